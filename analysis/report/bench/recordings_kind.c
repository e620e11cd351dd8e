#include "analysis/report/bench/recordings_kind.h"

#include <stdio.h>
#include <string.h>

#include "analysis/report/bench/recordings_figures.h"
#include "base/units.h"

static void print_step(FILE *out, const struct wb_recordings_results *results, int index,
                       enum wb_recordings_purpose purpose)
{
    const struct wb_recordings_results_wire *const wire = &results->wires[index];
    const enum wb_recordings_results_state state = wire->steps[purpose].state;
    const char *const what = wb_recordings_purposes[purpose];
    const double rms = wb_recordings_results_rms(wire, purpose);
    const double limit = results->campaign->limit[purpose];
    if (state == WB_RECORDINGS_NOT_WANTED)
        return;
    if (state != WB_RECORDINGS_DONE)
        fprintf(out, "  %s missing", what);
    else if (limit > 0.0 && !wb_recordings_results_keeps(results->campaign, wire, purpose))
        fprintf(out, "  %s RMS %.4f (limit %.4g exceeded)", what, rms, limit);
    else
        fprintf(out, "  %s RMS %.4f", what, rms);
}

/* What the law of the whole cycles says of the other length; NULL: nothing. */
static void print_prediction(FILE *out, const struct wb_validate_result *prediction)
{
    if (!prediction)
        return;
    fprintf(out, ", %g mm predicted with RMS %.4f", prediction->info.length / WB_MM,
            prediction->elastoplastic.rms);
    if (prediction->cycles.n_samples > 0)
        fprintf(out, ", unloading %.4f", prediction->cycles.rms);
}

/* NULL: the campaign has no whole cycles. */
static void print_cycle(FILE *out, const struct wb_recordings_cycle *cycle)
{
    if (!cycle)
        return;
    const struct wb_cycle_calibration *const c = &cycle->calibration;
    const struct wb_estimate *const stiffness = wb_recordings_cycle_stiffness(c);
    if (c->has_unloading && !c->is_followed)
        fprintf(out, "  stiffness %.0f to %.0f N mm2, no law fits the data",
                stiffness->candidates_low / WB_NMM2, stiffness->candidates_high / WB_NMM2);
    else
        fprintf(out, "  stiffness %.0f N mm2%s", stiffness->value / WB_NMM2,
                c->has_unloading ? "" : " by loading alone");
    if (c->has_unloading && c->is_followed)
        fprintf(out, ", residual curvature ratio %.3f", c->residual_curvature_ratio.value);
}

/* Each recording that is missing or was rejected, with the reason. */
static void print_missing(FILE *out, const struct wb_recordings_results *results)
{
    const struct wb_recordings_results_test *test;
    for (int i = 0; (test = wb_recordings_results_at(results, i, NULL, NULL)); i++) {
        if (!test->usable && !test->wanted->excluded.is_excluded)
            fprintf(out, "  not used: %s: %s\n", test->wanted->name,
                    wb_text_string(&test->problem));
    }
}

static void print(FILE *out, const void *context)
{
    const struct wb_recordings_results *const results = context;
    const struct wb_recordings *const campaign = results->campaign;
    fprintf(out, "%s%s: %d of %d recordings used\n", campaign->head.title,
            results->any_virtual ? " (virtual rig)" : "", results->outcome.n_usable,
            results->outcome.n_wanted);
    print_missing(out, results);
    for (int i = 0; i < results->n_wires; i++) {
        fprintf(out, "%-10s", results->wires[i].wanted->label);
        print_cycle(out, wb_recordings_results_cycle(&results->wires[i]));
        print_prediction(out, wb_recordings_results_prediction(&results->wires[i]));
        if (campaign->whole_cycle)
            fprintf(out, "; by the paper's route");
        print_step(out, results, i, WB_RECORDINGS_CALIBRATION);
        print_step(out, results, i, WB_RECORDINGS_VALIDATION);
        fprintf(out, "\n");
    }
}

/* Recordings that a wire was calibrated on; returns how many. */
static int list_recordings(const struct wb_recordings_results_tests *tests,
                           struct wb_properties_dataset list[WB_PROPERTIES_MOST_DATASETS])
{
    int n = 0;
    for (int i = 0; i < tests->n && n < WB_PROPERTIES_MOST_DATASETS; i++) {
        const struct wb_recordings_results_test *const test = &tests->items[i];
        if (!test->usable)
            continue;
        struct wb_properties_dataset *const entry = &list[n++];
        *entry = (struct wb_properties_dataset){.is_recording = true};
        snprintf(entry->name, sizeof entry->name, "%.95s", test->wanted->name);
        snprintf(entry->sha256, sizeof entry->sha256, "%s", test->sha256);
    }
    return n;
}

/* Of each wire the law of the whole cycles, or where there is none that of the paper's route. */
static enum wb_status add_cards(struct wb_cards *cards, const void *context)
{
    const struct wb_recordings_results *const results = context;
    struct wb_properties_dataset list[WB_PROPERTIES_MOST_DATASETS];
    for (int i = 0; i < results->n_wires; i++) {
        const struct wb_recordings_results_wire *const wire = &results->wires[i];
        const struct wb_recordings_results_step *const step =
            &wire->steps[WB_RECORDINGS_CALIBRATION];
        const struct wb_recordings_cycle *const cycle = wb_recordings_results_cycle(wire);
        const int n = list_recordings(&step->tests, list);
        struct wb_text text = {0};
        if (cycle) {
            struct wb_cycle_calibrate_settings settings;
            wb_cycle_calibrate_default_settings(&settings);
            wb_properties_format_cycle(&text, &cycle->calibration, &settings, list, n);
        } else if (step->state == WB_RECORDINGS_DONE) {
            wb_properties_format(&text, &wire->calibration, &results->campaign->head.fit, list, n);
        } else {
            continue;
        }
        WB_TRY(wb_cards_add(cards, wire->wanted->product.name, &text));
    }
    return WB_OK;
}

static bool take_recording(const void *results, int index, struct wb_kind_recording *recording)
{
    const struct wb_recordings_results_test *const test =
        wb_recordings_results_at(results, index, NULL, NULL);
    if (test)
        *recording = (struct wb_kind_recording){.name = test->wanted->name,
                                                .sha256 = test->usable ? test->sha256 : NULL};
    return test;
}

const struct wb_kind wb_recordings_kind = {
    .name = "recordings",
    .data = "recordings",
    .has_uncertainties = true,
    .campaign_size = sizeof(struct wb_recordings),
    .results_size = sizeof(struct wb_recordings_results),
    .keys = wb_recordings_keys,
    .load = wb_recordings_results_load,
    .recordings = take_recording,
    .compute = wb_recordings_results_compute,
    .figures = wb_recordings_figures,
    .n_figures = WB_RECORDINGS_FIGURES,
    .pages = wb_recordings_pages_build,
    .cards = add_cards,
    .json = wb_recordings_json_build,
    .print = print,
    .release = wb_recordings_results_release,
    .release_campaign = wb_recordings_release,
};
