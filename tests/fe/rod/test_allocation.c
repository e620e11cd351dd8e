/* Nothing is allocated while a test is computed. */
#include "fe/trial/loading_steps.h"
#include "tests/fe/allocations.h"
#include "tests/fe/rod/wires.h"

static void stepping_allocates_nothing(void **unused)
{
    (void)unused;
    const struct test_wire wire = test_wire_type(1);
    struct wb_section section = test_section(&wire);
    struct wb_cantilever_model model;
    wb_cantilever_default_model(&model);
    model.section = &section;
    model.length = 0.085;
    model.strand_length = 0.76;
    model.mass_per_length = test_wire_mass(&wire);
    struct wb_cantilever *cantilever = test_cantilever(&model);
    const struct wb_loading_steps_plan plan = {.maximum = 0.053, .steps = 10, .cycles = 2};
    struct wb_loading_steps loading;
    assert_int_equal(wb_loading_steps_init(&loading, &plan), WB_OK);
    assert_true(allocations > 10);

    allocations = 0;
    wb_cantilever_set_materials(cantilever, &wire.material);
    wb_cantilever_reset(cantilever);
    assert_int_equal(wb_loading_steps_run(&loading, &plan, cantilever), WB_OK);
    wb_cantilever_save(cantilever);
    wb_cantilever_restore(cantilever);
    assert_int_equal(allocations, 0);
    assert_int_equal(loading.n_rows, 41);

    wb_loading_steps_release(&loading);
    wb_cantilever_destroy(cantilever);
    wb_section_release(&section);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stepping_allocates_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
