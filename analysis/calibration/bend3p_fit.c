#include "analysis/calibration/bend3p_fit.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <gsl/gsl_blas.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_matrix.h>
#include <gsl/gsl_multifit_nlinear.h>
#include <gsl/gsl_spline.h>

#include "analysis/calibration/least_squares.h"
#include "base/units.h"
#include "fe/trial/bending3p.h"

#define WB_LOG_DOMAIN "three-point"

enum {
    STEPS = 36, /* of the computed loading, */
    BACK = 24   /* and of its way back */
};

static const double difference = 1e-3; /* of the free numbers, for slopes */
static const double arrived = 5e-4;    /* largest step of a free number at the end */
static const double settled_sum = 1e-5;
static const double lost_residual = 1e4;
static const double contact_scale = 2e-3; /* of the span: unit of the first contact's number */
static const double share_prior = 4.0;    /* of the logistic number */
/* Parts may yield before the first point, down to this part of its strain. */
static const double before_first = 0.25;

#define AT(field) offsetof(struct wb_bend3p_fit_settings, field)

const struct wb_setting wb_bend3p_fit_rows[WB_BEND3P_FIT_ROWS] = {
    {.name = "curve_share",
     .type = WB_SETTING_NUMBER,
     .offset = AT(force_share),
     .least = 1e-6,
     .largest = 1.0,
     .fallback = 5e-3,
     .option = "curve-share",
     .argument = "R",
     .help = "Error of a point as a part of the largest force, where the noise is less"},
    {.name = "part_prior",
     .type = WB_SETTING_NUMBER,
     .offset = AT(modulus_prior),
     .least = 1e-2,
     .largest = 1e3,
     .fallback = 2.0,
     .option = "part-prior",
     .argument = "X",
     .help = "Prior of the second differences of the logarithms of the moduli of parts that yield"},
    {.name = "contact_prior",
     .type = WB_SETTING_NUMBER,
     .offset = AT(contact_prior),
     .least = 1e-6,
     .largest = 1.0,
     .fallback = 5e-3,
     .option = "contact-prior",
     .argument = "R",
     .help = "Part of the span by which the first contact may well be off where it seems to be"},
    {.name = "half_elements",
     .type = WB_SETTING_INTEGER,
     .offset = AT(n_elements),
     .least = 8,
     .largest = 500,
     .fallback = 32,
     .option = "half-elements",
     .argument = "N",
     .help = "Beam elements of half the wire"},
    {.name = "curve_iterations",
     .type = WB_SETTING_INTEGER,
     .offset = AT(max_iterations),
     .least = 1,
     .largest = 10000,
     .fallback = 30,
     .option = "curve-iterations",
     .argument = "N",
     .help = "Most iterations of a fit"},
};

#undef AT

struct problem {
    const struct wb_bend3p_data *data;
    const struct wb_bend3p_bench *bench;
    const struct wb_bend3p_fit_settings *settings;
    struct wb_bending3p *bending;
    int n_law, n_free, n_residuals; /* n_law: moduli, and share */
    double start_modulus[WB_BEND3P_PARTS], yield_strain[WB_BEND3P_PARTS];
    double start_share;
    double contact, force_scale;
    double deepest; /* m: the largest deflection that is computed */

    /* The curve of the law last computed: what a nose does, whenever it came. */
    double of[WB_BEND3P_MOST_FREE];
    bool is_computed, reached;
    int n_curve, n_back;
    double travel[STEPS + 1], force[STEPS + 1]; /* beyond the first contact */
    double back_travel[BACK + 1], back_force[BACK + 1];
    double largest_curvature, wrapped;
    int runs;
    enum wb_status status;
};

/* The isotropic share comes last of the law's numbers, the first contact after them. */
static void law_of(const struct problem *p, const double *x, struct wb_law *law)
{
    struct wb_law_part parts[WB_BEND3P_PARTS];
    const double share = p->n_law > WB_BEND3P_PARTS
                             ? 1.0 / (1.0 + exp(-(p->start_share + x[WB_BEND3P_PARTS])))
                             : 0.0;
    const double poissons_ratio =
        p->data->info.poissons_ratio > 0.0 ? p->data->info.poissons_ratio : 0.4;
    for (int i = 0; i < WB_BEND3P_PARTS; i++)
        parts[i] =
            (struct wb_law_part){p->start_modulus[i] * exp(fmin(x[i], 50.0)), p->yield_strain[i]};
    wb_law_init_parallel(law, parts, WB_BEND3P_PARTS, share, poissons_ratio);
}

