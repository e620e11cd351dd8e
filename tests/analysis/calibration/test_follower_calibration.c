/* Tests with a follower force: their curves, calibration, validation and shapes. */
#include "tests/analysis/beam_data.h"
#include "tests/analysis/follower_data.h"

#include <unistd.h>

#include "analysis/calibration/paper/calibrate.h"
#include "analysis/calibration/paper/first_guess.h"
#include "analysis/calibration/properties/properties.h"
#include "analysis/validation/validate.h"
#include "base/file.h"

static const double mm = WB_MM;
static const double degree = M_PI / 180.0;

enum {
    STEPS = 48
};
static const double last_force = 24.0;

/* The composite wire of 100 mm up to 24 N. Its deflection is largest at 20.4 N. */
static struct wb_dataset composite;

static int make_composite(void **state)
{
    (void)state;
    const struct wb_test_info info = follower_info(0.1);
    keep_messages();
    follower_dataset(&composite, &info, last_force, STEPS);
    return 0;
}

static int release_composite(void **state)
{
    (void)state;
    wb_dataset_release(&composite);
    return 0;
}

/* The shape of a follower test under a force (N): n points at equal arc length. The force may be
 * one under which the wire has curled up and the deflection decreases again. */
static enum wb_status shape_under(const struct wb_properties *properties,
                                  const struct wb_test_info *info, double force, int n, double *x,
                                  double *y, double *angle)
{
    enum {
        FORCE_STEPS = 100
    };
    const struct wb_computed_settings how = {.n_elements = 0};
    const struct wb_material *const material = &properties->law.material;
    struct wb_computed *computed;
    double s[33], deflection;
    bool reached;
    for (int i = 0; i < n; i++)
        s[i] = info->length * i / (n - 1);
    assert_int_equal(wb_computed_create(&computed, info, material, &how), WB_OK);
    assert_int_equal(wb_computed_start(computed, material, &reached), WB_OK);
    enum wb_status status = WB_OK;
    for (int i = 1; status == WB_OK && i <= FORCE_STEPS; i++) {
        assert_true(reached);
        status = wb_computed_push(computed, force * i / FORCE_STEPS, &deflection, &reached);
    }
    if (status == WB_OK)
        wb_computed_shape(computed, n, s, x, y, angle);
    wb_computed_destroy(computed);
    return status;
}

/* Material of a homogenised circle of the same outer diameter that bends like the bare core:
 * strains are scaled by the ratio of the diameters, stresses by its third power. */
static struct wb_material equivalent(void)
{
    const double ratio = 4.86 / 3.26;
    struct wb_material m = follower_core;
    m.poissons_ratio = 0.39;
    m.youngs_modulus /= pow(ratio, 4.0);
    m.yield_stress /= pow(ratio, 3.0);
    m.strength_coefficient /= pow(ratio, 3.0 + m.hardening_exponent);
    return m;
}

static struct wb_calibrate_settings quick_settings(void)
{
    struct wb_calibrate_settings settings;
    wb_calibrate_default_settings(&settings);
    settings.n_elements = BEAM_ELEMENTS;
    return settings;
}

/* A dataset of the homogenised wire itself: rows in equal steps of the force. */
static void homogenised_dataset(struct wb_dataset *dataset, const struct wb_test_info *info,
                                const struct wb_material *material)
{
    const struct wb_computed_settings settings = {.n_elements = BEAM_ELEMENTS};
    struct wb_computed *computed;
    bool reached;
    wb_dataset_init(dataset);
    dataset->info = *info;
    assert_int_equal(wb_computed_create(&computed, info, material, &settings), WB_OK);
    assert_int_equal(wb_computed_start(computed, material, &reached), WB_OK);
    for (int i = 0; i <= STEPS; i++) {
        struct wb_row row = {.t = i, .cycle = 1, .force = last_force * i / STEPS};
        row.tension = row.stage = row.tip_x = row.tip_angle = (double)NAN;
        assert_int_equal(wb_computed_push(computed, row.force, &row.deflection, &reached), WB_OK);
        assert_true(reached);
        wb_dataset_add_row(dataset, &row);
    }
    wb_computed_destroy(computed);
}

