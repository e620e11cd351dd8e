/* The rod's section compared with closed forms, the planar section and finite differences; energy
 * balance. */
#include "fe/rod/rod_section.h"

#include <stdlib.h>

#include "fe/rod/fibres.h"
#include "tests/fe/rod/rod_energy.h"
#include "tests/fe/rod/wires.h"

enum {
    N = WB_ROD_SECTION_STRAINS
};

static const struct wb_material copper = {
    WB_HARDENING_ISOTROPIC_POWER, 68.2e9, 0.34, 182e6, 292e6, 0.31};
static const struct wb_material perfect = {
    WB_HARDENING_ISOTROPIC_POWER, 68.2e9, 0.34, 182e6, 0.0, 1.0};
static const struct wb_material prager = {
    WB_HARDENING_KINEMATIC_LINEAR, 68.2e9, 0.34, 182e6, 2e9, 1.0};
static const struct wb_material pvc = {WB_HARDENING_NONE_ELASTIC, 41e6, 0.43, 0.0, 0.0, 0.0};

static const double R = 1.63e-3;

/* A section and the history of one point of it. */
struct point {
    struct wb_rod_section *section;
    double *before, *after;
    struct wb_rod_section_response response;
};

static struct point make_parts(int n, const struct wb_rod_section_part *parts, int n_rings,
                               int n_around)
{
    struct point point;
    const struct wb_rod_section_layout layout = {n_rings, n_around};
    assert_int_equal(wb_rod_section_create(&point.section, n, parts, &layout), WB_OK);
    const size_t size = wb_rod_section_history_size(point.section);
    point.before = calloc(size, sizeof *point.before);
    point.after = calloc(size, sizeof *point.after);
    assert_non_null(point.before);
    assert_non_null(point.after);
    return point;
}

static struct point make_circle(const struct wb_material *material, int n_rings, int n_around)
{
    const struct wb_rod_section_part part = {0.0, 2.0 * R, *material};
    return make_parts(1, &part, n_rings, n_around);
}

static void release(struct point *point)
{
    wb_rod_section_destroy(point->section);
    free(point->before);
    free(point->after);
}

static const double *respond(struct point *point, const double *strain)
{
    wb_rod_section_respond(point->section, strain, point->before, point->after, &point->response);
    return point->response.force;
}

static void commit(struct point *point)
{
    double *old = point->before;
    point->before = point->after;
    point->after = old;
}

static void elastic_stiffnesses_are_exact(void **unused)
{
    (void)unused;
    const int layouts[][2] = {{1, 4}, {8, 24}, {3, 8}};
    for (size_t i = 0; i < 3; i++) {
        const double Ri = 1.63e-3, Ro = 2.43e-3;
        const struct wb_rod_section_part parts[2] = {{0.0, 2.0 * Ri, copper},
                                                     {2.0 * Ri, 2.0 * Ro, pvc}};
        struct point p = make_parts(2, parts, layouts[i][0], layouts[i][1]);
        const double Gc = 68.2e9 / 2.68, Gp = 41e6 / 2.86;
        const double J = M_PI / 2.0 * pow(Ri, 4.0), ring = M_PI / 2.0 * (pow(Ro, 4) - pow(Ri, 4));
        const double area = M_PI * Ri * Ri, ring_area = M_PI * (Ro * Ro - Ri * Ri);
        const double EA = 68.2e9 * area + 41e6 * ring_area;
        const double EI = 0.5 * (68.2e9 * J + 41e6 * ring), GJ = Gc * J + Gp * ring;
        assert_close_relative(wb_rod_section_axial_stiffness(p.section), EA, 1e-13);
        assert_close_relative(wb_rod_section_bending_stiffness(p.section), EI, 1e-13);
        assert_close_relative(wb_rod_section_shear_stiffness(p.section),
                              wb_section_shear_modulus(&copper) * area +
                                  wb_section_shear_modulus(&pvc) * ring_area,
                              1e-13);

        /* The virgin section, and with the fibre code enabled by the history's flag (no fibre has
         * yielded). */
        const double strain[N] = {1e-4, 0.1, 0.2, -0.3};
        const double expected[N] = {EA * 1e-4, GJ * 0.1, EI * 0.2, -EI * 0.3};
        const double far[N] = {0.0, 4.0, 0.0, 0.0}, none[N] = {0.0, 0.0, 0.0, 0.0};
        respond(&p, strain);
        assert_close_relative(p.response.tangent[1][1], GJ, 1e-13);
        for (int k = 0; k < N; k++)
            assert_close_relative(p.response.force[k], expected[k], 1e-12);
        respond(&p, far);
        assert_true(p.response.yielding > 0);
        commit(&p);
        const double residual = respond(&p, none)[1];
        respond(&p, strain);
        assert_close(p.response.yielding, 0, 0);
        for (int k = 0; k < N; k++)
            assert_close_relative(p.response.force[k] - (k == 1 ? residual : 0.0), expected[k],
                                  1e-10);
        release(&p);
    }
}

