/* A part of the runs of a harness's bands as a file. */
#include <stdlib.h>
#include <string.h>

#include "analysis/harness/harness_bands.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/json.h"
#include "base/number.h"
#include "base/text.h"
#include "base/version.h"

#define WB_LOG_DOMAIN "harness"

static const char name[] = "part.json";

/* A hash of everything that the results of a run depend on. */
static void hash_inputs(const struct wb_harness_bands *bands, char hash[WB_SHA256_TEXT])
{
    const struct wb_harness_result_set *const nominal = bands->nominal;
    const struct wb_harness_plan *const plan = nominal->plan;
    struct wb_text text = {0};
    wb_text_append(&text, "%s %s %d %d %llu %d\n", wb_version_revision(), plan->sha256,
                   nominal->settings.is_elastic, bands->settings.runs,
                   (unsigned long long)bands->settings.seed, nominal->n_places);
    for (int i = 0; i < plan->n_wires; i++)
        wb_text_append(&text, "%s\n", plan->wires[i].sha256);
    wb_hash_bytes(wb_text_string(&text), text.length, hash);
    wb_text_release(&text);
}

enum wb_status wb_harness_bands_write_part(const struct wb_harness_bands *bands, int first, int n,
                                           const char *folder)
{
    char path[WB_PATH], hash[WB_SHA256_TEXT];
    const double *const values = bands->values + (size_t)first * bands->stride;
    WB_TRY(wb_file_join(path, folder, name));
    hash_inputs(bands, hash);
    struct wb_json *const root = wb_json_create();
    wb_json_set_text(root, "inputs_sha256", hash);
    wb_json_set_integer(root, "first", first);
    struct wb_json *const list = wb_json_set_array(root, "values");
    for (size_t i = 0; i < (size_t)n * bands->stride; i++)
        wb_json_append_number(list, values[i]);
    char *const text = wb_json_format_line(root);
    wb_json_destroy(root);
    const enum wb_status status = wb_file_write(path, text, strlen(text));
    free(text);
    return status;
}

/* Takes the values of a part that fits. */
static bool take_values(struct wb_harness_bands *bands, int first, int n,
                        const struct wb_json *root)
{
    const struct wb_json *const list = wb_json_get(root, "values");
    const size_t length = (size_t)n * bands->stride;
    double *const values = bands->values + (size_t)first * bands->stride;
    char hash[WB_SHA256_TEXT];
    const char *given;
    int64_t begins;
    hash_inputs(bands, hash);
    if (!wb_json_get_text(root, "inputs_sha256", &given) || strcmp(given, hash) != 0 ||
        !wb_json_get_integer(root, "first", &begins) || begins != first ||
        wb_json_length(list) != length)
        return false;
    for (size_t i = 0; i < length; i++)
        if (!wb_json_number(wb_json_item(list, i), &values[i]))
            return false;
    return true;
}

enum wb_status wb_harness_bands_read_part(struct wb_harness_bands *bands, int first, int n,
                                          const char *folder, struct wb_reason *why)
{
    char path[WB_PATH];
    struct wb_json *root;
    WB_TRY(wb_file_join(path, folder, name));
    WB_TRY(wb_json_read_with_reason(&root, path, why));
    const bool fits = take_values(bands, first, n, root);
    wb_json_destroy(root);
    return fits ? WB_OK
                : wb_fail_to(why, WB_ERR_FORMAT,
                             "%s: not %d runs from run %d of this harness, its wires and its seed",
                             path, n, first + 1);
}
