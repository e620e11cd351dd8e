/* Benchmark: a law fitted to loading and unloading of one specimen of the virtual rig, and the beam
 * runs that it is made of.
 *
 * Baseline in the same run: `calibrate --method paper` on the same specimen, which fits K and n of
 * Ludwik's law to the loading alone, with 50 elements in each run. */
#include <stdio.h>
#include <stdlib.h>

#include "analysis/calibration/cycle/cycle_calibrate.h"
#include "analysis/calibration/paper/calibrate.h"
#include "base/units.h"
#include "fe/trial/loading_steps.h"
#include "tests/analysis/fast_rig.h"
#include "tests/bench/clock.h"
#include "tests/twin/fibres_swap.h"

enum {
    STEPS = 53,
    REPEATS = 25,
    FIBRES = 20
};

static const double default_goal_s = 0.3, specimens_goal_s = 1.5, load_goal_s = 3e-3,
                    both_goal_s = 5e-3;

/* Time, and what was done in it. */
struct work {
    double started;
    long updates; /* of sections */
};

static struct work start_work(void)
{
    return (struct work){cpu_seconds(), section_updates};
}

static double seconds_of(const struct work *start)
{
    return cpu_seconds() - start->started;
}

/* Of `spent`, a fibre's share at each answer of its section, ns. */
static double ns_per_update(const struct work *start, double spent)
{
    return 1e9 * spent / ((double)(section_updates - start->updates) * FIBRES);
}

/* 53 steps of 1 mm up, and down again, with 50 elements. */
static enum wb_status bench_beam(const char *name, const struct wb_law *law)
{
    struct wb_section section;
    struct wb_cantilever_model model;
    struct wb_cantilever *beam;
    struct wb_loading_steps loading = {0};
    const struct wb_loading_steps_plan load = {.maximum = STEPS * WB_MM, .steps = STEPS};
    struct wb_loading_steps_plan both = load;
    double least[2] = {1e9, 1e9};
    double ns = 0.0;
    int iterations = 0;
    both.cycles = 1;
    wb_cantilever_default_model(&model);
    WB_TRY(wb_section_init_law(&section, 1.25 * WB_MM, law, FIBRES));
    model.section = &section;
    model.length = 85.0 * WB_MM;
    WB_TRY(wb_cantilever_create(&beam, &model, NULL));
    WB_TRY(wb_loading_steps_init(&loading, &both));
    for (int i = 0; i < 2 * REPEATS; i++) {
        const struct work start = start_work();
        WB_TRY(wb_cantilever_set_law(beam, law));
        wb_cantilever_reset(beam);
        WB_TRY(wb_loading_steps_run(&loading, i % 2 ? &both : &load, beam));
        const double spent = seconds_of(&start);
        least[i % 2] = spent < least[i % 2] ? spent : least[i % 2];
        ns = ns_per_update(&start, least[i % 2]);
    }
    for (int i = 0; i < loading.n_rows; i++)
        iterations += loading.rows[i].point.iterations;
    printf("  %-28s %6.2f ms %6.2f ms   %5d iterations, %4.1f ns per fibre update\n", name,
           1e3 * least[0], 1e3 * least[1], iterations, ns);
    wb_loading_steps_release(&loading);
    wb_cantilever_destroy(beam);
    wb_section_release(&section);
    return WB_OK;
}

/* The paper's route; returns its time. */
static enum wb_status bench_paper(const struct wb_dataset *dataset, double *spent)
{
    struct wb_calibrate_settings settings;
    struct wb_calibrate_result result;
    wb_calibrate_default_settings(&settings);
    const struct work start = start_work();
    WB_TRY(wb_calibrate_run(&result, &dataset, 1, &settings, NULL));
    *spent = seconds_of(&start);
    printf("  %-28s %5.2f s of CPU, %3d runs, %2d iterations, RMS %.3f %% (loading), %.1f ns per "
           "fibre update\n",
           "baseline: the paper's route", *spent, result.evaluations, result.n_path,
           100.0 * result.rms, ns_per_update(&start, *spent));
    wb_calibrate_result_release(&result);
    return WB_OK;
}

