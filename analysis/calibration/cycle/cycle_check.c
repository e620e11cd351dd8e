#include "analysis/calibration/cycle/cycle_check.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "analysis/calibration/cycle/cycle_bow.h"
#include "analysis/calibration/cycle/cycle_check_private.h"
#include "analysis/calibration/cycle/cycle_fit.h"
#include "analysis/calibration/cycle/cycle_model.h"
#include "analysis/dataset/batches.h"
#include "analysis/dataset/fit.h"
#include "analysis/dataset/holds.h"
#include "analysis/dataset/stops.h"
#include "base/circle.h"
#include "base/memory.h"
#include "base/text.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "check"

enum {
    MOST_STOPS = 64
};

/* --- limits of the checks of rows --- */

/* A wire cannot deflect by more than about its length. */
static const double most_deflection = 1.2;
/* Least travel over length of a test; the paper takes E at 0.05. */
static const double least_travel = 0.05;
/* Largest travel over length of deflections in metres that were read as millimetres; that of a test
 * is larger. */
static const double metres_travel = 0.005;
/* The tension at zero deflection is that of the counterweight, the wire's weight and its bow, at
 * most a few times the weights. Readings in millinewtons are 1000 times too large, in grams 102
 * times. */
static const double most_weights = 50.0, millinewtons = 400.0;
/* The largest tension is at least the weights; readings in kilonewtons stay below this part of
 * them. */
static const double least_weights = 0.05;
/* Limits without weights to compare with: metals have at most the modulus of steel, 210 GPa; a
 * conductor with its jacket has more than the lower limit. */
static const double most_modulus = 300e9, least_modulus = 5e6;
/* At zero deflection, the distance of a marker from the clamp equals its arc length within half a
 * per cent, the effect of the bow. EI is proportional to the length cubed: 2 % of length are 6 % of
 * EI, 5 % are 16 %. */
static const double doubtful_length = 0.02, unusable_length = 0.05;
/* Largest deflection over length of this check. */
static const double near_zero = 0.03;

/* --- limits of the checks of fits --- */

/* Travel over length that K and n need; below the second number the law is little more than EI. */
static const double full_travel = 0.35, short_travel = 0.20;
/* Standard uncertainty of the level of zero deflection (two markers), without the stated
 * uncertainties of gain, counterweight and others; and the limits in standard uncertainties, the
 * second one for a bow that disagrees as well. (With 4 and 2.5, 3 % of healthy benches were
 * doubted.) */
static const double bench_level = 0.1 * WB_MM;
static const double level_limit = 4.5, level_limit_with_bow = 3.2;
/* The same for the mean over all specimens, which have the systematic error of the law in common.
 */
static const double common_limit = 5.0;
/* Least share of the level that the data must determine for the check. */
static const double least_level_share = 0.2;
/* Largest misfit for the check: that of a law can move level and bow. */
static const double largest_followed = 5e-3;
/* Difference of measured and computed force at zero deflection, over the largest force. */
static const double zero_share = 0.01;
/* A wrong zero explains a misfit beyond `least_missed` if a fit with a free zero, without its
 * prior, reduces the misfit to this part of it. */
static const double least_missed = 2.3e-3, explained_part = 0.6, free_place = 10.0 * WB_MM;
/* And to less than this part of the largest force; otherwise the law is wrong, whatever the zero.
 */
static const double largest_explained = 2e-3;
/* Below this tension (N) the strand may be slack. */
static const double slack = 2.5e-3;
/* Limits in standard deviations between two estimates of the bow. */
static const double bow_limit = 3.0, bow_doubt = 5.0;
/* Least part of the largest force of a bent wire. */
static const double bent_share = 0.2;
/* Least fall of the force at rest that is reported, in standard errors and as a part of the largest
 * force; from the last one on it is a doubt. */
static const double fall_noise = 4.0, least_fall = 2e-3, doubted_fall = 5e-3;
/* Largest misfit, as a part of the largest force and in units of the noise of the readings. */
static const double misfit_share = 0.01, misfit_noise = 3.0;
/* Largest difference of ln(EI) between a specimen and the others, in standard deviations; and the
 * least standard deviation, since that of a few specimens is known poorly. Specimens cut from one
 * reel differ by 2 to 7 %. */
static const double rigidity_limit = 4.0, least_deviation = 0.05;
/* False-alarm rate of the test for two batches. */
static const double batches_level = 0.02;
/* Largest part of rows left out as outliers. */
static const double outlier_share = 0.02;
/* Lengths that are tried, over the labelled one; and the parts to which a better length must reduce
 * misfit and level. */
static const double other_lengths[] = {1.08, 1.18, 1.28};
static const double better_fit = 0.6, better_level = 0.5;

const char *wb_cycle_check_severity_name(enum wb_cycle_check_severity severity)
{
    static const char *const names[] = {"note", "doubt", "unusable"};
    return names[severity];
}

/* Adds a remark. */
static void __attribute__((format(printf, 4, 5)))
say(struct wb_cycle_remarks *remarks, enum wb_cycle_check_severity severity, int sample,
    const char *format, ...)
{
    if (remarks->n == WB_CYCLE_MOST_REMARKS)
        return;
    struct wb_cycle_remark *const remark = &remarks->items[remarks->n++];
    va_list arguments;
    remark->severity = severity;
    remark->sample = sample;
    va_start(arguments, format);
    vsnprintf(remark->text, sizeof remark->text, format, arguments);
    va_end(arguments);
}

/* Adds a remark on one specimen, whose text begins with its wire and sample. Returns whether the
 * data are unusable. */
static bool __attribute__((format(printf, 4, 5)))
say_of(struct wb_cycle_remarks *remarks, enum wb_cycle_check_severity severity,
       const struct wb_test_info *info, const char *format, ...)
{
    char text[sizeof remarks->items[0].text];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    say(remarks, severity, info->sample, "wire '%s', sample %d: %s", info->wire, info->sample,
        text);
    return severity == WB_CHECK_UNUSABLE;
}

