#include "analysis/compare/welch.h"

#include <math.h>

#include <gsl/gsl_cdf.h>

/* Share of the comparisons that shall be decided. */
static const double wanted_power = 0.8;

static double variance_of_mean(const struct wb_welch_group *group)
{
    return group->deviation * group->deviation / group->n;
}

struct wb_welch wb_welch_find(const struct wb_welch_group *first,
                              const struct wb_welch_group *second, double alpha)
{
    const double a = variance_of_mean(first), b = variance_of_mean(second);
    struct wb_welch w = {.difference = second->mean - first->mean, .error = sqrt(a + b)};
    w.degrees = a + b > 0.0 ? (a + b) * (a + b) / (a * a / first->degrees + b * b / second->degrees)
                            : first->degrees + second->degrees;
    const double half = gsl_cdf_tdist_Qinv(alpha, w.degrees) * w.error;
    w.low = w.difference - half;
    w.high = w.difference + half;
    return w;
}

enum wb_verdict_of_groups wb_welch_decide(const struct wb_welch *welch, double limit)
{
    if (welch->low >= -limit && welch->high <= limit)
        return WB_GROUPS_EQUIVALENT;
    if (welch->low > limit || welch->high < -limit)
        return WB_GROUPS_DIFFERENT;
    return WB_GROUPS_UNDECIDED;
}

/* A group with more specimens and the same mean and scatter. */
static struct wb_welch_group larger(const struct wb_welch_group *group, int more)
{
    struct wb_welch_group with = *group;
    with.n += more;
    with.degrees += more;
    return with;
}

/* Probability that the interval decides if the true difference is the one found. */
static double power(const struct wb_welch *welch, double limit)
{
    const double d = fabs(welch->difference);
    if (!(welch->error > 0.0))
        return d == limit ? 0.0 : 1.0;
    const double half = 0.5 * (welch->high - welch->low) / welch->error;
    if (d > limit)
        return gsl_cdf_tdist_P((d - limit) / welch->error - half, welch->degrees);
    return fmax(0.0, gsl_cdf_tdist_P((limit - d) / welch->error - half, welch->degrees) -
                         gsl_cdf_tdist_P(half - (limit + d) / welch->error, welch->degrees));
}

int wb_welch_more(const struct wb_welch_group *first, const struct wb_welch_group *second,
                  double alpha, double limit)
{
    for (int more = 1; more <= WB_WELCH_MOST; more++) {
        const struct wb_welch_group a = larger(first, more), b = larger(second, more);
        const struct wb_welch welch = wb_welch_find(&a, &b, alpha);
        if (power(&welch, limit) >= wanted_power)
            return more;
    }
    return 0;
}
