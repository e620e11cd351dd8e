/* A law fitted to a cycle that a beam of a known law computed: no noise, the same mesh. */
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_blas.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_matrix.h>

#include "analysis/calibration/cycle/cycle_fit.h"
#include "analysis/calibration/cycle/cycle_model.h"
#include "analysis/calibration/law/bending.h"
#include "base/units.h"
#include "tests/check.h"

enum {
    ELEMENTS = 12,
    FIBRES = 20,
    MOST_POINTS = 128
};

static const double top = 53.0 * WB_MM;

struct specimen {
    struct wb_cycle_point points[MOST_POINTS];
    struct wb_cycle_data data;
};

static struct wb_test_info test_info(void)
{
    struct wb_test_info info = {
        .sample = 1,
        .length = 85.0 * WB_MM,
        .outer_diameter = 1.25 * WB_MM,
        .mass_per_length = 5e-3,
        .poissons_ratio = 0.39,
        .strand_length = 760.0 * WB_MM,
        .counterweight = 2.7 * WB_G,
        .gravity = WB_STANDARD_GRAVITY,
        .rest_level = (double)NAN,
    };
    snprintf(info.wire, sizeof info.wire, "computed");
    return info;
}

/* The tip moves at 1 mm/s. */
static void add(struct specimen *s, double deflection, bool unloading)
{
    const double speed = 1.0 * WB_MM;
    s->points[s->data.n_points++] = (struct wb_cycle_point){
        .deflection = deflection,
        .t = unloading ? s->data.departure + (top - deflection) / speed : deflection / speed,
        .is_unloading = unloading,
        .n_rows = 20,
        .deviation = 1e-5};
}

static void add_dwell(struct specimen *s, double dwell)
{
    s->data.arrival = top / (1.0 * WB_MM);
    s->data.departure = s->data.arrival + dwell;
    s->data.n_held = dwell > 0.0 ? WB_CYCLE_MOST_HELD : 0;
    for (int i = 0; i < s->data.n_held; i++)
        s->data.held[i] = (struct wb_cycle_held){
            .t = s->data.arrival + dwell * (i + 0.5) / WB_CYCLE_MOST_HELD, .deviation = 1e-6};
}

/* The cycle of a wire of this law and natural angle of the tip, held at the turn for `dwell` s. */
static void compute_with(struct specimen *s, const struct wb_law *law, double bow_angle,
                         double dwell)
{
    const struct wb_cycle_model_settings mesh = {ELEMENTS, FIBRES};
    const struct wb_cycle_specimen specimen = {bow_angle, 0.0};
    double tension[MOST_POINTS];
    struct wb_cycle_model *model;
    struct wb_cycle_run run;

    *s = (struct specimen){.data = {.info = test_info(), .top = top}};
    s->data.points = s->points;
    add_dwell(s, dwell);
    for (double d = 0.5 * WB_MM; d < top; d += (d < 4.0 * WB_MM ? 0.5 : 1.0) * WB_MM)
        add(s, d, false);
    s->data.n_loading = s->data.n_points;
    for (double d = top - 1.0 * WB_MM; d > 20.0 * WB_MM; d -= 1.0 * WB_MM)
        add(s, d, true);
    assert_int_equal(wb_cycle_model_create(&model, &s->data, law, &mesh), WB_OK);
    assert_int_equal(wb_cycle_model_run(model, law, &specimen, tension, NULL, &run), WB_OK);
    assert_true(run.reached);
    for (int i = 0; i < s->data.n_held; i++)
        s->data.held[i].tension = wb_cycle_model_held(model)[i];
    wb_cycle_model_destroy(model);
    int kept = 0;
    for (int i = 0; i < s->data.n_points && tension[i] > 2.5e-3; i++, kept++) {
        s->points[i].tension = tension[i];
        s->data.max_force = fmax(s->data.max_force, tension[i] - tension[0]);
    }
    s->data.n_points = kept;
    assert_true(kept > s->data.n_loading + 8);
}

static void compute(struct specimen *s, const struct wb_law *law, double bow_angle)
{
    compute_with(s, law, bow_angle, 0.0);
}

static void default_settings(struct wb_cycle_fit_settings *settings)
{
    wb_cycle_fit_default_settings(settings);
    settings->n_elements = settings->n_final_elements = ELEMENTS;
    settings->n_fibres = FIBRES;
}

/* Grid of parallel parts that span this test. */
static struct wb_cycle_grid test_grid(void)
{
    return (struct wb_cycle_grid){1.3e-4, 1.8e-2};
}

static struct wb_law ludwik(double isotropic_share, double exponent)
{
    const struct wb_material m = {
        WB_HARDENING_ISOTROPIC_POWER, 5641e6, 0.39, 4.95e6, 850e6, exponent};
    struct wb_law law;
    wb_law_init_ludwik(&law, &m);
    law.isotropic_share = isotropic_share;
    return law;
}

