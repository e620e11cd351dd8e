/* Decodes a recording's bytes, meta data and events, and puts them on the bench's clock: seconds
 * since the start of the first cycle, host time times the rig's time scale. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/align/align_private.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/number.h"
#include "base/units.h"
#include "daq/protocol/loss.h"
#include "daq/recording/foreign.h"
#include "daq/recording/index.h"
#include "daq/recording/recording_foreign.h"
#include "daq/recording/recover.h"
#include "daq/test/check_log.h"

#define WB_LOG_DOMAIN "align"

/* A device clock that jumps by more than this, s of host time, was restarted. */
#define JUMP 0.5
/* Stamps over a shorter span, s of device time, do not determine the clock's skew. */
#define LEAST_SPAN 5.0

void wb_align_list_add(struct wb_align_list *list, const void *item, size_t size)
{
    list->items = wb_memory_room(list->items, &list->capacity, list->n + 1, size);
    memcpy((char *)list->items + list->n++ * size, item, size);
}

/* --- samples --- */

static void take_load(void *context, const struct wb_load_sample *sample)
{
    struct wb_align *const align = context;
    const struct wb_align_reading reading = {
        .t_ns = sample->t_ns,
        .force = sample->valid ? sample->force : (double)NAN,
    };
    align->n_invalid += !sample->valid;
    wb_align_list_add(&align->readings, &reading, sizeof reading);
}

static void take_mocap(void *context, const struct wb_mocap_frame *frame)
{
    struct wb_align *const align = context;
    wb_point_cloud_add(&align->cloud, frame);
}

static void take_stage(void *context, const struct wb_stage_report *report)
{
    struct wb_align *const align = context;
    if (!isfinite(report->position))
        return;
    const struct wb_align_report_point point = {
        .t_ns = report->t_ns,
        .travel = align->rig.stage.down * report->position,
    };
    wb_align_list_add(&align->reports, &point, sizeof point);
}

static void take_probe(void *context, const struct wb_clock_probe *probe)
{
    struct wb_align *const align = context;
    wb_align_list_add(&align->probes, probe, sizeof *probe);
}

static enum wb_status decode(struct wb_align *align, struct wb_recording *recording)
{
    const struct wb_sink sink = {
        .context = align,
        .load = take_load,
        .mocap = take_mocap,
        .stage = take_stage,
        .probe = take_probe,
    };
    const enum wb_status status = wb_replay_run(recording, &align->rig, &sink, 0.0, &align->counts);
    /* What was read before the damaged place can still be used. */
    if (status == WB_ERR_DATA) {
        if (wb_recording_is_complete(recording))
            wb_align_warn(align, "the recording breaks off; its readable part is used");
        align->is_cut_short = true;
    } else if (status != WB_OK) {
        return status;
    }
    if (align->readings.n == 0)
        return wb_fail_to(align->why, WB_ERR_DATA,
                          "%s: the recording has no reading of a load cell", align->name);
    if (align->cloud.n_frames == 0)
        return wb_fail_to(align->why, WB_ERR_DATA,
                          "%s: the recording has no frame of motion capture", align->name);
    if (align->counts.damaged_chunks > 0) {
        align->is_cut_short = true;
        wb_align_warn(align, "%llu of %llu chunks %s damaged and left out",
                      (unsigned long long)align->counts.damaged_chunks,
                      (unsigned long long)align->counts.chunks,
                      align->counts.damaged_chunks == 1 ? "is" : "are");
    }
    return WB_OK;
}

/* --- losses --- */

static void note_loss(struct wb_align *align, struct wb_json *losses, const char *what,
                      const struct wb_loss *loss)
{
    const struct wb_loss_counts counts = wb_loss_counts(loss);
    struct wb_json *const object = wb_json_set_object(losses, what);
    wb_json_set_integer(object, "received", (int64_t)counts.received);
    wb_json_set_integer(object, "missing", (int64_t)counts.missing);
    wb_json_set_integer(object, "gaps", (int64_t)counts.gaps);
    wb_json_set_integer(object, "repeated", (int64_t)counts.repeated);
    wb_json_set_integer(object, "overtaken", (int64_t)counts.overtaken);
    wb_align_set(object, "longest_gap_s", counts.longest_gap);
    if (wb_loss_is_significant(loss))
        wb_align_warn(
            align, "%.2g %% of the %s never came: %llu in %llu place%s, the longest of %.3g s",
            wb_loss_share(&counts) / WB_PERCENT, what, (unsigned long long)counts.missing,
            (unsigned long long)counts.gaps, counts.gaps == 1 ? "" : "s", counts.longest_gap);
}

