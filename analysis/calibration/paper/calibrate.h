/* Calibration of the 1D elastoplastic beam against loading curves, section 4.1 of the paper.
 *
 * E from eq. 10, sigma_Y from eq. 11 (elastic zone and yield point are settings), n0 and K0 from
 * eqs. 12-16, then Nelder-Mead (GSL nmsimplex2) over K and n from the paper's simplex on E_L2 of
 * eq. 17, with the beam under the test's real loading and the samples' mean natural shape. E and
 * sigma_Y stay fixed meanwhile. K and n are sought in units of K0 and n0, so that GSL's size of
 * the simplex counts both alike.
 *
 * In a follower test, whose force stays normal to the wire's tip, deflections are compared at equal
 * forces over the whole of the loading: forces at equal deflections would end short of the largest
 * deflection and leave out how the wire curls up beyond it. Errors are then divided by the largest
 * deflection.
 */
#ifndef WB_ANALYSIS_CALIBRATION_PAPER_CALIBRATE_H
#define WB_ANALYSIS_CALIBRATION_PAPER_CALIBRATE_H

#include <stdbool.h>

#include "analysis/dataset/dataset.h"
#include "base/reason.h"
#include "base/setting.h"
#include "base/status.h"
#include "fe/material/material.h"

/* Settings of calibration and of validation. Defaults and ranges: wb_calibrate_table. */
struct wb_calibrate_settings {
    double elastic_zone;       /* deflection over length for eq. 10 */
    double yield_point;        /* the same for eq. 11; 0: as elastic_zone */
    double youngs_modulus;     /* Pa; given instead of eq. 10; 0: eq. 10 */
    double yield_stress;       /* Pa; given instead of eq. 11; 0: eq. 11 */
    double size_tolerance;     /* stop when the simplex' size is below, in units of (K0, n0) */
    double error_tolerance;    /* stop when E_L2 is below, relative to its scale F_max
                                  sqrt(delta_max), or its like of a follower test */
    int max_iterations;        /* per start */
    bool straight;             /* ignore the natural shape */
    bool bow_corrected;        /* take what the samples' bows make of eqs. 10 and 11 out of E and
                                  sigma_Y, two passes; false: the equations as printed */
    bool restart;              /* restart once from the optimum */
    double step;               /* m, deflection step of the comparison grid */
    double force_step;         /* N, the same of follower tests; 0: see analysis/curve.h */
    double largest_deflection; /* m: what comes later in the loading is left out; 0: nothing */
    int n_elements;            /* of the beam */
    int n_fibres;              /* over its diameter */
    /* Called after each iteration; may be NULL. Returns false to stop (Ctrl-C). */
    bool (*progress)(void *context, int evaluation, double error, double size);
    void *progress_context;
};

/* Where a setting may be given, or is named. */
enum {
    WB_CALIBRATE_COMMAND = 1,  /* wirebench calibrate */
    WB_CALIBRATE_VALIDATE = 2, /* wirebench validate */
    WB_CALIBRATE_CAMPAIGN = 4, /* `settings` and `fit` of campaigns */
    WB_CALIBRATE_REPORT = 8    /* `settings` of report.json */
};
extern const struct wb_setting_table wb_calibrate_table;

/* Fills in the defaults; no progress. */
void wb_calibrate_default_settings(struct wb_calibrate_settings *settings);

/* The settings with the yield point that they mean. */
struct wb_calibrate_settings
wb_calibrate_settings_meant(const struct wb_calibrate_settings *settings);

enum wb_calibrate_end {
    WB_CALIBRATE_SIZE,       /* the simplex became small */
    WB_CALIBRATE_ERROR,      /* the error became small */
    WB_CALIBRATE_REFINED,    /* the iterations ran out, then Gauss-Newton steps settled */
    WB_CALIBRATE_ITERATIONS, /* the iterations ran out */
    WB_CALIBRATE_STOPPED     /* by the caller */
};
const char *wb_calibrate_end_text(enum wb_calibrate_end end);
/* Whether the search ended by itself: not by a limit or by the caller. */
bool wb_calibrate_is_complete(enum wb_calibrate_end end);

/* One evaluation of the optimiser's path. */
struct wb_calibrate_step {
    double strength_coefficient, hardening_exponent; /* Pa, 1: best vertex so far */
    double error; /* E_L2 over F_max sqrt(delta_max), or its like, 1: comparable with an RMS */
    double size;  /* simplex size */
};

struct wb_calibrate_result {
    struct wb_material material;                                 /* the calibrated law */
    struct wb_test_info info;                                    /* the test it was calibrated on */
    double first_strength_coefficient, first_hardening_exponent; /* K0, n0 */
    int n_samples;                                               /* datasets averaged */
    double max_force, max_deflection;                            /* N, m, of the averaged curve */
    double bow_spread; /* m: standard deviation of the samples' bows, as far as known; 0 with one */
    bool bow_corrected;
    /* Standard uncertainties of E, sigma_Y, ln K, n from the scatter between samples (see
     * analysis/jackknife.h); NaN with one sample. K is within a factor of exp(deviation[2]). */
    double deviation[4];
    enum wb_calibrate_end end;
    bool restarted;                      /* the restart was made */
    double restart_moved;                /* largest relative change of K and n by the restart, 1 */
    int evaluations, failed_evaluations; /* beam runs; of them not converged (penalised) */
    int n_path;
    struct wb_calibrate_step *path; /* (n_path), owned */
    int start_of_restart; /* index in path where the restart begins; n_path when there was none */
    /* Errors are over F_max, or over the largest deflection of a follower test. */
    double rms;         /* eq. 19 of the final model on the same curve */
    double max_error;   /* largest of eq. 18 */
    double scatter_rms; /* RMS over the grid of the samples' standard deviation */
    /* The same of what is left when each sample is predicted with its own natural shape: scatter of
     * stiffness, yield and measurement, and what the model does not follow of the bows. */
    double residual_scatter_rms;
    double cpu_s;
};

/* What a reader of the properties should know, as sentences without an end: a bow that biases E and
 * sigma_Y beyond their uncertainty, an exponent above 1, an end at a bound of the search. Returns
 * how many there are. */
#define WB_CALIBRATE_MOST_REMARKS 3
int wb_calibrate_remarks(const struct wb_calibrate_result *result,
                         const char *remarks[WB_CALIBRATE_MOST_REMARKS]);

/* Calibrates on the average curve of `n` datasets. Unusable data (yield not reached, too few
 * points, reversed sign, ...) is WB_ERR_DATA. `why` receives why it failed; NULL: that is logged.
 */
WB_MUST_CHECK enum wb_status wb_calibrate_run(struct wb_calibrate_result *result,
                                              const struct wb_dataset *const *datasets, int n,
                                              const struct wb_calibrate_settings *settings,
                                              struct wb_reason *why);
void wb_calibrate_result_release(struct wb_calibrate_result *result);

#endif
