/* General banded systems, solved by LU factorisation with partial pivoting: for contact with
 * friction, whose tangents are not symmetric. For symmetric chains fe/linear/banded.h needs a third
 * of the time.
 */
#ifndef WB_FE_LINEAR_BAND_H
#define WB_FE_LINEAR_BAND_H

#include <stdbool.h>
#include <stddef.h>

struct wb_band {
    int n;          /* unknowns */
    int width;      /* number of diagonals on each side of the main one */
    double *values; /* (n x wb_band_row(width)); set by wb_band_add() */
};

/* Number of doubles in a row: the band, and space for fill-in from pivoting. */
static inline int wb_band_row(int width)
{
    return 3 * width + 1;
}

/* All entries zero. */
void wb_band_clear(struct wb_band *band);

/* A[row][column] += value, within the band. */
static inline void wb_band_add(struct wb_band *band, int row, int column, double value)
{
    band->values[(size_t)row * (size_t)wb_band_row(band->width) +
                 (size_t)(column - row + band->width)] += value;
}

/* Replaces equation `row` of A x = b by x[row] = value and moves the terms of the unknown in other
 * equations to the right-hand side. */
void wb_band_hold(struct wb_band *band, int row, double value, double *b);

/* Solves A x = b; `b` becomes x, the matrix is destroyed. Rows are scaled by their largest entry,
 * so equations may have different units. False if the matrix is singular or not finite. */
bool wb_band_solve(struct wb_band *band, double *b);

#endif
