/* Reports of a harness: reading, both computations, the pages, and what a report says of a result
 * that is not complete. */
#include "tests/analysis/report/report_folder.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

#include "analysis/report/harnesses/harnesses_kind.h"
#include "base/json.h"
#include "base/units.h"
#include "tests/analysis/harness/harness_text.h"

static struct wb_harnesses campaign;
static struct wb_harnesses_results results;

static int set_up(void **state)
{
    keep_messages();
    return make_folder(state);
}

static int tear_down(void **state)
{
    wb_harnesses_release_results(&results);
    wb_harnesses_release(&campaign);
    return remove_folder(state);
}

#define HEAD "kind: harness\ntitle: A <trunk> & leads\nnotes: a note\n"

/* The harness of harness_text.h with limits, one of which is exceeded, and a range of curvature. */
static void write_own_harness(void)
{
    write_harness(in_folder("h.yaml"), 15,
                  "  - {name: C1, branch: B1, at_mm: 200, holds: axis, most_force_N: 0.1, "
                  "most_moment_N_mm: 1e6}");
}

/* Computed once for all facts. */
static const struct wb_harnesses_results *whole_report(void)
{
    if (results.campaign)
        return &results;
    write_own_harness();
    assert_int_equal(wb_kind_read(&wb_harnesses_kind, &campaign,
                                  write_text("c.yaml", HEAD "harness: ./h.yaml\n")),
                     WB_OK);
    assert_string_equal(campaign.file, "h.yaml");
    assert_int_equal(wb_harnesses_load(&results, &campaign), WB_OK);
    assert_int_equal(wb_harnesses_compute(&results, 0, NULL, NULL), WB_OK);
    return &results;
}

static void write_report(void)
{
    assert_int_equal(
        wb_kind_write(&wb_harnesses_kind, whole_report(), in_folder("report"), true, 0), WB_OK);
}

/* --- reading --- */

static void invalid_file_is_rejected_with_its_line(void **state)
{
    (void)state;
    static const struct refused_campaign wrong[] = {
        {HEAD, "c.yaml:1: harness: this key is missing"},
        {"kind: harness\nharness: small\n", "c.yaml:1: title: this key is missing"},
        {HEAD "harness: none\n", "c.yaml:4: harness: no 'none' among the shipped harnesses"},
        {HEAD "harness: ./none.yaml\n", "c.yaml:4: harness: "},
        {HEAD "harness: [small]\n", "c.yaml:4: harness: expected a text"},
        {HEAD "harness: small\nrun: 3\n", "c.yaml:5: run: unknown key"},
        {HEAD "harness: small\nharness: door\n", "c.yaml:5: "},
        {HEAD "harness: {\n", "c.yaml:5: "},
        {HEAD "harness: small\nlaboratory: {report: 1, issued: yesterday}\n", "c.yaml:5: issued"},
    };
    assert_refused(&wb_harnesses_kind, &campaign, wrong, sizeof wrong / sizeof wrong[0]);
}

static void damaged_harness_file_is_rejected_with_its_own_line(void **state)
{
    (void)state;
    const char *const text = HEAD "harness: ./damaged.yaml\n";
    write_harness(in_folder("damaged.yaml"), 8,
                  "  - {name: B1, from: R, to: J, wire: cable, length_mm: 3}");
    assert_true(wb_kind_read(&wb_harnesses_kind, &campaign, write_text("c.yaml", text)) != WB_OK);
    assert_non_null(strstr(kept.error, "damaged.yaml:8: wire"));
    write_harness(in_folder("damaged.yaml"), 16, "steps: {");
    assert_true(wb_kind_read(&wb_harnesses_kind, &campaign, write_text("c.yaml", text)) != WB_OK);
    assert_non_null(strstr(kept.error, "damaged.yaml:17: "));
    /* Of another kind: the campaign itself. */
    assert_true(wb_kind_read(&wb_harnesses_kind, &campaign,
                             write_text("c.yaml", HEAD "harness: ./c.yaml\n")) != WB_OK);
    assert_non_null(strstr(kept.error, "c.yaml:"));
}

static void shipped_harness_is_named_from_fixtures_on(void **state)
{
    (void)state;
    static struct wb_harnesses shipped;
    assert_int_equal(
        wb_kind_read(&wb_harnesses_kind, &shipped, write_text("c.yaml", HEAD "harness: small\n")),
        WB_OK);
    assert_string_equal(shipped.file, "fixtures/harnesses/small.yaml");
    assert_int_equal(shipped.plan->n_steps, 7);
    wb_harnesses_release(&shipped);
}

/* --- results --- */

