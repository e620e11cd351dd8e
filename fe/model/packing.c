#include "fe/model/packing.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define WB_LOG_DOMAIN "packing"

/* Distance between the centres. */
static double centre_distance(const struct wb_packing_circle *a, const struct wb_packing_circle *b)
{
    const double y = b->y - a->y, z = b->z - a->z;
    return sqrt(y * y + z * z);
}

/* n wires of the given diameters, all at the origin. */
static enum wb_status take(struct wb_packing *packing, int n, const double *diameter)
{
    if (n < 1 || n > WB_PACKING_MOST)
        return wb_fail(WB_ERR_ARGUMENT, "the bundle has %d wires: expected 1 to %d", n,
                       WB_PACKING_MOST);
    packing->n = n;
    for (int i = 0; i < n; i++) {
        if (!(diameter[i] > 0.0 && isfinite(diameter[i])))
            return wb_fail(WB_ERR_ARGUMENT,
                           "wire %d has a diameter of %g m: expected a number above 0", i + 1,
                           diameter[i]);
        packing->wire[i] = (struct wb_packing_circle){0.0, 0.0, 0.5 * diameter[i]};
    }
    return WB_OK;
}

/* --- lattices --- */

/* Unit steps at multiples of 60 degrees from +z, as (z, y). */
static void unit_step(int sixth, double step[2])
{
    static const double half_root_3 = 0.86602540378443864676;
    static const double z[] = {1.0, 0.5, -0.5, -1.0, -0.5, 0.5};
    static const double y[] = {0.0, 1.0, 1.0, 0.0, -1.0, -1.0};
    step[0] = z[sixth % 6];
    step[1] = half_root_3 * y[sixth % 6];
}

static void fill_hexagon(struct wb_packing *packing, double pitch)
{
    int at = 1;
    for (int ring = 1; at < packing->n; ring++) {
        for (int side = 0; side < 6; side++) {
            double corner[2], along[2];
            unit_step(side, corner);
            unit_step(side + 2, along);
            for (int k = 0; k < ring; k++, at++) {
                packing->wire[at].z = pitch * (ring * corner[0] + k * along[0]);
                packing->wire[at].y = pitch * (ring * corner[1] + k * along[1]);
            }
        }
    }
}

/* A site of the lattice; its squared distance from the triangle's centre is norm / 9. */
struct site {
    int norm;
    double z, y, angle;
};

static int nearer(const void *a, const void *b)
{
    const struct site *const p = a, *const q = b;
    if (p->norm != q->norm)
        return p->norm < q->norm ? -1 : 1;
    return p->angle < q->angle ? -1 : p->angle > q->angle;
}

enum {
    REACH = 9, /* lattice steps from the centre: more than the largest patch needs */
    SITES = (2 * REACH + 1) * (2 * REACH + 1)
};

/* Sites by distance from the centre of a triangle that points up. */
static void list_sites(struct site sites[SITES])
{
    int n = 0;
    for (int i = -REACH; i <= REACH; i++) {
        for (int j = -REACH; j <= REACH; j++) {
            const int u = 3 * i - 1, v = 3 * j - 1;
            struct site *const site = &sites[n++];
            site->norm = u * u + u * v + v * v;
            site->z = (u + 0.5 * v) / 3.0;
            site->y = 0.5 * sqrt(3.0) * v / 3.0;
            site->angle = atan2(site->y, site->z);
            if (site->angle < -1e-9)
                site->angle += 2.0 * M_PI;
        }
    }
    qsort(sites, SITES, sizeof *sites, nearer);
}

static void fill_triangle(struct wb_packing *packing, double pitch)
{
    struct site sites[SITES];
    list_sites(sites);
    for (int i = 0; i < packing->n; i++) {
        packing->wire[i].z = pitch * sites[i].z;
        packing->wire[i].y = pitch * sites[i].y;
    }
}

int wb_packing_whole(enum wb_packing_lattice lattice, int n, int *less)
{
    struct site sites[SITES];
    int whole = 0;
    *less = 0;
    if (lattice == WB_PACKING_TRIANGLE)
        list_sites(sites);
    for (int shell = 0; whole < n; shell++) {
        *less = whole;
        if (lattice == WB_PACKING_HEXAGON) {
            whole = 1 + 3 * shell * (shell + 1);
            continue;
        }
        for (whole++; sites[whole].norm == sites[whole - 1].norm;)
            whole++;
    }
    return whole;
}

