/* Simulated tests: computes one and writes its dataset. `wirebench solve` calls this, and so does
 * the run of a campaign that misses a dataset (analysis/report/missing.h).
 *
 * Typical use:
 *
 *     struct wb_solve_settings settings = {.kind = WB_SOLVE_BUNDLE, .output = "7-type3"};
 *     wb_setting_fill(&wb_solve_settings_table, &settings);
 *     settings.model = "7-type3";
 *     status = wb_solve_run(&settings, NULL, NULL, &complete);
 */
#ifndef WB_ANALYSIS_SOLVE_SOLVE_H
#define WB_ANALYSIS_SOLVE_SOLVE_H

#include <stdbool.h>

#include "analysis/solve/solve_settings.h"
#include "base/json.h"
#include "base/status.h"
#include "base/text.h"
#include "fe/linear/trial.h"
#include "fe/trial/three_point_bending.h"

struct wb_solve; /* opaque; a computed test */

/* A row of its curve. */
struct wb_solve_row {
    int cycle;
    enum wb_phase phase;
    double deflection, tension, force, tip_x, tip_angle; /* m, N, N, m, rad */
    bool
        is_spatial; /* the model is one in space, and the tip may leave the plane of the test by: */
    double tip_z;   /* m */
    const char *step;                                   /* of the model; NULL: it has none */
    const struct wb_three_point_bending_point *bending; /* of three-point bending, with deflection
                                                 of the travel and force as above; else NULL */
};

int wb_solve_count(const struct wb_solve *solve); /* of its rows */
void wb_solve_row(const struct wb_solve *solve, int index, struct wb_solve_row *row);

/* How it was computed, as members of an object. */
void wb_solve_describe(const struct wb_solve *solve, struct wb_json *object);

/* What it comes to, as text for a terminal; false: nothing but its rows. */
bool wb_solve_summarise(const struct wb_solve *solve, struct wb_text *text);

/* Shows a computed test, after its dataset was written. */
typedef enum wb_status wb_solve_show(void *context, const struct wb_solve *solve);

/* Computes the test, writes its dataset if settings->output is set, and lets `show` (may be NULL)
 * look at it; warns of what its reader must know. *complete is false when the curve was cut short,
 * because the solver did not converge or by an interrupt (base/interrupt.h): what was computed is
 * there. With mpirun all ranks call this, the first writes and shows, all return the same. */
WB_MUST_CHECK enum wb_status wb_solve_run(const struct wb_solve_settings *settings,
                                          wb_solve_show *show, void *context, bool *complete);

/* Threads that the linear algebra of this process may use from now on. */
void wb_solve_set_threads(int n);

#endif
