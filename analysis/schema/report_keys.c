/* Keys of report.json of recordings, and of manifest.json. The other kinds of report are in
 * report_kinds_keys.c, the keys that all kinds share in common_keys.c. */
#include "analysis/schema/report_keys.h"
#include "analysis/calibration/paper/calibrate.h"

/* --- recordings --- */

static const struct wb_key settings_rows[] = {
    {.settings = &wb_calibrate_table, .applies = WB_CALIBRATE_REPORT},
};
static WB_KEYS(settings, "report_settings", "Settings of the calibration.");

static const struct wb_key limits_rows[] = {
    {"calibration_rms_max", NUMBER | OPTIONAL, "", "limit of the RMS of calibrations over F_max"},
    {"validation_rms_max", NUMBER | OPTIONAL, "", "limit of the RMS of validations over F_max"},
};
static WB_KEYS(limits, "report_limits", "Limits of the campaign.");

static const struct wb_key recording_rows[] = {
    {"name", TEXT, "", "name of the recording"},
    {"wire", TEXT, "", "name of the product"},
    {"purpose", TEXT, "", "use of the recording", .choices = "calibration|validation"},
    {"used", FLAG, "", "the recording is used"},
    {"seed", INTEGER | OPTIONAL, "", "seed of the virtual rig"},
    {"sha256", TEXT | OPTIONAL, "", "SHA-256 of the uncompressed recording"},
    {"excluded", OBJECT | OPTIONAL, "", "exclusion of the test", &wb_keys_excluded},
    {"problem", TEXT | OPTIONAL, "", "why the recording is not used"},
    {"sample", INTEGER | OPTIONAL, "", "number of the piece"},
    {"length_mm", NUMBER | OPTIONAL, "mm", "free length"},
    {"virtual_rig", FLAG | OPTIONAL, "", "the data come from a virtual rig"},
    {"start_utc", TEXT | OPTIONAL, "", "start of the test"},
    {"tool_revision", TEXT | OPTIONAL, "", "revision of the program that recorded"},
    {"operator", TEXT | OPTIONAL, "", "operator"},
    {"bow_mm", NUMBER | OPTIONAL, "mm", "natural offset of the tip"},
    {"corrections", OBJECT | LIST | OPTIONAL, "", "as in dataset.json", &wb_schema_correction},
    {"checks", OBJECT | OPTIONAL, "", "as in dataset.json", &wb_schema_checks},
    {"warnings", TEXT | LIST | OPTIONAL, "", "as in dataset.json"},
};
static WB_KEYS(recording, "report_recording",
               "A recording; the keys from `sample` on are of a used one.");

static const struct wb_key published_rows[] = {
    {.of = &wb_keys_ludwik},
    {"source", TEXT, "", "source of the values"},
};
static WB_KEYS(published, "published", "Published properties of a wire.");

static const struct wb_key measured_rows[] = {
    {"deflection_mm", NUMBER | LIST, "mm", "deflections of the curves"},
    {"force_mN", NUMBER | LIST | UNKNOWN, "mN", "mean force of the samples"},
    {"lowest_mN", NUMBER | LIST | UNKNOWN, "mN", "lowest force of the samples"},
    {"highest_mN", NUMBER | LIST | UNKNOWN, "mN", "highest force of the samples"},
    {"standard_deviation_mN", NUMBER | LIST | UNKNOWN, "mN",
     "standard deviation of the force between samples"},
};
static WB_KEYS(measured, "measured_curve", "The mean curve of the samples.");

static const struct wb_key computed_rows[] = {
    {"rms_over_F_max", NUMBER | UNKNOWN, "", "RMS error over F_max"},
    {"rms_from_5mm_over_F_max", NUMBER | UNKNOWN, "", "the same of deflections from 5 mm on"},
    {"largest_error_over_F_max", NUMBER | UNKNOWN, "", "largest error over F_max"},
    {"points_reached", INTEGER, "", "deflections that the computation reached"},
    {"force_mN", NUMBER | LIST | UNKNOWN, "mN", "computed force"},
    {"error_over_F_max", NUMBER | LIST | UNKNOWN, "", "error of the force over F_max"},
};
static WB_KEYS(computed, "computed_curve", "A computed curve.");

