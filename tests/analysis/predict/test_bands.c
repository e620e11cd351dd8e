/* Bands of a bundle of seven wires: files are written into a folder of the test's own. */
#include "analysis/predict/bands.h"

#include <stdlib.h>

#include "analysis/predict/bands_output.h"
#include "base/file.h"
#include "base/text.h"
#include "base/units.h"
#include "fe/section/section_run.h"
#include "tests/check.h"
#include "tests/messages.h"
#include "tests/own_folder.h"

static struct wb_bands *bands;

static int release(void **unused)
{
    (void)unused;
    wb_bands_destroy(bands);
    bands = NULL;
    return 0;
}

static const char head[] = "name: seven\n"
                           "wires: [{wire: type3, count: 7}]\n"
                           "packing: hexagon\n"
                           "tape: tape\n"
                           "length_mm: 114\n"
                           "interface: {cohesive_stiffness_N_mm3: 30, friction: 0.2}\n"
                           "run: {deflection_mm: 20, rows: 10}\n"
                           "loads: {weight: false}\n";
static const char exact_wires[] =
    "  wires: [{wire: type3, youngs_modulus_percent: 0, yield_stress_percent: 0, stress_percent: "
    "0}]\n";
static const char exact_lengths[] =
    "  diameter_percent: 0\n  pitch_percent: 0\n  length_percent: 0\n";
static const char exact_tape[] =
    "  tape: {thickness_percent: 0, youngs_modulus_percent: 0, yield_stress_percent: 0}\n";
static const char exact_rest[] = "  cohesive_stiffness_N_mm3: [30, 30]\n  friction: [0.2, 0.2]\n";

static void write_text(const char *name, const char *const *parts, char path[WB_PATH])
{
    struct wb_text text = {0};
    for (int i = 0; parts[i]; i++)
        wb_text_append(&text, "%s", parts[i]);
    assert_int_equal(wb_file_join(path, folder, name), WB_OK);
    assert_int_equal(wb_file_write_text(path, &text), WB_OK);
    wb_text_release(&text);
}

static void compute(const char *path, const struct wb_bands_settings *settings)
{
    assert_int_equal(wb_bands_create(&bands, path, settings), WB_OK);
}

/* Force at the largest deflection of a single run. */
static double single_run_force(const char *path, double cohesion, double length)
{
    struct wb_bundle_model *const model = calloc(1, sizeof *model);
    struct wb_section_run run;
    assert_non_null(model);
    assert_int_equal(wb_bundle_model_read(model, path), WB_OK);
    model->interface.shear_stiffness *= cohesion / model->interface.normal_stiffness;
    model->interface.normal_stiffness = cohesion;
    model->length = length;
    assert_int_equal(wb_section_run_init(&run, model, 2), WB_OK);
    assert_int_equal(wb_section_run(&run, model, NULL), WB_OK);
    const double force = run.rows[run.n_rows - 1].force;
    wb_section_run_release(&run);
    free(model);
    return force;
}

static void quantiles_of_one_input_are_runs_at_its_quantiles(void **unused)
{
    (void)unused;
    char path[WB_PATH];
    write_text("one.yaml",
               (const char *[]){head, "uncertainty:\n", exact_wires, exact_lengths, exact_tape,
                                "  cohesive_stiffness_N_mm3: [3, 300]\n  friction: [0.2, 0.2]\n",
                                NULL},
               path);
    compute(path, &(struct wb_bands_settings){.runs = 60, .seed = 1});
    assert_int_equal(bands->n_cases, 1);
    const struct wb_bands_case *const c = &bands->cases[0];
    assert_int_equal(c->n_lost + c->n_limited, 0);
    assert_int_equal(c->n_force, 11);
    const struct wb_bands_interval *const band = &c->force[10].band;
    const double n_mm3 = WB_N_PER_MM3;
    /* 60 strata: quantiles are accurate to half a stratum, 1/120. */
    assert_close(band->median, single_run_force(path, 30.0 * n_mm3, 0.114), 0.004 * band->median);
    assert_close(band->low, single_run_force(path, 3.0 * pow(100.0, 0.05) * n_mm3, 0.114),
                 0.02 * band->low);
    assert_close(band->high, single_run_force(path, 3.0 * pow(100.0, 0.95) * n_mm3, 0.114),
                 0.004 * band->high);
    assert_true(band->low < 0.85 * band->median);
    /* The model's error, 1.645 times 2 % of the largest force, is added in quadrature. */
    const double error = 1.6449 * 0.02 * band->median;
    assert_close(band->wide_low, band->median - hypot(band->median - band->low, error), 1e-6);
    assert_close(band->wide_high, band->median + hypot(band->high - band->median, error), 1e-6);
    const struct wb_ranking *const ranking = &c->ranking[1].ranking;
    assert_true(ranking->is_valid && ranking->n_groups == 1);
    assert_string_equal(bands->inputs.group_name[ranking->group[0].group], "bond of the tape");
    assert_close(ranking->group[0].share, 1.0, 1e-3);
}

