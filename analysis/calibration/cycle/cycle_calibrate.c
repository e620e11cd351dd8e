#include "analysis/calibration/cycle/cycle_calibrate.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_errno.h>

#include "analysis/calibration/cycle/cycle_budget.h"
#include "analysis/calibration/cycle/cycle_hold.h"
#include "analysis/calibration/paper/first_guess.h"
#include "base/memory.h"
#include "base/progress.h"
#include "base/units.h"
#include "base/workers.h"

#define WB_LOG_DOMAIN "calibrate"

const double wb_cycle_moment_parts[WB_CYCLE_MOMENTS] = {0.05, 0.1, 0.3, 0.6, 1.0};

const double wb_cycle_stiffness_curvatures[WB_CYCLE_STIFFNESSES - 1] = {0.5, 1.0, 2.0};

/* EI is resolved if a stiffness at the smallest curvature of the data is within this part of it. */
static const double resolved_within = 0.02;
/* Least curvature, 1/m, of a stiffness. */
static const double least_curvature = 0.05;
/* Deflection over length at which eqs. 10 and 11 give the initial guess of all fits. */
static const double elastic_zone = 0.05;
/* Range of deflection over length, beyond elastic_zone, of the slope past yield, and the smallest
 * exponent of the initial guess. */
static const double slope_zone = 0.03, smallest_first_exponent = 0.05;
/* Chaboche's laws are fitted if the best misfit of the others exceeds this part of F_max and this
 * many times the repeat noise. */
static const double follows_up_to = 1e-3, follows_noise = 2.0;
/* Candidates count in the ranges up to this many times the best misfit. */
static const double counts_up_to = 2.0;
/* Smaller weights are set to zero. */
static const double least_weight = 1e-6;
/* Confidence of the number of specimens that EI needs. */
static const double coverage = 0.95;
/* Largest standard errors of ln K and n at which K and n are reported. */
static const double largest_ln_strength_error = 0.10, largest_exponent_error = 0.03;
static const double wanted_precision = 0.05;

enum {
    MOST_THREADS = 16,
    MOST_SPECIMENS_NEEDED = 1000
};

static const struct wb_setting rows[] = {
    {WB_ROW_NUMBER(wb_cycle_calibrate_settings, pooled_deviation, "pooled_deviation", 1e-4, 1.0,
                   0.0),
     WB_ROW_OPTION("pooled-deviation", "S",
                   "Standard deviation of ln(EI) between specimens, pooled over several wires"),
     .otherwise = "of these specimens"},
    {WB_ROW_INTEGER(wb_cycle_calibrate_settings, pooled_degrees, "pooled_degrees", 1, 100000, 0),
     WB_ROW_OPTION("pooled-degrees", "N", "Degrees of freedom of --pooled-deviation"),
     .otherwise = "none"},
    {WB_ROW_QUANTITY(wb_cycle_calibrate_settings, at_most, "at_most_percent", "%", WB_PERCENT, 0.01,
                     1000.0, 0.0),
     WB_ROW_OPTION("at-most", "P",
                   "Exit with 3 if the 95 % uncertainty of a moment, of the unloading stiffness "
                   "above 1 /m or of the residual curvature ratio exceeds this part of its value"),
     .otherwise = "any"},
    {WB_ROW_INTEGER(wb_cycle_calibrate_settings, threads, "threads", 1, MOST_THREADS, 0),
     WB_ROW_OPTION("threads", "N", "Threads"), .otherwise = "as many as processors"},
};

const struct wb_setting_table wb_cycle_calibrate_tables[WB_CYCLE_CALIBRATE_TABLES] = {
    {.rows = wb_cycle_fit_rows,
     .n = WB_CYCLE_FIT_ROWS,
     .offset = offsetof(struct wb_cycle_calibrate_settings, fit)},
    {.rows = wb_cycle_data_rows,
     .n = WB_CYCLE_DATA_ROWS,
     .offset = offsetof(struct wb_cycle_calibrate_settings, data)},
    {WB_SETTING_ROWS(rows)},
};

void wb_cycle_calibrate_default_settings(struct wb_cycle_calibrate_settings *settings)
{
    *settings = (struct wb_cycle_calibrate_settings){.threads = 0};
    wb_cycle_fit_default_settings(&settings->fit);
    for (int t = 1; t < WB_CYCLE_CALIBRATE_TABLES; t++)
        wb_setting_fill(&wb_cycle_calibrate_tables[t],
                        (char *)settings + wb_cycle_calibrate_tables[t].offset);
}

void wb_cycle_calibrate_settings_text(const struct wb_cycle_calibrate_settings *settings,
                                      struct wb_text *text)
{
    for (int t = 0; t < WB_CYCLE_CALIBRATE_TABLES; t++) {
        const struct wb_setting_table *const table = &wb_cycle_calibrate_tables[t];
        for (size_t i = 0; i < table->n; i++) {
            const struct wb_setting *const row = &table->rows[i];
            const char *const at = (const char *)settings + table->offset;
            char value[WB_SETTING_VALUE];
            wb_setting_format(row, at, value);
            wb_text_append(text, "%s%s %s", t + (int)i > 0 ? ", " : "", row->name,
                           row->otherwise && !wb_setting_is_given(row, at) ? row->otherwise
                                                                           : value);
        }
    }
}

/* --- one specimen --- */

/* Tension of the loading relative to that at zero deflection, in the middle of a range of
 * deflections: by a line through its points in this range, at least three if the data have them.
 * *slope: N/m. */
static double loading_line(const struct wb_cycle_data *data, double from, double to, double *slope)
{
    int begin = 0, end = data->n_loading;
    while (begin < end - 3 && data->points[begin].deflection < from)
        begin++;
    while (end > begin + 3 && data->points[end - 1].deflection > to)
        end--;
    double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
    for (int i = begin; i < end; i++) {
        x += data->points[i].deflection / (end - begin);
        y += (data->points[i].tension - data->zero_tension) / (end - begin);
    }
    for (int i = begin; i < end; i++) {
        const double dx = data->points[i].deflection - x;
        xx += dx * dx;
        xy += dx * (data->points[i].tension - data->zero_tension - y);
    }
    *slope = xy / xx;
    return y + *slope * (0.5 * (from + to) - x);
}

/* Initial guess of the law: the closed forms of the paper on the points, which contain no outliers.
 * It is never rejected; the fit improves a poor one. */
