/* Contact between tape and wires, compiled once for each type and instruction set (see
 * fe/swept/swept_tape_contact.h and swept_tape_contact_kernel.h). Lanes are stations. */
#include "fe/swept/swept_tape_contact_kernel.h"
#include "fe/swept/swept_contact_law.h"
#include "fe/swept/swept_simd.h"

enum {
    BLOCK = WB_SWEPT_LANES
};

struct place {
    vec g[3], director[3], round, along, offset, area;
    vec out[3],
        depth; /* unit vector from the wire's centre to the node; penetration, negative if apart */
    vec across[3], aside, inwards, turn, lever, shear; /* see find_depth() */
    mask is_near;
};

struct totals {
    vec normal, tangential, friction, deepest;
};

/* True if stations from `j` on are all within a row; otherwise lanes are read one by one. */
INLINE bool is_inside(const struct wb_swept_tape_contact_kernel_model *m, int j)
{
    return j >= 0 && j + LANES <= m->stride;
}

INLINE int station_of(const struct wb_swept_tape_contact_kernel_model *m, int j)
{
    return j < 0 ? 0 : j > m->n_stations - 1 ? m->n_stations - 1 : j;
}

INLINE struct wide read(const struct wb_swept_tape_contact_kernel_model *m, const double *field,
                        int node, int i, int j)
{
    const double *row = field + (size_t)(3 * node + i) * (size_t)m->stride;
    double lane[PARTS * PART_LANES];

    if (is_inside(m, j))
        return load_wide(row + j);
    for (int l = 0; l < LANES; l++)
        lane[l] = row[station_of(m, j + l)];
    return load_wide(lane);
}

INLINE void add_to(const struct wb_swept_tape_contact_kernel_model *m, void *field, int node, int i,
                   int j, vec v)
{
    real *row = (real *)field + (size_t)(3 * node + i) * (size_t)m->stride;

    if (is_inside(m, j)) {
        vec sum;
        memcpy(&sum, row + j, sizeof sum);
        sum += v;
        memcpy(row + j, &sum, sizeof sum);
        return;
    }
    for (int l = 0; l < LANES; l++)
        row[station_of(m, j + l)] += v[l];
}

/* Computes the wire's centre from the two surface nodes (relative to their middle, in a frame that
 * rotates with them) and the node's distance from there, perpendicular to the axis. `chord` is from
 * one node to the other, `edge` from station to station, `from` the node relative to the first. */
INLINE void find_depth(real radius, const vec chord[3], const vec edge[3], const vec from[3],
                       struct place *p)
{
    const vec per_edge = safe_inverse_root(dot(edge, edge));
    vec axis[3], beside[3], v[3];

    for (int i = 0; i < 3; i++)
        axis[i] = per_edge * edge[i];
    const vec tilt = dot(chord, axis);
    for (int i = 0; i < 3; i++)
        beside[i] = chord[i] - tilt * axis[i];
    const vec span = safe_inverse_root(dot(beside, beside));
    for (int i = 0; i < 3; i++)
        beside[i] *= span;
    for (int i = 0; i < 3; i++) {
        const int k = (i + 1) % 3, l = (i + 2) % 3;
        p->across[i] = axis[k] * beside[l] - axis[l] * beside[k];
    }
    for (int i = 0; i < 3; i++)
        v[i] = from[i] - (real)0.5 * chord[i] - p->aside * beside[i] - p->inwards * p->across[i];
    const vec shift = dot(v, axis);
    for (int i = 0; i < 3; i++)
        v[i] -= shift * axis[i];
    const vec square = dot(v, v), inverse = safe_inverse_root(square);
    for (int i = 0; i < 3; i++)
        p->out[i] = inverse * v[i];
    p->depth = splat(radius) - square * inverse;
    /* Rotation of the axis, and of the frame, with the first node's edge. */
    p->lever = shift * per_edge;
    p->shear = tilt * per_edge;
    /* Motion of the centre when the two nodes rotate. */
    p->turn = span * (p->aside * dot(p->out, p->across) - p->inwards * dot(p->out, beside));
}

