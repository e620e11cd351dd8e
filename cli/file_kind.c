#include "cli/file_kind.h"

#include <ctype.h>
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "analysis/dataset/machine.h"
#include "analysis/report/kinds/kinds.h"
#include "base/config.h"
#include "base/file.h"
#include "cli/command.h"
#include "cli/finding.h"
#include "daq/recording/index.h"
#include "daq/take/take_reader.h"

#define WB_LOG_DOMAIN "file"

enum {
    HEAD = 64,             /* bytes that show a binary format */
    LARGEST_TEXT = 1 << 24 /* bytes of a text that is looked at */
};

/* "%s" in `next` stands for the quoted path, twice at most. */
static const struct {
    const char *key, *name, *next;
} rows[WB_FILE_KINDS] = {
    [WB_FILE_UNKNOWN] = {"unknown", "a file of unknown kind", ""},
    [WB_FILE_RECORDING] = {"recording", "a recording", "wirebench align %s -o DATASET"},
    [WB_FILE_DATASET] = {"dataset", "a dataset", "wirebench calibrate %s -o PROPERTIES.yaml"},
    [WB_FILE_PROPERTIES] = {"properties", "a properties file",
                            "wirebench validate %s DATASET...; wirebench export %s --to KIND"},
    [WB_FILE_RIG] = {"rig", "a rig file",
                     "wirebench doctor %s; wirebench record %s --specimen SPECIMEN.yaml -o "
                     "REC.wbr"},
    [WB_FILE_SPECIMEN] = {"specimen", "a specimen file",
                          "wirebench record RIG.yaml --specimen %s -o REC.wbr"},
    [WB_FILE_TEST_PIECE] = {"machine_specimen", "a specimen file of a testing machine",
                            "wirebench import force FILE --specimen %s --machine MACHINE.yaml -o "
                            "DATASET"},
    [WB_FILE_WIRE] = {"wire", "a wire file",
                      "wirebench solve cantilever --wire %s --length-mm L --deflection-mm D"},
    [WB_FILE_MATERIAL] = {"material", "a material file",
                          "wirebench calibrate --constituents --conductor %s "
                          "--conductor-diameter-mm D"},
    [WB_FILE_MODEL] = {"model", "a model file", "wirebench solve wire1d %s -o DATASET"},
    [WB_FILE_BUNDLE] = {"bundle", "a bundle file", "wirebench solve bundle %s -o DATASET"},
    [WB_FILE_HARNESS] = {"harness", "a harness file",
                         "wirebench quicklook %s -o DIR; wirebench solve harness %s -o DIR; "
                         "wirebench report with a campaign file of `kind: harness`"},
    [WB_FILE_MACHINE] = {"machine", "a machine file",
                         "wirebench import force FILE --specimen SPECIMEN.yaml --machine %s -o "
                         "DATASET"},
    [WB_FILE_CAMPAIGN] = {"campaign", "a campaign file", "wirebench report %s -o DIR"},
    [WB_FILE_SERIES] = {"series", "a series file", "wirebench record RIG.yaml --series %s"},
    [WB_FILE_INDEX] = {"index", "an index of recordings or simulations",
                       "wirebench info REC.wbr or DATASET, for one of its entries"},
    [WB_FILE_TAKE] = {"take", "a take of motion capture",
                      "wirebench import mocap %s --specimen SPECIMEN.yaml --rig RIG.yaml -o "
                      "REC.wbr"},
    [WB_FILE_TABLE] = {"table", "a table of numbers",
                       "wirebench import force %s --specimen SPECIMEN.yaml --machine MACHINE.yaml "
                       "-o DATASET"},
    [WB_FILE_PART_OF_DATASET] = {"dataset_file", "a file of a dataset",
                                 "name the folder of the dataset instead"},
    [WB_FILE_DATASETS] =
        {"datasets", "a folder of datasets",
         "wirebench calibrate %s/DATASET... -o PROPERTIES.yaml, with the datasets of one wire"},
    [WB_FILE_RECORDINGS] = {"recordings", "a folder of recordings",
                            "wirebench align %s/*.wbr* -o DATASETS"},
    [WB_FILE_REPORT] = {"report", "the folder of a report",
                        "open %s/report.html; wirebench report --check %s, if it is signed"},
    [WB_FILE_REPORT_NUMBERS] = {"report_json", "the numbers of a report",
                                "open report.html beside it; wirebench info --schema report "
                                "describes its keys"},
    [WB_FILE_MANIFEST] =
        {"manifest", "the manifest of a report",
         "wirebench report --check on its folder; wirebench info --schema manifest "
         "describes its keys"},
    [WB_FILE_VALIDATION] = {"validation", "the results of wirebench validate",
                            "open its figures; scores.csv has the errors and bounds"},
    [WB_FILE_HARNESS_RESULT] = {"harness_result", "the results of wirebench solve harness",
                                "open shapes.csv or forces.csv in it, its tables"},
    [WB_FILE_CHECK_LOG] = {"check_log", "a log of load-cell checks",
                           "wirebench stage RIG.yaml check MASS, which adds a line"},
    [WB_FILE_CARD] = {"card", "a card, the input of another program",
                      "read it with that program; wirebench does not read cards"},
    [WB_FILE_CHECKPOINT] = {"checkpoint", "a checkpoint of wirebench solve",
                            "run the command that wrote it again, with --checkpoint %s"},
    [WB_FILE_HDF5] = {"hdf5", "an HDF5 file",
                      "read it with another program (h5dump, h5py, MATLAB)"},
    [WB_FILE_VTK] = {"vtk", "a VTK file", "open it with ParaView"},
    [WB_FILE_GLTF] = {"gltf", "a 3D scene (glTF)", "open it with a glTF viewer or Blender"},
    [WB_FILE_FIGURE] = {"figure", "a figure or page", "open it with a viewer"},
};

