#include "analysis/dataset/curve.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/dataset/errors.h"
#include "analysis/dataset/fit.h"
#include "analysis/dataset/stops.h"
#include "base/memory.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "curve"

/* Lengths of one kind agree within this, m. */
#define SAME_LENGTH (0.1 * WB_MM)
/* Largest number of force steps of a follower test, unless set otherwise. */
#define MOST_FORCE_STEPS 100
/* Least number of points of a curve. */
#define FEWEST_POINTS 10
/* A bin without rows is interpolated between rows at most this many steps apart: a marker that is
 * hidden for 1.5 s leaves a gap of 1.5 mm, plus a row at either end. */
#define LONGEST_GAP 4.0

/* --- the first loading of a sample --- */

/* `at`: abscissa, on the grid; `value`: ordinate of the curve. */
struct loading_point {
    double at, value;
};

/* The first loading of one sample as points of its curve: force over deflection, or deflection over
 * force of a follower test. */
struct loading {
    size_t n;
    struct loading_point *points; /* (n) by ascending `at`; owned */
};

static int by_place(const void *a, const void *b)
{
    const double x = ((const struct loading_point *)a)->at;
    const double y = ((const struct loading_point *)b)->at;
    return (x > y) - (x < y);
}

static bool is_first_loading(const struct wb_row *row)
{
    return row->cycle == 1 && row->phase == WB_PHASE_LOAD;
}

size_t wb_curve_end_of_loading(const struct wb_dataset *dataset, double largest_deflection)
{
    const double limit = largest_deflection > 0.0 ? largest_deflection * (1.0 + 1e-9) : HUGE_VAL;
    double force = -HUGE_VAL, arrival = HUGE_VAL;
    struct wb_stop stop;
    size_t end = 0;
    /* The force falls in a dwell at the turn. */
    if (!dataset->info.is_follower && wb_stops_at_turn(dataset, 1, &stop))
        arrival = stop.arrival;
    for (size_t i = 0; i < dataset->n_rows; i++) {
        const struct wb_row *const row = &dataset->rows[i];
        if (!is_first_loading(row))
            continue;
        if (row->deflection > limit || row->t > arrival)
            break;
        if (dataset->info.is_follower && !(row->force >= force))
            continue;
        force = row->force;
        end = i + 1;
    }
    return end;
}

static enum wb_status check_sense(const struct wb_dataset *dataset, double lowest, double highest,
                                  double step, struct wb_reason *why)
{
    if (dataset->info.is_follower || highest > 0.0 || !(lowest < -step))
        return WB_OK;
    return wb_fail_to(why, WB_ERR_DATA,
                      "wire '%s', sample %d: the first loading goes down to %.2f mm and never "
                      "above zero; is the sign of the deflection reversed?",
                      dataset->info.wire, dataset->info.sample, lowest / WB_MM);
}

/* Collects the rows of the first loading up to the grid's largest deflection, or of a follower test
 * up to its largest force. WB_ERR_DATA when they form no curve; the sample must be released in that
 * case, too. */
