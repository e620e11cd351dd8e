#include "analysis/report/bench/recordings_results.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "analysis/align.h"
#include "analysis/report/bench/recordings_results_private.h"
#include "analysis/report/reasons.h"
#include "base/interrupt.h"
#include "daq/recording.h"

#define WB_LOG_DOMAIN "report"

enum job_kind {
    JOB_ALIGN,
    JOB_CALIBRATE,
    JOB_VALIDATE
};

enum job_state {
    JOB_WAITING,
    JOB_RUNNING,
    JOB_FINISHED
};

struct job {
    enum job_kind kind;
    enum job_state state;
    struct wb_recordings_results_wire *wire;
    struct wb_recordings_results_test *test; /* of an alignment */
    bool calibrates;                         /* an alignment for the calibration */
};

struct schedule {
    pthread_mutex_t lock;
    pthread_cond_t changed;
    struct wb_recordings_results *results;
    int n, n_finished;
    struct job *jobs; /* in order of preference: calibrations, alignments, validations */
    wb_kind_progress *progress;
    void *context;
};

/* --- one job --- */

static void read_meta(struct wb_recording *recording, const char *key, char *text, size_t size)
{
    char *value = NULL;
    if (wb_recording_meta(recording, key, &value) == WB_OK)
        snprintf(text, size, "%s", value);
    free(value);
}

/* What the recording says about bench and specimen. The truth of a virtual rig is not read. */
static enum wb_status read_bench(struct wb_recordings_results_test *test, struct wb_reason *why)
{
    struct wb_recording *recording;
    /* Aligning opens it again and tells what is wrong with the file. */
    WB_TRY(wb_recording_open_with_reason(&recording, test->wanted->path, why));
    char is_virtual[16] = "";
    read_meta(recording, "start_utc", test->start_utc, sizeof test->start_utc);
    read_meta(recording, "tool_revision", test->tool_revision, sizeof test->tool_revision);
    read_meta(recording, "operator", test->operator_name, sizeof test->operator_name);
    read_meta(recording, "virtual", is_virtual, sizeof is_virtual);
    test->is_virtual = strcmp(is_virtual, "true") == 0;
    char *text = NULL;
    enum wb_status status = WB_OK;
    if (wb_recording_meta(recording, "rig", &text) == WB_OK)
        status = wb_rig_parse(text, test->wanted->name, &test->rig, why);
    free(text);
    text = NULL;
    if (status == WB_OK && wb_recording_meta(recording, "specimen", &text) == WB_OK)
        status = wb_specimen_parse(text, test->wanted->name, &test->specimen, why);
    free(text);
    test->is_virtual |= test->rig.is_virtual;
    const enum wb_status closed = wb_recording_close(recording);
    return status == WB_OK ? closed : status;
}

static enum wb_status check_identity(const struct wb_recordings_results_test *test,
                                     const struct wb_recordings_results_wire *wire, double length,
                                     struct wb_reason *why)
{
    const struct wb_test_info *const info = &test->dataset.info;
    if (test->wanted->sha256[0] && strcmp(test->wanted->sha256, test->sha256) != 0)
        return wb_fail_to(why, WB_ERR_DATA,
                          "'%s' is not the recording that the index lists (sha256 %s)",
                          test->wanted->path, test->sha256);
    if (strcmp(info->wire, wire->wanted->product.name) != 0 ||
        !(fabs(info->length - length) < 1e-6))
        return wb_fail_to(why, WB_ERR_DATA, "'%s' is of wire '%s' at %g mm, not '%s' at %g mm",
                          test->wanted->path, info->wire, 1e3 * info->length,
                          wire->wanted->product.name, 1e3 * length);
    return WB_OK;
}

static enum wb_status align(struct wb_recordings_results_test *test,
                            const struct wb_recordings_results_wire *wire, double length,
                            struct wb_reason *why)
{
    struct wb_align_settings settings;
    wb_align_default_settings(&settings);
    WB_TRY(wb_recording_sha256(test->wanted->path, test->sha256, why));
    WB_TRY(read_bench(test, why));
    WB_TRY(wb_align_run(&test->dataset, test->wanted->path, &settings, why));
    const enum wb_status status = check_identity(test, wire, length, why);
    if (status != WB_OK)
        wb_dataset_release(&test->dataset);
    return status;
}