/* Called before frames are sorted and readings are mapped to a line. */
static void note_losses(struct wb_align *align)
{
    const struct wb_align_reading *const items = align->readings.items;
    struct wb_loss frames, readings;
    wb_loss_init(&frames, true, 0.0);
    for (size_t i = 0; i < align->cloud.n_frames; i++)
        wb_loss_add(&frames, align->cloud.frames[i].t_device);
    wb_loss_init(&readings, false, 0.0);
    for (size_t i = 0; i < align->readings.n; i++)
        wb_loss_add(&readings, wb_seconds_from_ns(items[i].t_ns));
    struct wb_json *const losses = wb_json_set_object(align->checks, "losses");
    note_loss(align, losses, "frames", &frames);
    note_loss(align, losses, "readings", &readings);
    align->is_losing_readings = wb_loss_is_significant(&readings);
}

/* The probes of imported recordings may be in the clock table only. */
static enum wb_status take_clock_row(void *context, const struct wb_clock_row *row)
{
    struct wb_align *const align = context;
    const struct wb_clock_probe probe = {
        .t_sent_ns = row->t_host_ns - row->rtt_ns / 2,
        .t_received_ns = row->t_host_ns + row->rtt_ns / 2,
        .t_device = row->t_device,
    };
    take_probe(align, &probe);
    return WB_OK;
}

/* --- events --- */

static enum wb_status take_tare(struct wb_align *align, const struct wb_event *event)
{
    struct wb_json *json;
    char origin[192];
    snprintf(origin, sizeof origin, "%s: event tare", align->name);
    WB_TRY(wb_json_parse_with_reason(&json, event->text, origin, align->why));
    int64_t samples = 0;
    align->tare_deviation = (double)NAN;
    align->has_tare = wb_json_get_number(json, "force_N", &align->tare);
    (void)wb_json_get_number(json, "sd_N", &align->tare_deviation);
    (void)wb_json_get_integer(json, "samples", &samples);
    wb_json_destroy(json);
    if (!align->has_tare)
        return wb_fail_to(align->why, WB_ERR_DATA, "%s: no number force_N", origin);
    align->tare_samples = samples > 1 && samples < 100000000 ? (long)samples : 1;
    align->tare_ns = event->t_ns;
    return WB_OK;
}

static void take_hold(struct wb_align *align, const struct wb_event *event)
{
    const bool begins = strcmp(event->kind, WB_BEND_HOLD_START) == 0;
    struct wb_bend_hold_recorded hold;
    const bool skipped = align->skips_hold;
    align->skips_hold = begins && align->n_holds == WB_ALIGN_MAX_HOLDS;
    if (align->skips_hold) {
        wb_align_warn(
            align,
            "the test was held more than %d times: the rows of later holds are treated as motion",
            WB_ALIGN_MAX_HOLDS);
        return;
    }
    if (!begins && (align->n_holds == 0 || skipped))
        return;
    if (!begins)
        hold = align->holds[align->n_holds - 1];
    if (wb_bend_hold_read(event, &hold) != WB_OK) {
        wb_align_warn(align, "invalid event %s: '%.100s'", event->kind, event->text);
        return;
    }
    align->n_holds += begins;
    align->holds[align->n_holds - 1] = hold;
}

static enum wb_status take_event(void *context, const struct wb_event *event)
{
    struct wb_align *const align = context;
    if (strcmp(event->kind, "tare") == 0 && !align->has_start)
        return take_tare(align, event);
    if (strcmp(event->kind, "cycle_start") == 0) {
        if (!align->has_start)
            align->start_ns = event->t_ns;
        align->has_start = true;
        align->n_cycle_starts++;
    } else if (strcmp(event->kind, "stop") == 0) {
        snprintf(align->stop_reason, sizeof align->stop_reason, "%.383s", event->text);
        if (strcmp(event->text, "done") != 0)
            align->is_cut_short = true;
    } else if (strcmp(event->kind, WB_BEND_HOLD_START) == 0 ||
               strcmp(event->kind, WB_BEND_HOLD_END) == 0) {
        take_hold(align, event);
    } else if (strcmp(event->kind, "stream_lost") == 0) {
        align->n_lost++;
    } else if (strcmp(event->kind, "drop") == 0) {
        align->n_drops++;
    } else if (strcmp(event->kind, "stall") == 0 || strcmp(event->kind, "reconnected") == 0) {
        wb_align_warn(align, "%.200s", event->text);
    }
    return WB_OK;
}

