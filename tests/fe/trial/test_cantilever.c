#include "fe/trial/cantilever.h"

#include <stdlib.h>

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

static struct rig slender_rig(int n_elements)
{
    const struct wb_material elastic = {
        WB_HARDENING_NONE_ELASTIC, youngs_modulus, 0.3, 0.0, 0.0, 0.0};
    struct rig rig;
    struct wb_cantilever_model model;
    assert_int_equal(wb_section_init_circle(&rig.section, diameter, &elastic, 0), WB_OK);
    wb_cantilever_default_model(&model);
    model.section = &rig.section;
    model.length = length;
    model.n_elements = n_elements;
    rig.cantilever = test_cantilever(&model);
    return rig;
}

static struct rig wire_rig(const struct test_wire *wire)
{
    struct rig rig = {.section = test_section(wire)};
    struct wb_cantilever_model model;
    wb_cantilever_default_model(&model);
    model.section = &rig.section;
    model.length = 0.085;
    rig.cantilever = test_cantilever(&model);
    return rig;
}

static void release_rig(struct rig *rig)
{
    wb_cantilever_destroy(rig->cantilever);
    wb_section_release(&rig->section);
}

static void small_deflection_is_that_of_euler_and_bernoulli(void **unused)
{
    (void)unused;
    struct rig rig = slender_rig(0);
    const double delta = 1e-4 * length;
    const struct wb_cantilever_point p = test_move(rig.cantilever, WB_CONTROL_DEFLECTION, delta);
    assert_close_relative(p.tension, 3.0 * bending_stiffness() * delta / pow(length, 3), 1e-5);
    assert_close_relative(p.tip_angle, 1.5 * delta / length, 1e-5);
    assert_close_relative(p.root_moment, p.tension * length, 1e-5);
    release_rig(&rig);
}

static void stout_wire_shears_like_timoshenkos(void **unused)
{
    (void)unused;
    const double L = 0.03, d = 0.01, delta = 1e-6;
    const struct wb_material m = {WB_HARDENING_NONE_ELASTIC, 5e9, 0.3, 0.0, 0.0, 0.0};
    struct wb_section section;
    struct wb_cantilever_model model;
    assert_int_equal(wb_section_init_circle(&section, d, &m, 0), WB_OK);
    wb_cantilever_default_model(&model);
    model.section = &section;
    model.length = L;
    struct wb_cantilever *c = test_cantilever(&model);
    const double EI = m.youngs_modulus * M_PI * pow(d, 4) / 64.0;
    const double GA = wb_section_shear_modulus(&m) * M_PI * d * d / 4.0;
    const double force = delta / (L * L * L / (3.0 * EI) + L / GA);
    assert_close_relative(test_move(c, WB_CONTROL_DEFLECTION, delta).tension, force, 1e-6);
    wb_cantilever_destroy(c);
    wb_section_release(&section);
}

/* Mattiasson 1981, IJNME 17:145: a = P L^2 / E I, w/L, u/L, theta. */
static const double dead_load[][4] = {
    {0.2, .066364, .002647, .099636},  {0.4, .130975, .010354, .197155},
    {0.6, .192350, .022488, .290738},  {0.8, .249452, .038166, .379063},
    {1.0, .301721, .056433, .461352},  {1.5, .410978, .107942, .639540},
    {2.0, .493457, .160642, .781750},  {2.5, .555659, .209958, .894997},
    {3.0, .603253, .254420, .986017},  {4.0, .669964, .328941, 1.121239},
    {5.0, .713792, .387628, 1.215368}, {6.0, .744571, .434589, 1.283697},
    {8.0, .784982, .504828, 1.374432}, {10., .810609, .554996, 1.430286},
};

