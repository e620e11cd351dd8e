/* Rig and specimen files used in place of the recording's own, and their differences. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/align/align_private.h"
#include "base/config.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/number.h"
#include "base/text.h"
#include "daq/protocol/average.h"

#define WB_LOG_DOMAIN "align"

/* Levels of nested maps that are compared key by key; deeper maps are compared whole. */
#define DEPTH 8

enum wb_status wb_align_given_text(const struct wb_align *align, struct wb_recording *recording,
                                   const char *key, const char *given, char **text,
                                   char origin[WB_PATH])
{
    if (given) {
        size_t size;
        snprintf(origin, WB_PATH, "%s", given);
        return wb_file_read_with_reason(given, text, &size, align->why);
    }
    const enum wb_status status = wb_recording_meta(recording, key, text);
    snprintf(origin, WB_PATH, "%s: %s", align->name, key);
    if (status == WB_ERR_NOT_FOUND)
        return wb_fail_to(align->why, WB_ERR_DATA,
                          "%s: the recording has no '%s' in its meta data: name a file with --%s",
                          align->name, key, key);
    return status;
}

/* --- differences --- */

struct differences {
    struct wb_align *align;
    const char *what; /* "rig" or "specimen" */
    struct wb_json *list;
};

/* Appends a scalar as written, a sequence in brackets, a map in braces, "none" for a missing
 * node. */
static void put_value(struct wb_text *text, const struct wb_config_node *node, int depth)
{
    const char *const scalar = node ? wb_config_scalar(node) : "none";
    if (scalar) {
        wb_text_append(text, "%s", scalar);
        return;
    }
    const int n = wb_config_length(node), entries = wb_config_entries(node);
    wb_text_append(text, "%s", n >= 0 ? "[" : "{");
    for (int i = 0; i < (n >= 0 ? n : entries) && depth > 0; i++) {
        const char *name;
        wb_text_append(text, "%s", i > 0 ? ", " : "");
        if (n >= 0) {
            put_value(text, wb_config_item(node, i), depth - 1);
            continue;
        }
        const struct wb_config_node *const value = wb_config_entry(node, i, &name);
        wb_text_append(text, "%s: ", name);
        put_value(text, value, depth - 1);
    }
    wb_text_append(text, "%s", n >= 0 ? "]" : "}");
}

/* Compares numbers by value, not by spelling. */
static bool is_same(const struct wb_config_node *a, const struct wb_config_node *b, int depth)
{
    const char *const text_a = a ? wb_config_scalar(a) : NULL;
    const char *const text_b = b ? wb_config_scalar(b) : NULL;
    double number_a, number_b;
    if (text_a && text_b)
        return strcmp(text_a, text_b) == 0 ||
               (wb_number_parse(text_a, &number_a) && wb_number_parse(text_b, &number_b) &&
                number_a == number_b);
    const int n = a && b ? wb_config_length(a) : -1;
    if (n < 0 || n != wb_config_length(b) || depth == 0)
        return false;
    for (int i = 0; i < n; i++) {
        if (!is_same(wb_config_item(a, i), wb_config_item(b, i), depth - 1))
            return false;
    }
    return true;
}

static void report_difference(const struct differences *d, const char *key,
                              const struct wb_config_node *recorded,
                              const struct wb_config_node *given)
{
    struct wb_text before = {.bytes = NULL}, now = {.bytes = NULL};
    put_value(&before, recorded, DEPTH);
    put_value(&now, given, DEPTH);
    struct wb_json *const entry = wb_json_append_object(d->list);
    wb_json_set_text(entry, "key", key);
    wb_json_set_text(entry, "recorded", wb_text_string(&before));
    wb_json_set_text(entry, "given", wb_text_string(&now));
    wb_align_warn(d->align, "%s corrected: %s is %.120s in place of the recorded %.120s", d->what,
                  key, wb_text_string(&now), wb_text_string(&before));
    wb_text_release(&before);
    wb_text_release(&now);
}

