/* Keys of a calibration on whole cycles, in report.json and in `calibrate --json`. */
#include "analysis/schema/tables.h"

static const struct wb_key rank_rows[] = {
    {"law", TEXT, "", "name of the law"},
    {"numbers", INTEGER, "", "number of its free parameters"},
    {"misfit", NUMBER | UNKNOWN, "", "RMS of the force residuals over F_max"},
    {"weight", NUMBER | UNKNOWN, "", "weight of the law among all laws"},
    {"counts", FLAG, "",
     "the law is in the ranges over laws: chosen, or with at most twice the best misfit"},
    {"flexural_rigidity_N_mm2", NUMBER | UNKNOWN, "N mm2", "EI at zero curvature by this law"},
    {"residual_curvature_ratio", NUMBER | UNKNOWN, "", "residual curvature ratio by this law"},
    {"parameters", OBJECT | OPTIONAL, "", "the law's numbers, of a law that counts",
     &wb_keys_law_of_json},
};
static WB_KEYS(rank, "ranked_law", "A law that was fitted.");

static const struct wb_key rule_rows[] = {
    {"chosen", TEXT, "", "name of the chosen law"},
    {"supported", FLAG, "", "the misfit of the chosen law is at most `largest_supported_misfit`"},
    {"largest_supported_misfit", NUMBER, "", "limit of that misfit, over F_max"},
    {"unloading_measured", FLAG, "", "unloading was measured"},
    {"stopped", FLAG, "", "interrupted before all laws were fitted"},
    {"repeat_noise", NUMBER | UNKNOWN, "", "noise of a point by repeated cycles, over F_max"},
    {"independent_residuals", NUMBER | UNKNOWN, "",
     "number of independent residuals of a specimen; residuals of neighbours are correlated"},
    {"ranked", OBJECT | LIST, "", "all laws that were fitted, the best first", &rank},
};
static WB_KEYS(rule, "hardening_rule", "The choice of the law.");

static const struct wb_key equivalent_rows[] = {
    {"youngs_modulus_MPa", NUMBER | UNKNOWN, "MPa", "Young's modulus E"},
    {"yield_stress_MPa", NUMBER | UNKNOWN, "MPa", "yield stress sigma_Y"},
    {"strength_coefficient_MPa", NUMBER | UNKNOWN, "MPa", "strength coefficient K"},
    {"hardening_exponent", NUMBER | UNKNOWN, "", "hardening exponent n"},
    {"moment_misfit", NUMBER | UNKNOWN, "", "RMS of the relative differences of the moment"},
};
static WB_KEYS(
    equivalent, "ludwik_equivalent",
    "Ludwik's law with isotropic hardening that has the same moments on a first loading.");

static const struct wb_key identifiable_rows[] = {
    {"strength_coefficient", FLAG, "", "the data determine K of a Ludwik law"},
    {"hardening_exponent", FLAG, "", "the data determine n of a Ludwik law"},
    {"ln_strength_error", NUMBER | UNKNOWN, "",
     "standard uncertainty of ln K, the largest of the specimens"},
    {"exponent_error", NUMBER | UNKNOWN, "",
     "standard uncertainty of n, the largest of the specimens"},
    {"travel_share", NUMBER | UNKNOWN, "",
     "travel over free length, the smallest of the specimens"},
};
static WB_KEYS(identifiable, "identifiable", "Which numbers of a Ludwik law the data determine.");

static const struct wb_key correlation_rows[] = {
    {"numbers", TEXT | LIST, "", "names of the law's free parameters"},
    {"matrix", NUMBER | LIST | UNKNOWN, "", "their correlations, row by row"},
};
static WB_KEYS(correlation, "law_correlation", "The correlations of a law's parameters.");

