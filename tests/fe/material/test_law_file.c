#include "fe/material/law_file.h"

#include <math.h>

#include "base/units.h"
#include "tests/check.h"
#include "tests/messages.h"

static const struct wb_material ludwik = {
    WB_HARDENING_ISOTROPIC_POWER, 5641e6, 0.39, 4.95e6, 850e6, 0.78};

static enum wb_status read_text(const char *text, const struct wb_material *material,
                                struct wb_law *law)
{
    struct wb_config *config;
    const struct wb_config_node *node = NULL;
    assert_int_equal(wb_config_parse(&config, text, "wire.yaml", NULL), WB_OK);
    const struct wb_config_key keys[] = {WB_CONFIG_OPTIONAL_NODE("law", &node)};
    assert_int_equal(wb_config_map(wb_config_root(config), keys, WB_COUNT(keys)), WB_OK);
    const enum wb_status status = wb_law_file_read(node, material, law);
    wb_config_destroy(config);
    return status;
}

static void without_a_block_the_law_is_the_papers(void **unused)
{
    (void)unused;
    struct wb_law law;
    assert_int_equal(wb_law_file_read(NULL, &ludwik, &law), WB_OK);
    assert_true(wb_law_is_plain(&law));
    assert_memory_equal(&law.material, &ludwik, sizeof ludwik);
}

static void what_is_written_reads_back_the_same(void **unused)
{
    (void)unused;
    const struct wb_law_part parts[] = {
        {2.6123456789e9, 1.2e-4}, {1.5e9, 8.123456789e-4}, {0.35e9, (double)INFINITY}};
    static const double shares[] = {0.0, 1.0 / 3.0, 1.0};
    for (int form = 0; form < 2; form++) {
        for (int i = 0; i < 3; i++) {
            struct wb_law law, back;
            struct wb_text text = {0};
            if (form)
                wb_law_init_parallel(&law, parts, 3, shares[i], 0.39);
            else
                wb_law_init_ludwik(&law, &ludwik);
            law.isotropic_share = shares[i];
            wb_law_file_append(&text, &law);
            if (wb_law_is_plain(&law)) {
                assert_int_equal(text.length, 0);
                continue;
            }
            assert_int_equal(read_text(wb_text_string(&text), &ludwik, &back), WB_OK);
            assert_int_equal(back.form, law.form);
            assert_true(back.isotropic_share == law.isotropic_share);
            assert_int_equal(back.n_parts, law.n_parts);
            for (int k = 0; k < law.n_parts; k++) {
                assert_close_relative(back.parts[k].modulus, law.parts[k].modulus, 1e-15);
                assert_true(back.parts[k].yield_strain == law.parts[k].yield_strain);
            }
            assert_close_relative(back.material.youngs_modulus, law.material.youngs_modulus, 1e-14);
            wb_text_release(&text);
        }
    }
}

static void combined_hardening_reads_back_the_same(void **unused)
{
    (void)unused;
    const struct wb_material elastic = {
        .youngs_modulus = 4.5123456789e9, .poissons_ratio = 0.39, .yield_stress = 2.1e6 / 3.0};
    const struct wb_law_back backs[] = {{2.6e9 / 7.0, 900.0 / 7.0}, {1e8, 0.0}};
    const struct wb_law_part parts[] = {{1e9 / 3.0, 1e-3}, {3e9, (double)INFINITY}};
    for (int i = 0; i < 5; i++) {
        struct wb_law law, back;
        struct wb_text text = {0};
        if (i < 3) {
            wb_law_init_chaboche(&law, &elastic, 1.4e6 / 3.0, 1000.0 / 3.0, backs, i);
        } else if (i == 3) {
            wb_law_init_ludwik(&law, &ludwik);
            law.isotropic_share = 1.0 / 3.0;
            law.is_combined = true;
        } else {
            wb_law_init_parallel(&law, parts, 2, 1.0 / 7.0, ludwik.poissons_ratio);
            law.is_combined = true;
        }
        wb_law_file_append(&text, &law);
        assert_int_equal(read_text(wb_text_string(&text), &ludwik, &back), WB_OK);
        assert_int_equal(back.form, law.form);
        assert_true(back.is_combined);
        assert_close_relative(back.isotropic_share, law.isotropic_share, 1e-15);
        assert_close_relative(back.material.youngs_modulus, law.material.youngs_modulus, 1e-15);
        if (law.form != WB_LAW_PARALLEL)
            assert_close_relative(back.material.yield_stress, law.material.yield_stress, 1e-15);
        assert_true(back.material.poissons_ratio == law.material.poissons_ratio);
        assert_close_relative(back.saturation, law.saturation, 1e-15);
        assert_true(back.rate == law.rate && back.n_backs == law.n_backs);
        for (int k = 0; k < law.n_backs; k++) {
            assert_close_relative(back.backs[k].modulus, law.backs[k].modulus, 1e-15);
            assert_true(back.backs[k].recovery == law.backs[k].recovery);
        }
        wb_text_release(&text);
    }
}

