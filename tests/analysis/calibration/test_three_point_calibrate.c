#include "analysis/calibration/three_point/three_point_calibrate.h"

#include <stdlib.h>

#include "analysis/calibration/law/bending.h"
#include "analysis/calibration/properties/properties.h"
#include "tests/analysis/calibration/properties_path.h"
#include "tests/analysis/three_point_data.h"

static struct wb_three_point_calibrate_settings settings_of_defaults(void)
{
    struct wb_three_point_calibrate_settings settings = {.progress = NULL};
    wb_setting_fill(&wb_three_point_calibrate_tables[0], &settings.data);
    wb_setting_fill(&wb_three_point_calibrate_tables[1], &settings.fit);
    return settings;
}

static struct wb_three_point_calibration calibrate(struct wb_dataset *datasets, int n)
{
    const struct wb_three_point_calibrate_settings settings = settings_of_defaults();
    const struct wb_dataset *pointers[8];
    struct wb_three_point_calibration c;
    struct wb_reason why;
    for (int i = 0; i < n; i++)
        pointers[i] = &datasets[i];
    if (wb_three_point_calibrate_run(&c, pointers, n, &settings, &why) != WB_OK)
        fail_msg("%s", why.text);
    for (int i = 0; i < n; i++)
        wb_dataset_release(&datasets[i]);
    return c;
}

/* Compares the calibrated moments and rigidity with the truth, which must also be within the
 * intervals. */
static void compare_with_truth(const struct wb_three_point_calibration *c,
                               const struct three_point_made *made)
{
    const struct wb_material material = three_point_material(made);
    const double d = test_wire_type(2).diameter;
    double moment[WB_THREE_POINT_MOMENTS];
    struct wb_law law;
    wb_law_init_ludwik(&law, &material);
    assert_int_equal(wb_bending_moments(&law, d, WB_THREE_POINT_MOMENTS, c->curvature, moment),
                     WB_OK);
    const double EI = material.youngs_modulus * M_PI * pow(d, 4) / 64.0;
    if (c->is_rigidity_identifiable)
        assert_true(c->rigidity.low < EI && EI < c->rigidity.high);
    print_message("EI %.4g (%.4g to %.4g), truth %.4g; M at the largest curvature %+.2f %%\n",
                  1e6 * c->rigidity.value, 1e6 * c->rigidity.low, 1e6 * c->rigidity.high, 1e6 * EI,
                  100.0 * (c->moment[4].value / moment[4] - 1.0));
    for (int k = 0; k < WB_THREE_POINT_MOMENTS; k++) {
        const double tolerance = c->curvature[k] < 0.15 * c->largest_curvature ? 0.05 : 0.02;
        assert_close_relative(c->moment[k].value, moment[k], tolerance);
    }
}

static void law_and_first_contact_are_recovered(void **unused)
{
    (void)unused;
    const struct three_point_made made = {.modulus_factor = 1.0,
                                          .friction = 0.3,
                                          .nose_radius = 2e-3,
                                          .compliance = 0.05e-3,
                                          .contact = 0.4e-3,
                                          .zero = 0.02,
                                          .noise = 2e-3};
    struct wb_dataset dataset;
    three_point_make(&dataset, &made, "");
    struct wb_three_point_calibration c = calibrate(&dataset, 1);
    const struct wb_three_point_member *const m = &c.members[0];
    assert_true(m->is_fitted && m->fit.is_converged && m->data.is_zeroed);
    assert_close(m->data.zero_force, made.zero, 1e-3);
    assert_close(m->fit.first_contact, made.contact,
                 fmax(2.0 * m->fit.first_contact_error, 2e-3 * three_point_span));
    assert_true(m->fit.first_contact_error > 0.0);
    assert_true(c.misfit < 2e-3);
    assert_false(c.is_rigidity_identifiable);
    compare_with_truth(&c, &made);
    wb_three_point_calibrate_release(&c);
}