const struct wb_cycle_remark *wb_cycle_check_find(const struct wb_cycle_remarks *remarks,
                                                  enum wb_cycle_check_severity severity)
{
    for (int i = 0; i < remarks->n; i++) {
        if (remarks->items[i].severity >= severity)
            return &remarks->items[i];
    }
    return NULL;
}

enum wb_status wb_cycle_check_refuse(const struct wb_cycle_remarks *remarks, struct wb_reason *why)
{
    const struct wb_cycle_remark *const remark = wb_cycle_check_find(remarks, WB_CHECK_UNUSABLE);
    return remark ? wb_fail_to(why, WB_ERR_DATA, "%s", remark->text) : WB_OK;
}

/* --- rows of the first loading --- */

struct loading {
    const struct wb_dataset *dataset;
    size_t n;
    double *memory;       /* workspace: as many numbers as rows of either kind; owned */
    double top;           /* m */
    double zero, largest; /* N: tension at zero deflection, and the largest */
    double stiffness;     /* N/m: slope of a chord over the first third; NaN: unknown */
};

static bool is_loading(const struct wb_row *row)
{
    return row->cycle == 1 && row->phase == WB_PHASE_LOAD && isfinite(row->deflection) &&
           isfinite(row->tension);
}

/* The 99th percentile, which ignores single wild readings. */
static double nearly_largest(double *values, size_t n)
{
    wb_fit_sort(values, n);
    return n > 0 ? values[n - 1 - n / 100] : (double)NAN;
}

/* Median tension of the loading's rows in a range of deflections. */
static double tension_between(const struct loading *loading, double from, double to)
{
    size_t n = 0;
    for (size_t i = 0; i < loading->dataset->n_rows; i++) {
        const struct wb_row *const row = &loading->dataset->rows[i];
        if (is_loading(row) && row->deflection >= from && row->deflection <= to)
            loading->memory[n++] = row->tension;
    }
    return wb_fit_median(loading->memory, n);
}

static void look_at_loading(struct loading *loading)
{
    const struct wb_dataset *const dataset = loading->dataset;
    loading->n = 0;
    for (size_t i = 0; i < dataset->n_rows; i++) {
        if (is_loading(&dataset->rows[i]))
            loading->memory[loading->n++] = dataset->rows[i].deflection;
    }
    const double top = loading->top = nearly_largest(loading->memory, loading->n);
    size_t n = 0;
    for (size_t i = 0; i < dataset->n_rows; i++) {
        if (is_loading(&dataset->rows[i]))
            loading->memory[n++] = dataset->rows[i].tension;
    }
    loading->largest = nearly_largest(loading->memory, n);
    loading->zero = tension_between(loading, -0.02 * top, 0.04 * top);
    loading->stiffness = (tension_between(loading, 0.2 * top, 0.3 * top) -
                          tension_between(loading, 0.0, 0.1 * top)) /
                         (0.2 * top);
}

/* Distance of markers from the clamp over their arc lengths, and of the tip over the length:
 * medians near zero deflection, of which the one farther from 1 is returned; NaN if neither is
 * known. */
static double length_seen(const struct loading *loading)
{
    const struct wb_dataset *const dataset = loading->dataset;
    const double length = dataset->info.length;
    double turn = (double)INFINITY;
    size_t n = 0;
    for (size_t i = 0; i < dataset->n_rows && !isfinite(turn); i++) {
        if (dataset->rows[i].phase == WB_PHASE_UNLOAD)
            turn = dataset->rows[i].t;
    }
    for (size_t i = 0; i < dataset->n_shape_rows; i++) {
        const struct wb_shape_row *const row = &dataset->shape_rows[i];
        if (row->t < turn && fabs(row->deflection) < near_zero * length && row->s > 0.5 * length)
            loading->memory[n++] = row->x / row->s;
    }
    const double markers = wb_fit_median(loading->memory, n);
    n = 0;
    for (size_t i = 0; i < dataset->n_rows; i++) {
        const struct wb_row *const row = &dataset->rows[i];
        if (is_loading(row) && fabs(row->deflection) < near_zero * length && isfinite(row->tip_x))
            loading->memory[n++] = row->tip_x / length;
    }
    const double tip = wb_fit_median(loading->memory, n);
    return fabs(markers - 1.0) > fabs(tip - 1.0) || !isfinite(tip) ? markers : tip;
}

/* Weights that the strand carries at zero deflection, N. */
static double weights(const struct wb_test_info *info)
{
    return info->gravity * (info->counterweight + 0.375 * info->mass_per_length * info->length);
}

/* Each of these functions makes at most one remark, and returns whether the data are unusable. */

static bool check_deflections(struct wb_cycle_remarks *remarks, const struct loading *loading)
{
    const struct wb_test_info *const info = &loading->dataset->info;
    const double share = loading->top / info->length;

    if (share > most_deflection)
        return say_of(remarks, WB_CHECK_UNUSABLE, info,
                      "the deflection reaches %.4g mm, the wire is %g mm long: %s? Expected "
                      "deflection_mm in millimetres, and the length as tested",
                      loading->top / WB_MM, info->length / WB_MM,
                      share < 1e3 * most_deflection && share > 1e3 * metres_travel
                          ? "are the deflections in micrometres"
                          : "is one of them wrong");
    if (share < metres_travel && 1e3 * share > least_travel && 1e3 * share < most_deflection)
        return say_of(remarks, WB_CHECK_UNUSABLE, info,
                      "the deflection ends at %.4g mm on a wire of %g mm: are the deflections in "
                      "metres? Expected deflection_mm in millimetres",
                      loading->top / WB_MM, info->length / WB_MM);
    if (share < least_travel)
        return say_of(remarks, WB_CHECK_UNUSABLE, info,
                      "the first loading ends at %.2f mm of deflection, %.2f of the length: "
                      "nothing can be determined from so little; at least %.1f mm give EI, %.0f mm "
                      "the law: test with a longer travel",
                      loading->top / WB_MM, share, least_travel * info->length / WB_MM,
                      full_travel * info->length / WB_MM);
    return false;
}

