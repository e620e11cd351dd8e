#include "analysis/report/bench/recordings_pages.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/calibration/cycle/cycle_budget.h"
#include "analysis/report/found.h"
#include "analysis/report/pages.h"
#include "analysis/validation/validate_bounds.h"
#include "base/text.h"
#include "base/units.h"

static void add_origin(struct wb_found *found, const struct wb_recordings_results *results)
{
    if (results->all_virtual)
        wb_found_say(found, WB_FOUND_ORIGIN,
                     "<b>Virtual rig.</b> All recordings of this report come from the virtual rig, "
                     "a simulated bench with a simulated wire. No physical wire was tested. The "
                     "wire in it only resembles the published one, whose values are given for "
                     "orientation.");
    else if (results->any_virtual)
        wb_found_say(found, WB_FOUND_ORIGIN,
                     "<b>Virtual rig.</b> Some recordings of this report come from the virtual "
                     "rig, a simulated bench with a simulated wire; the list of recordings says "
                     "which.");
}

static void add_incomplete(struct wb_found *found, const struct wb_recordings_results *results)
{
    const int n = results->outcome.n_wanted - results->outcome.n_usable;
    if (results->outcome.is_complete)
        return;
    if (n > 0)
        wb_found_say(found, WB_FOUND_INCOMPLETE,
                     "<b>Incomplete.</b> %d of %d recordings %s missing or could not be used. The "
                     "report shows the results of the others.",
                     n, results->outcome.n_wanted, wb_pages_plural(n, "is", "are"));
    else
        wb_found_say(found, WB_FOUND_INCOMPLETE,
                     "<b>Incomplete.</b> All recordings are there, but not every step could be "
                     "done.");
}

/* The validation of a wire by the campaign's method; NULL: there is none. */
static const struct wb_validate_result *prediction_of(const struct wb_recordings_results *results,
                                                      const struct wb_recordings_results_wire *wire)
{
    return results->campaign->whole_cycle
               ? wb_recordings_results_prediction(wire)
               : wb_recordings_results_of(wire, WB_RECORDINGS_VALIDATION);
}

/* --- a sentence for each wire --- */

/* Stiffness and residual curvature ratio of a calibration on whole cycles. */
static void append_cycle(struct wb_text *text, const struct wb_cycle_calibration *c)
{
    if (c->has_unloading && !c->is_followed) {
        wb_text_append(text,
                       "no law fits loading and unloading (%.1f %% of <i>F</i><sub>max</sub>); ",
                       c->ranked[0].misfit / WB_PERCENT);
        wb_recordings_cycle_append_ranges(text, c);
        return;
    }
    wb_recordings_cycle_append(text, c->has_unloading ? "unloading stiffness" : "secant stiffness",
                               WB_QUANTITY_UNLOADING_STIFFNESS, wb_recordings_cycle_stiffness(c));
    if (c->has_unloading)
        wb_recordings_cycle_append(text, ", residual curvature ratio",
                                   WB_QUANTITY_RESIDUAL_CURVATURE_RATIO,
                                   &c->residual_curvature_ratio);
    else
        wb_text_append(text, "; unloading was not recorded");
    wb_text_append(text, ", bent to %.0f /m.", c->largest_curvature);
}

/* Ludwik's parameters by the paper's route, with the standard uncertainties. */
static void append_paper(struct wb_text *text, const struct wb_calibrate_result *c)
{
    for (int i = 0; i < 4; i++) {
        const struct wb_pages_property *const property = &wb_pages_properties[i];
        const bool has_factor = i == 2; /* K's uncertainty is one */
        wb_text_append(text, "%s%s = %.*f", i > 0 ? ", " : "", property->symbol, property->decimals,
                       wb_pages_value(&c->material, i) / property->factor);
        if (isfinite(c->deviation[i]) && !has_factor)
            wb_text_append(text, " \xc2\xb1 %.*f", property->decimals,
                           c->deviation[i] / property->factor);
        wb_text_append(text, "%s", i < 3 ? " MPa" : "");
        if (isfinite(c->deviation[i]) && has_factor)
            wb_text_append(text, " (\xc3\x97/\xc3\xb7 %.3g)", exp(c->deviation[i]));
    }
    wb_text_append(text, "; RMS of the fit %.3g %% of <i>F</i><sub>max</sub>.",
                   c->rms / WB_PERCENT);
}

