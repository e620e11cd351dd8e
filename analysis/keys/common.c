#include "analysis/keys/common.h"

#include "analysis/keys/row.h"
#include "base/version.h"

static const struct wb_key wb_common_tool_rows[] = {
    {"name", TEXT, "program and command"},
    {"version", TEXT, "version of the program"},
    {"revision", TEXT, "revision of the sources that the program was built from"},
    {"confirmed_by_revision", TEXT | OPTIONAL,
     "of a stored simulation: a later revision, whose results are the same within the tolerances"},
};
WB_KEYS(wb_common_tool, "tool", "The program that wrote the file.");

void wb_keys_put_tool(struct wb_json *object, const char *name)
{
    struct wb_json *const tool = wb_json_set_object(object, "tool");
    wb_json_set_text(tool, "name", name);
    wb_json_set_text(tool, "version", wb_version());
    wb_json_set_text(tool, "revision", wb_version_revision());
}

static const struct wb_key wb_common_excluded_rows[] = {
    {"by", TEXT, "who excluded the test"},
    {"reason", TEXT, "why the test was excluded"},
    {"date_utc", TEXT | UNKNOWN, "when the test was excluded"},
};
WB_KEYS(wb_common_excluded, "excluded", "The exclusion of a test, from the index of recordings.");

static const struct wb_key wb_common_sum_rows[] = {
    {"file", TEXT, "name of the file"},
    {"sha256", TEXT, "SHA-256 of the file"},
};
WB_KEYS(wb_common_sum, "sum", "A file and its checksum.");

static const struct wb_key wb_common_machine_rows[] = {
    {"name", TEXT, "name of the machine"},
    {"kind", TEXT, "kind of test", .choices = "cantilever|three-point|tensile"},
    {"span_mm", NUMBER | OPTIONAL, "distance between the axes of the rollers"},
    {"roller_radius_mm", NUMBER | OPTIONAL, "radius of the rollers"},
    {"nose_radius_mm", BAND | OPTIONAL, "radius of the nose; a list: least and largest"},
    {"friction", BAND | OPTIONAL,
     "friction coefficient between the wire and rollers and nose; a list: least and largest"},
    {"gauge_length_mm", NUMBER | OPTIONAL, "length over which the elongation is measured"},
    {"elongation", TEXT | OPTIONAL, "how the elongation is measured",
     .choices = "crosshead|extensometer"},
    {"bends", TEXT | OPTIONAL, "direction in which the tip of a cantilever moves",
     .choices = "up|sideways|down"},
    {"compliance_mm_N", BAND | OPTIONAL,
     "compliance of machine, load cell and fixture; a list: least and largest"},
    {"speed_mm_s", BAND | OPTIONAL, "speed of the travel; a list: least and largest"},
};
WB_KEYS(wb_common_machine, "machine", "The testing machine, as its machine file describes it.");
