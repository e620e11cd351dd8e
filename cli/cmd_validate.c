/* wirebench validate: properties against datasets that were not used for the calibration. */
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/calibration/properties/properties.h"
#include "analysis/report/draw/figures_compared.h"
#include "analysis/validation/validate_bounds.h"
#include "analysis/validation/validate_json.h"
#include "analysis/validation/validate_tables.h"
#include "analysis/validation/validate_three_point.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/memory.h"
#include "base/units.h"
#include "cli/command.h"
#include "cli/datasets.h"
#include "cli/file_kind.h"
#include "cli/finding.h"
#include "cli/settings.h"
#include "cli/validate_three_point.h"

#define WB_LOG_DOMAIN "validate"

struct options {
    struct wb_command_common common;
    struct wb_datasets datasets;
    struct wb_calibrate_settings settings;
    struct wb_three_point_calibrate_settings three_point;
    const struct wb_setting *of[2]; /* the first option of each of the `sources` that was given */
};

static const struct argp_option other_options[] = {
    {"output", 'o', "DIR", 0,
     "Folder for forces, errors and scores of each group (CSV), and a figure of each group of "
     "cantilevers under a tip force (SVG)"},
    {"force", WB_KEY_FORCE, NULL, 0, "Overwrite the files of the output folder"},
    {"no-figure", WB_KEY_NO_FIGURE, NULL, 0, "Draw no figures"},
    {"json", WB_KEY_JSON, NULL, 0, "Print one JSON object"},
    {0},
};

static const struct argp argp = {
    .options = other_options,
    .parser = wb_command_parse_common,
    .args_doc = "PROPERTIES.yaml DATASET...",
    .doc =
        "Predicts tests from calibrated properties and scores each part separately: the first "
        "loading (eqs. 18 and 19, beside a linear elastic prediction), the unloading, the residual "
        "deflection, the energy dissipated in later cycles, and the shapes. Datasets are grouped "
        "by wire, length and loading, those of three-point bending by bench, and each group is "
        "averaged.\v"
        "Errors are relative to F_max, the largest force of the measured average, or, for tests "
        "with a follower force, to the largest deflection. Exit code 3: a prediction is incomplete "
        "because the beam did not converge, or a three-point test cannot be used.",
};

static const struct wb_settings_source sources[] = {
    {.tables = &wb_calibrate_table,
     .n_tables = 1,
     .offset = offsetof(struct options, settings),
     .title = "Settings of tests of cantilevers:"},
    {.tables = wb_three_point_calibrate_tables,
     .n_tables = WB_THREE_POINT_CALIBRATE_TABLES,
     .offset = offsetof(struct options, three_point),
     .title = "Settings of datasets of three-point bending, as of `wirebench calibrate`:"},
};

static void note_option(void *input, const struct wb_setting *row, size_t source)
{
    struct options *const o = input;
    if (!o->of[source])
        o->of[source] = row;
}

/* Options for a kind of test that is not among the datasets would be ignored silently. */
static bool has_foreign_option(const struct options *o)
{
    bool has[2] = {false, false};
    for (int i = 0; i < o->datasets.n; i++)
        has[o->datasets.pointers[i]->info.kind == WB_TEST_THREE_POINT] = true;
    for (int k = 0; k < 2; k++) {
        if (!o->of[k] || has[k])
            continue;
        wb_error("--%s applies only to %s: no such dataset was given", o->of[k]->option,
                 k == 0 ? "tests of cantilevers" : "datasets of three-point bending");
        return true;
    }
    return false;
}

/* Of one wire, length and loading, or of one wire on one bench of three-point bending. */
struct group {
    bool is_three_point;
    const struct wb_test_info *info; /* of the result */
    struct wb_validate_result result;
    struct wb_validate_three_point three_point;
};

struct groups {
    int n;
    int *of;             /* (datasets) group of each */
    struct group *items; /* (n) */
};

