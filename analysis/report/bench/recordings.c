#include "analysis/report/bench/recordings.h"

#include <glob.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/report/pages.h"
#include "base/memory.h"
#include "base/units.h"

const char *const wb_recordings_purposes[] = {"calibration", "validation"};

static const char default_index[] = "recordings/index.yaml";

/* What the campaign's file excludes. */
struct exclusion {
    char name[256];
    struct wb_index_exclusion of;
    bool is_found; /* a wire of the campaign would have it */
};

/* What reading needs besides the campaign itself. */
struct reading {
    struct wb_recordings *campaign;
    int n_excluded;
    struct exclusion *excluded; /* (n_excluded) */
    struct wb_index index;
    char not_listed[320]; /* why the index does not list a sample */
};

/* --- single parts --- */

static enum wb_status read_limits(const struct wb_config_node *node, struct wb_recordings *campaign)
{
    const struct wb_config_key keys[] = {
        WB_CONFIG_OPTIONAL_NUMBER("calibration_rms_max", &campaign->limit[0], 1.0, 1e-6, 10.0),
        WB_CONFIG_OPTIONAL_NUMBER("validation_rms_max", &campaign->limit[1], 1.0, 1e-6, 10.0),
    };
    return node ? wb_config_map(node, keys, WB_COUNT(keys)) : WB_OK;
}

static enum wb_status read_merits(const struct wb_config_node *node, struct wb_recordings *campaign)
{
    if (!node)
        return WB_OK;
    const struct wb_config_node *range;
    const struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("source", campaign->reference_source),
        WB_CONFIG_NODE("validation_rms", &range),
    };
    WB_TRY(wb_config_map(node, keys, WB_COUNT(keys)));
    const struct wb_config_key number = WB_CONFIG_NUMBER("validation_rms", NULL, 1.0, 1e-6, 10.0);
    int n = 0;
    return wb_config_numbers(range, &number, 2, 2, campaign->reference_rms, &n);
}

static enum wb_status read_reference(const struct wb_config_node *node,
                                     struct wb_recordings_wire *wire)
{
    if (!node) {
        wire->has_reference = wire->product.has_properties;
        snprintf(wire->reference_source, sizeof wire->reference_source, "%s", wire->product.source);
        wire->reference = wire->product.material;
        return WB_OK;
    }
    wire->has_reference = true;
    struct wb_material *const reference = &wire->reference;
    const struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("source", wire->reference_source),
        WB_CONFIG_NUMBER("youngs_modulus_MPa", &reference->youngs_modulus, WB_MPA, 1e-3, 1e7),
        WB_CONFIG_NUMBER("yield_stress_MPa", &reference->yield_stress, WB_MPA, 1e-6, 1e5),
        WB_CONFIG_NUMBER("strength_coefficient_MPa", &reference->strength_coefficient, WB_MPA, 0.0,
                         1e7),
        WB_CONFIG_NUMBER("hardening_exponent", &reference->hardening_exponent, 1.0, 1e-3, 2.0),
    };
    return wb_config_map(node, keys, WB_COUNT(keys));
}

/* --- recordings --- */

static void add_test(struct wb_recordings_tests *tests, const struct wb_recordings_test *test)
{
    tests->items = wb_memory_resize(tests->items, (size_t)tests->n + 1, sizeof *tests->items);
    tests->items[tests->n++] = *test;
}

static enum wb_status take_entry(struct wb_recordings_test *test, const struct wb_index *index,
                                 const struct wb_index_entry *entry)
{
    test->sample = entry->sample;
    test->seed = entry->seed;
    test->excluded = entry->excluded;
    memcpy(test->sha256, entry->sha256, sizeof test->sha256);
    if (entry->corrected_specimen[0])
        WB_TRY(wb_file_join(test->corrected_specimen, index->folder, entry->corrected_specimen));
    if (entry->corrected_rig[0])
        WB_TRY(wb_file_join(test->corrected_rig, index->folder, entry->corrected_rig));
    return WB_OK;
}

/* A recording that the campaign's index does not list may be excluded by the index in its own
 * folder. Errors in that index are ignored here; the alignment reports them. */
static void take_folders_index(struct wb_recordings_test *test)
{
    struct wb_index_entry entry;
    struct wb_reason ignored = {.text = ""};
    if (!test->sha256[0] && wb_index_look_up(&entry, test->path, NULL, &ignored))
        test->excluded = entry.excluded;
}

