/* The pages of a report of a harness. */
#include <math.h>
#include <stdio.h>

#include "analysis/harness/harness_bands_output.h"
#include "analysis/report/harnesses/harnesses_kind.h"
#include "analysis/report/pages.h"
#include "base/config.h"
#include "base/units.h"

#define STEP_ROOM 600.0 /* points: the heading, the table and the figures of a step */
#define RESIDUAL_ROOM 330.0
#define WIRES_ROOM 250.0

static const char *const kinds[] = {
    [WB_HARNESS_ROOT] = "root",
    [WB_HARNESS_CONNECTOR] = "connector",
    [WB_HARNESS_CLIP] = "clip",
};

/* --- cells --- */

/* Of a number with three digits that mean something; that of round-off is 0. */
static int decimals(double value)
{
    return fabs(value) < 5e-4 ? 0 : wb_pages_decimals(fabs(value));
}

/* A number with three digits that mean something; less than `least` is round-off and 0. */
static void put_rounded(struct wb_document_table *table, enum wb_document_tone tone, double value,
                        double least)
{
    if (!isfinite(value))
        wb_pages_cell_number(table, (double)NAN, 0);
    else
        wb_pages_cell(table, tone, "%.*f", fabs(value) < least ? 0 : wb_pages_decimals(value),
                      fabs(value) < least ? 0.0 : value);
}

/* A value with its limit in the next cell; 0: none. */
static void put_limited(struct wb_document_table *table, double value, double limit, double unit)
{
    const bool is_limited = limit > 0.0;
    const enum wb_document_tone tone = !is_limited     ? WB_TONE_PLAIN
                                       : value > limit ? WB_TONE_WARNING
                                                       : WB_TONE_GOOD;
    put_rounded(table, tone, value / unit, 5e-4);
    put_rounded(table, WB_TONE_PLAIN, is_limited ? limit / unit : (double)NAN, 0.0);
}

static void append_mark(struct wb_text *marks, const char *mark)
{
    wb_text_append(marks, "%s%s", marks->length > 0 ? ", " : "", mark);
}

/* The marks of a row: what exceeds a limit or depends on an unmeasured stiffness. */
static void put_marks(struct wb_document_table *table, bool force, bool moment, bool twist)
{
    struct wb_text marks = {0};
    if (force)
        append_mark(&marks, "force exceeded");
    if (moment)
        append_mark(&marks, "moment exceeded");
    if (twist)
        append_mark(&marks, "depends on GJ");
    wb_pages_cell(table, force || moment ? WB_TONE_WARNING : WB_TONE_PLAIN, "%s",
                  wb_text_string(&marks));
    wb_text_release(&marks);
}

static void put_step_number(struct wb_document_table *table, double value, int step)
{
    if (value > 0.0)
        wb_pages_cell(table, WB_TONE_PLAIN, "%d", step + 1);
    else
        wb_pages_cell_number(table, (double)NAN, 0);
}

/* --- clips and connectors --- */

static bool is_twist_sensitive(const struct wb_harness_result_set *set, int item)
{
    for (int i = 0; i < set->n_steps; i++) {
        if (wb_harness_found_is_twist_sensitive(&set->results[i].forces[item]))
            return true;
    }
    return false;
}

/* The item of a holder, for its limits; an obstacle has none. */
static const struct wb_harness_item *limits_of(const struct wb_harness_plan *plan, int holder)
{
    static const struct wb_harness_item none = {.branch = -1};
    return holder < plan->n_items ? &plan->items[holder] : &none;
}

/* Step, median and band in a unit, of the step that has the nominal largest value. */
static void put_band(struct wb_document_table *table, const struct wb_fit_band *band,
                     const struct wb_harness_extreme *largest, double unit)
{
    const double high = band->high / unit;
    put_step_number(table, largest->value, largest->step);
    put_rounded(table, WB_TONE_PLAIN, band->median / unit, 5e-4);
    if (isfinite(high))
        wb_pages_cell(table, WB_TONE_PLAIN, "%.*f to %.*f", decimals(high), band->low / unit,
                      decimals(high), high);
    else
        wb_pages_cell_number(table, (double)NAN, 0);
}

