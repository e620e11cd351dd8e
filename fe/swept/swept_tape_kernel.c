/* Forces of a tape of 4-node shells, compiled once for each type and instruction set (see
 * swept_tape_kernel.h). Lanes are consecutive elements along the axis.
 *
 * Positions x and directors D of an element are bilinear in xi (along the axis) and eta (around the
 * ring), each from -1/2 to 1/2:
 *
 *     x = x0 + X1 xi + X2 eta + 2 XH xi eta,  d = D0 + D1 xi + D2 eta + 2 DH xi eta.
 *
 * At the middle, in the orthonormal frame of the reference state (B transforms derivatives to it),
 *
 *     a_1, a_2 = dx,  d_1, d_2 = dd,
 *     E(z) = (1/2 (a_i.a_j) - reference) + z (sym(a_i.d_j) - reference),
 *
 * z from the middle surface (z^2 d_i.d_j / 2 and the effect of curvature on volumes are neglected).
 * Each point through the thickness has the logarithmic strain E - E^2 + 4/3 E^3 - 2 E^4 and plane
 * stress. All symmetric 2 x 2 matrices are kept as mean (11 + 22) / 2, half difference (11 - 22) /
 * 2 and 12.
 *
 * Transverse shear is that of the four edges, where it is exact: edge vector times the mean of its
 * two directors (E. N. Dvorkin, K. J. Bathe, Eng. Comput. 1 (1984) 77). Mean and half differences
 * of opposite edges give
 *
 *     g_1 = X1.D0 + XH.D2 / 2,  g_2 = X2.D0 + XH.D1 / 2,
 *     w_1 = X1.D2 / 2 + XH.D0,  w_2 = X2.D1 / 2 + XH.D0,
 *
 * whose energies are those of shear that is linear between the edges. The remaining vectors are
 * hourglass vectors, without the parts of linear fields: h = XH - c_1 a_1 - c_2 a_2, and the same
 * for d. Their energies 1/2 k (h.a_i)^2 are invariant to rotations; h out of the plane is shear.
 * Directors keep their length by 1/2 k ((d.d - 1) / 2)^2 at the nodes.
 *
 * Forces are the exact negative derivatives of this energy at constant plastic strains.
 */
#include "fe/swept/swept_tape_kernel.h"
#include "fe/swept/swept_simd.h"
#include "fe/swept/swept_yield.h"

enum {
    REFERENCE = WB_SWEPT_TAPE_REFERENCE,
    MEASURES = WB_SWEPT_TAPE_MEASURES,
    HISTORY = WB_SWEPT_TAPE_HISTORY,
    BLOCK = WB_SWEPT_LANES
};

/* A node of the ring between two stations: sums and differences of position (sums in double) and
 * director, and the negative derivatives of the energy with respect to them. */
struct line {
    struct wide sum[3];
    vec along[3], director[3], turn[3];
    vec f_sum[3], f_along[3], f_director[3], f_turn[3];
};

/* The seven vectors of an element, and the negative derivatives of the energy with respect to
 * them. */
struct modes {
    vec X1[3], X2[3], XH[3], D0[3], D1[3], D2[3], DH[3];
};

/* In the element's frame. */
struct gradients {
    vec a1[3], a2[3], d1[3], d2[3], hx[3], hd[3];
};

struct symmetric {
    vec mean, difference, both;
};

struct law {
    const real *table;
    real yield, yield_square, exponent;
    real mean_share, mean_slope;
    real sum_modulus, difference_modulus;
};

struct totals {
    vec stored, artificial, largest;
};

/* Reads a node from station j on. */
INLINE void read_line(const struct wb_swept_tape_kernel_call *call, int k, int j, struct line *line)
{
    const size_t stride = (size_t)call->model->layout.stride;

    for (int i = 0; i < 3; i++) {
        const size_t at = (size_t)(3 * k + i) * stride + (size_t)j;
        const struct wide begin = load_wide(call->fields.position + at);
        const struct wide end = load_wide(call->fields.position + at + 1);
        const struct wide d_begin = load_wide(call->fields.director + at);
        const struct wide d_end = load_wide(call->fields.director + at + 1);
        line->sum[i] = add(begin, end);
        line->along[i] = narrow(subtract(end, begin));
        line->director[i] = narrow(add(d_begin, d_end));
        line->turn[i] = narrow(subtract(d_end, d_begin));
        line->f_sum[i] = line->f_along[i] = line->f_director[i] = line->f_turn[i] = (vec){0};
    }
}

