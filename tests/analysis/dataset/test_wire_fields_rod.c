/* Fields of a computed 1D wire: what they carry is in equilibrium with the load. */
#include "tests/check.h"

#include "analysis/dataset/wire_fields.h"
#include "base/file.h"

enum {
    SLICES = 20
};

static const double load = 12.0; /* N, follower */

static struct wb_wire_model model;
static struct wb_wire1d *rod;
static struct wb_wire_run run;
static struct wb_fields fields;

static int make(void **state)
{
    (void)state;
    char path[WB_PATH];
    if (wb_file_find_fixture(path, "models", "follower-8awg", NULL) != WB_OK ||
        wb_wire_model_read(&model, path) != WB_OK)
        return -1;
    model.step[0].loads.follower[1] = load;
    model.step[0].rows = 4;
    if (wb_wire_run_init(&run, &model, 2) != WB_OK || wb_wire1d_create(&rod, &model, NULL) != WB_OK)
        return -1;
    if (wb_wire1d_run(rod, &run, NULL) != WB_OK || !run.converged)
        return -1;
    return wb_wire_fields_rod(&fields, &model, "loaded", rod, SLICES) == WB_OK ? 0 : -1;
}

static int release(void **state)
{
    (void)state;
    wb_fields_release(&fields);
    wb_wire1d_destroy(rod);
    wb_wire_run_release(&run);
    return 0;
}

/* Area and centre of a cell of a ring from its corners. */
static double cell_area(const struct wb_field_face *face, double centre[2])
{
    const double *const a = face->node[0].reference, *const b = face->node[1].reference;
    const double *const c = face->node[2].reference;
    const double inner = hypot(a[1], a[2]), outer = hypot(b[1], b[2]);
    const double angle = fabs(remainder(atan2(c[2], c[1]) - atan2(b[2], b[1]), 2.0 * M_PI));
    const double area = 0.5 * angle * (outer * outer - inner * inner);
    /* The centroid of a ring's sector. */
    const double r = 2.0 / 3.0 * (pow(outer, 3.0) - pow(inner, 3.0)) /
                     (outer * outer - inner * inner) * sin(0.5 * angle) / (0.5 * angle);
    const double *const middle = face->node[5].reference;
    const double size = hypot(middle[1], middle[2]);
    centre[0] = r * middle[1] / size;
    centre[1] = r * middle[2] / size;
    return area;
}

static void cells_fill_the_section_and_carry_the_moment(void **state)
{
    (void)state;
    assert_int_equal(fields.n, 3);
    for (int i = 1; i < 3; i++) {
        const struct wb_field *const cross = &fields.items[i];
        double area = 0.0, jacket = 0.0, force = 0.0, moment = 0.0, sideways = 0.0;
        assert_close(cross->x, model.section[i - 1], 0.0);
        for (int f = 0; f < cross->n_faces; f++) {
            double centre[2];
            const double dA = cell_area(&cross->faces[f], centre);
            const double stress = cross->faces[f].node[0].axial;
            area += dA;
            jacket += cross->faces[f].part == 1 ? dA : 0.0;
            force += stress * dA;
            moment -= stress * dA * centre[0];
            sideways += stress * dA * centre[1];
        }
        assert_close_relative(area, M_PI / 4.0 * 4.86e-3 * 4.86e-3, 1e-9);
        assert_close_relative(jacket, M_PI / 4.0 * (4.86e-3 * 4.86e-3 - 3.26e-3 * 3.26e-3), 1e-9);

        /* Tip force times lever, of the deformed wire. */
        double at[3], tip[3], frame[3][3], tip_frame[3][3];
        wb_wire1d_frame(rod, cross->x, at, frame);
        wb_wire1d_frame(rod, model.length, tip, tip_frame);
        const double *const n = tip_frame[1];
        const double expected = load * ((tip[0] - at[0]) * n[1] - (tip[1] - at[1]) * n[0]);
        const double along = load * (n[0] * frame[0][0] + n[1] * frame[0][1]);
        assert_close_relative(moment, expected, 0.02);
        assert_close(force, along, 0.02 * load);
        assert_close(sideways, 0.0, 1e-9 * expected);
    }
}

