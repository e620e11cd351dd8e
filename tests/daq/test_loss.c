/* Counts of lost, repeated and out-of-order samples in synthetic streams with known losses. */
#include "daq/protocol/loss.h"

#include <math.h>

#include "tests/check.h"

enum {
    N = 6000,
    LATEST = 17 /* number of stamps after which a gap is final */
};

static uint64_t state_of_noise;

static void seed(void)
{
    state_of_noise = 88172645463325252U;
}

/* Random number from 0 to 1 (xorshift). */
static double uniform(void)
{
    state_of_noise ^= state_of_noise << 13;
    state_of_noise ^= state_of_noise >> 7;
    state_of_noise ^= state_of_noise << 17;
    return (double)(state_of_noise >> 11) / 9007199254740992.0;
}

/* Adds N frames at 120 frames/s, stamped by a clock with an error of 200 ppm, of which the fraction
 * `share` is lost. */
static void frames(struct wb_loss *loss, double share, uint64_t *lost)
{
    seed();
    *lost = 0;
    for (int i = 0; i < N; i++) {
        /* Gaps near both ends are not counted: frames there may be out of order. */
        if (i >= LATEST && i < N - LATEST && uniform() < share)
            ++*lost;
        else
            wb_loss_add(loss, 1e4 + i * 1.0002 / 120.0);
    }
}

static void complete_stream_of_frames_has_no_losses(void **state)
{
    (void)state;
    struct wb_loss loss;
    uint64_t lost;
    wb_loss_init(&loss, true, 0.0);
    frames(&loss, 0.0, &lost);
    const struct wb_loss_counts counts = wb_loss_counts(&loss);
    assert_int_equal(counts.received, N);
    assert_int_equal(counts.missing, 0);
    assert_false(wb_loss_is_significant(&loss));
    assert_close(counts.period, 1.0002 / 120.0, 1e-9);
}

static void lost_frames_are_counted_exactly(void **state)
{
    (void)state;
    static const double shares[] = {0.001, 0.1, 0.3, 0.5};
    for (int i = 0; i < 4; i++) {
        struct wb_loss loss;
        uint64_t lost;
        wb_loss_init(&loss, true, 0.0);
        frames(&loss, shares[i], &lost);
        const struct wb_loss_counts counts = wb_loss_counts(&loss);
        assert_int_equal(counts.missing, lost);
        assert_int_equal(counts.received, N - lost);
        assert_true(counts.gaps > 0 && counts.gaps <= lost);
        assert_true(wb_loss_is_significant(&loss));
        assert_close(wb_loss_share(&counts), (double)lost / N, 1e-12);
    }
}

static void announced_rate_is_used_from_the_start(void **state)
{
    (void)state;
    struct wb_loss loss;
    wb_loss_init(&loss, true, 0.01);
    for (int i = 0; i < 10; i++)
        wb_loss_add(&loss, 5.0 + 0.01 * i);
    for (int i = 12; i < 11 + LATEST; i++)
        wb_loss_add(&loss, 5.0 + 0.01 * i);
    const struct wb_loss_counts counts = wb_loss_counts(&loss);
    assert_int_equal(counts.missing, 2);
    assert_int_equal(counts.gaps, 1);
    assert_close(counts.longest_gap, 0.02, 1e-12);
}

static void repeated_and_out_of_order_frames_are_not_missing(void **state)
{
    (void)state;
    static const int order[] = {0, 1, 2, 2, 4, 3, 5, 6, 6, 6, 7, 10, 9, 8, 9, 11};
    struct wb_loss loss;
    wb_loss_init(&loss, true, 0.01);
    for (size_t i = 0; i < sizeof order / sizeof *order; i++)
        wb_loss_add(&loss, 3.0 + 0.01 * order[i]);
    const struct wb_loss_counts counts = wb_loss_counts(&loss);
    assert_int_equal(counts.missing, 0);
    assert_int_equal(counts.repeated, 4);
    assert_int_equal(counts.overtaken, 3);
    assert_int_equal(counts.received, 12);
}

/* A stream with frames out of order, received from and up to any frame: frames in transit at both
 * ends are not lost. */
