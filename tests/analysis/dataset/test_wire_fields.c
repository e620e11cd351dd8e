/* Fields of a computed wire on its sections, from meshes and stresses that are made up. */
#include "tests/check.h"

#include <stdlib.h>

#include "analysis/dataset/wire_fields.h"

enum {
    ALONG = 12
};

static const double length = 0.1, radius = 0.05; /* m; of the wire, of the circle it is bent to */

static struct wb_wire_model model;
static struct wb_solid_mesh mesh;
static struct wb_wire3d_fields solid;

/* In the wire's own frame: stress along it, across it, and shear between. */
struct own_stress {
    double along, across, shear;
};

static struct own_stress stress_at(int kind, const double *X)
{
    const double value = 1e8 * (1.0 + X[0] / length + X[1] / 1e-3);
    switch (kind) {
    case 0:
        return (struct own_stress){.along = value};
    case 1:
        return (struct own_stress){.shear = value};
    default:
        return (struct own_stress){.along = value, .across = -2.0 * value, .shear = 0.5 * value};
    }
}

/* Bends the wire to a circle in the plane of x and y, turned about x by `turn`. */
static void bend(int kind, double turn)
{
    const double up[3] = {0.0, cos(turn), sin(turn)};
    for (int a = 0; a < mesh.n_nodes; a++) {
        const double *const X = mesh.node[a];
        const double y = X[1] * up[1] + X[2] * up[2], z = -X[1] * up[2] + X[2] * up[1];
        const double angle = X[0] / radius;
        const double rise = radius - (radius - y) * cos(angle);
        solid.position[a][0] = (radius - y) * sin(angle);
        solid.position[a][1] = rise * up[1] - z * up[2];
        solid.position[a][2] = rise * up[2] + z * up[1];
    }
    for (int e = 0; e < mesh.n_elements; e++) {
        for (int k = 0; k < WB_SOLID_MESH_NODES; k++) {
            const double *const X = mesh.node[mesh.element[e][k]];
            const double c = cos(X[0] / radius), s = sin(X[0] / radius);
            const double t[3] = {c, s * up[1], s * up[2]}, n[3] = {-s, c * up[1], c * up[2]};
            const struct own_stress own = stress_at(kind, X);
            static const int pairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}};
            for (int i = 0; i < 6; i++) {
                const int p = pairs[i][0], q = pairs[i][1];
                solid.stress[e][k][i] = own.along * t[p] * t[q] + own.across * n[p] * n[q] +
                                        own.shear * (t[p] * n[q] + n[p] * t[q]);
            }
            solid.plastic[e][k] = mesh.part[e] == 0 ? 0.25 : -1e-12;
        }
    }
}

static int make(void **state)
{
    (void)state;
    const struct wb_solid_mesh_wire wire = {
        .length = length,
        .n_parts = 2,
        .outer_diameter = {3.26e-3, 4.86e-3},
        .elements_along = ALONG,
        .section_density = 1,
    };
    if (wb_solid_mesh_sweep(&mesh, &wire) != WB_OK)
        return -1;
    solid.position = calloc((size_t)mesh.n_nodes, sizeof *solid.position);
    solid.stress = calloc((size_t)mesh.n_elements, sizeof *solid.stress);
    solid.plastic = calloc((size_t)mesh.n_elements, sizeof *solid.plastic);
    model = (struct wb_wire_model){.length = length, .n_parts = 2, .n_sections = 2};
    model.section[0] = 26e-3;
    model.section[1] = 50e-3;
    return solid.position && solid.stress && solid.plastic ? 0 : -1;
}

static int release(void **state)
{
    (void)state;
    free(solid.position);
    free(solid.stress);
    free(solid.plastic);
    wb_solid_mesh_release(&mesh);
    return 0;
}

static void take(struct wb_fields *fields, int kind, double turn)
{
    *fields = (struct wb_fields){0};
    bend(kind, turn);
    assert_int_equal(wb_wire_fields_solid(fields, &model, "loaded", &mesh, &solid), WB_OK);
}

