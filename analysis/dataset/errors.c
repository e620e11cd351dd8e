#include "analysis/dataset/errors.h"

#include <math.h>

double wb_errors_l2(int n, double step, const double *measured, const double *computed)
{
    double sum = 0.0;
    for (int i = 0; i < n; i++) {
        const double difference = measured[i] - computed[i];
        const double weight = i == 0 || i == n - 1 ? 0.5 : 1.0;
        sum += weight * difference * difference;
    }
    return sqrt(sum * step);
}

double wb_errors_relative_l2(int n, double step, const double *measured, const double *computed,
                             double max_force)
{
    return wb_errors_l2(n, step, measured, computed) / (max_force * sqrt(step * (n - 1)));
}

void wb_errors_curve(int n, const double *measured, const double *computed, double max_force,
                     double *error)
{
    for (int i = 0; i < n; i++)
        error[i] = fabs(measured[i] - computed[i]) / max_force;
}

double wb_errors_rms(int n, const double *error)
{
    double sum = 0.5 * (error[0] * error[0] + error[n - 1] * error[n - 1]);
    for (int i = 1; i < n - 1; i++)
        sum += error[i] * error[i];
    return sqrt(sum / (n - 1));
}

double wb_errors_largest(int n, const double *error)
{
    double largest = error[0];
    for (int i = 1; i < n; i++) {
        if (!(error[i] <= largest))
            largest = error[i];
        if (isnan(largest))
            break;
    }
    return largest;
}
