/* Shape and moment of one measured state.
 *
 * The curvature beyond the natural one is a polynomial without constant term in g, which falls from
 * 1 at the clamp to 0 at the tip, where no moment acts:
 *
 *     theta'(s) = theta0'(s) + a_1 g + a_2 g^2 + a_3 g^3,   g = 1 - s/L  or  1 - x(s)/x(L)
 *
 * theta, x and y follow by integration. The a_j are found by least squares (Gauss-Newton) on the
 * distances of the markers from the wire, along its normal, and on the height of the tip.
 *
 * Moment of what lies between s and the tip, T (sin p, cos p) the tension, P the counterweight and
 * w the weight per length:
 *
 *     M(s) = (x(L) - x(s)) (T cos p - P) - (y(L) - y(s)) T sin p - w int_s^L (x(r) - x(s)) dr
 */
#include "analysis/moment_curvature.h"

#include <math.h>
#include <stdlib.h>

#include "analysis/bending.h"
#include "analysis/cycle_data.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "moment"

enum {
    NODES = 401, /* along the wire */
    TERMS = 3,
    MOST_MARKERS = 64,
    FEWEST_MARKERS = 3,
    MOST_ITERATIONS = 50,
    STATIONS = 3,
    FEWEST_POINTS = 2 /* of a specimen in a stretch */
};

/* Places along the wire, s/L, at which a shape gives a point: beyond the middle the moment is small
 * and the shape's polynomial is held by the tip. */
static const double stations[STATIONS] = {0.0, 0.2, 0.4};

static const double default_step = 3.0 * WB_MM, default_share = 0.12, default_bow = 0.3 * WB_MM;
/* Standard deviation of a marker's constant distance off the axis, and of the mean of its places in
 * a state; the least that the places about the shapes count with. */
static const double offset_deviation = 0.07 * WB_MM, place_deviation = 0.04 * WB_MM,
                    least_deviation = 0.01 * WB_MM;
/* States with a tip this near to zero deflection show the natural shape. */
static const double near_zero = 2.0 * WB_MM;
/* How far the polynomial's form is off, as a part of the curvature: see docs/theory.md. */
static const double form_share = 0.005;

struct shape {
    double theta[NODES], x[NODES], y[NODES];
    double weight_arm[NODES]; /* int_s^L (x(r) - x(s)) dr, m2 */
    double dx[TERMS][NODES], dy[TERMS][NODES];
};

struct fitting {
    const struct wb_cycle_data *data;
    const struct wb_test_info *info; /* with the natural shape that counts */
    double level;
    double offsets[MOST_MARKERS]; /* m */
    double weights[NODES];        /* g */
    double a[TERMS];              /* 1/m */
    double covariance[TERMS][TERMS];
    double square_sum; /* m2 of the state's residuals */
    int n_residuals;
    struct shape shape;
};

static double natural_angle(const struct wb_test_info *info, double u)
{
    double sum = 0.0, power = u;
    for (int i = 0; i < info->n_natural_shape; i++, power *= u)
        sum += info->natural_shape[i] * power;
    return sum;
}

/* The shape of the numbers a, and its derivatives, by the trapezoidal rule. */
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
        const double g0 = f->weights[k - 1], g1 = f->weights[k];
        double p0 = g0, p1 = g1;
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
            q->weight_arm[k + 1] +
            (q->x[k + 1] - q->x[k]) * h * (NODES - 1 - k - 0.5);
}

static double between(const double *values, double at)
{
    const int k = (int)fmin(fmax(at, 0.0), NODES - 2.0);
    return values[k] + (at - k) * (values[k + 1] - values[k]);
}

/* Inverts a symmetric positive definite matrix; false where it is none. */
static bool invert(double m[TERMS][TERMS])
{
    double result[TERMS][TERMS] = {{0.0}};
    for (int i = 0; i < TERMS; i++)
        result[i][i] = 1.0;
    for (int i = 0; i < TERMS; i++) {
        const double pivot = m[i][i];
        if (!(pivot > 0.0))
            return false;
        for (int k = 0; k < TERMS; k++) {
            m[i][k] /= pivot;
            result[i][k] /= pivot;
        }
        for (int row = 0; row < TERMS; row++) {
            const double factor = m[row][i];
            if (row == i)
                continue;
            for (int k = 0; k < TERMS; k++) {
                m[row][k] -= factor * m[i][k];
                result[row][k] -= factor * result[i][k];
            }
        }
    }
    for (int i = 0; i < TERMS; i++) {
        for (int k = 0; k < TERMS; k++)
            m[i][k] = result[i][k];
    }
    return true;
}

