#include "fe/swept/swept_tape_contact.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "fe/swept/swept_private.h"
#include "fe/swept/swept_tape_contact_kernel.h"

#define WB_LOG_DOMAIN "swept"

enum {
    LANES = WB_SWEPT_LANES,
    ROWS = WB_SWEPT_TAPE_CONTACT_ROWS,
    HISTORY = WB_SWEPT_TAPE_CONTACT_HISTORY
};

static const struct wb_swept_tape_contact_kernel *const kernels[][2] =
    WB_SWEPT_KERNEL_VERSIONS(wb_swept_tape_contact_kernel);

static const double default_margin = 0.05; /* over the smallest radius */
static const int default_interval = 100;
/* Factor on the near distance beyond which a wire is skipped without further checks, valid even for
 * a bend radius of this many wire radii. */
static const double far_off = 1.25;
static const double sharpest_bend = 10.0;
/* Radii that a node may slide before its contact point is updated. Each update resets the gap along
 * the director to that of the circle without work of the forces: if it happened in every vibration,
 * a tape would draw energy from it. */
static const double kept_slip = 0.02;

struct surface {
    int n;
    int *node;     /* (n) */
    double radius; /* m */
};

/* Contact point of a node on a wire. */
struct near_place {
    int wire, partner[2], station;
    double gap, round, along, offset;
    double aside, inwards; /* the centre, relative to the middle between the two surface nodes */
};

struct wb_swept_tape_contact {
    const struct wb_swept_tape *tape;             /* borrowed */
    const struct wb_swept_tape_model *tape_model; /* the tape's */
    const struct wb_swept_cohesion *cohesion;     /* borrowed; NULL: no bonds */
    struct wb_swept_tape_contact_settings settings;
    const struct wb_swept_tape_contact_kernel *kernel;
    struct wb_swept_tape_contact_kernel_model model;
    int n_wires;
    struct surface *surface;                   /* (n_wires) */
    int *surface_nodes;                        /* of all wires */
    double *centre, *axis;                     /* (n_wires x 3 x n_stations), at the last refresh */
    int *first;                                /* (n_blocks + 1) */
    struct wb_swept_tape_contact_strip *strip; /* capacity: one per node and station */
    void *rows, *history;
    struct near_place *near; /* (n_nodes x n_stations); wire -1: no contact */
    int n_strips, n_near;
    long long steps;
    struct wb_memory memory; /* of all arrays */
};

static const struct wb_swept_layout *layout_of(const struct wb_swept_tape_contact *c)
{
    return &c->tape_model->layout;
}

static size_t real_size(const struct wb_swept_tape_contact *c)
{
    return wb_swept_kernel_real_size(c->tape_model->double_precision);
}

static void put(const struct wb_swept_tape_contact *c, void *numbers, size_t at, double value)
{
    wb_swept_kernel_put(c->tape_model->double_precision, numbers, (ptrdiff_t)at, value);
}

/* --- search --- */

static void read_node(const struct wb_swept_tape_contact *c, const double *field, int k, int j,
                      double out[3])
{
    const size_t stride = (size_t)layout_of(c)->stride;
    for (int i = 0; i < 3; i++)
        out[i] = field[(size_t)(3 * k + i) * stride + (size_t)j];
}

/* Component `i` of a wire's centre or axis, at all stations. */
static double *row_of(const struct wb_swept_tape_contact *c, double *rows, int wire, int i)
{
    return rows + (size_t)(3 * wire + i) * (size_t)layout_of(c)->n_stations;
}

/* Tangents to the centre lines, m per station. */
static void find_axes(struct wb_swept_tape_contact *c)
{
    const int last = layout_of(c)->n_stations - 1;

    for (int row = 0; row < 3 * c->n_wires; row++) {
        const double *centre = row_of(c, c->centre, row / 3, row % 3);
        double *axis = row_of(c, c->axis, row / 3, row % 3);
        for (int j = 0; j <= last; j++) {
            const int before = j > 0 ? j - 1 : 0, after = j < last ? j + 1 : last;
            axis[j] = (centre[after] - centre[before]) / (after - before);
        }
    }
}

static enum wb_status find_centres(struct wb_swept_tape_contact *c, const double *const *position)
{
    const struct wb_swept_layout *layout = layout_of(c);
    double check = 0.0;

