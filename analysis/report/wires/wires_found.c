/* The first page of a comparison of wires. */
#include <math.h>

#include "analysis/report/found.h"
#include "analysis/report/simulation_pages.h"
#include "analysis/report/wires/wires_kind.h"
#include "base/units.h"

/* The elastic solid and rod under the full force, and whether an elastic wire is a model at all. */
static void add_elastic(struct wb_found *found, const struct wb_wires_results *results)
{
    const struct wb_wires *const comparison = results->comparison;
    const struct wb_wires_run *const solid = wb_wires_solid_run(results, WB_WIRES_ELASTIC);
    const struct wb_wires_run *const rod = wb_wires_rod_run(results, WB_WIRES_ELASTIC);
    const struct wb_wire_model *const plastic = comparison->cases[WB_WIRES_ELASTOPLASTIC].model;
    struct wb_text text = {0};
    if (!solid || !rod)
        return;
    const double cost = wb_wires_cost(results, WB_WIRES_ELASTIC) / WB_PERCENT;
    wb_text_append(&text,
                   "<b>Linear elastic</b>: at %g N the axes of the 1D rod and the 3D solid are at "
                   "most %.3g mm apart",
                   solid->force, wb_wires_distance(solid, rod) / WB_MM);
    if (isfinite(cost))
        wb_text_append(&text, ", and the rod takes %.3g %% of the solid's CPU time", cost);
    wb_text_append(&text, ".");
    const double stress =
        wb_wires_find_peak(wb_wires_field(solid, comparison->loaded_state, (double)NAN), 0).stress;
    const double yield = plastic->part[0].material.yield_stress;
    if (isfinite(stress) && stress > yield)
        wb_text_append(&text,
                       " The largest stress of the core is %.0f MPa, %.1f times its yield stress: "
                       "a linear elastic model is not valid at this force.",
                       stress / WB_MPA, stress / yield);
    wb_found_add(found, WB_FOUND_RESULT, &text);
}

static void add_elastoplastic(struct wb_found *found, const struct wb_wires_results *results)
{
    const struct wb_wires_run *const solid = wb_wires_solid_run(results, WB_WIRES_ELASTOPLASTIC);
    const struct wb_wires_run *const rod = wb_wires_rod_run(results, WB_WIRES_ELASTOPLASTIC);
    const bool is_fitted = results->fit_state == WB_SIMULATION_USABLE;
    struct wb_text text = {0};
    if (!solid)
        return;
    wb_text_append(&text,
                   "<b>Elastoplastic</b>: at %g N the tip of the 3D solid has turned by %.0f "
                   "degrees",
                   solid->force, solid->tip_angle / WB_DEGREE);
    if (rod)
        wb_text_append(&text,
                       "; the axis of the 1D rod, whose fibres have the materials' own laws, is at "
                       "most %.3g mm away",
                       wb_wires_distance(solid, rod) / WB_MM);
    if (is_fitted && results->fitted.reached)
        wb_text_append(&text, "; that of one homogeneous rod fitted to the solid, %.3g mm",
                       wb_wires_rod_distance(solid, &results->fitted) / WB_MM);
    wb_text_append(&text, ".");
    wb_found_add(found, WB_FOUND_RESULT, &text);
    if (results->printed.done && results->printed.reached)
        wb_found_say(found, WB_FOUND_RESULT,
                     "<b>Printed properties</b>: with them the tip of the 1D rod turns by %.0f "
                     "degrees, %.0f degrees from the solid's.",
                     results->printed.tip_angle / WB_DEGREE,
                     fabs(results->printed.tip_angle - solid->tip_angle) / WB_DEGREE);
}

/* Residual stress of the pre-loads, and its effect on the tip. */
static void add_residual(struct wb_found *found, const struct wb_wires_results *results)
{
    double stress, moved;
    if (wb_wires_residual(results, &stress, &moved))
        wb_found_say(found, WB_FOUND_RESULT,
                     "<b>Residual stress</b>: the pre-loads leave at most %.0f MPa in the core, "
                     "which moves the tip by at most %.3g mm while the force grows.",
                     stress / WB_MPA, moved / WB_MM);
}

static void add_unchecked(struct wb_found *found, const struct wb_wires_results *results)
{
    wb_found_say(found, WB_FOUND_UNCHECKED,
                 "The elastoplastic models: limits of the campaign bound the elastic ones only.");
    if (results->fit_state == WB_SIMULATION_USABLE && !wb_calibrate_is_complete(results->fit.end))
        wb_found_say(found, WB_FOUND_FAILED, "The search for the fitted rod ended because %s.",
                     wb_calibrate_end_text(results->fit.end));
    if (wb_wires_has_substitutes(results->comparison))
        wb_found_say(found, WB_FOUND_UNCHECKED,
                     "Numbers that the paper prints: its Table 1 of materials is lost, and "
                     "substitutes stand in for it.");
    wb_found_say(found, WB_FOUND_UNCHECKED, "Agreement with a tested wire.");
}

static void add_next(struct wb_found *found, const struct wb_wires_results *results)
{
    const bool is_elastic_good = wb_wires_rod_run(results, WB_WIRES_ELASTIC) &&
                                 results->comparison->tip_limit > 0.0 &&
                                 !results->outcome.exceeds_limit;
    if (is_elastic_good)
        wb_found_say(found, WB_FOUND_NEXT,
                     "<b>Model</b>: use the 1D rod for shapes and forces; use the 3D solid for "
                     "stresses of a section, which a homogeneous rod does not have.");
    if (wb_wires_has_substitutes(results->comparison))
        wb_found_say(found, WB_FOUND_NEXT,
                     "<b>Materials</b>: replace the substitutes by materials from tensile tests of "
                     "core and jacket (<tt>wirebench calibrate --tensile</tt>), and solve again.");
    wb_found_say(found, WB_FOUND_NEXT,
                 "<b>Test</b>: calibrate the wire on a bending test before you use its numbers; no "
                 "number of this report is from a test.");
}

void wb_wires_found_put(struct wb_document *document, const struct wb_wires_results *results)
{
    struct wb_found found = {0};
    struct wb_verdict verdicts[WB_WIRES_VERDICTS];
    wb_found_say(&found, WB_FOUND_ORIGIN, "%s",
                 "<b>Simulations.</b> Everything in this report is computed: a wire as a 3D solid "
                 "and as a 1D rod. No wire was tested.");
    wb_simulation_pages_add_missing(&found, &results->outcome);
    add_elastic(&found, results);
    add_elastoplastic(&found, results);
    add_residual(&found, results);
    wb_found_say(&found, WB_FOUND_NOTE, "Computed values have no interval.");
    wb_found_add_verdicts(&found, verdicts, wb_wires_results_judge(results, verdicts));
    add_unchecked(&found, results);
    add_next(&found, results);
    wb_found_put(&found, document);
}