static void cells_cover_the_section(void **unused)
{
    (void)unused;
    const struct wb_rod_section_part parts[2] = {{0.0, 2.0 * R, copper}, {2.0 * R, 3.0 * R, pvc}};
    struct point p = make_parts(2, parts, 5, 12);
    double area = 0.0;
    assert_int_equal(wb_rod_section_fibres(p.section), 120);
    for (int i = 0; i < 120; i++) {
        struct wb_rod_section_fibre f;
        wb_rod_section_fibre(p.section, i, &f);
        const double cell = 0.5 * (f.end_angle - f.begin_angle) *
                            (f.outer_radius * f.outer_radius - f.inner_radius * f.inner_radius);
        const double r = hypot(f.y, f.z), angle = 0.5 * (f.begin_angle + f.end_angle);
        assert_close_relative(f.area, cell, 1e-12);
        assert_true(r > f.inner_radius && r < f.outer_radius);
        assert_close(f.y, r * cos(angle), 1e-15);
        assert_close(f.z, r * sin(angle), 1e-15);
        assert_int_equal(f.part, i / 60);
        area += f.area;
    }
    assert_close_relative(area, M_PI * 2.25 * R * R, 1e-13);
    release(&p);
}

static void fully_plastic_limits_are_reached(void **unused)
{
    (void)unused;
    const double Mp = 4.0 / 3.0 * 182e6 * R * R * R;
    const double Tp = 2.0 / 3.0 * M_PI * 182e6 / sqrt(3.0) * R * R * R;
    const double yield = 182e6 / 68.2e9 / R;
    struct point fine = make_circle(&perfect, 16, 64), p = make_circle(&perfect, 0, 0);
    const double bend[N] = {0.0, 0.0, 0.0, 200.0 * yield};
    const double twist[N] = {0.0, 200.0 * yield, 0.0, 0.0};
    const double pull[N] = {0.1, 0.0, 0.0, 0.0};

    assert_close_relative(respond(&fine, bend)[3], Mp, 5e-4);
    assert_close_relative(respond(&p, bend)[3], Mp, 2e-3);
    assert_close_relative(respond(&p, twist)[1], Tp, 5e-4);
    assert_close_relative(respond(&p, pull)[0], 182e6 * M_PI * R * R, 1e-12);

    /* Bending and torsion: s : t is constant along each radius, so the limits are integrals over
     * the angle. They lie on the circle or, because this mechanism gives an upper bound, slightly
     * outside it. */
    double worst = 0.0, farthest = 0.0;
    for (int i = 1; i < 18; i++) {
        const double a = M_PI / 36.0 * i, k = cos(a), g = sin(a) / 3.0;
        const double both[N] = {0.0, 200.0 * yield * sin(a), 0.0, 200.0 * yield * cos(a)};
        double M = 0.0, T = 0.0;
        for (int j = 0; j < 4000; j++) {
            const double c = cos(2.0 * M_PI * (j + 0.5) / 4000);
            const double q = sqrt(k * k * c * c + 3.0 * g * g);
            M += 182e6 * R * R * R / 3.0 * k * c * c / q * 2.0 * M_PI / 4000;
            T += 182e6 * R * R * R / 3.0 * g / q * 2.0 * M_PI / 4000;
        }
        respond(&fine, both);
        worst = fmax(worst, fabs(fine.response.force[3] - M) / Mp);
        worst = fmax(worst, fabs(fine.response.force[1] - T) / Tp);
        const double on = hypot(M / Mp, T / Tp);
        assert_true(on > 1.0);
        farthest = fmax(farthest, on);
    }
    print_message("bending and torsion: %.3f %% from the integrals, these up to %.2f %% outside of "
                  "the circle\n",
                  100.0 * worst, 100.0 * farthest - 100.0);
    assert_true(worst < 5e-4);
    assert_true(farthest < 1.04);
    release(&fine);
    release(&p);
}

