#include "analysis/curve.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"

#define WB_LOG_DOMAIN "curve"

/* Lengths of one kind agree within this, m. */
#define SAME_LENGTH (0.1 * WB_MM)
/* Fewer points than this are no curve. */
#define FEWEST_POINTS 10
/* A bin without rows is interpolated between rows this many steps apart at most: a marker hidden
 * for 1.5 s leaves 1.5 mm and a row at either end. */
#define LONGEST_GAP_STEPS 4.0

struct point {
    double deflection, force;
};

/* The first loading of one sample, by ascending deflection. */
struct loading {
    size_t n;
    struct point *points;
};

static int by_deflection(const void *a, const void *b)
{
    const double x = ((const struct point *)a)->deflection;
    const double y = ((const struct point *)b)->deflection;
    return (x > y) - (x < y);
}

static enum wb_status extract_loading(struct loading *loading, const struct wb_dataset *dataset,
                                      double step)
{
    const char *const wire = dataset->info.wire;
    const int sample = dataset->info.sample;
    double highest = -HUGE_VAL, lowest = HUGE_VAL;
    loading->n = 0;
    loading->points = malloc((dataset->n_rows + 1) * sizeof *loading->points);
    if (!loading->points)
        return wb_fail(WB_ERR_MEMORY, "no memory for %zu rows", dataset->n_rows);
    for (size_t i = 0; i < dataset->n_rows; i++) {
        const struct wb_row *const row = &dataset->rows[i];
        if (row->cycle != 1 || row->phase != WB_PHASE_LOAD)
            continue;
        if (!isfinite(row->deflection) || !isfinite(row->force))
            return wb_fail(WB_ERR_DATA,
                           "wire '%s', sample %d: row %zu has no finite deflection and force", wire,
                           sample, i + 1);
        highest = fmax(highest, row->deflection);
        lowest = fmin(lowest, row->deflection);
        /* Below zero the tip may still lie on its rest, where the force says nothing. */
        if (row->deflection < -0.25 * step)
            continue;
        loading->points[loading->n++] = (struct point){row->deflection, row->force};
    }
    if (!(highest > 0.0) && lowest < -step)
        return wb_fail(WB_ERR_DATA,
                       "wire '%s', sample %d: the first loading goes down to %.2f mm and never "
                       "above zero; is the sign of the deflection reversed?",
                       wire, sample, lowest / WB_MM);
    if (loading->n < FEWEST_POINTS)
        return wb_fail(WB_ERR_DATA,
                       "wire '%s', sample %d: the first loading (cycle 1, phase load) has only %zu "
                       "rows, expected at least %d",
                       wire, sample, loading->n, FEWEST_POINTS);
    qsort(loading->points, loading->n, sizeof *loading->points, by_deflection);
    return WB_OK;
}

