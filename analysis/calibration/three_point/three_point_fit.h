/* A law fitted to one three-point bending test, with its first contact.
 *
 * Least squares (GSL multifit_nlinear, dogleg) on the force. Free are the moduli of parallel parts
 * (fe/material/law.h) at given yield strains, the travel of the first contact, the natural bow,
 * and, where there is unloading, the isotropic share. Friction, the nose's radius and the
 * machine's compliance are the caller's: the curves do not tell them (theory, "Three-point
 * bending").
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
    WB_THREE_POINT_PARTS = 7,     /* of the law, the last elastic */
    WB_THREE_POINT_MOST_FREE = 10 /* and isotropic share, natural bow, first contact */
};

/* Yield strains of the parts, spaced by logarithm. */
struct wb_three_point_strains {
    double first, last;
};

struct wb_three_point_fit_settings {
    double force_share;   /* of the largest force: a point weighs one over this or the noise */
    double modulus_prior; /* 1, of the second differences of ln(modulus) */
    double contact_prior; /* of the span: standard deviation of the first contact about the place
                             where the readings show it */
    double bow_prior;     /* of the span: the same of the natural bow about none, where the specimen
                             does not say; 0: straight */
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
    /* How far the wire's middle lies below its places on the rollers by nature (hollow upwards),
     * m. Where the readings do not tell it, its error is the prior's; 0: held. */
    double bow, bow_error;
    bool is_bow_told;
    double bow_off; /* from the middle of its prior, in the prior's standard deviations: beyond two
                       it takes up what the law cannot follow */
    double bow_contact_correlation; /* of their errors */
    bool is_converged;              /* else the iterations ran out */
    double misfit;                  /* RMS of the force residuals over F_max */
    double largest_curvature;       /* 1/m, in the middle */
    double wrapped;                 /* rad, largest */
    /* The law moved by so many standard errors in independent directions, the first contact's
     * error among them: see struct wb_cycle_fit. */
    int n_moved;
    double moved_by[WB_THREE_POINT_MOST_FREE];
    struct wb_law moved[WB_THREE_POINT_MOST_FREE];
    int runs;
    double cpu_s;
};

/* The yield strains that a test asks for. */
struct wb_three_point_strains wb_three_point_fit_strains(const struct wb_three_point_data *data);

/* `start`: a fit of the same test to begin with, or NULL; `strains` NULL: those of the test.
 * WB_ERR_CONVERGENCE where the beam does
 * not come to the end of the test; the reason goes to `why` (NULL: logged). */
WB_MUST_CHECK enum wb_status
wb_three_point_fit_run(struct wb_three_point_fit *fit, const struct wb_three_point_data *data,
                       const struct wb_three_point_bench *bench,
                       const struct wb_three_point_strains *strains,
                       const struct wb_three_point_fit *start,
                       const struct wb_three_point_fit_settings *settings, struct wb_reason *why);

#endif
