#include "analysis/report/campaign.h"

#include <stdio.h>
#include <string.h>

#include "base/units.h"

#define WB_LOG_DOMAIN "campaign"

enum {
    MOST_SETTINGS = 32 /* rows of wb_calibrate_table */
};

enum wb_status wb_campaign_read_settings(const struct wb_config_node *node,
                                         struct wb_calibrate_settings *settings)
{
    struct wb_config_key keys[MOST_SETTINGS];
    const size_t n = wb_setting_keys(&wb_calibrate_table, WB_CALIBRATE_CAMPAIGN, settings, keys);
    return node ? wb_config_map(node, keys, n) : WB_OK;
}

/* No path of this machine may reach the report: shipped campaigns are named from fixtures/ on. */
void wb_campaign_set_name(char *name, size_t size, const char *path)
{
    static const char place[] = "fixtures/campaigns/";
    const char *const file = wb_file_name(path);
    const size_t before = (size_t)(file - path), length = sizeof place - 1;
    const bool shipped = before >= length && memcmp(file - length, place, length) == 0;
    snprintf(name, size, "%s%.200s", shipped ? place : "", file);
}

enum wb_status wb_campaign_read_kind(enum wb_campaign_kind *kind, const char *path)
{
    static const char *const kinds[] = {"recordings", "comparison", "bundles"};
    struct wb_config *config;
    WB_TRY(wb_config_read(&config, path));
    const struct wb_config_node *const root = wb_config_root(config);
    const struct wb_config_node *const node = wb_config_find(root, "kind");
    const char *const text = node ? wb_config_scalar(node) : kinds[0];
    enum wb_status status = WB_OK;
    if (text && strcmp(text, kinds[0]) == 0)
        *kind = WB_CAMPAIGN_RECORDINGS;
    else if (text && strcmp(text, kinds[1]) == 0)
        *kind = WB_CAMPAIGN_COMPARISON;
    else if (text && strcmp(text, kinds[2]) == 0)
        *kind = WB_CAMPAIGN_BUNDLES;
    else
        status = wb_config_refuse(root, "kind", "expected recordings, comparison or bundles");
    wb_config_destroy(config);
    return status;
}
