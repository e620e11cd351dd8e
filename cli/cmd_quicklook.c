/* wirebench quicklook: curve and shapes of one recording. */
#include "analysis/align/align.h"
#include "analysis/quicklook.h"
#include "cli/command.h"
#include "cli/datasets.h"
#include "cli/file_kind.h"

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
    .args_doc = "REC.wbr",
    .doc = "Aligns one recording (.wbr or .wbr.zst) and writes its force-deflection curve and "
           "shapes as figures (SVG, PNG, PDF) and CSV, with a summary that is also printed.\v"
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

int wb_cmd_quicklook(int argc, char **argv)
{
    struct wb_command_common options = {.noun = "recording", .destination = "figures go: -o DIR"};
    struct wb_align_settings settings;
    struct wb_dataset dataset;
    wb_command_parse(&argp, argc, argv, &options);

    wb_align_default_settings(&settings);
    if (wb_file_kind_check(options.input, WB_FILE_BIT(WB_FILE_RECORDING)) != WB_OK ||
        wb_align_run(&dataset, options.input, &settings, NULL) != WB_OK)
        return WB_EXIT_FAILED;
    const int code = deliver(&dataset, &options);
    wb_dataset_release(&dataset);
    return code;
}
