#include "analysis/report/predictions/predictions_kind.h"
#include "analysis/dataset/simulated_bundle.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/keys/row.h"
#include "analysis/predict/bands_output.h"
#include "analysis/report/draw/figures_bundle.h"
#include "analysis/report/found.h"
#include "analysis/report/numbers.h"
#include "analysis/report/pages.h"
#include "base/memory.h"
#include "base/units.h"

static const char *const side_names[] = {"below", "within", "above", "not reached"};

static const char *side_of(const struct wb_predictions_place *place)
{
    return side_names[place->side - WB_PREDICTIONS_BELOW];
}

static const char *origin_of(const struct wb_dataset *dataset)
{
    return dataset->info.is_simulation ? "a simulation, no test"
           : dataset->info.is_virtual  ? "measured on a virtual rig"
                                       : "measured";
}

/* --- figures --- */

static int count_bundles(const void *context)
{
    const struct wb_predictions_results *const results = context;
    return results->campaign->n_bundles;
}

static enum wb_status draw_section(struct wb_figures_item *item)
{
    const struct wb_predictions_results *const results = item->results;
    const struct wb_predictions_bundle *const bundle = &results->campaign->bundles[item->index];
    const struct wb_bundle_model *const models[] = {bundle->model};
    char name[64];
    snprintf(name, sizeof name, "section-%d", item->index + 1);
    wb_text_append(&item->caption, "Section of ");
    wb_text_append_escaped(&item->caption, bundle->label);
    wb_text_append(&item->caption, ", as its file has it, and the homogenised cylinder.");
    return wb_figures_bundle_draw(&item->figure, name, 1, models, bundle->model->run.mesh);
}

/* The rows of a test, over the bands. */
static void add_test(struct wb_panel *panel, const char *label,
                     const struct wb_predictions_verdict *verdict)
{
    static const struct wb_figure_style style = {.colour = WB_PALETTE_INK, .width = 1.0};
    const size_t n = verdict->dataset.n_rows;
    struct wb_text escaped = {0};
    double *const x = wb_memory_new(2 * n, sizeof *x);
    size_t used = 0;
    for (size_t i = 0; i < n; i++) {
        if (verdict->dataset.rows[i].phase == WB_PHASE_SLACK)
            continue;
        x[used] = verdict->dataset.rows[i].deflection / WB_MM;
        x[n + used++] = verdict->dataset.rows[i].force;
    }
    wb_text_append_escaped(&escaped, label);
    if (verdict->dataset.info.is_simulation || verdict->dataset.info.is_virtual)
        wb_text_append(&escaped, " (%s)", origin_of(&verdict->dataset));
    wb_figure_add_line(panel, wb_text_string(&escaped), used, x, x + n, &style);
    wb_text_release(&escaped);
    free(x);
}

static enum wb_status draw_bands(struct wb_figures_item *item)
{
    const struct wb_predictions_results *const results = item->results;
    const struct wb_predictions_bundle *const bundle = &results->campaign->bundles[item->index];
    const struct wb_predictions_prediction *const of = &results->bundles[item->index];
    struct wb_panel *panels[WB_BANDS_OUTPUT_PANELS];
    char name[64];
    int n_tests = 0;
    if (!of->bands)
        return WB_OK;
    snprintf(name, sizeof name, "bands-%d", item->index + 1);
    WB_TRY(wb_figures_start_simulation(&item->figure, name, 250.0));
    wb_bands_output_draw(of->bands, item->figure, panels);
    wb_figure_set_y_range(panels[0], 0.0, (double)NAN);
    wb_figure_set_y_range(panels[1], 0.0, (double)NAN);
    for (int i = 0; i < bundle->n_tests; i++) {
        if (of->tests[i].state != WB_SIMULATION_USABLE)
            continue;
        add_test(panels[0], bundle->tests[i].label, &of->tests[i]);
        n_tests++;
    }
    if (n_tests > 0)
        wb_figure_set_footer(item->figure, "bands and medians: simulation");
    wb_text_append(&item->caption,
                   "Predicted force and, of the homogenised beam of this length and these ends, "
                   "moment over curvature: median and band of 90 %%, with the model's error.%s%s",
                   of->bands->n_cases > 1 ? " A colour for each case." : "",
                   n_tests > 0 ? " Black: tests, with their unloading." : "");
    return WB_OK;
}