const char *wb_file_kind_key(enum wb_file_kind kind)
{
    return rows[kind].key;
}

const char *wb_file_kind_name(enum wb_file_kind kind)
{
    return rows[kind].name;
}

void wb_file_kind_append_next(struct wb_text *text, enum wb_file_kind kind, const char *path)
{
    wb_finding_append_command(text, rows[kind].next, path, path);
}

/* --- folders --- */

static bool holds(const char *folder, const char *name)
{
    char path[WB_PATH];
    return wb_file_join(path, folder, name) == WB_OK && wb_file_exists(path);
}

static enum wb_file_kind find_folder(const char *folder)
{
    enum wb_file_kind kind = WB_FILE_UNKNOWN;
    if (holds(folder, "dataset.json"))
        return WB_FILE_DATASET;
    if (holds(folder, "report.json"))
        return WB_FILE_REPORT;
    if (holds(folder, "scores.csv"))
        return WB_FILE_VALIDATION;
    if (holds(folder, "harness.json"))
        return WB_FILE_HARNESS_RESULT;
    DIR *const listing = opendir(folder);
    for (const struct dirent *entry; listing && (entry = readdir(listing));) {
        char path[WB_PATH];
        if (entry->d_name[0] == '.' || wb_file_join(path, folder, entry->d_name) != WB_OK)
            continue;
        if (holds(path, "dataset.json"))
            kind = WB_FILE_DATASETS;
        else if (kind == WB_FILE_UNKNOWN && (wb_command_ends_in(entry->d_name, ".wbr") ||
                                             wb_command_ends_in(entry->d_name, ".wbr.zst")))
            kind = WB_FILE_RECORDINGS;
    }
    if (listing)
        closedir(listing);
    return kind;
}

/* The kind of a file by the folder that holds it. */
static enum wb_file_kind find_part(const char *path)
{
    char folder[WB_PATH];
    wb_file_folder(folder, path);
    return holds(folder, "dataset.json")   ? WB_FILE_PART_OF_DATASET
           : holds(folder, "scores.csv")   ? WB_FILE_VALIDATION
           : holds(folder, "harness.json") ? WB_FILE_HARNESS_RESULT
                                           : WB_FILE_UNKNOWN;
}

/* --- YAML files, by their keys --- */

/* A harness file has the same `kind` as the campaign that names it. */
static bool is_harness(const struct wb_config_node *root)
{
    static const char *const parts[] = {"branches", "wires", "root", "steps"};
    bool has_any = false;
    for (size_t i = 0; i < WB_COUNT(parts); i++)
        has_any = has_any || wb_config_find(root, parts[i]);
    return has_any && !wb_config_find(root, "harness");
}

/* `kind` is the value of that key: of a harness, of a machine, or of a campaign. */
static enum wb_file_kind find_by_kind(const struct wb_config_node *root, const char *kind)
{
    if (strcmp(kind, "harness") == 0 && is_harness(root))
        return WB_FILE_HARNESS;
    static const enum wb_test_kind tests[] = {WB_TEST_CANTILEVER, WB_TEST_THREE_POINT,
                                              WB_TEST_TENSILE};
    for (size_t i = 0; i < WB_COUNT(tests); i++) {
        if (strcmp(kind, wb_machine_kind_name(tests[i])) == 0)
            return WB_FILE_MACHINE;
    }
    for (int i = 0; i < WB_KINDS; i++) {
        if (strcmp(kind, wb_kinds[i]->name) == 0)
            return WB_FILE_CAMPAIGN;
    }
    return WB_FILE_UNKNOWN;
}

