/* What a calibration on whole cycles says, against the truth of the virtual wires that were bent.
 *
 * Each specimen is one of tests/analysis/fast_rig.h: the rig's instruments, noise and alignment.
 * The numbers are printed; docs/verification.md has them. Threads share the work.
 */
#include <stdlib.h>

#include <gsl/gsl_errno.h>

#include "analysis/align/align.h"
#include "analysis/calibration/cycle/cycle_bow.h"
#include "analysis/calibration/cycle/cycle_calibrate.h"
#include "analysis/calibration/cycle/cycle_model.h"
#include "analysis/calibration/law/bending.h"
#include "analysis/calibration/paper/calibrate.h"
#include "base/file.h"
#include "base/units.h"
#include "base/workers.h"
#include "fe/trial/cantilever.h"
#include "tests/analysis/calibration/containing.h"
#include "tests/analysis/fast_rig.h"
#include "tests/check.h"

enum {
    TYPES = 3,
    PER_TYPE = 40,
    OTHER_TYPE = 2, /* of the wires of other laws */
    PER_TRUTH = 20,
    CAMPAIGNS = 200,
    CAMPAIGN_TYPE = 2,
    CAMPAIGN_SPECIMENS = 3,
    PREDICTED = 4,                 /* specimens of a type that are predicted at other lengths */
    NUMBERS = WB_CYCLE_MOMENTS + 2 /* EI, residual_curvature_ratio, moments */
};

/* --- specimens and what is said of them --- */

/* What is reported of a wire, and its truth. */
struct verdict {
    bool good;
    enum wb_candidate chosen;
    bool is_followed;
    double best_misfit, misfit; /* of the best candidate, of the chosen one */
    double containing;          /* see tests/analysis/calibration/containing.h */
    double value[NUMBERS], truth[NUMBERS];
    double low[NUMBERS], high[NUMBERS];             /* over specimens */
    double range_low[NUMBERS], range_high[NUMBERS]; /* over candidates */
    double cpu_s;
    double largest_curvature;
    struct wb_law law;
};

static const char *name_of(int number)
{
    static const char *const names[NUMBERS] = {"EI",     "residual", "M(0.05)", "M(0.1)",
                                               "M(0.3)", "M(0.6)",   "M(1)"};
    return names[number];
}

static void keep(struct verdict *verdict, int number, const struct wb_estimate *estimate)
{
    verdict->value[number] = estimate->value;
    verdict->low[number] = estimate->low;
    verdict->high[number] = estimate->high;
    verdict->range_low[number] = estimate->candidates_low;
    verdict->range_high[number] = estimate->candidates_high;
}

/* Calibrates on the datasets; the truth is that of `fast`. */
static void judge(struct verdict *verdict, const struct fast_rig *fast,
                  const struct wb_dataset *const *datasets, int n, unsigned left_out)
{
    struct wb_cycle_calibrate_settings settings;
    struct wb_cycle_calibration c;
    struct wb_reason why = {.text = ""};
    double residual;

    wb_cycle_calibrate_default_settings(&settings);
    settings.threads = 1;
    settings.left_out = left_out;
    if (wb_cycle_calibrate_run(&c, datasets, n, &settings, &why) != WB_OK) {
        printf("%s\n", why.text);
        return;
    }
    keep(verdict, 0, &c.rigidity);
    keep(verdict, 1, &c.residual_curvature_ratio);
    for (int k = 0; k < WB_CYCLE_MOMENTS; k++)
        keep(verdict, 2 + k, &c.moment[k]);
    fast_rig_truth(fast, WB_CYCLE_MOMENTS, c.curvature, verdict->truth + 2, &verdict->truth[0],
                   &residual);
    verdict->truth[1] = residual / c.largest_curvature;
    verdict->chosen = c.chosen;
    verdict->is_followed = c.is_followed;
    verdict->best_misfit = c.ranked[0].misfit;
    verdict->containing = worst_of_containing(&c);
    for (int i = 0; i < c.n_ranked; i++) {
        if (c.ranked[i].candidate == c.chosen)
            verdict->misfit = c.ranked[i].misfit;
    }
    verdict->cpu_s = c.cpu_s;
    verdict->largest_curvature = c.largest_curvature;
    verdict->law = c.law;
    verdict->good = true;
    wb_cycle_calibrate_release(&c);
}

