#include "analysis/calibration/cycle/cycle_fit.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <gsl/gsl_blas.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_matrix.h>
#include <gsl/gsl_multifit_nlinear.h>

#include "analysis/calibration/cycle/cycle_covariance.h"
#include "analysis/calibration/cycle/cycle_hold.h"
#include "analysis/calibration/cycle/cycle_model.h"
#include "analysis/dataset/fit.h"
#include "analysis/dataset/least_squares.h"
#include "base/memory.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "cycle"

/* Plastic strain at which the hardening stress of Ludwik's law is a free number: amidst those of a
 * test, where it is known best. */
static const double middle_plastic_strain = 3e-3;
/* Largest exponents. */
static const double largest_exponent = 1.5;           /* isotropic */
static const double largest_kinematic_exponent = 1.0; /* beyond, work would come from nowhere */
/* A search begins with an exponent within this part of the largest. */
static const double largest_part = 0.95;
/* A logistic number beyond this is at its bound. */
static const double at_bound = 4.6; /* 1 % of the range */
/* Where the logistic share of mixed hardening starts from a law with a pure rule. Parts that
 * follow a test kinematically lie nearer to those with both rules than Ludwik's isotropic law. */
static const double kinematic_start = -3.0, isotropic_start = 1.5;
/* Weak prior of logistic numbers, so that one that the data do not know stays finite. */
static const double logistic_prior = 4.0;
/* Weak prior of ln(yield stress) beside that of the hardening stress: a step of the search that
 * takes the yield stress to nothing is none that it comes back from, as all slopes are zero there.
 */
static const double yield_prior = 4.0;
/* Steps of the differences that give the slopes, in units of the free numbers' scales. */
static const double difference = 1e-3;
/* Huber's limit and where a point counts as an outlier, in standard deviations of the residuals. */
static const double huber_limit = 2.5;
/* Largest correlation of neighbouring residuals that is believed, as their number is finite;
 * weights are settled where their scale changes by no more than this part. */
static const double largest_correlation = 0.9, settled_scale = 0.3, largest_scale_of_misses = 10.0,
                    first_scale_of_misses = 5.0;
enum {
    most_passes = 4,
    points_of_turn = 3 /* on either side of it: some 1.5 mm of deflection behind it */
};
/* It has arrived when the next step changes no number by more than this, or the sum of squares by
 * less than this part. */
static const double arrived = 2e-4;
static const double settled_sum = 1e-4;
/* A number that nothing tells stays finite by a prior of this weight, in units of the free numbers.
 */
static const double know_nothing = 1e-6;
/* A law is moved by this many standard errors, and no number by more than that: a part that is
 * nearly nothing grows by powers over a whole one, which the errors to first order mean nothing of.
 */
static const double moved_by = 0.01, farthest = 1.0;
/* Weak priors of Chaboche's law: of the stresses that it may harden by, about the yield stress, and
 * of the rates, about those over which a test goes. */
static const double stress_prior = 4.0, rate_prior = 2.0;
/* Where its search starts: rates times the test's largest strain, of one and of two back stresses.
 */
static const double one_rate = 4.0, fast_rate = 20.0, slow_rate = 2.0;
/* And the least share of either kind of hardening. */
static const double least_share = 0.1;
/* Weak priors of a Maxwell element: logarithms of its modulus about where it starts, and of its
 * time between those of the dwell and of the loading. */
static const double maxwell_modulus_prior = 4.0, maxwell_time_prior = 1.5;
/* Least fall of the tension, over the largest, that a search starts from; the times of two elements
 * start this many times below and above that of one. */
static const double least_fall = 1e-4, apart = 4.0;
/* Time of the element that stands for relaxation that was not recorded, over that of the loading.
 */
static const double unseen_time = 0.25;
/* What Maxwell elements may miss of a fall. */
static const double fall_share = 0.02;
/* Residual of a run that does not reach its end: far above any other. */
static const double lost_residual = 1e4;

struct candidate {
    const char *name;
    enum wb_law_form form;
    bool has_share; /* of isotropic hardening, free */
    double isotropic_share;
    bool is_combined;
    int n_backs;
};

static const struct candidate candidates[WB_CANDIDATES] = {
    [WB_CANDIDATE_LUDWIK_ISOTROPIC] = {"Ludwik, isotropic", WB_LAW_LUDWIK, false, 1.0},
    [WB_CANDIDATE_LUDWIK_KINEMATIC] = {"Ludwik, kinematic", WB_LAW_LUDWIK, false, 0.0},
    [WB_CANDIDATE_LUDWIK_MIXED] = {"Ludwik, mixed", WB_LAW_LUDWIK, true, 0.5},
    [WB_CANDIDATE_PARALLEL_KINEMATIC] = {"parallel parts, kinematic", WB_LAW_PARALLEL, false, 0.0},
    [WB_CANDIDATE_PARALLEL_MIXED] = {"parallel parts, mixed", WB_LAW_PARALLEL, true, 0.5},
    [WB_CANDIDATE_LUDWIK_COMBINED] = {"Ludwik, combined", WB_LAW_LUDWIK, true, 0.5, true, 0},
    [WB_CANDIDATE_CHABOCHE_ONE] = {.name = "Chaboche, one back stress",
                                   .form = WB_LAW_CHABOCHE,
                                   .is_combined = true,
                                   .n_backs = 1},
    [WB_CANDIDATE_CHABOCHE_TWO] = {.name = "Chaboche, two back stresses",
                                   .form = WB_LAW_CHABOCHE,
                                   .is_combined = true,
                                   .n_backs = 2},
};

/* Free numbers of Chaboche's law: logarithms of E, sigma_Y, Q and b, then of each back stress where
 * it saturates, C / gamma, and its gamma. */
enum {
    MODULUS,
    YIELD,
    SATURATION,
    RATE,
    FIRST_BACK
};

const char *wb_candidate_name(enum wb_candidate candidate)
{
    return candidates[candidate].name;
}

int wb_candidate_numbers(enum wb_candidate candidate)
{
    const struct candidate *const c = &candidates[candidate];
    const int numbers = c->form == WB_LAW_PARALLEL ? WB_FIT_PARTS : FIRST_BACK + 2 * c->n_backs;
    return numbers + c->has_share;
}

