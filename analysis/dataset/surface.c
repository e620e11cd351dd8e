#include "analysis/dataset/surface.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/dataset/csv_table.h"
#include "base/memory.h"
#include "base/text.h"

#define WB_LOG_DOMAIN "surface"

enum {
    COLUMNS = 8,
    INTEGERS = 4, /* columns before the numbers */
    VALUES = 4,
    MOST_BODIES = 1000,
    MOST_NODES = 100000
};

static const char file_name[] = "surface.csv";
static const char *const column_names[COLUMNS] = {"body", "kind", "station", "node",
                                                  "x_mm", "y_mm", "z_mm",    "von_mises_MPa"};
static const int value_shifts[VALUES] = {3, 3, 3, -6};
/* Limits of plausible values: m, Pa. */
static const double most_values[VALUES] = {100.0, 100.0, 100.0, 1e15};
static const char *const expected_values[VALUES] = {
    "a number from -1e5 to 1e5", "a number from -1e5 to 1e5", "a number from -1e5 to 1e5",
    "a number from -1e9 to 1e9"};
/* m: a station whose nodes are closer together is degenerate. */
static const double least_extent = 1e-9;

static const char *kind_of(const struct wb_surface_body *body)
{
    if (!body->is_tape)
        return "wire";
    return body->closed ? "tape" : "strip";
}

void wb_surface_release(struct wb_surface *surface)
{
    if (!surface)
        return;
    for (int b = 0; b < surface->n; b++)
        free(surface->bodies[b].nodes);
    free(surface->bodies);
    *surface = (struct wb_surface){0};
}

/* --- from fields --- */

/* Index of the k-th of `kept` evenly spaced items out of n. With `ends` the last item is included;
 * a closed ring needs no such item, because its first item follows its last. */
static int pick(int k, int kept, int n, bool ends)
{
    if (kept == n)
        return k;
    return ends ? (int)lround((double)k * (n - 1) / (kept - 1)) : (int)((long)k * n / kept);
}

static void take_body(struct wb_surface_body *body, const struct wb_bundle_fields *fields,
                      const struct wb_bundle_fields_body *from)
{
    const int around = from->is_tape ? from->n_nodes : from->n_outline;
    const int most = from->is_tape ? WB_SURFACE_AROUND_TAPE : WB_SURFACE_AROUND_WIRE;
    const int most_along = from->closed ? WB_SURFACE_ALONG : WB_SURFACE_ALONG_STRIP;

    body->is_tape = from->is_tape;
    body->closed = from->closed;
    body->n_around = around < most ? around : most;
    body->n_along = from->n_stations < most_along ? from->n_stations : most_along;
    body->nodes =
        wb_memory_new((size_t)body->n_along * (size_t)body->n_around, sizeof *body->nodes);
    for (int j = 0; j < body->n_along; j++) {
        const int station = pick(j, body->n_along, from->n_stations, true);
        for (int k = 0; k < body->n_around; k++) {
            const int place = pick(k, body->n_around, around, !body->closed);
            const int node = from->is_tape ? place : from->outline[place];
            const int point = from->first + station * from->n_nodes + node;
            struct wb_surface_node *out = &body->nodes[j * body->n_around + k];
            memcpy(out->position, fields->position[point], sizeof out->position);
            out->von_mises = fields->von_mises[point];
        }
    }
}

void wb_surface_take(struct wb_surface *surface, const struct wb_bundle_fields *fields)
{
    surface->n = fields->n_bodies;
    surface->bodies = wb_memory_new((size_t)surface->n, sizeof *surface->bodies);
    for (int b = 0; b < surface->n; b++)
        take_body(&surface->bodies[b], fields, &fields->bodies[b]);
}

/* --- writing --- */

static enum wb_status append_node(struct wb_text *text, const struct wb_surface_node *node)
{
    char rounded[WB_CSV_TABLE_NUMBER];

    for (int i = 0; i < VALUES; i++) {
        const double exact = i < 3 ? node->position[i] : node->von_mises;
        if (!isfinite(exact))
            return wb_fail(WB_ERR_DATA, "%s of a bundle's surface is not a finite number",
                           column_names[INTEGERS + i]);
        snprintf(rounded, sizeof rounded, i < 3 ? "%.6f" : "%.3e", exact);
        const double value = strtod(rounded, NULL);
        wb_text_append(text, ",");
        wb_csv_table_append_number(text, value == 0.0 ? 0.0 : value, value_shifts[i]);
    }
    wb_text_append(text, "\n");
    return WB_OK;
}

static enum wb_status format(const struct wb_surface *surface, struct wb_text *text)
{
    wb_csv_table_append_header(text, column_names, COLUMNS);
    for (int b = 0; b < surface->n; b++) {
        const struct wb_surface_body *body = &surface->bodies[b];
        for (int i = 0; i < body->n_along * body->n_around; i++) {
            wb_text_append(text, "%d,%s,%d,%d", b, kind_of(body), i / body->n_around,
                           i % body->n_around);
            WB_TRY(append_node(text, &body->nodes[i]));
        }
    }
    return WB_OK;
}

enum wb_status wb_surface_write(const struct wb_surface *surface, const char *folder)
{
    struct wb_text text = {0};

    if (surface->n == 0)
        return wb_csv_table_write(folder, file_name, NULL);
    enum wb_status status = format(surface, &text);
    if (status == WB_OK)
        status = wb_csv_table_write(folder, file_name, &text);
    wb_text_release(&text);
    return status;
}

/* --- reading --- */

struct reader {
    struct wb_surface *surface;
    int n_nodes; /* read so far of the last body */
    size_t capacity;
};

