/* Keys of properties files; the reader is analysis/calibration/properties/properties_read.c. */
#include "analysis/calibration/cycle/cycle_calibrate.h"
#include "analysis/schema/tables.h"

static const struct wb_key deviations_rows[] = {
    {"youngs_modulus_MPa", NUMBER | OPTIONAL, "standard uncertainty of E"},
    {"yield_stress_MPa", NUMBER | OPTIONAL, "standard uncertainty of sigma_Y"},
    {"strength_coefficient_factor", NUMBER | OPTIONAL,
     "K lies between K divided by this factor and K times this factor"},
    {"strength_coefficient_MPa", NUMBER | OPTIONAL,
     "of older files: standard uncertainty of K; not used"},
    {"hardening_exponent", NUMBER | OPTIONAL, "standard uncertainty of n"},
};
static WB_KEYS(deviations, "deviations",
               "Standard uncertainties from the scatter between samples.");

static const struct wb_key dataset_rows[] = {
    {"folder", TEXT | OPTIONAL, "folder of the dataset, as given"},
    {"force_deflection_sha256", TEXT | OPTIONAL, "SHA-256 of its force_deflection.csv"},
    {"recording", TEXT | OPTIONAL, "in the properties of a report: recording or machine file"},
    {"recording_sha256", TEXT | OPTIONAL, "SHA-256 of that file"},
};
static WB_KEYS(dataset, "properties_dataset", "Data that the calibration used.");

static const struct wb_key settings_rows[] = {
    {.type = OPTIONAL, .settings = &wb_cycle_calibrate_tables[0]},
    {.type = OPTIONAL, .settings = &wb_cycle_calibrate_tables[1]},
    {.type = OPTIONAL, .settings = &wb_cycle_calibrate_tables[2]},
};
static WB_KEYS(settings, "cycle_settings",
               "Settings of a calibration on whole cycles, as its options name them.");

static const struct wb_key calibration_rows[] = {
    {"length_mm", NUMBER | OPTIONAL, "free length of the specimens"},
    {"loading", TEXT | OPTIONAL, "tests with a follower force; absent: others",
     .choices = "follower"},
    {"cut_at_mm", NUMBER | OPTIONAL,
     "the loading beyond this deflection was left out; absent: nothing was"},
    {"elastic_zone", NUMBER | OPTIONAL, "deflection over length for E"},
    {"yield_point", NUMBER | OPTIONAL, "deflection over length for sigma_Y"},
    {"natural_shape", TEXT | OPTIONAL, "natural shape of the beam: mean of the samples, or none",
     .choices = "mean|straight"},
    {"bow_corrected", FLAG | OPTIONAL, "E and sigma_Y were corrected for the samples' bows"},
    {"first_strength_coefficient_MPa", NUMBER | OPTIONAL, "initial guess of K"},
    {"first_hardening_exponent", NUMBER | OPTIONAL, "initial guess of n"},
    {"stopped", TEXT | OPTIONAL,
     "why the search ended; of whole cycles only where it was interrupted"},
    {"evaluations", INTEGER | OPTIONAL, "computations of the beam"},
    {"evaluations_not_converged", INTEGER | OPTIONAL, "computations that did not converge"},
    {"restart_moved", NUMBER | OPTIONAL,
     "largest relative change of K or n by the restart; absent: there was none"},
    {"max_force_N", NUMBER | OPTIONAL, "F_max, the largest force of the mean curve"},
    {"max_deflection_mm", NUMBER | OPTIONAL, "largest deflection of the mean curve"},
    {"rms", NUMBER | OPTIONAL,
     "RMS error over F_max; of a follower force over `max_deflection_mm`"},
    {"max_error", NUMBER | OPTIONAL, "largest error over the same"},
    {"samples", INTEGER | OPTIONAL, "number of samples"},
    {"scatter_rms", NUMBER | OPTIONAL, "scatter between samples over the same"},
    {"residual_scatter_rms", NUMBER | OPTIONAL,
     "part of the scatter that remains with the natural shape of each sample"},
    {"virtual_rig", FLAG | OPTIONAL, "the data come from a virtual rig"},
    {"simulation", FLAG | OPTIONAL, "the data come from a simulation"},
    {"tool", TEXT | OPTIONAL, "program, version and revision"},
    {"settings", OBJECT | OPTIONAL, "settings of a calibration on whole cycles", &settings_keys},
    {"datasets", OBJECT | LIST | OPTIONAL, "data that the calibration used", &dataset_keys},
};
static WB_KEYS(calibration, "properties_calibration", "How the properties were found.");

