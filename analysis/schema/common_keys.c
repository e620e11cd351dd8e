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

static const struct wb_key interval_rows[] = {
    {"median", NUMBER | UNKNOWN, "", "median of the runs"},
    {"low", NUMBER | UNKNOWN, "", "lower end of the band of 90 %, with the model's error"},
    {"high", NUMBER | UNKNOWN, "", "upper end of that band"},
    {"runs_low", NUMBER | UNKNOWN, "", "5 % quantile of the runs alone"},
    {"runs_high", NUMBER | UNKNOWN, "", "95 % quantile of the runs alone"},
};
static WB_KEYS(interval, "band", "A band of a predicted number, in the unit of its key.");

static const struct wb_key group_rows[] = {
    {"group", TEXT, "", "group of inputs"},
    {"share", NUMBER, "", "share of the ranks' variance that this group explains"},
    {"share_low", NUMBER, "", "lower end of its interval of 90 %"},
    {"share_high", NUMBER, "", "upper end of its interval of 90 %"},
};
static WB_KEYS(group, "ranking_group", "The influence of a group of inputs.");

static const struct wb_key ranking_rows[] = {
    {"of", TEXT, "", "result that the ranking is of", .choices = "force|deflection_springback"},
    {"deflection_mm", NUMBER | UNKNOWN, "mm", "deflection at which the result is taken"},
    {"R2", NUMBER | UNKNOWN, "", "share of the variance that ranks explain"},
    {"R2_low", NUMBER | UNKNOWN, "", "lower end of its interval"},
    {"R2_high", NUMBER | UNKNOWN, "", "upper end of its interval"},
    {"groups", OBJECT | LIST | OPTIONAL, "", "the groups of inputs; only from R2 = 0.9 on", &group},
};
static WB_KEYS(ranking, "ranking", "Which inputs the width of a band depends on.");

static const struct wb_key of_case_rows[] = {
    {"case", TEXT, "", "`file`, or the name of a scenario or of a combination of the sweep"},
    {"wires", INTEGER, "", "number of wires"},
    {"packing", TEXT, "", "packing of the wires"},
    {"tape_layers", NUMBER, "", "layers of tape, with overlap; 0: no tape"},
    {"tape_outline", TEXT, "", "how the tape lies round the wires", .choices = "none|circle|hull"},
    {"runs_not_converged", INTEGER, "", "runs that were not computed to the end"},
    {"draws_limited", INTEGER, "", "runs with a drawn law that had to be limited"},
    {"deflection_mm", NUMBER | OPTIONAL, "mm", "largest deflection that the band covers"},
    {"force_N", OBJECT | OPTIONAL, "N", "force at that deflection", &interval},
    {"deflection_springback", OBJECT, "",
     "springback of the deflection: 1 less the residual over the largest deflection", &interval},
    {"residual_curvature_ratio", OBJECT, "",
     "largest curvature along the bundle at zero force over that at the largest deflection",
     &interval},
    {"ranking", OBJECT | LIST, "", "which inputs the bands depend on", &ranking},
};
static WB_KEYS(of_case, "prediction_case", "A case that was predicted.");

static const struct wb_key wb_schema_uncertainty_rows[] = {
    {"confidence", NUMBER, "", "probability of the bands"},
    {"model_error", NUMBER, "", "standard deviation of the model's error, of the largest value"},
    {"runs", INTEGER, "", "runs of each case"},
    {"seed", INTEGER, "", "seed of the draws"},
    {"stopped", FLAG, "", "interrupted: the last case is missing"},
    {"laws_of_wires", TEXT | LIST, "", "source of the law of each kind of wire"},
    {"cases", OBJECT | LIST, "", "the cases", &of_case},
};
WB_KEYS(wb_schema_uncertainty, "uncertainty", "Bands of a bundle's prediction.");

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
