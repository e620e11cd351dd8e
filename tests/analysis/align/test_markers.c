/* Identification of markers: chains at the start, following, losses, strays. */
#include "analysis/align/markers_private.h"

#include <stdlib.h>

#include "base/log.h"
#include "tests/check.h"

#define N 7

static const double arcs[N] = {0.0, 0.0142, 0.0283, 0.0425, 0.0567, 0.0708, 0.085};
static uint64_t seed = 1;

static double uniform(void)
{
    seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(seed >> 11) * 0x1p-53;
}

static double noise(void)
{
    return 0.1e-3 * (uniform() + uniform() + uniform() + uniform() - 2.0) * sqrt(3.0);
}

static void quiet(void *context, enum wb_log_level level, const char *domain, const char *message)
{
    (void)context;
    (void)level;
    (void)domain;
    (void)message;
}

static struct wb_specimen specimen_of(const double *s, int n)
{
    struct wb_specimen specimen = {.length = s[n - 1], .n_markers = n};
    memcpy(specimen.markers, s, (size_t)n * sizeof *s);
    return specimen;
}

/* A wire bent to a circle by `angle` in all, its clamp at height `clamp`. */
static void place(double s, double length, double angle, double clamp, double p[3])
{
    const double kappa = angle / length + 1e-9;
    const double x = sin(kappa * s) / kappa, y = (1.0 - cos(kappa * s)) / kappa;
    p[0] = 0.3 + 0.6 * x;
    p[1] = clamp + y;
    p[2] = -0.2 + 0.8 * x;
}

struct scene {
    const double *s;
    int n, n_frames;
    int hidden;                    /* marker, -1: none */
    int hidden_from, hidden_until; /* frames */
    int all_hidden_from, all_hidden_until;
    int n_strays;
    bool carried_stray; /* one stray moves with the wire, 6 mm above marker 3 */
    double bend;        /* rad over the whole recording */
};

/* Fills a cloud; the true marker of every point goes into `truth` (-1: stray). */
static void film(const struct scene *scene, struct wb_point_cloud *cloud, int *truth)
{
    static struct wb_mocap_frame frame;
    size_t n_truth = 0;
    memset(cloud, 0, sizeof *cloud);
    seed = 17;
    for (int f = 0; f < scene->n_frames; f++) {
        const double part = (double)f / scene->n_frames;
        frame = (struct wb_mocap_frame){.t_ns = f, .t_device = f / 120.0};
        const bool none = f >= scene->all_hidden_from && f < scene->all_hidden_until;
        for (int k = 0; k < scene->n + scene->n_strays; k++) {
            const int i = (k + f) % (scene->n + scene->n_strays);
            double p[3];
            if (i < scene->n) {
                if (none ||
                    (i == scene->hidden && f >= scene->hidden_from && f < scene->hidden_until))
                    continue;
                place(scene->s[i], scene->s[scene->n - 1], scene->bend * part, 1.0 - 0.05 * part,
                      p);
            } else if (i == scene->n && scene->carried_stray) {
                place(scene->s[3], scene->s[scene->n - 1], scene->bend * part, 1.006 - 0.05 * part,
                      p);
            } else {
                p[0] = 0.3 + 0.06 * (i - scene->n);
                p[1] = 0.98;
                p[2] = -0.16;
            }
            struct wb_marker *const marker = &frame.markers[frame.n_markers++];
            marker->id = 7 * f + k; /* arbitrary */
            for (int axis = 0; axis < 3; axis++)
                marker->position[axis] = (float)(p[axis] + noise());
            truth[n_truth++] = i < scene->n ? i : -1;
        }
        wb_point_cloud_add(cloud, &frame);
    }
}

struct score {
    int right, wrong, missed;
};

static struct score score(const struct wb_marker_tracks *tracks, const struct wb_point_cloud *cloud,
                          const int *truth, bool reversed)
{
    struct score score = {0};
    for (size_t f = 0; f < cloud->n_frames; f++) {
        for (int i = 0; i < tracks->n_markers; i++) {
            const int expected = reversed ? tracks->n_markers - 1 - i : i;
            const int32_t index = tracks->index[f * (size_t)tracks->n_markers + (size_t)i];
            bool there = false;
            for (int k = 0; k < cloud->frames[f].n; k++)
                there = there || truth[cloud->frames[f].first + (size_t)k] == expected;
            if (index >= 0 && truth[index] == expected)
                score.right++;
            else if (index >= 0)
                score.wrong++;
            else if (there)
                score.missed++;
        }
    }
    return score;
}

static int truth[40000];