static const struct wb_figures_row figures[] = {
    {.place = "bands", .count = count_bundles, .draw = draw_bands},
    {.place = "section", .count = count_bundles, .draw = draw_section},
};

/* --- pages --- */

/* One case: force at the largest deflection and springback, with their bands. */
static void add_case(struct wb_found *found, const char *label, const struct wb_bands *bands,
                     const struct wb_bands_case *c)
{
    const struct wb_bands_place *const last = c->n_force > 0 ? &c->force[c->n_force - 1] : NULL;
    struct wb_text text = {0};
    wb_text_append(&text, "<b>");
    wb_text_append_escaped(&text, label);
    if (bands->n_cases > 1) {
        wb_text_append(&text, ", case ");
        wb_text_append_escaped(&text, c->variant.name);
    }
    wb_text_append(&text, "</b>: ");
    if (!last) {
        wb_text_append(&text, "no band: fewer than 95 %% of the runs reached a deflection.");
        wb_found_add(found, WB_FOUND_DOUBTFUL, &text);
        return;
    }
    wb_text_append(&text, "%.3g N (%.3g to %.3g) at a deflection of %.3g mm", last->band.median,
                   last->band.wide_low, last->band.wide_high, last->at / WB_MM);
    if (isfinite(c->springback.median))
        wb_text_append(&text, ", springback of the deflection %.2f (%.2f to %.2f)",
                       c->springback.median, c->springback.wide_low, c->springback.wide_high);
    wb_text_append(&text, ".");
    wb_found_add(found, WB_FOUND_RESULT, &text);
}

/* Tests of a bundle beside the bands; returns how many there are. */
static int add_tests_of(struct wb_found *found, const struct wb_predictions_bundle *bundle,
                        const struct wb_predictions_prediction *of)
{
    int n = 0;
    for (int i = 0; i < bundle->n_tests; i++) {
        const struct wb_predictions_verdict *const verdict = &of->tests[i];
        struct wb_text text = {0};
        if (!verdict->against)
            continue;
        n++;
        wb_text_append(&text, "Test ");
        wb_text_append_escaped(&text, bundle->tests[i].label);
        wb_text_append(&text, " (%s) beside the band of 90 %%: ", origin_of(&verdict->dataset));
        wb_text_append_escaped(&text, verdict->words);
        wb_text_append(&text, ".");
        wb_found_add(found, verdict->n_outside > 0 ? WB_FOUND_FAILED : WB_FOUND_PASSED, &text);
    }
    return n;
}

/* Whether the bands of a bundle can be trusted. */
static void add_trust(struct wb_found *found, const struct wb_predictions_bundle *bundle,
                      const struct wb_predictions_prediction *of)
{
    char label[400];
    int n_lost = 0;
    bool is_ranked = true;
    wb_pages_escape(label, sizeof label, bundle->label);
    for (int i = 0; i < of->bands->n_cases; i++)
        n_lost += of->bands->cases[i].n_lost;
    for (int i = 0; i < of->bands->cases[0].n_rankings; i++)
        is_ranked &= of->bands->cases[0].ranking[i].ranking.is_valid;
    if (n_lost > 0)
        wb_found_say(found, WB_FOUND_FAILED, "%d of %d runs of %s were not computed to the end.",
                     n_lost, of->bands->runs * of->bands->n_cases, label);
    else
        wb_found_say(found, WB_FOUND_PASSED, "All %d runs of %s were computed to the end.",
                     of->bands->runs * of->bands->n_cases, label);
    if (!is_ranked)
        wb_found_say(found, WB_FOUND_FAILED,
                     "The inputs of %s are not all ranked: ranks explain less than 0.9 of the "
                     "variance.",
                     label);
    if (add_tests_of(found, bundle, of) == 0)
        wb_found_say(found, WB_FOUND_UNCHECKED, "%s: no test of it is in the campaign.", label);
}