static void initial_law(const struct wb_cycle_data *data, struct wb_law *law)
{
    const double length = data->info.length, diameter = data->info.outer_diameter;
    const double at = fmin(elastic_zone * length, 0.7 * data->top);
    double slope;
    double force = loading_line(data, 0.75 * at, 1.25 * at, &slope);
    if (!(force > 0.0))
        force = data->max_force * at / data->top;
    (void)loading_line(data, at, at + slope_zone * length, &slope);
    const double E = wb_first_guess_modulus(force, at, length, diameter);
    const double yield = wb_first_guess_stress(force, length, diameter);
    const double tangent = wb_first_guess_stress(slope, length, diameter) /
                           wb_first_guess_strain(1.0, length, diameter);
    const double n = fmin(fmax(tangent / E, smallest_first_exponent), 1.0);
    const struct wb_material material = {
        .hardening = WB_HARDENING_ISOTROPIC_POWER,
        .youngs_modulus = E,
        .poissons_ratio = data->info.poissons_ratio,
        .yield_stress = yield,
        .strength_coefficient = wb_first_guess_strength(E, yield, n),
        .hardening_exponent = n,
    };
    wb_law_init_ludwik(law, &material);
}

/* Strain of the outer fibre of a straight, elastic wire at the deflection between the first two
 * points. Parts that yield at smaller strains affect a single point. */
static double first_strain(const struct wb_cycle_data *data)
{
    const double length = data->info.length;
    const double deflection = 0.5 * (data->points[0].deflection + data->points[1].deflection);
    return 1.5 * data->info.outer_diameter * deflection / (length * length);
}

static double best_misfit(const struct wb_cycle_member *member)
{
    double best = (double)INFINITY;
    for (int c = 0; c < WB_CANDIDATES; c++) {
        if (member->answers[c].is_fitted)
            best = fmin(best, member->answers[c].fit.misfit);
    }
    return best;
}

static const struct wb_cycle_fit *fit_of(const struct wb_cycle_member *member,
                                         enum wb_candidate candidate)
{
    const struct wb_cycle_answer *const answer = &member->answers[candidate];
    return answer->is_fitted ? &answer->fit : NULL;
}

/* The better of two fits (NULL: none): a converged one, then the one of smaller misfit. */
static const struct wb_cycle_fit *better(const struct wb_cycle_fit *one,
                                         const struct wb_cycle_fit *other)
{
    if (!one || !other)
        return one ? one : other;
    if (one->is_converged != other->is_converged)
        return one->is_converged ? one : other;
    return one->misfit <= other->misfit ? one : other;
}

/* Rewrites a law in the form of a candidate that contains it: a yield surface that does not move,
 * parts whose limits do not grow, or two equal backstresses in place of one. */
static void contain(enum wb_candidate candidate, struct wb_law *law)
{
    if (candidate == WB_CANDIDATE_LUDWIK_COMBINED || candidate == WB_CANDIDATE_PARALLEL_COMBINED)
        law->is_combined = true;
    if (candidate != WB_CANDIDATE_CHABOCHE_TWO)
        return;
    law->backs[0].modulus *= 0.5;
    law->backs[law->n_backs++] = law->backs[0];
}

/* The specimen that is fitted, and what all its fits share. */
struct fitting {
    struct wb_cycle_member *member;
    const struct wb_cycle_grid *grid;
    const struct wb_cycle_calibrate_settings *settings;
};

/* Replaces the fit of a candidate by that of a law that it contains, if that is better: with the
 * share at the end of its range, or with two equal backstresses. Priors, or a search that stopped
 * early, may have prevented the candidate's own fit from reaching it. A mixed law has no exponent
 * above 1. The contained fit is final: the answer refers to it. */
static void take_contained(const struct fitting *f, enum wb_candidate candidate,
                           const struct wb_cycle_fit *contained)
{
    struct wb_cycle_answer *const answer = &f->member->answers[candidate];
    const size_t n = (size_t)f->member->data.n_points;
    if (!contained || f->settings->left_out >> candidate & 1U ||
        (answer->is_fitted && better(&answer->fit, contained) == &answer->fit))
        return;
    if (candidate == WB_CANDIDATE_LUDWIK_MIXED && contained->law.material.hardening_exponent > 1.0)
        return;
    wb_cycle_fit_release(&answer->fit);
    answer->is_fitted = true;
    answer->origin = contained->candidate;
    answer->fit = *contained;
    answer->fit.candidate = candidate;
    answer->fit.search = NULL;
    answer->fit.n_law = wb_candidate_numbers(candidate) + 2 * contained->law.n_maxwell;
    answer->fit.n_free += answer->fit.n_law - contained->n_law;
    answer->fit.is_at_bound = true;
    contain(candidate, &answer->fit.law);
    for (int i = 0; i < answer->fit.n_moved; i++)
        contain(candidate, &answer->fit.moved[i]);
    answer->fit.tension = wb_memory_new(n, sizeof(double));
    memcpy(answer->fit.tension, contained->tension, n * sizeof(double));
}

/* Fits a candidate from the initial guess `start`, and keeps the fit if it is better than the
 * present one. `near` is the fit of that law to the same data (NULL: none). A start that the beam
 * cannot compute leaves the candidate unfitted and returns WB_OK. */
static enum wb_status fit_one(const struct fitting *f, enum wb_candidate candidate,
                              const struct wb_law *start, const struct wb_cycle_fit *near)
{
    struct wb_cycle_member *const member = f->member;
    struct wb_cycle_answer *const answer = &member->answers[candidate];
    struct wb_cycle_fit fit;
    if (f->settings->left_out >> candidate & 1U)
        return WB_OK;
    const enum wb_status status = wb_cycle_fit_run(&fit, &member->data, candidate, start, near,
                                                   f->grid, &f->settings->fit, &member->why);
    if (status == WB_ERR_CONVERGENCE)
        return WB_OK;
    WB_TRY(status);
    if (fit.is_contained) {
        wb_cycle_fit_release(&fit);
        take_contained(f, candidate, near);
    } else if (better(answer->is_fitted ? &answer->fit : NULL, &fit) == &fit) {
        wb_cycle_fit_release(&answer->fit);
        answer->fit = fit;
        answer->origin = candidate;
        answer->is_fitted = true;
    } else {
        wb_cycle_fit_release(&fit);
    }
    return WB_OK;
}

/* The same from the law of another specimen (NULL: none), which is a better guess than that of
 * `near`. */
static enum wb_status fit_from_specimen(const struct fitting *f,
                                        const struct wb_cycle_member *first,
                                        enum wb_candidate candidate,
                                        const struct wb_cycle_fit *near)
{
    const struct wb_cycle_fit *const known = first ? fit_of(first, candidate) : NULL;
    if (known)
        WB_TRY(fit_one(f, candidate, &known->law, near));
    const struct wb_cycle_fit *const found = fit_of(f->member, candidate);
    return found && found->is_converged ? WB_OK : fit_one(f, candidate, &near->law, near);
}

/* The same from the better of two fits (NULL: none); if the result is worse than the other fit,
 * also from that one. */
