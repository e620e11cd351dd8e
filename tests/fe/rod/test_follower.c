/* The cantilever under a force normal to the wire, controlled by the force or by the deflection. */
#include "fe/trial/loading_steps.h"

#include "tests/fe/rod/wires.h"

/* A slender elastic wire, so that extension and shear are negligible: E A L^2 / E I = 4e6. */
static const double length = 0.1, diameter = 0.2e-3, youngs_modulus = 5e9;

static double bending_stiffness(void)
{
    return youngs_modulus * M_PI * pow(diameter, 4) / 64.0;
}

struct rig {
    struct wb_section section;
    struct wb_cantilever *cantilever;
};

static struct rig rig_of(struct wb_section section, double strand, double mass_per_length)
{
    struct rig rig = {.section = section};
    struct wb_cantilever_model model;
    wb_cantilever_default_model(&model);
    model.section = &rig.section;
    model.length = length;
    model.strand_length = strand;
    model.mass_per_length = mass_per_length;
    rig.cantilever = test_cantilever(&model);
    return rig;
}

static struct rig slender_rig(double strand, double mass_per_length)
{
    const struct wb_material elastic = {
        WB_HARDENING_NONE_ELASTIC, youngs_modulus, 0.3, 0.0, 0.0, 0.0};
    struct wb_section section;
    assert_int_equal(wb_section_init_circle(&section, diameter, &elastic, 0), WB_OK);
    return rig_of(section, strand, mass_per_length);
}

/* A stiff wire: copper core in a soft jacket, which yields at 6.2 N and then bends more and more,
 * only near the clamp. */
static struct rig composite_rig(void)
{
    const struct wb_material copper = {
        WB_HARDENING_ISOTROPIC_POWER, 68.2e9, 0.34, 182e6, 292e6, 0.31};
    const struct wb_material jacket = {WB_HARDENING_ISOTROPIC_POWER, 41e6, 0.43, 2e6, 12e6, 0.6};
    struct wb_section section;
    wb_section_init_empty(&section);
    assert_int_equal(wb_section_add_ring(&section, 0.0, 3.26e-3, &copper, 1.0, 0), WB_OK);
    assert_int_equal(wb_section_add_ring(&section, 3.26e-3, 4.86e-3, &jacket, 1.0, 0), WB_OK);
    return rig_of(section, 0.0, 0.0);
}

static void release_rig(struct rig *rig)
{
    wb_cantilever_destroy(rig->cantilever);
    wb_section_release(&rig->section);
}

/* a = F L^2 / E I, x/L, y/L, theta, M0 L / E I. */
static const double elastica[][5] = {
    {0.5, .983481, .165043, .249481, .496891},    {1., .935646, .320642, .495885, .975510},
    {2., .767362, .573839, .968239, 1.815366},    {3., .551665, .726685, 1.398656, 2.431321},
    {4., .342746, .786168, 1.776436, 2.798472},   {5., .172278, .780690, 2.098157, 2.939623},
    {6., .049502, .740274, 2.365547, 2.899234},   {8., -.073863, .633592, 2.756554, 2.451432},
    {10., -.092123, .546983, 2.992715, 1.722373}, {13.5, -.008965, .461168, 3.141018, .124611},
};

enum {
    ROWS = sizeof elastica / sizeof elastica[0],
    RISING = 5 /* number of rows before the maximum of y, slightly beyond a = 4 */
};

/* Errors of a point relative to a row; that of x over the length, because the tip passes x = 0. */
static void compare(const struct wb_cantilever_point *p, const double *row, double *worst,
                    double *aside)
{
    const double EI = bending_stiffness();
    *worst = fmax(*worst, fabs(p->deflection / length / row[2] - 1.0));
    *worst = fmax(*worst, fabs(p->tip_angle / row[3] - 1.0));
    *worst = fmax(*worst, fabs(p->root_moment * length / EI / row[4] - 1.0));
    *aside = fmax(*aside, fabs(p->tip_x / length - row[1]));
}

