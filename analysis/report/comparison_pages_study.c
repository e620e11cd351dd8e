/* The study itself: linear elastic, elastoplastic, residual stresses. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/report/comparison_pages.h"
#include "analysis/report/pages_private.h"
#include "base/text.h"
#include "base/units.h"

static void put_paragraph(struct wb_document *document, struct wb_text *text)
{
    wb_document_paragraph(document, wb_text_string(text));
    document->failed |= text->failed;
    wb_text_release(text);
}

double wb_comparison_pages_force(const struct wb_comparison_results *results)
{
    const struct wb_wire_model *const model =
        results->comparison->cases[WB_COMPARISON_ELASTIC].model;
    return model->step[model->n_steps - 1].loads.follower[1];
}

const char *wb_comparison_pages_figure(char text[48], const struct wb_comparison_results *results,
                                       const char *number)
{
    text[0] = '\0';
    if (results->comparison->printed_source[0])
        snprintf(text, 48, " (the paper's Fig. %s)", number);
    return text;
}

/* --- tips --- */

static const char distances[] =
    "Tip from 3D: distance of the tips. Largest distance: of points at the same arc length.";

struct wb_document_table *wb_comparison_pages_start_tips(struct wb_document *document,
                                                         const char *caption)
{
    static const struct wb_document_column columns[] = {
        {"Model"},
        {.heading = "Tip <i>x</i> (mm)", .right = true, .wraps = true},
        {.heading = "<i>y</i> (mm)", .right = true, .wraps = true},
        {.heading = "<i>z</i> (mm)", .right = true, .wraps = true},
        {.heading = "Angle (degrees)", .right = true, .wraps = true},
        {.heading = "Tip from 3D (mm)", .right = true, .wraps = true},
        {.heading = "Largest distance (mm)", .right = true, .wraps = true},
    };
    return wb_document_table(document, caption ? caption : distances, 7, columns);
}

struct tip {
    const char *label;
    double place[3], angle; /* m, rad */
    double largest;         /* m, of the axis from the solid's */
};

static void put_tip(struct wb_document *document, struct wb_document_table *table,
                    const struct tip *tip, const struct wb_comparison_run *solid, bool begins)
{
    struct wb_pages_row row = {.n = 0};
    wb_pages_cell_plain(&row, WB_TONE_PLAIN, tip->label);
    for (int i = 0; i < 3; i++)
        wb_pages_cell_number(&row, tip->place[i] / WB_MM, 3);
    wb_pages_cell_number(&row, tip->angle / WB_DEGREE, 3);
    double away = (double)NAN;
    if (solid && isfinite(tip->largest))
        away = hypot(hypot(tip->place[0] - solid->tip[0], tip->place[1] - solid->tip[1]),
                     tip->place[2] - solid->tip[2]);
    wb_pages_cell_number(&row, away / WB_MM, 3);
    wb_pages_cell_number(&row, tip->largest / WB_MM, 3);
    wb_pages_put_row(document, table, begins, &row);
}

void wb_comparison_pages_put_tip(struct wb_document *document, struct wb_document_table *table,
                                 const char *label, const struct wb_comparison_run *run,
                                 const struct wb_comparison_run *solid)
{
    if (!run)
        return;
    struct tip tip = {.label = label, .angle = run->tip_angle, .largest = (double)NAN};
    memcpy(tip.place, run->tip, sizeof tip.place);
    if (solid && run != solid)
        tip.largest = wb_comparison_distance(solid, run);
    put_tip(document, table, &tip, solid, run == solid);
}

static void put_rod(struct wb_document *document, struct wb_document_table *table,
                    const char *label, const struct wb_comparison_rod *rod,
                    const struct wb_comparison_run *solid)
{
    const int last = WB_COMPARISON_POINTS - 1;
    if (!rod->reached)
        return;
    const struct tip tip = {.label = label,
                            .place = {rod->x[last], rod->y[last], 0.0},
                            .angle = rod->tip_angle,
                            .largest =
                                solid ? wb_comparison_rod_distance(solid, rod) : (double)NAN};
    put_tip(document, table, &tip, solid, false);
}

/* --- linear elastic --- */

