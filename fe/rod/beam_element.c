#include "fe/rod/beam_element.h"

#include <math.h>

void wb_beam_element_turn(const struct wb_rod_shape *shape, int g, const struct wb_beam_node *nodes,
                          struct wb_beam_point *point)
{
    const double *N = shape->N[g];
    const double t = N[0] * nodes[0].t + N[1] * nodes[1].t + N[2] * nodes[2].t;
    point->cosine = cos(t);
    point->sine = sin(t);
}

double wb_beam_element_curvature(const struct wb_rod_shape *shape, int g,
                                 const struct wb_beam_node *nodes)
{
    /* The derivatives add to zero, so they may act on differences, which lose fewer digits. */
    const double d0 = shape->dN[g][0], d2 = shape->dN[g][2];
    return d0 * (nodes[0].t - nodes[1].t) + d2 * (nodes[2].t - nodes[1].t);
}

void wb_beam_element_kinematics(const struct wb_rod_shape *shape, int g,
                                const struct wb_beam_node *nodes, struct wb_beam_point *point)
{
    const double d0 = shape->dN[g][0], d2 = shape->dN[g][2];

    wb_beam_element_turn(shape, g, nodes, point);
    point->k = wb_beam_element_curvature(shape, g, nodes);
    const double x_ = d0 * (nodes[0].x - nodes[1].x) + d2 * (nodes[2].x - nodes[1].x);
    const double y_ = d0 * (nodes[0].y - nodes[1].y) + d2 * (nodes[2].y - nodes[1].y);
    point->a = x_ * point->cosine + y_ * point->sine;
    point->b = y_ * point->cosine - x_ * point->sine;
}

/* d(eps) = (c, s, b, 0), d(gamma) = (-s, c, -a, 0), d(kappa) = (0, 0, 0, 1) over (x', y', t, t').
 */
void wb_beam_element_add_forces(const struct wb_rod_shape *shape, int g,
                                const struct wb_beam_point *p, double *restrict f)
{
    const double w = shape->weight;
    const double fx = w * (p->N * p->cosine - p->Q * p->sine);
    const double fy = w * (p->N * p->sine + p->Q * p->cosine);
    const double ft = w * (p->N * p->b - p->Q * p->a);
    const double fk = w * p->M;

    for (int i = 0; i < WB_BEAM_ELEMENT_NODES; i++) {
        f[3 * i] += shape->dN[g][i] * fx;
        f[3 * i + 1] += shape->dN[g][i] * fy;
        f[3 * i + 2] += shape->N[g][i] * ft + shape->dN[g][i] * fk;
    }
}

/* Second derivatives of the stored work of one point with respect to (x', y', t, t'). */
struct point_tangent {
    double xx, xy, yy, xt, yt, tt, xk, yk, tk, kk;
};

static void point_tangent(const struct wb_beam_point *p, double w, struct point_tangent *k)
{
    const double c = p->cosine, s = p->sine, a = p->a, b = p->b;
    const double D = w * p->D11, G = w * p->G, C = w * p->D12;
    const double N = w * p->N, Q = w * p->Q;

    k->xx = D * c * c + G * s * s;
    k->xy = (D - G) * c * s;
    k->yy = D * s * s + G * c * c;
    k->xt = D * c * b + G * s * a - N * s - Q * c;
    k->yt = D * s * b - G * c * a + N * c - Q * s;
    k->tt = D * b * b + G * a * a - N * a - Q * b;
    k->xk = C * c;
    k->yk = C * s;
    k->tk = C * b;
    k->kk = w * p->D22;
}

/* K_ij = sum of B_i^T k B_j over the Gauss points, with B_i = (dN_i, dN_i, N_i, dN_i). */
static inline void set_block(double *restrict K, const struct wb_rod_shape *shape,
                             const struct point_tangent *k, int i, int j)
{
    double sum[9] = {0};
    for (int g = 0; g < WB_BEAM_ELEMENT_POINTS; g++, k++) {
        const double Ni = shape->N[g][i], dNi = shape->dN[g][i];
        const double Nj = shape->N[g][j], dNj = shape->dN[g][j];
        const double dd = dNi * dNj, dn = dNi * Nj, nd = Ni * dNj;

        sum[0] += dd * k->xx;
        sum[1] += dd * k->xy;
        sum[2] += dn * k->xt + dd * k->xk;
        sum[4] += dd * k->yy;
        sum[5] += dn * k->yt + dd * k->yk;
        sum[6] += nd * k->xt + dd * k->xk;
        sum[7] += nd * k->yt + dd * k->yk;
        sum[8] += Ni * Nj * k->tt + (nd + dn) * k->tk + dd * k->kk;
    }
    sum[3] = sum[1];
    for (int e = 0; e < 9; e++)
        K[e] = sum[e];
}

void wb_beam_element_stiffness(const struct wb_rod_shape *shape, const struct wb_beam_point *points,
                               struct wb_beam_element_stiffness *restrict K)
{
    struct point_tangent k[WB_BEAM_ELEMENT_POINTS];
    for (int g = 0; g < WB_BEAM_ELEMENT_POINTS; g++)
        point_tangent(&points[g], shape->weight, &k[g]);
    set_block(K->K11, shape, k, 0, 0);
    set_block(K->K12, shape, k, 0, 1);
    set_block(K->K13, shape, k, 0, 2);
    set_block(K->K22, shape, k, 1, 1);
    set_block(K->K23, shape, k, 1, 2);
    set_block(K->K33, shape, k, 2, 2);
}
