/* The first page of a report of a harness. */
#include <math.h>

#include "analysis/report/found.h"
#include "analysis/report/harnesses/harnesses_kind.h"
#include "analysis/report/pages.h"
#include "base/units.h"

/* --- the sentence --- */

static void append_names(struct wb_text *text, const char *name)
{
    wb_text_append(text, text->length > 0 ? ", " : "");
    wb_text_append_escaped(text, name);
}

/* "step 2 (mount C1)". */
static void append_step(struct wb_text *text, const struct wb_harness_plan *plan, int step)
{
    wb_text_append(text, "step %d (", step + 1);
    wb_text_append_escaped(text, plan->steps[step].name);
    wb_text_append(text, ")");
}

/* With three digits that mean something. */
static void append_value(struct wb_text *text, double value, const char *unit)
{
    wb_text_append(text, "%.*f %s", wb_pages_decimals(value), value, unit);
}

static void append_limits(struct wb_text *text, const struct wb_harness_found *found)
{
    if (found->n_limits == 0)
        wb_text_append(text, "<b>No limits stated</b>");
    else if (found->n_limits == 1)
        wb_text_append(text, "<b>The only limit is %s</b>",
                       found->n_exceeded == 0 ? "kept" : "exceeded");
    else if (found->n_exceeded == 0)
        wb_text_append(text, "<b>All %d limits kept</b>", found->n_limits);
    else
        wb_text_append(text, "<b>%d of %d limits exceeded</b>", found->n_exceeded, found->n_limits);
}

static void append_extremes(struct wb_text *text, const struct wb_harness_plan *plan,
                            const struct wb_harness_found *found)
{
    const struct wb_harness_extreme *const force = &found->force, *const radius = &found->radius;
    wb_text_append(text, "; the largest force on the way is ");
    append_value(text, force->value, "N, on ");
    wb_text_append_escaped(text, plan->items[force->of].name);
    wb_text_append(text, " in ");
    append_step(text, plan, force->step);
    if (!isfinite(radius->value))
        return;
    wb_text_append(text, "; the least bend radius is ");
    append_value(text, radius->value / WB_MM, "mm, in ");
    wb_text_append_escaped(text, plan->branches[radius->of].name);
    wb_text_append(text, " at %.0f mm after ", radius->at / WB_MM);
    append_step(text, plan, radius->step);
}

static void append_residual(struct wb_text *text, const struct wb_harness_plan *plan,
                            const struct wb_harness_found *found)
{
    if (!found->is_taken_off)
        return;
    wb_text_append(text, "; taken off, the harness keeps a residual shape up to ");
    append_value(text, found->residual.value / WB_MM, "mm from the stress-free one, in ");
    wb_text_append_escaped(text, plan->branches[found->residual.of].name);
}

/* Branches that the calibration covers, exceeds, or whose range is not known. */
static void append_range(struct wb_text *text, const struct wb_harnesses_results *results)
{
    const struct wb_harness_plan *const plan = results->campaign->plan;
    struct wb_text beyond = {0};
    int n_unknown = 0;
    for (int i = 0; i < plan->n_branches; i++) {
        n_unknown += !isfinite(plan->wires[plan->branches[i].wire].largest_curvature);
        if (wb_harness_found_is_beyond(&results->set, i))
            append_names(&beyond, plan->branches[i].name);
    }
    if (beyond.length > 0)
        wb_text_append(text, "; curvatures go beyond the calibration in %s",
                       wb_text_string(&beyond));
    else if (n_unknown == plan->n_branches)
        wb_text_append(text, "; the calibrated ranges of curvature are not known");
    else
        wb_text_append(text, "; no curvature goes beyond a calibrated range%s",
                       n_unknown > 0 ? " that is known" : "");
    wb_text_release(&beyond);
}

/* The farthest motion of all snaps, m. */
static double largest_snap(const struct wb_harness_result_set *set)
{
    double largest = 0.0;
    for (int i = 0; i < set->n_steps; i++) {
        for (int k = 0; k < set->results[i].n_snaps; k++)
            largest = fmax(largest, set->results[i].snaps[k].distance);
    }
    return largest;
}

static void append_sentence(struct wb_text *text, const struct wb_harnesses_results *results)
{
    const struct wb_harness_plan *const plan = results->campaign->plan;
    const struct wb_harness_found *const found = &results->found;
    append_limits(text, found);
    append_extremes(text, plan, found);
    append_residual(text, plan, found);
    append_range(text, results);
    if (found->n_snaps == 0)
        wb_text_append(text, "; no snaps.");
    else
        wb_text_append(text, "; %d %s, by at most %.2g mm.", found->n_snaps,
                       wb_pages_plural(found->n_snaps, "snap", "snaps"),
                       largest_snap(&results->set) / WB_MM);
}