static void late_frames_at_either_end_are_not_missing(void **state)
{
    (void)state;
    static const int order[] = {0, 1, 3, 4, 2, 5, 8, 7, 6, 10, 9, 12, 13, 14, 11, 16, 15};
    const size_t n = sizeof order / sizeof *order;
    for (size_t first = 0; first < n; first++) {
        struct wb_loss loss;
        wb_loss_init(&loss, true, 0.01);
        for (size_t i = first; i < 3 * n; i++) {
            wb_loss_add(&loss, 3.0 + 0.01 * (order[i % n] + 17 * (int)(i / n)));
            assert_false(wb_loss_is_significant(&loss));
        }
        const struct wb_loss_counts counts = wb_loss_counts(&loss);
        assert_int_equal(counts.missing, 0);
        assert_int_equal(counts.gaps, 0);
        assert_close(counts.longest_gap, 0.0, 0.0);
    }
}

static void restarted_server_causes_no_loss(void **state)
{
    (void)state;
    struct wb_loss loss;
    wb_loss_init(&loss, true, 0.01);
    for (int i = 0; i < 100; i++)
        wb_loss_add(&loss, 1000.0 + 0.01 * i);
    for (int i = 0; i < 100; i++)
        wb_loss_add(&loss, 0.01 * i);
    const struct wb_loss_counts counts = wb_loss_counts(&loss);
    assert_int_equal(counts.missing, 0);
    assert_int_equal(counts.overtaken, 0);
    assert_int_equal(counts.received, 200);
}

/* --- lines --- */

enum arrival {
    PROMPT,
    LATE,
    STALLED,
    BUNDLED
};

/* Adds the arrival times of 80 lines/s, read every millisecond, of which the fraction `share` is
 * lost. */
static void lines(struct wb_loss *loss, enum arrival arrival, double share, uint64_t *lost)
{
    seed();
    *lost = 0;
    double last = 0.0;
    for (int i = 0; i < N; i++) {
        if (i > 0 && i < N - 1 && uniform() < share) {
            ++*lost;
            continue;
        }
        double t = i * 0.0125 * 1.0002;
        if (arrival == LATE && uniform() < 0.02)
            t += 0.03 * uniform();
        else if (arrival == STALLED && i >= 3000 && i < 3240)
            t = 3240 * 0.0125 * 1.0002;
        else if (arrival == BUNDLED)
            t = ceil(t / 0.064) * 0.064;
        last = fmax(last, ceil(t * 1e3) * 1e-3);
        wb_loss_add(loss, last);
    }
}

static void late_lines_and_stalls_are_not_counted_as_lost(void **state)
{
    (void)state;
    for (int arrival = PROMPT; arrival <= STALLED; arrival++) {
        struct wb_loss loss;
        uint64_t lost;
        wb_loss_init(&loss, false, 0.0);
        lines(&loss, (enum arrival)arrival, 0.0, &lost);
        const struct wb_loss_counts counts = wb_loss_counts(&loss);
        assert_int_equal(counts.received, N);
        assert_close(counts.period, 0.0125, 1.25e-4); /* read every millisecond */
        assert_int_equal(counts.missing, 0);
    }
}

/* A single lost line cannot always be distinguished from a late one. The count may therefore be
 * wrong by 10 %. */
static void lost_lines_are_counted(void **state)
{
    (void)state;
    static const double shares[] = {0.02, 0.1, 0.25};
    for (int arrival = PROMPT; arrival <= LATE; arrival++) {
        for (int i = 0; i < 3; i++) {
            struct wb_loss loss;
            uint64_t lost;
            wb_loss_init(&loss, false, 0.0);
            lines(&loss, (enum arrival)arrival, shares[i], &lost);
            const struct wb_loss_counts counts = wb_loss_counts(&loss);
            assert_close((double)counts.missing, (double)lost,
                         arrival == PROMPT ? 2.0 : 0.1 * (double)lost);
            assert_true(wb_loss_is_significant(&loss) || shares[i] < 0.05);
        }
    }
}

static void bundled_lines_have_no_period(void **state)
{
    (void)state;
    struct wb_loss loss;
    uint64_t lost;
    wb_loss_init(&loss, false, 0.0);
    lines(&loss, BUNDLED, 0.1, &lost);
    const struct wb_loss_counts counts = wb_loss_counts(&loss);
    assert_int_equal(counts.received, N - lost);
    assert_int_equal(counts.missing, 0);
    assert_false(wb_loss_is_significant(&loss));
}

