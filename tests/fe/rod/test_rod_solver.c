/* The elastic rod compared with exact solutions: elastica, follower, circle, bend in space,
 * shooting. */
#include <stdlib.h>

#include "base/vec3.h"
#include "fe/linear/banded.h"
#include "tests/fe/rod/rods.h"

enum {
    STATE = 18, /* of the shooting: r, R, n, m */
    STEPS = 2000
};

static const struct wb_material elastic = {WB_HARDENING_NONE_ELASTIC, 13.84e9, 0.39, 0.0, 0.0, 0.0};

/* Slender enough that axial strain and shear do not affect six digits. */
static struct test_rod make_slender(double *EI)
{
    struct test_rod t = test_rod_make(
        &(struct test_rod_plan){.diameter = 1e-3, .length = 1.0, .material = elastic});
    *EI = wb_rod_section_bending_stiffness(t.section);
    return t;
}

static void tip_deflection_matches_elastica(void **unused)
{
    (void)unused;
    /* P L^2 / EI: w/L, u/L, angle (Mattiasson 1981). */
    static const double rows[][4] = {
        {0.2, .066364, .002647, .099636},  {0.4, .130975, .010354, .197155},
        {0.6, .192350, .022488, .290738},  {0.8, .249452, .038166, .379063},
        {1.0, .301721, .056433, .461352},  {1.5, .410978, .107942, .639540},
        {2.0, .493457, .160642, .781750},  {2.5, .555659, .209958, .894997},
        {3.0, .603253, .254420, .986017},  {4.0, .669964, .328941, 1.121239},
        {5.0, .713792, .387628, 1.215368}, {6.0, .744571, .434589, 1.283697},
        {8.0, .784982, .504828, 1.374432}, {10.0, .810609, .554996, 1.430286}};
    /* Along y, along z, and in between. */
    for (int direction = 0; direction < 3; direction++) {
        const double a = direction * M_PI / 4.0, c = cos(a), s = sin(a);
        double EI, worst = 0.0;
        struct test_rod t = make_slender(&EI);
        for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
            const double P = rows[i][0] * EI;
            double along[3];
            test_rod_load(&t, &(struct wb_tip_loads){.force = {0.0, P * c, P * s}});
            const struct wb_rod_node *tip = wb_rod_tip(t.rod);
            const double *r = tip->position;
            test_rod_axis(tip, 0, along);
            worst = fmax(worst, fabs(r[1] * c + r[2] * s - rows[i][1]));
            worst = fmax(worst, fabs(1.0 - r[0] - rows[i][2]));
            worst = fmax(worst, fabs(atan2(along[1] * c + along[2] * s, along[0]) - rows[i][3]));
            assert_close(r[2] * c - r[1] * s, 0.0, 1e-10);
        }
        print_message("elastica in direction %d: %.2g\n", direction, worst);
        assert_true(worst < 2e-6);
        test_rod_release(&t);
    }
}

static void follower_force_matches_the_exact_curl(void **unused)
{
    (void)unused;
    /* F L^2 / EI: x/L, y/L, angle, root moment. */
    static const double rows[][5] = {
        {0.5, .983481, .165043, .249481, .496891},   {1, .935646, .320642, .495885, .975510},
        {2, .767362, .573839, .968239, 1.815366},    {3, .551665, .726685, 1.398656, 2.431321},
        {4, .342746, .786168, 1.776436, 2.798472},   {5, .172278, .780690, 2.098157, 2.939623},
        {6, .049502, .740274, 2.365547, 2.899234},   {8, -.073863, .633592, 2.756554, 2.451432},
        {10, -.092123, .546983, 2.992715, 1.722373}, {13.5, -.008965, .461168, 3.141018, .124611}};
    double EI, worst = 0.0;
    struct test_rod t = make_slender(&EI);
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        struct wb_rod_balance balance;
        double along[3];
        test_rod_load(&t, &(struct wb_tip_loads){.follower = {0.0, rows[i][0] * EI, 0.0}});
        wb_rod_evaluate(t.rod, 1.0, &balance);
        const struct wb_rod_node *tip = wb_rod_tip(t.rod);
        test_rod_axis(tip, 0, along);
        worst = fmax(worst, fabs(tip->position[0] - rows[i][1]));
        worst = fmax(worst, fabs(tip->position[1] - rows[i][2]));
        worst = fmax(worst, fabs(atan2(along[1], along[0]) - rows[i][3]));
        worst = fmax(worst, fabs(-balance.clamp[5] / EI - rows[i][4]));
    }
    print_message("follower: %.2g\n", worst);
    assert_true(worst < 3e-5);
    test_rod_release(&t);
}