static enum wb_status load_events(struct wb_align *align, struct wb_recording *recording)
{
    const enum wb_status status = wb_recording_each_event(recording, take_event, align);
    if (status == WB_ERR_DATA && align->has_tare)
        align->is_cut_short = true;
    else
        WB_TRY(status);
    if (!align->has_tare)
        return wb_fail_to(
            align->why, WB_ERR_DATA,
            "%s: no tare in the recording: without the load cell's zero there is no force",
            align->name);
    /* From here on `tare` is the reading of the unloaded cell. */
    align->tare -= wb_rig_tare_load(&align->rig);
    if (align->is_cut_short)
        wb_align_warn(align, "the test was cut short%s%s", align->stop_reason[0] ? ": " : "",
                      align->stop_reason);
    if (align->n_lost + align->n_drops > 0)
        wb_align_warn(align,
                      "while recording, streams were lost %u times and data dropped %u "
                      "times: the dataset has gaps there",
                      align->n_lost, align->n_drops);
    return WB_OK;
}

/* --- meta --- */

static enum wb_status load_rig_and_specimen(struct wb_align *align, struct wb_recording *recording)
{
    char *text, origin[WB_PATH];
    WB_TRY(wb_align_given_text(align, recording, "rig", align->settings.rig_path, &text, origin));
    enum wb_status status = wb_rig_parse(text, origin, &align->rig, align->why);
    free(text);
    WB_TRY(status);
    WB_TRY(wb_align_given_text(align, recording, "specimen", align->settings.specimen_path, &text,
                               origin));
    status = wb_specimen_parse(text, origin, &align->specimen, align->why);
    free(text);
    return status;
}

/* Whether the specimen is of the recorded wire; where a specimen file was given, by the wire's
 * name. */
static enum wb_status is_recorded_wire(const struct wb_align *align, struct wb_recording *recording,
                                       bool *is_it)
{
    struct wb_specimen recorded;
    char *text, origin[WB_PATH];
    *is_it = true;
    if (!align->settings.specimen_path)
        return WB_OK;
    WB_TRY(wb_align_given_text(align, recording, "specimen", NULL, &text, origin));
    const enum wb_status status = wb_specimen_parse(text, origin, &recorded, align->why);
    free(text);
    *is_it = status == WB_OK && strcmp(recorded.wire, align->specimen.wire) == 0;
    return status;
}

/* The wire's file as recorded with the test; for recordings without it, the current file of that
 * name. */
static enum wb_status load_wire(struct wb_align *align, struct wb_recording *recording)
{
    char *text, origin[192], path[WB_PATH];
    bool is_recorded;
    WB_TRY(is_recorded_wire(align, recording, &is_recorded));
    const enum wb_status found =
        is_recorded ? wb_recording_meta(recording, "wire", &text) : WB_ERR_NOT_FOUND;
    if (found == WB_OK) {
        snprintf(origin, sizeof origin, "%s: wire", align->name);
        const enum wb_status status = wb_wire_parse(text, origin, &align->wire, align->why);
        free(text);
        return status;
    }
    if (found != WB_ERR_NOT_FOUND)
        return found;
    char named_in[WB_PATH + 32], folder[WB_PATH];
    const char *const given = align->settings.specimen_path;
    if (given) {
        wb_file_folder(folder, given);
        snprintf(named_in, sizeof named_in, "%s:%d: wire", given, align->specimen.wire_line);
    }
    WB_TRY(wb_file_find_named(path, "wires", align->specimen.wire, given ? folder : NULL,
                              given ? named_in : NULL, align->why));
    return wb_wire_read(path, &align->wire, align->why);
}

/* Copies a meta text into the recording's entry; absent is left out. */
static void copy_meta(struct wb_recording *recording, struct wb_json *entry, const char *key,
                      const char *as)
{
    char *text;
    if (wb_recording_meta(recording, key, &text) == WB_OK) {
        wb_json_set_text(entry, as, text);
        free(text);
    }
}

