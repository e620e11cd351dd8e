/* Options of the commands `stage`, `rig`, `record --virtual` and `replay`, as tables of settings.
 */
#ifndef WB_CLI_BENCH_OPTIONS_H
#define WB_CLI_BENCH_OPTIONS_H

#include <stdbool.h>

#include "base/setting.h"
#include "cli/command.h"
#include "daq/acquire/sequence.h"
#include "daq/acquire/stage_job.h"
#include "fixtures/virtual/bench.h"

struct wb_stage_options {
    struct wb_command_common common;
    const char *rig_path, *action, *value;
    struct wb_stage_job_request job;
    double seconds;     /* s, averaging time of `stage check` */
    double tolerance;   /* fraction; 0: that of the rig file */
    const char *masses; /* of `stage check`, in g, separated by commas; NULL: the rig file's */
};

struct wb_virtual_version {
    int major, minor; /* of NatNet, the protocol of the motion capture */
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
    const char *run; /* folder that receives the rig file */
};

struct wb_replay_options {
    struct wb_command_common common;
    double rate; /* 0: as fast as possible */
};

/* The command `rig` uses the tables _rig and _virtual together. */
extern const struct wb_setting_table wb_bench_options_stage, wb_bench_options_rig,
    wb_bench_options_virtual, wb_bench_options_replay;

/* wb_bench_options_default() fills in the defaults; wb_bench_options_complete() must be called
 * after parsing: it sets seed and protocol version in `bench`. */
void wb_bench_options_default(struct wb_virtual_options *options);
void wb_bench_options_complete(struct wb_virtual_options *options);

/* "done", "still_loaded": how a test or job ended, as in the JSON of these commands. */
const char *wb_bench_options_end_name(enum wb_sequence_end end);

#endif
