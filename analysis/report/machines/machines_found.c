#include "analysis/report/machines/machines_kind.h"

#include <math.h>
#include <string.h>

#include "analysis/report/found.h"
#include "analysis/report/pages.h"
#include "base/units.h"

static void add_incomplete(struct wb_found *found, const struct wb_machines_results *results)
{
    const struct wb_kind_outcome *const outcome = &results->outcome;
    const int n_rejected = outcome->n_wanted - outcome->n_missing - outcome->n_usable;
    if (outcome->n_missing > 0 && results->has_folder)
        wb_found_say(found, WB_FOUND_INCOMPLETE, "<b>Incomplete.</b> %d of %d files are missing.",
                     outcome->n_missing, outcome->n_wanted);
    else if (outcome->n_missing > 0)
        wb_found_say(found, WB_FOUND_INCOMPLETE,
                     "<b>Incomplete.</b> The data are missing: the environment variable "
                     "<tt>%s</tt>, the path of their folder, is not set.",
                     results->campaign->environment);
    if (n_rejected > 0)
        wb_found_say(found, WB_FOUND_INCOMPLETE,
                     "<b>Incomplete.</b> %d of %d files could not be used; the tables of the "
                     "groups give the reasons.",
                     n_rejected, outcome->n_wanted);
    if (outcome->n_missing > 0)
        wb_found_say(found, WB_FOUND_NEXT,
                     "<b>Missing</b>: provide the files and run the same command again.");
}

/* Appends the name of a wire. A wire that the campaign does not name has the name of its group;
 * then the label of the group is appended, too. */
static void append_wire(struct wb_text *text, const struct wb_machines_results *results,
                        const struct wb_machines_fit *fit)
{
    const struct wb_machines_group *const group = &results->campaign->groups[fit->first];
    wb_text_append_escaped(text, group->piece.wire);
    if (strcmp(group->piece.wire, group->name) == 0 && strcmp(group->name, group->label) != 0) {
        wb_text_append(text, ", ");
        wb_text_append_escaped(text, group->label);
    }
}

/* Adds the calibrated bending moment of a wire at the largest curvature of its tests. */
static void add_fit(struct wb_found *found, const struct wb_machines_results *results,
                    const struct wb_machines_fit *fit)
{
    const struct wb_three_point_calibration *const c = &fit->calibration;
    const int last = WB_THREE_POINT_MOMENTS - 1;
    struct wb_text text = {0};
    wb_text_append(&text, "<b>");
    append_wire(&text, results, fit);
    wb_text_append(&text, "</b>: ");
    if (!fit->is_fitted) {
        wb_text_append(&text, "not calibrated; the reason is given below.");
        wb_found_add(found, WB_FOUND_DOUBTFUL, &text);
        return;
    }
    const struct wb_estimate *const moment = &c->moment[last];
    const int decimals = wb_pages_decimals(moment->value / WB_NMM);
    wb_text_append(&text, "bending moment %.*f N mm", decimals, moment->value / WB_NMM);
    if (isfinite(moment->low))
        wb_text_append(&text, " (%.*f to %.*f)", decimals, moment->low / WB_NMM, decimals,
                       moment->high / WB_NMM);
    wb_text_append(&text, " at a curvature of %.3g /m, from %d of %d tests", c->curvature[last],
                   c->n_fitted, fit->n);
    const struct wb_estimate *const EI = &c->rigidity;
    const int digits = wb_pages_decimals(EI->value / WB_NMM2);
    if (!c->is_rigidity_identifiable)
        wb_text_append(
            &text,
            "; the flexural rigidity cannot be determined, because unloading was not recorded "
            "in every test.");
    else if (isfinite(EI->low))
        wb_text_append(&text, "; flexural rigidity %.*f N mm\xc2\xb2 (%.*f to %.*f).", digits,
                       EI->value / WB_NMM2, digits, EI->low / WB_NMM2, digits, EI->high / WB_NMM2);
    else
        wb_text_append(&text, "; flexural rigidity %.*f N mm\xc2\xb2.", digits,
                       EI->value / WB_NMM2);
    wb_found_add(found, wb_machines_fits_is_biased(fit) ? WB_FOUND_DOUBTFUL : WB_FOUND_RESULT,
                 &text);
}

