#include "cli/datasets.h"

#include <stdlib.h>
#include <string.h>

#define WB_LOG_DOMAIN "datasets"

enum wb_status wb_datasets_add(struct wb_datasets *datasets, const char *name)
{
    const size_t n = (size_t)datasets->n + 1;
    const char **const names = realloc(datasets->names, n * sizeof *names);
    if (!names)
        return wb_fail(WB_ERR_MEMORY, "no memory for %zu names", n);
    names[datasets->n] = name;
    datasets->names = names;
    datasets->n++;
    return WB_OK;
}

enum wb_status wb_datasets_read(struct wb_datasets *datasets)
{
    const size_t n = (size_t)datasets->n;
    datasets->items = calloc(n, sizeof *datasets->items);
    datasets->pointers = calloc(n, sizeof(struct wb_dataset *));
    if (!datasets->items || !datasets->pointers)
        return wb_fail(WB_ERR_MEMORY, "no memory for %zu datasets", n);
    for (int i = 0; i < datasets->n; i++) {
        WB_TRY(wb_dataset_read(&datasets->items[i], datasets->names[i]));
        datasets->pointers[i] = &datasets->items[i];
    }
    return WB_OK;
}

void wb_datasets_release(struct wb_datasets *datasets)
{
    for (int i = 0; datasets->items && i < datasets->n; i++)
        wb_dataset_release(&datasets->items[i]);
    free(datasets->items);
    free(datasets->pointers);
    free(datasets->names);
    memset(datasets, 0, sizeof *datasets);
}