static void unloading_determines_the_hardening_rule(void **unused)
{
    (void)unused;
    const struct three_point_made made = {
        .modulus_factor = 1.0, .friction = 0.3, .nose_radius = 2e-3, .with_unloading = true};
    struct wb_dataset dataset;
    three_point_make(&dataset, &made, "");
    struct wb_three_point_calibration c = calibrate(&dataset, 1);
    assert_true(c.members[0].data.has_unloading);
    assert_true(c.is_rigidity_identifiable);
    assert_true(c.law.isotropic_share > 0.8); /* the wire's is isotropic */
    struct wb_properties read;
    assert_int_equal(wb_properties_write_three_point(path, &c, NULL, 0, true), WB_OK);
    assert_true(files_follow_schemas(path));
    assert_int_equal(wb_properties_read(path, &read), WB_OK);
    assert_true(read.is_rule_tested && read.is_rule_supported);
    assert_close_relative(read.rigidity.value, c.rigidity.value, 1e-9);
    compare_with_truth(&c, &made);
    wb_three_point_calibrate_release(&c);
}

/* Its last part has almost no modulus, which the readings cannot determine. */
static void wire_that_hardly_hardens_is_found_with_its_errors(void **unused)
{
    (void)unused;
    const struct three_point_made made = {
        .modulus_factor = 1.0, .softness = 50.0, .friction = 0.3, .nose_radius = 2e-3};
    struct wb_dataset dataset;
    three_point_make(&dataset, &made, "");
    struct wb_three_point_calibration c = calibrate(&dataset, 1);
    const struct wb_three_point_member *const m = &c.members[0];
    assert_int_equal(m->fit.n_moved, WB_THREE_POINT_PARTS + 1);
    for (int k = 0; k < WB_THREE_POINT_MOMENTS; k++)
        assert_true(m->moment_error[k] > 0.0 && m->moment_error[k] < 0.2);
    compare_with_truth(&c, &made);
    wb_three_point_calibrate_release(&c);
}

static double moment_of(const struct three_point_made *made, double curvature)
{
    const struct wb_material material = three_point_material(made);
    struct wb_law law;
    double moment;
    wb_law_init_ludwik(&law, &material);
    assert_int_equal(wb_bending_moments(&law, test_wire_type(2).diameter, 1, &curvature, &moment),
                     WB_OK);
    return moment;
}

/* 0.3 mm is 0.015 of the span. The curve hardly determines it, but the moment depends on it. */
static void bow_of_the_specimen_is_taken_into_account(void **unused)
{
    (void)unused;
    const struct three_point_made made = {.modulus_factor = 1.0,
                                          .friction = 0.3,
                                          .nose_radius = 2e-3,
                                          .contact = 0.2e-3,
                                          .noise = 2e-3,
                                          .bow = 0.3e-3};
    const struct wb_band says[] = {{false, (double)NAN, (double)NAN, (double)NAN},
                                   {true, 0.3e-3, 0.3e-3, 0.3e-3},
                                   {true, 0.2e-3, 0.0, 0.4e-3},
                                   {true, 0.0, -1e-3, 1e-3}};
    double misfit[4];
    for (int i = 0; i < 4; i++) {
        struct wb_dataset dataset;
        three_point_make(&dataset, &made, "");
        dataset.info.piece.natural_bow = says[i];
        struct wb_three_point_calibration c = calibrate(&dataset, 1);
        const struct wb_three_point_fit *const fit = &c.members[0].fit;
        misfit[i] = fit->misfit;
        print_message(
            "bow %+.3f +- %.3f mm (prior %+.3f +- %.3f), identifiable: %d, correlation with the "
            "contact %+.2f, misfit %.2g\n",
            1e3 * fit->bow, 1e3 * fit->bow_error, 1e3 * says[i].value,
            250.0 * (says[i].most - says[i].least), fit->is_bow_identifiable,
            fit->bow_contact_correlation, fit->misfit);
        const double truth = moment_of(&made, c.largest_curvature);
        print_message("    M at the largest curvature %+.2f %%, interval %.3g to %.3g of it\n",
                      100.0 * (c.moment[4].value / truth - 1.0), c.moment[4].low / truth,
                      c.moment[4].high / truth);
        /* A straight wire is wrong; a value and a range include the truth. */
        assert_int_equal(c.moment[4].low < truth && truth<c.moment[4].high, i> 0);
        if (i == 1)
            compare_with_truth(&c, &made);
        if (i < 2)
            assert_true(fit->bow_error == 0.0 && !fit->is_bow_identifiable);
        else
            assert_close(fit->bow, made.bow, 2.5 * fit->bow_error);
        assert_close(fit->bow, i == 0 ? 0.0 : made.bow, i < 2 ? 1e-12 : 0.3e-3);
        wb_three_point_calibrate_release(&c);
    }
    assert_true(misfit[1] < misfit[0]);
}