/* Adds a residual (measured less computed) with its derivatives to the normal equations. */
static void add(struct fitting *f, double residual, const double *slope, double normal[TERMS][TERMS],
                double *right)
{
    for (int i = 0; i < TERMS; i++) {
        for (int k = 0; k < TERMS; k++)
            normal[i][k] += slope[i] * slope[k];
        right[i] += slope[i] * residual;
    }
    f->square_sum += residual * residual;
    f->n_residuals++;
}

/* The shape through places `begin` to `end`, which belong to one state. */
static bool fit_state(struct fitting *f, int begin, int end)
{
    const struct wb_cycle_data *const data = f->data;
    const double length = f->info->length;
    const double height = data->points[data->places[begin].point].deflection - f->level;
    for (int k = 0; k < NODES; k++)
        f->weights[k] = 1.0 - (double)k / (NODES - 1);
    /* The elastic shape as a start. */
    f->a[0] = 3.0 * height / (length * length);
    f->a[1] = f->a[2] = 0.0;
    for (int iteration = 0; iteration < MOST_ITERATIONS; iteration++) {
        double normal[TERMS][TERMS] = {{0.0}}, right[TERMS] = {0.0}, slope[TERMS];
        const struct shape *const q = &f->shape;
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
        if (!invert(normal))
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
        if (getenv("GX"))
        for (int k = 0; k < NODES; k++)
            f->weights[k] = 1.0 - q->x[k] / q->x[NODES - 1];
        if (iteration > 2 && change < 1e-7 * (size + 1.0 / length))
            return true;
    }
    return false;
}

/* How far each marker sits off the axis, from the state next to zero deflection: whatever the
 * wire's law, its shape there is the natural one, with the tip moved to where it is held. */