static const struct wb_key rank_rows[] = {
    {"law", TEXT, "name of the law"},
    {"misfit", NUMBER | OPTIONAL, "misfit over F_max"},
    {"weight", NUMBER | OPTIONAL, "weight among all laws"},
};
static WB_KEYS(rank, "properties_ranked_law", "A law that was fitted.");

static const struct wb_key rule_rows[] = {
    {"chosen", TEXT | OPTIONAL, "name of the chosen law"},
    {"tested", FLAG | OPTIONAL, "unloading was measured, which tests the hardening rule"},
    {"supported", FLAG | OPTIONAL,
     "the law fits loading and unloading within 3 % of F_max; of three-point bending 0.5 %"},
    {"ranked", OBJECT | LIST | OPTIONAL, "all laws that were fitted, the best first", &rank_keys},
};
static WB_KEYS(rule, "properties_hardening_rule", "The choice of the law.");

static const struct wb_key specimen_rows[] = {
    {"sample", INTEGER, "number of the piece"},
    {"length_mm", NUMBER, "free length"},
    {"bow_mm", NUMBER | OPTIONAL, "natural offset of the tip"},
    {"bow_deviation_mm", NUMBER | OPTIONAL, "standard uncertainty of the bow"},
    {"uneven_bow_mm", NUMBER | OPTIONAL,
     "distance of the middle of the natural shape from that of an even curvature"},
    {"level_mm", NUMBER | OPTIONAL, "level of zero deflection"},
    {"misfit", NUMBER | OPTIONAL, "RMS of the force residuals over F_max"},
    {.of = &wb_law_ludwik_keys},
    {"ludwik_misfit", NUMBER | OPTIONAL, "RMS of the relative differences of the moment"},
};
static WB_KEYS(specimen, "properties_specimen",
               "A specimen by itself; the four numbers are of its Ludwik equivalent.");

static const struct wb_key band_rows[] = {
    {"of", TEXT, "parameter of the bench that was changed"},
    {"value", NUMBER | OPTIONAL, "its value: a friction coefficient"},
    {"value_mm", NUMBER | OPTIONAL, "its value: a radius of the nose"},
    {"possible", FLAG, "all specimens could be fitted with this value"},
    {"misfit", NUMBER | OPTIONAL, "misfit of that fit over F_max"},
    {"rigidity_ratio", NUMBER | OPTIONAL, "its EI over the EI above"},
};
static WB_KEYS(band, "bench_band", "The fits with an end of what the machine file leaves open.");

static const struct wb_key test_rows[] = {
    {"sample", INTEGER, "number of the piece"},
    {"series", TEXT, "series that the test belongs to"},
    {"fitted", FLAG, "a law was fitted to the test"},
    {"flexural_rigidity_N_mm2", NUMBER | OPTIONAL, "EI at zero curvature"},
    {"rigidity_error", NUMBER | OPTIONAL, "standard uncertainty of ln EI"},
    {"first_contact_mm", NUMBER | OPTIONAL, "travel at the first contact"},
    {"first_contact_error_mm", NUMBER | OPTIONAL, "its standard uncertainty"},
    {"natural_bow_mm", NUMBER | OPTIONAL, "natural bow"},
    {"natural_bow_error_mm", NUMBER | OPTIONAL,
     "its standard uncertainty; where the readings do not determine the bow, that of the file"},
    {"natural_bow_determined", FLAG | OPTIONAL, "the readings determine the natural bow"},
    {"usable_mm", NUMBER | OPTIONAL, "travel up to which the test is used"},
    {"usable_by", TEXT | OPTIONAL, "reason of that limit"},
    {"misfit", NUMBER | OPTIONAL, "RMS of the force residuals over F_max"},
    {"largest_curvature_1_m", NUMBER | OPTIONAL, "largest curvature"},
    {"wrapped_rad", NUMBER | OPTIONAL, "angle over which the wire lies on the nose"},
};
static WB_KEYS(test, "bending_test", "A three-point bending test by itself.");