static enum wb_status run_group(const struct options *o, const struct wb_properties *properties,
                                struct groups *groups, int group)
{
    const struct wb_datasets *const datasets = &o->datasets;
    const struct wb_dataset **const members =
        wb_memory_new((size_t)datasets->n, sizeof(struct wb_dataset *));
    int n = 0;
    for (int i = 0; i < datasets->n; i++) {
        if (groups->of[i] == group)
            members[n++] = datasets->pointers[i];
    }
    struct group *const g = &groups->items[group];
    g->is_three_point = members[0]->info.kind == WB_TEST_THREE_POINT;
    g->info = g->is_three_point ? &g->three_point.info : &g->result.info;
    const enum wb_status status =
        g->is_three_point ? wb_validate_three_point_run(&g->three_point, properties, members, n,
                                                        &o->three_point, NULL)
                          : wb_validate_run(&g->result, properties, members, n, &o->settings, NULL);
    free(members);
    return status;
}

static enum wb_status run_groups(struct options *o, const struct wb_properties *properties,
                                 struct groups *groups)
{
    const size_t n = (size_t)o->datasets.n;
    groups->of = wb_memory_new(n, sizeof *groups->of);
    groups->items = wb_memory_new(n, sizeof *groups->items);
    groups->n = wb_curve_group(o->datasets.pointers, o->datasets.n, groups->of);
    for (int i = 0; i < groups->n; i++)
        WB_TRY(run_group(o, properties, groups, i));
    return WB_OK;
}

/* The name of a group's file: slashes, spaces and control characters of the wire's name replaced.
 */
static void file_name(char *name, size_t size, const struct wb_test_info *info, const char *what)
{
    snprintf(name, size, "%s-L%g%s%s", info->wire, info->length / WB_MM,
             info->kind == WB_TEST_THREE_POINT ? "-three-point"
             : info->is_follower               ? "-follower"
                                               : "",
             what);
    for (char *c = name; *c; c++) {
        if (*c == '/' || *c == ' ' || (unsigned char)*c < 0x20)
            *c = '_';
    }
}

static enum wb_status write_table(const char *folder, const struct group *g, bool unloading)
{
    char name[128], path[WB_PATH];
    file_name(name, sizeof name, g->info, unloading ? "-unloading.csv" : ".csv");
    WB_TRY(wb_file_join(path, folder, name));
    if (g->is_three_point)
        return wb_validate_three_point_write_csv(&g->three_point, unloading, path);
    return unloading ? wb_validate_write_unloading(&g->result, path)
                     : wb_validate_write_csv(&g->result, path);
}

static enum wb_status write_tables(const struct options *o, const struct groups *groups)
{
    const char *const folder = o->common.output;
    struct wb_text scores = {0};
    char path[WB_PATH];
    WB_TRY(wb_file_prepare_output(folder, o->common.force));
    for (int i = 0; i < groups->n; i++) {
        const struct group *const g = &groups->items[i];
        WB_TRY(write_table(folder, g, false));
        if ((g->is_three_point ? g->three_point.unloading.n : g->result.cycles.n) > 0)
            WB_TRY(write_table(folder, g, true));
    }
    WB_TRY(wb_file_join(path, folder, "scores.csv"));
    wb_validate_tables_put_heading(&scores);
    for (int i = 0; i < groups->n; i++) {
        const struct group *const g = &groups->items[i];
        if (g->is_three_point)
            wb_validate_three_point_put_scores(&scores, &g->three_point);
        else
            wb_validate_put_scores(&scores, &g->result);
    }
    const enum wb_status status = wb_file_write_text(path, &scores);
    wb_text_release(&scores);
    return status;
}

/* A prediction of a cantilever under a tip force has a figure. */
static bool has_figure(const struct group *g)
{
    return !g->is_three_point && !g->result.info.is_follower && g->result.curve.max_force > 0.0;
}

static enum wb_status draw(const struct options *o, const struct group *g, char path[WB_PATH])
{
    const struct wb_test_info *const info = &g->result.info;
    char name[128];
    struct wb_text footer = {0};
    struct wb_figure *figure;
    file_name(name, sizeof name, info, ".svg");
    WB_TRY(wb_file_join(path, o->common.output, name));
    WB_TRY(wb_figure_create(&figure, "prediction", 480.0, 200.0));
    wb_figures_compared_prediction(figure, &g->result, wb_palette_wire(0));
    wb_text_append_escaped(&footer, info->wire);
    wb_text_append(&footer, " (%s), L = %g mm, mean of %d specimen%s", wb_finding_source(info),
                   info->length / WB_MM, g->result.curve.n_samples,
                   g->result.curve.n_samples == 1 ? "" : "s");
    wb_figure_set_footer(figure, wb_text_string(&footer));
    const enum wb_status status = wb_figure_write_svg(figure, path);
    wb_text_release(&footer);
    wb_figure_destroy(figure);
    return status;
}

