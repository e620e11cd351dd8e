/* Common parts of campaign files of all kinds: kind, title, notes, name and checksum, the place
 * of their simulations, the settings of a fit, and files that they name.
 */
#ifndef WB_ANALYSIS_REPORT_CAMPAIGN_H
#define WB_ANALYSIS_REPORT_CAMPAIGN_H

#include <stdbool.h>
#include <stddef.h>

#include "analysis/calibration/paper/calibrate.h"
#include "analysis/report/laboratory.h"
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
    struct wb_calibrate_settings fit;
    struct wb_laboratory laboratory;
};

/* The keys of every kind, first in its own table. */
#define WB_CAMPAIGN_KEYS(head)                                                                     \
    WB_CONFIG_IGNORED("kind"), WB_CONFIG_IGNORED("laboratory"),                                    \
        WB_CONFIG_TEXT("title", (head)->title), WB_CONFIG_OPTIONAL_TEXT("notes", (head)->notes)

/* Opens a campaign file, to be destroyed by the caller, and takes its name, checksum and folder;
 * the settings of the fit are the default ones. The rest is read by the kind's table of keys. */
WB_MUST_CHECK enum wb_status wb_campaign_open(struct wb_campaign *campaign,
                                              struct wb_config **config, const char *path);

/* Which of `names` (n_names) the file has as its kind; the first where it has none. Another name is
 * refused with file and line. */
WB_MUST_CHECK enum wb_status wb_campaign_read_kind(int *kind, const char *path,
                                                   const char *const *names, size_t n_names);

/* The settings of a fit; `node` NULL: leaves them. */
WB_MUST_CHECK enum wb_status wb_campaign_read_settings(const struct wb_config_node *node,
                                                       struct wb_calibrate_settings *settings);

/* The path that a key of `node` names: `name` below fixtures/FOLDER, or a path from the campaign
 * file. `shown` (NULL: not wanted) is the path as a command in the file's folder has it. */
WB_MUST_CHECK enum wb_status wb_campaign_find(const struct wb_campaign *campaign,
                                              const struct wb_config_node *node, const char *key,
                                              const char *folder, const char *name,
                                              char path[WB_PATH], char shown[300]);

/* A path from the campaign file as a command in that file's folder has it: as it is given, or its
 * last part where it says where on this machine it is. */
const char *wb_campaign_as_shown(const char *given);

/* For the `progress` of such settings: true until an interrupt. */
bool wb_campaign_go_on(void *context, int evaluation, double error, double size);

#endif
