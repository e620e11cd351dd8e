#include "fe/swept/swept_cohesion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "fe/swept/swept_cohesion_kernel.h"
#include "fe/swept/swept_private.h"

#define WB_LOG_DOMAIN "swept"

enum {
    LANES = WB_SWEPT_LANES,
    ROWS = WB_SWEPT_COHESION_ROWS
};

static const struct wb_swept_cohesion_kernel *const kernels[][2] =
    WB_SWEPT_KERNEL_VERSIONS(wb_swept_cohesion_kernel);

struct wb_swept_cohesion {
    const struct wb_swept_tape *tape;             /* borrowed */
    const struct wb_swept_tape_model *tape_model; /* the tape's */
    struct wb_swept_cohesion_settings settings;
    const struct wb_swept_cohesion_kernel *kernel;
    struct wb_swept_cohesion_kernel_model model;
    int n_wires;
    int n_strips, room;
    struct wb_swept_cohesion_strip *strip;
    double *numbers; /* rows of each strip (ROWS x LANES) */
    int *first;      /* (n_blocks + 1) */
    int *strip_of;   /* (n_nodes x n_stations); -1: not bonded */
    void *rows, *damage;
    struct wb_memory memory; /* owns all arrays except strip and numbers, which grow */
};

/* The bond point of a ring node in the reference state. */
struct facing {
    struct wb_swept_cohesion_strip strip; /* the nodes, common to a strip */
    double weight, offset, area;
};

static const struct wb_swept_layout *layout_of(const struct wb_swept_cohesion *c)
{
    return &c->tape_model->layout;
}

/* --- places --- */

/* A node's position and director at a station, in the plane of the section. */
struct ray {
    double y, z, to_y, to_z;
};

static struct ray ray_of(const struct wb_swept_cohesion *c, int k, int j)
{
    const size_t stride = (size_t)layout_of(c)->stride, at = 3 * (size_t)k * stride + (size_t)j;
    const double *x = c->tape_model->position + at, *d = wb_swept_tape_directors(c->tape) + at;
    return (struct ray){x[stride], x[2 * stride], d[stride], d[2 * stride]};
}

/* Takes the intersection of the ray with the segment from a to b, at x - o d, if it is nearer than
 * the one found before. */
static void try_segment(const struct ray *ray, const double a[2], const double b[2],
                        const int nodes[2], double least, struct facing *best)
{
    const double slack = 1e-9, along_y = b[0] - a[0], along_z = b[1] - a[1];
    const double det = along_y * ray->to_z - along_z * ray->to_y;
    const double from_y = ray->y - a[0], from_z = ray->z - a[1];
    const double w = (from_y * ray->to_z - from_z * ray->to_y) / det;
    const double o = (along_y * from_z - along_z * from_y) / det;

    if (!(w >= -slack && w <= 1.0 + slack && o > least && fabs(o) < fabs(best->offset)))
        return;
    best->offset = o;
    best->weight = w;
    memcpy(best->strip.partner, nodes, sizeof best->strip.partner);
}

static void face_wire(const struct ray *ray, const struct wb_swept_wire *wire, struct facing *best)
{
    for (int i = 0; i < wire->n_surface; i++) {
        const int nodes[2] = {wire->surface[i], wire->surface[(i + 1) % wire->n_surface]};
        const double *own = wire->node[nodes[0]], *next = wire->node[nodes[1]];
        const double a[2] = {wire->y + own[0], wire->z + own[1]};
        const double b[2] = {wire->y + next[0], wire->z + next[1]};
        try_segment(ray, a, b, nodes, -(double)INFINITY, best);
    }
}

/* Finds the next winding inside; directors point outwards. */
static void find_winding_below(const struct wb_swept_cohesion *c, int k, int j,
                               const struct ray *ray, struct facing *best)
{
    const int n = layout_of(c)->n_nodes, last = c->tape_model->closed ? n : n - 1;

    for (int i = 0; i < last; i++) {
        const int nodes[2] = {i, (i + 1) % n};
        const struct ray a = ray_of(c, nodes[0], j), b = ray_of(c, nodes[1], j);
        const double from[2] = {a.y, a.z}, to[2] = {b.y, b.z};
        if (nodes[0] != k && nodes[1] != k)
            try_segment(ray, from, to, nodes, 0.0, best);
    }
}

static enum wb_status find_facing(const struct wb_swept_cohesion *c,
                                  const struct wb_swept_wire *wires,
                                  const struct wb_swept_cohesion_bond *bond, int k, int j,
                                  struct facing *out)
{
    const struct ray ray = ray_of(c, k, j);