/* Adds the measured force and stiffness of a group, in campaigns that do not calibrate. */
static void add_group(struct wb_found *found, const struct wb_machines_group *group,
                      const struct wb_machines_group_results *of)
{
    struct wb_text text = {0};
    wb_text_append(&text, "<b>");
    wb_text_append_escaped(&text, group->label);
    wb_text_append(&text, "</b>: ");
    if (of->n_usable == 0) {
        wb_text_append(&text, "no test could be used.");
        wb_found_add(found, WB_FOUND_DOUBTFUL, &text);
        return;
    }
    const double force = of->force[WB_MACHINES_GRID - 1] / WB_MN, EI = of->rigidity / WB_NMM2;
    wb_text_append(&text, "%.*f mN at a deflection of %.3g mm", wb_pages_decimals(force), force,
                   of->reach / WB_MM);
    if (isfinite(EI))
        wb_text_append(&text,
                       ", apparent flexural rigidity at a deflection of 0.02 of the span "
                       "%.*f N mm\xc2\xb2",
                       wb_pages_decimals(EI), EI);
    if (isfinite(of->rigidity_deviation))
        wb_text_append(&text, " with a standard deviation of %.2g %% between tests",
                       of->rigidity_deviation / of->rigidity / WB_PERCENT);
    wb_text_append(&text, ", from %d of %d tests.", of->n_usable, group->n_tests);
    wb_found_add(found, WB_FOUND_RESULT, &text);
}

/* Adds the moment of a layered group at the largest curvature of its comparison. */
static void add_layer(struct wb_found *found, const struct wb_machines_results *results,
                      const struct wb_machines_layer *layer)
{
    const struct wb_cable_place *const place = &layer->place[WB_MACHINES_PLACES - 1];
    struct wb_text text = {0};
    if (layer->n == 0)
        return;
    wb_text_append(&text, "<b>");
    wb_text_append_escaped(&text, results->campaign->groups[layer->group].label);
    wb_text_append(&text, "</b>: moment %.3g times that of freely sliding wires",
                   place->ratio.value);
    if (isfinite(place->ratio.low))
        wb_text_append(&text, " (%.3g to %.3g)", place->ratio.low, place->ratio.high);
    wb_text_append(&text,
                   " at %.3g /m; <i>\xcf\x87</i> = ", layer->curvature[WB_MACHINES_PLACES - 1]);
    wb_pages_append_number(&text, place->chi.value, 2);
    if (isfinite(place->chi.low)) {
        wb_text_append(&text, " (");
        wb_pages_append_number(&text, place->chi.low, 2);
        wb_text_append(&text, " to ");
        wb_pages_append_number(&text, place->chi.high, 2);
        wb_text_append(&text, ")");
    }
    wb_text_append(&text, " on a scale from sliding (0) to bonded wires (1).");
    wb_found_add(found, WB_FOUND_RESULT, &text);
}

/* --- checks --- */

/* Adds the bias of each law against tests left out, and the fits that did not converge. */
static void add_checks(struct wb_found *found, const struct wb_machines_results *results)
{
    struct wb_text passed = {0};
    for (int i = 0; i < results->fits.n; i++) {
        const struct wb_machines_fit *const fit = &results->fits.fits[i];
        const double ratio = fit->left_out.bias / fit->left_out.scatter;
        struct wb_text text = {0};
        if (fit->is_validated && !wb_machines_fits_is_biased(fit)) {
            wb_text_append(&passed, passed.length > 0 ? ", " : "");
            append_wire(&passed, results, fit);
            wb_text_append(&passed, " (%.2f)", ratio);
        } else if (fit->is_validated) {
            wb_text_append(&text, "Bias of the law of ");
            append_wire(&text, results, fit);
            wb_text_append(
                &text, " against tests left out: %.2f times their standard deviation, limit 0.7.",
                ratio);
        } else if (fit->is_fitted) {
            wb_text_append(&text, "The law of ");
            append_wire(&text, results, fit);
            wb_text_append(&text, " could not be validated by leaving tests out.");
        }
        wb_found_add(found, WB_FOUND_FAILED, &text);
        const int n = wb_machines_fits_count_unconverged(fit);
        if (n > 0) {
            wb_text_append(&text, "%d %s of ", n, wb_pages_plural(n, "fit", "fits"));
            append_wire(&text, results, fit);
            wb_text_append(&text, " did not converge.");
        }
        wb_found_add(found, WB_FOUND_FAILED, &text);
    }
    if (passed.length > 0)
        wb_found_say(
            found, WB_FOUND_PASSED,
            "Bias of the law against tests left out, relative to their standard deviation, "
            "limit 0.7: %.600s.",
            wb_text_string(&passed));
    wb_text_release(&passed);
}