static enum wb_status extract_loading(struct loading *loading, const struct wb_dataset *dataset,
                                      const struct wb_curve_grid *grid, struct wb_reason *why)
{
    const char *const wire = dataset->info.wire;
    const int sample = dataset->info.sample;
    const bool follows = dataset->info.is_follower;
    const size_t end = wb_curve_end_of_loading(dataset, grid->largest_deflection);
    double highest = -HUGE_VAL, lowest = HUGE_VAL;
    loading->n = 0;
    loading->points = wb_memory_new(end + 1, sizeof *loading->points);
    for (size_t i = 0; i < end; i++) {
        const struct wb_row *const row = &dataset->rows[i];
        if (!is_first_loading(row))
            continue;
        if (!isfinite(row->deflection) || !isfinite(row->force))
            return wb_fail_to(why, WB_ERR_DATA,
                              "wire '%s', sample %d: row %zu has no finite deflection and force",
                              wire, sample, i + 1);
        highest = fmax(highest, row->deflection);
        lowest = fmin(lowest, row->deflection);
        /* Below zero the tip may still lie on its rest, and the force contains no information about
         * the wire. */
        if (follows ? row->force < 0.0 : row->deflection < -0.25 * grid->step)
            continue;
        loading->points[loading->n++] = follows
                                            ? (struct loading_point){row->force, row->deflection}
                                            : (struct loading_point){row->deflection, row->force};
    }
    WB_TRY(check_sense(dataset, lowest, highest, grid->step, why));
    if (loading->n < FEWEST_POINTS)
        return wb_fail_to(
            why, WB_ERR_DATA,
            "wire '%s', sample %d: the first loading (cycle 1, phase load) has only %zu "
            "rows, expected at least %d",
            wire, sample, loading->n, FEWEST_POINTS);
    qsort(loading->points, loading->n, sizeof *loading->points, by_place);
    return WB_OK;
}

/* Accepts a zeroed one. */
static void release_loading(struct loading *loading)
{
    free(loading->points);
    *loading = (struct loading){0};
}

/* Index of the first point at or above `at`; n when there is none. */
static size_t first_at_or_above(const struct loading *loading, double at)
{
    return wb_fit_first_at(&loading->points->at, sizeof *loading->points, loading->n, at);
}

/* Straight line through the points around `centre` with triangular weights, evaluated at `centre`.
 * False when the points do not determine it: too few, or all on one side and too far away. */
static bool fit_locally(const struct loading *loading, double centre, double half, double *value)
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

/* Interpolates linearly between the rows before and after; a row exactly at the place is returned
 * as it is. */
static bool interpolate_rows(const struct loading *loading, double at, double longest,
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
    const struct loading_point *const a = &loading->points[above - 1];
    const struct loading_point *const b = &loading->points[above];
    const double gap = b->at - a->at;
    if (!(gap <= longest * (1.0 + 1e-9)) || gap <= 0.0)
        return false;
    *value = a->value + (b->value - a->value) * (at - a->at) / gap;
    return true;
}

/* Value at grid point i by a straight line fitted to the points around it, or by interpolation
 * between the nearest. False where no points are near enough. */
static bool loading_value(const struct loading *loading, int i, double step, double *value)
{
    /* At zero only one side has rows: a wider window keeps the noise low there. */
    const double half = i == 0 ? 1.5 * step : step;
    return fit_locally(loading, i * step, half, value) ||
           interpolate_rows(loading, i * step, LONGEST_GAP * step, value);
}

/* --- the average --- */

/* Unit of the abscissa, for messages. */
struct axis {
    const char *unit;
    double size; /* of the unit */
};

static struct axis axis_of(const struct wb_test_info *info)
{
    return info->is_follower ? (struct axis){"N", 1.0} : (struct axis){"mm", WB_MM};
}

static bool same(double a, double b, double relative)
{
    return fabs(a - b) <= relative * fmax(fabs(a), fabs(b));
}

/* Same wire, length and loading: tests that may be averaged. */
static bool same_band(const struct wb_band *a, const struct wb_band *b)
{
    return a->known == b->known && (!a->known || (a->least == b->least && a->most == b->most));
}

static bool same_bench(const struct wb_machine *a, const struct wb_machine *b)
{
    return a->roller_radius == b->roller_radius && same_band(&a->nose_radius, &b->nose_radius) &&
           same_band(&a->friction, &b->friction) && same_band(&a->compliance, &b->compliance);
}

static bool same_kind(const struct wb_test_info *a, const struct wb_test_info *b)
{
    return strcmp(a->wire, b->wire) == 0 && fabs(a->length - b->length) <= SAME_LENGTH &&
           a->is_follower == b->is_follower && a->kind == b->kind &&
           (a->kind != WB_TEST_THREE_POINT || same_bench(&a->machine, &b->machine));
}

