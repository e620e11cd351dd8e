#include "analysis/dataset.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/csv_table.h"
#include "analysis/dataset_csv.h"
#include "base/file.h"
#include "base/text.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "dataset"

/* Version of dataset.json's layout. */
#define SCHEMA 1

enum loading {
    LOADING_TIP,
    LOADING_FOLLOWER,
    LOADING_GENERAL,
    LOADINGS
};

static const char *const loading_names[LOADINGS] = {"tip", "follower", "general"};

static enum loading loading_of(const struct wb_test_info *info)
{
    if (info->is_general)
        return LOADING_GENERAL;
    return info->is_follower ? LOADING_FOLLOWER : LOADING_TIP;
}

/* theta0(s) = sum_i b_i u^(i+1), u = s/L, and its derivative over s by Horner's scheme. */
static double natural_angle(const struct wb_test_info *info, double u)
{
    double sum = 0.0;
    for (int i = info->n_natural_shape - 1; i >= 0; i--)
        sum = (sum + info->natural_shape[i]) * u;
    return sum;
}

double wb_dataset_natural_curvature(void *context, double arc_length)
{
    const struct wb_test_info *const info = context;
    const double u = arc_length / info->length;
    double sum = 0.0;
    for (int i = info->n_natural_shape - 1; i >= 0; i--)
        sum = sum * u + (i + 1) * info->natural_shape[i];
    return sum / info->length;
}

double wb_dataset_bow(const struct wb_test_info *info)
{
    if (info->n_natural_shape == 0)
        return 0.0;
    /* Simpson's rule; 64 intervals of a polynomial angle leave less than 1e-9 of it. */
    enum {
        N = 64
    };
    double sum = 0.0;
    for (int i = 0; i <= N; i++) {
        const double weight = i == 0 || i == N ? 1.0 : i % 2 ? 4.0 : 2.0;
        sum += weight * sin(natural_angle(info, (double)i / N));
    }
    return sum * info->length / (3.0 * N);
}

bool wb_dataset_is_complete(const struct wb_dataset *dataset)
{
    bool complete;
    return wb_json_get_boolean(dataset->document, "complete", &complete) && complete;
}

enum wb_status wb_dataset_init(struct wb_dataset *dataset)
{
    memset(dataset, 0, sizeof *dataset);
    dataset->info.rest_level = (double)NAN;
    dataset->document = wb_json_create();
    if (!dataset->document)
        return wb_fail(WB_ERR_MEMORY, "out of memory for a dataset");
    wb_json_set_integer(dataset->document, "schema", SCHEMA);
    return WB_OK;
}

void wb_dataset_release(struct wb_dataset *dataset)
{
    free(dataset->rows);
    free(dataset->shape_rows);
    wb_json_destroy(dataset->document);
    memset(dataset, 0, sizeof *dataset);
}

/* The capacity is not stored: memory is grown when the count is a power of two, so it always holds
 * the next power of two. */
static void *grown(void *rows, size_t n, size_t row_size)
{
    if (n != 0 && (n & (n - 1)) != 0)
        return rows;
    const size_t capacity = n == 0 ? 1 : 2 * n;
    if (capacity > SIZE_MAX / row_size)
        return NULL;
    return realloc(rows, capacity * row_size);
}

enum wb_status wb_dataset_add_row(struct wb_dataset *dataset, const struct wb_row *row)
{
    struct wb_row *const rows = grown(dataset->rows, dataset->n_rows, sizeof *rows);
    if (!rows)
        return wb_fail(WB_ERR_MEMORY, "out of memory for %zu rows", dataset->n_rows + 1);
    dataset->rows = rows;
    rows[dataset->n_rows++] = *row;
    return WB_OK;
}

enum wb_status wb_dataset_add_shape_row(struct wb_dataset *dataset, const struct wb_shape_row *row)
{
    struct wb_shape_row *const rows =
        grown(dataset->shape_rows, dataset->n_shape_rows, sizeof *rows);
    if (!rows)
        return wb_fail(WB_ERR_MEMORY, "out of memory for %zu shape rows",
                       dataset->n_shape_rows + 1);
    dataset->shape_rows = rows;
    rows[dataset->n_shape_rows++] = *row;
    return WB_OK;
}