/* Draws a figure of each group; `path` receives that of the first, or "". */
static enum wb_status draw_groups(const struct options *o, const struct groups *groups,
                                  char path[WB_PATH])
{
    char other[WB_PATH];
    path[0] = '\0';
    for (int i = 0; i < groups->n; i++) {
        if (has_figure(&groups->items[i]))
            WB_TRY(draw(o, &groups->items[i], path[0] ? other : path));
    }
    return WB_OK;
}

static void set_prediction(struct wb_json *object, const struct wb_prediction *prediction)
{
    wb_json_set_number(object, "rms", prediction->rms);
    wb_json_set_number(object, "max_error", prediction->max_error);
    wb_json_set_number(object, "rms_from_5mm", prediction->rms_from_5mm);
    wb_json_set_boolean(object, "converged", prediction->n_reached == prediction->n);
}

static void print_json(const struct options *o, const struct wb_properties *properties,
                       const struct groups *groups)
{
    struct wb_json *const root = wb_json_create();
    wb_json_set_text(root, "properties", o->common.input);
    wb_json_set_text(root, "wire", properties->wire);
    struct wb_json *const array = wb_json_set_array(root, "groups");
    for (int i = 0; i < groups->n; i++) {
        const struct wb_validate_result *const r = &groups->items[i].result;
        struct wb_json *const item = wb_json_append_object(array);
        if (groups->items[i].is_three_point) {
            wb_validate_three_point_put_json(item, &groups->items[i].three_point);
            continue;
        }
        wb_json_set_text(item, "wire", r->info.wire);
        wb_json_set_number(item, "length_mm", r->info.length / WB_MM);
        wb_json_set_integer(item, "samples", r->curve.n_samples);
        wb_json_set_boolean(item, "virtual_rig", r->info.is_virtual);
        wb_json_set_boolean(item, "simulation", r->info.is_simulation);
        wb_json_set_text(item, "loading", r->info.is_follower ? "follower" : "tip");
        wb_json_set_number(item, "max_force_N", r->curve.max_force);
        wb_json_set_number(item, "max_deflection_mm", r->curve.max_deflection / WB_MM);
        set_prediction(wb_json_set_object(item, "elastoplastic"), &r->elastoplastic);
        set_prediction(wb_json_set_object(item, "elastic"), &r->elastic);
        wb_json_set_number(item, "shape_rms_mm", r->shape_rms / WB_MM);
        wb_json_set_number(item, "shape_max_mm", r->shape_max / WB_MM);
        wb_json_set_integer(item, "shape_points", r->n_shape_points);
        wb_json_set_number(item, "scatter_rms", r->scatter_rms);
        wb_json_set_number(item, "residual_scatter_rms", r->residual_scatter_rms);
        wb_json_set_number(item, "stiffness_deviation", r->stiffness_deviation);
        wb_json_set_integer(item, "stiffness_degrees_of_freedom", r->stiffness_degrees);
        wb_json_set_number(item, "expected_rms", r->expected_rms);
        wb_json_set_number(item, "expected_rms_95", r->expected_rms_95);
        wb_json_set_number(item, "scatter_share", r->scatter_share);
        wb_validate_json_put_cycles(item, r);
        wb_json_set_number(item, "cpu_s", r->cpu_s);
    }
    wb_command_print_json(root);
}

static void print_cycles(const struct wb_validate_result *r)
{
    const struct wb_validate_cycles *const cycles = &r->cycles;
    if (cycles->n_samples == 0) {
        if (!r->info.is_follower)
            printf("  unloading      not scored: %s\n",
                   cycles->why.text[0] ? cycles->why.text : "no unloading was measured");
        return;
    }
    printf("  unloading      RMS %.3g, largest error %.3g%s\n", cycles->rms, cycles->largest_error,
           r->is_rule_untested ? "; the hardening rule of these properties is not tested" : "");
    const double measured = cycles->residual_measured, predicted = cycles->residual_computed;
    if (isfinite(measured))
        printf("  residual deflection %.2f mm measured, %.2f mm predicted (%+.2f mm)\n",
               measured / WB_MM, predicted / WB_MM, (predicted - measured) / WB_MM);
    for (int i = 0; i < cycles->n_loops; i++) {
        const struct wb_validate_loop *const loop = &cycles->loops[i];
        printf("  cycle %-2d       dissipates %.3g mJ measured, %.3g mJ predicted (%+.1f %%)\n",
               loop->cycle, loop->measured / WB_MJ, loop->computed / WB_MJ,
               100.0 * (loop->computed / loop->measured - 1.0));
    }
}

