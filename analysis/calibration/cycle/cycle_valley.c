#include "analysis/calibration/cycle/cycle_valley.h"

#include <math.h>
#include <stdlib.h>

#include <gsl/gsl_multifit.h>

#include "analysis/calibration/cycle/cycle_fit.h"
#include "analysis/calibration/cycle/cycle_model.h"
#include "analysis/calibration/law/bending.h"
#include "analysis/dataset/fit.h"
#include "base/memory.h"

#define WB_LOG_DOMAIN "calibrate"

static const double smallest_exponent = 0.02, largest_exponent = 1.5;
/* Range of the nodes, in standard errors; and its limits, in ln of the stress and in n. */
static const double reach = 5.0, widest_stress = 0.5, widest_exponent = 0.4;
/* Step of the finite differences. */
static const double difference = 1e-3;
static const double confidence = 0.95;

/* Parameters of a loading; those that are free at each pair come first. */
enum {
    MODULUS, /* ln E */
    YIELD,   /* ln sigma_Y */
    BOW,     /* rad */
    LEVEL,   /* m */
    NUISANCES,
    STRESS = NUISANCES, /* ln of the stress of hardening at the middle */
    EXPONENT,
    NUMBERS
};

struct problem {
    struct wb_cycle_data loading; /* borrows all */
    struct wb_cycle_fit_settings settings;
    struct wb_cycle_model *model;
    double poissons_ratio;
    double best[NUMBERS], scale[NUMBERS];
    double bow_prior; /* rad: standard error of the bow by the markers */
    double *tension, *residual;
    gsl_matrix *slopes;  /* (n_points + 2 priors, NUMBERS), per scale, over the force noise */
    double noise;        /* N */
    double uneven_angle; /* of the specimen at the optimum */
};

static void law_of(const struct problem *p, const double *numbers, struct wb_law *law)
{
    const struct wb_material material =
        wb_bending_material(exp(numbers[MODULUS]), p->poissons_ratio, exp(numbers[YIELD]),
                            exp(numbers[STRESS]), numbers[EXPONENT]);
    wb_law_init_ludwik(law, &material);
}

/* Residuals of the forces, N; *misfit is NaN if the beam does not complete the loading. */
static enum wb_status run(struct problem *p, const double *numbers, double *misfit)
{
    const struct wb_cycle_specimen specimen = {numbers[BOW], numbers[LEVEL], p->uneven_angle};
    struct wb_cycle_run how;
    struct wb_law law;
    struct wb_reason why;
    double sum = 0.0;
    const int n = p->loading.n_points;

    *misfit = (double)NAN;
    law_of(p, numbers, &law);
    if (wb_law_check(&law, &why) != WB_OK)
        return WB_OK;
    WB_TRY(wb_cycle_model_run(p->model, &law, &specimen, p->tension, NULL, &how));
    for (int i = 0; i < n; i++) {
        p->residual[i] = p->tension[i] - p->loading.points[i].tension;
        sum += p->residual[i] * p->residual[i];
    }
    if (how.reached)
        *misfit = sqrt(sum / n) / p->loading.max_force;
    return WB_OK;
}

/* Jacobian at the optimum; `base` receives the residuals there (n_points, over the noise). */
static enum wb_status find_slopes(struct problem *p, gsl_vector *base, double *misfit)
{
    const size_t n = (size_t)p->loading.n_points;
    WB_TRY(run(p, p->best, misfit));
    gsl_vector_set_zero(base);
    gsl_matrix_set_zero(p->slopes);
    for (size_t i = 0; i < n; i++)
        gsl_vector_set(base, i, p->residual[i] / p->noise);
    for (int k = 0; k < NUMBERS; k++) {
        double numbers[NUMBERS], moved;
        for (int j = 0; j < NUMBERS; j++)
            numbers[j] = p->best[j] + (j == k ? difference * p->scale[k] : 0.0);
        WB_TRY(run(p, numbers, &moved));
        for (size_t i = 0; i < n; i++)
            gsl_matrix_set(p->slopes, i, (size_t)k,
                           (p->residual[i] / p->noise - gsl_vector_get(base, i)) / difference);
    }
    gsl_matrix_set(p->slopes, n, BOW, p->scale[BOW] / p->bow_prior);
    gsl_matrix_set(p->slopes, n + 1, LEVEL, p->scale[LEVEL] / p->settings.level_prior);
    return WB_OK;
}