static void dead_load_follows_mattiasson(void **unused)
{
    (void)unused;
    struct rig rig = slender_rig(0);
    double worst = 0.0;
    for (size_t i = 0; i < sizeof dead_load / sizeof dead_load[0]; i++) {
        const double *row = dead_load[i];
        const double force = row[0] * bending_stiffness() / (length * length);
        const struct wb_cantilever_point p =
            test_move(rig.cantilever, WB_CONTROL_DEAD_FORCE, force);
        worst = fmax(worst, fabs(p.deflection / length / row[1] - 1.0));
        worst = fmax(worst, fabs((1.0 - p.tip_x / length) / row[2] - 1.0));
        worst = fmax(worst, fabs(p.tip_angle / row[3] - 1.0));
        assert_close_relative(p.tension, force, 1e-14);
        assert_close_relative(p.root_moment, force * p.tip_x, 1e-6);
    }
    print_message("dead load: within %.4f %% of Mattiasson\n", 100.0 * worst);
    assert_true(worst < 2e-3);
    release_rig(&rig);
}

static void end_moment_rolls_the_wire_into_a_circle(void **unused)
{
    (void)unused;
    struct rig rig = slender_rig(0);
    const double moment = 2.0 * M_PI * bending_stiffness() / length;
    const struct wb_cantilever_point p = test_move(rig.cantilever, WB_CONTROL_TIP_MOMENT, moment);
    print_message("roll-up: tip at (%.2g, %.2g) L, turned by 2 pi %+.1g, %d iterations\n",
                  p.tip_x / length, p.deflection / length, p.tip_angle - 2.0 * M_PI, p.iterations);
    assert_close(p.tip_x, 0.0, 1e-5 * length);
    assert_close(p.deflection, 0.0, 1e-5 * length);
    assert_close(p.tip_angle, 2.0 * M_PI, 1e-6);
    /* All nodes are on the circle, including middle nodes; the highest point is at L / pi. */
    const double radius = 0.5 * length / M_PI;
    for (int i = 0; i <= 100; i++) {
        const double s = 0.01 * i * length, turn = 2.0 * M_PI * 0.01 * i;
        double x, y, angle;
        wb_cantilever_shape(rig.cantilever, 1, &s, &x, &y, &angle);
        assert_close(angle, turn, 1e-6);
        assert_close(x, radius * sin(turn), 2e-5 * length);
        assert_close(y, radius * (1.0 - cos(turn)), 2e-5 * length);
    }
    assert_close_relative(p.root_moment, moment, 1e-6);
    release_rig(&rig);
}

static void force_converges_with_fourth_order(void **unused)
{
    (void)unused;
    const int counts[] = {4, 8, 16, 32};
    double force[4], exact;
    struct rig fine = slender_rig(256);
    exact = test_move(fine.cantilever, WB_CONTROL_DEFLECTION, 0.6 * length).tension;
    release_rig(&fine);
    for (int i = 0; i < 4; i++) {
        struct rig rig = slender_rig(counts[i]);
        force[i] = test_move(rig.cantilever, WB_CONTROL_DEFLECTION, 0.6 * length).tension;
        release_rig(&rig);
    }
    for (int i = 1; i < 4; i++) {
        const double order = log2(fabs(force[i - 1] - exact) / fabs(force[i] - exact));
        print_message("elements %d to %d: order %.2f\n", counts[i - 1], counts[i], order);
        assert_true(order > 3.7 && order < 4.5);
    }
}

