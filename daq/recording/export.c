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
#include "daq/recording/sample_columns.h"
#include "daq/recording/survey.h"

#define WB_LOG_DOMAIN "export"

/* A table, written to a temporary file that is renamed when complete. */
struct table {
    FILE *file;
    char path[WB_PATH], part[WB_PATH + 8];
    uint64_t rows;
};

/* Source and receiver of the rows. */
struct source {
    int64_t first_ns; /* time of the first intact chunk; 0: none */
    wb_export_put *put;
    void *context;
};

/* Names of files and columns, and formats of the columns after t_s and t_ns: i integer, n number, m
 * length in mm, f number of single precision, w word, t quoted text. */
static const struct {
    const char *name, *columns, *formats;
} layouts[WB_SAMPLE_COLUMNS_TABLES] = {
    [WB_SAMPLE_COLUMNS_LOAD] = {"load.csv",
                                "t_s,t_ns,index,force_N,valid,unstable,overload,unit_changed",
                                "iniiii"},
    [WB_SAMPLE_COLUMNS_MOCAP] = {"mocap.csv",
                                 "t_s,t_ns,frame,t_device_s,marker,x_m,y_m,z_m,size_m,residual_m,"
                                 "params,occluded,model_filled,segment",
                                 "inifffffiiii"},
    [WB_SAMPLE_COLUMNS_STAGE] = {"stage.csv", "t_s,t_ns,state,position_mm,alarm", "wmi"},
    [WB_SAMPLE_COLUMNS_EVENTS] = {"events.csv", "t_s,t_ns,kind,text", "tt"},
    [WB_SAMPLE_COLUMNS_CLOCK] = {"clock.csv", "t_s,t_ns,stream,t_device_s,rtt_ns", "ini"},
};

/* --- tables --- */

