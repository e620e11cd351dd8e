/* wirebench calibrate: datasets to properties. */
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "analysis/calibration/paper/calibrate.h"
#include "analysis/calibration/properties/method.h"
#include "analysis/calibration/properties/properties.h"
#include "base/file.h"
#include "base/interrupt.h"
#include "base/progress.h"
#include "base/units.h"
#include "cli/calibrate.h"
#include "cli/calibrate_cycle.h"
#include "cli/calibrate_three_point.h"
#include "cli/command.h"
#include "cli/complete.h"
#include "cli/datasets.h"
#include "cli/finding.h"
#include "cli/print.h"
#include "cli/settings.h"

#define WB_LOG_DOMAIN "calibrate"

struct options {
    struct wb_command_common common;
    struct wb_datasets datasets;
    enum wb_method method;
    bool names_method;                       /* --method was given */
    const struct wb_setting *of[WB_METHODS]; /* the first option of each method that was given */
    struct wb_calibrate_settings settings;   /* of the paper's method */
    struct wb_calibrate_cycle cycle;
    struct wb_three_point_calibrate_settings three_point;
};

enum {
    KEY_METHOD = WB_KEY_OWN,
    /* Only for --help: cli/calibrate_tensile.c and its siblings parse them. */
    KEY_TENSILE,
    KEY_CONSTITUENTS,
    KEY_COMPLIANCE
};

static const struct argp_option other_options[] = {
    {"method", KEY_METHOD, "METHOD", 0,
     "cycle: a law and its hardening rule, fitted to loading and unloading; paper: E, sigma_Y, K "
     "and n, fitted to the averaged loading (cycle; tests with a follower force: paper)"},
    {"tensile", KEY_TENSILE, NULL, 0,
     "Tensile tests of a conductor, jacket or tape; see `wirebench calibrate --tensile --help`"},
    {"constituents", KEY_CONSTITUENTS, NULL, 0,
     "A wire's rigidity and moments from conductor and jacket; see `wirebench calibrate "
     "--constituents --help`"},
    {"compliance", KEY_COMPLIANCE, NULL, 0,
     "The compliance of a testing machine, from tests of a stiff bar; see `wirebench calibrate "
     "--compliance --help`"},
    {"output", 'o', "PROPERTIES.yaml", 0,
     "Write the properties to this file and, for whole cycles, a figure of measured and computed "
     "tension to PROPERTIES.svg"},
    {"force", WB_KEY_FORCE, NULL, 0, "Overwrite the properties and the figure"},
    {"no-figure", WB_KEY_NO_FIGURE, NULL, 0, "For whole cycles: draw no figure"},
    {"json", WB_KEY_JSON, NULL, 0, "Print one JSON object"},
    {0},
};

static const struct wb_settings_source sources[] = {
    [WB_METHOD_CYCLE] = {.tables = wb_cycle_calibrate_tables,
                         .n_tables = WB_CYCLE_CALIBRATE_TABLES,
                         .offset = offsetof(struct options, cycle.settings),
                         .title = "Settings of --method cycle:"},
    [WB_METHOD_PAPER] = {.tables = &wb_calibrate_table,
                         .n_tables = 1,
                         .offset = offsetof(struct options, settings),
                         .title = "Settings of --method paper:"},
    [WB_METHOD_THREE_POINT] = {.tables = wb_three_point_calibrate_tables,
                               .n_tables = WB_THREE_POINT_CALIBRATE_TABLES,
                               .offset = offsetof(struct options, three_point),
                               .title = "Settings of datasets of three-point bending:"},
};

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct options *const o = state->input;
    if (key != KEY_METHOD)
        return wb_command_parse_common(key, argument, state);
    for (int m = 0; m < WB_METHOD_THREE_POINT; m++) {
        if (strcmp(argument, wb_method_name(m)) == 0) {
            o->method = m;
            o->names_method = true;
            return 0;
        }
    }
    argp_error(state, "--method: expected cycle or paper, not '%s'", argument);
    return 0;
}

static void note_option(void *input, const struct wb_setting *row, size_t method)
{
    struct options *const o = input;
    /* --threads applies to all methods; the paper's uses one. */
    if (strcmp(row->option, "threads") != 0 && !o->of[method])
        o->of[method] = row;
}

