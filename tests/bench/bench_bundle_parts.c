/* Speedup by threads and ranks: wall time of a step of seven taped wires, on one part and on two
 * (threads of this process, or the ranks started by mpirun), with the same bundle (strong scaling)
 * and with a bundle of twice the length (weak scaling). A model extrapolates to more parts: it adds
 * the CPU time of a step of the largest part and the time of an exchange of packets, each measured
 * separately.
 *
 * Each time is the minimum of several blocks of steps, measured alternately, because other load on
 * the machine only adds time. Wall times are too long on a busy machine, the model's CPU times
 * are not. */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "base/file.h"
#include "fe/bundle/bundle.h"
#include "fe/bundle/bundle_part.h"
#include "fe/bundle/bundle_private.h"
#include "fe/team/team.h"

enum {
    BLOCKS = 10,
    ROUNDS = 2000
};

static struct wb_bundle_model model;
static int steps; /* of a block */

static double now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static int read_model(const char *mesh)
{
    char path[WB_PATH];
    if (wb_file_find_fixture(path, "bundles", "7-type3", NULL) != WB_OK ||
        wb_bundle_model_read(&model, path) != WB_OK)
        return 1;
    model.loads.weight = false;
    model.loads.strand_length = 0.0;
    snprintf(model.run.mesh, sizeof model.run.mesh, "%s", mesh);
    steps = wb_bundle_model_mesh(&model, mesh)->elements_along > 200 ? 20 : 200;
    return 0;
}

/* The same elements on a bundle so many times as long. */
static void lengthen(int times)
{
    for (int i = 0; i < model.n_meshes; i++)
        model.mesh[i].elements_along *= times;
    model.length *= times;
    model.run.deflection *= times;
}

static int make(struct wb_bundle **out, int threads)
{
    const struct wb_bundle_settings settings = {.duration = 1.0, .threads = threads};
    if (wb_bundle_create(out, &model, &settings) != WB_OK)
        return 1;
    wb_bundle_move_tip(*out, model.run.deflection, settings.duration);
    return wb_bundle_advance(*out, steps, NULL) != WB_OK;
}

/* Least seconds of a step in a block. */
static int time_block(struct wb_bundle *bundle, double *best)
{
    const double start = now();
    if (wb_bundle_advance(bundle, steps, NULL) != WB_OK)
        return 1;
    *best = fmin(*best, (now() - start) / steps);
    return 0;
}

/* Packets of so many numbers, there and back. */
struct swaps {
    struct wb_team *team;
};

static void swap(void *context, int member)
{
    struct wb_team *team = ((struct swaps *)context)->team;
    for (int i = 0; i < ROUNDS; i++) {
        wb_team_post(team, member);
        (void)wb_team_await(team, member, WB_TEAM_BEFORE);
        (void)wb_team_await(team, member, WB_TEAM_AFTER);
    }
}

static double swap_time(int threads, size_t numbers)
{
    struct swaps swaps;
    double best = (double)INFINITY;
    if (wb_team_create(&swaps.team, threads, numbers) != WB_OK)
        return (double)NAN;
    for (int i = 0; i < 5; i++) {
        const double start = now();
        wb_team_run(swaps.team, swap, &swaps);
        best = fmin(best, (now() - start) / ROUNDS);
    }
    wb_team_destroy(swaps.team);
    return best;
}

static double cpu_now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

/* CPU seconds of a step of the largest of so many parts, alone: the first so many stations. Those
 * of its halo rest, which costs what it costs when they move. */
static double part_time(const struct wb_bundle *whole, const char *mesh, int parts)
{
    const int n = wb_bundle_parts_largest(&model, mesh, parts);
    struct wb_bundle_part *part;
    double best = (double)INFINITY;

    if (n == 0 || wb_bundle_part_create(&part, wb_bundle_whole(whole), 0, n,
                                        (struct wb_swept_range){0, n}) != WB_OK)
        return (double)NAN;
    for (int i = 0; i < BLOCKS; i++) {
        const double start = cpu_now();
        for (int k = 0; k < steps; k++)
            if (wb_bundle_part_step(part, k == steps - 1) != WB_OK)
                best = (double)NAN;
        best = fmin(best, (cpu_now() - start) / steps);
    }
    wb_bundle_part_destroy(part);
    return best;
}

