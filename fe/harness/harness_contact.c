#include "fe/harness/harness_contact.h"

#include <math.h>
#include <string.h>

#include "base/vec3.h"

enum {
    SAMPLES = 33, /* of an element, between which a gap has one minimum */
    MAX_REFINEMENTS = 40
};

/* A gap along an element counts larger by half of this part of the wire's radius at its ends than
 * in its middle, so that it has a minimum where the wire lies flat. */
static const double rounding = 5e-3;

/* A minimum is beside a joint at this part of half of an element. */
static const double beside = 0.1;

/* The stiffness of places that touch is at first this part of what it is at last, and grows by this
 * factor each time that the forces balance; friction begins likewise. In a second trial it begins
 * softer. */
static const double soft = 1e-3, softest = 3e-5, stiffest = 3.0, growth = 30.0;
/* Gaps that become smaller by this ratio at least need no growth beyond a factor of 1. */
static const double enough = 0.1;
static const double least_relaxation = 0.1;

/* Arm at which the rotation of a normal is a way, over the length of the harness; part of its way
 * by which a place moves along the wire that counts. */
static const double turn_arm = 1e-4, along_part = 1e-6;

static const struct wb_rod_node *node_of(const struct wb_harness *h, int e, int n)
{
    return &h->placed[NODES * e + n];
}

static double half_length(const struct wb_harness *h, int e)
{
    return 0.5 * h->elements[e].shape.length;
}

/* Of a place that touches, N/m. */
static double stiffness_of(const struct wb_harness *h, int e)
{
    return h->contact_factor * h->elements[e].contact_stiffness;
}

/* The part of an element, from -1 to 1, that can touch: beside a held joint only what is two radii
 * and more away, since a wire in a clip that sits on an obstacle may begin inside. */
static void find_part(const struct wb_harness *h, int e, double *low, double *high)
{
    const double aside = 2.0 * h->elements[e].radius / half_length(h, e);
    *low = wb_harness_is_held(h, h->elements[e].near) ? -1.0 + aside : -1.0;
    *high = wb_harness_is_held(h, e + 1) ? 1.0 - aside : 1.0;
}

/* Looks at the place `c->at` of an element. Returns the derivative of the gap, with that of its
 * rounding, by the place; `c->bend` is the second. */
static double look_at(const struct wb_harness *h, struct wb_harness_contact *c)
{
    const int e = c->touch.element;
    const double z = c->at, half = half_length(h, e), round = rounding * h->elements[e].radius;
    double along[3], bend[3];
    wb_rod_shape_at(z, 2.0 * half, c->N, c->dN);
    for (int k = 0; k < 3; k++) {
        const double p[NODES] = {node_of(h, e, 0)->position[k], node_of(h, e, 1)->position[k],
                                 node_of(h, e, 2)->position[k]};
        c->position[k] = c->N[0] * p[0] + c->N[1] * p[1] + c->N[2] * p[2];
        along[k] = half * (c->dN[0] * p[0] + c->dN[1] * p[1] + c->dN[2] * p[2]);
        bend[k] = p[0] - 2.0 * p[1] + p[2];
    }
    c->gap = wb_obstacle_distance(&h->obstacles[c->touch.obstacle], c->position, c->normal,
                                  c->curvature) -
             h->elements[e].radius + 0.5 * round * z * z;
    wb_vec3_turn(c->curvature, along, c->turned);
    c->bend = wb_vec3_dot(along, c->turned) + wb_vec3_dot(c->normal, bend) + round;
    return wb_vec3_dot(c->normal, along) + round * z;
}

/* Moves a place to the minimum of the gap between two others. */
static void refine(const struct wb_harness *h, struct wb_harness_contact *c, double low,
                   double high)
{
    for (int i = 0; i < MAX_REFINEMENTS; i++) {
        const double slope = look_at(h, c), step = c->bend > 0.0 ? -slope / c->bend : 0.0;
        if (fabs(step) < 1e-15 && c->bend > 0.0)
            return;
        if (slope > 0.0)
            high = c->at;
        else
            low = c->at;
        c->at = c->bend > 0.0 && c->at + step > low && c->at + step < high ? c->at + step
                                                                           : 0.5 * (low + high);
        if (!(high - low > 1e-15))
            return;
    }
}

