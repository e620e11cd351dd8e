#include "analysis/jobs/jobs_queue.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/number.h"
#include "base/timing.h"

#define WB_LOG_DOMAIN "jobs"

static const double answer_time = 60.0; /* s; a busy controller takes its time */

/* --- lines of squeue --- */

static bool is_one_of(const char *word, const char *const *list)
{
    for (; *list; list++)
        if (strcmp(word, *list) == 0)
            return true;
    return false;
}

static bool has_ended(const char *state)
{
    static const char *const endings[] = {
        "COMPLETED", "FAILED",        "CANCELLED",     "TIMEOUT", "NODE_FAIL",
        "BOOT_FAIL", "OUT_OF_MEMORY", "DEADLINE",      "REVOKED", "PREEMPTED",
        "STOPPED",   "SPECIAL_EXIT",  "LAUNCH_FAILED", NULL};
    return is_one_of(state, endings);
}

/* Why a task waits when it only needs its turn. */
static bool is_patient(const char *reason)
{
    static const char *const usual[] = {"None",      "Resources", "Priority", "JobArrayTaskLimit",
                                        "BeginTime", "Cleaning",  "Prolog",   NULL};
    return is_one_of(reason, usual);
}

/* Clusters number their arrays each for itself. */
static bool are_of_one_array(const struct wb_jobs_plan_item *a, const struct wb_jobs_plan_item *b)
{
    return strcmp(a->array, b->array) == 0 && strcmp(a->cluster, b->cluster) == 0;
}

/* The item of "12_3" among those of one item's array. */
static struct wb_jobs_plan_item *find(struct wb_jobs_plan *plan,
                                      const struct wb_jobs_plan_item *one, const char *task)
{
    const size_t n = strlen(one->array);
    long number;
    if (strncmp(task, one->array, n) != 0 || task[n] != '_' ||
        !wb_number_parse_integer(task + n + 1, &number))
        return NULL;
    for (int i = 0; i < plan->n; i++) {
        struct wb_jobs_plan_item *const item = &plan->items[i];
        if (item->queued && item->task == number && are_of_one_array(item, one))
            return item;
    }
    return NULL;
}

static void note_ended(struct wb_jobs_plan_item *item, const char *state)
{
    if (item->ended_ns == 0)
        item->ended_ns = wb_time_now_ns();
    if (state[0])
        snprintf(item->ending, sizeof item->ending, "%s", state);
}

static void note_live(struct wb_jobs_plan_item *item, bool waits)
{
    item->ended_ns = 0; /* one that was put into the queue again */
    item->ending[0] = '\0';
    if (waits) {
        item->state = WB_JOBS_PLAN_TODO;
        return;
    }
    if (item->state != WB_JOBS_PLAN_RUNNING)
        item->started_ns = wb_time_now_ns();
    item->state = WB_JOBS_PLAN_RUNNING;
}

/* One line, "12_3|PENDING|Resources|/path/of/the/script". */
static void take_line(struct wb_jobs_plan *plan, const struct wb_jobs_plan_item *one, char *line,
                      bool *seen, struct wb_jobs_queue_look *look)
{
    char *const state = strchr(line, '|');
    char *const reason = state ? strchr(state + 1, '|') : NULL;
    char *const command = reason ? strchr(reason + 1, '|') : NULL;
    if (!command)
        return;
    *state = *reason = *command = '\0';
    struct wb_jobs_plan_item *const item = find(plan, one, line);
    /* Numbers begin anew when a cluster is set up again: then the task is somebody else's. */
    if (!item || strncmp(command + 1, plan->folder, strlen(plan->folder)) != 0)
        return;
    seen[item - plan->items] = true;
    const bool waits = strcmp(state + 1, "PENDING") == 0;
    if (has_ended(state + 1))
        note_ended(item, state + 1);
    else
        note_live(item, waits);
    if (waits && !is_patient(reason + 1))
        snprintf(look->reason, sizeof look->reason, "%s", reason + 1);
}

static void take_lines(struct wb_jobs_plan *plan, const struct wb_jobs_plan_item *one, char *text,
                       struct wb_jobs_queue_look *look, bool *seen)
{
    char *rest = NULL;
    for (char *line = text ? strtok_r(text, "\n", &rest) : NULL; line;
         line = strtok_r(NULL, "\n", &rest))
        take_line(plan, one, line, seen, look);
    for (int i = 0; i < plan->n; i++) {
        struct wb_jobs_plan_item *const item = &plan->items[i];
        if (item->queued && !seen[i] && are_of_one_array(item, one))
            note_ended(item, "");
    }
}

