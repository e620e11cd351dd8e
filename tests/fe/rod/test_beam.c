#include "fe/rod/beam.h"

#include "fe/linear/banded.h"
#include "fe/rod/beam_private.h"
#include "tests/fe/rod/wires.h"

static struct wb_beam *make_beam(const struct wb_section *section, int n_elements)
{
    const struct wb_beam_model model = {
        .section = section, .length = 0.085, .n_elements = n_elements, .load_y = -0.04};
    struct wb_beam *beam = NULL;
    assert_int_equal(wb_beam_create(&beam, &model), WB_OK);
    return beam;
}

/* Loads the tip of the virgin beam, solves for equilibrium in one step of the history (approached
 * gradually), and returns the tip's position and condensed stiffness. */
static void load_tip(struct wb_beam *beam, const double *force, double *place, double *K)
{
    struct wb_beam_balance balance;
    double right[3];

    wb_beam_reset(beam);
    for (int i = 1; i <= 30; i++) {
        const double part = fmin(1.0, i / 20.0);
        wb_beam_evaluate(beam, 1.0, &balance);
        wb_beam_condense(beam, K);
        wb_beam_reduce(beam, beam, right);
        for (int k = 0; k < 3; k++)
            right[k] += part * force[k];
        double matrix[9];
        memcpy(matrix, K, sizeof matrix);
        wb_banded_solve_small(3, 3, matrix, right);
        wb_beam_advance(beam, beam, right, 0.5);
    }
    wb_beam_evaluate(beam, 1.0, &balance);
    wb_beam_condense(beam, K);
    assert_true(balance.largest_residual < 1e-8);
    place[0] = wb_beam_tip(beam)->x;
    place[1] = wb_beam_tip(beam)->y;
    place[2] = wb_beam_tip(beam)->t;
}

static void condensed_stiffness_is_the_derivative_of_the_tip_forces(void **unused)
{
    (void)unused;
    const struct test_wire wire = test_wire_type(3);
    struct wb_section s = test_section(&wire);
    struct wb_beam *beam = make_beam(&s, 8);
    const double EI = wire.material.youngs_modulus * M_PI * pow(wire.diameter, 4) / 64.0;
    const double force[3] = {0.02, 0.09, 1e-4};
    const double d[3] = {1e-5, 1e-5, 1e-6};
    double K[9], other_K[9], place[3], worst = 0.0;

    load_tip(beam, force, place, K);
    print_message("tip at %.4f, %.4f m, %.3f rad\n", place[0], place[1], place[2]);
    assert_true(wb_beam_point(beam, 0)->D22 < 0.7 * EI);
    for (int j = 0; j < 3; j++) {
        double side[2][3];
        for (int k = 0; k < 2; k++) {
            double changed[3] = {force[0], force[1], force[2]};
            changed[j] += k == 0 ? -d[j] : d[j];
            load_tip(beam, changed, side[k], other_K);
        }
        /* K times the change of position is the change of force. */
        for (int i = 0; i < 3; i++) {
            double sum = 0.0;
            for (int k = 0; k < 3; k++)
                sum += K[3 * i + k] * (side[1][k] - side[0][k]);
            const double unit = i == 2 ? 0.085 : 1.0;
            const double exact = i == j ? 2.0 * d[j] : 0.0;
            worst = fmax(worst, fabs(sum - exact) / unit / (2.0 * d[j] / (j == 2 ? 0.085 : 1.0)));
        }
    }
    print_message("condensed tangent against differences: %.2g\n", worst);
    assert_true(worst < 1e-3);
    wb_beam_destroy(beam);
    wb_section_release(&s);
}

static double arc_curvature(void *context, double s)
{
    (void)s;
    return *(const double *)context;
}

static double wavy_curvature(void *context, double s)
{
    return *(const double *)context * cos(60.0 * s);
}

/* Data of a rejected trial state must not enter the next evaluation. */
static void rejected_trial_state_has_no_effect(void **unused)
{
    (void)unused;
    const struct test_wire wire = test_wire_type(3);
    struct wb_section s = test_section(&wire);
    struct wb_beam *beam = make_beam(&s, 8);
    const double force[3] = {0.02, 0.09, 1e-4}, far[3] = {-2e-3, 3e-3, 0.1};
    struct wb_beam_balance before, after;
    double K[9], right[3], place[3];

    load_tip(beam, force, place, K);
    wb_beam_commit(beam);
    for (int way = 0; way < 2; way++) {
        wb_beam_revert(beam);
        wb_beam_evaluate(beam, 1.0, &before);
        wb_beam_condense(beam, K);
        wb_beam_reduce(beam, beam, right);
        if (way == 1)
            wb_beam_save(beam);
        wb_beam_advance(beam, beam, far, 0.5);
        wb_beam_evaluate(beam, 1.0, &after);
        assert_true(after.largest_residual > 10.0 * before.largest_residual);
        if (way == 1)
            wb_beam_restore(beam);
        else
            wb_beam_revert(beam);
        wb_beam_evaluate(beam, 1.0, &after);
        assert_memory_equal(&after, &before, sizeof after);
    }
    wb_beam_destroy(beam);
    wb_section_release(&s);
}

