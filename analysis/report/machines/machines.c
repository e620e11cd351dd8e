#include "analysis/report/machines/machines.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/units.h"
#include "fe/material/hardening.h"
#include "fe/material/material_file.h"

enum {
    MOST_GROUPS = 100,
    MOST_TESTS = 1000
};

static enum wb_status read_usable(const struct wb_config_node *node, struct wb_band *band)
{
    const double none = (double)NAN;
    double numbers[2];
    int n = 1;
    const struct wb_config_key key =
        WB_CONFIG_NUMBER("usable_travel_mm", &numbers[0], WB_MM, 1e-6, 1e5);
    *band = (struct wb_band){false, none, none, none};
    if (!node)
        return WB_OK;
    if (wb_config_length(node) < 0)
        WB_TRY(wb_config_value(node, &key));
    else
        WB_TRY(wb_config_numbers(node, &key, 2, 2, numbers, &n));
    if (n == 1)
        numbers[1] = numbers[0];
    if (!(numbers[1] >= numbers[0]))
        return wb_config_refuse(node, NULL, "usable_travel_mm: expected the least first");
    *band = (struct wb_band){true, 0.5 * (numbers[0] + numbers[1]), numbers[0], numbers[1]};
    return WB_OK;
}

static enum wb_status read_tests(const struct wb_config_node *list, struct wb_machines_group *group)
{
    const int n = wb_config_length(list);
    if (n < 1 || n > MOST_TESTS)
        return wb_config_refuse(list, NULL, "tests: expected a list of 1 to %d files", MOST_TESTS);
    group->tests = wb_memory_new((size_t)n, sizeof *group->tests);
    for (; group->n_tests < n; group->n_tests++) {
        char *const name = group->tests[group->n_tests];
        const struct wb_config_key key = {
            .name = "tests", .type = WB_CONFIG_TYPE_TEXT, .target = name, .size = 300};
        WB_TRY(wb_config_value(wb_config_item(list, group->n_tests), &key));
    }
    return WB_OK;
}

static enum wb_status read_group(const struct wb_machines *campaign,
                                 const struct wb_config_node *node, struct wb_machines_group *group)
{
    const struct wb_config_node *tests, *usable;
    char machine[300], path[WB_PATH];
    group->piece.length = group->piece.area = (double)NAN;
    group->zero_force = 10.0 * WB_MN;
    const struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("name", group->name),
        WB_CONFIG_OPTIONAL_TEXT("label", group->label),
        WB_CONFIG_OPTIONAL_TEXT("wire", group->piece.wire),
        WB_CONFIG_OPTIONAL_TEXT("series", group->piece.series),
        WB_CONFIG_TEXT("machine", machine),
        WB_CONFIG_NUMBER("outer_diameter_mm", &group->piece.outer_diameter, WB_MM, 0.001, 1000.0),
        WB_CONFIG_OPTIONAL_NUMBER("zero_force_mN", &group->zero_force, WB_MN, 0.0, 1e6),
        WB_CONFIG_OPTIONAL_NODE("usable_travel_mm", &usable),
        WB_CONFIG_NODE("tests", &tests),
    };
    WB_TRY(wb_config_map(node, keys, WB_COUNT(keys)));
    WB_TRY(read_usable(usable, &group->piece.usable_travel));
    WB_TRY(read_tests(tests, group));
    if (!group->label[0])
        snprintf(group->label, sizeof group->label, "%s", group->name);
    if (!group->piece.wire[0])
        snprintf(group->piece.wire, sizeof group->piece.wire, "%s", group->name);
    WB_TRY(wb_campaign_find(&campaign->head, node, "machine", "machines", machine, path, NULL));
    WB_TRY(wb_machine_read(path, &group->machine, NULL));
    if (group->machine.kind != WB_TEST_THREE_POINT)
        return wb_config_refuse(node, "machine", "expected a three-point machine, not a %s one",
                                wb_machine_kind_name(group->machine.kind));
    return WB_OK;
}

static enum wb_status find_group(const struct wb_machines *campaign,
                                 const struct wb_config_node *node, int *group)
{
    const char *const name = wb_config_scalar(node);
    for (*group = 0; name && *group < campaign->n_groups; (*group)++) {
        if (strcmp(campaign->groups[*group].name, name) == 0)
            return WB_OK;
    }
    return wb_config_refuse(node, NULL, "'%s': expected the name of a group", name ? name : "");
}

