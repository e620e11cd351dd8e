/* Alignment: the recording of a bench test becomes a dataset.
 *
 * A recording holds the streams of load cell, cameras and stage, each with a clock and a frame of
 * its own. The alignment
 *   - maps the device clocks to the host's, from echo probes, else from the lower envelope of the
 *     arrival times, and takes off the delay of the load cell's filter;
 *   - subtracts the tare and the drift of the zero between stretches without load; where the test
 *     has no such stretch, it states a bound of the drift;
 *   - identifies the markers by geometry (their order along the wire and a prediction), because the
 *     cameras' ids change;
 *   - finds the plane of bending, puts the clamp at the origin, and moves each marker from where it
 *     sits to the wire's axis, along the local normal;
 *   - takes the force at zero deflection as zero;
 *   - finds the natural shape, the bow of the unloaded wire;
 *   - compares the stage's commanded travel with the measured one (slope, offset, residual, lost
 *     steps);
 *   - cuts the test into cycles and phases.
 * dataset.json lists each correction with its size. Nothing is filled in: gaps stay gaps.
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
    /* Paths of files that hold in place of the recording's own, where those were wrong; NULL: the
     * recording's own. Each key that differs is warned of and listed in dataset.json. The caller
     * keeps the texts. */
    const char *rig_path, *specimen_path;
};
extern const struct wb_setting_table wb_align_table;

/* In the warning about gaps this text follows their number. A report finds the warning by it and
 * prints one line for all recordings. */
#define WB_ALIGN_GAPS_TEXT "in the rows, the longest of"

/* Fills in the defaults; the recording's own rig and specimen. */
void wb_align_default_settings(struct wb_align_settings *settings);

/* Aligns one recording. The dataset's document lists everything that was done, and under "warnings"
 * (array of texts) what was warned of. WB_ERR_DATA when no dataset can be made of the recording (no
 * tare, markers not found, ...). `why` receives why it failed, after what of a damaged recording
 * could not be read, "; " between them. NULL: all that is logged where it is found. What could not
 * be read of a recording that serves all the same is logged in either case. */
WB_MUST_CHECK enum wb_status wb_align_run(struct wb_dataset *dataset, const char *recording_path,
                                          const struct wb_align_settings *settings,
                                          struct wb_reason *why);

/* What the alignment makes its rows of: both signals on the bench's clock, not yet thinned. All
 * arrays are owned. */
struct wb_align_signals {
    size_t n_motion, n_force;
    double *motion_t, *motion; /* s, m: how far down the clamp's marker is, in each frame that shows
                                  it, from an unknown zero */
    double *force_t, *force;   /* s, N: each reading, as read; the filter's delay is taken off */
    double filter_delay, filter_delay_uncertainty; /* s, of bench time, of the rig file */
    double camera_uncertainty;                     /* s, of bench time; NaN unknown */
    double time_scale;                             /* bench seconds in one of the host's */
};
void wb_align_signals_release(struct wb_align_signals *signals); /* accepts a zeroed one */

/* wb_align_run(), which also keeps the signals; on a failure there are none. */
WB_MUST_CHECK enum wb_status wb_align_run_signals(struct wb_dataset *dataset,
                                                  struct wb_align_signals *signals,
                                                  const char *recording_path,
                                                  const struct wb_align_settings *settings,
                                                  struct wb_reason *why);

#endif