/* A specimen, or more of one wire, that are tested and calibrated. */
struct job {
    struct fast_rig fast;
    int type;
    unsigned left_out; /* candidates */
    int n;             /* specimens, with seeds from fast.truth.seed on */
    uint64_t seed;
    struct verdict verdict;
};

static void start_job(struct job *job, int type, uint64_t seed)
{
    *job = (struct job){.type = type, .n = 1, .seed = seed};
    fast_rig_init(&job->fast, type, 85.0 * WB_MM, seed);
    job->fast.every_frame = 1;
}

/* Seed of the first stored recording of a type, L = 85 mm. */
static uint64_t first_seed(int type)
{
    return 1 + 6 * (uint64_t)(type - 1);
}

static void work_on(struct job *job)
{
    struct wb_dataset datasets[CAMPAIGN_SPECIMENS] = {{.rows = NULL}};
    const struct wb_dataset *list[CAMPAIGN_SPECIMENS];
    bool good = true;
    for (int i = 0; i < job->n && good; i++) {
        struct fast_rig fast = job->fast;
        wb_truth_draw(&fast.truth, job->seed + (uint64_t)i, &fast.rig, &fast.specimen);
        good = fast_rig_run(&fast, &datasets[i]) == WB_OK;
        datasets[i].info.sample = i + 1;
        list[i] = &datasets[i];
    }
    if (good) {
        struct fast_rig fast = job->fast;
        wb_truth_draw(&fast.truth, job->seed, &fast.rig, &fast.specimen);
        /* Of several, the wire that they all scatter around. */
        if (job->n > 1)
            fast.truth.stiffness_factor = fast.truth.yield_factor = 1.0;
        judge(&job->verdict, &fast, list, job->n, job->left_out);
    }
    for (int i = 0; i < job->n; i++)
        wb_dataset_release(&datasets[i]);
}

static enum wb_status work_on_one(void *jobs, int i)
{
    work_on((struct job *)jobs + i);
    return WB_OK;
}

static void work_on_all(struct job *jobs, int n)
{
    const struct wb_workers workers = {.n = n, .job = work_on_one, .context = jobs};
    assert_int_equal(wb_workers_run(&workers), n);
}

/* --- what comes of many --- */

struct summary {
    double bias[NUMBERS], deviation[NUMBERS]; /* of value over truth, less 1 */
    double half[NUMBERS];                     /* mean half-width of the range over candidates */
    double holds[NUMBERS];                    /* part of the ranges that hold the truth */
};

static double error_of(const struct verdict *verdict, int number)
{
    return verdict->value[number] / verdict->truth[number] - 1.0;
}

static struct summary summarise(const struct job *jobs, int n)
{
    struct summary summary = {{0.0}, {0.0}, {0.0}, {0.0}};
    for (int k = 0; k < NUMBERS; k++) {
        double squares = 0.0;
        for (int i = 0; i < n; i++)
            summary.bias[k] += error_of(&jobs[i].verdict, k) / n;
        for (int i = 0; i < n; i++)
            squares += pow(error_of(&jobs[i].verdict, k) - summary.bias[k], 2.0);
        summary.deviation[k] = sqrt(squares / (n - 1));
        for (int i = 0; i < n; i++) {
            const struct verdict *const v = &jobs[i].verdict;
            summary.half[k] += 0.5 * (v->range_high[k] - v->range_low[k]) / v->truth[k] / n;
            summary.holds[k] +=
                (v->range_low[k] <= v->truth[k] && v->truth[k] <= v->range_high[k]) / (double)n;
        }
    }
    return summary;
}

