/* CPU cost of taped bundles in explicit dynamics.
 *
 * - A step of seven wires that bend and yield: ns per hexahedron, the shares of wires, contact,
 * tape and cohesion, from runs without them; the baseline is the same wires without anything
 * between them. Two threads, and two processes at the same time. The same in double.
 * - The engineering run of seven wires, whole, in CPU time. Goal: 60 s.
 * - 27 wires on the engineering mesh, projected from the part of the run that shows the duration.
 *   Goal: 5 min on two cores.
 * - The paper's mesh of seven wires with f_m = 25 over 1 s, projected from 1 % of its steps. Goal:
 *   75 min on two cores. It is straight then: nothing has yielded or slipped.
 *
 * With names (`step`, `engineering`, `27`, `paper`) only these. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/file.h"
#include "fe/bundle/bundle_run.h"

enum {
    STEPS = 4000,
    ROUNDS = 3
};

/* The usual step is one of a fast bending to 53 mm, from where it has come to 17 mm. */
static const double bending = 0.3, bent_after = 0.12; /* s */

static struct wb_bundle_model model;

static double seconds(clockid_t clock)
{
    struct timespec now;
    clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static double cpu_now(void)
{
    return seconds(CLOCK_PROCESS_CPUTIME_ID);
}

static int read_model(const char *name)
{
    char path[WB_PATH];
    if (wb_file_find_fixture(path, "bundles", name, NULL) != WB_OK ||
        wb_bundle_model_read(&model, path) != WB_OK)
        return 1;
    model.loads.weight = false;
    model.loads.strand_length = 0.0;
    model.run.selective = 100.0;
    return 0;
}

static double hexahedra(const char *mesh)
{
    return (double)wb_bundle_model_hexahedra(&model, wb_bundle_model_mesh(&model, mesh));
}

/* --- a step --- */

/* Seconds on a clock that a step takes after some time (s), the least of some rounds; negative when
 * it fails. */
static double step_cost(clockid_t clock, const struct wb_bundle_settings *settings, double after,
                        int steps, int rounds, double *time_step)
{
    struct wb_bundle *bundle;
    double cost = -1.0;

    if (wb_bundle_create(&bundle, &model, settings) != WB_OK)
        return -1.0;
    *time_step = wb_bundle_time_step(bundle);
    wb_bundle_move_tip(bundle, model.run.deflection, settings->duration);
    if (wb_bundle_advance(bundle, (int)(after / *time_step), NULL) != WB_OK) {
        wb_bundle_destroy(bundle);
        return -1.0;
    }
    for (int round = 0; round <= rounds; round++) {
        const int n = round == 0 ? 1 + steps / 10 : steps;
        const double start = seconds(clock);
        if (wb_bundle_advance(bundle, n, NULL) != WB_OK) {
            cost = -1.0;
            break;
        }
        const double spent = (seconds(clock) - start) / n;
        if (round > 0 && (cost < 0.0 || spent < cost))
            cost = spent;
    }
    wb_bundle_destroy(bundle);
    return cost;
}

static double usual_cost(clockid_t clock, int threads)
{
    const struct wb_bundle_settings settings = {.duration = bending, .threads = threads};
    double time_step;
    return step_cost(clock, &settings, bent_after, STEPS, ROUNDS, &time_step);
}

/* Wall seconds of a step while a copy of this process makes the same steps. */
static double cost_beside_a_copy(void)
{
    fflush(stdout);
    const pid_t copy = fork();
    if (copy < 0)
        return -1.0;
    const double cost = usual_cost(CLOCK_MONOTONIC, 1);
    if (copy == 0)
        _exit(cost > 0.0 ? 0 : 1);
    int status = 1;
    waitpid(copy, &status, 0);
    return status == 0 ? cost : -1.0;
}

/* The same wires so far apart that they never touch. */
static void spread(void)
{
    for (int w = 0; w < model.packing.n; w++) {
        model.packing.wire[w].y *= 5.0;
        model.packing.wire[w].z *= 5.0;
    }
}

static int print_step(bool in_double)
{
    if (read_model("7-type3"))
        return 1;
    model.run.double_precision = in_double;
    const clockid_t cpu = CLOCK_PROCESS_CPUTIME_ID;
    const double n = hexahedra(model.run.mesh), whole = usual_cost(cpu, 1);
    const double one = usual_cost(CLOCK_MONOTONIC, 1), two = cost_beside_a_copy();
    const double threads = usual_cost(CLOCK_MONOTONIC, 2);
    model.has_tape = false;
    const double bare = usual_cost(cpu, 1);
    spread();
    const double alone = usual_cost(cpu, 1);
    if (whole < 0.0 || bare < 0.0 || alone < 0.0 || one < 0.0 || two < 0.0 || threads < 0.0)
        return 1;
    printf("a step of 7 wires, engineering mesh, %s: %.1f us, %.1f ns per hexahedron; wires %.0f "
           "%%, contact between them %.0f %%, tape and what joins it to them %.0f %%\n",
           in_double ? "double" : "float", 1e6 * whole, 1e9 * whole / n, 100.0 * alone / whole,
           100.0 * (bare - alone) / whole, 100.0 * (whole - bare) / whole);
    printf("  baseline, the same wires apart and without tape: %.1f us, %.1f ns per hexahedron, "
           "ratio %.2f\n",
           1e6 * alone, 1e9 * alone / n, whole / alone);
    printf("  wall time: one thread %.1f us, two threads %.1f us: %.2f times as fast; two "
           "processes at "
           "the same time %.1f us each: %.2f times the work\n",
           1e6 * one, 1e6 * threads, one / threads, 1e6 * two, 2.0 * one / two);
    return 0;
}

static int bench_step(void)
{
    return print_step(false) || print_step(true);
}

/* --- runs --- */

struct stop {
    double at;    /* share of an attempt after which it stops; above 1: never */
    double begin; /* s of CPU time: of the attempt */
    int attempt;
    double done; /* where it stopped */
};

static bool watch(void *context, const struct wb_bundle_progress *progress)
{
    struct stop *stop = context;
    if (progress->attempt != stop->attempt) {
        stop->attempt = progress->attempt;
        stop->begin = cpu_now();
    }
    stop->done = progress->done;
    return progress->done < stop->at;
}

/* A loading to the model's deflection on its mesh; CPU seconds, projected when it stopped. */
static double run_loading(struct wb_bundle_result *result, double stop_at)
{
    struct stop stop = {.at = stop_at};
    const struct wb_bundle_observer observer = {.progress = watch, .context = &stop};
    const struct wb_bundle_run_options options = {.observer = &observer};
    const double start = cpu_now();

    if (wb_bundle_run(result, &model, &options) != WB_OK || !result->converged) {
        printf("lost: %s\n", result->reason.text);
        return -1.0;
    }
    const double end = cpu_now();
    return result->stopped ? stop.begin - start + (end - stop.begin) / stop.done : end - start;
}

static int bench_loading(const char *name, double stop_at)
{
    struct wb_bundle_result result;
    if (read_model(name) || wb_bundle_result_init(&result, &model, 0) != WB_OK)
        return 1;
    const double cpu = run_loading(&result, stop_at);
    if (cpu > 0.0 && !result.stopped)
        printf("%d wires, engineering mesh, to %g mm: %.1f s of CPU time (goal: 60); %.2f s long "
               "after %d attempts, time step %.3g s, %lld steps in all, %.1f ns per hexahedron and "
               "step; balance within %.2g\n",
               model.packing.n, 1e3 * model.run.deflection, cpu, result.duration, result.attempts,
               result.time_step, result.all_steps,
               1e9 * cpu / ((double)result.all_steps * (double)result.hexahedra),
               result.largest.imbalance);
    else if (cpu > 0.0)
        printf(
            "%d wires, engineering mesh, to %g mm: %.0f s of CPU time projected, %.1f min on two "
            "cores if they share it evenly (goal: 5); %.2f s long, time step %.3g s\n",
            model.packing.n, 1e3 * model.run.deflection, cpu, cpu / 120.0, result.duration,
            result.time_step);
    wb_bundle_result_release(&result);
    return cpu > 0.0 ? 0 : 1;
}

/* --- the paper's mesh --- */

static int bench_paper(void)
{
    const struct wb_bundle_settings settings = {.mesh = "paper", .duration = 1.0};
    const struct wb_bundle_settings two_threads = {.mesh = "paper", .duration = 1.0, .threads = 2};
    const clockid_t cpu = CLOCK_PROCESS_CPUTIME_ID;
    double time_step;

    if (read_model("7-type3"))
        return 1;
    model.run.selective = 1.0;
    model.run.mass_scaling = 25.0;
    if (step_cost(cpu, &settings, 0.0, 1, 1, &time_step) < 0.0)
        return 1;
    const double steps = ceil(settings.duration / time_step), n = hexahedra("paper");
    const int some = (int)(0.01 * steps);
    const double cost = step_cost(cpu, &settings, 0.0, some / 10, 1, &time_step);
    const double wall = step_cost(CLOCK_MONOTONIC, &two_threads, 0.0, some, 1, &time_step);
    if (cost < 0.0 || wall < 0.0)
        return 1;
    printf(
        "7 wires, the paper's mesh, %.0f hexahedra, f_m = 25, %g s: time step %.3g s, %.3g steps, "
        "%.2f ms of CPU time and %.1f ns per hexahedron on one core; projected %.0f min on one "
        "core, %.0f min of wall time on two threads (goal: 75), %.0f min if they shared evenly\n",
        n, settings.duration, time_step, steps, 1e3 * cost, 1e9 * cost / n, cost * steps / 60.0,
        wall * steps / 60.0, cost * steps / 120.0);
    return 0;
}

int main(int argc, char **argv)
{
    static const char *const names[] = {"step", "engineering", "27", "paper"};
    int failed = 0;

    for (int i = 0; i < 4; i++) {
        bool wanted = argc < 2;
        for (int k = 1; k < argc; k++)
            wanted = wanted || strcmp(argv[k], names[i]) == 0;
        if (!wanted)
            continue;
        failed += i == 0   ? bench_step()
                  : i == 1 ? bench_loading("7-type3", 2.0)
                  : i == 2 ? bench_loading("27-type3", 0.25)
                           : bench_paper();
        fflush(stdout);
    }
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
