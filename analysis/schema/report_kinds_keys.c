/* Keys of report.json of comparison, bundles, prediction and machine campaigns. */
#include "analysis/predict/bands_output.h"
#include "analysis/schema/report_keys.h"
#include "fe/model/bundle_model.h"

/* --- comparison --- */

static const struct wb_key peak_rows[] = {
    {"von_mises_MPa", NUMBER, "MPa", "largest von Mises stress"},
    {"at_mm", NUMBER | LIST, "mm", "its place in the straight wire: x, y, z"},
};
static WB_KEYS(peak, "stress_peak", "The largest stress of a part.");

static const struct wb_key section_rows[] = {
    {"state", TEXT, "", "name of the model's step"},
    {"section", TEXT, "", "kind of section", .choices = "longitudinal|cross"},
    {"from_clamp_mm", NUMBER | UNKNOWN, "mm", "place of a cross section; null: longitudinal"},
    {"core", OBJECT | OPTIONAL, "", "largest stress of the core", &peak},
    {"jacket", OBJECT | OPTIONAL, "", "largest stress of the jacket", &peak},
};
static WB_KEYS(section, "section", "A section with stress fields.");

static const struct wb_key run_rows[] = {
    {.of = &wb_simulation_state_keys},
    {"elements", NUMBER | UNKNOWN, "", "number of elements"},
    {"degrees_of_freedom", NUMBER | UNKNOWN, "", "number of unknowns"},
    {"iterations", NUMBER | UNKNOWN, "", "iterations of the equilibrium"},
    {"cpu_s", NUMBER | UNKNOWN, "s", "CPU time"},
    {"peak_memory_MB", NUMBER | UNKNOWN, "MB", "largest memory of the process"},
    {"slip_mm", NUMBER | OPTIONAL, "mm", "with friction: largest slip"},
    {"slip_limit_mm", NUMBER | UNKNOWN | OPTIONAL, "mm",
     "with friction: limit of the assumption of small sliding"},
    {"opening_mm", NUMBER | UNKNOWN | OPTIONAL, "mm", "with friction: largest opening"},
    {"sha256", TEXT | OPTIONAL, "", "SHA-256 of force_deflection.csv"},
    {"follower_force_N", NUMBER | UNKNOWN | OPTIONAL, "N", "follower force"},
    {"tip_mm", NUMBER | LIST | UNKNOWN | OPTIONAL, "mm", "place of the tip: x, y, z"},
    {"tip_angle_degrees", NUMBER | UNKNOWN | OPTIONAL, "degree", "slope angle at the tip"},
    {"largest_distance_from_solid_mm", NUMBER | UNKNOWN | OPTIONAL, "mm",
     "largest distance of the axes of rod and solid"},
    {"sections", OBJECT | LIST | OPTIONAL, "", "sections with stress fields", &section},
    {"tip_moved_at_most_mm", NUMBER | UNKNOWN | OPTIONAL, "mm",
     "with residual stress: largest distance of the tip from that of the model without"},
};
static WB_KEYS(run, "comparison_run",
               "A dataset of a case; the keys from `sha256` on are of a used one.");

static const struct wb_key of_case_rows[] = {
    {"label", TEXT, "", "name of the case in the report"},
    {"model", TEXT, "", "name of the model"},
    {"inputs_sha256", TEXT, "", "SHA-256 of the solid's inputs"},
    {"wire3d", OBJECT | OPTIONAL, "", "dataset of the solid", &run},
    {"wire1d", OBJECT | OPTIONAL, "", "dataset of the rod", &run},
    {"cpu_of_rod_over_solid", NUMBER | UNKNOWN | OPTIONAL, "",
     "CPU time of the rod over that of the solid"},
};
static WB_KEYS(of_case, "comparison_case", "A case of the comparison.");

static const struct wb_key stress_rows[] = {
    {"from_clamp_mm", NUMBER, "mm", "place of the cross section"},
    {"core", OBJECT | OPTIONAL, "", "largest stress of the core", &peak},
    {"jacket", OBJECT | OPTIONAL, "", "largest stress of the jacket", &peak},
    {"curvature_per_mm", NUMBER | UNKNOWN, "1/mm", "curvature of the exact rod there"},
    {"E_kappa_r_MPa", NUMBER | UNKNOWN, "MPa", "stress E kappa r of beam theory"},
};
static WB_KEYS(stress, "elastic_stress", "Stresses of a cross section of the elastic solid.");