static void print_summary(const char *title, const struct summary *summary)
{
    printf("%-24s", title);
    for (int k = 0; k < NUMBERS; k++)
        printf("  %s %+.1f (%.1f)", name_of(k), 100.0 * summary->bias[k],
               100.0 * summary->deviation[k]);
    printf(" %%\n    range, half (holds)    ");
    for (int k = 0; k < NUMBERS; k++)
        printf("  %s %.1f (%.0f)", name_of(k), 100.0 * summary->half[k], 100.0 * summary->holds[k]);
    printf(" %%\n");
}

static void print_laws(const struct job *jobs, int n)
{
    int counts[WB_CANDIDATES] = {0}, unsupported = 0;
    double cpu = 0.0;
    for (int i = 0; i < n; i++) {
        counts[jobs[i].verdict.chosen]++;
        unsupported += !jobs[i].verdict.is_followed;
        cpu += jobs[i].verdict.cpu_s;
    }
    printf("    chosen:");
    for (int c = 0; c < WB_CANDIDATES; c++) {
        if (counts[c] > 0)
            printf(" %s %d;", wb_candidate_name(c), counts[c]);
    }
    printf(" not supported %d; %.2f s of CPU each\n", unsupported, cpu / n);
}

static void print_one(const struct job *job)
{
    const struct verdict *const v = &job->verdict;
    printf("      seed %d: %s, misfit %.3f (best %.3f) %%%s", (int)job->seed,
           wb_candidate_name(v->chosen), 100.0 * v->misfit, 100.0 * v->best_misfit,
           v->is_followed ? "" : ", not supported");
    for (int k = 0; k < NUMBERS; k++)
        printf("  %s %+.1f [%+.1f %+.1f]", name_of(k), 100.0 * error_of(v, k),
               100.0 * (v->range_low[k] / v->truth[k] - 1.0),
               100.0 * (v->range_high[k] / v->truth[k] - 1.0));
    printf("\n");
}

/* --- the facts --- */

static struct job types[TYPES][PER_TYPE];

static void the_rigs_wires_come_out_as_they_are(void **unused)
{
    (void)unused;
    for (int t = 0; t < TYPES; t++) {
        char title[32];
        for (int i = 0; i < PER_TYPE; i++) {
            start_job(&types[t][i], t + 1, 1000 + (uint64_t)i);
        }
        work_on_all(types[t], PER_TYPE);
        snprintf(title, sizeof title, "type %d, %d specimens", t + 1, PER_TYPE);
        for (int i = 0; i < PER_TYPE; i++)
            assert_true(types[t][i].verdict.good);
        const struct summary summary = summarise(types[t], PER_TYPE);
        print_summary(title, &summary);
        print_laws(types[t], PER_TYPE);
        for (int i = 0; i < PER_TYPE && getenv("SHOW_ALL"); i++)
            print_one(&types[t][i]);
    }
    for (int t = 0; t < TYPES; t++) {
        const struct summary summary = summarise(types[t], PER_TYPE);
        assert_close(summary.bias[0], 0.0, 0.04);
        assert_close(summary.deviation[0], 0.0, 0.03);
        for (int k = 2; k < NUMBERS; k++) {
            assert_close(summary.bias[k], 0.0, 0.012);
            assert_close(summary.deviation[k], 0.0, 0.01);
        }
        /* It changes by 0.5 to 1 % when the moments change by 0.1 %. */
        assert_close(summary.bias[1], 0.0, 0.02);
        assert_true(summary.holds[1] >= 0.9);
    }
}

/* Whether a number that is wrong is said without a warning. */
static bool misleads(const struct verdict *v, int number, double most)
{
    const double low =
        fmin(v->range_low[number], isfinite(v->low[number]) ? v->low[number] : v->value[number]);
    const double high =
        fmax(v->range_high[number], isfinite(v->high[number]) ? v->high[number] : v->value[number]);
    return v->is_followed && fabs(error_of(v, number)) > most &&
           !(low <= v->truth[number] && v->truth[number] <= high);
}