/* Free numbers of the specimen, behind those of the law. */
enum {
    BOW,
    LEVEL,
    UNEVEN, /* not free without places, unless the last is */
    ZERO,   /* of force: free where it may be wrong */
    OF_SPECIMEN
};

struct wb_cycle_search {
    const struct wb_cycle_data *data;
    struct wb_cycle_fit_settings settings;
    const struct candidate *candidate;
    struct wb_cycle_grid grid;
    struct wb_cycle_model *model;
    double poissons_ratio;
    int n_form;    /* free numbers of the law's form, */
    int n_maxwell; /* then two of each Maxwell element: logarithms of modulus and time */
    int n_law, n_free, n_residuals;
    struct wb_law_maxwell beside;   /* an element that is not free; modulus 0: none */
    double strain_rate;             /* 1/s, see struct wb_law */
    double maxwell_time;            /* s, prior of an element's */
    double start[WB_FIT_MOST_FREE]; /* the free numbers are counted from here, in units of scale */
    double scale[WB_FIT_MOST_FREE];
    double start_modulus[WB_FIT_PARTS];                     /* Pa */
    double *tension, *distance, *weight;                    /* weight: (n_points) */
    struct wb_cycle_neighbour neighbours[WB_FIT_MOST_FREE]; /* (n_free), for the slopes */
    double last_x[WB_FIT_MOST_FREE]; /* where the residuals were asked for last, */
    double *last;                    /* and they; (n_residuals) */
    bool has_last;
    gsl_matrix *slopes;                /* (n_residuals, n_free), */
    double slopes_x[WB_FIT_MOST_FREE]; /* there: in the end that of the fit */
    bool has_slopes, lacks_slopes;     /* they could not be found */
    double force_scale;                /* N */
    double scale_of_misses;            /* larger than 1 where the law does not follow */
    struct wb_cycle_run run;
    int runs;
    enum wb_status status;
};

/* Forces alone do not tell an unevenly bent wire from one with another law. */
static bool has_places(const struct wb_cycle_data *data)
{
    return data->n_places > 0;
}

static double logistic(double x)
{
    return 1.0 / (1.0 + exp(-x));
}

static double largest_exponent_of(const struct candidate *c)
{
    const bool is_overlay = !c->is_combined && (c->has_share || c->isotropic_share < 1.0);
    return is_overlay ? largest_kinematic_exponent : largest_exponent;
}

/* ln E, ln sigma_Y, ln(hardening stress at the middle), logistic exponent; or moduli over those of
 * the start, see wb_least_squares_positive(); and the logistic share of mixed hardening. */
static void relaxed_law_of(const struct wb_cycle_search *p, const double *free, struct wb_law *law)
{
    const struct candidate *const c = p->candidate;
    /* At its end a mixed law would be of another kind. */
    const double share =
        c->has_share ? fmin(logistic(free[p->n_form - 1]), 1.0 - 1e-9) : c->isotropic_share;

    if (c->form == WB_LAW_LUDWIK) {
        const double n = largest_exponent_of(c) * logistic(free[3]);
        const struct wb_material material = {
            .hardening = WB_HARDENING_ISOTROPIC_POWER,
            .youngs_modulus = exp(free[0]),
            .poissons_ratio = p->poissons_ratio,
            .yield_stress = exp(free[1]),
            .strength_coefficient = exp(free[2]) / pow(middle_plastic_strain, n),
            .hardening_exponent = n,
        };
        wb_law_init_ludwik(law, &material);
        law->isotropic_share = share;
        if (c->is_combined)
            wb_law_init_combined(law, &material, share);
        return;
    }
    if (c->form == WB_LAW_CHABOCHE) {
        const struct wb_material material = {.youngs_modulus = exp(free[MODULUS]),
                                             .poissons_ratio = p->poissons_ratio,
                                             .yield_stress = exp(free[YIELD])};
        struct wb_law_back backs[WB_LAW_MOST_BACKS];
        for (int i = 0; i < c->n_backs; i++) {
            const double *const back = free + FIRST_BACK + 2 * i;
            backs[i] = (struct wb_law_back){exp(back[0] + back[1]), exp(back[1])};
        }
        wb_law_init_chaboche(law, &material, exp(free[SATURATION]), exp(free[RATE]), backs,
                             c->n_backs);
        return;
    }
    struct wb_law_part parts[WB_FIT_PARTS];
    const double ratio = p->grid.last_strain / p->grid.first_strain;
    for (int i = 0; i < WB_FIT_PARTS; i++) {
        parts[i].modulus = p->start_modulus[i] * wb_least_squares_positive(free[i]);
        parts[i].yield_strain =
            i == WB_FIT_PARTS - 1
                ? (double)INFINITY
                : p->grid.first_strain * pow(ratio, (double)i / (WB_FIT_PARTS - 1));
    }
    wb_law_init_parallel(law, parts, WB_FIT_PARTS, share, p->poissons_ratio);
}

static void law_of(const struct wb_cycle_search *p, const double *free, struct wb_law *law)
{
    relaxed_law_of(p, free, law);
    law->n_maxwell = p->n_maxwell;
    for (int i = 0; i < p->n_maxwell; i++)
        law->maxwell[i] =
            (struct wb_law_maxwell){exp(free[p->n_form + 2 * i]), exp(free[p->n_form + 2 * i + 1])};
    if (p->n_maxwell == 2 && law->maxwell[0].time > law->maxwell[1].time) {
        const struct wb_law_maxwell slow = law->maxwell[0]; /* the fast one comes first */
        law->maxwell[0] = law->maxwell[1];
        law->maxwell[1] = slow;
    }
    if (p->beside.modulus > 0.0 && law->n_maxwell < WB_LAW_MOST_MAXWELL)
        law->maxwell[law->n_maxwell++] = p->beside;
    law->strain_rate = law->n_maxwell > 0 ? p->strain_rate : 0.0;
}

/* Of the outer fibre up to the clamp's curvature at the turn, 1/s. */
static double strain_rate_of(const struct wb_cycle_data *data, double curvature)
{
    const double t = wb_cycle_data_loading_time(data);
    return t > 0.0 ? 0.5 * data->info.outer_diameter * curvature / t : 0.0;
}

static double elastic_curvature(const struct wb_cycle_data *data)
{
    return 3.0 * data->top / (data->info.length * data->info.length);
}

