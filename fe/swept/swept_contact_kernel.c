/* Contact of swept wires, compiled once for each type and instruction set (see
 * swept_contact_kernel.h).
 *
 * Three passes over blocks of stations: gather reads nodes and computes frames; press computes the
 * forces of all pairs of wires at the pairs' own stations; scatter sums them for each wire and
 * distributes them to its nodes. All loads are along rows: contact positions lie between stations,
 * at offsets that differ from lane to lane. The kernel therefore loops over the integer offsets of
 * a block (few, because slip varies slowly along wires) with the weights max(0, 1 - |offset -
 * integer|), which are zero in most lanes.
 *
 * Gather and press are long chains of dependent operations. They prepare several vectors before
 * computing them, so that branches do not prevent the processor from overlapping them. */
#include "fe/swept/swept_contact_kernel.h"
#include "fe/swept/swept_contact_law.h"
#include "fe/swept/swept_simd.h"

typedef long long part_bits __attribute__((vector_size(BYTES), may_alias));

enum {
    BLOCK = WB_SWEPT_LANES,
    MAX_FRAMES = 8,
    MAX_MEETINGS = 16
};

/* A wire's centre and its two vectors. */
struct frame {
    struct wide c[3], pq[6];
};

INLINE int block_end(const struct wb_swept_contact_model *m, int block)
{
    const int end = (block + 1) * BLOCK;
    return end < m->n_stations ? end : m->n_stations;
}

INLINE vec load_anywhere(const real *at)
{
    vec out;
    memcpy(&out, at, sizeof out);
    return out;
}

INLINE struct wide multiply_add(struct wide a, struct wide b, struct wide sum)
{
    for (int i = 0; i < PARTS; i++)
        sum.of[i] += a.of[i] * b.of[i];
    return sum;
}

INLINE void read_frame(const struct wb_swept_contact_frames *wire, const double *position,
                       ptrdiff_t stride, struct frame *frame)
{
    for (int p = 0; p < PARTS; p++) {
        part sum[9];
        for (int i = 0; i < 9; i++)
            sum[i] = (part){0};
        for (int k = 0; k < wire->n_surface; k++) {
            const double *at = position + 3 * wire->node[k] * stride + p * PART_LANES;
            const double *weight = wire->weight[k];
            for (int i = 0; i < 3; i++) {
                const part x = *(const part_anywhere *)(at + i * stride);
                sum[i] += weight[0] * x;
                sum[3 + i] += weight[1] * x;
                sum[6 + i] += weight[2] * x;
            }
        }
        for (int i = 0; i < 9; i++)
            (i < 3 ? &frame->c[i] : &frame->pq[i - 3])->of[p] = sum[i];
    }
}

/* J's inverse, zero if it is singular. */
INLINE void invert(const vec pq[6], vec out[6])
{
    const vec *p = pq, *q = pq + 3, size = dot(p, p) + dot(q, q);
    const vec xx = size - p[0] * p[0] - q[0] * q[0], xy = -p[0] * p[1] - q[0] * q[1];
    const vec yy = size - p[1] * p[1] - q[1] * q[1], xz = -p[0] * p[2] - q[0] * q[2];
    const vec zz = size - p[2] * p[2] - q[2] * q[2], yz = -p[1] * p[2] - q[1] * q[2];
    const vec a = yy * zz - yz * yz, b = xz * yz - xy * zz, c = xy * yz - xz * yy;
    const vec det = xx * a + xy * b + xz * c;
    const mask regular = above(det, splat(0));
    const vec inverse = choose(regular, 1 / choose(regular, det, splat(1)), splat(0));

    out[0] = a * inverse;
    out[1] = (xx * zz - xz * xz) * inverse;
    out[2] = (xx * yy - xy * xy) * inverse;
    out[3] = b * inverse;
    out[4] = c * inverse;
    out[5] = (xy * xz - xx * yz) * inverse;
}

