#include "analysis/keys/keys.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/keys/row.h"
#include "base/units.h"

/* Units, and the ends of keys that name them; of several that fit the first counts. */
static const struct {
    const char *end, *name;
    double scale; /* SI value of one unit */
} units[] = {
    {"fracture_energy_N_mm", "N/mm", WB_N_PER_MM},
    {"_N_mm2", "N mm2", WB_NMM2},
    {"_N_mm3", "N/mm3", WB_N_PER_MM3},
    {"_N_mm", "N mm", WB_NMM},
    {"_Nmm", "N mm", WB_NMM},
    {"_Nm", "N m", 1.0},
    {"_mm_N", "mm/N", WB_MM},
    {"_mm_s", "mm/s", WB_MM},
    {"_mJ_per_m", "mJ/m", WB_MJ},
    {"_mJ_per_s", "mJ/s", WB_MJ},
    {"_per_mm", "1/mm", 1e3},
    {"_1_mm", "1/mm", 1e3},
    {"_1_m", "1/m", 1.0},
    {"_1_s", "1/s", 1.0},
    {"_per_s", "1/s", 1.0},
    {"_g_cm3", "g/cm3", WB_G_PER_CM3},
    {"_kg_m", "kg/m", 1.0},
    {"_g_m", "g/m", WB_G},
    {"_m_s2", "m/s2", 1.0},
    {"_mm2", "mm2", WB_MM *WB_MM},
    {"_mm", "mm", WB_MM},
    {"_ms", "ms", 1e-3},
    {"_mN", "mN", WB_MN},
    {"_mJ", "mJ", WB_MJ},
    {"_MPa", "MPa", WB_MPA},
    {"_MB", "MB", 1e6},
    {"_mrad", "mrad", 1e-3},
    {"_rad", "rad", 1.0},
    {"_deg", "degree", WB_DEGREE},
    {"_degrees", "degree", WB_DEGREE},
    {"_ppm", "ppm", WB_PPM},
    {"_percent", "%", WB_PERCENT},
    {"_N", "N", 1.0},
    {"_J", "J", 1.0},
    {"_g", "g", WB_G},
    {"_s", "s", 1.0},
};

const char *wb_keys_unit(const struct wb_key *row)
{
    const size_t length = strlen(row->key);
    for (size_t i = 0; i < WB_COUNT(units) && !row->unit; i++) {
        const size_t n = strlen(units[i].end);
        if (length >= n && strcmp(row->key + length - n, units[i].end) == 0)
            return units[i].name;
    }
    return row->unit ? row->unit : "";
}

static double scale_of(const char *unit)
{
    for (size_t i = 0; i < WB_COUNT(units); i++) {
        if (strcmp(units[i].name, unit) == 0)
            return units[i].scale;
    }
    return 1.0;
}

/* --- values --- */

static double number_at(const char *at, const char *unit)
{
    return *(const double *)(const void *)at / scale_of(unit);
}

static double rounded(double value)
{
    char text[40];
    snprintf(text, sizeof text, "%.6g", value);
    return isfinite(value) ? strtod(text, NULL) : value;
}

static int64_t integer_at(const struct wb_key *row, const char *at)
{
    switch (row->place.form) {
    case WB_KEY_BOOL:
        return *(const bool *)(const void *)at;
    case WB_KEY_INT:
        return *(const int *)(const void *)at;
    default:
        return *(const int64_t *)(const void *)at;
    }
}

/* NULL: the place has none. A choice is copied to `word`. */
static const char *text_at(const struct wb_key *row, const char *at, char word[80])
{
    if (row->place.form == WB_KEY_POINTER)
        return *(const char *const *)(const void *)at;
    if (row->place.form == WB_KEY_INSIDE)
        return at;
    const char *choice = row->choices;
    for (int64_t i = integer_at(row, at); i > 0; i--)
        choice += strcspn(choice, "|") + 1;
    snprintf(word, 80, "%.*s", (int)strcspn(choice, "|"), choice);
    return word;
}

/* --- rows --- */

struct walk {
    struct wb_json *object;
    const char *in;
    const char *from;
    const char *unit; /* of the object */
    int row;          /* number of the current row, from 1 */
    int behind;       /* number of the last row whose key the object has */
    bool has_begun, has_ended;
};

static void put_all(struct wb_json *object, const struct wb_keys *keys, const void *from,
                    const char *unit);