/* False if an element cannot touch an obstacle: a distance grows at most as the way. */
static bool is_near(const struct wb_harness *h, int e, int obstacle)
{
    double normal[3], curvature[9];
    const double *const middle = node_of(h, e, 1)->position;
    const double distance =
        wb_obstacle_distance(&h->obstacles[obstacle], middle, normal, curvature);
    const double farthest = fmax(wb_vec3_distance(node_of(h, e, 0)->position, middle),
                                 wb_vec3_distance(node_of(h, e, 2)->position, middle));
    return distance - 1.01 * h->elements[e].radius < 1.2 * farthest;
}

static double arc_length_of(const struct wb_harness *h, int e, double at)
{
    return h->elements[e].begin + (1.0 + at) * half_length(h, e);
}

/* The nearest of the places found to one that was known, nearer than `most` along the wire; -1 if
 * there is none. */
static int nearest_to(const struct wb_harness *h, const struct wb_harness_touch *t, bool is_fixed,
                      double most)
{
    const int e = t->element;
    const int end = h->first_contact[e + 1 < h->n_elements ? e + 2 : h->n_elements];
    int nearest = -1;
    for (int i = h->first_contact[e > 0 ? e - 1 : 0]; i < end; i++) {
        const struct wb_harness_contact *const c = &h->contacts[i];
        const double away =
            fabs(arc_length_of(h, e, t->at) - arc_length_of(h, c->touch.element, c->at));
        if (t->obstacle != c->touch.obstacle || is_fixed != c->touch.is_fixed || c->is_beside ||
            h->elements[e].branch != h->elements[c->touch.element].branch || !(away < most))
            continue;
        most = away;
        nearest = i;
    }
    return nearest;
}

/* A place that is no more leaves its force to one beside it. */
static int heir_of(const struct wb_harness *h, const struct wb_harness_touch *t)
{
    const double length = h->elements[t->element].shape.length;
    const int own = nearest_to(h, t, t->is_fixed, t->is_fixed ? 1e-3 * length : length);
    return own >= 0 ? own : nearest_to(h, t, !t->is_fixed, length);
}

/* A joint beside which the gap has a minimum does not touch: the minimum does. */
static void pass_over_joints(struct wb_harness *h)
{
    for (int i = 0; i < h->n_contacts; i++) {
        struct wb_harness_contact *const c = &h->contacts[i];
        if (!c->touch.is_fixed)
            continue;
        const int minimum =
            nearest_to(h, &c->touch, false, beside * half_length(h, c->touch.element));
        c->is_beside = minimum >= 0 && h->contacts[minimum].gap < c->gap;
    }
}

static void inherit(struct wb_harness *h)
{
    for (int k = 0; k < h->now.n; k++) {
        const struct wb_harness_touch *const t = &h->now.touch[k];
        const int i = heir_of(h, t);
        if (i < 0)
            continue;
        struct wb_harness_touch *const to = &h->contacts[i].touch;
        if (t->multiplier >= to->multiplier) {
            memcpy(to->normal, t->normal, sizeof to->normal);
            to->at = t->element == h->contacts[i].touch.element ? t->at : h->contacts[i].at;
        }
        to->multiplier += t->multiplier;
        to->expected += t->expected;
        to->pressed += t->pressed;
        to->missing = t->missing;
    }
    for (int k = 0; k < h->committed_touches.n; k++) {
        const struct wb_harness_touch *const t = &h->committed_touches.touch[k];
        const int i = heir_of(h, t);
        if (i >= 0)
            memcpy(h->contacts[i].touch.slip, t->slip, sizeof t->slip);
    }
}

