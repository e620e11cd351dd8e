/* Forces of swept 8-node hexahedra, compiled once for each type and instruction set (see
 * swept_hex_kernel.h). Lanes are consecutive elements along the wire.
 *
 * With s_a = x_a0 + x_a1 and d_a = x_a1 - x_a0 of section node a between two stations, the gradient
 * of the deformation at the middle of the element is
 *
 *     F1(q) = sum N_a(q) d_a / h,  F2 = 1/2 sum B_ya s_a,  F3 = 1/2 sum B_za s_a,
 *
 * where B are mean gradients of the section's quadrilateral, which depend only on its diagonals
 * (s_2 - s_0) and (s_3 - s_1). E are Green's strains of F1(mean), F2 and F3. The logarithmic strain
 * is approximated by L = E - E^2 + 4/3 diag(E_ii^3). With four points, in the section,
 *
 *     L(q) = L + (l(E11(q)) - l(E11)) diag(1, -1/2, -1/2) + (E12(q) - E12, E13(q) - E13),
 *
 * l(e) = e - e^2 + 4/3 e^3: the variation of F1 represents bending and torsion, at constant volume,
 * so that there is no volumetric locking. The energy is
 *
 *     1/2 kappa V (tr L)^2 + mu V sum_q w_q |dev L(q) - Ep(q)|^2 + hourglass,
 *
 * and forces are exactly its derivatives. With T = dW/dL, the stress conjugate to E is
 *
 *     S = T - T E - E T + 4 diag(E_ii^2 T_ii).
 *
 * Hourglass energies are 1/2 k |q|^2 of vectors q = sum gamma_a x_a, which vanish for linear fields
 * and rotate with the element (D. P. Flanagan, T. Belytschko, IJNME 17 (1981) 679).
 *
 * All this is invariant to rotations of the frame. Each section therefore has its own frame; s and
 * d minus its rigid motion are computed in double and rotated into it: F is 1 + H with H of the
 * order of the strain, and round-off is relative to the strain, not to 1. (In float it would
 * otherwise excite a slender wire with strains of 1e-7.)
 */
#include "fe/swept/swept_hex_kernel.h"
#include "fe/swept/swept_simd.h"
#include "fe/swept/swept_yield.h"

enum {
    GROUP_OF_ONE = 4, /* elements computed together: with one point each, and with four */
    GROUP_OF_FOUR = 1,
    HISTORY = WB_SWEPT_HEX_KERNEL_HISTORY,
    TERMS = WB_SWEPT_HEX_KERNEL_TERMS,
    BLOCK = WB_SWEPT_LANES,
    XX = 0,
    YY,
    ZZ,
    XY,
    XZ,
    YZ
};

/* A section node between two stations, in the section's frame: input of its elements, minus the
 * rigid motion, and their forces. */
struct node {
    vec s[3], d[3];
    vec fs[3], fd[3]; /* negative derivatives of the energy */
};

/* The frame's three axes. */
struct frame {
    vec axis[3][3];
};

INLINE struct wide wide_dot(const struct wide a[3], const struct wide b[3])
{
    struct wide out;
    for (int p = 0; p < PARTS; p++)
        out.of[p] = a[0].of[p] * b[0].of[p] + a[1].of[p] * b[1].of[p] + a[2].of[p] * b[2].of[p];
    return out;
}

/* a + factor b */
INLINE struct wide add_times(struct wide a, struct wide factor, struct wide b)
{
    for (int p = 0; p < PARTS; p++)
        a.of[p] += factor.of[p] * b.of[p];
    return a;
}

INLINE void normalise(struct wide a[3])
{
    const struct wide square = wide_dot(a, a);
    for (int p = 0; p < PARTS; p++) {
        const part factor = 1.0 / part_root(square.of[p]);
        for (int i = 0; i < 3; i++)
            a[i].of[p] *= factor;
    }
}

/* Sum and difference of a node's positions at stations j and j + 1. */
INLINE void read_node(const struct wb_swept_hex_kernel_model *m, const double *position, int node,
                      int j, struct wide sum[3], struct wide difference[3])
{
    for (int i = 0; i < 3; i++) {
        const double *at = position + (size_t)(3 * node + i) * (size_t)m->layout.stride + j;
        const struct wide begin = load_wide(at), end = load_wide(at + 1);
        sum[i] = add(begin, end);
        difference[i] = subtract(end, begin);
    }
}

