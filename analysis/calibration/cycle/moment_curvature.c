/* Shape and moment of one measured state.
 *
 * Curvature beyond the natural one, of which g = 1 - s/L falls from 1 at the clamp to 0 at the tip,
 * where no moment acts:
 *
 * theta'(s) = theta0'(s) + b(s) + a_1 g + a_2 g^2 + a_3 g^3
 *
 * With b = 0 the angle is a polynomial of four terms. theta, x and y follow by integration. The a_j
 * are found by least squares (Gauss-Newton) on the distances of the markers from the wire, along
 * its normal, and on the height of the tip.
 *
 * Moment of the loads between s and the tip, with the tension T (sin p, cos p), the counterweight P
 * and the weight per length w:
 *
 * M(s) = (x(L) - x(s)) (T cos p - P) - (y(L) - y(s)) T sin p - w int_s^L (x(r) - x(s)) dr
 *
 * If only a part of the wire yields, four terms are too smooth: the curvature of the clamp is 1 or
 * 2 % too large. On a first loading all places follow one curve of moment over curvature; the first
 * pass finds its mean over all states. Later passes use it for b, at the moments of the state, so
 * that the polynomial describes only the difference. All terms stay free, so each state is still
 * determined by its own data. During unloading, b is that at the turn.
 */
#include "analysis/calibration/cycle/moment_curvature.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>

#include "analysis/calibration/cycle/cycle_bow.h"
#include "analysis/calibration/cycle/cycle_data.h"
#include "analysis/calibration/law/bending.h"
#include "analysis/keys/row.h"
#include "base/memory.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "moment"

enum {
    NODES = 401, /* along the wire */
    TERMS = 3,
    CURVE_TERMS = 6, /* of the mean curve */
    PASSES = 3,
    SETTLING = 4, /* iterations before b is used */
    MOST_MARKERS = 64,
    FEWEST_MARKERS = 3,
    MOST_ITERATIONS = 50,
    STATIONS = 3,
    TABLE = 801,
    FEWEST_POINTS = 2 /* of a specimen in a range */
};

/* Places along the wire, s/L, at which a shape gives a point: beyond the middle the moment is
 * small, and the polynomial is determined by the tip. */
static const double stations[STATIONS] = {0.0, 0.2, 0.4};

/* Deflection between shapes; part of the largest curvature below which points are bands. */
static const double shape_step = 3.0 * WB_MM, smallest_share = 0.12;
/* Standard deviation of a marker's constant distance from the axis, and prior standard deviation of
 * its mean places in a state. */
static const double offset_deviation = 0.15 * WB_MM, place_deviation = 0.03 * WB_MM;
/* Weight of this prior, in places. */
static const double prior_places = 6.0;
/* Largest deflection over length of states that show the natural shape. */
static const double near_zero = 0.047;
/* Effect of the law on such a shape, as a part of its deflection. */
static const double law_share = 0.01;
/* Largest distance of a frame from the deflection of its state (cycle_data.c). */
static const double frame_reach = 1.6 * WB_MM;
/* Relative error of the curvature by the form of the polynomial: see docs/theory.md. */
static const double form_share = 0.005;

/* Bounds of the ranges of the comparison, over the largest curvature. */
static const double edges[WB_MOMENT_STRETCHES + 1] = {0.12, 0.2, 0.32, 0.46, 0.62, 0.8, 1.001};
/* Standard uncertainties that the scatter does not include: of a moment; of the method in the mean
 * of many. */
static const double least_relative_deviation = 0.005, method_deviation = 0.007;
/* Limits in standard deviations: for a range, and for its neighbour. */
static const double apart = 3.0, backing = 2.0;

struct shape {
    double theta[NODES], x[NODES], y[NODES];
    double weight_arm[NODES]; /* int_s^L (x(r) - x(s)) dr, m2 */
    double dx[TERMS][NODES], dy[TERMS][NODES];
};

