#include "analysis/report/bench/recordings_pages.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/calibration/cycle/cycle_budget.h"
#include "analysis/report/pages.h"
#include "analysis/validation/validate_bounds.h"
#include "base/text.h"
#include "base/units.h"

/* --- numbers --- */

/* "367 to 432"; a dash where either is not known. */
static void put_range(struct wb_document_table *table, double low, double high)
{
    wb_pages_cell_range(table, WB_TONE_PLAIN, low, high, wb_pages_decimals(high));
}

/* A real minus sign, where there is one. */
static const char *minus(double value)
{
    return value < 0.0 ? "\xe2\x88\x92" : "";
}

/* --- sentences that the first page has, too --- */

void wb_recordings_cycle_append(struct wb_text *text, const char *name, enum wb_quantity_id id,
                                const struct wb_estimate *e)
{
    const struct wb_quantity *const row = &wb_quantity_rows[id];
    const int decimals = wb_pages_decimals(e->value / row->scale);
    wb_text_append(text, "%s = %.*f%s", name, decimals, e->value / row->scale,
                   row->unit[0] ? " " : "");
    wb_pages_append_symbols(text, row->unit);
    if (isfinite(e->low))
        wb_text_append(text, " (%.*f to %.*f)", decimals, e->low / row->scale, decimals,
                       e->high / row->scale);
}

void wb_recordings_cycle_append_ranges(struct wb_text *text, const struct wb_cycle_calibration *c)
{
    const struct wb_estimate *const stiffness = wb_recordings_cycle_stiffness(c);
    const struct wb_estimate *const ratio = &c->residual_curvature_ratio;
    const double low = stiffness->candidates_low / WB_NMM2;
    const double high = stiffness->candidates_high / WB_NMM2;
    wb_text_append(text,
                   "unloading stiffness between %.*f and %.*f N mm\xc2\xb2, residual curvature "
                   "ratio between %.3f and %.3f, over the laws that fit about as well.",
                   wb_pages_decimals(low), low, wb_pages_decimals(high), high,
                   ratio->candidates_low, ratio->candidates_high);
}

/* --- tables of all wires --- */

static void put_verdict(struct wb_document_table *table, const struct wb_cycle_calibration *c)
{
    if (!c->has_unloading)
        wb_pages_cell(table, WB_TONE_WARNING, "rule untested: no unloading");
    else if (!c->is_followed)
        wb_pages_cell(table, WB_TONE_WARNING, "no law fits the data");
    else
        wb_pages_cell(table, WB_TONE_GOOD, "%s", wb_candidate_name(c->chosen));
}

static void put_wire(struct wb_document_table *table, const struct wb_recordings_results_wire *wire)
{
    const struct wb_recordings_cycle *const cycle = wb_recordings_results_cycle(wire);
    wb_pages_row(table, false, wire->wanted->label);
    if (!cycle) {
        wb_pages_cell(table, WB_TONE_WARNING, "missing");
        return;
    }
    const struct wb_cycle_calibration *const c = &cycle->calibration;
    const struct wb_estimate *const back = &c->residual_curvature_ratio;
    const struct wb_estimate *const stiffness = wb_recordings_cycle_stiffness(c);
    const double none = (double)NAN;
    /* Where no law fits the data, only the range over laws is known. */
    const bool is_known = c->is_followed || !c->has_unloading;
    wb_pages_cell_rounded(table, is_known ? stiffness->value / WB_NMM2 : none);
    put_range(table, is_known ? stiffness->low / WB_NMM2 : none, stiffness->high / WB_NMM2);
    put_range(table, stiffness->candidates_low / WB_NMM2, stiffness->candidates_high / WB_NMM2);
    wb_pages_cell_rounded(table, is_known && c->has_unloading ? back->value : none);
    put_range(table, c->has_unloading ? back->candidates_low : none, back->candidates_high);
    put_verdict(table, c);
    wb_pages_cell_number(table, 100.0 * c->ranked[0].misfit, 2);
}

static void put_laws(struct wb_document *document, const struct wb_recordings_results *results)
{
    const struct wb_document_column columns[] = {
        {"Wire"},
        {.heading = "Stiffness (N mm\xc2\xb2)", .right = true, .wraps = true},
        {.heading = "95 % interval", .right = true, .wraps = true},
        {.heading = "over laws", .right = true},
        {.heading = "Residual curvature ratio", .right = true, .wraps = true},
        {.heading = "over laws", .right = true},
        {"Law and hardening rule"},
        {.heading = "Misfit (%)", .right = true, .wraps = true},
    };
    struct wb_document_table *const table = wb_document_table(
        document,
        "From the first loading and unloading of each specimen. Stiffness: change of the moment "
        "over that of the curvature, of the first 1 /m during unloading from the largest "
        "curvature; where there is no unloading, from straight to 1 /m. Residual curvature ratio: "
        "curvature that remains at zero moment, over the curvature that the wire was bent to. 95 "
        "%: interval from all contributions that the uncertainty budgets state. Over laws: range "
        "over all laws whose misfit is at most twice the best. Misfit: RMS of the best law over "
        "loading and unloading, over <i>F</i><sub>max</sub>; above 3 % only ranges are given.",
        WB_COUNT(columns), columns);
    for (int i = 0; i < results->n_wires; i++)
        put_wire(table, &results->wires[i]);
}

static void start_moments_row(struct wb_document_table *table, bool begins_group, const char *wire,
                              enum wb_document_tone tone, const char *name)
{
    wb_pages_row(table, begins_group, wire);
    wb_document_cell(table, tone, name);
}

