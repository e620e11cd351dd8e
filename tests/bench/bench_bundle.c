/* The engineering run of seven taped wires: CPU time (goal: below 60 s), ns per hexahedron and
 * step, and what each part of the bundle adds to a step, from runs of some thousand steps without
 * it. */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "base/file.h"
#include "fe/bundle_run.h"

enum {
    STEPS = 6000
};

static struct wb_bundle_model model;

static double cpu_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int read_model(void)
{
    char path[WB_PATH];
    if (wb_file_find_fixture(path, "bundles", "7-type3", NULL) != WB_OK ||
        wb_bundle_model_read(&model, path) != WB_OK)
        return 1;
    model.loads.weight = false;
    model.loads.strand_length = 0.0;
    model.run.selective = 100.0;
    return 0;
}

/* Seconds of CPU time a step takes; negative when it fails. */
static double step_cost(void)
{
    const struct wb_bundle_settings settings = {.duration = 1.0};
    struct wb_bundle *bundle;
    if (wb_bundle_create(&bundle, &model, &settings) != WB_OK)
        return -1.0;
    wb_bundle_lead(bundle, model.run.deflection, settings.duration);
    double cost = -1.0;
    if (wb_bundle_advance(bundle, STEPS / 10) == WB_OK) {
        const double start = cpu_now();
        if (wb_bundle_advance(bundle, STEPS) == WB_OK)
            cost = (cpu_now() - start) / STEPS;
    }
    wb_bundle_destroy(bundle);
    return cost;
}

/* The same wires so far apart that they never touch. */
static void spread(void)
{
    for (int w = 0; w < model.packing.n; w++) {
        model.packing.wire[w].y *= 5.0;
        model.packing.wire[w].z *= 5.0;
    }
}

static int bench_parts(void)
{
    const double whole = step_cost();
    const double hexahedra =
        (double)wb_bundle_model_hexahedra(&model, wb_bundle_model_mesh(&model, model.run.mesh));
    model.has_tape = false;
    const double bare = step_cost();
    spread();
    const double alone = step_cost();
    if (whole < 0.0 || bare < 0.0 || alone < 0.0)
        return 1;
    printf("a step: %.1f us, %.1f ns per hexahedron; wires %.0f %%, contact %.0f %%, tape and "
           "cohesion %.0f %%\n",
           1e6 * whole, 1e9 * whole / hexahedra, 100.0 * alone / whole,
           100.0 * (bare - alone) / whole, 100.0 * (whole - bare) / whole);
    return 0;
}

static int bench_run(void)
{
    struct wb_bundle_history history;
    if (wb_bundle_run_init(&history, &model, 0) != WB_OK)
        return 1;
    const double start = cpu_now();
    const enum wb_status status = wb_bundle_run(&history, &model, NULL, NULL);
    const double cpu = cpu_now() - start;
    if (status == WB_OK && history.converged)
        printf("a loading to %g mm: %.1f s of CPU time, %.2f s long after %d attempts, time step "
               "%.3g s, %lld steps in all, %.1f ns per hexahedron and step; balance within %.2g\n",
               1e3 * model.run.deflection, cpu, history.duration, history.attempts,
               history.time_step, history.all_steps,
               1e9 * cpu / ((double)history.all_steps * (double)history.hexahedra),
               history.largest.imbalance);
    else
        printf("lost: %s\n", history.problem);
    const int code = status == WB_OK && history.converged ? 0 : 1;
    wb_bundle_run_release(&history);
    return code;
}

int main(void)
{
    if (read_model() || bench_parts() || read_model())
        return 1;
    return bench_run();
}
