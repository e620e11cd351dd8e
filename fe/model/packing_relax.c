/* Wires in a ring that tightens: wb_packing_settle() of fe/model/packing.h.
 *
 * With positions p_i and the ring's radius R as unknowns, in units of the mean radius,
 *     E = P (R + q sum |p_i|^2 / 2) + sum o_ij^2 / 2 + sum w_i^2 / 2,
 *     o_ij = max(0, r_i + r_j - |p_i - p_j|),  w_i = max(0, |p_i| + r_i - R):
 * elastic discs in a ring of the tension P, with a pull q to its centre that is too slight to move
 * any but those that carry nothing. As P goes to zero the overlaps do in proportion, and what
 * remains is a packing in which no small motion lets the ring become smaller. The last of them is
 * removed by making all contacts exact at once.
 */
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "fe/model/packing_private.h"

#define WB_LOG_DOMAIN "packing"

enum {
    UNKNOWNS = WB_PACKING_UNKNOWNS,
    STEPS = WB_PACKING_STEPS,
    MOST_ITERATIONS = 1000,
    MOST_CONTACTS = 4 * WB_PACKING_MOST /* in the plane at most 3 n - 3 pairs, and n at the ring */
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
static double press_pairs(const struct wb_packing_ring *ring, const double *x, int i,
                          double *gradient)
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

double wb_packing_ring_energy(const struct wb_packing_ring *ring, const double *x, double *gradient)
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
static void find_direction(int n, const struct wb_packing_memory *memory, const double *gradient,
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

static void remember(int n, struct wb_packing_memory *memory, const double *step,
                     const double *change)
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

static void look(const struct wb_packing_ring *ring, struct point *point)
{
    point->energy = wb_packing_ring_energy(ring, point->x, point->gradient);
}

/* A step along the direction that lowers the energy enough; false: there is none. */
static bool step_down(const struct wb_packing_ring *ring, const double *direction,
                      const struct point *from, struct point *to)
{
    const int n = 2 * ring->n + 1;
    const double slope = dot(n, from->gradient, direction);
    double longest = 0.0;
    if (!(slope < 0.0))
        return false;
    for (int i = 0; i < n; i++)
        longest = fmax(longest, fabs(direction[i]));
    /* No wire moves farther than its radius at once. */
    for (double part = fmin(1.0, 1.0 / longest); part > 1e-12; part *= 0.5) {
        memcpy(to->x, from->x, (size_t)n * sizeof *to->x);
        add(n, part, direction, to->x);
        look(ring, to);
        if (to->energy <= from->energy + 1e-4 * part * slope)
            return true;
    }
    return false;
}

void wb_packing_ring_balance(struct wb_packing_ring *ring, struct wb_packing_memory *memory,
                             double balance)
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
                break; /* no digit left to go down by */
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

/* All that overlap; the same ones again, with their gaps, where there are some. */
static void measure(const struct wb_packing_ring *ring, struct contact *contact)
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

static void find_contacts(const struct wb_packing_ring *ring, struct contacts *contacts)
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

/* Newton's method on all contacts that carry something. */
static void make_exact(struct wb_packing_ring *ring)
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

void wb_packing_ring_enter(struct wb_packing_ring *ring, const struct wb_packing *packing)
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

/* Moves the wires apart by what is left of overlap, and their circle's centre to the origin. */
static void leave(const struct wb_packing_ring *ring, struct wb_packing *packing)
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
            apart = fmax(apart, (a->radius + b->radius) / wb_packing_distance(a, b));
        }
    }
    const struct wb_packing_circle circle = wb_packing_enclosing(packing->n, packing->wire);
    for (int i = 0; i < ring->n; i++) {
        packing->wire[i].y = apart * (packing->wire[i].y - circle.y);
        packing->wire[i].z = apart * (packing->wire[i].z - circle.z);
    }
}

enum wb_status wb_packing_ring_settle(struct wb_packing_ring *ring,
                                      struct wb_packing_memory *memory, double from,
                                      struct wb_packing *packing)
{
    static const double slight = 1e-3, balance = 1e-6, to = 1e-6;
    struct wb_packing settled = *packing;
    ring->pull = slight;
    for (ring->tension = from; ring->tension > 0.99 * to; ring->tension *= 0.1)
        wb_packing_ring_balance(ring, memory, balance);
    make_exact(ring);
    leave(ring, &settled);
    if (!(wb_packing_smallest_gap(&settled) >= -1e-12 * mean_radius(&settled)) ||
        !isfinite(wb_packing_enclosing(settled.n, settled.wire).radius))
        return wb_fail(WB_ERR_CONVERGENCE, "%d wires do not settle", settled.n);
    *packing = settled;
    return WB_OK;
}

/* Lattices may be balanced on a ridge: small steps off it, the same every time. */
static void shake(struct wb_packing_ring *ring)
{
    static const double most = 1e-3, golden = 0.6180339887498949;
    for (int i = 0; i < 2 * ring->n; i++)
        ring->x[i] += most * (2.0 * fmod(golden * (i + 1), 1.0) - 1.0);
}

enum wb_status wb_packing_settle(struct wb_packing *packing)
{
    static const double firm = 0.01; /* wires do not pass each other */
    struct wb_packing_ring ring;
    struct wb_packing_memory *const memory = calloc(1, sizeof *memory);
    if (!memory)
        return wb_fail(WB_ERR_MEMORY, "no memory to settle wires");
    wb_packing_ring_enter(&ring, packing);
    shake(&ring);
    const enum wb_status status = wb_packing_ring_settle(&ring, memory, firm, packing);
    free(memory);
    return status;
}
