#include "fe/trial/roller.h"

#include <math.h>

enum {
    NODES = WB_BEAM_ELEMENT_NODES,
    UNKNOWNS = 3 * NODES
};

/* Position, rotation and their derivatives with respect to arc length at a point of an element. */
struct at {
    double x, y, t, x_, y_, t_;
};

static struct at interpolate(const struct wb_beam_node *node, const double N[NODES],
                             const double dN[NODES])
{
    struct at at = {0};
    for (int i = 0; i < NODES; i++) {
        at.x += N[i] * node[i].x;
        at.y += N[i] * node[i].y;
        at.t += N[i] * node[i].t;
        at.x_ += dN[i] * node[i].x;
        at.y_ += dN[i] * node[i].y;
        at.t_ += dN[i] * node[i].t;
    }
    return at;
}

/* (x - c) . (cos t, sin t): negative before the contact point, positive after it. */
static double signed_distance(const struct wb_roller *r, double x, double y, double t)
{
    return (x - r->x) * cos(t) + (y - r->y) * sin(t);
}

static double node_signed_distance(const struct wb_roller *r, const struct wb_beam_node *node)
{
    return signed_distance(r, node->x, node->y, node->t);
}

bool wb_roller_find(const struct wb_roller *roller, const struct wb_beam *beam, double near,
                    struct wb_roller_place *place)
{
    const struct wb_beam_node *nodes = wb_beam_nodes(beam);
    const int n_elements = (wb_beam_count_nodes(beam) - 1) / 2;
    const double h = wb_beam_element_length(beam);
    int e = (int)fmin(fmax(floor(near / h), 0.0), n_elements - 1);

    while (node_signed_distance(roller, &nodes[2 * e + 2]) < 0.0) {
        if (++e == n_elements)
            return false;
    }
    while (node_signed_distance(roller, &nodes[2 * e]) > 0.0) {
        if (--e < 0)
            return false;
    }
    if (!isfinite(node_signed_distance(roller, &nodes[2 * e])))
        return false;

    /* Newton's method with a bracket. */
    const struct wb_beam_node *node = nodes + 2 * e;
    double low = -1.0, high = 1.0, z = fmin(fmax(2.0 * (near / h - e) - 1.0, -1.0), 1.0);
    struct at at;
    for (int i = 0; i < 100; i++) {
        wb_rod_shape_at(z, h, place->N, place->dN);
        at = interpolate(node, place->N, place->dN);
        const double miss = signed_distance(roller, at.x, at.y, at.t);
        if (miss > 0.0)
            high = z;
        else
            low = z;
        const double c = cos(at.t), s = sin(at.t);
        const double g = (at.y - roller->y) * c - (at.x - roller->x) * s;
        const double slope = 0.5 * h * (at.x_ * c + at.y_ * s + g * at.t_);
        double next = z - miss / slope;
        if (!(next >= low && next <= high))
            next = 0.5 * (low + high);
        if (fabs(next - z) <= 1e-15 || high - low <= 1e-15)
            break;
        z = next;
    }
    place->element = e;
    place->arc = h * (e + 0.5 * (z + 1.0));
    place->angle = at.t;
    place->distance = (at.y - roller->y) * cos(at.t) - (at.x - roller->x) * sin(at.t);
    return true;
}

bool wb_roller_press(const struct wb_roller *roller, const struct wb_beam *beam,
                     const struct wb_roller_state *state, struct wb_roller_contact *contact)
{
    struct wb_roller_place *const p = &contact->place;
    if (!wb_roller_find(roller, beam, state->arc, p))
        return false;
    const struct at at = interpolate(wb_beam_nodes(beam) + 2 * p->element, p->N, p->dN);
    const double c = cos(p->angle), s = sin(p->angle), g = p->distance;
    const double a = at.x_ * c + at.y_ * s, b = at.y_ * c - at.x_ * s;
    const double k = roller->stiffness, arm = roller->wire_radius;
    const double own_radius = roller->radius - roller->wire_radius;

    contact->normal = k * (roller->radius - g);
    contact->slip = -(own_radius * (p->angle - state->angle) + p->arc - state->arc);
    const double stuck = state->friction - roller->sticking * contact->slip;
    /* During Newton iterations the normal force may be negative. The friction limit then follows it
     * without a kink, because a kink makes the iteration cycle. */
    const double most = roller->friction * contact->normal;
    const double direction = copysign(1.0, stuck);
    const bool slides = fabs(stuck) > most;
    contact->friction = slides ? direction * most : stuck;

    /* Derivatives with respect to the element's unknowns of the contact's arc length, angle,
     * distance, and both forces. */
    double ds[UNKNOWNS], dt[UNKNOWNS], dn[UNKNOWNS], df[UNKNOWNS];
    for (int i = 0; i < UNKNOWNS; i++) {
        const double N = p->N[i / 3];
        const double along = i % 3 == 0 ? N * c : i % 3 == 1 ? N * s : 0.0;
        const double across = i % 3 == 0 ? -N * s : i % 3 == 1 ? N * c : 0.0;
        const double turn = i % 3 == 2 ? N : 0.0;
        ds[i] = -(along + g * turn) / (a + g * at.t_);
        dt[i] = turn + at.t_ * ds[i];
        dn[i] = -k * (across + b * ds[i]);
        df[i] = slides ? direction * roller->friction * dn[i]
                       : roller->sticking * (own_radius * dt[i] + ds[i]);
    }

    const double x = -contact->normal * s + contact->friction * c;
    const double y = contact->normal * c + contact->friction * s;
    const double moment = contact->friction * arm;
    for (int i = 0; i < NODES; i++) {
        contact->force[3 * i] = p->N[i] * x;
        contact->force[3 * i + 1] = p->N[i] * y;
        contact->force[3 * i + 2] = p->N[i] * moment;
        for (int j = 0; j < UNKNOWNS; j++) {
            const double dx = -dn[j] * s + df[j] * c - y * dt[j];
            const double dy = dn[j] * c + df[j] * s + x * dt[j];
            contact->tangent[3 * i][j] = p->N[i] * dx + p->dN[i] * x * ds[j];
            contact->tangent[3 * i + 1][j] = p->N[i] * dy + p->dN[i] * y * ds[j];
            contact->tangent[3 * i + 2][j] = p->N[i] * df[j] * arm + p->dN[i] * moment * ds[j];
        }
    }
    return true;
}

double wb_roller_commit(const struct wb_roller *roller, const struct wb_roller_contact *contact,
                        struct wb_roller_state *state)
{
    /* Slip minus the elastic part in the sticking spring. */
    const double slid = contact->slip + (contact->friction - state->friction) / roller->sticking;
    const double work = -0.5 * (contact->friction + state->friction) * slid;
    state->arc = contact->place.arc;
    state->angle = contact->place.angle;
    state->friction = contact->friction;
    return work;
}
