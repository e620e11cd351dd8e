#include "fe/output/gltf_file.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/version.h"

#define WB_LOG_DOMAIN "gltf"

enum {
    HEAD = 12, /* bytes of the file's head: magic, version, size */
    CHUNK = 8, /* bytes before a chunk: its size and kind */
    MAGIC = 0x46546c67,
    VERSION = 2,
    JSON = 0x4e4f534a,
    BIN = 0x004e4942,
    /* Constants of OpenGL. */
    BYTE = 5120,
    UNSIGNED_BYTE = 5121,
    UNSIGNED_INT = 5125,
    FLOAT = 5126,
    ARRAY_BUFFER = 34962,
    ELEMENT_ARRAY_BUFFER = 34963
};

/* Items have a multiple of four bytes, so that every array is aligned. */
static const struct {
    const char *type;
    int components, number, target; /* target 0: not of vertices */
    bool has_range;
} uses[WB_GLTF_FILE_USES] = {
    [WB_GLTF_FILE_POSITIONS] = {"VEC3", 3, FLOAT, ARRAY_BUFFER, true},
    [WB_GLTF_FILE_NORMALS] = {"VEC3", 3, FLOAT, ARRAY_BUFFER, false},
    [WB_GLTF_FILE_COLOURS] = {"VEC4", 4, UNSIGNED_BYTE, ARRAY_BUFFER, false},
    [WB_GLTF_FILE_COLOUR_CHANGES] = {"VEC4", 4, BYTE, ARRAY_BUFFER, false},
    [WB_GLTF_FILE_INDICES] = {"SCALAR", 1, UNSIGNED_INT, ELEMENT_ARRAY_BUFFER, false},
    [WB_GLTF_FILE_TIMES] = {"SCALAR", 1, FLOAT, 0, true},
    [WB_GLTF_FILE_TRANSLATIONS] = {"VEC3", 3, FLOAT, 0, false},
    [WB_GLTF_FILE_ROTATIONS] = {"VEC4", 4, FLOAT, 0, false},
    [WB_GLTF_FILE_WEIGHTS] = {"SCALAR", 1, FLOAT, 0, false},
};

static bool is_byte(enum wb_gltf_file_use use)
{
    return uses[use].number == BYTE || uses[use].number == UNSIGNED_BYTE;
}

static int item_size(enum wb_gltf_file_use use)
{
    return uses[use].components * (is_byte(use) ? 1 : 4);
}

void wb_gltf_file_init(struct wb_gltf_file *file)
{
    char generator[64];
    *file = (struct wb_gltf_file){.root = wb_json_create(), .is_finite = true};
    struct wb_json *const asset = wb_json_set_object(file->root, "asset");
    snprintf(generator, sizeof generator, "wirebench %s", wb_version());
    wb_json_set_text(asset, "version", "2.0");
    wb_json_set_text(asset, "generator", generator);
    file->accessors = wb_json_set_array(file->root, "accessors");
}

void wb_gltf_file_release(struct wb_gltf_file *file)
{
    wb_json_destroy(file->root);
    for (int use = 0; use < WB_GLTF_FILE_USES; use++)
        wb_text_release(&file->bytes[use]);
    *file = (struct wb_gltf_file){.root = NULL};
}

/* --- arrays --- */

static void put_word(struct wb_text *text, uint32_t word)
{
    unsigned char bytes[4];
    for (int k = 0; k < 4; k++)
        bytes[k] = (unsigned char)(word >> (8 * k));
    wb_text_append_bytes(text, bytes, sizeof bytes);
}

static void put_number(struct wb_text *text, int number, double value)
{
    const float narrow = (float)value;
    uint32_t word;
    if (number == FLOAT) {
        memcpy(&word, &narrow, sizeof word);
        put_word(text, word);
    } else if (number == UNSIGNED_INT) {
        put_word(text, (uint32_t)value);
    } else {
        const double whole = number == BYTE ? 127.0 : 255.0;
        const unsigned char byte = (unsigned char)(int)lround(whole * value);
        wb_text_append_bytes(text, &byte, 1);
    }
}