struct fitting {
    const struct wb_cycle_data *data;
    const struct wb_test_info *info; /* with the natural shape that is used */
    double level;
    double offsets[MOST_MARKERS]; /* m */
    double base[NODES];           /* 1/m: b */
    bool has_curve;               /* the mean curve of an earlier pass: */
    double curve[CURVE_TERMS];    /* 1/m, of powers of the moment over */
    double largest_moment;        /* N m */
    double a[TERMS];              /* 1/m */
    double covariance[TERMS][TERMS];
    double square_sum; /* m2 of the state's residuals */
    int n_residuals;
    double all_square_sum; /* m2 of all states' */
    int all_degrees, n_states;
    struct shape shape;
};

static double falling(int node)
{
    return 1.0 - (double)node / (NODES - 1);
}

static double natural_angle(const struct wb_test_info *info, double u)
{
    double sum = 0.0, power = u;
    for (int i = 0; i < info->n_natural_shape; i++, power *= u)
        sum += info->natural_shape[i] * power;
    return sum;
}

/* Place at small slopes. */
static double natural_height(const struct wb_test_info *info, double u)
{
    double sum = 0.0, power = u * u;
    for (int i = 0; i < info->n_natural_shape; i++, power *= u)
        sum += info->length * info->natural_shape[i] * power / (i + 2);
    return sum;
}

/* Shape of the parameters a, and its derivatives, by the trapezoidal rule. */
static void integrate(struct fitting *f)
{
    struct shape *const q = &f->shape;
    const double h = f->info->length / (NODES - 1);
    double turn[TERMS] = {0.0};
    q->theta[0] = q->x[0] = q->y[0] = 0.0;
    double bend = 0.0, dx_before[TERMS] = {0.0}, dy_before[TERMS] = {0.0};
    for (int j = 0; j < TERMS; j++)
        q->dx[j][0] = q->dy[j][0] = 0.0;
    for (int k = 1; k < NODES; k++) {
        const double g0 = falling(k - 1), g1 = falling(k);
        double p0 = g0, p1 = g1;
        bend += 0.5 * h * (f->base[k - 1] + f->base[k]);
        for (int j = 0; j < TERMS; j++, p0 *= g0, p1 *= g1) {
            turn[j] += 0.5 * h * (p0 + p1);
            bend += f->a[j] * 0.5 * h * (p0 + p1);
        }
        q->theta[k] = natural_angle(f->info, (double)k / (NODES - 1)) + bend;
        const double c0 = cos(q->theta[k - 1]), c1 = cos(q->theta[k]);
        const double s0 = sin(q->theta[k - 1]), s1 = sin(q->theta[k]);
        q->x[k] = q->x[k - 1] + 0.5 * h * (c0 + c1);
        q->y[k] = q->y[k - 1] + 0.5 * h * (s0 + s1);
        for (int j = 0; j < TERMS; j++) {
            const double dx = -s1 * turn[j], dy = c1 * turn[j];
            q->dx[j][k] = q->dx[j][k - 1] + 0.5 * h * (dx_before[j] + dx);
            q->dy[j][k] = q->dy[j][k - 1] + 0.5 * h * (dy_before[j] + dy);
            dx_before[j] = dx;
            dy_before[j] = dy;
        }
    }
    q->weight_arm[NODES - 1] = 0.0;
    for (int k = NODES - 2; k >= 0; k--)
        q->weight_arm[k] =
            q->weight_arm[k + 1] + (q->x[k + 1] - q->x[k]) * h * (NODES - 1 - k - 0.5);
}

static double between(const double *values, double at)
{
    const int k = (int)fmin(fmax(at, 0.0), NODES - 2.0);
    return values[k] + (at - k) * (values[k + 1] - values[k]);
}

/* Replaces a symmetric matrix (n x n) by its inverse; false if it is not positive definite. */
static bool invert(double *matrix, size_t n)
{
    gsl_matrix_view m = gsl_matrix_view_array(matrix, n, n);
    return gsl_linalg_cholesky_decomp1(&m.matrix) == GSL_SUCCESS &&
           gsl_linalg_cholesky_invert(&m.matrix) == GSL_SUCCESS;
}