static void what_is_no_law_is_refused_with_its_line(void **unused)
{
    (void)unused;
    static const struct {
        const char *text, *message;
    } wrong[] = {
        {"law: {form: parallel, hardening: kinematic}", "parts"},
        {"law: {form: ludwik, hardening: kinematic, parts: [{modulus_MPa: 1}]}", "parts"},
        {"law: {form: ludwik, hardening: mixed}", "isotropic_share"},
        {"law: {form: ludwik, hardening: kinematic, isotropic_share: 0.3}", "isotropic_share"},
        {"law: {form: ludwik}", "hardening"},
        {"law: {form: cubic, hardening: kinematic}", "form"},
        {"law: {form: parallel, hardening: kinematic, parts: []}", "parts"},
        {"law: {form: parallel, hardening: kinematic, parts: [{modulus_MPa: -1}]}", "modulus_MPa"},
        {"law: {form: parallel, hardening: kinematic, parts: [{modulus_MPa: 1}, {modulus_MPa: 1, "
         "yield_strain: 0.1}]}",
         "only the last part"},
        {"law: {form: parallel, hardening: kinematic, parts: [{modulus_MPa: 1, yield_strain: 0.1}, "
         "{modulus_MPa: 1, yield_strain: 0.1}]}",
         "expected more than"},
        {"law: {form: parallel, hardening: combined, isotropic_share: 1, parts: [{modulus_MPa: "
         "1}]}",
         "isotropic_share"},
        {"law: {form: parallel, hardening: combined, parts: [{modulus_MPa: 1}]}",
         "isotropic_share"},
        {"law: {form: ludwik, hardening: combined}", "isotropic_share"},
        {"law: {form: chaboche, hardening: combined}", "chaboche"},
        {"law: {form: chaboche, hardening: kinematic, chaboche: {youngs_modulus_MPa: 1, "
         "yield_stress_MPa: 1}}",
         "hardening"},
        {"law: {form: chaboche, hardening: combined, isotropic_share: 1, chaboche: "
         "{youngs_modulus_MPa: 1, yield_stress_MPa: 1}}",
         "isotropic_share"},
        {"law: {form: ludwik, hardening: isotropic, chaboche: {youngs_modulus_MPa: 1}}",
         "chaboche"},
        {"law: {form: chaboche, hardening: combined, parts: [], chaboche: {youngs_modulus_MPa: 1, "
         "yield_stress_MPa: 1}}",
         "parts"},
        {"law: {form: chaboche, hardening: combined, chaboche: {youngs_modulus_MPa: 1}}",
         "yield_stress_MPa"},
        {"law: {form: chaboche, hardening: combined, chaboche: {youngs_modulus_MPa: 1, "
         "yield_stress_MPa: 1, back_stresses: [{modulus_MPa: 0, recovery: 1}]}}",
         "modulus_MPa"},
        {"law: {form: chaboche, hardening: combined, chaboche: {youngs_modulus_MPa: 1, "
         "yield_stress_MPa: 1, back_stresses: []}}",
         "back_stresses"},
        {"law: {form: ludwik, hardening: isotropic, relaxation: {strain_rate_1_s: 1}}", "elements"},
        {"law: {form: ludwik, hardening: isotropic, relaxation: {elements: []}}", "elements"},
        {"law: {form: ludwik, hardening: isotropic, relaxation: {elements: [{modulus_MPa: 1, "
         "time_s: 0}]}}",
         "time_s"},
        {"law: {form: ludwik, hardening: isotropic, relaxation: {elements: [{modulus_MPa: 1, "
         "time_s: 1}, {modulus_MPa: 1, time_s: 1}, {modulus_MPa: 1, time_s: 1}]}}",
         "elements"},
        {"law: {form: ludwik, hardening: isotropic, relaxation: {strain_rate_1_s: -1, elements: "
         "[{modulus_MPa: 1, time_s: 1}]}}",
         "strain_rate_1_s"},
    };
    struct wb_law law;
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        keep_messages();
        assert_int_not_equal(read_text(wrong[i].text, &ludwik, &law), WB_OK);
        if (!strstr(kept.last, wrong[i].message) || !strstr(kept.last, "wire.yaml:1"))
            fail_msg("'%s' gives '%s', expected '%s' in it", wrong[i].text, kept.last,
                     wrong[i].message);
    }
    struct wb_material steep = ludwik;
    steep.hardening_exponent = 1.2;
    keep_messages();
    assert_int_not_equal(read_text("law: {form: ludwik, hardening: kinematic}", &steep, &law),
                         WB_OK);
    assert_non_null(strstr(kept.last, "at most 1"));
}

static void maxwell_elements_of_any_form_read_back_the_same(void **unused)
{
    (void)unused;
    const struct wb_law_part parts[] = {{2.6e9, 1.2e-4}, {0.35e9, (double)INFINITY}};
    struct wb_law laws[2], back;
    wb_law_init_ludwik(&laws[0], &ludwik);
    wb_law_init_parallel(&laws[1], parts, 2, 0.0, 0.39);
    for (int i = 0; i < 2; i++) {
        struct wb_text text = {0};
        laws[i].n_maxwell = 2;
        laws[i].maxwell[0] = (struct wb_law_maxwell){1.23456789e8, 1.5};
        laws[i].maxwell[1] = (struct wb_law_maxwell){0.0, 1e3 / 3.0};
        laws[i].strain_rate = 2e-4 / 3.0;
        wb_law_file_append(&text, &laws[i]);
        assert_int_equal(read_text(wb_text_string(&text), &ludwik, &back), WB_OK);
        assert_int_equal(back.n_maxwell, 2);
        assert_true(back.strain_rate == laws[i].strain_rate);
        for (int k = 0; k < 2; k++) {
            assert_close(back.maxwell[k].modulus, laws[i].maxwell[k].modulus, 1e-6);
            assert_true(back.maxwell[k].time == laws[i].maxwell[k].time);
        }
        assert_int_equal(wb_law_is_plain(&back), i == 0);
        wb_text_release(&text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(without_a_block_the_law_is_the_papers),
        cmocka_unit_test(what_is_written_reads_back_the_same),
        cmocka_unit_test(combined_hardening_reads_back_the_same),
        cmocka_unit_test(maxwell_elements_of_any_form_read_back_the_same),
        cmocka_unit_test(what_is_no_law_is_refused_with_its_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