static struct wb_law parallel(double isotropic_share)
{
    static const double moduli[WB_FIT_PARTS] = {0.9e9, 1.4e9, 1.5e9, 0.9e9, 0.4e9, 0.15e9, 0.3e9};
    const struct wb_cycle_grid grid = test_grid();
    struct wb_law_part parts[WB_FIT_PARTS];
    struct wb_law law;
    for (int i = 0; i < WB_FIT_PARTS; i++)
        parts[i] = (struct wb_law_part){
            moduli[i], i == WB_FIT_PARTS - 1
                           ? (double)INFINITY
                           : grid.first_strain * pow(grid.last_strain / grid.first_strain,
                                                     (double)i / (WB_FIT_PARTS - 1))};
    wb_law_init_parallel(&law, parts, WB_FIT_PARTS, isotropic_share, 0.39);
    return law;
}

/* A start a factor off in all of Ludwik's numbers. */
static struct wb_law start_off(double factor)
{
    struct wb_law law = ludwik(1.0, 0.7);
    law.material.youngs_modulus *= factor;
    law.material.yield_stress *= factor;
    law.material.strength_coefficient *= factor;
    return law;
}

static void fit(struct wb_cycle_fit *found, const struct specimen *s, enum wb_candidate candidate,
                double factor, const struct wb_cycle_fit_settings *settings)
{
    const struct wb_cycle_grid grid = test_grid();
    const struct wb_law start = start_off(factor);
    assert_int_equal(
        wb_cycle_fit_run(found, &s->data, candidate, &start, NULL, &grid, settings, NULL), WB_OK);
    assert_true(found->is_converged);
}

static void ludwiks_law_is_found_again(void **unused)
{
    (void)unused;
    static const struct {
        enum wb_candidate candidate;
        double share, exponent;
    } cases[] = {
        {WB_CANDIDATE_LUDWIK_ISOTROPIC, 1.0, 0.78},
        {WB_CANDIDATE_LUDWIK_KINEMATIC, 0.0, 0.78},
        {WB_CANDIDATE_LUDWIK_MIXED, 0.3, 0.78},
        {WB_CANDIDATE_LUDWIK_MIXED, 0.7, 0.60},
    };
    struct wb_cycle_fit_settings settings;
    default_settings(&settings);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct specimen s;
        struct wb_cycle_fit found;
        const struct wb_law law = ludwik(cases[i].share, cases[i].exponent);
        compute(&s, &law, 0.03);
        fit(&found, &s, cases[i].candidate, 1.2, &settings);
        const struct wb_material *const m = &found.law.material;
        assert_true(found.misfit < 2e-5);
        assert_close_relative(m->youngs_modulus, 5641e6, 1e-3);
        assert_close_relative(m->yield_stress, 4.95e6, 3e-3);
        assert_close_relative(m->strength_coefficient, 850e6, 1e-2);
        assert_close(m->hardening_exponent, cases[i].exponent, 2e-3);
        assert_close(found.law.isotropic_share, cases[i].share, 1e-3);
        assert_close(found.bow_angle, 0.03, 5e-5);
        assert_close(found.level, 0.0, 0.005 * WB_MM);
        assert_false(found.is_at_bound);
        assert_int_equal(found.n_outliers, 0);
        wb_cycle_fit_release(&found);
    }
}

static void parallel_parts_are_found_again(void **unused)
{
    (void)unused;
    static const double shares[] = {0.0, 0.3, 0.7, 0.05, 0.15};
    struct wb_cycle_fit_settings settings;
    default_settings(&settings);
    settings.modulus_prior = 50.0; /* the moduli given here are not smooth */
    for (int i = 0; i < 5; i++) {
        const enum wb_candidate candidate = i >= 3            ? WB_CANDIDATE_PARALLEL_COMBINED
                                            : shares[i] > 0.0 ? WB_CANDIDATE_PARALLEL_MIXED
                                                              : WB_CANDIDATE_PARALLEL_KINEMATIC;
        struct specimen s;
        struct wb_cycle_fit found;
        struct wb_law law = parallel(shares[i]);
        law.is_combined = i >= 3;
        compute(&s, &law, -0.02);
        fit(&found, &s, candidate, 1.0, &settings);
        assert_true(found.misfit < 1e-4);
        assert_close(found.law.isotropic_share, shares[i], 3e-3);
        assert_close_relative(found.law.material.youngs_modulus, law.material.youngs_modulus, 0.01);
        for (int k = 1; k < WB_FIT_PARTS; k++)
            assert_close(found.law.parts[k].modulus, law.parts[k].modulus,
                         0.02 * law.material.youngs_modulus);
        wb_cycle_fit_release(&found);
    }
}

