/* wirebench align: recordings to datasets. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/align/align.h"
#include "base/file.h"
#include "base/interrupt.h"
#include "base/memory.h"
#include "cli/command.h"
#include "cli/datasets.h"
#include "cli/file_kind.h"
#include "cli/finding.h"
#include "cli/settings.h"

#define WB_LOG_DOMAIN "align"

struct options {
    struct wb_command_common common;
    struct wb_align_settings settings;
};

static const struct argp_option other_options[] = {
    {"output", 'o', "DATASET", 0,
     "Folder to write; for several recordings, each gets a folder in it"},
    {"rig", WB_KEY_TEXT(options, settings.rig_path), "FILE", 0,
     "Rig file that replaces a wrong one in the recording; the differences are written into the "
     "dataset"},
    {"specimen", WB_KEY_TEXT(options, settings.specimen_path), "FILE", 0,
     "Specimen file that replaces a wrong one in the recording, likewise"},
    {"force", WB_KEY_FORCE, NULL, 0, "Overwrite the files of the folder"},
    {"json", WB_KEY_JSON, NULL, 0, "Print one JSON object"},
    {0},
};

static const struct argp argp = {
    .options = other_options,
    .parser = wb_command_parse_common,
    .args_doc = "REC.wbr...",
    .doc = "Converts recordings (.wbr or .wbr.zst) into datasets: maps clocks, identifies markers, "
           "corrects tare, drift, filter delay and marker offset, moves the clamp to the origin, "
           "separates cycles and phases, and fits the natural shape. dataset.json lists every "
           "correction with its size.\v"
           "One recording becomes the dataset DATASET; each of several becomes DATASET/NAME, where "
           "NAME is its file name without ending. Exit code 3: a dataset is usable but incomplete "
           "(gaps, damaged or lost data, a test that ended early).",
};

/* The dataset of one recording and the folder that it is written to. */
struct result {
    char folder[WB_PATH];
    struct wb_dataset dataset;
};

/* The file name without .wbr or .wbr.zst. */
static void base_name(char name[WB_PATH], const char *path)
{
    snprintf(name, WB_PATH, "%s", wb_file_name(path));
    static const char *const endings[] = {".zst", ".wbr"};
    for (size_t i = 0; i < 2; i++) {
        if (wb_command_ends_in(name, endings[i]))
            name[strlen(name) - strlen(endings[i])] = '\0';
    }
}

static enum wb_status choose_folder(const struct options *o, struct result *results, size_t i)
{
    char name[WB_PATH];
    if (o->common.n == 1) {
        if (strlen(o->common.output) >= WB_PATH)
            return wb_fail(WB_ERR_ARGUMENT, "the output path is too long");
        strcpy(results[i].folder, o->common.output);
        return WB_OK;
    }
    base_name(name, o->common.inputs[i]);
    WB_TRY(wb_file_join(results[i].folder, o->common.output, name));
    for (size_t k = 0; k < i; k++) {
        if (strcmp(results[k].folder, results[i].folder) == 0)
            return wb_fail(WB_ERR_ARGUMENT,
                           "two recordings are named '%s': align them with separate commands",
                           name);
    }
    return WB_OK;
}

static enum wb_status run(const struct options *o, struct result *results, size_t *n_done)
{
    for (size_t i = 0; i < (size_t)o->common.n; i++) {
        WB_TRY(wb_file_kind_check(o->common.inputs[i], WB_FILE_BIT(WB_FILE_RECORDING)));
        WB_TRY(choose_folder(o, results, i));
    }
    for (size_t i = 0; i < (size_t)o->common.n && !wb_interrupted(); i++) {
        struct result *const result = &results[i];
        WB_TRY(wb_align_run(&result->dataset, o->common.inputs[i], &o->settings, NULL));
        *n_done = i + 1;
        WB_TRY(wb_dataset_write(&result->dataset, result->folder, o->common.force));
    }
    return WB_OK;
}