INLINE void find_modes(const struct line *a, const struct line *b, struct modes *m)
{
    for (int i = 0; i < 3; i++) {
        m->X1[i] = (real)0.5 * (a->along[i] + b->along[i]);
        m->X2[i] = (real)0.5 * narrow(subtract(b->sum[i], a->sum[i]));
        m->XH[i] = (real)0.5 * (b->along[i] - a->along[i]);
        m->D0[i] = (real)0.25 * (a->director[i] + b->director[i]);
        m->D1[i] = (real)0.5 * (a->turn[i] + b->turn[i]);
        m->D2[i] = (real)0.5 * (b->director[i] - a->director[i]);
        m->DH[i] = (real)0.5 * (b->turn[i] - a->turn[i]);
    }
}

INLINE void add_forces(const struct modes *f, struct line *a, struct line *b)
{
    for (int i = 0; i < 3; i++) {
        const vec along = (real)0.5 * f->X1[i], warp = (real)0.5 * f->XH[i];
        const vec turn = (real)0.5 * f->D1[i], twist = (real)0.5 * f->DH[i];
        const vec across = (real)0.5 * f->X2[i], bend = (real)0.5 * f->D2[i];
        const vec mean = (real)0.25 * f->D0[i];
        a->f_along[i] += along - warp;
        b->f_along[i] += along + warp;
        a->f_sum[i] -= across;
        b->f_sum[i] += across;
        a->f_turn[i] += turn - twist;
        b->f_turn[i] += turn + twist;
        a->f_director[i] += mean - bend;
        b->f_director[i] += mean + bend;
    }
}

INLINE vec constant(const real *c, int place)
{
    return load(c + place * BLOCK);
}

INLINE void find_gradients(const real *c, const struct modes *m, struct gradients *g)
{
    const vec B11 = constant(c, WB_SWEPT_TAPE_B11), B21 = constant(c, WB_SWEPT_TAPE_B21);
    const vec B22 = constant(c, WB_SWEPT_TAPE_B22);
    const vec c1 = constant(c, WB_SWEPT_TAPE_C1), c2 = constant(c, WB_SWEPT_TAPE_C2);

    for (int i = 0; i < 3; i++) {
        g->a1[i] = B11 * m->X1[i];
        g->a2[i] = B21 * m->X1[i] + B22 * m->X2[i];
        g->d1[i] = B11 * m->D1[i];
        g->d2[i] = B21 * m->D1[i] + B22 * m->D2[i];
        g->hx[i] = m->XH[i] - c1 * g->a1[i] - c2 * g->a2[i];
        g->hd[i] = m->DH[i] - c1 * g->d1[i] - c2 * g->d2[i];
    }
}

/* Indices are those of swept_tape_kernel.h. */
INLINE void find_measures(const real *c, const struct modes *m, const struct gradients *g,
                          vec e[WB_SWEPT_TAPE_N_MEASURES])
{
    const vec B11 = constant(c, WB_SWEPT_TAPE_B11), B21 = constant(c, WB_SWEPT_TAPE_B21);
    const vec B22 = constant(c, WB_SWEPT_TAPE_B22);
    const vec aa1 = (real)0.25 * dot(g->a1, g->a1), aa2 = (real)0.25 * dot(g->a2, g->a2);
    const vec ad1 = (real)0.5 * dot(g->a1, g->d1), ad2 = (real)0.5 * dot(g->a2, g->d2);
    const vec shear1 = dot(m->X1, m->D0) + (real)0.5 * dot(m->XH, m->D2);
    const vec shear2 = dot(m->X2, m->D0) + (real)0.5 * dot(m->XH, m->D1);
    const vec warp = dot(m->XH, m->D0);

    e[WB_SWEPT_TAPE_MEMBRANE] = aa1 + aa2;
    e[WB_SWEPT_TAPE_MEMBRANE + 1] = aa1 - aa2;
    e[WB_SWEPT_TAPE_MEMBRANE + 2] = (real)0.5 * dot(g->a1, g->a2);
    e[WB_SWEPT_TAPE_BENDING] = ad1 + ad2;
    e[WB_SWEPT_TAPE_BENDING + 1] = ad1 - ad2;
    e[WB_SWEPT_TAPE_BENDING + 2] = (real)0.5 * (dot(g->a1, g->d2) + dot(g->a2, g->d1));
    e[WB_SWEPT_TAPE_SHEAR] = B11 * shear1;
    e[WB_SWEPT_TAPE_SHEAR + 1] = B21 * shear1 + B22 * shear2;
    e[WB_SWEPT_TAPE_WARP] = (real)0.5 * dot(m->X1, m->D2) + warp;
    e[WB_SWEPT_TAPE_WARP + 1] = (real)0.5 * dot(m->X2, m->D1) + warp;
    e[WB_SWEPT_TAPE_HOURGLASS] = dot(g->hx, g->a1);
    e[WB_SWEPT_TAPE_HOURGLASS + 1] = dot(g->hx, g->a2);
    e[WB_SWEPT_TAPE_HOURGLASS + 2] = dot(g->hd, g->a1);
    e[WB_SWEPT_TAPE_HOURGLASS + 3] = dot(g->hd, g->a2);
}