static const struct argp argp = {
    .options = other_options,
    .parser = parse,
    .args_doc = "DATASET...",
    .doc = "Calibrates a bending law from the datasets of one wire: flexural rigidity, moments, "
           "residual curvature ratio and hardening rule, from the first loading and unloading of "
           "each specimen. With --method paper: E by eq. 10, the yield stress by eq. 11, K and n "
           "by Nelder-Mead on the averaged first loading, with the beam under the load of the "
           "test.\vMisfits and errors are relative to F_max, the largest force, or, for tests with "
           "a follower force, to the largest deflection. Exit code 3: no law fits loading and "
           "unloading, a quantity is less certain than --at-most requires, a search did not "
           "converge, or Ctrl-C stopped it; the properties are written.",
};

static bool report_beam_runs(void *context, int evaluation, double error, double size)
{
    char note[64];
    snprintf(note, sizeof note, "error %.2e, simplex %.1e", error, size);
    wb_progress_update(context, evaluation, note);
    return !wb_interrupted();
}

static void set_deviations(struct wb_json *root, const struct wb_calibrate_result *r)
{
    const char *remarks[WB_CALIBRATE_MOST_REMARKS];
    struct wb_json *const object = wb_json_set_object(root, "deviations");
    wb_json_set_number(object, "youngs_modulus_MPa", r->deviation[0] / WB_MPA);
    wb_json_set_number(object, "yield_stress_MPa", r->deviation[1] / WB_MPA);
    wb_json_set_number(object, "strength_coefficient_factor", exp(r->deviation[2]));
    wb_json_set_number(object, "hardening_exponent", r->deviation[3]);
    struct wb_json *const list = wb_json_set_array(root, "remarks");
    const int n = wb_calibrate_remarks(r, remarks);
    for (int i = 0; i < n; i++)
        wb_json_append_text(list, remarks[i]);
}

static void set_path(struct wb_json *root, const struct wb_calibrate_result *result)
{
    struct wb_json *const path = wb_json_set_array(root, "path");
    for (int i = 0; i < result->n_path; i++) {
        const struct wb_calibrate_step *const step = &result->path[i];
        struct wb_json *const item = wb_json_append_object(path);
        wb_json_set_number(item, "strength_coefficient_MPa", step->strength_coefficient / WB_MPA);
        wb_json_set_number(item, "hardening_exponent", step->hardening_exponent);
        wb_json_set_number(item, "error", step->error);
        wb_json_set_number(item, "size", step->size);
    }
}

static void print_json(const struct options *o, const struct wb_calibrate_result *r)
{
    const struct wb_calibrate_settings *const s = &o->settings;
    struct wb_json *const root = wb_json_create();
    wb_json_set_text(root, "wire", r->info.wire);
    wb_json_set_number(root, "length_mm", r->info.length / WB_MM);
    wb_json_set_integer(root, "samples", r->n_samples);
    wb_json_set_boolean(root, "virtual_rig", r->info.is_virtual);
    wb_json_set_boolean(root, "simulation", r->info.is_simulation);
    wb_json_set_text(root, "loading", r->info.is_follower ? "follower" : "tip");
    wb_json_set_number(root, "elastic_zone", s->elastic_zone);
    wb_json_set_number(root, "yield_point", wb_calibrate_settings_meant(s).yield_point);
    wb_json_set_boolean(root, "straight", s->straight);
    wb_json_set_boolean(root, "bow_corrected", r->bow_corrected);
    wb_json_set_number(root, "bow_spread_mm", r->bow_spread / WB_MM);
    wb_json_set_number(root, "bow_mm", wb_dataset_bow(&r->info) / WB_MM);
    wb_json_set_number(root, "youngs_modulus_MPa", r->material.youngs_modulus / WB_MPA);
    wb_json_set_number(root, "yield_stress_MPa", r->material.yield_stress / WB_MPA);
    wb_json_set_number(root, "strength_coefficient_MPa", r->material.strength_coefficient / WB_MPA);
    wb_json_set_number(root, "hardening_exponent", r->material.hardening_exponent);
    wb_json_set_number(root, "poissons_ratio", r->material.poissons_ratio);
    set_deviations(root, r);
    wb_json_set_number(root, "first_strength_coefficient_MPa",
                       r->first_strength_coefficient / WB_MPA);
    wb_json_set_number(root, "first_hardening_exponent", r->first_hardening_exponent);
    wb_json_set_text(root, "stopped", wb_calibrate_end_text(r->end));
    wb_json_set_boolean(root, "restarted", r->restarted);
    wb_json_set_number(root, "restart_moved", r->restart_moved);
    wb_json_set_integer(root, "evaluations", r->evaluations);
    wb_json_set_integer(root, "evaluations_not_converged", r->failed_evaluations);
    wb_json_set_number(root, "max_force_N", r->max_force);
    wb_json_set_number(root, "max_deflection_mm", r->max_deflection / WB_MM);
    wb_json_set_number(root, "rms", r->rms);
    wb_json_set_number(root, "max_error", r->max_error);
    wb_json_set_number(root, "scatter_rms", r->scatter_rms);
    wb_json_set_number(root, "residual_scatter_rms", r->residual_scatter_rms);
    wb_json_set_number(root, "cpu_s", r->cpu_s);
    set_path(root, r);
    wb_command_print_json(root);
}