static void given_force_follows_the_elastica(void **unused)
{
    (void)unused;
    struct rig rig = slender_rig(0.0, 0.0);
    double worst = 0.0, aside = 0.0;
    for (int i = 0; i < ROWS; i++) {
        const double force = elastica[i][0] * bending_stiffness() / (length * length);
        const struct wb_cantilever_point p =
            test_move(rig.cantilever, WB_CONTROL_FOLLOWER_FORCE, force);
        compare(&p, elastica[i], &worst, &aside);
        assert_true(p.follower == force && p.control == force);
        assert_true(p.tension == 0.0 && p.vertical_force == 0.0);
    }
    print_message("by force: within %.4f %%, x within %.6f L\n", 100.0 * worst, aside);
    assert_true(worst < 2e-3);
    assert_true(aside < 2e-4);
    release_rig(&rig);
}

static void prescribed_deflection_gives_the_force_of_the_elastica(void **unused)
{
    (void)unused;
    struct rig rig = slender_rig(0.0, 0.0);
    double worst = 0.0, aside = 0.0;
    for (int i = 0; i < RISING; i++) {
        const struct wb_cantilever_point p =
            test_move(rig.cantilever, WB_CONTROL_FOLLOWER_DEFLECTION, elastica[i][2] * length);
        compare(&p, elastica[i], &worst, &aside);
        worst = fmax(
            worst, fabs(p.follower * length * length / bending_stiffness() / elastica[i][0] - 1.0));
        assert_true(p.tension == 0.0 && p.vertical_force == 0.0);
    }
    print_message("by deflection: within %.4f %%, x within %.6f L\n", 100.0 * worst, aside);
    assert_true(worst < 2e-3);
    assert_true(aside < 2e-4);

    /* The same in one step from the straight wire, and with both signs. */
    int iterations = 0;
    for (int sign = -1; sign <= 1; sign += 2) {
        wb_cantilever_reset(rig.cantilever);
        const struct wb_cantilever_point p = test_move(
            rig.cantilever, WB_CONTROL_FOLLOWER_DEFLECTION, sign * elastica[2][2] * length);
        assert_close_relative(p.follower * length * length / bending_stiffness(),
                              sign * elastica[2][0], 1e-4);
        iterations += p.iterations;
    }
    print_message("from straight to a = 2: %d iterations\n", iterations / 2);
    assert_true(iterations <= 2 * 9);
    release_rig(&rig);
}

/* Newton's method needs the exact tangent of loads that rotate with the tip. */
static void small_steps_need_two_iterations(void **unused)
{
    (void)unused;
    struct rig rig = slender_rig(0.0, 0.0);
    int iterations = 0;
    test_move(rig.cantilever, WB_CONTROL_FOLLOWER_DEFLECTION, 0.5 * length);
    for (int i = 1; i <= 20; i++)
        iterations +=
            test_move(rig.cantilever, WB_CONTROL_FOLLOWER_DEFLECTION, (0.5 + 0.001 * i) * length)
                .iterations;
    assert_true(iterations <= 2 * 20);
    release_rig(&rig);
}

static void deflection_and_force_control_agree(void **unused)
{
    (void)unused;
    struct rig rig = composite_rig();
    double force[20], x[20], angle[20];
    for (int i = 0; i < 20; i++) {
        const struct wb_cantilever_point p =
            test_move(rig.cantilever, WB_CONTROL_FOLLOWER_DEFLECTION, 4.55e-3 * (i + 1));
        force[i] = p.follower;
        x[i] = p.tip_x;
        angle[i] = p.tip_angle;
    }
    assert_true(force[19] > 3.0 * 6.2);
    wb_cantilever_reset(rig.cantilever);
    for (int i = 0; i < 20; i++) {
        const struct wb_cantilever_point p =
            test_move(rig.cantilever, WB_CONTROL_FOLLOWER_FORCE, force[i]);
        assert_close(p.deflection, 4.55e-3 * (i + 1), 1e-8);
        assert_close(p.tip_x, x[i], 1e-7);
        assert_close(p.tip_angle, angle[i], 1e-6);
    }
    release_rig(&rig);
}

/* The largest deflection of a virgin wire under the follower force, found in small steps of
 * force. */
