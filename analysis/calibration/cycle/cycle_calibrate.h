/* Calibration of one wire on whole cycles: selects the law and the hardening rule that the
 * specimens support, and states its results with their uncertainty.
 *
 * Each specimen is fitted separately with each candidate (cycle_fit.h). A candidate's misfit is the
 * root mean square of its force residuals on loading and unloading over F_max, pooled over the
 * specimens. The candidates are weighted by Schwarz's criterion; the one of the largest weight is
 * chosen.
 *
 * The 95 % interval of a result combines the scatter between specimens, the uncertainty of the
 * fits, the weighted distance of the other laws from the chosen one, and the stated uncertainties
 * of gain, length, counterweight, density, marker offset and diameter, whose errors all specimens
 * share and the data cannot show (cycle_budget.h). The range of the result over all candidates with
 * a misfit of at most twice the best is given as well.
 */
#ifndef WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_CALIBRATE_H
#define WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_CALIBRATE_H

#include <stdbool.h>

#include "analysis/calibration/cycle/cycle_data.h"
#include "analysis/calibration/cycle/cycle_fit.h"
#include "analysis/calibration/law/bending.h"
#include "analysis/dataset/dataset.h"
#include "base/reason.h"
#include "base/setting.h"
#include "base/status.h"

enum {
    WB_CYCLE_MOMENTS = 5,
    WB_CYCLE_STIFFNESSES = 4 /* at most */
};

/* 1/m: where stiffness is reported, beside the smallest curvature that the data resolve. */
extern const double wb_cycle_stiffness_curvatures[WB_CYCLE_STIFFNESSES - 1];

/* Deflection over length that K and n need. */
#define WB_CYCLE_SMALLEST_TRAVEL 0.35

/* Parts of the largest curvature at which the moment is reported. */
extern const double wb_cycle_moment_parts[WB_CYCLE_MOMENTS];

/* A result with its interval. */
struct wb_estimate {
    double value;                           /* exp of the mean of ln over specimens */
    double low, high;                       /* interval of 95 % */
    double candidates_low, candidates_high; /* over the candidates that cannot be excluded */
    double deviation;                       /* s of ln over specimens (or pooled); NaN: unknown */
};

/* Contributions to an uncertainty. */
enum wb_contribution {
    WB_FROM_SPECIMENS, /* their scatter; unknown with one specimen */
    WB_FROM_FIT,       /* noise, priors, and misfit of the law */
    WB_FROM_LAW,       /* other laws that the data do not exclude */
    WB_FROM_SHARED,    /* the first of enum wb_cycle_shared, in its order */
    WB_CONTRIBUTIONS = WB_FROM_SHARED + WB_SHARED
};

/* Uncertainty budget of a result's logarithm. */
struct wb_budget {
    double uncertainty[WB_CONTRIBUTIONS]; /* standard; NaN: not known, and not in the others */
    double degrees[WB_CONTRIBUTIONS];     /* of freedom */
    double effect[WB_SHARED]; /* sensitivity per relative change of a shared quantity; of the
                                 markers per m */
    double combined, effective_degrees;
    double factor; /* coverage factor of the combined one for 95 % */
};

/* Stiffness at n curvatures, ascending: the stated ones, and the smallest one that the data of all
 * specimens resolve. Below it, the stiffness is an extrapolation by the law. */
struct wb_cycle_stiffness {
    int n;
    double resolved;                                   /* 1/m */
    double curvature[WB_CYCLE_STIFFNESSES];            /* 1/m */
    struct wb_estimate estimate[WB_CYCLE_STIFFNESSES]; /* N m2 */
};

/* Results of a law, and of a specimen with this law. */
enum wb_cycle_number {
    WB_CYCLE_RIGIDITY,           /* EI at curvature zero, N m2 */
    WB_CYCLE_RESIDUAL_CURVATURE, /* 1 */
    WB_CYCLE_LOOP_ENERGY,        /* J/m */
    WB_CYCLE_SPRINGBACK,         /* of the deflection, 1 */
    WB_CYCLE_FIRST_MOMENT,       /* N m */
    WB_CYCLE_FIRST_SECANT = WB_CYCLE_FIRST_MOMENT + WB_CYCLE_MOMENTS, /* N m2 */
    WB_CYCLE_FIRST_UNLOADING = WB_CYCLE_FIRST_SECANT + WB_CYCLE_STIFFNESSES,
    WB_CYCLE_NUMBERS = WB_CYCLE_FIRST_UNLOADING + WB_CYCLE_STIFFNESSES
};

/* Results of a candidate for one specimen. */
struct wb_cycle_answer {
    bool is_fitted;
    enum wb_candidate origin; /* candidate that was fitted: this one, or one that it contains */
    struct wb_cycle_fit fit;
    double value[WB_CYCLE_NUMBERS]; /* 0 where no such curvature exists */
    /* Standard errors of the logarithms from the residuals of the fit; 0 for candidates that do not
     * count. */
    double error[WB_CYCLE_NUMBERS];
    /* Sensitivities of the logarithms to the quantities that all specimens share; NaN: unknown; 0
     * for candidates that are not chosen. */
    double effect[WB_SHARED][WB_CYCLE_NUMBERS];
};

/* Largest misfit of a law that describes a wire. */
#define WB_CYCLE_LARGEST_FOLLOWED 3e-2

struct wb_cycle_member {
    int sample;
    struct wb_cycle_data data;
    struct wb_cycle_answer answers[WB_CANDIDATES];
    struct wb_material ludwik; /* equivalent: the same moments on a first loading */
    double ludwik_misfit;      /* 1, RMS of ln M */
    struct wb_reason why;      /* if nothing could be fitted */
    double cpu_s;
};

