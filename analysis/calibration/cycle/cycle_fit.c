#include "analysis/calibration/cycle/cycle_fit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <gsl/gsl_blas.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_matrix.h>
#include <gsl/gsl_multifit_nlinear.h>

#include "analysis/calibration/cycle/cycle_model.h"
#include "analysis/calibration/cycle/cycle_parameters.h"
#include "analysis/dataset/fit.h"
#include "analysis/dataset/least_squares.h"
#include "base/memory.h"

#define WB_LOG_DOMAIN "cycle"

/* Steps of the finite differences of the Jacobian, in units of the parameters' scales. */
static const double difference = 1e-3;
/* Huber's limit, and the limit of an outlier, in standard deviations of the residuals. */
static const double huber_limit = 2.5;
/* Largest correlation of neighbouring residuals that is used, as their number is finite; and the
 * relative change of the scale below which weights have converged. */
static const double largest_correlation = 0.9, settled_scale = 0.3, largest_scale_of_misses = 10.0,
                    first_scale_of_misses = 5.0;
enum {
    most_passes = 4,
    points_of_turn = 3 /* points on either side of the turn: about 1.5 mm of deflection after it */
};
/* Convergence: the next step changes no parameter by more than the first number, or the sum of
 * squares by less than the second, relative. */
static const double arrived = 2e-4;
static const double settled_sum = 1e-4;
/* Weight of the prior that keeps an undetermined parameter finite, in units of the free parameters.
 */
static const double know_nothing = 1e-6;
/* Square of the least standard error, in the same units. */
static const double surest = 1e-12;
/* Step of a moved law in standard errors, and the largest change of a parameter, which limits it to
 * the range where the linearised errors hold. */
static const double moved_by = 0.01, farthest = 1.0;
/* Time of the Maxwell element for relaxation that was not recorded, over the time of the loading.
 */
static const double unseen_time = 0.25;
/* Standard deviation of Maxwell elements from the fall, relative to the fall. */
static const double fall_share = 0.02;
/* Residual of an incomplete run: far above any other. */
static const double lost_residual = 1e4;

struct wb_cycle_search {
    struct wb_cycle_parameters parameters;
    struct wb_cycle_model *model;
    int n_residuals;
    struct wb_memory buffers;                               /* of the model's runs */
    double *tension, *distance, *weight;                    /* weight: (n_points) */
    struct wb_cycle_neighbour neighbours[WB_FIT_MOST_FREE]; /* (n_free), for the Jacobian */
    double last_x[WB_FIT_MOST_FREE];                        /* parameters of the last residuals, */
    double *last;                                           /* and these residuals (n_residuals) */
    bool has_last;
    gsl_matrix *slopes;                /* (n_residuals, n_free): Jacobian, */
    double slopes_x[WB_FIT_MOST_FREE]; /* there; at the end that of the fit */
    bool has_slopes, lacks_slopes;     /* the Jacobian could not be computed */
    double scale_of_misses;            /* larger than 1 for a systematic misfit */
    struct wb_cycle_run run;
    int runs;
    enum wb_status status;
};

/* Residuals of places: distances minus the offset of each marker. The optimal offset, with its
 * prior, is known in closed form. Returns the index after the residuals. */
static int place_residuals(const struct wb_cycle_search *p, const double *distance, double *r)
{
    const struct wb_cycle_data *const data = p->parameters.data;
    const double noise = p->parameters.settings.place_noise,
                 prior = p->parameters.settings.offset_prior;
    int at = 0;

    for (int m = 0; m < data->n_markers; m++) {
        double sum = 0.0;
        int n = 0;
        for (int i = 0; i < data->n_places; i++) {
            if (data->places[i].marker == m) {
                sum += distance[i];
                n++;
            }
        }
        const double offset = sum / (noise * noise) / (n / (noise * noise) + 1.0 / (prior * prior));
        for (int i = 0; i < data->n_places; i++) {
            if (data->places[i].marker == m)
                r[at++] = (distance[i] - offset) / noise;
        }
        r[at++] = offset / prior;
    }
    return at;
}

/* Number of periods of the dwell that are used: none without Maxwell elements. */
static int held_of(const struct wb_cycle_search *p)
{
    return p->parameters.n_maxwell > 0 ? p->parameters.data->n_held : 0;
}

/* Residuals of the tension in the dwell relative to its mean, in which the law may have a
 * systematic error. Returns the index after the residuals. */
static int held_residuals(const struct wb_cycle_search *p, const double *held, double *r)
{
    const struct wb_cycle_data *const data = p->parameters.data;
    const int n = held_of(p);
    double mean = 0.0;
    if (n == 0)
        return 0;
    for (int i = 0; i < n; i++)
        mean += (held[i] - data->held[i].tension) / n;
    const double fall = fabs(data->held[0].tension - data->held[n - 1].tension);
    const double noise = fmax(p->parameters.settings.force_noise, fall_share * fall);
    for (int i = 0; i < n; i++)
        r[i] = (held[i] - data->held[i].tension - mean) / noise;
    return n;
}