static struct wb_cantilever_point farthest(struct wb_cantilever *cantilever, double first,
                                           double step)
{
    struct wb_cantilever_point before, p = test_move(cantilever, WB_CONTROL_FOLLOWER_FORCE, first);
    do {
        before = p;
        p = test_move(cantilever, WB_CONTROL_FOLLOWER_FORCE, before.follower + step);
    } while (p.deflection > before.deflection);
    return before;
}

static void deflection_beyond_the_maximum_does_not_converge(void **unused)
{
    (void)unused;
    for (int plastic = 0; plastic < 2; plastic++) {
        struct rig rig = plastic ? composite_rig() : slender_rig(0.0, 0.0);
        const double first = plastic ? 20.0 : 4.0 * bending_stiffness() / (length * length);
        struct wb_cantilever_point p;
        const struct wb_cantilever_point top = farthest(rig.cantilever, first, 1e-4 * first);
        assert_true(top.follower > 1.005 * first);

        wb_cantilever_reset(rig.cantilever);
        for (int mm = 1; mm * WB_MM < top.deflection; mm++)
            test_move(rig.cantilever, WB_CONTROL_FOLLOWER_DEFLECTION, mm * WB_MM);
        assert_int_equal(wb_cantilever_move(rig.cantilever, WB_CONTROL_FOLLOWER_DEFLECTION,
                                            1.01 * top.deflection, &p),
                         WB_OK);
        assert_int_equal(p.end, WB_CANTILEVER_NOT_CONVERGED);
        print_message("largest deflection %.5f mm at %.5g N, stopped at %.5f mm, %.5g N\n",
                      top.deflection / WB_MM, top.follower, p.deflection / WB_MM, p.follower);
        assert_close(p.deflection, top.deflection, 1e-5 * length);
        assert_true(p.deflection <= top.deflection + 1e-7 * length);
        assert_close_relative(p.follower, top.follower, 5e-3);

        /* It does not jump over the maximum in one step from the straight wire either. */
        wb_cantilever_reset(rig.cantilever);
        assert_int_equal(wb_cantilever_move(rig.cantilever, WB_CONTROL_FOLLOWER_DEFLECTION,
                                            1.3 * top.deflection, &p),
                         WB_OK);
        assert_int_equal(p.end, WB_CANTILEVER_NOT_CONVERGED);
        assert_true(p.deflection <= top.deflection + 1e-7 * length);
        assert_true(p.follower <= top.follower + 2e-4 * first);

        /* Deflections below the maximum are still reachable. */
        p = test_move(rig.cantilever, WB_CONTROL_FOLLOWER_FORCE, 0.0);
        assert_true(plastic ? p.deflection > 1e-3 : fabs(p.deflection) < 1e-9);
        release_rig(&rig);
    }
}

static void a_curled_wire_does_not_converge(void **unused)
{
    (void)unused;
    struct rig rig = composite_rig();
    struct wb_cantilever_point p;
    test_move(rig.cantilever, WB_CONTROL_FOLLOWER_FORCE, 20.0);
    const struct wb_cantilever_point curled =
        test_move(rig.cantilever, WB_CONTROL_FOLLOWER_FORCE, 23.0);
    for (int sign = -1; sign <= 1; sign += 2) {
        assert_int_equal(wb_cantilever_move(rig.cantilever, WB_CONTROL_FOLLOWER_DEFLECTION,
                                            curled.deflection + sign * WB_MM, &p),
                         WB_OK);
        assert_int_equal(p.end, WB_CANTILEVER_NOT_CONVERGED);
        assert_close(p.deflection, curled.deflection, 1e-9);
        assert_close_relative(p.follower, curled.follower, 1e-9);
    }
    release_rig(&rig);
}

static void perfectly_plastic_wire_rotates_about_its_hinge(void **unused)
{
    (void)unused;
    struct test_wire wire = test_wire_type(1);
    wire.material.strength_coefficient = 0.0;
    struct rig rig = rig_of(test_section(&wire), 0.0, 0.0);
    const double R = 0.5 * wire.diameter;
    const double moment = 4.0 / 3.0 * wire.material.yield_stress * R * R * R;
    struct wb_cantilever_point p;
    for (int i = 1; i <= 20; i++)
        p = test_move(rig.cantilever, WB_CONTROL_FOLLOWER_DEFLECTION, 0.025 * i * length);
    assert_close_relative(p.root_moment, moment, 1e-2); /* twenty fibres: 0.7 % */
    /* The lever of the force about the clamp is nearly the length. */
    assert_close_relative(p.follower, moment / length, 2e-2);
    release_rig(&rig);
}

