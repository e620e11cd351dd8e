/* A part of errors.c that tests call by itself. */
#ifndef WB_ANALYSIS_DATASET_ERRORS_PRIVATE_H
#define WB_ANALYSIS_DATASET_ERRORS_PRIVATE_H

#include "analysis/dataset/errors.h"

/* Integral of `values` over (n - 1) steps, trapezoid rule. */
double wb_errors_integral(int n, double step, const double *values);

#endif