static const struct wb_key three_point_rows[] = {
    {"span_mm", NUMBER | OPTIONAL, "distance between the rollers"},
    {"roller_radius_mm", NUMBER | OPTIONAL, "radius of the rollers"},
    {"nose_radius_mm", NUMBER | OPTIONAL, "radius of the nose in the fits"},
    {"friction", NUMBER | OPTIONAL, "friction coefficient in the fits"},
    {"compliance_mm_N", NUMBER | OPTIONAL, "compliance of the machine in the fits"},
    {"compliance_known", FLAG | OPTIONAL, "the machine file states the compliance"},
    {"series", INTEGER | OPTIONAL, "number of series"},
    {"series_deviation", NUMBER | OPTIONAL, "standard deviation of ln EI between series"},
    {"bands", OBJECT | LIST | OPTIONAL, "fits with the ends of what is not known", &band_keys},
    {"tests", OBJECT | LIST | OPTIONAL, "each test by itself", &test_keys},
};
static WB_KEYS(three_point, "three_point",
               "The bench and the tests of a calibration on three-point bending.");

static const struct wb_key old_ratio_rows[] = {
    {"value", NUMBER | OPTIONAL, "mean over the specimens"},
    {"low", NUMBER | OPTIONAL, "lower end of the 95 % confidence interval of the mean"},
    {"high", NUMBER | OPTIONAL, "upper end of that interval"},
    {"candidates_low", NUMBER | OPTIONAL, "least value over the laws that are not excluded"},
    {"candidates_high", NUMBER | OPTIONAL, "largest value over these laws"},
    {"scatter", NUMBER | OPTIONAL, "standard deviation of the logarithm between specimens"},
};
static WB_KEYS(old_ratio, "springback_ratio", "The residual curvature ratio of older files.");

static const struct wb_key wb_schema_properties_rows[] = {
    {"schema", INTEGER | OPTIONAL, "layout of the file, 1"},
    {"wire", TEXT, "name of the product"},
    {"outer_diameter_mm", NUMBER, "outer diameter"},
    {"mass_per_length_kg_m", NUMBER, "mass per length"},
    {.of = &wb_law_ludwik_keys},
    {"poissons_ratio", NUMBER, "Poisson's ratio"},
    {"deviations", OBJECT | OPTIONAL, "standard uncertainties; absent with one sample",
     &deviations_keys},
    {"method", TEXT | OPTIONAL,
     "route of the calibration; absent: `paper` where there is `calibration`",
     .choices = "cycle|paper|three-point"},
    {"law", OBJECT | OPTIONAL,
     "law of the wire; the four numbers are then its Ludwik equivalent. Absent: Ludwik's law with "
     "isotropic hardening",
     &wb_law_file_keys},
    {"ludwik_misfit", NUMBER | OPTIONAL,
     "of the equivalent: RMS of the relative differences of the moment"},
    {.type = OPTIONAL, .quantities = true},
    {"springback_ratio", OBJECT | OPTIONAL,
     "name of `residual_curvature_ratio` before version 0.1.0", &old_ratio_keys},
    {"largest_curvature_1_m", NUMBER | OPTIONAL, "curvature up to which the law was measured"},
    {"hardening_rule", OBJECT | OPTIONAL, "choice of the law", &rule_keys},
    {"specimens", OBJECT | LIST | OPTIONAL, "each specimen by itself", &specimen_keys},
    {"three_point", OBJECT | OPTIONAL, "of three-point bending: the bench and the tests",
     &three_point_keys},
    {"calibration", OBJECT | OPTIONAL, "how the properties were found", &calibration_keys},
};
WB_KEYS(wb_schema_properties, "properties",
        "The properties of a wire, from a calibration or by hand.");
