#include "analysis/jobs/jobs_queue.h"

#include <stdio.h>
#include <string.h>

#include "base/timing.h"

#define WB_LOG_DOMAIN "jobs"

static const double answer_time = 60.0; /* s; a busy controller may be slow */

/* Final states of a task, each between spaces. */
static const char endings[] =
    " COMPLETED FAILED CANCELLED TIMEOUT NODE_FAIL BOOT_FAIL OUT_OF_MEMORY "
    "DEADLINE REVOKED PREEMPTED STOPPED SPECIAL_EXIT LAUNCH_FAILED ";
/* Reasons of tasks that only wait for their turn. */
static const char usual_reasons[] = " None Resources Priority JobArrayTaskLimit BeginTime Cleaning "
                                    "Prolog ";

static bool is_one_of(const char *word, const char *list)
{
    char padded[80];
    snprintf(padded, sizeof padded, " %s ", word);
    return strstr(list, padded) != NULL;
}

/* Each cluster numbers its arrays separately. */
static bool are_of_one_array(const struct wb_jobs_plan_item *a, const struct wb_jobs_plan_item *b)
{
    return a->queued && b->queued && strcmp(a->array, b->array) == 0 &&
           strcmp(a->cluster, b->cluster) == 0;
}

void wb_jobs_queue_task(const struct wb_jobs_plan_item *item, char task[64])
{
    snprintf(task, 64, "%s_%d", item->array, item->task);
}

static void set_ended(struct wb_jobs_plan_item *item, const char *state)
{
    if (item->ended_ns == 0)
        item->ended_ns = wb_time_now_ns();
    if (state[0])
        snprintf(item->ending, sizeof item->ending, "%s", state);
}

static void set_live(struct wb_jobs_plan_item *item, bool waits)
{
    item->ended_ns = 0; /* may be a task that was requeued */
    item->ending[0] = '\0';
    if (!waits && item->state != WB_JOBS_PLAN_RUNNING)
        item->started_ns = wb_time_now_ns();
    item->state = waits ? WB_JOBS_PLAN_TODO : WB_JOBS_PLAN_RUNNING;
}

/* Parses one line, "12_3|PENDING|Resources|/path/of/the/script". */
static void read_line(struct wb_jobs_plan *plan, const struct wb_jobs_plan_item *one, char *line,
                      struct wb_jobs_queue_look *look)
{
    char task[64];
    const char *const id = strsep(&line, "|"), *const state = strsep(&line, "|"),
                      *const reason = strsep(&line, "|");
    /* Numbers restart when a cluster is set up again: then the task belongs to another array. */
    if (!line || strncmp(line, plan->folder, strlen(plan->folder)) != 0)
        return;
    for (int i = 0; i < plan->n; i++) {
        struct wb_jobs_plan_item *const item = &plan->items[i];
        wb_jobs_queue_task(item, task);
        if (!are_of_one_array(item, one) || strcmp(id, task) != 0)
            continue;
        const bool waits = strcmp(state, "PENDING") == 0;
        item->seen = true;
        if (is_one_of(state, endings))
            set_ended(item, state);
        else
            set_live(item, waits);
        if (waits && !is_one_of(reason, usual_reasons))
            snprintf(look->reason, sizeof look->reason, "%s", reason);
    }
}

/* Runs squeue or sacct for the job of an item, on its cluster. */
static enum wb_status ask(struct wb_program_answer *answer, const char *const program[4],
                          const char *job, const struct wb_jobs_plan_item *item)
{
    const char *const words[] = {
        program[0],    program[1], program[2], program[3],
        "--noheader",  "--jobs",   job,        item->cluster[0] ? "--clusters" : NULL,
        item->cluster, NULL};
    return wb_program_run(answer, words, answer_time);
}

static void set_lost(struct wb_jobs_queue_look *look, const char *said)
{
    look->lost = true;
    snprintf(look->problem, sizeof look->problem, "%.*s", (int)strcspn(said, "\n"), said);
}

static enum wb_status look_at(struct wb_jobs_plan *plan, const struct wb_jobs_plan_item *one,
                              struct wb_jobs_queue_look *look)
{
    static const char *const squeue[] = {"squeue", "--array", "--states=all",
                                         "--format=%i|%T|%r|%o"};
    struct wb_program_answer answer;
    const enum wb_status status = ask(&answer, squeue, one->array, one);
    if (status == WB_ERR_NOT_FOUND)
        set_lost(look, "no squeue in PATH");
    else if (status == WB_ERR_TIMEOUT)
        set_lost(look, "squeue did not end");
    if (status != WB_OK)
        return look->lost ? WB_OK : status;
    const char *const said = wb_text_string(&answer.err);
    if (answer.code != 0 && !strstr(said, "Invalid job id"))
        set_lost(look, said);
    char *rest = answer.out.bytes, *line;
    while (!look->lost && (line = strsep(&rest, "\n")))
        read_line(plan, one, line, look);
    for (int i = 0; i < plan->n && !look->lost; i++) {
        struct wb_jobs_plan_item *const item = &plan->items[i];
        if (are_of_one_array(item, one) && !item->seen)
            set_ended(item, "");
        item->seen = item->seen || are_of_one_array(item, one);
    }
    wb_program_answer_release(&answer);
    return WB_OK;
}

enum wb_status wb_jobs_queue_look(struct wb_jobs_plan *plan, struct wb_jobs_queue_look *look)
{
    *look = (struct wb_jobs_queue_look){0};
    for (int i = 0; i < plan->n; i++)
        plan->items[i].seen = false;
    /* One request for each array. */
    for (int i = 0; i < plan->n && !look->lost; i++)
        if (plan->items[i].queued && !plan->items[i].seen)
            WB_TRY(look_at(plan, &plan->items[i], look));
    return WB_OK;
}

void wb_jobs_queue_ask_ending(struct wb_jobs_plan_item *item)
{
    static const char *const sacct[] = {"sacct", "--parsable2", "--allocations", "--format=State"};
    char task[64], state[64] = "";
    struct wb_program_answer answer;
    wb_jobs_queue_task(item, task);
    const enum wb_log_level before = wb_log_set_gravest(WB_LOG_DEBUG);
    const enum wb_status status = ask(&answer, sacct, task, item);
    wb_log_set_gravest(before);
    if (status != WB_OK)
        return;
    /* "CANCELLED by 1000" */
    if (answer.code == 0 && sscanf(wb_text_string(&answer.out), "%63[A-Z_]", state) == 1 &&
        is_one_of(state, endings))
        snprintf(item->ending, sizeof item->ending, "%s", state);
    wb_program_answer_release(&answer);
}

int wb_jobs_queue_largest_task(void)
{
    static const char *const words[] = {"scontrol", "show", "config", NULL};
    struct wb_program_answer answer;
    int size = 1001; /* Slurm's own default */
    if (wb_program_run(&answer, words, answer_time) == WB_OK) {
        const char *const line = strstr(wb_text_string(&answer.out), "MaxArraySize");
        if (!line || sscanf(line, "MaxArraySize = %d", &size) != 1 || size < 2)
            size = 1001;
        wb_program_answer_release(&answer);
    }
    return size - 1;
}
