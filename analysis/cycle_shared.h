/* What an error that all specimens share does to the result of a calibration on whole cycles.
 *
 * The gain of the load cell, the free length, the strand's length, the counterweight and the
 * diameter are the same for every specimen, so that neither the scatter nor the misfit says whether
 * they are right. Each is made larger by a small part, one specimen is fitted again from the law
 * that it has, and what changes is told in percent per percent.
 */
#ifndef WB_ANALYSIS_CYCLE_SHARED_H
#define WB_ANALYSIS_CYCLE_SHARED_H

#include "analysis/cycle_calibrate.h"
#include "base/reason.h"
#include "base/status.h"

enum wb_cycle_shared_cause {
    WB_SHARED_CELL_GAIN,
    WB_SHARED_LENGTH,
    WB_SHARED_DIAMETER,
    WB_SHARED_COUNTERWEIGHT,
    WB_SHARED_STRAND,
    WB_SHARED_CAUSES
};

/* Slopes of logarithms, 1; NaN where there is no such thing or the fit fails. */
struct wb_cycle_shared_slopes {
    double rigidity;       /* EI */
    double middle_moment;  /* M at 0.3 and */
    double largest_moment; /* at 1 of the largest curvature */
    double springback;
};

struct wb_cycle_shared {
    int sample; /* the specimen that was fitted again */
    struct wb_cycle_shared_slopes slopes[WB_SHARED_CAUSES];
};

/* "gain of the load cell", ... */
const char *wb_cycle_shared_name(enum wb_cycle_shared_cause cause);

/* Of the chosen law of a calibration that succeeded. `why` receives the reason of a failure; NULL:
 * it is logged. */
WB_MUST_CHECK enum wb_status wb_cycle_shared_find(struct wb_cycle_shared *shared,
                                                  const struct wb_cycle_calibration *calibration,
                                                  struct wb_reason *why);

#endif