static void find_offsets(struct fitting *f, int begin, int end)
{
    const struct wb_cycle_data *const data = f->data;
    const double length = f->info->length;
    const double trust = 1.0 / (1.0 + pow(place_deviation / offset_deviation, 2));
    const double height = data->points[data->places[begin].point].deflection - f->level;
    double bow = 0.0;
    if (!(fabs(height) < near_zero))
        return;
    for (int i = 0; i < f->info->n_natural_shape; i++)
        bow += length * f->info->natural_shape[i] / (i + 2);
    for (int i = begin; i < end; i++) {
        const struct wb_cycle_place *const place = &data->places[i];
        const double u = place->s / length;
        double y = (height - bow) * 0.5 * u * u * (3.0 - u), power = u * u;
        for (int k = 0; k < f->info->n_natural_shape; k++, power *= u)
            y += length * f->info->natural_shape[k] * power / (k + 2);
        f->offsets[place->marker] = trust * (place->y - y);
    }
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

/* The points of a fitted state. Along the wire the way back is another one at each place, so only
 * the clamp's is taken of it. Deviations stand for places that are off by 1 m, see finish(). */
static void add_points(struct wb_moment_cloud *cloud, const struct fitting *f,
                       const struct wb_cycle_point *point)
{
    for (int i = 0; i < (point->is_unloading ? 1 : STATIONS); i++) {
        const int node = (int)(stations[i] * (NODES - 1) + 0.5);
        const double g = f->weights[node], power[TERMS] = {g, g * g, g * g * g};
        struct wb_moment_point *const out = &cloud->points[cloud->n++];
        double variance = 0.0;
        *out = (struct wb_moment_point){.s = stations[i] * f->info->length,
                                        .moment = moment_of(f, point->tension, node),
                                        .is_unloading = point->is_unloading};
        for (int j = 0; j < TERMS; j++) {
            out->curvature += f->a[j] * power[j];
            for (int k = 0; k < TERMS; k++)
                variance += power[j] * f->covariance[j][k] * power[k];
        }
        out->deviation = sqrt(variance);
    }
}

/* Sizes of the deviations and which points are bands. */
static void finish(struct wb_moment_cloud *cloud, const struct fitting *f, double square_sum,
                   int degrees, const struct wb_moment_settings *settings, double bow_deviation)
{
    const double share =
        settings->smallest_share > 0.0 ? settings->smallest_share : default_share;
    const double places = sqrt(square_sum / (degrees > 0 ? degrees : 1));
    const double natural = 2.0 * bow_deviation / (f->info->length * f->info->length);
    cloud->place_rms = places;
    for (int i = 0; i < cloud->n; i++) {
        const struct wb_moment_point *const point = &cloud->points[i];
        if (point->s == 0.0 && !point->is_unloading)
            cloud->largest = fmax(cloud->largest, point->curvature);
    }
    for (int i = 0; i < cloud->n; i++) {
        struct wb_moment_point *const point = &cloud->points[i];
        point->deviation =
            sqrt(pow(point->deviation * fmax(places, least_deviation), 2) + natural * natural +
                 pow(form_share * point->curvature, 2));
        point->is_band = point->curvature < share * cloud->largest;
    }
}

/* As `align` states it. */
static double stated_bow_deviation(const struct wb_dataset *dataset)
{
    const struct wb_json *const checks = wb_json_get(dataset->document, "checks");
    double value;
    if (wb_json_get_number(wb_json_get(checks, "natural_shape"), "bow_uncertainty_mm", &value) &&
        value > 0.0)
        return value * WB_MM;
    return default_bow;
}

static enum wb_status take(struct wb_moment_cloud *cloud, struct fitting *f,
                           const struct wb_moment_settings *settings, double bow_deviation,
                           struct wb_reason *why)
{
    const struct wb_cycle_data *const data = f->data;
    double square_sum = 0.0;
    int degrees = 0;
    cloud->points = calloc((size_t)data->n_points * STATIONS + 1, sizeof *cloud->points);
    if (!cloud->points)
        return wb_fail_to(why, WB_ERR_MEMORY, "no memory for moments over curvatures");
    for (int begin = 0, end; begin < data->n_places; begin = end) {
        for (end = begin; end < data->n_places && data->places[end].point == data->places[begin].point;)
            end++;
        if (begin == 0)
            find_offsets(f, begin, end);
        if (end - begin < FEWEST_MARKERS || !fit_state(f, begin, end))
            continue;
        square_sum += f->square_sum;
        degrees += f->n_residuals - TERMS;
        add_points(cloud, f, &data->points[data->places[begin].point]);
    }
    if (cloud->n == 0)
        return wb_fail_to(why, WB_ERR_DATA,
                          "wire '%s', sample %d: no shapes of at least %d markers between clamp "
                          "and tip: expected some for moments over curvatures",
                          data->info.wire, data->info.sample, FEWEST_MARKERS);
    finish(cloud, f, square_sum, degrees, settings, bow_deviation);
    return WB_OK;
}

enum wb_status wb_moment_curvature_take(struct wb_moment_cloud *cloud,
                                        const struct wb_dataset *dataset,
                                        const struct wb_cycle_specimen *specimen,
                                        const struct wb_moment_settings *settings,
                                        struct wb_reason *why)
{
    const struct wb_moment_settings defaults = {0};
    const struct wb_moment_settings *const s = settings ? settings : &defaults;
    const struct wb_cycle_data_settings how = {.marker_step =
                                                   s->step > 0.0 ? s->step : default_step};
    struct wb_cycle_data data;
    *cloud = (struct wb_moment_cloud){0};
    WB_TRY(wb_cycle_data_take(&data, dataset, &how, why));
    struct wb_test_info info = dataset->info;
    struct fitting *const f = calloc(1, sizeof *f);
    enum wb_status status = WB_OK;
    if (!f) {
        status = wb_fail_to(why, WB_ERR_MEMORY, "no memory for a shape");
    } else {
        f->data = &data;
        f->info = &info;
        if (specimen) {
            info.n_natural_shape = 1;
            info.natural_shape[0] = specimen->bow_angle;
            f->level = specimen->level;
        }
        status = take(cloud, f, s,
                      s->bow_deviation > 0.0 ? s->bow_deviation : stated_bow_deviation(dataset),
                      why);
        free(f);
    }
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
