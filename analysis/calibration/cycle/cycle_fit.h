/* A law fitted to the first cycle of one specimen, loading and unloading together.
 *
 * Least squares (GSL multifit_nlinear, Powell's dogleg) on the tension of both branches and the
 * places of the markers. Free are the parameters of the law and of the specimen: its natural
 * curvature, even and uneven, and the level of zero deflection. The constant distance of each
 * marker from the axis is eliminated (variable projection). Outliers get smaller weights (Huber)
 * and are counted.
 *
 * Loading alone does not determine E and the hardening rule: a wire that yields early and hardens
 * has the same loading curve as a softer one. They differ in unloading.
 */
#ifndef WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_FIT_H
#define WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_FIT_H

#include <stdbool.h>

#include "analysis/calibration/cycle/cycle_data.h"
#include "analysis/calibration/cycle/cycle_model.h"
#include "analysis/calibration/cycle/cycle_shared.h"
#include "base/reason.h"
#include "base/setting.h"
#include "base/status.h"
#include "fe/material/law.h"

/* Laws that may be fitted: Ludwik's, parallel parts, then most of those with combined hardening. */
enum wb_candidate {
    WB_CANDIDATE_LUDWIK_ISOTROPIC,
    WB_CANDIDATE_LUDWIK_KINEMATIC,
    WB_CANDIDATE_LUDWIK_MIXED,
    WB_CANDIDATE_PARALLEL_KINEMATIC,
    WB_CANDIDATE_PARALLEL_MIXED,
    WB_CANDIDATE_LUDWIK_COMBINED,
    WB_CANDIDATE_CHABOCHE_ONE, /* one back stress, and a yield stress that grows */
    WB_CANDIDATE_CHABOCHE_TWO,
    WB_CANDIDATE_PARALLEL_COMBINED, /* the parts' limits grow */
    WB_CANDIDATES
};

/* "Ludwik, isotropic", ... */
const char *wb_candidate_name(enum wb_candidate candidate);

/* Number of free parameters of its law, without Maxwell elements. */
int wb_candidate_numbers(enum wb_candidate candidate);

enum {
    WB_FIT_PARTS = 7,     /* parallel parts, the last elastic */
    WB_FIT_MOST_LAW = 12, /* free parameters of a law */
    WB_FIT_MOST_FREE = 16 /* and of law and specimen */
};

struct wb_cycle_fit_settings {
    double force_noise;  /* N: weight of a point is one over the larger of this, */
    double force_share;  /* and of this part of the largest force */
    double place_noise;  /* m, of a marker's place */
    double offset_prior; /* m: standard deviation of a marker's constant offset, */
    double level_prior;  /* m: of the level of zero deflection, */
    double uneven_prior; /* rad: of the uneven natural curvature, which is zero without places */
    double zero_prior;   /* N: of the zero of force; 0: the zero is fixed */
    double relaxation_prior; /* 1: of the part of the force that relaxes in a long dwell, for tests
                                without one */
    double modulus_prior;    /* 1: of the second difference of ln(modulus) of parts that yield */
    int n_elements;          /* while searching */
    int n_final_elements;    /* of the last run */
    int n_fibres;            /* over the diameter */
    int max_iterations;
    int n_maxwell; /* Maxwell elements beside the law, 0 to 2; more than 0 needs a dwell */
};
/* Their rows, with range and default. */
enum {
    WB_CYCLE_FIT_ROWS = 12
};
extern const struct wb_setting wb_cycle_fit_rows[WB_CYCLE_FIT_ROWS];
void wb_cycle_fit_default_settings(struct wb_cycle_fit_settings *settings);

/* Range of yield strains of parallel parts, spaced logarithmically: from the strain of the outer
 * fibre between the first two points of the data to that at the last point, which is the place of
 * the elastic part. The last one is also the scale of the plastic strains over which Chaboche's
 * stresses grow. */
struct wb_cycle_grid {
    double first_strain, last_strain;
};

