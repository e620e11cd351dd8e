#include "fe/swept/swept_frequency.h"

#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "fe/swept/swept_private.h"

#define WB_LOG_DOMAIN "swept"

/* A linear function of an element's displacements: by station, corner, component. */
struct row {
    double at[2][4][3];
};

static struct row combine(double a, const struct row *x, double b, const struct row *y)
{
    struct row out;
    for (int i = 0; i < 24; i++)
        (&out.at[0][0][0])[i] = a * (&x->at[0][0][0])[i] + b * (&y->at[0][0][0])[i];
    return out;
}

/* Component `i` of the axial gradient with shape functions `N` over the section. */
static struct row along(const double N[4], double h, int i)
{
    struct row out = {{{{0.0}}}};
    for (int a = 0; a < 4; a++) {
        out.at[0][a][i] = -N[a] / h;
        out.at[1][a][i] = N[a] / h;
    }
    return out;
}

/* Component `i` of the mean gradient, or another weighted sum, over the section. */
static struct row across(const double B[4], int i)
{
    struct row out = {{{{0.0}}}};
    for (int a = 0; a < 4; a++)
        out.at[0][a][i] = out.at[1][a][i] = 0.5 * B[a];
    return out;
}

struct assembly {
    const int *quad;
    int n_nodes;
    double *stiffness;
};

/* Adds the energy weight / 2 (row u)^2. */
static void add_square(const struct assembly *to, double weight, const struct row *row)
{
    const size_t n = 6 * (size_t)to->n_nodes;

    for (int i = 0; i < 24; i++) {
        const double left = weight * (&row->at[0][0][0])[i];
        if (left == 0.0)
            continue;
        const size_t p = (size_t)(3 * (i / 12 * to->n_nodes + to->quad[i / 3 % 4]) + i % 3);
        for (int j = 0; j < 24; j++) {
            const size_t q = (size_t)(3 * (j / 12 * to->n_nodes + to->quad[j / 3 % 4]) + j % 3);
            to->stiffness[p * n + q] += left * (&row->at[0][0][0])[j];
        }
    }
}

/* Adds the deviator of the mean strain plus its variation over the section at one point. */
static void add_point(const struct assembly *to, double k, const struct row mean[6],
                      const struct row *axial, const struct row shear[2])
{
    const struct row middle = combine(1.0 / 3.0, &mean[1], 1.0 / 3.0, &mean[2]);
    const struct row third = combine(1.0, &middle, 1.0 / 3.0, &mean[0]);
    const struct row extra = combine(1.0, axial, -1.0, &mean[0]);

    for (int i = 0; i < 3; i++) {
        const struct row deviator = combine(1.0, &mean[i], -1.0, &third);
        const struct row row = combine(1.0, &deviator, i == 0 ? 1.0 : -0.5, &extra);
        add_square(to, k, &row);
    }
    add_square(to, 2.0 * k, &shear[0]);
    add_square(to, 2.0 * k, &shear[1]);
    add_square(to, 2.0 * k, &mean[5]);
}

static void add_hourglass(const struct assembly *to, const struct wb_swept_quad *quad,
                          const double k[4])
{
    static const double field[3][4] = {
        {-0.25, 0.25, 0.25, -0.25}, {-0.25, -0.25, 0.25, 0.25}, {0.25, -0.25, 0.25, -0.25}};
    double gamma[4];

    for (int a = 0; a < 4; a++)
        gamma[a] = quad->hourglass[a];
    for (int i = 0; i < 3; i++) {
        const struct row plane = across(gamma, i);
        add_square(to, k[0], &plane);
        for (int f = 0; f < 3 && k[1] > 0.0; f++) {
            const struct row row = along(field[f], 1.0, i);
            add_square(to, k[1 + f], &row);
        }
    }
}

static void add_element(const struct wb_swept_hex *hex, int e, const struct assembly *to)
{
    const struct wb_swept_hex_model *m = wb_swept_hex_get_model(hex);
    const double nu = m->material.poissons_ratio, E = m->material.youngs_modulus;
    const double two_mu = E / (1.0 + nu), kappa = E / (3.0 * (1.0 - 2.0 * nu));
    const double h = m->element_length;
    struct wb_swept_quad quad;
    double k[4];
    struct row mean[6], shear[2];

    wb_swept_section_quad(m->section, e, &quad);
    wb_swept_hex_hourglass(hex, e, k);
    const double volume = quad.area * h;
    mean[0] = along(quad.mean, h, 0);
    for (int i = 0; i < 2; i++) {
        const struct row axial = along(quad.mean, h, 1 + i), plane = across(quad.gradient[i], 0);
        mean[1 + i] = across(quad.gradient[i], 1 + i);
        mean[3 + i] = combine(0.5, &axial, 0.5, &plane);
    }
    const struct row zy = across(quad.gradient[0], 2), yz = across(quad.gradient[1], 1);
    mean[5] = combine(0.5, &zy, 0.5, &yz);

    const struct row sides = combine(1.0, &mean[1], 1.0, &mean[2]);
    const struct row trace = combine(1.0, &mean[0], 1.0, &sides);
    add_square(to, kappa * volume, &trace);
    add_hourglass(to, &quad, k);
    if (m->formulation == WB_SWEPT_HEX_ONE_POINT) {
        add_point(to, two_mu * volume, mean, &mean[0], &mean[3]);
        return;
    }
    for (int q = 0; q < 4; q++) {
        const struct row axial = along(quad.value[q], h, 0);
        for (int i = 0; i < 2; i++) {
            const struct row bend = along(quad.value[q], h, 1 + i);
            const struct row plane = across(quad.gradient[i], 0);
            shear[i] = combine(0.5, &bend, 0.5, &plane);
        }
        add_point(to, two_mu * volume * quad.weight[q], mean, &axial, shear);
    }
}

