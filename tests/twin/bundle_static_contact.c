#include <math.h>
#include <stdlib.h>

#include "tests/twin/bundle_static_private.h"

#define WB_LOG_DOMAIN "bundle_static"

enum {
    NODES = 4,        /* of a contact: two of each wire */
    MOST = 4 * NODES, /* unknowns */
    FACE_ITERATIONS = 8
};

static const double usual_stiffness = 0.25, usual_ratio = 0.5, usual_open = 1e-3;

enum wb_status wb_bundle_static_make_contact(struct wb_bundle_static *b)
{
    const struct wb_packing *packing = &b->model->packing;
    struct wb_packing_pair pairs[4 * WB_PACKING_MOST];
    double reach = b->wire[0].radius;

    if (b->settings.contact == WB_BUNDLE_STATIC_APART)
        return WB_OK;
    for (int w = 1; w < b->n_wires; w++)
        reach = fmin(reach, b->wire[w].radius);
    b->n_pairs = wb_packing_pairs(packing, 0.5 * reach, 4 * WB_PACKING_MOST, pairs);
    b->pair = calloc((size_t)b->n_pairs + 1, sizeof *b->pair);
    if (!b->pair)
        return wb_fail(WB_ERR_MEMORY, "out of memory for pairs of wires");
    for (int p = 0; p < b->n_pairs; p++) {
        struct wb_bundle_static_pair *pair = &b->pair[p];
        const struct wb_bundle_static_beam *first = &b->wire[pairs[p].a];
        const struct wb_bundle_static_beam *second = &b->wire[pairs[p].b];
        const double modulus = 2.0 * first->youngs_modulus * second->youngs_modulus /
                               (first->youngs_modulus + second->youngs_modulus);
        pair->wire[0] = pairs[p].a;
        pair->wire[1] = pairs[p].b;
        pair->reach = first->radius + second->radius;
        if (b->settings.contact != WB_BUNDLE_STATIC_TOUCHING)
            pair->reach += pairs[p].gap;
        pair->normal =
            modulus * (b->settings.stiffness > 0.0 ? b->settings.stiffness : usual_stiffness);
        pair->tangential =
            pair->normal *
            (b->settings.tangential_ratio > 0.0 ? b->settings.tangential_ratio : usual_ratio);
        pair->touch = calloc((size_t)b->n_stations, sizeof *pair->touch);
        if (!pair->touch)
            return wb_fail(WB_ERR_MEMORY, "out of memory for pairs of wires");
    }
    return WB_OK;
}

/* --- places that face each other --- */

/* Field of a wire at a place. */
static double at(const struct wb_bundle_static *b, double *state,
                 const struct wb_bundle_static_pair *pair,
                 const struct wb_bundle_static_touch *touch, int side, int field)
{
    const double *f = wb_bundle_static_wire_field(b, state, pair->wire[side], field);
    const int j = touch->node[side];
    return (1.0 - touch->part[side]) * f[j] + touch->part[side] * f[j + 1];
}

/* Puts both places `shift` apart, half to either side of station j. False: one is off its wire. */
static bool put(const struct wb_bundle_static *b, struct wb_bundle_static_touch *touch, int j,
                double shift)
{
    touch->shift = shift;
    for (int side = 0; side < 2; side++) {
        const double place = j + (side == 0 ? -0.5 : 0.5) * shift;
        if (!(place >= 0.0 && place <= b->n_elements))
            return false;
        touch->node[side] = (int)fmin(floor(place), b->n_elements - 1.0);
        touch->part[side] = place - touch->node[side];
    }
    return true;
}

struct across {
    double c, s;         /* of the mean rotation */
    double along, up, z; /* from the first place to the second in the mean section's frame, m */
    double angle[2];
};

static struct across look(const struct wb_bundle_static *b, double *state,
                          const struct wb_bundle_static_pair *pair,
                          const struct wb_bundle_static_touch *touch)
{
    struct across out;

    for (int side = 0; side < 2; side++)
        out.angle[side] = at(b, state, pair, touch, side, 3);
    const double mean = 0.5 * (out.angle[0] + out.angle[1]);
    const double x = at(b, state, pair, touch, 1, 0) - at(b, state, pair, touch, 0, 0);
    const double y = at(b, state, pair, touch, 1, 1) - at(b, state, pair, touch, 0, 1);
    out.c = cos(mean);
    out.s = sin(mean);
    out.along = x * out.c + y * out.s;
    out.up = y * out.c - x * out.s;
    out.z = at(b, state, pair, touch, 1, 2) - at(b, state, pair, touch, 0, 2);
    return out;
}