/* Law and specimen of the free parameters x. False if the law is invalid. */
static bool take_numbers(const struct wb_cycle_search *p, const double *x, double *free,
                         struct wb_law *law, struct wb_cycle_specimen *specimen)
{
    struct wb_reason why;
    wb_cycle_parameters_at(&p->parameters, x, free);
    wb_cycle_parameters_law(&p->parameters, free, law);
    *specimen = wb_cycle_parameters_specimen(&p->parameters, free);
    return wb_law_check(law, &why) == WB_OK;
}

/* Residuals of a computed cycle. */
static int compare(const struct wb_cycle_search *p, const double *free, const struct wb_law *law,
                   const double *tension, const double *distance, const double *held, double *r)
{
    const struct wb_cycle_data *const data = p->parameters.data;
    for (int i = 0; i < data->n_points; i++)
        r[i] = sqrt(p->weight[i]) *
               (tension[i] + free[p->parameters.n_law + WB_CYCLE_ZERO] - data->points[i].tension) /
               p->parameters.force_scale;
    int at = data->n_points;
    at += place_residuals(p, distance, r + at);
    at += held_residuals(p, held, r + at);
    at += wb_cycle_parameters_priors(&p->parameters, free, law, r + at);
    return at == p->n_residuals ? GSL_SUCCESS : GSL_ESANITY;
}

/* Residuals at the free parameters x. */
static int residuals(struct wb_cycle_search *p, const double *x, double *r)
{
    double free[WB_FIT_MOST_FREE];
    struct wb_law law;
    struct wb_cycle_specimen specimen;
    bool reached = take_numbers(p, x, free, &law, &specimen);
    if (reached) {
        p->runs++;
        p->status = wb_cycle_model_run(p->model, &law, &specimen, p->tension, p->distance, &p->run);
        if (p->status != WB_OK)
            return GSL_EFAILED;
        reached = p->run.reached;
    }
    if (!reached) {
        for (int i = 0; i < p->n_residuals; i++)
            r[i] = lost_residual;
        return GSL_SUCCESS;
    }
    return compare(p, free, &law, p->tension, p->distance, wb_cycle_model_held(p->model), r);
}

static size_t bytes_of(const struct wb_cycle_search *p)
{
    return (size_t)p->n_residuals * sizeof *p->last;
}

static bool is_at(const struct wb_cycle_search *p, const double *x, const gsl_vector *there)
{
    return memcmp(x, there->data, (size_t)p->parameters.n_free * sizeof *x) == 0;
}

static int gsl_residuals(const gsl_vector *x, void *context, gsl_vector *f)
{
    struct wb_cycle_search *const p = context;
    if (p->has_last && is_at(p, p->last_x, x)) {
        memcpy(f->data, p->last, bytes_of(p));
        return GSL_SUCCESS;
    }
    const int status = residuals(p, x->data, f->data);
    memcpy(p->last_x, x->data, (size_t)p->parameters.n_free * sizeof *p->last_x);
    memcpy(p->last, f->data, bytes_of(p));
    p->has_last = status == GSL_SUCCESS;
    return status;
}

/* Jacobian by differences from the residuals at x, from cycles computed as neighbours of that of x.
 */
static int find_slopes(struct wb_cycle_search *p, const double *x)
{
    double numbers[WB_FIT_MOST_FREE], moved[WB_FIT_MOST_FREE][WB_FIT_MOST_FREE];
    struct wb_law law;
    struct wb_cycle_specimen specimen;
    double *const there = wb_memory_new((size_t)p->n_residuals, sizeof *there);
    int status = take_numbers(p, x, numbers, &law, &specimen) ? GSL_SUCCESS : GSL_EFAILED;
    for (int k = 0; k < p->parameters.n_free && status == GSL_SUCCESS; k++) {
        struct wb_cycle_neighbour *const neighbour = &p->neighbours[k];
        double step[WB_FIT_MOST_FREE];
        memcpy(step, x, (size_t)p->parameters.n_free * sizeof *step);
        step[k] += difference;
        if (!take_numbers(p, step, moved[k], &neighbour->law, &neighbour->specimen))
            status = GSL_EFAILED;
    }
    if (status == GSL_SUCCESS) {
        p->status = wb_cycle_model_run_beside(p->model, &law, &specimen, p->tension, p->distance,
                                              p->parameters.n_free, p->neighbours, &p->run);
        p->runs++;
        if (p->status != WB_OK || !p->run.reached)
            status = GSL_EFAILED;
    }
    for (int k = 0; k < p->parameters.n_free && status == GSL_SUCCESS; k++) {
        const struct wb_cycle_neighbour *const neighbour = &p->neighbours[k];
        status = compare(p, moved[k], &neighbour->law, neighbour->tension, neighbour->distance,
                         neighbour->held, there);
        for (int i = 0; i < p->n_residuals; i++) {
            gsl_matrix_set(p->slopes, (size_t)i, (size_t)k, (there[i] - p->last[i]) / difference);
            if (!isfinite(there[i]))
                status = GSL_EFAILED;
        }
    }
    p->lacks_slopes = status != GSL_SUCCESS;
    free(there);
    return status;
}

