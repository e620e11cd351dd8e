#include "fe/output/gltf_file.h"

#include <stdlib.h>

#include "base/file.h"
#include "tests/check.h"
#include "tests/messages.h"
#include "tests/own_folder.h"

static char path[64];

static int begin(void **state)
{
    if (make_folder(state) != 0)
        return -1;
    snprintf(path, sizeof path, "%s/scene.glb", folder);
    return 0;
}

static uint32_t word_at(const char *bytes, size_t offset)
{
    uint32_t word = 0;
    for (int k = 3; k >= 0; k--)
        word = word << 8 | (unsigned char)bytes[offset + (size_t)k];
    return word;
}

static float float_at(const char *bytes, size_t offset)
{
    const uint32_t word = word_at(bytes, offset);
    float value;
    memcpy(&value, &word, sizeof value);
    return value;
}

/* The file's JSON, which the caller destroys, and where its buffer begins. */
static struct wb_json *read_back(char **bytes, size_t *buffer, size_t *buffer_size)
{
    size_t size;
    assert_int_equal(wb_file_read(path, bytes, &size), WB_OK);
    assert_memory_equal(*bytes, "glTF\2\0\0\0", 8);
    assert_int_equal(word_at(*bytes, 8), size);
    const size_t length = word_at(*bytes, 12);
    assert_memory_equal(*bytes + 16, "JSON", 4);
    assert_int_equal(length % 4, 0);
    *buffer_size = word_at(*bytes, 20 + length);
    assert_memory_equal(*bytes + 24 + length, "BIN\0", 4);
    *buffer = 28 + length;
    assert_int_equal(*buffer + *buffer_size, size);
    char *const text = strndup(*bytes + 20, length);
    struct wb_json *root;
    assert_int_equal(wb_json_parse(&root, text, "scene"), WB_OK);
    free(text);
    return root;
}

static int integer_of(const struct wb_json *object, const char *key)
{
    int64_t value;
    assert_true(wb_json_get_integer(object, key, &value));
    return (int)value;
}

/* Where the numbers of an accessor begin in the buffer. */
static size_t offset_of(const struct wb_json *root, size_t accessor)
{
    const struct wb_json *const a = wb_json_item(wb_json_get(root, "accessors"), accessor);
    const struct wb_json *const view =
        wb_json_item(wb_json_get(root, "bufferViews"), (size_t)integer_of(a, "bufferView"));
    return (size_t)integer_of(view, "byteOffset") + (size_t)integer_of(a, "byteOffset");
}

static const double triangle[] = {0.0, 0.0, -1.0, 0.1, 0.0, 0.5, 0.0, 2.0, 0.25};
static const double corners[] = {0, 1, 2};

/* Two arrays of one use, between which others are added. */
static void arrays_are_read_back(void **unused)
{
    (void)unused;
    static const double red[] = {1.0, 0.5, 0.0, 1.0}, change[] = {-1.0, 0.5, 0.0, 0.0};
    struct wb_gltf_file file;
    char *bytes;
    size_t buffer, size;
    wb_gltf_file_init(&file);
    assert_int_equal(wb_gltf_file_add(&file, WB_GLTF_FILE_POSITIONS, 2, triangle), 0);
    assert_int_equal(wb_gltf_file_add(&file, WB_GLTF_FILE_COLOURS, 1, red), 1);
    assert_int_equal(wb_gltf_file_add(&file, WB_GLTF_FILE_INDICES, 3, corners), 2);
    assert_int_equal(wb_gltf_file_add(&file, WB_GLTF_FILE_POSITIONS, 3, triangle), 3);
    assert_int_equal(wb_gltf_file_add(&file, WB_GLTF_FILE_COLOUR_CHANGES, 1, change), 4);
    assert_int_equal(wb_gltf_file_write(&file, path), WB_OK);
    wb_gltf_file_release(&file);
    struct wb_json *const root = read_back(&bytes, &buffer, &size);
    const struct wb_json *const views = wb_json_get(root, "bufferViews");
    assert_int_equal(wb_json_length(views), 4);
    assert_int_equal(size, (2 + 3) * 12 + 4 + 12 + 4);
    assert_int_equal(integer_of(wb_json_item(wb_json_get(root, "buffers"), 0), "byteLength"), size);
    for (size_t i = 0; i < 9; i++) {
        assert_true(float_at(bytes, buffer + offset_of(root, 3) + 4 * i) == (float)triangle[i]);
        if (i < 6)
            assert_true(float_at(bytes, buffer + offset_of(root, 0) + 4 * i) == (float)triangle[i]);
        if (i < 3)
            assert_int_equal(word_at(bytes, buffer + offset_of(root, 2) + 4 * i), i);
    }
    assert_memory_equal(bytes + buffer + offset_of(root, 1), "\xff\x80\x00\xff", 4);
    assert_memory_equal(bytes + buffer + offset_of(root, 4), "\x81\x40\x00\x00", 4);
    /* Arrays for graphics processors: of vertices, or of indices. */
    assert_int_equal(integer_of(wb_json_item(views, 0), "target"), 34962);
    assert_int_equal(integer_of(wb_json_item(views, 0), "byteStride"), 12);
    assert_int_equal(integer_of(wb_json_item(views, 2), "target"), 34963);
    wb_json_destroy(root);
    free(bytes);
}

