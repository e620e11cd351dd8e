/* Solves a cantilever test and prints force over deflection, loading and unloading.
 *
 *     cc solve_cantilever.c $(pkg-config --cflags --libs wirebench) -o solve_cantilever
 *     ./solve_cantilever type1 0.085 0.05
 */
#include <stdio.h>
#include <stdlib.h>

#include <wirebench.h>

enum {
    STEPS = 10, /* of each branch */
    ROWS = 2 * STEPS + 1
};

static int fail(void)
{
    fprintf(stderr, "solve_cantilever: %s\n", wirebench_message());
    return 1;
}

int main(int argc, char **argv)
{
    struct wirebench_properties *properties = NULL;
    double deflection[ROWS], force[ROWS], moment[ROWS];
    if (argc != 4) {
        fprintf(stderr, "usage: solve_cantilever WIRE LENGTH DEFLECTION, in metres\n");
        return 2;
    }
    const double largest = strtod(argv[3], NULL);
    for (int i = 0; i < ROWS; i++)
        deflection[i] = largest * (i <= STEPS ? i : 2 * STEPS - i) / STEPS;

    const struct wirebench_cantilever test = {.size = sizeof test, .length = strtod(argv[2], NULL)};
    struct wirebench_cantilever_result result = {
        .size = sizeof result, .force = force, .root_moment = moment};
    int code = 0;
    if (wirebench_properties_read(&properties, argv[1]) < 0 ||
        wirebench_solve_cantilever(properties, &test, ROWS, deflection, &result) < 0)
        code = fail();
    if (code == 0) {
        printf("deflection_m,force_N,root_moment_Nm\n");
        for (size_t i = 0; i < result.n_done; i++)
            printf("%.9g,%.9g,%.9g\n", deflection[i], force[i], moment[i]);
        if (result.n_done < ROWS)
            fprintf(stderr, "solve_cantilever: %s\n", wirebench_message());
    }
    wirebench_properties_destroy(properties);
    return code;
}
