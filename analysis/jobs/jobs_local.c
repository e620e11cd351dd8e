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
#include <time.h>
#include <unistd.h>

#include "base/interrupt.h"
#include "base/progress.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "jobs"

enum {
    LOOK_MS = 50,           /* between looks at the children */
    PATIENCE_MS = 10 * 1000 /* for a child to end after SIGTERM */
};

extern char **environ;

/* What every child gets; made before any fork(), after which memory must not be taken. */
struct setting {
    const char *program;
    char **environment; /* owned array; the texts are the process's or below */
    char threads[2][48];
};

/* Runs at once: as asked for, else cores that this process may use over cores of a run. */
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

static bool is_thread_count(const char *variable)
{
    return strncmp(variable, "OMP_NUM_THREADS=", 16) == 0 ||
           strncmp(variable, "OPENBLAS_NUM_THREADS=", 21) == 0;
}

/* The environment, with the threads of a run: several runs that each took all cores would only be
 * in each other's way. */
static enum wb_status init_setting(struct setting *setting, const struct wb_jobs_plan *plan)
{
    size_t n = 0, kept = 0;
    while (environ[n])
        n++;
    /* Also when the file of this binary was replaced meanwhile. */
    setting->program = plan->options->program ? plan->options->program : "/proc/self/exe";
    setting->environment = calloc(n + 3, sizeof(char *));
    if (!setting->environment)
        return wb_fail(WB_ERR_MEMORY, "out of memory");
    for (size_t i = 0; i < n; i++)
        if (!is_thread_count(environ[i]))
            setting->environment[kept++] = environ[i];
    snprintf(setting->threads[0], sizeof setting->threads[0], "OMP_NUM_THREADS=%d",
             plan->cores_per_job);
    snprintf(setting->threads[1], sizeof setting->threads[1], "OPENBLAS_NUM_THREADS=%d",
             plan->cores_per_job);
    setting->environment[kept++] = setting->threads[0];
    setting->environment[kept] = setting->threads[1];
    return WB_OK;
}

/* wirebench ARGUMENTS -o PARTIAL; the array is the caller's. */
static const char **command_line(const struct wb_jobs_plan_item *item, const char *partial)
{
    size_t n = 0, k = 0;
    while (item->job->arguments[n])
        n++;
    const char **const words = calloc(n + 4, sizeof *words);
    if (!words)
        return NULL;
    words[k++] = "wirebench";
    for (size_t i = 0; i < n; i++)
        words[k++] = item->job->arguments[i];
    words[k++] = "-o";
    words[k] = partial;
    return words;
}

/* Opens the log; its first line is the command. */
static int open_log(const struct wb_jobs_plan_item *item, const char *const *words)
{
    struct wb_text line = {0};
    const int log = open(item->log, O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC, 0666);
    if (log < 0)
        return -1;
    for (const char *const *word = words; *word; word++) {
        wb_text_append(&line, word == words ? "" : " ");
        wb_jobs_plan_quote(&line, *word);
    }
    wb_text_append(&line, "\n");
    const ssize_t written = write(log, wb_text_string(&line), line.length);
    const bool whole = !line.failed && written == (ssize_t)line.length;
    wb_text_release(&line);
    if (whole)
        return log;
    close(log);
    return -1;
}

/* In the child. Nothing here takes memory. */
__attribute__((noreturn)) static void become(const struct setting *setting, pid_t parent, int log,
                                             const char *const *words)
{
    static const char lost[] = "cannot start wirebench\n";
    /* A group of its own: Ctrl-C reaches this program first, which ends its children in order. */
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    const int nothing = open("/dev/null", O_RDONLY);
    if (getppid() == parent && nothing >= 0 && dup2(nothing, STDIN_FILENO) >= 0 &&
        dup2(log, STDOUT_FILENO) >= 0 && dup2(log, STDERR_FILENO) >= 0)
        execve(setting->program, (char *const *)words, setting->environment);
    if (write(log, lost, sizeof lost - 1) < 0)
        _exit(126);
    _exit(127);
}

static enum wb_status start_child(struct wb_jobs_plan_item *item, const struct setting *setting,
                                  const char *partial)
{
    const char **const words = command_line(item, partial);
    if (!words)
        return wb_fail(WB_ERR_MEMORY, "out of memory");
    const int log = open_log(item, words);
    if (log < 0) {
        free(words);
        return wb_fail(WB_ERR_IO, "cannot write '%s': %s", item->log, strerror(errno));
    }
    const pid_t parent = getpid(), child = fork();
    if (child == 0)
        become(setting, parent, log, words);
    const int error = errno;
    close(log);
    free(words);
    if (child < 0)
        return wb_fail(WB_ERR_IO, "cannot start a process: %s", strerror(error));
    setpgid(child, child); /* either of the two is first */
    item->pid = child;
    item->state = WB_JOBS_PLAN_RUNNING;
    item->started_ns = wb_progress_now_ns();
    return WB_OK;
}

