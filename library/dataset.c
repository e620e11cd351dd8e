/* Datasets of the library. */
#include <stdio.h>
#include <stdlib.h>

#include "analysis/align/align.h"
#include "base/file.h"
#include "base/memory.h"
#include "library/handles.h"
#include "library/options.h"

#define WB_LOG_DOMAIN "library"

/* The public kinds have the values of the internal ones. */
_Static_assert((int)WB_TEST_CANTILEVER == (int)WIREBENCH_CANTILEVER, "cantilever");
_Static_assert((int)WB_TEST_THREE_POINT == (int)WIREBENCH_THREE_POINT, "three-point");
_Static_assert((int)WB_TEST_TENSILE == (int)WIREBENCH_TENSILE, "tensile");
_Static_assert(sizeof((struct wb_test_info){0}.natural_shape) ==
                   sizeof((struct wirebench_dataset_info){0}.natural_shape),
               "natural shape");

/* Makes the tables and the text of a dataset that was read or made. */
static void show(struct wirebench_dataset *dataset)
{
    struct wb_columns tables[WB_DATASET_COLUMNS_TABLES];
    wb_dataset_columns_make(tables, &dataset->dataset);
    for (int i = 0; i < WB_DATASET_COLUMNS_TABLES; i++)
        dataset->tables[i].columns = tables[i];
    dataset->json = wb_json_format(dataset->dataset.document);
}

static enum wb_status read_dataset(struct wirebench_dataset *dataset, const char *folder)
{
    const unsigned kinds = WB_TEST_BIT(WB_TEST_CANTILEVER) | WB_TEST_BIT(WB_TEST_THREE_POINT) |
                           WB_TEST_BIT(WB_TEST_TENSILE);
    char path[WB_PATH];
    WB_TRY(wb_dataset_read_kinds(&dataset->dataset, folder, kinds, NULL));
    show(dataset);
    snprintf(dataset->origin.name, sizeof dataset->origin.name, "%s", wb_file_name(folder));
    WB_TRY(wb_file_join(path, folder, "force_deflection.csv"));
    return wb_hash_file(path, dataset->origin.sha256);
}

enum wirebench_status wirebench_dataset_read(struct wirebench_dataset **out, const char *folder)
{
    wb_call_begin();
    if (wb_call_need(out, "out") != WB_OK || wb_call_need(folder, "folder") != WB_OK)
        return wb_call_end(WB_ERR_ARGUMENT);
    struct wirebench_dataset *const dataset = wb_memory_new(1, sizeof *dataset);
    const enum wb_status status = read_dataset(dataset, folder);
    if (status == WB_OK)
        *out = dataset;
    else
        wirebench_dataset_close(dataset);
    return wb_call_end(status);
}

/* --- from a recording --- */

/* Calibrated properties name the recording, as in reports. */
static void set_origin(struct wirebench_dataset *dataset)
{
    const struct wb_json *const recording =
        wb_json_item(wb_json_get(dataset->dataset.document, "recordings"), 0);
    struct wb_properties_dataset *const origin = &dataset->origin;
    const char *name, *sha256;
    origin->is_recording = true;
    if (wb_json_get_text(recording, "name", &name))
        snprintf(origin->name, sizeof origin->name, "%.95s", name);
    if (wb_json_get_text(recording, "sha256", &sha256))
        snprintf(origin->sha256, sizeof origin->sha256, "%s", sha256);
}

static enum wb_status align_dataset(struct wirebench_dataset *dataset, const char *path,
                                    const struct wirebench_alignment *alignment)
{
    struct wb_align_settings settings;
    wb_align_default_settings(&settings);
    settings.rig_path = alignment->rig;
    settings.specimen_path = alignment->specimen;
    WB_TRY(wb_options_set(&wb_align_table, 1, &settings, alignment->options, "align"));
    wb_call_begin_gsl();
    const enum wb_status status = wb_align_run(&dataset->dataset, path, &settings, NULL);
    wb_call_end_gsl();
    WB_TRY(status);
    set_origin(dataset);
    WB_TRY(wb_dataset_settle(&dataset->dataset));
    show(dataset);
    return WB_OK;
}