static void load_gravity(struct wb_align *align, struct wb_recording *recording)
{
    char *text;
    align->gravity = align->rig.gravity;
    if (align->settings.rig_path)
        return;
    if (wb_recording_meta(recording, "g", &text) == WB_OK) {
        if (!wb_number_parse(text, &align->gravity))
            wb_align_warn(align, "meta 'g' is not a number; gravity is taken from the rig file");
        free(text);
    }
}

/* The error of a cell that passed its check is uniformly distributed within the tolerance (JCGM
 * 100:2008, 4.3.7). */
static void load_check(struct wb_align *align, struct wb_recording *recording)
{
    struct wb_check_log_entry check;
    char *text;
    if (wb_recording_meta(recording, "load_cell_check", &text) != WB_OK)
        return;
    if (wb_check_log_parse(text, &check) && check.passed &&
        strcmp(check.serial_number, align->rig.load_cell.serial_number) == 0)
        align->checked_gain = check.tolerance / sqrt(3.0);
    free(text);
}

static bool says_virtual(struct wb_recording *recording)
{
    char *text;
    if (wb_recording_meta(recording, "virtual", &text) != WB_OK)
        return false;
    const bool is_virtual = strcmp(text, "true") == 0;
    free(text);
    return is_virtual;
}

/* Finds the streams made from another program's file: their samples carry the file's own times. */
static enum wb_status look_at_files(struct wb_align *align, struct wb_recording *recording)
{
    align->import_uncertainty = (double)NAN;
    for (int i = 0; i < wb_recording_n_streams(recording); i++) {
        const struct wb_recording_stream *const stream = wb_recording_stream_at(recording, i);
        struct wb_foreign foreign;
        if (!wb_recording_foreign_is(stream))
            continue;
        WB_TRY(wb_foreign_parse(&foreign, wb_recording_stream_settings(recording, i), align->why));
        align->camera_times_given |= stream->role == WB_ROLE_MOCAP;
        align->load_times_given |= stream->role == WB_ROLE_LOAD || foreign.channel[0] != '\0';
        if (stream->role == WB_ROLE_LOAD)
            align->import_uncertainty = foreign.uncertainty;
    }
    return WB_OK;
}

/* Copies the results of the import into the dataset. */
static void copy_import(struct wb_align *align, struct wb_recording *recording)
{
    struct wb_json *json;
    char *text;
    if (wb_recording_meta(recording, "import", &text) != WB_OK)
        return;
    struct wb_reason why = {.text = ""};
    if (wb_json_parse_with_reason(&json, text, "import", &why) == WB_OK) {
        wb_json_set_copy(align->checks, "import", json);
        wb_json_destroy(json);
    }
    free(text);
}

/* Warns of what `wirebench recover` could not restore. */
static void note_recovery(struct wb_align *align, struct wb_recording *recording)
{
    char *missing;
    if (wb_recording_meta(recording, WB_RECOVER_META_MISSING, &missing) != WB_OK)
        return;
    if (*missing) {
        align->is_cut_short = true;
        wb_align_warn(align, "the recording was recovered from a damaged file; missing: %s",
                      missing);
    }
    free(missing);
}

/* The index beside the recording says whether the test was excluded later. */
static void note_exclusion(struct wb_align *align, const char *path, struct wb_json *recording)
{
    struct wb_index_entry entry;
    struct wb_reason why = {.text = ""};
    char text[WB_INDEX_EXCLUSION_TEXT];
    const bool is_listed = wb_index_look_up(&entry, path, align->sha256, &why);
    if (why.text[0])
        wb_align_warn(align, "cannot read whether the test was excluded: %s", why.text);
    if (!is_listed || !entry.excluded.is_excluded)
        return;
    wb_index_exclusion_set_json(&entry.excluded, recording);
    wb_index_exclusion_describe(&entry.excluded, text);
    wb_align_warn(align, "the test was excluded %s", text);
}