static void weight_is_carried_at_zero_deflection(void **unused)
{
    (void)unused;
    const double w = 0.02 * bending_stiffness() / pow(length, 3);
    struct rig rig = slender_rig(0.0, w / WB_STANDARD_GRAVITY);
    const struct wb_cantilever_point p =
        test_move(rig.cantilever, WB_CONTROL_FOLLOWER_DEFLECTION, 0.0);
    assert_close_relative(p.follower, 3.0 / 8.0 * w * length, 1e-5);
    release_rig(&rig);
}

static void other_tip_loads_stay(void **unused)
{
    (void)unused;
    struct rig rig = slender_rig(0.0, 0.0);
    const double force = 0.8 * bending_stiffness() / (length * length);
    const struct wb_cantilever_point dead = test_move(rig.cantilever, WB_CONTROL_DEAD_FORCE, force);
    const struct wb_cantilever_point same =
        test_move(rig.cantilever, WB_CONTROL_FOLLOWER_DEFLECTION, dead.deflection);
    assert_close(same.follower, 0.0, 1e-8 * force);
    assert_true(same.tension == force);
    const struct wb_cantilever_point more =
        test_move(rig.cantilever, WB_CONTROL_FOLLOWER_DEFLECTION, 1.1 * dead.deflection);
    assert_true(more.follower > 0.0 && more.tension == force);
    release_rig(&rig);
}

static void strand_and_follower_exclude_each_other(void **unused)
{
    (void)unused;
    struct rig rig = slender_rig(0.76, 0.0);
    struct wb_cantilever_point p;
    wb_log_set_sink(discard_message, NULL);
    assert_int_equal(wb_cantilever_move(rig.cantilever, WB_CONTROL_FOLLOWER_DEFLECTION, 0.01, &p),
                     WB_ERR_ARGUMENT);
    wb_log_set_sink(NULL, NULL);
    release_rig(&rig);
}

static void loading_steps_report_the_follower_force(void **unused)
{
    (void)unused;
    const enum wb_cantilever_control controls[] = {WB_CONTROL_FOLLOWER_DEFLECTION,
                                                   WB_CONTROL_FOLLOWER_FORCE};
    for (int k = 0; k < 2; k++) {
        struct rig rig = composite_rig();
        const struct wb_loading_steps_plan plan = {
            .control = controls[k], .maximum = k == 0 ? 0.03 : 14.0, .steps = 10};
        struct wb_loading_steps h;
        assert_int_equal(wb_loading_steps_init(&h, &plan), WB_OK);
        assert_int_equal(wb_loading_steps_run(&h, &plan, rig.cantilever), WB_OK);
        assert_int_equal(h.n_rows, 11);
        assert_true(h.zero_force == 0.0);
        for (int i = 0; i < h.n_rows; i++)
            assert_true(h.rows[i].force == h.rows[i].point.follower);
        assert_true(h.rows[10].force > 13.9);
        wb_loading_steps_release(&h);
        release_rig(&rig);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(given_force_follows_the_elastica),
        cmocka_unit_test(prescribed_deflection_gives_the_force_of_the_elastica),
        cmocka_unit_test(small_steps_need_two_iterations),
        cmocka_unit_test(deflection_and_force_control_agree),
        cmocka_unit_test(deflection_beyond_the_maximum_does_not_converge),
        cmocka_unit_test(a_curled_wire_does_not_converge),
        cmocka_unit_test(perfectly_plastic_wire_rotates_about_its_hinge),
        cmocka_unit_test(weight_is_carried_at_zero_deflection),
        cmocka_unit_test(other_tip_loads_stay),
        cmocka_unit_test(strand_and_follower_exclude_each_other),
        cmocka_unit_test(loading_steps_report_the_follower_force),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
