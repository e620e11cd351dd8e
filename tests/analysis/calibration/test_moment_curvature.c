#include "analysis/calibration/cycle/moment_curvature.h"

#include "analysis/calibration/cycle/cycle_model.h"

#include <stdlib.h>

#include <gsl/gsl_errno.h>

#include "analysis/calibration/cycle/cycle_fit.h"
#include "analysis/calibration/law/bending.h"
#include "base/units.h"
#include "fe/rod/fibres.h"
#include "fe/rod/section.h"
#include "fe/trial/cantilever.h"
#include "tests/analysis/fast_rig.h"
#include "tests/messages.h"

static const double mm = WB_MM;

/* A wire that yields from early on, about as the rig's second type. */
static struct wb_law soft_law(void)
{
    enum {
        PARTS = 9
    };
    struct wb_law_part parts[PARTS];
    struct wb_law law;
    for (int i = 0; i < PARTS; i++)
        parts[i] = (struct wb_law_part){1.3e9 * pow(0.72, i), 2e-4 * pow(1.9, i)};
    parts[PARTS - 1] = (struct wb_law_part){0.25e9, (double)INFINITY};
    wb_law_init_parallel(&law, parts, PARTS, 0.0, 0.39);
    return law;
}

static struct wb_test_info bench_info(double bow)
{
    const double diameter = 1.25 * mm, length = 85 * mm;
    struct wb_test_info info = {
        .wire = "made up",
        .sample = 1,
        .length = length,
        .outer_diameter = diameter,
        .mass_per_length = 4.31 * WB_G_PER_CM3 * M_PI * diameter * diameter / 4.0,
        .poissons_ratio = 0.39,
        .strand_length = 0.76,
        .counterweight = 2.7e-3,
        .gravity = WB_STANDARD_GRAVITY,
        .rest_level = (double)NAN,
        .n_natural_shape = 1,
        .natural_shape = {2.0 * bow / length},
        .is_simulation = true,
    };
    return info;
}

static void add_state(struct wb_dataset *dataset, struct wb_cantilever *cantilever, double to,
                      enum wb_phase phase, bool with_shape)
{
    struct wb_cantilever_point point;
    assert_int_equal(wb_cantilever_move(cantilever, WB_CONTROL_DEFLECTION, to, &point), WB_OK);
    assert_int_equal(point.end, WB_CANTILEVER_CONVERGED);
    const struct wb_row row = {.t = (double)dataset->n_rows,
                               .cycle = 1,
                               .phase = phase,
                               .deflection = to,
                               .tension = point.tension,
                               .force = point.vertical_force,
                               .stage = (double)NAN,
                               .tip_x = point.tip_x,
                               .tip_angle = point.tip_angle};
    wb_dataset_add_row(dataset, &row);
    for (int i = 0; with_shape && i < 7; i++) {
        struct wb_shape_row shape = {.t = row.t,
                                     .deflection = to,
                                     .marker = i,
                                     .s = dataset->info.length * i / 6,
                                     .z = (double)NAN};
        wb_cantilever_shape(cantilever, 1, &shape.s, &shape.x, &shape.y, NULL);
        wb_dataset_add_shape_row(dataset, &shape);
    }
}

/* The first cycle of the beam itself, up to 50 mm and back to 20 mm. */
static void exact_dataset(struct wb_dataset *dataset, const struct wb_law *law, double bow)
{
    struct wb_section section;
    struct wb_cantilever_model model;
    struct wb_cantilever *cantilever;
    wb_dataset_init(dataset);
    dataset->info = bench_info(bow);
    assert_int_equal(wb_section_init_law(&section, dataset->info.outer_diameter, law, 60), WB_OK);
    wb_cantilever_default_model(&model);
    model.section = &section;
    model.length = dataset->info.length;
    model.strand_length = dataset->info.strand_length;
    model.counterweight = dataset->info.counterweight;
    model.mass_per_length = dataset->info.mass_per_length;
    model.gravity_y = -dataset->info.gravity;
    model.natural_curvature = wb_dataset_natural_curvature;
    model.curvature_context = &dataset->info;
    assert_int_equal(wb_cantilever_create(&cantilever, &model, NULL), WB_OK);
    for (int i = 0; i <= 500; i++)
        add_state(dataset, cantilever, 0.1 * mm * i, WB_PHASE_LOAD, i % 5 == 0);
    for (int i = 499; i >= 200; i--)
        add_state(dataset, cantilever, 0.1 * mm * i, WB_PHASE_UNLOAD, i % 5 == 0);
    wb_cantilever_destroy(cantilever);
    wb_section_release(&section);
}