INLINE void multiply(const vec m[6], const vec v[3], vec out[3])
{
    out[0] = m[0] * v[0] + m[3] * v[1] + m[4] * v[2];
    out[1] = m[3] * v[0] + m[1] * v[1] + m[5] * v[2];
    out[2] = m[4] * v[0] + m[5] * v[1] + m[2] * v[2];
}

/* Writes the frame and its change; returns a value that is finite if the frame is. */
INLINE vec write_frame(const struct wb_swept_contact_model *m,
                       const struct wb_swept_contact_frames *wire, int j, const struct frame *frame)
{
    const ptrdiff_t stride = m->stride, row = m->row;
    double *centre = wire->centre + j, *fixed = wire->fixed + j;
    real *turn_at = (real *)wire->turn + j, *inverse_at = (real *)wire->inverse + j;
    vec pq[6], middle[6], inverse[6], change[6], turn[3], check = splat(0);
    vec work[3] = {splat(0), splat(0), splat(0)};

    for (int i = 0; i < 3; i++) {
        store_wide(fixed + (WB_SWEPT_CONTACT_BEFORE + i) * stride, load_wide(centre + i * row));
        store_wide(centre + i * row, frame->c[i]);
        check += narrow(frame->c[i]);
    }
    for (int i = 0; i < 6; i++) {
        double *at = fixed + (WB_SWEPT_CONTACT_P + i) * stride;
        pq[i] = narrow(frame->pq[i]);
        change[i] = m->started ? narrow(subtract(frame->pq[i], load_wide(at))) : splat(0);
        store_wide(at, frame->pq[i]);
        middle[i] = pq[i] - (real)0.5 * change[i];
        check += pq[i];
    }
    add_cross(middle, change, work);
    add_cross(middle + 3, change + 3, work);
    invert(middle, inverse);
    multiply(inverse, work, turn);
    invert(pq, inverse);
    for (int i = 0; i < 3; i++)
        store(turn_at + i * row, turn[i]);
    for (int i = 0; i < 6; i++)
        store(inverse_at + i * stride, inverse[i]);
    return check;
}

