/* Critical points of rods: moves end before them, and only there. */
#include "tests/fe/rod/rods.h"

#include "fe/rod/rod_private.h"

static const struct wb_material elastic = {WB_HARDENING_NONE_ELASTIC, 13.84e9, 0.39, 0.0, 0.0, 0.0};

static const double L = 0.1;

static struct test_rod make(const struct wb_material *material)
{
    return test_rod_make(
        &(struct test_rod_plan){.diameter = 3e-3, .length = L, .material = *material});
}

/* The same rod upright, with its axis along y, so that a deflection shortens it. */
static struct test_rod make_upright(const struct wb_material *material)
{
    struct test_rod t = make(material);
    const double quarter[4] = {sqrt(0.5), 0.0, 0.0, sqrt(0.5)};
    wb_rod_set_clamp(t.rod, quarter);
    wb_rod_solver_reset(t.solver);
    test_rod_load(&t, &(struct wb_tip_loads){0});
    return t;
}

static double force_unit(const struct test_rod *t)
{
    return wb_rod_section_bending_stiffness(t->section) / (L * L);
}

/* EI t'' + P (1 - P/EA + P/GA) t = 0 for the section's rotation t. */
static double buckling_load(const struct test_rod *t)
{
    const double soft = 1.0 / wb_rod_section_shear_stiffness(t->section) -
                        1.0 / wb_rod_section_axial_stiffness(t->section);
    double P = 0.0;
    for (int i = 0; i < 30; i++)
        P = M_PI * M_PI / 4.0 * force_unit(t) / (1.0 + P * soft);
    return P;
}

static struct wb_rod_result push(struct test_rod *t, const struct wb_tip_loads *tip, double tension)
{
    struct wb_rod_result result;
    const struct wb_rod_move move = {.control = WB_ROD_LOADS,
                                     .target = {.weight = 1.0, .tip = *tip, .tension = tension}};
    assert_int_equal(wb_rod_solver_move(t->solver, &move, &result), WB_OK);
    return result;
}

static struct wb_rod_result hold(struct test_rod *t, const struct wb_tip_loads *tip, double y)
{
    struct wb_rod_result result;
    const struct wb_rod_move move = {
        .control = WB_ROD_DEFLECTION, .target = {.weight = 1.0, .tip = *tip}, .deflection = y};
    assert_int_equal(wb_rod_solver_move(t->solver, &move, &result), WB_OK);
    return result;
}

static void assert_critical(const struct wb_rod_result *result)
{
    assert_int_equal(result->end, WB_ROD_NOT_CONVERGED);
    assert_non_null(strstr(result->problem, "critical point"));
    assert_non_null(strstr(result->problem, "buckling load"));
}

static void strut_stops_before_eulers_load(void **unused)
{
    (void)unused;
    struct test_rod t = make(&elastic);
    const double P = buckling_load(&t);
    /* In one move, and in a second move after a first one below the load. */
    for (int moves = 1; moves <= 2; moves++) {
        wb_rod_solver_reset(t.solver);
        if (moves == 2)
            test_rod_load(&t, &(struct wb_tip_loads){.force = {-0.9 * P, 0.0, 0.0}});
        const struct wb_rod_result result =
            push(&t, &(struct wb_tip_loads){.force = {-3.0 * P, 0.0, 0.0}}, 0.0);
        const double reached = -wb_rod_solver_loads(t.solver)->tip.force[0] / P;
        print_message("dead strut: stops at %.6f of its buckling load; %d iterations: %s\n",
                      reached, result.iterations, result.problem);
        assert_critical(&result);
        assert_true(reached < 1.0 && reached > 1.0 - 5e-5);
        assert_close(wb_rod_tip(t.rod)->position[1], 0.0, 1e-12);
    }
    /* It can be unloaded and loaded again. */
    test_rod_load(&t, &(struct wb_tip_loads){.force = {5.0 * P, 0.0, 0.0}});
    test_rod_load(&t, &(struct wb_tip_loads){.force = {-0.999 * P, 0.0, 0.0}});
    test_rod_release(&t);
}

/* A tip that is fixed along the strut but free laterally buckles at the same load. */
static void shortened_strut_stops_there_too(void **unused)
{
    (void)unused;
    struct test_rod t = make_upright(&elastic);
    const double P = buckling_load(&t), strain = P / wb_rod_section_axial_stiffness(t.section);
    const struct wb_rod_result result =
        hold(&t, &(struct wb_tip_loads){0}, L * (1.0 - 2.0 * strain));
    const double reached = -wb_rod_solver_loads(t.solver)->tension / P;
    print_message("shortened strut: stops at %.8f of its buckling load\n", reached);
    assert_critical(&result);
    assert_true(reached < 1.0 + 1e-6 && reached > 1.0 - 5e-5);
    test_rod_release(&t);
}

/* With a small lateral load it bends and continues: the elastica at 1.518 times Euler's load has a
 * tip angle of 100 degrees and coordinates of 0.349 and 0.792 of its length (Timoshenko & Gere). */