static bool check_forces(struct wb_cycle_remarks *remarks, const struct loading *loading)
{
    const struct wb_test_info *const info = &loading->dataset->info;
    const double carried = weights(info);
    const double second_moment = wb_circle_second_moment(info->outer_diameter);
    const double modulus = loading->stiffness * pow(info->length, 3) / (3.0 * second_moment);
    const double ratio = carried > 0.0 ? loading->zero / carried : (double)NAN;

    if (ratio > most_weights)
        return say_of(remarks, WB_CHECK_UNUSABLE, info,
                      "the tension at zero deflection is %.4g N, counterweight and wire weigh %.4g "
                      "N, %.0f times less: are the forces in %s? Expected tension_N and force_N in "
                      "newtons, and the counterweight in the rig file in grams",
                      loading->zero, carried, ratio,
                      ratio > millinewtons ? "millinewtons" : "grams");
    if (carried > 0.0 && loading->largest < least_weights * carried)
        return say_of(remarks, WB_CHECK_UNUSABLE, info,
                      "the tension stays below %.4g N, counterweight and wire alone weigh %.4g N: "
                      "are the forces in kilonewtons, or were the weights tared away? Expected "
                      "tension_N as the strand carries it, in newtons",
                      loading->largest, carried);
    if (modulus > most_modulus || (modulus > 0.0 && modulus < least_modulus))
        return say_of(remarks, WB_CHECK_UNUSABLE, info,
                      "the force rises by %.4g N/m, as on a solid rod of %.3g GPa; expected %g to "
                      "%g GPa: are the forces in %s? Expected newtons and millimetres; look at "
                      "diameter (%g mm) and length (%g mm) too",
                      loading->stiffness, modulus / 1e9, least_modulus / 1e9, most_modulus / 1e9,
                      modulus > most_modulus ? "millinewtons or grams" : "kilonewtons",
                      info->outer_diameter / WB_MM, info->length / WB_MM);
    return false;
}

static bool check_length(struct wb_cycle_remarks *remarks, const struct loading *loading)
{
    const struct wb_test_info *const info = &loading->dataset->info;
    const double seen = length_seen(loading);
    const double off = fabs(seen - 1.0);
    if (!(off > doubtful_length))
        return false;
    return say_of(remarks, off > unusable_length ? WB_CHECK_UNUSABLE : WB_CHECK_DOUBT, info,
                  "at zero deflection the markers stand at %.3f times their distance along the "
                  "wire, expected 1 within %g: is the specimen %.1f mm long, not %g? EI goes with "
                  "the cube of the length; measure it from the clamp to the strand",
                  seen, doubtful_length, seen * info->length / WB_MM, info->length / WB_MM);
}

/* Checks that the points can be taken. */
static void check_points(struct wb_cycle_remarks *remarks, const struct wb_dataset *dataset)
{
    struct wb_reason why = {.text = ""};
    struct wb_cycle_data data;
    if (wb_cycle_data_take(&data, dataset, NULL, &why) != WB_OK)
        say(remarks, WB_CHECK_UNUSABLE, dataset->info.sample, "%s", why.text);
    wb_cycle_data_release(&data);
}

void wb_cycle_check_data(struct wb_cycle_remarks *remarks, const struct wb_dataset *const *datasets,
                         int n)
{
    for (int i = 0; i < n; i++) {
        struct loading loading = {.dataset = datasets[i]};
        loading.memory =
            wb_memory_new(datasets[i]->n_rows + datasets[i]->n_shape_rows, sizeof *loading.memory);
        look_at_loading(&loading);
        /* The basic checks first: a wrong unit makes the later ones fail, too. */
        const bool is_unusable =
            loading.n > 0 && (check_deflections(remarks, &loading) ||
                              check_forces(remarks, &loading) || check_length(remarks, &loading));
        free(loading.memory);
        if (!is_unusable)
            check_points(remarks, datasets[i]);
    }
}

/* --- fits --- */

struct specimen {
    const struct wb_test_info *info;
    const struct wb_cycle_member *member;
    const struct wb_cycle_data *data;
    const struct wb_dataset *dataset;
    const struct wb_cycle_fit *fit; /* standard errors with the chosen law */
    /* Standard uncertainties of the level and of the bow (m) due to those that the files state of
     * gain, counterweight and others. */
    double level_of_shared, bow_of_shared;
    double relaxation_prior;
};

/* Finds them from the results of the fit with altered data. */
static void find_shared(struct specimen *s)
{
    const struct wb_cycle_fit *const fit = s->fit;
    const double length = s->info->length;
    s->level_of_shared = s->bow_of_shared = 0.0;
    for (int i = 0; i < WB_SHARED; i++) {
        if (!fit->has_altered[i])
            continue;
        const double changes = wb_cycle_shared_uncertainty(s->data, s->relaxation_prior, i) /
                               wb_cycle_shared_change(i);
        const struct wb_cycle_specimen *const altered = &fit->altered_specimen[i];
        s->level_of_shared = hypot(s->level_of_shared, changes * (altered->level - fit->level));
        s->bow_of_shared =
            hypot(s->bow_of_shared, 0.5 * length * changes * (altered->bow_angle - fit->bow_angle));
    }
}

/* The bow of the alignment and its standard deviation, m; false if it gave none. */
static bool aligned_bow(const struct wb_dataset *dataset, double *bow, double *deviation)
{
    const struct wb_test_info *const info = &dataset->info;
    *bow = 0.0;
    for (int i = 0; i < info->n_natural_shape; i++)
        *bow += info->natural_shape[i] * info->length / (i + 2);
    *deviation = wb_cycle_bow_deviation(dataset);
    return info->n_natural_shape > 0;
}