/* Strain of the outer fibre in the middle of an elastic beam at a deflection. */
static double strain_at(const struct wb_bend3p_data *data, double deflection)
{
    return 6.0 * deflection * data->info.outer_diameter / (data->info.length * data->info.length);
}

void wb_bend3p_fit_strains(const struct wb_bend3p_data *data, double *first, double *last)
{
    const double way = fmax(data->points[0].travel - data->first_contact, 1e-3 * data->info.length);
    *first = before_first * strain_at(data, way);
    /* A wire that yields bends more sharply in the middle. */
    *last = 1.5 * strain_at(data, data->usable - data->first_contact);
}

static void start_law(struct problem *p, const struct wb_bend3p_fit *start)
{
    const struct wb_bend3p_data *const data = p->data;
    const struct wb_bend3p_point *const first = &data->points[0];
    const double span = data->info.length, d = data->info.outer_diameter;
    const double way = fmax(first->travel - data->first_contact, 1e-3 * span);
    const double EI = fmax(first->force, 1e-3 * data->max_force) * pow(span, 3) / (48.0 * way);
    const double E = EI * 64.0 / (M_PI * pow(d, 4));
    double low, high;
    wb_bend3p_fit_strains(data, &low, &high);
    if (p->bench->first_strain > 0.0) {
        low = p->bench->first_strain;
        high = p->bench->last_strain;
    }
    const double ratio = high / low;

    for (int i = 0; i < WB_BEND3P_PARTS; i++) {
        p->yield_strain[i] = i + 1 < WB_BEND3P_PARTS
                                 ? low * pow(ratio, (double)i / (WB_BEND3P_PARTS - 1))
                                 : (double)INFINITY;
        p->start_modulus[i] = E / WB_BEND3P_PARTS;
    }
    p->contact = data->first_contact;
    p->start_share = 0.0;
    if (!start)
        return;
    for (int i = 0; i < WB_BEND3P_PARTS; i++) {
        p->start_modulus[i] = start->law.parts[i].modulus;
        p->yield_strain[i] = start->law.parts[i].yield_strain;
    }
    p->contact = start->first_contact;
    const double share = fmin(fmax(start->law.isotropic_share, 1e-3), 1.0 - 1e-3);
    p->start_share = log(share / (1.0 - share));
}

/* One equilibrium of the curve; false when it is not reached. */
static bool add(struct problem *p, double deflection, double *travel, double *force)
{
    struct wb_bending3p_point point;
    p->status = wb_bending3p_move(p->bending, deflection, &point);
    if (p->status != WB_OK || point.end != WB_BENDING3P_CONVERGED)
        return false;
    *travel = point.travel;
    *force = point.force;
    p->largest_curvature = fmax(p->largest_curvature, point.middle_curvature);
    p->wrapped = fmax(p->wrapped, point.wrapped);
    return true;
}

/* The whole curve of a law; `reached` says whether it came to its end. */
static void compute(struct problem *p, const double *x)
{
    const size_t size = (size_t)p->n_law * sizeof *x;
    struct wb_law law;
    struct wb_reason why;

    if (p->is_computed && memcmp(p->of, x, size) == 0)
        return;
    memcpy(p->of, x, size);
    p->is_computed = true;
    p->reached = false;
    p->n_curve = p->n_back = 0;
    p->largest_curvature = p->wrapped = 0.0;
    law_of(p, x, &law);
    if (wb_law_check(&law, &why) != WB_OK)
        return;
    p->runs++;
    p->status = wb_bending3p_set_law(p->bending, &law);
    if (p->status != WB_OK)
        return;
    p->travel[0] = p->force[0] = 0.0;
    for (int i = 1; i <= STEPS; i++) {
        /* Denser at the start, where the curve bends most. */
        const double part = (double)i / STEPS;
        if (!add(p, p->deepest * part * (0.35 + 0.65 * part), &p->travel[i], &p->force[i]))
            return;
        p->n_curve = i;
        if (!(p->travel[i] > p->travel[i - 1]))
            return;
    }
    for (int i = 0; p->data->has_unloading && i <= BACK; i++) {
        /* From the turn on; kept by growing travel. */
        const int at = BACK - i;
        double *const travel = &p->back_travel[at], *const force = &p->back_force[at];
        if (!add(p, p->deepest * (1.0 - pow((double)i / BACK, 1.5)), travel, force))
            return;
        p->n_back++;
    }
    p->reached = true;
}

