#include "analysis/validation/expected.h"

#include <math.h>

#include <gsl/gsl_cdf.h>

struct wb_expected wb_expected_find(const struct wb_expected_group *here,
                                    const struct wb_expected_group *calibration, double sensitivity,
                                    double found)
{
    const double none = (double)NAN;
    const struct wb_expected_group *const groups[] = {here, calibration};
    struct wb_expected e = {.deviation = none, .rms = none, .rms_95 = none, .share = none};
    double squares = 0.0;
    for (int i = 0; i < 2; i++) {
        const double s = groups[i]->deviation;
        if (groups[i]->n < 2 || !isfinite(s))
            continue;
        squares += (groups[i]->n - 1) * s * s;
        e.degrees += groups[i]->n - 1;
    }
    if (e.degrees == 0)
        return e;
    e.deviation = sqrt(squares / e.degrees);
    e.rms = e.deviation * sqrt(1.0 / here->n + (calibration->n > 0 ? 1.0 / calibration->n : 0.0)) *
            sensitivity;
    e.rms_95 = gsl_cdf_tdist_Pinv(0.975, e.degrees) * e.rms;
    if (found > 0.0)
        e.share = fmin(1.0, pow(e.rms / found, 2));
    return e;
}
