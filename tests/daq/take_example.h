/* One small take in every format, for tests of the readers: `n_frames` frames of 3 markers at 100
 * frames a second. Marker m in frame f is at (0.1 m + 0.001 f, 1 - 0.002 f, 0.25 m) m, and the
 * second is not seen in every fifth frame. */
#ifndef WB_TESTS_DAQ_TAKE_EXAMPLE_H
#define WB_TESTS_DAQ_TAKE_EXAMPLE_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "base/text.h"

enum {
    EXAMPLE_MARKERS = 3
};

static inline bool example_seen(int frame, int marker)
{
    return !(marker == 1 && frame % 5 == 4);
}

static inline double example_at(int frame, int marker, int axis)
{
    return axis == 0   ? 0.1 * marker + 0.001 * frame
           : axis == 1 ? 1.0 - 0.002 * frame
                       : 0.25 * marker;
}

/* --- Motive --- */

struct example_csv {
    int version;           /* 21 to 25; 11: rows */
    const char *unit;      /* "Meters" */
    double factor;         /* m in that unit */
    char delimiter, point; /* ',' '.' */
    const char *end;       /* of lines */
};

static inline void example_number(struct wb_text *text, const struct example_csv *form,
                                  double value)
{
    char number[40];
    snprintf(number, sizeof number, "%.6f", value);
    char *const point = strchr(number, '.');
    *point = form->point;
    wb_text_append(text, "%s", number);
}

/* A header's row: its first cells, then one word or one of three names a column. */
static inline void example_row(struct wb_text *text, const struct example_csv *form,
                               const char *word, const char *const names[EXAMPLE_MARKERS],
                               bool axes)
{
    const char d = form->delimiter;
    if (axes)
        wb_text_append(text, form->version == 21 ? "Frame%cTime" : "Frame%cTime (Seconds)", d);
    else
        wb_text_append(text, "%c%s", d, form->version == 21 ? "" : word);
    if (form->version >= 24)
        wb_text_append(text, "%c%s", d, axes ? "TimeCode" : "");
    for (int m = 0; m < EXAMPLE_MARKERS; m++)
        for (int k = 0; k < 3; k++)
            wb_text_append(text, "%c%.*s", d, axes ? 1 : 40, axes ? &"XYZ"[k] : names[m]);
    wb_text_append(text, "%s", form->end);
}

static inline void example_columns(struct wb_text *text, const struct example_csv *form,
                                   int n_frames)
{
    static const char *const types[] = {"Marker", "Marker", "Marker"};
    static const char *const names[] = {"Wire:Marker1", "Unlabeled 1382", "Unlabeled 17"};
    static const char *const ids[] = {"\"9E20\"", "\"9E21\"", "37151EE4:90AF"};
    static const char *const kinds[] = {"Position", "Position", "Position"};
    const char d = form->delimiter;
    wb_text_append(text, "Format Version%c1%c%d%cTake Name%ca%cExport Frame Rate%c100%c", d,
                   form->point, form->version, d, d, d, d, d);
    wb_text_append(text, "Total Exported Frames%c%d%cLength Units%c%s%cCoordinate Space%cGlobal%s",
                   d, n_frames, d, d, form->unit, d, d, form->end);
    wb_text_append(text, "%s", form->end);
    example_row(text, form, "Type", types, false);
    example_row(text, form, "Name", names, false);
    example_row(text, form, "ID", ids, false);
    if (form->version >= 25)
        example_row(text, form, "Parent", kinds, false);
    example_row(text, form, "", kinds, false);
    example_row(text, form, "", NULL, true);
    for (int f = 0; f < n_frames; f++) {
        wb_text_append(text, "%d%c", f, d);
        example_number(text, form, f * 0.01);
        if (form->version >= 24)
            wb_text_append(text, "%c16:12:17:%02d.03", d, f % 60);
        for (int m = 0; m < EXAMPLE_MARKERS; m++)
            for (int k = 0; k < 3; k++) {
                wb_text_append(text, "%c", d);
                if (example_seen(f, m))
                    example_number(text, form, example_at(f, m, k) / form->factor);
            }
        wb_text_append(text, "%s", form->end);
    }
}