/* Index of the first point at or above `deflection`; n when there is none. */
static size_t first_at_or_above(const struct loading *loading, double deflection)
{
    size_t low = 0, high = loading->n;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (loading->points[middle].deflection < deflection)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Straight line through the points around `centre` with triangular weights, taken at `centre`.
 * False when they do not settle a value there: too few, or all on one side and far off. */
static bool fit_locally(const struct loading *loading, double centre, double half, double *force)
{
    double weight_sum = 0.0, x_sum = 0.0, y_sum = 0.0, xx_sum = 0.0, xy_sum = 0.0;
    double nearest_below = HUGE_VAL, nearest_above = HUGE_VAL;
    int count = 0;
    for (size_t i = first_at_or_above(loading, centre - half); i < loading->n; i++) {
        const double x = loading->points[i].deflection - centre;
        const double y = loading->points[i].force;
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
        *force = y_mean;
        return true;
    }
    if (count < 3 || spread < 1e-3 * half * half)
        return false;
    const double nearest = fmin(nearest_below, nearest_above);
    if (fmax(nearest_below, nearest_above) > half && nearest > 0.3 * half)
        return false;
    const double slope = (xy_sum / weight_sum - x_mean * y_mean) / spread;
    *force = y_mean - slope * x_mean;
    return true;
}

/* Straight line between the rows before and after; a row right there is taken as it is. */
static bool interpolate_rows(const struct loading *loading, double at, double longest,
                             double *force)
{
    const double near = 1e-6 * longest;
    const size_t above = first_at_or_above(loading, at - near);
    if (above < loading->n && loading->points[above].deflection <= at + near) {
        *force = loading->points[above].force;
        return true;
    }
    if (above == 0 || above == loading->n)
        return false;
    const struct point *const a = &loading->points[above - 1], *const b = &loading->points[above];
    const double gap = b->deflection - a->deflection;
    if (!(gap <= longest * (1.0 + 1e-9)) || gap <= 0.0)
        return false;
    *force = a->force + (b->force - a->force) * (at - a->deflection) / gap;
    return true;
}

/* One sample's force at grid point i. */
static bool sample_force(const struct loading *loading, int i, double step, double *force)
{
    /* At zero only one side has rows: a wider window holds the noise down there as well. */
    const double half = i == 0 ? 1.5 * step : step;
    return fit_locally(loading, i * step, half, force) ||
           interpolate_rows(loading, i * step, LONGEST_GAP_STEPS * step, force);
}

static bool same(double a, double b, double relative)
{
    return fabs(a - b) <= relative * fmax(fabs(a), fabs(b));
}

bool wb_curve_same_kind(const struct wb_test_info *a, const struct wb_test_info *b)
{
    return strcmp(a->wire, b->wire) == 0 && fabs(a->length - b->length) <= SAME_LENGTH;
}

static enum wb_status check_same_test(const struct wb_test_info *a, const struct wb_test_info *b)
{
    if (!wb_curve_same_kind(a, b))
        return wb_fail(WB_ERR_DATA,
                       "datasets of different kinds cannot be averaged: wire '%s' of %.4g mm and "
                       "wire '%s' of %.4g mm",
                       a->wire, a->length / WB_MM, b->wire, b->length / WB_MM);
    if (!same(a->outer_diameter, b->outer_diameter, 1e-3) ||
        !same(a->strand_length, b->strand_length, 1e-3) ||
        !same(a->counterweight, b->counterweight, 1e-2) || !same(a->gravity, b->gravity, 1e-2) ||
        !same(a->mass_per_length, b->mass_per_length, 1e-2))
        return wb_fail(WB_ERR_DATA,
                       "datasets of wire '%s' were tested differently (diameter, strand, "
                       "counterweight, gravity or mass differ) and cannot be averaged",
                       a->wire);
    if (a->is_virtual != b->is_virtual)
        wb_warn("wire '%s': datasets of a virtual rig and others are averaged together", a->wire);
    return WB_OK;
}

static enum wb_status check_info(const struct wb_test_info *info)
{
    if (!(info->length > 0.0) || !(info->outer_diameter > 0.0) || !isfinite(info->length) ||
        !isfinite(info->outer_diameter))
        return wb_fail(WB_ERR_DATA, "wire '%s': length and outer diameter must be positive",
                       info->wire);
    return WB_OK;
}

static enum wb_status allocate(struct wb_curve *curve, int n)
{
    const size_t size = (size_t)n;
    memset(curve, 0, sizeof *curve);
    curve->n = n;
    curve->force = calloc(size, sizeof *curve->force);
    curve->low = calloc(size, sizeof *curve->low);
    curve->high = calloc(size, sizeof *curve->high);
    curve->deviation = calloc(size, sizeof *curve->deviation);
    if (!curve->force || !curve->low || !curve->high || !curve->deviation) {
        wb_curve_release(curve);
        return wb_fail(WB_ERR_MEMORY, "no memory for a curve of %d points", n);
    }
    return WB_OK;
}

/* Mean, range and standard deviation over the samples at one grid point. Two passes: the samples
 * differ by a few percent, where the one-pass sum of squares loses digits. */
static void combine(struct wb_curve *curve, int at, const double *values, int n)
{
    double sum = 0.0, low = values[0], high = values[0], squares = 0.0;
    for (int i = 0; i < n; i++) {
        sum += values[i];
        low = fmin(low, values[i]);
        high = fmax(high, values[i]);
    }
    const double mean = sum / n;
    for (int i = 0; i < n; i++)
        squares += (values[i] - mean) * (values[i] - mean);
    curve->force[at] = mean;
    curve->low[at] = low;
    curve->high[at] = high;
    curve->deviation[at] = n > 1 ? sqrt(squares / (n - 1)) : 0.0;
}

/* Grid points that every sample reaches. */
static int common_points(const struct loading *loadings, int n, double step)
{
    double largest = HUGE_VAL, ignored;
    for (int i = 0; i < n; i++)
        largest = fmin(largest, loadings[i].points[loadings[i].n - 1].deflection);
    int points = largest > 0.0 ? (int)fmin(floor(largest / step + 1e-6), 1e6) + 1 : 0;
    /* The last bins may hold nothing but a stray row beyond the turn. */
    for (int dropped = 0; dropped < 2 && points > 0; dropped++) {
        bool all = true;
        for (int i = 0; i < n; i++)
            all = all && sample_force(&loadings[i], points - 1, step, &ignored);
        if (all)
            break;
        points--;
    }
    return points;
}

static enum wb_status average(struct wb_curve *curve, const struct loading *loadings,
                              const struct wb_dataset *const *datasets, int n, double step)
{
    const int points = common_points(loadings, n, step);
    if (points < FEWEST_POINTS)
        return wb_fail(WB_ERR_DATA,
                       "wire '%s': the first loading reaches only %d points of %g mm in every "
                       "sample, expected at least %d",
                       datasets[0]->info.wire, points, step / WB_MM, FEWEST_POINTS);
    double *const values = malloc((size_t)n * sizeof *values);
    if (!values)
        return wb_fail(WB_ERR_MEMORY, "no memory for %d samples", n);
    enum wb_status status = allocate(curve, points);
    for (int k = 0; status == WB_OK && k < points; k++) {
        for (int i = 0; status == WB_OK && i < n; i++) {
            if (sample_force(&loadings[i], k, step, &values[i]))
                continue;
            const double begin = loadings[i].points[0].deflection;
            if (k * step < begin)
                status = wb_fail(WB_ERR_DATA,
                                 "wire '%s', sample %d: the first loading has no rows below %.2f "
                                 "mm, expected from zero deflection on (was the tip's rest too "
                                 "high, or the start lost?)",
                                 datasets[i]->info.wire, datasets[i]->info.sample, begin / WB_MM);
            else
                status = wb_fail(WB_ERR_DATA,
                                 "wire '%s', sample %d: no rows of the first loading around "
                                 "%.2f mm (a gap of more than %g steps of %g mm)",
                                 datasets[i]->info.wire, datasets[i]->info.sample, k * step / WB_MM,
                                 LONGEST_GAP_STEPS, step / WB_MM);
        }
        if (status == WB_OK)
            combine(curve, k, values, n);
    }
    free(values);
    if (status != WB_OK) {
        wb_curve_release(curve);
        return status;
    }
    curve->step = step;
    curve->n_samples = n;
    curve->max_deflection = (points - 1) * step;
    curve->max_force = curve->force[0];
    for (int k = 1; k < points; k++)
        curve->max_force = fmax(curve->max_force, curve->force[k]);
    return WB_OK;
}

enum wb_status wb_curve_average(struct wb_curve *curve, const struct wb_dataset *const *datasets,
                                int n, double step)
{
    struct wb_curve result = {0};
    if (n < 1 || !(step >= 0.0) || !isfinite(step))
        return wb_fail(WB_ERR_ARGUMENT, "averaging needs at least one dataset and a step >= 0");
    if (step == 0.0)
        step = 0.5 * WB_MM;
    for (int i = 0; i < n; i++) {
        WB_TRY(check_info(&datasets[i]->info));
        WB_TRY(check_same_test(&datasets[0]->info, &datasets[i]->info));
    }
    struct loading *const loadings = calloc((size_t)n, sizeof *loadings);
    if (!loadings)
        return wb_fail(WB_ERR_MEMORY, "no memory for %d samples", n);
    enum wb_status status = WB_OK;
    for (int i = 0; status == WB_OK && i < n; i++)
        status = extract_loading(&loadings[i], datasets[i], step);
    if (status == WB_OK)
        status = average(&result, loadings, datasets, n, step);
    for (int i = 0; i < n; i++)
        free(loadings[i].points);
    free(loadings);
    if (status == WB_OK)
        *curve = result;
    return status;
}

void wb_curve_release(struct wb_curve *curve)
{
    free(curve->force);
    free(curve->low);
    free(curve->high);
    free(curve->deviation);
    memset(curve, 0, sizeof *curve);
}

double wb_curve_force(const struct wb_curve *curve, double deflection)
{
    const double position = deflection / curve->step;
    if (!(position >= 0.0) || !(position <= (curve->n - 1) * (1.0 + 1e-12)))
        return (double)NAN;
    const int i = (int)fmin(floor(position), curve->n - 2);
    const double part = position - i;
    return (1.0 - part) * curve->force[i] + part * curve->force[i + 1];
}

double wb_curve_scatter(const struct wb_curve *curve)
{
    double sum = 0.5 * (curve->deviation[0] * curve->deviation[0] +
                        curve->deviation[curve->n - 1] * curve->deviation[curve->n - 1]);
    for (int i = 1; i < curve->n - 1; i++)
        sum += curve->deviation[i] * curve->deviation[i];
    return sqrt(sum / (curve->n - 1)) / curve->max_force;
}

static int known_shapes(const struct wb_dataset *const *datasets, int n)
{
    int known = 0;
    for (int i = 0; i < n; i++)
        known += datasets[i]->info.n_natural_shape > 0;
    return known;
}

void wb_curve_warn_unknown_shapes(const struct wb_dataset *const *datasets, int n)
{
    const int known = known_shapes(datasets, n);
    if (known > 0 && known < n)
        wb_warn("wire '%s': the natural shape of %d of %d samples is not known; the mean is that "
                "of the others",
                datasets[0]->info.wire, n - known, n);
}

void wb_curve_mean_info(const struct wb_dataset *const *datasets, int n, struct wb_test_info *info)
{
    struct wb_test_info mean = datasets[0]->info;
    const int size = (int)(sizeof mean.natural_shape / sizeof mean.natural_shape[0]);
    for (int k = 0; k < size; k++)
        mean.natural_shape[k] = 0.0;
    mean.n_natural_shape = 0;
    const int known = known_shapes(datasets, n);
    for (int i = 0; i < n; i++) {
        const struct wb_test_info *const one = &datasets[i]->info;
        for (int k = 0; k < one->n_natural_shape && k < size; k++)
            mean.natural_shape[k] += one->natural_shape[k] / known;
        if (one->n_natural_shape > mean.n_natural_shape)
            mean.n_natural_shape = one->n_natural_shape;
        mean.is_virtual = mean.is_virtual || one->is_virtual;
        mean.is_simulation = mean.is_simulation || one->is_simulation;
    }
    if (n > 1)
        mean.sample = 0;
    *info = mean;
}

int wb_curve_group(const struct wb_dataset *const *datasets, int n, int *group)
{
    int groups = 0;
    for (int i = 0; i < n; i++) {
        group[i] = -1;
        for (int k = 0; k < i && group[i] < 0; k++) {
            if (wb_curve_same_kind(&datasets[k]->info, &datasets[i]->info))
                group[i] = group[k];
        }
        if (group[i] < 0)
            group[i] = groups++;
    }
    return groups;
}
