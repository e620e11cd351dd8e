/* The report of wires, in order: summary, linear elastic, elastoplastic, residual stresses, cost,
 * provenance. */
#include "analysis/report/wires/wires_kind.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/report/pages.h"
#include "analysis/report/simulation_pages.h"
#include "base/units.h"

/* --- the fit, where it failed --- */

static void put_unfitted(struct wb_document *document, const struct wb_wires_results *results)
{
    if (results->fit_state != WB_SIMULATION_USABLE)
        wb_pages_item(document, WB_TONE_WARNING,
                      "<b>No fitted rod</b>: ", wb_text_string(&results->fit_problem), "", "");
}

/* --- results beside those that the paper prints --- */

struct fact {
    const char *what, *unit;
    double ours;
    int decimals;
    const char *paper; /* NULL or "": nothing */
};

static void put_fact(struct wb_document_table *table, const struct fact *fact)
{
    wb_document_row(table, false);
    wb_pages_cell(table, WB_TONE_PLAIN, "%s", fact->what);
    wb_pages_cell(table, WB_TONE_QUIET, "%s", fact->unit);
    wb_pages_cell_number(table, fact->ours, fact->decimals);
    if (fact->paper && fact->paper[0])
        wb_pages_cell_plain(table, WB_TONE_PLAIN, fact->paper);
    else
        wb_pages_cell(table, WB_TONE_QUIET, "\xe2\x80\x93");
}

static double angle_of(const struct wb_wires_run *run)
{
    return run ? run->tip_angle / WB_DEGREE : (double)NAN;
}

static double largest_stress(const struct wb_wires_results *results, int index)
{
    const struct wb_field *const field = wb_wires_field(
        wb_wires_solid_run(results, index), results->comparison->loaded_state, (double)NAN);
    return wb_wires_find_peak(field, 0).stress / WB_MPA;
}

static double distance_between(const struct wb_wires_run *one, const struct wb_wires_run *other)
{
    return one && other ? wb_wires_distance(one, other) / WB_MM : (double)NAN;
}

static void put_facts(struct wb_document *document, const struct wb_wires_results *results)
{
    static const struct wb_document_column columns[] = {
        {.heading = "Simulated at the full force", .wraps = true},
        {"Unit"},
        {.heading = "Here", .right = true},
        {.heading = "Paper", .right = true},
    };
    const struct wb_wires *const comparison = results->comparison;
    const struct wb_wires_run *const elastic = wb_wires_solid_run(results, WB_WIRES_ELASTIC);
    const struct wb_wires_run *const plastic = wb_wires_solid_run(results, WB_WIRES_ELASTOPLASTIC);
    const bool fitted = results->fit_state == WB_SIMULATION_USABLE && results->fitted.reached;
    const double none = (double)NAN;
    char stress[40] = "", cost[40] = "";
    if (comparison->printed_stress > 0.0)
        snprintf(stress, sizeof stress, "%.0f", comparison->printed_stress / WB_MPA);
    if (comparison->printed_cost > 0.0)
        snprintf(cost, sizeof cost, "below %g", comparison->printed_cost / WB_PERCENT);
    const struct fact facts[] = {
        {"Elastic: largest von Mises stress of the core, 3D", "MPa",
         largest_stress(results, WB_WIRES_ELASTIC), 0, stress},
        {"Elastic: largest distance of the axes, 1D from 3D", "mm",
         distance_between(elastic, wb_wires_rod_run(results, WB_WIRES_ELASTIC)), 3, NULL},
        {"Elastic: largest distance of the axes, friction from bond", "mm",
         distance_between(elastic, wb_wires_solid_run(results, WB_WIRES_CONTACT)), 3, NULL},
        {"Elastic: angle of the tip, 3D", "degrees", angle_of(elastic), 2, NULL},
        {"Elastoplastic: angle of the tip, 3D", "degrees", angle_of(plastic), 1, NULL},
        {"Elastoplastic: largest distance of the axes, 1D fibres from 3D", "mm",
         distance_between(plastic, wb_wires_rod_run(results, WB_WIRES_ELASTOPLASTIC)), 2, NULL},
        {"Elastoplastic: largest distance of the axes, 1D fitted from 3D", "mm",
         fitted ? wb_wires_rod_distance(plastic, &results->fitted) / WB_MM : none, 2, NULL},
        {"Elastoplastic: angle of the tip, 1D with the printed properties", "degrees",
         results->printed.reached ? results->printed.tip_angle / WB_DEGREE : none, 0, NULL},
        {"Cost of the elastic rod over the solid's", "%",
         wb_wires_cost(results, WB_WIRES_ELASTIC) / WB_PERCENT, 2, cost},
    };
    wb_document_heading(document, 2, "facts", "Results beside the paper");
    struct wb_document_table *const table = wb_document_table(
        document,
        comparison->printed_source[0]
            ? "Paper: printed values. It prints no others, and its figures are lost."
            : NULL,
        4, columns);
    for (size_t i = 0; i < WB_COUNT(facts); i++)
        put_fact(table, &facts[i]);
}

