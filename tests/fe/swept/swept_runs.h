/* A moving wire of swept hexahedra: body, masses and velocities. */
#ifndef WB_TESTS_FE_SWEPT_SWEPT_RUNS_H
#define WB_TESTS_FE_SWEPT_SWEPT_RUNS_H

#include "fe/swept/swept_frequency.h"
#include "fe/swept/swept_step.h"
#include "tests/fe/swept/swept_bodies.h"

struct swept_run {
    struct swept_body body;
    struct wb_swept_section section;
    struct wb_swept_hex_model model;
    struct wb_swept_step *step;
    struct wb_swept_step_fields fields;
    double *node_mass;
    double omega; /* bound */
    int blocks;
};

struct swept_setup {
    int core, rings, elements;
    enum wb_swept_hex_formulation formulation;
    double length, diameter, density, hourglass, mass_scaling, selective, gravity[3];
    struct wb_material material;
    bool double_precision;
};

static inline struct swept_setup swept_type3(int core, int rings, int elements, double length)
{
    const struct test_wire wire = test_wire_type(3);
    return (struct swept_setup){.core = core,
                                .rings = rings,
                                .elements = elements,
                                .length = length,
                                .diameter = wire.diameter,
                                .density = wire.density,
                                .material = wire.material,
                                .selective = 1.0};
}

/* The mass per length is the circle's, for any area of the mesh. */
static inline void swept_run_init(struct swept_run *run, const struct swept_setup *s)
{
    *run = (struct swept_run){0};
    run->section = swept_circle(s->diameter, s->core, s->rings);
    run->model = (struct wb_swept_hex_model){.section = &run->section,
                                             .material = s->material,
                                             .n_elements = s->elements,
                                             .element_length = s->length / s->elements,
                                             .formulation = s->formulation,
                                             .hourglass = s->hourglass,
                                             .double_precision = s->double_precision};
    wb_swept_hex_fit_circle(&run->section, s->diameter, s->formulation, &s->material);
    run->body = swept_body_create(&run->model);
    run->blocks = wb_swept_hex_blocks(run->body.hex);
    run->node_mass = malloc((size_t)run->section.n_nodes * sizeof *run->node_mass);
    assert_non_null(run->node_mass);
    for (int k = 0; k < run->section.n_nodes; k++)
        run->node_mass[k] =
            s->density * M_PI * s->diameter * s->diameter / 4.0 * run->section.share[k];
    const struct wb_swept_step_model step = {
        .layout = run->body.layout,
        .node_mass = run->node_mass,
        .spacing = run->model.element_length,
        .mass_scaling = s->mass_scaling,
        .selective = s->selective,
        .gravity = {s->gravity[0], s->gravity[1], s->gravity[2]},
        .double_precision = s->double_precision};
    assert_int_equal(wb_swept_step_create(&run->step, &step), WB_OK);
    run->fields = (struct wb_swept_step_fields){run->body.position, swept_field(&run->body.layout),
                                                run->body.force};
    assert_int_equal(
        wb_swept_frequency_bound(run->body.hex, run->node_mass, s->selective, &run->omega), WB_OK);
    if (s->mass_scaling > 0.0)
        run->omega /= sqrt(s->mass_scaling);
}

static inline void swept_run_release(struct swept_run *run)
{
    free(run->fields.velocity);
    wb_swept_step_destroy(run->step);
    swept_body_destroy(&run->body);
    wb_swept_section_release(&run->section);
    free(run->node_mass);
}

static inline double *swept_velocity(const struct swept_run *run, int node, int c, int station)
{
    return &run->fields.velocity[swept_at(&run->body.layout, node, c, station)];
}

/* Computes forces, then advances velocities by `first` and positions by `dt`. */
static inline void swept_advance(struct swept_run *run, double first, double dt,
                                 struct wb_swept_step_sums *sums)
{
    const double times[2] = {first, dt};
    swept_find_forces(&run->body, 0, run->blocks, NULL);
    wb_swept_step_update(run->step, &run->fields, times, 0, run->blocks, sums);
}

static inline void swept_hold(struct swept_run *run, int station, bool held)
{
    for (int c = 0; c < 3; c++)
        wb_swept_step_hold(run->step, station, c, held);
}

/* Mass-weighted mean over a station. */
static inline double swept_mean(const struct swept_run *run, const double *field, int c,
                                int station)
{
    double sum = 0.0;
    for (int k = 0; k < run->section.n_nodes; k++)
        sum += run->section.share[k] * field[swept_at(&run->body.layout, k, c, station)];
    return sum;
}

#endif
