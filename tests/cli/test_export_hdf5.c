/* wirebench export -o FILE.h5: read back with HDF5 and compared, column by column and row by row,
 * with the CSV files of the same recording and dataset. */
#include <stdlib.h>
#include <unistd.h>

#include <hdf5.h>

#include "tests/own_folder.h"

static const char *recording;

static int run(const char *format, ...) __attribute__((format(printf, 1, 2)));
static int run(const char *format, ...)
{
    char command[9000];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(command, sizeof command, format, arguments);
    va_end(arguments);
    const int status = system(command);
    return status < 0 ? -1 : status >> 8;
}

/* --- a column of the file --- */

struct column {
    size_t n;
    double *reals;     /* or */
    int64_t *integers; /* or */
    char **texts;
};

static void read_text_attribute(hid_t object, const char *name, char *text, size_t size)
{
    const hid_t attribute = H5Aopen(object, name, H5P_DEFAULT);
    assert_true(attribute >= 0);
    const hid_t type = H5Aget_type(attribute);
    char *value = NULL;
    assert_true(H5Aread(attribute, type, &value) >= 0);
    snprintf(text, size, "%s", value);
    H5free_memory(value);
    H5Tclose(type);
    H5Aclose(attribute);
}

static void read_column(hid_t group, const char *name, struct column *column)
{
    const hid_t array = H5Dopen2(group, name, H5P_DEFAULT);
    if (array < 0)
        fail_msg("no column '%s'", name);
    const hid_t type = H5Dget_type(array), space = H5Dget_space(array);
    const H5T_class_t kind = H5Tget_class(type);
    *column = (struct column){.n = (size_t)H5Sget_simple_extent_npoints(space)};
    void *const values = calloc(column->n + 1, 8);
    assert_non_null(values);
    const hid_t in_memory = kind == H5T_FLOAT     ? H5T_NATIVE_DOUBLE
                            : kind == H5T_INTEGER ? H5T_NATIVE_INT64
                                                  : type;
    assert_true(H5Dread(array, in_memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
    column->reals = kind == H5T_FLOAT ? values : NULL;
    column->integers = kind == H5T_INTEGER ? values : NULL;
    column->texts = kind == H5T_STRING ? values : NULL;
    /* The unit is what the name ends in. */
    char unit[16];
    read_text_attribute(array, "unit", unit, sizeof unit);
    const size_t length = strlen(name), end = strlen(unit);
    if (kind == H5T_STRING)
        assert_string_equal(unit, "");
    else if (strcmp(unit, "1") != 0)
        assert_true(length > end && strcmp(name + length - end, unit) == 0);
    H5Sclose(space);
    H5Tclose(type);
    H5Dclose(array);
}

static void release(struct column *column)
{
    for (size_t i = 0; column->texts && i < column->n; i++)
        H5free_memory(column->texts[i]);
    free(column->reals ? (void *)column->reals
                       : (column->integers ? (void *)column->integers : (void *)column->texts));
}

/* --- a line of CSV --- */

/* Cuts off the next field, without its quotes; NULL at the end. */
static char *next_field(char **rest)
{
    char *const begin = *rest;
    if (!begin)
        return NULL;
    char *from = begin, *to = begin;
    bool quoted = false;
    for (; *from && (quoted || *from != ','); from++) {
        if (*from == '"' && quoted && from[1] == '"')
            *to++ = *from++;
        else if (*from == '"')
            quoted = !quoted;
        else
            *to++ = *from;
    }
    *rest = *from ? from + 1 : NULL;
    *to = '\0';
    return begin;
}

static bool is_float(const char *name)
{
    static const char *const names[] = {"x_m", "y_m", "z_m", "size_m", "residual_m"};
    for (int i = 0; i < 5; i++) {
        if (strcmp(names[i], name) == 0)
            return true;
    }
    return false;
}

static void compare_field(const struct column *column, size_t row, const char *field, double scale,
                          const char *name, bool has_floats)
{
    if (column->texts) {
        assert_string_equal(column->texts[row], field);
    } else if (column->integers) {
        assert_int_equal(column->integers[row], strtoll(field, NULL, 10));
    } else if (!field[0]) {
        assert_true(isnan(column->reals[row]));
    } else {
        const double expected = strtod(field, NULL) * scale;
        /* t_s has nine decimals; cameras send floats. */
        const double tolerance = strcmp(name, "t_s") == 0       ? 1e-9
                                 : has_floats && is_float(name) ? 6e-8 * fabs(expected)
                                                                : 4e-16 * fabs(expected);
        assert_close(column->reals[row], expected, tolerance);
    }
}

enum {
    MOST = 16
};

/* All columns of the CSV file are in the group, and equal; returns the rows. */
static size_t compare_table(hid_t file, const char *table, const char *path, bool has_floats)
{
    static char line[1 << 16];
    struct column columns[MOST];
    char names[MOST][32];
    double scales[MOST];
    int n = 0;
    size_t row = 0;
    const hid_t group = H5Gopen2(file, table, H5P_DEFAULT);
    assert_true(group >= 0);
    FILE *const csv = fopen(path, "r");
    if (!csv)
        fail_msg("no %s", path);
    while (fgets(line, sizeof line, csv)) {
        line[strcspn(line, "\n")] = '\0';
        if (line[0] == '#')
            continue;
        char *rest = line, *field;
        if (n == 0) {
            for (; (field = next_field(&rest)); n++) {
                const size_t length = strlen(field);
                const bool is_mm = length > 3 && strcmp(field + length - 3, "_mm") == 0;
                assert_true(n < MOST);
                snprintf(names[n], sizeof names[n], "%.*s", (int)(length - is_mm), field);
                if (is_mm)
                    names[n][length - 2] = 'm', names[n][length - 1] = '\0';
                scales[n] = is_mm ? 1e-3 : 1.0;
                read_column(group, names[n], &columns[n]);
            }
            continue;
        }
        for (int i = 0; i < n; i++) {
            assert_true(row < columns[i].n);
            field = next_field(&rest);
            assert_non_null(field);
            compare_field(&columns[i], row, field, scales[i], names[i], has_floats);
        }
        row++;
    }
    fclose(csv);
    for (int i = 0; i < n; i++) {
        assert_int_equal(columns[i].n, row);
        release(&columns[i]);
    }
    H5Gclose(group);
    return row;
}

/* --- facts --- */

static void a_recording_is_its_csv(void **state)
{
    (void)state;
    static const char *const tables[] = {"load", "mocap", "stage", "events", "clock"};
    char path[128], source[256];
    assert_int_equal(run("$WIREBENCH_BINARY export '%s' -o %s/csv > /dev/null", recording, folder),
                     0);
    assert_int_equal(
        run("$WIREBENCH_BINARY export '%s' -o %s/rec.h5 > /dev/null", recording, folder), 0);
    snprintf(path, sizeof path, "%s/rec.h5", folder);
    const hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    assert_true(file >= 0);
    for (int i = 0; i < 5; i++) {
        snprintf(path, sizeof path, "%s/csv/%s.csv", folder, tables[i]);
        const size_t rows = compare_table(file, tables[i], path, i == 1);
        assert_true(rows > (i == 3 ? 5 : 100));
    }
    read_text_attribute(file, "source", source, sizeof source);
    assert_non_null(strstr(source, "type1-L85-1.wbr.zst (sha256 "));
    const hid_t meta = H5Gopen2(file, "meta", H5P_DEFAULT);
    struct column keys;
    read_column(meta, "key", &keys);
    bool found = false;
    for (size_t i = 0; i < keys.n; i++)
        found = found || strcmp(keys.texts[i], "specimen") == 0;
    assert_true(found);
    release(&keys);
    H5Gclose(meta);
    H5Fclose(file);
}

static void a_dataset_is_its_csv_bit_for_bit(void **state)
{
    (void)state;
    char path[128];
    const int code =
        run("$WIREBENCH_BINARY align '%s' -o %s/dataset > /dev/null 2>&1", recording, folder);
    assert_true(code == 0 || code == 3);
    assert_int_equal(
        run("$WIREBENCH_BINARY export %s/dataset -o %s/set.h5 > /dev/null", folder, folder), 0);
    snprintf(path, sizeof path, "%s/set.h5", folder);
    const hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    assert_true(file >= 0);
    snprintf(path, sizeof path, "%s/dataset/force_deflection.csv", folder);
    assert_true(compare_table(file, "force_deflection", path, false) > 100);
    snprintf(path, sizeof path, "%s/dataset/shape.csv", folder);
    assert_true(compare_table(file, "shape", path, false) > 100);
    const hid_t group = H5Gopen2(file, "dataset", H5P_DEFAULT);
    struct column json;
    read_column(group, "json", &json);
    assert_int_equal(json.n, 1);
    assert_non_null(strstr(json.texts[0], "\"corrections\""));
    release(&json);
    H5Gclose(group);
    H5Fclose(file);
}

static void the_same_gives_the_same_bytes_later(void **state)
{
    (void)state;
    assert_int_equal(
        run("$WIREBENCH_BINARY export '%s' -o %s/one.h5 > /dev/null", recording, folder), 0);
    sleep(1); /* HDF5 stores times in seconds, where it does */
    assert_int_equal(
        run("$WIREBENCH_BINARY export '%s' -o %s/other.h5 > /dev/null", recording, folder), 0);
    assert_int_equal(run("cmp %s/one.h5 %s/other.h5", folder, folder), 0);
}

static void rejections_name_the_error_and_leave_no_files(void **state)
{
    (void)state;
    assert_int_equal(run("touch %s/mine.h5; $WIREBENCH_BINARY export '%s' -o %s/mine.h5 2>&1 | "
                         "grep -q 'exists; --force overwrites it' && [ ! -s %s/mine.h5 ]",
                         folder, recording, folder, folder),
                     0);
    assert_int_equal(run("$WIREBENCH_BINARY export '%s' -o %s/mine.h5 --force > /dev/null && "
                         "[ -s %s/mine.h5 ]",
                         recording, folder, folder),
                     0);
    assert_int_equal(
        run("$WIREBENCH_BINARY export '%s' -o %s/no/mine.h5 2>&1 | "
            "grep -q \"^wirebench: error: cannot create a file beside '.*/no/mine.h5': No such\"",
            recording, folder),
        0);
    /* A disk that is full. */
    assert_int_equal(run("(ulimit -f 50; trap '' XFSZ; $WIREBENCH_BINARY export %s/dataset "
                         "-o %s/full.h5) > %s/said 2>&1",
                         folder, folder, folder),
                     1);
    assert_int_equal(run("grep -q \"cannot write '.*full.h5': File too large\" %s/said && "
                         "[ ! -e %s/full.h5 ] && [ ! -e %s/full.h5.part ]",
                         folder, folder, folder),
                     0);
    assert_int_equal(run("mkdir -p %s/folder && $WIREBENCH_BINARY export %s/folder -o %s/out 2>&1 "
                         "| grep -q -- '-o FILE.h5'",
                         folder, folder, folder),
                     0);
}

#define FACT(name) cmocka_unit_test(name)

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        FACT(a_recording_is_its_csv),
        FACT(a_dataset_is_its_csv_bit_for_bit),
        FACT(the_same_gives_the_same_bytes_later),
        FACT(rejections_name_the_error_and_leave_no_files),
    };
    if (argc != 2)
        return 2;
    recording = argv[1];
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