static void prager_and_hodge_cantilever_up_to_collapse(void **unused)
{
    (void)unused;
    /* Perfectly plastic rectangle (Prager and Hodge 1951). Small displacements: the numbers are
     * chosen for a deflection of 1e-3 L. */
    enum {
        STRIPS = 200
    };
    const double height = 1e-3, width = 1e-3, L = 0.1, E = 5e9;
    const double EI = E * width * pow(height, 3) / 12.0;
    const double delta = 1e-3 * L;
    const double P_yield = 3.0 * EI * delta / pow(L, 3) / (20.0 / 9.0);
    struct wb_material m = {WB_HARDENING_ISOTROPIC_POWER, E, 0.3, 0.0, 0.0, 1.0};
    m.yield_stress = P_yield * L * 0.5 * height * E / EI;
    struct wb_fibre fibres[STRIPS];
    for (int i = 0; i < STRIPS; i++)
        fibres[i] =
            (struct wb_fibre){height * ((i + 0.5) / STRIPS - 0.5), width * height / STRIPS, 0};
    const struct wb_section section = {STRIPS, fibres, 1, &m, 1e3 * E * width * height};
    struct wb_cantilever_model model;
    wb_cantilever_default_model(&model);
    model.section = &section;
    model.length = L;
    model.n_elements = 400;
    struct wb_cantilever *c = test_cantilever(&model);

    const struct wb_cantilever_point yield = test_move(c, WB_CONTROL_DEAD_FORCE, 0.999 * P_yield);
    const double delta_yield = yield.deflection / 0.999;
    /* delta / delta_y = (Py / P)^2 (5 - (3 + P / Py) sqrt(3 - 2 P / Py)): 20/9 at 1.5 Py. */
    const double loads[] = {1.1, 1.2, 1.3, 1.4, 1.45, 1.49, 1.4985};
    double worst = 0.0;
    for (size_t i = 0; i < sizeof loads / sizeof loads[0]; i++) {
        const double P = loads[i];
        const double exact = (5.0 - (3.0 + P) * sqrt(3.0 - 2.0 * P)) / (P * P);
        const struct wb_cantilever_point p = test_move(c, WB_CONTROL_DEAD_FORCE, P * P_yield);
        worst = fmax(worst, fabs(p.deflection / delta_yield / exact - 1.0));
    }
    print_message("Prager and Hodge: within %.3f %% up to 0.999 of the collapse load\n",
                  100.0 * worst);
    assert_true(worst < 2e-3);
    wb_cantilever_destroy(c);
}

static void overload_of_a_perfectly_plastic_wire_does_not_converge(void **unused)
{
    (void)unused;
    struct test_wire wire = test_wire_type(1);
    wire.material.strength_coefficient = 0.0;
    struct rig rig = wire_rig(&wire);
    struct wb_cantilever_point p;
    const double R = 0.5 * wire.diameter;
    const double moment = 4.0 / 3.0 * wire.material.yield_stress * R * R * R;

    /* An end moment above the plastic moment: no equilibrium. The state stays below it. */
    assert_int_equal(wb_cantilever_move(rig.cantilever, WB_CONTROL_TIP_MOMENT, 1.2 * moment, &p),
                     WB_OK);
    assert_int_equal(p.end, WB_CANTILEVER_NOT_CONVERGED);
    assert_true(p.control < 1.01 * moment && p.control > 0.95 * moment);
    assert_close_relative(p.root_moment, p.control, 1e-4);
    /* And it can be unloaded from there. */
    p = test_move(rig.cantilever, WB_CONTROL_TIP_MOMENT, 0.0);
    assert_close(p.root_moment, 0.0, 1e-6 * moment);
    assert_true(p.tip_angle > 0.0);
    release_rig(&rig);
}

static void closed_cycle_dissipates_only_when_plastic(void **unused)
{
    (void)unused;
    for (int plastic = 0; plastic < 2; plastic++) {
        struct test_wire wire = test_wire_type(3);
        if (!plastic)
            wire.material.hardening = WB_HARDENING_NONE_ELASTIC;
        struct rig rig = wire_rig(&wire);
        double work = 0.0, loading = 0.0, last_force = 0.0, last = 0.0;
        for (int i = 1; i <= 2 * 106; i++) {
            const double y = (i <= 106 ? i : 212 - i) * 0.5e-3;
            const double force = test_move(rig.cantilever, WB_CONTROL_DEFLECTION, y).tension;
            work += 0.5 * (force + last_force) * (y - last);
            last_force = force;
            last = y;
            if (i == 106)
                loading = work;
        }
        assert_true(loading > 0.0);
        if (plastic)
            assert_true(work > 0.3 * loading);
        else
            assert_close(work, 0.0, 1e-6 * loading);
        release_rig(&rig);
    }
}