    for (int w = 0; w < c->n_wires; w++) {
        const struct surface *surface = &c->surface[w];
        for (int i = 0; i < 3; i++) {
            double *row = row_of(c, c->centre, w, i);
            for (int j = 0; j < layout->n_stations; j++)
                row[j] = 0.0;
            for (int s = 0; s < surface->n; s++) {
                const double *x =
                    position[w] + (size_t)(3 * surface->node[s] + i) * (size_t)layout->stride;
                for (int j = 0; j < layout->n_stations; j++)
                    row[j] += x[j] / surface->n;
            }
            for (int j = 0; j < layout->n_stations; j++)
                check += row[j];
        }
    }
    if (!isfinite(check))
        return wb_fail_to(c->settings.reason, WB_ERR_DATA,
                          "positions of a wire under the tape are not finite");
    find_axes(c);
    return WB_OK;
}

/* The position along a wire opposite to x at station j: integer part in near->station, fraction in
 * near->along; computes the centre there and the axis, a unit vector. False beyond the ends. */
static bool find_place_along(const struct wb_swept_tape_contact *c, const double x[3], int j,
                             struct near_place *near, double centre[3], double axis[3])
{
    const int last = layout_of(c)->n_stations - 1;
    double from[3];

    for (int i = 0; i < 3; i++) {
        axis[i] = row_of(c, c->axis, near->wire, i)[j];
        from[i] = x[i] - row_of(c, c->centre, near->wire, i)[j];
    }
    const double length = wb_vec3_dot(axis, axis), shift = wb_vec3_dot(from, axis) / length;
    const double slack = 0.01; /* tolerance at the ends, in stations */
    double at = j + shift;
    if (!(at >= -slack && at <= last + slack))
        return false;
    at = fmin(fmax(at, 0.0), last);
    const int whole = (int)at < last ? (int)at : last - 1;
    near->station = whole - j;
    near->along = at - whole;
    for (int i = 0; i < 3; i++) {
        const double *row = row_of(c, c->centre, near->wire, i);
        centre[i] = (1.0 - near->along) * row[whole] + near->along * row[whole + 1];
        axis[i] /= sqrt(length);
    }
    return true;
}

/* Position of a wire's surface node there. */
static void read_surface(const struct wb_swept_tape_contact *c, const double *position, int node,
                         int j, const struct near_place *near, double out[3])
{
    double here[3], there[3];

    read_node(c, position, node, j + near->station, here);
    read_node(c, position, node, j + near->station + 1, there);
    for (int i = 0; i < 3; i++)
        out[i] = (1.0 - near->along) * here[i] + near->along * there[i];
}

/* The two surface nodes between which the line through x in a direction (perpendicular to the axis)
 * passes, and the weight; of two intersections the farther one in that direction. */
static bool find_place_round(const struct wb_swept_tape_contact *c, const double *position,
                             const double x[3], const double direction[3], const double axis[3],
                             int j, struct near_place *near, double place[3])
{
    const struct surface *surface = &c->surface[near->wire];
    double across[3], before[3] = {0.0}, u_before = 0.0, v_before = 0.0,
                      farthest = -(double)INFINITY;

    wb_vec3_cross(axis, direction, across);
    for (int s = 0; s <= surface->n; s++) {
        double at[3], from[3];
        const int node = surface->node[s % surface->n];
        read_surface(c, position, node, j, near, at);
        for (int i = 0; i < 3; i++)
            from[i] = at[i] - x[i];
        const double u = wb_vec3_dot(from, direction), v = wb_vec3_dot(from, across);
        if (s > 0 && (v >= 0.0) != (v_before >= 0.0)) {
            const double w = v_before / (v_before - v);
            const double there = (1.0 - w) * u_before + w * u;
            if (there > farthest) {
                farthest = there;
                near->round = w;
                near->partner[0] = surface->node[s - 1];
                near->partner[1] = node;
                for (int i = 0; i < 3; i++)
                    place[i] = (1.0 - w) * before[i] + w * at[i];
            }
        }
        memcpy(before, at, sizeof before);
        u_before = u;
        v_before = v;
    }
    return isfinite(farthest);
}

