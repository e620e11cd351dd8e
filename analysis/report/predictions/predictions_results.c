#include "analysis/report/predictions/predictions_private.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/dataset/curve.h"
#include "analysis/report/reasons.h"
#include "base/hash.h"
#include "base/interrupt.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "report"

enum {
    THIRDS = 3
};

/* --- tests --- */

static enum wb_status check_length(const struct wb_dataset *dataset,
                                   const struct wb_bundle_model *model, struct wb_reason *why)
{
    static const double same = 0.02; /* of the length: 1 % of it is 2.2 % of the force */
    if (fabs(dataset->info.length - model->length) <= same * model->length)
        return WB_OK;
    return wb_fail_to(why, WB_ERR_DATA,
                      "its free length is %.4g mm, that of the bundle's file %.4g mm: a bundle's "
                      "stiffness goes with its length; predict the length that was tested",
                      dataset->info.length / WB_MM, model->length / WB_MM);
}

static enum wb_status read_test(struct wb_predictions_verdict *verdict,
                                const struct wb_predictions_test *test,
                                const struct wb_bundle_model *model, struct wb_reason *why)
{
    char path[WB_PATH];
    WB_TRY(wb_dataset_read(&verdict->dataset, test->path, why));
    enum wb_status status = check_length(&verdict->dataset, model, why);
    if (status == WB_OK)
        status = wb_file_join(path, test->path, "force_deflection.csv");
    if (status == WB_OK)
        status = wb_hash_file(path, verdict->sha256);
    if (status != WB_OK)
        wb_dataset_release(&verdict->dataset);
    return status;
}

static void load_test(struct wb_predictions_verdict *verdict,
                      const struct wb_predictions_test *test, const struct wb_bundle_model *model)
{
    const struct wb_reasons reasons = {&verdict->problem, test->path, test->given};
    struct wb_reason why = {.text = ""};
    char path[WB_PATH];
    verdict->state = WB_SIMULATION_MISSING;
    if (wb_file_join(path, test->path, "dataset.json") != WB_OK || !wb_file_exists(path)) {
        wb_text_append(&verdict->problem, "there is no such dataset");
        return;
    }
    const enum wb_status status = read_test(verdict, test, model, &why);
    verdict->state = status == WB_OK ? WB_SIMULATION_USABLE : WB_SIMULATION_REFUSED;
    if (status != WB_OK)
        wb_reasons_fail(&reasons, status, &why);
}

enum wb_status wb_predictions_results_load(void *context, const void *of)
{
    struct wb_predictions_results *const results = context;
    const struct wb_predictions *const campaign = of;
    results->campaign = campaign;
    results->outcome.campaign = &campaign->head;
    results->outcome.n_steps = campaign->n_bundles;
    for (int b = 0; b < campaign->n_bundles; b++) {
        const struct wb_predictions_bundle *const bundle = &campaign->bundles[b];
        for (int i = 0; i < bundle->n_tests; i++) {
            struct wb_predictions_verdict *const verdict = &results->bundles[b].tests[i];
            load_test(verdict, &bundle->tests[i], bundle->model);
            results->outcome.n_wanted++;
            results->outcome.n_missing += verdict->state == WB_SIMULATION_MISSING;
            results->outcome.n_usable += verdict->state == WB_SIMULATION_USABLE;
        }
    }
    return WB_OK;
}

/* --- a test beside its bands --- */

/* Straight between the places; NaN beyond them. */
static struct wb_bands_interval band_at(const struct wb_bands_case *c, double at)
{
    const double none = (double)NAN;
    for (int i = 1; i < c->n_force; i++) {
        const struct wb_bands_place *const a = &c->force[i - 1], *const b = &c->force[i];
        if (!(at <= b->at))
            continue;
        const double t = (at - a->at) / (b->at - a->at);
        const struct wb_bands_interval *const p = &a->band, *const q = &b->band;
        return (struct wb_bands_interval){
            .median = p->median + t * (q->median - p->median),
            .low = p->low + t * (q->low - p->low),
            .high = p->high + t * (q->high - p->high),
            .wide_low = p->wide_low + t * (q->wide_low - p->wide_low),
            .wide_high = p->wide_high + t * (q->wide_high - p->wide_high),
        };
    }
    return (struct wb_bands_interval){none, none, none, none, none};
}

