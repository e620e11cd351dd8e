#include "tests/analysis/beam_data.h"

#include "analysis/calibration/paper/scatter.h"

static const double mm = WB_MM;
static const struct wb_computed_settings settings = {.n_elements = BEAM_ELEMENTS};

/* Residual scatter of three samples with these bows and factors on the force. */
static double scatter_of(const double bow[3], const double factor[3], double *whole)
{
    const struct wb_material material = beam_material(1);
    struct wb_dataset dataset[3];
    const struct wb_dataset *datasets[3];
    struct wb_curve curve;
    double rms = -1.0;
    for (int i = 0; i < 3; i++) {
        const struct wb_test_info info = beam_info(1, 0.085, bow[i]);
        beam_dataset(&dataset[i], &info, &material, 1.0 * mm, 50 * mm, factor[i]);
        datasets[i] = &dataset[i];
    }
    assert_int_equal(curve_average(&curve, datasets, 3, 1.0 * mm), WB_OK);
    assert_int_equal(wb_scatter_residual(&rms, datasets, 3, &curve, &material, &settings), WB_OK);
    *whole = wb_curve_scatter(&curve);
    double one = -1.0;
    assert_int_equal(wb_scatter_residual(&one, datasets, 1, &curve, &material, &settings), WB_OK);
    assert_close(one, 0.0, 0.0);
    wb_curve_release(&curve);
    for (int i = 0; i < 3; i++)
        wb_dataset_release(&dataset[i]);
    return rms;
}

static void bows_alone_leave_no_residual_scatter(void **state)
{
    (void)state;
    const double bow[3] = {-3 * mm, 2 * mm, 4 * mm}, factor[3] = {1.0, 1.0, 1.0};
    double whole;
    const double residual = scatter_of(bow, factor, &whole);
    assert_true(whole > 0.01);
    assert_true(residual < 1e-6);
}

static void scatter_of_the_stiffness_is_all_residual(void **state)
{
    (void)state;
    const double bow[3] = {0.0, 0.0, 0.0}, factor[3] = {0.96, 1.01, 1.03};
    double whole;
    const double residual = scatter_of(bow, factor, &whole);
    assert_true(whole > 0.01);
    assert_close_relative(residual, whole, 1e-6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bows_alone_leave_no_residual_scatter),
        cmocka_unit_test(scatter_of_the_stiffness_is_all_residual),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
