/* Points of a first cycle: tests are made up row by row, so that what lies behind them is known. */
#include <stdlib.h>

#include "analysis/calibration/cycle/cycle_data.h"
#include "base/units.h"
#include "tests/check.h"

enum {
    RATE = 20 /* rows a second */
};

static const double speed = 1.0 * WB_MM, top = 40.0 * WB_MM, weight = 30e-3;

/* Tension of a wire that softens, and of its unloading to a residual deflection of 15 mm. */
static double loading(double deflection)
{
    return weight + 0.12 * (1.0 - exp(-deflection / (25.0 * WB_MM)));
}

static const double residual = 15.0 * WB_MM;

static double unloading(double deflection)
{
    const double part = (deflection - residual) / (top - residual);
    return weight + (loading(top) - weight) * part * (0.8 + 0.2 * part);
}

/* Noise of standard deviation 1, the same in every run. */
static double noise(void)
{
    static unsigned state = 12345;
    double sum = 0.0;
    for (int i = 0; i < 12; i++) {
        state = state * 1664525U + 1013904223U;
        sum += (double)(state >> 8) / 16777216.0;
    }
    return sum - 6.0;
}

struct made_up {
    double deflection_noise, tension_noise; /* m, N */
    double reach;                           /* m of the loading */
    bool one_way;
    int n_outliers;
};

static struct wb_dataset make_test(const struct made_up *how)
{
    struct wb_dataset dataset;
    wb_dataset_init(&dataset);
    snprintf(dataset.info.wire, sizeof dataset.info.wire, "made-up");
    dataset.info.sample = 1;
    dataset.info.length = 85.0 * WB_MM;
    dataset.info.outer_diameter = 1.25 * WB_MM;
    const int rows = (int)lround(how->reach / speed * RATE);
    for (int i = 0; i <= (how->one_way ? rows : 2 * rows); i++) {
        const bool back = i > rows;
        const double true_deflection = (back ? 2 * rows - i : i) * speed / RATE;
        struct wb_row row = {.t = (double)i / RATE,
                             .cycle = 1,
                             .phase = back ? WB_PHASE_UNLOAD : WB_PHASE_LOAD,
                             .stage = (double)NAN,
                             .tip_angle = (double)NAN};
        row.deflection = true_deflection + how->deflection_noise * noise();
        row.tension = (back ? unloading(true_deflection) : loading(true_deflection)) +
                      how->tension_noise * noise();
        if (!back && how->n_outliers > 0 && i % (rows / how->n_outliers) == rows / 9)
            row.tension += 1.0;
        row.force = row.tension - weight;
        wb_dataset_add_row(&dataset, &row);
    }
    return dataset;
}

static struct wb_cycle_data take(const struct made_up *how)
{
    struct wb_dataset dataset = make_test(how);
    struct wb_cycle_data data;
    assert_int_equal(wb_cycle_data_take(&data, &dataset, NULL, NULL), WB_OK);
    wb_dataset_release(&dataset);
    return data;
}

static double true_tension(const struct wb_cycle_point *point)
{
    return point->is_unloading ? unloading(point->deflection) : loading(point->deflection);
}

static void the_points_lie_on_the_curve(void **unused)
{
    (void)unused;
    struct wb_cycle_data data = take(&(struct made_up){.reach = top});
    assert_true(data.n_loading > 40 && data.n_points > data.n_loading + 20);
    assert_int_equal(data.n_outliers, 0);
    assert_close(data.top, top, 1e-12);
    assert_close(data.zero_tension, weight, 1e-12);
    assert_close(data.max_force, loading(top) - weight, 2e-3);
    assert_close(data.residual_deflection, residual, 0.02 * WB_MM);
    for (int i = 0; i < data.n_points; i++) {
        const struct wb_cycle_point *const point = &data.points[i];
        /* A chord of 1 mm lies this far off the curve. */
        assert_close(point->tension, true_tension(point), 1.0e-5);
        assert_int_equal(point->is_unloading, i >= data.n_loading);
    }
    for (int i = 1; i < data.n_points; i++) {
        const double way = data.points[i].deflection - data.points[i - 1].deflection;
        assert_true(i == data.n_loading || (i < data.n_loading ? way > 0.0 : way < 0.0));
    }
    wb_cycle_data_release(&data);
}

/* Noise of the deflection as large as a bin would make a line through it too flat, and its value
 * at a given deflection wrong. */
