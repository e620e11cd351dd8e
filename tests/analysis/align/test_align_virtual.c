/* Alignment of a test on the virtual rig, compared with its truth. The rig's instruments run
 * without ports or clocks here: each sample at its own time, as on the rig at any time scale. */
#include <stdlib.h>
#include <unistd.h>

#include "analysis/align/align.h"
#include "analysis/dataset/holds.h"
#include "base/log.h"
#include "base/text.h"
#include "daq/protocol/natnet_encode.h"
#include "daq/recording/recording.h"
#include "fixtures/virtual/live_wire.h"
#include "fixtures/virtual/sim_cell.h"
#include "fixtures/virtual/sim_mocap.h"
#include "tests/messages.h"
#include "tests/own_folder.h"
#include "tests/virtual/setup.h"

#define HOST_ZERO_NS INT64_C(900000000000)
#define START_S 3.5 /* of the first cycle, on the rig's clock */
#define TARE_S 2.0
#define DWELL_S 1.0
#define MAX_FRAMES 20000

/* The true state of the wire at each frame. */
struct truth_row {
    double t, deflection, tension;
};

struct session {
    struct setup setup;
    struct wb_live_wire *wire;
    struct wb_live_wire_view view;
    struct wb_sim_cell cell;
    struct wb_sim_mocap mocap;
    struct wb_natnet_version version;
    struct wb_recording *recording;
    double travel, time_scale, hold;
    int load, camera, stage;
    int64_t seq[3];
    double tare_sum, tare_squares;
    int tare_n;
    int n_truth;
    struct truth_row truth[MAX_FRAMES];
};

static struct session session;

static int start(void **state)
{
    keep_messages();
    return make_folder(state);
}

/* --- the rig, offline --- */

static int64_t host(double t)
{
    return HOST_ZERO_NS + (int64_t)llround(t / session.time_scale * 1e9);
}

static double end_time(void)
{
    return START_S + 2.0 * session.travel / session.setup.rig.stage.speed + session.hold + DWELL_S;
}

/* Time at which the operator holds the test: half way down. */
static double hold_time(void)
{
    return START_S + 0.5 * session.travel / session.setup.rig.stage.speed;
}

static double travel_at(double t)
{
    const double speed = session.setup.rig.stage.speed;
    const double in = (t < hold_time() ? t : fmax(hold_time(), t - session.hold)) - START_S;
    const double down = session.travel / speed;
    if (in <= 0.0 || in >= 2.0 * down)
        return 0.0;
    return in < down ? speed * in : session.travel - speed * (in - down);
}

static void chunk(int stream, int64_t t_ns, const void *bytes, size_t n)
{
    assert_int_equal(
        wb_recording_append_chunk(session.recording, stream, session.seq[stream]++, t_ns, bytes, n),
        WB_OK);
}

static void take_frame(uint64_t k)
{
    static struct wb_natnet_frame frame;
    static uint8_t bytes[8192];
    const double t = wb_sim_mocap_time(&session.mocap, k);
    assert_true(session.n_truth < MAX_FRAMES);
    session.truth[session.n_truth++] = (struct truth_row){
        .t = t - START_S,
        .deflection = session.view.deflection,
        .tension = session.view.tension,
    };
    wb_sim_mocap_frame(&session.mocap, k, &session.view, &frame);
    const size_t n = wb_natnet_encode_frame(bytes, sizeof bytes, session.version, &frame);
    const double sent = wb_sim_mocap_send_time(&session.mocap, k);
    chunk(session.camera, host(sent) + 200000, bytes, n);
    if (session.version.major >= 3 && k % 120 == 0) {
        /* A probe with 0.1 ms of latency each way. */
        const double at = sent + 1e-4 * session.time_scale;
        const size_t size = wb_natnet_encode_echo_response(
            bytes, sizeof bytes, (uint64_t)host(sent), wb_sim_mocap_ticks(&session.mocap, at));
        chunk(session.camera, host(sent) + 200000, bytes, size);
    }
}

