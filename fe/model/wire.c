#include "fe/model/wire.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/circle.h"
#include "base/config.h"
#include "base/units.h"
#include "fe/material/law_file.h"

#define COPPER_MODULUS 120e9
#define STIFFEST_JACKET                                                                            \
    10e9 /* filled polymers; PVC and cross-linked polyethylene are below 3 GPa */
#define FINEST_STRAND 0.05e-3

enum {
    NUMBERS = 6 /* keys of the law: Poisson's ratio, Ludwik's four numbers, and the block */
};

static void set_law_keys(struct wb_material *m, const struct wb_config_node **law,
                         struct wb_config_key keys[NUMBERS])
{
    const struct wb_config_key all[NUMBERS] = {
        WB_CONFIG_NUMBER("youngs_modulus_MPa", &m->youngs_modulus, WB_MPA, 1e-3, 1e7),
        WB_CONFIG_NUMBER("poissons_ratio", &m->poissons_ratio, 1.0, -0.99, 0.5),
        WB_CONFIG_NUMBER("yield_stress_MPa", &m->yield_stress, WB_MPA, 1e-6, 1e6),
        WB_CONFIG_NUMBER("strength_coefficient_MPa", &m->strength_coefficient, WB_MPA, 0.0, 1e9),
        WB_CONFIG_NUMBER("hardening_exponent", &m->hardening_exponent, 1.0, 1e-3, 2.0),
        WB_CONFIG_OPTIONAL_NODE("law", law),
    };
    memcpy(keys, all, sizeof all);
}

static enum wb_status take_law(const struct wb_config_node *law, struct wb_wire *wire)
{
    wire->material.hardening = WB_HARDENING_ISOTROPIC_POWER;
    WB_TRY(wb_law_file_read(law, &wire->material, &wire->law));
    wire->has_properties = true;
    return WB_OK;
}

static enum wb_status read_properties(const struct wb_config_node *node, struct wb_wire *wire)
{
    const struct wb_config_node *law = NULL;
    struct wb_config_key keys[NUMBERS + 1] = {WB_CONFIG_OPTIONAL_TEXT("source", wire->source)};
    set_law_keys(&wire->material, &law, keys + 1);
    WB_TRY(wb_config_map(node, keys, WB_COUNT(keys)));
    return take_law(law, wire);
}

/* Of the properties file that `wirebench calibrate -o` writes, what describes a wire; its other
 * keys are those of analysis/calibration/properties. */
static enum wb_status read_calibrated(const struct wb_config_node *root, struct wb_wire *wire)
{
    const struct wb_config_node *law = NULL;
    double mass = 0.0;
    struct wb_config_key keys[NUMBERS + 3] = {
        WB_CONFIG_TEXT("wire", wire->name),
        WB_CONFIG_NUMBER("outer_diameter_mm", &wire->outer_diameter, WB_MM, 1e-3, 1e3),
        WB_CONFIG_NUMBER("mass_per_length_kg_m", &mass, 1.0, 0.0, 1e3),
    };
    set_law_keys(&wire->material, &law, keys + 3);
    for (size_t i = 0; i < WB_COUNT(keys); i++) {
        const struct wb_config_node *const node = wb_config_find(root, keys[i].name);
        if (node)
            WB_TRY(wb_config_value(node, &keys[i]));
        else if (!keys[i].optional)
            return wb_config_refuse(root, keys[i].name, "this key is missing");
    }
    const double d = wire->outer_diameter;
    wire->density = mass / (M_PI * d * d / 4.0);
    snprintf(wire->source, sizeof wire->source, "%s", wb_config_origin(root));
    return take_law(law, wire);
}

static enum wb_status read_wire(const struct wb_config_node *root, void *wire)
{
    const struct wb_config_node *properties = NULL;
    struct wb_wire w = {0};
    const struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("name", w.name),
        WB_CONFIG_NUMBER("conductor_diameter_mm", &w.conductor_diameter, WB_MM, 0.0, 1e3),
        WB_CONFIG_NUMBER("outer_diameter_mm", &w.outer_diameter, WB_MM, 1e-3, 1e3),
        WB_CONFIG_NUMBER("density_g_cm3", &w.density, WB_G_PER_CM3, 1e-3, 30.0),
        WB_CONFIG_OPTIONAL_NUMBER("u_outer_diameter_mm", &w.outer_diameter_uncertainty, WB_MM, 1e-5,
                                  100.0),
        WB_CONFIG_OPTIONAL_NUMBER("u_density_percent", &w.density_uncertainty, WB_PERCENT, 1e-4,
                                  50.0),
        WB_CONFIG_OPTIONAL_NODE("properties", &properties),
    };

    if (wb_config_find(root, "wire") && !wb_config_find(root, "name")) {
        WB_TRY(read_calibrated(root, &w));
        *(struct wb_wire *)wire = w;
        return WB_OK;
    }
    WB_TRY(wb_config_map(root, keys, WB_COUNT(keys)));
    if (w.conductor_diameter > w.outer_diameter)
        return wb_config_refuse(root, "conductor_diameter_mm",
                                "%g mm is more than outer_diameter_mm, %g mm",
                                w.conductor_diameter / WB_MM, w.outer_diameter / WB_MM);
    if (properties)
        WB_TRY(read_properties(properties, &w));
    *(struct wb_wire *)wire = w;
    return WB_OK;
}

enum wb_status wb_wire_read(const char *path, struct wb_wire *wire, struct wb_reason *why)
{
    return wb_config_load(NULL, path, why, read_wire, wire);
}

enum wb_status wb_wire_parse(const char *text, const char *origin, struct wb_wire *wire,
                             struct wb_reason *why)
{
    return wb_config_load(text, origin, why, read_wire, wire);
}

double wb_wire_second_moment(const struct wb_wire *wire)
{
    return wb_circle_second_moment(wire->outer_diameter);
}

double wb_wire_mass_per_length(const struct wb_wire *wire)
{
    return wire->density * M_PI * wire->outer_diameter * wire->outer_diameter / 4.0;
}

/* E I of strands that slide freely, with the least metal that such wires have. */
static double least_rigidity(const struct wb_wire *wire)
{
    const double conductor = wire->conductor_diameter, outer = wire->outer_diameter;
    const double metal = conductor > 0.0 ? 0.75 * M_PI / 4.0 * conductor * conductor
                                         : M_PI / 4.0 / 6.0 * outer * outer;
    return COPPER_MODULUS * metal * FINEST_STRAND * FINEST_STRAND / 16.0;
}

static double largest_rigidity(const struct wb_wire *wire)
{
    /* A bundle has no single conductor: assume copper over the whole diameter. */
    const double conductor =
        wire->conductor_diameter > 0.0 ? wire->conductor_diameter : wire->outer_diameter;
    const double inner = wb_circle_second_moment(conductor);
    return COPPER_MODULUS * inner +
           STIFFEST_JACKET * (wb_circle_second_moment(wire->outer_diameter) - inner);
}

void wb_wire_stiffness_bounds(const struct wb_wire *wire, double length, double *lowest,
                              double *highest)
{
    const double bending = 3.0 / pow(length, 3.0);
    *lowest = bending * least_rigidity(wire);
    *highest = bending * largest_rigidity(wire);
    if (wire->has_properties) {
        const double known = bending * wb_wire_second_moment(wire);
        const double one = wire->material.youngs_modulus;
        const double other = wire->law.material.youngs_modulus;
        *lowest = known * fmin(one, other) / 3.0;
        *highest = known * fmax(one, other) * 3.0;
    }
}