/* Ranges are those of the numbers in single precision. */
static void ranges_are_exact(void **unused)
{
    (void)unused;
    struct wb_gltf_file file;
    char *bytes;
    size_t buffer, size;
    wb_gltf_file_init(&file);
    wb_gltf_file_add(&file, WB_GLTF_FILE_POSITIONS, 3, triangle);
    wb_gltf_file_add(&file, WB_GLTF_FILE_NORMALS, 3, triangle);
    assert_int_equal(wb_gltf_file_write(&file, path), WB_OK);
    wb_gltf_file_release(&file);
    struct wb_json *const root = read_back(&bytes, &buffer, &size);
    const struct wb_json *const accessors = wb_json_get(root, "accessors");
    static const double low[] = {0.0, 0.0, -1.0}, high[] = {(double)0.1F, 2.0, 0.5};
    for (size_t k = 0; k < 3; k++) {
        const struct wb_json *const first = wb_json_item(accessors, 0);
        double least, most;
        assert_true(wb_json_number(wb_json_item(wb_json_get(first, "min"), k), &least));
        assert_true(wb_json_number(wb_json_item(wb_json_get(first, "max"), k), &most));
        assert_true(least == low[k] && most == high[k]);
    }
    assert_null(wb_json_get(wb_json_item(accessors, 1), "min"));
    wb_json_destroy(root);
    free(bytes);
}

/* JSON of any length is padded. */
static void chunks_are_aligned(void **unused)
{
    (void)unused;
    for (int n = 0; n < 5; n++) {
        struct wb_gltf_file file;
        char *bytes, name[] = "xxxxx";
        size_t buffer, size;
        name[n] = '\0';
        wb_gltf_file_init(&file);
        wb_gltf_file_add(&file, WB_GLTF_FILE_TIMES, 3, corners);
        wb_json_set_text(wb_json_set_object(file.root, "extras"), "name", name);
        assert_int_equal(wb_gltf_file_write(&file, path), WB_OK);
        wb_gltf_file_release(&file);
        wb_json_destroy(read_back(&bytes, &buffer, &size));
        assert_int_equal(buffer % 4, 0);
        free(bytes);
    }
}

static void number_that_is_not_finite_is_rejected(void **unused)
{
    (void)unused;
    const double bad[] = {0.0, (double)NAN, 0.0};
    struct wb_gltf_file file;
    char other[80];
    snprintf(other, sizeof other, "%s/bad.glb", folder);
    wb_gltf_file_init(&file);
    wb_gltf_file_add(&file, WB_GLTF_FILE_NORMALS, 1, bad);
    keep_messages();
    assert_int_equal(wb_gltf_file_write(&file, other), WB_ERR_DATA);
    release_messages();
    assert_non_null(strstr(kept.error, "not finite"));
    assert_false(wb_file_exists(other));
    wb_gltf_file_release(&file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(arrays_are_read_back),
        cmocka_unit_test(ranges_are_exact),
        cmocka_unit_test(chunks_are_aligned),
        cmocka_unit_test(number_that_is_not_finite_is_rejected),
    };
    return cmocka_run_group_tests(tests, begin, remove_folder);
}