void wb_swept_frequency_layer(const struct wb_swept_hex *hex, double *stiffness)
{
    const struct wb_swept_section *section = wb_swept_hex_get_model(hex)->section;

    for (int e = 0; e < section->n_quads; e++) {
        const struct assembly to = {section->quad[e], section->n_nodes, stiffness};
        add_element(hex, e, &to);
    }
}

/* K to M'^-1/2 K M'^-1/2, for both sides of one station's degrees of freedom of one component. With
 * u the unit vector of the roots of the masses, M^-1/2 M' M^-1/2 = beta + (1 - beta) u u^T, whose
 * inverse root is beta^-1/2 + (1 - beta^-1/2) u u^T. */
static void scale_lines(double *K, size_t n, size_t step, const double *roots, int n_nodes,
                        double selective)
{
    const double small = 1.0 / sqrt(selective);

    for (size_t line = 0; line < n; line++) {
        double *at = K + line * (step == 1 ? n : 1);
        for (size_t group = 0; group < 6; group++) {
            double total = 0.0, sum = 0.0;
            for (int k = 0; k < n_nodes; k++) {
                double *entry =
                    at + step * (3 * ((size_t)k + group / 3 * (size_t)n_nodes) + group % 3);
                *entry /= roots[k];
                sum += roots[k] * *entry;
                total += roots[k] * roots[k];
            }
            for (int k = 0; k < n_nodes; k++) {
                double *entry =
                    at + step * (3 * ((size_t)k + group / 3 * (size_t)n_nodes) + group % 3);
                *entry = small * *entry + (1.0 - small) * roots[k] * sum / total;
            }
        }
    }
}

enum wb_status wb_swept_frequency_largest(double *K, int n, const char *of, double *value)
{
    double *const values = wb_memory_new((size_t)n, sizeof *values);
    lapack_int found = 0, ignored = 0;
    double vector = 0.0;

    const lapack_int info = LAPACKE_dsyevx(LAPACK_ROW_MAJOR, 'N', 'I', 'U', n, K, n, 0.0, 0.0, n, n,
                                           0.0, &found, values, &vector, 1, &ignored);
    *value = values[0];
    free(values);
    if (info != 0 || found != 1 || !wb_swept_is_positive(*value))
        return wb_fail(WB_ERR_CONVERGENCE, "the eigenvalue solver failed for %s", of);
    return WB_OK;
}

enum wb_status wb_swept_frequency_bound(const struct wb_swept_hex *hex, const double *node_mass,
                                        double selective, double *omega)
{
    const struct wb_swept_hex_model *m = wb_swept_hex_get_model(hex);
    const int n_nodes = m->section->n_nodes;
    const size_t n = 6 * (size_t)n_nodes;

    if (n_nodes > WB_SWEPT_FREQUENCY_MOST_NODES)
        return wb_fail(WB_ERR_UNSUPPORTED,
                       "the section has %d nodes: frequencies are supported for at most %d",
                       n_nodes, WB_SWEPT_FREQUENCY_MOST_NODES);
    WB_TRY(wb_swept_step_check_masses(n_nodes, node_mass, selective));
    double *const K = wb_memory_new(n * n + (size_t)n_nodes, sizeof *K);
    double *roots = K + n * n;
    for (int k = 0; k < n_nodes; k++)
        roots[k] = sqrt(0.5 * node_mass[k] * m->element_length);
    wb_swept_frequency_layer(hex, K);
    scale_lines(K, n, 1, roots, n_nodes, selective);
    scale_lines(K, n, n, roots, n_nodes, selective);
    double value = 0.0;
    const enum wb_status status =
        wb_swept_frequency_largest(K, (int)n, "a layer of the wire", &value);
    free(K);
    WB_TRY(status);
    *omega = sqrt(value) * (1.0 + 1e-9);
    return WB_OK;
}
