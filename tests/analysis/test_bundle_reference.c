/* Shipped curves of the explicit bundle, with constant friction of 0.4, against stored ones of a
 * static model. */
#include "analysis/dataset/dataset.h"
#include "base/file.h"
#include "tests/check.h"
#include "tests/fe/bundle/static_reference.h"

/* The largest difference beyond 1 mm, over the static force. */
static double compare(const char *dataset_name, const struct static_point *expected, size_t n)
{
    struct wb_dataset dataset;
    char path[WB_PATH];
    double worst = 0.0;

    assert_int_equal(wb_file_find_data(path, dataset_name), WB_OK);
    assert_int_equal(wb_dataset_read(&dataset, path, NULL), WB_OK);
    for (size_t i = 0; i < n; i++) {
        const size_t at = (size_t)expected[i].deflection_mm;
        assert_true(at < dataset.n_rows);
        const struct wb_row *row = &dataset.rows[at];
        const double error = row->force / expected[i].force - 1.0;
        assert_close(row->deflection, expected[i].deflection_mm * 1e-3, 1e-6);
        print_message("%s, %4.1f mm: static %.4f N, explicit %.4f N, %+.1f %%\n", dataset_name,
                      row->deflection * 1e3, expected[i].force, row->force, 100.0 * error);
        worst = fmax(worst, fabs(error));
    }
    wb_dataset_release(&dataset);
    return worst;
}

static void seven_wires_with_friction_agree_within_five_percent(void **unused)
{
    (void)unused;
    assert_true(compare("simulations/7-type3-constant", static_7,
                        sizeof static_7 / sizeof static_7[0]) < 0.05);
}

static void twelve_wires_with_friction_agree_within_five_percent(void **unused)
{
    (void)unused;
    assert_true(compare("simulations/12-type3-constant", static_12,
                        sizeof static_12 / sizeof static_12[0]) < 0.05);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(seven_wires_with_friction_agree_within_five_percent),
        cmocka_unit_test(twelve_wires_with_friction_agree_within_five_percent),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