/* The input that makes the first case's force uncertain most; then the cases. */
static void add_next_of(struct wb_found *found, const struct wb_bands *bands)
{
    for (int i = bands->cases[0].n_rankings - 1; i >= 0; i--) {
        const struct wb_bands_ranking *const of = &bands->cases[0].ranking[i];
        struct wb_text text = {0};
        if (strcmp(of->of, "force") != 0 || !of->ranking.is_valid || of->ranking.n_groups == 0)
            continue;
        const struct wb_ranking_share *const share = &of->ranking.group[0];
        wb_text_append(&text, "<b>Narrow the band</b>: determine ");
        wb_text_append_escaped(&text, bands->inputs.group_name[share->group]);
        wb_text_append(
            &text,
            " more accurately; it causes the largest part, %.0f %%, of the variance of the "
            "ranks of the force at %.3g mm.",
            share->share / WB_PERCENT, of->at / WB_MM);
        wb_found_add(found, WB_FOUND_NEXT, &text);
        break;
    }
    if (bands->n_cases > 1)
        wb_found_say(found, WB_FOUND_NEXT,
                     "<b>Decide</b> between the cases by a photograph of a cut: they are choices "
                     "of packing and tape, and no probability is given for them.");
}

static void put_found(struct wb_document *document, const struct wb_predictions_results *results)
{
    const struct wb_predictions *const campaign = results->campaign;
    struct wb_found found = {0};
    bool any_test = false;
    wb_found_say(&found, WB_FOUND_ORIGIN, "%s",
                 "<b>Simulations.</b> The bands are computed by the section model from what the "
                 "files of the bundles state. Where a test is compared with a band, its origin is "
                 "given.");
    const int n_lost = results->outcome.n_wanted - results->outcome.n_usable;
    if (n_lost > 0)
        wb_found_say(&found, WB_FOUND_INCOMPLETE,
                     "<b>Incomplete.</b> %d of %d datasets of tests %s missing or cannot be used.",
                     n_lost, results->outcome.n_wanted, wb_pages_plural(n_lost, "is", "are"));
    for (int i = 0; i < campaign->n_bundles; i++) {
        const struct wb_predictions_prediction *const of = &results->bundles[i];
        any_test |= campaign->bundles[i].n_tests > 0;
        for (int k = 0; of->bands && k < of->bands->n_cases; k++)
            add_case(&found, campaign->bundles[i].label, of->bands, &of->bands->cases[k]);
        if (of->bands) {
            add_trust(&found, &campaign->bundles[i], of);
            add_next_of(&found, of->bands);
            continue;
        }
        struct wb_text text = {0};
        wb_text_append(&text, "<b>");
        wb_text_append_escaped(&text, campaign->bundles[i].label);
        wb_text_append(&text, "</b>: no bands; the reason is given below.");
        wb_found_add(&found, WB_FOUND_DOUBTFUL, &text);
    }
    wb_found_say(&found, WB_FOUND_NOTE,
                 "In brackets: bands of 90 %%, in which one further bundle lies with that "
                 "probability if the files state all that is uncertain. They include %g %% for the "
                 "error of the section model.",
                 WB_BANDS_MODEL_ERROR / WB_PERCENT);
    if (!any_test)
        wb_found_say(&found, WB_FOUND_NEXT,
                     "<b>Test</b>: bend one such bundle and name its dataset under <tt>tests</tt> "
                     "in the campaign.");
    wb_found_put(&found, document);
}

/* A band; NULL: there is none. */
static void put_interval(struct wb_document_table *table, const struct wb_bands_interval *band,
                         int decimals)
{
    if (band && isfinite(band->median))
        wb_pages_cell(table, WB_TONE_PLAIN, "%.*f (%.*f to %.*f)", decimals, band->median, decimals,
                      band->wide_low, decimals, band->wide_high);
    else
        wb_pages_cell_number(table, (double)NAN, 0);
}

