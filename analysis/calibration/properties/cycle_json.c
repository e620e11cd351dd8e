#include "analysis/calibration/cycle/cycle_json.h"

#include <math.h>

#include "analysis/calibration/cycle/cycle_budget.h"
#include "base/units.h"
#include "fe/material/law_json.h"

/* Where no law follows the wire, only the range over the candidates is given. */
static void put_estimate(struct wb_json *object, const struct wb_cycle_calibration *c,
                         const char *name, const struct wb_estimate *e, double unit)
{
    const bool only_range = c->has_unloading && !c->is_followed;
    const double unknown = (double)NAN;
    wb_json_set_number(object, name, only_range ? unknown : e->value / unit);
    wb_json_set_number(object, "low", only_range ? unknown : e->low / unit);
    wb_json_set_number(object, "high", only_range ? unknown : e->high / unit);
    wb_json_set_number(object, "candidates_low", e->candidates_low / unit);
    wb_json_set_number(object, "candidates_high", e->candidates_high / unit);
}

static void put_ludwik(struct wb_json *object, const struct wb_material *m, double misfit)
{
    wb_json_set_number(object, "youngs_modulus_MPa", m->youngs_modulus / WB_MPA);
    wb_json_set_number(object, "yield_stress_MPa", m->yield_stress / WB_MPA);
    wb_json_set_number(object, "strength_coefficient_MPa", m->strength_coefficient / WB_MPA);
    wb_json_set_number(object, "hardening_exponent", m->hardening_exponent);
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
    wb_json_set_boolean(object, "supported", c->is_followed);
    wb_json_set_number(object, "largest_supported_misfit", WB_CYCLE_LARGEST_FOLLOWED);
    wb_json_set_boolean(object, "unloading_measured", c->has_unloading);
    wb_json_set_boolean(object, "stopped", c->is_stopped);
    wb_json_set_number(object, "repeat_noise", c->repeat_noise);
    wb_json_set_number(object, "independent_residuals", c->n_independent);
    struct wb_json *const ranked = wb_json_set_array(object, "ranked");
    for (int i = 0; i < c->n_ranked; i++) {
        const struct wb_cycle_rank *const rank = &c->ranked[i];
        struct wb_json *const item = wb_json_append_object(ranked);
        wb_json_set_text(item, "law", wb_candidate_name(rank->candidate));
        wb_json_set_integer(item, "numbers", rank->n_free);
        wb_json_set_number(item, "misfit", rank->misfit);
        wb_json_set_number(item, "weight", rank->weight);
        wb_json_set_boolean(item, "counts", rank->counts);
        wb_json_set_number(item, "flexural_rigidity_N_mm2", rank->rigidity.value / WB_NMM2);
        wb_json_set_number(item, "residual_curvature_ratio",
                           c->has_unloading ? rank->residual_curvature_ratio.value : (double)NAN);
        /* Numbers of a law that does not follow hang on where its search ended. */
        if (rank->counts)
            put_law(wb_json_set_object(item, "parameters"), &rank->law);
    }
}

/* The numbers' names, and their correlations row by row. */
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
        wb_json_set_integer(item, "sample", member->sample);
        wb_json_set_number(item, "length_mm", member->data.info.length / WB_MM);
        wb_json_set_number(item, "flexural_rigidity_N_mm2",
                           answer->value[WB_CYCLE_RIGIDITY] / WB_NMM2);
        wb_json_set_number(item, "residual_curvature_ratio",
                           c->has_unloading ? answer->value[WB_CYCLE_RESIDUAL_CURVATURE]
                                            : (double)NAN);
        wb_json_set_number(item, "bow_mm", bow.tip / WB_MM);
        wb_json_set_number(item, "bow_uncertainty_mm", bow.deviation / WB_MM);
        wb_json_set_number(item, "uneven_bow_mm", bow.uneven / WB_MM);
        wb_json_set_number(item, "level_mm", fit->level / WB_MM);
        wb_json_set_number(item, "misfit", fit->misfit);
        wb_json_set_number(item, "loading_misfit", fit->loading_misfit);
        wb_json_set_number(item, "unloading_misfit", fit->unloading_misfit);
        wb_json_set_number(item, "markers_rms_mm", fit->place_rms / WB_MM);
        wb_json_set_number(item, "largest_curvature_1_m", fit->clamp_curvature);
        wb_json_set_number(item, "residual_deflection_mm",
                           member->data.residual_deflection / WB_MM);
        wb_json_set_integer(item, "outliers", fit->n_outliers + member->data.n_outliers);
        put_correlation(item, fit);
        put_ludwik(wb_json_set_object(item, "ludwik_equivalent"), &member->ludwik,
                   member->ludwik_misfit);
    }
}

