#include "daq/recording/foreign.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/json.h"
#include "base/memory.h"
#include "base/units.h"
#include "daq/protocol/loadcell_line.h"
#include "daq/take/take_reader.h"

#define WB_LOG_DOMAIN "import"

/* Bytes; larger files are rejected, because a file is held in memory as a whole. */
#define LARGEST_FILE ((int64_t)4 << 30)

/* --- settings --- */

char *wb_foreign_format(const struct wb_foreign *foreign)
{
    struct wb_json *const root = wb_json_create();
    wb_json_set_text(root, "file", foreign->name);
    wb_json_set_text(root, "format", foreign->format);
    wb_json_set_text(root, "sha256", foreign->sha256);
    wb_json_set_integer(root, "bytes", (int64_t)foreign->size);
    wb_json_set_number(root, "offset_s", foreign->offset);
    wb_json_set_number(root, "offset_uncertainty_s", foreign->uncertainty);
    if (foreign->channel[0])
        wb_json_set_text(root, "channel", foreign->channel);
    if (foreign->unit[0])
        wb_json_set_text(root, "unit", foreign->unit);
    if (foreign->columns[0])
        wb_json_set_text(root, "columns", foreign->columns);
    char *const text = wb_json_format(root);
    wb_json_destroy(root);
    return text;
}

static void copy_text(const struct wb_json *root, const char *key, char *to, size_t size)
{
    const char *text;
    if (wb_json_get_text(root, key, &text))
        snprintf(to, size, "%s", text);
}

enum wb_status wb_foreign_parse(struct wb_foreign *foreign, const char *text, struct wb_reason *why)
{
    struct wb_json *root;
    int64_t size = -1;
    *foreign = (struct wb_foreign){.offset = (double)NAN, .uncertainty = (double)NAN};
    WB_TRY(wb_json_parse_with_reason(&root, text, "settings of a file in the recording", why));
    copy_text(root, "file", foreign->name, sizeof foreign->name);
    copy_text(root, "format", foreign->format, sizeof foreign->format);
    copy_text(root, "sha256", foreign->sha256, sizeof foreign->sha256);
    copy_text(root, "channel", foreign->channel, sizeof foreign->channel);
    copy_text(root, "unit", foreign->unit, sizeof foreign->unit);
    copy_text(root, "columns", foreign->columns, sizeof foreign->columns);
    (void)wb_json_get_number(root, "offset_s", &foreign->offset);
    (void)wb_json_get_number(root, "offset_uncertainty_s", &foreign->uncertainty);
    (void)wb_json_get_integer(root, "bytes", &size);
    wb_json_destroy(root);
    if (size < 0 || size > LARGEST_FILE || !(fabs(foreign->offset) < 1e8))
        return wb_fail_to(why, WB_ERR_FORMAT,
                          "the settings of the file '%s' in the recording are damaged",
                          foreign->name);
    foreign->size = (size_t)size;
    return WB_OK;
}

/* --- force of a take --- */

/* Accepts the spellings of units in C3D files in addition to those of instruments. */
static bool unit_factor(const char *unit, double gravity, double *newtons)
{
    static const char *const others[] = {"nt", "newton", "newtons"};
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        if (strcasecmp(unit, others[i]) == 0) {
            *newtons = 1.0;
            return true;
        }
    }
    return wb_line_unit_factor(unit, gravity, newtons);
}

static enum wb_status choose_channel(struct wb_foreign *foreign, const struct wb_take *take,
                                     double gravity, int *chosen, struct wb_reason *why)
{
    char names[400] = "";
    double newtons;
    int n = 0;
    *chosen = -1;
    for (int i = 0; i < take->n_channels; i++) {
        const struct wb_take_channel *const channel = &take->channels[i];
        if (foreign->channel[0] ? strcmp(channel->name, foreign->channel) == 0
                                : unit_factor(channel->unit, gravity, &newtons)) {
            *chosen = i;
            n++;
        }
        const size_t used = strlen(names);
        snprintf(names + used, sizeof names - used, "%s%s (%s)", i ? ", " : "", channel->name,
                 channel->unit);
    }
    if (n == 1)
        return WB_OK;
    return wb_fail_to(why, WB_ERR_DATA,
                      "%s: %d analogue channels could be the force, expected 1: choose one with "
                      "--channel NAME; the file has %s",
                      foreign->name, n, names[0] ? names : "none");
}