static const struct wb_key comparison_rows[] = {
    {"samples", INTEGER | OPTIONAL, "", "number of samples"},
    {"length_mm", NUMBER | OPTIONAL, "mm", "free length"},
    {"F_max_mN", NUMBER | OPTIONAL, "mN", "F_max, the largest force of the mean curve"},
    {"max_deflection_mm", NUMBER | OPTIONAL, "mm", "largest deflection of the mean curve"},
    {"scatter_rms_over_F_max", NUMBER | UNKNOWN | OPTIONAL, "",
     "scatter between samples over F_max; null with one sample"},
    {"residual_scatter_rms_over_F_max", NUMBER | UNKNOWN | OPTIONAL, "",
     "part of the scatter that remains with the natural shape of each sample"},
    {"shape_rms_mm", NUMBER | UNKNOWN | OPTIONAL, "mm",
     "RMS distance of the markers from the computed wire"},
    {"shape_largest_mm", NUMBER | UNKNOWN | OPTIONAL, "mm", "largest such distance"},
    {"shape_points", INTEGER | OPTIONAL, "", "number of markers' places compared"},
    {"mean_bow_mm", NUMBER | OPTIONAL, "mm", "mean natural offset of the tip"},
    {"measured", OBJECT | OPTIONAL, "", "mean curve of the samples", &measured},
    {"elastoplastic", OBJECT | OPTIONAL, "", "curve of the elastoplastic wire", &computed},
    {"linear_elastic", OBJECT | OPTIONAL, "", "curve of the linear elastic wire", &computed},
    {"rms_uncertainty_95_over_F_max", NUMBER | UNKNOWN | OPTIONAL, "",
     "in reports of a laboratory: expanded uncertainty (95 %) of the RMS"},
    {"limit_kept", FLAG | OPTIONAL, "", "in reports of a laboratory: the limit is kept"},
};
static WB_KEYS(comparison, "comparison_keys", "");

static const struct wb_key state_rows[] = {
    {"state", TEXT, "", "whether there is a result", .choices = "not wanted|missing|failed|done"},
    {"problem", TEXT | OPTIONAL, "", "why it is missing or failed"},
};
static WB_KEYS(state, "state_keys", "");

static const struct wb_key uncertainties_rows[] = {
    {"youngs_modulus_MPa", NUMBER | UNKNOWN, "MPa", "of E"},
    {"yield_stress_MPa", NUMBER | UNKNOWN, "MPa", "of sigma_Y"},
    {"strength_coefficient_factor", NUMBER | UNKNOWN, "",
     "K lies between K divided by this factor and K times this factor"},
    {"hardening_exponent", NUMBER | UNKNOWN, "", "of n"},
};
static WB_KEYS(uncertainties, "standard_uncertainties",
               "Standard uncertainties from the scatter between samples.");

static const struct wb_key search_rows[] = {
    {"first_strength_coefficient_MPa", NUMBER, "MPa", "initial guess of K"},
    {"first_hardening_exponent", NUMBER, "", "initial guess of n"},
    {"stopped_because", TEXT, "", "why the search ended"},
    {"restarted", FLAG, "", "the search was started again from the optimum"},
    {"restart_moved", NUMBER | UNKNOWN, "", "largest relative change of K or n by the restart"},
    {"beam_runs", INTEGER, "", "computations of the beam"},
    {"beam_runs_not_converged", INTEGER, "", "computations that did not converge"},
    {"strength_coefficient_MPa", NUMBER | LIST, "MPa", "K of each iteration"},
    {"hardening_exponent", NUMBER | LIST, "", "n of each iteration"},
    {"error_over_F_max", NUMBER | LIST | UNKNOWN, "", "error of each iteration"},
    {"simplex_size", NUMBER | LIST | UNKNOWN, "", "size of the simplex in each iteration"},
};
static WB_KEYS(search, "search", "The search for K and n.");

static const struct wb_key calibration_rows[] = {
    {.of = &state},
    {"properties", OBJECT | OPTIONAL, "", "E, sigma_Y, K and n", &wb_keys_ludwik},
    {"standard_uncertainties", OBJECT | OPTIONAL, "", "their standard uncertainties",
     &uncertainties},
    {"bow_corrected", FLAG | OPTIONAL, "", "E and sigma_Y were corrected for the samples' bows"},
    {"remarks", TEXT | LIST | OPTIONAL, "", "remarks on the properties"},
    {"rms_over_F_max", NUMBER | OPTIONAL, "", "RMS error of the fit over F_max"},
    {"largest_error_over_F_max", NUMBER | OPTIONAL, "", "largest error of the fit over F_max"},
    {.of = &comparison},
    {"search", OBJECT | OPTIONAL, "", "search for K and n", &search},
};
static WB_KEYS(calibration, "report_calibration",
               "The calibration of a wire; all keys are present where it is done.");