/* For unloading and residual deflection the law is scaled to the stiffness of each specimen. */
static void print_bound(const struct wb_validate_result *r, enum wb_validate_part part)
{
    static const char *const what[WB_VALIDATE_PARTS] = {
        [WB_VALIDATE_LOADING] = "RMS",
        [WB_VALIDATE_UNLOADING] = "RMS, law scaled to the loading of each specimen",
        [WB_VALIDATE_RESIDUAL] = "mm error, law scaled to the loading of each specimen",
        [WB_VALIDATE_SHAPES] = "mm, RMS of the mean over the specimens",
    };
    const struct wb_validate_bound *const bound = &r->bounds[part];
    const double unit = wb_validate_part_unit(part);
    if (isfinite(bound->bound) && isfinite(bound->found))
        printf("    %-19s found %-8.3g bound %-8.3g %s%s\n", wb_validate_part_name(part),
               bound->found / unit, bound->bound / unit, what[part],
               bound->is_exceeded ? ": exceeded" : "");
}

static void print_scatter(const struct wb_validate_result *r)
{
    if (r->curve.n_samples > 1)
        printf("  scatter        between specimens %.3g, corrected for their natural shapes %.3g\n",
               r->scatter_rms, r->residual_scatter_rms);
    if (!wb_validate_bounds_known(r))
        return;
    if (isfinite(r->stiffness_deviation))
        printf("  bounds         for specimens whose stiffness scatters by %.1f %%; a correct law "
               "exceeds one of them in one of twenty validations\n",
               100.0 * r->stiffness_deviation);
    else
        printf("  bounds         a correct law exceeds one of them in one of twenty validations\n");
    for (int i = 0; i < WB_VALIDATE_PARTS; i++)
        print_bound(r, i);
}

static void print_group(const struct wb_validate_result *r)
{
    printf("wire %s, L = %g mm, %d specimen%s%s%s\n", r->info.wire, r->info.length / WB_MM,
           r->curve.n_samples, r->curve.n_samples == 1 ? "" : "s",
           r->info.is_virtual      ? ", virtual rig"
           : r->info.is_simulation ? ", simulation"
                                   : "",
           r->info.is_follower ? ", follower force" : "");
    printf("  loading        RMS %.3g, largest error %.3g ", r->elastoplastic.rms,
           r->elastoplastic.max_error);
    if (r->info.is_follower)
        printf("(of the deflection, over the largest measured, %.4g mm)\n",
               r->curve.max_deflection / WB_MM);
    else
        printf("(over F_max = %.4g N of the measured average)\n", r->curve.max_force);
    printf("    if elastic   RMS %.3g, largest error %.3g\n", r->elastic.rms, r->elastic.max_error);
    print_cycles(r);
    if (r->n_shape_points > 0)
        printf("  shapes         RMS %.2f mm, largest %.2f mm, %d markers\n", r->shape_rms / WB_MM,
               r->shape_max / WB_MM, r->n_shape_points);
    print_scatter(r);
    if (r->is_beyond)
        printf("  beyond         curvature at the clamp %.3g /m: above the range of these "
               "properties\n",
               r->cycles.clamp_curvature);
}

static void append_found_three_point(struct wb_text *text, const struct wb_validate_three_point *r)
{
    wb_text_append(text,
                   "%s in three-point bending, span %g mm (%s, %d test%s): RMS error of the "
                   "loading %.2g %%",
                   r->info.wire, r->info.length / WB_MM, wb_finding_source(&r->info), r->n_used,
                   r->n_used == 1 ? "" : "s", r->loading.rms / WB_PERCENT);
    if (r->n_unloading > 0)
        wb_text_append(text, ", of the unloading %.2g %%", r->unloading.rms / WB_PERCENT);
    wb_text_append(text, " of F_max");
    if (isfinite(r->residual_measured))
        wb_text_append(text, "; residual deflection %.3f mm measured, %.3f mm predicted",
                       r->residual_measured / WB_MM, r->residual_computed / WB_MM);
}

