#include "analysis/properties.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/config.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/number.h"
#include "base/text.h"
#include "base/units.h"
#include "base/version.h"

#define WB_LOG_DOMAIN "properties"

/* Limits of the file's numbers, in its units. */
#define LARGEST_MPA 1e7

void wb_properties_from_result(const struct wb_calibrate_result *result,
                               struct wb_properties *properties)
{
    memset(properties, 0, sizeof *properties);
    snprintf(properties->wire, sizeof properties->wire, "%s", result->info.wire);
    properties->outer_diameter = result->info.outer_diameter;
    properties->mass_per_length = result->info.mass_per_length;
    properties->material = result->material;
    wb_law_init_ludwik(&properties->law, &properties->material);
    properties->largest_curvature = properties->stiffness_deviation = (double)NAN;
    memcpy(properties->deviation, result->deviation, sizeof properties->deviation);
    properties->calibration_length = result->info.length;
    properties->rms = result->rms;
    properties->scatter_rms = result->n_samples > 1 ? result->scatter_rms : (double)NAN;
    properties->residual_scatter_rms =
        result->n_samples > 1 ? result->residual_scatter_rms : (double)NAN;
    properties->n_samples = result->n_samples;
    properties->is_virtual = result->info.is_virtual;
}

/* "  key: value" with a number that reads back the same; nothing when it is not known. */
static void put_number(struct wb_text *text, const char *indent, const char *key, double value)
{
    char number[WB_NUMBER_TEXT];
    if (isfinite(value))
        wb_text_append(text, "%s%s: %s\n", indent, key, wb_number_format(value, number));
}

/* A double-quoted YAML scalar. */
static void put_quoted(struct wb_text *text, const char *value)
{
    wb_text_append(text, "\"");
    for (const char *c = value; *c; c++) {
        if (*c == '"' || *c == '\\')
            wb_text_append(text, "\\%c", *c);
        else if ((unsigned char)*c < 0x20 || *c == 0x7f)
            wb_text_append(text, "\\x%02x", (unsigned char)*c);
        else
            wb_text_append_bytes(text, c, 1);
    }
    wb_text_append(text, "\"");
}

static void put_datasets(struct wb_text *text, const char *const *names, int n)
{
    wb_text_append(text, n > 0 ? "  datasets:\n" : "  datasets: []\n");
    for (int i = 0; i < n; i++) {
        char path[WB_PATH], hex[WB_SHA256_TEXT];
        wb_text_append(text, "    - folder: ");
        put_quoted(text, names[i]);
        wb_text_append(text, "\n");
        if (wb_file_join(path, names[i], "force_deflection.csv") == WB_OK && wb_file_exists(path) &&
            wb_hash_file(path, hex) == WB_OK)
            wb_text_append(text, "      force_deflection_sha256: %s\n", hex);
    }
}

static void put_calibration(struct wb_text *text, const struct wb_calibrate_result *result,
                            const struct wb_calibrate_settings *settings)
{
    wb_text_append(text, "calibration:\n");
    put_number(text, "  ", "length_mm", result->info.length / WB_MM);
    if (result->info.is_follower)
        wb_text_append(text, "  loading: follower\n");
    if (settings->largest_deflection > 0.0)
        put_number(text, "  ", "cut_at_mm", settings->largest_deflection / WB_MM);
    put_number(text, "  ", "elastic_zone", settings->elastic_zone);
    put_number(text, "  ", "yield_point", wb_calibrate_settings_meant(settings).yield_point);
    wb_text_append(text, "  natural_shape: %s\n",
                   settings->straight || result->info.n_natural_shape == 0 ? "straight" : "mean");
    wb_text_append(text, "  bow_corrected: %s\n", result->bow_corrected ? "true" : "false");
    put_number(text, "  ", "first_strength_coefficient_MPa",
               result->first_strength_coefficient / WB_MPA);
    put_number(text, "  ", "first_hardening_exponent", result->first_hardening_exponent);
    wb_text_append(text, "  stopped: %s\n", wb_calibrate_end_text(result->end));
    wb_text_append(text, "  evaluations: %d\n", result->evaluations);
    wb_text_append(text, "  evaluations_not_converged: %d\n", result->failed_evaluations);
    if (result->restarted)
        put_number(text, "  ", "restart_moved", result->restart_moved);
    wb_text_append(text, "  # errors are over %s of the measured average\n",
                   result->info.is_follower ? "the largest deflection"
                                            : "F_max, the largest force");
    put_number(text, "  ", "max_force_N", result->max_force);
    put_number(text, "  ", "max_deflection_mm", result->max_deflection / WB_MM);
    put_number(text, "  ", "rms", result->rms);
    put_number(text, "  ", "max_error", result->max_error);
    wb_text_append(text, "  samples: %d\n", result->n_samples);
    if (result->n_samples > 1) {
        put_number(text, "  ", "scatter_rms", result->scatter_rms);
        put_number(text, "  ", "residual_scatter_rms", result->residual_scatter_rms);
    }
    wb_text_append(text, "  virtual_rig: %s\n", result->info.is_virtual ? "true" : "false");
    wb_text_append(text, "  simulation: %s\n", result->info.is_simulation ? "true" : "false");
    wb_text_append(text, "  tool: \"wirebench %s (%s)\"\n", wb_version(), wb_version_revision());
}

