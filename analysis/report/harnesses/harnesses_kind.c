#include "analysis/report/harnesses/harnesses_kind.h"

#include <math.h>

#include "analysis/harness/harness_output.h"
#include "analysis/keys/row.h"
#include "analysis/report/numbers.h"
#include "base/units.h"

/* --- numbers --- */

#define FOUND(member) WB_AT(struct wb_harness_found, member)

static const struct wb_key found_rows[] = {
    {"limits", FOUND(n_limits), "limits of forces, moments and radii that the harness file states"},
    {"limits_exceeded", FOUND(n_exceeded), "how many of them are exceeded during the steps"},
    {"largest_force_N", FOUND(force.value), "largest force during the steps"},
    {"largest_force_on", TEXT, "the root, connector or clip that it acts on"},
    {"largest_force_step", TEXT, "the step"},
    {"least_radius_mm", FOUND(radius.value) | UNKNOWN,
     "least bend radius at the end of a step; null: straight"},
    {"least_radius_branch", TEXT, "its branch"},
    {"least_radius_at_mm", FOUND(radius.at), "its place on the branch"},
    {"least_radius_step", TEXT, "the step"},
    {"branches_beyond_calibration", FOUND(n_beyond),
     "branches with curvatures beyond the calibration of their wire"},
    {"snaps", FOUND(n_snaps), "snaps in all steps"},
    {"items_that_depend_on_torsion", FOUND(n_twist),
     "items with a force that depends on a torsional stiffness that is not measured"},
};
static WB_KEYS(found, "harness_found", "The findings of a report of a harness.");

static const struct wb_key wb_harnesses_kind_rows[] = {
    {.of = &wb_numbers_head_keys},
    {"file", WB_AT(struct wb_harnesses, file), "the harness file, as given"},
    {"found", OBJECT, "findings of the elastoplastic computation", &found_keys},
    {"harness", OBJECT, "the computation with the laws of the wires",
     &wb_harness_output_result_keys},
    {"elastic", OBJECT, "the same computation without yielding", &wb_harness_output_result_keys},
};
WB_KEYS(wb_harnesses_kind, "report_of_harness", "The report of a harness.");

static void put_found(struct wb_json *root, const struct wb_harnesses_results *results)
{
    const struct wb_harness_plan *const plan = results->campaign->plan;
    const struct wb_harness_found *const found = &results->found;
    struct wb_json *const object = wb_json_set_object(root, "found");
    WB_PUT(object, &found_keys, struct wb_harness_found, found);
    wb_json_set_text(object, "largest_force_on", plan->items[found->force.of].name);
    wb_json_set_text(object, "largest_force_step", plan->steps[found->force.step].name);
    WB_PUT(object, &found_keys, struct wb_harness_found, found);
    wb_json_set_text(object, "least_radius_branch", plan->branches[found->radius.of].name);
    WB_PUT(object, &found_keys, struct wb_harness_found, found);
    wb_json_set_text(object, "least_radius_step", plan->steps[found->radius.step].name);
    WB_PUT(object, &found_keys, struct wb_harness_found, found);
}

static struct wb_json *build_json(const void *context)
{
    const struct wb_harnesses_results *const results = context;
    struct wb_json *const root =
        wb_numbers_create(&results->campaign->head, "simulation", &results->outcome);
    WB_PUT(root, &wb_harnesses_kind_keys, struct wb_harnesses, results->campaign);
    put_found(root, results);
    wb_harness_output_put_result(wb_json_set_object(root, "harness"), &results->set,
                                 results->bands);
    wb_harness_output_put_result(wb_json_set_object(root, "elastic"), &results->elastic, NULL);
    return root;
}

static void print(FILE *out, const void *context)
{
    const struct wb_harnesses_results *const results = context;
    struct wb_text text = {0};
    fprintf(out, "%s (simulation)\n\n", results->campaign->head.title);
    wb_harness_output_append_finding(&text, &results->set);
    wb_text_append(&text, "\n");
    wb_harness_output_append_finding(&text, &results->elastic);
    if (results->found.n_limits > 0)
        wb_text_append(&text, "\n%d of %d limits exceeded", results->found.n_exceeded,
                       results->found.n_limits);
    fprintf(out, "%s\n", wb_text_string(&text));
    wb_text_release(&text);
}

const struct wb_kind wb_harnesses_kind = {
    .name = "harness",
    .data = "harness files",
    .campaign_size = sizeof(struct wb_harnesses),
    .results_size = sizeof(struct wb_harnesses_results),
    .keys = wb_harnesses_keys,
    .load = wb_harnesses_load,
    .compute = wb_harnesses_compute,
    .figures = wb_harnesses_figures,
    .n_figures = WB_HARNESSES_FIGURES,
    .pages = wb_harnesses_pages,
    .json = build_json,
    .print = print,
    .release = wb_harnesses_release_results,
    .release_campaign = wb_harnesses_release,
};
