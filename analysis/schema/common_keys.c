/* Keys that several files have, and those of reports of all kinds. */
#include "analysis/schema/report_keys.h"

static const struct wb_key wb_schema_tool_rows[] = {
    {"name", TEXT, "", "program and command"},
    {"version", TEXT, "", "version of the program"},
    {"revision", TEXT, "", "revision of the sources that the program was built from"},
    {"confirmed_by_revision", TEXT | OPTIONAL, "",
     "of a stored simulation: a later revision, whose results are the same within the tolerances"},
};
WB_KEYS(wb_schema_tool, "tool", "The program that wrote the file.");

static const struct wb_key wb_schema_campaign_rows[] = {
    {"file", TEXT, "", "name of the campaign file"},
    {"sha256", TEXT, "", "SHA-256 of the campaign file"},
};
WB_KEYS(wb_schema_campaign, "campaign", "The campaign file.");

static const struct wb_key wb_schema_excluded_rows[] = {
    {"by", TEXT, "", "who excluded the test"},
    {"reason", TEXT, "", "why the test was excluded"},
    {"date_utc", TEXT | UNKNOWN, "", "when the test was excluded"},
};
WB_KEYS(wb_schema_excluded, "excluded", "The exclusion of a test, from the index of recordings.");

static const struct wb_key wb_schema_sum_rows[] = {
    {"file", TEXT, "", "name of the file"},
    {"sha256", TEXT, "", "SHA-256 of the file"},
};
WB_KEYS(wb_schema_sum, "sum", "A file and its checksum.");

static const struct wb_key wb_schema_machine_rows[] = {
    {"name", TEXT, "", "name of the machine"},
    {"kind", TEXT, "", "kind of test", .choices = "cantilever|three-point|tensile"},
    {"span_mm", NUMBER | OPTIONAL, "mm", "distance between the axes of the rollers"},
    {"roller_radius_mm", NUMBER | OPTIONAL, "mm", "radius of the rollers"},
    {"nose_radius_mm", BAND | OPTIONAL, "mm", "radius of the nose; a list: least and largest"},
    {"friction", BAND | OPTIONAL, "",
     "friction coefficient between the wire and rollers and nose; a list: least and largest"},
    {"gauge_length_mm", NUMBER | OPTIONAL, "mm", "length over which the elongation is measured"},
    {"elongation", TEXT | OPTIONAL, "", "how the elongation is measured",
     .choices = "crosshead|extensometer"},
    {"bends", TEXT | OPTIONAL, "", "direction in which the tip of a cantilever moves",
     .choices = "up|sideways|down"},
    {"compliance_mm_N", BAND | OPTIONAL, "mm/N",
     "compliance of machine, load cell and fixture; a list: least and largest"},
    {"speed_mm_s", BAND | OPTIONAL, "mm/s", "speed of the travel; a list: least and largest"},
};
WB_KEYS(wb_schema_machine, "machine", "The testing machine, as its machine file describes it.");

/* --- reports of all kinds --- */

static const struct wb_key amends_rows[] = {
    {"report", TEXT, "", "number of the report that this one replaces"},
    {"issued", TEXT, "", "date of that report"},
    {"why", TEXT, "", "what changed"},
};
static WB_KEYS(amends, "amends", "The report that this one replaces.");

static const struct wb_key laboratory_rows[] = {
    {"report", TEXT | OPTIONAL, "", "number of the report"},
    {"name", TEXT | OPTIONAL, "", "name of the laboratory"},
    {"address", TEXT | OPTIONAL, "", "address of the laboratory"},
    {"place", TEXT | OPTIONAL, "", "place of the tests"},
    {"customer", TEXT | OPTIONAL, "", "customer, with contact"},
    {"item", TEXT | OPTIONAL, "", "items that were tested"},
    {"item_state", TEXT | OPTIONAL, "", "condition of the items"},
    {"received", TEXT | OPTIONAL, "", "date on which the items were received"},
    {"tested_from", TEXT | OPTIONAL, "", "first day of the tests"},
    {"tested_until", TEXT | OPTIONAL, "", "last day of the tests"},
    {"issued", TEXT | OPTIONAL, "", "date of the report"},
    {"method", TEXT | OPTIONAL, "", "method"},
    {"deviations", TEXT | OPTIONAL, "", "deviations from the method"},
    {"sampling", TEXT | OPTIONAL, "", "how the items were sampled"},
    {"external", TEXT | OPTIONAL, "", "results from external providers"},
    {"environment", TEXT | OPTIONAL, "", "environmental conditions"},
    {"authorised_by", TEXT | OPTIONAL, "", "who authorises the report"},
    {"decision_rule", TEXT, "", "rule by which limits are judged", .choices = "simple|guarded"},
    {"amends", OBJECT | OPTIONAL, "", "report that this one replaces", &amends},
    {"missing", TEXT | LIST, "", "required fields that the campaign file lacks"},
};
static WB_KEYS(laboratory, "laboratory",
               "The fields of a laboratory, as the campaign file has them.");

static const struct wb_key report_end_rows[] = {
    {"laboratory", OBJECT | OPTIONAL, "", "fields of a laboratory", &laboratory},
    {"files", TEXT | LIST, "", "files of the report, relative to its folder"},
};
static WB_KEYS(report_end, "report_end", "");

static const struct wb_key wb_schema_report_head_rows[] = {
    {"title", TEXT, "", "title of the campaign"},
    {"data", TEXT, "", "origin of the data",
     .choices = "measured|measured (virtual rig)|simulation"},
    {"schema", INTEGER, "", "layout of the file, 1"},
    {"tool", OBJECT, "", "program that wrote the report", &wb_schema_tool},
    {"campaign", OBJECT, "", "campaign file", &wb_schema_campaign},
    {"complete", FLAG, "", "false: data are missing (exit code 3)"},
    {"limit_exceeded", FLAG, "", "true: a limit of the campaign is exceeded (exit code 4)"},
    {.of = &report_end},
};
WB_KEYS(wb_schema_report_head, "report_head", "");

static const struct wb_key wb_schema_simulation_state_rows[] = {
    {"dataset", TEXT, "", "name of the dataset"},
    {"state", TEXT, "", "whether the dataset is used",
     .choices = "not wanted|missing|outdated|refused|used"},
    {"command", TEXT, "", "command that computes it"},
    {"problem", TEXT | OPTIONAL, "", "why it is not used"},
};
WB_KEYS(wb_schema_simulation_state, "simulation_state", "");