/* Least squares of A x = y by the first n columns of the slopes; false if it fails. */
static bool solve(const struct problem *p, size_t n, const gsl_vector *y, gsl_vector *x,
                  gsl_matrix *covariance)
{
    const size_t rows = p->slopes->size1;
    const gsl_matrix_const_view slopes = gsl_matrix_const_submatrix(p->slopes, 0, 0, rows, n);
    gsl_multifit_linear_workspace *const w = wb_memory_need(gsl_multifit_linear_alloc(rows, n));
    double sum;
    const bool found = gsl_multifit_linear(&slopes.matrix, y, x, covariance, &sum, w) == 0;
    gsl_multifit_linear_free(w);
    return found;
}

/* Standard errors of the stress and of n from the residuals of the loading. */
static bool find_errors(const struct problem *p, const gsl_vector *base, double *stress,
                        double *exponent)
{
    double numbers[NUMBERS], squares[NUMBERS * NUMBERS];
    gsl_vector_view x = gsl_vector_view_array(numbers, NUMBERS);
    gsl_matrix_view covariance = gsl_matrix_view_array(squares, NUMBERS, NUMBERS);
    if (!solve(p, NUMBERS, base, &x.vector, &covariance.matrix))
        return false;
    *stress = sqrt(gsl_matrix_get(&covariance.matrix, STRESS, STRESS)) * p->scale[STRESS];
    *exponent = sqrt(gsl_matrix_get(&covariance.matrix, EXPONENT, EXPONENT)) * p->scale[EXPONENT];
    return *stress > 0.0 && *exponent > 0.0 && isfinite(*stress) && isfinite(*exponent);
}

/* Moves the free parameters so that they compensate a step of stress and exponent, to first order.
 */
static bool adapt(const struct problem *p, const gsl_vector *base, double *numbers)
{
    double change[NUISANCES], squares[NUISANCES * NUISANCES];
    gsl_vector_view x = gsl_vector_view_array(change, NUISANCES);
    gsl_matrix_view covariance = gsl_matrix_view_array(squares, NUISANCES, NUISANCES);
    gsl_vector *const y = wb_memory_need(gsl_vector_alloc(base->size));
    for (size_t i = 0; i < base->size; i++) {
        double now = gsl_vector_get(base, i);
        for (size_t k = NUISANCES; k < NUMBERS; k++)
            now += gsl_matrix_get(p->slopes, i, k) * (numbers[k] - p->best[k]) / p->scale[k];
        gsl_vector_set(y, i, -now);
    }
    const bool adapted = solve(p, NUISANCES, y, &x.vector, &covariance.matrix);
    for (size_t k = 0; adapted && k < NUISANCES; k++)
        numbers[k] = p->best[k] + change[k] * p->scale[k];
    gsl_vector_free(y);
    return adapted;
}

