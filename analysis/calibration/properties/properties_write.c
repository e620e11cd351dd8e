/* Properties as the text of a file. */
#include <math.h>

#include "analysis/calibration/cycle/cycle_budget.h"
#include "analysis/calibration/properties/properties.h"
#include "analysis/calibration/properties/quantity.h"
#include "base/config.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/number.h"
#include "base/text.h"
#include "base/units.h"
#include "base/version.h"
#include "fe/material/law_file.h"

#define WB_LOG_DOMAIN "properties"

/* Appends "  key: value" with a number that is read back unchanged; nothing if it is unknown. */
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

/* Datasets that have no folder. */
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

/* Whether the tests were real, and the tool that calibrated them. */
static void put_origin(struct wb_text *text, const struct wb_test_info *info)
{
    wb_text_append(text, "  virtual_rig: %s\n", info->is_virtual ? "true" : "false");
    wb_text_append(text, "  simulation: %s\n", info->is_simulation ? "true" : "false");
    wb_text_append(text, "  tool: \"wirebench %s (%s)\"\n", wb_version(), wb_version_revision());
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
    put_origin(text, &result->info);
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
        wb_text_append(text, "# standard uncertainties from the scatter between specimens\n"
                             "deviations:\n");
        put_number(text, "  ", "youngs_modulus_MPa", result->deviation[0] / WB_MPA);
        put_number(text, "  ", "yield_stress_MPa", result->deviation[1] / WB_MPA);
        wb_text_append(text, "  # standard uncertainty of K, as a factor\n");
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

/* Appends "{curvature_1_m: 1, value: 2, ...}" with the known values. */
static void append_estimate(struct wb_text *text, const struct wb_quantity *row,
                            const double *curvature, const struct wb_estimate *estimate)
{
    const struct {
        const char *name;
        double value;
    } parts[] = {
        {"curvature_1_m", curvature ? *curvature : (double)NAN},
        {row->value_key, estimate->value / row->scale},
        {"low", estimate->low / row->scale},
        {"high", estimate->high / row->scale},
        {"candidates_low", estimate->candidates_low / row->scale},
        {"candidates_high", estimate->candidates_high / row->scale},
        {"scatter", estimate->deviation},
    };
    char number[WB_NUMBER_TEXT];
    int n = 0;
    for (size_t i = 0; i < WB_COUNT(parts); i++) {
        if (!isfinite(parts[i].value))
            continue;
        wb_text_append(text, "%s%s: %s", n++ > 0 ? ", " : "{", parts[i].name,
                       wb_number_format(parts[i].value, number));
    }
    wb_text_append(text, n > 0 ? "}\n" : "{}\n");
}

/* Appends the known quantities. */
static void put_quantities(struct wb_text *text, const struct wb_properties *p)
{
    for (enum wb_quantity_id id = 0; id < WB_QUANTITIES; id++) {
        const struct wb_quantity *const row = &wb_quantity_rows[id];
        const struct wb_quantity_values values = wb_quantity_values(p, id);
        if (values.n == 0 || !wb_quantity_is_known(&values.estimate[0]))
            continue;
        wb_text_append(text, "%s:%s", row->key, row->most > 0 ? "\n" : " ");
        if (row->resolved > 0) {
            put_number(text, "  ", "resolved_from_1_m", values.resolved);
            wb_text_append(text, "  at:\n");
        }
        for (int k = 0; k < values.n; k++) {
            if (row->most > 0)
                wb_text_append(text, "%s- ", row->resolved > 0 ? "    " : "  ");
            append_estimate(text, row, values.curvature ? &values.curvature[k] : NULL,
                            &values.estimate[k]);
        }
    }
}

static void put_rule(struct wb_text *text, const struct wb_cycle_calibration *calibration,
                     const struct wb_properties *p)
{
    wb_text_append(text,
                   "# supported: the law fits loading and unloading within %g %% of F_max\n"
                   "hardening_rule:\n",
                   100.0 * WB_CYCLE_LARGEST_FOLLOWED);
    wb_text_append(text, "  chosen: \"%s\"\n", wb_candidate_name(calibration->chosen));
    wb_text_append(text, "  tested: %s\n", p->is_rule_tested ? "true" : "false");
    wb_text_append(text, "  supported: %s\n", calibration->is_followed ? "true" : "false");
    wb_text_append(text, "  # misfits of the candidates, over F_max, and their weights\n"
                         "  ranked:\n");
    for (int i = 0; i < calibration->n_ranked; i++) {
        wb_text_append(text, "    - law: \"%s\"\n",
                       wb_candidate_name(calibration->ranked[i].candidate));
        put_number(text, "      ", "misfit", calibration->ranked[i].misfit);
        put_number(text, "      ", "weight", calibration->ranked[i].weight);
    }
}

static void put_specimens(struct wb_text *text, const struct wb_properties *p)
{
    wb_text_append(text, "# Each specimen separately; the four numbers are its Ludwik equivalent.\n"
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
        wb_law_file_append(text, &p->law);
        return;
    }
    if (p->law.form == WB_LAW_LUDWIK)
        wb_text_append(text,
                       "# The law is Ludwik's with these four numbers and the hardening rule "
                       "below; with isotropic\n"
                       "# hardening they give the same first loading, but another unloading.\n");
    else
        wb_text_append(text, "# These four numbers are derived from the law below: Ludwik's law "
                             "with isotropic hardening and the\n"
                             "# same first loading; EI and the unloading are those of the law.\n");
    put_material(text, "", &p->material);
    put_number(text, "", "poissons_ratio", p->law.material.poissons_ratio);
    put_number(text, "", "ludwik_misfit", p->ludwik_misfit);
    wb_text_append(text, "# %s over the specimens\n",
                   calibration->n_members < 2       ? "one specimen; no mean"
                   : p->law.form == WB_LAW_PARALLEL ? "means of the moduli"
                   : p->law.form == WB_LAW_CHABOCHE ? "means of the stresses"
                                                    : "means of the logarithms");
    wb_law_file_append(text, &p->law);
}

/* States which errors common to all specimens the intervals include. */
static void put_common_errors(struct wb_text *text, const struct wb_cycle_calibration *calibration)
{
    const double *const u = calibration->budget[WB_CYCLE_FIRST_MOMENT].uncertainty;
    for (int known = 0; known < 2; known++) {
        const char *between = known ? "# The intervals include the stated uncertainty of "
                                    : "# Not stated, and not included in the intervals: ";
        for (int i = 0; i < WB_SHARED; i++) {
            if (isfinite(u[WB_FROM_SHARED + i]) != known ||
                !wb_cycle_budget_has(calibration, WB_FROM_SHARED + i))
                continue;
            wb_text_append(text, "%s%s", between, wb_cycle_shared_name((enum wb_cycle_shared)i));
            between = ", ";
        }
        if (between[0] == ',')
            wb_text_append(text, "\n");
    }
    if (!isfinite(calibration->rigidity.deviation))
        wb_text_append(
            text, "# One specimen: the scatter between specimens is unknown and not included.\n");
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
                         "# do not exclude.\n");
    put_common_errors(text, calibration);
    wb_text_append(text,
                   "# moment_curvature: first loading. Stiffness: change of the moment over the "
                   "change of the curvature, unloading "
                   "from the largest\n"
                   "# curvature and loading from zero; below resolved_from_1_m only the law "
                   "supports it. Flexural\n"
                   "# rigidity: at zero curvature%s.\n",
                   calibration->is_rigidity_resolved
                       ? ""
                       : ", which the data do not resolve: use a stiffness instead");
    put_quantities(text, p);
    wb_text_append(text, "# largest measured curvature of the law\n");
    put_number(text, "", "largest_curvature_1_m", p->largest_curvature);
    put_rule(text, calibration, p);
    put_specimens(text, p);
    wb_text_append(text, "calibration:\n");
    put_number(text, "  ", "length_mm", p->calibration_length / WB_MM);
    if (calibration->is_stopped)
        wb_text_append(text,
                       "  stopped: interrupted before all laws were fitted to all specimens\n");
    wb_text_append(text, "  # over F_max of each specimen, loading and unloading\n");
    put_number(text, "  ", "rms", p->rms);
    wb_text_append(text, "  samples: %d\n", p->n_samples);
    put_origin(text, info);
    put_settings(text, settings);
}