static void natural_curvature_is_free_of_stress(void **unused)
{
    (void)unused;
    const struct test_wire wire = test_wire_type(1);
    struct wb_section s = test_section(&wire);
    double curvature = 12.0;
    struct wb_beam_model model = {.section = &s,
                                  .length = 0.085,
                                  .n_elements = 50,
                                  .natural_curvature = wavy_curvature,
                                  .curvature_context = &curvature};
    struct wb_beam *beam = NULL;
    struct wb_beam_balance balance;
    assert_int_equal(wb_beam_create(&beam, &model), WB_OK);
    wb_beam_evaluate(beam, 1.0, &balance);
    assert_true(balance.largest_force == 0.0);
    assert_true(balance.largest_residual == 0.0);

    /* The reference is the integral of the curvature: t = c sin(60 s) / 60, here by fine sums. */
    enum {
        FINE = 170000
    };
    double x = 0.0, y = 0.0;
    for (int i = 0; i < FINE; i++) {
        const double t = curvature * sin(60.0 * 0.085 * (i + 0.5) / FINE) / 60.0;
        x += 0.085 / FINE * cos(t);
        y += 0.085 / FINE * sin(t);
    }
    assert_close(wb_beam_reference_tip(beam)->x, x, 1e-10);
    assert_close(wb_beam_reference_tip(beam)->y, y, 1e-10);
    assert_close(wb_beam_reference_tip(beam)->t, curvature * sin(60.0 * 0.085) / 60.0, 1e-10);
    wb_beam_destroy(beam);

    /* The reference of a constant curvature is an arc. */
    model.natural_curvature = arc_curvature;
    assert_int_equal(wb_beam_create(&beam, &model), WB_OK);
    for (int i = 0; i <= 20; i++) {
        const double at = 0.085 * i / 20;
        const struct wb_beam_node node = wb_beam_position(beam, at);
        assert_close(node.t, curvature * at, 1e-12);
        assert_close(node.x, sin(curvature * at) / curvature, 1e-8);
        assert_close(node.y, (1.0 - cos(curvature * at)) / curvature, 1e-8);
    }
    wb_beam_destroy(beam);
    wb_section_release(&s);
}

static void advance_does_not_stretch_a_rotating_beam(void **unused)
{
    (void)unused;
    const struct test_wire wire = test_wire_type(1);
    struct wb_section s = test_section(&wire);
    const struct wb_beam_model model = {.section = &s, .length = 0.085, .n_elements = 50};
    struct wb_beam *beam = NULL;
    assert_int_equal(wb_beam_create(&beam, &model), WB_OK);

    struct wb_beam_balance balance;
    double K[9], right[3];
    wb_beam_evaluate(beam, 1.0, &balance);
    wb_beam_condense(beam, K);
    wb_beam_reduce(beam, beam, right);
    /* Moved sideways by a third of its length in one linear step. */
    const double tip[3] = {0.0, 0.03, 0.5};
    wb_beam_advance(beam, beam, tip, 1.0);
    wb_beam_evaluate(beam, 1.0, &balance);
    for (int g = 0; g < 100; g++)
        assert_close(wb_beam_point(beam, g)->a, 1.0, 1e-9);
    wb_beam_destroy(beam);
    wb_section_release(&s);
}

static void load_adds_up_to_weight(void **unused)
{
    (void)unused;
    const struct test_wire wire = test_wire_type(1);
    struct wb_section s = test_section(&wire);
    struct wb_beam *beam = make_beam(&s, 7);
    struct wb_beam_balance balance;
    wb_beam_evaluate(beam, 1.0, &balance);
    /* Straight and unstrained: the tip has its consistent share, a sixth of the last element. */
    assert_close_relative(balance.tip[1], 0.04 * 0.085 / 7.0 / 6.0, 1e-12);
    assert_close_relative(balance.largest_residual, 0.04 * 0.085 / 7.0 * 4.0 / 6.0, 1e-12);
    wb_beam_destroy(beam);
    wb_section_release(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(condensed_stiffness_is_the_derivative_of_the_tip_forces),
        cmocka_unit_test(rejected_trial_state_has_no_effect),
        cmocka_unit_test(natural_curvature_is_free_of_stress),
        cmocka_unit_test(advance_does_not_stretch_a_rotating_beam),
        cmocka_unit_test(load_adds_up_to_weight),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
