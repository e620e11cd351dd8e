/* Takes of motion capture from real programs, against the facts listed beside them. Needs
 * WIREBENCH_REAL_DATA; skipped (exit status 77) without. */
#include <stdio.h>
#include <stdlib.h>

#include "base/file.h"
#include "daq/take/take_reader.h"
#include "tests/check.h"
#include "tests/daq/take_missing.h"

#define SKIPPED 77

static struct wb_take take, other;

static void read_to(struct wb_take *to, const char *name, const char *format)
{
    char path[WB_PATH], *bytes;
    size_t n;
    const struct wb_take_reader *reader = NULL;
    wb_take_release(to);
    snprintf(path, sizeof path, "%s/%s", getenv("WIREBENCH_REAL_DATA"), name);
    assert_int_equal(wb_file_read(path, &bytes, &n), WB_OK);
    assert_int_equal(wb_take_read(to, name, (const uint8_t *)bytes, n, &reader, NULL), WB_OK);
    assert_string_equal(reader->name, format);
    free(bytes);
}

static size_t count(const struct wb_take *t, enum wb_take_kind kind, bool only_seen)
{
    size_t n = 0;
    for (size_t i = 0; i < t->n_points; i++)
        n += t->points[i].kind == kind && (t->points[i].n_seen > 0 || !only_seen);
    return n;
}

static void assert_nothing_left_out(void)
{
    assert_int_equal(take.skipped_rows, 0);
}

static void motive_1_21_has_its_250_frames(void **state)
{
    (void)state;
    read_to(&take, "motive/take_v1.21.csv", "motive-csv");
    assert_string_equal(take.format, "Motive CSV 1.21");
    assert_close(take.rate, 120.0, 0.0);
    assert_int_equal(take.n_frames, 250);
    assert_int_equal(take.declared_frames, 250);
    assert_int_equal(take.jumps, 0);
    assert_nothing_left_out();
    assert_int_equal(count(&take, WB_TAKE_BODY, false), 1);
    assert_int_equal(count(&take, WB_TAKE_SOLVED, false), 3);
    assert_int_equal(count(&take, WB_TAKE_MARKER, true), 3);
    assert_int_equal(count(&take, WB_TAKE_UNLABELLED, false), 6);
    assert_int_equal(count(&take, WB_TAKE_UNLABELLED, true), 3);
    assert_close(take.frames[249].t, 249.0 / 120.0, 1e-12);
    /* Positions are metres: the measured markers of the body are where it solves them, to 0.1 mm.
     */
    static struct wb_mocap_frame frame;
    assert_int_equal(wb_take_frame_at(&take, 0, &frame), 0);
    assert_int_equal(frame.n_markers, 6);
    const struct wb_take_place *const solved = &take.places[take.frames[0].first + 1];
    assert_int_equal(take.points[solved->point].kind, WB_TAKE_SOLVED);
    for (int k = 0; k < 3; k++)
        assert_close((double)frame.markers[3].position[k], (double)solved->position[k], 1e-4);
}

static void motive_1_23_jumps_and_misses_6_75_percent(void **state)
{
    (void)state;
    read_to(&take, "motive/take_v1.23.csv", "motive-csv");
    assert_string_equal(take.format, "Motive CSV 1.23");
    assert_close(take.rate, 100.0, 0.0);
    assert_int_equal(take.n_frames, 934);
    assert_int_equal(take.frames[0].number, 72210);
    assert_close(take.frames[0].t, 722.10, 1e-9);
    assert_int_equal(take.jumps, 4);
    assert_nothing_left_out();
    assert_int_equal(count(&take, WB_TAKE_BODY, false), 3);
    assert_close(100.0 * take_missing(&take), 6.75, 5e-3);
}

static const char *const samples[] = {"pc_int",   "pc_real", "dec_int",
                                      "dec_real", "sgi_int", "sgi_real"};

/* Positions stand in steps of 0.2812 mm (POINT:SCALE); who wrote the six files rounded one in 150
 * of them to the step beside. */
#define STEP 2.813e-4

static void six_c3d_files_decode_to_the_same_points(void **state)
{
    (void)state;
    char name[100];
    for (size_t i = 0; i < 6; i++) {
        struct wb_take *const to = i == 0 ? &other : &take;
        snprintf(name, sizeof name, "c3d/ktk_data_c3d_test_suite_Sample02_%s.c3d", samples[i]);
        read_to(to, name, "c3d");
        assert_close(100.0 * take_missing(to), 7.116, 5e-4);
        if (i == 0)
            continue;
        assert_nothing_left_out();
        assert_int_equal(take.n_frames, other.n_frames);
        assert_int_equal(take.n_points, other.n_points);
        assert_int_equal(take.n_places, other.n_places);
        size_t beside = 0;
        for (size_t k = 0; k < take.n_places; k++) {
            assert_int_equal(take.places[k].point, other.places[k].point);
            for (int axis = 0; axis < 3; axis++) {
                const double off = fabs((double)take.places[k].position[axis] -
                                        (double)other.places[k].position[axis]);
                assert_close(off, 0.0, STEP);
                beside += off > 1e-6;
            }
        }
        assert_true(150 * beside <= 3 * take.n_places);
        assert_int_equal(take.n_channels, other.n_channels);
        const size_t n = take.n_frames * (size_t)(take.per_frame * take.n_channels);
        for (size_t k = 0; k < n; k++)
            assert_close((double)take.analog[k], (double)other.analog[k],
                         1e-5 * fabs((double)other.analog[k]) + 1e-3);
    }
}

static void trc_files_agree_with_their_headers(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        size_t markers, frames;
        double rate, first_t;
    } files[] = {
        {"trc/test_file_01.trc", 2, 4, 60.0, 0.0},
        {"trc/test_file_04.trc", 37, 2, 200.0, -0.005},
        {"trc/test_file_06_2tab_one_space.trc", 9, 1091, 100.0, 0.0},
    };
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        read_to(&take, files[i].name, "trc");
        assert_int_equal(take.n_points, files[i].markers);
        assert_int_equal(take.n_frames, files[i].frames);
        assert_int_equal(take.declared_frames, files[i].frames);
        assert_close(take.rate, files[i].rate, 0.0);
        assert_close(take.frames[0].t, files[i].first_t, 1e-9);
        assert_nothing_left_out();
    }
    /* Frames count from 0, and a marker is at 0, 0, 0 throughout: never seen. */
    assert_int_equal(take.frames[0].number, 0);
    size_t unseen = 0;
    for (size_t i = 0; i < take.n_points; i++)
        unseen += take.points[i].n_seen == 0;
    assert_int_equal(unseen, 1);
    assert_close(take_missing(&take), 1.0 / 9.0, 1e-12);
}

int main(void)
{
    if (!getenv("WIREBENCH_REAL_DATA")) {
        printf("skipped: WIREBENCH_REAL_DATA is not set\n");
        return SKIPPED;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(motive_1_21_has_its_250_frames),
        cmocka_unit_test(motive_1_23_jumps_and_misses_6_75_percent),
        cmocka_unit_test(six_c3d_files_decode_to_the_same_points),
        cmocka_unit_test(trc_files_agree_with_their_headers),
    };
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    wb_take_release(&take);
    wb_take_release(&other);
    return failed;
}