/* The warnings of an incomplete dataset contain the reasons. */
static enum wirebench_status end_incomplete(const struct wirebench_dataset *dataset)
{
    const struct wb_json *const warnings = wb_json_get(dataset->dataset.document, "warnings");
    struct wb_text text = {0};
    for (size_t i = 0; i < wb_json_length(warnings); i++) {
        const char *warning;
        if (wb_json_text(wb_json_item(warnings, i), &warning))
            wb_text_append(&text, "%s%s", i > 0 ? "; " : "", warning);
    }
    const enum wirebench_status status = wb_call_end_incomplete(
        "%s: the test is incomplete: %s", dataset->origin.name, wb_text_string(&text));
    wb_text_release(&text);
    return status;
}

enum wirebench_status wirebench_dataset_align(struct wirebench_dataset **out,
                                              const char *recording_path,
                                              const struct wirebench_alignment *alignment)
{
    struct wirebench_alignment given = {0};
    wb_call_begin();
    if (wb_call_need(out, "out") != WB_OK ||
        wb_call_need(recording_path, "recording_path") != WB_OK ||
        (alignment &&
         wb_call_take(&given, sizeof given, alignment, "wirebench_alignment") != WB_OK))
        return wb_call_end(WB_ERR_ARGUMENT);
    struct wirebench_dataset *const dataset = wb_memory_new(1, sizeof *dataset);
    const enum wb_status status = align_dataset(dataset, recording_path, &given);
    if (status != WB_OK) {
        wirebench_dataset_close(dataset);
        return wb_call_end(status);
    }
    *out = dataset;
    return wb_dataset_is_complete(&dataset->dataset) ? wb_call_end(WB_OK) : end_incomplete(dataset);
}

void wirebench_dataset_close(struct wirebench_dataset *dataset)
{
    if (!dataset)
        return;
    wb_dataset_release(&dataset->dataset);
    for (int i = 0; i < WB_DATASET_COLUMNS_TABLES; i++)
        wb_columns_release(&dataset->tables[i].columns);
    free(dataset->json);
    free(dataset);
}

enum wirebench_status wirebench_dataset_describe(const struct wirebench_dataset *dataset,
                                                 struct wirebench_dataset_info *info)
{
    wb_call_begin();
    if (wb_call_need(dataset, "dataset") != WB_OK)
        return wb_call_end(WB_ERR_ARGUMENT);
    const struct wb_test_info *const test = &dataset->dataset.info;
    struct wirebench_dataset_info mine = {
        .wire = test->wire,
        .kind = (enum wirebench_kind)test->kind,
        .sample = test->sample,
        .length = test->length,
        .outer_diameter = test->outer_diameter,
        .mass_per_length = test->mass_per_length,
        .strand_length = test->strand_length,
        .counterweight = test->counterweight,
        .gravity = test->gravity,
        .n_natural_shape = test->n_natural_shape,
        .is_follower = test->is_follower,
        .is_virtual = test->is_virtual,
        .is_simulation = test->is_simulation,
        .is_complete = wb_dataset_is_complete(&dataset->dataset),
    };
    for (int i = 0; i < test->n_natural_shape; i++)
        mine.natural_shape[i] = test->natural_shape[i];
    return wb_call_end(wb_call_give(info, &mine, sizeof mine, "wirebench_dataset_info"));
}

enum wirebench_status wirebench_dataset_table(const struct wirebench_dataset *dataset,
                                              const char *name,
                                              const struct wirebench_table **table)
{
    wb_call_begin();
    if (wb_call_need(dataset, "dataset") != WB_OK || wb_call_need(name, "name") != WB_OK ||
        wb_call_need(table, "table") != WB_OK)
        return wb_call_end(WB_ERR_ARGUMENT);
    const int index = wb_dataset_columns_find(name);
    if (index < 0)
        return wb_call_end(wb_fail(WB_ERR_NOT_FOUND,
                                   "no table '%s' in a dataset: expected force_deflection or shape",
                                   name));
    *table = &dataset->tables[index];
    return wb_call_end(WB_OK);
}

const char *wirebench_dataset_json(const struct wirebench_dataset *dataset)
{
    return dataset->json;
}
