/* The specimen's natural shape: its bow, from force and shape near zero deflection.
 *
 * Small slopes, clamped at s = 0, a net vertical force P at the tip, weight w per length, natural
 * shape n(s), u = s/L:
 *
 *   y(s) = n(s) + P/EI (L s^2/2 - s^3/6) - w/EI (s^4/24 - L s^3/6 + L^2 s^2/4)
 *
 * While strand or rest hold the tip, P follows from its height Y = y(L), and then
 *
 *   y(s) - Y p(u) - w L^4/EI (p(u)/8 - g(u)) = n(s) - n(L) p(u)
 *
 *   p(u) = (3 u^2 - u^3)/2,  g(u) = u^4/24 - u^3/6 + u^2/4
 *
 * The right side is small, at most n(L)/13.5 for a uniform curvature, and each marker has its own
 * position error. The force determines the bow better: at the natural tip offset the loading curve
 * would carry the weights alone, F_w = counterweight + 3/8 w L.
 *
 * A wire yields early, so its path to zero deflection matters. If it is bowed downwards, the rest
 * lifted it from its natural shape: the loading curve continues from there and is extrapolated back
 * (second degree) to F_w. If it is bowed upwards, the weights pulled it down onto the rest, and
 * loading reverses that: by Masing's rule the reversed branch is the first one doubled, so the
 * natural offset lies half-way between the rest (force F_r) and the deflection at which the force
 * is 2 F_w - F_r.
 *
 * Force and markers are combined by generalised least squares for
 *
 *   theta0(s) = sum_i b_i u^(i+1),  n(s) = L sum_i b_i u^(i+2)/(i+2)
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_blas.h>
#include <gsl/gsl_linalg.h>

#include "analysis/align/align_private.h"
#include "analysis/dataset/fit.h"
#include "base/memory.h"
#include "base/units.h"

/* Rows with the tip this near to zero deflection (m) are used; slopes are small there. */
#define NEAR_ZERO (1.5 * WB_MM)
/* Standard uncertainty of a marker's offset from the axis, m, where the specimen file gives
 * none. */
#define DEFAULT_OFFSET_ERROR (0.05 * WB_MM)
/* Range of the loading curve used for the extrapolation, as part of the length. */
#define EXTRAPOLATION_PART 0.06
/* Uncertainty of the bow from the force, as part of the difference between the bow that accounts
 * for yielding and that of a straight line. */
#define PATH_ERROR 0.2
/* Further uncertainty of an extrapolated bow, as part of the bow: before the first row the wire was
 * stiffer than in any row, so the parabola is too shallow there. */
#define EXTRAPOLATION_ERROR 0.1
/* A second term is kept if it exceeds its uncertainty by this factor. */
#define SIGNIFICANT 3.0
#define MAX_TERMS 2
#define MAX_OBSERVATIONS (WB_SPECIMEN_MAX_MARKERS + 1)

/* Elastic shape over tip deflection of a cantilever bent by a tip force, p(u) above, u = s/L. */
static double tip_shape(double u)
{
    return 0.5 * u * u * (3.0 - u);
}

static double weight_shape(double u)
{
    return u * u * (0.25 - u / 6.0 + u * u / 24.0);
}

/* n(s) - n(L) p(u) of one term with b = 1, over L. */
static double term_shape(int term, double u)
{
    const int power = term + 2;
    return (pow(u, power) - tip_shape(u)) / power;
}

/* Observations, with their errors as combinations of independent ones: one of each marker (those of
 * clamp and tip enter all observations) and one of the force. */
struct observations {
    int n, n_errors;
    double value[MAX_OBSERVATIONS];                        /* m */
    double design[MAX_OBSERVATIONS][MAX_TERMS];            /* m per rad */
    double errors[MAX_OBSERVATIONS][MAX_OBSERVATIONS + 1]; /* m: standard deviations, signed */
};

/* Mean over the rows near zero of y - Y p(u), for one marker. */
static int mean_deviation(const struct wb_align *align, int marker, double u, double *mean)
{
    int n = 0;
    *mean = 0.0;
    for (size_t i = 0; i < align->n_rows; i++) {
        const struct wb_align_row *const row = &align->rows[i];
        if (row->cycle > 1 || row->phase == WB_PHASE_UNLOAD || fabs(row->tip_y) > NEAR_ZERO)
            break;
        if (isfinite(row->y[marker])) {
            *mean += row->y[marker] - row->tip_y * tip_shape(u);
            n++;
        }
    }
    *mean /= n > 0 ? n : 1;
    return n;
}

/* Standard uncertainty of a marker's place, m. */
static double own_error(const struct wb_specimen *specimen)
{
    return specimen->marker_offset_uncertainty > 0.0 ? specimen->marker_offset_uncertainty
                                                     : DEFAULT_OFFSET_ERROR;
}