static void take_reading(uint64_t k, double t)
{
    static char bytes[WB_REPLY_BYTES];
    wb_sim_cell_read(&session.cell, k, t, session.view.tension);
    const size_t n = wb_reply_take(&session.cell.out, bytes, sizeof bytes);
    /* The first bytes after opening may be half a line: the driver drops the first line. */
    chunk(session.load, host(t) + 300000, bytes, n);
    if (t > START_S - TARE_S - 0.01 && t < START_S - 0.01) {
        session.tare_sum += session.cell.reading;
        session.tare_squares += session.cell.reading * session.cell.reading;
        session.tare_n++;
    }
}

static void take_report(double t)
{
    char line[96];
    const int n = snprintf(
        line, sizeof line, "<Jog|MPos:%.3f,0.000,0.000|FS:60,0>\r\n",
        session.setup.rig.stage.down * travel_at(t - 0.01 * session.time_scale) / WB_MM - 58.0);
    chunk(session.stage, host(t), line, (size_t)n);
}

static void event(double t, const char *kind, const char *text)
{
    assert_int_equal(wb_recording_append_event(session.recording, host(t), kind, text), WB_OK);
}

static void run_rig(void)
{
    static uint8_t bytes[8192];
    struct wb_natnet_server server = {
        .name = "virtual rig",
        .natnet_version = {session.version.major, session.version.minor, 0, 0},
        .has_connection = session.version.major >= 3,
        .clock_frequency = (uint64_t)session.setup.truth.clock_frequency,
    };
    const size_t n = wb_natnet_encode_server(bytes, sizeof bytes, &server);
    chunk(session.camera, host(0.0), bytes, n);
    chunk(session.load, host(0.0), "\r\n", 2);
    uint64_t frame = 0, reading = 0, report = 0;
    for (;;) {
        const double frame_t = wb_sim_mocap_time(&session.mocap, frame);
        const double reading_t = wb_sim_cell_time(&session.cell, reading);
        const double report_t = (double)report / 5.0;
        const double t = fmin(frame_t, fmin(reading_t, report_t));
        if (t > end_time())
            return;
        wb_live_wire_move(session.wire, travel_at(t), &session.view);
        if (t == frame_t)
            take_frame(frame++);
        else if (t == reading_t)
            take_reading(reading++, t);
        else
            take_report((double)report++ / 5.0);
    }
}

static void write_events(void)
{
    char text[160];
    const double mean = session.tare_sum / session.tare_n;
    const double variance = session.tare_squares / session.tare_n - mean * mean;
    snprintf(text, sizeof text, "{\"force_N\": %.9g, \"samples\": %d, \"sd_N\": %.9g}", mean,
             session.tare_n, sqrt(variance));
    event(START_S - 0.01, "tare", text);
    event(START_S, "cycle_start", "1");
    if (session.hold > 0.0) {
        event(hold_time(), "hold_start",
              "{\"cycle\": 1, \"phase\": \"down\", \"travel_mm\": 10, \"tension_mN\": 60}");
        event(hold_time() + session.hold, "hold_end",
              "{\"lasted_s\": 6, \"tension_mN\": 58.5, \"how\": \"resumed\"}");
    }
    event(end_time(), "stop", "done");
}

static void set_meta(const char *key, const char *name)
{
    char path[WB_PATH], *text;
    assert_int_equal(wb_file_find_data(path, name), WB_OK);
    assert_int_equal(wb_file_read(path, &text, NULL), WB_OK);
    struct wb_text value = {0};
    wb_text_append(&value, "%s", text);
    if (strcmp(key, "rig") == 0)
        wb_text_append(&value, "\nvirtual: true\ntime_scale: %g\n", session.time_scale);
    assert_int_equal(wb_recording_set_meta(session.recording, key, wb_text_string(&value)), WB_OK);
    wb_text_release(&value);
    free(text);
}

struct plan {
    const char *specimen;
    uint64_t seed;
    int major, minor;
    double travel, time_scale;
    double hold; /* s */
};