/* The section's frame: the first axis along the central node's line, the others rotate with the
 * line from there to the node beside it. Orthonormal to round-off of double. */
INLINE void find_axes(const struct wb_swept_hex_kernel_model *m, const struct wide centre[3],
                      const struct wide along[3], const struct wide beside[3],
                      struct wide axes[3][3])
{
    const double *from = m->node[m->centre], *to = m->node[m->beside];
    const double y = to[0] - from[0], z = to[1] - from[1], length = sqrt(y * y + z * z);
    const double c = y / length, s = z / length;
    struct wide side[3], across[3];

    for (int i = 0; i < 3; i++) {
        axes[0][i] = along[i];
        side[i] = subtract(beside[i], centre[i]);
    }
    normalise(axes[0]);
    struct wide lean = wide_dot(side, axes[0]);
    for (int p = 0; p < PARTS; p++)
        lean.of[p] = -lean.of[p];
    for (int i = 0; i < 3; i++)
        side[i] = add_times(side[i], lean, axes[0][i]);
    normalise(side);
    for (int i = 0; i < 3; i++) {
        const int k = (i + 1) % 3, l = (i + 2) % 3;
        for (int p = 0; p < PARTS; p++)
            across[i].of[p] = axes[0][k].of[p] * side[l].of[p] - axes[0][l].of[p] * side[k].of[p];
    }
    for (int i = 0; i < 3; i++) {
        for (int p = 0; p < PARTS; p++) {
            axes[1][i].of[p] = c * side[i].of[p] - s * across[i].of[p];
            axes[2][i].of[p] = s * side[i].of[p] + c * across[i].of[p];
        }
    }
}

/* s and d of all nodes from station j on. Lanes after the last element are at rest. */
INLINE void read_nodes(const struct wb_swept_hex_kernel_model *m, const double *position, int j,
                       struct node *nodes, struct frame *frame)
{
    const double *middle = m->node[m->centre];
    const int left = m->n_elements - j;
    const mask active = first_lanes(left);
    struct wide centre[3], along[3], s[3], d[3], axes[3][3];

    read_node(m, position, m->centre, j, centre, along);
    read_node(m, position, m->beside, j, s, d);
    find_axes(m, centre, along, s, axes);
    for (int i = 0; i < 9; i++)
        frame->axis[i / 3][i % 3] = narrow(axes[i / 3][i % 3]);
    for (int k = 0; k < m->layout.n_nodes; k++) {
        const double y = -2.0 * (m->node[k][0] - middle[0]), z = -2.0 * (m->node[k][1] - middle[1]);
        vec own_s[3], own_d[3];
        read_node(m, position, k, j, s, d);
        for (int i = 0; i < 3; i++) {
            for (int p = 0; p < PARTS; p++) {
                s[i].of[p] += y * axes[1][i].of[p] + z * axes[2][i].of[p] - centre[i].of[p];
                d[i].of[p] -= m->length * axes[0][i].of[p];
            }
            own_s[i] = narrow(s[i]);
            own_d[i] = narrow(d[i]);
        }
        for (int i = 0; i < 3; i++) {
            nodes[k].s[i] = dot(frame->axis[i], own_s);
            nodes[k].d[i] = dot(frame->axis[i], own_d);
            nodes[k].fs[i] = nodes[k].fd[i] = (vec){0};
        }
    }
    for (int k = 0; left < LANES && k < m->layout.n_nodes; k++) {
        for (int i = 0; i < 3; i++) {
            nodes[k].s[i] = choose(active, nodes[k].s[i], (vec){0});
            nodes[k].d[i] = choose(active, nodes[k].d[i], (vec){0});
        }
    }
}

/* Writes forces at stations j to j + LANES - 1: of the elements that begin there, and of those that
 * end there, of which the last ones come with the next vector. */
INLINE void put(real *at, vec value, bool adds)
{
    if (adds)
        value += load(at);
    store(at, value);
}

