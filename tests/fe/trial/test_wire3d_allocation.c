/* The 3D wire fails cleanly wherever memory ends, and takes none while it steps. */
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

static void every_missing_piece_of_memory_is_an_error(void **unused)
{
    (void)unused;
    wb_log_set_sink(discard_message, NULL);
    for (int contact = 0; contact < 2; contact++) {
        const struct wb_wire_model model = make_model(contact);
        struct wb_wire3d *wire;
        struct wb_wire3d_fields fields;
        struct wb_wire_run run;
        enum wb_status status;

        fail_at = 0;
        do {
            fail_at++;
            allocations = 0;
            status = wb_wire3d_create(&wire, &model);
            assert_true(status == WB_OK || (status == WB_ERR_MEMORY && !wire));
        } while (status != WB_OK);
        assert_true(fail_at > 30);

        fail_at = 0;
        do {
            fail_at++;
            allocations = 0;
            status = wb_wire_run_init(&run, &model, 7);
            assert_true(status == WB_OK || status == WB_ERR_MEMORY);
        } while (status != WB_OK);
        assert_int_equal(fail_at, 4);

        /* Once more from the virgin state takes a solid's memory, stepping takes none: as much for
         * many rows as for one. */
        fail_at = 0;
        allocations = 0;
        assert_int_equal(wb_wire3d_run(wire, &run, NULL), WB_OK);
        assert_true(run.converged && run.n_rows == 3);
        assert_int_equal(allocations, 1);
        do {
            fail_at++;
            allocations = 0;
            run.n_rows = 0;
            status = wb_wire3d_run(wire, &run, NULL);
            assert_true(status == WB_OK || status == WB_ERR_MEMORY);
        } while (status != WB_OK);
        assert_true(run.converged && run.n_rows == 3 && fail_at > 20);

        fail_at = 0;
        do {
            fail_at++;
            allocations = 0;
            status = wb_wire3d_fields(wire, &fields);
            assert_true(status == WB_OK || status == WB_ERR_MEMORY);
        } while (status != WB_OK);
        assert_int_equal(fail_at, 6);
        fail_at = 0;
        wb_wire3d_fields_release(&fields);
        wb_wire_run_release(&run);
        wb_wire3d_destroy(wire);
    }
    wb_log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_missing_piece_of_memory_is_an_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
