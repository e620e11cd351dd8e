#include "live/live_events.h"

#include <math.h>
#include <stdlib.h>

#include "base/json.h"
#include "base/log.h"
#include "base/units.h"

/* Appends an event with a JSON document as data, and destroys the document. The document is written
 * on one line, because each line of an event needs the name of its field. */
static void append_document(struct wb_text *text, const char *name, struct wb_json *root)
{
    char *const json = wb_json_format(root);
    for (char *at = json; *at; at++)
        if (*at == '\n')
            *at = ' ';
    wb_text_append(text, "event: %s\ndata: %s\n\n", name, json);
    free(json);
    wb_json_destroy(root);
}

static void append_plan(struct wb_text *text, const struct wb_live_plan *plan)
{
    struct wb_json *const root = wb_json_create();
    wb_json_set_text(root, "title", plan->title);
    wb_json_set_boolean(root, "virtual_rig", plan->is_virtual);
    wb_json_set_number(root, "length_mm", plan->length / WB_MM);
    wb_json_set_number(root, "travel_mm", plan->travel / WB_MM);
    wb_json_set_number(root, "travel_limit_mm", plan->travel_limit / WB_MM);
    wb_json_set_number(root, "force_limit_mN", plan->force_limit / WB_MN);
    struct wb_json *const deflection = wb_json_set_array(root, "predicted_deflection_mm");
    struct wb_json *const tension = wb_json_set_array(root, "predicted_force_mN");
    for (int i = 0; i < plan->n_predicted; i++) {
        wb_json_append_number(deflection, plan->deflection[i] / WB_MM);
        wb_json_append_number(tension, plan->tension[i] / WB_MN);
    }
    append_document(text, "plan", root);
}

static void set_streams(struct wb_json *root, const struct wb_live_frame *frame)
{
    static const char *const names[WB_INTERLOCK_ROLES] = {
        [WB_ROLE_LOAD] = "load_cell", [WB_ROLE_MOCAP] = "cameras", [WB_ROLE_STAGE] = "stage"};
    for (int role = 0; role < WB_INTERLOCK_ROLES; role++) {
        const struct wb_live_frame_stream *const stream = &frame->stream[role];
        struct wb_json *const object = wb_json_set_object(root, names[role]);
        wb_json_set_text(object, "state",
                         stream->is_gone                          ? "went away"
                         : stream->is_lost                        ? "silent"
                         : !stream->is_ready                      ? "waited for"
                         : stream->is_losing || stream->drops > 0 ? "losing"
                                                                  : "good");
        wb_json_set_number(object, "rate_Hz", stream->rate);
        wb_json_set_integer(object, "samples", (int64_t)stream->samples);
        wb_json_set_integer(object, "gaps", (int64_t)stream->gaps);
        wb_json_set_integer(object, "missing", (int64_t)stream->missing);
        wb_json_set_integer(object, "drops", (int64_t)stream->drops);
    }
}

static void set_markers(struct wb_json *root, const struct wb_live_frame *frame)
{
    struct wb_json *const markers = wb_json_set_array(root, "markers");
    for (int i = 0; frame->are_markers_found && i < frame->n_markers; i++) {
        struct wb_json *const marker = wb_json_append_object(markers);
        wb_json_set_number(marker, "x_mm", (double)frame->marker[i][0] / WB_MM);
        wb_json_set_number(marker, "y_mm", (double)frame->marker[i][1] / WB_MM);
        wb_json_set_boolean(marker, "seen", frame->seen >> i & 1u);
    }
}

