/* Properties from the text of a file. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/calibration/properties/method.h"
#include "analysis/calibration/properties/properties_private.h"
#include "analysis/calibration/properties/quantity.h"
#include "base/config.h"
#include "base/file.h"
#include "base/units.h"
#include "fe/material/law_file.h"

/* Limits of the file's values, in its units. */
#define LARGEST_MPA 1e7

static enum wb_status read_deviations(const struct wb_config_node *node, double deviation[4])
{
    const struct wb_config_key keys[] = {
        WB_CONFIG_OPTIONAL_NUMBER("youngs_modulus_MPa", &deviation[0], WB_MPA, 0.0, LARGEST_MPA),
        WB_CONFIG_OPTIONAL_NUMBER("yield_stress_MPa", &deviation[1], WB_MPA, 0.0, LARGEST_MPA),
        WB_CONFIG_OPTIONAL_NUMBER("strength_coefficient_factor", &deviation[2], 1.0, 1.0, 1e300),
        WB_CONFIG_IGNORED("strength_coefficient_MPa"), /* key of older files */
        WB_CONFIG_OPTIONAL_NUMBER("hardening_exponent", &deviation[3], 1.0, 0.0, 100.0),
    };
    WB_TRY(wb_config_map(node, keys, WB_COUNT(keys)));
    deviation[2] = log(deviation[2]);
    return WB_OK;
}

/* A scalar of a map as text, truncated to `size`; "" if missing. */
static void keep_scalar(const struct wb_config_node *map, const char *key, char *text, size_t size)
{
    const struct wb_config_node *const node = wb_config_find(map, key);
    const char *const scalar = node ? wb_config_scalar(node) : NULL;
    snprintf(text, size, "%s", scalar ? scalar : "");
}

/* Reads names and checksums, for citations; a file written by hand may have any structure here. */
static void read_datasets(const struct wb_config_node *node, struct wb_properties *properties)
{
    const int n = node ? wb_config_length(node) : 0;
    properties->n_datasets = n > 0 ? n : 0;
    for (int i = 0; i < n && i < WB_PROPERTIES_MOST_DATASETS; i++) {
        struct wb_properties_dataset *const d = &properties->datasets[i];
        const struct wb_config_node *const item = wb_config_item(node, i);
        char path[WB_PATH];
        d->is_recording = wb_config_find(item, "recording") != NULL;
        keep_scalar(item, d->is_recording ? "recording" : "folder", path, sizeof path);
        for (size_t end = strlen(path); end > 1 && path[end - 1] == '/'; end--)
            path[end - 1] = '\0';
        snprintf(d->name, sizeof d->name, "%.95s", wb_file_name(path));
        keep_scalar(item, d->is_recording ? "recording_sha256" : "force_deflection_sha256",
                    d->sha256, sizeof d->sha256);
    }
}

static enum wb_status read_calibration(const struct wb_config_node *node,
                                       struct wb_properties *properties)
{
    const struct wb_config_node *datasets = NULL, *settings = NULL;
    const struct wb_config_key keys[] = {
        WB_CONFIG_OPTIONAL_NUMBER("length_mm", &properties->calibration_length, WB_MM, 1.0, 1e4),
        WB_CONFIG_OPTIONAL_NUMBER("rms", &properties->rms, 1.0, 0.0, 1e6),
        WB_CONFIG_OPTIONAL_NUMBER("scatter_rms", &properties->scatter_rms, 1.0, 0.0, 1e6),
        WB_CONFIG_OPTIONAL_NUMBER("residual_scatter_rms", &properties->residual_scatter_rms, 1.0,
                                  0.0, 1e6),
        WB_CONFIG_OPTIONAL_INTEGER("samples", &properties->n_samples, 0, 100000),
        WB_CONFIG_OPTIONAL_BOOLEAN("virtual_rig", &properties->is_virtual),
        WB_CONFIG_IGNORED("loading"),
        WB_CONFIG_IGNORED("cut_at_mm"),
        WB_CONFIG_IGNORED("elastic_zone"),
        WB_CONFIG_IGNORED("yield_point"),
        WB_CONFIG_IGNORED("natural_shape"),
        WB_CONFIG_IGNORED("bow_corrected"),
        WB_CONFIG_IGNORED("first_strength_coefficient_MPa"),
        WB_CONFIG_IGNORED("first_hardening_exponent"),
        WB_CONFIG_IGNORED("stopped"),
        WB_CONFIG_IGNORED("evaluations"),
        WB_CONFIG_IGNORED("evaluations_not_converged"),
        WB_CONFIG_IGNORED("restart_moved"),
        WB_CONFIG_IGNORED("max_force_N"),
        WB_CONFIG_IGNORED("max_deflection_mm"),
        WB_CONFIG_IGNORED("max_error"),
        WB_CONFIG_OPTIONAL_BOOLEAN("simulation", &properties->is_simulation),
        WB_CONFIG_IGNORED("tool"),
        WB_CONFIG_OPTIONAL_NODE("settings", &settings),
        WB_CONFIG_OPTIONAL_NODE("datasets", &datasets),
    };
    WB_TRY(wb_config_map(node, keys, WB_COUNT(keys)));
    keep_scalar(node, "tool", properties->tool, sizeof properties->tool);
    read_datasets(datasets, properties);
    const struct wb_config_key pooled =
        WB_CONFIG_INTEGER("pooled_degrees", &properties->pooled_degrees, 1, 100000);
    const struct wb_config_node *const given =
        settings && wb_config_find(settings, "pooled_deviation")
            ? wb_config_find(settings, pooled.name)
            : NULL;
    return given ? wb_config_value(given, &pooled) : WB_OK;
}