/* The larger start over the smaller is 1.65 squared. */
static void starts_on_either_side_find_the_same_minimum(void **unused)
{
    (void)unused;
    static const enum wb_candidate candidates[] = {WB_CANDIDATE_LUDWIK_KINEMATIC,
                                                   WB_CANDIDATE_PARALLEL_KINEMATIC};
    struct wb_cycle_fit_settings settings;
    struct specimen s;
    const struct wb_law law = parallel(0.0);
    default_settings(&settings);
    compute(&s, &law, 0.01);
    for (int i = 0; i < 2; i++) {
        struct wb_cycle_fit low, high;
        fit(&low, &s, candidates[i], 1.0 / 1.65, &settings);
        fit(&high, &s, candidates[i], 1.65, &settings);
        assert_close(low.misfit, high.misfit, 2e-5);
        assert_close_relative(low.law.material.youngs_modulus, high.law.material.youngs_modulus,
                              0.01);
        assert_close(low.bow_angle, high.bow_angle, 3e-4);
        wb_cycle_fit_release(&low);
        wb_cycle_fit_release(&high);
    }
}

static void points_far_off_count_little_and_are_counted(void **unused)
{
    (void)unused;
    struct wb_cycle_fit_settings settings;
    struct specimen s;
    struct wb_cycle_fit found;
    const struct wb_law law = ludwik(0.0, 0.78);
    default_settings(&settings);
    compute(&s, &law, 0.03);
    s.points[20].tension += 0.05;
    s.points[40].tension += 0.03;
    s.points[s.data.n_loading + 5].tension -= 0.04;
    fit(&found, &s, WB_CANDIDATE_LUDWIK_KINEMATIC, 1.0, &settings);
    assert_int_equal(found.n_outliers, 3);
    /* A point far off still pulls like one of 2.5 standard deviations. */
    assert_close_relative(found.law.material.youngs_modulus, 5641e6, 0.08);
    assert_close_relative(found.law.material.strength_coefficient, 850e6, 0.08);
    assert_true(found.misfit > 0.01); /* which counts them */
    wb_cycle_fit_release(&found);
}

static void the_level_of_zero_deflection_is_found(void **unused)
{
    (void)unused;
    struct wb_cycle_fit_settings settings;
    struct specimen s;
    struct wb_cycle_fit found;
    const struct wb_law law = ludwik(0.0, 0.78);
    default_settings(&settings);
    settings.level_prior = 1.0 * WB_MM; /* of forces alone the usual one would win */
    compute(&s, &law, 0.03);
    for (int i = 0; i < s.data.n_points; i++)
        s.points[i].deflection += 0.05 * WB_MM;
    s.data.top += 0.05 * WB_MM;
    fit(&found, &s, WB_CANDIDATE_LUDWIK_KINEMATIC, 1.0, &settings);
    assert_close(found.level, 0.05 * WB_MM, 0.01 * WB_MM);
    assert_close_relative(found.law.material.youngs_modulus, 5641e6, 0.005);
    wb_cycle_fit_release(&found);
}

/* A law's derivatives of the whole cycle, from cycles computed beside it, against the slow twin: a
 * run of its own for each. */
