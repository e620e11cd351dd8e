#include "analysis/import/mocap_import.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <gsl/gsl_errno.h>

#include "analysis/align/markers.h"
#include "analysis/dataset/fit.h"
#include "base/file.h"
#include "base/json.h"
#include "base/memory.h"
#include "base/units.h"
#include "daq/recording/foreign.h"
#include "daq/recording/recording_foreign.h"
#include "daq/take/take_reader.h"
#include "daq/test/bend_recording.h"

#define WB_LOG_DOMAIN "import"

/* The tare needs at least this many readings over at least this time, s. */
#define LEAST_TARE_READINGS 5
#define LEAST_TARE_TIME 0.3
/* The motion begins when the tip leaves its rest by this, m, or by this number of standard
 * deviations. */
#define LEAST_MOTION (0.2 * WB_MM)
#define MOTION_DEVIATIONS 6.0
/* Part of the whole deflection that is certainly motion, and not a tap. */
#define SURE_MOTION 0.15
/* Window (s) of means that show the beginning where single positions do not, and their largest
 * difference from the rest, in standard deviations. */
#define REST_WINDOW 0.2
#define REST_DEVIATIONS 3.0
/* Part of the rest before the motion that belongs to the test, s, and at most half of the rest;
 * recordings of a bench begin likewise. */
#define REST_BEFORE 1.0

static const struct wb_setting setting_rows[] = {
    {WB_ROW_QUANTITY(wb_mocap_import_request, offset, "offset_s", "s", 1.0, -1e6, 1e6, (double)NAN),
     WB_ROW_OPTION("offset-s", "S",
                   "Time of the take minus time of the force file at the same moment"),
     .otherwise = "found by a tap or a reversal"},
    {WB_ROW_QUANTITY(wb_mocap_import_request, tare, "tare_mN", "mN", WB_MN, -1e7, 1e7, (double)NAN),
     WB_ROW_OPTION("tare-mN", "F", "Force reading of the load cell at rest"),
     .otherwise = "mean before the motion begins"},
};

const struct wb_setting_table wb_mocap_import_table = {WB_SETTING_ROWS(setting_rows)};

/* A file and its contents. */
struct source {
    struct wb_foreign foreign;
    char *bytes;
};

struct import {
    const struct wb_mocap_import_request *request;
    struct wb_mocap_import *result;
    struct wb_rig rig;
    struct wb_specimen specimen;
    struct source take_file, force_file;
    struct wb_take take;
    struct wb_force_table force;
    struct wb_point_cloud cloud;
    struct wb_marker_tracks tracks;
    /* The tip relative to the clamp, in frames in which both are seen. */
    size_t n_motion;
    double *t, *motion, *shake; /* (n_motion) owned */
};

/* --- files --- */

static enum wb_status open_source(struct source *source, const char *path)
{
    struct wb_foreign *const foreign = &source->foreign;
    WB_TRY(wb_file_read(path, &source->bytes, &foreign->size));
    snprintf(foreign->name, sizeof foreign->name, "%.120s", wb_file_name(path));
    foreign->uncertainty = (double)NAN;
    wb_hash_bytes(source->bytes, foreign->size, foreign->sha256);
    return WB_OK;
}

static enum wb_status read_take(struct import *import)
{
    const char *const path = import->request->take_path;
    struct wb_mocap_import *const result = import->result;
    const struct wb_take_reader *reader;
    WB_TRY(open_source(&import->take_file, path));
    WB_TRY(wb_take_read(&import->take, path, (const uint8_t *)import->take_file.bytes,
                        import->take_file.foreign.size, &reader, NULL));
    const struct wb_take *const take = &import->take;
    snprintf(import->take_file.foreign.format, sizeof import->take_file.foreign.format, "%s",
             reader->name);
    memcpy(result->format, take->format, sizeof result->format);
    result->n_frames = take->n_frames;
    result->duration = take->frames[take->n_frames - 1].t - take->frames[0].t;
    result->rate = take->rate > 0.0         ? take->rate
                   : result->duration > 0.0 ? (double)(take->n_frames - 1) / result->duration
                                            : 0.0;
    result->skipped_rows = take->skipped_rows;
    result->first_skipped = take->first_skipped;
    result->empty_rows = take->empty_rows;
    result->jumps = take->jumps;
    result->jumped = take->jumped;
    const size_t there = take->n_frames + take->skipped_rows;
    result->missing_frames = take->declared_frames > there ? take->declared_frames - there : 0;
    for (size_t i = 0; i < take->n_points; i++)
        result->n_points += wb_take_is_measured(take->points[i].kind);
    if (result->n_points == 0)
        return wb_fail(WB_ERR_DATA,
                       "%s: rigid bodies only: their markers are solved, not measured; export "
                       "again with 'Markers' enabled",
                       path);
    return WB_OK;
}

