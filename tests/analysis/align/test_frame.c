/* The clamp's frame from noisy markers with a known vertical and bending plane. */
#include "analysis/align/frame.h"

#include <stdlib.h>

#include "base/log.h"
#include "base/vec3.h"
#include "tests/check.h"

#define N 4
#define N_FRAMES 2000

static const double arcs[N] = {0.0, 0.03, 0.06, 0.09};
static uint64_t seed;

static double noise(double deviation)
{
    double sum = -6.0;
    for (int i = 0; i < 12; i++) {
        seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
        sum += (double)(seed >> 11) * 0x1p-53;
    }
    return deviation * sum;
}

struct scene {
    double up[3], along[3];
    double motion, noise;
    bool upside; /* first and last marker exchanged */
    double lift; /* m: how much the tip rises in the clamp's frame */
};

static struct wb_point_cloud cloud;
static struct wb_marker_tracks tracks;
static int32_t indices[N_FRAMES * N];
static double times[N_FRAMES];

/* Points in the order of the markers; the tip rises as a parabola while the clamp goes down. */
static void film(const struct scene *scene)
{
    static struct wb_mocap_frame frame;
    memset(&cloud, 0, sizeof cloud);
    seed = 4;
    for (int f = 0; f < N_FRAMES; f++) {
        const double part = (double)f / N_FRAMES;
        frame.n_markers = N;
        times[f] = f / 120.0;
        for (int i = 0; i < N; i++) {
            const int marker = scene->upside ? N - 1 - i : i;
            const double x = arcs[marker], u = x / arcs[N - 1];
            const double y = scene->lift * part * u * u - scene->motion * part;
            for (int k = 0; k < 3; k++)
                frame.markers[i].position[k] =
                    (float)(0.4 + x * scene->along[k] + y * scene->up[k] + noise(scene->noise));
            indices[f * N + i] = f * N + i;
        }
        wb_point_cloud_add(&cloud, &frame);
    }
    tracks = (struct wb_marker_tracks){
        .cloud = &cloud, .n_markers = N, .n_frames = N_FRAMES, .index = indices};
}

static struct scene tilted(void)
{
    /* Vertical 2 degrees off the server's axis, x turned by 40 degrees about it. */
    const double t = 2.0 * M_PI / 180.0, a = 40.0 * M_PI / 180.0;
    const struct scene scene = {
        .up = {sin(t), cos(t), 0.0},
        .along = {cos(a) * cos(t), -cos(a) * sin(t), -sin(a)},
        .motion = 0.053,
        .noise = 0.1e-3,
        .lift = 0.05,
    };
    return scene;
}

static const double server_up[3] = {0.0, 1.0, 0.0};

static void vertical_and_plane_are_found(void **state)
{
    (void)state;
    struct wb_bench_frame frame;
    const struct scene scene = tilted();
    film(&scene);
    assert_int_equal(wb_frame_fit(&frame, &tracks, times, 0.1, server_up, NULL), WB_OK);
    assert_true(frame.up_from_motion);
    assert_close(wb_vec3_dot(frame.up, scene.up), 1.0, 1e-7);
    assert_close(wb_vec3_dot(frame.along, scene.along), 1.0, 1e-6);
    assert_close(wb_vec3_dot(frame.normal, frame.up), 0.0, 1e-12);
    assert_close(wb_vec3_dot(frame.normal, frame.along), 0.0, 1e-12);
    assert_close(frame.tilt, 2.0 * M_PI / 180.0, 1e-3);
    assert_close(frame.motion, scene.motion, 1e-3);
    assert_close(frame.planarity, scene.noise, 0.02e-3);
    assert_close(frame.plane_tilt, 0.0, 2e-3);
    const double error = acos(fmin(1.0, wb_vec3_dot(frame.up, scene.up)));
    assert_true(error < 4.0 * frame.up_uncertainty && frame.up_uncertainty < 0.5e-3);
    wb_frame_release(&frame);
    wb_point_cloud_release(&cloud);
}

static void coordinates_count_from_the_clamp(void **state)
{
    (void)state;
    struct wb_bench_frame frame;
    struct scene scene = tilted();
    film(&scene);
    assert_int_equal(wb_frame_fit(&frame, &tracks, times, 0.1, server_up, NULL), WB_OK);
    double sum_x = 0.0, sum_y = 0.0, sum_z = 0.0;
    for (size_t f = 0; f < N_FRAMES; f++) {
        const double *const tip = wb_markers_position(&tracks, f, N - 1);
        double x, y, z;
        wb_frame_coordinates(&frame, f, tip, &x, &y, &z);
        const double true_y = scene.lift * (double)f / N_FRAMES;
        assert_close(x, arcs[N - 1], 0.7e-3);
        assert_close(y, true_y, 0.7e-3);
        sum_x += (x - arcs[N - 1]) / N_FRAMES;
        sum_y += (y - true_y) / N_FRAMES;
        sum_z += z / N_FRAMES;
    }
    assert_close(sum_x, 0.0, 0.02e-3);
    assert_close(sum_y, 0.0, 0.03e-3);
    assert_close(sum_z, 0.0, 0.03e-3);
    /* Smoothed over 25 frames, the clamp's own noise is a fifth. */
    double sum = 0.0, squares = 0.0;
    for (size_t f = 0; f < N_FRAMES; f++) {
        const double error = wb_frame_clamp_height(&frame, f) + scene.motion * (double)f / N_FRAMES;
        sum += error / N_FRAMES;
        squares += error * error / N_FRAMES;
    }
    squares -= sum * sum;
    assert_true(sqrt(squares) < 0.04e-3);
    wb_frame_release(&frame);
    wb_point_cloud_release(&cloud);
}

