#include "analysis/jobs/jobs_slurm.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "analysis/jobs/jobs_array.h"
#include "analysis/jobs/jobs_queue.h"
#include "base/interrupt.h"
#include "base/memory.h"
#include "base/timing.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "jobs"

static const double usual_interval = 10.0; /* s, between requests to the queue */
static const double first_interval = 1.0;  /* s: avoids a long wait for a short array */

static int count_queued(const struct wb_jobs_plan *plan)
{
    int n = 0;
    for (int i = 0; i < plan->n; i++)
        n += plan->items[i].queued;
    return n;
}

/* --- submitted runs: one file NAME.slurm for each run that was not collected --- */

static void submission_path(const struct wb_jobs_plan_item *item, char path[WB_PATH + 8])
{
    const char *const ending = strrchr(item->log, '.');
    snprintf(path, WB_PATH + 8, "%.*s.slurm", (int)(ending - item->log), item->log);
}

static enum wb_status save_submission(const struct wb_jobs_plan_item *item)
{
    char path[WB_PATH + 8], text[WB_PATH + 160];
    submission_path(item, path);
    const int n = snprintf(text, sizeof text, "%s %d %s %s\n%s\n", item->array, item->task,
                           item->list, item->cluster[0] ? item->cluster : "-", item->output);
    return wb_file_write(path, text, (size_t)n);
}

static void remove_submission(struct wb_jobs_plan_item *item)
{
    char path[WB_PATH + 8];
    submission_path(item, path);
    unlink(path);
    item->queued = false;
}

/* Marks an item as queued if there is a file of its name and output. */
static void load_submission(struct wb_jobs_plan_item *item)
{
    char path[WB_PATH + 8], output[WB_PATH] = "";
    submission_path(item, path);
    if (item->state != WB_JOBS_PLAN_TODO)
        remove_submission(item);
    FILE *const file = fopen(path, "r");
    if (!file)
        return;
    item->queued = fscanf(file, "%31s %d %31s %63[^\n]\n", item->array, &item->task, item->list,
                          item->cluster) == 4 &&
                   fgets(output, sizeof output, file) &&
                   strncmp(output, item->output, strlen(item->output)) == 0 &&
                   strcmp(output + strlen(item->output), "\n") == 0;
    fclose(file);
    if (strcmp(item->cluster, "-") == 0)
        item->cluster[0] = '\0';
}

enum wb_status wb_jobs_slurm_find_queued(struct wb_jobs_plan *plan)
{
    struct wb_jobs_queue_look look;
    for (int i = 0; i < plan->n; i++)
        load_submission(&plan->items[i]);
    WB_TRY(wb_jobs_queue_look(plan, &look));
    if (look.lost)
        return wb_fail(WB_ERR_BUSY,
                       "runs were submitted to Slurm, but their state cannot be determined: %s; "
                       "try again, or remove '%s/*.slurm' once they have certainly ended",
                       look.problem, plan->folder);
    for (int i = 0; i < plan->n; i++)
        if (plan->items[i].ended_ns != 0)
            remove_submission(&plan->items[i]);
    const int n = count_queued(plan);
    if (n > 0)
        wb_info("%d %s still in Slurm's queue from an earlier call", n,
                n == 1 ? "run is" : "runs are");
    return WB_OK;
}

/* --- submitting --- */

static enum wb_status submit_missing(const struct wb_jobs_plan *plan)
{
    struct wb_jobs_plan_item **const missing = wb_memory_new((size_t)plan->n, sizeof(void *));
    enum wb_status status = WB_OK;
    int n = 0;
    for (int i = 0; i < plan->n; i++)
        if (plan->items[i].state == WB_JOBS_PLAN_TODO && !plan->items[i].queued)
            missing[n++] = &plan->items[i];
    /* Checked even in a dry run, for which Slurm may be missing. */
    const int size = n > 0 ? wb_jobs_queue_largest_task() : 1;
    for (int first = 0; first < n && status == WB_OK; first += size) {
        const int end = n - first < size ? n : first + size;
        status = wb_jobs_array_submit(plan, missing + first, end - first);
        for (int k = first; k < end && status == WB_OK && !plan->options->dry_run; k++)
            status = save_submission(missing[k]);
    }
    free(missing);
    return status;
}

/* --- waiting and collecting --- */

struct waiting {
    double interval; /* s, current; grows to the requested one */
    bool lost;       /* Slurm does not answer, and that was reported */
    char reason[64]; /* last reported one */
};

static double longest_interval(const struct wb_jobs_plan *plan)
{
    return plan->options->poll_interval > 0.0 ? plan->options->poll_interval : usual_interval;
}

static void collect_output(struct wb_jobs_plan_item *item)
{
    if (item->state == WB_JOBS_PLAN_RUNNING)
        item->took_ns = wb_time_now_ns() - item->started_ns;
    item->state = WB_JOBS_PLAN_DONE;
    remove_submission(item);
}