/* The part of a validation from `first` on that exceeds its bound most; `first` where none does. */
static enum wb_validate_part worst_part(const struct wb_validate_result *p,
                                        enum wb_validate_part first)
{
    enum wb_validate_part part = first;
    double most = 1.0;
    for (enum wb_validate_part k = first; k < WB_VALIDATE_PARTS; k++) {
        const struct wb_validate_bound *const bound = &p->bounds[k];
        if (bound->is_exceeded && bound->found / bound->bound > most) {
            most = bound->found / bound->bound;
            part = k;
        }
    }
    return part;
}

/* "loading within 0.68 % of F_max, where the scatter of specimens explains 3.1 %". */
static void append_bound(struct wb_text *text, const struct wb_validate_result *p,
                         enum wb_validate_part part)
{
    const struct wb_validate_bound *const bound = &p->bounds[part];
    const bool is_length = part == WB_VALIDATE_RESIDUAL || part == WB_VALIDATE_SHAPES;
    const double unit = is_length ? WB_MM : WB_PERCENT;
    wb_text_append(text, "%s%s %.3g %s, where the scatter of specimens explains %.3g %s",
                   wb_validate_part_name(part), bound->is_exceeded ? " off by" : " within",
                   bound->found / unit, is_length ? "mm" : "% of <i>F</i><sub>max</sub>",
                   bound->bound / unit, is_length ? "mm" : "%");
}

/* Whether specimens of the other length are predicted, with the numbers of the worst part. The
 * paper's route is fitted to the loading, which is therefore judged apart. */
static void append_prediction(struct wb_text *text, const struct wb_validate_result *p,
                              bool by_cycle)
{
    static const char *const words[] = {
        [WB_VALIDATE_PREDICTED] = "yes",       [WB_VALIDATE_NOT_PREDICTED] = "no",
        [WB_VALIDATE_UNDECIDED] = "undecided", [WB_VALIDATE_BEYOND] = "with care",
        [WB_VALIDATE_NOT_CONVERGED] = "no",
    };
    const enum wb_validate_verdict verdict = wb_validate_bounds_verdict(p);
    const struct wb_validate_bound *const loading = &p->bounds[WB_VALIDATE_LOADING];
    const enum wb_validate_part rest = worst_part(p, WB_VALIDATE_UNLOADING);
    wb_text_append(text, " Specimens of %g mm are predicted: <b>%s</b>; ", p->info.length / WB_MM,
                   words[verdict]);
    if (verdict == WB_VALIDATE_NOT_CONVERGED) {
        wb_text_append(text, "the beam did not converge up to the largest deflection.");
    } else if (!isfinite(loading->bound)) {
        wb_text_append(text,
                       "loading within %.3g %% of <i>F</i><sub>max</sub>; the scatter of specimens "
                       "is not known.",
                       p->elastoplastic.rms / WB_PERCENT);
    } else {
        append_bound(text, p, by_cycle ? worst_part(p, WB_VALIDATE_LOADING) : WB_VALIDATE_LOADING);
        if (!by_cycle && isfinite(p->bounds[rest].bound)) {
            wb_text_append(text, "; ");
            append_bound(text, p, rest);
        }
        wb_text_append(text, ".%s",
                       verdict == WB_VALIDATE_BEYOND
                           ? " They are bent further than the law was measured."
                           : "");
    }
}

