/* wirebench calibrate --tensile: tensile tests of a wire's constituents. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/calibration/constituents/tensile.h"
#include "analysis/calibration/constituents/tensile_material.h"
#include "base/units.h"
#include "cli/calibrate.h"
#include "cli/command.h"
#include "cli/datasets.h"
#include "cli/finding.h"
#include "cli/settings.h"

#define WB_LOG_DOMAIN "calibrate"

struct options {
    struct wb_command_common common;
    struct wb_datasets datasets;
    struct wb_tensile_settings settings;
    struct wb_tensile_material_settings material;
    const char *name;
};

static const struct argp_option other_options[] = {
    {"tensile", WB_KEY_IGNORED, NULL, 0, "Tensile tests"},
    {"output", 'o', "MATERIAL.yaml", 0, "Write a material file here"},
    {"name", WB_KEY_TEXT(options, name), "NAME", 0,
     "Name of the material (name of the wire and the constituent)"},
    {"force", WB_KEY_FORCE, NULL, 0, "Overwrite the material file"},
    {"json", WB_KEY_JSON, NULL, 0, "Print one JSON object"},
    {0},
};

static const struct argp argp = {
    .options = other_options,
    .parser = wb_command_parse_common,
    .args_doc = "DATASET...",
    .doc =
        "Properties of a conductor, a jacket or a tape from datasets of tensile tests (`wirebench "
        "import force`): initial slope, proof stress, strength, stresses at plastic strains, "
        "and K and n by eq. 7 and by least squares, with intervals over the specimens.\v"
        "The travel of a crosshead does not give E: a material file then needs "
        "--youngs-modulus-mpa. Exit code 3: Ludwik's law does not fit every curve within "
        "--alike, or no law could be fitted.",
};

/* --- text --- */

static void print_number(const char *name, const struct wb_tensile_number *number, double unit,
                         const char *unit_name)
{
    if (number->n == 0)
        printf("%-28s %10s\n", name, "-");
    else if (isfinite(number->low))
        printf("%-28s %10.4g %-4s  %.4g to %.4g\n", name, number->mean / unit, unit_name,
               number->low / unit, number->high / unit);
    else
        printf("%-28s %10.4g %s\n", name, number->mean / unit, unit_name);
}

static void print_modulus(const struct wb_tensile_result *r)
{
    if (r->own_elongation) {
        print_number("E", &r->youngs_modulus, WB_MPA, "MPa");
        return;
    }
    printf("%-28s crosshead travel: no E\n", "E");
    print_number("slope with grips and machine", &r->slope, WB_MPA, "MPa");
}

static void print_laws(const struct options *o, const struct wb_tensile_result *r)
{
    if (r->direct_exponent.n == 0) {
        printf("no law is fitted: %s\n", r->specimens[0].start_is_straight
                                             ? "too few points beyond the yield point"
                                             : "there is no plastic strain");
        return;
    }
    printf("sigma = sigma_Y + K ep^n (eq. 6), least squares\n");
    print_number("  sigma_Y", &r->direct_yield, WB_MPA, "MPa");
    print_number("  K", &r->direct_strength, WB_MPA, "MPa");
    print_number("  n", &r->direct_exponent, 1.0, "");
    if (!r->follows)
        printf("  this law fits %d of %d curves within %.3g %% of the strength (--alike): use the "
               "stresses above\n",
               r->n_followed, r->n_specimens, o->settings.alike / WB_PERCENT);
    if (r->identifiable)
        printf("  n from %.3g to %.3g fits equally well\n", r->n_low, r->n_high);
    else if (isfinite(r->n_low))
        printf("  not identifiable: n from %.3g to %.3g fits equally well, each with its own "
               "sigma_Y and K; use the three only together\n",
               r->n_low, r->n_high);
    if (isfinite(r->of_mean.rms) && r->n_specimens > 1) {
        printf("  of the mean curve: %.4g MPa, %.4g MPa, %.3g, misfit %.2g MPa",
               r->of_mean.yield_stress / WB_MPA, r->of_mean.strength_coefficient / WB_MPA,
               r->of_mean.hardening_exponent, r->of_mean.rms / WB_MPA);
        if (isfinite(r->of_mean_n_low))
            printf("; n from %.3g to %.3g fits equally well", r->of_mean_n_low, r->of_mean_n_high);
        putchar('\n');
    }
    printf("by eq. 7, with the proof stress as sigma_Y\n");
    print_number("  K", &r->eq7_strength, WB_MPA, "MPa");
    print_number("  n", &r->eq7_exponent, 1.0, "");
}