/* H = f(E), f(e) = e - e^2 + 4/3 e^3 - 2 e^4. With E = m I + N, N^2 = r I: H = A(m, r) I + B(m, r)
 * N. */
INLINE struct symmetric logarithm(const struct symmetric *E)
{
    const vec m = E->mean, r = E->difference * E->difference + E->both * E->both;
    const vec B = 1 - m * (2 - m * (4 - 8 * m)) + r * ((real)(4.0 / 3.0) - 8 * m);

    return (struct symmetric){m * (1 - m * (1 - m * ((real)(4.0 / 3.0) - 2 * m))) -
                                  r * (1 - m * (4 - 12 * m) + 2 * r),
                              B * E->difference, B * E->both};
}

/* S with S : dE = T : dH, in place. */
INLINE void pull_back(const struct symmetric *E, struct symmetric *T)
{
    const vec m = E->mean, r = E->difference * E->difference + E->both * E->both;
    const vec slope = 1 - m * (2 - m * (4 - 8 * m));
    const vec B = slope + r * ((real)(4.0 / 3.0) - 8 * m);
    const vec A_m = slope + r * (4 - 24 * m), A_r = m * (4 - 12 * m) - 1 - 4 * r;
    const vec B_m = m * (8 - 24 * m) - 2 - 8 * r, B_r = (real)(4.0 / 3.0) - 8 * m;
    const vec work = T->difference * E->difference + T->both * E->both;
    const vec by_r = 2 * (T->mean * A_r + work * B_r);

    T->mean = T->mean * A_m + work * B_m;
    T->difference = B * T->difference + by_r * E->difference;
    T->both = B * T->both + by_r * E->both;
}

/* p / x of p + K / (3 mu) p^n = x. */
INLINE vec part_of(const struct law *law, vec x)
{
    x = minimum(maximum(x, splat((real)0x1p-31)), splat((real)BELOW_TWO));
    return yielded_part(law->table, WB_SWEPT_TAPE_TERMS, x);
}

/* Subtracts the plastic strain from a strain, and returns it to the yield surface.
 *
 * With the trial stresses over 3 mu, t of the mean and s of the deviator in the plane, the length l
 * = p - p0 and the yield stress q = y + x - p, the stress on the surface is t q / A and s q / B,
 *
 *     A = q + mean_slope l,  B = q + l = y + x - p0,  S = (t / A)^2 + (s / B)^2 = 1.
 *
 * Newton's method for x on 1/sqrt(S) = 1; the initial guess is exact for mean_slope = 1. Usually
 * one step suffices, as increments are small. With r = p / x, dp/dx = r / (r + n (1 - r)). */
