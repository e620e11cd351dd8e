/* A stored recording, written in the file formats of a laboratory, is imported as the same test;
 * and nothing is written if the files do not suffice. */
#include "analysis/import/mocap_import.h"

#include <stdlib.h>
#include <unistd.h>

#include "analysis/align/align.h"
#include "analysis/dataset/fit.h"
#include "base/file.h"
#include "base/text.h"
#include "base/units.h"
#include "daq/protocol/clock.h"
#include "daq/recording/foreign.h"
#include "daq/recording/recording.h"
#include "daq/recording/replay.h"
#include "daq/take/take_reader.h"
#include "tests/daq/take_example.h"
#include "tests/messages.h"
#include "tests/own_folder.h"

#define MOST 20000
#define MOST_IDS 64
#define RATE 120.0
/* s: the force's clock less the take's. */
#define CLOCKS 62.75

/* The samples of the recording's instruments. */
static struct {
    int n_frames, n_readings, n_ids;
    struct wb_mocap_frame *frames;
    struct wb_load_sample readings[MOST];
    int32_t ids[MOST_IDS];
    double host_less_device; /* s */
} sent;

static char take_path[64], force_path[64], output[64], original[WB_PATH];
static char specimen_path[WB_PATH], rig_path[WB_PATH];
static struct wb_dataset reference;

static void take_frame(void *context, const struct wb_mocap_frame *frame)
{
    (void)context;
    if (sent.n_frames < MOST)
        sent.frames[sent.n_frames++] = *frame;
    for (int i = 0; i < frame->n_markers; i++) {
        int k = 0;
        while (k < sent.n_ids && sent.ids[k] != frame->markers[i].id)
            k++;
        if (k == sent.n_ids && k < MOST_IDS)
            sent.ids[sent.n_ids++] = frame->markers[i].id;
    }
}

static void take_reading(void *context, const struct wb_load_sample *sample)
{
    (void)context;
    if (sent.n_readings < MOST && sample->valid)
        sent.readings[sent.n_readings++] = *sample;
}

static double frame_time(int i)
{
    return (sent.frames[i].frame_number - sent.frames[0].frame_number) / RATE;
}

/* --- files --- */

static bool is_measured(const struct wb_marker *marker)
{
    return !(marker->params & (WB_MARKER_OCCLUDED | WB_MARKER_MODEL_FILLED));
}

/* One column for each id, and a marker has a new id each time it is found again. */
static void write_motive(int first, int last)
{
    struct wb_text text = {0};
    wb_text_append(&text,
                   "Format Version,1.23,Take Name,t,Capture Frame Rate,120.000000,Export Frame "
                   "Rate,120.000000,Total Exported Frames,%d,Length Units,Millimeters,Coordinate "
                   "Space,Global\n\n",
                   last - first);
    static const char *const rows[] = {",Type", ",Name", ",ID", ",", "Frame,Time (Seconds)"};
    for (int r = 0; r < 5; r++) {
        wb_text_append(&text, "%s", rows[r]);
        for (int i = 0; i < 3 * sent.n_ids; i++) {
            if (r == 1)
                wb_text_append(&text, ",Unlabeled %d", sent.ids[i / 3]);
            else
                wb_text_append(&text, ",%s",
                               r == 0       ? "Marker"
                               : r == 2     ? "90AF"
                               : r == 3     ? "Position"
                               : i % 3 == 0 ? "X"
                               : i % 3 == 1 ? "Y"
                                            : "Z");
        }
        wb_text_append(&text, "\n");
    }
    for (int f = first; f < last; f++) {
        const struct wb_mocap_frame *const frame = &sent.frames[f];
        wb_text_append(&text, "%d,%.6f", frame->frame_number - sent.frames[0].frame_number,
                       frame_time(f));
        for (int i = 0; i < sent.n_ids; i++) {
            const struct wb_marker *found = NULL;
            for (int k = 0; k < frame->n_markers; k++)
                if (frame->markers[k].id == sent.ids[i] && is_measured(&frame->markers[k]))
                    found = &frame->markers[k];
            for (int k = 0; k < 3; k++) {
                if (found)
                    wb_text_append(&text, ",%.4f", 1e3 * (double)found->position[k]);
                else
                    wb_text_append(&text, ",");
            }
        }
        wb_text_append(&text, "\n");
    }
    assert_int_equal(wb_file_write_text(take_path, &text), WB_OK);
    wb_text_release(&text);
}

