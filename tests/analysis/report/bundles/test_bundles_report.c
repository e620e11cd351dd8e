/* Campaigns of bundles: what is computed from their datasets, and the report. */
#include "tests/analysis/report/bundles/bundles_campaign.h"

#include <stdlib.h>

#include "base/json.h"

/* --- results --- */

static void errors_are_over_the_published_curves_largest_force(void **state)
{
    (void)state;
    const struct wb_bundles_results *const all = whole_report();
    const struct wb_bundles_result *const same = wb_bundles_results_usable(all, 0);
    const struct wb_bundles_result *const more = wb_bundles_results_usable(all, 1);
    const struct wb_bundles_result *const less = wb_bundles_results_usable(all, 4);
    assert_non_null(same);
    assert_non_null(more);
    assert_non_null(less);
    /* The published curve of seven wires by another program: 1.8011 N at 53 mm. */
    assert_close(same->published_max, 1.8011, 2e-3);
    assert_close(same->rms, 0.0, 1e-4);
    assert_close(more->max_error, 0.05, 1e-4);
    assert_close(more->curve.max_force, 1.05 * more->published_max, 1e-3);
    assert_close(less->max_error, 0.1, 1e-4);
    double squares = 0.0;
    for (int i = 0; i < more->curve.n; i++) {
        const double weight = i == 0 || i == more->curve.n - 1 ? 0.5 : 1.0;
        squares += weight * pow(0.05 * more->published[i] / more->published_max, 2.0);
    }
    assert_close_relative(more->rms, sqrt(squares / (more->curve.n - 1)), 2e-3);
}

static void published_properties_come_back_from_their_own_curve(void **state)
{
    (void)state;
    const struct wb_bundles_results *const all = whole_report();
    const struct wb_bundles_fit *const fit = wb_bundles_results_fit(all, 0);
    assert_non_null(fit);
    assert_true(fit->result.rms < 2e-3);
    assert_close_relative(fit->result.material.youngs_modulus, 1114e6, 0.03);
    assert_close_relative(fit->result.material.yield_stress, 2.7e6, 0.05);
    assert_close_relative(fit->rigidity,
                          wb_bundles_results_rigidity(fit->result.material.youngs_modulus, 4.6e-3),
                          1e-12);
    /* Nine tenths of the force, nine tenths of E I. */
    const struct wb_bundles_fit *const twelve = wb_bundles_results_fit(all, 1);
    assert_non_null(twelve);
    assert_close_relative(twelve->result.material.youngs_modulus, 0.9 * 1022e6, 0.03);
}

/* The made-up run 0 lies on the published curve: the model's distance from it, by hand. */
static void the_section_model_stands_beside_the_bundles_runs(void **state)
{
    (void)state;
    const struct wb_bundles_results *const all = whole_report();
    const struct wb_bundles_result *const run = wb_bundles_results_usable(all, 0);
    const struct wb_bundles_section *const section = wb_bundles_results_section(all, 0);
    struct wb_section_run computed;
    const struct wb_bundle_model *const model = whole_campaign.runs[0].model;
    assert_non_null(section);
    assert_int_equal(wb_section_run_init(&computed, model, 2), WB_OK);
    assert_int_equal(wb_section_run(&computed, model, NULL), WB_OK);
    const double end = computed.rows[computed.n_rows - 1].force;
    assert_close_relative(section->curve.force[section->curve.n - 1], end, 1e-3);
    assert_close_relative(section->rigidity[1].rigidity, computed.rigidity[1].rigidity, 1e-12);
    wb_section_run_release(&computed);
    assert_true(section->is_mean && isnan(section->loosens));
    double largest = 0.0;
    for (int i = 0; i < run->curve.n; i++)
        largest = fmax(largest, fabs(section->curve.force[i] - run->curve.force[i]));
    assert_close_relative(section->largest, largest / run->curve.max_force, 1e-9);
    assert_true(section->rms > 0.2 * section->largest && section->rms < section->largest);
    /* Only bundles' runs are computed; of one whose dataset is not there, too, but not compared. */
    assert_false(wb_bundles_results_section(all, 1)->is_mean);
    assert_null(wb_bundles_results_section(all, 2));
}

static void a_bundle_that_the_section_model_refuses_says_why(void **state)
{
    (void)state;
    struct wb_bundles_section section = {0};
    struct wb_bundles_run run = whole_campaign.runs[0];
    struct wb_bundle_model *const gaps = malloc(sizeof *gaps);
    assert_non_null(gaps);
    *gaps = *run.model;
    gaps->wire_gap = 0.05e-3;
    run.model = gaps;
    wb_bundles_section_compute(&section, &run, NULL, 0.5e-3);
    assert_int_equal(section.state, WB_SIMULATION_REFUSED);
    assert_memory_equal(wb_text_string(&section.problem), "gaps: wires_mm: 0.05 between", 28);
    wb_bundles_section_release(&section);
    free(gaps);
}

static void cost_is_that_which_the_datasets_store(void **state)
{
    (void)state;
    assert_close(wb_bundles_results_cost(whole_report(), 0), 0.1 / 50.0, 1e-12);
}

static void energies_are_read_row_by_row(void **state)
{
    (void)state;
    const struct wb_bundles_result *const run = wb_bundles_results_usable(whole_report(), 0);
    assert_non_null(run);
    assert_int_equal(run->n_energies, 54);
    const struct wb_bundles_energy *const last = &run->energies[53];
    assert_close(last->deflection, 53e-3, 1e-9);
    assert_close(last->time, 0.53, 1e-12);
    assert_close_relative(last->internal, 0.9 * last->external, 1e-9);
    assert_close_relative(last->friction, 0.1 * last->external, 1e-9);
    double work = 0.0;
    for (int i = 1; i < run->curve.n; i++)
        work += 0.5 * (run->curve.force[i] + run->curve.force[i - 1]) * run->curve.step;
    assert_close_relative(last->external, work, 2e-3);
}

