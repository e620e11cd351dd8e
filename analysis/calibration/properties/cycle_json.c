#include "analysis/calibration/properties/cycle_json.h"

#include <math.h>

#include "analysis/calibration/cycle/cycle_budget.h"
#include "analysis/calibration/properties/properties.h"
#include "analysis/calibration/properties/quantity.h"
#include "analysis/keys/common.h"
#include "analysis/keys/row.h"
#include "base/units.h"
#include "fe/material/law_json.h"

#define CYCLE(member) WB_AT(struct wb_cycle_calibration, member)
#define RANK(member) WB_AT(struct wb_cycle_rank, member)
#define MATERIAL(member) WB_AT(struct wb_material, member)
#define MEMBER(member) WB_AT(struct wb_cycle_member, member)
#define BOW(member) WB_AT(struct wb_cycle_bow, member)
#define FIT(member) WB_AT(struct wb_cycle_fit, member)

static const struct wb_key rank_rows[] = {
    {"law", TEXT, "name of the law"},
    {"numbers", RANK(n_free), "number of its free parameters"},
    {"misfit", RANK(misfit) | UNKNOWN, "RMS of the force residuals over F_max"},
    {"weight", RANK(weight) | UNKNOWN, "weight of the law among all laws"},
    {"counts", RANK(counts),
     "the law is in the ranges over laws: chosen, or with at most twice the best misfit"},
    {"flexural_rigidity_N_mm2", RANK(rigidity.value) | UNKNOWN, "EI at zero curvature by this law"},
    {"residual_curvature_ratio", NUMBER | UNKNOWN, "residual curvature ratio by this law"},
    {"parameters", OBJECT | OPTIONAL, "the law's numbers, of a law that counts", &wb_law_json_keys},
};
static WB_KEYS(rank, "ranked_law", "A law that was fitted.");

static const struct wb_key rule_rows[] = {
    {"chosen", TEXT, "name of the chosen law"},
    {"supported", CYCLE(is_followed),
     "the misfit of the chosen law is at most `largest_supported_misfit`"},
    {"largest_supported_misfit", NUMBER, "limit of that misfit, over F_max"},
    {"unloading_measured", CYCLE(has_unloading), "unloading was measured"},
    {"stopped", CYCLE(is_stopped), "interrupted before all laws were fitted"},
    {"repeat_noise", CYCLE(repeat_noise) | UNKNOWN,
     "noise of a point by repeated cycles, over F_max"},
    {"independent_residuals", CYCLE(n_independent) | UNKNOWN,
     "number of independent residuals of a specimen; residuals of neighbours are correlated"},
    {"ranked", OBJECT | LIST, "all laws that were fitted, the best first", &rank_keys},
};
static WB_KEYS(rule, "hardening_rule", "The choice of the law.");

static const struct wb_key equivalent_rows[] = {
    {"youngs_modulus_MPa", MATERIAL(youngs_modulus) | UNKNOWN, "Young's modulus E"},
    {"yield_stress_MPa", MATERIAL(yield_stress) | UNKNOWN, "yield stress sigma_Y"},
    {"strength_coefficient_MPa", MATERIAL(strength_coefficient) | UNKNOWN,
     "strength coefficient K"},
    {"hardening_exponent", MATERIAL(hardening_exponent) | UNKNOWN, "hardening exponent n"},
    {"moment_misfit", NUMBER | UNKNOWN, "RMS of the relative differences of the moment"},
};
static WB_KEYS(
    equivalent, "ludwik_equivalent",
    "Ludwik's law with isotropic hardening that has the same moments on a first loading.");

static const struct wb_key identifiable_rows[] = {
    {"strength_coefficient", CYCLE(is_strength_identifiable),
     "the data determine K of a Ludwik law"},
    {"hardening_exponent", CYCLE(is_exponent_identifiable), "the data determine n of a Ludwik law"},
    {"ln_strength_error", CYCLE(ln_strength_error) | UNKNOWN,
     "standard uncertainty of ln K, the largest of the specimens"},
    {"exponent_error", CYCLE(exponent_error) | UNKNOWN,
     "standard uncertainty of n, the largest of the specimens"},
    {"travel_share", CYCLE(travel_share) | UNKNOWN,
     "travel over free length, the smallest of the specimens"},
};
static WB_KEYS(identifiable, "identifiable", "Which numbers of a Ludwik law the data determine.");