static bool is_bonded(const struct wb_swept_tape_contact *c, int k, int j, int wire)
{
    return c->cohesion && wb_swept_cohesion_partner(c->cohesion, k, j) == wire &&
           wb_swept_cohesion_damage(c->cohesion, k, j) < 1.0;
}

/* True if a wire's centre line may come as near to x as `reach`, judged from its station j: the
 * line may bend at most with its largest curvature. */
static bool may_be_near(const struct wb_swept_tape_contact *c, const double x[3], int w, int j,
                        double reach)
{
    double from[3], axis[3];

    for (int i = 0; i < 3; i++) {
        from[i] = x[i] - row_of(c, c->centre, w, i)[j];
        axis[i] = row_of(c, c->axis, w, i)[j];
    }
    const double along = wb_vec3_dot(from, axis),
                 shift_square = along * along / wb_vec3_dot(axis, axis);
    const double sag = shift_square / (2.0 * sharpest_bend * c->surface[w].radius);
    const double beside = far_off * reach + sag;
    return wb_vec3_dot(from, from) - shift_square <= beside * beside;
}

/* The wire nearest to a node, within the margin. */
static bool find_wire(const struct wb_swept_tape_contact *c, const double x[3], int k, int j,
                      struct near_place *best, double centre[3], double axis[3])
{
    const double half = 0.5 * c->tape_model->thickness;

    best->wire = -1;
    best->gap = c->settings.margin;
    for (int w = 0; w < c->n_wires; w++) {
        struct near_place near = {.wire = w};
        double at[3], along[3], from[3];
        if (!may_be_near(c, x, w, j, c->surface[w].radius + half + best->gap) ||
            is_bonded(c, k, j, w) || !find_place_along(c, x, j, &near, at, along))
            continue;
        for (int i = 0; i < 3; i++)
            from[i] = x[i] - at[i];
        const double beside = wb_vec3_dot(from, along);
        near.gap = sqrt(fmax(wb_vec3_dot(from, from) - beside * beside, 0.0)) -
                   c->surface[w].radius - half;
        if (near.gap >= best->gap)
            continue;
        *best = near;
        memcpy(centre, at, sizeof at);
        memcpy(axis, along, sizeof along);
    }
    return best->wire >= 0;
}

/* --- strips --- */

static int find_strip(struct wb_swept_tape_contact *c, int k, const struct near_place *near,
                      int from)
{
    for (int s = from; s < c->n_strips; s++) {
        const struct wb_swept_tape_contact_strip *strip = &c->strip[s];
        if (strip->wire == near->wire && strip->partner[0] == near->partner[0] &&
            strip->partner[1] == near->partner[1] && strip->station == near->station)
            return s;
    }
    const size_t size = ROWS * LANES * real_size(c);
    memset((unsigned char *)c->rows + (size_t)c->n_strips * size, 0, size);
    c->strip[c->n_strips] = (struct wb_swept_tape_contact_strip){
        k,
        near->wire,
        {near->partner[0], near->partner[1]},
        near->station,
        c->surface[near->wire].radius + 0.5 * c->tape_model->thickness};
    return c->n_strips++;
}

static void clear_friction(struct wb_swept_tape_contact *c, int k, int j)
{
    const size_t stride = (size_t)layout_of(c)->stride;

    for (int i = 0; i < WB_SWEPT_TAPE_CONTACT_BEFORE; i++)
        put(c, c->history, (size_t)(k * HISTORY + i) * stride + (size_t)j, 0.0);
}

/* Writes the values of a node near a wire to its strip. */
static void track_node(struct wb_swept_tape_contact *c, int k, int j, const struct near_place *near,
                       int s)
{
    const size_t at = (size_t)s * ROWS * LANES + (size_t)(j % LANES);

    put(c, c->rows, at + WB_SWEPT_TAPE_CONTACT_ROUND * LANES, near->round);
    put(c, c->rows, at + WB_SWEPT_TAPE_CONTACT_ALONG * LANES, near->along);
    put(c, c->rows, at + WB_SWEPT_TAPE_CONTACT_OFFSET * LANES, near->offset);
    put(c, c->rows, at + WB_SWEPT_TAPE_CONTACT_ASIDE * LANES, near->aside);
    put(c, c->rows, at + WB_SWEPT_TAPE_CONTACT_INWARDS * LANES, near->inwards);
    put(c, c->rows, at + WB_SWEPT_TAPE_CONTACT_AREA * LANES, wb_swept_tape_area(c->tape, k, j));
    c->n_near++;
}