/* --- curves --- */

static void the_curve_is_deflection_at_the_rows_forces(void **state)
{
    (void)state;
    const struct wb_dataset *const datasets[] = {&composite};
    struct wb_curve curve;
    assert_int_equal(curve_average(&curve, datasets, 1, 0.0), WB_OK);
    assert_true(curve.is_follower);
    assert_int_equal(curve.n, STEPS + 1);
    assert_close_relative(curve.step, last_force / STEPS, 1e-12);
    for (int i = 0; i < curve.n; i++)
        assert_close(curve.deflection[i], composite.rows[i].deflection, 1e-12);
    assert_close_relative(curve.max_force, last_force, 1e-12);
    assert_close(curve.max_deflection, composite.rows[41].deflection, 1e-12);
    assert_true(wb_curve_scale(&curve) == curve.max_deflection);
    /* It has no force at a deflection. */
    assert_true(isnan(curve_force(&curve, 1.0 * mm)));
    wb_curve_release(&curve);

    /* Other steps are interpolated linearly between the rows. */
    const struct wb_curve_grid grid = {.force_step = 0.25};
    assert_int_equal(wb_curve_average_on(&curve, datasets, 1, &grid, NULL), WB_OK);
    assert_int_equal(curve.n, 2 * STEPS + 1);
    assert_close(curve.deflection[61],
                 0.5 * (composite.rows[30].deflection + composite.rows[31].deflection), 1e-9);
    wb_curve_release(&curve);
}

static void rows_after_the_largest_force_or_deflection_are_left_out(void **state)
{
    (void)state;
    const struct wb_test_info info = follower_info(0.1);
    struct wb_dataset dataset;
    const struct wb_dataset *const datasets[] = {&dataset};
    struct wb_curve whole, curve;
    follower_dataset(&dataset, &info, last_force, STEPS);
    assert_int_equal(curve_average(&whole, datasets, 1, 0.0), WB_OK);
    for (int i = 1; i <= 20; i++) {
        struct wb_row row = dataset.rows[STEPS];
        row.t += i;
        row.force -= 0.5 * i;
        row.deflection += 1.0 * mm * i;
        wb_dataset_add_row(&dataset, &row);
    }
    assert_int_equal(curve_average(&curve, datasets, 1, 0.0), WB_OK);
    assert_int_equal(curve.n, whole.n);
    assert_memory_equal(curve.value, whole.value, (size_t)whole.n * sizeof *whole.value);
    wb_curve_release(&curve);

    /* 50.3 mm are reached at 17 N. */
    const struct wb_curve_grid grid = {.largest_deflection = 55.0 * mm};
    assert_int_equal(wb_curve_average_on(&curve, datasets, 1, &grid, NULL), WB_OK);
    assert_close_relative(curve.max_force, 17.0, 1e-12);
    wb_curve_release(&curve);
    wb_curve_release(&whole);
    wb_dataset_release(&dataset);

    /* The same setting limits a test of the other kind. */
    const struct wb_test_info tip = beam_info(2, 0.085, 0.0);
    const struct wb_material material = beam_material(2);
    beam_dataset(&dataset, &tip, &material, 1.0 * mm, 53.0 * mm, 1.0);
    const struct wb_curve_grid below = {.step = 1.0 * mm, .largest_deflection = 30.0 * mm};
    assert_int_equal(wb_curve_average_on(&curve, datasets, 1, &below, NULL), WB_OK);
    assert_close(curve.max_deflection, 30.0 * mm, 1e-12);
    wb_curve_release(&curve);
    wb_dataset_release(&dataset);
}