static void put_stresses(struct wb_document *document, const struct wb_comparison_results *results)
{
    static const struct wb_document_column columns[] = {
        {.heading = "From the clamp (mm)", .right = true, .wraps = true},
        {.heading = "Core, 3D (MPa)", .right = true, .wraps = true},
        {.heading = "<i>E\xce\xba</i><i>r</i> (MPa)", .right = true, .wraps = true},
        {.heading = "Ratio", .right = true},
        {.heading = "<i>\xce\xba</i> (1/mm)", .right = true, .wraps = true},
        {.heading = "Jacket, 3D (MPa)", .right = true, .wraps = true},
    };
    const double limit = results->comparison->stress_limit;
    if (results->n_stresses == 0)
        return;
    wb_document_heading(document, 2, "stresses", "Stress beside beam theory");
    struct wb_document_table *const table = wb_document_table(
        document,
        "Largest von Mises stress of a cross section. <i>E\xce\xba</i><i>r</i>: Young's modulus of "
        "the core, curvature of the exact elastic rod under the follower force, and the core's "
        "radius.",
        6, columns);
    for (int i = 0; i < results->n_stresses; i++) {
        const struct wb_comparison_stress *const stress = &results->stresses[i];
        const double ratio = stress->core.stress / stress->beam;
        struct wb_pages_row row = {.n = 0};
        wb_pages_cell_number(&row, stress->x / WB_MM, 2);
        wb_pages_cell_number(&row, stress->core.stress / WB_MPA, 1);
        wb_pages_cell_number(&row, stress->beam / WB_MPA, 1);
        if (limit > 0.0)
            wb_pages_cell(&row, fabs(ratio - 1.0) <= limit ? WB_TONE_GOOD : WB_TONE_WARNING, "%.4f",
                          ratio);
        else
            wb_pages_cell_number(&row, ratio, 4);
        wb_pages_cell_number(&row, stress->curvature * WB_MM, 6);
        wb_pages_cell_number(&row, stress->jacket.stress / WB_MPA, 2);
        wb_pages_put_row(document, table, false, &row);
    }
}

static void put_largest(struct wb_document *document, const struct wb_comparison_results *results,
                        const struct wb_comparison_run *run)
{
    const struct wb_comparison *const comparison = results->comparison;
    const struct wb_wire_model_part *const core =
        &comparison->cases[WB_COMPARISON_ELASTIC].model->part[0];
    const struct wb_field *const field =
        wb_fields_find(&run->fields, comparison->loaded_state, (double)NAN);
    const struct wb_wire_model *const plastic =
        comparison->cases[WB_COMPARISON_ELASTOPLASTIC].model;
    const struct wb_comparison_peak peak = wb_comparison_find_peak(field, 0);
    const double root =
        core->material.youngs_modulus * results->exact.curvature[0] * 0.5 * core->outer_diameter;
    struct wb_text text = {0};
    if (!isfinite(peak.stress))
        return;
    wb_text_append(&text,
                   "The largest von Mises stress of the core is <b>%.0f MPa</b>, %.2f mm from the "
                   "clamp: %.1f times its yield stress of %.0f MPa, so that the linear elastic "
                   "model does not hold. Beam theory has %.0f MPa at the clamp.",
                   peak.stress / WB_MPA, peak.reference[0] / WB_MM,
                   peak.stress / plastic->part[0].material.yield_stress,
                   plastic->part[0].material.yield_stress / WB_MPA, root / WB_MPA);
    if (comparison->printed_stress > 0.0)
        wb_text_append(&text, " The paper prints %.0f MPa.", comparison->printed_stress / WB_MPA);
    if (comparison->printed_stress > 0.0 && wb_comparison_has_substitutes(comparison))
        wb_text_append(&text,
                       " Its Young's modulus of copper is lost, and the core's was chosen so "
                       "that beam theory gives that stress.");
    put_paragraph(document, &text);
}