static void neighbours_of_a_run_are_runs_of_their_own(void **unused)
{
    (void)unused;
    enum {
        NEIGHBOURS = 3
    };
    const double step = 1e-3;
    const struct wb_cycle_model_settings mesh = {ELEMENTS, FIBRES, NEIGHBOURS};
    struct wb_law laws[4] = {ludwik(1.0, 0.78), ludwik(0.0, 0.75), parallel(0.4), ludwik(0.0, 0.7)};
    laws[3].n_maxwell = 1;
    laws[3].maxwell[0] = (struct wb_law_maxwell){0.4e9, 15.0};
    laws[3].strain_rate = 1e-4;
    for (int k = 0; k < 4; k++) {
        const struct wb_cycle_specimen specimen = {0.03, 0.05 * WB_MM, 0.01};
        double alone[MOST_POINTS], beside[MOST_POINTS], tension[NEIGHBOURS][MOST_POINTS];
        double held[WB_CYCLE_MOST_HELD], largest = 0.0;
        struct wb_cycle_model *model;
        struct wb_cycle_neighbour neighbours[NEIGHBOURS];
        struct wb_cycle_run run;
        struct specimen s;
        compute_with(&s, &laws[k], 0.03, 60.0);
        for (int i = 0; i < NEIGHBOURS; i++)
            neighbours[i] = (struct wb_cycle_neighbour){laws[k], specimen, tension[i], NULL};
        if (laws[k].form == WB_LAW_LUDWIK)
            neighbours[0].law.material.yield_stress *= 1.0 + step;
        else
            neighbours[0].law.isotropic_share += step;
        neighbours[1].specimen.bow_angle += 0.1 * step;
        neighbours[2].specimen.level += step * WB_MM;
        assert_int_equal(wb_cycle_model_create(&model, &s.data, &laws[k], &mesh), WB_OK);
        assert_int_equal(wb_cycle_model_run_beside(model, &laws[k], &specimen, beside, NULL,
                                                   NEIGHBOURS, neighbours, &run),
                         WB_OK);
        assert_int_equal(wb_cycle_model_run(model, &laws[k], &specimen, alone, NULL, &run), WB_OK);
        memcpy(held, wb_cycle_model_held(model), (size_t)s.data.n_held * sizeof *held);
        for (int i = 0; i < s.data.n_points; i++)
            assert_true(beside[i] == alone[i]);
        for (int i = 0; i < NEIGHBOURS; i++) {
            double squares = 0.0, missed = 0.0;
            assert_int_equal(wb_cycle_model_run(model, &neighbours[i].law, &neighbours[i].specimen,
                                                beside, NULL, &run),
                             WB_OK);
            for (int j = 0; j < s.data.n_points; j++) {
                squares += pow(beside[j] - alone[j], 2.0);
                missed += pow(tension[i][j] - beside[j], 2.0);
            }
            for (int j = 0; j < s.data.n_held; j++)
                assert_close(neighbours[i].held[j], wb_cycle_model_held(model)[j],
                             0.01 * fabs(neighbours[i].held[j] - held[j]) + 1e-9);
            assert_true(squares > 0.0);
            largest = fmax(largest, sqrt(missed / squares));
        }
        print_message("    law %d: differences missed by at most %.2e\n", k, largest);
        assert_true(largest < 5e-3);
        wb_cycle_model_destroy(model);
    }
}

/* A share that would not leave its end is not searched, and one that would is. */
static void a_share_at_its_end_is_known_at_once(void **unused)
{
    (void)unused;
    const struct wb_cycle_grid grid = test_grid();
    struct wb_cycle_fit_settings settings;
    default_settings(&settings);
    for (int k = 0; k < 3; k++) {
        const struct wb_law law = ludwik(0.5 * k, 0.75);
        const enum wb_candidate pure =
            k == 2 ? WB_CANDIDATE_LUDWIK_ISOTROPIC : WB_CANDIDATE_LUDWIK_KINEMATIC;
        struct wb_cycle_fit contained, mixed;
        struct specimen s;
        compute(&s, &law, 0.02);
        fit(&contained, &s, pure, 1.1, &settings);
        assert_int_equal(wb_cycle_fit_run(&mixed, &s.data, WB_CANDIDATE_LUDWIK_MIXED,
                                          &contained.law, &contained, &grid, &settings, NULL),
                         WB_OK);
        print_message("    share %g: %d runs\n", 0.5 * k, mixed.runs);
        assert_int_equal(mixed.is_contained, k != 1);
        if (k == 1) {
            assert_true(mixed.is_converged);
            assert_close(mixed.law.isotropic_share, 0.5, 0.01);
            assert_true(mixed.misfit < 1e-4);
        }
        wb_cycle_fit_release(&mixed);
        wb_cycle_fit_release(&contained);
    }
}

/* What the rule is worth: the other one misses the unloading by far. */
static void a_wrong_hardening_rule_increases_the_misfit(void **unused)
{
    (void)unused;
    struct wb_cycle_fit_settings settings;
    struct specimen s;
    struct wb_cycle_fit found;
    const struct wb_law law = ludwik(1.0, 0.78);
    const struct wb_law start = start_off(1.0);
    default_settings(&settings);
    compute(&s, &law, 0.0);
    assert_int_equal(wb_cycle_fit_run(&found, &s.data, WB_CANDIDATE_LUDWIK_KINEMATIC, &start, NULL,
                                      NULL, &settings, NULL),
                     WB_OK);
    assert_true(found.misfit > 0.01);
    wb_cycle_fit_release(&found);
}

/* A normal number of standard deviation 1, from uniform ones that repeat. */
static double normal(uint64_t *state)
{
    double sum = -6.0;
    for (int i = 0; i < 12; i++) {
        *state = *state * 6364136223846793005u + 1442695040888963407u;
        sum += (double)(*state >> 11) / 9007199254740992.0;
    }
    return sum;
}

/* Standard error of ln E by the laws that were moved. */
static double stated_modulus_error(const struct wb_cycle_fit *fit)
{
    double squares = 0.0;
    for (int i = 0; i < fit->n_moved; i++) {
        const double ratio =
            fit->moved[i].material.youngs_modulus / fit->law.material.youngs_modulus;
        squares += pow((ratio - 1.0) / fit->moved_by[i], 2.0);
    }
    return sqrt(squares);
}

