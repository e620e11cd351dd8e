/* Nothing is allocated while a rod is computed, and creating one fails cleanly when memory ends. */
#include "fe/trial/wire1d.h"
#include "tests/fe/allocations.h"
#include "tests/fe/rod/wires.h"

static struct wb_wire_model make_model(void)
{
    const struct test_wire wire = test_wire_type(3);
    struct wb_wire_model model = {
        .length = 0.085,
        .n_parts = 1,
        .part[0] = {.outer_diameter = wire.diameter,
                    .material = wire.material,
                    .density = wire.density},
        .gravity = {0.0, -9.81, 0.0},
        .n_steps = 3,
        .step = {{.loads = {.force = {0.0, 0.1, 0.05}, .moment = {1e-3, 0.0, 0.0}}, .rows = 4},
                 {.kind = WB_WIRE_STEP_DEFLECTION, .deflection = 0.03, .rows = 4},
                 {.kind = WB_WIRE_STEP_RELEASE, .rows = 3}},
    };
    model.step[1].loads = model.step[2].loads = model.step[0].loads;
    return model;
}

static void stepping_allocates_nothing(void **unused)
{
    (void)unused;
    const struct wb_wire_model model = make_model();
    struct wb_wire1d *wire = NULL;
    struct wb_wire_run run;
    assert_int_equal(wb_wire1d_create(&wire, &model, NULL), WB_OK);
    assert_int_equal(wb_wire_run_init(&run, &model, 11), WB_OK);
    assert_true(allocations > 10);
    allocations = 0;
    assert_int_equal(wb_wire1d_run(wire, &run, NULL), WB_OK);
    assert_int_equal(allocations, 0);
    assert_true(run.converged);
    assert_int_equal(run.n_rows, 12);
    wb_wire_run_release(&run);
    wb_wire1d_destroy(wire);
}

static void every_missing_piece_of_memory_is_an_error(void **unused)
{
    (void)unused;
    const struct wb_wire_model model = make_model();
    struct wb_wire1d *wire = NULL;
    wb_log_set_sink(discard_message, NULL);
    int failures = 0;
    for (fail_at = 1;; fail_at++) {
        allocations = 0;
        const enum wb_status status = wb_wire1d_create(&wire, &model, NULL);
        if (status == WB_OK)
            break;
        assert_int_equal(status, WB_ERR_MEMORY);
        assert_null(wire);
        failures++;
    }
    assert_true(failures > 20);
    struct wb_wire1d_fibre *fibres = NULL;
    int n = 0;
    allocations = 0;
    fail_at = 1;
    assert_int_equal(wb_wire1d_section(wire, 0.01, &fibres, &n), WB_ERR_MEMORY);
    assert_null(fibres);
    fail_at = 0;
    wb_log_set_sink(NULL, NULL);
    wb_wire1d_destroy(wire);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stepping_allocates_nothing),
        cmocka_unit_test(every_missing_piece_of_memory_is_an_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