/* Adds a recording at a path, with its `entry` in the index (NULL: none). */
static enum wb_status add_file(struct wb_recordings_tests *tests, const char *path,
                               const struct wb_index *index, const struct wb_index_entry *entry)
{
    struct wb_recordings_test test = {.seed = -1};
    snprintf(test.name, sizeof test.name, "%s", wb_file_name(path));
    if (entry)
        WB_TRY(take_entry(&test, index, entry));
    if (wb_file_exists(path)) {
        snprintf(test.path, sizeof test.path, "%s", path);
        take_folders_index(&test);
    } else
        snprintf(test.missing, sizeof test.missing, "%s",
                 entry                       ? "the index lists it, but the file does not exist"
                 : strpbrk(test.name, "*?[") ? "no file matches this pattern"
                                             : "no such file");
    add_test(tests, &test);
    return WB_OK;
}

static int by_sample(const void *a, const void *b)
{
    const struct wb_recordings_test *const left = a, *const right = b;
    if (left->sample != right->sample)
        return left->sample < right->sample ? -1 : 1;
    return strcmp(left->name, right->name);
}

/* All recordings of the index of this wire and length, and a missing one for each expected sample
 * that it does not list. */
static enum wb_status take_from_index(const struct reading *reading,
                                      const struct wb_recordings_wire *wire, double length,
                                      struct wb_recordings_tests *tests)
{
    for (int i = 0; i < reading->index.n; i++) {
        const struct wb_index_entry *const entry = &reading->index.entries[i];
        if (strcmp(entry->wire, wire->product.name) != 0 || !(fabs(entry->length - length) < 1e-6))
            continue;
        char path[WB_PATH];
        WB_TRY(wb_file_join(path, reading->index.folder, entry->file));
        WB_TRY(add_file(tests, path, &reading->index, entry));
    }
    for (int sample = 1; tests->n < reading->campaign->samples && sample <= 100000; sample++) {
        bool known = false;
        for (int i = 0; i < tests->n; i++)
            known |= tests->items[i].sample == sample;
        if (known)
            continue;
        struct wb_recordings_test test = {.sample = sample, .seed = -1};
        snprintf(test.name, sizeof test.name, "%.60s, %g mm, sample %d", wire->label,
                 length / WB_MM, sample);
        memcpy(test.missing, reading->not_listed, sizeof test.missing);
        add_test(tests, &test);
    }
    if (tests->n > 1)
        qsort(tests->items, (size_t)tests->n, sizeof *tests->items, by_sample);
    return WB_OK;
}

/* One item of an explicit list: a name in the index, else a path or glob beside the campaign. */
static enum wb_status take_named(const struct reading *reading, const char *name,
                                 struct wb_recordings_tests *tests)
{
    char path[WB_PATH];
    const struct wb_index_entry *const entry =
        strchr(name, '/') ? NULL : wb_index_find(&reading->index, name);
    if (entry) {
        WB_TRY(wb_file_join(path, reading->index.folder, entry->file));
        return add_file(tests, path, &reading->index, entry);
    }
    WB_TRY(wb_file_join(path, reading->campaign->head.folder, name));
    glob_t found = {0};
    enum wb_status status = WB_OK;
    /* glob() sorts, so the order is the same in every run (of one locale, which we never set). */
    const bool any = glob(path, 0, NULL, &found) == 0;
    for (size_t i = 0; any && status == WB_OK && i < found.gl_pathc; i++)
        status = add_file(tests, found.gl_pathv[i], &reading->index,
                          wb_index_find(&reading->index, found.gl_pathv[i]));
    globfree(&found);
    return any ? status : add_file(tests, path, &reading->index, NULL);
}

/* Marks what the campaign excludes, as an index would. */
static void exclude(const struct reading *reading, struct wb_recordings_tests *tests)
{
    for (int i = 0; i < tests->n; i++) {
        for (int k = 0; k < reading->n_excluded; k++) {
            struct exclusion *const one = &reading->excluded[k];
            if (strcmp(one->name, tests->items[i].name) != 0)
                continue;
            one->is_found = true;
            tests->items[i].excluded = one->of;
        }
    }
}