static void put_summary(struct wb_document *document, const struct wb_wires_results *results,
                        const struct wb_figures *figures)
{
    struct wb_verdict verdicts[WB_WIRES_VERDICTS];
    const int n = wb_wires_results_judge(results, verdicts);
    wb_wires_found_put(document, results);
    wb_figures_put(figures, document, "found", 0);
    wb_simulation_pages_put_decisions(document, results->outcome.campaign, verdicts, n);
    wb_simulation_pages_put_missing(document, &results->outcome, wb_wires_results_list, results);
    put_unfitted(document, results);
    put_facts(document, results);
}

/* --- tips --- */

static const char distances[] =
    "Tip from 3D: distance of the tips. Largest distance: of points at the same arc length.";

static struct wb_document_table *start_tips(struct wb_document *document, const char *caption)
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

static void put_tip(struct wb_document_table *table, const struct tip *tip,
                    const struct wb_wires_run *solid, bool begins)
{
    wb_document_row(table, begins);
    wb_pages_cell_plain(table, WB_TONE_PLAIN, tip->label);
    for (int i = 0; i < 3; i++)
        wb_pages_cell_number(table, tip->place[i] / WB_MM, 3);
    wb_pages_cell_number(table, tip->angle / WB_DEGREE, 3);
    double away = (double)NAN;
    if (solid && isfinite(tip->largest))
        away = hypot(hypot(tip->place[0] - solid->tip[0], tip->place[1] - solid->tip[1]),
                     tip->place[2] - solid->tip[2]);
    wb_pages_cell_number(table, away / WB_MM, 3);
    wb_pages_cell_number(table, tip->largest / WB_MM, 3);
}

static void put_tip_of(struct wb_document_table *table, const char *label,
                       const struct wb_wires_run *run, const struct wb_wires_run *solid)
{
    if (!run)
        return;
    struct tip tip = {.label = label, .angle = run->tip_angle, .largest = (double)NAN};
    memcpy(tip.place, run->tip, sizeof tip.place);
    if (solid && run != solid)
        tip.largest = wb_wires_distance(solid, run);
    put_tip(table, &tip, solid, run == solid);
}

static void put_rod(struct wb_document_table *table, const char *label,
                    const struct wb_wires_rod *rod, const struct wb_wires_run *solid)
{
    const int last = WB_WIRES_POINTS - 1;
    if (!rod->reached)
        return;
    const struct tip tip = {.label = label,
                            .place = {rod->x[last], rod->y[last], 0.0},
                            .angle = rod->tip_angle,
                            .largest = solid ? wb_wires_rod_distance(solid, rod) : (double)NAN};
    put_tip(table, &tip, solid, false);
}

/* --- linear elastic --- */

static void put_stresses(struct wb_document *document, const struct wb_wires_results *results)
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
        const struct wb_wires_stress *const stress = &results->stresses[i];
        const double ratio = stress->core.stress / stress->beam;
        wb_document_row(table, false);
        wb_pages_cell_number(table, stress->x / WB_MM, 2);
        wb_pages_cell_number(table, stress->core.stress / WB_MPA, 1);
        wb_pages_cell_number(table, stress->beam / WB_MPA, 1);
        wb_pages_cell_judged(table, ratio, 4, limit > 0.0, fabs(ratio - 1.0) <= limit);
        wb_pages_cell_number(table, stress->curvature * WB_MM, 6);
        wb_pages_cell_number(table, stress->jacket.stress / WB_MPA, 2);
    }
}

