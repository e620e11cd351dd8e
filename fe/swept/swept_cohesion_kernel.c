/* Forces of cohesion, compiled once for each type and instruction set (see
 * fe/swept/swept_cohesion.h and swept_cohesion_kernel.h). Lanes are stations.
 *
 * With n = g.d, p = (1 - D) K_nn or, in compression, K_nn, and q = (1 - D) K_ss, the energy is A /
 * 2 (q (g.g - n^2) + p n^2); the force on the node is -A t, t = q g + (p - q) n d, on the director
 * A (o t - (p - q) n g). */
#include "fe/swept/swept_cohesion_kernel.h"
#include "fe/swept/swept_simd.h"

enum {
    BLOCK = WB_SWEPT_LANES
};

INLINE struct wide read(const double *field, int node, int i, int stride, int j)
{
    return load_wide(field + (size_t)(3 * node + i) * (size_t)stride + (size_t)j);
}

INLINE void add_to(void *field, int node, int i, int stride, int j, vec v)
{
    real *at = (real *)field + (size_t)(3 * node + i) * (size_t)stride + (size_t)j;
    store(at, load(at) + v);
}

struct opening {
    vec g[3], director[3];
    vec weight, offset, area;
    mask is_bonded;
};

struct totals {
    vec stored, dissipated;
};

INLINE void find_opening(const struct wb_swept_cohesion_kernel_model *m,
                         const struct wb_swept_cohesion_fields *fields,
                         const struct wb_swept_cohesion_strip *strip, const real *rows, int j,
                         struct opening *open)
{
    const double *own = fields->tape.position;
    const double *other = strip->to < 0 ? own : fields->position[strip->to];

    open->weight = load(rows + WB_SWEPT_COHESION_WEIGHT * BLOCK);
    open->offset = load(rows + WB_SWEPT_COHESION_OFFSET * BLOCK);
    open->area = load(rows + WB_SWEPT_COHESION_BONDED * BLOCK);
    open->is_bonded = above(open->area, splat(0));
    for (int i = 0; i < 3; i++) {
        const struct wide a = read(other, strip->partner[0], i, m->stride, j);
        const struct wide b = read(other, strip->partner[1], i, m->stride, j);
        const vec d = narrow(read(fields->tape.director, strip->node, i, m->stride, j));
        const vec between = narrow(subtract(read(own, strip->node, i, m->stride, j), a));
        open->director[i] = d;
        open->g[i] = between - open->weight * narrow(subtract(b, a)) - open->offset * d;
    }
}

/* Damage for the undamaged energy `Y` and the square of l; *dissipated receives the energy of its
 * growth. */
INLINE vec grow(const struct wb_swept_cohesion_kernel_model *m, const struct opening *open, vec Y,
                vec square, vec before, vec *dissipated)
{
    const mask beyond = above(square, splat(1));
    *dissipated = (vec){0};
    if (!any(beyond))
        return before;

    const vec l2 = choose(beyond, square, splat(1));
    const vec at_onset = choose(beyond, Y, splat(1)) / l2;
    const vec last = (real)m->fracture_energy / at_onset; /* l when broken */
    const vec inverse = inverse_root(l2);
    const vec reached = minimum(last * (1 - inverse) / (last - 1), splat(1));
    const mask grows = above(choose(beyond, reached, (vec){0}), before);
    const vec after = choose(grows, reached, before);
    /* The previous damage corresponds to l = from. */
    const vec from = 1 / (1 - before * (1 - 1 / last));
    const vec to = minimum(l2 * inverse, last);
    *dissipated = choose(grows, open->area * at_onset * from * to * (after - before), (vec){0});
    return after;
}

INLINE void run_strip(const struct wb_swept_cohesion_kernel_model *m,
                      const struct wb_swept_cohesion_fields *fields,
                      const struct wb_swept_cohesion_strip *strip, const real *rows, real *damage,
                      int j, struct totals *totals)
{
    const real normal = (real)m->normal, shear = (real)m->shear, outwards = (real)strip->outwards;
    struct opening open;
    vec p = splat(normal), q = splat(shear);

    find_opening(m, fields, strip, rows, j, &open);
    const vec n = dot(open.g, open.director), square = dot(open.g, open.g) - n * n;
    if (m->breaks) {
        const vec opened = maximum(outwards * n, (vec){0});
        const vec Y = (real)0.5 * (normal * opened * opened + shear * square);
        const real u = (real)m->per_strength, v = (real)m->per_shear_strength;
        vec dissipated;
        const vec D =
            grow(m, &open, Y, u * u * opened * opened + v * v * square, load(damage), &dissipated);
        store(damage, choose(open.is_bonded, D, load(damage)));
        const mask pressed = above((vec){0}, outwards * n),
                   broken = above(D, splat((real)0.5 * BELOW_TWO));
        p = choose(pressed, choose(broken, (vec){0}, p), p - p * D);
        q -= q * D;
        totals->dissipated +=
            only_counted(&m->counted, j, choose(open.is_bonded, dissipated, (vec){0}));
    }
    const vec energy = (real)0.5 * open.area * (q * square + p * n * n);
    totals->stored += only_counted(&m->counted, j, choose(open.is_bonded, energy, (vec){0}));

    const vec along = (p - q) * n;
    for (int i = 0; i < 3; i++) {
        const vec t = choose(open.is_bonded, open.area * (q * open.g[i] + along * open.director[i]),
                             (vec){0});
        const vec turning =
            choose(open.is_bonded, open.offset * t - open.area * along * open.g[i], (vec){0});
        void *other = strip->to < 0 ? fields->tape.force : fields->force[strip->to];
        add_to(fields->tape.force, strip->node, i, m->stride, j, -t);
        add_to(fields->tape.moment, strip->node, i, m->stride, j, turning);
        add_to(other, strip->partner[0], i, m->stride, j, (1 - open.weight) * t);
        add_to(other, strip->partner[1], i, m->stride, j, open.weight * t);
    }
}

static void add_forces(const struct wb_swept_cohesion_kernel_model *m,
                       const struct wb_swept_cohesion_fields *fields, void *damage, int first,
                       int end, struct wb_swept_cohesion_sums *sums)
{
    for (int b = first; b < end; b++) {
        struct totals totals = {{0}, {0}};
        for (int s = m->first[b]; s < m->first[b + 1]; s++) {
            const real *rows = (const real *)m->rows + (size_t)s * WB_SWEPT_COHESION_ROWS * BLOCK;
            real *own = (real *)damage + (size_t)s * BLOCK;
            for (int lane = 0; lane < BLOCK; lane += LANES)
                run_strip(m, fields, &m->strip[s], rows + lane, own + lane, b * BLOCK + lane,
                          &totals);
        }
        for (int i = 0; i < LANES && sums; i++) {
            sums->stored += (double)totals.stored[i];
            sums->dissipated += (double)totals.dissipated[i];
        }
    }
}

const struct wb_swept_cohesion_kernel KERNEL_VERSION(wb_swept_cohesion_kernel) = {add_forces};