static const struct wb_key bound_rows[] = {
    {"found", NUMBER | UNKNOWN, "", "value, in the unit of the key above"},
    {"bound", NUMBER | UNKNOWN, "", "bound of the value; null: not known"},
    {"exceeded", FLAG, "", "the value exceeds its bound"},
};
static WB_KEYS(bound, "bound", "A value of a validation and its bound.");

static const struct wb_key bounds_rows[] = {
    {"loading", OBJECT, "", "RMS error on loading over F_max", &bound},
    {"unloading", OBJECT, "", "RMS error on unloading over F_max", &bound},
    {"residual_deflection_mm", OBJECT, "mm", "error of the residual deflection", &bound},
    {"shapes_mm", OBJECT, "mm", "RMS distance of the markers", &bound},
};
static WB_KEYS(bounds, "bounds", "Bounds of a validation.");

static const struct wb_key unloading_rows[] = {
    {"samples", INTEGER, "", "number of samples with unloading"},
    {"rms", NUMBER | UNKNOWN, "", "RMS error of the mean over F_max"},
    {"max_error", NUMBER | UNKNOWN, "", "largest error of the mean over F_max"},
    {"rms_of_samples", NUMBER | UNKNOWN, "", "RMS error of the single samples over F_max"},
    {"rule_untested", FLAG, "", "the calibration had no unloading to test the hardening rule"},
};
static WB_KEYS(unloading, "unloading", "The prediction of the unloading.");

static const struct wb_key residual_rows[] = {
    {"measured", NUMBER | UNKNOWN, "mm", "measured residual deflection"},
    {"predicted", NUMBER | UNKNOWN, "mm", "predicted residual deflection"},
};
static WB_KEYS(residual, "residual_deflection",
               "Deflection where the force has returned to that at zero deflection.");

static const struct wb_key loop_rows[] = {
    {"cycle", INTEGER, "", "cycle, from 1"},
    {"samples", INTEGER, "", "number of samples"},
    {"measured", NUMBER | UNKNOWN, "mJ", "measured energy loss of the cycle"},
    {"predicted", NUMBER | UNKNOWN, "mJ", "predicted energy loss of the cycle"},
};
static WB_KEYS(loop, "loop_energy", "The energy loss of a later cycle.");

static const struct wb_key validation_rows[] = {
    {.of = &state},
    {.of = &comparison},
    {"rms_of_perfect_model_over_F_max", NUMBER | UNKNOWN | OPTIONAL, "",
     "RMS error expected from specimen scatter alone"},
    {"rms_of_perfect_model_95_over_F_max", NUMBER | UNKNOWN | OPTIONAL, "",
     "RMS error that specimen scatter alone exceeds in one of twenty validations"},
    {"share_explained_by_scatter", NUMBER | UNKNOWN | OPTIONAL, "",
     "square of the expected RMS over that of the RMS found, at most 1"},
    {"clamp_curvature_1_m", NUMBER | UNKNOWN | OPTIONAL, "1/m", "computed curvature at the clamp"},
    {"beyond_known_curvature", FLAG | OPTIONAL, "",
     "that curvature exceeds the one up to which the law was measured"},
    {"bounds", OBJECT | OPTIONAL, "", "errors and their bounds", &bounds},
    {"unloading", OBJECT | UNKNOWN | OPTIONAL, "",
     "prediction of the unloading; null: no unloading was measured", &unloading},
    {"residual_deflection_mm", OBJECT | OPTIONAL, "mm", "residual deflection", &residual},
    {"loop_energy_mJ", OBJECT | LIST | OPTIONAL, "mJ", "energy loss of the later cycles", &loop},
};
static WB_KEYS(validation, "report_validation",
               "The validation of a wire; keys from `samples` on are present if done.");

