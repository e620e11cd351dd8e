#include "analysis/calibration/properties/cycle_json.h"

#include <math.h>

#include "analysis/calibration/cycle/cycle_budget.h"
#include "analysis/calibration/properties/properties.h"
#include "analysis/calibration/properties/quantity.h"
#include "base/units.h"
#include "fe/material/law_json.h"

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
        /* The parameters of a law that does not fit depend on where its search ended. */
        if (rank->counts)
            put_law(wb_json_set_object(item, "parameters"), &rank->law);
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

void wb_cycle_json_put(struct wb_json *object, const struct wb_cycle_calibration *c)
{
    struct wb_properties properties;
    wb_properties_from_cycle(c, &properties);
    wb_quantity_put(object, &properties);
    wb_json_set_boolean(object, "flexural_rigidity_resolved", c->is_rigidity_resolved);
    wb_json_set_number(object, "largest_curvature_1_m", c->largest_curvature);
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