/* Tension of the fitted law at zero deflection; NaN if the beam cannot be computed there.
 */
static enum wb_status computed_zero(const struct specimen *specimen, double *tension)
{
    struct wb_cycle_point zero = {.deflection = 0.0};
    struct wb_cycle_data one = *specimen->data;
    const struct wb_cycle_model_settings settings = {0, 0};
    const struct wb_cycle_specimen own = {specimen->fit->bow_angle, specimen->fit->level,
                                          specimen->fit->uneven_angle};
    struct wb_cycle_model *model;
    struct wb_cycle_run run;
    one.points = &zero;
    one.n_points = one.n_loading = 1;
    one.n_places = 0;
    *tension = (double)NAN;
    WB_TRY(wb_cycle_model_create(&model, &one, &specimen->fit->law, &settings));
    const enum wb_status status =
        wb_cycle_model_run(model, &specimen->fit->law, &own, tension, NULL, &run);
    wb_cycle_model_destroy(model);
    return status;
}

static void check_natural_shape(struct wb_cycle_remarks *remarks, const struct specimen *s)
{
    const struct wb_cycle_bow bow = wb_cycle_fit_bow(s->fit, s->info->length);
    if (s->info->n_natural_shape > 0)
        return;
    say_of(remarks, WB_CHECK_NOTE, s->info,
           "the dataset has no natural shape; the fit found a bow of %.2f mm (standard error %.2f "
           "mm) by itself, but nothing confirms it: align the recording again",
           bow.tip / WB_MM, bow.deviation / WB_MM);
}

static void check_travel(struct wb_cycle_remarks *remarks, const struct specimen *s)
{
    const double length = s->info->length, share = s->data->top / length;
    if (share >= full_travel)
        return;
    say_of(remarks, share < short_travel ? WB_CHECK_DOUBT : WB_CHECK_NOTE, s->info,
           "the travel ends at %.1f mm, %.2f of the length: EI may be used (to some 15 %%), K and "
           "n are not identifiable, and beyond a curvature of %.1f /m the law is not known; "
           "expected %.2f of the length: a travel of %.0f mm is enough",
           s->data->top / WB_MM, share, s->fit->clamp_curvature, full_travel,
           ceil(full_travel * length / WB_MM));
}

static void check_outliers(struct wb_cycle_remarks *remarks, const struct specimen *s)
{
    long rows = s->data->n_outliers;
    for (int i = 0; i < s->data->n_points; i++)
        rows += s->data->points[i].n_rows;
    if (s->data->n_outliers == 0 && s->fit->n_outliers == 0)
        return;
    const bool many = s->data->n_outliers > outlier_share * (double)rows;
    say_of(remarks, many ? WB_CHECK_DOUBT : WB_CHECK_NOTE, s->info,
           "%d of %ld rows were left out as outliers, %d of %d points weighted down%s",
           s->data->n_outliers, rows, s->fit->n_outliers, s->data->n_points,
           many ? ": expected at most 2 % of the rows; look for knocks, a loose plug, lost markers"
                : "");
}

static void check_misfit(struct wb_cycle_remarks *remarks, const struct specimen *s)
{
    double sum = 0.0;
    for (int i = 0; i < s->data->n_points; i++)
        sum += pow(s->data->points[i].deviation / s->data->max_force, 2);
    const double noise = sqrt(sum / s->data->n_points);
    if (s->fit->misfit <= fmax(misfit_share, misfit_noise * noise))
        return;
    say_of(remarks, WB_CHECK_DOUBT, s->info,
           "the best law misses the force by %.2f %% of the largest (loading %.2f, unloading "
           "%.2f), expected at most %.2f %%: slip in the clamp, creep, a wrong length or zero, or "
           "a wire that no law here describes; look at the residuals and test another specimen",
           100.0 * s->fit->misfit, 100.0 * s->fit->loading_misfit, 100.0 * s->fit->unloading_misfit,
           100.0 * fmax(misfit_share, misfit_noise * noise));
}

/* Fits a law with one free zero without a prior: of force, or of deflection and all places.
 * *is_fitted is false if the fit does not converge. */
static enum wb_status fit_law_freely(const struct specimen *s, const struct wb_cycle_fit *fit,
                                     bool frees_force, struct wb_cycle_fit *freed, bool *is_fitted)
{
    const struct wb_law *const law = &fit->law;
    struct wb_cycle_grid grid = {.last_strain =
                                     0.5 * s->info->outer_diameter * fit->clamp_curvature};
    struct wb_cycle_fit_settings settings;
    struct wb_reason why;
    wb_cycle_fit_default_settings(&settings);
    if (frees_force)
        settings.zero_prior = s->data->max_force;
    else
        settings.level_prior = settings.place_noise = settings.offset_prior = free_place;
    if (law->form == WB_LAW_PARALLEL) {
        const double ratio = law->parts[1].yield_strain / law->parts[0].yield_strain;
        grid.first_strain = law->parts[0].yield_strain;
        grid.last_strain = grid.first_strain * pow(ratio, law->n_parts - 1);
    }
    const enum wb_status status =
        wb_cycle_fit_run(freed, s->data, fit->candidate, law, NULL, &grid, &settings, &why);
    *is_fitted = status == WB_OK;
    return status == WB_ERR_CONVERGENCE ? WB_OK : status;
}

/* The same with the chosen law and, if its misfit stays large, with parallel parts, which may be
 * the right law that the wrong zero concealed. */