/* Force of a branch at a travel; zero before its first point. Beyond the last it goes on straight.
 */
static double force_on(gsl_spline *spline, gsl_interp_accel *accel, const double *x,
                       const double *y, int n, double at)
{
    if (at <= x[0])
        return y[0];
    if (at >= x[n - 1])
        return y[n - 1] + (at - x[n - 1]) * (y[n - 1] - y[n - 2]) / (x[n - 1] - x[n - 2]);
    return gsl_spline_eval(spline, at, accel);
}

static int residuals(struct problem *p, const double *x, double *r)
{
    const struct wb_bend3p_data *const data = p->data;
    const double span = data->info.length;
    const double contact = p->contact + contact_scale * span * x[p->n_law];
    struct wb_law law;
    int at = 0;

    compute(p, x);
    if (p->status != WB_OK)
        return GSL_EFAILED;
    if (!p->reached) {
        for (int i = 0; i < p->n_residuals; i++)
            r[i] = lost_residual;
        return GSL_SUCCESS;
    }
    const int n_back = p->n_back;
    gsl_interp_accel *const accel = gsl_interp_accel_alloc();
    gsl_spline *const there = gsl_spline_alloc(gsl_interp_steffen, STEPS + 1);
    gsl_spline *const back =
        n_back > 3 ? gsl_spline_alloc(gsl_interp_steffen, (size_t)n_back) : NULL;
    int status = accel && there && (back || n_back <= 3) ? GSL_SUCCESS : GSL_ENOMEM;
    if (status == GSL_SUCCESS)
        status = gsl_spline_init(there, p->travel, p->force, STEPS + 1);
    if (status == GSL_SUCCESS && back)
        status = gsl_spline_init(back, p->back_travel, p->back_force, (size_t)n_back);
    for (int i = 0; status == GSL_SUCCESS && i < data->n_points; i++) {
        const struct wb_bend3p_point *const point = &data->points[i];
        const double way = point->travel - contact;
        if (i > 0 && point->is_unloading && !data->points[i - 1].is_unloading)
            gsl_interp_accel_reset(accel);
        const double force = point->is_unloading && back
                                 ? force_on(back, accel, p->back_travel, p->back_force, n_back, way)
                                 : force_on(there, accel, p->travel, p->force, STEPS + 1, way);
        r[at++] = (force - point->force) / p->force_scale;
    }
    gsl_spline_free(there);
    if (back)
        gsl_spline_free(back);
    gsl_interp_accel_free(accel);
    if (status != GSL_SUCCESS)
        return status;
    law_of(p, x, &law);
    at += wb_least_squares_smooth_parts(law.parts, WB_BEND3P_PARTS, p->settings->modulus_prior,
                                        r + at);
    r[at++] = (contact - data->first_contact) / (p->settings->contact_prior * span);
    if (p->n_law > WB_BEND3P_PARTS)
        r[at++] = (p->start_share + x[WB_BEND3P_PARTS]) / share_prior;
    return at == p->n_residuals ? GSL_SUCCESS : GSL_ESANITY;
}

static int gsl_residuals(const gsl_vector *x, void *context, gsl_vector *f)
{
    return residuals(context, x->data, f->data);
}