/* Reports each key in which the maps differ by its path, such as "load_cell.unit". */
static void compare(const struct differences *d, const char *path,
                    const struct wb_config_node *recorded, const struct wb_config_node *given,
                    int depth)
{
    const struct wb_config_node *const maps[] = {given, recorded};
    for (int side = 0; side < 2; side++) {
        for (int i = 0; maps[side] && i < wb_config_entries(maps[side]); i++) {
            const char *name;
            char key[256];
            const struct wb_config_node *const value = wb_config_entry(maps[side], i, &name);
            const struct wb_config_node *const other =
                maps[1 - side] ? wb_config_find(maps[1 - side], name) : NULL;
            /* Keys of both maps were compared in the first round. */
            if (side == 1 && other)
                continue;
            snprintf(key, sizeof key, "%.180s%s%.60s", path, path[0] ? "." : "", name);
            if (other && depth > 0 && wb_config_entries(value) >= 0 &&
                wb_config_entries(other) >= 0)
                compare(d, key, other, value, depth - 1);
            else if (!is_same(value, other, DEPTH))
                report_difference(d, key, side == 0 ? other : value, side == 0 ? value : NULL);
        }
    }
}

/* Compares the files' top nodes. A recorded text that is not valid YAML may be why a file was
 * given: all keys differ then. */
static enum wb_status compare_texts(const struct differences *d, const char *recorded,
                                    const char *given, const char *path)
{
    struct wb_config *before = NULL, *now = NULL;
    struct wb_reason unread = {.text = ""};
    WB_TRY(wb_config_parse(&now, given, path, d->align->why));
    if (!recorded || wb_config_parse(&before, recorded, "recorded", &unread) != WB_OK)
        before = NULL;
    compare(d, "", before ? wb_config_root(before) : NULL, wb_config_root(now), DEPTH);
    wb_config_destroy(before);
    wb_config_destroy(now);
    return WB_OK;
}

static enum wb_status describe(struct wb_align *align, struct wb_recording *recording,
                               struct wb_json *corrected, const char *what, const char *path)
{
    char *given, *recorded = NULL, origin[WB_PATH], sha256[WB_SHA256_TEXT];
    WB_TRY(wb_align_given_text(align, recording, what, path, &given, origin));
    const enum wb_status found = wb_recording_meta(recording, what, &recorded);
    if (found != WB_OK && found != WB_ERR_NOT_FOUND) {
        free(given);
        return found;
    }
    wb_hash_bytes(given, strlen(given), sha256);
    struct wb_json *const object = wb_json_set_object(corrected, what);
    wb_json_set_text(object, "file", wb_file_name(path));
    wb_json_set_text(object, "sha256", sha256);
    const struct differences d = {align, what, wb_json_set_array(object, "differences")};
    const enum wb_status status = compare_texts(&d, recorded, given, path);
    /* A recording of the virtual rig stays virtual, whatever file is given. */
    struct wb_rig rig;
    struct wb_reason unread = {.text = ""};
    if (recorded && strcmp(what, "rig") == 0 &&
        wb_rig_parse(recorded, origin, &rig, &unread) == WB_OK)
        align->is_virtual |= rig.is_virtual;
    free(recorded);
    free(given);
    return status;
}

enum wb_status wb_align_given_describe(struct wb_align *align, struct wb_recording *recording,
                                       struct wb_json *entry)
{
    const struct wb_align_settings *const settings = &align->settings;
    if (!settings->rig_path && !settings->specimen_path)
        return WB_OK;
    struct wb_json *const corrected = wb_json_set_object(entry, "corrected");
    if (settings->rig_path)
        WB_TRY(describe(align, recording, corrected, "rig", settings->rig_path));
    if (settings->specimen_path)
        WB_TRY(describe(align, recording, corrected, "specimen", settings->specimen_path));
    return WB_OK;
}

/* --- tare --- */

enum wb_status wb_align_given_tare(struct wb_align *align)
{
    const struct wb_align_reading *const readings = align->readings.items;
    struct wb_average zero = {.n = 0};
    for (size_t i = align->readings.n; i > 0 && zero.n < align->tare_samples; i--) {
        if (readings[i - 1].t_ns <= align->tare_ns && isfinite(readings[i - 1].force))
            wb_average_add(&zero, readings[i - 1].force);
    }
    if (zero.n < align->tare_samples)
        return wb_fail_to(align->why, WB_ERR_DATA,
                          "%s: only %ld of the %ld readings of the tare exist: all are needed to "
                          "compute the tare again with the given rig",
                          align->name, (long)zero.n, align->tare_samples);
    align->tare = zero.mean - wb_rig_tare_load(&align->rig);
    align->tare_deviation = wb_average_deviation(&zero);
    return WB_OK;
}
