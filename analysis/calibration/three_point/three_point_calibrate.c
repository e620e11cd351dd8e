#include "analysis/calibration/three_point/three_point_calibrate.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_cdf.h>

#include "analysis/calibration/law/bending.h"
#include "base/circle.h"
#include "base/memory.h"
#include "base/units.h"
#include "base/workers.h"

#define WB_LOG_DOMAIN "three-point"

const struct wb_setting_table wb_three_point_calibrate_tables[WB_THREE_POINT_CALIBRATE_TABLES] = {
    {.rows = wb_three_point_data_rows,
     .n = WB_THREE_POINT_DATA_ROWS,
     .offset = offsetof(struct wb_three_point_calibrate_settings, data)},
    {.rows = wb_three_point_fit_rows,
     .n = WB_THREE_POINT_FIT_ROWS,
     .offset = offsetof(struct wb_three_point_calibrate_settings, fit)},
};

static const double coverage = 0.95;
/* Parts of the largest curvature at which the moment is reported. */
static const double parts[WB_THREE_POINT_MOMENTS] = {0.05, 0.1, 0.2, 0.5, 1.0};
/* Ranges if the machine file gives none: friction; nose radius over that of the rollers. */
static const double least_friction = 0.0, most_friction = 0.6;
static const double least_nose = 0.5, most_nose = 2.5;

static enum wb_status check_same(const struct wb_dataset *const *datasets, int n,
                                 struct wb_reason *why)
{
    const struct wb_test_info *const a = &datasets[0]->info;
    for (int i = 1; i < n; i++) {
        const struct wb_test_info *const b = &datasets[i]->info;
        if (strcmp(a->wire, b->wire) != 0 || a->outer_diameter != b->outer_diameter)
            return wb_fail_to(why, WB_ERR_DATA,
                              "tests of wire '%s' of %g mm and of wire '%s' of %g mm: expected one "
                              "wire",
                              a->wire, a->outer_diameter / WB_MM, b->wire,
                              b->outer_diameter / WB_MM);
        if (b->kind != WB_TEST_THREE_POINT || a->length != b->length ||
            a->machine.roller_radius != b->machine.roller_radius)
            return wb_fail_to(why, WB_ERR_DATA,
                              "wire '%s': tests on different benches: expected one span and one "
                              "radius of the rollers",
                              a->wire);
    }
    return WB_OK;
}

void wb_three_point_calibrate_bench(const struct wb_machine *machine,
                                    struct wb_three_point_bench *bench,
                                    struct wb_three_point_variant ends[WB_THREE_POINT_VARIANTS])
{
    const double roller = machine->roller_radius;
    struct wb_band friction = machine->friction, nose = machine->nose_radius;
    if (!friction.known)
        friction = (struct wb_band){true, 0.5 * (least_friction + most_friction), least_friction,
                                    most_friction};
    if (!nose.known)
        nose = (struct wb_band){true, roller, least_nose * roller, most_nose * roller};
    *bench = (struct wb_three_point_bench){
        .friction = friction.value,
        .nose_radius = nose.value,
        .compliance = machine->compliance.known ? machine->compliance.value : 0.0,
    };
    const double values[WB_THREE_POINT_VARIANTS] = {friction.least, friction.most, nose.least,
                                                    nose.most};
    for (int i = 0; i < WB_THREE_POINT_VARIANTS; i++)
        ends[i] = (struct wb_three_point_variant){
            .name = i < 2 ? "friction" : "nose radius", .value = values[i], .is_possible = true};
}

/* Rigidity and moments of a law; their errors from the moved laws of the fit. */
static enum wb_status describe(struct wb_three_point_member *m,
                               const struct wb_three_point_calibration *c)
{
    const double d = m->data.info.outer_diameter;
    m->rigidity = m->fit.law.material.youngs_modulus * wb_circle_second_moment(d);
    WB_TRY(wb_bending_moments(&m->fit.law, d, WB_THREE_POINT_MOMENTS, c->curvature, m->moment));
    m->rigidity_error = 0.0;
    memset(m->moment_error, 0, sizeof m->moment_error);
    for (int i = 0; i < m->fit.n_moved; i++) {
        const struct wb_law *const law = &m->fit.moved[i];
        double moment[WB_THREE_POINT_MOMENTS];
        WB_TRY(wb_bending_moments(law, d, WB_THREE_POINT_MOMENTS, c->curvature, moment));
        const double by = m->fit.moved_by[i];
        m->rigidity_error +=
            pow(log(law->material.youngs_modulus / m->fit.law.material.youngs_modulus) / by, 2);
        for (int k = 0; k < WB_THREE_POINT_MOMENTS; k++)
            m->moment_error[k] += pow(log(moment[k] / m->moment[k]) / by, 2);
    }
    m->rigidity_error = sqrt(m->rigidity_error);
    for (int k = 0; k < WB_THREE_POINT_MOMENTS; k++)
        m->moment_error[k] = sqrt(m->moment_error[k]);
    return WB_OK;
}