static void put_cases(struct wb_document *document, const struct wb_bands *bands)
{
    static const struct wb_document_column columns[] = {
        {"Case"},
        {.heading = "Wires", .right = true},
        {"Packing"},
        {.heading = "Tape layers", .right = true, .wraps = true},
        {"Outline"},
        {.heading = "<i>\xce\xb4</i> (mm)", .right = true},
        {.heading = "Force there (N)", .right = true},
        {.heading = "Springback of the deflection", .right = true, .wraps = true},
        {.heading = "Residual curvature ratio", .right = true, .wraps = true},
        {.heading = "Runs lost", .right = true, .wraps = true},
    };
    struct wb_text caption = {0};
    wb_text_append(
        &caption,
        "Median and band of 90 %% of %d runs of each case, widened by the model's own error "
        "of %g %%. Cases are choices, not probabilities: a photograph of a cut shows which "
        "one applies. Springback of the deflection: 1 less the residual deflection at zero "
        "force over the largest deflection. Residual curvature ratio: largest curvature along the "
        "bundle at zero force over that at the largest deflection.",
        bands->runs, WB_BANDS_MODEL_ERROR / WB_PERCENT);
    struct wb_document_table *const table =
        wb_pages_start_table(document, &caption, (int)WB_COUNT(columns), columns);
    for (int i = 0; i < bands->n_cases; i++) {
        const struct wb_bands_case *const c = &bands->cases[i];
        const struct wb_bands_place *const last = c->n_force > 0 ? &c->force[c->n_force - 1] : NULL;
        wb_document_row(table, false);
        wb_pages_cell_plain(table, WB_TONE_PLAIN, c->variant.name);
        wb_pages_cell(table, WB_TONE_PLAIN, "%d", c->n_wires);
        wb_pages_cell_plain(table, WB_TONE_PLAIN, c->packing);
        wb_pages_cell(table, WB_TONE_PLAIN, "%.3g", c->layers);
        wb_pages_cell_plain(table, WB_TONE_PLAIN,
                            !(c->layers > 0.0) ? "none"
                            : c->is_round      ? "circle"
                                               : "hull");
        wb_pages_cell_number(table, last ? last->at / WB_MM : (double)NAN, 1);
        put_interval(table, last ? &last->band : NULL, 3);
        put_interval(table, &c->springback, 3);
        put_interval(table, &c->residual_curvature_ratio, 3);
        wb_pages_cell(table, c->n_lost > 0 ? WB_TONE_WARNING : WB_TONE_PLAIN, "%d", c->n_lost);
    }
}

/* For readers; files have the key. */
static const char *name_of(const struct wb_bands_ranking *of)
{
    return strcmp(of->of, "force") == 0 ? "Force" : "Springback of the deflection";
}

static void put_ranking(struct wb_document *document, const struct wb_bands *bands)
{
    static const struct wb_document_column columns[] = {
        {"Value"},
        {.heading = "at (mm)", .right = true},
        {"Depends on"},
        {.heading = "Share (%)", .right = true},
        {.heading = "Interval of 90 % (%)", .right = true},
    };
    struct wb_document_table *const table = wb_document_table(
        document,
        "Causes of the width of the band, the largest share first: part of the variance of the "
        "ranks that a group of inputs causes. No shares where ranks do not explain the result "
        "(R<sup>2</sup> below 0.9).",
        (int)WB_COUNT(columns), columns);
    for (int i = 0; i < bands->cases[0].n_rankings; i++) {
        const struct wb_bands_ranking *const of = &bands->cases[0].ranking[i];
        if (!of->ranking.is_valid) {
            wb_document_row(table, true);
            wb_pages_cell_plain(table, WB_TONE_PLAIN, name_of(of));
            wb_pages_cell_number(table, of->at / WB_MM, 1);
            wb_pages_cell(table, WB_TONE_WARNING, "no ranking, R<sup>2</sup> %.2f", of->ranking.r2);
            wb_pages_cell_number(table, (double)NAN, 0);
            wb_pages_cell_number(table, (double)NAN, 0);
        }
        for (int g = 0; of->ranking.is_valid && g < of->ranking.n_groups; g++) {
            const struct wb_ranking_share *const share = &of->ranking.group[g];
            wb_document_row(table, g == 0);
            wb_pages_cell_plain(table, WB_TONE_PLAIN, g == 0 ? name_of(of) : "");
            if (g == 0)
                wb_pages_cell_number(table, of->at / WB_MM, 1);
            else
                wb_pages_cell_plain(table, WB_TONE_PLAIN, "");
            wb_pages_cell_plain(table, WB_TONE_PLAIN, bands->inputs.group_name[share->group]);
            wb_pages_cell_number(table, share->share / WB_PERCENT, 1);
            wb_pages_cell(table, WB_TONE_PLAIN, "%.1f to %.1f", share->low / WB_PERCENT,
                          share->high / WB_PERCENT);
        }
    }
}

