/* Alignment of synthetic recordings whose truth is known, with typical faults of benches. */
#include "analysis/align/align.h"

#include "base/file.h"
#include "base/log.h"
#include "daq/recording/survey.h"
#include "tests/analysis/synthetic.h"
#include "tests/messages.h"
#include "tests/schemas.h"
#include "tests/trials.h"

static int n_recordings;

static int start(void **state)
{
    keep_messages();
    return make_folder(state);
}

/* The test to record, and its dataset. */
static struct syn syn;
static struct wb_dataset dataset;

static int begin(void **state)
{
    (void)state;
    syn_default(&syn);
    memset(&dataset, 0, sizeof dataset);
    return 0;
}

static int end(void **state)
{
    (void)state;
    wb_dataset_release(&dataset);
    return 0;
}

/* A test with its own bench and dataset. */
#define TEST(name) cmocka_unit_test_setup_teardown(name, begin, end)

static void record(char path[WB_PATH])
{
    snprintf(path, WB_PATH, "%s/test-%d.wbr", folder, ++n_recordings);
    syn_record(&syn, path);
}

static enum wb_status run(const char *path, struct wb_reason *why)
{
    struct wb_align_settings settings;
    wb_align_default_settings(&settings);
    wb_dataset_release(&dataset);
    return wb_align_run(&dataset, path, &settings, why);
}

/* Records and aligns. */
static void align(void)
{
    char path[WB_PATH];
    record(path);
    if (run(path, NULL) != WB_OK)
        fail_msg("not aligned: %s", kept.last);
}

/* Aligning must fail with `expected` in the reason, or in the log if no reason is passed, but never
 * in both. Restores the default bench. */
static void expect_rejection(const char *expected)
{
    struct wb_reason why = {.text = "of before"};
    char path[WB_PATH];
    record(path);
    assert_int_equal(run(path, NULL), WB_ERR_DATA);
    assert_message(expected);
    assert_int_equal(run(path, &why), WB_ERR_DATA);
    assert_string_equal(why.text, kept.error);
    keep_messages();
    assert_int_equal(run(path, &why), WB_ERR_DATA);
    assert_string_equal(kept.error, "");
    syn_default(&syn);
}

/* Overwrites the recording from this part of its length on. */
static void overwrite(const char *path, double part)
{
    FILE *const file = fopen(path, "r+b");
    assert_non_null(file);
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    const long size = ftell(file), from = (long)(part * (double)size) / 4096 * 4096;
    assert_int_equal(fseek(file, from, SEEK_SET), 0);
    for (long i = from; i < size; i++)
        assert_int_equal(fputc(0, file), 0);
    assert_int_equal(fclose(file), 0);
}

/* --- corrections, checks and warnings of the dataset --- */

static double correction(const struct wb_dataset *of, const char *name, const char *key)
{
    const struct wb_json *const list = wb_json_get(of->document, "corrections");
    for (size_t i = 0; i < wb_json_length(list); i++) {
        const struct wb_json *const entry = wb_json_item(list, i);
        const char *text;
        double value;
        if (wb_json_get_text(entry, "name", &text) && strcmp(text, name) == 0)
            return wb_json_get_number(entry, key, &value) ? value : (double)NAN;
    }
    fail_msg("no correction '%s'", name);
    return (double)NAN;
}

static double check(const char *group, const char *key)
{
    double value;
    const struct wb_json *const object =
        wb_json_get(wb_json_get(dataset.document, "checks"), group);
    return wb_json_get_number(object, key, &value) ? value : (double)NAN;
}

static bool warns(const char *of)
{
    const struct wb_json *const list = wb_json_get(dataset.document, "warnings");
    const char *text;
    for (size_t i = 0; i < wb_json_length(list); i++) {
        if (wb_json_text(wb_json_item(list, i), &text) && (!of || strstr(text, of)))
            return true;
    }
    return false;
}

/* --- against the truth --- */

struct errors {
    int n;
    double deflection_mean, deflection_rms, force_mean, force_rms, largest_force; /* SI */
};

/* Errors of the rows of one phase, without those in which the filter settles after a jump or a
 * turn. */
