/* Datasets in the form of `solve wire3d` and `solve wire1d`, without a 3D solution: the axis is
 * that of a homogenised rod, the stresses are those of beam theory. For tests of readers of such
 * datasets. */
#ifndef WB_TESTS_ANALYSIS_BENT_WIRE_H
#define WB_TESTS_ANALYSIS_BENT_WIRE_H

#include "tests/check.h"

#include <stdlib.h>

#include "analysis/dataset/fields.h"
#include "analysis/dataset/simulated.h"
#include "fe/rod/section.h"
#include "fe/trial/cantilever.h"
#include "fe/trial/wire_run_private.h"

enum {
    BENT_SHAPE = 41,  /* positions of a shape */
    BENT_ALONG = 24,  /* faces along the longitudinal section */
    BENT_ACROSS = 6,  /* over the core's diameter */
    BENT_AROUND = 16, /* of the jacket, and of a rod's cells */
    BENT_RINGS = 4    /* of a rod's cells in each part */
};

struct bent_wire {
    const struct wb_wire_model *model;
    const char *solver;          /* "wire3d", "wire1d" */
    struct wb_material material; /* of the rod that gives the axis */
    double stress_factor;        /* of all stresses; 1 is beam theory */
    double most_stress;          /* Pa, von Mises, of the core; 0: no end */
    double aside;                /* m: z of the tip, when the model has a step before the last */
    double cpu;                  /* s */
    bool cut_short;              /* it ends half way */
    /* Of the last state. */
    double x[BENT_SHAPE], y[BENT_SHAPE], z[BENT_SHAPE], angle[BENT_SHAPE];
    double force;
};

/* --- the axis --- */

static inline double bent_rigidity(const struct bent_wire *bent)
{
    return bent->material.youngs_modulus * pow(bent->model->part[1].outer_diameter, 4.0) *
           3.14159265358979323846 / 64.0;
}

/* Curvature of an elastic wire by the moment of the follower force. */
static inline double bent_curvature(const struct bent_wire *bent, double s)
{
    const double place = s / bent->model->length * (BENT_SHAPE - 1);
    const int i = place < BENT_SHAPE - 1 ? (int)place : BENT_SHAPE - 2;
    const double part = place - i;
    const double x = bent->x[i] + part * (bent->x[i + 1] - bent->x[i]);
    const double y = bent->y[i] + part * (bent->y[i + 1] - bent->y[i]);
    const double tip = bent->angle[BENT_SHAPE - 1];
    return bent->force *
           ((bent->x[BENT_SHAPE - 1] - x) * cos(tip) + (bent->y[BENT_SHAPE - 1] - y) * sin(tip)) /
           bent_rigidity(bent);
}

static inline void bent_add_row(struct bent_wire *bent, struct wb_wire_run *run, int step,
                                double fraction)
{
    const struct wb_wire_model *const model = bent->model;
    double(*const shape)[3] = calloc(BENT_SHAPE, sizeof *shape);
    struct wb_wire_row row = {.step = step, .fraction = fraction, .iterations = 4};
    assert_non_null(shape);
    for (int i = 0; i < BENT_SHAPE; i++) {
        const double part = (double)i / (BENT_SHAPE - 1);
        bent->z[i] = model->n_steps > 1 && fraction > 0.0 ? bent->aside * part * part : 0.0;
        shape[i][0] = bent->x[i];
        shape[i][1] = bent->y[i];
        shape[i][2] = bent->z[i];
    }
    memcpy(row.tip, shape[BENT_SHAPE - 1], sizeof row.tip);
    row.tangent[0] = cos(bent->angle[BENT_SHAPE - 1]);
    row.tangent[1] = sin(bent->angle[BENT_SHAPE - 1]);
    row.loads.follower[1] = bent->force;
    wb_wire_run_add(run, model, &row, false, (const double(*)[3])shape);
    free(shape);
}

/* --- the stresses --- */

