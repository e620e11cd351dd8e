#include "analysis/jobs/jobs_slurm.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "analysis/jobs/jobs_array.h"
#include "analysis/jobs/jobs_queue.h"
#include "base/interrupt.h"
#include "base/json.h"
#include "base/timing.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "jobs"

static const double usual_interval = 10.0; /* s */
static const double first_interval = 1.0;  /* s: a short array is not made to wait */

/* --- what was submitted --- */

static enum wb_status memory_path(const struct wb_jobs_plan *plan, char path[WB_PATH])
{
    return wb_file_join(path, plan->folder, "slurm.json");
}

static int count_queued(const struct wb_jobs_plan *plan)
{
    int n = 0;
    for (int i = 0; i < plan->n; i++)
        n += plan->items[i].queued;
    return n;
}

/* Writes down what is queued; without any, nothing is left to remember. */
static enum wb_status remember(const struct wb_jobs_plan *plan)
{
    char path[WB_PATH], *text;
    WB_TRY(memory_path(plan, path));
    if (count_queued(plan) == 0) {
        unlink(path);
        return WB_OK;
    }
    struct wb_json *const root = wb_json_create();
    struct wb_json *const tasks = wb_json_set_array(root, "tasks");
    for (int i = 0; i < plan->n; i++) {
        const struct wb_jobs_plan_item *const item = &plan->items[i];
        if (!item->queued)
            continue;
        struct wb_json *const task = wb_json_append_object(tasks);
        wb_json_set_text(task, "output", item->output);
        wb_json_set_text(task, "array", item->array);
        wb_json_set_text(task, "cluster", item->cluster);
        wb_json_set_text(task, "list", item->list);
        wb_json_set_integer(task, "task", item->task);
    }
    enum wb_status status = wb_json_format(root, &text);
    wb_json_destroy(root);
    if (status != WB_OK)
        return status;
    status = wb_file_write(path, text, strlen(text));
    free(text);
    return status;
}

static void recall_task(struct wb_jobs_plan *plan, const struct wb_json *task)
{
    const char *output, *array, *cluster, *list;
    int64_t number;
    if (!wb_json_get_text(task, "output", &output) || !wb_json_get_text(task, "array", &array) ||
        !wb_json_get_text(task, "cluster", &cluster) || !wb_json_get_text(task, "list", &list) ||
        !wb_json_get_integer(task, "task", &number))
        return;
    for (int i = 0; i < plan->n; i++) {
        struct wb_jobs_plan_item *const item = &plan->items[i];
        if (item->state != WB_JOBS_PLAN_TODO || strcmp(item->output, output) != 0)
            continue;
        item->queued = true;
        item->task = (int)number;
        snprintf(item->array, sizeof item->array, "%s", array);
        snprintf(item->cluster, sizeof item->cluster, "%s", cluster);
        snprintf(item->list, sizeof item->list, "%s", list);
    }
}

static enum wb_status recall(struct wb_jobs_plan *plan, const char *path)
{
    struct wb_json *root;
    WB_TRY(wb_json_read(&root, path));
    const struct wb_json *const tasks = wb_json_get(root, "tasks");
    for (size_t i = 0; i < wb_json_length(tasks); i++)
        recall_task(plan, wb_json_item(tasks, i));
    wb_json_destroy(root);
    return WB_OK;
}

enum wb_status wb_jobs_slurm_find_queued(struct wb_jobs_plan *plan)
{
    char path[WB_PATH];
    struct wb_jobs_queue_look look;
    WB_TRY(memory_path(plan, path));
    if (!wb_file_exists(path))
        return WB_OK;
    WB_TRY(recall(plan, path));
    WB_TRY(wb_jobs_queue_look(plan, &look));
    if (look.lost)
        return wb_fail(WB_ERR_BUSY,
                       "runs were given to Slurm, and it cannot be asked for them: %s; try again, "
                       "or remove '%s' when they have surely ended",
                       look.problem, path);
    for (int i = 0; i < plan->n; i++)
        if (plan->items[i].ended_ns != 0)
            plan->items[i].queued = false;
    const int n = count_queued(plan);
    if (n > 0)
        wb_info("%d %s still with Slurm from an earlier call", n, n == 1 ? "run is" : "runs are");
    return WB_OK;
}

/* --- submitting --- */

static enum wb_status submit_missing(struct wb_jobs_plan *plan)
{
    char list[32];
    int missing = 0;
    for (int i = 0; i < plan->n; i++)
        missing += plan->items[i].state == WB_JOBS_PLAN_TODO && !plan->items[i].queued;
    if (missing == 0)
        return WB_OK;
    /* Asked for even in a dry run, where there may be none. */
    const int size = wb_jobs_queue_largest_task();
    WB_TRY(wb_jobs_array_write(plan, list));
    for (int first = 0; first < plan->n; first += size) {
        WB_TRY(wb_jobs_array_submit(plan, list, first,
                                    plan->n - first < size ? plan->n - first : size));
        if (!plan->options->dry_run)
            WB_TRY(remember(plan));
    }
    return WB_OK;
}