static void put_place(struct wb_document_table *table, const struct wb_predictions_test *test,
                      const struct wb_predictions_place *place, bool is_first)
{
    const bool is_outside =
        place->side == WB_PREDICTIONS_BELOW || place->side == WB_PREDICTIONS_ABOVE;
    wb_document_row(table, is_first);
    wb_pages_cell_plain(table, WB_TONE_PLAIN, is_first ? test->label : "");
    wb_pages_cell_plain(table, WB_TONE_PLAIN, is_first ? test->case_name : "");
    if (isfinite(place->at))
        wb_pages_cell(table, WB_TONE_PLAIN, "force at %.1f mm (N)", place->at / WB_MM);
    else
        wb_pages_cell_plain(table, WB_TONE_PLAIN, "springback of the deflection");
    wb_pages_cell_number(table, place->measured, 3);
    put_interval(table, &place->band, 3);
    wb_pages_cell_plain(table,
                        is_outside                             ? WB_TONE_WARNING
                        : place->side == WB_PREDICTIONS_WITHIN ? WB_TONE_GOOD
                                                               : WB_TONE_PLAIN,
                        side_of(place));
}

static void put_tests(struct wb_document *document, const struct wb_predictions_bundle *bundle,
                      const struct wb_predictions_prediction *of)
{
    static const struct wb_document_column columns[] = {
        {"Test"},
        {"Case"},
        {"Quantity"},
        {.heading = "Test", .right = true},
        {.heading = "Predicted (90 %)", .right = true},
        {"Side"},
    };
    struct wb_document_table *table = NULL;
    for (int i = 0; i < bundle->n_tests; i++) {
        const struct wb_predictions_verdict *const verdict = &of->tests[i];
        if (!verdict->against)
            continue;
        if (!table)
            table = wb_document_table(
                document,
                "Tests beside the band, which is that of one further bundle of the same wires: one "
                "of ten such values is expected outside.",
                (int)WB_COUNT(columns), columns);
        for (int k = 0; k < WB_PREDICTIONS_PLACES; k++)
            put_place(table, &bundle->tests[i], &verdict->places[k], k == 0);
    }
    for (int i = 0; i < bundle->n_tests; i++) {
        const struct wb_predictions_verdict *const verdict = &of->tests[i];
        char words[300];
        if (verdict->against) {
            snprintf(words, sizeof words, "%s (%s)", verdict->words, origin_of(&verdict->dataset));
            wb_pages_item(document, WB_TONE_PLAIN, "<b>", bundle->tests[i].label, "</b>: ", words);
        } else {
            wb_pages_item(document, WB_TONE_WARNING, "<b>", bundle->tests[i].given,
                          "</b>: ", wb_text_string(&verdict->problem));
        }
    }
}

static void put_bundle(struct wb_document *document, const struct wb_predictions_results *results,
                       int index, const struct wb_figures *drawn)
{
    const struct wb_predictions_bundle *const bundle = &results->campaign->bundles[index];
    const struct wb_predictions_prediction *const of = &results->bundles[index];
    char anchor[32];
    snprintf(anchor, sizeof anchor, "bundle-%d", index + 1);
    wb_document_heading(document, 1, anchor, bundle->label);
    if (!of->bands) {
        wb_pages_item(document, WB_TONE_WARNING, "", "No bands: ", "",
                      wb_text_string(&of->problem));
        return;
    }
    put_cases(document, of->bands);
    if (index > 0) /* the first page has that of the first bundle */
        wb_figures_put(drawn, document, "bands", index);
    put_tests(document, bundle, of);
    wb_figures_put(drawn, document, "section", index);
    put_ranking(document, of->bands);
    for (int i = 0; i < of->bands->inputs.n_types; i++)
        wb_pages_item(document, WB_TONE_PLAIN, "", "Law of the wires: ", "",
                      of->bands->inputs.wires[i].source);
}

