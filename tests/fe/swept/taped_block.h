/* A flat tape on a wire of rectangular section, for the tests of cohesion. */
#ifndef WB_TESTS_FE_SWEPT_TAPED_BLOCK_H
#define WB_TESTS_FE_SWEPT_TAPED_BLOCK_H

#include "fe/swept/swept_cohesion.h"
#include "tests/fe/swept/adhesive.h"
#include "tests/fe/swept/tapes.h"

enum {
    NODES = 5,
    STATIONS = 20,
    CORNERS = 8
};

static const double gap = 0.1e-3, width = 2e-3, spacing = 0.5e-3;

/* A flat tape on a wire of rectangular section, whose upper side is y = 0 and has five nodes. */
static const double block_node[CORNERS][2] = {{0.0, 1.5e-3},  {0.0, 0.7e-3},  {0.0, 0.1e-3},
                                              {0.0, -0.6e-3}, {0.0, -1.4e-3}, {-1e-3, -1.4e-3},
                                              {-1e-3, 0.0},   {-1e-3, 1.5e-3}};
static const int block_surface[CORNERS] = {0, 1, 2, 3, 4, 5, 6, 7};
static const struct wb_swept_wire block = {
    .node = block_node,
    .n_nodes = CORNERS,
    .n_surface = CORNERS,
    .surface = block_surface,
};

struct pair {
    struct test_tape tape;
    struct wb_swept_cohesion *cohesion;
    struct wb_swept_layout layout; /* of the wire */
    double *position;
    void *force;
};

static inline struct wb_swept_cohesion_settings brittle(void)
{
    struct wb_swept_cohesion_settings settings;
    default_cohesion(&settings);
    settings.strength = 0.5e6;
    settings.shear_strength = 0.2e6;
    settings.fracture_energy = 25.0;
    return settings;
}

static inline void place_block(const struct wb_swept_layout *layout, double *position)
{
    for (int k = 0; k < CORNERS; k++) {
        for (int j = 0; j < STATIONS; j++)
            tape_put(layout, position, k, j, spacing * j, block_node[k][0], block_node[k][1]);
    }
}

static inline struct pair pair_create(const struct wb_swept_cohesion_settings *settings,
                                      bool is_double, enum wb_swept_instructions instructions)
{
    struct wb_swept_tape_model model = tape_model(&elastic_tape, NODES, STATIONS, false, spacing);
    struct wb_swept_cohesion_bond bond[NODES * STATIONS];
    struct pair p = {.layout = wb_swept_layout(CORNERS, STATIONS)};
    for (int k = 0; k < NODES; k++) {
        for (int j = 0; j < STATIONS; j++) {
            tape_put(&model.layout, model.position, k, j, spacing * j, gap,
                     width * (0.5 - (double)k / (NODES - 1)));
            bond[k * STATIONS + j] = (struct wb_swept_cohesion_bond){0, 1.0};
        }
    }
    model.double_precision = is_double;
    model.instructions = instructions;
    p.tape = test_tape_create(&model);
    assert_int_equal(wb_swept_cohesion_create(&p.cohesion, p.tape.tape, settings, 1, &block, bond),
                     WB_OK);
    p.position = swept_field(&p.layout);
    p.force = swept_field(&p.layout);
    place_block(&p.layout, p.position);
    return p;
}

static inline void pair_destroy(struct pair *p)
{
    wb_swept_cohesion_destroy(p->cohesion);
    test_tape_destroy(&p->tape);
    free(p->position);
    free(p->force);
}

/* Cohesion alone. */
static inline struct wb_swept_cohesion_sums pair_forces(struct pair *p)
{
    const struct wb_swept_cohesion_fields fields = {
        {p->tape.position, p->tape.director, p->tape.force, p->tape.moment},
        (const double *const[]){p->position},
        (void *const[]){p->force}};
    const size_t size = p->tape.model.double_precision ? sizeof(double) : sizeof(float);
    struct wb_swept_cohesion_sums sums = {0};
    memset(p->tape.force, 0, wb_swept_size(&p->tape.layout) * size);
    memset(p->tape.moment, 0, wb_swept_size(&p->tape.layout) * size);
    memset(p->force, 0, wb_swept_size(&p->layout) * size);
    wb_swept_cohesion_add_forces(p->cohesion, &fields, 0, wb_swept_tape_blocks(p->tape.tape),
                                 &sums);
    return sums;
}

static inline double block_load(const struct pair *p, int node, int component, int station)
{
    const size_t at = swept_at(&p->layout, node, component, station);
    return p->tape.model.double_precision ? ((double *)p->force)[at]
                                          : (double)((float *)p->force)[at];
}

static inline void move_tape(struct pair *p, double x, double y, double z)
{
    const double by[3] = {x, y, z};
    for (int k = 0; k < NODES; k++) {
        for (int j = 0; j < STATIONS; j++) {
            for (int i = 0; i < 3; i++)
                p->tape.position[swept_at(&p->tape.layout, k, i, j)] += by[i];
        }
    }
}

static inline void set_tape(struct pair *p, double x, double y, double z)
{
    memcpy(p->tape.position, p->tape.model.position,
           wb_swept_size(&p->tape.layout) * sizeof(double));
    move_tape(p, x, y, z);
}

static inline void turn_field(const struct wb_swept_layout *layout, double *field, double angle)
{
    double R[3][3];
    swept_rotation(angle, R);
    for (int k = 0; k < layout->n_nodes; k++) {
        for (int j = 0; j < layout->n_stations; j++) {
            double x[3];
            tape_get(layout, field, k, j, x);
            tape_put(layout, field, k, j, R[0][0] * x[0] + R[0][1] * x[1] + R[0][2] * x[2],
                     R[1][0] * x[0] + R[1][1] * x[1] + R[1][2] * x[2],
                     R[2][0] * x[0] + R[2][1] * x[1] + R[2][2] * x[2]);
        }
    }
}

static inline void shake_field(const struct wb_swept_layout *layout, double *field, double size,
                               uint64_t *seed)
{
    for (int k = 0; k < layout->n_nodes; k++) {
        for (int j = 0; j < layout->n_stations; j++) {
            for (int i = 0; i < 3; i++)
                field[swept_at(layout, k, i, j)] += size * (2.0 * test_random(seed) - 1.0);
        }
    }
}

static inline void sum_tape(const struct pair *p, double sum[3])
{
    for (int i = 0; i < 3; i++) {
        sum[i] = 0.0;
        for (int k = 0; k < NODES; k++) {
            for (int j = 0; j < STATIONS; j++)
                sum[i] += tape_load(&p->tape, p->tape.force, k, i, j);
        }
    }
}

static const double whole_area = 2e-3 * 0.5e-3 * (STATIONS - 1);

/* Positions, directors and wire randomly displaced by a large amount, and rotated. */
static inline struct pair shaken(const struct wb_swept_cohesion_settings *settings, bool is_double,
                                 enum wb_swept_instructions instructions)
{
    struct pair p = pair_create(settings, is_double, instructions);
    uint64_t seed = 4;
    move_tape(&p, 8e-6, 10e-6, 4e-6);
    shake_field(&p.tape.layout, p.tape.position, 8e-6, &seed);
    shake_field(&p.tape.layout, p.tape.director, 0.03, &seed);
    shake_field(&p.layout, p.position, 8e-6, &seed);
    turn_field(&p.tape.layout, p.tape.position, 0.6);
    turn_field(&p.tape.layout, p.tape.director, 0.6);
    turn_field(&p.layout, p.position, 0.6);
    return p;
}

#endif
