/* What figures of recordings share: their names, their footers, the wires they are of. */
#ifndef WB_ANALYSIS_REPORT_BENCH_RECORDINGS_DRAW_H
#define WB_ANALYSIS_REPORT_BENCH_RECORDINGS_DRAW_H

#include "analysis/report/bench/recordings_results.h"
#include "analysis/report/figures.h"

/* "measured (virtual rig)" or "measured", after where the used recordings come from. */
const char *wb_recordings_draw_measured(const struct wb_recordings_results *results);

/* A wire's name as part of file names, anchors and figure names: other characters become '-'. */
void wb_recordings_draw_slug(char slug[64], const char *name);

/* The count of rows that stand for one figure of each wire, and the wire of such a figure. */
int wb_recordings_draw_count(const void *results);
const struct wb_recordings_results_wire *
wb_recordings_draw_wire(const struct wb_figures_item *item);

/* Starts a figure that says where its data come from, named WIRE-KIND ("all-KIND" when its row is
 * not of single wires). */
WB_MUST_CHECK enum wb_status wb_recordings_draw_start(struct wb_figures_item *item,
                                                      const char *kind, double width,
                                                      double height);

#endif
