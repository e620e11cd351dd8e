/* The start check: markers identified by geometry, zero, stage; and the gate that limits remarks.
 */
#include <stdlib.h>

#include "base/units.h"
#include "daq/acquire/marker_check.h"
#include "daq/acquire/remark_gate.h"
#include "daq/test/start_check.h"
#include "tests/check.h"

#define N 7

static const struct wb_specimen specimen = {
    .length = 0.085,
    .n_markers = N,
    .markers = {0.0, 0.0142, 0.0283, 0.0425, 0.0567, 0.0708, 0.085},
};

/* Marker m on a wire with a bow of `bow` (m at the tip), turned by an angle about the vertical and
 * shifted, as the cameras' frame is arbitrary. */
static void place(struct wb_mocap_frame *frame, int m, double bow, double angle)
{
    const double s = specimen.markers[m];
    const double y = bow * (s / specimen.length) * (s / specimen.length) + 1e-3;
    struct wb_marker *const marker = &frame->markers[frame->n_markers++];
    memset(marker, 0, sizeof *marker);
    marker->position[0] = (float)(0.3 + s * cos(angle));
    marker->position[1] = (float)(1.1 + y);
    marker->position[2] = (float)(-0.7 + s * sin(angle));
}

static void stray(struct wb_mocap_frame *frame, double x, double y, double z)
{
    struct wb_marker *const marker = &frame->markers[frame->n_markers++];
    memset(marker, 0, sizeof *marker);
    marker->position[0] = (float)x;
    marker->position[1] = (float)y;
    marker->position[2] = (float)z;
}

static int count(const struct wb_mocap_frame *frame)
{
    struct wb_marker_places places;
    wb_marker_check_frame(frame, &specimen, &places);
    int counted = 0;
    for (int m = 0; m < N; m++)
        counted += places.index[m] >= 0;
    assert_int_equal(counted, places.n_seen);
    return counted;
}

static void all_markers_of_a_bowed_wire_are_found_at_any_angle(void **state)
{
    (void)state;
    for (int k = 0; k < 12; k++) {
        struct wb_mocap_frame frame = {.n_markers = 0};
        for (int m = N - 1; m >= 0; m--)
            place(&frame, m, k % 2 ? 4e-3 : -4e-3, 0.5 * k);
        assert_int_equal(count(&frame), N);
    }
}

static void each_missing_marker_is_detected_and_not_replaced_by_a_stray(void **state)
{
    (void)state;
    for (int missing = 0; missing < N; missing++) {
        struct wb_mocap_frame frame = {.n_markers = 0};
        struct wb_marker_places places;
        stray(&frame, 0.35, 1.14, -0.7);
        stray(&frame, 0.1, 0.9, -0.2);
        for (int m = 0; m < N; m++)
            if (m != missing)
                place(&frame, m, 3e-3, 0.4);
        wb_marker_check_frame(&frame, &specimen, &places);
        assert_int_equal(places.n_seen, N - 1);
        /* The spacing is symmetric to 0.1 mm, so that either end may be taken for the clamp. */
        assert_true(places.index[missing] < 0 || places.index[N - 1 - missing] < 0);
        for (int m = 0; m < N; m++)
            assert_true(places.index[m] < 0 || places.index[m] >= 2); /* no stray */
    }
}

static void occluded_and_filled_in_markers_are_not_seen(void **state)
{
    (void)state;
    struct wb_mocap_frame frame = {.n_markers = 0};
    for (int m = 0; m < N; m++)
        place(&frame, m, 0.0, 0.0);
    frame.markers[2].params = WB_MARKER_OCCLUDED;
    frame.markers[4].params = WB_MARKER_MODEL_FILLED;
    assert_int_equal(count(&frame), N - 2);
}