static void put_largest(struct wb_document *document, const struct wb_wires_results *results,
                        const struct wb_wires_run *run)
{
    const struct wb_wires *const comparison = results->comparison;
    const struct wb_wire_model_part *const core =
        &comparison->cases[WB_WIRES_ELASTIC].model->part[0];
    const struct wb_field *const field =
        wb_fields_find(&run->fields, comparison->loaded_state, (double)NAN);
    const struct wb_wire_model *const plastic = comparison->cases[WB_WIRES_ELASTOPLASTIC].model;
    const struct wb_wires_peak peak = wb_wires_find_peak(field, 0);
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
    if (comparison->printed_stress > 0.0 && wb_wires_has_substitutes(comparison))
        wb_text_append(&text,
                       " Its Young's modulus of copper is lost, and the core's was chosen so "
                       "that beam theory gives that stress.");
    wb_pages_put_text(document, WB_BLOCK_PARAGRAPH, WB_TONE_PLAIN, &text);
}

static void put_elastic(struct wb_document *document, const struct wb_wires_results *results,
                        const struct wb_figures *figures)
{
    const struct wb_wires_run *const solid = wb_wires_solid_run(results, WB_WIRES_ELASTIC);
    const struct wb_wires_run *const contact = wb_wires_solid_run(results, WB_WIRES_CONTACT);
    const struct wb_wires_run *const rod = wb_wires_rod_run(results, WB_WIRES_ELASTIC);
    const struct wb_wire_model *const model = results->comparison->cases[WB_WIRES_ELASTIC].model;
    wb_document_heading(document, 1, "elastic", "Linear elastic: solid and rod");
    wb_figures_put(figures, document, "elastic", 0);
    if (solid)
        put_largest(document, results, solid);
    put_stresses(document, results);
    wb_document_heading(document, 2, "elastic-shapes", "Shapes");
    wb_figures_put(figures, document, "elastic-shapes", 0);
    struct wb_document_table *const table = start_tips(
        document, "Tip from 3D: distance of the tips. Largest distance: of points at the same arc "
                  "length. Exact: the elastica under the follower force, which neither shears nor "
                  "stretches.");
    put_tip_of(table, "3D, bonded", solid, solid);
    put_tip_of(table, "3D, friction", contact, solid);
    put_tip_of(table, "1D", rod, solid);
    put_rod(table, "1D, exact", &results->exact, solid);
    struct wb_text text = {0};
    wb_text_append(&text,
                   "The rod's effective Young's modulus is %.2f GPa (eq. 8), its Poisson's ratio "
                   "%.3f (eq. 9).",
                   wb_wire_model_youngs_modulus(model) / (1e3 * WB_MPA),
                   wb_wire_model_poissons_ratio(model));
    if (contact && solid)
        wb_text_append(&text,
                       " Friction (<i>\xce\xbc</i> = %g) instead of a bond moves the axis by %.4f "
                       "mm at most.",
                       results->comparison->cases[WB_WIRES_CONTACT].model->jacket_contact.friction,
                       wb_wires_distance(solid, contact) / WB_MM);
    if (contact && isfinite(contact->slip))
        wb_text_append(&text, " Core and jacket slip by %.4f mm at most.", contact->slip / WB_MM);
    wb_pages_put_text(document, WB_BLOCK_PARAGRAPH, WB_TONE_PLAIN, &text);
}

/* --- elastoplastic --- */

/* Printed properties under which the wire curls up. */
static void append_misprint(struct wb_text *text, const struct wb_wires_results *results,
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
        wb_text_append(text, " The solid with the soft copper of the literature curls up, too: "
                             "either the paper's copper is harder, or its figures show a curl "
                             "that the text does not mention. Without its Table 1 this cannot be "
                             "determined.");
}