static void a_missing_dataset_is_told_with_the_command_that_makes_it(void **state)
{
    (void)state;
    const struct wb_bundles_results *const all = whole_report();
    assert_int_equal(all->runs[3].simulation.state, WB_SIMULATION_MISSING);
    assert_true(wb_simulation_is_missing(&all->runs[3].simulation));
    assert_int_equal(all->outcome.n_wanted, 7);
    assert_int_equal(all->outcome.n_usable, 6);
    assert_false(all->outcome.is_complete);
}

/* --- the report --- */

static void write_report(void)
{
    if (!wb_file_exists(in_folder("report")))
        assert_int_equal(
            wb_kind_write(&wb_bundles_kind, whole_report(), in_folder("report"), false, 0), WB_OK);
}

static void the_report_is_whole_and_says_that_it_shows_simulations(void **state)
{
    (void)state;
    static const char *const figures[] = {"forces-1",        "errors-1", "energies-1", "study-1",
                                          "section-model-1", "fit",      "found"};
    write_report();
    assert_simulated_figures(figures, sizeof figures / sizeof figures[0]);
    assert_true(wb_file_exists(in_folder("report/figures/sections-1.svg")));
    assert_true(wb_file_exists(in_folder("report/figures/shape-1.svg")));
    assert_true(wb_file_exists(in_folder("report/figures/shape-2.svg")));
    static const char *const texts[] = {
        "<b>Simulations.</b>",
        "simulations, no tests",
        "Bundles &lt;and&gt; beams",
        "a note &amp; more",
        "Friction &lt;mu&gt;",
        "<b>Incomplete.</b> 1 of 7 datasets is missing",
        "wirebench solve bundle fixtures/bundles/7-type3.yaml -o sim/hung",
        "(the paper's Fig. 17)",
        "7 wires bent by 53 mm (the paper's Fig. 21)",
        "RMS from the published curve, over its largest force, limit",
        "12 wires (",
        "1114",
        "0.200",
        "Section model beside the explicit one",
        "0.2 (mean)",
    };
    assert_says_all("report/report.html", texts, sizeof texts / sizeof texts[0]);
    assert_clean_report();
}

static void report_json_has_what_the_pages_tell(void **state)
{
    (void)state;
    struct wb_json *root;
    double value;
    write_report();
    assert_int_equal(wb_json_read(&root, in_folder("report/report.json")), WB_OK);
    const struct wb_json *const bundle = wb_json_item(wb_json_get(root, "bundles"), 0);
    assert_true(wb_json_get_number(bundle, "cpu_of_rod_over_bundle", &value));
    assert_close(value, 0.002, 1e-12);
    assert_true(wb_json_get_number(wb_json_get(bundle, "published"), "EI_N_mm2", &value));
    assert_close(value, 24485.0, 1.0);
    const struct wb_json *const run = wb_json_item(wb_json_get(root, "runs"), 4);
    assert_true(wb_json_get_number(run, "rms", &value));
    assert_close(value, wb_bundles_results_usable(whole_report(), 4)->rms, 1e-15);
    assert_int_equal((int)wb_json_length(wb_json_get(run, "force_N")), 107);
    assert_true(wb_json_get_number(wb_json_get(run, "section_model"), "rms", &value));
    assert_close(value, wb_bundles_results_section(whole_report(), 4)->rms, 1e-15);
    assert_int_equal((int)wb_json_length(wb_json_get(root, "limits")), 7);
    assert_int_equal((int)wb_json_length(wb_json_get(root, "files")), 35);
    wb_json_destroy(root);
}

static void the_same_datasets_give_the_same_bytes(void **state)
{
    (void)state;
    write_report();
    assert_same_report(&wb_bundles_kind, whole_report());
}

static void a_report_without_datasets_says_how_to_make_them(void **state)
{
    (void)state;
    char text[sizeof whole];
    snprintf(text, sizeof text, "%s", whole);
    memcpy(strstr(text, "sim\n"), "xyz\n", 4);
    assert_int_equal(read_campaign(text), WB_OK);
    compute();
    assert_int_equal(results.outcome.n_usable, 1); /* the beam that is named by its path */
    assert_int_equal(wb_kind_write(&wb_bundles_kind, &results, in_folder("none"), true, 0), WB_OK);
    release();
    assert_true(says("none/report.html", "6 of 7 datasets are missing"));
    assert_true(says("none/report.html", "-o xyz/twelve"));
    assert_true(wb_file_exists(in_folder("none/figures/sections-1.svg")));
    assert_false(wb_file_exists(in_folder("none/figures/fit.svg")));
    assert_false(says("none/report.html", ">nan") || says("none/report.html", " nan"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(errors_are_over_the_published_curves_largest_force),
        cmocka_unit_test(published_properties_come_back_from_their_own_curve),
        cmocka_unit_test(the_section_model_stands_beside_the_bundles_runs),
        cmocka_unit_test(a_bundle_that_the_section_model_refuses_says_why),
        cmocka_unit_test(cost_is_that_which_the_datasets_store),
        cmocka_unit_test(energies_are_read_row_by_row),
        cmocka_unit_test(a_missing_dataset_is_told_with_the_command_that_makes_it),
        cmocka_unit_test(the_report_is_whole_and_says_that_it_shows_simulations),
        cmocka_unit_test(report_json_has_what_the_pages_tell),
        cmocka_unit_test(the_same_datasets_give_the_same_bytes),
        cmocka_unit_test(a_report_without_datasets_says_how_to_make_them),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
