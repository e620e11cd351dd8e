/* Benchmark: a law fitted to loading and unloading of one specimen of the virtual rig, and the beam
 * runs that it is made of.
 *
 * Baseline in the same run: as many beam runs with a beam created for each, at the mesh of the
 * search, which is what an optimiser that starts a solver each time cannot avoid. */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "analysis/calibration/cycle_calibrate.h"
#include "analysis/calibration/cycle_model.h"
#include "base/units.h"
#include "fe/rod/fibres.h"
#include "fe/trial/loading_steps.h"
#include "tests/analysis/fast_rig.h"

enum {
    STEPS = 53,
    REPEATS = 25,
    FIBRES = 20
};

static const double default_goal_s = 0.3, table_goal_s = 1.5, load_goal_s = 3e-3,
                    both_goal_s = 5e-3;

static long updates; /* of sections */

void __real_wb_fibres_respond(const struct wb_fibres *fibres, double eps, double kappa,
                              const double *restrict before, double *restrict after,
                              struct wb_fibres_response *restrict response);
void __wrap_wb_fibres_respond(const struct wb_fibres *fibres, double eps, double kappa,
                              const double *restrict before, double *restrict after,
                              struct wb_fibres_response *restrict response);

void __wrap_wb_fibres_respond(const struct wb_fibres *fibres, double eps, double kappa,
                              const double *restrict before, double *restrict after,
                              struct wb_fibres_response *restrict response)
{
    updates++;
    __real_wb_fibres_respond(fibres, eps, kappa, before, after, response);
}

static double cpu_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
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
    long count[2] = {0, 0};
    int iterations = 0;
    both.cycles = 1;
    wb_cantilever_default_model(&model);
    WB_TRY(wb_section_init_law(&section, 1.25 * WB_MM, law, FIBRES));
    model.section = &section;
    model.length = 85.0 * WB_MM;
    WB_TRY(wb_cantilever_create(&beam, &model, NULL));
    WB_TRY(wb_loading_steps_init(&loading, &both));
    for (int i = 0; i < 2 * REPEATS; i++) {
        const double started = cpu_seconds();
        updates = 0;
        WB_TRY(wb_cantilever_set_law(beam, law));
        wb_cantilever_reset(beam);
        WB_TRY(wb_loading_steps_run(&loading, i % 2 ? &both : &load, beam));
        const double spent = cpu_seconds() - started;
        least[i % 2] = spent < least[i % 2] ? spent : least[i % 2];
        count[i % 2] = updates;
    }
    for (int i = 0; i < loading.n_rows; i++)
        iterations += loading.rows[i].point.iterations;
    printf("  %-28s %6.2f ms %6.2f ms   %5d iterations, %4.1f ns per fibre update\n", name,
           1e3 * least[0], 1e3 * least[1], iterations,
           1e9 * least[1] / ((double)count[1] * FIBRES));
    wb_loading_steps_release(&loading);
    wb_cantilever_destroy(beam);
    wb_section_release(&section);
    return WB_OK;
}

static double seconds_of_new_beams(const struct wb_cycle_data *data, const struct wb_law *law,
                                   const struct wb_cycle_fit_settings *settings, int runs)
{
    const struct wb_cycle_model_settings mesh = {settings->n_elements, settings->n_fibres};
    const struct wb_cycle_specimen specimen = {0.0, 0.0};
    double *const tension = calloc((size_t)data->n_points, sizeof *tension);
    const double started = cpu_seconds();
    for (int i = 0; i < runs && tension; i++) {
        struct wb_cycle_model *model;
        struct wb_cycle_run run;
        if (wb_cycle_model_create(&model, data, law, &mesh) != WB_OK)
            break;
        if (wb_cycle_model_run(model, law, &specimen, tension, NULL, &run) != WB_OK)
            break;
        wb_cycle_model_destroy(model);
    }
    const double spent = cpu_seconds() - started;
    free(tension);
    return spent;
}

static enum wb_status bench_fit(struct wb_law *found)
{
    struct fast_rig fast;
    struct wb_dataset dataset;
    struct wb_cycle_calibration c;
    struct wb_cycle_calibrate_settings settings;
    double spent[WB_CANDIDATES];
    int runs = 0;
    fast_rig_init(&fast, 2, 85.0 * WB_MM, 1);
    fast.every_frame = 1;
    WB_TRY(fast_rig_run(&fast, &dataset));
    const struct wb_dataset *const list[] = {&dataset};
    wb_cycle_calibrate_default_settings(&settings);
    settings.threads = 1;
    const double started = cpu_seconds();
    WB_TRY(wb_cycle_calibrate_run(&c, list, 1, &settings, NULL));
    const double table = cpu_seconds() - started;
    printf("one specimen of type 2, L = 85 mm, %d points, search with %d elements:\n",
           c.members[0].data.n_points, settings.fit.n_elements);
    for (int i = 0; i < WB_CANDIDATES; i++) {
        const struct wb_cycle_fit *const fit = &c.members[0].answers[i].fit;
        printf("  %-28s %5.2f s of CPU, %3d runs, %2d iterations, misfit %.3f %%\n",
               wb_candidate_name(i), fit->cpu_s, fit->runs, fit->iterations, 100.0 * fit->misfit);
        spent[i] = fit->cpu_s;
        runs += fit->runs;
    }
    const struct wb_cycle_fit *const best =
        &c.members[0].answers[WB_CANDIDATE_PARALLEL_KINEMATIC].fit;
    *found = best->law;
    printf("  default law by itself %.2f s (goal %g); whole table %.2f s, %d runs (goal %g)\n",
           spent[WB_CANDIDATE_PARALLEL_KINEMATIC], default_goal_s, table, runs, table_goal_s);
    const double baseline =
        seconds_of_new_beams(&c.members[0].data, found, &settings.fit, best->runs);
    printf("  baseline, a beam created for each run of the default law: %.2f s; ratio %.2f\n",
           baseline, baseline / spent[WB_CANDIDATE_PARALLEL_KINEMATIC]);
    wb_cycle_calibrate_release(&c);
    wb_dataset_release(&dataset);
    return WB_OK;
}

static enum wb_status bench(void)
{
    const struct wb_material material = {
        WB_HARDENING_ISOTROPIC_POWER, 5641e6, 0.39, 4.95e6, 850e6, 0.78};
    struct wb_law parts, mixed, ludwik;
    WB_TRY(bench_fit(&parts));
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
