/* Queried stresses of tapes compared with closed forms, the flow stress and the energy. */
#include "fe/swept/swept_private.h"
#include "fe/swept/swept_tape.h"

#include "tests/fe/swept/tapes.h"

enum {
    NODES = 5,
    STATIONS = 20 /* more than a block */
};

static struct test_tape sheet(const struct wb_material *material, bool is_double)
{
    struct wb_swept_tape_model model = tape_model(material, NODES, STATIONS, false, 1e-3);
    make_sheet(&model, 19e-3, 4e-3, 0.2);
    model.double_precision = is_double;
    return test_tape_create(&model);
}

/* Stretches the reference state along x and y, and rotates it. */
static void stretch(struct test_tape *t, double along, double across, double angle)
{
    const double by[3] = {exp(along), exp(across), 1.0};
    double R[3][3];
    swept_rotation(angle, R);
    for (int k = 0; k < NODES; k++) {
        for (int j = 0; j < STATIONS; j++) {
            double x[3], d[3];
            tape_get(&t->layout, t->model.position, k, j, x);
            tape_get(&t->layout, wb_swept_tape_directors(t->tape), k, j, d);
            for (int i = 0; i < 3; i++) {
                const size_t at = swept_at(&t->layout, k, i, j);
                t->position[at] = R[i][0] * by[0] * x[0] + R[i][1] * by[1] * x[1] + R[i][2] * x[2];
                t->director[at] = R[i][0] * d[0] + R[i][1] * d[1] + R[i][2] * d[2];
            }
        }
    }
}

static void a_stretched_sheet_has_stress_along_only(void **unused)
{
    (void)unused;
    for (int is_double = 0; is_double < 2; is_double++) {
        struct test_tape t = sheet(&elastic_tape, is_double);
        struct wb_swept_tape_stress out[WB_SWEPT_TAPE_STRESS_MOST];
        const double strain = 0.01, expected = 119e6 * strain;
        stretch(&t, strain, -0.3 * strain, 0.8);
        assert_int_equal(wb_swept_tape_stress_points(t.tape), 3);
        for (int k = 0; k < NODES - 1; k++) {
            for (int j = 0; j < STATIONS - 1; j++) {
                wb_swept_tape_stress_find(t.tape, t.state, t.position, t.director, k, j, out);
                for (int q = 0; q < 3; q++) {
                    const double *s = out[q].stress;
                    assert_close_relative(s[0] + s[1], expected, 1e-4);
                    /* The only stress component: zero determinant in any frame. */
                    assert_close(s[0] * s[1] - s[2] * s[2], 0.0, 1e-4 * expected * expected);
                    assert_close_relative(wb_swept_tape_stress_von_mises(s), expected, 1e-4);
                    assert_close(out[q].plastic, 0.0, 0.0);
                }
            }
        }
        test_tape_destroy(&t);
    }
}

static void a_yielding_sheet_has_the_flow_stress_and_the_kernels_energy(void **unused)
{
    (void)unused;
    struct test_tape t = sheet(&tape_law, true);
    struct wb_swept_tape_stress out[WB_SWEPT_TAPE_STRESS_MOST];
    struct wb_swept_tape_sums sums = {0};
    double stored = 0.0;
    for (int i = 1; i <= 400; i++) {
        stretch(&t, 1e-4 * i, -0.7e-4 * i, 0.8);
        sums = tape_forces(&t);
    }
    const double mu = 119e6 / 2.6, bulk = 119e6 / 0.7; /* in the plane: E / (1 - nu) */
    for (int k = 0; k < NODES - 1; k++) {
        for (int j = 0; j < STATIONS - 1; j++) {
            double density = 0.0;
            wb_swept_tape_stress_find(t.tape, t.state, t.position, t.director, k, j, out);
            for (int q = 0; q < 3; q++) {
                const double *s = out[q].stress;
                const double p = wb_swept_tape_plastic_strain(t.state, k, j, q);
                const double mean = 0.5 * (s[0] + s[1]), difference = 0.5 * (s[0] - s[1]);
                assert_true(p > 0.01);
                assert_close(out[q].plastic, p, 0.0);
                assert_close_relative(wb_swept_tape_stress_von_mises(s),
                                      2.4e6 + 16.3e6 * pow(p, 0.73), 1e-4);
                density = mean * mean / bulk + (difference * difference + s[2] * s[2]) / (2.0 * mu);
            }
            /* Corners of the sheet's elements, by the shoelace. */
            double x[4][3], area = 0.0;
            tape_get(&t.layout, t.model.position, k, j, x[0]);
            tape_get(&t.layout, t.model.position, k, j + 1, x[1]);
            tape_get(&t.layout, t.model.position, k + 1, j + 1, x[2]);
            tape_get(&t.layout, t.model.position, k + 1, j, x[3]);
            for (int a = 0; a < 4; a++)
                area += 0.5 * (x[a][0] * x[(a + 1) % 4][1] - x[(a + 1) % 4][0] * x[a][1]);
            stored += density * area * 0.2e-3;
        }
    }
    assert_close_relative(stored, sums.stored, 1e-4);
    test_tape_destroy(&t);
}

/* A flat sheet rolled up along x: E z / R / (1 - nu^2) along, nu times that across, at the Gauss
 * points. Chords are shorter than arcs by a millionth, which is 0.3 % of it. */
static void a_rolled_sheet_has_bending_stress(void **unused)
{
    (void)unused;
    struct wb_swept_tape_model model = tape_model(&elastic_tape, NODES, STATIONS, false, 1e-3);
    make_sheet(&model, 19e-3, 4e-3, 0.0);
    struct test_tape t = test_tape_create(&model);
    struct wb_swept_tape_stress out[WB_SWEPT_TAPE_STRESS_MOST];
    const double radius = 0.2;
    for (int k = 0; k < NODES; k++) {
        for (int j = 0; j < STATIONS; j++) {
            const double angle = 1e-3 * j / radius;
            tape_put(&t.layout, t.position, k, j, radius * sin(angle), 1e-3 * k,
                     radius * (cos(angle) - 1.0));
            tape_put(&t.layout, t.director, k, j, sin(angle), 0.0, cos(angle));
        }
    }
    const double z = 0.1e-3 * sqrt(0.6), expected = 119e6 * z / radius / 0.91;
    for (int j = 0; j < STATIONS - 1; j++) {
        wb_swept_tape_stress_find(t.tape, t.state, t.position, t.director, 1, j, out);
        for (int q = 0; q < 3; q++) {
            assert_close(out[q].stress[0], (q - 1) * expected, 5e-3 * expected);
            assert_close(out[q].stress[1], (q - 1) * 0.3 * expected, 5e-3 * expected);
            assert_close(out[q].stress[2], 0.0, 1e-3 * expected);
        }
    }
    test_tape_destroy(&t);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_stretched_sheet_has_stress_along_only),
        cmocka_unit_test(a_yielding_sheet_has_the_flow_stress_and_the_kernels_energy),
        cmocka_unit_test(a_rolled_sheet_has_bending_stress),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