/* --- whether to trust it --- */

static void add_incomplete(struct wb_found *found, const struct wb_harness_result_set *set,
                           const char *law)
{
    struct wb_text text = {0};
    const struct wb_harness_step_result *const last = &set->results[set->n_steps - 1];
    if (set->converged)
        return;
    wb_text_append(&text, "<b>Incomplete.</b> The %s computation ends in ", law);
    append_step(&text, set->plan, set->n_steps - 1);
    wb_text_append(&text, ", at %.3g of it", last->fraction);
    if (last->worst_branch >= 0) {
        wb_text_append(&text, ", in branch ");
        wb_text_append_escaped(&text, set->plan->branches[last->worst_branch].name);
    }
    if (last->problem) {
        wb_text_append(&text, ": ");
        wb_text_append_escaped(&text, last->problem);
    }
    wb_text_append(&text, ". Later steps are not computed.");
    wb_found_add(found, WB_FOUND_INCOMPLETE, &text);
}

static void add_exceeded(struct wb_found *found, const char *what, const char *name, double value,
                         double limit, const char *unit, const struct wb_harness_plan *plan,
                         int step)
{
    struct wb_text text = {0};
    wb_text_append(&text, "%s ", what);
    wb_text_append_escaped(&text, name);
    wb_text_append(&text, ": ");
    append_value(&text, value, unit);
    wb_text_append(&text, " in ");
    append_step(&text, plan, step);
    wb_text_append(&text, ", limit ");
    append_value(&text, limit, unit);
    wb_text_append(&text, ".");
    wb_found_add(found, WB_FOUND_FAILED, &text);
}

static void add_limits_of_item(struct wb_found *found, const struct wb_harness_result_set *set,
                               int index)
{
    const struct wb_harness_item *const item = &set->plan->items[index];
    struct wb_harness_extreme force, moment;
    wb_harness_found_largest(set, index, &force, &moment);
    if (item->largest_force > 0.0 && force.value > item->largest_force)
        add_exceeded(found, "Force on", item->name, force.value, item->largest_force, "N",
                     set->plan, force.step);
    if (item->largest_moment > 0.0 && moment.value > item->largest_moment)
        add_exceeded(found, "Moment on", item->name, moment.value / WB_NMM,
                     item->largest_moment / WB_NMM, "N mm", set->plan, moment.step);
}

static void add_limits(struct wb_found *found, const struct wb_harnesses_results *results)
{
    const struct wb_harness_result_set *const set = &results->set;
    const int n_kept = results->found.n_limits - results->found.n_exceeded;
    for (int i = 0; i < set->plan->n_items; i++)
        add_limits_of_item(found, set, i);
    for (int i = 0; i < set->plan->n_branches; i++) {
        const int step = wb_harness_found_exceeds_radius(set, i);
        struct wb_text text = {0};
        if (step < 0)
            continue;
        wb_text_append(&text, "Bend radius of ");
        wb_text_append_escaped(&text, set->plan->branches[i].name);
        wb_text_append(&text, ": below its limit of %.3g mm, first in ",
                       set->plan->branches[i].least_radius / WB_MM);
        append_step(&text, set->plan, step);
        wb_text_append(&text, "; least radius at the end of a step %.3g mm.",
                       wb_harness_found_radius(set, i).value / WB_MM);
        wb_found_add(found, WB_FOUND_FAILED, &text);
    }
    if (results->found.n_limits == 0)
        wb_found_say(found, WB_FOUND_UNCHECKED,
                     "Limits: the harness file states none for forces, moments and radii.");
    else if (n_kept > 0)
        wb_found_say(found, WB_FOUND_PASSED,
                     "%d of %d limits on forces, moments and radii %s kept "
                     "during all steps.",
                     n_kept, results->found.n_limits, wb_pages_plural(n_kept, "is", "are"));
}

static void add_range(struct wb_found *found, const struct wb_harness_result_set *set)
{
    for (int i = 0; i < set->plan->n_branches; i++) {
        const struct wb_harness_plan_branch *const branch = &set->plan->branches[i];
        struct wb_text text = {0};
        if (!wb_harness_found_is_beyond(set, i))
            continue;
        wb_text_append(&text, "Curvature of ");
        wb_text_append_escaped(&text, branch->name);
        wb_text_append(&text, ": up to %.3g 1/m, calibrated to %.3g 1/m: its law is extrapolated.",
                       set->results[set->n_steps - 1].branches[i].largest_bending_so_far,
                       set->plan->wires[branch->wire].largest_curvature);
        wb_found_add(found, WB_FOUND_FAILED, &text);
    }
}