/* Times of the readings on the clock of the take, at a constant rate. */
static void reading_times(double *t)
{
    static double number[MOST];
    static int64_t host_ns[MOST];
    struct wb_clock_line line;
    for (int i = 0; i < sent.n_readings; i++) {
        number[i] = (double)i;
        host_ns[i] = sent.readings[i].t_ns;
    }
    assert_int_equal(
        wb_clock_fit_envelope(&line, number, host_ns, (size_t)sent.n_readings, 1.0 / 80.0, 32.0),
        WB_OK);
    for (int i = 0; i < sent.n_readings; i++)
        t[i] = wb_seconds_from_ns(wb_clock_line_host_ns(&line, number[i])) - sent.host_less_device -
               sent.frames[0].t_device;
}

/* In the format of a logger with another locale. */
static void write_force(double until)
{
    static double t[MOST];
    struct wb_text text = {0};
    reading_times(t);
    wb_text_append(&text, "Zeit (s);Kraft (mN)\r\n");
    for (int i = 0; i < sent.n_readings && t[i] <= until; i++) {
        char row[80];
        snprintf(row, sizeof row, "%.4f;%.5f\r\n", t[i] + CLOCKS, sent.readings[i].force / WB_MN);
        for (char *at = row; *at; at++)
            *at = *at == '.' ? ',' : *at;
        wb_text_append(&text, "%s", row);
    }
    assert_int_equal(wb_file_write_text(force_path, &text), WB_OK);
    wb_text_release(&text);
}

/* A C3D with a point for each id and the force as a channel, two readings per frame. */
static void write_c3d(const char *path)
{
    static double t[MOST];
    static struct example_bytes head;
    const int first = sent.frames[0].frame_number;
    const int n = sent.frames[sent.n_frames - 1].frame_number - first + 1;
    char labels[4 * MOST_IDS];
    FILE *const file = fopen(path, "wb");
    assert_non_null(file);
    for (int i = 0; i < sent.n_ids; i++)
        memcpy(labels + (size_t)4 * i,
               (char[]){'M', (char)('0' + i / 10), (char)('0' + i % 10), ' '}, 4);
    head = (struct example_bytes){.processor = 84};
    example_byte(&head, 2);
    example_byte(&head, 0x50);
    const long words[] = {sent.n_ids, 2, 1, n, 10};
    for (int i = 0; i < 5; i++)
        example_word(&head, words[i]);
    example_float(&head, -1.0);
    example_word(&head, 5);
    example_word(&head, 2);
    example_float(&head, RATE);
    example_block(&head);
    example_byte(&head, 0);
    example_byte(&head, 0);
    example_byte(&head, 3);
    example_byte(&head, head.processor);
    example_group(&head, 1, "POINT");
    example_int(&head, 1, "USED", sent.n_ids);
    example_int(&head, 1, "FRAMES", n);
    example_int(&head, 1, "DATA_START", 5);
    example_real(&head, 1, "SCALE", -1.0);
    example_real(&head, 1, "RATE", RATE);
    example_texts(&head, 1, "LABELS", labels, sent.n_ids);
    example_texts(&head, 1, "UNITS", "mm\0\0", 1);
    example_group(&head, 2, "ANALOG");
    example_int(&head, 2, "USED", 1);
    example_real(&head, 2, "GEN_SCALE", 1.0);
    example_real(&head, 2, "SCALE", 1.0);
    example_int(&head, 2, "OFFSET", 0);
    example_texts(&head, 2, "LABELS", "Fz  ", 1);
    example_texts(&head, 2, "UNITS", "mN\0\0", 1);
    while (head.n < (size_t)4 * 512)
        example_byte(&head, 0);
    assert_int_equal(fwrite(head.bytes, 1, head.n, file), head.n);
    reading_times(t);
    const struct wb_mocap_frame *frame = sent.frames;
    for (int f = 0, at = 1; f < n; f++) {
        float row[4 * MOST_IDS + 2] = {0.0f};
        for (int i = 0; i < sent.n_ids; i++)
            row[4 * i + 3] = -1.0f;
        while (frame < sent.frames + sent.n_frames && frame->frame_number - first < f)
            frame++;
        for (int k = 0; frame->frame_number - first == f && k < frame->n_markers; k++) {
            int i = 0;
            while (sent.ids[i] != frame->markers[k].id)
                i++;
            for (int j = 0; j < 3; j++)
                row[4 * i + j] = 1e3f * frame->markers[k].position[j];
            row[4 * i + 3] = is_measured(&frame->markers[k]) ? 1.0f : -1.0f;
        }
        for (int r = 0; r < 2; r++) {
            const double now = (f + 0.5 * r) / RATE;
            while (at + 1 < sent.n_readings && t[at] < now)
                at++;
            const double part = (now - t[at - 1]) / (t[at] - t[at - 1]);
            row[4 * sent.n_ids + r] = (float)(((1.0 - part) * sent.readings[at - 1].force +
                                               part * sent.readings[at].force) /
                                              WB_MN);
        }
        assert_int_equal(fwrite(row, sizeof *row, (size_t)(4 * sent.n_ids + 2), file),
                         4 * sent.n_ids + 2);
    }
    fclose(file);
}