static void end_moment_closes_the_circle(void **unused)
{
    (void)unused;
    /* About z, y and an axis between: three planes. */
    for (int plane = 0; plane < 3; plane++) {
        const double a = plane * M_PI / 4.0;
        double EI;
        struct test_rod t = make_slender(&EI);
        const double M = 2.0 * M_PI * EI;
        test_rod_load(&t, &(struct wb_tip_loads){.moment = {0.0, -M * sin(a), M * cos(a)}});
        const struct wb_rod_node *tip = wb_rod_tip(t.rod);
        const double origin[3] = {0.0, 0.0, 0.0};
        const double top[3] = {0.0, cos(a) / M_PI, sin(a) / M_PI};
        assert_close(test_rod_distance(tip->position, origin), 0.0, 1e-9);
        assert_close(fabs(tip->rotation[0]), 1.0, 1e-12);
        assert_close(test_rod_distance(wb_rod_position(t.rod, 0.5).position, top), 0.0, 1e-6);
        test_rod_release(&t);
    }
}

/* --- shooting: the rod's equations integrated by Runge and Kutta's method --- */

struct shooting {
    double EA, GA, GJ, EI, length;
    double load[3];
    double natural[3]; /* curvature */
    struct wb_tip_loads tip;
};

/* r' = R (G + e), R' = R [k x], n' = -load, m' = -r' x n. */
static void slope(const struct shooting *p, const double y[STATE], double dy[STATE])
{
    const double *R = y + 3, *n = y + 12, *m = y + 15;
    double N[3], M[3];
    for (int i = 0; i < 3; i++) {
        N[i] = R[i] * n[0] + R[3 + i] * n[1] + R[6 + i] * n[2];
        M[i] = R[i] * m[0] + R[3 + i] * m[1] + R[6 + i] * m[2];
    }
    const double G[3] = {1.0 + N[0] / p->EA, N[1] / p->GA, N[2] / p->GA};
    const double k[3] = {p->natural[0] + M[0] / p->GJ, p->natural[1] + M[1] / p->EI,
                         p->natural[2] + M[2] / p->EI};
    for (int i = 0; i < 3; i++) {
        const double *row = R + 3 * i;
        dy[i] = row[0] * G[0] + row[1] * G[1] + row[2] * G[2];
        dy[3 + 3 * i] = row[1] * k[2] - row[2] * k[1];
        dy[4 + 3 * i] = row[2] * k[0] - row[0] * k[2];
        dy[5 + 3 * i] = row[0] * k[1] - row[1] * k[0];
        dy[12 + i] = -p->load[i];
    }
    wb_vec3_cross(n, dy, dy + 15);
}

/* Integrates from forces and moments at the clamp to the unbalanced ones at the tip. */
static void shoot(const struct shooting *p, const double root[6], double y[STATE], double miss[6])
{
    const double h = p->length / STEPS;
    memset(y, 0, STATE * sizeof *y);
    y[3] = y[7] = y[11] = 1.0;
    memcpy(y + 12, root, 6 * sizeof *root);
    for (int i = 0; i < STEPS; i++) {
        static const double part[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0, 2.0, 2.0, 1.0};
        double sum[STATE] = {0}, k[STATE] = {0};
        for (int stage = 0; stage < 4; stage++) {
            double at[STATE];
            for (int j = 0; j < STATE; j++)
                at[j] = y[j] + h * part[stage] * k[j];
            slope(p, at, k);
            for (int j = 0; j < STATE; j++)
                sum[j] += weight[stage] / 6.0 * k[j];
        }
        for (int j = 0; j < STATE; j++)
            y[j] += h * sum[j];
    }
    for (int i = 0; i < 3; i++) {
        miss[i] = y[12 + i] - p->tip.force[i];
        for (int j = 0; j < 3; j++)
            miss[i] -= y[3 + 3 * i + j] * p->tip.follower[j];
        miss[3 + i] = y[15 + i] - p->tip.moment[i];
    }
}

