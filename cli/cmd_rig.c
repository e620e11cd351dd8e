/* wirebench rig: the virtual rig, until it is interrupted. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/file.h"
#include "base/interrupt.h"
#include "base/units.h"
#include "cli/command.h"
#include "daq/acquisition.h"
#include "fixtures/virtual/bench.h"

#define WB_LOG_DOMAIN "rig"

struct options {
    struct wb_bench_settings bench;
    const char *run;
};

enum {
    OPTION_SPECIMEN = 256,
    OPTION_RUN,
    OPTION_SEED,
    OPTION_TIME_SCALE,
    OPTION_NATNET,
    OPTION_LOST_STEPS
};

static const struct argp_option argp_options[] = {
    {"specimen", OPTION_SPECIMEN, "SPECIMEN.yaml", 0, "The piece of wire to put on the rig", 0},
    {"run", OPTION_RUN, "DIR", 0, "Folder that receives rig.yaml, the rig file for `record`", 0},
    {"seed", OPTION_SEED, "N", 0, "Seed of specimen, truth and noise (default 1)", 0},
    {"time-scale", OPTION_TIME_SCALE, "X", 0,
     "Let all clocks, filters and drifts run X times (default 1)", 0},
    {"natnet-version", OPTION_NATNET, "M.N", 0,
     "Protocol of the motion capture, 2.5 to 4.1 (default 3.0)", 0},
    {"lost-steps", OPTION_LOST_STEPS, "MM@MM", 0,
     "The stage loses so many mm once it is so many mm down, such as 0.8@20", 0},
    {0},
};

/* "3.0" */
static struct wb_natnet_version parse_version(struct argp_state *state, const char *text)
{
    struct wb_natnet_version version = {0, 0};
    char major[8];
    const size_t n = strcspn(text, ".");
    if (text[n] != '.' || n == 0 || n >= sizeof major)
        argp_error(state, "--natnet-version: expected a version such as 3.0, not '%s'", text);
    memcpy(major, text, n);
    major[n] = '\0';
    version.major = (uint8_t)wb_command_integer(state, "--natnet-version", major, 2, 4);
    version.minor = (uint8_t)wb_command_integer(state, "--natnet-version", text + n + 1, 0, 99);
    return version;
}

/* "0.8@20" */
static void parse_lost_steps(struct argp_state *state, const char *text,
                             struct wb_bench_settings *bench)
{
    char lost[32];
    const size_t n = strcspn(text, "@");
    if (text[n] != '@' || n == 0 || n >= sizeof lost)
        argp_error(state, "--lost-steps: expected MM@MM such as 0.8@20, not '%s'", text);
    memcpy(lost, text, n);
    lost[n] = '\0';
    bench->lost_steps = wb_command_number(state, "--lost-steps", lost, 0.0, 100.0) * WB_MM;
    bench->lost_at = wb_command_number(state, "--lost-steps", text + n + 1, 0.0, 5000.0) * WB_MM;
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct options *const options = state->input;
    switch (key) {
    case OPTION_SPECIMEN:
        options->bench.specimen = argument;
        return 0;
    case OPTION_RUN:
        options->run = argument;
        return 0;
    case OPTION_SEED:
        options->bench.seed =
            (uint64_t)wb_command_integer(state, "--seed", argument, 0, 1000000000);
        return 0;
    case OPTION_TIME_SCALE:
        options->bench.time_scale = wb_command_number(state, "--time-scale", argument, 0.05, 50.0);
        return 0;
    case OPTION_NATNET:
        options->bench.natnet = parse_version(state, argument);
        return 0;
    case OPTION_LOST_STEPS:
        parse_lost_steps(state, argument, &options->bench);
        return 0;
    case ARGP_KEY_ARG:
        if (options->bench.rig)
            argp_error(state, "one rig file is expected, '%s' is one too many", argument);
        options->bench.rig = argument;
        return 0;
    case ARGP_KEY_END:
        if (!options->bench.rig)
            argp_error(state, "no rig file given");
        if (!options->bench.specimen)
            argp_error(state, "no --specimen given");
        if (!options->run)
            argp_error(state, "no folder for the rig file given (--run DIR)");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp argp = {
    .options = argp_options,
    .parser = parse,
    .args_doc = "RIG.yaml --specimen SPECIMEN.yaml --run DIR",
    .doc = "The virtual rig: stands in for the bench of RIG.yaml, with load cell and stage on "
           "pseudo-terminals and the motion capture on a free UDP port of this machine.\v"
           "When all is ready it writes DIR/rig.yaml, which `wirebench record` takes as its rig, "
           "prints 'ready', and runs until Ctrl-C. Several rigs run side by side. RIG.yaml gives "
           "protocols, capacity, noise, filter, frame rate, stage and strand; its addresses are "
           "not used. The same seed and specimen give the same wire and the same noise.",
};

/* A folder serves one rig: a second one would replace the first one's rig file and later remove it.
 */
static enum wb_status lock_folder(struct wb_file_lock *lock, const char *folder)
{
    char path[WB_PATH], who[64] = "";
    long holder;
    WB_TRY(wb_file_join(path, folder, "rig.lock"));
    const enum wb_status status = wb_file_lock(lock, path, &holder);
    if (status != WB_ERR_BUSY)
        return status;
    if (holder > 0)
        snprintf(who, sizeof who, " (process %ld)", holder);
    return wb_fail(status,
                   "a rig runs in '%s' already%s: end it, or give this one another folder (--run)",
                   folder, who);
}

/* Somebody may have put another file in its place, or changed it. */
static bool is_same_file(const char *path, const struct stat *before)
{
    struct stat now;
    return stat(path, &now) == 0 && now.st_dev == before->st_dev && now.st_ino == before->st_ino &&
           now.st_mtim.tv_sec == before->st_mtim.tv_sec &&
           now.st_mtim.tv_nsec == before->st_mtim.tv_nsec;
}

int wb_cmd_rig(int argc, char **argv)
{
    struct options options = {.bench = {.seed = 1}};
    struct wb_bench *bench;
    char path[WB_PATH], rig[WB_PATH], specimen[WB_PATH];
    struct wb_file_lock lock;
    static const volatile bool never = false;
    wb_command_parse(&argp, argc, argv, &options);
    options.bench.rig = wb_command_find(options.bench.rig, rig);
    options.bench.specimen = wb_command_find(options.bench.specimen, specimen);
    wb_interrupt_install();
    wb_acquisition_raise_priority();
    if (wb_file_make_folder(options.run) != WB_OK ||
        wb_file_join(path, options.run, "rig.yaml") != WB_OK ||
        lock_folder(&lock, options.run) != WB_OK)
        return WB_EXIT_FAILED;
    if (wb_bench_open(&bench, &options.bench) != WB_OK) {
        wb_file_unlock(&lock);
        return WB_EXIT_FAILED;
    }
    struct stat written;
    enum wb_status status = wb_bench_write_rig(bench, path);
    if (status == WB_OK) {
        wb_info("virtual rig: load cell %s, motion capture %s, stage %s; rig file '%s'",
                wb_bench_address(bench, WB_ROLE_LOAD), wb_bench_address(bench, WB_ROLE_MOCAP),
                wb_bench_address(bench, WB_ROLE_STAGE), path);
        const bool known = stat(path, &written) == 0;
        fprintf(stderr, "ready\n");
        wb_bench_run(bench, &never);
        /* The addresses end with the rig: the file must not be taken for a bench's. */
        if (known && is_same_file(path, &written))
            remove(path);
    }
    wb_bench_close(bench);
    wb_file_unlock(&lock);
    return wb_command_exit(status);
}