static void elastic_computation_stands_beside_that_with_the_laws(void **state)
{
    (void)state;
    const struct wb_harnesses_results *const r = whole_report();
    assert_true(r->outcome.is_complete && r->outcome.exceeds_limit && !r->outcome.interrupted);
    assert_true(r->elastic.settings.is_elastic && !r->set.settings.is_elastic);
    assert_true(r->found.residual.value > 1e-3);
    struct wb_harness_found elastic;
    wb_harness_found_collect(&elastic, &r->elastic);
    assert_true(elastic.residual.value == 0.0);
    /* The clip; free items have no force. */
    assert_true(wb_harnesses_elastic_force(r, 1, 3) == r->elastic.results[1].forces[3].size);
    assert_true(wb_harnesses_elastic_force(r, 1, 3) > 1.2 * r->set.results[1].forces[3].size);
    assert_true(isnan(wb_harnesses_elastic_force(r, 0, 3)));
    assert_true(wb_harnesses_elastic_largest(r, 3) >= wb_harnesses_elastic_force(r, 1, 3));
}

/* Another build has other digits there. */
static void round_off_is_zero(void **state)
{
    (void)state;
    const struct wb_harnesses_results *const r = whole_report();
    const struct wb_harness_step_result *const off = &r->set.results[4];
    assert_true(off->forces[0].size == 0.0 && off->forces[0].moment_size == 0.0);
    assert_true(off->elastic == 0.0);
    assert_true(off->plastic > 0.0 && off->forces[0].largest > 0.0);
    for (int i = 0; i < campaign.plan->n_branches; i++) {
        assert_true(isinf(r->elastic.results[4].branches[i].least_radius));
        assert_true(r->elastic.results[4].branches[i].largest_bending == 0.0);
        assert_true(isfinite(r->set.results[4].branches[i].least_radius));
    }
    for (int i = 0; i < r->elastic.n_steps; i++)
        assert_true(r->elastic.results[i].plastic == 0.0);
}

/* --- the report --- */

static void report_says_what_was_found(void **state)
{
    (void)state;
    write_report();
    static const char *const texts[] = {
        "<b>Simulation.</b>",
        "A &lt;trunk&gt; &amp; leads",
        "<b>1 of 2 limits exceeded</b>; the largest force on the way is ",
        "; taken off, the harness keeps a residual shape up to ",
        "; the calibrated ranges of curvature are not known; no snaps.",
        "<b>Failed.</b> Force on C1: ",
        ", limit 0.100 N.",
        "<b>Passed.</b> 1 of 2 limits",
        "<b>Passed.</b> All 5 steps end at stable equilibria",
        "Unloading of trunk, lead: the law was fitted on loading only",
        "force exceeded",
        "Step 3: move C1",
        "Branch B2: curvature and bend radius along it",
        "bundle-7.yaml",
        "SHA-256 <tt>",
        "Law of trunk: <i>E</i> ",
        "a note",
    };
    assert_says_all("report/report.html", texts, sizeof texts / sizeof texts[0]);
    static const char *const figures[] = {"harness",
                                          "forces",
                                          "step-1",
                                          "step-2-perspective",
                                          "step-5-forces",
                                          "residual",
                                          "residual-perspective",
                                          "branch-3"};
    assert_simulated_figures(figures, sizeof figures / sizeof figures[0]);
    assert_clean_report();
    assert_same_report(&wb_harnesses_kind, &results);
}

static void numbers_are_those_of_both_computations(void **state)
{
    (void)state;
    struct wb_json *root;
    double value;
    const char *text;
    write_report();
    assert_int_equal(wb_json_read(&root, in_folder("report/report.json")), WB_OK);
    const struct wb_json *const found = wb_json_get(root, "found");
    assert_true(wb_json_get_number(found, "limits_exceeded", &value));
    assert_close(value, 1.0, 0.0);
    assert_true(wb_json_get_number(found, "largest_force_N", &value));
    assert_close_relative(value, results.found.force.value, 1e-12);
    assert_true(wb_json_get_text(found, "least_radius_step", &text));
    assert_string_equal(text, campaign.plan->steps[results.found.radius.step].name);
    static const char *const computed[] = {"harness", "elastic"};
    const struct wb_harness_result_set *const sets[] = {&results.set, &results.elastic};
    for (int i = 0; i < 2; i++) {
        const struct wb_json *const set = wb_json_get(root, computed[i]);
        assert_null(wb_json_get(set, "tool"));
        const struct wb_json *const step = wb_json_item(wb_json_get(set, "steps"), 1);
        const struct wb_json *const force = wb_json_item(wb_json_get(step, "forces"), 1);
        assert_true(wb_json_get_text(force, "name", &text));
        assert_string_equal(text, "C1");
        assert_true(wb_json_get_number(force, "force_N", &value));
        assert_close_relative(value, sets[i]->results[1].forces[3].size, 1e-12);
    }
    wb_json_destroy(root);
}