static void same_moves_give_the_same_bits(void **unused)
{
    (void)unused;
    const struct test_wire wire = test_wire_type(2);
    struct rig one = wire_rig(&wire), two = wire_rig(&wire);
    for (int i = 0; i <= 40; i++) {
        const double y = (i <= 20 ? i : 40 - i) * 2e-3;
        const struct wb_cantilever_point a = test_move(one.cantilever, WB_CONTROL_DEFLECTION, y);
        const struct wb_cantilever_point b = test_move(two.cantilever, WB_CONTROL_DEFLECTION, y);
        assert_true(a.tension == b.tension && a.tip_x == b.tip_x && a.tip_angle == b.tip_angle);
    }
    /* Also after a reset. */
    wb_cantilever_reset(one.cantilever);
    wb_cantilever_reset(two.cantilever);
    const double reset = test_move(one.cantilever, WB_CONTROL_DEFLECTION, 0.02).tension;
    release_rig(&one);
    one = wire_rig(&wire);
    assert_true(test_move(one.cantilever, WB_CONTROL_DEFLECTION, 0.02).tension == reset);
    release_rig(&one);
    release_rig(&two);
}

static void trial_move_can_be_undone(void **unused)
{
    (void)unused;
    const struct test_wire wire = test_wire_type(1);
    struct rig rig = wire_rig(&wire);
    test_move(rig.cantilever, WB_CONTROL_DEFLECTION, 0.01);
    test_move(rig.cantilever, WB_CONTROL_DEFLECTION, 0.011);
    wb_cantilever_save(rig.cantilever);
    const double first = test_move(rig.cantilever, WB_CONTROL_DEFLECTION, 0.012).tension;
    test_move(rig.cantilever, WB_CONTROL_DEFLECTION, 0.05);
    test_move(rig.cantilever, WB_CONTROL_DEFLECTION, -0.02);
    wb_cantilever_restore(rig.cantilever);
    assert_true(test_move(rig.cantilever, WB_CONTROL_DEFLECTION, 0.012).tension == first);
    release_rig(&rig);
}

static void replaced_material_acts_like_a_new_wire(void **unused)
{
    (void)unused;
    struct test_wire wire = test_wire_type(1), other = wire;
    other.material = test_wire_type(2).material;
    struct rig rig = wire_rig(&wire), fresh = wire_rig(&other);
    test_move(rig.cantilever, WB_CONTROL_DEFLECTION, 0.03);
    wb_cantilever_set_materials(rig.cantilever, &other.material);
    wb_cantilever_reset(rig.cantilever);
    assert_close_relative(test_move(rig.cantilever, WB_CONTROL_DEFLECTION, 0.03).tension,
                          test_move(fresh.cantilever, WB_CONTROL_DEFLECTION, 0.03).tension, 1e-12);
    release_rig(&rig);
    release_rig(&fresh);
}

static int messages;

static void count_message(void *context, enum wb_log_level level, const char *domain,
                          const char *message)
{
    (void)context;
    (void)level;
    (void)domain;
    (void)message;
    messages++;
}

static void assert_rejected(const struct wb_cantilever_model *model)
{
    struct wb_cantilever *c = NULL;
    const int before = messages;
    assert_int_equal(wb_cantilever_create(&c, model, NULL), WB_ERR_ARGUMENT);
    assert_null(c);
    assert_int_equal(messages, before + 1);
}

static double broken_curvature(void *context, double s)
{
    (void)context;
    return s > 0.05 ? (double)NAN : 0.0;
}

