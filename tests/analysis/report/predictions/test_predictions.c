/* Campaigns of predictions: reading, tests held against bands, and the report. The tests are made
 * up: the medians of the prediction times a factor, so that where they lie is known. */
#include "tests/analysis/report/report_folder.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

#include "analysis/report/predictions/predictions_kind.h"
#include "analysis/report/predictions/predictions_private.h"
#include "base/json.h"
#include "base/units.h"
#include "tests/check.h"

static struct wb_predictions campaign;
static struct wb_predictions_results results;

static int set_up(void **state)
{
    keep_messages();
    return make_folder(state);
}

static int tear_down(void **state)
{
    wb_predictions_results_release(&results);
    wb_predictions_release(&campaign);
    return remove_folder(state);
}

#define HEAD "kind: prediction\ntitle: Seven <wires>\nnotes: a note\nruns: 20\n"

static const char whole[] = HEAD "bundles:\n"
                                 "  - bundle: template\n"
                                 "    tests:\n"
                                 "      - {dataset: ./same, label: as foretold}\n"
                                 "      - {dataset: ./stiff, label: stiff & short}\n"
                                 "      - {dataset: ./thin, case: one-layer}\n"
                                 "      - {dataset: ./longer}\n"
                                 "      - {dataset: ./none}\n";

/* --- reading --- */

static void a_campaign_that_makes_no_sense_is_refused_with_its_line(void **state)
{
    (void)state;
    static const struct refused_campaign wrong[] = {
        {HEAD "bundles: []\n", "c.yaml:5: bundles: expected a list of 1 to 16 bundles"},
        {HEAD "bundles: [{bundle: 7-type3}]\n", "7-type3.yaml has no section uncertainty: add it"},
        {HEAD "bundles: [{bundle: template, tests: [{dataset: x, case: twisted}]}]\n",
         "c.yaml:5: case: 'twisted' is no scenario of "},
        {"kind: prediction\ntitle: x\nruns: 3\nbundles: [{bundle: template}]\n",
         "c.yaml:3: runs: "},
    };
    assert_refused(&wb_predictions_kind, &campaign, wrong, sizeof wrong / sizeof wrong[0]);
}

/* --- tests beside bands --- */

/* The case's medians times a factor on the way up, then straight down to zero force and beyond, so
 * that this part of the way springs back. */
static void make_test(const char *name, const struct wb_bands_case *c, double factor, double back,
                      double length)
{
    struct wb_dataset dataset;
    wb_dataset_init(&dataset);
    snprintf(dataset.info.wire, sizeof dataset.info.wire, "bundle");
    dataset.info.length = length;
    dataset.info.outer_diameter = 4.6 * WB_MM;
    dataset.info.mass_per_length = 0.05;
    dataset.info.rest_level = (double)NAN;
    dataset.info.gravity = 9.80665;
    dataset.info.counterweight = 0.01;
    dataset.info.strand_length = 0.76;
    dataset.info.is_virtual = true;
    const struct wb_bands_place *const last = &c->force[c->n_force - 1];
    for (int i = 0; i < c->n_force + 2; i++) {
        const bool is_up = i < c->n_force;
        const double part = i == c->n_force ? 1.0 : 2.0; /* of the way to zero force */
        const struct wb_row row = {
            .t = i,
            .cycle = 1,
            .phase = is_up ? WB_PHASE_LOAD : WB_PHASE_UNLOAD,
            .deflection = is_up ? c->force[i].at : last->at * (1.0 - back * part),
            .force = is_up ? factor * c->force[i].band.median
                           : factor * last->band.median * (1.0 - part),
            .tension = 0.1,
            .stage = (double)NAN,
            .tip_x = (double)NAN,
            .tip_angle = (double)NAN,
        };
        wb_dataset_add_row(&dataset, &row);
    }
    assert_int_equal(wb_dataset_write(&dataset, in_folder(name), true), WB_OK);
    wb_dataset_release(&dataset);
}

/* Predicts once without tests, makes these, and computes all; once for all facts. */
static const struct wb_predictions_results *whole_report(void)
{
    if (results.campaign)
        return &results;
    assert_int_equal(wb_kind_read(&wb_predictions_kind, &campaign, write_text("c.yaml", whole)),
                     WB_OK);
    struct wb_bands *bands;
    const struct wb_bands_settings settings = {.runs = 20, .seed = 1};
    const double length = campaign.bundles[0].model->length;
    assert_int_equal(wb_bands_create(&bands, campaign.bundles[0].model->path, &settings), WB_OK);
    make_test("same", &bands->cases[0], 1.0, bands->cases[0].springback.median, length);
    make_test("stiff", &bands->cases[0], 1.3, bands->cases[0].springback.median, length);
    make_test("thin", &bands->cases[1], 1.0, 0.9, length);
    make_test("longer", &bands->cases[0], 1.0, 0.5, 1.1 * length);
    wb_bands_destroy(bands);
    assert_int_equal(wb_predictions_results_load(&results, &campaign), WB_OK);
    assert_int_equal(wb_predictions_results_compute(&results, 0, NULL, NULL), WB_OK);
    return &results;
}