INLINE void find_place(const struct wb_swept_tape_contact_kernel_model *m,
                       const struct wb_swept_cohesion_fields *fields,
                       const struct wb_swept_tape_contact_strip *strip, const real *rows, int j,
                       struct place *out)
{
    const double *own = fields->tape.position, *wire = fields->position[strip->wire];
    const int a = strip->partner[0], b = strip->partner[1], at = j + strip->station;

    out->round = load(rows + WB_SWEPT_TAPE_CONTACT_ROUND * BLOCK);
    out->along = load(rows + WB_SWEPT_TAPE_CONTACT_ALONG * BLOCK);
    out->offset = load(rows + WB_SWEPT_TAPE_CONTACT_OFFSET * BLOCK);
    out->area = load(rows + WB_SWEPT_TAPE_CONTACT_AREA * BLOCK);
    out->aside = load(rows + WB_SWEPT_TAPE_CONTACT_ASIDE * BLOCK);
    out->inwards = load(rows + WB_SWEPT_TAPE_CONTACT_INWARDS * BLOCK);
    out->is_near = above(out->area, splat(0));
    vec chord[3], edge[3], from[3];
    for (int i = 0; i < 3; i++) {
        const struct wide first = read(m, wire, a, i, at), second = read(m, wire, a, i, at + 1);
        const vec here = narrow(subtract(read(m, wire, b, i, at), first));
        const vec there = narrow(subtract(read(m, wire, b, i, at + 1), second));
        const vec between = narrow(subtract(read(m, own, strip->node, i, j), first));
        out->director[i] = narrow(read(m, fields->tape.director, strip->node, i, j));
        edge[i] = narrow(subtract(second, first));
        chord[i] = (1 - out->along) * here + out->along * there;
        from[i] = between - out->along * edge[i];
        out->g[i] = from[i] - out->round * chord[i] - out->offset * out->director[i];
    }
    find_depth((real)strip->radius, chord, edge, from, out);
}

/* Pressure pushes the node outwards by A p and the wire's centre inwards; friction subtracts A t
 * from the node, with the lever o along its director. */
INLINE void add_forces_at(const struct wb_swept_tape_contact_kernel_model *m,
                          const struct wb_swept_cohesion_fields *fields,
                          const struct wb_swept_tape_contact_strip *strip,
                          const struct place *place, int j, const vec drag[3], vec pressure)
{
    void *wire = fields->force[strip->wire];
    const int a = strip->partner[0], b = strip->partner[1], at = j + strip->station;

    for (int i = 0; i < 3; i++) {
        const vec push = choose(place->is_near, place->area * pressure * place->out[i], (vec){0});
        const vec turn = choose(place->is_near,
                                place->area * pressure * place->turn * place->across[i], (vec){0});
        const vec f = choose(place->is_near, -place->area * drag[i], (vec){0});
        const vec there = place->along * f, here = f - there;
        const vec of_b = (real)-0.5 * push - turn, of_a = (real)-0.5 * push + turn;
        const vec b_there = place->along * of_b;
        const vec a_there = place->along * of_a - place->lever * push + place->shear * turn;
        add_to(m, fields->tape.force, strip->node, i, j, push - f);
        add_to(m, fields->tape.moment, strip->node, i, j, place->offset * f);
        add_to(m, wire, a, i, at, here - place->round * here + of_a - a_there);
        add_to(m, wire, a, i, at + 1, there - place->round * there + a_there);
        add_to(m, wire, b, i, at, place->round * here + of_b - b_there);
        add_to(m, wire, b, i, at + 1, place->round * there + b_there);
    }
}

/* Friction of a node at LANES stations. */
struct friction {
    vec drag[3], lost[3], aside[3]; /* aside: g perpendicular to the director */
};

INLINE void store_friction(const struct wb_swept_tape_contact_kernel_model *m, mask where,
                           const struct friction *f, real *history)
{
    const size_t stride = (size_t)m->stride;

    for (int i = 0; i < 3; i++) {
        real *row = history + (size_t)i * stride;
        real *drag = row + WB_SWEPT_TAPE_CONTACT_DRAG * stride;
        real *lost = row + WB_SWEPT_TAPE_CONTACT_LOST * stride;
        real *before = row + WB_SWEPT_TAPE_CONTACT_BEFORE * stride;
        store(drag, choose(where, f->drag[i], load(drag)));
        store(lost, choose(where, f->lost[i], load(lost)));
        store(before, choose(where, f->aside[i], load(before)));
    }
}

