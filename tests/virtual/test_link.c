/* Effects of the network on frames, fault by fault. */
#include "fixtures/virtual/link.h"

#include <math.h>

#include "tests/check.h"

#define FRAMES 4000
#define PERIOD 0.01

struct arrivals {
    int n, n_garbage;
    uint64_t k[2 * FRAMES];
    double due[2 * FRAMES];
};

/* Sends frames one period apart, taking all due frames before each. */
static void pass(const char *list, uint64_t seed, struct arrivals *arrivals)
{
    static struct wb_link link;
    static struct wb_natnet_frame frame;
    struct wb_faults faults;
    assert_int_equal(wb_faults_read(&faults, list), WB_OK);
    wb_link_init(&link, &faults, seed, PERIOD);
    memset(arrivals, 0, sizeof *arrivals);
    for (uint64_t k = 0; k <= FRAMES; k++) {
        const double t = (double)k * PERIOD;
        while (wb_link_next(&link) <= (k < FRAMES ? t : HUGE_VAL) && link.n > 0) {
            const double next = wb_link_next(&link);
            const struct wb_link_frame *const taken = wb_link_take(&link);
            assert_true(taken->due == next);
            arrivals->n_garbage += taken->garbage;
            if (taken->garbage)
                continue;
            assert_int_equal(taken->frame.mocap.frame_number, (int)taken->k);
            arrivals->k[arrivals->n] = taken->k;
            arrivals->due[arrivals->n++] = taken->due;
        }
        frame.mocap.frame_number = (int32_t)k;
        if (k < FRAMES)
            wb_link_put(&link, k, t, &frame);
    }
}

static struct arrivals got, again;

/* Number of arrivals that repeat or precede the last frame. */
static int backwards(const struct arrivals *arrivals)
{
    int n = 0;
    for (int i = 1; i < arrivals->n; i++)
        n += arrivals->k[i] < arrivals->k[i - 1];
    return n;
}

static int repeated(const struct arrivals *arrivals)
{
    int n = 0;
    for (int i = 1; i < arrivals->n; i++)
        n += arrivals->k[i] == arrivals->k[i - 1];
    return n;
}

static void without_faults_every_frame_arrives_when_it_is_sent(void **state)
{
    (void)state;
    pass("", 1, &got);
    assert_int_equal(got.n, FRAMES);
    for (int i = 0; i < got.n; i++) {
        assert_int_equal(got.k[i], i);
        assert_close(got.due[i], (double)i * PERIOD, 0.0);
    }
}

static void loss_drops_frames(void **state)
{
    (void)state;
    pass("loss=10", 1, &got);
    assert_true(got.n > 0.87 * FRAMES && got.n < 0.93 * FRAMES);
    assert_int_equal(backwards(&got) + repeated(&got) + got.n_garbage, 0);
    pass("loss=100", 1, &got);
    assert_int_equal(got.n, 0);
}

static void duplicates_arrive_in_succession(void **state)
{
    (void)state;
    pass("duplicates=10", 1, &got);
    assert_int_equal(got.n, FRAMES + repeated(&got));
    assert_true(repeated(&got) > 0.07 * FRAMES && repeated(&got) < 0.13 * FRAMES);
    assert_int_equal(backwards(&got), 0);
}

static void reordered_frames_arrive_after_the_next(void **state)
{
    (void)state;
    pass("reorder=10", 1, &got);
    assert_int_equal(got.n, FRAMES);
    assert_true(backwards(&got) > 0.06 * FRAMES);
    assert_int_equal(repeated(&got), 0);
}

static void delayed_frames_keep_their_order(void **state)
{
    (void)state;
    double longest = 0.0;
    pass("delay=50", 1, &got);
    assert_int_equal(got.n, FRAMES);
    for (int i = 0; i < got.n; i++) {
        const double wait = got.due[i] - (double)i * PERIOD;
        assert_int_equal(got.k[i], i);
        assert_true(wait >= 0.0 && wait <= 0.05 + 1e-9);
        longest = fmax(longest, wait);
    }
    assert_true(longest > 0.049);
}

static void garbage_arrives_in_addition_to_frames(void **state)
{
    (void)state;
    pass("garbage=10", 1, &got);
    assert_int_equal(got.n, FRAMES);
    assert_true(got.n_garbage > 0.07 * FRAMES && got.n_garbage < 0.13 * FRAMES);
}

static void the_seed_decides_which_frames(void **state)
{
    (void)state;
    static const char list[] = "loss=3,duplicates=3,reorder=3,delay=30,garbage=3";
    pass(list, 5, &got);
    pass(list, 5, &again);
    assert_memory_equal(&got, &again, sizeof got);
    pass(list, 6, &again);
    assert_memory_not_equal(&got, &again, sizeof got);
}

static void frames_beyond_the_capacity_are_lost(void **state)
{
    (void)state;
    static struct wb_link link;
    static const struct wb_natnet_frame frame;
    const struct wb_faults faults = {0};
    wb_link_init(&link, &faults, 1, PERIOD);
    for (uint64_t k = 0; k < 2 * WB_LINK_FRAMES; k++)
        wb_link_put(&link, k, 0.0, &frame);
    for (uint64_t k = 0; k < WB_LINK_FRAMES - 1; k++)
        assert_int_equal(wb_link_take(&link)->k, k);
    assert_true(isinf(wb_link_next(&link)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(without_faults_every_frame_arrives_when_it_is_sent),
        cmocka_unit_test(loss_drops_frames),
        cmocka_unit_test(duplicates_arrive_in_succession),
        cmocka_unit_test(reordered_frames_arrive_after_the_next),
        cmocka_unit_test(delayed_frames_keep_their_order),
        cmocka_unit_test(garbage_arrives_in_addition_to_frames),
        cmocka_unit_test(the_seed_decides_which_frames),
        cmocka_unit_test(frames_beyond_the_capacity_are_lost),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