static void add_wire(struct wb_found *found, const struct wb_recordings_results *results,
                     const struct wb_recordings_results_wire *wire)
{
    const struct wb_recordings_cycle *const cycle = wb_recordings_results_cycle(wire);
    const struct wb_validate_result *const p = prediction_of(results, wire);
    const bool by_cycle = results->campaign->whole_cycle;
    const bool is_calibrated =
        by_cycle ? cycle != NULL
                 : wb_recordings_results_of(wire, WB_RECORDINGS_CALIBRATION) != NULL;
    struct wb_text text = {0};
    wb_text_append(&text, "<b>%s</b>: ", wire->wanted->markup);
    if (cycle && cycle->calibration.is_stopped)
        wb_text_append(&text, "undecided: stopped before all laws were fitted.");
    else if (!is_calibrated)
        wb_text_append(&text, "not calibrated; the reason is given below.");
    else if (by_cycle)
        append_cycle(&text, &cycle->calibration);
    else
        append_paper(&text, &wire->calibration);
    if (p)
        append_prediction(&text, p, by_cycle);
    const bool is_followed = by_cycle ? cycle && cycle->calibration.is_followed : is_calibrated;
    const bool is_exceeded = p && (wb_validate_bounds_exceeded(p) ||
                                   wb_validate_bounds_verdict(p) == WB_VALIDATE_NOT_CONVERGED);
    wb_found_add(found, is_followed && !is_exceeded ? WB_FOUND_RESULT : WB_FOUND_DOUBTFUL, &text);
}

static void add_note(struct wb_found *found, const struct wb_recordings_results *results)
{
    if (results->campaign->whole_cycle)
        wb_found_say(found, WB_FOUND_NOTE,
                     "In brackets: intervals of 95 %%. Unloading stiffness: change of the moment "
                     "over the change of the curvature, over the first 1 /m from the largest "
                     "curvature.");
    else
        wb_found_say(found, WB_FOUND_NOTE,
                     "\xc2\xb1: standard uncertainty from the scatter between specimens, of "
                     "<i>K</i> a factor. The paper's route states no interval of 95 %%.");
}

/* --- whether to trust it --- */

/* How much of a validation's error the scatter between samples explains. */
static void append_share(struct wb_text *text, const struct wb_validate_result *validation)
{
    if (isfinite(validation->scatter_share))
        wb_text_append(text,
                       " RMS of a perfect model with specimens that differ like these: about "
                       "%.4f, above %.4f in one of twenty validations; found: %.4f, which is %s.",
                       validation->expected_rms, validation->expected_rms_95,
                       validation->elastoplastic.rms,
                       validation->elastoplastic.rms > validation->expected_rms_95
                           ? "more than the scatter of specimens explains"
                           : "no more than the scatter of specimens explains");
    else
        wb_text_append(text, " What the scatter between specimens explains is not known: there are "
                             "fewer than two specimens.");
}

/* Continues a list of wires with another one. */
static void append_to_list(struct wb_text *list, const struct wb_recordings_results_wire *wire)
{
    wb_text_append(list, "%s%s", list->length > 0 ? ", " : "", wire->wanted->markup);
}

/* The limits of the campaign, which bound the RMS of the paper's route. */
static void add_limits(struct wb_found *found, const struct wb_recordings_results *results,
                       enum wb_recordings_purpose purpose)
{
    const double limit = results->campaign->limit[purpose];
    struct wb_text kept = {0};
    for (int i = 0; i < results->n_wires && limit > 0.0; i++) {
        const struct wb_recordings_results_wire *const wire = &results->wires[i];
        const double rms = wb_recordings_results_rms(wire, purpose);
        struct wb_text text = {0};
        if (!wb_recordings_results_of(wire, purpose))
            continue;
        if (wb_recordings_results_keeps(results->campaign, wire, purpose)) {
            append_to_list(&kept, wire);
            wb_text_append(&kept, " (%.4f)", rms);
            continue;
        }
        wb_text_append(&text,
                       "%s, %s by the paper's route: RMS %.4f of <i>F</i><sub>max</sub>, limit "
                       "%.4g exceeded.",
                       wire->wanted->markup, wb_recordings_purposes[purpose], rms, limit);
        if (purpose == WB_RECORDINGS_VALIDATION)
            append_share(&text, &wire->steps[purpose].result);
        wb_found_add(found, WB_FOUND_FAILED, &text);
    }
    if (kept.length > 0)
        wb_found_say(found, WB_FOUND_PASSED,
                     "RMS of the %s by the paper's route, limit %.4g of <i>F</i><sub>max</sub>: "
                     "%.900s.",
                     wb_recordings_purposes[purpose], limit, wb_text_string(&kept));
    wb_text_release(&kept);
}

