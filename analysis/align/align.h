/* Alignment: makes a dataset from the recording of a bench test.
 *
 * A recording contains the streams of load cell, cameras and stage, each with its own clock and
 * frame of reference. The alignment
 *   - maps the device clocks to the host's, from echo probes, else from the lower envelope of the
 *     arrival times, and subtracts the delay of the load cell's filter;
 *   - subtracts the tare and the drift of the zero between stretches without load; if the test
 *     has no such stretch, it states a bound of the drift;
 *   - identifies the markers by geometry (their order along the wire and a prediction), because the
 *     cameras' ids change;
 *   - finds the plane of bending, sets the origin at the clamp, and moves each marker to the wire's
 *     axis, along the local normal;
 *   - sets the force at zero deflection to zero;
 *   - finds the natural shape, the bow of the unloaded wire;
 *   - compares the stage's commanded travel with the measured one (slope, offset, residual, lost
 *     steps);
 *   - cuts the test into cycles and phases.
 * dataset.json lists each correction with its size. Gaps are not filled.
 */
#ifndef WB_ANALYSIS_ALIGN_ALIGN_H
#define WB_ANALYSIS_ALIGN_ALIGN_H

#include "analysis/dataset/dataset.h"
#include "base/reason.h"
#include "base/setting.h"
#include "base/status.h"

/* Defaults and ranges: wb_align_table. */
struct wb_align_settings {
    double longest_gap; /* s of bench time: rows are made only where both neighbours of force
                           and shape are nearer than this */
    double row_rate;    /* rows a second of bench time; 0: one row a mocap frame thinned to 20/s */
    double shape_step;  /* m of deflection between stored shapes */
    double lost_steps;  /* m: a larger residual of the stage is reported as lost steps */
    /* Files used in place of the recording's own rig and specimen where those were wrong; NULL: the
     * recording's own. Each key that differs is logged as a warning and listed in dataset.json. The
     * caller keeps the strings. */
    const char *rig_path, *specimen_path;
};
extern const struct wb_setting_table wb_align_table;

/* Text after the number of gaps in the warning about gaps. A report finds the warning by it and
 * prints one line for all recordings. */
#define WB_ALIGN_GAPS_TEXT "in the rows, the longest of"

/* Fills in the defaults, and no files in place of the recording's own rig and specimen. */
void wb_align_default_settings(struct wb_align_settings *settings);

/* Aligns one recording. The dataset's document lists every correction, and under "warnings" (array
 * of texts) every warning. WB_ERR_DATA: no dataset can be made from the recording (no tare, markers
 * not found, ...). On failure `why` receives the unreadable parts of a damaged recording, "; ", and
 * the reason of the failure; with NULL both are logged where they occur. Unreadable parts of a
 * recording that could still be aligned are always logged. */
WB_MUST_CHECK enum wb_status wb_align_run(struct wb_dataset *dataset, const char *recording_path,
                                          const struct wb_align_settings *settings,
                                          struct wb_reason *why);

/* The two signals from which rows are made, on the bench's clock, before averaging. All arrays are
 * owned. */
struct wb_align_signals {
    size_t n_motion, n_force;
    double *motion_t, *motion; /* s, m: clamp travel, downwards from an arbitrary zero, in each
                                  frame that shows the clamp's marker */
    double *force_t, *force;   /* s, N: raw readings; the filter's delay is removed */
    double filter_delay, filter_delay_uncertainty; /* s of bench time, from the rig file */
};
void wb_align_signals_release(struct wb_align_signals *signals); /* accepts a zeroed one */

/* Like wb_align_run(), and returns the signals too; they are empty on failure. */
WB_MUST_CHECK enum wb_status wb_align_run_signals(struct wb_dataset *dataset,
                                                  struct wb_align_signals *signals,
                                                  const char *recording_path,
                                                  const struct wb_align_settings *settings,
                                                  struct wb_reason *why);

#endif