/* Of many tests of one wire that differ by their noise alone. */
static void correlations_and_errors_are_those_of_repeated_tests(void **unused)
{
    (void)unused;
    enum {
        TESTS = 60
    };
    struct specimen exact, noisy;
    struct wb_cycle_fit_settings settings;
    const struct wb_law law = ludwik(0.0, 0.75);
    const struct wb_cycle_grid grid = test_grid();
    double x[TESTS], y[TESTS], mean_x = 0.0, mean_y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0,
                               stated = 0.0, error = 0.0, modulus = 0.0, modulus_squares = 0.0,
                               modulus_error = 0.0;
    uint64_t state = 5;
    char text[24];
    default_settings(&settings);
    settings.level_prior = 1.0; /* the tests do not differ by what a prior leaves open */
    compute(&exact, &law, 0.05);
    for (int k = 0; k < TESTS; k++) {
        struct wb_cycle_fit fit;
        noisy = exact;
        noisy.data.points = noisy.points;
        for (int i = 0; i < noisy.data.n_points; i++)
            noisy.points[i].tension += 1e-4 * normal(&state);
        assert_int_equal(wb_cycle_fit_run(&fit, &noisy.data, WB_CANDIDATE_LUDWIK_KINEMATIC, &law,
                                          NULL, &grid, &settings, NULL),
                         WB_OK);
        assert_int_equal(fit.n_numbers, 4);
        assert_string_equal(wb_cycle_fit_number(&fit, 2, text), "K");
        x[k] = log(fit.law.material.strength_coefficient);
        y[k] = fit.law.material.hardening_exponent;
        mean_x += x[k] / TESTS;
        mean_y += y[k] / TESTS;
        stated += fit.correlation[2][3] / TESTS;
        error += fit.exponent_error / TESTS;
        const double ln_modulus = log(fit.law.material.youngs_modulus / 5641e6);
        modulus += ln_modulus / TESTS;
        modulus_squares += ln_modulus * ln_modulus / TESTS;
        modulus_error += stated_modulus_error(&fit) / TESTS;
        for (int i = 0; i < 4; i++)
            assert_close(fit.correlation[i][i], 1.0, 1e-12);
        wb_cycle_fit_release(&fit);
    }
    for (int k = 0; k < TESTS; k++) {
        xx += (x[k] - mean_x) * (x[k] - mean_x);
        xy += (x[k] - mean_x) * (y[k] - mean_y);
        yy += (y[k] - mean_y) * (y[k] - mean_y);
    }
    print_message("    ln K and n: %.3f found, %.3f stated\n", xy / sqrt(xx * yy), stated);
    const double found = sqrt(yy / (TESTS - 1));
    print_message("    n: standard deviation %.5f found, %.5f stated\n", found, error);
    assert_close(xy / sqrt(xx * yy), stated, 0.002);
    assert_close_relative(found, error, 0.3);
    const double scatter = sqrt(modulus_squares - modulus * modulus);
    print_message("    ln E: standard deviation %.5f found, %.5f stated\n", scatter, modulus_error);
    /* Of white noise residuals of one sign in a row make it half as large again: a row has two on
     * average, its sum a mean square of 2 + 4 (2/pi) variances. Too small it must not be. */
    assert_true(modulus_error >= 0.9 * scatter);
    assert_true(modulus_error <= 2.0 * scatter);
}

/* What a normal density around the best fit leaves out: the posterior of Ludwik's law and the
 * specimen's bow and level, sampled by Metropolis and Hastings with runs of the beam alone. */
enum {
    LN_E,
    LN_YIELD,
    LN_HARDENING, /* of the stress at a plastic strain of 3e-3 */
    EXPONENT,
    BOW,
    LEVEL,
    SAMPLED,
    MOMENTS = 4 /* and stiffnesses */
};

struct posterior {
    const struct specimen *s;
    struct wb_cycle_model *model;
    double noise, level_prior;
};

static struct wb_law sampled_law(const double *x)
{
    struct wb_law law = ludwik(0.0, x[EXPONENT]);
    law.material.youngs_modulus = exp(x[LN_E]);
    law.material.yield_stress = exp(x[LN_YIELD]);
    law.material.strength_coefficient = exp(x[LN_HARDENING]) / pow(3e-3, x[EXPONENT]);
    return law;
}