/* Adds a residual (measured less computed) with its derivatives to the normal equations. */
static void add(struct fitting *f, double residual, const double *slope,
                double normal[TERMS][TERMS], double *right)
{
    for (int i = 0; i < TERMS; i++) {
        for (int k = 0; k < TERMS; k++)
            normal[i][k] += slope[i] * slope[k];
        right[i] += slope[i] * residual;
    }
    f->square_sum += residual * residual;
    f->n_residuals++;
}

/* Moment at a node. */
static double moment_of(const struct fitting *f, double tension, int node)
{
    const struct wb_test_info *const info = f->info;
    const struct shape *const q = &f->shape;
    const double arm = q->x[NODES - 1] - q->x[node], rise = q->y[NODES - 1] - q->y[node];
    const double sine =
        info->strand_length > 0.0 ? (info->length - q->x[NODES - 1]) / info->strand_length : 0.0;
    return arm * (tension * sqrt(1.0 - sine * sine) - info->counterweight * info->gravity) -
           rise * tension * sine - info->mass_per_length * info->gravity * q->weight_arm[node];
}

/* Sets b of a loading: the mean curve at the moments of the present shape. */
static void follow_curve(struct fitting *f, double tension)
{
    for (int k = 0; k < NODES; k++) {
        const double m = fmin(fmax(moment_of(f, tension, k) / f->largest_moment, 0.0), 1.0);
        double power = m;
        f->base[k] = 0.0;
        for (int j = 0; j < CURVE_TERMS; j++, power *= m)
            f->base[k] += f->curve[j] * power;
    }
}

/* Curvature relative to the natural one at a node. */
static double curvature_of(const struct fitting *f, int node)
{
    const double g = falling(node);
    return f->base[node] + g * (f->a[0] + g * (f->a[1] + g * f->a[2]));
}

/* Fits the shape to places `begin` to `end`, which belong to one state. */
static bool fit_state(struct fitting *f, int begin, int end)
{
    const struct wb_cycle_data *const data = f->data;
    const double length = f->info->length;
    const struct wb_cycle_point *const point = &data->points[data->places[begin].point];
    const double height = point->deflection - f->level;
    if (!point->is_unloading) {
        /* Initial guess: the elastic shape. */
        memset(f->base, 0, sizeof f->base);
        f->a[0] = 3.0 * height / (length * length);
        f->a[1] = f->a[2] = 0.0;
    }
    for (int iteration = 0; iteration < MOST_ITERATIONS; iteration++) {
        double normal[TERMS][TERMS] = {{0.0}}, right[TERMS] = {0.0}, slope[TERMS];
        const struct shape *const q = &f->shape;
        if (f->has_curve && !point->is_unloading && iteration == SETTLING) {
            follow_curve(f, point->tension);
            memset(f->a, 0, sizeof f->a);
        }
        integrate(f);
        f->square_sum = 0.0;
        f->n_residuals = 0;
        for (int i = begin; i < end; i++) {
            const struct wb_cycle_place *const place = &data->places[i];
            const double at = place->s / length * (NODES - 1), angle = between(q->theta, at);
            const double residual = (place->y - between(q->y, at)) * cos(angle) -
                                    (place->x - between(q->x, at)) * sin(angle) -
                                    f->offsets[place->marker];
            for (int j = 0; j < TERMS; j++)
                slope[j] = between(q->dy[j], at) * cos(angle) - between(q->dx[j], at) * sin(angle);
            add(f, residual, slope, normal, right);
        }
        for (int j = 0; j < TERMS; j++)
            slope[j] = q->dy[j][NODES - 1];
        add(f, height - q->y[NODES - 1], slope, normal, right);
        if (!invert(&normal[0][0], TERMS))
            return false;
        double change = 0.0, size = 0.0;
        for (int i = 0; i < TERMS; i++) {
            double step = 0.0;
            for (int k = 0; k < TERMS; k++) {
                step += normal[i][k] * right[k];
                f->covariance[i][k] = normal[i][k];
            }
            f->a[i] += step;
            change += fabs(step);
            size += fabs(f->a[i]);
        }
        if (!isfinite(change))
            return false;
        if (iteration > SETTLING && change < 1e-7 * (size + 1.0 / length))
            return true;
    }
    return false;
}