static const struct wb_key specimen_rows[] = {
    {"sample", INTEGER, "", "number of the piece"},
    {"length_mm", NUMBER, "mm", "free length"},
    {"flexural_rigidity_N_mm2", NUMBER | UNKNOWN, "N mm2", "EI at zero curvature"},
    {"residual_curvature_ratio", NUMBER | UNKNOWN, "",
     "residual curvature at zero moment over the largest curvature"},
    {"bow_mm", NUMBER | UNKNOWN, "mm", "natural offset of the tip"},
    {"bow_uncertainty_mm", NUMBER | UNKNOWN, "mm", "standard uncertainty of the bow"},
    {"uneven_bow_mm", NUMBER | UNKNOWN, "mm",
     "distance of the middle of the natural shape from that of an even curvature"},
    {"level_mm", NUMBER | UNKNOWN, "mm", "level of zero deflection"},
    {"misfit", NUMBER | UNKNOWN, "", "RMS of the force residuals over F_max"},
    {"loading_misfit", NUMBER | UNKNOWN, "", "the same of loading alone"},
    {"unloading_misfit", NUMBER | UNKNOWN, "", "the same of unloading alone"},
    {"markers_rms_mm", NUMBER | UNKNOWN, "mm",
     "RMS distance of the markers from the computed wire"},
    {"largest_curvature_1_m", NUMBER | UNKNOWN, "1/m", "largest curvature at the clamp"},
    {"residual_deflection_mm", NUMBER | UNKNOWN, "mm", "measured residual deflection"},
    {"outliers", INTEGER, "", "points left out as outliers"},
    {"law_correlation", OBJECT, "", "correlations of the law's parameters", &correlation},
    {"ludwik_equivalent", OBJECT, "", "Ludwik equivalent of the specimen", &equivalent},
};
static WB_KEYS(specimen, "cycle_specimen", "A specimen by itself.");

static const struct wb_key contribution_rows[] = {
    {"of", TEXT, "",
     "source of the uncertainty: `specimens`, `fits`, `law`, or what all specimens share"},
    {"standard_uncertainty", NUMBER | UNKNOWN, "", "of the logarithm of the quantity"},
    {"degrees_of_freedom", NUMBER | UNKNOWN, "", "degrees of freedom; null: infinite"},
    {"sensitivity", NUMBER | UNKNOWN | OPTIONAL, "",
     "change of the logarithm by a relative change of what all specimens share"},
    {"sensitivity_1_mm", NUMBER | UNKNOWN | OPTIONAL, "1/mm",
     "change of the logarithm by a change of the marker offset"},
};
static WB_KEYS(contribution, "contribution", "A contribution to the uncertainty of a quantity.");

static const struct wb_key budget_rows[] = {
    {"quantity", TEXT, "", "the quantity",
     .choices = "flexural_rigidity|residual_curvature_ratio|loop_energy|"
                "deflection_springback|moment|secant_stiffness|"
                "unloading_stiffness"},
    {"curvature_1_m", NUMBER | UNKNOWN, "1/m", "curvature; null: the quantity has none"},
    {"standard_uncertainty", NUMBER | UNKNOWN, "",
     "combined standard uncertainty of the logarithm of the quantity"},
    {"degrees_of_freedom", NUMBER | UNKNOWN, "", "effective degrees of freedom; null: infinite"},
    {"coverage_factor", NUMBER | UNKNOWN, "", "coverage factor for 95 %"},
    {"contributions", OBJECT | LIST, "", "contributions", &contribution},
};
static WB_KEYS(budget, "budget", "The uncertainty budget of a quantity.");

static const struct wb_key wb_schema_cycle_rows[] = {
    {.type = ESTIMATES, .quantities = true},
    {"flexural_rigidity_resolved", FLAG, "",
     "EI at zero curvature is within 2 % of a stiffness that the data resolve"},
    {"largest_curvature_1_m", NUMBER | UNKNOWN, "1/m",
     "curvature at the clamp that all specimens reached"},
    {"hardening_rule", OBJECT, "", "choice of the law", &rule},
    {"law", OBJECT, "", "means over the specimens of the law's numbers", &wb_keys_law_of_json},
    {"ludwik_equivalent", OBJECT, "", "Ludwik law that bends alike on a first loading",
     &equivalent},
    {"identifiable", OBJECT, "", "which numbers of a Ludwik law the data determine", &identifiable},
    {"specimens_for_5_percent", INTEGER, "",
     "number of specimens that EI within 5 % needs; 0: not known"},
    {"specimens", OBJECT | LIST, "", "each specimen by itself", &specimen},
    {"budget", OBJECT | LIST, "", "uncertainty budget of each quantity", &budget},
};
WB_KEYS(wb_schema_cycle, "cycle_keys", "");