static struct errors compare(enum wb_phase phase)
{
    struct errors errors = {0};
    struct syn truth = syn;
    truth.largest_y = SYN_REST;
    const double zero = syn_carried() - truth.stiffness * truth.bow;
    double changed = -1.0;
    enum wb_phase before = WB_PHASE_SLACK;
    for (size_t i = 0; i < dataset.n_rows; i++) {
        const struct wb_row *const row = &dataset.rows[i];
        const struct syn_state then = syn_move(&truth, row->t);
        if (row->phase != before)
            changed = row->t;
        before = row->phase;
        if (row->phase != phase || row->t < changed + 0.5)
            continue;
        const double dy = row->deflection - then.y;
        const double df = row->force - (then.vertical - zero);
        errors.n++;
        errors.deflection_mean += dy;
        errors.deflection_rms += dy * dy;
        errors.force_mean += df;
        errors.force_rms += df * df;
        errors.largest_force = fmax(errors.largest_force, fabs(df));
    }
    errors.deflection_mean /= errors.n;
    errors.force_mean /= errors.n;
    errors.deflection_rms = sqrt(errors.deflection_rms / errors.n);
    errors.force_rms = sqrt(errors.force_rms / errors.n);
    return errors;
}

/* Noise of 0.1 mm and 98 uN, averaged over six frames and five readings. The vertical is found from
 * 20 mm of noisy motion: 0.2 mrad, 0.02 mm at the tip, and the corresponding force. */
static void assert_true_to_bench(void)
{
    for (int phase = WB_PHASE_LOAD; phase <= WB_PHASE_UNLOAD; phase++) {
        const struct errors errors = compare((enum wb_phase)phase);
        assert_true(errors.n > 100);
        assert_close(errors.deflection_mean, 0.0, 0.05e-3);
        assert_close(errors.deflection_rms, 0.0, 0.08e-3);
        assert_close(errors.force_mean, 0.0, 0.1e-3);
        assert_close(errors.force_rms, 0.0, 0.12e-3);
    }
}

static void dataset_matches_the_true_test(void **state)
{
    (void)state;
    align();
    assert_true_to_bench();
    assert_false(warns(NULL));

    assert_string_equal(dataset.info.wire, "synthetic");
    assert_int_equal(dataset.info.sample, 2);
    assert_true(dataset.info.is_virtual && !dataset.info.is_simulation);
    assert_close(dataset.info.length, SYN_LENGTH, 1e-12);
    assert_close(dataset.info.strand_length, SYN_STRAND, 1e-12);
    assert_close(dataset.info.counterweight, SYN_COUNTERWEIGHT, 1e-12);
    assert_close(dataset.info.rest_level, SYN_REST, 0.05e-3);
    assert_close(correction(&dataset, "filter delay", "value_ms"), 50.0, 1e-9);
    assert_close(correction(&dataset, "tare", "value_mN"), 3.0, 1e-6);
    assert_close(correction(&dataset, "force at zero deflection", "value_mN"),
                 (syn_carried() - syn.stiffness * syn.bow) / WB_MN, 0.05);
    /* Shapes: the markers lie on the axis of the true wire. */
    assert_true(dataset.n_shape_rows > 40 * SYN_MARKERS);
    double sum = 0.0;
    for (size_t i = 0; i < dataset.n_shape_rows; i++) {
        const struct wb_shape_row *const row = &dataset.shape_rows[i];
        double x, y;
        syn_point(&syn, syn_look_up(syn.table_y, syn.table_a, row->deflection), syn_s[row->marker],
                  &x, &y);
        sum += (row->x - x) * (row->x - x) + (row->y - y) * (row->y - y);
    }
    assert_close(sqrt(sum / (double)dataset.n_shape_rows), 0.0, 0.1e-3);
}

/* Mean height (m) of the inner markers above the true wire at their deflection, loading or
 * unloading. Only deflections that both phases reach are used: a small error of the vertical then
 * affects both alike. */
static double mean_height(enum wb_phase phase)
{
    double sum = 0.0, turn = 0.0;
    int n = 0;
    for (size_t i = 0; i < dataset.n_rows; i++) {
        if (dataset.rows[i].phase == WB_PHASE_LOAD)
            turn = dataset.rows[i].t;
    }
    for (size_t i = 0; i < dataset.n_shape_rows; i++) {
        const struct wb_shape_row *const row = &dataset.shape_rows[i];
        if (row->marker == 0 || row->marker == SYN_MARKERS - 1 || row->deflection < 20e-3 ||
            row->deflection > 38e-3 || (row->t > turn) != (phase == WB_PHASE_UNLOAD))
            continue;
        double x, y;
        syn_point(&syn, syn_look_up(syn.table_y, syn.table_a, row->deflection), syn_s[row->marker],
                  &x, &y);
        sum += row->y - y;
        n++;
    }
    assert_true(n > 100);
    return sum / n;
}

