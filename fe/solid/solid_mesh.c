#include "fe/solid/solid_mesh.h"

#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "fe/solid/solid_mesh_private.h"

#define WB_LOG_DOMAIN "mesh"

enum {
    FACES = 6,
    MAX_NODES = 10000000 /* keeps node and unknown numbers far below the range of int */
};

/* Nodes of an element's faces, normals outward. */
static const int face_node[FACES][WB_SOLID_MESH_FACE] = {
    {0, 3, 2, 1, 11, 10, 9, 8},  {4, 5, 6, 7, 12, 13, 14, 15}, {0, 1, 5, 4, 8, 17, 12, 16},
    {1, 2, 6, 5, 9, 18, 13, 17}, {2, 3, 7, 6, 10, 19, 14, 18}, {3, 0, 4, 7, 11, 16, 15, 19},
};

/* The face at the start of a slice, in the same order as the face at its end (face 1). */
static const int start_face[WB_SOLID_MESH_FACE] = {0, 1, 2, 3, 8, 9, 10, 11};

enum wb_status wb_solid_mesh_init(struct wb_solid_mesh *mesh, int n_nodes, int n_elements)
{
    if (n_nodes < 1 || n_nodes > MAX_NODES || n_elements < 1 || n_elements > MAX_NODES)
        return wb_fail(WB_ERR_ARGUMENT,
                       "the mesh has %d nodes and %d elements: expected 1 to %d of each", n_nodes,
                       n_elements, MAX_NODES);

    struct wb_solid_mesh made = {
        .n_nodes = n_nodes, .n_elements = n_elements, .n_parts = 1, .n_layers = 1};
    made.node = wb_memory_take(&made.memory, (size_t)n_nodes, sizeof *made.node);
    made.element = wb_memory_take(&made.memory, (size_t)n_elements, sizeof *made.element);
    made.part = wb_memory_take(&made.memory, (size_t)n_elements, sizeof *made.part);
    made.layer = wb_memory_take(&made.memory, 2, sizeof *made.layer);
    made.link = wb_memory_take(&made.memory, 1, sizeof *made.link);
    made.layer[1] = n_nodes;
    *mesh = made;
    return WB_OK;
}

void wb_solid_mesh_release(struct wb_solid_mesh *mesh)
{
    wb_memory_release(&mesh->memory);
    memset(mesh, 0, sizeof *mesh);
}

static void take_face(struct wb_solid_face *face, const struct wb_solid_mesh *mesh, int e,
                      const int which[WB_SOLID_MESH_FACE])
{
    face->element = e;
    for (int k = 0; k < WB_SOLID_MESH_FACE; k++)
        face->node[k] = mesh->element[e][which[k]];
}

/* True if a face lies on z = 0 and its element on the side z > 0. */
static bool is_on_plane(const struct wb_solid_mesh *mesh, int e, const int which[], double near)
{
    double above = 0.0;
    for (int k = 0; k < WB_SOLID_MESH_NODES; k++)
        above += mesh->node[mesh->element[e][k]][2];
    for (int k = 0; k < WB_SOLID_MESH_FACE; k++) {
        if (!(fabs(mesh->node[mesh->element[e][which[k]]][2]) <= near))
            return false;
    }
    return above > 0.0;
}

enum wb_status wb_solid_mesh_longitudinal(const struct wb_solid_mesh *mesh,
                                          struct wb_solid_face **faces, int *n)
{
    double widest = 0.0;
    for (int i = 0; i < mesh->n_nodes; i++)
        widest = fmax(widest, fabs(mesh->node[i][2]));
    const double near = 1e-9 * widest;

    int found = 0;
    for (int e = 0; e < mesh->n_elements; e++) {
        for (int f = 0; f < FACES; f++)
            found += is_on_plane(mesh, e, face_node[f], near);
    }
    if (found == 0)
        return wb_fail(WB_ERR_ARGUMENT, "no face of the mesh lies on the plane z = 0");
    struct wb_solid_face *const list = wb_memory_new((size_t)found, sizeof *list);

    int next = 0;
    for (int e = 0; e < mesh->n_elements; e++) {
        for (int f = 0; f < FACES; f++) {
            if (is_on_plane(mesh, e, face_node[f], near))
                take_face(&list[next++], mesh, e, face_node[f]);
        }
    }
    *faces = list;
    *n = found;
    return WB_OK;
}