static enum wb_status find_tests(const struct reading *reading,
                                 const struct wb_recordings_wire *wire,
                                 const struct wb_config_node *list, double length,
                                 struct wb_recordings_tests *tests)
{
    if (!list)
        return take_from_index(reading, wire, length, tests);
    const int n = wb_config_length(list);
    if (n < 0)
        return wb_config_refuse(list, NULL, "expected a list of recordings");
    for (int i = 0; i < n; i++) {
        const char *const name = wb_config_scalar(wb_config_item(list, i));
        if (!name || !*name)
            return wb_config_refuse(wb_config_item(list, i), NULL,
                                    "expected the name or path of a recording");
        WB_TRY(take_named(reading, name, tests));
    }
    return WB_OK;
}

static enum wb_status read_excluded(struct reading *reading, const struct wb_config_node *list)
{
    const int n = list ? wb_config_length(list) : 0;
    if (list && n < 1)
        return wb_config_refuse(list, "excluded",
                                "expected a list of recordings that are not used");
    reading->excluded = wb_memory_new((size_t)n, sizeof *reading->excluded);
    for (; reading->n_excluded < n; reading->n_excluded++) {
        const struct wb_config_node *const node = wb_config_item(list, reading->n_excluded);
        struct exclusion *const one = &reading->excluded[reading->n_excluded];
        WB_TRY(wb_index_exclusion_read(node, one->name, &one->of));
    }
    return WB_OK;
}

/* A name that means nothing would leave in what a person wanted out. */
static enum wb_status check_excluded(const struct reading *reading,
                                     const struct wb_config_node *list)
{
    for (int i = 0; i < reading->n_excluded; i++) {
        if (!reading->excluded[i].is_found)
            return wb_config_refuse(
                wb_config_item(list, i), "recording",
                "'%s' is not a recording of this campaign: give its name as the report has it",
                reading->excluded[i].name);
    }
    return WB_OK;
}

static enum wb_status read_wire(const struct reading *reading, const struct wb_config_node *node,
                                struct wb_recordings_wire *wire)
{
    char name[256];
    const struct wb_config_node *reference, *lists[WB_RECORDINGS_PURPOSES];
    const struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("wire", name),
        WB_CONFIG_OPTIONAL_TEXT("label", wire->label),
        WB_CONFIG_OPTIONAL_NODE("reference", &reference),
        WB_CONFIG_OPTIONAL_NODE("calibration", &lists[WB_RECORDINGS_CALIBRATION]),
        WB_CONFIG_OPTIONAL_NODE("validation", &lists[WB_RECORDINGS_VALIDATION]),
    };
    const struct wb_recordings *const campaign = reading->campaign;
    char path[WB_PATH];
    WB_TRY(wb_config_map(node, keys, WB_COUNT(keys)));
    WB_TRY(wb_campaign_find(&campaign->head, node, "wire", "wires", name, path, wire->file));
    WB_TRY(wb_hash_file(path, wire->sha256));
    WB_TRY(wb_wire_read(path, &wire->product, NULL));
    if (!wire->label[0])
        snprintf(wire->label, sizeof wire->label, "%s", wire->product.name);
    wb_pages_escape(wire->markup, sizeof wire->markup, wire->label);
    WB_TRY(read_reference(reference, wire));
    for (int k = 0; k < WB_RECORDINGS_PURPOSES; k++) {
        if (campaign->length[k] > 0.0)
            WB_TRY(find_tests(reading, wire, lists[k], campaign->length[k], &wire->tests[k]));
        else if (lists[k])
            return wb_config_refuse(node, "validation", "the campaign has no validation_length_mm");
        exclude(reading, &wire->tests[k]);
    }
    return WB_OK;
}

static enum wb_status read_wires(struct reading *reading, const struct wb_config_node *list)
{
    struct wb_recordings *const campaign = reading->campaign;
    const int n = wb_config_length(list);
    if (n < 1)
        return wb_config_refuse(list, "wires", "expected a list of at least one wire");
    campaign->wires = wb_memory_new((size_t)n, sizeof *campaign->wires);
    for (int i = 0; i < n; i++) {
        const struct wb_config_node *const node = wb_config_item(list, i);
        struct wb_recordings_wire *const wire = &campaign->wires[campaign->n_wires++];
        WB_TRY(read_wire(reading, node, wire));
        for (int k = 0; k < i; k++) {
            if (strcmp(campaign->wires[k].product.name, wire->product.name) == 0)
                return wb_config_refuse(node, "wire", "'%s' stands twice in the campaign",
                                        wire->product.name);
        }
    }
    return WB_OK;
}