/* A row's deflection is the mean of six frames, here with a noise of 0.16 mm. Rows chosen by their
 * own deflection would lead their inner markers by 0.05 mm on average. */
static void shapes_do_not_lag_behind_their_deflections(void **state)
{
    enum {
        DRAWS = 8
    };
    (void)state;
    double lag = 0.0;
    for (int i = 0; i < DRAWS; i++) {
        syn.marker_noise = 0.4e-3;
        syn.travel = 42e-3;
        syn.another = (uint64_t)i;
        align();
        lag += 0.5 * (mean_height(WB_PHASE_UNLOAD) - mean_height(WB_PHASE_LOAD)) / DRAWS;
    }
    assert_close(lag, 0.0, 0.012e-3);
}

static void bows_are_within_their_stated_uncertainty(void **state)
{
    (void)state;
    static const double bows[] = {-4e-3, -2.2e-3, 0.0, 2e-3, 3.7e-3};
    for (size_t i = 0; i < sizeof bows / sizeof bows[0]; i++) {
        syn_default(&syn);
        syn.bow = bows[i];
        align();
        const double stated = correction(&dataset, "natural shape", "uncertainty_mm") * WB_MM;
        const double bow = wb_dataset_bow(&dataset.info);
        assert_true(stated < 0.4e-3);
        assert_close(bow, bows[i], 2.0 * stated);
        /* The markers alone barely resolve it. */
        assert_close(check("natural_shape", "bow_from_markers_mm") * WB_MM, bows[i],
                     2.0 * WB_MM * check("natural_shape", "bow_from_markers_uncertainty_mm"));
    }
}

static void an_elastic_loop_is_closed(void **state)
{
    (void)state;
    syn.unloading = syn.stiffness;
    syn.force_noise = 30e-6;
    align();
    /* Without the correction of the filter's delay the loop would be 2 v dt = 0.1 mm wide: 36 uN
     * rms. */
    const double width = check("timing", "loop_area_mJ") * 1e-3 / (syn.stiffness * 19e-3);
    assert_close(width, 0.0, 0.01e-3);
    assert_close(check("timing", "loop_width_error_mm"), 0.01, 0.001);
    assert_close(check("timing", "speed_mm_s"), 1.0, 0.01);
}

static void drift_between_zero_loads_is_subtracted(void **state)
{
    (void)state;
    syn.drift = 20e-6; /* 1.2 mN/min: a bad cell */
    syn.cycles = 2;
    align();
    assert_true_to_bench();
    assert_close(correction(&dataset, "zero drift", "value_mN"),
                 syn.drift * 2.0 * syn_cycle_time(&syn) / WB_MN, 0.1);
}

/* Only the event differs: the weight on the cell is subtracted from the tare. */
static void a_tare_with_the_counterweight_gives_the_same_tension(void **state)
{
    (void)state;
    align();
    struct wb_dataset unloaded = dataset;
    memset(&dataset, 0, sizeof dataset);
    syn_default(&syn);
    syn.loaded_tare = true;
    align();
    assert_true_to_bench();
    assert_close(correction(&dataset, "tare", "value_mN"),
                 correction(&unloaded, "tare", "value_mN"), 1e-4);
    assert_int_equal(dataset.n_rows, unloaded.n_rows);
    assert_close(dataset.rows[dataset.n_rows / 2].tension,
                 unloaded.rows[unloaded.n_rows / 2].tension, 1e-9);
    wb_dataset_release(&unloaded);
}

static void undetectable_drift_is_bounded(void **state)
{
    (void)state;
    char path[WB_PATH];
    /* The cell stops sending before the strand becomes slack again. */
    syn.gap_from = 35.0;
    syn.gap_until = 1e9;
    record(path);
    assert_int_equal(run(path, NULL), WB_OK);
    const bool only_tare = warns("zero drift is not corrected");
    const double value = correction(&dataset, "zero drift", "value_mN");
    assert_true(only_tare);
    assert_close(value, 0.0, 0.03);
    assert_true(correction(&dataset, "zero drift", "uncertainty_mN") > 0.0);
}