static enum wb_status check_same_test(const struct wb_test_info *a, const struct wb_test_info *b,
                                      struct wb_reason *why)
{
    if (!same_kind(a, b))
        return wb_fail_to(
            why, WB_ERR_DATA,
            "datasets of different kinds cannot be averaged: wire '%s' of %.4g mm%s and "
            "wire '%s' of %.4g mm%s",
            a->wire, a->length / WB_MM, a->is_follower ? " under a follower force" : "", b->wire,
            b->length / WB_MM, b->is_follower ? " under a follower force" : "");
    if (!same(a->outer_diameter, b->outer_diameter, 1e-3) ||
        !same(a->strand_length, b->strand_length, 1e-3) ||
        !same(a->counterweight, b->counterweight, 1e-2) || !same(a->gravity, b->gravity, 1e-2) ||
        !same(a->mass_per_length, b->mass_per_length, 1e-2))
        return wb_fail_to(why, WB_ERR_DATA,
                          "datasets of wire '%s' were tested differently (diameter, strand, "
                          "counterweight, gravity or mass differ) and cannot be averaged",
                          a->wire);
    if (a->is_virtual != b->is_virtual)
        wb_warn("wire '%s': datasets of a virtual rig and others are averaged together", a->wire);
    return WB_OK;
}

static enum wb_status check_info(const struct wb_test_info *info, struct wb_reason *why)
{
    if (!(info->length > 0.0) || !(info->outer_diameter > 0.0) || !isfinite(info->length) ||
        !isfinite(info->outer_diameter))
        return wb_fail_to(why, WB_ERR_DATA, "wire '%s': length and outer diameter must be positive",
                          info->wire);
    if (info->is_general)
        return wb_fail_to(
            why, WB_ERR_DATA,
            "wire '%s': its loads are not those of a bending test, of which a curve can "
            "be made",
            info->wire);
    return WB_OK;
}

static void allocate(struct wb_curve *curve, int n)
{
    const size_t size = (size_t)n;
    memset(curve, 0, sizeof *curve);
    curve->n = n;
    curve->value = wb_memory_new(size, sizeof *curve->value);
    curve->low = wb_memory_new(size, sizeof *curve->low);
    curve->high = wb_memory_new(size, sizeof *curve->high);
    curve->deviation = wb_memory_new(size, sizeof *curve->deviation);
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
    curve->value[at] = mean;
    curve->low[at] = low;
    curve->high[at] = high;
    curve->deviation[at] = n > 1 ? sqrt(squares / (n - 1)) : 0.0;
}

/* Abscissa up to which all samples reach. */
static double common_end(const struct loading *loadings, int n)
{
    double end = HUGE_VAL;
    for (int i = 0; i < n; i++)
        end = fmin(end, loadings[i].points[loadings[i].n - 1].at);
    return end;
}

/* Grid points that every sample reaches. */
static int common_points(const struct loading *loadings, int n, double step)
{
    const double largest = common_end(loadings, n);
    double ignored;
    int points = largest > 0.0 ? (int)fmin(floor(largest / step + 1e-6), 1e6) + 1 : 0;
    /* The last bins may contain only a stray row beyond the turn. */
    for (int dropped = 0; dropped < 2 && points > 0; dropped++) {
        bool all = true;
        for (int i = 0; i < n; i++)
            all = all && loading_value(&loadings[i], points - 1, step, &ignored);
        if (all)
            break;
        points--;
    }
    return points;
}

