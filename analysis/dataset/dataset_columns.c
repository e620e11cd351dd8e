#include "analysis/dataset/dataset_columns.h"

#include <string.h>

static const struct wb_column_kind row_kinds[] = {
    {"t_s", "s", WB_COLUMN_REAL},
    {"cycle", "1", WB_COLUMN_INTEGER},
    {"phase", "", WB_COLUMN_TEXT},
    {"deflection_m", "m", WB_COLUMN_REAL},
    {"tension_N", "N", WB_COLUMN_REAL},
    {"force_N", "N", WB_COLUMN_REAL},
    {"stage_m", "m", WB_COLUMN_REAL},
    {"tip_x_m", "m", WB_COLUMN_REAL},
    {"tip_angle_rad", "rad", WB_COLUMN_REAL},
};

static const struct wb_column_kind shape_kinds[] = {
    {"t_s", "s", WB_COLUMN_REAL},       {"deflection_m", "m", WB_COLUMN_REAL},
    {"marker", "1", WB_COLUMN_INTEGER}, {"s_m", "m", WB_COLUMN_REAL},
    {"x_m", "m", WB_COLUMN_REAL},       {"y_m", "m", WB_COLUMN_REAL},
    {"z_m", "m", WB_COLUMN_REAL},
};

#define COUNT(array) ((int)(sizeof(array) / sizeof((array)[0])))

static const struct {
    const char *name;
    const struct wb_column_kind *kinds;
    int n;
} layouts[WB_DATASET_COLUMNS_TABLES] = {
    {"force_deflection", row_kinds, COUNT(row_kinds)},
    {"shape", shape_kinds, COUNT(shape_kinds)},
};

int wb_dataset_columns_find(const char *name)
{
    for (int i = 0; i < WB_DATASET_COLUMNS_TABLES; i++) {
        if (strcmp(layouts[i].name, name) == 0)
            return i;
    }
    return -1;
}

static void add_row(struct wb_columns *table, const struct wb_row *row)
{
    const union wb_cell cells[] = {
        {.real = row->t},
        {.integer = row->cycle},
        {.text = wb_trial_phase_name(row->phase)},
        {.real = row->deflection},
        {.real = row->tension},
        {.real = row->force},
        {.real = row->stage},
        {.real = row->tip_x},
        {.real = row->tip_angle},
    };
    wb_columns_add_row(table, cells);
}

static void add_shape_row(struct wb_columns *table, const struct wb_shape_row *row)
{
    const union wb_cell cells[] = {
        {.real = row->t}, {.real = row->deflection}, {.integer = row->marker}, {.real = row->s},
        {.real = row->x}, {.real = row->y},          {.real = row->z},
    };
    wb_columns_add_row(table, cells);
}

void wb_dataset_columns_make(struct wb_columns tables[WB_DATASET_COLUMNS_TABLES],
                             const struct wb_dataset *dataset)
{
    struct wb_columns *const rows = &tables[WB_DATASET_COLUMNS_FORCE_DEFLECTION];
    struct wb_columns *const shape = &tables[WB_DATASET_COLUMNS_SHAPE];
    for (int i = 0; i < WB_DATASET_COLUMNS_TABLES; i++)
        wb_columns_init(&tables[i], layouts[i].name, layouts[i].kinds, layouts[i].n);
    for (size_t i = 0; i < dataset->n_rows; i++)
        add_row(rows, &dataset->rows[i]);
    for (size_t i = 0; i < dataset->n_shape_rows; i++)
        add_shape_row(shape, &dataset->shape_rows[i]);
}
