/* What a run has in place of values of its bundle's file. */
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "fe/model/bundle_override_private.h"
#include "tests/messages.h"

static void make_model(struct wb_bundle_model *model)
{
    memset(model, 0, sizeof *model);
    strcpy(model->path, "some.yaml");
    model->n_meshes = 2;
    strcpy(model->mesh[0].name, "coarse");
    strcpy(model->mesh[1].name, "fine");
    strcpy(model->run.mesh, "coarse");
    model->run.mass_scaling = 25.0;
    model->run.selective = 1.0;
    model->run.deflection = 0.053;
    model->run.rows = 53;
    model->length = 0.114;
    model->length_source = WB_BUNDLE_LENGTH_PRINTED;
    model->potted_length = 0.003;
    model->loads = (struct wb_bundle_loads){.strand_length = 0.76, .weight = true};
    model->interface = (struct wb_bundle_interface){
        .normal_stiffness = 30e9,
        .shear_stiffness = 10e9,
        .friction.mu_static = 0.4,
        .friction.mu_kinetic = 0.1,
        .friction.decay = 2e3,
    };
}

static void an_empty_one_changes_nothing(void **unused)
{
    (void)unused;
    static struct wb_bundle_model model, before;
    const struct wb_bundle_override override = {0};
    make_model(&model);
    before = model;
    assert_true(wb_bundle_override_is_empty(&override));
    assert_int_equal(wb_bundle_override_apply(&override, &model), WB_OK);
    assert_memory_equal(&model, &before, sizeof model);
}

static void all_of_it_reaches_the_model(void **unused)
{
    (void)unused;
    static struct wb_bundle_model model;
    const struct wb_bundle_override override = {
        .dead_force = true,
        .no_weight = true,
        .length = 0.08,
        .run = {.mesh = "fine",
                .duration = 1.5,
                .mass_scaling = 100.0,
                .selective = 50.0,
                .deflection = 0.02,
                .rows = 4,
                .cycles = 2},
        .interface = {.has_friction = true,
                      .friction.mu_static = 0.3,
                      .friction.mu_kinetic = 0.3,
                      .normal_stiffness = 60e9},
    };
    make_model(&model);
    assert_false(wb_bundle_override_is_empty(&override));
    assert_int_equal(wb_bundle_override_apply(&override, &model), WB_OK);
    assert_string_equal(model.run.mesh, "fine");
    assert_close(model.loads.strand_length, 0.0, 0.0);
    assert_false(model.loads.weight);
    assert_close(model.run.duration, 1.5, 0.0);
    assert_close(model.run.mass_scaling, 100.0, 0.0);
    assert_close(model.run.selective, 50.0, 0.0);
    assert_close(model.run.deflection, 0.02, 0.0);
    assert_int_equal(model.run.rows, 4);
    assert_int_equal(model.run.cycles, 2);
    assert_close(model.length, 0.08, 0.0);
    assert_int_equal(model.length_source, WB_BUNDLE_LENGTH_OWN);
    assert_close(model.interface.friction.mu_static, 0.3, 0.0);
    assert_close(model.interface.friction.mu_kinetic, 0.3, 0.0);
    assert_close(model.interface.friction.decay, 0.0, 0.0);
    assert_close(model.interface.normal_stiffness, 60e9, 0.0);
    assert_close_relative(model.interface.shear_stiffness, 20e9, 1e-15);
}

static void friction_of_zero_is_an_override(void **unused)
{
    (void)unused;
    static struct wb_bundle_model model;
    const struct wb_bundle_override override = {.interface = {.has_friction = true}};
    make_model(&model);
    assert_false(wb_bundle_override_is_empty(&override));
    assert_int_equal(wb_bundle_override_apply(&override, &model), WB_OK);
    assert_close(model.interface.friction.mu_static, 0.0, 0.0);
    assert_close(model.interface.friction.decay, 0.0, 0.0);
}

static void what_is_out_of_range_is_refused_and_changes_nothing(void **unused)
{
    (void)unused;
    static const struct wb_bundle_override bad[] = {
        {.interface = {.has_friction = true, .friction.mu_static = -0.1}},
        {.interface = {.has_friction = true, .friction.mu_static = 11.0}},
        {.interface = {.has_friction = true,
                       .friction.mu_static = 0.1,
                       .friction.mu_kinetic = 0.2}},
        {.interface = {.has_friction = true, .friction.decay = -1.0}},
        {.interface = {.normal_stiffness = -1.0}},
        {.no_weight = true, .run = {.mass_scaling = 0.5}, .interface = {.normal_stiffness = 60e9}},
        {.dead_force = true, .run = {.selective = 0.99}},
        {.run = {.duration = -1.0}},
        {.run = {.duration = (double)NAN}},
        {.length = 0.05},
        {.run = {.deflection = 0.114}},
        {.length = 0.1, .run = {.deflection = 0.1}},
        {.length = 0.006, .run = {.deflection = 0.001}},
        {.length = -1.0},
        {.run = {.rows = -1}},
        {.run = {.cycles = 1001}},
    };
    static struct wb_bundle_model model, before;
    make_model(&model);
    before = model;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_int_equal(wb_bundle_override_apply(&bad[i], &model), WB_ERR_ARGUMENT);
        assert_memory_equal(&model, &before, sizeof model);
    }
    const struct wb_bundle_override other = {.dead_force = true, .run = {.mesh = "none"}};
    assert_int_equal(wb_bundle_override_apply(&other, &model), WB_ERR_ARGUMENT);
    assert_memory_equal(&model, &before, sizeof model);
}