INLINE void return_to_yield(const struct law *law, real *history, struct symmetric *e)
{
    const real enough = sizeof(real) == 4 ? (real)3e-4 : (real)1e-7;
    const real less = 1 - law->mean_slope;
    const struct symmetric plastic = {load(history), load(history + BLOCK),
                                      load(history + 2 * BLOCK)};
    e->mean -= plastic.mean;
    e->difference -= plastic.difference;
    e->both -= plastic.both;
    const vec t2 = law->mean_share * law->mean_share * e->mean * e->mean;
    const vec s2 = (real)(4.0 / 3.0) * (e->difference * e->difference + e->both * e->both);
    const mask beyond = above(t2 + s2, splat(law->yield_square));
    if (!any(beyond))
        return;

    const vec p0 = load(history + 3 * BLOCK), square = choose(beyond, t2 + s2, splat((real)1));
    vec B = square * inverse_root(square), x = B - law->yield + p0;
    vec r = part_of(law, x), p = x * r;
    const mask yields = above(choose(beyond, p, (vec){0}), p0);
    if (!any(yields))
        return;

    vec A = B - less * (p - p0), per_A, per_B;
    for (int i = 0; i < 12; i++) {
        const vec inverse = 1 / (A * B), rest = r + law->exponent * (1 - r);
        per_A = B * inverse;
        per_B = A * inverse;
        const vec aa = t2 * per_A * per_A, bb = s2 * per_B * per_B, sum = aa + bb;
        const vec fall = aa * per_A * (rest - less * r) + bb * per_B * rest;
        const vec root = inverse_root(sum);
        const vec change = choose(yields, (sum - 1) / ((1 + root) * root * fall), (vec){0});
        const vec step = rest * change, of_p = r * change;
        x += step;
        p += of_p;
        B += step;
        A += step - less * of_p;
        if (!any(above(size_of(step), enough * x)))
            break;
        r = part_of(law, x);
        p = x * r;
        A = B - less * (p - p0);
    }
    /* A and B changed little since their inverses were computed. */
    const vec length = maximum(p - p0, (vec){0});
    const vec of_mean =
        choose(yields, law->mean_slope * length * per_A * (2 - A * per_A), (vec){0});
    const vec of_rest = choose(yields, length * per_B * (2 - B * per_B), (vec){0});
    const vec mean = of_mean * e->mean;
    const vec difference = of_rest * e->difference, both = of_rest * e->both;
    store(history, plastic.mean + mean);
    store(history + BLOCK, plastic.difference + difference);
    store(history + 2 * BLOCK, plastic.both + both);
    store(history + 3 * BLOCK, p0 + choose(yields, length, (vec){0}));
    e->mean -= mean;
    e->difference -= difference;
    e->both -= both;
}

/* Resultants of the stresses, times the volume over the thickness' share: conjugate to the measures
 * of membrane and bending. */
INLINE void find_stresses(const struct wb_swept_tape_kernel_model *m, const struct law *law,
                          const struct symmetric *E0, const struct symmetric *K, real *history,
                          struct symmetric *N, struct symmetric *M, vec *energy, vec *largest)
{
    *N = *M = (struct symmetric){{0}, {0}, {0}};
    for (int q = 0; q < m->n_points; q++) {
        const real z = (real)m->z[q], weight = (real)m->weight[q];
        const struct symmetric E = {E0->mean + z * K->mean, E0->difference + z * K->difference,
                                    E0->both + z * K->both};
        struct symmetric e = logarithm(&E);
        return_to_yield(law, history + q * HISTORY * BLOCK, &e);
        struct symmetric T = {law->sum_modulus * e.mean, law->difference_modulus * e.difference,
                              law->difference_modulus * e.both};
        if (energy) {
            *energy += weight * (T.mean * e.mean + T.difference * e.difference + T.both * e.both);
            *largest = maximum(*largest, size_of(E.mean) + size_of(E.difference) + size_of(E.both));
        }
        pull_back(&E, &T);
        N->mean += weight * T.mean;
        N->difference += weight * T.difference;
        N->both += weight * T.both;
        M->mean += weight * z * T.mean;
        M->difference += weight * z * T.difference;
        M->both += weight * z * T.both;
    }
}

/* Negative derivatives with respect to a and d of membrane and bending, and of the hourglass
 * energies with the forces `q` on these measures. */
INLINE void gradient_forces(const struct gradients *g, const struct symmetric *N,
                            const struct symmetric *M, const vec q[4], struct gradients *f)
{
    const vec N11 = -(N->mean + N->difference), N22 = N->difference - N->mean, N12 = -N->both;
    const vec M11 = -(M->mean + M->difference), M22 = M->difference - M->mean, M12 = -M->both;

    for (int i = 0; i < 3; i++) {
        f->a1[i] = N11 * g->a1[i] + N12 * g->a2[i] + M11 * g->d1[i] + M12 * g->d2[i] -
                   q[0] * g->hx[i] - q[2] * g->hd[i];
        f->a2[i] = N12 * g->a1[i] + N22 * g->a2[i] + M12 * g->d1[i] + M22 * g->d2[i] -
                   q[1] * g->hx[i] - q[3] * g->hd[i];
        f->d1[i] = M11 * g->a1[i] + M12 * g->a2[i];
        f->d2[i] = M12 * g->a1[i] + M22 * g->a2[i];
        f->hx[i] = -(q[0] * g->a1[i] + q[1] * g->a2[i]);
        f->hd[i] = -(q[2] * g->a1[i] + q[3] * g->a2[i]);
    }
}