static enum wb_status fit_freely(const struct specimen *s, bool frees_force,
                                 struct wb_cycle_fit *freed, bool *is_fitted)
{
    const struct wb_cycle_answer *const parts =
        &s->member->answers[WB_CANDIDATE_PARALLEL_KINEMATIC];
    struct wb_cycle_fit other = {.tension = NULL};
    bool has_other = false;
    WB_TRY(fit_law_freely(s, s->fit, frees_force, freed, is_fitted));
    if (!parts->is_fitted || (*is_fitted && freed->misfit <= largest_explained))
        return WB_OK;
    WB_TRY(fit_law_freely(s, &parts->fit, frees_force, &other, &has_other));
    if (has_other && !(*is_fitted && freed->misfit <= other.misfit)) {
        wb_cycle_fit_release(freed);
        *freed = other;
        *is_fitted = true;
        return WB_OK;
    }
    wb_cycle_fit_release(&other);
    return WB_OK;
}

/* Refits with other lengths, longer ones if the level is too high. Returns the length that fits
 * clearly better; 0: none. */
static double find_length(const struct specimen *s, double level)
{
    const struct wb_cycle_answer *const answers = s->member->answers;
    const enum wb_candidate candidate = answers[WB_CANDIDATE_LUDWIK_KINEMATIC].is_fitted
                                            ? WB_CANDIDATE_LUDWIK_KINEMATIC
                                            : WB_CANDIDATE_LUDWIK_ISOTROPIC;
    const struct wb_cycle_grid none = {0.0, 0.0};
    struct wb_cycle_fit_settings settings;
    const struct wb_cycle_fit *const labelled = &answers[candidate].fit;
    double least = better_fit * labelled->misfit, better = 0.0;

    if (!answers[candidate].is_fitted)
        return better;
    wb_cycle_fit_default_settings(&settings);
    for (size_t i = 0; i < sizeof other_lengths / sizeof other_lengths[0]; i++) {
        const double ratio = level > 0.0 ? other_lengths[i] : 1.0 / other_lengths[i];
        struct wb_cycle_data data = *s->data;
        struct wb_law start = labelled->law;
        struct wb_cycle_fit fit;
        struct wb_reason why;
        data.info.length *= ratio;
        /* Initial guess with the same stiffness and yield force for the longer wire. */
        start.material.youngs_modulus *= pow(ratio, 3);
        start.material.yield_stress *= ratio;
        if (wb_cycle_fit_run(&fit, &data, candidate, &start, NULL, &none, &settings, &why) != WB_OK)
            continue;
        if (fit.misfit < least && fabs(fit.level) < better_level * fabs(level)) {
            least = fit.misfit;
            better = data.info.length;
        }
        wb_cycle_fit_release(&fit);
    }
    return better;
}

static bool check_other_length(struct wb_cycle_remarks *remarks, const struct specimen *s,
                               double level)
{
    const double better = find_length(s, level);
    if (better > 0.0)
        say_of(remarks, WB_CHECK_DOUBT, s->info,
               "a length of about %.0f mm fits clearly better than the %g mm it is labelled with: "
               "measure it; EI goes with the cube of the length",
               better / WB_MM, s->info->length / WB_MM);
    return better > 0.0;
}

/* The level without its prior, and its standard uncertainties: of this specimen, and the one that
 * all specimens share. If the data hardly determine the level, that of the fit. */
static void find_level(const struct specimen *s, double *level, double *own, double *shared)
{
    const struct wb_cycle_fit *const fit = s->fit;
    const bool is_known = fit->level_share > least_level_share;
    const double share = is_known ? fit->level_share : 1.0;
    *level = fit->level / share;
    *own = hypot(bench_level, is_known ? fit->level_error : 0.0);
    *shared = s->level_of_shared / share;
}

/* A wrong zero of force or a wrong counterweight changes level, force at zero deflection and bow; a
 * wrong zero of deflection does not change the bow. */
static enum wb_status check_zeros_of(struct wb_cycle_remarks *remarks, const struct specimen *s,
                                     bool length_is_seen)
{
    const struct wb_cycle_data *const data = s->data;
    const double length = data->info.length;
    const struct wb_cycle_bow bow = wb_cycle_fit_bow(s->fit, length);
    double zero, bow_before, deviation, level, own, shared;

    WB_TRY(computed_zero(s, &zero));
    /* After the first points, where the strand takes over the load from the rest. */
    const struct wb_cycle_point *const low = &data->points[3], *const high = &data->points[7];
    const double stiffness = (high->tension - low->tension) / (high->deflection - low->deflection);
    find_level(s, &level, &own, &shared);
    const double level_deviation = hypot(own, shared);
    /* The level is within its limits, so it does not explain the difference. */
    const double limit =
        fmax(zero_share * data->max_force, level_limit * level_deviation * fmax(stiffness, 0.0));
    const bool has_bow = aligned_bow(s->dataset, &bow_before, &deviation);
    const double apart =
        fabs(bow.tip - bow_before) / hypot(hypot(deviation, bow.deviation), s->bow_of_shared);
    const bool bow_off = has_bow && apart > bow_limit;
    const bool zero_off =
        zero > slack && data->zero_tension > slack && fabs(data->zero_tension - zero) > limit;
    const bool level_off =
        fabs(level) > (bow_off ? level_limit_with_bow : level_limit) * level_deviation;
    if (!level_off && !zero_off && !(has_bow && apart > bow_doubt)) {
        if (bow_off)
            say_of(remarks, WB_CHECK_NOTE, s->info,
                   "the bow of the alignment is %.2f mm, that of the fit %.2f mm, %.1f standard "
                   "deviations apart, expected at most %g; force and level at zero agree with the "
                   "fit's",
                   bow_before / WB_MM, bow.tip / WB_MM, apart, bow_limit);
        return WB_OK;
    }
    if (!length_is_seen && check_other_length(remarks, s, level))
        return WB_OK;
    char bows[160] = "";
    if (has_bow)
        snprintf(bows, sizeof bows,
                 "; bow %.2f mm, %.2f mm by the alignment (%.1f standard "
                 "deviations apart, expected at most %g)",
                 bow.tip / WB_MM, bow_before / WB_MM, apart, bow_limit);
    say_of(
        remarks, WB_CHECK_DOUBT, s->info,
        "%s is wrong: at zero deflection the tension is %.2f mN, the law's %.2f mN (expected "
        "within %.2f mN), and zero deflection lies %.2f mm off (expected within %.2f mm)%s; %s%s",
        bow_off ? "the zero of force or the counterweight" : "the zero of deflection, or of force,",
        data->zero_tension / WB_MN, zero / WB_MN, limit / WB_MN, level / WB_MM,
        level_limit * level_deviation / WB_MM, bows,
        bow_off ? "weigh the counterweight, tare the cell with nothing on it and record again"
                : "look at the markers of clamp and tip and their offset from the axis, then at "
                  "tare and counterweight",
        s->fit->misfit > largest_followed
            ? "; where all specimens say so, the law itself may not follow this wire"
            : "");
    return WB_OK;
}

