#include "fe/output/bundle_fields.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "fe/bundle/bundle_part.h"
#include "fe/material/material.h"
#include "fe/swept/swept_hex_stress.h"

enum {
    TENSOR = 6
};

/* Sums at a point, for averages. */
struct sum {
    double stress[TENSOR], plastic;
    int n;
};

/* --- the mesh --- */

static const struct wb_swept_section *section_of(const struct wb_bundle_bodies *bodies, int wire)
{
    return &bodies->type[bodies->model->type_of[wire]].section;
}

static void count(struct wb_bundle_fields *f, const struct wb_bundle_bodies *bodies)
{
    f->n_bodies = bodies->n_wires + (bodies->has_tape ? 1 : 0);
    for (int w = 0; w < bodies->n_wires; w++) {
        const struct wb_swept_layout *layout = &bodies->wire[w].layout;
        f->n_points += layout->n_nodes * layout->n_stations;
        f->n_hexahedra += section_of(bodies, w)->n_quads * (layout->n_stations - 1);
    }
    if (bodies->has_tape) {
        const struct wb_swept_layout *ring = &bodies->ring.layout;
        f->n_points += ring->n_nodes * ring->n_stations;
        f->n_quads = wb_swept_tape_elements(bodies->tape) * (ring->n_stations - 1);
    }
}

static void allocate(struct wb_bundle_fields *f)
{
    const size_t points = (size_t)f->n_points;
    const size_t cells = (size_t)f->n_hexahedra + (size_t)f->n_quads;

    f->bodies = wb_memory_take(&f->memory, (size_t)f->n_bodies, sizeof *f->bodies);
    f->reference = wb_memory_take(&f->memory, points, sizeof *f->reference);
    f->position = wb_memory_take(&f->memory, points, sizeof *f->position);
    f->von_mises = wb_memory_take(&f->memory, points, sizeof *f->von_mises);
    f->plastic = wb_memory_take(&f->memory, points, sizeof *f->plastic);
    f->hexahedron = wb_memory_take(&f->memory, (size_t)f->n_hexahedra, sizeof *f->hexahedron);
    f->quad = wb_memory_take(&f->memory, (size_t)f->n_quads + 1, sizeof *f->quad);
    f->body = wb_memory_take(&f->memory, cells, sizeof *f->body);
}

static void set_outline(struct wb_bundle_fields *f, struct wb_bundle_fields_body *body,
                        const struct wb_swept_section *section)
{
    body->n_outline = section->n_outline;
    body->outline =
        wb_memory_take(&f->memory, (size_t)section->n_outline + 1, sizeof *body->outline);
    memcpy(body->outline, section->outline, (size_t)section->n_outline * sizeof *body->outline);
}

/* Positions of a field at the body's points. */
static void read_points(const struct wb_bundle_fields_body *body, int stride, const double *field,
                        double (*points)[3])
{
    for (int k = 0; k < body->n_nodes; k++)
        for (int i = 0; i < 3; i++) {
            const double *row = field + (ptrdiff_t)(3 * k + i) * stride;
            for (int j = 0; j < body->n_stations; j++)
                points[body->first + j * body->n_nodes + k][i] = row[j];
        }
}

/* Adds a wire's straight positions, and its hexahedra starting at `cell`; returns the next cell. */
static int mesh_wire(struct wb_bundle_fields *f, const struct wb_bundle_bodies *bodies, int w,
                     int cell)
{
    const struct wb_swept_section *section = section_of(bodies, w);
    const struct wb_packing_circle *circle = &bodies->model->packing.wire[w];
    const struct wb_bundle_fields_body *body = &f->bodies[w];
    const int n = body->n_nodes;

    for (int j = 0; j < body->n_stations; j++)
        for (int k = 0; k < n; k++) {
            double *at = f->reference[body->first + j * n + k];
            at[0] = j * bodies->spacing;
            at[1] = circle->y + section->node[k][0];
            at[2] = circle->z + section->node[k][1];
        }
    for (int j = 0; j < body->n_stations - 1; j++)
        for (int e = 0; e < section->n_quads; e++, cell++) {
            for (int a = 0; a < 8; a++)
                f->hexahedron[cell][a] = body->first + (j + a / 4) * n + section->quad[e][a % 4];
            f->body[cell] = w;
        }
    return cell;
}

static void mesh_tape(struct wb_bundle_fields *f, const struct wb_bundle_bodies *bodies)
{
    const int tape = bodies->n_wires;
    const struct wb_bundle_fields_body *body = &f->bodies[tape];
    const int n = body->n_nodes, around = wb_swept_tape_elements(bodies->tape);
    int cell = 0;

    read_points(body, bodies->ring.layout.stride, wb_swept_tape_get_model(bodies->tape)->position,
                f->reference);
    for (int j = 0; j < body->n_stations - 1; j++)
        for (int k = 0; k < around; k++, cell++) {
            const int here = body->first + j * n, next = (k + 1) % n;
            const int quad[4] = {here + k, here + n + k, here + n + next, here + next};
            memcpy(f->quad[cell], quad, sizeof quad);
            f->body[f->n_hexahedra + cell] = tape;
        }
}

static void make_mesh(struct wb_bundle_fields *f, const struct wb_bundle_bodies *bodies)
{
    int first = 0, cell = 0;

    for (int b = 0; b < f->n_bodies; b++) {
        const bool is_tape = b == bodies->n_wires;
        const struct wb_swept_layout *layout =
            is_tape ? &bodies->ring.layout : &bodies->wire[b].layout;
        f->bodies[b] = (struct wb_bundle_fields_body){
            .is_tape = is_tape,
            .closed = !is_tape || wb_swept_tape_elements(bodies->tape) == layout->n_nodes,
            .n_nodes = layout->n_nodes,
            .n_stations = layout->n_stations,
            .first = first,
        };
        first += layout->n_nodes * layout->n_stations;
        if (is_tape) {
            mesh_tape(f, bodies);
            continue;
        }
        set_outline(f, &f->bodies[b], section_of(bodies, b));
        cell = mesh_wire(f, bodies, b, cell);
    }
}

