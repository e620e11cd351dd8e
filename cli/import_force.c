/* wirebench import force: the curve of a testing machine to a dataset. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/dataset/machine_import.h"
#include "base/file.h"
#include "base/units.h"
#include "cli/command.h"
#include "cli/complete.h"
#include "cli/file_kind.h"
#include "cli/finding.h"
#include "cli/import.h"

#define WB_LOG_DOMAIN "import"

enum {
    KEY_DELIMITER = WB_KEY_OWN,
    KEY_DECIMAL
};

struct options {
    struct wb_command_common common;
    const char *specimen, *machine, *columns;
    struct wb_text_table_form form;
};

static const struct argp_option argp_options[] = {
    {"specimen", WB_KEY_TEXT(options, specimen), "SPECIMEN.yaml", 0, "The specimen"},
    {"machine", WB_KEY_TEXT(options, machine), "MACHINE.yaml", 0,
     "The machine and the kind of test: span, radii, ..."},
    {"output", 'o', "DATASET", 0, "Folder to write"},
    {"columns", WB_KEY_TEXT(options, columns), "LIST", 0,
     "The columns, and their units where the header has none: time=1,force=2:mN,travel=3 (from the "
     "header)"},
    {"delimiter", KEY_DELIMITER, "NAME", 0,
     "Between the columns: tab, semicolon, comma, bar or blanks (detected)"},
    {"decimal", KEY_DECIMAL, "NAME", 0, "Decimal sign: point or comma (detected)"},
    {"force", WB_KEY_FORCE, NULL, 0, "Overwrite the files of the folder"},
    {"json", WB_KEY_JSON, NULL, 0, "Print one JSON object"},
    {0},
};

struct name {
    const char *text;
    char character;
};

static const struct name delimiters[] = {{"tab", '\t'}, {"semicolon", ';'}, {"comma", ','},
                                         {"bar", '|'},  {"blanks", ' '},    {NULL, '\0'}};
static const struct name decimals[] = {{"point", '.'}, {"comma", ','}, {NULL, '\0'}};

static char find_name(struct argp_state *state, const char *option, const char *text,
                      const struct name *names)
{
    char expected[80] = "";
    for (const struct name *name = names; name->text; name++) {
        if (strcmp(name->text, text) == 0)
            return name->character;
        snprintf(expected + strlen(expected), sizeof expected - strlen(expected), "%s%s",
                 name == names ? "" : ", ", name->text);
    }
    argp_error(state, "--%s: expected one of %s, not '%s'", option, expected, text);
    return '\0';
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct options *const o = state->input;
    switch (key) {
    case KEY_DELIMITER:
        o->form.delimiter = find_name(state, "delimiter", argument, delimiters);
        return 0;
    case KEY_DECIMAL:
        o->form.decimal = find_name(state, "decimal", argument, decimals);
        return 0;
    case ARGP_KEY_END:
        if (!o->specimen || !o->machine)
            argp_error(state, "specimen or machine missing: --specimen SPECIMEN.yaml --machine "
                              "MACHINE.yaml");
        break;
    }
    return wb_command_parse_common(key, argument, state);
}

static const struct argp argp = {
    .options = argp_options,
    .parser = parse,
    .args_doc = "FILE",
    .doc = "Converts the curve that a testing machine exported as text into a dataset: three-point "
           "bending, a tensile test, or a cantilever pressed at its tip. Encoding, delimiter, "
           "decimal sign, header, units and columns are detected; name them where they are "
           "ambiguous.\v"
           "Rows without force or travel are left out and counted. The original file is kept in "
           "the dataset (original.zst). Exit code 3: the file ends in the middle of a row, or "
           "times are missing.",
};

/* --- output --- */

static void print_range(const struct wb_dataset *dataset)
{
    double force = -HUGE_VAL, least = HUGE_VAL, most = -HUGE_VAL;
    int cycles = 0;
    bool back = false;
    for (size_t i = 0; i < dataset->n_rows; i++) {
        const struct wb_row *const row = &dataset->rows[i];
        force = fmax(force, row->force);
        least = fmin(least, row->deflection);
        most = fmax(most, row->deflection);
        cycles = row->cycle;
        back = back || row->phase == WB_PHASE_UNLOAD;
    }
    printf("%s %.5g to %.5g mm, force up to %.5g N, %s%s\n",
           dataset->info.kind == WB_TEST_TENSILE ? "elongation" : "travel", least / WB_MM,
           most / WB_MM, force, back ? "loading and unloading" : "loading only",
           cycles > 1 ? ", several cycles" : "");
}

static void print_text(const struct wb_dataset *dataset,
                       const struct wb_machine_import_report *report, const char *folder)
{
    const struct wb_test_info *const info = &dataset->info;
    printf("%s, sample %d: %s test\n", info->wire, info->sample, wb_machine_kind_name(info->kind));
    print_range(dataset);
    printf("%zu rows taken of %zu lines; left out: %zu empty", report->rows, report->lines,
           report->empty);
    if (report->partial > 0)
        printf(", %zu partial (%zu without force, %zu without travel, %zu without time)",
               report->partial, report->without_force, report->without_travel,
               report->without_time);
    putchar('\n');
    if (report->gaps > 0)
        printf("%d gaps in time, the longest of %.3g s\n", report->gaps, report->longest_gap);
    if (report->cut)
        printf("the file is truncated: its last row is incomplete\n");
    if (!isfinite(dataset->rows[0].t))
        printf("no time in the file\n");
    const bool own_elongation =
        info->machine.kind == WB_TEST_TENSILE && info->machine.own_elongation;
    if (info->machine.kind == WB_TEST_TENSILE && !own_elongation)
        printf("elongation from the crosshead's travel: valid for yield and hardening, no E\n");
    if (!info->machine.compliance.known && !own_elongation)
        printf("machine compliance not given: the travel includes it\n");
    printf("written to %s\n", folder);
}