INLINE void write_forces(const struct wb_swept_hex_kernel_model *m, real *force, int j,
                         const struct node *nodes, const struct frame *frame, vec (*carry)[3])
{
    const int left = m->n_elements - j, first_added = m->first_added;
    const mask active = first_lanes(left);

    for (int k = 0; k < m->layout.n_nodes; k++) {
        const struct node *n = &nodes[k];
        vec f0[3], f1[3];
        for (int i = 0; i < 3; i++) {
            f0[i] = n->fs[i] - n->fd[i];
            f1[i] = n->fs[i] + n->fd[i];
        }
        for (int i = 0; i < 3; i++) {
            const vec axes[3] = {frame->axis[0][i], frame->axis[1][i], frame->axis[2][i]};
            vec begin = dot(axes, f0), end = dot(axes, f1);
            if (left < LANES) {
                begin = choose(active, begin, (vec){0});
                end = choose(active, end, (vec){0});
            }
            put(force + (size_t)(3 * k + i) * (size_t)m->layout.stride + j,
                begin + shift_in(carry[k][i], end), k >= first_added);
            carry[k][i] = end;
        }
    }
}

/* Forces after the last element. */
INLINE void write_last_force(const struct wb_swept_hex_kernel_model *m, real *force, int j,
                             vec (*carry)[3])
{
    for (int k = 0; k < m->layout.n_nodes; k++) {
        for (int i = 0; i < 3; i++) {
            put(force + (size_t)(3 * k + i) * (size_t)m->layout.stride + j,
                shift_in(carry[k][i], (vec){0}), k >= m->first_added);
            carry[k][i] = (vec){0};
        }
    }
}

struct law {
    const real *table;
    real yield, yield_norm; /* sigma_Y / (3 mu), and half_norm() at that strain */
};

struct totals {
    vec stored, artificial, largest;
};

/* Strains of an element that are constant over its section. */
struct strain {
    vec H1[3], H2[3], H3[3]; /* columns of F - 1 */
    vec E[6];                /* Green's */
    vec L[6];                /* logarithmic; its diagonal minus a third of the trace */
    vec trace;               /* of L */
    vec warp[3];             /* eight times the section's hourglass vector */
};

struct element {
    const real *c; /* constants */
    struct node *n[4];
    real *history;
    struct strain mean;
    vec H1[4][3], axial[4]; /* of the points, and Green's axial strain */
    vec t[4][6];            /* deviators of the points' elastic strains */
};

INLINE vec log_strain(vec e)
{
    return e - e * e * (1 - (real)(4.0 / 3.0) * e);
}

INLINE vec log_slope(vec e)
{
    return 1 - e * (2 - 4 * e);
}

/* H2, H3 and the hourglass vector of the section. */
INLINE void section_gradient(const real *c, const struct node *const n[4], struct strain *e)
{
    for (int i = 0; i < 3; i++) {
        const vec s0 = n[0]->s[i], s1 = n[1]->s[i], s2 = n[2]->s[i], s3 = n[3]->s[i];
        const vec first = s2 - s0, second = s3 - s1;
        e->H2[i] = c[WB_SWEPT_HEX_B] * first + c[WB_SWEPT_HEX_B + 1] * second;
        e->H3[i] = c[WB_SWEPT_HEX_B + 2] * first + c[WB_SWEPT_HEX_B + 3] * second;
        e->warp[i] = (s0 + s2) - (s1 + s3) - c[WB_SWEPT_HEX_GAMMA] * e->H2[i] -
                     c[WB_SWEPT_HEX_GAMMA + 1] * e->H3[i];
    }
}