static void observe_markers(const struct wb_align *align, double weight, double stiffness,
                            struct observations *obs)
{
    const struct wb_specimen *const specimen = &align->specimen;
    const int tip = specimen->n_markers - 1;
    const double length = specimen->length, bending = stiffness * pow(length, 3) / 3.0;
    const double own = own_error(specimen);
    obs->n_errors = tip + 2;
    for (int marker = 1; marker < tip; marker++) {
        const double u = specimen->markers[marker] / length, p = tip_shape(u);
        double mean;
        const int n = mean_deviation(align, marker, u, &mean);
        if (n == 0)
            continue;
        obs->value[obs->n] = mean - weight * pow(length, 4) / bending * (p / 8.0 - weight_shape(u));
        for (int term = 0; term < MAX_TERMS; term++)
            obs->design[obs->n][term] = length * term_shape(term, u);
        obs->errors[obs->n][marker] = own;
        obs->errors[obs->n][0] = -(1.0 - p) * own;
        obs->errors[obs->n][tip] = -p * own;
        obs->n++;
    }
}

/* --- the bow from the force --- */

struct loading {
    size_t n;
    double *y, *force; /* m, N: vertical force less F_w; one allocation, owned by y */
};

static void gather_loading(const struct wb_align *align, double carried, struct loading *loading)
{
    loading->n = 0;
    loading->y = wb_memory_new(2 * align->n_rows, sizeof *loading->y);
    loading->force = loading->y + align->n_rows;
    for (size_t i = 0; i < align->n_rows && align->rows[i].cycle == 1; i++) {
        const struct wb_align_row *const row = &align->rows[i];
        if (row->phase != WB_PHASE_LOAD || row->t < align->settled_t)
            continue;
        loading->y[loading->n] = row->tip_y;
        loading->force[loading->n++] = row->vertical - carried;
    }
}

/* Second-degree fit of the force up to `highest`: coefficients of 1, y, y^2. */
static bool fit_parabola(const struct loading *loading, double highest, double *coefficients)
{
    size_t n = 0;
    double deviation;
    while (n < loading->n && loading->y[n] < highest)
        n++;
    return n >= 10 && wb_fit_parabola(loading->y, loading->force, n, coefficients, &deviation) &&
           coefficients[1] > 0.0;
}

/* The root of c0 + c1 y + c2 y^2 next to zero on the rising branch; the parabola's top if it has no
 * root. */
static double root_near_zero(const double *c)
{
    const double discriminant = c[1] * c[1] - 4.0 * c[0] * c[2];
    if (!(discriminant > 0.0))
        return -0.5 * c[1] / c[2];
    return -2.0 * c[0] / (c[1] + sqrt(discriminant));
}

/* Deflection at which the loading curve crosses a force: the first mean of ten rows above it,
 * refined by a straight line over a millimetre on either side. NaN if the curve does not reach
 * it. */
static double crossing(const struct loading *loading, double force)
{
    enum {
        MEAN = 10
    };
    double sum = 0.0;
    size_t i = 0;
    for (; i < loading->n; i++) {
        sum += loading->force[i] - (i >= MEAN ? loading->force[i - MEAN] : 0.0);
        if (i + 1 >= MEAN && sum / MEAN > force)
            break;
    }
    if (i >= loading->n)
        return (double)NAN;
    const double about = loading->y[i >= MEAN / 2 ? i - MEAN / 2 : 0];
    size_t first = 0, last = i + 1;
    while (first < i && loading->y[first] < about - 1.0 * WB_MM)
        first++;
    while (last < loading->n && loading->y[last] < about + 1.0 * WB_MM)
        last++;
    struct wb_fit_line line;
    if (!wb_fit_line(loading->y + first, loading->force + first, last - first, &line) ||
        !(line.slope > 0.0))
        return (double)NAN;
    return (force - line.value) / line.slope;
}

/* The natural tip offset; `path` receives the uncertainty from the wire's yielding. */
static double bow_from_loading(const struct wb_align *align, const struct loading *loading,
                               double *path)
{
    double c[3];
    const double straight = -(align->zero_force - align->carried) / align->stiffness;
    *path = PATH_ERROR * fabs(straight);
    if (!fit_parabola(loading, EXTRAPOLATION_PART * align->specimen.length, c))
        return straight;
    const double rest = align->dataset->info.rest_level;
    const double at_rest = isfinite(rest) ? c[0] + rest * (c[1] + rest * c[2]) : 1.0;
    const double extrapolated = root_near_zero(c);
    const double mirrored = at_rest < 0.0 ? crossing(loading, -at_rest) : (double)NAN;
    const double bow = isfinite(mirrored) ? 0.5 * (rest + mirrored) : extrapolated;
    *path = PATH_ERROR * fabs(bow - straight);
    if (!isfinite(mirrored))
        *path = hypot(*path, EXTRAPOLATION_ERROR * fabs(bow));
    return bow;
}