static void no_wire_of_another_law_is_wrong_without_a_warning(void **unused)
{
    (void)unused;
    static struct job jobs[WB_COMPOSITE_SLIPPING][PER_TRUTH + 1];
    int wrong = 0;
    double worst_containing = 0.0;
    for (int v = WB_COMPOSITE_ISOTROPIC; v < WB_COMPOSITE_SLIPPING; v++) {
        for (int i = 0; i <= PER_TRUTH; i++) {
            struct job *const job = &jobs[v][i];
            start_job(job, OTHER_TYPE, 2000 + (uint64_t)i);
            job->fast.variant = v;
            if (i == PER_TRUTH)
                job->fast.noise = 1e-3;
        }
        work_on_all(jobs[v], PER_TRUTH + 1);
        for (int i = 0; i <= PER_TRUTH; i++) {
            assert_true(jobs[v][i].verdict.good);
            worst_containing = fmax(worst_containing, jobs[v][i].verdict.containing);
        }
        const struct summary summary = summarise(jobs[v], PER_TRUTH);
        print_summary(wb_composite_variant_names[v], &summary);
        print_laws(jobs[v], PER_TRUTH);
        printf("    best misfit without noise %.3f %%\n",
               100.0 * jobs[v][PER_TRUTH].verdict.best_misfit);
        for (int i = 0; i <= PER_TRUTH; i++) {
            bool here = false;
            for (int k = 0; k < NUMBERS; k++) {
                if (k != 1 && misleads(&jobs[v][i].verdict, k, k == 0 ? 0.10 : 0.03))
                    here = true;
            }
            if ((here && i < PER_TRUTH) || getenv("SHOW_ALL"))
                print_one(&jobs[v][i]);
            wrong += here && i < PER_TRUTH;
        }
    }
    printf("    wrong without a warning: %d of %d\n", wrong,
           PER_TRUTH * (WB_COMPOSITE_SLIPPING - 1));
    assert_int_equal(wrong, 0);
    printf("    misfit above that of a contained law: %.2f %% at most\n", 100.0 * worst_containing);
    assert_true(worst_containing <= 0.0);
    for (int v = WB_COMPOSITE_ISOTROPIC; v < WB_COMPOSITE_SLIPPING; v++) {
        if (jobs[v][PER_TRUTH].verdict.best_misfit <= 1e-3)
            assert_close(summarise(jobs[v], PER_TRUTH).bias[0], 0.0, 0.05);
    }
}

/* --- other lengths --- */

/* How far a prediction is off what was measured. */
struct prediction {
    double loading, unloading; /* RMS over F_max */
    double residual;           /* m, of the deflection without force during unloading */
    double loop;               /* of the second cycle's energy, relative */
};

/* Work of a closed cycle: force over deflection, row by row. */
static double measured_loop(const struct wb_dataset *dataset, int cycle)
{
    const struct wb_row *last = NULL;
    double work = 0.0;
    for (size_t i = 0; i < dataset->n_rows; i++) {
        const struct wb_row *const row = &dataset->rows[i];
        if (row->cycle != cycle || !isfinite(row->tension) || !isfinite(row->deflection))
            continue;
        if (last)
            work += 0.5 * (row->tension + last->tension) * (row->deflection - last->deflection);
        last = row;
    }
    return work;
}

/* Work of the second cycle of the same beam, from its rest and back: it is bent back below zero
 * deflection, as the specimen is. */
static double computed_loop(const struct wb_test_info *info, const struct wb_law *law, double top)
{
    enum {
        STEPS = 200
    };
    struct wb_section section;
    struct wb_cantilever_model model;
    struct wb_cantilever *beam;
    struct wb_cantilever_point point, last = {0};
    const double rest = wb_cycle_model_rest(info);
    double work = 0.0;

    wb_cantilever_default_model(&model);
    assert_int_equal(wb_section_init_law(&section, info->outer_diameter, law, 20), WB_OK);
    model.section = &section;
    model.length = info->length;
    model.strand_length = info->strand_length;
    model.counterweight = info->counterweight;
    model.mass_per_length = info->mass_per_length;
    model.gravity_y = -info->gravity;
    model.natural_curvature = wb_dataset_natural_curvature;
    model.curvature_context = (void *)info;
    assert_int_equal(wb_cantilever_create(&beam, &model, NULL), WB_OK);
    for (int i = 0; i <= 4 * STEPS; i++) {
        const int way = i % (2 * STEPS);
        const double target = rest + (top - rest) * (way <= STEPS ? way : 2 * STEPS - way) / STEPS;
        assert_int_equal(wb_cantilever_move(beam, WB_CONTROL_DEFLECTION, target, &point), WB_OK);
        assert_int_equal(point.end, WB_CANTILEVER_CONVERGED);
        if (i > 2 * STEPS)
            work += 0.5 * (point.tension + last.tension) * (point.deflection - last.deflection);
        last = point;
    }
    wb_cantilever_destroy(beam);
    wb_section_release(&section);
    return work;
}

