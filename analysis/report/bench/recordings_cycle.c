#include "analysis/report/bench/recordings_cycle.h"

#include <math.h>
#include <stdlib.h>

#include <gsl/gsl_cdf.h>

#include "analysis/calibration/law/bending.h"
#include "analysis/calibration/properties/cycle_json.h"
#include "analysis/keys/row.h"
#include "base/interrupt.h"
#include "base/memory.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "report"

static const double coverage = 0.95;

/* What the interval of a mean of n logarithms is to both sides. */
static double half_width(double deviation, int degrees, int n)
{
    return gsl_cdf_tdist_Qinv(0.5 * (1.0 - coverage), degrees) * deviation / sqrt(n);
}

/* --- the law's line --- */

static enum wb_status draw_curve(struct wb_recordings_cycle *cycle)
{
    const struct wb_cycle_calibration *const c = &cycle->calibration;
    struct wb_recordings_cycle_curve *const curve = &cycle->curve;
    double sum[WB_RECORDINGS_CYCLE_CURVE] = {0.0}, squares[WB_RECORDINGS_CYCLE_CURVE] = {0.0};
    double moment[WB_RECORDINGS_CYCLE_CURVE];
    const int n = c->n_members, points = WB_RECORDINGS_CYCLE_CURVE;

    /* Close together where the line bends most. */
    for (int k = 0; k < points; k++)
        curve->curvature[k] = c->largest_curvature * pow((double)k / (points - 1), 2.0);
    for (int i = 0; i < n; i++) {
        const struct wb_cycle_member *const member = &c->members[i];
        WB_TRY(wb_bending_moments(&member->answers[c->chosen].fit.law,
                                  member->data.info.outer_diameter, points, curve->curvature,
                                  moment));
        for (int k = 1; k < points; k++) {
            sum[k] += log(moment[k]);
            squares[k] += log(moment[k]) * log(moment[k]);
        }
    }
    curve->moment[0] = curve->low[0] = curve->high[0] = 0.0;
    for (int k = 1; k < points; k++) {
        const double mean = sum[k] / n;
        curve->moment[k] = exp(mean);
        curve->low[k] = curve->high[k] = (double)NAN;
        if (n < 2)
            continue;
        const double s = sqrt(fmax(0.0, squares[k] - n * mean * mean) / (n - 1));
        curve->low[k] = exp(mean - half_width(s, n - 1, n));
        curve->high[k] = exp(mean + half_width(s, n - 1, n));
    }
    return WB_OK;
}

/* --- what figures need --- */

/* The first specimen with the most cycles: later ones are predicted. */
static enum wb_status predict_later(struct wb_recordings_cycle *cycle,
                                    const struct wb_dataset *const *datasets)
{
    const struct wb_cycle_calibration *const c = &cycle->calibration;
    int best = 0;
    for (int i = 1; i < c->n_members; i++) {
        if (wb_cycle_later_count(datasets[i]) > wb_cycle_later_count(datasets[best]))
            best = i;
    }
    const struct wb_cycle_member *const member = &c->members[best];
    return wb_cycle_later_predict(&cycle->later, datasets[best], &member->data,
                                  &member->answers[c->chosen].fit);
}

/* The valley is looked at from Ludwik's best law; a specimen without one has none. */
static bool find_valley(struct wb_recordings_cycle *cycle)
{
    const struct wb_cycle_calibration *const c = &cycle->calibration;
    struct wb_reason why = {.text = ""};
    for (int i = 0; i < c->n_ranked; i++) {
        const struct wb_cycle_fit *const fit = &c->members[0].answers[c->ranked[i].candidate].fit;
        if (fit->law.form == WB_LAW_LUDWIK)
            return wb_cycle_valley_find(&cycle->valley, &c->members[0].data, &fit->law, &why) ==
                   WB_OK;
    }
    return false;
}