static void cycles_and_phases_come_from_the_clamp(void **state)
{
    (void)state;
    syn.cycles = 3;
    syn.no_events = true;
    align();
    const double cycle_time = syn_cycle_time(&syn), down = syn.travel / SYN_SPEED;
    assert_false(warns(NULL));
    /* Without events time counts from the tare. */
    int wrong = 0;
    for (size_t i = 0; i < dataset.n_rows; i++) {
        const struct wb_row *const row = &dataset.rows[i];
        const double in = fmod(row->t, cycle_time);
        if (fabs(in - down) < 0.2 || in > 2.0 * down - 0.2 || in < 0.2)
            continue;
        wrong += row->cycle != 1 + (int)(row->t / cycle_time);
        wrong += row->phase == (in < down ? WB_PHASE_UNLOAD : WB_PHASE_LOAD);
    }
    assert_int_equal(wrong, 0);
    assert_int_equal(dataset.rows[dataset.n_rows - 1].cycle, 3);
}

static void slack_rows_are_those_without_tension(void **state)
{
    (void)state;
    align();
    struct syn truth = syn;
    truth.largest_y = SYN_REST;
    int wrong = 0, slack = 0;
    for (size_t i = 0; i < dataset.n_rows; i++) {
        const struct wb_row *const row = &dataset.rows[i];
        const double tension = syn_move(&truth, row->t).tension;
        slack += row->phase == WB_PHASE_SLACK;
        /* In between, filter and noise blur the transition, and either is right. */
        if (tension == 0.0 || tension > 1e-3)
            wrong += (row->phase == WB_PHASE_SLACK) != (tension == 0.0);
    }
    assert_true(slack > 80);
    assert_true(wrong <= 6);
}

static void lost_steps_are_flagged_and_do_not_change_the_deflection(void **state)
{
    (void)state;
    align();
    assert_close(check("stage", "slope"), 1.0, 1e-3);
    assert_close(check("stage", "largest_residual_mm"), 0.0, 0.1);
    assert_close(check("stage", "report_lag_ms"), 12.0, 5.0);

    syn_default(&syn);
    syn.lost = 0.8e-3;
    syn.lost_at = 12e-3;
    align();
    assert_true(warns("lost steps"));
    assert_close(check("stage", "not_returned_mm"), -0.8, 0.05);
    assert_true_to_bench();
}

static void occlusions_strays_and_new_ids_leave_gaps_only(void **state)
{
    (void)state;
    syn.stray = syn.ids_change = true;
    syn.hidden_marker = 3;
    syn.hidden_from = 8.0;
    syn.hidden_until = 14.0;
    align();
    assert_true_to_bench();
    for (size_t i = 0; i < dataset.n_shape_rows; i++) {
        const struct wb_shape_row *const row = &dataset.shape_rows[i];
        assert_false(row->marker == 3 && row->t > 8.03 && row->t < 13.97);
    }

    /* The tip's own marker, filled in by the server at a wrong place, gives no row. */
    syn.hidden_marker = SYN_MARKERS - 1;
    syn.model_filled = true;
    align();
    assert_true_to_bench();
    assert_true(warns("in the rows"));
    for (size_t i = 0; i < dataset.n_rows; i++)
        assert_false(dataset.rows[i].t > 8.01 && dataset.rows[i].t < 13.99);
}

static void rows_beside_a_loss_of_the_clamp_are_right(void **state)
{
    (void)state;
    for (int k = 0; k < 8; k++) {
        syn_default(&syn);
        syn.hidden_marker = 0;
        syn.hidden_from = 8.0 + 0.0117 * k;
        syn.hidden_until = 12.0 + 0.0083 * k;
        align();
        syn.largest_y = SYN_REST;
        double worst = 0.0;
        int beside = 0;
        for (size_t i = 0; i < dataset.n_rows; i++) {
            const struct wb_row *const row = &dataset.rows[i];
            const double y = syn_move(&syn, row->t).y;
            assert_false(row->t > syn.hidden_from + 0.05 && row->t < syn.hidden_until - 0.05);
            if (row->t < 7.5 || row->t > 12.6)
                continue;
            worst = fmax(worst, fabs(row->deflection - y));
            beside++;
        }
        assert_true(beside > 10);
        assert_close(worst, 0.0, 0.15e-3);
    }
}

static void a_silent_load_cell_leaves_a_gap(void **state)
{
    (void)state;
    syn.gap_from = 10.0;
    syn.gap_until = 13.0;
    align();
    bool complete = true;
    assert_true_to_bench();
    assert_true(wb_json_get_boolean(dataset.document, "complete", &complete) && !complete);
    for (size_t i = 0; i < dataset.n_rows; i++)
        assert_false(dataset.rows[i].t > 10.1 && dataset.rows[i].t < 12.8);
}