/* Where no law fits the data, only the range over laws. */
static void put_moments_of(struct wb_document_table *table,
                           const struct wb_recordings_results_wire *wire)
{
    const struct wb_recordings_cycle *const cycle = wb_recordings_results_cycle(wire);
    if (!cycle)
        return;
    const struct wb_cycle_calibration *const c = &cycle->calibration;
    const struct wb_estimate *const M = c->moment;
    const bool is_refuted = wb_recordings_cycle_is_refuted(cycle);
    start_moments_row(table, true, wire->wanted->label, WB_TONE_QUIET, "<i>\xce\xba</i> (1/m)");
    for (int k = 0; k < WB_CYCLE_MOMENTS; k++)
        wb_pages_cell_rounded(table, c->curvature[k]);
    start_moments_row(table, false, "", WB_TONE_PLAIN, "<i>M</i> (N mm)");
    for (int k = 0; k < WB_CYCLE_MOMENTS; k++)
        wb_pages_cell_rounded(table, is_refuted ? (double)NAN : M[k].value / WB_NMM);
    start_moments_row(table, false, "", WB_TONE_QUIET, is_refuted ? "over laws" : "95 %");
    for (int k = 0; k < WB_CYCLE_MOMENTS; k++)
        put_range(table, (is_refuted ? M[k].candidates_low : M[k].low) / WB_NMM,
                  (is_refuted ? M[k].candidates_high : M[k].high) / WB_NMM);
}

/* Of each wire the stiffness at the curvatures that are stated: from straight, and during
 * unloading.
 */
static void put_stiffness_row(struct wb_document_table *table, const struct wb_cycle_calibration *c,
                              const struct wb_cycle_stiffness *stiffness, bool is_refuted)
{
    for (int k = 0; k < WB_CYCLE_STIFFNESSES - 1; k++) {
        const double curvature = wb_cycle_stiffness_curvatures[k];
        const struct wb_estimate *const e = wb_cycle_stiffness_at(stiffness, curvature);
        const enum wb_document_tone tone =
            curvature < stiffness->resolved ? WB_TONE_QUIET : WB_TONE_PLAIN;
        const int decimals = e ? wb_pages_decimals(e->value / WB_NMM2) : 0;
        if (!e || c->largest_curvature < curvature)
            wb_pages_cell_number(table, (double)NAN, 0);
        else if (is_refuted)
            wb_pages_cell_range(table, tone, e->candidates_low / WB_NMM2,
                                e->candidates_high / WB_NMM2,
                                wb_pages_decimals(e->candidates_high / WB_NMM2));
        else if (isfinite(e->low))
            wb_pages_cell(table, tone, "%.*f (%.*f to %.*f)", decimals, e->value / WB_NMM2,
                          decimals, e->low / WB_NMM2, decimals, e->high / WB_NMM2);
        else
            wb_pages_cell(table, tone, "%.*f", decimals, e->value / WB_NMM2);
    }
}

static void put_stiffness_of(struct wb_document_table *table,
                             const struct wb_recordings_results *results,
                             const struct wb_recordings_results_wire *wire)
{
    const struct wb_recordings_cycle *const cycle = wb_recordings_results_cycle(wire);
    if (!cycle)
        return;
    const struct wb_cycle_calibration *const c = &cycle->calibration;
    const bool is_refuted = wb_recordings_cycle_is_refuted(cycle);
    const struct wb_estimate *const EI = &c->rigidity;
    double low = EI->low, high = EI->high;
    if (results->pool.degrees > 0)
        wb_recordings_cycle_interval(&results->pool, cycle, &low, &high);
    start_moments_row(table, true, wire->wanted->label, WB_TONE_PLAIN, "unloading");
    wb_pages_cell_number(table, c->unloading.n > 0 ? c->unloading.resolved : (double)NAN, 2);
    put_stiffness_row(table, c, &c->unloading, is_refuted);
    wb_pages_cell_rounded(table, is_refuted ? (double)NAN : EI->value / WB_NMM2);
    start_moments_row(table, false, "", WB_TONE_PLAIN, "secant");
    wb_pages_cell_number(table, c->secant.resolved, 2);
    put_stiffness_row(table, c, &c->secant, is_refuted);
    put_range(table, (is_refuted ? EI->candidates_low : low) / WB_NMM2,
              (is_refuted ? EI->candidates_high : high) / WB_NMM2);
}

static void put_stiffnesses(struct wb_document *document,
                            const struct wb_recordings_results *results)
{
    const struct wb_document_column columns[] = {
        {"Wire"},
        {""},
        {.heading = "from (1/m)", .right = true},
        {.heading = "0.5 /m", .right = true},
        {.heading = "1 /m", .right = true},
        {.heading = "2 /m", .right = true},
        {.heading = results->pool.degrees > 0 ? "<i>EI</i> at zero, pooled" : "<i>EI</i> at zero",
         .right = true,
         .wraps = true},
    };
    struct wb_text caption = {0};
    wb_text_append(
        &caption,
        "Stiffness (N mm\xc2\xb2) with the interval of the mean of the samples: change of the "
        "moment over the change of the curvature; unloading from the largest curvature, secant "
        "from straight. From: the smallest curvature that the data of all specimens resolve; "
        "values below it, in grey, and at zero depend on the law alone.");
    if (results->pool.degrees > 0)
        wb_text_append(&caption,
                       " The interval of <i>EI</i> is from the scatter of all wires' specimens "
                       "together, <i>s</i> of ln <i>EI</i> %.3f with %d degrees of freedom.",
                       results->pool.deviation, results->pool.degrees);
    struct wb_document_table *const table =
        wb_pages_start_table(document, &caption, WB_COUNT(columns), columns);
    for (int i = 0; i < results->n_wires; i++)
        put_stiffness_of(table, results, &results->wires[i]);
}