/* Limits of a comparison with the paper. */
static void put_curl(struct wb_document *document, const struct wb_wires_results *results,
                     const struct wb_wires_run *solid)
{
    const struct wb_wires *const comparison = results->comparison;
    const struct wb_material *const copper =
        &comparison->cases[WB_WIRES_ELASTOPLASTIC].model->part[0].material;
    struct wb_text text = {0};
    if (wb_wires_has_substitutes(comparison))
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
    wb_pages_put_text(document, WB_BLOCK_NOTICE, WB_TONE_WARNING, &text);
}

/* A property of a material; NULL: it has none. */
static void put_value(struct wb_document_table *table, const struct wb_material *material, int i)
{
    const struct wb_pages_property *const property = &wb_pages_properties[i];
    wb_pages_cell_number(table,
                         material ? wb_pages_value(material, i) / property->factor : (double)NAN,
                         i == 2 ? 1 : property->decimals); /* K is small here */
}

static void put_property(struct wb_document_table *table, const struct wb_wires_results *results,
                         int i)
{
    const struct wb_pages_property *const property = &wb_pages_properties[i];
    const struct wb_wires *const comparison = results->comparison;
    wb_document_row(table, false);
    wb_pages_cell(table, WB_TONE_PLAIN, "%s %s", property->name, property->symbol);
    wb_pages_cell(table, WB_TONE_QUIET, "%s", property->unit);
    put_value(table, results->fit_state == WB_SIMULATION_USABLE ? &results->fit.material : NULL, i);
    put_value(table, comparison->has_printed_wire ? &comparison->printed_wire.material : NULL, i);
}

static void put_fit(struct wb_document *document, const struct wb_wires_results *results,
                    const struct wb_wires_run *solid)
{
    static const struct wb_document_column columns[] = {
        {"Property"},
        {"Unit"},
        {.heading = "Fitted", .right = true},
        {.heading = "Printed", .right = true},
    };
    const struct wb_wires *const comparison = results->comparison;
    char source[400], caption[900];
    wb_document_heading(document, 2, "fit", "Properties of the rod, fitted to the solid");
    if (results->fit_state != WB_SIMULATION_USABLE)
        wb_pages_item(document, WB_TONE_WARNING,
                      "<b>No fit</b>: ", wb_text_string(&results->fit_problem), "", "");
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
        put_property(table, results, i);
    if (results->fit_state != WB_SIMULATION_USABLE)
        return;
    struct wb_text text = {0};
    wb_text_append(&text,
                   "At equal forces the fitted rod's deflection follows the solid's with an RMS "
                   "error of %.2f %% of the largest (%.1f mm)",
                   results->fit.rms / WB_PERCENT, results->fit.max_deflection / WB_MM);
    if (results->fitted.reached)
        wb_text_append(&text, "; at %g N its axis is within %.2f mm of the solid's.", solid->force,
                       wb_wires_rod_distance(solid, &results->fitted) / WB_MM);
    else
        wb_text_append(&text, "; its computation ended at %.1f N.",
                       results->fitted.force[results->fitted.n_curve - 1]);
    if (!wb_calibrate_is_complete(results->fit.end))
        wb_text_append(&text, " The search ended because %s.",
                       wb_calibrate_end_text(results->fit.end));
    const char *remarks[WB_CALIBRATE_MOST_REMARKS];
    const int n = wb_calibrate_remarks(&results->fit, remarks);
    for (int i = 0; i < n; i++) {
        wb_text_append(&text, " Remark: ");
        wb_pages_append_symbols(&text, remarks[i]);
        wb_text_append(&text, ".");
    }
    wb_pages_put_text(document, WB_BLOCK_PARAGRAPH, WB_TONE_PLAIN, &text);
}

