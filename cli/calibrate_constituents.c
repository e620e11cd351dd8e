/* wirebench calibrate --constituents: a wire computed from its constituents. */
#include <math.h>
#include <stdio.h>

#include "analysis/calibration/constituents/layers.h"
#include "base/circle.h"
#include "base/number.h"
#include "base/units.h"
#include "cli/calibrate.h"
#include "cli/command.h"
#include "cli/file_kind.h"
#include "cli/finding.h"
#include "cli/print.h"
#include "cli/settings.h"
#include "fe/material/material_file.h"

#define WB_LOG_DOMAIN "calibrate"

enum {
    KEY_CURVATURE = WB_KEY_OWN,
    POINTS = 21
};

struct options {
    struct wb_command_common common;
    struct wb_layers layers;
    const char *conductor, *jacket;
    double largest_curvature; /* 1/m */
};

static const struct argp_option other_options[] = {
    {"constituents", WB_KEY_IGNORED, NULL, 0, "A wire from its constituents"},
    {"conductor", WB_KEY_TEXT(options, conductor), "NAME|FILE", 0, "Material of the conductor"},
    {"jacket", WB_KEY_TEXT(options, jacket), "NAME|FILE", 0, "Material of the jacket"},
    {"largest-curvature", KEY_CURVATURE, "K", 0,
     "Curvature up to which moments are printed: 0.001 to 1e6 1/m (50)"},
    {"json", WB_KEY_JSON, NULL, 0, "Print one JSON object"},
    {0},
};

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct options *const o = state->input;
    if (key == KEY_CURVATURE) {
        if (!wb_number_parse(argument, &o->largest_curvature) || !(o->largest_curvature >= 0.001) ||
            !(o->largest_curvature <= 1e6))
            argp_error(state, "--largest-curvature: expected a number from 0.001 to 1e6, not '%s'",
                       argument);
        return 0;
    }
    if (key == ARGP_KEY_END) {
        if (!o->conductor || !(o->layers.conductor_diameter > 0.0))
            argp_error(state, "the conductor is missing: --conductor MATERIAL "
                              "--conductor-diameter-mm D");
        if ((o->jacket != NULL) != (o->layers.outer_diameter > 0.0))
            argp_error(state, "--jacket and --outer-diameter-mm must be given together");
    }
    return wb_command_parse_common(key, argument, state);
}

static const struct argp argp = {
    .options = other_options,
    .parser = parse,
    .args_doc = "",
    .doc = "A wire's flexural rigidity and Poisson's ratio by eqs. 8 and 9, and its bending moment "
           "over curvature, from the materials of conductor and jacket. For a stranded conductor "
           "both bounds are given: strands bonded to a plane section, and strands that slide "
           "without friction.",
};

static enum wb_status read_material(const char *name, struct wb_material *material)
{
    char path[WB_PATH];
    struct wb_material_file file;
    WB_TRY(wb_file_find_fixture(path, "materials", name, NULL));
    WB_TRY(wb_file_kind_check(path, WB_FILE_BIT(WB_FILE_MATERIAL)));
    WB_TRY(wb_material_file_read(&file, path));
    if (!isfinite(file.material.poissons_ratio))
        return wb_fail(WB_ERR_DATA, "%s: poissons_ratio is missing, which eq. 9 needs", path);
    *material = file.material;
    return WB_OK;
}

/* Curvatures in equal steps, and the moments of both limits, N m. */
struct table {
    double curvature[POINTS], bonded[POINTS], sliding[POINTS];
};

static enum wb_status run(struct options *o, struct table *table)
{
    WB_TRY(read_material(o->conductor, &o->layers.conductor));
    if (o->jacket)
        WB_TRY(read_material(o->jacket, &o->layers.jacket));
    else
        o->layers.outer_diameter = o->layers.conductor_diameter;
    for (int i = 0; i < POINTS; i++)
        table->curvature[i] = o->largest_curvature * i / (POINTS - 1);
    WB_TRY(wb_layers_moments(&o->layers, false, table->curvature, POINTS, table->bonded, NULL));
    return wb_layers_moments(&o->layers, true, table->curvature, POINTS, table->sliding, NULL);
}

