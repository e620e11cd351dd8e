#include "base/columns.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

enum {
    FIRST_ROWS = 64
};

void wb_columns_init(struct wb_columns *table, const char *name, const struct wb_column_kind *kinds,
                     int n)
{
    *table = (struct wb_columns){.name = name, .n = n};
    for (int i = 0; i < n; i++)
        table->items[i].kind = &kinds[i];
}

/* All three kinds of values have the same size. */
_Static_assert(sizeof(double) == sizeof(int64_t), "doubles of 64 bits");
_Static_assert(sizeof(char *) <= sizeof(int64_t), "pointers of at most 64 bits");

static void grow(struct wb_columns *table)
{
    const size_t capacity = table->capacity ? 2 * table->capacity : FIRST_ROWS;
    for (int i = 0; i < table->n; i++)
        table->items[i].reals = wb_memory_resize(table->items[i].reals, capacity, sizeof(double));
    table->capacity = capacity;
}

void wb_columns_add_row(struct wb_columns *table, const union wb_cell *cells)
{
    if (table->n_rows == table->capacity)
        grow(table);
    const size_t row = table->n_rows++;
    for (int i = 0; i < table->n; i++) {
        struct wb_column *const column = &table->items[i];
        switch (column->kind->type) {
        case WB_COLUMN_REAL:
            column->reals[row] = cells[i].real;
            break;
        case WB_COLUMN_INTEGER:
            column->integers[row] = cells[i].integer;
            break;
        case WB_COLUMN_TEXT:
            column->texts[row] = wb_memory_text(cells[i].text);
            break;
        }
    }
}

const struct wb_column *wb_columns_find(const struct wb_columns *table, const char *name)
{
    for (int i = 0; i < table->n; i++) {
        if (strcmp(table->items[i].kind->name, name) == 0)
            return &table->items[i];
    }
    return NULL;
}

void wb_columns_release(struct wb_columns *table)
{
    for (int i = 0; i < table->n; i++) {
        struct wb_column *const column = &table->items[i];
        for (size_t row = 0; column->kind->type == WB_COLUMN_TEXT && row < table->n_rows; row++)
            free(column->texts[row]);
        free(column->reals);
    }
    *table = (struct wb_columns){0};
}