    *out = (struct facing){.strip = {.node = k, .to = bond->to}, .offset = (double)INFINITY};
    if (bond->to == WB_SWEPT_COHESION_TAPE)
        find_winding_below(c, k, j, &ray, out);
    else
        face_wire(&ray, &wires[bond->to], out);
    if (!isfinite(out->offset))
        return wb_fail(WB_ERR_ARGUMENT,
                       "tape node %d has no surface below it at station %d: expected one on the "
                       "line along its director",
                       k, j);
    out->area = bond->share * wb_swept_tape_area(c->tape, k, j);
    out->strip.outwards = out->offset < 0.0 ? -1.0 : 1.0;
    return WB_OK;
}

/* --- strips --- */

/* Finds the strip with the nodes of a bond, from strip `from` on, or adds one. */
static int find_strip(struct wb_swept_cohesion *c, const struct facing *f, int from)
{
    for (int s = c->n_strips - 1; s >= from; s--)
        if (memcmp(&c->strip[s], &f->strip, sizeof f->strip) == 0)
            return s;
    if (c->n_strips == c->room) {
        c->room = 2 * c->room + 64;
        const size_t room = (size_t)c->room;
        c->strip = wb_memory_resize(c->strip, room, sizeof *c->strip);
        c->numbers = wb_memory_resize(c->numbers, room * ROWS * LANES, sizeof *c->numbers);
    }
    const int added = c->n_strips++;
    memset(c->numbers + (size_t)added * ROWS * LANES, 0, ROWS * LANES * sizeof *c->numbers);
    c->strip[added] = f->strip;
    return added;
}

static enum wb_status add_bond(struct wb_swept_cohesion *c, const struct wb_swept_wire *wires,
                               const struct wb_swept_cohesion_bond *bond, int k, int j, int from)
{
    const int n_stations = layout_of(c)->n_stations;
    struct facing f;

    if (bond->to == WB_SWEPT_COHESION_FREE)
        return WB_OK;
    if (bond->to < WB_SWEPT_COHESION_TAPE || bond->to >= c->n_wires ||
        !(bond->share > 0.0 && bond->share <= 1.0))
        return wb_fail(
            WB_ERR_ARGUMENT,
            "tape node %d: wire %d, share %g: expected a wire from 0 to %d, or %d for the "
            "tape, and a share above 0, at most 1",
            k, bond->to, bond->share, c->n_wires - 1, WB_SWEPT_COHESION_TAPE);
    WB_TRY(find_facing(c, wires, bond, k, j, &f));
    const int s = find_strip(c, &f, from);
    double *rows = c->numbers + (size_t)s * ROWS * LANES + j % LANES;
    rows[WB_SWEPT_COHESION_WEIGHT * LANES] = f.weight;
    rows[WB_SWEPT_COHESION_OFFSET * LANES] = f.offset;
    rows[WB_SWEPT_COHESION_BONDED * LANES] = f.area;
    c->strip_of[k * n_stations + j] = s;
    return WB_OK;
}

static enum wb_status make_strips(struct wb_swept_cohesion *c, const struct wb_swept_wire *wires,
                                  const struct wb_swept_cohesion_bond *bond)
{
    const struct wb_swept_layout *layout = layout_of(c);
    const int n_blocks = layout->stride / LANES;

    for (int i = 0; i < layout->n_nodes * layout->n_stations; i++)
        c->strip_of[i] = -1;
    for (int b = 0; b < n_blocks; b++) {
        c->first[b] = c->n_strips;
        for (int k = 0; k < layout->n_nodes; k++) {
            const int from = c->n_strips;
            for (int j = b * LANES; j < (b + 1) * LANES && j < layout->n_stations; j++)
                WB_TRY(add_bond(c, wires, &bond[k * layout->n_stations + j], k, j, from));
        }
    }
    c->first[n_blocks] = c->n_strips;
    return WB_OK;
}

/* --- creation --- */

static enum wb_status check(const struct wb_swept_cohesion_settings *s)
{
    const double stored = 0.5 * fmax(s->strength * s->strength / s->normal_stiffness,
                                     s->shear_strength * s->shear_strength / s->shear_stiffness);

