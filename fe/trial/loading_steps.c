#include "fe/trial/loading_steps.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"

#define WB_LOG_DOMAIN "loading steps"

enum {
    MAX_STEPS = 1000000,
    MAX_CYCLES = 100000,
    MAX_ROWS = 10000000,
    MAX_SHAPE = 1000
};

int wb_loading_steps_planned_rows(const struct wb_loading_steps_plan *plan)
{
    return 1 + plan->steps * (plan->cycles == 0 ? 1 : 2 * plan->cycles);
}

static enum wb_status check_plan(const struct wb_loading_steps_plan *plan)
{
    if (!isfinite(plan->maximum) || plan->maximum == 0.0)
        return wb_fail(WB_ERR_ARGUMENT, "largest value %g: expected a number other than 0",
                       plan->maximum);
    if (plan->steps < 1 || plan->steps > MAX_STEPS)
        return wb_fail(WB_ERR_ARGUMENT, "%d steps: expected 1 to %d", plan->steps, MAX_STEPS);
    if (plan->cycles < 0 || plan->cycles > MAX_CYCLES ||
        2.0 * plan->steps * plan->cycles > MAX_ROWS)
        return wb_fail(WB_ERR_ARGUMENT, "%d cycles of %d steps: expected at most %d rows in all",
                       plan->cycles, plan->steps, MAX_ROWS);
    if (plan->n_shape < 0 || plan->n_shape > MAX_SHAPE)
        return wb_fail(WB_ERR_ARGUMENT, "%d positions of a shape: expected 0 to %d", plan->n_shape,
                       MAX_SHAPE);
    return WB_OK;
}

enum wb_status wb_loading_steps_init(struct wb_loading_steps *loading,
                                     const struct wb_loading_steps_plan *plan)
{
    *loading = (struct wb_loading_steps){0};
    WB_TRY(check_plan(plan));

    const int rows = wb_loading_steps_planned_rows(plan);
    const size_t positions = (size_t)rows * (size_t)plan->n_shape;
    loading->rows = wb_memory_new((size_t)rows, sizeof *loading->rows);
    loading->capacity = rows;
    loading->n_shape = plan->n_shape;
    loading->shape_x = wb_memory_new(positions, sizeof *loading->shape_x);
    loading->shape_y = wb_memory_new(positions, sizeof *loading->shape_y);
    return WB_OK;
}

void wb_loading_steps_release(struct wb_loading_steps *loading)
{
    if (!loading)
        return;
    free(loading->rows);
    free(loading->shape_x);
    free(loading->shape_y);
    *loading = (struct wb_loading_steps){0};
}

/* True while the test continues: converged and not stopped. */
static bool test_continues(struct wb_loading_steps *loading,
                           const struct wb_loading_steps_plan *plan)
{
    if (loading->converged && !loading->stopped && plan->stop)
        loading->stopped = plan->stop(plan->stop_context);
    return loading->converged && !loading->stopped;
}

static bool is_follower(const struct wb_loading_steps_plan *plan)
{
    return plan->control == WB_CONTROL_FOLLOWER_FORCE ||
           plan->control == WB_CONTROL_FOLLOWER_DEFLECTION;
}

/* Moves to loading step `index` (0 .. plan->steps) and adds a row if it converged. */
static enum wb_status add_row(struct wb_loading_steps *loading,
                              const struct wb_loading_steps_plan *plan,
                              struct wb_cantilever *cantilever, int cycle, int index,
                              enum wb_phase phase)
{
    const double target =
        index == plan->steps ? plan->maximum : plan->maximum * index / plan->steps;
    struct wb_loading_steps_row *row = &loading->rows[loading->n_rows];

    WB_TRY(wb_cantilever_move(cantilever, plan->control, target, &loading->end));
    if (loading->end.end != WB_CANTILEVER_CONVERGED) {
        loading->converged = false;
        return WB_OK;
    }
    row->point = loading->end;
    const bool follows = is_follower(plan);
    if (loading->n_rows == 0 && !follows)
        loading->zero_force = row->point.vertical_force;
    row->cycle = cycle;
    row->phase = row->point.slack ? WB_PHASE_SLACK : phase;
    row->force = follows ? row->point.follower : row->point.vertical_force - loading->zero_force;
    if (loading->n_shape > 0) {
        const size_t at = (size_t)loading->n_rows * (size_t)loading->n_shape;
        wb_cantilever_shape(cantilever, loading->n_shape, plan->shape_s, loading->shape_x + at,
                            loading->shape_y + at, NULL);
    }
    loading->n_rows++;
    return WB_OK;
}

/* `steps` rows from zero to the maximum or back. */
static enum wb_status run_branch(struct wb_loading_steps *loading,
                                 const struct wb_loading_steps_plan *plan,
                                 struct wb_cantilever *cantilever, int cycle, enum wb_phase phase)
{
    for (int i = 1; i <= plan->steps && test_continues(loading, plan); i++) {
        const int index = phase == WB_PHASE_LOAD ? i : plan->steps - i;
        WB_TRY(add_row(loading, plan, cantilever, cycle, index, phase));
    }
    return WB_OK;
}

enum wb_status wb_loading_steps_run(struct wb_loading_steps *loading,
                                    const struct wb_loading_steps_plan *plan,
                                    struct wb_cantilever *cantilever)
{
    WB_TRY(check_plan(plan));
    if (loading->capacity < wb_loading_steps_planned_rows(plan) ||
        loading->n_shape != plan->n_shape)
        return wb_fail(WB_ERR_ARGUMENT,
                       "loading allocated for %d rows and %d positions of a shape: expected at "
                       "least %d rows and exactly %d positions",
                       loading->capacity, loading->n_shape, wb_loading_steps_planned_rows(plan),
                       plan->n_shape);

    loading->n_rows = 0;
    loading->zero_force = 0.0;
    loading->converged = true;
    loading->stopped = false;
    if (test_continues(loading, plan))
        WB_TRY(add_row(loading, plan, cantilever, 1, 0, WB_PHASE_LOAD));

    const int cycles = plan->cycles == 0 ? 1 : plan->cycles;
    for (int cycle = 1; cycle <= cycles; cycle++) {
        WB_TRY(run_branch(loading, plan, cantilever, cycle, WB_PHASE_LOAD));
        if (plan->cycles > 0)
            WB_TRY(run_branch(loading, plan, cantilever, cycle, WB_PHASE_UNLOAD));
    }
    return WB_OK;
}