void wb_bundle_fields_init(struct wb_bundle_fields *fields, const struct wb_bundle *bundle)
{
    const struct wb_bundle_bodies *bodies = &wb_bundle_whole(bundle)->bodies;

    *fields = (struct wb_bundle_fields){0};
    count(fields, bodies);
    allocate(fields);
    make_mesh(fields, bodies);
    wb_bundle_fields_take(fields, bundle);
}

void wb_bundle_fields_release(struct wb_bundle_fields *fields)
{
    if (!fields)
        return;
    wb_memory_release(&fields->memory);
    *fields = (struct wb_bundle_fields){0};
}

/* --- the state --- */

static void sum_up_wire(const struct wb_bundle_bodies *bodies, int w, struct sum *sums)
{
    const struct wb_swept_hex *hex = bodies->type[bodies->model->type_of[w]].hex;
    const struct wb_swept_section *section = section_of(bodies, w);
    const struct wb_bundle_body *body = &bodies->wire[w];
    const int n = body->layout.n_nodes;

    for (int j = 0; j < body->layout.n_stations - 1; j++) {
        for (int e = 0; e < section->n_quads; e++) {
            struct wb_swept_hex_stress points[4], corners[4];
            wb_swept_hex_stress_find(hex, bodies->wire_state[w], body->position, e, j, points);
            wb_swept_hex_stress_at_corners(hex, points, corners);
            for (int a = 0; a < 8; a++) {
                struct sum *sum = &sums[(j + a / 4) * n + section->quad[e][a % 4]];
                for (int i = 0; i < TENSOR; i++)
                    sum->stress[i] += corners[a % 4].stress[i];
                sum->plastic += corners[a % 4].plastic;
                sum->n++;
            }
        }
    }
}

static void take_wire(struct wb_bundle_fields *f, const struct wb_bundle_bodies *bodies, int w,
                      struct sum *sums)
{
    const struct wb_bundle_fields_body *body = &f->bodies[w];
    const struct wb_material *law = &bodies->model->type[bodies->model->type_of[w]].material;
    const int n = body->n_nodes * body->n_stations;

    read_points(body, bodies->wire[w].layout.stride, bodies->wire[w].position, f->position);
    memset(sums, 0, (size_t)n * sizeof *sums);
    sum_up_wire(bodies, w, sums);
    for (int i = 0; i < n; i++) {
        double mean[TENSOR];
        for (int k = 0; k < TENSOR; k++)
            mean[k] = sums[i].stress[k] / sums[i].n;
        const double plastic = fmax(0.0, sums[i].plastic / sums[i].n);
        const double stress = wb_material_von_mises(mean);
        const double most = wb_material_flow_stress(law, plastic);
        f->plastic[body->first + i] = plastic;
        f->von_mises[body->first + i] = stress > most ? most : stress;
    }
}

static void take_tape(struct wb_bundle_fields *f, const struct wb_bundle_bodies *bodies,
                      struct sum *sums)
{
    const struct wb_bundle_fields_body *body = &f->bodies[bodies->n_wires];
    const double *position = bodies->ring.position, *director = bodies->directors.position;
    const int n = body->n_nodes, around = wb_swept_tape_elements(bodies->tape);

    read_points(body, bodies->ring.layout.stride, position, f->position);
    memset(sums, 0, (size_t)(n * body->n_stations) * sizeof *sums);
    for (int j = 0; j < body->n_stations - 1; j++)
        for (int k = 0; k < around; k++) {
            struct wb_swept_tape_stress out[WB_SWEPT_TAPE_STRESS_MOST];
            double stress = 0.0, plastic = 0.0;
            wb_swept_tape_stress_find(bodies->tape, bodies->tape_state, position, director, k, j,
                                      out);
            for (int q = 0; q < wb_swept_tape_stress_points(bodies->tape); q++) {
                stress = fmax(stress, wb_swept_tape_stress_von_mises(out[q].stress));
                plastic = fmax(plastic, out[q].plastic);
            }
            for (int a = 0; a < 4; a++) {
                struct sum *sum = &sums[(j + a / 2) * n + (k + a % 2) % n];
                sum->stress[0] += stress;
                sum->plastic += plastic;
                sum->n++;
            }
        }
    for (int i = 0; i < n * body->n_stations; i++) {
        f->von_mises[body->first + i] = sums[i].stress[0] / sums[i].n;
        f->plastic[body->first + i] = sums[i].plastic / sums[i].n;
    }
}

void wb_bundle_fields_take(struct wb_bundle_fields *fields, const struct wb_bundle *bundle)
{
    const struct wb_bundle_bodies *bodies = &wb_bundle_whole(bundle)->bodies;
    int most = 0;

    for (int b = 0; b < fields->n_bodies; b++) {
        const int n = fields->bodies[b].n_nodes * fields->bodies[b].n_stations;
        most = n > most ? n : most;
    }
    struct sum *const sums = wb_memory_new((size_t)most, sizeof *sums);
    for (int w = 0; w < bodies->n_wires; w++)
        take_wire(fields, bodies, w, sums);
    if (bodies->has_tape)
        take_tape(fields, bodies, sums);
    free(sums);
}
