#include "analysis/calibration/three_point/machine_compliance.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_cdf.h>

#include "analysis/calibration/three_point/three_point_calibrate.h"
#include "analysis/calibration/three_point/three_point_model.h"
#include "analysis/dataset/fit.h"
#include "base/circle.h"
#include "base/memory.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "compliance"

static const struct wb_setting rows[] = {
    {WB_ROW_QUANTITY(wb_machine_compliance_settings, rigidity, "rigidity_N_mm2", "N mm2", 1e-6,
                     1e-6, 1e15, 0.0),
     WB_ROW_OPTION("rigidity-n-mm2", "EI", "Flexural rigidity of the bar"),
     .otherwise = "required"},
    {WB_ROW_NUMBER(wb_machine_compliance_settings, rigidity_error, "rigidity_error", 1e-6, 1.0,
                   0.02),
     WB_ROW_OPTION("rigidity-error", "R", "Uncertainty of the rigidity (95 %), as a part of it")},
    {WB_ROW_NUMBER(wb_machine_compliance_settings, from_force, "from_force", 0.01, 0.9, 0.2),
     WB_ROW_OPTION(
         "from-force", "R",
         "Part of the largest force below which readings are ignored, while the bar seats")},
};

const struct wb_setting_table wb_machine_compliance_table = {WB_SETTING_ROWS(rows)};

enum {
    LEAST_READINGS = 10,
    ELEMENTS = 32 /* of half the bar */
};

static const double coverage = 0.95;
/* Largest curvature of a line: deviation over its rise in either half of the forces. The unloading
 * may deviate from it by as much in slope, and in travel. */
static const double most_curved = 0.03;
/* Part of the largest force above which the unloading is ignored, because friction reverses
 * there. */
static const double below_turn = 0.9;
/* Number of standard deviations below which a difference is not significant. */
static const double noises = 3.0;
static const double poissons_ratio = 0.3; /* of a metal: shear of a bar on a short span */

/* The readings of one branch above the smallest force, and their travel less the bar's
 * deflection. */
struct readings {
    int n;
    double *travel, *force, *remainder;
};

struct test {
    double zero, largest; /* N */
    struct readings up, back;
};

static void add_reading(struct readings *r, const struct wb_row *row, double force)
{
    r->travel[r->n] = row->deflection;
    r->force[r->n++] = force;
}

static void collect(struct test *test, const struct wb_dataset *dataset, double from_force)
{
    size_t n = 0, top = 0;
    while (n < dataset->n_rows && dataset->rows[n].cycle == dataset->rows[0].cycle)
        n++;
    double *const room = wb_memory_new(6 * n, sizeof *room);
    *test = (struct test){
        .zero = HUGE_VAL,
        .up = {.travel = room, .force = room + n, .remainder = room + 2 * n},
        .back = {.travel = room + 3 * n, .force = room + 4 * n, .remainder = room + 5 * n}};
    /* The loading ends at the largest force, not at the largest travel: a bar that slips forward at
     * the turn moves on, and its readings there would count as noise of the loading. */
    for (size_t i = 0; i < n; i++) {
        if (dataset->rows[i].force > dataset->rows[top].force)
            top = i;
    }
    for (size_t i = 0; i <= top && i < n; i++)
        test->zero = fmin(test->zero, dataset->rows[i].force);
    if (n > 0)
        test->largest = dataset->rows[top].force - test->zero;
    for (size_t i = 0; i < n; i++) {
        const struct wb_row *const row = &dataset->rows[i];
        const double force = row->force - test->zero;
        if (!(force >= from_force * test->largest) || !isfinite(row->deflection))
            continue;
        if (i <= top)
            add_reading(&test->up, row, force);
        else if (force <= below_turn * test->largest)
            add_reading(&test->back, row, force);
    }
}

/* The bar's deflection under a force, by bisection of its curve. */
static double deflection_of(const struct wb_three_point_model *model, double force, double most)
{
    double low = 0.0, high = most;
    for (int i = 0; i < 60; i++) {
        const double middle = 0.5 * (low + high);
        if (wb_three_point_model_force(model, middle, false) < force)
            low = middle;
        else
            high = middle;
    }
    return 0.5 * (low + high);
}

/* Curvature of the readings: deviation of their parabola over half the forces, over the rise of the
 * line there. */
static double curved_part(const struct readings *r, double mean, double slope)
{
    double c[3], deviation, reach = 0.0;
    double *const x = wb_memory_new((size_t)r->n, sizeof *x);
    for (int i = 0; i < r->n; i++) {
        x[i] = r->force[i] - mean;
        reach = fmax(reach, fabs(x[i]));
    }
    const bool found = wb_fit_parabola(x, r->remainder, (size_t)r->n, c, &deviation);
    free(x);
    return found ? fabs(c[2] * reach / slope) : 0.0;
}

/* The line of one branch. */
struct slope {
    struct wb_fit_line line; /* m of travel over N */
    double error, curved;
};