static void print_value(const char *name, double value, double deviation, const char *unit)
{
    if (isfinite(deviation)) {
        const int n = wb_print_decimals(deviation, 2);
        printf("%-8s %10.*f +- %-8.*f %s\n", name, n, value, n, deviation, unit);
    } else {
        printf("%-8s %10.*f %s\n", name, wb_print_decimals(value, 5), value, unit);
    }
}

static void print_text(const struct options *o, const struct wb_calibrate_result *r)
{
    const struct wb_calibrate_settings *const s = &o->settings;
    printf("wire %s, L = %g mm, %d specimen%s%s%s\n", r->info.wire, r->info.length / WB_MM,
           r->n_samples, r->n_samples == 1 ? "" : "s",
           r->info.is_virtual      ? ", virtual rig"
           : r->info.is_simulation ? ", simulation"
                                   : "",
           r->info.is_follower ? ", follower force" : "");
    printf("elastic zone %g L, yield point %g L, ", s->elastic_zone,
           wb_calibrate_settings_meant(s).yield_point);
    if (s->straight)
        printf("natural shape ignored\n");
    else
        printf("mean bow %.2f mm, between specimens %.2f mm%s\n", wb_dataset_bow(&r->info) / WB_MM,
               r->bow_spread / WB_MM,
               r->bow_corrected ? "; E and sigma_Y corrected for the bows" : "");
    print_value("E", r->material.youngs_modulus / WB_MPA, r->deviation[0] / WB_MPA, "MPa");
    print_value("sigma_Y", r->material.yield_stress / WB_MPA, r->deviation[1] / WB_MPA, "MPa");
    const double strength = r->material.strength_coefficient / WB_MPA;
    printf("%-8s %10.*f", "K", wb_print_decimals(strength, 5), strength);
    if (isfinite(r->deviation[2]))
        printf(" */ %-8.3g", exp(r->deviation[2]));
    printf(" MPa\n");
    print_value("n", r->material.hardening_exponent, r->deviation[3], "");
    const char *remarks[WB_CALIBRATE_MOST_REMARKS];
    const int n_remarks = wb_calibrate_remarks(r, remarks);
    for (int i = 0; i < n_remarks; i++)
        printf("note: %s\n", remarks[i]);
    printf("initial guess K0 = %.5g MPa, n0 = %.4g; %d beam runs, %d not converged; end: %s\n",
           r->first_strength_coefficient / WB_MPA, r->first_hardening_exponent, r->evaluations,
           r->failed_evaluations, wb_calibrate_end_text(r->end));
    if (r->restarted && r->restart_moved == 0.0)
        printf("the restart from the optimum found the same optimum\n");
    else if (r->restarted)
        printf("the restart moved the optimum by %.2g\n", r->restart_moved);
    printf("RMS %.3g, largest error %.3g ", r->rms, r->max_error);
    if (r->info.is_follower)
        printf("(of the deflection, over the largest measured, %.4g mm)\n",
               r->max_deflection / WB_MM);
    else
        printf("(over F_max = %.4g N of the measured average)\n", r->max_force);
    if (r->n_samples == 1)
        printf("one specimen: no uncertainty\n");
    else
        printf("scatter between specimens %.3g, of which %.3g is not due to their natural shapes\n",
               r->scatter_rms, r->residual_scatter_rms);
}

