/* Whether two groups of specimens are alike, by the difference of their means and its interval.
 *
 * The groups may scatter differently (Welch). With standard error s_e and degrees of freedom v by
 * Welch and Satterthwaite, the interval of the difference d is d -+ t(1 - alpha, v) s_e. Within
 * -+ a limit: equivalent (Schuirmann's two one-sided tests, each at alpha); outside of it as a
 * whole: different; else the specimens cannot tell. Each verdict is wrong with a probability of
 * alpha at most.
 */
#ifndef WB_ANALYSIS_COMPARE_WELCH_H
#define WB_ANALYSIS_COMPARE_WELCH_H

/* A group of n values; `degrees` of its standard deviation, n - 1 unless that is pooled over more
 * than the group. */
struct wb_welch_group {
    double mean, deviation;
    int n, degrees;
};

struct wb_welch {
    double difference; /* of the second group's mean from the first one's */
    double error;      /* standard error of it */
    double degrees;    /* of freedom */
    double low, high;  /* its interval of 1 - 2 alpha */
};

enum wb_verdict_of_groups {
    WB_GROUPS_EQUIVALENT,
    WB_GROUPS_DIFFERENT,
    WB_GROUPS_UNDECIDED
};

/* Both groups have n >= 2. Two groups without any scatter have an interval without width. */
struct wb_welch wb_welch_find(const struct wb_welch_group *first,
                              const struct wb_welch_group *second, double alpha);

/* `limit` is above 0. */
enum wb_verdict_of_groups wb_welch_decide(const struct wb_welch *welch, double limit);

/* How many more specimens of each group it takes for the interval to decide in four of five such
 * comparisons, if mean and scatter of all specimens are those found; 0 where more than
 * WB_WELCH_MOST would be needed: the difference lies at the limit. */
enum {
    WB_WELCH_MOST = 1000
};
int wb_welch_more(const struct wb_welch_group *first, const struct wb_welch_group *second,
                  double alpha, double limit);

#endif
