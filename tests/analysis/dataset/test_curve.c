#include "tests/analysis/beam_data.h"

static const double mm = WB_MM;

static double line(double x)
{
    return 2.0 * x;
}

static double parabola(double x)
{
    return 2.0 * x - 10.0 * x * x;
}

/* Evenly spread numbers without a library: -1..1, mean 0, variance 1/3. */
static double noise(uint64_t *state)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) / 4503599627370496.0 - 1.0;
}

static enum wb_status average(struct wb_curve *curve, const struct wb_dataset *dataset, double step)
{
    return curve_average(curve, &dataset, 1, step);
}

static void assert_follows(const struct wb_curve *curve, double (*force)(double deflection))
{
    for (int i = 0; i < curve->n; i++)
        assert_close(curve->force[i], force(i * curve->step), 1e-12);
}

/* The loading is refused with that message. */
static void refuse(const struct wb_dataset *dataset, double step, const char *message)
{
    struct wb_curve curve;
    assert_int_equal(average(&curve, dataset, step), WB_ERR_DATA);
    assert_message(message);
}

static void a_single_curve_comes_back_on_the_grid(void **state)
{
    (void)state;
    struct wb_dataset dataset;
    struct wb_curve curve;
    plain_dataset(&dataset, line, 0.05 * mm, 53 * mm);
    assert_int_equal(average(&curve, &dataset, 0.0), WB_OK);
    assert_int_equal(curve.n, 107);
    assert_int_equal(curve.n_samples, 1);
    assert_close(curve.step, 0.5 * mm, 0.0);
    assert_close(curve.max_deflection, 53 * mm, 1e-12);
    for (int i = 0; i < curve.n; i++) {
        assert_close(curve.force[i], line(i * curve.step), 1e-12);
        assert_close(curve.deviation[i], 0.0, 0.0);
        assert_close(curve.low[i], curve.high[i], 0.0);
    }
    assert_close(curve_force(&curve, 10.25 * mm), line(10.25 * mm), 1e-12);
    assert_true(isnan(curve_force(&curve, 53.6 * mm)));
    assert_true(isnan(curve_force(&curve, -0.1 * mm)));
    assert_close(wb_curve_scatter(&curve), 0.0, 0.0);
    wb_curve_release(&curve);
    wb_dataset_release(&dataset);
}

static void loads_in_space_make_no_curve(void **state)
{
    (void)state;
    struct wb_dataset dataset;
    struct wb_curve curve;
    plain_dataset(&dataset, line, 0.05 * mm, 53 * mm);
    dataset.info.is_general = true;
    assert_int_equal(average(&curve, &dataset, 0.0), WB_ERR_DATA);
    wb_dataset_release(&dataset);
}

static void rows_on_the_grid_are_taken_as_they_are(void **state)
{
    (void)state;
    struct wb_dataset dataset;
    struct wb_curve curve;
    plain_dataset(&dataset, parabola, 0.5 * mm, 53 * mm);
    assert_int_equal(average(&curve, &dataset, 0.5 * mm), WB_OK);
    assert_int_equal(curve.n, 107);
    assert_follows(&curve, parabola);
    wb_curve_release(&curve);
    wb_dataset_release(&dataset);
}

static void coarse_rows_are_interpolated(void **state)
{
    (void)state;
    struct wb_dataset dataset;
    struct wb_curve curve;
    plain_dataset(&dataset, line, 1.0 * mm, 53 * mm);
    assert_int_equal(average(&curve, &dataset, 0.5 * mm), WB_OK);
    assert_follows(&curve, line);
    wb_curve_release(&curve);
    wb_dataset_release(&dataset);
}

