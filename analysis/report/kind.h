/* A kind of report: its functions for report.h. To add a kind, write its functions and a row in
 * analysis/report/kinds/kinds.c.
 *
 * `campaign` is the content of a file of this kind, `results` its results; both are of the kind's
 * own types, zeroed before the first function sees them. A campaign begins with a struct
 * wb_campaign, results with a struct wb_kind_outcome.
 */
#ifndef WB_ANALYSIS_REPORT_KIND_H
#define WB_ANALYSIS_REPORT_KIND_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "analysis/report/campaign.h"
#include "analysis/report/cards.h"
#include "analysis/report/document.h"
#include "analysis/report/figures.h"
#include "analysis/report/simulation.h"
#include "base/json.h"
#include "base/status.h"

/* How a report came out; the first three are known once the data were looked at. */
struct wb_kind_outcome {
    int n_wanted;                       /* recordings or datasets */
    int n_missing;                      /* recordings or files that are not there */
    int n_steps;                        /* of the computation, for its progress */
    int n_usable;                       /* of those that are wanted */
    bool is_complete;                   /* nothing is missing, refused or failed */
    bool exceeds_limit;                 /* of the campaign */
    bool interrupted;                   /* by Ctrl-C; the results are not to be reported */
    const struct wb_campaign *campaign; /* borrowed; `load` sets it */
};

/* Called after each finished step, by one thread at a time: how many are done, and the name of the
 * last. May be NULL. */
typedef void wb_kind_progress(void *context, int done, const char *what);

/* --- the functions of a kind --- */

/* Reads the keys of a campaign file into a zeroed campaign, whose head was opened. */
typedef enum wb_status wb_kind_keys(void *campaign, const struct wb_config_node *root);
/* Looks at the data; may be called again after its results were released. */
typedef enum wb_status wb_kind_load(void *results, const void *campaign);
/* Then computes everything; WB_OK also where data are missing. `n_threads` 0: as many as cores. */
typedef enum wb_status wb_kind_compute(void *results, int n_threads, wb_kind_progress *progress,
                                       void *context);
/* Builds the document, which is released before the figures. */
typedef void wb_kind_pages(struct wb_document *document, const void *results,
                           const struct wb_figures *figures);
/* Adds the laws that were calibrated (wb_cards_add()). */
typedef enum wb_status wb_kind_cards(struct wb_cards *cards, const void *results);
/* All numbers, with units in the keys; NULL when out of memory. */
typedef struct wb_json *wb_kind_json(const void *results);
/* Of a campaign or of results; accepts zeroed ones. */
typedef void wb_kind_release(void *of);

/* A recording that a report was made from. */
struct wb_kind_recording {
    const char *name;   /* for readers: no path of this machine; borrowed */
    const char *sha256; /* of the uncompressed recording; borrowed; NULL: it is not used */
};
/* The recording at an index; false after the last. */
typedef bool wb_kind_recordings(const void *results, int index,
                                struct wb_kind_recording *recording);

struct wb_kind {
    const char *name;       /* `kind:` of the campaign file */
    const char *data;       /* its inputs, for messages: "recordings" */
    bool has_uncertainties; /* of the values that its limits bound */
    size_t campaign_size, results_size;

    wb_kind_keys *keys;
    wb_kind_load *load;
    wb_simulation_list *datasets;   /* that may be computed; NULL: data are measured */
    wb_kind_recordings *recordings; /* NULL: it reads none */
    wb_kind_compute *compute;

    const struct wb_figures_row *figures; /* (n_figures) */
    size_t n_figures;
    wb_kind_pages *pages;
    wb_kind_cards *cards; /* NULL: it calibrates nothing */
    wb_kind_json *json;
    void (*print)(FILE *out, const void *results); /* a summary */

    wb_kind_release *release, *release_campaign;
};

/* Reads a campaign file. Errors name file, line and key; on one nothing needs a release. */
WB_MUST_CHECK enum wb_status wb_kind_read(const struct wb_kind *kind, void *campaign,
                                          const char *path);

/* Writes computed results into `folder`, as wb_files_write() does. */
WB_MUST_CHECK enum wb_status wb_kind_write(const struct wb_kind *kind, const void *results,
                                           const char *folder, bool force, int n_threads);

#endif
