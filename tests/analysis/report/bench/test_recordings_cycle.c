/* What a report says of calibrations on whole cycles, of specimens of the virtual rig: the other
 * length predicted on both ways, and a wire that no law follows. */
#include "analysis/report/bench/recordings_kind.h"
#include "analysis/report/bench/recordings_results_private.h"
#include "base/units.h"
#include "tests/analysis/fast_rig.h"
#include "tests/analysis/report/report_folder.h"

#include <cmocka.h>

static const char text[] = "title: Both ways\n"
                           "index: none.yaml\n"
                           "calibration_length_mm: 85\n"
                           "validation_length_mm: 100\n"
                           "wires: [{wire: type2}]\n";

struct bench {
    struct wb_recordings campaign;
    struct wb_recordings_results results;
};

static struct wb_dataset *make(struct wb_recordings_results_tests *tests, double length,
                               uint64_t seed)
{
    struct wb_recordings_results_test *const test = &tests->items[0];
    struct fast_rig fast;
    assert_int_equal(tests->n, 1);
    fast_rig_init(&fast, 2, length, seed);
    assert_int_equal(fast_rig_run(&fast, &test->dataset), WB_OK);
    test->dataset.info.sample = 1;
    test->usable = test->is_virtual = true;
    return &test->dataset;
}

/* Without the paper's route, which has its own tests. */
static void calibrate(struct bench *bench)
{
    struct wb_properties properties;
    struct wb_reason why = {.text = ""};
    write_text("campaign.yaml", text);
    assert_int_equal(
        wb_kind_read(&wb_recordings_kind, &bench->campaign, in_folder("campaign.yaml")), WB_OK);
    memset(&bench->results, 0, sizeof bench->results);
    assert_int_equal(wb_recordings_results_load(&bench->results, &bench->campaign), WB_OK);
    struct wb_recordings_results_wire *const wire = &bench->results.wires[0];
    const struct wb_dataset *const near = make(&wire->steps[0].tests, 85.0 * WB_MM, 1);
    const struct wb_dataset *const far = make(&wire->steps[1].tests, 100.0 * WB_MM, 2);
    if (wb_recordings_cycle_run(&wire->cycle, &near, 1, &why) != WB_OK)
        fail_msg("%s", why.text);
    wb_properties_from_cycle(&wire->cycle.calibration, &properties);
    assert_int_equal(
        wb_validate_run(&wire->prediction, &properties, &far, 1, &bench->campaign.head.fit, NULL),
        WB_OK);
    wire->cycle_states[0] = wire->cycle_states[1] = WB_RECORDINGS_DONE;
    wb_recordings_results_judge(&bench->results);
}

static double number_of(const struct wb_json *object, const char *key)
{
    double value = (double)NAN;
    assert_true(wb_json_get_number(object, key, &value));
    return value;
}

static void the_law_predicts_both_ways_at_the_other_length(void **state)
{
    struct bench *const bench = *state;
    struct wb_json *root;
    const struct wb_validate_result *const p =
        wb_recordings_results_prediction(&bench->results.wires[0]);
    assert_non_null(p);
    /* Another specimen of the product, so some percent off, but on both ways. */
    assert_true(p->elastoplastic.rms < 0.06);
    assert_true(p->cycles.n_samples == 1 && p->cycles.rms < 0.06);
    assert_int_equal(
        wb_kind_write(&wb_recordings_kind, &bench->results, in_folder("good"), false, 0), WB_OK);
    assert_int_equal(wb_json_read(&root, in_folder("good/report.json")), WB_OK);
    const struct wb_json *const cycle =
        wb_json_get(wb_json_item(wb_json_get(root, "wires"), 0), "cycle");
    const struct wb_json *const prediction = wb_json_get(cycle, "prediction");
    assert_close(number_of(wb_json_get(prediction, "unloading"), "rms"), p->cycles.rms, 1e-15);
    assert_close(number_of(wb_json_get(prediction, "elastoplastic"), "rms_over_F_max"),
                 p->elastoplastic.rms, 1e-15);
    assert_close(number_of(wb_json_get(prediction, "residual_deflection_mm"), "measured"),
                 p->cycles.residual_measured / WB_MM, 1e-9);
    wb_json_destroy(root);
    assert_true(wb_file_exists(in_folder("good/figures/type2-prediction.svg")));
    assert_true(wb_file_exists(in_folder("good/figures/all-moments.svg")));
    assert_true(says("good/report.html", "Prediction at 100 mm"));
    assert_true(says("good/report.html", "Law and hardening rule"));
    assert_false(says("good/report.html", "no law fits the data"));
    assert_false(says("good/report.html", "Broken line"));
}

/* Neither EI nor residual curvature ratio nor a moment has a value then, on no page. */
static void a_rule_that_the_data_do_not_support_has_ranges_only(void **state)
{
    struct bench *const bench = *state;
    struct wb_cycle_calibration *const c = &bench->results.wires[0].cycle.calibration;
    char value[64];
    /* Which wires come to this is for tests/analysis/calibration. */
    c->is_followed = false;
    c->ranked[0].misfit = 0.02;
    assert_int_equal(
        wb_kind_write(&wb_recordings_kind, &bench->results, in_folder("bad"), false, 0), WB_OK);
    assert_true(says("bad/report.html", "no law fits the data"));
    assert_true(says("bad/report.html", "No law fits the data"));
    assert_true(says("bad/report.html", "Broken line"));
    assert_true(says("bad/report.html", "over laws"));
    snprintf(value, sizeof value, "<i>EI</i> = %.0f", 1e6 * c->rigidity.value);
    assert_false(says("bad/report.html", value));
    snprintf(value, sizeof value, ">%.2f<", 1e3 * c->moment[4].value);
    assert_false(says("bad/report.html", value));
    assert_true(says("bad/report.json", "\"supported\": false"));
}

static int setup(void **state)
{
    static struct bench bench;
    if (make_folder(state) != 0)
        return -1;
    calibrate(&bench);
    *state = &bench;
    return 0;
}

static int teardown(void **state)
{
    struct bench *const bench = *state;
    wb_recordings_results_release(&bench->results);
    wb_recordings_release(&bench->campaign);
    return remove_folder(state);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_law_predicts_both_ways_at_the_other_length),
        cmocka_unit_test(a_rule_that_the_data_do_not_support_has_ranges_only),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