static enum wb_status fill_nodes(struct wb_cycle_valley *valley, struct problem *p,
                                 const gsl_vector *base, double stress, double exponent)
{
    const double to_stress = fmin(reach * stress, widest_stress);
    const double to_exponent = fmin(reach * exponent, widest_exponent);
    const int middle = WB_VALLEY_NODES / 2;
    for (int i = 0; i < WB_VALLEY_NODES; i++) {
        for (int k = 0; k < WB_VALLEY_NODES; k++) {
            struct wb_cycle_valley_node *const node = &valley->nodes[i][k];
            double numbers[NUMBERS];
            for (int j = 0; j < NUMBERS; j++)
                numbers[j] = p->best[j];
            numbers[STRESS] += to_stress * (i - middle) / middle;
            numbers[EXPONENT] += to_exponent * (k - middle) / middle;
            const double n = numbers[EXPONENT];
            *node = (struct wb_cycle_valley_node){.misfit = (double)NAN};
            /* The centres of faces of 8 nodes are not computed. */
            if (!(n >= smallest_exponent && n <= largest_exponent) || (i % 2 == 1 && k % 2 == 1))
                continue;
            node->exponent = n;
            node->stress = exp(numbers[STRESS]);
            if (adapt(p, base, numbers))
                WB_TRY(run(p, numbers, &node->misfit));
        }
    }
    return WB_OK;
}

/* Shape functions of a face of 8 nodes: corners around, then the middles of the sides. */
static double misfit_within(const struct wb_cycle_valley *valley, int i, int k, double x, double y)
{
    const double weights[3][3] = {
        {-0.25 * (1.0 - x) * (1.0 - y) * (1.0 + x + y), 0.5 * (1.0 - x * x) * (1.0 - y),
         -0.25 * (1.0 + x) * (1.0 - y) * (1.0 - x + y)},
        {0.5 * (1.0 - x) * (1.0 - y * y), 0.0, 0.5 * (1.0 + x) * (1.0 - y * y)},
        {-0.25 * (1.0 - x) * (1.0 + y) * (1.0 + x - y), 0.5 * (1.0 - x * x) * (1.0 + y),
         -0.25 * (1.0 + x) * (1.0 + y) * (1.0 - x - y)},
    };
    double sum = 0.0;
    for (int a = 0; a < 3; a++) {
        for (int b = 0; b < 3; b++) {
            if (a != 1 || b != 1)
                sum += weights[a][b] * valley->nodes[i + a][k + b].misfit;
        }
    }
    return sum;
}

/* Widens the ranges by the pairs of a face that lie within the limit. */
static void take_face(struct wb_cycle_valley *valley, int i, int k)
{
    const struct wb_cycle_valley_node *const low = &valley->nodes[i][k];
    const struct wb_cycle_valley_node *const high = &valley->nodes[i + 2][k + 2];
    const int fine = 10;
    for (int a = 0; a <= fine; a++) {
        for (int b = 0; b <= fine; b++) {
            const double x = 2.0 * b / fine - 1.0, y = 2.0 * a / fine - 1.0;
            if (!(misfit_within(valley, i, k, x, y) <= valley->limit))
                continue;
            const double n = low->exponent + (high->exponent - low->exponent) * b / fine;
            const double stress = low->stress * pow(high->stress / low->stress, (double)a / fine);
            const double K = stress / pow(WB_BENDING_PLASTIC_STRAIN, n);
            valley->strength_low = fmin(valley->strength_low, K);
            valley->strength_high = fmax(valley->strength_high, K);
            valley->exponent_low = fmin(valley->exponent_low, n);
            valley->exponent_high = fmax(valley->exponent_high, n);
        }
    }
}

/* Finds the ranges of K and n within the limit. */
static void find_region(struct wb_cycle_valley *valley, int n_points)
{
    const int degrees = n_points > NUMBERS ? n_points - NUMBERS : 1;
    const double f = wb_fit_fisher_limit(1.0 - confidence, 2.0, degrees);
    const struct wb_cycle_valley_node *const nodes = &valley->nodes[0][0];
    for (int i = 0; i < WB_VALLEY_NODES * WB_VALLEY_NODES; i++) {
        if (nodes[i].misfit < valley->best_misfit)
            valley->best_misfit = nodes[i].misfit;
    }
    valley->limit = valley->best_misfit * sqrt(1.0 + 2.0 * f / degrees);
    valley->strength_low = valley->strength_high = valley->best.strength_coefficient;
    valley->exponent_low = valley->exponent_high = valley->best.hardening_exponent;
    for (int i = 0; i + 2 < WB_VALLEY_NODES; i += 2) {
        for (int k = 0; k + 2 < WB_VALLEY_NODES; k += 2)
            take_face(valley, i, k);
    }
}