/* Typical residual of a point over the largest force, as a robust standard deviation: a few
 * outliers, such as points at which the wire was still on its rest, have no effect. */
static double usual_miss(const struct specimen *s)
{
    const struct wb_cycle_data *const data = s->data;
    double *const sizes = wb_memory_new((size_t)data->n_points, sizeof *sizes);
    for (int i = 0; i < data->n_points; i++)
        sizes[i] = fabs(s->fit->tension[i] - data->points[i].tension);
    const double miss = wb_fit_usual_size(sizes, (size_t)data->n_points);
    free(sizes);
    return miss / data->max_force;
}

/* Error of the zero of force by two stated uncertainties of the counterweight, N. */
static double stated_zero(const struct wb_cycle_data *data)
{
    return 2.0 * data->info.uncertainty.counterweight * data->info.gravity;
}

/* Mean of an error over all specimens, and its standard uncertainty: the contribution of the
 * specimens' own errors decreases with their number, the shared one does not. */
struct common_error {
    int n;
    double sum, own, shared; /* own: sum of squares of the specimens' own uncertainties */
};

static void add_error(struct common_error *error, double value, double own, double shared)
{
    if (!isfinite(value + own + shared))
        return;
    error->n++;
    error->sum += value;
    error->own += own * own;
    error->shared += shared;
}

static double mean_of(const struct common_error *error)
{
    return error->sum / error->n;
}

static double deviation_of(const struct common_error *error)
{
    return hypot(sqrt(error->own), error->shared) / error->n;
}

/* A wrong zero or counterweight of the bench affects all specimens: their mean shows an error that
 * is within the limits of a single specimen. Only specimens that the law describes are used. */
static void check_zeros_of_all(struct wb_cycle_remarks *remarks, const struct specimen *specimens,
                               int n)
{
    struct common_error level = {0}, bow = {0};
    for (int i = 0; i < n; i++) {
        const struct specimen *const s = &specimens[i];
        const struct wb_cycle_fit *const fit = s->fit;
        const struct wb_cycle_bow fitted = wb_cycle_fit_bow(fit, s->info->length);
        double aligned, deviation, own_level, own, shared;
        if (usual_miss(s) > least_missed)
            continue;
        find_level(s, &own_level, &own, &shared);
        add_error(&level, own_level, own, shared);
        if (aligned_bow(s->dataset, &aligned, &deviation))
            add_error(&bow, fitted.tip - aligned, hypot(deviation, fitted.deviation),
                      s->bow_of_shared);
    }
    if (bow.n > 1 && fabs(mean_of(&bow)) > common_limit * deviation_of(&bow))
        say(remarks, WB_CHECK_DOUBT, 0,
            "wire '%s': the zero of force or the counterweight is wrong: the bows of %d specimens "
            "differ from those of the alignment by %.2f mm on average (expected within %.2f mm); "
            "weigh the counterweight, tare the cell with nothing on it and record again",
            specimens[0].info->wire, bow.n, mean_of(&bow) / WB_MM,
            common_limit * deviation_of(&bow) / WB_MM);
    else if (level.n > 1 && fabs(mean_of(&level)) > common_limit * deviation_of(&level))
        say(remarks, WB_CHECK_DOUBT, 0,
            "wire '%s': the zero of deflection, or of force, is wrong: in %d specimens zero "
            "deflection lies %.2f mm off on average (expected within %.2f mm); look at the markers "
            "of clamp and tip and their offset from the axis, then at tare and counterweight",
            specimens[0].info->wire, level.n, mean_of(&level) / WB_MM,
            common_limit * deviation_of(&level) / WB_MM);
}

/* A law with a large misfit is either wrong for the wire, or a zero is wrong; in the second case it
 * fits with another zero. */
static enum wb_status check_zeros(struct wb_cycle_remarks *remarks, const struct specimen *s,
                                  bool length_is_seen)
{
    struct wb_cycle_fit level = {.tension = NULL}, force = {.tension = NULL};
    struct specimen looked_at = *s;
    bool has_level, has_force = false;
    if (usual_miss(s) <= least_missed) {
        const int n = remarks->n;
        const enum wb_status status = check_zeros_of(remarks, s, length_is_seen);
        if (remarks->n == n)
            check_misfit(remarks, s);
        return status;
    }
    enum wb_status status = fit_freely(s, false, &level, &has_level);
    if (status == WB_OK)
        status = fit_freely(s, true, &force, &has_force);
    const double missed = fmin(explained_part * s->fit->misfit, largest_explained);
    const bool is_level = has_level && level.misfit <= missed;
    const bool is_force = has_force && force.misfit <= missed;
    const bool is_stated = is_force && fabs(force.zero) <= stated_zero(s->data);
    /* Only within the limits of the chosen fit: without its prior the level can take any value. */
    looked_at.fit = &level;
    if (status == WB_OK && !is_level && !is_force) {
        if (length_is_seen || !has_level || !check_other_length(remarks, s, level.level))
            check_misfit(remarks, s);
    } else if (status == WB_OK && is_level && (!is_force || level.misfit <= force.misfit)) {
        status = check_zeros_of(remarks, &looked_at, length_is_seen);
    } else if (status == WB_OK && is_stated) {
        check_misfit(remarks, s);
    } else if (status == WB_OK &&
               (length_is_seen || !has_level || !check_other_length(remarks, s, level.level))) {
        say_of(remarks, WB_CHECK_DOUBT, s->info,
               "the zero of force or the counterweight is wrong: the law misses the force by %.2f "
               "%% of the largest, by %.2f %% if %.2f mN are taken off; weigh the counterweight, "
               "tare the cell with nothing on it and record again",
               100.0 * s->fit->misfit, 100.0 * force.misfit, force.zero / WB_MN);
    }
    wb_cycle_fit_release(&level);
    wb_cycle_fit_release(&force);
    return status;
}