/* Pure power law, no elastic part (K much below E): M = 2 K k^n int y^(n+1) 2 sqrt(R^2 - y^2) dy,
 * a Beta function. */
static void power_law_in_bending_is_the_beta_function(void **unused)
{
    (void)unused;
    const double n = 0.5, K = 292e6, kappa = 30.0;
    const struct wb_material m = {WB_HARDENING_ISOTROPIC_POWER, 1e15, 0.3, 1.0, K, n};
    struct point p = make_circle(&m, 8, 24);
    const double strain[N] = {0.0, 0.0, kappa, 0.0};
    /* int_0^R y^(n+1) sqrt(R^2 - y^2) dy = R^(n+3)/2 B((n+2)/2, 3/2) */
    const double beta = tgamma(0.5 * n + 1.0) * tgamma(1.5) / tgamma(0.5 * n + 2.5);
    const double M = 4.0 * K * pow(kappa, n) * 0.5 * pow(R, n + 3.0) * beta;
    assert_close_relative(respond(&p, strain)[2], M, 1e-3);
    release(&p);
}

static void every_direction_bends_alike(void **unused)
{
    (void)unused;
    struct point p = make_circle(&copper, 0, 0);
    const double yield = 182e6 / 68.2e9 / R;
    double worst = 0.0;
    for (double size = 1.2; size < 20.0; size *= 1.5) {
        double first = 0.0;
        for (int i = 0; i < 64; i++) {
            const double a = 2.0 * M_PI * i / 64;
            const double strain[N] = {0.0, 0.0, size * yield * sin(a), size * yield * cos(a)};
            const double *f = respond(&p, strain);
            const double along = f[2] * sin(a) + f[3] * cos(a);
            const double aside = f[2] * cos(a) - f[3] * sin(a);
            if (i == 0)
                first = along;
            worst = fmax(worst, fabs(along / first - 1.0));
            if (i % 8 == 0) {
                /* y, z and the diagonals: equal to round-off, without a lateral moment. */
                assert_close_relative(along, first, 1e-13);
                assert_close(aside, 0.0, 1e-13 * first);
                assert_close(f[0], 0.0, 1e-13 * first / R);
                assert_close(f[1], 0.0, 1e-13 * first);
            }
        }
    }
    print_message("moment in any direction: %.3f %%\n", 100.0 * worst);
    assert_true(worst < 1.5e-3);
    release(&p);
}

