#include "cli/datasets.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/dataset/exclusion.h"
#include "analysis/quicklook.h"
#include "base/file.h"
#include "base/memory.h"
#include "cli/file_kind.h"

#define WB_LOG_DOMAIN "datasets"

static bool is_dataset(const char *folder)
{
    char path[WB_PATH];
    return wb_file_join(path, folder, "dataset.json") == WB_OK && wb_file_exists(path);
}

static int by_name(const void *a, const void *b)
{
    return strcmp(a, b);
}

/* Lists the datasets in a folder, for a message: "data/a, data/b". Returns their number. */
static int list_datasets(const char *folder, char *text, size_t size)
{
    enum {
        MOST = 6
    };
    char names[MOST][256];
    int n = 0;
    DIR *const listing = opendir(folder);
    for (const struct dirent *entry; listing && (entry = readdir(listing));) {
        char path[WB_PATH];
        if (entry->d_name[0] == '.' || wb_file_join(path, folder, entry->d_name) != WB_OK ||
            !is_dataset(path))
            continue;
        if (n < MOST)
            snprintf(names[n], sizeof names[n], "%s", entry->d_name);
        n++;
    }
    if (listing)
        closedir(listing);
    const int shown = n < MOST ? n : MOST;
    qsort(names, (size_t)shown, sizeof names[0], by_name);
    size_t used = 0;
    text[0] = '\0';
    for (int i = 0; i < shown && used < size; i++)
        used += (size_t)snprintf(text + used, size - used, "%s%s/%s", i > 0 ? ", " : "", folder,
                                 names[i]);
    if (n > MOST && used < size)
        snprintf(text + used, size - used, ", ...");
    return n;
}

static enum wb_status check_name(const char *name)
{
    char held[1024];
    const bool is_other_folder = wb_file_is_folder(name) && !is_dataset(name);
    const int n = is_other_folder ? list_datasets(name, held, sizeof held) : 0;
    if (n > 0)
        return wb_fail(WB_ERR_FORMAT, "'%s' contains %s: %s; name the datasets themselves", name,
                       n == 1 ? "a dataset" : "several datasets", held);
    WB_TRY(wb_file_kind_check(name, WB_FILE_BIT(WB_FILE_DATASET)));
    if (is_dataset(name))
        return WB_OK;
    return wb_fail(WB_ERR_FORMAT, "'%s' %s, expected a dataset: a folder with dataset.json", name,
                   wb_file_exists(name) ? "is of unknown kind" : "does not exist");
}

enum wb_status wb_datasets_read(struct wb_datasets *datasets, const char *const *names, int n,
                                unsigned kinds)
{
    datasets->n = n;
    datasets->items = wb_memory_new((size_t)n, sizeof *datasets->items);
    datasets->pointers = wb_memory_new((size_t)n, sizeof(struct wb_dataset *));
    for (int i = 0; i < n; i++)
        WB_TRY(check_name(names[i]));
    for (int i = 0; i < n; i++) {
        WB_TRY(wb_dataset_read_kinds(&datasets->items[i], names[i], kinds, NULL));
        WB_TRY(wb_exclusion_check(&datasets->items[i], names[i]));
        datasets->pointers[i] = &datasets->items[i];
    }
    return WB_OK;
}

void wb_datasets_release(struct wb_datasets *datasets)
{
    for (int i = 0; i < datasets->n; i++)
        wb_dataset_release(&datasets->items[i]);
    free(datasets->items);
    free(datasets->pointers);
    memset(datasets, 0, sizeof *datasets);
}

void wb_datasets_print(const struct wb_dataset *dataset, const char *folder)
{
    struct wb_text text = {0};
    wb_quicklook_summary(dataset, &text);
    printf("%s\nwritten to %s\n", wb_text_string(&text), folder);
    wb_text_release(&text);
}

void wb_datasets_describe(struct wb_json *object, const struct wb_dataset *dataset,
                          const char *folder)
{
    wb_json_set_text(object, "folder", folder);
    wb_quicklook_describe(dataset, object);
}