static int gsl_slopes(const gsl_vector *x, void *context, gsl_matrix *J)
{
    struct wb_cycle_search *const p = context;
    if (!p->has_last || !is_at(p, p->last_x, x))
        return GSL_ESANITY;
    if (!p->has_slopes || !is_at(p, p->slopes_x, x)) {
        const int status = find_slopes(p, x->data);
        p->has_slopes = status == GSL_SUCCESS;
        if (status != GSL_SUCCESS)
            return status;
        memcpy(p->slopes_x, x->data, (size_t)p->parameters.n_free * sizeof *p->slopes_x);
    }
    gsl_matrix_memcpy(J, p->slopes);
    return GSL_SUCCESS;
}

/* Scales the known residual of a point to its new weight. */
static void weigh_again(struct wb_cycle_search *p, int i, double ratio)
{
    gsl_vector_view slopes = gsl_matrix_row(p->slopes, (size_t)i);
    gsl_vector_scale(&slopes.vector, ratio);
    p->last[i] *= ratio;
}

/* Standard deviation of equivalent independent residuals, in units of the force noise. Under a
 * systematic misfit neighbouring residuals are correlated; with the lag-1 correlation r, the
 * variance of the sum of n residuals is (1 + r) / (1 - r) times n variances. `counts` are Huber's
 * weights. */
static double find_discrepancy(const struct wb_cycle_search *p, const double *miss,
                               const double *counts)
{
    double squares = 0.0, products = 0.0, sum = 0.0;
    for (int i = 0; i < p->parameters.data->n_points; i++) {
        squares += counts[i] * miss[i] * miss[i];
        sum += counts[i];
        if (i > 0 && i != p->parameters.data->n_loading)
            products += sqrt(counts[i] * counts[i - 1]) * miss[i] * miss[i - 1];
    }
    const double r = squares > 0.0 ? fmin(fmax(products / squares, 0.0), largest_correlation) : 0.0;
    return sqrt(squares / sum * (1.0 + r) / (1.0 - r));
}

/* Sets the weights of the points for the next pass from the residuals of this one: Huber's, and
 * smaller ones under a systematic misfit, so that priors keep their weight. Returns whether they
 * changed. */
static bool set_weights(struct wb_cycle_search *p, const gsl_vector *f, int *n_outliers)
{
    const int n = p->parameters.data->n_points, outliers_before = *n_outliers;
    const double scale_before = p->scale_of_misses;
    double *const counts = wb_memory_new((size_t)n, sizeof *counts);
    double *const miss = p->tension; /* free to use until the next run */
    for (int i = 0; i < n; i++) {
        miss[i] = gsl_vector_get(f, (size_t)i) / sqrt(p->weight[i]);
        counts[i] = fabs(miss[i]);
    }
    const double limit = huber_limit * fmax(wb_fit_usual_size(counts, (size_t)n), 1.0);
    *n_outliers = 0;
    for (int i = 0; i < n; i++) {
        counts[i] = fabs(miss[i]) > limit ? limit / fabs(miss[i]) : 1.0;
        *n_outliers += counts[i] < 0.5;
    }
    p->scale_of_misses =
        fmin(fmax(find_discrepancy(p, miss, counts), 1.0), largest_scale_of_misses);
    for (int i = 0; i < n; i++) {
        const double before = p->weight[i];
        p->weight[i] = counts[i] / (p->scale_of_misses * p->scale_of_misses);
        weigh_again(p, i, sqrt(p->weight[i] / before));
    }
    free(counts);
    return *n_outliers != outliers_before ||
           fabs(log(p->scale_of_misses / scale_before)) > settled_scale;
}

/* Iterates to convergence; false if the iterations ran out. */
static bool iterate(struct wb_cycle_search *p, gsl_multifit_nlinear_workspace *w, int *iterations)
{
    const struct wb_least_squares_search search = {
        .max_iterations = p->parameters.settings.max_iterations,
        .smallest_step = arrived,
        .smallest_gain = settled_sum,
        .status = &p->status,
    };
    return wb_least_squares_iterate(w, &search, iterations) && !p->lacks_slopes;
}

/* --- covariance ---
 *
 * The readings contribute by the jackknife (Tukey 1958), which leaves out each group of residuals
 * once; the priors contribute by their standard deviations. If the form of the law cannot describe
 * the test, neighbouring residuals are large and of one sign, and the parameters that depend on
 * them are uncertain, others are not. Parameters that the readings do not determine, such as the
 * virgin curve below the curvature of the wire at zero deflection, depend on the priors. For pure
 * noise, groups by sign overestimate a standard error by half.
 */

