/* Calibration of the library: the methods of `wirebench calibrate`. The result of any method is
 * written as a properties file in memory and parsed, so that it equals that of reading the
 * command's file. */
#include <stdint.h>
#include <stdlib.h>

#include "analysis/calibration/cycle/cycle_verdict.h"
#include "analysis/calibration/properties/method.h"
#include "analysis/dataset/exclusion.h"
#include "base/memory.h"
#include "library/handles.h"
#include "library/options.h"

#define WB_LOG_DOMAIN "library"

/* --- settings --- */

struct job {
    struct wirebench_calibration given;
    enum wb_method method;
    int n;
    const struct wb_dataset **datasets;    /* (n) owned; the datasets themselves are borrowed */
    struct wb_properties_dataset *origins; /* (n) owned */
    const char **names;                    /* (n) owned */
    struct wb_calibrate_settings paper;
    struct wb_cycle_calibrate_settings cycle;
    struct wb_three_point_calibrate_settings three_point;
    const char *missing; /* what is missing in the result; NULL: nothing */
};

static bool report(void *context, int done, int all)
{
    struct job *const job = context;
    return !job->given.progress || job->given.progress(job->given.context, done, all) != 0;
}

static bool report_evaluation(void *context, int evaluation, double error, double size)
{
    (void)error, (void)size;
    return report(context, evaluation, 0);
}

static enum wb_status set_options(struct job *job)
{
    const char *const *const options = job->given.options;
    switch (job->method) {
    case WB_METHOD_PAPER:
        return wb_options_set(&wb_calibrate_table, 1, &job->paper, options, "calibrate");
    case WB_METHOD_THREE_POINT:
        return wb_options_set(wb_three_point_calibrate_tables, WB_THREE_POINT_CALIBRATE_TABLES,
                              &job->three_point, options, "calibrate");
    default:
        return wb_options_set(wb_cycle_calibrate_tables, WB_CYCLE_CALIBRATE_TABLES, &job->cycle,
                              options, "calibrate");
    }
}

static enum wb_status choose_method(struct job *job)
{
    WB_TRY(wb_method_choose(&job->method, job->datasets, job->names, job->n, NULL));
    if (job->method == WB_METHOD_THREE_POINT)
        return WB_OK;
    switch (job->given.method) {
    case WIREBENCH_METHOD_DEFAULT:
        return WB_OK;
    case WIREBENCH_METHOD_CYCLE:
        job->method = WB_METHOD_CYCLE;
        return WB_OK;
    case WIREBENCH_METHOD_PAPER:
        job->method = WB_METHOD_PAPER;
        return WB_OK;
    }
    return wb_fail(WB_ERR_ARGUMENT, "method %d: expected one of enum wirebench_method",
                   (int)job->given.method);
}

static enum wb_status prepare(struct job *job)
{
    WB_TRY(choose_method(job));
    wb_calibrate_default_settings(&job->paper);
    wb_cycle_calibrate_default_settings(&job->cycle);
    for (int i = 0; i < WB_THREE_POINT_CALIBRATE_TABLES; i++)
        wb_setting_fill(&wb_three_point_calibrate_tables[i],
                        (char *)&job->three_point + wb_three_point_calibrate_tables[i].offset);
    if (job->given.threads < 0)
        return wb_fail(WB_ERR_ARGUMENT, "threads: %d: expected 0 (all) or more",
                       job->given.threads);
    WB_TRY(set_options(job));
    job->cycle.threads = job->given.threads;
    job->three_point.threads = job->given.threads;
    job->paper.progress = report_evaluation;
    job->cycle.progress = job->three_point.progress = report;
    job->paper.progress_context = job->cycle.progress_context = job->three_point.progress_context =
        job;
    return WB_OK;
}

/* --- methods --- */

static enum wb_status run_paper(struct job *job, struct wb_text *text)
{
    struct wb_calibrate_result result = {0};
    const char *remarks[WB_CALIBRATE_MOST_REMARKS];
    WB_TRY(wb_calibrate_run(&result, job->datasets, job->n, &job->paper, NULL));
    wb_properties_format(text, &result, &job->paper, job->origins, job->n);
    const int n = wb_calibrate_remarks(&result, remarks);
    for (int i = 0; i < n; i++)
        wb_call_warn(remarks[i]);
    if (!wb_calibrate_is_complete(result.end))
        job->missing = wb_calibrate_end_text(result.end);
    wb_calibrate_result_release(&result);
    return WB_OK;
}