static void zero_one_and_too_many_markers_are_handled(void **state)
{
    (void)state;
    struct wb_mocap_frame frame = {.n_markers = 0};
    assert_int_equal(count(&frame), 0);
    place(&frame, 0, 0.0, 0.0);
    assert_int_equal(count(&frame), 1);
    for (int m = 1; m < N; m++)
        place(&frame, m, 0.0, 0.0);
    srand(1);
    while (frame.n_markers < WB_MAX_MARKERS)
        stray(&frame, rand() % 1000 * 1e-3, rand() % 1000 * 1e-3, rand() % 1000 * 1e-3);
    assert_int_equal(count(&frame), N);
    frame.markers[3].position[0] = NAN;
    assert_true(count(&frame) >= N - 1);
}

static void marker_may_be_lost_in_less_than_half_of_the_frames(void **state)
{
    (void)state;
    for (int lost = 4; lost <= 6; lost += 2) {
        struct wb_start_check check = {0};
        char text[WB_START_CHECK_TEXT] = "";
        for (int k = 0; k < 10; k++) {
            struct wb_mocap_frame frame = {.n_markers = 0};
            for (int m = 0; m < N; m++)
                if (m != 3 || k >= lost)
                    place(&frame, m, 2e-3, 1.0);
            wb_start_check_frame(&check, &frame, &specimen);
        }
        assert_int_equal(wb_start_check_markers(&check, &specimen, text), lost < 5);
        if (lost > 5)
            assert_string_equal(text,
                                "6 of 7 markers seen; missing, counted from one end: 4 (42.5 mm)");
    }
}

/* 20 frames of all markers, which jitter by `noise` m up and down and along, times `factor`. */
static struct wb_start_check frames(double noise, double factor)
{
    struct wb_start_check check = {0};
    for (int k = 0; k < 20; k++) {
        struct wb_mocap_frame frame = {.n_markers = 0};
        for (int m = 0; m < N; m++) {
            place(&frame, m, 2e-3, 1.0);
            for (int c = 0; c < 3; c++)
                frame.markers[m].position[c] =
                    (float)(factor * ((double)frame.markers[m].position[c] +
                                      noise * (((k + m + c) % 2) ? 1.0 : -1.0)));
        }
        wb_start_check_frame(&check, &frame, &specimen);
    }
    return check;
}

static void identical_frames_are_rejected(void **state)
{
    (void)state;
    const struct wb_rig rig = {.name = ""};
    char text[WB_START_CHECK_TEXT] = "";
    const struct wb_start_check measured = frames(1e-4, 1.0), still = frames(0.0, 1.0);
    assert_true(wb_start_check_markers(&still, &specimen, text));
    assert_false(wb_start_check_chain(&still, &specimen, &rig, text));
    assert_non_null(strstr(text, "identical in 20 frames"));
    assert_true(wb_start_check_chain(&measured, &specimen, &rig, text));
}

static void wrong_camera_scale_is_distinguished_from_a_wrong_file(void **state)
{
    (void)state;
    const struct wb_rig rig = {.name = ""};
    char text[WB_START_CHECK_TEXT] = "";
    struct wb_start_check check = frames(1e-4, 1.03);
    assert_false(wb_start_check_chain(&check, &specimen, &rig, text));
    assert_non_null(strstr(text, "measure 87.6 mm"));
    assert_non_null(strstr(text, "scale is off by +3.0 %"));
    check = frames(1e-4, 1000.0);
    assert_false(wb_start_check_markers(&check, &specimen, text));
    assert_non_null(strstr(text, "millimetres"));
}

static void model_filled_markers_are_reported(void **state)
{
    (void)state;
    struct wb_start_check check = {0};
    struct wb_mocap_frame frame = {.n_markers = 0};
    char text[WB_START_CHECK_TEXT] = "";
    for (int m = 0; m < N; m++) {
        place(&frame, m, 0.0, 0.0);
        frame.markers[m].params = m % 2 ? WB_MARKER_MODEL_FILLED : WB_MARKER_OCCLUDED;
    }
    wb_start_check_frame(&check, &frame, &specimen);
    assert_false(wb_start_check_markers(&check, &specimen, text));
    assert_non_null(strstr(text, "filled in by a model"));
}

