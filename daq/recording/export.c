#include "daq/recording/export.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/number.h"
#include "base/units.h"
#include "daq/recording/replay.h"
#include "daq/recording/sample_columns.h"

#define WB_LOG_DOMAIN "export"

/* A table, written to a temporary file that is renamed when complete. */
struct table {
    const char *name, *columns;
    FILE *file;
    char path[WB_PATH], part[WB_PATH + 8];
    uint64_t rows;
};

enum {
    TABLE_LOAD,
    TABLE_MOCAP,
    TABLE_STAGE,
    TABLE_EVENTS,
    TABLE_CLOCK,
    N_TABLES
};

struct export
{
    struct table tables[N_TABLES];
    int64_t first_ns;
};

/* --- tables --- */

static enum wb_status open_table(struct table *table, const char *folder, const char *source,
                                 const struct wb_rig *rig)
{
    WB_TRY(wb_file_join(table->path, folder, table->name));
    snprintf(table->part, sizeof table->part, "%s.part", table->path);
    table->file = fopen(table->part, "we");
    if (!table->file)
        return wb_fail(WB_ERR_IO, "cannot write '%s': %s", table->path, strerror(errno));
    fprintf(table->file, "# %s%s\n%s\n", rig->is_virtual ? "virtual rig, " : "", source,
            table->columns);
    return WB_OK;
}

static enum wb_status close_table(struct table *table, bool keep)
{
    if (!table->file)
        return WB_OK;
    errno = 0;
    bool good = fflush(table->file) == 0 && !ferror(table->file) && fsync(fileno(table->file)) == 0;
    int error = errno;
    if (fclose(table->file) != 0 && good) {
        good = false;
        error = errno;
    }
    table->file = NULL;
    if (keep && good) {
        if (rename(table->part, table->path) == 0)
            return WB_OK;
        error = errno;
    }
    unlink(table->part);
    if (!keep)
        return WB_OK;
    return wb_fail(WB_ERR_IO, "cannot write '%s': %s", table->path, strerror(error ? error : EIO));
}

/* Shortest decimal text that is read back as the same float. */
static const char *format_float(float value, char text[WB_NUMBER_TEXT])
{
    for (int digits = 6; digits < 9; digits++) {
        snprintf(text, WB_NUMBER_TEXT, "%.*g", digits, (double)value);
        if (strtof(text, NULL) == value)
            return text;
    }
    snprintf(text, WB_NUMBER_TEXT, "%.9g", (double)value);
    return text;
}

/* Writes a quoted CSV field; quotes are doubled. */
static void put_text(FILE *file, const char *text)
{
    putc('"', file);
    for (; *text; text++) {
        if (*text == '"')
            putc('"', file);
        putc(*text, file);
    }
    putc('"', file);
}

/* Begins a row with t_s and t_ns. */
static FILE *begin_row(struct export *export, int which, int64_t t_ns)
{
    struct table *table = &export->tables[which];
    table->rows++;
    bool before = t_ns < export->first_ns;
    uint64_t since = before ? (uint64_t) export->first_ns - (uint64_t)t_ns
                            : (uint64_t)t_ns - (uint64_t) export->first_ns;
    const uint64_t second = (uint64_t)WB_NS_PER_S;
    fprintf(table->file, "%s%" PRIu64 ".%09" PRIu64 ",%" PRId64, before ? "-" : "", since / second,
            since % second, t_ns);
    return table->file;
}

static const char *number_or_empty(double value, char text[WB_NUMBER_TEXT])
{
    return isfinite(value) ? wb_number_format(value, text) : "";
}

/* --- rows --- */

static void put_load(void *context, const struct wb_load_sample *sample)
{
    char force[WB_NUMBER_TEXT];
    FILE *file = begin_row(context, TABLE_LOAD, sample->t_ns);
    fprintf(file, ",%" PRIu64 ",%s,%d,%d,%d,%d\n", sample->index,
            number_or_empty(sample->force, force), sample->valid, sample->unstable,
            sample->overload, sample->unit_changed);
}

