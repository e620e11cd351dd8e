/* A calibration on whole cycles in JSON and in a properties file: the same numbers, and nothing
 * that the data do not say. */
#include <math.h>

#include "analysis/calibration/properties/cycle_json.h"
#include "analysis/calibration/properties/properties.h"
#include "base/file.h"
#include "base/units.h"
#include "tests/analysis/calibration/properties_path.h"
#include "tests/check.h"

enum {
    SPECIMENS = 2
};

/* A made-up calibration, whose members are on the stack. */
struct made {
    struct wb_cycle_calibration calibration;
    struct wb_cycle_member members[SPECIMENS];
    struct wb_cycle_calibrate_settings settings;
};

static const struct wb_material ludwik = {WB_HARDENING_ISOTROPIC_POWER, 4e9, 0.39, 3e6, 700e6, 0.7};

static struct wb_estimate around(double value)
{
    return (struct wb_estimate){value,        0.95 * value, 1.06 * value,
                                0.98 * value, 1.11 * value, 0.03};
}

static void make(struct made *made)
{
    static const struct wb_law_part parts[] = {
        {2.5e9, 1.1e-4}, {7e8, 1.3e-3}, {3.3e8, (double)INFINITY}};
    struct wb_cycle_calibration *const c = &made->calibration;
    *made = (struct made){
        .calibration =
            {
                .n_members = SPECIMENS,
                .has_unloading = true,
                .repeat_noise = 4e-4,
                .n_ranked = 2,
                .chosen = WB_CANDIDATE_PARALLEL_MIXED,
                .is_followed = true,
                .largest_curvature = 29.0,
                .rigidity = around(3e-4),
                .residual_curvature_ratio = around(0.27),
                .loop_energy = around(0.06),
                .ludwik = ludwik,
                .ludwik_misfit = 0.012,
                .ln_strength_error = (double)NAN,
                .exponent_error = (double)NAN,
                .travel_share = 0.6,
                .specimens_for_5_percent = 4,
            },
    };
    c->secant = (struct wb_cycle_stiffness){.n = 3, .resolved = 0.8, .curvature = {0.5, 0.8, 1.0}};
    c->unloading =
        (struct wb_cycle_stiffness){.n = 4, .resolved = 0.2, .curvature = {0.2, 0.5, 1.0, 2.0}};
    for (int k = 0; k < WB_CYCLE_STIFFNESSES; k++) {
        c->secant.estimate[k] = around(2.9e-4 - 1e-5 * k);
        c->unloading.estimate[k] = around(3e-4 - 1e-5 * k);
    }
    c->members = made->members;
    c->ranked[0] = (struct wb_cycle_rank){.candidate = WB_CANDIDATE_PARALLEL_MIXED,
                                          .is_fitted = true,
                                          .misfit = 7e-4,
                                          .rigidity = around(3e-4),
                                          .residual_curvature_ratio = around(0.27)};
    c->ranked[1] = (struct wb_cycle_rank){.candidate = WB_CANDIDATE_LUDWIK_MIXED,
                                          .is_fitted = true,
                                          .misfit = 9e-4,
                                          .rigidity = around(2.9e-4),
                                          .residual_curvature_ratio = around(0.28)};
    wb_law_init_parallel(&c->law, parts, 3, 0.3, 0.39);
    for (int k = 0; k < WB_CYCLE_MOMENTS; k++) {
        c->curvature[k] = wb_cycle_moment_parts[k] * c->largest_curvature;
        c->moment[k] = around(1e-3 * (k + 1));
    }
    for (int i = 0; i < SPECIMENS; i++) {
        struct wb_cycle_member *const member = &made->members[i];
        *member = (struct wb_cycle_member){
            .sample = i + 1, .ludwik = ludwik, .ludwik_misfit = 0.01 * (i + 1)};
        member->ludwik.youngs_modulus *= 1.0 + 0.1 * i;
        member->data.info = (struct wb_test_info){.wire = "type2",
                                                  .length = 0.085,
                                                  .outer_diameter = 1.25e-3,
                                                  .mass_per_length = 5.3e-3,
                                                  .poissons_ratio = 0.39,
                                                  .is_virtual = true};
        struct wb_cycle_answer *const answer = &member->answers[c->chosen];
        answer->is_fitted = true;
        answer->value[WB_CYCLE_RIGIDITY] = 3e-4;
        answer->value[WB_CYCLE_RESIDUAL_CURVATURE] = 0.27;
        answer->value[WB_CYCLE_LOOP_ENERGY] = 0.06;
        answer->fit.law = c->law;
        answer->fit.bow_angle = 0.05 - 0.13 * i;
        answer->fit.bow_angle_error = 1e-3;
        answer->fit.level = -2e-5 * i;
        answer->fit.misfit = 7e-4;
        answer->fit.is_converged = true;
    }
    wb_cycle_calibrate_default_settings(&made->settings);
}