/* From the elements of a law near by, or from the fall of the tension in the dwell. */
static void start_maxwell(struct wb_cycle_search *p, const struct wb_law *law)
{
    double *const start = p->start + p->n_form;
    for (int i = 0; i < p->n_maxwell && law->n_maxwell == p->n_maxwell; i++) {
        start[2 * i] = log(law->maxwell[i].modulus);
        start[2 * i + 1] = log(law->maxwell[i].time);
    }
    if (law->n_maxwell == p->n_maxwell)
        return;
    struct wb_cycle_relaxation seen;
    wb_cycle_hold_describe(p->data, &seen);
    const double strain = 0.5 * p->data->info.outer_diameter * elastic_curvature(p->data);
    const double secant = wb_law_virgin_stress(law, strain, NULL) / strain;
    const double loading = wb_cycle_data_loading_time(p->data), time = seen.time;
    const double share = fmax(seen.fall / p->data->max_force, least_fall);
    /* What is left of the stress at the turn, and what of that goes in the dwell. */
    const double left = time / loading * -expm1(-loading / time);
    const double gone = -expm1(-seen.duration / time);
    for (int i = 0; i < p->n_maxwell; i++) {
        start[2 * i] = log(share * secant / (left * gone * p->n_maxwell));
        start[2 * i + 1] = log(time * (p->n_maxwell == 1 ? 1.0 : i == 0 ? 1.0 / apart : apart));
    }
}

/* From another of its kind; the second of two back stresses comes of the first. */
static void start_from_chaboche(struct wb_cycle_search *p, const struct wb_law *law)
{
    const int n = p->candidate->n_backs;
    p->start[MODULUS] = log(law->material.youngs_modulus);
    p->start[YIELD] = log(law->material.yield_stress);
    p->start[SATURATION] = log(law->saturation);
    p->start[RATE] = log(law->rate);
    for (int i = 0; i < n; i++) {
        const struct wb_law_back *const back = &law->backs[i < law->n_backs ? i : 0];
        const double split = n > law->n_backs ? 2.0 : 1.0;
        const double rate = i == 0 ? back->recovery * split : back->recovery / split;
        p->start[FIRST_BACK + 2 * i] = log(back->modulus / back->recovery / split);
        p->start[FIRST_BACK + 2 * i + 1] = log(rate);
    }
}

/* From the virgin curve of another law, which hardens by as much at the test's largest strain and,
 * of two back stresses, at a tenth of it. */
static void start_from_curve(struct wb_cycle_search *p, const struct wb_law *law)
{
    const double E = law->material.youngs_modulus, top = p->grid.last_strain;
    const double stress = wb_law_virgin_stress(law, top, NULL);
    const double yield = fmin(
        law->form == WB_LAW_PARALLEL ? 0.1 * stress : law->material.yield_stress, 0.5 * stress);
    const double share = fmin(fmax(law->isotropic_share, least_share), 1.0 - least_share);
    const double hardening = stress - yield;
    p->start[MODULUS] = log(E);
    p->start[YIELD] = log(yield);
    p->start[SATURATION] = log(share * hardening);
    p->start[RATE] = log(one_rate / top);
    if (p->candidate->n_backs == 1) {
        p->start[FIRST_BACK] = log((1.0 - share) * hardening);
        p->start[FIRST_BACK + 1] = log(one_rate / top);
        return;
    }
    const double early = wb_law_virgin_stress(law, 0.1 * top, NULL) - yield;
    const double fast = fmin(fmax(early, 0.1 * hardening), 0.7 * hardening);
    p->start[FIRST_BACK] = log((1.0 - share) * fast);
    p->start[FIRST_BACK + 1] = log(fast_rate / top);
    p->start[FIRST_BACK + 2] = log((1.0 - share) * (hardening - fast));
    p->start[FIRST_BACK + 3] = log(slow_rate / top);
}

/* Free numbers of the law nearest to the given one. */
static void start_law(struct wb_cycle_search *p, const struct wb_law *law)
{
    const struct candidate *const c = p->candidate;

    if (c->form == WB_LAW_LUDWIK) {
        const struct wb_material *const m = &law->material;
        const double n = m->hardening_exponent;
        const double most = largest_exponent_of(c);
        const double part = fmin(fmax(n / most, 1.0 - largest_part), largest_part);
        p->start[0] = log(m->youngs_modulus);
        p->start[1] = log(m->yield_stress);
        p->start[2] = log(m->strength_coefficient * pow(middle_plastic_strain, n));
        p->start[3] = log(part / (1.0 - part));
    } else if (c->form == WB_LAW_CHABOCHE) {
        if (law->form == WB_LAW_CHABOCHE)
            start_from_chaboche(p, law);
        else
            start_from_curve(p, law);
    } else {
        /* Slopes of the given curve's chords between the yield strains. */
        const double ratio =
            pow(p->grid.last_strain / p->grid.first_strain, 1.0 / (WB_FIT_PARTS - 1));
        double strain = p->grid.first_strain, stress = wb_law_virgin_stress(law, strain, NULL);
        double slope = stress / strain;
        for (int i = 0; i < WB_FIT_PARTS; i++) {
            const double next_strain = strain * ratio;
            const double next_stress = wb_law_virgin_stress(law, next_strain, NULL);
            const double next = (next_stress - stress) / (next_strain - strain);
            const double modulus = i == WB_FIT_PARTS - 1 ? slope : slope - next;
            p->start_modulus[i] = fmax(modulus, 1e-2 * law->material.youngs_modulus);
            p->start[i] = 0.0;
            slope = next;
            strain = next_strain;
            stress = next_stress;
        }
    }
    /* From the side of the pure rule that was nearer. */
    if (c->has_share)
        p->start[p->n_form - 1] = law->isotropic_share == 1.0   ? isotropic_start
                                  : law->isotropic_share == 0.0 ? kinematic_start
                                                                : 0.0;
    start_maxwell(p, law);
    for (int i = 0; i < p->n_law; i++)
        p->scale[i] = 1.0;
}