INLINE void mean_strain(const real *c, const struct node *const n[4], struct strain *e)
{
    section_gradient(c, n, e);
    for (int i = 0; i < 3; i++) {
        e->H1[i] = c[WB_SWEPT_HEX_MEAN] * n[0]->d[i] + c[WB_SWEPT_HEX_MEAN + 1] * n[1]->d[i] +
                   c[WB_SWEPT_HEX_MEAN + 2] * n[2]->d[i] + c[WB_SWEPT_HEX_MEAN + 3] * n[3]->d[i];
    }

    vec *E = e->E, *L = e->L;
    const real half = (real)0.5;
    E[XX] = e->H1[0] + half * dot(e->H1, e->H1);
    E[YY] = e->H2[1] + half * dot(e->H2, e->H2);
    E[ZZ] = e->H3[2] + half * dot(e->H3, e->H3);
    E[XY] = half * (e->H1[1] + e->H2[0] + dot(e->H1, e->H2));
    E[XZ] = half * (e->H1[2] + e->H3[0] + dot(e->H1, e->H3));
    E[YZ] = half * (e->H2[2] + e->H3[1] + dot(e->H2, e->H3));

    const vec xy2 = E[XY] * E[XY], xz2 = E[XZ] * E[XZ], yz2 = E[YZ] * E[YZ];
    L[XX] = log_strain(E[XX]) - xy2 - xz2;
    L[YY] = log_strain(E[YY]) - xy2 - yz2;
    L[ZZ] = log_strain(E[ZZ]) - xz2 - yz2;
    L[XY] = E[XY] - E[XY] * (E[XX] + E[YY]) - E[XZ] * E[YZ];
    L[XZ] = E[XZ] - E[XZ] * (E[XX] + E[ZZ]) - E[XY] * E[YZ];
    L[YZ] = E[YZ] - E[YZ] * (E[YY] + E[ZZ]) - E[XY] * E[XZ];
    e->trace = L[XX] + L[YY] + L[ZZ];
    const vec third = (real)(1.0 / 3.0) * e->trace;
    L[XX] -= third;
    L[YY] -= third;
    L[ZZ] -= third;
}

/* S from T, in place. */
INLINE void pull_back(const vec E[6], vec T[6])
{
    vec S[6];

    S[XX] = T[XX] * log_slope(E[XX]) - 2 * (T[XY] * E[XY] + T[XZ] * E[XZ]);
    S[YY] = T[YY] * log_slope(E[YY]) - 2 * (T[XY] * E[XY] + T[YZ] * E[YZ]);
    S[ZZ] = T[ZZ] * log_slope(E[ZZ]) - 2 * (T[XZ] * E[XZ] + T[YZ] * E[YZ]);
    S[XY] =
        T[XY] - (T[XX] + T[YY]) * E[XY] - T[XY] * (E[XX] + E[YY]) - T[XZ] * E[YZ] - T[YZ] * E[XZ];
    S[XZ] =
        T[XZ] - (T[XX] + T[ZZ]) * E[XZ] - T[XZ] * (E[XX] + E[ZZ]) - T[XY] * E[YZ] - T[YZ] * E[XY];
    S[YZ] =
        T[YZ] - (T[YY] + T[ZZ]) * E[YZ] - T[YZ] * (E[YY] + E[ZZ]) - T[XY] * E[XZ] - T[XZ] * E[XY];
    for (int i = 0; i < 6; i++)
        T[i] = S[i];
}

/* The plastic strain p of a yielding point: p + K / (3 mu) p^n = x (see hardening.h) with x = e -
 * sigma_Y / (3 mu) + p0, where e is the elastic trial strain that belongs to its trial stress. The
 * table gives p / x; for x below its range p is wrong, but negligible. */
INLINE vec yielded_strain(const struct law *law, vec x)
{
    x = minimum(x, splat((real)BELOW_TWO));
    return x * yielded_part(law->table, TERMS, x);
}

/* e : e / 2 of a deviator; ZZ is not read. */
INLINE vec half_norm(const vec e[6])
{
    return e[XX] * (e[XX] + e[YY]) + e[YY] * e[YY] + e[XY] * e[XY] + e[XZ] * e[XZ] + e[YZ] * e[YZ];
}

/* Subtracts the plastic strain from a deviator, and returns it to the yield surface. ZZ, which is
 * minus the sum of XX and YY, is neither read nor written. */