/* Residuals over their standard deviations; false where there is no such wire. */
static bool sampled_residuals(const struct posterior *p, const double *x, double *r)
{
    const struct wb_law law = sampled_law(x);
    const struct wb_cycle_specimen specimen = {x[BOW], x[LEVEL], 0.0};
    struct wb_reason why;
    struct wb_cycle_run run;
    if (wb_law_check(&law, &why) != WB_OK)
        return false;
    assert_int_equal(wb_cycle_model_run(p->model, &law, &specimen, r, NULL, &run), WB_OK);
    for (int i = 0; i < p->s->data.n_points; i++)
        r[i] = (r[i] - p->s->points[i].tension) / p->noise;
    r[p->s->data.n_points] = x[LEVEL] / p->level_prior;
    return run.reached;
}

/* Lower triangular L of the inverse of J'J, by differences: L L' is the covariance. */
static void proposal(const struct posterior *p, const double *x, gsl_matrix *L)
{
    const int n = p->s->data.n_points + 1;
    double low[MOST_POINTS + 1], high[MOST_POINTS + 1], at[SAMPLED];
    gsl_matrix *const J = gsl_matrix_alloc((size_t)n, SAMPLED);
    for (int k = 0; k < SAMPLED; k++) {
        const double step = k == LEVEL ? 1e-6 : k == BOW ? 1e-4 : 1e-3;
        memcpy(at, x, sizeof at);
        at[k] = x[k] - step;
        assert_true(sampled_residuals(p, at, low));
        at[k] = x[k] + step;
        assert_true(sampled_residuals(p, at, high));
        for (int i = 0; i < n; i++)
            gsl_matrix_set(J, (size_t)i, (size_t)k, (high[i] - low[i]) / (2.0 * step));
    }
    gsl_blas_dsyrk(CblasLower, CblasTrans, 1.0, J, 0.0, L);
    assert_int_equal(gsl_linalg_cholesky_decomp1(L), GSL_SUCCESS);
    assert_int_equal(gsl_linalg_cholesky_invert(L), GSL_SUCCESS);
    assert_int_equal(gsl_linalg_cholesky_decomp1(L), GSL_SUCCESS);
    gsl_matrix_free(J);
}

/* Logarithms of two moments, of the unloading stiffness over 1 /m and of E. */
static void stated_numbers(const struct wb_law *law, double diameter, double *number)
{
    static const double curvature[2] = {4.0, 25.0};
    const double change = 1.0;
    double secant;
    assert_int_equal(wb_bending_moments(law, diameter, 2, curvature, number), WB_OK);
    assert_int_equal(
        wb_bending_stiffness(law, diameter, 25.0, 1, curvature, &secant, 1, &change, &number[2]),
        WB_OK);
    number[3] = law->material.youngs_modulus;
    for (int i = 0; i < MOMENTS; i++)
        number[i] = log(number[i]);
}

