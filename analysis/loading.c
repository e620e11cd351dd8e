#include "analysis/loading.h"

#include <math.h>
#include <stdlib.h>

#include "base/units.h"

#define WB_LOG_DOMAIN "curve"

static int by_place(const void *a, const void *b)
{
    const double x = ((const struct wb_loading_point *)a)->at;
    const double y = ((const struct wb_loading_point *)b)->at;
    return (x > y) - (x < y);
}

static bool is_first_loading(const struct wb_row *row)
{
    return row->cycle == 1 && row->phase == WB_PHASE_LOAD;
}

/* Rows of the first loading: up to the largest force of a follower test, and up to the largest
 * deflection that is wanted. */
static size_t end_of_loading(const struct wb_dataset *dataset, double largest_deflection)
{
    const double limit = largest_deflection > 0.0 ? largest_deflection * (1.0 + 1e-9) : HUGE_VAL;
    double force = -HUGE_VAL;
    size_t end = 0;
    for (size_t i = 0; i < dataset->n_rows; i++) {
        const struct wb_row *const row = &dataset->rows[i];
        if (!is_first_loading(row))
            continue;
        if (row->deflection > limit)
            break;
        if (dataset->info.is_follower && !(row->force >= force))
            continue;
        force = row->force;
        end = i + 1;
    }
    return end;
}

static enum wb_status check_sense(const struct wb_dataset *dataset, double lowest, double highest,
                                  double step)
{
    if (dataset->info.is_follower || highest > 0.0 || !(lowest < -step))
        return WB_OK;
    return wb_fail(WB_ERR_DATA,
                   "wire '%s', sample %d: the first loading goes down to %.2f mm and never "
                   "above zero; is the sign of the deflection reversed?",
                   dataset->info.wire, dataset->info.sample, lowest / WB_MM);
}

enum wb_status wb_loading_extract(struct wb_loading *loading, const struct wb_dataset *dataset,
                                  const struct wb_curve_grid *grid)
{
    const char *const wire = dataset->info.wire;
    const int sample = dataset->info.sample;
    const bool follows = dataset->info.is_follower;
    const size_t end = end_of_loading(dataset, grid->largest_deflection);
    double highest = -HUGE_VAL, lowest = HUGE_VAL;
    loading->n = 0;
    loading->points = malloc((end + 1) * sizeof *loading->points);
    if (!loading->points)
        return wb_fail(WB_ERR_MEMORY, "no memory for %zu rows", end);
    for (size_t i = 0; i < end; i++) {
        const struct wb_row *const row = &dataset->rows[i];
        if (!is_first_loading(row))
            continue;
        if (!isfinite(row->deflection) || !isfinite(row->force))
            return wb_fail(WB_ERR_DATA,
                           "wire '%s', sample %d: row %zu has no finite deflection and force", wire,
                           sample, i + 1);
        highest = fmax(highest, row->deflection);
        lowest = fmin(lowest, row->deflection);
        /* Below zero the tip may still lie on its rest, where the force says nothing. */
        if (follows ? row->force < 0.0 : row->deflection < -0.25 * grid->step)
            continue;
        loading->points[loading->n++] =
            follows ? (struct wb_loading_point){row->force, row->deflection}
                    : (struct wb_loading_point){row->deflection, row->force};
    }
    WB_TRY(check_sense(dataset, lowest, highest, grid->step));
    if (loading->n < WB_LOADING_FEWEST_POINTS)
        return wb_fail(WB_ERR_DATA,
                       "wire '%s', sample %d: the first loading (cycle 1, phase load) has only %zu "
                       "rows, expected at least %d",
                       wire, sample, loading->n, WB_LOADING_FEWEST_POINTS);
    qsort(loading->points, loading->n, sizeof *loading->points, by_place);
    return WB_OK;
}

void wb_loading_release(struct wb_loading *loading)
{
    free(loading->points);
    *loading = (struct wb_loading){0};
}

/* Index of the first point at or above `at`; n when there is none. */
static size_t first_at_or_above(const struct wb_loading *loading, double at)
{
    size_t low = 0, high = loading->n;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (loading->points[middle].at < at)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Straight line through the points around `centre` with triangular weights, taken at `centre`.
 * False when they do not settle a value there: too few, or all on one side and far off. */
static bool fit_locally(const struct wb_loading *loading, double centre, double half, double *value)
{
    double weight_sum = 0.0, x_sum = 0.0, y_sum = 0.0, xx_sum = 0.0, xy_sum = 0.0;
    double nearest_below = HUGE_VAL, nearest_above = HUGE_VAL;
    int count = 0;
    for (size_t i = first_at_or_above(loading, centre - half); i < loading->n; i++) {
        const double x = loading->points[i].at - centre;
        const double y = loading->points[i].value;
        const double weight = 1.0 - fabs(x) / half;
        if (x >= half)
            break;
        if (weight <= 0.0)
            continue;
        weight_sum += weight;
        x_sum += weight * x;
        y_sum += weight * y;
        xx_sum += weight * x * x;
        xy_sum += weight * x * y;
        if (x <= 0.0)
            nearest_below = fmin(nearest_below, -x);
        if (x >= 0.0)
            nearest_above = fmin(nearest_above, x);
        count++;
    }
    if (count == 0)
        return false;
    const double x_mean = x_sum / weight_sum, y_mean = y_sum / weight_sum;
    const double spread = xx_sum / weight_sum - x_mean * x_mean;
    if (fabs(x_mean) < 1e-6 * half) {
        *value = y_mean;
        return true;
    }
    if (count < 3 || spread < 1e-3 * half * half)
        return false;
    const double nearest = fmin(nearest_below, nearest_above);
    if (fmax(nearest_below, nearest_above) > half && nearest > 0.3 * half)
        return false;
    const double slope = (xy_sum / weight_sum - x_mean * y_mean) / spread;
    *value = y_mean - slope * x_mean;
    return true;
}

/* Straight line between the rows before and after; a row right there is taken as it is. */
static bool interpolate_rows(const struct wb_loading *loading, double at, double longest,
                             double *value)
{
    const double near = 1e-6 * longest;
    const size_t above = first_at_or_above(loading, at - near);
    if (above < loading->n && loading->points[above].at <= at + near) {
        *value = loading->points[above].value;
        return true;
    }
    if (above == 0 || above == loading->n)
        return false;
    const struct wb_loading_point *const a = &loading->points[above - 1], *const b =
                                                                              &loading
                                                                                   ->points[above];
    const double gap = b->at - a->at;
    if (!(gap <= longest * (1.0 + 1e-9)) || gap <= 0.0)
        return false;
    *value = a->value + (b->value - a->value) * (at - a->at) / gap;
    return true;
}

bool wb_loading_value(const struct wb_loading *loading, int i, double step, double *value)
{
    /* At zero only one side has rows: a wider window holds the noise down there as well. */
    const double half = i == 0 ? 1.5 * step : step;
    return fit_locally(loading, i * step, half, value) ||
           interpolate_rows(loading, i * step, WB_LOADING_LONGEST_GAP * step, value);
}