static enum wb_status write_made(const struct made *made, bool force)
{
    const char *const names[] = {"data/a", "data/\"b\""};
    return wb_properties_write_cycle(path, &made->calibration, &made->settings, names, 2, force);
}

static void read_back(const struct made *made, struct wb_properties *read)
{
    assert_int_equal(write_made(made, true), WB_OK);
    assert_true(files_follow_schemas(path));
    assert_int_equal(wb_properties_read(path, read), WB_OK);
}

static void assert_estimate(const struct wb_estimate *a, const struct wb_estimate *b)
{
    const double x[] = {a->value, a->low, a->high, a->candidates_low, a->candidates_high};
    const double y[] = {b->value, b->low, b->high, b->candidates_low, b->candidates_high};
    for (int i = 0; i < 5; i++) {
        if (isnan(y[i]))
            assert_true(isnan(x[i]));
        else
            assert_close_relative(x[i], y[i], 1e-14);
    }
}

static void assert_stiffness(const struct wb_cycle_stiffness *a, const struct wb_cycle_stiffness *b)
{
    assert_true(b->n > 1);
    assert_int_equal(a->n, b->n);
    assert_close_relative(a->resolved, b->resolved, 1e-14);
    for (int k = 0; k < a->n; k++) {
        assert_close_relative(a->curvature[k], b->curvature[k], 1e-14);
        assert_estimate(&a->estimate[k], &b->estimate[k]);
    }
}

static void assert_material(const struct wb_material *a, const struct wb_material *b)
{
    assert_int_equal(a->hardening, b->hardening);
    assert_close_relative(a->youngs_modulus, b->youngs_modulus, 1e-14);
    assert_close_relative(a->poissons_ratio, b->poissons_ratio, 1e-14);
    assert_close_relative(a->yield_stress, b->yield_stress, 1e-14);
    assert_close_relative(a->strength_coefficient, b->strength_coefficient, 1e-14);
    assert_close_relative(a->hardening_exponent, b->hardening_exponent, 1e-14);
}

static void a_file_has_what_the_calibration_had(void **state)
{
    (void)state;
    struct made made;
    struct wb_properties direct, read;
    make(&made);
    wb_properties_from_cycle(&made.calibration, &direct);
    read_back(&made, &read);
    assert_string_equal(read.wire, "type2");
    assert_material(&read.material, &ludwik);
    assert_int_equal(read.law.form, WB_LAW_PARALLEL);
    assert_int_equal(read.law.n_parts, 3);
    assert_close_relative(read.law.isotropic_share, 0.3, 1e-14);
    for (int i = 0; i < 3; i++)
        assert_close_relative(read.law.parts[i].modulus, direct.law.parts[i].modulus, 1e-14);
    assert_close_relative(read.law.parts[1].yield_strain, 1.3e-3, 1e-14);
    assert_true(isinf(read.law.parts[2].yield_strain));
    assert_close_relative(read.law.material.youngs_modulus, 3.53e9, 1e-14);
    assert_close_relative(read.largest_curvature, 29.0, 1e-14);
    assert_close_relative(read.ludwik_misfit, 0.012, 1e-14);
    assert_estimate(&read.rigidity, &direct.rigidity);
    assert_estimate(&read.residual_curvature_ratio, &direct.residual_curvature_ratio);
    assert_stiffness(&read.secant, &direct.secant);
    assert_stiffness(&read.unloading, &direct.unloading);
    assert_true(read.is_rule_tested && read.is_rule_supported && read.is_virtual);
    assert_int_equal(read.n_moments, WB_CYCLE_MOMENTS);
    for (int k = 0; k < WB_CYCLE_MOMENTS; k++) {
        assert_close_relative(read.curvature[k], direct.curvature[k], 1e-14);
        assert_estimate(&read.moment[k], &direct.moment[k]);
    }
    assert_close_relative(read.calibration_length, 0.085, 1e-14);
    assert_close_relative(read.rms, 7e-4, 1e-14);
    assert_int_equal(read.n_samples, SPECIMENS);
    assert_int_equal(read.n_specimens, SPECIMENS);
    for (int i = 0; i < SPECIMENS; i++) {
        const struct wb_properties_specimen *const a = &read.specimens[i],
                                                   *b = &direct.specimens[i];
        assert_int_equal(a->sample, i + 1);
        assert_material(&a->ludwik, &made.members[i].ludwik);
        assert_close_relative(a->length, b->length, 1e-14);
        assert_close_relative(a->bow, 0.5 * (0.05 - 0.13 * i) * 0.085, 1e-14);
        assert_close_relative(a->bow_deviation, b->bow_deviation, 1e-14);
        assert_close(a->level, b->level, 1e-18);
        assert_close_relative(a->misfit, b->misfit, 1e-14);
        assert_close_relative(a->ludwik_misfit, b->ludwik_misfit, 1e-14);
    }
}

