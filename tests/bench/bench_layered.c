/* Time of the linear systems of 3D wires: assembly, factorisation and solution, on one thread,
 * compared with LAPACK's band solvers on the same matrix in the same run. The matrices have the
 * sparsity pattern of swept meshes, with 60 elements along the wire unless stated otherwise, and
 * random entries, symmetric or not. */
#include <cblas.h>
#include <lapacke.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fe/linear/layered.h"
#include "fe/linear/layered_private.h"
#include "fe/solid/solid_mesh.h"
#include "tests/bench/clock.h"

enum {
    UNKNOWNS = 60, /* of an element */
    RIGHT = 10     /* right-hand sides: the residual and nine of the tip */
};

struct problem {
    const char *title;
    struct wb_solid_mesh_wire wire;
    bool has_band; /* LAPACK's band solvers can hold it */
    int repeats;
};

struct timing {
    double add, factor, solve, solve_ten, solve_last; /* s, least of the repeats */
    double band_factor, band_solve;
    double operations, memory, band_memory, difference;
    int n, n_elements, band, most; /* half-band, unknowns of the largest block */
};

static void keep_least(double *least, double start)
{
    const double spent = cpu_seconds() - start;
    if (*least == 0.0 || spent < *least)
        *least = spent;
}

static double random_number(uint64_t *state)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) * 0x1p-53;
}

/* Unknowns of an element; the clamped section is left out. */
static void element_unknowns(const struct wb_solid_mesh *mesh, int e, int *index)
{
    for (int k = 0; k < UNKNOWNS; k++) {
        const int node = mesh->element[e][k / 3] - mesh->layer[1];
        index[k] = node < 0 ? -1 : 3 * node + k % 3;
    }
}

static void make_element(bool symmetric, double *matrix)
{
    uint64_t state = 1;
    for (int i = 0; i < UNKNOWNS; i++) {
        for (int j = 0; j <= i; j++) {
            const double value = random_number(&state) - 0.5;
            matrix[i * UNKNOWNS + j] = value;
            matrix[j * UNKNOWNS + i] = symmetric ? value : random_number(&state) - 0.5;
        }
        matrix[i * UNKNOWNS + i] += 20.0;
    }
}

static struct wb_layered *make_layered(const struct wb_solid_mesh *mesh, bool symmetric)
{
    struct wb_layered *layered = NULL;
    int *first = calloc((size_t)mesh->n_layers + 1, sizeof *first);
    int *link = calloc((size_t)mesh->n_layers, sizeof *link);
    if (first && link) {
        for (int l = 1; l <= mesh->n_layers; l++)
            first[l] = 3 * (mesh->layer[l] - mesh->layer[1]);
        for (int l = 1; l + 1 < mesh->n_layers; l++)
            link[l] = 3 * (mesh->link[l] - mesh->layer[1]);
        if (wb_layered_create(&layered, mesh->n_layers, first, link, symmetric) != WB_OK)
            layered = NULL;
    }
    free(first);
    free(link);
    return layered;
}

static void assemble(struct wb_layered *layered, const struct wb_solid_mesh *mesh,
                     const double *matrix)
{
    int index[UNKNOWNS];
    for (int e = 0; e < mesh->n_elements; e++) {
        element_unknowns(mesh, e, index);
        wb_layered_add(layered, UNKNOWNS, index, matrix);
    }
}

static bool time_layered(const struct problem *problem, const struct wb_solid_mesh *mesh,
                         bool symmetric, double *x, struct timing *t)
{
    double matrix[UNKNOWNS * UNKNOWNS];
    struct wb_layered *layered = make_layered(mesh, symmetric);
    if (!layered)
        return false;
    make_element(symmetric, matrix);

    struct wb_layered_pivots pivots = {0};
    for (int i = 0; i < problem->repeats && !pivots.singular; i++) {
        double start = cpu_seconds();
        wb_layered_clear(layered);
        assemble(layered, mesh, matrix);
        keep_least(&t->add, start);
        start = cpu_seconds();
        wb_layered_factor(layered, &pivots);
        keep_least(&t->factor, start);
        for (int k = 0; k < RIGHT * t->n; k++)
            x[k] = 1.0;
        start = cpu_seconds();
        wb_layered_solve(layered, RIGHT, x);
        keep_least(&t->solve_ten, start);
        memset(x, 0, sizeof(double) * RIGHT * (size_t)t->n);
        start = cpu_seconds();
        wb_layered_solve_last(layered, RIGHT - 1, x);
        keep_least(&t->solve_last, start);
        for (int k = 0; k < t->n; k++)
            x[k] = 1.0;
        start = cpu_seconds();
        wb_layered_solve(layered, 1, x);
        keep_least(&t->solve, start);
    }
    t->operations = wb_layered_operations(layered);
    t->memory = (double)wb_layered_memory(layered);
    wb_layered_destroy(layered);
    return !pivots.singular;
}

/* The element's entries in LAPACK's band storage (symmetric: lower half). */
static void add_band(const struct timing *t, bool symmetric, const int *index, const double *matrix,
                     double *band)
{
    const ptrdiff_t rows = symmetric ? t->band + 1 : 3 * t->band + 1;
    for (int i = 0; i < UNKNOWNS; i++) {
        for (int j = 0; j < UNKNOWNS; j++) {
            const int row = index[i], column = index[j];
            if (row < 0 || column < 0 || (symmetric && row < column))
                continue;
            const ptrdiff_t place = row - column + (symmetric ? 0 : 2 * t->band);
            band[column * rows + place] += matrix[i * UNKNOWNS + j];
        }
    }
}