static void the_clamp_is_not_extrapolated_into_a_loss(void **state)
{
    (void)state;
    struct wb_bench_frame frame;
    const struct scene scene = tilted();
    film(&scene);
    /* Losses of the clamp's marker; three frames remain in the middle of the first. */
    size_t n_none = 0;
    for (int f = 500; f < 560; f++)
        indices[f * N] = f >= 529 && f < 532 ? f * N : -1;
    for (int f = 900; f < 912; f++)
        indices[f * N] = -1;
    assert_int_equal(wb_frame_fit(&frame, &tracks, times, 0.1, server_up, NULL), WB_OK);
    for (size_t f = 0; f < N_FRAMES; f++) {
        const double height = wb_frame_clamp_height(&frame, f);
        n_none += !isfinite(height);
        if (isfinite(height))
            assert_close(height - wb_frame_clamp_height(&frame, 0),
                         -scene.motion * (double)f / N_FRAMES, 4.0 * scene.noise);
    }
    assert_true(n_none > 40 && n_none < 72);
    assert_true(isfinite(wb_frame_clamp_height(&frame, 499)));
    assert_true(isfinite(wb_frame_clamp_height(&frame, 560)));
    wb_frame_release(&frame);
    wb_point_cloud_release(&cloud);
}

static void without_motion_up_is_the_servers_axis(void **state)
{
    (void)state;
    struct wb_bench_frame frame;
    struct scene scene = tilted();
    scene.motion = 0.0;
    film(&scene);
    assert_int_equal(wb_frame_fit(&frame, &tracks, times, 0.1, server_up, NULL), WB_OK);
    assert_false(frame.up_from_motion);
    assert_close(wb_vec3_dot(frame.up, server_up), 1.0, 1e-12);
    wb_frame_release(&frame);
    wb_point_cloud_release(&cloud);
}

static void the_moving_end_is_the_clamp(void **state)
{
    (void)state;
    struct scene scene = tilted();
    film(&scene);
    assert_false(wb_frame_is_reversed(&tracks, server_up));
    wb_point_cloud_release(&cloud);
    scene.upside = true;
    film(&scene);
    assert_true(wb_frame_is_reversed(&tracks, server_up));
    wb_point_cloud_release(&cloud);
    scene.motion = scene.lift = 0.0;
    film(&scene);
    assert_false(wb_frame_is_reversed(&tracks, server_up));
    wb_point_cloud_release(&cloud);
}

static void frames_with_a_hidden_clamp_are_left_out(void **state)
{
    (void)state;
    struct wb_bench_frame frame;
    const struct scene scene = tilted();
    film(&scene);
    for (int f = 500; f < 700; f++)
        indices[f * N] = -1;
    assert_int_equal(wb_frame_fit(&frame, &tracks, times, 0.1, server_up, NULL), WB_OK);
    assert_true(isnan(wb_frame_clamp_height(&frame, 600)));
    assert_true(isfinite(wb_frame_clamp_height(&frame, 499)));
    assert_true(isnan(wb_frame_clamp_height(&frame, 505)));
    assert_true(isfinite(wb_frame_clamp_height(&frame, 750)));
    assert_close(wb_vec3_dot(frame.along, scene.along), 1.0, 1e-6);
    wb_frame_release(&frame);
    wb_point_cloud_release(&cloud);
}

static void quiet(void *context, enum wb_log_level level, const char *domain, const char *message)
{
    (void)context;
    (void)level;
    (void)domain;
    (void)message;
}

static void markers_along_the_vertical_are_rejected(void **state)
{
    (void)state;
    struct wb_bench_frame frame;
    struct scene scene = tilted();
    memcpy(scene.along, scene.up, sizeof scene.along);
    scene.noise = 0.0;
    film(&scene);
    wb_log_set_sink(quiet, NULL);
    assert_int_equal(wb_frame_fit(&frame, &tracks, times, 0.1, scene.up, NULL), WB_ERR_DATA);
    wb_log_set_sink(NULL, NULL);
    wb_point_cloud_release(&cloud);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(vertical_and_plane_are_found),
        cmocka_unit_test(coordinates_count_from_the_clamp),
        cmocka_unit_test(the_clamp_is_not_extrapolated_into_a_loss),
        cmocka_unit_test(without_motion_up_is_the_servers_axis),
        cmocka_unit_test(the_moving_end_is_the_clamp),
        cmocka_unit_test(frames_with_a_hidden_clamp_are_left_out),
        cmocka_unit_test(markers_along_the_vertical_are_rejected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
