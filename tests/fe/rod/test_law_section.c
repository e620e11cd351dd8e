/* The section in space with a law. The references are fibres that are computed one by one along
 * their own strain, and the section in a plane. */
#include "fe/rod/law_section.h"

#include "fe/rod/ring.h"
#include "tests/fe/rod/laws.h"
#include "tests/fe/rod/points.h"

enum {
    RINGS = 3,
    AROUND = 12
};

struct point {
    struct wb_law_section *section;
    double *before, *after;
};

static struct point point_of(const struct wb_law *law, int n_rings, int n_around)
{
    struct point p = {0};
    const struct wb_law_section_model model = {
        .diameter = DIAMETER, .law = law, .fibres = {n_rings, n_around}};
    assert_int_equal(wb_law_section_create(&p.section, &model), WB_OK);
    const size_t size = wb_law_section_history_size(p.section);
    p.before = calloc(size, sizeof *p.before);
    p.after = calloc(size, sizeof *p.after);
    assert_true(p.before && p.after);
    return p;
}

static void release(struct point *p)
{
    wb_law_section_destroy(p->section);
    free(p->before);
    free(p->after);
}

static struct wb_rod_section_response respond(const struct point *p, const double strain[4])
{
    struct wb_rod_section_response r;
    wb_law_section_respond(p->section, strain, p->before, p->after, &r);
    return r;
}

static struct wb_rod_section_response accept_strain(struct point *p, const double strain[4])
{
    const struct wb_rod_section_response r = respond(p, strain);
    double *const old = p->before;
    p->before = p->after;
    p->after = old;
    return r;
}

/* The same fibres, each a section of its own in a plane that only stretches. */
static void equals_fibres_that_are_computed_one_by_one(void **unused)
{
    (void)unused;
    double point[RINGS], weight[RINGS];
    wb_ring_rule(RINGS, point, weight);
    for (int l = 0; l < TEST_LAWS; l++) {
        const struct wb_law law = test_laws_get(l);
        struct point p = point_of(&law, RINGS, AROUND);
        struct fibre_point fibres[RINGS * AROUND];
        for (int i = 0; i < RINGS * AROUND; i++)
            fibres[i] = make_point(&law, 1);
        const double A = M_PI * DIAMETER * DIAMETER / 4.0;
        uint64_t random = 7 + (uint64_t)l;
        /* First about y, then about z, then anywhere. */
        for (int step = 0; step < 40; step++) {
            const double far = step < 10 ? 0.1 * step : 1.0;
            const double ky = step < 20 ? 40.0 * far : 80.0 * (test_random(&random) - 0.5);
            const double kz = step < 10   ? 0.0
                              : step < 20 ? 4.0 * (step - 10)
                                          : 80.0 * (test_random(&random) - 0.5);
            const double strain[4] = {1e-3 * (test_random(&random) - 0.5), 3.0, ky, kz};
            const struct wb_rod_section_response r = accept_strain(&p, strain);
            double N = 0.0, My = 0.0, Mz = 0.0;
            for (int i = 0; i < RINGS * AROUND; i++) {
                const int ring = i / AROUND;
                double c, s;
                wb_ring_direction(i % AROUND, AROUND, ring % 2 == 1, &c, &s);
                const double at = 0.5 * DIAMETER * sqrt(point[ring]), y = at * c, z = at * s;
                const struct wb_fibres_response f =
                    fibre_point_respond(&fibres[i], strain[0] - y * kz + z * ky, 0.0);
                fibre_point_accept(&fibres[i]);
                const double force = f.N * weight[ring] / AROUND; /* its fibre has all of A */
                N += force;
                My += force * z;
                Mz -= force * y;
            }
            const double size = 60e6 * A;
            assert_close(r.force[0], N, 1e-11 * size);
            assert_close(r.force[2], My, 1e-11 * size * DIAMETER);
            assert_close(r.force[3], Mz, 1e-11 * size * DIAMETER);
        }
        for (int i = 0; i < RINGS * AROUND; i++)
            fibre_point_release(&fibres[i]);
        release(&p);
    }
}