/* A test of another length of the same wire, predicted with the law that 85 mm gave. One number is
 * its own, the bow, from the tension before it is bent; nothing is fitted to what follows. */
static void predict(struct prediction *prediction, const struct job *job, double length,
                    double travel)
{
    const struct wb_law *const law = &job->verdict.law;
    const struct wb_cycle_model_settings mesh = {50, 20};
    struct fast_rig fast = job->fast;
    struct wb_dataset dataset;
    struct wb_cycle_data data;
    struct wb_cycle_model *model;
    struct wb_cycle_run run;

    fast_rig_init(&fast, job->type, length, job->seed);
    fast.travel = travel;
    fast.cycles = 2;
    fast.every_frame = 1;
    assert_int_equal(fast_rig_run(&fast, &dataset), WB_OK);
    assert_int_equal(wb_cycle_data_take(&data, &dataset, NULL, NULL), WB_OK);
    double *const tension = calloc((size_t)data.n_points, sizeof *tension);
    assert_non_null(tension);
    struct wb_cycle_specimen specimen = {.level = 0.0};
    assert_int_equal(wb_cycle_bow_find(&specimen.bow_angle, &dataset, &data, law, &mesh), WB_OK);
    assert_int_equal(wb_cycle_model_create(&model, &data, law, &mesh), WB_OK);
    assert_int_equal(wb_cycle_model_run(model, law, &specimen, tension, NULL, &run), WB_OK);
    assert_true(run.reached);

    double sums[2] = {0.0, 0.0};
    int counts[2] = {0, 0};
    double residual = (double)NAN;
    for (int i = 0; i < data.n_points; i++) {
        const int way = data.points[i].is_unloading;
        sums[way] += pow((tension[i] - data.points[i].tension) / data.max_force, 2.0);
        counts[way]++;
        if (i > data.n_loading && tension[i] < data.zero_tension && isnan(residual)) {
            const double part = (data.zero_tension - tension[i]) / (tension[i - 1] - tension[i]);
            residual = data.points[i].deflection +
                       part * (data.points[i - 1].deflection - data.points[i].deflection);
        }
    }
    struct wb_test_info bent = dataset.info;
    bent.n_natural_shape = 1;
    bent.natural_shape[0] = specimen.bow_angle;
    prediction->loading = sqrt(sums[0] / counts[0]);
    prediction->unloading = sqrt(sums[1] / counts[1]);
    prediction->residual = residual - data.residual_deflection;
    prediction->loop = computed_loop(&bent, law, data.top) / measured_loop(&dataset, 2) - 1.0;
    free(tension);
    wb_cycle_model_destroy(model);
    wb_cycle_data_release(&data);
    wb_dataset_release(&dataset);
}

