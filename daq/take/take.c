#include "daq/take/take.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/config.h"
#include "base/memory.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "take"

/* s, accepted difference between a time and that of its frame number: files round times to 1 ms. */
#define ROUNDING 0.75e-3
/* Consecutive missing frames, at most; more are an error. */
#define LONGEST_JUMP 100000000

void wb_take_release(struct wb_take *take)
{
    free(take->points);
    free(take->frames);
    free(take->places);
    free(take->channels);
    free(take->analog);
    memset(take, 0, sizeof *take);
}

bool wb_take_is_measured(enum wb_take_kind kind)
{
    return kind == WB_TAKE_MARKER || kind == WB_TAKE_UNLABELLED;
}

size_t wb_take_frame_at(const struct wb_take *take, size_t frame, struct wb_mocap_frame *out)
{
    const struct wb_take_frame *const from = &take->frames[frame];
    size_t left = 0;
    *out = (struct wb_mocap_frame){
        .t_ns = wb_ns_from_seconds(from->t),
        .frame_number = from->number,
        .t_device = from->t,
        .t_clock = (double)NAN,
    };
    for (size_t i = from->first; i < from[1].first; i++) {
        const struct wb_take_place *const place = &take->places[i];
        const enum wb_take_kind kind = take->points[place->point].kind;
        if (!wb_take_is_measured(kind))
            continue;
        if (out->n_markers == WB_MAX_MARKERS) {
            left++;
            continue;
        }
        struct wb_marker *const marker = &out->markers[out->n_markers++];
        *marker = (struct wb_marker){
            .id = (int32_t)place->point + 1,
            .params = WB_MARKER_POINT_CLOUD_SOLVED,
        };
        if (kind == WB_TAKE_UNLABELLED)
            marker->params |= WB_MARKER_UNLABELED;
        memcpy(marker->position, place->position, sizeof marker->position);
    }
    return left;
}

/* --- for readers --- */

void wb_take_copy_name(char *to, size_t size, struct wb_span name)
{
    name = wb_cells_strip(name);
    const size_t n = name.n < size ? name.n : size - 1;
    for (size_t i = 0; i < n; i++)
        to[i] = name.text[i] >= ' ' && name.text[i] <= '~' ? name.text[i] : '?';
    to[n] = '\0';
}

struct wb_take_quoted wb_take_quote(struct wb_span cell)
{
    struct wb_take_quoted quoted;
    wb_take_copy_name(quoted.text, sizeof quoted.text, cell);
    return quoted;
}

size_t wb_take_add_point(struct wb_take *take, enum wb_take_kind kind, struct wb_span name)
{
    take->points =
        wb_memory_room(take->points, &take->capacity[0], take->n_points + 1, sizeof *take->points);
    struct wb_take_point *const point = &take->points[take->n_points];
    *point = (struct wb_take_point){.kind = kind};
    wb_take_copy_name(point->name, sizeof point->name, name);
    return take->n_points++;
}

bool wb_take_add_frame(struct wb_take *take, int32_t number, double t)
{
    const size_t n = take->n_frames;
    if (n > 0 && !(number > take->frames[n - 1].number && t > take->frames[n - 1].t))
        return false;
    /* One more element, for the end of the last frame. */
    take->frames = wb_memory_room(take->frames, &take->capacity[1], n + 2, sizeof *take->frames);
    take->frames[take->n_frames++] =
        (struct wb_take_frame){.number = number, .t = t, .first = take->n_places};
    return true;
}

void wb_take_add_place(struct wb_take *take, uint32_t point, const double position[3])
{
    take->places =
        wb_memory_room(take->places, &take->capacity[2], take->n_places + 1, sizeof *take->places);
    struct wb_take_place *const place = &take->places[take->n_places++];
    place->point = point;
    for (int k = 0; k < 3; k++)
        place->position[k] = (float)position[k];
    take->points[point].n_seen++;
}

void wb_take_drop_frame(struct wb_take *take)
{
    const size_t first = take->frames[--take->n_frames].first;
    while (take->n_places > first)
        take->points[take->places[--take->n_places].point].n_seen--;
}

float *wb_take_add_analog(struct wb_take *take, size_t n)
{
    const size_t used = (take->n_frames > 0 ? take->n_frames - 1 : 0) * n;
    take->analog = wb_memory_room(take->analog, &take->capacity[3], used + n, sizeof *take->analog);
    return take->analog + used;
}

/* Recomputes times from frame numbers if they agree within rounding. A file may number the frames
 * of the cameras and contain every n-th of them. */
static void unround_times(struct wb_take *take)
{
    struct wb_take_frame *const frames = take->frames;
    const size_t n = take->n_frames;
    if (n < 2 || !(take->rate > 0.0))
        return;
    double least = HUGE_VAL, largest = -HUGE_VAL;
    for (size_t i = 0; i < n; i++) {
        const double off = frames[i].t - (double)frames[i].number / take->rate;
        least = fmin(least, off);
        largest = fmax(largest, off);
    }
    if (!(largest - least <= 2.0 * ROUNDING))
        return;
    double offset = 0.5 * (least + largest);
    if (fabs(offset) <= ROUNDING)
        offset = 0.0;
    for (size_t i = 0; i < n; i++)
        frames[i].t = offset + (double)frames[i].number / take->rate;
}

enum wb_status wb_take_finish(struct wb_take *take, enum wb_status status, const char *name,
                              struct wb_reason *why)
{
    if (status == WB_OK && take->n_frames == 0)
        status = wb_fail_to(why, WB_ERR_FORMAT, "%s: the file contains no frame", name);
    if (status != WB_OK) {
        wb_take_release(take);
        return status;
    }
    struct wb_take_frame *const frames = take->frames;
    frames[take->n_frames].first = take->n_places;
    /* Numbers increase by 1, or by the number of camera frames per frame in the file. */
    int64_t step = INT64_MAX;
    for (size_t i = 1; i < take->n_frames; i++) {
        const int64_t by = (int64_t)frames[i].number - frames[i - 1].number;
        step = by < step ? by : step;
    }
    for (size_t i = 1; i < take->n_frames; i++) {
        const int64_t by = (int64_t)frames[i].number - frames[i - 1].number;
        if (by > step && by < LONGEST_JUMP) {
            take->jumps++;
            take->jumped += (size_t)(by / step - 1);
        }
    }
    unround_times(take);
    return WB_OK;
}

double wb_take_length_unit(struct wb_span name)
{
    static const struct {
        const char *names;
        double factor;
    } units[] = {
        {"m meter meters metre metres", 1.0},
        {"mm millimeter millimeters millimetre millimetres", 1e-3},
        {"cm centimeter centimeters centimetre centimetres", 1e-2},
        {"inch inches in", 0.0254},
    };
    char word[24];
    if (name.n >= sizeof word)
        return 0.0;
    wb_take_copy_name(word, sizeof word, name);
    for (char *letter = word; *letter; letter++)
        *letter = (char)tolower((unsigned char)*letter);
    for (size_t i = 0; i < WB_COUNT(units); i++)
        if (wb_cells_lists(units[i].names, word))
            return units[i].factor;
    return 0.0;
}