static enum wb_status fit_from(const struct fitting *f, const struct wb_cycle_member *first,
                               enum wb_candidate candidate, const struct wb_cycle_fit *one,
                               const struct wb_cycle_fit *other)
{
    const struct wb_cycle_fit *const near = better(one, other);
    const struct wb_cycle_fit *const second = near == one ? other : one;
    if (near)
        WB_TRY(fit_from_specimen(f, first, candidate, near));
    const bool is_worse = second && better(second, fit_of(f->member, candidate)) == second;
    return is_worse ? fit_one(f, candidate, &second->law, second) : WB_OK;
}

static const struct wb_cycle_fit *best_ludwik(const struct wb_cycle_member *member)
{
    const struct wb_cycle_fit *best = NULL;
    for (int c = WB_CANDIDATE_LUDWIK_ISOTROPIC; c <= WB_CANDIDATE_LUDWIK_MIXED; c++)
        best = better(best, fit_of(member, c));
    return better(best, fit_of(member, WB_CANDIDATE_LUDWIK_COMBINED));
}

static bool has_unloading(const struct wb_cycle_member *member)
{
    return member->data.n_loading < member->data.n_points;
}

/* Fits Ludwik's candidates. Most wires are closer to the kinematic one, which is a better initial
 * guess of the isotropic one than the closed forms. */
static enum wb_status fit_ludwiks(const struct fitting *f)
{
    struct wb_cycle_member *const member = f->member;
    struct wb_law start;
    initial_law(&member->data, &start);
    if (!has_unloading(member))
        return fit_one(f, WB_CANDIDATE_LUDWIK_ISOTROPIC, &start, NULL);
    WB_TRY(fit_one(f, WB_CANDIDATE_LUDWIK_KINEMATIC, &start, NULL));
    const struct wb_cycle_fit *const kinematic = fit_of(member, WB_CANDIDATE_LUDWIK_KINEMATIC);
    WB_TRY(
        fit_one(f, WB_CANDIDATE_LUDWIK_ISOTROPIC, kinematic ? &kinematic->law : &start, kinematic));
    const struct wb_cycle_fit *const isotropic = fit_of(member, WB_CANDIDATE_LUDWIK_ISOTROPIC);
    if (!isotropic && !kinematic) {
        WB_TRY(fit_one(f, WB_CANDIDATE_LUDWIK_MIXED, &start, NULL));
        return fit_one(f, WB_CANDIDATE_LUDWIK_COMBINED, &start, NULL);
    }
    WB_TRY(fit_from(f, NULL, WB_CANDIDATE_LUDWIK_MIXED, isotropic, kinematic));
    take_contained(f, WB_CANDIDATE_LUDWIK_MIXED, isotropic);
    take_contained(f, WB_CANDIDATE_LUDWIK_MIXED, kinematic);
    WB_TRY(fit_from(f, NULL, WB_CANDIDATE_LUDWIK_COMBINED, isotropic, kinematic));
    take_contained(f, WB_CANDIDATE_LUDWIK_COMBINED, isotropic);
    return WB_OK;
}

static enum wb_status fit_parallels(const struct fitting *f, const struct wb_cycle_member *first)
{
    const struct wb_cycle_fit *const near = best_ludwik(f->member);
    if (!near)
        return WB_OK;
    WB_TRY(fit_from_specimen(f, first, WB_CANDIDATE_PARALLEL_KINEMATIC, near));
    const struct wb_cycle_fit *const pure = fit_of(f->member, WB_CANDIDATE_PARALLEL_KINEMATIC);
    WB_TRY(fit_from(f, NULL, WB_CANDIDATE_PARALLEL_MIXED, pure, near));
    take_contained(f, WB_CANDIDATE_PARALLEL_MIXED, pure);
    WB_TRY(fit_from(f, NULL, WB_CANDIDATE_PARALLEL_COMBINED, pure, near));
    take_contained(f, WB_CANDIDATE_PARALLEL_COMBINED, pure);
    return WB_OK;
}

static enum wb_status fit_chaboches(const struct fitting *f, const struct wb_cycle_member *first)
{
    const struct wb_cycle_fit *const near = best_ludwik(f->member);
    if (!near)
        return WB_OK;
    WB_TRY(fit_from_specimen(f, first, WB_CANDIDATE_CHABOCHE_ONE, near));
    const struct wb_cycle_fit *const one = fit_of(f->member, WB_CANDIDATE_CHABOCHE_ONE);
    WB_TRY(fit_from(f, first, WB_CANDIDATE_CHABOCHE_TWO, one, near));
    take_contained(f, WB_CANDIDATE_CHABOCHE_TWO, one);
    return WB_OK;
}

/* Finds the sensitivity of a law to the quantities that all specimens share. */
static void find_sensitivity(struct wb_cycle_member *member, enum wb_candidate candidate)
{
    struct wb_cycle_answer *const answer = &member->answers[candidate];
    const enum wb_candidate origin = answer->origin;
    struct wb_cycle_fit *const fit = &member->answers[origin].fit;
    wb_cycle_fit_find_altered(fit);
    if (origin == candidate)
        return;
    memcpy(answer->fit.altered, fit->altered, sizeof fit->altered);
    memcpy(answer->fit.altered_specimen, fit->altered_specimen, sizeof fit->altered_specimen);
    memcpy(answer->fit.has_altered, fit->has_altered, sizeof fit->has_altered);
    for (int i = 0; i < WB_SHARED; i++) {
        if (fit->has_altered[i])
            contain(candidate, &answer->fit.altered[i]);
    }
}

/* --- specimens side by side --- */

enum stage {
    DATA,
    LUDWIKS,   /* from here on with the Maxwell elements that the dwells of all specimens show */
    PARALLELS, /* from here on with the strains of all specimens */
    CHABOCHES, /* if the other laws leave a misfit */
    SHARED     /* sensitivity of the chosen law to the quantities that all specimens share */
};

struct work {
    struct wb_cycle_calibration *calibration;
    const struct wb_dataset *const *datasets;
    struct wb_cycle_calibrate_settings settings;
    enum stage stage;
    int begin; /* first specimen of the present batch */
    struct wb_cycle_grid grid;
    int done, all;
    bool stopped;
    enum wb_status status; /* the first failure */
};

static enum wb_status fit_member(void *context, int index)
{
    struct work *const work = context;
    const int i = work->begin + index;
    struct wb_cycle_member *const member = &work->calibration->members[i];
    const struct wb_cycle_member *const first = i > 0 ? work->calibration->members : NULL;
    const struct fitting fitting = {member, &work->grid, &work->settings};
    const double begin = wb_progress_thread_cpu();
    enum wb_status status = WB_OK;
    switch (work->stage) {
    case DATA:
        status = wb_cycle_data_take(&member->data, work->datasets[i], &work->settings.data,
                                    &member->why);
        break;
    case LUDWIKS:
        status = fit_ludwiks(&fitting);
        break;
    case PARALLELS:
        status = fit_parallels(&fitting, first);
        break;
    case CHABOCHES:
        status = fit_chaboches(&fitting, first);
        break;
    case SHARED:
        find_sensitivity(member, work->calibration->chosen);
        break;
    }
    member->cpu_s += wb_progress_thread_cpu() - begin;
    return status;
}