static void print_text(const struct options *o, const struct table *table)
{
    const double squared = WB_MM * WB_MM;
    const double bonded = wb_layers_rigidity(&o->layers, false);
    const double sliding = wb_layers_rigidity(&o->layers, true);
    const bool two = o->layers.strands > 0;
    printf("%-22s %10.5g N mm2%s\n", "E I, eq. 8", bonded / squared, two ? ", bonded" : "");
    if (two)
        printf("%-22s %10.5g N mm2, sliding strands\n", "", sliding / squared);
    printf("%-22s %10.5g MPa over the outer diameter\n", "E_eff",
           bonded / wb_circle_second_moment(o->layers.outer_diameter) / WB_MPA);
    printf("%-22s %10.3g\n", "nu_eff, eq. 9", wb_layers_poissons_ratio(&o->layers));
    if (two)
        printf("%-22s %10.3g\n", "fill factor", wb_layers_fill(&o->layers));
    printf("\n%12s %14s%s\n", "kappa 1/m", "M N mm", two ? "   M N mm sliding" : "");
    for (int i = 0; i < POINTS; i++) {
        printf("%12.5g %14.6g", table->curvature[i], table->bonded[i] / WB_NMM);
        if (two)
            printf(" %16.6g", table->sliding[i] / WB_NMM);
        putchar('\n');
    }
}

/* A computation from materials: no test of the wire confirms it. */
static void print_finding(const struct options *o, const struct table *table)
{
    struct wb_finding finding = {.figure = NULL};
    char a[WB_PRINT_NUMBER], b[WB_PRINT_NUMBER];
    const bool two = o->layers.strands > 0;
    wb_text_append(&finding.found, "computed from the materials: EI %s",
                   wb_print_number(wb_layers_rigidity(&o->layers, two) / WB_NMM2, a));
    if (two)
        wb_text_append(&finding.found, " (sliding strands) to %s (bonded)",
                       wb_print_number(wb_layers_rigidity(&o->layers, false) / WB_NMM2, a));
    wb_text_append(&finding.found, " N mm2; M at %.4g /m ", table->curvature[POINTS - 1]);
    if (two)
        wb_text_append(&finding.found, "%s to ",
                       wb_print_number(table->sliding[POINTS - 1] / WB_NMM, b));
    wb_text_append(&finding.found, "%s N mm",
                   wb_print_number(table->bonded[POINTS - 1] / WB_NMM, b));
    wb_text_append(&finding.trust, two ? "as bounds: a real wire lies between sliding and bonded "
                                         "strands; no test of the wire was used"
                                       : "as an estimate: no test of the wire was used");
    wb_text_append(&finding.next, "record bending tests of the wire and compare with wirebench "
                                  "calibrate DATASET...");
    wb_finding_print(&finding);
}

static void print_json(const struct options *o, const struct table *table)
{
    const double squared = WB_MM * WB_MM;
    struct wb_json *const root = wb_json_create();
    wb_json_set_number(root, "bonded_rigidity_N_mm2",
                       wb_layers_rigidity(&o->layers, false) / squared);
    wb_json_set_number(root, "sliding_rigidity_N_mm2",
                       wb_layers_rigidity(&o->layers, true) / squared);
    wb_json_set_number(root, "youngs_modulus_MPa",
                       wb_layers_rigidity(&o->layers, false) /
                           wb_circle_second_moment(o->layers.outer_diameter) / WB_MPA);
    wb_json_set_number(root, "poissons_ratio", wb_layers_poissons_ratio(&o->layers));
    wb_json_set_number(root, "fill", wb_layers_fill(&o->layers));
    struct wb_json *const points = wb_json_set_array(root, "points");
    for (int i = 0; i < POINTS; i++) {
        struct wb_json *const point = wb_json_append_object(points);
        wb_json_set_number(point, "curvature_1_m", table->curvature[i]);
        wb_json_set_number(point, "bonded_moment_Nmm", table->bonded[i] / WB_NMM);
        wb_json_set_number(point, "sliding_moment_Nmm", table->sliding[i] / WB_NMM);
    }
    wb_command_print_json(root);
}

int wb_calibrate_constituents(int argc, char **argv)
{
    struct options options = {.largest_curvature = 50.0};
    struct table table;
    wb_settings_parse_table(&argp, &wb_layers_table, &options.layers, 1, argc, argv, &options);
    if (run(&options, &table) != WB_OK)
        return WB_EXIT_FAILED;
    if (options.common.json) {
        print_json(&options, &table);
    } else {
        print_text(&options, &table);
        print_finding(&options, &table);
    }
    return WB_EXIT_OK;
}
