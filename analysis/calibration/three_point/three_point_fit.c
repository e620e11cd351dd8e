#include "analysis/calibration/three_point/three_point_fit.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_blas.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_matrix.h>
#include <gsl/gsl_multifit_nlinear.h>

#include "analysis/calibration/paper/calibrate.h"
#include "analysis/calibration/three_point/three_point_place.h"
#include "analysis/dataset/least_squares.h"
#include "base/circle.h"
#include "base/memory.h"
#include "base/progress.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "three-point"

static const double difference = 1e-3;     /* of the free parameters, for derivatives */
static const double converged_step = 5e-4; /* largest step of a free parameter at convergence */
static const double settled_sum = 1e-4;
/* Smallest modulus of a part over its initial value: without it the search would continue towards
 * zero. */
static const double least_modulus = 3e-3;
static const double lost_residual = 1e4;
static const double contact_scale = 2e-3; /* of the span: unit of the first contact's parameter, */
static const double bow_scale = 1e-2;     /* and of the natural bow's */
/* A bow is identifiable if its error is below this part of its prior. */
static const double identifiable_part = 0.5;
/* The isotropic share: standard deviation of its prior about one half, and the step of its
 * derivative at the end, taken inwards. Its parameter may leave the range 0 to 1, at a residual of
 * one for every share_wall beyond it: many wires are at an end of the range, and slow convergence
 * towards it would delay the other parameters. */
static const double share_spread = 0.5, share_step = 0.02, share_wall = 0.02;
/* Weight of the prior that keeps a parameter finite when neither readings nor another prior
 * determine it; number of standard errors by which a law is moved, and largest change of a
 * parameter. In units of the free parameters. */
static const double weak_prior = 1e-6, moved_by = 0.1, farthest = 1.0;
/* Smallest yield strain of the parts, as part of the strain at the first point; smaller with
 * unloading, which determines the stiffness before the first point: yielding below the smallest
 * yield strain would be fitted as a later contact. */
static const double before_first = 0.25, before_first_back = 0.1;

const struct wb_setting wb_three_point_fit_rows[WB_THREE_POINT_FIT_ROWS] = {
    {WB_ROW_NUMBER(wb_three_point_fit_settings, force_share, "curve_share", 1e-6, 1.0, 5e-3),
     WB_ROW_OPTION("curve-share", "R",
                   "Smallest error of a point, as a part of the largest force")},
    {WB_ROW_NUMBER(wb_three_point_fit_settings, modulus_prior, "part_prior", 1e-2, 1e3, 2.0),
     WB_ROW_OPTION("part-prior", "X",
                   "Prior of the second differences of the yielding parts' log moduli"),
     .applies = WB_CALIBRATE_COMMAND},
    {WB_ROW_NUMBER(wb_three_point_fit_settings, contact_prior, "contact_prior", 1e-6, 1.0, 5e-3),
     WB_ROW_OPTION("contact-prior", "R",
                   "Prior of the error of the first contact, as a part of the span")},
    {WB_ROW_NUMBER(wb_three_point_fit_settings, bow_prior, "bow_prior", 1e-6, 0.1, 0.0),
     WB_ROW_OPTION(
         "bow-prior", "R",
         "Prior of the bow of a wire whose specimen file gives none, as a part of the span"),
     .otherwise = "straight"},
    {WB_ROW_INTEGER(wb_three_point_fit_settings, n_elements, "half_elements", 8, 500, 32),
     WB_ROW_OPTION("half-elements", "N", "Beam elements of half the wire")},
    {WB_ROW_INTEGER(wb_three_point_fit_settings, max_iterations, "curve_iterations", 1, 10000, 40),
     WB_ROW_OPTION("curve-iterations", "N", "Maximum number of iterations of a fit"),
     .applies = WB_CALIBRATE_COMMAND},
};

enum {
    SHARE = WB_THREE_POINT_PARTS /* index of the isotropic share among the free parameters */
};

