/* CPU time of an equilibrium of the shipped door harness, 3 m and about 210 nodes, on one core: the
 * steps of its file, elastic, with its own laws (Ludwik, isotropic), with the same kinematic, and
 * with parallel parts; of ten times as many elements; and a session of it: frames in which a
 * connector is dragged by 3 mm, and releases. The baseline is a planar cantilever of the same
 * number of nodes in the same run. Usage: bench_harness DOOR.yaml
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "analysis/harness/harness_session.h"
#include "fe/trial/loading_steps.h"
#include "tests/bench/clock.h"

enum {
    STEPS = 53,
    ELEMENTS = 105,
    REPEATS = 3,
    FRAMES = 200,
    ASSEMBLED = 8 /* steps of the file after which a connector is dragged */
};

struct timing {
    double mean; /* s of an equilibrium */
    int elements, increments, iterations;
};

static bool time_harness(struct wb_harness_plan *plan, const struct wb_harness_settings *settings,
                         struct timing *timing)
{
    *timing = (struct timing){.mean = (double)INFINITY};
    for (int k = 0; k < REPEATS; k++) {
        struct wb_harness_result_set set;
        int increments = 0, iterations = 0;
        const double start = cpu_seconds();
        const bool good = wb_harness_run_compute(&set, plan, settings, NULL, NULL) == WB_OK;
        const double spent = cpu_seconds() - start;
        for (int i = 0; good && i < set.n_steps; i++) {
            increments += set.results[i].increments;
            iterations += set.results[i].iterations;
        }
        const bool converged = good && set.converged;
        timing->elements = set.n_elements;
        timing->increments = increments;
        timing->iterations = iterations;
        timing->mean = fmin(timing->mean, spent / increments);
        wb_harness_run_release(&set);
        if (!converged)
            return false;
    }
    return true;
}

/* An increment of a cantilever of Ludwik's law. */
static double time_cantilever(void)
{
    const struct wb_material material = {
        WB_HARDENING_ISOTROPIC_POWER, 4528e6, 0.39, 4.52e6, 1327e6, 0.90};
    const struct wb_loading_steps_plan plan = {.maximum = 0.053, .steps = STEPS};
    struct wb_section section;
    struct wb_cantilever_model model;
    struct wb_cantilever *cantilever = NULL;
    struct wb_loading_steps loading = {0};
    double least = (double)INFINITY;

    wb_cantilever_default_model(&model);
    bool good = wb_section_init_circle(&section, 1.4e-3, &material, 20) == WB_OK;
    model.section = &section;
    model.length = 0.085;
    model.n_elements = ELEMENTS;
    good = good && wb_cantilever_create(&cantilever, &model, NULL) == WB_OK &&
           wb_loading_steps_init(&loading, &plan) == WB_OK;
    for (int i = 0; good && i < REPEATS; i++) {
        const double start = cpu_seconds();
        wb_cantilever_reset(cantilever);
        good = wb_loading_steps_run(&loading, &plan, cantilever) == WB_OK && loading.converged;
        least = fmin(least, (cpu_seconds() - start) / STEPS);
    }
    wb_loading_steps_release(&loading);
    wb_cantilever_destroy(cantilever);
    wb_section_release(&section);
    return good ? least : (double)NAN;
}

static void print(const char *what, const struct timing *t, double base)
{
    printf("%-34s %4d elements %5d equilibria %4.1f iterations %8.3f ms %8.1f\n", what, t->elements,
           t->increments, (double)t->iterations / t->increments, 1e3 * t->mean, t->mean / base);
}

struct times {
    double worst, sum; /* s */
    int n;
};

static void print_times(const char *what, const struct times *t, double base)
{
    printf("%-38s %4d times, mean %8.3f ms %8.1f, worst %8.3f ms %8.1f\n", what, t->n,
           1e3 * t->sum / t->n, t->sum / t->n / base, 1e3 * t->worst, t->worst / base);
}

/* Takes a step and adds its time; false if it has no equilibrium. */
static bool time_step(struct wb_harness_session *session, const struct wb_harness_step *step,
                      struct times *times)
{
    struct wb_reason why = {""};
    const char *key;
    const double start = cpu_seconds();
    if (wb_harness_session_step(session, step, NULL, NULL, &key, &why) != WB_OK)
        return false;
    const double spent = cpu_seconds() - start;
    times->worst = fmax(times->worst, spent);
    times->sum += spent;
    times->n++;
    return wb_harness_session_state(session)->result.end == WB_HARNESS_CONVERGED;
}