static void run_align(const struct wb_recordings *campaign, const struct job *job)
{
    struct wb_recordings_results_test *const test = job->test;
    if (test->wanted->missing[0]) {
        wb_text_append(&test->problem, "%s", test->wanted->missing);
        return;
    }
    struct wb_reason why = {.text = ""};
    const enum wb_status status =
        align(test, job->wire,
              job->calibrates ? campaign->calibration_length : campaign->validation_length, &why);
    test->usable = status == WB_OK;
    if (test->usable)
        return;
    const struct wb_reasons reasons = {&test->problem, test->wanted->path, test->wanted->name};
    wb_reasons_fail(&reasons, status, &why);
}

static int usable_datasets(const struct wb_recordings_results_tests *tests,
                           const struct wb_dataset **datasets)
{
    int n = 0;
    for (int i = 0; i < tests->n; i++) {
        if (tests->items[i].usable)
            datasets[n++] = &tests->items[i].dataset;
    }
    return n;
}

static enum wb_status calibrate(const struct wb_recordings *campaign,
                                struct wb_recordings_results_wire *wire,
                                const struct wb_dataset *const *datasets, int n,
                                struct wb_reason *why)
{
    struct wb_calibrate_settings settings = campaign->calibrate;
    settings.progress = wb_campaign_go_on;
    WB_TRY(wb_calibrate_run(&wire->calibration, datasets, n, &settings, why));
    wb_properties_from_result(&wire->calibration, &wire->properties);
    const enum wb_status status =
        wb_validate_run(&wire->fit, &wire->properties, datasets, n, &campaign->calibrate, why);
    if (status != WB_OK)
        wb_calibrate_result_release(&wire->calibration);
    return status;
}

static enum wb_recordings_results_state run_step(const struct wb_recordings *campaign,
                                                 const struct job *job)
{
    struct wb_recordings_results_wire *const wire = job->wire;
    const bool calibrates = job->kind == JOB_CALIBRATE;
    const struct wb_recordings_results_tests *const tests =
        calibrates ? &wire->calibration_tests : &wire->validation_tests;
    struct wb_text *const problem =
        calibrates ? &wire->calibration_problem : &wire->validation_problem;
    const struct wb_dataset **const datasets = calloc((size_t)tests->n + 1, sizeof *datasets);
    const int n = datasets ? usable_datasets(tests, datasets) : 0;
    if (n == 0 || (!calibrates && wire->calibration_state != WB_RECORDINGS_DONE)) {
        wb_text_append(problem, n == 0 ? "no usable recording"
                                       : "the calibration that it builds on is missing");
        free(datasets);
        return WB_RECORDINGS_MISSING;
    }
    struct wb_reason why = {.text = ""};
    const enum wb_status status = calibrates
                                      ? calibrate(campaign, wire, datasets, n, &why)
                                      : wb_validate_run(&wire->validation, &wire->properties,
                                                        datasets, n, &campaign->calibrate, &why);
    free(datasets);
    if (status == WB_OK)
        return WB_RECORDINGS_DONE;
    const struct wb_reasons reasons = {problem, NULL, NULL};
    wb_reasons_fail(&reasons, status, &why);
    return WB_RECORDINGS_FAILED;
}

static void run_job(const struct wb_recordings *campaign, const struct job *job)
{
    switch (job->kind) {
    case JOB_ALIGN:
        run_align(campaign, job);
        break;
    case JOB_CALIBRATE:
        job->wire->calibration_state = run_step(campaign, job);
        break;
    case JOB_VALIDATE:
        job->wire->validation_state = run_step(campaign, job);
        break;
    }
}

/* --- the schedule --- */

static bool is_ready(const struct schedule *schedule, const struct job *job)
{
    if (job->kind == JOB_ALIGN)
        return true;
    for (int i = 0; i < schedule->n; i++) {
        const struct job *const other = &schedule->jobs[i];
        if (other->wire != job->wire || other->state == JOB_FINISHED)
            continue;
        const bool before = job->kind == JOB_CALIBRATE
                                ? other->kind == JOB_ALIGN && other->calibrates
                                : other != job;
        if (before)
            return false;
    }
    return true;
}

static struct job *next_job(struct schedule *schedule)
{
    for (int i = 0; i < schedule->n; i++) {
        struct job *const job = &schedule->jobs[i];
        if (job->state == JOB_WAITING && is_ready(schedule, job))
            return job;
    }
    return NULL;
}

static void tell(const struct schedule *schedule, const struct job *job)
{
    if (!schedule->progress)
        return;
    char what[160];
    const char *const label = job->wire->wanted->label;
    if (job->kind == JOB_ALIGN)
        snprintf(what, sizeof what, "aligned %.120s", job->test->wanted->name);
    else
        snprintf(what, sizeof what, "%s %.120s",
                 job->kind == JOB_CALIBRATE ? "calibrated" : "validated", label);
    schedule->progress(schedule->context, schedule->n_finished, schedule->n, what);
}

