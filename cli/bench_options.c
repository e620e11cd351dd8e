#include "cli/bench_options.h"

#include <math.h>
#include <stddef.h>

#include "base/units.h"
#include "fixtures/virtual/composite.h"

static const struct wb_setting stage_rows[] = {
    {WB_ROW_QUANTITY(wb_stage_options, job.speed, "speed_mm_s", "mm/s", WB_MM, 1e-3, 1e3, 0.0),
     WB_ROW_OPTION("speed-mm-s", "V", "Speed of jog and release"),
     .otherwise = "the rig's; of release half of it"},
    {WB_ROW_QUANTITY(wb_stage_options, job.zero, "zero_mn", "mN", WB_MN, -1e6, 1e6, (double)NAN),
     WB_ROW_OPTION("zero-mn", "F", "Load cell reading with a slack strand, for release"),
     .otherwise = "not known"},
    {WB_ROW_BOOLEAN(wb_stage_options, job.without_load_cell, "without_load_cell", false),
     WB_ROW_OPTION("without-load-cell", NULL, "Home or jog with the load cell not connected")},
    {WB_ROW_QUANTITY(wb_stage_options, seconds, "seconds", "s", 1.0, 0.2, 3600.0, 5.0),
     WB_ROW_OPTION("seconds", "T", "Averaging time of check, under each mass and without one")},
    {WB_ROW_QUANTITY(wb_stage_options, tolerance, "tolerance_percent", "%", WB_PERCENT, 1e-3, 100.0,
                     0.0),
     WB_ROW_OPTION("tolerance-percent", "P", "Largest deviation of check"),
     .otherwise = "the rig's check_tolerance_percent"},
    {WB_ROW_TEXT(wb_stage_options, masses, "masses"),
     WB_ROW_OPTION("masses", "LIST", "Series of masses in g for check, such as 0,5,10,20,10,5,0"),
     .otherwise = "the rig's check_masses_g"},
};

const struct wb_setting_table wb_bench_options_stage = {WB_SETTING_ROWS(stage_rows)};

static const struct wb_setting version_rows[] = {
    {WB_ROW_INTEGER(wb_virtual_version, major, "major", 2, 4, 0)},
    {WB_ROW_INTEGER(wb_virtual_version, minor, "minor", 0, 99, 0)},
};
static const struct wb_setting_table version_table = {WB_SETTING_ROWS(version_rows)};

static const struct wb_setting lost_steps_rows[] = {
    {WB_ROW_QUANTITY(wb_bench_settings, lost_steps, "lost_steps_mm", "mm", WB_MM, 0.0, 100.0, 0.0)},
    {WB_ROW_QUANTITY(wb_bench_settings, lost_at, "lost_at_mm", "mm", WB_MM, 0.0, 5000.0, 0.0)},
};
static const struct wb_setting_table lost_steps_table = {WB_SETTING_ROWS(lost_steps_rows)};

static const struct wb_setting virtual_rows[] = {
    {WB_ROW_INTEGER(wb_virtual_options, seed, "seed", 0, 1e9, -1),
     WB_ROW_OPTION("seed", "N", "Seed of specimen, truth and noise"),
     .otherwise = "the specimen's sample"},
    {WB_ROW_LIST(wb_virtual_options, version, "natnet_version", version_table, has_version),
     WB_ROW_OPTION("natnet-version", "M.N", "Protocol of the motion capture, 2.5 to 4.4; M"),
     .otherwise = "3.0", .separator = '.'},
    {WB_ROW_CHOICE(wb_virtual_options, bench.variant, "wire_law", wb_composite_variant_names, 0),
     WB_ROW_OPTION("wire-law", "NAME", "Material law of the wire")},
    {WB_ROW_LIST(wb_virtual_options, bench, "lost_steps", lost_steps_table, has_lost_steps),
     WB_ROW_OPTION("lost-steps", "MM@MM",
                   "Travel lost by the stage, and the downward travel (up to 5000) at which it is "
                   "lost, such as 0.8@20; lost"),
     .otherwise = "none", .separator = '@'},
    {WB_ROW_TEXT(wb_virtual_options, bench.faults, "faults"),
     WB_ROW_OPTION(
         "faults", "LIST",
         "Faults of the bench, such as loss=5,wrong-up; the manual lists their names and values"),
     .otherwise = "none"},
};

const struct wb_setting_table wb_bench_options_virtual = {WB_SETTING_ROWS(virtual_rows)};

static const struct wb_setting rig_rows[] = {
    {WB_ROW_TEXT(wb_rig_options, virtual.bench.specimen, "specimen"),
     WB_ROW_OPTION("specimen", "SPECIMEN.yaml", "Specimen to put on the rig")},
    {WB_ROW_TEXT(wb_rig_options, run, "run"),
     WB_ROW_OPTION("run", "DIR", "Folder that receives rig.yaml, the rig file for `record`")},
    {WB_ROW_NUMBER(wb_rig_options, virtual.bench.time_scale, "time_scale", 0.05, 50.0, 1.0),
     WB_ROW_OPTION("time-scale", "X", "Run all clocks, filters and drifts X times as fast")},
    {WB_ROW_INTEGER(wb_rig_options, virtual.bench.natnet_port, "natnet_port", 0, 65535, 0),
     WB_ROW_OPTION("natnet-port", "N", "UDP port of the motion capture; 0: any free port")},
    {WB_ROW_BOOLEAN(wb_rig_options, virtual.bench.multicast, "multicast", false),
     WB_ROW_OPTION("multicast", NULL,
                   "Stream the motion capture to a multicast group on the loopback")},
};

const struct wb_setting_table wb_bench_options_rig = {WB_SETTING_ROWS(rig_rows)};

static const struct wb_setting replay_rows[] = {
    {WB_ROW_NUMBER(wb_replay_options, rate, "rate", 1e-3, 1e6, 1.0),
     WB_ROW_OPTION("rate", "1|N|max", "Speed: 1 as recorded, N times as fast, or without waiting"),
     .zero = "max"},
};

const struct wb_setting_table wb_bench_options_replay = {WB_SETTING_ROWS(replay_rows)};

void wb_bench_options_default(struct wb_virtual_options *options)
{
    *options = (struct wb_virtual_options){.seed = 0};
    wb_setting_fill(&wb_bench_options_virtual, options);
}

const char *wb_bench_options_end_name(enum wb_sequence_end end)
{
    static const char *const names[] = {
        [WB_SEQUENCE_RUNNING] = "running",
        [WB_SEQUENCE_DONE] = "done",
        [WB_SEQUENCE_LIMIT] = "limit",
        [WB_SEQUENCE_INTERRUPTED] = "interrupted",
        [WB_SEQUENCE_STILL_LOADED] = "still_loaded",
        [WB_SEQUENCE_FAILED] = "failed",
    };
    return names[end];
}

void wb_bench_options_complete(struct wb_virtual_options *options)
{
    options->bench.seed = options->seed < 0 ? WB_BENCH_SEED_OF_SAMPLE : (uint64_t)options->seed;
    options->bench.natnet = (struct wb_natnet_version){(uint8_t)options->version.major,
                                                       (uint8_t)options->version.minor};
}
