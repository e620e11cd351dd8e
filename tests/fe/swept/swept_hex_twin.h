/* The slow twin of fe/swept/swept_hex.c, in textbook form: 8-node elements one by one, nodes
 * gathered and forces scattered, shape functions in three dimensions, the complete deformation
 * gradient, the exact logarithm by eigenvectors, the yield stress by Newton's method; all in
 * double. Node fields are plain: [(station n_nodes + node) 3 + component]. */
#ifndef WB_TESTS_FE_SWEPT_SWEPT_HEX_TWIN_H
#define WB_TESTS_FE_SWEPT_SWEPT_HEX_TWIN_H

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "fe/swept/swept_hex.h"

struct twin_point {
    double plastic[3][3], accumulated;
};

struct twin_sums {
    double stored, artificial, plastic;
};

static const double twin_corner[8][3] = {{-1, -1, -1}, {-1, 1, -1}, {-1, 1, 1}, {-1, -1, 1},
                                         {1, -1, -1},  {1, 1, -1},  {1, 1, 1},  {1, -1, 1}};

/* Gradients of the eight shape functions with respect to the reference position, and of the field
 * (eta zeta); returns the map's determinant. Local coordinates: along the axis, and the section's
 * two. */
static inline double twin_gradients(const double X[8][3], const double at[3], double grad[8][3],
                                    double field[3])
{
    double J[3][3] = {{0.0}}, inverse[3][3], slope[8][3];
    for (int a = 0; a < 8; a++) {
        const double *c = twin_corner[a];
        const double f[3] = {1 + c[0] * at[0], 1 + c[1] * at[1], 1 + c[2] * at[2]};
        slope[a][0] = c[0] * f[1] * f[2] / 8;
        slope[a][1] = c[1] * f[2] * f[0] / 8;
        slope[a][2] = c[2] * f[0] * f[1] / 8;
        for (int i = 0; i < 9; i++)
            J[i / 3][i % 3] += X[a][i / 3] * slope[a][i % 3];
    }
    double det = 0.0;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        for (int l = 0; l < 3; l++) {
            const int m = (l + 1) % 3, n = (l + 2) % 3;
            inverse[l][i] = J[j][m] * J[k][n] - J[j][n] * J[k][m];
        }
        det += J[i][0] * inverse[0][i];
    }
    const double own[3] = {0.0, at[2], at[1]};
    for (int i = 0; i < 3; i++) {
        for (int a = 0; a < 8; a++) {
            grad[a][i] = 0.0;
            for (int l = 0; l < 3; l++)
                grad[a][i] += slope[a][l] * inverse[l][i] / det;
        }
        field[i] = 0.0;
        for (int l = 0; l < 3; l++)
            field[i] += own[l] * inverse[l][i] / det;
    }
    return det;
}

/* The reference element: mean gradients, volume, gradients on the four lines along the axis. */
struct twin_element {
    double volume, mean[8][3], hourglass[4][8], stiffness[4];
    double axial[4][8], weight[4];
};

static inline void twin_element_init(const struct wb_swept_hex_model *m, const double X[8][3],
                                     struct twin_element *e)
{
    static const double root = 0.57735026918962576451;
    const double E = m->material.youngs_modulus, mu = E / (2 * (1 + m->material.poissons_ratio));
    double slope = 0.0;

    memset(e, 0, sizeof *e);
    for (int p = 0; p < 8; p++) {
        const double at[3] = {root * twin_corner[p][0], root * twin_corner[p][1],
                              root * twin_corner[p][2]};
        double grad[8][3], field[3];
        const double det = twin_gradients(X, at, grad, field);
        e->volume += det;
        slope += det * (field[1] * field[1] + field[2] * field[2]);
        for (int i = 0; i < 24; i++)
            e->mean[i / 3][i % 3] += det * grad[i / 3][i % 3];
    }
    for (int i = 0; i < 24; i++)
        e->mean[i / 3][i % 3] /= e->volume;
    for (int q = 0; q < 4; q++) {
        const double at[3] = {0.0, root * twin_corner[q][1], root * twin_corner[q][2]};
        double grad[8][3], field[3];
        e->weight[q] = 8.0 * twin_gradients(X, at, grad, field) / 4.0 / e->volume;
        for (int a = 0; a < 8; a++)
            e->axial[q][a] = grad[a][0];
    }
    for (int f = 0; f < 4; f++) {
        double moment[3] = {0.0, 0.0, 0.0}, gamma[8];
        for (int a = 0; a < 8; a++) {
            const double *c = twin_corner[a];
            const double fields[4] = {c[1] * c[2], c[0] * c[1], c[0] * c[2], c[0] * c[1] * c[2]};
            gamma[a] = fields[f];
            for (int i = 0; i < 3; i++)
                moment[i] += gamma[a] * X[a][i];
        }
        for (int a = 0; a < 8; a++) {
            for (int i = 0; i < 3; i++)
                gamma[a] -= moment[i] * e->mean[a][i];
            e->hourglass[f][a] = gamma[a] / 8.0;
        }
    }
    const double h = m->element_length, c = m->hourglass, along = 4.0 * c * E * e->volume / (h * h);
    e->stiffness[0] = c * mu * slope;
    if (m->formulation == WB_SWEPT_HEX_ONE_POINT) {
        e->stiffness[1] = e->stiffness[2] = along / 3.0;
        e->stiffness[3] = along / 9.0;
    }
}