/* Which predictions are within the bounds that the scatter of specimens gives, and which are not.
 */
static void add_bounds(struct wb_found *found, const struct wb_recordings_results *results)
{
    struct wb_text within = {0}, beyond = {0};
    for (int i = 0; i < results->n_wires; i++) {
        const struct wb_recordings_results_wire *const wire = &results->wires[i];
        const struct wb_validate_result *const p = prediction_of(results, wire);
        if (!p || !wb_validate_bounds_known(p))
            continue;
        const bool is_beyond = wb_validate_bounds_exceeded(p);
        struct wb_text *const text = is_beyond ? &beyond : &within;
        append_to_list(text, wire);
        if (is_beyond) {
            wb_text_append(text, " (");
            wb_validate_bounds_append(text, p);
            wb_text_append(text, ")");
        }
    }
    if (beyond.length > 0)
        wb_found_say(
            found, WB_FOUND_FAILED,
            "Predictions that are off by more than the scatter of specimens explains: "
            "%.900s. A right law exceeds one of these bounds in one of twenty validations.",
            wb_text_string(&beyond));
    if (within.length > 0)
        wb_found_say(found, WB_FOUND_PASSED,
                     "Predictions that are off by no more than the scatter of specimens explains: "
                     "%.900s.",
                     wb_text_string(&within));
    wb_text_release(&beyond);
    wb_text_release(&within);
}

static int count_doubts(const struct wb_cycle_remarks *remarks)
{
    int n = 0;
    for (int i = 0; i < remarks->n; i++)
        n += remarks->items[i].severity != WB_CHECK_NOTE;
    return n;
}

/* Checks of the data and of the law of one wire. */
static void add_checks(struct wb_found *found, const struct wb_recordings_results_wire *wire)
{
    const struct wb_recordings_cycle *const cycle = wb_recordings_results_cycle(wire);
    const char *const label = wire->wanted->markup;
    if (!cycle)
        return;
    const int n = count_doubts(&cycle->remarks);
    if (n > 0)
        wb_found_say(found, WB_FOUND_FAILED,
                     "%d %s of the data of %s; the page of the wire says why.", n,
                     wb_pages_plural(n, "check", "checks"), label);
    if (cycle->has_comparison && cycle->comparison.is_apart)
        wb_found_say(found, WB_FOUND_FAILED,
                     "The law of %s differs from the moments that shapes and strand tension give "
                     "without a law, by %.1f standard deviations.",
                     label, cycle->comparison.in_deviations);
    if (!cycle->calibration.has_unloading)
        wb_found_say(found, WB_FOUND_UNCHECKED,
                     "The hardening rule of %s: no unloading was recorded.", label);
}