static void put_band_table(struct wb_document *document, const struct wb_harness_bands *bands)
{
    static const struct wb_document_column columns[] = {
        {"At"},
        {.heading = "Force in step", .right = true, .wraps = true},
        {.heading = "Median (N)", .right = true, .wraps = true},
        {.heading = "95 % band (N)", .right = true, .wraps = true},
        {.heading = "Moment in step", .right = true, .wraps = true},
        {.heading = "Median (N\xc2\xa0mm)", .right = true, .wraps = true},
        {.heading = "95 % band (N\xc2\xa0mm)", .right = true, .wraps = true},
    };
    struct wb_document_table *const table = wb_document_table(
        document, "Largest force and moment during the steps that have the largest ones above.",
        WB_COUNT(columns), columns);
    for (int i = 0; i < bands->nominal->plan->n_items; i++) {
        struct wb_harness_extreme force, moment;
        wb_harness_found_largest(bands->nominal, i, &force, &moment);
        wb_pages_row(table, false, bands->nominal->plan->items[i].name);
        put_band(table, &bands->steps[force.step].forces[i].largest_force, &force, 1.0);
        put_band(table, &bands->steps[moment.step].forces[i].largest_moment, &moment, WB_NMM);
    }
}

/* What the bands are of, and which runs deviate. */
static void put_bands(struct wb_document *document, const struct wb_harness_bands *bands)
{
    const struct wb_harness_plan *const plan = bands->nominal->plan;
    struct wb_text drawn = {0}, deviants = {0}, text = {0};
    for (int i = 0; i < plan->n_wires; i++)
        if (wb_harness_bands_is_drawn(&plan->wires[i]))
            wb_text_append(&drawn, "%s%s (%d)", drawn.length > 0 ? ", " : "", plan->wires[i].name,
                           plan->wires[i].specimens.n);
    wb_pages_put(
        document, WB_BLOCK_PARAGRAPH, WB_TONE_PLAIN,
        "Bands: %g %% of %d runs, from the scatter of the specimens of %s. Other wires are "
        "taken as exact.",
        WB_HARNESS_BANDS_CONFIDENCE / WB_PERCENT, bands->settings.runs, wb_text_string(&drawn));
    put_band_table(document, bands);
    wb_harness_bands_output_append_deviants(&deviants, bands);
    if (deviants.length > 0) {
        wb_text_append(&text, "Bands: ");
        wb_text_append_escaped(&text, wb_text_string(&deviants));
        wb_text_append(&text, ".");
        wb_pages_put_text(document, WB_BLOCK_PARAGRAPH, WB_TONE_WARNING, &text);
    }
    wb_text_release(&drawn);
    wb_text_release(&deviants);
}

static void put_items(struct wb_document *document, const struct wb_harnesses_results *results)
{
    static const struct wb_document_column columns[] = {
        {"At"},
        {"Kind"},
        {.heading = "Largest force (N)", .right = true, .wraps = true},
        {.heading = "in step", .right = true, .wraps = true},
        {.heading = "Limit (N)", .right = true, .wraps = true},
        {.heading = "Elastic (N)", .right = true, .wraps = true},
        {.heading = "Elastic over it", .right = true, .wraps = true},
        {.heading = "Largest moment (N\xc2\xa0mm)", .right = true, .wraps = true},
        {.heading = "in step", .right = true, .wraps = true},
        {.heading = "Limit (N\xc2\xa0mm)", .right = true, .wraps = true},
        {.heading = "Marks", .wraps = true},
    };
    const struct wb_harness_result_set *const set = &results->set;
    wb_document_heading(document, 1, "items",
                        set->plan->n_obstacles > 0 ? "Clips, connectors and obstacles"
                                                   : "Clips and connectors");
    struct wb_document_table *const table = wb_document_table(
        document,
        "Largest force and moment on the wire during all steps, and the largest force of the same "
        "steps with elastic wires. Forces that depend on GJ differ by more than 10 % with a fifth "
        "of a torsional stiffness that is not measured.",
        WB_COUNT(columns), columns);
    for (int i = 0; i < wb_harness_file_n_holders(set->plan); i++) {
        const struct wb_harness_item *const item = limits_of(set->plan, i);
        const double elastic = wb_harnesses_elastic_largest(results, i);
        struct wb_harness_extreme force, moment;
        wb_harness_found_largest(set, i, &force, &moment);
        wb_pages_row(table, false, wb_harness_file_holder(set->plan, i));
        wb_pages_cell_plain(table, WB_TONE_PLAIN,
                            i < set->plan->n_items ? kinds[item->kind] : "obstacle");
        put_rounded(table,
                    item->largest_force > 0.0 && force.value > item->largest_force ? WB_TONE_WARNING
                                                                                   : WB_TONE_PLAIN,
                    force.value, 5e-4);
        put_step_number(table, force.value, force.step);
        put_rounded(table, WB_TONE_PLAIN,
                    item->largest_force > 0.0 ? item->largest_force : (double)NAN, 0.0);
        put_rounded(table, WB_TONE_PLAIN, elastic, 5e-4);
        wb_pages_cell_number(table, force.value > 0.0 ? elastic / force.value : (double)NAN, 2);
        put_rounded(table,
                    item->largest_moment > 0.0 && moment.value > item->largest_moment
                        ? WB_TONE_WARNING
                        : WB_TONE_PLAIN,
                    moment.value / WB_NMM, 5e-4);
        put_step_number(table, moment.value, moment.step);
        put_rounded(table, WB_TONE_PLAIN,
                    item->largest_moment > 0.0 ? item->largest_moment / WB_NMM : (double)NAN, 0.0);
        put_marks(table, item->largest_force > 0.0 && force.value > item->largest_force,
                  item->largest_moment > 0.0 && moment.value > item->largest_moment,
                  is_twist_sensitive(set, i));
    }
    if (results->bands)
        put_bands(document, results->bands);
}