/* Lower half of J'J with the prior that keeps undetermined parameters finite. */
static gsl_matrix *squares_of(const gsl_matrix *J)
{
    gsl_matrix *const squares = wb_memory_need(gsl_matrix_alloc(J->size2, J->size2));
    gsl_matrix_set_identity(squares);
    gsl_blas_dsyrk(CblasLower, CblasTrans, 1.0, J, know_nothing, squares);
    return squares;
}

/* Its Cholesky factor; NULL: not positive definite. */
static gsl_matrix *factor_squares(const gsl_matrix *J)
{
    gsl_matrix *const squares = squares_of(J);
    if (gsl_linalg_cholesky_decomp1(squares) == GSL_SUCCESS)
        return squares;
    gsl_matrix_free(squares);
    return NULL;
}

enum {
    IS_PRIOR = -1 /* residual that belongs to no group */
};

/* Begins a new group of residuals at each change of sign. Returns the index after the last one. */
static int group_rows(const gsl_vector *f, int at, int n, int *group, int *n_groups)
{
    for (int i = at; i < at + n; i++) {
        *n_groups += i == at || (gsl_vector_get(f, (size_t)i) < 0.0) !=
                                    (gsl_vector_get(f, (size_t)i - 1) < 0.0);
        group[i] = *n_groups - 1;
    }
    return at + n;
}

/* Groups correlated residuals: consecutive ones of one sign, of one branch, one marker or the
 * dwell. Returns the number of groups. */
static int group_residuals(const struct wb_cycle_data *data, bool has_held, const gsl_vector *f,
                           int *group)
{
    int n_groups = 0;
    for (size_t i = 0; i < f->size; i++)
        group[i] = IS_PRIOR;
    int at = group_rows(f, 0, data->n_loading, group, &n_groups);
    at = group_rows(f, at, data->n_points - data->n_loading, group, &n_groups);
    for (int m = 0; m < data->n_markers; m++) {
        int n = 0;
        for (int i = 0; i < data->n_places; i++)
            n += data->places[i].marker == m;
        at = group_rows(f, at, n, group, &n_groups) + 1; /* after the prior of its offset */
    }
    if (has_held)
        group_rows(f, at, data->n_held, group, &n_groups);
    return n_groups;
}

/* Adds the contribution of one group of residuals to the covariance: the change of the free
 * parameters, to first order, when the group is left out. `squares` is J'J; `rest` is workspace. */
static bool add_group(const gsl_matrix *J, const gsl_vector *f, const int *group, int left_out,
                      const gsl_matrix *squares, gsl_matrix *rest, gsl_matrix *covariance)
{
    double numbers[WB_FIT_MOST_FREE] = {0.0};
    gsl_vector_view change = gsl_vector_view_array(numbers, J->size2);
    gsl_matrix_memcpy(rest, squares);
    for (size_t i = 0; i < J->size1; i++) {
        if (group[i] != left_out)
            continue;
        const gsl_vector_const_view slopes = gsl_matrix_const_row(J, i);
        gsl_blas_dsyr(CblasLower, -1.0, &slopes.vector, rest);
        gsl_blas_daxpy(gsl_vector_get(f, i), &slopes.vector, &change.vector);
    }
    return gsl_linalg_cholesky_decomp1(rest) == GSL_SUCCESS &&
           gsl_linalg_cholesky_svx(rest, &change.vector) == GSL_SUCCESS &&
           gsl_blas_dsyr(CblasLower, 1.0, &change.vector, covariance) == GSL_SUCCESS;
}

/* Adds the contribution of the priors, by their standard deviations. */
static bool add_priors(const gsl_matrix *J, const int *group, const gsl_matrix *squares,
                       gsl_matrix *rest, gsl_matrix *covariance)
{
    gsl_matrix_memcpy(rest, squares);
    bool good = gsl_linalg_cholesky_decomp1(rest) == GSL_SUCCESS;
    for (size_t i = 0; i < J->size1 && good; i++) {
        double numbers[WB_FIT_MOST_FREE];
        gsl_vector_view change = gsl_vector_view_array(numbers, J->size2);
        if (group[i] != IS_PRIOR)
            continue;
        gsl_matrix_get_row(&change.vector, J, i);
        good = gsl_linalg_cholesky_svx(rest, &change.vector) == GSL_SUCCESS &&
               gsl_blas_dsyr(CblasLower, 1.0, &change.vector, covariance) == GSL_SUCCESS;
    }
    return good;
}

/* Fills the lower half of the covariance of the free parameters. `f` are the residuals at the end
 * of the search, `J` is their Jacobian. False if it cannot be computed. */
static bool find_covariance(const struct wb_cycle_data *data, bool has_held, const gsl_vector *f,
                            const gsl_matrix *J, gsl_matrix *covariance)
{
    const size_t n = J->size2;
    gsl_matrix *const squares = squares_of(J);
    gsl_matrix *const rest = wb_memory_need(gsl_matrix_alloc(n, n));
    int *const group = wb_memory_new(f->size, sizeof *group);
    const int n_groups = group_residuals(data, has_held, f, group);
    bool good = true;
    gsl_matrix_set_identity(covariance);
    gsl_matrix_scale(covariance, surest);
    for (int g = 0; g < n_groups && good; g++)
        good = add_group(J, f, group, g, squares, rest, covariance);
    good = good && add_priors(J, group, squares, rest, covariance);
    gsl_matrix_free(squares);
    gsl_matrix_free(rest);
    free(group);
    return good;
}

