/* A kind of report: what report.h needs to make it. To add a kind, write its functions and a row in
 * analysis/report/kinds/kinds.c.
 *
 * `campaign` is what a file of this kind says, `results` what comes of it; both are of the kind's
 * own types, zeroed before the first function sees them. Results begin with a struct
 * wb_kind_outcome.
 */
#ifndef WB_ANALYSIS_REPORT_KIND_H
#define WB_ANALYSIS_REPORT_KIND_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "analysis/report/document.h"
#include "analysis/report/figures.h"
#include "analysis/report/simulation.h"
#include "base/json.h"
#include "base/status.h"

/* How a report came out. */
struct wb_kind_outcome {
    int n_wanted, n_usable; /* recordings or datasets */
    bool is_complete;       /* nothing is missing, refused or failed */
    bool exceeds_limit;     /* of the campaign */
    bool interrupted;       /* by Ctrl-C; the results are not to be reported */
};

/* Called after each finished step, by one thread at a time: how many of how many, and what was
 * done. May be NULL. */
typedef void wb_kind_progress(void *context, int done, int total, const char *what);

struct wb_kind {
    const char *name; /* `kind:` of the campaign file */
    const char *data; /* what it is made from, for messages: "recordings" */
    size_t campaign_size, results_size;

    enum wb_status (*read)(void *campaign, const char *path);
    /* Looks at the data; may be called again after its results were released. */
    enum wb_status (*load)(void *results, const void *campaign);
    wb_simulation_list *datasets; /* that may be computed; NULL: data are measured */
    int (*count_steps)(const void *campaign);
    /* Computes everything; WB_OK also where data are missing. `n_threads` 0: as many as cores. */
    enum wb_status (*compute)(void *results, int n_threads, wb_kind_progress *progress,
                              void *context);

    const struct wb_figures_row *figures; /* (n_figures) */
    size_t n_figures;
    void (*pages)(struct wb_document *document, const void *results,
                  const struct wb_figures *figures);
    /* All numbers, with the report's own files listed; NULL when out of memory. */
    struct wb_json *(*json)(const void *results, const char *const *files, int n_files);
    void (*print)(FILE *out, const void *results); /* a summary */

    /* Both accept zeroed ones. */
    void (*release)(void *results);
    void (*release_campaign)(void *campaign);
};

#endif