/* Strength 3 MPa with 30 N/mm3: 0.15 N/mm until there, with 3 N/mm3 1.5. */
static void damage_has_to_soften_with_the_new_stiffness(void **unused)
{
    (void)unused;
    static struct wb_bundle_model model;
    struct wb_bundle_override override = {.interface = {.normal_stiffness = 3e9}};
    make_model(&model);
    model.interface.has_damage = true;
    model.interface.damage = (struct wb_bundle_damage){
        .strength = 3e6, .shear_strength = 1e6, .fracture_energy = 1400.0};
    assert_int_equal(wb_bundle_override_apply(&override, &model), WB_ERR_ARGUMENT);
    assert_close(model.interface.normal_stiffness, 30e9, 0.0);
    override.interface.normal_stiffness = 4e9;
    assert_int_equal(wb_bundle_override_apply(&override, &model), WB_OK);
    /* In shear 10 N/mm3 becomes 1.33: 1.5 N/mm until 2 MPa. */
    make_model(&model);
    model.interface.has_damage = true;
    model.interface.damage = (struct wb_bundle_damage){
        .strength = 1e6, .shear_strength = 2e6, .fracture_energy = 1400.0};
    assert_int_equal(wb_bundle_override_apply(&override, &model), WB_ERR_ARGUMENT);
}

/* --- of a file --- */

static const char source[] = "name: twelve\nwires: [{wire: type3, count: 12}]\npacking: triangle\n"
                             "tape: tape\ntaping: {layout: sleeve, layers: 2}\nlength_mm: 114\n"
                             "interface: {cohesive_stiffness_N_mm3: 30, friction: 0.4}\n"
                             "loads: {weight: false}\n";
static char path[64];

static int write_file(void **unused)
{
    (void)unused;
    snprintf(path, sizeof path, "/tmp/test_bundle_override-%d.yaml", (int)getpid());
    return wb_file_write(path, source, strlen(source)) == WB_OK ? 0 : -1;
}

static int remove_file(void **unused)
{
    (void)unused;
    return remove(path);
}

static void packing_and_tape_are_those_that_are_given(void **unused)
{
    (void)unused;
    static struct wb_bundle_model model, plain;
    struct wb_bundle_override override = {
        .packing = 1 + WB_BUNDLE_DENSEST, .layers = 1, .run = {.rows = 7}};
    assert_int_equal(wb_bundle_override_read(&plain, path, NULL, NULL), WB_OK);
    assert_int_equal(wb_bundle_override_read(&model, path, &override, NULL), WB_OK);
    assert_int_equal(model.arrangement, WB_BUNDLE_DENSEST);
    assert_true(wb_bundle_model_diameter(&model) < wb_bundle_model_diameter(&plain) - 1e-6);
    assert_close_relative(wb_taping_thickness(&model.tape.taping),
                          0.5 * wb_taping_thickness(&plain.tape.taping), 1e-12);
    assert_int_equal(model.run.rows, 7);
    override = (struct wb_bundle_override){.bond = {.is_given = true, .reach = 1e-5}};
    assert_int_equal(wb_bundle_override_read(&model, path, &override, NULL), WB_OK);
    assert_false(model.tape.round);
    assert_close(model.tape.reach, 1e-5, 0.0);
    override = (struct wb_bundle_override){.outline = 2, .bond = {.is_given = true}};
    assert_int_equal(wb_bundle_override_read(&model, path, &override, NULL), WB_OK);
    assert_true(model.tape.round);
    assert_close(model.tape.reach, 0.0, 0.0);
}

static void a_variant_has_precedence(void **unused)
{
    (void)unused;
    static struct wb_bundle_model model;
    const struct wb_bundle_override override = {
        .packing = 1 + WB_BUNDLE_DENSEST, .layers = 1, .outline = 2, .bond = {.is_given = true}};
    const struct wb_bundle_variant variant = {.name = "thick", .layers = 3};
    assert_int_equal(wb_bundle_override_read(&model, path, &override, &variant), WB_OK);
    assert_close(model.tape.taping.layers, 3.0, 0.0);
    assert_int_equal(model.arrangement, WB_BUNDLE_DENSEST);
    assert_true(model.tape.round);
}

static void what_the_bundle_cannot_have_is_refused(void **unused)
{
    (void)unused;
    static struct wb_bundle_model model;
    static const struct wb_bundle_override bad[] = {
        {.packing = 1 + WB_BUNDLE_HEXAGON},
        {.layers = 21},
        {.bond = {.is_given = true, .reach = 2e-3}},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        keep_messages();
        assert_int_not_equal(wb_bundle_override_read(&model, path, &bad[i], NULL), WB_OK);
        assert_int_equal(kept.n, 1);
        wb_log_set_sink(NULL, NULL);
    }
    const struct wb_bundle_override circle = {.outline = 2};
    keep_messages();
    assert_int_not_equal(wb_bundle_override_read(&model, path, &circle, NULL), WB_OK);
    assert_non_null(strstr(kept.last, "--bond-reach-mm"));
    wb_log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_empty_one_changes_nothing),
        cmocka_unit_test(all_of_it_reaches_the_model),
        cmocka_unit_test(friction_of_zero_is_an_override),
        cmocka_unit_test(what_is_out_of_range_is_refused_and_changes_nothing),
        cmocka_unit_test(damage_has_to_soften_with_the_new_stiffness),
        cmocka_unit_test(packing_and_tape_are_those_that_are_given),
        cmocka_unit_test(a_variant_has_precedence),
        cmocka_unit_test(what_the_bundle_cannot_have_is_refused),
    };
    return cmocka_run_group_tests(tests, write_file, remove_file);
}
