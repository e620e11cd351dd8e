#include "analysis/report/manifest.h"

#include <stdlib.h>
#include <string.h>

#include "analysis/plot/typeset.h"
#include "analysis/report/files.h"
#include "analysis/report/numbers.h"
#include "base/build.h"
#include "base/hash.h"
#include "base/memory.h"
#include "base/reads.h"

#define WB_LOG_DOMAIN "report"

const char wb_manifest_name[] = "manifest.json";
const char wb_manifest_signature_name[] = "manifest.json.asc";

static void put_sum(struct wb_json *list, const char *role, const char *name, const char *sha256)
{
    struct wb_json *const entry = wb_json_append_object(list);
    if (role)
        wb_json_set_text(entry, "what", role);
    wb_json_set_text(entry, "name", name);
    wb_json_set_text(entry, "sha256", sha256);
}

/* An input of a report: a recording, or a file that was read. */
struct input {
    const char *what;
    char name[WB_PATH], sha256[WB_SHA256_TEXT];
};

static int compare_inputs(const void *a, const void *b)
{
    const struct input *const x = a, *const y = b;
    const int by_what = strcmp(y->what, x->what), by_name = strcmp(x->name, y->name);
    return by_what != 0 ? by_what : by_name != 0 ? by_name : strcmp(x->sha256, y->sha256);
}

/* The part of an absolute path below a folder; NULL: it is not there. */
static const char *below(const char *path, const char *folder)
{
    char *const whole = realpath(folder[0] ? folder : ".", NULL);
    const size_t n = whole ? strlen(whole) : 0;
    const bool is_below = n > 0 && strncmp(path, whole, n) == 0 && path[n] == '/';
    free(whole);
    return is_below ? path + n + 1 : NULL;
}

/* The part of an absolute path by which shipped data are found; NULL: it is not shipped. */
static const char *among_shipped(const char *path)
{
    for (const char *part = strchr(path, '/'); part; part = strchr(part, '/')) {
        char found[WB_PATH];
        part++;
        if (*part == '\0' || wb_file_find_data(found, part) != WB_OK)
            continue;
        char *const whole = realpath(found, NULL);
        const bool is_same = whole && strcmp(whole, path) == 0;
        free(whole);
        if (is_same)
            return part;
    }
    return NULL;
}

/* A file as every machine names it: from the campaign's folder on, or as shipped data; of one that
 * lies elsewhere the last folder and its name. */
static const char *as_shown(const char *path, const struct wb_campaign *campaign)
{
    const char *shown = below(path, campaign->folder);
    if (!shown)
        shown = among_shipped(path);
    if (shown)
        return shown;
    const char *const name = wb_file_name(path);
    shown = name > path ? name - 1 : name;
    while (shown > path && shown[-1] != '/')
        shown--;
    return *shown == '/' ? name : shown;
}

static void add_input(struct input *inputs, int *n, const char *what, const char *name,
                      const char *sha256)
{
    struct input *const input = &inputs[(*n)++];
    input->what = what;
    snprintf(input->name, sizeof input->name, "%s", name);
    snprintf(input->sha256, sizeof input->sha256, "%s", sha256);
}

/* Sorted: the order of reading depends on threads, and nobody asks for it. */
static void put_inputs(struct wb_json *root, const struct wb_kind *kind, const void *results)
{
    const struct wb_kind_outcome *const outcome = results;
    struct wb_json *const list = wb_json_set_array(root, "inputs");
    struct wb_kind_recording recording;
    struct wb_read read;
    int n = 0, n_recordings = 0;
    while (kind->recordings && kind->recordings(results, n_recordings, &recording))
        n_recordings++;
    struct input *const inputs =
        wb_memory_new((size_t)(n_recordings + wb_reads_count()), sizeof *inputs);
    for (int i = 0; i < n_recordings && kind->recordings(results, i, &recording); i++) {
        if (recording.sha256)
            add_input(inputs, &n, "recording", recording.name, recording.sha256);
    }
    for (int i = 0; wb_reads_at(i, &read); i++)
        add_input(inputs, &n, "file", as_shown(read.path, outcome->campaign), read.sha256);
    qsort(inputs, (size_t)n, sizeof *inputs, compare_inputs);
    for (int i = 0; i < n; i++) {
        if (i == 0 || compare_inputs(&inputs[i - 1], &inputs[i]) != 0)
            put_sum(list, inputs[i].what, inputs[i].name, inputs[i].sha256);
    }
    free(inputs);
}

