/* C3D (c3d.org, "The C3D File Format"): blocks of 512 bytes; a header, parameters in groups, then
 * frames of points and analogue readings.
 *
 * The parameter section gives the processor that wrote the file: Intel (84); DEC (85), with Intel's
 * integers and VAX floats; or MIPS (86), big-endian. If POINT:SCALE is negative, data are floats;
 * otherwise they are 16-bit integers to be multiplied by it. A point is X, Y, Z and a word of
 * residual and cameras, which is negative if the point is missing. An analogue reading is
 * (raw - OFFSET) x SCALE x GEN_SCALE.
 */
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/config.h"
#include "base/memory.h"
#include "daq/take/take_reader.h"

#define WB_LOG_DOMAIN "c3d"

#define BLOCK 512
#define MOST_POINTS 65535
#define MOST_STEPS 20000000

enum processor {
    INTEL = 84,
    DEC = 85,
    MIPS = 86
};

/* A parameter, located in the file. */
struct parameter {
    int type; /* -1 characters, 1 byte, 2 int16, 4 float */
    int n_dimensions;
    unsigned dimensions[7];
    const uint8_t *data;
    size_t n_items;
};

struct reading {
    struct wb_take *take;
    const char *name;
    struct wb_reason *why;
    const uint8_t *bytes;
    size_t n;
    enum processor processor;
    size_t parameters; /* offset of the section */
    size_t steps;      /* records read so far; limits the run time for malicious files */
    /* From header and parameters. */
    bool is_real, is_unsigned;
    double scale, unit; /* of integers; m */
    size_t word;        /* bytes of a value */
    size_t n_points, n_channels, per_frame, n_frames;
    size_t data; /* offset */
    int32_t first;
    double *offsets, *scales; /* of the channels; owned */
};

/* Fails with the location in the file: an offset in bytes, or the name of a parameter. */
#define reject_at(reading, where, format, ...)                                                     \
    wb_fail_to((reading)->why, WB_ERR_FORMAT, "%s: byte %zu: " format, (reading)->name,            \
               (size_t)(where), __VA_ARGS__)
#define reject_parameter(reading, where, format, ...)                                              \
    wb_fail_to((reading)->why, WB_ERR_FORMAT, "%s: %s: " format, (reading)->name, where,           \
               __VA_ARGS__)

/* --- number formats of the three processors --- */

static uint16_t get_word(const struct reading *reading, const uint8_t *at)
{
    return reading->processor == MIPS ? (uint16_t)(at[0] << 8 | at[1])
                                      : (uint16_t)(at[1] << 8 | at[0]);
}

static int16_t get_int(const struct reading *reading, const uint8_t *at)
{
    return (int16_t)get_word(reading, at);
}

/* VAX floats store the high word first; their exponent is larger by two for the same number, and
 * exponent 0 means zero. */