static void invalid_models_and_moves_are_rejected(void **unused)
{
    (void)unused;
    const struct test_wire wire = test_wire_type(1);
    struct rig rig = wire_rig(&wire);
    struct wb_cantilever_point p;
    wb_log_set_sink(count_message, NULL);

    for (int i = 0; i < 8; i++) {
        struct wb_cantilever_model m;
        wb_cantilever_default_model(&m);
        m.section = i == 0 ? NULL : &rig.section;
        m.length = i == 1 ? 0.0 : 0.085;
        m.n_elements = i == 2 ? -1 : 0;
        m.strand_length = i == 3 ? -1.0 : 0.0;
        m.counterweight = i == 4 ? (double)NAN : 0.0;
        m.has_rest = i == 5; /* without a strand */
        m.gravity_x = i == 6 ? (double)INFINITY : 0.0;
        m.natural_curvature = i == 7 ? broken_curvature : NULL;
        assert_rejected(&m);
    }
    assert_int_equal(wb_cantilever_move(rig.cantilever, WB_CONTROL_STAGE, 0.01, &p),
                     WB_ERR_ARGUMENT);
    assert_int_equal(wb_cantilever_move(rig.cantilever, WB_CONTROL_DEFLECTION, (double)NAN, &p),
                     WB_ERR_ARGUMENT);
    wb_log_set_sink(NULL, NULL);
    release_rig(&rig);
}

/* A Zener wire held at a small deflection: the force decays to the relaxed wire's, in one step as
 * well as in the sub-steps of a strong bend. */
static void a_held_tip_relaxes_exponentially(void **unused)
{
    (void)unused;
    const double relaxing = 0.4 * youngs_modulus, tau = 7.0, delta = 1e-4 * length;
    const struct wb_law_part part = {youngs_modulus, (double)INFINITY};
    const double stiffness = 3.0 * bending_stiffness() / pow(length, 3);
    struct wb_cantilever_model model;
    struct wb_section section;
    struct wb_law law;
    wb_law_init_parallel(&law, &part, 1, 0.0, 0.3);
    law.n_maxwell = 1;
    law.maxwell[0] = (struct wb_law_maxwell){relaxing, tau};
    assert_int_equal(wb_section_init_law(&section, diameter, &law, 0), WB_OK);
    wb_cantilever_default_model(&model);
    model.section = &section;
    model.length = length;
    struct wb_cantilever *const c = test_cantilever(&model);

    wb_cantilever_set_duration(c, 0.0);
    double force = test_move(c, WB_CONTROL_DEFLECTION, delta).tension;
    assert_close_relative(force, stiffness * delta * 1.4, 1e-5);
    wb_cantilever_set_duration(c, 5.0);
    force = test_move(c, WB_CONTROL_DEFLECTION, delta).tension;
    assert_close_relative(force, stiffness * delta * (1.0 + 0.4 * exp(-5.0 / tau)), 1e-5);
    wb_cantilever_set_duration(c, (double)INFINITY);
    force = test_move(c, WB_CONTROL_DEFLECTION, delta).tension;
    assert_close_relative(force, stiffness * delta, 1e-5);

    /* The duration of a long move is the sum of those of its sub-steps. */
    double forces[2];
    for (int i = 0; i < 2; i++) {
        const int n = i == 0 ? 1 : 40;
        wb_cantilever_reset(c);
        wb_cantilever_set_duration(c, 20.0 / n);
        for (int k = 1; k <= n; k++)
            forces[i] = test_move(c, WB_CONTROL_DEFLECTION, 0.6 * length * k / n).tension;
    }
    assert_close_relative(forces[0], forces[1], 0.02);
    wb_cantilever_destroy(c);
    wb_section_release(&section);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(small_deflection_is_that_of_euler_and_bernoulli),
        cmocka_unit_test(stout_wire_shears_like_timoshenkos),
        cmocka_unit_test(dead_load_follows_mattiasson),
        cmocka_unit_test(end_moment_rolls_the_wire_into_a_circle),
        cmocka_unit_test(force_converges_with_fourth_order),
        cmocka_unit_test(prager_and_hodge_cantilever_up_to_collapse),
        cmocka_unit_test(overload_of_a_perfectly_plastic_wire_does_not_converge),
        cmocka_unit_test(closed_cycle_dissipates_only_when_plastic),
        cmocka_unit_test(same_moves_give_the_same_bits),
        cmocka_unit_test(trial_move_can_be_undone),
        cmocka_unit_test(a_held_tip_relaxes_exponentially),
        cmocka_unit_test(replaced_material_acts_like_a_new_wire),
        cmocka_unit_test(invalid_models_and_moves_are_rejected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
