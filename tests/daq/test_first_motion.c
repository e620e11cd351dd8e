/* Comparison of cameras and stage in the first motion, with synthetic frames. */
#include "daq/test/first_motion.h"

#include <string.h>

#include "tests/check.h"

static const struct wb_specimen specimen = {
    .length = 0.085,
    .n_markers = 7,
    .markers = {0.0, 0.0142, 0.0283, 0.0425, 0.0567, 0.0708, 0.085},
};

static const struct wb_rig rig = {.mocap = {.up = 'y'}, .stage = {.down = 1}};

/* The clamp, marker 0, moved by `moved` (m); the tip stays. */
static void see(struct wb_mocap_frame *frame, const double moved[3])
{
    memset(frame, 0, sizeof *frame);
    frame->n_markers = specimen.n_markers;
    for (int m = 0; m < specimen.n_markers; m++) {
        const double part = 1.0 - specimen.markers[m] / specimen.length;
        frame->markers[m].position[0] = (float)(0.3 + specimen.markers[m] + part * moved[0]);
        frame->markers[m].position[1] = (float)(1.1 + part * moved[1]);
        frame->markers[m].position[2] = (float)(part * moved[2]);
    }
}

static bool judge(double x, double y, double z, double travel, char text[WB_START_CHECK_TEXT])
{
    static const double rest[3] = {0.0, 0.0, 0.0};
    struct wb_tip_watch watch = {0};
    struct wb_mocap_frame frame;
    see(&frame, rest);
    for (int k = 0; k < 5; k++)
        wb_tip_watch_rest(&watch, &frame, &specimen, rig.mocap.up);
    for (int k = 1; k <= 10; k++) {
        see(&frame, (const double[3]){0.1 * k * x, 0.1 * k * y, 0.1 * k * z});
        wb_tip_watch_follow(&watch, &frame);
    }
    return wb_first_motion_agrees(&watch, travel, 0.5e-3, &rig, text);
}

static void clamp_that_follows_the_stage_agrees(void **state)
{
    (void)state;
    char text[WB_START_CHECK_TEXT];
    assert_true(judge(0.0, -2.0e-3, 0.0, 2.0e-3, text));
    assert_true(judge(0.0, -2.5e-3, 0.0, 2.0e-3, text)); /* the report is older than the frame, */
    assert_true(judge(0.0, -1.2e-3, 0.0, 2.0e-3, text)); /* or younger */
    assert_true(judge(0.2e-3, -2.0e-3, 0.1e-3, 2.0e-3, text));
}

static void each_fault_is_reported_with_its_remedy(void **state)
{
    (void)state;
    static const struct {
        double moved[3];
        const char *word;
    } faults[] = {
        {{0.0, 0.0, 0.0}, "live mode"},
        {{0.0, -0.5e-3, 0.0}, "the clamp is fixed"},
        {{0.0, -6e-3, 0.0}, "($100)"},
        {{0.0, 0.0, -2e-3}, "set mocap.up"},
        {{2e-3, 0.1e-3, 0.0}, "not along y"},
        {{0.0, 2e-3, 0.0}, "set stage.down of the rig file to -1"},
    };
    for (size_t i = 0; i < sizeof faults / sizeof faults[0]; i++) {
        const double *const m = faults[i].moved;
        char text[WB_START_CHECK_TEXT] = "";
        assert_false(judge(m[0], m[1], m[2], 2e-3, text));
        if (!strstr(text, faults[i].word))
            fail_msg("fault %zu: '%s'", i, text);
    }
}

static void wire_without_markers_at_rest_is_not_judged(void **state)
{
    (void)state;
    const struct wb_tip_watch watch = {0};
    char text[WB_START_CHECK_TEXT];
    assert_true(wb_first_motion_agrees(&watch, 2e-3, 0.5e-3, &rig, text));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(clamp_that_follows_the_stage_agrees),
        cmocka_unit_test(each_fault_is_reported_with_its_remedy),
        cmocka_unit_test(wire_without_markers_at_rest_is_not_judged),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