static double get_float(const struct reading *reading, const uint8_t *at)
{
    uint32_t bits;
    float value;
    if (reading->processor == MIPS)
        bits = (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3];
    else if (reading->processor == DEC)
        bits = (uint32_t)at[1] << 24 | (uint32_t)at[0] << 16 | (uint32_t)at[3] << 8 | at[2];
    else
        bits = (uint32_t)at[3] << 24 | (uint32_t)at[2] << 16 | (uint32_t)at[1] << 8 | at[0];
    if (reading->processor == DEC) {
        const int exponent = (int)(bits >> 23 & 0xff);
        const double fraction = 0.5 + (double)(bits & 0x7fffff) / 16777216.0;
        const double magnitude = exponent ? ldexp(fraction, exponent - 128) : 0.0;
        return bits >> 31 ? -magnitude : magnitude;
    }
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

/* --- parameters --- */

/* A record of the parameter section. read_record() returns false at the end of the section, also if
 * it is truncated. */
struct record {
    int id; /* negative: a group with number -id */
    struct wb_span name;
    size_t body; /* offset after the word that points to the next record */
    size_t next; /* offset; 0: none */
};

static bool read_record(const struct reading *reading, size_t at, struct record *record)
{
    if (at + 2 > reading->n)
        return false;
    const int length = (int8_t)reading->bytes[at];
    record->id = (int8_t)reading->bytes[at + 1];
    record->name = (struct wb_span){(const char *)reading->bytes + at + 2, (size_t)abs(length)};
    const size_t word = at + 2 + record->name.n;
    if (length == 0 || record->id == 0 || word + 2 > reading->n)
        return false;
    const uint16_t offset = get_word(reading, reading->bytes + word);
    record->body = word + 2;
    record->next = offset >= 2 ? word + offset : 0;
    return true;
}

static bool read_parameter(const struct reading *reading, size_t at, struct parameter *parameter)
{
    if (at + 2 > reading->n)
        return false;
    parameter->type = (int8_t)reading->bytes[at];
    parameter->n_dimensions = reading->bytes[at + 1];
    at += 2;
    if (parameter->n_dimensions > 7 || at + (size_t)parameter->n_dimensions > reading->n)
        return false;
    size_t n_items = 1;
    for (int i = 0; i < parameter->n_dimensions; i++) {
        parameter->dimensions[i] = reading->bytes[at++];
        n_items *= parameter->dimensions[i];
        if (n_items > reading->n)
            return false;
    }
    const size_t size = parameter->type == -1 ? 1 : (size_t)abs(parameter->type);
    parameter->data = reading->bytes + at;
    parameter->n_items = n_items;
    return (size == 1 || size == 2 || size == 4) && at + size * n_items <= reading->n;
}

/* Finds GROUP:NAME. The offset of the next record is always positive, so the search ends. */
static bool find(struct reading *reading, const char *group, const char *name,
                 struct parameter *parameter)
{
    struct record record;
    int id = 0;
    for (size_t at = reading->parameters; at && read_record(reading, at, &record);
         at = record.next) {
        if (reading->steps++ > MOST_STEPS)
            return false;
        if (record.id < 0 && wb_cells_equal(record.name, group))
            id = -record.id;
    }
    for (size_t at = reading->parameters; at && id && read_record(reading, at, &record);
         at = record.next) {
        if (record.id == id && wb_cells_equal(record.name, name))
            return read_parameter(reading, record.body, parameter);
    }
    return false;
}

static bool get_item(const struct reading *reading, const struct parameter *parameter, size_t i,
                     double *value)
{
    if (i >= parameter->n_items)
        return false;
    switch (parameter->type) {
    case 1:
        *value = parameter->data[i];
        return true;
    case 2:
        *value = get_int(reading, parameter->data + 2 * i);
        return true;
    case 4:
        *value = get_float(reading, parameter->data + 4 * i);
        return true;
    default:
        return false;
    }
}

static bool find_number(struct reading *reading, const char *group, const char *name, double *value)
{
    struct parameter parameter;
    return find(reading, group, name, &parameter) && get_item(reading, &parameter, 0, value) &&
           isfinite(*value);
}

/* Reads a count: counts are unsigned, although the format declares signed integers. */
static bool find_count(struct reading *reading, const char *group, const char *name, size_t *count)
{
    double value;
    if (!find_number(reading, group, name, &value))
        return false;
    *count = value < 0.0 && value >= -32768.0 ? (size_t)(value + 65536.0)
             : value < 1e9                    ? (size_t)value
                                              : 0;
    return true;
}

/* Finds the i-th text of a list, which continues in LABELS2, LABELS3, ... after 255 entries. */
static bool find_text(struct reading *reading, const char *group, const char *name, size_t i,
                      struct wb_span *text)
{
    char list[16];
    for (int k = 1; k < 100; k++) {
        struct parameter parameter;
        snprintf(list, sizeof list, k > 1 ? "%s%d" : "%s", name, k);
        if (!find(reading, group, list, &parameter) || parameter.type != -1 ||
            parameter.n_dimensions < 1)
            return false;
        const size_t length = parameter.dimensions[0];
        const size_t n_texts = parameter.n_dimensions < 2 ? 1
                               : length > 0               ? parameter.n_items / length
                                                          : 0;
        if (i < n_texts) {
            const char *const at = (const char *)parameter.data + i * length;
            *text = (struct wb_span){at, strnlen(at, length)};
            return true;
        }
        i -= n_texts;
    }
    return false;
}

/* --- layout of the file --- */

static enum wb_status find_parameters(struct reading *reading)
{
    if (reading->n < 2 * BLOCK || reading->bytes[0] == 0 || reading->bytes[1] != 0x50)
        return reject_at(reading, 0, "%s", "expected a C3D file of at least 1024 bytes");
    const size_t section = ((size_t)reading->bytes[0] - 1) * BLOCK;
    if (section + 4 > reading->n)
        return reject_at(reading, 0, "the parameters begin at byte %zu, after the end of the file",
                         section);
    const int processor = reading->bytes[section + 3];
    if (processor < INTEL || processor > MIPS)
        return reject_at(reading, section + 3,
                         "processor: expected 84 (Intel), 85 (DEC) or 86 (MIPS), not %d",
                         processor);
    reading->processor = (enum processor)processor;
    reading->parameters = section + 4;
    static const char *const names[] = {"Intel", "DEC", "MIPS"};
    snprintf(reading->take->format, sizeof reading->take->format, "C3D, %s",
             names[processor - INTEL]);
    return WB_OK;
}

/* Reads a count of 32 bits, stored as two unsigned words; the upper one may be missing. */
static bool find_long(struct reading *reading, const char *name, double *count)
{
    struct parameter parameter;
    double low, high = 0.0;
    if (!find(reading, "TRIAL", name, &parameter) || parameter.type != 2 ||
        !get_item(reading, &parameter, 0, &low))
        return false;
    (void)get_item(reading, &parameter, 1, &high);
    *count = low + (low < 0.0 ? 65536.0 : 0.0) + 65536.0 * high;
    return true;
}

/* Determines the number of frames, for which 16 bits in header and POINT:FRAMES may be too few. */
static void count_frames(struct reading *reading)
{
    static const char *const counts[] = {"LONG_FRAMES", "FRAMES"};
    const uint8_t *const header = reading->bytes;
    const size_t first = get_word(reading, header + 6), last = get_word(reading, header + 8);
    double from, to;
    reading->first = (int32_t)first;
    if (find_long(reading, "ACTUAL_START_FIELD", &from) &&
        find_long(reading, "ACTUAL_END_FIELD", &to) && from >= 0.0 && to >= from && to < 1e9) {
        reading->n_frames = (size_t)(to - from) + 1;
        reading->first = (int32_t)from;
        return;
    }
    for (size_t i = 0; i < WB_COUNT(counts); i++)
        if (find_count(reading, "POINT", counts[i], &reading->n_frames) && reading->n_frames > 0)
            return;
    reading->n_frames = last >= first ? last - first + 1 : 0;
}

static enum wb_status read_layout(struct reading *reading)
{
    double scale, rate;
    size_t block, per_frame = get_word(reading, reading->bytes + 4);
    struct wb_span unit;
    if (!find_count(reading, "POINT", "USED", &reading->n_points))
        reading->n_points = get_word(reading, reading->bytes + 2);
    if (reading->n_points == 0 || reading->n_points > MOST_POINTS)
        return reject_parameter(reading, "POINT:USED", "expected 1 to %d points, not %zu",
                                MOST_POINTS, reading->n_points);
    if (!find_number(reading, "POINT", "SCALE", &scale))
        scale = get_float(reading, reading->bytes + 12);
    if (!(fabs(scale) > 0.0) || !(fabs(scale) < 1e6))
        return reject_parameter(reading, "POINT:SCALE", "expected a scale other than 0, not %g",
                                scale);
    reading->is_real = scale < 0.0;
    reading->word = reading->is_real ? 4 : 2;
    reading->scale = fabs(scale);
    if (!find_number(reading, "POINT", "RATE", &rate))
        rate = get_float(reading, reading->bytes + 20);
    /* At lower rates the times of frames with large numbers would overflow 64 bits of ns. */
    if (!(rate >= 0.5) || !(rate < 1e6))
        return reject_parameter(reading, "POINT:RATE", "expected 0.5 to 1e6 frames/s, not %g",
                                rate);
    reading->take->rate = rate;
    if (!find_text(reading, "POINT", "UNITS", 0, &unit))
        return reject_parameter(reading, "POINT:UNITS", "%s", "missing: lengths have no unit");
    reading->unit = wb_take_length_unit(unit);
    if (!(reading->unit > 0.0)) {
        char word[24];
        wb_take_copy_name(word, sizeof word, unit);
        return reject_parameter(reading, "POINT:UNITS", "unknown unit of length '%s'", word);
    }
    if (!find_count(reading, "POINT", "DATA_START", &block) || block == 0)
        block = get_word(reading, reading->bytes + 16);
    reading->data = (block - 1) * BLOCK;
    if (block == 0 || reading->data >= reading->n)
        return reject_parameter(reading, "POINT:DATA_START", "block %zu is outside the file",
                                block);
    if (!find_count(reading, "ANALOG", "USED", &reading->n_channels))
        reading->n_channels = 0;
    if (reading->n_channels > 0) {
        if (per_frame % reading->n_channels != 0 || per_frame / reading->n_channels > 10000)
            return reject_at(reading, 4, "%zu analogue readings per frame do not fit %zu channels",
                             per_frame, reading->n_channels);
        reading->per_frame = per_frame / reading->n_channels;
        if (reading->per_frame == 0)
            reading->n_channels = 0;
    } else if (per_frame > 0) {
        return reject_parameter(reading, "ANALOG:USED", "no channels, but %zu readings per frame",
                                per_frame);
    }
    count_frames(reading);
    return WB_OK;
}

static void read_points(struct reading *reading)
{
    for (size_t i = 0; i < reading->n_points; i++) {
        struct wb_span text;
        char name[32];
        if (!find_text(reading, "POINT", "LABELS", i, &text)) {
            snprintf(name, sizeof name, "Unlabeled %zu", i + 1);
            text = (struct wb_span){name, strlen(name)};
        }
        const bool unlabelled =
            text.n == 0 || *text.text == '*' || wb_cells_begins(text, "Unlabeled");
        wb_take_add_point(reading->take, unlabelled ? WB_TAKE_UNLABELLED : WB_TAKE_MARKER, text);
    }
}

static enum wb_status read_channels(struct reading *reading)
{
    const size_t n = reading->n_channels;
    struct parameter scales, offsets;
    double general = 1.0;
    struct wb_span text;
    if (n == 0)
        return WB_OK;
    reading->take->channels = wb_memory_new(n, sizeof *reading->take->channels);
    reading->offsets = wb_memory_new(n, sizeof *reading->offsets);
    reading->scales = wb_memory_new(n, sizeof *reading->scales);
    reading->take->n_channels = (int)n;
    reading->take->per_frame = (int)reading->per_frame;
    (void)find_number(reading, "ANALOG", "GEN_SCALE", &general);
    reading->is_unsigned =
        find_text(reading, "ANALOG", "FORMAT", 0, &text) && wb_cells_begins(text, "UNSIGNED");
    const bool has_scales = find(reading, "ANALOG", "SCALE", &scales);
    const bool has_offsets = find(reading, "ANALOG", "OFFSET", &offsets);
    for (size_t i = 0; i < n; i++) {
        struct wb_take_channel *const channel = &reading->take->channels[i];
        reading->scales[i] = 1.0;
        if (has_scales)
            (void)get_item(reading, &scales, i, &reading->scales[i]);
        if (has_offsets)
            (void)get_item(reading, &offsets, i, &reading->offsets[i]);
        if (reading->is_unsigned && reading->offsets[i] < 0.0 && offsets.type == 2)
            reading->offsets[i] += 65536.0;
        reading->scales[i] *= general;
        if (!isfinite(reading->scales[i]) || !isfinite(reading->offsets[i]))
            return reject_parameter(reading, "ANALOG:SCALE", "channel %zu has no finite scale",
                                    i + 1);
        if (find_text(reading, "ANALOG", "LABELS", i, &text))
            wb_take_copy_name(channel->name, sizeof channel->name, text);
        if (find_text(reading, "ANALOG", "UNITS", i, &text))
            wb_take_copy_name(channel->unit, sizeof channel->unit, text);
    }
    return WB_OK;
}

/* --- data --- */

static double get_raw(const struct reading *reading, const uint8_t *at)
{
    return reading->is_real ? get_float(reading, at) : get_int(reading, at);
}

static enum wb_status read_point(struct reading *reading, size_t point, const uint8_t *at)
{
    const double factor = (reading->is_real ? 1.0 : reading->scale) * reading->unit;
    const double residual = get_raw(reading, at + 3 * reading->word);
    double position[3];
    bool zero = true;
    if (residual < 0.0 || isnan(residual))
        return WB_OK;
    for (int k = 0; k < 3; k++) {
        const double raw = get_raw(reading, at + (size_t)k * reading->word);
        if (!isfinite(raw))
            return WB_OK;
        zero &= raw == 0.0;
        position[k] = raw * factor;
        if (!(fabs(position[k]) <= WB_TAKE_LARGEST_POSITION))
            return reject_at(reading, at - reading->bytes,
                             "implausible position of a marker: %g m; check POINT:UNITS",
                             position[k]);
    }
    if (zero)
        return WB_OK;
    wb_take_add_place(reading->take, (uint32_t)point, position);
    return WB_OK;
}

static enum wb_status read_frame(struct reading *reading, size_t frame, const uint8_t *at)
{
    struct wb_take *const take = reading->take;
    (void)wb_take_add_frame(take, reading->first + (int32_t)frame,
                            (double)(reading->first + (int32_t)frame) / take->rate);
    for (size_t i = 0; i < reading->n_points; i++, at += 4 * reading->word)
        WB_TRY(read_point(reading, i, at));
    const size_t n = reading->n_channels * reading->per_frame;
    float *const analog = n > 0 ? wb_take_add_analog(take, n) : NULL;
    for (size_t i = 0; i < n; i++, at += reading->word) {
        const size_t channel = i % reading->n_channels;
        const double raw = reading->is_unsigned && !reading->is_real ? get_word(reading, at)
                                                                     : get_raw(reading, at);
        analog[i] = (float)((raw - reading->offsets[channel]) * reading->scales[channel]);
    }
    return WB_OK;
}

static enum wb_status read_data(struct reading *reading)
{
    const size_t size =
        reading->word * (4 * reading->n_points + reading->n_channels * reading->per_frame);
    const size_t there = (reading->n - reading->data) / size;
    size_t n = reading->n_frames;
    /* 65535 is the largest 16-bit count: use the length of the file. */
    if (n == 65535 && there > n)
        n = there;
    if (n == 0)
        return reject_parameter(reading, "POINT:FRAMES", "%s", "expected at least 1 frame");
    if ((double)reading->first + (double)n > (double)INT_MAX)
        return reject_parameter(reading, "POINT:FRAMES",
                                "%zu frames exceed the range of frame numbers", n);
    reading->take->declared_frames = n;
    for (size_t i = 0; i < n && i < there; i++)
        WB_TRY(read_frame(reading, i, reading->bytes + reading->data + i * size));
    return WB_OK;
}

/* --- the file --- */

static bool is_c3d(const uint8_t *bytes, size_t n)
{
    /* The first byte is a block number; a text file with 'P' as its second letter is excluded. */
    return n >= 2 && bytes[0] > 0 && bytes[1] == 0x50 && (n < 3 || bytes[0] < ' ');
}

static enum wb_status read_all(struct reading *reading)
{
    WB_TRY(find_parameters(reading));
    WB_TRY(read_layout(reading));
    read_points(reading);
    WB_TRY(read_channels(reading));
    return read_data(reading);
}

static enum wb_status read_c3d(struct wb_take *take, const char *name, const uint8_t *bytes,
                               size_t n, struct wb_reason *why)
{
    struct reading reading = {.take = take, .name = name, .why = why, .bytes = bytes, .n = n};
    memset(take, 0, sizeof *take);
    const enum wb_status status = read_all(&reading);
    free(reading.offsets);
    free(reading.scales);
    return wb_take_finish(take, status, name, why);
}

const struct wb_take_reader wb_c3d = {.name = "c3d", .is = is_c3d, .read = read_c3d};
