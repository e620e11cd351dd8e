/* A law fitted to the first cycle of one specimen, loading and unloading together.
 *
 * Least squares (GSL multifit_nlinear, Powell's dogleg) on the tension of both branches and
 * the places of the markers. Free are the law's numbers and those of the specimen: how it is bent
 * by nature, evenly and unevenly, and the level of zero deflection. Each marker sits a constant
 * distance off the axis, which is eliminated (variable projection). Points far off are weighted
 * down (Huber) and counted.
 *
 * Loading alone leaves E and the hardening rule open: a wire that yields early and hardens bends up
 * like one that is soft. The unloading tells them apart.
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

/* Free numbers of its law, without Maxwell elements. */
int wb_candidate_numbers(enum wb_candidate candidate);

enum {
    WB_FIT_PARTS = 7,     /* parallel parts, the last elastic */
    WB_FIT_MOST_LAW = 12, /* free numbers of a law */
    WB_FIT_MOST_FREE = 16 /* and of the specimen */
};

struct wb_cycle_fit_settings {
    double force_noise;  /* N: weight of a point is one over the larger of this, */
    double force_share;  /* and of this part of the largest force */
    double place_noise;  /* m, of a marker's place */
    double offset_prior; /* m: standard deviation of a marker's constant offset, */
    double level_prior;  /* m: of the level of zero deflection, */
    double uneven_prior; /* rad: of how unevenly it is bent by nature; without places it is not */
    double zero_prior;   /* N: of the zero of force; 0: it is right */
    double relaxation_prior; /* 1: of the part of the force that goes in a long dwell, of tests
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

/* Yield strains of parallel parts: spaced by logarithm from the outer fibre's strain between the
 * first two points of the data to that at the last, where the elastic part's would stand. The last
 * is also the scale of the plastic strains over which Chaboche's stresses grow. */
struct wb_cycle_grid {
    double first_strain, last_strain;
};

struct wb_cycle_fit {
    enum wb_candidate candidate;
    struct wb_law law;
    double bow_angle, bow_angle_error; /* rad */
    double level;                      /* m */
    /* Part of the level that the data determine, 0 to 1; the rest is its prior. The data alone put
     * it at level / level_share, with this standard error (m). NaN unknown. */
    double level_share, level_error;
    double zero;         /* N: what the cell shows too much; 0 where it is right */
    double uneven_angle; /* rad; 0 without places */
    bool is_converged;   /* else the iterations ran out */
    bool is_at_bound;    /* an exponent or a share at the end of its range */
    bool is_contained;   /* the fit near by is the best: nothing was searched; only the candidate,
                            counts and cost are set */
    double misfit;       /* RMS of the force residuals over the largest force, */
    double loading_misfit, unloading_misfit; /* of either branch; NaN: none */
    double place_rms;                        /* m, after the markers' offsets; NaN without places */
    double ln_strength_error, exponent_error; /* standard errors of Ludwik's ln K and n by this
                                                 specimen's own residuals; NaN of parallel parts */
    /* The law moved a little in each of independent directions, by this many standard errors. What
     * is computed with it has a variance: the sum of the squares of its differences over these.
     * None where that could not be found. */
    int n_moved;
    double moved_by[WB_FIT_MOST_FREE];
    struct wb_law moved[WB_FIT_MOST_FREE];
    /* The law and the specimen that the fit would come to if what all specimens share were larger
     * by wb_cycle_shared_change(), to first order: wb_cycle_fit_find_altered(). */
    bool has_altered[WB_SHARED];
    struct wb_law altered[WB_SHARED];
    struct wb_cycle_specimen altered_specimen[WB_SHARED];
    /* How the law's numbers hang together in this fit: of ln E, ln sigma_Y, ln K and n, of the
     * parts' moduli, or of the logarithms of Chaboche's; then of the isotropic share where that is
     * free. NaN unknown. */
    int n_numbers;
    double correlation[WB_FIT_MOST_LAW][WB_FIT_MOST_LAW];
    double clamp_curvature; /* 1/m, largest */
    double first_curvature; /* 1/m, at the first point */
    double turn_change;     /* 1/m, of it from the turn to the first point of the unloading */
    double turn_miss;       /* part of the force's change just behind the turn that the law misses,
                               more than 0 where it is too soft; NaN: not known */
    int n_free, n_law;      /* numbers fitted; of them the law's */
    int n_outliers;         /* points weighted by less than half */
    double scale_of_misses; /* larger than 1 where the law does not follow: weights of forces */
    int runs, iterations;
    double cpu_s;
    /* (data->n_points) computed tension of the last run, N; owned; NULL where it failed */
    double *tension;
    /* What wb_cycle_fit_find_altered() goes on from; owned; NULL of a copy and of no fit. */
    struct wb_cycle_search *search;
};

/* Fits one candidate. `start` gives a law near by; `near` a fit of another law to the same data,
 * whose specimen and weights are near by (NULL: none). Where the candidate is near's law with an
 * isotropic share, and `start` is near's law, the fit ends at once as is_contained if Gauss and
 * Newton's step keeps the share at its end. `grid` is used by parallel parts and Chaboche's laws
 * (NULL: none of them). Without unloading only WB_CANDIDATE_LUDWIK_ISOTROPIC can be fitted. `data`
 * is borrowed as long as the fit is. WB_ERR_CONVERGENCE where the beam cannot compute the start;
 * `why` receives it, NULL: logged. */
WB_MUST_CHECK enum wb_status
wb_cycle_fit_run(struct wb_cycle_fit *fit, const struct wb_cycle_data *data,
                 enum wb_candidate candidate, const struct wb_law *start,
                 const struct wb_cycle_fit *near, const struct wb_cycle_grid *grid,
                 const struct wb_cycle_fit_settings *settings, struct wb_reason *why);

/* Finds what is altered, by a run of the beam for each thing that specimens share. Of a fit with
 * its search: one of wb_cycle_fit_run() that is not is_contained. */
void wb_cycle_fit_find_altered(struct wb_cycle_fit *fit);

/* "E", "part 3", "isotropic share": number `i` of the correlations. */
const char *wb_cycle_fit_number(const struct wb_cycle_fit *fit, int i, char text[24]);

/* The pair of numbers that hang together most; false where that is not known. */
bool wb_cycle_fit_strongest(const struct wb_cycle_fit *fit, int *one, int *other);

/* The natural shape of a fitted specimen of a length, m: offset of the tip, its standard error, and
 * how far the middle lies off that of an even curvature. */
struct wb_cycle_bow {
    double tip, deviation, uneven;
};
struct wb_cycle_bow wb_cycle_fit_bow(const struct wb_cycle_fit *fit, double length);

void wb_cycle_fit_release(struct wb_cycle_fit *fit); /* accepts a zeroed one */

#endif