INLINE void run_strip(const struct wb_swept_tape_contact_kernel_model *m,
                      const struct contact_law *law, const struct wb_swept_cohesion_fields *fields,
                      const struct wb_swept_tape_contact_strip *strip, const real *rows, int j,
                      real *history, struct totals *totals)
{
    const size_t stride = (size_t)m->stride;
    struct contact_energy energy;
    struct friction f = {{{0}}, {{0}}, {{0}}};
    struct meeting at;
    struct place place;
    vec unit[3];

    find_place(m, fields, strip, rows, j, &place);
    const vec n = dot(place.g, place.director);
    const vec depth = choose(place.is_near, positive_part(place.depth), splat(0));
    const vec inverse = safe_inverse_root(dot(place.director, place.director));
    for (int i = 0; i < 3; i++) {
        const real *row = history + (size_t)i * stride;
        unit[i] = inverse * place.director[i];
        /* Without the component along the director, because pure rotation would otherwise cause
         * slip. */
        f.aside[i] = place.g[i] - n * inverse * unit[i];
        f.drag[i] = load(row + WB_SWEPT_TAPE_CONTACT_DRAG * stride);
        f.lost[i] = load(row + WB_SWEPT_TAPE_CONTACT_LOST * stride);
        /* Of the wire's surface relative to the tape's. */
        at.slip[i] = load(row + WB_SWEPT_TAPE_CONTACT_BEFORE * stride) - f.aside[i];
        at.turn[i] = splat(0);
    }
    if (!any(above(depth + dot(f.drag, f.drag), splat(0)))) {
        store_friction(m, place.is_near, &f, history);
        return;
    }
    friction_force(law, &at, unit, law->normal * depth, f.drag, f.lost, &energy);
    store_friction(m, place.is_near, &f, history);
    const vec stored = (real)0.5 * law->normal * depth * depth;
    const vec area = only_counted(&m->counted, j, place.area);
    totals->normal += choose(place.is_near, area * stored, splat(0));
    totals->tangential += choose(place.is_near, area * energy.tangential, splat(0));
    totals->friction += choose(place.is_near, area * energy.friction, splat(0));
    totals->deepest = maximum(totals->deepest, depth);
    add_forces_at(m, fields, strip, &place, j, f.drag, law->normal * depth);
}

static void add_forces(const struct wb_swept_tape_contact_kernel_model *m,
                       const struct wb_swept_cohesion_fields *fields, void *history,
                       double time_step, struct wb_swept_tape_contact_sums *sums)
{
    struct contact_law law = {
        .normal = splat((real)m->normal),
        .tangential = splat((real)m->shear),
        .compliance = splat((real)(1.0 / m->shear)),
    };
    struct totals totals = {{0}, {0}, {0}, {0}};

    set_friction(&law, &m->friction, time_step);
    for (int b = 0; b < m->n_blocks; b++) {
        for (int s = m->first[b]; s < m->first[b + 1]; s++) {
            const struct wb_swept_tape_contact_strip *strip = &m->strip[s];
            const real *rows =
                (const real *)m->rows + (size_t)s * WB_SWEPT_TAPE_CONTACT_ROWS * BLOCK;
            real *own = (real *)history +
                        (size_t)strip->node * WB_SWEPT_TAPE_CONTACT_HISTORY * (size_t)m->stride;
            for (int lane = 0; lane < BLOCK; lane += LANES)
                run_strip(m, &law, fields, strip, rows + lane, b * BLOCK + lane,
                          own + b * BLOCK + lane, &totals);
        }
    }
    for (int i = 0; i < LANES; i++) {
        sums->normal += (double)totals.normal[i];
        sums->tangential += (double)totals.tangential[i];
        sums->friction += (double)totals.friction[i];
        sums->deepest = fmax(sums->deepest, (double)totals.deepest[i]);
    }
}

const struct wb_swept_tape_contact_kernel KERNEL_VERSION(wb_swept_tape_contact_kernel) = {
    add_forces};