static void tests_of_both_kinds_are_not_averaged(void **state)
{
    (void)state;
    struct wb_dataset other = composite;
    other.info.is_follower = false;
    const struct wb_dataset *const datasets[] = {&composite, &other, &composite};
    struct wb_curve curve;
    int group[3];
    assert_int_equal(curve_average(&curve, datasets, 2, 0.0), WB_ERR_DATA);
    assert_message("under a follower force");
    assert_int_equal(wb_curve_group(datasets, 3, group), 2);
    assert_true(group[0] == 0 && group[1] == 1 && group[2] == 0);
}

static void the_inverted_curve_agrees_with_deflection_control(void **state)
{
    (void)state;
    const struct wb_dataset *const datasets[] = {&composite};
    const struct wb_material material = equivalent();
    const struct wb_computed_settings settings = {.n_elements = 20};
    struct wb_computed *computed;
    struct wb_curve curve, turned;
    bool reached;
    double force;
    assert_int_equal(curve_average(&curve, datasets, 1, 0.0), WB_OK);
    assert_int_equal(wb_computed_create(&computed, &composite.info, &material, &settings), WB_OK);
    /* Fine steps, of the homogenised wire. */
    curve.n = 200;
    curve.step = 0.1;
    double deflection[200];
    int n_reached;
    assert_int_equal(wb_computed_curve(computed, &material, 200, 0.1, deflection, &n_reached),
                     WB_OK);
    assert_int_equal(n_reached, 200);
    struct wb_curve fine = curve;
    fine.deflection = deflection;
    assert_int_equal(wb_curve_turn(&turned, &fine, 1.0 * mm, NULL), WB_OK);
    assert_false(turned.is_follower);
    assert_int_equal(turned.n, 1 + (int)floor(deflection[199] / mm));
    assert_int_equal(wb_computed_start(computed, &material, &reached), WB_OK);
    for (int i = 1; i < turned.n; i++) {
        assert_int_equal(wb_computed_move(computed, i * mm, &force, &reached), WB_OK);
        assert_true(reached);
        /* Linear between points 0.1 N apart; the curvature is largest near the end. */
        assert_close(turned.force[i], force, i * mm < 0.08 ? 0.003 : 0.01);
    }
    /* Beyond the largest deflection there is no force. */
    assert_int_equal(wb_computed_move(computed, 0.095, &force, &reached), WB_OK);
    assert_false(reached);
    wb_curve_release(&turned);
    wb_computed_destroy(computed);
    curve.n = STEPS + 1;

    for (int i = 0; i < curve.n; i++)
        curve.deflection[i] = -curve.deflection[i];
    assert_int_equal(wb_curve_turn(&turned, &curve, 1.0 * mm, NULL), WB_ERR_DATA);
    assert_message("sign");
    wb_curve_release(&curve);
}

static void a_force_can_be_set_only_in_follower_tests(void **state)
{
    (void)state;
    const struct wb_material material = equivalent();
    const struct wb_computed_settings settings = {.n_elements = BEAM_ELEMENTS};
    struct wb_test_info info = follower_info(0.1);
    struct wb_computed *computed;
    bool reached;
    double deflection;
    info.is_follower = false;
    assert_int_equal(wb_computed_create(&computed, &info, &material, &settings), WB_OK);
    assert_int_equal(wb_computed_start(computed, &material, &reached), WB_OK);
    assert_int_equal(wb_computed_push(computed, 1.0, &deflection, &reached), WB_ERR_ARGUMENT);
    wb_computed_destroy(computed);
    info.is_follower = true;
    info.strand_length = 0.76;
    assert_int_equal(wb_computed_create(&computed, &info, &material, &settings), WB_ERR_ARGUMENT);
    assert_null(computed);
}

/* --- calibration --- */