/* Straight between the rows of the first loading; NaN beyond them. */
static double force_at(const struct wb_dataset *dataset, double at)
{
    const size_t n = wb_curve_end_of_loading(dataset, 0.0);
    const struct wb_row *before = NULL;
    for (size_t i = 0; i < n; i++) {
        const struct wb_row *const row = &dataset->rows[i];
        if (row->phase != WB_PHASE_LOAD)
            continue;
        if (before && before->deflection <= at && at <= row->deflection)
            return before->force + (at - before->deflection) /
                                       (row->deflection - before->deflection) *
                                       (row->force - before->force);
        before = row;
    }
    return (double)NAN;
}

static double largest_deflection(const struct wb_dataset *dataset)
{
    const size_t n = wb_curve_end_of_loading(dataset, 0.0);
    double most = 0.0;
    for (size_t i = 0; i < n; i++)
        most =
            fmax(most, dataset->rows[i].phase == WB_PHASE_LOAD ? dataset->rows[i].deflection : 0.0);
    return most;
}

/* 1 - d_0 / d_max, with the deflection at zero force on the first unloading; NaN: the force does
 * not reach it. */
static double springback(const struct wb_dataset *dataset)
{
    const struct wb_row *before = NULL;
    for (size_t i = 0; i < dataset->n_rows && dataset->rows[i].cycle == 1; i++) {
        const struct wb_row *const row = &dataset->rows[i];
        if (row->phase == WB_PHASE_SLACK)
            continue;
        if (row->phase == WB_PHASE_UNLOAD && before && before->force > 0.0 && row->force <= 0.0) {
            const double t = before->force / (before->force - row->force);
            const double free = before->deflection + t * (row->deflection - before->deflection);
            return 1.0 - free / largest_deflection(dataset);
        }
        before = row;
    }
    return (double)NAN;
}

static enum wb_predictions_side find_side(double measured, const struct wb_bands_interval *band)
{
    if (!isfinite(measured) || !isfinite(band->wide_low) || !isfinite(band->wide_high))
        return WB_PREDICTIONS_UNKNOWN;
    return measured < band->wide_low    ? WB_PREDICTIONS_BELOW
           : measured > band->wide_high ? WB_PREDICTIONS_ABOVE
                                        : WB_PREDICTIONS_WITHIN;
}

/* How many of the first n places are on that side of their band. */
static int count(const struct wb_predictions_place *places, int n, enum wb_predictions_side side)
{
    int found = 0;
    for (int i = 0; i < n; i++)
        found += places[i].side == side;
    return found;
}

static int count_outside(const struct wb_predictions_place places[WB_PREDICTIONS_PLACES])
{
    return count(places, WB_PREDICTIONS_PLACES, WB_PREDICTIONS_BELOW) +
           count(places, WB_PREDICTIONS_PLACES, WB_PREDICTIONS_ABOVE);
}

static void compare(struct wb_predictions_verdict *verdict, const struct wb_bands_case *against)
{
    struct wb_predictions_place *const places = verdict->places;
    const double predicted = against->n_force > 0 ? against->force[against->n_force - 1].at : 0.0;
    /* Slightly before the end: there is no row beyond it. */
    const double most = fmin(largest_deflection(&verdict->dataset), predicted) * (1.0 - 1e-9);
    verdict->against = against;
    for (int i = 0; i < THIRDS; i++) {
        places[i].at = most * (i + 1) / THIRDS;
        places[i].measured = force_at(&verdict->dataset, places[i].at);
        places[i].band = band_at(against, places[i].at);
    }
    places[THIRDS].at = (double)NAN;
    places[THIRDS].measured = springback(&verdict->dataset);
    places[THIRDS].band = against->springback;
    for (int i = 0; i < WB_PREDICTIONS_PLACES; i++)
        places[i].side = find_side(places[i].measured, &places[i].band);
    verdict->n_outside = count_outside(places);
    verdict->words = wb_predictions_judge(places);
}