/* Finds the distance of each marker from the axis from the states close to zero deflection. Their
 * shape is the natural one, bent by a force at the tip to the measured height, which depends little
 * on the law. Errors of the natural shape are included in these distances. Places of a simulation
 * are on the axis. */
static void find_offsets(struct fitting *f)
{
    const struct wb_cycle_data *const data = f->data;
    const double length = f->info->length, bow = natural_height(f->info, 1.0);
    double sum[MOST_MARKERS] = {0.0}, weights[MOST_MARKERS];
    if (f->info->is_simulation)
        return;
    for (int i = 0; i < data->n_markers; i++)
        weights[i] = 1.0 / (offset_deviation * offset_deviation);
    for (int i = 0; i < data->n_places; i++) {
        const struct wb_cycle_place *const place = &data->places[i];
        const double height = data->points[place->point].deflection - f->level;
        const double u = place->s / length, bend = height - bow;
        if (data->points[place->point].is_unloading || fabs(height) > near_zero * length)
            break;
        const double weight = 1.0 / (pow(place_deviation, 2) + pow(law_share * bend, 2));
        sum[place->marker] +=
            weight * (place->y - natural_height(f->info, u) - bend * 0.5 * u * u * (3.0 - u));
        weights[place->marker] += weight;
    }
    for (int i = 0; i < data->n_markers; i++)
        f->offsets[i] = sum[i] / weights[i];
}

/* Factor of the uncertainty of places close to the turn, where frames lie on one side only and the
 * places are extrapolated along a line. */
static double turn_factor(const struct fitting *f, const struct wb_cycle_point *point)
{
    const double beyond = fmin(fmax(f->data->top - point->deflection, 0.0), frame_reach);
    const double off_middle = 0.5 * (frame_reach - beyond);
    return hypot(1.0, off_middle / ((frame_reach + beyond) / sqrt(12.0)));
}

/* Adds the points of a fitted state. During unloading only that of the clamp is used, because the
 * curvature at the turn differs along the wire. Deviations are for errors of places of 1 m, see
 * finish(). */
static void add_points(struct wb_moment_cloud *cloud, const struct fitting *f,
                       const struct wb_cycle_point *point)
{
    for (int i = 0; i < (point->is_unloading ? 1 : STATIONS); i++) {
        const int node = (int)(stations[i] * (NODES - 1) + 0.5);
        const double g = falling(node), power[TERMS] = {g, g * g, g * g * g};
        struct wb_moment_point *const out = &cloud->points[cloud->n++];
        double variance = 0.0;
        *out = (struct wb_moment_point){.s = stations[i] * f->info->length,
                                        .curvature = curvature_of(f, node),
                                        .moment = moment_of(f, point->tension, node),
                                        .is_unloading = point->is_unloading};
        for (int j = 0; j < TERMS; j++) {
            for (int k = 0; k < TERMS; k++)
                variance += power[j] * f->covariance[j][k] * power[k];
        }
        out->deviation = sqrt(variance) * turn_factor(f, point);
    }
}

