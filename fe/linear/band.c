#include "fe/linear/band.h"

#include <math.h>
#include <string.h>

void wb_band_clear(struct wb_band *band)
{
    memset(band->values, 0,
           (size_t)band->n * (size_t)wb_band_row(band->width) * sizeof *band->values);
}

/* The diagonal entry serves as pivot if it is at least this fraction of the largest entry of its
 * column. */
static const double large_enough = 0.1;

static double *row_of(const struct wb_band *band, int row)
{
    return band->values + (size_t)row * (size_t)wb_band_row(band->width);
}

void wb_band_hold(struct wb_band *band, int row, double value, double *b)
{
    const int w = band->width;
    for (int i = row - w; i <= row + w; i++) {
        if (i < 0 || i >= band->n)
            continue;
        b[i] -= value * row_of(band, i)[row - i + w];
        row_of(band, i)[row - i + w] = 0.0;
        row_of(band, row)[i - row + w] = 0.0;
    }
    row_of(band, row)[w] = 1.0;
    b[row] = value;
}

/* row -= factor times pivot, n entries. */
static void subtract(double *restrict row, const double *restrict pivot, double factor, int n)
{
    for (int j = 0; j < n; j++)
        row[j] -= factor * pivot[j];
}

static bool scale_row(double *row, int n, double *b)
{
    double largest = 0.0;
    for (int j = 0; j < n; j++)
        largest = fabs(row[j]) > largest ? fabs(row[j]) : largest;
    if (!(largest > 0.0) || !isfinite(largest))
        return false;
    const double factor = 1.0 / largest;
    for (int j = 0; j < n; j++)
        row[j] *= factor;
    *b *= factor;
    return true;
}

/* The row from k to `last` with the pivot for column k: row k itself unless its entry is small,
 * because an exchange increases the bandwidth. */
static int find_pivot(const struct wb_band *band, int k, int last)
{
    const int w = band->width;
    const double own = fabs(row_of(band, k)[w]);
    double largest = own;
    int pivot = k;
    for (int i = k + 1; i <= last; i++) {
        const double size = fabs(row_of(band, i)[k - i + w]);
        if (size > largest) {
            largest = size;
            pivot = i;
        }
    }
    return own >= large_enough * largest ? k : pivot;
}

/* Entry j of a row of band storage belongs to column row - width + j. Elimination of column k
 * changes rows k .. k + width. The pivot's row is filled up to column `reach`, at most k + 2 width;
 * without row exchanges it stays at the row's own end, k + width. */
static inline bool solve(struct wb_band *band, double *b, const int w)
{
    const int n = band->n;
    int reach = 0;

    for (int i = 0; i < n; i++) {
        if (!scale_row(row_of(band, i), 2 * w + 1, &b[i]))
            return false;
    }
    for (int k = 0; k < n; k++) {
        const int last = k + w < n - 1 ? k + w : n - 1;
        const int pivot = find_pivot(band, k, last);
        const int end = pivot + w < n - 1 ? pivot + w : n - 1;
        double *P = row_of(band, k);
        reach = end > reach ? end : reach;
        if (pivot != k) {
            double *Q = row_of(band, pivot);
            for (int j = k; j <= reach; j++) {
                /* The pivot's row has space up to column pivot + 2 width, which is not before
                 * `reach`. */
                const double kept = P[j - k + w];
                P[j - k + w] = Q[j - pivot + w];
                Q[j - pivot + w] = kept;
            }
            const double kept = b[k];
            b[k] = b[pivot];
            b[pivot] = kept;
        }
        if (!(fabs(P[w]) > 0.0))
            return false;
        const double inverse = 1.0 / P[w];
        P[w] = inverse;
        for (int i = k + 1; i <= last; i++) {
            double *Q = row_of(band, i) + (k - i + w);
            const double factor = Q[0] * inverse;
            if (factor == 0.0)
                continue;
            if (reach - k == w)
                subtract(Q + 1, P + w + 1, factor, w);
            else
                subtract(Q + 1, P + w + 1, factor, reach - k);
            b[i] -= factor * b[k];
        }
    }
    for (int k = n - 1; k >= 0; k--) {
        const double *P = row_of(band, k);
        const int right = k + 2 * w < n - 1 ? k + 2 * w : n - 1;
        double sum = b[k];
        for (int j = k + 1; j <= right; j++)
            sum -= P[j - k + w] * b[j];
        b[k] = sum * P[w];
        if (!isfinite(b[k]))
            return false;
    }
    return true;
}

bool wb_band_solve(struct wb_band *band, double *b)
{
    /* The width of a beam's band is a constant, so that the compiler can unroll the loops. */
    return band->width == 8 ? solve(band, b, 8) : solve(band, b, band->width);
}