/* A test without shapes has an empty cloud. */
static enum wb_status take_clouds(struct wb_recordings_cycle *cycle,
                                  const struct wb_dataset *const *datasets)
{
    const struct wb_cycle_calibration *const c = &cycle->calibration;
    const size_t n = (size_t)c->n_members;
    cycle->clouds = wb_memory_new(n, sizeof *cycle->clouds);
    const struct wb_moment_cloud **const taken = wb_memory_new(n, sizeof *taken);
    int n_taken = 0;
    enum wb_status status = WB_OK;
    for (int i = 0; i < c->n_members; i++) {
        const struct wb_cycle_fit *const fit = &c->members[i].answers[c->chosen].fit;
        const struct wb_cycle_specimen specimen = {fit->bow_angle, fit->level, fit->uneven_angle};
        struct wb_reason why = {.text = ""};
        const enum wb_status one =
            wb_moment_curvature_take(&cycle->clouds[i], datasets[i], &specimen, &why);
        if (one == WB_OK)
            taken[n_taken++] = &cycle->clouds[i];
        else
            cycle->clouds[i] = (struct wb_moment_cloud){.n = 0};
    }
    if (n_taken > 0) {
        status = wb_moment_curvature_compare(
            taken, n_taken, &c->law, c->members[0].data.info.outer_diameter, &cycle->comparison);
        cycle->has_comparison = status == WB_OK;
    }
    free(taken);
    return status;
}

/* --- all of it --- */

static bool go_on(void *context, int done, int all)
{
    (void)context, (void)done, (void)all;
    return !wb_interrupted();
}

enum wb_status wb_recordings_cycle_run(struct wb_recordings_cycle *cycle,
                                       const struct wb_dataset *const *datasets, int n,
                                       struct wb_reason *why)
{
    struct wb_cycle_calibrate_settings settings;
    wb_cycle_calibrate_default_settings(&settings);
    /* Wires are computed side by side already. */
    settings.threads = 1;
    settings.progress = go_on;
    WB_TRY(wb_cycle_check_calibrate(&cycle->calibration, &cycle->remarks, datasets, n, &settings,
                                    why));
    enum wb_status status =
        cycle->calibration.is_stopped ? wb_fail_to(why, WB_ERR_DATA, "stopped") : draw_curve(cycle);
    if (status == WB_OK)
        status = predict_later(cycle, datasets);
    if (status == WB_OK)
        status = take_clouds(cycle, datasets);
    if (status != WB_OK) {
        wb_recordings_cycle_release(cycle);
        return status;
    }
    cycle->has_valley = find_valley(cycle);
    return WB_OK;
}

void wb_recordings_cycle_release(struct wb_recordings_cycle *cycle)
{
    const int n = cycle->calibration.n_members;
    wb_cycle_calibrate_release(&cycle->calibration);
    wb_cycle_later_release(&cycle->later);
    for (int i = 0; cycle->clouds && i < n; i++)
        wb_moment_curvature_release(&cycle->clouds[i]);
    free(cycle->clouds);
    cycle->clouds = NULL;
}

bool wb_recordings_cycle_is_refuted(const struct wb_recordings_cycle *cycle)
{
    return cycle->calibration.has_unloading && !cycle->calibration.is_followed;
}

#define LATER(member) WB_AT(struct wb_cycle_later, member)
#define VALLEY(member) WB_AT(struct wb_cycle_valley, member)

static const struct wb_key cloud_rows[] = {
    {"sample", INTEGER, "number of the piece"},
    {"points", OBJECT | LIST, "points", &wb_moment_curvature_keys},
};
static WB_KEYS(cloud, "moment_points", "The points of a specimen.");

static const struct wb_key later_rows[] = {
    {"sample", LATER(sample), "number of the piece"},
    {"cycles", LATER(n_cycles), "number of cycles"},
    {"rms_over_F_max", LATER(rms) | UNKNOWN, "RMS error of the later cycles over F_max"},
    {"measured_energy_mJ", LATER(measured_energy) | UNKNOWN,
     "measured energy loss of the last cycle"},
    {"computed_energy_mJ", LATER(computed_energy) | UNKNOWN,
     "computed energy loss of the last cycle"},
};
static WB_KEYS(later, "later_cycles", "Later cycles, which the law was not fitted to.");

static const struct wb_key remark_rows[] = {
    {"severity", TEXT, "severity", .choices = "note|doubt"},
    {"sample", NUMBER | UNKNOWN, "number of the piece; null: all"},
    {"text", TEXT, "the remark"},
};
static WB_KEYS(remark, "cycle_remark", "A remark on the calibration.");