static enum wb_file_kind find_map(const struct wb_config_node *root)
{
    /* The first row whose keys are all there; keys that only this kind has stand first. */
    static const struct {
        enum wb_file_kind kind;
        const char *keys[3];
    } patterns[] = {
        {WB_FILE_RIG, {"load_cell"}},
        {WB_FILE_RIG, {"mocap"}},
        {WB_FILE_REPORT_NUMBERS, {"tool", "limit_exceeded", "files"}},
        {WB_FILE_MANIFEST, {"report", "inputs", "files"}},
        {WB_FILE_SERIES, {"series", "specimens"}},
        {WB_FILE_INDEX, {"recordings"}},
        {WB_FILE_INDEX, {"simulations"}},
        {WB_FILE_MODEL, {"wire", "history"}},
        {WB_FILE_BUNDLE, {"wires", "packing"}},
        {WB_FILE_BUNDLE, {"wires", "run"}},
        {WB_FILE_BUNDLE, {"wires", "interface"}},
        {WB_FILE_PROPERTIES, {"wire", "youngs_modulus_MPa"}},
        {WB_FILE_SPECIMEN, {"wire", "markers_mm"}},
        {WB_FILE_TEST_PIECE, {"wire", "sample"}},
        {WB_FILE_WIRE, {"name", "conductor_diameter_mm"}},
        {WB_FILE_MATERIAL, {"name", "youngs_modulus_MPa"}},
        {WB_FILE_MATERIAL, {"name", "density_g_cm3", "source"}},
        {WB_FILE_CAMPAIGN, {"calibration_length_mm"}},
        {WB_FILE_CAMPAIGN, {"title", "wires", "limits"}},
        {WB_FILE_MACHINE, {"name", "span_mm"}},
        {WB_FILE_CARD, {"card", "tool"}},
    };
    const struct wb_config_node *const node = wb_config_find(root, "kind");
    const char *const name = node ? wb_config_scalar(node) : NULL;
    if (name)
        return find_by_kind(root, name);
    for (size_t i = 0; i < WB_COUNT(patterns); i++) {
        bool has_all = true;
        for (size_t k = 0; k < WB_COUNT(patterns[i].keys) && patterns[i].keys[k]; k++)
            has_all = has_all && wb_config_find(root, patterns[i].keys[k]);
        if (has_all)
            return patterns[i].kind;
    }
    return WB_FILE_UNKNOWN;
}

static enum wb_file_kind find_yaml(const char *text, const char *path)
{
    struct wb_reason why = {.text = ""};
    struct wb_config *config;
    if (wb_config_parse(&config, text, path, &why) != WB_OK)
        return WB_FILE_UNKNOWN;
    /* The index of a series is a list. */
    const enum wb_file_kind kind = strcmp(wb_file_name(path), WB_INDEX_FILE) == 0
                                       ? WB_FILE_INDEX
                                       : find_map(wb_config_root(config));
    wb_config_destroy(config);
    return kind;
}

/* --- other texts --- */

/* Whether a line has two or more fields, and nothing but numbers in them. */
static bool is_row(const char *line, size_t length)
{
    static const char between[] = " \t;,|\r", number[] = "0123456789.:+-eE\"";
    int n = 0;
    for (size_t i = 0; i < length;) {
        bool has_digit = false;
        if (strchr(between, line[i])) {
            i++;
            continue;
        }
        for (; i < length && !strchr(between, line[i]); i++) {
            if (!strchr(number, line[i]))
                return false;
            has_digit = has_digit || isdigit((unsigned char)line[i]);
        }
        n += has_digit;
    }
    return n > 1;
}

static bool is_table(const char *text)
{
    int n_lines = 0, n_rows = 0;
    for (const char *line = text; *line;) {
        const size_t length = strcspn(line, "\n");
        n_lines += length > 1;
        n_rows += is_row(line, length);
        line += length + (line[length] != '\0');
    }
    return n_rows >= 4 && 2 * n_rows > n_lines;
}

static bool is_card(const char *text)
{
    return strstr(text, "Written by wirebench ") &&
           (strstr(text, " card of wire ") || strstr(text, " card (NOT RUN") ||
            strstr(text, "Table of wire "));
}