static void *work(void *context)
{
    struct schedule *const schedule = context;
    pthread_mutex_lock(&schedule->lock);
    while (schedule->n_finished < schedule->n && !wb_interrupted()) {
        struct job *const job = next_job(schedule);
        if (!job) {
            pthread_cond_wait(&schedule->changed, &schedule->lock);
            continue;
        }
        job->state = JOB_RUNNING;
        pthread_mutex_unlock(&schedule->lock);
        run_job(schedule->results->campaign, job);
        pthread_mutex_lock(&schedule->lock);
        job->state = JOB_FINISHED;
        schedule->n_finished++;
        tell(schedule, job);
        pthread_cond_broadcast(&schedule->changed);
    }
    /* Others may wait for a job that an interrupted worker will not do any more. */
    pthread_cond_broadcast(&schedule->changed);
    pthread_mutex_unlock(&schedule->lock);
    return NULL;
}

static void add_jobs(struct schedule *schedule)
{
    struct wb_recordings_results *const results = schedule->results;
    for (int i = 0; i < results->n_wires; i++)
        schedule->jobs[schedule->n++] =
            (struct job){.kind = JOB_CALIBRATE, .wire = &results->wires[i]};
    for (int round = 0; round < 2; round++) {
        for (int i = 0; i < results->n_wires; i++) {
            struct wb_recordings_results_wire *const wire = &results->wires[i];
            struct wb_recordings_results_tests *const tests =
                round == 0 ? &wire->calibration_tests : &wire->validation_tests;
            for (int k = 0; k < tests->n; k++)
                schedule->jobs[schedule->n++] = (struct job){.kind = JOB_ALIGN,
                                                             .wire = wire,
                                                             .test = &tests->items[k],
                                                             .calibrates = round == 0};
        }
    }
    for (int i = 0; i < results->n_wires; i++) {
        if (results->wires[i].validation_state != WB_RECORDINGS_NOT_WANTED)
            schedule->jobs[schedule->n++] =
                (struct job){.kind = JOB_VALIDATE, .wire = &results->wires[i]};
    }
}

static void run_threads(struct schedule *schedule, int n_threads)
{
    pthread_t threads[16];
    int n = 0;
    /* The calling thread works too, so one thread that cannot be started is no failure. */
    while (n < n_threads - 1 && n < 16 && pthread_create(&threads[n], NULL, work, schedule) == 0)
        n++;
    work(schedule);
    for (int i = 0; i < n; i++)
        pthread_join(threads[i], NULL);
}

/* --- all of it --- */

static enum wb_status prepare_tests(struct wb_recordings_results_tests *tests,
                                    const struct wb_recordings_tests *wanted)
{
    tests->items = calloc((size_t)wanted->n + 1, sizeof *tests->items);
    if (!tests->items)
        return wb_fail(WB_ERR_MEMORY, "out of memory preparing a report");
    tests->n = wanted->n;
    for (int i = 0; i < wanted->n; i++)
        tests->items[i].wanted = &wanted->items[i];
    return WB_OK;
}

enum wb_status wb_recordings_results_init(struct wb_recordings_results *results,
                                          const struct wb_recordings *campaign)
{
    memset(results, 0, sizeof *results);
    results->campaign = campaign;
    results->wires = calloc((size_t)campaign->n_wires, sizeof *results->wires);
    if (!results->wires)
        return wb_fail(WB_ERR_MEMORY, "out of memory preparing a report");
    results->n_wires = campaign->n_wires;
    for (int i = 0; i < campaign->n_wires; i++) {
        struct wb_recordings_results_wire *const wire = &results->wires[i];
        wire->wanted = &campaign->wires[i];
        wire->calibration_state = WB_RECORDINGS_MISSING;
        wire->validation_state =
            campaign->validation_length > 0.0 ? WB_RECORDINGS_MISSING : WB_RECORDINGS_NOT_WANTED;
        WB_TRY(prepare_tests(&wire->calibration_tests, &wire->wanted->calibration));
        WB_TRY(prepare_tests(&wire->validation_tests, &wire->wanted->validation));
        results->outcome.n_wanted += wire->calibration_tests.n + wire->validation_tests.n;
    }
    return WB_OK;
}