/* --- dataset.json: the typed part --- */

/* A length of 0.085 m reads 85 in the file, not 85.000000000000014: 15 digits are what people and
 * the settings files write. */
static void set_scaled(struct wb_json *object, const char *key, double value, double unit)
{
    char text[40];
    snprintf(text, sizeof text, "%.15g", value / unit);
    wb_json_set_number(object, key, isfinite(value) ? strtod(text, NULL) : (double)NAN);
}

static void set_info(struct wb_json *document, const struct wb_test_info *info)
{
    struct wb_json *const test = wb_json_set_object(document, "test");
    wb_json_set_text(test, "wire", info->wire);
    wb_json_set_integer(test, "sample", info->sample);
    set_scaled(test, "length_mm", info->length, WB_MM);
    set_scaled(test, "outer_diameter_mm", info->outer_diameter, WB_MM);
    wb_json_set_number(test, "mass_per_length_kg_m", info->mass_per_length);
    wb_json_set_number(test, "poissons_ratio", info->poissons_ratio);
    wb_json_set_text(test, "loading", loading_names[loading_of(info)]);
    set_scaled(test, "strand_length_mm", info->strand_length, WB_MM);
    set_scaled(test, "counterweight_g", info->counterweight, WB_G);
    wb_json_set_number(test, "gravity_m_s2", info->gravity);
    set_scaled(test, "rest_level_mm", info->rest_level, WB_MM);
    struct wb_json *const shape = wb_json_set_array(test, "natural_shape_rad");
    for (int i = 0; i < info->n_natural_shape; i++)
        wb_json_append_number(shape, info->natural_shape[i]);
    set_scaled(test, "natural_bow_mm", wb_dataset_bow(info), WB_MM);
    wb_json_set_boolean(test, "virtual_rig", info->is_virtual);
    wb_json_set_boolean(test, "simulation", info->is_simulation);
}

static enum wb_status get_number(const struct wb_json *test, const char *path, const char *key,
                                 double unit, double *value)
{
    double read;
    if (!wb_json_get_number(test, key, &read))
        return wb_fail(WB_ERR_FORMAT, "%s: test.%s: expected a number", path, key);
    *value = read * unit;
    return WB_OK;
}

static enum wb_status get_flag(const struct wb_json *test, const char *path, const char *key,
                               bool *value)
{
    if (!wb_json_get_boolean(test, key, value))
        return wb_fail(WB_ERR_FORMAT, "%s: test.%s: expected true or false", path, key);
    return WB_OK;
}

static enum wb_status get_shape(const struct wb_json *test, const char *path,
                                struct wb_test_info *info)
{
    const struct wb_json *const shape = wb_json_get(test, "natural_shape_rad");
    const size_t n = wb_json_length(shape);
    if (!shape || n > sizeof info->natural_shape / sizeof info->natural_shape[0])
        return wb_fail(WB_ERR_FORMAT,
                       "%s: test.natural_shape_rad: expected an array of at most 4 numbers", path);
    for (size_t i = 0; i < n; i++) {
        if (!wb_json_number(wb_json_item(shape, i), &info->natural_shape[i]))
            return wb_fail(WB_ERR_FORMAT, "%s: test.natural_shape_rad: item %zu is not a number",
                           path, i + 1);
    }
    info->n_natural_shape = (int)n;
    return WB_OK;
}

