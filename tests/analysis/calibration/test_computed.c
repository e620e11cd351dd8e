#include "tests/analysis/beam_data.h"

#include "analysis/dataset/errors.h"
#include "fe/rod/section.h"
#include "fe/trial/cantilever.h"

static const double mm = WB_MM;

static void the_curve_is_that_of_the_cantilever_with_zeroed_force(void **state)
{
    (void)state;
    const struct wb_test_info info = beam_info(2, 0.085, 2.0 * mm);
    const struct wb_material material = beam_material(2);
    const struct wb_computed_settings settings = {.n_elements = BEAM_ELEMENTS};
    struct wb_computed *computed;
    double force[54];
    int reached;
    assert_int_equal(wb_computed_create(&computed, &info, &material, &settings), WB_OK);
    assert_int_equal(wb_computed_curve(computed, &material, 54, 1.0 * mm, force, &reached), WB_OK);
    assert_int_equal(reached, 54);
    assert_close(force[0], 0.0, 0.0);

    struct wb_section section;
    struct wb_cantilever_model model;
    struct wb_cantilever *cantilever;
    struct wb_cantilever_point zero, point;
    assert_int_equal(wb_section_init_circle(&section, info.outer_diameter, &material, 0), WB_OK);
    wb_cantilever_default_model(&model);
    model.section = &section;
    model.length = info.length;
    model.n_elements = BEAM_ELEMENTS;
    model.natural_curvature = wb_dataset_natural_curvature;
    model.curvature_context = (void *)&info;
    model.strand_length = info.strand_length;
    model.counterweight = info.counterweight;
    model.mass_per_length = info.mass_per_length;
    model.gravity_y = -info.gravity;
    assert_int_equal(wb_cantilever_create(&cantilever, &model, NULL), WB_OK);
    assert_int_equal(wb_cantilever_move(cantilever, WB_CONTROL_DEFLECTION, 0.0, &zero), WB_OK);
    assert_int_equal(wb_cantilever_move(cantilever, WB_CONTROL_DEFLECTION, 53.0 * mm, &point),
                     WB_OK);
    /* The strand carries the counterweight and some of the weight at zero deflection. */
    assert_true(zero.vertical_force > 0.5 * info.counterweight * info.gravity);
    assert_close_relative(force[53], point.vertical_force - zero.vertical_force, 1e-6);
    wb_cantilever_destroy(cantilever);
    wb_section_release(&section);
    wb_computed_destroy(computed);
}

static void each_run_starts_from_the_virgin_wire(void **state)
{
    (void)state;
    const struct wb_test_info info = beam_info(0, 0.1, 0.0);
    const struct wb_material material = beam_material(0), other = beam_material(1);
    const struct wb_computed_settings settings = {.n_elements = BEAM_ELEMENTS};
    struct wb_computed *computed;
    double first[54], between[54], again[54];
    int reached;
    assert_int_equal(wb_computed_create(&computed, &info, &material, &settings), WB_OK);
    assert_int_equal(wb_computed_curve(computed, &material, 54, mm, first, &reached), WB_OK);
    assert_int_equal(wb_computed_curve(computed, &other, 54, mm, between, &reached), WB_OK);
    assert_int_equal(wb_computed_curve(computed, &material, 54, mm, again, &reached), WB_OK);
    assert_memory_equal(first, again, sizeof first);
    assert_true(fabs(between[53] - first[53]) > 0.01 * first[53]);
    wb_computed_destroy(computed);
}

/* The curve must include the bench's weight and strand; otherwise calibration would fit them into K
 * and n. */
static void loading_of_the_test_is_in_the_curve(void **state)
{
    (void)state;
    const struct wb_material material = beam_material(2);
    const struct wb_computed_settings settings = {.n_elements = BEAM_ELEMENTS};
    double force[2][54];
    int reached;
    for (int i = 0; i < 2; i++) {
        struct wb_test_info info = beam_info(2, 0.085, 0.0);
        struct wb_computed *computed;
        if (i == 1)
            info.strand_length = info.counterweight = info.gravity = 0.0;
        assert_int_equal(wb_computed_create(&computed, &info, &material, &settings), WB_OK);
        assert_int_equal(wb_computed_curve(computed, &material, 54, mm, force[i], &reached), WB_OK);
        assert_int_equal(reached, 54);
        wb_computed_destroy(computed);
    }
    const double change = force[0][53] / force[1][53] - 1.0;
    assert_true(fabs(change) > 0.005 && fabs(change) < 0.2);
}

/* The effect of a bow is several times the RMS error of a calibration. */
static void a_bow_of_three_millimetres_changes_the_curve(void **state)
{
    (void)state;
    for (int i = 0; i < 6; i++) {
        const int type = i / 2;
        const struct wb_material material = beam_material(type);
        const struct wb_test_info info = beam_info(type, 0.085, i % 2 ? 3.0 * mm : -3.0 * mm);
        double force[2][54], error[54];
        int reached;
        for (int k = 0; k < 2; k++) {
            const struct wb_computed_settings settings = {.straight = k == 1,
                                                          .n_elements = BEAM_ELEMENTS};
            struct wb_computed *computed;
            assert_int_equal(wb_computed_create(&computed, &info, &material, &settings), WB_OK);
            assert_int_equal(wb_computed_curve(computed, &material, 54, mm, force[k], &reached),
                             WB_OK);
            wb_computed_destroy(computed);
        }
        wb_errors_curve(54, force[0], force[1], force[0][53], error);
        const double rms = wb_errors_rms(54, error);
        assert_true(rms > 0.02 && rms < 0.05);
    }
}

static void a_curve_that_does_not_converge_ends_in_nan(void **state)
{
    (void)state;
    const struct wb_test_info info = beam_info(0, 0.085, 0.0);
    struct wb_material material = beam_material(0);
    const struct wb_computed_settings settings = {.n_elements = BEAM_ELEMENTS};
    struct wb_computed *computed;
    double force[54];
    int reached;
    assert_int_equal(wb_computed_create(&computed, &info, &material, &settings), WB_OK);
    /* The beam converges for any real material, so the strength is not a number. */
    material.strength_coefficient = (double)NAN;
    assert_int_equal(wb_computed_curve(computed, &material, 54, mm, force, &reached), WB_OK);
    assert_true(reached > 1 && reached < 10);
    for (int i = 0; i < 54; i++)
        assert_true(isfinite(force[i]) == (i < reached));
    wb_computed_destroy(computed);
    wb_computed_destroy(NULL);
}

static void a_strand_that_is_slack_at_zero_is_rejected(void **state)
{
    (void)state;
    const struct wb_test_info info = beam_info(2, 0.085, 12.0 * mm);
    const struct wb_material material = beam_material(2);
    const struct wb_computed_settings settings = {.n_elements = BEAM_ELEMENTS};
    struct wb_computed *computed;
    bool reached;
    keep_messages();
    assert_int_equal(wb_computed_create(&computed, &info, &material, &settings), WB_OK);
    assert_int_equal(wb_computed_start(computed, &material, &reached), WB_ERR_DATA);
    assert_message("slack");
    wb_computed_destroy(computed);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_curve_is_that_of_the_cantilever_with_zeroed_force),
        cmocka_unit_test(each_run_starts_from_the_virgin_wire),
        cmocka_unit_test(loading_of_the_test_is_in_the_curve),
        cmocka_unit_test(a_bow_of_three_millimetres_changes_the_curve),
        cmocka_unit_test(a_curve_that_does_not_converge_ends_in_nan),
        cmocka_unit_test(a_strand_that_is_slack_at_zero_is_rejected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