static void kink_and_given_travel_end_the_range(void **unused)
{
    (void)unused;
    const struct three_point_made made = {
        .modulus_factor = 1.0, .friction = 0.2, .nose_radius = 2e-3, .noise = 1e-3, .slip = 3.2e-3};
    struct wb_three_point_calibrate_settings settings = settings_of_defaults();
    struct wb_three_point_data data;
    struct wb_dataset dataset;
    three_point_make(&dataset, &made, "");
    assert_int_equal(wb_three_point_data_make(&data, &dataset, &settings.data, NULL), WB_OK);
    assert_int_equal(data.limit, WB_THREE_POINT_LIMIT_KINK);
    assert_close(data.usable, made.slip, 0.1e-3);
    for (int i = 1; i < data.n_points; i++)
        assert_true(data.points[i].travel > data.points[i - 1].travel);
    assert_true(data.points[0].travel >= data.first_contact + 0.00999 * three_point_span);
    wb_three_point_data_release(&data);
    settings.data.usable = 2e-3;
    assert_int_equal(wb_three_point_data_make(&data, &dataset, &settings.data, NULL), WB_OK);
    assert_int_equal(data.limit, WB_THREE_POINT_LIMIT_GIVEN);
    assert_close(data.usable, 2e-3, 1e-9);
    wb_three_point_data_release(&data);
    wb_dataset_release(&dataset);
}

/* A soft wire's force is little above the noise of the machine. */
static void noise_is_not_a_kink_and_does_not_hide_the_contact(void **unused)
{
    (void)unused;
    struct wb_three_point_calibrate_settings settings = settings_of_defaults();
    for (int i = 0; i < 5; i++) {
        const struct three_point_made made = {.modulus_factor = 1.0,
                                              .softness = 4.0,
                                              .friction = 0.2,
                                              .nose_radius = 2e-3,
                                              .noise = 0.15,
                                              .contact = 1e-3};
        struct wb_three_point_data data;
        struct wb_dataset dataset;
        three_point_make(&dataset, &made, "");
        assert_int_equal(wb_three_point_data_make(&data, &dataset, &settings.data, NULL), WB_OK);
        print_message("noise %.1f %% of the largest force, contact at %.3f of %.3f mm, %s\n",
                      100.0 * data.noise / data.max_force, 1e3 * data.first_contact,
                      1e3 * made.contact, wb_three_point_limit_name(data.limit));
        assert_int_equal(data.limit, WB_THREE_POINT_LIMIT_END);
        assert_close(data.first_contact, made.contact, 0.15e-3);
        wb_three_point_data_release(&data);
        wb_dataset_release(&dataset);
    }
}

/* A wire that is seated with a jerk, and a single outlier. */
static void a_jerk_at_the_start_and_an_outlier_are_not_kinks(void **unused)
{
    (void)unused;
    const struct three_point_made made = {
        .modulus_factor = 1.0, .friction = 0.2, .nose_radius = 2e-3, .noise = 1e-3};
    struct wb_three_point_calibrate_settings settings = settings_of_defaults();
    for (int stray = 0; stray < 2; stray++) {
        struct wb_three_point_data data;
        struct wb_dataset dataset;
        three_point_make(&dataset, &made, "");
        for (size_t i = 0; i < dataset.n_rows; i++) {
            struct wb_row *const row = &dataset.rows[i];
            if (stray && i == 120)
                row->force *= 1.06;
            if (!stray && i >= 6 && i < 12)
                row->force = 0.3 * dataset.rows[3].force;
        }
        assert_int_equal(wb_three_point_data_make(&data, &dataset, &settings.data, NULL), WB_OK);
        assert_int_equal(data.limit, WB_THREE_POINT_LIMIT_END);
        wb_three_point_data_release(&data);
        wb_dataset_release(&dataset);
    }
}