static void append_trust(struct wb_text *text, const struct wb_dataset *dataset,
                         const struct wb_machine_import_report *report)
{
    const struct wb_machine *const machine = &dataset->info.machine;
    const bool is_complete = wb_dataset_is_complete(dataset);
    if (report->cut)
        wb_text_append(text, "in part: the file is truncated");
    else if (!is_complete)
        wb_text_append(text, "in part: the dataset is incomplete, see above");
    else
        wb_text_append(text, "yes: the whole file was read");
    if (report->partial > 0)
        wb_text_append(text, "; %zu incomplete row%s left out", report->partial,
                       report->partial == 1 ? "" : "s");
    if (!machine->compliance.known &&
        !(machine->kind == WB_TEST_TENSILE && machine->own_elongation))
        wb_text_append(text, "; the travel includes the machine's compliance, which is not known");
    wb_text_append(text, "; units and zeros were not checked against the wire");
}

static void append_next(struct wb_text *text, const struct wb_dataset *dataset, const char *folder)
{
    char file[WB_PATH];
    if (dataset->info.kind == WB_TEST_TENSILE) {
        /* Without -o: a material file needs a density, too. */
        wb_finding_append_command(text, "wirebench calibrate --tensile %s", folder);
        return;
    }
    snprintf(file, sizeof file, "%s.yaml", dataset->info.wire);
    wb_finding_append_command(text, "wirebench calibrate %s -o %s", folder, file);
}

static void print_finding(const struct wb_dataset *dataset,
                          const struct wb_machine_import_report *report, const char *folder)
{
    const struct wb_test_info *const info = &dataset->info;
    struct wb_finding finding = {.figure = NULL};
    double force = -HUGE_VAL;
    for (size_t i = 0; i < dataset->n_rows; i++)
        force = fmax(force, dataset->rows[i].force);
    wb_text_append(&finding.found, "%s, sample %d (%s, %s): %zu rows, force up to %.4g N",
                   info->wire, info->sample, wb_machine_kind_name(info->kind),
                   wb_finding_source(info), report->rows, force);
    append_trust(&finding.trust, dataset, report);
    append_next(&finding.next, dataset, folder);
    wb_finding_print(&finding);
}

static void print_json(const struct wb_dataset *dataset, const char *folder)
{
    struct wb_json *const root = wb_json_create();
    wb_json_set_text(root, "folder", folder);
    wb_json_set_text(root, "kind", wb_machine_kind_name(dataset->info.kind));
    wb_json_set_text(root, "wire", dataset->info.wire);
    wb_json_set_integer(root, "sample", dataset->info.sample);
    wb_json_set_boolean(root, "complete", wb_dataset_is_complete(dataset));
    wb_json_set_copy(root, "import", wb_json_get(dataset->document, "import"));
    wb_command_print_json(root);
}

/* --- the command --- */

static enum wb_status run(const struct options *o, struct wb_dataset *dataset,
                          struct wb_machine_import_report *report)
{
    struct wb_machine machine;
    struct wb_test_piece piece;
    char found[WB_PATH], *bytes;
    size_t size;
    const char *path = o->machine;
    WB_TRY(wb_file_kind_find_input(&path, found, WB_FILE_BIT(WB_FILE_MACHINE)));
    WB_TRY(wb_machine_read(path, &machine, NULL));
    path = o->specimen;
    WB_TRY(wb_file_kind_find_input(&path, found, WB_FILE_BIT(WB_FILE_TEST_PIECE)));
    WB_TRY(wb_test_piece_read(path, machine.kind, &piece, NULL));
    WB_TRY(wb_file_kind_check(o->common.input, WB_FILE_BIT(WB_FILE_TABLE)));
    WB_TRY(wb_file_read(o->common.input, &bytes, &size));
    const struct wb_machine_import from = {o->common.input, o->columns, &o->form, &machine, &piece};
    enum wb_status status = wb_machine_import(dataset, bytes, size, &from, report, NULL);
    if (status == WB_OK)
        status = wb_machine_import_write(dataset, bytes, size, o->common.output, o->common.force);
    free(bytes);
    return status;
}

static int deliver(const struct options *o, const struct wb_dataset *dataset,
                   const struct wb_machine_import_report *report)
{
    if (o->common.json) {
        print_json(dataset, o->common.output);
    } else {
        print_text(dataset, report, o->common.output);
        print_finding(dataset, report, o->common.output);
    }
    return wb_dataset_is_complete(dataset) ? WB_EXIT_OK : WB_EXIT_INCOMPLETE;
}

int wb_import_force(int argc, char **argv)
{
    struct options options = {
        .common = {.noun = "file of a testing machine", .destination = "dataset goes: -o DATASET"}};
    struct wb_dataset dataset = {.rows = NULL};
    struct wb_machine_import_report report;
    for (const struct name *name = delimiters; name->text; name++)
        wb_complete_value("delimiter", name->text);
    for (const struct name *name = decimals; name->text; name++)
        wb_complete_value("decimal", name->text);
    wb_command_parse(&argp, argc, argv, &options);
    int code = wb_command_exit(run(&options, &dataset, &report));
    if (code == WB_EXIT_OK)
        code = deliver(&options, &dataset, &report);
    wb_dataset_release(&dataset);
    return code;
}