static enum wb_status find_slope(struct slope *slope, const struct readings *r,
                                 const struct wb_three_point_model *model, double most)
{
    struct wb_fit_line line;
    double mean = 0.0, spread = 0.0;
    int signs = 1;
    for (int i = 0; i < r->n; i++) {
        r->remainder[i] = r->travel[i] - deflection_of(model, r->force[i], most);
        mean += r->force[i] / r->n;
    }
    if (!wb_fit_line(r->force, r->remainder, (size_t)r->n, &line))
        return WB_ERR_DATA;
    for (int i = 0; i < r->n; i++) {
        const double off = r->remainder[i] - line.value - line.slope * r->force[i];
        const double before =
            i > 0 ? r->remainder[i - 1] - line.value - line.slope * r->force[i - 1] : off;
        signs += (off < 0.0) != (before < 0.0);
        spread += pow(r->force[i] - mean, 2);
    }
    slope->line = line;
    slope->error = line.residual * sqrt(fmax(1.0, 0.5 * r->n / signs) / spread);
    slope->curved = curved_part(r, mean, line.slope);
    return WB_OK;
}

static enum wb_status check(const struct wb_dataset *const *datasets, int n,
                            const struct wb_machine_compliance_settings *s, struct wb_reason *why)
{
    const struct wb_test_info *const a = &datasets[0]->info;
    if (!(s->rigidity > 0.0))
        return wb_fail_to(why, WB_ERR_ARGUMENT,
                          "the bar's flexural rigidity is missing: --rigidity-n-mm2 (E pi d^4 / 64 "
                          "of a round bar)");
    for (int i = 0; i < n; i++) {
        const struct wb_test_info *const b = &datasets[i]->info;
        if (b->kind != WB_TEST_THREE_POINT)
            return wb_fail_to(why, WB_ERR_DATA, "'%s' is not a three-point bending test", b->wire);
        if (strcmp(a->wire, b->wire) != 0 || a->outer_diameter != b->outer_diameter ||
            a->length != b->length || a->machine.roller_radius != b->machine.roller_radius)
            return wb_fail_to(why, WB_ERR_DATA,
                              "tests of '%s' and of '%s': expected one bar on one bench", a->wire,
                              b->wire);
    }
    return WB_OK;
}

/* Mean over the tests with the bench's friction. */
struct mean {
    double slope, deviation, error, misfit, of_bar, curved;
    /* Of the unloadings: mean slope and its error, residual travel at the smallest force, largest
     * travel from zero force. NaN: not all tests have an unloading. */
    double back, back_error, residual, most_travel;
    double strain; /* largest strain of the bar */
};

/* Adds the unloading of one test to the sums. */
static enum wb_status add_unloading(struct mean *mean, const struct test *test, int n,
                                    const struct slope *up,
                                    const struct wb_three_point_model *model, double most)
{
    struct slope back;
    if (test->back.n < LEAST_READINGS)
        mean->back = (double)NAN;
    if (!isfinite(mean->back))
        return WB_OK;
    WB_TRY(find_slope(&back, &test->back, model, most));
    const double least = test->up.force[0];
    mean->back += back.line.slope / n;
    mean->back_error = hypot(mean->back_error, hypot(back.error, up->error) / n);
    mean->residual +=
        (back.line.value - up->line.value + (back.line.slope - up->line.slope) * least) / n;
    return WB_OK;
}

static enum wb_status find_mean(struct mean *mean, const struct test *all, int n,
                                const struct wb_test_info *info,
                                const struct wb_three_point_bench *bench, double rigidity,
                                struct wb_reason *why)
{
    const double d = info->outer_diameter, span = info->length;
    const struct wb_law_part part = {rigidity / wb_circle_second_moment(d), (double)INFINITY};
    struct wb_three_point_model *model;
    struct wb_three_point_run run = {.reached = false};
    struct wb_law law;
    double largest = 0.0, sum = 0.0, squares = 0.0, misfits = 0.0;
    *mean = (struct mean){.of_bar = pow(span, 3) / (48.0 * rigidity)};
    for (int i = 0; i < n; i++)
        largest = fmax(largest, all[i].largest);
    const double most = 1.1 * largest * mean->of_bar;
    wb_law_init_parallel(&law, &part, 1, 0.0, poissons_ratio);
    WB_TRY(wb_three_point_model_create(&model, info, bench, &law, ELEMENTS));
    enum wb_status status = wb_three_point_model_run(model, &law, 0.0, most, false, &run);
    if (status == WB_OK && !run.reached)
        status = wb_fail_to(
            why, WB_ERR_DATA,
            "a bar of %.4g N mm2 under %.4g N bends beyond %.3g mm (%s): the bar is too compliant",
            rigidity / 1e-6, largest, run.travel / WB_MM, wb_three_point_bending_end_name(run.end));
    for (int i = 0; i < n && status == WB_OK; i++) {
        struct slope slope;
        status = find_slope(&slope, &all[i].up, model, 1.5 * most);
        if (status == WB_OK)
            status = add_unloading(mean, &all[i], n, &slope, model, 1.5 * most);
        if (status != WB_OK) {
            (void)wb_fail_to(why, status, "test %d of '%s': its force is constant", i + 1,
                             info->wire);
            break;
        }
        sum += slope.line.slope;
        squares += slope.line.slope * slope.line.slope;
        misfits += slope.line.residual * slope.line.residual;
        mean->error = slope.error;
        mean->curved = fmax(mean->curved, slope.curved);
        mean->most_travel =
            fmax(mean->most_travel, deflection_of(model, all[i].largest, 1.5 * most) +
                                        slope.line.slope * all[i].largest);
    }
    /* The run goes to 1.1 times the bar's deflection. */
    mean->strain = 0.5 * d * run.largest_curvature / 1.1;
    wb_three_point_model_destroy(model);
    mean->slope = sum / n;
    mean->misfit = sqrt(misfits / n);
    mean->deviation =
        n > 1 ? sqrt(fmax(0.0, squares - n * mean->slope * mean->slope) / (n - 1)) : 0.0;
    return status;
}

