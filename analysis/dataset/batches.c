#include "analysis/dataset/batches.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/dataset/fit.h"
#include "base/memory.h"
#include "base/random.h"

enum {
    LEAST_GROUP = 2,
    DRAWN = 4000, /* samples */
    SEED = 1969
};

/* The best split of sorted numbers: the square between the groups over that within. */
static struct wb_batches split(const double *sorted, int n)
{
    struct wb_batches best = {.ratio = 0.0};
    double sum = 0.0, squares = 0.0, lower = 0.0;
    for (int i = 0; i < n; i++)
        sum += sorted[i];
    for (int i = 0; i < n; i++)
        squares += (sorted[i] - sum / n) * (sorted[i] - sum / n);
    for (int k = 1; k <= n - LEAST_GROUP; k++) {
        lower += sorted[k - 1];
        if (k < LEAST_GROUP)
            continue;
        const double apart = (sum - lower) / (n - k) - lower / k;
        const double between = apart * apart * k * (n - k) / n;
        const double within = fmax(squares - between, 1e-12 * squares);
        if (between / within > best.ratio) {
            best.ratio = between / within;
            best.apart = apart;
            best.border = 0.5 * (sorted[k - 1] + sorted[k]);
        }
    }
    return best;
}

struct wb_batches wb_batches_find(const double *numbers, int n, double level)
{
    if (n < WB_BATCHES_LEAST)
        return (struct wb_batches){.limit = (double)INFINITY};
    double *const sorted = wb_memory_new((size_t)n, sizeof *sorted);
    double *const ratios = wb_memory_new(DRAWN, sizeof *ratios);
    for (int i = 0; i < DRAWN; i++) {
        for (int k = 0; k < n; k++)
            sorted[k] = wb_random_normal(SEED, (uint64_t)i, (uint64_t)k);
        wb_fit_sort(sorted, (size_t)n);
        ratios[i] = split(sorted, n).ratio;
    }
    wb_fit_sort(ratios, DRAWN);
    memcpy(sorted, numbers, (size_t)n * sizeof *sorted);
    wb_fit_sort(sorted, (size_t)n);
    struct wb_batches found = split(sorted, n);
    found.limit = ratios[(int)((1.0 - level) * DRAWN)];
    found.are_two = found.ratio > found.limit;
    free(sorted);
    free(ratios);
    return found;
}