static enum wb_status open_table(struct table *table, int which, const char *folder,
                                 const char *source, const struct wb_rig *rig)
{
    WB_TRY(wb_file_join(table->path, folder, layouts[which].name));
    snprintf(table->part, sizeof table->part, "%s.part", table->path);
    table->file = fopen(table->part, "we");
    if (!table->file)
        return wb_fail(WB_ERR_IO, "cannot write '%s': %s", table->path, strerror(errno));
    fprintf(table->file, "# %s%s\n%s\n", rig->is_virtual ? "virtual rig, " : "", source,
            layouts[which].columns);
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

static void put_cell(FILE *file, char format, const union wb_cell *cell)
{
    char number[WB_NUMBER_TEXT];
    switch (format) {
    case 'i':
        fprintf(file, "%" PRId64, cell->integer);
        break;
    case 'f':
        fputs(format_float((float)cell->real, number), file);
        break;
    case 'w':
        fputs(cell->text, file);
        break;
    case 't':
        put_text(file, cell->text);
        break;
    default:
        if (isfinite(cell->real))
            fputs(wb_number_format(format == 'm' ? cell->real / WB_MM : cell->real, number), file);
    }
}

static void put_row(void *context, int which, int64_t first_ns, const union wb_cell *cells)
{
    struct table *const table = (struct table *)context + which;
    const char *const formats = layouts[which].formats;
    const int64_t t_ns = cells[1].integer;
    const uint64_t since =
        t_ns < first_ns ? (uint64_t)first_ns - (uint64_t)t_ns : (uint64_t)t_ns - (uint64_t)first_ns;
    const uint64_t second = (uint64_t)WB_NS_PER_S;
    table->rows++;
    fprintf(table->file, "%s%" PRIu64 ".%09" PRIu64 ",%" PRId64, t_ns < first_ns ? "-" : "",
            since / second, since % second, t_ns);
    for (int i = 0; formats[i]; i++) {
        putc(',', table->file);
        put_cell(table->file, formats[i], &cells[2 + i]);
    }
    putc('\n', table->file);
}

/* --- rows --- */

static double seconds(const struct source *source, int64_t t_ns)
{
    return wb_survey_seconds(source->first_ns, t_ns);
}

static const char *state_name(enum wb_stage_state state)
{
    static const char *const names[] = {"unknown", "idle", "run",   "jog",
                                        "hold",    "home", "alarm", "other"};
    return (size_t)state < sizeof names / sizeof names[0] ? names[state] : "unknown";
}

static enum wb_status take_first(void *context, const struct wb_chunk *chunk)
{
    int64_t *const first_ns = context;
    if (!chunk->intact)
        return WB_OK;
    *first_ns = chunk->t_ns;
    return WB_ERR_TIMEOUT; /* ends the walk after the first intact chunk */
}

/* Finds the time of the first intact chunk. WB_ERR_DATA: no chunk could be read from a damaged
 * database. */
static enum wb_status find_first(struct wb_recording *recording, int64_t *first_ns)
{
    const enum wb_status status = wb_recording_each_chunk(recording, take_first, first_ns);
    return status == WB_ERR_TIMEOUT ? WB_OK : status;
}

static void on_load(void *context, const struct wb_load_sample *sample)
{
    struct source *const source = context;
    const union wb_cell cells[] = {
        {.real = seconds(source, sample->t_ns)},
        {.integer = sample->t_ns},
        {.integer = (int64_t)sample->index},
        {.real = sample->force},
        {.integer = sample->valid},
        {.integer = sample->unstable},
        {.integer = sample->overload},
        {.integer = sample->unit_changed},
    };
    source->put(source->context, WB_SAMPLE_COLUMNS_LOAD, source->first_ns, cells);
}

static void on_mocap(void *context, const struct wb_mocap_frame *frame)
{
    struct source *const source = context;
    for (int i = 0; i < frame->n_markers; i++) {
        const struct wb_marker *const marker = &frame->markers[i];
        const union wb_cell cells[] = {
            {.real = seconds(source, frame->t_ns)},
            {.integer = frame->t_ns},
            {.integer = frame->frame_number},
            {.real = frame->t_device},
            {.integer = marker->id},
            {.real = (double)marker->position[0]},
            {.real = (double)marker->position[1]},
            {.real = (double)marker->position[2]},
            {.real = (double)marker->size},
            {.real = (double)marker->residual},
            {.integer = marker->params},
            {.integer = (marker->params & WB_MARKER_OCCLUDED) != 0},
            {.integer = (marker->params & WB_MARKER_MODEL_FILLED) != 0},
            {.integer = frame->segment},
        };
        source->put(source->context, WB_SAMPLE_COLUMNS_MOCAP, source->first_ns, cells);
    }
}

static void on_stage(void *context, const struct wb_stage_report *report)
{
    struct source *const source = context;
    const union wb_cell cells[] = {
        {.real = seconds(source, report->t_ns)},
        {.integer = report->t_ns},
        {.text = state_name(report->state)},
        {.real = report->position},
        {.integer = report->alarm},
    };
    source->put(source->context, WB_SAMPLE_COLUMNS_STAGE, source->first_ns, cells);
}

static enum wb_status on_event(void *context, const struct wb_event *event)
{
    struct source *const source = context;
    const union wb_cell cells[] = {
        {.real = seconds(source, event->t_ns)},
        {.integer = event->t_ns},
        {.text = event->kind},
        {.text = event->text},
    };
    source->put(source->context, WB_SAMPLE_COLUMNS_EVENTS, source->first_ns, cells);
    return WB_OK;
}

static enum wb_status on_clock(void *context, const struct wb_clock_row *row)
{
    struct source *const source = context;
    const union wb_cell cells[] = {
        {.real = seconds(source, row->t_host_ns)},
        {.integer = row->t_host_ns},
        {.integer = row->stream},
        {.real = row->t_device},
        {.integer = row->rtt_ns},
    };
    source->put(source->context, WB_SAMPLE_COLUMNS_CLOCK, source->first_ns, cells);
    return WB_OK;
}

enum wb_status wb_export_rows(struct wb_recording *recording, const struct wb_rig *rig,
                              wb_export_put *put, void *context, struct wb_replay_counts *counts)
{
    struct source source = {.put = put, .context = context};
    const struct wb_sink sink = {
        .context = &source, .load = on_load, .mocap = on_mocap, .stage = on_stage};
    *counts = (struct wb_replay_counts){0};
    WB_TRY(find_first(recording, &source.first_ns));
    enum wb_status status = wb_replay_run(recording, rig, &sink, 0.0, counts);
    const enum wb_status events = wb_recording_each_event(recording, on_event, &source);
    const enum wb_status clock = wb_recording_each_clock(recording, on_clock, &source);
    if (status == WB_OK)
        status = events;
    return status == WB_OK ? clock : status;
}

/* --- tables of a recording --- */

enum wb_status wb_export_csv(struct wb_recording *recording, const struct wb_rig *rig,
                             const char *source, const char *folder,
                             struct wb_export_counts *counts)
{
    struct table tables[WB_SAMPLE_COLUMNS_TABLES] = {{0}};
    struct wb_replay_counts replayed = {0};
    enum wb_status status = WB_OK;
    for (int i = 0; i < WB_SAMPLE_COLUMNS_TABLES && status == WB_OK; i++)
        status = open_table(&tables[i], i, folder, source, rig);
    if (status == WB_OK)
        status = wb_export_rows(recording, rig, put_row, tables, &replayed);
    bool keep = status == WB_OK || status == WB_ERR_DATA;
    for (int i = 0; i < WB_SAMPLE_COLUMNS_TABLES; i++) {
        enum wb_status closed = close_table(&tables[i], keep);
        if (status == WB_OK)
            status = closed;
    }
    *counts = (struct wb_export_counts){
        .load = tables[WB_SAMPLE_COLUMNS_LOAD].rows,
        .mocap = tables[WB_SAMPLE_COLUMNS_MOCAP].rows,
        .stage = tables[WB_SAMPLE_COLUMNS_STAGE].rows,
        .events = tables[WB_SAMPLE_COLUMNS_EVENTS].rows,
        .clock = tables[WB_SAMPLE_COLUMNS_CLOCK].rows,
        .damaged_chunks = replayed.damaged_chunks,
    };
    return status;
}
