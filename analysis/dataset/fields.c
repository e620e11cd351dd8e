#include "analysis/dataset/fields.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/dataset/csv_table.h"
#include "base/memory.h"
#include "base/text.h"

#define WB_LOG_DOMAIN "fields"

static const char file_name[] = "fields.csv";

enum {
    TEXT_COLUMNS = 6, /* state, section, at_mm, face, part, node */
    VALUES = 9,
    COLUMNS = TEXT_COLUMNS + VALUES,
    MOST_FACES = 1000000,
    MOST_PARTS = 2,
    DIGITS = 6
};

static const char *const column_names[COLUMNS] = {
    "state", "section", "at_mm", "face", "part",          "node",      "X_mm",           "Y_mm",
    "Z_mm",  "x_mm",    "y_mm",  "z_mm", "von_mises_MPa", "axial_MPa", "plastic_strain",
};
/* Smaller coordinates are round-off, m. */
static const double smallest_place = 1e-12;

/* Decimal places from SI to the file's unit. */
static const int value_shifts[VALUES] = {3, 3, 3, 3, 3, 3, -6, -6, 0};

/* A node's members are the values of its row, in this order. */
_Static_assert(sizeof(struct wb_field_node) == VALUES * sizeof(double), "a node is its values");

/* --- the list --- */

enum wb_status wb_fields_add(struct wb_fields *fields, const char *state, double x, int n_faces,
                             struct wb_field **field, struct wb_reason *why)
{
    if (strlen(state) >= sizeof fields->items->state || state[strcspn(state, ",\"\r\n")] != '\0' ||
        state[0] == '\0')
        return wb_fail_to(why, WB_ERR_ARGUMENT, "'%s' cannot name a state of fields", state);
    if (n_faces < 1 || n_faces > MOST_FACES)
        return wb_fail_to(why, WB_ERR_ARGUMENT, "%d faces in a field: expected 1 to %d", n_faces,
                          MOST_FACES);
    fields->items = wb_memory_resize(fields->items, (size_t)fields->n + 1, sizeof *fields->items);
    struct wb_field *const added = &fields->items[fields->n++];
    *added = (struct wb_field){.x = x, .n_faces = n_faces};
    strcpy(added->state, state);
    added->faces = wb_memory_new((size_t)n_faces, sizeof *added->faces);
    *field = added;
    return WB_OK;
}

void wb_fields_release(struct wb_fields *fields)
{
    if (!fields)
        return;
    for (int i = 0; i < fields->n; i++)
        free(fields->items[i].faces);
    free(fields->items);
    *fields = (struct wb_fields){0};
}

const struct wb_field *wb_fields_find(const struct wb_fields *fields, const char *state, double x)
{
    const struct wb_field *found = NULL;
    for (int i = 0; i < fields->n; i++) {
        const struct wb_field *const field = &fields->items[i];
        if (strcmp(field->state, state) != 0 || isnan(field->x) != isnan(x))
            continue;
        if (isnan(x))
            return field;
        if (!found || fabs(field->x - x) < fabs(found->x - x))
            found = field;
    }
    return found;
}

/* --- writing --- */

static void append_number(struct wb_text *text, double value, int shift)
{
    char rounded[WB_CSV_TABLE_NUMBER];
    snprintf(rounded, sizeof rounded, "%.*e", DIGITS - 1, value);
    wb_csv_table_append_number(text, strtod(rounded, NULL), shift);
}

static enum wb_status append_field(struct wb_text *text, const struct wb_field *field)
{
    for (int f = 0; f < field->n_faces; f++) {
        for (int k = 0; k < 8; k++) {
            double values[VALUES];
            memcpy(values, &field->faces[f].node[k], sizeof values);
            wb_text_append(text, "%s,%s,", field->state,
                           isnan(field->x) ? "longitudinal" : "cross");
            if (!isnan(field->x))
                append_number(text, field->x, 3);
            wb_text_append(text, ",%d,%d,%d", f, field->faces[f].part, k);
            for (int i = 0; i < VALUES; i++) {
                if (!isfinite(values[i]))
                    return wb_fail(WB_ERR_DATA, "state %s, face %d: %s is not a finite number",
                                   field->state, f, column_names[TEXT_COLUMNS + i]);
                const bool is_nought = i < 6 && fabs(values[i]) < smallest_place;
                wb_text_append_bytes(text, ",", 1);
                append_number(text, is_nought ? 0.0 : values[i], value_shifts[i]);
            }
            wb_text_append_bytes(text, "\n", 1);
        }
    }
    return WB_OK;
}

static enum wb_status format(const struct wb_fields *fields, struct wb_text *text)
{
    wb_csv_table_append_header(text, column_names, COLUMNS);
    for (int i = 0; i < fields->n; i++)
        WB_TRY(append_field(text, &fields->items[i]));
    return WB_OK;
}

enum wb_status wb_fields_write(const struct wb_fields *fields, const char *folder)
{
    struct wb_text text = {0};
    if (fields->n == 0)
        return wb_csv_table_write(folder, file_name, NULL);
    enum wb_status status = format(fields, &text);
    if (status == WB_OK)
        status = wb_csv_table_write(folder, file_name, &text);
    wb_text_release(&text);
    return status;
}