enum wb_status wb_solid_mesh_section(const struct wb_solid_mesh *mesh, double x,
                                     struct wb_solid_face **faces, int *n)
{
    if (mesh->n_axis < 3 || !isfinite(x))
        return wb_fail(
            WB_ERR_ARGUMENT,
            "the mesh has no section at x = %g m: expected the mesh of a wire and a finite x", x);

    /* Every second node of the axis lies in a section. */
    int section = 0;
    for (int i = 0; i < mesh->n_axis; i += 2) {
        if (fabs(mesh->node[mesh->axis[i]][0] - x) <
            fabs(mesh->node[mesh->axis[2 * section]][0] - x))
            section = i / 2;
    }
    const int in_slice = mesh->n_tip_faces;
    struct wb_solid_face *const list = wb_memory_new((size_t)in_slice, sizeof *list);

    const int first = (section > 0 ? section - 1 : 0) * in_slice;
    for (int q = 0; q < in_slice; q++)
        take_face(&list[q], mesh, first + q, section > 0 ? face_node[1] : start_face);
    *faces = list;
    *n = in_slice;
    return WB_OK;
}

/* --- sections of 8-node quadrilaterals swept along x --- */

enum {
    MAX_DENSITY = 64,
    MAX_ALONG = 100000,
    PARTS = 2
};

/* Half side of the inner square of a circle of radius 1, and bulge of its sides. Its corners have
 * angles of 117 degrees inside and 121 degrees in the ring. */
static const double square_side = 0.495;
static const double square_bulge = 0.12;

/* Nodes of a section, numbered in the order of addition; corners of quadrilaterals also have a node
 * halfway to the next section. */
struct section {
    int n, n_corners;
    double (*at)[2]; /* (n), first and second coordinate in the section */
    int *halfway;    /* (n), number among the corners, or -1 */
    int n_quads;
    int (*quad)[8]; /* (n_quads): corners, counter-clockwise from first to second coordinate, then
                       midside nodes */
    int *part;      /* (n_quads) */
    int n_edges;
    int (*edge)[2][3];       /* (n_edges), inner and outer: corner, next corner, node between */
    struct wb_memory memory; /* of all arrays */
};

/* Node numbers on a grid of half element steps; -1 in the middle of elements, which have no node
 * there. A ring is periodic in j. */
struct lattice {
    int ni, nj;
    int *id; /* (ni x nj) */
};

static int *lattice_at(const struct lattice *lattice, int i, int j)
{
    return &lattice->id[i * lattice->nj + j % lattice->nj];
}

static void section_init(struct section *s, int most_nodes, int most_quads, int most_edges)
{
    *s = (struct section){0};
    s->at = wb_memory_take(&s->memory, (size_t)most_nodes, sizeof *s->at);
    s->halfway = wb_memory_take(&s->memory, (size_t)most_nodes, sizeof *s->halfway);
    s->quad = wb_memory_take(&s->memory, (size_t)most_quads, sizeof *s->quad);
    s->part = wb_memory_take(&s->memory, (size_t)most_quads, sizeof *s->part);
    s->edge = wb_memory_take(&s->memory, (size_t)most_edges + 1, sizeof *s->edge);
}

static void lattice_init(struct lattice *lattice, int ni, int nj)
{
    lattice->ni = ni;
    lattice->nj = nj;
    lattice->id = wb_memory_new((size_t)ni * (size_t)nj, sizeof *lattice->id);
}

/* Adds the node at grid point (i, j), unless it is the middle of an element, and returns its
 * number. */
static int add_node(struct section *s, int i, int j, double first, double second)
{
    const bool is_corner = i % 2 == 0 && j % 2 == 0;
    if (i % 2 && j % 2)
        return -1;
    s->at[s->n][0] = first;
    s->at[s->n][1] = second;
    s->halfway[s->n] = is_corner ? s->n_corners++ : -1;
    return s->n++;
}

static void add_quads(struct section *s, const struct lattice *lattice, int cells_i, int cells_j,
                      int part)
{
    static const int step[8][2] = {{0, 0}, {2, 0}, {2, 2}, {0, 2}, {1, 0}, {2, 1}, {1, 2}, {0, 1}};
    for (int i = 0; i < cells_i; i++) {
        for (int j = 0; j < cells_j; j++) {
            for (int k = 0; k < 8; k++)
                s->quad[s->n_quads][k] =
                    *lattice_at(lattice, 2 * i + step[k][0], 2 * j + step[k][1]);
            s->part[s->n_quads++] = part;
        }
    }
}

