/* Tests of a campaign of testing machines: the curve of each test beyond its first contact, and the
 * mean of a group. */
#ifndef WB_ANALYSIS_REPORT_MACHINES_MACHINES_TEST_H
#define WB_ANALYSIS_REPORT_MACHINES_MACHINES_TEST_H

#include "analysis/dataset/machine_import.h"
#include "base/hash.h"
#include "base/text.h"

enum {
    WB_MACHINES_GRID = 101
};

struct wb_machines_test {
    bool is_missing; /* the file does not exist */
    bool is_usable;  /* imported, and the force exceeds the group's zero force */
    struct wb_text problem;
    struct wb_dataset dataset;
    struct wb_machine_import_report report;
    char sha256[WB_SHA256_TEXT];
    double start;    /* m, travel where the force first exceeds the group's zero force */
    double rigidity; /* N m2: F L^3 / 48 d at d = 0.02 L beyond `start`; NaN: not reached */
};

struct wb_machines_group_results {
    struct wb_machines_test *tests; /* (n_tests of the group), owned */
    int n_usable;
    double reach; /* m: deflection up to which all usable tests go, at most the usable travel */
    /* On WB_MACHINES_GRID deflections from 0 to `reach`: mean force and standard deviation, N. */
    double force[WB_MACHINES_GRID], deviation[WB_MACHINES_GRID];
    double rigidity, rigidity_deviation; /* N m2: mean and standard deviation over the tests */
};

/* Travel where the force first exceeds `zero_force`, m; NaN: nowhere. */
double wb_machines_test_start(const struct wb_machines_test *test, double zero_force);

/* Force at a deflection beyond `start`, N; NaN beyond the test's end. */
double wb_machines_test_force(const struct wb_machines_test *test, double start, double deflection);

/* The largest deflection beyond the test's own start, m. */
double wb_machines_test_reach(const struct wb_machines_test *test);

#endif