static double sum_of(vec v)
{
    real all[LANES];
    double sum[4] = {0.0, 0.0, 0.0, 0.0};

    memcpy(all, &v, sizeof all);
    for (int i = 0; i < LANES; i++)
        sum[i % 4] += (double)all[i];
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/* Clears lanes after the last station, because 0 x NaN would spread. */
static void clear_padding(struct frame *frame, int lanes)
{
    for (int i = 0; i < LANES; i++) {
        for (int c = 0; i >= lanes && c < 3; c++)
            frame->c[c].of[i / PART_LANES][i % PART_LANES] = 0.0;
        for (int c = 0; i >= lanes && c < 6; c++)
            frame->pq[c].of[i / PART_LANES][i % PART_LANES] = 0.0;
    }
}

/* Gathers vectors of a wire from station `first` to `end`, several at a time. */
INLINE vec gather_wire(const struct wb_swept_contact_model *m,
                       const struct wb_swept_contact_frames *wire, const double *position,
                       int first, int end)
{
    struct frame frame[MAX_FRAMES];
    vec check = splat(0);

    for (int j = first; j < end; j += MAX_FRAMES * LANES) {
        const int left = (end - j + LANES - 1) / LANES, n = left < MAX_FRAMES ? left : MAX_FRAMES;
        for (int i = 0; i < n; i++)
            read_frame(wire, position + j + i * LANES, m->stride, &frame[i]);
        if (j + n * LANES > end)
            clear_padding(&frame[n - 1], end - (j + (n - 1) * LANES));
        for (int i = 0; i < n; i++)
            check += write_frame(m, wire, j + i * LANES, &frame[i]);
    }
    return check;
}

static void gather(const struct wb_swept_contact_call *call)
{
    const struct wb_swept_contact_model *m = call->model;
    const int last = block_end(m, call->end_block - 1);
    vec check = splat(0);

    for (int w = 0; w < m->n_wires; w++)
        check += gather_wire(m, &m->wire[w], call->position[w], call->first_block * BLOCK, last);
    for (int b = call->first_block; b < call->end_block; b++)
        m->sums[b] = (struct wb_swept_contact_sums){0};
    m->sums[call->first_block].check = sum_of(check);
}

INLINE struct wide share_at(struct wide offset, double whole)
{
    const part_bits all_but_sign = (part_bits){0} + 0x7fffffffffffffff;
    struct wide out;
    for (int i = 0; i < PARTS; i++) {
        const part share = 1.0 - (part)((part_bits)(offset.of[i] - whole) & all_but_sign);
        out.of[i] = (part)((share > 0.0) & (part_bits)share);
    }
    return out;
}

/* A wire's centre and rotation at positions between stations. */
INLINE void interpolate(const struct wb_swept_contact_model *m,
                        const struct wb_swept_contact_frames *wire, int j, struct wide offset,
                        const struct wb_swept_contact_window *window, struct wide centre[3],
                        vec turn[3])
{
    const ptrdiff_t row = m->row;
    for (int i = 0; i < 3; i++) {
        centre[i] = splat_wide(0.0);
        turn[i] = splat(0);
    }
    for (int whole = window->first; whole <= window->last; whole++) {
        const struct wide share = share_at(offset, whole);
        const vec narrow_share = narrow(share);
        const double *at = wire->centre + j + whole;
        const real *turn_at = (const real *)wire->turn + j + whole;
        for (int i = 0; i < 3; i++) {
            centre[i] = multiply_add(share, load_wide(at + i * row), centre[i]);
            turn[i] += narrow_share * load_anywhere(turn_at + i * row);
        }
    }
}

/* Contact points prepared for computation. */
struct queue {
    int n;
    struct meeting at[MAX_MEETINGS];
    const struct wb_swept_contact_pair_rows *pair[MAX_MEETINGS];
    int station[MAX_MEETINGS];
};

/* The surfaces meet at c_a + share_a D = c_b - share_b D, one point in space, which moves with
 * either wire's rotation: a rigid motion of both causes no slip (exactly, with D at the middle of
 * the step), and forces cause no net moment. */
INLINE void meet(const struct wb_swept_contact_model *m,
                 const struct wb_swept_contact_pair_rows *pair, int j, struct meeting *at)
{
    const ptrdiff_t stride = m->stride;
    double *rows = pair->rows + j, *before = rows + WB_SWEPT_CONTACT_BETWEEN * stride;
    struct wide a[3], b[3];
    vec turn_a[3], turn_b[3], lever[3], middle[3];
    part square[PARTS];

    interpolate(m, &m->wire[pair->wire[0]], j, load_wide(rows), &pair->from[0][j / BLOCK], a,
                turn_a);
    interpolate(m, &m->wire[pair->wire[1]], j, load_wide(rows + stride), &pair->from[1][j / BLOCK],
                b, turn_b);
    for (int p = 0; p < PARTS; p++)
        square[p] = (part){0};
    for (int i = 0; i < 3; i++) {
        const struct wide between = subtract(b[i], a[i]);
        for (int p = 0; p < PARTS; p++)
            square[p] += between.of[p] * between.of[p];
        at->between[i] = narrow(between);
        at->step[i] = narrow(subtract(between, load_wide(before + i * stride)));
        store_wide(before + i * stride, between);
        middle[i] = at->between[i] - (real)0.5 * at->step[i];
        at->slip[i] = at->step[i];
        at->turn[i] = (real)0.5 * (turn_a[i] + turn_b[i]);
        lever[i] = (real)pair->share[0] * turn_a[i] + (real)pair->share[1] * turn_b[i];
    }
    struct wide depth;
    for (int p = 0; p < PARTS; p++)
        depth.of[p] = pair->reach - part_root(square[p]);
    at->depth = positive_part(narrow(depth));
    add_cross(middle, lever, at->slip);
}

INLINE void add_energy(const struct contact_energy *energy, vec length, struct contact_energy *sums)
{
    sums->normal += length * energy->normal;
    sums->tangential += length * energy->tangential;
    sums->friction += length * energy->friction;
    sums->damping += length * energy->damping;
}

INLINE void press_one(const struct wb_swept_contact_model *m, const struct meeting *at,
                      const struct wb_swept_contact_pair_rows *pair, int j, struct contact_law *law,
                      struct contact_energy *sums, vec *deepest)
{
    const ptrdiff_t row = m->row;
    real *rows = (real *)pair->load + j, *drag_at = rows + WB_SWEPT_CONTACT_DRAG * row;
    vec unit[3], force[3], drag[3], lost[3], couple[3] = {splat(0), splat(0), splat(0)};
    struct contact_energy energy;

    law->normal = splat((real)pair->normal);
    law->tangential = splat((real)pair->tangential);
    law->compliance = splat((real)pair->compliance);
    for (int i = 0; i < 3; i++) {
        drag[i] = load(drag_at + i * row);
        lost[i] = load(drag_at + (3 + i) * row);
    }
    const vec length = load(rows + WB_SWEPT_CONTACT_LENGTH * row);
    const vec normal = normal_force(law, at, unit, &energy);
    friction_force(law, at, unit, normal, drag, lost, &energy);
    add_energy(&energy, only_counted(&m->counted, j, length), sums);
    *deepest = maximum(*deepest, choose(above(length, splat(0)), at->depth, splat(0)));
    for (int i = 0; i < 3; i++)
        force[i] = length * (drag[i] - normal * unit[i]);
    add_cross(at->between, force, couple);
    for (int i = 0; i < 3; i++) {
        store(drag_at + i * row, drag[i]);
        store(drag_at + (3 + i) * row, lost[i]);
        store(rows + (WB_SWEPT_CONTACT_FORCE + i) * row, force[i]);
        store(rows + (WB_SWEPT_CONTACT_COUPLE + i) * row, couple[i]);
    }
}

static void press_queue(const struct wb_swept_contact_model *m, const struct contact_law *law,
                        struct queue *queue, struct contact_energy *sums, vec *deepest)
{
    struct contact_energy total = *sums;
    struct contact_law of_pair = *law;
    vec most = *deepest;

    for (int i = 0; i < queue->n; i++)
        press_one(m, &queue->at[i], queue->pair[i], queue->station[i], &of_pair, &total, &most);
    *sums = total;
    *deepest = most;
    queue->n = 0;
}

/* Computes the contact points of all pairs in the block; the last ones stay in the queue. */
static void press_block(const struct wb_swept_contact_model *m, const struct contact_law *law,
                        int block, struct queue *queue, struct contact_energy *sums, vec *deepest)
{
    for (int p = 0; p < m->n_pairs; p++) {
        if (!m->pair[p].active[block])
            continue;
        for (int j = block * BLOCK; j < block_end(m, block); j += LANES) {
            if (queue->n == MAX_MEETINGS)
                press_queue(m, law, queue, sums, deepest);
            meet(m, &m->pair[p], j, &queue->at[queue->n]);
            queue->pair[queue->n] = &m->pair[p];
            queue->station[queue->n++] = j;
        }
    }
}

/* The first block of a call receives the sums of all blocks. */
static void press(const struct wb_swept_contact_call *call)
{
    const struct wb_swept_contact_model *m = call->model;
    struct contact_law law = {.damping = splat((real)(m->damping_time / call->time_step))};
    struct contact_energy sums = {splat(0), splat(0), splat(0), splat(0)};
    struct wb_swept_contact_sums *out = &m->sums[call->first_block];
    vec deepest = splat(0);
    struct queue queue;

    set_friction(&law, &m->friction, call->time_step);
    queue.n = 0;
    for (int block = call->first_block; block < call->end_block; block++)
        press_block(m, &law, block, &queue, &sums, &deepest);
    press_queue(m, &law, &queue, &sums, &deepest);
    out->normal = sum_of(sums.normal);
    out->tangential = sum_of(sums.tangential);
    out->friction = sum_of(sums.friction);
    out->damping = sum_of(sums.damping);
    for (int i = 0; i < LANES; i++)
        out->deepest = (double)deepest[i] > out->deepest ? (double)deepest[i] : out->deepest;
}

/* Collects force and couple on a wire's stations from a pair. */
INLINE void collect(const struct wb_swept_contact_model *m,
                    const struct wb_swept_contact_pair_rows *pair, int side, int j, vec force[3],
                    vec couple[3])
{
    const ptrdiff_t row = m->row;
    const struct wb_swept_contact_window *window = &pair->to[side][j / BLOCK];
    const real sign = side == 0 ? 1 : -1, lever = (real)pair->share[side];

    for (int whole = window->first; whole <= window->last; whole++) {
        const real *rows = (const real *)pair->load + (j - whole);
        const vec offset = load_anywhere(rows + side * row);
        const vec share = positive_part(1 - size_of(offset - (real)whole));
        const vec of_force = sign * share, of_couple = lever * share;
        for (int i = 0; i < 3; i++) {
            force[i] += of_force * load_anywhere(rows + (WB_SWEPT_CONTACT_FORCE + i) * row);
            couple[i] += of_couple * load_anywhere(rows + (WB_SWEPT_CONTACT_COUPLE + i) * row);
        }
    }
}

/* f_k = a F + b (m x p) + e (m x q). */
INLINE void spread(const struct wb_swept_contact_model *m,
                   const struct wb_swept_contact_frames *wire, int j, const vec force[3],
                   const vec couple[3], real *out)
{
    const ptrdiff_t stride = m->stride;
    const double *fixed = wire->fixed + j;
    const real *inverse_at = (const real *)wire->inverse + j, *weight = wire->narrow_weight;
    vec inverse[6], turn[3], pq[6], of_p[3], of_q[3];

    for (int i = 0; i < 6; i++) {
        inverse[i] = load(inverse_at + i * stride);
        pq[i] = narrow(load_wide(fixed + (WB_SWEPT_CONTACT_P + i) * stride));
    }
    for (int i = 0; i < 3; i++)
        of_p[i] = of_q[i] = splat(0);
    multiply(inverse, couple, turn);
    add_cross(turn, pq, of_p);
    add_cross(turn, pq + 3, of_q);
    for (int k = 0; k < wire->n_surface; k++, weight += 3) {
        real *at = out + 3 * (ptrdiff_t)wire->node[k] * stride;
        for (int i = 0; i < 3; i++) {
            real *to = at + i * stride;
            store(to, load(to) + weight[0] * force[i] + weight[1] * of_p[i] + weight[2] * of_q[i]);
        }
    }
}

static void scatter(const struct wb_swept_contact_call *call)
{
    const struct wb_swept_contact_model *m = call->model;

    for (int b = call->first_block; b < call->end_block; b++) {
        for (int w = 0; w < m->n_wires; w++) {
            const struct wb_swept_contact_frames *wire = &m->wire[w];
            for (int j = b * BLOCK; wire->n_sides > 0 && j < block_end(m, b); j += LANES) {
                vec force[3] = {splat(0), splat(0), splat(0)};
                vec couple[3] = {splat(0), splat(0), splat(0)};
                for (int s = 0; s < wire->n_sides; s++)
                    collect(m, &m->pair[wire->side[s] / 2], wire->side[s] % 2, j, force, couple);
                spread(m, wire, j, force, couple, (real *)call->force[w] + j);
            }
        }
    }
}

const struct wb_swept_contact_kernel KERNEL_VERSION(wb_swept_contact_kernel) = {gather, press,
                                                                                scatter};
