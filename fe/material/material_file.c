#include "fe/material/material_file.h"

#include <math.h>

#include "base/config.h"
#include "base/units.h"
#include "fe/material/hardening.h"

enum {
    WITHOUT_PARAMETERS = 11 /* keys of a file */
};

/* Which of the optional keys were given. */
struct given {
    bool yield, hardening, parameter[WB_HARDENING_PARAMETERS];
};

/* A law has all of its parameters, or none of them if it is perfectly plastic then. */
static enum wb_status check_parameters(const struct wb_config_node *root, const struct given *given,
                                       const struct wb_hardening_law *law)
{
    int first_given = -1, first_missing = -1;

    for (int i = 0; i < WB_HARDENING_PARAMETERS; i++) {
        const char *key = wb_hardening_parameters[i].key;
        if (given->parameter[i] && !law->has[i])
            return wb_config_refuse(root, key, "%s hardening has no %s", law->name, key);
        if (law->has[i] && given->parameter[i] && first_given < 0)
            first_given = i;
        if (law->has[i] && !given->parameter[i] && first_missing < 0)
            first_missing = i;
    }
    if (first_missing >= 0 && !law->may_be_perfect)
        return wb_config_refuse(root, "hardening", "%s hardening needs %s", law->name,
                                wb_hardening_parameters[first_missing].key);
    if (first_missing >= 0 && first_given >= 0) {
        const bool in_order = first_given < first_missing;
        return wb_config_refuse(
            root, wb_hardening_parameters[first_given].key, "%s and %s go together",
            wb_hardening_parameters[in_order ? first_given : first_missing].key,
            wb_hardening_parameters[in_order ? first_missing : first_given].key);
    }
    return WB_OK;
}

static enum wb_status check(const struct wb_config_node *root, const struct given *given,
                            const struct wb_hardening_law *law)
{
    bool hardens = given->hardening;

    for (int i = 0; i < WB_HARDENING_PARAMETERS; i++)
        hardens = hardens || given->parameter[i];
    if (!given->yield && hardens)
        return wb_config_refuse(root, "yield_stress_MPa",
                                "this key is missing: the material hardens");
    return given->yield ? check_parameters(root, given, law) : WB_OK;
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

static enum wb_status read_root(const struct wb_config_node *root, struct wb_material_file *file)
{
    struct wb_material *const m = &file->material;
    struct given given = {0};
    /* The laws that yield, by name; the first is that of files that name none. */
    const char *names[WB_HARDENING_LAWS + 1] = {NULL};
    enum wb_hardening laws[WB_HARDENING_LAWS] = {0};
    const struct wb_config_node *intervals = NULL;
    int hardening = 0, n_laws = 0;
    struct wb_config_key keys[WITHOUT_PARAMETERS + WB_HARDENING_PARAMETERS] = {
        WB_CONFIG_TEXT("name", file->name),
        WB_CONFIG_OPTIONAL_BOOLEAN("substitute", &file->is_substitute),
        WB_CONFIG_TEXT("source", file->source),
        WB_CONFIG_NUMBER("youngs_modulus_MPa", &m->youngs_modulus, WB_MPA, 1e-3, 1e7),
        /* Beyond this a solid is incompressible. */
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
    of_parameters[-2].present = &given.yield;
    of_parameters[-1].present = &given.hardening;
    for (int i = 0; i < WB_HARDENING_PARAMETERS; i++) {
        const struct wb_hardening_parameter *p = &wb_hardening_parameters[i];
        of_parameters[i] = (struct wb_config_key)WB_CONFIG_OPTIONAL_NUMBER(
            p->key, wb_hardening_value(m, i), p->factor, p->low, p->high);
        of_parameters[i].present = &given.parameter[i];
    }
    m->poissons_ratio = (double)NAN;
    m->hardening_exponent = 1.0;

    for (int i = 0; i < WB_MATERIAL_NUMBERS; i++)
        file->interval[i][0] = file->interval[i][1] = (double)NAN;
    WB_TRY(wb_config_map(root, keys, WB_COUNT(keys)));
    if (intervals)
        WB_TRY(read_intervals(intervals, file));
    WB_TRY(check(root, &given, &wb_hardening_laws[laws[hardening]]));
    m->hardening = given.yield ? laws[hardening] : WB_HARDENING_NONE_ELASTIC;
    return WB_OK;
}

enum wb_status wb_material_file_read(struct wb_material_file *file, const char *path)
{
    struct wb_config *config;
    struct wb_material_file read = {0};
    WB_TRY(wb_config_read(&config, path, NULL));
    const enum wb_status status = read_root(wb_config_root(config), &read);
    wb_config_destroy(config);
    if (status == WB_OK)
        *file = read;
    return status;
}
