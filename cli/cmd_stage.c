/* wirebench stage: set the bench, free a specimen, check the load cell. */
#include <errno.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "base/interrupt.h"
#include "base/number.h"
#include "base/units.h"
#include "cli/bench_options.h"
#include "cli/live_line.h"
#include "cli/settings.h"
#include "daq/acquisition.h"
#include "daq/check_log.h"
#include "daq/mass_check.h"
#include "daq/rig.h"

#define WB_LOG_DOMAIN "stage"

static const struct argp_option other_options[] = {
    {"json", WB_KEY_JSON, NULL, 0, "Print the outcome as JSON", 0},
    {0},
};

static const char *const actions[] = {"home", "jog", "unlock", "release", "check"};
enum {
    ACTION_CHECK = 4,
    N_ACTIONS = 5
};

static int find_action(const char *name)
{
    for (int i = 0; i < N_ACTIONS; i++)
        if (strcmp(actions[i], name) == 0)
            return i;
    return -1;
}

static void check_words(const struct wb_stage_options *options, struct argp_state *state)
{
    if (!options->rig_path)
        argp_error(state, "no rig file given");
    if (!options->action)
        argp_error(state, "nothing to do given: home, jog MM, unlock, release or check MASS_G");
    const int action = find_action(options->action);
    if (action < 0)
        argp_error(state, "'%s' is not known: expected home, jog, unlock, release or check",
                   options->action);
    if (action == WB_STAGE_JOB_JOG && !options->value)
        argp_error(state, "jog needs a distance in mm, down positive: jog 2.5");
    if (options->value && action != WB_STAGE_JOB_JOG && action != WB_STAGE_JOB_RELEASE &&
        action != ACTION_CHECK)
        argp_error(state, "%s takes no number", options->action);
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct wb_stage_options *const options = state->input;
    switch (key) {
    case ARGP_KEY_ARG:
        if (!options->rig_path)
            options->rig_path = argument;
        else if (!options->action)
            options->action = argument;
        else if (!options->value)
            options->value = argument;
        else
            argp_error(state, "'%s' is one word too many", argument);
        return 0;
    case ARGP_KEY_END:
        check_words(options, state);
        return 0;
    default:
        return wb_command_parse_common(key, argument, state, &options->common);
    }
}

static const struct argp argp = {
    .options = other_options,
    .parser = parse,
    .args_doc = "RIG.yaml home\nRIG.yaml jog MM\nRIG.yaml unlock\nRIG.yaml release [MM]\n"
                "RIG.yaml check [MASS_G]",
    .doc =
        "Sets the bench by hand.\n\n"
        "home     runs the stage's own homing cycle. Take the specimen off first.\n"
        "jog MM   moves the clamp down (negative: up) at the rig's speed.\n"
        "unlock   brings the stage out of hold or alarm without moving it.\n"
        "release  frees a specimen after a stop: brings the stage out of hold or alarm and goes "
        "slowly up until the strand is slack (the reading stays level over 0.75 mm), at most by "
        "MM (default: limits.travel_mm of the rig file).\n"
        "check    compares the load cell with a known mass (default: the rig's "
        "check_mass_g), and adds the outcome to the log beside the rig file (RIG.checks.csv).\v"
        "While the stage moves the load cell is watched: force limit, overload, a change of "
        "unit, silence and alarms stop it, and so does Ctrl-C. Its reading is not tared here. "
        "A release may begin beyond the limits, because that is what it mends; it stops when "
        "the load grows by 5 % of the capacity, which means that up is not the way to unload.\n\n"
        "Exit codes: 0 done, check passed; 1 failed, check not passed; 2 wrong usage; 3 stopped "
        "by a limit or Ctrl-C, or not seen slack.",
};

/* --- jobs --- */

static void show_job(const struct wb_stage_job *job)
{
    struct wb_stage_job_status status;
    wb_stage_job_status(job, &status);
    char force[64] = "", position[64] = "position --";
    if (status.has_force)
        snprintf(force, sizeof force, "force %.2f mN (%.3f g)  ", status.force / WB_MN,
                 status.force / status.gravity / WB_G);
    if (status.has_position)
        snprintf(position, sizeof position, "position %.3f mm, moved %.3f mm",
                 status.position / WB_MM, status.moved / WB_MM);
    wb_live_line_show("%s%s  %s%s", status.is_virtual ? "virtual rig: " : "", status.phase, force,
                      position);
}

static int print_job_json(const struct wb_rig *rig, const struct wb_stage_job_result *result)
{
    static const char *const ends[] = {"running",     "done",         "limit",
                                       "interrupted", "still_loaded", "failed"};
    struct wb_json *const root = wb_json_create();
    wb_json_set_text(root, "end", ends[result->end]);
    wb_json_set_text(root, "reason", result->text);
    wb_json_set_boolean(root, "virtual_rig", rig->is_virtual);
    wb_json_set_boolean(root, "standing", result->standing);
    wb_json_set_number(root, "position_mm", result->position / WB_MM);
    wb_json_set_number(root, "moved_mm", result->moved / WB_MM);
    wb_json_set_number(root, "force_mN", result->force / WB_MN);
    wb_json_set_number(root, "force_change_mN", result->change / WB_MN);
    return wb_command_print_json(root);
}

