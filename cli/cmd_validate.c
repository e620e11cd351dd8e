/* wirebench validate: properties against datasets they were not calibrated on. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "analysis/properties.h"
#include "analysis/validate.h"
#include "base/file.h"
#include "base/units.h"
#include "cli/command.h"
#include "cli/datasets.h"
#include "cli/settings.h"

#define WB_LOG_DOMAIN "validate"

struct options {
    struct wb_command_common common;
    struct wb_datasets datasets;
    struct wb_calibrate_settings settings;
};

static const struct argp_option other_options[] = {
    {"output", 'o', "DIR", 0, "Write forces and errors of each group there as CSV", 0},
    {"force", WB_KEY_FORCE, NULL, 0, "Overwrite the output folder's files", 0},
    {"json", WB_KEY_JSON, NULL, 0, "Print one JSON object", 0},
    {0},
};

static const struct argp argp = {
    .options = other_options,
    .parser = wb_command_parse_only_common,
    .args_doc = "PROPERTIES.yaml DATASET...",
    .doc = "Predicts the first loading of tests with calibrated properties and prints the errors "
           "of eqs. 18 and 19, beside those of a linear elastic prediction, and the distance of "
           "shapes. Datasets are grouped by wire, length and loading, and each group is averaged.\v"
           "Errors are over F_max, the largest force of the measured average, or over the largest "
           "deflection of tests with a follower force. Exit code 3: a prediction was cut short "
           "because the beam did not converge.",
};

/* The datasets in groups of one wire, length and loading, with the result of each group. */
struct groups {
    int n;
    int *of;                            /* (datasets) group of each */
    struct wb_validate_result *results; /* (n) */
};

static enum wb_status run_group(const struct options *o, const struct wb_properties *properties,
                                struct groups *groups, int group)
{
    const struct wb_datasets *const datasets = &o->datasets;
    const struct wb_dataset **const members =
        malloc((size_t)datasets->n * sizeof(struct wb_dataset *));
    int n = 0;
    if (!members)
        return wb_fail(WB_ERR_MEMORY, "no memory for %d datasets", datasets->n);
    for (int i = 0; i < datasets->n; i++) {
        if (groups->of[i] == group)
            members[n++] = datasets->pointers[i];
    }
    const enum wb_status status =
        wb_validate_run(&groups->results[group], properties, members, n, &o->settings, NULL);
    free(members);
    return status;
}

static enum wb_status run_groups(struct options *o, const struct wb_properties *properties,
                                 struct groups *groups)
{
    WB_TRY(wb_datasets_read(&o->datasets, o->common.inputs + 1, o->common.n - 1));
    const size_t n = (size_t)o->datasets.n;
    groups->of = calloc(n, sizeof *groups->of);
    groups->results = calloc(n, sizeof *groups->results);
    if (!groups->of || !groups->results)
        return wb_fail(WB_ERR_MEMORY, "no memory for %d datasets", o->datasets.n);
    groups->n = wb_curve_group(o->datasets.pointers, o->datasets.n, groups->of);
    for (int i = 0; i < groups->n; i++)
        WB_TRY(run_group(o, properties, groups, i));
    return WB_OK;
}

/* Name of a group's CSV file: the wire's name with anything unusual in a path replaced. */
static void csv_name(char *name, size_t size, const struct wb_test_info *info)
{
    snprintf(name, size, "%s-L%g%s.csv", info->wire, info->length / WB_MM,
             info->is_follower ? "-follower" : "");
    for (char *c = name; *c; c++) {
        if (*c == '/' || *c == ' ' || (unsigned char)*c < 0x20)
            *c = '_';
    }
}