static enum wb_status read_force(struct import *import)
{
    const struct wb_mocap_import_request *const request = import->request;
    struct wb_foreign *const take = &import->take_file.foreign;
    struct wb_mocap_import *const result = import->result;
    const struct wb_foreign *from = take;
    if (request->force_path) {
        struct wb_foreign *const foreign = &import->force_file.foreign;
        WB_TRY(open_source(&import->force_file, request->force_path));
        strcpy(foreign->format, WB_FOREIGN_FORCE_TABLE);
        WB_TRY(wb_force_table_parse(&import->force, request->force_path, import->force_file.bytes,
                                    foreign->size, request->columns ? request->columns : "",
                                    foreign->columns, &import->rig, NULL));
        from = foreign;
    } else if (import->take.n_channels > 0 || request->channel) {
        if (request->channel) {
            const size_t n = strcspn(request->channel, ":");
            snprintf(take->channel, sizeof take->channel, "%.*s", (int)(n < 63 ? n : 63),
                     request->channel);
            if (request->channel[n])
                snprintf(take->unit, sizeof take->unit, "%s", request->channel + n + 1);
        }
        WB_TRY(wb_foreign_channel(take, &import->take, &import->rig, &import->force, NULL));
    }
    result->has_force = import->force.n > 0;
    result->n_readings = import->force.n;
    result->force_skipped = import->force.skipped_rows;
    memcpy(result->channel, from->channel, sizeof result->channel);
    memcpy(result->unit, from->unit, sizeof result->unit);
    memcpy(result->columns, from->columns, sizeof result->columns);
    return WB_OK;
}

/* --- markers --- */

static void fill_cloud(struct import *import)
{
    struct wb_mocap_frame *const frame = wb_memory_new(1, sizeof *frame);
    for (size_t i = 0; i < import->take.n_frames; i++) {
        (void)wb_take_frame_at(&import->take, i, frame);
        wb_point_cloud_add(&import->cloud, frame);
    }
    free(frame);
}

/* Finds the columns of the file that were our markers at some time. The cloud contains the measured
 * positions in the file's order. */
static void count_stitched(struct import *import)
{
    const struct wb_take *const take = &import->take;
    bool *const ours = wb_memory_new(take->n_points, sizeof *ours);
    uint32_t *const points = wb_memory_new(import->cloud.n_points, sizeof *points);
    size_t n = 0;
    for (size_t f = 0; f < take->n_frames; f++) {
        int in_frame = 0;
        for (size_t i = take->frames[f].first; i < take->frames[f + 1].first; i++) {
            const uint32_t point = take->places[i].point;
            if (wb_take_is_measured(take->points[point].kind) && in_frame++ < WB_MAX_MARKERS)
                points[n++] = point;
        }
    }
    for (size_t i = 0; i < take->n_frames * (size_t)import->tracks.n_markers; i++)
        if (import->tracks.index[i] >= 0)
            ours[points[import->tracks.index[i]]] = true;
    for (size_t i = 0; i < take->n_points; i++)
        import->result->n_stitched += ours[i];
    free(ours);
    free(points);
}

