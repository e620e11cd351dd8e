#include "analysis/report/campaign.h"

#include <stdio.h>
#include <string.h>

#include "base/units.h"

#define WB_LOG_DOMAIN "campaign"

enum wb_status wb_campaign_read_settings(const struct wb_config_node *node,
                                         struct wb_calibrate_settings *settings)
{
    const struct wb_config_key keys[] = {
        WB_CONFIG_OPTIONAL_NUMBER("elastic_zone", &settings->elastic_zone, 1.0,
                                  WB_CALIBRATE_LEAST_ZONE, WB_CALIBRATE_LARGEST_ZONE),
        WB_CONFIG_OPTIONAL_NUMBER("yield_point", &settings->yield_point, 1.0,
                                  WB_CALIBRATE_LEAST_ZONE, WB_CALIBRATE_LARGEST_ZONE),
        WB_CONFIG_OPTIONAL_NUMBER("step_mm", &settings->step, WB_MM, 0.05, 10.0),
        WB_CONFIG_OPTIONAL_BOOLEAN("straight", &settings->straight),
        WB_CONFIG_OPTIONAL_BOOLEAN("bow_corrected", &settings->bow_corrected),
        WB_CONFIG_OPTIONAL_BOOLEAN("restart", &settings->restart),
        WB_CONFIG_OPTIONAL_INTEGER("max_iterations", &settings->max_iterations, 1, 100000),
        WB_CONFIG_OPTIONAL_INTEGER("elements", &settings->n_elements, 2, 1000),
        WB_CONFIG_OPTIONAL_INTEGER("fibres", &settings->n_fibres, 4, 1000),
    };
    return node ? wb_config_map(node, keys, WB_COUNT(keys)) : WB_OK;
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