static bool is_length_seen(const struct wb_dataset *dataset)
{
    if (dataset->n_shape_rows > 0)
        return true;
    for (size_t i = 0; i < dataset->n_rows; i++) {
        if (isfinite(dataset->rows[i].tip_x))
            return true;
    }
    return false;
}

/* --- specimens against each other --- */

static double ln_rigidity(const struct wb_cycle_calibration *calibration, int i)
{
    return log(calibration->members[i].answers[calibration->chosen].value[WB_CYCLE_RIGIDITY]);
}

static void check_others(struct wb_cycle_remarks *remarks,
                         const struct wb_cycle_calibration *calibration)
{
    const int n = calibration->n_members;
    const char *const wire = calibration->members[0].data.info.wire;
    if (n == 1) {
        if (!isfinite(calibration->rigidity.deviation))
            say(remarks, WB_CHECK_NOTE, 0,
                "wire '%s': one specimen cannot show how specimens differ: the intervals are those "
                "of this specimen, not of the product; test at least three",
                wire);
        return;
    }
    if (n == 2) {
        const double apart = ln_rigidity(calibration, 0) - ln_rigidity(calibration, 1);
        if (fabs(apart) > rigidity_limit * M_SQRT2 * least_deviation)
            say(remarks, WB_CHECK_DOUBT, 0,
                "wire '%s': EI of specimens %d and %d differ by %.0f %%, expected at most %.0f %%: "
                "is one of another wire, or its length wrong? Test a third",
                wire, calibration->members[0].sample, calibration->members[1].sample,
                100.0 * expm1(fabs(apart)),
                100.0 * expm1(rigidity_limit * M_SQRT2 * least_deviation));
        return;
    }
    /* Compares each specimen with all others, without itself, because an outlier increases a common
     * deviation. Only the farthest one is reported; it makes the others look like outliers, too. */
    int farthest = -1;
    double most = rigidity_limit, off = 0.0, allowed = 0.0;
    for (int i = 0; i < n; i++) {
        double sum = 0.0, squares = 0.0;
        for (int k = 0; k < n; k++) {
            const double x = ln_rigidity(calibration, k);
            sum += k == i ? 0.0 : x;
            squares += k == i ? 0.0 : x * x;
        }
        const double mean = sum / (n - 1);
        const double own = sqrt(fmax(0.0, squares - (n - 1) * mean * mean) / (n - 2));
        const double deviation = fmax(own, least_deviation);
        const double away = ln_rigidity(calibration, i) - mean;
        if (fabs(away) / deviation > most) {
            most = fabs(away) / deviation;
            farthest = i;
            off = away;
            allowed = rigidity_limit * deviation;
        }
    }
    if (farthest >= 0)
        say_of(remarks, WB_CHECK_DOUBT, &calibration->members[farthest].data.info,
               "EI is %.0f %% %s than the others', expected within %.0f %%: is it of this wire, "
               "its length right, and clamped as the others? Leave it out or test it again",
               100.0 * fabs(expm1(off)), off > 0.0 ? "higher" : "lower", 100.0 * expm1(allowed));
}

/* Uses the moment at the largest curvature, which is known best. */
static void check_batches(struct wb_cycle_remarks *remarks,
                          const struct wb_cycle_calibration *calibration)
{
    const int n = calibration->n_members, number = WB_CYCLE_FIRST_MOMENT + WB_CYCLE_MOMENTS - 1;
    double *const x = wb_memory_new((size_t)n, sizeof *x);
    struct wb_text groups[2] = {{.bytes = NULL}, {.bytes = NULL}};
    for (int i = 0; i < n; i++)
        x[i] = log(calibration->members[i].answers[calibration->chosen].value[number]);
    const struct wb_batches found = wb_batches_find(x, n, batches_level);
    for (int i = 0; i < n; i++) {
        struct wb_text *const group = &groups[x[i] > found.border];
        wb_text_append(group, "%s%d", group->bytes ? ", " : "", calibration->members[i].sample);
    }
    if (found.are_two)
        say(remarks, WB_CHECK_DOUBT, 0,
            "wire '%s': specimens %s and specimens %s are two groups, whose moments at the largest "
            "curvature are %.0f %% apart; of products of one kind, 1 in %.0f looks like this. Are "
            "they of two batches? Calibrate each by itself",
            calibration->members[0].data.info.wire, wb_text_string(&groups[0]),
            wb_text_string(&groups[1]), 100.0 * expm1(found.apart), 1.0 / batches_level);
    wb_text_release(&groups[0]);
    wb_text_release(&groups[1]);
    free(x);
}

static void check_holds(struct wb_cycle_remarks *remarks, const struct specimen *s)
{
    double seconds;
    const int n = wb_holds_of_bent_wire(s->dataset, &seconds);
    if (n > 0)
        say_of(remarks, WB_CHECK_DOUBT, s->info,
               "the test was held %d time%s, for %.0f s in all, while the wire was bent: it "
               "relaxed, and no law here includes it. Leave it out or test it again without a hold",
               n, n == 1 ? "" : "s", seconds);
}

/* Mean tension of some rows, and the square of its standard error; NaN for fewer than two rows with
 * a tension. */