static inline void bent_set_node(const struct bent_wire *bent, struct wb_field_node *node, int part,
                                 bool loaded, const double at[3])
{
    const double place = at[0] / bent->model->length * (BENT_SHAPE - 1);
    const int i = place < BENT_SHAPE - 1 ? (int)place : BENT_SHAPE - 2;
    const double p = place - i, angle = bent->angle[i] + p * (bent->angle[i + 1] - bent->angle[i]);
    memcpy(node->reference, at, sizeof node->reference);
    node->position[0] = bent->x[i] + p * (bent->x[i + 1] - bent->x[i]) - at[1] * sin(angle);
    node->position[1] = bent->y[i] + p * (bent->y[i + 1] - bent->y[i]) + at[1] * cos(angle);
    node->position[2] = bent->z[i] + p * (bent->z[i + 1] - bent->z[i]) + at[2];
    const struct wb_wire_model_part *const of = &bent->model->part[part];
    if (loaded) {
        node->axial = -bent->stress_factor * of->material.youngs_modulus *
                      bent_curvature(bent, at[0]) * at[1];
    } else {
        /* Residual stress after bending: zero at the axis, one sign inside, the other outside. */
        const double r = (at[1] + at[2]) / bent->model->part[0].outer_diameter;
        node->axial = part == 0 ? 4e8 * (r - 2.4 * r * r * r) : 1e5 * r;
    }
    if (part == 0 && bent->most_stress > 0.0)
        node->axial = copysign(fmin(fabs(node->axial), bent->most_stress), node->axial);
    node->von_mises = fabs(node->axial);
}

static const double bent_corners[8][2] = {{0, 0},   {1, 0},   {1, 1},   {0, 1},
                                          {0.5, 0}, {1, 0.5}, {0.5, 1}, {0, 0.5}};

/* A cell of a rod has the value of its centre everywhere. */
static inline void bent_level(struct wb_field_face *face)
{
    double axial = 0.0, von_mises = 0.0;
    for (int k = 4; k < 8; k++) {
        axial += 0.25 * face->node[k].axial;
        von_mises += 0.25 * face->node[k].von_mises;
    }
    for (int k = 0; k < 8; k++) {
        face->node[k].axial = axial;
        face->node[k].von_mises = von_mises;
    }
}

/* Rings from `inner` to `outer`, in cells. */
static inline int bent_rings(const struct bent_wire *bent, struct wb_field_face *faces, int part,
                             bool loaded, double x)
{
    const double inner = 0.5 * bent->model->part[part].inner_diameter;
    const double outer = 0.5 * bent->model->part[part].outer_diameter;
    for (int i = 0; i < BENT_RINGS * BENT_AROUND; i++) {
        faces[i].part = part;
        for (int k = 0; k < 8; k++) {
            const double r =
                inner + (outer - inner) * (i / BENT_AROUND + bent_corners[k][0]) / BENT_RINGS;
            const double angle =
                6.28318530717958647692 * (i % BENT_AROUND + bent_corners[k][1]) / BENT_AROUND;
            bent_set_node(bent, &faces[i].node[k], part, loaded,
                          (double[3]){x, r * cos(angle), r * sin(angle)});
        }
        if (strcmp(bent->solver, "wire1d") == 0)
            bent_level(&faces[i]);
    }
    return BENT_RINGS * BENT_AROUND;
}

static inline void bent_add_section(const struct bent_wire *bent, struct wb_fields *fields,
                                    const char *state, bool loaded, double x)
{
    struct wb_field *field;
    assert_int_equal(wb_fields_add(fields, state, x, 2 * BENT_RINGS * BENT_AROUND, &field, NULL),
                     WB_OK);
    const int n = bent_rings(bent, field->faces, 0, loaded, x);
    (void)bent_rings(bent, field->faces + n, 1, loaded, x);
}

static inline void bent_add_long(const struct bent_wire *bent, struct wb_fields *fields,
                                 const char *state, bool loaded)
{
    const double core = 0.5 * bent->model->part[0].outer_diameter;
    const double out = 0.5 * bent->model->part[1].outer_diameter;
    struct wb_field *field;
    const int across = BENT_ACROSS + 2;
    assert_int_equal(wb_fields_add(fields, state, (double)NAN, BENT_ALONG * across, &field, NULL),
                     WB_OK);
    for (int i = 0; i < BENT_ALONG * across; i++) {
        struct wb_field_face *const face = &field->faces[i];
        const int row = i % across;
        face->part = row == 0 || row == across - 1;
        for (int k = 0; k < 8; k++) {
            const double t = bent_corners[k][1];
            const double y = row == 0            ? -out + t * (out - core)
                             : row == across - 1 ? core + t * (out - core)
                                                 : -core + 2.0 * core * (row - 1 + t) / BENT_ACROSS;
            const double x = bent->model->length * (i / across + bent_corners[k][0]) / BENT_ALONG;
            bent_set_node(bent, &face->node[k], face->part, loaded, (double[3]){x, y, 0.0});
        }
        if (strcmp(bent->solver, "wire1d") == 0)
            bent_level(face);
    }
}

