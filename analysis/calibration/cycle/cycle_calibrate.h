/* Calibration of one wire on whole cycles: which law and which hardening rule the specimens
 * support, and what it says with which certainty.
 *
 * Each specimen is fitted by itself with each candidate (cycle_fit.h). A candidate's
 * misfit is the root mean square of the force residuals of both ways over F_max, pooled over the
 * specimens. The candidates have weights by Schwarz's criterion; that of the largest is chosen.
 *
 * A number's interval holds it with 95 %: it combines the scatter between specimens, what the fits
 * leave open, how far the other laws lie from the chosen one by their weights, and what the files
 * state of gain, length, counterweight, density, marker offset and diameter, which all specimens
 * share and which leave no trace in the data (cycle_budget.h). Beside it stands the range of the
 * number over all candidates whose misfit is at most twice the best.
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

/* A number with what is known of it. */
struct wb_estimate {
    double value;                           /* exp of the mean of ln over specimens */
    double low, high;                       /* interval of 95 % */
    double candidates_low, candidates_high; /* over the candidates that cannot be excluded */
    double deviation;                       /* s of ln over specimens (or pooled); NaN: unknown */
};

/* What makes up an uncertainty. */
enum wb_contribution {
    WB_FROM_SPECIMENS, /* their scatter; unknown with one */
    WB_FROM_FIT,       /* noise, priors, and what the law does not follow */
    WB_FROM_LAW,       /* other laws that the data do not exclude */
    WB_FROM_SHARED,    /* the first of enum wb_cycle_shared */
    WB_CONTRIBUTIONS = WB_FROM_SHARED + WB_SHARED
};

/* Of a number's logarithm. */
struct wb_budget {
    double uncertainty[WB_CONTRIBUTIONS]; /* standard; NaN: not known, and not in the others */
    double degrees[WB_CONTRIBUTIONS];     /* of freedom */
    double effect[WB_SHARED];             /* per part of what is shared, of the markers per m */
    double combined, effective_degrees;
    double factor; /* of the combined one, for 95 % */
};

/* Stiffness at n curvatures, ascending: those that are stated, and the smallest that the data of
 * all specimens resolve; below it the law speaks alone. */
struct wb_cycle_stiffness {
    int n;
    double resolved;                                   /* 1/m */
    double curvature[WB_CYCLE_STIFFNESSES];            /* 1/m */
    struct wb_estimate estimate[WB_CYCLE_STIFFNESSES]; /* N m2 */
};

/* What is reported of a law, and of a specimen with it. */
enum wb_cycle_number {
    WB_CYCLE_RIGIDITY,           /* EI at curvature zero, N m2 */
    WB_CYCLE_RESIDUAL_CURVATURE, /* 1 */
    WB_CYCLE_LOOP_ENERGY,        /* J/m */
    WB_CYCLE_FIRST_MOMENT,       /* N m */
    WB_CYCLE_FIRST_SECANT = WB_CYCLE_FIRST_MOMENT + WB_CYCLE_MOMENTS, /* N m2 */
    WB_CYCLE_FIRST_UNLOADING = WB_CYCLE_FIRST_SECANT + WB_CYCLE_STIFFNESSES,
    WB_CYCLE_NUMBERS = WB_CYCLE_FIRST_UNLOADING + WB_CYCLE_STIFFNESSES
};

/* What a candidate gives for one specimen. */
struct wb_cycle_answer {
    bool is_fitted;
    enum wb_candidate origin; /* whose fit it is: its own, or one that it contains */
    struct wb_cycle_fit fit;
    double value[WB_CYCLE_NUMBERS]; /* 0 where there is no such curvature */
    /* Standard errors of the logarithms by the residuals of the fit; 0 of candidates that do not
     * count. */
    double error[WB_CYCLE_NUMBERS];
    /* Changes of the logarithms with what all specimens share; NaN: not known; 0 of candidates that
     * are not chosen. */
    double effect[WB_SHARED][WB_CYCLE_NUMBERS];
};

/* Largest misfit of a law that follows a wire. */
#define WB_CYCLE_LARGEST_FOLLOWED 3e-2

struct wb_cycle_member {
    int sample;
    struct wb_cycle_data data;
    struct wb_cycle_answer answers[WB_CANDIDATES];
    struct wb_material ludwik; /* that bends alike on a first loading */
    double ludwik_misfit;      /* 1, of ln M */
    struct wb_reason why;      /* where nothing could be fitted */
    double cpu_s;
};

