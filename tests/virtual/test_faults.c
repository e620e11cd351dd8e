/* Lists of faults: parsing, and lists rejected with one message. */
#include "fixtures/virtual/faults.h"
#include "fixtures/virtual/faults_private.h"

#include <stdlib.h>

#include "base/units.h"
#include "tests/check.h"
#include "tests/messages.h"

static struct wb_faults read_list(const char *list)
{
    struct wb_faults faults;
    memset(&faults, 0xff, sizeof faults);
    assert_int_equal(wb_faults_read(&faults, list), WB_OK);
    return faults;
}

static void an_empty_list_has_no_faults(void **state)
{
    (void)state;
    static const struct wb_faults none;
    static const char *const lists[] = {NULL, ""};
    for (int i = 0; i < 2; i++) {
        const struct wb_faults faults = read_list(lists[i]);
        assert_true(faults.loss == none.loss && faults.delay == none.delay);
        assert_true(faults.stuck_stage == 0.0 && !faults.wrong_up);
    }
}

static void values_are_in_their_units(void **state)
{
    (void)state;
    const struct wb_faults faults =
        read_list("loss=7.5,delay=20,clock-drift=-300,zero-drift=6,unplug-cell=12,wrong-up");
    assert_close(faults.loss, 0.075, 1e-15);
    assert_close(faults.delay, 0.02, 1e-15);
    assert_close(faults.clock_drift, -3e-4, 1e-15);
    assert_close(faults.zero_drift, 1e-4, 1e-15);
    assert_close(faults.unplug_cell, 12.0 * WB_MM, 1e-15);
    assert_true(faults.wrong_up);
    assert_close(faults.duplicates, 0.0, 0.0);
}

static void every_name_alone_has_its_default_value(void **state)
{
    (void)state;
    for (size_t i = 0; i < wb_faults_table.n; i++) {
        const struct wb_setting *const row = &wb_faults_table.rows[i];
        const struct wb_faults faults = read_list(row->name);
        assert_true(wb_setting_is_given(row, &faults));
        for (size_t k = 0; k < wb_faults_table.n; k++)
            assert_int_equal(wb_setting_is_given(&wb_faults_table.rows[k], &faults), k == i);
    }
}

static void invalid_faults_are_rejected_with_one_message(void **state)
{
    (void)state;
    static const struct {
        const char *list, *said;
    } cases[] = {
        {"los", "'los' is not a fault: expected some of loss, duplicates"},
        {"loss=5,,reorder", "'' is not a fault"},
        {"loss=5,", "'' is not a fault"},
        {"loss=0", "loss: expected a number from 0.01 to 100"},
        {"loss=101", "loss: expected a number"},
        {"loss=", "loss: expected a number"},
        {"delay=5000", "delay: expected a number from 0.1 to 200"},
        {"wrong-up=1", "wrong-up takes no value"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct wb_faults faults = {.loss = 0.5};
        keep_messages();
        assert_int_equal(wb_faults_read(&faults, cases[i].list), WB_ERR_ARGUMENT);
        release_messages();
        assert_int_equal(kept.n, 1);
        assert_message(cases[i].said);
        assert_close(faults.loss, 0.5, 0.0);
    }
}

static int hits(const struct wb_faults *faults, const double *fault, uint64_t seed)
{
    int n = 0;
    for (uint64_t k = 0; k < 10000; k++)
        n += wb_faults_hit(faults, fault, seed, k);
    return n;
}

static void fractions_are_correct_and_depend_on_the_seed_only(void **state)
{
    (void)state;
    const struct wb_faults faults = read_list("loss=5,reorder=5");
    int differ = 0;
    assert_true(abs(hits(&faults, &faults.loss, 3) - 500) < 100);
    assert_int_equal(hits(&faults, &faults.garbage, 3), 0);
    for (uint64_t k = 0; k < 10000; k++) {
        const bool hit = wb_faults_hit(&faults, &faults.loss, 3, k);
        assert_int_equal(hit, wb_faults_hit(&faults, &faults.loss, 3, k));
        differ += hit != wb_faults_hit(&faults, &faults.loss, 4, k);
        /* Faults are independent of each other. */
        differ += hit != wb_faults_hit(&faults, &faults.reorder, 3, k);
    }
    assert_true(differ > 1000);
}

static void noise_contains_no_byte_of_an_instrument(void **state)
{
    (void)state;
    uint8_t bytes[500], again[500];
    wb_faults_noise(3, 7, bytes, sizeof bytes);
    wb_faults_noise(3, 7, again, sizeof again);
    assert_memory_equal(bytes, again, sizeof bytes);
    for (size_t i = 0; i < sizeof bytes; i++)
        assert_true(bytes[i] >= 0x80);
    wb_faults_noise(3, 8, again, sizeof again);
    assert_memory_not_equal(bytes, again, sizeof bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_empty_list_has_no_faults),
        cmocka_unit_test(values_are_in_their_units),
        cmocka_unit_test(every_name_alone_has_its_default_value),
        cmocka_unit_test(invalid_faults_are_rejected_with_one_message),
        cmocka_unit_test(fractions_are_correct_and_depend_on_the_seed_only),
        cmocka_unit_test(noise_contains_no_byte_of_an_instrument),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