/* Index of the first member of a member's series. */
static int series_of(const struct wb_three_point_calibration *c, int i)
{
    for (int k = 0; k < i; k++) {
        if (c->members[k].is_fitted &&
            strcmp(c->members[k].data.info.piece.series, c->members[i].data.info.piece.series) == 0)
            return k;
    }
    return i;
}

/* Rigidity of a member (-1), or one of its moments. */
static double value_of(const struct wb_three_point_member *m, int moment)
{
    return moment < 0 ? m->rigidity : m->moment[moment];
}

/* Mean and interval of the logarithms of a value over members, with their own errors. */
static void estimate(const struct wb_three_point_calibration *c, int moment,
                     struct wb_estimate *out)
{
    double sum = 0.0, own = 0.0, squares = 0.0;
    int n = 0;
    /* Over the means of the series, or with a single series over its members. */
    for (int i = 0; i < c->n_members; i++) {
        if (!c->members[i].is_fitted || (c->n_series > 1 && series_of(c, i) != i))
            continue;
        double mean = 0.0;
        int count = 0;
        for (int k = i; k < c->n_members; k++) {
            if (k == i || (c->n_series > 1 && c->members[k].is_fitted && series_of(c, k) == i)) {
                mean += log(value_of(&c->members[k], moment));
                count++;
            }
        }
        mean /= count;
        sum += mean;
        squares += mean * mean;
        own = moment < 0 ? c->members[i].rigidity_error : c->members[i].moment_error[moment];
        n++;
    }
    const double mean = sum / n;
    out->value = exp(mean);
    out->deviation = n > 1 ? sqrt(fmax(0.0, (squares - n * mean * mean) / (n - 1))) : (double)NAN;
    const double half =
        n > 1 ? gsl_cdf_tdist_Qinv(0.5 * (1.0 - coverage), n - 1) * out->deviation / sqrt(n)
              : 2.0 * own;
    out->low = exp(mean - half);
    out->high = exp(mean + half);
    out->candidates_low = out->candidates_high = out->value;
}

void wb_three_point_calibrate_law(const struct wb_three_point_calibration *c, int without,
                                  struct wb_law *law)
{
    struct wb_law_part mean[WB_THREE_POINT_PARTS];
    const struct wb_law *any = NULL;
    double share = 0.0;
    int n = 0;
    memset(mean, 0, sizeof mean);
    for (int i = 0; i < c->n_members; i++)
        n += c->members[i].is_fitted && i != without;
    for (int i = 0; i < c->n_members; i++) {
        if (!c->members[i].is_fitted || i == without)
            continue;
        any = &c->members[i].fit.law;
        for (int k = 0; k < WB_THREE_POINT_PARTS; k++)
            mean[k].modulus += any->parts[k].modulus / n;
        share += any->isotropic_share / n;
    }
    for (int k = 0; k < WB_THREE_POINT_PARTS; k++)
        mean[k].yield_strain = any->parts[k].yield_strain;
    wb_law_init_parallel(law, mean, WB_THREE_POINT_PARTS, share, any->material.poissons_ratio);
}

/* --- parallel fits --- */

struct work {
    struct wb_three_point_calibration *calibration;
    const struct wb_three_point_calibrate_settings *settings;
    struct variant_fit *fits; /* (n_members x WB_THREE_POINT_VARIANTS); NULL: the members' own */
    int done, all;
    bool stopped;
    enum wb_status status; /* last failure of a job: out of memory */
};

/* A member's fit with another bench. */
struct variant_fit {
    bool is_fitted;
    struct wb_three_point_fit fit;
};

static bool count_fit(void *context, int index, enum wb_status status)
{
    struct work *const work = context;
    const struct wb_three_point_calibrate_settings *const s = work->settings;
    (void)index;
    work->done++;
    if (status != WB_OK)
        work->status = status;
    work->stopped = s->progress && !s->progress(s->progress_context, work->done, work->all);
    return !work->stopped && status == WB_OK;
}

