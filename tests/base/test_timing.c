/* The clock, its replacement, and dates. */
#include "base/timing.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

#include "base/units.h"
#include "tests/check.h"

static int64_t fixed_now_ns(void)
{
    return 42;
}

static int64_t fixed_utc(void)
{
    return 43;
}

static int refuse_to_wait(struct pollfd *descriptors, size_t n, int64_t deadline_ns)
{
    (void)descriptors, (void)n, (void)deadline_ns;
    return 44;
}

static void host_waits_until_the_deadline(void **state)
{
    (void)state;
    const int64_t deadline_ns = wb_time_now_ns() + 2 * WB_NS_PER_MS;
    assert_false(wb_time_is_virtual());
    assert_int_equal(wb_time_wait(NULL, 0, deadline_ns), 0);
    assert_true(wb_time_now_ns() >= deadline_ns);
    /* A deadline in the past does not wait. */
    assert_int_equal(wb_time_wait(NULL, 0, INT64_MIN / 2), 0);
}

static void host_wait_ends_when_a_descriptor_is_ready(void **state)
{
    int ends[2];
    (void)state;
    assert_int_equal(pipe(ends), 0);
    assert_int_equal(write(ends[1], "x", 1), 1);
    struct pollfd polled[] = {{.fd = -1, .events = POLLIN}, {.fd = ends[0], .events = POLLIN}};
    assert_int_equal(wb_time_wait(polled, 2, INT64_MAX), 1);
    assert_true(polled[1].revents & POLLIN);
    close(ends[0]);
    close(ends[1]);
}

static void replacement_is_used_until_it_is_removed(void **state)
{
    static const struct wb_time_source source = {fixed_now_ns, fixed_utc, refuse_to_wait};
    (void)state;
    wb_time_replace(&source);
    assert_true(wb_time_is_virtual());
    assert_int_equal(wb_time_now_ns(), 42);
    assert_int_equal(wb_time_utc(), 43);
    assert_int_equal(wb_time_wait(NULL, 0, 0), 44);
    wb_time_replace(NULL);
    assert_false(wb_time_is_virtual());
    assert_true(wb_time_now_ns() != 42);
}

static void dates_round_trip(void **state)
{
    char text[WB_TIME_TEXT];
    int64_t utc = 0;
    (void)state;
    wb_time_format(1795615380, text);
    assert_string_equal(text, "2026-11-25T14:03:00Z");
    assert_true(wb_time_parse(text, &utc));
    assert_int_equal(utc, 1795615380);
    assert_true(wb_time_parse("2026-11-25", &utc));
    assert_int_equal(utc, 1795615380 - 14 * 3600 - 3 * 60);
    assert_true(wb_time_parse("2024-02-29", &utc));
}

static void invalid_dates_are_rejected(void **state)
{
    static const char *const texts[] = {"",
                                        "2026",
                                        "25.11.2026",
                                        "2026-13-01",
                                        "2026-02-30",
                                        "2026-11-31",
                                        "2026-11-25 ",
                                        "2026-11-25T14:03Z",
                                        "2026-11-25T14:03:00",
                                        "2026-11-25T25:00:00Z",
                                        "now"};
    (void)state;
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        int64_t utc;
        if (wb_time_parse(texts[i], &utc))
            fail_msg("'%s' was taken for a date", texts[i]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(host_waits_until_the_deadline),
        cmocka_unit_test(host_wait_ends_when_a_descriptor_is_ready),
        cmocka_unit_test(replacement_is_used_until_it_is_removed),
        cmocka_unit_test(dates_round_trip),
        cmocka_unit_test(invalid_dates_are_rejected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