/* Newton's method with finite differences on the clamp's reactions, from an initial guess. */
static void solve_by_shooting(const struct shooting *p, double root[6], double y[STATE])
{
    const double unit[6] = {1.0, 1.0, 1.0, p->length, p->length, p->length};
    const double force = p->EI / (p->length * p->length);
    double miss[6], size = 0.0;
    for (int iteration = 0; iteration < 20; iteration++) {
        double A[36], moved[6];
        shoot(p, root, y, miss);
        size = 0.0;
        for (int i = 0; i < 6; i++)
            size = fmax(size, fabs(miss[i]) / unit[i] / force);
        if (size < 1e-13)
            break;
        for (int j = 0; j < 6; j++) {
            double other[STATE], off[6];
            const double step = 1e-7 * force * unit[j];
            memcpy(moved, root, sizeof moved);
            moved[j] += step;
            shoot(p, moved, other, off);
            for (int i = 0; i < 6; i++)
                A[6 * i + j] = (off[i] - miss[i]) / step;
        }
        for (int i = 0; i < 6; i++)
            moved[i] = -miss[i];
        wb_banded_solve_small(6, 6, A, moved);
        for (int i = 0; i < 6; i++)
            root[i] += moved[i];
    }
    assert_true(size < 1e-9);
}

/* Of the virgin section. */
static double torsion_stiffness(const struct wb_rod_section *section)
{
    const double none[WB_ROD_SECTION_STRAINS] = {0.0};
    const size_t size = wb_rod_section_history_size(section);
    double *const before = calloc(size, sizeof *before), *const after = calloc(size, sizeof *after);
    struct wb_rod_section_response response;
    assert_true(before && after);
    wb_rod_section_respond(section, none, before, after, &response);
    free(before);
    free(after);
    return response.tangent[1][1];
}

static struct shooting shooting_of(const struct test_rod *t, double length,
                                   const struct wb_tip_loads *tip)
{
    return (struct shooting){
        .EA = wb_rod_section_axial_stiffness(t->section),
        .GA = wb_rod_section_shear_stiffness(t->section),
        .GJ = torsion_stiffness(t->section),
        .EI = wb_rod_section_bending_stiffness(t->section),
        .length = length,
        .tip = *tip,
    };
}

/* Distance of the tip from the result of shooting, whose initial guess is the rod's reactions. */
static double shooting_error(const struct test_rod *t, const struct shooting *p)
{
    struct wb_rod_balance balance;
    double root[6], y[STATE], R[9];
    wb_rod_evaluate(t->rod, 1.0, &balance);
    for (int i = 0; i < 6; i++)
        root[i] = -balance.clamp[i];
    solve_by_shooting(p, root, y);
    const struct wb_rod_node *tip = wb_rod_tip(t->rod);
    double error = test_rod_distance(tip->position, y);
    wb_rod_element_matrix(tip->rotation, R);
    for (int i = 0; i < 9; i++)
        error = fmax(error, p->length * fabs(R[i] - y[3 + i]));
    return error / p->length;
}

static void loads_in_space_match_shooting(void **unused)
{
    (void)unused;
    /* In units of EI / L^2 and EI / L; the moments keep their axes as the tip turns. */
    static const struct wb_tip_loads cases[] = {
        {.force = {0.5, 2.0, -1.0}, .moment = {1.5, -1.0, 2.0}},
        {.moment = {2.0, 0.5, 3.0}},
        {.follower = {-1.0, 3.0, 2.0}, .moment = {1.0, 0.0, 0.0}},
        {.force = {-1.0, 1.0, 4.0}, .moment = {-3.0, 1.0, 1.0}, .follower = {0.0, 1.5, -0.5}},
    };
    const double d = 4.86e-3, L = 0.1;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        double error[3];
        for (int level = 0; level < 3; level++) {
            struct test_rod t = test_rod_make(&(struct test_rod_plan){.diameter = d,
                                                                      .length = L,
                                                                      .material = elastic,
                                                                      .n_elements = 12 << level,
                                                                      .load = {0.0, -100.0, 50.0}});
            const double EI = wb_rod_section_bending_stiffness(t.section);
            struct wb_tip_loads tip;
            for (int k = 0; k < 3; k++) {
                tip.force[k] = cases[i].force[k] * EI / (L * L);
                tip.moment[k] = cases[i].moment[k] * EI / L;
                tip.follower[k] = cases[i].follower[k] * EI / (L * L);
            }
            test_rod_load(&t, &tip);
            struct shooting p = shooting_of(&t, L, &tip);
            p.load[1] = -100.0;
            p.load[2] = 50.0;
            error[level] = shooting_error(&t, &p);
            test_rod_release(&t);
        }
        print_message("12, 24, 48 elements: error %.2g, %.2g, %.2g\n", error[0], error[1],
                      error[2]);
        assert_true(error[2] < 2e-6);
        assert_true(error[0] / error[1] > 12.0);
        assert_true(error[1] / error[2] > 12.0);
    }
}