static void put_models(struct wb_document *document, const struct wb_predictions_results *results)
{
    static const struct wb_document_column columns[] = {
        {"What", .wraps = true},
        {.heading = "SHA-256, first 16 digits", .monospace = true},
    };
    struct wb_document_table *const table =
        wb_document_table(document,
                          "Of bundles: of all inputs of the section model; of tests: of "
                          "<tt>force_deflection.csv</tt>.",
                          (int)WB_COUNT(columns), columns);
    for (int b = 0; b < results->campaign->n_bundles; b++) {
        const struct wb_predictions_bundle *const bundle = &results->campaign->bundles[b];
        char sha256[WB_SHA256_TEXT];
        wb_document_row(table, false);
        wb_pages_cell_plain(table, WB_TONE_PLAIN, bundle->model_name);
        wb_simulated_bundle_sum(bundle->model, NULL, sha256);
        wb_pages_cell_checksum(table, sha256);
        for (int i = 0; i < bundle->n_tests; i++) {
            if (results->bundles[b].tests[i].state != WB_SIMULATION_USABLE)
                continue;
            wb_document_row(table, false);
            wb_pages_cell_plain(table, WB_TONE_PLAIN, bundle->tests[i].given);
            wb_pages_cell_checksum(table, results->bundles[b].tests[i].sha256);
        }
    }
}

static void build_pages(struct wb_document *document, const void *context,
                        const struct wb_figures *drawn)
{
    const struct wb_predictions_results *const results = context;
    const struct wb_predictions *const campaign = results->campaign;
    char subtitle[200];
    snprintf(subtitle, sizeof subtitle, "%d %s with bands", campaign->n_bundles,
             wb_pages_plural(campaign->n_bundles, "bundle", "bundles"));
    wb_pages_start(document, "Prediction", &campaign->head, subtitle, "bands are simulations", "");
    put_found(document, results);
    wb_figures_put(drawn, document, "bands", 0);
    for (int i = 0; i < campaign->n_bundles; i++)
        put_bundle(document, results, i, drawn);
    wb_pages_put_origin(document, &campaign->head, "files");
    put_models(document, results);
}

/* --- numbers --- */

#define PLACE(member) WB_AT(struct wb_predictions_place, member)
#define VERDICT(member) WB_AT(struct wb_predictions_verdict, member)
#define BUNDLE(member) WB_AT(struct wb_predictions_bundle, member)

static const struct wb_key place_rows[] = {
    {"of", TEXT, "the number", .choices = "force_N|deflection_springback"},
    {"deflection_mm", PLACE(at) | IF_KNOWN, "of a force: deflection"},
    {"test", PLACE(measured) | UNKNOWN, "value of the test, in N or as a ratio"},
    {"median", PLACE(band.median) | UNKNOWN, "median of the band"},
    {"low", PLACE(band.wide_low) | UNKNOWN, "lower end of the band"},
    {"high", PLACE(band.wide_high) | UNKNOWN, "upper end of the band"},
    {"it_lies", TEXT, "place of the test's value", .choices = "below|within|above|not reached"},
};
static WB_KEYS(place, "predicted_number", "A number of a test and its band.");

static const struct wb_key test_rows[] = {
    {"label", WB_AT(struct wb_predictions_test, label), "name in the report"},
    {"dataset", WB_AT(struct wb_predictions_test, given), "folder of the dataset, as given"},
    {"problem", TEXT | OPTIONAL, "why the test is not compared"},
    {"sha256", VERDICT(sha256) | OPTIONAL, "SHA-256 of force_deflection.csv"},
    {"origin", TEXT | OPTIONAL, "origin of the test",
     .choices = "measured|measured on a virtual rig|a simulation, no test"},
    {"case", TEXT | OPTIONAL, "case that the test is compared with"},
    {"verdict", VERDICT(words) | OPTIONAL, "verdict on all numbers"},
    {"places", OBJECT | LIST | OPTIONAL, "the numbers", &place_keys},
};
static WB_KEYS(test, "predicted_test", "A test beside the bands.");

static const struct wb_key bundle_rows[] = {
    {"label", BUNDLE(label), "name in the report"},
    {"bundle", BUNDLE(model_name), "name of the bundle's file"},
    {"inputs_sha256", TEXT, "SHA-256 of the inputs of the section model"},
    {"uncertainty", OBJECT | OPTIONAL, "bands", &wb_bands_output_keys},
    {"problem", TEXT | OPTIONAL, "why there are no bands"},
    {"tests", OBJECT | LIST, "tests", &test_keys},
};
static WB_KEYS(bundle, "predicted_bundle", "A bundle.");