/* Motion of the wire along the surface since the last commit. */
static void find_slip(const struct wb_harness *h, struct wb_harness_contact *c)
{
    const double most = wb_harness_presliding(h) / fmin(h->contact_factor, 1.0);
    double *const slip = c->touch.slip;
    double dN[NODES];
    wb_rod_shape_at(c->touch.at, 2.0 * half_length(h, c->touch.element), c->rubbing, dN);
    for (int n = 0; n < NODES; n++) {
        const double *const was =
            h->committed_nodes[wb_harness_node_of(h, c->touch.element, n)].position;
        const double *const is = node_of(h, c->touch.element, n)->position;
        for (int k = 0; k < 3; k++)
            slip[k] += c->rubbing[n] * (is[k] - was[k]) / most;
    }
    const double along = wb_vec3_dot(slip, c->touch.normal);
    for (int k = 0; k < 3; k++)
        slip[k] -= along * c->touch.normal[k];
    const double size = wb_vec3_length(slip);
    c->slips = size > 1.0;
    c->rate = 1.0 / (most * fmax(size, 1.0));
    for (int k = 0; k < 3; k++)
        slip[k] /= fmax(size, 1.0);
}

static void add_place(struct wb_harness *h, const struct wb_harness_contact *place)
{
    h->is_crowded |= h->n_contacts == h->most_contacts;
    if (h->is_crowded)
        return;
    struct wb_harness_contact *const c = &h->contacts[h->n_contacts++];
    *c = *place;
    c->touch.at = c->at;
    c->touch.missing = (double)NAN;
    memcpy(c->touch.normal, c->normal, sizeof c->normal);
}

static struct wb_harness_contact place_on(int e, int obstacle, double at)
{
    return (struct wb_harness_contact){.touch = {.element = e, .obstacle = obstacle}, .at = at};
}

static void add_fixed(struct wb_harness *h, int e, int obstacle, double at)
{
    struct wb_harness_contact place = place_on(e, obstacle, at);
    place.touch.is_fixed = true;
    (void)look_at(h, &place);
    add_place(h, &place);
}

/* The minima of the gap inside of an element, and its far end. */
static void look_at_element(struct wb_harness *h, int e, int obstacle)
{
    double low, high, slope_before = 0.0;
    find_part(h, e, &low, &high);
    if (!(low < high))
        return;
    const double step = (high - low) / (SAMPLES - 1);
    for (int i = 0; i < SAMPLES; i++) {
        struct wb_harness_contact place =
            place_on(e, obstacle, i < SAMPLES - 1 ? low + i * step : high);
        const double slope = look_at(h, &place);
        if (slope_before < 0.0 && slope > 0.0) {
            refine(h, &place, place.at - step, place.at);
            add_place(h, &place);
        }
        slope_before = slope;
    }
    if (low > -1.0)
        add_fixed(h, e, obstacle, low);
    add_fixed(h, e, obstacle, high);
}

void wb_harness_contact_find(struct wb_harness *h)
{
    h->n_contacts = 0;
    h->is_crowded = false;
    for (int e = 0; e < h->n_elements && h->n_obstacles > 0; e++) {
        h->first_contact[e] = h->n_contacts;
        for (int o = 0; o < h->n_obstacles; o++) {
            if (is_near(h, e, o))
                look_at_element(h, e, o);
        }
        h->first_contact[e + 1] = h->n_contacts;
    }
    if (h->n_obstacles > 0) {
        pass_over_joints(h);
        inherit(h);
    }
    int n = 0;
    for (int e = 0, i = 0; e < h->n_elements && h->n_obstacles > 0; e++) {
        const int end = h->first_contact[e + 1];
        h->first_contact[e] = n;
        for (; i < end; i++) {
            struct wb_harness_contact c = h->contacts[i];
            c.force = fmax(c.touch.multiplier - stiffness_of(h, e) * c.gap, 0.0);
            if (c.is_beside || !(c.force > 0.0 || c.touch.multiplier > 0.0))
                continue;
            find_slip(h, &c);
            h->contacts[n++] = c;
        }
    }
    h->n_contacts = n;
    if (h->n_obstacles > 0)
        h->first_contact[h->n_elements] = n;
}