static void start_specimen(struct wb_cycle_search *p, const struct wb_cycle_fit *near)
{
    const struct wb_test_info *const info = &p->data->info;
    double *const start = p->start + p->n_law, *const scale = p->scale + p->n_law;
    start[BOW] = near ? near->bow_angle : info->n_natural_shape > 0 ? info->natural_shape[0] : 0.0;
    scale[BOW] = 0.01;
    start[LEVEL] = near ? near->level : 0.0;
    scale[LEVEL] = 0.1 * WB_MM;
    start[UNEVEN] = near ? near->uneven_angle : 0.0;
    scale[UNEVEN] = 0.01;
    start[ZERO] = near ? near->zero : 0.0;
    scale[ZERO] = p->force_scale;
}

static void absolute(const struct wb_cycle_search *p, const double *x, double *free)
{
    for (int i = 0; i < p->n_law + OF_SPECIMEN; i++)
        free[i] = p->start[i] + (i < p->n_free ? p->scale[i] * x[i] : 0.0);
}

static struct wb_cycle_specimen specimen_of(const struct wb_cycle_search *p, const double *free)
{
    const double *const own = free + p->n_law;
    return (struct wb_cycle_specimen){
        .bow_angle = own[BOW], .level = own[LEVEL], .uneven_angle = own[UNEVEN]};
}

/* Distances of places less each marker's own offset; the offset that makes the sum of squares
 * smallest, its prior included, is known in closed form. Returns the index behind the residuals. */
static int place_residuals(const struct wb_cycle_search *p, const double *distance, double *r)
{
    const struct wb_cycle_data *const data = p->data;
    const double noise = p->settings.place_noise, prior = p->settings.offset_prior;
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

static int prior_residuals(const struct wb_cycle_search *p, const double *free,
                           const struct wb_law *law, double *r)
{
    const struct candidate *const c = p->candidate;
    int at = 0;

    r[at++] = free[p->n_law + LEVEL] / p->settings.level_prior;
    r[at++] = free[p->n_law + UNEVEN] / p->settings.uneven_prior;
    if (p->settings.zero_prior > 0.0)
        r[at++] = free[p->n_law + ZERO] / p->settings.zero_prior;
    if (c->form == WB_LAW_PARALLEL) {
        at += wb_least_squares_smooth_parts(law->parts, WB_FIT_PARTS, p->settings.modulus_prior,
                                            r + at);
    } else if (c->form == WB_LAW_CHABOCHE) {
        const double slow = log(p->grid.last_strain);
        r[at++] = (free[SATURATION] - free[YIELD]) / stress_prior;
        r[at++] = (free[RATE] + slow) / rate_prior;
        for (int i = FIRST_BACK; i < p->n_form; i += 2) {
            r[at++] = (free[i] - free[YIELD]) / stress_prior;
            r[at++] = (free[i + 1] + slow) / rate_prior;
        }
    } else {
        r[at++] = (free[1] - free[2]) / yield_prior;
        r[at++] = free[3] / logistic_prior;
    }
    if (c->has_share)
        r[at++] = free[p->n_form - 1] / logistic_prior;
    for (int i = p->n_form; i < p->n_law; i += 2) {
        r[at++] = (free[i] - p->start[i]) / maxwell_modulus_prior;
        r[at++] = (free[i + 1] - log(p->maxwell_time)) / maxwell_time_prior;
    }
    return at;
}

/* Periods of the dwell that count: without Maxwell elements they tell nothing. */
static int held_of(const struct wb_cycle_search *p)
{
    return p->n_maxwell > 0 ? p->data->n_held : 0;
}

/* How the tension falls in the dwell: beyond the mean, which the law may miss. Returns the index
 * behind the residuals. */
static int held_residuals(const struct wb_cycle_search *p, const double *held, double *r)
{
    const struct wb_cycle_data *const data = p->data;
    const int n = held_of(p);
    double mean = 0.0;
    if (n == 0)
        return 0;
    for (int i = 0; i < n; i++)
        mean += (held[i] - data->held[i].tension) / n;
    const double fall = fabs(data->held[0].tension - data->held[n - 1].tension);
    const double noise = fmax(p->settings.force_noise, fall_share * fall);
    for (int i = 0; i < n; i++)
        r[i] = (held[i] - data->held[i].tension - mean) / noise;
    return n;
}

/* Law and specimen of the free numbers x. False where the law is not possible. */
static bool take_numbers(const struct wb_cycle_search *p, const double *x, double *free,
                         struct wb_law *law, struct wb_cycle_specimen *specimen)
{
    struct wb_reason why;
    absolute(p, x, free);
    law_of(p, free, law);
    *specimen = specimen_of(p, free);
    return wb_law_check(law, &why) == WB_OK;
}

/* Residuals of a computed cycle. */
static int compare(const struct wb_cycle_search *p, const double *free, const struct wb_law *law,
                   const double *tension, const double *distance, const double *held, double *r)
{
    const struct wb_cycle_data *const data = p->data;
    for (int i = 0; i < data->n_points; i++)
        r[i] = sqrt(p->weight[i]) * (tension[i] + free[p->n_law + ZERO] - data->points[i].tension) /
               p->force_scale;
    int at = data->n_points;
    at += place_residuals(p, distance, r + at);
    at += held_residuals(p, held, r + at);
    at += prior_residuals(p, free, law, r + at);
    return at == p->n_residuals ? GSL_SUCCESS : GSL_ESANITY;
}

/* Residuals at the free numbers x. */
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
    return memcmp(x, there->data, (size_t)p->n_free * sizeof *x) == 0;
}

static int gsl_residuals(const gsl_vector *x, void *context, gsl_vector *f)
{
    struct wb_cycle_search *const p = context;
    if (p->has_last && is_at(p, p->last_x, x)) {
        memcpy(f->data, p->last, bytes_of(p));
        return GSL_SUCCESS;
    }
    const int status = residuals(p, x->data, f->data);
    memcpy(p->last_x, x->data, (size_t)p->n_free * sizeof *p->last_x);
    memcpy(p->last, f->data, bytes_of(p));
    p->has_last = status == GSL_SUCCESS;
    return status;
}