/* As if the third step had found no equilibrium, and the elastic computation a snap before. */
/* The lead is a calibrated wire; the trunk is exact. */
static void bands_stand_beside_the_largest_forces(void **state)
{
    (void)state;
    char line[WB_PATH];
    struct wb_harnesses own = {.runs = 0};
    struct wb_harnesses_results of = {.campaign = NULL};
    struct wb_json *root;
    const char *const root_folder = getenv("WIREBENCH_SOURCE_ROOT");
    assert_non_null(root_folder);
    snprintf(line, sizeof line, "  - {name: lead, wire: %s/docs/cards/type1.yaml}", root_folder);
    write_harness(in_folder("scatter.yaml"), 5, line);
    assert_int_equal(wb_kind_read(&wb_harnesses_kind, &own,
                                  write_text("s.yaml", HEAD "harness: ./scatter.yaml\nruns: 40\n")),
                     WB_OK);
    assert_int_equal(wb_harnesses_load(&of, &own), WB_OK);
    assert_int_equal(of.outcome.n_steps, 3);
    assert_int_equal(wb_harnesses_compute(&of, 0, NULL, NULL), WB_OK);
    assert_non_null(of.bands);
    assert_int_equal(wb_kind_write(&wb_harnesses_kind, &of, in_folder("banded"), true, 0), WB_OK);
    static const char *const texts[] = {"95 % band (N)", "Bands: 95 % of 40 runs",
                                        "the specimens of lead (3)"};
    assert_says_all("banded/report.html", texts, sizeof texts / sizeof texts[0]);
    assert_true(files_follow_schemas(in_folder("banded")));
    assert_int_equal(wb_json_read(&root, in_folder("banded/report.json")), WB_OK);
    assert_non_null(wb_json_get(wb_json_get(root, "harness"), "uncertainty"));
    assert_null(wb_json_get(wb_json_get(root, "elastic"), "uncertainty"));
    wb_json_destroy(root);
    wb_harnesses_release_results(&of);
    wb_harnesses_release(&own);
    /* Without scatter the campaign is rejected. */
    assert_int_equal(wb_kind_read(&wb_harnesses_kind, &own,
                                  write_text("s.yaml", HEAD "harness: small\nruns: 40\n")),
                     WB_ERR_ARGUMENT);
    assert_message("the file of no wire has it");
    wb_harnesses_release(&own);
}

static void incomplete_result_is_reported_as_far_as_it_goes(void **state)
{
    (void)state;
    static struct wb_harnesses cut;
    static struct wb_harnesses_results part;
    assert_int_equal(
        wb_kind_read(&wb_harnesses_kind, &cut, write_text("c.yaml", HEAD "harness: ./h.yaml\n")),
        WB_OK);
    assert_int_equal(wb_harnesses_load(&part, &cut), WB_OK);
    assert_int_equal(wb_harnesses_compute(&part, 0, NULL, NULL), WB_OK);
    struct wb_harness_step_result *const last = &part.set.results[2];
    part.set.converged = part.elastic.converged = false;
    part.set.n_steps = 3;
    last->end = WB_HARNESS_NOT_CONVERGED;
    last->problem = "no <equilibrium>";
    last->fraction = 0.25;
    last->worst_branch = 1;
    last->n_snaps = 1;
    last->snaps[0] = (struct wb_harness_snap){.fraction = 0.125, .distance = 0.034};
    last->snap_branch[0] = 0;
    part.elastic.n_steps = 2;
    part.elastic.results[1].end = WB_HARNESS_NOT_CONVERGED;
    wb_harness_found_collect(&part.found, &part.set);
    assert_true(isnan(wb_harnesses_elastic_force(&part, 1, 3)));
    assert_true(isnan(wb_harnesses_elastic_largest(&part, 3)));
    assert_int_equal(wb_kind_write(&wb_harnesses_kind, &part, in_folder("report"), true, 0), WB_OK);
    static const char *const texts[] = {
        "The elastoplastic computation ends in step 3 (move C1), at 0.25 of it, in branch B2: no ",
        "no &lt;equilibrium&gt;. Later steps are not computed.",
        "The elastic computation ends in step 2 (mount C1)",
        "<b>Not completed</b>: it ends at 0.25 of the step.",
        "1 snap, the first at 0.125 of the step; in the farthest motion B1 moves by 34.0 mm.",
        "; 1 snap, by at most 34 mm.",
        "Snaps in step 3 (move C1)",
    };
    assert_says_all("report/report.html", texts, sizeof texts / sizeof texts[0]);
    assert_false(says("report/report.html", "residual shape up to"));
    assert_false(wb_file_exists(in_folder("report/figures/residual.svg")));
    assert_false(wb_file_exists(in_folder("report/figures/step-4.svg")));
    assert_clean_report();
    wb_harnesses_release_results(&part);
    wb_harnesses_release(&cut);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(invalid_file_is_rejected_with_its_line),
        cmocka_unit_test(damaged_harness_file_is_rejected_with_its_own_line),
        cmocka_unit_test(shipped_harness_is_named_from_fixtures_on),
        cmocka_unit_test(elastic_computation_stands_beside_that_with_the_laws),
        cmocka_unit_test(round_off_is_zero),
        cmocka_unit_test(report_says_what_was_found),
        cmocka_unit_test(numbers_are_those_of_both_computations),
        cmocka_unit_test(bands_stand_beside_the_largest_forces),
        cmocka_unit_test(incomplete_result_is_reported_as_far_as_it_goes),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