struct row {
    int body, station, node;
    bool is_tape, closed;
    struct wb_surface_node at;
};

static enum wb_status parse_row(const struct wb_csv_table *table, char *const *fields,
                                struct row *row)
{
    double values[VALUES];

    WB_TRY(wb_csv_table_integer(table, 0, fields, MOST_BODIES - 1, &row->body));
    WB_TRY(wb_csv_table_integer(table, 2, fields, MOST_NODES - 1, &row->station));
    WB_TRY(wb_csv_table_integer(table, 3, fields, MOST_NODES - 1, &row->node));
    const bool is_wire = strcmp(fields[1], "wire") == 0, is_tape = strcmp(fields[1], "tape") == 0;
    if (!is_wire && !is_tape && strcmp(fields[1], "strip") != 0)
        return wb_csv_table_refuse(table, 1, "wire, tape or strip", fields[1]);
    row->is_tape = !is_wire;
    row->closed = is_wire || is_tape;
    for (int i = 0; i < VALUES; i++)
        if (!wb_csv_table_parse_number(fields[INTEGERS + i], value_shifts[i], &values[i]) ||
            !(fabs(values[i]) <= most_values[i]))
            return wb_csv_table_refuse(table, INTEGERS + i, expected_values[i],
                                       fields[INTEGERS + i]);
    memcpy(row->at.position, values, sizeof row->at.position);
    row->at.von_mises = values[3];
    return WB_OK;
}

static bool has_extent(const struct wb_surface_body *body, int station)
{
    const struct wb_surface_node *node = &body->nodes[station * body->n_around];
    double largest = 0.0;

    for (int k = 1; k < body->n_around; k++)
        for (int i = 0; i < 3; i++)
            largest = fmax(largest, fabs(node[k].position[i] - node[0].position[i]));
    return largest >= least_extent;
}

/* Checks that the last body is complete: at least two stations of at least three nodes (strip:
 * two), and no degenerate end, which could not be drawn. */
static enum wb_status check_last(const struct reader *reader, const struct wb_csv_table *table)
{
    if (reader->surface->n == 0)
        return WB_OK;
    const struct wb_surface_body *body = &reader->surface->bodies[reader->surface->n - 1];
    const int least = body->closed ? 3 : 2;
    if (body->n_along >= 2 && body->n_around >= least &&
        reader->n_nodes == body->n_along * body->n_around) {
        if (has_extent(body, 0) && has_extent(body, body->n_along - 1))
            return WB_OK;
        return wb_csv_table_fail(table, "body %d: all nodes of its first or last station coincide",
                                 reader->surface->n - 1);
    }
    return wb_csv_table_fail(
        table,
        "body %d has %d nodes: expected at least 2 stations with the same number of nodes, at "
        "least %d",
        reader->surface->n - 1, reader->n_nodes, least);
}

static enum wb_status begin_body(struct reader *reader, const struct wb_csv_table *table,
                                 const struct row *row)
{
    struct wb_surface *surface = reader->surface;

    WB_TRY(check_last(reader, table));
    surface->bodies =
        wb_memory_resize(surface->bodies, (size_t)surface->n + 1, sizeof *surface->bodies);
    surface->bodies[surface->n++] =
        (struct wb_surface_body){.is_tape = row->is_tape, .closed = row->closed};
    reader->n_nodes = 0;
    reader->capacity = 0;
    return WB_OK;
}

/* Rows are sorted by body, station and node, without gaps. The number of nodes of the first
 * station applies to all stations of a body. */
static enum wb_status take_row(struct reader *reader, const struct wb_csv_table *table,
                               const struct row *row)
{
    struct wb_surface *surface = reader->surface;

    if (row->body == surface->n)
        WB_TRY(begin_body(reader, table, row));
    if (row->body != surface->n - 1)
        return wb_csv_table_fail(table, "body: expected %d next, not %d", surface->n, row->body);
    struct wb_surface_body *body = &surface->bodies[row->body];
    if (row->is_tape != body->is_tape || row->closed != body->closed)
        return wb_csv_table_fail(table, "%s: differs from the first row of the body",
                                 column_names[1]);
    if (row->station == 0)
        body->n_around = row->node + 1;
    body->n_along = row->station + 1;
    const long long place = (long long)row->station * body->n_around + row->node;
    if (row->node >= body->n_around || reader->n_nodes != place)
        return wb_csv_table_fail(table, "node: station %d, node %d is out of order", row->station,
                                 row->node);
    body->nodes = wb_memory_room(body->nodes, &reader->capacity, (size_t)reader->n_nodes + 1,
                                 sizeof *body->nodes);
    body->nodes[reader->n_nodes++] = row->at;
    return WB_OK;
}

static enum wb_status take_fields(void *context, const struct wb_csv_table *table,
                                  char *const *fields)
{
    struct reader *const reader = context;
    struct row row;

    WB_TRY(parse_row(table, fields, &row));
    return take_row(reader, table, &row);
}

static enum wb_status check_end(void *context, const struct wb_csv_table *table)
{
    return check_last(context, table);
}

enum wb_status wb_surface_read(struct wb_surface *surface, const char *folder,
                               struct wb_reason *why)
{
    struct wb_surface read = {0};
    struct reader reader = {.surface = &read};
    struct wb_csv_table table = {.n_columns = COLUMNS,
                                 .columns = column_names,
                                 .take = take_fields,
                                 .finish = check_end,
                                 .context = &reader,
                                 .why = why};
    const enum wb_status status = wb_csv_table_read(&table, folder, file_name);
    if (status != WB_OK)
        wb_surface_release(&read);
    *surface = read;
    return status;
}
