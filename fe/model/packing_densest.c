/* The search of wb_packing_densest() of fe/model/packing.h: monotonic basin hopping (Grosso et al.
 * 2010) from random starts. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "fe/model/packing_private.h"

#define WB_LOG_DOMAIN "packing"

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

/* A point within the radius R of the origin, without any function that two libraries could round
 * differently. */
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

static void throw_all(struct wb_packing_ring *ring, uint64_t *state)
{
    double area = 0.0;
    for (int i = 0; i < ring->n; i++)
        area += ring->radius[i] * ring->radius[i];
    const double R = sqrt(area / 0.7);
    for (int i = 0; i < ring->n; i++)
        throw_wire(state, R, &ring->x[2 * i]);
    ring->x[2 * ring->n] = R;
}

/* Moves one wire elsewhere, or exchanges two of different size. */
static void disturb(struct wb_packing_ring *ring, uint64_t *state)
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
static double expected_radius(const struct wb_packing_ring *ring)
{
    double gradient[WB_PACKING_UNKNOWNS];
    const double energy = wb_packing_ring_energy(ring, ring->x, gradient);
    const double R = ring->x[2 * ring->n];
    return R + 2.0 * (energy / ring->tension - (R - ring->reference));
}

static double relax(struct wb_packing_ring *ring, struct wb_packing_memory *memory)
{
    static const double balance = 1e-3;
    for (ring->tension = soft_tension; ring->tension > rough_tension; ring->tension *= 0.1)
        wb_packing_ring_balance(ring, memory, balance);
    ring->tension = rough_tension;
    wb_packing_ring_balance(ring, memory, balance);
    return expected_radius(ring);
}

/* What a chain of disturbances goes on from, and the best of all. */
struct record {
    double radius;
    double x[WB_PACKING_UNKNOWNS];
};

static void search(struct wb_packing_ring *ring, struct wb_packing_memory *memory,
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
    struct wb_packing_ring ring;
    struct record best;
    WB_TRY(wb_packing_take(&found, n, diameter));
    struct wb_packing_memory *const memory = calloc(1, sizeof *memory);
    if (!memory)
        return wb_fail(WB_ERR_MEMORY, "no memory for the search of a packing");
    wb_packing_ring_enter(&ring, &found);
    search(&ring, memory, settings, &best);
    memcpy(ring.x, best.x, sizeof ring.x);
    const enum wb_status status = wb_packing_ring_settle(&ring, memory, rough_tension, &found);
    free(memory);
    if (status == WB_OK)
        *packing = found;
    return status;
}