static const struct wb_key valley_rows[] = {
    {"strength_coefficient_MPa", VALLEY(best.strength_coefficient) | UNKNOWN, "K of the best fit"},
    {"hardening_exponent", VALLEY(best.hardening_exponent) | UNKNOWN, "n of the best fit"},
    {"misfit", VALLEY(best_misfit) | UNKNOWN, "misfit of the best fit"},
    {"limit", VALLEY(limit) | UNKNOWN, "misfit up to which an F-test (95 %) sees no difference"},
    {"strength_coefficient_low_MPa", VALLEY(strength_low) | UNKNOWN, "least K within that limit"},
    {"strength_coefficient_high_MPa", VALLEY(strength_high) | UNKNOWN,
     "largest K within that limit"},
    {"hardening_exponent_low", VALLEY(exponent_low) | UNKNOWN, "least n within that limit"},
    {"hardening_exponent_high", VALLEY(exponent_high) | UNKNOWN, "largest n within that limit"},
};
static WB_KEYS(valley, "ludwik_on_loading", "K and n of the first loading of the first specimen.");

static const struct wb_key wb_recordings_cycle_rows[] = {
    {.of = &wb_cycle_json_keys},
    {"moment_curvature_measured", OBJECT | LIST, "M over curvature without a law", &cloud_keys},
    {"later_cycles", OBJECT | OPTIONAL, "later cycles", &later_keys},
    {"remarks", OBJECT | LIST, "remarks on the calibration", &remark_keys},
    {"ludwik_on_loading_alone", OBJECT | OPTIONAL, "K and n of a first loading alone",
     &valley_keys},
};
WB_KEYS(wb_recordings_cycle, "report_cycle_keys", "");

void wb_recordings_cycle_put(struct wb_json *object, const struct wb_recordings_cycle *cycle)
{
    wb_cycle_json_put(object, &cycle->calibration);
    struct wb_json *const clouds = wb_json_set_array(object, "moment_curvature_measured");
    for (int i = 0; i < cycle->calibration.n_members; i++) {
        struct wb_json *const item = wb_json_append_object(clouds);
        wb_json_set_integer(item, "sample", cycle->calibration.members[i].sample);
        wb_moment_curvature_put(wb_json_set_array(item, "points"), &cycle->clouds[i]);
    }
    if (cycle->later.n > 0)
        WB_PUT(wb_json_set_object(object, "later_cycles"), &later_keys, struct wb_cycle_later,
               &cycle->later);
    wb_cycle_check_put(wb_json_set_array(object, "remarks"), &cycle->remarks);
    if (cycle->has_valley)
        WB_PUT(wb_json_set_object(object, "ludwik_on_loading_alone"), &valley_keys,
               struct wb_cycle_valley, &cycle->valley);
}

/* --- pooled over wires --- */

void wb_recordings_cycle_pool(struct wb_recordings_cycle_pool *pool,
                              const struct wb_recordings_cycle *cycle)
{
    const struct wb_estimate *const rigidity = &cycle->calibration.rigidity;
    const int degrees = cycle->calibration.n_members - 1;
    if (degrees < 1 || !isfinite(rigidity->deviation))
        return;
    pool->deviation += degrees * rigidity->deviation * rigidity->deviation;
    pool->degrees += degrees;
}

void wb_recordings_cycle_close(struct wb_recordings_cycle_pool *pool)
{
    pool->deviation = pool->degrees > 0 ? sqrt(pool->deviation / pool->degrees) : (double)NAN;
}

const struct wb_estimate *
wb_recordings_cycle_stiffness(const struct wb_cycle_calibration *calibration)
{
    const struct wb_cycle_stiffness *const stiffness =
        calibration->unloading.n > 0 ? &calibration->unloading : &calibration->secant;
    return &stiffness->estimate[wb_cycle_stiffness_near_one(stiffness)];
}

void wb_recordings_cycle_interval(const struct wb_recordings_cycle_pool *pool,
                                  const struct wb_recordings_cycle *cycle, double *low,
                                  double *high)
{
    const double value = cycle->calibration.rigidity.value;
    *low = *high = (double)NAN;
    if (pool->degrees < 1)
        return;
    const double half = half_width(pool->deviation, pool->degrees, cycle->calibration.n_members);
    *low = value * exp(-half);
    *high = value * exp(half);
}
