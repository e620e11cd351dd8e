/* Keys of dataset.json; those of simulations are in schema_simulation.c. */
#include "analysis/align/align_keys.h"
#include "analysis/dataset/machine_import.h"
#include "analysis/schema/tables.h"

static const struct wb_key test_rows[] = {
    {"wire", TEXT, "name of the product"},
    {"sample", INTEGER, "number of the piece; 0: none"},
    {"length_mm", NUMBER,
     "free length; of a three-point test the span, of a tensile test the gauge length"},
    {"outer_diameter_mm", NUMBER, "outer diameter"},
    {"mass_per_length_kg_m", NUMBER, "mass per length; 0: not known, of a testing machine"},
    {"poissons_ratio", NUMBER, "Poisson's ratio"},
    {"loading", TEXT | OPTIONAL,
     "`tip`: a strand or a vertical force raises the tip; `follower`: the force stays normal to "
     "the "
     "wire at its tip; `general`: other simulated loads, without a force-deflection curve for a "
     "calibration; absent: `tip`",
     .choices = "tip|follower|general"},
    {"strand_length_mm", NUMBER,
     "length of the strand; 0: there is none, and the force is vertical or a follower force"},
    {"counterweight_g", NUMBER, "mass at the tip"},
    {"gravity_m_s2", NUMBER, "gravity; 0: the data do not contain weight"},
    {"rest_level_mm", NUMBER | UNKNOWN, "y of the rest below the tip; null: there was none"},
    {"natural_shape_rad", NUMBER | LIST,
     "b_0, b_1, ... of the stress-free angle, the sum of b_i (s/L)^(i+1)"},
    {"natural_bow_mm", NUMBER, "natural offset of the tip that follows from them"},
    {"u_gain_percent", NUMBER | OPTIONAL, "standard uncertainty of the load cell's gain"},
    {"u_length_mm", NUMBER | OPTIONAL, "standard uncertainty of the free length"},
    {"u_counterweight_g", NUMBER | OPTIONAL, "standard uncertainty of the counterweight"},
    {"u_outer_diameter_mm", NUMBER | OPTIONAL, "standard uncertainty of the outer diameter"},
    {"u_density_percent", NUMBER | OPTIONAL, "standard uncertainty of the density"},
    {"u_marker_offset_mm", NUMBER | OPTIONAL,
     "standard uncertainty of the markers' distance from the axis"},
    {"virtual_rig", FLAG, "the data come from a virtual rig"},
    {"simulation", FLAG, "the data come from `solve`"},
    {"kind", TEXT | OPTIONAL, "kind of test; absent: cantilever", .choices = "three-point|tensile"},
};
static WB_KEYS(test, "test",
               "What other commands need of the test; an absent uncertainty is not stated.");

static const struct wb_key piece_rows[] = {
    {"series", TEXT | OPTIONAL, "series that the test belongs to"},
    {"outer_diameter_mm", NUMBER | OPTIONAL, "outer diameter"},
    {"length_mm", NUMBER | OPTIONAL, "length of the piece"},
    {"mass_per_length_g_m", NUMBER | OPTIONAL, "mass per length"},
    {"usable_travel_mm", NUMBER | LIST | OPTIONAL,
     "travel up to which the test is used, least and largest"},
    {"natural_bow_mm", NUMBER | LIST | OPTIONAL, "natural bow, least and largest"},
    {"constituent", TEXT | OPTIONAL, "of a tensile test: part of the wire that was pulled",
     .choices = "conductor|jacket|tape"},
    {"area_mm2", NUMBER | OPTIONAL, "of a tensile test: area of its section"},
};
static WB_KEYS(piece, "test_piece",
               "What is known of the specimen of a testing machine besides `test`.");

static const struct wb_key common_rows[] = {
    {"schema", INTEGER, "layout of the file, 1"},
    {"name", TEXT, "name of the dataset"},
    {"test", OBJECT, "what other commands need of the test", &test_keys},
};
static WB_KEYS(common, "dataset_keys", "");

static const struct wb_key aligned_rows[] = {
    {.of = &common_keys},
    {.of = &wb_align_document_keys},
};
static WB_KEYS(aligned, "dataset_of_recording", "The dataset of a recording, by `align`.");

static const struct wb_key imported_rows[] = {
    {.of = &common_keys},
    {"tool", OBJECT, "program that imported the file", &wb_common_tool_keys},
    {"import", OBJECT, "the file", &wb_machine_import_keys},
    {"complete", FLAG, "false: the file is cut, or there are gaps in time"},
    {"machine", OBJECT, "testing machine", &wb_common_machine_keys},
    {"test_piece", OBJECT, "what else is known of the specimen", &piece_keys},
};
static WB_KEYS(imported, "dataset_of_machine",
               "The dataset of a testing machine, by `import force`.");

static const struct wb_key simulated_rows[] = {
    {.of = &common_keys},
    {"complete", FLAG | OPTIONAL,
     "whether the whole loading was computed; of `cantilever` and `bending3p` see `converged`"},
    {"simulation", OBJECT, "the computation", &wb_schema_simulation},
    {"tool", OBJECT, "program that computed the dataset", &wb_common_tool_keys},
    {"machine", OBJECT | OPTIONAL, "of `bending3p`: the testing machine", &wb_common_machine_keys},
    {"test_piece", OBJECT | OPTIONAL, "of `bending3p`: the specimen", &piece_keys},
};
static WB_KEYS(simulated, "dataset_of_simulation", "The dataset of a simulation, by `solve`.");

static const struct wb_keys *const kinds[] = {&aligned_keys, &imported_keys, &simulated_keys, NULL};
const struct wb_keys wb_schema_dataset = {
    "dataset", "A dataset comes from a recording, a testing machine or a simulation.",
    .alternatives = kinds};
