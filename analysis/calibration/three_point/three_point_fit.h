/* Fit of a law to one three-point bending test, with its first contact.
 *
 * Least squares (GSL multifit_nlinear, dogleg) on the force. Free parameters are the moduli of
 * parallel parts (fe/material/law.h) at given yield strains, the travel of the first contact, the
 * natural bow, and, with an unloading, the isotropic share. Friction, the nose's radius and the
 * machine's compliance are given by the caller: the curves do not determine them (theory,
 * "Three-point bending").
 */
#ifndef WB_ANALYSIS_CALIBRATION_THREE_POINT_THREE_POINT_FIT_H
#define WB_ANALYSIS_CALIBRATION_THREE_POINT_THREE_POINT_FIT_H

#include <stdbool.h>

#include "analysis/calibration/three_point/three_point_data.h"
#include "analysis/calibration/three_point/three_point_model.h"
#include "base/reason.h"
#include "base/setting.h"
#include "base/status.h"
#include "fe/material/law.h"

enum {
    WB_THREE_POINT_PARTS = 7,     /* parts of the law, the last one elastic */
    WB_THREE_POINT_MOST_FREE = 10 /* with isotropic share, natural bow, first contact */
};

/* Yield strains of the parts, with logarithmic spacing. */
struct wb_three_point_strains {
    double first, last;
};

struct wb_three_point_fit_settings {
    double force_share; /* of the largest force: the error of a point is the larger of this and the
                           noise */
    double modulus_prior; /* 1, of the second differences of ln(modulus) */
    double contact_prior; /* of the span: standard deviation of the first contact about its initial
                             guess */
    double bow_prior;     /* of the span: standard deviation of the natural bow about zero, if the
                             specimen file gives none; 0: straight */
    int n_elements;       /* of half the wire */
    int max_iterations;
};
enum {
    WB_THREE_POINT_FIT_ROWS = 6
};
extern const struct wb_setting wb_three_point_fit_rows[WB_THREE_POINT_FIT_ROWS];

struct wb_three_point_fit {
    struct wb_law law;
    double first_contact, first_contact_error; /* m of travel */
    /* Distance of the unloaded wire's middle below the line between its points on the rollers
     * (positive: hollow upwards), m. If the readings do not determine it, its error is that of the
     * prior; 0: fixed. */
    double bow, bow_error;
    bool is_bow_identifiable;
    double bow_off; /* distance from the middle of its prior, in the prior's standard deviations:
                       above two, it probably compensates an error of the law */
    double bow_contact_correlation; /* of their errors */
    bool is_converged;              /* else the iterations were exhausted */
    double misfit;                  /* RMS of the force residuals over F_max */
    double largest_curvature;       /* 1/m, at midspan */
    double wrapped;                 /* largest wrap angle of the nose, rad */
    /* Laws moved by moved_by[i] standard errors in independent directions, which include the first
     * contact's error: see struct wb_cycle_fit. */
    int n_moved;
    double moved_by[WB_THREE_POINT_MOST_FREE];
    struct wb_law moved[WB_THREE_POINT_MOST_FREE];
    double cpu_s;
};

/* The yield strains for a test. */
struct wb_three_point_strains wb_three_point_fit_strains(const struct wb_three_point_data *data);

/* Fits a test. `start`: a fit of the same test as initial guess, or NULL; `strains` NULL: those of
 * the test. WB_ERR_CONVERGENCE if the beam does not reach the end of the test; `why` receives the
 * reason (NULL: logged). */
WB_MUST_CHECK enum wb_status
wb_three_point_fit_run(struct wb_three_point_fit *fit, const struct wb_three_point_data *data,
                       const struct wb_three_point_bench *bench,
                       const struct wb_three_point_strains *strains,
                       const struct wb_three_point_fit *start,
                       const struct wb_three_point_fit_settings *settings, struct wb_reason *why);

#endif
