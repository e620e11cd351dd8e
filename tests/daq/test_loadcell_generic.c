#include "base/units.h"
#include "daq/protocol/drivers.h"
#include "tests/check.h"
#include "tests/daq/collect.h"
#include "tests/trials.h"

#define MS WB_NS_PER_MS

static struct wb_rig rig_of(const char *unit)
{
    struct wb_rig rig = {.gravity = 9.81, .time_scale = 1.0};
    rig.load_cell.scale = 1.0;
    rig.load_cell.sign = 1;
    rig.load_cell.overload = 30e-3 * 9.81;
    strcpy(rig.load_cell.unit, unit);
    return rig;
}

static void feed(void *driver, int64_t t_ns, const char *text, struct collect *collect)
{
    const struct wb_sink sink = collect_sink(collect);
    wb_loadcell_generic.receive(driver, t_ns, (const uint8_t *)text, strlen(text), &sink);
}

static void readings_become_forces_with_their_arrival(void **state)
{
    (void)state;
    struct collect collect = {0};
    const struct wb_rig rig = rig_of("");
    void *const driver = collect_open(&wb_loadcell_generic, &rig);
    assert_false(wb_loadcell_generic.ready(driver));
    feed(driver, 10 * MS, "0 g\r\n1.5 g\r\n-2", &collect);
    feed(driver, 20 * MS, ".5 g ?\r\n", &collect);
    assert_int_equal(collect.n_load, 2);
    assert_close(collect.load[0].force, 1.5e-3 * 9.81, 1e-16);
    assert_true(collect.load[0].valid && !collect.load[0].unstable);
    assert_int_equal(collect.load[0].t_ns, 10 * MS);
    assert_int_equal(collect.load[0].index, 0);
    /* The stamp is that of the read that completed the line. */
    assert_close(collect.load[1].force, -2.5e-3 * 9.81, 1e-16);
    assert_true(collect.load[1].valid && collect.load[1].unstable);
    assert_int_equal(collect.load[1].t_ns, 20 * MS);
    assert_int_equal(collect.load[1].index, 1);
    assert_true(wb_loadcell_generic.ready(driver));
    free(driver);
}

static void incomplete_first_line_is_dropped_and_reported(void **state)
{
    (void)state;
    struct collect collect = {0};
    const struct wb_rig rig = rig_of("g");
    void *const driver = collect_open(&wb_loadcell_generic, &rig);
    feed(driver, 0, "00.00\n1.25\n", &collect);
    assert_int_equal(collect.n_load, 1);
    assert_close(collect.load[0].force, 1.25e-3 * 9.81, 1e-16);
    assert_int_equal(collect_count(&collect, "partial"), 1);
    assert_non_null(strstr(collect_text(&collect, "partial"), "00.00"));
    free(driver);
}

static void overload_is_an_invalid_sample_and_one_remark(void **state)
{
    (void)state;
    struct collect collect = {0};
    const struct wb_rig rig = rig_of("");
    void *const driver = collect_open(&wb_loadcell_generic, &rig);
    feed(driver, 0, "\n29 g\nOL,+9999999E+19\nOL\n31 g\n-31 g\n2 g\nOL\n", &collect);
    assert_int_equal(collect.n_load, 7);
    for (int i = 1; i <= 4; i++) {
        assert_true(collect.load[i].overload && !collect.load[i].valid);
        assert_true(isnan(collect.load[i].force));
    }
    assert_true(collect.load[0].valid && collect.load[5].valid && !collect.load[5].overload);
    assert_int_equal(collect_count(&collect, "overload"), 2); /* one each time it begins */
    free(driver);
}

static void change_of_unit_is_reported(void **state)
{
    (void)state;
    struct collect collect = {0};
    const struct wb_rig rig = rig_of("");
    void *const driver = collect_open(&wb_loadcell_generic, &rig);
    feed(driver, 0, "\n1 g\n0.002 kg\n0.003\n4 g\n", &collect);
    assert_int_equal(collect.n_load, 4);
    assert_false(collect.load[0].unit_changed);
    assert_true(collect.load[1].unit_changed && collect.load[1].valid);
    assert_close(collect.load[1].force, 2e-3 * 9.81, 1e-16);
    /* A line without a unit keeps the last unit, and thus the alarm. */
    assert_true(collect.load[2].unit_changed);
    assert_close(collect.load[2].force, 3e-3 * 9.81, 1e-16);
    assert_false(collect.load[3].unit_changed);
    assert_int_equal(collect_count(&collect, "unit"), 2);
    free(driver);
}