static void fail_lost(struct wb_jobs_plan *plan, struct wb_jobs_plan_item *item)
{
    char how[192], task[64], out[2 * WB_PATH];
    wb_jobs_queue_task(item, task);
    if (!item->ending[0])
        wb_jobs_queue_ask_ending(item);
    if (!item->ending[0])
        snprintf(how, sizeof how,
                 "Slurm's task %s is gone and has no output: it may have been cancelled before it "
                 "started",
                 task);
    else
        snprintf(how, sizeof how, "Slurm's task %s is %s%s", task, item->ending,
                 strcmp(item->ending, "COMPLETED") == 0 ? ", but its output is missing" : "");
    snprintf(out, sizeof out, "%s/%s/%s.out", plan->folder, item->list, task);
    remove_submission(item);
    wb_jobs_plan_fail(plan, item, how, out);
}

/* Files of another machine may appear here with a delay, and so does the reason that Slurm gives
 * for ending a task. */
static bool is_lost(const struct wb_jobs_plan *plan, const struct wb_jobs_plan_item *item)
{
    const bool may_come = !item->ending[0] || strcmp(item->ending, "COMPLETED") == 0;
    const double patience = (may_come ? 3.0 : 1.0) * longest_interval(plan);
    return item->ended_ns != 0 && wb_seconds_from_ns(wb_time_now_ns() - item->ended_ns) >= patience;
}

static void collect(struct wb_jobs_plan *plan)
{
    for (int i = 0; i < plan->n; i++) {
        struct wb_jobs_plan_item *const item = &plan->items[i];
        if (!item->queued)
            continue;
        if (wb_jobs_plan_is_made(item))
            collect_output(item);
        else if (is_lost(plan, item))
            fail_lost(plan, item);
    }
}

/* Reports events of the wait, each once. */
static void report_events(struct wb_jobs_plan *plan, struct waiting *waiting,
                          const struct wb_jobs_queue_look *look)
{
    if (look->lost != waiting->lost) {
        wb_jobs_plan_clear(plan);
        if (look->lost)
            wb_warn("Slurm does not answer, still waiting: %s", look->problem);
        else
            wb_info("Slurm answers again");
        waiting->lost = look->lost;
    }
    if (look->reason[0] && strcmp(look->reason, waiting->reason) != 0) {
        wb_jobs_plan_clear(plan);
        wb_warn("tasks wait in Slurm's queue: %s", look->reason);
        snprintf(waiting->reason, sizeof waiting->reason, "%s", look->reason);
    }
}

/* Sleeps in short intervals, as a signal may arrive just before a sleep. */
static void wait_interruptibly(double seconds)
{
    const int64_t until_ns = wb_time_now_ns() + wb_ns_from_seconds(seconds);
    for (int64_t now_ns; !wb_interrupted() && (now_ns = wb_time_now_ns()) < until_ns;) {
        const int64_t part_ns = now_ns + WB_NS_PER_S / 4;
        wb_time_sleep(part_ns < until_ns ? part_ns : until_ns);
    }
}

static void report_remaining(struct wb_jobs_plan *plan)
{
    struct wb_text arrays = {0};
    const char *last = "";
    for (int i = 0; i < plan->n; i++) {
        const struct wb_jobs_plan_item *const item = &plan->items[i];
        if (!item->queued || strcmp(item->array, last) == 0)
            continue;
        wb_text_append(&arrays, " %s", item->array);
        last = item->array;
    }
    wb_jobs_plan_clear(plan);
    wb_warn(
        "stopped waiting; Slurm continues %d of the runs: run the same command again to collect "
        "them, or end them with `scancel%s`",
        count_queued(plan), wb_text_string(&arrays));
    wb_text_release(&arrays);
}

enum wb_status wb_jobs_slurm_run(struct wb_jobs_plan *plan)
{
    const double longest = longest_interval(plan);
    struct waiting waiting = {.interval = longest < first_interval ? longest : first_interval};
    WB_TRY(submit_missing(plan));
    while (count_queued(plan) > 0 && !wb_interrupted()) {
        struct wb_jobs_queue_look look;
        WB_TRY(wb_jobs_queue_look(plan, &look));
        report_events(plan, &waiting, &look);
        collect(plan);
        if (count_queued(plan) == 0)
            break;
        wb_jobs_plan_draw(plan, wb_jobs_plan_count(plan, WB_JOBS_PLAN_RUNNING),
                          look.lost ? "Slurm does not answer" : NULL);
        wait_interruptibly(waiting.interval);
        waiting.interval = 1.5 * waiting.interval < longest ? 1.5 * waiting.interval : longest;
    }
    if (count_queued(plan) > 0)
        report_remaining(plan);
    return WB_OK;
}
