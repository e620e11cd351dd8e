/* States of a bundle that are kept during its computation: VTK files, and the surface at the
 * largest deflection. */
#ifndef WB_ANALYSIS_SOLVE_BUNDLE_STATES_H
#define WB_ANALYSIS_SOLVE_BUNDLE_STATES_H

#include <stdbool.h>

#include "analysis/dataset/surface.h"
#include "analysis/solve/solve_time.h"
#include "base/status.h"
#include "fe/bundle/bundle_run.h"
#include "fe/output/bundle_fields.h"
#include "fe/output/bundle_vtk.h"

struct wb_bundle_states {
    bool wants_surface, wants_vtk; /* set by the caller */
    int every;                     /* rows between VTK files; from 1 */
    int turn; /* rows from one turn of the loading to the next; turns have files too */
    struct wb_vtk_file_series *series; /* the caller's */
    /* The members below are filled in by wb_bundle_states_take(). */
    int attempt;
    bool has_fields;
    struct wb_bundle_fields fields;
    struct wb_surface surface;  /* without bodies: not taken yet */
    double deflection;          /* m, of the surface */
    struct wb_solve_time spent; /* time spent on fields and files */
};

/* Keeps or writes the requested states of a row; called by wb_bundle_observer's `place`. */
WB_MUST_CHECK enum wb_status wb_bundle_states_take(struct wb_bundle_states *states,
                                                   const struct wb_bundle_result *result,
                                                   const struct wb_bundle_row *row,
                                                   const struct wb_bundle *bundle);
/* Saves or restores the struct; called by wb_bundle_observer's `visit`. */
void wb_bundle_states_visit(struct wb_bundle_states *states, struct wb_checkpoint *checkpoint);
void wb_bundle_states_release(struct wb_bundle_states *states); /* accepts a zeroed one */

#endif