/* Moves the law along the columns of the triangular factor of the covariance, which is overwritten.
 */
static void move_law(const struct wb_cycle_search *p, const gsl_vector *x, gsl_matrix *covariance,
                     struct wb_cycle_fit *fit)
{
    double free[WB_FIT_MOST_FREE], step[WB_FIT_MOST_FREE];
    struct wb_cycle_specimen specimen;
    fit->n_moved = 0;
    if (gsl_linalg_cholesky_decomp1(covariance) != GSL_SUCCESS)
        return;
    for (int k = 0; k < p->parameters.n_law; k++) {
        const gsl_vector_view side = gsl_matrix_column(covariance, (size_t)k);
        double largest = 0.0;
        for (int i = k; i < p->parameters.n_free; i++)
            largest = fmax(largest, fabs(gsl_vector_get(&side.vector, (size_t)i)));
        const double by = fmin(moved_by, farthest / largest);
        for (int i = 0; i < p->parameters.n_free; i++)
            step[i] = gsl_vector_get(x, (size_t)i) +
                      (i < k ? 0.0 : by * gsl_vector_get(&side.vector, (size_t)i));
        fit->moved_by[k] = by;
        if (!take_numbers(p, step, free, &fit->moved[k], &specimen))
            return;
    }
    fit->n_moved = p->parameters.n_law;
}

/* Standard errors from the covariance. */
static void find_errors(const struct wb_cycle_search *p, gsl_multifit_nlinear_workspace *w,
                        struct wb_cycle_fit *fit)
{
    gsl_matrix *const covariance = wb_memory_need(
        gsl_matrix_alloc((size_t)p->parameters.n_free, (size_t)p->parameters.n_free));
    double sum;
    fit->ln_strength_error = fit->exponent_error = fit->bow_angle_error = (double)NAN;
    fit->level_share = fit->level_error = (double)NAN;
    gsl_blas_ddot(w->f, w->f, &sum);
    if (gsl_multifit_nlinear_covar(w->J, 0.0, covariance) == GSL_SUCCESS) {
        const double variance = sum / fmax(1.0, p->n_residuals - p->parameters.n_free);
        const size_t bow = (size_t)p->parameters.n_law;
        fit->bow_angle_error =
            p->parameters.scale[bow] * sqrt(variance * gsl_matrix_get(covariance, bow, bow));
        /* Data and prior are weighted by their inverse variances. */
        const size_t level = (size_t)(p->parameters.n_law + WB_CYCLE_LEVEL);
        const double prior = p->parameters.settings.level_prior;
        const double both =
            pow(p->parameters.scale[level], 2) * gsl_matrix_get(covariance, level, level);
        fit->level_share = fmax(0.0, 1.0 - both / (prior * prior));
        fit->level_error = sqrt(variance * both / fit->level_share);
        wb_cycle_parameters_correlate(&p->parameters, covariance, variance, fit);
    }
    if (find_covariance(p->parameters.data, held_of(p) > 0, w->f, w->J, covariance))
        move_law(p, w->x, covariance, fit);
    gsl_matrix_free(covariance);
}

/* Creates the beam of the search. */
static enum wb_status create_model(struct wb_cycle_search *p, const struct wb_law *law,
                                   int n_neighbours)
{
    const struct wb_cycle_fit_settings *const s = &p->parameters.settings;
    const struct wb_cycle_model_settings how = {s->n_elements, s->n_fibres, n_neighbours};
    return wb_cycle_model_create(&p->model, p->parameters.data, law, &how);
}

/* Allocates the results of the beam, and of its neighbours. */
static void take_buffers(struct wb_cycle_search *p, int n_neighbours)
{
    const size_t points = (size_t)p->parameters.data->n_points;
    const size_t places = (size_t)p->parameters.data->n_places;
    p->tension = wb_memory_take(&p->buffers, points, sizeof *p->tension);
    p->distance = wb_memory_take(&p->buffers, places, sizeof *p->distance);
    p->last = wb_memory_take(&p->buffers, (size_t)p->n_residuals, sizeof *p->last);
    for (int k = 0; k < n_neighbours; k++) {
        struct wb_cycle_neighbour *const neighbour = &p->neighbours[k];
        neighbour->tension = wb_memory_take(&p->buffers, points, sizeof(double));
        neighbour->distance = wb_memory_take(&p->buffers, places, sizeof(double));
    }
}

static void free_buffers(struct wb_cycle_search *p)
{
    wb_cycle_model_destroy(p->model);
    p->model = NULL;
    wb_memory_release(&p->buffers);
    p->has_last = false;
}

