/* Tracking of the specimen's markers from frame to frame. */
#include <string.h>

#include "base/units.h"
#include "live/live_shape.h"
#include "tests/check.h"

#define MARKERS 5
#define SPACING (20.0 * WB_MM)

static const struct wb_specimen specimen = {
    .length = 4.0 * SPACING,
    .n_markers = MARKERS,
    .markers = {0.0, SPACING, 2.0 * SPACING, 3.0 * SPACING, 4.0 * SPACING},
};

/* A wire along z whose clamp, at z = 0 or with `turned` at the far end, has sunk by `sunk`, and
 * whose markers follow a parabola; bits of `hidden` are occluded. */
static void make_frame(struct wb_mocap_frame *frame, double sunk, bool turned, unsigned hidden)
{
    memset(frame, 0, sizeof *frame);
    frame->n_markers = MARKERS;
    for (int i = 0; i < MARKERS; i++) {
        struct wb_marker *const marker = &frame->markers[turned ? MARKERS - 1 - i : i];
        const double along = i / (double)(MARKERS - 1);
        marker->position[0] = 0.3f;
        marker->position[1] = (float)(1.0 - sunk * (1.0 - along * along));
        marker->position[2] = (float)(0.5 + (turned ? -1.0 : 1.0) * i * SPACING);
        marker->params = hidden >> i & 1u ? WB_MARKER_OCCLUDED : 0;
    }
}

static void follow(struct wb_live_shape *shape, bool turned, unsigned hidden)
{
    struct wb_mocap_frame frame;
    for (int step = 0; step <= 40; step++) {
        make_frame(&frame, step * 0.5 * WB_MM, turned, step > 5 && step < 38 ? hidden : 0);
        wb_live_shape_follow(shape, &frame, &specimen, 'y');
    }
}

static void assert_parabola(const struct wb_live_shape *shape)
{
    for (int i = 0; i < MARKERS; i++) {
        const double along = i / (double)(MARKERS - 1);
        float place[2];
        wb_live_shape_place(shape, i, place);
        assert_close((double)place[0], i * SPACING, 1e-6);
        assert_close((double)place[1], 20.0 * WB_MM * along * along, 1e-6);
    }
}

static void markers_are_counted_from_the_clamp_at_either_end(void **state)
{
    (void)state;
    for (int turned = 0; turned < 2; turned++) {
        struct wb_live_shape shape = {0};
        follow(&shape, turned, 0);
        assert_true(shape.is_found && shape.is_clamp_known);
        assert_parabola(&shape);
        assert_int_equal(wb_live_shape_seen(&shape), 0x1f);
    }
}

static void hidden_marker_is_reported_and_found_again_on_the_bent_wire(void **state)
{
    (void)state;
    struct wb_mocap_frame frame;
    for (int turned = 0; turned < 2; turned++) {
        struct wb_live_shape shape = {0};
        follow(&shape, turned, 1u << 3);
        assert_parabola(&shape);
        assert_int_equal(wb_live_shape_seen(&shape), 0x1f);
        make_frame(&frame, 20.0 * WB_MM, turned, 1u << 3);
        wb_live_shape_follow(&shape, &frame, &specimen, 'y');
        assert_int_equal(wb_live_shape_seen(&shape), 0x17);
    }
}

static void tracking_begins_after_all_markers_were_seen_in_one_frame(void **state)
{
    (void)state;
    struct wb_live_shape shape = {0};
    struct wb_mocap_frame frame;
    make_frame(&frame, 0.0, false, 1u << 2);
    for (int i = 0; i < 50; i++)
        wb_live_shape_follow(&shape, &frame, &specimen, 'y');
    assert_false(shape.is_found);
    make_frame(&frame, 0.0, false, 0);
    for (int i = 0; i < 50; i++)
        wb_live_shape_follow(&shape, &frame, &specimen, 'y');
    assert_true(shape.is_found);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(markers_are_counted_from_the_clamp_at_either_end),
        cmocka_unit_test(hidden_marker_is_reported_and_found_again_on_the_bent_wire),
        cmocka_unit_test(tracking_begins_after_all_markers_were_seen_in_one_frame),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
