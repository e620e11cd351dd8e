/* Makes a report of any kind: report.pdf, report.html, report.json and figures/.
 *
 * The same data and the same revision give the same bytes: nothing in them depends on the time of
 * the run, on how long it took, on the folder or on this machine's paths. The cost of a simulation
 * is read from its dataset.
 */
#ifndef WB_ANALYSIS_REPORT_REPORT_H
#define WB_ANALYSIS_REPORT_REPORT_H

#include <stdbool.h>

#include "analysis/jobs/jobs.h"
#include "analysis/report/kind.h"
#include "base/status.h"

/* The report to make; all borrowed. */
struct wb_report_order {
    const char *campaign; /* path of its file */
    const char *folder;   /* to write; NULL: nothing, only datasets that cannot be used are
                             listed, with the reason */
    bool force;           /* replaces the report that it holds */
    bool has_manifest;    /* also writes manifest.json */
    const char *key;      /* to sign the manifest with, by gpg; NULL: none */
    bool quiet;           /* prints no summary; a list is JSON */
    int n_threads;        /* 0: as many as cores, 4 at most */
    const struct wb_jobs_options *jobs; /* for datasets that are missing */
};

enum wb_report_end {
    WB_REPORT_COMPLETE,
    WB_REPORT_INCOMPLETE, /* written; something is missing, and the report says what */
    WB_REPORT_LIMIT,      /* written; a limit of the campaign is exceeded */
    WB_REPORT_INTERRUPTED /* nothing is written, which was said; datasets that were made stay */,
    WB_REPORT_NOTHING /* nothing is written: only a list was asked for, of runs, or of datasets, of
                         which none is missing or outdated */
};

/* Reads the campaign, whose kind is one of `kinds` (n_kinds; the first one where the file names
 * none), has missing datasets made where that is asked for, computes, writes, signs, and prints a
 * summary on stdout. A folder that holds a signed report is refused, `force` or not. */
WB_MUST_CHECK enum wb_status wb_report_make(enum wb_report_end *end,
                                            const struct wb_kind *const *kinds, size_t n_kinds,
                                            const struct wb_report_order *order);

#endif