static void friction_is_not_identifiable_but_is_in_the_range(void **unused)
{
    (void)unused;
    const struct three_point_made made = {
        .modulus_factor = 1.0, .friction = 0.3, .nose_radius = 2e-3};
    struct wb_dataset dataset;
    three_point_make(&dataset, &made, "");
    dataset.info.machine.friction.known = false;
    struct wb_three_point_calibration c = calibrate(&dataset, 1);
    assert_close(c.bench.friction, 0.3, 1e-12);
    assert_close(c.variants[0].value, 0.0, 0.0);
    assert_close(c.variants[1].value, 0.6, 1e-12);
    for (int i = 0; i < 2; i++) {
        assert_true(c.variants[i].is_possible);
        assert_true(c.variants[i].misfit < 5e-3); /* as good as the truth */
        print_message("friction %g: M at the largest curvature x %.3f, misfit %.4f (%.4f)\n",
                      c.variants[i].value, c.variants[i].moment[4], c.variants[i].misfit, c.misfit);
    }
    assert_true(c.variants[0].moment[4] > 1.03 && c.variants[1].moment[4] < 0.97);
    assert_true(c.moment[4].candidates_low < 0.97 * c.moment[4].value);
    assert_true(c.moment[4].candidates_high > 1.03 * c.moment[4].value);
    wb_three_point_calibrate_release(&c);
}

static void the_scatter_of_series_does_not_average_out(void **unused)
{
    (void)unused;
    struct wb_dataset datasets[4];
    for (int i = 0; i < 4; i++) {
        const struct three_point_made made = {.modulus_factor = i < 2 ? 1.15 : 0.87,
                                              .friction = 0.2,
                                              .nose_radius = 2e-3,
                                              .noise = 2e-3};
        three_point_make(&datasets[i], &made, i < 2 ? "1" : "1b");
    }
    struct wb_three_point_calibration c = calibrate(datasets, 4);
    assert_int_equal(c.n_series, 2);
    assert_int_equal(c.n_fitted, 4);
    assert_close(c.series_deviation, log(1.15 / 0.87) / sqrt(2.0), 0.06);
    /* Two means: t of one degree of freedom. */
    assert_true(c.moment[4].high / c.moment[4].low > 2.0);
    /* The properties contain the scatter of series, not that of tests. */
    struct wb_properties read;
    assert_int_equal(wb_properties_write_three_point(path, &c, NULL, 0, true), WB_OK);
    assert_true(files_follow_schemas(path));
    assert_int_equal(wb_properties_read(path, &read), WB_OK);
    assert_int_equal(read.n_series, 2);
    assert_int_equal(read.n_samples, 4);
    assert_int_equal(wb_properties_units(&read), 2);
    assert_close(read.stiffness_deviation, log(1.15 / 0.87) / sqrt(2.0), 0.06);
    assert_false(read.is_rule_tested);
    wb_three_point_calibrate_release(&c);
}

static bool stop_at_the_second(void *context, int done, int all)
{
    *(int *)context = done;
    assert_int_equal(all, 2 * (1 + WB_THREE_POINT_VARIANTS));
    return done < 2;
}