/* For a quantity without curvatures `curvature` is NULL. */
static enum wb_status read_estimate(const struct wb_config_node *node,
                                    const struct wb_quantity *row, double *curvature,
                                    struct wb_estimate *e)
{
    const double scale = row->scale, largest = row->largest;
    double unused;
    const struct wb_config_key keys[] = {
        WB_CONFIG_OPTIONAL_NUMBER(row->value_key, &e->value, scale, 0.0, largest),
        WB_CONFIG_OPTIONAL_NUMBER("low", &e->low, scale, 0.0, largest),
        WB_CONFIG_OPTIONAL_NUMBER("high", &e->high, scale, 0.0, largest),
        WB_CONFIG_OPTIONAL_NUMBER("candidates_low", &e->candidates_low, scale, 0.0, largest),
        WB_CONFIG_OPTIONAL_NUMBER("candidates_high", &e->candidates_high, scale, 0.0, largest),
        WB_CONFIG_OPTIONAL_NUMBER("scatter", &e->deviation, 1.0, 0.0, 100.0),
        WB_CONFIG_NUMBER("curvature_1_m", curvature ? curvature : &unused, 1.0, 0.0, 1e6),
    };
    return wb_config_map(node, keys, WB_COUNT(keys) - (curvature ? 0 : 1));
}

/* A list of estimates at ascending curvatures. */
static enum wb_status read_list(const struct wb_config_node *list, const struct wb_quantity *row,
                                const char *key, struct wb_properties *properties)
{
    char *const base = (char *)properties;
    double *const curvature = (double *)(void *)(base + row->curvature);
    struct wb_estimate *const estimate = (struct wb_estimate *)(void *)(base + row->estimate);
    const int n = wb_config_length(list);
    if (n < 1 || n > row->most)
        return wb_config_refuse(list, key, "expected a list of 1 to %d curvatures", row->most);
    for (int k = 0; k < n; k++) {
        const struct wb_config_node *const item = wb_config_item(list, k);
        estimate[k] = wb_properties_unknown_estimate;
        WB_TRY(read_estimate(item, row, &curvature[k], &estimate[k]));
        if (k > 0 && !(curvature[k] > curvature[k - 1]))
            return wb_config_refuse(item, "curvature_1_m", "%g: expected more than the one before",
                                    curvature[k]);
    }
    *(int *)(void *)(base + row->n) = n;
    return WB_OK;
}

static enum wb_status read_quantity(const struct wb_config_node *node,
                                    const struct wb_quantity *row, struct wb_properties *properties)
{
    char *const base = (char *)properties;
    const struct wb_config_node *list = NULL;
    if (row->most == 0)
        return read_estimate(node, row, NULL, (struct wb_estimate *)(void *)(base + row->estimate));
    if (row->resolved == 0)
        return read_list(node, row, row->key, properties);
    const struct wb_config_key keys[] = {
        WB_CONFIG_NUMBER("resolved_from_1_m", (double *)(void *)(base + row->resolved), 1.0, 0.0,
                         1e6),
        WB_CONFIG_NODE("at", &list),
    };
    WB_TRY(wb_config_map(node, keys, WB_COUNT(keys)));
    return read_list(list, row, "at", properties);
}

static enum wb_status read_rule(const struct wb_config_node *node, struct wb_properties *properties)
{
    char chosen[64];
    const struct wb_config_key keys[] = {
        WB_CONFIG_OPTIONAL_TEXT("chosen", chosen),
        WB_CONFIG_OPTIONAL_BOOLEAN("tested", &properties->is_rule_tested),
        WB_CONFIG_OPTIONAL_BOOLEAN("supported", &properties->is_rule_supported),
        WB_CONFIG_IGNORED("ranked"),
    };
    return wb_config_map(node, keys, WB_COUNT(keys));
}

