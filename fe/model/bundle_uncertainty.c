#include "fe/model/bundle_uncertainty.h"

#include <string.h>

#include "base/units.h"
#include "fe/model/model_file.h"

#define WB_LOG_DOMAIN "bundle"

/* A larger tolerance is taken as a typing error: the model does not hold for half the value. */
static const double most_tolerance = 50.0; /* percent */

const char *const wb_bundle_uncertainty_outlines[] = {"hull", "circle", NULL};

static const char *const lattices[] = {"hexagon", "triangle", "densest", NULL};

/* --- wires --- */

static enum wb_status read_spread(void *uncertainty, const struct wb_config_node *map)
{
    struct wb_bundle_uncertainty *const u = uncertainty;
    struct wb_bundle_spread *const spread = &u->wire[u->n_wires];
    char name[WB_PATH] = "", folder[WB_PATH];
    const struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("wire", spread->wire),
        WB_CONFIG_OPTIONAL_TEXT("properties", name),
        WB_CONFIG_OPTIONAL_NUMBER("youngs_modulus_percent", &spread->youngs_modulus, WB_PERCENT,
                                  0.0, most_tolerance),
        WB_CONFIG_OPTIONAL_NUMBER("yield_stress_percent", &spread->yield_stress, WB_PERCENT, 0.0,
                                  most_tolerance),
        WB_CONFIG_OPTIONAL_NUMBER("stress_percent", &spread->stress, WB_PERCENT, 0.0,
                                  most_tolerance),
    };
    WB_TRY(wb_config_map(map, keys, WB_COUNT(keys)));
    spread->line = wb_config_line(map);
    int n_tolerances = 0;
    for (size_t i = 2; i < WB_COUNT(keys); i++)
        n_tolerances += wb_config_find(map, keys[i].name) != NULL;
    spread->has_tolerances = n_tolerances == 3;
    if (n_tolerances == 1 || n_tolerances == 2)
        return wb_config_refuse(map, "wire",
                                "%s: of youngs_modulus_percent, yield_stress_percent and "
                                "stress_percent all three are needed (0: exact)",
                                spread->wire);
    if (!spread->has_tolerances && name[0] == '\0')
        return wb_config_refuse(map, "wire",
                                "%s: expected properties: FILE (of calibrate, with specimens), or "
                                "youngs_modulus_percent, yield_stress_percent and stress_percent",
                                spread->wire);
    for (int i = 0; i < u->n_wires; i++)
        if (strcmp(u->wire[i].wire, spread->wire) == 0)
            return wb_config_refuse(map, "wire", "%s is given twice", spread->wire);
    u->n_wires++;
    if (name[0] == '\0')
        return WB_OK;
    wb_file_folder(folder, wb_config_origin(map));
    return wb_file_join(spread->properties, name[0] == '/' ? "" : folder, name);
}

/* --- tape and interface --- */

static enum wb_status read_tape(struct wb_bundle_uncertainty *u, const struct wb_config_node *map)
{
    const struct wb_config_key keys[] = {
        WB_CONFIG_NUMBER("thickness_percent", &u->tape_thickness, WB_PERCENT, 0.0, most_tolerance),
        WB_CONFIG_NUMBER("youngs_modulus_percent", &u->tape_modulus, WB_PERCENT, 0.0,
                         most_tolerance),
        WB_CONFIG_NUMBER("yield_stress_percent", &u->tape_yield_stress, WB_PERCENT, 0.0,
                         most_tolerance),
    };
    u->has_tape = true;
    return wb_config_map(map, keys, WB_COUNT(keys));
}

/* [least, largest], both above zero: the logarithm is uniformly distributed between them. */
static enum wb_status read_range(const struct wb_config_node *section,
                                 const struct wb_config_node *list, const struct wb_config_key *key,
                                 double range[2])
{
    int n;
    WB_TRY(wb_config_numbers(list, key, 2, 2, range, &n));
    if (range[0] <= range[1])
        return WB_OK;
    return wb_config_refuse(section, key->name, "expected [least, largest]");
}

/* --- scenarios --- */