/* --- waiting and collecting --- */

struct waiting {
    double interval; /* s, now; grows to the one that was asked for */
    bool lost;       /* and that was said */
    char reason[64]; /* that was said */
};

static double longest_interval(const struct wb_jobs_plan *plan)
{
    return plan->options->poll_interval > 0.0 ? plan->options->poll_interval : usual_interval;
}

static void take(struct wb_jobs_plan_item *item)
{
    if (item->state == WB_JOBS_PLAN_RUNNING)
        item->took_ns = wb_time_now_ns() - item->started_ns;
    item->state = WB_JOBS_PLAN_DONE;
    item->queued = false;
}

static void give_up(struct wb_jobs_plan *plan, struct wb_jobs_plan_item *item)
{
    char how[192], name[128], folder[WB_PATH], out[WB_PATH];
    if (!item->ending[0])
        wb_jobs_queue_ask_ending(item);
    if (!item->ending[0])
        snprintf(how, sizeof how,
                 "Slurm's task %s_%d is gone and left no output, as when it is cancelled before it "
                 "begins",
                 item->array, item->task);
    else
        snprintf(how, sizeof how, "Slurm's task %s_%d is %s%s", item->array, item->task,
                 item->ending,
                 strcmp(item->ending, "COMPLETED") == 0 ? ", but its output is not there" : "");
    snprintf(name, sizeof name, "%s_%d.out", item->array, item->task);
    const bool has_out = wb_file_join(folder, plan->folder, item->list) == WB_OK &&
                         wb_file_join(out, folder, name) == WB_OK;
    item->queued = false;
    wb_jobs_plan_fail(plan, item, how, has_out ? out : NULL);
}

/* Files of another machine may take some time to be seen here; what Slurm says of a task that it
 * ended also comes a little later. */
static bool is_hopeless(const struct wb_jobs_plan *plan, const struct wb_jobs_plan_item *item)
{
    const bool may_come = !item->ending[0] || strcmp(item->ending, "COMPLETED") == 0;
    const double patience = (may_come ? 3.0 : 1.0) * longest_interval(plan);
    return item->ended_ns != 0 && wb_seconds_from_ns(wb_time_now_ns() - item->ended_ns) >= patience;
}

/* Whether anything changed. */
static bool collect(struct wb_jobs_plan *plan)
{
    const int before = count_queued(plan);
    for (int i = 0; i < plan->n; i++) {
        struct wb_jobs_plan_item *const item = &plan->items[i];
        if (!item->queued)
            continue;
        if (wb_jobs_plan_is_made(item))
            take(item);
        else if (is_hopeless(plan, item))
            give_up(plan, item);
    }
    return count_queued(plan) != before;
}

/* What has to be known while waiting, each once. */
static void tell(struct wb_jobs_plan *plan, struct waiting *waiting,
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

static void rest(double seconds)
{
    const int64_t until_ns = wb_time_now_ns() + wb_ns_from_seconds(seconds);
    while (!wb_interrupted() && wb_time_now_ns() < until_ns) {
        const int64_t left_ns = until_ns - wb_time_now_ns();
        /* In parts, as a signal may come just before the sleep. */
        const struct timespec part = {.tv_nsec = left_ns < WB_NS_PER_S / 4
                                                     ? (long)(left_ns > 0 ? left_ns : 0)
                                                     : (long)(WB_NS_PER_S / 4)};
        nanosleep(&part, NULL);
    }
}

static void say_who_goes_on(struct wb_jobs_plan *plan)
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
    wb_warn("stopped waiting; Slurm goes on with %d of the runs: the same command again collects "
            "them, `scancel%s` ends them",
            count_queued(plan), wb_text_string(&arrays));
    wb_text_release(&arrays);
}

static enum wb_status wait_for_all(struct wb_jobs_plan *plan)
{
    const double longest = longest_interval(plan);
    struct waiting waiting = {.interval = longest < first_interval ? longest : first_interval};
    while (count_queued(plan) > 0 && !wb_interrupted()) {
        struct wb_jobs_queue_look look;
        char note[96] = "";
        WB_TRY(wb_jobs_queue_look(plan, &look));
        tell(plan, &waiting, &look);
        if (collect(plan))
            WB_TRY(remember(plan));
        if (count_queued(plan) == 0)
            break;
        if (look.lost)
            snprintf(note, sizeof note, "Slurm does not answer");
        wb_jobs_plan_draw(plan, wb_jobs_plan_count(plan, WB_JOBS_PLAN_RUNNING),
                          note[0] ? note : NULL);
        rest(waiting.interval);
        waiting.interval = 1.5 * waiting.interval < longest ? 1.5 * waiting.interval : longest;
    }
    if (count_queued(plan) > 0)
        say_who_goes_on(plan);
    return WB_OK;
}

enum wb_status wb_jobs_slurm_run(struct wb_jobs_plan *plan)
{
    WB_TRY(submit_missing(plan));
    if (plan->options->dry_run)
        return WB_OK;
    WB_TRY(remember(plan));
    return wait_for_all(plan);
}