/* Largest relative error of the moments against a law on the loading, of points beyond a share of
 * the largest curvature. */
static double worst_error(const struct wb_moment_cloud *cloud, const struct wb_law *law,
                          double diameter)
{
    double worst = 0.0;
    int n = 0;
    for (int i = 0; i < cloud->n; i++) {
        const struct wb_moment_point *const point = &cloud->points[i];
        double moment;
        if (point->is_unloading || point->is_band)
            continue;
        assert_int_equal(wb_bending_moments(law, diameter, 1, &point->curvature, &moment), WB_OK);
        worst = fmax(worst, fabs(point->moment / moment - 1.0));
        n++;
    }
    assert_true(n > 20);
    return worst;
}

static double error_of(const struct wb_dataset *dataset, const struct wb_law *law)
{
    struct wb_moment_cloud cloud;
    assert_int_equal(wb_moment_curvature_take(&cloud, dataset, NULL, NULL), WB_OK);
    const double worst = worst_error(&cloud, law, dataset->info.outer_diameter);
    wb_moment_curvature_release(&cloud);
    return worst;
}

static void exact_shapes_give_the_moments_of_the_law(void **state)
{
    (void)state;
    const struct wb_law law = soft_law();
    const double bows[] = {0.0, -3.0 * mm, 3.0 * mm};
    for (int i = 0; i < 3; i++) {
        struct wb_dataset dataset;
        exact_dataset(&dataset, &law, bows[i]);
        const double worst = error_of(&dataset, &law);
        print_message("bow %+.0f mm: moments within %.2f %%\n", bows[i] / mm, 100.0 * worst);
        /* Bowed upwards, it was bent down first: its loading is not quite the virgin one. */
        assert_true(worst < (bows[i] > 0.0 ? 0.007 : 0.005));
        wb_dataset_release(&dataset);
    }
}

static void weight_counterweight_strand_and_bow_count(void **state)
{
    (void)state;
    const struct wb_law law = soft_law();
    struct wb_dataset dataset;
    exact_dataset(&dataset, &law, -3.0 * mm);
    const struct wb_test_info info = dataset.info;
    double error[4];
    dataset.info.mass_per_length = 0.0;
    error[0] = error_of(&dataset, &law);
    dataset.info = info;
    dataset.info.counterweight = 0.0;
    error[1] = error_of(&dataset, &law);
    dataset.info = info;
    dataset.info.strand_length = 0.0;
    error[2] = error_of(&dataset, &law);
    dataset.info = info;
    dataset.info.n_natural_shape = 0;
    error[3] = error_of(&dataset, &law);
    print_message("off without weight %.1f, counterweight %.1f, strand %.1f, bow %.1f %%\n",
                  100.0 * error[0], 100.0 * error[1], 100.0 * error[2], 100.0 * error[3]);
    for (int i = 0; i < 4; i++)
        assert_true(error[i] > 0.01);

    /* What a fit found wins over the dataset. */
    struct wb_moment_cloud cloud;
    const struct wb_cycle_specimen specimen = {.bow_angle = info.natural_shape[0]};
    assert_int_equal(wb_moment_curvature_take(&cloud, &dataset, &specimen, NULL), WB_OK);
    assert_true(worst_error(&cloud, &law, info.outer_diameter) < 0.005);
    wb_moment_curvature_release(&cloud);
    wb_dataset_release(&dataset);
}

/* The clamp's curvature at the turn, which no state of the cloud need meet. */
static double curvature_of_the_turn(const struct wb_dataset *dataset, const struct wb_law *law)
{
    const struct wb_cycle_model_settings settings = {.n_elements = 0};
    const struct wb_cycle_specimen straight = {0.0, 0.0};
    struct wb_cycle_data data;
    struct wb_cycle_model *model;
    struct wb_cycle_run run;
    assert_int_equal(wb_cycle_data_take(&data, dataset, NULL, NULL), WB_OK);
    assert_int_equal(wb_cycle_model_create(&model, &data, law, &settings), WB_OK);
    double *const tension = calloc((size_t)data.n_points, sizeof *tension);
    assert_non_null(tension);
    assert_int_equal(wb_cycle_model_run(model, law, &straight, tension, NULL, &run), WB_OK);
    assert_true(run.reached);
    free(tension);
    wb_cycle_model_destroy(model);
    wb_cycle_data_release(&data);
    return run.clamp_curvature;
}