static enum wb_status write_tables(const struct options *o, const struct groups *groups)
{
    WB_TRY(wb_file_prepare_output(o->common.output, o->common.force));
    for (int i = 0; i < groups->n; i++) {
        char name[128], path[WB_PATH];
        csv_name(name, sizeof name, &groups->results[i].info);
        WB_TRY(wb_file_join(path, o->common.output, name));
        WB_TRY(wb_validate_write_csv(&groups->results[i], path));
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

static int print_json(const struct options *o, const struct wb_properties *properties,
                      const struct groups *groups)
{
    struct wb_json *const root = wb_json_create();
    wb_json_set_text(root, "properties", o->common.input);
    wb_json_set_text(root, "wire", properties->wire);
    struct wb_json *const array = wb_json_set_array(root, "groups");
    for (int i = 0; i < groups->n; i++) {
        const struct wb_validate_result *const r = &groups->results[i];
        struct wb_json *const item = wb_json_append_object(array);
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
        wb_json_set_number(item, "expected_rms_at_most", r->expected_rms);
        wb_json_set_number(item, "scatter_share_at_most", r->scatter_share);
        wb_json_set_number(item, "cpu_s", r->cpu_s);
    }
    return wb_command_print_json(root);
}

static void print_group(const struct wb_validate_result *r)
{
    printf("wire %s, L = %g mm, %d sample%s%s%s\n", r->info.wire, r->info.length / WB_MM,
           r->curve.n_samples, r->curve.n_samples == 1 ? "" : "s",
           r->info.is_virtual      ? ", virtual rig"
           : r->info.is_simulation ? ", simulation"
                                   : "",
           r->info.is_follower ? ", follower force" : "");
    printf("  elastoplastic  RMS %.3g, largest error %.3g ", r->elastoplastic.rms,
           r->elastoplastic.max_error);
    if (r->info.is_follower)
        printf("(of the deflection, over the largest measured, %.4g mm)\n",
               r->curve.max_deflection / WB_MM);
    else
        printf("(over F_max = %.4g N of the measured average)\n", r->curve.max_force);
    printf("  elastic        RMS %.3g, largest error %.3g\n", r->elastic.rms, r->elastic.max_error);
    if (r->n_shape_points > 0)
        printf("  shapes         RMS %.2f mm, largest %.2f mm, %d markers\n", r->shape_rms / WB_MM,
               r->shape_max / WB_MM, r->n_shape_points);
    if (isfinite(r->expected_rms))
        printf("  scatter        between samples %.3g, with each one's own natural shape %.3g\n"
               "                 RMS that the scatter between samples alone lets expect: at most "
               "%.2g; found: %.2g (at most %.0f %% of the mean square error)\n",
               r->scatter_rms, r->residual_scatter_rms, r->expected_rms, r->elastoplastic.rms,
               100.0 * r->scatter_share);
}

static int deliver(const struct options *o, const struct wb_properties *properties,
                   const struct groups *groups)
{
    bool complete = true;
    if (o->common.output) {
        const enum wb_status status = write_tables(o, groups);
        if (status != WB_OK)
            return wb_command_exit(status);
    }
    if (o->common.json) {
        const int code = print_json(o, properties, groups);
        if (code != WB_EXIT_OK)
            return code;
    }
    for (int i = 0; i < groups->n; i++) {
        const struct wb_prediction *const prediction = &groups->results[i].elastoplastic;
        if (!o->common.json)
            print_group(&groups->results[i]);
        complete = complete && prediction->n_reached == prediction->n;
    }
    return complete ? WB_EXIT_OK : WB_EXIT_INCOMPLETE;
}

int wb_cmd_validate(int argc, char **argv)
{
    struct options options = {
        .common = {.noun = "the properties and at least one dataset", .least = 2}};
    struct wb_properties properties;
    struct groups groups = {0};
    wb_calibrate_default_settings(&options.settings);
    wb_settings_parse_table(&argp, &wb_calibrate_table, &options.settings, WB_CALIBRATE_VALIDATE,
                            argc, argv, &options);

    enum wb_status status =
        wb_file_is_folder(options.common.input)
            ? wb_fail(WB_ERR_ARGUMENT,
                      "'%s' is a folder: the properties file comes first, then the datasets",
                      options.common.input)
            : wb_properties_read(options.common.input, &properties);
    if (status == WB_OK)
        status = run_groups(&options, &properties, &groups);
    const int code =
        status == WB_OK ? deliver(&options, &properties, &groups) : wb_command_exit(status);
    for (int i = 0; i < groups.n; i++)
        wb_validate_result_release(&groups.results[i]);
    free(groups.results);
    free(groups.of);
    wb_datasets_release(&options.datasets);
    wb_command_release(&options.common);
    return code;
}