static enum wb_status run_side_by_side(struct work *work, int n, enum wb_status (*job)(void *, int),
                                       struct wb_reason *why)
{
    const struct wb_workers workers = {.n = n,
                                       .n_threads = work->settings->threads,
                                       .job = job,
                                       .done = count_fit,
                                       .context = work};
    (void)wb_workers_run(&workers);
    if (work->status != WB_OK)
        return wb_fail_to(why, work->status, "out of memory");
    return work->stopped ? wb_fail_to(why, WB_ERR_TIMEOUT, "stopped") : WB_OK;
}

/* A member that cannot be fitted does not affect the others. */
static enum wb_status fit_member(void *context, int index)
{
    struct work *const work = context;
    struct wb_three_point_calibration *const c = work->calibration;
    struct wb_three_point_member *const m = &c->members[index];
    m->is_fitted = m->data.n_points > 0 &&
                   wb_three_point_fit_run(&m->fit, &m->data, &c->bench, &c->strains, NULL,
                                          &work->settings->fit, &m->why) == WB_OK;
    return WB_OK;
}

static enum wb_status fit_members(struct work *work, struct wb_reason *why)
{
    struct wb_three_point_calibration *const c = work->calibration;
    double sum = 0.0;
    WB_TRY(run_side_by_side(work, c->n_members, fit_member, why));
    c->largest_curvature = HUGE_VAL;
    c->is_rigidity_identifiable = true;
    for (int i = 0; i < c->n_members; i++) {
        const struct wb_three_point_member *const m = &c->members[i];
        c->cpu_s += m->fit.cpu_s;
        if (!m->is_fitted)
            continue;
        c->n_fitted++;
        c->is_rigidity_identifiable = c->is_rigidity_identifiable && m->data.has_unloading;
        sum += m->fit.misfit * m->fit.misfit;
        c->largest_curvature = fmin(c->largest_curvature, m->fit.largest_curvature);
    }
    if (c->n_fitted == 0)
        return wb_fail_to(why, WB_ERR_DATA, "none of the %d tests can be fitted; the first: %s",
                          c->n_members, c->members[0].why.text);
    c->misfit = sqrt(sum / c->n_fitted);
    for (int k = 0; k < WB_THREE_POINT_MOMENTS; k++)
        c->curvature[k] = parts[k] * c->largest_curvature;
    for (int i = 0; i < c->n_members; i++) {
        struct wb_three_point_member *const m = &c->members[i];
        if (!m->is_fitted)
            continue;
        WB_TRY(describe(m, c));
        c->n_series += series_of(c, i) == i;
    }
    return WB_OK;
}

/* --- another bench --- */

/* The bench with one value at an end of its range; false if the value is known exactly. */
static bool variant_bench(const struct wb_three_point_calibration *c, int variant,
                          struct wb_three_point_bench *bench)
{
    *bench = c->bench;
    double *const number = variant < 2 ? &bench->friction : &bench->nose_radius;
    if (*number == c->variants[variant].value)
        return false;
    *number = c->variants[variant].value;
    return true;
}

/* Fits a member again, starting from its result. */
static enum wb_status fit_variant(void *context, int index)
{
    struct work *const work = context;
    const struct wb_three_point_calibration *const c = work->calibration;
    const struct wb_three_point_member *const m = &c->members[index / WB_THREE_POINT_VARIANTS];
    struct variant_fit *const fit = &work->fits[index];
    struct wb_three_point_bench bench;
    struct wb_reason unused;
    if (m->is_fitted && variant_bench(c, index % WB_THREE_POINT_VARIANTS, &bench))
        fit->is_fitted = wb_three_point_fit_run(&fit->fit, &m->data, &bench, &c->strains, &m->fit,
                                                &work->settings->fit, &unused) == WB_OK;
    return WB_OK;
}

static void widen(struct wb_estimate *e, double ratio)
{
    e->candidates_low = fmin(e->candidates_low, e->value * ratio);
    e->candidates_high = fmax(e->candidates_high, e->value * ratio);
}

