/* wirebench quicklook: curve and shapes of one recording, or the shape of a harness file. */
#include <stdio.h>
#include <stdlib.h>

#include "analysis/align/align.h"
#include "analysis/harness/harness_quicklook.h"
#include "analysis/quicklook.h"
#include "base/memory.h"
#include "cli/command.h"
#include "cli/datasets.h"
#include "cli/file_kind.h"
#include "cli/finding.h"

#define WB_LOG_DOMAIN "quicklook"

static const struct argp_option option_table[] = {
    {"output", 'o', "DIR", 0, "Folder to write"},
    {"force", WB_KEY_FORCE, NULL, 0, "Overwrite the files of the folder"},
    {"json", WB_KEY_JSON, NULL, 0, "Print one JSON object"},
    {0},
};

static const struct argp argp = {
    .options = option_table,
    .parser = wb_command_parse_common,
    .args_doc = "REC.wbr|HARNESS.yaml",
    .doc = "Aligns one recording (.wbr or .wbr.zst) and writes its force-deflection curve and "
           "shapes as figures (SVG, PNG, PDF) and CSV, with a summary that is also printed. Of a "
           "harness file it draws the stress-free shape; no step is computed.\v"
           "Exit code 3: usable but incomplete (gaps, damaged or lost data, a test that ended "
           "early).",
};

static int deliver(const struct wb_dataset *dataset, const struct wb_command_common *options)
{
    if (wb_quicklook_write(dataset, options->output, options->force) != WB_OK)
        return WB_EXIT_FAILED;
    if (options->json) {
        struct wb_json *const root = wb_json_create();
        wb_datasets_describe(root, dataset, options->output);
        wb_command_print_json(root);
    } else {
        wb_datasets_print(dataset, options->output);
    }
    return wb_dataset_is_complete(dataset) ? WB_EXIT_OK : WB_EXIT_INCOMPLETE;
}

static int look_at_recording(const struct wb_command_common *options)
{
    struct wb_align_settings settings;
    struct wb_dataset dataset;
    wb_align_default_settings(&settings);
    if (wb_align_run(&dataset, options->input, &settings, NULL) != WB_OK)
        return WB_EXIT_FAILED;
    const int code = deliver(&dataset, options);
    wb_dataset_release(&dataset);
    return code;
}

static void print_harness(const struct wb_harness_result_set *set,
                          const struct wb_command_common *options)
{
    struct wb_text text = {0};
    char figure[WB_PATH];
    if (options->json) {
        struct wb_json *const root = wb_json_create();
        wb_json_set_text(root, "folder", options->output);
        wb_harness_quicklook_describe(set, root);
        wb_command_print_json(root);
        return;
    }
    wb_harness_quicklook_summary(set, &text);
    printf("%s\nwritten to %s\n", wb_text_string(&text), options->output);
    wb_text_release(&text);
    snprintf(figure, sizeof figure, "%s/shape.svg", options->output);
    struct wb_finding finding = {.figure = figure};
    wb_text_append(&finding.found, "%s: free of stress, as the file describes it", set->plan->name);
    wb_finding_append_command(&finding.next, "wirebench solve harness %s", options->input);
    wb_finding_print(&finding);
}

static int look_at_harness(const char *path, const struct wb_command_common *options)
{
    struct wb_harness_plan *const plan = wb_memory_new(1, sizeof *plan);
    struct wb_harness_result_set set = {.plan = NULL};
    enum wb_status status = wb_harness_file_read(plan, path);
    if (status == WB_OK)
        status = wb_harness_quicklook_compute(&set, plan);
    if (status == WB_OK)
        status = wb_harness_quicklook_write(&set, options->output, options->force);
    if (status == WB_OK)
        print_harness(&set, options);
    wb_harness_run_release(&set);
    free(plan);
    return wb_command_exit(status);
}

int wb_cmd_quicklook(int argc, char **argv)
{
    struct wb_command_common options = {.noun = "recording or harness file",
                                        .destination = "figures go: -o DIR"};
    char path[WB_PATH];
    wb_command_parse(&argp, argc, argv, &options);
    if (wb_file_kind_find_input(&options.input, path,
                                WB_FILE_BIT(WB_FILE_RECORDING) | WB_FILE_BIT(WB_FILE_HARNESS)) !=
        WB_OK)
        return WB_EXIT_FAILED;
    return wb_file_kind_find(options.input) == WB_FILE_HARNESS
               ? look_at_harness(options.input, &options)
               : look_at_recording(&options);
}
