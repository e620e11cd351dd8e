#include "base/units.h"
#include "daq/protocol/drivers.h"
#include "tests/check.h"
#include "tests/daq/collect.h"

#define MS WB_NS_PER_MS

static struct wb_rig rig_of(void)
{
    struct wb_rig rig = {.gravity = WB_STANDARD_GRAVITY, .time_scale = 1.0};
    rig.load_cell.scale = 1.0;
    rig.load_cell.sign = 1;
    rig.load_cell.overload = 200e-3 * WB_STANDARD_GRAVITY;
    return rig;
}

static void feed(void *driver, const char *text, struct collect *collect)
{
    const struct wb_sink sink = collect_sink(collect);
    wb_loadcell_mtsics.receive(driver, 5 * MS, (const uint8_t *)text, strlen(text), &sink);
}

static void stable_and_dynamic_weights_are_both_valid(void **state)
{
    (void)state;
    struct collect collect = {0};
    const struct wb_rig rig = rig_of();
    void *const driver = collect_open(&wb_loadcell_mtsics, &rig);
    feed(driver, "S S     100.00 g\r\nS D      -0.52 g\r\nS D 0.0012 kg\r\n", &collect);
    assert_int_equal(collect.n_load, 3);
    assert_close(collect.load[0].force, 0.1 * WB_STANDARD_GRAVITY, 1e-15);
    assert_true(collect.load[0].valid && !collect.load[0].unstable);
    assert_close(collect.load[1].force, -0.52e-3 * WB_STANDARD_GRAVITY, 1e-15);
    assert_true(collect.load[1].valid && collect.load[1].unstable);
    assert_true(collect.load[2].unit_changed && collect.load[2].valid);
    assert_close(collect.load[2].force, 1.2e-3 * WB_STANDARD_GRAVITY, 1e-15);
    assert_true(wb_loadcell_mtsics.ready(driver));
    free(driver);
}

static void range_marks_are_overloads(void **state)
{
    (void)state;
    struct collect collect = {0};
    const struct wb_rig rig = rig_of();
    void *const driver = collect_open(&wb_loadcell_mtsics, &rig);
    feed(driver, "S S 1 g\r\nS +\r\nS -\r\nS D 201 g\r\n", &collect);
    assert_int_equal(collect.n_load, 4);
    for (int i = 1; i < 4; i++)
        assert_true(collect.load[i].overload && !collect.load[i].valid);
    free(driver);
}

static void errors_are_reported_and_give_no_sample(void **state)
{
    (void)state;
    struct collect collect = {0};
    const struct wb_rig rig = rig_of();
    void *const driver = collect_open(&wb_loadcell_mtsics, &rig);
    feed(driver,
         "S S 1 g\r\nS I\r\nES\r\nET\r\nEL\r\nS S 1.2.3 g\r\nS X 1 g\r\nS S\r\nS S 1 g g\r\n",
         &collect);
    assert_int_equal(collect.n_load, 1);
    assert_true(collect_count(&collect, "refused") >= 3);
    assert_non_null(strstr(collect_text(&collect, "refused"), "cannot weigh now"));
    free(driver);
}

static void truncated_first_line_is_dropped(void **state)
{
    (void)state;
    struct collect collect = {0};
    const struct wb_rig rig = rig_of();
    void *const driver = collect_open(&wb_loadcell_mtsics, &rig);
    feed(driver, "  100.00 g\r\nS S 2 g\r\n", &collect);
    assert_int_equal(collect.n_load, 1);
    assert_int_equal(collect_count(&collect, "partial"), 1);
    assert_int_equal(collect_count(&collect, "refused"), 0);
    free(driver);
}

static void serial_number_is_compared_with_the_rig(void **state)
{
    (void)state;
    struct collect collect = {0};
    struct wb_rig rig = rig_of();
    strcpy(rig.load_cell.serial_number, "B123");
    void *const driver = collect_open(&wb_loadcell_mtsics, &rig);
    feed(driver, "I4 A \"B123\"\r\n", &collect);
    assert_int_equal(collect_count(&collect, "serial"), 0);
    assert_int_equal(collect_count(&collect, "connected"), 1);
    feed(driver, "I4 A \"C999\"\r\nI4 I\r\n", &collect);
    assert_int_equal(collect_count(&collect, "serial"), 1);
    assert_non_null(strstr(collect_text(&collect, "serial"), "C999"));
    free(driver);
}

static void stream_is_requested_again_after_silence(void **state)
{
    (void)state;
    struct collect collect = {0};
    const struct wb_rig rig = rig_of();
    void *const driver = collect_open(&wb_loadcell_mtsics, &rig);
    struct wb_outbox outbox = {0};
    wb_loadcell_mtsics.start(driver, 0, &outbox);
    assert_int_equal(outbox.n_entries, 2);
    assert_memory_equal(outbox.bytes, "I4\r\nSIR\r\n", 9);
    wb_outbox_clear(&outbox);
    for (int64_t t = 0; t < 3000; t += 20) {
        wb_loadcell_mtsics.tick(driver, t * MS, &outbox);
        feed(driver, "S S 2 g\r\n", &collect);
        collect.n_load = 0;
    }
    assert_int_equal(outbox.n_entries, 0);
    for (int64_t t = 3000; t < 5500; t += 20)
        wb_loadcell_mtsics.tick(driver, t * MS, &outbox);
    assert_int_equal(outbox.n_entries, 2);
    assert_memory_equal(outbox.bytes, "SIR\r\nSIR\r\n", 10);
    free(driver);
}

/* `S` waits for a stable load, which a test in motion never gives. */
static void commands_that_wait_for_stability_are_not_sent(void **state)
{
    (void)state;
    for (int polled = 0; polled < 2; polled++) {
        struct wb_rig rig = rig_of();
        rig.load_cell.poll_period_ns = polled ? 50 * MS : 0;
        void *const driver = collect_open(&wb_loadcell_mtsics, &rig);
        struct wb_outbox outbox = {0};
        wb_loadcell_mtsics.start(driver, 0, &outbox);
        for (int64_t t = 0; t < 400; t += 20)
            wb_loadcell_mtsics.tick(driver, t * MS, &outbox);
        wb_loadcell_mtsics.stop(driver, &outbox);
        for (size_t i = 0; i < outbox.n_entries; i++) {
            size_t n;
            const uint8_t *const entry = collect_entry(&outbox, i, &n);
            assert_true(n >= 4 &&
                        (memcmp(entry, "SI\r\n", n) == 0 || memcmp(entry, "SIR\r\n", n) == 0 ||
                         memcmp(entry, "I4\r\n", n) == 0));
        }
        /* Polled: at the start and every 50 ms from 50 to 350; else I4, SIR and the SI that ends
         * the stream. */
        assert_int_equal(outbox.n_entries, polled ? 9 : 3);
        free(driver);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stable_and_dynamic_weights_are_both_valid),
        cmocka_unit_test(range_marks_are_overloads),
        cmocka_unit_test(errors_are_reported_and_give_no_sample),
        cmocka_unit_test(truncated_first_line_is_dropped),
        cmocka_unit_test(serial_number_is_compared_with_the_rig),
        cmocka_unit_test(stream_is_requested_again_after_silence),
        cmocka_unit_test(commands_that_wait_for_stability_are_not_sent),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