static void append_found(struct wb_text *text, const struct wb_validate_result *r)
{
    wb_text_append(text, "%s at L = %g mm (%s, %d specimen%s): RMS error of the loading %.2g %%",
                   r->info.wire, r->info.length / WB_MM, wb_finding_source(&r->info),
                   r->curve.n_samples, r->curve.n_samples == 1 ? "" : "s",
                   r->elastoplastic.rms / WB_PERCENT);
    if (r->cycles.n_samples > 0)
        wb_text_append(text, ", of the unloading %.2g %%", r->cycles.rms / WB_PERCENT);
    wb_text_append(text, " of %s", r->info.is_follower ? "the largest deflection" : "F_max");
    if (r->cycles.n_samples > 0 && isfinite(r->cycles.residual_measured))
        wb_text_append(text, "; residual deflection %.1f mm measured, %.1f mm predicted",
                       r->cycles.residual_measured / WB_MM, r->cycles.residual_computed / WB_MM);
}

/* Whether the calibration used this dataset. */
static bool is_calibrated_on(const struct wb_properties *properties, const char *folder)
{
    char path[WB_PATH], sha256[WB_SHA256_TEXT];
    if (wb_file_join(path, folder, "force_deflection.csv") != WB_OK || !wb_file_exists(path) ||
        wb_hash_file(path, sha256) != WB_OK)
        return false;
    for (int i = 0; i < properties->n_datasets && i < WB_PROPERTIES_MOST_DATASETS; i++) {
        if (strcmp(properties->datasets[i].sha256, sha256) == 0)
            return true;
    }
    return false;
}

static enum wb_validate_verdict verdict_of(const struct group *g)
{
    return g->is_three_point ? wb_validate_three_point_verdict(&g->three_point)
                             : wb_validate_bounds_verdict(&g->result);
}

static void append_verdict(struct wb_text *text, const struct group *g)
{
    static const char *const verdicts[] = {
        [WB_VALIDATE_PREDICTED] = "yes: within the scatter of specimens",
        [WB_VALIDATE_NOT_PREDICTED] = "no: wrong law or another wire (by chance in 1 of 20): ",
        [WB_VALIDATE_UNDECIDED] = "undecided: the scatter between specimens is unknown",
        [WB_VALIDATE_BEYOND] = "with care: bent beyond the range of the properties",
        [WB_VALIDATE_NOT_CONVERGED] = "no: the beam did not converge up to the largest deflection",
    };
    const enum wb_validate_verdict verdict = verdict_of(g);
    wb_text_append(text, "%s", verdicts[verdict]);
    if (verdict == WB_VALIDATE_NOT_PREDICTED && g->is_three_point)
        wb_text_append(text, "loading %.2g %%, bound %.2g %%",
                       g->three_point.loading.rms / WB_PERCENT,
                       g->three_point.expected.rms_95 / WB_PERCENT);
    else if (verdict == WB_VALIDATE_NOT_PREDICTED)
        wb_validate_bounds_append(text, &g->result);
}

/* For the worst verdict of the groups. */
static const char *next_of(enum wb_validate_verdict worst)
{
    static const char *const next[] = {
        [WB_VALIDATE_NOT_PREDICTED] = "compare length, zeros and batch of these specimens with "
                                      "those of the calibration; then calibrate on both",
        [WB_VALIDATE_UNDECIDED] = "calibrate on at least three specimens, to measure the scatter",
        [WB_VALIDATE_BEYOND] = "calibrate on tests that are bent as far as these",
        [WB_VALIDATE_NOT_CONVERGED] = "refine the beam (--elements), or validate with a shorter "
                                      "travel (--largest-deflection-mm)",
    };
    return next[worst];
}

