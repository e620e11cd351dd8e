/* The deflection in the status line: tracked from frame to frame for either order of the ends, with
 * hidden markers and strays. */
#include "base/units.h"
#include "daq/test/tip_watch.h"
#include "tests/check.h"

static const struct wb_specimen specimen = {
    .length = 0.06,
    .n_markers = 4,
    .markers = {0.0, 0.02, 0.04, 0.06},
};

static void set(struct wb_mocap_frame *frame, char up, double x, double height)
{
    struct wb_marker *const marker = &frame->markers[frame->n_markers++];
    memset(marker, 0, sizeof *marker);
    marker->position[0] = (float)(0.1 + x);
    marker->position[up == 'z' ? 2 : 1] = (float)(1.0 + height);
    marker->position[up == 'z' ? 1 : 2] = 0.3F;
}

/* A wire whose clamp has moved down by `travel`; the tip keeps its height and moves inwards. */
static struct wb_mocap_frame view(char up, bool backwards, double travel, bool tip_hidden)
{
    struct wb_mocap_frame frame = {.n_markers = 0};
    set(&frame, up, 0.5, 0.4);
    for (int k = 0; k < 4; k++) {
        const int m = backwards ? 3 - k : k;
        const double share = m / 3.0;
        set(&frame, up, 0.02 * m - 0.3 * travel * share, -travel * (1.0 - share));
        if (m == 3 && tip_hidden)
            frame.markers[frame.n_markers - 1].params = WB_MARKER_OCCLUDED;
    }
    return frame;
}

static double deflection_after(char up, bool backwards, double travel)
{
    struct wb_tip_watch watch = {0};
    struct wb_mocap_frame frame;
    for (int k = 0; k < 10; k++) {
        frame = view(up, backwards, 0.0, false);
        wb_tip_watch_rest(&watch, &frame, &specimen, up);
    }
    assert_true(watch.settled);
    const int n = 400;
    for (int k = 0; k <= n + 100; k++) {
        const bool hidden = k > 100 && k < 130;
        frame = view(up, backwards, k < n ? travel * k / n : travel, hidden);
        wb_tip_watch_follow(&watch, &frame);
    }
    return watch.deflection;
}

static void deflection_is_the_tip_s_rise_above_the_clamp(void **state)
{
    (void)state;
    assert_close(deflection_after('y', false, 0.03), 0.03, 1e-5);
    assert_close(deflection_after('y', true, 0.03), 0.03, 1e-5);
    assert_close(deflection_after('z', false, 0.03), 0.03, 1e-5);
}

static void both_ends_are_needed_for_the_rest(void **state)
{
    (void)state;
    struct wb_tip_watch watch = {0};
    for (int k = 0; k < 10; k++) {
        struct wb_mocap_frame frame = view('y', false, 0.0, true);
        wb_tip_watch_rest(&watch, &frame, &specimen, 'y');
        wb_tip_watch_follow(&watch, &frame);
    }
    assert_false(watch.settled);
    assert_close(watch.deflection, 0.0, 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(deflection_is_the_tip_s_rise_above_the_clamp),
        cmocka_unit_test(both_ends_are_needed_for_the_rest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
