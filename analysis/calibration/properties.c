#include "analysis/calibration/properties.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include <gsl/gsl_cdf.h>

#include "base/config.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/number.h"
#include "base/text.h"
#include "base/units.h"
#include "base/version.h"
#include "fe/material/law_file.h"

#define WB_LOG_DOMAIN "properties"

/* Limits of the file's numbers, in its units. */
#define LARGEST_MPA 1e7

/* N mm2 in one N m2; N mm in one N m; mJ/m in one J/m. */
#define N_MM2 1e-6
#define N_MM 1e-3
#define MILLI 1e-3

static const struct wb_estimate unknown_estimate = {(double)NAN, (double)NAN, (double)NAN,
                                                    (double)NAN, (double)NAN, (double)NAN};

/* What no source of properties needs to know. */
static void make_unknown(struct wb_properties *properties)
{
    *properties = (struct wb_properties){.n_samples = 0};
    for (int k = 0; k < 4; k++)
        properties->deviation[k] = (double)NAN;
    properties->calibration_length = properties->rms = (double)NAN;
    properties->scatter_rms = properties->residual_scatter_rms = (double)NAN;
    properties->ludwik_misfit = properties->largest_curvature = (double)NAN;
    properties->stiffness_deviation = (double)NAN;
    properties->rigidity = properties->springback = unknown_estimate;
}

/* As the key `method` has them. */
enum {
    METHOD_CYCLE,
    METHOD_PAPER,
    METHOD_THREE_POINT
};
static const char *const methods[] = {"cycle", "paper", "three-point", NULL};

static void set_origin(struct wb_properties *properties, const struct wb_test_info *info,
                       int method)
{
    properties->is_virtual = info->is_virtual;
    properties->is_simulation = info->is_simulation;
    snprintf(properties->method, sizeof properties->method, "%s", methods[method]);
    snprintf(properties->tool, sizeof properties->tool, "wirebench %s (%s)", wb_version(),
             wb_version_revision());
}

void wb_properties_from_result(const struct wb_calibrate_result *result,
                               struct wb_properties *properties)
{
    make_unknown(properties);
    snprintf(properties->wire, sizeof properties->wire, "%s", result->info.wire);
    properties->outer_diameter = result->info.outer_diameter;
    properties->mass_per_length = result->info.mass_per_length;
    properties->material = result->material;
    memcpy(properties->deviation, result->deviation, sizeof properties->deviation);
    properties->calibration_length = result->info.length;
    properties->rms = result->rms;
    properties->scatter_rms = result->n_samples > 1 ? result->scatter_rms : (double)NAN;
    properties->residual_scatter_rms =
        result->n_samples > 1 ? result->residual_scatter_rms : (double)NAN;
    properties->n_samples = result->n_samples;
    set_origin(properties, &result->info, METHOD_PAPER);
    wb_law_init_ludwik(&properties->law, &result->material);
}

void wb_properties_from_wire(const struct wb_wire *wire, struct wb_properties *properties)
{
    make_unknown(properties);
    snprintf(properties->wire, sizeof properties->wire, "%s", wire->name);
    properties->outer_diameter = wire->outer_diameter;
    properties->mass_per_length = wb_wire_mass_per_length(wire);
    properties->material = wire->material;
    properties->law = wire->law;
}

/* Where the data refute the rule, only the range over the candidates is known. */
static struct wb_estimate known(const struct wb_cycle_calibration *calibration,
                                const struct wb_estimate *estimate)
{
    struct wb_estimate known = *estimate;
    known.deviation = (double)NAN;
    if (calibration->has_unloading && !calibration->is_supported)
        known.value = known.low = known.high = (double)NAN;
    return known;
}

/* By a way back, and to the end. */
static bool is_rule_tested(const struct wb_cycle_calibration *calibration)
{
    return calibration->has_unloading && !calibration->is_stopped;
}

