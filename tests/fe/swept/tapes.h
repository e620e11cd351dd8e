/* Tapes for tests: model, positions and forces; flat sheets and tubes. */
#ifndef WB_TESTS_FE_SWEPT_TAPES_H
#define WB_TESTS_FE_SWEPT_TAPES_H

#include <stdlib.h>

#include "fe/swept/swept_step.h"
#include "fe/swept/swept_tape.h"
#include "tests/fe/swept/swept_bodies.h"

/* The tape of the paper: two half-lapped layers. */
static const struct wb_material tape_law = {
    WB_HARDENING_ISOTROPIC_POWER, 119e6, 0.3, 2.4e6, 16.3e6, 0.73};
static const struct wb_material elastic_tape = {
    WB_HARDENING_NONE_ELASTIC, 119e6, 0.3, 0.0, 0.0, 1.0};

struct test_tape {
    struct wb_swept_tape_model model;
    struct wb_swept_tape *tape;
    struct wb_swept_tape_state *state;
    struct wb_swept_layout layout;
    double *position, *director;
    void *force, *moment;
};

/* A model in double precision. The caller sets its positions; test_tape_destroy() frees them. */
static inline struct wb_swept_tape_model tape_model(const struct wb_material *material, int nodes,
                                                    int stations, bool closed, double spacing)
{
    const struct wb_swept_layout layout = wb_swept_layout(nodes, stations);
    return (struct wb_swept_tape_model){
        .material = *material,
        .density = 1250.0,
        .thickness = 0.2e-3,
        .layout = layout,
        .position = swept_field(&layout),
        .spacing = spacing,
        .closed = closed,
        .double_precision = true,
    };
}

static inline void tape_put(const struct wb_swept_layout *layout, const double *field, int node,
                            int station, double x, double y, double z)
{
    const double value[3] = {x, y, z};
    for (int i = 0; i < 3; i++)
        ((double *)field)[swept_at(layout, node, i, station)] = value[i];
}

static inline void tape_get(const struct wb_swept_layout *layout, const double *field, int node,
                            int station, double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = field[swept_at(layout, node, i, station)];
}

static inline struct test_tape test_tape_create(const struct wb_swept_tape_model *model)
{
    struct test_tape t = {.model = *model, .layout = model->layout};
    const size_t bytes = wb_swept_size(&t.layout) * sizeof(double);
    assert_int_equal(wb_swept_tape_create(&t.tape, model), WB_OK);
    t.state = wb_swept_tape_state_create(t.tape);
    t.position = swept_field(&t.layout);
    t.director = swept_field(&t.layout);
    t.force = swept_field(&t.layout);
    t.moment = swept_field(&t.layout);
    memcpy(t.position, model->position, bytes);
    memcpy(t.director, wb_swept_tape_directors(t.tape), bytes);
    return t;
}

static inline void test_tape_destroy(struct test_tape *t)
{
    wb_swept_tape_state_destroy(t->state);
    wb_swept_tape_destroy(t->tape);
    free((void *)t->model.position);
    free(t->position);
    free(t->director);
    free(t->force);
    free(t->moment);
}

static inline struct wb_swept_tape_sums tape_forces(struct test_tape *t)
{
    const struct wb_swept_tape_fields fields = {t->position, t->director, t->force, t->moment};
    struct wb_swept_tape_sums sums = {0};
    wb_swept_tape_forces(t->state, &fields, 0, wb_swept_tape_blocks(t->tape), &sums);
    return sums;
}

static inline double tape_energy(struct test_tape *t)
{
    const struct wb_swept_tape_sums sums = tape_forces(t);
    return sums.stored + sums.artificial;
}

/* One component of the force or moment at a node, in either precision. */
static inline double tape_load(const struct test_tape *t, const void *field, int node,
                               int component, int station)
{
    const size_t at = swept_at(&t->layout, node, component, station);
    return t->model.double_precision ? ((const double *)field)[at]
                                     : (double)((const float *)field)[at];
}

/* A flat sheet of a x b (m) in the plane z = 0, normal +z. Inner nodes are displaced at random by
 * up to `distortion` times the size of an element. */
static inline void make_sheet(struct wb_swept_tape_model *model, double a, double b,
                              double distortion)
{
    const struct wb_swept_layout *l = &model->layout;
    uint64_t seed = 7;
    for (int k = 0; k < l->n_nodes; k++) {
        for (int j = 0; j < l->n_stations; j++) {
            const bool inner = k > 0 && k < l->n_nodes - 1 && j > 0 && j < l->n_stations - 1;
            const double off = inner ? distortion : 0.0;
            const double xi = j + off * (2.0 * test_random(&seed) - 1.0);
            const double eta = k + off * (2.0 * test_random(&seed) - 1.0);
            tape_put(l, model->position, k, j, a * xi / (l->n_stations - 1),
                     b * eta / (l->n_nodes - 1), 0.0);
        }
    }
}

/* A tube around the x axis. Its lines of nodes are helices, which turn by `winding` (rad) from one
 * station to the next. The section of a closed tube is a full circle, that of an open one `turns`
 * circles. */
static inline void make_tube(struct wb_swept_tape_model *model, double radius, double winding,
                             double turns)
{
    const struct wb_swept_layout *l = &model->layout;
    const double step =
        model->closed ? 2.0 * M_PI / l->n_nodes : 2.0 * M_PI * turns / (l->n_nodes - 1);
    for (int k = 0; k < l->n_nodes; k++) {
        for (int j = 0; j < l->n_stations; j++) {
            const double angle = k * step + winding * j;
            tape_put(l, model->position, k, j, model->spacing * j, radius * sin(angle),
                     radius * cos(angle));
        }
    }
}

#endif
