/* The static bundle (tests/twin/bundle_static.h) against shipped curves of the explicit one: both
 * with constant friction of 0.4, a vertical force and no weight, as the static model knows them. */
#include "analysis/dataset/dataset.h"
#include "base/file.h"
#include "tests/check.h"
#include "tests/twin/bundle_static.h"

/* Every tenth row and the second: the largest difference, over the static force. */
static double compare(const char *bundle_name, const char *dataset_name, double from)
{
    const struct wb_bundle_static_settings settings = {.open_stiffness = 1e-4};
    struct wb_bundle_model *const model = test_malloc(sizeof *model);
    struct wb_bundle_static *bundle = NULL;
    struct wb_dataset dataset;
    char path[WB_PATH];
    double worst = 0.0;

    assert_int_equal(wb_file_find_fixture(path, "bundles", bundle_name, NULL), WB_OK);
    assert_int_equal(wb_bundle_model_read(model, path), WB_OK);
    model->loads.weight = false;
    model->loads.strand_length = 0.0;
    model->interface.friction_static = model->interface.friction_kinetic = 0.4;
    assert_int_equal(wb_file_find_data(path, dataset_name), WB_OK);
    assert_int_equal(wb_dataset_read(&dataset, path, NULL), WB_OK);
    assert_int_equal(wb_bundle_static_create(&bundle, model, &settings), WB_OK);
    for (size_t i = 2; i < dataset.n_rows; i++) {
        const struct wb_row *row = &dataset.rows[i];
        struct wb_bundle_static_point point;
        if (i != 2 && i % 10 != 0 && i + 1 != dataset.n_rows)
            continue;
        assert_int_equal(wb_bundle_static_move(bundle, row->deflection, &point), WB_OK);
        assert_int_equal(point.end, WB_BUNDLE_STATIC_CONVERGED);
        const double error = row->force / point.vertical - 1.0;
        print_message("%s, %4.1f mm: static %.4f N, explicit %.4f N, %+.1f %%\n", bundle_name,
                      row->deflection * 1e3, point.vertical, row->force, 100.0 * error);
        if (row->deflection > from)
            worst = fmax(worst, fabs(error));
    }
    wb_bundle_static_destroy(bundle);
    wb_dataset_release(&dataset);
    test_free(model);
    return worst;
}

static void seven_wires_with_friction_agree_within_five_percent(void **unused)
{
    (void)unused;
    assert_true(compare("7-type3", "simulations/7-type3-constant", 1e-3) < 0.05);
}

static void twelve_wires_with_friction_agree_within_five_percent(void **unused)
{
    (void)unused;
    assert_true(compare("12-type3", "simulations/12-type3-constant", 1e-3) < 0.05);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(seven_wires_with_friction_agree_within_five_percent),
        cmocka_unit_test(twelve_wires_with_friction_agree_within_five_percent),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