enum wb_status wb_packing_on_lattice(struct wb_packing *packing, int n, const double *diameter,
                                     enum wb_packing_lattice lattice)
{
    struct wb_packing filled = {0};
    double pitch = 0.0;
    int less;
    WB_TRY(take(&filled, n, diameter));
    for (int i = 0; i < n; i++)
        pitch = fmax(pitch, diameter[i]);
    const int whole = wb_packing_whole(lattice, n, &less);
    if (whole != n)
        return wb_fail(WB_ERR_ARGUMENT,
                       "%d wires do not fill a patch of the lattice: expected %d or %d", n, less,
                       whole);
    if (lattice == WB_PACKING_HEXAGON)
        fill_hexagon(&filled, pitch);
    else
        fill_triangle(&filled, pitch);
    *packing = filled;
    return WB_OK;
}

/* --- gaps --- */

double wb_packing_smallest_gap(const struct wb_packing *packing)
{
    double smallest = (double)INFINITY;
    for (int a = 0; a < packing->n; a++) {
        for (int b = a + 1; b < packing->n; b++) {
            const struct wb_packing_circle *const p = &packing->wire[a], *const q =
                                                                             &packing->wire[b];
            smallest = fmin(smallest, centre_distance(p, q) - p->radius - q->radius);
        }
    }
    return smallest;
}

/* Whether wire c touches the segment between the centres of a and b. */
static bool is_between(const struct wb_packing_circle *a, const struct wb_packing_circle *b,
                       const struct wb_packing_circle *c)
{
    const double y = b->y - a->y, z = b->z - a->z;
    double part = ((c->y - a->y) * y + (c->z - a->z) * z) / (y * y + z * z);
    part = fmin(fmax(part, 0.0), 1.0);
    const struct wb_packing_circle nearest = {a->y + part * y, a->z + part * z, 0.0};
    return centre_distance(c, &nearest) <= (1.0 + 1e-9) * c->radius;
}

static bool are_neighbours(const struct wb_packing *packing, int a, int b)
{
    for (int c = 0; c < packing->n; c++) {
        if (c != a && c != b && is_between(&packing->wire[a], &packing->wire[b], &packing->wire[c]))
            return false;
    }
    return true;
}

int wb_packing_pairs(const struct wb_packing *packing, double reach, int most,
                     struct wb_packing_pair *pairs)
{
    int n = 0;
    for (int a = 0; a < packing->n; a++) {
        for (int b = a + 1; b < packing->n; b++) {
            const struct wb_packing_circle *const p = &packing->wire[a], *const q =
                                                                             &packing->wire[b];
            const double gap = centre_distance(p, q) - p->radius - q->radius;
            if (gap > reach || !are_neighbours(packing, a, b))
                continue;
            if (n < most)
                pairs[n] = (struct wb_packing_pair){a, b, gap, atan2(q->y - p->y, q->z - p->z)};
            n++;
        }
    }
    return n;
}

/* --- enclosing circle --- */

/* Both circles are touched from inside, at the ends of the longest line through their centres. Not
 * round both where one holds the other. */
static struct wb_packing_circle enclose_two(const struct wb_packing_circle *a,
                                            const struct wb_packing_circle *b)
{
    const double d = centre_distance(a, b);
    const double radius = 0.5 * (d + a->radius + b->radius), part = (radius - a->radius) / d;
    return (struct wb_packing_circle){a->y + part * (b->y - a->y), a->z + part * (b->z - a->z),
                                      radius};
}

/* The circle that three touch from inside (Apollonius). With x its centre from that of the first,
 * s = R - r0, d_i the other centres from the first and e_i = r0 - r_i,
 *     |x| = s, |x - d_i| = s + e_i   ->   x.d_i = (d_i^2 - e_i^2) / 2 - e_i s,
 * so that x = u + s v, and s solves a quadratic equation. False when there is none. */