/* Seconds of a step on one part and on two, with a bundle `longer` times as long on two. */
static int measure(const char *mesh, int threads, int longer, double *one, double *two,
                   size_t *bytes)
{
    struct wb_bundle *bundle[2] = {NULL, NULL};
    const bool alone = wb_team_ranks() == 1;
    int failed;

    *one = *two = (double)INFINITY;
    if (read_model(mesh))
        return 1;
    /* A rank cannot be alone while others wait: one part is measured without mpirun. */
    failed = alone && make(&bundle[0], 1);
    static struct wb_bundle_model shorter;
    shorter = model;
    if (!failed && longer > 1) {
        for (int i = 0; alone && i < BLOCKS && !failed; i++)
            failed = time_block(bundle[0], one);
        wb_bundle_destroy(bundle[0]);
        bundle[0] = NULL;
        lengthen(longer);
    }
    failed = failed || make(&bundle[1], threads);
    for (int i = 0; i < BLOCKS && !failed; i++)
        failed = (bundle[0] && time_block(bundle[0], one)) || time_block(bundle[1], two);
    if (!failed)
        *bytes = wb_bundle_parts_bytes(wb_bundle_whole(bundle[1]));
    wb_bundle_destroy(bundle[0]);
    wb_bundle_destroy(bundle[1]);
    model = shorter;
    return failed;
}

/* A bundle that is longer by a length for each part: all but the two at its ends have a neighbour
 * on both sides, so that it does not matter how many there are. */
static void print_weak_model(const char *mesh, double one, double swapped)
{
    enum {
        PARTS = 3
    };
    const struct wb_bundle_settings settings = {.duration = 1.0};
    static struct wb_bundle_model shorter;
    struct wb_bundle *whole;

    shorter = model;
    lengthen(PARTS);
    if (wb_bundle_create(&whole, &model, &settings) == WB_OK) {
        const double of_part = part_time(whole, mesh, PARTS), sum = of_part + swapped;
        printf(
            "  weak, %d parts or more, each as long as the whole above: %d stations, %.2f us and a "
            "swap, efficiency %.2f\n",
            PARTS, wb_bundle_parts_largest(&model, mesh, PARTS), 1e6 * of_part, one / sum);
        wb_bundle_destroy(whole);
    }
    model = shorter;
}

static void print_model(const char *mesh, double latency, double swapped)
{
    const struct wb_bundle_settings settings = {.duration = 1.0};
    struct wb_bundle *whole;

    if (read_model(mesh) || wb_bundle_create(&whole, &model, &settings) != WB_OK)
        return;
    const double one = part_time(whole, mesh, 1);
    printf("  model: a step of the whole %.2f us of CPU time, a swap %.2f us (%.2f us without "
           "data)\n",
           1e6 * one, 1e6 * swapped, 1e6 * latency);
    for (int parts = 2; parts <= 32 && wb_bundle_parts_largest(&model, mesh, parts); parts *= 2) {
        const double of_part = part_time(whole, mesh, parts), sum = of_part + swapped;
        printf("  %2d parts of %3d stations: %8.2f us and a swap, %5.2f times as fast, efficiency "
               "%.2f\n",
               parts, wb_bundle_parts_largest(&model, mesh, parts), 1e6 * of_part, one / sum,
               one / sum / parts);
    }
    wb_bundle_destroy(whole);
    print_weak_model(mesh, one, swapped);
}

int main(void)
{
    static const char *const meshes[] = {"engineering", "paper"};
    int failed = wb_team_start() != WB_OK;
    const int ranks = wb_team_ranks(), threads = ranks > 1 ? 1 : 2;
    const bool prints = wb_team_rank() == 0;

    for (int m = 0; m < 2 && !failed; m++) {
        double one, two, longer_one, longer_two;
        size_t bytes = 0;
        failed = measure(meshes[m], threads, 1, &one, &two, &bytes);
        if (failed)
            break;
        const double latency = swap_time(threads, 0);
        const double swapped = swap_time(threads, bytes / sizeof(double));
        failed = measure(meshes[m], threads, 2, &longer_one, &longer_two, &bytes);
        if (!prints || failed)
            continue;
        printf("%s mesh, %d stations, %zu kB to a neighbour and step:\n", meshes[m],
               wb_bundle_parts_largest(&model, meshes[m], 1), bytes / 1000);
        if (ranks == 1) {
            printf("  strong: 1 part %.2f us a step, 2 threads %.2f us: %.2f times as fast\n",
                   1e6 * one, 1e6 * two, one / two);
            printf("  weak: 1 part %.2f us, twice the length on 2 threads %.2f us: efficiency "
                   "%.2f\n",
                   1e6 * longer_one, 1e6 * longer_two, longer_one / longer_two);
            print_model(meshes[m], latency, swapped);
        } else {
            printf("  %d ranks: %.2f us a step; twice the length %.2f us; a swap %.2f us (%.2f us "
                   "without data)\n",
                   ranks, 1e6 * two, 1e6 * longer_two, 1e6 * swapped, 1e6 * latency);
        }
    }
    wb_team_end();
    return failed;
}