void wb_comparison_pages_elastic(struct wb_document *document,
                                 const struct wb_comparison_results *results,
                                 const struct wb_comparison_figures *figures)
{
    const struct wb_comparison_run *const solid =
        wb_comparison_usable(results, WB_COMPARISON_ELASTIC, WB_COMPARISON_SOLID);
    const struct wb_comparison_run *const contact =
        wb_comparison_usable(results, WB_COMPARISON_CONTACT, WB_COMPARISON_SOLID);
    const struct wb_comparison_run *const rod =
        wb_comparison_usable(results, WB_COMPARISON_ELASTIC, WB_COMPARISON_ROD);
    const struct wb_wire_model *const model =
        results->comparison->cases[WB_COMPARISON_ELASTIC].model;
    char caption[700], in[48];
    wb_document_heading(document, 1, "elastic", "Linear elastic: solid and rod");
    if (figures->elastic) {
        snprintf(
            caption, sizeof caption,
            "Simulated wire of linear elastic materials under a follower force of %g N%s: von "
            "Mises "
            "stress on the longitudinal section as it is deformed, and on a cross section, seen "
            "from the clamp. Ring: the largest value.",
            wb_comparison_pages_force(results), wb_comparison_pages_figure(in, results, "3a"));
        wb_document_figures(document, figures->elastic, caption, NULL, NULL);
    }
    if (solid)
        put_largest(document, results, solid);
    put_stresses(document, results);
    wb_document_heading(document, 2, "elastic-shapes", "Shapes");
    if (figures->elastic_shapes) {
        snprintf(caption, sizeof caption,
                 "Simulated shapes of the axis at %g N%s, and how far they lie from that of the "
                 "bonded solid.",
                 wb_comparison_pages_force(results),
                 wb_comparison_pages_figure(in, results, "4, linear elastic"));
        wb_document_figures(document, figures->elastic_shapes, caption, NULL, NULL);
    }
    struct wb_document_table *const table = wb_comparison_pages_start_tips(
        document, "Tip from 3D: distance of the tips. Largest distance: of points at the same arc "
                  "length. Exact: the elastica under the follower force, which neither shears nor "
                  "stretches.");
    wb_comparison_pages_put_tip(document, table, "3D, bonded", solid, solid);
    wb_comparison_pages_put_tip(document, table, "3D, friction", contact, solid);
    wb_comparison_pages_put_tip(document, table, "1D", rod, solid);
    put_rod(document, table, "1D, exact", &results->exact, solid);
    struct wb_text text = {0};
    wb_text_append(&text,
                   "The rod's effective Young's modulus is %.2f GPa (eq. 8), its Poisson's ratio "
                   "%.3f (eq. 9).",
                   wb_wire_model_youngs_modulus(model) / (1e3 * WB_MPA),
                   wb_wire_model_poissons_ratio(model));
    if (contact && solid)
        wb_text_append(
            &text,
            " Friction (<i>\xce\xbc</i> = %g) instead of a bond moves the axis by %.4f "
            "mm at most.",
            results->comparison->cases[WB_COMPARISON_CONTACT].model->jacket_contact.friction,
            wb_comparison_distance(solid, contact) / WB_MM);
    if (contact && isfinite(contact->slip))
        wb_text_append(&text, " Core and jacket slip by %.4f mm at most.", contact->slip / WB_MM);
    put_paragraph(document, &text);
}

/* --- elastoplastic --- */

/* Printed properties under which the wire curls up. */
static void append_misprint(struct wb_text *text, const struct wb_comparison_results *results,
                            bool solid_curls)
{
    if (!(results->printed.tip_angle / WB_DEGREE > 90.0))
        return;
    wb_text_append(text, " The paper's text suggests no such curl, so its <i>K</i> is taken for a "
                         "misprint");
    if (results->tenfold.reached)
        wb_text_append(text, " (ten times as much gives %.0f degrees)",
                       results->tenfold.tip_angle / WB_DEGREE);
    wb_text_append(text, ".");
    if (solid_curls)
        wb_text_append(text, " That the solid of copper as soft as the literature has it curls up "
                             "too says that the paper's figures need a harder copper than this, or "
                             "show a curl that its text does not mention; without its Table 1 "
                             "neither can be told.");
}