/* Rotates (y, z) by `quarters` right angles, exactly: mesh lines on y = 0 and z = 0 stay there. */
static void turn(double at[2], int quarters)
{
    for (int k = 0; k < quarters; k++) {
        const double y = at[0];
        at[0] = 0.0 - at[1]; /* no negative zeros */
        at[1] = y;
    }
}

/* Maps a point of the square, coordinates from -1 to 1, into a circle of radius 1. */
static void square_point(double at[2], double s, double t)
{
    at[0] = square_side * s * (1.0 + square_bulge * (1.0 - t * t));
    at[1] = square_side * t * (1.0 + square_bulge * (1.0 - s * s));
}

static void add_square(struct section *s, const struct lattice *square, int m, double radius)
{
    for (int i = 0; i <= 4 * m; i++) {
        for (int j = 0; j <= 4 * m; j++) {
            double at[2];
            square_point(at, (double)(i - 2 * m) / (2 * m), (double)(j - 2 * m) / (2 * m));
            *lattice_at(square, i, j) = add_node(s, i, j, radius * at[0], radius * at[1]);
        }
    }
    add_quads(s, square, 2 * m, 2 * m, 0);
}

/* Node on the square's outline; j counts around from the corner at -45 degrees. */
static int outline(const struct lattice *square, int m, int j)
{
    const int most = 4 * m, k = j % most;
    switch (j / most) {
    case 0:
        return *lattice_at(square, most, k);
    case 1:
        return *lattice_at(square, most - k, most);
    case 2:
        return *lattice_at(square, 0, most - k);
    default:
        return *lattice_at(square, k, 0);
    }
}

struct ring {
    int part, m;
    double inner, outer; /* radii; inner 0: starts at the outline of the square */
};

static void ring_point(double at[2], const struct ring *ring, int i, int j)
{
    const int m = ring->m, side = j / (4 * m);
    const double t = (double)(j % (4 * m) - 2 * m) / (2 * m); /* -1 to 1 along a side */
    const double w = (double)i / (2 * m);
    double from[2] = {ring->inner * cos(0.25 * M_PI * t), ring->inner * sin(0.25 * M_PI * t)};
    if (ring->inner == 0.0) {
        square_point(from, 1.0, t);
        from[0] *= ring->outer;
        from[1] *= ring->outer;
    }
    at[0] = (1.0 - w) * from[0] + w * ring->outer * cos(0.25 * M_PI * t);
    at[1] = (1.0 - w) * from[1] + w * ring->outer * sin(0.25 * M_PI * t);
    turn(at, side);
}

/* If rings share nodes, row i = 0 of the lattice is already filled; otherwise it is -1. */
static void add_ring(struct section *s, const struct lattice *lattice, const struct ring *ring)
{
    for (int i = 0; i <= 2 * ring->m; i++) {
        for (int j = 0; j < 16 * ring->m; j++) {
            double at[2];
            if (i == 0 && *lattice_at(lattice, 0, j) >= 0)
                continue;
            ring_point(at, ring, i, j);
            *lattice_at(lattice, i, j) = add_node(s, i, j, at[0], at[1]);
        }
    }
    add_quads(s, lattice, ring->m, 8 * ring->m, ring->part);
}

static void add_edges(struct section *s, const struct lattice *inner, const struct lattice *outer)
{
    for (int j = 0; j < inner->nj; j += 2) {
        static const int step[3] = {0, 2, 1};
        for (int k = 0; k < 3; k++) {
            s->edge[s->n_edges][0][k] = *lattice_at(inner, inner->ni - 1, j + step[k]);
            s->edge[s->n_edges][1][k] = *lattice_at(outer, 0, j + step[k]);
        }
        s->n_edges++;
    }
}

static void fill_wire_section(struct section *s, const struct wb_solid_mesh_wire *wire,
                              const struct lattice *square, const struct lattice ring[PARTS])
{
    const int m = wire->section_density;

    add_square(s, square, m, 0.5 * wire->outer_diameter[0]);
    for (int p = 0; p < wire->n_parts; p++) {
        const struct ring around = {
            .part = p,
            .m = m,
            .inner = p > 0 ? 0.5 * wire->outer_diameter[p - 1] : 0.0,
            .outer = 0.5 * wire->outer_diameter[p],
        };
        for (int j = 0; j < 16 * m; j++) {
            const int inside = p > 0 ? *lattice_at(&ring[p - 1], 2 * m, j) : outline(square, m, j);
            *lattice_at(&ring[p], 0, j) = p > 0 && wire->split ? -1 : inside;
        }
        add_ring(s, &ring[p], &around);
        if (p > 0 && wire->split)
            add_edges(s, &ring[p - 1], &ring[p]);
    }
}