/* --- forces --- */

static double friction_of(const struct wb_harness *h, const struct wb_harness_contact *c)
{
    return h->obstacles[c->touch.obstacle].friction * c->touch.pressed;
}

/* How far a place is from its obstacle; the angle by which the normal differs from that known
 * counts as a way. */
static double distance_of(const struct wb_harness *h, const struct wb_harness_contact *c)
{
    double way = fabs(c->gap);
    if (friction_of(h, c) > 0.0) {
        const double turn = wb_vec3_distance(c->normal, c->touch.normal);
        const double moved = fabs(c->at - c->touch.at) * half_length(h, c->touch.element);
        const double missing = fabs(c->force - c->touch.pressed);
        way = fmax(way, fmax(turn_arm * h->length * turn, along_part * moved));
        way = fmax(way, missing / h->elements[c->touch.element].contact_stiffness);
    }
    return way;
}

void wb_harness_contact_add_forces(struct wb_harness *h, struct wb_harness_balance *balance)
{
    wb_harness_contact_find(h);
    for (int i = 0; i < h->n_contacts; i++) {
        const struct wb_harness_contact *const c = &h->contacts[i];
        for (int n = 0; n < NODES; n++) {
            double *const to = h->residual[wb_harness_node_of(h, c->touch.element, n)];
            for (int k = 0; k < 3; k++)
                to[k] -= c->N[n] * c->force * c->normal[k] -
                         c->rubbing[n] * friction_of(h, c) * c->touch.slip[k];
        }
        balance->farthest_contact = wb_larger(balance->farthest_contact, distance_of(h, c));
        balance->largest_contact =
            wb_larger(balance->largest_contact, fmax(c->force, c->touch.multiplier));
    }
    if (h->is_crowded)
        balance->farthest_contact = (double)NAN;
}

/* Adds N_a M N_b to the stiffness between the positions of nodes a and b. */
static void add_block(struct wb_rod_element_stiffness *stiffness, const double N[NODES],
                      const double M[9])
{
    for (int a = 0; a < NODES; a++) {
        for (int b = 0; b < NODES; b++) {
            for (int r = 0; r < 3; r++) {
                for (int k = 0; k < 3; k++)
                    stiffness->K[a][b][U * r + k] += N[a] * N[b] * M[3 * r + k];
            }
        }
    }
}

/* The place of a minimum moves as the wire does, which makes the gap smaller by a^2 / 2 over its
 * second derivative, for the derivative a of its slope. */
static void add_moving_place(struct wb_rod_element_stiffness *stiffness,
                             const struct wb_harness_contact *c, double half)
{
    double a[NODES][3];
    for (int n = 0; n < NODES; n++) {
        for (int k = 0; k < 3; k++)
            a[n][k] = c->N[n] * c->turned[k] + half * c->dN[n] * c->normal[k];
    }
    for (int n = 0; n < NODES; n++) {
        for (int m = 0; m < NODES; m++) {
            for (int r = 0; r < 3; r++) {
                for (int k = 0; k < 3; k++)
                    stiffness->K[n][m][U * r + k] +=
                        c->touch.expected / c->bend * a[n][r] * a[m][k];
            }
        }
    }
}

