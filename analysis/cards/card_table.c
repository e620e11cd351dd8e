#include "analysis/cards/card_table.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/calibration/law/bending.h"
#include "analysis/cards/card_curve.h"
#include "analysis/keys/common.h"
#include "base/json.h"
#include "base/number.h"
#include "fe/material/law_json.h"

#define WB_LOG_DOMAIN "card"

/* The calibrated residual curvature ratio; if that is unknown, the law's, without an interval. */
static enum wb_status find_residual_curvature_ratio(const struct wb_card_source *source,
                                                    struct wb_estimate *residual_curvature_ratio)
{
    const struct wb_properties *const p = &source->properties;
    struct wb_bending bending;
    *residual_curvature_ratio = p->residual_curvature_ratio;
    if (isfinite(residual_curvature_ratio->value) ||
        isfinite(residual_curvature_ratio->candidates_low))
        return WB_OK;
    WB_TRY(wb_bending_describe(&p->law, p->outer_diameter, wb_card_source_curvature(source),
                               &bending));
    residual_curvature_ratio->value = bending.residual_curvature_ratio;
    return WB_OK;
}

/* --- the curve --- */

static const struct {
    const char *key;
    size_t offset; /* of the values in struct wb_card_curve */
} columns[] = {
    {"curvature_1_m", offsetof(struct wb_card_curve, curvature)},
    {"moment_N_m", offsetof(struct wb_card_curve, moment)},
    {"low_N_m", offsetof(struct wb_card_curve, low)},
    {"high_N_m", offsetof(struct wb_card_curve, high)},
    {"candidates_low_N_m", offsetof(struct wb_card_curve, candidates_low)},
    {"candidates_high_N_m", offsetof(struct wb_card_curve, candidates_high)},
    {"secant_flexural_rigidity_N_m2", offsetof(struct wb_card_curve, secant)},
};

static double cell(const struct wb_card_curve *curve, size_t column, int k)
{
    return ((const double *)((const char *)curve + columns[column].offset))[k];
}

/* --- JSON --- */

static void set_estimate(struct wb_json *object, const char *key, const struct wb_estimate *e)
{
    struct wb_json *const entry = wb_json_set_object(object, key);
    wb_json_set_number(entry, "value", e->value);
    wb_json_set_number(entry, "low", e->low);
    wb_json_set_number(entry, "high", e->high);
    wb_json_set_number(entry, "candidates_low", e->candidates_low);
    wb_json_set_number(entry, "candidates_high", e->candidates_high);
}

static void set_law(struct wb_json *object, const struct wb_law *law)
{
    struct wb_json *const entry = wb_json_set_object(object, "law");
    const struct wb_material *const m = &law->material;
    wb_json_set_text(entry, "form", wb_law_form_name(law->form));
    wb_json_set_text(entry, "hardening", wb_law_rule_name(law));
    wb_json_set_number(entry, "isotropic_share", law->isotropic_share);
    wb_json_set_number(entry, "youngs_modulus_Pa", m->youngs_modulus);
    wb_json_set_number(entry, "poissons_ratio", m->poissons_ratio);
    wb_law_json_numbers(entry, law, "Pa", 1.0);
}

static void set_curve(struct wb_json *object, const struct wb_card_curve *curve)
{
    struct wb_json *const entry = wb_json_set_object(object, "moment_curvature");
    for (size_t c = 0; c < WB_COUNT(columns); c++) {
        struct wb_json *const array = wb_json_set_array(entry, columns[c].key);
        for (int k = 0; k < WB_CARD_CURVE; k++)
            wb_json_append_number(array, cell(curve, c, k));
    }
}

static void set_origin(struct wb_json *root, const struct wb_card_source *source)
{
    const struct wb_properties *const p = &source->properties;
    struct wb_json *const test = wb_json_set_object(root, "test");
    wb_json_set_text(test, "method", p->method[0] ? p->method : NULL);
    wb_json_set_number(test, "length_m", p->calibration_length);
    wb_json_set_integer(test, "samples", p->n_samples);
    wb_json_set_boolean(test, "virtual_rig", p->is_virtual);
    wb_json_set_boolean(test, "simulation", p->is_simulation);
    wb_json_set_text(test, "tool", p->tool[0] ? p->tool : NULL);
    struct wb_json *const file = wb_json_set_object(root, "source");
    wb_json_set_text(file, "kind", source->is_wire_file ? "wire file" : "properties file");
    wb_json_set_text(file, "file", source->file);
    wb_json_set_text(file, "sha256", source->sha256);
    wb_json_set_text(file, "stated", source->stated[0] ? source->stated : NULL);
    struct wb_json *const datasets = wb_json_set_array(root, "datasets");
    for (int i = 0; i < p->n_datasets && i < WB_PROPERTIES_MOST_DATASETS; i++) {
        const struct wb_properties_dataset *const d = &p->datasets[i];
        struct wb_json *const entry = wb_json_append_object(datasets);
        wb_json_set_text(entry, "name", d->name);
        wb_json_set_text(entry, "of", d->is_recording ? "recording" : "force_deflection.csv");
        wb_json_set_text(entry, "sha256", d->sha256[0] ? d->sha256 : NULL);
    }
    wb_json_set_integer(root, "datasets_in_all", p->n_datasets);
}