static const struct wb_key point_rows[] = {
    {"curvature_1_m", NUMBER, "1/m", "curvature by the markers"},
    {"curvature_deviation_1_m", NUMBER, "1/m", "standard uncertainty of the curvature"},
    {"moment_N_mm", NUMBER, "N mm", "moment by the strand's tension"},
    {"branch", TEXT, "", "branch of the cycle", .choices = "loading|unloading"},
    {"s_mm", NUMBER, "mm", "arc length of the place"},
    {"band", FLAG, "", "the wire is bent too little there: the point shows scatter only"},
};
static WB_KEYS(point, "moment_point", "A point of M over curvature, without a law.");

static const struct wb_key cloud_rows[] = {
    {"sample", INTEGER, "", "number of the piece"},
    {"points", OBJECT | LIST, "", "points", &point},
};
static WB_KEYS(cloud, "moment_points", "The points of a sample.");

static const struct wb_key later_rows[] = {
    {"sample", INTEGER, "", "number of the piece"},
    {"cycles", INTEGER, "", "number of cycles"},
    {"rms_over_F_max", NUMBER | UNKNOWN, "", "RMS error of the later cycles over F_max"},
    {"measured_energy_mJ", NUMBER | UNKNOWN, "mJ", "measured energy loss of the last cycle"},
    {"computed_energy_mJ", NUMBER | UNKNOWN, "mJ", "computed energy loss of the last cycle"},
};
static WB_KEYS(later, "later_cycles", "Later cycles, which the law was not fitted to.");

static const struct wb_key valley_rows[] = {
    {"strength_coefficient_MPa", NUMBER | UNKNOWN, "MPa", "K of the best fit"},
    {"hardening_exponent", NUMBER | UNKNOWN, "", "n of the best fit"},
    {"misfit", NUMBER | UNKNOWN, "", "misfit of the best fit"},
    {"limit", NUMBER | UNKNOWN, "", "misfit up to which an F-test (95 %) sees no difference"},
    {"strength_coefficient_low_MPa", NUMBER | UNKNOWN, "MPa", "least K within that limit"},
    {"strength_coefficient_high_MPa", NUMBER | UNKNOWN, "MPa", "largest K within that limit"},
    {"hardening_exponent_low", NUMBER | UNKNOWN, "", "least n within that limit"},
    {"hardening_exponent_high", NUMBER | UNKNOWN, "", "largest n within that limit"},
};
static WB_KEYS(valley, "ludwik_on_loading", "K and n of the first loading of the first sample.");

static const struct wb_key pooled_rows[] = {
    {"low", NUMBER | UNKNOWN, "N mm2", "lower end of the 95 % confidence interval"},
    {"high", NUMBER | UNKNOWN, "N mm2", "upper end of that interval"},
    {"deviation_of_logarithm", NUMBER | UNKNOWN, "", "pooled standard deviation of ln EI"},
    {"degrees_of_freedom", INTEGER, "", "its degrees of freedom"},
};
static WB_KEYS(pooled, "pooled_interval",
               "The interval of EI with the scatter of all wires' samples.");

static const struct wb_key remark_rows[] = {
    {"severity", TEXT, "", "severity", .choices = "note|doubt"},
    {"sample", NUMBER | UNKNOWN, "", "number of the piece; null: all"},
    {"text", TEXT, "", "the remark"},
};
static WB_KEYS(remark, "cycle_remark", "A remark on the calibration.");

/* Of a cycle that is done, or not. */
static const struct wb_key prediction_rows[] = {
    {"prediction", OBJECT | OPTIONAL, "", "validation of this law", &validation},
};
static WB_KEYS(prediction, "prediction_key", "");

static const struct wb_key cycle_done_rows[] = {
    {"state", TEXT, "", "the calibration is done", .choices = "done"},
    {.of = &wb_schema_cycle},
    {"moment_curvature_measured", OBJECT | LIST, "", "M over curvature without a law", &cloud},
    {"later_cycles", OBJECT | OPTIONAL, "", "later cycles", &later},
    {"remarks", OBJECT | LIST, "", "remarks on the calibration", &remark},
    {"ludwik_on_loading_alone", OBJECT | OPTIONAL, "", "K and n of a first loading alone", &valley},
    {"flexural_rigidity_N_mm2_pooled_over_wires", OBJECT | OPTIONAL, "N mm2",
     "EI with the scatter of all wires' samples", &pooled},
    {.of = &prediction},
};
static WB_KEYS(cycle_done, "report_cycle", "The calibration on whole cycles.");

