#include "fixtures/virtual/truth.h"

#include <stdlib.h>

#include "base/config.h"
#include "tests/virtual/setup.h"

static void the_same_seed_draws_the_same_truth(void **state)
{
    (void)state;
    struct setup one, two;
    setup_bench(&one, "type1-L85-1", 7);
    setup_bench(&two, "type1-L85-1", 7);
    assert_memory_equal(&one.truth, &two.truth, sizeof one.truth);
    setup_bench(&two, "type1-L85-1", 8);
    assert_true(one.truth.stiffness_factor != two.truth.stiffness_factor);
    assert_true(one.truth.bow != two.truth.bow);
}

static void stiffness_and_yield_scatter_by_four_percent(void **state)
{
    (void)state;
    enum {
        N = 4000
    };
    struct setup setup;
    setup_bench(&setup, "type1-L85-1", 0);
    double sums[2] = {0}, squares[2] = {0}, product = 0.0;
    for (uint64_t seed = 0; seed < N; seed++) {
        wb_truth_draw(&setup.truth, seed, &setup.rig, &setup.specimen);
        const double a = setup.truth.stiffness_factor - 1.0, b = setup.truth.yield_factor - 1.0;
        sums[0] += a;
        sums[1] += b;
        squares[0] += a * a;
        squares[1] += b * b;
        product += a * b;
    }
    for (int i = 0; i < 2; i++) {
        assert_close(sums[i] / N, 0.0, 5.0 * 0.04 / sqrt(N));
        assert_close(sqrt(squares[i] / N), 0.04, 0.04 * 5.0 / sqrt(2.0 * N));
    }
    /* Independent of each other. */
    assert_close(product / sqrt(squares[0] * squares[1]), 0.0, 5.0 / sqrt(N));
}

static void the_bow_is_two_to_four_millimetres_either_way(void **state)
{
    (void)state;
    struct setup setup;
    setup_bench(&setup, "type2-L100-1", 0);
    int up = 0;
    double least = 10.0, most = 0.0;
    for (uint64_t seed = 0; seed < 1000; seed++) {
        wb_truth_draw(&setup.truth, seed, &setup.rig, &setup.specimen);
        const double size = fabs(setup.truth.bow) / WB_MM;
        assert_true(size >= 2.0 && size <= 4.0);
        least = fmin(least, size);
        most = fmax(most, size);
        up += setup.truth.bow > 0.0;
    }
    assert_true(least < 2.1 && most > 3.9);
    assert_true(up > 420 && up < 580);
}

static void the_curvature_gives_the_bow(void **state)
{
    (void)state;
    struct setup setup;
    for (uint64_t seed = 1; seed <= 18; seed++) {
        setup_bench(&setup, "type3-L100-2", seed);
        const double L = setup.specimen.length;
        struct wb_truth_bow bow = {.truth = &setup.truth, .length = L};
        /* Slope and height by the trapezoidal rule on a fine grid; slopes are below 0.1. */
        const int n = 20000;
        double slope = 0.0, height = 0.0, before = wb_truth_curvature(&bow, 0.0);
        for (int i = 1; i <= n; i++) {
            const double curvature = wb_truth_curvature(&bow, L * i / n);
            const double next = slope + 0.5 * (before + curvature) * L / n;
            height += 0.5 * (slope + next) * L / n;
            slope = next;
            before = curvature;
        }
        assert_close(height, setup.truth.bow, 1e-8);
    }
}

static void markers_are_a_millimetre_off_the_axis_with_scatter(void **state)
{
    (void)state;
    struct setup setup;
    setup_bench(&setup, "type1-L85-1", 0);
    double sum = 0.0, squares = 0.0;
    int n = 0;
    for (uint64_t seed = 0; seed < 500; seed++) {
        wb_truth_draw(&setup.truth, seed, &setup.rig, &setup.specimen);
        for (int i = 0; i < setup.specimen.n_markers; i++, n++) {
            const double off = setup.truth.marker_offsets[i] / WB_MM - 1.0;
            sum += off;
            squares += off * off;
        }
    }
    assert_close(sum / n, 0.0, 5.0 * 0.05 / sqrt(n));
    assert_close(sqrt(squares / n), 0.05, 0.05 * 5.0 / sqrt(2.0 * n));
}

