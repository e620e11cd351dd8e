/* wirebench stage: moves the stage by hand, frees a specimen, checks the load cell. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/interrupt.h"
#include "base/number.h"
#include "base/units.h"
#include "cli/bench_options.h"
#include "cli/check_cell.h"
#include "cli/complete.h"
#include "cli/file_kind.h"
#include "cli/live_line.h"
#include "cli/settings.h"
#include "daq/acquire/acquisition.h"
#include "daq/protocol/rig.h"

#define WB_LOG_DOMAIN "stage"

static const struct argp_option other_options[] = {
    {"output", 'o', "CERTIFICATE.pdf", 0, "Write the series of check as a page"},
    {"force", WB_KEY_FORCE, NULL, 0, "Replace that file"},
    {"json", WB_KEY_JSON, NULL, 0, "Print the outcome as JSON"},
    {0},
};

static const char *const actions[] = {"home", "jog", "unlock", "release", "check", NULL};
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
        argp_error(state, "rig file missing");
    if (!options->action)
        argp_error(state, "action missing: home, jog MM, unlock, release or check MASS_G");
    const int action = find_action(options->action);
    if (action < 0)
        argp_error(state, "unknown action '%s': expected home, jog, unlock, release or check",
                   options->action);
    if (action == WB_STAGE_JOB_JOG && !options->value)
        argp_error(state, "jog needs a distance in mm, down positive: jog 2.5");
    if (action != ACTION_CHECK && (options->masses || options->common.output))
        argp_error(state, "--masses and -o apply only to check, not to %s", options->action);
    if (options->masses && options->value)
        argp_error(state, "check: one mass and --masses cannot be combined");
    if (options->common.output && !wb_command_ends_in(options->common.output, ".pdf"))
        argp_error(state, "--output: expected NAME.pdf, not '%s'", options->common.output);
    if (options->value && action != WB_STAGE_JOB_JOG && action != WB_STAGE_JOB_RELEASE &&
        action != ACTION_CHECK)
        argp_error(state, "%s takes no number", options->action);
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct wb_stage_options *const options = state->input;
    if (key == ARGP_KEY_ARG) {
        if (!options->rig_path)
            options->rig_path = argument;
        else if (!options->action)
            options->action = argument;
        else if (!options->value)
            options->value = argument;
        else
            argp_error(state, "unexpected argument '%s'", argument);
        return 0;
    }
    if (key == ARGP_KEY_END)
        check_words(options, state);
    return wb_command_parse_common(key, argument, state);
}

static const struct argp argp = {
    .options = other_options,
    .parser = parse,
    .args_doc = "RIG.yaml home\nRIG.yaml jog MM\nRIG.yaml unlock\nRIG.yaml release [MM]\n"
                "RIG.yaml check [MASS_G | --masses LIST]",
    .doc =
        "Operates the bench by hand.\n\n"
        "home     runs the stage's homing cycle. Remove the specimen first.\n"
        "jog MM   moves the clamp down (negative: up) at the speed of the rig file.\n"
        "unlock   clears hold or alarm of the stage without moving it.\n"
        "release  frees a specimen after a stop: clears hold or alarm and moves slowly up until "
        "the strand is slack (the reading is constant over 0.75 mm, at the zero of the load cell "
        "that --zero-mn gives), at most by MM (limits.travel_mm of the rig file). Without "
        "--zero-mn it ends at a constant reading and asks to look at the strand.\n"
        "check    compares the load cell with a known mass, or with a series of masses up and "
        "down (check_masses_g of the rig file, else its check_mass_g), and adds the result to the "
        "log beside the rig file (RIG.checks.csv).\v"
        "While the stage moves, the load cell is monitored: force limit, overload, a change of "
        "unit, silence, alarms and Ctrl-C stop the stage. The readings are not tared. A release "
        "may begin beyond the limits; it stops when the load increases by 5 % of the capacity, "
        "because then moving up does not unload the specimen.\n\n"
        "Exit codes: 0 done, check passed; 1 failed, check not passed; 2 wrong usage; 3 stopped "
        "by a limit or Ctrl-C, or the strand was not seen slack.",
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

static void print_job_json(const struct wb_rig *rig, const struct wb_stage_job_result *result)
{
    struct wb_json *const root = wb_json_create();
    wb_json_set_text(root, "end", wb_bench_options_end_name(result->end));
    wb_json_set_text(root, "reason", result->text);
    wb_json_set_boolean(root, "virtual_rig", rig->is_virtual);
    wb_json_set_boolean(root, "standing", result->standing);
    wb_json_set_number(root, "position_mm", result->position / WB_MM);
    wb_json_set_number(root, "moved_mm", result->moved / WB_MM);
    wb_json_set_number(root, "force_mN", result->force / WB_MN);
    wb_json_set_number(root, "force_change_mN", result->change / WB_MN);
    wb_command_print_json(root);
}

static void report_job(const struct wb_rig *rig, const struct wb_stage_job_result *result,
                       bool quiet)
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
        wb_error("the stage did not confirm that it stopped: switch off its power before you touch "
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
    report_job(rig, &result, options->common.json);
    if (options->common.json)
        print_job_json(rig, &result);
    if (result.end == WB_SEQUENCE_DONE)
        return WB_EXIT_OK;
    return result.end == WB_SEQUENCE_FAILED ? WB_EXIT_FAILED : WB_EXIT_INCOMPLETE;
}

/* Moves a negative number behind "--", so that `jog -2` is not parsed as an option. */
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
        wb_error("stage: too many arguments");
        return WB_EXIT_USAGE;
    }
    if (argc > 1) /* the first is the rig file */
        wb_complete_arguments(actions);
    argc = shield_number(argc, argv, shielded);
    wb_setting_fill(&wb_bench_options_stage, &options);
    wb_settings_parse_table(&argp, &wb_bench_options_stage, &options, 1, argc, shielded, &options);
    wb_interrupt_install();
    wb_acquisition_raise_priority();
    if (wb_file_kind_check(options.rig_path, WB_FILE_BIT(WB_FILE_RIG)) != WB_OK ||
        wb_rig_read(options.rig_path, &rig) != WB_OK)
        return WB_EXIT_FAILED;
    const int action = find_action(options.action);
    if (action == ACTION_CHECK)
        return wb_check_cell_run(&options, &rig);
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
