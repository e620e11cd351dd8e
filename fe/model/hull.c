#include "fe/model/hull.h"

#include <math.h>
#include <string.h>

#define WB_LOG_DOMAIN "hull"

/* Support function of a wire in the direction of a normal. */
static double support(const struct wb_packing_circle *wire, double normal)
{
    return wire->z * cos(normal) + wire->y * sin(normal) + wire->radius;
}

static struct wb_packing_circle tangent_point(const struct wb_packing_circle *wire, double normal)
{
    return (struct wb_packing_circle){wire->y + wire->radius * sin(normal),
                                      wire->z + wire->radius * cos(normal), 0.0};
}

/* Along the outline at a normal, counter-clockwise. */
static double tangential(const struct wb_packing_circle *from, const struct wb_packing_circle *to,
                         double normal)
{
    return (to->y - from->y) * cos(normal) - (to->z - from->z) * sin(normal);
}

/* --- arcs --- */

/* The wire that reaches farthest at a normal; of equal wires the rearmost along the outline. */
static int farthest(const struct wb_packing *packing, double normal)
{
    int best = 0;
    for (int i = 1; i < packing->n; i++) {
        const double more =
            support(&packing->wire[i], normal) - support(&packing->wire[best], normal);
        const double tie = 1e-12 * packing->wire[i].radius;
        const bool ahead = tangential(&packing->wire[best], &packing->wire[i], normal) > 0.0;
        if (more > tie || (more >= -tie && ahead))
            best = i;
    }
    return best;
}

/* Angle by which the normal turns on wire a, from `normal`, until wire b reaches as far; negative:
 * b never does. Where a touches b on both sides of b's range it is entered once in a turn. */
static double turn_to(const struct wb_packing_circle *a, const struct wb_packing_circle *b,
                      double normal)
{
    const double y = b->y - a->y, z = b->z - a->z, distance = sqrt(y * y + z * z);
    const double cosine = (a->radius - b->radius) / distance;
    if (!(fabs(cosine) < 1.0))
        return -1.0;
    double turn = fmod(atan2(y, z) - acos(cosine) - normal, 2.0 * M_PI);
    /* Round-off may place a crossing at this normal slightly behind it. */
    if (turn < -1e-9)
        turn += 2.0 * M_PI;
    if (turn > 2.0 * M_PI - 1e-9)
        turn -= 2.0 * M_PI;
    return fmax(turn, 0.0);
}

/* The next wire of the outline, and the angle to it; -1: none within the rest of the turn. Of
 * aligned wires the farthest. */
static int next_wire(const struct wb_packing *packing, int wire, double normal, double *turn)
{
    const struct wb_packing_circle *const here = &packing->wire[wire];
    int next = -1;
    for (int i = 0; i < packing->n; i++) {
        if (i == wire)
            continue;
        const double t = turn_to(here, &packing->wire[i], normal);
        if (t < 0.0)
            continue;
        const double ahead =
            next < 0 ? 0.0 : tangential(&packing->wire[next], &packing->wire[i], normal + t);
        if (next < 0 || t < *turn - 1e-12 || (t < *turn + 1e-12 && ahead > 0.0)) {
            *turn = t;
            next = i;
        }
    }
    return next;
}

static enum wb_status add_arc(struct wb_hull *hull, int wire, double from, double to)
{
    if (hull->n_arcs == WB_HULL_MOST)
        return wb_fail(WB_ERR_DATA, "the outline of %d wires does not close after %d arcs",
                       hull->packing.n, WB_HULL_MOST);
    hull->arc[hull->n_arcs++] = (struct wb_hull_arc){.wire = wire, .from = from, .to = to};
    return WB_OK;
}

/* One turn from a normal of -pi. */
static enum wb_status go_round(struct wb_hull *hull)
{
    double normal = -M_PI, turn = 0.0;
    int wire = farthest(&hull->packing, normal);
    for (;;) {
        const int next = next_wire(&hull->packing, wire, normal, &turn);
        if (next < 0 || normal + turn >= M_PI)
            return add_arc(hull, wire, normal, M_PI);
        WB_TRY(add_arc(hull, wire, normal, normal + turn));
        normal += turn;
        wire = next;
    }
}

/* The arc that was cut at the first normal is joined; it is the last. */
static void join_ends(struct wb_hull *hull)
{
    struct wb_hull_arc *const first = &hull->arc[0], *const last = &hull->arc[hull->n_arcs - 1];
    if (hull->n_arcs < 2 || first->wire != last->wire)
        return;
    last->to = first->to + 2.0 * M_PI;
    hull->n_arcs--;
    memmove(first, first + 1, (size_t)hull->n_arcs * sizeof *first);
}

static void measure_straights(struct wb_hull *hull)
{
    for (int k = 0; k < hull->n_arcs; k++) {
        struct wb_hull_arc *const arc = &hull->arc[k];
        const struct wb_hull_arc *const next = &hull->arc[(k + 1) % hull->n_arcs];
        const struct wb_packing_circle a = tangent_point(&hull->packing.wire[arc->wire], arc->to);
        const struct wb_packing_circle b = tangent_point(&hull->packing.wire[next->wire], arc->to);
        arc->straight = hull->n_arcs > 1 ? fmax(0.0, tangential(&a, &b, arc->to)) : 0.0;
    }
}