/* A planar path with reversals compared with the strips of fe/rod/fibres.h. */
static void planar_paths_agree_with_the_planar_section(void **unused)
{
    (void)unused;
    const struct wb_material *laws[] = {&copper, &prager};
    for (int run = 0; run < 4; run++) {
        const int law = run % 2;
        const bool fine = run >= 2;
        struct wb_section strips;
        struct wb_fibres *fibres = NULL;
        assert_int_equal(wb_section_init_circle(&strips, 2.0 * R, laws[law], 400), WB_OK);
        assert_int_equal(wb_fibres_create(&fibres, &strips), WB_OK);
        const size_t size = wb_fibres_history_size(fibres);
        double *history = calloc(size, sizeof *history), *next = calloc(size, sizeof *next);
        assert_non_null(history);
        assert_non_null(next);

        struct point p = make_circle(laws[law], fine ? 24 : 0, fine ? 96 : 0);
        const double yield = 182e6 / 68.2e9 / R;
        double worst = 0.0, largest = 0.0;
        for (int i = 0; i <= 60; i++) {
            const double kappa = 6.0 * yield * sin(2.0 * M_PI * i / 40.0);
            const double eps = 5e-4 * sin(2.0 * M_PI * i / 30.0);
            const double strain[N] = {eps, 0.0, 0.0, kappa};
            struct wb_fibres_response planar;
            respond(&p, strain);
            wb_fibres_respond(fibres, eps, kappa, history, next, &planar);
            memcpy(history, next, size * sizeof *history);
            commit(&p);
            largest = fmax(largest, fabs(planar.M));
            worst = fmax(worst, fabs(p.response.force[3] - planar.M));
            worst = fmax(worst, R / 4.0 * fabs(p.response.force[0] - planar.N));
        }
        print_message("cyclic planar path: %.3f %% of the largest moment\n",
                      100.0 * worst / largest);
        assert_true(worst < (fine ? 3e-4 : 4e-3) * largest);
        release(&p);
        free(history);
        free(next);
        wb_fibres_destroy(fibres);
        wb_section_release(&strips);
    }
}

static void the_tangent_is_the_derivative(void **unused)
{
    (void)unused;
    const struct wb_material *laws[] = {&copper, &prager, &perfect};
    const double yield = 182e6 / 68.2e9 / R, step[N] = {1e-8, 1e-5, 1e-5, 1e-5};
    double worst = 0.0;
    for (int law = 0; law < 3; law++) {
        struct point p = make_circle(laws[law], 0, 0);
        uint64_t seed = 17;
        for (int i = 0; i < 40; i++) {
            double strain[N];
            for (int k = 0; k < N; k++)
                strain[k] = (k == 0 ? R : 1.0) * 6.0 * yield * (test_random(&seed) - 0.5);
            respond(&p, strain);
            const struct wb_rod_section_response at = p.response;
            for (int j = 0; j < N; j++) {
                double moved[N], side[2][N];
                memcpy(moved, strain, sizeof moved);
                for (int k = 0; k < 2; k++) {
                    moved[j] = strain[j] + (k == 0 ? step[j] : -step[j]);
                    memcpy(side[k], respond(&p, moved), sizeof side[k]);
                }
                for (int k = 0; k < N; k++) {
                    const double unit = (j == 0 ? 1.0 : R) * (k == 0 ? 1.0 : R) * 68.2e9 * R * R;
                    const double slope = 0.5 * (side[0][k] - side[1][k]) / step[j];
                    worst = fmax(worst, fabs(slope - at.tangent[k][j]) / unit);
                    assert_close(at.tangent[k][j], at.tangent[j][k], 0.0);
                }
            }
            respond(&p, strain);
            if (i % 3 == 0)
                commit(&p);
        }
        release(&p);
    }
    print_message("tangent against differences: %.2g\n", worst);
    assert_true(worst < 1e-4);
}

/* Work in fine steps along a closed non-proportional path is stored or dissipated. */
static void work_is_stored_or_dissipated(void **unused)
{
    (void)unused;
    const struct wb_material *laws[] = {&copper, &prager};
    const double yield = 182e6 / 68.2e9 / R;
    for (int law = 0; law < 2; law++) {
        double error[2];
        for (int fine = 0; fine < 2; fine++) {
            const int n = fine ? 800 : 400;
            struct point p = make_circle(laws[law], 0, 0);
            double was[N] = {0}, force[N] = {0}, work = 0.0, lost = 0.0, stored = 0.0;
            for (int i = 1; i <= n; i++) {
                const double a = 2.0 * M_PI * i / n;
                const double strain[N] = {3e-4 * sin(a), 3.0 * yield * sin(2.0 * a),
                                          4.0 * yield * (1.0 - cos(a)), 3.0 * yield * sin(a)};
                double dissipated;
                respond(&p, strain);
                for (int k = 0; k < N; k++) {
                    work += 0.5 * (force[k] + p.response.force[k]) * (strain[k] - was[k]);
                    force[k] = p.response.force[k];
                    was[k] = strain[k];
                }
                test_section_energy(p.section, laws[law], strain, p.before, p.after, &stored,
                                    &dissipated);
                assert_true(dissipated >= 0.0 && stored >= 0.0);
                lost += dissipated;
                commit(&p);
            }
            error[fine] = fabs(work - stored - lost) / work;
            print_message("work %.4g J/m, stored %.4g, dissipated %.4g: missing %.2g\n", work,
                          stored, lost, error[fine]);
            release(&p);
        }
        assert_true(error[1] < 2e-3);
        assert_true(error[1] < 0.6 * error[0]);
    }
}