static void add_snaps(struct wb_found *found, const struct wb_harnesses_results *results)
{
    const struct wb_harness_result_set *const set = &results->set;
    struct wb_text text = {0};
    for (int i = 0; i < set->n_steps; i++) {
        if (set->results[i].n_snaps == 0)
            continue;
        wb_text_append(&text, text.length > 0 ? ", " : "Snaps in ");
        append_step(&text, set->plan, i);
    }
    if (text.length > 0)
        wb_text_append(&text, ": the equilibrium became unstable and the harness moved to another; "
                              "that one depends on the motion.");
    wb_found_add(found, WB_FOUND_UNCHECKED, &text);
    if (set->converged && results->found.n_snaps == 0)
        wb_found_say(found, WB_FOUND_PASSED,
                     "All %d steps end at stable equilibria, on paths without a snap.",
                     set->n_steps);
}

/* Items and wires whose numbers rest on assumptions. */
static void add_assumptions(struct wb_found *found, const struct wb_harness_result_set *set)
{
    const struct wb_harness_plan *const plan = set->plan;
    struct wb_text items = {0}, wires = {0};
    bool is_unloaded = false;
    for (int k = 0; k < plan->n_items; k++) {
        bool depends = false;
        for (int i = 0; i < set->n_steps; i++)
            depends |= wb_harness_found_is_twist_sensitive(&set->results[i].forces[k]);
        if (depends)
            append_names(&items, plan->items[k].name);
    }
    for (int i = 0; i < set->n_steps; i++)
        is_unloaded |=
            plan->steps[i].kind == WB_HARNESS_RELEASE || plan->steps[i].kind == WB_HARNESS_TAKE_OFF;
    for (int i = 0; i < plan->n_wires && is_unloaded; i++) {
        if (!plan->wires[i].has_unloading)
            append_names(&wires, plan->wires[i].name);
    }
    if (items.length > 0)
        wb_found_say(found, WB_FOUND_UNCHECKED,
                     "Torsion: forces on %.600s depend on a torsional stiffness that is not "
                     "measured; with a fifth of it they differ by more than 10 %%.",
                     wb_text_string(&items));
    if (wires.length > 0)
        wb_found_say(found, WB_FOUND_UNCHECKED,
                     "Unloading of %.600s: the law was fitted on loading only; the residual shape "
                     "and forces after a release follow from an assumed hardening rule.",
                     wb_text_string(&wires));
    wb_found_say(found, WB_FOUND_UNCHECKED, "Agreement with a harness that was built.");
    if (items.length > 0)
        wb_found_say(found, WB_FOUND_NEXT,
                     "<b>Torsion</b>: measure the torsional stiffness of the wires and state it in "
                     "the harness file (<tt>torsional_stiffness_N_mm2</tt>).");
    if (wires.length > 0)
        wb_found_say(found, WB_FOUND_NEXT,
                     "<b>Unloading</b>: calibrate %.600s on tests with unloading and name the "
                     "properties file in the harness file.",
                     wb_text_string(&wires));
    wb_text_release(&items);
    wb_text_release(&wires);
}

/* --- the page --- */

static void add_origin(struct wb_found *found, const struct wb_harness_plan *plan)
{
    struct wb_text text = {0}, wires = {0};
    wb_text_append(&text, "<b>Simulation.</b> Everything in this report is computed from a harness "
                          "file and the laws of its wires. No harness was built or tested.");
    for (int i = 0; i < plan->n_wires; i++) {
        if (plan->wires[i].is_virtual)
            append_names(&wires, plan->wires[i].name);
    }
    if (wires.length > 0)
        wb_text_append(&text, " Calibrated on a virtual rig, not on real wires: %s.",
                       wb_text_string(&wires));
    wb_text_release(&wires);
    wb_found_add(found, WB_FOUND_ORIGIN, &text);
}

void wb_harnesses_found_put(struct wb_document *document,
                            const struct wb_harnesses_results *results)
{
    struct wb_found found = {0};
    struct wb_text sentence = {0};
    add_origin(&found, results->campaign->plan);
    add_incomplete(&found, &results->set, "elastoplastic");
    add_incomplete(&found, &results->elastic, "elastic");
    append_sentence(&sentence, results);
    wb_found_add(&found, WB_FOUND_RESULT, &sentence);
    add_limits(&found, results);
    add_range(&found, &results->set);
    add_snaps(&found, results);
    if (results->found.n_exceeded > 0)
        wb_found_say(&found, WB_FOUND_NEXT,
                     "<b>Limits</b>: change the lengths, the places or the order of the steps in "
                     "the harness file, and make this report again.");
    add_assumptions(&found, &results->set);
    wb_found_put(&found, document);
}