static void mean_range_and_deviation_are_those_of_the_samples(void **state)
{
    (void)state;
    struct wb_dataset dataset[3];
    struct wb_curve curve;
    const double factor[3] = {0.9, 1.0, 1.25};
    const struct wb_dataset *datasets[3];
    for (int i = 0; i < 3; i++) {
        plain_dataset(&dataset[i], line, 0.1 * mm, (40 + 5 * i) * mm);
        for (size_t k = 0; k < dataset[i].n_rows; k++)
            dataset[i].rows[k].force *= factor[i];
        datasets[i] = &dataset[i];
    }
    assert_int_equal(curve_average(&curve, datasets, 3, 0.5 * mm), WB_OK);
    /* The shortest sample ends the average. */
    assert_close(curve.max_deflection, 40 * mm, 1e-12);
    const double mean = (0.9 + 1.0 + 1.25) / 3.0;
    const double deviation =
        sqrt((pow(0.9 - mean, 2) + pow(1.0 - mean, 2) + pow(1.25 - mean, 2)) / 2.0);
    for (int i = 0; i < curve.n; i++) {
        const double force = line(i * curve.step);
        assert_close(curve.force[i], mean * force, 1e-12);
        assert_close(curve.low[i], 0.9 * force, 1e-12);
        assert_close(curve.high[i], 1.25 * force, 1e-12);
        assert_close(curve.deviation[i], deviation * force, 1e-12);
    }
    /* RMS of a deviation that grows linearly to its end. */
    assert_close_relative(wb_curve_scatter(&curve), deviation / mean / sqrt(3.0), 1e-3);
    wb_curve_release(&curve);
    for (int i = 0; i < 3; i++)
        wb_dataset_release(&dataset[i]);
}

static void noise_of_force_and_deflection_is_averaged_away_without_bias(void **state)
{
    (void)state;
    struct wb_dataset dataset;
    struct wb_curve curve;
    uint64_t seed = 7;
    const double force_noise = 1e-4, deflection_noise = 0.17 * mm;
    plain_dataset(&dataset, parabola, 0.02 * mm, 53 * mm);
    for (size_t i = 0; i < dataset.n_rows; i++) {
        dataset.rows[i].force += force_noise * noise(&seed);
        dataset.rows[i].deflection += deflection_noise * noise(&seed);
    }
    assert_int_equal(average(&curve, &dataset, 0.5 * mm), WB_OK);
    double sum = 0.0, squares = 0.0;
    for (int i = 1; i < curve.n - 1; i++) {
        const double error = curve.force[i] - parabola(i * curve.step);
        sum += error;
        squares += error * error;
    }
    /* A row's own noise is 2e-4 N and more in all; some thirty rows count in a bin. */
    assert_true(sqrt(squares / (curve.n - 2)) < 6e-5);
    assert_true(fabs(sum / (curve.n - 2)) < 1e-5);
    assert_close(curve.force[0], 0.0, 1.5e-4);
    wb_curve_release(&curve);
    wb_dataset_release(&dataset);
}

static void only_the_taut_first_loading_counts(void **state)
{
    (void)state;
    struct wb_dataset dataset;
    struct wb_curve curve;
    plain_dataset(&dataset, line, 0.1 * mm, 50 * mm);
    for (int k = 0; k < 500; k++) {
        struct wb_row row = {.t = 60.0, .cycle = 1, .deflection = k * 0.1 * mm, .force = 7.0};
        row.phase = k % 2 ? WB_PHASE_UNLOAD : WB_PHASE_SLACK;
        row.cycle = k % 3 == 0 ? 2 : 1;
        if (row.cycle == 2)
            row.phase = WB_PHASE_LOAD;
        wb_dataset_add_row(&dataset, &row);
    }
    /* On the rest below zero the force rises at one deflection. */
    for (int k = 0; k < 100; k++) {
        const struct wb_row row = {.cycle = 1, .deflection = -0.5 * mm, .force = -0.001 * k};
        wb_dataset_add_row(&dataset, &row);
    }
    assert_int_equal(average(&curve, &dataset, 0.5 * mm), WB_OK);
    assert_follows(&curve, line);
    wb_curve_release(&curve);
    wb_dataset_release(&dataset);
}