static void other_lengths_are_predicted(void **unused)
{
    (void)unused;
    static const double lengths[] = {60.0 * WB_MM, 150.0 * WB_MM};
    struct prediction worst = {0.0, 0.0, 0.0, 0.0};
    for (int t = 0; t < TYPES; t++) {
        for (int l = 0; l < 2; l++) {
            struct prediction sum = {0.0, 0.0, 0.0, 0.0};
            if (!types[t][0].verdict.good) {
                for (int i = 0; i < PREDICTED; i++)
                    start_job(&types[t][i], t + 1, 1000 + (uint64_t)i);
                work_on_all(types[t], PREDICTED);
            }
            /* As far as the law was fitted, or as the strand allows. */
            const double part = lengths[l] / (85.0 * WB_MM);
            const double travel = 53.0 * WB_MM * fmin(part * part, part);
            for (int i = 0; i < PREDICTED; i++) {
                struct prediction one;
                predict(&one, &types[t][i], lengths[l], travel);
                sum.loading += one.loading / PREDICTED;
                sum.unloading += one.unloading / PREDICTED;
                /* A short unloading may end above it. */
                if (isfinite(one.residual))
                    worst.residual = fmax(worst.residual, fabs(one.residual));
                sum.loop += one.loop / PREDICTED;
                if (getenv("SHOW_ALL"))
                    printf("      seed %d: %.2f %.2f %% %+.2f mm %+.1f %%\n", (int)types[t][i].seed,
                           100.0 * one.loading, 100.0 * one.unloading, one.residual / WB_MM,
                           100.0 * one.loop);
            }
            printf("type %d, predicted at %g mm, travel %.0f mm, means of %d: loading %.2f, "
                   "unloading %.2f %% of F_max; loop of cycle 2 "
                   "%+.1f %%\n",
                   t + 1, lengths[l] / WB_MM, travel / WB_MM, PREDICTED, 100.0 * sum.loading,
                   100.0 * sum.unloading, 100.0 * sum.loop);
            worst.loading = fmax(worst.loading, sum.loading);
            worst.unloading = fmax(worst.unloading, sum.unloading);
            worst.loop = fmax(worst.loop, fabs(sum.loop));
        }
    }
    printf("    largest residual deflection off %.2f mm\n", worst.residual / WB_MM);
    assert_true(worst.loading <= 0.005);
    assert_true(worst.unloading <= 0.006);
    assert_true(worst.residual <= 0.5 * WB_MM);
    assert_true(worst.loop <= 0.03);
}

/* --- campaigns --- */

static void intervals_cover_the_truth(void **unused)
{
    (void)unused;
    static struct job jobs[CAMPAIGNS];
    int covers[NUMBERS] = {0}, n = 0;
    double half[NUMBERS] = {0.0};
    for (int i = 0; i < CAMPAIGNS; i++) {
        start_job(&jobs[i], CAMPAIGN_TYPE, 10000 + (uint64_t)(CAMPAIGN_SPECIMENS * i));
        jobs[i].fast.every_frame = 6;
        jobs[i].n = CAMPAIGN_SPECIMENS;
        /* The rig's wires choose between the two that are left, see above. */
        jobs[i].left_out = 1U << WB_CANDIDATE_LUDWIK_ISOTROPIC | 1U << WB_CANDIDATE_LUDWIK_MIXED |
                           1U << WB_CANDIDATE_PARALLEL_MIXED | 1U << WB_CANDIDATE_PARALLEL_COMBINED;
    }
    work_on_all(jobs, CAMPAIGNS);
    for (int i = 0; i < CAMPAIGNS; i++) {
        const struct verdict *const v = &jobs[i].verdict;
        /* A mark that is lost at the start makes a specimen that is refused. */
        if (!v->good)
            continue;
        n++;
        for (int k = 0; k < NUMBERS; k++) {
            covers[k] += v->low[k] <= v->truth[k] && v->truth[k] <= v->high[k];
            half[k] += 0.5 * (v->high[k] - v->low[k]) / v->truth[k];
        }
    }
    printf("type %d, %d campaigns of %d, coverage (mean half-width):", CAMPAIGN_TYPE, n,
           CAMPAIGN_SPECIMENS);
    for (int k = 0; k < NUMBERS; k++)
        printf("  %s %.0f (%.0f)", name_of(k), 100.0 * covers[k] / n, 100.0 * half[k] / n);
    printf(" %%\n");
    assert_true(n >= CAMPAIGNS - 10);
    assert_true(covers[0] >= 0.80 * n);
    for (int k = 2; k < NUMBERS; k++)
        assert_true(covers[k] >= 0.90 * n);
}

/* --- the stored recordings --- */