void wb_harness_contact_add_stiffness(const struct wb_harness *h, int element,
                                      struct wb_rod_element_stiffness *stiffness)
{
    if (h->n_obstacles == 0)
        return;
    for (int i = h->first_contact[element]; i < h->first_contact[element + 1]; i++) {
        const struct wb_harness_contact *const c = &h->contacts[i];
        const double pushes = c->force > 0.0 ? stiffness_of(h, element) : 0.0;
        const double rubs = friction_of(h, c) * c->rate;
        const double *const n = c->normal, *const slip = c->touch.slip;
        const double *const known = c->touch.normal;
        double normal[9], along[9];
        for (int r = 0; r < 3; r++) {
            for (int k = 0; k < 3; k++) {
                normal[3 * r + k] =
                    pushes * n[r] * n[k] - c->touch.expected * c->curvature[3 * r + k];
                along[3 * r + k] = rubs * ((r == k ? 1.0 : 0.0) - known[r] * known[k] -
                                           (c->slips ? slip[r] * slip[k] : 0.0));
            }
        }
        add_block(stiffness, c->N, normal);
        add_block(stiffness, c->rubbing, along);
        if (!c->touch.is_fixed && c->bend > 0.0)
            add_moving_place(stiffness, c, half_length(h, element));
    }
}

void wb_harness_contact_advance(struct wb_harness *h)
{
    h->now.n = h->n_contacts;
    for (int i = 0; i < h->n_contacts; i++) {
        const struct wb_harness_contact *const c = &h->contacts[i];
        double way = 0.0;
        for (int n = 0; n < NODES; n++)
            way += c->N[n] *
                   wb_vec3_dot(c->normal, h->increment[wb_harness_node_of(h, c->touch.element, n)]);
        h->now.touch[i] = c->touch;
        h->now.touch[i].expected =
            c->force > 0.0 ? fmax(c->force - stiffness_of(h, c->touch.element) * way, 0.0) : 0.0;
    }
}

/* --- what is known --- */

static void take_forces(const struct wb_harness *h, struct wb_harness_touches *to)
{
    to->n = h->n_contacts;
    for (int i = 0; i < h->n_contacts; i++) {
        const struct wb_harness_contact *const c = &h->contacts[i];
        to->touch[i] = c->touch;
        to->touch[i].multiplier = to->touch[i].expected = c->force;
        to->touch[i].at = c->at;
        memcpy(to->touch[i].normal, c->normal, sizeof c->normal);
    }
}

/* Aitken's relaxation for vectors (Irons and Tuck 1969): where more friction takes force from the
 * places that rub, the forces would alternate without an end. */
static void relax(struct wb_harness *h)
{
    double change = 0.0, along = 0.0;
    for (int i = 0; i < h->n_contacts; i++) {
        const struct wb_harness_contact *const c = &h->contacts[i];
        const double missing = c->force - c->touch.pressed;
        if (isnan(c->touch.missing))
            continue;
        change += (missing - c->touch.missing) * (missing - c->touch.missing);
        along += c->touch.missing * (missing - c->touch.missing);
    }
    if (change > 0.0)
        h->relaxation =
            along < 0.0 ? fmin(fmax(-h->relaxation * along / change, least_relaxation), 1.0) : 1.0;
    for (int i = 0; i < h->n_contacts; i++) {
        struct wb_harness_touch *const t = &h->contacts[i].touch;
        const bool is_new = isnan(t->missing);
        t->missing = h->contacts[i].force - t->pressed;
        t->pressed += (is_new ? 1.0 : h->relaxation) * t->missing;
    }
}

void wb_harness_adapt_contacts(struct wb_harness *h)
{
    double gap = 0.0;
    for (int i = 0; i < h->n_contacts; i++)
        gap = fmax(gap, distance_of(h, &h->contacts[i]));
    relax(h);
    take_forces(h, &h->now);
    if (h->contact_factor < 1.0)
        h->contact_factor = fmin(h->contact_factor * growth, 1.0);
    else if (gap > enough * h->last_gap)
        h->contact_factor = fmin(h->contact_factor * growth, stiffest);
    h->last_gap = gap;
}

void wb_harness_contact_commit(struct wb_harness *h)
{
    take_forces(h, &h->committed_touches);
}

void wb_harness_contact_revert(struct wb_harness *h)
{
    h->contact_factor = soft;
    h->last_gap = (double)INFINITY;
    h->relaxation = 1.0;
    h->now.n = h->committed_touches.n;
    for (int i = 0; i < h->now.n; i++) {
        h->now.touch[i] = h->committed_touches.touch[i];
        h->now.touch[i].missing = (double)NAN;
    }
}