/* Removes the rows between two deflections. */
static void cut(struct wb_dataset *dataset, double from, double to)
{
    size_t left = 0;
    for (size_t i = 0; i < dataset->n_rows; i++) {
        if (dataset->rows[i].deflection < from || dataset->rows[i].deflection > to)
            dataset->rows[left++] = dataset->rows[i];
    }
    dataset->n_rows = left;
}

static void a_short_gap_is_bridged_and_a_long_one_refused(void **state)
{
    (void)state;
    struct wb_dataset dataset;
    struct wb_curve curve;
    plain_dataset(&dataset, line, 0.05 * mm, 50 * mm);
    cut(&dataset, 20.01 * mm, 21.89 * mm);
    assert_int_equal(average(&curve, &dataset, 0.5 * mm), WB_OK);
    assert_follows(&curve, line);
    wb_curve_release(&curve);
    cut(&dataset, 20.01 * mm, 22.14 * mm);
    refuse(&dataset, 0.5 * mm, "no rows of the first loading around 2");
    wb_dataset_release(&dataset);
}

static void different_kinds_are_not_averaged(void **state)
{
    (void)state;
    struct wb_dataset dataset[2];
    struct wb_curve curve;
    const struct wb_dataset *const datasets[] = {&dataset[0], &dataset[1]};
    for (int i = 0; i < 2; i++)
        plain_dataset(&dataset[i], line, 0.1 * mm, 50 * mm);
    dataset[1].info.length = 0.1;
    assert_int_equal(curve_average(&curve, datasets, 2, 0.0), WB_ERR_DATA);
    assert_message("different kinds");
    dataset[1].info.length = 0.085;
    strcpy(dataset[1].info.wire, "type2");
    assert_int_equal(curve_average(&curve, datasets, 2, 0.0), WB_ERR_DATA);
    strcpy(dataset[1].info.wire, dataset[0].info.wire);
    dataset[1].info.counterweight = 0.0;
    assert_int_equal(curve_average(&curve, datasets, 2, 0.0), WB_ERR_DATA);
    assert_message("tested differently");
    for (int i = 0; i < 2; i++)
        wb_dataset_release(&dataset[i]);
}

static void unusable_rows_are_refused_with_the_reason(void **state)
{
    (void)state;
    struct wb_dataset dataset;
    struct wb_curve curve;
    plain_dataset(&dataset, line, 0.1 * mm, 50 * mm);
    dataset.rows[100].force = (double)NAN;
    refuse(&dataset, 0.0, "row 101 has no finite");
    dataset.rows[100].force = 0.0;
    for (size_t i = 0; i < dataset.n_rows; i++)
        dataset.rows[i].deflection = -dataset.rows[i].deflection;
    refuse(&dataset, 0.0, "reversed");
    dataset.n_rows = 5;
    for (size_t i = 0; i < dataset.n_rows; i++)
        dataset.rows[i].deflection = (double)i * mm;
    refuse(&dataset, 0.0, "only 5 rows");
    dataset.n_rows = 0;
    assert_int_equal(average(&curve, &dataset, 0.0), WB_ERR_DATA);
    assert_int_equal(curve_average(&curve, NULL, 0, 0.0), WB_ERR_ARGUMENT);
    wb_dataset_release(&dataset);
}

static void a_loading_of_a_few_steps_is_refused(void **state)
{
    (void)state;
    struct wb_dataset dataset;
    plain_dataset(&dataset, line, 0.05 * mm, 3 * mm);
    refuse(&dataset, 0.5 * mm, "reaches only 7 points");
    wb_dataset_release(&dataset);
}