enum wb_status wb_foreign_channel(struct wb_foreign *foreign, const struct wb_take *take,
                                  const struct wb_rig *rig, struct wb_force_table *force,
                                  struct wb_reason *why)
{
    int channel;
    double newtons;
    memset(force, 0, sizeof *force);
    WB_TRY(choose_channel(foreign, take, rig->gravity, &channel, why));
    snprintf(foreign->channel, sizeof foreign->channel, "%s", take->channels[channel].name);
    if (!foreign->unit[0])
        snprintf(foreign->unit, sizeof foreign->unit, "%s", take->channels[channel].unit);
    if (!unit_factor(foreign->unit, rig->gravity, &newtons))
        return wb_fail_to(
            why, WB_ERR_DATA,
            "%s: the unit '%s' of channel '%s' is not a unit of force: give the unit, "
            "for example --channel NAME:mN",
            foreign->name, foreign->channel, foreign->unit);
    const size_t per_frame = (size_t)take->per_frame;
    const size_t n = take->n_frames * per_frame;
    force->t = wb_memory_new(n, sizeof *force->t);
    force->force = wb_memory_new(n, sizeof *force->force);
    for (size_t i = 0; i < n; i++) {
        const double part = (double)(i % per_frame) / (double)per_frame;
        const double value = (double)take->analog[i * (size_t)take->n_channels + (size_t)channel];
        if (!isfinite(value)) {
            force->skipped_rows++;
            continue;
        }
        force->t[force->n] = take->frames[i / per_frame].t + part / take->rate;
        force->force[force->n++] = rig->load_cell.sign * newtons * value;
    }
    return WB_OK;
}

/* --- samples --- */

static void deliver_take(const struct wb_foreign *foreign, const struct wb_take *take,
                         const struct wb_sink *sink)
{
    size_t left = 0;
    struct wb_mocap_frame *const frame = wb_memory_new(1, sizeof *frame);
    for (size_t i = 0; sink->mocap && i < take->n_frames; i++) {
        left += wb_take_frame_at(take, i, frame);
        frame->t_ns = wb_ns_from_seconds(take->frames[i].t + foreign->offset);
        sink->mocap(sink->context, frame);
    }
    free(frame);
    if (left > 0)
        wb_driver_remark(sink, WB_LOG_WARNING, 0, "refused",
                         "%zu markers beyond the first %d of a frame are ignored", left,
                         WB_MAX_MARKERS);
}

static void deliver_force(const struct wb_foreign *foreign, const struct wb_force_table *force,
                          const struct wb_sink *sink)
{
    for (size_t i = 0; sink->load && i < force->n; i++) {
        const struct wb_load_sample sample = {
            .t_ns = wb_ns_from_seconds(force->t[i] + foreign->offset),
            .index = i,
            .force = force->force[i],
            .valid = true,
        };
        sink->load(sink->context, &sample);
    }
}

static enum wb_status play_take(const struct wb_foreign *foreign, const uint8_t *bytes,
                                const struct wb_rig *rig, const struct wb_sink *sink,
                                struct wb_reason *why)
{
    const struct wb_take_reader *const reader = wb_take_reader_find(foreign->format);
    struct wb_take take;
    if (!reader)
        return wb_fail_to(why, WB_ERR_UNSUPPORTED, "the file '%s' has the unknown format '%s'",
                          foreign->name, foreign->format);
    WB_TRY(reader->read(&take, foreign->name, bytes, foreign->size, why));
    enum wb_status status = WB_OK;
    deliver_take(foreign, &take, sink);
    if (foreign->channel[0]) {
        struct wb_foreign copy = *foreign;
        struct wb_force_table force;
        status = wb_foreign_channel(&copy, &take, rig, &force, why);
        if (status == WB_OK) {
            deliver_force(foreign, &force, sink);
            wb_force_table_release(&force);
        }
    }
    wb_take_release(&take);
    return status;
}

enum wb_status wb_foreign_play(const struct wb_foreign *foreign, const uint8_t *bytes,
                               const struct wb_rig *rig, const struct wb_sink *sink,
                               struct wb_reason *why)
{
    if (strcmp(foreign->format, WB_FOREIGN_FORCE_TABLE) != 0)
        return play_take(foreign, bytes, rig, sink, why);
    char taken[WB_FORCE_TABLE_LIST];
    struct wb_force_table force;
    WB_TRY(wb_force_table_parse(&force, foreign->name, bytes, foreign->size, foreign->columns,
                                taken, rig, why));
    deliver_force(foreign, &force, sink);
    wb_force_table_release(&force);
    return WB_OK;
}
