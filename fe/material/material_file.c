#include "fe/material/material_file.h"

#include <math.h>

#include "base/config.h"
#include "base/units.h"

static const char *const hardening_names[] = {"isotropic", "kinematic", NULL};

/* Which of the optional keys were given. */
struct given {
    bool yield, hardening, coefficient, exponent;
};

static enum wb_status check(const struct wb_config_node *root, const struct given *given,
                            bool is_kinematic)
{
    if (!given->yield && (given->hardening || given->coefficient || given->exponent))
        return wb_config_refuse(root, "yield_stress_MPa",
                                "this key is missing: the material hardens");
    if (is_kinematic && given->exponent)
        return wb_config_refuse(root, "hardening_exponent",
                                "kinematic hardening is linear and has no exponent");
    if (is_kinematic && !given->coefficient)
        return wb_config_refuse(root, "hardening",
                                "kinematic hardening needs strength_coefficient_MPa");
    if (!is_kinematic && given->coefficient != given->exponent)
        return wb_config_refuse(root,
                                given->exponent ? "hardening_exponent" : "strength_coefficient_MPa",
                                "strength_coefficient_MPa and hardening_exponent go together");
    return WB_OK;
}

static enum wb_status read_root(const struct wb_config_node *root, struct wb_material_file *file)
{
    struct wb_material *const m = &file->material;
    struct given given = {0};
    int hardening = 0;
    struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("name", file->name),
        WB_CONFIG_OPTIONAL_BOOLEAN("substitute", &file->is_substitute),
        WB_CONFIG_TEXT("source", file->source),
        WB_CONFIG_NUMBER("youngs_modulus_MPa", &m->youngs_modulus, WB_MPA, 1e-3, 1e7),
        /* Beyond this a solid is incompressible. */
        WB_CONFIG_OPTIONAL_NUMBER("poissons_ratio", &m->poissons_ratio, 1.0, -0.99, 0.499),
        WB_CONFIG_OPTIONAL_NUMBER("yield_stress_MPa", &m->yield_stress, WB_MPA, 1e-6, 1e6),
        WB_CONFIG_OPTIONAL_CHOICE("hardening", &hardening, hardening_names),
        WB_CONFIG_OPTIONAL_NUMBER("strength_coefficient_MPa", &m->strength_coefficient, WB_MPA, 0.0,
                                  1e9),
        WB_CONFIG_OPTIONAL_NUMBER("hardening_exponent", &m->hardening_exponent, 1.0, 1e-3, 2.0),
        WB_CONFIG_NUMBER("density_g_cm3", &file->density, WB_G_PER_CM3, 1e-3, 30.0),
        WB_CONFIG_OPTIONAL_NUMBER("thickness_of_two_layers_mm", &file->thickness, WB_MM, 1e-3,
                                  10.0),
    };
    keys[5].present = &given.yield;
    keys[6].present = &given.hardening;
    keys[7].present = &given.coefficient;
    keys[8].present = &given.exponent;
    m->poissons_ratio = (double)NAN;
    m->hardening_exponent = 1.0;

    WB_TRY(wb_config_map(root, keys, WB_COUNT(keys)));
    WB_TRY(check(root, &given, hardening == 1));
    m->hardening = !given.yield     ? WB_HARDENING_NONE_ELASTIC
                   : hardening == 1 ? WB_HARDENING_KINEMATIC_LINEAR
                                    : WB_HARDENING_ISOTROPIC_POWER;
    return WB_OK;
}

enum wb_status wb_material_file_read(struct wb_material_file *file, const char *path)
{
    struct wb_config *config;
    struct wb_material_file read = {0};
    WB_TRY(wb_config_read(&config, path));
    const enum wb_status status = read_root(wb_config_root(config), &read);
    wb_config_destroy(config);
    if (status == WB_OK)
        *file = read;
    return status;
}