static void align_recording(struct wb_dataset *dataset, int type, int sample)
{
    struct wb_align_settings settings;
    char name[64], path[WB_PATH];
    snprintf(name, sizeof name, "recordings/type%d-L85-%d.wbr.zst", type, sample);
    assert_int_equal(wb_file_find_data(path, name), WB_OK);
    wb_align_default_settings(&settings);
    assert_int_equal(wb_align_run(dataset, path, &settings, NULL), WB_OK);
}

/* By the paper's equations: EI, residual_curvature_ratio, moments of Ludwik's law with isotropic
 * hardening. */
static void judge_by_the_paper(double *value, const struct wb_dataset *const *datasets, int n,
                               const double *curvature)
{
    struct wb_calibrate_settings settings;
    struct wb_calibrate_result result;
    struct wb_bending bending;
    struct wb_law law;
    const double diameter = datasets[0]->info.outer_diameter;
    wb_calibrate_default_settings(&settings);
    assert_int_equal(wb_calibrate_run(&result, datasets, n, &settings, NULL), WB_OK);
    wb_law_init_ludwik(&law, &result.material);
    assert_int_equal(wb_bending_describe(&law, diameter, curvature[WB_CYCLE_MOMENTS - 1], &bending),
                     WB_OK);
    assert_int_equal(wb_bending_moments(&law, diameter, WB_CYCLE_MOMENTS, curvature, value + 2),
                     WB_OK);
    value[0] = bending.flexural_rigidity;
    value[1] = bending.residual_curvature_ratio;
    wb_calibrate_result_release(&result);
}

/* Means of the logarithms of the specimens' truths, from the seeds that recordings/index.yaml
 * names. */
static void stored_truth(double *truth, int type, const double *curvature)
{
    for (int k = 0; k < NUMBERS; k++)
        truth[k] = 0.0;
    for (int i = 0; i < CAMPAIGN_SPECIMENS; i++) {
        double one[NUMBERS], residual;
        struct fast_rig fast;
        fast_rig_init(&fast, type, 85.0 * WB_MM, first_seed(type) + (uint64_t)i);
        fast_rig_truth(&fast, WB_CYCLE_MOMENTS, curvature, one + 2, one, &residual);
        one[1] = residual / curvature[WB_CYCLE_MOMENTS - 1];
        for (int k = 0; k < NUMBERS; k++)
            truth[k] += log(one[k]) / CAMPAIGN_SPECIMENS;
    }
    for (int k = 0; k < NUMBERS; k++)
        truth[k] = exp(truth[k]);
}

static void the_stored_recordings_come_out_as_they_are(void **unused)
{
    (void)unused;
    for (int t = 1; t <= TYPES; t++) {
        struct wb_dataset datasets[CAMPAIGN_SPECIMENS];
        const struct wb_dataset *list[CAMPAIGN_SPECIMENS];
        double paper[NUMBERS], truth[NUMBERS], curvature[WB_CYCLE_MOMENTS];
        struct job job;
        start_job(&job, t, first_seed(t));
        for (int i = 0; i < CAMPAIGN_SPECIMENS; i++) {
            align_recording(&datasets[i], t, i + 1);
            list[i] = &datasets[i];
        }
        judge(&job.verdict, &job.fast, list, CAMPAIGN_SPECIMENS, 0);
        assert_true(job.verdict.good);
        for (int k = 0; k < WB_CYCLE_MOMENTS; k++)
            curvature[k] = wb_cycle_moment_parts[k] * job.verdict.largest_curvature;
        stored_truth(truth, t, curvature);
        memcpy(job.verdict.truth, truth, sizeof truth);
        judge_by_the_paper(paper, list, CAMPAIGN_SPECIMENS, curvature);
        printf("type %d, stored recordings, L = 85 mm, off the truth by\n    the paper's:", t);
        for (int k = 0; k < NUMBERS; k++)
            printf("  %s %+.1f", name_of(k), 100.0 * (paper[k] / truth[k] - 1.0));
        printf(" %%\n    this:");
        for (int k = 0; k < NUMBERS; k++)
            printf("  %s %+.1f [%+.1f %+.1f]", name_of(k), 100.0 * error_of(&job.verdict, k),
                   100.0 * (job.verdict.low[k] / truth[k] - 1.0),
                   100.0 * (job.verdict.high[k] / truth[k] - 1.0));
        printf(" %%\n");
        for (int i = 0; i < CAMPAIGN_SPECIMENS; i++)
            wb_dataset_release(&datasets[i]);
        assert_close(error_of(&job.verdict, 0), 0.0, 0.06);
        for (int k = 2; k < NUMBERS; k++)
            assert_close(error_of(&job.verdict, k), 0.0, 0.02);
        assert_true(fabs(error_of(&job.verdict, 0)) < fabs(paper[0] / truth[0] - 1.0));
    }
}