/* --- import --- */

static struct wb_mocap_import_request request_of(void)
{
    unlink(output);
    return (struct wb_mocap_import_request){
        .take_path = take_path,
        .force_path = force_path,
        .specimen_path = specimen_path,
        .rig_path = rig_path,
        .output = output,
        .offset = (double)NAN,
        .tare = (double)NAN,
    };
}

static int start(void **state)
{
    struct wb_recording *recording;
    struct wb_rig rig;
    struct wb_replay_counts counts;
    struct wb_align_settings settings;
    const struct wb_sink sink = {.load = take_reading, .mocap = take_frame};
    keep_messages();
    if (make_folder(state) != 0)
        return -1;
    snprintf(take_path, sizeof take_path, "%s/take.csv", folder);
    snprintf(force_path, sizeof force_path, "%s/force.csv", folder);
    snprintf(output, sizeof output, "%s/r.wbr", folder);
    sent.frames = calloc(MOST, sizeof *sent.frames);
    wb_align_default_settings(&settings);
    if (!sent.frames || wb_file_find_data(original, "recordings/type1-L100-1.wbr.zst") != WB_OK ||
        wb_file_find_data(specimen_path, "fixtures/specimens/type1-L100-1.yaml") != WB_OK ||
        wb_file_find_data(rig_path, "fixtures/rigs/paper.yaml") != WB_OK ||
        wb_recording_open(&recording, original) != WB_OK ||
        wb_replay_rig(recording, &rig) != WB_OK ||
        wb_replay_run(recording, &rig, &sink, 0.0, &counts) != WB_OK ||
        wb_recording_close(recording) != WB_OK ||
        wb_align_run(&reference, original, &settings, NULL) != WB_OK)
        return -1;
    sent.host_less_device = HUGE_VAL;
    for (int i = 0; i < sent.n_frames; i++)
        sent.host_less_device =
            fmin(sent.host_less_device,
                 wb_seconds_from_ns(sent.frames[i].t_ns) - sent.frames[i].t_device);
    write_motive(0, sent.n_frames);
    write_force(1e9);
    return 0;
}

static int end(void **state)
{
    wb_dataset_release(&reference);
    free(sent.frames);
    release_messages();
    return remove_folder(state);
}

/* Force at a deflection on the first loading. */
static double force_at(const struct wb_dataset *dataset, double deflection)
{
    for (size_t i = 1; i < dataset->n_rows; i++) {
        const struct wb_row *const a = &dataset->rows[i - 1], *const b = &dataset->rows[i];
        if (a->phase == WB_PHASE_LOAD && b->deflection >= deflection && a->deflection < deflection)
            return a->force + (b->force - a->force) * (deflection - a->deflection) /
                                  (b->deflection - a->deflection);
    }
    return (double)NAN;
}

/* Residual deflection: zero force during unloading, by a line through the rows around it. */
static double residual_deflection(const struct wb_dataset *dataset)
{
    double x[200], y[200];
    struct wb_fit_line line;
    size_t n = 0;
    for (size_t i = 0; i < dataset->n_rows && n < 200; i++) {
        const struct wb_row *const row = &dataset->rows[i];
        if (row->phase != WB_PHASE_UNLOAD || fabs(row->force) > 2.0 * WB_MN)
            continue;
        x[n] = row->force;
        y[n++] = row->deflection;
    }
    assert_true(n > 50 && wb_fit_line(x, y, n, &line));
    return line.value;
}