struct twin {
    struct wb_swept_hex_model model;
    struct twin_point *points;     /* (elements x quads x 4) */
    struct twin_element *elements; /* (quads) */
};

static inline void twin_destroy(struct twin *twin)
{
    free(twin->points);
    free(twin->elements);
}

static inline struct twin twin_create(const struct wb_swept_hex_model *model)
{
    const struct wb_swept_section *section = model->section;
    struct twin twin = {*model, NULL, NULL};

    if (twin.model.hourglass == 0.0)
        twin.model.hourglass = 0.05;
    twin.points = calloc((size_t)(4 * model->n_elements * section->n_quads), sizeof *twin.points);
    twin.elements = calloc((size_t)section->n_quads, sizeof *twin.elements);
    if (!twin.points || !twin.elements)
        abort();
    for (int q = 0; q < section->n_quads; q++) {
        double X[8][3];
        for (int a = 0; a < 8; a++) {
            const double *node = section->node[section->quad[q][a % 4]];
            X[a][0] = (a / 4) * model->element_length;
            X[a][1] = node[0];
            X[a][2] = node[1];
        }
        twin_element_init(&twin.model, (const double(*)[3])X, &twin.elements[q]);
    }
    return twin;
}

/* Eigenvalues and vectors (columns) of a symmetric matrix by Jacobi's rotations. */
static inline void twin_eigen(double A[3][3], double V[3][3])
{
    for (int i = 0; i < 9; i++)
        V[i / 3][i % 3] = i / 3 == i % 3;
    for (int sweep = 0; sweep < 30; sweep++) {
        for (int turn = 0; turn < 3; turn++) {
            const int p = turn == 2, q = turn == 0 ? 1 : 2;
            if (fabs(A[p][q]) < 1e-300)
                continue;
            const double theta = (A[q][q] - A[p][p]) / (2 * A[p][q]);
            const double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
            const double c = 1 / sqrt(t * t + 1), s = t * c;
            for (int k = 0; k < 3; k++) {
                const double x = A[k][p], y = A[k][q];
                A[k][p] = c * x - s * y;
                A[k][q] = s * x + c * y;
            }
            for (int k = 0; k < 3; k++) {
                const double x = A[p][k], y = A[q][k], v = V[k][p], w = V[k][q];
                A[p][k] = c * x - s * y;
                A[q][k] = s * x + c * y;
                V[k][p] = c * v - s * w;
                V[k][q] = s * v + c * w;
            }
        }
    }
}

struct twin_spectrum {
    double c[3], V[3][3]; /* of C */
};

static inline void twin_logarithm(double E[3][3], struct twin_spectrum *s, double L[3][3])
{
    double C[3][3];
    for (int i = 0; i < 9; i++)
        C[i / 3][i % 3] = 2 * E[i / 3][i % 3];
    twin_eigen(C, s->V); /* of C - 1, which keeps the digits of small strains */
    for (int k = 0; k < 3; k++)
        s->c[k] = C[k][k];
    for (int i = 0; i < 9; i++) {
        L[i / 3][i % 3] = 0.0;
        for (int k = 0; k < 3; k++)
            L[i / 3][i % 3] += 0.5 * log1p(s->c[k]) * s->V[i / 3][k] * s->V[i % 3][k];
    }
}