static enum wb_status load_all(struct wb_align *align, struct wb_recording *recording,
                               const char *path)
{
    WB_TRY(load_rig_and_specimen(align, recording));
    WB_TRY(load_wire(align, recording));
    align->is_virtual = align->rig.is_virtual || says_virtual(recording);
    align->gravity = align->rig.gravity;
    wb_align_describe(align);
    load_gravity(align, recording);
    load_check(align, recording);
    struct wb_json *const list = wb_json_set_array(align->dataset->document, "recordings");
    struct wb_json *const entry = wb_json_append_object(list);
    wb_json_set_text(entry, "name", align->name);
    wb_json_set_text(entry, "sha256", align->sha256);
    copy_meta(recording, entry, "start_utc", "start_utc");
    copy_meta(recording, entry, "operator", "operator");
    copy_meta(recording, entry, "notes", "notes");
    copy_meta(recording, entry, "tool_version", "recorded_with_version");
    copy_meta(recording, entry, "tool_revision", "recorded_with_revision");
    note_exclusion(align, path, entry);
    WB_TRY(wb_align_given_describe(align, recording, entry));
    WB_TRY(look_at_files(align, recording));
    copy_import(align, recording);
    WB_TRY(load_events(align, recording));
    if (!wb_recording_is_complete(recording) && !align->is_cut_short) {
        align->is_cut_short = true;
        wb_align_warn(align, "the recording was not closed or is not all there: its end is "
                             "missing");
    }
    note_recovery(align, recording);
    WB_TRY(decode(align, recording));
    note_losses(align);
    if (align->settings.rig_path)
        WB_TRY(wb_align_given_tare(align));
    if (align->probes.n == 0)
        WB_TRY(wb_recording_each_clock(recording, take_clock_row, align));
    return WB_OK;
}

enum wb_status wb_align_load(struct wb_align *align, const void *context)
{
    const char *const path = context;
    struct wb_recording *recording;
    snprintf(align->name, sizeof align->name, "%.120s", wb_file_name(path));
    WB_TRY(wb_recording_open_with_reason(&recording, path, align->lost));
    wb_recording_warn_cut_short(recording);
    enum wb_status status = wb_recording_hash(recording, align->sha256);
    if (status == WB_OK)
        status = load_all(align, recording, path);
    const enum wb_status closed = wb_recording_close(recording);
    return status != WB_OK ? status : closed;
}

/* --- the bench's clock --- */

double wb_align_bench_time(const struct wb_align *align, int64_t host_ns)
{
    return wb_seconds_from_ns(host_ns - align->zero_ns) * align->rig.time_scale;
}

double wb_align_reading_period(const struct wb_align *align)
{
    const struct wb_align_reading *const r = align->readings.items;
    const size_t n = align->readings.n;
    return n > 1 && r[n - 1].t > r[0].t ? (r[n - 1].t - r[0].t) / (double)(n - 1) : 1.0;
}

/* --- the cameras --- */

/* The stamp of a frame that is used: the one on the probes' clock if there are probes, else the
 * capture stamp. */
static double stamp_of(const struct wb_point_frame *frame, bool on_probe_clock)
{
    return on_probe_clock ? frame->t_clock : frame->t_device;
}

static bool choose_stamp(const struct wb_align *align, bool *on_probe_clock)
{
    size_t n_clock = 0, n_device = 0;
    for (size_t i = 0; i < align->cloud.n_frames; i++) {
        n_clock += isfinite(align->cloud.frames[i].t_clock);
        n_device += isfinite(align->cloud.frames[i].t_device);
    }
    *on_probe_clock = align->probes.n > 0 && 2 * n_clock > align->cloud.n_frames;
    return *on_probe_clock || 2 * n_device > align->cloud.n_frames;
}

/* Sorts overtaken frames, and drops repeated ones and those without a stamp. A jump back by more
 * than JUMP is a restart: frames after it keep their place. */
static size_t order_frames(struct wb_align *align, bool on_probe_clock)
{
    struct wb_point_frame *const frames = align->cloud.frames;
    const double back = JUMP * align->rig.time_scale;
    size_t n = 0;
    for (size_t i = 0; i < align->cloud.n_frames; i++) {
        const struct wb_point_frame frame = frames[i];
        const double stamp = stamp_of(&frame, on_probe_clock);
        if (!isfinite(stamp))
            continue;
        const double last = n > 0 ? stamp_of(&frames[n - 1], on_probe_clock) : -HUGE_VAL;
        size_t place = n;
        if (stamp > last - back) {
            while (place > 0 && stamp_of(&frames[place - 1], on_probe_clock) > stamp &&
                   stamp_of(&frames[place - 1], on_probe_clock) < stamp + back)
                place--;
        }
        if (place > 0 && stamp_of(&frames[place - 1], on_probe_clock) == stamp)
            continue;
        memmove(frames + place + 1, frames + place, (n - place) * sizeof *frames);
        frames[place] = frame;
        n++;
    }
    const size_t dropped = align->cloud.n_frames - n;
    align->cloud.n_frames = n;
    return dropped;
}