/* A bundle without uncertainty has only the model's band. */
static void without_uncertainty_the_band_is_the_models(void **unused)
{
    (void)unused;
    char path[WB_PATH];
    write_text("exact.yaml",
               (const char *[]){head, "uncertainty:\n", exact_wires, exact_lengths, exact_tape,
                                exact_rest, NULL},
               path);
    compute(path, &(struct wb_bands_settings){.runs = 25});
    const struct wb_bands_interval *const band = &bands->cases[0].force[10].band;
    assert_close(band->median, single_run_force(path, 30.0 * WB_N_PER_MM3, 0.114),
                 2e-4 * band->median);
    assert_close(band->low, band->high, 1e-12);
    assert_close_relative(band->wide_high, 1.0329 * band->median, 1e-4);
    assert_int_equal(bands->cases[0].ranking[0].ranking.n_groups, 0);
}

/* A leaning strand and the sag under weight change the force a little. */
static void overrides_of_the_command_apply_to_every_run(void **unused)
{
    (void)unused;
    static const struct wb_bundle_override override = {.dead_force = true, .no_weight = true};
    char path[WB_PATH];
    double median[3];
    for (int i = 0; i < 3; i++) {
        struct wb_text loads = {0};
        wb_text_append(&loads, "%s", head);
        char *const at = strstr(loads.bytes, "loads:");
        assert_non_null(at);
        *at = '\0';
        write_text("loads.yaml",
                   (const char *[]){loads.bytes,
                                    i == 0 ? "loads: {weight: false}\n"
                                           : "loads: {weight: true, strand_mm: 60}\n",
                                    "uncertainty:\n", exact_wires, exact_lengths, exact_tape,
                                    exact_rest, NULL},
                   path);
        wb_text_release(&loads);
        compute(path,
                &(struct wb_bands_settings){.runs = 22, .override = i == 2 ? &override : NULL});
        median[i] = bands->cases[0].force[10].band.median;
        release(NULL);
    }
    assert_true(fabs(median[1] - median[0]) > 1e-4 * median[0]);
    assert_close_relative(median[2], median[0], 1e-9);
}

static const char some[] =
    "uncertainty:\n"
    "  wires: [{wire: type3, youngs_modulus_percent: 5, yield_stress_percent: 10, "
    "stress_percent: 5}]\n"
    "  diameter_percent: 1\n  pitch_percent: 1\n  length_percent: 0.5\n"
    "  tape: {thickness_percent: 10, youngs_modulus_percent: 10, yield_stress_percent: 10}\n"
    "  cohesive_stiffness_N_mm3: [20, 45]\n  friction: [0.1, 0.4]\n";

static void write_outputs(const char *name)
{
    char inner[WB_PATH];
    assert_int_equal(wb_file_join(inner, folder, name), WB_OK);
    assert_int_equal(wb_file_make_folder(inner), WB_OK);
    assert_int_equal(wb_bands_output_write(bands, inner), WB_OK);
}

static void assert_same_files(const char *one, const char *other)
{
    static const char *const names[] = {"bands.csv", "cases.csv", "bands.svg"};
    for (int i = 0; i < 3; i++) {
        char path[2][WB_PATH], inner[WB_PATH], *bytes[2];
        size_t size[2];
        for (int k = 0; k < 2; k++) {
            assert_int_equal(wb_file_join(inner, folder, k ? other : one), WB_OK);
            assert_int_equal(wb_file_join(path[k], inner, names[i]), WB_OK);
            assert_int_equal(wb_file_read(path[k], &bytes[k], &size[k]), WB_OK);
        }
        assert_true(size[0] > 300);
        assert_int_equal(size[0], size[1]);
        assert_memory_equal(bytes[0], bytes[1], size[0]);
        free(bytes[0]);
        free(bytes[1]);
    }
}