static void begin_slip(struct wb_swept_tape_contact *c, int k, int j, const double aside[3])
{
    const size_t stride = (size_t)layout_of(c)->stride;

    for (int i = 0; i < 3; i++)
        put(c, c->history,
            (size_t)(k * HISTORY + WB_SWEPT_TAPE_CONTACT_BEFORE + i) * stride + (size_t)j,
            aside[i]);
}

/* Subtracts a vector's component along a unit vector; returns the length of the rest. */
static double take_out(double v[3], const double unit[3])
{
    const double along = wb_vec3_dot(v, unit);

    for (int i = 0; i < 3; i++)
        v[i] -= along * unit[i];
    return sqrt(wb_vec3_dot(v, v));
}

/* True if a node is still close enough to its last contact point. */
static bool is_still_near(const struct wb_swept_tape_contact *c, const double *position,
                          const struct near_place *near, int j, const double x[3],
                          const double d[3])
{
    const double size = sqrt(wb_vec3_dot(d, d));
    double a[3], b[3], g[3], unit[3];

    read_surface(c, position, near->partner[0], j, near, a);
    read_surface(c, position, near->partner[1], j, near, b);
    for (int i = 0; i < 3; i++) {
        unit[i] = d[i] / size;
        g[i] = x[i] - near->offset * d[i] - (1.0 - near->round) * a[i] - near->round * b[i];
    }
    return take_out(g, unit) < kept_slip * c->surface[near->wire].radius;
}

/* The centre relative to the middle between the two surface nodes, in the frame that rotates with
 * them (as find_depth() of the kernel uses it). */
static void find_centre_beside(const struct wb_swept_tape_contact *c, const double *position, int j,
                               const double centre[3], const double axis[3],
                               struct near_place *near)
{
    double a[3], b[3], chord[3], across[3], from[3];

    read_surface(c, position, near->partner[0], j, near, a);
    read_surface(c, position, near->partner[1], j, near, b);
    for (int i = 0; i < 3; i++) {
        chord[i] = b[i] - a[i];
        from[i] = centre[i] - 0.5 * (a[i] + b[i]);
    }
    const double length = take_out(chord, axis);
    wb_vec3_cross(axis, chord, across);
    near->aside = wb_vec3_dot(from, chord) / length;
    near->inwards = wb_vec3_dot(from, across) / length;
}

/* The point on the wire below a node. It is searched for along the inward director, so that g
 * initially has no component across it; if there is none, towards the centre. False if there is
 * none. */
static bool find_place(const struct wb_swept_tape_contact *c, const double *position, int j,
                       const double x[3], const double d[3], const double centre[3],
                       const double axis[3], struct near_place *near, double aside[3])
{
    const double size = sqrt(wb_vec3_dot(d, d));
    double radial[3], direction[3], place[3] = {0.0};

    for (int i = 0; i < 3; i++)
        radial[i] = x[i] - centre[i];
    (void)take_out(radial, axis);
    const double outwards = wb_vec3_dot(d, radial) < 0.0 ? -1.0 : 1.0;
    for (int i = 0; i < 3; i++)
        direction[i] = outwards * d[i];
    const double length = take_out(direction, axis);
    if (!(length > 0.1 && find_place_round(c, position, x, direction, axis, j, near, place)) &&
        !find_place_round(c, position, x, radial, axis, j, near, place))
        return false;

    for (int i = 0; i < 3; i++) {
        aside[i] = x[i] - place[i];
        direction[i] = d[i] / size;
    }
    near->offset = (wb_vec3_dot(aside, direction) - outwards * near->gap) / size;
    (void)take_out(aside, direction);
    find_centre_beside(c, position, j, centre, axis, near);
    return true;
}

/* Searches for contact of a node at a station, and tracks it if it is near a wire. Strips of the
 * node in this block begin at `from`. */
