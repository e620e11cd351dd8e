#include "analysis/jobs/jobs.h"

#include <stdlib.h>

#include "analysis/jobs/jobs_local.h"
#include "analysis/jobs/jobs_plan.h"
#include "analysis/jobs/jobs_slurm.h"
#include "base/interrupt.h"

#define WB_LOG_DOMAIN "jobs"

bool wb_jobs_wanted(const struct wb_jobs_options *options)
{
    return options->where != WB_JOBS_NOWHERE;
}

void wb_jobs_options_release(struct wb_jobs_options *options)
{
    free(options->extra);
    options->extra = NULL;
    options->n_extra = 0;
}

/* --- running --- */

/* Removes what unfinished runs left, except for runs that Slurm still executes. */
static void clean_up(struct wb_jobs_plan *plan)
{
    for (int i = 0; i < plan->n; i++) {
        struct wb_jobs_plan_item *const item = &plan->items[i];
        if (item->state == WB_JOBS_PLAN_TODO && !item->queued &&
            !wb_jobs_plan_is_blocked(plan, item))
            wb_jobs_plan_clean(item, false);
    }
}

static enum wb_status run(struct wb_jobs_plan *plan)
{
    enum wb_status status = wb_jobs_slurm_find_queued(plan);
    if (status != WB_OK)
        return status;
    clean_up(plan);
    if (plan->options->where == WB_JOBS_SLURM)
        status = wb_jobs_slurm_run(plan);
    else
        wb_jobs_local_run(plan);
    wb_jobs_plan_clear(plan);
    return status;
}

static void sum_up(struct wb_jobs_outcome *outcome, const struct wb_jobs_plan *plan)
{
    *outcome = (struct wb_jobs_outcome){
        .present = wb_jobs_plan_count(plan, WB_JOBS_PLAN_PRESENT),
        .done = wb_jobs_plan_count(plan, WB_JOBS_PLAN_DONE),
        .failed = wb_jobs_plan_count(plan, WB_JOBS_PLAN_FAILED),
        .left = wb_jobs_plan_count(plan, WB_JOBS_PLAN_TODO) +
                wb_jobs_plan_count(plan, WB_JOBS_PLAN_RUNNING),
        .interrupted = wb_interrupted(),
    };
}

static enum wb_status run_locked(struct wb_jobs_outcome *outcome, struct wb_jobs_plan *plan)
{
    char path[WB_PATH];
    struct wb_file_lock lock;
    long holder = 0;
    WB_TRY(wb_file_join(path, plan->folder, "lock"));
    enum wb_status status = wb_file_lock(&lock, path, &holder);
    if (status == WB_ERR_BUSY)
        return wb_fail(WB_ERR_BUSY, "the runs of '%s' are already in progress in process %ld",
                       plan->folder, holder);
    if (status != WB_OK)
        return status;
    status = run(plan);
    if (status == WB_OK)
        sum_up(outcome, plan);
    wb_file_unlock(&lock);
    return status;
}

enum wb_status wb_jobs_run(struct wb_jobs_outcome *outcome, const struct wb_job *jobs, int n,
                           const struct wb_jobs_options *options)
{
    struct wb_jobs_plan plan;
    WB_TRY(wb_jobs_plan_init(&plan, jobs, n, options));
    const enum wb_status status = run_locked(outcome, &plan);
    wb_jobs_plan_release(&plan);
    return status;
}