/* A loss of frames or readings from dataset.json. */
static double loss(const char *what, const char *key)
{
    double value;
    const struct wb_json *const losses =
        wb_json_get(wb_json_get(wb_json_get(dataset.document, "checks"), "losses"), what);
    return wb_json_get_number(losses, key, &value) ? value : (double)NAN;
}

/* A problem that the check of the recording finds in the data alone: no sequence number is
 * missing. */
static void assert_problem(const char *path, const char *words)
{
    struct wb_recording *recording;
    struct wb_survey survey;
    char text[256], all[2048] = "";
    assert_int_equal(wb_recording_open(&recording, path), WB_OK);
    assert_int_equal(wb_survey_run(recording, true, &survey), WB_OK);
    assert_int_equal(wb_recording_close(recording), WB_OK);
    for (int at = 0; wb_survey_problem(&survey, &at, text, sizeof text);) {
        if (strstr(text, words))
            return;
        strncat(all, text, sizeof all - strlen(all) - 1);
    }
    fail_msg("no '%s' in: %s", words, all);
}

static void frames_and_lines_that_never_came_are_counted(void **state)
{
    (void)state;
    align();
    assert_true(loss("frames", "missing") == 0.0);
    assert_true(loss("readings", "missing") == 0.0);
    char path[WB_PATH];
    syn_default(&syn);
    syn.vanish = 0.3;
    record(path);
    assert_int_equal(run(path, NULL), WB_OK);
    assert_true(loss("frames", "missing") == (double)syn.vanished_frames);
    assert_close(loss("readings", "missing"), (double)syn.vanished_lines,
                 0.03 * (double)syn.vanished_lines);
    assert_true(warns("% of the frames never came") && warns("% of the readings never came"));
    assert_true_to_bench();
    assert_problem(path, "mocap stream 1: 30 % of its frames never came");
    assert_problem(path, "load stream 0: 30 % of its lines never came");
}

static void overtaken_and_repeated_frames_are_put_in_order(void **state)
{
    (void)state;
    align();
    const double rows = (double)dataset.n_rows, frames = loss("frames", "received");
    syn_default(&syn);
    syn.overtaken = true;
    align();
    assert_true(loss("frames", "missing") == 0.0);
    assert_true(loss("frames", "received") == frames);
    assert_close(loss("frames", "overtaken"), frames / 10.0, 1.0);
    assert_close(loss("frames", "repeated"), frames / 10.0, 1.0);
    assert_false(warns(NULL));
    assert_true((double)dataset.n_rows == rows);
    assert_true_to_bench();
}

/* The worst streams of a network and a clock, all faults at once. */
static void force_and_deflection_are_right_despite_loss_disorder_and_drift(void **state)
{
    (void)state;
    static const double shares[] = {0.05, 0.2, 0.5}, skews[] = {-200e-6, 0.0, 200e-6};
    int n = 0;
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            for (int way = 0; way < 4; way++, n++) {
                syn_default(&syn);
                syn.vanish = shares[i];
                syn.skew = skews[k];
                syn.overtaken = way & 1;
                syn.restart_at = way & 2 ? 17.0 : 0.0;
                align();
                assert_true_to_bench();
                assert_true(warns("% of the frames never came"));
            }
        }
    }
    count_trials(
        "Frames and lines lost to 50 %, overtaken, repeated; clocks restarted, 200 ppm off",
        (uint64_t)n, "tests: force and deflection as without, and the loss reported");
}

static void servers_without_echo_and_restarted_servers_are_supported(void **state)
{
    (void)state;
    syn.version_major = 2;
    syn.version_minor = 7;
    align();
    assert_true_to_bench();
    assert_true(isnan(check("timing", "camera_clock_uncertainty_ms")));

    syn_default(&syn);
    syn.restart_at = 17.0;
    align();
    assert_true_to_bench();
    assert_int_equal(
        wb_json_length(wb_json_get(wb_json_get(dataset.document, "checks"), "camera_clock")), 2);
}

static void the_clock_is_mapped_by_the_probes(void **state)
{
    (void)state;
    align();
    const struct wb_json *const segment =
        wb_json_item(wb_json_get(wb_json_get(dataset.document, "checks"), "camera_clock"), 0);
    double skew, uncertainty;
    assert_true(wb_json_get_number(segment, "skew_ppm", &skew));
    assert_true(wb_json_get_number(segment, "uncertainty_ms", &uncertainty));
    assert_close(skew, 50.0, 3.0);
    assert_true(uncertainty > 0.0 && uncertainty < 0.3);
}