static void append_number(struct wb_text *text, const char *name, double value, double deviation,
                          const char *unit)
{
    char a[WB_PRINT_NUMBER];
    wb_text_append(text, "%s %s", name, wb_print_number(value, a));
    if (isfinite(deviation))
        wb_text_append(text, " +- %.*f", wb_print_decimals(deviation, 2), deviation);
    wb_text_append(text, "%s%s", unit[0] ? " " : "", unit);
}

static void print_paper_finding(const struct options *o, const struct wb_calibrate_result *r)
{
    struct wb_finding finding = {.figure = NULL};
    const char *remarks[WB_CALIBRATE_MOST_REMARKS];
    const int n_remarks = wb_calibrate_remarks(r, remarks);
    const bool is_complete = wb_calibrate_is_complete(r->end);
    char strength[WB_PRINT_NUMBER];
    wb_text_append(&finding.found, "%s (%s, %d specimen%s): ", r->info.wire,
                   wb_finding_source(&r->info), r->n_samples, r->n_samples == 1 ? "" : "s");
    append_number(&finding.found, "E", r->material.youngs_modulus / WB_MPA,
                  r->deviation[0] / WB_MPA, "MPa");
    append_number(&finding.found, "; sigma_Y", r->material.yield_stress / WB_MPA,
                  r->deviation[1] / WB_MPA, "MPa");
    wb_text_append(&finding.found, "; K %s MPa; ",
                   wb_print_number(r->material.strength_coefficient / WB_MPA, strength));
    append_number(&finding.found, "n", r->material.hardening_exponent, r->deviation[3], "");
    if (!is_complete)
        wb_text_append(&finding.trust, "no: %s", wb_calibrate_end_text(r->end));
    else if (n_remarks > 0)
        wb_text_append(&finding.trust, "in part: read the %d note%s above", n_remarks,
                       n_remarks == 1 ? "" : "s");
    else
        wb_text_append(&finding.trust,
                       "for loading only: fits it within %.2g %% of %s (RMS); this method does not "
                       "use the unloading",
                       r->rms / WB_PERCENT,
                       r->info.is_follower ? "the largest deflection" : "F_max");
    if (is_complete && r->n_samples == 1)
        wb_text_append(&finding.trust, "; one specimen cannot show how specimens differ");
    if (is_complete)
        wb_finding_append_validate(&finding.next, o->common.output, r->info.wire, "length");
    else
        wb_text_append(&finding.next,
                       "run the same command again and let it finish; where the iterations ran "
                       "out, with a larger --max-iterations");
    wb_finding_print(&finding);
}

static int deliver_paper(const struct options *o, const struct wb_calibrate_result *result)
{
    if (o->common.output) {
        const enum wb_status status = wb_properties_write(
            o->common.output, result, &o->settings, o->common.inputs, o->common.n, o->common.force);
        if (status != WB_OK)
            return wb_command_exit(status);
    }
    if (o->common.json) {
        print_json(o, result);
    } else {
        print_text(o, result);
        print_paper_finding(o, result);
    }
    const bool complete = wb_calibrate_is_complete(result->end);
    if (!complete)
        wb_warn("%s: the properties are the best that were found until then",
                wb_calibrate_end_text(result->end));
    return complete ? WB_EXIT_OK : WB_EXIT_INCOMPLETE;
}

static int run_paper(struct options *o)
{
    struct wb_calibrate_result result = {0};
    struct wb_progress progress;
    o->settings.progress = report_beam_runs;
    o->settings.progress_context = &progress;
    wb_progress_start(&progress, "calibrate", "beam runs", 0.0);
    const enum wb_status status =
        wb_calibrate_run(&result, o->datasets.pointers, o->datasets.n, &o->settings, NULL);
    wb_progress_finish(&progress);
    const int code = status == WB_OK ? deliver_paper(o, &result) : wb_command_exit(status);
    wb_calibrate_result_release(&result);
    return code;
}

/* --- whole cycles --- */

