/* Shared parts of least-squares fits of a law to a test: the search with its convergence criteria,
 * and the prior of parallel parts. */
#ifndef WB_ANALYSIS_DATASET_LEAST_SQUARES_H
#define WB_ANALYSIS_DATASET_LEAST_SQUARES_H

#include <stdbool.h>

#include <gsl/gsl_multifit_nlinear.h>

#include "base/status.h"
#include "fe/material/law.h"

/* Creates a workspace of Powell's dogleg in a trust region with Levenberg's scaling. The caller
 * scales the free parameters. GSL's errors are returned instead of ending the program. Release with
 * gsl_multifit_nlinear_free(). */
gsl_multifit_nlinear_workspace *wb_least_squares_create(int n_residuals, int n_free);

struct wb_least_squares_search {
    int max_iterations;
    double smallest_step; /* converged when no free parameter moves by more, */
    double smallest_gain; /* or the sum of squares falls by at most this fraction */
    int patience;         /* more often than this in a row: a step may overshoot to an equal sum */
    /* Set by the residuals where they cannot be computed: ends the search. */
    const enum wb_status *status;
};

/* Iterates an initialised workspace until it converges; false when the iterations ran out, or the
 * residuals failed. Adds to *iterations (NULL: not counted). */
bool wb_least_squares_iterate(gsl_multifit_nlinear_workspace *workspace,
                              const struct wb_least_squares_search *search, int *iterations);

/* Maps x to a positive number: 1 at x = 0, nearly linear above, exponential decay below. Forces are
 * nearly linear in moduli, so linear steps converge fast, and moduli that approach zero stay
 * positive. */
double wb_least_squares_positive(double x);

/* Residuals of the prior that parallel parts with ascending yield strain yield about evenly: the
 * second differences of ln(modulus), over `deviation`. The last part, which stays elastic, is of
 * another kind (jacket, hardening) and not restricted. Returns their number, n - 3, for n parts of
 * at least three. */
int wb_least_squares_smooth_parts(const struct wb_law_part *parts, int n, double deviation,
                                  double *residuals);

#endif
