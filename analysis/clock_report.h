/* The clocks of one recording: accuracy of the times of cameras and load cell on the host's clock,
 * lag of the force behind the markers, and effect of that lag on the area of the loop.
 *
 * Clocks and loop area are results of the alignment (checks of align.h). The lag is measured at
 * reversals of the motion (reversal_lag.h); the expected value is the filter delay of the rig file.
 * Without a reversal, or with too small a force, the lag is not identifiable and `reason` says why.
 *
 * Times are in bench seconds: on a virtual rig that runs X times as fast, X bench seconds pass in
 * one host second.
 */
#ifndef WB_ANALYSIS_CLOCK_REPORT_H
#define WB_ANALYSIS_CLOCK_REPORT_H

#include <stdbool.h>

#include "analysis/dataset/dataset.h"
#include "base/json.h"
#include "base/status.h"
#include "base/text.h"

struct wb_clock_report {
    struct wb_dataset dataset;             /* of the alignment */
    double expected, expected_uncertainty; /* s, filter delay of the rig file */
    bool identifiable;
    char reason[256];   /* why not; "" otherwise */
    double lag;         /* s, of the force behind the markers, including the filter delay; or NaN */
    double uncertainty; /* s, standard */
    double interval[2]; /* s, 95 %: lag -+ 1.96 standard uncertainties */
    int n_reversals;    /* from which a lag was determined */
    bool agrees;        /* expected and measured differ by less than their joint 95 % interval */
    /* Area of the first cycle's loop (J) with the delay of the rig file, its derivative with
     * respect to that delay (J/s), and the area with the delay at each end of the interval, to
     * first order. NaN if the alignment has no area. */
    double area, area_per_delay, area_interval[2];
};

/* Aligns the recording with the default settings and fills the report. Failures are logged.
 * Release the report after a failure, too. */
WB_MUST_CHECK enum wb_status wb_clock_report_make(struct wb_clock_report *report,
                                                  const char *recording_path);
void wb_clock_report_release(struct wb_clock_report *report); /* accepts a zeroed one */

/* The report as text, and as members of a JSON object with units in the keys. */
void wb_clock_report_format(const struct wb_clock_report *report, struct wb_text *text);
void wb_clock_report_describe(const struct wb_clock_report *report, struct wb_json *object);

#endif