/* Differences; that of the first contact needs no run. */
static int gsl_slopes(const gsl_vector *x, void *context, gsl_matrix *J)
{
    struct problem *const p = context;
    const size_t n = (size_t)p->n_residuals;
    double moved[WB_BEND3P_MOST_FREE];
    double *const base = calloc(2 * n, sizeof *base);
    if (!base)
        return GSL_ENOMEM;
    double *const other = base + n;
    int status = residuals(p, x->data, base);
    for (int step = 0; step < p->n_free && status == GSL_SUCCESS; step++) {
        const int k = p->n_free - 1 - step; /* the contact first, while the curve is there */
        memcpy(moved, x->data, (size_t)p->n_free * sizeof *moved);
        const double by = k == p->n_law ? 10.0 * difference : difference;
        moved[k] += by;
        status = residuals(p, moved, other);
        for (size_t i = 0; i < n; i++)
            gsl_matrix_set(J, i, (size_t)k, (other[i] - base[i]) / by);
    }
    free(base);
    return status;
}

/* Neighbouring residuals of one sign tell the same: how many in a row, over the two of noise. */
static double alike_in_a_row(const gsl_vector *f, int n)
{
    int rows = 1;
    for (int i = 1; i < n; i++)
        rows += (gsl_vector_get(f, (size_t)i) < 0.0) != (gsl_vector_get(f, (size_t)i - 1) < 0.0);
    return fmax(1.0, 0.5 * n / rows);
}

static void find_errors(struct problem *p, gsl_multifit_nlinear_workspace *w,
                        struct wb_bend3p_fit *fit)
{
    const size_t n = (size_t)p->n_free;
    gsl_matrix *const covariance = gsl_matrix_alloc(n, n);
    double sum;
    fit->first_contact_error = (double)NAN;
    if (!covariance)
        return;
    gsl_blas_ddot(w->f, w->f, &sum);
    /* Not less than the points' own error: a curve without noise is not known without end. */
    const double variance = fmax(sum / fmax(1.0, p->data->n_points - p->n_free), 0.0) *
                            alike_in_a_row(w->f, p->data->n_points);
    if (gsl_multifit_nlinear_covar(w->J, 0.0, covariance) == GSL_SUCCESS) {
        fit->first_contact_error = contact_scale * p->data->info.length *
                                   sqrt(variance * gsl_matrix_get(covariance, n - 1, n - 1));
        if (gsl_linalg_cholesky_decomp1(covariance) == GSL_SUCCESS) {
            for (size_t k = 0; k < n; k++) {
                double x[WB_BEND3P_MOST_FREE];
                for (size_t i = 0; i < n; i++)
                    x[i] = gsl_vector_get(w->x, i) + (i < k ? 0.0
                                                            : WB_BEND3P_MOVED * sqrt(variance) *
                                                                  gsl_matrix_get(covariance, i, k));
                law_of(p, x, &fit->moved[fit->n_moved++]);
            }
        }
    }
    gsl_matrix_free(covariance);
}