static void noise_of_the_deflection_makes_no_bias(void **unused)
{
    (void)unused;
    double loading_sum = 0.0, unloading_sum = 0.0, first_sum = 0.0;
    int n_loading = 0, n_unloading = 0, n_first = 0;
    for (int repeat = 0; repeat < 40; repeat++) {
        struct wb_cycle_data data = take(&(struct made_up){
            .reach = top, .deflection_noise = 0.2 * WB_MM, .tension_noise = 1e-4});
        for (int i = 0; i < data.n_points; i++) {
            const double off = data.points[i].tension - true_tension(&data.points[i]);
            if (data.points[i].is_unloading) {
                unloading_sum += off;
                n_unloading++;
            } else {
                loading_sum += off;
                n_loading++;
            }
            if (i < 8) {
                first_sum += off;
                n_first++;
            }
        }
        wb_cycle_data_release(&data);
    }
    /* 0.2 mm are worth 1 mN there; of thousands of rows 0.02 mN are left. */
    assert_close(first_sum / n_first, 0.0, 6e-5);
    assert_close(loading_sum / n_loading, 0.0, 3e-5);
    assert_close(unloading_sum / n_unloading, 0.0, 3e-5);
}

static void a_points_deviation_is_that_of_its_mean(void **unused)
{
    (void)unused;
    struct wb_cycle_data data = take(&(struct made_up){.reach = top, .tension_noise = 1e-3});
    double squares = 0.0, said = 0.0;
    for (int i = 0; i < data.n_points; i++) {
        const struct wb_cycle_point *const point = &data.points[i];
        squares += pow(point->tension - true_tension(point), 2.0);
        said += point->deviation * point->deviation;
        assert_true(point->n_rows >= 4 && point->n_rows <= 2 * RATE);
    }
    assert_close(sqrt(squares / said), 1.0, 0.25);
    wb_cycle_data_release(&data);
}

static void outliers_are_left_out_and_counted(void **unused)
{
    (void)unused;
    struct wb_cycle_data data =
        take(&(struct made_up){.reach = top, .tension_noise = 1e-4, .n_outliers = 6});
    assert_int_equal(data.n_outliers, 6);
    for (int i = 0; i < data.n_points; i++)
        assert_close(data.points[i].tension, true_tension(&data.points[i]), 2e-4);
    wb_cycle_data_release(&data);
}

static void a_test_without_unloading_has_loading_points_only(void **unused)
{
    (void)unused;
    struct wb_cycle_data data = take(&(struct made_up){.reach = top, .one_way = true});
    assert_true(data.n_points > 0);
    assert_int_equal(data.n_points, data.n_loading);
    assert_true(isnan(data.residual_deflection));
    wb_cycle_data_release(&data);
}

static void refused(struct wb_dataset *dataset, const char *word)
{
    struct wb_cycle_data data;
    struct wb_reason why = {.text = ""};
    assert_int_equal(wb_cycle_data_take(&data, dataset, NULL, &why), WB_ERR_DATA);
    assert_non_null(strstr(why.text, word));
    assert_null(data.points);
    wb_dataset_release(dataset);
}

static void a_follower_test_is_rejected(void **unused)
{
    (void)unused;
    struct wb_dataset dataset = make_test(&(struct made_up){.reach = top});
    dataset.info.is_follower = true;
    refused(&dataset, "vertical");
}

static void a_test_with_few_points_is_rejected(void **unused)
{
    (void)unused;
    struct wb_dataset dataset = make_test(&(struct made_up){.reach = 3.0 * WB_MM});
    refused(&dataset, "points");
}

static void a_falling_force_is_rejected(void **unused)
{
    (void)unused;
    struct wb_dataset dataset = make_test(&(struct made_up){.reach = top});
    for (size_t i = 0; i < dataset.n_rows; i++) {
        dataset.rows[i].tension = weight - (dataset.rows[i].tension - weight);
        dataset.rows[i].force = dataset.rows[i].tension - weight;
    }
    refused(&dataset, "does not rise");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_points_lie_on_the_curve),
        cmocka_unit_test(noise_of_the_deflection_makes_no_bias),
        cmocka_unit_test(a_points_deviation_is_that_of_its_mean),
        cmocka_unit_test(outliers_are_left_out_and_counted),
        cmocka_unit_test(a_test_without_unloading_has_loading_points_only),
        cmocka_unit_test(a_follower_test_is_rejected),
        cmocka_unit_test(a_test_with_few_points_is_rejected),
        cmocka_unit_test(a_falling_force_is_rejected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