static void put_moments(struct wb_document *document, const struct wb_recordings_results *results)
{
    char headings[WB_CYCLE_MOMENTS][64];
    struct wb_document_column columns[2 + WB_CYCLE_MOMENTS] = {{"Wire"}, {""}};
    for (int k = 0; k < WB_CYCLE_MOMENTS; k++) {
        snprintf(headings[k], sizeof headings[k], "%g <i>\xce\xba</i><sub>max</sub>",
                 wb_cycle_moment_parts[k]);
        columns[2 + k] = (struct wb_document_column){.heading = headings[k], .right = true};
    }
    struct wb_document_table *const table = wb_document_table(
        document,
        "Bending moment <i>M</i> of a first loading at parts of the largest curvature "
        "<i>\xce\xba</i><sub>max</sub> that all specimens of the wire reached at the clamp, with "
        "the interval of the mean of the specimens. Beyond it the law is extrapolated.",
        2 + WB_CYCLE_MOMENTS, columns);
    for (int i = 0; i < results->n_wires; i++)
        put_moments_of(table, &results->wires[i]);
}

/* --- the other length --- */

/* In its unit; NaN where there is none. */
static double score_of(const struct wb_validate_result *of, const struct wb_recordings_score *row)
{
    double value = (double)NAN;
    if (of && !(row->needs_scatter && of->curve.n_samples < 2) &&
        !(row->needs_unloading && of->cycles.n_samples == 0))
        memcpy(&value, (const char *)of + row->offset, sizeof value);
    return value / row->in_unit;
}

#define OF(member) offsetof(struct wb_validate_result, member)

static void put_predictions(struct wb_document *document,
                            const struct wb_recordings_results *results)
{
    static const struct wb_recordings_score scores[] = {
        {"Loading, RMS (%)", "", OF(elastoplastic.rms), WB_PERCENT, 2},
        {"bound (%)", "", OF(bounds[WB_VALIDATE_LOADING].bound), WB_PERCENT, 2},
        {"Unloading, RMS (%)", "", OF(cycles.rms), WB_PERCENT, 2, .needs_unloading = true},
        {"Residual deflection, measured (mm)", "", OF(cycles.residual_measured), WB_MM, 1,
         .needs_unloading = true},
        {"Residual deflection, predicted (mm)", "", OF(cycles.residual_computed), WB_MM, 1,
         .needs_unloading = true},
        {"Shapes, RMS (mm)", "", OF(shape_rms), WB_MM, 2},
        {"<i>F</i><sub>max</sub> (mN)", "", OF(curve.max_force), WB_MN, 1},
    };
    struct wb_document_column columns[1 + WB_COUNT(scores)] = {{"Wire"}};
    for (size_t k = 0; k < WB_COUNT(scores); k++)
        columns[1 + k] =
            (struct wb_document_column){.heading = scores[k].name, .right = true, .wraps = true};
    const double *const length = results->campaign->length;
    wb_document_heading(document, 2, "prediction", "How well another length is predicted");
    struct wb_document_table *const table = wb_pages_table(
        document, WB_COUNT(columns), columns,
        "Mean of the specimens of %g mm beside the prediction by the laws of the %g mm specimens; "
        "RMS over <i>F</i><sub>max</sub>. Bound: exceeded on loading or in another part in one of "
        "twenty validations of a right law, because specimens differ. Residual deflection: where "
        "the force during unloading has come down to that at zero deflection.",
        length[WB_RECORDINGS_VALIDATION] / WB_MM, length[WB_RECORDINGS_CALIBRATION] / WB_MM);
    for (int i = 0; i < results->n_wires; i++) {
        const struct wb_recordings_results_wire *const wire = &results->wires[i];
        const struct wb_validate_result *const p = wb_recordings_results_prediction(wire);
        wb_pages_row(table, false, wire->wanted->label);
        if (!p)
            wb_pages_cell(table, WB_TONE_WARNING, "missing");
        for (size_t k = 0; p && k < WB_COUNT(scores); k++)
            wb_pages_cell_number(table, score_of(p, &scores[k]), scores[k].decimals);
    }
}

void wb_recordings_cycle_put_score(struct wb_document_table *table, const char *name,
                                   const char *unit, const double values[2], int decimals)
{
    wb_document_row(table, false);
    wb_document_cell(table, WB_TONE_PLAIN, name);
    wb_document_cell(table, WB_TONE_QUIET, unit);
    for (int i = 0; i < 2; i++)
        wb_pages_cell_number(table, values[i], decimals);
}

void wb_recordings_cycle_put_scores(struct wb_document_table *table,
                                    const struct wb_recordings_score *rows, size_t n,
                                    const struct wb_validate_result *const results[2])
{
    for (size_t k = 0; k < n; k++) {
        const double values[2] = {score_of(results[0], &rows[k]), score_of(results[1], &rows[k])};
        wb_recordings_cycle_put_score(table, rows[k].name, rows[k].unit, values, rows[k].decimals);
    }
}

/* The measured and the computed energy of a later cycle. */
static void put_loop(struct wb_document_table *table, const struct wb_validate_cycles *cycle,
                     const struct wb_validate_cycles *paper, int i)
{
    char name[60];
    const struct wb_validate_loop *const loop = &cycle->loops[i];
    const double other = paper && i < paper->n_loops ? paper->loops[i].computed : (double)NAN;
    const double measured[2] = {loop->measured / WB_MJ,
                                paper ? loop->measured / WB_MJ : (double)NAN};
    const double predicted[2] = {loop->computed / WB_MJ, other / WB_MJ};
    snprintf(name, sizeof name, "Energy lost in cycle %d, measured", loop->cycle);
    wb_recordings_cycle_put_score(table, name, "mJ", measured, 3);
    snprintf(name, sizeof name, "Energy lost in cycle %d, predicted", loop->cycle);
    wb_recordings_cycle_put_score(table, name, "mJ", predicted, 3);
}