static enum wb_status search(struct problem *p, gsl_multifit_nlinear_workspace *w,
                             struct wb_bend3p_fit *fit, struct wb_reason *why)
{
    gsl_multifit_nlinear_fdf fdf = {
        .f = gsl_residuals,
        .df = gsl_slopes,
        .n = (size_t)p->n_residuals,
        .p = (size_t)p->n_free,
        .params = p,
    };
    double zero[WB_BEND3P_MOST_FREE] = {0.0};
    const gsl_vector_view x = gsl_vector_view_array(zero, (size_t)p->n_free);
    const int started = gsl_multifit_nlinear_init(&x.vector, &fdf, w);
    if (p->status != WB_OK)
        return p->status;
    if (started != GSL_SUCCESS || !p->reached)
        return wb_fail_to(why, WB_ERR_CONVERGENCE,
                          "wire '%s', sample %d: the beam does not come to %.3g mm of deflection "
                          "with a nose of %.3g mm and friction %.2g from the first guess",
                          p->data->info.wire, p->data->info.sample, p->deepest / WB_MM,
                          p->bench->nose_radius / WB_MM, p->bench->friction);
    const struct wb_least_squares_search how = {
        .max_iterations = p->settings->max_iterations,
        .smallest_step = arrived,
        .smallest_gain = settled_sum,
        .status = &p->status,
    };
    fit->is_converged = wb_least_squares_iterate(w, &how, NULL);
    if (p->status != WB_OK)
        return p->status;
    /* The curve of the answer itself, not of the last trial. */
    double *const r = calloc((size_t)p->n_residuals, sizeof *r);
    const int status = r ? residuals(p, w->x->data, r) : GSL_ENOMEM;
    double sum = 0.0;
    for (int i = 0; status == GSL_SUCCESS && i < p->data->n_points; i++)
        sum += r[i] * r[i];
    free(r);
    if (status != GSL_SUCCESS || !p->reached)
        return wb_fail_to(why, WB_ERR_CONVERGENCE, "wire '%s', sample %d: the fit was lost",
                          p->data->info.wire, p->data->info.sample);
    fit->misfit = sqrt(sum / p->data->n_points) * p->force_scale / p->data->max_force;
    law_of(p, w->x->data, &fit->law);
    fit->first_contact =
        p->contact + contact_scale * p->data->info.length * gsl_vector_get(w->x, (size_t)p->n_law);
    fit->largest_curvature = p->largest_curvature;
    fit->wrapped = p->wrapped;
    find_errors(p, w, fit);
    return WB_OK;
}

static enum wb_status make_bending(struct problem *p)
{
    const struct wb_test_info *const info = &p->data->info;
    const double no_step[WB_BEND3P_MOST_FREE] = {0.0};
    struct wb_section section = {0};
    struct wb_law law;

    law_of(p, no_step, &law);
    WB_TRY(wb_section_init_law(&section, info->outer_diameter, &law, 0));
    const struct wb_bending3p_model model = {
        .section = &section,
        .diameter = info->outer_diameter,
        .span = info->length,
        .support_radius = info->machine.roller_radius,
        .nose_radius = p->bench->nose_radius,
        .friction = p->bench->friction,
        .compliance = p->bench->compliance,
        .n_elements = p->settings->n_elements,
    };
    const enum wb_status status = wb_bending3p_create(&p->bending, &model);
    wb_section_release(&section);
    return status;
}

enum wb_status wb_bend3p_fit_run(struct wb_bend3p_fit *fit, const struct wb_bend3p_data *data,
                                 const struct wb_bend3p_bench *bench,
                                 const struct wb_bend3p_fit *start,
                                 const struct wb_bend3p_fit_settings *settings,
                                 struct wb_reason *why)
{
    const clock_t begin = clock();
    struct problem p = {.data = data, .bench = bench, .settings = settings};
    double last_force = data->points[0].force, last_travel = data->usable;

    for (int i = 0; i < data->n_points && !data->points[i].is_unloading; i++)
        last_force = data->points[i].force;
    *fit = (struct wb_bend3p_fit){.is_converged = false};
    p.deepest = last_travel - data->first_contact - bench->compliance * last_force;
    if (!(p.deepest > 0.0))
        return wb_fail_to(why, WB_ERR_DATA,
                          "wire '%s', sample %d: a compliance of %.3g mm/N takes all of the travel",
                          data->info.wire, data->info.sample, bench->compliance / WB_MM);
    p.n_law = WB_BEND3P_PARTS + data->has_unloading;
    p.n_free = p.n_law + 1;
    p.n_residuals = data->n_points + WB_BEND3P_PARTS - 3 + 1 + data->has_unloading;
    p.force_scale = fmax(data->noise, settings->force_share * data->max_force);
    start_law(&p, start);
    WB_TRY(make_bending(&p));

    gsl_multifit_nlinear_workspace *const w = wb_least_squares_create(p.n_residuals, p.n_free);
    const enum wb_status status =
        w ? search(&p, w, fit, why)
          : wb_fail_to(why, WB_ERR_MEMORY, "no memory for %d points", data->n_points);
    if (w)
        gsl_multifit_nlinear_free(w);
    wb_bending3p_destroy(p.bending);
    fit->runs = p.runs;
    fit->cpu_s = (double)(clock() - begin) / CLOCKS_PER_SEC;
    return status;
}