/* Differences from the residuals at x, of cycles computed beside that of x. */
static int find_slopes(struct wb_cycle_search *p, const double *x)
{
    double numbers[WB_FIT_MOST_FREE], moved[WB_FIT_MOST_FREE][WB_FIT_MOST_FREE];
    struct wb_law law;
    struct wb_cycle_specimen specimen;
    double *const there = wb_memory_new((size_t)p->n_residuals, sizeof *there);
    int status = take_numbers(p, x, numbers, &law, &specimen) ? GSL_SUCCESS : GSL_EFAILED;
    for (int k = 0; k < p->n_free && status == GSL_SUCCESS; k++) {
        struct wb_cycle_neighbour *const neighbour = &p->neighbours[k];
        double step[WB_FIT_MOST_FREE];
        memcpy(step, x, (size_t)p->n_free * sizeof *step);
        step[k] += difference;
        if (!take_numbers(p, step, moved[k], &neighbour->law, &neighbour->specimen))
            status = GSL_EFAILED;
    }
    if (status == GSL_SUCCESS) {
        p->status = wb_cycle_model_run_beside(p->model, &law, &specimen, p->tension, p->distance,
                                              p->n_free, p->neighbours, &p->run);
        p->runs++;
        if (p->status != WB_OK || !p->run.reached)
            status = GSL_EFAILED;
    }
    for (int k = 0; k < p->n_free && status == GSL_SUCCESS; k++) {
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
        memcpy(p->slopes_x, x->data, (size_t)p->n_free * sizeof *p->slopes_x);
    }
    gsl_matrix_memcpy(J, p->slopes);
    return GSL_SUCCESS;
}

/* What is known of a point's residual is that of another weight. */
static void weigh_again(struct wb_cycle_search *p, int i, double ratio)
{
    gsl_vector_view slopes = gsl_matrix_row(p->slopes, (size_t)i);
    gsl_vector_scale(&slopes.vector, ratio);
    p->last[i] *= ratio;
}

/* Standard deviation of residuals of which each counts as one, in units of the force's: neighbours
 * miss alike where the law cannot follow, with a correlation r of one and the next, and the sum of
 * n of them varies by (1 + r) / (1 - r) times n variances. `counts` are Huber's weights. */
static double find_discrepancy(const struct wb_cycle_search *p, const double *miss,
                               const double *counts)
{
    double squares = 0.0, products = 0.0, sum = 0.0;
    for (int i = 0; i < p->data->n_points; i++) {
        squares += counts[i] * miss[i] * miss[i];
        sum += counts[i];
        if (i > 0 && i != p->data->n_loading)
            products += sqrt(counts[i] * counts[i - 1]) * miss[i] * miss[i - 1];
    }
    const double r = squares > 0.0 ? fmin(fmax(products / squares, 0.0), largest_correlation) : 0.0;
    return sqrt(squares / sum * (1.0 + r) / (1.0 - r));
}

/* Weights of the points for the next pass, by what this one left: Huber's, and smaller ones where
 * the law does not follow, so that priors keep their weight. Returns whether they changed. */
static bool set_weights(struct wb_cycle_search *p, const gsl_vector *f, int *n_outliers)
{
    const int n = p->data->n_points, outliers_before = *n_outliers;
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

/* Iterates to the end; false when the iterations ran out. */
static bool iterate(struct wb_cycle_search *p, gsl_multifit_nlinear_workspace *w, int *iterations)
{
    const struct wb_least_squares_search search = {
        .max_iterations = p->settings.max_iterations,
        .smallest_step = arrived,
        .smallest_gain = settled_sum,
        .status = &p->status,
    };
    return wb_least_squares_iterate(w, &search, iterations) && !p->lacks_slopes;
}

/* The law moved along the columns of the covariance's triangular factor, which the covariance is
 * destroyed for. */
static void move_law(const struct wb_cycle_search *p, const gsl_vector *x, gsl_matrix *covariance,
                     struct wb_cycle_fit *fit)
{
    double free[WB_FIT_MOST_FREE], step[WB_FIT_MOST_FREE];
    struct wb_reason why;
    fit->n_moved = 0;
    if (gsl_linalg_cholesky_decomp1(covariance) != GSL_SUCCESS)
        return;
    for (int k = 0; k < p->n_law; k++) {
        const gsl_vector_view side = gsl_matrix_column(covariance, (size_t)k);
        double largest = 0.0;
        for (int i = k; i < p->n_free; i++)
            largest = fmax(largest, fabs(gsl_vector_get(&side.vector, (size_t)i)));
        const double by = fmin(moved_by, farthest / largest);
        for (int i = 0; i < p->n_free; i++)
            step[i] = gsl_vector_get(x, (size_t)i) +
                      (i < k ? 0.0 : by * gsl_vector_get(&side.vector, (size_t)i));
        absolute(p, step, free);
        law_of(p, free, &fit->moved[k]);
        fit->moved_by[k] = by;
        if (wb_law_check(&fit->moved[k], &why) != WB_OK)
            return;
    }
    fit->n_moved = p->n_law;
}

/* Correlations of the law's numbers. Ludwik's are turned into those of K and n, which fits do not
 * count in; a part's own scale does not matter. */
static void find_correlations(const struct wb_cycle_search *p, const gsl_matrix *covariance,
                              struct wb_cycle_fit *fit)
{
    double turn[WB_FIT_MOST_LAW][WB_FIT_MOST_LAW] = {{0.0}}, c[WB_FIT_MOST_LAW][WB_FIT_MOST_LAW];
    const int n = p->n_law;
    for (int i = 0; i < n; i++)
        turn[i][i] = 1.0;
    if (p->candidate->form == WB_LAW_LUDWIK) {
        const double exponent = fit->law.material.hardening_exponent;
        turn[3][3] = exponent * (1.0 - exponent / largest_exponent_of(p->candidate));
        turn[2][3] = -turn[3][3] * log(middle_plastic_strain);
    }
    /* C of where it saturates and gamma. */
    for (int i = FIRST_BACK; p->candidate->form == WB_LAW_CHABOCHE && i < p->n_form; i += 2)
        turn[i][i + 1] = 1.0;
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            c[i][j] = 0.0;
            for (int k = 0; k < n; k++) {
                for (int l = 0; l < n; l++)
                    c[i][j] +=
                        turn[i][k] * turn[j][l] * gsl_matrix_get(covariance, (size_t)k, (size_t)l);
            }
        }
    }
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++)
            fit->correlation[i][j] = c[i][j] / sqrt(c[i][i] * c[j][j]);
    }
    fit->n_numbers = n;
}