static void longitudinal_section_lies_in_the_plane(void **state)
{
    (void)state;
    const struct wb_field *const field = &fields.items[0];
    double area[2] = {0}, highest = 0.0;
    assert_true(isnan(field->x));
    for (int f = 0; f < field->n_faces; f++) {
        const struct wb_field_node *const node = field->faces[f].node;
        area[field->faces[f].part] += fabs((node[1].reference[0] - node[0].reference[0]) *
                                           (node[3].reference[1] - node[0].reference[1]));
        for (int k = 0; k < 8; k++) {
            double at[3], frame[3][3];
            assert_close(node[k].reference[2], 0.0, 0.0);
            assert_close(node[k].position[2], 0.0, 1e-12);
            wb_wire1d_frame(rod, node[k].reference[0], at, frame);
            for (int i = 0; i < 3; i++)
                assert_close(node[k].position[i], at[i] + node[k].reference[1] * frame[1][i],
                             1e-12);
            highest = fmax(highest, node[k].reference[1]);
        }
        /* Bent upwards: compression above. */
        if (node[5].reference[0] < 0.5 * model.length && fabs(node[5].reference[1]) > 1e-3)
            assert_true(node[5].axial * node[5].reference[1] < 0.0);
    }
    assert_close_relative(area[0], model.length * 3.26e-3, 1e-9);
    assert_close_relative(area[1], model.length * (4.86e-3 - 3.26e-3), 1e-9);
    assert_close_relative(highest, 2.43e-3, 1e-9);
}

static void core_yields_beside_the_clamp(void **state)
{
    (void)state;
    const struct wb_field *const cross = &fields.items[1];
    double stress = 0.0, plastic = 0.0;
    for (int f = 0; f < cross->n_faces; f++) {
        if (cross->faces[f].part != 0)
            continue;
        stress = fmax(stress, cross->faces[f].node[0].von_mises);
        plastic = fmax(plastic, cross->faces[f].node[0].plastic);
    }
    assert_true(plastic > 1e-4);
    assert_close_relative(stress, 182e6 + 292e6 * pow(plastic, 0.31), 1e-6);
}

/* G r theta' of the elastic composite, theta' = T / sum G J. */
static void torsion_counts_in_the_von_mises_stress(void **state)
{
    (void)state;
    static const double T = 0.05;
    char path[WB_PATH];
    struct wb_wire_model twisted;
    struct wb_wire1d *wire;
    struct wb_wire_run twisting;
    struct wb_fields kept = {0};
    assert_int_equal(wb_file_find_fixture(path, "models", "follower-8awg-elastic", NULL), WB_OK);
    assert_int_equal(wb_wire_model_read(&twisted, path), WB_OK);
    twisted.step[0].loads = (struct wb_tip_loads){.moment = {T, 0.0, 0.0}};
    assert_int_equal(wb_wire_run_init(&twisting, &twisted, 0), WB_OK);
    assert_int_equal(wb_wire1d_create(&wire, &twisted, NULL), WB_OK);
    assert_int_equal(wb_wire1d_run(wire, &twisting, NULL), WB_OK);
    assert_int_equal(wb_wire_fields_rod(&kept, &twisted, "twisted", wire, 2), WB_OK);

    double G[2], rigidity = 0.0;
    for (int i = 0; i < 2; i++) {
        const struct wb_wire_model_part *const part = &twisted.part[i];
        G[i] = 0.5 * part->material.youngs_modulus / (1.0 + part->material.poissons_ratio);
        rigidity +=
            G[i] * M_PI / 32.0 * (pow(part->outer_diameter, 4.0) - pow(part->inner_diameter, 4.0));
    }
    const struct wb_field *const cross = wb_fields_find(&kept, "twisted", 50e-3);
    for (int f = 0; f < cross->n_faces; f++) {
        const struct wb_field_face *const face = &cross->faces[f];
        const double inner = hypot(face->node[0].reference[1], face->node[0].reference[2]);
        const double outer = hypot(face->node[1].reference[1], face->node[1].reference[2]);
        const double per_radius = sqrt(3.0) * G[face->part] * T / rigidity;
        assert_in_range((long)face->node[0].von_mises, (long)(per_radius * inner),
                        (long)(per_radius * outer) + 1);
        assert_close(face->node[0].axial, 0.0, 1e-3 * face->node[0].von_mises);
    }
    wb_fields_release(&kept);
    wb_wire1d_destroy(wire);
    wb_wire_run_release(&twisting);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cells_fill_the_section_and_carry_the_moment),
        cmocka_unit_test(longitudinal_section_lies_in_the_plane),
        cmocka_unit_test(core_yields_beside_the_clamp),
        cmocka_unit_test(torsion_counts_in_the_von_mises_stress),
    };
    return cmocka_run_group_tests(tests, make, release);
}
