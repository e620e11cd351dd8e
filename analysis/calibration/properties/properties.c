#include "analysis/calibration/properties/properties_private.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include <gsl/gsl_cdf.h>

#include "analysis/calibration/properties/method.h"
#include "base/version.h"

const struct wb_estimate wb_properties_unknown_estimate = {(double)NAN, (double)NAN, (double)NAN,
                                                           (double)NAN, (double)NAN, (double)NAN};

void wb_properties_make_unknown(struct wb_properties *properties)
{
    *properties = (struct wb_properties){.n_samples = 0};
    for (int k = 0; k < 4; k++)
        properties->deviation[k] = (double)NAN;
    properties->calibration_length = properties->rms = (double)NAN;
    properties->scatter_rms = properties->residual_scatter_rms = (double)NAN;
    properties->ludwik_misfit = properties->largest_curvature = (double)NAN;
    properties->stiffness_deviation = (double)NAN;
    properties->rigidity = properties->residual_curvature_ratio = properties->loop_energy =
        properties->springback = wb_properties_unknown_estimate;
    for (int k = 0; k < WB_PROPERTIES_MOST_MOMENTS; k++)
        properties->moment[k] = wb_properties_unknown_estimate;
}

/* Begins the properties of a wire that was calibrated on such tests. */
static void begin(struct wb_properties *properties, const struct wb_test_info *info,
                  enum wb_method method)
{
    wb_properties_make_unknown(properties);
    snprintf(properties->wire, sizeof properties->wire, "%s", info->wire);
    properties->outer_diameter = info->outer_diameter;
    properties->mass_per_length = info->mass_per_length;
    properties->is_virtual = info->is_virtual;
    properties->is_simulation = info->is_simulation;
    snprintf(properties->method, sizeof properties->method, "%s", wb_method_name(method));
    snprintf(properties->tool, sizeof properties->tool, "wirebench %s (%s)", wb_version(),
             wb_version_revision());
}

void wb_properties_from_result(const struct wb_calibrate_result *result,
                               struct wb_properties *properties)
{
    begin(properties, &result->info, WB_METHOD_PAPER);
    properties->material = result->material;
    memcpy(properties->deviation, result->deviation, sizeof properties->deviation);
    properties->calibration_length = result->info.length;
    properties->rms = result->rms;
    properties->scatter_rms = result->n_samples > 1 ? result->scatter_rms : (double)NAN;
    properties->residual_scatter_rms =
        result->n_samples > 1 ? result->residual_scatter_rms : (double)NAN;
    properties->n_samples = result->n_samples;
    wb_law_init_ludwik(&properties->law, &result->material);
}

void wb_properties_from_wire(const struct wb_wire *wire, struct wb_properties *properties)
{
    wb_properties_make_unknown(properties);
    snprintf(properties->wire, sizeof properties->wire, "%s", wire->name);
    properties->outer_diameter = wire->outer_diameter;
    properties->mass_per_length = wb_wire_mass_per_length(wire);
    properties->material = wire->material;
    properties->law = wire->law;
}

/* If no law fits the wire, only the range over the candidates is known. */
static struct wb_estimate known(const struct wb_cycle_calibration *calibration,
                                const struct wb_estimate *estimate)
{
    struct wb_estimate known = *estimate;
    if (calibration->has_unloading && !calibration->is_followed)
        known.value = known.low = known.high = (double)NAN;
    return known;
}

static struct wb_cycle_stiffness known_stiffness(const struct wb_cycle_calibration *calibration,
                                                 const struct wb_cycle_stiffness *stiffness)
{
    struct wb_cycle_stiffness known_ones = *stiffness;
    for (int k = 0; k < known_ones.n; k++)
        known_ones.estimate[k] = known(calibration, &stiffness->estimate[k]);
    return known_ones;
}

static void keep_specimen(const struct wb_cycle_calibration *calibration,
                          const struct wb_cycle_member *member,
                          struct wb_properties_specimen *specimen)
{
    const struct wb_cycle_fit *const fit = &member->answers[calibration->chosen].fit;
    const double length = member->data.info.length;
    const struct wb_cycle_bow bow = wb_cycle_fit_bow(fit, length);
    *specimen = (struct wb_properties_specimen){
        .sample = member->sample,
        .length = length,
        .bow = bow.tip,
        .bow_deviation = bow.deviation,
        .uneven_bow = bow.uneven,
        .level = fit->level,
        .misfit = fit->misfit,
        .ludwik = member->ludwik,
        .ludwik_misfit = member->ludwik_misfit,
    };
}

