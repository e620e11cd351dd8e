#include "fe/linear/band.h"

#include <math.h>
#include <string.h>

void wb_band_clear(struct wb_band *band)
{
    memset(band->values, 0,
           (size_t)band->n * (size_t)wb_band_row(band->width) * sizeof *band->values);
}

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

/* Entry j of a row of band storage is of column row - width + j. Elimination of column k works on
 * rows k .. k + width, whose entries from column k to k + 2 width may be filled. */
bool wb_band_solve(struct wb_band *band, double *b)
{
    const int n = band->n, w = band->width, length = wb_band_row(w);

    for (int i = 0; i < n; i++) {
        double *row = row_of(band, i), largest = 0.0;
        for (int j = 0; j <= 2 * w; j++)
            largest = fmax(largest, fabs(row[j]));
        if (!(largest > 0.0) || !isfinite(largest))
            return false;
        for (int j = 0; j < length; j++)
            row[j] /= largest;
        b[i] /= largest;
    }
    for (int k = 0; k < n; k++) {
        const int last = k + w < n - 1 ? k + w : n - 1;
        const int right = k + 2 * w < n - 1 ? k + 2 * w : n - 1;
        int pivot = k;
        for (int i = k + 1; i <= last; i++) {
            if (fabs(row_of(band, i)[k - i + w]) > fabs(row_of(band, pivot)[k - pivot + w]))
                pivot = i;
        }
        double *P = row_of(band, k);
        if (pivot != k) {
            double *Q = row_of(band, pivot);
            for (int j = k; j <= right; j++) {
                /* The pivot's row ends at column pivot + 2 width, which is never before `right`. */
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
        for (int i = k + 1; i <= last; i++) {
            double *Q = row_of(band, i);
            const double factor = Q[k - i + w] / P[w];
            if (factor == 0.0)
                continue;
            for (int j = k + 1; j <= right; j++)
                Q[j - i + w] -= factor * P[j - k + w];
            b[i] -= factor * b[k];
        }
    }
    for (int k = n - 1; k >= 0; k--) {
        const double *P = row_of(band, k);
        const int right = k + 2 * w < n - 1 ? k + 2 * w : n - 1;
        double sum = b[k];
        for (int j = k + 1; j <= right; j++)
            sum -= P[j - k + w] * b[j];
        b[k] = sum / P[w];
        if (!isfinite(b[k]))
            return false;
    }
    return true;
}