static void record(const struct plan *plan, char path[WB_PATH])
{
    char name[256];
    memset(&session, 0, sizeof session);
    session.version = (struct wb_natnet_version){(uint8_t)plan->major, (uint8_t)plan->minor};
    session.travel = plan->travel;
    session.time_scale = plan->time_scale;
    session.hold = plan->hold;
    setup_bench(&session.setup, plan->specimen, plan->seed);
    struct setup *const s = &session.setup;
    const struct wb_live_wire_parts parts = {&s->truth, &s->composite, &s->wire, &s->rig,
                                             &s->specimen};
    assert_int_equal(wb_live_wire_create(&session.wire, &parts, NULL), WB_OK);
    assert_int_equal(wb_sim_cell_init(&session.cell, &s->truth, &s->rig), WB_OK);
    wb_sim_mocap_init(&session.mocap, &s->truth, s->rig.mocap.up, s->specimen.n_markers,
                      session.version);
    snprintf(path, WB_PATH, "%s/%s-%d.wbr", folder, plan->specimen, (int)plan->seed);
    assert_int_equal(wb_recording_create(&session.recording, path), WB_OK);
    assert_int_equal(wb_recording_add_stream(session.recording, WB_ROLE_LOAD, "offline",
                                             s->rig.load_cell.protocol, "", &session.load),
                     WB_OK);
    assert_int_equal(wb_recording_add_stream(session.recording, WB_ROLE_MOCAP, "offline", "natnet",
                                             "", &session.camera),
                     WB_OK);
    assert_int_equal(wb_recording_add_stream(session.recording, WB_ROLE_STAGE, "offline", "grbl",
                                             "", &session.stage),
                     WB_OK);
    set_meta("rig", "fixtures/rigs/paper.yaml");
    snprintf(name, sizeof name, "fixtures/specimens/%s.yaml", plan->specimen);
    set_meta("specimen", name);
    snprintf(name, sizeof name, "fixtures/wires/%s.yaml", s->specimen.wire);
    set_meta("wire", name);
    assert_int_equal(wb_recording_set_meta(session.recording, "virtual", "true"), WB_OK);
    run_rig();
    write_events();
    assert_int_equal(wb_recording_close(session.recording), WB_OK);
    wb_live_wire_destroy(session.wire);
}

/* --- against the truth --- */

static struct truth_row truth_at(double t)
{
    int low = 0, high = session.n_truth - 1;
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        if (session.truth[middle].t <= t)
            low = middle;
        else
            high = middle;
    }
    const struct truth_row *const a = &session.truth[low], *const b = &session.truth[high];
    const double part = (t - a->t) / (b->t - a->t);
    return (struct truth_row){
        .t = t,
        .deflection = (1.0 - part) * a->deflection + part * b->deflection,
        .tension = (1.0 - part) * a->tension + part * b->tension,
    };
}

static double number_in(const struct wb_dataset *dataset, const char *group, const char *key)
{
    double value = (double)NAN;
    (void)wb_json_get_number(wb_json_get(wb_json_get(dataset->document, "checks"), group), key,
                             &value);
    return value;
}

/* The level of zero deflection is wrong by the difference of the true offsets of the clamp's and
 * the tip's marker from the nominal one, which cannot be measured. */
static double unknown_level(void)
{
    const double *const offsets = session.setup.truth.marker_offsets;
    return offsets[session.setup.specimen.n_markers - 1] - offsets[0];
}

