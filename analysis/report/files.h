/* The files of a report, whatever it is about: report.pdf and report.html of its document,
 * report.json of its numbers, figures/ as SVG and PNG, cards/ for other programs.
 */
#ifndef WB_ANALYSIS_REPORT_FILES_H
#define WB_ANALYSIS_REPORT_FILES_H

#include <stdbool.h>

#include "analysis/report/cards.h"
#include "analysis/report/document.h"
#include "analysis/report/figures.h"
#include "base/json.h"
#include "base/status.h"

/* Writes everything into `folder`, which is made; `numbers` get the list of the report's files,
 * `files`, relative to its folder. WB_ERR_EXISTS when it holds anything, unless
 * `force`: then the files of the report before are replaced (and those that are no longer made are
 * removed), others are left alone. All is drawn first and written into a hidden folder in it, so
 * that on a failure the old report stays and nothing half-written is left behind. */
WB_MUST_CHECK enum wb_status wb_files_write(const struct wb_document *document,
                                            const struct wb_figures *figures,
                                            const struct wb_cards *cards, struct wb_json *numbers,
                                            const char *folder, bool force, int n_threads);

/* Whether a name is one that a report's file may have: nothing outside of its folder. */
bool wb_files_is_ours(const char *name);

#endif