static double mean_tension(const struct wb_row *rows, size_t n, double *variance)
{
    double sum = 0.0, squares = 0.0;
    int known = 0;
    for (size_t i = 0; i < n; i++) {
        if (isfinite(rows[i].tension)) {
            sum += rows[i].tension;
            known++;
        }
    }
    const double mean = known > 1 ? sum / known : (double)NAN;
    for (size_t i = 0; i < n; i++)
        squares += isfinite(rows[i].tension) ? pow(rows[i].tension - mean, 2.0) : 0.0;
    *variance = squares / (known - 1.0) / known;
    return mean;
}

/* Reports the largest fall of the force among all stops. */
static void check_relaxation(struct wb_cycle_remarks *remarks, const struct specimen *s)
{
    struct wb_stop stops[MOST_STOPS];
    const struct wb_row *const rows = s->dataset->rows;
    const int n = wb_stops_find(s->dataset, 0, bent_share * s->data->max_force, stops, MOST_STOPS);
    const struct wb_stop *worst = NULL;
    double most = 0.0;
    for (int i = 0; i < n; i++) {
        const size_t fifth = (stops[i].end - stops[i].first) / 5;
        double before, after;
        const double fall = mean_tension(&rows[stops[i].first], fifth, &before) -
                            mean_tension(&rows[stops[i].end - fifth], fifth, &after);
        if (!(fall > fall_noise * sqrt(before + after) && fall > most))
            continue;
        most = fall;
        worst = &stops[i];
    }
    const double share = most / s->data->max_force;
    if (!worst || share < least_fall)
        return;
    const double seconds = rows[worst->end - 1].t - rows[worst->first].t;
    const double at = rows[worst->first].deflection / WB_MM;
    if (s->fit->law.n_maxwell > 0)
        say_of(remarks, WB_CHECK_NOTE, s->info,
               "the force falls by %.1f %% of the largest in %.1f s while nothing moves, at a "
               "deflection of %.1f mm: the wire relaxes, and Maxwell elements beside the law "
               "follow it; moments are those at the test's speed",
               100.0 * share, seconds, at);
    else
        say_of(remarks, share >= doubted_fall ? WB_CHECK_DOUBT : WB_CHECK_NOTE, s->info,
               "the force falls by %.1f %% of the largest in %.1f s while nothing moves, at a "
               "deflection of %.1f mm: the wire relaxes, and the law does not. The stiffness "
               "during unloading and EI come out too high, moments too low; record with a dwell at "
               "the turn (--dwell-s), from which relaxation is fitted",
               100.0 * share, seconds, at);
}

enum wb_status wb_cycle_check_run(struct wb_cycle_remarks *remarks,
                                  const struct wb_cycle_calibration *calibration,
                                  const struct wb_dataset *const *datasets)
{
    const char *const wire = calibration->members[0].data.info.wire;
    if (!calibration->has_unloading)
        say(remarks, WB_CHECK_NOTE, 0,
            "wire '%s': there is no unloading in the data of all specimens: the hardening rule is "
            "untested and EI known poorly; record the return to zero force too",
            wire);
    const int n = calibration->n_members;
    struct specimen *const specimens = wb_memory_new((size_t)n, sizeof *specimens);
    enum wb_status status = WB_OK;
    int n_zeros = 0; /* number of remarks on the zeros of single specimens */
    for (int i = 0; i < n && status == WB_OK; i++) {
        const struct wb_cycle_member *const member = &calibration->members[i];
        struct specimen *const specimen = &specimens[i];
        *specimen = (struct specimen){
            .info = &member->data.info,
            .member = member,
            .data = &member->data,
            .dataset = datasets[i],
            .fit = &member->answers[calibration->chosen].fit,
            .relaxation_prior = calibration->relaxation_prior,
        };
        find_shared(specimen);
        check_travel(remarks, specimen);
        check_holds(remarks, specimen);
        check_relaxation(remarks, specimen);
        check_natural_shape(remarks, specimen);
        const int before = remarks->n;
        status = check_zeros(remarks, specimen, is_length_seen(datasets[i]));
        for (int k = before; k < remarks->n; k++)
            n_zeros += remarks->items[k].severity == WB_CHECK_DOUBT;
        check_outliers(remarks, specimen);
    }
    if (status == WB_OK && n_zeros == 0)
        check_zeros_of_all(remarks, specimens, n);
    check_others(remarks, calibration);
    check_batches(remarks, calibration);
    free(specimens);
    return status;
}

enum wb_status wb_cycle_check_calibrate(struct wb_cycle_calibration *calibration,
                                        struct wb_cycle_remarks *remarks,
                                        const struct wb_dataset *const *datasets, int n,
                                        const struct wb_cycle_calibrate_settings *settings,
                                        struct wb_reason *why)
{
    *remarks = (struct wb_cycle_remarks){.n = 0};
    *calibration = (struct wb_cycle_calibration){.n_members = 0};
    wb_cycle_check_data(remarks, datasets, n);
    WB_TRY(wb_cycle_check_refuse(remarks, why));
    WB_TRY(wb_cycle_calibrate_run(calibration, datasets, n, settings, why));
    enum wb_status status = wb_cycle_check_run(remarks, calibration, datasets);
    if (status == WB_OK)
        status = wb_cycle_check_refuse(remarks, why);
    if (status != WB_OK)
        wb_cycle_calibrate_release(calibration);
    return status;
}

void wb_cycle_check_put(struct wb_json *array, const struct wb_cycle_remarks *remarks)
{
    for (int i = 0; i < remarks->n; i++) {
        const struct wb_cycle_remark *const remark = &remarks->items[i];
        struct wb_json *const item = wb_json_append_object(array);
        wb_json_set_text(item, "severity", wb_cycle_check_severity_name(remark->severity));
        wb_json_set_number(item, "sample", remark->sample > 0 ? remark->sample : (double)NAN);
        wb_json_set_text(item, "text", remark->text);
    }
}