static void threads_do_not_change_a_byte_and_scenarios_are_cases(void **unused)
{
    (void)unused;
    char path[WB_PATH];
    write_text("some.yaml",
               (const char *[]){head, some,
                                "  scenarios:\n    - {name: one-layer, layers: 1}\n"
                                "    - {name: round, outline: circle, bond_reach_mm: 0.1}\n",
                                NULL},
               path);
    struct wb_bands_settings settings = {.runs = 24, .seed = 5, .n_threads = 1};
    compute(path, &settings);
    write_outputs("first");
    assert_int_equal(bands->n_cases, 3);
    const struct wb_bands_case *const c = bands->cases;
    assert_string_equal(c[0].variant.name, "file");
    assert_close(c[0].layers, 2.0, 0.0);
    assert_close(c[1].layers, 1.0, 0.0);
    assert_true(c[2].is_round && !c[1].is_round);
    for (int i = 0; i < 3; i++)
        print_message("%s: %.4f N\n", c[i].variant.name, c[i].force[10].band.median);
    assert_true(c[1].force[10].band.median < 0.95 * c[0].force[10].band.median);
    assert_true(c[2].force[10].band.median < 0.998 * c[0].force[10].band.median);
    for (int i = 0; i < 3; i++) {
        assert_true(c[i].springback.low < c[i].springback.high && c[i].springback.high < 1.0);
        assert_int_equal(c[i].n_moment, WB_BANDS_MOMENTS);
        for (int k = 1; k < WB_BANDS_MOMENTS; k++)
            assert_true(c[i].moment[k].band.median > c[i].moment[k - 1].band.median);
    }
    release(NULL);
    settings.n_threads = 3;
    compute(path, &settings);
    write_outputs("second");
    assert_same_files("first", "second");
}

static void a_sweep_replaces_the_scenarios(void **unused)
{
    (void)unused;
    static const struct wb_bundle_variant variants[] = {
        {.name = "a", .layers = 1, .lap = 0.5},
        {.name = "b", .wires = 12},
        {.name = "c", .wires = 2},
    };
    char path[WB_PATH];
    write_text("swept.yaml",
               (const char *[]){head, some, "  scenarios: [{name: x, layers: 1}]\n", NULL}, path);
    compute(path, &(struct wb_bands_settings){
                      .runs = 22, .seed = 5, .n_variants = 3, .variants = variants});
    const struct wb_bands_case *const c = bands->cases;
    assert_int_equal(bands->n_cases, 4);
    /* One layer, half-lapped, is as thick as the two of the file. */
    assert_close(c[1].layers, 2.0, 1e-12);
    for (int i = 0; i <= 10; i++)
        assert_close(c[1].force[i].band.median, c[0].force[i].band.median,
                     1e-6 * c[0].force[10].band.median);
    assert_int_equal(c[2].n_wires, 12);
    assert_string_equal(c[2].packing, "triangle");
    assert_true(c[2].force[10].band.low > 1.3 * c[0].force[10].band.high);
    assert_string_equal(c[3].packing, "densest");
}

/* --- specimens --- */

static void append_properties(struct wb_text *text, double diameter_mm, int n)
{
    wb_text_append(text,
                   "wire: type3\nouter_diameter_mm: %g\nmass_per_length_kg_m: 0.00765\n"
                   "youngs_modulus_MPa: 4528\nyield_stress_MPa: 4.52\n"
                   "strength_coefficient_MPa: 1327\nhardening_exponent: 0.9\npoissons_ratio: 0.39\n"
                   "method: cycle\nspecimens:\n",
                   diameter_mm);
    for (int i = 0; i < n; i++)
        wb_text_append(text,
                       "  - {sample: %d, length_mm: 85, youngs_modulus_MPa: %g, yield_stress_MPa: "
                       "%g, strength_coefficient_MPa: %g, hardening_exponent: 0.9}\n",
                       i + 1, 4528 + 200.0 * (i - 2), 4.52 + 0.3 * (i % 3 - 1),
                       1327 + 60.0 * (i - 2));
}

static void write_properties(double diameter_mm, int n)
{
    char path[WB_PATH];
    struct wb_text text = {0};
    append_properties(&text, diameter_mm, n);
    assert_int_equal(wb_file_join(path, folder, "properties.yaml"), WB_OK);
    assert_int_equal(wb_file_write_text(path, &text), WB_OK);
    wb_text_release(&text);
}