/* --- branches --- */

static void put_branches(struct wb_document *document, const struct wb_harnesses_results *results,
                         const struct wb_figures *figures)
{
    static const struct wb_document_column columns[] = {
        {"Branch"},
        {"Wire"},
        {.heading = "Length (mm)", .right = true, .wraps = true},
        {.heading = "Least radius (mm)", .right = true, .wraps = true},
        {.heading = "at (mm)", .right = true},
        {.heading = "after step", .right = true, .wraps = true},
        {.heading = "Limit (mm)", .right = true, .wraps = true},
        {.heading = "Bent to (1/m)", .right = true},
        {.heading = "Calibrated (1/m)", .right = true},
        {.heading = "Marks", .wraps = true},
    };
    const struct wb_harness_result_set *const set = &results->set;
    wb_document_heading(document, 1, "branches", "Curvature and bend radius");
    struct wb_document_table *const table = wb_document_table(
        document,
        "Least bend radius at the end of a step; its limit is checked during the steps, too. "
        "Bent to: largest curvature relative to the natural shape, during all steps. Calibrated: "
        "largest curvature of the tests that the law was fitted to.",
        WB_COUNT(columns), columns);
    for (int i = 0; i < set->plan->n_branches; i++) {
        const struct wb_harness_plan_branch *const branch = &set->plan->branches[i];
        const struct wb_harness_wire *const wire = &set->plan->wires[branch->wire];
        const struct wb_harness_extreme radius = wb_harness_found_radius(set, i);
        const int exceeded = wb_harness_found_exceeds_radius(set, i);
        const bool is_beyond = wb_harness_found_is_beyond(set, i), is_bent = isfinite(radius.value);
        char mark[80] = "";
        if (exceeded >= 0)
            snprintf(mark, sizeof mark, "radius below limit in step %d%s", exceeded + 1,
                     is_beyond ? ", beyond calibration" : "");
        else if (is_beyond)
            snprintf(mark, sizeof mark, "beyond calibration");
        wb_pages_row(table, false, branch->name);
        wb_pages_cell_plain(table, WB_TONE_PLAIN, wire->name);
        wb_pages_cell(table, WB_TONE_PLAIN, "%.4g", branch->length / WB_MM);
        put_rounded(table, exceeded >= 0 ? WB_TONE_WARNING : WB_TONE_PLAIN,
                    is_bent ? radius.value / WB_MM : (double)NAN, 0.0);
        wb_pages_cell_number(table, is_bent ? radius.at / WB_MM : (double)NAN, 0);
        put_step_number(table, is_bent ? 1.0 : 0.0, radius.step);
        put_rounded(table, WB_TONE_PLAIN,
                    branch->least_radius > 0.0 ? branch->least_radius / WB_MM : (double)NAN, 0.0);
        put_rounded(table, is_beyond ? WB_TONE_WARNING : WB_TONE_PLAIN,
                    set->results[set->n_steps - 1].branches[i].largest_bending_so_far, 5e-4);
        put_rounded(table, WB_TONE_PLAIN, wire->largest_curvature, 0.0);
        wb_pages_cell(table, mark[0] ? WB_TONE_WARNING : WB_TONE_PLAIN, "%s", mark);
    }
    for (int i = 0; i < set->plan->n_branches; i++)
        wb_figures_put(figures, document, "branch", i);
}