const char *wb_cycle_fit_number(const struct wb_cycle_fit *fit, int i, char text[24])
{
    static const char *const ludwik[] = {"E", "sigma_Y", "K", "n"};
    static const char *const chaboche[] = {"E",      "sigma_Y", "Q",      "b",  "C1",
                                           "gamma1", "C2",      "gamma2", "C3", "gamma3"};
    static const char *const elements[] = {"Maxwell modulus 1", "Maxwell time 1",
                                           "Maxwell modulus 2", "Maxwell time 2"};
    const bool is_ludwik = fit->law.form == WB_LAW_LUDWIK;
    const int maxwell = i - (fit->n_numbers - 2 * fit->law.n_maxwell);
    if (maxwell >= 0)
        snprintf(text, 24, "%s", elements[maxwell]);
    else if (fit->law.form == WB_LAW_CHABOCHE)
        snprintf(text, 24, "%s", chaboche[i]);
    else if (i >= (is_ludwik ? 4 : fit->law.n_parts))
        snprintf(text, 24, "isotropic share");
    else if (is_ludwik)
        snprintf(text, 24, "%s", ludwik[i]);
    else
        snprintf(text, 24, "part %d", i + 1);
    return text;
}

bool wb_cycle_fit_strongest(const struct wb_cycle_fit *fit, int *one, int *other)
{
    double strongest = -1.0;
    for (int i = 0; i < fit->n_numbers; i++) {
        for (int j = 0; j < i; j++) {
            if (fabs(fit->correlation[i][j]) > strongest) {
                strongest = fabs(fit->correlation[i][j]);
                *one = j;
                *other = i;
            }
        }
    }
    return strongest >= 0.0;
}

/* Standard errors from the curvature of the sum of squares, scaled by what is left of it. */
static void find_errors(const struct wb_cycle_search *p, gsl_multifit_nlinear_workspace *w,
                        struct wb_cycle_fit *fit)
{
    gsl_matrix *const covariance =
        wb_memory_need(gsl_matrix_alloc((size_t)p->n_free, (size_t)p->n_free));
    double sum;
    fit->ln_strength_error = fit->exponent_error = fit->bow_angle_error = (double)NAN;
    gsl_blas_ddot(w->f, w->f, &sum);
    if (gsl_multifit_nlinear_covar(w->J, 0.0, covariance) == GSL_SUCCESS) {
        const double variance = sum / fmax(1.0, p->n_residuals - p->n_free);
        const size_t bow = (size_t)p->n_law;
        fit->bow_angle_error =
            p->scale[bow] * sqrt(variance * gsl_matrix_get(covariance, bow, bow));
        if (p->candidate->form == WB_LAW_LUDWIK) {
            /* ln K = ln h - n ln(middle), n by its logistic number. */
            const double n = fit->law.material.hardening_exponent;
            const double slope = n * (1.0 - n / largest_exponent_of(p->candidate));
            const double a = 1.0, b = -slope * log(middle_plastic_strain);
            const double hh = gsl_matrix_get(covariance, 2, 2);
            const double hn = gsl_matrix_get(covariance, 2, 3);
            const double nn = gsl_matrix_get(covariance, 3, 3);
            fit->exponent_error = slope * sqrt(variance * nn);
            fit->ln_strength_error =
                sqrt(variance * fmax(0.0, a * a * hh + 2.0 * a * b * hn + b * b * nn));
        }
        find_correlations(p, covariance, fit);
    }
    if (wb_cycle_covariance_find(p->data, held_of(p) > 0, w->f, w->J, covariance))
        move_law(p, w->x, covariance, fit);
    gsl_matrix_free(covariance);
}

/* What runs of the beam need, and those of neighbours beside it. */
static void take_buffers(struct wb_cycle_search *p, int n_neighbours)
{
    p->tension = wb_memory_new((size_t)p->data->n_points, sizeof *p->tension);
    p->distance = wb_memory_new((size_t)p->data->n_places, sizeof *p->distance);
    p->last = wb_memory_new((size_t)p->n_residuals, sizeof *p->last);
    for (int k = 0; k < n_neighbours; k++) {
        struct wb_cycle_neighbour *const neighbour = &p->neighbours[k];
        neighbour->tension = wb_memory_new((size_t)p->data->n_points, sizeof(double));
        neighbour->distance = wb_memory_new((size_t)p->data->n_places, sizeof(double));
    }
}

static void free_buffers(struct wb_cycle_search *p)
{
    wb_cycle_model_destroy(p->model);
    p->model = NULL;
    free(p->tension);
    free(p->distance);
    free(p->last);
    p->tension = p->distance = p->last = NULL;
    p->has_last = false;
    for (int k = 0; k < p->n_free; k++) {
        free(p->neighbours[k].tension);
        free(p->neighbours[k].distance);
        p->neighbours[k].tension = p->neighbours[k].distance = NULL;
    }
}

/* A Maxwell element that carries a part of the outer fibre's stress at the turn. */
static struct wb_law_maxwell unseen_element(const struct wb_cycle_search *p,
                                            const struct wb_law *law, double part)
{
    const double loading = wb_cycle_data_loading_time(p->data), x = 1.0 / unseen_time;
    const double strain = 0.5 * p->data->info.outer_diameter * p->run.clamp_curvature;
    const double secant = wb_law_virgin_stress(law, strain, NULL) / strain;
    return (struct wb_law_maxwell){part * secant * x / -expm1(-x), unseen_time * loading};
}

/* Cholesky's factor of J'J; NULL: it has none. */
static gsl_matrix *factor_squares(const gsl_matrix *J)
{
    gsl_matrix *const squares = wb_memory_need(gsl_matrix_alloc(J->size2, J->size2));
    gsl_matrix_set_identity(squares);
    gsl_blas_dsyrk(CblasLower, CblasTrans, 1.0, J, know_nothing, squares);
    if (gsl_linalg_cholesky_decomp1(squares) == GSL_SUCCESS)
        return squares;
    gsl_matrix_free(squares);
    return NULL;
}

/* Gauss and Newton's step from the end of the search, with the residuals of altered data. `squares`
 * are the sums of the slopes' products as Cholesky factors them, `r` the residuals of the data. */
