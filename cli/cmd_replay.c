/* wirebench replay: plays a recording through the decoders. */
#include <inttypes.h>
#include <stdio.h>

#include "base/interrupt.h"
#include "base/timing.h"
#include "base/units.h"
#include "cli/bench_options.h"
#include "cli/file_kind.h"
#include "cli/live_line.h"
#include "cli/settings.h"
#include "daq/acquire/acquisition.h"
#include "daq/recording/replay.h"
#include "daq/recording/survey.h"

#define WB_LOG_DOMAIN "replay"

static const struct argp_option other_options[] = {
    {"json", WB_KEY_JSON, NULL, 0, "Print one JSON object at the end"},
    {0},
};

static const struct argp argp = {
    .options = other_options,
    .parser = wb_command_parse_common,
    .args_doc = "REC.wbr",
    .doc = "Plays a recording (.wbr or .wbr.zst): the recorded bytes pass the same decoders as on "
           "the bench, with a live line of force, travel and markers on the terminal; at the end "
           "the numbers of decoded samples are printed.\v"
           "Ctrl-C stops it. Exit code 3: interrupted, or parts are missing or damaged.",
};

/* The latest sample of each channel, for the live line. */
struct player {
    bool is_virtual, started;
    int64_t first_ns, last_ns;
    bool has_force, has_travel, has_frame;
    double force, travel_start, travel, gravity;
    int down, markers;
};

static void show(struct player *player, int64_t t_ns)
{
    if (!player->started) {
        player->started = true;
        player->first_ns = t_ns;
    }
    player->last_ns = t_ns;
    if (!wb_live_line_due())
        return;
    char force[64] = "-- mN", travel[48] = "travel --", markers[32] = "markers --";
    if (player->has_force)
        snprintf(force, sizeof force, "%.2f mN %.2f g", player->force / WB_MN,
                 player->force / player->gravity / WB_G);
    if (player->has_travel)
        snprintf(travel, sizeof travel, "travel %.1f mm",
                 (player->travel - player->travel_start) * player->down / WB_MM);
    if (player->has_frame)
        snprintf(markers, sizeof markers, "markers %d", player->markers);
    wb_live_line_show("%sreplay %.1f s  %s  %s  %s", player->is_virtual ? "virtual rig: " : "",
                      wb_survey_seconds(player->first_ns, t_ns), force, travel, markers);
}

static void take_load(void *context, const struct wb_load_sample *sample)
{
    struct player *player = context;
    if (sample->valid) {
        player->has_force = true;
        player->force = sample->force;
    }
    show(player, sample->t_ns);
}

static void take_mocap(void *context, const struct wb_mocap_frame *frame)
{
    struct player *player = context;
    player->has_frame = true;
    player->markers = 0;
    for (int i = 0; i < frame->n_markers; i++)
        player->markers += wb_acquisition_marker_measured(&frame->markers[i]);
    show(player, frame->t_ns);
}

static void take_stage(void *context, const struct wb_stage_report *report)
{
    struct player *player = context;
    if (report->position == report->position) { /* not NaN */
        if (!player->has_travel)
            player->travel_start = report->position;
        player->has_travel = true;
        player->travel = report->position;
    }
    show(player, report->t_ns);
}

static void take_remark(void *context, enum wb_log_level level, int64_t t_ns, const char *kind,
                        const char *text)
{
    const struct player *player = context;
    wb_log(level, WB_LOG_DOMAIN, "%.3f s: %s: %s",
           player->started ? wb_survey_seconds(player->first_ns, t_ns) : 0.0, kind, text);
}

static void print(const struct wb_replay_options *options, const struct player *player,
                  const struct wb_replay_counts *counts, double wall_s)
{
    double duration_s = wb_survey_seconds(player->first_ns, player->last_ns);
    if (!options->common.json) {
        printf("%s: %s%.1f s, %" PRIu64 " chunks, %" PRIu64 " load readings, %" PRIu64
               " mocap frames, %" PRIu64 " stage reports, %" PRIu64 " damaged chunks\n",
               options->common.input, player->is_virtual ? "virtual rig, " : "", duration_s,
               counts->chunks, counts->load_samples, counts->mocap_frames, counts->stage_reports,
               counts->damaged_chunks);
        return;
    }
    struct wb_json *root = wb_json_create();
    wb_json_set_text(root, "recording", options->common.input);
    wb_json_set_boolean(root, "virtual_rig", player->is_virtual);
    wb_json_set_integer(root, "chunks", (int64_t)counts->chunks);
    wb_json_set_integer(root, "damaged_chunks", (int64_t)counts->damaged_chunks);
    wb_json_set_integer(root, "bytes", (int64_t)counts->bytes);
    wb_json_set_integer(root, "load_readings", (int64_t)counts->load_samples);
    wb_json_set_integer(root, "mocap_frames", (int64_t)counts->mocap_frames);
    wb_json_set_integer(root, "stage_reports", (int64_t)counts->stage_reports);
    wb_json_set_number(root, "duration_s", duration_s);
    wb_json_set_number(root, "wall_s", wall_s);
    wb_json_set_boolean(root, "interrupted", wb_interrupted());
    wb_command_print_json(root);
}

static enum wb_status play(struct wb_recording *recording, const struct wb_replay_options *options,
                           struct player *player, struct wb_replay_counts *counts)
{
    struct wb_rig rig;
    WB_TRY(wb_replay_rig(recording, &rig));
    player->is_virtual = rig.is_virtual;
    player->down = rig.stage.down;
    player->gravity = rig.gravity;
    const struct wb_sink sink = {.context = player,
                                 .load = take_load,
                                 .mocap = take_mocap,
                                 .stage = take_stage,
                                 .remark = options->rate > 0.0 ? take_remark : NULL};
    if (options->rate > 0.0)
        wb_live_line_open();
    enum wb_status status = wb_replay_run(recording, &rig, &sink, options->rate, counts);
    wb_live_line_close();
    return status;
}

int wb_cmd_replay(int argc, char **argv)
{
    struct wb_replay_options options = {.common = {.noun = "recording"}};
    struct wb_recording *recording = NULL;
    struct player player = {.started = false};
    struct wb_replay_counts counts = {0};
    wb_setting_fill(&wb_bench_options_replay, &options);
    wb_settings_parse_table(&argp, &wb_bench_options_replay, &options, 1, argc, argv, &options);
    wb_interrupt_install();
    if (wb_file_kind_check(options.common.input, WB_FILE_BIT(WB_FILE_RECORDING)) != WB_OK ||
        wb_recording_open(&recording, options.common.input) != WB_OK)
        return WB_EXIT_FAILED;
    bool complete = wb_recording_is_complete(recording);
    int64_t started_ns = wb_time_now_ns();
    enum wb_status status = play(recording, &options, &player, &counts);
    double wall_s = wb_seconds_from_ns(wb_time_now_ns() - started_ns);
    if (wb_recording_close(recording) != WB_OK)
        return WB_EXIT_FAILED;
    /* A truncated database is replayed up to its end. */
    if (status != WB_OK && !(status == WB_ERR_DATA && counts.chunks > 0))
        return WB_EXIT_FAILED;
    print(&options, &player, &counts, wall_s);
    bool whole = status == WB_OK && complete && counts.damaged_chunks == 0 && !wb_interrupted();
    return whole ? WB_EXIT_OK : WB_EXIT_INCOMPLETE;
}
