/* Bands of a bundle's prediction: the section model (fe/section/section_run.h) run over a Latin
 * hypercube of the uncertain inputs (analysis/predict/inputs.h).
 *
 * Bands are given for force over deflection, for moment over curvature of the homogenised beam, and
 * for the springback (the part of the largest deflection that springs back), at each place
 * separately: median and 90 % of the runs, and the same widened by the model's own error. That
 * error is 2 % (standard deviation, from 19 explicit curves) of the largest median force or moment,
 * or of the springback itself; 1.645 times it is added in quadrature to both halves of the 90 %
 * band.
 *
 * Choices of the design (packing, outline, layers) are compared, not drawn: each is a case of its
 * own over the same hypercube, so that cases differ by the choice alone. The same file, seed and
 * number of runs give the same numbers on any number of threads.
 */
#ifndef WB_ANALYSIS_PREDICT_BANDS_H
#define WB_ANALYSIS_PREDICT_BANDS_H

#include <stdbool.h>
#include <stdint.h>

#include "analysis/predict/inputs.h"
#include "analysis/predict/ranking.h"
#include "base/status.h"
#include "fe/model/bundle_model.h"
#include "fe/model/bundle_override.h"

enum {
    WB_BANDS_CASES = 64,
    WB_BANDS_ROWS = 26,    /* most rows of a loading, without row 0 */
    WB_BANDS_MOMENTS = 16, /* most points of M over kappa */
    WB_BANDS_RANKINGS = 3
};

/* Standard deviation of the model from the explicit one, as a part of the largest value. */
#define WB_BANDS_MODEL_ERROR 0.02

struct wb_bands_interval {
    double median, low, high;   /* of the runs: median, 5 and 95 % */
    double wide_low, wide_high; /* with the model's error */
};

struct wb_bands_place {
    double at; /* m, or 1/m */
    struct wb_bands_interval band;
};

struct wb_bands_ranking {
    const char *of; /* "force" or "deflection_springback" */
    double at;      /* m, the deflection */
    struct wb_ranking ranking;
};

struct wb_bands_case {
    struct wb_bundle_variant variant; /* named "file": the file as it is */
    int n_wires;
    char packing[16];
    double layers; /* of tape, with overlap; 0: no tape */
    bool is_round; /* the tape */
    int n_runs;
    int n_lost;    /* runs that were not computed to the end */
    int n_limited; /* runs with a limited law, see analysis/predict/specimens.h */
    int n_force;   /* rows that at least 95 % of the runs reach */
    struct wb_bands_place force[WB_BANDS_ROWS + 1]; /* N over m */
    int n_moment;
    struct wb_bands_place moment[WB_BANDS_MOMENTS];    /* N m over 1/m */
    struct wb_bands_interval springback;               /* of the deflection, 1; NaN: too few runs */
    struct wb_bands_interval residual_curvature_ratio; /* as `springback` */
    int n_rankings;
    struct wb_bands_ranking ranking[WB_BANDS_RANKINGS];
};

struct wb_bands_settings {
    int runs;                                  /* of each case; 0: 500 */
    uint64_t seed;                             /* of the hypercube and of resampling */
    const struct wb_bundle_override *override; /* NULL: nothing */
    int n_variants; /* that replace the file's scenarios; 0: the file's */
    const struct wb_bundle_variant *variants;
    int n_threads;               /* 0: as many as processors */
    bool (*stop)(void *context); /* called after each run, by one thread at a time; NULL: never */
    void *context;
};

struct wb_bands {
    struct wb_inputs inputs;
    int runs;
    uint64_t seed;
    bool stopped; /* stopped before the last case was complete */
    int n_cases;
    struct wb_bands_case *cases; /* (n_cases) owned; that of the file first */
};

/* Reads the bundle of the path, once per case, and computes all cases. */
WB_MUST_CHECK enum wb_status wb_bands_create(struct wb_bands **out, const char *path,
                                             const struct wb_bands_settings *settings);
void wb_bands_destroy(struct wb_bands *bands); /* accepts NULL */

#endif
