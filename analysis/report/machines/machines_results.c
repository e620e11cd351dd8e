#include "analysis/report/machines/machines_results.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/interrupt.h"
#include "base/memory.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "report"

/* Of the span: where the rigidity is taken, past the seating and short of yielding. */
#define EARLY 0.02

/* --- the data --- */

static enum wb_status import_test(const struct wb_machines_group *group, int index,
                                  const char *path, struct wb_machines_test *test,
                                  struct wb_reason *why)
{
    struct wb_test_piece piece = group->piece;
    char *bytes;
    size_t size;
    piece.sample = index + 1;
    WB_TRY(wb_file_read_with_reason(path, &bytes, &size, why));
    wb_hash_bytes(bytes, size, test->sha256);
    const struct wb_machine_import from = {group->tests[index], NULL, NULL, &group->machine,
                                           &piece};
    const enum wb_status status =
        wb_machine_import(&test->dataset, bytes, size, &from, &test->report, why);
    free(bytes);
    return status;
}

static void load_test(const struct wb_machines_results *results, int g, int index)
{
    const struct wb_machines *const campaign = results->campaign;
    const struct wb_machines_group *const group = &campaign->groups[g];
    struct wb_machines_test *const test = &results->groups[g].tests[index];
    const char *const folder =
        campaign->environment[0] ? getenv(campaign->environment) : campaign->head.folder;
    struct wb_reason why = {{0}};
    char path[WB_PATH];
    test->rigidity = test->start = (double)NAN;
    if (!folder || wb_file_join(path, folder, group->tests[index]) != WB_OK ||
        !wb_file_exists(path)) {
        test->is_missing = true;
        wb_text_append(&test->problem, "the file does not exist");
        return;
    }
    const enum wb_status status = import_test(group, index, path, test, &why);
    test->is_usable = status == WB_OK;
    if (!test->is_usable)
        wb_text_append(&test->problem, "%s", why.text);
}

enum wb_status wb_machines_results_load(void *context, const void *of)
{
    struct wb_machines_results *const results = context;
    const struct wb_machines *const campaign = of;
    results->campaign = campaign;
    results->outcome.campaign = &campaign->head;
    results->has_folder = !campaign->environment[0] || getenv(campaign->environment);
    results->groups = wb_memory_new((size_t)campaign->n_groups, sizeof *results->groups);
    if (!results->has_folder)
        wb_warn("%s is not set: set it to the path of the data folder", campaign->environment);
    for (int g = 0; g < campaign->n_groups; g++) {
        const int n = campaign->groups[g].n_tests;
        results->groups[g].tests = wb_memory_new((size_t)n, sizeof *results->groups[g].tests);
        for (int i = 0; i < n; i++) {
            const struct wb_machines_test *const test = &results->groups[g].tests[i];
            load_test(results, g, i);
            results->outcome.n_wanted++;
            results->outcome.n_missing += test->is_missing;
            results->outcome.n_usable += test->is_usable;
        }
    }
    results->outcome.n_steps = campaign->n_groups + wb_machines_fits_count_wires(campaign);
    return WB_OK;
}

/* --- curves --- */

static void find_start(const struct wb_machines_group *group, struct wb_machines_test *test)
{
    test->start = wb_machines_test_start(test, group->zero_force);
    if (isnan(test->start)) {
        test->is_usable = false;
        wb_text_append(&test->problem, "the force never exceeds %g mN (zero_force_mN)",
                       group->zero_force / WB_MN);
        return;
    }
    const double span = group->machine.span;
    test->rigidity = wb_machines_test_force(test, test->start, EARLY * span) * pow(span, 3.0) /
                     (48.0 * EARLY * span);
}

/* Mean and standard deviation of those that are finite. */
struct sums {
    int n;
    double sum, squares;
};

static void take(struct sums *sums, double value)
{
    if (!isfinite(value))
        return;
    sums->n++;
    sums->sum += value;
    sums->squares += value * value;
}

static void finish(const struct sums *sums, double *mean, double *deviation)
{
    const double n = sums->n;
    *mean = sums->n > 0 ? sums->sum / n : (double)NAN;
    *deviation =
        sums->n > 1 ? sqrt(fmax(sums->squares - n * *mean * *mean, 0.0) / (n - 1.0)) : (double)NAN;
}

static void compute_group(const struct wb_machines_group *group,
                          struct wb_machines_group_results *results)
{
    struct sums rigidity = {0, 0.0, 0.0};
    results->reach = group->piece.usable_travel.known ? group->piece.usable_travel.most : HUGE_VAL;
    for (int i = 0; i < group->n_tests; i++) {
        struct wb_machines_test *const test = &results->tests[i];
        if (test->is_usable)
            find_start(group, test);
        if (!test->is_usable)
            continue;
        results->n_usable++;
        take(&rigidity, test->rigidity);
        results->reach = fmin(results->reach, wb_machines_test_reach(test));
    }
    finish(&rigidity, &results->rigidity, &results->rigidity_deviation);
    for (int k = 0; k < WB_MACHINES_GRID; k++) {
        struct sums force = {0, 0.0, 0.0};
        /* Slightly before the end: the shortest test has no row beyond it. */
        const double d = results->reach * (1.0 - 1e-9) * k / (WB_MACHINES_GRID - 1);
        for (int i = 0; i < group->n_tests && results->n_usable > 0; i++) {
            if (results->tests[i].is_usable)
                take(&force,
                     wb_machines_test_force(&results->tests[i], results->tests[i].start, d));
        }
        finish(&force, &results->force[k], &results->deviation[k]);
    }
}

enum wb_status wb_machines_results_compute(void *context, int n_threads, wb_kind_progress *progress,
                                           void *progress_context)
{
    struct wb_machines_results *const results = context;
    const struct wb_machines *const campaign = results->campaign;
    results->outcome.n_usable = 0;
    for (int g = 0; g < campaign->n_groups && !wb_interrupted(); g++) {
        compute_group(&campaign->groups[g], &results->groups[g]);
        results->outcome.n_usable += results->groups[g].n_usable;
        if (progress)
            progress(progress_context, g + 1, campaign->groups[g].label);
    }
    if (!wb_interrupted())
        WB_TRY(wb_machines_cable_compute(&results->cable, campaign, results->groups));
    wb_machines_fits_compute(&results->fits, campaign, results->groups, n_threads, progress,
                             progress_context);
    results->outcome.interrupted = wb_interrupted();
    results->outcome.is_complete = results->outcome.n_usable == results->outcome.n_wanted;
    return WB_OK;
}

void wb_machines_results_release(void *context)
{
    struct wb_machines_results *const results = context;
    for (int g = 0; results->groups && g < results->campaign->n_groups; g++) {
        struct wb_machines_group_results *const group = &results->groups[g];
        for (int i = 0; i < results->campaign->groups[g].n_tests; i++) {
            wb_text_release(&group->tests[i].problem);
            wb_dataset_release(&group->tests[i].dataset);
        }
        free(group->tests);
    }
    free(results->groups);
    wb_machines_fits_release(&results->fits);
    memset(results, 0, sizeof *results);
}
