/* A recording's bytes, decoded, and what its meta and events say. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/align_private.h"
#include "base/file.h"
#include "base/number.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "align"

bool wb_align_list_add(struct wb_align_list *list, const void *item, size_t size)
{
    if (list->n == list->capacity) {
        const size_t capacity = list->capacity ? 2 * list->capacity : 1024;
        void *const items = realloc(list->items, capacity * size);
        if (!items)
            return false;
        list->items = items;
        list->capacity = capacity;
    }
    memcpy((char *)list->items + list->n++ * size, item, size);
    return true;
}

struct wb_align_reading *wb_align_readings(const struct wb_align *align)
{
    return align->readings.items;
}

struct wb_align_report_point *wb_align_reports(const struct wb_align *align)
{
    return align->reports.items;
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
    if (!wb_align_list_add(&align->readings, &reading, sizeof reading))
        align->out_of_memory = true;
}

static void take_mocap(void *context, const struct wb_mocap_frame *frame)
{
    struct wb_align *const align = context;
    if (!align->out_of_memory && wb_point_cloud_add(&align->cloud, frame) != WB_OK)
        align->out_of_memory = true;
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
    if (!wb_align_list_add(&align->reports, &point, sizeof point))
        align->out_of_memory = true;
}

static void take_probe(void *context, const struct wb_clock_probe *probe)
{
    struct wb_align *const align = context;
    if (!wb_align_list_add(&align->probes, probe, sizeof *probe))
        align->out_of_memory = true;
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
    if (align->out_of_memory)
        return wb_fail(WB_ERR_MEMORY, "%s: out of memory", align->name);
    /* What was read before the database broke off can still serve. */
    if (status == WB_ERR_DATA) {
        if (wb_recording_is_complete(recording))
            wb_align_warn(align, "the recording breaks off; what is readable is used");
        align->is_cut_short = true;
    } else if (status != WB_OK) {
        return status;
    }
    if (align->readings.n == 0)
        return wb_fail(WB_ERR_DATA, "%s: no reading of a load cell in it", align->name);
    if (align->cloud.n_frames == 0)
        return wb_fail(WB_ERR_DATA, "%s: no frame of motion capture in it", align->name);
    if (align->counts.damaged_chunks > 0) {
        align->is_cut_short = true;
        wb_align_warn(align, "%llu of %llu chunks %s damaged and left out",
                      (unsigned long long)align->counts.damaged_chunks,
                      (unsigned long long)align->counts.chunks,
                      align->counts.damaged_chunks == 1 ? "is" : "are");
    }
    return WB_OK;
}