static enum wb_status find_markers(struct import *import)
{
    struct wb_mocap_import *const result = import->result;
    const struct wb_marker_settings settings = {
        .noise = import->rig.mocap.marker_noise,
        .frame_period = result->rate > 0.0 ? 1.0 / result->rate : 0.0,
    };
    struct wb_reason why = {.text = ""};
    fill_cloud(import);
    const enum wb_status status =
        wb_markers_track(&import->tracks, &import->cloud, &import->specimen, &settings, &why);
    if (status != WB_OK)
        return wb_fail(status, "%s: %s", import->request->take_path, why.text);
    result->n_markers = import->tracks.n_markers;
    result->missing = (double)import->tracks.n_missing /
                      ((double)import->tracks.n_frames * import->tracks.n_markers);
    count_stitched(import);
    return WB_OK;
}

/* --- motion --- */

/* Vector from the first marker to the last; false if one of them is not seen. */
static bool tip_from_clamp(const struct import *import, size_t frame, double tip[3])
{
    const double *const first = wb_markers_position(&import->tracks, frame, 0);
    const double *const last =
        wb_markers_position(&import->tracks, frame, import->tracks.n_markers - 1);
    if (!first || !last)
        return false;
    for (int k = 0; k < 3; k++)
        tip[k] = last[k] - first[k];
    return true;
}

/* Motion along the line between the two positions of the tip that are farthest apart, relative to
 * its position at the start. */
static enum wb_status find_motion(struct import *import)
{
    const size_t n = import->take.n_frames;
    double start[3] = {0.0}, far[3] = {0.0}, tip[3], farthest = -1.0;
    import->t = wb_memory_new(n, sizeof *import->t);
    import->motion = wb_memory_new(n, sizeof *import->motion);
    import->shake = wb_memory_new(n, sizeof *import->shake);
    bool started = false;
    for (size_t i = 0; i < n; i++) {
        if (!tip_from_clamp(import, i, tip))
            continue;
        if (!started)
            memcpy(start, tip, sizeof start);
        started = true;
        double squares = 0.0;
        for (int k = 0; k < 3; k++)
            squares += (tip[k] - start[k]) * (tip[k] - start[k]);
        if (squares > farthest) {
            farthest = squares;
            memcpy(far, tip, sizeof far);
        }
    }
    if (!(farthest > LEAST_MOTION * LEAST_MOTION))
        return wb_fail(WB_ERR_DATA, "%s: the tip does not move relative to the clamp",
                       import->request->take_path);
    const double distance = sqrt(farthest);
    for (size_t i = 0; i < n; i++) {
        if (!tip_from_clamp(import, i, tip))
            continue;
        double along = 0.0;
        for (int k = 0; k < 3; k++)
            along += (tip[k] - start[k]) * (far[k] - start[k]) / distance;
        import->t[import->n_motion] = import->take.frames[i].t;
        import->motion[import->n_motion++] = along;
    }
    const struct wb_signal motion = {import->t, import->motion, import->n_motion};
    wb_signal_shake(&motion, import->shake);
    return WB_OK;
}

/* The first sample of the last window, at or before `last`, in which the tip is still at rest. */
static size_t last_rest(const struct wb_signal *motion, double rest, double noise, size_t last)
{
    size_t from = last;
    for (size_t until = last;; until--) {
        double sum = 0.0;
        from = wb_signal_index(motion, motion->t[until] - REST_WINDOW);
        for (size_t i = from; i <= until; i++)
            sum += motion->x[i] - rest;
        const double n = (double)(until - from + 1);
        if (from == 0 || !(fabs(sum / n) > REST_DEVIATIONS * noise / sqrt(n)))
            return from;
    }
}

/* Finds the beginning: slightly before the last rest that precedes certain motion. The strand
 * becomes taut while the tip hardly moves, and the force's zero is read where the wire passes its
 * level, within a millimetre of its rest. */
