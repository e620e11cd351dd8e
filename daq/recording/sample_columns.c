#include "daq/recording/sample_columns.h"

#include <string.h>

#include "daq/recording/survey.h"

#define WB_LOG_DOMAIN "samples"

#define T_S                                                                                        \
    {                                                                                              \
        "t_s", "s", WB_COLUMN_REAL                                                                 \
    }
#define T_NS                                                                                       \
    {                                                                                              \
        "t_ns", "ns", WB_COLUMN_INTEGER                                                            \
    }

static const struct wb_column_kind load_kinds[] = {
    T_S,
    T_NS,
    {"index", "1", WB_COLUMN_INTEGER},
    {"force_N", "N", WB_COLUMN_REAL},
    {"valid", "1", WB_COLUMN_INTEGER},
    {"unstable", "1", WB_COLUMN_INTEGER},
    {"overload", "1", WB_COLUMN_INTEGER},
    {"unit_changed", "1", WB_COLUMN_INTEGER},
};

static const struct wb_column_kind mocap_kinds[] = {
    T_S,
    T_NS,
    {"frame", "1", WB_COLUMN_INTEGER},
    {"t_device_s", "s", WB_COLUMN_REAL},
    {"marker", "1", WB_COLUMN_INTEGER},
    {"x_m", "m", WB_COLUMN_REAL},
    {"y_m", "m", WB_COLUMN_REAL},
    {"z_m", "m", WB_COLUMN_REAL},
    {"size_m", "m", WB_COLUMN_REAL},
    {"residual_m", "m", WB_COLUMN_REAL},
    {"params", "1", WB_COLUMN_INTEGER},
    {"occluded", "1", WB_COLUMN_INTEGER},
    {"model_filled", "1", WB_COLUMN_INTEGER},
    {"segment", "1", WB_COLUMN_INTEGER},
};

static const struct wb_column_kind stage_kinds[] = {
    T_S,
    T_NS,
    {"state", "", WB_COLUMN_TEXT},
    {"position_m", "m", WB_COLUMN_REAL},
    {"alarm", "1", WB_COLUMN_INTEGER},
};

static const struct wb_column_kind event_kinds[] = {
    T_S,
    T_NS,
    {"kind", "", WB_COLUMN_TEXT},
    {"text", "", WB_COLUMN_TEXT},
};

static const struct wb_column_kind clock_kinds[] = {
    T_S,
    T_NS,
    {"stream", "1", WB_COLUMN_INTEGER},
    {"t_device_s", "s", WB_COLUMN_REAL},
    {"rtt_ns", "ns", WB_COLUMN_INTEGER},
};

#define COUNT(array) ((int)(sizeof(array) / sizeof((array)[0])))

static const struct {
    const char *name;
    const struct wb_column_kind *kinds;
    int n;
} layouts[WB_SAMPLE_COLUMNS_TABLES] = {
    {"load", load_kinds, COUNT(load_kinds)},    {"mocap", mocap_kinds, COUNT(mocap_kinds)},
    {"stage", stage_kinds, COUNT(stage_kinds)}, {"events", event_kinds, COUNT(event_kinds)},
    {"clock", clock_kinds, COUNT(clock_kinds)},
};

int wb_sample_columns_find(const char *name)
{
    for (int i = 0; i < WB_SAMPLE_COLUMNS_TABLES; i++) {
        if (strcmp(layouts[i].name, name) == 0)
            return i;
    }
    return -1;
}

struct reading {
    struct wb_columns *tables;
    int64_t first_ns;
};

static double seconds(const struct reading *reading, int64_t t_ns)
{
    return wb_survey_seconds(reading->first_ns, t_ns);
}

const char *wb_sample_columns_state(enum wb_stage_state state)
{
    static const char *const names[] = {"unknown", "idle", "run",   "jog",
                                        "hold",    "home", "alarm", "other"};
    return (size_t)state < sizeof names / sizeof names[0] ? names[state] : "unknown";
}

static enum wb_status find_start(void *context, const struct wb_chunk *chunk)
{
    int64_t *const first_ns = context;
    if (!chunk->intact)
        return WB_OK;
    *first_ns = chunk->t_ns;
    return WB_ERR_TIMEOUT; /* ends the walk after the first intact chunk */
}