/* Imported recordings may have their probes in the table only. */
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
    WB_TRY(wb_json_parse(&json, event->text, origin));
    int64_t samples = 0;
    align->tare_deviation = (double)NAN;
    align->has_tare = wb_json_get_number(json, "force_N", &align->tare);
    (void)wb_json_get_number(json, "sd_N", &align->tare_deviation);
    (void)wb_json_get_integer(json, "samples", &samples);
    wb_json_destroy(json);
    if (!align->has_tare)
        return wb_fail(WB_ERR_DATA, "%s: no number force_N", origin);
    align->tare_samples = samples > 1 && samples < 100000000 ? (long)samples : 1;
    align->tare_ns = event->t_ns;
    return WB_OK;
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
        snprintf(align->stop_reason, sizeof align->stop_reason, "%.60s", event->text);
        if (strcmp(event->text, "done") != 0)
            align->is_cut_short = true;
    } else if (strcmp(event->kind, "stream_lost") == 0) {
        align->n_lost++;
    } else if (strcmp(event->kind, "drop") == 0) {
        align->n_drops++;
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
        return wb_fail(WB_ERR_DATA,
                       "%s: no tare: the load cell's zero is not known, so there is no force",
                       align->name);
    /* From here on the reading of the unloaded cell. */
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

static enum wb_status need_meta(struct wb_align *align, struct wb_recording *recording,
                                const char *key, char **text, char origin[192])
{
    const enum wb_status status = wb_recording_meta(recording, key, text);
    snprintf(origin, 192, "%s: %s", align->name, key);
    if (status == WB_ERR_NOT_FOUND)
        return wb_fail(WB_ERR_DATA, "%s: the recording has no meta '%s'", align->name, key);
    return status;
}

static enum wb_status load_rig(struct wb_align *align, struct wb_recording *recording)
{
    char *text, origin[192];
    WB_TRY(need_meta(align, recording, "rig", &text, origin));
    const enum wb_status status = wb_rig_parse(text, origin, &align->rig);
    free(text);
    return status;
}

static enum wb_status load_specimen(struct wb_align *align, struct wb_recording *recording)
{
    char *text, origin[192];
    WB_TRY(need_meta(align, recording, "specimen", &text, origin));
    const enum wb_status status = wb_specimen_parse(text, origin, &align->specimen);
    free(text);
    return status;
}

/* The wire as it was when the test was recorded; for recordings without it, the file of that
 * name. */
static enum wb_status load_wire(struct wb_align *align, struct wb_recording *recording)
{
    char *text, origin[192], path[WB_PATH];
    const enum wb_status found = wb_recording_meta(recording, "wire", &text);
    if (found == WB_OK) {
        snprintf(origin, sizeof origin, "%s: wire", align->name);
        const enum wb_status status = wb_wire_parse(text, origin, &align->wire);
        free(text);
        return status;
    }
    if (found != WB_ERR_NOT_FOUND)
        return found;
    WB_TRY(wb_file_find_fixture(path, "wires", align->specimen.wire, NULL));
    return wb_wire_read(path, &align->wire);
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
    if (wb_recording_meta(recording, "g", &text) == WB_OK) {
        if (!wb_number_parse(text, &align->gravity))
            wb_align_warn(align, "meta 'g' is no number; gravity is taken from the rig file");
        free(text);
    }
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

static enum wb_status load_all(struct wb_align *align, struct wb_recording *recording)
{
    WB_TRY(load_rig(align, recording));
    WB_TRY(load_specimen(align, recording));
    WB_TRY(load_wire(align, recording));
    align->is_virtual = align->rig.is_virtual || says_virtual(recording);
    align->gravity = align->rig.gravity;
    wb_align_describe(align);
    load_gravity(align, recording);
    struct wb_json *const list = wb_json_set_array(align->dataset->document, "recordings");
    struct wb_json *const entry = wb_json_append_object(list);
    wb_json_set_text(entry, "name", align->name);
    wb_json_set_text(entry, "sha256", align->sha256);
    copy_meta(recording, entry, "start_utc", "start_utc");
    copy_meta(recording, entry, "operator", "operator");
    copy_meta(recording, entry, "notes", "notes");
    copy_meta(recording, entry, "tool_version", "recorded_with_version");
    copy_meta(recording, entry, "tool_revision", "recorded_with_revision");
    WB_TRY(load_events(align, recording));
    if (!wb_recording_is_complete(recording) && !align->is_cut_short) {
        align->is_cut_short = true;
        wb_align_warn(align, "the recording was not closed or is not all there: its end is "
                             "missing");
    }
    WB_TRY(decode(align, recording));
    if (align->probes.n == 0)
        WB_TRY(wb_recording_each_clock(recording, take_clock_row, align));
    if (align->out_of_memory)
        return wb_fail(WB_ERR_MEMORY, "%s: out of memory", align->name);
    return WB_OK;
}

enum wb_status wb_align_load(struct wb_align *align, const char *path)
{
    struct wb_recording *recording;
    snprintf(align->name, sizeof align->name, "%.120s", wb_file_name(path));
    WB_TRY(wb_recording_sha256(path, align->sha256));
    WB_TRY(wb_recording_open(&recording, path));
    const enum wb_status status = load_all(align, recording);
    const enum wb_status closed = wb_recording_close(recording);
    return status != WB_OK ? status : closed;
}
