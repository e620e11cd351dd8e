/* wirebench doctor: checks whether the bench is ready for a test. */
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "base/interrupt.h"
#include "base/units.h"
#include "cli/command.h"
#include "cli/file_kind.h"
#include "cli/live_line.h"
#include "cli/settings.h"
#include "daq/doctor/doctor.h"
#include "daq/doctor/scan.h"

#define WB_LOG_DOMAIN "doctor"

#define WORDS 32

struct options {
    struct wb_command_common common;
    bool scans;
    const char *words[WORDS]; /* rig file and specimen, or ports to scan */
    int n_words;
    struct wb_doctor_request request;
};

static const struct argp_option option_table[] = {
    {"folder", WB_KEY_TEXT(options, request.folder), "DIR", 0,
     "Folder for the recordings (the current folder)"},
    {"scan", WB_KEY_FLAG(options, scans), NULL, 0,
     "Look for instruments and write a first rig file"},
    {"output", 'o', "RIG.yaml", 0, "The rig file that --scan writes; it must not exist"},
    {"json", WB_KEY_JSON, NULL, 0, "Print one JSON object"},
    {0},
};

static void check_words(const struct options *options, struct argp_state *state)
{
    if (options->scans && !options->common.output)
        argp_error(state, "--scan needs the rig file to write: -o RIG.yaml");
    for (int i = 0; options->scans && i < options->n_words; i++)
        if (strncmp(options->words[i], "serial:", 7) != 0 &&
            strncmp(options->words[i], "pty:", 4) != 0 &&
            strncmp(options->words[i], "udp:", 4) != 0)
            argp_error(state,
                       "invalid address '%s': expected serial:PATH, pty:PATH or udp:HOST:PORT",
                       options->words[i]);
    if (options->scans)
        return;
    if (options->common.output)
        argp_error(state, "-o needs --scan");
    if (options->n_words == 0)
        argp_error(state, "rig file missing");
    if (options->n_words > 2)
        argp_error(state, "unexpected argument '%s'", options->words[2]);
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct options *const options = state->input;
    if (key == ARGP_KEY_ARG) {
        if (options->n_words == WORDS)
            argp_error(state, "too many arguments: '%s'", argument);
        options->words[options->n_words++] = argument;
        return 0;
    }
    if (key == ARGP_KEY_END)
        check_words(options, state);
    return wb_command_parse_common(key, argument, state);
}

static const struct argp argp = {
    .options = option_table,
    .parser = parse,
    .args_doc = "RIG.yaml [SPECIMEN.yaml]\n--scan [ADDRESS...] -o RIG.yaml",
    .doc =
        "Checks whether the bench is ready for a test: opens the ports of the rig file, listens "
        "for some seconds, and prints for each item that a test needs whether it is ready, or what "
        "is wrong and how to fix it. The stage is not moved, and nothing is recorded.\v"
        "The checks are those of `wirebench record`. With a specimen file, the markers on the "
        "bench are compared with it, and a picture shows both.\n\n"
        "--scan listens at every free serial port with a USB adapter, queries it for a GRBL or a "
        "Tic, searches NatNet servers on all network interfaces, and writes a first rig file; with "
        "addresses, only at these. It moves nothing and overwrites nothing.\n\n"
        "Exit codes: 0 ready; 1 a file cannot be read or written; 2 wrong usage; 3 stopped by "
        "Ctrl-C, or --scan did not find all instruments; 4 not ready.",
};

static const struct wb_settings_source sources[] = {
    {.tables = &wb_bend_test_table,
     .n_tables = 1,
     .offset = offsetof(struct options, request.test)},
    {.tables = &wb_doctor_table, .n_tables = 1, .offset = offsetof(struct options, request)},
};

static const struct wb_settings_command command = {
    .argp = &argp, .sources = sources, .n_sources = WB_COUNT(sources), .place = 1};

static void print_json(const struct wb_doctor_report *report)
{
    struct wb_json *const root = wb_json_create();
    wb_json_set_boolean(root, "ready", wb_doctor_is_ready(report));
    wb_json_set_boolean(root, "virtual_rig", report->is_virtual);
    struct wb_json *const items = wb_json_set_array(root, "items");
    for (int i = 0; i < report->n; i++) {
        struct wb_json *const item = wb_json_append_object(items);
        wb_json_set_text(item, "name", report->items[i].name);
        wb_json_set_text(item, "verdict", wb_doctor_verdict_name(report->items[i].verdict));
        wb_json_set_text(item, "text", report->items[i].text);
    }
    wb_json_set_text(root, "picture", report->picture);
    wb_command_print_json(root);
}