    if (!wb_swept_is_positive(s->normal_stiffness) || !wb_swept_is_positive(s->shear_stiffness))
        return wb_fail(WB_ERR_ARGUMENT,
                       "cohesion: the normal stiffness is %g Pa/m and the shear stiffness %g Pa/m: "
                       "expected numbers above 0",
                       s->normal_stiffness, s->shear_stiffness);
    if (s->strength == 0.0)
        return WB_OK;
    if (!wb_swept_is_positive(s->strength) || !wb_swept_is_positive(s->shear_strength))
        return wb_fail(
            WB_ERR_ARGUMENT,
            "cohesion: the normal strength is %g Pa and the shear strength %g Pa: expected numbers "
            "above 0, or a normal strength of 0 for a bond that never breaks",
            s->strength, s->shear_strength);
    if (!(s->fracture_energy > 1.001 * stored && isfinite(s->fracture_energy)))
        return wb_fail(
            WB_ERR_ARGUMENT,
            "cohesion: fracture energy %g J/m2: expected more than 1.001 times the %g J/m2 "
            "stored at the onset of damage",
            s->fracture_energy, stored);
    return WB_OK;
}

static enum wb_status fill(struct wb_swept_cohesion *c, const struct wb_swept_wire *wires,
                           const struct wb_swept_cohesion_bond *bond)
{
    const struct wb_swept_layout *layout = layout_of(c);
    const struct wb_swept_cohesion_settings *s = &c->settings;
    const size_t n_blocks = (size_t)layout->stride / LANES;
    const bool breaks = s->strength > 0.0, is_double = c->tape_model->double_precision;

    WB_TRY(check(s));
    c->kernel = kernels[c->tape_model->instructions][is_double];
    c->first = wb_memory_take(&c->memory, n_blocks + 1, sizeof *c->first);
    c->strip_of = wb_memory_take(&c->memory, (size_t)layout->n_nodes * (size_t)layout->n_stations,
                                 sizeof *c->strip_of);
    WB_TRY(make_strips(c, wires, bond));
    c->rows = wb_swept_kernel_convert(&c->memory, is_double, c->numbers,
                                      (size_t)c->n_strips * ROWS * LANES);
    c->damage = wb_swept_take(&c->memory, (size_t)c->n_strips * LANES,
                              wb_swept_kernel_real_size(is_double));
    c->model = (struct wb_swept_cohesion_kernel_model){
        .stride = layout->stride,
        .first = c->first,
        .strip = c->strip,
        .rows = c->rows,
        .normal = s->normal_stiffness,
        .shear = s->shear_stiffness,
        .breaks = breaks,
        .per_strength = breaks ? s->normal_stiffness / s->strength : 0.0,
        .per_shear_strength = breaks ? s->shear_stiffness / s->shear_strength : 0.0,
        .fracture_energy = s->fracture_energy,
        .counted = wb_swept_range_within(c->tape_model->counted, layout->n_stations),
    };
    return WB_OK;
}

enum wb_status wb_swept_cohesion_create(struct wb_swept_cohesion **out,
                                        const struct wb_swept_tape *tape,
                                        const struct wb_swept_cohesion_settings *settings,
                                        int n_wires, const struct wb_swept_wire *wires,
                                        const struct wb_swept_cohesion_bond *bond)
{
    *out = NULL;
    struct wb_swept_cohesion *const c = wb_memory_new(1, sizeof *c);
    c->tape = tape;
    c->tape_model = wb_swept_tape_get_model(tape);
    c->settings = *settings;
    c->n_wires = n_wires;
    const enum wb_status status = fill(c, wires, bond);
    if (status != WB_OK) {
        wb_swept_cohesion_destroy(c);
        return status;
    }
    *out = c;
    return WB_OK;
}

void wb_swept_cohesion_destroy(struct wb_swept_cohesion *cohesion)
{
    if (!cohesion)
        return;
    free(cohesion->strip);
    free(cohesion->numbers);
    wb_memory_release(&cohesion->memory);
    free(cohesion);
}

void *wb_swept_cohesion_data(struct wb_swept_cohesion *cohesion, size_t *bytes)
{
    *bytes = (size_t)cohesion->n_strips * LANES *
             wb_swept_kernel_real_size(cohesion->tape_model->double_precision);
    return cohesion->damage;
}

void wb_swept_cohesion_add_forces(struct wb_swept_cohesion *cohesion,
                                  const struct wb_swept_cohesion_fields *fields, int first, int end,
                                  struct wb_swept_cohesion_sums *sums)
{
    cohesion->kernel->add_forces(&cohesion->model, fields, cohesion->damage, first, end, sums);
}