/* Uses the host's times of the frames: those of the file from which they were imported, or their
 * arrivals. */
static void use_host_times(struct wb_align *align)
{
    for (size_t i = 0; i < align->cloud.n_frames; i++)
        align->frame_t[i] = wb_align_bench_time(align, align->cloud.frames[i].t_ns);
    if (align->camera_times_given) {
        align->method = "times of the file";
        align->camera_uncertainty = align->import_uncertainty * align->rig.time_scale;
        return;
    }
    align->method = "arrival";
    align->camera_uncertainty = (double)NAN;
    wb_align_warn(align, "frames carry no stamp of the server: their arrival times are used, with "
                         "the network's jitter");
}

/* Fits a line to the frames first..last-1, through the probes of that time if there are any. No
 * message on failure. */
static enum wb_status fit_segment(const struct wb_align *align,
                                  const struct wb_clock_stamps *stamps, bool on_probe_clock,
                                  size_t first, size_t last, struct wb_clock_line *line)
{
    if (on_probe_clock) {
        /* Probes answered by the same run of the server: those between these stamps, with a
         * margin. */
        const struct wb_clock_probe *const all = align->probes.items;
        struct wb_clock_probe *const used = wb_memory_new(align->probes.n, sizeof *used);
        size_t n = 0;
        const double margin = 10.0 * align->rig.time_scale;
        for (size_t i = 0; i < align->probes.n; i++) {
            if (all[i].t_device >= stamps->device[first] - margin &&
                all[i].t_device <= stamps->device[last - 1] + margin)
                used[n++] = all[i];
        }
        const enum wb_status status = wb_clock_fit_probes(line, used, n, stamps->nominal_slope);
        free(used);
        if (status != WB_ERR_DATA)
            return status;
    }
    return wb_clock_fit_envelope(line, stamps->device + first, stamps->host_ns + first,
                                 last - first, stamps->nominal_slope, LEAST_SPAN);
}

/* Describes a segment of n_frames frames and `span` seconds of the server's clock. */
static void describe_segment(struct wb_align *align, struct wb_json *list, size_t n_frames,
                             double span, const struct wb_clock_line *line)
{
    const bool probed = isfinite(line->uncertainty);
    struct wb_json *const entry = wb_json_append_object(list);
    wb_json_set_text(entry, "method", probed ? "echo probes" : "lower envelope");
    wb_json_set_integer(entry, "frames", (int64_t)n_frames);
    wb_json_set_integer(entry, "points", (int64_t)line->n_points);
    wb_json_set_integer(entry, "points_used", (int64_t)line->n_used);
    wb_json_set_number(entry, "offset_s",
                       round((wb_seconds_from_ns(line->host_zero_ns) - line->device_zero) * 1e6) /
                           1e6);
    wb_json_set_number(entry, "span_s", round(span * 1e3) / 1e3);
    wb_align_set(entry, "skew_ppm", (line->slope * align->rig.time_scale - 1.0) / WB_PPM);
    wb_align_set(entry, "skew_uncertainty_ppm",
                 line->slope_uncertainty * align->rig.time_scale / WB_PPM);
    wb_align_set(entry, "scatter_ms", line->scatter * 1e3);
    wb_align_set(entry, "uncertainty_ms", line->uncertainty * 1e3);
    if (!probed)
        wb_json_set_text(entry, "note",
                         "includes the shortest network latency, an unknown constant");
}

static enum wb_status map_segments(struct wb_align *align, const struct wb_clock_stamps *stamps,
                                   bool on_probe_clock)
{
    size_t starts[WB_ALIGN_MAX_SEGMENTS];
    const size_t n_segments = wb_clock_split(stamps, JUMP, starts, WB_ALIGN_MAX_SEGMENTS);
    struct wb_json *const list = wb_json_set_array(align->checks, "camera_clock");
    align->camera_uncertainty = 0.0;
    align->method = on_probe_clock ? "echo probes" : "lower envelope";
    for (size_t i = 0; i < n_segments; i++) {
        const size_t first = starts[i], last = i + 1 < n_segments ? starts[i + 1] : stamps->n;
        struct wb_clock_line line;
        const enum wb_status status =
            fit_segment(align, stamps, on_probe_clock, first, last, &line);
        if (status != WB_OK)
            return wb_fail_to(align->why, status, "out of memory for %zu stamps", last - first);
        for (size_t k = first; k < last; k++)
            align->frame_t[k] =
                wb_align_bench_time(align, wb_clock_line_host_ns(&line, stamps->device[k]));
        describe_segment(align, list, last - first,
                         stamps->device[last - 1] - stamps->device[first], &line);
        const double uncertainty = line.uncertainty * align->rig.time_scale;
        if (!(uncertainty <= align->camera_uncertainty))
            align->camera_uncertainty = uncertainty;
    }
    if (n_segments > 1)
        wb_align_warn(align,
                      "the motion-capture server's clock broke %zu time%s (set or restarted): each "
                      "stretch was mapped separately",
                      n_segments - 1, n_segments == 2 ? "" : "s");
    return WB_OK;
}