static struct score run(const struct scene *scene, struct wb_marker_tracks *tracks)
{
    struct wb_point_cloud cloud;
    const struct wb_specimen specimen = specimen_of(scene->s, scene->n);
    const struct wb_marker_settings settings = {0};
    film(scene, &cloud, truth);
    assert_int_equal(wb_markers_track(tracks, &cloud, &specimen, &settings, NULL), WB_OK);
    struct score result = score(tracks, &cloud, truth, false);
    /* Equal spacings cannot distinguish the ends. */
    if (tracks->symmetric && result.right < result.wrong)
        result = score(tracks, &cloud, truth, true);
    wb_point_cloud_release(&cloud);
    return result;
}

static struct scene plain(void)
{
    return (struct scene){
        .s = arcs, .n = N, .n_frames = 2400, .hidden = -1, .all_hidden_from = -1, .bend = 1.2};
}

static void all_markers_are_followed_through_the_test(void **state)
{
    (void)state;
    struct wb_marker_tracks tracks;
    const struct scene scene = plain();
    const struct score result = run(&scene, &tracks);
    assert_int_equal(result.right, N * scene.n_frames);
    assert_int_equal(result.wrong + result.missed, 0);
    assert_int_equal(tracks.n_strays, 0);
    assert_true(tracks.symmetric);
    wb_marker_tracks_release(&tracks);
}

static void strays_are_not_taken_for_markers(void **state)
{
    (void)state;
    struct wb_marker_tracks tracks;
    struct scene scene = plain();
    scene.n_strays = 3;
    scene.carried_stray = true;
    const struct score result = run(&scene, &tracks);
    assert_int_equal(result.right, N * scene.n_frames);
    assert_int_equal(result.wrong, 0);
    assert_int_equal(tracks.n_strays, 3 * scene.n_frames);
    wb_marker_tracks_release(&tracks);
}

static void a_hidden_marker_is_missing_and_found_again(void **state)
{
    (void)state;
    for (int marker = 0; marker < N; marker++) {
        struct wb_marker_tracks tracks;
        struct scene scene = plain();
        scene.hidden = marker;
        scene.hidden_from = 600;
        scene.hidden_until = 1500;
        scene.n_strays = 2;
        scene.carried_stray = true;
        const struct score result = run(&scene, &tracks);
        assert_int_equal(result.wrong, 0);
        assert_true(result.missed <= 1);
        assert_int_equal(tracks.n_missing, 900 + (size_t)result.missed);
        wb_marker_tracks_release(&tracks);
    }
}

static void the_chain_is_found_again_after_all_were_lost(void **state)
{
    (void)state;
    struct wb_marker_tracks tracks;
    struct scene scene = plain();
    scene.all_hidden_from = 800;
    scene.all_hidden_until = 1700;
    scene.n_strays = 2;
    const struct score result = run(&scene, &tracks);
    assert_int_equal(result.wrong, 0);
    assert_int_equal(result.missed, 0);
    assert_true(tracks.n_searches >= 1);
    wb_marker_tracks_release(&tracks);
}

static void a_marker_hidden_at_the_start_is_found_later(void **state)
{
    (void)state;
    struct wb_marker_tracks tracks;
    struct scene scene = plain();
    scene.hidden = 4;
    scene.hidden_until = 2000;
    scene.n_strays = 2;
    const struct score result = run(&scene, &tracks);
    assert_true(tracks.start_frame >= 2000);
    assert_int_equal(result.wrong, 0);
    assert_true(result.missed <= 1);
    wb_marker_tracks_release(&tracks);
}

static void a_marker_that_is_never_seen_is_missing(void **state)
{
    (void)state;
    struct wb_marker_tracks tracks;
    struct scene scene = plain();
    scene.hidden = 2;
    scene.hidden_until = scene.n_frames;
    const struct score result = run(&scene, &tracks);
    assert_int_equal(result.wrong, 0);
    assert_int_equal(result.right, (N - 1) * scene.n_frames);
    wb_marker_tracks_release(&tracks);
}

static void uneven_spacings_determine_the_order(void **state)
{
    (void)state;
    static const double uneven[] = {0.0, 0.008, 0.02, 0.036, 0.085};
    for (int turned = 0; turned < 2; turned++) {
        struct wb_marker_tracks tracks;
        struct scene scene = plain();
        scene.s = uneven;
        scene.n = 5;
        scene.n_strays = 1;
        const struct score result = run(&scene, &tracks);
        assert_false(tracks.symmetric);
        assert_int_equal(result.right, 5 * scene.n_frames);
        wb_marker_tracks_release(&tracks);
    }
}

