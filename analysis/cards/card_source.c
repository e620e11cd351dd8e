#include "analysis/cards/card_source.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_cdf.h>

#include "base/circle.h"
#include "base/config.h"
#include "base/file.h"
#include "base/units.h"
#include "base/version.h"
#include "fe/material/law.h"
#include "fe/model/wire.h"

#define WB_LOG_DOMAIN "card"

/* Strain of the outer fibre up to which a law of unknown range is used. */
static const double assumed_strain = 0.02;

/* --- reading --- */

static enum wb_status parse_wire(struct wb_card_source *source, const char *text,
                                 const char *origin, struct wb_reason *why)
{
    struct wb_wire wire;
    WB_TRY(wb_wire_parse(text, origin, &wire, why));
    if (!wire.has_properties)
        return wb_fail_to(why, WB_ERR_FORMAT,
                          "%s: properties: wire %s has none, and a card is made from them; "
                          "calibrate tests with 'wirebench calibrate'",
                          origin, wire.name);
    wb_properties_from_wire(&wire, &source->properties);
    source->is_wire_file = true;
    snprintf(source->stated, sizeof source->stated, "%s", wire.source);
    return WB_OK;
}

/* Determines which of the two files it is. */
static enum wb_status recognise(const char *text, const char *origin, bool *is_wire_file,
                                struct wb_reason *why)
{
    struct wb_config *config;
    WB_TRY(wb_config_parse(&config, text, origin, why));
    const struct wb_config_node *const root = wb_config_root(config);
    const bool is_properties = wb_config_find(root, "wire") != NULL;
    *is_wire_file = wb_config_find(root, "name") && wb_config_find(root, "conductor_diameter_mm");
    wb_config_destroy(config);
    if (is_properties == *is_wire_file)
        return wb_fail_to(why, WB_ERR_FORMAT,
                          "%s: expected a wire file (with 'name' and 'conductor_diameter_mm') or a "
                          "properties file from 'wirebench calibrate' (with 'wire')",
                          origin);
    return WB_OK;
}

enum wb_status wb_card_source_parse(struct wb_card_source *source, const char *text,
                                    const char *origin, struct wb_reason *why)
{
    bool is_wire_file;
    WB_TRY(recognise(text, origin, &is_wire_file, why));
    struct wb_card_source read = {.is_wire_file = false};
    if (is_wire_file)
        WB_TRY(parse_wire(&read, text, origin, why));
    else
        WB_TRY(wb_properties_parse(text, origin, &read.properties, why));
    WB_TRY(wb_law_check(&read.properties.law, why));
    snprintf(read.file, sizeof read.file, "%.95s", wb_file_name(origin));
    wb_hash_bytes(text, strlen(text), read.sha256);
    *source = read;
    return WB_OK;
}

enum wb_status wb_card_source_read(struct wb_card_source *source, const char *path)
{
    char *text;
    size_t size;
    WB_TRY(wb_file_read(path, &text, &size));
    const enum wb_status status = strlen(text) == size
                                      ? wb_card_source_parse(source, text, path, NULL)
                                      : wb_fail(WB_ERR_FORMAT,
                                                "%s: expected a wire or properties file, but it is "
                                                "not text; export a recording without --to",
                                                path);
    free(text);
    return status;
}

/* --- derived quantities --- */

struct wb_estimate wb_card_source_rigidity(const struct wb_card_source *source)
{
    const struct wb_properties *const p = &source->properties;
    const double unknown = (double)NAN;
    if (isfinite(p->rigidity.value))
        return p->rigidity;
    const double I = wb_circle_second_moment(p->outer_diameter);
    struct wb_estimate e = {
        p->law.material.youngs_modulus * I, unknown, unknown, p->rigidity.candidates_low,
        p->rigidity.candidates_high,        unknown};
    const int n = wb_properties_units(p);
    if (n > 1 && isfinite(p->deviation[0]) && wb_law_is_plain(&p->law)) {
        const double half = gsl_cdf_tdist_Qinv(0.025, n - 1) * p->deviation[0] * I;
        e.low = e.value - half;
        e.high = e.value + half;
    }
    return e;
}