static void put_mocap(void *context, const struct wb_mocap_frame *frame)
{
    char t_device[WB_NUMBER_TEXT], x[WB_NUMBER_TEXT], y[WB_NUMBER_TEXT], z[WB_NUMBER_TEXT],
        size[WB_NUMBER_TEXT], residual[WB_NUMBER_TEXT];
    snprintf(t_device, sizeof t_device, "%s", number_or_empty(frame->t_device, x));
    for (int i = 0; i < frame->n_markers; i++) {
        const struct wb_marker *m = &frame->markers[i];
        FILE *file = begin_row(context, TABLE_MOCAP, frame->t_ns);
        fprintf(file, ",%" PRId32 ",%s,%" PRId32 ",%s,%s,%s,%s,%s,%d,%d,%d,%d\n",
                frame->frame_number, t_device, m->id, format_float(m->position[0], x),
                format_float(m->position[1], y), format_float(m->position[2], z),
                format_float(m->size, size), format_float(m->residual, residual), m->params,
                (m->params & WB_MARKER_OCCLUDED) != 0, (m->params & WB_MARKER_MODEL_FILLED) != 0,
                frame->segment);
    }
}

static void put_stage(void *context, const struct wb_stage_report *report)
{
    char position[WB_NUMBER_TEXT];
    FILE *file = begin_row(context, TABLE_STAGE, report->t_ns);
    fprintf(file, ",%s,%s,%d\n", wb_sample_columns_state(report->state),
            number_or_empty(report->position / WB_MM, position), report->alarm);
}

static enum wb_status put_event(void *context, const struct wb_event *event)
{
    FILE *file = begin_row(context, TABLE_EVENTS, event->t_ns);
    putc(',', file);
    put_text(file, event->kind);
    putc(',', file);
    put_text(file, event->text);
    putc('\n', file);
    return WB_OK;
}

static enum wb_status put_clock(void *context, const struct wb_clock_row *row)
{
    char t_device[WB_NUMBER_TEXT];
    FILE *file = begin_row(context, TABLE_CLOCK, row->t_host_ns);
    fprintf(file, ",%d,%s,%" PRId64 "\n", row->stream, number_or_empty(row->t_device, t_device),
            row->rtt_ns);
    return WB_OK;
}

/* --- tables of a recording --- */

static enum wb_status write_tables(struct export *export, struct wb_recording *recording,
                                   const struct wb_rig *rig, struct wb_export_counts *counts)
{
    enum wb_status status = wb_sample_columns_start(recording, &export->first_ns);
    if (status != WB_OK)
        return status;
    const struct wb_sink sink = {
        .context = export, .load = put_load, .mocap = put_mocap, .stage = put_stage};
    struct wb_replay_counts replayed;
    status = wb_replay_run(recording, rig, &sink, 0.0, &replayed);
    counts->damaged_chunks = replayed.damaged_chunks;
    enum wb_status events = wb_recording_each_event(recording, put_event, export);
    enum wb_status clock = wb_recording_each_clock(recording, put_clock, export);
    if (status == WB_OK)
        status = events;
    return status == WB_OK ? clock : status;
}

enum wb_status wb_export_csv(struct wb_recording *recording, const struct wb_rig *rig,
                             const char *source, const char *folder,
                             struct wb_export_counts *counts)
{
    static const char *const names[][2] = {
        {"load.csv", "t_s,t_ns,index,force_N,valid,unstable,overload,unit_changed"},
        {"mocap.csv", "t_s,t_ns,frame,t_device_s,marker,x_m,y_m,z_m,size_m,residual_m,params,"
                      "occluded,model_filled,segment"},
        {"stage.csv", "t_s,t_ns,state,position_mm,alarm"},
        {"events.csv", "t_s,t_ns,kind,text"},
        {"clock.csv", "t_s,t_ns,stream,t_device_s,rtt_ns"},
    };
    struct export export = {.first_ns = 0};
    struct wb_export_counts counted = {0};
    enum wb_status status = WB_OK;
    for (int i = 0; i < N_TABLES && status == WB_OK; i++) {
        export.tables[i].name = names[i][0];
        export.tables[i].columns = names[i][1];
        status = open_table(&export.tables[i], folder, source, rig);
    }
    if (status == WB_OK)
        status = write_tables(&export, recording, rig, &counted);
    bool keep = status == WB_OK || status == WB_ERR_DATA;
    for (int i = 0; i < N_TABLES; i++) {
        enum wb_status closed = close_table(&export.tables[i], keep);
        if (status == WB_OK)
            status = closed;
    }
    counted.load = export.tables[TABLE_LOAD].rows;
    counted.mocap = export.tables[TABLE_MOCAP].rows;
    counted.stage = export.tables[TABLE_STAGE].rows;
    counted.events = export.tables[TABLE_EVENTS].rows;
    counted.clock = export.tables[TABLE_CLOCK].rows;
    *counts = counted;
    return status;
}