static bool finish_member(void *context, int index, enum wb_status status)
{
    struct work *const work = context;
    (void)index;
    const struct wb_cycle_calibrate_settings *const s = &work->settings;
    if (work->status == WB_OK)
        work->status = status;
    if (work->stage == DATA || work->stage == SHARED)
        return true;
    work->done++;
    work->stopped = s->progress && !s->progress(s->progress_context, work->done, work->all);
    return !work->stopped;
}

/* Computes a stage of the specimens from `begin` up to `end`, exclusive. */
static void work_on(struct work *work, int begin, int end)
{
    const struct wb_workers workers = {
        .n = work->stopped && work->stage != SHARED ? 0 : end - begin,
        .n_threads = work->settings.threads,
        .job = fit_member,
        .done = finish_member,
        .context = work,
    };
    work->begin = begin;
    (void)wb_workers_run(&workers);
}

/* Computes a stage of all specimens. In stages of laws with many parameters the first specimen is
 * fitted alone, because the others start from its laws. */
static enum wb_status work_side_by_side(struct work *work, enum stage stage)
{
    const int ahead = stage == PARALLELS || stage == CHABOCHES ? 1 : 0;
    work->stage = stage;
    work_on(work, 0, ahead);
    if (work->status == WB_OK)
        work_on(work, ahead, work->calibration->n_members);
    return work->status;
}

/* Whether unloading was measured for all specimens. */
static bool all_have_unloading(const struct wb_cycle_calibration *calibration)
{
    for (int i = 0; i < calibration->n_members; i++) {
        if (!has_unloading(&calibration->members[i]))
            return false;
    }
    return true;
}

/* Number of Maxwell elements that the dwells show, 0 to 2; 0 if one specimen has no dwell, or if
 * unloading was not measured. */
static int count_elements(const struct wb_cycle_calibration *calibration)
{
    const int n = calibration->n_members;
    int held = 0, seen = 0, two = 0;
    for (int i = 0; i < n; i++) {
        struct wb_cycle_relaxation r;
        wb_cycle_hold_describe(&calibration->members[i].data, &r);
        held += r.duration > 0.0;
        seen += r.is_seen;
        two += r.needs_two;
    }
    if (!all_have_unloading(calibration) || held < n || 2 * seen < n || seen == 0)
        return 0;
    return 2 * two < n || two == 0 ? 1 : 2;
}

/* Reports the reason of the first specimen that failed. */
static enum wb_status report_failure(const struct wb_cycle_calibration *calibration,
                                     enum wb_status status, struct wb_reason *why)
{
    for (int i = 0; i < calibration->n_members; i++) {
        const struct wb_cycle_member *const member = &calibration->members[i];
        if (member->why.text[0] != '\0' && !isfinite(best_misfit(member)))
            return wb_fail_to(why, status, "%s", member->why.text);
    }
    return wb_fail_to(why, status, "the specimens could not be fitted");
}

/* --- results of all specimens --- */

/* The law that was fitted to specimen `i`. */
static const struct wb_law *law_of(const struct wb_cycle_calibration *calibration,
                                   enum wb_candidate candidate, int i)
{
    return &calibration->members[i].answers[candidate].fit.law;
}

static double diameter_of(const struct wb_cycle_calibration *calibration)
{
    return calibration->members[0].data.info.outer_diameter;
}

static struct wb_cycle_grid find_grid(const struct wb_cycle_calibration *calibration)
{
    struct wb_cycle_grid grid = {(double)INFINITY, 0.0};
    for (int i = 0; i < calibration->n_members; i++) {
        const struct wb_cycle_member *const member = &calibration->members[i];
        const struct wb_cycle_fit *const fit = best_ludwik(member);
        grid.first_strain = fmin(grid.first_strain, first_strain(&member->data));
        if (fit)
            grid.last_strain =
                fmax(grid.last_strain, 0.5 * diameter_of(calibration) * fit->clamp_curvature);
    }
    /* A short test keeps a distance between the two. */
    grid.last_strain = fmax(grid.last_strain, 5.0 * grid.first_strain);
    return grid;
}

static void find_repeat_noise(struct wb_cycle_calibration *calibration)
{
    double sum = 0.0;
    int n = 0;
    for (int i = 0; i < calibration->n_members; i++) {
        const struct wb_cycle_data *const data = &calibration->members[i].data;
        for (int k = 0; k < data->n_points; k++) {
            const double d = data->points[k].deviation / data->max_force;
            sum += d * d;
            n++;
        }
    }
    calibration->repeat_noise = sqrt(sum / n);
}

/* A search whose iterations ran out counts as a fit only with `unfinished`, if no other fit exists.
 */
static void pool_misfit(const struct wb_cycle_calibration *calibration, bool unfinished,
                        struct wb_cycle_rank *rank)
{
    double sum = 0.0;
    int n = 0;
    rank->is_fitted = true;
    for (int i = 0; i < calibration->n_members; i++) {
        const struct wb_cycle_member *const member = &calibration->members[i];
        const struct wb_cycle_answer *const answer = &member->answers[rank->candidate];
        if (!answer->is_fitted || !(answer->fit.is_converged || unfinished)) {
            rank->is_fitted = false;
            return;
        }
        sum += member->data.n_points * answer->fit.misfit * answer->fit.misfit;
        n += member->data.n_points;
        rank->n_free = answer->fit.n_law;
    }
    rank->misfit = sqrt(sum / n);
}

static int by_misfit(const void *a, const void *b)
{
    const struct wb_cycle_rank *const x = a, *const y = b;
    if (x->is_fitted != y->is_fitted)
        return x->is_fitted ? -1 : 1;
    if (x->misfit != y->misfit)
        return x->misfit > y->misfit ? 1 : -1;
    return (int)x->candidate - (int)y->candidate; /* the simpler of two equal ones first */
}

/* Number of independent residuals of a specimen: with a lag-1 correlation r, n residuals count as n
 * (1 - r) / (1 + r). More specimens do not add to it, because the misfit of a law is the same in
 * all of them. */
static double count_independent(const struct wb_cycle_calibration *calibration,
                                enum wb_candidate candidate)
{
    double squares = 0.0, products = 0.0, points = 0.0;
    for (int i = 0; i < calibration->n_members; i++) {
        const struct wb_cycle_data *const data = &calibration->members[i].data;
        const double *const tension = calibration->members[i].answers[candidate].fit.tension;
        points += (double)data->n_points / calibration->n_members;
        for (int k = 0; k < data->n_points; k++) {
            const double r = tension[k] - data->points[k].tension;
            squares += r * r;
            if (k > 0 && k != data->n_loading)
                products += r * (tension[k - 1] - data->points[k - 1].tension);
        }
    }
    const double r = squares > 0.0 ? fmin(fmax(products / squares, 0.0), 0.99) : 0.0;
    return fmax(points * (1.0 - r) / (1.0 + r), 2.0);
}