/* Fails with the reason why a grid point has no value. */
static enum wb_status fail_at(const struct loading *loading, const struct wb_test_info *info,
                              double at, double step, struct wb_reason *why)
{
    const struct axis axis = axis_of(info);
    const double begin = loading->points[0].at;
    if (at < begin)
        return wb_fail_to(
            why, WB_ERR_DATA,
            "wire '%s', sample %d: the first loading has no rows below %.2f %s, "
            "expected from zero %s on (was the tip's rest too high, or the start lost?)",
            info->wire, info->sample, begin / axis.size, axis.unit,
            info->is_follower ? "force" : "deflection");
    return wb_fail_to(why, WB_ERR_DATA,
                      "wire '%s', sample %d: no rows of the first loading around %.2f %s (a gap of "
                      "more than %g steps of %g %s)",
                      info->wire, info->sample, at / axis.size, axis.unit, LONGEST_GAP,
                      step / axis.size, axis.unit);
}

static void find_largest(struct wb_curve *curve)
{
    const double end = (curve->n - 1) * curve->step;
    double largest = curve->value[0];
    for (int k = 1; k < curve->n; k++)
        largest = fmax(largest, curve->value[k]);
    curve->max_deflection = curve->is_follower ? largest : end;
    curve->max_force = curve->is_follower ? end : largest;
}

static enum wb_status average(struct wb_curve *curve, const struct loading *loadings,
                              const struct wb_dataset *const *datasets, int n, double step,
                              struct wb_reason *why)
{
    const int points = common_points(loadings, n, step);
    const struct axis axis = axis_of(&datasets[0]->info);
    if (points < FEWEST_POINTS)
        return wb_fail_to(why, WB_ERR_DATA,
                          "wire '%s': the first loading reaches only %d points of %g %s in every "
                          "sample, expected at least %d",
                          datasets[0]->info.wire, points, step / axis.size, axis.unit,
                          FEWEST_POINTS);
    double *const values = wb_memory_new((size_t)n, sizeof *values);
    enum wb_status status = WB_OK;
    allocate(curve, points);
    for (int k = 0; status == WB_OK && k < points; k++) {
        for (int i = 0; status == WB_OK && i < n; i++) {
            if (!loading_value(&loadings[i], k, step, &values[i]))
                status = fail_at(&loadings[i], &datasets[i]->info, k * step, step, why);
        }
        if (status == WB_OK)
            combine(curve, k, values, n);
    }
    free(values);
    if (status != WB_OK) {
        wb_curve_release(curve);
        return status;
    }
    curve->is_follower = datasets[0]->info.is_follower;
    curve->step = step;
    curve->n_samples = n;
    find_largest(curve);
    return WB_OK;
}

/* One step of force per row where the rows are equally spaced and not too many. */
static double default_force_step(const struct loading *loadings, int n)
{
    return common_end(loadings, n) /
           (double)(loadings[0].n - 1 < MOST_FORCE_STEPS ? loadings[0].n - 1 : MOST_FORCE_STEPS);
}

static enum wb_status average_loadings(struct wb_curve *curve, struct loading *loadings,
                                       const struct wb_dataset *const *datasets, int n,
                                       const struct wb_curve_grid *grid, struct wb_reason *why)
{
    for (int i = 0; i < n; i++)
        WB_TRY(extract_loading(&loadings[i], datasets[i], grid, why));
    double step = grid->step;
    if (datasets[0]->info.is_follower)
        step = grid->force_step > 0.0 ? grid->force_step : default_force_step(loadings, n);
    if (!(step > 0.0))
        return wb_fail_to(why, WB_ERR_DATA, "wire '%s': the follower force never grows",
                          datasets[0]->info.wire);
    return average(curve, loadings, datasets, n, step, why);
}