INLINE void return_to_yield(const struct law *law, real *history, vec e[6])
{
    const vec xx = load(history), yy = load(history + BLOCK), xy = load(history + 2 * BLOCK);
    const vec xz = load(history + 3 * BLOCK), yz = load(history + 4 * BLOCK);
    e[XX] -= xx;
    e[YY] -= yy;
    e[XY] -= xy;
    e[XZ] -= xz;
    e[YZ] -= yz;
    const vec norm = half_norm(e);
    const mask beyond = above(norm, splat(law->yield_norm));
    if (!any(beyond))
        return;

    const vec square = (real)(4.0 / 3.0) * norm;
    const vec inverse = inverse_root(maximum(square, splat((real)1e-30)));
    const vec p0 = load(history + 5 * BLOCK);
    const vec p = yielded_strain(law, square * inverse - law->yield + p0);
    const vec step = choose(beyond, maximum(p - p0, (vec){0}), (vec){0});
    const vec flow = step * inverse;
    store(history, xx + flow * e[XX]);
    store(history + BLOCK, yy + flow * e[YY]);
    store(history + 2 * BLOCK, xy + flow * e[XY]);
    store(history + 3 * BLOCK, xz + flow * e[XZ]);
    store(history + 4 * BLOCK, yz + flow * e[YZ]);
    store(history + 5 * BLOCK, p0 + step);
    for (int i = 0; i < 6; i++)
        e[i] -= flow * e[i];
}

/* Adds the nodes' forces of P2, P3 (derivatives of the energy with respect to F2 and F3) and of the
 * section's hourglass vector. */
INLINE void add_section_forces(const real *c, struct node *const n[4], const struct strain *e,
                               const vec P2[3], const vec P3[3])
{
    for (int i = 0; i < 3; i++) {
        const vec w = c[WB_SWEPT_HEX_K_PLANE] * e->warp[i];
        const vec p2 = P2[i] - c[WB_SWEPT_HEX_GAMMA] * w;
        const vec p3 = P3[i] - c[WB_SWEPT_HEX_GAMMA + 1] * w;
        const vec first = c[WB_SWEPT_HEX_B] * p2 + c[WB_SWEPT_HEX_B + 2] * p3;
        const vec second = c[WB_SWEPT_HEX_B + 1] * p2 + c[WB_SWEPT_HEX_B + 3] * p3;
        n[0]->fs[i] += first - w;
        n[1]->fs[i] += second + w;
        n[2]->fs[i] -= first + w;
        n[3]->fs[i] -= second - w;
    }
}

/* Derivatives of the energy with respect to F1, F2 and F3, the columns of F S; added to P2 and
 * P3. */
INLINE void mean_stress(const struct strain *e, const vec S[6], vec P1[3], vec P2[3], vec P3[3])
{
    const vec F1[3] = {1 + e->H1[0], e->H1[1], e->H1[2]};
    const vec F2[3] = {e->H2[0], 1 + e->H2[1], e->H2[2]};
    const vec F3[3] = {e->H3[0], e->H3[1], 1 + e->H3[2]};

    for (int i = 0; i < 3; i++) {
        P1[i] = S[XX] * F1[i] + S[XY] * F2[i] + S[XZ] * F3[i];
        P2[i] += S[XY] * F1[i] + S[YY] * F2[i] + S[YZ] * F3[i];
        P3[i] += S[XZ] * F1[i] + S[YZ] * F2[i] + S[ZZ] * F3[i];
    }
}

/* One point: adds the forces of the three other hourglass vectors, those of d. */
INLINE void add_along(const real *c, struct node *const n[4], const vec P1[3],
                      struct totals *totals)
{
    const real *k = c + WB_SWEPT_HEX_K_ALONG, *mean = c + WB_SWEPT_HEX_MEAN;

    for (int i = 0; i < 3; i++) {
        const vec d0 = n[0]->d[i], d1 = n[1]->d[i], d2 = n[2]->d[i], d3 = n[3]->d[i];
        const vec a = d2 - d0, b = d1 - d3;
        const vec xi = (real)0.25 * (a + b), eta = (real)0.25 * (a - b);
        const vec both = (real)0.25 * ((d0 + d2) - (d1 + d3));
        const vec f1 = (real)0.25 * k[0] * xi, f2 = (real)0.25 * k[1] * eta;
        const vec f3 = (real)0.25 * k[2] * both;
        n[0]->fd[i] -= mean[0] * P1[i] + (f3 - f1 - f2);
        n[1]->fd[i] -= mean[1] * P1[i] + (f1 - f2 - f3);
        n[2]->fd[i] -= mean[2] * P1[i] + (f1 + f2 + f3);
        n[3]->fd[i] -= mean[3] * P1[i] + (f2 - f1 - f3);
        if (totals)
            totals->artificial +=
                (real)0.5 * (k[0] * xi * xi + k[1] * eta * eta + k[2] * both * both);
    }
}