static void k_and_n_of_the_homogenised_wire_are_recovered(void **state)
{
    (void)state;
    const struct wb_test_info info = follower_info(0.1);
    const struct wb_material truth = equivalent();
    struct wb_calibrate_settings settings = quick_settings();
    struct wb_calibrate_result result;
    struct wb_dataset dataset;
    homogenised_dataset(&dataset, &info, &truth);
    settings.youngs_modulus = truth.youngs_modulus;
    settings.yield_stress = truth.yield_stress;
    assert_int_equal(calibrate_one(&result, &dataset, &settings), WB_OK);
    assert_close_relative(result.material.strength_coefficient, truth.strength_coefficient, 2e-3);
    assert_close_relative(result.material.hardening_exponent, truth.hardening_exponent, 2e-3);
    assert_true(result.rms < 2e-4);
    assert_int_equal(result.failed_evaluations, 0);
    assert_true(result.info.is_follower);
    wb_calibrate_result_release(&result);
    wb_dataset_release(&dataset);
}

/* The homogenised wire reproduces the composite one until it has curled up. The best yield point is
 * where the core yields, 0.0546 of the length; the default is close enough. */
static void the_composite_wire_is_reproduced_to_the_end(void **state)
{
    (void)state;
    static const struct {
        double yield_point, end, rms, tip, angle; /* end: m, largest deflection compared; 0: all */
    } cases[] = {
        {0.04, 0.0, 0.0075, 2.0 * WB_MM, 1.5 * M_PI / 180.0},
        {0.0, 0.0, 0.0035, 1.0 * WB_MM, 0.8 * M_PI / 180.0},
        {0.0546, 0.0, 0.001, 0.2 * WB_MM, 0.1 * M_PI / 180.0},
        {0.06, 0.0, 0.0035, 1.0 * WB_MM, 0.8 * M_PI / 180.0},
        /* If only the first three quarters are fitted, the end of the curl is extrapolated. */
        {0.0, 70.0 * WB_MM, 0.003, 20.0 * WB_MM, 15.0 * M_PI / 180.0},
    };
    const struct wb_row *const end = &composite.rows[STEPS];
    const struct wb_material bare = equivalent();
    double x[21], y[21], angle[21];
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct wb_calibrate_settings settings = quick_settings();
        struct wb_calibrate_result result;
        struct wb_properties properties;
        settings.yield_point = cases[i].yield_point;
        settings.largest_deflection = cases[i].end;
        settings.n_elements = 16;
        settings.restart = false;
        assert_int_equal(calibrate_one(&result, &composite, &settings), WB_OK);
        wb_properties_from_result(&result, &properties);
        assert_int_equal(shape_under(&properties, &composite.info, last_force, 21, x, y, angle),
                         WB_OK);
        const double away = hypot(x[20] - end->tip_x, y[20] - end->deflection);
        const double turned = angle[20] - end->tip_angle;
        print_message(
            "yield point %.4f: E %.0f, sigma_Y %.2f, K %.2f MPa, n %.4f; RMS %.5f; at "
            "%g N the tip is %.2f mm and %.2f degrees off\n",
            settings.yield_point > 0.0 ? settings.yield_point : settings.elastic_zone,
            result.material.youngs_modulus / WB_MPA, result.material.yield_stress / WB_MPA,
            result.material.strength_coefficient / WB_MPA, result.material.hardening_exponent,
            result.rms, last_force, away / mm, turned / degree);
        /* The jacket adds 0.24 % to the core's stiffness. */
        assert_close_relative(result.material.youngs_modulus, 1.0024 * bare.youngs_modulus, 1e-3);
        assert_true(result.rms < cases[i].rms);
        assert_true(away < cases[i].tip);
        assert_true(fabs(turned) < cases[i].angle);
        assert_int_equal(result.failed_evaluations, 0);
        assert_close(result.max_deflection, composite.rows[cases[i].end > 0.0 ? 36 : 41].deflection,
                     1e-12);
        wb_calibrate_result_release(&result);
    }
}