enum wb_status wb_curve_average_on(struct wb_curve *curve, const struct wb_dataset *const *datasets,
                                   int n, const struct wb_curve_grid *grid, struct wb_reason *why)
{
    struct wb_curve_grid complete = {0};
    struct wb_curve result = {0};
    if (grid)
        complete = *grid;
    if (n < 1 || !(complete.step >= 0.0 && isfinite(complete.step)) ||
        !(complete.force_step >= 0.0 && isfinite(complete.force_step)) ||
        !(complete.largest_deflection >= 0.0))
        return wb_fail_to(why, WB_ERR_ARGUMENT,
                          "averaging needs at least one dataset, steps and a largest "
                          "deflection >= 0");
    if (complete.step == 0.0)
        complete.step = 0.5 * WB_MM;
    for (int i = 0; i < n; i++) {
        WB_TRY(check_info(&datasets[i]->info, why));
        WB_TRY(check_same_test(&datasets[0]->info, &datasets[i]->info, why));
    }
    struct loading *const loadings = wb_memory_new((size_t)n, sizeof *loadings);
    const enum wb_status status = average_loadings(&result, loadings, datasets, n, &complete, why);
    for (int i = 0; i < n; i++)
        release_loading(&loadings[i]);
    free(loadings);
    if (status == WB_OK)
        *curve = result;
    return status;
}

/* Points up to the largest deflection that rise above all points before them. */
static int rising_points(const struct wb_curve *curve, struct loading_point *points)
{
    int n = 0;
    for (int i = 0; i < curve->n; i++) {
        if (n == 0 || curve->deflection[i] > points[n - 1].at)
            points[n++] = (struct loading_point){curve->deflection[i], i * curve->step};
    }
    return n;
}

/* Force at a deflection by linear interpolation; *from is the point to start searching from. */
static double force_between(const struct loading_point *points, int n, double deflection, int *from)
{
    while (*from < n - 2 && points[*from + 1].at < deflection)
        ++*from;
    const struct loading_point *const a = &points[*from], *const b = a + 1;
    return a->value + (b->value - a->value) * (deflection - a->at) / (b->at - a->at);
}

enum wb_status wb_curve_turn(struct wb_curve *turned, const struct wb_curve *curve, double step,
                             struct wb_reason *why)
{
    struct loading_point *const points = wb_memory_new((size_t)curve->n, sizeof *points);
    struct wb_curve made;
    int from = 0;
    const int n = rising_points(curve, points);
    const double last = n > 0 ? points[n - 1].at : 0.0;
    const double places = n > 1 ? floor(last / step + 1e-6) : 0.0;
    if (n < FEWEST_POINTS || !(places >= 1.0)) {
        free(points);
        return wb_fail_to(why, WB_ERR_DATA,
                          "the deflection does not rise with the follower force from zero on (%d "
                          "points rise, to %.4g mm); is its sign reversed?",
                          n, last / WB_MM);
    }
    allocate(&made, (int)fmin(places, 1e6) + 1);
    for (int i = 0; i < made.n; i++)
        made.force[i] = force_between(points, n, i * step, &from);
    free(points);
    for (int i = made.n - 1; i >= 0; i--)
        made.low[i] = made.high[i] = made.force[i] -= made.force[0];
    made.step = step;
    made.n_samples = curve->n_samples;
    find_largest(&made);
    *turned = made;
    return WB_OK;
}

void wb_curve_release(struct wb_curve *curve)
{
    free(curve->value);
    free(curve->low);
    free(curve->high);
    free(curve->deviation);
    memset(curve, 0, sizeof *curve);
}

double wb_curve_scale(const struct wb_curve *curve)
{
    return curve->is_follower ? curve->max_deflection : curve->max_force;
}

double wb_curve_scatter(const struct wb_curve *curve)
{
    return wb_errors_rms(curve->n, curve->deviation) / wb_curve_scale(curve);
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
    memset(mean.natural_shape, 0, sizeof mean.natural_shape);
    mean.n_natural_shape = 0;
    const int known = known_shapes(datasets, n);
    for (int i = 0; i < n; i++) {
        const struct wb_test_info *const one = &datasets[i]->info;
        for (int k = 0; k < one->n_natural_shape; k++)
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
            if (same_kind(&datasets[k]->info, &datasets[i]->info))
                group[i] = group[k];
        }
        if (group[i] < 0)
            group[i] = groups++;
    }
    return groups;
}