static void print_cell(int width, int digits, double value)
{
    if (isfinite(value))
        printf(" %*.*g", width, digits, value);
    else
        printf(" %*s", width, "-");
}

static void print_specimens(const struct wb_tensile_result *r)
{
    printf(
        "\nsample  slack %%  slope MPa  proof MPa  strength MPa  at %%   sigma_Y MPa    K MPa      "
        "n  misfit MPa  n fits equally\n");
    for (int i = 0; i < r->n_specimens; i++) {
        const struct wb_tensile_specimen *const s = &r->specimens[i];
        printf("%6d %8.3f %10.5g", s->sample, s->slack / WB_PERCENT, s->slope / WB_MPA);
        print_cell(10, 4, s->proof_stress / WB_MPA);
        printf(" %13.4g %5.3g", s->strength / WB_MPA, s->uniform_strain / WB_PERCENT);
        print_cell(13, 4, s->direct.yield_stress / WB_MPA);
        print_cell(8, 4, s->direct.strength_coefficient / WB_MPA);
        print_cell(6, 3, s->direct.hardening_exponent);
        print_cell(11, 3, s->direct.rms / WB_MPA);
        if (isfinite(s->n_low))
            printf("  %.3g to %.3g\n", s->n_low, s->n_high);
        else
            printf("  none\n");
    }
}

static void print_text(const struct options *o, const struct wb_tensile_result *r)
{
    char name[48];
    printf("%s of %s: %d specimen%s, area %.4g mm2, gauge length %.4g mm\n\n",
           wb_test_piece_constituent_name(r->constituent), r->wire, r->n_specimens,
           r->n_specimens == 1 ? "" : "s", r->area / (WB_MM * WB_MM), r->gauge_length / WB_MM);
    printf("%-28s %10s %-4s  %s\n", "", "mean", "",
           r->n_specimens > 1 ? "95 % interval of the mean" : "(one specimen: no interval)");
    print_modulus(r);
    snprintf(name, sizeof name, "proof stress, %.3g %%", o->settings.proof_offset / WB_PERCENT);
    print_number(name, &r->proof_stress, WB_MPA, "MPa");
    print_number("strength", &r->strength, WB_MPA, "MPa");
    print_number("strain there", &r->uniform_strain, WB_PERCENT, "%");
    for (int k = 0; k < WB_TENSILE_STRESSES; k++) {
        snprintf(name, sizeof name, "true stress at ep = %g", wb_tensile_plastic_strains[k]);
        print_number(name, &r->stress[k], WB_MPA, "MPa");
    }
    print_laws(o, r);
    print_specimens(r);
    for (int i = 0; i < r->n_specimens; i++) {
        if (!r->specimens[i].start_is_straight)
            printf("\nsample %d: the curve has no straight start: no proof stress, no plastic "
                   "strain, no law\n",
                   r->specimens[i].sample);
    }
    if (r->constituent != WB_CONDUCTOR)
        printf("\nloading alone cannot separate plastic strain from nonlinear elastic strain, as "
               "rubber has it\n");
    if (o->common.output)
        printf("\nwritten to %s\n", o->common.output);
}

static void append_number(struct wb_text *text, const char *name,
                          const struct wb_tensile_number *number)
{
    wb_text_append(text, "%s %.4g MPa", name, number->mean / WB_MPA);
    if (isfinite(number->low))
        wb_text_append(text, " (%.4g to %.4g)", number->low / WB_MPA, number->high / WB_MPA);
}

static void append_trust(struct wb_text *text, const struct wb_tensile_result *r)
{
    if (r->direct_exponent.n == 0)
        wb_text_append(text, "for the stresses only: no law could be fitted");
    else if (!r->follows)
        wb_text_append(text, "for the stresses only: Ludwik's law fits %d of %d curves (--alike)",
                       r->n_followed, r->n_specimens);
    else if (!r->identifiable)
        wb_text_append(text,
                       "yes, but sigma_Y, K and n only together: n from %.3g to %.3g fits "
                       "equally well",
                       r->n_low, r->n_high);
    else
        wb_text_append(text, "yes: Ludwik's law fits all curves, for loading");
    if (!r->own_elongation)
        wb_text_append(text, "; no E: the elongation is the crosshead's travel");
    if (r->n_specimens == 1)
        wb_text_append(text, "; one specimen cannot show how specimens differ");
}

