/* The results of a comparison of wires: its datasets read and checked, the properties of a 1D rod
 * fitted to the solid, and the rods that are computed for comparison.
 */
#ifndef WB_ANALYSIS_REPORT_WIRES_WIRES_RESULTS_H
#define WB_ANALYSIS_REPORT_WIRES_WIRES_RESULTS_H

#include <stdbool.h>

#include "analysis/calibration/paper/calibrate.h"
#include "analysis/report/kind.h"
#include "analysis/report/verdict.h"
#include "analysis/report/wires/wires_run.h"

/* Largest von Mises stress of a part on a section. */
struct wb_wires_peak {
    double stress;       /* Pa; NaN: no such part */
    double reference[3]; /* m, on the straight wire */
    double position[3];  /* m */
};

/* A cross section of the elastic solid beside beam theory. */
struct wb_wires_stress {
    double x; /* m */
    struct wb_wires_peak core, jacket;
    double curvature; /* 1/m, of the exact rod */
    double beam;      /* Pa: E kappa r of the core's outer fibre */
};

#define WB_WIRES_STRESSES 8

struct wb_wires_results {
    struct wb_kind_outcome outcome;
    const struct wb_wires *comparison; /* borrowed */
    struct wb_wires_run runs[WB_WIRES_CASES][WB_WIRES_SOLVERS];
    struct wb_wires_rod exact; /* elastic */

    int n_stresses;
    struct wb_wires_stress stresses[WB_WIRES_STRESSES];

    enum wb_simulation_state fit_state; /* refused: the calibration failed */
    struct wb_text fit_problem;
    struct wb_calibrate_result fit;
    struct wb_wires_rod fitted;  /* the rod with the fitted properties */
    struct wb_wires_rod printed; /* with the printed ones; not done: none are */
    struct wb_wires_rod tenfold; /* with ten times the printed strength coefficient */
    double collapse_force;       /* N: of the printed yield stress, without hardening */
};

/* Every case's solid, then its rod; of struct wb_wires_results. */
wb_simulation_list wb_wires_results_list;

/* Reads and checks the datasets; then computes the rods for comparison. */
wb_kind_load wb_wires_results_load;
wb_kind_compute wb_wires_results_compute;
wb_kind_release wb_wires_results_release;

/* A run that is usable, else NULL; of a case its solid, and its rod. */
const struct wb_wires_run *wb_wires_usable(const struct wb_wires_results *results, int index,
                                           enum wb_wires_solver solver);
const struct wb_wires_run *wb_wires_solid_run(const struct wb_wires_results *results, int index);
const struct wb_wires_run *wb_wires_rod_run(const struct wb_wires_results *results, int index);

enum {
    WB_WIRES_VERDICTS = 4
};

/* Verdicts of the campaign's limits on the usable results. Returns their number: of the tips of
 * the elastic solid and rod, of the elastic stress that differs most, and of the elastic rod's
 * cost.
 */
int wb_wires_results_judge(const struct wb_wires_results *results,
                           struct wb_verdict verdicts[WB_WIRES_VERDICTS]);

/* CPU seconds of the rod over the solid's; NaN unless both are used and known. */
double wb_wires_cost(const struct wb_wires_results *results, int index);

/* Largest residual stress of the solids' cores on the drawn section, Pa, and the most by which it
 * moves their tips, m; false: not known. */
bool wb_wires_residual(const struct wb_wires_results *results, double *stress, double *moved);

/* By how much E of the jacket moves when that of the core moves by a part `change` and the
 * effective modulus of eq. 8 stays, Pa. */
double wb_wires_split(const struct wb_wire_model *model, double change);

/* The peak of a part (0 core, 1 jacket) on a field. */
struct wb_wires_peak wb_wires_find_peak(const struct wb_field *field, int part);

#endif