static void an_existing_file_is_kept_without_force(void **state)
{
    (void)state;
    struct made made;
    make(&made);
    assert_int_equal(write_made(&made, true), WB_OK);
    assert_int_equal(write_made(&made, false), WB_ERR_EXISTS);
    assert_message("--force");
}

static void unreadable_properties_are_not_written(void **state)
{
    (void)state;
    struct made made;
    remove(path);
    make(&made);
    made.calibration.residual_curvature_ratio.candidates_high = 1.2;
    assert_true(write_made(&made, true) != WB_OK);
    assert_message("candidates_high");
    assert_false(wb_file_exists(path));
    make(&made);
    made.calibration.ludwik.yield_stress = 1e-5;
    assert_true(write_made(&made, true) != WB_OK);
    assert_message("yield_stress_MPa");
    assert_false(wb_file_exists(path));
}

static void a_refuted_rule_leaves_only_ranges(void **state)
{
    (void)state;
    struct made made;
    struct wb_properties read;
    make(&made);
    made.calibration.is_followed = false;
    read_back(&made, &read);
    assert_false(read.is_rule_supported);
    assert_true(read.is_rule_tested);
    assert_true(isnan(read.rigidity.value) && isnan(read.rigidity.low));
    assert_close_relative(read.rigidity.candidates_high, 1.11 * 3e-4, 1e-12);
    assert_true(isnan(read.moment[0].value));
    assert_close_relative(read.moment[0].candidates_low, 0.98e-3, 1e-12);
}

static struct wb_json *put(const struct made *made)
{
    struct wb_json *const root = wb_json_create(), *read;
    wb_cycle_json_put(root, &made->calibration);
    char *const text = wb_json_format(root);
    wb_json_destroy(root);
    assert_int_equal(wb_json_parse(&read, text, "text"), WB_OK);
    free(text);
    return read;
}

/* The laws that were not tried may follow better. */
static void a_stopped_calibration_leaves_the_rule_untested(void **state)
{
    (void)state;
    struct made made;
    struct wb_properties read;
    char *text;
    make(&made);
    made.calibration.is_stopped = true;
    made.calibration.is_followed = false;
    read_back(&made, &read);
    assert_false(read.is_rule_tested || read.is_rule_supported);
    assert_true(isnan(read.rigidity.value));
    assert_int_equal(wb_file_read(path, &text, NULL), WB_OK);
    assert_non_null(strstr(text, "  stopped: interrupted"));
    free(text);
    struct wb_json *const root = put(&made);
    bool is_stopped = false;
    assert_true(wb_json_get_boolean(wb_json_get(root, "hardening_rule"), "stopped", &is_stopped));
    assert_true(is_stopped);
    wb_json_destroy(root);
}

static void without_unloading_the_residual_curvature_ratio_is_absent(void **state)
{
    (void)state;
    struct made made;
    struct wb_properties read;
    make(&made);
    made.calibration.has_unloading = made.calibration.is_followed = false;
    read_back(&made, &read);
    assert_false(read.is_rule_tested);
    assert_close_relative(read.rigidity.value, 3e-4, 1e-12);
    assert_true(isnan(read.residual_curvature_ratio.value) &&
                isnan(read.residual_curvature_ratio.candidates_low));
}