static void a_scaled_bench_keeps_its_own_time(void **state)
{
    (void)state;
    syn.time_scale = 20.0;
    align();
    assert_true_to_bench();
    assert_close(dataset.rows[dataset.n_rows - 1].t, syn_cycle_time(&syn), 0.3);
}

static void any_position_of_the_cameras_is_supported(void **state)
{
    (void)state;
    for (int i = 0; i < 4; i++) {
        syn_default(&syn);
        syn.z_up = i % 2;
        syn.plane_angle = -2.5 + 1.4 * i;
        align();
        assert_true_to_bench();
    }
}

static void a_busy_host_does_not_change_the_result(void **state)
{
    (void)state;
    syn.busy_from = 9.0;
    syn.busy_until = 11.2;
    align();
    assert_true_to_bench();
    assert_false(warns(NULL));
}

static void polled_readings_keep_their_arrival(void **state)
{
    (void)state;
    syn.polled = true;
    align();
    assert_true_to_bench();
    assert_true(isnan(check("load_cell_stream", "arrival_scatter_ms")));
}

/* --- with files that correct the recording --- */

static void write_text(char path[WB_PATH], const char *name, const char *text)
{
    snprintf(path, WB_PATH, "%s/%s", folder, name);
    assert_int_equal(wb_file_write(path, text, strlen(text)), WB_OK);
}

static enum wb_status run_corrected(const char *path, const char *rig, const char *specimen,
                                    struct wb_reason *why)
{
    struct wb_align_settings settings;
    wb_align_default_settings(&settings);
    settings.rig_path = rig;
    settings.specimen_path = specimen;
    wb_dataset_release(&dataset);
    return wb_align_run(&dataset, path, &settings, why);
}

/* The entry of key `key` of the corrected rig or specimen in dataset.json. */
static void assert_difference(const char *what, const char *key, const char *recorded,
                              const char *given)
{
    const struct wb_json *const entry =
        wb_json_item(wb_json_get(dataset.document, "recordings"), 0);
    const struct wb_json *const list =
        wb_json_get(wb_json_get(wb_json_get(entry, "corrected"), what), "differences");
    const char *text;
    for (size_t i = 0; i < wb_json_length(list); i++) {
        const struct wb_json *const item = wb_json_item(list, i);
        assert_true(wb_json_get_text(item, "key", &text));
        if (strcmp(text, key) != 0)
            continue;
        assert_true(wb_json_get_text(item, "recorded", &text));
        assert_string_equal(text, recorded);
        assert_true(wb_json_get_text(item, "given", &text));
        assert_string_equal(text, given);
        return;
    }
    fail_msg("no difference in '%s' of %zu", key, wb_json_length(list));
}

static void a_wrong_specimen_length_can_be_corrected(void **state)
{
    (void)state;
    char path[WB_PATH], right[WB_PATH];
    syn.specimen = "wire: synthetic\n"
                   "length_mm: 100\n"
                   "sample: 2\n"
                   "markers_mm: [0, 16.7, 33.3, 50, 66.7, 83.3, 100]\n"
                   "marker_offset_mm: 1.0\n"
                   "marker_offset_uncertainty_mm: 0.050\n";
    record(path);
    assert_int_equal(run(path, NULL), WB_ERR_DATA);
    write_text(right, "right.yaml", syn_specimen);
    assert_int_equal(run_corrected(path, NULL, right, NULL), WB_OK);
    assert_true_to_bench();
    assert_close(dataset.info.length, SYN_LENGTH, 1e-12);
    assert_difference("specimen", "length_mm", "100", "85");
    assert_difference("specimen", "markers_mm", "[0, 16.7, 33.3, 50, 66.7, 83.3, 100]",
                      "[0, 14.2, 28.3, 42.5, 56.7, 70.8, 85]");
    assert_true(warns("specimen corrected: length_mm is 85 in place of the recorded 100"));
    /* 0.05 and 0.050 are one number. */
    assert_false(warns("uncertainty"));
}

