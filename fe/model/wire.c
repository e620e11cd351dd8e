#include "fe/model/wire.h"

#include <math.h>

#include "base/config.h"
#include "base/units.h"
#include "fe/material/law_file.h"

static enum wb_status read_properties(const struct wb_config_node *node, struct wb_wire *wire)
{
    struct wb_material *m = &wire->material;
    const struct wb_config_node *law = NULL;
    const struct wb_config_key keys[] = {
        WB_CONFIG_OPTIONAL_TEXT("source", wire->source),
        WB_CONFIG_NUMBER("youngs_modulus_MPa", &m->youngs_modulus, WB_MPA, 1e-3, 1e7),
        WB_CONFIG_NUMBER("poissons_ratio", &m->poissons_ratio, 1.0, -0.99, 0.5),
        WB_CONFIG_NUMBER("yield_stress_MPa", &m->yield_stress, WB_MPA, 1e-6, 1e6),
        WB_CONFIG_NUMBER("strength_coefficient_MPa", &m->strength_coefficient, WB_MPA, 0.0, 1e9),
        WB_CONFIG_NUMBER("hardening_exponent", &m->hardening_exponent, 1.0, 1e-3, 2.0),
        WB_CONFIG_OPTIONAL_NODE("law", &law),
    };

    WB_TRY(wb_config_map(node, keys, WB_COUNT(keys)));
    m->hardening = WB_HARDENING_ISOTROPIC_POWER;
    WB_TRY(wb_law_file_read(law, m, &wire->law));
    wire->has_properties = true;
    return WB_OK;
}

static enum wb_status read_wire(const struct wb_config_node *root, struct wb_wire *wire)
{
    const struct wb_config_node *properties = NULL;
    struct wb_wire w = {0};
    const struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("name", w.name),
        WB_CONFIG_NUMBER("conductor_diameter_mm", &w.conductor_diameter, WB_MM, 0.0, 1e3),
        WB_CONFIG_NUMBER("outer_diameter_mm", &w.outer_diameter, WB_MM, 1e-3, 1e3),
        WB_CONFIG_NUMBER("density_g_cm3", &w.density, WB_G_PER_CM3, 1e-3, 30.0),
        WB_CONFIG_OPTIONAL_NODE("properties", &properties),
    };

    WB_TRY(wb_config_map(root, keys, WB_COUNT(keys)));
    if (w.conductor_diameter > w.outer_diameter)
        return wb_config_refuse(root, "conductor_diameter_mm",
                                "%g mm is more than outer_diameter_mm, %g mm",
                                w.conductor_diameter / WB_MM, w.outer_diameter / WB_MM);
    if (properties)
        WB_TRY(read_properties(properties, &w));
    *wire = w;
    return WB_OK;
}

static enum wb_status take(struct wb_config *config, struct wb_wire *wire)
{
    const enum wb_status status = read_wire(wb_config_root(config), wire);
    wb_config_destroy(config);
    return status;
}

enum wb_status wb_wire_read(const char *path, struct wb_wire *wire, struct wb_reason *why)
{
    struct wb_config *config = NULL;
    WB_TRY(wb_config_read(&config, path, why));
    return take(config, wire);
}

enum wb_status wb_wire_parse(const char *text, const char *origin, struct wb_wire *wire,
                             struct wb_reason *why)
{
    struct wb_config *config = NULL;
    WB_TRY(wb_config_parse(&config, text, origin, why));
    return take(config, wire);
}

double wb_wire_second_moment(const struct wb_wire *wire)
{
    return M_PI * pow(wire->outer_diameter, 4.0) / 64.0;
}

double wb_wire_mass_per_length(const struct wb_wire *wire)
{
    return wire->density * M_PI * wire->outer_diameter * wire->outer_diameter / 4.0;
}