/* Drops frames whose time does not ascend across segments. */
static void drop_backward(struct wb_align *align)
{
    struct wb_point_frame *const frames = align->cloud.frames;
    size_t n = 0;
    for (size_t i = 0; i < align->cloud.n_frames; i++) {
        if (n > 0 && !(align->frame_t[i] > align->frame_t[n - 1]))
            continue;
        align->frame_t[n] = align->frame_t[i];
        frames[n++] = frames[i];
    }
    align->cloud.n_frames = n;
}

static enum wb_status map_cameras(struct wb_align *align)
{
    bool on_probe_clock;
    const bool has_stamps = choose_stamp(align, &on_probe_clock);
    size_t n_dropped = 0;
    if (has_stamps)
        n_dropped = order_frames(align, on_probe_clock);
    const size_t n = align->cloud.n_frames;
    double *const device = wb_memory_new(n, sizeof *device);
    int64_t *const host_ns = wb_memory_new(n, sizeof *host_ns);
    align->frame_t = wb_memory_new(n, sizeof *align->frame_t);
    enum wb_status status = WB_OK;
    if (align->camera_times_given || !has_stamps) {
        use_host_times(align);
    } else {
        for (size_t i = 0; i < n; i++) {
            device[i] = stamp_of(&align->cloud.frames[i], on_probe_clock);
            host_ns[i] = align->cloud.frames[i].t_ns;
        }
        const struct wb_clock_stamps stamps = {device, host_ns, n, 1.0 / align->rig.time_scale};
        status = map_segments(align, &stamps, on_probe_clock);
    }
    free(device);
    free(host_ns);
    if (status == WB_OK)
        drop_backward(align);
    wb_json_set_integer(align->checks, "disordered_frames",
                        (int64_t)(n_dropped + n - align->cloud.n_frames));
    return status;
}

/* --- the load cell --- */

/* Puts the readings of a stream on a line over their number, which removes the host's jitter.
 * Readings that were requested one by one keep their arrival times, and so do those of a stream
 * with many losses, where the number does not determine the time. */
static enum wb_status map_stream(struct wb_align *align, int64_t *host_ns, double *number,
                                 size_t *n_used)
{
    struct wb_align_reading *const readings = align->readings.items;
    const size_t n = align->readings.n;
    size_t starts[WB_ALIGN_MAX_SEGMENTS];
    for (size_t i = 0; i < n; i++) {
        host_ns[i] = readings[i].t_ns;
        number[i] = (double)i;
    }
    const size_t n_segments = wb_clock_split_readings(host_ns, n, starts, WB_ALIGN_MAX_SEGMENTS);
    double scatter = 0.0;
    for (size_t i = 0; i < n_segments; i++) {
        const size_t first = starts[i], last = i + 1 < n_segments ? starts[i + 1] : n;
        const double mean_period =
            wb_seconds_from_ns(host_ns[n - 1] - host_ns[0]) / (n > 1 ? (double)(n - 1) : 1.0);
        struct wb_clock_line line;
        WB_TRY(wb_clock_fit_envelope(&line, number + first, host_ns + first, last - first,
                                     mean_period, 32.0));
        for (size_t k = first; k < last; k++)
            readings[k].t = wb_align_bench_time(align, wb_clock_line_host_ns(&line, number[k]));
        scatter = fmax(scatter, line.scatter);
    }
    align->load_scatter = scatter * align->rig.time_scale;
    *n_used = n_segments;
    return WB_OK;
}

