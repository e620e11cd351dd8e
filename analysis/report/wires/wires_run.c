/* One dataset of a comparison: read, checked, and its end taken. */
#include "analysis/report/wires/wires_run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "report"

/* --- one dataset --- */

static void read_simulation(struct wb_wires_run *run)
{
    const struct wb_json *const simulation = wb_simulation_of(&run->simulation);
    run->elements = wb_simulation_number(simulation, "elements");
    run->unknowns = wb_simulation_number(simulation, "degrees_of_freedom");
    run->iterations = wb_simulation_number(simulation, "iterations");
    run->memory_MB = wb_simulation_number(simulation, "peak_memory_MB");
    const struct wb_json *const interface = wb_json_get(simulation, "interface");
    run->slip = wb_simulation_number(interface, "slip_mm") * WB_MM;
    run->slip_limit = wb_simulation_number(interface, "slip_limit_mm") * WB_MM;
    run->opening = wb_simulation_number(interface, "opening_mm") * WB_MM;
}

/* A point of the axis; the planar rod has no z. */
static void take_point(const struct wb_shape_row *row, double point[3])
{
    point[0] = row->x;
    point[1] = row->y;
    point[2] = isfinite(row->z) ? row->z : 0.0;
}

/* State and axis at the end of the history. */
static enum wb_status take_end(struct wb_wires_run *run, const struct wb_wire_model *model,
                               struct wb_reason *why)
{
    const struct wb_dataset *const dataset = &run->simulation.dataset;
    if (dataset->n_rows == 0 || dataset->n_shape_rows < 2)
        return wb_fail_to(why, WB_ERR_DATA, "it has no rows or no shapes");
    const struct wb_row *const last = &dataset->rows[dataset->n_rows - 1];
    size_t first = dataset->n_shape_rows;
    while (first > 0 && dataset->shape_rows[first - 1].t == last->t)
        first--;
    const size_t n = dataset->n_shape_rows - first;
    if (n < 2)
        return wb_fail_to(why, WB_ERR_DATA, "it has no shape of its last row");
    run->s = wb_memory_new(n, sizeof *run->s);
    run->shape = wb_memory_new(n, sizeof *run->shape);
    for (size_t i = 0; i < n; i++) {
        run->s[i] = dataset->shape_rows[first + i].s;
        take_point(&dataset->shape_rows[first + i], run->shape[i]);
    }
    run->n_shape = (int)n;
    memcpy(run->tip, run->shape[n - 1], sizeof run->tip);
    run->force = wb_wires_force(model);
    run->tip_angle = last->tip_angle;
    if (fabs(run->s[n - 1] - model->length) > 1e-6 * model->length)
        return wb_fail_to(why, WB_ERR_DATA, "its shapes end at %g mm, not at the wire's tip",
                          run->s[n - 1] / WB_MM);
    return WB_OK;
}

/* The row with which the step before the last one ended; -1 when the dataset does not say. */
static int row_before_loading(const struct wb_wires_run *run)
{
    const struct wb_json *const steps = wb_json_get(wb_simulation_of(&run->simulation), "steps");
    const size_t n = wb_json_length(steps);
    int64_t row = 1;
    if (n == 0 || (n > 1 && !wb_json_get_integer(wb_json_item(steps, n - 2), "last_row", &row)) ||
        row < 1 || row >= (int64_t)run->simulation.dataset.n_rows)
        return -1;
    return (int)row - 1;
}

/* Tips along the last step. Its rows stand at equal steps of the force when there are as many as
 * the model asks for; else the path was followed through a limit point. */
static void take_loading(struct wb_wires_run *run, const struct wb_wire_model *model)
{
    const struct wb_dataset *const dataset = &run->simulation.dataset;
    const int first = row_before_loading(run), rows = model->step[model->n_steps - 1].rows;
    if (first < 0 || first + 1 + rows != (int)dataset->n_rows)
        return;
    run->loading = wb_memory_new((size_t)rows + 1, sizeof *run->loading);
    run->loaded = wb_memory_new((size_t)rows + 1, sizeof *run->loaded);
    size_t at = 0;
    for (int i = 0; i <= rows; i++) {
        const double t = dataset->rows[first + i].t;
        while (at < dataset->n_shape_rows && dataset->shape_rows[at].t <= t)
            at++;
        if (at == 0 || dataset->shape_rows[at - 1].t != t)
            return;
        run->loading[i] = run->force * i / rows;
        take_point(&dataset->shape_rows[at - 1], run->loaded[i]);
    }
    run->n_loading = rows + 1;
}

/* Stored fields are continued from inside the elements and overshoot where the plastic zone begins:
 * no von Mises stress is reported that the node's own plastic strain does not allow. */