/* What the reader must know before comparing with the paper. */
static void put_curl(struct wb_document *document, const struct wb_comparison_results *results,
                     const struct wb_comparison_run *solid)
{
    const struct wb_comparison *const comparison = results->comparison;
    const struct wb_material *const copper =
        &comparison->cases[WB_COMPARISON_ELASTOPLASTIC].model->part[0].material;
    struct wb_text text = {0};
    if (wb_comparison_has_substitutes(comparison))
        wb_text_append(&text, "<b>The materials are substitutes</b> for the paper's Table 1, which "
                              "is lost; their hardening is that of the literature. ");
    wb_text_append(&text,
                   "With <i>\xcf\x83</i><sub>Y</sub> = %.0f MPa, <i>K</i> = %.0f MPa and <i>n</i> "
                   "= %.2f of the core the solid%s: at %g N its tip has turned by <b>%.0f "
                   "degrees</b>, where the elastic one turns by %.0f.",
                   copper->yield_stress / WB_MPA, copper->strength_coefficient / WB_MPA,
                   copper->hardening_exponent,
                   solid->tip_angle / WB_DEGREE > 90.0 ? " itself curls up" : " yields",
                   solid->force, solid->tip_angle / WB_DEGREE,
                   results->exact.tip_angle / WB_DEGREE);
    if (results->printed.done) {
        const struct wb_material *const printed = &comparison->printed_wire.material;
        wb_text_append(
            &text,
            " With the effective properties that the paper prints (<i>\xcf\x83</i><sub>Y</sub> = "
            "%g MPa, <i>K</i> = %g MPa, <i>n</i> = %g) the 1D wire curls to <b>%.0f degrees</b>",
            printed->yield_stress / WB_MPA, printed->strength_coefficient / WB_MPA,
            printed->hardening_exponent, results->printed.tip_angle / WB_DEGREE);
        if (!results->printed.reached)
            wb_text_append(&text, " at %.1f N, where its computation ended",
                           results->printed.force[results->printed.n_curve - 1]);
        wb_text_append(&text, "; without hardening it would give way at %.1f N.",
                       results->collapse_force);
        append_misprint(&text, results, solid->tip_angle / WB_DEGREE > 90.0);
    }
    wb_document_notice(document, WB_TONE_WARNING, wb_text_string(&text));
    document->failed |= text.failed;
    wb_text_release(&text);
}

static void put_property(struct wb_document *document, struct wb_document_table *table,
                         const struct wb_comparison_results *results, int i)
{
    const struct wb_pages_property *const property = &wb_pages_properties[i];
    const int decimals = i == 2 ? 1 : property->decimals; /* K is small here */
    const bool fitted = results->fit_state == WB_COMPARISON_USABLE;
    const bool printed = results->comparison->has_printed_wire;
    struct wb_pages_row row = {.n = 0};
    wb_pages_cell(&row, WB_TONE_PLAIN, "%s %s", property->name, property->symbol);
    wb_pages_cell(&row, WB_TONE_QUIET, "%s", property->unit);
    wb_pages_cell_number(
        &row, fitted ? wb_pages_value(&results->fit.material, i) / property->factor : (double)NAN,
        decimals);
    wb_pages_cell_number(&row,
                         printed ? wb_pages_value(&results->comparison->printed_wire.material, i) /
                                       property->factor
                                 : (double)NAN,
                         decimals);
    wb_pages_put_row(document, table, false, &row);
}

static void put_fit(struct wb_document *document, const struct wb_comparison_results *results,
                    const struct wb_comparison_run *solid)
{
    static const struct wb_document_column columns[] = {
        {"Property"},
        {"Unit"},
        {.heading = "Fitted", .right = true},
        {.heading = "Printed", .right = true},
    };
    const struct wb_comparison *const comparison = results->comparison;
    char source[400], caption[900];
    wb_document_heading(document, 2, "fit", "Properties of the rod, fitted to the solid");
    if (results->fit_state != WB_COMPARISON_USABLE) {
        char problem[900], item[1000];
        snprintf(item, sizeof item, "<b>No fit</b>: %s",
                 wb_pages_escape(problem, sizeof problem, wb_text_string(&results->fit_problem)));
        wb_document_item(document, WB_TONE_WARNING, item);
    }
    snprintf(
        caption, sizeof caption,
        "%s, <i>\xcf\x83</i><sub>Y</sub> of eq. 11, <i>K</i> and <i>n</i> by the search of "
        "section 4.1 on the solid's deflection at equal forces. Printed: %s; the materials behind "
        "both differ, so that they need not agree.",
        comparison->mixture ? "<i>E</i> of eq. 8" : "<i>E</i> of eq. 10",
        wb_pages_escape(source, sizeof source,
                        comparison->has_printed_wire ? comparison->printed_source : "none"));
    struct wb_document_table *const table = wb_document_table(document, caption, 4, columns);
    for (int i = 0; i < 4; i++)
        put_property(document, table, results, i);
    if (results->fit_state != WB_COMPARISON_USABLE)
        return;
    struct wb_text text = {0};
    wb_text_append(&text,
                   "At equal forces the fitted rod's deflection follows the solid's with an RMS "
                   "error of %.2f %% of the largest (%.1f mm)",
                   results->fit.rms / WB_PERCENT, results->fit.max_deflection / WB_MM);
    if (results->fitted.reached)
        wb_text_append(&text, "; at %g N its axis is within %.2f mm of the solid's.", solid->force,
                       wb_comparison_rod_distance(solid, &results->fitted) / WB_MM);
    else
        wb_text_append(&text, "; its computation ended at %.1f N.",
                       results->fitted.force[results->fitted.n_curve - 1]);
    if (results->fit.end != WB_CALIBRATE_SIZE && results->fit.end != WB_CALIBRATE_ERROR)
        wb_text_append(&text, " The search ended because %s.",
                       wb_calibrate_end_text(results->fit.end));
    const char *remarks[WB_CALIBRATE_MOST_REMARKS];
    const int n = wb_calibrate_remarks(&results->fit, remarks);
    for (int i = 0; i < n; i++)
        wb_text_append(&text, " Remark: %s.", remarks[i]);
    put_paragraph(document, &text);
}