static enum wb_status search_node(struct wb_swept_tape_contact *c,
                                  const struct wb_swept_cohesion_fields *fields, int k, int j,
                                  int from)
{
    struct near_place *now = &c->near[k * layout_of(c)->n_stations + j];
    const struct near_place before = *now;
    double x[3], d[3], centre[3] = {0.0}, axis[3] = {0.0}, aside[3];
    struct near_place near = {.wire = -1};

    read_node(c, fields->tape.position, k, j, x);
    read_node(c, fields->tape.director, k, j, d);
    if (!isfinite(wb_vec3_dot(x, x) + wb_vec3_dot(d, d)))
        return wb_fail_to(c->settings.reason, WB_ERR_DATA, "positions of the tape are not finite");
    now->wire = -1;
    if (!find_wire(c, x, k, j, &near, centre, axis))
        return WB_OK;
    if (near.gap < -0.5 * c->surface[near.wire].radius)
        return wb_fail_to(c->settings.reason, WB_ERR_DATA, "the tape penetrates wire %d by %.3g mm",
                          near.wire + 1, -1e3 * near.gap);
    const double *position = fields->position[near.wire];
    if (before.wire == near.wire && is_still_near(c, position, &before, j, x, d)) {
        near = before;
    } else if (find_place(c, position, j, x, d, centre, axis, &near, aside)) {
        if (before.wire != near.wire)
            clear_friction(c, k, j);
        begin_slip(c, k, j, aside);
    } else {
        return WB_OK;
    }
    track_node(c, k, j, &near, find_strip(c, k, &near, from));
    *now = near;
    return WB_OK;
}

static enum wb_status refresh(struct wb_swept_tape_contact *c,
                              const struct wb_swept_cohesion_fields *fields)
{
    const struct wb_swept_layout *layout = layout_of(c);
    const int n_blocks = layout->stride / LANES;

    c->n_strips = c->n_near = 0;
    WB_TRY(find_centres(c, fields->position));
    for (int b = 0; b < n_blocks; b++) {
        c->first[b] = c->n_strips;
        for (int k = 0; k < layout->n_nodes; k++) {
            const int from = c->n_strips;
            for (int j = b * LANES; j < (b + 1) * LANES && j < layout->n_stations; j++)
                WB_TRY(search_node(c, fields, k, j, from));
        }
    }
    c->first[n_blocks] = c->n_strips;
    return WB_OK;
}

/* --- creation --- */

static enum wb_status check(const struct wb_swept_tape_contact_settings *s, int n_wires,
                            const struct wb_swept_wire *wires)
{
    if (!wb_swept_is_positive(s->normal_stiffness) || !wb_swept_is_positive(s->shear_stiffness))
        return wb_fail(WB_ERR_ARGUMENT,
                       "contact of the tape: the normal stiffness is %g Pa/m and the shear "
                       "stiffness %g Pa/m: expected numbers above 0",
                       s->normal_stiffness, s->shear_stiffness);
    if (!(s->friction.mu_kinetic >= 0.0 && s->friction.mu_static >= s->friction.mu_kinetic &&
          isfinite(s->friction.mu_static)) ||
        !(s->friction.decay >= 0.0 && isfinite(s->friction.decay)))
        return wb_fail(
            WB_ERR_ARGUMENT,
            "friction of the tape: static coefficient %g, kinetic coefficient %g, decay %g s/m: "
            "expected 0 or more, and the static coefficient not below the kinetic one",
            s->friction.mu_static, s->friction.mu_kinetic, s->friction.decay);
    if (!(s->margin >= 0.0 && isfinite(s->margin)) || s->refresh_interval < 0)
        return wb_fail(WB_ERR_ARGUMENT,
                       "contact of the tape: the margin is %g m and the refresh interval %d steps: "
                       "expected 0 or more",
                       s->margin, s->refresh_interval);
    for (int w = 0; w < n_wires; w++) {
        if (!wb_swept_is_positive(wires[w].radius) || wires[w].n_surface < 3)
            return wb_fail(WB_ERR_ARGUMENT,
                           "wire %d has a radius of %g m and %d surface nodes: expected a radius "
                           "above 0 and at least 3 nodes",
                           w + 1, wires[w].radius, wires[w].n_surface);
    }
    return WB_OK;
}