/* Only beside a YAML file: /dev/stdout has no place beside it, and an output that ends in .svg
 * would be overwritten by its figure. */
static bool has_figure(const struct options *o)
{
    return o->common.output && !o->common.no_figure &&
           (wb_command_ends_in(o->common.output, ".yaml") ||
            wb_command_ends_in(o->common.output, ".yml"));
}

static void warn_cycle(const struct options *o)
{
    const struct wb_cycle_calibration *const c = &o->cycle.calibration;
    const struct wb_cycle_verdict *const v = &o->cycle.verdict;
    const char *const wire = c->members[0].data.info.wire;
    if (v->has[WB_CYCLE_NO_LAW_FITS])
        wb_warn("wire '%s': no law fits loading and unloading within %g %% of F_max", wire,
                WB_CYCLE_LARGEST_FOLLOWED / WB_PERCENT);
    if (v->has[WB_CYCLE_UNCERTAIN] && isfinite(v->known))
        wb_warn("wire '%s': the expanded uncertainty (95 %%) of %s is %.3g %%, expected at most "
                "%g %% (--at-most): the budget shows the largest contributions",
                wire, v->worst, v->known / WB_PERCENT, v->at_most / WB_PERCENT);
    else if (v->has[WB_CYCLE_UNCERTAIN])
        wb_warn("wire '%s': %s is unknown, so that --at-most %g cannot be met: calibrate several "
                "specimens",
                wire, v->worst, v->at_most / WB_PERCENT);
    if (v->has[WB_CYCLE_NOT_CONVERGED])
        wb_warn("wire '%s': the fit of a specimen did not converge within %d iterations "
                "(--fit-iterations)",
                wire, o->cycle.settings.fit.max_iterations);
    if (v->has[WB_CYCLE_STOPPED])
        wb_warn("stopped: %d of %d specimens are fitted, not with all laws; the properties are "
                "preliminary and the hardening rule is undecided",
                c->n_members, o->common.n);
}

static int deliver_cycle(const struct options *o)
{
    const struct wb_cycle_calibration *const c = &o->cycle.calibration;
    const char *figure = NULL;
    char path[WB_PATH];
    if (o->common.output) {
        enum wb_status status =
            wb_properties_write_cycle(o->common.output, c, &o->cycle.settings, o->common.inputs,
                                      c->n_members, o->common.force);
        if (status == WB_OK && has_figure(o)) {
            figure = wb_finding_figure_path(path, o->common.output);
            status = wb_calibrate_cycle_draw(&o->cycle, figure);
        }
        if (status != WB_OK)
            return wb_command_exit(status);
    }
    if (o->common.json)
        wb_calibrate_cycle_print_json(&o->cycle);
    else
        wb_calibrate_cycle_print(&o->cycle, o->common.output, figure);
    warn_cycle(o);
    return wb_cycle_verdict_is_complete(&o->cycle.verdict) ? WB_EXIT_OK : WB_EXIT_INCOMPLETE;
}

static int run_cycle(struct options *o)
{
    struct wb_cycle_calibrate_settings *const settings = &o->cycle.settings;
    struct wb_cycle_calibration *const calibration = &o->cycle.calibration;
    struct wb_progress progress;
    int code = WB_EXIT_FAILED;
    settings->progress = wb_calibrate_report;
    settings->progress_context = &progress;
    wb_progress_start(&progress, "calibrate", "fits", 2.0 * o->datasets.n);
    const enum wb_status status = wb_cycle_check_calibrate(
        calibration, &o->cycle.remarks, o->datasets.pointers, o->datasets.n, settings, NULL);
    wb_progress_finish(&progress);
    if (status == WB_OK) {
        o->cycle.verdict = wb_cycle_verdict(calibration, &o->cycle.remarks, settings);
        code = deliver_cycle(o);
    }
    wb_cycle_calibrate_release(calibration);
    return code;
}

/* --- the method --- */

