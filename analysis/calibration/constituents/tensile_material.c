#include "analysis/calibration/constituents/tensile_material.h"

#include <math.h>
#include <stdio.h>

#include "base/config.h"
#include "base/file.h"
#include "base/text.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "tensile"

static const struct wb_setting rows[] = {
    {WB_ROW_QUANTITY(wb_tensile_material_settings, youngs_modulus, "youngs_modulus_MPa", "MPa",
                     WB_MPA, 0.001, 1e7, 0.0),
     WB_ROW_OPTION("youngs-modulus-mpa", "E", "Young's modulus, known from elsewhere"),
     .otherwise = "of the tests"},
    {WB_ROW_QUANTITY(wb_tensile_material_settings, density, "density_g_cm3", "g/cm3", WB_G_PER_CM3,
                     0.001, 30.0, 0.0),
     WB_ROW_OPTION("density-g-cm3", "R", "Density"), .otherwise = "none"},
    {WB_ROW_NUMBER(wb_tensile_material_settings, poissons_ratio, "poissons_ratio", 0.0, 0.499, 0.0),
     WB_ROW_OPTION("poissons-ratio", "NU", "Poisson's ratio"), .otherwise = "none"},
};
const struct wb_setting_table wb_tensile_material_table = {WB_SETTING_ROWS(rows)};

static void put(struct wb_text *text, const char *indent, const char *key, double value,
                double unit)
{
    wb_text_append(text, "%s%s: %.6g\n", indent, key, value / unit);
}

static void put_interval(struct wb_text *text, const char *key,
                         const struct wb_tensile_number *number, double unit)
{
    if (number->n > 1)
        wb_text_append(text, "  %s: [%.4g, %.4g]\n", key, number->low / unit, number->high / unit);
}

/* Double-quoted YAML, which permits any name. */
static void put_text(struct wb_text *text, const char *key, const char *value)
{
    wb_text_append(text, "%s: \"", key);
    for (const char *at = value; *at; at++)
        wb_text_append(text, *at == '"' || *at == '\\' ? "\\%c" : "%c", *at);
    wb_text_append(text, "\"\n");
}

static enum wb_status check(const struct wb_tensile_result *result,
                            const struct wb_tensile_material_settings *settings,
                            struct wb_reason *why)
{
    for (int i = 0; i < result->n_specimens; i++) {
        if (!result->specimens[i].start_is_straight)
            return wb_fail_to(
                why, WB_ERR_DATA,
                "sample %d: the start of the curve is not straight: there is no plastic "
                "strain, and no law for a material file",
                result->specimens[i].sample);
    }
    if (!isfinite(result->of_mean.rms))
        return wb_fail_to(
            why, WB_ERR_DATA,
            "no law fitted: too few points beyond the yield point for a material file");
    if (!(settings->youngs_modulus > 0.0) && !result->own_elongation)
        return wb_fail_to(why, WB_ERR_DATA,
                          "a material file needs E, which crosshead travel does not give: add "
                          "--youngs-modulus-mpa");
    if (!(settings->density > 0.0))
        return wb_fail_to(why, WB_ERR_DATA, "a material file needs --density-g-cm3");
    if (!(result->of_mean.yield_stress > 0.0))
        return wb_fail_to(why, WB_ERR_DATA,
                          "the least squares give no yield stress above zero: begin them at a "
                          "smaller --fit-from");
    return WB_OK;
}

static void append(struct wb_text *text, const struct wb_tensile_result *result, const char *name,
                   const struct wb_tensile_material_settings *settings)
{
    const bool given = settings->youngs_modulus > 0.0;
    char own[128], alike[160], source[400];
    snprintf(own, sizeof own, "%.60s, %s", result->wire,
             wb_test_piece_constituent_name(result->constituent));
    if (result->n_followed > 0)
        snprintf(alike, sizeof alike,
                 "the law fits %d of the curves; n from %.3g to %.3g fits alike%s",
                 result->n_followed, result->n_low, result->n_high,
                 result->identifiable ? "" : ": sigma_Y, K and n are strongly correlated");
    else
        snprintf(alike, sizeof alike, "the law fits no curve");
    snprintf(source, sizeof source, "%d tensile test%s of %s, elongation by %s; E %s; %s",
             result->n_specimens, result->n_specimens == 1 ? "" : "s", own,
             result->own_elongation ? "extensometer" : "crosshead",
             given ? "known from elsewhere" : "of the tests", alike);
    wb_text_append(text, "schema: %d\n", WB_CONFIG_SCHEMA);
    put_text(text, "name", name ? name : own);
    put_text(text, "source", source);
    wb_text_append(text, "origin: tensile tests\n");
    put(text, "", "youngs_modulus_MPa",
        given ? settings->youngs_modulus : result->youngs_modulus.mean, WB_MPA);
    if (settings->poissons_ratio > 0.0)
        put(text, "", "poissons_ratio", settings->poissons_ratio, 1.0);
    put(text, "", "yield_stress_MPa", result->of_mean.yield_stress, WB_MPA);
    put(text, "", "strength_coefficient_MPa", result->of_mean.strength_coefficient, WB_MPA);
    put(text, "", "hardening_exponent", result->of_mean.hardening_exponent, 1.0);
    put(text, "", "density_g_cm3", settings->density, WB_G_PER_CM3);
    if (result->direct_exponent.n < 2)
        return;
    wb_text_append(text, "intervals:  # 95 %% of the mean over %d specimens\n",
                   result->direct_exponent.n);
    if (!given)
        put_interval(text, "youngs_modulus_MPa", &result->youngs_modulus, WB_MPA);
    put_interval(text, "yield_stress_MPa", &result->direct_yield, WB_MPA);
    put_interval(text, "strength_coefficient_MPa", &result->direct_strength, WB_MPA);
    put_interval(text, "hardening_exponent", &result->direct_exponent, 1.0);
}

enum wb_status wb_tensile_material_write(const struct wb_tensile_result *result, const char *name,
                                         const struct wb_tensile_material_settings *settings,
                                         const char *path, struct wb_reason *why)
{
    struct wb_text text = {0};
    WB_TRY(check(result, settings, why));
    append(&text, result, name, settings);
    const enum wb_status status = wb_file_write_text(path, &text);
    wb_text_release(&text);
    return status;
}