static void kinematic_ludwik_keeps_its_four_numbers(void **state)
{
    (void)state;
    struct made made;
    struct wb_properties read;
    make(&made);
    wb_law_init_ludwik(&made.calibration.law, &ludwik);
    made.calibration.law.isotropic_share = 0.0;
    read_back(&made, &read);
    assert_int_equal(read.law.form, WB_LAW_LUDWIK);
    assert_close(read.law.isotropic_share, 0.0, 0.0);
    assert_material(&read.law.material, &ludwik);
    made.calibration.law.isotropic_share = 1.0;
    read_back(&made, &read);
    assert_true(wb_law_is_plain(&read.law));
    assert_material(&read.law.material, &ludwik);
}

static void different_lengths_have_no_length_in_common(void **state)
{
    (void)state;
    struct made made;
    struct wb_properties read;
    make(&made);
    made.members[1].data.info.length = 0.1;
    read_back(&made, &read);
    assert_true(isnan(read.calibration_length));
    assert_close_relative(read.specimens[1].length, 0.1, 1e-14);
}

/* --- refusals --- */

/* The written file with the first `from` replaced by `to` is refused with all of `expected`. */
static void assert_refused(const char *whole, const char *from, const char *to,
                           const char *expected)
{
    struct wb_text text = {0};
    struct wb_properties read;
    char line[32];
    const char *const at = strstr(whole, from);
    int number = 1;
    if (!at)
        fail_msg("no '%s' in the file", from);
    for (const char *c = whole; c < at + strspn(from, "\n"); c++)
        number += *c == '\n';
    wb_text_append_bytes(&text, whole, (size_t)(at - whole));
    wb_text_append(&text, "%s%s", to, at + strlen(from));
    assert_int_equal(wb_file_write(path, wb_text_string(&text), text.length), WB_OK);
    wb_text_release(&text);
    assert_int_equal(wb_properties_read(path, &read), WB_ERR_FORMAT);
    assert_message(expected);
    snprintf(line, sizeof line, "properties.yaml:%d", number);
    assert_message(line);
}

static void errors_are_reported_with_line_and_key(void **state)
{
    (void)state;
    static const struct {
        const char *from, *to, *expected;
    } wrong[] = {
        {"method: cycle", "method: circle", "method"},
        {"hardening: mixed", "hardening: odd", "hardening"},
        {"yield_strain: 0.0013", "yield_strain: -1", "yield_strain"},
        {"largest_curvature_1_m: 29", "largest_curvature_1_m: 29 1/m", "largest_curvature_1_m"},
        {"residual_curvature_ratio: {value: 0.27", "residual_curvature_ratio: {value: 1.27",
         "value"},
        {"residual_curvature_ratio: {value", "residual_curvature_ratio: {colour", "colour"},
        {"\n  - {curvature_1_m: 29", "\n  - {curvature_1_m: 1", "curvature_1_m"},
        {"tested: true", "tested: maybe", "tested"},
        {"\n  - sample: 2", "\n  - sample: -2", "sample"},
        {"\n    bow_mm: ", "\n    bow_mm: nan #", "bow_mm"},
        {"\n    bow_mm: ", "\n    colour: ", "colour"},
        {"ludwik_misfit: 0.012", "ludwik_misfit: -0.012", "ludwik_misfit"},
    };
    struct made made;
    char *whole;
    make(&made);
    assert_int_equal(write_made(&made, true), WB_OK);
    assert_int_equal(wb_file_read(path, &whole, NULL), WB_OK);
    for (size_t i = 0; i < WB_COUNT(wrong); i++)
        assert_refused(whole, wrong[i].from, wrong[i].to, wrong[i].expected);
    free(whole);
}

/* Every cut of the file and every line left out is either read or refused with one message. */
static void damaged_files_are_read_or_rejected(void **state)
{
    (void)state;
    struct made made;
    struct wb_properties read;
    char *whole;
    int refused = 0;
    make(&made);
    assert_int_equal(write_made(&made, true), WB_OK);
    assert_int_equal(wb_file_read(path, &whole, NULL), WB_OK);
    for (char *line = whole; *line;) {
        const size_t length = strcspn(line, "\n") + 1;
        struct wb_text text = {0};
        wb_text_append_bytes(&text, whole, (size_t)(line - whole));
        wb_text_append(&text, "%s", line + length);
        assert_int_equal(wb_file_write(path, wb_text_string(&text), text.length), WB_OK);
        wb_text_release(&text);
        keep_messages();
        const enum wb_status status = wb_properties_read(path, &read);
        assert_int_equal(kept.n, status != WB_OK);
        assert_int_equal(wb_file_write(path, whole, (size_t)(line - whole) + length / 2), WB_OK);
        refused += wb_properties_read(path, &read) != WB_OK;
        line += length;
    }
    assert_true(refused > 10);
    free(whole);
}