/* Adds a pressure to a deviator without ZZ. */
INLINE void add_pressure(vec pressure, vec T[6])
{
    T[ZZ] = pressure - T[XX] - T[YY];
    T[XX] += pressure;
    T[YY] += pressure;
}

/* Strains of the points minus the plastic strain: the mean strain, modified by the section's axial
 * vectors. */
INLINE void strain_points(struct element *e, int points)
{
    const struct strain *mean = &e->mean;

    mean_strain(e->c, (const struct node *const *)e->n, &e->mean);
    if (points == 1) {
        for (int i = 0; i < 6; i++)
            e->t[0][i] = mean->L[i];
        return;
    }
    const vec base = mean->L[XX] - log_strain(mean->E[XX]);
    const vec half_yy = mean->L[YY] + (real)0.5 * log_strain(mean->E[XX]);
    const vec base_xy = mean->L[XY] - mean->E[XY] + (real)0.5 * mean->H2[0];
    const vec base_xz = mean->L[XZ] - mean->E[XZ] + (real)0.5 * mean->H3[0];
    const vec F2[3] = {mean->H2[0], 1 + mean->H2[1], mean->H2[2]};
    const vec F3[3] = {mean->H3[0], mean->H3[1], 1 + mean->H3[2]};
#pragma GCC unroll 4
    for (int q = 0; q < 4; q++) {
        const real *N = e->c + WB_SWEPT_HEX_POINT + q * WB_SWEPT_HEX_POINT_STRIDE;
        vec *H1 = e->H1[q], *t = e->t[q];
        for (int i = 0; i < 3; i++)
            H1[i] = N[0] * e->n[0]->d[i] + N[1] * e->n[1]->d[i] + N[2] * e->n[2]->d[i] +
                    N[3] * e->n[3]->d[i];
        e->axial[q] = H1[0] + (real)0.5 * dot(H1, H1);
        const vec l = log_strain(e->axial[q]);
        t[XX] = base + l;
        t[YY] = half_yy - (real)0.5 * l;
        t[XY] = base_xy + (real)0.5 * dot(H1, F2);
        t[XZ] = base_xz + (real)0.5 * dot(H1, F3);
        t[YZ] = mean->L[YZ];
    }
}

/* Forces of the four points: P of each, their contributions to P2 and P3, and the sum T of their
 * deviators times stiffness. */
INLINE void point_stress(const struct element *e, vec P[4][3], vec P2[3], vec P3[3], vec T[6])
{
    const struct strain *mean = &e->mean;
    const vec F2[3] = {mean->H2[0], 1 + mean->H2[1], mean->H2[2]};
    const vec F3[3] = {mean->H3[0], mean->H3[1], 1 + mean->H3[2]};

#pragma GCC unroll 4
    for (int q = 0; q < 4; q++) {
        const real k = e->c[WB_SWEPT_HEX_POINT + q * WB_SWEPT_HEX_POINT_STRIDE + 4];
        const vec *t = e->t[q], F1[3] = {1 + e->H1[q][0], e->H1[q][1], e->H1[q][2]};
        const vec xx = k * t[XX], xy = k * t[XY], xz = k * t[XZ];
        const vec along = xx * ((real)1.5 * log_slope(e->axial[q]));
        T[XX] += xx;
        T[YY] += k * t[YY];
        T[XY] += xy;
        T[XZ] += xz;
        T[YZ] += k * t[YZ];
        for (int i = 0; i < 3; i++) {
            P[q][i] = along * F1[i] + xy * F2[i] + xz * F3[i];
            P2[i] += xy * F1[i];
            P3[i] += xz * F1[i];
        }
    }
}