/* --- steps --- */

static void put_forces(struct wb_document *document, const struct wb_harnesses_results *results,
                       int step)
{
    static const struct wb_document_column columns[] = {
        {"At"},
        {.heading = "Force (N)", .right = true, .wraps = true},
        {.heading = "along, across, up (N)", .right = true},
        {.heading = "Elastic (N)", .right = true, .wraps = true},
        {.heading = "Largest (N)", .right = true, .wraps = true},
        {.heading = "Limit (N)", .right = true, .wraps = true},
        {.heading = "Moment (N\xc2\xa0mm)", .right = true, .wraps = true},
        {.heading = "Largest (N\xc2\xa0mm)", .right = true, .wraps = true},
        {.heading = "Limit (N\xc2\xa0mm)", .right = true, .wraps = true},
        {.heading = "Marks", .wraps = true},
    };
    const struct wb_harness_plan *const plan = results->campaign->plan;
    struct wb_document_table *const table = wb_document_table(
        document,
        "Forces and moments on the wire at the end of the step, in the frame of the section there; "
        "the largest ones during the step; and the force with elastic wires.",
        WB_COUNT(columns), columns);
    for (int i = 0; i < wb_harness_file_n_holders(plan); i++) {
        const struct wb_harness_item *const item = limits_of(plan, i);
        const struct wb_harness_force *const f = &results->set.results[step].forces[i];
        struct wb_text parts = {0};
        if (!f->is_mounted)
            continue;
        for (int k = 0; k < 3; k++) {
            wb_text_append(&parts, k > 0 ? ", " : "");
            wb_pages_append_number(&parts, f->force[k], decimals(f->size));
        }
        wb_pages_row(table, false, wb_harness_file_holder(plan, i));
        put_rounded(table, WB_TONE_PLAIN, f->size, 5e-4);
        wb_pages_cell(table, WB_TONE_PLAIN, "%s", wb_text_string(&parts));
        wb_text_release(&parts);
        put_rounded(table, WB_TONE_PLAIN, wb_harnesses_elastic_force(results, step, i), 5e-4);
        put_limited(table, f->largest, item->largest_force, 1.0);
        put_rounded(table, WB_TONE_PLAIN, f->moment_size / WB_NMM, 5e-4);
        put_limited(table, f->largest_moment, item->largest_moment, WB_NMM);
        put_marks(table, f->exceeds_force, f->exceeds_moment,
                  wb_harness_found_is_twist_sensitive(f));
    }
}

/* How many, where in the step, and the farthest motion. */
static void append_snaps(struct wb_text *text, const struct wb_harness_plan *plan,
                         const struct wb_harness_step_result *step)
{
    int farthest = 0;
    if (step->n_snaps == 0)
        return;
    for (int i = 1; i < step->n_snaps; i++)
        farthest = step->snaps[i].distance > step->snaps[farthest].distance ? i : farthest;
    const double distance = step->snaps[farthest].distance / WB_MM;
    const int branch = step->snap_branch[farthest];
    wb_text_append(text, " %d %s, the first at %.3g of the step; in the farthest motion ",
                   step->n_snaps, wb_pages_plural(step->n_snaps, "snap", "snaps"),
                   step->snaps[0].fraction);
    wb_text_append_escaped(text, branch < 0 ? "the root" : plan->branches[branch].name);
    wb_text_append(text, " moves by %.*f mm.", decimals(distance), distance);
}

/* Length of wire that slid through each clip that lets it slide. */
static void append_slid(struct wb_text *text, const struct wb_harness_plan *plan,
                        const struct wb_harness_step_result *step)
{
    for (int i = 0; i < plan->n_items; i++) {
        const double slid = step->forces[i].slid / WB_MM;
        if (!step->forces[i].is_mounted || !isfinite(slid))
            continue;
        wb_text_append(text, " Since its mount %.*f mm of wire slid through ", decimals(slid),
                       fabs(slid));
        wb_text_append_escaped(text, plan->items[i].name);
        wb_text_append(text, " towards the %s of ", slid > 0.0 ? "beginning" : "end");
        wb_text_append_escaped(text, plan->branches[plan->items[i].branch].name);
        wb_text_append(text, ".");
    }
}