/* Zero deflection is where the tip's marker is level with the clamp's, so both their errors enter
 * the bow in full. */
static void observe_force(const struct wb_align *align, double bow, double path,
                          struct observations *obs, double *deviation)
{
    const int tip = align->specimen.n_markers - 1;
    const double length = align->specimen.length;
    const double own = own_error(&align->specimen);
    const double vertical =
        align->frame.up_from_motion ? length * align->frame.up_uncertainty : 0.0;
    const double force =
        hypot(align->zero_force_deviation, align->zeros[0].deviation) / align->stiffness;
    const double zero = hypot(force, vertical);
    for (int term = 0; term < MAX_TERMS; term++)
        obs->design[obs->n][term] = length / (term + 2);
    obs->value[obs->n] = bow;
    obs->errors[obs->n][0] = -own;
    obs->errors[obs->n][tip] = own;
    obs->errors[obs->n][tip + 1] = hypot(zero, path);
    *deviation = sqrt(2.0 * own * own + zero * zero + path * path);
    obs->n++;
}

/* --- combination --- */

struct estimate {
    int n_terms;
    double terms[MAX_TERMS], covariance[MAX_TERMS][MAX_TERMS];
    double bow, bow_deviation; /* m, small slopes */
};

/* Generalised least squares on observations first..n-1 with `n_terms` terms. */
static bool estimate_terms(const struct observations *obs, int first, int n_terms, double length,
                           struct estimate *estimate)
{
    const int n = obs->n - first;
    double covariance[MAX_OBSERVATIONS * MAX_OBSERVATIONS];
    double whitened[MAX_OBSERVATIONS * MAX_TERMS], value[MAX_OBSERVATIONS];
    if (n < n_terms)
        return false;
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < n; k++) {
            double sum = 0.0;
            for (int e = 0; e < obs->n_errors; e++)
                sum += obs->errors[first + i][e] * obs->errors[first + k][e];
            covariance[i * n + k] = sum;
        }
        value[i] = obs->value[first + i];
        for (int t = 0; t < n_terms; t++)
            whitened[i * n_terms + t] = obs->design[first + i][t];
    }
    const size_t rows = (size_t)n, columns = (size_t)n_terms;
    gsl_matrix_view c = gsl_matrix_view_array(covariance, rows, rows);
    gsl_matrix_view w = gsl_matrix_view_array(whitened, rows, columns);
    gsl_vector_view v = gsl_vector_view_array(value, rows);
    if (gsl_linalg_cholesky_decomp1(&c.matrix) != GSL_SUCCESS)
        return false;
    /* Whitening by the Cholesky factor of the covariance turns them into ordinary least squares. */
    gsl_blas_dtrsm(CblasLeft, CblasLower, CblasNoTrans, CblasNonUnit, 1.0, &c.matrix, &w.matrix);
    gsl_blas_dtrsv(CblasLower, CblasNoTrans, CblasNonUnit, &c.matrix, &v.vector);
    double normal[MAX_TERMS * MAX_TERMS], right[MAX_TERMS];
    gsl_matrix_view a = gsl_matrix_view_array(normal, columns, columns);
    gsl_vector_view b = gsl_vector_view_array(right, columns);
    gsl_blas_dgemm(CblasTrans, CblasNoTrans, 1.0, &w.matrix, &w.matrix, 0.0, &a.matrix);
    gsl_blas_dgemv(CblasTrans, 1.0, &w.matrix, &v.vector, 0.0, &b.vector);
    if (gsl_linalg_cholesky_decomp1(&a.matrix) != GSL_SUCCESS ||
        gsl_linalg_cholesky_invert(&a.matrix) != GSL_SUCCESS)
        return false;
    *estimate = (struct estimate){.n_terms = n_terms};
    double variance = 0.0;
    for (int i = 0; i < n_terms; i++) {
        for (int k = 0; k < n_terms; k++) {
            estimate->covariance[i][k] = normal[i * n_terms + k];
            estimate->terms[i] += normal[i * n_terms + k] * right[k];
            variance += normal[i * n_terms + k] * length / (i + 2) * length / (k + 2);
        }
    }
    for (int i = 0; i < n_terms; i++)
        estimate->bow += estimate->terms[i] * length / (i + 2);
    estimate->bow_deviation = sqrt(variance);
    return true;
}

/* Two terms where the second is significant, else one. */
static bool estimate_shape(const struct observations *obs, double length, struct estimate *estimate)
{
    struct estimate two;
    if (!estimate_terms(obs, 0, 1, length, estimate))
        return false;
    if (obs->n > 2 && estimate_terms(obs, 0, 2, length, &two) &&
        fabs(two.terms[1]) > SIGNIFICANT * sqrt(two.covariance[1][1]))
        *estimate = two;
    return true;
}