struct wb_cycle_rank {
    enum wb_candidate candidate;
    bool is_fitted; /* for all specimens */
    double misfit;
    double weight;
    bool counts; /* misfit at most twice the best, or chosen: its results are in the ranges */
    int n_free;  /* parameters of the law */
    struct wb_estimate rigidity, residual_curvature_ratio; /* without the ranges */
    struct wb_law law; /* means over the specimens, as for the chosen one */
};

struct wb_cycle_calibration {
    int n_members;
    struct wb_cycle_member *members; /* (n_members), owned */
    bool has_unloading;
    double repeat_noise;                        /* standard error of a point over F_max */
    struct wb_cycle_rank ranked[WB_CANDIDATES]; /* best first; those not fitted last */
    int n_ranked;
    enum wb_candidate chosen;
    double n_independent; /* independent residuals of a specimen with the best law */
    bool is_followed;     /* the best misfit is at most 3 %, and unloading was fitted */
    /* `progress` stopped the run before all candidates were fitted to all specimens: `members` are
     * the specimens that were fitted, and no hardening rule is supported. */
    bool is_stopped;
    double largest_curvature; /* 1/m: smallest of the specimens' largest */
    double relaxation_prior;  /* 1, see struct wb_cycle_fit_settings */
    double pooled_deviation;  /* see struct wb_cycle_calibrate_settings */
    int pooled_degrees;
    double strain_rate; /* 1/s, of the outer fibre, mean over the specimens: the results of laws
                           with Maxwell elements are stated at this rate; 0: no Maxwell elements */
    struct wb_estimate rigidity, residual_curvature_ratio, loop_energy; /* N m2, 1, J/m */
    double mean_length;            /* m, free length, mean over the specimens */
    struct wb_estimate springback; /* of the deflection of this length, 1 */
    double curvature[WB_CYCLE_MOMENTS];
    struct wb_estimate moment[WB_CYCLE_MOMENTS];
    /* Of the virgin wire from straight, and during unloading over changes of curvature from the
     * largest one; without entries if no unloading was measured. */
    struct wb_cycle_stiffness secant, unloading;
    struct wb_budget budget[WB_CYCLE_NUMBERS];
    /* EI, the slope at curvature zero, is within 2 % of a stiffness at the smallest curvature that
     * the data resolve; else it is an extrapolation by the law. */
    bool is_rigidity_resolved;
    struct wb_law law;         /* means over the specimens */
    struct wb_material ludwik; /* its Ludwik equivalent; of a Ludwik law its own parameters */
    double ludwik_misfit;
    bool is_strength_identifiable, is_exponent_identifiable; /* K, n of a Ludwik law */
    double ln_strength_error, exponent_error;                /* largest of the specimens' */
    double travel_share;                                     /* smallest travel over length */
    int specimens_for_5_percent; /* number of specimens for EI within 5 %; 0: unknown */
    double cpu_s;
};

struct wb_cycle_calibrate_settings {
    struct wb_cycle_data_settings data;
    struct wb_cycle_fit_settings fit;
    unsigned left_out;       /* bits 1 << candidate: candidates that are not fitted */
    double pooled_deviation; /* s of ln(EI) pooled over other wires; 0: of these specimens */
    int pooled_degrees;      /* its degrees of freedom */
    double
        at_most; /* largest expanded uncertainty that is accepted, as a part of the value; 0: any */
    int threads; /* 0: as many as there are processors */
    bool (*progress)(void *context, int done, int all); /* NULL; false stops */
    void *progress_context;
};
/* Rows of all settings except progress; offsets of the tables are relative to the struct. */
enum {
    WB_CYCLE_CALIBRATE_TABLES = 3
};
extern const struct wb_setting_table wb_cycle_calibrate_tables[WB_CYCLE_CALIBRATE_TABLES];
void wb_cycle_calibrate_default_settings(struct wb_cycle_calibrate_settings *settings);

/* Appends "name value, name value ..." of all rows, in the rows' units. */
void wb_cycle_calibrate_settings_text(const struct wb_cycle_calibrate_settings *settings,
                                      struct wb_text *text);

/* Calibrates on n datasets of one wire. WB_ERR_DATA if two datasets have the same readings or are
 * of different wires, or if no law can be fitted; `why` receives the reason (NULL: it is logged). A
 * run that `progress` stopped returns WB_OK with is_stopped. */
WB_MUST_CHECK enum wb_status
wb_cycle_calibrate_run(struct wb_cycle_calibration *calibration,
                       const struct wb_dataset *const *datasets, int n,
                       const struct wb_cycle_calibrate_settings *settings, struct wb_reason *why);
void wb_cycle_calibrate_release(struct wb_cycle_calibration *calibration);

/* Index of the smallest curvature that the data resolve. */
static inline int wb_cycle_stiffness_resolved(const struct wb_cycle_stiffness *stiffness)
{
    int k = 0;
    while (k < stiffness->n - 1 && stiffness->curvature[k] < stiffness->resolved)
        k++;
    return k;
}

/* Index of the curvature 1/m, or of the largest below it; -1 without entries. */
static inline int wb_cycle_stiffness_near_one(const struct wb_cycle_stiffness *stiffness)
{
    int k = stiffness->n - 1;
    while (k > 0 && stiffness->curvature[k] > 1.0)
        k--;
    return k;
}

/* The stiffness at a stated curvature (1/m); NULL: not available. */
const struct wb_estimate *wb_cycle_stiffness_at(const struct wb_cycle_stiffness *stiffness,
                                                double curvature);

/* Length of the specimens, m; NaN if they differ. */
double wb_cycle_calibrate_length(const struct wb_cycle_calibration *calibration);

/* Whether the chosen law's fit converged for all specimens. */
bool wb_cycle_calibrate_is_converged(const struct wb_cycle_calibration *calibration);

#endif