struct problem {
    const struct wb_three_point_data *data;
    const struct wb_three_point_strains *strains;
    const struct wb_three_point_fit_settings *settings;
    struct wb_three_point_model *model;
    /* Parameters of the law (moduli, and share), then the bow if it is free, and last the
     * contact. */
    int n_law, n_curve, n_free, n_residuals; /* n_curve: parameters that change the curve; including
                                                the contact if there is unloading, which begins at
                                                the turn, whose distance from the contact changes */
    double bow, bow_deviation; /* m: middle and standard deviation of its prior; 0: fixed */
    double start_bow;
    double start_modulus[WB_THREE_POINT_PARTS], yield_strain[WB_THREE_POINT_PARTS];
    double start_share;
    double contact, force_scale;
    double end; /* m of travel less the machine's deformation: the last one that is computed */

    /* The law that was computed last. */
    double of[WB_THREE_POINT_MOST_FREE];
    bool is_computed;
    struct wb_three_point_run run;
    enum wb_status status;
};

static double contact_of(const struct problem *p, const double *x)
{
    return p->contact + contact_scale * p->data->info.length * x[p->n_free - 1];
}

/* The largest deflection. A loading beyond it is extrapolated linearly, and need not be computed
 * again. */
static double deepest_of(const struct problem *p, const double *x)
{
    return p->end - (p->data->has_unloading ? contact_of(p, x) : p->data->first_contact);
}

static double bow_of(const struct problem *p, const double *x)
{
    return p->start_bow +
           (p->bow_deviation > 0.0 ? bow_scale * p->data->info.length * x[p->n_law] : 0.0);
}

/* The isotropic share is the last parameter of the law. */
static double share_of(const struct problem *p, const double *x)
{
    return p->n_law > SHARE ? fmin(fmax(0.5 + x[SHARE], 0.0), 1.0) : 0.0;
}

static void law_of(const struct problem *p, const double *x, struct wb_law *law)
{
    struct wb_law_part parts[WB_THREE_POINT_PARTS];
    const double share = share_of(p, x);
    const double poissons_ratio =
        p->data->info.poissons_ratio > 0.0 ? p->data->info.poissons_ratio : 0.4;
    for (int i = 0; i < WB_THREE_POINT_PARTS; i++)
        parts[i] = (struct wb_law_part){p->start_modulus[i] *
                                            (least_modulus + wb_least_squares_positive(x[i])),
                                        p->yield_strain[i]};
    wb_law_init_parallel(law, parts, WB_THREE_POINT_PARTS, share, poissons_ratio);
}

/* Strain of the outer fibre in the middle of an elastic beam at a deflection. */
static double strain_at(const struct wb_three_point_data *data, double deflection)
{
    return 6.0 * deflection * data->info.outer_diameter / (data->info.length * data->info.length);
}

struct wb_three_point_strains wb_three_point_fit_strains(const struct wb_three_point_data *data)
{
    const double distance =
        fmax(data->points[0].travel - data->first_contact, 1e-3 * data->info.length);
    /* A wire that yields has a larger curvature at midspan. */
    const double before = data->has_unloading ? before_first_back : before_first;
    return (struct wb_three_point_strains){before * strain_at(data, distance),
                                           1.5 *
                                               strain_at(data, data->usable - data->first_contact)};
}