static bool has_row(const struct wb_json *object, const struct wb_key *row)
{
    if (row->key)
        return wb_json_get(object, row->key);
    for (size_t i = 0; row->settings && i < row->settings->n; i++) {
        if (wb_json_get(object, row->settings->rows[i].name))
            return true;
    }
    return false;
}

static void put_list(struct wb_json *array, const struct wb_key *row, const char *from)
{
    const struct wb_key_place *const place = &row->place;
    const size_t n =
        place->count ? place->count : (size_t) * (const int *)(const void *)(from + place->length);
    const char *item = from + place->offset;
    if (place->is_pointer)
        item = *(const char *const *)(const void *)item;
    for (size_t i = 0; i < n; i++, item += place->step) {
        if (row->of)
            put_all(wb_json_append_object(array), row->of, item, wb_keys_unit(row));
        else
            wb_json_append_number(array, number_at(item, wb_keys_unit(row)));
    }
}

static void put_number(struct wb_json *object, const struct wb_key *row, const char *at,
                       const char *unit)
{
    const char *const own = wb_keys_unit(row);
    const double value = number_at(at, own[0] ? own : unit);
    if (isfinite(value) || (row->type & IF_KNOWN) != IF_KNOWN)
        wb_json_set_number(object, row->key, row->type & ROUNDED ? rounded(value) : value);
}

static void put_text(struct wb_json *object, const struct wb_key *row, const char *at)
{
    char word[80];
    const char *const text = text_at(row, at, word);
    if ((text && text[0]) || (row->type & IF_KNOWN) != IF_KNOWN)
        wb_json_set_text(object, row->key, text);
}

static void put_settings(struct wb_json *object, const struct wb_key *row, const char *at)
{
    for (size_t i = 0; i < row->settings->n; i++) {
        const struct wb_setting *const setting = &row->settings->rows[i];
        if (row->applies == 0 || wb_setting_applies(setting, row->applies))
            wb_setting_set_json(setting, at, object);
    }
}

static void put_row(struct wb_json *object, const struct wb_key *row, const char *from,
                    const char *unit)
{
    const char *const at = from + row->place.offset;
    if (row->settings)
        put_settings(object, row, at);
    else if (row->type & LIST)
        put_list(wb_json_set_array(object, row->key), row, from);
    else if (row->of)
        put_all(wb_json_set_object(object, row->key), row->of, at, wb_keys_unit(row));
    else if (row->type & TEXT)
        put_text(object, row, at);
    else if (row->type & NUMBER)
        put_number(object, row, at, unit);
    else if (row->type & FLAG)
        wb_json_set_boolean(object, row->key, integer_at(row, at));
    else
        wb_json_set_integer(object, row->key, integer_at(row, at));
}

/* Calls `visit` for each row, those of included tables in their place. */
static void walk_rows(struct walk *walk, const struct wb_keys *keys,
                      void (*visit)(struct walk *walk, const struct wb_key *row))
{
    for (size_t i = 0; i < keys->n; i++) {
        const struct wb_key *const row = &keys->rows[i];
        if (!row->key && row->of) {
            walk_rows(walk, row->of, visit);
        } else {
            walk->row++;
            visit(walk, row);
        }
    }
}

static void find_last(struct walk *walk, const struct wb_key *row)
{
    if (has_row(walk->object, row))
        walk->behind = walk->row;
}

static void put_next(struct walk *walk, const struct wb_key *row)
{
    if (walk->row <= walk->behind || walk->has_ended)
        return;
    if (row->place.in && strcmp(row->place.in, walk->in) == 0) {
        put_row(walk->object, row, walk->from, "");
        walk->has_begun = true;
    } else {
        walk->has_ended = walk->has_begun;
    }
}

void wb_keys_put(struct wb_json *object, const struct wb_keys *keys, const char *in,
                 const void *from)
{
    struct walk walk = {.object = object, .in = in, .from = from};
    walk_rows(&walk, keys, find_last);
    walk.row = 0;
    walk_rows(&walk, keys, put_next);
}

static void put_any(struct walk *walk, const struct wb_key *row)
{
    if (row->place.in)
        put_row(walk->object, row, walk->from, walk->unit);
}

/* All rows with a place, of an object within another. */
static void put_all(struct wb_json *object, const struct wb_keys *keys, const void *from,
                    const char *unit)
{
    struct walk walk = {.object = object, .from = from, .unit = unit};
    walk_rows(&walk, keys, put_any);
}