static struct wb_start_check readings(double mean, double deviation)
{
    struct wb_start_check check = {0};
    for (int k = 0; k < 40; k++)
        wb_average_add(&check.load, mean + (k % 2 ? deviation : -deviation));
    return check;
}

static void zero_is_judged_by_capacity_and_noise(void **state)
{
    (void)state;
    struct wb_rig rig = {.gravity = 9.81, .load_cell = {.capacity = 0.2, .noise = 1e-4}};
    char text[WB_START_CHECK_TEXT];
    struct wb_start_check check = readings(0.019, 1e-4);
    assert_true(wb_start_check_zero(&check, &rig, "my/rig.yaml", text));
    check = readings(0.021, 1e-4);
    assert_false(wb_start_check_zero(&check, &rig, "my/rig.yaml", text));
    assert_non_null(strstr(text, "'wirebench stage my/rig.yaml release'"));
    check = readings(-0.021, 1e-4);
    assert_false(wb_start_check_zero(&check, &rig, "my/rig.yaml", text));
    check = readings(0.0, 6e-4);
    assert_false(wb_start_check_zero(&check, &rig, "my/rig.yaml", text));
    assert_non_null(strstr(text, "noise"));
    rig.load_cell.noise = 0.0; /* not known: 1 % of the capacity */
    assert_true(wb_start_check_zero(&check, &rig, "my/rig.yaml", text));
    check = readings(0.0, 2.1e-3);
    assert_false(wb_start_check_zero(&check, &rig, "my/rig.yaml", text));
}

static void tare_with_the_counterweight_expects_its_weight(void **state)
{
    (void)state;
    struct wb_rig rig = {.gravity = 10.0,
                         .load_cell = {.capacity = 0.2, .noise = 1e-4},
                         .strand = {.length = 0.76, .counterweight = 2.7e-3}};
    char text[WB_START_CHECK_TEXT];
    struct wb_start_check check = readings(0.027, 1e-4);
    assert_false(wb_start_check_zero(&check, &rig, "rig.yaml", text));
    assert_close(wb_rig_tare_load(&rig), 0.0, 0.0);
    rig.load_cell.tare = WB_RIG_TARE_COUNTERWEIGHT;
    assert_close(wb_rig_tare_load(&rig), 0.027, 1e-15);
    assert_true(wb_start_check_zero(&check, &rig, "rig.yaml", text));
    check = readings(0.040, 1e-4);
    assert_true(wb_start_check_zero(&check, &rig, "rig.yaml", text));
    check = readings(0.041, 1e-4);
    assert_false(wb_start_check_zero(&check, &rig, "rig.yaml", text));
    /* An unloaded cell within a tenth of its capacity of the counterweight is rejected, */
    check = readings(0.0, 1e-4);
    assert_false(wb_start_check_zero(&check, &rig, "rig.yaml", text));
    assert_non_null(strstr(text, "load_cell.tare is counterweight"));
    /* also a heavy counterweight with a larger deviation. */
    rig.strand.counterweight = 10e-3;
    check = readings(0.121, 1e-4);
    assert_false(wb_start_check_zero(&check, &rig, "rig.yaml", text));
    check = readings(0.119, 1e-4);
    assert_true(wb_start_check_zero(&check, &rig, "rig.yaml", text));
}