static void sections_are_where_the_mesh_has_them(void **state)
{
    (void)state;
    struct wb_fields fields;
    take(&fields, 0, 0.0);
    assert_int_equal(fields.n, 3);
    assert_true(isnan(fields.items[0].x));
    assert_int_equal(fields.items[0].n_faces, 6 * ALONG);
    assert_close(fields.items[1].x, 25e-3, 1e-12);
    assert_close(fields.items[2].x, 50e-3, 1e-12);
    for (int i = 1; i < 3; i++) {
        const struct wb_field *const cross = &fields.items[i];
        int jacket = 0;
        assert_int_equal(cross->n_faces, 20);
        for (int f = 0; f < 20; f++) {
            jacket += cross->faces[f].part == 1;
            for (int k = 0; k < 8; k++)
                assert_close(cross->faces[f].node[k].reference[0], cross->x, 1e-12);
        }
        assert_int_equal(jacket, 8);
    }
    for (int f = 0; f < fields.items[0].n_faces; f++)
        for (int k = 0; k < 8; k++)
            assert_close(fields.items[0].faces[f].node[k].reference[2], 0.0, 1e-12);
    wb_fields_release(&fields);
}

static void two_sections_in_one_plane_are_one(void **state)
{
    (void)state;
    struct wb_fields fields;
    model.section[0] = 24.9e-3;
    model.section[1] = 25.1e-3;
    take(&fields, 0, 0.0);
    model.section[0] = 26e-3;
    model.section[1] = 50e-3;
    assert_int_equal(fields.n, 2);
    /* Another state has its own. */
    assert_int_equal(wb_wire_fields_solid(&fields, &model, "unloaded", &mesh, &solid), WB_OK);
    assert_int_equal(fields.n, 5);
    wb_fields_release(&fields);
}

static void axial_stress_is_along_the_bent_wire(void **state)
{
    (void)state;
    for (int kind = 0; kind < 3; kind++) {
        struct wb_fields fields;
        take(&fields, kind, 0.7);
        for (int i = 0; i < fields.n; i++) {
            const struct wb_field *const field = &fields.items[i];
            for (int f = 0; f < field->n_faces; f++) {
                for (int k = 0; k < 8; k++) {
                    const struct wb_field_node *const node = &field->faces[f].node[k];
                    const struct own_stress own = stress_at(kind, node->reference);
                    /* At the ends the slope is one-sided: second order in the element's length. */
                    const bool at_end =
                        node->reference[0] < 1e-9 || node->reference[0] > length - 1e-9;
                    assert_close(node->axial, own.along, at_end ? 5e6 : 1.0);
                }
            }
        }
        wb_fields_release(&fields);
    }
}

static void von_mises_stress_is_that_of_tension_and_of_shear(void **state)
{
    (void)state;
    for (int kind = 0; kind < 3; kind++) {
        struct wb_fields fields;
        take(&fields, kind, 0.7);
        const struct wb_field *const field = &fields.items[0];
        for (int f = 0; f < field->n_faces; f++) {
            for (int k = 0; k < 8; k++) {
                const struct wb_field_node *const node = &field->faces[f].node[k];
                const struct own_stress s = stress_at(kind, node->reference);
                const double expected = sqrt(s.along * s.along - s.along * s.across +
                                             s.across * s.across + 3.0 * s.shear * s.shear);
                assert_close(node->von_mises, expected, 1.0);
                assert_close(node->plastic, field->faces[f].part == 0 ? 0.25 : 0.0, 0.0);
            }
        }
        wb_fields_release(&fields);
    }
}

static void positions_are_the_deformed_ones(void **state)
{
    (void)state;
    struct wb_fields fields;
    take(&fields, 0, 0.0);
    for (int i = 0; i < fields.n; i++) {
        for (int f = 0; f < fields.items[i].n_faces; f++) {
            const struct wb_field_node *const node = &fields.items[i].faces[f].node[3];
            const double r = radius - node->reference[1], angle = node->reference[0] / radius;
            assert_close(node->position[0], r * sin(angle), 1e-15);
            assert_close(node->position[1], radius - r * cos(angle), 1e-15);
            assert_close(node->position[2], node->reference[2], 1e-15);
        }
    }
    wb_fields_release(&fields);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sections_are_where_the_mesh_has_them),
        cmocka_unit_test(two_sections_in_one_plane_are_one),
        cmocka_unit_test(axial_stress_is_along_the_bent_wire),
        cmocka_unit_test(von_mises_stress_is_that_of_tension_and_of_shear),
        cmocka_unit_test(positions_are_the_deformed_ones),
    };
    return cmocka_run_group_tests(tests, make, release);
}