/* A campaign without its index can still name recordings by path, and says what it lacks. */
static enum wb_status read_index(struct reading *reading, const char *given)
{
    char path[WB_PATH];
    bool found;
    if (given[0]) {
        WB_TRY(wb_file_join(path, reading->campaign->head.folder, given));
        found = wb_file_exists(path);
    } else {
        found = wb_file_find_data(path, default_index) == WB_OK;
    }
    if (!found) {
        snprintf(reading->not_listed, sizeof reading->not_listed,
                 "there is no index of recordings '%.200s'", given[0] ? given : default_index);
        return WB_OK;
    }
    return wb_index_read(&reading->index, path, NULL);
}

static enum wb_status read_all(struct reading *reading, const struct wb_config_node *root)
{
    struct wb_recordings *const campaign = reading->campaign;
    const struct wb_config_node *settings, *limits, *reference, *wires, *excluded;
    char index[1024] = "";
    campaign->samples = 1;
    campaign->whole_cycle = true;
    const struct wb_config_key keys[] = {
        WB_CAMPAIGN_KEYS(&campaign->head),
        WB_CONFIG_OPTIONAL_TEXT("index", index),
        WB_CONFIG_NUMBER("calibration_length_mm", &campaign->length[0], WB_MM, 1.0, 1e4),
        WB_CONFIG_OPTIONAL_NUMBER("validation_length_mm", &campaign->length[1], WB_MM, 1.0, 1e4),
        WB_CONFIG_OPTIONAL_INTEGER("samples", &campaign->samples, 1, 1000),
        WB_CONFIG_OPTIONAL_BOOLEAN("whole_cycle", &campaign->whole_cycle),
        WB_CONFIG_OPTIONAL_BOOLEAN("pooled_scatter", &campaign->pooled_scatter),
        WB_CONFIG_OPTIONAL_NODE("settings", &settings),
        WB_CONFIG_OPTIONAL_NODE("limits", &limits),
        WB_CONFIG_OPTIONAL_NODE("reference", &reference),
        WB_CONFIG_NODE("wires", &wires),
        WB_CONFIG_OPTIONAL_NODE("excluded", &excluded),
    };
    WB_TRY(wb_config_map(root, keys, WB_COUNT(keys)));
    WB_TRY(wb_campaign_read_settings(settings, &campaign->head.fit));
    WB_TRY(read_limits(limits, campaign));
    WB_TRY(read_merits(reference, campaign));
    WB_TRY(read_index(reading, index));
    WB_TRY(read_excluded(reading, excluded));
    WB_TRY(read_wires(reading, wires));
    return check_excluded(reading, excluded);
}

enum wb_status wb_recordings_keys(void *context, const struct wb_config_node *root)
{
    struct reading reading = {.campaign = context, .not_listed = "not in the index of recordings"};
    const enum wb_status status = read_all(&reading, root);
    wb_index_release(&reading.index);
    free(reading.excluded);
    return status;
}

void wb_recordings_release(void *context)
{
    struct wb_recordings *const campaign = context;
    for (int i = 0; i < campaign->n_wires; i++) {
        for (int k = 0; k < WB_RECORDINGS_PURPOSES; k++)
            free(campaign->wires[i].tests[k].items);
    }
    free(campaign->wires);
    memset(campaign, 0, sizeof *campaign);
}

int wb_recordings_count(const struct wb_recordings *campaign, int *n_missing)
{
    int n = 0;
    *n_missing = 0;
    for (int i = 0; i < WB_RECORDINGS_PURPOSES * campaign->n_wires; i++) {
        const struct wb_recordings_tests *const tests =
            &campaign->wires[i / WB_RECORDINGS_PURPOSES].tests[i % WB_RECORDINGS_PURPOSES];
        for (int k = 0; k < tests->n; k++) {
            n += !tests->items[k].excluded.is_excluded;
            *n_missing += tests->items[k].missing[0] && !tests->items[k].excluded.is_excluded;
        }
    }
    return n;
}
