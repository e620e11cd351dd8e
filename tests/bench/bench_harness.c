/* CPU time of an equilibrium of the shipped door harness, 3 m and about 210 nodes, on one core: the
 * steps of its file, elastic, with its own laws (Ludwik, isotropic), with the same kinematic, and
 * with parallel parts; and of ten times as many elements. The baseline is a planar cantilever of
 * the same number of nodes in the same run. Usage: bench_harness DOOR.yaml
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "analysis/harness/harness_run.h"
#include "fe/trial/loading_steps.h"
#include "tests/bench/clock.h"

enum {
    STEPS = 53,
    ELEMENTS = 105,
    REPEATS = 3
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
           "most "
           "11 times the time of an iteration\n");
    free(plan);
    return EXIT_SUCCESS;
}
