#include "analysis/jobs/jobs_plan.h"

#include <errno.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/memory.h"
#include "base/timing.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "jobs"

enum {
    TAIL_LINES = 5,
    TAIL_BYTES = 8192,
    LINE_BYTES = 160 /* longest line of a log that is shown */
};

/* --- checks --- */

static bool is_name(const char *name)
{
    static const char allowed[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                  "._-";
    const size_t n = strlen(name);
    return n > 0 && n <= 200 && name[0] != '.' && name[0] != '-' && strspn(name, allowed) == n;
}

static enum wb_status check_job(const struct wb_job *job, enum wb_jobs_where where)
{
    if (!job->name || !is_name(job->name))
        return wb_fail(WB_ERR_ARGUMENT,
                       "invalid name of a run '%s': expected letters, digits, '.', '_' and '-'",
                       job->name ? job->name : "");
    if (!job->output || !job->output[0] || !job->arguments || !job->arguments[0])
        return wb_fail(WB_ERR_ARGUMENT, "'%s' has no command or no output folder", job->name);
    if (where == WB_JOBS_LOCAL && !job->run)
        return wb_fail(WB_ERR_ARGUMENT, "'%s' has no function to run", job->name);
    bool has_newline = strchr(job->output, '\n') != NULL;
    for (const char *const *argument = job->arguments; *argument; argument++)
        has_newline = has_newline || strchr(*argument, '\n');
    if (has_newline)
        return wb_fail(WB_ERR_ARGUMENT, "'%s': the command or output contains a line break",
                       job->name);
    return WB_OK;
}

static int by_name(const void *a, const void *b)
{
    const struct wb_jobs_plan_item *const *const one = a, *const *const other = b;
    return strcmp((*one)->job->name, (*other)->job->name);
}

static int by_output(const void *a, const void *b)
{
    const struct wb_jobs_plan_item *const *const one = a, *const *const other = b;
    return strcmp((*one)->output, (*other)->output);
}

/* Two runs must not share a log or an output. */
static enum wb_status check_unique(const struct wb_jobs_plan *plan)
{
    const size_t n = (size_t)plan->n;
    const struct wb_jobs_plan_item **const sorted = wb_memory_new(n, sizeof(void *));
    enum wb_status status = WB_OK;
    for (size_t i = 0; i < n; i++)
        sorted[i] = &plan->items[i];
    qsort(sorted, n, sizeof(void *), by_name);
    for (size_t i = 1; i < n && status == WB_OK; i++)
        if (by_name(&sorted[i - 1], &sorted[i]) == 0)
            status = wb_fail(WB_ERR_ARGUMENT, "two runs are named '%s'", sorted[i]->job->name);
    qsort(sorted, n, sizeof(void *), by_output);
    for (size_t i = 1; i < n && status == WB_OK; i++)
        if (by_output(&sorted[i - 1], &sorted[i]) == 0)
            status = wb_fail(WB_ERR_ARGUMENT, "'%s' and '%s' would both write '%s'",
                             sorted[i - 1]->job->name, sorted[i]->job->name, sorted[i]->output);
    free(sorted);
    return status;
}

/* --- begin and end --- */

/* Stable order: by cost, then by position in the caller's list. */
static int by_cost(const void *a, const void *b)
{
    const struct wb_jobs_plan_item *const one = a, *const other = b;
    if (one->job->cost > other->job->cost || one->job->cost < other->job->cost)
        return one->job->cost > other->job->cost ? -1 : 1;
    return one->job < other->job ? -1 : one->job > other->job;
}

/* Records the outdated folder, to distinguish it from the new one. */
static void note_old(struct wb_jobs_plan_item *item)
{
    struct stat old;
    if (!item->job->replace || stat(item->output, &old) != 0)
        return;
    item->was_there = true;
    item->old_device = old.st_dev;
    item->old_inode = old.st_ino;
}

/* The absolute path without links, so that later calls recognise the same file; missing parent
 * folders are created. */
static enum wb_status resolve(char path[WB_PATH], const char *directory, const char *name)
{
    char whole[WB_PATH], parent[WB_PATH];
    WB_TRY(wb_file_join(whole, directory, name));
    /* With a '/' at the end the unfinished folder would be inside the finished one. */
    for (size_t n = strlen(whole); n > 1 && whole[n - 1] == '/'; n--)
        whole[n - 1] = '\0';
    wb_file_folder(parent, whole);
    WB_TRY(wb_file_make_folder(parent));
    char *const real = realpath(parent, NULL);
    if (!real)
        return wb_fail(WB_ERR_IO, "cannot find '%s': %s", parent, strerror(errno));
    const enum wb_status status = wb_file_join(path, real, wb_file_name(whole));
    free(real);
    return status;
}

static enum wb_status with_ending(char path[WB_PATH], const char *output, const char *ending)
{
    if (snprintf(path, WB_PATH, "%s%s", output, ending) >= WB_PATH)
        return wb_fail(WB_ERR_ARGUMENT, "'%s%s': the path is too long", output, ending);
    return WB_OK;
}

static enum wb_status init_item(struct wb_jobs_plan *plan, struct wb_jobs_plan_item *item)
{
    char name[256];
    snprintf(name, sizeof name, "%s.log", item->job->name);
    WB_TRY(wb_file_join(item->log, plan->folder, name));
    WB_TRY(resolve(item->output, plan->directory, item->job->output));
    WB_TRY(with_ending(item->partial, item->output, ".partial"));
    note_old(item);
    if (wb_jobs_plan_is_made(item))
        item->state = WB_JOBS_PLAN_PRESENT;
    return WB_OK;
}

static enum wb_status fill(struct wb_jobs_plan *plan, const struct wb_job *jobs)
{
    if (!getcwd(plan->directory, sizeof plan->directory))
        return wb_fail(WB_ERR_IO, "cannot determine the current folder: %s", strerror(errno));
    WB_TRY(resolve(plan->folder, plan->directory, plan->options->folder));
    WB_TRY(wb_file_make_folder(plan->folder));
    for (int i = 0; i < plan->n; i++) {
        WB_TRY(check_job(&jobs[i], plan->options->where));
        plan->items[i].job = &jobs[i];
    }
    qsort(plan->items, (size_t)plan->n, sizeof plan->items[0], by_cost);
    for (int i = 0; i < plan->n; i++)
        WB_TRY(init_item(plan, &plan->items[i]));
    return check_unique(plan);
}

enum wb_status wb_jobs_plan_init(struct wb_jobs_plan *plan, const struct wb_job *jobs, int n,
                                 const struct wb_jobs_options *options)
{
    *plan = (struct wb_jobs_plan){
        .options = options,
        .n = n,
        .cores_per_job = options->cores_per_job > 0 ? options->cores_per_job : 1,
        .on_terminal = isatty(STDERR_FILENO) != 0,
    };
    if (!options->folder || n < 0)
        return wb_fail(WB_ERR_ARGUMENT, "runs need a folder for their logs");
    plan->items = wb_memory_new((size_t)n, sizeof *plan->items);
    const enum wb_status status = fill(plan, jobs);
    if (status != WB_OK)
        wb_jobs_plan_release(plan);
    return status;
}

void wb_jobs_plan_release(struct wb_jobs_plan *plan)
{
    free(plan->items);
    plan->items = NULL;
    plan->n = 0;
}

int wb_jobs_plan_count(const struct wb_jobs_plan *plan, enum wb_jobs_plan_state state)
{
    int n = 0;
    for (int i = 0; i < plan->n; i++)
        n += plan->items[i].state == state;
    return n;
}

/* --- outputs --- */

const char *wb_jobs_plan_product(const struct wb_jobs_plan_item *item)
{
    return item->job->product ? item->job->product : "dataset.json";
}

static bool has_product(const struct wb_jobs_plan_item *item, const char *folder)
{
    char path[WB_PATH];
    return wb_file_join(path, folder, wb_jobs_plan_product(item)) == WB_OK && wb_file_exists(path);
}

bool wb_jobs_plan_is_made(const struct wb_jobs_plan_item *item)
{
    struct stat now;
    if (stat(item->output, &now) != 0 || !has_product(item, item->output))
        return false;
    return !item->was_there || now.st_dev != item->old_device || now.st_ino != item->old_inode;
}

bool wb_jobs_plan_is_blocked(struct wb_jobs_plan *plan, struct wb_jobs_plan_item *item)
{
    if (item->job->replace || !wb_file_exists(item->output) ||
        wb_file_count_entries(item->output) == 0)
        return false;
    wb_jobs_plan_clear(plan);
    item->state = WB_JOBS_PLAN_FAILED;
    wb_error("run '%s' not started: '%s' exists but has no %s; move it away", item->job->name,
             item->output, wb_jobs_plan_product(item));
    return true;
}

bool wb_jobs_plan_is_partial_whole(const struct wb_jobs_plan_item *item)
{
    return has_product(item, item->partial);
}

static int remove_one(const char *path, const struct stat *info, int kind, struct FTW *walk)
{
    (void)info;
    (void)kind;
    (void)walk;
    return remove(path);
}

/* Removes a folder with its contents; links are removed, not followed. */
static void remove_folder(const char *path)
{
    if (wb_file_exists(path) && nftw(path, remove_one, 16, FTW_DEPTH | FTW_PHYS) != 0)
        wb_warn("cannot remove '%s': %s", path, strerror(errno));
}

bool wb_jobs_plan_clean(const struct wb_jobs_plan_item *item, bool keep_usable)
{
    if (keep_usable && wb_jobs_plan_is_partial_whole(item))
        return true;
    remove_folder(item->partial);
    return false;
}

enum wb_status wb_jobs_plan_accept(const struct wb_jobs_plan_item *item)
{
    char outdated[WB_PATH];
    WB_TRY(with_ending(outdated, item->output, ".outdated"));
    if (item->job->replace && wb_file_exists(item->output)) {
        remove_folder(outdated);
        if (rename(item->output, outdated) != 0)
            return wb_fail(WB_ERR_IO, "cannot rename the outdated '%s': %s", item->output,
                           strerror(errno));
    }
    if (rename(item->partial, item->output) != 0)
        return wb_fail(WB_ERR_IO, "cannot rename '%s' to '%s': %s", item->partial, item->output,
                       strerror(errno));
    if (item->job->replace)
        remove_folder(outdated);
    return WB_OK;
}

/* --- messages --- */

static void append_line(struct wb_text *text, const char *line, size_t n)
{
    wb_text_append(text, "\n    ");
    for (size_t i = 0; i < n && i < LINE_BYTES; i++) {
        /* Control characters of a progress line or a terminal are replaced. */
        const unsigned char c = (unsigned char)line[i];
        const char shown = c < ' ' || c == 0x7f ? ' ' : (char)c;
        wb_text_append_bytes(text, &shown, 1);
    }
    if (n > LINE_BYTES)
        wb_text_append(text, "...");
}

/* Appends the last lines of a file. */
static void append_tail(struct wb_text *text, const char *path)
{
    char bytes[TAIL_BYTES];
    FILE *const file = fopen(path, "rb");
    if (!file)
        return;
    /* A file shorter than that is read from its start. */
    if (fseek(file, -TAIL_BYTES, SEEK_END) != 0)
        rewind(file);
    size_t n = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    while (n > 0 && bytes[n - 1] == '\n')
        n--;
    size_t start = n;
    for (int lines = 0; start > 0; start--)
        if (bytes[start - 1] == '\n' && ++lines == TAIL_LINES)
            break;
    while (start < n) {
        const char *const line = bytes + start, *const end = memchr(line, '\n', n - start);
        const size_t length = end ? (size_t)(end - line) : n - start;
        append_line(text, line, length);
        start += length + 1;
    }
}

void wb_jobs_plan_fail(struct wb_jobs_plan *plan, struct wb_jobs_plan_item *item, const char *how,
                       const char *other_log)
{
    struct wb_text text = {0};
    item->state = WB_JOBS_PLAN_FAILED;
    wb_jobs_plan_clear(plan);
    append_tail(&text, item->log);
    if (other_log)
        append_tail(&text, other_log);
    wb_error("run '%s' failed: %s; see '%s'%s", item->job->name, how, item->log,
             wb_text_string(&text));
    wb_text_release(&text);
    if (wb_jobs_plan_clean(item, true))
        wb_info("the incomplete output of '%s' is in '%s'", item->job->name, item->partial);
}

void wb_jobs_plan_duration(char text[32], double seconds)
{
    const double minutes = seconds / 60.0;
    if (seconds < 100.0)
        snprintf(text, 32, "%.0f s", seconds);
    else if (minutes < 100.0)
        snprintf(text, 32, "%.0f min", minutes);
    else if (minutes < 1e6)
        snprintf(text, 32, "%d h %02d min", (int)(minutes / 60.0), (int)minutes % 60);
    else
        snprintf(text, 32, "%.0f days", minutes / 1440.0);
}

/* Remaining time, s, from the duration and cost of the finished runs; negative if unknown. */
static double time_left(const struct wb_jobs_plan *plan, int at_once)
{
    double cost = 0.0, took = 0.0, left = 0.0, longest = 0.0;
    int done = 0;
    for (int i = 0; i < plan->n; i++) {
        const struct wb_jobs_plan_item *const item = &plan->items[i];
        if (item->state != WB_JOBS_PLAN_DONE)
            continue;
        done++;
        cost += item->job->cost;
        took += wb_seconds_from_ns(item->took_ns);
    }
    if (done == 0)
        return -1.0;
    const int64_t now_ns = wb_time_now_ns();
    for (int i = 0; i < plan->n; i++) {
        const struct wb_jobs_plan_item *const item = &plan->items[i];
        if (item->state != WB_JOBS_PLAN_TODO && item->state != WB_JOBS_PLAN_RUNNING)
            continue;
        double one =
            cost > 0.0 && item->job->cost > 0.0 ? took * item->job->cost / cost : took / done;
        if (item->state == WB_JOBS_PLAN_RUNNING)
            one -= wb_seconds_from_ns(now_ns - item->started_ns);
        one = one > 0.0 ? one : 0.0;
        left += one;
        longest = one > longest ? one : longest;
    }
    left /= at_once > 1 ? at_once : 1;
    return left > longest ? left : longest;
}

void wb_jobs_plan_draw(struct wb_jobs_plan *plan, int at_once, const char *note)
{
    char left[32] = "";
    if (!plan->on_terminal)
        return;
    const int failed = wb_jobs_plan_count(plan, WB_JOBS_PLAN_FAILED);
    const double seconds = time_left(plan, at_once);
    fprintf(stderr, "\r\033[Kruns: %d of %d done, %d running, %d left",
            wb_jobs_plan_count(plan, WB_JOBS_PLAN_DONE) +
                wb_jobs_plan_count(plan, WB_JOBS_PLAN_PRESENT),
            plan->n, wb_jobs_plan_count(plan, WB_JOBS_PLAN_RUNNING),
            wb_jobs_plan_count(plan, WB_JOBS_PLAN_TODO));
    if (failed > 0)
        fprintf(stderr, ", %d failed", failed);
    if (seconds >= 0.0) {
        wb_jobs_plan_duration(left, seconds);
        fprintf(stderr, ", about %s", left);
    }
    if (note)
        fprintf(stderr, ", %s", note);
    fflush(stderr);
    plan->drawn = true;
}

void wb_jobs_plan_clear(struct wb_jobs_plan *plan)
{
    if (plan->drawn) {
        fprintf(stderr, "\r\033[K");
        fflush(stderr);
    }
    plan->drawn = false;
}