bool wb_harness_soften_contacts(struct wb_harness *h)
{
    h->contact_factor = softest;
    return h->n_obstacles > 0;
}

/* --- passing through --- */

/* Half of the smallest size of an obstacle, m. */
static double half_size(const struct wb_obstacle *o)
{
    switch (o->kind) {
    case WB_OBSTACLE_CYLINDER:
        return fmin(o->size[0], 0.5 * o->size[1]);
    case WB_OBSTACLE_BOX:
        return 0.5 * fmin(fmin(o->size[0], o->size[1]), o->size[2]);
    default:
        return (double)INFINITY;
    }
}

/* Whether a place of an element was inside of an obstacle on its way since the last commit. */
static bool passes(const struct wb_harness *h, int e, int obstacle, double at)
{
    const struct wb_obstacle *const o = &h->obstacles[obstacle];
    double N[NODES], dN[NODES], was[3] = {0}, is[3] = {0}, normal[3], curvature[9];
    wb_rod_shape_at(at, h->elements[e].shape.length, N, dN);
    for (int n = 0; n < NODES; n++) {
        const double *const before = h->committed_nodes[wb_harness_node_of(h, e, n)].position;
        for (int k = 0; k < 3; k++) {
            was[k] += N[n] * before[k];
            is[k] += N[n] * node_of(h, e, n)->position[k];
        }
    }
    const int steps = (int)fmin(2.0 * wb_vec3_distance(was, is) / half_size(o), 1e3);
    for (int i = 1; i <= steps; i++) {
        double between[3];
        for (int k = 0; k < 3; k++)
            between[k] = was[k] + (is[k] - was[k]) * i / (steps + 1);
        if (wb_obstacle_distance(o, between, normal, curvature) < 0.0)
            return true;
    }
    return false;
}

bool wb_harness_passes_through(const struct wb_harness *h)
{
    for (int o = 0; o < h->n_obstacles; o++) {
        for (int e = 0; e < h->n_elements; e++) {
            const int places =
                1 + (int)fmin(h->elements[e].shape.length / half_size(&h->obstacles[o]), 1e3);
            for (int i = 0; i <= places; i++) {
                if (passes(h, e, o, -1.0 + 2.0 * i / places))
                    return true;
            }
        }
    }
    return false;
}

/* --- results --- */

void wb_harness_obstacle_force(const struct wb_harness *h, int obstacle, double force[6])
{
    memset(force, 0, U * sizeof *force);
    for (int i = 0; i < h->n_contacts; i++) {
        const struct wb_harness_contact *const c = &h->contacts[i];
        if (c->touch.obstacle != obstacle)
            continue;
        double part[3];
        for (int k = 0; k < 3; k++)
            part[k] = c->force * c->normal[k];
        wb_harness_add_force(force, part, c->position);
        for (int n = 0; n < NODES; n++) {
            for (int k = 0; k < 3; k++)
                part[k] = -c->rubbing[n] * friction_of(h, c) * c->touch.slip[k];
            wb_harness_add_force(force, part, node_of(h, c->touch.element, n)->position);
        }
    }
}

double wb_harness_depth(const struct wb_harness *h, int *obstacle, int *branch, double *arc_length)
{
    double most = 0.0;
    for (int i = 0; i < h->n_elements * h->n_obstacles * SAMPLES; i++) {
        const int e = i / SAMPLES / h->n_obstacles;
        double low, high;
        find_part(h, e, &low, &high);
        if (!(low < high))
            continue;
        struct wb_harness_contact c = place_on(e, i / SAMPLES % h->n_obstacles,
                                               low + (high - low) * (i % SAMPLES) / (SAMPLES - 1));
        (void)look_at(h, &c);
        if (-c.gap <= most)
            continue;
        most = -c.gap;
        *obstacle = c.touch.obstacle;
        *branch = h->elements[e].branch;
        *arc_length = arc_length_of(h, e, c.at);
    }
    return most;
}