static enum wb_status bench_fit(struct wb_law *found)
{
    struct fast_rig fast;
    struct wb_dataset dataset;
    struct wb_cycle_calibration c;
    struct wb_cycle_calibrate_settings settings;
    double baseline;
    int runs = 0;
    fast_rig_init(&fast, 2, 85.0 * WB_MM, 1);
    fast.every_frame = 1;
    WB_TRY(fast_rig_run(&fast, &dataset));
    const struct wb_dataset *const list[] = {&dataset};
    wb_cycle_calibrate_default_settings(&settings);
    settings.threads = 1;
    const struct work start = start_work();
    WB_TRY(wb_cycle_calibrate_run(&c, list, 1, &settings, NULL));
    const double table = seconds_of(&start), ns = ns_per_update(&start, table);
    printf("one specimen of type 2, L = 85 mm, %d points, search with %d elements:\n",
           c.members[0].data.n_points, settings.fit.n_elements);
    for (int i = 0; i < WB_CANDIDATES; i++) {
        const struct wb_cycle_fit *const fit = &c.members[0].answers[i].fit;
        printf("  %-28s %5.2f s of CPU, %3d runs, %2d iterations, misfit %.3f %%\n",
               wb_candidate_name(i), fit->cpu_s, fit->runs, fit->iterations, 100.0 * fit->misfit);
        runs += fit->runs;
    }
    const struct wb_cycle_fit *const best =
        &c.members[0].answers[WB_CANDIDATE_PARALLEL_KINEMATIC].fit;
    *found = best->law;
    printf("  whole table %.2f s, %d runs, %.1f ns per fibre update\n", table, runs, ns);
    WB_TRY(bench_paper(&dataset, &baseline));
    printf("  default law by itself %.2f s (goal %g); baseline over it %.2f\n", best->cpu_s,
           default_goal_s, baseline / best->cpu_s);
    wb_cycle_calibrate_release(&c);
    wb_dataset_release(&dataset);
    return WB_OK;
}

/* What `calibrate` does by default with three specimens. */
static enum wb_status bench_specimens(void)
{
    enum {
        SPECIMENS = 3
    };
    struct wb_dataset datasets[SPECIMENS];
    const struct wb_dataset *list[SPECIMENS];
    struct wb_cycle_calibration c;
    struct wb_cycle_calibrate_settings settings;
    for (int i = 0; i < SPECIMENS; i++) {
        struct fast_rig fast;
        fast_rig_init(&fast, 1, 85.0 * WB_MM, 1 + (uint64_t)i);
        fast.every_frame = 1;
        WB_TRY(fast_rig_run(&fast, &datasets[i]));
        list[i] = &datasets[i];
    }
    wb_cycle_calibrate_default_settings(&settings);
    const struct work start = start_work();
    WB_TRY(wb_cycle_calibrate_run(&c, list, SPECIMENS, &settings, NULL));
    printf("three specimens of type 1, all candidates: %.2f s of CPU (goal %g)\n",
           seconds_of(&start), specimens_goal_s);
    wb_cycle_calibrate_release(&c);
    for (int i = 0; i < SPECIMENS; i++)
        wb_dataset_release(&datasets[i]);
    return WB_OK;
}

static enum wb_status bench(void)
{
    const struct wb_material material = {
        WB_HARDENING_ISOTROPIC_POWER, 5641e6, 0.39, 4.95e6, 850e6, 0.78};
    struct wb_law parts, mixed, ludwik;
    WB_TRY(bench_fit(&parts));
    WB_TRY(bench_specimens());
    printf("one beam, 50 elements, %d fibres, %d steps of 1 mm up, and down again (goal %.0f and "
           "%.0f ms):\n",
           FIBRES, STEPS, 1e3 * load_goal_s, 1e3 * both_goal_s);
    wb_law_init_ludwik(&ludwik, &material);
    WB_TRY(bench_beam("Ludwik, isotropic", &ludwik));
    ludwik.isotropic_share = 0.0;
    WB_TRY(bench_beam("Ludwik, kinematic", &ludwik));
    WB_TRY(bench_beam("parallel parts, kinematic", &parts));
    mixed = parts;
    mixed.isotropic_share = 0.5;
    return bench_beam("parallel parts, mixed", &mixed);
}

int main(void)
{
    return bench() == WB_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
