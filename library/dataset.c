/* Datasets of the library. */
#include <stdio.h>
#include <stdlib.h>

#include "base/file.h"
#include "library/handles.h"

#define WB_LOG_DOMAIN "library"

/* The public kinds have the numbers of ours. */
_Static_assert((int)WB_TEST_CANTILEVER == (int)WIREBENCH_CANTILEVER, "cantilever");
_Static_assert((int)WB_TEST_THREE_POINT == (int)WIREBENCH_THREE_POINT, "three-point");
_Static_assert((int)WB_TEST_TENSILE == (int)WIREBENCH_TENSILE, "tensile");
_Static_assert(sizeof((struct wb_test_info){0}.natural_shape) ==
                   sizeof((struct wirebench_dataset_info){0}.natural_shape),
               "natural shape");

static enum wb_status read_dataset(struct wirebench_dataset *dataset, const char *folder)
{
    const unsigned kinds = WB_TEST_BIT(WB_TEST_CANTILEVER) | WB_TEST_BIT(WB_TEST_THREE_POINT) |
                           WB_TEST_BIT(WB_TEST_TENSILE);
    struct wb_columns tables[WB_DATASET_COLUMNS_TABLES];
    char path[WB_PATH];
    WB_TRY(wb_dataset_read_kinds(&dataset->dataset, folder, kinds, NULL));
    WB_TRY(wb_dataset_columns_make(tables, &dataset->dataset));
    for (int i = 0; i < WB_DATASET_COLUMNS_TABLES; i++)
        dataset->tables[i].columns = tables[i];
    WB_TRY(wb_json_format(dataset->dataset.document, &dataset->json));
    snprintf(dataset->origin.name, sizeof dataset->origin.name, "%s", wb_file_name(folder));
    WB_TRY(wb_file_join(path, folder, "force_deflection.csv"));
    return wb_hash_file(path, dataset->origin.sha256);
}

enum wirebench_status wirebench_dataset_read(struct wirebench_dataset **out, const char *folder)
{
    wb_call_begin();
    if (wb_call_need(out, "out") != WB_OK || wb_call_need(folder, "folder") != WB_OK)
        return wb_call_end(WB_ERR_ARGUMENT);
    struct wirebench_dataset *const dataset = calloc(1, sizeof *dataset);
    if (!dataset)
        return wb_call_end(wb_fail(WB_ERR_MEMORY, "no memory for a dataset"));
    const enum wb_status status = read_dataset(dataset, folder);
    if (status == WB_OK)
        *out = dataset;
    else
        wirebench_dataset_close(dataset);
    return wb_call_end(status);
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