/* Scales the deviations and marks points of the band. */
static void finish(struct wb_moment_cloud *cloud, const struct fitting *f, double bow_deviation)
{
    /* Errors of a marker's distance are the same in all states, so few independent numbers
     * determine their size; the prior counts as additional ones. */
    const double free_places = (double)f->all_degrees / f->n_states;
    const double places =
        sqrt((prior_places * pow(place_deviation, 2) + f->all_square_sum / f->n_states) /
             (prior_places + free_places));
    const double natural = 2.0 * bow_deviation / (f->info->length * f->info->length);
    for (int i = 0; i < cloud->n; i++) {
        const struct wb_moment_point *const point = &cloud->points[i];
        if (point->s == 0.0 && !point->is_unloading)
            cloud->largest = fmax(cloud->largest, point->curvature);
    }
    for (int i = 0; i < cloud->n; i++) {
        struct wb_moment_point *const point = &cloud->points[i];
        point->deviation = sqrt(pow(point->deviation * places, 2) + natural * natural +
                                pow(form_share * point->curvature, 2));
        point->is_band = point->curvature < smallest_share * cloud->largest;
    }
}

/* Fits the mean curve of the points of the loading by least squares; false if there are too few. */
static bool find_curve(struct fitting *f, const struct wb_moment_cloud *cloud)
{
    double normal[CURVE_TERMS][CURVE_TERMS] = {{0.0}}, right[CURVE_TERMS] = {0.0};
    int n = 0;
    f->largest_moment = 0.0;
    for (int i = 0; i < cloud->n && !cloud->points[i].is_unloading; i++)
        f->largest_moment = fmax(f->largest_moment, cloud->points[i].moment);
    for (int i = 0; i < cloud->n && !cloud->points[i].is_unloading; i++) {
        const struct wb_moment_point *const point = &cloud->points[i];
        const double m = point->moment / f->largest_moment;
        double power[CURVE_TERMS];
        if (!(m > 0.0))
            continue;
        for (int j = 0; j < CURVE_TERMS; j++)
            power[j] = pow(m, j + 1) / point->deviation;
        for (int j = 0; j < CURVE_TERMS; j++) {
            for (int k = 0; k < CURVE_TERMS; k++)
                normal[j][k] += power[j] * power[k];
            right[j] += power[j] * point->curvature / point->deviation;
        }
        n++;
    }
    if (n < 3 * CURVE_TERMS || !invert(&normal[0][0], CURVE_TERMS))
        return false;
    for (int j = 0; j < CURVE_TERMS; j++) {
        f->curve[j] = 0.0;
        for (int k = 0; k < CURVE_TERMS; k++)
            f->curve[j] += normal[j][k] * right[k];
    }
    return true;
}

/* Fits all states, those of the loading first. */
static void fit_states(struct wb_moment_cloud *cloud, struct fitting *f)
{
    const struct wb_cycle_data *const data = f->data;
    bool has_turned = false;
    cloud->n = 0;
    f->all_square_sum = 0.0;
    f->all_degrees = f->n_states = 0;
    for (int begin = 0, end; begin < data->n_places; begin = end) {
        const struct wb_cycle_point *const point = &data->points[data->places[begin].point];
        end = begin + 1;
        while (end < data->n_places && data->places[end].point == data->places[begin].point)
            end++;
        if (end - begin < FEWEST_MARKERS)
            continue;
        if (point->is_unloading && !has_turned) {
            for (int k = 0; k < NODES; k++)
                f->base[k] = curvature_of(f, k);
            memset(f->a, 0, sizeof f->a);
            has_turned = true;
        }
        if (!fit_state(f, begin, end))
            continue;
        f->all_square_sum += f->square_sum;
        f->all_degrees += f->n_residuals - TERMS;
        f->n_states++;
        add_points(cloud, f, point);
    }
}

static enum wb_status take(struct wb_moment_cloud *cloud, struct fitting *f, double bow_deviation,
                           struct wb_reason *why)
{
    const struct wb_cycle_data *const data = f->data;
    cloud->points = wb_memory_new((size_t)data->n_points * STATIONS, sizeof *cloud->points);
    find_offsets(f);
    for (int pass = 0; pass < PASSES; pass++) {
        f->has_curve = pass > 0 && find_curve(f, cloud);
        fit_states(cloud, f);
    }
    if (cloud->n == 0)
        return wb_fail_to(why, WB_ERR_DATA,
                          "wire '%s', sample %d: no shapes of at least %d markers between clamp "
                          "and tip: expected some for moments over curvatures",
                          data->info.wire, data->info.sample, FEWEST_MARKERS);
    finish(cloud, f, bow_deviation);
    return WB_OK;
}