static void keep_specimen(const struct wb_cycle_calibration *calibration,
                          const struct wb_cycle_member *member,
                          struct wb_properties_specimen *specimen)
{
    const struct wb_cycle_fit *const fit = &member->answers[calibration->chosen].fit;
    const double length = member->data.info.length;
    const struct wb_cycle_bow bow = wb_cycle_fit_bow(fit, length);
    *specimen = (struct wb_properties_specimen){
        .sample = member->sample,
        .length = length,
        .bow = bow.tip,
        .bow_deviation = bow.deviation,
        .uneven_bow = bow.uneven,
        .level = fit->level,
        .misfit = fit->misfit,
        .ludwik = member->ludwik,
        .ludwik_misfit = member->ludwik_misfit,
    };
}

static double misfit_of_chosen(const struct wb_cycle_calibration *calibration)
{
    for (int i = 0; i < calibration->n_ranked; i++) {
        if (calibration->ranked[i].candidate == calibration->chosen)
            return calibration->ranked[i].misfit;
    }
    return (double)NAN;
}

int wb_properties_units(const struct wb_properties *properties)
{
    return properties->n_series > 1 ? properties->n_series : properties->n_samples;
}

/* How far specimens differ, from the interval of a moment well within the data: EI carries more of
 * the fits' own noise. */
static void find_deviation(struct wb_properties *properties)
{
    const int n = wb_properties_units(properties), at = properties->n_moments / 2;
    if (n < 2 || properties->n_moments < 1)
        return;
    const struct wb_estimate *const moment = &properties->moment[at];
    properties->stiffness_deviation =
        0.5 * log(moment->high / moment->low) * sqrt(n) / gsl_cdf_tdist_Qinv(0.025, n - 1);
}