static void print_finding(const struct options *o, const struct wb_properties *properties,
                          const struct groups *groups, const char *figure)
{
    struct wb_finding finding = {.figure = figure};
    const int n_all = o->common.n - 1;
    int n_same = 0;
    enum wb_validate_verdict worst = WB_VALIDATE_PREDICTED;
    for (int i = 1; i <= n_all; i++)
        n_same += is_calibrated_on(properties, o->common.inputs[i]);
    for (int i = 0; i < groups->n; i++) {
        const struct group *const g = &groups->items[i];
        const enum wb_validate_verdict verdict = verdict_of(g);
        if (i > 0)
            wb_text_append(&finding.found, "; ");
        if (g->is_three_point)
            append_found_three_point(&finding.found, &g->three_point);
        else
            append_found(&finding.found, &g->result);
        worst = verdict > worst || worst == WB_VALIDATE_PREDICTED ? verdict : worst;
        if (n_same == n_all)
            continue;
        if (i > 0)
            wb_text_append(&finding.trust, "; ");
        if (groups->n > 1)
            wb_text_append(&finding.trust, "%s = %g mm: ", g->is_three_point ? "span" : "L",
                           g->info->length / WB_MM);
        append_verdict(&finding.trust, g);
    }
    if (n_same == n_all)
        wb_text_append(&finding.trust, "no: the calibration used these tests, so they do not test "
                                       "the law");
    else if (n_same > 0)
        wb_text_append(&finding.trust,
                       "; %d of these %d tests were used by the calibration and do not count",
                       n_same, n_all);
    if (n_same == n_all)
        wb_text_append(&finding.next, "validate with specimens of another length or span");
    else if (worst != WB_VALIDATE_PREDICTED)
        wb_text_append(&finding.next, "%s", next_of(worst));
    else
        wb_finding_append_command(&finding.next,
                                  "wirebench export %s --to table -o CARD.json, for other programs",
                                  o->common.input);
    wb_finding_print(&finding);
}

static int deliver(const struct options *o, const struct wb_properties *properties,
                   const struct groups *groups)
{
    bool complete = true;
    char figure[WB_PATH] = "";
    if (o->common.output) {
        enum wb_status status = write_tables(o, groups);
        if (status == WB_OK && !o->common.no_figure)
            status = draw_groups(o, groups, figure);
        if (status != WB_OK)
            return wb_command_exit(status);
    }
    if (o->common.json)
        print_json(o, properties, groups);
    for (int i = 0; i < groups->n; i++) {
        const struct group *const g = &groups->items[i];
        const struct wb_prediction *const prediction = &g->result.elastoplastic;
        if (!o->common.json && g->is_three_point)
            wb_validate_three_point_print(&g->three_point);
        else if (!o->common.json)
            print_group(&g->result);
        complete = complete && (g->is_three_point ? g->three_point.n_used == g->three_point.n_tests
                                                  : prediction->n_reached == prediction->n);
    }
    if (!o->common.json)
        print_finding(o, properties, groups, figure);
    return complete ? WB_EXIT_OK : WB_EXIT_INCOMPLETE;
}

static int run(struct options *o, struct groups *groups)
{
    struct wb_properties properties;
    if (wb_file_kind_check(o->common.input, WB_FILE_BIT(WB_FILE_PROPERTIES)) != WB_OK ||
        wb_properties_read(o->common.input, &properties) != WB_OK ||
        wb_datasets_read(&o->datasets, o->common.inputs + 1, o->common.n - 1,
                         WB_TEST_BIT(WB_TEST_CANTILEVER) | WB_TEST_BIT(WB_TEST_THREE_POINT)) !=
            WB_OK)
        return WB_EXIT_FAILED;
    if (has_foreign_option(o))
        return WB_EXIT_USAGE;
    if (run_groups(o, &properties, groups) != WB_OK)
        return WB_EXIT_FAILED;
    return deliver(o, &properties, groups);
}

int wb_cmd_validate(int argc, char **argv)
{
    static const struct wb_settings_command command = {
        .argp = &argp,
        .sources = sources,
        .n_sources = WB_COUNT(sources),
        .place = WB_CALIBRATE_VALIDATE,
        .note = note_option,
    };
    struct options options = {
        .common = {.noun = "the properties and at least one dataset", .least = 2}};
    struct groups groups = {0};
    wb_calibrate_default_settings(&options.settings);
    wb_setting_fill(&wb_three_point_calibrate_tables[0], &options.three_point.data);
    wb_setting_fill(&wb_three_point_calibrate_tables[1], &options.three_point.fit);
    wb_settings_parse(&command, argc, argv, &options);
    const int code = run(&options, &groups);
    for (int i = 0; i < groups.n; i++) {
        wb_validate_result_release(&groups.items[i].result);
        wb_validate_three_point_release(&groups.items[i].three_point);
    }
    free(groups.items);
    free(groups.of);
    wb_datasets_release(&options.datasets);
    return code;
}