static void bend(void *context, double s, double curvature[3])
{
    (void)s;
    curvature[2] = *(const double *)context;
}

/* Bathe & Bolourchi 1979: a bend of 45 degrees and radius 100, loaded across its plane. The section
 * is a circle of the same bending stiffness as their square, so that only its torsion stiffness
 * differs. Published tips lie around ours; shooting with the same stiffness is exact. */
static void bend_of_45_degrees_leaves_its_plane(void **unused)
{
    (void)unused;
    double curvature = 0.01;
    const double L = 25.0 * M_PI, d = pow(64.0 / 12.0 / M_PI, 0.25);
    const struct wb_material m = {WB_HARDENING_NONE_ELASTIC, 1e7, 0.0, 0.0, 0.0, 0.0};
    struct test_rod t = test_rod_make(&(struct test_rod_plan){.diameter = d,
                                                              .length = L,
                                                              .material = m,
                                                              .natural_curvature = bend,
                                                              .curvature_context = &curvature,
                                                              .n_elements = 16});
    /* Simo & Vu-Quoc 1986, with the bend's start along our x: (ours x, y, z) = (their y, x, z). */
    static const double published[3][4] = {
        {300.0, 58.84, 22.33, 40.08}, {450.0, 52.32, 18.62, 48.39}, {600.0, 47.23, 15.79, 53.37}};
    const struct wb_rod_node *tip = wb_rod_tip(t.rod);
    assert_close(tip->position[0], 100.0 * sin(M_PI / 4.0), 1e-5);
    assert_close(tip->position[1], 100.0 * (1.0 - cos(M_PI / 4.0)), 1e-5);
    for (int i = 0; i < 3; i++) {
        const struct wb_tip_loads loads = {.force = {0.0, 0.0, published[i][0]}};
        const struct wb_rod_result result = test_rod_load(&t, &loads);
        struct shooting p = shooting_of(&t, L, &loads);
        p.natural[2] = curvature;
        const double error = shooting_error(&t, &p);
        print_message("F = %.0f: tip %.3f, %.3f, %.3f in %d increments, %d iterations; shooting: "
                      "%.2g\n",
                      published[i][0], tip->position[0], tip->position[1], tip->position[2],
                      result.increments, result.iterations, error);
        assert_true(error < 1e-6);
        for (int k = 0; k < 3; k++)
            assert_close(tip->position[k], published[i][k + 1], 0.5);
    }
    test_rod_release(&t);
}

static void coil(void *context, double s, double curvature[3])
{
    (void)s;
    memcpy(curvature, context, 3 * sizeof *curvature);
}

/* A helical spring with more than two turns, in tension and torsion. */
static void helix_under_force_and_moment_matches_shooting(void **unused)
{
    (void)unused;
    double natural[3] = {30.0, 0.0, 140.0};
    struct test_rod t = test_rod_make(&(struct test_rod_plan){.diameter = 1e-3,
                                                              .length = 0.1,
                                                              .material = elastic,
                                                              .natural_curvature = coil,
                                                              .curvature_context = natural,
                                                              .n_elements = 100});
    const double EI = wb_rod_section_bending_stiffness(t.section);
    const double start = test_rod_distance(wb_rod_tip(t.rod)->position, (double[3]){0});
    for (int i = 1; i <= 3; i++) {
        struct wb_tip_loads loads = {.force = {40.0 * i, 10.0 * i, 60.0 * i},
                                     .moment = {3.0 * i, -1.0 * i, 2.0 * i}};
        for (int k = 0; k < 3; k++) {
            loads.force[k] *= EI / 0.01;
            loads.moment[k] *= EI / 0.1;
        }
        test_rod_load(&t, &loads);
        struct shooting p = shooting_of(&t, 0.1, &loads);
        memcpy(p.natural, natural, sizeof natural);
        const double error = shooting_error(&t, &p);
        const double end = test_rod_distance(wb_rod_tip(t.rod)->position, (double[3]){0});
        print_message("spring: %.1f to %.1f mm, shooting: %.2g\n", 1e3 * start, 1e3 * end, error);
        assert_true(end > 1.2 * start);
        assert_true(error < 1e-5);
    }
    test_rod_release(&t);
}

