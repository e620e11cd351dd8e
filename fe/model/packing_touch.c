/* Newton's method for gaps g(x) = 0 of the wires' centres x: J dx = -g, of which conjugate
 * gradients on J^T J dx = -J^T g (CGLS), begun at zero, find the shortest dx. A patch of a lattice
 * has more contacts than unknowns, which do not contradict each other. */
#include "fe/model/packing_touch.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "base/units.h"

#define WB_LOG_DOMAIN "packing"

enum {
    MOST_PAIRS = 3 * WB_PACKING_MOST, /* of touching circles in a plane */
    MOST_STEPS = 60
};

static const double exact = 1e-13; /* of the largest diameter: remaining gap */

struct contacts {
    int n, wires;
    struct wb_packing_pair pair[MOST_PAIRS];
    double y[MOST_PAIRS], z[MOST_PAIRS]; /* from a to b */
};

/* gaps = J x, x as (y, z) of each wire */
static void open(const struct contacts *c, const double *x, double *gaps)
{
    for (int k = 0; k < c->n; k++) {
        const double *const a = x + 2 * c->pair[k].a, *const b = x + 2 * c->pair[k].b;
        gaps[k] = c->y[k] * (b[0] - a[0]) + c->z[k] * (b[1] - a[1]);
    }
}

/* x = J^T gaps; returns its square */
static double push(const struct contacts *c, const double *gaps, double *x)
{
    double square = 0.0;
    memset(x, 0, 2 * (size_t)c->wires * sizeof *x);
    for (int k = 0; k < c->n; k++) {
        double *const a = x + 2 * c->pair[k].a, *const b = x + 2 * c->pair[k].b;
        a[0] -= c->y[k] * gaps[k];
        a[1] -= c->z[k] * gaps[k];
        b[0] += c->y[k] * gaps[k];
        b[1] += c->z[k] * gaps[k];
    }
    for (int i = 0; i < 2 * c->wires; i++)
        square += x[i] * x[i];
    return square;
}

/* The shortest x that closes all gaps, or the least-squares solution. */
static void close_gaps(const struct contacts *c, double *x)
{
    double left[MOST_PAIRS], change[MOST_PAIRS], down[2 * WB_PACKING_MOST],
        along[2 * WB_PACKING_MOST];
    const int n = 2 * c->wires;

    memset(x, 0, (size_t)n * sizeof *x);
    for (int k = 0; k < c->n; k++)
        left[k] = -c->pair[k].gap;
    double square = push(c, left, down);
    const double small = 1e-30 * square;
    memcpy(along, down, sizeof along);
    for (int i = 0; i < 4 * n && square > small; i++) {
        double length = 0.0;
        open(c, along, change);
        for (int k = 0; k < c->n; k++)
            length += change[k] * change[k];
        const double step = square / length, before = square;
        for (int j = 0; j < n; j++)
            x[j] += step * along[j];
        for (int k = 0; k < c->n; k++)
            left[k] -= step * change[k];
        square = push(c, left, down);
        for (int j = 0; j < n; j++)
            along[j] = down[j] + square / before * along[j];
    }
}

/* Updates the pairs, adds pairs that came within reach, and returns the pair with the widest gap or
 * overlap (-1: no pair). */
static int find_contacts(struct contacts *c, const struct wb_packing *packing, double reach)
{
    struct wb_packing_pair near[MOST_PAIRS];
    const int before = c->n, n = wb_packing_pairs(packing, reach, MOST_PAIRS, near);
    int widest = -1;

    for (int i = 0; i < n && i < MOST_PAIRS && c->n < MOST_PAIRS; i++) {
        bool is_new = true;
        for (int k = 0; k < before; k++)
            is_new = is_new && (c->pair[k].a != near[i].a || c->pair[k].b != near[i].b);
        if (is_new)
            c->pair[c->n++] = near[i];
    }
    for (int k = 0; k < c->n; k++) {
        const struct wb_packing_circle *const a = &packing->wire[c->pair[k].a];
        const struct wb_packing_circle *const b = &packing->wire[c->pair[k].b];
        const double distance = hypot(b->y - a->y, b->z - a->z);
        c->pair[k].gap = distance - a->radius - b->radius;
        c->y[k] = (b->y - a->y) / distance;
        c->z[k] = (b->z - a->z) / distance;
        if (widest < 0 || fabs(c->pair[k].gap) > fabs(c->pair[widest].gap))
            widest = k;
    }
    return widest;
}

static enum wb_status refuse(const struct wb_packing_pair *pair, double reach,
                             struct wb_reason *why)
{
    const char *const how = pair->gap < 0.0 ? "overlap by" : "are apart by";
    if (pair->gap < -reach)
        return wb_fail_to(why, WB_ERR_ARGUMENT,
                          "wires %d and %d %s %.3g mm, expected at most the given distance: check "
                          "their places and diameters",
                          pair->a + 1, pair->b + 1, how, -pair->gap / WB_MM);
    return wb_fail_to(why, WB_ERR_ARGUMENT,
                      "not all wires within %g mm of each other can touch: %d and %d still %s %.3g "
                      "mm: give a distance that excludes wires that do not touch",
                      reach / WB_MM, pair->a + 1, pair->b + 1, how, fabs(pair->gap) / WB_MM);
}

enum wb_status wb_packing_touch(struct wb_packing *packing, double reach, struct wb_reason *why)
{
    struct wb_packing moved = *packing;
    struct contacts contacts = {.wires = packing->n};
    double largest = 0.0, x[2 * WB_PACKING_MOST];

    for (int i = 0; i < packing->n; i++)
        largest = fmax(largest, 2.0 * packing->wire[i].radius);
    int widest = find_contacts(&contacts, &moved, reach);
    for (int step = 0; step < MOST_STEPS && widest >= 0; step++) {
        const struct wb_packing_pair *const worst = &contacts.pair[widest];
        if (fabs(worst->gap) <= exact * largest)
            break;
        if (worst->gap < -reach)
            return refuse(worst, reach, why);
        close_gaps(&contacts, x);
        for (int i = 0; i < moved.n; i++) {
            moved.wire[i].y += x[2 * i];
            moved.wire[i].z += x[2 * i + 1];
        }
        widest = find_contacts(&contacts, &moved, reach);
    }
    if (widest >= 0 && fabs(contacts.pair[widest].gap) > exact * largest)
        return refuse(&contacts.pair[widest], reach, why);
    *packing = moved;
    return WB_OK;
}