static const struct wb_key rod_rows[] = {
    {"reached", FLAG, "", "the rod reached the force"},
    {"tip_x_mm", NUMBER | UNKNOWN, "mm", "x of the tip"},
    {"tip_y_mm", NUMBER | UNKNOWN, "mm", "y of the tip"},
    {"tip_angle_degrees", NUMBER | UNKNOWN, "degree", "slope angle at the tip"},
    {"largest_distance_from_solid_mm", NUMBER | UNKNOWN | OPTIONAL, "mm",
     "largest distance of the axes of rod and solid"},
    {"x_mm", NUMBER | LIST | UNKNOWN, "mm", "x of the axis"},
    {"y_mm", NUMBER | LIST | UNKNOWN, "mm", "y of the axis"},
    {"force_N", NUMBER | LIST | UNKNOWN | OPTIONAL, "N", "forces of the curve"},
    {"deflection_mm", NUMBER | LIST | UNKNOWN | OPTIONAL, "mm", "deflections of the curve"},
    {"angle_degrees", NUMBER | LIST | UNKNOWN | OPTIONAL, "degree", "slope angles of the curve"},
};
static WB_KEYS(rod, "rod", "A rod under the same force.");

static const struct wb_key fit_rows[] = {
    {"printed", OBJECT | OPTIONAL, "", "published properties", &wb_keys_ludwik},
    {"problem", TEXT | OPTIONAL, "", "why there is no fit"},
    {"properties", OBJECT | OPTIONAL, "", "fitted properties", &wb_keys_ludwik},
    {"rms_over_largest_deflection", NUMBER | UNKNOWN | OPTIONAL, "",
     "RMS error over the largest deflection"},
    {"F_max_N", NUMBER | OPTIONAL, "N", "largest force"},
    {"max_deflection_mm", NUMBER | OPTIONAL, "mm", "largest deflection"},
    {"stopped_because", TEXT | OPTIONAL, "", "why the search ended"},
    {"beam_runs", INTEGER | OPTIONAL, "", "computations of the beam"},
    {"rod", OBJECT | OPTIONAL, "", "rod with the fitted properties", &rod},
};
static WB_KEYS(fit, "comparison_fit", "The homogenised law fitted to the solid.");

static const struct wb_key wb_schema_report_comparison_rows[] = {
    {.of = &wb_numbers_head_keys},
    {"jacket_modulus_per_percent_of_core_MPa", NUMBER, "MPa",
     "change of the jacket's E by eq. 8 when the core's E changes by 1 %"},
    {"cases", OBJECT | LIST, "", "cases", &of_case},
    {"elastic_stresses", OBJECT | LIST, "", "stresses of the elastic solid", &stress},
    {"exact_elastic_rod", OBJECT | OPTIONAL, "", "elastica", &rod},
    {"fit", OBJECT, "", "homogenised law fitted to the solid", &fit},
    {"printed_rod", OBJECT | OPTIONAL, "", "rod with the published properties", &rod},
    {"printed_collapse_force_N", NUMBER | UNKNOWN | OPTIONAL, "N",
     "force at which that rod would collapse without hardening"},
};
WB_KEYS(wb_schema_report_comparison, "report_of_comparison",
        "The report of a comparison campaign.");

/* --- bundles --- */

static const struct wb_key verdict_rows[] = {
    {"limit", TEXT, "", "key of the limit"},  {"of", TEXT, "", "bundle or run"},
    {"value", NUMBER | UNKNOWN, "", "value"}, {"largest", NUMBER, "", "limit of the value"},
    {"kept", FLAG, "", "the limit is kept"},
};
static WB_KEYS(verdict, "verdict", "A limit and whether it is kept.");

static const struct wb_key beam_rows[] = {
    {"outer_diameter_mm", NUMBER, "mm", "outer diameter"},
    {.of = &wb_keys_ludwik},
    {"EI_N_mm2", NUMBER, "N mm2", "flexural rigidity"},
};
static WB_KEYS(beam, "beam", "A homogenised beam.");

static const struct wb_key result_rows[] = {
    {.of = &wb_simulation_state_keys},
    {"sha256", TEXT | OPTIONAL, "", "SHA-256 of force_deflection.csv"},
    {"tool_revision", TEXT | OPTIONAL, "", "revision of the program that computed it"},
    {"cpu_s", NUMBER | UNKNOWN | OPTIONAL, "s", "CPU time"},
};
static WB_KEYS(result, "bundle_dataset", "A dataset.");