/* Contributions that no file states of any wire, by name. */
static void add_unstated(struct wb_found *found, const struct wb_recordings_results *results)
{
    struct wb_text names = {0};
    for (enum wb_contribution row = 0; row < WB_CONTRIBUTIONS; row++) {
        bool is_unstated = false;
        char name[WB_BUDGET_TEXT] = "";
        for (int i = 0; i < results->n_wires && !is_unstated; i++) {
            const struct wb_recordings_cycle *const cycle =
                wb_recordings_results_cycle(&results->wires[i]);
            bool is_stated = true;
            if (!cycle || !wb_cycle_budget_has(&cycle->calibration, row))
                continue;
            wb_cycle_budget_cell(&cycle->calibration.budget[WB_CYCLE_RIGIDITY], row, &is_stated);
            is_unstated = !is_stated;
            wb_cycle_budget_row(&cycle->calibration, row, name);
        }
        if (!is_unstated)
            continue;
        /* "free length, not stated: per 1 %" */
        char *const end = strstr(name, ", not stated");
        if (end)
            *end = '\0';
        wb_text_append(&names, names.length > 0 ? "; " : "");
        wb_text_append_escaped(&names, name);
    }
    if (names.length > 0)
        wb_found_say(found, WB_FOUND_UNCHECKED,
                     "Contributions that no file states, and that the intervals therefore exclude: "
                     "%.900s.",
                     wb_text_string(&names));
    wb_text_release(&names);
}

/* Remarks on the calibration of a wire by the paper's route; returns how many. */
static int remarks_of(const struct wb_recordings_results_wire *wire,
                      const char *remarks[WB_CALIBRATE_MOST_REMARKS])
{
    return wb_recordings_results_of(wire, WB_RECORDINGS_CALIBRATION)
               ? wb_calibrate_remarks(&wire->calibration, remarks)
               : 0;
}

static bool has_remark(const struct wb_recordings_results_wire *wire, const char *remark)
{
    const char *remarks[WB_CALIBRATE_MOST_REMARKS];
    const int n = remarks_of(wire, remarks);
    for (int k = 0; k < n; k++) {
        if (strcmp(remarks[k], remark) == 0)
            return true;
    }
    return false;
}

/* A remark with the wires from `first` on that it holds for. */
static void add_remark(struct wb_found *found, const struct wb_recordings_results *results,
                       int first, const char *remark)
{
    struct wb_text text = {0};
    for (int i = 0; i < first; i++) {
        if (has_remark(&results->wires[i], remark))
            return;
    }
    for (int i = first; i < results->n_wires; i++) {
        if (has_remark(&results->wires[i], remark))
            append_to_list(&text, &results->wires[i]);
    }
    wb_text_append(&text, ": ");
    wb_pages_append_symbols(&text, remark);
    wb_text_append(&text, ".");
    wb_found_add(found, WB_FOUND_UNCHECKED, &text);
}

static void add_remarks(struct wb_found *found, const struct wb_recordings_results *results)
{
    for (int i = 0; i < results->n_wires; i++) {
        const char *remarks[WB_CALIBRATE_MOST_REMARKS];
        const int n = remarks_of(&results->wires[i], remarks);
        for (int k = 0; k < n; k++)
            add_remark(found, results, i, remarks[k]);
    }
}

static void add_trust(struct wb_found *found, const struct wb_recordings_results *results)
{
    const struct wb_recordings *const campaign = results->campaign;
    bool any_limit = false;
    add_bounds(found, results);
    for (enum wb_recordings_purpose purpose = 0; purpose < WB_RECORDINGS_PURPOSES; purpose++) {
        add_limits(found, results, purpose);
        any_limit |= campaign->limit[purpose] > 0.0;
    }
    for (int i = 0; i < results->n_wires; i++)
        add_checks(found, &results->wires[i]);
    if (!any_limit)
        wb_found_say(found, WB_FOUND_UNCHECKED, "The campaign states no limits.");
    if (!(campaign->length[WB_RECORDINGS_VALIDATION] > 0.0))
        wb_found_say(found, WB_FOUND_UNCHECKED,
                     "Another length: the campaign has no validation, so the calibration is not "
                     "compared with data that it was not fitted to.");
    if (campaign->whole_cycle) {
        add_unstated(found, results);
    } else {
        add_remarks(found, results);
        wb_found_say(found, WB_FOUND_UNCHECKED,
                     "The hardening rule: the paper's route is fitted to the loading alone, with "
                     "isotropic hardening.");
    }
}