static void a_follower_test_that_did_not_yield_is_rejected(void **state)
{
    (void)state;
    const struct wb_test_info info = follower_info(0.1);
    const struct wb_calibrate_settings settings = quick_settings();
    struct wb_material elastic = equivalent();
    struct wb_calibrate_result result;
    struct wb_dataset dataset;
    elastic.hardening = WB_HARDENING_NONE_ELASTIC;
    homogenised_dataset(&dataset, &info, &elastic);
    assert_int_equal(calibrate_one(&result, &dataset, &settings), WB_ERR_DATA);
    assert_message("of the linear elastic prediction's");
    wb_dataset_release(&dataset);
    /* 5.3 mm at 6 N. */
    follower_dataset(&dataset, &info, 6.0, STEPS);
    assert_int_equal(calibrate_one(&result, &dataset, &settings), WB_ERR_DATA);
    assert_message("yield is not reached: the first loading ends at 5.00 mm");
    wb_dataset_release(&dataset);
}

/* The weight bends the wire downwards until the force lifts it; this must not affect E or the
 * fit. */
static void weight_is_part_of_the_model(void **state)
{
    (void)state;
    struct wb_test_info info = follower_info(0.1);
    const struct wb_material truth = equivalent();
    struct wb_calibrate_settings settings = quick_settings();
    struct wb_calibrate_result result;
    struct wb_dataset dataset;
    info.mass_per_length = 1.0; /* a hundred times that of such a wire's metal */
    info.gravity = WB_STANDARD_GRAVITY;
    homogenised_dataset(&dataset, &info, &truth);
    assert_true(dataset.rows[0].deflection < -0.2 * mm);
    const struct wb_computed_settings how = {.n_elements = BEAM_ELEMENTS};
    struct wb_computed *computed;
    double deflection[3];
    int reached;
    assert_int_equal(wb_computed_create(&computed, &info, &truth, &how), WB_OK);
    assert_int_equal(
        wb_computed_curve(computed, &truth, 3, last_force / STEPS, deflection, &reached), WB_OK);
    for (int i = 0; i < 3; i++)
        assert_close(deflection[i], dataset.rows[i].deflection, 1e-9);
    wb_computed_destroy(computed);
    settings.yield_stress = truth.yield_stress;
    assert_int_equal(calibrate_one(&result, &dataset, &settings), WB_OK);
    assert_close_relative(result.material.youngs_modulus, truth.youngs_modulus, 5e-3);
    assert_close_relative(result.material.strength_coefficient, truth.strength_coefficient, 5e-3);
    assert_true(result.rms < 5e-4);
    wb_calibrate_result_release(&result);
    wb_dataset_release(&dataset);
}

/* Multiplying all forces by a factor is equivalent to a wire with all stresses multiplied by it. */
static void deviations_are_those_of_the_samples(void **state)
{
    (void)state;
    const double factor[3] = {0.998, 1.001, 1.001};
    const struct wb_test_info info = follower_info(0.1);
    struct wb_calibrate_settings settings = quick_settings();
    struct wb_calibrate_result result;
    struct wb_dataset dataset[3];
    const struct wb_dataset *datasets[3];
    for (int i = 0; i < 3; i++) {
        struct wb_material truth = equivalent();
        truth.youngs_modulus *= factor[i];
        truth.yield_stress *= factor[i];
        truth.strength_coefficient *= factor[i];
        homogenised_dataset(&dataset[i], &info, &truth);
        datasets[i] = &dataset[i];
    }
    settings.restart = false;
    assert_int_equal(wb_calibrate_run(&result, datasets, 3, &settings, NULL), WB_OK);
    assert_int_equal(result.n_samples, 3);
    assert_close_relative(result.deviation[0] / result.material.youngs_modulus, 0.001, 0.02);
    assert_close_relative(result.deviation[1] / result.material.yield_stress, 0.001, 0.02);
    assert_close_relative(result.deviation[2], 0.001, 0.3);
    assert_true(result.deviation[3] < 0.001);
    print_message("deviation of n %.5f, scatter %.5f\n", result.deviation[3], result.scatter_rms);
    /* All differences between the samples are in the model. */
    assert_close_relative(result.residual_scatter_rms, result.scatter_rms, 1e-6);
    wb_calibrate_result_release(&result);
    for (int i = 0; i < 3; i++)
        wb_dataset_release(&dataset[i]);
}

/* --- validation --- */

