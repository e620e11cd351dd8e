/* Parts of `doctor`: the picture of the markers, the check of the disk, the user of a port, the
 * network interface towards a server, and the collected samples. */
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/units.h"
#include "daq/acquire/disk_check.h"
#include "daq/acquire/silence_check.h"
#include "daq/doctor/doctor_items.h"
#include "daq/doctor/marker_picture.h"
#include "daq/stream/network.h"
#include "daq/stream/port_user.h"
#include "tests/check.h"
#include "tests/folder.h"

#define N 5

static const struct wb_specimen specimen = {
    .length = 0.1, .n_markers = N, .markers = {0.0, 0.02, 0.045, 0.07, 0.1}};

/* A wire along z with its markers in reverse order and without marker `missing`; y is up. */
static void fill(struct wb_mocap_frame *frame, int missing)
{
    memset(frame, 0, sizeof *frame);
    for (int m = 0; m < N; m++) {
        if (m == missing)
            continue;
        float *const at = frame->markers[frame->n_markers++].position;
        at[0] = 0.3F;
        at[1] = 1.0F;
        at[2] = (float)(2.0 - specimen.markers[m]);
    }
}

/* The line of the picture that holds this text. */
static const char *line_of(const char *picture, const char *text, char line[128])
{
    const char *const found = strstr(picture, text);
    if (!found)
        fail_msg("no '%s' in\n%s", text, picture);
    const char *begin = found;
    while (begin > picture && begin[-1] != '\n')
        begin--;
    snprintf(line, 128, "%.*s", (int)strcspn(begin, "\n"), begin);
    return line;
}

static void wire_is_drawn_to_scale_in_80_columns_with_its_file_below(void **state)
{
    char text[4096], line[128];
    struct wb_mocap_frame frame;
    (void)state;
    fill(&frame, -1);
    wb_marker_picture(&frame, &specimen, 'y', text, sizeof text);
    for (const char *at = text; *at; at += strcspn(at, "\n") + 1)
        assert_in_range(strcspn(at, "\n"), 1, 80);
    const char *const wire = line_of(text, "1 ", line);
    /* 100 mm over 73 columns: 20 mm are 14.6, 45 are 32.85. */
    const char *const begin = strchr(wire, '1');
    assert_int_equal(strchr(wire, '2') - begin, 15);
    assert_int_equal(strchr(wire, '3') - begin, 33);
    assert_int_equal(strchr(wire, '5') - begin, 73);
    assert_true(strlen(wire) <= 80);
    char below[128];
    line_of(strstr(text, "specimen file"), "1 ", below);
    assert_string_equal(wire, below);
    assert_null(strchr(text, '?'));
}

static void missing_marker_is_a_question_mark_and_a_stray_is_a_star(void **state)
{
    char text[4096], line[128];
    struct wb_mocap_frame frame;
    (void)state;
    fill(&frame, 2);
    float *const stray = frame.markers[frame.n_markers++].position;
    stray[0] = 0.3F;
    stray[1] = 1.02F;
    stray[2] = 1.95F;
    wb_marker_picture(&frame, &specimen, 'y', text, sizeof text);
    char below[128];
    const char *const drawn = strchr(strstr(text, "(? not seen)"), '\n') + 1;
    line_of(drawn, "1 ", below);
    line_of(drawn, "?", line);
    assert_int_equal(strchr(line, '?') - line, strchr(below, '3') - below);
    char star[128];
    const char *const canvas = strchr(text, '\n') + 1;
    line_of(canvas, "*", star);
    /* 20 mm up are higher than the wire's row. */
    assert_true(strchr(canvas, '*') < strchr(canvas, '1'));
    assert_null(strchr(star, '1'));
}

static void picture_needs_no_specimen_and_is_empty_without_measured_markers(void **state)
{
    char text[4096];
    struct wb_mocap_frame frame;
    (void)state;
    fill(&frame, -1);
    wb_marker_picture(&frame, NULL, 'z', text, sizeof text);
    int stars = 0;
    for (const char *at = text; (at = strchr(at, '*')); at++)
        stars++;
    assert_int_equal(stars, N);
    for (int i = 0; i < N; i++)
        frame.markers[i].params = WB_MARKER_OCCLUDED;
    wb_marker_picture(&frame, NULL, 'z', text, sizeof text);
    assert_string_equal(text, "");
}