/* Transforms derivatives with respect to gradients and shear (forces `s` for g_1, g_2, `w` for w_1,
 * w_2) to those with respect to modes. */
INLINE void mode_forces(const real *c, const struct modes *m, const struct gradients *g,
                        const vec s[2], const vec w[2], struct modes *f)
{
    const vec B11 = constant(c, WB_SWEPT_TAPE_B11), B21 = constant(c, WB_SWEPT_TAPE_B21);
    const vec B22 = constant(c, WB_SWEPT_TAPE_B22);
    const vec c1 = constant(c, WB_SWEPT_TAPE_C1), c2 = constant(c, WB_SWEPT_TAPE_C2);
    const vec s1 = s[0], s2 = s[1], h1 = (real)0.5 * s1, h2 = (real)0.5 * s2;
    const vec w1 = (real)0.5 * w[0], w2 = (real)0.5 * w[1], both = w[0] + w[1];

    for (int i = 0; i < 3; i++) {
        const vec a1 = g->a1[i] - c1 * g->hx[i], a2 = g->a2[i] - c2 * g->hx[i];
        const vec d1 = g->d1[i] - c1 * g->hd[i], d2 = g->d2[i] - c2 * g->hd[i];
        f->X1[i] = B11 * a1 + B21 * a2 - s1 * m->D0[i] - w1 * m->D2[i];
        f->X2[i] = B22 * a2 - s2 * m->D0[i] - w2 * m->D1[i];
        f->XH[i] = g->hx[i] - h1 * m->D2[i] - h2 * m->D1[i] - both * m->D0[i];
        f->D0[i] = -(s1 * m->X1[i] + s2 * m->X2[i] + both * m->XH[i]);
        f->D1[i] = B11 * d1 + B21 * d2 - h2 * m->XH[i] - w2 * m->X2[i];
        f->D2[i] = B22 * d2 - h1 * m->XH[i] - w1 * m->X1[i];
        f->DH[i] = g->hd[i];
    }
}

INLINE void run_element(const struct wb_swept_tape_kernel_model *model, const struct law *law,
                        const real *c, real *history, struct line *a, struct line *b,
                        struct totals *totals)
{
    struct modes m, f;
    struct gradients g, fg;
    struct symmetric N, M;
    vec e[WB_SWEPT_TAPE_N_MEASURES], energy = {0}, largest = {0};

    find_modes(a, b, &m);
    find_gradients(c, &m, &g);
    find_measures(c, &m, &g, e);
    for (int i = 0; i < WB_SWEPT_TAPE_N_MEASURES; i++)
        e[i] -= constant(c, MEASURES + i);
    const struct symmetric E0 = {e[0], e[1], e[2]}, K = {e[3], e[4], e[5]};
    find_stresses(model, law, &E0, &K, history, &N, &M, totals ? &energy : NULL, &largest);

