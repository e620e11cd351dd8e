/* Calibration of the 1D elastoplastic beam on loading curves, section 4.1 of the paper.
 *
 * E from eq. 10, sigma_Y from eq. 11 (elastic zone and yield point are settings), n0 and K0 from
 * eqs. 12-16, then Nelder-Mead (GSL nmsimplex2) over K and n from the paper's simplex on E_L2 of
 * eq. 17, with the beam under the test's real loading and the samples' mean natural shape. E and
 * sigma_Y stay fixed during this search. K and n are in units of K0 and n0, so that both have the
 * same weight in GSL's size of the simplex.
 *
 * In a follower test, whose force stays normal to the wire's tip, deflections are compared at equal
 * forces over the whole loading: a comparison of forces at equal deflections would end at the
 * largest deflection and exclude the range beyond, in which the wire curls up. Errors are then
 * divided by the largest deflection.
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
    double elastic_zone;    /* deflection over length for eq. 10 */
    double yield_point;     /* the same for eq. 11; 0: as elastic_zone */
    double youngs_modulus;  /* Pa; given instead of eq. 10; 0: eq. 10 */
    double yield_stress;    /* Pa; given instead of eq. 11; 0: eq. 11 */
    double size_tolerance;  /* stop when the simplex' size is below, in units of (K0, n0) */
    double error_tolerance; /* stop when E_L2 is below, relative to its scale F_max sqrt(delta_max),
                               or its equivalent for a follower test */
    int max_iterations;     /* per start */
    bool straight;          /* ignore the natural shape */
    bool bow_corrected;     /* remove the bias of eqs. 10 and 11 by the samples' bows from E and
                               sigma_Y, in two iterations; false: the equations as printed */
    bool restart;           /* restart once from the optimum */
    double step;            /* m, deflection step of the comparison grid */
    double force_step;      /* N, the same of follower tests; 0: see analysis/dataset/curve.h */
    double largest_deflection; /* m: ignore the loading beyond this deflection; 0: no limit */
    int n_elements;            /* of the beam */
    int n_fibres;              /* over its diameter */
    /* Called after each iteration; may be NULL. Returns false to stop (Ctrl-C). */
    bool (*progress)(void *context, int evaluation, double error, double size);
    void *progress_context;
};

/* Where a setting is accepted or listed. */
enum {
    WB_CALIBRATE_COMMAND = 1,  /* wirebench calibrate */
    WB_CALIBRATE_VALIDATE = 2, /* wirebench validate */
    WB_CALIBRATE_CAMPAIGN = 4, /* `settings` and `fit` of campaigns */
    WB_CALIBRATE_REPORT = 8,   /* `settings` of report.json */
    WB_CALIBRATE_EVERYWHERE =
        WB_CALIBRATE_COMMAND | WB_CALIBRATE_VALIDATE | WB_CALIBRATE_CAMPAIGN | WB_CALIBRATE_REPORT
};
extern const struct wb_setting_table wb_calibrate_table;

/* Fills in the defaults; no progress. */
void wb_calibrate_default_settings(struct wb_calibrate_settings *settings);

/* The settings with the yield point that is used. */
struct wb_calibrate_settings
wb_calibrate_settings_meant(const struct wb_calibrate_settings *settings);

enum wb_calibrate_end {
    WB_CALIBRATE_SIZE,       /* the simplex is small */
    WB_CALIBRATE_ERROR,      /* the error is small */
    WB_CALIBRATE_REFINED,    /* iterations exhausted, then Gauss-Newton steps converged */
    WB_CALIBRATE_ITERATIONS, /* iterations exhausted */
    WB_CALIBRATE_STOPPED     /* by the caller */
};
const char *wb_calibrate_end_text(enum wb_calibrate_end end);
/* Whether the search converged, and was not ended by a limit or by the caller. */
bool wb_calibrate_is_complete(enum wb_calibrate_end end);

/* One evaluation of the optimiser's path. */
struct wb_calibrate_step {
    double strength_coefficient, hardening_exponent; /* Pa, 1: best vertex so far */
    double error; /* E_L2 over F_max sqrt(delta_max), or its equivalent, 1: like an RMS */
    double size;  /* simplex size */
};

struct wb_calibrate_result {
    struct wb_material material;                                 /* the calibrated law */
    struct wb_test_info info;                                    /* the test it was calibrated on */
    double first_strength_coefficient, first_hardening_exponent; /* K0, n0 */
    int n_samples;                                               /* datasets averaged */
    double max_force, max_deflection;                            /* N, m, of the averaged curve */
    double bow_spread; /* m: standard deviation of the known bows of the samples; 0 with one */
    bool bow_corrected;
    /* Standard uncertainties of E, sigma_Y, ln K, n from the scatter between samples (see
     * analysis/calibration/paper/jackknife.h); NaN with one sample. The relative uncertainty of K
     * is exp(deviation[2]). */
    double deviation[4];
    enum wb_calibrate_end end;
    bool restarted;                      /* the restart was made */
    double restart_moved;                /* largest relative change of K and n by the restart, 1 */
    int evaluations, failed_evaluations; /* beam runs; those that did not converge (penalised) */
    int n_path;
    struct wb_calibrate_step *path; /* (n_path), owned */
    int start_of_restart; /* index in path where the restart begins; n_path without a restart */
    /* Errors are over F_max, or over the largest deflection of a follower test. */
    double rms;         /* eq. 19 of the final model on the same curve */
    double max_error;   /* largest of eq. 18 */
    double scatter_rms; /* RMS over the grid of the samples' standard deviation */
    /* The same after each sample is predicted with its own natural shape: scatter of stiffness,
     * yield and measurement, and effects of bows that the model does not reproduce. */
    double residual_scatter_rms;
    double cpu_s;
};

/* Limitations of the properties, as clauses for a report: a bow whose bias of E and sigma_Y exceeds
 * their uncertainty, an exponent above 1, an optimum at a bound of the search. Returns their
 * number. */
#define WB_CALIBRATE_MOST_REMARKS 3
int wb_calibrate_remarks(const struct wb_calibrate_result *result,
                         const char *remarks[WB_CALIBRATE_MOST_REMARKS]);

/* Calibrates on the average curve of `n` datasets. WB_ERR_DATA for unusable data (yield not
 * reached, too few points, reversed sign, ...). `why` receives the reason; NULL: it is logged. */
WB_MUST_CHECK enum wb_status wb_calibrate_run(struct wb_calibrate_result *result,
                                              const struct wb_dataset *const *datasets, int n,
                                              const struct wb_calibrate_settings *settings,
                                              struct wb_reason *why);
void wb_calibrate_result_release(struct wb_calibrate_result *result);

#endif