static inline void bent_add_fields(const struct bent_wire *bent, struct wb_fields *fields, int step)
{
    const struct wb_wire_model *const model = bent->model;
    const bool loaded = step == model->n_steps - 1;
    const char *const state = model->step[step].name;
    bent_add_long(bent, fields, state, loaded);
    for (int i = 0; i < model->n_sections; i++)
        bent_add_section(bent, fields, state, loaded, model->section[i]);
}

/* --- the dataset --- */

static inline void bent_run(struct bent_wire *bent, struct wb_wire_run *run,
                            struct wb_fields *fields)
{
    const struct wb_wire_model *const model = bent->model;
    struct wb_section section;
    struct wb_cantilever *cantilever;
    struct wb_cantilever_model beam;
    assert_int_equal(
        wb_section_init_circle(&section, model->part[1].outer_diameter, &bent->material, 0), WB_OK);
    wb_cantilever_default_model(&beam);
    beam.section = &section;
    beam.length = model->length;
    beam.gravity_y = 0.0;
    assert_int_equal(wb_cantilever_create(&cantilever, &beam, NULL), WB_OK);
    assert_int_equal(wb_wire_run_init(run, model, BENT_SHAPE), WB_OK);
    bent->force = 0.0;
    for (int i = 0; i < BENT_SHAPE; i++) {
        bent->x[i] = run->shape_s[i];
        bent->y[i] = bent->angle[i] = 0.0;
    }
    bent_add_row(bent, run, 0, 0.0);
    for (int step = 0; step < model->n_steps; step++) {
        const int rows = model->step[step].rows;
        const bool last = step == model->n_steps - 1;
        for (int i = 1; i <= rows && !(last && bent->cut_short && 2 * i > rows); i++) {
            struct wb_cantilever_point point;
            bent->force = model->step[step].loads.follower[1] * i / rows;
            assert_int_equal(
                wb_cantilever_move(cantilever, WB_CONTROL_FOLLOWER_FORCE, bent->force, &point),
                WB_OK);
            assert_int_equal(point.end, WB_CANTILEVER_CONVERGED);
            wb_cantilever_shape(cantilever, BENT_SHAPE, run->shape_s, bent->x, bent->y,
                                bent->angle);
            bent_add_row(bent, run, step, (double)i / rows);
        }
        if (model->step[step].fields && !(last && bent->cut_short))
            bent_add_fields(bent, fields, step);
    }
    run->converged = !bent->cut_short;
    if (bent->cut_short)
        snprintf(run->problem, sizeof run->problem, "step 'loaded' at 12 N: made up");
    wb_cantilever_destroy(cantilever);
    wb_section_release(&section);
}

/* Writes the dataset into a folder, replacing an existing one. */
static inline void bent_write(struct bent_wire *bent, const char *folder)
{
    struct wb_wire_run run = {0};
    struct wb_fields fields = {0};
    struct wb_dataset dataset;
    bent_run(bent, &run, &fields);
    run.n_elements = strcmp(bent->solver, "wire3d") == 0 ? 2400 : 50;
    run.n_unknowns = strcmp(bent->solver, "wire3d") == 0 ? 31000 : 600;
    run.iterations = 4 * run.n_rows;
    const struct wb_simulated_wire wire = {.solver = bent->solver,
                                           .model = bent->model,
                                           .run = &run,
                                           .wall = bent->cpu,
                                           .cpu = bent->cpu,
                                           .peak_memory = 250e6};
    wb_dataset_init(&dataset);
    wb_simulated_fill_wire(&dataset, &wire);
    assert_int_equal(wb_dataset_write(&dataset, folder, true), WB_OK);
    assert_int_equal(wb_fields_write(&fields, folder), WB_OK);
    wb_dataset_release(&dataset);
    wb_fields_release(&fields);
    wb_wire_run_release(&run);
}

#endif
