#include "analysis/report/bench/recordings_results.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <gsl/gsl_cdf.h>

#include "analysis/align/align.h"
#include "analysis/report/bench/recordings_results_private.h"
#include "analysis/report/reasons.h"
#include "base/interrupt.h"
#include "base/json.h"
#include "base/memory.h"
#include "daq/recording/recording.h"

#define WB_LOG_DOMAIN "report"

enum job_state {
    JOB_WAITING,
    JOB_RUNNING,
    JOB_FINISHED
};

/* The alignment of a recording, or a step of a wire: by the paper's route, or on whole cycles. */
struct job {
    enum job_state state;
    enum wb_recordings_purpose purpose;
    struct wb_recordings_results_wire *wire;
    struct wb_recordings_results_test *test; /* to align; NULL: the job is a step of a wire */
    bool is_cycle;
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

/* The text of the correction file, if there is one, else of the recording's meta `key`; NULL if
 * there is neither. */
static enum wb_status bench_text(struct wb_recording *recording, const char *key,
                                 const char *corrected, char **text, struct wb_reason *why)
{
    size_t size;
    if (corrected[0])
        return wb_file_read_with_reason(corrected, text, &size, why);
    const enum wb_status status = wb_recording_meta(recording, key, text);
    if (status != WB_OK)
        *text = NULL;
    return status == WB_ERR_NOT_FOUND ? WB_OK : status;
}

/* Reads rig and specimen from the recording or its correction files. The true values of a virtual
 * rig are not read. */
static enum wb_status read_rig_and_specimen(struct wb_recordings_results_test *test,
                                            struct wb_recording *recording, struct wb_reason *why)
{
    const struct wb_recordings_test *const wanted = test->wanted;
    char *text;
    WB_TRY(bench_text(recording, "rig", wanted->corrected_rig, &text, why));
    enum wb_status status = text ? wb_rig_parse(text, wanted->name, &test->rig, why) : WB_OK;
    free(text);
    WB_TRY(status);
    WB_TRY(bench_text(recording, "specimen", wanted->corrected_specimen, &text, why));
    status = text ? wb_specimen_parse(text, wanted->name, &test->specimen, why) : WB_OK;
    free(text);
    return status;
}

static enum wb_status read_bench(struct wb_recordings_results_test *test, struct wb_reason *why)
{
    struct wb_recording *recording;
    /* Alignment opens the recording again and reports defects of the file. */
    WB_TRY(wb_recording_open_with_reason(&recording, test->wanted->path, why));
    char is_virtual[16] = "";
    read_meta(recording, "start_utc", test->start_utc, sizeof test->start_utc);
    read_meta(recording, "tool_revision", test->tool_revision, sizeof test->tool_revision);
    read_meta(recording, "operator", test->operator_name, sizeof test->operator_name);
    read_meta(recording, "virtual", is_virtual, sizeof is_virtual);
    test->is_virtual = strcmp(is_virtual, "true") == 0;
    const enum wb_status status = read_rig_and_specimen(test, recording, why);
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

/* Also for a recording that cannot be aligned, so that the report identifies the file. */
static void keep_hash(struct wb_recordings_results_test *test)
{
    const struct wb_json *const list = wb_json_get(test->dataset.document, "recordings");
    const char *sha256;
    struct wb_reason why;
    if (wb_json_text(wb_json_get(wb_json_item(list, 0), "sha256"), &sha256))
        snprintf(test->sha256, sizeof test->sha256, "%s", sha256);
    else if (wb_recording_sha256(test->wanted->path, test->sha256, &why) != WB_OK)
        test->sha256[0] = '\0';
}

static enum wb_status align(struct wb_recordings_results_test *test, struct wb_reason *why)
{
    struct wb_align_settings settings;
    wb_align_default_settings(&settings);
    WB_TRY(read_bench(test, why));
    if (test->wanted->corrected_rig[0])
        settings.rig_path = test->wanted->corrected_rig;
    if (test->wanted->corrected_specimen[0])
        settings.specimen_path = test->wanted->corrected_specimen;
    return wb_align_run(&test->dataset, test->wanted->path, &settings, why);
}

static void run_align(const struct wb_recordings *campaign, const struct job *job)
{
    struct wb_recordings_results_test *const test = job->test;
    if (test->wanted->missing[0]) {
        wb_text_append(&test->problem, "%s", test->wanted->missing);
        return;
    }
    struct wb_reason why = {.text = ""};
    enum wb_status status = align(test, &why);
    keep_hash(test);
    if (status == WB_OK)
        status = check_identity(test, job->wire, campaign->length[job->purpose], &why);
    if (status != WB_OK)
        wb_dataset_release(&test->dataset);
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

/* By the paper's route: the calibration and its error, or the validation. */
static enum wb_status run_step(const struct wb_recordings *campaign, const struct job *job,
                               const struct wb_dataset *const *datasets, int n,
                               struct wb_reason *why)
{
    struct wb_recordings_results_wire *const wire = job->wire;
    const bool calibrates = job->purpose == WB_RECORDINGS_CALIBRATION;
    if (calibrates) {
        struct wb_calibrate_settings settings = campaign->head.fit;
        settings.progress = wb_campaign_go_on;
        WB_TRY(wb_calibrate_run(&wire->calibration, datasets, n, &settings, why));
        wb_properties_from_result(&wire->calibration, &wire->properties);
    }
    const enum wb_status status =
        wb_validate_run(&wire->steps[job->purpose].result, &wire->properties, datasets, n,
                        &campaign->head.fit, why);
    if (status != WB_OK && calibrates)
        wb_calibrate_result_release(&wire->calibration);
    return status;
}

/* On whole cycles: the calibration, or its prediction of the validation recordings. */
static enum wb_status run_cycle(const struct wb_recordings *campaign, const struct job *job,
                                const struct wb_dataset *const *datasets, int n,
                                struct wb_reason *why)
{
    struct wb_recordings_results_wire *const wire = job->wire;
    struct wb_properties properties;
    if (job->purpose == WB_RECORDINGS_CALIBRATION)
        return wb_recordings_cycle_run(&wire->cycle, datasets, n, why);
    wb_properties_from_cycle(&wire->cycle.calibration, &properties);
    return wb_validate_run(&wire->prediction, &properties, datasets, n, &campaign->head.fit, why);
}

/* A step of a wire, whose state is WB_RECORDINGS_MISSING until then. */
static void run_wire(const struct wb_recordings *campaign, const struct job *job)
{
    struct wb_recordings_results_wire *const wire = job->wire;
    struct wb_recordings_results_step *const step = &wire->steps[job->purpose];
    enum wb_recordings_results_state *const state =
        job->is_cycle ? &wire->cycle_states[job->purpose] : &step->state;
    struct wb_text *const problem =
        job->is_cycle ? &wire->cycle_problems[job->purpose] : &step->problem;
    const enum wb_recordings_results_state calibration =
        job->is_cycle ? wire->cycle_states[0] : wire->steps[0].state;
    const struct wb_dataset **const datasets =
        wb_memory_new((size_t)step->tests.n, sizeof *datasets);
    const int n = usable_datasets(&step->tests, datasets);
    if (n == 0) {
        wb_text_append(problem, "no usable recording");
    } else if (job->purpose == WB_RECORDINGS_VALIDATION && calibration != WB_RECORDINGS_DONE) {
        wb_text_append(problem, "there is no calibration to validate");
    } else {
        const struct wb_reasons reasons = {problem, NULL, NULL};
        struct wb_reason why = {.text = ""};
        const enum wb_status status = job->is_cycle ? run_cycle(campaign, job, datasets, n, &why)
                                                    : run_step(campaign, job, datasets, n, &why);
        *state = status == WB_OK ? WB_RECORDINGS_DONE : WB_RECORDINGS_FAILED;
        if (status != WB_OK)
            wb_reasons_fail(&reasons, status, &why);
    }
    free(datasets);
}

/* --- the schedule --- */

/* A calibration waits for the alignment of its recordings, a validation for that of all recordings
 * of its wire and for the calibration. */
static bool comes_before(const struct job *other, const struct job *job)
{
    if (other->wire != job->wire)
        return false;
    return other->test ? other->purpose <= job->purpose
                       : other->purpose < job->purpose && other->is_cycle == job->is_cycle;
}

static bool is_ready(const struct schedule *schedule, const struct job *job)
{
    for (int i = 0; i < schedule->n && !job->test; i++) {
        const struct job *const other = &schedule->jobs[i];
        if (other->state != JOB_FINISHED && comes_before(other, job))
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

static void report_progress(const struct schedule *schedule, const struct job *job)
{
    if (!schedule->progress)
        return;
    char what[160];
    static const char *const done[] = {"calibrated", "validated"};
    snprintf(what, sizeof what, "%s %.120s%s", job->test ? "aligned" : done[job->purpose],
             job->test ? job->test->wanted->name : job->wire->wanted->label,
             job->is_cycle ? " on whole cycles" : "");
    schedule->progress(schedule->context, schedule->n_finished, what);
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
        if (job->test)
            run_align(schedule->results->campaign, job);
        else
            run_wire(schedule->results->campaign, job);
        pthread_mutex_lock(&schedule->lock);
        job->state = JOB_FINISHED;
        schedule->n_finished++;
        report_progress(schedule, job);
        pthread_cond_broadcast(&schedule->changed);
    }
    /* After an interrupt, wakes the threads that still wait for a job. */
    pthread_cond_broadcast(&schedule->changed);
    pthread_mutex_unlock(&schedule->lock);
    return NULL;
}

static void add_steps(struct schedule *schedule, enum wb_recordings_purpose purpose, bool is_cycle)
{
    for (int i = 0; i < schedule->results->n_wires; i++) {
        struct wb_recordings_results_wire *const wire = &schedule->results->wires[i];
        const enum wb_recordings_results_state state =
            is_cycle ? wire->cycle_states[purpose] : wire->steps[purpose].state;
        if (state != WB_RECORDINGS_NOT_WANTED)
            schedule->jobs[schedule->n++] =
                (struct job){.purpose = purpose, .wire = wire, .is_cycle = is_cycle};
    }
}

static void add_alignments(struct schedule *schedule, enum wb_recordings_purpose purpose)
{
    for (int i = 0; i < schedule->results->n_wires; i++) {
        struct wb_recordings_results_wire *const wire = &schedule->results->wires[i];
        const struct wb_recordings_results_tests *const tests = &wire->steps[purpose].tests;
        for (int k = 0; k < tests->n; k++) {
            if (!tests->items[k].wanted->excluded.is_excluded)
                schedule->jobs[schedule->n++] =
                    (struct job){.purpose = purpose, .wire = wire, .test = &tests->items[k]};
        }
    }
}

static void add_jobs(struct schedule *schedule)
{
    /* The longest first. */
    add_steps(schedule, WB_RECORDINGS_CALIBRATION, true);
    add_steps(schedule, WB_RECORDINGS_CALIBRATION, false);
    add_alignments(schedule, WB_RECORDINGS_CALIBRATION);
    add_alignments(schedule, WB_RECORDINGS_VALIDATION);
    add_steps(schedule, WB_RECORDINGS_VALIDATION, true);
    add_steps(schedule, WB_RECORDINGS_VALIDATION, false);
}

static void run_threads(struct schedule *schedule, int n_threads)
{
    pthread_t threads[16];
    int n = 0;
    /* A thread that cannot be started is not an error: the calling thread works, too. */
    while (n < n_threads - 1 && n < 16 && pthread_create(&threads[n], NULL, work, schedule) == 0)
        n++;
    work(schedule);
    for (int i = 0; i < n; i++)
        pthread_join(threads[i], NULL);
}

/* --- preparing, computing, releasing --- */

static void prepare_tests(struct wb_recordings_results_tests *tests,
                          const struct wb_recordings_tests *wanted)
{
    tests->items = wb_memory_new((size_t)wanted->n, sizeof *tests->items);
    tests->n = wanted->n;
    for (int i = 0; i < wanted->n; i++)
        tests->items[i].wanted = &wanted->items[i];
}

enum wb_status wb_recordings_results_load(void *context, const void *of)
{
    struct wb_recordings_results *const results = context;
    const struct wb_recordings *const campaign = of;
    struct wb_kind_outcome *const outcome = &results->outcome;
    results->campaign = campaign;
    outcome->campaign = &campaign->head;
    outcome->n_wanted = wb_recordings_count(campaign, &outcome->n_missing);
    outcome->n_steps = outcome->n_wanted;
    results->wires = wb_memory_new((size_t)campaign->n_wires, sizeof *results->wires);
    results->n_wires = campaign->n_wires;
    for (int i = 0; i < campaign->n_wires; i++) {
        struct wb_recordings_results_wire *const wire = &results->wires[i];
        wire->wanted = &campaign->wires[i];
        for (int k = 0; k < WB_RECORDINGS_PURPOSES; k++) {
            const bool is_wanted = campaign->length[k] > 0.0;
            const bool has_cycle = is_wanted && campaign->whole_cycle;
            wire->steps[k].state = is_wanted ? WB_RECORDINGS_MISSING : WB_RECORDINGS_NOT_WANTED;
            wire->cycle_states[k] = has_cycle ? WB_RECORDINGS_MISSING : WB_RECORDINGS_NOT_WANTED;
            outcome->n_steps += is_wanted + has_cycle;
            prepare_tests(&wire->steps[k].tests, &wire->wanted->tests[k]);
        }
    }
    return WB_OK;
}

static void count_test(struct wb_recordings_results *results,
                       struct wb_recordings_results_tests *tests,
                       const struct wb_recordings_results_test *test)
{
    tests->n_usable++;
    results->outcome.n_usable++;
    results->any_virtual |= test->is_virtual;
    results->all_virtual &= test->is_virtual;
    if (strcmp(test->start_utc, results->latest_utc) > 0)
        memcpy(results->latest_utc, test->start_utc, sizeof results->latest_utc);
}

static bool is_settled(enum wb_recordings_results_state state)
{
    return state == WB_RECORDINGS_DONE || state == WB_RECORDINGS_NOT_WANTED;
}

static void judge_step(struct wb_recordings_results *results,
                       struct wb_recordings_results_wire *wire, enum wb_recordings_purpose purpose)
{
    struct wb_recordings_results_step *const step = &wire->steps[purpose];
    const double limit = results->campaign->limit[purpose];
    for (int i = 0; i < step->tests.n; i++) {
        if (step->tests.items[i].usable)
            count_test(results, &step->tests, &step->tests.items[i]);
    }
    results->outcome.is_complete &=
        is_settled(step->state) && is_settled(wire->cycle_states[purpose]);
    if (step->state == WB_RECORDINGS_DONE && limit > 0.0 &&
        !wb_recordings_results_keeps(results->campaign, wire, purpose))
        results->outcome.exceeds_limit = true;
}

void wb_recordings_results_judge(struct wb_recordings_results *results)
{
    results->all_virtual = true;
    results->outcome.is_complete = true;
    for (int i = 0; i < results->n_wires; i++) {
        judge_step(results, &results->wires[i], WB_RECORDINGS_CALIBRATION);
        judge_step(results, &results->wires[i], WB_RECORDINGS_VALIDATION);
        if (results->campaign->pooled_scatter && wb_recordings_results_cycle(&results->wires[i]))
            wb_recordings_cycle_pool(&results->pool, &results->wires[i].cycle);
    }
    wb_recordings_cycle_close(&results->pool);
    results->outcome.is_complete &= results->outcome.n_usable == results->outcome.n_wanted;
    results->all_virtual &= results->outcome.n_usable > 0;
}

enum wb_status wb_recordings_results_compute(void *of, int n_threads, wb_kind_progress *progress,
                                             void *context)
{
    struct wb_recordings_results *const results = of;
    struct schedule schedule = {.lock = PTHREAD_MUTEX_INITIALIZER,
                                .changed = PTHREAD_COND_INITIALIZER,
                                .results = results,
                                .progress = progress,
                                .context = context};
    schedule.jobs = wb_memory_new((size_t)results->outcome.n_steps, sizeof *schedule.jobs);
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

static void release_step(struct wb_recordings_results_step *step)
{
    for (int i = 0; i < step->tests.n; i++) {
        wb_text_release(&step->tests.items[i].problem);
        wb_dataset_release(&step->tests.items[i].dataset);
    }
    free(step->tests.items);
    wb_text_release(&step->problem);
    if (step->state == WB_RECORDINGS_DONE)
        wb_validate_result_release(&step->result);
}

void wb_recordings_results_release(void *context)
{
    struct wb_recordings_results *const results = context;
    for (int i = 0; i < results->n_wires; i++) {
        struct wb_recordings_results_wire *const wire = &results->wires[i];
        if (wb_recordings_results_of(wire, WB_RECORDINGS_CALIBRATION))
            wb_calibrate_result_release(&wire->calibration);
        if (wb_recordings_results_cycle(wire))
            wb_recordings_cycle_release(&wire->cycle);
        wb_validate_result_release(&wire->prediction);
        for (int k = 0; k < WB_RECORDINGS_PURPOSES; k++) {
            wb_text_release(&wire->cycle_problems[k]);
            release_step(&wire->steps[k]);
        }
    }
    free(results->wires);
    memset(results, 0, sizeof *results);
}

/* --- access --- */

struct wb_recordings_results_test *
wb_recordings_results_at(const struct wb_recordings_results *results, int index,
                         const struct wb_recordings_results_wire **wire,
                         enum wb_recordings_purpose *purpose)
{
    for (int i = 0; i < WB_RECORDINGS_PURPOSES * results->n_wires; i++) {
        const struct wb_recordings_results_wire *const of =
            &results->wires[i / WB_RECORDINGS_PURPOSES];
        const struct wb_recordings_results_tests *const tests =
            &of->steps[i % WB_RECORDINGS_PURPOSES].tests;
        if (index < tests->n) {
            if (wire)
                *wire = of;
            if (purpose)
                *purpose = (enum wb_recordings_purpose)(i % WB_RECORDINGS_PURPOSES);
            return &tests->items[index];
        }
        index -= tests->n;
    }
    return NULL;
}

const struct wb_validate_result *
wb_recordings_results_of(const struct wb_recordings_results_wire *wire,
                         enum wb_recordings_purpose purpose)
{
    const struct wb_recordings_results_step *const step = &wire->steps[purpose];
    return step->state == WB_RECORDINGS_DONE ? &step->result : NULL;
}

const struct wb_recordings_cycle *
wb_recordings_results_cycle(const struct wb_recordings_results_wire *wire)
{
    return wire->cycle_states[WB_RECORDINGS_CALIBRATION] == WB_RECORDINGS_DONE ? &wire->cycle
                                                                               : NULL;
}

const struct wb_validate_result *
wb_recordings_results_prediction(const struct wb_recordings_results_wire *wire)
{
    return wire->cycle_states[WB_RECORDINGS_VALIDATION] == WB_RECORDINGS_DONE ? &wire->prediction
                                                                              : NULL;
}

double wb_recordings_results_rms(const struct wb_recordings_results_wire *wire,
                                 enum wb_recordings_purpose purpose)
{
    return purpose == WB_RECORDINGS_CALIBRATION ? wire->calibration.rms
                                                : wire->steps[purpose].result.elastoplastic.rms;
}

double wb_recordings_results_uncertainty(const struct wb_recordings_results_wire *wire,
                                         enum wb_recordings_purpose purpose)
{
    const struct wb_calibrate_result *const c = &wire->calibration;
    if (purpose == WB_RECORDINGS_VALIDATION)
        return wire->steps[purpose].result.expected_rms_95;
    if (c->n_samples < 2)
        return (double)NAN;
    return gsl_cdf_tdist_Qinv(0.025, c->n_samples - 1) *
           fmin(c->scatter_rms, c->residual_scatter_rms) / sqrt(c->n_samples);
}

bool wb_recordings_results_keeps(const struct wb_recordings *campaign,
                                 const struct wb_recordings_results_wire *wire,
                                 enum wb_recordings_purpose purpose)
{
    return wb_verdict_keeps(
        campaign->head.laboratory.rule, wb_recordings_results_rms(wire, purpose),
        wb_recordings_results_uncertainty(wire, purpose), campaign->limit[purpose]);
}

double wb_recordings_results_capacity(const struct wb_rig *rig)
{
    return rig->gravity > 0.0 ? rig->load_cell.capacity / rig->gravity : (double)NAN;
}
