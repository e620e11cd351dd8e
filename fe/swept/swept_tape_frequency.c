#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vec3.h"
#include "fe/swept/swept_tape_private.h"

#define WB_LOG_DOMAIN "swept"

enum {
    UNKNOWNS = 24, /* 4 positions, then 4 directors */
    LENGTHS = WB_SWEPT_TAPE_N_MEASURES,
    ALL_MEASURES = LENGTHS + 4
};

/* The measures of swept_tape_kernel.c and the directors' lengths, all quadratic in `u`: the plain
 * version of what the kernel does. */
static void find_measures(const struct wb_swept_tape_element *element, const double *u, double *e)
{
    const double *B = element->B, *c = element->hourglass;
    double mode[8][3], a1[3], a2[3], d1[3], d2[3], hx[3], hd[3];

    for (int f = 0; f < 2; f++) {
        for (int i = 0; i < 3; i++) {
            const double *x = u + 12 * f + i;
            mode[4 * f][i] = 0.25 * (x[0] + x[3] + x[6] + x[9]);
            mode[4 * f + 1][i] = 0.5 * (x[3] - x[0] + x[9] - x[6]);
            mode[4 * f + 2][i] = 0.5 * (x[6] - x[0] + x[9] - x[3]);
            mode[4 * f + 3][i] = 0.5 * (x[9] - x[6] - x[3] + x[0]);
        }
    }
    const double *X1 = mode[1], *X2 = mode[2], *XH = mode[3];
    const double *D0 = mode[4], *D1 = mode[5], *D2 = mode[6], *DH = mode[7];
    for (int i = 0; i < 3; i++) {
        a1[i] = B[0] * X1[i];
        a2[i] = B[1] * X1[i] + B[2] * X2[i];
        d1[i] = B[0] * D1[i];
        d2[i] = B[1] * D1[i] + B[2] * D2[i];
        hx[i] = XH[i] - c[0] * a1[i] - c[1] * a2[i];
        hd[i] = DH[i] - c[0] * d1[i] - c[1] * d2[i];
    }
    const double shear[2] = {wb_vec3_dot(X1, D0) + 0.5 * wb_vec3_dot(XH, D2),
                             wb_vec3_dot(X2, D0) + 0.5 * wb_vec3_dot(XH, D1)};
    e[0] = 0.25 * (wb_vec3_dot(a1, a1) + wb_vec3_dot(a2, a2));
    e[1] = 0.25 * (wb_vec3_dot(a1, a1) - wb_vec3_dot(a2, a2));
    e[2] = 0.5 * wb_vec3_dot(a1, a2);
    e[3] = 0.5 * (wb_vec3_dot(a1, d1) + wb_vec3_dot(a2, d2));
    e[4] = 0.5 * (wb_vec3_dot(a1, d1) - wb_vec3_dot(a2, d2));
    e[5] = 0.5 * (wb_vec3_dot(a1, d2) + wb_vec3_dot(a2, d1));
    e[6] = B[0] * shear[0];
    e[7] = B[1] * shear[0] + B[2] * shear[1];
    e[8] = 0.5 * wb_vec3_dot(X1, D2) + wb_vec3_dot(XH, D0);
    e[9] = 0.5 * wb_vec3_dot(X2, D1) + wb_vec3_dot(XH, D0);
    e[10] = wb_vec3_dot(hx, a1);
    e[11] = wb_vec3_dot(hx, a2);
    e[12] = wb_vec3_dot(hd, a1);
    e[13] = wb_vec3_dot(hd, a2);
    for (int a = 0; a < 4; a++)
        e[LENGTHS + a] = 0.5 * wb_vec3_dot(u + 12 + 3 * a, u + 12 + 3 * a);
}

/* Stiffnesses of the measures. */
static void find_stiffnesses(const struct wb_swept_tape *tape,
                             const struct wb_swept_tape_element *element, double *k)
{
    const struct wb_swept_tape_kernel_model *m = &tape->numbers;
    const double V = element->area * tape->model.thickness;
    const double bent = tape->model.thickness / tape->model.sheets;
    const double *B = element->B;
    const double plane[2] = {B[0] * B[0] + B[1] * B[1], B[2] * B[2]};

    for (int i = 0; i < 3; i++) {
        k[i] = 2.0 * V * (i == 0 ? m->sum_modulus : m->difference_modulus);
        k[3 + i] = k[i] * bent * bent / 12.0;
    }
    for (int i = 0; i < 2; i++) {
        k[6 + i] = V * m->shear;
        k[8 + i] = V * m->shear / 3.0 * plane[i];
        k[10 + i] = V * m->membrane_hourglass * plane[i];
        k[12 + i] = V * m->bending_hourglass * plane[i];
    }
    for (int a = 0; a < 4; a++)
        k[LENGTHS + a] = 0.25 * V * m->shear;
}

