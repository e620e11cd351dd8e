#include "analysis/plot/place.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"

static const double cell = 1.5; /* pt */

struct wb_place {
    double width, height;
    int columns, rows;
    unsigned char *taken; /* (rows x columns) */
};

struct wb_place *wb_place_create(double width, double height)
{
    struct wb_place *const place = wb_memory_new(1, sizeof *place);
    place->width = width;
    place->height = height;
    place->columns = (int)fmax(1.0, ceil(width / cell));
    place->rows = (int)fmax(1.0, ceil(height / cell));
    place->taken = wb_memory_new((size_t)place->columns * (size_t)place->rows, 1);
    return place;
}

void wb_place_destroy(struct wb_place *place)
{
    if (!place)
        return;
    free(place->taken);
    free(place);
}

/* The cell that holds a coordinate, kept within -1..n so that far points cost nothing. */
static int cell_of(double coordinate, int n)
{
    const double index = floor(coordinate / cell);
    return index < -1.0 ? -1 : index > n ? n : (int)index;
}

void wb_place_mark_box(struct wb_place *place, const struct wb_place_box *box)
{
    if (!isfinite(box->x + box->y + box->width + box->height))
        return;
    const int left = cell_of(box->x, place->columns);
    const int right = cell_of(box->x + box->width, place->columns);
    const int top = cell_of(box->y, place->rows);
    const int bottom = cell_of(box->y + box->height, place->rows);
    for (int row = top < 0 ? 0 : top; row <= bottom && row < place->rows; row++) {
        for (int column = left < 0 ? 0 : left; column <= right && column < place->columns; column++)
            place->taken[row * place->columns + column] = 1;
    }
}

/* Cuts a segment to the plot and a margin (Liang and Barsky); false when nothing is left. */
static bool cut(const struct wb_place *place, double margin, double p[4])
{
    const double dx = p[2] - p[0], dy = p[3] - p[1];
    const double steps[4] = {-dx, dx, -dy, dy};
    const double room[4] = {p[0] + margin, place->width + margin - p[0], p[1] + margin,
                            place->height + margin - p[1]};
    double from = 0.0, to = 1.0;
    for (int i = 0; i < 4; i++) {
        if (steps[i] == 0.0) {
            if (room[i] < 0.0)
                return false;
            continue;
        }
        const double where = room[i] / steps[i];
        if (steps[i] < 0.0)
            from = fmax(from, where);
        else
            to = fmin(to, where);
    }
    if (from > to)
        return false;
    p[2] = p[0] + to * dx;
    p[3] = p[1] + to * dy;
    p[0] += from * dx;
    p[1] += from * dy;
    return true;
}

void wb_place_mark_segment(struct wb_place *place, double x0, double y0, double x1, double y1,
                           double half_width)
{
    double p[4] = {x0, y0, x1, y1};
    if (!isfinite(x0 + y0 + x1 + y1) || !cut(place, half_width + cell, p))
        return;
    const double length = hypot(p[2] - p[0], p[3] - p[1]);
    const int n = (int)ceil(length / (0.5 * cell));
    for (int i = 0; i <= n; i++) {
        const double part = n > 0 ? (double)i / n : 0.0;
        const double reach = half_width + 0.5 * cell;
        const struct wb_place_box spot = {p[0] + part * (p[2] - p[0]) - reach,
                                          p[1] + part * (p[3] - p[1]) - reach, 2.0 * reach,
                                          2.0 * reach};
        wb_place_mark_box(place, &spot);
    }
}

/* sums[r][c]: marked cells above row r and left of column c. */
static int *sum_table(const struct wb_place *place)
{
    const int stride = place->columns + 1;
    int *const sums = wb_memory_new((size_t)stride * (size_t)(place->rows + 1), sizeof *sums);
    for (int row = 0; row < place->rows; row++) {
        for (int column = 0; column < place->columns; column++)
            sums[(row + 1) * stride + column + 1] =
                place->taken[row * place->columns + column] + sums[row * stride + column + 1] +
                sums[(row + 1) * stride + column] - sums[row * stride + column];
    }
    return sums;
}

struct window {
    int row, column, rows, columns;
};

static bool is_free(const struct wb_place *place, const int *sums, const struct window *window)
{
    const int stride = place->columns + 1;
    const int bottom = window->row + window->rows, right = window->column + window->columns;
    if (window->row < 0 || window->column < 0 || bottom > place->rows || right > place->columns)
        return false;
    return sums[bottom * stride + right] - sums[window->row * stride + right] -
               sums[bottom * stride + window->column] +
               sums[window->row * stride + window->column] ==
           0;
}

static int larger_of(int a, int b)
{
    return a > b ? a : b;
}

/* How many cells a window in a corner can grow on all sides before it meets data. */
static int clearance(const struct wb_place *place, const int *sums, const struct window *window)
{
    for (int growth = 0;; growth++) {
        const int top = larger_of(0, window->row - growth);
        const int left = larger_of(0, window->column - growth);
        const int below = larger_of(0, place->rows - window->row - window->rows - growth);
        const int beside = larger_of(0, place->columns - window->column - window->columns - growth);
        const struct window larger = {top, left, place->rows - top - below,
                                      place->columns - left - beside};
        if (!is_free(place, sums, &larger))
            return growth;
        if (larger.rows == place->rows && larger.columns == place->columns)
            return growth;
    }
}

static bool best_corner(const struct wb_place *place, const int *sums, struct window *window)
{
    /* Upper left, lower right, upper right, lower left: the first wins a tie. */
    static const int bottoms[] = {0, 1, 0, 1}, rights[] = {0, 1, 1, 0};
    struct window best = *window;
    int most = -1;
    for (int i = 0; i < 4; i++) {
        struct window candidate = *window;
        candidate.row = bottoms[i] ? place->rows - window->rows : 0;
        candidate.column = rights[i] ? place->columns - window->columns : 0;
        if (!is_free(place, sums, &candidate))
            continue;
        const int room = clearance(place, sums, &candidate);
        if (room > most) {
            most = room;
            best = candidate;
        }
    }
    *window = best;
    return most >= 0;
}

static bool nearest_spot(const struct wb_place *place, const int *sums, struct window *window)
{
    const int last_row = place->rows - window->rows, last_column = place->columns - window->columns;
    double least = hypot(place->rows, place->columns) / 3.0;
    struct window best = *window;
    bool found = false;
    for (int row = 0; row <= last_row; row++) {
        for (int column = 0; column <= last_column; column++) {
            const struct window candidate = {row, column, window->rows, window->columns};
            const double distance =
                hypot(row < last_row - row ? row : last_row - row,
                      column < last_column - column ? column : last_column - column);
            if (distance < least && is_free(place, sums, &candidate)) {
                least = distance;
                best = candidate;
                found = true;
            }
        }
    }
    *window = best;
    return found;
}

bool wb_place_find(const struct wb_place *place, double width, double height, double gap,
                   struct wb_place_box *box)
{
    struct window window = {.rows = (int)ceil((height + 2.0 * gap) / cell),
                            .columns = (int)ceil((width + 2.0 * gap) / cell)};
    if (window.rows > place->rows || window.columns > place->columns)
        return false;
    int *const sums = sum_table(place);
    const bool found = best_corner(place, sums, &window) || nearest_spot(place, sums, &window);
    free(sums);
    if (!found)
        return false;
    /* Cells may stick out of the plot by a part of one. */
    const double x = window.column * cell + gap, y = window.row * cell + gap;
    *box = (struct wb_place_box){fmin(x, place->width - width - gap),
                                 fmin(y, place->height - height - gap), width, height};
    return true;
}
