/* What a run has in place of values of its bundle's file. */
#include "fe/model/bundle_override.h"

#include <string.h>

#include "tests/check.h"

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
    model->loads = (struct wb_bundle_loads){.strand_length = 0.76, .weight = true};
    model->interface = (struct wb_bundle_interface){
        .normal_stiffness = 30e9,
        .shear_stiffness = 10e9,
        .friction_static = 0.4,
        .friction_kinetic = 0.1,
        .friction_decay = 2e3,
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
        .run = {.mesh = "fine", .duration = 1.5, .mass_scaling = 100.0, .selective = 50.0},
        .interface = {.has_friction = true,
                      .friction_static = 0.3,
                      .friction_kinetic = 0.3,
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
    assert_close(model.interface.friction_static, 0.3, 0.0);
    assert_close(model.interface.friction_kinetic, 0.3, 0.0);
    assert_close(model.interface.friction_decay, 0.0, 0.0);
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
    assert_close(model.interface.friction_static, 0.0, 0.0);
    assert_close(model.interface.friction_decay, 0.0, 0.0);
}

static void what_is_out_of_range_is_refused_and_changes_nothing(void **unused)
{
    (void)unused;
    static const struct wb_bundle_override bad[] = {
        {.interface = {.has_friction = true, .friction_static = -0.1}},
        {.interface = {.has_friction = true, .friction_static = 11.0}},
        {.interface = {.has_friction = true, .friction_static = 0.1, .friction_kinetic = 0.2}},
        {.interface = {.has_friction = true, .friction_decay = -1.0}},
        {.interface = {.normal_stiffness = -1.0}},
        {.no_weight = true, .run = {.mass_scaling = 0.5}, .interface = {.normal_stiffness = 60e9}},
        {.dead_force = true, .run = {.selective = 0.99}},
        {.run = {.duration = -1.0}},
        {.run = {.duration = (double)NAN}},
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_empty_one_changes_nothing),
        cmocka_unit_test(all_of_it_reaches_the_model),
        cmocka_unit_test(friction_of_zero_is_an_override),
        cmocka_unit_test(what_is_out_of_range_is_refused_and_changes_nothing),
        cmocka_unit_test(damage_has_to_soften_with_the_new_stiffness),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