/* Weights the candidates by Schwarz's criterion (1978), from misfit and number of parameters. */
static void weigh(struct wb_cycle_calibration *calibration)
{
    const struct wb_cycle_rank *const best = &calibration->ranked[0];
    const double n = count_independent(calibration, best->candidate);
    double least = (double)INFINITY, sum = 0.0;
    for (int i = 0; i < calibration->n_ranked; i++) {
        struct wb_cycle_rank *const rank = &calibration->ranked[i];
        rank->weight = 2.0 * n * log(rank->misfit / best->misfit) + rank->n_free * log(n);
        least = fmin(least, rank->weight);
    }
    for (int i = 0; i < calibration->n_ranked; i++)
        sum += exp(0.5 * (least - calibration->ranked[i].weight));
    for (int i = 0; i < calibration->n_ranked; i++) {
        struct wb_cycle_rank *const rank = &calibration->ranked[i];
        const double weight = exp(0.5 * (least - rank->weight)) / sum;
        rank->weight = weight < least_weight ? 0.0 : weight;
    }
    calibration->n_independent = n;
}

/* Ranks the candidates by misfit and chooses the one of the largest weight. */
static void choose(struct wb_cycle_calibration *calibration)
{
    find_repeat_noise(calibration);
    calibration->n_ranked = 0;
    for (int unfinished = 0; unfinished < 2 && calibration->n_ranked == 0; unfinished++) {
        for (int c = 0; c < WB_CANDIDATES; c++) {
            struct wb_cycle_rank *const rank = &calibration->ranked[c];
            *rank = (struct wb_cycle_rank){.candidate = c};
            pool_misfit(calibration, unfinished, rank);
            calibration->n_ranked += rank->is_fitted;
        }
    }
    qsort(calibration->ranked, WB_CANDIDATES, sizeof calibration->ranked[0], by_misfit);
    if (calibration->n_ranked == 0)
        return;
    weigh(calibration);
    const struct wb_cycle_rank *const best = &calibration->ranked[0];
    const struct wb_cycle_rank *chosen = best;
    for (int i = 0; i < calibration->n_ranked; i++) {
        struct wb_cycle_rank *const rank = &calibration->ranked[i];
        rank->counts = rank->misfit <= counts_up_to * best->misfit;
        if (rank->weight > chosen->weight)
            chosen = rank;
    }
    calibration->chosen = chosen->candidate;
    for (int i = 0; i < calibration->n_ranked; i++)
        calibration->ranked[i].counts |= &calibration->ranked[i] == chosen;
    calibration->is_followed = calibration->has_unloading && !calibration->is_stopped &&
                               best->misfit <= WB_CYCLE_LARGEST_FOLLOWED;
}

/* Whether Chaboche's laws are worth their time. A good fit of combined parallel parts is ignored:
 * where all other laws fit less well, Chaboche's laws show how much the results depend on the form
 * of the law. */
static bool chaboche_is_needed(const struct wb_cycle_calibration *calibration)
{
    double best = (double)INFINITY;
    for (int i = 0; i < calibration->n_ranked; i++) {
        if (calibration->ranked[i].candidate != WB_CANDIDATE_PARALLEL_COMBINED)
            best = fmin(best, calibration->ranked[i].misfit);
    }
    return isfinite(best) && best > fmax(follows_up_to, follows_noise * calibration->repeat_noise);
}

/* Results of a law at the mean strain rate of the specimens; `value` is indexed by enum
 * wb_cycle_number. */
static enum wb_status describe_law(const struct wb_cycle_calibration *calibration,
                                   const struct wb_law *fitted, double *value)
{
    struct wb_law law = *fitted;
    const struct wb_cycle_stiffness *const s = &calibration->secant;
    const struct wb_cycle_stiffness *const u = &calibration->unloading;
    const double diameter = diameter_of(calibration), largest = calibration->largest_curvature;
    struct wb_bending bending;
    if (calibration->strain_rate > 0.0)
        law.strain_rate = calibration->strain_rate;
    WB_TRY(wb_bending_describe(&law, diameter, largest, &bending));
    value[WB_CYCLE_RIGIDITY] = bending.flexural_rigidity;
    value[WB_CYCLE_RESIDUAL_CURVATURE] = bending.residual_curvature_ratio;
    value[WB_CYCLE_LOOP_ENERGY] = bending.loop_energy;
    WB_TRY(wb_bending_springback(&law, diameter, calibration->mean_length, largest,
                                 &value[WB_CYCLE_SPRINGBACK]));
    WB_TRY(wb_bending_moments(&law, diameter, WB_CYCLE_MOMENTS, calibration->curvature,
                              value + WB_CYCLE_FIRST_MOMENT));
    return wb_bending_stiffness(&law, diameter, largest, s->n, s->curvature,
                                value + WB_CYCLE_FIRST_SECANT, u->n, u->curvature,
                                value + WB_CYCLE_FIRST_UNLOADING);
}

/* Standard errors of the logarithms of an answer, from the results of the moved laws. */
static enum wb_status find_answer_errors(struct wb_cycle_answer *answer,
                                         const struct wb_cycle_calibration *calibration)
{
    double moved[WB_CYCLE_NUMBERS] = {0.0};
    for (int i = 0; i < answer->fit.n_moved; i++) {
        WB_TRY(describe_law(calibration, &answer->fit.moved[i], moved));
        for (int k = 0; k < WB_CYCLE_NUMBERS; k++) {
            if (answer->value[k] > 0.0)
                answer->error[k] +=
                    pow((moved[k] / answer->value[k] - 1.0) / answer->fit.moved_by[i], 2.0);
        }
    }
    const bool is_known = answer->fit.n_moved > 0;
    for (int k = 0; k < WB_CYCLE_NUMBERS; k++)
        answer->error[k] = is_known ? sqrt(answer->error[k]) : (double)NAN;
    return WB_OK;
}

/* Sensitivities of the logarithms to the quantities that all specimens share. The weight grows with
 * the square of the diameter, so its sensitivity is twice that to the density. */