static void align_output(struct wb_dataset *dataset)
{
    struct wb_align_settings settings;
    wb_align_default_settings(&settings);
    assert_int_equal(wb_align_run(dataset, output, &settings, NULL), WB_OK);
}

static void a_test_in_files_is_the_same_test(void **state)
{
    (void)state;
    struct wb_mocap_import result;
    struct wb_dataset dataset;
    const struct wb_mocap_import_request request = request_of();
    assert_int_equal(wb_mocap_import_run(&result, &request), WB_OK);
    assert_true(result.complete);
    assert_int_equal(result.n_frames, sent.n_frames);
    assert_int_equal(result.n_points, sent.n_ids);
    /* Seven markers, with one column each time one was found again. */
    assert_int_equal(result.n_markers, 7);
    assert_true(result.n_stitched > 15);
    assert_int_equal(result.sync.method, WB_SYNC_REVERSAL);
    assert_true(result.sync.uncertainty < 0.03);
    /* The readings have the filter's delay of 50 ms, and arrivals some ms more. */
    assert_close(result.sync.lag, -CLOCKS - 0.05, 3.0 * result.sync.uncertainty);
    assert_close(result.offset, result.sync.lag + 0.05, 1e-12);
    align_output(&dataset);
    print_message(
        "lag off by %.1f ms, stated %.1f ms; residual deflection %.2f mm, by the recording "
        "%.2f mm\n",
        1e3 * (result.sync.lag + CLOCKS + 0.05), 1e3 * result.sync.uncertainty,
        residual_deflection(&dataset) / WB_MM, residual_deflection(&reference) / WB_MM);
    for (double at = 5.0; at < 51.0; at += 5.0)
        assert_close(force_at(&dataset, at * WB_MM), force_at(&reference, at * WB_MM), 0.3 * WB_MN);
    assert_true(wb_dataset_is_complete(&dataset));
    wb_dataset_release(&dataset);
}

static void a_given_lag_and_tare_are_used(void **state)
{
    (void)state;
    struct wb_mocap_import result;
    struct wb_mocap_import_request request = request_of();
    request.offset = -CLOCKS;
    request.tare = -1.9 * WB_MN;
    assert_int_equal(wb_mocap_import_run(&result, &request), WB_OK);
    assert_int_equal(result.sync.method, WB_SYNC_GIVEN);
    assert_close(result.offset, -CLOCKS, 0.0);
    struct wb_dataset dataset;
    align_output(&dataset);
    assert_close(force_at(&dataset, 30.0 * WB_MM), force_at(&reference, 30.0 * WB_MM), 0.3 * WB_MN);
    wb_dataset_release(&dataset);
}

struct counted {
    size_t n_frames, n_readings;
    double last_force;
    int64_t last_ns;
};

static void count_frame(void *context, const struct wb_mocap_frame *frame)
{
    struct counted *const counted = context;
    counted->n_frames++;
    counted->last_ns = frame->t_ns;
}

static void count_reading(void *context, const struct wb_load_sample *sample)
{
    struct counted *const counted = context;
    counted->n_readings++;
    counted->last_force = sample->force;
}

static void replay_output(struct counted *counted, struct wb_replay_counts *counts)
{
    struct wb_recording *recording;
    struct wb_rig rig;
    const struct wb_sink sink = {.context = counted, .load = count_reading, .mocap = count_frame};
    *counted = (struct counted){0};
    assert_int_equal(wb_recording_open(&recording, output), WB_OK);
    assert_int_equal(wb_replay_rig(recording, &rig), WB_OK);
    assert_int_equal(wb_replay_run(recording, &rig, &sink, 0.0, counts), WB_OK);
    assert_int_equal(wb_recording_close(recording), WB_OK);
}

/* Samples come from the files' bytes in the recording; the files themselves were deleted. */
static void a_replay_reads_the_files_in_the_recording(void **state)
{
    (void)state;
    struct wb_mocap_import result;
    struct counted counted;
    struct wb_replay_counts counts;
    const struct wb_mocap_import_request request = request_of();
    assert_int_equal(wb_mocap_import_run(&result, &request), WB_OK);
    unlink(take_path);
    unlink(force_path);
    replay_output(&counted, &counts);
    assert_int_equal(counted.n_frames, sent.n_frames);
    assert_int_equal(counted.n_readings, sent.n_readings);
    assert_close(counted.last_force, sent.readings[sent.n_readings - 1].force, 1e-8);
    assert_int_equal(counted.last_ns, (int64_t)llround(frame_time(sent.n_frames - 1) * 1e9));
    assert_int_equal(counts.damaged_chunks, 0);
    write_motive(0, sent.n_frames);
    write_force(1e9);
}