static void find_altered(struct wb_cycle_search *p, const gsl_matrix *squares, const double *r,
                         enum wb_cycle_shared shared, struct wb_cycle_fit *fit)
{
    const struct wb_cycle_model_settings how = {p->settings.n_elements, p->settings.n_fibres, 0};
    struct wb_cycle_data altered;
    struct wb_cycle_search q = *p;
    double free_numbers[WB_FIT_MOST_FREE], numbers[WB_FIT_MOST_FREE];
    struct wb_reason why;
    if (shared == WB_SHARED_RELAXATION)
        q.beside = unseen_element(p, &fit->law, wb_cycle_shared_change(shared));
    if (!wb_cycle_shared_alter(&altered, p->data, shared, wb_cycle_shared_change(shared)))
        return;
    gsl_vector *const change = wb_memory_need(gsl_vector_alloc((size_t)p->n_residuals));
    gsl_vector_view step = gsl_vector_view_array(numbers, (size_t)p->n_free);
    q.data = &altered;
    bool good = wb_cycle_model_create(&q.model, &altered, &fit->law, &how) == WB_OK &&
                residuals(&q, p->slopes_x, change->data) == GSL_SUCCESS && q.run.reached;
    for (int i = 0; i < p->n_residuals && good; i++)
        change->data[i] = r[i] - change->data[i];
    good = good &&
           gsl_blas_dgemv(CblasTrans, 1.0, p->slopes, change, 0.0, &step.vector) == GSL_SUCCESS &&
           gsl_linalg_cholesky_svx(squares, &step.vector) == GSL_SUCCESS;
    if (good) {
        for (int i = 0; i < p->n_free; i++)
            numbers[i] += p->slopes_x[i];
        absolute(&q, numbers, free_numbers);
        law_of(&q, free_numbers, &fit->altered[shared]);
        fit->altered_specimen[shared] = specimen_of(&q, free_numbers);
        fit->has_altered[shared] = wb_law_check(&fit->altered[shared], &why) == WB_OK;
    }
    wb_cycle_model_destroy(q.model);
    gsl_vector_free(change);
    wb_cycle_data_release(&altered);
}

void wb_cycle_fit_find_altered(struct wb_cycle_fit *fit)
{
    struct wb_cycle_search *const p = fit->search;
    const struct wb_cycle_model_settings how = {p->settings.n_elements, p->settings.n_fibres, 0};
    double *const r = wb_memory_new((size_t)p->n_residuals, sizeof *r);
    gsl_matrix *const squares = factor_squares(p->slopes);
    take_buffers(p, 0);
    if (squares && wb_cycle_model_create(&p->model, p->data, &fit->law, &how) == WB_OK &&
        residuals(p, p->slopes_x, r) == GSL_SUCCESS && p->run.reached) {
        for (int i = 0; i < WB_SHARED; i++)
            find_altered(p, squares, r, i, fit);
    }
    free_buffers(p);
    gsl_matrix_free(squares);
    free(r);
}

/* From the mean residual of the last points of the loading to that of the first of the way back. */
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
    const struct wb_cycle_data *const data = p->data;
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
    fit->place_rms =
        data->n_places > 0 ? p->settings.place_noise * sqrt(sum / data->n_places) : (double)NAN;
    free(r);
}

static int count_residuals(const struct wb_cycle_search *p)
{
    const struct candidate *const c = p->candidate;
    const int priors = c->form == WB_LAW_PARALLEL   ? WB_FIT_PARTS - 3
                       : c->form == WB_LAW_CHABOCHE ? 2 + 2 * c->n_backs
                                                    : 2;
    return p->data->n_points + p->data->n_places + p->data->n_markers + held_of(p) + 2 + priors +
           c->has_share + 2 * p->n_maxwell + (p->settings.zero_prior > 0.0);
}

/* The last run, with more elements. */
static enum wb_status run_finely(struct wb_cycle_fit *fit, struct wb_cycle_search *p,
                                 struct wb_reason *why)
{
    const struct wb_cycle_model_settings how = {p->settings.n_final_elements, p->settings.n_fibres,
                                                0};
    const struct wb_cycle_specimen specimen = {fit->bow_angle, fit->level, fit->uneven_angle};
    struct wb_cycle_model *fine;
    WB_TRY(wb_cycle_model_create(&fine, p->data, &fit->law, &how));
    const enum wb_status status =
        wb_cycle_model_run(fine, &fit->law, &specimen, fit->tension, p->distance, &p->run);
    wb_cycle_model_destroy(fine);
    p->runs++;
    if (status == WB_OK && !p->run.reached)
        return wb_fail_to(why, WB_ERR_CONVERGENCE,
                          "wire '%s', sample %d: %s: the beam of %d elements does not come to the "
                          "end of the cycle",
                          p->data->info.wire, p->data->info.sample, p->candidate->name,
                          p->settings.n_final_elements);
    return status;
}

/* Whether the fit is one of a law that the candidate is with a share at its end. */
static bool contains(const struct candidate *c, const struct wb_cycle_fit *near)
{
    const struct candidate *const other = &candidates[near->candidate];
    if (!c->has_share || c->form != other->form || other->has_share || !near->is_converged)
        return false;
    /* Nearer to the ends of its range an exponent is not where a search begins. */
    if (c->form == WB_LAW_LUDWIK &&
        near->law.material.hardening_exponent > largest_part * largest_exponent_of(c))
        return false;
    return !c->is_combined || other->isotropic_share == 1.0;
}

/* Where the search's weights begin. Beside a law that follows one of another hardening rule will
 * not, and nothing is asked of how it fails. */
static double first_scale(const struct candidate *c, const struct wb_cycle_fit *near)
{
    if (!near || c->form == WB_LAW_CHABOCHE)
        return first_scale_of_misses;
    const struct candidate *const other = &candidates[near->candidate];
    const bool is_alike =
        c->isotropic_share == other->isotropic_share && c->is_combined == other->is_combined;
    if (is_alike || contains(c, near))
        return near->scale_of_misses;
    return near->scale_of_misses < first_scale_of_misses ? largest_scale_of_misses
                                                         : first_scale_of_misses;
}

/* Whether the isotropic share, from the optimum of the law without it, would not leave its end:
 * Gauss and Newton's step, with all numbers free, goes there. */