struct wb_cycle_rank {
    enum wb_candidate candidate;
    bool is_fitted; /* for all specimens */
    double misfit;
    double weight;
    bool counts; /* misfit at most twice the best, or chosen: its numbers are in the ranges */
    int n_free;  /* of the law */
    struct wb_estimate rigidity, residual_curvature_ratio; /* without the ranges */
    struct wb_law law; /* means of the specimens' numbers, as those of the chosen one */
};

struct wb_cycle_calibration {
    int n_members;
    struct wb_cycle_member *members; /* (n_members), owned */
    bool has_unloading;
    double repeat_noise;                        /* of a point, over F_max */
    struct wb_cycle_rank ranked[WB_CANDIDATES]; /* best first; those not fitted last */
    int n_ranked;
    enum wb_candidate chosen;
    double n_independent; /* residuals of a specimen, of the best law */
    bool is_followed;     /* the best misfit is at most 3 %, and unloading was fitted */
    /* `progress` said so before all candidates were fitted to all specimens: the members are those
     * that were, and nothing is decided of the rule. */
    bool is_stopped;
    double largest_curvature; /* 1/m: smallest of the specimens' largest */
    double relaxation_prior;  /* 1, see struct wb_cycle_fit_settings */
    double strain_rate;       /* 1/s, of the outer fibre, mean over the specimens, at which numbers
                                 of laws with Maxwell elements are stated; 0: without */
    struct wb_estimate rigidity, residual_curvature_ratio, loop_energy; /* N m2, 1, J/m */
    double curvature[WB_CYCLE_MOMENTS];
    struct wb_estimate moment[WB_CYCLE_MOMENTS];
    /* Of the virgin wire from straight, and during unloading from the largest curvature over
     * changes of it; the second without entries where no unloading was measured. */
    struct wb_cycle_stiffness secant, unloading;
    struct wb_budget budget[WB_CYCLE_NUMBERS];
    /* EI, the slope at curvature zero, is no more than 2 % from a stiffness at the smallest
     * curvature that the data resolve; else it is the law's alone. */
    bool is_rigidity_resolved;
    struct wb_law law; /* means over the specimens */
    struct wb_material
        ludwik; /* its equivalent; the law itself where that is Ludwik's, isotropic */
    double ludwik_misfit;
    bool is_strength_identifiable, is_exponent_identifiable; /* K, n of a Ludwik law */
    double ln_strength_error, exponent_error;                /* largest of the specimens' */
    double travel_share;                                     /* smallest travel over length */
    int specimens_for_5_percent; /* specimens that EI within 5 % needs; 0: unknown */
    double cpu_s;
};

struct wb_cycle_calibrate_settings {
    struct wb_cycle_data_settings data;
    struct wb_cycle_fit_settings fit;
    unsigned left_out;       /* bit 1 << candidate: is not fitted */
    double pooled_deviation; /* s of ln(EI) pooled over other wires; 0: of these specimens */
    int pooled_degrees;      /* its degrees of freedom */
    double at_most;          /* expanded uncertainty that is enough; 0: any */
    int threads;             /* 0: as many as there are processors */
    bool (*progress)(void *context, int done, int all); /* NULL; false stops */
    void *progress_context;
};
/* Their rows, but progress; the tables' offsets count from the struct. */
enum {
    WB_CYCLE_CALIBRATE_TABLES = 3
};
extern const struct wb_setting_table wb_cycle_calibrate_tables[WB_CYCLE_CALIBRATE_TABLES];
void wb_cycle_calibrate_default_settings(struct wb_cycle_calibrate_settings *settings);

/* Appends "name value, name value ..." of all rows, in the rows' units. */
void wb_cycle_calibrate_settings_text(const struct wb_cycle_calibrate_settings *settings,
                                      struct wb_text *text);

/* Calibrates on n datasets of one wire. The same data twice, another wire's, or none that can be
 * fitted: WB_ERR_DATA. `why` receives the reason; NULL: it is logged. Being stopped is a result. */
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

/* Index of the curvature 1 1/m, or of the largest below; -1 without entries. */
static inline int wb_cycle_stiffness_near_one(const struct wb_cycle_stiffness *stiffness)
{
    int k = stiffness->n - 1;
    while (k > 0 && stiffness->curvature[k] > 1.0)
        k--;
    return k;
}

/* The stiffness at a curvature that is stated; NULL: there is none. */
const struct wb_estimate *wb_cycle_stiffness_at(const struct wb_cycle_stiffness *stiffness,
                                                double curvature);

/* The specimens' length, m; NaN where it is not the same. */
double wb_cycle_calibrate_length(const struct wb_cycle_calibration *calibration);

/* Whether the chosen law's fit converged for all specimens. */
bool wb_cycle_calibrate_is_converged(const struct wb_cycle_calibration *calibration);

#endif