static enum wb_status run_cycle(struct job *job, struct wb_text *text)
{
    struct wb_cycle_calibration calibration = {0};
    struct wb_cycle_remarks *const remarks = wb_memory_new(1, sizeof *remarks);
    const enum wb_status status =
        wb_cycle_check_calibrate(&calibration, remarks, job->datasets, job->n, &job->cycle, NULL);
    for (int i = 0; i < remarks->n; i++)
        wb_call_warn(remarks->items[i].text);
    if (status == WB_OK) {
        const struct wb_cycle_verdict verdict =
            wb_cycle_verdict(&calibration, remarks, &job->cycle);
        wb_properties_format_cycle(text, &calibration, &job->cycle, job->origins, job->n);
        if (verdict.has[WB_CYCLE_STOPPED])
            job->missing = "stopped before all laws were fitted: the hardening rule is undecided";
        else if (verdict.has[WB_CYCLE_NOT_CONVERGED])
            job->missing = "the iterations were exhausted for a specimen (option fit-iterations)";
        else if (verdict.has[WB_CYCLE_NO_LAW_FITS])
            job->missing = "no law fits loading and unloading (hardening_rule in the properties "
                           "has the misfits)";
        else if (verdict.has[WB_CYCLE_UNCERTAIN])
            job->missing = "the uncertainty of a value exceeds the limit (option at-most)";
    }
    free(remarks);
    wb_cycle_calibrate_release(&calibration);
    return status;
}

static enum wb_status run_three_point(struct job *job, struct wb_text *text)
{
    struct wb_three_point_calibration calibration = {0};
    const enum wb_status status =
        wb_three_point_calibrate_run(&calibration, job->datasets, job->n, &job->three_point, NULL);
    if (status == WB_OK) {
        wb_properties_format_three_point(text, &calibration, job->origins, job->n);
        for (int i = 0; i < calibration.n_members; i++) {
            if (!calibration.members[i].is_fitted)
                job->missing = "not every test could be fitted";
            else if (!calibration.members[i].fit.is_converged)
                job->missing = "the iterations were exhausted for a test (option curve-iterations)";
        }
    }
    wb_three_point_calibrate_release(&calibration);
    return status;
}

static enum wb_status calibrate(struct job *job, struct wirebench_properties *properties)
{
    static enum wb_status (*const run[WB_METHODS])(struct job *, struct wb_text *) = {
        [WB_METHOD_CYCLE] = run_cycle,
        [WB_METHOD_PAPER] = run_paper,
        [WB_METHOD_THREE_POINT] = run_three_point,
    };
    struct wb_text *const text = &properties->text;
    WB_TRY(prepare(job));
    wb_call_begin_gsl();
    const enum wb_status status = run[job->method](job, text);
    wb_call_end_gsl();
    WB_TRY(status);
    return wb_card_source_parse(&properties->source, wb_text_string(text),
                                "the calibrated properties", NULL);
}

/* --- calibration --- */

static enum wb_status take_datasets(struct job *job,
                                    const struct wirebench_dataset *const *datasets, size_t n)
{
    if (n < 1 || n > INT32_MAX)
        return wb_fail(WB_ERR_ARGUMENT, "%zu datasets: expected 1 or more", n);
    WB_TRY(wb_call_need(datasets, "datasets"));
    job->n = (int)n;
    job->datasets = wb_memory_new(n, sizeof(struct wb_dataset *));
    job->origins = wb_memory_new(n, sizeof *job->origins);
    job->names = wb_memory_new(n, sizeof *job->names);
    for (size_t i = 0; i < n; i++) {
        WB_TRY(wb_call_need(datasets[i], "a dataset"));
        if (datasets[i]->dataset.info.kind == WB_TEST_TENSILE)
            return wb_fail(WB_ERR_UNSUPPORTED, "'%s' is a tensile test: expected tests of bending",
                           datasets[i]->origin.name);
        WB_TRY(wb_exclusion_check(&datasets[i]->dataset, datasets[i]->origin.name));
        job->datasets[i] = &datasets[i]->dataset;
        job->origins[i] = datasets[i]->origin;
        job->names[i] = datasets[i]->origin.name;
    }
    return WB_OK;
}

enum wirebench_status wirebench_calibrate(struct wirebench_properties **out,
                                          const struct wirebench_dataset *const *datasets, size_t n,
                                          const struct wirebench_calibration *calibration)
{
    struct job job = {0};
    wb_call_begin();
    enum wb_status status = wb_call_need(out, "out");
    if (status == WB_OK && calibration)
        status = wb_call_take(&job.given, sizeof job.given, calibration, "wirebench_calibration");
    if (status == WB_OK)
        status = take_datasets(&job, datasets, n);
    struct wirebench_properties *const properties =
        status == WB_OK ? wb_memory_new(1, sizeof *properties) : NULL;
    if (status == WB_OK)
        status = calibrate(&job, properties);
    free(job.datasets);
    free(job.origins);
    free(job.names);
    if (status == WB_OK)
        *out = properties;
    else
        wirebench_properties_destroy(properties);
    return status == WB_OK && job.missing ? wb_call_end_incomplete("%s", job.missing)
                                          : wb_call_end(status);
}