static void copy_wires(struct wb_swept_tape_contact *c, const struct wb_swept_wire *wires)
{
    double smallest = (double)INFINITY;
    size_t nodes = 0;

    for (int w = 0; w < c->n_wires; w++)
        nodes += (size_t)wires[w].n_surface;
    c->surface = wb_memory_take(&c->memory, (size_t)c->n_wires + 1, sizeof *c->surface);
    c->surface_nodes = wb_memory_take(&c->memory, nodes + 1, sizeof *c->surface_nodes);
    nodes = 0;
    for (int w = 0; w < c->n_wires; w++) {
        c->surface[w] =
            (struct surface){wires[w].n_surface, c->surface_nodes + nodes, wires[w].radius};
        memcpy(c->surface[w].node, wires[w].surface,
               (size_t)wires[w].n_surface * sizeof *c->surface[w].node);
        nodes += (size_t)wires[w].n_surface;
        smallest = fmin(smallest, wires[w].radius);
    }
    if (c->settings.margin == 0.0)
        c->settings.margin = default_margin * smallest;
}

static void allocate(struct wb_swept_tape_contact *c)
{
    const struct wb_swept_layout *layout = layout_of(c);
    const size_t places = (size_t)layout->n_nodes * (size_t)layout->n_stations;
    const size_t n_blocks = (size_t)layout->stride / LANES;

    c->first = wb_memory_take(&c->memory, n_blocks + 1, sizeof *c->first);
    c->strip = wb_memory_take(&c->memory, places, sizeof *c->strip);
    c->near = wb_memory_take(&c->memory, places, sizeof *c->near);
    c->centre = wb_memory_take(&c->memory, 3 * (size_t)c->n_wires * (size_t)layout->n_stations + 1,
                               sizeof *c->centre);
    c->axis = wb_memory_take(&c->memory, 3 * (size_t)c->n_wires * (size_t)layout->n_stations + 1,
                             sizeof *c->axis);
    c->rows = wb_swept_take(&c->memory, places * ROWS * LANES, real_size(c));
    c->history = wb_swept_take(
        &c->memory, (size_t)layout->n_nodes * HISTORY * (size_t)layout->stride, real_size(c));
}

static void fill(struct wb_swept_tape_contact *c, const struct wb_swept_wire *wires)
{
    const struct wb_swept_layout *layout = layout_of(c);
    const struct wb_swept_tape_contact_settings *s = &c->settings;

    c->kernel = kernels[c->tape_model->instructions][c->tape_model->double_precision];
    if (c->settings.refresh_interval == 0)
        c->settings.refresh_interval = default_interval;
    copy_wires(c, wires);
    allocate(c);
    c->model = (struct wb_swept_tape_contact_kernel_model){
        .n_stations = layout->n_stations,
        .stride = layout->stride,
        .n_blocks = layout->stride / LANES,
        .first = c->first,
        .strip = c->strip,
        .rows = c->rows,
        .normal = s->normal_stiffness,
        .shear = s->shear_stiffness,
        .friction = s->friction,
        .counted = wb_swept_range_within(c->tape_model->counted, layout->n_stations),
    };
    wb_swept_tape_contact_reset(c);
}

enum wb_status wb_swept_tape_contact_create(struct wb_swept_tape_contact **out,
                                            const struct wb_swept_tape *tape,
                                            const struct wb_swept_cohesion *cohesion,
                                            const struct wb_swept_tape_contact_settings *settings,
                                            int n_wires, const struct wb_swept_wire *wires)
{
    *out = NULL;
    WB_TRY(check(settings, n_wires, wires));
    struct wb_swept_tape_contact *const c = wb_memory_new(1, sizeof *c);
    c->tape = tape;
    c->tape_model = wb_swept_tape_get_model(tape);
    c->cohesion = cohesion;
    c->settings = *settings;
    c->n_wires = n_wires;
    fill(c, wires);
    *out = c;
    return WB_OK;
}

void wb_swept_tape_contact_destroy(struct wb_swept_tape_contact *contact)
{
    if (!contact)
        return;
    wb_memory_release(&contact->memory);
    free(contact);
}

void wb_swept_tape_contact_reset(struct wb_swept_tape_contact *contact)
{
    const struct wb_swept_layout *layout = layout_of(contact);

    contact->steps = 0;
    contact->n_strips = contact->n_near = 0;
    for (int i = 0; i < layout->n_nodes * layout->n_stations; i++)
        contact->near[i].wire = -1;
}

