#include "fe/rod/beam_element.h"

#include <math.h>

void wb_beam_element_rotation(const struct wb_rod_shape *shape, int g,
                              const struct wb_beam_node *nodes, struct wb_beam_point *point)
{
    const double *N = shape->N[g];
    const double d0 = shape->dN[g][0], d2 = shape->dN[g][2];
    const double t = N[0] * nodes[0].t + N[1] * nodes[1].t + N[2] * nodes[2].t;

    /* The derivatives add to zero, so they may act on differences, which lose fewer digits. */
    point->k = d0 * (nodes[0].t - nodes[1].t) + d2 * (nodes[2].t - nodes[1].t);
    point->cosine = cos(t);
    point->sine = sin(t);
}

void wb_beam_element_kinematics(const struct wb_rod_shape *shape, int g,
                                const struct wb_beam_node *nodes, struct wb_beam_point *point)
{
    const double d0 = shape->dN[g][0], d2 = shape->dN[g][2];

    wb_beam_element_rotation(shape, g, nodes, point);
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

/* K_ij += B_i^T k B_j with B_i = (dN_i, dN_i, N_i, dN_i). */
static inline void add_block(double *restrict K, const struct point_tangent *k, double Ni,
                             double dNi, double Nj, double dNj)
{
    const double dd = dNi * dNj, dn = dNi * Nj, nd = Ni * dNj;

    K[0] += dd * k->xx;
    K[1] += dd * k->xy;
    K[2] += dn * k->xt + dd * k->xk;
    K[3] += dd * k->xy;
    K[4] += dd * k->yy;
    K[5] += dn * k->yt + dd * k->yk;
    K[6] += nd * k->xt + dd * k->xk;
    K[7] += nd * k->yt + dd * k->yk;
    K[8] += Ni * Nj * k->tt + (nd + dn) * k->tk + dd * k->kk;
}

void wb_beam_element_stiffness(const struct wb_rod_shape *shape, const struct wb_beam_point *points,
                               struct wb_beam_element_stiffness *restrict K)
{
    *K = (struct wb_beam_element_stiffness){0};
    for (int g = 0; g < WB_BEAM_ELEMENT_POINTS; g++) {
        const double *N = shape->N[g], *dN = shape->dN[g];
        struct point_tangent k;
        point_tangent(&points[g], shape->weight, &k);
        add_block(K->K11, &k, N[0], dN[0], N[0], dN[0]);
        add_block(K->K12, &k, N[0], dN[0], N[1], dN[1]);
        add_block(K->K13, &k, N[0], dN[0], N[2], dN[2]);
        add_block(K->K22, &k, N[1], dN[1], N[1], dN[1]);
        add_block(K->K23, &k, N[1], dN[1], N[2], dN[2]);
        add_block(K->K33, &k, N[2], dN[2], N[2], dN[2]);
    }
}