/* The clamp's during unloading: the law bent to the largest curvature and let go. */
static void unloading_is_that_of_the_hardening_rule(void **state)
{
    (void)state;
    const struct wb_law law = soft_law();
    struct wb_dataset dataset;
    struct wb_moment_cloud cloud;
    struct wb_section section;
    struct wb_fibres *fibres;
    struct wb_fibres_response response;
    int n = 0;
    exact_dataset(&dataset, &law, 0.0);
    assert_int_equal(wb_moment_curvature_take(&cloud, &dataset, NULL, NULL), WB_OK);
    assert_int_equal(wb_section_init_law(&section, dataset.info.outer_diameter, &law, 60), WB_OK);
    assert_int_equal(wb_fibres_create(&fibres, &section), WB_OK);
    const size_t size = wb_fibres_history_size(fibres);
    double *const history = calloc(3 * size, sizeof *history);
    assert_non_null(history);
    wb_fibres_respond(fibres, 0.0, curvature_of_the_turn(&dataset, &law), history, history + size,
                      &response);
    const double largest = response.M;
    double worst = 0.0;
    for (int i = 0; i < cloud.n; i++) {
        const struct wb_moment_point *const point = &cloud.points[i];
        if (!point->is_unloading)
            continue;
        assert_close(point->s, 0.0, 0.0);
        wb_fibres_respond(fibres, 0.0, point->curvature, history + size, history + 2 * size,
                          &response);
        worst = fmax(worst, fabs(point->moment - response.M) / largest);
        n++;
    }
    print_message("unloading: %d points within %.1f %% of the largest moment\n", n, 100.0 * worst);
    assert_true(n > 5);
    assert_true(worst < 0.03);
    free(history);
    wb_fibres_destroy(fibres);
    wb_section_release(&section);
    wb_moment_curvature_release(&cloud);
    wb_dataset_release(&dataset);
}

/* --- specimens of the virtual rig --- */

enum {
    SPECIMENS = 20,
    TRUE_POINTS = 300,
    RANGES = 3
};

/* Over the largest curvature. */
static const double range_ends[RANGES + 1] = {0.12, 0.25, 0.5, 1.01};

struct errors {
    int n;
    double sum, square, scaled_square;
};

static void collect(struct errors errors[2][RANGES], const struct fast_rig *fast,
                    const struct wb_moment_cloud *cloud)
{
    double curvature[TRUE_POINTS], moment[TRUE_POINTS];
    const double step = 1.1 * cloud->largest / TRUE_POINTS;
    for (int i = 0; i < TRUE_POINTS; i++)
        curvature[i] = step * (i + 1);
    fast_rig_truth(fast, TRUE_POINTS, curvature, moment, NULL, NULL);
    for (int i = 0; i < cloud->n; i++) {
        const struct wb_moment_point *const point = &cloud->points[i];
        if (point->is_unloading || point->is_band)
            continue;
        const int k = (int)(point->curvature / step) - 1;
        assert_true(k >= 0 && k < TRUE_POINTS - 1);
        const double slope = (moment[k + 1] - moment[k]) / step;
        const double truth = moment[k] + (point->curvature - curvature[k]) * slope;
        const double error = point->moment / truth - 1.0;
        const double scaled = (point->moment - truth) / (slope * point->deviation);
        int range = 0;
        while (range < RANGES - 1 && point->curvature >= range_ends[range + 1] * cloud->largest)
            range++;
        struct errors *const e = &errors[point->s > 0.0][range];
        e->n++;
        e->sum += error;
        e->square += error * error;
        e->scaled_square += scaled * scaled;
    }
}

