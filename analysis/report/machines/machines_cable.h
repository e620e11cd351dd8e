/* The groups of a campaign that are layers of one cable, compared at equal curvature: where each
 * lies between wires that slide and wires that are bonded
 * (analysis/calibration/constituents/cable.h). */
#ifndef WB_ANALYSIS_REPORT_MACHINES_MACHINES_CABLE_H
#define WB_ANALYSIS_REPORT_MACHINES_MACHINES_CABLE_H

#include "analysis/calibration/constituents/cable.h"
#include "analysis/report/machines/machines.h"
#include "analysis/report/machines/machines_test.h"

enum {
    WB_MACHINES_PLACES = 20,
    WB_MACHINES_ZEROS = 2 /* half and twice the groups' zero force */
};

/* A layered group at curvatures evenly up to its reach. */
struct wb_machines_layer {
    int group, n;                         /* n: usable tests; 0: the group cannot be compared */
    double curvature[WB_MACHINES_PLACES]; /* 1/m, nominal */
    /* The deflection of the wires is so small that their seating on the supports dominates. */
    bool is_seating[WB_MACHINES_PLACES];
    struct wb_cable_place place[WB_MACHINES_PLACES];
    double over_first[WB_MACHINES_PLACES]; /* M over that of the first layered group; NaN */
    /* chi with the wires of one series alone, and with other zeros of the force. */
    double chi_of_series[WB_MACHINES_WIRES][WB_MACHINES_PLACES];
    double chi_of_zero[WB_MACHINES_ZEROS][WB_MACHINES_PLACES];
};

struct wb_machines_cable_results {
    int n_layers; /* 0: the campaign has no cable */
    struct wb_machines_layer layers[WB_MACHINES_LAYERS];
};

/* Fills zeroed results. */
WB_MUST_CHECK enum wb_status
wb_machines_cable_compute(struct wb_machines_cable_results *results,
                          const struct wb_machines *campaign,
                          const struct wb_machines_group_results *groups);

#endif