static void start_law(struct problem *p, const struct wb_three_point_fit *start)
{
    const struct wb_three_point_data *const data = p->data;
    const struct wb_three_point_point *const first = &data->points[0];
    const double span = data->info.length, d = data->info.outer_diameter;
    const double distance = fmax(first->travel - data->first_contact, 1e-3 * span);
    const double EI = fmax(first->force, 1e-3 * data->max_force) * pow(span, 3) / (48.0 * distance);
    const double E = EI / wb_circle_second_moment(d);
    const struct wb_three_point_strains strains =
        p->strains ? *p->strains : wb_three_point_fit_strains(data);
    const double ratio = strains.last / strains.first;

    for (int i = 0; i < WB_THREE_POINT_PARTS; i++) {
        p->yield_strain[i] =
            i + 1 < WB_THREE_POINT_PARTS
                ? strains.first * pow(ratio, (double)i / (WB_THREE_POINT_PARTS - 1))
                : (double)INFINITY;
        p->start_modulus[i] = E / WB_THREE_POINT_PARTS;
    }
    p->contact = data->first_contact;
    p->start_bow = p->bow;
    p->start_share = 0.0;
    if (!start)
        return;
    for (int i = 0; i < WB_THREE_POINT_PARTS; i++) {
        p->start_modulus[i] = start->law.parts[i].modulus;
        p->yield_strain[i] = start->law.parts[i].yield_strain;
    }
    p->contact = start->first_contact;
    p->start_bow = start->bow;
    p->start_share = start->law.isotropic_share - 0.5;
}

/* The whole curve of a law; run.reached: it was computed to its end. */
static void compute(struct problem *p, const double *x)
{
    const size_t size = (size_t)p->n_curve * sizeof *x;
    struct wb_law law;
    struct wb_reason why;

    if (p->is_computed && memcmp(p->of, x, size) == 0)
        return;
    memcpy(p->of, x, size);
    p->is_computed = true;
    p->run = (struct wb_three_point_run){.reached = false};
    law_of(p, x, &law);
    if (wb_law_check(&law, &why) != WB_OK)
        return;
    p->status = wb_three_point_model_run(
        p->model, &law, wb_three_point_model_curvature(&p->data->info, bow_of(p, x)),
        deepest_of(p, x), p->data->has_unloading, &p->run);
}

static int residuals(struct problem *p, const double *x, double *r)
{
    const struct wb_three_point_data *const data = p->data;
    const double span = data->info.length;
    const double contact = contact_of(p, x);
    struct wb_law law;
    int at = 0;

    compute(p, x);
    if (p->status != WB_OK)
        return GSL_EFAILED;
    if (!p->run.reached) {
        for (int i = 0; i < p->n_residuals; i++)
            r[i] = lost_residual;
        return GSL_SUCCESS;
    }
    for (int i = 0; i < data->n_points; i++) {
        const struct wb_three_point_point *const point = &data->points[i];
        const double force =
            wb_three_point_model_force(p->model, point->travel - contact, point->is_unloading);
        r[at++] = (force - point->force) / p->force_scale;
    }
    law_of(p, x, &law);
    at += wb_least_squares_smooth_parts(law.parts, WB_THREE_POINT_PARTS, p->settings->modulus_prior,
                                        r + at);
    r[at++] = (contact - data->first_contact) / (p->settings->contact_prior * span);
    if (p->bow_deviation > 0.0)
        r[at++] = (bow_of(p, x) - p->bow) / p->bow_deviation;
    if (p->n_law > SHARE) {
        const double inside = share_of(p, x) - 0.5;
        r[at++] = inside / share_spread + (x[SHARE] - inside) / share_wall;
    }
    return at == p->n_residuals ? GSL_SUCCESS : GSL_ESANITY;
}

static int gsl_residuals(const gsl_vector *x, void *context, gsl_vector *f)
{
    return residuals(context, x->data, f->data);
}

/* Difference quotients; that of the first contact needs no run. */
static int gsl_slopes(const gsl_vector *x, void *context, gsl_matrix *J)
{
    struct problem *const p = context;
    const size_t n = (size_t)p->n_residuals;
    double moved[WB_THREE_POINT_MOST_FREE];
    double *const base = wb_memory_new(2 * n, sizeof *base);
    double *const other = base + n;
    int status = residuals(p, x->data, base);
    for (int step = 0; step < p->n_free && status == GSL_SUCCESS; step++) {
        const int k = p->n_free - 1 - step; /* the contact first, while the curve is available */
        memcpy(moved, x->data, (size_t)p->n_free * sizeof *moved);
        const double by = k >= p->n_law ? 10.0 * difference : difference;
        moved[k] += by;
        status = residuals(p, moved, other);
        for (size_t i = 0; i < n; i++)
            gsl_matrix_set(J, i, (size_t)k, (other[i] - base[i]) / by);
    }
    free(base);
    return status;
}