static double misfit_of_chosen(const struct wb_cycle_calibration *calibration)
{
    for (int i = 0; i < calibration->n_ranked; i++) {
        if (calibration->ranked[i].candidate == calibration->chosen)
            return calibration->ranked[i].misfit;
    }
    return (double)NAN;
}

int wb_properties_units(const struct wb_properties *properties)
{
    return properties->n_series > 1 ? properties->n_series : properties->n_samples;
}

double wb_properties_scatter(const struct wb_estimate *estimate, int n, int degrees)
{
    if (estimate->deviation > 0.0)
        return estimate->deviation;
    return 0.5 * log(estimate->high / estimate->low) * sqrt(n) / gsl_cdf_tdist_Qinv(0.025, degrees);
}

void wb_properties_find_deviation(struct wb_properties *properties)
{
    const int n = wb_properties_units(properties), at = properties->n_moments / 2;
    if (n < 2 || properties->n_moments < 1)
        return;
    const struct wb_estimate *const moment = &properties->moment[at];
    properties->stiffness_deviation = wb_properties_scatter(moment, n, n - 1);
}

void wb_properties_from_cycle(const struct wb_cycle_calibration *calibration,
                              struct wb_properties *properties)
{
    begin(properties, &calibration->members[0].data.info, WB_METHOD_CYCLE);
    properties->material = calibration->ludwik;
    properties->calibration_length = wb_cycle_calibrate_length(calibration);
    properties->rms = misfit_of_chosen(calibration);
    properties->n_samples = calibration->n_members;
    properties->law = calibration->law;
    properties->ludwik_misfit = calibration->ludwik_misfit;
    properties->largest_curvature = calibration->largest_curvature;
    properties->rigidity = known(calibration, &calibration->rigidity);
    properties->secant = known_stiffness(calibration, &calibration->secant);
    properties->unloading = known_stiffness(calibration, &calibration->unloading);
    if (calibration->has_unloading) {
        properties->residual_curvature_ratio =
            known(calibration, &calibration->residual_curvature_ratio);
        properties->springback = known(calibration, &calibration->springback);
        properties->loop_energy = known(calibration, &calibration->loop_energy);
    }
    properties->is_rule_tested = calibration->has_unloading && !calibration->is_stopped;
    properties->is_rule_supported = calibration->is_followed;
    properties->n_moments = WB_CYCLE_MOMENTS;
    for (int k = 0; k < WB_CYCLE_MOMENTS; k++) {
        properties->curvature[k] = calibration->curvature[k];
        properties->moment[k] = known(calibration, &calibration->moment[k]);
    }
    wb_properties_find_deviation(properties);
    const int n = calibration->n_members;
    properties->n_specimens = n < WB_PROPERTIES_MOST_SPECIMENS ? n : WB_PROPERTIES_MOST_SPECIMENS;
    for (int i = 0; i < properties->n_specimens; i++)
        keep_specimen(calibration, &calibration->members[i], &properties->specimens[i]);
}

void wb_properties_from_three_point(const struct wb_three_point_calibration *c,
                                    struct wb_properties *properties)
{
    begin(properties, &c->members[0].data.info, WB_METHOD_THREE_POINT);
    properties->material = c->ludwik;
    properties->rms = c->misfit;
    properties->n_samples = c->n_fitted;
    properties->n_series = c->n_series;
    properties->law = c->law;
    properties->ludwik_misfit = c->ludwik_misfit;
    properties->largest_curvature = c->largest_curvature;
    if (c->is_rigidity_identifiable)
        properties->rigidity = c->rigidity;
    properties->is_rule_tested = c->is_rigidity_identifiable; /* all tests have an unloading */
    properties->is_rule_supported =
        properties->is_rule_tested && c->misfit <= WB_THREE_POINT_LARGEST_SUPPORTED;
    properties->n_moments = WB_THREE_POINT_MOMENTS;
    for (int k = 0; k < WB_THREE_POINT_MOMENTS; k++) {
        properties->curvature[k] = c->curvature[k];
        properties->moment[k] = c->moment[k];
    }
}
