#include "fe/trial/history.h"

#include <math.h>
#include <stdlib.h>

#define WB_LOG_DOMAIN "history"

enum {
    MOST_STEPS = 1000000,
    MOST_CYCLES = 100000,
    MOST_ROWS = 10000000,
    MOST_SHAPE = 1000
};

int wb_history_planned_rows(const struct wb_history_plan *plan)
{
    return 1 + plan->steps * (plan->cycles == 0 ? 1 : 2 * plan->cycles);
}

static enum wb_status check_plan(const struct wb_history_plan *plan)
{
    if (!isfinite(plan->maximum) || plan->maximum == 0.0)
        return wb_fail(WB_ERR_ARGUMENT, "largest value %g: expected a number other than 0",
                       plan->maximum);
    if (plan->steps < 1 || plan->steps > MOST_STEPS)
        return wb_fail(WB_ERR_ARGUMENT, "%d steps: expected 1 to %d", plan->steps, MOST_STEPS);
    if (plan->cycles < 0 || plan->cycles > MOST_CYCLES ||
        2.0 * plan->steps * plan->cycles > MOST_ROWS)
        return wb_fail(WB_ERR_ARGUMENT, "%d cycles of %d steps: expected at most %d rows in all",
                       plan->cycles, plan->steps, MOST_ROWS);
    if (plan->n_shape < 0 || plan->n_shape > MOST_SHAPE)
        return wb_fail(WB_ERR_ARGUMENT, "%d positions of a shape: expected 0 to %d", plan->n_shape,
                       MOST_SHAPE);
    return WB_OK;
}

enum wb_status wb_history_init(struct wb_history *history, const struct wb_history_plan *plan)
{
    *history = (struct wb_history){0};
    WB_TRY(check_plan(plan));

    const int rows = wb_history_planned_rows(plan);
    history->rows = calloc((size_t)rows, sizeof *history->rows);
    if (!history->rows)
        return wb_fail(WB_ERR_MEMORY, "no memory for %d rows", rows);
    history->capacity = rows;
    history->n_shape = plan->n_shape;
    if (plan->n_shape == 0)
        return WB_OK;

    const size_t positions = (size_t)rows * (size_t)plan->n_shape;
    history->shape_x = calloc(positions, sizeof *history->shape_x);
    history->shape_y = calloc(positions, sizeof *history->shape_y);
    if (!history->shape_x || !history->shape_y) {
        wb_history_release(history);
        return wb_fail(WB_ERR_MEMORY, "no memory for %d shapes", rows);
    }
    return WB_OK;
}

void wb_history_release(struct wb_history *history)
{
    if (!history)
        return;
    free(history->rows);
    free(history->shape_x);
    free(history->shape_y);
    *history = (struct wb_history){0};
}

/* True while the test is to go on. */
static bool goes_on(struct wb_history *history, const struct wb_history_plan *plan)
{
    if (history->converged && !history->stopped && plan->stop)
        history->stopped = plan->stop(plan->stop_context);
    return history->converged && !history->stopped;
}

static bool is_follower(const struct wb_history_plan *plan)
{
    return plan->control == WB_CONTROL_FOLLOWER_FORCE ||
           plan->control == WB_CONTROL_FOLLOWER_DEFLECTION;
}

/* Moves to step `index` of the way up and adds the row, if it gets there. */
static enum wb_status add_row(struct wb_history *history, const struct wb_history_plan *plan,
                              struct wb_cantilever *cantilever, int cycle, int index,
                              enum wb_phase phase)
{
    const double target =
        index == plan->steps ? plan->maximum : plan->maximum * index / plan->steps;
    struct wb_history_row *row = &history->rows[history->n_rows];

    WB_TRY(wb_cantilever_move(cantilever, plan->control, target, &history->end));
    if (history->end.end != WB_CANTILEVER_CONVERGED) {
        history->converged = false;
        return WB_OK;
    }
    row->point = history->end;
    const bool follows = is_follower(plan);
    if (history->n_rows == 0 && !follows)
        history->zero_force = row->point.vertical_force;
    row->cycle = cycle;
    row->phase = row->point.slack ? WB_PHASE_SLACK : phase;
    row->force = follows ? row->point.follower : row->point.vertical_force - history->zero_force;
    if (history->n_shape > 0) {
        const size_t at = (size_t)history->n_rows * (size_t)history->n_shape;
        wb_cantilever_shape(cantilever, history->n_shape, plan->shape_s, history->shape_x + at,
                            history->shape_y + at, NULL);
    }
    history->n_rows++;
    return WB_OK;
}

/* `steps` rows from one end to the other. */
static enum wb_status run_branch(struct wb_history *history, const struct wb_history_plan *plan,
                                 struct wb_cantilever *cantilever, int cycle, enum wb_phase phase)
{
    for (int i = 1; i <= plan->steps && goes_on(history, plan); i++) {
        const int index = phase == WB_PHASE_LOAD ? i : plan->steps - i;
        WB_TRY(add_row(history, plan, cantilever, cycle, index, phase));
    }
    return WB_OK;
}

enum wb_status wb_history_run(struct wb_history *history, const struct wb_history_plan *plan,
                              struct wb_cantilever *cantilever)
{
    WB_TRY(check_plan(plan));
    if (history->capacity < wb_history_planned_rows(plan) || history->n_shape != plan->n_shape)
        return wb_fail(WB_ERR_ARGUMENT, "the history was made for another plan");

    history->n_rows = 0;
    history->zero_force = 0.0;
    history->converged = true;
    history->stopped = false;
    if (goes_on(history, plan))
        WB_TRY(add_row(history, plan, cantilever, 1, 0, WB_PHASE_LOAD));

    const int cycles = plan->cycles == 0 ? 1 : plan->cycles;
    for (int cycle = 1; cycle <= cycles; cycle++) {
        WB_TRY(run_branch(history, plan, cantilever, cycle, WB_PHASE_LOAD));
        if (plan->cycles > 0)
            WB_TRY(run_branch(history, plan, cantilever, cycle, WB_PHASE_UNLOAD));
    }
    return WB_OK;
}