/* Overwrites bytes in the middle of the recording, within a page of the database. */
static void a_damaged_block_is_reported_and_loses_its_file(void **state)
{
    (void)state;
    struct wb_mocap_import result;
    struct counted counted;
    struct wb_replay_counts counts;
    const struct wb_mocap_import_request request = request_of();
    assert_int_equal(wb_mocap_import_run(&result, &request), WB_OK);
    FILE *const file = fopen(output, "r+b");
    assert_non_null(file);
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    const long size = ftell(file);
    assert_int_equal(fseek(file, (size / 2 & ~4095L) + 1000, SEEK_SET), 0);
    for (int i = 0; i < 64; i++)
        fputc(0x5a, file);
    fclose(file);
    replay_output(&counted, &counts);
    assert_true(counts.damaged_chunks > 0);
    assert_true(counted.n_frames == 0 || counted.n_readings == 0);
    assert_message("cannot be read: a piece of it is damaged");
}

static void a_ramp_without_an_event_is_rejected(void **state)
{
    (void)state;
    struct wb_mocap_import result;
    /* The motion goes up until 56 s: neither file has a reversal. */
    write_motive(0, (int)(50.0 * RATE));
    write_force(50.0);
    const struct wb_mocap_import_request request = request_of();
    assert_int_equal(wb_mocap_import_run(&result, &request), WB_ERR_DATA);
    assert_message("not identifiable");
    assert_message("--offset-s");
    assert_int_not_equal(access(output, F_OK), 0);
    write_motive(0, sent.n_frames);
    write_force(1e9);
}

static void without_a_rest_there_is_no_tare(void **state)
{
    (void)state;
    struct wb_mocap_import result;
    write_motive((int)(10.0 * RATE), sent.n_frames);
    const struct wb_mocap_import_request request = request_of();
    struct wb_mocap_import_request given = request;
    given.offset = -CLOCKS;
    given.tare = (double)NAN;
    /* The force file begins earlier and is cut as well. */
    assert_int_equal(wb_mocap_import_run(&result, &given), WB_OK);
    assert_true(result.motion_start > 9.9);
    unlink(output);
    struct wb_text text = {0};
    wb_text_append(&text, "t (s),F (mN)\n%.3f,1\n%.3f,2\n%.3f,3\n", CLOCKS + 20.0, CLOCKS + 21.0,
                   CLOCKS + 22.0);
    assert_int_equal(wb_file_write_text(force_path, &text), WB_OK);
    wb_text_release(&text);
    assert_int_equal(wb_mocap_import_run(&result, &given), WB_ERR_DATA);
    assert_message("--tare-mN");
    write_motive(0, sent.n_frames);
    write_force(1e9);
}

static void omitted_rows_are_counted_and_make_the_dataset_incomplete(void **state)
{
    (void)state;
    struct wb_mocap_import result;
    char *text;
    size_t size;
    assert_int_equal(wb_file_read(take_path, &text, &size), WB_OK);
    /* A file that was truncated in its last tenth. */
    assert_int_equal(wb_file_write(take_path, text, size - size / 50), WB_OK);
    free(text);
    const struct wb_mocap_import_request request = request_of();
    assert_int_equal(wb_mocap_import_run(&result, &request), WB_OK);
    assert_false(result.complete);
    assert_int_equal(result.skipped_rows, 1);
    assert_int_equal(result.missing_frames + 1 + result.n_frames, sent.n_frames);
    struct wb_dataset dataset;
    align_output(&dataset);
    assert_false(wb_dataset_is_complete(&dataset));
    wb_dataset_release(&dataset);
    write_motive(0, sent.n_frames);
}

static void an_existing_recording_is_not_overwritten(void **state)
{
    (void)state;
    struct wb_mocap_import result;
    const struct wb_mocap_import_request request = request_of();
    assert_int_equal(wb_file_write(output, "x", 1), WB_OK);
    assert_int_equal(wb_mocap_import_run(&result, &request), WB_ERR_EXISTS);
}