static void wire_section(struct section *s, const struct wb_solid_mesh_wire *wire)
{
    const int m = wire->section_density;
    struct lattice square = {0}, ring[PARTS] = {{0}};
    const int nodes = 12 * m * m + 8 * m + 1 + wire->n_parts * (24 * m * m + 16 * m);

    section_init(s, nodes, 4 * m * m + wire->n_parts * 8 * m * m, 8 * m);
    lattice_init(&square, 4 * m + 1, 4 * m + 1);
    for (int p = 0; p < wire->n_parts; p++)
        lattice_init(&ring[p], 2 * m + 1, 16 * m);
    fill_wire_section(s, wire, &square, ring);
    free(square.id);
    for (int p = 0; p < PARTS; p++)
        free(ring[p].id);
}

/* Node numbers in the sweep: node i of section l, and halfway between sections l - 1 and l. */
static int section_node(const struct section *s, int l, int i)
{
    return l * (s->n + s->n_corners) + i;
}

static int halfway_node(const struct section *s, int l, int i)
{
    return s->n + (l - 1) * (s->n + s->n_corners) + s->halfway[i];
}

static void fill_elements(struct wb_solid_mesh *mesh, const struct section *s, int slices)
{
    for (int l = 0; l < slices; l++) {
        for (int q = 0; q < s->n_quads; q++) {
            const int e = l * s->n_quads + q;
            const int *quad = s->quad[q];
            for (int k = 0; k < 4; k++) {
                mesh->element[e][k] = section_node(s, l, quad[k]);
                mesh->element[e][4 + k] = section_node(s, l + 1, quad[k]);
                mesh->element[e][8 + k] = section_node(s, l, quad[4 + k]);
                mesh->element[e][12 + k] = section_node(s, l + 1, quad[4 + k]);
                mesh->element[e][16 + k] = halfway_node(s, l + 1, quad[k]);
            }
            mesh->part[e] = s->part[q];
        }
    }
}

static void side_face(int face[WB_SOLID_MESH_FACE], const struct section *s, int l,
                      const int edge[3])
{
    face[0] = section_node(s, l, edge[0]);
    face[1] = section_node(s, l, edge[1]);
    face[2] = section_node(s, l + 1, edge[1]);
    face[3] = section_node(s, l + 1, edge[0]);
    face[4] = section_node(s, l, edge[2]);
    face[5] = halfway_node(s, l + 1, edge[1]);
    face[6] = section_node(s, l + 1, edge[2]);
    face[7] = halfway_node(s, l + 1, edge[0]);
}

static void fill_nodes(struct wb_solid_mesh *mesh, const struct section *s, int slices,
                       double length)
{
    for (int l = 0; l <= slices; l++) {
        for (int i = 0; i < s->n; i++) {
            double *node = mesh->node[section_node(s, l, i)];
            node[0] = (double)l / slices * length;
            memcpy(node + 1, s->at[i], sizeof s->at[i]);
            if (l == 0 || s->halfway[i] < 0)
                continue;
            node = mesh->node[halfway_node(s, l, i)];
            node[0] = (2 * l - 1) / (2.0 * slices) * length;
            memcpy(node + 1, s->at[i], sizeof s->at[i]);
        }
    }
}