/* Bent in a plane at any angle it has the moment of the section in a plane, in that plane. */
static void bends_alike_in_every_direction(void **unused)
{
    (void)unused;
    for (int l = 0; l < TEST_LAWS; l++) {
        const struct wb_law law = test_laws_get(l);
        for (int angle = 0; angle < 90; angle += 17) {
            struct point p = point_of(&law, 0, 0);
            struct fibre_point plane = make_point(&law, 400);
            const double c = cos(angle * M_PI / 180.0), s = sin(angle * M_PI / 180.0);
            double largest = 0.0, sum = 0.0;
            for (int step = 1; step <= 60; step++) {
                const double kappa = step <= 20   ? 2.0 * step
                                     : step <= 40 ? 40.0 - 4.0 * (step - 20)
                                                  : -40.0 + 3.0 * (step - 40);
                const double strain[4] = {0.0, 0.0, -s * kappa, c * kappa};
                const struct wb_rod_section_response r = accept_strain(&p, strain);
                const double M = bend(&plane, kappa);
                largest = fmax(largest, fabs(M));
                const double along = c * r.force[3] - s * r.force[2] - M;
                const double across = s * r.force[3] + c * r.force[2];
                assert_close(along, 0.0, 3e-3 * largest);
                assert_close(across, 0.0, 3e-3 * largest);
                sum += fabs(along) + fabs(across);
            }
            assert_true(sum / 60.0 <= 2e-3 * largest);
            fibre_point_release(&plane);
            release(&p);
        }
    }
}

static void tangent_is_the_derivative_of_the_forces(void **unused)
{
    (void)unused;
    for (int l = 0; l < TEST_LAWS; l++) {
        const struct wb_law law = test_laws_get(l);
        struct point p = point_of(&law, 0, 0);
        const double first[4] = {2e-4, 1.0, 20.0, -11.0}, strain[4] = {5e-4, 2.0, 24.0, 3.0};
        const struct wb_law_section_stiffness k = wb_law_section_stiffness(p.section);
        const double unit[4] = {k.axial, k.torsion, k.bending, k.bending};
        (void)accept_strain(&p, first);
        const struct wb_rod_section_response at = respond(&p, strain);
        for (int j = 0; j < 4; j++) {
            double low[4], high[4];
            const double d = j == 0 ? 1e-8 : 2e-5;
            memcpy(low, strain, sizeof low);
            memcpy(high, strain, sizeof high);
            low[j] -= d;
            high[j] += d;
            const struct wb_rod_section_response a = respond(&p, low), b = respond(&p, high);
            for (int i = 0; i < 4; i++) {
                assert_close(at.tangent[i][j], (b.force[i] - a.force[i]) / (2.0 * d),
                             2e-4 * sqrt(unit[i] * unit[j]));
                assert_true(at.tangent[i][j] == at.tangent[j][i]);
            }
        }
        release(&p);
    }
}

static void stiffness_is_that_of_a_circle(void **unused)
{
    (void)unused;
    const struct wb_law law = test_laws_get(0);
    const double E = law.material.youngs_modulus, nu = law.material.poissons_ratio;
    const double I = M_PI * pow(DIAMETER, 4.0) / 64.0;
    struct wb_law_section *section;
    struct wb_law_section_model model = {.diameter = DIAMETER, .law = &law};
    assert_int_equal(wb_law_section_create(&section, &model), WB_OK);
    struct wb_law_section_stiffness k = wb_law_section_stiffness(section);
    assert_close_relative(k.axial, E * M_PI * DIAMETER * DIAMETER / 4.0, 1e-13);
    assert_close_relative(k.bending, E * I, 1e-13);
    assert_close_relative(k.torsion, E * I / (1.0 + nu), 1e-13);
    wb_law_section_destroy(section);

    model.torsional_stiffness = 2.5e-5;
    assert_int_equal(wb_law_section_create(&section, &model), WB_OK);
    k = wb_law_section_stiffness(section);
    assert_true(k.torsion == 2.5e-5);
    wb_law_section_destroy(section);
}