static void put_summary(struct wb_document *document, const struct wb_harness_result_set *set,
                        int index)
{
    const struct wb_harness_step_result *const step = &set->results[index];
    struct wb_text text = {0};
    if (step->end == WB_HARNESS_CONVERGED)
        wb_text_append(&text, "A stable equilibrium after %d %s.", step->increments,
                       wb_pages_plural(step->increments, "increment", "increments"));
    else
        wb_text_append(&text, "<b>Not completed</b>: it ends at %.3g of the step.", step->fraction);
    wb_text_append(&text,
                   " Elastic energy of the wires %.*f mJ; plastic work from the first step on "
                   "%.*f mJ.",
                   decimals(step->elastic / WB_MJ), fabs(step->elastic) / WB_MJ,
                   decimals(step->plastic / WB_MJ), step->plastic / WB_MJ);
    append_snaps(&text, set->plan, step);
    append_slid(&text, set->plan, step);
    wb_pages_put_text(document, WB_BLOCK_PARAGRAPH, WB_TONE_PLAIN, &text);
}

static void put_steps(struct wb_document *document, const struct wb_harnesses_results *results,
                      const struct wb_figures *figures)
{
    wb_document_need_room(document, STEP_ROOM);
    wb_document_heading(document, 1, "steps", "Steps");
    for (int i = 0; i < results->set.n_steps; i++) {
        char anchor[32], heading[140];
        snprintf(anchor, sizeof anchor, "step-%d", i + 1);
        snprintf(heading, sizeof heading, "Step %d: %s", i + 1,
                 results->campaign->plan->steps[i].name);
        if (i > 0)
            wb_document_need_room(document, STEP_ROOM);
        wb_document_heading(document, 2, anchor, heading);
        put_summary(document, &results->set, i);
        put_forces(document, results, i);
        wb_figures_put(figures, document, "step", i);
    }
}

/* --- residual shape --- */

static void put_residual(struct wb_document *document, const struct wb_harnesses_results *results,
                         const struct wb_figures *figures)
{
    const struct wb_harness_found *const found = &results->found;
    char branch[200];
    if (!found->is_taken_off)
        return;
    wb_document_need_room(document, RESIDUAL_ROOM);
    wb_document_heading(document, 1, "residual", "Residual shape");
    wb_pages_escape(branch, sizeof branch,
                    results->campaign->plan->branches[found->residual.of].name);
    wb_pages_put(document, WB_BLOCK_PARAGRAPH, WB_TONE_PLAIN,
                 "Taken off, the harness keeps a shape whose largest distance from the stress-free "
                 "shape before is %.*f mm, in %s at %.0f mm.",
                 decimals(found->residual.value / WB_MM), found->residual.value / WB_MM, branch,
                 found->residual.at / WB_MM);
    wb_figures_put(figures, document, "residual", 0);
}

/* --- wires --- */

static void put_wire_files(struct wb_document *document, const struct wb_harness_plan *plan)
{
    static const struct wb_document_column columns[] = {
        {"Wire"},
        {.heading = "File", .wraps = true},
        {.heading = "SHA-256, first 16 digits", .monospace = true},
        {.heading = "Fitted on", .wraps = true},
        {.heading = "Source", .wraps = true},
    };
    struct wb_document_table *const table = wb_document_table(
        document, "The files of the wires. All 64 digits of a checksum are in report.json.",
        WB_COUNT(columns), columns);
    for (int i = 0; i < plan->n_wires; i++) {
        const struct wb_harness_wire *const wire = &plan->wires[i];
        wb_pages_row(table, false, wire->name);
        wb_pages_cell_plain(table, WB_TONE_PLAIN, wire->file);
        wb_pages_cell_checksum(table, wire->sha256);
        wb_pages_cell_plain(table, WB_TONE_PLAIN,
                            wire->has_unloading ? "loading and unloading" : "loading only");
        wb_pages_cell_plain(table, WB_TONE_PLAIN,
                            wire->is_virtual ? "virtual rig" : "as its file says");
    }
}