static void stage_must_be_idle_at_a_known_position(void **state)
{
    (void)state;
    static const struct {
        enum wb_stage_state state;
        const char *words;
    } refused[] = {{WB_STAGE_JOG, "'wirebench stage my/rig.yaml unlock'"},
                   {WB_STAGE_HOLD, "'wirebench stage my/rig.yaml release'"},
                   {WB_STAGE_ALARM, "'wirebench stage my/rig.yaml unlock'"},
                   {WB_STAGE_OTHER, "'wirebench stage my/rig.yaml unlock'"},
                   {WB_STAGE_UNKNOWN, "'wirebench stage my/rig.yaml unlock'"}};
    char text[WB_START_CHECK_TEXT];
    struct wb_stage_report report = {.state = WB_STAGE_IDLE, .position = 0.1};
    assert_true(wb_start_check_stage(&report, "my/rig.yaml", text));
    report.position = (double)NAN;
    assert_false(wb_start_check_stage(&report, "my/rig.yaml", text));
    for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++) {
        report = (struct wb_stage_report){.state = refused[i].state, .position = 0.1};
        assert_false(wb_start_check_stage(&report, "my/rig.yaml", text));
        if (!strstr(text, refused[i].words))
            fail_msg("'%s' does not contain %s", text, refused[i].words);
    }
}

static void average_agrees_with_the_definition(void **state)
{
    (void)state;
    struct wb_average average = {0};
    assert_close(wb_average_deviation(&average), 0.0, 0.0);
    const double values[] = {2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0};
    for (int i = 0; i < 8; i++)
        wb_average_add(&average, values[i]);
    assert_close(average.mean, 5.0, 1e-15);
    assert_close(wb_average_deviation(&average), sqrt(32.0 / 7.0), 1e-15);
}

static void gate_stores_20_a_second_and_counts_the_rest(void **state)
{
    (void)state;
    struct wb_remark_gate gate = {0};
    unsigned held = 99;
    int stored = 0;
    for (int i = 0; i < 50; i++)
        stored += wb_remark_gate_store(&gate, 5 * WB_NS_PER_S + i, &held);
    assert_int_equal(stored, 20);
    assert_int_equal(held, 0);
    assert_true(wb_remark_gate_store(&gate, 6 * WB_NS_PER_S, &held));
    assert_int_equal(held, 30);
    assert_true(wb_remark_gate_store(&gate, 6 * WB_NS_PER_S + 1, &held));
    assert_int_equal(held, 0);
}

static void gate_shows_each_kind_once_in_10_s(void **state)
{
    (void)state;
    struct wb_remark_gate gate = {0};
    const int64_t t_ns = 100 * WB_NS_PER_S;
    assert_true(wb_remark_gate_show(&gate, t_ns, "refused"));
    assert_false(wb_remark_gate_show(&gate, t_ns + 1, "refused"));
    assert_true(wb_remark_gate_show(&gate, t_ns + 2, "alarm"));
    assert_false(wb_remark_gate_show(&gate, t_ns + 9 * WB_NS_PER_S, "refused"));
    assert_true(wb_remark_gate_show(&gate, t_ns + 10 * WB_NS_PER_S, "refused"));
    for (int i = 0; i < 40; i++) {
        char kind[16];
        snprintf(kind, sizeof kind, "kind%d", i);
        assert_true(wb_remark_gate_show(&gate, t_ns + 20 * WB_NS_PER_S + i, kind));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_markers_of_a_bowed_wire_are_found_at_any_angle),
        cmocka_unit_test(each_missing_marker_is_detected_and_not_replaced_by_a_stray),
        cmocka_unit_test(occluded_and_filled_in_markers_are_not_seen),
        cmocka_unit_test(zero_one_and_too_many_markers_are_handled),
        cmocka_unit_test(marker_may_be_lost_in_less_than_half_of_the_frames),
        cmocka_unit_test(identical_frames_are_rejected),
        cmocka_unit_test(wrong_camera_scale_is_distinguished_from_a_wrong_file),
        cmocka_unit_test(model_filled_markers_are_reported),
        cmocka_unit_test(zero_is_judged_by_capacity_and_noise),
        cmocka_unit_test(tare_with_the_counterweight_expects_its_weight),
        cmocka_unit_test(stage_must_be_idle_at_a_known_position),
        cmocka_unit_test(average_agrees_with_the_definition),
        cmocka_unit_test(gate_stores_20_a_second_and_counts_the_rest),
        cmocka_unit_test(gate_shows_each_kind_once_in_10_s),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