static void find_start(struct import *import)
{
    const struct wb_signal motion = {import->t, import->motion, import->n_motion};
    const double noise = wb_signal_noise(&motion);
    double most = 0.0;
    for (size_t i = 0; i < import->n_motion; i++)
        most = fmax(most, fabs(import->motion[i]));
    const double band = fmax(LEAST_MOTION, MOTION_DEVIATIONS * noise);
    /* A tap exceeds the level of certain motion, but returns. */
    size_t sure = 0, last = 0;
    for (size_t i = 0; i < import->n_motion && sure == 0; i++)
        if (import->motion[i] > SURE_MOTION * most + band &&
            (i + 1 == import->n_motion ||
             import->motion[i + (import->n_motion - i - 1 < 30 ? import->n_motion - i - 1 : 30)] >
                 SURE_MOTION * most))
            sure = i;
    for (size_t i = 0; i < sure; i++)
        if (fabs(import->motion[i]) <= band)
            last = i;
    double *const resting = wb_memory_new(last + 1, sizeof *resting);
    memcpy(resting, import->motion, (last + 1) * sizeof *resting);
    const double rest = wb_fit_median(resting, last + 1);
    free(resting);
    const double rested = import->t[last_rest(&motion, rest, noise, last)];
    import->result->motion_start = rested - fmin(REST_BEFORE, 0.5 * (rested - import->t[0]));
}

/* --- the two clocks --- */

/* Brings both files to one clock. A lag found from events includes the delay of the load cell's
 * filter, which the alignment subtracts again; so it is added here. */
static enum wb_status synchronize_clocks(struct import *import)
{
    const struct wb_mocap_import_request *const request = import->request;
    struct wb_mocap_import *const result = import->result;
    struct wb_foreign *const foreign = &import->force_file.foreign;
    const double delay = import->rig.load_cell.filter_delay;
    result->filter_delay = delay;
    if (!request->force_path) {
        result->sync = (struct wb_sync){.method = WB_SYNC_SAME, .uncertainty = (double)NAN};
        return WB_OK;
    }
    if (isfinite(request->offset)) {
        result->sync = (struct wb_sync){
            .method = WB_SYNC_GIVEN, .lag = request->offset, .uncertainty = (double)NAN};
        result->offset = foreign->offset = request->offset;
        return WB_OK;
    }
    const bool any = !request->tap && !request->reversal;
    const struct wb_sync_settings settings = {
        .tap = any || request->tap,
        .reversal = any || request->reversal,
        .filter_delay = delay,
    };
    const struct wb_signal motion = {import->t, import->motion, import->n_motion};
    const struct wb_signal shake = {import->t, import->shake, import->n_motion};
    const struct wb_signal force = {import->force.t, import->force.force, import->force.n};
    wb_sync_find(&result->sync, &motion, &shake, &force, &settings);
    if (result->sync.method == WB_SYNC_NONE)
        return wb_fail(
            WB_ERR_DATA,
            "the lag between '%s' and '%s' is not identifiable: %s. Tap the bench once before the "
            "test, or reverse the motion for a part of its travel, so that both files show it; or "
            "give the lag, --offset-s S (time of the take less that of the force)",
            import->take_file.foreign.name, foreign->name, result->sync.reason);
    result->offset = foreign->offset = result->sync.lag + delay;
    foreign->uncertainty = result->sync.uncertainty;
    return WB_OK;
}

/* --- tare --- */

static enum wb_status find_tare(struct import *import)
{
    struct wb_mocap_import *const result = import->result;
    const struct wb_force_table *const force = &import->force;
    result->tare = import->request->tare;
    result->tare_deviation = (double)NAN;
    result->tare_samples = 1;
    if (isfinite(result->tare))
        return WB_OK;
    double *const values = wb_memory_new(2 * force->n, sizeof *values);
    double *const off = values + force->n;
    size_t n = 0;
    while (n < force->n && force->t[n] + result->offset < result->motion_start)
        n++;
    const double span = n > 1 ? force->t[n - 1] - force->t[0] : 0.0;
    if (n < LEAST_TARE_READINGS || span < LEAST_TARE_TIME) {
        free(values);
        return wb_fail(WB_ERR_DATA,
                       "no tare: only %zu readings (%.2f s) of the force precede the beginning of "
                       "the motion at %.2f s of the take, expected %d over %.1f s; give the force "
                       "of the unloaded cell, --tare-mN F",
                       n, span, result->motion_start, LEAST_TARE_READINGS, LEAST_TARE_TIME);
    }
    /* Readings far from the median are left out: a tap may be among them. */
    memcpy(values, force->force, n * sizeof *values);
    const double middle = wb_fit_median(values, n);
    for (size_t i = 0; i < n; i++)
        off[i] = fabs(force->force[i] - middle);
    const double deviation = wb_fit_usual_size(off, n);
    double sum = 0.0, squares = 0.0;
    long used = 0;
    for (size_t i = 0; i < n; i++) {
        const double d = force->force[i] - middle;
        if (fabs(d) > 4.0 * deviation)
            continue;
        used++;
        sum += d;
        squares += d * d;
    }
    free(values);
    const double mean = sum / (double)used;
    result->tare = middle + mean;
    result->tare_samples = used;
    result->tare_deviation =
        used > 1 ? sqrt(fmax(squares / (double)used - mean * mean, 0.0)) : (double)NAN;
    return WB_OK;
}