static const struct wb_key bundle_rows[] = {
    {"label", TEXT, "", "name in the report"},
    {"group", TEXT, "", "group of the bundle"},
    {"decaying_friction", TEXT, "", "name of the run with decaying friction"},
    {"constant_friction", TEXT | OPTIONAL, "", "name of the run with constant friction"},
    {"packed_diameter_mm", NUMBER, "mm", "diameter of wires and tape"},
    {"EI_sliding_N_mm2", NUMBER, "N mm2", "elastic flexural rigidity of sliding wires"},
    {"EI_bonded_N_mm2", NUMBER, "N mm2", "elastic flexural rigidity of bonded wires"},
    {"published", OBJECT | OPTIONAL, "", "published beam", &beam},
    {"fit_problem", TEXT | OPTIONAL, "", "why no beam was fitted"},
    {"fitted", OBJECT | OPTIONAL, "", "beam fitted to the run with decaying friction", &beam},
    {"fit_rms", NUMBER | UNKNOWN | OPTIONAL, "", "RMS error of the fit over F_max"},
    {"fit_largest_error", NUMBER | UNKNOWN | OPTIONAL, "", "largest error of the fit over F_max"},
    {"fit_stopped_because", TEXT | OPTIONAL, "", "why the search ended"},
    {"fit_beam_runs", INTEGER | OPTIONAL, "", "computations of the beam"},
    {"fitted_force_N", NUMBER | LIST | UNKNOWN | OPTIONAL, "N",
     "force of the fitted beam at the run's deflections"},
    {"rod", OBJECT | OPTIONAL, "", "dataset of the published beam", &result},
    {"cpu_of_rod_over_bundle", NUMBER | UNKNOWN | OPTIONAL, "",
     "CPU time of the beam over that of the bundle"},
};
static WB_KEYS(bundle, "report_bundle", "A bundle.");

static const struct wb_key elastic_rows[] = {
    {"length_mm", NUMBER, "mm", "length"},
    {"EI_N_mm2", NUMBER | UNKNOWN, "N mm2", "flexural rigidity at that length"},
    {"newmark_alpha_L", NUMBER | UNKNOWN, "", "alpha L of Newmark's theory"},
};
static WB_KEYS(elastic, "section_rigidity", "The elastic rigidity at one length.");

static const struct wb_key section_model_rows[] = {
    {"problem", TEXT | OPTIONAL, "", "why the section model was not computed"},
    {"friction_used", NUMBER | OPTIONAL, "", "friction coefficient"},
    {"friction_is_mean_of_decay", FLAG | OPTIONAL, "",
     "it is the geometric mean of a static and a kinetic coefficient"},
    {"rms", NUMBER | UNKNOWN | OPTIONAL, "", "RMS difference from the run's curve over its F_max"},
    {"largest_error", NUMBER | UNKNOWN | OPTIONAL, "", "largest difference over F_max"},
    {"tape_loosens_mm", NUMBER | UNKNOWN | OPTIONAL, "mm",
     "deflection from which the section model is too stiff, as the tape loosens; null: nowhere"},
    {"elastic", OBJECT | LIST | OPTIONAL, "", "elastic rigidity", &elastic},
    {"force_N", NUMBER | LIST | UNKNOWN | OPTIONAL, "N", "force at the run's deflections"},
};
static WB_KEYS(section_model, "section_model", "The section model of the same bundle.");

static const struct wb_setting_table friction_setting = {wb_bundle_model_friction_setting, 1};
static const struct wb_setting_table cohesion_setting = {wb_bundle_model_cohesion_setting, 1};