/* A Maxwell element with a given part of the stress of the outer fibre at the turn. */
static struct wb_law_maxwell unseen_element(const struct wb_cycle_search *p,
                                            const struct wb_law *law, double part)
{
    const double loading = wb_cycle_data_loading_time(p->parameters.data), x = 1.0 / unseen_time;
    const double strain = 0.5 * p->parameters.data->info.outer_diameter * p->run.clamp_curvature;
    const double secant = wb_law_virgin_stress(law, strain, NULL) / strain;
    return (struct wb_law_maxwell){part * secant * x / -expm1(-x), unseen_time * loading};
}

/* Gauss-Newton step from the end of the search, with the residuals of altered data. `squares` is
 * the Cholesky factor of J'J, `r` the residuals of the data. */
static void find_altered(struct wb_cycle_search *p, const gsl_matrix *squares, const double *r,
                         enum wb_cycle_shared shared, struct wb_cycle_fit *fit)
{
    struct wb_cycle_data altered;
    struct wb_cycle_search q = *p;
    double free_numbers[WB_FIT_MOST_FREE], numbers[WB_FIT_MOST_FREE];
    if (shared == WB_SHARED_RELAXATION)
        q.parameters.beside = unseen_element(p, &fit->law, wb_cycle_shared_change(shared));
    if (!wb_cycle_shared_alter(&altered, p->parameters.data, shared,
                               wb_cycle_shared_change(shared)))
        return;
    gsl_vector *const change = wb_memory_need(gsl_vector_alloc((size_t)p->n_residuals));
    gsl_vector_view step = gsl_vector_view_array(numbers, (size_t)p->parameters.n_free);
    q.parameters.data = &altered;
    bool good = create_model(&q, &fit->law, 0) == WB_OK &&
                residuals(&q, p->slopes_x, change->data) == GSL_SUCCESS && q.run.reached;
    for (int i = 0; i < p->n_residuals && good; i++)
        change->data[i] = r[i] - change->data[i];
    good = good &&
           gsl_blas_dgemv(CblasTrans, 1.0, p->slopes, change, 0.0, &step.vector) == GSL_SUCCESS &&
           gsl_linalg_cholesky_svx(squares, &step.vector) == GSL_SUCCESS;
    if (good) {
        for (int i = 0; i < p->parameters.n_free; i++)
            numbers[i] += p->slopes_x[i];
        fit->has_altered[shared] = take_numbers(&q, numbers, free_numbers, &fit->altered[shared],
                                                &fit->altered_specimen[shared]);
    }
    wb_cycle_model_destroy(q.model);
    gsl_vector_free(change);
    wb_cycle_data_release(&altered);
}

void wb_cycle_fit_find_altered(struct wb_cycle_fit *fit)
{
    struct wb_cycle_search *const p = fit->search;
    double *const r = wb_memory_new((size_t)p->n_residuals, sizeof *r);
    gsl_matrix *const squares = factor_squares(p->slopes);
    take_buffers(p, 0);
    if (squares && create_model(p, &fit->law, 0) == WB_OK &&
        residuals(p, p->slopes_x, r) == GSL_SUCCESS && p->run.reached) {
        for (int i = 0; i < WB_SHARED; i++)
            find_altered(p, squares, r, i, fit);
    }
    free_buffers(p);
    gsl_matrix_free(squares);
    free(r);
}

/* Change of the mean residual from the last points of the loading to the first points of the
 * unloading. */
static double turn_miss(const struct wb_cycle_fit *fit, const struct wb_cycle_data *data)
{
    const struct wb_cycle_point *const turn = data->points + data->n_loading;
    const double *const tension = fit->tension + data->n_loading;
    double change = 0.0, way = 0.0;
    if (data->n_loading < points_of_turn || data->n_points < data->n_loading + points_of_turn)
        return (double)NAN;
    for (int i = 0; i < points_of_turn; i++) {
        change += tension[i] - turn[i].tension - (tension[-1 - i] - turn[-1 - i].tension);
        way += data->top - turn[i].deflection;
    }
    const int last = points_of_turn - 1;
    const double slope =
        (tension[0] - tension[last]) / (turn[0].deflection - turn[last].deflection);
    return change / (slope * way);
}

static void find_misfits(struct wb_cycle_fit *fit, struct wb_cycle_search *p)
{
    const struct wb_cycle_data *const data = p->parameters.data;
    double sums[2] = {0.0, 0.0};
    int counts[2] = {0, 0};

    for (int i = 0; i < data->n_points; i++) {
        const double r = fit->tension[i] - data->points[i].tension;
        const int branch = data->points[i].is_unloading;
        sums[branch] += r * r;
        counts[branch]++;
    }
    fit->misfit = sqrt((sums[0] + sums[1]) / data->n_points) / data->max_force;
    fit->loading_misfit = sqrt(sums[0] / counts[0]) / data->max_force;
    fit->turn_miss = turn_miss(fit, data);
    fit->unloading_misfit =
        counts[1] > 0 ? sqrt(sums[1] / counts[1]) / data->max_force : (double)NAN;

    double *const r = wb_memory_new((size_t)(data->n_places + data->n_markers), sizeof *r);
    double sum = 0.0;
    const int n = place_residuals(p, p->distance, r);
    for (int i = 0; i < n; i++)
        sum += r[i] * r[i];
    fit->place_rms = data->n_places > 0
                         ? p->parameters.settings.place_noise * sqrt(sum / data->n_places)
                         : (double)NAN;
    free(r);
}