static bool time_band(const struct problem *problem, const struct wb_solid_mesh *mesh,
                      bool symmetric, const double *x, struct timing *t)
{
    const int rows = symmetric ? t->band + 1 : 3 * t->band + 1, n = t->n;
    const size_t size = (size_t)rows * (size_t)n;
    double matrix[UNKNOWNS * UNKNOWNS], *band = malloc(size * sizeof *band);
    double *y = malloc((size_t)n * sizeof *y);
    lapack_int *pivots = malloc((size_t)n * sizeof *pivots);
    bool good = band && y && pivots;
    make_element(symmetric, matrix);
    t->band_memory = (double)size * sizeof *band;
    for (int i = 0; good && i < problem->repeats; i++) {
        memset(band, 0, size * sizeof *band);
        for (int e = 0; e < mesh->n_elements; e++) {
            int index[UNKNOWNS];
            element_unknowns(mesh, e, index);
            add_band(t, symmetric, index, matrix, band);
        }
        for (int k = 0; k < n; k++)
            y[k] = 1.0;
        const int m = t->band;
        double start = cpu_seconds();
        good = (symmetric
                    ? LAPACKE_dpbtrf_work(LAPACK_COL_MAJOR, 'L', n, m, band, rows)
                    : LAPACKE_dgbtrf_work(LAPACK_COL_MAJOR, n, n, m, m, band, rows, pivots)) == 0;
        keep_least(&t->band_factor, start);
        start = cpu_seconds();
        good = good &&
               (symmetric ? LAPACKE_dpbtrs_work(LAPACK_COL_MAJOR, 'L', n, m, 1, band, rows, y, n)
                          : LAPACKE_dgbtrs_work(LAPACK_COL_MAJOR, 'N', n, m, m, 1, band, rows,
                                                pivots, y, n)) == 0;
        keep_least(&t->band_solve, start);
    }
    for (int k = 0; good && k < n; k++) {
        const double difference = x[k] > y[k] ? x[k] - y[k] : y[k] - x[k];
        t->difference = difference > t->difference ? difference : t->difference;
    }
    free(band);
    free(y);
    free(pivots);
    return good;
}

static void print_timing(const struct problem *problem, bool symmetric, const struct timing *t)
{
    printf(
        "%s, %s: %d unknowns, %d elements, blocks of %d, half-band %d\n"
        "  clear and add %.4f s (%.2f us an element of 60 x 60), %.0f MB\n"
        "  factor %.4f s (%.1f GFlop/s), solve %.4f s, %d at once %.4f s, %d of the tip %.4f s\n",
        problem->title, symmetric ? "symmetric" : "general", t->n, t->n_elements, t->most, t->band,
        t->add, 1e6 * t->add / t->n_elements, 1e-6 * t->memory, t->factor,
        1e-9 * t->operations / t->factor, t->solve, RIGHT, t->solve_ten, RIGHT - 1, t->solve_last);
    if (problem->has_band)
        printf("  LAPACK's %s: factor %.4f s, solve %.4f s, %.0f MB; ours / LAPACK: factor %.2f, "
               "solve %.2f; largest difference %.1e\n",
               symmetric ? "dpbtrf, dpbtrs" : "dgbsv (dgbtrf, dgbtrs)", t->band_factor,
               t->band_solve, 1e-6 * t->band_memory, t->factor / t->band_factor,
               t->solve / t->band_solve, t->difference);
}

static bool time_problem(const struct problem *problem)
{
    struct wb_solid_mesh mesh = {0};
    bool good = true;
    if (wb_solid_mesh_sweep(&mesh, &problem->wire) != WB_OK)
        return false;
    for (int symmetric = 1; good && symmetric >= 0; symmetric--) {
        struct timing t = {.n = 3 * (mesh.n_nodes - mesh.layer[1]), .n_elements = mesh.n_elements};
        for (int l = 1; l < mesh.n_layers; l++) {
            const int n = 3 * (mesh.layer[l + 1] - mesh.layer[l]);
            const int reach = l + 1 < mesh.n_layers ? 3 * (mesh.layer[l + 2] - mesh.link[l]) : n;
            t.most = n > t.most ? n : t.most;
            t.band = reach - 1 > t.band ? reach - 1 : t.band;
        }
        double *x = malloc(sizeof(double) * RIGHT * (size_t)t.n);
        good = x && time_layered(problem, &mesh, symmetric, x, &t) &&
               (!problem->has_band || time_band(problem, &mesh, symmetric, x, &t));
        free(x);
        if (good)
            print_timing(problem, symmetric, &t);
    }
    wb_solid_mesh_release(&mesh);
    return good;
}

int main(void)
{
    const struct problem problems[] = {
        {"one part, density 1", {0.085, 1, {2.8e-3, 0.0}, 60, 1, 0}, true, 5},
        {"two parts, density 1", {0.1, 2, {3.26e-3, 4.86e-3}, 60, 1, 0}, true, 3},
        {"two parts, split, density 1", {0.1, 2, {3.26e-3, 4.86e-3}, 60, 1, 1}, false, 3},
        {"two parts, density 2, 20 elements along",
         {0.033, 2, {3.26e-3, 4.86e-3}, 20, 2, 0},
         false,
         2},
    };
    printf("linear systems of swept wires, one core (OpenBLAS: %s), CPU s\n\n",
           openblas_get_corename());
    for (size_t i = 0; i < sizeof problems / sizeof problems[0]; i++) {
        if (!time_problem(&problems[i])) {
            fprintf(stderr, "%s: no memory, or no solution\n", problems[i].title);
            return EXIT_FAILURE;
        }
    }
    printf("\ngoal, one part: symmetric factor at most 0.04 s, general at most 0.09 s, 5 us an "
           "element\n");
    return EXIT_SUCCESS;
}
