/* wirebench clock: the uncertainty of the times in a recording. */
#include <stdio.h>

#include "analysis/clock_report.h"
#include "cli/command.h"
#include "cli/file_kind.h"

#define WB_LOG_DOMAIN "clock"

static const struct argp_option option_table[] = {
    {"json", WB_KEY_JSON, NULL, 0, "Print one JSON object"},
    {0},
};

static const struct argp argp = {
    .options = option_table,
    .parser = wb_command_parse_common,
    .args_doc = "REC.wbr",
    .doc =
        "Prints how accurate the times of a recording (.wbr or .wbr.zst) are: offset and drift of "
        "the cameras' clock against the host's, scatter of the arrival times of the load cell, "
        "the lag of the force behind the markers, measured at reversals of the motion, and the "
        "effect of that lag on the area of the loop.\v"
        "Exit codes: 0 the lag agrees with the rig file; 1 the recording could not be aligned; "
        "2 wrong usage; 3 the lag is not identifiable or differs from the rig file.",
};

static void print(const struct wb_clock_report *report, const struct wb_command_common *options)
{
    struct wb_text text = {0};
    if (options->json) {
        struct wb_json *const root = wb_json_create();
        wb_json_set_text(root, "recording", options->input);
        wb_clock_report_describe(report, root);
        wb_command_print_json(root);
        return;
    }
    wb_clock_report_format(report, &text);
    printf("%s%s\n%s", options->input, report->dataset.info.is_virtual ? " (virtual rig)" : "",
           wb_text_string(&text));
    wb_text_release(&text);
}

int wb_cmd_clock(int argc, char **argv)
{
    struct wb_command_common options = {.noun = "recording"};
    struct wb_clock_report report;
    wb_command_parse(&argp, argc, argv, &options);
    if (wb_file_kind_check(options.input, WB_FILE_BIT(WB_FILE_RECORDING)) != WB_OK ||
        wb_clock_report_make(&report, options.input) != WB_OK)
        return WB_EXIT_FAILED;
    print(&report, &options);
    const bool as_expected = report.identifiable && report.agrees;
    wb_clock_report_release(&report);
    return as_expected ? WB_EXIT_OK : WB_EXIT_INCOMPLETE;
}