/* --- reading --- */

struct reader {
    struct wb_fields *fields;
    int capacity; /* faces of the last field */
    int due;      /* node of a face that comes next */
};

/* A row of the file. */
struct row {
    const char *state;
    double x;
    int face, part, node;
    double values[VALUES];
};

static enum wb_status parse_row(const struct wb_csv_table *table, char *const *fields,
                                struct row *row)
{
    row->state = fields[0];
    if (fields[0][0] == '\0' || strlen(fields[0]) >= sizeof((struct wb_field *)NULL)->state)
        return wb_csv_table_refuse(table, 0, "the name of a step", fields[0]);

    const bool cross = strcmp(fields[1], "cross") == 0;
    if (!cross && strcmp(fields[1], "longitudinal") != 0)
        return wb_csv_table_refuse(table, 1, "longitudinal or cross", fields[1]);
    row->x = (double)NAN;
    if (cross && !wb_csv_table_parse_number(fields[2], 3, &row->x))
        return wb_csv_table_refuse(table, 2, "a number", fields[2]);
    if (!cross && fields[2][0] != '\0')
        return wb_csv_table_refuse(table, 2, "nothing for a longitudinal section", fields[2]);

    WB_TRY(wb_csv_table_integer(table, 3, fields, MOST_FACES - 1, &row->face));
    WB_TRY(wb_csv_table_integer(table, 4, fields, MOST_PARTS - 1, &row->part));
    WB_TRY(wb_csv_table_integer(table, 5, fields, 7, &row->node));
    for (int i = 0; i < VALUES; i++)
        if (!wb_csv_table_parse_number(fields[TEXT_COLUMNS + i], value_shifts[i], &row->values[i]))
            return wb_csv_table_refuse(table, TEXT_COLUMNS + i, "a number",
                                       fields[TEXT_COLUMNS + i]);
    return WB_OK;
}

/* Makes room for one more face in the last field. */
static void add_face(struct reader *reader, struct wb_field *field)
{
    if (field->n_faces == reader->capacity) {
        reader->capacity *= 2;
        field->faces =
            wb_memory_resize(field->faces, (size_t)reader->capacity, sizeof *field->faces);
    }
    field->n_faces++;
}

static bool has_field(const struct wb_fields *fields, const struct row *row)
{
    const struct wb_field *const found = wb_fields_find(fields, row->state, row->x);
    return found && (isnan(row->x) || found->x == row->x);
}

/* The rows of a field are consecutive, face by face and node by node. `expected` is the next node,
 * 0 where a face or a field may begin. */
static enum wb_status take_row(struct reader *reader, const struct wb_csv_table *table,
                               const struct row *row, int expected)
{
    struct wb_fields *const fields = reader->fields;
    struct wb_field *field = fields->n > 0 ? &fields->items[fields->n - 1] : NULL;
    const bool same = field && strcmp(field->state, row->state) == 0 &&
                      (isnan(field->x) ? isnan(row->x) : field->x == row->x);
    if (expected != row->node || (expected > 0 && !same))
        return wb_csv_table_fail(table, "node: expected node %d of a face, not %d of %s", expected,
                                 row->node, same ? "it" : "another field");
    if (expected == 0 && !same) {
        if (has_field(fields, row))
            return wb_csv_table_fail(table, "section: this field of state %s appears twice",
                                     row->state);
        WB_TRY(wb_fields_add(fields, row->state, row->x, 1, &field, table->why));
        reader->capacity = 1;
    } else if (expected == 0) {
        add_face(reader, field);
    }

    struct wb_field_face *const face = &field->faces[field->n_faces - 1];
    if (row->face != field->n_faces - 1 || (expected > 0 && row->part != face->part))
        return wb_csv_table_fail(table, "face: expected face %d in one part", field->n_faces - 1);
    face->part = row->part;
    memcpy(&face->node[row->node], row->values, sizeof row->values);
    return WB_OK;
}

static enum wb_status take_fields(void *context, const struct wb_csv_table *table,
                                  char *const *fields)
{
    struct reader *const reader = context;
    struct row row;
    WB_TRY(parse_row(table, fields, &row));
    WB_TRY(take_row(reader, table, &row, reader->due));
    reader->due = (reader->due + 1) % 8;
    return WB_OK;
}

static enum wb_status check_end(void *context, const struct wb_csv_table *table)
{
    const struct reader *const reader = context;
    if (reader->due != 0)
        return wb_csv_table_fail(table, "node: the last face ends before node %d", reader->due);
    return WB_OK;
}

enum wb_status wb_fields_read(struct wb_fields *fields, const char *folder, struct wb_reason *why)
{
    struct wb_fields read = {0};
    struct reader reader = {.fields = &read};
    struct wb_csv_table table = {.n_columns = COLUMNS,
                                 .columns = column_names,
                                 .take = take_fields,
                                 .finish = check_end,
                                 .context = &reader,
                                 .why = why};
    const enum wb_status status = wb_csv_table_read(&table, folder, file_name);
    if (status != WB_OK)
        wb_fields_release(&read);
    *fields = read;
    return status;
}