    const vec volume = constant(c, WB_SWEPT_TAPE_VOLUME);
    const vec B11 = constant(c, WB_SWEPT_TAPE_B11), B21 = constant(c, WB_SWEPT_TAPE_B21);
    const vec B22 = constant(c, WB_SWEPT_TAPE_B22), B1B1 = B11 * B11 + B21 * B21;
    const vec shear = (real)model->shear * volume;
    const vec k1 = volume * B1B1, k2 = volume * (B22 * B22);
    const real third = (real)(1.0 / 3.0 * model->shear);
    const real membrane = (real)model->membrane_hourglass, bending = (real)model->bending_hourglass;
    const vec t1 = shear * e[WB_SWEPT_TAPE_SHEAR], t2 = shear * e[WB_SWEPT_TAPE_SHEAR + 1];
    const vec s[2] = {B11 * t1 + B21 * t2, B22 * t2};
    const vec w[2] = {third * k1 * e[WB_SWEPT_TAPE_WARP], third * k2 * e[WB_SWEPT_TAPE_WARP + 1]};
    const vec *h = e + WB_SWEPT_TAPE_HOURGLASS;
    const vec q[4] = {membrane * k1 * h[0], membrane * k2 * h[1], bending * k1 * h[2],
                      bending * k2 * h[3]};
    if (totals) {
        totals->stored +=
            volume * energy +
            (real)0.5 * (t1 * e[WB_SWEPT_TAPE_SHEAR] + t2 * e[WB_SWEPT_TAPE_SHEAR + 1] +
                         w[0] * e[WB_SWEPT_TAPE_WARP] + w[1] * e[WB_SWEPT_TAPE_WARP + 1]);
        totals->artificial += (real)0.5 * (q[0] * h[0] + q[1] * h[1] + q[2] * h[2] + q[3] * h[3]);
        totals->largest = largest;
    }
    N.mean *= volume;
    N.difference *= volume;
    N.both *= volume;
    M.mean *= volume;
    M.difference *= volume;
    M.both *= volume;
    gradient_forces(&g, &N, &M, q, &fg);
    mode_forces(c, &m, &fg, s, w, &f);
    add_forces(&f, a, b);
}

/* Adds the totals of the counted lanes. */
static void add_sums(const struct totals *totals, const struct wb_swept_range *lanes, double limit,
                     struct wb_swept_tape_sums *sums)
{
    for (int i = lanes->first; i < lanes->end; i++) {
        sums->stored += (double)totals->stored[i];
        sums->artificial += (double)totals->artificial[i];
        sums->largest_strain = fmax(sums->largest_strain, (double)totals->largest[i]);
        sums->beyond_limit += !((double)totals->largest[i] <= limit);
    }
}

/* Padding has undefined positions: clear its forces. */
INLINE void clear_padding(int left, struct line *line)
{
    const mask active = first_lanes(left);
    for (int i = 0; i < 3; i++) {
        line->f_sum[i] = choose(active, line->f_sum[i], (vec){0});
        line->f_along[i] = choose(active, line->f_along[i], (vec){0});
        line->f_director[i] = choose(active, line->f_director[i], (vec){0});
        line->f_turn[i] = choose(active, line->f_turn[i], (vec){0});
    }
}

/* Writes forces and moments at stations j to j + LANES - 1: of the elements that begin there, and
 * of those that end there, of which the last ones come with the next vector. */
INLINE void write_line(const struct wb_swept_tape_kernel_call *call, int k, int j,
                       struct line *line, struct wb_swept_tape_sums *sums)
{
    const struct wb_swept_tape_kernel_model *m = call->model;
    const size_t stride = (size_t)m->layout.stride;
    real *carry = (real *)call->carry + (size_t)k * WB_SWEPT_TAPE_CARRY * BLOCK;
    const vec stiffness = load((const real *)m->length_stiffness + (size_t)k * stride + (size_t)j);
    vec d[3];

    for (int i = 0; i < 3; i++)
        d[i] = narrow(load_wide(call->fields.director + (size_t)(3 * k + i) * stride + (size_t)j));
    const vec excess = (real)0.5 * dot(d, d) - (real)0.5, pull = stiffness * excess;
    if (m->n_along - j < LANES)
        clear_padding(m->n_along - j, line);
    for (int i = 0; i < 3; i++) {
        const size_t at = (size_t)(3 * k + i) * stride + (size_t)j;
        const vec f_end = line->f_sum[i] + line->f_along[i];
        const vec m_end = line->f_director[i] + line->f_turn[i];
        store((real *)call->fields.force + at,
              line->f_sum[i] - line->f_along[i] + shift_in(load(carry + 2 * i * BLOCK), f_end));
        store((real *)call->fields.moment + at,
              line->f_director[i] - line->f_turn[i] - pull * d[i] +
                  shift_in(load(carry + (2 * i + 1) * BLOCK), m_end));
        store(carry + 2 * i * BLOCK, f_end);
        store(carry + (2 * i + 1) * BLOCK, m_end);
    }
    if (sums) {
        const vec energy = (real)0.5 * pull * excess;
        const struct wb_swept_range lanes = lanes_counted(&m->counted, j);
        for (int i = lanes.first; i < lanes.end; i++)
            sums->stored += (double)energy[i];
    }
}

