#include "fe/material/material_file.h"

#include <math.h>

#include "base/config.h"
#include "base/units.h"
#include "fe/material/hardening.h"

enum {
    WITHOUT_PARAMETERS = 11 /* keys of a file */
};

static bool is_given(const struct wb_config_node *root, int parameter)
{
    return wb_config_find(root, wb_hardening_parameters[parameter].key) != NULL;
}

/* A law has all of its parameters, or none if it may be perfectly plastic. */
static enum wb_status check_parameters(const struct wb_config_node *root,
                                       const struct wb_hardening_law *law)
{
    const char *given = NULL, *missing = NULL; /* the first ones */

    for (int i = 0; i < WB_HARDENING_PARAMETERS; i++) {
        const char *const key = wb_hardening_parameters[i].key;
        if (is_given(root, i) && !law->has[i])
            return wb_config_refuse(root, key, "%s hardening does not use %s", law->name, key);
        if (law->has[i] && is_given(root, i) && !given)
            given = key;
        if (law->has[i] && !is_given(root, i) && !missing)
            missing = key;
    }
    if (missing && !law->may_be_perfect)
        return wb_config_refuse(root, "hardening", "%s hardening needs %s", law->name, missing);
    if (missing && given)
        return wb_config_refuse(root, given, "%s must be given together with %s", given, missing);
    return WB_OK;
}

static enum wb_status check(const struct wb_config_node *root, const struct wb_hardening_law *law)
{
    bool hardens = wb_config_find(root, "hardening");

    if (wb_config_find(root, "yield_stress_MPa"))
        return check_parameters(root, law);
    for (int i = 0; i < WB_HARDENING_PARAMETERS; i++)
        hardens = hardens || is_given(root, i);
    if (hardens)
        return wb_config_refuse(root, "yield_stress_MPa",
                                "this key is missing: a material that hardens needs it");
    return WB_OK;
}

/* Intervals of the numbers, each [least, most]. */
static enum wb_status read_intervals(const struct wb_config_node *map,
                                     struct wb_material_file *file)
{
    static const struct {
        const char *key;
        double unit;
    } numbers[WB_MATERIAL_NUMBERS] = {
        {"youngs_modulus_MPa", WB_MPA},
        {"yield_stress_MPa", WB_MPA},
        {"strength_coefficient_MPa", WB_MPA},
        {"hardening_exponent", 1.0},
    };
    const struct wb_config_node *nodes[WB_MATERIAL_NUMBERS];
    struct wb_config_key keys[WB_MATERIAL_NUMBERS];
    for (int i = 0; i < WB_MATERIAL_NUMBERS; i++) {
        const struct wb_config_key key = WB_CONFIG_OPTIONAL_NODE(numbers[i].key, &nodes[i]);
        keys[i] = key;
    }
    WB_TRY(wb_config_map(map, keys, WB_MATERIAL_NUMBERS));
    for (int i = 0; i < WB_MATERIAL_NUMBERS; i++) {
        const struct wb_config_key key =
            WB_CONFIG_NUMBER(numbers[i].key, NULL, numbers[i].unit, 0.0, 1e8);
        int n;
        if (!nodes[i])
            continue;
        WB_TRY(wb_config_numbers(nodes[i], &key, 2, 2, file->interval[i], &n));
        if (!(file->interval[i][1] >= file->interval[i][0]))
            return wb_config_refuse(map, numbers[i].key, "expected the least first");
    }
    return WB_OK;
}

static enum wb_status read_root(const struct wb_config_node *root, void *into)
{
    struct wb_material_file read = {.name = ""}, *const file = &read;
    struct wb_material *const m = &file->material;
    /* The laws that yield, by name; the first is the default. */
    const char *names[WB_HARDENING_LAWS + 1] = {NULL};
    enum wb_hardening laws[WB_HARDENING_LAWS] = {0};
    const struct wb_config_node *intervals = NULL;
    int hardening = 0, n_laws = 0;
    struct wb_config_key keys[WITHOUT_PARAMETERS + WB_HARDENING_PARAMETERS] = {
        WB_CONFIG_TEXT("name", file->name),
        WB_CONFIG_OPTIONAL_BOOLEAN("substitute", &file->is_substitute),
        WB_CONFIG_TEXT("source", file->source),
        WB_CONFIG_NUMBER("youngs_modulus_MPa", &m->youngs_modulus, WB_MPA, 1e-3, 1e7),
        /* Above this a solid is nearly incompressible. */
        WB_CONFIG_OPTIONAL_NUMBER("poissons_ratio", &m->poissons_ratio, 1.0, -0.99, 0.499),
        WB_CONFIG_NUMBER("density_g_cm3", &file->density, WB_G_PER_CM3, 1e-3, 30.0),
        WB_CONFIG_OPTIONAL_NUMBER("thickness_of_two_layers_mm", &file->thickness, WB_MM, 1e-3,
                                  10.0),
        WB_CONFIG_OPTIONAL_TEXT("origin", file->origin),
        WB_CONFIG_OPTIONAL_NODE("intervals", &intervals),
        WB_CONFIG_OPTIONAL_NUMBER("yield_stress_MPa", &m->yield_stress, WB_MPA, 1e-6, 1e6),
        WB_CONFIG_OPTIONAL_CHOICE("hardening", &hardening, names),
    };
    struct wb_config_key *const of_parameters = keys + WITHOUT_PARAMETERS;

    for (int i = 0; i < WB_HARDENING_LAWS; i++) {
        if (!wb_hardening_laws[i].yields)
            continue;
        names[n_laws] = wb_hardening_laws[i].name;
        laws[n_laws++] = (enum wb_hardening)i;
    }
    for (int i = 0; i < WB_HARDENING_PARAMETERS; i++) {
        const struct wb_hardening_parameter *p = &wb_hardening_parameters[i];
        of_parameters[i] = (struct wb_config_key)WB_CONFIG_OPTIONAL_NUMBER(
            p->key, wb_hardening_value(m, i), p->factor, p->low, p->high);
    }
    m->poissons_ratio = (double)NAN;
    m->hardening_exponent = 1.0;

    for (int i = 0; i < WB_MATERIAL_NUMBERS; i++)
        file->interval[i][0] = file->interval[i][1] = (double)NAN;
    WB_TRY(wb_config_map(root, keys, WB_COUNT(keys)));
    if (intervals)
        WB_TRY(read_intervals(intervals, file));
    WB_TRY(check(root, &wb_hardening_laws[laws[hardening]]));
    m->hardening = m->yield_stress > 0.0 ? laws[hardening] : WB_HARDENING_NONE_ELASTIC;
    *(struct wb_material_file *)into = read;
    return WB_OK;
}

enum wb_status wb_material_file_read(struct wb_material_file *file, const char *path)
{
    return wb_config_load(NULL, path, NULL, read_root, file);
}