/* Correction for correlated residuals: mean number of neighbours with the same sign, over the two
 * of white noise. */
static double residual_correlation(const gsl_vector *f, int n)
{
    int rows = 1;
    for (int i = 1; i < n; i++)
        rows += (gsl_vector_get(f, (size_t)i) < 0.0) != (gsl_vector_get(f, (size_t)i - 1) < 0.0);
    return fmax(1.0, 0.5 * n / rows);
}

/* Covariance of the parameters from the readings, with variance `variance`, and from the priors,
 * with their standard deviations: H^-1 (variance Jr'Jr + Jp'Jp) H^-1. */
static bool find_covariance(const gsl_matrix *J, size_t n_readings, double variance,
                            gsl_matrix *covariance)
{
    const size_t n = J->size2;
    const gsl_matrix_const_view readings = gsl_matrix_const_submatrix(J, 0, 0, n_readings, n);
    const gsl_matrix_const_view priors =
        gsl_matrix_const_submatrix(J, n_readings, 0, J->size1 - n_readings, n);
    gsl_matrix *const H = wb_memory_need(gsl_matrix_alloc(n, n));
    gsl_matrix *const M = wb_memory_need(gsl_matrix_alloc(n, n));
    gsl_matrix *const HM = wb_memory_need(gsl_matrix_alloc(n, n));
    gsl_matrix_set_identity(H);
    gsl_blas_dsyrk(CblasLower, CblasTrans, 1.0, J, weak_prior, H);
    gsl_matrix_set_identity(M);
    gsl_blas_dgemm(CblasTrans, CblasNoTrans, 1.0, &priors.matrix, &priors.matrix, weak_prior, M);
    gsl_blas_dgemm(CblasTrans, CblasNoTrans, variance, &readings.matrix, &readings.matrix, 1.0, M);
    const bool good = gsl_linalg_cholesky_decomp1(H) == GSL_SUCCESS &&
                      gsl_linalg_cholesky_invert(H) == GSL_SUCCESS;
    if (good) {
        gsl_blas_dgemm(CblasNoTrans, CblasNoTrans, 1.0, H, M, 0.0, HM);
        gsl_blas_dgemm(CblasNoTrans, CblasNoTrans, 1.0, HM, H, 0.0, covariance);
    }
    gsl_matrix_free(H);
    gsl_matrix_free(M);
    gsl_matrix_free(HM);
    return good;
}

/* Derivatives with respect to the isotropic share, instead of its parameter, for which they are
 * zero outside 0 to 1. */
static bool slope_of_share(struct problem *p, const gsl_vector *x, const gsl_vector *f,
                           gsl_matrix *J)
{
    double moved[WB_THREE_POINT_MOST_FREE];
    double *const r = wb_memory_new(f->size, sizeof *r);
    const double share = share_of(p, x->data), by = share > 0.5 ? -share_step : share_step;
    memcpy(moved, x->data, (size_t)p->n_free * sizeof *moved);
    moved[SHARE] = share + by - 0.5;
    const bool good = residuals(p, moved, r) == GSL_SUCCESS && p->run.reached;
    for (size_t i = 0; good && i < f->size; i++)
        gsl_matrix_set(J, i, SHARE, (r[i] - gsl_vector_get(f, i)) / by);
    if (good)
        gsl_matrix_set(J, f->size - 1, SHARE, 1.0 / share_spread);
    free(r);
    return good;
}

/* Moves the law along the columns of the covariance's triangular factor, which overwrites the
 * covariance; a share is kept within 0 to 1. */