/* --- the recording --- */

static enum wb_status add_file(struct wb_recording *recording, enum wb_role role,
                               const struct source *source, double first, double last)
{
    char address[160];
    int id;
    snprintf(address, sizeof address, WB_RECORDING_FOREIGN "%s", source->foreign.name);
    char *const settings = wb_foreign_format(&source->foreign);
    const enum wb_status status =
        wb_recording_add_stream(recording, role, address, source->foreign.format, settings, &id);
    free(settings);
    WB_TRY(status);
    return wb_recording_foreign_append(recording, id, source->bytes, source->foreign.size,
                                       wb_ns_from_seconds(first + source->foreign.offset),
                                       wb_ns_from_seconds(last + source->foreign.offset));
}

/* Writes results of the import and missing parts into the recording's meta data. */
static enum wb_status add_report(const struct import *import, struct wb_recording *recording)
{
    const struct wb_mocap_import *const r = import->result;
    struct wb_json *const root = wb_json_create();
    wb_json_set_text(root, "take", import->take_file.foreign.name);
    wb_json_set_text(root, "take_sha256", import->take_file.foreign.sha256);
    wb_json_set_text(root, "format", r->format);
    wb_json_set_integer(root, "frames", (int64_t)r->n_frames);
    wb_json_set_integer(root, "missing_frames", (int64_t)r->missing_frames);
    wb_json_set_integer(root, "jumps", (int64_t)r->jumps);
    wb_json_set_integer(root, "frames_jumped", (int64_t)r->jumped);
    wb_json_set_integer(root, "skipped_rows", (int64_t)r->skipped_rows);
    wb_json_set_integer(root, "first_skipped_line", (int64_t)r->first_skipped);
    wb_json_set_integer(root, "empty_rows", (int64_t)r->empty_rows);
    wb_json_set_integer(root, "marker_columns", (int64_t)r->n_points);
    wb_json_set_integer(root, "markers", r->n_markers);
    wb_json_set_integer(root, "columns_stitched", (int64_t)r->n_stitched);
    wb_json_set_number(root, "missing_percent", 100.0 * r->missing);
    if (r->has_force) {
        if (import->request->force_path) {
            wb_json_set_text(root, "force", import->force_file.foreign.name);
            wb_json_set_text(root, "force_sha256", import->force_file.foreign.sha256);
        }
        wb_json_set_integer(root, "readings", (int64_t)r->n_readings);
        wb_json_set_integer(root, "force_skipped_rows", (int64_t)r->force_skipped);
        wb_json_set_text(root, "clocks", wb_sync_name(r->sync.method));
        wb_json_set_number(root, "lag_s", r->sync.lag);
        wb_json_set_number(root, "lag_uncertainty_s", r->sync.uncertainty);
        wb_json_set_integer(root, "events_paired", r->sync.n_events);
        wb_json_set_number(root, "offset_s", r->offset);
    }
    char *const text = wb_json_format(root);
    wb_json_destroy(root);
    const enum wb_status status = wb_recording_set_meta(recording, "import", text);
    free(text);
    return status;
}