static void rig_shows_its_wires(void **state)
{
    (void)state;
    for (int type = 1; type <= 3; type++) {
        struct errors errors[2][RANGES] = {{{0}}};
        for (int k = 0; k < SPECIMENS; k++) {
            struct fast_rig fast;
            struct wb_dataset dataset;
            struct wb_moment_cloud cloud;
            fast_rig_init(&fast, type, 85 * mm, 5000 + (uint64_t)k);
            fast.every_frame = 1;
            assert_int_equal(fast_rig_run(&fast, &dataset), WB_OK);
            assert_int_equal(wb_moment_curvature_take(&cloud, &dataset, NULL, NULL), WB_OK);
            collect(errors, &fast, &cloud);
            wb_moment_curvature_release(&cloud);
            wb_dataset_release(&dataset);
        }
        for (int place = 0; place < 2; place++) {
            for (int r = 0; r < RANGES; r++) {
                const struct errors *const e = &errors[place][r];
                const double bias = e->sum / e->n;
                const double scatter = sqrt(fmax(e->square / e->n - bias * bias, 0.0));
                const double scaled = sqrt(e->scaled_square / e->n);
                print_message("type %d, %s, %.2f to %.2f: moment off by %+.1f %%, scatter %.1f %%, "
                              "over its deviation %.2f (%d points)\n",
                              type, place == 0 ? "clamp" : "along", range_ends[r],
                              range_ends[r + 1], 100.0 * bias, 100.0 * scatter, scaled, e->n);
                assert_true(fabs(bias) < (r == 0 ? 0.023 : 0.01));
                assert_true(scatter < (r == 0 ? 0.05 : r == 1 ? 0.028 : 0.018));
                assert_true(scaled > 0.5 && scaled < 1.7);
            }
        }
    }
}

static struct wb_law scaled_law(const struct wb_law *law, double factor)
{
    struct wb_law result = *law;
    for (int i = 0; i < result.n_parts; i++)
        result.parts[i].modulus *= factor;
    result.material.youngs_modulus *= factor;
    return result;
}

static bool is_apart(const struct wb_moment_cloud *const *clouds, int n, const struct wb_law *law,
                     double diameter)
{
    struct wb_moment_comparison comparison;
    assert_int_equal(wb_moment_curvature_compare(clouds, n, law, diameter, &comparison), WB_OK);
    assert_true(comparison.n >= 4);
    if (comparison.is_apart) {
        assert_true(comparison.last > comparison.first);
        assert_true(comparison.in_deviations > 3.0);
    }
    return comparison.is_apart;
}

/* A law fitted to a specimen agrees with what its cameras and cell say by themselves; one that is
 * 10 % off does not. */
static void fitted_law_does_not_warn_and_a_wrong_one_does(void **state)
{
    (void)state;
    enum {
        EACH = 4
    };
    int n_false = 0, n_found = 0;
    for (int type = 1; type <= 3; type++) {
        struct wb_moment_cloud clouds[EACH];
        const struct wb_moment_cloud *list[EACH];
        struct wb_law law = {.form = WB_LAW_LUDWIK};
        double diameter = 0.0;
        for (int k = 0; k < EACH; k++) {
            const struct wb_material near = {
                WB_HARDENING_ISOTROPIC_POWER, 5.6e9, 0.39, 5e6, 8.5e8, 0.78};
            struct fast_rig fast;
            struct wb_dataset dataset;
            struct wb_cycle_data data;
            struct wb_cycle_fit fit;
            struct wb_cycle_fit_settings settings;
            struct wb_law start;
            fast_rig_init(&fast, type, 85 * mm, 6000 + (uint64_t)k);
            fast.every_frame = 1;
            assert_int_equal(fast_rig_run(&fast, &dataset), WB_OK);
            assert_int_equal(wb_cycle_data_take(&data, &dataset, NULL, NULL), WB_OK);
            diameter = data.info.outer_diameter;
            const struct wb_cycle_grid grid = {1.2e-4, 0.5 * diameter * 28.0};
            wb_cycle_fit_default_settings(&settings);
            wb_law_init_ludwik(&start, &near);
            assert_int_equal(wb_cycle_fit_run(&fit, &data, WB_CANDIDATE_PARALLEL_KINEMATIC, &start,
                                              NULL, &grid, &settings, NULL),
                             WB_OK);
            const struct wb_cycle_specimen specimen = {fit.bow_angle, fit.level};
            assert_int_equal(wb_moment_curvature_take(&clouds[k], &dataset, &specimen, NULL),
                             WB_OK);
            law = fit.law;
            list[k] = &clouds[k];
            const struct wb_law low = scaled_law(&law, 0.9), high = scaled_law(&law, 1.1);
            n_false += is_apart(&list[k], 1, &law, diameter);
            n_found += is_apart(&list[k], 1, &low, diameter);
            n_found += is_apart(&list[k], 1, &high, diameter);
            wb_cycle_fit_release(&fit);
            wb_cycle_data_release(&data);
            wb_dataset_release(&dataset);
        }
        /* All of a type against a law that is far off all of them. */
        const struct wb_law low = scaled_law(&law, 0.8);
        assert_true(is_apart(list, EACH, &low, diameter));
        for (int k = 0; k < EACH; k++)
            wb_moment_curvature_release(&clouds[k]);
    }
    print_message("%d false alarms of %d; %d of %d laws 10 %% off found\n", n_false, 3 * EACH,
                  n_found, 6 * EACH);
    assert_int_equal(n_false, 0);
    assert_int_equal(n_found, 6 * EACH);
}

