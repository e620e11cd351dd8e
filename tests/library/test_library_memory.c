/* Every failing allocation of the project ends a call of the library with its status: the process
 * continues, and the next call works. The linker redirects allocations here (--wrap); those of
 * other libraries do not fail. */
#include <gsl/gsl_errno.h>

#include "base/memory.h"
#include "include/wirebench.h"
#include "tests/check.h"
#include "tests/fe/allocations.h"

/* Interface of the leak sanitizer, if present: memory owned by a failed call is leaked. */
void __lsan_disable(void) __attribute__((weak));
void __lsan_enable(void) __attribute__((weak));

static const char *dataset_folder;

struct things {
    struct wirebench_properties *wire;
    struct wirebench_dataset *dataset;
};

static enum wirebench_status create(struct things *things)
{
    const struct wirebench_law law = {.size = sizeof law,
                                      .outer_diameter = 1.1e-3,
                                      .poissons_ratio = 0.3,
                                      .youngs_modulus = 5e9,
                                      .yield_stress = 4e6,
                                      .strength_coefficient = 1.3e9,
                                      .hardening_exponent = 0.9};
    struct wirebench_properties *wire = NULL;
    const enum wirebench_status status = wirebench_properties_create(&wire, &law);
    assert_true((status == WIREBENCH_OK) == (wire != NULL));
    wirebench_properties_destroy(wire);
    (void)things;
    return status;
}

static enum wirebench_status bend(struct things *things)
{
    struct wirebench_bending bending = {.size = sizeof bending};
    return wirebench_bend(things->wire, 30.0, &bending);
}

static enum wirebench_status solve(struct things *things)
{
    const double deflection[] = {5e-3, 10e-3, 0.0};
    double force[3];
    const struct wirebench_cantilever test = {.size = sizeof test, .length = 0.085};
    struct wirebench_cantilever_result result = {.size = sizeof result, .force = force};
    return wirebench_solve_cantilever(things->wire, &test, 3, deflection, &result);
}

static enum wirebench_status solve_three_point(struct things *things)
{
    const double deflection[] = {1e-3, 2e-3, 0.0};
    double force[3];
    const struct wirebench_three_point test = {.size = sizeof test, .span = 0.04};
    struct wirebench_three_point_result result = {.size = sizeof result, .force = force};
    return wirebench_solve_three_point(things->wire, &test, 3, deflection, &result);
}

static enum wirebench_status read_dataset(struct things *things)
{
    struct wirebench_dataset *dataset = NULL;
    const enum wirebench_status status = wirebench_dataset_read(&dataset, dataset_folder);
    wirebench_dataset_close(dataset);
    (void)things;
    return status;
}

static enum wirebench_status calibrate(struct things *things)
{
    static const char *const options[] = {"max-iterations=2", "elements=8", "step-mm=2", NULL};
    const struct wirebench_dataset *const dataset = things->dataset;
    const struct wirebench_calibration calibration = {.size = sizeof calibration,
                                                      .method = WIREBENCH_METHOD_PAPER,
                                                      .options = options,
                                                      .threads = 2};
    struct wirebench_properties *properties = NULL;
    const enum wirebench_status status =
        wirebench_calibrate(&properties, &dataset, 1, &calibration);
    wirebench_properties_destroy(properties);
    return status;
}

static struct wirebench_harness *coarse_harness(enum wirebench_status *status)
{
    const struct wirebench_harness_settings settings = {
        .size = sizeof settings, .is_elastic = 1, .element_length = 0.1};
    struct wirebench_harness *harness = NULL;
    *status = wirebench_harness_read(&harness, "small", &settings);
    return harness;
}

static const struct wirebench_harness_step hang = {.size = sizeof hang, .kind = WIREBENCH_HANG};

static enum wirebench_status step_harness(struct things *things)
{
    const struct wirebench_table *table;
    enum wirebench_status status;
    struct wirebench_harness *const harness = coarse_harness(&status);
    if (status == WIREBENCH_OK)
        status = wirebench_harness_take_step(harness, &hang);
    if (status == WIREBENCH_OK)
        status = wirebench_harness_table(harness, "shapes", &table);
    wirebench_harness_destroy(harness);
    (void)things;
    return status;
}

