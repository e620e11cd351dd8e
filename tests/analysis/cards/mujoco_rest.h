/* Where a MuJoCo model rests: Newton's method with differences of the engine's own forces. */
#ifndef WB_TESTS_ANALYSIS_CARDS_MUJOCO_REST_H
#define WB_TESTS_ANALYSIS_CARDS_MUJOCO_REST_H

#include <mujoco/mujoco.h>
#include <stdlib.h>

#include "tests/check.h"

/* Unbalanced forces of the joints in the state of `d`. */
typedef void mujoco_residual(const void *context, const mjModel *m, mjData *d, double *residual);

/* Gauss without pivoting suffices for a stable equilibrium, where all pivots are positive; returns
 * the least one. */
static inline double mujoco_eliminate(int n, double *matrix, double *right)
{
    double least = (double)INFINITY;
    for (int p = 0; p < n; p++) {
        least = fmin(least, matrix[p * n + p]);
        for (int i = p + 1; i < n; i++) {
            const double factor = matrix[i * n + p] / matrix[p * n + p];
            for (int j = p; j < n; j++)
                matrix[i * n + j] -= factor * matrix[p * n + j];
            right[i] -= factor * right[p];
        }
    }
    for (int i = n - 1; i >= 0; i--) {
        for (int j = i + 1; j < n; j++)
            right[i] -= matrix[i * n + j] * right[j];
        right[i] /= matrix[i * n + i];
    }
    return least;
}

/* Moves the joints from their current angles to a stable equilibrium, within `tolerance` (rad). */
static inline void mujoco_rest(const mjModel *m, mjData *d, double tolerance,
                               mujoco_residual *find_residual, const void *context)
{
    const int n = m->nv;
    double *const matrix = malloc((size_t)(n * n) * sizeof *matrix);
    double *const residual = malloc((size_t)n * sizeof *residual);
    double *const moved = malloc((size_t)n * sizeof *moved);
    double largest = 1.0, least_pivot = 0.0;
    assert_non_null(matrix);
    assert_non_null(residual);
    assert_non_null(moved);
    for (int iteration = 0; iteration < 30 && largest > tolerance; iteration++) {
        find_residual(context, m, d, residual);
        for (int j = 0; j < n; j++) {
            double *const q = &d->qpos[j];
            const double angle = *q, step = 1e-7;
            *q = angle + step;
            find_residual(context, m, d, moved);
            *q = angle;
            for (int i = 0; i < n; i++)
                matrix[i * n + j] = (residual[i] - moved[i]) / step;
        }
        least_pivot = mujoco_eliminate(n, matrix, residual);
        largest = 0.0;
        for (int i = 0; i < n; i++) {
            d->qpos[i] += residual[i];
            largest = fmax(largest, fabs(residual[i]));
        }
    }
    free(matrix);
    free(residual);
    free(moved);
    assert_true(largest <= tolerance);
    assert_true(least_pivot > 0.0);
    mj_forward(m, d);
}

#endif