enum wb_status wb_moment_curvature_take(struct wb_moment_cloud *cloud,
                                        const struct wb_dataset *dataset,
                                        const struct wb_cycle_specimen *specimen,
                                        struct wb_reason *why)
{
    const struct wb_cycle_data_settings how = {.marker_step = shape_step};
    struct wb_cycle_data data;
    *cloud = (struct wb_moment_cloud){0};
    WB_TRY(wb_cycle_data_take(&data, dataset, &how, why));
    struct wb_test_info info = dataset->info;
    struct fitting *const f = wb_memory_new(1, sizeof *f);
    f->data = &data;
    f->info = &info;
    if (specimen) {
        wb_cycle_model_bend(specimen, &info);
        f->level = specimen->level;
    }
    const enum wb_status status = take(cloud, f, wb_cycle_bow_deviation(dataset), why);
    free(f);
    wb_cycle_data_release(&data);
    if (status != WB_OK)
        wb_moment_curvature_release(cloud);
    return status;
}

void wb_moment_curvature_release(struct wb_moment_cloud *cloud)
{
    free(cloud->points);
    *cloud = (struct wb_moment_cloud){0};
}

/* --- against a law --- */

/* Mean of one specimen in one range. */
struct sums {
    double weight, difference, deviation;
    int n;
};

/* Moment of the law at a curvature, and its slope, from a table at even steps. */
struct table {
    double step;
    double moment[TABLE];
};

static enum wb_status tabulate(struct table *table, const struct wb_law *law, double diameter,
                               double largest)
{
    double curvature[TABLE];
    table->step = largest / (TABLE - 1);
    for (int i = 0; i < TABLE; i++)
        curvature[i] = table->step * i;
    return wb_bending_moments(law, diameter, TABLE, curvature, table->moment);
}

static double moment_at(const struct table *table, double curvature, double *slope)
{
    const double at = curvature / table->step;
    const int k = (int)fmin(fmax(at, 0.0), TABLE - 2.0);
    *slope = (table->moment[k + 1] - table->moment[k]) / table->step;
    return table->moment[k] + (curvature - table->step * k) * *slope;
}

static int stretch_of(const struct wb_moment_comparison *c, double curvature)
{
    for (int i = 0; i < c->n; i++) {
        if (curvature >= c->stretches[i].first && curvature < c->stretches[i].last)
            return i;
    }
    return -1;
}

/* Weighted mean of the relative differences of one specimen in one range, and the mean of their
 * deviations, because their errors are correlated. */
static void gather(struct sums *sums, const struct wb_moment_cloud *cloud,
                   const struct table *table, const struct wb_moment_comparison *c)
{
    for (int i = 0; i < cloud->n; i++) {
        const struct wb_moment_point *const point = &cloud->points[i];
        const int stretch =
            point->is_unloading || point->is_band ? -1 : stretch_of(c, point->curvature);
        double slope;
        if (stretch < 0 || !(point->moment > 0.0))
            continue;
        const double moment = moment_at(table, point->curvature, &slope);
        const double deviation =
            hypot(slope * point->deviation / point->moment, least_relative_deviation);
        const double weight = 1.0 / (deviation * deviation);
        sums[stretch].weight += weight;
        sums[stretch].difference += weight * (moment / point->moment - 1.0);
        sums[stretch].deviation += weight * deviation;
        sums[stretch].n++;
    }
}

