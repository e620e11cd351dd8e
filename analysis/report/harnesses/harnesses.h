/* A report of a harness: its file is computed twice, with the laws of the wires and elastic. Its
 * YAML file:
 *
 *     kind: harness
 *     title: A trunk with two leads
 *     notes: what a reader should know     # optional
 *     harness: small                       # name in fixtures/harnesses, or a path
 *     runs: 500                            # optional: bands from the scatter of the specimens, of
 *     seed: 1                              # this many runs with this seed
 *
 * A harness file has the same `kind`, and no key `harness`.
 */
#ifndef WB_ANALYSIS_REPORT_HARNESSES_HARNESSES_H
#define WB_ANALYSIS_REPORT_HARNESSES_HARNESSES_H

#include "analysis/harness/harness_bands.h"
#include "analysis/harness/harness_found.h"
#include "analysis/harness/harness_run.h"
#include "analysis/report/campaign.h"
#include "analysis/report/kind.h"

struct wb_harnesses {
    struct wb_campaign head;
    char file[300];               /* the harness file, as shown */
    struct wb_harness_plan *plan; /* owned */
    int runs, seed;               /* of the bands; 0 runs: none */
};

wb_kind_keys wb_harnesses_keys;
wb_kind_release wb_harnesses_release;

struct wb_harnesses_results {
    struct wb_kind_outcome outcome;
    const struct wb_harnesses *campaign;  /* borrowed */
    struct wb_harness_result_set set;     /* with the laws of the wires */
    struct wb_harness_result_set elastic; /* the same without yielding */
    struct wb_harness_found found;        /* of `set` */
    struct wb_harness_bands *bands;       /* of `set`; owned; NULL: none */
};

wb_kind_load wb_harnesses_load;
wb_kind_compute wb_harnesses_compute;
wb_kind_release wb_harnesses_release_results;

/* The elastic force at an item after a step, N; NAN: it was not computed or the item is free. */
double wb_harnesses_elastic_force(const struct wb_harnesses_results *results, int step, int item);
/* The largest one during all steps; NAN: not all were computed. */
double wb_harnesses_elastic_largest(const struct wb_harnesses_results *results, int item);

#endif