static void move_law(const struct problem *p, const gsl_vector *x, gsl_matrix *covariance,
                     struct wb_three_point_fit *fit)
{
    const size_t n = (size_t)p->n_free;
    const bool is_share_free = p->n_law > SHARE;
    const double share = share_of(p, x->data);
    fit->n_moved = 0;
    if (gsl_linalg_cholesky_decomp1(covariance) != GSL_SUCCESS)
        return;
    for (size_t k = 0; k < n; k++) {
        double step[WB_THREE_POINT_MOST_FREE], largest = 1e-300;
        for (size_t i = k; i < n; i++)
            largest = fmax(largest, fabs(gsl_matrix_get(covariance, i, k)));
        double by = fmin(moved_by, farthest / largest);
        if (is_share_free && k <= SHARE) {
            const double of = gsl_matrix_get(covariance, SHARE, k);
            by = fmin(by, 0.5 / fmax(fabs(of), 1e-300));
            by = (share > 0.5) == (of > 0.0) ? -by : by;
        }
        for (size_t i = 0; i < n; i++)
            step[i] = gsl_vector_get(x, i) + (i < k ? 0.0 : by * gsl_matrix_get(covariance, i, k));
        if (is_share_free)
            step[SHARE] =
                share - 0.5 + (k <= SHARE ? by * gsl_matrix_get(covariance, SHARE, k) : 0.0);
        law_of(p, step, &fit->moved[fit->n_moved]);
        fit->moved_by[fit->n_moved++] = by;
    }
}

static void find_errors(struct problem *p, gsl_multifit_nlinear_workspace *w,
                        struct wb_three_point_fit *fit)
{
    const size_t n = (size_t)p->n_free, contact = n - 1, bow = (size_t)p->n_law;
    const double span = p->data->info.length;
    gsl_matrix *const covariance = wb_memory_need(gsl_matrix_alloc(n, n));
    fit->first_contact_error = (double)NAN;
    double sum = 0.0;
    for (size_t i = 0; i < (size_t)p->data->n_points; i++)
        sum += pow(gsl_vector_get(w->f, i), 2);
    const double variance = sum / fmax(1.0, p->data->n_points - p->n_free) *
                            residual_correlation(w->f, p->data->n_points);
    if ((p->n_law <= SHARE || slope_of_share(p, w->x, w->f, w->J)) &&
        find_covariance(w->J, (size_t)p->data->n_points, variance, covariance)) {
        const double of_contact = sqrt(gsl_matrix_get(covariance, contact, contact));
        fit->first_contact_error = contact_scale * span * of_contact;
        if (p->bow_deviation > 0.0) {
            const double of_bow = sqrt(gsl_matrix_get(covariance, bow, bow));
            fit->bow_error = bow_scale * span * of_bow;
            fit->bow_contact_correlation =
                gsl_matrix_get(covariance, bow, contact) / (of_bow * of_contact);
            fit->bow_off = (fit->bow - p->bow) / p->bow_deviation;
            fit->is_bow_identifiable = fit->bow_error < identifiable_part * p->bow_deviation;
        }
        move_law(p, w->x, covariance, fit);
    }
    gsl_matrix_free(covariance);
}

