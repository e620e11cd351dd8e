/* Assembles a harness by the steps of its file and prints the forces on what is mounted; then it
 * undoes the last step and prints them again.
 *
 *     cc assemble_harness.c $(pkg-config --cflags --libs wirebench) -o assemble_harness
 *     ./assemble_harness small
 */
#include <stdio.h>

#include <wirebench.h>

static int fail(void)
{
    fprintf(stderr, "assemble_harness: %s\n", wirebench_message());
    return 1;
}

static int print_forces(struct wirebench_harness *harness)
{
    const struct wirebench_table *forces = NULL;
    struct wirebench_harness_info info = {.size = sizeof info};
    struct wirebench_column item = {.size = sizeof item}, force = {.size = sizeof force};
    if (wirebench_harness_describe(harness, &info) < 0 ||
        wirebench_harness_table(harness, "forces", &forces) < 0 ||
        wirebench_table_find(forces, "item", &item) < 0 ||
        wirebench_table_find(forces, "force_N", &force) < 0)
        return fail();
    for (size_t i = 0; i < force.n; i++)
        printf("%d,%s,%s,%.9g\n", info.state, info.step, item.texts[i], force.reals[i]);
    return 0;
}

int main(int argc, char **argv)
{
    struct wirebench_harness *harness = NULL;
    struct wirebench_harness_info info = {.size = sizeof info};
    int code = 0;
    if (argc != 2) {
        fprintf(stderr, "usage: assemble_harness HARNESS\n");
        return 2;
    }
    if (wirebench_harness_read(&harness, argv[1], NULL) < 0 ||
        wirebench_harness_describe(harness, &info) < 0)
        code = fail();
    if (code == 0)
        printf("state,step,item,force_N\n");
    for (int i = 0; code == 0 && i < info.n_steps; i++) {
        struct wirebench_harness_step step = {.size = sizeof step};
        if (wirebench_harness_planned_step(harness, i, &step) < 0 ||
            wirebench_harness_take_step(harness, &step) < 0)
            code = fail();
        else
            code = print_forces(harness);
    }
    if (code == 0 && wirebench_harness_undo(harness, 1) < 0)
        code = fail();
    if (code == 0)
        code = print_forces(harness);
    wirebench_harness_destroy(harness);
    return code;
}
