/* Nothing is allocated while a rod is computed, and running out of memory during creation is an
 * error. */
#include "base/memory.h"
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

struct attempt {
    const struct wb_wire_model *model;
    struct wb_wire1d *wire;
};

static enum wb_status create(void *context)
{
    struct attempt *const attempt = context;
    return wb_wire1d_create(&attempt->wire, attempt->model, NULL);
}

static enum wb_status take_section(void *context)
{
    const struct attempt *const attempt = context;
    int n;
    free(wb_wire1d_section(attempt->wire, 0.01, &n));
    return WB_OK;
}

/* Results of a newly created wire. */
static void compute(struct wb_wire1d *wire, const struct wb_wire_model *model,
                    struct wb_wire_run *run)
{
    assert_int_equal(wb_wire_run_init(run, model, 11), WB_OK);
    assert_int_equal(wb_wire1d_run(wire, run, NULL), WB_OK);
}

static void every_failed_allocation_is_an_error(void **unused)
{
    (void)unused;
    const struct wb_wire_model model = make_model();
    struct attempt attempt = {.model = &model};
    struct wb_wire_run before, after;
    assert_int_equal(create(&attempt), WB_OK);
    compute(attempt.wire, &model, &before);
    wb_wire1d_destroy(attempt.wire);

    wb_log_set_sink(discard_message, NULL);
    int failures = 0;
    for (fail_at = 1;; fail_at++) {
        allocations = 0;
        const enum wb_status status = wb_memory_try(create, &attempt);
        if (status == WB_OK)
            break;
        assert_int_equal(status, WB_ERR_MEMORY);
        assert_int_equal(allocations, fail_at);
        assert_null(attempt.wire);
        failures++;
    }
    assert_true(failures > 20);
    allocations = 0;
    fail_at = 1;
    assert_int_equal(wb_memory_try(take_section, &attempt), WB_ERR_MEMORY);
    fail_at = 0;
    wb_log_set_sink(NULL, NULL);

    compute(attempt.wire, &model, &after);
    assert_int_equal(after.n_rows, before.n_rows);
    for (int i = 0; i < before.n_rows; i++) {
        assert_memory_equal(after.rows[i].tip, before.rows[i].tip, sizeof before.rows[i].tip);
        assert_memory_equal(&after.rows[i].force, &before.rows[i].force, sizeof(double));
    }
    wb_wire_run_release(&before);
    wb_wire_run_release(&after);
    wb_wire1d_destroy(attempt.wire);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stepping_allocates_nothing),
        cmocka_unit_test(every_failed_allocation_is_an_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