/* --- what to do next --- */

/* Smallest and largest RMS of the unloading, by one method or the other. */
struct span {
    double low, high; /* 1; NaN: none */
};

static void add_to_span(struct span *span, double rms)
{
    span->low = fmin(span->low, rms);
    span->high = fmax(span->high, rms);
}

/* "0.5 to 2.3 %", or "0.5 %" where both ends are the same. */
static const char *span_words(const struct span *span, char words[32])
{
    char low[12], high[12];
    snprintf(low, sizeof low, "%.1f", span->low / WB_PERCENT);
    snprintf(high, sizeof high, "%.1f", span->high / WB_PERCENT);
    const bool is_one = strcmp(low, high) == 0;
    snprintf(words, 32, "%s%s%s %%", low, is_one ? "" : " to ", is_one ? "" : high);
    return words;
}

static bool has_unloading(const struct wb_validate_result *p)
{
    return p && p->cycles.n_samples > 0 && isfinite(p->cycles.rms);
}

/* Which of both methods predicts the unloading better. */
static void add_method(struct wb_found *found, const struct wb_recordings_results *results)
{
    struct span cycle = {(double)NAN, (double)NAN}, paper = cycle;
    char words[2][32];
    for (int i = 0; i < results->n_wires; i++) {
        const struct wb_recordings_results_wire *const wire = &results->wires[i];
        const struct wb_validate_result *const by_cycle = wb_recordings_results_prediction(wire);
        const struct wb_validate_result *const by_paper =
            wb_recordings_results_of(wire, WB_RECORDINGS_VALIDATION);
        if (!has_unloading(by_cycle) || !has_unloading(by_paper))
            continue;
        add_to_span(&cycle, by_cycle->cycles.rms);
        add_to_span(&paper, by_paper->cycles.rms);
    }
    if (isfinite(cycle.low))
        wb_found_say(
            found, WB_FOUND_NEXT,
            "<b>Method</b>: %s. The law of loading and unloading predicts the unloading "
            "with an RMS error of %s of <i>F</i><sub>max</sub>, the paper's route, which is "
            "fitted to the loading alone, of %s.",
            cycle.high <= paper.high ? "use the law of loading and unloading"
                                     : "neither law predicts the unloading better for all wires",
            span_words(&cycle, words[0]), span_words(&paper, words[1]));
    else if (!results->campaign->whole_cycle)
        wb_found_say(found, WB_FOUND_NEXT,
                     "<b>Method</b>: set <tt>whole_cycle: true</tt> in the campaign to calibrate "
                     "on the unloading, too, where it was recorded. That gives intervals of 95 %% "
                     "and tests the hardening rule. Until then, use these laws for loading only.");
}

/* How many specimens are missing for EI within 5 %. */
static void add_specimens(struct wb_found *found, const struct wb_recordings_results *results)
{
    struct wb_text text = {0};
    for (int i = 0; i < results->n_wires; i++) {
        const struct wb_recordings_cycle *const of =
            wb_recordings_results_cycle(&results->wires[i]);
        if (!of || of->calibration.specimens_for_5_percent <= of->calibration.n_members)
            continue;
        wb_text_append(&text, text.length > 0 ? ", "
                                              : "<b>Test next</b>: for <i>EI</i> within \xc2\xb1"
                                                "5 %%, ");
        wb_text_append(&text, "%d specimens of %s (%d tested)",
                       of->calibration.specimens_for_5_percent, results->wires[i].wanted->markup,
                       of->calibration.n_members);
    }
    if (text.length > 0)
        wb_text_append(&text, ".");
    wb_found_add(found, WB_FOUND_NEXT, &text);
}

