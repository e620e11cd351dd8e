/* What campaign files of all kinds have in common: kind, title, notes, name and checksum, the place
 * of their simulations, and the settings of a fit.
 */
#ifndef WB_ANALYSIS_REPORT_CAMPAIGN_H
#define WB_ANALYSIS_REPORT_CAMPAIGN_H

#include <stdbool.h>
#include <stddef.h>

#include "analysis/calibrate.h"
#include "base/config.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/status.h"

struct wb_campaign {
    char title[200], notes[2000];
    char name[256];              /* of the file, from fixtures/ on when it is a shipped one */
    char sha256[WB_SHA256_TEXT]; /* of the file */
    char folder[WB_PATH];        /* of the file; no report shows it */
    char simulations[WB_PATH];   /* as the file gives it; "": the shipped ones */
};

/* Opens a campaign file, to be destroyed by the caller, and takes its name, checksum and folder.
 * The rest is read by the kind's own table of keys. */
WB_MUST_CHECK enum wb_status wb_campaign_open(struct wb_campaign *campaign,
                                              struct wb_config **config, const char *path);

/* Which of `names` (n_names) the file has as its kind; the first where it has none. Another name is
 * refused with file and line. */
WB_MUST_CHECK enum wb_status wb_campaign_read_kind(int *kind, const char *path,
                                                   const char *const *names, size_t n_names);

/* The settings of a calibration; `node` NULL: leaves them. */
WB_MUST_CHECK enum wb_status wb_campaign_read_settings(const struct wb_config_node *node,
                                                       struct wb_calibrate_settings *settings);

/* For the `progress` of such settings: true until an interrupt. */
bool wb_campaign_go_on(void *context, int evaluation, double error, double size);

#endif