static void put_wires(struct wb_document *document, const struct wb_harness_result_set *set)
{
    static const struct wb_document_column columns[] = {
        {"Wire"},
        {.heading = "Outer diameter (mm)", .right = true, .wraps = true},
        {.heading = "Mass (g/m)", .right = true},
        {.heading = "<i>EI</i> (N\xc2\xa0mm\xc2\xb2)", .right = true},
        {.heading = "GJ (N\xc2\xa0mm\xc2\xb2)", .right = true},
        {"GJ from"},
        {.heading = "Calibrated (1/m)", .right = true},
    };
    const struct wb_harness_plan *const plan = set->plan;
    wb_document_need_room(document, WIRES_ROOM);
    wb_document_heading(document, 1, "wires", "Wires");
    put_wire_files(document, plan);
    struct wb_document_table *const table = wb_document_table(
        document,
        "<i>EI</i>: of the law at zero curvature. GJ: torsional stiffness, of the harness file, or "
        "by default <i>EI</i> / (1 + Poisson's ratio), which no test supports.",
        WB_COUNT(columns), columns);
    for (int i = 0; i < plan->n_wires; i++) {
        const struct wb_harness_wire *const wire = &plan->wires[i];
        wb_pages_row(table, false, wire->name);
        wb_pages_cell_number(table, wire->diameter / WB_MM, 2);
        wb_pages_cell_rounded(table, wire->mass / WB_G);
        wb_pages_cell_rounded(table, wire->law.material.youngs_modulus * M_PI *
                                         pow(wire->diameter, 4.0) / 64.0 / WB_NMM2);
        wb_pages_cell_rounded(table, wb_harness_run_torsion(plan, i, &set->settings) / WB_NMM2);
        wb_pages_cell_plain(table, WB_TONE_PLAIN,
                            wire->torsional_stiffness > 0.0 ? "harness file" : "default");
        put_rounded(table, WB_TONE_PLAIN, wire->largest_curvature, 0.0);
    }
    for (int i = 0; i < plan->n_wires; i++) {
        struct wb_text law = {0}, text = {0};
        wb_law_append_numbers(&law, &plan->wires[i].law);
        wb_text_append(&text, "Law of ");
        wb_text_append_escaped(&text, plan->wires[i].name);
        wb_text_append(&text, ": ");
        wb_pages_append_symbols(&text, wb_text_string(&law));
        wb_text_append(&text, "%s.", plan->wires[i].is_virtual ? " (virtual rig)" : "");
        wb_text_release(&law);
        wb_pages_put_text(document, WB_BLOCK_ITEM, WB_TONE_PLAIN, &text);
    }
}

static void put_file(struct wb_document *document, const struct wb_harnesses *campaign)
{
    char name[600], title[400];
    const struct wb_harness_plan *const plan = campaign->plan;
    wb_pages_put(document, WB_BLOCK_PARAGRAPH, WB_TONE_PLAIN,
                 "Harness file <tt>%s</tt>, SHA-256 <tt>%s</tt>%s%s.",
                 wb_pages_escape(name, sizeof name, campaign->file), plan->sha256,
                 plan->title[0] ? ": " : "", wb_pages_escape(title, sizeof title, plan->title));
}

void wb_harnesses_pages(struct wb_document *document, const void *context,
                        const struct wb_figures *figures)
{
    const struct wb_harnesses_results *const results = context;
    const struct wb_harness_result_set *const set = &results->set;
    char subtitle[300];
    snprintf(subtitle, sizeof subtitle, "%s: %d %s, %d %s", set->plan->name, set->plan->n_branches,
             wb_pages_plural(set->plan->n_branches, "branch", "branches"), set->plan->n_steps,
             wb_pages_plural(set->plan->n_steps, "step", "steps"));
    wb_pages_start(document, "Simulation report", &results->campaign->head, subtitle,
                   "simulations, no tests", "");
    wb_harnesses_found_put(document, results);
    wb_figures_put(figures, document, "found", 0);
    put_items(document, results);
    put_residual(document, results, figures);
    put_branches(document, results, figures);
    put_steps(document, results, figures);
    put_wires(document, set);
    wb_pages_put_origin(document, &results->campaign->head, "files");
    put_file(document, results->campaign);
}