static bool enclose_three(const struct wb_packing_circle *c[3], struct wb_packing_circle *circle)
{
    const double dy[2] = {c[1]->y - c[0]->y, c[2]->y - c[0]->y};
    const double dz[2] = {c[1]->z - c[0]->z, c[2]->z - c[0]->z};
    const double e[2] = {c[0]->radius - c[1]->radius, c[0]->radius - c[2]->radius};
    const double cross = dy[0] * dz[1] - dz[0] * dy[1];
    const double h0 = 0.5 * (dy[0] * dy[0] + dz[0] * dz[0] - e[0] * e[0]);
    const double h1 = 0.5 * (dy[1] * dy[1] + dz[1] * dz[1] - e[1] * e[1]);
    const double uy = (h0 * dz[1] - h1 * dz[0]) / cross, uz = (h1 * dy[0] - h0 * dy[1]) / cross;
    const double vy = -(e[0] * dz[1] - e[1] * dz[0]) / cross;
    const double vz = -(e[1] * dy[0] - e[0] * dy[1]) / cross;
    const double a = vy * vy + vz * vz - 1.0, b = uy * vy + uz * vz, k = uy * uy + uz * uz;
    const double root = sqrt(b * b - a * k);
    /* Both roots without cancellation; a may be zero. */
    const double q = -(b + (b < 0.0 ? -root : root));
    const double roots[2] = {q / a, k / q};
    bool found = false;
    for (int i = 0; i < 2; i++) {
        const double s = roots[i];
        if (!isfinite(s) || s < 0.0 || s + e[0] < 0.0 || s + e[1] < 0.0)
            continue;
        if (found && s + c[0]->radius >= circle->radius)
            continue;
        *circle = (struct wb_packing_circle){c[0]->y + uy + s * vy, c[0]->z + uz + s * vz,
                                             s + c[0]->radius};
        found = true;
    }
    return found;
}

/* Distance by which a circle protrudes from another. */
static double excess(const struct wb_packing_circle *outer, const struct wb_packing_circle *circle)
{
    return centre_distance(outer, circle) + circle->radius - outer->radius;
}

static const double enclosing_tolerance = 1e-13; /* of the radius */

/* The circles that determine the enclosing circle. */
struct basis {
    int n;
    const struct wb_packing_circle *member[4];
};

static bool holds(const struct wb_packing_circle *outer, const struct basis *all)
{
    for (int i = 0; i < all->n; i++) {
        if (!(excess(outer, all->member[i]) <= enclosing_tolerance * outer->radius))
            return false;
    }
    return true;
}

/* The smallest circle around up to four circles `all`: tries every subset of up to three, which
 * becomes the basis. */
static bool enclose_few(const struct basis *all, struct basis *basis,
                        struct wb_packing_circle *circle)
{
    bool found = false;
    for (unsigned int set = 1; set < 1u << all->n; set++) {
        struct basis part = {0};
        struct wb_packing_circle trial = {0};
        for (int i = 0; i < all->n; i++) {
            if (set >> i & 1u)
                part.member[part.n++] = all->member[i];
        }
        if (part.n > 3 || (part.n == 3 && !enclose_three(part.member, &trial)))
            continue;
        if (part.n == 1)
            trial = *part.member[0];
        if (part.n == 2)
            trial = enclose_two(part.member[0], part.member[1]);
        if (holds(&trial, all) && !(found && trial.radius >= circle->radius)) {
            *circle = trial;
            *basis = part;
            found = true;
        }
    }
    return found;
}

/* Exchanges the basis for one with the circle that protrudes farthest: the radius grows each time,
 * so no basis recurs. */
struct wb_packing_circle wb_packing_enclosing(int n, const struct wb_packing_circle *circles)
{
    struct wb_packing_circle enclosing = circles[0];
    struct basis basis = {1, {&circles[0]}};
    for (;;) {
        int farthest = 0;
        for (int i = 1; i < n; i++) {
            if (excess(&enclosing, &circles[i]) > excess(&enclosing, &circles[farthest]))
                farthest = i;
        }
        const double out = excess(&enclosing, &circles[farthest]);
        if (out <= enclosing_tolerance * enclosing.radius)
            return enclosing;
        struct wb_packing_circle next = enclosing;
        struct basis all = basis, next_basis;
        all.member[all.n++] = &circles[farthest];
        if (!enclose_few(&all, &next_basis, &next) || !(next.radius > enclosing.radius)) {
            /* Round-off: the remaining protrusion is added to the radius. */
            enclosing.radius += out;
            return enclosing;
        }
        enclosing = next;
        basis = next_basis;
    }
}