static void print(const struct wb_doctor_report *report)
{
    int n_wrong = 0;
    for (int i = 0; i < report->n; i++) {
        const struct wb_doctor_item *const item = &report->items[i];
        printf("%-10s %-10s %s\n", item->name, wb_doctor_verdict_name(item->verdict), item->text);
        n_wrong += item->verdict == WB_DOCTOR_NOT_READY;
    }
    fputs(report->picture, stdout);
    const char *const bench = report->is_virtual ? "the virtual rig" : "the bench";
    if (n_wrong == 0)
        printf("%s is ready\n", bench);
    else
        printf("%s is NOT READY: %d problem%s to fix\n", bench, n_wrong, n_wrong == 1 ? "" : "s");
}

static int look_at_bench(const struct options *options, struct wb_doctor_report *report)
{
    struct wb_doctor *doctor;
    /* The report contains the remarks of the instruments. */
    wb_log_set_threshold(WB_LOG_ERROR);
    if (wb_doctor_open(&doctor, &options->request) != WB_OK)
        return WB_EXIT_FAILED;
    wb_live_line_open();
    while (wb_doctor_step(doctor, 20 * WB_NS_PER_MS)) {
        if (wb_live_line_due())
            wb_live_line_show("listening to the instruments");
    }
    wb_live_line_close();
    wb_doctor_close(doctor, report);
    wb_log_set_threshold(WB_LOG_INFO);
    return wb_interrupted() ? WB_EXIT_INCOMPLETE : WB_EXIT_OK;
}

static enum wb_status look_for_instruments(const struct options *options, struct wb_scan *scan)
{
    if (options->n_words == 0) {
        wb_scan_find_ports(scan);
        WB_TRY(wb_scan_find_servers(scan, NULL));
    }
    for (int i = 0; i < options->n_words; i++) {
        const char *const address = options->words[i];
        if (strncmp(address, "udp:", 4) == 0)
            WB_TRY(wb_scan_find_servers(scan, address));
        else if (!wb_scan_add_port(scan, address))
            return wb_fail(WB_ERR_ARGUMENT, "'%s': the address is too long, or there are too many",
                           address);
    }
    for (int i = 0; i < scan->n_ports && !wb_interrupted(); i++) {
        wb_info("listening at %s", scan->ports[i].address);
        wb_scan_listen(&scan->ports[i]);
    }
    return WB_OK;
}

static int scan_bench(const struct options *options)
{
    static struct wb_scan scan;
    struct wb_text text = {0}, next = {0};
    const char *const path = options->common.output;
    if (wb_file_exists(path)) {
        wb_error("'%s' exists: a rig file is never overwritten, choose another name", path);
        return WB_EXIT_FAILED;
    }
    if (look_for_instruments(options, &scan) != WB_OK)
        return WB_EXIT_FAILED;
    if (wb_interrupted())
        return WB_EXIT_INCOMPLETE;
    wb_scan_write_rig(&scan, &text);
    const enum wb_status status = wb_file_write_text(path, &text);
    wb_text_release(&text);
    if (status != WB_OK)
        return WB_EXIT_FAILED;
    wb_text_append_quoted(&next, path);
    printf("%s: %d port%s, %d NatNet server%s; replace every FILL IN, then run: wirebench doctor "
           "%s\n",
           path, scan.n_ports, scan.n_ports == 1 ? "" : "s", scan.n_servers,
           scan.n_servers == 1 ? "" : "s", wb_text_string(&next));
    wb_text_release(&next);
    return wb_scan_is_complete(&scan) ? WB_EXIT_OK : WB_EXIT_INCOMPLETE;
}

int wb_cmd_doctor(int argc, char **argv)
{
    struct options options = {.common = {.noun = NULL}};
    struct wb_doctor_report report;
    char specimen[WB_PATH];
    wb_doctor_default_request(&options.request);
    wb_settings_parse(&command, argc, argv, &options);
    wb_interrupt_install();
    if (options.scans)
        return scan_bench(&options);
    struct wb_bend_test_request *const test = &options.request.test;
    test->rig_path = options.words[0];
    test->specimen_path = options.words[1];
    if (wb_file_kind_check(test->rig_path, WB_FILE_BIT(WB_FILE_RIG)) != WB_OK ||
        (test->specimen_path &&
         wb_file_kind_find_input(&test->specimen_path, specimen, WB_FILE_SPECIMENS) != WB_OK))
        return WB_EXIT_FAILED;
    const int code = look_at_bench(&options, &report);
    if (code != WB_EXIT_OK)
        return code;
    if (options.common.json)
        print_json(&report);
    else
        print(&report);
    return wb_doctor_is_ready(&report) ? WB_EXIT_OK : WB_EXIT_LIMIT;
}