INLINE void add_forces_of_one(const struct element *e, struct totals *totals)
{
    vec P1[3], P2[3] = {{0}}, P3[3] = {{0}}, T[6];

    for (int i = 0; i < 6; i++)
        T[i] = e->c[WB_SWEPT_HEX_STIFFNESS] * e->t[0][i];
    add_pressure(e->c[WB_SWEPT_HEX_K_VOLUME] * e->mean.trace, T);
    pull_back(e->mean.E, T);
    mean_stress(&e->mean, T, P1, P2, P3);
    add_section_forces(e->c, e->n, &e->mean, P2, P3);
    add_along(e->c, e->n, P1, totals);
}

INLINE void add_forces_of_four(const struct element *e)
{
    vec P[4][3], P1[3], P2[3] = {{0}}, P3[3] = {{0}}, T[6] = {{0}};

    point_stress(e, P, P2, P3, T);
    const vec along = (real)1.5 * T[XX] * log_slope(e->mean.E[XX]), xy = T[XY], xz = T[XZ];
    add_pressure(e->c[WB_SWEPT_HEX_K_VOLUME] * e->mean.trace, T);
    pull_back(e->mean.E, T);
    /* Subtract the parts that the points have themselves. */
    T[XX] -= along;
    T[XY] -= xy;
    T[XZ] -= xz;
    mean_stress(&e->mean, T, P1, P2, P3);
    for (int i = 0; i < 3; i++) {
        for (int a = 0; a < 4; a++) {
            vec f = e->n[a]->fd[i] - e->c[WB_SWEPT_HEX_MEAN + a] * P1[i];
            for (int q = 0; q < 4; q++)
                f -= e->c[WB_SWEPT_HEX_POINT + q * WB_SWEPT_HEX_POINT_STRIDE + a] * P[q][i];
            e->n[a]->fd[i] = f;
        }
    }
    add_section_forces(e->c, e->n, &e->mean, P2, P3);
}

/* All except for the energy of the axial hourglass vectors. */
INLINE void add_totals(const struct element *e, int points, struct totals *totals)
{
    vec largest = {0};

    totals->stored += (real)0.5 * e->c[WB_SWEPT_HEX_K_VOLUME] * e->mean.trace * e->mean.trace;
    totals->artificial += (real)0.5 * e->c[WB_SWEPT_HEX_K_PLANE] * dot(e->mean.warp, e->mean.warp);
    for (int q = 0; q < points; q++) {
        const real k = e->c[points == 1 ? WB_SWEPT_HEX_STIFFNESS
                                        : WB_SWEPT_HEX_POINT + q * WB_SWEPT_HEX_POINT_STRIDE + 4];
        totals->stored += k * half_norm(e->t[q]);
        if (points > 1)
            largest = maximum(size_of(e->axial[q]), largest);
    }
    for (int i = 0; i < 6; i++)
        largest = maximum(size_of(e->mean.E[i]), largest);
    totals->largest = maximum(largest, totals->largest);
}

/* Adds the totals of the counted lanes. */
static void add_sums(const struct totals *totals, const struct wb_swept_range *counted,
                     double limit, struct wb_swept_hex_sums *sums)
{
    for (int i = counted->first; i < counted->end; i++) {
        sums->stored += (double)totals->stored[i];
        sums->artificial += (double)totals->artificial[i];
        sums->largest_strain = fmax(sums->largest_strain, (double)totals->largest[i]);
        /* Maxima drop NaN, sums do not: use a sum to count NaN as beyond the limit. */
        sums->beyond_limit +=
            !((double)totals->largest[i] <= limit && isfinite((double)totals->stored[i]));
    }
}

struct slab {
    const struct wb_swept_hex_kernel_model *m;
    const struct law *law;
    real *history; /* of the first element */
    struct node *nodes;
    struct wb_swept_range counted; /* lanes, in sums */
    struct wb_swept_hex_sums *sums;
};

/* Elements `first` to `first` + n - 1 of the section, stage by stage: each stage is a short chain
 * of operations, of which the processor overlaps several. */