/* S = dL/dE : T. */
static inline void twin_pull_back(const struct twin_spectrum *s, double T[3][3], double S[3][3])
{
    double P[3][3] = {{0.0}};
    for (int a = 0; a < 9; a++) {
        for (int i = 0; i < 9; i++)
            P[a / 3][a % 3] += s->V[i / 3][a / 3] * T[i / 3][i % 3] * s->V[i % 3][a % 3];
        const double x = s->c[a / 3], y = s->c[a % 3];
        P[a / 3][a % 3] *=
            fabs(x - y) < 1e-9 ? 1 / (1 + 0.5 * (x + y)) : (log1p(x) - log1p(y)) / (x - y);
    }
    for (int i = 0; i < 9; i++) {
        S[i / 3][i % 3] = 0.0;
        for (int a = 0; a < 9; a++)
            S[i / 3][i % 3] += s->V[i / 3][a / 3] * P[a / 3][a % 3] * s->V[i % 3][a % 3];
    }
}

/* Returns a trial deviator to the yield surface; e becomes the elastic deviator. */
static inline void twin_return(const struct wb_material *m, struct twin_point *p, double e[3][3])
{
    const double three_mu = 1.5 * m->youngs_modulus / (1 + m->poissons_ratio);
    double square = 0.0;
    for (int i = 0; i < 9; i++) {
        e[i / 3][i % 3] -= p->plastic[i / 3][i % 3];
        square += e[i / 3][i % 3] * e[i / 3][i % 3];
    }
    const double size = sqrt(2.0 / 3.0 * square);
    if (m->hardening == WB_HARDENING_NONE_ELASTIC ||
        three_mu * size <=
            m->yield_stress + m->strength_coefficient * pow(p->accumulated, m->hardening_exponent))
        return;
    /* Newton's method with a bracket, bisected if a step leaves it or p is 0. */
    double low = 0.0, high = size, step = 0.0;
    for (int k = 0; k < 200; k++) {
        const double now = p->accumulated + step;
        const double hardening = m->strength_coefficient * pow(now, m->hardening_exponent);
        const double excess = three_mu * (size - step) - m->yield_stress - hardening;
        const double slope = three_mu + m->hardening_exponent * hardening / now;
        low = excess > 0.0 ? step : low;
        high = excess > 0.0 ? high : step;
        const double next = step + excess / slope, before = step;
        step = next > low && next < high ? next : 0.5 * (low + high);
        if (fabs(step - before) <= 1e-15 * size)
            break;
    }
    for (int i = 0; i < 9; i++) {
        p->plastic[i / 3][i % 3] += step / size * e[i / 3][i % 3];
        e[i / 3][i % 3] *= 1 - step / size;
    }
    p->accumulated += step;
}

static inline void twin_green(double F[3][3], double E[3][3])
{
    for (int i = 0; i < 9; i++) {
        E[i / 3][i % 3] = i / 3 == i % 3 ? -0.5 : 0.0;
        for (int k = 0; k < 3; k++)
            E[i / 3][i % 3] += 0.5 * F[k][i / 3] * F[k][i % 3];
    }
}

static inline double twin_plastic_work(const struct wb_material *m, double p)
{
    return m->yield_stress * p + m->strength_coefficient * pow(p, m->hardening_exponent + 1) /
                                     (m->hardening_exponent + 1);
}

/* f += dW/dF1 . axial for the vector dW/dF1. */
static inline void twin_add_axial(const double N[8], const double P[3], double f[8][3])
{
    for (int i = 0; i < 24; i++)
        f[i / 3][i % 3] += N[i / 3] * P[i % 3];
}

static inline void twin_element_forces(const struct wb_swept_hex_model *m,
                                       const struct twin_element *e, double x[8][3],
                                       struct twin_point *points, double f[8][3],
                                       struct twin_sums *sums)
{
    const struct wb_material *material = &m->material;
    const double mu = material->youngs_modulus / (2 * (1 + material->poissons_ratio));
    const double kappa = material->youngs_modulus / (3 * (1 - 2 * material->poissons_ratio));
    const bool one = m->formulation == WB_SWEPT_HEX_ONE_POINT;
    double F[3][3] = {{0.0}}, E[3][3], L[3][3], S[3][3], T[3][3] = {{0.0}}, P[3][3];
    struct twin_spectrum spectrum;