static void errors_are_those_of_the_sampled_posterior(void **unused)
{
    (void)unused;
    enum {
        SAMPLES = 2500
    };
    static const char *const names[MOMENTS] = {"M(4 /m)", "M(25 /m)", "unloading", "E"};
    const double wider = 1.3; /* proposals than the density, so that its tails are met */
    const struct wb_cycle_model_settings mesh = {ELEMENTS, FIBRES, 0};
    const struct wb_law law = ludwik(0.0, 0.75);
    struct wb_cycle_fit_settings settings;
    struct wb_cycle_fit found;
    struct specimen s;
    struct posterior p = {.s = &s};
    double r[MOST_POINTS + 1], at[SAMPLED], now[SAMPLED], z[SAMPLED], number[MOMENTS];
    double sum = 0.0, square_z = 0.0, mean[MOMENTS] = {0.0}, squares[MOMENTS] = {0.0};
    uint64_t state = 11;
    int accepted = 0;
    default_settings(&settings);
    compute(&s, &law, 0.05);
    p.noise = fmax(settings.force_noise, settings.force_share * s.data.max_force);
    p.level_prior = settings.level_prior;
    for (int i = 0; i < s.data.n_points; i++)
        s.points[i].tension += p.noise * normal(&state);
    assert_int_equal(wb_cycle_fit_run(&found, &s.data, WB_CANDIDATE_LUDWIK_KINEMATIC, &law, NULL,
                                      NULL, &settings, NULL),
                     WB_OK);
    assert_int_equal(wb_cycle_model_create(&p.model, &s.data, &law, &mesh), WB_OK);
    const struct wb_material *const m = &found.law.material;
    const double best[SAMPLED] = {
        log(m->youngs_modulus),
        log(m->yield_stress),
        log(m->strength_coefficient * pow(3e-3, m->hardening_exponent)),
        m->hardening_exponent,
        found.bow_angle,
        found.level,
    };
    gsl_matrix *const L = gsl_matrix_alloc(SAMPLED, SAMPLED);
    proposal(&p, best, L);
    memcpy(now, best, sizeof now);
    assert_true(sampled_residuals(&p, now, r));
    for (int i = 0; i <= s.data.n_points; i++)
        sum += r[i] * r[i];
    for (int k = 0; k < SAMPLES; k++) {
        double sum_there = 0.0, square_there = 0.0;
        for (int i = 0; i < SAMPLED; i++) {
            z[i] = wider * normal(&state);
            square_there += z[i] * z[i] / (wider * wider);
        }
        for (int i = 0; i < SAMPLED; i++) {
            at[i] = best[i];
            for (int j = 0; j <= i; j++)
                at[i] += gsl_matrix_get(L, (size_t)i, (size_t)j) * z[j];
        }
        const bool is_wire = sampled_residuals(&p, at, r);
        for (int i = 0; i <= s.data.n_points; i++)
            sum_there += r[i] * r[i];
        state = state * 6364136223846793005u + 1442695040888963407u;
        const double uniform = (double)(state >> 11) / 9007199254740992.0;
        if (is_wire && log(uniform) < 0.5 * (sum - sum_there + square_there - square_z)) {
            memcpy(now, at, sizeof now);
            sum = sum_there;
            square_z = square_there;
            accepted++;
        }
        const struct wb_law drawn = sampled_law(now);
        stated_numbers(&drawn, s.data.info.outer_diameter, number);
        for (int i = 0; i < MOMENTS; i++) {
            mean[i] += number[i] / SAMPLES;
            squares[i] += number[i] * number[i] / SAMPLES;
        }
    }
    double own[MOMENTS], stated[MOMENTS] = {0.0};
    stated_numbers(&found.law, s.data.info.outer_diameter, own);
    for (int k = 0; k < found.n_moved; k++) {
        stated_numbers(&found.moved[k], s.data.info.outer_diameter, number);
        for (int i = 0; i < MOMENTS; i++)
            stated[i] += pow((number[i] - own[i]) / found.moved_by[k], 2.0);
    }
    print_message("    %d of %d samples accepted\n", accepted, SAMPLES);
    for (int i = 0; i < MOMENTS; i++) {
        const double sampled = sqrt(squares[i] - mean[i] * mean[i]);
        print_message("    %s: %.3f %% sampled, %.3f %% stated\n", names[i], 100.0 * sampled,
                      100.0 * sqrt(stated[i]));
        assert_true(sqrt(stated[i]) >= 0.9 * sampled);
        assert_true(sqrt(stated[i]) <= 2.0 * sampled);
        assert_close(mean[i], own[i], 0.3 * sampled);
    }
    assert_true(accepted > SAMPLES / 5);
    gsl_matrix_free(L);
    wb_cycle_model_destroy(p.model);
    wb_cycle_fit_release(&found);
}

/* What all specimens share: the step to first order, and a search with the altered data. */
static void sensitivities_to_shared_quantities_agree_with_a_new_search(void **unused)
{
    (void)unused;
    enum {
        CURVATURES = 3
    };
    static const double curvature[CURVATURES] = {2.0, 8.0, 25.0};
    const double larger = 3.0; /* changes that the ends of searches tell */
    struct wb_cycle_fit_settings settings;
    const struct wb_law law = ludwik(0.0, 0.75);
    const struct wb_law parts = parallel(0.0);
    default_settings(&settings);
    for (int k = 0; k < 2; k++) {
        const enum wb_candidate candidate =
            k == 0 ? WB_CANDIDATE_LUDWIK_KINEMATIC : WB_CANDIDATE_PARALLEL_KINEMATIC;
        settings.modulus_prior = 50.0; /* the moduli given here are not smooth */
        double M[CURVATURES], predicted[CURVATURES], found[CURVATURES];
        struct wb_cycle_fit base, again;
        struct specimen s, altered;
        compute(&s, k == 0 ? &law : &parts, 0.03);
        fit(&base, &s, candidate, 1.2, &settings);
        wb_cycle_fit_find_altered(&base);
        assert_false(base.has_altered[WB_SHARED_DIAMETER]);
        for (int i = 0; i < WB_SHARED_DIAMETER; i++) {
            altered = s;
            assert_true(base.has_altered[i]);
            const double change = larger * wb_cycle_shared_change(i);
            if (i == WB_SHARED_RELAXATION)
                continue;
            assert_true(wb_cycle_shared_alter(&altered.data, &s.data, i, change));
            fit(&again, &altered, candidate, 1.2, &settings);
            const double d = s.data.info.outer_diameter;
            assert_int_equal(wb_bending_moments(&base.law, d, CURVATURES, curvature, M), WB_OK);
            assert_int_equal(
                wb_bending_moments(&base.altered[i], d, CURVATURES, curvature, predicted), WB_OK);
            assert_int_equal(wb_bending_moments(&again.law, d, CURVATURES, curvature, found),
                             WB_OK);
            for (int j = 0; j < CURVATURES; j++) {
                const double step = larger * (predicted[j] / M[j] - 1.0),
                             search = found[j] / M[j] - 1.0;
                print_message("    %s, %g /m: %+.3f %%, by a search %+.3f %%\n",
                              wb_cycle_shared_name(i), curvature[j], 100.0 * step, 100.0 * search);
                /* Moduli that are nearly nothing are no linear numbers. */
                assert_close(step, search, 3e-4 + (k == 0 ? 0.02 : 0.15) * fabs(search));
            }
            wb_cycle_fit_release(&again);
            wb_cycle_data_release(&altered.data);
        }
        wb_cycle_fit_release(&base);
    }
}

