#include "analysis/report/campaign.h"

#include <stdio.h>
#include <string.h>

#include "base/interrupt.h"

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

const char *wb_campaign_as_shown(const char *given)
{
    if (given[0] == '/' || strstr(given, ".."))
        given = wb_file_name(given);
    return strncmp(given, "./", 2) == 0 ? given + 2 : given;
}

enum wb_status wb_campaign_find(const struct wb_campaign *campaign,
                                const struct wb_config_node *node, const char *key,
                                const char *folder, const char *name, char path[WB_PATH],
                                char shown[300])
{
    char named_in[WB_PATH + 32];
    snprintf(named_in, sizeof named_in, "%s:%d: %s", wb_config_origin(node),
             wb_config_line(wb_config_find(node, key)), key);
    WB_TRY(wb_file_find_named(path, folder, name, campaign->folder, named_in, NULL));
    const bool is_shipped = !strchr(name, '/') && !strstr(name, ".yaml");
    if (shown && is_shipped)
        snprintf(shown, 300, "fixtures/%s/%s.yaml", folder, name);
    else if (shown)
        snprintf(shown, 300, "%s", wb_campaign_as_shown(name));
    return WB_OK;
}

/* No path of this machine may reach the report: shipped campaigns are named from fixtures/ on. */
static void set_name(char *name, size_t size, const char *path)
{
    static const char place[] = "fixtures/campaigns/";
    const char *const file = wb_file_name(path);
    const size_t before = (size_t)(file - path), length = sizeof place - 1;
    const bool shipped = before >= length && memcmp(file - length, place, length) == 0;
    snprintf(name, size, "%s%.200s", shipped ? place : "", file);
}

enum wb_status wb_campaign_open(struct wb_campaign *campaign, struct wb_config **config,
                                const char *path)
{
    wb_calibrate_default_settings(&campaign->fit);
    WB_TRY(wb_hash_file(path, campaign->sha256));
    set_name(campaign->name, sizeof campaign->name, path);
    wb_file_folder(campaign->folder, path);
    return wb_config_read(config, path, NULL);
}

/* "recordings, comparison or bundles". */
static void list_names(char *text, size_t size, const char *const *names, size_t n)
{
    size_t used = 0;
    text[0] = '\0';
    for (size_t i = 0; i < n && used < size; i++)
        used += (size_t)snprintf(text + used, size - used, "%s%s",
                                 i == 0       ? ""
                                 : i + 1 == n ? " or "
                                              : ", ",
                                 names[i]);
}

enum wb_status wb_campaign_read_kind(int *kind, const char *path, const char *const *names,
                                     size_t n_names)
{
    char expected[200];
    struct wb_config *config;
    WB_TRY(wb_config_read(&config, path, NULL));
    const struct wb_config_node *const root = wb_config_root(config);
    const struct wb_config_node *const node = wb_config_find(root, "kind");
    const char *const text = node ? wb_config_scalar(node) : names[0];
    enum wb_status status = WB_ERR_NOT_FOUND;
    for (size_t i = 0; i < n_names && text && status != WB_OK; i++) {
        if (strcmp(text, names[i]) != 0)
            continue;
        *kind = (int)i;
        status = WB_OK;
    }
    list_names(expected, sizeof expected, names, n_names);
    if (status != WB_OK)
        status = wb_config_refuse(root, "kind", "expected %s", expected);
    wb_config_destroy(config);
    return status;
}

bool wb_campaign_go_on(void *context, int evaluation, double error, double size)
{
    (void)context, (void)evaluation, (void)error, (void)size;
    return !wb_interrupted();
}