static enum wb_status add_events(const struct import *import, struct wb_recording *recording)
{
    const struct wb_mocap_import *const r = import->result;
    const int64_t start_ns = wb_ns_from_seconds(r->motion_start);
    char text[512];
    if (r->has_force) {
        char deviation[40] = "";
        if (isfinite(r->tare_deviation))
            snprintf(deviation, sizeof deviation, ", \"sd_N\": %.17g", r->tare_deviation);
        snprintf(text, sizeof text, "{\"force_N\": %.17g, \"samples\": %ld%s}", r->tare,
                 r->tare_samples, deviation);
        WB_TRY(wb_recording_append_event(recording, start_ns, "tare", text));
    }
    if (!r->complete) {
        /* Short, because warnings of the alignment quote its beginning. */
        snprintf(text, sizeof text,
                 "import: %zu frames missing, %zu rows and %zu of force left out",
                 r->missing_frames + r->jumped, r->skipped_rows, r->force_skipped);
        const double end = import->take.frames[r->n_frames - 1].t;
        WB_TRY(wb_recording_append_event(recording, wb_ns_from_seconds(end), "stop", text));
    }
    return WB_OK;
}

static enum wb_status fill_recording(struct import *import, struct wb_recording *recording)
{
    const struct wb_take_frame *const frames = import->take.frames;
    WB_TRY(add_report(import, recording));
    WB_TRY(add_file(recording, WB_ROLE_MOCAP, &import->take_file, frames[0].t,
                    frames[import->take.n_frames - 1].t));
    if (import->request->force_path)
        WB_TRY(add_file(recording, WB_ROLE_LOAD, &import->force_file, import->force.t[0],
                        import->force.t[import->force.n - 1]));
    return add_events(import, recording);
}

static enum wb_status write_recording(struct import *import)
{
    const struct wb_mocap_import_request *const request = import->request;
    const struct wb_bend_recording description = {
        .path = request->output,
        .rig_path = request->rig_path,
        .specimen_path = request->specimen_path,
        .rig = &import->rig,
        .specimen = &import->specimen,
        .notes = request->notes,
        .imported = true,
        .monotonic_start_ns = wb_ns_from_seconds(import->take.frames[0].t),
    };
    struct wb_recording *recording;
    WB_TRY(wb_bend_recording_create(&recording, &description));
    const enum wb_status status = fill_recording(import, recording);
    const enum wb_status closed = wb_recording_close(recording);
    if (status == WB_OK && closed == WB_OK)
        return WB_OK;
    unlink(request->output);
    return status != WB_OK ? status : closed;
}

/* --- import --- */

static enum wb_status run(struct import *import)
{
    struct wb_mocap_import *const result = import->result;
    WB_TRY(wb_rig_read(import->request->rig_path, &import->rig));
    WB_TRY(wb_specimen_read(import->request->specimen_path, &import->specimen));
    WB_TRY(read_take(import));
    WB_TRY(read_force(import));
    WB_TRY(find_markers(import));
    if (result->has_force) {
        WB_TRY(find_motion(import));
        find_start(import);
        WB_TRY(synchronize_clocks(import));
        WB_TRY(find_tare(import));
    }
    result->complete = result->missing_frames == 0 && result->skipped_rows == 0 &&
                       result->jumped == 0 && result->force_skipped == 0;
    return write_recording(import);
}

enum wb_status wb_mocap_import_run(struct wb_mocap_import *result,
                                   const struct wb_mocap_import_request *request)
{
    memset(result, 0, sizeof *result);
    /* GSL's default handler aborts; results of fits are checked instead. */
    gsl_set_error_handler_off();
    if (access(request->output, F_OK) == 0)
        return wb_fail(WB_ERR_EXISTS,
                       "'%s' exists: a recording is never overwritten; choose another name",
                       request->output);
    struct import *const import = wb_memory_new(1, sizeof *import);
    import->request = request;
    import->result = result;
    const enum wb_status status = run(import);
    free(import->take_file.bytes);
    free(import->force_file.bytes);
    wb_take_release(&import->take);
    wb_force_table_release(&import->force);
    wb_point_cloud_release(&import->cloud);
    wb_marker_tracks_release(&import->tracks);
    free(import->t);
    free(import->motion);
    free(import->shake);
    free(import);
    return status;
}