static enum wb_status find_answer_effects(struct wb_cycle_answer *answer,
                                          const struct wb_cycle_data *data,
                                          const struct wb_cycle_calibration *calibration)
{
    double altered[WB_CYCLE_NUMBERS] = {0.0};
    for (int i = 0; i < WB_SHARED; i++) {
        const bool is_there = wb_cycle_shared_applies(data, i);
        for (int k = 0; k < WB_CYCLE_NUMBERS && is_there; k++)
            answer->effect[i][k] = (double)NAN;
        if (!answer->fit.has_altered[i])
            continue;
        WB_TRY(describe_law(calibration, &answer->fit.altered[i], altered));
        for (int k = 0; k < WB_CYCLE_NUMBERS; k++) {
            if (answer->value[k] > 0.0)
                answer->effect[i][k] =
                    (altered[k] / answer->value[k] - 1.0) / wb_cycle_shared_change(i);
        }
    }
    for (int k = 0; k < WB_CYCLE_NUMBERS; k++)
        answer->effect[WB_SHARED_DIAMETER][k] = 2.0 * answer->effect[WB_SHARED_DENSITY][k];
    return WB_OK;
}

static bool candidate_counts(const struct wb_cycle_calibration *calibration,
                             enum wb_candidate candidate)
{
    for (int i = 0; i < calibration->n_ranked; i++) {
        if (calibration->ranked[i].candidate == candidate)
            return calibration->ranked[i].counts;
    }
    return false;
}

/* Chooses the stated curvatures within the range of the data, and the smallest resolved one. */
static void choose_curvatures(struct wb_cycle_stiffness *stiffness, double resolved, double largest)
{
    bool is_in = false;
    stiffness->n = 0;
    stiffness->resolved = fmin(resolved, largest);
    for (int k = 0; k < WB_CYCLE_STIFFNESSES - 1; k++) {
        const double curvature = wb_cycle_stiffness_curvatures[k];
        if (!is_in && stiffness->resolved < curvature)
            stiffness->curvature[stiffness->n++] = stiffness->resolved;
        is_in = is_in || stiffness->resolved <= curvature;
        if (curvature <= largest)
            stiffness->curvature[stiffness->n++] = curvature;
    }
    if (!is_in)
        stiffness->curvature[stiffness->n++] = stiffness->resolved;
}

static bool is_near_resolved(const struct wb_cycle_stiffness *stiffness, double rigidity)
{
    const int k = wb_cycle_stiffness_resolved(stiffness);
    return fabs(stiffness->estimate[k].value / rigidity - 1.0) <= resolved_within;
}

static enum wb_status describe_answers(struct wb_cycle_calibration *calibration)
{
    double first = least_curvature, change = least_curvature;

    calibration->largest_curvature = (double)INFINITY;
    calibration->strain_rate = calibration->mean_length = 0.0;
    for (int i = 0; i < calibration->n_members; i++) {
        const struct wb_cycle_answer *const answer =
            &calibration->members[i].answers[calibration->chosen];
        calibration->largest_curvature =
            fmin(calibration->largest_curvature, answer->fit.clamp_curvature);
        calibration->mean_length +=
            calibration->members[i].data.info.length / calibration->n_members;
        calibration->strain_rate += answer->fit.law.strain_rate / calibration->n_members;
        first = fmax(first, answer->fit.first_curvature);
        change = fmax(change, answer->fit.turn_change);
    }
    choose_curvatures(&calibration->secant, first, calibration->largest_curvature);
    if (calibration->has_unloading)
        choose_curvatures(&calibration->unloading, change, calibration->largest_curvature);
    for (int k = 0; k < WB_CYCLE_MOMENTS; k++)
        calibration->curvature[k] = wb_cycle_moment_parts[k] * calibration->largest_curvature;
    for (int i = 0; i < calibration->n_members; i++) {
        for (int c = 0; c < WB_CANDIDATES; c++) {
            struct wb_cycle_answer *const answer = &calibration->members[i].answers[c];
            if (!answer->is_fitted)
                continue;
            WB_TRY(describe_law(calibration, &answer->fit.law, answer->value));
            if (candidate_counts(calibration, c))
                WB_TRY(find_answer_errors(answer, calibration));
            if (c == (int)calibration->chosen)
                WB_TRY(find_answer_effects(answer, &calibration->members[i].data, calibration));
        }
    }
    return WB_OK;
}

/* Means of the stresses that the specimens harden by, and of the logarithms of the rates, each as
 * its stress counts: a rate of next to no stress says nothing. */
static void average_chaboche(const struct wb_cycle_calibration *calibration,
                             enum wb_candidate candidate, struct wb_law *average)
{
    const int n = calibration->n_members;
    const struct wb_law *const first = law_of(calibration, candidate, 0);
    struct wb_material material = first->material;
    double E = 0.0, yield = 0.0, saturation = 0.0, rate = 0.0;
    double stress[WB_LAW_MOST_BACKS] = {0.0}, recovery[WB_LAW_MOST_BACKS] = {0.0};
    for (int i = 0; i < n; i++) {
        const struct wb_law *const law = law_of(calibration, candidate, i);
        /* The fast back stress of one with the fast ones of the others. */
        const bool is_turned = law->n_backs > 1 && law->backs[0].recovery < law->backs[1].recovery;
        E += log(law->material.youngs_modulus) / n;
        yield += law->material.yield_stress / n;
        saturation += law->saturation / n;
        rate += law->saturation * log(law->rate) / n;
        for (int k = 0; k < law->n_backs; k++) {
            const struct wb_law_back *const back = &law->backs[is_turned ? 1 - k : k];
            const double end = back->modulus / back->recovery;
            stress[k] += end / n;
            recovery[k] += end * log(back->recovery) / n;
        }
    }
    struct wb_law_back backs[WB_LAW_MOST_BACKS];
    for (int k = 0; k < first->n_backs; k++) {
        const double gamma = exp(recovery[k] / stress[k]);
        backs[k] = (struct wb_law_back){stress[k] * gamma, gamma};
    }
    material.youngs_modulus = exp(E);
    material.yield_stress = yield;
    wb_law_init_chaboche(average, &material, saturation, exp(rate / saturation), backs,
                         first->n_backs);
}

/* Means of the moduli, and of the logarithms of the times, each as its modulus counts. */
static void average_maxwell(const struct wb_cycle_calibration *calibration,
                            enum wb_candidate candidate, struct wb_law *average)
{
    const int n = calibration->n_members;
    average->n_maxwell = law_of(calibration, candidate, 0)->n_maxwell;
    average->strain_rate = average->n_maxwell > 0 ? calibration->strain_rate : 0.0;
    for (int k = 0; k < average->n_maxwell; k++) {
        double modulus = 0.0, time = 0.0;
        for (int i = 0; i < n; i++) {
            const struct wb_law *const law = law_of(calibration, candidate, i);
            modulus += law->maxwell[k].modulus / n;
            time += law->maxwell[k].modulus * log(law->maxwell[k].time) / n;
        }
        average->maxwell[k] = (struct wb_law_maxwell){modulus, exp(time / modulus)};
    }
}

/* Law of the product, without Maxwell elements. Moduli of parallel parts are averaged, so that the
 * product carries the mean moment of the specimens; the mean of the logarithms would lose a part
 * that is small in one specimen. Parameters of Ludwik's law are averaged by their logarithms. */
