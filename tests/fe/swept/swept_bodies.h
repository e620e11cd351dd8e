/* Wires of swept hexahedra for tests: sections, positions and forces. */
#ifndef WB_TESTS_FE_SWEPT_SWEPT_BODIES_H
#define WB_TESTS_FE_SWEPT_SWEPT_BODIES_H

#include <stdlib.h>
#include <string.h>

#include "fe/swept/swept_hex.h"
#include "fe/swept/swept_private.h"
#include "tests/fe/rod/wires.h"

struct swept_body {
    struct wb_swept_hex *hex;
    struct wb_swept_hex_state *state;
    struct wb_swept_layout layout;
    double *position;
    void *force;
};

static inline double *swept_field(const struct wb_swept_layout *layout)
{
    return wb_swept_allocate(wb_swept_size(layout), sizeof(double));
}

static inline size_t swept_at(const struct wb_swept_layout *layout, int node, int component,
                              int station)
{
    return (size_t)(3 * node + component) * (size_t)layout->stride + (size_t)station;
}

/* Sets the positions of the undeformed wire. */
static inline void swept_reference(struct swept_body *body)
{
    const struct wb_swept_hex_model *m = wb_swept_hex_get_model(body->hex);
    for (int k = 0; k < m->section->n_nodes; k++) {
        for (int j = 0; j <= m->n_elements; j++) {
            body->position[swept_at(&body->layout, k, 0, j)] = j * m->element_length;
            body->position[swept_at(&body->layout, k, 1, j)] = m->section->node[k][0];
            body->position[swept_at(&body->layout, k, 2, j)] = m->section->node[k][1];
        }
    }
}

static inline struct swept_body swept_body_create(const struct wb_swept_hex_model *model)
{
    struct swept_body body = {0};
    assert_int_equal(wb_swept_hex_create(&body.hex, model), WB_OK);
    body.state = wb_swept_hex_state_create(body.hex);
    body.layout = wb_swept_hex_layout(body.hex);
    body.position = swept_field(&body.layout);
    body.force = swept_field(&body.layout);
    swept_reference(&body);
    return body;
}

static inline void swept_body_destroy(struct swept_body *body)
{
    wb_swept_hex_state_destroy(body->state);
    wb_swept_hex_destroy(body->hex);
    free(body->position);
    free(body->force);
}

/* Computes the forces of blocks `first` to `end` - 1, without other forces. */
static inline void swept_find_forces(struct swept_body *body, int first, int end,
                                     struct wb_swept_hex_sums *sums)
{
    const struct wb_swept_hex_fields fields = {.position = body->position, .force = body->force};
    if (first == 0)
        memset(body->force, 0, wb_swept_size(&body->layout) * sizeof(double));
    wb_swept_hex_add_forces(body->state, &fields, first, end, sums);
}

static inline struct wb_swept_hex_sums swept_forces(struct swept_body *body)
{
    struct wb_swept_hex_sums sums = {0};
    swept_find_forces(body, 0, wb_swept_hex_blocks(body->hex), &sums);
    return sums;
}

static inline double swept_force(const struct swept_body *body, int node, int component,
                                 int station)
{
    const size_t at = swept_at(&body->layout, node, component, station);
    return wb_swept_hex_get_model(body->hex)->double_precision ? ((const double *)body->force)[at]
                                                               : (double)((float *)body->force)[at];
}

/* Sets the positions x = c + F X, where X are those of the undeformed wire. */
static inline void swept_set_linear(struct swept_body *body, double F[3][3], const double c[3])
{
    const struct wb_swept_hex_model *m = wb_swept_hex_get_model(body->hex);
    for (int k = 0; k < m->section->n_nodes; k++) {
        for (int j = 0; j <= m->n_elements; j++) {
            const double X[3] = {j * m->element_length, m->section->node[k][0],
                                 m->section->node[k][1]};
            for (int i = 0; i < 3; i++)
                body->position[swept_at(&body->layout, k, i, j)] =
                    c[i] + F[i][0] * X[0] + F[i][1] * X[1] + F[i][2] * X[2];
        }
    }
}

/* Rotation matrix about the axis (1, 2, 3); `angle` in rad. */
static inline void swept_rotation(double angle, double R[3][3])
{
    const double n[3] = {1 / sqrt(14.0), 2 / sqrt(14.0), 3 / sqrt(14.0)}, c = cos(angle);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            R[i][j] = (i == j ? c : 0.0) + (1 - c) * n[i] * n[j];
        R[i][(i + 1) % 3] -= sin(angle) * n[(i + 2) % 3];
        R[i][(i + 2) % 3] += sin(angle) * n[(i + 1) % 3];
    }
}

static inline bool swept_is_convex(const struct wb_swept_section *section, const int *quad)
{
    for (int a = 0; a < 4; a++) {
        const double *p = section->node[quad[a]], *next = section->node[quad[(a + 1) % 4]];
        const double *before = section->node[quad[(a + 3) % 4]];
        const double turn = (next[0] - p[0]) * (before[1] - p[1]) - //
                            (next[1] - p[1]) * (before[0] - p[0]);
        if (!(turn > 0.0 && isfinite(turn)))
            return false;
    }
    return true;
}

/* A section of any mesh. WB_ERR_ARGUMENT if a quadrilateral is not convex and counter-clockwise or
 * a node does not exist. */
static inline enum wb_status swept_section_init(struct wb_swept_section *section, int n_nodes,
                                                const double (*node)[2], int n_quads,
                                                const int (*quad)[4])
{
    const size_t nodes = (size_t)n_nodes, quads = (size_t)n_quads;
    for (int i = 0; i < 4 * n_quads; i++) {
        if (quad[i / 4][i % 4] < 0 || quad[i / 4][i % 4] >= n_nodes)
            return WB_ERR_ARGUMENT;
    }
    *section = (struct wb_swept_section){.n_nodes = n_nodes, .n_quads = n_quads};
    section->node = wb_memory_take(&section->memory, nodes, sizeof *section->node);
    section->share = wb_memory_take(&section->memory, nodes, sizeof *section->share);
    section->quad = wb_memory_take(&section->memory, quads, sizeof *section->quad);
    section->outline = wb_memory_take(&section->memory, 1, sizeof *section->outline);
    memcpy(section->node, node, nodes * sizeof *node);
    memcpy(section->quad, quad, quads * sizeof *quad);
    for (int e = 0; e < n_quads; e++) {
        if (!swept_is_convex(section, quad[e])) {
            wb_swept_section_release(section);
            return WB_ERR_ARGUMENT;
        }
    }
    wb_swept_section_integrate(section);
    return WB_OK;
}

/* A section of about the given size (m), meshed with four distorted quadrilaterals. */
static inline struct wb_swept_section swept_distorted_section(double size)
{
    static const double at[9][2] = {{0.0, 0.05}, {1.1, -0.1}, {2.0, 0.0}, {-0.1, 0.9}, {0.8, 1.2},
                                    {2.2, 0.8},  {0.1, 2.1},  {1.2, 1.9}, {1.9, 2.0}};
    static const int quad[4][4] = {{0, 1, 4, 3}, {1, 2, 5, 4}, {3, 4, 7, 6}, {4, 5, 8, 7}};
    struct wb_swept_section section;
    assert_int_equal(swept_section_init(&section, 9, at, 4, quad), WB_OK);
    wb_swept_section_scale(&section, size / 2.0);
    return section;
}

static inline struct wb_swept_section swept_circle(double diameter, int core, int rings)
{
    struct wb_swept_section section;
    assert_int_equal(wb_swept_section_init_circle(&section, diameter, core, rings), WB_OK);
    return section;
}

#endif