/* Files older than the key have none: their force is the strand's, or vertical. */
static enum wb_status get_loading(const struct wb_json *test, const char *path,
                                  struct wb_test_info *info)
{
    const char *name = loading_names[LOADING_TIP];
    int loading = 0;
    if (wb_json_get(test, "loading") && !wb_json_get_text(test, "loading", &name))
        return wb_fail(WB_ERR_FORMAT, "%s: test.loading: expected a text", path);
    while (loading < LOADINGS && strcmp(name, loading_names[loading]) != 0)
        loading++;
    if (loading == LOADINGS)
        return wb_fail(WB_ERR_FORMAT, "%s: test.loading: expected %s, %s or %s, not '%.40s'", path,
                       loading_names[LOADING_TIP], loading_names[LOADING_FOLLOWER],
                       loading_names[LOADING_GENERAL], name);
    info->is_follower = loading == LOADING_FOLLOWER;
    info->is_general = loading == LOADING_GENERAL;
    if (info->is_follower && info->strand_length != 0.0)
        return wb_fail(WB_ERR_FORMAT,
                       "%s: test.strand_length_mm: a follower force is not a strand's: expected 0",
                       path);
    return WB_OK;
}

static enum wb_status get_info(const struct wb_json *document, const char *path,
                               struct wb_test_info *info)
{
    const struct wb_json *const test = wb_json_get(document, "test");
    const char *wire;
    int64_t sample;
    if (!test)
        return wb_fail(WB_ERR_FORMAT, "%s: no object 'test': this is not a dataset", path);
    if (!wb_json_get_text(test, "wire", &wire) || strlen(wire) >= sizeof info->wire)
        return wb_fail(WB_ERR_FORMAT, "%s: test.wire: expected a text of at most %zu bytes", path,
                       sizeof info->wire - 1);
    strcpy(info->wire, wire);
    if (!wb_json_get_integer(test, "sample", &sample) || sample < 0 || sample > INT32_MAX)
        return wb_fail(WB_ERR_FORMAT, "%s: test.sample: expected a whole number from 0", path);
    info->sample = (int)sample;
    WB_TRY(get_number(test, path, "length_mm", WB_MM, &info->length));
    WB_TRY(get_number(test, path, "outer_diameter_mm", WB_MM, &info->outer_diameter));
    WB_TRY(get_number(test, path, "mass_per_length_kg_m", 1.0, &info->mass_per_length));
    WB_TRY(get_number(test, path, "poissons_ratio", 1.0, &info->poissons_ratio));
    WB_TRY(get_number(test, path, "strand_length_mm", WB_MM, &info->strand_length));
    WB_TRY(get_loading(test, path, info));
    WB_TRY(get_number(test, path, "counterweight_g", WB_G, &info->counterweight));
    WB_TRY(get_number(test, path, "gravity_m_s2", 1.0, &info->gravity));
    if (wb_json_get_number(test, "rest_level_mm", &info->rest_level))
        info->rest_level *= WB_MM;
    else
        info->rest_level = (double)NAN;
    if (!(info->length > 0.0) || !(info->outer_diameter > 0.0))
        return wb_fail(WB_ERR_FORMAT,
                       "%s: test.length_mm and test.outer_diameter_mm must be positive", path);
    WB_TRY(get_shape(test, path, info));
    WB_TRY(get_flag(test, path, "virtual_rig", &info->is_virtual));
    return get_flag(test, path, "simulation", &info->is_simulation);
}

/* --- the folder --- */

/* The caller's document stays as it is: the typed part is set into a copy. */
static enum wb_status format_document(const struct wb_dataset *dataset, char **text)
{
    struct wb_json *copy;
    char *raw;
    WB_TRY(wb_json_format(dataset->document, &raw));
    const enum wb_status parsed = wb_json_parse(&copy, raw, "dataset document");
    free(raw);
    WB_TRY(parsed);
    set_info(copy, &dataset->info);
    const enum wb_status status = wb_json_format(copy, text);
    wb_json_destroy(copy);
    return status;
}

static enum wb_status write_file(const char *folder, const char *name, const char *bytes,
                                 size_t size)
{
    char path[WB_PATH];
    WB_TRY(wb_file_join(path, folder, name));
    return wb_file_write(path, bytes, size);
}

enum wb_status wb_dataset_begin(const char *folder, bool force)
{
    /* The first says that the others are there. */
    static const char *const names[] = {"dataset.json", "fields.csv", "energies.csv",
                                        "surface.csv"};