static inline void example_rows(struct wb_text *text, const struct example_csv *form, int n_frames)
{
    wb_text_append(text, "comment,made for a test%srighthanded%sinfo,version,1.1%s", form->end,
                   form->end, form->end);
    wb_text_append(text, "info,framecount,%d%sinfo,rigidbodycount,1%srigidbody,\"B\",1,0%s",
                   n_frames, form->end, form->end, form->end);
    for (int f = 0; f < n_frames; f++) {
        int n = 0;
        for (int m = 0; m < EXAMPLE_MARKERS; m++)
            n += example_seen(f, m);
        wb_text_append(text, "frame,%d,%.6f,1,1,0,0,0,0,0,0,1,0,0,0,%d", f, f * 0.01, n);
        for (int m = 0; m < EXAMPLE_MARKERS; m++)
            if (example_seen(f, m))
                wb_text_append(text, ",%.6f,%.6f,%.6f,%d", example_at(f, m, 0), example_at(f, m, 1),
                               example_at(f, m, 2), 50000 + m);
        wb_text_append(text, "%s", form->end);
    }
}

static inline void example_motive(struct wb_text *text, const struct example_csv *form,
                                  int n_frames)
{
    if (form->version == 11)
        example_rows(text, form, n_frames);
    else
        example_columns(text, form, n_frames);
}

/* --- TRC --- */

static inline void example_trc(struct wb_text *text, int n_frames, const char *end)
{
    wb_text_append(text, "PathFileType\t4\t(X/Y/Z)\ta.trc%s", end);
    wb_text_append(text,
                   "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate%s"
                   "100\t100\t%d\t%d\tmm\t100%s",
                   end, n_frames, EXAMPLE_MARKERS, end);
    wb_text_append(text,
                   "Frame#\tTime\tA\t\t\tB\t\t\tC\t\t%s\t\tX1\tY1\tZ1\tX2\tY2\tZ2\tX3\tY3\tZ3%s%s",
                   end, end, end);
    for (int f = 0; f < n_frames; f++) {
        wb_text_append(text, "%d\t%.3f", f, f * 0.01);
        for (int m = 0; m < EXAMPLE_MARKERS; m++)
            for (int k = 0; k < 3; k++) {
                if (example_seen(f, m))
                    wb_text_append(text, "\t%.4f", 1e3 * example_at(f, m, k));
                else
                    wb_text_append(text, f % 2 ? "\t" : "\t0");
            }
        wb_text_append(text, "%s", end);
    }
}

/* --- C3D --- */

/* A C3D that is written as some processor would: 84 Intel, 85 DEC, 86 MIPS. One analogue channel
 * "Fz" in N with two readings a frame: force 0.5 f + 0.25 r of reading r. */
struct example_c3d {
    int processor;
    bool real, unsigned_analog;
    bool without_analog;
};

struct example_bytes {
    uint8_t bytes[65536];
    size_t n;
    int processor;
};

static inline void example_byte(struct example_bytes *to, int value)
{
    if (to->n < sizeof to->bytes)
        to->bytes[to->n++] = (uint8_t)value;
}

static inline void example_word(struct example_bytes *to, long value)
{
    const uint16_t word = (uint16_t)value;
    example_byte(to, to->processor == 86 ? word >> 8 : word & 0xff);
    example_byte(to, to->processor == 86 ? word & 0xff : word >> 8);
}

static inline void example_float(struct example_bytes *to, double value)
{
    const float number = (float)(to->processor == 85 ? 4.0 * value : value);
    uint32_t bits;
    memcpy(&bits, &number, sizeof bits);
    static const int orders[3][4] = {{0, 8, 16, 24}, {16, 24, 0, 8}, {24, 16, 8, 0}};
    for (int i = 0; i < 4; i++)
        example_byte(to, (int)(bits >> orders[to->processor - 84][i] & 0xff));
}

static inline void example_name(struct example_bytes *to, int id, const char *name, int rest)
{
    example_byte(to, (int)strlen(name));
    example_byte(to, id);
    for (const char *at = name; *at; at++)
        example_byte(to, *at);
    example_word(to, 2 + rest);
}

static inline void example_group(struct example_bytes *to, int id, const char *name)
{
    example_name(to, -id, name, 1);
    example_byte(to, 0);
}

