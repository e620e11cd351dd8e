/* What a search for a law counts in: free numbers of the law and of the specimen, for
 * cycle_fit.c alone.
 *
 * Of Ludwik's law ln E, ln sigma_Y, ln(hardening stress at a plastic strain amid the test's) and a
 * logistic exponent; of parallel parts their moduli over those of the start, see
 * wb_least_squares_positive(); of Chaboche's logarithms. Behind these the logistic share of mixed
 * or combined hardening, logarithms of modulus and time of each Maxwell element, and the
 * specimen's. Weak priors keep finite what a test does not tell.
 */
#ifndef WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_NUMBERS_H
#define WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_NUMBERS_H

#include <stdbool.h>

#include <gsl/gsl_matrix.h>

#include "analysis/calibration/cycle/cycle_data.h"
#include "analysis/calibration/cycle/cycle_fit.h"
#include "analysis/calibration/cycle/cycle_model.h"
#include "fe/material/law.h"

struct wb_cycle_numbers_candidate {
    const char *name;
    enum wb_law_form form;
    bool has_share; /* of isotropic hardening, free */
    double isotropic_share;
    bool is_combined;
    int n_backs;
};
const struct wb_cycle_numbers_candidate *wb_cycle_numbers_candidate(enum wb_candidate candidate);

/* Whether the fit is one of a law that the candidate is with a share at its end. */
bool wb_cycle_numbers_contains(const struct wb_cycle_numbers_candidate *candidate,
                               const struct wb_cycle_fit *near);

/* Free numbers of the specimen, behind those of the law. */
enum wb_cycle_own_number {
    WB_CYCLE_BOW,
    WB_CYCLE_LEVEL,
    WB_CYCLE_UNEVEN, /* not free without places, unless the last is */
    WB_CYCLE_ZERO,   /* of force: free where it may be wrong */
    WB_CYCLE_OWN_NUMBERS
};

struct wb_cycle_numbers {
    const struct wb_cycle_data *data; /* borrowed */
    struct wb_cycle_fit_settings settings;
    const struct wb_cycle_numbers_candidate *candidate;
    struct wb_cycle_grid grid;
    double poissons_ratio;
    int n_form;    /* free numbers of the law's form, */
    int n_maxwell; /* then two of each Maxwell element */
    int n_law, n_free;
    int n_priors;
    double force_scale;             /* N */
    struct wb_law_maxwell beside;   /* an element that is not free; modulus 0: none */
    double strain_rate;             /* 1/s, see struct wb_law */
    double maxwell_time;            /* s, prior of an element's */
    double start[WB_FIT_MOST_FREE]; /* the free numbers are counted from here, in units of scale */
    double scale[WB_FIT_MOST_FREE];
    double start_modulus[WB_FIT_PARTS]; /* Pa */
};

/* They start from a law near by, and from the specimen of a fit near by (NULL: none). `grid` as
 * wb_cycle_fit_run(). */
void wb_cycle_numbers_init(struct wb_cycle_numbers *numbers, const struct wb_cycle_data *data,
                           enum wb_candidate candidate, const struct wb_law *start,
                           const struct wb_cycle_fit *near, const struct wb_cycle_grid *grid,
                           const struct wb_cycle_fit_settings *settings);

/* The free numbers (n_law + WB_CYCLE_OWN_NUMBERS) at x (n_free), which counts from the start; the
 * law and the specimen that they are. */
void wb_cycle_numbers_at(const struct wb_cycle_numbers *numbers, const double *x, double *free);
void wb_cycle_numbers_law(const struct wb_cycle_numbers *numbers, const double *free,
                          struct wb_law *law);
struct wb_cycle_specimen wb_cycle_numbers_specimen(const struct wb_cycle_numbers *numbers,
                                                   const double *free);

/* Strain rate of the outer fibre up to the clamp's curvature (1/m) at the turn, 1/s. */
double wb_cycle_numbers_strain_rate(const struct wb_cycle_data *data, double curvature);

/* How far the priors are off, over their standard deviations: (n_priors), which it returns. */
int wb_cycle_numbers_priors(const struct wb_cycle_numbers *numbers, const double *free,
                            const struct wb_law *law, double *r);

/* Whether an exponent or a share lies at the end of its range. */
bool wb_cycle_numbers_at_bound(const struct wb_cycle_numbers *numbers, const double *free);

/* Whether a step of the share's number from its start, beside a law whose share is at its end,
 * leads to that end. */
bool wb_cycle_numbers_share_ends(const struct wb_cycle_numbers *numbers, const struct wb_law *law,
                                 double step);

/* Correlations of the law's numbers, and standard errors of ln K and n of Ludwik's, from the
 * covariance of x but for a factor, `variance`. */
void wb_cycle_numbers_correlate(const struct wb_cycle_numbers *numbers,
                                const gsl_matrix *covariance, double variance,
                                struct wb_cycle_fit *fit);

#endif