/* Writes the file only if it can be read again. */
static enum wb_status write_readable(const char *path, struct wb_text *text)
{
    struct wb_properties read;
    struct wb_reason why = {.text = ""};
    enum wb_status status = wb_properties_parse(wb_text_string(text), path, &read, &why);
    if (status == WB_OK)
        status = wb_file_write_text(path, text);
    else
        status = wb_fail(status, "'%s' not written, because it could not be read again: %s", path,
                         why.text);
    wb_text_release(text);
    return status;
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
    return write_readable(path, &text);
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
    return write_readable(path, &text);
}

/* --- calibrations on three-point bending --- */

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
    wb_text_append(text, "  # fits repeated with parameters that the curves do not determine; EI "
                         "over that above\n  bands:\n");
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
        put_number(text, "      ", "flexural_rigidity_N_mm2", m->rigidity / WB_NMM2);
        put_number(text, "      ", "rigidity_error", m->rigidity_error);
        put_number(text, "      ", "first_contact_mm", m->fit.first_contact / WB_MM);
        put_number(text, "      ", "first_contact_error_mm", m->fit.first_contact_error / WB_MM);
        put_number(text, "      ", "natural_bow_mm", m->fit.bow / WB_MM);
        put_number(text, "      ", "natural_bow_error_mm", m->fit.bow_error / WB_MM);
        wb_text_append(text, "      natural_bow_determined: %s\n",
                       m->fit.is_bow_identifiable ? "true" : "false");
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
    wb_properties_from_three_point(c, &p);
    put_wire(text, info);
    wb_text_append(
        text, "# These four numbers are derived from the law below: Ludwik's law with isotropic "
              "hardening and the\n"
              "# same first loading.\n");
    put_material(text, "", &c->ludwik);
    put_number(text, "", "poissons_ratio", c->law.material.poissons_ratio);
    put_number(text, "", "ludwik_misfit", c->ludwik_misfit);
    wb_law_file_append(text, &c->law);
    wb_text_append(text, "method: three-point\n"
                         "# Means with an interval of 95 %%; candidates: over friction and nose "
                         "radius, which the curves do\n"
                         "# not determine.\n");
    put_quantities(text, &p);
    if (!c->is_rigidity_identifiable)
        wb_text_append(text, "# flexural_rigidity_N_mm2: not identifiable from loading alone\n");
    put_number(text, "", "largest_curvature_1_m", c->largest_curvature);
    wb_text_append(
        text,
        "# tested: all tests have an unloading; supported: the law fits it within 0.5 %% of "
        "F_max\n"
        "hardening_rule:\n  chosen: \"%s\"\n  tested: %s\n  supported: %s\n",
        wb_candidate_name(WB_CANDIDATE_PARALLEL_MIXED), p.is_rule_tested ? "true" : "false",
        p.is_rule_supported ? "true" : "false");
    put_bench(text, c);
    wb_text_append(text, "calibration:\n");
    put_number(text, "  ", "rms", c->misfit);
    wb_text_append(text, "  samples: %d\n", c->n_fitted);
    put_origin(text, info);
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
    return write_readable(path, &text);
}