static enum wb_status find_groups(const struct wb_machines *campaign,
                                  const struct wb_config_node *list, int most, int *groups, int *n)
{
    *n = wb_config_length(list);
    if (*n < 1 || *n > most)
        return wb_config_refuse(list, NULL, "expected a list of 1 to %d groups", most);
    for (int i = 0; i < *n; i++)
        WB_TRY(find_group(campaign, wb_config_item(list, i), &groups[i]));
    return WB_OK;
}

static enum wb_status read_cable(struct wb_machines *campaign, const struct wb_config_node *node)
{
    struct wb_machines_cable *const cable = &campaign->cable;
    const struct wb_config_node *wires, *core, *layers;
    struct wb_material_file file;
    char path[WB_PATH];
    const struct wb_config_key keys[] = {
        WB_CONFIG_NODE("wires", &wires),
        WB_CONFIG_NODE("core", &core),
        WB_CONFIG_NODE("layers", &layers),
        WB_CONFIG_INTEGER("wire_count", &cable->ring.n_wires, 1, 1000),
        WB_CONFIG_NUMBER("wire_circle_radius_mm", &cable->ring.radius, WB_MM, 1e-3, 1000.0),
        WB_CONFIG_TEXT("conductor", cable->conductor),
        WB_CONFIG_NUMBER("conductor_area_mm2", &cable->ring.area, WB_MM * WB_MM, 1e-6, 1e6),
    };
    WB_TRY(wb_config_map(node, keys, WB_COUNT(keys)));
    WB_TRY(find_groups(campaign, wires, WB_MACHINES_WIRES, cable->wires, &cable->n_wires));
    WB_TRY(find_group(campaign, core, &cable->core));
    WB_TRY(find_groups(campaign, layers, WB_MACHINES_LAYERS, cable->layers, &cable->n_layers));
    for (int i = 1; i < cable->n_wires; i++) {
        if (campaign->groups[cable->wires[i]].machine.span !=
            campaign->groups[cable->wires[0]].machine.span)
            return wb_config_refuse(wires, NULL, "wires: expected tests at one span");
    }
    WB_TRY(wb_campaign_find(&campaign->head, node, "conductor", "materials", cable->conductor, path,
                            NULL));
    WB_TRY(wb_material_file_read(&file, path));
    cable->ring.conductor = file.material;
    if (wb_hardening_law(&file.material)->moves)
        return wb_config_refuse(node, "conductor", "expected isotropic hardening");
    return WB_OK;
}

enum wb_status wb_machines_keys(void *context, const struct wb_config_node *root)
{
    struct wb_machines *const campaign = context;
    const struct wb_config_node *groups, *cable;
    const struct wb_config_key keys[] = {
        WB_CAMPAIGN_KEYS(&campaign->head),
        WB_CONFIG_OPTIONAL_TEXT("data_environment", campaign->environment),
        WB_CONFIG_OPTIONAL_BOOLEAN("calibrate", &campaign->calibrates),
        WB_CONFIG_NODE("groups", &groups),
        WB_CONFIG_OPTIONAL_NODE("cable", &cable),
    };
    WB_TRY(wb_config_map(root, keys, WB_COUNT(keys)));
    const int n = wb_config_length(groups);
    if (n < 1 || n > MOST_GROUPS)
        return wb_config_refuse(root, "groups", "expected a list of 1 to %d groups", MOST_GROUPS);
    campaign->groups = wb_memory_new((size_t)n, sizeof *campaign->groups);
    for (int i = 0; i < n; i++) {
        campaign->n_groups = i + 1;
        WB_TRY(read_group(campaign, wb_config_item(groups, i), &campaign->groups[i]));
        for (int k = 0; k < i; k++) {
            if (strcmp(campaign->groups[k].name, campaign->groups[i].name) == 0)
                return wb_config_refuse(wb_config_item(groups, i), "name",
                                        "'%s' stands there twice", campaign->groups[i].name);
        }
    }
    return cable ? read_cable(campaign, cable) : WB_OK;
}

void wb_machines_release(void *context)
{
    struct wb_machines *const campaign = context;
    for (int i = 0; i < campaign->n_groups; i++)
        free(campaign->groups[i].tests);
    free(campaign->groups);
    campaign->groups = NULL;
    campaign->n_groups = 0;
}