static void tests_are_held_against_the_case_that_they_are_of(void **state)
{
    (void)state;
    const struct wb_predictions_verdict *const tests = whole_report()->bundles[0].tests;
    for (int i = 0; i < 3; i++) {
        assert_close(tests[0].places[i].at, 53.0 * WB_MM * (i + 1) / 3.0, 1e-8);
        assert_close_relative(tests[0].places[i].measured, tests[0].places[i].band.median, 1e-9);
        assert_int_equal(tests[0].places[i].side, WB_PREDICTIONS_WITHIN);
        assert_close_relative(tests[1].places[i].measured, 1.3 * tests[1].places[i].band.median,
                              1e-9);
        assert_int_equal(tests[1].places[i].side, WB_PREDICTIONS_ABOVE);
        assert_int_equal(tests[2].places[i].side, WB_PREDICTIONS_WITHIN);
    }
    assert_close(tests[0].places[3].measured, tests[0].places[3].band.median, 1e-9);
    assert_int_equal(tests[0].places[3].side, WB_PREDICTIONS_WITHIN);
    assert_string_equal(tests[2].against->variant.name, "one-layer");
    assert_close(tests[2].places[3].measured, 0.9, 1e-9);
    assert_int_equal(tests[2].places[3].side, WB_PREDICTIONS_ABOVE);
    assert_non_null(strstr(tests[0].words, "within: model"));
    assert_non_null(strstr(tests[1].words, "stiffer than predicted at every deflection"));
    assert_non_null(strstr(tests[2].words, "force within, springback of the deflection outside"));
    assert_true(results.outcome.exceeds_limit && !results.outcome.is_complete);
    assert_int_equal(results.outcome.n_missing, 1);
    assert_int_equal(results.outcome.n_usable, 3);
}

static void a_test_of_another_length_is_refused(void **state)
{
    (void)state;
    const struct wb_predictions_verdict *const longer = &whole_report()->bundles[0].tests[3];
    assert_int_equal(longer->state, WB_SIMULATION_REFUSED);
    assert_non_null(strstr(wb_text_string(&longer->problem), "predict the length that was tested"));
    assert_null(longer->against);
}

static void the_places_together_say_what_to_look_at(void **state)
{
    (void)state;
    enum {
        B = WB_PREDICTIONS_BELOW,
        I = WB_PREDICTIONS_WITHIN,
        A = WB_PREDICTIONS_ABOVE,
        U = WB_PREDICTIONS_UNKNOWN
    };
    static const struct {
        int sides[WB_PREDICTIONS_PLACES];
        const char *words;
    } cases[] = {
        {{I, I, I, I}, "within: "},          {{I, I, I, U}, "within: "},
        {{B, B, B, I}, "softer "},           {{A, A, A, B}, "stiffer "},
        {{I, I, B, I}, "within at first, "}, {{I, B, B, A}, "within at first, "},
        {{I, I, I, A}, "force within, "},    {{I, A, I, I}, "one number outside"},
        {{B, I, A, I}, "some numbers "},     {{U, U, U, U}, "nothing "},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct wb_predictions_place places[WB_PREDICTIONS_PLACES] = {{0}};
        for (int k = 0; k < WB_PREDICTIONS_PLACES; k++)
            places[k].side = (enum wb_predictions_side)cases[i].sides[k];
        const char *const words = wb_predictions_judge(places);
        assert_memory_equal(words, cases[i].words, strlen(cases[i].words));
    }
}

/* --- the report --- */

static void the_report_says_what_is_predicted_and_what_was_tested(void **state)
{
    (void)state;
    assert_int_equal(
        wb_kind_write(&wb_predictions_kind, whole_report(), in_folder("report"), true, 0), WB_OK);
    static const char *const texts[] = {
        "<b>Simulations.</b>",
        "Seven &lt;wires&gt;",
        "one-layer",
        "stiff &amp; short",
        "measured on a virtual rig",
        "there is no such dataset",
        "diameter with pitch",
        "Law of the wires: tolerances about",
    };
    assert_says_all("report/report.html", texts, sizeof texts / sizeof texts[0]);
    assert_clean_report();
    assert_same_report(&wb_predictions_kind, &results);
    struct wb_json *root;
    double value;
    assert_int_equal(wb_json_read(&root, in_folder("report/report.json")), WB_OK);
    const struct wb_json *const tests =
        wb_json_get(wb_json_item(wb_json_get(root, "bundles"), 0), "tests");
    const struct wb_json *const place =
        wb_json_item(wb_json_get(wb_json_item(tests, 1), "places"), 2);
    assert_true(wb_json_get_number(place, "deflection_mm", &value));
    assert_close(value, 53.0, 1e-6);
    wb_json_destroy(root);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_campaign_that_makes_no_sense_is_refused_with_its_line),
        cmocka_unit_test(tests_are_held_against_the_case_that_they_are_of),
        cmocka_unit_test(a_test_of_another_length_is_refused),
        cmocka_unit_test(the_places_together_say_what_to_look_at),
        cmocka_unit_test(the_report_says_what_is_predicted_and_what_was_tested),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
