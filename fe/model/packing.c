#include "fe/model/packing.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "fe/model/packing_private.h"

#define WB_LOG_DOMAIN "packing"

static const double pi = 3.14159265358979323846;

double wb_packing_distance(const struct wb_packing_circle *a, const struct wb_packing_circle *b)
{
    const double y = b->y - a->y, z = b->z - a->z;
    return sqrt(y * y + z * z);
}

enum wb_status wb_packing_take(struct wb_packing *packing, int n, const double *diameter)
{
    if (n < 1 || n > WB_PACKING_MOST)
        return wb_fail(WB_ERR_ARGUMENT, "%d wires, expected 1 to %d", n, WB_PACKING_MOST);
    packing->n = n;
    for (int i = 0; i < n; i++) {
        if (!(diameter[i] > 0.0 && isfinite(diameter[i])))
            return wb_fail(WB_ERR_ARGUMENT, "a wire with a diameter of %g m", diameter[i]);
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
                site->angle += 2.0 * pi;
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
    WB_TRY(wb_packing_take(&filled, n, diameter));
    for (int i = 0; i < n; i++)
        pitch = fmax(pitch, diameter[i]);
    const int whole = wb_packing_whole(lattice, n, &less);
    if (whole != n)
        return wb_fail(WB_ERR_ARGUMENT, "%d wires are no whole patch of the lattice: %d or %d are",
                       n, less, whole);
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
            smallest = fmin(smallest, wb_packing_distance(p, q) - p->radius - q->radius);
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
    return wb_packing_distance(c, &nearest) <= (1.0 + 1e-9) * c->radius;
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
            const double gap = wb_packing_distance(p, q) - p->radius - q->radius;
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
    const double d = wb_packing_distance(a, b);
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

/* How far a circle stands out of another. */
static double excess(const struct wb_packing_circle *outer, const struct wb_packing_circle *circle)
{
    return wb_packing_distance(outer, circle) + circle->radius - outer->radius;
}

static const double enclosing_tolerance = 1e-13; /* of the radius */

/* The circles that hold the enclosing one. */
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

/* The smallest circle round the four or less of `all`, by trying every subset of up to three, which
 * then is the basis. */
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

/* From a basis to the next with the circle that stands out farthest: the radius grows each time, so
 * no basis comes back. */
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
            /* Round-off: what is left is made part of the circle. */
            enclosing.radius += out;
            return enclosing;
        }
        enclosing = next;
        basis = next_basis;
    }
}