static void put_split(struct wb_document *document, const struct wb_wires_results *results)
{
    const struct wb_wire_model *const model =
        results->comparison->cases[WB_WIRES_ELASTOPLASTIC].model;
    const struct wb_wire_model_part *const core = &model->part[0], *const jacket = &model->part[1];
    const double most = wb_wire_model_youngs_modulus(model) *
                        pow(jacket->outer_diameter / core->outer_diameter, 4.0);
    struct wb_text text = {0};
    wb_text_append(
        &text,
        "<b>The split between core and jacket is ill-conditioned.</b> Eq. 8 with "
        "<i>E</i><sub>eff</sub> = %.2f GPa leaves %.0f MPa for the jacket if the core has %.1f "
        "GPa; 1 %% of the core's modulus moves the jacket's by <b>%.0f MPa</b>, "
        "and a core modulus above %.2f GPa leaves none for the jacket.",
        wb_wire_model_youngs_modulus(model) / (1e3 * WB_MPA),
        jacket->material.youngs_modulus / WB_MPA, core->material.youngs_modulus / (1e3 * WB_MPA),
        wb_wires_split(model, 0.01) / WB_MPA, most / (1e3 * WB_MPA));
    wb_pages_put_text(document, WB_BLOCK_PARAGRAPH, WB_TONE_PLAIN, &text);
}

static void put_elastoplastic(struct wb_document *document, const struct wb_wires_results *results,
                              const struct wb_figures *figures)
{
    const struct wb_wires_run *const solid = wb_wires_solid_run(results, WB_WIRES_ELASTOPLASTIC);
    const struct wb_wires_run *const rod = wb_wires_rod_run(results, WB_WIRES_ELASTOPLASTIC);
    wb_document_heading(document, 1, "elastoplastic", "Elastoplastic: solid and rod");
    if (solid)
        put_curl(document, results, solid);
    wb_figures_put(figures, document, "elastoplastic", 0);
    wb_document_heading(document, 2, "elastoplastic-shapes", "Shapes");
    struct wb_document_table *const table = start_tips(document, NULL);
    put_tip_of(table, "3D", solid, solid);
    put_tip_of(table, "1D fibres", rod, solid);
    if (results->fit_state == WB_SIMULATION_USABLE)
        put_rod(table, "1D fitted", &results->fitted, solid);
    put_rod(table, "1D as printed", &results->printed, solid);
    put_fit(document, results, solid);
    put_split(document, results);
}

/* --- residual stresses: pre-loads, residual stress, and its effect under the force --- */

static bool is_zero(const double vector[3])
{
    return vector[0] == 0.0 && vector[1] == 0.0 && vector[2] == 0.0;
}

static void append_vector(struct wb_text *text, const char *what, const double vector[3],
                          const char *unit)
{
    if (!is_zero(vector))
        wb_text_append(text, "%s (%g, %g, %g) %s", what, vector[0], vector[1], vector[2], unit);
}

/* A step by the loads at its end. */
static void append_step(struct wb_text *text, const struct wb_tip_loads *loads)
{
    append_vector(text, " force", loads->force, "N");
    append_vector(text, !is_zero(loads->force) ? " and moment" : " moment", loads->moment, "N m");
    if (loads->follower[1] != 0.0)
        wb_text_append(text, " follower force %g N", loads->follower[1]);
    else if (is_zero(loads->force) && is_zero(loads->moment))
        wb_text_append(text, " no load");
}

static void put_preloads(struct wb_document *document, const struct wb_wires *comparison)
{
    for (int i = 0; i < comparison->n_residual; i++) {
        const struct wb_wires_case *const item = &comparison->cases[WB_WIRES_RESIDUAL + i];
        char label[200];
        struct wb_text text = {0};
        wb_text_append(&text, "<b>%s.</b> At the tip act, step by step:",
                       wb_pages_escape(label, sizeof label, item->label));
        for (int k = 0; k < item->model->n_steps; k++) {
            wb_text_append(&text, "%s", k > 0 ? ";" : "");
            append_step(&text, &item->model->step[k].loads);
        }
        wb_text_append(&text, ".");
        wb_pages_put_text(document, WB_BLOCK_ITEM, WB_TONE_PLAIN, &text);
    }
}

/* Largest and smallest axial stress of the core, Pa. */
static void find_axial(const struct wb_field *field, double range[2])
{
    range[0] = range[1] = (double)NAN;
    for (int i = 0; field && i < field->n_faces; i++) {
        for (int k = 0; k < 8 && field->faces[i].part == 0; k++) {
            range[0] = fmin(range[0], field->faces[i].node[k].axial);
            range[1] = fmax(range[1], field->faces[i].node[k].axial);
        }
    }
}