static void contradicting_unit_is_used_and_reported_once(void **state)
{
    (void)state;
    struct collect collect = {0};
    const struct wb_rig rig = rig_of("g");
    void *const driver = collect_open(&wb_loadcell_generic, &rig);
    feed(driver, 0, "\n1 g\n2\n0.002 kg\n0.003\n0.031 kg\n", &collect);
    assert_int_equal(collect.n_load, 5);
    assert_false(collect.load[0].unit_contradicts || collect.load[1].unit_contradicts);
    for (int i = 2; i < 4; i++) {
        assert_true(collect.load[i].unit_contradicts && collect.load[i].valid);
        assert_close(collect.load[i].force, i * 1e-3 * 9.81, 1e-16);
    }
    /* The cell's range is watched in the unit that it prints. */
    assert_true(collect.load[4].overload && !collect.load[4].valid);
    assert_non_null(strstr(collect_text(&collect, "unit"), "kg"));
    assert_int_equal(collect_count(&collect, "unit"), 2); /* the change, the contradiction */
    free(driver);
}

static void readings_without_a_unit_are_rejected(void **state)
{
    (void)state;
    struct collect collect = {0};
    const struct wb_rig rig = rig_of("");
    void *const driver = collect_open(&wb_loadcell_generic, &rig);
    feed(driver, 0, "\n1.5\n1.5 pcs\n", &collect);
    assert_int_equal(collect.n_load, 0);
    assert_int_equal(collect_count(&collect, "refused"), 2);
    assert_non_null(strstr(collect_text(&collect, "refused"), "load_cell.unit"));
    free(driver);
}

static void garbage_is_counted_without_a_flood_of_remarks(void **state)
{
    (void)state;
    struct collect collect = {0};
    const struct wb_rig rig = rig_of("g");
    void *const driver = collect_open(&wb_loadcell_generic, &rig);
    for (int i = 0; i < 1001; i++)
        feed(driver, 0, "Err 55\n", &collect);
    assert_int_equal(collect.n_load, 0);
    /* 1000 refused (the first line was partial): 1, 2, 3, 10, 20, 30, 100, 200, 300, 1000 */
    assert_int_equal(collect_count(&collect, "refused"), 10);
    assert_non_null(strstr(collect.remarks[collect.n_remarks - 1].text, "1000 so far"));
    free(driver);
}

/* Result of many lines. */
struct tally {
    int n, wrong, next;
};

/* Reading k is k + 1 thousandths of a gram. */
static void tally_load(void *context, const struct wb_load_sample *sample)
{
    struct tally *const tally = context;
    const double k = sample->force / 9.81e-6 - 1.0;
    tally->n++;
    tally->wrong += !sample->valid || fabs(k - round(k)) > 1e-6 || (int)round(k) < tally->next;
    tally->next = (int)round(k) + 1;
}

/* Bytes as caused by a wrong baud rate or a bad contact, including line ends and digits, at random
 * positions of a stream; each burst begins with a byte that indicators do not print. */
static void noise_loses_two_readings_per_burst_and_creates_none(void **state)
{
    (void)state;
    enum {
        READINGS = 20000
    };
    struct tally tally = {0};
    const struct wb_sink sink = {.context = &tally, .load = tally_load};
    const struct wb_rig rig = rig_of("g");
    void *const driver = collect_open(&wb_loadcell_generic, &rig);
    uint32_t random = 4711;
    int bursts = 0;
    feed(driver, 0, "\r\n", &(struct collect){0});
    for (int k = 0; k < READINGS; k++) {
        uint8_t bytes[128];
        int n = snprintf((char *)bytes, sizeof bytes, "%.3f g\r\n", 1e-3 * (k + 1));
        random = random * 1664525u + 1013904223u;
        if (random >> 24 < 40) {
            const int at = (int)((random >> 8) % (uint32_t)(n - 1)), size = 1 + (random >> 3) % 40;
            memmove(bytes + at + size, bytes + at, (size_t)(n - at));
            for (int i = 0; i < size; i++) {
                random = random * 1664525u + 1013904223u;
                bytes[at + i] = (uint8_t)(random >> 24);
            }
            bytes[at] |= 0x80;
            n += size;
            bursts++;
        }
        wb_loadcell_generic.receive(driver, k * 12 * MS, bytes, (size_t)n, &sink);
    }
    free(driver);
    assert_int_equal(tally.wrong, 0);
    assert_true(bursts > 2000 && tally.n < READINGS);
    assert_true(READINGS - tally.n <= 2 * bursts);
    count_trials("Noise between the bytes of a load cell", (uint64_t)bursts,
                 "bursts in %d lines: %.2f readings lost per burst, no wrong reading", READINGS,
                 (double)(READINGS - tally.n) / bursts);
}

static void bytes_before_settling_are_ignored(void **state)
{
    (void)state;
    struct collect collect = {0};
    struct wb_rig rig = rig_of("g");
    rig.load_cell.settle_ns = 2000 * MS;
    void *const driver = collect_open(&wb_loadcell_generic, &rig);
    feed(driver, 5000 * MS, "bootloader\n1\n2\n", &collect);
    feed(driver, 6999 * MS, "3\n4\n", &collect);
    feed(driver, 7000 * MS, "5\n6\n", &collect);
    assert_int_equal(collect.n_load, 1);
    assert_close(collect.load[0].force, 6e-3 * 9.81, 1e-16);
    free(driver);
}