static void describe_load(struct wb_align *align, bool by_arrival, size_t n_segments)
{
    const struct wb_align_reading *const readings = align->readings.items;
    const size_t n = align->readings.n;
    const double span = n > 1 ? readings[n - 1].t - readings[0].t : 0.0;
    struct wb_json *const object = wb_json_set_object(align->checks, "load_cell_stream");
    wb_json_set_text(object, "method",
                     align->load_times_given ? "times of the file"
                     : by_arrival            ? "arrival of each reading"
                                             : "lower envelope");
    wb_json_set_integer(object, "readings", (int64_t)n);
    wb_json_set_integer(object, "invalid_readings", (int64_t)align->n_invalid);
    wb_json_set_integer(object, "segments", (int64_t)n_segments);
    if (span > 0.0)
        wb_align_set(object, "rate_per_s", (double)(n - 1) / span);
    wb_align_set(object, "arrival_scatter_ms",
                 by_arrival ? (double)NAN : align->load_scatter * 1e3);
}

static void drop_invalid_readings(struct wb_align *align)
{
    struct wb_align_reading *const readings = align->readings.items;
    size_t n = 0;
    for (size_t i = 0; i < align->readings.n; i++) {
        if (!isfinite(readings[i].force) || (n > 0 && readings[i].t < readings[n - 1].t))
            continue;
        readings[n++] = readings[i];
    }
    align->readings.n = n;
}

static enum wb_status map_load(struct wb_align *align)
{
    struct wb_align_reading *const readings = align->readings.items;
    const size_t n = align->readings.n;
    /* Times from a file, and arrivals of readings that were requested one by one or of which many
     * were lost, are used as they are. */
    const bool by_arrival = align->load_times_given ||
                            align->rig.load_cell.poll_command[0] != '\0' ||
                            align->is_losing_readings;
    size_t n_segments = 1;
    if (by_arrival) {
        for (size_t i = 0; i < n; i++)
            readings[i].t = wb_align_bench_time(align, readings[i].t_ns);
    } else {
        int64_t *const host_ns = wb_memory_new(n, sizeof *host_ns);
        double *const number = wb_memory_new(n, sizeof *number);
        const enum wb_status status = map_stream(align, host_ns, number, &n_segments);
        free(host_ns);
        free(number);
        if (status != WB_OK)
            return wb_fail_to(align->why, status,
                              "%s: the load cell's readings cannot be mapped to the host's clock",
                              align->name);
    }
    describe_load(align, by_arrival, n_segments);
    align->filter_delay = align->rig.load_cell.filter_delay;
    /* A lag found from an event in both files includes the filter's delay, whatever it is. */
    align->filter_delay_uncertainty =
        isfinite(align->import_uncertainty) ? 0.0 : align->rig.load_cell.filter_delay_uncertainty;
    for (size_t i = 0; i < n; i++)
        readings[i].t -= align->filter_delay;
    drop_invalid_readings(align);
    if (align->readings.n == 0)
        return wb_fail_to(align->why, WB_ERR_DATA,
                          "%s: the recording has no valid reading of the load cell", align->name);
    return WB_OK;
}

/* --- the stage and the start of time --- */

static void map_stage(struct wb_align *align)
{
    struct wb_align_report_point *const reports = align->reports.items;
    for (size_t i = 0; i < align->reports.n; i++)
        reports[i].t = wb_align_bench_time(align, reports[i].t_ns);
}

enum wb_status wb_align_times(struct wb_align *align)
{
    /* Without events the test starts where both streams have data. */
    const struct wb_align_reading *const readings = align->readings.items;
    const int64_t load_ns = readings[0].t_ns;
    const int64_t mocap_ns = align->cloud.frames[0].t_ns;
    align->zero_ns = load_ns > mocap_ns ? load_ns : mocap_ns;
    if (align->has_start)
        align->zero_ns = align->start_ns;
    else if (align->tare_ns > align->zero_ns)
        align->zero_ns = align->tare_ns;
    WB_TRY(map_cameras(align));
    WB_TRY(map_load(align));
    map_stage(align);
    if (align->cloud.n_frames == 0)
        return wb_fail_to(align->why, WB_ERR_DATA,
                          "%s: the recording has no frame of motion capture with a time",
                          align->name);
    const struct wb_align_correction correction = {"filter delay", "ms", 1e-3, align->filter_delay,
                                                   align->filter_delay_uncertainty};
    wb_align_correct(align, &correction,
                     "the load cell's stamps were moved back by its filter's delay from the rig "
                     "file; the transmission time of a line cannot be separated from it");
    return WB_OK;
}
