/* What the tests of a series have in common and where they differ: a few numbers of each test's
 * first cycle, their mean and spread, and all curves in one figure. For the operator at the bench;
 * a report calibrates on the same recordings. */
#ifndef WB_ANALYSIS_SERIES_RESULTS_H
#define WB_ANALYSIS_SERIES_RESULTS_H

#include <stdbool.h>

#include "analysis/dataset/dataset.h"
#include "base/json.h"
#include "base/reason.h"
#include "base/status.h"
#include "base/text.h"
#include "daq/recording/index.h"

/* Of the first cycle; slope and what is left are of its points
 * (analysis/calibration/cycle/cycle_data.h). */
enum wb_series_quantity {
    WB_SERIES_PEAK_FORCE, /* N: largest force of the curve's rows */
    WB_SERIES_STIFFNESS,  /* N/m: least-squares slope up to a deflection of 0.05 of the length */
    WB_SERIES_RESIDUAL,   /* m: residual deflection: at zero force of the unloading */
    WB_SERIES_LOOP,       /* J: area of the loop above zero deflection */
    WB_SERIES_QUANTITIES
};

struct wb_series_test {
    char name[256]; /* of the recording's file */
    int number, sample;
    struct wb_index_exclusion excluded;
    bool is_usable; /* a dataset could be made of it */
    char problem[320];
    struct wb_dataset dataset;
    double values[WB_SERIES_QUANTITIES]; /* NaN: the test does not say */
};

/* All zero is empty. */
struct wb_series_results {
    int n;
    struct wb_series_test *tests; /* (n), owned, in the order in which they were added */
};

/* Aligns a recording and adds it; one that cannot be aligned is added with its problem. Returns the
 * test, which stays in its place until the next one is added. */
struct wb_series_test *wb_series_results_add(struct wb_series_results *results, const char *path,
                                             int number);
void wb_series_results_release(struct wb_series_results *results);

/* Appends a table: the quantities of each test, and their mean and standard deviation over the
 * tests that count (usable, not excluded) and have them. */
void wb_series_results_append(const struct wb_series_results *results, struct wb_text *text);

/* Sets the same as members of an object, "tests" and "statistics", units in the keys. */
void wb_series_results_describe(const struct wb_series_results *results, struct wb_json *object);

/* Whether a row belongs to the curves that are compared: of the first cycle, with a taut strand,
 * from zero deflection on. */
bool wb_series_results_shows(const struct wb_row *row);

/* Draws the first cycles of all tests, as SVG, PNG or PDF by the ending; excluded ones grey. The
 * file is replaced. WB_ERR_DATA when there is no usable test. */
WB_MUST_CHECK enum wb_status wb_series_results_draw(const struct wb_series_results *results,
                                                    const char *series, const char *path);

#endif