static void paper_follower_of_24_newtons(void **unused)
{
    (void)unused;
    struct test_rod t = test_rod_make(
        &(struct test_rod_plan){.diameter = 4.86e-3, .length = 0.1, .material = elastic});
    const struct wb_tip_loads loads = {.follower = {0.0, 24.0, 0.0}};
    double along[3];
    test_rod_load(&t, &loads);
    const struct wb_rod_node *tip = wb_rod_tip(t.rod);
    test_rod_axis(tip, 0, along);
    /* Exact without shear and axial strain, which add 0.03 mm. */
    assert_close(tip->position[0], 97.3646e-3, 1e-5);
    assert_close(tip->position[1], 20.7793e-3, 3e-5);
    assert_close(atan2(along[1], along[0]), 18.080 * M_PI / 180.0, 2e-5);
    /* And exact with them. */
    const struct shooting p = shooting_of(&t, 0.1, &loads);
    assert_true(shooting_error(&t, &p) < 1e-8);
    test_rod_release(&t);
}

/* The tension of a strand acts towards its upper end, also out of the plane. */
static void strand_pulls_towards_its_upper_end(void **unused)
{
    (void)unused;
    const double L = 0.1, S = 0.12;
    struct test_rod t = test_rod_make(&(struct test_rod_plan){
        .diameter = 2e-3, .length = L, .material = elastic, .strand_length = S});
    const struct wb_tip_loads aside = {.force = {0.0, 0.0, 1.5}, .moment = {0.01, 0.02, 0.0}};
    test_rod_load(&t, &aside);
    struct wb_rod_result result;
    const struct wb_rod_move up = {
        .control = WB_ROD_DEFLECTION, .target = {.weight = 1.0, .tip = aside}, .deflection = 0.05};
    assert_int_equal(wb_rod_solver_move(t.solver, &up, &result), WB_OK);
    assert_int_equal(result.end, WB_ROD_CONVERGED);

    const double *tip = wb_rod_tip(t.rod)->position;
    const double T = wb_rod_solver_loads(t.solver)->tension;
    const double p = (L - tip[0]) / S, q = -tip[2] / S;
    struct wb_rod_balance balance;
    wb_rod_evaluate(t.rod, 1.0, &balance);
    assert_close(tip[1], 0.05, 1e-12);
    assert_true(T > 0.5 && fabs(q) > 0.02 && p > 0.1);
    assert_close(-balance.clamp[0], T * p, 1e-7);
    assert_close(-balance.clamp[1], T * sqrt(1.0 - p * p - q * q), 1e-7);
    assert_close(-balance.clamp[2], T * q + 1.5, 1e-7);
    assert_close(wb_rod_solver_vertical_force(t.solver), -balance.clamp[1], 1e-7);

    /* Checks that all tangents of the loads are exact: a small additional change needs few
     * iterations. */
    const struct wb_rod_move other = {
        .control = WB_ROD_DEFLECTION,
        .target = {.weight = 1.0,
                   .tip = {.force = {0.1, 0.0, 1.5}, .moment = {0.01, 0.018, 0.001}}},
        .deflection = 0.0495};
    assert_int_equal(wb_rod_solver_move(t.solver, &other, &result), WB_OK);
    assert_int_equal(result.end, WB_ROD_CONVERGED);
    print_message("strand in space: %.3f N, leaning %.3f and %.3f; %d iterations\n", T, p, q,
                  result.iterations);
    assert_in_range(result.iterations, 1, 3 * result.increments);
    test_rod_release(&t);
}

static void followers_and_moments_take_few_iterations(void **unused)
{
    (void)unused;
    struct test_rod t = test_rod_make(
        &(struct test_rod_plan){.diameter = 2e-3, .length = 0.1, .material = elastic});
    struct wb_tip_loads loads = {.moment = {0.04, 0.05, 0.06}, .follower = {-0.5, 2.0, 1.0}};
    test_rod_load(&t, &loads);
    loads.moment[1] += 2e-3;
    loads.follower[2] -= 0.05;
    const struct wb_rod_result result = test_rod_load(&t, &loads);
    print_message("follower and moment: %d iterations\n", result.iterations);
    assert_in_range(result.iterations, 1, 3 * result.increments);
    test_rod_release(&t);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tip_deflection_matches_elastica),
        cmocka_unit_test(follower_force_matches_the_exact_curl),
        cmocka_unit_test(end_moment_closes_the_circle),
        cmocka_unit_test(loads_in_space_match_shooting),
        cmocka_unit_test(bend_of_45_degrees_leaves_its_plane),
        cmocka_unit_test(helix_under_force_and_moment_matches_shooting),
        cmocka_unit_test(strand_pulls_towards_its_upper_end),
        cmocka_unit_test(followers_and_moments_take_few_iterations),
        cmocka_unit_test(paper_follower_of_24_newtons),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