/* --- JSON --- */

static double number_at(const struct wb_json *object, const char *key)
{
    double value = (double)NAN;
    (void)wb_json_get_number(object, key, &value);
    return value;
}

static void json_has_the_same_numbers(void **state)
{
    (void)state;
    struct made made;
    make(&made);
    struct wb_json *const root = put(&made);
    const struct wb_json *const rigidity = wb_json_get(root, "flexural_rigidity_N_mm2");
    assert_close_relative(number_at(rigidity, "value"), 300.0, 1e-12);
    assert_close_relative(number_at(rigidity, "low"), 285.0, 1e-12);
    assert_close_relative(number_at(rigidity, "candidates_high"), 333.0, 1e-12);
    const struct wb_json *const moments = wb_json_get(root, "moment_curvature");
    assert_int_equal(wb_json_length(moments), WB_CYCLE_MOMENTS);
    const struct wb_json *const last = wb_json_item(moments, WB_CYCLE_MOMENTS - 1);
    assert_close_relative(number_at(last, "curvature_1_m"), 29.0, 1e-12);
    assert_close_relative(number_at(last, "moment_N_mm"), 5.0, 1e-12);
    assert_close_relative(number_at(last, "high"), 5.3, 1e-12);
    const struct wb_json *const rule = wb_json_get(root, "hardening_rule");
    const char *chosen = "";
    bool supported = false;
    assert_true(wb_json_get_text(rule, "chosen", &chosen));
    assert_string_equal(chosen, "parallel parts, mixed");
    assert_true(wb_json_get_boolean(rule, "supported", &supported) && supported);
    assert_int_equal(wb_json_length(wb_json_get(rule, "ranked")), 2);
    const struct wb_json *const specimens = wb_json_get(root, "specimens");
    assert_int_equal(wb_json_length(specimens), SPECIMENS);
    const struct wb_json *const own = wb_json_get(wb_json_item(specimens, 1), "ludwik_equivalent");
    assert_close_relative(number_at(own, "youngs_modulus_MPa"), 4400.0, 1e-12);
    wb_json_destroy(root);
}

static void json_omits_unknown_results(void **state)
{
    (void)state;
    struct made made;
    make(&made);
    made.calibration.is_followed = false;
    struct wb_json *root = put(&made);
    const struct wb_json *rigidity = wb_json_get(root, "flexural_rigidity_N_mm2");
    assert_true(isnan(number_at(rigidity, "value")) && isnan(number_at(rigidity, "high")));
    assert_close_relative(number_at(rigidity, "candidates_low"), 294.0, 1e-12);
    wb_json_destroy(root);

    made.calibration.has_unloading = false;
    root = put(&made);
    rigidity = wb_json_get(root, "flexural_rigidity_N_mm2");
    assert_close_relative(number_at(rigidity, "value"), 300.0, 1e-12);
    const struct wb_json *const residual_curvature_ratio =
        wb_json_get(root, "residual_curvature_ratio");
    assert_true(isnan(number_at(residual_curvature_ratio, "value")));
    assert_true(isnan(number_at(residual_curvature_ratio, "candidates_low")));
    wb_json_destroy(root);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_file_has_what_the_calibration_had),
        cmocka_unit_test(an_existing_file_is_kept_without_force),
        cmocka_unit_test(unreadable_properties_are_not_written),
        cmocka_unit_test(a_refuted_rule_leaves_only_ranges),
        cmocka_unit_test(a_stopped_calibration_leaves_the_rule_untested),
        cmocka_unit_test(without_unloading_the_residual_curvature_ratio_is_absent),
        cmocka_unit_test(kinematic_ludwik_keeps_its_four_numbers),
        cmocka_unit_test(different_lengths_have_no_length_in_common),
        cmocka_unit_test(errors_are_reported_with_line_and_key),
        cmocka_unit_test(damaged_files_are_read_or_rejected),
        cmocka_unit_test(json_has_the_same_numbers),
        cmocka_unit_test(json_omits_unknown_results),
    };
    return cmocka_run_group_tests(tests, make_path, remove_folder);
}