enum wb_status wb_sample_columns_start(struct wb_recording *recording, int64_t *first_ns)
{
    *first_ns = 0;
    const enum wb_status status = wb_recording_each_chunk(recording, find_start, first_ns);
    return status == WB_ERR_TIMEOUT ? WB_OK : status;
}

static void put_load(void *context, const struct wb_load_sample *sample)
{
    struct reading *const reading = context;
    const union wb_cell cells[] = {
        {.real = seconds(reading, sample->t_ns)},
        {.integer = sample->t_ns},
        {.integer = (int64_t)sample->index},
        {.real = sample->force},
        {.integer = sample->valid},
        {.integer = sample->unstable},
        {.integer = sample->overload},
        {.integer = sample->unit_changed},
    };
    wb_columns_add_row(&reading->tables[WB_SAMPLE_COLUMNS_LOAD], cells);
}

static void put_mocap(void *context, const struct wb_mocap_frame *frame)
{
    struct reading *const reading = context;
    for (int i = 0; i < frame->n_markers; i++) {
        const struct wb_marker *const marker = &frame->markers[i];
        const union wb_cell cells[] = {
            {.real = seconds(reading, frame->t_ns)},
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
        wb_columns_add_row(&reading->tables[WB_SAMPLE_COLUMNS_MOCAP], cells);
    }
}

static void put_stage(void *context, const struct wb_stage_report *report)
{
    struct reading *const reading = context;
    const union wb_cell cells[] = {
        {.real = seconds(reading, report->t_ns)},
        {.integer = report->t_ns},
        {.text = wb_sample_columns_state(report->state)},
        {.real = report->position},
        {.integer = report->alarm},
    };
    wb_columns_add_row(&reading->tables[WB_SAMPLE_COLUMNS_STAGE], cells);
}

static enum wb_status put_event(void *context, const struct wb_event *event)
{
    struct reading *const reading = context;
    const union wb_cell cells[] = {
        {.real = seconds(reading, event->t_ns)},
        {.integer = event->t_ns},
        {.text = event->kind},
        {.text = event->text},
    };
    wb_columns_add_row(&reading->tables[WB_SAMPLE_COLUMNS_EVENTS], cells);
    return WB_OK;
}

static enum wb_status put_clock(void *context, const struct wb_clock_row *row)
{
    struct reading *const reading = context;
    const union wb_cell cells[] = {
        {.real = seconds(reading, row->t_host_ns)},
        {.integer = row->t_host_ns},
        {.integer = row->stream},
        {.real = row->t_device},
        {.integer = row->rtt_ns},
    };
    wb_columns_add_row(&reading->tables[WB_SAMPLE_COLUMNS_CLOCK], cells);
    return WB_OK;
}

static enum wb_status fill(struct reading *reading, struct wb_recording *recording,
                           const struct wb_rig *rig, struct wb_replay_counts *counts)
{
    WB_TRY(wb_sample_columns_start(recording, &reading->first_ns));
    const struct wb_sink sink = {
        .context = reading, .load = put_load, .mocap = put_mocap, .stage = put_stage};
    enum wb_status status = wb_replay_run(recording, rig, &sink, 0.0, counts);
    const enum wb_status events = wb_recording_each_event(recording, put_event, reading);
    const enum wb_status clock = wb_recording_each_clock(recording, put_clock, reading);
    if (status == WB_OK)
        status = events;
    return status == WB_OK ? clock : status;
}

enum wb_status wb_sample_columns_read(struct wb_columns tables[WB_SAMPLE_COLUMNS_TABLES],
                                      struct wb_recording *recording, const struct wb_rig *rig,
                                      struct wb_replay_counts *counts)
{
    struct reading reading = {.tables = tables};
    *counts = (struct wb_replay_counts){0};
    for (int i = 0; i < WB_SAMPLE_COLUMNS_TABLES; i++)
        wb_columns_init(&tables[i], layouts[i].name, layouts[i].kinds, layouts[i].n);
    const enum wb_status status = fill(&reading, recording, rig, counts);
    for (int i = 0; status != WB_OK && status != WB_ERR_DATA && i < WB_SAMPLE_COLUMNS_TABLES; i++)
        wb_columns_release(&tables[i]);
    return status;
}
