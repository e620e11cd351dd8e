#include "cli/solve_harness_parts.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"

#define WB_LOG_DOMAIN "solve"

enum {
    PART_RUNS = 25, /* of a job: some seconds */
    MOST_PARTS = 1000
};

/* Part `k` (from 0) of `n` has the runs from `first` on. */
struct part {
    int k, n;
    int first, n_runs;
};

static struct part part_of(int k, int n, int runs)
{
    const int first = (int)((long long)runs * k / n);
    return (struct part){k, n, first, (int)((long long)runs * (k + 1) / n) - first};
}

static bool parse_part(const struct wb_solve_settings *settings, struct part *part)
{
    int k, n, end = 0;
    if (sscanf(settings->part, "%d/%d%n", &k, &n, &end) != 2 || settings->part[end] != '\0' ||
        k < 1 || k > n || n > settings->runs)
        return false;
    *part = part_of(k - 1, n, settings->runs);
    return true;
}

enum wb_status wb_solve_harness_parts_check(const struct wb_solve_settings *settings)
{
    struct part part;
    if (!parse_part(settings, &part))
        return wb_fail(WB_ERR_ARGUMENT,
                       "--part: expected K/N, a part of N (at most the number of runs), not '%s'",
                       settings->part);
    return WB_OK;
}

enum wb_status wb_solve_harness_parts_compute(struct wb_harness_bands *bands,
                                              const struct wb_solve_settings *settings)
{
    struct part part;
    if (!parse_part(settings, &part))
        return WB_ERR_ARGUMENT; /* was checked */
    WB_TRY(wb_harness_bands_compute(bands, part.first, part.n_runs));
    return bands->stopped
               ? WB_OK
               : wb_harness_bands_write_part(bands, part.first, part.n_runs, settings->output);
}

/* --- jobs --- */

struct one {
    struct wb_harness_bands *bands;
    struct part part;
    char name[32], output[WB_PATH];
    char **command;
};

/* In a process of its own. */
static int run_one(void *context, const char *output, int cores)
{
    const struct one *const one = context;
    one->bands->settings.n_threads = cores;
    if (wb_harness_bands_compute(one->bands, one->part.first, one->part.n_runs) != WB_OK ||
        one->bands->stopped || wb_file_make_folder(output) != WB_OK ||
        wb_harness_bands_write_part(one->bands, one->part.first, one->part.n_runs, output) != WB_OK)
        return 1;
    return 0;
}

/* `shared` has the settings of all parts. */
static enum wb_status make_job(struct wb_job *job, struct one *one, const char *folder,
                               const struct wb_solve_settings *shared)
{
    struct wb_reason why = {.text = ""};
    struct wb_solve_settings settings = *shared;
    char words[32];
    snprintf(words, sizeof words, "%d/%d", one->part.k + 1, one->part.n);
    snprintf(one->name, sizeof one->name, "part-%d-of-%d", one->part.k + 1, one->part.n);
    WB_TRY(wb_file_join(one->output, folder, one->name));
    settings.part = words;
    one->command = wb_solve_settings_command(&settings);
    *job = (struct wb_job){
        .name = one->name,
        .run = run_one,
        .context = one,
        .arguments = (const char *const *)one->command,
        .output = one->output,
        .product = "part.json",
        .replace = wb_file_exists(one->output) &&
                   wb_harness_bands_read_part(one->bands, one->part.first, one->part.n_runs,
                                              one->output, &why) != WB_OK,
    };
    return WB_OK;
}

static enum wb_status read_parts(struct wb_harness_bands *bands, const struct one *ones, int n)
{
    for (int i = 0; i < n; i++)
        WB_TRY(wb_harness_bands_read_part(bands, ones[i].part.first, ones[i].part.n_runs,
                                          ones[i].output, NULL));
    return WB_OK;
}

enum wb_status wb_solve_harness_parts_run(struct wb_harness_bands *bands,
                                          const struct wb_solve_settings *settings,
                                          const struct wb_jobs_options *jobs, bool *complete)
{
    const int runs = bands->settings.runs, most = (runs + PART_RUNS - 1) / PART_RUNS;
    const int n = most < MOST_PARTS ? most : MOST_PARTS;
    struct one *const ones = wb_memory_new((size_t)n, sizeof *ones);
    struct wb_job *const list = wb_memory_new((size_t)n, sizeof *list);
    struct wb_solve_settings shared = *settings;
    struct wb_jobs_options options = *jobs;
    struct wb_jobs_outcome outcome = {0};
    char folder[WB_PATH];
    enum wb_status status = wb_file_join(folder, "", settings->output);
    shared.output = shared.vtk = shared.gltf = NULL;
    shared.frames = 0;
    for (size_t end = strlen(folder); end > 1 && folder[end - 1] == '/';)
        folder[--end] = '\0';
    if (status == WB_OK && strlen(folder) + sizeof ".jobs" > sizeof folder)
        status = wb_fail(WB_ERR_ARGUMENT, "the output's path is too long");
    if (status == WB_OK)
        strcat(folder, ".jobs");
    for (int i = 0; i < n && status == WB_OK; i++) {
        ones[i] = (struct one){.bands = bands, .part = part_of(i, n, runs)};
        status = make_job(&list[i], &ones[i], folder, &shared);
    }
    options.folder = folder;
    if (status == WB_OK)
        status = wb_jobs_run(&outcome, list, n, &options);
    *complete = status == WB_OK && outcome.present + outcome.done == n;
    if (*complete)
        status = read_parts(bands, ones, n);
    else if (status == WB_OK)
        wb_warn("%d of %d parts of the runs are computed; run the same command again to continue",
                outcome.present + outcome.done, n);
    for (int i = 0; i < n; i++)
        free(ones[i].command);
    free(ones);
    free(list);
    return status;
}
