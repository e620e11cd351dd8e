#include "fixtures/virtual/sim_mocap.h"
#include "fixtures/virtual/sim_mocap_private.h"

#include <stdlib.h>

#include "tests/virtual/setup.h"

static const struct wb_natnet_version v30 = {3, 0};

static double slope_at(int marker)
{
    return 0.15 * marker;
}

/* A wire that is not in equilibrium, with heights and slopes that differ from marker to marker. */
static void shape(const struct setup *setup, double travel, struct wb_live_wire_view *view)
{
    memset(view, 0, sizeof *view);
    view->travel = travel;
    view->n_markers = setup->specimen.n_markers;
    for (int i = 0; i < view->n_markers; i++) {
        view->x[i] = setup->specimen.markers[i];
        view->y[i] = 2.0 * WB_MM * i;
        view->angle[i] = slope_at(i);
    }
}

/* Actual position of marker m of that wire in the lab. */
static void expected(const struct setup *setup, int m, double travel, double lab[3])
{
    const double offset = setup->truth.marker_offsets[m];
    const double bench[3] = {setup->specimen.markers[m] - offset * sin(slope_at(m)),
                             2.0 * WB_MM * m + offset * cos(slope_at(m)) - travel, 0.0};
    wb_truth_to_lab(&setup->truth, 'y', bench, lab);
}

/* The measured marker nearest to a position; NULL if none is within 3 mm. */
static const struct wb_marker *nearest(const struct wb_mocap_frame *frame, const double lab[3])
{
    const struct wb_marker *best = NULL;
    double least = 3.0 * WB_MM;
    for (int i = 0; i < frame->n_markers; i++) {
        const struct wb_marker *const marker = &frame->markers[i];
        double squares = 0.0;
        for (int axis = 0; axis < 3; axis++)
            squares += pow((double)marker->position[axis] - lab[axis], 2.0);
        if (!(marker->params & WB_MARKER_OCCLUDED) && sqrt(squares) < least) {
            least = sqrt(squares);
            best = marker;
        }
    }
    return best;
}

static void markers_are_measured_with_their_noise(void **state)
{
    (void)state;
    struct setup setup;
    struct wb_sim_mocap mocap;
    struct wb_live_wire_view view;
    struct wb_natnet_frame *const frame = malloc(sizeof *frame);
    assert_non_null(frame);
    setup_bench(&setup, "type1-L85-1", 4);
    wb_sim_mocap_init(&mocap, &setup.truth, 'y', setup.specimen.n_markers, v30);
    double sum[3] = {0}, squares[3] = {0};
    int n = 0;
    for (uint64_t k = 0; k < 3000; k++) {
        const double travel = 1e-5 * (double)k;
        shape(&setup, travel, &view);
        wb_sim_mocap_frame(&mocap, k, &view, frame);
        for (int m = 0; m < setup.specimen.n_markers; m++) {
            double lab[3];
            expected(&setup, m, travel, lab);
            const struct wb_marker *const marker = nearest(&frame->mocap, lab);
            if (!marker)
                continue;
            n++;
            for (int axis = 0; axis < 3; axis++) {
                const double off = (double)marker->position[axis] - lab[axis];
                sum[axis] += off;
                squares[axis] += off * off;
            }
        }
    }
    assert_true(n > 7 * 3000 * 9 / 10);
    for (int axis = 0; axis < 3; axis++) {
        assert_close(sum[axis] / n, 0.0, 5.0 * 0.1 * WB_MM / sqrt(n));
        assert_close(sqrt(squares[axis] / n), 0.1 * WB_MM, 0.1 * WB_MM * 5.0 / sqrt(2.0 * n));
    }
    free(frame);
}

static void frames_depend_on_seed_and_number_only(void **state)
{
    (void)state;
    struct setup setup;
    struct wb_sim_mocap one, two;
    struct wb_live_wire_view view;
    struct wb_natnet_frame *const a = malloc(sizeof *a), *const b = malloc(sizeof *b);
    assert_non_null(a);
    assert_non_null(b);
    setup_bench(&setup, "type1-L85-1", 4);
    shape(&setup, 0.0, &view);
    wb_sim_mocap_init(&one, &setup.truth, 'y', 7, v30);
    wb_sim_mocap_init(&two, &setup.truth, 'y', 7, v30);
    for (uint64_t k = 0; k < 500; k++) {
        wb_sim_mocap_frame(&one, k, &view, a);
        wb_sim_mocap_frame(&two, k, &view, b);
        assert_memory_equal(a, b, sizeof *a);
    }
    free(a);
    free(b);
}