static void put_bounds(struct wb_document *document, const struct wb_validate_result *p)
{
    struct wb_text text = {0};
    if (!wb_validate_bounds_known(p))
        return;
    if (wb_validate_bounds_exceeded(p)) {
        wb_text_append(&text, "<b>Bound exceeded:</b> ");
        wb_validate_bounds_append(&text, p);
        wb_text_append(&text,
                       ". A right law exceeds one of the bounds in one of twenty validations, "
                       "because specimens differ; otherwise the law is wrong, or the specimens "
                       "are of another wire.");
        wb_pages_put_text(document, WB_BLOCK_NOTICE, WB_TONE_WARNING, &text);
        return;
    }
    wb_document_paragraph(document,
                          "No bound is exceeded: the scatter of specimens explains the "
                          "differences. A right law exceeds one of the bounds in one of twenty "
                          "validations.");
}

#define PART "% of <i>F</i><sub>max</sub>"

static void put_scores(struct wb_document *document, const struct wb_recordings_results_wire *wire)
{
    static const struct wb_document_column columns[] = {
        {"Prediction"},
        {"Unit"},
        {.heading = "Loading and unloading", .right = true},
        {.heading = "Paper's route", .right = true},
    };
    static const struct wb_recordings_score scores[] = {
        {"Loading, RMS", PART, OF(elastoplastic.rms), WB_PERCENT, 2},
        {"Loading, largest error", PART, OF(elastoplastic.max_error), WB_PERCENT, 2},
        {"Loading, bound of the RMS", PART, OF(bounds[WB_VALIDATE_LOADING].bound), WB_PERCENT, 2},
        {"Unloading, RMS", PART, OF(cycles.rms), WB_PERCENT, 2, .needs_unloading = true},
        {"Unloading, largest error", PART, OF(cycles.largest_error), WB_PERCENT, 2,
         .needs_unloading = true},
        {"Unloading with each specimen as stiff as its loading, RMS", PART,
         OF(bounds[WB_VALIDATE_UNLOADING].found), WB_PERCENT, 2},
        {"Unloading, bound", PART, OF(bounds[WB_VALIDATE_UNLOADING].bound), WB_PERCENT, 2},
        {"Residual deflection, measured", "mm", OF(cycles.residual_measured), WB_MM, 2,
         .needs_unloading = true},
        {"Residual deflection, predicted", "mm", OF(cycles.residual_computed), WB_MM, 2,
         .needs_unloading = true},
        {"Residual deflection with each specimen as stiff, off by", "mm",
         OF(bounds[WB_VALIDATE_RESIDUAL].found), WB_MM, 2},
        {"Residual deflection, bound", "mm", OF(bounds[WB_VALIDATE_RESIDUAL].bound), WB_MM, 2},
        {"Shapes, RMS of the mean displacement over the specimens", "mm",
         OF(bounds[WB_VALIDATE_SHAPES].found), WB_MM, 2},
        {"Shapes, bound", "mm", OF(bounds[WB_VALIDATE_SHAPES].bound), WB_MM, 2},
        {"Shapes, RMS distance", "mm", OF(shape_rms), WB_MM, 2},
    };
    const struct wb_validate_result *const p = wb_recordings_results_prediction(wire);
    const struct wb_validate_result *const q =
        wb_recordings_results_of(wire, WB_RECORDINGS_VALIDATION);
    if (!p)
        return;
    struct wb_document_table *const table = wb_document_table(
        document,
        "The same specimens by the law of this chapter and by that of the paper's route, for each "
        "part of the test.",
        WB_COUNT(columns), columns);
    wb_recordings_cycle_put_scores(table, scores, WB_COUNT(scores),
                                   (const struct wb_validate_result *[2]){p, q});
    for (int i = 0; i < p->cycles.n_loops; i++)
        put_loop(table, &p->cycles, q ? &q->cycles : NULL, i);
    put_bounds(document, p);
    if (p->is_beyond)
        wb_document_notice(document, WB_TONE_WARNING,
                           "<b>Extrapolation.</b> These tests bend the wire further at the clamp "
                           "than those that the law was fitted to.");
}

static void put_prediction(struct wb_document *document,
                           const struct wb_recordings_results *results, int index,
                           const struct wb_figures *figures)
{
    const struct wb_recordings_results_wire *const wire = &results->wires[index];
    const enum wb_recordings_results_state state = wire->cycle_states[WB_RECORDINGS_VALIDATION];
    if (state == WB_RECORDINGS_NOT_WANTED)
        return;
    char heading[80];
    snprintf(heading, sizeof heading, "Prediction at %g mm",
             results->campaign->length[WB_RECORDINGS_VALIDATION] / WB_MM);
    wb_document_heading(document, 2, "", heading);
    if (state != WB_RECORDINGS_DONE)
        wb_pages_item(document, WB_TONE_WARNING, "<b>", "No prediction",
                      "</b>: ", wb_text_string(&wire->cycle_problems[WB_RECORDINGS_VALIDATION]));
    wb_figures_put(figures, document, "prediction", index);
    put_scores(document, wire);
}