static void describe_natural(struct wb_align *align, const struct estimate *estimate,
                             const struct estimate *from_markers, double from_force,
                             double from_force_deviation)
{
    struct wb_json *const object = wb_json_set_object(align->checks, "natural_shape");
    wb_align_set(object, "bow_mm", estimate->bow / WB_MM);
    wb_align_set(object, "bow_uncertainty_mm", estimate->bow_deviation / WB_MM);
    wb_align_set(object, "bow_from_markers_mm", from_markers->bow / WB_MM);
    wb_align_set(object, "bow_from_markers_uncertainty_mm", from_markers->bow_deviation / WB_MM);
    wb_align_set(object, "bow_from_force_mm", from_force / WB_MM);
    wb_align_set(object, "bow_from_force_uncertainty_mm", from_force_deviation / WB_MM);
    wb_align_set(object, "per_percent_of_counterweight_mm",
                 0.01 * align->rig.strand.counterweight * align->gravity / align->stiffness /
                     WB_MM);
    struct wb_json *const deviations = wb_json_set_array(object, "terms_uncertainty_rad");
    for (int i = 0; i < estimate->n_terms; i++)
        wb_json_append_number(deviations, sqrt(estimate->covariance[i][i]));
    const struct wb_align_correction correction = {
        .name = "natural shape",
        .unit = "mm",
        .factor = WB_MM,
        .value = estimate->bow,
        .uncertainty = estimate->bow_deviation,
    };
    wb_align_correct(align, &correction,
                     "natural tip offset (bow), upwards positive; not subtracted from the data but "
                     "passed to the model as natural_shape_rad; from the force at zero deflection "
                     "and the markers' places there; the counterweight's mass is assumed exact");
    const double apart = fabs(from_markers->bow - from_force);
    if (isfinite(from_force) && isfinite(from_markers->bow) &&
        apart > 3.0 * hypot(from_markers->bow_deviation, from_force_deviation))
        wb_align_warn(align,
                      "the bow from the markers (%.2f mm) and from the force (%.2f mm) do "
                      "not agree: check counterweight, tare and the markers' offset",
                      from_markers->bow / WB_MM, from_force / WB_MM);
}

/* Finds a rest below the tip: the strand takes load there before the tip moves. Without a rest the
 * tension begins at zero. */
static double find_rest(const struct wb_align *align)
{
    double levels[256];
    size_t n = 0;
    for (size_t i = 0; i < align->n_rows && align->rows[i].cycle == 1; i++) {
        if (align->rows[i].phase == WB_PHASE_SLACK && align->rows[i].t < align->taut_t && n < 256)
            levels[n++] = align->rows[i].tip_y;
    }
    if (n == 0)
        return (double)NAN;
    const double level = wb_fit_median(levels, n);
    const double least = fmax(0.02 * align->rig.strand.counterweight * align->gravity,
                              10.0 * align->zero_force_deviation);
    return align->zero_force + align->stiffness * level > least ? level : (double)NAN;
}

void wb_align_natural(struct wb_align *align)
{
    struct wb_test_info *const info = &align->dataset->info;
    struct observations obs;
    const double length = align->specimen.length;
    const double weight = wb_wire_mass_per_length(&align->wire) * align->gravity;
    memset(&obs, 0, sizeof obs);
    align->carried = align->rig.strand.counterweight * align->gravity + 0.375 * weight * length;
    info->rest_level = find_rest(align);
    struct estimate from_markers = {.bow = (double)NAN, .bow_deviation = (double)NAN};
    struct estimate estimate;
    double from_force = (double)NAN, from_force_deviation = (double)NAN;
    observe_markers(align, weight, align->stiffness, &obs);
    if (obs.n > 0 && !estimate_terms(&obs, 0, 1, length, &from_markers))
        from_markers.bow = from_markers.bow_deviation = (double)NAN;
    /* The force determines the bow only if the tare is certainly that of an unloaded cell. */
    if (align->slack_seen) {
        struct loading loading;
        double path;
        gather_loading(align, align->carried, &loading);
        from_force = bow_from_loading(align, &loading, &path);
        free(loading.y);
        observe_force(align, from_force, path, &obs, &from_force_deviation);
    }
    if (obs.n == 0 || !estimate_shape(&obs, length, &estimate)) {
        wb_align_warn(align, "the natural shape cannot be determined from this recording: the wire "
                             "is assumed straight");
        return;
    }
    info->n_natural_shape = estimate.n_terms;
    memcpy(info->natural_shape, estimate.terms, sizeof estimate.terms);
    describe_natural(align, &estimate, &from_markers, from_force, from_force_deviation);
}