static const struct wb_key correlation_rows[] = {
    {"numbers", TEXT | LIST, "names of the law's free parameters"},
    {"matrix", NUMBER | LIST | UNKNOWN, "their correlations, row by row"},
};
static WB_KEYS(correlation, "law_correlation", "The correlations of a law's parameters.");

static const struct wb_key specimen_rows[] = {
    {"sample", MEMBER(sample), "number of the piece"},
    {"length_mm", MEMBER(data.info.length), "free length"},
    {"flexural_rigidity_N_mm2", NUMBER | UNKNOWN, "EI at zero curvature"},
    {"residual_curvature_ratio", NUMBER | UNKNOWN,
     "residual curvature at zero moment over the largest curvature"},
    {"bow_mm", BOW(tip) | UNKNOWN, "natural offset of the tip"},
    {"bow_uncertainty_mm", BOW(deviation) | UNKNOWN, "standard uncertainty of the bow"},
    {"uneven_bow_mm", BOW(uneven) | UNKNOWN,
     "distance of the middle of the natural shape from that of an even curvature"},
    {"level_mm", FIT(level) | UNKNOWN, "level of zero deflection"},
    {"misfit", FIT(misfit) | UNKNOWN, "RMS of the force residuals over F_max"},
    {"loading_misfit", FIT(loading_misfit) | UNKNOWN, "the same of loading alone"},
    {"unloading_misfit", FIT(unloading_misfit) | UNKNOWN, "the same of unloading alone"},
    {"markers_rms_mm", FIT(place_rms) | UNKNOWN,
     "RMS distance of the markers from the computed wire"},
    {"largest_curvature_1_m", FIT(clamp_curvature) | UNKNOWN, "largest curvature at the clamp"},
    {"residual_deflection_mm", MEMBER(data.residual_deflection) | UNKNOWN,
     "measured residual deflection"},
    {"outliers", INTEGER, "points left out as outliers"},
    {"law_correlation", OBJECT, "correlations of the law's parameters", &correlation_keys},
    {"ludwik_equivalent", OBJECT, "Ludwik equivalent of the specimen", &equivalent_keys},
};
static WB_KEYS(specimen, "cycle_specimen", "A specimen by itself.");

static const struct wb_key wb_cycle_json_rows[] = {
    {.type = ESTIMATES, .quantities = true},
    {"flexural_rigidity_resolved", CYCLE(is_rigidity_resolved),
     "EI at zero curvature is within 2 % of a stiffness that the data resolve"},
    {"largest_curvature_1_m", CYCLE(largest_curvature) | UNKNOWN,
     "curvature at the clamp that all specimens reached"},
    {"hardening_rule", OBJECT, "choice of the law", &rule_keys},
    {"law", OBJECT, "means over the specimens of the law's numbers", &wb_law_json_keys},
    {"ludwik_equivalent", OBJECT, "Ludwik law that bends alike on a first loading",
     &equivalent_keys},
    {"identifiable", WB_HERE(struct wb_cycle_calibration),
     "which numbers of a Ludwik law the data determine", &identifiable_keys},
    {"specimens_for_5_percent", CYCLE(specimens_for_5_percent),
     "number of specimens that EI within 5 % needs; 0: not known", .unit = ""},
    {"specimens", OBJECT | LIST, "each specimen by itself", &specimen_keys},
    {"budget", OBJECT | LIST, "uncertainty budget of each quantity", &wb_cycle_budget_keys},
};
WB_KEYS(wb_cycle_json, "cycle_keys", "");

static void put_ludwik(struct wb_json *object, const struct wb_material *m, double misfit)
{
    WB_PUT(object, &equivalent_keys, struct wb_material, m);
    wb_json_set_number(object, "moment_misfit", misfit);
}

static void put_law(struct wb_json *object, const struct wb_law *law)
{
    wb_json_set_text(object, "form", wb_law_form_name(law->form));
    wb_json_set_text(object, "hardening", wb_law_rule_name(law));
    wb_json_set_number(object, "isotropic_share", law->isotropic_share);
    wb_json_set_number(object, "youngs_modulus_MPa", law->material.youngs_modulus / WB_MPA);
    wb_json_set_number(object, "poissons_ratio", law->material.poissons_ratio);
    wb_law_json_numbers(object, law, "MPa", WB_MPA);
}