static void put_failures(struct wb_document *document, const struct wb_recordings_results *results)
{
    for (int i = 0; i < results->n_wires; i++) {
        const struct wb_recordings_results_wire *const wire = &results->wires[i];
        const struct wb_recordings_cycle *const cycle = wb_recordings_results_cycle(wire);
        if (!cycle)
            wb_pages_item(document, WB_TONE_WARNING, "<b>", wire->wanted->label,
                          ": no calibration on whole cycles</b>: ",
                          wb_text_string(&wire->cycle_problems[WB_RECORDINGS_CALIBRATION]));
        else if (wb_recordings_cycle_is_refuted(cycle))
            wb_pages_item(document, WB_TONE_WARNING, "<b>", wire->wanted->label,
                          ": no law fits the data</b>: ",
                          "only ranges over the laws are given. The residual deflections on the "
                          "wire's page are measured.");
    }
}

void wb_recordings_cycle_put_summary(struct wb_document *document,
                                     const struct wb_recordings_results *results)
{
    bool any = false, any_prediction = false;
    if (!results->campaign->whole_cycle)
        return;
    wb_document_heading(document, 2, "bending", "Bending properties, from loading and unloading");
    for (int i = 0; i < results->n_wires; i++)
        any |= wb_recordings_results_cycle(&results->wires[i]) != NULL;
    if (any) {
        put_laws(document, results);
        put_moments(document, results);
        put_stiffnesses(document, results);
    }
    put_failures(document, results);
    for (int i = 0; i < results->n_wires; i++)
        any_prediction |= wb_recordings_results_prediction(&results->wires[i]) != NULL;
    if (any_prediction)
        put_predictions(document, results);
}

/* --- one wire --- */

static void put_answer(struct wb_document *document, const struct wb_recordings_cycle *cycle)
{
    const struct wb_cycle_calibration *const c = &cycle->calibration;
    struct wb_text text = {0};
    if (!c->has_unloading) {
        wb_text_append(
            &text, "<b>Rule untested.</b> There is no unloading, so Ludwik's law is "
                   "fitted to the loading alone, and the residual curvature ratio is not known. ");
    } else if (!c->is_followed) {
        wb_text_append(&text,
                       "<b>No law fits the data.</b> The best misses loading and unloading by "
                       "%.2f %% of <i>F</i><sub>max</sub>: ",
                       100.0 * c->ranked[0].misfit);
        wb_recordings_cycle_append_ranges(&text, c);
        wb_text_append(&text, " ");
    } else {
        const char *const name = wb_candidate_name(c->chosen);
        wb_text_append(&text, "<b>%c%s.</b> ", toupper((unsigned char)name[0]), name + 1);
    }
    if (c->is_followed || !c->has_unloading) {
        wb_recordings_cycle_append(&text, "Moment at the largest curvature", WB_QUANTITY_MOMENT,
                                   &c->moment[WB_CYCLE_MOMENTS - 1]);
        wb_recordings_cycle_append(
            &text, c->has_unloading ? "; unloading stiffness" : "; secant stiffness",
            WB_QUANTITY_UNLOADING_STIFFNESS, wb_recordings_cycle_stiffness(c));
    }
    if (c->is_followed) {
        wb_recordings_cycle_append(&text, "; residual curvature ratio",
                                   WB_QUANTITY_RESIDUAL_CURVATURE_RATIO,
                                   &c->residual_curvature_ratio);
        wb_recordings_cycle_append(&text, "; springback of the deflection", WB_QUANTITY_SPRINGBACK,
                                   &c->springback);
        wb_recordings_cycle_append(&text, "; loop energy", WB_QUANTITY_LOOP_ENERGY,
                                   &c->loop_energy);
        wb_text_append(&text, ", bent to %.1f /m and back.", c->largest_curvature);
    }
    if (c->specimens_for_5_percent > 0)
        wb_text_append(&text,
                       " Specimens needed for <i>EI</i> within \xc2\xb1"
                       "5 %%: %d.",
                       c->specimens_for_5_percent);
    wb_pages_put_text(document, WB_BLOCK_PARAGRAPH, WB_TONE_PLAIN, &text);
}

static void put_ranked(struct wb_document *document, const struct wb_cycle_calibration *c)
{
    static const struct wb_document_column columns[] = {
        {"Law"},
        {.heading = "Misfit (%)", .right = true},
        {.heading = "Parameters", .right = true},
        {.heading = "Weight", .right = true},
        {.heading = "<i>EI</i> (N mm\xc2\xb2)", .right = true},
        {.heading = "Residual ratio", .right = true},
        {""},
    };
    wb_document_heading(document, 2, "", "Laws and hardening rules");
    struct wb_document_table *const table = wb_pages_table(
        document, WB_COUNT(columns), columns,
        "Misfit: RMS over loading and unloading, over <i>F</i><sub>max</sub>; repeat noise of the "
        "readings %.3f %%. Weight: from the misfit and the number of free parameters (Schwarz's "
        "criterion), with %.0f independent residuals of a specimen, because neighbouring "
        "residuals are correlated. The law of the largest weight is chosen. In range: misfit at "
        "most twice the best.",
        100.0 * c->repeat_noise, c->n_independent);
    for (int i = 0; i < c->n_ranked; i++) {
        const struct wb_cycle_rank *const rank = &c->ranked[i];
        const bool is_chosen = rank->candidate == c->chosen;
        const char *const name = wb_candidate_name(rank->candidate);
        wb_document_row(table, false);
        wb_pages_cell(table, WB_TONE_PLAIN, is_chosen ? "<b>%s</b>" : "%s", name);
        wb_pages_cell_number(table, 100.0 * rank->misfit, 3);
        wb_pages_cell(table, WB_TONE_PLAIN, "%d", rank->n_free);
        wb_pages_cell_number(table, rank->weight, 3);
        wb_pages_cell_rounded(table, rank->rigidity.value / WB_NMM2);
        wb_pages_cell_rounded(table, c->has_unloading ? rank->residual_curvature_ratio.value
                                                      : (double)NAN);
        wb_pages_cell(table, rank->counts ? WB_TONE_PLAIN : WB_TONE_QUIET,
                      is_chosen      ? "chosen"
                      : rank->counts ? "in range"
                                     : "out of range");
    }
}