static enum wb_file_kind find_text(const char *text, const char *path)
{
    enum wb_file_kind kind = WB_FILE_UNKNOWN;
    if (is_card(text))
        return WB_FILE_CARD;
    if (strstr(text, "<VTKFile "))
        return WB_FILE_VTK;
    if (strstr(text, "<svg ") || strncmp(text, "<!DOCTYPE html", 14) == 0)
        return WB_FILE_FIGURE;
    if (strncmp(text, "utc,known_mass_g,", 17) == 0)
        return WB_FILE_CHECK_LOG;
    const bool is_yaml = wb_command_ends_in(path, ".yaml") || wb_command_ends_in(path, ".yml");
    if (!is_yaml && find_part(path) != WB_FILE_UNKNOWN)
        return find_part(path);
    if (!wb_command_ends_in(path, ".csv"))
        kind = find_yaml(text, path);
    return kind == WB_FILE_UNKNOWN && !is_yaml && is_table(text) ? WB_FILE_TABLE : kind;
}

/* --- files --- */

static enum wb_file_kind find_head(const char *head, size_t n)
{
    static const struct {
        const char *bytes;
        size_t n;
        enum wb_file_kind kind;
    } magic[] = {
        {"SQLite format 3", 16, WB_FILE_RECORDING},
        {"wirebench checkpoint ", 21, WB_FILE_CHECKPOINT},
        {"\x89HDF\r\n\x1a\n", 8, WB_FILE_HDF5},
        {"\x89PNG\r\n\x1a\n", 8, WB_FILE_FIGURE},
        {"%PDF-", 5, WB_FILE_FIGURE},
        {"glTF", 4, WB_FILE_GLTF},
    };
    for (size_t i = 0; i < WB_COUNT(magic); i++) {
        if (n >= magic[i].n && memcmp(head, magic[i].bytes, magic[i].n) == 0)
            return magic[i].kind;
    }
    return WB_FILE_UNKNOWN;
}

static size_t read_head(const char *path, char head[HEAD])
{
    FILE *const file = fopen(path, "rb");
    const size_t n = file ? fread(head, 1, HEAD, file) : 0;
    if (file)
        fclose(file);
    return n;
}

/* Whether these bytes are UTF-16, as testing machines write it, mostly of Latin letters; leaves the
 * other half of the bytes out. */
static bool narrow(char *bytes, size_t size)
{
    size_t n = 0;
    for (size_t i = 0; i < size; i++)
        n += bytes[i] != '\0';
    if (size < 4 || 3 * n < size || 3 * n > 2 * size)
        return false;
    n = 0;
    for (size_t i = 0; i < size; i++) {
        if (bytes[i] != '\0')
            bytes[n++] = bytes[i];
    }
    bytes[n] = '\0';
    return true;
}

enum wb_file_kind wb_file_kind_find(const char *path)
{
    struct stat what;
    struct wb_reason why = {.text = ""};
    char head[HEAD], *bytes;
    size_t size;
    if (wb_file_is_folder(path))
        return find_folder(path);
    /* By its name, because the recording may be damaged or compressed. */
    if (wb_command_ends_in(path, ".wbr") || wb_command_ends_in(path, ".wbr.zst"))
        return WB_FILE_RECORDING;
    /* A pipe can be read only once. */
    if (stat(path, &what) != 0 || !S_ISREG(what.st_mode))
        return WB_FILE_UNKNOWN;
    const enum wb_file_kind kind = find_head(head, read_head(path, head));
    if (kind != WB_FILE_UNKNOWN || what.st_size > LARGEST_TEXT ||
        wb_file_read_with_reason(path, &bytes, &size, &why) != WB_OK)
        return kind;
    const bool is_take = wb_take_reader_detect((const uint8_t *)bytes, size) != NULL;
    const bool is_text = strlen(bytes) == size || narrow(bytes, size);
    const enum wb_file_kind found = is_take   ? WB_FILE_TAKE
                                    : is_text ? find_text(bytes, path)
                                              : WB_FILE_UNKNOWN;
    free(bytes);
    return found;
}

enum wb_status wb_file_kind_check(const char *path, uint64_t expected)
{
    const enum wb_file_kind kind = wb_file_kind_find(path);
    struct wb_text wanted = {0}, next = {0};
    if (kind == WB_FILE_UNKNOWN || (expected & WB_FILE_BIT(kind)) != 0)
        return WB_OK;
    for (int i = 0; i < WB_FILE_KINDS; i++) {
        if ((expected & WB_FILE_BIT(i)) != 0)
            wb_text_append(&wanted, "%s%s", wanted.length > 0 ? " or " : "", rows[i].name);
    }
    wb_file_kind_append_next(&next, kind, path);
    wb_error("'%s' is %s, expected %s; for this file: %s", path, rows[kind].name,
             wb_text_string(&wanted), wb_text_string(&next));
    wb_text_release(&wanted);
    wb_text_release(&next);
    return WB_ERR_FORMAT;
}

enum wb_status wb_file_kind_find_input(const char **name, char path[WB_PATH], uint64_t expected)
{
    *name = wb_command_find(*name, path);
    return wb_file_kind_check(*name, expected);
}