static enum wb_status sweep(struct wb_solid_mesh *mesh, const struct section *s, int slices,
                            double length)
{
    const long long nodes = s->n + (long long)slices * (s->n + s->n_corners);
    const long long elements = (long long)slices * s->n_quads;
    if (nodes > INT_MAX)
        return wb_fail(WB_ERR_ARGUMENT,
                       "the mesh of %lld elements has too many nodes: expected at most %d",
                       elements, INT_MAX);

    struct wb_solid_mesh made;
    WB_TRY(wb_solid_mesh_init(&made, (int)nodes, (int)elements));
    made.n_layers = slices + 1;
    made.layer = wb_memory_take(&made.memory, (size_t)slices + 2, sizeof *made.layer);
    made.link = wb_memory_take(&made.memory, (size_t)slices + 1, sizeof *made.link);
    made.n_pairs = slices * s->n_edges;
    made.pair = s->n_edges > 0
                    ? wb_memory_take(&made.memory, (size_t)made.n_pairs, sizeof *made.pair)
                    : NULL;

    fill_elements(&made, s, slices);
    for (int l = 0; l <= slices; l++) {
        made.link[l] = section_node(s, l, 0);
        made.layer[l + 1] = section_node(s, l, s->n);
    }
    for (int i = 0; i < made.n_pairs; i++) {
        const int l = i / s->n_edges, k = i % s->n_edges;
        side_face(made.pair[i].inner, s, l, s->edge[k][0]);
        side_face(made.pair[i].outer, s, l, s->edge[k][1]);
    }
    fill_nodes(&made, s, slices, length);
    *mesh = made;
    return WB_OK;
}

/* Marks clamp, tip faces and axis of a swept wire; `centre` is the axis' node in the section. */
static void mark_wire(struct wb_solid_mesh *mesh, const struct section *s, int slices, int centre)
{
    mesh->clamp = wb_memory_take(&mesh->memory, (size_t)s->n, sizeof *mesh->clamp);
    mesh->tip_face = wb_memory_take(&mesh->memory, (size_t)s->n_quads, sizeof *mesh->tip_face);
    mesh->axis = wb_memory_take(&mesh->memory, 2 * (size_t)slices + 1, sizeof *mesh->axis);

    mesh->n_clamp = s->n;
    for (int i = 0; i < s->n; i++)
        mesh->clamp[i] = section_node(s, 0, i);
    mesh->n_tip_faces = s->n_quads;
    for (int q = 0; q < s->n_quads; q++) {
        mesh->tip_face[q].element = (slices - 1) * s->n_quads + q;
        for (int k = 0; k < WB_SOLID_MESH_FACE; k++)
            mesh->tip_face[q].node[k] = section_node(s, slices, s->quad[q][k]);
    }
    mesh->n_axis = 2 * slices + 1;
    for (int l = 0; l <= slices; l++) {
        mesh->axis[2 * l] = section_node(s, l, centre);
        if (l > 0)
            mesh->axis[2 * l - 1] = halfway_node(s, l, centre);
    }
}

static enum wb_status check_wire(const struct wb_solid_mesh_wire *wire)
{
    if (!(wire->length > 0.0) || !isfinite(wire->length))
        return wb_fail(WB_ERR_ARGUMENT, "the wire is %g m long: expected a number above 0",
                       wire->length);
    if (wire->n_parts < 1 || wire->n_parts > PARTS)
        return wb_fail(WB_ERR_ARGUMENT, "the wire has %d parts: expected 1 or %d", wire->n_parts,
                       PARTS);
    for (int p = 0; p < wire->n_parts; p++) {
        const double inside = p > 0 ? wire->outer_diameter[p - 1] : 0.0;
        if (!(wire->outer_diameter[p] > inside) || !isfinite(wire->outer_diameter[p]))
            return wb_fail(WB_ERR_ARGUMENT,
                           "part %d has a diameter of %g m: expected more than the %g m inside it",
                           p, wire->outer_diameter[p], inside);
    }
    if (wire->elements_along < 1 || wire->elements_along > MAX_ALONG)
        return wb_fail(WB_ERR_ARGUMENT, "the mesh has %d elements along the wire: expected 1 to %d",
                       wire->elements_along, MAX_ALONG);
    if (wire->section_density < 1 || wire->section_density > MAX_DENSITY)
        return wb_fail(WB_ERR_ARGUMENT, "the section's density is %d: expected 1 to %d",
                       wire->section_density, MAX_DENSITY);
    return WB_OK;
}

enum wb_status wb_solid_mesh_sweep(struct wb_solid_mesh *mesh,
                                   const struct wb_solid_mesh_wire *wire)
{
    struct section section;
    struct wb_solid_mesh made;
    WB_TRY(check_wire(wire));
    wire_section(&section, wire);

    const enum wb_status status = sweep(&made, &section, wire->elements_along, wire->length);
    if (status == WB_OK) {
        made.n_parts = wire->n_parts;
        int centre = 0;
        while (section.at[centre][0] != 0.0 || section.at[centre][1] != 0.0)
            centre++;
        mark_wire(&made, &section, wire->elements_along, centre);
        *mesh = made;
    }
    wb_memory_release(&section.memory);
    return status;
}
