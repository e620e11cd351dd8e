/* Running out of memory anywhere in the 3D wire is an error, and stepping allocates nothing. */
#include <string.h>

#include "base/memory.h"
#include "fe/trial/wire3d.h"
#include "tests/check.h"
#include "tests/fe/allocations.h"

/* A core in its jacket, bonded or with contact. */
static struct wb_wire_model make_model(bool contact)
{
    const struct wb_material material = {WB_HARDENING_NONE_ELASTIC, 1e9, 0.3, 0.0, 0.0, 0.0};
    struct wb_wire_model model = {
        .length = 0.01,
        .n_parts = 2,
        .part[0] = {.outer_diameter = 1e-3, .material = material},
        .part[1] = {.inner_diameter = 1e-3, .outer_diameter = 1.4e-3, .material = material},
        .wire = {.outer_diameter = 1.4e-3},
        .elements_along = 2,
        .section_density = 1,
        .has_contact = contact,
        .n_steps = 1,
        .step = {{.loads = {.force = {0.0, 1e-3, 0.0}}, .rows = 2}},
    };
    wb_trial_default_jacket_contact(&model.jacket_contact, 1e9, 0.3, 0.2e-3, 0.0);
    return model;
}

struct attempt {
    struct wb_wire_model model;
    struct wb_wire3d *wire;
    struct wb_wire_run run;
    struct wb_wire3d_fields fields;
};

static enum wb_status create(void *context)
{
    struct attempt *const a = context;
    return wb_wire3d_create(&a->wire, &a->model);
}

static enum wb_status init_run(void *context)
{
    struct attempt *const a = context;
    return wb_wire_run_init(&a->run, &a->model, 7);
}

static enum wb_status run(void *context)
{
    struct attempt *const a = context;
    a->run.n_rows = 0;
    return wb_wire3d_run(a->wire, &a->run, NULL);
}

static enum wb_status take_fields(void *context)
{
    struct attempt *const a = context;
    wb_wire3d_fields(a->wire, &a->fields);
    return WB_OK;
}

/* Lets each allocation of a call fail in turn, until the call succeeds; returns their number. */
static int fail_everywhere(enum wb_status (*call)(void *context), struct attempt *attempt)
{
    enum wb_status status;
    fail_at = 0;
    do {
        fail_at++;
        allocations = 0;
        status = wb_memory_try(call, attempt);
        assert_true(status == WB_OK || (status == WB_ERR_MEMORY && allocations == fail_at));
    } while (status != WB_OK);
    const int n = fail_at - 1;
    fail_at = 0;
    return n;
}

static void every_failed_allocation_is_an_error(void **unused)
{
    (void)unused;
    wb_log_set_sink(discard_message, NULL);
    for (int contact = 0; contact < 2; contact++) {
        struct attempt a = {.model = make_model(contact)};
        struct wb_wire_row rows[3];

        assert_true(fail_everywhere(create, &a) > 29);
        assert_int_equal(fail_everywhere(init_run, &a), 3);

        /* A new run from the virgin state allocates a solid, stepping nothing: the same number for
         * many rows as for one. */
        allocations = 0;
        assert_int_equal(run(&a), WB_OK);
        assert_true(a.run.converged && a.run.n_rows == 3);
        assert_int_equal(allocations, 0);
        memcpy(rows, a.run.rows, sizeof rows);
        assert_true(fail_everywhere(run, &a) > 19);
        assert_true(a.run.converged && a.run.n_rows == 3);
        for (int i = 0; i < 3; i++)
            assert_memory_equal(a.run.rows[i].tip, rows[i].tip, sizeof rows[i].tip);

        assert_int_equal(fail_everywhere(take_fields, &a), 5);
        wb_wire3d_fields_release(&a.fields);
        wb_wire_run_release(&a.run);
        wb_wire3d_destroy(a.wire);
    }
    wb_log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_failed_allocation_is_an_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