static void add_unchecked(struct wb_found *found, const struct wb_machines_results *results)
{
    bool has_compliance = true, has_unloading = true;
    for (int i = 0; i < results->fits.n; i++) {
        const struct wb_three_point_calibration *const c = &results->fits.fits[i].calibration;
        if (!results->fits.fits[i].is_fitted)
            continue;
        has_compliance &= c->is_compliance_known;
        has_unloading &= c->is_rigidity_identifiable;
    }
    if (results->fits.n == 0)
        wb_found_say(found, WB_FOUND_UNCHECKED,
                     "Material laws: the campaign has no <tt>calibrate: true</tt>, so no law was "
                     "fitted.");
    if (results->fits.n > 0)
        wb_found_say(found, WB_FOUND_UNCHECKED,
                     "Friction at the supports and nose radius: not measured by these tests. The "
                     "tables give the range of each moment for the ranges of the machine file.");
    if (!has_compliance)
        wb_found_say(found, WB_FOUND_UNCHECKED,
                     "Compliance of the machine: the machine file does not give it, so the travel "
                     "includes it.");
    if (!has_unloading)
        wb_found_say(found, WB_FOUND_UNCHECKED,
                     "Unloading and springback: unloading was not recorded in every test.");
    if (results->cable.n_layers > 0)
        wb_found_say(found, WB_FOUND_UNCHECKED,
                     "Insulation, lay and outer layers: both bounds of <i>\xcf\x87</i> neglect "
                     "them.");
}

static void add_next(struct wb_found *found, const struct wb_machines_results *results)
{
    bool any_biased = false, has_compliance = true, has_unloading = true;
    for (int i = 0; i < results->fits.n; i++) {
        const struct wb_machines_fit *const fit = &results->fits.fits[i];
        any_biased |= wb_machines_fits_is_biased(fit);
        has_compliance &= !fit->is_fitted || fit->calibration.is_compliance_known;
        has_unloading &= !fit->is_fitted || fit->calibration.is_rigidity_identifiable;
    }
    if (results->fits.n == 0)
        wb_found_say(found, WB_FOUND_NEXT,
                     "<b>Calibrate</b>: set <tt>calibrate: true</tt> in the campaign to fit a law "
                     "with intervals to each wire.");
    if (!has_unloading)
        wb_found_say(found, WB_FOUND_NEXT,
                     "<b>Unload</b>: record the unloading in the next tests; it determines the "
                     "flexural rigidity and the springback.");
    if (!has_compliance)
        wb_found_say(found, WB_FOUND_NEXT,
                     "<b>Compliance</b>: measure the compliance of the machine with a stiff bar "
                     "(<tt>wirebench calibrate --compliance</tt>) and enter it in the machine "
                     "file.");
    if (any_biased)
        wb_found_say(
            found, WB_FOUND_NEXT,
            "<b>Bias</b>: use the measured curve where the law is biased against tests left out.");
}

void wb_machines_found_put(struct wb_document *document, const struct wb_machines_results *results)
{
    const struct wb_machines *const campaign = results->campaign;
    struct wb_found found = {0};
    add_incomplete(&found, results);
    for (int i = 0; i < results->fits.n; i++)
        add_fit(&found, results, &results->fits.fits[i]);
    for (int g = 0; results->fits.n == 0 && g < campaign->n_groups; g++)
        add_group(&found, &campaign->groups[g], &results->groups[g]);
    for (int i = 0; i < results->cable.n_layers; i++)
        add_layer(&found, results, &results->cable.layers[i]);
    if (results->fits.n > 0 || results->cable.n_layers > 0)
        wb_found_say(&found, WB_FOUND_NOTE,
                     "In brackets: 95 %% intervals from the scatter between tests, or between the "
                     "means of series.");
    add_checks(&found, results);
    add_unchecked(&found, results);
    add_next(&found, results);
    wb_found_put(&found, document);
}