static void print_finding(const struct options *o, const struct wb_tensile_result *r)
{
    struct wb_finding finding = {.figure = NULL};
    wb_text_append(&finding.found,
                   "%s of %s (%s, %d specimen%s): ", wb_test_piece_constituent_name(r->constituent),
                   r->wire, wb_finding_source(&o->datasets.items[0].info), r->n_specimens,
                   r->n_specimens == 1 ? "" : "s");
    if (r->own_elongation) {
        append_number(&finding.found, "E", &r->youngs_modulus);
        wb_text_append(&finding.found, "; ");
    }
    if (r->proof_stress.n > 0) {
        append_number(&finding.found, "proof stress", &r->proof_stress);
        wb_text_append(&finding.found, "; ");
    }
    append_number(&finding.found, "strength", &r->strength);
    append_trust(&finding.trust, r);
    if (r->direct_exponent.n == 0)
        wb_text_append(&finding.next, "use the stresses above; a material file needs a law");
    else if (!o->common.output)
        wb_text_append(
            &finding.next, "run the same command with -o MATERIAL.yaml%s%s to keep the law",
            r->own_elongation || o->material.youngs_modulus > 0.0 ? "" : " --youngs-modulus-mpa E",
            o->material.density > 0.0 ? "" : " --density-g-cm3 R");
    else if (r->constituent == WB_CONDUCTOR || r->constituent == WB_JACKET) {
        wb_text_append(&finding.next, "wirebench calibrate --constituents --%s ",
                       r->constituent == WB_CONDUCTOR ? "conductor" : "jacket");
        wb_text_append_quoted(&finding.next, o->common.output);
        wb_text_append(&finding.next, " ..., for the wire's rigidity and moments");
    } else {
        wb_text_append(&finding.next, "name the material in a bundle file as its tape");
    }
    wb_finding_print(&finding);
}

/* --- JSON --- */

static void set_number(struct wb_json *root, const char *key,
                       const struct wb_tensile_number *number, double unit)
{
    struct wb_json *const object = wb_json_set_object(root, key);
    wb_json_set_number(object, "mean", number->mean / unit);
    wb_json_set_number(object, "low", number->low / unit);
    wb_json_set_number(object, "high", number->high / unit);
    wb_json_set_integer(object, "specimens", number->n);
}

static void set_law(struct wb_json *object, const struct wb_tensile_law *law)
{
    wb_json_set_number(object, "yield_stress_MPa", law->yield_stress / WB_MPA);
    wb_json_set_number(object, "strength_coefficient_MPa", law->strength_coefficient / WB_MPA);
    wb_json_set_number(object, "hardening_exponent", law->hardening_exponent);
    wb_json_set_number(object, "rms_MPa", law->rms / WB_MPA);
}

static void set_specimens(struct wb_json *root, const struct wb_tensile_result *r)
{
    struct wb_json *const list = wb_json_set_array(root, "specimens");
    for (int i = 0; i < r->n_specimens; i++) {
        const struct wb_tensile_specimen *const s = &r->specimens[i];
        struct wb_json *const object = wb_json_append_object(list);
        wb_json_set_integer(object, "sample", s->sample);
        wb_json_set_integer(object, "points", (int64_t)s->n_points);
        wb_json_set_boolean(object, "start_is_straight", s->start_is_straight);
        wb_json_set_number(object, "slack", s->slack);
        wb_json_set_number(object, "slope_MPa", s->slope / WB_MPA);
        wb_json_set_number(object, "proof_stress_MPa", s->proof_stress / WB_MPA);
        wb_json_set_number(object, "strength_MPa", s->strength / WB_MPA);
        wb_json_set_number(object, "uniform_strain", s->uniform_strain);
        struct wb_json *const stresses = wb_json_set_array(object, "true_stress_MPa");
        for (int k = 0; k < WB_TENSILE_STRESSES; k++)
            wb_json_append_number(stresses, s->stress[k] / WB_MPA);
        set_law(wb_json_set_object(object, "least_squares"), &s->direct);
        set_law(wb_json_set_object(object, "eq7"), &s->eq7);
        wb_json_set_number(object, "exponent_alike_low", s->n_low);
        wb_json_set_number(object, "exponent_alike_high", s->n_high);
    }
}

