#include "analysis/calibration/cycle/cycle_parameters.h"

#include <math.h>
#include <stdio.h>

#include "analysis/calibration/cycle/cycle_hold.h"
#include "analysis/calibration/law/bending.h"
#include "analysis/dataset/least_squares.h"
#include "base/units.h"

/* Largest exponents. */
static const double largest_exponent = 1.5;           /* isotropic */
static const double largest_kinematic_exponent = 1.0; /* a larger exponent would generate work */
/* Largest initial exponent, over the largest exponent. */
static const double largest_part = 0.95;
/* A logistic parameter beyond this is at its bound. */
static const double at_bound = 4.6; /* 1 % of the range */
/* Initial logistic share of mixed hardening, from a kinematic and from an isotropic law. Parts that
 * fit a kinematic test are closer to a mixed law than Ludwik's isotropic law is. */
static const double kinematic_start = -3.0, isotropic_start = 1.5;
/* Weak prior of logistic parameters, which keeps one finite that the data do not determine. */
static const double logistic_prior = 4.0;
/* Weak prior of ln(yield stress) relative to that of the hardening stress: the search could not
 * return from a yield stress near zero, where all derivatives vanish. */
static const double yield_prior = 4.0;
/* Weak priors of Chaboche's law: of the hardening stresses relative to the yield stress, and of the
 * rates relative to those of the test's strains. */
static const double stress_prior = 4.0, rate_prior = 2.0;
/* Initial rates times the test's largest strain, of one and of two backstresses.
 */
static const double one_rate = 4.0, fast_rate = 20.0, slow_rate = 2.0;
/* Initial least share of either kind of hardening. */
static const double least_share = 0.1;
/* Weak priors of a Maxwell element: of ln(modulus) about its initial value, and of ln(time) between
 * those of the dwell and of the loading. */
static const double maxwell_modulus_prior = 4.0, maxwell_time_prior = 1.5;
/* Least initial fall of the tension, over the largest; and the factor of the initial times of two
 * elements, below and above that of one. */
static const double least_fall = 1e-4, apart = 4.0;

static const struct wb_cycle_parameters_candidate candidates[WB_CANDIDATES] = {
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
    [WB_CANDIDATE_PARALLEL_COMBINED] = {"parallel parts, combined", WB_LAW_PARALLEL, true, 0.5,
                                        true, 0},
};

/* Free parameters of Chaboche's law: logarithms of E, sigma_Y, Q and b, then for each backstress of
 * its saturation value, C / gamma, and of gamma. */
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
    const struct wb_cycle_parameters_candidate *const c = &candidates[candidate];
    const int numbers = c->form == WB_LAW_PARALLEL ? WB_FIT_PARTS : FIRST_BACK + 2 * c->n_backs;
    return numbers + c->has_share;
}

const struct wb_cycle_parameters_candidate *
wb_cycle_parameters_candidate(enum wb_candidate candidate)
{
    return &candidates[candidate];
}

static double logistic(double x)
{
    return 1.0 / (1.0 + exp(-x));
}

static double largest_exponent_of(const struct wb_cycle_parameters_candidate *c)
{
    const bool is_overlay = !c->is_combined && (c->has_share || c->isotropic_share < 1.0);
    return is_overlay ? largest_kinematic_exponent : largest_exponent;
}

/* Turns parts with kinematic hardening into parts whose limits grow, with the same virgin curve:
 * the share of the elastic part's modulus becomes hardening of the others. So the share affects
 * unloading only. Returns the isotropic share of the law. */
static double harden_parts(struct wb_law_part *parts, double share)
{
    double sum = 0.0;
    for (int i = 0; i < WB_FIT_PARTS - 1; i++)
        sum += parts[i].modulus;
    const double growth = share * parts[WB_FIT_PARTS - 1].modulus / sum;
    for (int i = 0; i < WB_FIT_PARTS - 1; i++)
        parts[i].modulus *= 1.0 + growth;
    parts[WB_FIT_PARTS - 1].modulus *= 1.0 - share;
    return growth / (1.0 + growth);
}

/* Ludwik's law: ln E, ln sigma_Y, ln(hardening stress at WB_BENDING_PLASTIC_STRAIN), logistic
 * exponent. Parallel parts: moduli over the initial ones, see wb_least_squares_positive(). Then the
 * logistic share of mixed hardening. */
static void relaxed_law_of(const struct wb_cycle_parameters *p, const double *free,
                           struct wb_law *law)
{
    const struct wb_cycle_parameters_candidate *const c = p->candidate;
    /* At the end of the range, a mixed law would be another candidate. */
    const double share =
        c->has_share ? fmin(logistic(free[p->n_form - 1]), 1.0 - 1e-9) : c->isotropic_share;

