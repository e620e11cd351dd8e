#include "cli/bench_options.h"

#include <math.h>
#include <stddef.h>

#include "base/units.h"
#include "fixtures/virtual/composite.h"

#define STAGE_AT(member) offsetof(struct wb_stage_options, member)
#define RIG_AT(member) offsetof(struct wb_rig_options, member)
#define VIRTUAL_AT(member) offsetof(struct wb_virtual_options, member)

static const struct wb_setting stage_rows[] = {
    {.name = "speed_mm_s",
     .unit = "mm/s",
     .type = WB_SETTING_NUMBER,
     .offset = STAGE_AT(job.speed),
     .scale = WB_MM,
     .least = 1e-3,
     .largest = 1e3,
     .otherwise = "the rig's; of release half of it",
     .option = "speed-mm-s",
     .argument = "V",
     .help = "Speed of jog and release"},
    {.name = "zero_mn",
     .unit = "mN",
     .type = WB_SETTING_NUMBER,
     .offset = STAGE_AT(job.zero),
     .scale = WB_MN,
     .least = -1e6,
     .largest = 1e6,
     .fallback = (double)NAN,
     .otherwise = "not known",
     .option = "zero-mn",
     .argument = "F",
     .help = "What the load cell reads with a slack strand, for release"},
    {.name = "without_load_cell",
     .type = WB_SETTING_BOOLEAN,
     .offset = STAGE_AT(job.without_load_cell),
     .option = "without-load-cell",
     .help = "Home or jog blindly, with the load cell not connected"},
    {.name = "seconds",
     .unit = "s",
     .type = WB_SETTING_NUMBER,
     .offset = STAGE_AT(seconds),
     .least = 0.2,
     .largest = 3600.0,
     .fallback = 5.0,
     .option = "seconds",
     .argument = "T",
     .help = "How long check averages under each mass, and without one"},
    {.name = "tolerance_percent",
     .unit = "%",
     .type = WB_SETTING_NUMBER,
     .offset = STAGE_AT(tolerance),
     .scale = WB_PERCENT,
     .least = 1e-3,
     .largest = 100.0,
     .otherwise = "the rig's check_tolerance_percent",
     .option = "tolerance-percent",
     .argument = "P",
     .help = "Largest deviation of check"},
    {.name = "masses",
     .type = WB_SETTING_TEXT,
     .offset = STAGE_AT(masses),
     .otherwise = "the rig's check_masses_g",
     .option = "masses",
     .argument = "LIST",
     .help = "Masses in g that check asks for one after another, such as 0,5,10,20,10,5,0"},
};

const struct wb_setting_table wb_bench_options_stage = {.rows = stage_rows,
                                                        .n = WB_COUNT(stage_rows)};

static const struct wb_setting version_rows[] = {
    {.name = "major", .type = WB_SETTING_INTEGER, .offset = 0, .least = 2, .largest = 4},
    {.name = "minor",
     .type = WB_SETTING_INTEGER,
     .offset = VIRTUAL_AT(version.minor) - VIRTUAL_AT(version.major),
     .least = 0,
     .largest = 99},
};
static const struct wb_setting_table version_table = {.rows = version_rows,
                                                      .n = WB_COUNT(version_rows)};

static const struct wb_setting lost_steps_rows[] = {
    {.name = "lost_steps_mm",
     .unit = "mm",
     .type = WB_SETTING_NUMBER,
     .offset = offsetof(struct wb_bench_settings, lost_steps),
     .scale = WB_MM,
     .least = 0.0,
     .largest = 100.0},
    {.name = "lost_at_mm",
     .unit = "mm",
     .type = WB_SETTING_NUMBER,
     .offset = offsetof(struct wb_bench_settings, lost_at),
     .scale = WB_MM,
     .least = 0.0,
     .largest = 5000.0},
};
static const struct wb_setting_table lost_steps_table = {.rows = lost_steps_rows,
                                                         .n = WB_COUNT(lost_steps_rows)};

