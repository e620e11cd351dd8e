/* The free parameters of a fit, for cycle_fit.c alone: those of the law, then those of the
 * specimen.
 *
 * Ludwik's law: ln E, ln sigma_Y, ln(hardening stress at a plastic strain amid the test's), and the
 * logit of the exponent. Parallel parts: their moduli over those of the initial guess, mapped by
 * wb_least_squares_positive(). Chaboche's law: logarithms. Then the logit of the isotropic share,
 * if it is free, and the logarithms of modulus and time of each Maxwell element. Weak priors keep
 * parameters finite that the test does not determine.
 */
#ifndef WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_PARAMETERS_H
#define WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_PARAMETERS_H

#include <stdbool.h>

#include <gsl/gsl_matrix.h>

#include "analysis/calibration/cycle/cycle_data.h"
#include "analysis/calibration/cycle/cycle_fit.h"
#include "analysis/calibration/cycle/cycle_model.h"
#include "fe/material/law.h"

struct wb_cycle_parameters_candidate {
    const char *name;
    enum wb_law_form form;
    bool has_share; /* of isotropic hardening, free */
    double isotropic_share;
    bool is_combined;
    int n_backs;
};
const struct wb_cycle_parameters_candidate *
wb_cycle_parameters_candidate(enum wb_candidate candidate);

/* Whether the candidate is the law of this fit with a free isotropic share. */
bool wb_cycle_parameters_contains(const struct wb_cycle_parameters_candidate *candidate,
                                  const struct wb_cycle_fit *near);

/* Parameters of the specimen, behind those of the law. */
enum wb_cycle_specimen_parameter {
    WB_CYCLE_BOW,
    WB_CYCLE_LEVEL,
    WB_CYCLE_UNEVEN, /* fixed without marker places, unless WB_CYCLE_ZERO is free */
    WB_CYCLE_ZERO,   /* of force; free only where a wrong zero is looked for */
    WB_CYCLE_SPECIMEN_PARAMETERS
};

struct wb_cycle_parameters {
    const struct wb_cycle_data *data; /* borrowed */
    struct wb_cycle_fit_settings settings;
    const struct wb_cycle_parameters_candidate *candidate;
    struct wb_cycle_grid grid;
    double poissons_ratio;
    int n_form;    /* parameters of the law without Maxwell elements */
    int n_maxwell; /* Maxwell elements, two parameters each */
    int n_law, n_free;
    int n_priors;
    double force_scale;             /* N, unit of the force's zero and of the residuals */
    struct wb_law_maxwell beside;   /* a fixed element; modulus 0: none */
    double strain_rate;             /* 1/s, see struct wb_law */
    double maxwell_time;            /* s, prior mean of an element's time */
    double start[WB_FIT_MOST_FREE]; /* initial guess; x counts from here, in units of scale */
    double scale[WB_FIT_MOST_FREE];
    double start_modulus[WB_FIT_PARTS]; /* Pa */
};

/* The initial guess comes from the law `start` and from the specimen of the fit `near` (NULL: the
 * specimen as aligned). `grid` as in wb_cycle_fit_run(). */
void wb_cycle_parameters_init(struct wb_cycle_parameters *parameters,
                              const struct wb_cycle_data *data, enum wb_candidate candidate,
                              const struct wb_law *start, const struct wb_cycle_fit *near,
                              const struct wb_cycle_grid *grid,
                              const struct wb_cycle_fit_settings *settings);

/* The parameters (n_law + WB_CYCLE_SPECIMEN_PARAMETERS) at x (n_free); the law and the specimen
 * with these parameters. */
void wb_cycle_parameters_at(const struct wb_cycle_parameters *parameters, const double *x,
                            double *free);
void wb_cycle_parameters_law(const struct wb_cycle_parameters *parameters, const double *free,
                             struct wb_law *law);
struct wb_cycle_specimen wb_cycle_parameters_specimen(const struct wb_cycle_parameters *parameters,
                                                      const double *free);

/* Strain rate of the outer fibre up to the clamp's curvature (1/m) at the turn, 1/s. */
double wb_cycle_parameters_strain_rate(const struct wb_cycle_data *data, double curvature);

/* Residuals of the priors, over their standard deviations: (n_priors), which it returns. */
int wb_cycle_parameters_priors(const struct wb_cycle_parameters *parameters, const double *free,
                               const struct wb_law *law, double *r);

/* Whether the exponent or the isotropic share lies at the end of its range. */
bool wb_cycle_parameters_at_bound(const struct wb_cycle_parameters *parameters, const double *free);

/* Whether a step of the share's logit from the initial guess leads to the end of the range at which
 * the share of `law` lies. */
bool wb_cycle_parameters_share_ends(const struct wb_cycle_parameters *parameters,
                                    const struct wb_law *law, double step);

/* Sets the correlations of the law's parameters, and the standard errors of Ludwik's ln K and n.
 * `covariance` of x, (n_free, n_free), is to be multiplied by `variance`. */
void wb_cycle_parameters_correlate(const struct wb_cycle_parameters *parameters,
                                   const gsl_matrix *covariance, double variance,
                                   struct wb_cycle_fit *fit);

#endif