/* Result of the calibration with the yield point at 0.0546 of the length. */
static struct wb_properties fitted_properties(void)
{
    struct wb_properties properties = {
        .wire = "8awg",
        .outer_diameter = 4.86e-3,
        .material = {WB_HARDENING_ISOTROPIC_POWER, 13845e6, 0.39, 55.11e6, 85.73e6, 0.3273}};
    properties.calibration_length = properties.rms = (double)NAN;
    properties.scatter_rms = properties.residual_scatter_rms = (double)NAN;
    properties.largest_curvature = properties.stiffness_deviation = (double)NAN;
    wb_law_init_ludwik(&properties.law, &properties.material);
    return properties;
}

static void another_length_is_predicted_with_its_curl(void **state)
{
    (void)state;
    const struct wb_properties properties = fitted_properties();
    const struct wb_test_info info = follower_info(0.12);
    const struct wb_calibrate_settings settings = {.n_elements = 25};
    struct wb_dataset dataset;
    struct wb_validate_result result;
    follower_dataset(&dataset, &info, 20.0, 40);
    const struct wb_dataset *const datasets[] = {&dataset};
    assert_int_equal(wb_validate_run(&result, &properties, datasets, 1, &settings, NULL), WB_OK);
    print_message("L = 120 mm: RMS %.4f, elastic %.3f; shapes RMS %.2f mm, largest %.2f mm, %d "
                  "points\n",
                  result.elastoplastic.rms, result.elastic.rms, result.shape_rms / mm,
                  result.shape_max / mm, result.n_shape_points);
    assert_true(result.elastoplastic.rms < 0.0015);
    assert_true(result.elastic.rms > 0.3);
    assert_int_equal(result.elastic.n_reached, result.curve.n);
    assert_true(result.elastoplastic.rms_from_5mm > result.elastoplastic.rms);
    /* Every position except the clamp's, in every row, including those beyond the largest
     * deflection. */
    assert_int_equal(result.n_shape_points, 10 * 41);
    assert_true(result.shape_rms < 0.15 * mm);
    assert_true(result.shape_max < 0.5 * mm);
    wb_validate_result_release(&result);
    wb_dataset_release(&dataset);
}

static void the_distance_of_the_models_own_shapes_is_zero(void **state)
{
    (void)state;
    const struct wb_properties properties = fitted_properties();
    const struct wb_calibrate_settings settings = {.n_elements = 50};
    struct wb_dataset dataset;
    struct wb_validate_result result;
    double x[11], y[11];
    homogenised_dataset(&dataset, &composite.info, &properties.material);
    for (int i = 8; i <= STEPS; i += 8) {
        const struct wb_row *const row = &dataset.rows[i];
        assert_int_equal(shape_under(&properties, &dataset.info, row->force, 11, x, y, NULL),
                         WB_OK);
        for (int k = 0; k < 11; k++) {
            const struct wb_shape_row shape = {.t = row->t,
                                               .deflection = row->deflection,
                                               .marker = k,
                                               .s = 0.01 * k,
                                               .x = x[k],
                                               .y = y[k]};
            wb_dataset_add_shape_row(&dataset, &shape);
        }
    }
    const struct wb_dataset *const datasets[] = {&dataset};
    assert_int_equal(wb_validate_run(&result, &properties, datasets, 1, &settings, NULL), WB_OK);
    assert_int_equal(result.n_shape_points, 60);
    print_message("shape max %.4f mm\n", result.shape_max / mm);
    assert_true(result.shape_max < 0.02 * mm);
    wb_validate_result_release(&result);
    wb_dataset_release(&dataset);
}