/* One vector of stations. Nodes are read and written in order; the first node of a closed ring is
 * written last. */
INLINE void run_stations(const struct wb_swept_tape_kernel_call *call, const struct law *law, int j,
                         struct wb_swept_tape_sums *sums)
{
    const struct wb_swept_tape_kernel_model *m = call->model;
    const size_t block = (size_t)(j / BLOCK), lane = (size_t)(j % BLOCK);
    const struct wb_swept_range elements = {
        m->counted.first, m->counted.end < m->n_along ? m->counted.end : m->n_along};
    const struct wb_swept_range lanes = lanes_counted(&elements, j);
    struct line lines[3];
    struct line *first = &lines[0], *own = first, *next = &lines[1];

    read_line(call, 0, j, first);
    for (int k = 0; k < m->n_elements; k++) {
        const size_t place = block * (size_t)m->n_elements + (size_t)k;
        const bool is_last = k + 1 == m->layout.n_nodes;
        struct totals totals = {{0}, {0}, {0}};
        if (is_last)
            next = first;
        else
            read_line(call, k + 1, j, next);
        run_element(m, law, (const real *)m->reference + place * REFERENCE * BLOCK + lane,
                    (real *)call->history + place * (size_t)m->n_points * HISTORY * BLOCK + lane,
                    own, next, sums ? &totals : NULL);
        if (sums)
            add_sums(&totals, &lanes, m->strain_limit, sums);
        if (k > 0 || !m->closed)
            write_line(call, k, j, own, sums);
        struct line *spare = own == first ? &lines[2] : own;
        own = next;
        next = spare;
    }
    write_line(call, m->closed ? 0 : m->n_elements, j, m->closed ? first : own, sums);
}

INLINE void run(const struct wb_swept_tape_kernel_call *call, struct wb_swept_tape_sums *sums)
{
    const struct wb_swept_tape_kernel_model *m = call->model;
    const real yield = (real)m->yield_strain;
    const struct law law = {m->table,
                            yield,
                            yield * yield,
                            (real)m->exponent,
                            (real)m->mean_share,
                            (real)m->mean_slope,
                            (real)m->sum_modulus,
                            (real)m->difference_modulus};

    if (call->first_block == 0)
        memset(call->carry, 0,
               (size_t)m->layout.n_nodes * WB_SWEPT_TAPE_CARRY * BLOCK * sizeof(real));
    for (int j = call->first_block * BLOCK; j < call->end_block * BLOCK; j += LANES)
        run_stations(call, &law, j, sums);
}

/* Flush denormal numbers to zero during the kernel: products of strains near zero would otherwise
 * double its time. */
static void forces(const struct wb_swept_tape_kernel_call *call)
{
#if defined(__SSE2__)
    const unsigned int control = _mm_getcsr();
    _mm_setcsr(control | 0x8040);
#endif
    if (call->sums)
        run(call, call->sums);
    else
        run(call, NULL);
#if defined(__SSE2__)
    _mm_setcsr(control);
#endif
}

static void measure(const struct wb_swept_tape_kernel_call *call)
{
    const struct wb_swept_tape_kernel_model *model = call->model;

    for (int j = 0; j < model->layout.stride; j += LANES) {
        for (int k = 0; k < model->n_elements; k++) {
            const size_t place = (size_t)(j / BLOCK) * (size_t)model->n_elements + (size_t)k;
            real *c = (real *)model->reference + place * REFERENCE * BLOCK + j % BLOCK;
            struct line a, b;
            struct modes m;
            struct gradients g;
            vec e[WB_SWEPT_TAPE_N_MEASURES];
            read_line(call, k, j, &a);
            read_line(call, (k + 1) % model->layout.n_nodes, j, &b);
            find_modes(&a, &b, &m);
            find_gradients(c, &m, &g);
            find_measures(c, &m, &g, e);
            for (int i = 0; i < WB_SWEPT_TAPE_N_MEASURES; i++) {
                for (int l = 0; l < LANES; l++)
                    c[(MEASURES + i) * BLOCK + l] =
                        c[WB_SWEPT_TAPE_VOLUME * BLOCK + l] > 0 ? e[i][l] : 0;
            }
        }
    }
}

const struct wb_swept_tape_kernel KERNEL_VERSION(wb_swept_tape_kernel) = {forces, measure};
