/* Datasets in the form of `solve bundle`, without a 3D solution: forces are those of the published
 * beam times a factor, and the axis is that beam's. For tests of readers of such datasets. */
#ifndef WB_TESTS_ANALYSIS_MADE_UP_BUNDLE_H
#define WB_TESTS_ANALYSIS_MADE_UP_BUNDLE_H

#include "tests/check.h"

#include <stdlib.h>

#include "analysis/dataset/simulated_bundle.h"
#include "analysis/dataset/surface.h"
#include "base/units.h"
#include "fe/rod/section.h"
#include "fe/trial/cantilever.h"

enum {
    MADE_UP_SHAPE = 26
};

struct made_up_bundle {
    const struct wb_bundle_model *model; /* as it was run */
    double factor;                       /* of the published forces */
    double kinetic, imbalance;           /* largest ratios */
    double cpu;                          /* s */
    int rows;                            /* computed rows of the model; 0: all */
};

static inline void made_up_fill_row(struct wb_bundle_result *result, int i,
                                    const struct wb_cantilever_point *point, double factor)
{
    struct wb_bundle_row *const row = &result->rows[i];
    *row = (struct wb_bundle_row){
        .time = 0.01 * i,
        .cycle = 1,
        .phase = WB_PHASE_LOAD,
        .deflection = point->deflection,
        .tip = {point->tip_x, point->deflection, 0.0},
        .tip_angle = point->tip_angle,
        .tension = factor * point->tension,
        .vertical_force = factor * point->vertical_force,
        .force = factor * point->vertical_force,
    };
    if (i > 0) {
        const struct wb_bundle_row *const before = row - 1;
        row->energies = before->energies;
        row->energies.external +=
            0.5 * (row->force + before->force) * (row->deflection - before->deflection);
        row->energies.stored = 0.6 * row->energies.external;
        row->energies.plastic = 0.3 * row->energies.external;
        row->energies.friction = 0.1 * row->energies.external;
    }
}

static inline void made_up_bend(const struct made_up_bundle *bundle,
                                struct wb_bundle_result *result)
{
    const struct wb_bundle_model *const m = bundle->model;
    const struct wb_wire *const beam = &m->published.beam;
    struct wb_section section;
    struct wb_cantilever *cantilever;
    struct wb_cantilever_model model;
    assert_int_equal(wb_section_init_circle(&section, beam->outer_diameter, &beam->material, 0),
                     WB_OK);
    wb_cantilever_default_model(&model);
    model.section = &section;
    model.length = m->length;
    model.gravity_y = 0.0;
    assert_int_equal(wb_cantilever_create(&cantilever, &model, NULL), WB_OK);
    const int n = bundle->rows > 0 ? bundle->rows : m->run.rows + 1;
    for (int i = 0; i < n; i++) {
        struct wb_cantilever_point point;
        double x[MADE_UP_SHAPE], y[MADE_UP_SHAPE];
        assert_int_equal(wb_cantilever_move(cantilever, WB_CONTROL_DEFLECTION,
                                            m->run.deflection * i / m->run.rows, &point),
                         WB_OK);
        made_up_fill_row(result, i, &point, bundle->factor);
        wb_cantilever_shape(cantilever, MADE_UP_SHAPE, result->shape_s, x, y, NULL);
        for (int k = 0; k < MADE_UP_SHAPE; k++) {
            double *const at = result->shape[i * MADE_UP_SHAPE + k];
            at[0] = x[k], at[1] = y[k], at[2] = 0.0;
        }
        result->n_rows = i + 1;
    }
    wb_cantilever_destroy(cantilever);
    wb_section_release(&section);
}

enum {
    MADE_UP_AROUND = 12
};

/* A tube with the bundle's diameter along its last axis, with a stress that decreases towards the
 * tip. */
static inline void made_up_write_surface(const struct wb_bundle_result *result, double diameter,
                                         const char *folder)
{
    const double(*const axis)[3] =
        (const double(*)[3])result->shape + (size_t)(result->n_rows - 1) * MADE_UP_SHAPE;
    struct wb_surface_node nodes[MADE_UP_SHAPE * MADE_UP_AROUND];
    struct wb_surface_body body = {
        .closed = true, .n_around = MADE_UP_AROUND, .n_along = MADE_UP_SHAPE, .nodes = nodes};
    const struct wb_surface surface = {1, &body};
    for (int i = 0; i < MADE_UP_SHAPE; i++) {
        const int from = i > 0 ? i - 1 : 0, to = i + 1 < MADE_UP_SHAPE ? i + 1 : i;
        const double angle = atan2(axis[to][1] - axis[from][1], axis[to][0] - axis[from][0]);
        for (int k = 0; k < MADE_UP_AROUND; k++) {
            const double around = 6.283185307179586 * k / MADE_UP_AROUND;
            const double up = 0.5 * diameter * cos(around), aside = 0.5 * diameter * sin(around);
            nodes[i * MADE_UP_AROUND + k] = (struct wb_surface_node){
                .position = {axis[i][0] - up * sin(angle), axis[i][1] + up * cos(angle), aside},
                .von_mises = 30e6 * (1.0 - (double)i / MADE_UP_SHAPE),
            };
        }
    }
    assert_int_equal(wb_surface_write(&surface, folder), WB_OK);
}

/* Of a bundle under a dead force, without weight. */
static inline void made_up_write(const struct made_up_bundle *bundle, const char *folder)
{
    const struct wb_bundle_model *const m = bundle->model;
    struct wb_bundle_result result = {0};
    struct wb_dataset dataset;
    assert_int_equal(wb_bundle_result_init(&result, m, MADE_UP_SHAPE), WB_OK);
    made_up_bend(bundle, &result);
    result.converged = result.n_rows == m->run.rows + 1;
    wb_reason_set(&result.reason, "made up");
    result.duration = m->run.duration > 0.0 ? m->run.duration : 1.5;
    result.chosen = !(m->run.duration > 0.0);
    result.attempts = 1;
    result.time_step = 4e-6;
    result.steps = result.all_steps = 400000;
    result.hexahedra = 6720;
    result.largest.kinetic = bundle->kinetic;
    result.largest.artificial = 0.004;
    result.largest.imbalance = bundle->imbalance;
    result.largest.strain = 0.03;
    const struct wb_simulated_bundle simulated = {
        .model = m,
        .mesh = wb_bundle_model_mesh(m, m->run.mesh),
        .result = &result,
        .wall = bundle->cpu,
        .cpu = bundle->cpu,
    };
    wb_dataset_init(&dataset);
    wb_simulated_bundle_fill(&dataset, &simulated);
    assert_int_equal(wb_dataset_write(&dataset, folder, true), WB_OK);
    assert_int_equal(wb_simulated_bundle_write_energies(&dataset, &simulated, folder), WB_OK);
    made_up_write_surface(&result, m->published.outer_diameter, folder);
    wb_dataset_release(&dataset);
    wb_bundle_result_release(&result);
}

#endif