static void laws_come_from_the_specimens_of_a_calibration(void **unused)
{
    (void)unused;
    char path[WB_PATH];
    write_properties(1.4, 5);
    write_text("drawn.yaml",
               (const char *[]){head,
                                "uncertainty:\n  wires: [{wire: type3, properties: "
                                "properties.yaml}]\n",
                                exact_lengths, exact_tape, exact_rest, NULL},
               path);
    compute(path, &(struct wb_bands_settings){.runs = 60, .seed = 2});
    const struct wb_bands_case *const c = &bands->cases[0];
    assert_string_equal(bands->inputs.wires[0].source, "5 specimens of properties.yaml");
    assert_int_equal(bands->inputs.n_dimensions, 6 + 8);
    assert_close(c->force[10].band.median, single_run_force(path, 30.0 * WB_N_PER_MM3, 0.114),
                 0.02 * c->force[10].band.median);
    const double width = c->force[10].band.high / c->force[10].band.low - 1.0;
    print_message("force %.4f N, band %.1f %% wide\n", c->force[10].band.median, 100.0 * width);
    /* Force is proportional to E^0.29 and other inputs: the specimens differ by 7 % of E,
     * correlated with K. */
    assert_true(width > 0.03 && width < 0.15);
    assert_int_equal(c->ranking[1].ranking.n_groups, 1);
    assert_true(c->ranking[1].ranking.is_valid);
}

/* --- errors --- */

static void assert_rejected(const char *const *parts, const char *message)
{
    char path[WB_PATH];
    const struct wb_bands_settings settings = {.runs = 30};
    write_text("wrong.yaml", parts, path);
    keep_messages();
    const enum wb_status status = wb_bands_create(&bands, path, &settings);
    release_messages();
    assert_int_not_equal(status, WB_OK);
    assert_message(message);
}

static void missing_uncertainties_are_reported(void **unused)
{
    (void)unused;
    static const char by_file[] = "uncertainty:\n  wires: [{wire: type3, properties: "
                                  "properties.yaml}]\n";
    static const char start[] = "uncertainty:\n";
    write_properties(1.4, 2);
    assert_rejected((const char *[]){head, NULL}, "uncertainty: this section is missing");
    assert_rejected((const char *[]){head, NULL}, "wires: [{wire: type3, properties: FILE}]");
    assert_rejected((const char *[]){head, by_file, exact_lengths, exact_tape, exact_rest, NULL},
                    "has 2 specimens");
    assert_rejected((const char *[]){head, start, exact_wires, exact_lengths, exact_rest, NULL},
                    "this key is missing: tape");
    assert_rejected((const char *[]){head, start, exact_wires, exact_lengths, exact_tape,
                                     "  friction: [0.2, 0.2]\n", NULL},
                    "this key is missing: cohesive_stiffness_N_mm3");
    assert_rejected((const char *[]){head, start, exact_wires, exact_lengths, exact_tape,
                                     "  cohesive_stiffness_N_mm3: [30, 30]\n", NULL},
                    "this key is missing: friction");
    assert_rejected((const char *[]){head, start, exact_wires, exact_tape, exact_rest,
                                     "  pitch_percent: 0\n  length_percent: 0\n", NULL},
                    "diameter_percent");
    assert_rejected((const char *[]){head, start, exact_wires, exact_lengths, exact_tape,
                                     "  cohesive_stiffness_N_mm3: [40, 30]\n", NULL},
                    "expected [least, largest]");
    assert_rejected(
        (const char *[]){head, start, "  wires: [{wire: type3}]\n", exact_lengths, NULL},
        "expected properties: FILE");
    assert_rejected((const char *[]){head, start,
                                     "  wires: [{wire: type3, youngs_modulus_percent: 1}]\n",
                                     exact_lengths, NULL},
                    "all three are needed");
    assert_rejected((const char *[]){head, start,
                                     "  wires: [{wire: type2, youngs_modulus_percent: 1, "
                                     "yield_stress_percent: 1, stress_percent: 1}]\n",
                                     exact_lengths, exact_tape, exact_rest, NULL},
                    "the bundle has no wire type2");
    write_properties(1.5, 5);
    assert_rejected((const char *[]){head, by_file, exact_lengths, exact_tape, exact_rest, NULL},
                    "is of a wire of 1.5 mm");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(quantiles_of_one_input_are_runs_at_its_quantiles, release),
        cmocka_unit_test_teardown(without_uncertainty_the_band_is_the_models, release),
        cmocka_unit_test_teardown(overrides_of_the_command_apply_to_every_run, release),
        cmocka_unit_test_teardown(threads_do_not_change_a_byte_and_scenarios_are_cases, release),
        cmocka_unit_test_teardown(a_sweep_replaces_the_scenarios, release),
        cmocka_unit_test_teardown(laws_come_from_the_specimens_of_a_calibration, release),
        cmocka_unit_test_teardown(missing_uncertainties_are_reported, release),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