/* Final run, with more elements. */
static enum wb_status run_finely(struct wb_cycle_fit *fit, struct wb_cycle_search *p,
                                 struct wb_reason *why)
{
    const struct wb_cycle_model_settings how = {p->parameters.settings.n_final_elements,
                                                p->parameters.settings.n_fibres, 0};
    const struct wb_cycle_specimen specimen = {fit->bow_angle, fit->level, fit->uneven_angle};
    struct wb_cycle_model *fine;
    WB_TRY(wb_cycle_model_create(&fine, p->parameters.data, &fit->law, &how));
    const enum wb_status status =
        wb_cycle_model_run(fine, &fit->law, &specimen, fit->tension, p->distance, &p->run);
    wb_cycle_model_destroy(fine);
    p->runs++;
    if (status == WB_OK && !p->run.reached)
        return wb_fail_to(why, WB_ERR_CONVERGENCE,
                          "wire '%s', sample %d: %s: the beam of %d elements does not come to the "
                          "end of the cycle",
                          p->parameters.data->info.wire, p->parameters.data->info.sample,
                          p->parameters.candidate->name, p->parameters.settings.n_final_elements);
    return status;
}

/* Sets the initial weights of the search. If a law fits well, one of another hardening rule does
 * not, and the details of its misfit are not needed. */
static double first_scale(const struct wb_cycle_parameters_candidate *c,
                          const struct wb_cycle_fit *near)
{
    if (!near || c->form == WB_LAW_CHABOCHE)
        return first_scale_of_misses;
    const struct wb_cycle_parameters_candidate *const other =
        wb_cycle_parameters_candidate(near->candidate);
    const bool is_alike =
        c->isotropic_share == other->isotropic_share && c->is_combined == other->is_combined;
    if (is_alike || wb_cycle_parameters_contains(c, near))
        return near->scale_of_misses;
    return near->scale_of_misses < first_scale_of_misses ? largest_scale_of_misses
                                                         : first_scale_of_misses;
}

/* Whether the isotropic share stays at the end of its range, from the optimum of the law without
 * it: a Gauss-Newton step with all parameters free leads there. */
static bool is_best_at_end(const struct wb_cycle_search *p, const gsl_multifit_nlinear_workspace *w,
                           const struct wb_law *law)
{
    const size_t at = (size_t)p->parameters.n_form - 1;
    gsl_matrix *const squares = factor_squares(w->J);
    gsl_vector *const step = wb_memory_need(gsl_vector_alloc((size_t)p->parameters.n_free));
    bool is_best = squares &&
                   gsl_blas_dgemv(CblasTrans, -1.0, w->J, w->f, 0.0, step) == GSL_SUCCESS &&
                   gsl_linalg_cholesky_svx(squares, step) == GSL_SUCCESS;
    is_best =
        is_best && wb_cycle_parameters_share_ends(&p->parameters, law, gsl_vector_get(step, at));
    gsl_vector_free(step);
    gsl_matrix_free(squares);
    return is_best;
}

