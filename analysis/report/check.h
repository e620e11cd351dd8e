/* Checks a signed report: its signature, its files, and whether the same comes out again. */
#ifndef WB_ANALYSIS_REPORT_CHECK_H
#define WB_ANALYSIS_REPORT_CHECK_H

#include <stdio.h>

#include "analysis/report/kind.h"
#include "base/status.h"

struct wb_check_order {
    const char *folder;   /* of the report */
    const char *campaign; /* NULL: the file that the manifest names, here or among the shipped */
    int n_threads;        /* as for a report */
    FILE *out;            /* findings, a line each */
};

enum wb_check_end {
    WB_CHECK_SAME,         /* the same bytes came out again */
    WB_CHECK_OTHER_BUILD,  /* made by another build, numbers within 1e-9, fitted ones 1e-5 */
    WB_CHECK_NOT_COMPUTED, /* signature and files are good; the campaign is not here, or Ctrl-C */
};

/* Computes the report again in a folder of its own below $TMPDIR, which it removes. What is not as
 * it was signed is WB_ERR_DATA, with a message that names it. */
WB_MUST_CHECK enum wb_status wb_check_run(enum wb_check_end *end,
                                          const struct wb_kind *const *kinds, size_t n_kinds,
                                          const struct wb_check_order *order);

#endif