static void add_next(struct wb_found *found, const struct wb_recordings_results *results)
{
    bool any_exceeded = false;
    for (int i = 0; i < results->n_wires; i++) {
        const struct wb_validate_result *const p = prediction_of(results, &results->wires[i]);
        any_exceeded |=
            p && (results->campaign->whole_cycle ? wb_validate_bounds_exceeded(p)
                                                 : p->bounds[WB_VALIDATE_LOADING].is_exceeded);
    }
    add_method(found, results);
    add_specimens(found, results);
    if (!results->outcome.is_complete)
        wb_found_say(found, WB_FOUND_NEXT,
                     "<b>Missing</b>: record what is missing, or name it in the campaign, and run "
                     "the same command again.");
    if (any_exceeded)
        wb_found_say(found, WB_FOUND_NEXT,
                     "<b>Prediction</b>: check that the specimens of both lengths are of the same "
                     "wire, then test more of them, before using a law that did not predict the "
                     "other length.");
    if (results->all_virtual)
        wb_found_say(
            found, WB_FOUND_NEXT,
            "<b>Physical wire</b>: record specimens of your wire with <tt>wirebench record</tt>.");
}

/* --- decisions of a laboratory --- */

/* A verdict with uncertainty and decision rule. */
static void put_decision(struct wb_document *document, const struct wb_recordings *campaign,
                         const struct wb_recordings_results_wire *wire,
                         enum wb_recordings_purpose purpose, bool is_good)
{
    const bool is_kept = wb_recordings_results_keeps(campaign, wire, purpose);
    const double uncertainty = wb_recordings_results_uncertainty(wire, purpose);
    char known[80] = "not known (one specimen)";
    if (isfinite(uncertainty))
        snprintf(known, sizeof known, "= %.4f (95 %%, scatter between specimens)", uncertainty);
    wb_pages_put(document, WB_BLOCK_ITEM,
                 !is_kept  ? WB_TONE_WARNING
                 : is_good ? WB_TONE_GOOD
                           : WB_TONE_PLAIN,
                 "%s, %s: RMS %.4f of <i>F</i><sub>max</sub>, <i>U</i> %s, limit %.4g: <b>%s</b> "
                 "by %s acceptance.",
                 wire->wanted->markup, wb_recordings_purposes[purpose],
                 wb_recordings_results_rms(wire, purpose), known, campaign->limit[purpose],
                 is_kept ? "kept" : "exceeded", wb_verdict_rules[campaign->head.laboratory.rule]);
}

static void put_decisions(struct wb_document *document, const struct wb_recordings_results *results)
{
    const struct wb_recordings *const campaign = results->campaign;
    if (!campaign->head.laboratory.is_given)
        return;
    wb_document_heading(document, 2, "decisions", "Decisions on the limits");
    for (int i = 0; i < WB_RECORDINGS_PURPOSES * results->n_wires; i++) {
        const enum wb_recordings_purpose purpose =
            (enum wb_recordings_purpose)(i % WB_RECORDINGS_PURPOSES);
        const struct wb_recordings_results_wire *const wire =
            &results->wires[i / WB_RECORDINGS_PURPOSES];
        if (wb_recordings_results_of(wire, purpose) && campaign->limit[purpose] > 0.0)
            put_decision(document, campaign, wire, purpose, !results->outcome.exceeds_limit);
    }
}

/* --- all of it --- */

void wb_recordings_found_put(struct wb_document *document,
                             const struct wb_recordings_results *results,
                             const struct wb_figures *figures)
{
    struct wb_found found = {0};
    add_origin(&found, results);
    add_incomplete(&found, results);
    for (int i = 0; i < results->n_wires; i++)
        add_wire(&found, results, &results->wires[i]);
    add_note(&found, results);
    add_trust(&found, results);
    add_next(&found, results);
    wb_found_put(&found, document);
    wb_figures_put(figures, document, "found", 0);
    put_decisions(document, results);
}