static void keep_to_law(struct wb_fields *fields, const struct wb_wire_model *model)
{
    for (int i = 0; i < fields->n; i++)
        for (int f = 0; f < fields->items[i].n_faces; f++) {
            struct wb_field_face *face = &fields->items[i].faces[f];
            if (face->part < 0 || face->part >= model->n_parts)
                continue;
            for (int k = 0; k < 8; k++)
                face->node[k].von_mises =
                    fmin(face->node[k].von_mises,
                         wb_material_flow_stress(&model->part[face->part].material,
                                                 face->node[k].plastic));
        }
}

/* A dataset while it is read. */
struct loading {
    struct wb_wires_run *run;
    const struct wb_wires_case *item;
    enum wb_wires_solver solver;
};

static enum wb_status take(void *context, struct wb_reason *why)
{
    const struct loading *const loading = context;
    const struct wb_wire_model *const model = loading->item->model;
    struct wb_wires_run *const run = loading->run;
    read_simulation(run);
    WB_TRY(take_end(run, model, why));
    take_loading(run, model);
    WB_TRY(wb_fields_read(&run->fields, loading->item->datasets[loading->solver].path, why));
    keep_to_law(&run->fields, model);
    return WB_OK;
}

void wb_wires_run_load(struct wb_wires_run *run, const struct wb_wires_case *item,
                       enum wb_wires_solver solver)
{
    struct loading loading = {run, item, solver};
    const struct wb_simulation_reader reader = {take, &loading};
    run->elements = run->unknowns = run->iterations = (double)NAN;
    run->memory_MB = run->slip = run->slip_limit = run->opening = (double)NAN;
    wb_simulation_load(&run->simulation, &item->datasets[solver], &reader);
}

void wb_wires_run_release(struct wb_wires_run *run)
{
    wb_simulation_result_release(&run->simulation);
    wb_fields_release(&run->fields);
    free(run->s);
    free(run->shape);
    free(run->loading);
    free(run->loaded);
    memset(run, 0, sizeof *run);
}

const struct wb_field *wb_wires_field(const struct wb_wires_run *run, const char *state, double x)
{
    return run ? wb_fields_find(&run->fields, state, x) : NULL;
}

/* --- comparing --- */

void wb_wires_axis_point(const struct wb_wires_run *run, double s, double point[3])
{
    /* The cubic (or less) through the nearest points. */
    const int n = run->n_shape < 4 ? run->n_shape : 4;
    int first = 0;
    while (first + n < run->n_shape && run->s[first + n / 2] < s)
        first++;
    point[0] = point[1] = point[2] = 0.0;
    for (int i = first; i < first + n; i++) {
        double weight = 1.0;
        for (int k = first; k < first + n; k++) {
            if (k != i)
                weight *= (s - run->s[k]) / (run->s[i] - run->s[k]);
        }
        for (int k = 0; k < 3; k++)
            point[k] += weight * run->shape[i][k];
    }
}

static double apart(const double a[3], const double b[3])
{
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

double wb_wires_distance_at(const struct wb_wires_run *run, double s, const double point[3])
{
    double own[3];
    wb_wires_axis_point(run, s, own);
    return apart(own, point);
}

double wb_wires_distance(const struct wb_wires_run *run, const struct wb_wires_run *other)
{
    double largest = 0.0;
    for (int i = 0; i < other->n_shape; i++)
        largest = fmax(largest, wb_wires_distance_at(run, other->s[i], other->shape[i]));
    return largest;
}

double wb_wires_rod_distance(const struct wb_wires_run *run, const struct wb_wires_rod *rod)
{
    double largest = 0.0;
    for (int i = 0; i < WB_WIRES_POINTS; i++) {
        const double point[3] = {rod->x[i], rod->y[i], 0.0};
        largest = fmax(largest, wb_wires_distance_at(run, rod->s[i], point));
    }
    return largest;
}

double wb_wires_tip_distance(const struct wb_wires_run *run, int row,
                             const struct wb_wires_run *other)
{
    const double force = run->loading[row];
    for (int i = 1; i < other->n_loading; i++) {
        const double low = other->loading[i - 1], high = other->loading[i];
        if (!(force >= low - 1e-9 * high && force <= high * (1.0 + 1e-9)))
            continue;
        const double part = (force - low) / (high - low);
        double tip[3];
        for (int k = 0; k < 3; k++)
            tip[k] =
                other->loaded[i - 1][k] + part * (other->loaded[i][k] - other->loaded[i - 1][k]);
        return apart(tip, run->loaded[row]);
    }
    return (double)NAN;
}

double wb_wires_effect(const struct wb_wires_run *run, const struct wb_wires_run *other)
{
    double largest = (double)NAN;
    for (int i = 0; i < run->n_loading; i++)
        largest = fmax(largest, wb_wires_tip_distance(run, i, other));
    return largest;
}