void wb_properties_from_cycle(const struct wb_cycle_calibration *calibration,
                              struct wb_properties *properties)
{
    const struct wb_test_info *const info = &calibration->members[0].data.info;
    make_unknown(properties);
    snprintf(properties->wire, sizeof properties->wire, "%s", info->wire);
    properties->outer_diameter = info->outer_diameter;
    properties->mass_per_length = info->mass_per_length;
    properties->material = calibration->ludwik;
    properties->calibration_length = wb_cycle_calibrate_length(calibration);
    properties->rms = misfit_of_chosen(calibration);
    properties->n_samples = calibration->n_members;
    set_origin(properties, info, METHOD_CYCLE);
    properties->law = calibration->law;
    properties->ludwik_misfit = calibration->ludwik_misfit;
    properties->largest_curvature = calibration->largest_curvature;
    properties->rigidity = known(calibration, &calibration->rigidity);
    if (calibration->has_unloading)
        properties->springback = known(calibration, &calibration->springback);
    properties->is_rule_tested = is_rule_tested(calibration);
    properties->is_rule_supported = calibration->is_supported;
    properties->n_moments = WB_CYCLE_MOMENTS;
    for (int k = 0; k < WB_CYCLE_MOMENTS; k++) {
        properties->curvature[k] = calibration->curvature[k];
        properties->moment[k] = known(calibration, &calibration->moment[k]);
    }
    find_deviation(properties);
    const int n = calibration->n_members;
    properties->n_specimens = n < WB_PROPERTIES_MOST_SPECIMENS ? n : WB_PROPERTIES_MOST_SPECIMENS;
    for (int i = 0; i < properties->n_specimens; i++)
        keep_specimen(calibration, &calibration->members[i], &properties->specimens[i]);
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

/* Of datasets that are in no folder of their own. */
static void put_known_datasets(struct wb_text *text, const struct wb_properties_dataset *datasets,
                               int n)
{
    wb_text_append(text, n > 0 ? "  datasets:\n" : "  datasets: []\n");
    for (int i = 0; i < n; i++) {
        const struct wb_properties_dataset *const d = &datasets[i];
        wb_text_append(text, d->is_recording ? "    - recording: " : "    - folder: ");
        put_quoted(text, d->name);
        wb_text_append(text, "\n");
        if (d->sha256[0])
            wb_text_append(text, "      %s: %s\n",
                           d->is_recording ? "recording_sha256" : "force_deflection_sha256",
                           d->sha256);
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

static void put_material(struct wb_text *text, const char *indent,
                         const struct wb_material *material)
{
    put_number(text, indent, "youngs_modulus_MPa", material->youngs_modulus / WB_MPA);
    put_number(text, indent, "yield_stress_MPa", material->yield_stress / WB_MPA);
    put_number(text, indent, "strength_coefficient_MPa", material->strength_coefficient / WB_MPA);
    put_number(text, indent, "hardening_exponent", material->hardening_exponent);
}

static void put_wire(struct wb_text *text, const struct wb_test_info *info)
{
    wb_text_append(text, "schema: %d\nwire: ", WB_CONFIG_SCHEMA);
    put_quoted(text, info->wire);
    wb_text_append(text, "\n");
    put_number(text, "", "outer_diameter_mm", info->outer_diameter / WB_MM);
    put_number(text, "", "mass_per_length_kg_m", info->mass_per_length);
}

static void format(struct wb_text *text, const struct wb_calibrate_result *result,
                   const struct wb_calibrate_settings *settings)
{
    const struct wb_material *const material = &result->material;
    if (result->info.is_virtual)
        wb_text_append(text, "# Calibrated on a virtual rig.\n");
    put_wire(text, &result->info);
    put_material(text, "", material);
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
}

void wb_properties_format(struct wb_text *text, const struct wb_calibrate_result *result,
                          const struct wb_calibrate_settings *settings,
                          const struct wb_properties_dataset *datasets, int n_datasets)
{
    format(text, result, settings);
    put_known_datasets(text, datasets, n_datasets);
}

/* --- calibrations on whole cycles --- */

/* "  key: {value: 1, low: 0.9, ...}" with what is known; nothing where nothing is. */
static void put_estimate(struct wb_text *text, const char *key, const struct wb_estimate *estimate,
                         double unit)
{
    const struct {
        const char *name;
        double value;
    } parts[] = {
        {"value", estimate->value},
        {"low", estimate->low},
        {"high", estimate->high},
        {"candidates_low", estimate->candidates_low},
        {"candidates_high", estimate->candidates_high},
    };
    char number[WB_NUMBER_TEXT];
    int n = 0;
    for (size_t i = 0; i < WB_COUNT(parts); i++) {
        if (!isfinite(parts[i].value))
            continue;
        wb_text_append(text, n++ == 0 ? "%s: {" : ", ", key);
        wb_text_append(text, "%s: %s", parts[i].name,
                       wb_number_format(parts[i].value / unit, number));
    }
    if (n > 0)
        wb_text_append(text, "}\n");
}

static void put_moments(struct wb_text *text, const struct wb_properties *p)
{
    wb_text_append(text, "moment_curvature:\n");
    for (int k = 0; k < p->n_moments; k++) {
        const struct wb_estimate *const e = &p->moment[k];
        wb_text_append(text, "  -\n");
        put_number(text, "    ", "curvature_1_m", p->curvature[k]);
        put_number(text, "    ", "moment_N_mm", e->value / N_MM);
        put_number(text, "    ", "low", e->low / N_MM);
        put_number(text, "    ", "high", e->high / N_MM);
        put_number(text, "    ", "candidates_low", e->candidates_low / N_MM);
        put_number(text, "    ", "candidates_high", e->candidates_high / N_MM);
    }
}

static void put_rule(struct wb_text *text, const struct wb_cycle_calibration *calibration)
{
    wb_text_append(text, "# the rule is supported where a candidate follows loading and unloading "
                         "within 0.5 %% of F_max\n"
                         "hardening_rule:\n");
    wb_text_append(text, "  chosen: \"%s\"\n", wb_candidate_name(calibration->chosen));
    wb_text_append(text, "  tested: %s\n", is_rule_tested(calibration) ? "true" : "false");
    wb_text_append(text, "  supported: %s\n", calibration->is_supported ? "true" : "false");
    wb_text_append(text, "  # misfits of the candidates, over F_max\n"
                         "  ranked:\n");
    for (int i = 0; i < calibration->n_ranked; i++) {
        wb_text_append(text, "    - law: \"%s\"\n",
                       wb_candidate_name(calibration->ranked[i].candidate));
        put_number(text, "      ", "misfit", calibration->ranked[i].misfit);
    }
}

static void put_specimens(struct wb_text *text, const struct wb_properties *p)
{
    wb_text_append(text, "# Each specimen by itself; the four numbers are its Ludwik equivalent.\n"
                         "specimens:\n");
    for (int i = 0; i < p->n_specimens; i++) {
        const struct wb_properties_specimen *const specimen = &p->specimens[i];
        wb_text_append(text, "  - sample: %d\n", specimen->sample);
        put_number(text, "    ", "length_mm", specimen->length / WB_MM);
        put_number(text, "    ", "bow_mm", specimen->bow / WB_MM);
        put_number(text, "    ", "bow_deviation_mm", specimen->bow_deviation / WB_MM);
        put_number(text, "    ", "uneven_bow_mm", specimen->uneven_bow / WB_MM);
        put_number(text, "    ", "level_mm", specimen->level / WB_MM);
        put_number(text, "    ", "misfit", specimen->misfit);
        put_material(text, "    ", &specimen->ludwik);
        put_number(text, "    ", "ludwik_misfit", specimen->ludwik_misfit);
    }
}

static void put_settings(struct wb_text *text, const struct wb_cycle_calibrate_settings *settings)
{
    wb_text_append(text, "  settings:\n");
    for (int t = 0; t < WB_CYCLE_CALIBRATE_TABLES; t++) {
        const struct wb_setting_table *const table = &wb_cycle_calibrate_tables[t];
        for (size_t i = 0; i < table->n; i++) {
            const char *const at = (const char *)settings + table->offset;
            char value[WB_SETTING_VALUE];
            wb_setting_format(&table->rows[i], at, value);
            if (wb_setting_is_given(&table->rows[i], at))
                wb_text_append(text, "    %s: %s\n", table->rows[i].name, value);
        }
    }
}

static void put_law(struct wb_text *text, const struct wb_cycle_calibration *calibration,
                    const struct wb_properties *p)
{
    if (wb_law_is_plain(&p->law)) {
        put_material(text, "", &p->material);
        put_number(text, "", "poissons_ratio", p->law.material.poissons_ratio);
        return;
    }
    if (p->law.form == WB_LAW_LUDWIK)
        wb_text_append(text, "# The law is Ludwik's of these four numbers with the hardening rule "
                             "below; models that know\n"
                             "# isotropic hardening alone bend alike on a first loading and not on "
                             "the way back.\n");
    else
        wb_text_append(text, "# These four numbers are derived from the law below: Ludwik's, "
                             "isotropic, that bends alike on a\n"
                             "# first loading; EI and the way back are the law's, not theirs.\n");
    put_material(text, "", &p->material);
    put_number(text, "", "poissons_ratio", p->law.material.poissons_ratio);
    put_number(text, "", "ludwik_misfit", p->ludwik_misfit);
    wb_text_append(text, "# %s over the specimens\n",
                   calibration->n_members > 1 ? "means of the logarithms"
                                              : "one specimen; no mean");
    wb_law_file_append(text, &p->law);
}

static void format_cycle(struct wb_text *text, const struct wb_cycle_calibration *calibration,
                         const struct wb_properties *p,
                         const struct wb_cycle_calibrate_settings *settings)
{
    const struct wb_test_info *const info = &calibration->members[0].data.info;
    if (info->is_virtual)
        wb_text_append(text, "# Calibrated on a virtual rig.\n");
    put_wire(text, info);
    put_law(text, calibration, p);
    wb_text_append(text, "method: cycle\n"
                         "# Means over the specimens with an interval of 95 %%, and their range "
                         "over the laws that the data\n"
                         "# do not exclude. Gain of the cell, length, counterweight and diameter "
                         "are in neither.\n");
    put_estimate(text, "flexural_rigidity_N_mm2", &p->rigidity, N_MM2);
    put_estimate(text, "springback_ratio", &p->springback, 1.0);
    if (isfinite(p->springback.candidates_low)) {
        const struct wb_estimate energy = known(calibration, &calibration->loop_energy);
        put_estimate(text, "loop_energy_mJ_per_m", &energy, MILLI);
    }
    wb_text_append(text, "# beyond it the law is not measured\n");
    put_number(text, "", "largest_curvature_1_m", p->largest_curvature);
    put_moments(text, p);
    put_rule(text, calibration);
    put_specimens(text, p);
    wb_text_append(text, "calibration:\n");
    put_number(text, "  ", "length_mm", p->calibration_length / WB_MM);
    if (calibration->is_stopped)
        wb_text_append(text,
                       "  stopped: interrupted before all laws were fitted to all specimens\n");
    wb_text_append(text, "  # over F_max of each specimen, both ways\n");
    put_number(text, "  ", "rms", p->rms);
    wb_text_append(text, "  samples: %d\n", p->n_samples);
    wb_text_append(text, "  virtual_rig: %s\n", info->is_virtual ? "true" : "false");
    wb_text_append(text, "  simulation: %s\n", info->is_simulation ? "true" : "false");
    wb_text_append(text, "  tool: \"wirebench %s (%s)\"\n", wb_version(), wb_version_revision());
    put_settings(text, settings);
}

void wb_properties_format_cycle(struct wb_text *text,
                                const struct wb_cycle_calibration *calibration,
                                const struct wb_cycle_calibrate_settings *settings,
                                const struct wb_properties_dataset *datasets, int n_datasets)
{
    struct wb_properties properties;
    wb_properties_from_cycle(calibration, &properties);
    format_cycle(text, calibration, &properties, settings);
    put_known_datasets(text, datasets, n_datasets);
}

enum wb_status wb_properties_write_cycle(const char *path,
                                         const struct wb_cycle_calibration *calibration,
                                         const struct wb_cycle_calibrate_settings *settings,
                                         const char *const *names, int n_names, bool force)
{
    struct wb_properties properties;
    struct wb_text text = {0};
    if (!force && wb_file_exists(path))
        return wb_fail(WB_ERR_EXISTS, "'%s' exists; --force overwrites it", path);
    wb_properties_from_cycle(calibration, &properties);
    if (properties.n_specimens < calibration->n_members)
        wb_warn("'%s' keeps the first %d specimens of %d", path, properties.n_specimens,
                calibration->n_members);
    format_cycle(&text, calibration, &properties, settings);
    put_datasets(&text, names, n_names);
    const enum wb_status status = wb_file_write_text(path, &text);
    wb_text_release(&text);
    return status;
}

enum wb_status wb_properties_write(const char *path, const struct wb_calibrate_result *result,
                                   const struct wb_calibrate_settings *settings,
                                   const char *const *names, int n_names, bool force)
{
    struct wb_text text = {0};
    if (!force && wb_file_exists(path))
        return wb_fail(WB_ERR_EXISTS, "'%s' exists; --force overwrites it", path);
    format(&text, result, settings);
    put_datasets(&text, names, n_names);
    const enum wb_status status = wb_file_write_text(path, &text);
    wb_text_release(&text);
    return status;
}

/* --- calibrations on three-point bending --- */

/* All tests have a way back, and the law follows both ways. */
static bool has_tested_rule(const struct wb_three_point_calibration *c)
{
    return c->is_rigidity_identifiable;
}

static void from_three_point(const struct wb_three_point_calibration *c,
                             struct wb_properties *properties)
{
    const struct wb_test_info *const info = &c->members[0].data.info;
    make_unknown(properties);
    snprintf(properties->wire, sizeof properties->wire, "%s", info->wire);
    properties->outer_diameter = info->outer_diameter;
    properties->mass_per_length = info->mass_per_length;
    properties->material = c->ludwik;
    properties->rms = c->misfit;
    properties->n_samples = c->n_fitted;
    properties->n_series = c->n_series;
    set_origin(properties, info, METHOD_THREE_POINT);
    properties->law = c->law;
    properties->ludwik_misfit = c->ludwik_misfit;
    properties->largest_curvature = c->largest_curvature;
    if (c->is_rigidity_identifiable)
        properties->rigidity = c->rigidity;
    properties->is_rule_tested = has_tested_rule(c);
    properties->is_rule_supported = has_tested_rule(c) && c->misfit <= WB_CYCLE_LARGEST_SUPPORTED;
    properties->n_moments = WB_THREE_POINT_MOMENTS;
    for (int k = 0; k < WB_THREE_POINT_MOMENTS; k++) {
        properties->curvature[k] = c->curvature[k];
        properties->moment[k] = c->moment[k];
    }
}

static void put_bench(struct wb_text *text, const struct wb_three_point_calibration *c)
{
    wb_text_append(text, "three_point:\n");
    put_number(text, "  ", "span_mm", c->members[0].data.info.length / WB_MM);
    put_number(text, "  ", "roller_radius_mm",
               c->members[0].data.info.machine.roller_radius / WB_MM);
    put_number(text, "  ", "nose_radius_mm", c->bench.nose_radius / WB_MM);
    put_number(text, "  ", "friction", c->bench.friction);
    put_number(text, "  ", "compliance_mm_N", c->bench.compliance / WB_MM);
    wb_text_append(text, "  compliance_known: %s\n", c->is_compliance_known ? "true" : "false");
    wb_text_append(text, "  series: %d\n", c->n_series);
    put_number(text, "  ", "series_deviation", c->series_deviation);
    wb_text_append(text, "  # the fits again with what the curves do not tell; EI over that above\n"
                         "  bands:\n");
    for (int i = 0; i < WB_THREE_POINT_VARIANTS; i++) {
        const struct wb_three_point_variant *const v = &c->variants[i];
        wb_text_append(text, "    - of: \"%s\"\n", v->name);
        put_number(text, "      ", i < 2 ? "value" : "value_mm",
                   i < 2 ? v->value : v->value / WB_MM);
        wb_text_append(text, "      possible: %s\n", v->is_possible ? "true" : "false");
        if (!v->is_possible)
            continue;
        put_number(text, "      ", "misfit", v->misfit);
        put_number(text, "      ", "rigidity_ratio", v->rigidity);
    }
    wb_text_append(text, "  tests:\n");
    for (int i = 0; i < c->n_members; i++) {
        const struct wb_three_point_member *const m = &c->members[i];
        wb_text_append(text, "    - sample: %d\n      series: ", m->data.info.sample);
        put_quoted(text, m->data.info.piece.series);
        wb_text_append(text, "\n      fitted: %s\n", m->is_fitted ? "true" : "false");
        if (!m->is_fitted)
            continue;
        put_number(text, "      ", "flexural_rigidity_N_mm2", m->rigidity / N_MM2);
        put_number(text, "      ", "rigidity_error", m->rigidity_error);
        put_number(text, "      ", "first_contact_mm", m->fit.first_contact / WB_MM);
        put_number(text, "      ", "first_contact_error_mm", m->fit.first_contact_error / WB_MM);
        put_number(text, "      ", "natural_bow_mm", m->fit.bow / WB_MM);
        put_number(text, "      ", "natural_bow_error_mm", m->fit.bow_error / WB_MM);
        wb_text_append(text, "      natural_bow_told: %s\n", m->fit.is_bow_told ? "true" : "false");
        put_number(text, "      ", "usable_mm", m->data.usable / WB_MM);
        wb_text_append(text, "      usable_by: \"%s\"\n", wb_three_point_limit_name(m->data.limit));
        put_number(text, "      ", "misfit", m->fit.misfit);
        put_number(text, "      ", "largest_curvature_1_m", m->fit.largest_curvature);
        put_number(text, "      ", "wrapped_rad", m->fit.wrapped);
    }
}

static void format_three_point(struct wb_text *text, const struct wb_three_point_calibration *c)
{
    const struct wb_test_info *const info = &c->members[0].data.info;
    struct wb_properties p;
    from_three_point(c, &p);
    put_wire(text, info);
    wb_text_append(text,
                   "# These four numbers are derived from the law below: Ludwik's, isotropic, "
                   "that bends alike on a\n"
                   "# first loading.\n");
    put_material(text, "", &c->ludwik);
    put_number(text, "", "poissons_ratio", c->law.material.poissons_ratio);
    put_number(text, "", "ludwik_misfit", c->ludwik_misfit);
    wb_law_file_append(text, &c->law);
    wb_text_append(text, "method: three-point\n"
                         "# Means with an interval of 95 %%; candidates: over friction and nose "
                         "radius, which the curves do\n"
                         "# not tell.\n");
    if (c->is_rigidity_identifiable)
        put_estimate(text, "flexural_rigidity_N_mm2", &c->rigidity, N_MM2);
    else
        wb_text_append(text, "# flexural_rigidity_N_mm2: not identifiable from loading alone\n");
    put_number(text, "", "largest_curvature_1_m", c->largest_curvature);
    put_moments(text, &p);
    wb_text_append(text,
                   "# tested where all tests have a way back, supported where the law then follows "
                   "within 0.5 %% of F_max\n"
                   "hardening_rule:\n  chosen: \"%s\"\n  tested: %s\n  supported: %s\n",
                   wb_candidate_name(WB_CANDIDATE_PARALLEL_MIXED),
                   p.is_rule_tested ? "true" : "false", p.is_rule_supported ? "true" : "false");
    put_bench(text, c);
    wb_text_append(text, "calibration:\n");
    put_number(text, "  ", "rms", c->misfit);
    wb_text_append(text, "  samples: %d\n", c->n_fitted);
    wb_text_append(text, "  virtual_rig: %s\n", info->is_virtual ? "true" : "false");
    wb_text_append(text, "  simulation: %s\n", info->is_simulation ? "true" : "false");
    wb_text_append(text, "  tool: \"wirebench %s (%s)\"\n", wb_version(), wb_version_revision());
}

void wb_properties_format_three_point(struct wb_text *text,
                                      const struct wb_three_point_calibration *calibration,
                                      const struct wb_properties_dataset *datasets, int n_datasets)
{
    format_three_point(text, calibration);
    put_known_datasets(text, datasets, n_datasets);
}

enum wb_status wb_properties_write_three_point(const char *path,
                                               const struct wb_three_point_calibration *calibration,
                                               const char *const *names, int n_names, bool force)
{
    struct wb_text text = {0};
    if (!force && wb_file_exists(path))
        return wb_fail(WB_ERR_EXISTS, "'%s' exists; --force overwrites it", path);
    format_three_point(&text, calibration);
    put_datasets(&text, names, n_names);
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

/* A scalar of a map as text; "" where there is none. What is too long is cut. */
static void keep_scalar(const struct wb_config_node *map, const char *key, char *text, size_t size)
{
    const struct wb_config_node *const node = wb_config_find(map, key);
    const char *const scalar = node ? wb_config_scalar(node) : NULL;
    snprintf(text, size, "%s", scalar ? scalar : "");
}

/* Names and checksums, for those who cite them; a file by hand may have them in any shape. */
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

static enum wb_status read_estimate(const struct wb_config_node *node, double unit, double largest,
                                    struct wb_estimate *e)
{
    const struct wb_config_key keys[] = {
        WB_CONFIG_OPTIONAL_NUMBER("value", &e->value, unit, 0.0, largest),
        WB_CONFIG_OPTIONAL_NUMBER("low", &e->low, unit, 0.0, largest),
        WB_CONFIG_OPTIONAL_NUMBER("high", &e->high, unit, 0.0, largest),
        WB_CONFIG_OPTIONAL_NUMBER("candidates_low", &e->candidates_low, unit, 0.0, largest),
        WB_CONFIG_OPTIONAL_NUMBER("candidates_high", &e->candidates_high, unit, 0.0, largest),
    };
    return node ? wb_config_map(node, keys, WB_COUNT(keys)) : WB_OK;
}

static enum wb_status read_moments(const struct wb_config_node *node,
                                   struct wb_properties *properties)
{
    const int n = wb_config_length(node);
    if (n < 1 || n > WB_PROPERTIES_MOST_MOMENTS)
        return wb_config_refuse(node, "moment_curvature", "expected a list of 1 to %d moments",
                                WB_PROPERTIES_MOST_MOMENTS);
    for (int k = 0; k < n; k++) {
        struct wb_estimate *const e = &properties->moment[k];
        double *const curvature = &properties->curvature[k];
        const struct wb_config_node *const item = wb_config_item(node, k);
        const struct wb_config_key keys[] = {
            WB_CONFIG_NUMBER("curvature_1_m", curvature, 1.0, 0.0, 1e6),
            WB_CONFIG_OPTIONAL_NUMBER("moment_N_mm", &e->value, N_MM, 0.0, 1e9),
            WB_CONFIG_OPTIONAL_NUMBER("low", &e->low, N_MM, 0.0, 1e9),
            WB_CONFIG_OPTIONAL_NUMBER("high", &e->high, N_MM, 0.0, 1e9),
            WB_CONFIG_OPTIONAL_NUMBER("candidates_low", &e->candidates_low, N_MM, 0.0, 1e9),
            WB_CONFIG_OPTIONAL_NUMBER("candidates_high", &e->candidates_high, N_MM, 0.0, 1e9),
        };
        *e = unknown_estimate;
        WB_TRY(wb_config_map(item, keys, WB_COUNT(keys)));
        if (k > 0 && !(*curvature > properties->curvature[k - 1]))
            return wb_config_refuse(item, "curvature_1_m", "%g: expected more than the one before",
                                    *curvature);
    }
    properties->n_moments = n;
    return WB_OK;
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
    const struct wb_config_node *rigidity = NULL, *springback = NULL, *moments = NULL;
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
        WB_CONFIG_OPTIONAL_CHOICE("method", &method, methods),
        WB_CONFIG_OPTIONAL_NODE("law", &law),
        WB_CONFIG_OPTIONAL_NUMBER("ludwik_misfit", &properties->ludwik_misfit, 1.0, 0.0, 1e6),
        WB_CONFIG_OPTIONAL_NODE("flexural_rigidity_N_mm2", &rigidity),
        WB_CONFIG_OPTIONAL_NODE("springback_ratio", &springback),
        WB_CONFIG_IGNORED("loop_energy_mJ_per_m"),
        WB_CONFIG_OPTIONAL_NUMBER("largest_curvature_1_m", &properties->largest_curvature, 1.0,
                                  1e-6, 1e6),
        WB_CONFIG_OPTIONAL_NODE("moment_curvature", &moments),
        WB_CONFIG_OPTIONAL_NODE("hardening_rule", &rule),
        WB_CONFIG_OPTIONAL_NODE("specimens", &specimens),
        WB_CONFIG_OPTIONAL_NODE("three_point", &three_point),
    };
    material->hardening = WB_HARDENING_ISOTROPIC_POWER;
    WB_TRY(wb_config_map(root, keys, WB_COUNT(keys)));
    if (method < 0 && calibration)
        method = METHOD_PAPER; /* which does not write the key */
    if (method >= 0)
        snprintf(properties->method, sizeof properties->method, "%s", methods[method]);
    if (deviations)
        WB_TRY(read_deviations(deviations, properties->deviation));
    if (calibration)
        WB_TRY(read_calibration(calibration, properties));
    WB_TRY(wb_law_file_read(law, material, &properties->law));
    WB_TRY(read_estimate(rigidity, N_MM2, 1e15, &properties->rigidity));
    WB_TRY(read_estimate(springback, 1.0, 1.0, &properties->springback));
    if (moments)
        WB_TRY(read_moments(moments, properties));
    if (rule)
        WB_TRY(read_rule(rule, properties));
    if (three_point)
        WB_TRY(read_three_point(three_point, properties));
    return specimens ? read_specimens(specimens, properties) : WB_OK;
}

static enum wb_status take(struct wb_config *config, struct wb_properties *properties)
{
    struct wb_properties read;
    make_unknown(&read);
    const enum wb_status status = read_root(wb_config_root(config), &read);
    wb_config_destroy(config);
    find_deviation(&read);
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