static void reversing_turns_the_order_round(void **state)
{
    (void)state;
    struct wb_marker_tracks tracks;
    struct wb_point_cloud cloud;
    const struct wb_specimen specimen = specimen_of(arcs, N);
    const struct wb_marker_settings settings = {0};
    const struct scene scene = plain();
    film(&scene, &cloud, truth);
    assert_int_equal(wb_markers_track(&tracks, &cloud, &specimen, &settings, NULL), WB_OK);
    const double *const first = wb_markers_position(&tracks, 100, 0);
    const double *const last = wb_markers_position(&tracks, 100, N - 1);
    wb_markers_reverse(&tracks);
    assert_ptr_equal(wb_markers_position(&tracks, 100, N - 1), first);
    assert_ptr_equal(wb_markers_position(&tracks, 100, 0), last);
    wb_marker_tracks_release(&tracks);
    wb_point_cloud_release(&cloud);
}

static void occluded_and_filled_points_are_left_out(void **state)
{
    (void)state;
    static struct wb_mocap_frame frame;
    struct wb_point_cloud cloud = {0};
    frame.n_markers = 4;
    frame.markers[0].params = WB_MARKER_OCCLUDED | WB_MARKER_POINT_CLOUD_SOLVED;
    frame.markers[1].params = WB_MARKER_MODEL_FILLED | WB_MARKER_HAS_MODEL;
    frame.markers[2].params = WB_MARKER_UNLABELED;
    frame.markers[3].position[1] = (float)NAN;
    wb_point_cloud_add(&cloud, &frame);
    assert_int_equal(cloud.frames[0].n, 1);
    assert_int_equal(cloud.n_points, 1);
    assert_int_equal(cloud.n_occluded, 1);
    assert_int_equal(cloud.n_filled, 1);
    wb_point_cloud_release(&cloud);
}

static void recordings_without_a_chain_are_rejected(void **state)
{
    (void)state;
    static struct wb_mocap_frame frame;
    struct wb_point_cloud cloud = {0};
    struct wb_marker_tracks tracks;
    const struct wb_specimen specimen = specimen_of(arcs, N);
    const struct wb_marker_settings settings = {0};
    wb_log_set_sink(quiet, NULL);
    assert_int_equal(wb_markers_track(&tracks, &cloud, &specimen, &settings, NULL), WB_ERR_DATA);
    /* A dense random cloud: the search ends in time and finds no chain. */
    for (int f = 0; f < 5; f++) {
        frame.n_markers = WB_MAX_MARKERS;
        for (int i = 0; i < frame.n_markers; i++) {
            for (int k = 0; k < 3; k++)
                frame.markers[i].position[k] = (float)(10.0 * uniform());
        }
        wb_point_cloud_add(&cloud, &frame);
    }
    assert_int_equal(wb_markers_track(&tracks, &cloud, &specimen, &settings, NULL), WB_ERR_DATA);
    wb_log_set_sink(NULL, NULL);
    wb_point_cloud_release(&cloud);
}

static void a_hostile_cloud_ends_in_time(void **state)
{
    (void)state;
    /* Points in a lattice with the markers' spacing form chains everywhere. */
    static double points[WB_MAX_MARKERS][3];
    static double even[N];
    int chosen[N];
    for (int i = 0; i < N; i++)
        even[i] = 0.014 * i;
    for (int i = 0; i < WB_MAX_MARKERS; i++) {
        points[i][0] = 0.014 * (i % 16);
        points[i][1] = 0.014 * (double)(i / 16);
    }
    const struct wb_specimen specimen = specimen_of(even, N);
    assert_int_equal(
        wb_markers_chain((const double(*)[3])points, WB_MAX_MARKERS, &specimen, 0.1e-3, N, chosen),
        N);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_markers_are_followed_through_the_test),
        cmocka_unit_test(strays_are_not_taken_for_markers),
        cmocka_unit_test(a_hidden_marker_is_missing_and_found_again),
        cmocka_unit_test(the_chain_is_found_again_after_all_were_lost),
        cmocka_unit_test(a_marker_hidden_at_the_start_is_found_later),
        cmocka_unit_test(a_marker_that_is_never_seen_is_missing),
        cmocka_unit_test(uneven_spacings_determine_the_order),
        cmocka_unit_test(reversing_turns_the_order_round),
        cmocka_unit_test(occluded_and_filled_points_are_left_out),
        cmocka_unit_test(recordings_without_a_chain_are_rejected),
        cmocka_unit_test(a_hostile_cloud_ends_in_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