/* Compares unloading and loading. Friction acts on the bar in both directions, so that the two
 * branches differ by twice its effect on one. */
static void judge_unloading(struct wb_machine_compliance *result, const struct mean *mean)
{
    result->has_unloading = isfinite(mean->back);
    result->is_reversible = true;
    result->value_unloading = mean->back;
    result->residual = result->has_unloading ? mean->residual : (double)NAN;
    result->most_travel = mean->most_travel;
    result->strain = mean->strain;
    if (!result->has_unloading)
        return;
    const double of_slope = most_curved * (mean->of_bar + mean->slope) + 2.0 * result->of_friction +
                            noises * mean->back_error;
    const double of_travel = most_curved * mean->most_travel + noises * mean->misfit;
    result->is_reversible =
        fabs(mean->back - mean->slope) <= of_slope && fabs(mean->residual) <= of_travel;
}

static enum wb_status find(struct wb_machine_compliance *result, const struct test *all, int n,
                           const struct wb_test_info *info,
                           const struct wb_machine_compliance_settings *s, struct wb_reason *why)
{
    struct wb_three_point_variant ends[WB_THREE_POINT_VARIANTS];
    struct wb_three_point_bench bench;
    struct mean mean, low, high;
    wb_three_point_calibrate_bench(&info->machine, &bench, ends);
    bench.compliance = 0.0;
    WB_TRY(find_mean(&mean, all, n, info, &bench, s->rigidity, why));
    bench.friction = ends[0].value;
    WB_TRY(find_mean(&low, all, n, info, &bench, s->rigidity, why));
    bench.friction = ends[1].value;
    WB_TRY(find_mean(&high, all, n, info, &bench, s->rigidity, why));
    *result = (struct wb_machine_compliance){
        .value = mean.slope,
        .of_bar = mean.of_bar,
        .of_readings =
            n > 1 ? gsl_cdf_tdist_Qinv(0.5 * (1.0 - coverage), n - 1) * mean.deviation / sqrt(n)
                  : 2.0 * mean.error,
        .of_rigidity = s->rigidity_error * mean.of_bar,
        .of_friction = 0.5 * fabs(high.slope - low.slope),
        .misfit = mean.misfit,
        .n_tests = n,
    };
    const double half = sqrt(pow(result->of_readings, 2) + pow(result->of_rigidity, 2) +
                             pow(result->of_friction, 2));
    result->low = result->value - half;
    result->high = result->value + half;
    result->is_straight = mean.curved <= most_curved;
    judge_unloading(result, &mean);
    result->is_identifiable = result->low > 0.0 && result->is_straight && result->is_reversible;
    return WB_OK;
}

enum wb_status wb_machine_compliance_find(struct wb_machine_compliance *result,
                                          const struct wb_dataset *const *datasets, int n,
                                          const struct wb_machine_compliance_settings *settings,
                                          struct wb_reason *why)
{
    if (n < 1)
        return wb_fail_to(why, WB_ERR_ARGUMENT, "expected at least one test");
    WB_TRY(check(datasets, n, settings, why));
    struct test *const all = wb_memory_new((size_t)n, sizeof *all);
    enum wb_status status = WB_OK;
    for (int i = 0; i < n && status == WB_OK; i++) {
        collect(&all[i], datasets[i], settings->from_force);
        if (all[i].up.n < LEAST_READINGS)
            status = wb_fail_to(why, WB_ERR_DATA,
                                "test %d of '%s': %d readings above %g of the largest force: "
                                "expected at least %d",
                                i + 1, datasets[i]->info.wire, all[i].up.n, settings->from_force,
                                LEAST_READINGS);
    }
    if (status == WB_OK)
        status = find(result, all, n, &datasets[0]->info, settings, why);
    for (int i = 0; i < n; i++)
        free(all[i].up.travel);
    free(all);
    return status;
}
