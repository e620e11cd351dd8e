/* What campaign files of all kinds have in common: kind, title, notes, name and checksum, the place
 * of their simulations, and the settings of a calibration.
 */
#ifndef WB_ANALYSIS_REPORT_CAMPAIGN_H
#define WB_ANALYSIS_REPORT_CAMPAIGN_H

#include "analysis/calibrate.h"
#include "base/config.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/status.h"

/* What a campaign file is about. */
enum wb_campaign_kind {
    WB_CAMPAIGN_RECORDINGS, /* this file's */
    WB_CAMPAIGN_COMPARISON, /* analysis/report/wires/wires.h */
    WB_CAMPAIGN_BUNDLES     /* analysis/report/bundles/bundles.h */
};
WB_MUST_CHECK enum wb_status wb_campaign_read_kind(enum wb_campaign_kind *kind, const char *path);

/* What campaigns of all kinds share: the settings of a calibration (`node` NULL: leaves them), and
 * the name that a report may tell of a campaign file. */
WB_MUST_CHECK enum wb_status wb_campaign_read_settings(const struct wb_config_node *node,
                                                       struct wb_calibrate_settings *settings);
void wb_campaign_set_name(char *name, size_t size, const char *path);

#endif