static void append_state(struct wb_text *text, const struct wb_live_history *history)
{
    const struct wb_live_frame *const frame = &history->frame;
    struct wb_json *const root = wb_json_create();
    wb_json_set_integer(root, "version", WB_LIVE_FRAME_VERSION);
    wb_json_set_integer(root, "number", (int64_t)frame->number);
    wb_json_set_text(root, "state", wb_live_frame_word(frame->word));
    wb_json_set_text(root, "phase", frame->phase);
    wb_json_set_text(root, "reason", frame->text);
    wb_json_set_integer(root, "cycle", frame->cycle);
    wb_json_set_integer(root, "cycles", frame->cycles);
    wb_json_set_number(root, "elapsed_s", frame->elapsed);
    wb_json_set_number(root, "time_left_s", frame->time_left);
    wb_json_set_number(root, "force_mN", frame->force / WB_MN);
    wb_json_set_number(root, "peak_mN", frame->peak / WB_MN);
    wb_json_set_number(root, "deflection_mm", frame->deflection / WB_MM);
    wb_json_set_number(root, "travel_mm", frame->travel / WB_MM);
    set_streams(root, frame);
    wb_json_set_number(root, "disk_lag_s", frame->disk_lag);
    wb_json_set_number(root, "disk_memory_percent", frame->disk_fill / WB_PERCENT);
    wb_json_set_boolean(root, "disk_good", !frame->is_disk_failing && !frame->is_disk_late);
    wb_json_set_number(root, "disk_free_GB", history->disk_free / 1e9);
    wb_json_set_number(root, "disk_left_h", history->disk_left / 3600.0);
    wb_json_set_integer(root, "frames_dropped", (int64_t)frame->frames_dropped);
    wb_json_set_integer(root, "points_dropped", (int64_t)frame->points_dropped);
    set_markers(root, frame);
    append_document(text, "state", root);
}

/* Appends points as [cycle, mm, mN]; written directly for speed. */
static void append_list(struct wb_text *text, const struct wb_live_frame_point *points, size_t n)
{
    wb_text_append(text, "[");
    for (size_t i = 0; i < n; i++)
        wb_text_append(text, "%s[%d,%.5g,%.5g]", i > 0 ? "," : "", points[i].cycle,
                       (double)points[i].deflection / WB_MM, (double)points[i].force / WB_MN);
    wb_text_append(text, "]}\n\n");
}

static void append_points(struct wb_text *text, const struct wb_live_history *history, size_t from)
{
    wb_text_append(text, "event: points\ndata: {\"from\": %zu, \"points\": ", from);
    append_list(text, history->points + from, history->n_points - from);
}

static void append_earlier(struct wb_text *text, const struct wb_live_plan *plan)
{
    wb_text_append(text, "event: earlier\ndata: {\"points\": ");
    append_list(text, plan->earlier, plan->n_earlier);
}

static void append_messages(struct wb_text *text, const struct wb_live_history *history, int from)
{
    static const char *const levels[] = {"error", "warning", "info", "debug"};
    if (from < history->n_messages - WB_LIVE_HISTORY_MESSAGES)
        from = history->n_messages - WB_LIVE_HISTORY_MESSAGES;
    for (int i = from; i < history->n_messages; i++) {
        const struct wb_live_frame_message *const message =
            &history->message[i % WB_LIVE_HISTORY_MESSAGES];
        struct wb_json *const root = wb_json_create();
        wb_json_set_text(root, "level", levels[message->level & 3]);
        wb_json_set_text(root, "text", message->text);
        append_document(text, "message", root);
    }
}

void wb_live_events_append(struct wb_live_events_cursor *cursor, const struct wb_live_plan *plan,
                           const struct wb_live_history *history, bool is_over,
                           struct wb_text *text)
{
    if (!cursor->has_plan)
        append_plan(text, plan);
    if (!cursor->has_plan && plan->n_earlier > 0)
        append_earlier(text, plan);
    cursor->has_plan = true;
    if (cursor->thinned != history->n_thinned)
        cursor->points = 0;
    cursor->thinned = history->n_thinned;
    if (history->n_points > cursor->points)
        append_points(text, history, cursor->points);
    cursor->points = history->n_points;
    if (history->has_frame && history->frame.number != cursor->frame) {
        append_state(text, history);
        cursor->frame = history->frame.number;
    }
    if (history->n_messages > cursor->messages)
        append_messages(text, history, cursor->messages);
    cursor->messages = history->n_messages;
    if (is_over && !cursor->has_end)
        wb_text_append(text, "event: end\ndata: {}\n\n");
    cursor->has_end = is_over;
}