static bool is_best_at_end(const struct wb_cycle_search *p, const gsl_multifit_nlinear_workspace *w,
                           const struct wb_law *law)
{
    const size_t at = (size_t)p->n_form - 1;
    const double share = logistic(p->start[at]);
    gsl_matrix *const squares = factor_squares(w->J);
    gsl_vector *const step = wb_memory_need(gsl_vector_alloc((size_t)p->n_free));
    bool is_best = squares &&
                   gsl_blas_dgemv(CblasTrans, -1.0, w->J, w->f, 0.0, step) == GSL_SUCCESS &&
                   gsl_linalg_cholesky_svx(squares, step) == GSL_SUCCESS;
    if (is_best) {
        const double to = share + share * (1.0 - share) * gsl_vector_get(step, at);
        is_best = law->isotropic_share == 0.0 ? to < logistic(-at_bound) : to > logistic(at_bound);
    }
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
        .p = (size_t)p->n_free,
        .params = p,
    };
    double at[WB_FIT_MOST_FREE] = {0.0};
    double free_numbers[WB_FIT_MOST_FREE];
    gsl_vector_view x = gsl_vector_view_array(at, (size_t)p->n_free);
    const int started = gsl_multifit_nlinear_init(&x.vector, &fdf, w);
    if (p->status != WB_OK)
        return p->status;
    if (started != GSL_SUCCESS || !p->run.reached)
        return wb_fail_to(why, WB_ERR_CONVERGENCE,
                          "wire '%s', sample %d: %s: the beam does not come to the end of the "
                          "cycle from the first guess",
                          p->data->info.wire, p->data->info.sample, p->candidate->name);
    fit->is_contained = near && contains(p->candidate, near) && is_best_at_end(p, w, &near->law);
    for (int pass = 0; pass < most_passes && !fit->is_contained; pass++) {
        fit->is_converged = iterate(p, w, &fit->iterations);
        if (p->status != WB_OK)
            return p->status;
        if (!set_weights(p, w->f, &fit->n_outliers) || !fit->is_converged)
            break;
        memcpy(at, w->x->data, (size_t)p->n_free * sizeof *at);
        if (gsl_multifit_nlinear_init(&x.vector, &fdf, w) != GSL_SUCCESS)
            break;
    }
    if (fit->is_contained)
        return WB_OK;
    absolute(p, w->x->data, free_numbers);
    p->strain_rate = strain_rate_of(p->data, p->run.clamp_curvature);
    law_of(p, free_numbers, &fit->law);
    const struct wb_cycle_specimen specimen = specimen_of(p, free_numbers);
    fit->bow_angle = specimen.bow_angle;
    fit->level = specimen.level;
    fit->uneven_angle = specimen.uneven_angle;
    fit->zero = free_numbers[p->n_law + ZERO];
    fit->is_at_bound = (p->candidate->form == WB_LAW_LUDWIK && fabs(free_numbers[3]) > at_bound) ||
                       (p->candidate->has_share && fabs(free_numbers[p->n_form - 1]) > at_bound);
    find_errors(p, w, fit);
    WB_TRY(run_finely(fit, p, why));
    for (int i = 0; i < p->data->n_points; i++)
        fit->tension[i] += fit->zero;
    fit->clamp_curvature = p->run.clamp_curvature;
    if (fit->law.n_maxwell > 0)
        fit->law.strain_rate = strain_rate_of(p->data, fit->clamp_curvature);
    fit->first_curvature = p->run.first_curvature;
    fit->turn_change = p->run.turn_change;
    find_misfits(fit, p);
    return WB_OK;
}

static void release_search(struct wb_cycle_search *p)
{
    if (!p)
        return;
    free(p->weight);
    gsl_matrix_free(p->slopes);
    free(p);
}

enum wb_status wb_cycle_fit_run(struct wb_cycle_fit *fit, const struct wb_cycle_data *data,
                                enum wb_candidate candidate, const struct wb_law *start,
                                const struct wb_cycle_fit *near, const struct wb_cycle_grid *grid,
                                const struct wb_cycle_fit_settings *settings, struct wb_reason *why)
{
    const clock_t begin = clock();
    const struct candidate *const c = &candidates[candidate];
    struct wb_cycle_search *const p = wb_memory_new(1, sizeof *p);
    *p = (struct wb_cycle_search){
        .data = data,
        .settings = *settings,
        .candidate = c,
        .grid = grid ? *grid : (struct wb_cycle_grid){0.0, 0.0},
        .poissons_ratio = start->material.poissons_ratio,
        .n_form = wb_candidate_numbers(candidate),
        .n_maxwell = settings->n_maxwell,
        .strain_rate = strain_rate_of(data, elastic_curvature(data)),
        .scale_of_misses = first_scale(c, near),
    };
    p->n_law = p->n_form + 2 * p->n_maxwell;
    p->maxwell_time = sqrt((data->departure - data->arrival) * wb_cycle_data_loading_time(data));
    p->n_free = p->n_law + (settings->zero_prior > 0.0 ? OF_SPECIMEN : UNEVEN + has_places(data));
    p->n_residuals = count_residuals(p);
    p->force_scale = fmax(settings->force_noise, settings->force_share * data->max_force);
    *fit = (struct wb_cycle_fit){
        .candidate = candidate, .n_free = p->n_free, .n_law = p->n_law, .search = p};
    start_law(p, start);
    start_specimen(p, near);

    const double no_step[WB_FIT_MOST_FREE] = {0.0};
    double free_numbers[WB_FIT_MOST_FREE];
    struct wb_law law;
    absolute(p, no_step, free_numbers);
    law_of(p, free_numbers, &law);

    const struct wb_cycle_model_settings how = {settings->n_elements, settings->n_fibres,
                                                p->n_free};
    const size_t points = (size_t)data->n_points;
    take_buffers(p, p->n_free);
    p->weight = wb_memory_new(points, sizeof *p->weight);
    for (size_t i = 0; i < points; i++)
        p->weight[i] = 1.0 / (p->scale_of_misses * p->scale_of_misses);
    p->slopes = wb_memory_need(gsl_matrix_calloc((size_t)p->n_residuals, (size_t)p->n_free));
    fit->tension = wb_memory_new(points, sizeof *fit->tension);
    gsl_multifit_nlinear_workspace *const w = wb_least_squares_create(p->n_residuals, p->n_free);
    enum wb_status status = wb_cycle_model_create(&p->model, data, &law, &how);
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
    free(fit->tension);
    release_search(fit->search);
    fit->tension = NULL;
    fit->search = NULL;
}