static void print_json(const struct result *results, size_t n)
{
    struct wb_json *const root = wb_json_create();
    struct wb_json *const list = wb_json_set_array(root, "datasets");
    for (size_t i = 0; i < n; i++)
        wb_datasets_describe(wb_json_append_object(list), &results[i].dataset, results[i].folder);
    wb_command_print_json(root);
}

static void print_finding(const struct options *o, const struct result *results, size_t n)
{
    struct wb_finding finding = {.figure = NULL};
    const struct wb_test_info *const info = &results[0].dataset.info;
    int n_warnings = 0, n_incomplete = 0;
    bool is_one_wire = true;
    for (size_t i = 0; i < n; i++) {
        const struct wb_dataset *const dataset = &results[i].dataset;
        n_warnings += (int)wb_json_length(wb_json_get(dataset->document, "warnings"));
        n_incomplete += !wb_dataset_is_complete(dataset);
        is_one_wire = is_one_wire && strcmp(dataset->info.wire, info->wire) == 0;
    }
    wb_text_append(&finding.found, "%zu dataset%s", n, n == 1 ? "" : "s");
    if (is_one_wire)
        wb_text_append(&finding.found, " of wire %s (%s)", info->wire, wb_finding_source(info));
    const int n_left = o->common.n - (int)n;
    if (n_left > 0)
        wb_text_append(&finding.trust, "in part: interrupted, %d recording%s not aligned%s", n_left,
                       n_left == 1 ? "" : "s", n_incomplete + n_warnings > 0 ? "; " : "");
    if (n_incomplete > 0)
        wb_text_append(&finding.trust, "in part: %d incomplete (gaps, damaged or lost data)%s",
                       n_incomplete, n_warnings > 0 ? "; " : "");
    if (n_warnings > 0)
        wb_text_append(&finding.trust, "%sread the %d warning%s above first",
                       n_incomplete > 0 ? "" : "in part: ", n_warnings, n_warnings == 1 ? "" : "s");
    if (n_left + n_incomplete + n_warnings == 0)
        wb_text_append(&finding.trust, "yes: complete, without warnings");
    if (is_one_wire) {
        char file[WB_PATH];
        snprintf(file, sizeof file, "%s.yaml", info->wire);
        wb_finding_append_command(&finding.next,
                                  o->common.n > 1 ? "wirebench calibrate %s/* -o %s"
                                                  : "wirebench calibrate %s -o %s",
                                  o->common.output, file);
    } else {
        wb_text_append(&finding.next,
                       "wirebench calibrate, separately for the datasets of each wire");
    }
    wb_finding_print(&finding);
}

static void deliver(const struct options *o, const struct result *results, size_t n)
{
    if (o->common.json) {
        print_json(results, n);
        return;
    }
    for (size_t i = 0; i < n; i++) {
        if (i > 0)
            putchar('\n');
        wb_datasets_print(&results[i].dataset, results[i].folder);
    }
    if (n > 0)
        print_finding(o, results, n);
}

int wb_cmd_align(int argc, char **argv)
{
    struct options options = {.common = {.noun = "at least one recording",
                                         .least = 1,
                                         .destination = "dataset goes: -o DATASET"}};
    wb_align_default_settings(&options.settings);
    wb_settings_parse_table(&argp, &wb_align_table, &options.settings, 1, argc, argv, &options);
    const size_t n = (size_t)options.common.n;
    wb_interrupt_install();

    size_t n_done = 0;
    struct result *const results = wb_memory_new(n, sizeof *results);
    int code = wb_command_exit(run(&options, results, &n_done));
    if (code == WB_EXIT_OK)
        deliver(&options, results, n_done);
    for (size_t i = 0; i < n_done; i++) {
        if (code == WB_EXIT_OK && !wb_dataset_is_complete(&results[i].dataset))
            code = WB_EXIT_INCOMPLETE;
        wb_dataset_release(&results[i].dataset);
    }
    if (code == WB_EXIT_OK && n_done < n)
        code = WB_EXIT_INCOMPLETE;
    free(results);
    return code;
}