/* Maxwell elements relax in space as in a plane. */
static void relaxes_as_in_a_plane(void **unused)
{
    (void)unused;
    struct wb_law law = test_laws_get(0);
    law.n_maxwell = 1;
    law.maxwell[0] = (struct wb_law_maxwell){300.0 * WB_MPA, 5.0};
    struct wb_section section;
    assert_int_equal(wb_section_init_law_in_space(&section, DIAMETER, &law, 8, 24), WB_OK);
    struct fibre_point plane = fibre_point_make(&section), space = fibre_point_make(&section);
    wb_section_release(&section);
    wb_fibres_set_duration(plane.fibres, 2.0);
    wb_fibres_set_duration(space.fibres, 2.0);
    for (int step = 1; step <= 30; step++) {
        const double kappa = step < 15 ? 3.0 * step : 45.0;
        struct wb_fibres_space_response r, turned;
        const struct wb_fibres_response reference = fibre_point_respond(&plane, 1e-4, kappa);
        wb_fibres_respond_in_space(space.fibres, 1e-4, kappa, 0.0, space.before, space.after,
                                   &turned);
        assert_close_relative(turned.M_y, reference.M, 1e-12);
        assert_close_relative(turned.Dyy, reference.D22, 1e-12);
        wb_fibres_respond_in_space(space.fibres, 1e-4, kappa, 0.0, space.before, space.after, &r);
        assert_memory_equal(&r, &turned, sizeof r);
        fibre_point_accept(&plane);
        fibre_point_accept(&space);
    }
    fibre_point_release(&plane);
    fibre_point_release(&space);
}

static void vector_instructions_do_not_change_a_bit(void **unused)
{
    (void)unused;
    for (int l = 0; l < TEST_LAWS; l++) {
        const struct wb_law law = test_laws_get(l);
        struct wb_section section;
        assert_int_equal(wb_section_init_law_in_space(&section, DIAMETER, &law, 4, 16), WB_OK);
        struct fibre_point fastest = fibre_point_make(&section),
                           portable = fibre_point_make(&section);
        wb_section_release(&section);
        wb_fibres_set_portable(portable.fibres);
        uint64_t random = 11;
        for (int step = 0; step < 60; step++) {
            const double eps = 1e-3 * (test_random(&random) - 0.5);
            const double ky = 60.0 * (test_random(&random) - 0.5);
            const double kz = 60.0 * (test_random(&random) - 0.5);
            struct wb_fibres_space_response a, b;
            wb_fibres_respond_in_space(fastest.fibres, eps, ky, kz, fastest.before, fastest.after,
                                       &a);
            wb_fibres_respond_in_space(portable.fibres, eps, ky, kz, portable.before,
                                       portable.after, &b);
            assert_memory_equal(&a, &b, sizeof a);
            fibre_point_accept(&fastest);
            fibre_point_accept(&portable);
        }
        fibre_point_release(&fastest);
        fibre_point_release(&portable);
    }
}

static void rejects_impossible_sections(void **unused)
{
    (void)unused;
    const struct wb_law law = test_laws_get(0);
    const struct wb_law_section_model wrong[] = {
        {.diameter = 0.0, .law = &law},
        {.diameter = DIAMETER, .law = &law, .torsional_stiffness = -1.0},
        {.diameter = DIAMETER, .law = &law, .fibres = {0, 6}},
        {.diameter = DIAMETER, .law = &law, .fibres = {65, 24}},
    };
    wb_log_set_sink(discard_message, NULL);
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        struct wb_law_section *section;
        assert_int_equal(wb_law_section_create(&section, &wrong[i]), WB_ERR_ARGUMENT);
        assert_null(section);
    }
    wb_log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equals_fibres_that_are_computed_one_by_one),
        cmocka_unit_test(bends_alike_in_every_direction),
        cmocka_unit_test(tangent_is_the_derivative_of_the_forces),
        cmocka_unit_test(stiffness_is_that_of_a_circle),
        cmocka_unit_test(relaxes_as_in_a_plane),
        cmocka_unit_test(vector_instructions_do_not_change_a_bit),
        cmocka_unit_test(rejects_impossible_sections),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