/* --- wires in a ring that tightens ---
 *
 * With positions p_i and the ring's radius R as unknowns, in units of the mean radius,
 *     E = P (R + q sum |p_i|^2 / 2) + sum o_ij^2 / 2 + sum w_i^2 / 2,
 *     o_ij = max(0, r_i + r_j - |p_i - p_j|),  w_i = max(0, |p_i| + r_i - R):
 * elastic discs in a ring of the tension P, with a pull q to its centre that is too slight to move
 * any but those that carry nothing. As P goes to zero the overlaps do in proportion, and what
 * remains is a packing in which no small motion lets the ring become smaller. The last of them is
 * removed by making all contacts exact at once.
 */

enum {
    UNKNOWNS = 2 * WB_PACKING_MOST + 1, /* y and z of each wire, then the radius */
    STEPS = 12,                         /* steps that L-BFGS keeps */
    MOST_ITERATIONS = 1000,
    MOST_CONTACTS = 4 * WB_PACKING_MOST /* in the plane at most 3 n - 3 pairs, and n at the ring */
};

/* Wires in a ring that tightens, in units of their mean radius. */
struct ring {
    int n;
    double tension;   /* of the ring */
    double pull;      /* of the centre, for the tension and a distance */
    double reference; /* of the radius in the energy, to keep its last digits */
    double radius[WB_PACKING_MOST];
    double x[UNKNOWNS];
};

/* Curvature information of the minimisation. */
struct memory {
    int n, first; /* steps, the oldest at `first` */
    double step[STEPS][UNKNOWNS];
    double change[STEPS][UNKNOWNS]; /* of the gradient in that step */
    double weight[STEPS];
};

