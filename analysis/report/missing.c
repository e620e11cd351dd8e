#include "analysis/report/missing.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "analysis/solve/solve.h"
#include "base/hash.h"
#include "base/memory.h"

#define WB_LOG_DOMAIN "report"

/* A job's settings, and the data that they point to. */
struct one {
    struct wb_solve_settings settings;
    char checkpoint[WB_PATH];
    char **command; /* owned */
};

struct all {
    int n;
    struct wb_job *jobs; /* (n) */
    struct one *texts;   /* (n) */
    int cores;           /* of a run */
    char folder[WB_PATH];
    char program[WB_SHA256_TEXT];
};

static enum wb_status name_folder(char path[WB_PATH], const char *report)
{
    size_t length = strlen(report);
    while (length > 1 && report[length - 1] == '/')
        length--;
    if (snprintf(path, WB_PATH, "%.*s.jobs", (int)length, report) >= WB_PATH)
        return wb_fail(WB_ERR_ARGUMENT, "the output's path is too long");
    return WB_OK;
}

static enum wb_status name_checkpoint(const struct all *all,
                                      const struct wb_simulation_entry *entry, char path[WB_PATH])
{
    char hash[WB_SHA256_TEXT], name[200];
    struct wb_text text = {0};
    wb_text_append(&text, "%s %d %s %s", all->program, all->cores, entry->wanted->inputs_sha256,
                   wb_text_string(&entry->wanted->command));
    wb_hash_bytes(wb_text_string(&text), text.length, hash);
    wb_text_release(&text);
    snprintf(name, sizeof name, "%.128s-%.12s.checkpoint", entry->wanted->log, hash);
    return wb_file_join(path, all->folder, name);
}

/* Called in a process of its own, on this machine. */
static int run_one(void *context, const char *output, int cores)
{
    const struct one *const one = context;
    struct wb_solve_settings settings = one->settings;
    bool complete;
    settings.output = output;
    wb_solve_set_threads(cores);
    if (wb_solve_run(&settings, NULL, NULL, &complete) != WB_OK)
        return 1;
    return complete ? 0 : 3; /* as `wirebench solve` does */
}

static enum wb_status add_job(struct all *all, const struct wb_simulation_entry *entry)
{
    struct one *const one = &all->texts[all->n];
    one->settings = entry->wanted->settings;
    if (entry->is_resumable) {
        if (all->cores > 1)
            one->settings.threads = all->cores;
        WB_TRY(name_checkpoint(all, entry, one->checkpoint));
        one->settings.checkpoint = one->checkpoint;
    }
    one->command = wb_solve_settings_command(&one->settings);
    all->jobs[all->n++] = (struct wb_job){
        .name = entry->wanted->log,
        .run = run_one,
        .context = one,
        .arguments = (const char *const *)one->command,
        .output = entry->wanted->path,
        .cost = entry->cost,
        .replace = entry->result->state == WB_SIMULATION_STALE,
    };
    return WB_OK;
}

static enum wb_status add_jobs(struct all *all, wb_simulation_list *list, const void *results)
{
    struct wb_simulation_entry entry;
    size_t n = 0;
    for (int i = 0; list(results, i, &entry); i++)
        n += wb_simulation_is_missing(entry.result);
    if (n == 0)
        return WB_OK;
    all->jobs = wb_memory_new(n, sizeof *all->jobs);
    all->texts = wb_memory_new(n, sizeof *all->texts);
    WB_TRY(wb_hash_file("/proc/self/exe", all->program));
    for (int i = 0; list(results, i, &entry); i++) {
        if (wb_simulation_is_missing(entry.result))
            WB_TRY(add_job(all, &entry));
    }
    return WB_OK;
}

enum wb_status wb_missing_make(struct wb_missing_outcome *outcome, wb_simulation_list *list,
                               const void *results, const char *folder,
                               const struct wb_jobs_options *options)
{
    struct wb_jobs_options own = *options;
    struct wb_jobs_outcome of_jobs = {0};
    struct all all = {.n = 0, .cores = options->cores_per_job > 1 ? options->cores_per_job : 1};
    enum wb_status status = name_folder(all.folder, folder);
    if (status == WB_OK)
        status = add_jobs(&all, list, results);
    own.folder = all.folder;
    if (status == WB_OK && all.n > 0)
        status = wb_jobs_run(&of_jobs, all.jobs, all.n, &own);
    *outcome = (struct wb_missing_outcome){.n = all.n, .interrupted = of_jobs.interrupted};
    for (int i = 0; i < all.n; i++)
        free(all.texts[i].command);
    free(all.jobs);
    free(all.texts);
    return status;
}

/* --- checkpoints --- */

/* Whether a file is a checkpoint of a run by any program, or one that was being written. */
static bool is_checkpoint_of(const char *file, const char *run)
{
    static const char ending[] = ".checkpoint";
    enum {
        DIGITS = 12
    };
    const size_t length = strlen(run);
    if (strncmp(file, run, length) != 0 || file[length] != '-')
        return false;
    const char *const hash = file + length + 1;
    if (strspn(hash, "0123456789abcdef") != DIGITS)
        return false;
    const char *const rest = hash + DIGITS;
    return strncmp(rest, ending, strlen(ending)) == 0 &&
           (rest[strlen(ending)] == '\0' || rest[strlen(ending)] == '.');
}

static bool is_done_with(wb_simulation_list *list, const void *results, const char *file)
{
    struct wb_simulation_entry entry;
    for (int i = 0; list(results, i, &entry); i++) {
        if (entry.is_resumable && entry.result->state == WB_SIMULATION_USABLE &&
            is_checkpoint_of(file, entry.wanted->log))
            return true;
    }
    return false;
}

void wb_missing_remove_checkpoints(wb_simulation_list *list, const void *results,
                                   const char *folder)
{
    char path[WB_PATH];
    DIR *const files = name_folder(path, folder) == WB_OK ? opendir(path) : NULL;
    if (!files)
        return;
    for (const struct dirent *entry; (entry = readdir(files));) {
        if (is_done_with(list, results, entry->d_name))
            (void)unlinkat(dirfd(files), entry->d_name, 0);
    }
    closedir(files);
}