static void put_rule(struct wb_json *object, const struct wb_cycle_calibration *c)
{
    wb_json_set_text(object, "chosen", wb_candidate_name(c->chosen));
    WB_PUT(object, &rule_keys, struct wb_cycle_calibration, c);
    wb_json_set_number(object, "largest_supported_misfit", WB_CYCLE_LARGEST_FOLLOWED);
    WB_PUT(object, &rule_keys, struct wb_cycle_calibration, c);
    struct wb_json *const ranked = wb_json_set_array(object, "ranked");
    for (int i = 0; i < c->n_ranked; i++) {
        const struct wb_cycle_rank *const of = &c->ranked[i];
        struct wb_json *const item = wb_json_append_object(ranked);
        wb_json_set_text(item, "law", wb_candidate_name(of->candidate));
        WB_PUT(item, &rank_keys, struct wb_cycle_rank, of);
        wb_json_set_number(item, "residual_curvature_ratio",
                           c->has_unloading ? of->residual_curvature_ratio.value : (double)NAN);
        /* The parameters of a law that does not fit depend on where its search ended. */
        if (of->counts)
            put_law(wb_json_set_object(item, "parameters"), &of->law);
    }
}

/* The names of the parameters, and their correlations row by row. */
static void put_correlation(struct wb_json *item, const struct wb_cycle_fit *fit)
{
    struct wb_json *const object = wb_json_set_object(item, "law_correlation");
    struct wb_json *const names = wb_json_set_array(object, "numbers");
    char text[24];
    for (int i = 0; i < fit->n_numbers; i++)
        wb_json_append_text(names, wb_cycle_fit_number(fit, i, text));
    struct wb_json *const rows = wb_json_set_array(object, "matrix");
    for (int i = 0; i < fit->n_numbers; i++) {
        for (int j = 0; j < fit->n_numbers; j++)
            wb_json_append_number(rows, fit->correlation[i][j]);
    }
}

static void put_specimens(struct wb_json *array, const struct wb_cycle_calibration *c)
{
    for (int i = 0; i < c->n_members; i++) {
        const struct wb_cycle_member *const member = &c->members[i];
        const struct wb_cycle_answer *const answer = &member->answers[c->chosen];
        const struct wb_cycle_fit *const fit = &answer->fit;
        const struct wb_cycle_bow bow = wb_cycle_fit_bow(fit, member->data.info.length);
        struct wb_json *const item = wb_json_append_object(array);
        WB_PUT(item, &specimen_keys, struct wb_cycle_member, member);
        wb_json_set_number(item, "flexural_rigidity_N_mm2",
                           answer->value[WB_CYCLE_RIGIDITY] / WB_NMM2);
        wb_json_set_number(item, "residual_curvature_ratio",
                           c->has_unloading ? answer->value[WB_CYCLE_RESIDUAL_CURVATURE]
                                            : (double)NAN);
        WB_PUT(item, &specimen_keys, struct wb_cycle_bow, &bow);
        WB_PUT(item, &specimen_keys, struct wb_cycle_fit, fit);
        WB_PUT(item, &specimen_keys, struct wb_cycle_member, member);
        wb_json_set_integer(item, "outliers", fit->n_outliers + member->data.n_outliers);
        put_correlation(item, fit);
        put_ludwik(wb_json_set_object(item, "ludwik_equivalent"), &member->ludwik,
                   member->ludwik_misfit);
    }
}

void wb_cycle_json_put(struct wb_json *object, const struct wb_cycle_calibration *c)
{
    struct wb_properties properties;
    wb_properties_from_cycle(c, &properties);
    wb_quantity_put(object, &properties);
    WB_PUT(object, &wb_cycle_json_keys, struct wb_cycle_calibration, c);
    put_rule(wb_json_set_object(object, "hardening_rule"), c);
    put_law(wb_json_set_object(object, "law"), &c->law);
    put_ludwik(wb_json_set_object(object, "ludwik_equivalent"), &c->ludwik, c->ludwik_misfit);
    WB_PUT(object, &wb_cycle_json_keys, struct wb_cycle_calibration, c);
    put_specimens(wb_json_set_array(object, "specimens"), c);
    wb_cycle_budget_put(wb_json_set_array(object, "budget"), c);
}