    if (c->form == WB_LAW_LUDWIK) {
        const double n = largest_exponent_of(c) * logistic(free[3]);
        const struct wb_material material =
            wb_bending_material(exp(free[0]), p->poissons_ratio, exp(free[1]), exp(free[2]), n);
        wb_law_init_ludwik(law, &material);
        law->isotropic_share = share;
        law->is_combined = c->is_combined;
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
    const double kept = c->is_combined ? harden_parts(parts, share) : share;
    wb_law_init_parallel(law, parts, WB_FIT_PARTS, kept, p->poissons_ratio);
    law->is_combined = c->is_combined;
}

void wb_cycle_parameters_law(const struct wb_cycle_parameters *p, const double *free,
                             struct wb_law *law)
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

/* Strain rate of the outer fibre up to the clamp's curvature at the turn, 1/s. */
double wb_cycle_parameters_strain_rate(const struct wb_cycle_data *data, double curvature)
{
    const double t = wb_cycle_data_loading_time(data);
    return t > 0.0 ? 0.5 * data->info.outer_diameter * curvature / t : 0.0;
}

static double elastic_curvature(const struct wb_cycle_data *data)
{
    return 3.0 * data->top / (data->info.length * data->info.length);
}

/* Initial guess of Maxwell elements: from those of the given law, or from the fall of the tension
 * in the dwell. */
static void start_maxwell(struct wb_cycle_parameters *p, const struct wb_law *law)
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
    /* Part of the stress that is left at the turn, and part of this that relaxes in the dwell. */
    const double left = time / loading * -expm1(-loading / time);
    const double gone = -expm1(-seen.duration / time);
    for (int i = 0; i < p->n_maxwell; i++) {
        start[2 * i] = log(share * secant / (left * gone * p->n_maxwell));
        start[2 * i + 1] = log(time * (p->n_maxwell == 1 ? 1.0 : i == 0 ? 1.0 / apart : apart));
    }
}

/* Initial guess from another Chaboche law; the second of two backstresses is derived from the
 * first. */
static void start_from_chaboche(struct wb_cycle_parameters *p, const struct wb_law *law)
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

/* Initial guess from the virgin curve of another law: the same hardening at the test's largest
 * strain and, for two backstresses, at a tenth of it. */
static void start_from_curve(struct wb_cycle_parameters *p, const struct wb_law *law)
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