INLINE void add_group(const struct slab *slab, int first, int n, int points)
{
    const struct wb_swept_hex_kernel_model *m = slab->m;
    struct element elements[GROUP_OF_ONE];

    for (int i = 0; i < n; i++) {
        struct element *e = &elements[i];
        const int *quad = m->quad[first + i];
        e->c = (const real *)m->constants + (first + i) * WB_SWEPT_HEX_KERNEL_CONSTANTS;
        for (int a = 0; a < 4; a++)
            e->n[a] = slab->nodes + quad[a];
        e->history = slab->history + (size_t)(first + i) * (size_t)points * HISTORY * BLOCK;
        strain_points(e, points);
    }
    for (int i = 0; i < n; i++) {
#pragma GCC unroll 4
        for (int q = 0; q < points; q++)
            return_to_yield(slab->law, elements[i].history + q * HISTORY * BLOCK, elements[i].t[q]);
    }
    for (int i = 0; i < n; i++) {
        struct totals totals = {{0}, {0}, {0}}, *wanted = slab->sums ? &totals : NULL;
        if (points == 1)
            add_forces_of_one(&elements[i], wanted);
        else
            add_forces_of_four(&elements[i]);
        if (wanted) {
            add_totals(&elements[i], points, wanted);
            add_sums(wanted, &slab->counted, m->strain_limit, slab->sums);
        }
    }
}

/* Prefetches the cache lines of rows `first` to `end` - 1 in the block at station j, of the field
 * that is used next and of the forces. The lines of one block are a stride apart, which hardware
 * prefetchers do not predict. */
INLINE void fetch(const struct wb_swept_hex_kernel_call *call, int first, int end, int j)
{
    enum {
        LINE = 64 /* bytes */
    };

    for (int row = first; row < end; row++) {
        const size_t at = (size_t)row * (size_t)call->model->layout.stride + (size_t)j;
        const char *soon = (const char *)(call->fields.soon + at);
        const char *force = (const char *)((const real *)call->fields.force + at);
#pragma GCC unroll 4
        for (size_t byte = 0; byte < LANES * sizeof(double); byte += LINE)
            __builtin_prefetch(soon + byte, 1, 2);
#pragma GCC unroll 4
        for (size_t byte = 0; byte < LANES * sizeof(real); byte += LINE)
            __builtin_prefetch(force + byte, 1, 2);
    }
}

INLINE void run(const struct wb_swept_hex_kernel_call *call, int points, bool want_sums)
{
    const struct wb_swept_hex_kernel_model *m = call->model;
    const real yield = (real)m->yield_strain;
    const struct law law = {m->table, yield, (real)0.75 * yield * yield};
    struct node *nodes = call->workspace;
    vec(*carry)[3] = (vec(*)[3])(nodes + m->layout.n_nodes);
    const int group = points == 1 ? GROUP_OF_ONE : GROUP_OF_FOUR, rows = 3 * m->layout.n_nodes;

    if (call->first_block == 0)
        memset(carry, 0, (size_t)m->layout.n_nodes * sizeof *carry);
    for (int j = call->first_block * BLOCK; j < call->end_block * BLOCK; j += LANES) {
        real *history = (real *)call->history +
                        (size_t)(j / BLOCK) * (size_t)(m->n_quads * points) * HISTORY * BLOCK +
                        j % BLOCK;
        const int left = m->n_elements - j;
        struct frame frame;
        if (left <= 0) {
            write_last_force(m, call->fields.force, j, carry);
            continue;
        }
        read_nodes(m, call->fields.position, j, nodes, &frame);
        const struct slab slab = {
            m, &law, history, nodes, lanes_counted(&m->counted, j), want_sums ? call->sums : NULL};
        for (int e = 0; e < m->n_quads; e += group) {
            const int end = m->n_quads - e < group ? m->n_quads : e + group;
            if (call->fields.soon)
                fetch(call, e * rows / m->n_quads, end * rows / m->n_quads, j);
            add_group(&slab, e, end - e, points);
        }
        write_forces(m, call->fields.force, j, nodes, &frame, carry);
    }
}

static void four_points(const struct wb_swept_hex_kernel_call *call)
{
    if (call->sums)
        run(call, 4, true);
    else
        run(call, 4, false);
}

static void one_point(const struct wb_swept_hex_kernel_call *call)
{
    if (call->sums)
        run(call, 1, true);
    else
        run(call, 1, false);
}

const struct wb_swept_hex_kernel KERNEL_VERSION(wb_swept_hex_kernel) = {four_points, one_point};