static void average_relaxed(const struct wb_cycle_calibration *calibration,
                            enum wb_candidate candidate, struct wb_law *average)
{
    const int n = calibration->n_members;
    const struct wb_law *const first = law_of(calibration, candidate, 0);
    double share = 0.0, E = 0.0, yield = 0.0, hardening = 0.0, exponent = 0.0;
    double moduli[WB_LAW_MOST_PARTS] = {0.0}, yielding = 0.0, kept = 0.0;
    const double plastic = WB_BENDING_PLASTIC_STRAIN;

    for (int i = 0; i < n; i++) {
        const struct wb_law *const law = law_of(calibration, candidate, i);
        share += law->isotropic_share / n;
        for (int k = 0; k < law->n_parts; k++) {
            const double modulus = law->parts[k].modulus / n;
            moduli[k] += modulus;
            yielding += isfinite(law->parts[k].yield_strain) ? modulus : 0.0;
            kept += isfinite(law->parts[k].yield_strain) ? law->isotropic_share * modulus : 0.0;
        }
        if (law->form == WB_LAW_LUDWIK) {
            const struct wb_material *const m = &law->material;
            E += log(m->youngs_modulus) / n;
            yield += log(m->yield_stress) / n;
            hardening += log(m->strength_coefficient * pow(plastic, m->hardening_exponent)) / n;
            exponent += log(m->hardening_exponent) / n;
        }
    }
    if (first->form == WB_LAW_CHABOCHE) {
        average_chaboche(calibration, candidate, average);
        return;
    }
    if (first->form == WB_LAW_PARALLEL) {
        struct wb_law_part parts[WB_LAW_MOST_PARTS];
        for (int k = 0; k < first->n_parts; k++)
            parts[k] = (struct wb_law_part){moduli[k], first->parts[k].yield_strain};
        /* The mean of the moduli that yielded parts keep, in combined hardening. */
        wb_law_init_parallel(average, parts, first->n_parts,
                             first->is_combined ? kept / yielding : share,
                             first->material.poissons_ratio);
        average->is_combined = first->is_combined;
        return;
    }
    struct wb_material material = first->material;
    material.youngs_modulus = exp(E);
    material.yield_stress = exp(yield);
    material.hardening_exponent = exp(exponent);
    material.strength_coefficient = exp(hardening) / pow(plastic, material.hardening_exponent);
    wb_law_init_ludwik(average, &material);
    average->isotropic_share = share;
    average->is_combined = first->is_combined;
}

static void average_law(const struct wb_cycle_calibration *calibration, enum wb_candidate candidate,
                        struct wb_law *average)
{
    average_relaxed(calibration, candidate, average);
    average_maxwell(calibration, candidate, average);
}

/* Ludwik's law with the same first loading: of such a law its own parameters. */
static enum wb_status find_equivalent(const struct wb_cycle_calibration *calibration,
                                      const struct wb_law *law, struct wb_material *ludwik,
                                      double *misfit)
{
    *ludwik = law->material;
    *misfit = 0.0;
    return law->form == WB_LAW_LUDWIK
               ? WB_OK
               : wb_bending_ludwik(law, diameter_of(calibration), calibration->largest_curvature,
                                   ludwik, misfit);
}

static enum wb_status find_equivalents(struct wb_cycle_calibration *calibration)
{
    WB_TRY(find_equivalent(calibration, &calibration->law, &calibration->ludwik,
                           &calibration->ludwik_misfit));
    for (int i = 0; i < calibration->n_members; i++) {
        struct wb_cycle_member *const member = &calibration->members[i];
        WB_TRY(find_equivalent(calibration, law_of(calibration, calibration->chosen, i),
                               &member->ludwik, &member->ludwik_misfit));
    }
    return WB_OK;
}

static void judge_identifiability(struct wb_cycle_calibration *calibration)
{
    bool at_bound = false;
    calibration->ln_strength_error = calibration->exponent_error = 0.0;
    calibration->travel_share = (double)INFINITY;
    for (int i = 0; i < calibration->n_members; i++) {
        const struct wb_cycle_member *const member = &calibration->members[i];
        const struct wb_cycle_fit *const fit = &member->answers[calibration->chosen].fit;
        if (!(fit->ln_strength_error <= calibration->ln_strength_error))
            calibration->ln_strength_error = fit->ln_strength_error;
        if (!(fit->exponent_error <= calibration->exponent_error))
            calibration->exponent_error = fit->exponent_error;
        at_bound = at_bound || fit->is_at_bound;
        calibration->travel_share =
            fmin(calibration->travel_share, member->data.top / member->data.info.length);
    }
    const bool enough = calibration->travel_share >= WB_CYCLE_SMALLEST_TRAVEL && !at_bound;
    calibration->is_strength_identifiable =
        enough && calibration->ln_strength_error <= largest_ln_strength_error;
    calibration->is_exponent_identifiable =
        enough && calibration->exponent_error <= largest_exponent_error;
}

/* Number of specimens that makes the interval of EI as narrow as wanted. */
static int specimens_needed(double deviation)
{
    if (!(deviation > 0.0))
        return 0;
    for (int n = 2; n <= MOST_SPECIMENS_NEEDED; n++) {
        if (gsl_cdf_tdist_Qinv(0.5 * (1.0 - coverage), n - 1) * deviation / sqrt(n) <=
            log1p(wanted_precision))
            return n;
    }
    return MOST_SPECIMENS_NEEDED;
}

static struct wb_estimate *estimate_of(struct wb_cycle_calibration *calibration,
                                       enum wb_cycle_number number)
{
    if (number == WB_CYCLE_RIGIDITY)
        return &calibration->rigidity;
    if (number == WB_CYCLE_RESIDUAL_CURVATURE)
        return &calibration->residual_curvature_ratio;
    if (number == WB_CYCLE_LOOP_ENERGY)
        return &calibration->loop_energy;
    if (number == WB_CYCLE_SPRINGBACK)
        return &calibration->springback;
    if (number < WB_CYCLE_FIRST_SECANT)
        return &calibration->moment[number - WB_CYCLE_FIRST_MOMENT];
    return number < WB_CYCLE_FIRST_UNLOADING
               ? &calibration->secant.estimate[number - WB_CYCLE_FIRST_SECANT]
               : &calibration->unloading.estimate[number - WB_CYCLE_FIRST_UNLOADING];
}

