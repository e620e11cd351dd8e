#include "analysis/harness/harness_frames.h"

#include "analysis/harness/harness_run.h"
#include "tests/check.h"

enum {
    PLACES = 3,
    FORCES = 2
};

static struct wb_memory memory;
static struct wb_harness_frames frames;

static void begin(int wanted, bool is_motion)
{
    frames = (struct wb_harness_frames){
        .n_wanted = wanted, .n_places = PLACES, .n_forces = FORCES, .memory = &memory};
    wb_harness_frames_create(&frames);
    wb_harness_frames_begin(&frames, is_motion);
}

/* Offers a shape that is known by its number; true: it was taken. */
static bool offer(double fraction, int number)
{
    struct wb_harness_frame *const frame = wb_harness_frames_take(&frames, fraction);
    for (int i = 0; frame && i < PLACES; i++)
        frame->places[i].branch = number;
    if (frame)
        frame->forces[FORCES - 1].size = number;
    return frame;
}

static void expect(int n, const double *fractions, const int *numbers)
{
    assert_int_equal(frames.n, n);
    for (int i = 0; i < n; i++) {
        assert_close(frames.list[i].fraction, fractions[i], 1e-12);
        assert_int_equal(frames.list[i].places[PLACES - 1].branch, numbers[i]);
        assert_true(frames.list[i].forces[FORCES - 1].size == numbers[i]);
    }
}

static void first_increment_at_or_beyond_each_part_is_taken(void **unused)
{
    (void)unused;
    static const double offered[] = {0.1, 0.25, 0.3, 0.49, 0.8, 0.9, 1.0};
    static const double fractions[] = {0.25, 0.8};
    static const int numbers[] = {1, 4};
    begin(4, false);
    for (int i = 0; i < (int)(sizeof offered / sizeof offered[0]); i++)
        (void)offer(offered[i], i);
    wb_harness_frames_end(&frames, 1.0);
    expect(2, fractions, numbers);
    wb_memory_release(&memory);
}

/* Multiples of 1/N, which are not exact in binary. */
static void increment_on_each_part_is_taken(void **unused)
{
    (void)unused;
    for (int n = 2; n < 200; n++) {
        begin(n, false);
        for (int i = 1; i < n; i++)
            assert_true(offer(i * (1.0 / n), i));
        assert_false(offer(1.0, n));
        wb_harness_frames_end(&frames, 1.0);
        assert_int_equal(frames.n, n - 1);
    }
    wb_memory_release(&memory);
}

static void shape_after_a_snap_replaces_those_of_the_motion(void **unused)
{
    (void)unused;
    static const double fractions[] = {0.5};
    static const int numbers[] = {3};
    begin(2, false);
    assert_true(offer(0.5, 1));
    assert_true(offer(0.5, 2));
    assert_true(offer(0.5, 3));
    assert_false(offer(0.7, 4));
    wb_harness_frames_end(&frames, 1.0);
    expect(1, fractions, numbers);
    wb_memory_release(&memory);
}

/* A snap that does not come to rest ends the step before its fraction. */
static void frames_beyond_the_completed_part_are_dropped(void **unused)
{
    (void)unused;
    static const double fractions[] = {0.3};
    static const int numbers[] = {1};
    begin(4, false);
    (void)offer(0.3, 1);
    (void)offer(0.6, 2);
    wb_harness_frames_end(&frames, 0.4);
    expect(1, fractions, numbers);
    wb_memory_release(&memory);
}

/* The last step of a motion is the end of the release, which is not a frame. */
static void motion_is_thinned_evenly(void **unused)
{
    (void)unused;
    for (int wanted = 2; wanted < 12; wanted++) {
        for (int steps = 0; steps < 60; steps++) {
            begin(wanted, true);
            for (int i = 1; i <= steps; i++)
                (void)offer(1.0, i);
            wb_harness_frames_end(&frames, 1.0);
            assert_true(frames.n <= wanted - 1 &&
                        (steps == 0 || 2 * frames.n >= wanted - 1 || frames.n == steps));
            for (int i = 0; i < frames.n; i++) {
                const int number = (i + 1) * frames.stride;
                assert_int_equal(frames.list[i].places[0].branch, number);
                assert_close(frames.list[i].fraction, (double)number / (steps + 1), 1e-12);
            }
        }
    }
    wb_memory_release(&memory);
}

static void steps_keep_their_places(void **unused)
{
    (void)unused;
    begin(2, true);
    (void)offer(1.0, 7);
    const struct wb_harness_place *const kept = frames.list[0].places;
    wb_harness_frames_begin(&frames, false);
    (void)offer(0.5, 8);
    assert_int_equal(kept->branch, 7);
    wb_memory_release(&memory);
}

static void one_or_no_shape_is_the_end_alone(void **unused)
{
    (void)unused;
    for (int wanted = 0; wanted < 2; wanted++) {
        for (int motion = 0; motion < 2; motion++) {
            begin(wanted, motion == 1);
            assert_false(offer(0.5, 1));
            wb_harness_frames_end(&frames, 1.0);
            assert_int_equal(frames.n, 0);
        }
    }
    wb_memory_release(&memory);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(first_increment_at_or_beyond_each_part_is_taken),
        cmocka_unit_test(increment_on_each_part_is_taken),
        cmocka_unit_test(shape_after_a_snap_replaces_those_of_the_motion),
        cmocka_unit_test(frames_beyond_the_completed_part_are_dropped),
        cmocka_unit_test(motion_is_thinned_evenly),
        cmocka_unit_test(steps_keep_their_places),
        cmocka_unit_test(one_or_no_shape_is_the_end_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
