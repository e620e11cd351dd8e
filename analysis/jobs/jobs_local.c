#include "analysis/jobs/jobs_local.h"

#include <errno.h>
#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/interrupt.h"
#include "base/timing.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "jobs"

#define LOOK_NS (WB_NS_PER_S / 20)     /* between checks of the children */
#define PATIENCE_NS (10 * WB_NS_PER_S) /* time for a child to end after SIGTERM */

/* Runs at once: as requested, else the cores available to this process over the cores of a run. */
static int count_workers(const struct wb_jobs_plan *plan)
{
    cpu_set_t cores;
    if (plan->options->workers > 0)
        return plan->options->workers;
    const int n = sched_getaffinity(0, sizeof cores, &cores) == 0 ? CPU_COUNT(&cores) : 1;
    const int workers = n / plan->cores_per_job;
    return workers > 1 ? workers : 1;
}

/* --- one child --- */

/* Opens the log; its first line is the equivalent command. */
static int open_log(const struct wb_jobs_plan_item *item)
{
    struct wb_text line = {0};
    const int log = open(item->log, O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC, 0666);
    if (log < 0)
        return -1;
    wb_text_append(&line, "wirebench");
    for (const char *const *word = item->job->arguments; *word; word++) {
        wb_text_append(&line, " ");
        wb_text_append_quoted(&line, *word);
    }
    wb_text_append(&line, " -o ");
    wb_text_append_quoted(&line, item->partial);
    wb_text_append(&line, "\n");
    const ssize_t written = write(log, wb_text_string(&line), line.length);
    const bool whole = written == (ssize_t)line.length;
    wb_text_release(&line);
    if (whole)
        return log;
    close(log);
    return -1;
}

/* Executed in the child. */
__attribute__((noreturn)) static void run_child(const struct wb_jobs_plan_item *item, int cores,
                                                pid_t parent, int log)
{
    static const char lost[] = "cannot start the run\n";
    /* Its own process group: Ctrl-C reaches only this program, which ends its children in order. */
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    const int nothing = open("/dev/null", O_RDONLY);
    if (getppid() != parent || nothing < 0 || dup2(nothing, STDIN_FILENO) < 0 ||
        dup2(log, STDOUT_FILENO) < 0 || dup2(log, STDERR_FILENO) < 0)
        _exit(write(log, lost, sizeof lost - 1) < 0 ? 126 : 127);
    /* The child must not keep the parent's files open, above all its lock. */
    close_range(STDERR_FILENO + 1, ~0U, 0);
    wb_log_set_sink(NULL, NULL);
    const int code = item->job->run(item->job->context, item->partial, cores);
    fflush(stdout);
    _exit(code);
}

static enum wb_status start_child(struct wb_jobs_plan *plan, struct wb_jobs_plan_item *item)
{
    const int log = open_log(item);
    if (log < 0)
        return wb_fail(WB_ERR_IO, "cannot write '%s': %s", item->log, strerror(errno));
    fflush(NULL); /* otherwise both processes would write the buffered output */
    const pid_t parent = getpid(), child = fork();
    if (child == 0)
        run_child(item, plan->cores_per_job, parent, log);
    const int error = errno;
    close(log);
    if (child < 0)
        return wb_fail(WB_ERR_IO, "cannot start a process: %s", strerror(error));
    setpgid(child, child); /* set in both processes, as either may run first */
    item->pid = child;
    item->state = WB_JOBS_PLAN_RUNNING;
    item->started_ns = wb_time_now_ns();
    return WB_OK;
}

/* --- the end of a child --- */

static void describe(char *how, size_t size, int status, double seconds)
{
    char time[32];
    wb_jobs_plan_duration(time, seconds);
    if (WIFSIGNALED(status))
        snprintf(how, size, "ended by signal %d (%s) after %s", WTERMSIG(status),
                 strsignal(WTERMSIG(status)), time);
    else if (WEXITSTATUS(status) == 0)
        snprintf(how, size, "no dataset after %s", time);
    else
        snprintf(how, size, "exit code %d after %s", WEXITSTATUS(status), time);
}

