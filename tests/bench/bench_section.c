/* Cost of taped bundles in the section model (fe/section/section_solver.h): CPU time on one core
 * for loading to 53 mm in 53 rows, the minimum of several rounds.
 *
 * - With symmetry about the plane of bending. Goals: 30 ms for 7 wires, 300 ms for 27 wires.
 * - Without use of the symmetry. Goals: 80 ms and 900 ms.
 * - A cycle of loading and unloading, and a bundle of twice the length with twice the elements;
 *   both relative to the loading.
 * - The explicit run of seven wires, relative to the section model; `quick` skips it. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "fe/bundle/bundle_run.h"
#include "fe/section/section_solver.h"
#include "tests/bench/clock.h"

enum {
    ROUNDS = 5
};

static struct wb_bundle_model model;

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

/* CPU seconds of loading (1 branch), or of loading and unloading (2); negative on failure. */
static double run_once(const struct wb_section_solver_settings *settings, int branches)
{
    const double start = cpu_seconds();
    const int rows = model.run.rows;
    struct wb_section_solver *solver;
    struct wb_section_solver_point point = {.end = WB_SECTION_SOLVER_CONVERGED};

    if (wb_section_solver_create(&solver, &model, settings) != WB_OK)
        return -1.0;
    for (int i = 0; i <= branches * rows && point.end == WB_SECTION_SOLVER_CONVERGED; i++) {
        const int step = i <= rows ? i : 2 * rows - i;
        wb_section_solver_move(solver, model.run.deflection * step / rows, &point);
    }
    wb_section_solver_destroy(solver);
    return point.end == WB_SECTION_SOLVER_CONVERGED ? cpu_seconds() - start : -1.0;
}

static double cost(const struct wb_section_solver_settings *settings, int branches)
{
    double least = (double)INFINITY;
    for (int i = 0; i < ROUNDS; i++)
        least = fmin(least, run_once(settings, branches));
    return least;
}

static double measure(const char *name, double goal_ms, double goal_whole_ms)
{
    const struct wb_section_solver_settings half = {.friction = 0.4};
    const struct wb_section_solver_settings whole = {.friction = 0.4, .beam.is_whole = true};
    const struct wb_section_solver_settings longer = {.friction = 0.4, .beam.n_elements = 48};

    if (read_model(name) != 0)
        return -1.0;
    const double loading = cost(&half, 1), without = cost(&whole, 1), cycle = cost(&half, 2);
    model.length *= 2.0;
    model.run.deflection *= 2.0;
    const double twice = cost(&longer, 1);
    printf("%-10s %6.1f ms (goal %g), without symmetry %6.1f ms (goal %g); relative to the "
           "loading: a cycle %.2f, twice the length and elements %.2f\n",
           name, 1e3 * loading, goal_ms, 1e3 * without, goal_whole_ms, cycle / loading,
           twice / loading);
    return loading;
}

int main(int argc, char **argv)
{
    struct wb_bundle_result result;
    const double seven = measure("7-type3", 30.0, 80.0);
    const double most = measure("27-type3", 300.0, 900.0);

    if (!(seven > 0.0 && most > 0.0))
        return 1;
    if (argc > 1 && strcmp(argv[1], "quick") == 0)
        return 0;
    if (read_model("7-type3") != 0 || wb_bundle_result_init(&result, &model, 0) != WB_OK)
        return 1;
    const double start = cpu_seconds();
    if (wb_bundle_run(&result, &model, NULL) != WB_OK)
        return 1;
    const double explicit_run = cpu_seconds() - start;
    printf("7-type3 in explicit dynamics: %.1f s, %.0f times the section model\n", explicit_run,
           explicit_run / seven);
    wb_bundle_result_release(&result);
    return 0;
}