/* The uncertainty is the tolerance of the check where the rig file states none. */
static void a_checked_load_cell_has_the_uncertainty_of_its_check(void **state)
{
    (void)state;
    static const struct {
        const char *check;
        double gain;
    } cases[] = {
        {NULL, 0.0},
        {"2026-01-01T09:00:00Z,10,10.004,4,0.04,0.6,yes,", 0.006},
        {"2026-01-01T09:00:00Z,10,10.2,200,2,0.6,no,", 0.0},
        {"2026-01-01T09:00:00Z,10,10.004,4,0.04,0.6,yes,another cell", 0.0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        syn.check = cases[i].check;
        align();
        assert_close(dataset.info.uncertainty.gain, cases[i].gain / sqrt(3.0), 1e-12);
        assert_close(dataset.info.uncertainty.marker_offset, 0.05e-3, 1e-12);
        assert_close(dataset.info.uncertainty.length, 0.0, 0.0);
    }
}

static void a_wrong_load_cell_scale_is_corrected_with_its_tare(void **state)
{
    (void)state;
    char path[WB_PATH], right[WB_PATH], rig[2048];
    syn.scale = 0.5;
    record(path);
    syn_rig(&syn, 0.0, rig);
    write_text(right, "right-rig.yaml", rig);
    assert_int_equal(run_corrected(path, right, NULL, NULL), WB_OK);
    assert_true_to_bench();
    assert_close(correction(&dataset, "tare", "value_mN"), 3.0, 0.05);
    assert_difference("rig", "load_cell.scale", "0.5", "none");
    assert_true(warns("rig corrected: load_cell.scale is none in place of the recorded 0.5"));
}

static void a_virtual_recording_stays_virtual_when_corrected(void **state)
{
    (void)state;
    char path[WB_PATH], right[WB_PATH], rig[2048];
    record(path);
    syn_rig(&syn, 0.0, rig);
    char *const flag = strstr(rig, "virtual: true\n");
    assert_non_null(flag);
    flag[0] = '\0';
    write_text(right, "no-longer-virtual.yaml", rig);
    assert_int_equal(run_corrected(path, right, NULL, NULL), WB_OK);
    assert_true(dataset.info.is_virtual);
    assert_difference("rig", "virtual", "true", "none");
}

static void errors_in_given_files_are_reported(void **state)
{
    (void)state;
    char path[WB_PATH], wrong[WB_PATH];
    struct wb_reason why = {.text = ""};
    record(path);
    assert_int_equal(run_corrected(path, "/nonexistent/rig.yaml", NULL, &why), WB_ERR_NOT_FOUND);
    assert_non_null(strstr(why.text, "/nonexistent/rig.yaml"));
    write_text(wrong, "wrong.yaml", "wire: synthetic\nlength_mm: many\n");
    assert_int_equal(run_corrected(path, NULL, wrong, &why), WB_ERR_FORMAT);
    assert_non_null(strstr(why.text, "wrong.yaml:2: length_mm"));
    write_text(wrong, "other-wire.yaml",
               "wire: no-such-wire\nlength_mm: 85\nsample: 2\n"
               "markers_mm: [0, 14.2, 28.3, 42.5, 56.7, 70.8, 85]\nmarker_offset_mm: 1.0\n");
    assert_int_equal(run_corrected(path, NULL, wrong, &why), WB_ERR_NOT_FOUND);
    assert_non_null(strstr(why.text, "other-wire.yaml:1: wire"));
}

static void unusable_recordings_are_rejected_with_the_reason(void **state)
{
    (void)state;
    syn.no_tare = true;
    expect_rejection("tare");
    syn.sign = -1.0;
    expect_rejection("sign");
    syn.no_motion = true;
    expect_rejection("moved");
    syn.marker_noise = 20e-3;
    expect_rejection("markers not found");
    syn.gap_from = -100.0;
    syn.gap_until = 1e9;
    expect_rejection("no reading");
    struct wb_align_settings settings;
    wb_align_default_settings(&settings);
    assert_int_equal(wb_align_run(&dataset, "/nonexistent/test.wbr", &settings, NULL),
                     WB_ERR_NOT_FOUND);
    settings.longest_gap = -1.0;
    assert_int_equal(wb_align_run(&dataset, "/nonexistent/test.wbr", &settings, NULL),
                     WB_ERR_ARGUMENT);
}

/* Unreadable parts precede the failure that they caused; those of a recording that can still be
 * aligned are logged. */
static void unreadable_parts_are_reported_with_the_reason(void **state)
{
    (void)state;
    char path[WB_PATH];
    struct wb_reason why = {.text = ""};
    record(path);
    overwrite(path, 0.97);
    keep_messages();
    assert_int_equal(run(path, &why), WB_OK);
    assert_non_null(strstr(kept.error, "table chunk is damaged"));
    assert_string_equal(why.text, "");
    assert_true(warns("the recording breaks off"));

    overwrite(path, 0.1);
    keep_messages();
    assert_int_equal(run(path, &why), WB_ERR_DATA);
    assert_string_equal(kept.error, "");
    const char *const lost = strstr(why.text, "table chunk is damaged");
    assert_non_null(lost);
    const char *const failed = strstr(lost, "; ");
    assert_non_null(failed);
    assert_int_equal(run(path, NULL), WB_ERR_DATA);
    assert_string_equal(failed + 2, kept.error);
}

static void corrupt_bytes_never_crash_the_alignment(void **state)
{
    (void)state;
    static const double parts[] = {0.003, 0.05, 0.5, 1.0};
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        char path[WB_PATH];
        syn_default(&syn);
        syn.corrupt = parts[i];
        syn.travel = 8e-3;
        record(path);
        const enum wb_status status = run(path, NULL);
        assert_true(status == WB_OK || status == WB_ERR_DATA);
        /* A few wrong bytes are typical of a bad cable; the rest of the test is still usable. */
        if (i == 0)
            assert_int_equal(status, WB_OK);
    }
}