static void put_split(struct wb_document *document, const struct wb_comparison_results *results)
{
    const struct wb_wire_model *const model =
        results->comparison->cases[WB_COMPARISON_ELASTOPLASTIC].model;
    const struct wb_wire_model_part *const core = &model->part[0], *const jacket = &model->part[1];
    const double most = wb_wire_model_youngs_modulus(model) *
                        pow(jacket->outer_diameter / core->outer_diameter, 4.0);
    struct wb_text text = {0};
    wb_text_append(
        &text,
        "<b>The split between core and jacket is ill-conditioned.</b> Eq. 8 with "
        "<i>E</i><sub>eff</sub> = %.2f GPa leaves %.0f MPa for the jacket when the core "
        "has %.1f GPa; 1 %% of the core's modulus moves the jacket's by <b>%.0f MPa</b>, "
        "and above %.2f GPa of the core nothing is left for it.",
        wb_wire_model_youngs_modulus(model) / (1e3 * WB_MPA),
        jacket->material.youngs_modulus / WB_MPA, core->material.youngs_modulus / (1e3 * WB_MPA),
        wb_comparison_split(model, 0.01) / WB_MPA, most / (1e3 * WB_MPA));
    put_paragraph(document, &text);
}

void wb_comparison_pages_elastoplastic(struct wb_document *document,
                                       const struct wb_comparison_results *results,
                                       const struct wb_comparison_figures *figures)
{
    const struct wb_comparison_run *const solid =
        wb_comparison_usable(results, WB_COMPARISON_ELASTOPLASTIC, WB_COMPARISON_SOLID);
    const struct wb_comparison_run *const rod =
        wb_comparison_usable(results, WB_COMPARISON_ELASTOPLASTIC, WB_COMPARISON_ROD);
    char caption[700], in[48];
    wb_document_heading(document, 1, "elastoplastic", "Elastoplastic: solid and rod");
    if (solid)
        put_curl(document, results, solid);
    if (figures->elastoplastic) {
        snprintf(caption, sizeof caption,
                 "The same wire of elastoplastic materials at %g N%s: von Mises stress, simulated. "
                 "The colours have another scale than the elastic ones.",
                 wb_comparison_pages_force(results), wb_comparison_pages_figure(in, results, "3b"));
        wb_document_figures(document, figures->elastoplastic, caption, NULL, NULL);
    }
    if (figures->shapes) {
        snprintf(
            caption, sizeof caption,
            "Simulated shapes of the axis at %g N%s, and how far they lie from that of the solid. "
            "1D fibres: each material with its own law; 1D fitted: one homogenised material, "
            "fitted to the solid.",
            wb_comparison_pages_force(results),
            wb_comparison_pages_figure(in, results, "4, elastoplastic"));
        wb_document_figures(document, figures->shapes, caption, NULL, NULL);
    }
    wb_document_heading(document, 2, "elastoplastic-shapes", "Shapes");
    struct wb_document_table *const table = wb_comparison_pages_start_tips(document, NULL);
    wb_comparison_pages_put_tip(document, table, "3D", solid, solid);
    wb_comparison_pages_put_tip(document, table, "1D fibres", rod, solid);
    if (results->fit_state == WB_COMPARISON_USABLE)
        put_rod(document, table, "1D fitted", &results->fitted, solid);
    put_rod(document, table, "1D as printed", &results->printed, solid);
    put_fit(document, results, solid);
    if (figures->loading)
        wb_document_figures(document, figures->loading,
                            results->printed.reached
                                ? "Follower force against deflection and angle of the tip, "
                                  "simulated. As printed: with the paper's effective properties."
                                : "Follower force against deflection and angle of the tip, "
                                  "simulated.",
                            NULL, NULL);
    put_split(document, results);
}