const char *wb_predictions_judge(const struct wb_predictions_place places[WB_PREDICTIONS_PLACES])
{
    const int n = WB_PREDICTIONS_PLACES;
    const int below = count(places, THIRDS, WB_PREDICTIONS_BELOW);
    const int above = count(places, THIRDS, WB_PREDICTIONS_ABOVE);
    const int outside = count_outside(places);
    if (count(places, n, WB_PREDICTIONS_UNKNOWN) == n)
        return "nothing of it can be judged: it does not reach where the prediction is";
    if (outside == 0)
        return "within: model, calibration and measured section agree within their uncertainties";
    if (below == THIRDS || above == THIRDS)
        return above == THIRDS
                   ? "stiffer than predicted at every deflection: look at diameter and length "
                     "first, then at layers and bond"
                   : "softer than predicted at every deflection: look at diameter and length "
                     "first, then at layers and bond";
    if (places[0].side == WB_PREDICTIONS_WITHIN && places[2].side == WB_PREDICTIONS_BELOW)
        return "within at first, too soft later: the tape lets go of the wires, or a bond breaks";
    if (below + above == 0)
        return "force within, springback of the deflection outside: the law of the wires beyond "
               "yield, or the bond";
    if (outside == 1)
        return "one number outside: of ten such numbers one is expected there; test a second "
               "bundle";
    return "some numbers outside, on no one pattern: test a second bundle, and cut this one";
}

/* --- all of it --- */

static const struct wb_bands_case *find_case(const struct wb_bands *bands, const char *name)
{
    for (int i = 0; i < bands->n_cases; i++)
        if (strcmp(bands->cases[i].variant.name, name) == 0)
            return &bands->cases[i];
    return NULL;
}

static void predict(struct wb_predictions_results *results, int index, int n_threads)
{
    const struct wb_predictions *const campaign = results->campaign;
    const struct wb_predictions_bundle *const bundle = &campaign->bundles[index];
    struct wb_predictions_prediction *const prediction = &results->bundles[index];
    const struct wb_bands_settings settings = {
        .runs = campaign->runs,
        .seed = (uint64_t)campaign->seed,
        .n_threads = n_threads,
        .stop = wb_interrupt_stops,
    };
    const enum wb_status status =
        wb_bands_create(&prediction->bands, bundle->model->path, &settings);
    if (status != WB_OK)
        wb_text_append(&prediction->problem, "%s", wb_status_text(status));
    for (int i = 0; i < bundle->n_tests && prediction->bands; i++) {
        const struct wb_bands_case *const against =
            find_case(prediction->bands, bundle->tests[i].case_name);
        if (against && prediction->tests[i].state == WB_SIMULATION_USABLE)
            compare(&prediction->tests[i], against);
    }
}

enum wb_status wb_predictions_results_compute(void *of, int n_threads, wb_kind_progress *progress,
                                              void *context)
{
    struct wb_predictions_results *const results = of;
    const struct wb_predictions *const campaign = results->campaign;
    bool all = true;
    for (int i = 0; i < campaign->n_bundles && !wb_interrupted(); i++) {
        predict(results, i, n_threads);
        all = all && results->bundles[i].bands;
        if (progress)
            progress(context, i + 1, campaign->bundles[i].label);
    }
    results->outcome.interrupted = wb_interrupted();
    results->outcome.is_complete = all && results->outcome.n_usable == results->outcome.n_wanted;
    /* One of four outside is no failure: one of ten is expected outside. */
    for (int b = 0; b < campaign->n_bundles; b++)
        for (int i = 0; i < campaign->bundles[b].n_tests; i++)
            results->outcome.exceeds_limit |= results->bundles[b].tests[i].n_outside > 1;
    return WB_OK;
}

void wb_predictions_results_release(void *context)
{
    struct wb_predictions_results *const results = context;
    for (int b = 0; b < WB_PREDICTIONS_BUNDLES; b++) {
        struct wb_predictions_prediction *const prediction = &results->bundles[b];
        wb_bands_destroy(prediction->bands);
        wb_text_release(&prediction->problem);
        for (int i = 0; i < WB_PREDICTIONS_TESTS; i++) {
            if (prediction->tests[i].state == WB_SIMULATION_USABLE)
                wb_dataset_release(&prediction->tests[i].dataset);
            wb_text_release(&prediction->tests[i].problem);
        }
    }
    memset(results, 0, sizeof *results);
}