static enum wb_status read_three_point(const struct wb_config_node *node,
                                       struct wb_properties *properties)
{
    const struct wb_config_key keys[] = {
        WB_CONFIG_OPTIONAL_INTEGER("series", &properties->n_series, 0, 100000),
        WB_CONFIG_IGNORED("span_mm"),
        WB_CONFIG_IGNORED("roller_radius_mm"),
        WB_CONFIG_IGNORED("nose_radius_mm"),
        WB_CONFIG_IGNORED("friction"),
        WB_CONFIG_IGNORED("compliance_mm_N"),
        WB_CONFIG_IGNORED("compliance_known"),
        WB_CONFIG_IGNORED("series_deviation"),
        WB_CONFIG_IGNORED("bands"),
        WB_CONFIG_IGNORED("tests"),
    };
    return wb_config_map(node, keys, WB_COUNT(keys));
}

static enum wb_status read_specimens(const struct wb_config_node *node,
                                     struct wb_properties *properties)
{
    const int n = wb_config_length(node);
    if (n < 1 || n > WB_PROPERTIES_MOST_SPECIMENS)
        return wb_config_refuse(node, "specimens", "expected a list of 1 to %d specimens",
                                WB_PROPERTIES_MOST_SPECIMENS);
    for (int i = 0; i < n; i++) {
        struct wb_properties_specimen *const s = &properties->specimens[i];
        struct wb_material *const m = &s->ludwik;
        const struct wb_config_key keys[] = {
            WB_CONFIG_INTEGER("sample", &s->sample, 0, 1000000),
            WB_CONFIG_NUMBER("length_mm", &s->length, WB_MM, 1.0, 1e4),
            WB_CONFIG_OPTIONAL_NUMBER("bow_mm", &s->bow, WB_MM, -1e4, 1e4),
            WB_CONFIG_OPTIONAL_NUMBER("bow_deviation_mm", &s->bow_deviation, WB_MM, 0.0, 1e4),
            WB_CONFIG_OPTIONAL_NUMBER("uneven_bow_mm", &s->uneven_bow, WB_MM, -1e4, 1e4),
            WB_CONFIG_OPTIONAL_NUMBER("level_mm", &s->level, WB_MM, -1e4, 1e4),
            WB_CONFIG_OPTIONAL_NUMBER("misfit", &s->misfit, 1.0, 0.0, 1e6),
            WB_CONFIG_NUMBER("youngs_modulus_MPa", &m->youngs_modulus, WB_MPA, 1e-6, LARGEST_MPA),
            WB_CONFIG_NUMBER("yield_stress_MPa", &m->yield_stress, WB_MPA, 1e-6, LARGEST_MPA),
            WB_CONFIG_NUMBER("strength_coefficient_MPa", &m->strength_coefficient, WB_MPA, 0.0,
                             LARGEST_MPA),
            WB_CONFIG_NUMBER("hardening_exponent", &m->hardening_exponent, 1.0, 1e-3, 2.0),
            WB_CONFIG_OPTIONAL_NUMBER("ludwik_misfit", &s->ludwik_misfit, 1.0, 0.0, 1e6),
        };
        s->bow = s->bow_deviation = s->uneven_bow = s->level = s->misfit = s->ludwik_misfit =
            (double)NAN;
        m->hardening = WB_HARDENING_ISOTROPIC_POWER;
        m->poissons_ratio = properties->material.poissons_ratio;
        WB_TRY(wb_config_map(wb_config_item(node, i), keys, WB_COUNT(keys)));
    }
    properties->n_specimens = n;
    return WB_OK;
}