static void put_residual_row(struct wb_document_table *table,
                             const struct wb_wires_results *results, int index,
                             enum wb_wires_solver solver)
{
    const struct wb_wires *const comparison = results->comparison;
    const struct wb_wires_run *const run = wb_wires_usable(results, index, solver);
    const struct wb_wires_run *const without =
        wb_wires_usable(results, WB_WIRES_ELASTOPLASTIC, solver);
    const struct wb_field *const field =
        wb_wires_field(run, comparison->residual_state, comparison->section);
    double axial[2];
    if (!run)
        return;
    find_axial(field, axial);
    wb_document_row(table, solver == WB_WIRES_SOLID);
    wb_pages_cell_plain(table, WB_TONE_PLAIN, comparison->cases[index].label);
    wb_pages_cell(table, WB_TONE_PLAIN, solver == WB_WIRES_SOLID ? "3D" : "1D fibres");
    wb_pages_cell_number(table, field ? field->x / WB_MM : (double)NAN, 2);
    wb_pages_cell_number(table, axial[1] / WB_MPA, 1);
    wb_pages_cell_number(table, axial[0] / WB_MPA, 1);
    wb_pages_cell_number(table, wb_wires_find_peak(field, 0).stress / WB_MPA, 1);
    wb_pages_cell_number(table, without ? wb_wires_effect(run, without) / WB_MM : (double)NAN, 3);
    wb_pages_cell_number(table, without ? wb_wires_distance(without, run) / WB_MM : (double)NAN, 3);
}

static void put_residual_stresses(struct wb_document *document,
                                  const struct wb_wires_results *results)
{
    static const struct wb_document_column columns[] = {
        {"Case"},
        {"Model"},
        {.heading = "Section at (mm)", .right = true, .wraps = true},
        {.heading = "Axial, largest (MPa)", .right = true, .wraps = true},
        {.heading = "Axial, smallest (MPa)", .right = true, .wraps = true},
        {.heading = "von Mises, largest (MPa)", .right = true, .wraps = true},
        {.heading = "Tip moved, at most (mm)", .right = true, .wraps = true},
        {.heading = "Axis moved at the end (mm)", .right = true, .wraps = true},
    };
    const struct wb_wires *const comparison = results->comparison;
    struct wb_document_table *const table = wb_document_table(
        document,
        "Stresses of the core on the section that is drawn, without load. Moved: distance from "
        "the same model without residual stress, of the tip at any force and of the axis at the "
        "full force.",
        8, columns);
    for (int i = 0; i < comparison->n_residual; i++) {
        for (int k = 0; k < WB_WIRES_SOLVERS; k++)
            put_residual_row(table, results, WB_WIRES_RESIDUAL + i, (enum wb_wires_solver)k);
    }
}

/* The paper's finding beside ours. */
static void put_finding(struct wb_document *document, const struct wb_wires_results *results)
{
    double stress, moved;
    char text[500];
    if (!wb_wires_residual(results, &stress, &moved))
        return;
    snprintf(text, sizeof text,
             "%s pre-loads leave at most <b>%.0f MPa</b> in the solid's core on that section, "
             "and move its tip by at most <b>%.2f mm</b> while the follower force grows.",
             results->comparison->printed_source[0]
                 ? "The paper finds the shapes notably different. Here the"
                 : "The",
             stress / WB_MPA, moved / WB_MM);
    wb_document_paragraph(document, text);
}