static void put_ranked_numbers(struct wb_document *document, const struct wb_cycle_calibration *c)
{
    static const struct wb_document_column columns[] = {{"Law"},
                                                        {.heading = "Parameters", .wraps = true}};
    struct wb_document_table *const table = wb_document_table(
        document,
        "Parameters of the laws in range: means over the specimens, of Ludwik's law of logarithms.",
        WB_COUNT(columns), columns);
    for (int i = 0; i < c->n_ranked; i++) {
        struct wb_text numbers = {0}, typeset = {0};
        if (!c->ranked[i].counts)
            continue;
        wb_law_append_numbers(&numbers, &c->ranked[i].law);
        wb_pages_append_symbols(&typeset, wb_text_string(&numbers));
        wb_pages_row(table, false, wb_candidate_name(c->ranked[i].candidate));
        wb_document_cell(table, WB_TONE_PLAIN, wb_text_string(&typeset));
        wb_text_release(&numbers);
        wb_text_release(&typeset);
    }
}

/* The natural shape of each sample, as it was fitted. */
static void put_bows(struct wb_document *document, const struct wb_cycle_calibration *c)
{
    static const struct wb_document_column columns[] = {
        {.heading = "Sample", .right = true},
        {.heading = "Bow (mm)", .right = true},
        {.heading = "Uneven bow (mm)", .right = true},
        {.heading = "Error of zero deflection (mm)", .right = true},
    };
    struct wb_document_table *const table = wb_document_table(
        document,
        "Natural shape, fitted with the law. Bow: offset of the tip. Uneven bow: offset of the "
        "middle from a shape of even curvature.",
        WB_COUNT(columns), columns);
    for (int i = 0; i < c->n_members; i++) {
        const struct wb_cycle_member *const member = &c->members[i];
        const struct wb_cycle_fit *const fit = &member->answers[c->chosen].fit;
        const struct wb_cycle_bow bow = wb_cycle_fit_bow(fit, member->data.info.length);
        wb_document_row(table, false);
        wb_pages_cell(table, WB_TONE_PLAIN, "%d", member->sample);
        wb_pages_cell(table, WB_TONE_PLAIN, "%s%.2f \xc2\xb1 %.2f", minus(bow.tip),
                      fabs(bow.tip / WB_MM), bow.deviation / WB_MM);
        wb_pages_cell_number(table, bow.uneven / WB_MM, 2);
        wb_pages_cell_number(table, fit->level / WB_MM, 2);
    }
}

static void put_specimens(struct wb_document *document, const struct wb_recordings_cycle *cycle)
{
    static const struct wb_document_column columns[] = {
        {.heading = "Sample", .right = true},
        {.heading = "<i>EI</i> (N\xc2\xa0mm\xc2\xb2)", .right = true, .wraps = true},
        {.heading = "Residual curvature ratio", .right = true, .wraps = true},
        {.heading = "Residual deflection (mm)", .right = true, .wraps = true},
        {.heading = "Misfit, loading (%)", .right = true, .wraps = true},
        {.heading = "Misfit, unloading (%)", .right = true, .wraps = true},
        {.heading = "Markers (mm)", .right = true, .wraps = true},
        {.heading = "Outliers", .right = true, .wraps = true},
    };
    const struct wb_cycle_calibration *const c = &cycle->calibration;
    wb_document_heading(document, 2, "", "Specimens");
    struct wb_document_table *const table = wb_document_table(
        document,
        "Each sample fitted by itself with the chosen law. Residual deflection: as measured, where "
        "the force has come down to that at zero deflection. Misfit: RMS of the force residuals "
        "over <i>F</i><sub>max</sub>. Markers: RMS distance to the computed wire. Outliers: "
        "readings that were left out or weighted down.",
        WB_COUNT(columns), columns);
    for (int i = 0; i < c->n_members; i++) {
        const struct wb_cycle_member *const member = &c->members[i];
        const struct wb_cycle_answer *const answer = &member->answers[c->chosen];
        const struct wb_cycle_fit *const fit = &answer->fit;
        wb_document_row(table, false);
        wb_pages_cell(table, WB_TONE_PLAIN, "%d", member->sample);
        wb_pages_cell_rounded(table, answer->value[WB_CYCLE_RIGIDITY] / WB_NMM2);
        wb_pages_cell_rounded(table, c->has_unloading ? answer->value[WB_CYCLE_RESIDUAL_CURVATURE]
                                                      : (double)NAN);
        wb_pages_cell_number(table, member->data.residual_deflection / WB_MM, 1);
        wb_pages_cell_number(table, 100.0 * fit->loading_misfit, 3);
        wb_pages_cell_number(table, 100.0 * fit->unloading_misfit, 3);
        wb_pages_cell_number(table, fit->place_rms / WB_MM, 3);
        wb_pages_cell(table, WB_TONE_PLAIN, "%d", fit->n_outliers + member->data.n_outliers);
    }
    put_bows(document, c);
}