static void bent_strut_continues_past_eulers_load(void **unused)
{
    (void)unused;
    for (int held = 0; held < 2; held++) {
        struct test_rod t = make_upright(&elastic);
        const double P = buckling_load(&t);
        const struct wb_tip_loads aside = {.force = {1e-3 * P, 0.0, 0.0}};
        double along[3];
        test_rod_load(&t, &aside);
        const struct wb_rod_result result =
            held ? hold(&t, &aside, 0.349 * L) : push(&t, &aside, -1.518 * P);
        const struct wb_rod_node *tip = wb_rod_tip(t.rod);
        test_rod_axis(tip, 0, along);
        const double turned = acos(along[1]) * 180.0 / M_PI;
        print_message("strut bent, %s: %.4f P, tip at %.4f, %.4f, turned by %.2f degrees\n",
                      held ? "held" : "loaded", -wb_rod_solver_loads(t.solver)->tension / P,
                      tip->position[0] / L, tip->position[1] / L, turned);
        assert_string_equal(result.problem, "");
        assert_int_equal(result.end, WB_ROD_CONVERGED);
        assert_close(-wb_rod_solver_loads(t.solver)->tension / P, 1.518, 3e-3);
        assert_close(tip->position[0], 0.792 * L, 2e-3 * L);
        assert_close(tip->position[1], 0.349 * L, 2e-3 * L);
        assert_close(turned, 100.0, 0.2);
        test_rod_release(&t);
    }
}

/* A strut bent by a lateral load and compressed beyond its buckling load follows the lateral load
 * when it reverses: in a plane it would remain bent for a while, in space it swings around at once.
 * `turning` is the share a of the compressive load that rotates with the tip; it raises the
 * buckling load to that of cos(k L) = -a / (1 - a), k^2 = P / EI. */
static void assert_swings_at_zero(double turning)
{
    struct test_rod t = make(&elastic);
    const double kL = acos(-turning / (1.0 - turning)), P = 1.3 * kL * kL * force_unit(&t);
    struct wb_tip_loads loads = {.force = {-(1.0 - turning) * P, 0.02 * P, 0.0},
                                 .follower = {-turning * P, 0.0, 0.0}};
    /* For loads that rotate, only single critical points are detected, but a straight strut has two
     * at once, one per plane: bend it strongly first. */
    struct wb_tip_loads first = loads;
    first.force[1] = 0.3 * P;
    test_rod_load(&t, &first);
    test_rod_load(&t, &loads);
    const double bent = wb_rod_tip(t.rod)->position[1];
    assert_true(bent > 0.1 * L);
    loads.force[1] = -0.01 * P;
    const struct wb_rod_result result = push(&t, &loads, 0.0);
    print_message("bent by %.3f L: swings at %.6f of the way to -1/2 (%s)\n", bent / L,
                  result.fraction, result.problem);
    assert_critical(&result);
    assert_close(result.fraction, 2.0 / 3.0, 1e-3);
    assert_true(result.fraction < 2.0 / 3.0 + 2e-5);
    assert_close(wb_rod_tip(t.rod)->position[2], 0.0, 1e-9);
    test_rod_release(&t);
}

static void bent_strut_swings_out_of_its_plane(void **unused)
{
    (void)unused;
    assert_swings_at_zero(0.0);
}

static void bent_strut_swings_under_a_follower(void **unused)
{
    (void)unused;
    assert_swings_at_zero(0.2);
}

/* Beck's column: a load that rotates with the tip causes no static buckling. */
static void follower_along_the_rod_has_no_critical_point(void **unused)
{
    (void)unused;
    struct test_rod t = make(&elastic);
    test_rod_load(&t, &(struct wb_tip_loads){.follower = {-19.0 * force_unit(&t), 0.0, 0.0}});
    test_rod_release(&t);
}

/* A yielding strut carries less load the more it bends: control by deflection passes the limit
 * load, control by load ends there, and both agree. */
static void deflection_control_passes_a_limit_load(void **unused)
{
    (void)unused;
    const struct wb_material soft = {WB_HARDENING_ISOTROPIC_POWER, 13.84e9, 0.39, 40e6, 20e6, 0.5};
    struct test_rod t = make_upright(&soft);
    const struct wb_tip_loads aside = {.force = {0.03 * buckling_load(&t), 0.0, 0.0}};
    test_rod_load(&t, &aside);
    double largest = 0.0, last = 0.0, y = wb_rod_tip(t.rod)->position[1];
    for (int i = 0; i < 400; i++) {
        y -= 2.5e-5 * L * (1.0 + 0.05 * i);
        const struct wb_rod_result result = hold(&t, &aside, y);
        assert_string_equal(result.problem, "");
        last = -wb_rod_solver_loads(t.solver)->tension;
        largest = fmax(largest, last);
    }
    assert_true(largest < 0.9 * buckling_load(&t));
    assert_true(last < 0.8 * largest);

    wb_rod_solver_reset(t.solver);
    test_rod_load(&t, &aside);
    const struct wb_rod_result result = push(&t, &aside, -2.0 * largest);
    const double reached = -wb_rod_solver_loads(t.solver)->tension;
    print_message("limit load: %.4f N held (%.4f N at the end), %.4f N loaded (%s)\n", largest,
                  last, reached, result.problem);
    assert_int_equal(result.end, WB_ROD_NOT_CONVERGED);
    assert_close_relative(reached, largest, 2e-3);
    test_rod_release(&t);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(strut_stops_before_eulers_load),
        cmocka_unit_test(shortened_strut_stops_there_too),
        cmocka_unit_test(bent_strut_continues_past_eulers_load),
        cmocka_unit_test(bent_strut_swings_out_of_its_plane),
        cmocka_unit_test(bent_strut_swings_under_a_follower),
        cmocka_unit_test(follower_along_the_rod_has_no_critical_point),
        cmocka_unit_test(deflection_control_passes_a_limit_load),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