static void tell_job(const struct wb_rig *rig, const struct wb_stage_job_result *result, bool quiet)
{
    const char *const virtual_rig = rig->is_virtual ? "virtual rig: " : "";
    if (result->end != WB_SEQUENCE_DONE)
        wb_error("%s%s", virtual_rig, result->text);
    if (result->end == WB_SEQUENCE_DONE && !quiet) {
        printf("%s%s", virtual_rig, result->text);
        if (isfinite(result->position))
            printf("; the stage stands at %.3f mm", result->position / WB_MM);
        if (isfinite(result->force))
            printf(", the load cell reads %.2f mN", result->force / WB_MN);
        printf("\n");
    }
    if (!result->standing)
        wb_error("the stage did not confirm that it stands: switch off its power before you touch "
                 "the bench");
}

static int run_job(const struct wb_stage_options *options, const struct wb_rig *rig)
{
    struct wb_stage_job *job;
    struct wb_stage_job_result result;
    wb_interrupt_guard();
    if (wb_stage_job_open(&job, rig, &options->job) != WB_OK)
        return WB_EXIT_FAILED;
    wb_live_line_open();
    while (wb_stage_job_step(job, 20 * WB_NS_PER_MS) == WB_SEQUENCE_RUNNING) {
        if (wb_live_line_due())
            show_job(job);
    }
    wb_stage_job_close(job, &result);
    wb_live_line_close();
    tell_job(rig, &result, options->common.json);
    if (options->common.json && print_job_json(rig, &result) != WB_EXIT_OK)
        return WB_EXIT_FAILED;
    if (result.end == WB_SEQUENCE_DONE)
        return WB_EXIT_OK;
    return result.end == WB_SEQUENCE_FAILED ? WB_EXIT_FAILED : WB_EXIT_INCOMPLETE;
}

/* --- check --- */

/* True once a whole line, empty or not, was read from stdin; *ended when there is no more. Reads
 * byte by byte: what follows the line is not ours. */
static bool line_came(bool *ended)
{
    struct pollfd polled = {.fd = STDIN_FILENO, .events = POLLIN};
    char byte;
    while (poll(&polled, 1, 0) > 0) {
        const ssize_t n = read(STDIN_FILENO, &byte, 1);
        if (n == 1 && byte == '\n')
            return true;
        if (n < 0 && errno == EINTR)
            return false;
        if (n <= 0) {
            *ended = true;
            return false;
        }
    }
    return false;
}

static bool measure(struct wb_mass_check *check, double known)
{
    enum wb_mass_check_phase phase, before = WB_MASS_CHECK_CONNECTING;
    bool ended = false;
    while ((phase = wb_mass_check_step(check, 20 * WB_NS_PER_MS)) < WB_MASS_CHECK_DONE) {
        if (phase != before && phase == WB_MASS_CHECK_ZERO)
            fprintf(stderr, "reading without the mass...\n");
        else if (phase != before && phase == WB_MASS_CHECK_WAITING)
            fprintf(stderr, "hang %g g on the load cell, then press Enter: ", known / WB_G);
        else if (phase != before && phase == WB_MASS_CHECK_SETTLING)
            fprintf(stderr, "reading with the mass...\n");
        before = phase;
        if (phase == WB_MASS_CHECK_WAITING && line_came(&ended))
            wb_mass_check_hung(check);
        if (ended) {
            wb_error("nobody pressed Enter: standard input has ended");
            return false;
        }
    }
    return phase == WB_MASS_CHECK_DONE;
}

static int print_check(const struct wb_stage_options *options, const struct wb_rig *rig,
                       double known, double tolerance, const struct wb_mass_check_result *result)
{
    const struct wb_rig_load_cell *const cell = &rig->load_cell;
    const char *const serial = cell->serial_number[0] ? cell->serial_number : "not given";
    const char *const date = cell->calibration_date[0] ? cell->calibration_date : "not given";
    if (options->common.json) {
        struct wb_json *const root = wb_json_create();
        wb_json_set_boolean(root, "virtual_rig", rig->is_virtual);
        wb_json_set_text(root, "serial_number", serial);
        wb_json_set_text(root, "calibration_date", date);
        wb_json_set_number(root, "capacity_g", cell->capacity / rig->gravity / WB_G);
        wb_json_set_number(root, "known_mass_g", known / WB_G);
        wb_json_set_number(root, "read_mass_g", result->mass / WB_G);
        wb_json_set_number(root, "deviation_mg", result->deviation / WB_MG);
        wb_json_set_number(root, "deviation_percent", result->relative / WB_PERCENT);
        wb_json_set_number(root, "standard_error_mg", result->uncertainty / WB_MG);
        wb_json_set_number(root, "tolerance_percent", tolerance / WB_PERCENT);
        wb_json_set_boolean(root, "passed", result->passed);
        return wb_command_print_json(root);
    }
    printf("%sload cell %s, capacity %g g, calibrated %s\n", rig->is_virtual ? "virtual rig: " : "",
           serial, cell->capacity / rig->gravity / WB_G, date);
    printf("known %.4f g, read %.4f g: deviation %+.2f mg (%+.3f %%), standard error %.2f mg\n",
           known / WB_G, result->mass / WB_G, result->deviation / WB_MG,
           result->relative / WB_PERCENT, result->uncertainty / WB_MG);
    printf("%s: tolerance %g %%\n", result->passed ? "passed" : "NOT PASSED",
           tolerance / WB_PERCENT);
    return WB_EXIT_OK;
}