static const struct wb_key bundle_run_rows[] = {
    {"name", TEXT, "", "name of the run"},
    {"bundle", TEXT, "", "name of the bundle's file"},
    {"inputs_sha256", TEXT, "", "SHA-256 of the inputs"},
    {"mesh", TEXT, "", "name of the mesh"},
    {.settings = &friction_setting},
    {.settings = &cohesion_setting},
    {"strand_mm", NUMBER, "mm", "length of the strand; 0: a vertical force"},
    {"weight", FLAG, "", "weight acts"},
    {"mass_scaling", NUMBER, "", "mass scaling f_m of eq. 29"},
    {"selective_mass_scaling", NUMBER, "", "selective mass scaling beta; 1: none"},
    {.of = &result},
    {"section_model", OBJECT | OPTIONAL, "", "section model", &section_model},
    {"elements", NUMBER | UNKNOWN | OPTIONAL, "", "number of hexahedra"},
    {"shells", NUMBER | UNKNOWN | OPTIONAL, "", "number of shells"},
    {"steps", NUMBER | UNKNOWN | OPTIONAL, "", "time steps of the last attempt"},
    {"time_step_s", NUMBER | UNKNOWN | OPTIONAL, "s", "time step"},
    {"duration_s", NUMBER | UNKNOWN | OPTIONAL, "s", "duration of a loading"},
    {"ns_per_element_step", NUMBER | UNKNOWN | OPTIONAL, "ns", "CPU time over hexahedra and steps"},
    {"kinetic_over_internal", NUMBER | UNKNOWN | OPTIONAL, "",
     "largest kinetic over internal energy"},
    {"artificial_over_internal", NUMBER | UNKNOWN | OPTIONAL, "",
     "largest artificial over internal energy"},
    {"imbalance_over_external", NUMBER | UNKNOWN | OPTIONAL, "",
     "largest imbalance over external work"},
    {"largest_strain", NUMBER | UNKNOWN | OPTIONAL, "", "largest logarithmic strain"},
    {"beyond_strain_limit", FLAG | OPTIONAL, "",
     "a strain exceeds 5 % in wires or 10 % in the tape"},
    {"largest_penetration_mm", NUMBER | UNKNOWN | OPTIONAL, "mm", "largest penetration of wires"},
    {"deflection_mm", NUMBER | LIST | OPTIONAL, "mm", "deflections of the curves"},
    {"F_max_N", NUMBER | OPTIONAL, "N", "largest force of the run"},
    {"force_N", NUMBER | LIST | UNKNOWN | OPTIONAL, "N", "force of the run"},
    {"published_force_N", NUMBER | LIST | UNKNOWN | OPTIONAL, "N", "force of the published beam"},
    {"error", NUMBER | LIST | UNKNOWN | OPTIONAL, "", "difference over `published_F_max_N`"},
    {"published_F_max_N", NUMBER | UNKNOWN | OPTIONAL, "N", "largest force of the published beam"},
    {"rms", NUMBER | UNKNOWN | OPTIONAL, "", "RMS of `error`"},
    {"largest_error", NUMBER | UNKNOWN | OPTIONAL, "", "largest of `error`"},
};
static WB_KEYS(bundle_run, "report_run",
               "A run; the keys from `elements` on are of a used dataset.");

static const struct wb_key wb_schema_report_bundles_rows[] = {
    {.of = &wb_numbers_head_keys},
    {"limits", OBJECT | LIST, "", "limits of the campaign", &verdict},
    {"bundles", OBJECT | LIST, "", "bundles", &bundle},
    {"runs", OBJECT | LIST, "", "runs", &bundle_run},
};
WB_KEYS(wb_schema_report_bundles, "report_of_bundles", "The report of a campaign of bundles.");

/* --- prediction --- */

static const struct wb_key place_rows[] = {
    {"of", TEXT, "", "the number", .choices = "force_N|deflection_springback"},
    {"deflection_mm", NUMBER | OPTIONAL, "mm", "of a force: deflection"},
    {"test", NUMBER | UNKNOWN, "", "value of the test, in N or as a ratio"},
    {"median", NUMBER | UNKNOWN, "", "median of the band"},
    {"low", NUMBER | UNKNOWN, "", "lower end of the band"},
    {"high", NUMBER | UNKNOWN, "", "upper end of the band"},
    {"it_lies", TEXT, "", "place of the test's value", .choices = "below|within|above|not reached"},
};
static WB_KEYS(place, "predicted_number", "A number of a test and its band.");

static const struct wb_key test_rows[] = {
    {"label", TEXT, "", "name in the report"},
    {"dataset", TEXT, "", "folder of the dataset, as given"},
    {"problem", TEXT | OPTIONAL, "", "why the test is not compared"},
    {"sha256", TEXT | OPTIONAL, "", "SHA-256 of force_deflection.csv"},
    {"origin", TEXT | OPTIONAL, "", "origin of the test",
     .choices = "measured|measured on a virtual rig|a simulation, no test"},
    {"case", TEXT | OPTIONAL, "", "case that the test is compared with"},
    {"verdict", TEXT | OPTIONAL, "", "verdict on all numbers"},
    {"places", OBJECT | LIST | OPTIONAL, "", "the numbers", &place},
};
static WB_KEYS(test, "predicted_test", "A test beside the bands.");

static const struct wb_key predicted_rows[] = {
    {"label", TEXT, "", "name in the report"},
    {"bundle", TEXT, "", "name of the bundle's file"},
    {"inputs_sha256", TEXT, "", "SHA-256 of the inputs of the section model"},
    {"uncertainty", OBJECT | OPTIONAL, "", "bands", &wb_bands_output_keys},
    {"problem", TEXT | OPTIONAL, "", "why there are no bands"},
    {"tests", OBJECT | LIST, "", "tests", &test},
};
static WB_KEYS(predicted, "predicted_bundle", "A bundle.");

static const struct wb_key wb_schema_report_prediction_rows[] = {
    {.of = &wb_numbers_head_keys},
    {"bundles", OBJECT | LIST, "", "bundles", &predicted},
};
WB_KEYS(wb_schema_report_prediction, "report_of_prediction",
        "The report of a campaign of predictions.");

/* --- machine --- */