static const struct wb_key cycle_failed_rows[] = {
    {"state", TEXT, "", "why there is no calibration", .choices = "missing|failed"},
    {"problem", TEXT, "", "why it is missing or failed"},
    {.of = &prediction},
};
static WB_KEYS(cycle_failed, "report_cycle_missing",
               "A calibration on whole cycles that is not there.");

static const struct wb_keys *const cycles[] = {&cycle_done, &cycle_failed, NULL};
static const struct wb_keys cycle = {"cycle", "The calibration on whole cycles, or why not.",
                                     .alternatives = cycles};

static const struct wb_key wire_rows[] = {
    {"wire", TEXT, "", "name of the product"},
    {"label", TEXT, "", "name in the report"},
    {"conductor_diameter_mm", NUMBER, "mm", "diameter of the conductor; 0: no single one"},
    {"outer_diameter_mm", NUMBER, "mm", "outer diameter"},
    {"density_g_cm3", NUMBER, "g/cm3", "mean density over the outer diameter"},
    {"published", OBJECT | OPTIONAL, "", "published properties", &published},
    {"calibration", OBJECT, "", "calibration by the paper's route", &calibration},
    {"validation", OBJECT, "", "validation of that calibration", &validation},
    {"cycle", OBJECT | OPTIONAL, "", "calibration on whole cycles", &cycle},
};
static WB_KEYS(wire, "report_wire", "A wire of a campaign of recordings.");

static const struct wb_key recordings_rows[] = {
    {.of = &wb_numbers_head_keys},
    {"virtual_rig", FLAG, "", "a recording that is used comes from a virtual rig"},
    {"settings", OBJECT, "", "settings of the calibration", &settings},
    {"limits", OBJECT, "", "limits of the campaign", &limits},
    {"recordings", OBJECT | LIST, "", "recordings of the campaign", &recording},
    {"wires", OBJECT | LIST, "", "wires of the campaign", &wire},
};
static WB_KEYS(recordings, "report_of_recordings", "The report of a campaign of recordings.");

static const struct wb_keys *const kinds[] = {&recordings,
                                              &wb_schema_report_comparison,
                                              &wb_schema_report_bundles,
                                              &wb_schema_report_prediction,
                                              &wb_schema_report_machine,
                                              NULL};
const struct wb_keys wb_schema_report = {
    "report", "A report; its keys depend on the kind of the campaign.", .alternatives = kinds};

/* --- manifest.json --- */

static const struct wb_key manifest_input_rows[] = {
    {"what", TEXT, "", "kind of input", .choices = "recording|file"},
    {"name", TEXT, "",
     "name: of a recording; of a file relative to the campaign's folder or to the shipped data, "
     "or its folder and name"},
    {"sha256", TEXT, "", "SHA-256; of a recording of the uncompressed one"},
};
static WB_KEYS(manifest_input, "manifest_input", "A recording or a file that was read.");

static const struct wb_key manifest_file_rows[] = {
    {"name", TEXT, "", "name, relative to the report's folder"},
    {"sha256", TEXT, "", "SHA-256"},
};
static WB_KEYS(manifest_file, "manifest_file", "A file of the report.");

static const struct wb_key build_rows[] = {
    {"version", TEXT, "", "version of the program"},
    {"revision", TEXT, "", "revision of the sources"},
    {"compiler", TEXT, "", "compiler"},
    {"options", TEXT, "", "options of the compiler that choose machine code"},
    {"processor", TEXT, "", "vector instructions, and the processor that OpenBLAS assumes"},
    {"libraries", OBJECT | LIST, "", "libraries of the process", &wb_keys_sum},
    {"fonts", OBJECT | LIST, "", "fonts of the report", &wb_keys_sum},
};
static WB_KEYS(build, "build", "The program that made the report.");

static const struct wb_key wb_schema_manifest_rows[] = {
    {"report", TEXT, "", "number of the report; empty without a laboratory"},
    {"title", TEXT, "", "title of the report"},
    {"amends", TEXT | OPTIONAL, "", "number of the report that this one replaces"},
    {"campaign", OBJECT, "", "campaign file", &wb_numbers_campaign_keys},
    {"inputs", OBJECT | LIST, "", "inputs of the report, sorted", &manifest_input},
    {"files", OBJECT | LIST, "", "files of the report", &manifest_file},
    {"build", OBJECT, "", "program that made the report", &build},
};
WB_KEYS(wb_schema_manifest, "manifest", "The inputs and files of a signed report.");