void wb_bundle_static_face(struct wb_bundle_static *b)
{
    for (int p = 0; p < b->n_pairs; p++) {
        const struct wb_bundle_static_pair *pair = &b->pair[p];
        for (int j = b->held; j < b->n_stations; j++) {
            struct wb_bundle_static_touch *touch = &pair->touch[j];
            /* What lay off a wire's end is looked for anew. */
            touch->active = put(b, touch, j, touch->shift) || put(b, touch, j, 0.0);
            for (int i = 0; i < FACE_ITERATIONS && touch->active; i++) {
                const double off = look(b, b->trial, pair, touch).along;
                if (fabs(off) < 1e-9 * b->h)
                    break;
                touch->active = put(b, touch, j, touch->shift - off / b->h);
            }
            if (!touch->active)
                continue;
            const struct across was = look(b, b->committed, pair, touch);
            touch->along = was.along;
            touch->angle[0] = was.angle[0];
            touch->angle[1] = was.angle[1];
        }
    }
}

/* --- forces --- */

/* Normal force and friction per length, and their derivatives by depth and slip. */
struct answer {
    double normal, drag;
    double normal_depth, drag_depth, drag_slip;
};

static struct answer press(const struct wb_bundle_static *b,
                           const struct wb_bundle_static_pair *pair,
                           struct wb_bundle_static_touch *touch, double depth, double slip)
{
    const double mu =
        b->settings.has_friction ? b->settings.friction : b->model->interface.friction_static;
    const double squeeze = b->settings.squeeze;
    struct answer out = {0};
    const bool glued = b->settings.contact == WB_BUNDLE_STATIC_GLUED;

    const bool open = depth <= 0.0 && b->settings.contact == WB_BUNDLE_STATIC_TOUCHING;
    const double share = !open                              ? 1.0
                         : b->settings.open_stiffness > 0.0 ? b->settings.open_stiffness
                                                            : usual_open;
    out.normal = share * pair->normal * depth;
    out.normal_depth = share * pair->normal;
    out.drag = touch->drag + pair->tangential * slip;
    out.drag_slip = pair->tangential;
    const double limit = mu * fmax(0.0, (b->frozen ? touch->pressure : out.normal) + squeeze);
    touch->limit = !glued && fabs(out.drag) > limit;
    touch->trial_slip = touch->slip;
    touch->trial_work = touch->work;
    if (touch->limit) {
        const double sign = out.drag > 0.0 ? 1.0 : -1.0;
        const double plastic = (fabs(out.drag) - limit) / pair->tangential;
        touch->trial_slip += sign * plastic;
        touch->trial_work += plastic * limit;
        out.drag = sign * limit;
        out.drag_slip = 0.0;
        out.drag_depth = limit > 0.0 && !b->frozen ? sign * mu * out.normal_depth : 0.0;
    }
    touch->trial_drag = out.drag;
    touch->normal = out.normal;
    touch->depth = depth;
    return out;
}

/* Gradients by x, y, z, t of the four nodes: of the distance's three components, of the mean
 * rotation, of both angles. */
struct gradients {
    double along[MOST], up[MOST], z[MOST], mean[MOST], angle[2][MOST];
};

static void find_gradients(const struct wb_bundle_static_touch *touch, const struct across *a,
                           struct gradients *g)
{
    *g = (struct gradients){0};
    for (int side = 0; side < 2; side++) {
        for (int end = 0; end < 2; end++) {
            const double part = end == 0 ? 1.0 - touch->part[side] : touch->part[side];
            const double sign = side == 0 ? -part : part;
            const int i = 4 * (2 * side + end);
            g->along[i] = sign * a->c;
            g->along[i + 1] = sign * a->s;
            g->up[i] = -sign * a->s;
            g->up[i + 1] = sign * a->c;
            g->z[i + 2] = sign;
            g->angle[side][i + 3] = part;
            g->mean[i + 3] = 0.5 * part;
            g->along[i + 3] = 0.5 * part * a->up;
            g->up[i + 3] = -0.5 * part * a->along;
        }
    }
}