/* Free parameters of the law closest to the given one. */
static void start_law(struct wb_cycle_parameters *p, const struct wb_law *law)
{
    const struct wb_cycle_parameters_candidate *const c = p->candidate;

    if (c->form == WB_LAW_LUDWIK) {
        const struct wb_material *const m = &law->material;
        const double n = m->hardening_exponent;
        const double most = largest_exponent_of(c);
        const double part = fmin(fmax(n / most, 1.0 - largest_part), largest_part);
        p->start[0] = log(m->youngs_modulus);
        p->start[1] = log(m->yield_stress);
        p->start[2] = log(m->strength_coefficient * pow(WB_BENDING_PLASTIC_STRAIN, n));
        p->start[3] = log(part / (1.0 - part));
    } else if (c->form == WB_LAW_CHABOCHE) {
        if (law->form == WB_LAW_CHABOCHE)
            start_from_chaboche(p, law);
        else
            start_from_curve(p, law);
    } else {
        /* Moduli from the slopes of the curve's chords between the yield strains. */
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
    /* On the side of the closest pure rule; parts harden little. */
    const bool grows = c->form == WB_LAW_PARALLEL && c->is_combined;
    if (c->has_share)
        p->start[p->n_form - 1] = law->isotropic_share == 0.0 || grows ? kinematic_start
                                  : law->isotropic_share == 1.0        ? isotropic_start
                                                                       : 0.0;
    start_maxwell(p, law);
    for (int i = 0; i < p->n_law; i++)
        p->scale[i] = 1.0;
}

static void start_specimen(struct wb_cycle_parameters *p, const struct wb_cycle_fit *near)
{
    const struct wb_test_info *const info = &p->data->info;
    double *const start = p->start + p->n_law, *const scale = p->scale + p->n_law;
    start[WB_CYCLE_BOW] = near                        ? near->bow_angle
                          : info->n_natural_shape > 0 ? info->natural_shape[0]
                                                      : 0.0;
    scale[WB_CYCLE_BOW] = 0.01;
    start[WB_CYCLE_LEVEL] = near ? near->level : 0.0;
    scale[WB_CYCLE_LEVEL] = 0.1 * WB_MM;
    start[WB_CYCLE_UNEVEN] = near ? near->uneven_angle : 0.0;
    scale[WB_CYCLE_UNEVEN] = 0.01;
    start[WB_CYCLE_ZERO] = near ? near->zero : 0.0;
    scale[WB_CYCLE_ZERO] = p->force_scale;
}

void wb_cycle_parameters_at(const struct wb_cycle_parameters *p, const double *x, double *free)
{
    for (int i = 0; i < p->n_law + WB_CYCLE_SPECIMEN_PARAMETERS; i++)
        free[i] = p->start[i] + (i < p->n_free ? p->scale[i] * x[i] : 0.0);
}

struct wb_cycle_specimen wb_cycle_parameters_specimen(const struct wb_cycle_parameters *p,
                                                      const double *free)
{
    const double *const own = free + p->n_law;
    return (struct wb_cycle_specimen){.bow_angle = own[WB_CYCLE_BOW],
                                      .level = own[WB_CYCLE_LEVEL],
                                      .uneven_angle = own[WB_CYCLE_UNEVEN]};
}

bool wb_cycle_parameters_contains(const struct wb_cycle_parameters_candidate *c,
                                  const struct wb_cycle_fit *near)
{
    const struct wb_cycle_parameters_candidate *const other = &candidates[near->candidate];
    if (!c->has_share || c->form != other->form || other->has_share || !near->is_converged)
        return false;
    /* A search does not begin with an exponent closer to the ends of its range. */
    if (c->form == WB_LAW_LUDWIK &&
        near->law.material.hardening_exponent > largest_part * largest_exponent_of(c))
        return false;
    return !c->is_combined || other->isotropic_share == (c->form == WB_LAW_LUDWIK ? 1.0 : 0.0);
}

int wb_cycle_parameters_priors(const struct wb_cycle_parameters *p, const double *free,
                               const struct wb_law *law, double *r)
{
    const struct wb_cycle_parameters_candidate *const c = p->candidate;
    int at = 0;

    r[at++] = free[p->n_law + WB_CYCLE_LEVEL] / p->settings.level_prior;
    r[at++] = free[p->n_law + WB_CYCLE_UNEVEN] / p->settings.uneven_prior;
    if (p->settings.zero_prior > 0.0)
        r[at++] = free[p->n_law + WB_CYCLE_ZERO] / p->settings.zero_prior;
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

void wb_cycle_parameters_init(struct wb_cycle_parameters *p, const struct wb_cycle_data *data,
                              enum wb_candidate candidate, const struct wb_law *start,
                              const struct wb_cycle_fit *near, const struct wb_cycle_grid *grid,
                              const struct wb_cycle_fit_settings *settings)
{
    *p = (struct wb_cycle_parameters){
        .data = data,
        .settings = *settings,
        .candidate = &candidates[candidate],
        .grid = grid ? *grid : (struct wb_cycle_grid){0.0, 0.0},
        .poissons_ratio = start->material.poissons_ratio,
        .n_form = wb_candidate_numbers(candidate),
        .n_maxwell = settings->n_maxwell,
        .force_scale = fmax(settings->force_noise, settings->force_share * data->max_force),
        .strain_rate = wb_cycle_parameters_strain_rate(data, elastic_curvature(data)),
        .maxwell_time = sqrt((data->departure - data->arrival) * wb_cycle_data_loading_time(data)),
    };
    /* Forces alone cannot distinguish an uneven natural curvature from another law. */
    const int own = WB_CYCLE_UNEVEN + (data->n_places > 0);
    p->n_law = p->n_form + 2 * p->n_maxwell;
    p->n_free = p->n_law + (settings->zero_prior > 0.0 ? WB_CYCLE_SPECIMEN_PARAMETERS : own);
    start_law(p, start);
    start_specimen(p, near);
    double priors[2 * WB_FIT_MOST_FREE];
    struct wb_law law;
    wb_cycle_parameters_law(p, p->start, &law);
    p->n_priors = wb_cycle_parameters_priors(p, p->start, &law, priors);
}

bool wb_cycle_parameters_at_bound(const struct wb_cycle_parameters *p, const double *free)
{
    return (p->candidate->form == WB_LAW_LUDWIK && fabs(free[3]) > at_bound) ||
           (p->candidate->has_share && fabs(free[p->n_form - 1]) > at_bound);
}

bool wb_cycle_parameters_share_ends(const struct wb_cycle_parameters *p, const struct wb_law *law,
                                    double step)
{
    const double share = logistic(p->start[p->n_form - 1]);
    const double to = share + share * (1.0 - share) * step;
    return law->isotropic_share == 0.0 ? to < logistic(-at_bound) : to > logistic(at_bound);
}

/* Transforms Ludwik's parameters to E, sigma_Y, K and n, and Chaboche's C / gamma to C. */
void wb_cycle_parameters_correlate(const struct wb_cycle_parameters *p,
                                   const gsl_matrix *covariance, double variance,
                                   struct wb_cycle_fit *fit)
{
    double turn[WB_FIT_MOST_LAW][WB_FIT_MOST_LAW] = {{0.0}}, c[WB_FIT_MOST_LAW][WB_FIT_MOST_LAW];
    const int n = p->n_law;
    for (int i = 0; i < n; i++)
        turn[i][i] = 1.0;
    if (p->candidate->form == WB_LAW_LUDWIK) {
        const double exponent = fit->law.material.hardening_exponent;
        turn[3][3] = exponent * (1.0 - exponent / largest_exponent_of(p->candidate));
        turn[2][3] = -turn[3][3] * log(WB_BENDING_PLASTIC_STRAIN);
    }
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
    if (p->candidate->form == WB_LAW_LUDWIK) {
        fit->ln_strength_error =
            sqrt(variance * fmax(c[2][2], 0.0)); /* a difference of two parameters */
        fit->exponent_error = sqrt(variance * c[3][3]);
    }
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