    for (int a = 0; a < 8; a++) {
        for (int i = 0; i < 9; i++)
            F[i / 3][i % 3] += x[a][i / 3] * e->mean[a][i % 3];
    }
    twin_green(F, E);
    twin_logarithm(E, &spectrum, L);
    const double trace = L[0][0] + L[1][1] + L[2][2];
    sums->stored += 0.5 * kappa * e->volume * trace * trace;
    double shared[3] = {0.0, 0.0,
                        0.0}; /* of axial strain and shears, which the points have individually */
    for (int q = 0; q < (one ? 1 : 4); q++) {
        const double volume = e->volume * (one ? 1.0 : e->weight[q]);
        double t[3][3], F1[3] = {0.0, 0.0, 0.0}, axial = 0.0;
        memcpy(t, L, sizeof t);
        for (int i = 0; i < 3; i++)
            t[i][i] -= trace / 3.0;
        if (!one) {
            for (int i = 0; i < 24; i++)
                F1[i % 3] += e->axial[q][i / 3] * x[i / 3][i % 3];
            double Eq[3] = {0.0, 0.0, 0.0};
            for (int i = 0; i < 3; i++) {
                Eq[0] += 0.5 * F1[i] * F1[i];
                Eq[1] += 0.5 * F1[i] * F[i][1];
                Eq[2] += 0.5 * F1[i] * F[i][2];
            }
            axial = Eq[0] - 0.5;
            const double extra = 0.5 * (log1p(2 * axial) - log1p(2 * E[0][0]));
            t[0][0] += extra;
            t[1][1] -= 0.5 * extra;
            t[2][2] -= 0.5 * extra;
            t[0][1] = t[1][0] = t[0][1] + Eq[1] - E[0][1];
            t[0][2] = t[2][0] = t[0][2] + Eq[2] - E[0][2];
        }
        twin_return(material, &points[q], t);
        sums->plastic += volume * twin_plastic_work(material, points[q].accumulated);
        for (int i = 0; i < 9; i++) {
            sums->stored += volume * mu * t[i / 3][i % 3] * t[i / 3][i % 3];
            t[i / 3][i % 3] *= 2 * mu * volume;
            T[i / 3][i % 3] += t[i / 3][i % 3];
        }
        if (one)
            continue;
        double P1[3];
        const double along = 1.5 * t[0][0] / (1 + 2 * axial);
        for (int i = 0; i < 3; i++) {
            P1[i] = along * F1[i] + t[0][1] * F[i][1] + t[0][2] * F[i][2];
            for (int a = 0; a < 8; a++)
                f[a][i] += e->mean[a][1] * t[0][1] * F1[i] + e->mean[a][2] * t[0][2] * F1[i];
        }
        twin_add_axial(e->axial[q], P1, f);
        shared[0] += 1.5 * t[0][0] / (1 + 2 * E[0][0]);
        shared[1] += t[0][1];
        shared[2] += t[0][2];
    }
    for (int i = 0; i < 3; i++)
        T[i][i] += kappa * e->volume * trace;
    twin_pull_back(&spectrum, T, S);
    S[0][0] -= shared[0];
    S[0][1] = S[1][0] = S[0][1] - shared[1];
    S[0][2] = S[2][0] = S[0][2] - shared[2];
    for (int i = 0; i < 9; i++) {
        P[i / 3][i % 3] = 0.0;
        for (int k = 0; k < 3; k++)
            P[i / 3][i % 3] += F[i / 3][k] * S[k][i % 3];
    }
    for (int i = 0; i < 24; i++) {
        for (int k = 0; k < 3; k++)
            f[i / 3][i % 3] += P[i % 3][k] * e->mean[i / 3][k];
    }
    for (int h = 0; h < 4; h++) {
        for (int i = 0; i < 3; i++) {
            double q = 0.0;
            for (int a = 0; a < 8; a++)
                q += e->hourglass[h][a] * x[a][i];
            sums->artificial += 0.5 * e->stiffness[h] * q * q;
            for (int a = 0; a < 8; a++)
                f[a][i] += e->stiffness[h] * q * e->hourglass[h][a];
        }
    }
}

/* Writes the negative derivatives of the energy to `force`. */
static inline struct twin_sums twin_forces(struct twin *twin, const double *position, double *force)
{
    const struct wb_swept_hex_model *m = &twin->model;
    const struct wb_swept_section *section = m->section;
    struct twin_sums sums = {0.0, 0.0, 0.0};

    memset(force, 0, 3 * (size_t)(section->n_nodes * (m->n_elements + 1)) * sizeof *force);
    for (int j = 0; j < m->n_elements; j++) {
        for (int q = 0; q < section->n_quads; q++) {
            double x[8][3], f[8][3] = {{0.0}};
            int node[8];
            for (int a = 0; a < 8; a++) {
                node[a] = (j + a / 4) * section->n_nodes + section->quad[q][a % 4];
                memcpy(x[a], position + 3 * node[a], sizeof x[a]);
            }
            twin_element_forces(m, &twin->elements[q], x,
                                twin->points + 4 * (j * section->n_quads + q), f, &sums);
            for (int i = 0; i < 24; i++)
                force[3 * node[i / 3] + i % 3] -= f[i / 3][i % 3];
        }
    }
    return sums;
}

#endif