static enum wb_status read_root(const struct wb_config_node *root, struct wb_properties *properties)
{
    const struct wb_config_node *deviations = NULL, *calibration = NULL, *law = NULL;
    const struct wb_config_node *quantities[WB_QUANTITIES] = {NULL};
    const struct wb_config_node *old_ratio = NULL; /* residual curvature ratio before 0.1.0 */
    const struct wb_config_node *rule = NULL, *specimens = NULL, *three_point = NULL;
    int method = -1;
    struct wb_material *const material = &properties->material;
    const struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("wire", properties->wire),
        WB_CONFIG_NUMBER("outer_diameter_mm", &properties->outer_diameter, WB_MM, 1e-3, 1e3),
        WB_CONFIG_NUMBER("mass_per_length_kg_m", &properties->mass_per_length, 1.0, 0.0, 1e3),
        WB_CONFIG_NUMBER("youngs_modulus_MPa", &material->youngs_modulus, WB_MPA, 1e-6,
                         LARGEST_MPA),
        WB_CONFIG_NUMBER("yield_stress_MPa", &material->yield_stress, WB_MPA, 1e-6, LARGEST_MPA),
        WB_CONFIG_NUMBER("strength_coefficient_MPa", &material->strength_coefficient, WB_MPA, 0.0,
                         LARGEST_MPA),
        WB_CONFIG_NUMBER("hardening_exponent", &material->hardening_exponent, 1.0, 1e-3, 2.0),
        WB_CONFIG_NUMBER("poissons_ratio", &material->poissons_ratio, 1.0, -0.99, 0.5),
        WB_CONFIG_OPTIONAL_NODE("deviations", &deviations),
        WB_CONFIG_OPTIONAL_NODE("calibration", &calibration),
        WB_CONFIG_OPTIONAL_CHOICE("method", &method, wb_method_names),
        WB_CONFIG_OPTIONAL_NODE("law", &law),
        WB_CONFIG_OPTIONAL_NUMBER("ludwik_misfit", &properties->ludwik_misfit, 1.0, 0.0, 1e6),
        WB_CONFIG_OPTIONAL_NODE("springback_ratio", &old_ratio),
        WB_CONFIG_OPTIONAL_NUMBER("largest_curvature_1_m", &properties->largest_curvature, 1.0,
                                  1e-6, 1e6),
        WB_CONFIG_OPTIONAL_NODE("hardening_rule", &rule),
        WB_CONFIG_OPTIONAL_NODE("specimens", &specimens),
        WB_CONFIG_OPTIONAL_NODE("three_point", &three_point),
#define QUANTITY(id) WB_CONFIG_OPTIONAL_NODE(wb_quantity_rows[id].key, &quantities[id])
        QUANTITY(WB_QUANTITY_MOMENT),
        QUANTITY(WB_QUANTITY_UNLOADING_STIFFNESS),
        QUANTITY(WB_QUANTITY_RESIDUAL_CURVATURE_RATIO),
        QUANTITY(WB_QUANTITY_SPRINGBACK),
        QUANTITY(WB_QUANTITY_LOOP_ENERGY),
        QUANTITY(WB_QUANTITY_SECANT_STIFFNESS),
        QUANTITY(WB_QUANTITY_RIGIDITY),
#undef QUANTITY
    };
    material->hardening = WB_HARDENING_ISOTROPIC_POWER;
    WB_TRY(wb_config_map(root, keys, WB_COUNT(keys)));
    if (method < 0 && calibration)
        method = WB_METHOD_PAPER; /* which does not write the key */
    if (method >= 0)
        snprintf(properties->method, sizeof properties->method, "%s", wb_method_names[method]);
    if (deviations)
        WB_TRY(read_deviations(deviations, properties->deviation));
    if (calibration)
        WB_TRY(read_calibration(calibration, properties));
    WB_TRY(wb_law_file_read(law, material, &properties->law));
    if (!quantities[WB_QUANTITY_RESIDUAL_CURVATURE_RATIO])
        quantities[WB_QUANTITY_RESIDUAL_CURVATURE_RATIO] = old_ratio;
    for (enum wb_quantity_id id = 0; id < WB_QUANTITIES; id++) {
        if (quantities[id])
            WB_TRY(read_quantity(quantities[id], &wb_quantity_rows[id], properties));
    }
    if (rule)
        WB_TRY(read_rule(rule, properties));
    if (three_point)
        WB_TRY(read_three_point(three_point, properties));
    return specimens ? read_specimens(specimens, properties) : WB_OK;
}

static enum wb_status take(struct wb_config *config, struct wb_properties *properties)
{
    struct wb_properties read;
    wb_properties_make_unknown(&read);
    const enum wb_status status = read_root(wb_config_root(config), &read);
    wb_config_destroy(config);
    wb_properties_find_deviation(&read);
    if (status == WB_OK)
        *properties = read;
    return status;
}

enum wb_status wb_properties_read(const char *path, struct wb_properties *properties)
{
    struct wb_config *config;
    WB_TRY(wb_config_read(&config, path, NULL));
    return take(config, properties);
}

enum wb_status wb_properties_parse(const char *text, const char *origin,
                                   struct wb_properties *properties, struct wb_reason *why)
{
    struct wb_config *config;
    WB_TRY(wb_config_parse(&config, text, origin, why));
    return take(config, properties);
}