static void losses_are_short_often_and_long_rarely(void **state)
{
    (void)state;
    struct setup setup;
    struct wb_sim_mocap mocap;
    setup_bench(&setup, "type1-L85-1", 4);
    wb_sim_mocap_init(&mocap, &setup.truth, 'y', 7, v30);
    const uint64_t minutes = 120, n = minutes * 60 * 120;
    int shorts = 0, longs = 0, filled = 0;
    uint64_t lost = 0;
    for (int m = 0; m < 7; m++) {
        int run = 0;
        bool was_filled = false;
        for (uint64_t k = 0; k < n; k++) {
            const enum wb_sim_mocap_sight sight = wb_sim_mocap_sight(&mocap, m, k);
            if (sight != WB_SIM_MOCAP_SEEN) {
                run++;
                lost++;
                was_filled = was_filled || sight == WB_SIM_MOCAP_FILLED;
                continue;
            }
            shorts += run > 0 && run <= 24;
            longs += run > 24;
            filled += run > 0 && was_filled;
            run = 0;
            was_filled = false;
        }
    }
    /* Per marker: 1.8 short losses per minute and one long loss in 6 minutes. */
    assert_close((double)shorts / (7.0 * (double)minutes), 1.8, 0.25);
    assert_close((double)longs / (7.0 * (double)minutes), 0.16, 0.05);
    assert_close((double)filled / shorts, 0.4, 0.06);
    assert_true(lost < 7 * n / 100);
}

static void a_marker_returns_with_a_new_id(void **state)
{
    (void)state;
    struct setup setup;
    struct wb_sim_mocap mocap;
    struct wb_live_wire_view view;
    struct wb_natnet_frame *const frame = malloc(sizeof *frame);
    assert_non_null(frame);
    setup_bench(&setup, "type1-L85-1", 4);
    shape(&setup, 0.0, &view);
    wb_sim_mocap_init(&mocap, &setup.truth, 'y', 7, v30);
    int32_t id[7] = {0};
    bool seen[7] = {false};
    int changes = 0, kept = 0;
    for (uint64_t k = 0; k < 20000; k++) {
        wb_sim_mocap_frame(&mocap, k, &view, frame);
        for (int m = 0; m < 7; m++) {
            double lab[3];
            expected(&setup, m, 0.0, lab);
            const struct wb_marker *const marker = nearest(&frame->mocap, lab);
            if (marker && id[m] != 0 && seen[m]) {
                assert_int_equal(marker->id, id[m]);
                kept++;
            } else if (marker && id[m] != 0) {
                assert_true(marker->id > id[m]);
                changes++;
            }
            seen[m] = marker != NULL;
            if (marker)
                id[m] = marker->id;
        }
        for (int i = 0; i < frame->mocap.n_markers; i++)
            for (int j = 0; j < i; j++)
                assert_int_not_equal(frame->mocap.markers[i].id, frame->mocap.markers[j].id);
    }
    assert_true(changes > 10 && kept > 100000);
    free(frame);
}

static void the_order_changes_and_a_ghost_appears_at_times(void **state)
{
    (void)state;
    struct setup setup;
    struct wb_sim_mocap mocap;
    struct wb_live_wire_view view;
    struct wb_natnet_frame *const frame = malloc(sizeof *frame);
    assert_non_null(frame);
    setup_bench(&setup, "type1-L85-1", 4);
    shape(&setup, 0.0, &view);
    wb_sim_mocap_init(&mocap, &setup.truth, 'y', 7, v30);
    double first[3], ghost[3];
    expected(&setup, 3, 0.0, first);
    memcpy(ghost, setup.truth.ghost, sizeof ghost);
    int places[9] = {0}, ghosts = 0;
    for (uint64_t k = 0; k < 12000; k++) {
        wb_sim_mocap_frame(&mocap, k, &view, frame);
        const struct wb_marker *const marker = nearest(&frame->mocap, first);
        if (marker)
            places[marker - frame->mocap.markers]++;
        ghosts += nearest(&frame->mocap, ghost) != NULL;
        assert_int_equal(nearest(&frame->mocap, ghost) != NULL, wb_sim_mocap_ghost(&mocap, k));
    }
    for (int i = 0; i < 7; i++)
        assert_true(places[i] > 500);
    assert_true(ghosts > 200 && ghosts < 3000);
    free(frame);
}