/* Both elements of a law come back from the cycle with a dwell, whatever its form; from a start
 * that knows the dwell alone. */
static void relaxation_is_found_from_the_dwell(void **unused)
{
    (void)unused;
    struct wb_cycle_fit_settings settings;
    default_settings(&settings);
    for (int n = 1; n <= 2; n++) {
        struct wb_law law = ludwik(0.0, 0.6);
        struct wb_cycle_fit found;
        struct specimen s;
        law.n_maxwell = n;
        law.maxwell[0] = (struct wb_law_maxwell){0.5e9, n == 1 ? 15.0 : 5.0};
        law.maxwell[1] = (struct wb_law_maxwell){0.4e9, 60.0};
        compute_with(&s, &law, 0.03, 40.0);
        assert_true(s.data.held[0].tension > 1.01 * s.data.held[WB_CYCLE_MOST_HELD - 1].tension);
        settings.n_maxwell = n;
        fit(&found, &s, WB_CANDIDATE_LUDWIK_KINEMATIC, 1.2, &settings);
        assert_true(found.misfit < 2e-4);
        assert_int_equal(found.law.n_maxwell, n);
        for (int i = 0; i < n; i++) {
            print_message("    element %d: %.4g MPa over %.2f s\n", i + 1,
                          found.law.maxwell[i].modulus / WB_MPA, found.law.maxwell[i].time);
            assert_close_relative(found.law.maxwell[i].modulus, law.maxwell[i].modulus,
                                  n == 1 ? 0.02 : 0.15);
            assert_close_relative(found.law.maxwell[i].time, law.maxwell[i].time,
                                  n == 1 ? 0.02 : 0.15);
        }
        assert_close_relative(found.law.material.youngs_modulus, law.material.youngs_modulus, 0.02);
        /* The outer fibre's largest strain over the time of the loading. */
        const double loading = s.data.arrival - s.points[0].t;
        assert_close_relative(found.law.strain_rate,
                              0.5 * s.data.info.outer_diameter * found.clamp_curvature / loading,
                              1e-2);
        assert_int_equal(found.n_moved, found.n_law);
        wb_cycle_fit_release(&found);
    }
}

/* A law without elements misses the wire that relaxes, and is distinguished from it. */
static void a_law_that_does_not_relax_misses_one_that_does(void **unused)
{
    (void)unused;
    struct wb_cycle_fit_settings settings;
    struct wb_law law = ludwik(0.0, 0.6);
    struct wb_cycle_fit found;
    struct specimen s;
    default_settings(&settings);
    law.n_maxwell = 1;
    law.maxwell[0] = (struct wb_law_maxwell){0.5e9, 15.0};
    compute_with(&s, &law, 0.03, 40.0);
    fit(&found, &s, WB_CANDIDATE_LUDWIK_KINEMATIC, 1.2, &settings);
    assert_true(found.misfit > 1e-3);
    wb_cycle_fit_release(&found);
}

int main(void)
{
    gsl_set_error_handler_off();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(relaxation_is_found_from_the_dwell),
        cmocka_unit_test(a_law_that_does_not_relax_misses_one_that_does),
        cmocka_unit_test(ludwiks_law_is_found_again),
        cmocka_unit_test(parallel_parts_are_found_again),
        cmocka_unit_test(starts_on_either_side_find_the_same_minimum),
        cmocka_unit_test(points_far_off_count_little_and_are_counted),
        cmocka_unit_test(the_level_of_zero_deflection_is_found),
        cmocka_unit_test(neighbours_of_a_run_are_runs_of_their_own),
        cmocka_unit_test(a_share_at_its_end_is_known_at_once),
        cmocka_unit_test(a_wrong_hardening_rule_increases_the_misfit),
        cmocka_unit_test(correlations_and_errors_are_those_of_repeated_tests),
        cmocka_unit_test(errors_are_those_of_the_sampled_posterior),
        cmocka_unit_test(sensitivities_to_shared_quantities_agree_with_a_new_search),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