/* Those that report.json lists, itself among them. */
static enum wb_status put_files(struct wb_json *root, const char *folder)
{
    char path[WB_PATH], sha256[WB_SHA256_TEXT];
    struct wb_json *report;
    struct wb_json *const list = wb_json_set_array(root, "files");
    enum wb_status status = WB_OK;
    WB_TRY(wb_file_join(path, folder, "report.json"));
    WB_TRY(wb_json_read(&report, path));
    const struct wb_json *const files = wb_json_get(report, "files");
    for (size_t i = 0; status == WB_OK && i < wb_json_length(files); i++) {
        const char *name = "";
        wb_json_text(wb_json_item(files, i), &name);
        status = wb_file_join(path, folder, name);
        if (status == WB_OK)
            status = wb_hash_file(path, sha256);
        if (status == WB_OK)
            put_sum(list, NULL, name, sha256);
    }
    wb_json_destroy(report);
    return status;
}

static enum wb_status put_build(struct wb_json *root)
{
    static char path[WB_TYPESET_FONTS][WB_PATH];
    struct wb_json *const build = wb_json_set_object(root, "build");
    WB_TRY(wb_build_put(build));
    struct wb_json *const list = wb_json_set_array(build, "fonts");
    const int n = wb_typeset_font_files(path);
    for (int i = 0; i < n; i++) {
        char sha256[WB_SHA256_TEXT];
        WB_TRY(wb_hash_file(path[i], sha256));
        struct wb_json *const entry = wb_json_append_object(list);
        wb_json_set_text(entry, "file", wb_file_name(path[i]));
        wb_json_set_text(entry, "sha256", sha256);
    }
    return WB_OK;
}

static enum wb_status fill(struct wb_json *root, const struct wb_kind *kind, const void *results,
                           const char *folder)
{
    const struct wb_kind_outcome *const outcome = results;
    const struct wb_laboratory *const laboratory = &outcome->campaign->laboratory;
    wb_json_set_text(root, "report", laboratory->report);
    wb_json_set_text(root, "title", outcome->campaign->title);
    if (laboratory->amends.report[0])
        wb_json_set_text(root, "amends", laboratory->amends.report);
    wb_numbers_put_campaign(root, outcome->campaign);
    put_inputs(root, kind, results);
    WB_TRY(put_files(root, folder));
    return put_build(root);
}

enum wb_status wb_manifest_write(const struct wb_kind *kind, const void *results,
                                 const char *folder)
{
    char path[WB_PATH];
    WB_TRY(wb_file_join(path, folder, wb_manifest_name));
    struct wb_json *const root = wb_json_create();
    enum wb_status status = fill(root, kind, results, folder);
    char *const text = wb_json_format(root);
    wb_json_destroy(root);
    if (status == WB_OK)
        status = wb_file_write(path, text, strlen(text));
    free(text);
    return status;
}

bool wb_manifest_is_signed(const char *folder)
{
    char path[WB_PATH];
    return wb_file_join(path, folder, wb_manifest_signature_name) == WB_OK && wb_file_exists(path);
}

enum wb_status wb_manifest_check_files(const struct wb_json *manifest, const char *folder, int *n)
{
    const struct wb_json *const files = wb_json_get(manifest, "files");
    *n = (int)wb_json_length(files);
    for (int i = 0; i < *n; i++) {
        const struct wb_json *const entry = wb_json_item(files, (size_t)i);
        const char *name, *wanted;
        char path[WB_PATH], found[WB_SHA256_TEXT];
        if (!wb_json_get_text(entry, "name", &name) ||
            !wb_json_get_text(entry, "sha256", &wanted) || !wb_files_is_ours(name))
            return wb_fail(WB_ERR_FORMAT, "%s/%s: file %d has no name or no sum", folder,
                           wb_manifest_name, i + 1);
        WB_TRY(wb_file_join(path, folder, name));
        if (!wb_file_exists(path))
            return wb_fail(WB_ERR_DATA, "'%s' is missing; the manifest lists it", path);
        WB_TRY(wb_hash_file(path, found));
        if (strcmp(found, wanted) != 0)
            return wb_fail(WB_ERR_DATA, "'%s' is not what was signed: SHA-256 %s, signed %s", path,
                           found, wanted);
    }
    return *n > 0 ? WB_OK
                  : wb_fail(WB_ERR_FORMAT, "%s/%s lists no files", folder, wb_manifest_name);
}