static void stresses_add_up_to_the_forces(void **unused)
{
    (void)unused;
    const struct wb_rod_section_part parts[2] = {{0.0, 2.0 * R, copper}, {2.0 * R, 3.0 * R, pvc}};
    struct point p = make_parts(2, parts, 0, 0);
    const double strain[N] = {1e-3, 3.0, -4.0, 5.0};
    double sum[N] = {0};
    respond(&p, strain);
    commit(&p);
    for (int i = 0; i < wb_rod_section_fibres(p.section); i++) {
        struct wb_rod_section_fibre f;
        double axial, shear, plastic;
        wb_rod_section_fibre(p.section, i, &f);
        wb_rod_section_stress(p.section, i, strain, p.before, &axial, &shear, &plastic);
        sum[0] += axial * f.area;
        sum[1] += shear * hypot(f.y, f.z) * f.area;
        sum[2] += axial * f.z * f.area;
        sum[3] -= axial * f.y * f.area;
        assert_true(plastic >= 0.0 && plastic < 1.0);
    }
    for (int k = 0; k < N; k++)
        assert_close_relative(sum[k], p.response.force[k], 1e-10);
    assert_true(p.response.yielding > 0 && p.response.yielding < 192);
    release(&p);
}

static void invalid_sections_are_rejected(void **unused)
{
    (void)unused;
    struct wb_rod_section *section = NULL;
    struct wb_rod_section_part part = {0.0, 1e-3, copper};
    const struct wb_rod_section_layout bad[] = {{-1, 24}, {65, 24}, {8, 10}, {8, 260}, {8, -4}};
    wb_log_set_sink(discard_message, NULL);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        assert_int_equal(wb_rod_section_create(&section, 1, &part, &bad[i]), WB_ERR_ARGUMENT);
    assert_int_equal(wb_rod_section_create(&section, 0, &part, NULL), WB_ERR_ARGUMENT);
    part.inner_diameter = 1e-3;
    assert_int_equal(wb_rod_section_create(&section, 1, &part, NULL), WB_ERR_ARGUMENT);
    part.inner_diameter = (double)NAN;
    assert_int_equal(wb_rod_section_create(&section, 1, &part, NULL), WB_ERR_ARGUMENT);
    part.inner_diameter = 0.0;
    part.outer_diameter = (double)INFINITY;
    assert_int_equal(wb_rod_section_create(&section, 1, &part, NULL), WB_ERR_ARGUMENT);
    part.outer_diameter = 1e-3;
    part.material.yield_stress = (double)NAN;
    assert_int_equal(wb_rod_section_create(&section, 1, &part, NULL), WB_ERR_ARGUMENT);
    assert_null(section);
    wb_log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(elastic_stiffnesses_are_exact),
        cmocka_unit_test(cells_cover_the_section),
        cmocka_unit_test(fully_plastic_limits_are_reached),
        cmocka_unit_test(power_law_in_bending_is_the_beta_function),
        cmocka_unit_test(every_direction_bends_alike),
        cmocka_unit_test(planar_paths_agree_with_the_planar_section),
        cmocka_unit_test(the_tangent_is_the_derivative),
        cmocka_unit_test(work_is_stored_or_dissipated),
        cmocka_unit_test(stresses_add_up_to_the_forces),
        cmocka_unit_test(invalid_sections_are_rejected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