static void invalid_and_extreme_times_are_tolerated(void **state)
{
    (void)state;
    static const double times[] = {
        (double)NAN, (double)INFINITY, -(double)INFINITY, 0.0, 0.0, -1e300, 1e300, 1.0, -1.0,
        5e-324};
    for (int stamped = 0; stamped < 2; stamped++) {
        struct wb_loss loss;
        seed();
        wb_loss_init(&loss, stamped, 0.0);
        for (int i = 0; i < N; i++)
            wb_loss_add(&loss, times[(int)(10.0 * uniform())]);
        const struct wb_loss_counts counts = wb_loss_counts(&loss);
        assert_int_equal(counts.received + counts.repeated, N);
    }
}

/* A computer that is busy while the period is determined: most lines are late, and sometimes the
 * process is suspended. */
static void period_from_a_busy_computer_gives_no_losses(void **state)
{
    (void)state;
    const double period = 0.0125;
    struct wb_loss loss;
    double last = 0.0;
    seed();
    wb_loss_init(&loss, false, 0.0);
    for (int i = 0; i < N; i++) {
        const double busy = i < 200 ? 0.004 : 0.001, stall = i % 500 < 300 ? 0.0 : 0.4;
        const double late = -busy * log(1.0 - uniform());
        const double awake = (i - i % 500 + 300) * period + stall;
        last = fmax(last, i * period + late);
        if (stall > 0.0)
            last = fmax(last, awake);
        wb_loss_add(&loss, last);
    }
    const struct wb_loss_counts counts = wb_loss_counts(&loss);
    assert_int_equal(counts.received, N);
    assert_close_relative(counts.period, period, 0.002);
    assert_true(wb_loss_share(&counts) < 0.001); /* until the period is accurate */
    assert_false(wb_loss_is_significant(&loss));
}

/* A computer that is delayed by 10 ms right after the period was determined: eight lines arrive
 * together. */
static void temporary_stall_is_not_reported_as_loss(void **state)
{
    (void)state;
    const double period = 1.0 / 800.0;
    for (int begin = 60; begin < 75; begin++) {
        struct wb_loss loss;
        wb_loss_init(&loss, false, 0.0);
        for (int k = 0; k < 2000; k++) {
            const double due = k * period, awake = (begin + 8) * period;
            wb_loss_add(&loss, k >= begin && due < awake ? awake : due);
            assert_false(wb_loss_is_significant(&loss));
        }
        assert_int_equal(wb_loss_counts(&loss).missing, 0);
    }
}

/* A busy computer reads four lines, 0.1 ms apart, every 5 ms. In the second half of the stream it
 * is no longer busy and reads each line in time. */
static void bundles_of_a_busy_computer_give_no_period(void **state)
{
    (void)state;
    struct wb_loss loss;
    wb_loss_init(&loss, false, 0.0);
    for (int k = 0; k < 4000; k++) {
        const double due = k / 800.0;
        const int in_bundle = k % 4;
        wb_loss_add(&loss, k < 2000 ? due + (3 - in_bundle) / 800.0 + 1e-4 * in_bundle : due);
        assert_false(wb_loss_is_significant(&loss));
    }
    const struct wb_loss_counts counts = wb_loss_counts(&loss);
    assert_close(counts.period, 1.0 / 800.0, 1e-5);
    assert_int_equal(counts.missing, 0);
}

/* A stream of 7 s at 80 lines/s, each line delayed by an exponentially distributed time of mean
 * `mean` (s). The fraction `share` of the lines is lost. */
struct busy {
    double mean;
    bool has_stalls; /* the computer stalls once in 2 s on average, for up to 0.4 s */
    double share;
};

static void busy_stream(struct wb_loss *loss, const struct busy *busy, uint64_t *lost)
{
    const double period = 0.0125 * 1.0002;
    double last = 0.0, awake = 0.0;
    *lost = 0;
    wb_loss_init(loss, false, 0.0);
    for (int i = 0; i < 560; i++) {
        if (uniform() < busy->share) {
            ++*lost;
            continue;
        }
        const double t = i * period - busy->mean * log(1.0 - uniform());
        if (busy->has_stalls && uniform() < 0.5 * period)
            awake = t + 0.4 * uniform();
        last = fmax(fmax(last, awake), t);
        wb_loss_add(loss, last);
    }
}