static enum wb_status choose_method(struct options *o)
{
    enum wb_method chosen;
    WB_TRY(wb_method_choose(&chosen, o->datasets.pointers, o->common.inputs, o->datasets.n, NULL));
    if (chosen == WB_METHOD_PAPER && !o->names_method)
        wb_info("tests with a follower force: --method paper is used");
    if (chosen == WB_METHOD_THREE_POINT && o->names_method)
        wb_info("three-point bending: --method is ignored, it applies to tests of cantilevers");
    if (chosen == WB_METHOD_THREE_POINT || !o->names_method)
        o->method = chosen;
    return WB_OK;
}

/* Options of another method would be ignored silently. */
static bool has_foreign_option(const struct options *o)
{
    for (int m = 0; m < WB_METHODS; m++) {
        if (!o->of[m] || (enum wb_method)m == o->method)
            continue;
        if (m == WB_METHOD_THREE_POINT)
            wb_error("--%s applies only to datasets of three-point bending", o->of[m]->option);
        else
            wb_error("--%s applies only to --method %s: these datasets are calibrated by %s%s",
                     o->of[m]->option, wb_method_name(m),
                     o->method == WB_METHOD_THREE_POINT ? "" : "--method ",
                     wb_method_name(o->method));
        return true;
    }
    return false;
}

/* A pooled deviation without its degrees of freedom would be ignored silently. */
static bool has_half_a_pool(const struct options *o)
{
    const struct wb_cycle_calibrate_settings *const s = &o->cycle.settings;
    const bool has_half = (s->pooled_deviation > 0.0) != (s->pooled_degrees > 0);
    if (has_half)
        wb_error("--pooled-deviation and --pooled-degrees must be given together");
    return has_half;
}

static enum wb_status begin(struct options *o)
{
    if (o->common.output)
        WB_TRY(wb_command_check_output(o->common.output, o->common.force));
    WB_TRY(wb_datasets_read(&o->datasets, o->common.inputs, o->common.n,
                            WB_TEST_BIT(WB_TEST_CANTILEVER) | WB_TEST_BIT(WB_TEST_THREE_POINT)));
    WB_TRY(choose_method(o));
    char figure[WB_PATH];
    if (o->method != WB_METHOD_CYCLE || !has_figure(o))
        return WB_OK;
    return wb_finding_check_figure(wb_finding_figure_path(figure, o->common.output),
                                   o->common.force);
}

static int run(struct options *o)
{
    const enum wb_status status = begin(o);
    if (status != WB_OK)
        return wb_command_exit(status);
    if (has_foreign_option(o) || has_half_a_pool(o))
        return WB_EXIT_USAGE;
    o->three_point.threads = o->cycle.settings.threads;
    if (o->method == WB_METHOD_THREE_POINT)
        return wb_calibrate_three_point(&o->three_point, &o->datasets, &o->common);
    return o->method == WB_METHOD_PAPER ? run_paper(o) : run_cycle(o);
}

/* Whether this word stands before "--": it selects a kind of test with options of its own. */
static bool has_argument(int argc, char **argv, const char *wanted)
{
    for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++) {
        if (strcmp(argv[i], wanted) == 0)
            return true;
    }
    return false;
}

int wb_cmd_calibrate(int argc, char **argv)
{
    static const struct wb_settings_command command = {
        .argp = &argp,
        .sources = sources,
        .n_sources = WB_COUNT(sources),
        .place = WB_CALIBRATE_COMMAND,
        .note = note_option,
    };
    struct options options = {.common = {.noun = "at least one dataset", .least = 1}};
    if (has_argument(argc, argv, "--tensile"))
        return wb_calibrate_tensile(argc, argv);
    if (has_argument(argc, argv, "--compliance"))
        return wb_calibrate_compliance(argc, argv);
    if (has_argument(argc, argv, "--constituents"))
        return wb_calibrate_constituents(argc, argv);
    for (int m = 0; m < WB_METHOD_THREE_POINT; m++)
        wb_complete_value("method", wb_method_name(m));
    wb_calibrate_default_settings(&options.settings);
    wb_cycle_calibrate_default_settings(&options.cycle.settings);
    wb_setting_fill(&wb_three_point_calibrate_tables[0], &options.three_point.data);
    wb_setting_fill(&wb_three_point_calibrate_tables[1], &options.three_point.fit);
    wb_settings_parse(&command, argc, argv, &options);
    wb_interrupt_install();
    const int code = run(&options);
    wb_datasets_release(&options.datasets);
    return code;
}
