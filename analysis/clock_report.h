/* The clocks of one recording: how well the cameras' and the load cell's times are known on the
 * host's, how far the force lags behind the markers, and what that lag does to the loop.
 *
 * Clocks and the loop are findings of the alignment (checks of align.h). The lag is measured where
 * the motion is reversed (reversal_lag.h). The filter's delay of the rig file is what is expected.
 * Where a recording has no reversal, or too little force, the lag is not identifiable, with the
 * reason.
 *
 * Times are those of the bench: of a virtual rig that runs X times as fast, X host seconds.
 */
#ifndef WB_ANALYSIS_CLOCK_REPORT_H
#define WB_ANALYSIS_CLOCK_REPORT_H

#include <stdbool.h>

#include "analysis/dataset/dataset.h"
#include "base/json.h"
#include "base/reason.h"
#include "base/status.h"
#include "base/text.h"

struct wb_clock_report {
    struct wb_dataset dataset;             /* of the alignment */
    double expected, expected_uncertainty; /* s, filter delay of the rig file */
    bool identifiable;
    char reason[256];   /* why not; "" otherwise */
    double lag;         /* s, of the force behind the markers, the filter's delay within; NaN */
    double uncertainty; /* s, standard */
    double interval[2]; /* s, 95 %: lag -+ 1.96 standard uncertainties */
    int n_reversals;    /* that gave a lag */
    bool agrees;        /* expected and measured differ by less than their 95 % interval */
    /* Area of the first cycle's loop (J) with the delay that the rig file has, its change with that
     * delay (J/s), and the area with the delays at both ends of the interval, to first order. NaN
     * where the alignment has no area. */
    double area, area_per_delay, area_interval[2];
};

/* Aligns the recording by the defaults and reports. `why` as of wb_align_run(). Release it also
 * when it was refused. */
WB_MUST_CHECK enum wb_status wb_clock_report_make(struct wb_clock_report *report,
                                                  const char *recording_path,
                                                  struct wb_reason *why);
void wb_clock_report_release(struct wb_clock_report *report); /* accepts a zeroed one */

/* As text for people, and as members of an object with units in the keys. */
WB_MUST_CHECK enum wb_status wb_clock_report_format(const struct wb_clock_report *report,
                                                    struct wb_text *text);
void wb_clock_report_describe(const struct wb_clock_report *report, struct wb_json *object);

#endif