static inline void example_int(struct example_bytes *to, int id, const char *name, long value)
{
    example_name(to, id, name, 5);
    example_byte(to, 2);
    example_byte(to, 0);
    example_word(to, value);
    example_byte(to, 0);
}

static inline void example_real(struct example_bytes *to, int id, const char *name, double value)
{
    example_name(to, id, name, 7);
    example_byte(to, 4);
    example_byte(to, 0);
    example_float(to, value);
    example_byte(to, 0);
}

/* `n` texts of four characters. */
static inline void example_texts(struct example_bytes *to, int id, const char *name,
                                 const char *texts, int n)
{
    example_name(to, id, name, 2 + 2 + 4 * n + 1);
    example_byte(to, 0xff);
    example_byte(to, 2);
    example_byte(to, 4);
    example_byte(to, n);
    for (int i = 0; i < 4 * n; i++)
        example_byte(to, texts[i]);
    example_byte(to, 0);
}

static inline void example_block(struct example_bytes *to)
{
    while (to->n % 512 != 0)
        example_byte(to, 0);
}

static inline void example_c3d(struct example_bytes *to, const struct example_c3d *form,
                               int n_frames)
{
    const double scale = 0.05; /* mm */
    const int analog = form->without_analog ? 0 : 2;
    to->n = 0;
    to->processor = form->processor;
    example_byte(to, 2);
    example_byte(to, 0x50);
    example_word(to, EXAMPLE_MARKERS);
    example_word(to, analog);
    example_word(to, 1);
    example_word(to, n_frames);
    example_word(to, 10);
    example_float(to, form->real ? -scale : scale);
    example_word(to, 4);
    example_word(to, analog);
    example_float(to, 100.0);
    example_block(to);
    example_byte(to, 0);
    example_byte(to, 0);
    example_byte(to, 2);
    example_byte(to, form->processor);
    example_group(to, 1, "POINT");
    example_int(to, 1, "USED", EXAMPLE_MARKERS);
    example_int(to, 1, "FRAMES", n_frames);
    example_int(to, 1, "DATA_START", 4);
    example_real(to, 1, "SCALE", form->real ? -scale : scale);
    example_real(to, 1, "RATE", 100.0);
    example_texts(to, 1, "LABELS", "A   B   *17 ", 3);
    example_texts(to, 1, "UNITS", "mm\0\0", 1);
    if (analog) {
        example_group(to, 2, "ANALOG");
        example_int(to, 2, "USED", 1);
        example_real(to, 2, "GEN_SCALE", 0.5);
        example_real(to, 2, "SCALE", 0.1);
        example_int(to, 2, "OFFSET", form->unsigned_analog ? 40000 : 100);
        example_texts(to, 2, "LABELS", "Fz  ", 1);
        example_texts(to, 2, "UNITS", "N   ", 1);
        if (form->unsigned_analog) {
            example_name(to, 2, "FORMAT", 2 + 1 + 8 + 1);
            example_byte(to, 0xff);
            example_byte(to, 1);
            example_byte(to, 8);
            for (const char *at = "UNSIGNED"; *at; at++)
                example_byte(to, *at);
            example_byte(to, 0);
        }
    }
    example_byte(to, 0);
    example_byte(to, 0);
    while (to->n < (size_t)3 * 512)
        example_byte(to, 0);
    for (int f = 0; f < n_frames; f++) {
        for (int m = 0; m < EXAMPLE_MARKERS; m++) {
            for (int k = 0; k < 3; k++) {
                const double mm = 1e3 * example_at(f, m, k);
                if (form->real)
                    example_float(to, mm);
                else
                    example_word(to, lround(mm / scale));
            }
            if (form->real)
                example_float(to, example_seen(f, m) ? 3.0 : -1.0);
            else
                example_word(to, example_seen(f, m) ? 3 : -1);
        }
        for (int r = 0; r < analog; r++) {
            /* (raw - offset) x 0.1 x 0.5 = 0.5 f + 0.25 r */
            const double raw =
                (0.5 * f + 0.25 * r) / 0.05 + (form->unsigned_analog ? 40000.0 : 100.0);
            if (form->real)
                example_float(to, raw);
            else
                example_word(to, lround(raw));
        }
    }
    example_block(to);
}

#endif