static void force_control_reaches_shapes_beyond_deflection_control(void **state)
{
    (void)state;
    const struct wb_properties properties = fitted_properties();
    struct wb_test_info info = follower_info(0.1);
    double x[33], y[33], x2[33], y2[33], angle[33];
    assert_int_equal(shape_under(&properties, &info, 18.0, 33, x, y, angle), WB_OK);
    assert_int_equal(wb_validate_shape(&properties, &info, y[32], 33, x2, y2), WB_OK);
    for (int i = 0; i < 33; i++)
        assert_close(hypot(x2[i] - x[i], y2[i] - y[i]), 0.0, 0.01 * mm);
    assert_int_equal(shape_under(&properties, &info, 23.0, 33, x, y, angle), WB_OK);
    assert_true(angle[32] > 0.5 * M_PI && x[32] < 0.0);
    assert_int_equal(wb_validate_shape(&properties, &info, 0.095, 33, x2, y2), WB_ERR_CONVERGENCE);
    info.is_follower = false;
    assert_int_equal(shape_under(&properties, &info, 18.0, 33, x, y, angle), WB_ERR_ARGUMENT);
}

static void the_csv_lists_deflections(void **state)
{
    (void)state;
    const struct wb_properties properties = fitted_properties();
    const struct wb_calibrate_settings settings = {.n_elements = BEAM_ELEMENTS};
    const struct wb_dataset *const datasets[] = {&composite};
    struct wb_validate_result result;
    char path[] = "/tmp/wirebench-follower-XXXXXX";
    char *text;
    double force, measured;
    const int descriptor = mkstemp(path);
    assert_true(descriptor >= 0);
    close(descriptor);
    assert_int_equal(wb_validate_run(&result, &properties, datasets, 1, &settings, NULL), WB_OK);
    assert_int_equal(wb_validate_write_csv(&result, path), WB_OK);
    assert_int_equal(wb_file_read(path, &text, NULL), WB_OK);
    const char *const header = strstr(text, "\nforce_N,measured_mm,low_mm,");
    assert_non_null(header);
    const char *const line = strstr(text, "\n18,");
    assert_non_null(line);
    assert_int_equal(sscanf(line, "\n%lf,%lf", &force, &measured), 2);
    assert_close(measured, result.curve.deflection[36] / mm, 1e-12);
    free(text);
    unlink(path);
    wb_validate_result_release(&result);
}

static void properties_state_the_loading(void **state)
{
    (void)state;
    const struct wb_calibrate_settings settings = quick_settings();
    struct wb_calibrate_result result = {.info = follower_info(0.1), .material = equivalent()};
    struct wb_properties properties;
    char path[] = "/tmp/wirebench-follower-XXXXXX";
    char *text;
    const int descriptor = mkstemp(path);
    assert_true(descriptor >= 0);
    close(descriptor);
    assert_int_equal(wb_properties_write(path, &result, &settings, NULL, 0, true), WB_OK);
    assert_int_equal(wb_file_read(path, &text, NULL), WB_OK);
    assert_non_null(strstr(text, "loading: follower"));
    assert_non_null(strstr(text, "over the largest deflection"));
    free(text);
    assert_int_equal(wb_properties_read(path, &properties), WB_OK);
    unlink(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_curve_is_deflection_at_the_rows_forces),
        cmocka_unit_test(rows_after_the_largest_force_or_deflection_are_left_out),
        cmocka_unit_test(tests_of_both_kinds_are_not_averaged),
        cmocka_unit_test(the_inverted_curve_agrees_with_deflection_control),
        cmocka_unit_test(a_force_can_be_set_only_in_follower_tests),
        cmocka_unit_test(k_and_n_of_the_homogenised_wire_are_recovered),
        cmocka_unit_test(the_composite_wire_is_reproduced_to_the_end),
        cmocka_unit_test(a_follower_test_that_did_not_yield_is_rejected),
        cmocka_unit_test(weight_is_part_of_the_model),
        cmocka_unit_test(deviations_are_those_of_the_samples),
        cmocka_unit_test(another_length_is_predicted_with_its_curl),
        cmocka_unit_test(the_distance_of_the_models_own_shapes_is_zero),
        cmocka_unit_test(force_control_reaches_shapes_beyond_deflection_control),
        cmocka_unit_test(the_csv_lists_deflections),
        cmocka_unit_test(properties_state_the_loading),
    };
    return cmocka_run_group_tests(tests, make_composite, release_composite);
}