    WB_TRY(wb_file_prepare_output(folder, force));
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        WB_TRY(wb_csv_table_write(folder, names[i], NULL, 0));
    return WB_OK;
}

struct texts {
    char *document;
    struct wb_text rows, shapes;
};

static void release_texts(struct texts *texts)
{
    free(texts->document);
    wb_text_release(&texts->rows);
    wb_text_release(&texts->shapes);
}

static enum wb_status format_texts(const struct wb_dataset *dataset, struct texts *texts)
{
    *texts = (struct texts){.document = NULL};
    if (dataset->info.is_follower && dataset->info.strand_length != 0.0)
        return wb_fail(WB_ERR_ARGUMENT, "a dataset with a follower force and a strand");
    WB_TRY(format_document(dataset, &texts->document));
    return wb_dataset_csv_format(dataset, &texts->rows, &texts->shapes);
}

static enum wb_status write_texts(const struct texts *texts, const char *folder)
{
    WB_TRY(write_file(folder, "force_deflection.csv", wb_text_string(&texts->rows),
                      texts->rows.length));
    WB_TRY(write_file(folder, "shape.csv", wb_text_string(&texts->shapes), texts->shapes.length));
    return write_file(folder, "dataset.json", texts->document, strlen(texts->document));
}

enum wb_status wb_dataset_finish(const struct wb_dataset *dataset, const char *folder)
{
    struct texts texts;

    enum wb_status status = format_texts(dataset, &texts);
    if (status == WB_OK)
        status = write_texts(&texts, folder);
    release_texts(&texts);
    return status;
}

/* What cannot be written leaves what is there alone. */
enum wb_status wb_dataset_write(const struct wb_dataset *dataset, const char *folder, bool force)
{
    struct texts texts;

    enum wb_status status = format_texts(dataset, &texts);
    if (status == WB_OK)
        status = wb_dataset_begin(folder, force);
    if (status == WB_OK)
        status = write_texts(&texts, folder);
    release_texts(&texts);
    return status;
}

static enum wb_status read_table(struct wb_dataset *dataset, const char *folder, const char *name,
                                 enum wb_status (*parse)(struct wb_dataset *dataset,
                                                         const char *path, char *text, size_t n))
{
    char path[WB_PATH];
    char *text;
    size_t size;
    WB_TRY(wb_file_join(path, folder, name));
    WB_TRY(wb_file_read(path, &text, &size));
    const enum wb_status status = parse(dataset, path, text, size);
    free(text);
    return status;
}

static enum wb_status read_all(struct wb_dataset *dataset, const char *folder)
{
    char path[WB_PATH];
    int64_t schema;
    WB_TRY(wb_file_join(path, folder, "dataset.json"));
    WB_TRY(wb_json_read(&dataset->document, path));
    if (!wb_json_get_integer(dataset->document, "schema", &schema))
        return wb_fail(WB_ERR_FORMAT, "%s: no number 'schema': this is not a dataset", path);
    if (schema != SCHEMA)
        return wb_fail(WB_ERR_UNSUPPORTED,
                       "%s: dataset schema %lld, this program reads %d: use a newer wirebench",
                       path, (long long)schema, SCHEMA);
    WB_TRY(get_info(dataset->document, path, &dataset->info));
    WB_TRY(read_table(dataset, folder, "force_deflection.csv", wb_dataset_csv_parse_rows));
    return read_table(dataset, folder, "shape.csv", wb_dataset_csv_parse_shapes);
}

enum wb_status wb_dataset_read(struct wb_dataset *dataset, const char *folder)
{
    struct wb_dataset read = {0};
    const enum wb_status status = read_all(&read, folder);
    if (status != WB_OK) {
        wb_dataset_release(&read);
        memset(dataset, 0, sizeof *dataset);
        return status;
    }
    *dataset = read;
    return WB_OK;
}

double wb_dataset_gap(const struct wb_dataset *dataset)
{
    const size_t n = dataset->n_rows;
    if (n < 2)
        return HUGE_VAL;
    return 5.0 * (dataset->rows[n - 1].t - dataset->rows[0].t) / (double)(n - 1);
}