/* Adds the outcome to the log beside the rig file; a log that cannot be written is told, and does
 * not change the outcome. */
static void log_check(const struct wb_stage_options *options, const struct wb_rig *rig,
                      double known, double tolerance, const struct wb_mass_check_result *result)
{
    struct wb_check_log_entry entry = {
        .known = known, .read = result->mass, .tolerance = tolerance, .passed = result->passed};
    const time_t now = time(NULL);
    struct tm utc;
    char path[WB_PATH];
    gmtime_r(&now, &utc);
    strftime(entry.utc, sizeof entry.utc, "%Y-%m-%dT%H:%M:%SZ", &utc);
    snprintf(entry.serial_number, sizeof entry.serial_number, "%s", rig->load_cell.serial_number);
    if (wb_check_log_append(options->rig_path, &entry) == WB_OK &&
        wb_check_log_path(path, options->rig_path) == WB_OK)
        wb_info("added to '%s'", path);
}

static int run_check(const struct wb_stage_options *options, const struct wb_rig *rig)
{
    const struct wb_rig_load_cell *const cell = &rig->load_cell;
    double known = cell->check_mass;
    if (options->value) {
        if (!wb_number_parse(options->value, &known) || !(known > 0.0)) {
            wb_error("check: expected a mass in grams, not '%s'", options->value);
            return WB_EXIT_USAGE;
        }
        known *= WB_G;
    }
    if (!(known > 0.0)) {
        wb_error("check: no mass given, and the rig file has no load_cell.check_mass_g");
        return WB_EXIT_USAGE;
    }
    if (known * rig->gravity > cell->overload) {
        wb_error("check: %g g is more than the load cell reads (%g g)", known / WB_G,
                 cell->overload / rig->gravity / WB_G);
        return WB_EXIT_USAGE;
    }
    const double tolerance = options->tolerance > 0.0 ? options->tolerance : cell->check_tolerance;
    struct wb_mass_check *check;
    struct wb_mass_check_result result;
    if (wb_mass_check_open(&check, rig, options->seconds) != WB_OK)
        return WB_EXIT_FAILED;
    const bool measured = measure(check, known);
    if (measured)
        wb_mass_check_result(check, known, tolerance, &result);
    wb_mass_check_close(check);
    if (measured)
        log_check(options, rig, known, tolerance, &result);
    if (!measured || print_check(options, rig, known, tolerance, &result) != WB_EXIT_OK)
        return WB_EXIT_FAILED;
    return result.passed ? WB_EXIT_OK : WB_EXIT_FAILED;
}

/* `jog -2`: a negative number is no option. It is moved behind a "--". */
static int shield_number(int argc, char **argv, char **shielded)
{
    const char *number = NULL;
    int n = 0;
    double value;
    for (int i = 0; i < argc; i++) {
        if (i > 0 && !number && argv[i][0] == '-' && wb_number_parse(argv[i], &value))
            number = argv[i];
        else
            shielded[n++] = argv[i];
    }
    if (number) {
        shielded[n++] = (char *)"--";
        shielded[n++] = (char *)number;
    }
    shielded[n] = NULL;
    return n;
}

int wb_cmd_stage(int argc, char **argv)
{
    struct wb_stage_options options = {0};
    struct wb_rig rig;
    char *shielded[64];
    if (argc > 60) {
        wb_error("stage: too many words");
        return WB_EXIT_USAGE;
    }
    argc = shield_number(argc, argv, shielded);
    wb_setting_fill(&wb_bench_options_stage, &options);
    wb_settings_parse_table(&argp, &wb_bench_options_stage, &options, 1, argc, shielded, &options);
    wb_interrupt_install();
    wb_acquisition_raise_priority();
    if (wb_rig_read(options.rig_path, &rig) != WB_OK)
        return WB_EXIT_FAILED;
    const int action = find_action(options.action);
    if (action == ACTION_CHECK)
        return run_check(&options, &rig);
    options.job.kind = (enum wb_stage_job_kind)action;
    if (options.value) {
        if (!wb_number_parse(options.value, &options.job.distance)) {
            wb_error("%s: expected a distance in mm, not '%s'", options.action, options.value);
            return WB_EXIT_USAGE;
        }
        options.job.distance *= WB_MM;
    }
    return run_job(&options, &rig);
}
