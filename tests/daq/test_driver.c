#include "daq/protocol/drivers.h"

#include "tests/check.h"

static void drivers_are_found_by_role_and_protocol(void **state)
{
    (void)state;
    assert_ptr_equal(wb_drivers_find(WB_ROLE_LOAD, "generic"), &wb_loadcell_generic);
    assert_ptr_equal(wb_drivers_find(WB_ROLE_LOAD, "mt-sics"), &wb_loadcell_mtsics);
    assert_ptr_equal(wb_drivers_find(WB_ROLE_MOCAP, "natnet"), &wb_natnet_client);
    assert_ptr_equal(wb_drivers_find(WB_ROLE_STAGE, "grbl"), &wb_stage_grbl);
    assert_null(wb_drivers_find(WB_ROLE_STAGE, "generic"));
    assert_null(wb_drivers_find(WB_ROLE_LOAD, "gener"));
}

static void every_driver_has_the_operations_that_the_loop_calls(void **state)
{
    (void)state;
    static const struct wb_driver *const drivers[] = {WB_DRIVERS(WB_DRIVERS_ADDRESS)};
    const size_t n = sizeof drivers / sizeof drivers[0];
    for (size_t i = 0; i < n; i++) {
        const struct wb_driver *const driver = drivers[i];
        /* No name is there twice. */
        assert_ptr_equal(wb_drivers_find(driver->role, driver->name), driver);
        assert_true(driver->name && driver->state_size > 0);
        assert_true(driver->init && driver->start && driver->receive && driver->tick);
        assert_true(driver->ready != NULL);
        assert_int_equal(driver->command != NULL, driver->role == WB_ROLE_STAGE);
    }
    assert_true(n >= 4);
}

static void roles_have_names(void **state)
{
    (void)state;
    assert_string_equal(wb_role_name(WB_ROLE_LOAD), "load");
    assert_string_equal(wb_role_name(WB_ROLE_MOCAP), "mocap");
    assert_string_equal(wb_role_name(WB_ROLE_STAGE), "stage");
}

static void outbox_keeps_entries_apart(void **state)
{
    (void)state;
    struct wb_outbox outbox = {0};
    assert_true(wb_outbox_add_text(&outbox, "ab"));
    assert_true(wb_outbox_add(&outbox, "\0c!", 3));
    assert_int_equal(outbox.n_entries, 2);
    assert_int_equal(outbox.ends[0], 2);
    assert_int_equal(outbox.ends[1], 5);
    assert_memory_equal(outbox.bytes, "ab\0c!", 5);
    wb_outbox_clear(&outbox);
    assert_int_equal(outbox.n_entries + outbox.n_bytes, 0);
}

static void full_outbox_accepts_no_more_entries(void **state)
{
    (void)state;
    static const uint8_t big[WB_OUTBOX_BYTES + 1];
    struct wb_outbox outbox = {0};
    assert_false(wb_outbox_add(&outbox, big, sizeof big));
    assert_false(wb_outbox_add(&outbox, big, 0));
    assert_int_equal(outbox.n_entries, 0);
    assert_true(wb_outbox_add(&outbox, big, sizeof big - 1));
    assert_false(wb_outbox_add(&outbox, big, 1));
    wb_outbox_clear(&outbox);
    for (int i = 0; i < WB_OUTBOX_ENTRIES; i++)
        assert_true(wb_outbox_add(&outbox, big, 1));
    assert_false(wb_outbox_add(&outbox, big, 1));
    assert_int_equal(outbox.n_bytes, WB_OUTBOX_ENTRIES);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(drivers_are_found_by_role_and_protocol),
        cmocka_unit_test(every_driver_has_the_operations_that_the_loop_calls),
        cmocka_unit_test(roles_have_names),
        cmocka_unit_test(outbox_keeps_entries_apart),
        cmocka_unit_test(full_outbox_accepts_no_more_entries),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