static void assert_aligned(const struct plan *plan)
{
    char path[WB_PATH];
    struct wb_dataset dataset;
    struct wb_align_settings settings;
    wb_align_default_settings(&settings);
    record(plan, path);
    if (wb_align_run(&dataset, path, &settings, NULL) != WB_OK)
        fail_msg("not aligned: %s", kept.last);

    double n = 0.0, level = 0.0, squares = 0.0, tension = 0.0, tension_squares = 0.0;
    for (size_t i = 0; i < dataset.n_rows; i++) {
        const struct wb_row *const row = &dataset.rows[i];
        const struct truth_row truth = truth_at(row->t);
        /* The filter has not settled after a jump or a turn of the tension. */
        if (row->phase == WB_PHASE_SLACK || row->deflection < 0.5 * WB_MM ||
            fabs(row->t - plan->travel / session.setup.rig.stage.speed) < 0.5)
            continue;
        n += 1.0;
        level += row->deflection - truth.deflection;
        squares += (row->deflection - truth.deflection) * (row->deflection - truth.deflection);
        tension += row->tension - truth.tension;
        tension_squares += (row->tension - truth.tension) * (row->tension - truth.tension);
    }
    level /= n;
    tension /= n;
    const double bow = wb_dataset_bow(&dataset.info);
    const double bow_uncertainty =
        WB_MM * number_in(&dataset, "natural_shape", "bow_uncertainty_mm");
    print_message("           %s NatNet %d.%d x%g: level %+.3f mm (offsets %+.3f), rms %.3f mm; "
                  "tension %+.1f uN, rms %.1f uN; bow %.2f mm, truth %.2f, stated %.2f\n",
                  plan->specimen, plan->major, plan->minor, plan->time_scale, level / WB_MM,
                  unknown_level() / WB_MM, sqrt(squares / n - level * level) / WB_MM, 1e6 * tension,
                  1e6 * sqrt(tension_squares / n), bow / WB_MM, session.setup.truth.bow / WB_MM,
                  bow_uncertainty / WB_MM);
    assert_true(n > 300.0);
    assert_close(level, unknown_level(), 0.05 * WB_MM);
    assert_close(sqrt(squares / n - level * level), 0.0, 0.07 * WB_MM);
    assert_close(tension, 0.0, 40e-6);
    assert_close(sqrt(tension_squares / n), 0.0, 70e-6);
    assert_close(bow, session.setup.truth.bow, 2.0 * bow_uncertainty);
    assert_true(bow_uncertainty < 0.4 * WB_MM);
    assert_close(dataset.info.rest_level, session.setup.truth.rest_level + unknown_level(),
                 0.06 * WB_MM);
    assert_true(dataset.info.is_virtual);
    wb_dataset_release(&dataset);
}

static void rows_of_a_hold_are_left_out_and_the_hold_is_reported(void **state)
{
    (void)state;
    char path[WB_PATH];
    struct wb_dataset dataset;
    struct wb_align_settings settings;
    wb_align_default_settings(&settings);
    record(&(struct plan){"type1-L85-1", 2, 3, 0, 0.02, 1.0, 6.0}, path);
    if (wb_align_run(&dataset, path, &settings, NULL) != WB_OK)
        fail_msg("not aligned: %s", kept.last);
    const double from = hold_time() - START_S;
    int before = 0, after = 0;
    for (size_t i = 0; i < dataset.n_rows; i++) {
        const double t = dataset.rows[i].t;
        assert_false(t > from && t < from + 6.0);
        before += t > from - 1.0 && t <= from;
        after += t >= from + 6.0 && t < from + 7.0;
    }
    assert_true(before >= 18 && after >= 18); /* of 20 a second */
    const struct wb_json *const holds =
        wb_json_get(wb_json_get(dataset.document, "checks"), "holds");
    double start = 0.0, lasted = 0.0, seconds = 0.0;
    assert_int_equal(wb_json_length(holds), 1);
    assert_true(wb_json_get_number(wb_json_item(holds, 0), "start_s", &start));
    assert_true(wb_json_get_number(wb_json_item(holds, 0), "lasted_s", &lasted));
    assert_close(start, from, 1e-4);
    assert_close(lasted, 6.0, 1e-4);
    assert_int_equal(wb_holds_of_bent_wire(&dataset, &seconds), 1);
    assert_close(seconds, 6.0, 1e-4);
    assert_true(wb_dataset_is_complete(&dataset)); /* a hold is no gap in the data */
    assert_int_equal(number_in(&dataset, "rows", "gaps"), 0);
    assert_int_equal(dataset.rows[dataset.n_rows - 1].cycle, 1);
    const char *warning = "";
    const struct wb_json *const warnings = wb_json_get(dataset.document, "warnings");
    for (size_t i = 0; i < wb_json_length(warnings) && !strstr(warning, "held at"); i++)
        assert_true(wb_json_text(wb_json_item(warnings, i), &warning));
    assert_non_null(strstr(warning, "held at 10.00 mm of travel on the way down of cycle 1 for "
                                    "6.0 s, while the tension went from 60.00 to 58.50 mN"));
    wb_dataset_release(&dataset);
}

static void type_1_is_aligned(void **state)
{
    (void)state;
    assert_aligned(&(struct plan){"type1-L85-1", 1, 3, 0, 0.02, 1.0});
}

