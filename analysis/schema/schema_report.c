/* Keys of report.json, and of manifest.json. */
#include "analysis/report/bench/recordings_kind.h"
#include "analysis/report/bundles/bundles_kind.h"
#include "analysis/report/harnesses/harnesses_kind.h"
#include "analysis/report/machines/machines_kind.h"
#include "analysis/report/numbers.h"
#include "analysis/report/predictions/predictions_kind.h"
#include "analysis/report/wires/wires_kind.h"
#include "analysis/schema/tables.h"

static const struct wb_keys *const kinds[] = {&wb_recordings_json_keys,
                                              &wb_wires_json_keys,
                                              &wb_bundles_json_keys,
                                              &wb_predictions_kind_keys,
                                              &wb_machines_kind_keys,
                                              &wb_harnesses_kind_keys,
                                              NULL};
const struct wb_keys wb_schema_report = {
    "report", "A report; its keys depend on the kind of the campaign.", .alternatives = kinds};

/* --- manifest.json --- */

static const struct wb_key manifest_input_rows[] = {
    {"what", TEXT, "kind of input", .choices = "recording|file"},
    {"name", TEXT,
     "name: of a recording; of a file relative to the campaign's folder or to the shipped data, "
     "or its folder and name"},
    {"sha256", TEXT, "SHA-256; of a recording of the uncompressed one"},
};
static WB_KEYS(manifest_input, "manifest_input", "A recording or a file that was read.");

static const struct wb_key manifest_file_rows[] = {
    {"name", TEXT, "name, relative to the report's folder"},
    {"sha256", TEXT, "SHA-256"},
};
static WB_KEYS(manifest_file, "manifest_file", "A file of the report.");

static const struct wb_key build_rows[] = {
    {"version", TEXT, "version of the program"},
    {"revision", TEXT, "revision of the sources"},
    {"compiler", TEXT, "compiler"},
    {"options", TEXT, "options of the compiler that choose machine code"},
    {"processor", TEXT, "vector instructions, and the processor that OpenBLAS assumes"},
    {"libraries", OBJECT | LIST, "libraries of the process", &wb_common_sum_keys},
    {"fonts", OBJECT | LIST, "fonts of the report", &wb_common_sum_keys},
};
static WB_KEYS(build, "build", "The program that made the report.");

static const struct wb_key wb_schema_manifest_rows[] = {
    {"report", TEXT, "number of the report; empty without a laboratory"},
    {"title", TEXT, "title of the report"},
    {"amends", TEXT | OPTIONAL, "number of the report that this one replaces"},
    {"campaign", OBJECT, "campaign file", &wb_numbers_campaign_keys},
    {"inputs", OBJECT | LIST, "inputs of the report, sorted", &manifest_input_keys},
    {"files", OBJECT | LIST, "files of the report", &manifest_file_keys},
    {"build", OBJECT, "program that made the report", &build_keys},
};
WB_KEYS(wb_schema_manifest, "manifest", "The inputs and files of a signed report.");