static void disk_is_judged_by_speed_and_free_space(void **state)
{
    char text[WB_DISK_CHECK_TEXT];
    const struct wb_disk_check good = {.n = 16, .usual = 5e-3, .longest = 0.3, .free = 1e9};
    struct wb_disk_check slow = good, full = good;
    slow.usual = 0.12;
    full.free = 1e6;
    (void)state;
    assert_true(wb_disk_check_judge(&good, "here", 1e4, 120.0, text));
    assert_non_null(strstr(text, "5.0 ms"));
    assert_false(wb_disk_check_judge(&slow, "here", 1e4, 120.0, text));
    assert_non_null(strstr(text, "120 ms"));
    assert_false(wb_disk_check_judge(&full, "here", 1e4, 120.0, text));
    assert_non_null(strstr(text, "1 MB free"));
}

static void measuring_a_disk_leaves_no_files(void **state)
{
    char folder[32], command[64];
    struct wb_disk_check check;
    struct wb_reason why = {0};
    (void)state;
    assert_true(temporary_folder_make(folder));
    assert_int_equal(wb_disk_check_measure(&check, folder, &why), WB_OK);
    assert_int_equal(check.n, 16);
    assert_true(check.usual > 0.0 && check.longest >= check.usual && check.free > 0.0);
    snprintf(command, sizeof command, "test -z \"$(ls -A %s)\"", folder);
    assert_int_equal(system(command), 0);
    assert_int_equal(temporary_folder_remove(folder), 0);
    assert_int_equal(wb_disk_check_measure(&check, folder, &why), WB_ERR_NOT_FOUND);
    assert_non_null(strstr(why.text, "--folder"));
}

static void process_that_has_a_port_open_is_named(void **state)
{
    char path[64], user[WB_PORT_USER_TEXT], expected[32];
    int ready[2], quit[2];
    char byte = 0;
    (void)state;
    const int master = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    assert_true(master >= 0 && grantpt(master) == 0 && unlockpt(master) == 0);
    assert_int_equal(ptsname_r(master, path, sizeof path), 0);
    assert_false(wb_port_user(path, user));
    assert_int_equal(pipe(ready) + pipe(quit), 0);
    const pid_t child = fork();
    if (child == 0) {
        const int held = open(path, O_RDWR | O_NOCTTY);
        close(quit[1]);
        (void)!write(ready[1], &byte, held >= 0);
        (void)!read(quit[0], &byte, 1);
        _exit(0);
    }
    assert_int_equal(read(ready[0], &byte, 1), 1);
    assert_true(wb_port_user(path, user));
    snprintf(expected, sizeof expected, "process %d", (int)child);
    assert_non_null(strstr(user, expected));
    close(quit[1]);
    waitpid(child, NULL, 0);
    close(master);
    assert_false(wb_port_user("/dev/null-of-no-name", user));
}

static void interface_towards_a_server_is_reported_if_frames_are_missing(void **state)
{
    struct wb_network_card card;
    struct wb_acquisition_latest *const latest = calloc(1, sizeof *latest);
    struct wb_rig *const rig = calloc(1, sizeof *rig);
    char text[WB_SILENCE_TEXT];
    (void)state;
    assert_true(wb_network_towards("udp:127.0.0.1:1510", &card));
    assert_string_equal(card.address, "127.0.0.1");
    assert_true(card.is_loopback);
    assert_false(wb_network_towards("pty:/dev/pts/1", &card));
    latest->stream[WB_ROLE_MOCAP].bytes = 279;
    strcpy(rig->mocap.address, "udp:127.0.0.1:1510,group=239.255.42.99:1511,interface=10.9.9.9");
    assert_false(wb_silence_check(WB_ROLE_MOCAP, latest, rig, 6.0, text));
    assert_non_null(strstr(text, "joined on 10.9.9.9"));
    assert_non_null(strstr(text, "write interface=127.0.0.1"));
    assert_non_null(strstr(text, "UDP port 1511"));
    strcpy(rig->mocap.address, "udp:127.0.0.1:1510,group=239.255.42.99:1511,interface=127.0.0.1");
    assert_false(wb_silence_check(WB_ROLE_MOCAP, latest, rig, 6.0, text));
    assert_null(strstr(text, "write interface="));
    latest->has_mocap = latest->stream[WB_ROLE_MOCAP].ready = true;
    assert_true(wb_silence_check(WB_ROLE_MOCAP, latest, rig, 6.0, text));
    free(latest);
    free(rig);
}