double wb_card_source_curvature(const struct wb_card_source *source)
{
    const double known = source->properties.largest_curvature;
    return isfinite(known) ? known : assumed_strain / (0.5 * source->properties.outer_diameter);
}

bool wb_card_source_has_unloading(const struct wb_card_source *source)
{
    return source->properties.is_rule_tested && source->properties.is_rule_supported;
}

const char *wb_card_source_warning(const struct wb_card_source *source)
{
    if (source->properties.is_virtual)
        return "MADE OF VIRTUAL DATA: the tests were made on a virtual rig, not on a wire.";
    if (source->properties.is_simulation)
        return "MADE OF SIMULATED DATA: the tests were computed, not measured.";
    return NULL;
}

/* --- header of a card --- */

/* Length at which a line is broken; input files of some programs permit 256 characters. */
enum {
    LINE = 110
};

/* Appends a sentence, broken into lines that begin with the prefix; "--" becomes "- -". */
static void put(struct wb_text *text, const char *prefix, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
static void put(struct wb_text *text, const char *prefix, const char *format, ...)
{
    char sentence[2048], *rest = NULL;
    size_t column = 0;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(sentence, sizeof sentence, format, arguments);
    va_end(arguments);
    for (char *c = sentence; *c; c++) {
        if ((unsigned char)*c < 0x20)
            *c = ' ';
    }
    wb_text_append(text, "%s", prefix);
    for (char *word = strtok_r(sentence, " ", &rest); word; word = strtok_r(NULL, " ", &rest)) {
        const bool breaks = column > 0 && column + strlen(word) >= LINE;
        if (breaks)
            wb_text_append(text, "\n%s  ", prefix);
        column = breaks ? strlen(word) : column + strlen(word) + 1;
        wb_text_append(text, "%s", breaks || word == sentence ? "" : " ");
        for (const char *c = word; *c; c++)
            wb_text_append(text, c[0] == '-' && c[1] == '-' ? "- " : "%c", *c);
    }
    wb_text_append(text, "\n");
}

static void put_interval(struct wb_text *text, const char *prefix,
                         const struct wb_card_source *source)
{
    const struct wb_estimate e = wb_card_source_rigidity(source);
    put(text, prefix, "Flexural rigidity EI of the virgin wire: %.6g N m2.", e.value);
    if (isfinite(e.low) && isfinite(e.high))
        put(text, prefix, "Interval of 95 %% of EI: %.6g to %.6g N m2.", e.low, e.high);
    else
        put(text, prefix, "Interval of EI: unknown.");
    if (isfinite(e.candidates_low) && isfinite(e.candidates_high))
        put(text, prefix,
            "Range of EI over the laws that the data do not exclude: %.6g to %.6g "
            "N m2.",
            e.candidates_low, e.candidates_high);
}

static void put_range(struct wb_text *text, const char *prefix, const struct wb_card_source *source)
{
    const double curvature = wb_card_source_curvature(source);
    const double strain = 0.5 * curvature * source->properties.outer_diameter;
    if (isfinite(source->properties.largest_curvature))
        put(text, prefix,
            "Curvature range: 0 to %.6g 1/m as tested (%.3g of strain at the outer fibre); the law "
            "is extrapolated beyond it.",
            curvature, strain);
    else
        put(text, prefix,
            "Curvature range: the file states none; used up to %.6g 1/m, %.3g of strain at the "
            "outer fibre.",
            curvature, strain);
}

static void put_rule(struct wb_text *text, const char *prefix, const struct wb_card_source *source)
{
    const struct wb_properties *const p = &source->properties;
    if (wb_card_source_has_unloading(source))
        put(text, prefix, "Hardening rule: %s, supported by loading and unloading.",
            wb_law_rule_name(&p->law));
    else
        put(text, prefix, "LOADING ONLY: the hardening rule (%s) %s.", wb_law_rule_name(&p->law),
            p->is_rule_tested      ? "is not supported by the measured unloading"
            : source->is_wire_file ? "is that of the wire file, which names no test of it"
                                   : "was not tested by an unloading");
}

static void put_tests(struct wb_text *text, const char *prefix, const struct wb_card_source *source)
{
    const struct wb_properties *const p = &source->properties;
    struct wb_text words = {0};
    if (strcmp(p->method, "three-point") == 0)
        wb_text_append(&words, "three-point bending, loading and unloading");
    else if (strcmp(p->method, "cycle") == 0)
        wb_text_append(&words, "cantilever bending, whole cycles");
    else if (p->method[0])
        wb_text_append(&words, "cantilever bending, first loading");
    else
        wb_text_append(&words, "not stated");
    if (isfinite(p->calibration_length))
        wb_text_append(&words, ", free length %.6g mm", p->calibration_length / WB_MM);
    if (p->n_samples > 0)
        wb_text_append(&words, ", %d sample%s", p->n_samples, p->n_samples == 1 ? "" : "s");
    if (p->n_series > 1)
        wb_text_append(&words, " in %d series", p->n_series);
    put(text, prefix, "Test conditions: %s; quasi-static. Temperature and humidity: not stated.",
        wb_text_string(&words));
    wb_text_release(&words);
}

static void put_checksums(struct wb_text *text, const char *prefix,
                          const struct wb_card_source *source)
{
    const struct wb_properties *const p = &source->properties;
    const int kept =
        p->n_datasets < WB_PROPERTIES_MOST_DATASETS ? p->n_datasets : WB_PROPERTIES_MOST_DATASETS;
    put(text, prefix, "%s: %s, sha256 %s", source->is_wire_file ? "Wire file" : "Properties",
        source->file, source->sha256);
    if (source->stated[0])
        put(text, prefix, "Source of the values, as stated in the file: %s", source->stated);
    if (p->tool[0])
        put(text, prefix, "Calibrated by: %s", p->tool);
    if (kept == 0)
        put(text, prefix, "Datasets: none stated.");
    for (int i = 0; i < kept; i++) {
        const struct wb_properties_dataset *const d = &p->datasets[i];
        put(text, prefix, "%s: %s, %ssha256 %s", d->is_recording ? "Recording" : "Dataset", d->name,
            d->is_recording ? "" : "force_deflection.csv ", d->sha256[0] ? d->sha256 : "unknown");
    }
    if (kept < p->n_datasets)
        put(text, prefix, "and %d more, listed in the properties file.", p->n_datasets - kept);
}

void wb_card_source_append(const struct wb_card_source *source, const char *kind,
                           const char *prefix, struct wb_text *text)
{
    const struct wb_properties *const p = &source->properties;
    static const char *const forms[] = {
        [WB_LAW_LUDWIK] = "Ludwik's, sigma_Y + K ep^n",
        [WB_LAW_PARALLEL] = "parallel parts",
        [WB_LAW_CHABOCHE] =
            ("Chaboche's, yields at sigma_Y + Q (1 - exp(-b p)) about the sum of X, "
             "dX = C dep - gamma X dp"),
    };
    const char *const warning = wb_card_source_warning(source);
    struct wb_text numbers = {0};
    if (warning)
        put(text, prefix, "%s", warning);
    put(text, prefix, "%s of wire %s.", kind, p->wire);
    put(text, prefix, "Written by wirebench %s (%s).", wb_version(), wb_version_revision());
    put(text, prefix, "Units of the data: SI (m, kg, s, N, Pa, rad).");
    put(text, prefix,
        "Wire: outer diameter %.6g m, mass %.6g kg/m; homogenised, a solid circle of one law.",
        p->outer_diameter, p->mass_per_length);
    wb_law_append_numbers(&numbers, &p->law);
    put(text, prefix, "Law: %s, %s; %s; Poisson's ratio %.6g.", forms[p->law.form],
        wb_law_rule_name(&p->law), wb_text_string(&numbers), p->law.material.poissons_ratio);
    wb_text_release(&numbers);
    if (p->law.n_maxwell > 0)
        put(text, prefix,
            "The wire relaxes: moments below are at the strain rate of the tests, the stresses of "
            "a material those of the relaxed law.");
    put_interval(text, prefix, source);
    put_range(text, prefix, source);
    put_rule(text, prefix, source);
    put_tests(text, prefix, source);
    put_checksums(text, prefix, source);
}