/* The largest eigenvalue of M^-1 K with masses `mass`, `inertia` at each of its nodes. */
static enum wb_status element_eigenvalue(const struct wb_swept_tape *tape,
                                         const struct wb_swept_tape_element *element, double mass,
                                         double inertia, double *value)
{
    double u[UNKNOWNS], row[ALL_MEASURES][UNKNOWNS], k[ALL_MEASURES];
    double K[UNKNOWNS * UNKNOWNS] = {0.0}, values[UNKNOWNS], vector = 0.0;
    const double length = sqrt(element->area);
    lapack_int found = 0, ignored = 0;

    for (int a = 0; a < 4; a++) {
        memcpy(u + 3 * a, element->node[a], sizeof element->node[a]);
        memcpy(u + 12 + 3 * a, element->director[a], sizeof element->director[a]);
    }
    for (int b = 0; b < UNKNOWNS; b++) {
        /* Differences are exact for quadratic functions, but for round-off. */
        const double step = b < 12 ? 0.1 * length : 0.1, saved = u[b];
        double above[ALL_MEASURES], below[ALL_MEASURES];
        u[b] = saved + step;
        find_measures(element, u, above);
        u[b] = saved - step;
        find_measures(element, u, below);
        u[b] = saved;
        for (int i = 0; i < ALL_MEASURES; i++)
            row[i][b] = (above[i] - below[i]) / (2.0 * step * sqrt(b < 12 ? mass : inertia));
    }
    find_stiffnesses(tape, element, k);
    for (int i = 0; i < ALL_MEASURES; i++) {
        for (int a = 0; a < UNKNOWNS; a++) {
            for (int b = a; b < UNKNOWNS; b++)
                K[a * UNKNOWNS + b] += k[i] * row[i][a] * row[i][b];
        }
    }
    const lapack_int info =
        LAPACKE_dsyevx(LAPACK_ROW_MAJOR, 'N', 'I', 'U', UNKNOWNS, K, UNKNOWNS, 0.0, 0.0, UNKNOWNS,
                       UNKNOWNS, 0.0, &found, values, &vector, 1, &ignored);
    if (info != 0 || found != 1 || !(values[0] > 0.0 && isfinite(values[0])))
        return wb_fail(WB_ERR_CONVERGENCE, "the largest frequency of a tape's element: not found");
    *value = values[0] * (1.0 + 1e-9);
    return WB_OK;
}

/* Whether an element is the other moved and turned, to 1e-9. */
static bool is_same(const struct wb_swept_tape_element *a, const struct wb_swept_tape_element *b)
{
    for (int p = 0; p < 4; p++) {
        for (int q = 0; q < 4; q++) {
            double of_a[3], of_b[3];
            for (int i = 0; i < 3; i++) {
                of_a[i] = a->node[q][i] - a->node[0][i];
                of_b[i] = b->node[q][i] - b->node[0][i];
            }
            const double size = sqrt(wb_vec3_dot(of_a, of_a));
            if (!(fabs(size - sqrt(wb_vec3_dot(of_b, of_b))) <= 1e-9 * size) ||
                !(fabs(wb_vec3_dot(a->director[p], of_a) - wb_vec3_dot(b->director[p], of_b)) <=
                  1e-9 * size) ||
                !(fabs(wb_vec3_dot(a->director[p], a->director[q]) -
                       wb_vec3_dot(b->director[p], b->director[q])) <= 1e-9))
                return false;
        }
    }
    return fabs(a->area - b->area) <= 1e-9 * a->area &&
           fabs(a->B[0] - b->B[0]) <= 1e-9 * fabs(a->B[0]) &&
           fabs(a->B[1] - b->B[1]) <= 1e-9 * fabs(a->B[0]) &&
           fabs(a->B[2] - b->B[2]) <= 1e-9 * fabs(a->B[2]);
}

/* How much larger a node's share of the elements, at the most, is than what it is given: masses are
 * means over the stations. */
static enum wb_status largest_shares(const struct wb_swept_tape *tape, double *of_mass,
                                     double *of_inertia)
{
    const struct wb_swept_tape_model *m = &tape->model;
    const size_t stride = (size_t)m->layout.stride;
    double *share = calloc((size_t)m->layout.n_nodes * stride, sizeof *share);

    if (!share)
        return wb_fail(WB_ERR_MEMORY, "no memory for a tape");
    *of_mass = *of_inertia = 0.0;
    for (int k = 0; k < tape->numbers.n_elements; k++) {
        for (int j = 0; j < tape->numbers.n_along; j++) {
            struct wb_swept_tape_element e;
            (void)wb_swept_tape_element_of(tape, k, j, &e);
            for (int a = 0; a < 4; a++)
                share[(size_t)((k + a / 2) % m->layout.n_nodes) * stride + (size_t)(j + a % 2)] +=
                    0.25 * e.area * wb_swept_tape_gyration(tape, &e);
        }
    }
    for (int k = 0; k < m->layout.n_nodes; k++) {
        for (int j = 0; j < m->layout.n_stations; j++) {
            const size_t at = (size_t)k * stride + (size_t)j;
            const bool is_end = j == 0 || j == m->layout.n_stations - 1;
            const double factor = m->density * m->thickness / (m->spacing * (is_end ? 0.5 : 1.0));
            *of_mass = fmax(*of_mass, tape->area[at] * factor / tape->mass[k]);
            *of_inertia = fmax(*of_inertia, share[at] * factor / tape->inertia[k]);
        }
    }
    free(share);
    return WB_OK;
}

enum wb_status wb_swept_tape_stiffness_per_mass(const struct wb_swept_tape *tape, double *largest)
{
    double of_mass = 0.0, of_inertia = 0.0, most = 0.0;

    WB_TRY(largest_shares(tape, &of_mass, &of_inertia));
    for (int k = 0; k < tape->numbers.n_elements; k++) {
        struct wb_swept_tape_element before;
        for (int j = 0; j < tape->numbers.n_along; j++) {
            struct wb_swept_tape_element e;
            double value = 0.0;
            (void)wb_swept_tape_element_of(tape, k, j, &e);
            if (j > 0 && is_same(&before, &e))
                continue;
            before = e;
            const double mass = tape->model.density * tape->model.thickness * 0.25 * e.area;
            WB_TRY(element_eigenvalue(tape, &e, mass / of_mass,
                                      mass * wb_swept_tape_gyration(tape, &e) / of_inertia,
                                      &value));
            most = fmax(most, value);
        }
    }
    *largest = most;
    return WB_OK;
}
