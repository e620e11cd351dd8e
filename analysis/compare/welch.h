/* Equivalence of two groups of specimens, by the difference of their means and its interval.
 *
 * The groups may have different scatter (Welch). With standard error s_e and degrees of freedom v
 * by Welch and Satterthwaite, the interval of the difference d is d -+ t(1 - alpha, v) s_e. Within
 * -+ a limit: equivalent (Schuirmann's two one-sided tests, each at alpha); completely outside:
 * different; else undecided. Each verdict is wrong with a probability of at most alpha.
 */
#ifndef WB_ANALYSIS_COMPARE_WELCH_H
#define WB_ANALYSIS_COMPARE_WELCH_H

/* A group of n values; `degrees` of freedom of its standard deviation, n - 1 unless it is pooled
 * over more than the group. */
struct wb_welch_group {
    double mean, deviation;
    int n, degrees;
};

struct wb_welch {
    double difference; /* mean of the second group minus that of the first */
    double error;      /* standard error of it */
    double degrees;    /* of freedom */
    double low, high;  /* its interval of 1 - 2 alpha */
};

enum wb_verdict_of_groups {
    WB_GROUPS_EQUIVALENT,
    WB_GROUPS_DIFFERENT,
    WB_GROUPS_UNDECIDED
};

/* Both groups have n >= 2. For two groups without scatter the interval has no width. */
struct wb_welch wb_welch_find(const struct wb_welch_group *first,
                              const struct wb_welch_group *second, double alpha);

/* The verdict for a `limit` above 0. */
enum wb_verdict_of_groups wb_welch_decide(const struct wb_welch *welch, double limit);

/* Number of additional specimens of each group with which the interval decides in four of five
 * comparisons, if mean and scatter of all specimens are those found; 0 if more than WB_WELCH_MOST
 * would be needed, because the difference is at the limit. */
enum {
    WB_WELCH_MOST = 1000
};
int wb_welch_more(const struct wb_welch_group *first, const struct wb_welch_group *second,
                  double alpha, double limit);

#endif