/* The fast rig is the rig: points of both datasets of one seed. */
static void the_fast_rig_gives_what_the_rig_recorded(void **unused)
{
    (void)unused;
    for (int t = 1; t <= TYPES; t++) {
        struct wb_dataset recorded, fast_made;
        struct wb_cycle_data a, b;
        struct fast_rig fast;
        double squares = 0.0, expected = 0.0;
        int n = 0;
        align_recording(&recorded, t, 2);
        fast_rig_init(&fast, t, 85.0 * WB_MM, first_seed(t) + 1);
        fast.every_frame = 1;
        assert_int_equal(fast_rig_run(&fast, &fast_made), WB_OK);
        assert_int_equal(wb_cycle_data_take(&a, &recorded, NULL, NULL), WB_OK);
        assert_int_equal(wb_cycle_data_take(&b, &fast_made, NULL, NULL), WB_OK);
        assert_close(a.top, b.top, 0.3 * WB_MM);
        assert_close(a.zero_tension, b.zero_tension, 0.003 * a.max_force);
        assert_close(a.residual_deflection, b.residual_deflection, 0.15 * WB_MM);
        assert_close(wb_dataset_bow(&recorded.info), wb_dataset_bow(&fast_made.info), 0.3 * WB_MM);
        for (int i = 0; i < a.n_points; i++) {
            for (int k = 0; k + 1 < b.n_points; k++) {
                const struct wb_cycle_point *const p = &a.points[i], *const q = &b.points[k];
                const double part =
                    (p->deflection - q->deflection) / (q[1].deflection - q->deflection);
                if (p->is_unloading != q->is_unloading || q[1].is_unloading != q->is_unloading ||
                    !(part >= 0.0 && part < 1.0))
                    continue;
                const double off = p->tension - q->tension - part * (q[1].tension - q->tension);
                squares += off * off;
                expected += p->deviation * p->deviation + q->deviation * q->deviation;
                n++;
            }
        }
        printf("type %d, seed %d: the fast rig's %d points are %.3f %% of F_max off the recorded "
               "ones, their noise %.3f %%\n",
               t, (int)first_seed(t) + 1, n, 100.0 * sqrt(squares / n) / a.max_force,
               100.0 * sqrt(expected / n) / a.max_force);
        assert_true(n > 80);
        assert_true(sqrt(squares / n) < 0.0015 * a.max_force);
        wb_cycle_data_release(&a);
        wb_cycle_data_release(&b);
        wb_dataset_release(&recorded);
        wb_dataset_release(&fast_made);
    }
}

int main(void)
{
    gsl_set_error_handler_off();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_rigs_wires_come_out_as_they_are),
        cmocka_unit_test(no_wire_of_another_law_is_wrong_without_a_warning),
        cmocka_unit_test(other_lengths_are_predicted),
        cmocka_unit_test(intervals_cover_the_truth),
        cmocka_unit_test(the_stored_recordings_come_out_as_they_are),
        cmocka_unit_test(the_fast_rig_gives_what_the_rig_recorded),
    };
    wb_log_set_sink(discard_message, NULL);
    setvbuf(stdout, NULL, _IOLBF, 0);
    if (getenv("ONLY"))
        cmocka_set_test_filter(getenv("ONLY"));
    return cmocka_run_group_tests(tests, NULL, NULL);
}