enum wb_status wb_swept_tape_contact_add_forces(struct wb_swept_tape_contact *contact,
                                                const struct wb_swept_cohesion_fields *fields,
                                                double time_step,
                                                struct wb_swept_tape_contact_sums *sums)
{
    if (contact->steps == 0)
        WB_TRY(refresh(contact, fields));
    contact->kernel->add_forces(&contact->model, fields, contact->history, time_step, sums);
    /* Refresh after the forces: the slip of each step then refers to one contact point. */
    if (++contact->steps % contact->settings.refresh_interval == 0)
        WB_TRY(refresh(contact, fields));
    return WB_OK;
}

int wb_swept_tape_contact_near(const struct wb_swept_tape_contact *contact)
{
    return contact->n_near;
}

/* --- checkpoints --- */

/* Includes unused capacity, so that sizes are fixed. */
void wb_swept_tape_contact_visit(struct wb_swept_tape_contact *contact,
                                 struct wb_checkpoint *checkpoint)
{
    const struct wb_swept_layout *layout = layout_of(contact);
    const size_t nodes = (size_t)layout->n_nodes, stride = (size_t)layout->stride;
    const size_t places = nodes * (size_t)layout->n_stations, real = real_size(contact);

    wb_checkpoint_enter(checkpoint, "tape contact");
    wb_checkpoint_visit_member(checkpoint, contact, steps);
    wb_checkpoint_visit_member(checkpoint, contact, n_strips);
    wb_checkpoint_visit_member(checkpoint, contact, n_near);
    wb_checkpoint_visit(checkpoint, "first", contact->first,
                        (stride / LANES + 1) * sizeof *contact->first);
    wb_checkpoint_visit(checkpoint, "strip", contact->strip, places * sizeof *contact->strip);
    wb_checkpoint_visit(checkpoint, "near", contact->near, places * sizeof *contact->near);
    wb_checkpoint_visit(checkpoint, "rows", contact->rows, places * ROWS * LANES * real);
    wb_checkpoint_visit(checkpoint, "history", contact->history, nodes * HISTORY * stride * real);
    wb_checkpoint_leave(checkpoint);
}

/* --- stable step --- */

static double largest_stiffness(const struct wb_swept_tape_contact *c)
{
    return fmax(c->settings.normal_stiffness, c->settings.shear_stiffness);
}

/* Factor for moving both sides; see fe/swept/swept_cohesion.c. */
static const double both_sides = 2.0;

static double largest_area(const struct wb_swept_tape_contact *c)
{
    const struct wb_swept_layout *layout = layout_of(c);
    double area = 0.0;

    for (int k = 0; k < layout->n_nodes; k++) {
        for (int j = 1; j < layout->n_stations - 1; j++)
            area = fmax(area, wb_swept_tape_area(c->tape, k, j));
        for (int j = 0; j < layout->n_stations; j += layout->n_stations - 1)
            area = fmax(area, 2.0 * wb_swept_tape_area(c->tape, k, j));
    }
    return area;
}

double wb_swept_tape_contact_stiffness_per_mass(const struct wb_swept_tape_contact *contact,
                                                const double *mass, const double *inertia)
{
    double most = 0.0;

    for (int w = 0; w < contact->n_wires; w++) {
        /* The contact point lies on a chord, at most this far below the circle. */
        const double below = contact->surface[w].radius * (1.0 - cos(M_PI / contact->surface[w].n));
        const double o = 0.5 * contact->tape_model->thickness + below;
        for (int k = 0; k < layout_of(contact)->n_nodes; k++)
            most = fmax(most, 1.0 / mass[k] + o * o / inertia[k]);
    }
    return both_sides * largest_stiffness(contact) * largest_area(contact) * most;
}

double wb_swept_tape_contact_wire_stiffness_per_mass(const struct wb_swept_tape_contact *contact,
                                                     int wire, const double *mass)
{
    const struct surface *surface = &contact->surface[wire];
    const double spacing = contact->tape_model->spacing, area = largest_area(contact);
    /* A surface node carries the tape's nodes on its two chords, with weights from 0 to 1: at most
     * one more than the nodes of a chord. */
    const double chord = 2.0 * surface->radius * sin(M_PI / surface->n);
    const double nodes = chord * spacing / area + 1.0;
    double least = (double)INFINITY;

    for (int s = 0; s < surface->n; s++)
        least = fmin(least, mass[surface->node[s]]);
    return both_sides * largest_stiffness(contact) * area * nodes / least;
}