static enum wb_status conclude(struct wb_cycle_calibration *calibration,
                               const struct wb_cycle_calibrate_settings *settings)
{
    calibration->relaxation_prior = settings->fit.relaxation_prior;
    calibration->pooled_deviation = settings->pooled_deviation;
    calibration->pooled_degrees = settings->pooled_degrees;
    WB_TRY(describe_answers(calibration));
    for (int k = 0; k < WB_CYCLE_NUMBERS; k++)
        wb_cycle_estimate(calibration, k, estimate_of(calibration, k), &calibration->budget[k]);
    calibration->is_rigidity_resolved =
        is_near_resolved(&calibration->secant, calibration->rigidity.value) ||
        (calibration->has_unloading &&
         is_near_resolved(&calibration->unloading, calibration->rigidity.value));
    for (int i = 0; i < calibration->n_ranked; i++) {
        struct wb_cycle_rank *const rank = &calibration->ranked[i];
        wb_cycle_average(calibration, rank->candidate, WB_CYCLE_RIGIDITY, &rank->rigidity);
        wb_cycle_average(calibration, rank->candidate, WB_CYCLE_RESIDUAL_CURVATURE,
                         &rank->residual_curvature_ratio);
        average_law(calibration, rank->candidate, &rank->law);
    }
    average_law(calibration, calibration->chosen, &calibration->law);
    WB_TRY(find_equivalents(calibration));
    judge_identifiability(calibration);
    calibration->specimens_for_5_percent = specimens_needed(calibration->rigidity.deviation);
    return WB_OK;
}

/* --- checks of the input --- */

static bool is_same_data(const struct wb_dataset *a, const struct wb_dataset *b)
{
    if (a->n_rows != b->n_rows || a->n_rows == 0)
        return false;
    for (size_t i = 0; i < a->n_rows; i++) {
        if (a->rows[i].deflection != b->rows[i].deflection ||
            a->rows[i].tension != b->rows[i].tension)
            return false;
    }
    return true;
}

static enum wb_status check_datasets(const struct wb_dataset *const *datasets, int n,
                                     struct wb_reason *why)
{
    if (n < 1)
        return wb_fail_to(why, WB_ERR_ARGUMENT, "no dataset to calibrate on");
    for (int i = 0; i < n; i++) {
        const struct wb_test_info *const a = &datasets[0]->info, *const b = &datasets[i]->info;
        if (strcmp(a->wire, b->wire) != 0 || a->outer_diameter != b->outer_diameter)
            return wb_fail_to(why, WB_ERR_DATA,
                              "datasets 1 and %d are of wires '%s', %g mm, and '%s', %g mm: "
                              "expected one wire",
                              i + 1, a->wire, a->outer_diameter / WB_MM, b->wire,
                              b->outer_diameter / WB_MM);
        for (int k = 0; k < i; k++) {
            if (is_same_data(datasets[k], datasets[i]))
                return wb_fail_to(why, WB_ERR_DATA,
                                  "datasets %d and %d of wire '%s' hold the same readings: a "
                                  "specimen that is counted twice makes intervals too narrow; "
                                  "leave one out",
                                  k + 1, i + 1, a->wire);
        }
    }
    return WB_OK;
}

static enum wb_status run(struct wb_cycle_calibration *calibration,
                          const struct wb_dataset *const *datasets,
                          const struct wb_cycle_calibrate_settings *settings, struct wb_reason *why)
{
    struct work work = {
        .calibration = calibration,
        .datasets = datasets,
        .settings = *settings,
        .all = (SHARED - LUDWIKS) * calibration->n_members,
        .status = WB_OK,
    };
    enum wb_status status = work_side_by_side(&work, DATA);
    if (status == WB_OK) {
        work.settings.fit.n_maxwell = count_elements(calibration);
        status = work_side_by_side(&work, LUDWIKS);
    }
    if (status != WB_OK)
        return report_failure(calibration, status, why);
    /* Specimens are computed in order; each one that was started is complete. */
    for (int i = work.done; i < calibration->n_members; i++)
        wb_cycle_data_release(&calibration->members[i].data);
    calibration->n_members = work.done;
    calibration->has_unloading = all_have_unloading(calibration);
    work.grid = find_grid(calibration);
    int n_stages = calibration->has_unloading ? 2 : 1;
    if (calibration->has_unloading)
        status = work_side_by_side(&work, PARALLELS);
    choose(calibration);
    if (status == WB_OK && calibration->has_unloading && chaboche_is_needed(calibration)) {
        n_stages = 3;
        status = work_side_by_side(&work, CHABOCHES);
    }
    if (status != WB_OK)
        return report_failure(calibration, status, why);
    calibration->is_stopped = work.done < n_stages * (work.all / (SHARED - LUDWIKS));
    choose(calibration);
    if (calibration->n_ranked == 0)
        return report_failure(calibration, WB_ERR_DATA, why);
    WB_TRY(work_side_by_side(&work, SHARED));
    return conclude(calibration, settings);
}

enum wb_status wb_cycle_calibrate_run(struct wb_cycle_calibration *calibration,
                                      const struct wb_dataset *const *datasets, int n,
                                      const struct wb_cycle_calibrate_settings *settings,
                                      struct wb_reason *why)
{
    *calibration = (struct wb_cycle_calibration){.n_members = n};
    /* GSL's default handler aborts; this code checks the status codes instead. */
    gsl_set_error_handler_off();
    WB_TRY(check_datasets(datasets, n, why));
    calibration->members = wb_memory_new((size_t)n, sizeof *calibration->members);
    for (int i = 0; i < n; i++)
        calibration->members[i].sample = datasets[i]->info.sample;
    const enum wb_status status = run(calibration, datasets, settings, why);
    for (int i = 0; i < n; i++)
        calibration->cpu_s += calibration->members[i].cpu_s;
    if (status != WB_OK)
        wb_cycle_calibrate_release(calibration);
    return status;
}

void wb_cycle_calibrate_release(struct wb_cycle_calibration *calibration)
{
    for (int i = 0; calibration->members && i < calibration->n_members; i++) {
        struct wb_cycle_member *const member = &calibration->members[i];
        wb_cycle_data_release(&member->data);
        for (int c = 0; c < WB_CANDIDATES; c++)
            wb_cycle_fit_release(&member->answers[c].fit);
    }
    free(calibration->members);
    *calibration = (struct wb_cycle_calibration){.members = NULL};
}

const struct wb_estimate *wb_cycle_stiffness_at(const struct wb_cycle_stiffness *stiffness,
                                                double curvature)
{
    for (int k = 0; k < stiffness->n; k++) {
        if (stiffness->curvature[k] == curvature)
            return &stiffness->estimate[k];
    }
    return NULL;
}

double wb_cycle_calibrate_length(const struct wb_cycle_calibration *calibration)
{
    const double length = calibration->members[0].data.info.length;
    for (int i = 1; i < calibration->n_members; i++) {
        if (calibration->members[i].data.info.length != length)
            return (double)NAN;
    }
    return length;
}

bool wb_cycle_calibrate_is_converged(const struct wb_cycle_calibration *calibration)
{
    for (int i = 0; i < calibration->n_members; i++) {
        if (!calibration->members[i].answers[calibration->chosen].fit.is_converged)
            return false;
    }
    return true;
}