static bool is_success(const struct wb_jobs_plan_item *item, int status)
{
    return WIFEXITED(status) && WEXITSTATUS(status) == 0 && wb_jobs_plan_is_partial_whole(item);
}

static void finish_item(struct wb_jobs_plan *plan, struct wb_jobs_plan_item *item, int status)
{
    char how[128];
    item->pid = 0;
    item->took_ns = wb_time_now_ns() - item->started_ns;
    if (is_success(item, status)) {
        if (wb_jobs_plan_accept(item) == WB_OK)
            item->state = WB_JOBS_PLAN_DONE;
        else
            wb_jobs_plan_fail(plan, item, "its folder could not be renamed", NULL);
        return;
    }
    describe(how, sizeof how, status, wb_seconds_from_ns(item->took_ns));
    wb_jobs_plan_fail(plan, item, how, NULL);
}

/* Collects the children that ended. Returns the number still running. */
static int collect_ended(struct wb_jobs_plan *plan)
{
    int running = 0;
    for (int i = 0; i < plan->n; i++) {
        struct wb_jobs_plan_item *const item = &plan->items[i];
        int status = 0;
        if (item->pid <= 0) /* a running item without a process is a Slurm task */
            continue;
        if (waitpid(item->pid, &status, WNOHANG) == item->pid)
            finish_item(plan, item, status);
        running += item->pid > 0;
    }
    return running;
}

static void signal_all(const struct wb_jobs_plan *plan, int signal_number)
{
    for (int i = 0; i < plan->n; i++)
        if (plan->items[i].pid > 0)
            kill(-plan->items[i].pid, signal_number);
}

/* Runs that were ended before they were complete count as not started. */
static int discard_interrupted(struct wb_jobs_plan *plan)
{
    int running = 0;
    for (int i = 0; i < plan->n; i++) {
        struct wb_jobs_plan_item *const item = &plan->items[i];
        int status = -1;
        if (item->pid <= 0)
            continue;
        if (waitpid(item->pid, &status, WNOHANG) == 0) {
            running++;
            continue;
        }
        if (is_success(item, status)) {
            finish_item(plan, item, status);
            continue;
        }
        item->pid = 0;
        item->state = WB_JOBS_PLAN_TODO;
        wb_jobs_plan_clean(item, false);
    }
    return running;
}

static void end_all(struct wb_jobs_plan *plan)
{
    const int64_t until_ns = wb_time_now_ns() + PATIENCE_NS;
    bool killed = false;
    signal_all(plan, SIGTERM);
    while (discard_interrupted(plan) > 0) {
        if (!killed && wb_time_now_ns() > until_ns) {
            signal_all(plan, SIGKILL);
            killed = true;
        }
        wb_time_sleep(wb_time_now_ns() + LOOK_NS);
    }
}

static struct wb_jobs_plan_item *next(struct wb_jobs_plan *plan)
{
    for (int i = 0; i < plan->n; i++)
        if (plan->items[i].state == WB_JOBS_PLAN_TODO && !plan->items[i].queued)
            return &plan->items[i];
    return NULL;
}

static void run_all(struct wb_jobs_plan *plan)
{
    const int workers = count_workers(plan);
    int64_t drawn_ns = 0;
    for (;;) {
        int running = collect_ended(plan);
        struct wb_jobs_plan_item *item;
        while (!wb_interrupted() && running < workers && (item = next(plan))) {
            if (start_child(plan, item) != WB_OK)
                wb_jobs_plan_fail(plan, item, "it could not be started", NULL);
            running += item->state == WB_JOBS_PLAN_RUNNING;
        }
        if (running == 0 || wb_interrupted())
            return;
        if (wb_time_now_ns() - drawn_ns > WB_NS_PER_S / 2) {
            wb_jobs_plan_draw(plan, workers, NULL);
            drawn_ns = wb_time_now_ns();
        }
        wb_time_sleep(wb_time_now_ns() + LOOK_NS);
    }
}

void wb_jobs_local_run(struct wb_jobs_plan *plan)
{
    signal(SIGCHLD,
           SIG_DFL); /* callers may ignore it, which would hide the exit status of children */
    run_all(plan);
    if (wb_interrupted())
        end_all(plan);
}