static void count_tests(struct wb_recordings_results *results,
                        struct wb_recordings_results_tests *tests)
{
    for (int i = 0; i < tests->n; i++) {
        const struct wb_recordings_results_test *const test = &tests->items[i];
        if (!test->usable)
            continue;
        tests->n_usable++;
        results->outcome.n_usable++;
        results->any_virtual |= test->is_virtual;
        results->all_virtual &= test->is_virtual;
        if (strcmp(test->start_utc, results->latest_utc) > 0)
            memcpy(results->latest_utc, test->start_utc, sizeof results->latest_utc);
    }
}

void wb_recordings_results_judge(struct wb_recordings_results *results)
{
    const struct wb_recordings *const campaign = results->campaign;
    results->all_virtual = true;
    results->outcome.is_complete = true;
    for (int i = 0; i < results->n_wires; i++) {
        struct wb_recordings_results_wire *const wire = &results->wires[i];
        count_tests(results, &wire->calibration_tests);
        count_tests(results, &wire->validation_tests);
        const bool calibrated = wire->calibration_state == WB_RECORDINGS_DONE;
        const bool validated = wire->validation_state == WB_RECORDINGS_DONE;
        results->outcome.is_complete &=
            calibrated && (validated || wire->validation_state == WB_RECORDINGS_NOT_WANTED);
        /* Compared so that a NaN exceeds. */
        if (calibrated && campaign->calibration_limit > 0.0 &&
            !(wire->calibration.rms <= campaign->calibration_limit))
            results->outcome.exceeds_limit = true;
        if (validated && campaign->validation_limit > 0.0 &&
            !(wire->validation.elastoplastic.rms <= campaign->validation_limit))
            results->outcome.exceeds_limit = true;
    }
    results->outcome.is_complete &= results->outcome.n_usable == results->outcome.n_wanted;
    results->all_virtual &= results->outcome.n_usable > 0;
}

enum wb_status wb_recordings_results_compute(struct wb_recordings_results *results,
                                             const struct wb_recordings *campaign, int n_threads,
                                             wb_kind_progress *progress, void *context)
{
    enum wb_status status = wb_recordings_results_init(results, campaign);
    struct schedule schedule = {.lock = PTHREAD_MUTEX_INITIALIZER,
                                .changed = PTHREAD_COND_INITIALIZER,
                                .results = results,
                                .progress = progress,
                                .context = context};
    if (status == WB_OK) {
        const size_t n = (size_t)results->outcome.n_wanted + 2 * (size_t)results->n_wires;
        schedule.jobs = calloc(n, sizeof *schedule.jobs);
        if (!schedule.jobs)
            status = wb_fail(WB_ERR_MEMORY, "out of memory preparing a report");
    }
    if (status != WB_OK) {
        wb_recordings_results_release(results);
        return status;
    }
    add_jobs(&schedule);
    if (n_threads <= 0) {
        const long cores = sysconf(_SC_NPROCESSORS_ONLN);
        n_threads = cores < 1 ? 1 : cores > 4 ? 4 : (int)cores;
    }
    run_threads(&schedule, n_threads);
    free(schedule.jobs);
    results->outcome.interrupted = wb_interrupted();
    wb_recordings_results_judge(results);
    return WB_OK;
}

static void release_tests(struct wb_recordings_results_tests *tests)
{
    for (int i = 0; i < tests->n; i++) {
        wb_text_release(&tests->items[i].problem);
        wb_dataset_release(&tests->items[i].dataset);
    }
    free(tests->items);
}

void wb_recordings_results_release(struct wb_recordings_results *results)
{
    for (int i = 0; i < results->n_wires; i++) {
        struct wb_recordings_results_wire *const wire = &results->wires[i];
        release_tests(&wire->calibration_tests);
        release_tests(&wire->validation_tests);
        wb_text_release(&wire->calibration_problem);
        wb_text_release(&wire->validation_problem);
        if (wire->calibration_state == WB_RECORDINGS_DONE) {
            wb_calibrate_result_release(&wire->calibration);
            wb_validate_result_release(&wire->fit);
        }
        if (wire->validation_state == WB_RECORDINGS_DONE)
            wb_validate_result_release(&wire->validation);
    }
    free(results->wires);
    memset(results, 0, sizeof *results);
}

double wb_recordings_results_capacity(const struct wb_rig *rig)
{
    return rig->gravity > 0.0 ? rig->load_cell.capacity / rig->gravity : (double)NAN;
}

double wb_recordings_results_validation_share(const struct wb_recordings_results_wire *wire)
{
    return wire->validation_state == WB_RECORDINGS_DONE ? wire->validation.scatter_share
                                                        : (double)NAN;
}
