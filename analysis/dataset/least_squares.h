/* What least-squares fits of a law to a test share: the search and its end, and the prior of
 * parallel parts. */
#ifndef WB_ANALYSIS_DATASET_LEAST_SQUARES_H
#define WB_ANALYSIS_DATASET_LEAST_SQUARES_H

#include <stdbool.h>

#include <gsl/gsl_multifit_nlinear.h>

#include "base/status.h"
#include "fe/material/law.h"

/* A workspace of Powell's dogleg in a trust region with Levenberg's scaling, which takes the
 * free numbers as they are scaled by the caller, with GSL's errors returned instead of ending the
 * program. Release with gsl_multifit_nlinear_free(). */
gsl_multifit_nlinear_workspace *wb_least_squares_create(int n_residuals, int n_free);

struct wb_least_squares_search {
    int max_iterations;
    double smallest_step; /* it has arrived when no free number moves by more, */
    double smallest_gain; /* or the sum of squares falls by no more than this part of itself, */
    int patience;         /* more than so often in a row: a step may overshoot to an equal height */
    /* Set by the residuals where they cannot be computed: ends the search. */
    const enum wb_status *status;
};

/* Iterates an initialized workspace to its end; false when the iterations ran out, or the
 * residuals failed. Adds to *iterations (NULL: not wanted). */
bool wb_least_squares_iterate(gsl_multifit_nlinear_workspace *workspace,
                              const struct wb_least_squares_search *search, int *iterations);

/* A positive number that is 1 at x = 0, grows nearly linearly above and falls by an exponential
 * below. Forces are nearly linear in moduli, so that linear steps arrive soon; moduli that go to
 * nothing stay positive. */
double wb_least_squares_positive(double x);

/* Residuals of the prior that parallel parts which yield one after another do so about evenly: the
 * second differences of ln(modulus), over `deviation`. The last part, which stays elastic, is of
 * another kind (jacket, hardening) and may be as stiff as it is. Returns their number, n - 3, for
 * n parts of at least three. */
int wb_least_squares_smooth_parts(const struct wb_law_part *parts, int n, double deviation,
                                  double *residuals);

#endif
