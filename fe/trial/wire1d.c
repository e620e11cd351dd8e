#include "fe/trial/wire1d.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "fe/rod/rod_solver.h"

enum {
    DEFAULT_ELEMENTS = 50
};

struct wb_wire1d {
    const struct wb_wire_model *model; /* borrowed */
    int n_elements;
    struct wb_rod_section *section;
    struct wb_rod *rod;
    struct wb_rod_solver *solver;
};

/* A run in progress. */
struct run {
    struct wb_wire1d *wire;
    struct wb_wire_progress at;
};

static enum wb_status make_section(struct wb_wire1d *wire,
                                   const struct wb_rod_section_layout *layout)
{
    const struct wb_wire_model *m = wire->model;
    struct wb_rod_section_part parts[WB_WIRE_MODEL_PARTS];

    for (int i = 0; i < m->n_parts; i++)
        parts[i] = (struct wb_rod_section_part){
            .inner_diameter = m->part[i].inner_diameter,
            .outer_diameter = m->part[i].outer_diameter,
            .material = m->part[i].material,
        };
    return wb_rod_section_create(&wire->section, m->n_parts, parts, layout);
}

static enum wb_status make_rod(struct wb_wire1d *wire)
{
    const struct wb_wire_model *m = wire->model;
    const double mass = wb_wire_model_mass_per_length(m);
    const struct wb_rod_model rod = {
        .section = wire->section,
        .length = m->length,
        .n_elements = wire->n_elements,
        .load = {mass * m->gravity[0], mass * m->gravity[1], mass * m->gravity[2]},
    };
    WB_TRY(wb_rod_create(&wire->rod, &rod));

    const struct wb_rod_solver_model solver = {
        .rod = wire->rod,
        .length = m->length,
        .strand_length = m->strand_length,
        .strand_x = m->length,
    };
    return wb_rod_solver_create(&wire->solver, &solver);
}

enum wb_status wb_wire1d_create(struct wb_wire1d **out, const struct wb_wire_model *model,
                                const struct wb_wire1d_settings *settings)
{
    *out = NULL;
    struct wb_wire1d_settings given = {0};
    if (settings)
        given = *settings;
    const struct wb_rod_section_layout layout = {given.n_rings, given.n_around};

    struct wb_wire1d *const wire = wb_memory_new(1, sizeof *wire);
    wire->model = model;
    wire->n_elements = given.n_elements == 0 ? DEFAULT_ELEMENTS : given.n_elements;
    enum wb_status status = make_section(wire, &layout);
    if (status == WB_OK)
        status = make_rod(wire);
    if (status != WB_OK)
        wb_wire1d_destroy(wire);
    else
        *out = wire;
    return status;
}

void wb_wire1d_destroy(struct wb_wire1d *wire)
{
    if (!wire)
        return;
    wb_rod_solver_destroy(wire->solver);
    wb_rod_destroy(wire->rod);
    wb_rod_section_destroy(wire->section);
    free(wire);
}

void wb_wire1d_frame(const struct wb_wire1d *wire, double s, double position[3], double frame[3][3])
{
    const struct wb_rod_node at = wb_rod_position(wire->rod, s);
    double R[9];

    memcpy(position, at.position, sizeof at.position);
    wb_rod_element_matrix(at.rotation, R);
    for (int row = 0; row < 3; row++) {
        for (int i = 0; i < 3; i++)
            frame[row][i] = R[3 * i + row];
    }
}

static void add_row(struct run *r, double fraction)
{
    const struct wb_wire1d *wire = r->wire;
    const struct wb_wire_run *run = r->at.run;
    const struct wb_rod_loads *loads = wb_rod_solver_loads(wire->solver);
    struct wb_wire_row row = {.fraction = fraction, .loads = loads->tip};
    double frame[3][3];

    wb_wire1d_frame(wire, wire->model->length, row.tip, frame);
    memcpy(row.tangent, frame[0], sizeof row.tangent);
    wb_wire_run_set_forces(&row, wire->model, loads->tension,
                           wb_rod_solver_vertical_force(wire->solver), (const double(*)[3])frame);
    for (int k = 0; k < run->n_shape; k++) {
        const struct wb_rod_node at = wb_rod_position(wire->rod, run->shape_s[k]);
        memcpy(run->axis[k], at.position, sizeof run->axis[k]);
    }
    wb_wire_run_end_row(&r->at, &row, wb_rod_solver_is_slack(wire->solver));
}

/* Called by wb_rod_solver_move() after each increment. */
static bool observe(void *context, double fraction, int iterations)
{
    struct run *r = context;
    double tip[3], frame[3][3];

    wb_wire1d_frame(r->wire, r->wire->model->length, tip, frame);
    return wb_wire_run_end_increment(&r->at, frame[0], fraction, iterations);
}

/* Makes one move and adds its iterations and cutbacks to the run; true if it converged. */
static bool move(struct run *r, struct wb_rod_move *move, struct wb_rod_result *result)
{
    move->observer = observe;
    move->context = r;
    r->at.status = wb_rod_solver_move(r->wire->solver, move, result);
    if (r->at.status != WB_OK)
        return false;
    r->at.run->iterations += result->iterations;
    r->at.run->cutbacks += result->cutbacks;
    r->at.run->stopped = r->at.run->stopped || result->end == WB_ROD_STOPPED;
    return result->end == WB_ROD_CONVERGED;
}