static void pause_ends_a_line_if_the_rig_file_says_so(void **state)
{
    (void)state;
    struct collect collect = {0};
    struct wb_rig rig = rig_of("g");
    strcpy(rig.load_cell.terminator, "idle");
    rig.load_cell.idle_gap_ns = 20 * MS;
    void *const driver = collect_open(&wb_loadcell_generic, &rig);
    feed(driver, 0, "7.7", &collect);
    feed(driver, 100 * MS, "1.", &collect);
    feed(driver, 119 * MS, "25", &collect); /* within the gap: the same line */
    assert_int_equal(collect.n_load, 0);
    feed(driver, 200 * MS, "2.5", &collect);
    assert_int_equal(collect.n_load, 1);
    assert_close(collect.load[0].force, 1.25e-3 * 9.81, 1e-16);
    assert_int_equal(collect.load[0].t_ns, 119 * MS); /* its own last byte */
    free(driver);
}

static void polls_keep_their_period(void **state)
{
    (void)state;
    struct wb_rig rig = rig_of("g");
    strcpy(rig.load_cell.start_command, "START\r");
    strcpy(rig.load_cell.poll_command, "W\r");
    rig.load_cell.poll_period_ns = 100 * MS;
    rig.load_cell.settle_ns = 50 * MS;
    void *const driver = collect_open(&wb_loadcell_generic, &rig);
    struct wb_outbox outbox = {0};
    wb_loadcell_generic.start(driver, 1000 * MS, &outbox);
    assert_int_equal(outbox.n_entries, 1);
    assert_memory_equal(outbox.bytes, "START\r", 6);
    int n_polls = 0;
    int64_t first = 0;
    for (int64_t t = 1000; t < 2050; t += 10) {
        wb_outbox_clear(&outbox);
        wb_loadcell_generic.tick(driver, t * MS, &outbox);
        if (outbox.n_entries && !first)
            first = t;
        n_polls += (int)outbox.n_entries;
    }
    assert_int_equal(first, 1050); /* not before the instrument has settled */
    assert_int_equal(n_polls, 10);
    /* After a pause there is one poll; missed polls are skipped. */
    wb_outbox_clear(&outbox);
    wb_loadcell_generic.tick(driver, 9000 * MS, &outbox);
    wb_loadcell_generic.tick(driver, 9010 * MS, &outbox);
    assert_int_equal(outbox.n_entries, 1);
    free(driver);
}

/* The result depends only on chunks and their times, not on sent bytes. */
static void replay_gives_the_same_samples(void **state)
{
    (void)state;
    static struct collect live, replayed;
    struct wb_rig rig = rig_of("");
    strcpy(rig.load_cell.poll_command, "W\r");
    rig.load_cell.poll_period_ns = 30 * MS;
    void *const a = collect_open(&wb_loadcell_generic, &rig);
    void *const b = collect_open(&wb_loadcell_generic, &rig);
    static const char *const chunks[] = {"2 g\r\n1.", "25 g\r\nOL\r", "\n3 kg\r\nxx\r\n",
                                         "-4 g\r\n"};
    struct wb_outbox outbox = {0};
    wb_loadcell_generic.start(a, 0, &outbox);
    for (int i = 0; i < 4; i++) {
        feed(a, i * 40 * MS, chunks[i], &live);
        wb_outbox_clear(&outbox);
        wb_loadcell_generic.tick(a, i * 40 * MS + 7, &outbox);
    }
    for (int i = 0; i < 4; i++)
        feed(b, i * 40 * MS, chunks[i], &replayed);
    assert_int_equal(live.n_load, 4);
    assert_memory_equal(&live, &replayed, sizeof live);
    free(a);
    free(b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(readings_become_forces_with_their_arrival),
        cmocka_unit_test(incomplete_first_line_is_dropped_and_reported),
        cmocka_unit_test(overload_is_an_invalid_sample_and_one_remark),
        cmocka_unit_test(change_of_unit_is_reported),
        cmocka_unit_test(contradicting_unit_is_used_and_reported_once),
        cmocka_unit_test(readings_without_a_unit_are_rejected),
        cmocka_unit_test(garbage_is_counted_without_a_flood_of_remarks),
        cmocka_unit_test(noise_loses_two_readings_per_burst_and_creates_none),
        cmocka_unit_test(bytes_before_settling_are_ignored),
        cmocka_unit_test(pause_ends_a_line_if_the_rig_file_says_so),
        cmocka_unit_test(polls_keep_their_period),
        cmocka_unit_test(replay_gives_the_same_samples),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