static void rigid_bodies_alone_are_rejected(void **state)
{
    (void)state;
    struct wb_mocap_import result;
    static const char text[] = "Format Version,1.23,Length Units,Meters,Export Frame Rate,120\n"
                               ",Type,Rigid Body,Rigid Body,Rigid Body\n,Name,R,R,R\n,ID,1,1,1\n"
                               ",,Position,Position,Position\nFrame,Time (Seconds),X,Y,Z\n"
                               "0,0,1,2,3\n1,0.008,1,2,3\n";
    assert_int_equal(wb_file_write(take_path, text, strlen(text)), WB_OK);
    const struct wb_mocap_import_request request = request_of();
    assert_int_equal(wb_mocap_import_run(&result, &request), WB_ERR_DATA);
    assert_message("rigid bodies only");
    write_motive(0, sent.n_frames);
}

/* Nothing marks the beginning of the test in a take with its own force: it is found early enough
 * that the zero of the force is that of the recording. */
static void a_take_with_its_force_in_it_is_the_same_test(void **state)
{
    (void)state;
    struct wb_mocap_import result;
    struct wb_dataset dataset;
    char path[80];
    snprintf(path, sizeof path, "%s/take.c3d", folder);
    write_c3d(path);
    struct wb_mocap_import_request request = request_of();
    request.take_path = path;
    request.force_path = NULL;
    assert_int_equal(wb_mocap_import_run(&result, &request), WB_OK);
    assert_int_equal(result.sync.method, WB_SYNC_SAME);
    assert_string_equal(result.channel, "Fz");
    align_output(&dataset);
    print_message("residual deflection %.2f mm, by the recording %.2f\n",
                  residual_deflection(&dataset) / WB_MM, residual_deflection(&reference) / WB_MM);
    assert_close(residual_deflection(&dataset), residual_deflection(&reference), 0.05 * WB_MM);
    for (size_t i = 0; i < 12; i++)
        assert_true(dataset.rows[i].force < force_at(&reference, 5.0 * WB_MM) - 20.0 * WB_MN);
    for (double at = 5.0; at < 51.0; at += 5.0)
        assert_close(force_at(&dataset, at * WB_MM), force_at(&reference, at * WB_MM), 0.3 * WB_MN);
    wb_dataset_release(&dataset);
    unlink(path);
}

/* The force of a C3D is one of its channels, on the same clock. */
static void a_channel_of_a_take_is_its_force(void **state)
{
    (void)state;
    static struct example_bytes bytes;
    struct wb_foreign foreign = {.name = "a.c3d"};
    struct wb_force_table force;
    struct wb_take take;
    struct wb_rig rig = {.gravity = 9.80665};
    const struct example_c3d form = {.processor = 85};
    rig.load_cell.sign = -1;
    example_c3d(&bytes, &form, 10);
    assert_int_equal(wb_take_read(&take, "a.c3d", bytes.bytes, bytes.n, NULL, NULL), WB_OK);
    assert_int_equal(wb_foreign_channel(&foreign, &take, &rig, &force, NULL), WB_OK);
    assert_string_equal(foreign.channel, "Fz");
    assert_int_equal(force.n, 20);
    for (int i = 0; i < 20; i++) {
        assert_close(force.t[i], 0.01 + 0.005 * i, 1e-12);
        assert_close(force.force[i], -0.25 * i, 1e-5);
    }
    wb_force_table_release(&force);
    snprintf(foreign.channel, sizeof foreign.channel, "Fx");
    assert_int_equal(wb_foreign_channel(&foreign, &take, &rig, &force, NULL), WB_ERR_DATA);
    assert_message("Fz (N)");
    wb_take_release(&take);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_test_in_files_is_the_same_test),
        cmocka_unit_test(a_given_lag_and_tare_are_used),
        cmocka_unit_test(a_replay_reads_the_files_in_the_recording),
        cmocka_unit_test(a_damaged_block_is_reported_and_loses_its_file),
        cmocka_unit_test(a_ramp_without_an_event_is_rejected),
        cmocka_unit_test(without_a_rest_there_is_no_tare),
        cmocka_unit_test(omitted_rows_are_counted_and_make_the_dataset_incomplete),
        cmocka_unit_test(an_existing_recording_is_not_overwritten),
        cmocka_unit_test(rigid_bodies_alone_are_rejected),
        cmocka_unit_test(a_take_with_its_force_in_it_is_the_same_test),
        cmocka_unit_test(a_channel_of_a_take_is_its_force),
    };
    return cmocka_run_group_tests(tests, start, end);
}