static void natural_shapes_are_averaged(void **state)
{
    (void)state;
    struct wb_dataset dataset[2];
    struct wb_test_info info;
    const struct wb_dataset *const datasets[] = {&dataset[0], &dataset[1]};
    for (int i = 0; i < 2; i++)
        plain_dataset(&dataset[i], line, 0.1 * mm, 50 * mm);
    dataset[0].info.n_natural_shape = 1;
    dataset[0].info.natural_shape[0] = 0.06;
    dataset[1].info.n_natural_shape = 2;
    dataset[1].info.natural_shape[0] = -0.02;
    dataset[1].info.natural_shape[1] = 0.01;
    wb_curve_mean_info(datasets, 2, &info);
    assert_int_equal(info.n_natural_shape, 2);
    assert_close(info.natural_shape[0], 0.02, 1e-15);
    assert_close(info.natural_shape[1], 0.005, 1e-15);
    assert_int_equal(info.sample, 0);
    wb_curve_mean_info(datasets, 1, &info);
    assert_int_equal(info.sample, 1);
    for (int i = 0; i < 2; i++)
        wb_dataset_release(&dataset[i]);
}

static void groups_are_by_wire_and_length(void **state)
{
    (void)state;
    struct wb_dataset dataset[4] = {0};
    const struct wb_dataset *const datasets[] = {&dataset[0], &dataset[1], &dataset[2],
                                                 &dataset[3]};
    int group[4];
    for (int i = 0; i < 4; i++)
        dataset[i].info = beam_info(i == 3 ? 1 : 0, i == 1 ? 0.1 : 0.085, 0.0);
    assert_int_equal(wb_curve_group(datasets, 4, group), 3);
    assert_int_equal(group[0], 0);
    assert_int_equal(group[1], 1);
    assert_int_equal(group[2], 0);
    assert_int_equal(group[3], 2);
}

static void a_loading_that_begins_above_zero_is_told(void **state)
{
    (void)state;
    struct wb_dataset dataset;
    plain_dataset(&dataset, line, 0.05 * mm, 53 * mm);
    for (int i = 0; i < 34; i++)
        dataset.rows[i].phase = WB_PHASE_SLACK;
    refuse(&dataset, 0.0, "no rows below 1.70 mm");
    wb_dataset_release(&dataset);
}

static void the_mean_shape_is_of_those_that_are_known(void **state)
{
    (void)state;
    struct wb_dataset dataset[3] = {0};
    const struct wb_dataset *const datasets[] = {&dataset[0], &dataset[1], &dataset[2]};
    struct wb_test_info info;
    for (int i = 0; i < 3; i++)
        dataset[i].info = beam_info(1, 0.085, i == 1 ? 0.0 : 2.0 * mm + i * mm);
    wb_curve_mean_info(datasets, 3, &info);
    assert_close_relative(info.natural_shape[0], 6.0 * mm / 0.085, 1e-12);
    keep_messages();
    wb_curve_warn_unknown_shapes(datasets, 3);
    assert_message("1 of 3 samples is not known");
    kept.n = 0;
    wb_curve_warn_unknown_shapes(datasets, 1);
    wb_curve_warn_unknown_shapes(datasets + 1, 1);
    assert_int_equal(kept.n, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_single_curve_comes_back_on_the_grid),
        cmocka_unit_test(loads_in_space_make_no_curve),
        cmocka_unit_test(rows_on_the_grid_are_taken_as_they_are),
        cmocka_unit_test(coarse_rows_are_interpolated),
        cmocka_unit_test(mean_range_and_deviation_are_those_of_the_samples),
        cmocka_unit_test(noise_of_force_and_deflection_is_averaged_away_without_bias),
        cmocka_unit_test(only_the_taut_first_loading_counts),
        cmocka_unit_test(a_short_gap_is_bridged_and_a_long_one_refused),
        cmocka_unit_test(different_kinds_are_not_averaged),
        cmocka_unit_test(unusable_rows_are_refused_with_the_reason),
        cmocka_unit_test(a_loading_of_a_few_steps_is_refused),
        cmocka_unit_test(natural_shapes_are_averaged),
        cmocka_unit_test(groups_are_by_wire_and_length),
        cmocka_unit_test(a_loading_that_begins_above_zero_is_told),
        cmocka_unit_test(the_mean_shape_is_of_those_that_are_known),
    };
    return cmocka_run_group_tests(tests, silence, NULL);
}