static void type_3_is_aligned_at_twenty_times_the_speed(void **state)
{
    (void)state;
    assert_aligned(&(struct plan){"type3-L100-1", 5, 4, 1, 0.02, 20.0});
}

static void a_server_without_echo_is_supported(void **state)
{
    (void)state;
    assert_aligned(&(struct plan){"type2-L85-2", 3, 2, 7, 0.02, 1.0});
}

/* True tension where the tip passes a deflection on the first loading; the strand is vertical
 * there. */
static double true_tension(double deflection)
{
    for (int i = 1; i < session.n_truth; i++) {
        const struct truth_row *const a = &session.truth[i - 1], *const b = &session.truth[i];
        if (a->t > 0.0 && a->deflection < deflection && b->deflection >= deflection)
            return a->tension + (b->tension - a->tension) * (deflection - a->deflection) /
                                    (b->deflection - a->deflection);
    }
    fail_msg("the tip never passes %g mm", deflection / WB_MM);
    return 0.0;
}

static double zero_force_of(const struct wb_dataset *dataset)
{
    const struct wb_json *const list = wb_json_get(dataset->document, "corrections");
    double value = (double)NAN;
    for (size_t i = 0; i < wb_json_length(list); i++) {
        const char *name;
        const struct wb_json *const entry = wb_json_item(list, i);
        if (wb_json_get_text(entry, "name", &name) && strcmp(name, "force at zero deflection") == 0)
            (void)wb_json_get_number(entry, "value_mN", &value);
    }
    return value * WB_MN;
}

/* Wires that bow down yield before the first row that is used: the stated bow and force at zero
 * must be right over many such wires. */
static void downward_bows_are_within_their_stated_uncertainty(void **state)
{
    (void)state;
    static const char *const specimens[] = {"type1-L85-1",  "type2-L85-1",  "type3-L85-1",
                                            "type1-L100-1", "type2-L100-1", "type3-L100-1"};
    double n = 0.0, pulls = 0.0, error = 0.0, zero = 0.0, zero_squares = 0.0;
    for (int seed = 1; seed <= 48; seed++) {
        const struct plan plan = {specimens[seed % 6], (uint64_t)seed, 3, 0, 0.01, 1.0};
        char path[WB_PATH];
        struct wb_dataset dataset;
        struct wb_align_settings settings;
        wb_align_default_settings(&settings);
        setup_bench(&session.setup, plan.specimen, plan.seed);
        if (session.setup.truth.bow > 0.0)
            continue;
        record(&plan, path);
        if (wb_align_run(&dataset, path, &settings, NULL) != WB_OK)
            fail_msg("%s, seed %d not aligned: %s", plan.specimen, seed, kept.last);
        const double off = wb_dataset_bow(&dataset.info) - session.setup.truth.bow;
        const double pull =
            off / (WB_MM * number_in(&dataset, "natural_shape", "bow_uncertainty_mm"));
        const double zero_off = zero_force_of(&dataset) - true_tension(-unknown_level());
        n += 1.0;
        error += off;
        pulls += pull * pull;
        zero += zero_off;
        zero_squares += zero_off * zero_off;
        wb_dataset_release(&dataset);
    }
    pulls = sqrt(pulls / n);
    print_message("           %g wires bowed down: bow off by %.3f mm on average, RMS pull %.2f; "
                  "force at zero off by %+.1f uN on average, RMS %.1f uN\n",
                  n, error / n / WB_MM, pulls, 1e6 * zero / n, 1e6 * sqrt(zero_squares / n));
    assert_true(n >= 15.0);
    assert_true(pulls > 0.3 && pulls < 1.3);
    assert_close(error / n, 0.0, 0.4 * WB_MM);
    /* A straight line instead gives 15.5 uN for the same seeds. */
    assert_close(zero / n, 0.0, 12e-6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(type_1_is_aligned),
        cmocka_unit_test(rows_of_a_hold_are_left_out_and_the_hold_is_reported),
        cmocka_unit_test(type_3_is_aligned_at_twenty_times_the_speed),
        cmocka_unit_test(a_server_without_echo_is_supported),
        cmocka_unit_test(downward_bows_are_within_their_stated_uncertainty),
    };
    return cmocka_run_group_tests(tests, start, remove_folder);
}