static enum wb_status compare(struct wb_three_point_calibration *c, int index,
                              const struct variant_fit *fits)
{
    struct wb_three_point_variant *const variant = &c->variants[index];
    const double d = c->members[0].data.info.outer_diameter;
    double sum = 0.0, ratio = 0.0, ratios[WB_THREE_POINT_MOMENTS] = {0.0};
    for (int i = 0; i < c->n_members; i++) {
        const struct wb_three_point_member *const m = &c->members[i];
        const struct variant_fit *const of = &fits[i * WB_THREE_POINT_VARIANTS + index];
        double moment[WB_THREE_POINT_MOMENTS];
        if (!m->is_fitted)
            continue;
        variant->is_possible = variant->is_possible && of->is_fitted;
        if (!variant->is_possible)
            return WB_OK;
        WB_TRY(wb_bending_moments(&of->fit.law, d, WB_THREE_POINT_MOMENTS, c->curvature, moment));
        sum += of->fit.misfit * of->fit.misfit / c->n_fitted;
        ratio += log(of->fit.law.material.youngs_modulus / m->fit.law.material.youngs_modulus) /
                 c->n_fitted;
        for (int k = 0; k < WB_THREE_POINT_MOMENTS; k++)
            ratios[k] += log(moment[k] / m->moment[k]) / c->n_fitted;
    }
    variant->misfit = sqrt(sum);
    variant->rigidity = exp(ratio);
    widen(&c->rigidity, variant->rigidity);
    for (int k = 0; k < WB_THREE_POINT_MOMENTS; k++) {
        variant->moment[k] = exp(ratios[k]);
        widen(&c->moment[k], variant->moment[k]);
    }
    return WB_OK;
}

static enum wb_status vary(struct work *work, struct wb_reason *why)
{
    struct wb_three_point_calibration *const c = work->calibration;
    const int n = c->n_members * WB_THREE_POINT_VARIANTS;
    struct wb_three_point_bench bench;
    work->fits = wb_memory_new((size_t)n, sizeof *work->fits);
    enum wb_status status = run_side_by_side(work, n, fit_variant, why);
    for (int i = 0; i < n; i++)
        c->cpu_s += work->fits[i].fit.cpu_s;
    for (int i = 0; i < WB_THREE_POINT_VARIANTS && status == WB_OK; i++) {
        if (variant_bench(c, i, &bench)) {
            status = compare(c, i, work->fits);
            continue;
        }
        c->variants[i].misfit = c->misfit;
        c->variants[i].rigidity = 1.0;
        for (int k = 0; k < WB_THREE_POINT_MOMENTS; k++)
            c->variants[i].moment[k] = 1.0;
    }
    free(work->fits);
    return status;
}

static enum wb_status run(struct wb_three_point_calibration *c,
                          const struct wb_dataset *const *datasets,
                          const struct wb_three_point_calibrate_settings *s, struct wb_reason *why)
{
    struct work work = {
        .calibration = c, .settings = s, .all = c->n_members * (1 + WB_THREE_POINT_VARIANTS)};

    c->strains = (struct wb_three_point_strains){HUGE_VAL, 0.0};
    wb_three_point_calibrate_bench(&datasets[0]->info.machine, &c->bench, c->variants);
    c->is_compliance_known = datasets[0]->info.machine.compliance.known;
    for (int i = 0; i < c->n_members; i++) {
        struct wb_three_point_member *const m = &c->members[i];
        if (wb_three_point_data_make(&m->data, datasets[i], &s->data, &m->why) != WB_OK)
            continue;
        const struct wb_three_point_strains own = wb_three_point_fit_strains(&m->data);
        c->strains.first = fmin(c->strains.first, own.first);
        c->strains.last = fmax(c->strains.last, own.last);
    }
    WB_TRY(fit_members(&work, why));
    wb_three_point_calibrate_law(c, -1, &c->law);
    estimate(c, -1, &c->rigidity);
    for (int k = 0; k < WB_THREE_POINT_MOMENTS; k++)
        estimate(c, k, &c->moment[k]);
    c->series_deviation = c->n_series > 1 ? c->rigidity.deviation : (double)NAN;
    WB_TRY(vary(&work, why));
    return wb_bending_ludwik(&c->law, datasets[0]->info.outer_diameter, c->largest_curvature,
                             &c->ludwik, &c->ludwik_misfit);
}

enum wb_status wb_three_point_calibrate_run(
    struct wb_three_point_calibration *calibration, const struct wb_dataset *const *datasets, int n,
    const struct wb_three_point_calibrate_settings *settings, struct wb_reason *why)
{
    *calibration = (struct wb_three_point_calibration){.n_members = n};
    WB_TRY(check_same(datasets, n, why));
    calibration->members = wb_memory_new((size_t)n, sizeof *calibration->members);
    const enum wb_status status = run(calibration, datasets, settings, why);
    if (status != WB_OK)
        wb_three_point_calibrate_release(calibration);
    return status;
}

void wb_three_point_calibrate_release(struct wb_three_point_calibration *calibration)
{
    for (int i = 0; calibration->members && i < calibration->n_members; i++)
        wb_three_point_data_release(&calibration->members[i].data);
    free(calibration->members);
    calibration->members = NULL;
    calibration->n_members = 0;
}
