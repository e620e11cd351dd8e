/* The slow twin of fe/solid/solid_point.c, without eigenvectors: the logarithm of C by inverse
 * scaling and squaring in long double, the return mapping of small strains by bisection, the stress
 * by differences of E(F). */
#ifndef WB_TESTS_FE_SOLID_SOLID_POINT_TWIN_H
#define WB_TESTS_FE_SOLID_SOLID_POINT_TWIN_H

#include <math.h>
#include <string.h>

#include "fe/solid/solid_point.h"

typedef long double real;

static inline void multiply(real a[3][3], real b[3][3], real out[3][3])
{
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            out[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
    }
}

/* X with (I + X)^2 = I + A: X = A / 2 - X^2 / 2, which contracts for small A. */
static inline void root_excess(real A[3][3])
{
    real X[3][3], square[3][3];
    for (int i = 0; i < 9; i++)
        X[i / 3][i % 3] = A[i / 3][i % 3] / 2;
    for (int k = 0; k < 400; k++) {
        multiply(X, X, square);
        for (int i = 0; i < 9; i++)
            X[i / 3][i % 3] = (A[i / 3][i % 3] - square[i / 3][i % 3]) / 2;
    }
    for (int i = 0; i < 9; i++)
        A[i / 3][i % 3] = X[i / 3][i % 3];
}

/* Deviator of E = 1/2 ln(F^T F). F must be within a factor of 1.5 of a rotation. */
static inline void log_strain_deviator(real h[3][3], real E[3][3])
{
    enum {
        ROOTS = 5
    };
    real A[3][3], term[3][3], next[3][3];
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            A[i][j] = h[i][j] + h[j][i];
            for (int k = 0; k < 3; k++)
                A[i][j] += h[k][i] * h[k][j];
        }
    }
    for (int k = 0; k < ROOTS; k++)
        root_excess(A);
    memset(E, 0, 9 * sizeof E[0][0]);
    memcpy(term, A, sizeof term);
    for (int k = 1; k < 60; k++) {
        for (int i = 0; i < 9; i++)
            E[i / 3][i % 3] += (k % 2 ? 1 : -1) * term[i / 3][i % 3] / k;
        multiply(term, A, next);
        memcpy(term, next, sizeof term);
    }
    const real mean = (E[0][0] + E[1][1] + E[2][2]) / 3;
    for (int i = 0; i < 3; i++) {
        E[i][i] -= mean;
        for (int j = 0; j < 3; j++)
            E[i][j] *= (real)(1 << ROOTS) / 2;
    }
}

static inline void unpack(const double t[6], real out[3][3])
{
    static const int place[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
    for (int i = 0; i < 9; i++)
        out[i / 3][i % 3] = (real)t[place[i / 3][i % 3]];
}

/* T of the log space, and the increment of p. */
static inline real twin_log_stress(const struct wb_material *m, real E[3][3],
                                   const struct wb_solid_point_state *before, real T[3][3])
{
    const real mu = (real)m->youngs_modulus / (2 * (1 + (real)m->poissons_ratio));
    const real K = (real)m->strength_coefficient, n = (real)m->hardening_exponent;
    const real Y = (real)m->yield_stress, p0 = (real)before->accumulated;
    const bool kinematic = m->hardening == WB_HARDENING_KINEMATIC_LINEAR;
    real plastic[3][3], xi[3][3], size = 0, low = 0;

    unpack(before->plastic_strain, plastic);
    for (int i = 0; i < 9; i++) {
        const real p = plastic[i / 3][i % 3];
        T[i / 3][i % 3] = 2 * mu * (E[i / 3][i % 3] - p);
        xi[i / 3][i % 3] = T[i / 3][i % 3] - (kinematic ? 2 * K * p / 3 : 0);
        size += xi[i / 3][i % 3] * xi[i / 3][i % 3];
    }
    const real q = sqrtl(1.5L * size);
    if (m->hardening == WB_HARDENING_NONE_ELASTIC)
        return 0;
    real high = q / (3 * mu);
    for (int k = 0; k < 200; k++) {
        const real step = (low + high) / 2;
        const real hardening = kinematic ? K * step : K * powl(p0 + step, n);
        if (q - 3 * mu * step > Y + hardening)
            low = step;
        else
            high = step;
    }
    for (int i = 0; i < 9; i++)
        T[i / 3][i % 3] -= 3 * mu * low / q * xi[i / 3][i % 3];
    return low;
}

/* P = T : dE/dF by differences of fourth order, then tau = P F^T. */
static inline void twin_stress(const struct wb_material *m, const double h9[9],
                               const struct wb_solid_point_state *before, real tau[3][3])
{
    static const real weight[4] = {1, -8, 8, -1};
    static const int at[4] = {-2, -1, 1, 2};
    const real step = 1e-4L;
    real h[3][3], E[3][3], T[3][3], P[3][3];

    for (int i = 0; i < 9; i++)
        h[i / 3][i % 3] = (real)h9[i];
    log_strain_deviator(h, E);
    twin_log_stress(m, E, before, T);
    for (int i = 0; i < 9; i++) {
        P[i / 3][i % 3] = 0;
        for (int k = 0; k < 4; k++) {
            h[i / 3][i % 3] = (real)h9[i] + (real)at[k] * step;
            log_strain_deviator(h, E);
            for (int j = 0; j < 9; j++)
                P[i / 3][i % 3] += weight[k] / (12 * step) * T[j / 3][j % 3] * E[j / 3][j % 3];
        }
        h[i / 3][i % 3] = (real)h9[i];
    }
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            tau[i][j] = P[i][j];
            for (int k = 0; k < 3; k++)
                tau[i][j] += P[i][k] * h[j][k];
        }
    }
}

#endif
