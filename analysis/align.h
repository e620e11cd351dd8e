/* Alignment: a recording becomes a dataset.
 *
 * Steps, each with its size in dataset.json: device clocks mapped to the host's (echo probes, else
 * lower envelope), filter delay of the cell, tare, drift between zero-load stretches (a bound
 * otherwise), markers identified by geometry (order along the wire and prediction, not ids), the
 * bending plane, clamp to the origin, marker offset removed along the local slope, zero of force at
 * zero deflection, natural shape (bow), stage commanded against measured (slope, offset, residual,
 * lost steps), cycles and phases. Gaps stay gaps.
 */
#ifndef WB_ANALYSIS_ALIGN_H
#define WB_ANALYSIS_ALIGN_H

#include "analysis/dataset.h"
#include "base/setting.h"
#include "base/status.h"

/* Defaults and ranges: wb_align_table. */
struct wb_align_settings {
    double longest_gap; /* s of bench time: rows are made only where both neighbours of force
                           and shape are nearer than this */
    double row_rate;    /* rows a second of bench time; 0: one row a mocap frame thinned to 20/s */
    double shape_step;  /* m of deflection between stored shapes */
    double lost_steps;  /* m: stage residual that is flagged */
};
extern const struct wb_setting_table wb_align_table;

/* How the warning about gaps, of which a report makes one line for all recordings, goes on after
 * their number. */
#define WB_ALIGN_GAPS_TEXT "in the rows, the longest of"

/* Fills in the defaults. */
void wb_align_default_settings(struct wb_align_settings *settings);

/* Aligns one recording. The dataset's document tells everything that was done; warnings are also
 * listed there under "warnings" (array of texts). WB_ERR_DATA with the reason when the recording
 * cannot serve (no tare, markers not found, ...). */
WB_MUST_CHECK enum wb_status wb_align_run(struct wb_dataset *dataset, const char *recording_path,
                                          const struct wb_align_settings *settings);

#endif