static void without_points_there_is_no_comparison(void **state)
{
    (void)state;
    const struct wb_law law = soft_law();
    const struct wb_moment_cloud empty = {0}, *const list[] = {&empty};
    struct wb_moment_comparison comparison;
    assert_int_equal(wb_moment_curvature_compare(list, 1, &law, mm, &comparison), WB_OK);
    assert_int_equal(comparison.n, 0);
    assert_false(comparison.is_apart);
}

static void shapes_are_wanted(void **state)
{
    (void)state;
    const struct wb_law law = soft_law();
    struct wb_dataset dataset;
    struct wb_moment_cloud cloud;
    struct wb_reason why = {""};
    exact_dataset(&dataset, &law, 0.0);
    dataset.n_shape_rows = 0;
    assert_int_equal(wb_moment_curvature_take(&cloud, &dataset, NULL, &why), WB_ERR_DATA);
    assert_non_null(strstr(why.text, "no shapes of at least 3 markers"));
    assert_null(cloud.points);
    dataset.info.is_follower = true;
    assert_int_equal(wb_moment_curvature_take(&cloud, &dataset, NULL, &why), WB_ERR_DATA);
    wb_dataset_release(&dataset);
}

static void points_are_written_as_json(void **state)
{
    (void)state;
    struct wb_moment_point points[] = {
        {.curvature = 2.5, .moment = 1.5e-3, .deviation = 0.1, .s = 17 * mm},
        {.curvature = 0.5, .moment = 1e-4, .deviation = 0.2, .is_unloading = true, .is_band = true},
    };
    const struct wb_moment_cloud cloud = {.n = 2, .points = points};
    struct wb_json *const json = wb_json_create();
    struct wb_json *const array = wb_json_set_array(json, "cloud");
    const char *text;
    double number;
    bool band;
    wb_moment_curvature_put(array, &cloud);
    assert_int_equal(wb_json_length(array), 2);
    assert_true(wb_json_get_number(wb_json_item(array, 0), "curvature_1_m", &number));
    assert_close(number, 2.5, 0.0);
    assert_true(wb_json_get_number(wb_json_item(array, 0), "curvature_deviation_1_m", &number));
    assert_close(number, 0.1, 0.0);
    assert_true(wb_json_get_number(wb_json_item(array, 0), "moment_N_mm", &number));
    assert_close(number, 1.5, 1e-12);
    assert_true(wb_json_get_number(wb_json_item(array, 0), "s_mm", &number));
    assert_close(number, 17.0, 1e-12);
    assert_true(wb_json_get_text(wb_json_item(array, 1), "branch", &text));
    assert_string_equal(text, "unloading");
    assert_true(wb_json_get_boolean(wb_json_item(array, 1), "band", &band));
    assert_true(band);
    wb_json_destroy(json);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exact_shapes_give_the_moments_of_the_law),
        cmocka_unit_test(weight_counterweight_strand_and_bow_count),
        cmocka_unit_test(unloading_is_that_of_the_hardening_rule),
        cmocka_unit_test(rig_shows_its_wires),
        cmocka_unit_test(fitted_law_does_not_warn_and_a_wrong_one_does),
        cmocka_unit_test(without_points_there_is_no_comparison),
        cmocka_unit_test(shapes_are_wanted),
        cmocka_unit_test(points_are_written_as_json),
    };
    gsl_set_error_handler_off();
    keep_messages();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
