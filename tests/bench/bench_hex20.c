/* CPU time per element on one core: 20-node hexahedra of a power-law material, rotated by half a
 * radian, all points yielding or all unloading. The baseline is the slow twin in the same run: full
 * B^T c B, point by point. 64 elements are evaluated in turn, as in the mesh of a body. */
#include <stdio.h>
#include <stdlib.h>

#include "tests/bench/clock.h"
#include "tests/fe/solid/hex20_cases.h"
#include "tests/fe/solid/hex20_twin.h"

enum {
    ELEMENTS = 64,
    REPEATS = 40
};

struct element {
    struct wb_hex20_geometry geometry;
    double u[60];
    struct wb_solid_point_state before[27], after[27];
};

static const struct wb_material material = {
    WB_HARDENING_ISOTROPIC_POWER, 68.2e9, 0.34, 182e6, 600e6, 0.4};

static bool make_element(struct element *e, enum wb_integration integration)
{
    struct wb_solid_point_state virgin[27] = {{{0.0}}};
    struct wb_hex20_result result;
    double position[20][3], force[60];

    make_nodes(0.1, position);
    make_displacement(position, 0.0, 0.01, 1e-6, e->u);
    if (!make_geometry(&e->geometry, integration, position) ||
        !wb_hex20_evaluate(&e->geometry, integration, &material, e->u, virgin, e->before, force,
                           NULL, &result))
        return false;
    make_displacement(position, 0.5, 0.01, 1e-6, e->u);
    return wb_hex20_evaluate(&e->geometry, integration, &material, e->u, e->before, e->after, force,
                             NULL, &result);
}

enum what {
    FORCE,
    STIFFNESS,
    TWIN
};

/* Least microseconds an element of all repeats; from the state after (no yielding) or before. */
static double time_elements(struct element *elements, enum wb_integration integration,
                            bool yielding, enum what what)
{
    static double K[3600];
    struct wb_solid_point_state after[27];
    struct wb_hex20_result result;
    double force[60], best = 1e9;
    int yields = 0;

    for (int repeat = 0; repeat < REPEATS; repeat++) {
        const double start = cpu_seconds();
        for (int i = 0; i < ELEMENTS; i++) {
            struct element *e = &elements[i];
            const struct wb_solid_point_state *before = yielding ? e->before : e->after;
            bool good;
            if (what == TWIN)
                good = twin_evaluate(&e->geometry, wb_hex20_points(integration), false, &material,
                                     e->u, before, after, force, K);
            else
                good = wb_hex20_evaluate(&e->geometry, integration, &material, e->u, before, after,
                                         force, what == STIFFNESS ? K : NULL, &result);
            yields += what != TWIN && result.yielding > 0;
            if (!good)
                return (double)NAN;
        }
        const double spent = (cpu_seconds() - start) * 1e6 / ELEMENTS;
        best = spent < best ? spent : best;
    }
    return what == TWIN || yields == (yielding ? ELEMENTS * REPEATS : 0) ? best : (double)NAN;
}

int main(void)
{
    static const char *const names[] = {"selective", "reduced"};
    struct element *elements = calloc(ELEMENTS, sizeof *elements);
    bool good = elements != NULL;

    printf("one evaluation of a 20-node hexahedron, CPU microseconds on one core\n\n"
           "                          forces   and stiffness   slow twin   ratio to the twin\n");
    for (int k = 0; good && k < 2; k++) {
        const enum wb_integration integration =
            k == 0 ? WB_INTEGRATION_SELECTIVE : WB_INTEGRATION_REDUCED;
        srand(1);
        for (int i = 0; good && i < ELEMENTS; i++)
            good = make_element(&elements[i], integration);
        for (int yielding = 0; good && yielding < 2; yielding++) {
            const double force = time_elements(elements, integration, yielding, FORCE);
            const double stiffness = time_elements(elements, integration, yielding, STIFFNESS);
            const double twin = time_elements(elements, integration, yielding, TWIN);
            good = force > 0.0 && stiffness > 0.0 && twin > 0.0;
            printf("%-10s %-10s %10.1f %15.1f %11.1f %19.3f\n", names[k],
                   yielding ? "yielding" : "elastic", force, stiffness, twin, stiffness / twin);
        }
    }
    free(elements);
    if (!good) {
        fprintf(stderr, "the benchmark's elements did not do what they should\n");
        return EXIT_FAILURE;
    }
    printf("\ngoal, selective: at most 25 without and 50 with stiffness\n");
    return EXIT_SUCCESS;
}