static void put_residual(struct wb_document *document, const struct wb_wires_results *results,
                         const struct wb_figures *figures)
{
    const struct wb_wires *const comparison = results->comparison;
    if (comparison->n_residual == 0)
        return;
    wb_document_heading(document, 1, "residual", "Residual stresses");
    wb_document_paragraph(document,
                          "Loads at the tip bend and twist the wire out of the plane and are then "
                          "removed. The follower force is applied to the wire with the residual "
                          "stress that remains. All results are simulated.");
    put_preloads(document, comparison);
    wb_document_heading(document, 2, "residual-stresses", "Residual stress and its effect");
    for (int i = 0; i < comparison->n_residual; i++)
        wb_figures_put(figures, document, "residual", i);
    put_residual_stresses(document, results);
    put_finding(document, results);
    wb_figures_put(figures, document, "residual-effect", 0);
    wb_document_heading(document, 2, "residual-shapes", "Shapes");
    struct wb_document_table *const table = start_tips(document, NULL);
    for (int i = 0; i <= comparison->n_residual; i++) {
        const int index = WB_WIRES_ELASTOPLASTIC + i;
        const char *const name = i == 0 ? "None" : comparison->cases[index].label;
        const struct wb_wires_run *const solid = wb_wires_solid_run(results, index);
        char label[100];
        snprintf(label, sizeof label, "%s, 3D", name);
        put_tip_of(table, label, solid, solid);
        snprintf(label, sizeof label, "%s, 1D fibres", name);
        put_tip_of(table, label, wb_wires_rod_run(results, index), solid);
    }
}

/* --- cost --- */

static void put_simulation(struct wb_document_table *table, const struct wb_wires_results *results,
                           int i, int k)
{
    static const char *const models[] = {"3D solid", "1D rod"};
    const struct wb_wires_run *const run = &results->runs[i][k];
    wb_document_row(table, k == WB_WIRES_SOLID);
    wb_pages_cell_plain(table, WB_TONE_PLAIN,
                        k == WB_WIRES_SOLID ? results->comparison->cases[i].label : "");
    wb_pages_cell(table, WB_TONE_PLAIN, "%s", models[k]);
    wb_pages_cell_number(table, run->elements, 0);
    wb_pages_cell_number(table, run->unknowns, 0);
    wb_pages_cell_number(table, run->iterations, 0);
    wb_pages_cell_number(table, run->simulation.cpu_s,
                         run->simulation.cpu_s < 0.1    ? 3
                         : run->simulation.cpu_s < 10.0 ? 2
                                                        : 0);
    wb_pages_cell_number(table, run->memory_MB, 0);
    if (run->simulation.state == WB_SIMULATION_USABLE)
        wb_pages_cell(table, WB_TONE_GOOD, "converged");
    else
        wb_pages_cell(table, WB_TONE_WARNING, "%s",
                      run->simulation.state == WB_SIMULATION_STALE     ? "outdated"
                      : run->simulation.state == WB_SIMULATION_MISSING ? "missing"
                                                                       : "not used");
    wb_pages_cell_number(
        table, k == WB_WIRES_ROD ? wb_wires_cost(results, i) / WB_PERCENT : (double)NAN, 2);
}

static void put_cost(struct wb_document *document, const struct wb_wires_results *results)
{
    static const struct wb_document_column columns[] = {
        {"Simulation"},
        {"Model"},
        {.heading = "Elements", .right = true},
        {.heading = "Unknowns", .right = true},
        {.heading = "Iterations", .right = true},
        {.heading = "CPU (s)", .right = true},
        {.heading = "Memory (MB)", .right = true, .wraps = true},
        {"State"},
        {.heading = "1D over 3D (%)", .right = true, .wraps = true},
    };
    const struct wb_wires *const comparison = results->comparison;
    wb_document_heading(document, 1, "cost", "Cost");
    struct wb_text caption = {0};
    wb_text_append(&caption, "CPU seconds and memory are those that each simulation stored when it "
                             "was made, on the machine that made it.");
    if (comparison->printed_cost > 0.0)
        wb_text_append(&caption,
                       " The paper: the elastic rod costs below %g %% of the bonded solid.",
                       comparison->printed_cost / WB_PERCENT);
    struct wb_document_table *const table = wb_pages_start_table(document, &caption, 9, columns);
    for (int i = 0; i < comparison->n_cases; i++) {
        for (int k = 0; k < WB_WIRES_SOLVERS; k++) {
            if (results->runs[i][k].simulation.state != WB_SIMULATION_NOT_WANTED)
                put_simulation(table, results, i, k);
        }
    }
}

/* --- provenance --- */