/* Judges all ranges: whether two neighbours, or the only range, differ in the same direction. */
static void judge(struct wb_moment_comparison *c)
{
    for (int i = 0; i < c->n; i++) {
        const struct wb_moment_stretch *const here = &c->stretches[i];
        const double z = here->difference / here->deviation;
        bool is_backed = c->n == 1;
        for (int k = i - 1; k <= i + 1; k += 2) {
            if (k >= 0 && k < c->n)
                is_backed = is_backed || c->stretches[k].difference / c->stretches[k].deviation *
                                                 copysign(1.0, z) >
                                             backing;
        }
        if (!(fabs(z) > apart) || !is_backed)
            continue;
        if (!c->is_apart)
            c->first = here->first;
        c->last = here->last;
        c->is_apart = true;
        if (fabs(z) > fabs(c->in_deviations)) {
            c->in_deviations = fabs(z);
            c->difference = here->difference;
        }
    }
}

enum wb_status wb_moment_curvature_compare(const struct wb_moment_cloud *const *clouds, int n,
                                           const struct wb_law *law, double diameter,
                                           struct wb_moment_comparison *comparison)
{
    struct wb_moment_comparison *const c = comparison;
    struct table table;
    double largest = 0.0;
    struct {
        double difference, difference_square, variance;
    } sum[WB_MOMENT_STRETCHES] = {{0.0}};
    int kept = 0;

    *c = (struct wb_moment_comparison){0};
    for (int i = 0; i < n; i++)
        largest = fmax(largest, clouds[i]->largest);
    if (!(largest > 0.0))
        return WB_OK;
    WB_TRY(tabulate(&table, law, diameter, 1.05 * largest));
    c->n = WB_MOMENT_STRETCHES;
    for (int k = 0; k < c->n; k++) {
        c->stretches[k].first = edges[k] * largest;
        c->stretches[k].last = edges[k + 1] * largest;
    }
    for (int i = 0; i < n; i++) {
        struct sums sums[WB_MOMENT_STRETCHES] = {{0.0}};
        gather(sums, clouds[i], &table, c);
        for (int k = 0; k < c->n; k++) {
            if (sums[k].n < FEWEST_POINTS)
                continue;
            const double difference = sums[k].difference / sums[k].weight;
            sum[k].difference += difference;
            sum[k].difference_square += difference * difference;
            sum[k].variance += pow(sums[k].deviation / sums[k].weight, 2);
            c->stretches[k].n++;
        }
    }
    for (int k = 0; k < c->n; k++) {
        struct wb_moment_stretch stretch = c->stretches[k];
        if (2 * stretch.n < n || stretch.n == 0)
            continue;
        stretch.difference = sum[k].difference / stretch.n;
        /* The scatter of specimens may exceed the measurement uncertainty. */
        const double scatter = stretch.n > 1
                                   ? fmax(sum[k].difference_square -
                                              stretch.n * stretch.difference * stretch.difference,
                                          0.0) /
                                         (stretch.n - 1)
                                   : 0.0;
        stretch.deviation =
            hypot(sqrt(fmax(sum[k].variance / stretch.n, scatter) / stretch.n), method_deviation);
        c->stretches[kept++] = stretch;
    }
    c->n = kept;
    judge(c);
    return WB_OK;
}

#define POINT(member) WB_AT(struct wb_moment_point, member)

static const struct wb_key wb_moment_curvature_rows[] = {
    {"curvature_1_m", POINT(curvature), "curvature by the markers"},
    {"curvature_deviation_1_m", POINT(deviation), "standard uncertainty of the curvature"},
    {"moment_N_mm", POINT(moment), "moment by the strand's tension"},
    {"branch", WB_CHOICE(struct wb_moment_point, is_unloading), "branch of the cycle",
     .choices = "loading|unloading"},
    {"s_mm", POINT(s), "arc length of the place"},
    {"band", POINT(is_band), "the wire is bent too little there: the point shows scatter only"},
};
WB_KEYS(wb_moment_curvature, "moment_point", "A point of M over curvature, without a law.");

void wb_moment_curvature_put(struct wb_json *array, const struct wb_moment_cloud *cloud)
{
    for (int i = 0; i < cloud->n; i++)
        WB_PUT(wb_json_append_object(array), &wb_moment_curvature_keys, struct wb_moment_point,
               &cloud->points[i]);
}