static void set_up(struct things *things)
{
    const struct wirebench_law law = {
        .size = sizeof law, .outer_diameter = 1.1e-3, .poissons_ratio = 0.3, .youngs_modulus = 5e9};
    *things = (struct things){0};
    assert_int_equal(wirebench_properties_create(&things->wire, &law), WIREBENCH_OK);
    assert_int_equal(wirebench_dataset_read(&things->dataset, dataset_folder), WIREBENCH_OK);
}

static void each_call_without_memory_returns_its_status(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        enum wirebench_status (*call)(struct things *things);
        int least, stride; /* fewest failures expected; only every stride-th of many allocations is
                              tried */
    } cases[] = {
        {"properties", create, 1, 1},       {"bend", bend, 1, 1},
        {"cantilever", solve, 5, 1},        {"three points", solve_three_point, 5, 1},
        {"dataset", read_dataset, 20, 149}, {"calibrate", calibrate, 20, 2},
        {"harness", step_harness, 20, 5},
    };
    struct things things;
    set_up(&things);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        fail_at = 0;
        const enum wirebench_status without = cases[i].call(&things);
        if (without < WIREBENCH_OK)
            fail_msg("%s: %s", cases[i].name, wirebench_message());
        int failures = 0;
        for (int at = 1;; at += cases[i].stride) {
            allocations = 0;
            fail_at = at;
            const enum wirebench_status status = cases[i].call(&things);
            const bool did_fail = allocations >= at;
            fail_at = 0;
            if (!did_fail) {
                assert_int_equal(status, without);
                break;
            }
            if (status != WIREBENCH_ERR_MEMORY || !wirebench_message()[0])
                fail_msg("%s, allocation %d: status %d: '%s'", cases[i].name, at, (int)status,
                         wirebench_message());
            if (wb_memory_is_guarded())
                fail_msg("%s, allocation %d: a guard is left", cases[i].name, at);
            failures++;
        }
        if (failures < cases[i].least)
            fail_msg("%s: only %d allocations", cases[i].name, failures);
        if (cases[i].call(&things) != without)
            fail_msg("%s: the next call fails: %s", cases[i].name, wirebench_message());
    }
    wirebench_properties_destroy(things.wire);
    wirebench_dataset_close(things.dataset);
}

/* Without memory for a step nothing has changed; without memory for a table it is made later. */
static void a_harness_goes_on_after_a_call_without_memory(void **state)
{
    (void)state;
    enum wirebench_status status;
    const struct wirebench_table *table = NULL;
    struct wirebench_harness_info info = {.size = sizeof info};
    struct wirebench_harness *const harness = coarse_harness(&status);
    for (int at = 1; at <= 2; at++) {
        allocations = 0;
        fail_at = at;
        assert_int_equal(wirebench_harness_take_step(harness, &hang), WIREBENCH_ERR_MEMORY);
        allocations = 0;
        assert_int_equal(wirebench_harness_table(harness, "shapes", &table), WIREBENCH_ERR_MEMORY);
        fail_at = 0;
    }
    assert_int_equal(wirebench_harness_describe(harness, &info), WIREBENCH_OK);
    assert_int_equal(info.state, 0);
    assert_int_equal(wirebench_harness_take_step(harness, &hang), WIREBENCH_OK);
    assert_int_equal(wirebench_harness_table(harness, "shapes", &table), WIREBENCH_OK);
    assert_true(wirebench_table_rows(table) > 10);
    assert_int_equal(wirebench_harness_undo(harness, 1), WIREBENCH_OK);
    wirebench_harness_destroy(harness);
}

static void gsls_handler_is_restored(void **state)
{
    (void)state;
    struct things things;
    set_up(&things);
    gsl_error_handler_t *const mine = gsl_set_error_handler_off();
    gsl_set_error_handler(mine);
    int failures = 0;
    for (int at = 1; at < 60; at += 10) {
        allocations = 0;
        fail_at = at;
        failures += calibrate(&things) == WIREBENCH_ERR_MEMORY;
        fail_at = 0;
        gsl_error_handler_t *const after = gsl_set_error_handler(mine);
        assert_true(after == mine);
    }
    assert_true(failures > 3);
    wirebench_properties_destroy(things.wire);
    wirebench_dataset_close(things.dataset);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_call_without_memory_returns_its_status),
        cmocka_unit_test(a_harness_goes_on_after_a_call_without_memory),
        cmocka_unit_test(gsls_handler_is_restored),
    };
    if (argc != 2)
        return 2;
    dataset_folder = argv[1];
    if (__lsan_disable)
        __lsan_disable();
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    if (__lsan_enable)
        __lsan_enable();
    return failed;
}