static enum wb_status search(struct problem *p, const struct wb_three_point_bench *bench,
                             gsl_multifit_nlinear_workspace *w, struct wb_three_point_fit *fit,
                             struct wb_reason *why)
{
    gsl_multifit_nlinear_fdf fdf = {
        .f = gsl_residuals,
        .df = gsl_slopes,
        .n = (size_t)p->n_residuals,
        .p = (size_t)p->n_free,
        .params = p,
    };
    double zero[WB_THREE_POINT_MOST_FREE] = {0.0};
    zero[SHARE] = p->n_law > SHARE ? p->start_share : 0.0;
    const gsl_vector_view x = gsl_vector_view_array(zero, (size_t)p->n_free);
    const int started = gsl_multifit_nlinear_init(&x.vector, &fdf, w);
    if (p->status != WB_OK)
        return p->status;
    if (started != GSL_SUCCESS || !p->run.reached)
        return wb_fail_to(why, WB_ERR_CONVERGENCE,
                          "wire '%s', sample %d: the beam reaches %.3g of %.3g mm of deflection "
                          "(%s) with a nose of %.3g mm and friction %.2g at the initial guess: use "
                          "less of the test (usable_travel_mm, --usable-mm)",
                          p->data->info.wire, p->data->info.sample, p->run.travel / WB_MM,
                          deepest_of(p, zero) / WB_MM, wb_three_point_bending_end_name(p->run.end),
                          bench->nose_radius / WB_MM, bench->friction);
    const struct wb_least_squares_search how = {
        .max_iterations = p->settings->max_iterations,
        .smallest_step = converged_step,
        .smallest_gain = settled_sum,
        .patience = 1,
        .status = &p->status,
    };
    fit->is_converged = wb_least_squares_iterate(w, &how, NULL);
    if (p->status != WB_OK)
        return p->status;
    /* The curve of the result, not of the last trial. */
    double *const r = wb_memory_new((size_t)p->n_residuals, sizeof *r);
    const int status = residuals(p, w->x->data, r);
    double sum = 0.0;
    for (int i = 0; status == GSL_SUCCESS && i < p->data->n_points; i++)
        sum += r[i] * r[i];
    free(r);
    if (status != GSL_SUCCESS || !p->run.reached)
        return wb_fail_to(why, WB_ERR_CONVERGENCE, "wire '%s', sample %d: the fit diverged",
                          p->data->info.wire, p->data->info.sample);
    fit->misfit = sqrt(sum / p->data->n_points) * p->force_scale / p->data->max_force;
    law_of(p, w->x->data, &fit->law);
    fit->first_contact = contact_of(p, w->x->data);
    fit->bow = bow_of(p, w->x->data);
    fit->largest_curvature = p->run.largest_curvature;
    fit->wrapped = p->run.wrapped;
    find_errors(p, w, fit);
    return WB_OK;
}

enum wb_status wb_three_point_fit_run(struct wb_three_point_fit *fit,
                                      const struct wb_three_point_data *data,
                                      const struct wb_three_point_bench *bench,
                                      const struct wb_three_point_strains *strains,
                                      const struct wb_three_point_fit *start,
                                      const struct wb_three_point_fit_settings *settings,
                                      struct wb_reason *why)
{
    const double begin = wb_progress_thread_cpu();
    const double no_step[WB_THREE_POINT_MOST_FREE] = {0.0};
    struct problem p = {.data = data, .strains = strains, .settings = settings};
    struct wb_law law;
    const double last_force = data->points[wb_three_point_data_count_loading(data) - 1].force;

    *fit = (struct wb_three_point_fit){.is_converged = false};
    p.end = data->usable - bench->compliance * last_force;
    if (!(p.end > data->first_contact))
        return wb_fail_to(
            why, WB_ERR_DATA,
            "wire '%s', sample %d: a compliance of %.3g mm/N accounts for all of the travel",
            data->info.wire, data->info.sample, bench->compliance / WB_MM);
    p.n_law = WB_THREE_POINT_PARTS + data->has_unloading;
    wb_three_point_place_bow(&data->info, settings, &p.bow, &p.bow_deviation);
    const int is_bow_free = p.bow_deviation > 0.0;
    p.n_free = p.n_law + is_bow_free + 1;
    p.n_curve = data->has_unloading ? p.n_free : p.n_free - 1;
    p.n_residuals =
        data->n_points + WB_THREE_POINT_PARTS - 3 + 1 + is_bow_free + data->has_unloading;
    p.force_scale = wb_three_point_place_error(data, settings);
    start_law(&p, start);
    law_of(&p, no_step, &law);
    WB_TRY(wb_three_point_model_create(&p.model, &data->info, bench, &law, settings->n_elements));

    gsl_multifit_nlinear_workspace *const w = wb_least_squares_create(p.n_residuals, p.n_free);
    const enum wb_status status = search(&p, bench, w, fit, why);
    gsl_multifit_nlinear_free(w);
    wb_three_point_model_destroy(p.model);
    fit->cpu_s = wb_progress_thread_cpu() - begin;
    return status;
}