static void threads_do_not_change_the_result_and_a_stop_ends_it(void **unused)
{
    (void)unused;
    struct wb_three_point_calibrate_settings settings = settings_of_defaults();
    struct wb_dataset datasets[2];
    const struct wb_dataset *const pointers[2] = {&datasets[0], &datasets[1]};
    struct wb_three_point_calibration one, three;
    struct wb_reason why;
    int done = 0;
    for (int i = 0; i < 2; i++) {
        const struct three_point_made made = {
            .modulus_factor = 1.0 + 0.1 * i, .friction = 0.2, .nose_radius = 2e-3, .noise = 2e-3};
        three_point_make(&datasets[i], &made, "");
        datasets[i].info.machine.friction.known = false;
    }
    settings.fit.max_iterations = 3;
    settings.threads = 1;
    assert_int_equal(wb_three_point_calibrate_run(&one, pointers, 2, &settings, NULL), WB_OK);
    settings.threads = 3;
    assert_int_equal(wb_three_point_calibrate_run(&three, pointers, 2, &settings, NULL), WB_OK);
    assert_close(one.rigidity.low, three.rigidity.low, 0.0);
    for (int k = 0; k < WB_THREE_POINT_MOMENTS; k++) {
        assert_close(one.moment[k].value, three.moment[k].value, 0.0);
        assert_close(one.moment[k].candidates_low, three.moment[k].candidates_low, 0.0);
        assert_true(one.moment[k].candidates_low < one.moment[k].value);
    }
    wb_three_point_calibrate_release(&one);
    wb_three_point_calibrate_release(&three);
    settings.threads = 1;
    settings.progress = stop_at_the_second;
    settings.progress_context = &done;
    assert_int_equal(wb_three_point_calibrate_run(&one, pointers, 2, &settings, &why),
                     WB_ERR_TIMEOUT);
    assert_int_equal(done, 2);
    wb_dataset_release(&datasets[0]);
    wb_dataset_release(&datasets[1]);
}

static void other_tests_are_rejected(void **unused)
{
    (void)unused;
    const struct three_point_made made = {
        .modulus_factor = 1.0, .friction = 0.2, .nose_radius = 2e-3};
    const struct wb_three_point_calibrate_settings settings = settings_of_defaults();
    struct wb_dataset datasets[2];
    const struct wb_dataset *pointers[2] = {&datasets[0], &datasets[1]};
    struct wb_three_point_calibration c;
    struct wb_reason why;
    three_point_make(&datasets[0], &made, "");
    three_point_make(&datasets[1], &made, "");
    datasets[1].info.length = 2.0 * three_point_span;
    assert_int_equal(wb_three_point_calibrate_run(&c, pointers, 2, &settings, &why), WB_ERR_DATA);
    assert_non_null(strstr(why.text, "different benches"));
    datasets[1].info.length = three_point_span;
    snprintf(datasets[1].info.wire, sizeof datasets[1].info.wire, "other");
    assert_int_equal(wb_three_point_calibrate_run(&c, pointers, 2, &settings, &why), WB_ERR_DATA);
    assert_non_null(strstr(why.text, "expected one wire"));
    for (size_t i = 0; i < datasets[0].n_rows; i++)
        datasets[0].rows[i].force = 0.0;
    assert_int_equal(wb_three_point_calibrate_run(&c, pointers, 1, &settings, &why), WB_ERR_DATA);
    assert_non_null(strstr(why.text, "first contact"));
    assert_null(strstr(why.text, "scatter"));
    /* Only noise of 1 N. */
    uint64_t random = 20261124;
    for (size_t i = 0; i < datasets[0].n_rows; i++)
        datasets[0].rows[i].force = 2.0 * test_random(&random) - 1.0;
    assert_int_equal(wb_three_point_calibrate_run(&c, pointers, 1, &settings, &why), WB_ERR_DATA);
    assert_non_null(strstr(why.text, "first contact"));
    assert_non_null(strstr(why.text, "scatter by 0."));
    wb_dataset_release(&datasets[0]);
    wb_dataset_release(&datasets[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(law_and_first_contact_are_recovered),
        cmocka_unit_test(unloading_determines_the_hardening_rule),
        cmocka_unit_test(wire_that_hardly_hardens_is_found_with_its_errors),
        cmocka_unit_test(bow_of_the_specimen_is_taken_into_account),
        cmocka_unit_test(kink_and_given_travel_end_the_range),
        cmocka_unit_test(noise_is_not_a_kink_and_does_not_hide_the_contact),
        cmocka_unit_test(a_jerk_at_the_start_and_an_outlier_are_not_kinks),
        cmocka_unit_test(friction_is_not_identifiable_but_is_in_the_range),
        cmocka_unit_test(the_scatter_of_series_does_not_average_out),
        cmocka_unit_test(threads_do_not_change_the_result_and_a_stop_ends_it),
        cmocka_unit_test(other_tests_are_rejected),
    };
    return cmocka_run_group_tests(tests, make_path, remove_folder);
}