static void start(struct wb_jobs_plan *plan, struct wb_jobs_plan_item *item,
                  const struct setting *setting)
{
    char partial[WB_PATH];
    if (wb_jobs_plan_partial(item, partial) != WB_OK ||
        start_child(item, setting, partial) != WB_OK)
        wb_jobs_plan_fail(plan, item, "it could not be started", NULL);
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

static bool made_dataset(const struct wb_jobs_plan_item *item)
{
    char partial[WB_PATH], path[WB_PATH];
    return wb_jobs_plan_partial(item, partial) == WB_OK &&
           wb_file_join(path, partial, "dataset.json") == WB_OK && wb_file_exists(path);
}

static bool is_success(const struct wb_jobs_plan_item *item, int status)
{
    return WIFEXITED(status) && WEXITSTATUS(status) == 0 && made_dataset(item);
}

static void settle(struct wb_jobs_plan *plan, struct wb_jobs_plan_item *item, int status)
{
    char how[128];
    item->pid = 0;
    item->took_ns = wb_progress_now_ns() - item->started_ns;
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

/* Settles those that ended; how many still run. */
static int look(struct wb_jobs_plan *plan)
{
    int running = 0;
    for (int i = 0; i < plan->n; i++) {
        struct wb_jobs_plan_item *const item = &plan->items[i];
        int status = 0;
        if (item->pid <= 0) /* what runs without one is a task of Slurm */
            continue;
        if (waitpid(item->pid, &status, WNOHANG) == item->pid)
            settle(plan, item, status);
        running += item->pid > 0;
    }
    return running;
}

static void pause_ms(int ms)
{
    const struct timespec time = {.tv_sec = ms / 1000, .tv_nsec = (ms % 1000) * 1000000L};
    nanosleep(&time, NULL); /* a signal ends it sooner */
}

static void signal_all(const struct wb_jobs_plan *plan, int signal_number)
{
    for (int i = 0; i < plan->n; i++)
        if (plan->items[i].pid > 0)
            kill(-plan->items[i].pid, signal_number);
}

/* Those that ended before they were through are as if they had not been begun. */
static int bury(struct wb_jobs_plan *plan)
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
            settle(plan, item, status);
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
    const int64_t until_ns = wb_progress_now_ns() + PATIENCE_MS * WB_NS_PER_MS;
    bool killed = false;
    signal_all(plan, SIGTERM);
    while (bury(plan) > 0) {
        if (!killed && wb_progress_now_ns() > until_ns) {
            signal_all(plan, SIGKILL);
            killed = true;
        }
        pause_ms(LOOK_MS);
    }
}

static struct wb_jobs_plan_item *next(struct wb_jobs_plan *plan)
{
    for (int i = 0; i < plan->n; i++)
        if (plan->items[i].state == WB_JOBS_PLAN_TODO && !plan->items[i].queued)
            return &plan->items[i];
    return NULL;
}

static void run_all(struct wb_jobs_plan *plan, const struct setting *setting)
{
    const int workers = count_workers(plan);
    int64_t drawn_ns = 0;
    for (;;) {
        int running = look(plan);
        struct wb_jobs_plan_item *item;
        while (!wb_interrupted() && running < workers && (item = next(plan))) {
            start(plan, item, setting);
            running += item->state == WB_JOBS_PLAN_RUNNING;
        }
        if (running == 0 || wb_interrupted())
            return;
        if (wb_progress_now_ns() - drawn_ns > WB_NS_PER_S / 2) {
            wb_jobs_plan_draw(plan, workers, NULL);
            drawn_ns = wb_progress_now_ns();
        }
        pause_ms(LOOK_MS);
    }
}

enum wb_status wb_jobs_local_run(struct wb_jobs_plan *plan)
{
    struct setting setting;
    WB_TRY(init_setting(&setting, plan));
    signal(SIGCHLD,
           SIG_DFL); /* ignored, as some callers leave it, it would hide how children end */
    run_all(plan, &setting);
    if (wb_interrupted())
        end_all(plan);
    free(setting.environment);
    return WB_OK;
}