static struct wb_json *make_json(const struct wb_card_source *source,
                                 const struct wb_card_curve *curve,
                                 const struct wb_estimate *residual_curvature_ratio)
{
    const struct wb_properties *const p = &source->properties;
    const struct wb_estimate rigidity = wb_card_source_rigidity(source);
    const char *const warning = wb_card_source_warning(source);
    struct wb_json *const root = wb_json_create();
    wb_json_set_text(root, "card", warning ? warning : "wirebench table");
    wb_json_set_integer(root, "schema", 1);
    wb_keys_put_tool(root, "wirebench");
    wb_json_set_text(root, "units", "SI: m, kg, s, N, Pa, rad; as the keys say");
    wb_json_set_text(root, "wire", p->wire);
    wb_json_set_number(root, "outer_diameter_m", p->outer_diameter);
    wb_json_set_number(root, "mass_per_length_kg_m", p->mass_per_length);
    set_law(root, &p->law);
    wb_json_set_boolean(root, "loading_only", !wb_card_source_has_unloading(source));
    set_estimate(root, "flexural_rigidity_N_m2", &rigidity);
    set_estimate(root, "residual_curvature_ratio", residual_curvature_ratio);
    wb_json_set_number(root, "largest_curvature_1_m", wb_card_source_curvature(source));
    wb_json_set_boolean(root, "largest_curvature_tested", isfinite(p->largest_curvature));
    set_curve(root, curve);
    set_origin(root, source);
    return root;
}

enum wb_status wb_card_table_json(const struct wb_card_source *source,
                                  const struct wb_card_settings *settings, struct wb_text *text,
                                  struct wb_reason *why)
{
    struct wb_card_curve curve;
    struct wb_estimate residual_curvature_ratio;
    (void)settings, (void)why;
    WB_TRY(wb_card_curve_init(&curve, source));
    WB_TRY(find_residual_curvature_ratio(source, &residual_curvature_ratio));
    struct wb_json *const root = make_json(source, &curve, &residual_curvature_ratio);
    char *const formatted = wb_json_format(root);
    wb_json_destroy(root);
    /* The origin is on the first line, after the bracket. */
    wb_text_append(text, "{ %s", strchr(formatted, '"'));
    free(formatted);
    return WB_OK;
}

/* --- CSV --- */

enum wb_status wb_card_table_csv(const struct wb_card_source *source,
                                 const struct wb_card_settings *settings, struct wb_text *text,
                                 struct wb_reason *why)
{
    struct wb_card_curve curve;
    struct wb_estimate residual_curvature_ratio;
    (void)settings, (void)why;
    WB_TRY(wb_card_curve_init(&curve, source));
    WB_TRY(find_residual_curvature_ratio(source, &residual_curvature_ratio));
    wb_card_source_append(source, "Table", "# ", text);
    wb_text_append(
        text,
        "# Residual curvature ratio, residual over largest curvature: %.6g. Empty cells are not "
        "known.\n",
        residual_curvature_ratio.value);
    for (size_t c = 0; c < WB_COUNT(columns); c++)
        wb_text_append(text, "%s%s", c > 0 ? "," : "", columns[c].key);
    wb_text_append(text, "\n");
    for (int k = 0; k < WB_CARD_CURVE; k++) {
        for (size_t c = 0; c < WB_COUNT(columns); c++) {
            const double value = cell(&curve, c, k);
            char number[WB_NUMBER_TEXT];
            wb_text_append(text, "%s%s", c > 0 ? "," : "",
                           isfinite(value) ? wb_number_format(value, number) : "");
        }
        wb_text_append(text, "\n");
    }
    return WB_OK;
}