static enum wb_status read_scenario(void *uncertainty, const struct wb_config_node *map)
{
    struct wb_bundle_uncertainty *const u = uncertainty;
    struct wb_bundle_variant *const variant = &u->scenario[u->n_scenarios];
    const struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("name", variant->name),
        WB_CONFIG_OPTIONAL_INTEGER("wires", &variant->wires, 1, 128),
        WB_CONFIG_OPTIONAL_CHOICE("packing", &variant->packing, lattices),
        WB_CONFIG_OPTIONAL_INTEGER("layers", &variant->layers, 1, 20),
        WB_CONFIG_OPTIONAL_NUMBER("overlap_percent", &variant->lap, WB_PERCENT, 0.0, 95.0),
        WB_CONFIG_OPTIONAL_CHOICE("outline", &variant->outline, wb_bundle_uncertainty_outlines),
        WB_CONFIG_OPTIONAL_NUMBER("bond_reach_mm", &variant->reach, WB_MM, 0.0, 1.0),
    };
    WB_TRY(wb_config_map(map, keys, WB_COUNT(keys)));
    variant->has_packing = wb_config_find(map, "packing");
    variant->has_outline = wb_config_find(map, "outline");
    variant->has_reach = wb_config_find(map, "bond_reach_mm");
    WB_TRY(wb_model_file_check_name(map, variant->name));
    if (variant->has_reach != variant->has_outline)
        return wb_config_refuse(map, variant->has_reach ? "bond_reach_mm" : "outline",
                                "outline and bond_reach_mm must be given together");
    for (int i = 0; i < u->n_scenarios; i++)
        if (strcmp(u->scenario[i].name, variant->name) == 0)
            return wb_config_refuse(map, "name", "another scenario has the name %s", variant->name);
    u->n_scenarios++;
    return WB_OK;
}

enum wb_status wb_bundle_uncertainty_read(struct wb_bundle_uncertainty *u,
                                          const struct wb_config_node *map)
{
    static const struct wb_config_key cohesion = {.name = "cohesive_stiffness_N_mm3",
                                                  .factor = WB_N_PER_MM3,
                                                  .minimum = 1e-6,
                                                  .maximum = 1e9};
    static const struct wb_config_key friction = {
        .name = "friction", .factor = 1.0, .minimum = 1e-3, .maximum = 10.0};
    const struct wb_config_node *wires, *tape, *stiffness, *coefficient, *scenarios;
    const struct wb_config_key keys[] = {
        WB_CONFIG_NODE("wires", &wires),
        WB_CONFIG_NUMBER("diameter_percent", &u->diameter, WB_PERCENT, 0.0, most_tolerance),
        WB_CONFIG_NUMBER("pitch_percent", &u->pitch, WB_PERCENT, 0.0, most_tolerance),
        WB_CONFIG_NUMBER("length_percent", &u->length, WB_PERCENT, 0.0, most_tolerance),
        WB_CONFIG_OPTIONAL_NODE("tape", &tape),
        WB_CONFIG_OPTIONAL_NODE("cohesive_stiffness_N_mm3", &stiffness),
        WB_CONFIG_OPTIONAL_NODE("friction", &coefficient),
        WB_CONFIG_OPTIONAL_NODE("scenarios", &scenarios),
    };
    WB_TRY(wb_config_map(map, keys, WB_COUNT(keys)));
    WB_TRY(wb_model_file_list(map, "wires", wires, WB_BUNDLE_UNCERTAINTY_WIRES, read_spread, u));
    if (tape)
        WB_TRY(read_tape(u, tape));
    if (stiffness)
        WB_TRY(read_range(map, stiffness, &cohesion, u->cohesion));
    if (coefficient)
        WB_TRY(read_range(map, coefficient, &friction, u->friction));
    u->has_cohesion = stiffness != NULL;
    u->has_friction = coefficient != NULL;
    return scenarios ? wb_model_file_list(map, "scenarios", scenarios,
                                          WB_BUNDLE_UNCERTAINTY_SCENARIOS, read_scenario, u)
                     : WB_OK;
}
