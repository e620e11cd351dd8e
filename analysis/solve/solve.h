/* Simulated tests: computes one and writes its dataset. Called by `wirebench solve`, and by the run
 * of a campaign for a missing dataset (analysis/report/missing.h).
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

/* A row of the computed curve. */
struct wb_solve_row {
    int cycle;
    enum wb_phase phase;
    double deflection, tension, force, tip_x, tip_angle; /* m, N, N, m, rad */
    bool is_spatial;  /* whether the tip may leave the plane of the test */
    double tip_z;     /* m, out of that plane */
    const char *step; /* of the model; NULL: none */
    /* Of three-point bending, whose `deflection` is the travel and whose `force` is as above; else
     * NULL. */
    const struct wb_three_point_bending_point *bending;
};

int wb_solve_count(const struct wb_solve *solve); /* number of rows */
void wb_solve_row(const struct wb_solve *solve, int index, struct wb_solve_row *row);

/* Sets what describes the computation as members of an object. */
void wb_solve_describe(const struct wb_solve *solve, struct wb_json *object);

/* Appends a summary for a terminal; false if there is nothing besides the rows. */
bool wb_solve_summarise(const struct wb_solve *solve, struct wb_text *text);

/* Prints a computed test, after its dataset was written. */
typedef enum wb_status wb_solve_show(void *context, const struct wb_solve *solve);

/* Computes the test, writes its dataset if settings->output is set, and passes it to `show` (may be
 * NULL). Logs warnings about the validity of the result. *complete is false if the curve was cut
 * short, because the solver did not converge or by an interrupt (base/interrupt.h): the rows
 * computed so far are kept. With mpirun all ranks call this; the first writes and shows, all return
 * the same. */
WB_MUST_CHECK enum wb_status wb_solve_run(const struct wb_solve_settings *settings,
                                          wb_solve_show *show, void *context, bool *complete);

/* Limits the threads of this process's linear algebra from now on. */
void wb_solve_set_threads(int n);

#endif