static void add_touch(struct wb_bundle_static *b, const struct wb_bundle_static_pair *pair, int j)
{
    struct wb_bundle_static_touch *touch = &pair->touch[j];
    const struct across a = look(b, b->trial, pair, touch);
    const double distance = hypot(a.up, a.z), ny = a.up / distance, nz = a.z / distance;
    const double half = 0.5 * pair->reach, length = wb_bundle_static_length(b, j);
    /* Slip of the surfaces: of unequal wires their turning has a part in it. */
    const double lever[2] = {ny * (b->wire[pair->wire[0]].radius - half),
                             ny * (b->wire[pair->wire[1]].radius - half)};
    const double slip = a.along - touch->along + lever[0] * (a.angle[0] - touch->angle[0]) +
                        lever[1] * (a.angle[1] - touch->angle[1]);
    const struct answer r = press(b, pair, touch, pair->reach - distance, slip);
    struct wb_bundle_static_place place = {0};
    struct gradients g;
    double depth[MOST], across[MOST], slide[MOST], force[MOST], tangent[MOST * MOST];

    find_gradients(touch, &a, &g);
    for (int i = 0; i < MOST; i++) {
        depth[i] = -(ny * g.up[i] + nz * g.z[i]);
        across[i] = ny * g.z[i] - nz * g.up[i];
        slide[i] = g.along[i] + lever[0] * g.angle[0][i] + lever[1] * g.angle[1][i];
        force[i] = length * (r.normal * depth[i] + r.drag * slide[i]);
    }
    /* The law's derivatives, then how its directions turn. */
    for (int i = 0; i < MOST; i++) {
        for (int k = 0; k < MOST; k++) {
            const double law = r.normal_depth * depth[i] * depth[k] +
                               slide[i] * (r.drag_depth * depth[k] + r.drag_slip * slide[k]);
            const double bend = r.drag * (g.up[i] * g.mean[k] + g.mean[i] * g.up[k] +
                                          a.along * g.mean[i] * g.mean[k]);
            const double lean =
                r.normal * ny *
                (g.along[i] * g.mean[k] + g.mean[i] * g.along[k] - a.up * g.mean[i] * g.mean[k]);
            const double turn = r.normal / distance * across[i] * across[k];
            tangent[MOST * i + k] = length * (law + bend + lean - turn);
        }
    }
    for (int side = 0; side < 2; side++)
        for (int end = 0; end < 2; end++)
            for (int field = 0; field < 4; field++)
                wb_bundle_static_name_wire(b, pair->wire[side], field, touch->node[side] + end,
                                           &place);
    wb_bundle_static_add(b, &place, force, tangent);
}

void wb_bundle_static_add_contact(struct wb_bundle_static *b)
{
    for (int p = 0; p < b->n_pairs; p++)
        for (int j = b->held; j < b->n_stations; j++)
            if (b->pair[p].touch[j].active)
                add_touch(b, &b->pair[p], j);
}

void wb_bundle_static_freeze(struct wb_bundle_static *b)
{
    for (int p = 0; p < b->n_pairs; p++)
        for (int j = b->held; j < b->n_stations; j++)
            b->pair[p].touch[j].pressure = b->pair[p].touch[j].normal;
}

void wb_bundle_static_commit_contact(struct wb_bundle_static *b)
{
    for (int p = 0; p < b->n_pairs; p++) {
        for (int j = b->held; j < b->n_stations; j++) {
            struct wb_bundle_static_touch *touch = &b->pair[p].touch[j];
            if (!touch->active) {
                /* What has slid off its neighbour does not remember it. */
                touch->drag = touch->normal = touch->depth = 0.0;
                touch->limit = false;
                continue;
            }
            touch->drag = touch->trial_drag;
            touch->slip = touch->trial_slip;
            touch->work = touch->trial_work;
        }
    }
}

void wb_bundle_static_contact_energy(const struct wb_bundle_static *b, double *stored,
                                     double *dissipated)
{
    *stored = *dissipated = 0.0;
    for (int p = 0; p < b->n_pairs; p++) {
        const struct wb_bundle_static_pair *pair = &b->pair[p];
        for (int j = b->held; j < b->n_stations; j++) {
            const struct wb_bundle_static_touch *touch = &pair->touch[j];
            const double length = wb_bundle_static_length(b, j);
            *stored += 0.5 * length *
                       (touch->normal * touch->normal / pair->normal +
                        touch->drag * touch->drag / pair->tangential);
            *dissipated += length * touch->work;
        }
    }
}