static void put_stiffness(struct wb_json *object, const struct wb_cycle_calibration *c,
                          const struct wb_cycle_stiffness *stiffness)
{
    wb_json_set_number(object, "resolved_from_1_m",
                       stiffness->n > 0 ? stiffness->resolved : (double)NAN);
    struct wb_json *const array = wb_json_set_array(object, "at");
    for (int k = 0; k < stiffness->n; k++) {
        struct wb_json *const item = wb_json_append_object(array);
        wb_json_set_number(item, "curvature_1_m", stiffness->curvature[k]);
        put_estimate(item, c, "value", &stiffness->estimate[k], WB_NMM2);
    }
}

void wb_cycle_json_put(struct wb_json *object, const struct wb_cycle_calibration *c)
{
    const double unknown = (double)NAN;
    const struct wb_estimate untested = {unknown, unknown, unknown, unknown, unknown, unknown};
    put_stiffness(wb_json_set_object(object, "unloading_stiffness_N_mm2"), c, &c->unloading);
    put_stiffness(wb_json_set_object(object, "secant_stiffness_N_mm2"), c, &c->secant);
    put_estimate(wb_json_set_object(object, "flexural_rigidity_N_mm2"), c, "value", &c->rigidity,
                 WB_NMM2);
    wb_json_set_boolean(object, "flexural_rigidity_resolved", c->is_rigidity_resolved);
    put_estimate(wb_json_set_object(object, "residual_curvature_ratio"), c, "value",
                 c->has_unloading ? &c->residual_curvature_ratio : &untested, 1.0);
    put_estimate(wb_json_set_object(object, "loop_energy_mJ_per_m"), c, "value",
                 c->has_unloading ? &c->loop_energy : &untested, WB_MJ);
    wb_json_set_number(object, "largest_curvature_1_m", c->largest_curvature);
    struct wb_json *const moments = wb_json_set_array(object, "moment_curvature");
    for (int k = 0; k < WB_CYCLE_MOMENTS; k++) {
        struct wb_json *const item = wb_json_append_object(moments);
        wb_json_set_number(item, "curvature_1_m", c->curvature[k]);
        put_estimate(item, c, "moment_N_mm", &c->moment[k], WB_NMM);
    }
    put_rule(wb_json_set_object(object, "hardening_rule"), c);
    put_law(wb_json_set_object(object, "law"), &c->law);
    put_ludwik(wb_json_set_object(object, "ludwik_equivalent"), &c->ludwik, c->ludwik_misfit);
    struct wb_json *const identifiable = wb_json_set_object(object, "identifiable");
    wb_json_set_boolean(identifiable, "strength_coefficient", c->is_strength_identifiable);
    wb_json_set_boolean(identifiable, "hardening_exponent", c->is_exponent_identifiable);
    wb_json_set_number(identifiable, "ln_strength_error", c->ln_strength_error);
    wb_json_set_number(identifiable, "exponent_error", c->exponent_error);
    wb_json_set_number(identifiable, "travel_share", c->travel_share);
    wb_json_set_integer(object, "specimens_for_5_percent", c->specimens_for_5_percent);
    put_specimens(wb_json_set_array(object, "specimens"), c);
    wb_cycle_budget_put(wb_json_set_array(object, "budget"), c);
}
