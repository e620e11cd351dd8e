#include "daq/recording/sample_columns.h"

#include <string.h>

#include "daq/recording/export.h"

#define WB_LOG_DOMAIN "samples"

static const struct wb_column_kind load_kinds[] = {
    {"t_s", "s", WB_COLUMN_REAL},         {"t_ns", "ns", WB_COLUMN_INTEGER},
    {"index", "1", WB_COLUMN_INTEGER},    {"force_N", "N", WB_COLUMN_REAL},
    {"valid", "1", WB_COLUMN_INTEGER},    {"unstable", "1", WB_COLUMN_INTEGER},
    {"overload", "1", WB_COLUMN_INTEGER}, {"unit_changed", "1", WB_COLUMN_INTEGER},
};

static const struct wb_column_kind mocap_kinds[] = {
    {"t_s", "s", WB_COLUMN_REAL},
    {"t_ns", "ns", WB_COLUMN_INTEGER},
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
    {"t_s", "s", WB_COLUMN_REAL},      {"t_ns", "ns", WB_COLUMN_INTEGER},
    {"state", "", WB_COLUMN_TEXT},     {"position_m", "m", WB_COLUMN_REAL},
    {"alarm", "1", WB_COLUMN_INTEGER},
};

static const struct wb_column_kind event_kinds[] = {
    {"t_s", "s", WB_COLUMN_REAL},
    {"t_ns", "ns", WB_COLUMN_INTEGER},
    {"kind", "", WB_COLUMN_TEXT},
    {"text", "", WB_COLUMN_TEXT},
};

static const struct wb_column_kind clock_kinds[] = {
    {"t_s", "s", WB_COLUMN_REAL},        {"t_ns", "ns", WB_COLUMN_INTEGER},
    {"stream", "1", WB_COLUMN_INTEGER},  {"t_device_s", "s", WB_COLUMN_REAL},
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

static void put_row(void *context, int table, int64_t first_ns, const union wb_cell *cells)
{
    (void)first_ns;
    struct wb_columns *const tables = context;
    wb_columns_add_row(&tables[table], cells);
}

enum wb_status wb_sample_columns_read(struct wb_columns tables[WB_SAMPLE_COLUMNS_TABLES],
                                      struct wb_recording *recording, const struct wb_rig *rig,
                                      struct wb_replay_counts *counts)
{
    for (int i = 0; i < WB_SAMPLE_COLUMNS_TABLES; i++)
        wb_columns_init(&tables[i], layouts[i].name, layouts[i].kinds, layouts[i].n);
    const enum wb_status status = wb_export_rows(recording, rig, put_row, tables, counts);
    for (int i = 0; status != WB_OK && status != WB_ERR_DATA && i < WB_SAMPLE_COLUMNS_TABLES; i++)
        wb_columns_release(&tables[i]);
    return status;
}
