/* Validation by tests left out, with synthetic curves whose laws are known. */
#include "analysis/validation/left_out.h"

#include <stdlib.h>

#include "base/units.h"
#include "fe/trial/three_point_bending.h"
#include "tests/check.h"

enum {
    TESTS = 3,
    POINTS = 60
};

static struct wb_three_point_calibration calibration;
static struct wb_three_point_member members[TESTS];

static void set_law(struct wb_law *law, double times)
{
    struct wb_law_part parts[WB_THREE_POINT_PARTS];
    for (int i = 0; i < WB_THREE_POINT_PARTS; i++)
        parts[i] = (struct wb_law_part){
            times * 1e9, i + 1 < WB_THREE_POINT_PARTS ? 1e-3 * pow(2.0, i) : (double)INFINITY};
    wb_law_init_parallel(law, parts, WB_THREE_POINT_PARTS, 0.0, 0.4);
}

/* The curve of a law, as points after a contact at `contact`. */
static void make_member(struct wb_three_point_member *m, double times, double contact)
{
    struct wb_section section = {0};
    struct wb_three_point_bending *bending;
    *m = (struct wb_three_point_member){.is_fitted = true};
    m->data.info.outer_diameter = 1e-3;
    m->data.info.length = 20e-3;
    m->data.info.machine.roller_radius = 2e-3;
    m->data.first_contact = contact;
    m->data.points = calloc(POINTS, sizeof *m->data.points);
    set_law(&m->fit.law, times);
    m->fit.first_contact = contact;
    assert_int_equal(wb_section_init_law(&section, 1e-3, &m->fit.law, 0), WB_OK);
    const struct wb_three_point_bending_model model = {.section = &section,
                                                       .diameter = 1e-3,
                                                       .span = 20e-3,
                                                       .support_radius = 2e-3,
                                                       .nose_radius = 2e-3,
                                                       .friction = 0.2,
                                                       .n_elements = 32};
    assert_int_equal(wb_three_point_bending_create(&bending, &model), WB_OK);
    wb_section_release(&section);
    for (int i = 0; i < POINTS; i++) {
        struct wb_three_point_bending_point point;
        assert_int_equal(wb_three_point_bending_move(bending, (0.2 + 0.05 * i) * WB_MM, &point),
                         WB_OK);
        assert_int_equal(point.end, WB_THREE_POINT_BENDING_CONVERGED);
        m->data.points[m->data.n_points++] =
            (struct wb_three_point_point){contact + point.travel, point.force, false};
    }
    wb_three_point_bending_destroy(bending);
}

static void make_tests(const double times[TESTS])
{
    calibration = (struct wb_three_point_calibration){.n_members = TESTS, .n_fitted = TESTS};
    calibration.members = members;
    calibration.bench = (struct wb_three_point_bench){.friction = 0.2, .nose_radius = 2e-3};
    for (int i = 0; i < TESTS; i++)
        make_member(&members[i], times[i], 0.3 * WB_MM * i);
}

static int release(void **state)
{
    (void)state;
    for (int i = 0; i < TESTS; i++) {
        free(members[i].data.points);
        members[i].data.points = NULL;
    }
    return 0;
}

static void equal_tests_are_predicted_by_each_other(void **state)
{
    (void)state;
    struct wb_left_out r;
    make_tests((const double[]){1.0, 1.0, 1.0});
    assert_int_equal(wb_left_out_run(&r, &calibration, 32, NULL), WB_OK);
    assert_int_equal(r.n, 3);
    assert_close(r.scatter / r.of_max_force, 0.0, 1e-9);
    assert_close(r.rms / r.of_max_force, 0.0, 2e-3);
    assert_close(r.bias / r.of_max_force, 0.0, 2e-3);
    assert_close(r.deflection[0], 0.2 * WB_MM, 1e-6);
    assert_close(r.deflection[WB_LEFT_OUT_GRID - 1], 3.15 * WB_MM, 1e-6);
}

/* Stiffnesses of 0.9, 1 and 1.1: s is 0.1 of the force. The error of a model without bias is the
 * difference between the test left out and the mean of the others. */
static void the_error_of_an_unbiased_model_is_the_scatter(void **state)
{
    (void)state;
    struct wb_left_out r;
    make_tests((const double[]){0.9, 1.0, 1.1});
    assert_int_equal(wb_left_out_run(&r, &calibration, 32, NULL), WB_OK);
    for (int k = 0; k < WB_LEFT_OUT_GRID; k += 8)
        assert_close_relative(r.deviation[k], 0.1 * r.mean[k], 1e-3);
    assert_close_relative(r.expected, sqrt(1.5) * r.scatter, 1e-12);
    assert_close_relative(r.rms, r.expected, 0.02);
    assert_true(r.bias < 0.05 * r.scatter);
}

/* Laws that are 30 % too stiff for their curves. */
static void a_wrong_law_gives_a_bias(void **state)
{
    (void)state;
    struct wb_left_out r;
    make_tests((const double[]){0.9, 1.0, 1.1});
    for (int i = 0; i < TESTS; i++)
        set_law(&members[i].fit.law, 1.3 * (0.9 + 0.1 * i));
    assert_int_equal(wb_left_out_run(&r, &calibration, 32, NULL), WB_OK);
    for (int k = 0; k < WB_LEFT_OUT_GRID; k += 8)
        assert_close_relative(r.offset[k], 0.3 * r.mean[k], 0.02);
    assert_true(r.bias > 2.5 * r.scatter);
    assert_close_relative(r.rms, hypot(r.expected, r.bias), 0.05);
}

static void the_contact_found_in_other_tests_shifts_the_model(void **state)
{
    (void)state;
    struct wb_left_out r;
    make_tests((const double[]){1.0, 1.0, 1.0});
    for (int i = 0; i < TESTS; i++)
        members[i].data.first_contact -= 0.05 * WB_MM; /* the readings show it too early */
    assert_int_equal(wb_left_out_run(&r, &calibration, 32, NULL), WB_OK);
    assert_close(r.bias / r.of_max_force, 0.0, 2e-3);
}

static void one_test_cannot_be_left_out(void **state)
{
    (void)state;
    struct wb_left_out r;
    struct wb_reason why;
    make_tests((const double[]){1.0, 1.0, 1.0});
    members[0].is_fitted = members[1].is_fitted = false;
    assert_int_equal(wb_left_out_run(&r, &calibration, 32, &why), WB_ERR_DATA);
    assert_non_null(strstr(why.text, "1 of 3"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(equal_tests_are_predicted_by_each_other, release),
        cmocka_unit_test_teardown(the_error_of_an_unbiased_model_is_the_scatter, release),
        cmocka_unit_test_teardown(a_wrong_law_gives_a_bias, release),
        cmocka_unit_test_teardown(the_contact_found_in_other_tests_shifts_the_model, release),
        cmocka_unit_test_teardown(one_test_cannot_be_left_out, release),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
