#include "fe/swept/swept_hex_stress.h"

#include <math.h>
#include <stddef.h>

#include "base/vec3.h"
#include "fe/swept/swept_hex_kernel.h"
#include "fe/swept/swept_private.h"

enum {
    XX = 0,
    YY,
    ZZ,
    XY,
    XZ,
    YZ
};

int wb_swept_hex_stress_points(const struct wb_swept_hex *hex)
{
    return wb_swept_hex_get_model(hex)->formulation == WB_SWEPT_HEX_ONE_POINT ? 1 : 4;
}

static double log_strain(double e)
{
    return e - e * e * (1.0 - 4.0 / 3.0 * e);
}

/* The element of the kernels: columns of F, Green's strain, and its logarithm (formulas in
 * swept_hex_kernel.c). */
struct element {
    struct wb_swept_quad quad;
    double along[4][3]; /* d_a / h */
    double F[3][3];     /* columns: by x, y, z */
    double E[6], L[6];  /* the diagonal of L minus a third of the trace */
    double trace;
};

static void find_gradient(struct element *e, const struct wb_swept_hex *hex, const double *position,
                          int quad, int element)
{
    const struct wb_swept_hex_model *m = wb_swept_hex_get_model(hex);
    const struct wb_swept_layout layout = wb_swept_hex_layout(hex);

    wb_swept_section_quad(m->section, quad, &e->quad);
    for (int i = 0; i < 9; i++)
        e->F[i / 3][i % 3] = 0.0;
    for (int a = 0; a < 4; a++) {
        for (int i = 0; i < 3; i++) {
            const size_t row = (size_t)(3 * m->section->quad[quad][a] + i);
            const double *x = position + row * (size_t)layout.stride + element;
            const double s = 0.5 * (x[0] + x[1]), d = (x[1] - x[0]) / m->element_length;
            e->along[a][i] = d;
            e->F[0][i] += e->quad.mean[a] * d;
            e->F[1][i] += e->quad.gradient[0][a] * s;
            e->F[2][i] += e->quad.gradient[1][a] * s;
        }
    }
}

static void find_strain(struct element *e)
{
    double *E = e->E, *L = e->L;

    E[XX] = 0.5 * (wb_vec3_dot(e->F[0], e->F[0]) - 1.0);
    E[YY] = 0.5 * (wb_vec3_dot(e->F[1], e->F[1]) - 1.0);
    E[ZZ] = 0.5 * (wb_vec3_dot(e->F[2], e->F[2]) - 1.0);
    E[XY] = 0.5 * wb_vec3_dot(e->F[0], e->F[1]);
    E[XZ] = 0.5 * wb_vec3_dot(e->F[0], e->F[2]);
    E[YZ] = 0.5 * wb_vec3_dot(e->F[1], e->F[2]);
    L[XX] = log_strain(E[XX]) - E[XY] * E[XY] - E[XZ] * E[XZ];
    L[YY] = log_strain(E[YY]) - E[XY] * E[XY] - E[YZ] * E[YZ];
    L[ZZ] = log_strain(E[ZZ]) - E[XZ] * E[XZ] - E[YZ] * E[YZ];
    L[XY] = E[XY] - E[XY] * (E[XX] + E[YY]) - E[XZ] * E[YZ];
    L[XZ] = E[XZ] - E[XZ] * (E[XX] + E[ZZ]) - E[XY] * E[YZ];
    L[YZ] = E[YZ] - E[YZ] * (E[YY] + E[ZZ]) - E[XY] * E[XZ];
    e->trace = L[XX] + L[YY] + L[ZZ];
    for (int i = XX; i <= ZZ; i++)
        L[i] -= e->trace / 3.0;
}

/* Adds the contribution of the corners' axial vectors to the deviator at one of four points. */
static void vary(const struct element *e, int q, double t[6])
{
    double F1[3] = {0.0};

    for (int a = 0; a < 4; a++)
        for (int i = 0; i < 3; i++)
            F1[i] += e->quad.value[q][a] * e->along[a][i];
    const double more = log_strain(0.5 * (wb_vec3_dot(F1, F1) - 1.0)) - log_strain(e->E[XX]);
    t[XX] += more;
    t[YY] -= 0.5 * more;
    t[ZZ] -= 0.5 * more;
    t[XY] += 0.5 * wb_vec3_dot(F1, e->F[1]) - e->E[XY];
    t[XZ] += 0.5 * wb_vec3_dot(F1, e->F[2]) - e->E[XZ];
}

void wb_swept_hex_stress_find(const struct wb_swept_hex *hex,
                              const struct wb_swept_hex_state *state, const double *position,
                              int quad, int element, struct wb_swept_hex_stress *out)
{
    static const int place[5] = {XX, YY, XY, XZ, YZ}; /* components stored in the history */
    const struct wb_swept_hex_model *m = wb_swept_hex_get_model(hex);
    const double nu = m->material.poissons_ratio, E = m->material.youngs_modulus;
    const double two_mu = E / (1.0 + nu), kappa = E / (3.0 * (1.0 - 2.0 * nu));
    const int n = wb_swept_hex_stress_points(hex);
    struct element e;

    find_gradient(&e, hex, position, quad, element);
    find_strain(&e);
    /* Kirchhoff stress over the change of volume. */
    const double per_volume = exp(-e.trace);
    for (int q = 0; q < n; q++) {
        double t[6];
        for (int i = 0; i < 6; i++)
            t[i] = e.L[i];
        if (n > 1)
            vary(&e, q, t);
        for (int i = 0; i < 5; i++)
            t[place[i]] -= wb_swept_hex_history(state, quad, element, q, i);
        t[ZZ] = -t[XX] - t[YY];
        for (int i = 0; i < 6; i++)
            out[q].stress[i] = per_volume * (two_mu * t[i] + (i <= ZZ ? kappa * e.trace : 0.0));
        out[q].plastic = wb_swept_hex_history(state, quad, element, q, WB_SWEPT_HEX_ACCUMULATED);
    }
}

void wb_swept_hex_stress_at_corners(const struct wb_swept_hex *hex,
                                    const struct wb_swept_hex_stress *points,
                                    struct wb_swept_hex_stress corners[4])
{
    /* The Gauss points are at 1/sqrt(3) of the distance to the corners, in the same order. */
    static const double root = 1.7320508075688772;
    const double factor[3] = {0.25 * (1.0 + root) * (1.0 + root), -0.5,
                              0.25 * (1.0 - root) * (1.0 - root)};
    const bool one = wb_swept_hex_stress_points(hex) == 1;

    for (int a = 0; a < 4; a++) {
        if (one) {
            corners[a] = points[0];
            continue;
        }
        const struct wb_swept_hex_stress *own = &points[a], *before = &points[(a + 3) % 4];
        const struct wb_swept_hex_stress *next = &points[(a + 1) % 4], *far = &points[(a + 2) % 4];
        for (int i = 0; i < 6; i++)
            corners[a].stress[i] = factor[0] * own->stress[i] +
                                   factor[1] * (before->stress[i] + next->stress[i]) +
                                   factor[2] * far->stress[i];
        corners[a].plastic = factor[0] * own->plastic +
                             factor[1] * (before->plastic + next->plastic) +
                             factor[2] * far->plastic;
    }
}
