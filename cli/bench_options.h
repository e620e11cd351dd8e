/* Options of the commands for the bench, its recordings and the virtual rig, as rows of settings.
 */
#ifndef WB_CLI_BENCH_OPTIONS_H
#define WB_CLI_BENCH_OPTIONS_H

#include <stdbool.h>

#include "base/setting.h"
#include "cli/command.h"
#include "daq/acquire/stage_job.h"
#include "fixtures/virtual/bench.h"

struct wb_stage_options {
    struct wb_command_common common;
    const char *rig_path, *action, *value;
    struct wb_stage_job_request job;
    double seconds;     /* averaging time of a check */
    double tolerance;   /* fraction; 0: the rig's */
    const char *masses; /* of a check's series, in g between commas; NULL: the rig's */
};

struct wb_virtual_version {
    int major, minor; /* of the motion capture's protocol */
};

/* Options of a virtual bench, shared by `rig` and `record --virtual`. */
struct wb_virtual_options {
    struct wb_bench_settings bench;
    int seed;
    bool has_version, has_lost_steps;
    struct wb_virtual_version version; /* if has_version */
};

struct wb_rig_options {
    struct wb_command_common common;
    struct wb_virtual_options virtual;
    const char *run; /* folder of the rig file */
};

struct wb_replay_options {
    struct wb_command_common common;
    double rate; /* 0: as fast as possible */
};

/* `rig` has the rows of struct wb_rig_options beside those of `virtual`. */
extern const struct wb_setting_table wb_bench_options_stage, wb_bench_options_rig,
    wb_bench_options_virtual, wb_bench_options_replay;

/* Fills in the defaults; after parsing, sets the bench's settings from the options. */
void wb_bench_options_default(struct wb_virtual_options *options);
void wb_bench_options_complete(struct wb_virtual_options *options);

#endif