static void put_budget(struct wb_document *document, const struct wb_cycle_calibration *c)
{
    struct wb_document_column columns[1 + WB_BUDGET_COLUMNS] = {{"Contribution"}};
    struct wb_budget_column numbers[WB_BUDGET_COLUMNS];
    char name[WB_BUDGET_TEXT];
    const int n = wb_cycle_budget_columns(c, numbers);
    for (int k = 0; k < n; k++)
        columns[1 + k] =
            (struct wb_document_column){.heading = numbers[k].name, .right = true, .wraps = true};
    wb_document_heading(document, 2, "", "Uncertainty budget");
    struct wb_document_table *const table = wb_document_table(
        document,
        "Standard uncertainties (%) of moments, stiffnesses and the residual curvature ratio by "
        "contribution, and the coverage factor for an interval of 95 %. In brackets: "
        "contributions that no file states, which are in no interval; effect of 1 %, of the "
        "marker offset of 0.1 mm. State them in the rig, specimen and wire files (u_...).",
        1 + n, columns);
    for (int i = 0; i < WB_CONTRIBUTIONS; i++) {
        if (!wb_cycle_budget_has(c, i))
            continue;
        wb_cycle_budget_row(c, i, name);
        wb_pages_row(table, false, name);
        for (int k = 0; k < n; k++) {
            bool is_stated;
            const double u = wb_cycle_budget_cell(&c->budget[numbers[k].number], i, &is_stated);
            if (!isfinite(u))
                wb_pages_cell(table, WB_TONE_QUIET, "unknown");
            else
                wb_pages_cell(table, is_stated ? WB_TONE_PLAIN : WB_TONE_QUIET,
                              is_stated ? "%.2f" : "(%.2f)", 100.0 * u);
        }
    }
    wb_pages_row(table, false, "Combined");
    for (int k = 0; k < n; k++)
        wb_pages_cell_number(table, 100.0 * c->budget[numbers[k].number].combined, 2);
    wb_pages_row(table, false, "Degrees of freedom");
    for (int k = 0; k < n; k++)
        wb_pages_cell_number(table, c->budget[numbers[k].number].effective_degrees, 1);
    wb_pages_row(table, false, "Factor for 95 %");
    for (int k = 0; k < n; k++)
        wb_pages_cell_number(table, c->budget[numbers[k].number].factor, 2);
}

/* A parameter of a Ludwik law, shown only where the data determine it. */
static void append_known(struct wb_text *text, const char *name, double value, int decimals,
                         const char *unit, bool is_known)
{
    if (is_known)
        wb_text_append(text, ", %s = %.*f%s", name, decimals, value, unit);
    else
        wb_text_append(text, ", %s not identifiable with these data", name);
}

static void put_parts(struct wb_document *document, const struct wb_law *law)
{
    struct wb_document_column columns[WB_DOCUMENT_COLUMNS] = {{"Part"}};
    char headings[WB_DOCUMENT_COLUMNS][8];
    const int n = law->n_parts < WB_DOCUMENT_COLUMNS ? law->n_parts : WB_DOCUMENT_COLUMNS - 1;
    for (int i = 0; i < n; i++) {
        snprintf(headings[i], sizeof headings[i], "%d", i + 1);
        columns[1 + i] = (struct wb_document_column){.heading = headings[i], .right = true};
    }
    struct wb_document_table *const table = wb_pages_table(
        document, 1 + n, columns,
        "Parts side by side that share the strain, each elastic up to its yield strain; means over "
        "the specimens. Hardening: %s. %s: %.3g.",
        wb_law_rule_name(law),
        law->is_combined ? "Tangent modulus of a yielded part over its modulus"
                         : "Share of the area with isotropic hardening",
        law->isotropic_share);
    wb_pages_row(table, false, "Modulus (MPa)");
    for (int i = 0; i < n; i++)
        wb_pages_cell_rounded(table, law->parts[i].modulus / WB_MPA);
    wb_document_row(table, false);
    wb_document_cell(table, WB_TONE_PLAIN, "Yield strain (10<sup>\xe2\x88\x92\x33</sup>)");
    for (int i = 0; i < n; i++) {
        if (isfinite(law->parts[i].yield_strain))
            wb_pages_cell_rounded(table, 1e3 * law->parts[i].yield_strain);
        else
            wb_pages_cell(table, WB_TONE_QUIET, "elastic");
    }
}

static void put_chaboche(struct wb_document *document, const struct wb_law *law)
{
    const struct wb_document_column columns[] = {{"Hardening"},
                                                 {.heading = "Modulus (MPa)", .right = true},
                                                 {.heading = "Rate", .right = true},
                                                 {.heading = "Saturates at (MPa)", .right = true}};
    struct wb_document_table *const table = wb_pages_table(
        document, WB_COUNT(columns), columns,
        "Chaboche's law: <i>E</i> = %.0f MPa; yields at %.3f MPa on either side of the sum of the "
        "back stresses, and this yield stress grows. Modulus: initial slope over plastic strain; "
        "rate: <i>\xce\xb3</i> of a back stress, <i>b</i> of the yield stress. Means over the "
        "specimens.",
        law->material.youngs_modulus / WB_MPA, law->material.yield_stress / WB_MPA);
    for (int i = -1; i < law->n_backs; i++) {
        char name[40];
        const bool grows = i < 0;
        const double modulus = grows ? law->saturation * law->rate : law->backs[i].modulus;
        const double rate = grows ? law->rate : law->backs[i].recovery;
        snprintf(name, sizeof name, grows ? "yield stress" : "back stress %d", i + 1);
        wb_pages_row(table, false, name);
        wb_pages_cell_rounded(table, modulus / WB_MPA);
        wb_pages_cell_rounded(table, rate);
        if (rate > 0.0)
            wb_pages_cell_rounded(table, modulus / rate / WB_MPA);
        else
            wb_pages_cell(table, WB_TONE_QUIET, "never");
    }
}