/* --- questions --- */

static void note_lost(struct wb_jobs_queue_look *look, const char *said)
{
    look->lost = true;
    snprintf(look->problem, sizeof look->problem, "%.*s", (int)strcspn(said, "\n"), said);
}

static enum wb_status look_at(struct wb_jobs_plan *plan, const struct wb_jobs_plan_item *one,
                              struct wb_jobs_queue_look *look, bool *seen)
{
    char jobs[64], cluster[80];
    snprintf(jobs, sizeof jobs, "--jobs=%s", one->array);
    snprintf(cluster, sizeof cluster, "--clusters=%s", one->cluster);
    const char *const words[] = {"squeue",
                                 "--noheader",
                                 "--array",
                                 "--states=all",
                                 jobs,
                                 "--format=%i|%T|%r|%o",
                                 one->cluster[0] ? cluster : NULL,
                                 NULL};
    struct wb_program_answer answer;
    const enum wb_status status = wb_program_run(&answer, words, answer_time);
    if (status == WB_ERR_NOT_FOUND)
        note_lost(look, "there is no squeue in PATH");
    else if (status == WB_ERR_TIMEOUT)
        note_lost(look, "squeue did not end");
    if (status != WB_OK)
        return status == WB_ERR_NOT_FOUND || status == WB_ERR_TIMEOUT ? WB_OK : status;
    const bool unknown = strstr(wb_text_string(&answer.err), "Invalid job id") != NULL;
    if (answer.out.failed)
        note_lost(look, "out of memory");
    else if (answer.code == 0 || unknown)
        take_lines(plan, one, answer.out.bytes, look, seen);
    else
        note_lost(look, wb_text_string(&answer.err));
    wb_program_answer_release(&answer);
    return WB_OK;
}

/* Whether an item before this one is of the same array, which was asked for already. */
static bool was_asked(const struct wb_jobs_plan *plan, int index)
{
    for (int i = 0; i < index; i++)
        if (plan->items[i].queued && are_of_one_array(&plan->items[i], &plan->items[index]))
            return true;
    return false;
}

enum wb_status wb_jobs_queue_look(struct wb_jobs_plan *plan, struct wb_jobs_queue_look *look)
{
    enum wb_status status = WB_OK;
    *look = (struct wb_jobs_queue_look){0};
    bool *const seen = calloc((size_t)plan->n + 1, sizeof *seen);
    if (!seen)
        return wb_fail(WB_ERR_MEMORY, "out of memory");
    for (int i = 0; i < plan->n && status == WB_OK && !look->lost; i++)
        if (plan->items[i].queued && !was_asked(plan, i))
            status = look_at(plan, &plan->items[i], look, seen);
    free(seen);
    return status;
}

void wb_jobs_queue_ask_ending(struct wb_jobs_plan_item *item)
{
    char job[64], cluster[80], state[64] = "";
    snprintf(job, sizeof job, "--jobs=%s_%d", item->array, item->task);
    snprintf(cluster, sizeof cluster, "--clusters=%s", item->cluster);
    const char *const words[] = {"sacct",
                                 "--noheader",
                                 "--parsable2",
                                 "--allocations",
                                 job,
                                 "--format=State",
                                 item->cluster[0] ? cluster : NULL,
                                 NULL};
    struct wb_program_answer answer;
    const enum wb_log_level before = wb_log_set_gravest(WB_LOG_DEBUG);
    const enum wb_status status = wb_program_run(&answer, words, answer_time);
    wb_log_set_gravest(before);
    if (status != WB_OK)
        return;
    /* "CANCELLED by 1000" */
    if (answer.code == 0 && sscanf(wb_text_string(&answer.out), "%63[A-Z_]", state) == 1 &&
        has_ended(state))
        snprintf(item->ending, sizeof item->ending, "%s", state);
    wb_program_answer_release(&answer);
}

int wb_jobs_queue_largest_task(void)
{
    static const char *const words[] = {"scontrol", "show", "config", NULL};
    struct wb_program_answer answer;
    int size = 1001; /* Slurm's own default */
    if (wb_program_run(&answer, words, answer_time) != WB_OK)
        return size - 1;
    const char *const line = strstr(wb_text_string(&answer.out), "MaxArraySize");
    if (!line || sscanf(line, "MaxArraySize = %d", &size) != 1 || size < 2)
        size = 1001;
    wb_program_answer_release(&answer);
    return size - 1;
}