static enum wb_status search(struct wb_cycle_fit *fit, struct wb_cycle_search *p,
                             gsl_multifit_nlinear_workspace *w, const struct wb_cycle_fit *near,
                             struct wb_reason *why)
{
    gsl_multifit_nlinear_fdf fdf = {
        .f = gsl_residuals,
        .df = gsl_slopes,
        .n = (size_t)p->n_residuals,
        .p = (size_t)p->parameters.n_free,
        .params = p,
    };
    double at[WB_FIT_MOST_FREE] = {0.0};
    double free_numbers[WB_FIT_MOST_FREE];
    gsl_vector_view x = gsl_vector_view_array(at, (size_t)p->parameters.n_free);
    const int started = gsl_multifit_nlinear_init(&x.vector, &fdf, w);
    if (p->status != WB_OK)
        return p->status;
    if (started != GSL_SUCCESS || !p->run.reached)
        return wb_fail_to(why, WB_ERR_CONVERGENCE,
                          "wire '%s', sample %d: %s: the beam does not come to the end of the "
                          "cycle from the first guess",
                          p->parameters.data->info.wire, p->parameters.data->info.sample,
                          p->parameters.candidate->name);
    fit->is_contained = near && wb_cycle_parameters_contains(p->parameters.candidate, near) &&
                        is_best_at_end(p, w, &near->law);
    for (int pass = 0; pass < most_passes && !fit->is_contained; pass++) {
        fit->is_converged = iterate(p, w, &fit->iterations);
        if (p->status != WB_OK)
            return p->status;
        if (!set_weights(p, w->f, &fit->n_outliers) || !fit->is_converged)
            break;
        memcpy(at, w->x->data, (size_t)p->parameters.n_free * sizeof *at);
        if (gsl_multifit_nlinear_init(&x.vector, &fdf, w) != GSL_SUCCESS)
            break;
    }
    if (fit->is_contained)
        return WB_OK;
    wb_cycle_parameters_at(&p->parameters, w->x->data, free_numbers);
    p->parameters.strain_rate =
        wb_cycle_parameters_strain_rate(p->parameters.data, p->run.clamp_curvature);
    wb_cycle_parameters_law(&p->parameters, free_numbers, &fit->law);
    const struct wb_cycle_specimen specimen =
        wb_cycle_parameters_specimen(&p->parameters, free_numbers);
    fit->bow_angle = specimen.bow_angle;
    fit->level = specimen.level;
    fit->uneven_angle = specimen.uneven_angle;
    fit->zero = free_numbers[p->parameters.n_law + WB_CYCLE_ZERO];
    fit->is_at_bound = wb_cycle_parameters_at_bound(&p->parameters, free_numbers);
    find_errors(p, w, fit);
    WB_TRY(run_finely(fit, p, why));
    for (int i = 0; i < p->parameters.data->n_points; i++)
        fit->tension[i] += fit->zero;
    fit->clamp_curvature = p->run.clamp_curvature;
    if (fit->law.n_maxwell > 0)
        fit->law.strain_rate =
            wb_cycle_parameters_strain_rate(p->parameters.data, fit->clamp_curvature);
    fit->first_curvature = p->run.first_curvature;
    fit->turn_change = p->run.turn_change;
    find_misfits(fit, p);
    return WB_OK;
}

enum wb_status wb_cycle_fit_run(struct wb_cycle_fit *fit, const struct wb_cycle_data *data,
                                enum wb_candidate candidate, const struct wb_law *start,
                                const struct wb_cycle_fit *near, const struct wb_cycle_grid *grid,
                                const struct wb_cycle_fit_settings *settings, struct wb_reason *why)
{
    const clock_t begin = clock();
    struct wb_cycle_search *const p = wb_memory_new(1, sizeof *p);
    wb_cycle_parameters_init(&p->parameters, data, candidate, start, near, grid, settings);
    p->scale_of_misses = first_scale(p->parameters.candidate, near);
    p->n_residuals =
        data->n_points + data->n_places + data->n_markers + held_of(p) + p->parameters.n_priors;
    *fit = (struct wb_cycle_fit){.candidate = candidate,
                                 .n_free = p->parameters.n_free,
                                 .n_law = p->parameters.n_law,
                                 .search = p};

    const double no_step[WB_FIT_MOST_FREE] = {0.0};
    double free_numbers[WB_FIT_MOST_FREE];
    struct wb_law law;
    wb_cycle_parameters_at(&p->parameters, no_step, free_numbers);
    wb_cycle_parameters_law(&p->parameters, free_numbers, &law);

    const size_t points = (size_t)data->n_points;
    take_buffers(p, p->parameters.n_free);
    p->weight = wb_memory_new(points, sizeof *p->weight);
    for (size_t i = 0; i < points; i++)
        p->weight[i] = 1.0 / (p->scale_of_misses * p->scale_of_misses);
    p->slopes =
        wb_memory_need(gsl_matrix_calloc((size_t)p->n_residuals, (size_t)p->parameters.n_free));
    fit->tension = wb_memory_new(points, sizeof *fit->tension);
    gsl_multifit_nlinear_workspace *const w =
        wb_least_squares_create(p->n_residuals, p->parameters.n_free);
    enum wb_status status = create_model(p, &law, p->parameters.n_free);
    if (status == WB_OK)
        status = search(fit, p, w, near, why);
    fit->runs = p->runs;
    fit->scale_of_misses = p->scale_of_misses;
    gsl_multifit_nlinear_free(w);
    free_buffers(p);
    fit->cpu_s = (double)(clock() - begin) / CLOCKS_PER_SEC;
    if (status != WB_OK)
        wb_cycle_fit_release(fit);
    return status;
}

struct wb_cycle_bow wb_cycle_fit_bow(const struct wb_cycle_fit *fit, double length)
{
    return (struct wb_cycle_bow){.tip = 0.5 * fit->bow_angle * length,
                                 .deviation = 0.5 * fit->bow_angle_error * length,
                                 .uneven = 0.125 * fit->uneven_angle * length};
}

void wb_cycle_fit_release(struct wb_cycle_fit *fit)
{
    if (fit->search) {
        free(fit->search->weight);
        gsl_matrix_free(fit->search->slopes);
    }
    free(fit->search);
    free(fit->tension);
    fit->tension = NULL;
    fit->search = NULL;
}