static void late_lines_do_not_count_as_lost(void **state)
{
    (void)state;
    static const double means[] = {0.0002, 0.001, 0.002, 0.003, 0.005, 0.01};
    seed();
    for (int stalls = 0; stalls < 2; stalls++) {
        for (size_t i = 0; i < sizeof means / sizeof *means; i++) {
            const struct busy busy = {means[i], stalls, 0.0};
            uint64_t missing = 0;
            for (int stream = 0; stream < 300; stream++) {
                struct wb_loss loss;
                uint64_t lost;
                busy_stream(&loss, &busy, &lost);
                if (wb_loss_is_significant(&loss))
                    fail_msg("mean delay %g s: stream %d is reported as lossy", means[i], stream);
                missing += wb_loss_counts(&loss).missing;
            }
            /* At the end of a stalled stream the backlog has not been read yet. */
            assert_true(missing <= (stalls ? 300u : 0u));
        }
    }
}

static void lost_lines_are_counted_among_late_ones(void **state)
{
    (void)state;
    static const double means[] = {0.0002, 0.001, 0.002}, shares[] = {0.05, 0.15};
    seed();
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 2; k++) {
            const struct busy busy = {means[i], false, shares[k]};
            uint64_t all_lost = 0, missing = 0;
            int n_significant = 0;
            for (int stream = 0; stream < 300; stream++) {
                struct wb_loss loss;
                uint64_t lost;
                busy_stream(&loss, &busy, &lost);
                n_significant += wb_loss_is_significant(&loss);
                missing += wb_loss_counts(&loss).missing;
                all_lost += lost;
            }
            assert_close_relative((double)missing, (double)all_lost, 0.05);
            assert_true(n_significant >= 295);
        }
    }
}

/* The period must be found although there are never eight regular intervals in a row. */
static void loss_of_every_fourth_line_is_counted(void **state)
{
    (void)state;
    struct wb_loss loss;
    wb_loss_init(&loss, false, 0.0);
    for (int i = 0; i < N; i++)
        if (i % 4 != 3)
            wb_loss_add(&loss, i * 0.0125);
    const struct wb_loss_counts counts = wb_loss_counts(&loss);
    assert_close((double)counts.missing, N / 4.0, 3.0);
    assert_close((double)counts.gaps, N / 4.0, 10.0); /* gaps at both ends may not be counted */
    assert_close(counts.longest_gap, 0.0125, 1e-5);
    assert_true(wb_loss_is_significant(&loss));
}

/* An interruption of 100 s is too long to be counted as lost lines; it is reported elsewhere. */
static void interruption_is_not_counted_as_lost_lines(void **state)
{
    (void)state;
    struct wb_loss loss;
    wb_loss_init(&loss, false, 0.0);
    for (int i = 0; i < N; i++)
        if (i % 10 != 9)
            wb_loss_add(&loss, i * 0.0125 + (i < N / 2 ? 0.0 : 100.0));
    assert_close((double)wb_loss_counts(&loss).missing, N / 10.0, 6.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(complete_stream_of_frames_has_no_losses),
        cmocka_unit_test(lost_frames_are_counted_exactly),
        cmocka_unit_test(announced_rate_is_used_from_the_start),
        cmocka_unit_test(repeated_and_out_of_order_frames_are_not_missing),
        cmocka_unit_test(late_frames_at_either_end_are_not_missing),
        cmocka_unit_test(restarted_server_causes_no_loss),
        cmocka_unit_test(late_lines_and_stalls_are_not_counted_as_lost),
        cmocka_unit_test(lost_lines_are_counted),
        cmocka_unit_test(bundled_lines_have_no_period),
        cmocka_unit_test(invalid_and_extreme_times_are_tolerated),
        cmocka_unit_test(period_from_a_busy_computer_gives_no_losses),
        cmocka_unit_test(temporary_stall_is_not_reported_as_loss),
        cmocka_unit_test(bundles_of_a_busy_computer_give_no_period),
        cmocka_unit_test(late_lines_do_not_count_as_lost),
        cmocka_unit_test(lost_lines_are_counted_among_late_ones),
        cmocka_unit_test(loss_of_every_fourth_line_is_counted),
        cmocka_unit_test(interruption_is_not_counted_as_lost_lines),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