static void print_json(const struct options *o, const struct wb_tensile_result *r)
{
    struct wb_json *const root = wb_json_create();
    wb_json_set_text(root, "wire", r->wire);
    wb_json_set_text(root, "constituent", wb_test_piece_constituent_name(r->constituent));
    wb_json_set_number(root, "area_mm2", r->area / (WB_MM * WB_MM));
    wb_json_set_number(root, "gauge_length_mm", r->gauge_length / WB_MM);
    wb_json_set_boolean(root, "elongation_is_the_specimens", r->own_elongation);
    wb_json_set_number(root, "proof_offset", o->settings.proof_offset);
    set_number(root, "youngs_modulus_MPa", &r->youngs_modulus, WB_MPA);
    set_number(root, "slope_MPa", &r->slope, WB_MPA);
    set_number(root, "proof_stress_MPa", &r->proof_stress, WB_MPA);
    set_number(root, "strength_MPa", &r->strength, WB_MPA);
    set_number(root, "uniform_strain", &r->uniform_strain, 1.0);
    struct wb_json *const strains = wb_json_set_array(root, "plastic_strains");
    for (int k = 0; k < WB_TENSILE_STRESSES; k++)
        wb_json_append_number(strains, wb_tensile_plastic_strains[k]);
    set_number(root, "true_stress_at_0_002_MPa", &r->stress[0], WB_MPA);
    set_number(root, "true_stress_at_0_01_MPa", &r->stress[1], WB_MPA);
    set_number(root, "true_stress_at_0_05_MPa", &r->stress[2], WB_MPA);
    struct wb_json *const direct = wb_json_set_object(root, "least_squares");
    set_number(direct, "yield_stress_MPa", &r->direct_yield, WB_MPA);
    set_number(direct, "strength_coefficient_MPa", &r->direct_strength, WB_MPA);
    set_number(direct, "hardening_exponent", &r->direct_exponent, 1.0);
    wb_json_set_number(direct, "exponent_alike_low", r->n_low);
    wb_json_set_number(direct, "exponent_alike_high", r->n_high);
    wb_json_set_integer(direct, "followed", r->n_followed);
    wb_json_set_boolean(direct, "follows", r->follows);
    wb_json_set_boolean(direct, "identifiable", r->identifiable);
    struct wb_json *const of_mean = wb_json_set_object(direct, "of_mean_curve");
    set_law(of_mean, &r->of_mean);
    wb_json_set_number(of_mean, "exponent_alike_low", r->of_mean_n_low);
    wb_json_set_number(of_mean, "exponent_alike_high", r->of_mean_n_high);
    struct wb_json *const eq7 = wb_json_set_object(root, "eq7");
    set_number(eq7, "strength_coefficient_MPa", &r->eq7_strength, WB_MPA);
    set_number(eq7, "hardening_exponent", &r->eq7_exponent, 1.0);
    set_specimens(root, r);
    wb_command_print_json(root);
}

/* --- the command --- */

static enum wb_status run(struct options *o, struct wb_tensile_result *result)
{
    WB_TRY(wb_datasets_read(&o->datasets, o->common.inputs, o->common.n,
                            WB_TEST_BIT(WB_TEST_TENSILE)));
    WB_TRY(wb_tensile_run(result, o->datasets.pointers, o->datasets.n, &o->settings, NULL));
    if (!o->common.output)
        return WB_OK;
    WB_TRY(wb_command_check_output(o->common.output, o->common.force));
    return wb_tensile_material_write(result, o->name, &o->material, o->common.output, NULL);
}

static int deliver(const struct options *o, const struct wb_tensile_result *result)
{
    if (o->common.json) {
        print_json(o, result);
    } else {
        print_text(o, result);
        print_finding(o, result);
    }
    return result->follows ? WB_EXIT_OK : WB_EXIT_INCOMPLETE;
}

int wb_calibrate_tensile(int argc, char **argv)
{
    static const struct wb_settings_source sources[] = {
        {.tables = &wb_tensile_table, .n_tables = 1, .offset = offsetof(struct options, settings)},
        {.tables = &wb_tensile_material_table,
         .n_tables = 1,
         .offset = offsetof(struct options, material),
         .title = "Of the material file:"},
    };
    static const struct wb_settings_command command = {
        .argp = &argp,
        .sources = sources,
        .n_sources = WB_COUNT(sources),
        .place = 1,
    };
    struct options options = {.common = {.noun = "at least one tensile dataset", .least = 1}};
    struct wb_tensile_result result = {.n_specimens = 0};
    wb_tensile_default_settings(&options.settings);
    wb_setting_fill(&wb_tensile_material_table, &options.material);
    wb_settings_parse(&command, argc, argv, &options);
    int code = wb_command_exit(run(&options, &result));
    if (code == WB_EXIT_OK)
        code = deliver(&options, &result);
    wb_tensile_release(&result);
    wb_datasets_release(&options.datasets);
    return code;
}