static void put_material(struct wb_document_table *table, const struct wb_wire_model_part *part)
{
    const struct wb_material *const m = &part->material;
    wb_document_row(table, false);
    wb_pages_cell_plain(table, WB_TONE_PLAIN, part->name);
    wb_pages_cell_plain(table, WB_TONE_PLAIN, part->material_name);
    wb_pages_cell_number(table, part->outer_diameter / WB_MM, 2);
    wb_pages_cell_number(table, m->youngs_modulus / WB_MPA, 0);
    wb_pages_cell_number(table, m->poissons_ratio, 2);
    wb_pages_cell_number(table, m->yield_stress / WB_MPA, 1);
    wb_pages_cell_number(table, m->strength_coefficient / WB_MPA, 1);
    wb_pages_cell_number(table, m->hardening_exponent, 2);
    wb_pages_cell(table, part->is_substitute ? WB_TONE_WARNING : WB_TONE_PLAIN, "%s",
                  part->is_substitute ? "substitute" : "given");
}

static void put_materials(struct wb_document *document, const struct wb_wires *comparison)
{
    static const struct wb_document_column columns[] = {
        {"Part"},
        {"Material"},
        {.heading = "Outside (mm)", .right = true},
        {.heading = "<i>E</i> (MPa)", .right = true},
        {.heading = "<i>\xce\xbd</i>", .right = true},
        {.heading = "<i>\xcf\x83</i><sub>Y</sub> (MPa)", .right = true},
        {.heading = "<i>K</i> (MPa)", .right = true},
        {.heading = "<i>n</i>", .right = true},
        {"Values"},
    };
    const struct wb_wire_model *const model = comparison->cases[WB_WIRES_ELASTOPLASTIC].model;
    wb_document_heading(document, 2, "materials", "Materials");
    struct wb_document_table *const table = wb_document_table(
        document,
        wb_wires_has_substitutes(comparison)
            ? "Substitute: stands in for a value of the paper's Table 1, which is lost."
            : NULL,
        9, columns);
    for (int i = 0; i < model->n_parts; i++)
        put_material(table, &model->part[i]);
    for (int i = 0; i < model->n_parts; i++) {
        struct wb_text text = {0};
        wb_text_append(&text, "<b>");
        wb_text_append_escaped(&text, model->part[i].material_name);
        wb_text_append(&text, "</b>: ");
        wb_pages_append_symbols(&text, model->part[i].source);
        wb_pages_put_text(document, WB_BLOCK_ITEM, WB_TONE_PLAIN, &text);
    }
}

static void put_models(struct wb_document *document, const struct wb_wires *comparison)
{
    static const struct wb_document_column columns[] = {
        {"Model"},
        {.heading = "SHA-256 of all inputs of the solid, first 16 digits", .monospace = true}};
    wb_document_heading(document, 2, "models", "Models");
    struct wb_document_table *const table = wb_document_table(document, NULL, 2, columns);
    for (int i = 0; i < comparison->n_cases; i++) {
        const struct wb_wires_case *const item = &comparison->cases[i];
        if (!item->model)
            continue;
        wb_document_row(table, false);
        wb_pages_cell_plain(table, WB_TONE_PLAIN, item->model_name);
        wb_pages_cell_checksum(table, item->datasets[WB_WIRES_SOLID].inputs_sha256);
    }
}

static void put_provenance(struct wb_document *document, const struct wb_wires_results *results)
{
    const struct wb_wires *const comparison = results->comparison;
    wb_pages_put_origin(document, &comparison->head, "datasets");
    put_materials(document, comparison);
    put_models(document, comparison);
    wb_simulation_pages_put_datasets(document, wb_wires_results_list, results);
}

/* --- all of it --- */

void wb_wires_pages_build(struct wb_document *document, const void *context,
                          const struct wb_figures *figures)
{
    const struct wb_wires_results *const results = context;
    wb_simulation_pages_start(document, &results->outcome);
    put_summary(document, results, figures);
    put_elastic(document, results, figures);
    put_elastoplastic(document, results, figures);
    put_residual(document, results, figures);
    put_cost(document, results);
    put_provenance(document, results);
}