static const struct wb_setting virtual_rows[] = {
    {.name = "seed",
     .type = WB_SETTING_INTEGER,
     .offset = VIRTUAL_AT(seed),
     .least = 0,
     .largest = 1e9,
     .fallback = 1,
     .option = "seed",
     .argument = "N",
     .help = "Seed of specimen, truth and noise"},
    {.name = "natnet_version",
     .type = WB_SETTING_LIST,
     .offset = VIRTUAL_AT(version),
     .otherwise = "3.0",
     .option = "natnet-version",
     .argument = "M.N",
     .help = "Protocol of the motion capture, 2.5 to 4.4; M",
     .separator = '.',
     .members = &version_table,
     .given = VIRTUAL_AT(has_version)},
    {.name = "wire_law",
     .type = WB_SETTING_CHOICE,
     .offset = VIRTUAL_AT(bench.variant),
     .choices = wb_composite_variant_names,
     .option = "wire-law",
     .argument = "NAME",
     .help = "What the wire is made of, to try a calibration on"},
    {.name = "lost_steps",
     .type = WB_SETTING_LIST,
     .offset = VIRTUAL_AT(bench),
     .otherwise = "none",
     .option = "lost-steps",
     .argument = "MM@MM",
     .help = "The stage loses so many mm once it is so many mm down (up to 5000), such as 0.8@20; "
             "lost",
     .separator = '@',
     .members = &lost_steps_table,
     .given = VIRTUAL_AT(has_lost_steps)},
    {.name = "faults",
     .type = WB_SETTING_TEXT,
     .offset = VIRTUAL_AT(bench.faults),
     .otherwise = "none",
     .option = "faults",
     .argument = "LIST",
     .help = "What is wrong with the bench, such as loss=5,wrong-up: names and values are in the "
             "manual"},
};

const struct wb_setting_table wb_bench_options_virtual = {.rows = virtual_rows,
                                                          .n = WB_COUNT(virtual_rows)};

static const struct wb_setting rig_rows[] = {
    {.name = "specimen",
     .type = WB_SETTING_TEXT,
     .offset = RIG_AT(virtual.bench.specimen),
     .option = "specimen",
     .argument = "SPECIMEN.yaml",
     .help = "The piece of wire to put on the rig"},
    {.name = "run",
     .type = WB_SETTING_TEXT,
     .offset = RIG_AT(run),
     .option = "run",
     .argument = "DIR",
     .help = "Folder that receives rig.yaml, the rig file for `record`"},
    {.name = "time_scale",
     .type = WB_SETTING_NUMBER,
     .offset = RIG_AT(virtual.bench.time_scale),
     .least = 0.05,
     .largest = 50.0,
     .fallback = 1.0,
     .option = "time-scale",
     .argument = "X",
     .help = "Let all clocks, filters and drifts run X times as fast"},
    {.name = "natnet_port",
     .type = WB_SETTING_INTEGER,
     .offset = RIG_AT(virtual.bench.natnet_port),
     .least = 0,
     .largest = 65535,
     .option = "natnet-port",
     .argument = "N",
     .help = "UDP port of the motion capture; 0 is a free one"},
    {.name = "multicast",
     .type = WB_SETTING_BOOLEAN,
     .offset = RIG_AT(virtual.bench.multicast),
     .option = "multicast",
     .help = "Let the motion capture stream to a multicast group on the loopback"},
};

const struct wb_setting_table wb_bench_options_rig = {.rows = rig_rows, .n = WB_COUNT(rig_rows)};

static const struct wb_setting replay_rows[] = {
    {.name = "rate",
     .type = WB_SETTING_NUMBER,
     .offset = offsetof(struct wb_replay_options, rate),
     .least = 1e-3,
     .largest = 1e6,
     .zero = "max",
     .fallback = 1.0,
     .option = "rate",
     .argument = "1|N|max",
     .help = "Speed: 1 as recorded, N times, or as fast as it goes"},
};

const struct wb_setting_table wb_bench_options_replay = {.rows = replay_rows,
                                                         .n = WB_COUNT(replay_rows)};

void wb_bench_options_default(struct wb_virtual_options *options)
{
    *options = (struct wb_virtual_options){.seed = 0};
    wb_setting_fill(&wb_bench_options_virtual, options);
}

void wb_bench_options_complete(struct wb_virtual_options *options)
{
    options->bench.seed = (uint64_t)options->seed;
    options->bench.natnet = (struct wb_natnet_version){(uint8_t)options->version.major,
                                                       (uint8_t)options->version.minor};
}