/* The range of the numbers as they are stored. */
static void put_range(struct wb_json *accessor, int components, size_t n, const double *values)
{
    struct wb_json *const least = wb_json_set_array(accessor, "min");
    struct wb_json *const most = wb_json_set_array(accessor, "max");
    for (int k = 0; k < components; k++) {
        double low = (double)INFINITY, high = -(double)INFINITY;
        for (size_t i = 0; i < n; i++) {
            const double stored = (double)(float)values[i * (size_t)components + (size_t)k];
            low = fmin(low, stored);
            high = fmax(high, stored);
        }
        wb_json_append_number(least, low);
        wb_json_append_number(most, high);
    }
}

int wb_gltf_file_add(struct wb_gltf_file *file, enum wb_gltf_file_use use, size_t n,
                     const double *values)
{
    struct wb_text *const bytes = &file->bytes[use];
    struct wb_json *const accessor = wb_json_append_object(file->accessors);
    if (bytes->length == 0)
        file->view[use] = file->n_views++;
    wb_json_set_integer(accessor, "bufferView", file->view[use]);
    wb_json_set_integer(accessor, "byteOffset", (int64_t)bytes->length);
    wb_json_set_integer(accessor, "componentType", uses[use].number);
    if (is_byte(use))
        wb_json_set_boolean(accessor, "normalized", true);
    wb_json_set_integer(accessor, "count", (int64_t)n);
    wb_json_set_text(accessor, "type", uses[use].type);
    if (uses[use].has_range)
        put_range(accessor, uses[use].components, n, values);
    for (size_t i = 0; i < n * (size_t)uses[use].components; i++) {
        file->is_finite = file->is_finite && isfinite(values[i]);
        put_number(bytes, uses[use].number, values[i]);
    }
    return file->n_accessors++;
}

/* --- the file --- */

/* The use whose view has this index. */
static enum wb_gltf_file_use use_of(const struct wb_gltf_file *file, int view)
{
    int use = 0;
    while (file->bytes[use].length == 0 || file->view[use] != view)
        use++;
    return (enum wb_gltf_file_use)use;
}

/* Describes the buffer and its views; returns the buffer's size. */
static size_t put_views(struct wb_gltf_file *file)
{
    struct wb_json *const views = wb_json_set_array(file->root, "bufferViews");
    size_t offset = 0;
    for (int i = 0; i < file->n_views; i++) {
        const enum wb_gltf_file_use use = use_of(file, i);
        struct wb_json *const view = wb_json_append_object(views);
        wb_json_set_integer(view, "buffer", 0);
        wb_json_set_integer(view, "byteOffset", (int64_t)offset);
        wb_json_set_integer(view, "byteLength", (int64_t)file->bytes[use].length);
        if (uses[use].target == ARRAY_BUFFER)
            wb_json_set_integer(view, "byteStride", item_size(use));
        if (uses[use].target != 0)
            wb_json_set_integer(view, "target", uses[use].target);
        offset += file->bytes[use].length;
    }
    struct wb_json *const buffers = wb_json_set_array(file->root, "buffers");
    wb_json_set_integer(wb_json_append_object(buffers), "byteLength", (int64_t)offset);
    return offset;
}

enum wb_status wb_gltf_file_write(struct wb_gltf_file *file, const char *path)
{
    struct wb_text text = {0};
    if (!file->is_finite)
        return wb_fail(WB_ERR_DATA, "the scene has numbers that are not finite");
    const size_t buffer = put_views(file);
    char *const json = wb_json_format_line(file->root);
    const size_t length = strlen(json) - 1, padding = (4 - length % 4) % 4;
    const size_t size = HEAD + CHUNK + length + padding + CHUNK + buffer;
    if (size > UINT32_MAX) {
        free(json);
        return wb_fail(WB_ERR_DATA, "the scene has %.1f GiB; glTF files have at most 4 GiB",
                       (double)size / 0x1p30);
    }
    put_word(&text, MAGIC);
    put_word(&text, VERSION);
    put_word(&text, (uint32_t)size);
    put_word(&text, (uint32_t)(length + padding));
    put_word(&text, JSON);
    wb_text_append_bytes(&text, json, length);
    wb_text_append_bytes(&text, "   ", padding);
    free(json);
    put_word(&text, (uint32_t)buffer);
    put_word(&text, BIN);
    for (int i = 0; i < file->n_views; i++) {
        const struct wb_text *const bytes = &file->bytes[use_of(file, i)];
        wb_text_append_bytes(&text, bytes->bytes, bytes->length);
    }
    const enum wb_status status = wb_file_write_text(path, &text);
    wb_text_release(&text);
    return status;
}