static void put_law(struct wb_document *document, const struct wb_recordings_cycle *cycle)
{
    struct wb_text text = {0};
    const struct wb_cycle_calibration *const c = &cycle->calibration;
    const struct wb_material *const m = &c->ludwik;
    wb_document_heading(document, 2, "", "Parameters of the law");
    if (wb_recordings_cycle_is_refuted(cycle))
        wb_text_append(&text, "No law fits the data; these are parameters of the chosen law, not "
                              "properties of the wire. ");
    if (c->law.form != WB_LAW_LUDWIK) {
        if (c->law.form == WB_LAW_PARALLEL)
            put_parts(document, &c->law);
        else
            put_chaboche(document, &c->law);
        wb_text_append(&text,
                       "Equivalent Ludwik law of a first loading (RMS %.1f %% of <i>M</i>)"
                       ": <i>E</i> = %.0f MPa, <i>\xcf\x83</i><sub>Y</sub> = %.2f MPa, <i>K</i> = "
                       "%.0f MPa, <i>n</i> = %.3f. It says nothing about unloading.",
                       100.0 * c->ludwik_misfit, m->youngs_modulus / WB_MPA,
                       m->yield_stress / WB_MPA, m->strength_coefficient / WB_MPA,
                       m->hardening_exponent);
    } else {
        wb_text_append(&text,
                       "Hardening %s, isotropic share %.2f, <i>E</i> = %.0f MPa, "
                       "<i>\xcf\x83</i><sub>Y</sub> = %.2f MPa",
                       wb_law_rule_name(&c->law), c->law.isotropic_share,
                       m->youngs_modulus / WB_MPA, m->yield_stress / WB_MPA);
        append_known(&text, "<i>K</i>", m->strength_coefficient / WB_MPA, 0, " MPa",
                     c->is_strength_identifiable);
        append_known(&text, "<i>n</i>", m->hardening_exponent, 3, "", c->is_exponent_identifiable);
        wb_text_append(&text, ".");
        if (!(c->is_strength_identifiable && c->is_exponent_identifiable))
            wb_text_append(&text, " %s",
                           c->travel_share < 0.35
                               ? "A travel of at least 0.35 of the length would determine it."
                               : "More specimens, or an unloading, would determine it.");
    }
    if (c->law.n_maxwell > 0) {
        struct wb_text relaxation = {0};
        wb_law_append_relaxation(&relaxation, &c->law);
        wb_text_append(&text, " In parallel: ");
        wb_pages_append_symbols(&text, wb_text_string(&relaxation));
        wb_text_append(&text, "; the law itself is the relaxed wire's.");
        wb_text_release(&relaxation);
    }
    char a[24], b[24];
    int one, other;
    const struct wb_cycle_fit *const fit = &c->members[0].answers[c->chosen].fit;
    if (wb_cycle_fit_strongest(fit, &one, &other)) {
        wb_text_append(
            &text,
            " The law's parameters are strongly correlated: in the fit of sample %d the strongest "
            "correlation is %s%.2f, between ",
            c->members[0].sample, minus(fit->correlation[one][other]),
            fabs(fit->correlation[one][other]));
        wb_pages_append_symbols(&text, wb_cycle_fit_number(fit, one, a));
        wb_text_append(&text, " and ");
        wb_pages_append_symbols(&text, wb_cycle_fit_number(fit, other, b));
        wb_text_append(&text, ".");
    }
    wb_pages_put_text(document, WB_BLOCK_PARAGRAPH, WB_TONE_PLAIN, &text);
}

/* Where the law differs from the moments that shapes and strand tension give without it. */
static void put_apart(struct wb_document *document, const struct wb_recordings_cycle *cycle)
{
    const struct wb_moment_comparison *const c = &cycle->comparison;
    if (cycle->has_comparison && c->is_apart)
        wb_pages_put(document, WB_BLOCK_NOTICE, WB_TONE_WARNING,
                     "<b>Law and measured moments differ.</b> Between %.1f and %.1f /m the law's "
                     "moment is %.1f %% %s the moment from shapes and strand tension, %.1f "
                     "standard deviations.",
                     c->first, c->last, 100.0 * fabs(c->difference),
                     c->difference > 0.0 ? "above" : "below", c->in_deviations);
}

/* Findings of the checks of the data: doubts as warnings, notes as notes. */
static void put_remarks(struct wb_document *document, const struct wb_cycle_remarks *remarks)
{
    for (int i = 0; i < remarks->n; i++) {
        const struct wb_cycle_remark *const remark = &remarks->items[i];
        const bool is_doubt = remark->severity != WB_CHECK_NOTE;
        struct wb_text text = {0};
        wb_text_append(&text, is_doubt ? "<b>In doubt:</b> " : "Note: ");
        wb_text_append_escaped(&text, remark->text);
        wb_text_append(&text, ".");
        wb_pages_put_text(document, is_doubt ? WB_BLOCK_NOTICE : WB_BLOCK_PARAGRAPH,
                          is_doubt ? WB_TONE_WARNING : WB_TONE_PLAIN, &text);
    }
}

void wb_recordings_cycle_put_wire(struct wb_document *document,
                                  const struct wb_recordings_results *results, int index,
                                  const struct wb_figures *figures)
{
    const struct wb_recordings_cycle *const cycle =
        wb_recordings_results_cycle(&results->wires[index]);
    if (!cycle)
        return;
    wb_document_heading(document, 2, "", "Loading and unloading");
    put_answer(document, cycle);
    put_remarks(document, &cycle->remarks);
    wb_figures_put(figures, document, "cycle", index);
    put_ranked(document, &cycle->calibration);
    put_ranked_numbers(document, &cycle->calibration);
    wb_figures_put(figures, document, "later", index);
    put_prediction(document, results, index, figures);
    put_specimens(document, cycle);
    wb_figures_put(figures, document, "law", index);
    put_apart(document, cycle);
    put_law(document, cycle);
    wb_figures_put(figures, document, "valley", index);
    put_budget(document, &cycle->calibration);
}