struct wb_cycle_fit {
    enum wb_candidate candidate;
    struct wb_law law;
    double bow_angle, bow_angle_error; /* rad */
    double level;                      /* m */
    /* Part of the level that the data determine, 0 to 1; the rest is its prior. Without the prior
     * the level is level / level_share, with this standard error (m). NaN: unknown. */
    double level_share, level_error;
    double zero;         /* N: error of the cell's reading at zero; 0 if the zero is fixed */
    double uneven_angle; /* rad; 0 without places */
    bool is_converged;   /* else the iterations ran out */
    bool is_at_bound;    /* an exponent or a share at the end of its range */
    bool is_contained;   /* the fit `near` is the best one: no search was made; only the candidate,
                            counts and cost are set */
    double misfit;       /* RMS of the force residuals over the largest force, */
    double loading_misfit, unloading_misfit; /* of either branch; NaN: none */
    double place_rms;                        /* m, after the markers' offsets; NaN without places */
    double ln_strength_error, exponent_error; /* standard errors of Ludwik's ln K and n by this
                                                 specimen's own residuals; NaN of parallel parts */
    /* Laws moved in independent directions of the covariance, by this many standard errors. The
     * variance of a result of the law is the sum of the squares of its differences over these
     * numbers. 0 if unknown. */
    int n_moved;
    double moved_by[WB_FIT_MOST_FREE];
    struct wb_law moved[WB_FIT_MOST_FREE];
    /* Law and specimen of the fit, to first order, if a quantity that all specimens share were
     * larger by wb_cycle_shared_change(): see wb_cycle_fit_find_altered(). */
    bool has_altered[WB_SHARED];
    struct wb_law altered[WB_SHARED];
    struct wb_cycle_specimen altered_specimen[WB_SHARED];
    /* Correlations of the law's parameters in this fit: of ln E, ln sigma_Y, ln K and n, of the
     * parts' moduli, or of the logarithms of Chaboche's parameters; then of the isotropic share if
     * it is free. NaN: unknown. */
    int n_numbers;
    double correlation[WB_FIT_MOST_LAW][WB_FIT_MOST_LAW];
    double clamp_curvature; /* 1/m, largest */
    double first_curvature; /* 1/m, at the first point */
    double turn_change;     /* 1/m: change of curvature from the turn to the first point of the
                               unloading */
    double turn_miss;  /* relative error of the force's change just after the turn, positive if the
                          law is too soft; NaN: unknown */
    int n_free, n_law; /* free parameters; of them those of the law */
    int n_outliers;    /* points weighted by less than half */
    double
        scale_of_misses; /* larger than 1 for a systematic misfit: divides the weights of forces */
    int runs, iterations;
    double cpu_s;
    /* (data->n_points) computed tension of the last run, N; owned; NULL if it failed */
    double *tension;
    /* State for wb_cycle_fit_find_altered(); owned; NULL in a copy and without a fit. */
    struct wb_cycle_search *search;
};

/* Fits one candidate. `start` is the initial guess of the law; `near` a fit of another law to the
 * same data, which gives the initial guess of specimen and weights (NULL: none). If the candidate
 * is the law of `near` with an isotropic share, and `start` is that law, the fit ends at once as
 * is_contained if a Gauss-Newton step keeps the share at the end of its range. `grid` is used by
 * parallel parts and Chaboche's laws (NULL for others). Without unloading only
 * WB_CANDIDATE_LUDWIK_ISOTROPIC can be fitted. `data` is borrowed while the fit exists.
 * WB_ERR_CONVERGENCE if the beam cannot compute the start; `why` receives the reason, NULL: it is
 * logged. */
WB_MUST_CHECK enum wb_status
wb_cycle_fit_run(struct wb_cycle_fit *fit, const struct wb_cycle_data *data,
                 enum wb_candidate candidate, const struct wb_law *start,
                 const struct wb_cycle_fit *near, const struct wb_cycle_grid *grid,
                 const struct wb_cycle_fit_settings *settings, struct wb_reason *why);

/* Sets altered laws and specimens, with one run of the beam for each shared quantity. Only for a
 * fit with its search: one of wb_cycle_fit_run() that is not is_contained. */
void wb_cycle_fit_find_altered(struct wb_cycle_fit *fit);

/* Name of parameter `i` of the correlations: "E", "part 3", "isotropic share". */
const char *wb_cycle_fit_number(const struct wb_cycle_fit *fit, int i, char text[24]);

/* The most strongly correlated pair of parameters; false if unknown. */
bool wb_cycle_fit_strongest(const struct wb_cycle_fit *fit, int *one, int *other);

/* Natural shape of a fitted specimen of a length (m): offset of the tip, its standard error, and
 * the offset of the middle from the shape of even curvature, m. */
struct wb_cycle_bow {
    double tip, deviation, uneven;
};
struct wb_cycle_bow wb_cycle_fit_bow(const struct wb_cycle_fit *fit, double length);

void wb_cycle_fit_release(struct wb_cycle_fit *fit); /* accepts a zeroed one */

#endif
