/* wirebench rig: runs the virtual rig until it is interrupted. */
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

#include "base/file.h"
#include "base/interrupt.h"
#include "cli/bench_options.h"
#include "cli/file_kind.h"
#include "cli/settings.h"
#include "daq/acquire/acquisition.h"

#define WB_LOG_DOMAIN "rig"

static const struct argp_option other_options[] = {{0}};

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct wb_rig_options *const options = state->input;
    if (key == ARGP_KEY_END && !options->virtual.bench.specimen)
        argp_error(state, "--specimen SPECIMEN.yaml is missing");
    if (key == ARGP_KEY_END && !options->run)
        argp_error(state, "folder for the rig file missing: --run DIR");
    return wb_command_parse_common(key, argument, state);
}

static const struct argp argp = {
    .options = other_options,
    .parser = parse,
    .args_doc = "RIG.yaml --specimen SPECIMEN.yaml --run DIR",
    .doc =
        "The virtual rig: simulates the bench of RIG.yaml, with load cell and stage on "
        "pseudo-terminals and the motion capture on a free UDP port of this machine.\v"
        "When it is ready it writes DIR/rig.yaml, the rig file for `wirebench record`, prints "
        "'ready', and runs until Ctrl-C. Several rigs can run at once. RIG.yaml gives protocols, "
        "capacity, noise, filter, frame rate, stage and strand; its addresses are not used. The "
        "same seed and specimen give the same wire and the same noise.\n\n"
        "Exit codes: 0 ended by Ctrl-C; 1 a file cannot be used, or the folder is in use; 2 wrong "
        "usage.",
};

static const struct wb_settings_source sources[] = {
    {.tables = &wb_bench_options_rig, .n_tables = 1},
    {.tables = &wb_bench_options_virtual,
     .n_tables = 1,
     .offset = offsetof(struct wb_rig_options, virtual)},
};

static const struct wb_settings_command command = {
    .argp = &argp, .sources = sources, .n_sources = WB_COUNT(sources), .place = 1};

/* One rig a folder: a second one would replace the rig file of the first and later remove it.
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
                   "a rig is already running in '%s'%s: end it, or choose another folder (--run)",
                   folder, who);
}

/* Another process may have replaced or changed the file. */
static bool is_same_file(const char *path, const struct stat *before)
{
    struct stat now;
    return stat(path, &now) == 0 && now.st_dev == before->st_dev && now.st_ino == before->st_ino &&
           now.st_mtim.tv_sec == before->st_mtim.tv_sec &&
           now.st_mtim.tv_nsec == before->st_mtim.tv_nsec;
}

int wb_cmd_rig(int argc, char **argv)
{
    struct wb_rig_options options = {.common = {.noun = "rig file"}};
    struct wb_bench *bench;
    char path[WB_PATH], rig[WB_PATH], specimen[WB_PATH];
    struct wb_file_lock lock;
    static const volatile bool never = false;
    wb_bench_options_default(&options.virtual);
    wb_setting_fill(&wb_bench_options_rig, &options);
    wb_settings_parse(&command, argc, argv, &options);
    wb_bench_options_complete(&options.virtual);
    struct wb_bench_settings *const settings = &options.virtual.bench;
    settings->rig = options.common.input;
    settings->folder = options.run;
    if (wb_file_kind_find_input(&settings->rig, rig, WB_FILE_BIT(WB_FILE_RIG)) != WB_OK ||
        wb_file_kind_find_input(&settings->specimen, specimen, WB_FILE_SPECIMENS) != WB_OK)
        return WB_EXIT_FAILED;
    wb_interrupt_install();
    wb_acquisition_raise_priority();
    if (wb_file_make_folder(options.run) != WB_OK ||
        wb_file_join(path, options.run, "rig.yaml") != WB_OK ||
        lock_folder(&lock, options.run) != WB_OK)
        return WB_EXIT_FAILED;
    if (wb_bench_open(&bench, settings) != WB_OK) {
        wb_file_unlock(&lock);
        return WB_EXIT_FAILED;
    }
    struct stat written;
    const enum wb_status status = wb_bench_write_rig(bench, path);
    if (status == WB_OK) {
        wb_info("virtual rig: load cell %s, motion capture %s, stage %s; rig file '%s'",
                wb_bench_address(bench, WB_ROLE_LOAD), wb_bench_address(bench, WB_ROLE_MOCAP),
                wb_bench_address(bench, WB_ROLE_STAGE), path);
        const bool known = stat(path, &written) == 0;
        fprintf(stderr, "ready\n");
        wb_bench_run(bench, &never);
        /* Its addresses are invalid from now on. */
        if (known && is_same_file(path, &written))
            remove(path);
    }
    wb_bench_close(bench);
    wb_file_unlock(&lock);
    return wb_command_exit(status);
}