/* Drags a connector along a circle and back to where it was. */
static bool drag(struct wb_harness_session *session, const struct wb_harness_step *from,
                 struct times *times)
{
    const double frame = 3e-3, radius = FRAMES * frame / (4.0 * M_PI);
    bool good = true;
    for (int i = 1; good && i <= FRAMES; i++) {
        struct wb_harness_step step = *from;
        step.kind = WB_HARNESS_MOVE;
        step.has_direction = step.has_up = false;
        step.position[0] += radius * (cos(4.0 * M_PI * i / FRAMES) - 1.0);
        step.position[1] += radius * sin(4.0 * M_PI * i / FRAMES);
        good = time_step(session, &step, times);
    }
    return good;
}

/* Releases each clip and connector of the assembled harness, from the same state. */
static bool release_each(struct wb_harness_session *session, const struct wb_harness_plan *plan,
                         struct times *times)
{
    struct wb_reason why = {""};
    bool good = true;
    for (int i = 1; good && i < plan->n_items; i++) {
        const struct wb_harness_step step = {.kind = WB_HARNESS_RELEASE, .item = i};
        good =
            time_step(session, &step, times) && wb_harness_session_undo(session, 1, &why) == WB_OK;
    }
    return good;
}

static bool time_session(const struct wb_harness_plan *plan,
                         const struct wb_harness_settings *settings, double base)
{
    struct wb_harness_session *session;
    struct times steps = {0}, frames = {0}, releases = {0};
    if (wb_harness_session_create(&session, plan, settings) != WB_OK)
        return false;
    bool good = true;
    for (int i = 0; good && i < ASSEMBLED; i++)
        good = time_step(session, &plan->steps[i], &steps);
    good = good && release_each(session, plan, &releases) &&
           drag(session, &plan->steps[ASSEMBLED - 1], &frames);
    wb_harness_session_destroy(session);
    if (!good)
        return false;
    print_times("a frame: a connector dragged by 3 mm", &frames, base);
    print_times("a release", &releases, base);
    return true;
}

int main(int argc, char **argv)
{
    struct wb_harness_plan *const plan = calloc(1, sizeof *plan);
    const struct wb_harness_settings yielding = {.torsion = 1.0};
    const struct wb_harness_settings elastic = {.torsion = 1.0, .is_elastic = true};
    struct wb_harness_settings fine = yielding;
    const double base = time_cantilever();
    struct timing t;
    if (argc < 2 || !plan || !isfinite(base) || wb_harness_file_read(plan, argv[1]) != WB_OK)
        return EXIT_FAILURE;
    for (int w = 0; w < plan->n_wires; w++) /* one run, without a softer torsion */
        plan->wires[w].torsional_stiffness = wb_harness_run_torsion(plan, w, &yielding);

    printf("planar cantilever (base), %d elements: %.3f ms an equilibrium\n", ELEMENTS, 1e3 * base);
    if (!time_harness(plan, &elastic, &t))
        return EXIT_FAILURE;
    print("elastic", &t, base);
    if (!time_harness(plan, &yielding, &t))
        return EXIT_FAILURE;
    print("Ludwik, isotropic", &t, base);
    if (!time_session(plan, &yielding, base))
        return EXIT_FAILURE;
    fine.element_length = 3.0 / (10 * t.elements);
    if (!time_harness(plan, &fine, &t))
        return EXIT_FAILURE;
    print("ten times the elements", &t, base);
    for (int w = 0; w < plan->n_wires; w++)
        plan->wires[w].law.isotropic_share = 0.0;
    if (!time_harness(plan, &yielding, &t))
        return EXIT_FAILURE;
    print("Ludwik, kinematic", &t, base);
    for (int w = 0; w < plan->n_wires; w++) {
        const double E = plan->wires[w].law.material.youngs_modulus;
        const struct wb_law_part parts[] = {{0.25 * E, 7e-4}, {0.2 * E, 1.5e-3},
                                            {0.15 * E, 4e-3}, {0.1 * E, 9e-3},
                                            {0.1 * E, 2e-2},  {0.2 * E, (double)INFINITY}};
        wb_law_init_parallel(&plan->wires[w].law, parts, 6, 0.0, 0.39);
    }
    if (!time_harness(plan, &yielding, &t))
        return EXIT_FAILURE;
    print("six parallel parts, kinematic", &t, base);
    printf("goals: 1.0 ms (parallel parts), 2.0 ms (Ludwik, kinematic); ten times the elements at "
           "most 11 times the time of an iteration; a frame 16 ms, a release 50 ms, at worst\n");
    free(plan);
    return EXIT_SUCCESS;
}