static void the_same_recording_gives_the_same_bytes(void **state)
{
    (void)state;
    static const char *const files[] = {"dataset.json", "force_deflection.csv", "shape.csv"};
    char path[WB_PATH], outputs[2][WB_PATH];
    record(path);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(run(path, NULL), WB_OK);
        snprintf(outputs[i], WB_PATH, "%.200s/output-%d", folder, i);
        assert_int_equal(wb_dataset_write(&dataset, outputs[i], false), WB_OK);
    }
    for (size_t k = 0; k < 3; k++) {
        char *bytes[2], name[2][WB_PATH];
        size_t size[2];
        for (int i = 0; i < 2; i++) {
            assert_int_equal(wb_file_join(name[i], outputs[i], files[k]), WB_OK);
            assert_int_equal(wb_file_read(name[i], &bytes[i], &size[i]), WB_OK);
        }
        assert_int_equal(size[0], size[1]);
        assert_memory_equal(bytes[0], bytes[1], size[0]);
        assert_null(strstr(bytes[0], folder));
        free(bytes[0]);
        free(bytes[1]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(dataset_matches_the_true_test),
        TEST(shapes_do_not_lag_behind_their_deflections),
        TEST(bows_are_within_their_stated_uncertainty),
        TEST(an_elastic_loop_is_closed),
        TEST(drift_between_zero_loads_is_subtracted),
        TEST(a_tare_with_the_counterweight_gives_the_same_tension),
        TEST(undetectable_drift_is_bounded),
        TEST(cycles_and_phases_come_from_the_clamp),
        TEST(slack_rows_are_those_without_tension),
        TEST(lost_steps_are_flagged_and_do_not_change_the_deflection),
        TEST(occlusions_strays_and_new_ids_leave_gaps_only),
        TEST(rows_beside_a_loss_of_the_clamp_are_right),
        TEST(a_silent_load_cell_leaves_a_gap),
        TEST(frames_and_lines_that_never_came_are_counted),
        TEST(overtaken_and_repeated_frames_are_put_in_order),
        TEST(servers_without_echo_and_restarted_servers_are_supported),
        TEST(the_clock_is_mapped_by_the_probes),
        TEST(force_and_deflection_are_right_despite_loss_disorder_and_drift),
        TEST(a_scaled_bench_keeps_its_own_time),
        TEST(any_position_of_the_cameras_is_supported),
        TEST(a_busy_host_does_not_change_the_result),
        TEST(polled_readings_keep_their_arrival),
        TEST(a_wrong_specimen_length_can_be_corrected),
        TEST(a_checked_load_cell_has_the_uncertainty_of_its_check),
        TEST(a_wrong_load_cell_scale_is_corrected_with_its_tare),
        TEST(a_virtual_recording_stays_virtual_when_corrected),
        TEST(errors_in_given_files_are_reported),
        TEST(unusable_recordings_are_rejected_with_the_reason),
        TEST(unreadable_parts_are_reported_with_the_reason),
        TEST(corrupt_bytes_never_crash_the_alignment),
        TEST(the_same_recording_gives_the_same_bytes),
    };
    return cmocka_run_group_tests(tests, start, check_and_remove_folder);
}
