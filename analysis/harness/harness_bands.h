/* Bands of the forces and shapes of a harness, from the scatter of the specimens of its wires: all
 * steps computed over a Latin hypercube of the laws of the wires.
 *
 * A wire of the harness file has scatter if it names a properties file with the laws of at least
 * WB_SPECIMENS_LEAST specimens. A run draws one law for it, that of a further wire of the product
 * (analysis/predict/specimens.h), and all branches of the wire have this law; wires of the same
 * file are one wire. Other wires, lengths, masses and torsional stiffnesses of the harness file are
 * exact; a torsional stiffness by default follows the drawn E.
 *
 * Runs that find no equilibrium in a step count up to the step before. Runs whose snaps differ from
 * those of the nominal laws may have ended on another arch; their forces and shapes are part of the
 * bands. Both are counted and listed. The same file, seed and number of runs give the same numbers
 * on any number of threads.
 *
 *     status = wb_harness_bands_create(&bands, &nominal, &settings);
 *     status = wb_harness_bands_compute(bands, 0, bands->runs);
 *     wb_harness_bands_finish(bands);
 */
#ifndef WB_ANALYSIS_HARNESS_HARNESS_BANDS_H
#define WB_ANALYSIS_HARNESS_HARNESS_BANDS_H

#include <stdbool.h>
#include <stdint.h>

#include "analysis/dataset/fit.h"
#include "analysis/harness/harness_run.h"
#include "base/memory.h"
#include "base/reason.h"
#include "base/status.h"

enum {
    WB_HARNESS_BANDS_LEAST_RUNS = 40 /* the outer 2.5 % are then one run */
};

#define WB_HARNESS_BANDS_CONFIDENCE 0.95

/* Of what holds an item, in a step: N, N m. */
struct wb_harness_force_bands {
    struct wb_fit_band force, moment;                 /* at the end of the step */
    struct wb_fit_band largest_force, largest_moment; /* on the way */
};

/* Of a branch at the end of a step: the largest distance, anywhere along the branch, from the shape
 * with the nominal laws. */
struct wb_harness_shape_band {
    double median, distance; /* m, of the runs: median, and what 95 % of them do not exceed */
    double at;               /* m: where on the branch the run at 95 % has it */
};

struct wb_harness_step_bands {
    int n;       /* runs with an equilibrium; with fewer than 95 % of all the bands are NAN */
    int n_lost;  /* runs without one in this step */
    int n_other; /* of the n: runs with other snaps up to here */
    struct wb_harness_force_bands *forces;  /* (n_items) of mounted ones */
    struct wb_harness_shape_band *branches; /* (n_branches) */
};

/* A run that found no equilibrium, or that snapped otherwise. */
struct wb_harness_deviant {
    int run;  /* from 1 */
    int step; /* index, the first one */
    bool is_lost;
    int branch; /* of a lost one: where no equilibrium was found; -1: the root */
};

struct wb_harness_bands_settings {
    int runs;
    uint64_t seed;
    int n_threads;               /* 0: as many as processors */
    bool (*stop)(void *context); /* called by all threads; NULL: never */
    void *context;
};

struct wb_harness_bands {
    const struct wb_harness_result_set *nominal; /* borrowed */
    struct wb_harness_bands_settings settings;
    bool stopped;                        /* before the last run: no bands */
    struct wb_harness_step_bands *steps; /* (n_steps of the nominal results) */
    bool is_taken_off;                   /* the last step took the harness off, */
    struct wb_fit_band residual;         /* then: largest distance from the stress-free shape, m */
    int n_deviants;
    struct wb_harness_deviant *deviants; /* (n_deviants) */
    int n_dimensions;                    /* numbers of a run */
    double *points;                      /* (runs x n_dimensions) */
    size_t stride;
    double *values; /* (runs x stride) results of the runs, see harness_bands.c */
    struct wb_memory memory;
};

/* WB_ERR_ARGUMENT if no wire has scatter, or with too few runs; the message says what to do. */
WB_MUST_CHECK enum wb_status wb_harness_bands_check(const struct wb_harness_plan *plan, int runs);

/* Checks this, too; WB_ERR_ARGUMENT also if the nominal results have not converged, or with more
 * runs than memory holds. */
WB_MUST_CHECK enum wb_status
wb_harness_bands_create(struct wb_harness_bands **out, const struct wb_harness_result_set *nominal,
                        const struct wb_harness_bands_settings *settings);
void wb_harness_bands_destroy(struct wb_harness_bands *bands); /* accepts NULL */

/* Whether a wire is drawn. */
bool wb_harness_bands_is_drawn(const struct wb_harness_wire *wire);

/* Writes the results of the n runs from `first` on as part.json into a folder, which exists; and
 * reads them. WB_ERR_FORMAT for those of other inputs, other runs, or another revision of the
 * program; `why` receives the reason; NULL: it is logged. */
WB_MUST_CHECK enum wb_status wb_harness_bands_write_part(const struct wb_harness_bands *bands,
                                                         int first, int n, const char *folder);
WB_MUST_CHECK enum wb_status wb_harness_bands_read_part(struct wb_harness_bands *bands, int first,
                                                        int n, const char *folder,
                                                        struct wb_reason *why);

/* Computes n runs from `first` on. */
WB_MUST_CHECK enum wb_status wb_harness_bands_compute(struct wb_harness_bands *bands, int first,
                                                      int n);

/* The bands, once all runs are computed. */
void wb_harness_bands_finish(struct wb_harness_bands *bands);

#endif
