/* The manifest of a report, manifest.json in its folder: SHA-256 sums of its files and of its
 * inputs, and the build of the program. A signature of the manifest is one of all of these.
 */
#ifndef WB_ANALYSIS_REPORT_MANIFEST_H
#define WB_ANALYSIS_REPORT_MANIFEST_H

#include <stdbool.h>

#include "analysis/report/kind.h"
#include "base/file.h"
#include "base/status.h"

extern const char wb_manifest_name[], wb_manifest_signature_name[]; /* "manifest.json", ".asc" */

/* Of a report that was just written into `folder` from these results. */
WB_MUST_CHECK enum wb_status wb_manifest_write(const struct wb_kind *kind, const void *results,
                                               const char *folder);

/* Whether a folder holds a signed report. */
bool wb_manifest_is_signed(const char *folder);

/* Compares the files of `folder` with its manifest; *n receives how many there are. WB_ERR_DATA
 * names the first that is not as it was. */
WB_MUST_CHECK enum wb_status wb_manifest_check_files(const struct wb_json *manifest,
                                                     const char *folder, int *n);

#endif