/* Filled markers are flagged, wrong by millimetres, and absent if the protocol has no flag. */
static void filled_markers_are_flagged_and_wrong(void **state)
{
    (void)state;
    struct setup setup;
    struct wb_live_wire_view view;
    struct wb_natnet_frame *const frame = malloc(sizeof *frame);
    assert_non_null(frame);
    setup_bench(&setup, "type1-L85-1", 4);
    shape(&setup, 0.0, &view);
    for (int old = 0; old < 2; old++) {
        const struct wb_natnet_version version = {2, old ? 5 : 7};
        struct wb_sim_mocap mocap;
        wb_sim_mocap_init(&mocap, &setup.truth, 'y', 7, version);
        int filled = 0;
        for (uint64_t k = 0; k < 20000; k++) {
            wb_sim_mocap_frame(&mocap, k, &view, frame);
            for (int i = 0; i < frame->mocap.n_markers; i++) {
                const struct wb_marker *const marker = &frame->mocap.markers[i];
                if (!(marker->params & WB_MARKER_MODEL_FILLED))
                    continue;
                filled++;
                assert_true(marker->params & WB_MARKER_OCCLUDED);
                double least = 1.0;
                for (int m = 0; m < 7; m++) {
                    double lab[3], squares = 0.0;
                    expected(&setup, m, 0.0, lab);
                    for (int axis = 0; axis < 3; axis++)
                        squares += pow((double)marker->position[axis] - lab[axis], 2.0);
                    least = fmin(least, sqrt(squares));
                }
                assert_true(least > 0.5 * WB_MM && least < 4.0 * WB_MM);
            }
        }
        if (old)
            assert_int_equal(filled, 0);
        else
            assert_true(filled > 20);
    }
    free(frame);
}

static void the_clock_has_an_offset_of_hours_and_drifts(void **state)
{
    (void)state;
    struct setup setup;
    struct wb_sim_mocap mocap;
    setup_bench(&setup, "type1-L85-1", 4);
    wb_sim_mocap_init(&mocap, &setup.truth, 'y', 7, v30);
    const double rate = setup.truth.clock_frequency;
    assert_true(wb_sim_mocap_clock(&mocap, 0.0) > 7000.0);
    const double ran =
        (double)(wb_sim_mocap_ticks(&mocap, 1000.0) - wb_sim_mocap_ticks(&mocap, 0.0)) / rate;
    assert_close(fabs(ran - 1000.0), 0.05, 1e-6);
    /* Frames are equidistant on the server's own clock, and sent after their exposure. */
    for (uint64_t k = 0; k < 5000; k++) {
        const double t = wb_sim_mocap_time(&mocap, k), next = wb_sim_mocap_time(&mocap, k + 1);
        assert_close(wb_sim_mocap_clock(&mocap, next) - wb_sim_mocap_clock(&mocap, t), 1.0 / 120.0,
                     1e-9);
        const double delay = wb_sim_mocap_send_time(&mocap, k) - t;
        assert_true(delay > 1.7e-3 && delay < 3.0e-3);
    }
}

static void a_clock_that_restarts_shows_one_second(void **state)
{
    (void)state;
    struct setup setup;
    struct wb_sim_mocap mocap;
    setup_bench(&setup, "type1-L85-1", 3);
    wb_sim_mocap_init(&mocap, &setup.truth, 'y', 7, v30);
    assert_true(wb_sim_mocap_clock(&mocap, 50.0) > 3600.0);
    for (double t = 50.0; t < 100.0; t += 30.0) {
        wb_sim_mocap_restart_clock(&mocap, t);
        assert_close(wb_sim_mocap_clock(&mocap, t), 1.0, 1e-9);
        assert_close(wb_sim_mocap_clock(&mocap, t + 10.0), 11.0, 1e-3);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(markers_are_measured_with_their_noise),
        cmocka_unit_test(frames_depend_on_seed_and_number_only),
        cmocka_unit_test(losses_are_short_often_and_long_rarely),
        cmocka_unit_test(a_marker_returns_with_a_new_id),
        cmocka_unit_test(the_order_changes_and_a_ghost_appears_at_times),
        cmocka_unit_test(filled_markers_are_flagged_and_wrong),
        cmocka_unit_test(the_clock_has_an_offset_of_hours_and_drifts),
        cmocka_unit_test(a_clock_that_restarts_shows_one_second),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