/* --- queries --- */

static double number(const struct wb_swept_cohesion *c, int strip, int row, int lane)
{
    return c->numbers[((size_t)strip * ROWS + (size_t)row) * LANES + (size_t)lane];
}

double wb_swept_cohesion_area(const struct wb_swept_cohesion *cohesion)
{
    double area = 0.0;

    for (int s = 0; s < cohesion->n_strips; s++) {
        for (int lane = 0; lane < LANES; lane++)
            area += number(cohesion, s, WB_SWEPT_COHESION_BONDED, lane);
    }
    return area;
}

int wb_swept_cohesion_partner(const struct wb_swept_cohesion *cohesion, int node, int station)
{
    const int s = cohesion->strip_of[node * layout_of(cohesion)->n_stations + station];
    return s < 0 ? WB_SWEPT_COHESION_FREE : cohesion->strip[s].to;
}

double wb_swept_cohesion_damage(const struct wb_swept_cohesion *cohesion, int node, int station)
{
    const int s = cohesion->strip_of[node * layout_of(cohesion)->n_stations + station];
    const size_t at = (size_t)s * LANES + (size_t)(station % LANES);

    if (s < 0)
        return 1.0;
    return wb_swept_kernel_get(cohesion->tape_model->double_precision, cohesion->damage,
                               (ptrdiff_t)at);
}

static double largest_stiffness(const struct wb_swept_cohesion *c)
{
    return fmax(c->settings.normal_stiffness, c->settings.shear_stiffness);
}

/* A bond's energy is at most twice the sum of the energies with either of its sides moved alone:
 * hence the factor. End stations have half the area and half the mass. */
static const double both_sides = 2.0;

double wb_swept_cohesion_wire_stiffness_per_mass(const struct wb_swept_cohesion *cohesion, int wire,
                                                 const double *mass)
{
    const struct wb_swept_layout *layout = layout_of(cohesion);
    double most = 0.0;

    for (int j = 0; j < layout->n_stations; j++) {
        const bool is_end = j == 0 || j == layout->n_stations - 1;
        for (int s = cohesion->first[j / LANES]; s < cohesion->first[j / LANES + 1]; s++) {
            for (int side = 0; side < 2 && cohesion->strip[s].to == wire; side++) {
                /* Row sum of the node at this side of the strip, over all strips. */
                const int node = cohesion->strip[s].partner[side];
                double sum = 0.0;
                for (int t = cohesion->first[j / LANES]; t < cohesion->first[j / LANES + 1]; t++) {
                    const struct wb_swept_cohesion_strip *other = &cohesion->strip[t];
                    const double w = number(cohesion, t, WB_SWEPT_COHESION_WEIGHT, j % LANES);
                    const double area = number(cohesion, t, WB_SWEPT_COHESION_BONDED, j % LANES);
                    if (other->to == wire && other->partner[0] == node)
                        sum += area * fabs(1.0 - w);
                    if (other->to == wire && other->partner[1] == node)
                        sum += area * fabs(w);
                }
                most = fmax(most, sum / (mass[node] * (is_end ? 0.5 : 1.0)));
            }
        }
    }
    return both_sides * largest_stiffness(cohesion) * most;
}

double wb_swept_cohesion_tape_stiffness_per_mass(const struct wb_swept_cohesion *cohesion,
                                                 const double *mass, const double *inertia)
{
    const struct wb_swept_layout *layout = layout_of(cohesion);
    const double *x = mass;
    double most = 0.0;

    for (int j = 0; j < layout->n_stations; j++) {
        const double length = j == 0 || j == layout->n_stations - 1 ? 0.5 : 1.0;
        for (int s = cohesion->first[j / LANES]; s < cohesion->first[j / LANES + 1]; s++) {
            const struct wb_swept_cohesion_strip *strip = &cohesion->strip[s];
            const double o = number(cohesion, s, WB_SWEPT_COHESION_OFFSET, j % LANES);
            const double area = number(cohesion, s, WB_SWEPT_COHESION_BONDED, j % LANES);
            double flexibility = 1.0 / x[strip->node] + o * o / inertia[strip->node];
            /* A winding that is bonded to others is also the lower side of bonds. */
            if (strip->to == WB_SWEPT_COHESION_TAPE)
                flexibility += 2.0 / fmin(x[strip->partner[0]], x[strip->partner[1]]);
            most = fmax(most, area * flexibility / length);
        }
    }
    return both_sides * largest_stiffness(cohesion) * most;
}