static double dot(int n, const double *a, const double *b)
{
    double sum = 0.0;
    for (int i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

static void add(int n, double factor, const double *a, double *sum)
{
    for (int i = 0; i < n; i++)
        sum[i] += factor * a[i];
}

/* --- energy --- */

/* Adds the energy of overlaps with the wires before i. */
static double press_pairs(const struct ring *ring, const double *x, int i, double *gradient)
{
    double sum = 0.0;
    for (int j = 0; j < i; j++) {
        const double y = x[2 * i] - x[2 * j], z = x[2 * i + 1] - x[2 * j + 1];
        const double reach = ring->radius[i] + ring->radius[j], square = y * y + z * z;
        if (square >= reach * reach)
            continue;
        const double distance = sqrt(square) + 1e-300, overlap = reach - distance;
        const double force = overlap / distance;
        sum += 0.5 * overlap * overlap;
        gradient[2 * i] -= force * y;
        gradient[2 * i + 1] -= force * z;
        gradient[2 * j] += force * y;
        gradient[2 * j + 1] += force * z;
    }
    return sum;
}

/* The energy at x, and its gradient. */
static double ring_energy(const struct ring *ring, const double *x, double *gradient)
{
    const int n = ring->n;
    const double pull = ring->tension * ring->pull;
    double sum = ring->tension * (x[2 * n] - ring->reference);
    memset(gradient, 0, (size_t)(2 * n) * sizeof *gradient);
    gradient[2 * n] = ring->tension;
    for (int i = 0; i < n; i++) {
        const double y = x[2 * i], z = x[2 * i + 1], square = y * y + z * z;
        sum += press_pairs(ring, x, i, gradient) + 0.5 * pull * square;
        gradient[2 * i] += pull * y;
        gradient[2 * i + 1] += pull * z;
        const double distance = sqrt(square) + 1e-300, out = distance + ring->radius[i] - x[2 * n];
        if (out > 0.0) {
            sum += 0.5 * out * out;
            gradient[2 * i] += out * y / distance;
            gradient[2 * i + 1] += out * z / distance;
            gradient[2 * n] -= out;
        }
    }
    return sum;
}

/* --- minimisation (L-BFGS) --- */

/* The direction of the next step, by the two loops of the method. */
static void find_direction(int n, const struct memory *memory, const double *gradient,
                           double *direction)
{
    double alpha[STEPS];
    for (int i = 0; i < n; i++)
        direction[i] = -gradient[i];
    for (int k = memory->n - 1; k >= 0; k--) {
        const int at = (memory->first + k) % STEPS;
        alpha[k] = memory->weight[at] * dot(n, memory->step[at], direction);
        add(n, -alpha[k], memory->change[at], direction);
    }
    if (memory->n > 0) {
        const int last = (memory->first + memory->n - 1) % STEPS;
        const double scale =
            1.0 / (memory->weight[last] * dot(n, memory->change[last], memory->change[last]));
        for (int i = 0; i < n; i++)
            direction[i] *= scale;
    }
    for (int k = 0; k < memory->n; k++) {
        const int at = (memory->first + k) % STEPS;
        const double beta = memory->weight[at] * dot(n, memory->change[at], direction);
        add(n, alpha[k] - beta, memory->step[at], direction);
    }
}

static void remember(int n, struct memory *memory, const double *step, const double *change)
{
    const double curvature = dot(n, step, change);
    if (!(curvature > 1e-12 * dot(n, change, change)))
        return;
    const int at = (memory->first + memory->n) % STEPS;
    if (memory->n == STEPS)
        memory->first = (memory->first + 1) % STEPS;
    else
        memory->n++;
    memcpy(memory->step[at], step, (size_t)n * sizeof *step);
    memcpy(memory->change[at], change, (size_t)n * sizeof *change);
    memory->weight[at] = 1.0 / curvature;
}

struct point {
    double energy;
    double x[UNKNOWNS], gradient[UNKNOWNS];
};

static void look(const struct ring *ring, struct point *point)
{
    point->energy = ring_energy(ring, point->x, point->gradient);
}

/* A step along the direction that lowers the energy enough; false: not found. */
static bool step_down(const struct ring *ring, const double *direction, const struct point *from,
                      struct point *to)
{
    const int n = 2 * ring->n + 1;
    const double slope = dot(n, from->gradient, direction);
    double longest = 0.0;
    if (!(slope < 0.0))
        return false;
    for (int i = 0; i < n; i++)
        longest = fmax(longest, fabs(direction[i]));
    /* No wire moves farther than its radius in one step. */
    for (double part = fmin(1.0, 1.0 / longest); part > 1e-12; part *= 0.5) {
        memcpy(to->x, from->x, (size_t)n * sizeof *to->x);
        add(n, part, direction, to->x);
        look(ring, to);
        if (to->energy <= from->energy + 1e-4 * part * slope)
            return true;
    }
    return false;
}

/* Minimises until the residual forces are below `balance` times the tension. */
static void ring_balance(struct ring *ring, struct memory *memory, double balance)
{
    const int n = 2 * ring->n + 1;
    struct point now = {0}, next;
    double direction[UNKNOWNS], change[UNKNOWNS];
    ring->reference = ring->x[2 * ring->n];
    memcpy(now.x, ring->x, (size_t)n * sizeof *now.x);
    look(ring, &now);
    memory->n = memory->first = 0;
    for (int iteration = 0; iteration < MOST_ITERATIONS; iteration++) {
        if (sqrt(dot(n, now.gradient, now.gradient)) <= balance * ring->tension)
            break;
        find_direction(n, memory, now.gradient, direction);
        if (!step_down(ring, direction, &now, &next)) {
            if (memory->n == 0)
                break; /* no further decrease in floating point */
            memory->n = 0;
            continue;
        }
        for (int i = 0; i < n; i++) {
            direction[i] = next.x[i] - now.x[i];
            change[i] = next.gradient[i] - now.gradient[i];
        }
        remember(n, memory, direction, change);
        memcpy(&now, &next, sizeof now);
    }
    memcpy(ring->x, now.x, (size_t)n * sizeof *now.x);
}

/* --- contacts --- */

/* Wires a and b, or a and the ring (b < 0), whose gap grows by n . (p_b - p_a), or by R - n . p_a.
 */
struct contact {
    int a, b;
    double y, z;
    double gap;
};

struct contacts {
    int n;
    struct contact list[MOST_CONTACTS];
};

/* All overlapping contacts; if contacts exist, the same ones with new gaps. */
static void measure(const struct ring *ring, struct contact *contact)
{
    const double *const x = ring->x, *const a = &x[2 * contact->a];
    const bool is_pair = contact->b >= 0;
    const double y = is_pair ? x[2 * contact->b] - a[0] : a[0];
    const double z = is_pair ? x[2 * contact->b + 1] - a[1] : a[1];
    const double distance = sqrt(y * y + z * z) + 1e-300, radius = ring->radius[contact->a];
    contact->y = y / distance;
    contact->z = z / distance;
    contact->gap =
        is_pair ? distance - radius - ring->radius[contact->b] : x[2 * ring->n] - radius - distance;
}

static void find_contacts(const struct ring *ring, struct contacts *contacts)
{
    contacts->n = 0;
    for (int a = 0; a < ring->n; a++) {
        for (int b = -1; b < a; b++) {
            struct contact contact = {.a = a, .b = b};
            measure(ring, &contact);
            if (contact.gap < 0.0 && contacts->n < MOST_CONTACTS)
                contacts->list[contacts->n++] = contact;
        }
    }
}

/* The change of the gaps for a motion, and its transpose. */
static void apply(const struct contacts *contacts, int n, const double *motion, double *change)
{
    for (int k = 0; k < contacts->n; k++) {
        const struct contact *const c = &contacts->list[k];
        const double own = c->y * motion[2 * c->a] + c->z * motion[2 * c->a + 1];
        const double other =
            c->b >= 0 ? c->y * motion[2 * c->b] + c->z * motion[2 * c->b + 1] : motion[2 * n];
        change[k] = other - own;
    }
}

static void apply_transpose(const struct contacts *contacts, int n, const double *force,
                            double *motion)
{
    memset(motion, 0, (size_t)(2 * n + 1) * sizeof *motion);
    for (int k = 0; k < contacts->n; k++) {
        const struct contact *const c = &contacts->list[k];
        motion[2 * c->a] -= force[k] * c->y;
        motion[2 * c->a + 1] -= force[k] * c->z;
        if (c->b >= 0) {
            motion[2 * c->b] += force[k] * c->y;
            motion[2 * c->b + 1] += force[k] * c->z;
        } else {
            motion[2 * n] += force[k];
        }
    }
}

/* The smallest motion that closes all gaps to first order, by conjugate gradients on the normal
 * equations (CGLS): they may be singular. */
static void close_gaps(const struct contacts *contacts, int n, double *motion)
{
    const int m = contacts->n, unknowns = 2 * n + 1;
    double residual[MOST_CONTACTS], image[MOST_CONTACTS], s[UNKNOWNS], p[UNKNOWNS];
    memset(motion, 0, (size_t)unknowns * sizeof *motion);
    for (int k = 0; k < m; k++)
        residual[k] = -contacts->list[k].gap;
    apply_transpose(contacts, n, residual, s);
    memcpy(p, s, (size_t)unknowns * sizeof *p);
    double gamma = dot(unknowns, s, s);
    const double enough = 1e-28 * gamma;
    for (int iteration = 0; iteration < 4 * unknowns && gamma > enough; iteration++) {
        apply(contacts, n, p, image);
        const double step = gamma / dot(m, image, image);
        add(unknowns, step, p, motion);
        add(m, -step, image, residual);
        apply_transpose(contacts, n, residual, s);
        const double next = dot(unknowns, s, s);
        for (int i = 0; i < unknowns; i++)
            p[i] = s[i] + next / gamma * p[i];
        gamma = next;
    }
}

/* Newton's method on all contacts that carry a force. */
static void make_exact(struct ring *ring)
{
    struct contacts contacts;
    double motion[UNKNOWNS];
    find_contacts(ring, &contacts);
    for (int iteration = 0; iteration < 4; iteration++) {
        close_gaps(&contacts, ring->n, motion);
        add(2 * ring->n + 1, 1.0, motion, ring->x);
        for (int k = 0; k < contacts.n; k++)
            measure(ring, &contacts.list[k]);
    }
}

/* --- from and to packings --- */

static double mean_radius(const struct wb_packing *packing)
{
    double sum = 0.0;
    for (int i = 0; i < packing->n; i++)
        sum += packing->wire[i].radius;
    return sum / packing->n;
}

/* Places the wires around the centre of their enclosing circle. */
static void ring_enter(struct ring *ring, const struct wb_packing *packing)
{
    const double unit = mean_radius(packing);
    const struct wb_packing_circle circle = wb_packing_enclosing(packing->n, packing->wire);
    memset(ring, 0, sizeof *ring);
    ring->n = packing->n;
    for (int i = 0; i < packing->n; i++) {
        ring->radius[i] = packing->wire[i].radius / unit;
        ring->x[2 * i] = (packing->wire[i].y - circle.y) / unit;
        ring->x[2 * i + 1] = (packing->wire[i].z - circle.z) / unit;
    }
    ring->x[2 * ring->n] = circle.radius / unit;
}

/* Separates the wires by the remaining overlap and moves their circle's centre to the origin. */
static void leave(const struct ring *ring, struct wb_packing *packing)
{
    const double unit = mean_radius(packing);
    double apart = 1.0;
    for (int i = 0; i < ring->n; i++) {
        packing->wire[i].y = unit * ring->x[2 * i];
        packing->wire[i].z = unit * ring->x[2 * i + 1];
    }
    for (int i = 0; i < ring->n; i++) {
        for (int j = 0; j < i; j++) {
            const struct wb_packing_circle *const a = &packing->wire[i];
            const struct wb_packing_circle *const b = &packing->wire[j];
            apart = fmax(apart, (a->radius + b->radius) / centre_distance(a, b));
        }
    }
    const struct wb_packing_circle circle = wb_packing_enclosing(packing->n, packing->wire);
    for (int i = 0; i < ring->n; i++) {
        packing->wire[i].y = apart * (packing->wire[i].y - circle.y);
        packing->wire[i].z = apart * (packing->wire[i].z - circle.z);
    }
}

/* Lowers the tension from `from` until it is negligible and writes the positions to the wires. */
static enum wb_status ring_settle(struct ring *ring, struct memory *memory, double from,
                                  struct wb_packing *packing)
{
    static const double slight = 1e-3, balance = 1e-6, to = 1e-6;
    struct wb_packing settled = *packing;
    ring->pull = slight;
    for (ring->tension = from; ring->tension > 0.99 * to; ring->tension *= 0.1)
        ring_balance(ring, memory, balance);
    make_exact(ring);
    leave(ring, &settled);
    if (!(wb_packing_smallest_gap(&settled) >= -1e-12 * mean_radius(&settled)) ||
        !isfinite(wb_packing_enclosing(settled.n, settled.wire).radius))
        return wb_fail(WB_ERR_CONVERGENCE, "the packing of %d wires did not converge", settled.n);
    *packing = settled;
    return WB_OK;
}

/* Lattices may be in unstable equilibrium: apply small, reproducible perturbations. */
static void shake(struct ring *ring)
{
    static const double most = 1e-3, golden = 0.6180339887498949;
    for (int i = 0; i < 2 * ring->n; i++)
        ring->x[i] += most * (2.0 * fmod(golden * (i + 1), 1.0) - 1.0);
}

enum wb_status wb_packing_settle(struct wb_packing *packing)
{
    static const double firm = 0.01; /* wires do not pass each other */
    struct ring ring;
    struct memory *const memory = wb_memory_new(1, sizeof *memory);
    ring_enter(&ring, packing);
    shake(&ring);
    const enum wb_status status = ring_settle(&ring, memory, firm, packing);
    free(memory);
    return status;
}

/* --- the densest packing, by monotonic basin hopping (Grosso et al. 2010) from random starts ---
 */

static const double soft_tension = 0.3;   /* wires pass each other */
static const double rough_tension = 1e-3; /* the contacts are those of the packing */

/* SplitMix64. */
static uint64_t next_bits(uint64_t *state)
{
    uint64_t z = *state += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}

static double next_uniform(uint64_t *state)
{
    return (double)(next_bits(state) >> 11) * 0x1p-53;
}

static int next_index(uint64_t *state, int n)
{
    return (int)(next_bits(state) % (uint64_t)n);
}

/* A point within the radius R of the origin, without library functions whose rounding may differ.
 */
static void throw_wire(uint64_t *state, double R, double *position)
{
    double y, z;
    do {
        y = 2.0 * next_uniform(state) - 1.0;
        z = 2.0 * next_uniform(state) - 1.0;
    } while (y * y + z * z > 1.0);
    position[0] = R * y;
    position[1] = R * z;
}

static void throw_all(struct ring *ring, uint64_t *state)
{
    double area = 0.0;
    for (int i = 0; i < ring->n; i++)
        area += ring->radius[i] * ring->radius[i];
    const double R = sqrt(area / 0.7);
    for (int i = 0; i < ring->n; i++)
        throw_wire(state, R, &ring->x[2 * i]);
    ring->x[2 * ring->n] = R;
}

/* Moves one wire, or exchanges two of different size. */
static void disturb(struct ring *ring, uint64_t *state)
{
    const int a = next_index(state, ring->n), b = next_index(state, ring->n);
    if (ring->radius[a] == ring->radius[b] || next_uniform(state) < 0.3) {
        throw_wire(state, ring->x[2 * ring->n], &ring->x[2 * a]);
        return;
    }
    for (int k = 0; k < 2; k++) {
        const double other = ring->x[2 * a + k];
        ring->x[2 * a + k] = ring->x[2 * b + k];
        ring->x[2 * b + k] = other;
    }
}

/* The radius without tension: dE/dP = R, and R falls in proportion to P. */
static double expected_radius(const struct ring *ring)
{
    double gradient[UNKNOWNS];
    const double energy = ring_energy(ring, ring->x, gradient);
    const double R = ring->x[2 * ring->n];
    return R + 2.0 * (energy / ring->tension - (R - ring->reference));
}

static double relax(struct ring *ring, struct memory *memory)
{
    static const double balance = 1e-3;
    for (ring->tension = soft_tension; ring->tension > rough_tension; ring->tension *= 0.1)
        ring_balance(ring, memory, balance);
    ring->tension = rough_tension;
    ring_balance(ring, memory, balance);
    return expected_radius(ring);
}

/* The current packing of a chain of perturbations, and the best of all chains. */
struct record {
    double radius;
    double x[UNKNOWNS];
};

static void search(struct ring *ring, struct memory *memory,
                   const struct wb_packing_search *settings, struct record *best)
{
    static const double progress = 1e-6;
    struct record chain = {.radius = (double)INFINITY};
    uint64_t state = settings->seed;
    const int trials = settings->trials > 0 ? settings->trials : 40 * ring->n;
    const int patience = 2 * ring->n;
    int failures = patience;
    *best = chain;
    for (int trial = 0; trial < trials; trial++) {
        if (failures >= patience) {
            throw_all(ring, &state);
            chain.radius = (double)INFINITY;
            failures = 0;
        } else {
            memcpy(ring->x, chain.x, sizeof ring->x);
            disturb(ring, &state);
        }
        const double radius = relax(ring, memory);
        failures = radius < chain.radius - progress ? 0 : failures + 1;
        if (radius < chain.radius) {
            chain.radius = radius;
            memcpy(chain.x, ring->x, sizeof ring->x);
        }
        if (chain.radius < best->radius)
            *best = chain;
    }
}

enum wb_status wb_packing_densest(struct wb_packing *packing, int n, const double *diameter,
                                  const struct wb_packing_search *settings)
{
    struct wb_packing found = {0};
    struct ring ring;
    struct record best;
    WB_TRY(take(&found, n, diameter));
    struct memory *const memory = wb_memory_new(1, sizeof *memory);
    ring_enter(&ring, &found);
    search(&ring, memory, settings, &best);
    memcpy(ring.x, best.x, sizeof ring.x);
    const enum wb_status status = ring_settle(&ring, memory, rough_tension, &found);
    free(memory);
    if (status == WB_OK)
        *packing = found;
    return status;
}
