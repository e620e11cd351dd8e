#include "tests/analysis/beam_data.h"

#include "analysis/validation/marker_distance.h"

static const double mm = WB_MM;

/* Compares a dataset of the beam, modified by the caller, with the beam. */
static struct wb_marker_distance compare(const struct wb_dataset *dataset,
                                         const struct wb_material *material)
{
    const struct wb_computed_settings settings = {.n_elements = BEAM_ELEMENTS};
    struct wb_computed *computed;
    struct wb_marker_distance distance;
    assert_int_equal(wb_computed_create(&computed, &dataset->info, material, &settings), WB_OK);
    const struct wb_marker_distance_range range = {1.0 * mm, 50 * mm};
    assert_int_equal(wb_marker_distance_find(&distance, computed, material, &dataset, 1, &range),
                     WB_OK);
    wb_computed_destroy(computed);
    return distance;
}

static void make(struct wb_dataset *dataset)
{
    const struct wb_test_info info = beam_info(0, 0.085, 0.0);
    const struct wb_material material = beam_material(0);
    beam_dataset(dataset, &info, &material, 0.7 * mm, 49 * mm, 1.0);
}

static void the_distance_of_the_beams_own_shapes_is_zero(void **state)
{
    (void)state;
    const struct wb_material material = beam_material(0);
    struct wb_dataset dataset;
    make(&dataset);
    /* 71 frames of six markers beyond the clamp; between the grid's frames shapes are interpolated
     * linearly. */
    const struct wb_marker_distance distance = compare(&dataset, &material);
    assert_int_equal(distance.n_points, 71 * 6);
    assert_true(distance.largest < 0.01 * mm);
    wb_dataset_release(&dataset);
}

static void a_shift_is_measured(void **state)
{
    (void)state;
    const struct wb_material material = beam_material(0);
    struct wb_dataset dataset;
    make(&dataset);
    for (size_t i = 0; i < dataset.n_shape_rows; i++) {
        dataset.shape_rows[i].x += 0.3 * mm;
        dataset.shape_rows[i].y += 0.4 * mm;
    }
    const struct wb_marker_distance distance = compare(&dataset, &material);
    assert_close(distance.rms, 0.5 * mm, 0.01 * mm);
    assert_close(distance.largest, 0.5 * mm, 0.01 * mm);
    wb_dataset_release(&dataset);
}

static void clamp_unloading_and_far_frames_are_left_out(void **state)
{
    (void)state;
    const struct wb_material material = beam_material(0);
    struct wb_dataset dataset;
    make(&dataset);
    const double end = dataset.rows[dataset.n_rows - 1].t;
    for (size_t i = 0; i < dataset.n_shape_rows; i++) {
        if (dataset.shape_rows[i].s == 0.0)
            dataset.shape_rows[i].y = 5.0;
    }
    const struct wb_shape_row strangers[] = {
        {end + 1.0, 20 * mm, 3, 0.0425, 1.0, 1.0},
        {10.0, 51 * mm, 3, 0.0425, 1.0, 1.0},
        {10.0, -1 * mm, 3, 0.0425, 1.0, 1.0},
        {10.0, 10 * mm, 3, 0.0425, (double)NAN, 1.0},
    };
    for (size_t i = 0; i < sizeof strangers / sizeof strangers[0]; i++)
        wb_dataset_add_shape_row(&dataset, &strangers[i]);
    const struct wb_marker_distance distance = compare(&dataset, &material);
    assert_int_equal(distance.n_points, 71 * 6);
    assert_true(distance.largest < 0.01 * mm);
    wb_dataset_release(&dataset);
}

static void without_shapes_the_distance_is_unknown(void **state)
{
    (void)state;
    const struct wb_material material = beam_material(0);
    struct wb_dataset dataset;
    make(&dataset);
    dataset.n_shape_rows = 0;
    const struct wb_marker_distance distance = compare(&dataset, &material);
    assert_int_equal(distance.n_points, 0);
    assert_true(isnan(distance.rms) && isnan(distance.largest));
    wb_dataset_release(&dataset);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_distance_of_the_beams_own_shapes_is_zero),
        cmocka_unit_test(a_shift_is_measured),
        cmocka_unit_test(clamp_unloading_and_far_frames_are_left_out),
        cmocka_unit_test(without_shapes_the_distance_is_unknown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