static void instruments_are_those_of_the_paper_bench(void **state)
{
    (void)state;
    struct setup setup;
    const double g = WB_STANDARD_GRAVITY;
    for (uint64_t seed = 1; seed < 50; seed++) {
        setup_bench(&setup, "type1-L85-1", seed);
        const struct wb_truth *const truth = &setup.truth;
        assert_close_relative(truth->cell_noise, 10.0 * WB_MG * g, 1e-9);
        assert_close_relative(truth->cell_resolution, 1.0 * WB_MG * g, 1e-9);
        assert_close_relative(fabs(truth->cell_drift), 2.0 * WB_MG * g / 60.0, 1e-9);
        assert_close(truth->cell_filter, 0.05, 1e-12);
        assert_true(truth->cell_rate > 77.0 && truth->cell_rate < 83.0);
        assert_close(truth->frame_rate, 120.0, 0.0);
        assert_close(truth->marker_noise, 0.1 * WB_MM, 1e-12);
        assert_close(fabs(truth->clock_drift), 50e-6, 1e-12);
        assert_true(truth->clock_offset > 7000.0 && truth->clock_offset < 44000.0);
    }
}

static void the_lab_frame_keeps_distances_and_handedness(void **state)
{
    (void)state;
    struct setup setup;
    setup_bench(&setup, "type1-L85-1", 11);
    const double points[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const char ups[] = {'y', 'z'};
    for (int u = 0; u < 2; u++) {
        double lab[4][3], axes[3][3];
        for (int i = 0; i < 4; i++)
            wb_truth_to_lab(&setup.truth, ups[u], points[i], lab[i]);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                axes[i][j] = lab[i + 1][j] - lab[0][j];
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++) {
                double dot = 0.0;
                for (int j = 0; j < 3; j++)
                    dot += axes[i][j] * axes[k][j];
                assert_close(dot, i == k ? 1.0 : 0.0, 1e-12);
            }
        /* Up is up. */
        assert_close(axes[1][u == 0 ? 1 : 2], 1.0, 1e-12);
    }
}

static void the_written_truth_is_complete_yaml(void **state)
{
    (void)state;
    struct setup setup;
    struct wb_text text = {0};
    struct wb_config *config;
    setup_bench(&setup, "type1-L85-1", 3);
    wb_text_append(&text, "truth:\n");
    wb_truth_format(&setup.truth, setup.specimen.n_markers, &text);
    assert_int_equal(wb_config_parse(&config, wb_text_string(&text), "truth", NULL), WB_OK);
    const char *name;
    const struct wb_config_node *const map = wb_config_entry(wb_config_root(config), 0, &name);
    char source[32];
    double bow = 0.0, stiffness = 0.0;
    int seed = 0;
    const struct wb_config_node *offsets = NULL;
    for (int i = 0; i < wb_config_entries(map); i++) {
        const struct wb_config_node *const value = wb_config_entry(map, i, &name);
        if (strcmp(name, "source") == 0)
            snprintf(source, sizeof source, "%s", wb_config_scalar(value));
        if (strcmp(name, "seed") == 0)
            seed = atoi(wb_config_scalar(value));
        if (strcmp(name, "bow_mm") == 0)
            bow = atof(wb_config_scalar(value)) * WB_MM;
        if (strcmp(name, "stiffness_factor") == 0)
            stiffness = atof(wb_config_scalar(value));
        if (strcmp(name, "marker_offsets_mm") == 0)
            offsets = value;
    }
    assert_string_equal(source, "virtual rig");
    assert_int_equal(seed, 3);
    assert_close(bow, setup.truth.bow, 1e-15);
    assert_close(stiffness, setup.truth.stiffness_factor, 0.0);
    assert_non_null(offsets);
    assert_int_equal(wb_config_length(offsets), 7);
    wb_config_destroy(config);
    wb_text_release(&text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_same_seed_draws_the_same_truth),
        cmocka_unit_test(stiffness_and_yield_scatter_by_four_percent),
        cmocka_unit_test(the_bow_is_two_to_four_millimetres_either_way),
        cmocka_unit_test(the_curvature_gives_the_bow),
        cmocka_unit_test(markers_are_a_millimetre_off_the_axis_with_scatter),
        cmocka_unit_test(instruments_are_those_of_the_paper_bench),
        cmocka_unit_test(the_lab_frame_keeps_distances_and_handedness),
        cmocka_unit_test(the_written_truth_is_complete_yaml),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