static const struct wb_key wb_predictions_kind_rows[] = {
    {.of = &wb_numbers_head_keys},
    {"bundles", OBJECT | LIST, "bundles", &bundle_keys},
};
WB_KEYS(wb_predictions_kind, "report_of_prediction", "The report of a campaign of predictions.");

static void put_test_numbers(struct wb_json *list, const struct wb_predictions_test *test,
                             const struct wb_predictions_verdict *verdict)
{
    struct wb_json *const entry = wb_json_append_object(list);
    WB_PUT(entry, &test_keys, struct wb_predictions_test, test);
    if (!verdict->against) {
        wb_json_set_text(entry, "problem", wb_text_string(&verdict->problem));
        return;
    }
    WB_PUT(entry, &test_keys, struct wb_predictions_verdict, verdict);
    wb_json_set_text(entry, "origin", origin_of(&verdict->dataset));
    wb_json_set_text(entry, "case", verdict->against->variant.name);
    WB_PUT(entry, &test_keys, struct wb_predictions_verdict, verdict);
    struct wb_json *const places = wb_json_set_array(entry, "places");
    for (int k = 0; k < WB_PREDICTIONS_PLACES; k++) {
        const struct wb_predictions_place *const place = &verdict->places[k];
        struct wb_json *const item = wb_json_append_object(places);
        wb_json_set_text(item, "of", isfinite(place->at) ? "force_N" : "deflection_springback");
        WB_PUT(item, &place_keys, struct wb_predictions_place, place);
        wb_json_set_text(item, "it_lies", side_of(place));
    }
}

static struct wb_json *build_json(const void *context)
{
    const struct wb_predictions_results *const results = context;
    const struct wb_predictions *const campaign = results->campaign;
    struct wb_json *const root =
        wb_numbers_create(&campaign->head, "simulation", &results->outcome);
    struct wb_json *const list = wb_json_set_array(root, "bundles");
    for (int b = 0; b < campaign->n_bundles; b++) {
        const struct wb_predictions_bundle *const bundle = &campaign->bundles[b];
        const struct wb_predictions_prediction *const of = &results->bundles[b];
        struct wb_json *const entry = wb_json_append_object(list);
        WB_PUT(entry, &bundle_keys, struct wb_predictions_bundle, bundle);
        char sha256[WB_SHA256_TEXT];
        wb_simulated_bundle_sum(bundle->model, NULL, sha256);
        wb_json_set_text(entry, "inputs_sha256", sha256);
        if (of->bands)
            wb_bands_output_describe(of->bands, entry);
        else
            wb_json_set_text(entry, "problem", wb_text_string(&of->problem));
        struct wb_json *const tests = wb_json_set_array(entry, "tests");
        for (int i = 0; i < bundle->n_tests; i++)
            put_test_numbers(tests, &bundle->tests[i], &of->tests[i]);
    }
    return root;
}

static void print(FILE *out, const void *context)
{
    const struct wb_predictions_results *const results = context;
    const struct wb_predictions *const campaign = results->campaign;
    fprintf(out, "%s (simulations)\n", campaign->head.title);
    for (int b = 0; b < campaign->n_bundles; b++) {
        const struct wb_predictions_bundle *const bundle = &campaign->bundles[b];
        const struct wb_predictions_prediction *const of = &results->bundles[b];
        struct wb_text text = {0};
        if (of->bands)
            wb_bands_output_summarise(of->bands, &text);
        fprintf(out, "\n%s\n%s", bundle->label, of->bands ? wb_text_string(&text) : "no bands\n");
        wb_text_release(&text);
        for (int i = 0; i < bundle->n_tests; i++)
            fprintf(out, "test %s: %s\n", bundle->tests[i].label,
                    of->tests[i].against ? of->tests[i].words
                                         : wb_text_string(&of->tests[i].problem));
    }
}

const struct wb_kind wb_predictions_kind = {
    .name = "prediction",
    .data = "datasets",
    .campaign_size = sizeof(struct wb_predictions),
    .results_size = sizeof(struct wb_predictions_results),
    .keys = wb_predictions_keys,
    .load = wb_predictions_results_load,
    .compute = wb_predictions_results_compute,
    .figures = figures,
    .n_figures = WB_COUNT(figures),
    .pages = build_pages,
    .json = build_json,
    .print = print,
    .release = wb_predictions_results_release,
    .release_campaign = wb_predictions_release,
};