static void format(struct wb_text *text, const struct wb_calibrate_result *result,
                   const struct wb_calibrate_settings *settings, const char *const *names,
                   int n_names)
{
    const struct wb_material *const material = &result->material;
    if (result->info.is_virtual)
        wb_text_append(text, "# Calibrated on a virtual rig.\n");
    wb_text_append(text, "wire: ");
    put_quoted(text, result->info.wire);
    wb_text_append(text, "\n");
    put_number(text, "", "outer_diameter_mm", result->info.outer_diameter / WB_MM);
    put_number(text, "", "mass_per_length_kg_m", result->info.mass_per_length);
    put_number(text, "", "youngs_modulus_MPa", material->youngs_modulus / WB_MPA);
    put_number(text, "", "yield_stress_MPa", material->yield_stress / WB_MPA);
    put_number(text, "", "strength_coefficient_MPa", material->strength_coefficient / WB_MPA);
    put_number(text, "", "hardening_exponent", material->hardening_exponent);
    put_number(text, "", "poissons_ratio", material->poissons_ratio);
    if (isfinite(result->deviation[0])) {
        wb_text_append(text, "# standard uncertainties from the scatter between samples\n"
                             "deviations:\n");
        put_number(text, "  ", "youngs_modulus_MPa", result->deviation[0] / WB_MPA);
        put_number(text, "  ", "yield_stress_MPa", result->deviation[1] / WB_MPA);
        wb_text_append(text, "  # K lies within it times and over this factor\n");
        put_number(text, "  ", "strength_coefficient_factor", exp(result->deviation[2]));
        put_number(text, "  ", "hardening_exponent", result->deviation[3]);
    }
    put_calibration(text, result, settings);
    put_datasets(text, names, n_names);
}

enum wb_status wb_properties_write(const char *path, const struct wb_calibrate_result *result,
                                   const struct wb_calibrate_settings *settings,
                                   const char *const *names, int n_names, bool force)
{
    struct wb_text text = {0};
    if (!force && wb_file_exists(path))
        return wb_fail(WB_ERR_EXISTS, "'%s' exists; --force overwrites it", path);
    format(&text, result, settings, names, n_names);
    const enum wb_status status = wb_file_write_text(path, &text);
    wb_text_release(&text);
    return status;
}

static enum wb_status read_deviations(const struct wb_config_node *node, double deviation[4])
{
    const struct wb_config_key keys[] = {
        WB_CONFIG_OPTIONAL_NUMBER("youngs_modulus_MPa", &deviation[0], WB_MPA, 0.0, LARGEST_MPA),
        WB_CONFIG_OPTIONAL_NUMBER("yield_stress_MPa", &deviation[1], WB_MPA, 0.0, LARGEST_MPA),
        WB_CONFIG_OPTIONAL_NUMBER("strength_coefficient_factor", &deviation[2], 1.0, 1.0, 1e300),
        WB_CONFIG_IGNORED("strength_coefficient_MPa"), /* as older files have it */
        WB_CONFIG_OPTIONAL_NUMBER("hardening_exponent", &deviation[3], 1.0, 0.0, 100.0),
    };
    WB_TRY(wb_config_map(node, keys, WB_COUNT(keys)));
    deviation[2] = log(deviation[2]);
    return WB_OK;
}

static enum wb_status read_calibration(const struct wb_config_node *node,
                                       struct wb_properties *properties)
{
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
        WB_CONFIG_IGNORED("simulation"),
        WB_CONFIG_IGNORED("tool"),
        WB_CONFIG_IGNORED("datasets"),
    };
    return wb_config_map(node, keys, WB_COUNT(keys));
}

static enum wb_status read_root(const struct wb_config_node *root, struct wb_properties *properties)
{
    const struct wb_config_node *deviations = NULL, *calibration = NULL;
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
    };
    material->hardening = WB_HARDENING_ISOTROPIC_POWER;
    WB_TRY(wb_config_map(root, keys, WB_COUNT(keys)));
    if (deviations)
        WB_TRY(read_deviations(deviations, properties->deviation));
    if (calibration)
        WB_TRY(read_calibration(calibration, properties));
    return WB_OK;
}

enum wb_status wb_properties_read(const char *path, struct wb_properties *properties)
{
    struct wb_config *config;
    struct wb_properties read = {0};
    for (int k = 0; k < 4; k++)
        read.deviation[k] = (double)NAN;
    read.calibration_length = read.rms = read.largest_curvature = (double)NAN;
    read.scatter_rms = read.residual_scatter_rms = read.stiffness_deviation = (double)NAN;
    WB_TRY(wb_config_read(&config, path, NULL));
    const enum wb_status status = read_root(wb_config_root(config), &read);
    wb_config_destroy(config);
    wb_law_init_ludwik(&read.law, &read.material);
    if (status == WB_OK)
        *properties = read;
    return status;
}