static enum wb_status find(struct wb_cycle_valley *valley, struct problem *p, struct wb_reason *why)
{
    gsl_vector *const base = wb_memory_need(gsl_vector_alloc(p->slopes->size1));
    double stress, exponent;
    enum wb_status status = find_slopes(p, base, &valley->best_misfit);
    if (status == WB_OK &&
        (!isfinite(valley->best_misfit) || !find_errors(p, base, &stress, &exponent)))
        status = wb_fail_to(why, WB_ERR_DATA, "the loading does not bound K and n");
    if (status == WB_OK)
        status = fill_nodes(valley, p, base, stress, exponent);
    gsl_vector_free(base);
    if (status == WB_OK)
        find_region(valley, p->loading.n_points);
    return status;
}

/* Finds the optimum of the loading alone, the centre of the nodes. */
static enum wb_status find_best(struct problem *p, const struct wb_law *start,
                                struct wb_material *best, struct wb_reason *why)
{
    const struct wb_cycle_grid none = {0.0, 0.0};
    struct wb_cycle_fit fit;
    WB_TRY(wb_cycle_fit_run(&fit, &p->loading, WB_CANDIDATE_LUDWIK_ISOTROPIC, start, NULL, &none,
                            &p->settings, why));
    wb_cycle_fit_release(&fit);
    *best = fit.law.material;
    p->poissons_ratio = best->poissons_ratio;
    p->best[MODULUS] = log(best->youngs_modulus);
    p->best[YIELD] = log(best->yield_stress);
    p->best[BOW] = fit.bow_angle;
    p->best[LEVEL] = fit.level;
    p->uneven_angle = fit.uneven_angle;
    p->best[STRESS] =
        log(best->strength_coefficient * pow(WB_BENDING_PLASTIC_STRAIN, best->hardening_exponent));
    p->best[EXPONENT] = best->hardening_exponent;
    p->bow_prior = fmax(1e-6, isfinite(fit.bow_angle_error) ? fit.bow_angle_error : 0.01);
    for (int k = 0; k < NUMBERS; k++)
        p->scale[k] = 1.0;
    p->scale[BOW] = 0.01;
    p->scale[LEVEL] = p->settings.level_prior;
    return WB_OK;
}

enum wb_status wb_cycle_valley_find(struct wb_cycle_valley *valley,
                                    const struct wb_cycle_data *data, const struct wb_law *start,
                                    struct wb_reason *why)
{
    struct problem p = {.loading = *data};
    struct wb_law law;

    wb_cycle_fit_default_settings(&p.settings);
    p.settings.n_final_elements = p.settings.n_elements;
    p.loading.n_points = data->n_loading;
    p.loading.n_places = 0;
    while (p.loading.n_places < data->n_places &&
           data->places[p.loading.n_places].point < data->n_loading)
        p.loading.n_places++;
    p.noise = fmax(p.settings.force_noise, p.settings.force_share * data->max_force);
    WB_TRY(find_best(&p, start, &valley->best, why));
    law_of(&p, p.best, &law);
    const struct wb_cycle_model_settings how = {p.settings.n_elements, p.settings.n_fibres};
    const size_t n = (size_t)p.loading.n_points;
    p.tension = wb_memory_new(n, sizeof *p.tension);
    p.residual = wb_memory_new(n, sizeof *p.residual);
    p.slopes = wb_memory_need(gsl_matrix_alloc(n + 2, NUMBERS));
    enum wb_status status = wb_cycle_model_create(&p.model, &p.loading, &law, &how);
    if (status == WB_OK)
        status = find(valley, &p, why);
    wb_cycle_model_destroy(p.model);
    gsl_matrix_free(p.slopes);
    free(p.tension);
    free(p.residual);
    return status;
}