/* The next wire on a straight piece beyond the wire of arc k; -1: none. */
static int wire_between(const struct wb_hull *hull, int k, double tolerance)
{
    const struct wb_hull_arc *const arc = &hull->arc[k];
    const struct wb_packing *const packing = &hull->packing;
    const struct wb_packing_circle *const here = &packing->wire[arc->wire];
    const int end = hull->arc[(k + 1) % hull->n_arcs].wire;
    double nearest = arc->straight;
    int found = -1;
    for (int i = 0; i < packing->n; i++) {
        if (i == arc->wire || i == end)
            continue;
        const double along = tangential(here, &packing->wire[i], arc->to);
        const double inside = support(here, arc->to) - support(&packing->wire[i], arc->to);
        if (inside <= tolerance && along > 0.0 && along < nearest) {
            nearest = along;
            found = i;
        }
    }
    return found;
}

static enum wb_status add_touched(struct wb_hull *hull, double tolerance)
{
    for (int k = 0; k < hull->n_arcs; k++) {
        const int wire = hull->n_arcs > 1 ? wire_between(hull, k, tolerance) : -1;
        if (wire < 0)
            continue;
        const double normal = hull->arc[k].to;
        WB_TRY(add_arc(hull, wire, normal, normal));
        memmove(&hull->arc[k + 2], &hull->arc[k + 1],
                (size_t)(hull->n_arcs - k - 2) * sizeof hull->arc[0]);
        hull->arc[k + 1] = (struct wb_hull_arc){.wire = wire, .from = normal, .to = normal};
        measure_straights(hull);
    }
    return WB_OK;
}

enum wb_status wb_hull_find(struct wb_hull *hull, const struct wb_packing *packing,
                            double tolerance)
{
    struct wb_hull found = {.packing = *packing};
    WB_TRY(go_round(&found));
    join_ends(&found);
    measure_straights(&found);
    WB_TRY(add_touched(&found, tolerance));
    *hull = found;
    return WB_OK;
}

/* --- measures of the outline --- */

double wb_hull_length(const struct wb_hull *hull, double offset)
{
    double length = 2.0 * M_PI * offset;
    for (int k = 0; k < hull->n_arcs; k++) {
        const struct wb_hull_arc *const arc = &hull->arc[k];
        length += hull->packing.wire[arc->wire].radius * (arc->to - arc->from) + arc->straight;
    }
    return length;
}

/* Half of the integral of the support over the outline. */
static void add_arc_moments(struct wb_hull_moments *sum, const struct wb_packing_circle *centre,
                            double R, const struct wb_hull_arc *arc)
{
    const double turn = arc->to - arc->from;
    const double s = cos(arc->from) - cos(arc->to), c = sin(arc->to) - sin(arc->from);
    const double twice = 0.25 * (sin(2.0 * arc->to) - sin(2.0 * arc->from));
    const double y = centre->y, z = centre->z;
    sum->length += R * turn;
    sum->y += R * (y * turn + R * s);
    sum->z += R * (z * turn + R * c);
    sum->yy += R * (y * y * turn + 2.0 * y * R * s + R * R * (0.5 * turn - twice));
    sum->zz += R * (z * z * turn + 2.0 * z * R * c + R * R * (0.5 * turn + twice));
}

static void add_straight_moments(struct wb_hull_moments *sum, const struct wb_packing_circle *from,
                                 const struct wb_packing_circle *to)
{
    const double length = hypot(to->y - from->y, to->z - from->z);
    sum->length += length;
    sum->y += 0.5 * length * (from->y + to->y);
    sum->z += 0.5 * length * (from->z + to->z);
    sum->yy += length / 3.0 * (from->y * from->y + from->y * to->y + to->y * to->y);
    sum->zz += length / 3.0 * (from->z * from->z + from->z * to->z + to->z * to->z);
}

struct wb_hull_moments wb_hull_moments(const struct wb_hull *hull, double offset)
{
    struct wb_hull_moments sum = {0};
    for (int k = 0; k < hull->n_arcs; k++) {
        const struct wb_hull_arc *const arc = &hull->arc[k];
        struct wb_packing_circle wire = hull->packing.wire[arc->wire];
        wire.radius += offset;
        const struct wb_packing_circle from = tangent_point(&wire, arc->to);
        const struct wb_packing_circle to = {from.y + arc->straight * cos(arc->to),
                                             from.z - arc->straight * sin(arc->to), 0.0};
        add_arc_moments(&sum, &wire, wire.radius, arc);
        add_straight_moments(&sum, &from, &to);
    }
    return sum;
}

double wb_hull_contact(const struct wb_hull *hull, int wire, bool *touches)
{
    double angle = 0.0;
    *touches = false;
    for (int k = 0; k < hull->n_arcs; k++) {
        if (hull->arc[k].wire != wire)
            continue;
        *touches = true;
        angle += hull->arc[k].to - hull->arc[k].from;
    }
    return angle;
}

struct wb_hull_point wb_hull_at(const struct wb_hull *hull, double offset, double s)
{
    const double length = wb_hull_length(hull, offset);
    double rest = fmod(s, length);
    if (rest < 0.0)
        rest += length;
    for (int k = 0;; k++) {
        const struct wb_hull_arc *const arc = &hull->arc[k];
        const struct wb_packing_circle *const wire = &hull->packing.wire[arc->wire];
        const double R = wire->radius + offset, on_arc = R * (arc->to - arc->from);
        const bool is_last = k == hull->n_arcs - 1;
        if (rest <= on_arc || (is_last && rest > on_arc + arc->straight)) {
            const double normal = fmin(arc->from + rest / R, arc->to);
            return (struct wb_hull_point){wire->y + R * sin(normal), wire->z + R * cos(normal),
                                          normal, arc->wire};
        }
        rest -= on_arc;
        if (rest < arc->straight || is_last) {
            const double y = sin(arc->to), z = cos(arc->to);
            return (struct wb_hull_point){wire->y + R * y + rest * z, wire->z + R * z - rest * y,
                                          arc->to, -1};
        }
        rest -= arc->straight;
    }
}