/* The move to the end of a row: the loads at `share` of the step, which began at `start`. */
static struct wb_rod_move plan_row(const struct run *r, const struct wb_wire_target *start,
                                   double share)
{
    const struct wb_wire_target to =
        wb_wire_run_target(&r->wire->model->step[r->at.step], start, share);
    return (struct wb_rod_move){
        .control = to.is_held ? WB_ROD_DEFLECTION : WB_ROD_LOADS,
        .target = {.weight = 1.0, .tip = to.tip, .tension = to.tension},
        .deflection = to.deflection,
    };
}

static bool run_step(struct run *r)
{
    const struct wb_wire_step *step = &r->wire->model->step[r->at.step];
    const struct wb_rod_loads *loads = wb_rod_solver_loads(r->wire->solver);
    const struct wb_wire_target start = {
        .tip = loads->tip,
        .tension = loads->tension,
        .deflection = wb_rod_solver_deflection(r->wire->solver),
    };

    for (r->at.row = 1; r->at.row <= step->rows; r->at.row++) {
        const double share = (double)r->at.row / step->rows;
        struct wb_rod_move row = plan_row(r, &start, share);
        struct wb_rod_result result = {0};
        if (!move(r, &row, &result)) {
            if (result.end == WB_ROD_NOT_CONVERGED)
                snprintf(r->at.run->problem, sizeof r->at.run->problem,
                         "step '%s', row %d (%.3g of the row): %s", step->name, r->at.row,
                         result.fraction, result.problem);
            return false;
        }
        add_row(r, share);
        if (r->at.status != WB_OK || r->at.run->stopped)
            return false;
    }
    return true;
}

/* Applies the weight to the virgin wire; if the first step prescribes a deflection, at deflection
 * zero. */
static bool begin(struct run *r)
{
    const bool level = r->wire->model->step[0].kind == WB_WIRE_STEP_DEFLECTION;
    struct wb_rod_move first = {
        .control = level ? WB_ROD_DEFLECTION : WB_ROD_LOADS,
        .target = {.weight = 1.0},
    };
    struct wb_rod_result result = {0};

    wb_rod_solver_reset(r->wire->solver);
    r->at.row = 0;
    if (!move(r, &first, &result)) {
        if (result.end == WB_ROD_NOT_CONVERGED)
            snprintf(r->at.run->problem, sizeof r->at.run->problem, "under its weight: %s",
                     result.problem);
        return false;
    }
    add_row(r, 0.0);
    return r->at.status == WB_OK && !r->at.run->stopped;
}

enum wb_status wb_wire1d_run(struct wb_wire1d *wire, struct wb_wire_run *run,
                             const struct wb_wire_observer *observer)
{
    struct run r = {
        .wire = wire,
        .at = {.run = run, .model = wire->model, .observer = observer, .status = WB_OK},
    };

    run->n_elements = wire->n_elements;
    run->n_unknowns = 2 * WB_ROD_ELEMENT_UNKNOWNS * wire->n_elements;
    run->converged = begin(&r);
    for (r.at.step = 0; run->converged && r.at.step < wire->model->n_steps; r.at.step++)
        run->converged = run_step(&r);
    if (run->stopped)
        run->converged = true;
    return r.at.status;
}

/* The Gauss point nearest to s. */
static int nearest_point(const struct wb_wire1d *wire, double s)
{
    int nearest = 0;
    double distance = (double)INFINITY;
    for (int g = 0; g < WB_ROD_ELEMENT_POINTS * wire->n_elements; g++) {
        double at, strain[WB_ROD_SECTION_STRAINS];
        const double *history;
        wb_rod_point_state(wire->rod, g, &at, strain, &history);
        if (fabs(at - s) < distance) {
            distance = fabs(at - s);
            nearest = g;
        }
    }
    return nearest;
}

struct wb_wire1d_fibre *wb_wire1d_section(const struct wb_wire1d *wire, double s, int *n)
{
    const int count = wb_rod_section_fibres(wire->section);
    struct wb_wire1d_fibre *const out = wb_memory_new((size_t)count, sizeof *out);

    double at, strain[WB_ROD_SECTION_STRAINS];
    const double *history;
    wb_rod_point_state(wire->rod, nearest_point(wire, s), &at, strain, &history);
    for (int i = 0; i < count; i++) {
        struct wb_rod_section_fibre cell;
        struct wb_wire1d_fibre *f = &out[i];
        wb_rod_section_fibre(wire->section, i, &cell);
        *f = (struct wb_wire1d_fibre){
            .y = cell.y,
            .z = cell.z,
            .inner_radius = cell.inner_radius,
            .outer_radius = cell.outer_radius,
            .begin_angle = cell.begin_angle,
            .end_angle = cell.end_angle,
            .part = cell.part,
        };
        wb_rod_section_stress(wire->section, i, strain, history, &f->axial, &f->shear, &f->plastic);
    }
    *n = count;
    return out;
}
