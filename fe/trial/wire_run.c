#include "fe/trial/wire_run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/interpolate.h"
#include "base/memory.h"
#include "fe/trial/wire_run_private.h"

#define WB_LOG_DOMAIN "wire run"

enum {
    MAX_SHAPE = 1000
};

int wb_wire_run_planned_rows(const struct wb_wire_model *model)
{
    int rows = 1;
    for (int i = 0; i < model->n_steps; i++)
        rows += model->step[i].rows;
    return rows;
}

enum wb_status wb_wire_run_init(struct wb_wire_run *run, const struct wb_wire_model *model,
                                int n_shape)
{
    *run = (struct wb_wire_run){.converged = true};
    if (n_shape < 0 || n_shape == 1 || n_shape > MAX_SHAPE)
        return wb_fail(WB_ERR_ARGUMENT, "%d positions of a shape: expected none or 2 to %d",
                       n_shape, MAX_SHAPE);

    const size_t rows = (size_t)wb_wire_run_planned_rows(model) + WB_WIRE_RUN_SPARE;
    const size_t n = (size_t)n_shape;
    run->rows = wb_memory_new(rows, sizeof *run->rows);
    run->shape_s = wb_memory_new(n, sizeof *run->shape_s);
    run->shape = wb_memory_new((rows + 1) * n, sizeof *run->shape);
    run->axis = run->shape + rows * n;
    run->capacity = (int)rows;
    run->n_shape = n_shape;
    for (int i = 0; i < n_shape; i++)
        run->shape_s[i] = model->length * i / (n_shape - 1);
    return WB_OK;
}

void wb_wire_run_release(struct wb_wire_run *run)
{
    if (!run)
        return;
    free(run->rows);
    free(run->shape_s);
    free(run->shape);
    *run = (struct wb_wire_run){0};
}

/* The branch's phase is that of its step, also in rows with a slack strand. */
static int cycle_of(const struct wb_wire_run *run, const struct wb_wire_model *model, int step)
{
    if (run->n_rows == 0)
        return 1;
    const struct wb_wire_row *const before = &run->rows[run->n_rows - 1];
    const bool begins = model->step[before->step].unloads && !model->step[step].unloads;
    return before->cycle + (begins ? 1 : 0);
}

/* Updates the tip angle to the branch of atan2 nearest to its last value. */
static void turn_to(struct wb_wire_run *run, const double tangent[3])
{
    const double angle = atan2(tangent[1], tangent[0]);
    run->tip_angle = angle + 2.0 * M_PI * round((run->tip_angle - angle) / (2.0 * M_PI));
}

void wb_wire_run_add(struct wb_wire_run *run, const struct wb_wire_model *model,
                     const struct wb_wire_row *row, bool slack, const double (*shape)[3])
{
    if (run->n_rows >= run->capacity)
        return;

    struct wb_wire_row *const out = &run->rows[run->n_rows];
    *out = *row;
    out->cycle = cycle_of(run, model, row->step);
    out->phase = slack                            ? WB_PHASE_SLACK
                 : model->step[row->step].unloads ? WB_PHASE_UNLOAD
                                                  : WB_PHASE_LOAD;
    turn_to(run, row->tangent);
    out->tip_angle = run->tip_angle;
    /* A deflection as first step begins at zero with the weight applied. */
    if (run->n_rows == 0)
        run->zero_force =
            model->step[0].kind == WB_WIRE_STEP_DEFLECTION ? row->vertical_force : 0.0;
    out->force = wb_wire_model_is_follower(model) ? row->loads.follower[1]
                                                  : row->vertical_force - run->zero_force;
    if (run->n_shape > 0)
        memcpy(run->shape + (size_t)run->n_rows * (size_t)run->n_shape, shape,
               (size_t)run->n_shape * sizeof *shape);
    run->n_rows++;
}

struct wb_wire_target wb_wire_run_target(const struct wb_wire_step *step,
                                         const struct wb_wire_target *start, double share)
{
    struct wb_wire_target target = {
        .tip = wb_trial_loads_between(&start->tip, &step->loads, share),
        .tension = start->tension,
    };

    if (step->kind == WB_WIRE_STEP_RELEASE)
        target.tension = wb_interpolate(start->tension, 0.0, share);
    target.is_held = step->kind == WB_WIRE_STEP_DEFLECTION;
    if (target.is_held)
        target.deflection = wb_interpolate(start->deflection, step->deflection, share);
    return target;
}

bool wb_wire_run_end_increment(struct wb_wire_progress *p, const double tangent[3], double fraction,
                               int iterations)
{
    const double done = (p->run->n_rows + fraction) / wb_wire_run_planned_rows(p->model);
    const double of_step = (p->row - 1 + fraction) / p->model->step[p->step].rows;

    p->increments++;
    p->iterations += iterations;
    p->run->increments++;
    turn_to(p->run, tangent);
    return !p->observer || !p->observer->increment ||
           p->observer->increment(p->observer->context, p->run, p->step,
                                  fmin(fmax(of_step, 0.0), 1.0), iterations, fmin(1.0, done));
}

static bool has_deflection(const struct wb_wire_model *model)
{
    for (int i = 0; i < model->n_steps; i++) {
        if (model->step[i].kind == WB_WIRE_STEP_DEFLECTION)
            return true;
    }
    return false;
}

void wb_wire_run_set_forces(struct wb_wire_row *row, const struct wb_wire_model *model,
                            double tension, double vertical, const double frame[3][3])
{
    row->tension = tension;
    row->vertical_force = vertical;
    if (has_deflection(model))
        return;
    row->tension = row->loads.force[1];
    for (int i = 0; i < 3; i++)
        row->tension += row->loads.follower[i] * frame[i][1];
    row->vertical_force = row->tension;
}

void wb_wire_run_end_row(struct wb_wire_progress *p, struct wb_wire_row *row, bool slack)
{
    row->step = p->step;
    row->increments = p->increments;
    row->iterations = p->iterations;
    wb_wire_run_add(p->run, p->model, row, slack, (const double(*)[3])p->run->axis);
    p->increments = p->iterations = 0;
    if (p->observer && p->observer->row)
        p->status = p->observer->row(p->observer->context, p->run, row->fraction == 1.0);
}