static void slope_of_the_force_is_that_of_its_readings(void **state)
{
    struct wb_doctor_seen *const seen = calloc(1, sizeof *seen);
    const struct wb_sink sink = wb_doctor_seen_sink(seen);
    double error;
    (void)state;
    seen->listening = true;
    srand(5);
    for (int i = 0; i < 400; i++) {
        const double t = 0.01 * i, noise = 1e-4 * (rand() / (double)RAND_MAX - 0.5);
        const struct wb_load_sample sample = {.t_ns = 7 * WB_NS_PER_S + wb_ns_from_seconds(t),
                                              .valid = true,
                                              .force = 0.5 + 2e-3 * t + noise};
        sink.load(sink.context, &sample);
    }
    const double slope = wb_doctor_trend_slope(&seen->trend, &error);
    assert_close(slope, 2e-3, 3e-5);
    assert_true(error > fabs(slope - 2e-3) && error < 0.1 * slope);
    free(seen);
}

/* 400 frames of a wire that lies along an axis, with all that a finding about the axis needs. */
static enum wb_doctor_verdict judge_axis(char up, const double direction[3])
{
    static struct wb_doctor_seen seen;
    static struct wb_doctor_report report;
    struct wb_rig rig = {.time_scale = 1.0, .gravity = 9.81, .mocap = {.up = up}};
    struct wb_bend_test_request test;
    const enum wb_role source = WB_ROLE_MOCAP;
    memset(&seen, 0, sizeof seen);
    memset(&report, 0, sizeof report);
    wb_bend_test_default_request(&test);
    test.rig_path = "none.yaml";
    rig.stage.speed = 1e-3;
    seen.rig = &rig;
    seen.specimen = &specimen;
    seen.source = &source;
    seen.listening = true;
    const struct wb_sink sink = wb_doctor_seen_sink(&seen);
    for (int i = 0; i < 20; i++) {
        struct wb_mocap_frame frame = {.n_markers = N, .t_device = 0.01 * i};
        for (int m = 0; m < N; m++)
            for (int k = 0; k < 3; k++)
                frame.markers[m].position[k] =
                    (float)(1.0 + specimen.markers[m] * direction[k] + 1e-5 * (i % 3));
        sink.mocap(sink.context, &frame);
    }
    seen.latest.has_mocap = true;
    seen.latest.stream[WB_ROLE_MOCAP].open = seen.latest.stream[WB_ROLE_MOCAP].ready = true;
    wb_doctor_judge(&seen, &test, &report);
    for (int i = 0; i < report.n; i++)
        if (strcmp(report.items[i].name, "up axis") == 0)
            return report.items[i].verdict;
    fail_msg("nothing is said of the up axis");
    return WB_DOCTOR_UNKNOWN;
}

static void wire_that_rises_along_the_up_axis_shows_a_wrong_one(void **state)
{
    const double c = cos(0.5), s = sin(0.5);
    const double along_x[3] = {1.0, 0.0, 0.0}, towards_z[3] = {c, 0.0, s},
                 towards_y[3] = {c, s, 0.0}, nearly[3] = {cos(0.1), sin(0.1), 0.0};
    (void)state;
    assert_int_equal(judge_axis('y', along_x), WB_DOCTOR_UNKNOWN);
    assert_int_equal(judge_axis('y', towards_z), WB_DOCTOR_READY);
    assert_int_equal(judge_axis('y', towards_y), WB_DOCTOR_NOT_READY);
    assert_int_equal(judge_axis('y', nearly), WB_DOCTOR_UNKNOWN);
    assert_int_equal(judge_axis('z', towards_y), WB_DOCTOR_READY);
    assert_int_equal(judge_axis('z', towards_z), WB_DOCTOR_NOT_READY);
}

int main(void)
{
    const struct CMUnitTest facts[] = {
        cmocka_unit_test(wire_is_drawn_to_scale_in_80_columns_with_its_file_below),
        cmocka_unit_test(missing_marker_is_a_question_mark_and_a_stray_is_a_star),
        cmocka_unit_test(picture_needs_no_specimen_and_is_empty_without_measured_markers),
        cmocka_unit_test(disk_is_judged_by_speed_and_free_space),
        cmocka_unit_test(measuring_a_disk_leaves_no_files),
        cmocka_unit_test(process_that_has_a_port_open_is_named),
        cmocka_unit_test(interface_towards_a_server_is_reported_if_frames_are_missing),
        cmocka_unit_test(slope_of_the_force_is_that_of_its_readings),
        cmocka_unit_test(wire_that_rises_along_the_up_axis_shows_a_wrong_one),
    };
    return cmocka_run_group_tests(facts, NULL, NULL);
}
