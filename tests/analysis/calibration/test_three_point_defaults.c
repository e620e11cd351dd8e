/* Quality of the default settings of the three-point fit compared with alternatives: bias and
 * coverage of EI and of moments over synthetic tests with noise, a zero, a first contact and
 * seating; and for tests with unloading, the prediction of another test's force and residual
 * deflection. */
#include "analysis/calibration/law/bending.h"
#include "analysis/calibration/three_point/three_point_calibrate.h"

#include "analysis/validation/validate_three_point.h"
#include "base/units.h"
#include "tests/analysis/three_point_data.h"

enum {
    TESTS = 6,
    WAYS_BACK = 8,
    ALTERNATIVES_BACK = 2, /* unloading costs several loadings */
    NUMBERS = 1 + WB_THREE_POINT_MOMENTS
};

struct alternative {
    const char *name;
    double contact_prior, seating, part_prior; /* times the defaults */
};

static const struct alternative alternatives[] = {
    {"defaults", 1.0, 1.0, 1.0},
    {"points from 0.002 span on", 1.0, 0.2, 1.0},
    {"contact prior / 10", 0.1, 1.0, 1.0},
    {"contact prior x 10", 10.0, 1.0, 1.0},
    {"points from 0.03 span on", 1.0, 3.0, 1.0},
    {"part prior / 4", 1.0, 1.0, 0.25},
    {"part prior x 4", 1.0, 1.0, 4.0},
};
enum {
    ALTERNATIVES = sizeof alternatives / sizeof alternatives[0]
};

/* Sums of one alternative over the tests. */
struct sums {
    int n, covered[NUMBERS];
    double error[NUMBERS], squares[NUMBERS]; /* of ln(found / true) */
    /* Unloading of another test: RMS over its F_max; residual deflection predicted less true, m. */
    double unloading, residual, residual_squares, most_residual;
};

static struct three_point_made draw(uint64_t *random)
{
    return (struct three_point_made){
        .modulus_factor = exp(0.4 * (test_random(random) - 0.5)),
        .softness = exp(2.0 * (test_random(random) - 0.5)),
        .friction = 0.3,
        .nose_radius = 2e-3,
        .contact = (0.2 + 0.3 * test_random(random)) * 1e-3,
        .zero = 0.02,
        .noise = 4e-3,
        .seating = 0.004 * three_point_span * test_random(random),
    };
}

static void add(struct sums *sums, const struct wb_three_point_calibration *c,
                const struct three_point_made *made)
{
    const struct wb_material material = three_point_material(made);
    const double d = test_wire_type(2).diameter;
    double truth[NUMBERS];
    struct wb_law law;
    wb_law_init_ludwik(&law, &material);
    truth[0] = material.youngs_modulus * M_PI * pow(d, 4) / 64.0;
    assert_int_equal(wb_bending_moments(&law, d, WB_THREE_POINT_MOMENTS, c->curvature, truth + 1),
                     WB_OK);
    sums->n++;
    for (int k = 0; k < NUMBERS; k++) {
        const struct wb_estimate *const e = k == 0 ? &c->rigidity : &c->moment[k - 1];
        const double error = log(e->value / truth[k]);
        sums->error[k] += error;
        sums->squares[k] += error * error;
        sums->covered[k] += e->low < truth[k] && truth[k] < e->high;
    }
}

/* Prediction of another test of the same wire, without noise. */
static void predict(struct sums *sums, const struct wb_three_point_calibration *c,
                    const struct three_point_made *made)
{
    struct three_point_made clean = *made;
    struct wb_three_point_calibrate_settings settings = {.progress = NULL};
    struct wb_properties properties = {.wire = "type2",
                                       .outer_diameter = test_wire_type(2).diameter,
                                       .material = c->ludwik,
                                       .law = c->law,
                                       .stiffness_deviation = (double)NAN,
                                       .largest_curvature = (double)NAN,
                                       .is_rule_tested = true};
    struct wb_validate_three_point result;
    struct wb_dataset dataset;
    struct wb_reason why;
    clean.noise = clean.zero = clean.contact = clean.seating = 0.0;
    wb_setting_fill(&wb_three_point_calibrate_tables[0], &settings.data);
    wb_setting_fill(&wb_three_point_calibrate_tables[1], &settings.fit);
    three_point_make(&dataset, &clean, "");
    const struct wb_dataset *const pointer = &dataset;
    if (wb_validate_three_point_run(&result, &properties, &pointer, 1, &settings, &why) != WB_OK)
        fail_msg("%s", why.text);
    const double residual = result.residual_computed - result.residual_measured;
    if (!isfinite(residual) || !isfinite(result.unloading.rms))
        fail_msg("no unloading: %d, RMS %g, residual %g and %g mm", result.n_unloading,
                 result.unloading.rms, result.residual_computed / WB_MM,
                 result.residual_measured / WB_MM);
    sums->unloading += pow(result.unloading.rms, 2);
    sums->residual += residual;
    sums->residual_squares += residual * residual;
    sums->most_residual = fmax(sums->most_residual, result.residual_measured);
    wb_validate_three_point_release(&result);
    wb_dataset_release(&dataset);
}

static void run(struct sums *sums, const struct alternative *a, const struct three_point_made *made)
{
    struct wb_three_point_calibrate_settings settings = {.progress = NULL};
    struct wb_three_point_calibration c;
    struct wb_dataset dataset;
    struct wb_reason why;
    wb_setting_fill(&wb_three_point_calibrate_tables[0], &settings.data);
    wb_setting_fill(&wb_three_point_calibrate_tables[1], &settings.fit);
    settings.fit.contact_prior *= a->contact_prior;
    settings.fit.modulus_prior *= a->part_prior;
    settings.data.seating *= a->seating;
    three_point_make(&dataset, made, "");
    const struct wb_dataset *const pointer = &dataset;
    if (wb_three_point_calibrate_run(&c, &pointer, 1, &settings, &why) != WB_OK)
        fail_msg("%s: %s", a->name, why.text);
    add(sums, &c, made);
    if (made->with_unloading)
        predict(sums, &c, made);
    wb_three_point_calibrate_release(&c);
    wb_dataset_release(&dataset);
}

static void run_all(struct sums *sums, int n, int n_alternatives, bool with_unloading)
{
    static const char *const names[NUMBERS] = {"EI", "M at 0.05", "0.1", "0.2", "0.5", "1 kappa"};
    uint64_t random = 20261123;
    for (int i = 0; i < n; i++) {
        struct three_point_made made = draw(&random);
        made.with_unloading = with_unloading;
        for (int a = 0; a < n_alternatives; a++)
            run(&sums[a], &alternatives[a], &made);
    }
    print_message("%d tests: mean and RMS of ln(found / true) in %%, intervals that hold\n", n);
    for (int a = 0; a < n_alternatives; a++) {
        print_message("%-26s", alternatives[a].name);
        for (int k = 0; k < NUMBERS; k++)
            print_message("  %s %+.1f %.1f %d", names[k], 100.0 * sums[a].error[k] / n,
                          100.0 * sqrt(sums[a].squares[k] / n), sums[a].covered[k]);
        print_message("\n");
    }
}

static void defaults_are_as_good_as_alternatives_on_loadings(void **state)
{
    (void)state;
    struct sums sums[ALTERNATIVES] = {{0}};
    run_all(sums, TESTS, ALTERNATIVES, false);
    /* The largest moment is known within 3 %, and no alternative is much better. */
    const int last = NUMBERS - 1;
    assert_true(sqrt(sums[0].squares[last] / TESTS) < 0.03);
    for (int a = 1; a < ALTERNATIVES; a++)
        assert_true(sums[0].squares[last] < 2.0 * sums[a].squares[last] + 1e-4 * TESTS);
    /* Intervals of 95 % contain the truth; 6 of them miss it more than once in one of thirty
     * cases. */
    for (int k = 1; k < NUMBERS; k++)
        assert_true(sums[0].covered[k] >= TESTS - 1);
}

static void defaults_are_as_good_as_alternatives_on_unloadings(void **state)
{
    (void)state;
    struct sums sums[ALTERNATIVES] = {{0}};
    const int n = WAYS_BACK;
    run_all(sums, n, ALTERNATIVES_BACK, true);
    for (int a = 0; a < ALTERNATIVES_BACK; a++)
        print_message(
            "%-26s  unloading RMS %.2f %% of F_max, residual %+.3f mm, RMS %.3f mm, of %.2f "
            "mm\n",
            alternatives[a].name, 100.0 * sqrt(sums[a].unloading / n), sums[a].residual / n / WB_MM,
            sqrt(sums[a].residual_squares / n) / WB_MM, sums[a].most_residual / WB_MM);
    /* The unloading of another test and its residual deflection: within 2.5 % of F_max and 0.05 mm
     * (0.25 % of the span), and no alternative has half the error of the unloading. Points from
     * 0.002 of the span on predict the residual deflection better, but not EI. */
    assert_true(sqrt(sums[0].unloading / n) < 0.025);
    assert_true(sqrt(sums[0].residual_squares / n) < 0.05 * WB_MM);
    for (int a = 1; a < ALTERNATIVES_BACK; a++)
        assert_true(sums[0].unloading < 4.0 * sums[a].unloading &&
                    sums[0].squares[0] < 4.0 * sums[a].squares[0]);
    /* With unloading EI is identifiable within 5 %. Intervals of 95 % contain EI and the moments: 8
     * of them miss more than once in one of seventeen cases. */
    assert_true(sqrt(sums[0].squares[0] / n) < 0.05);
    for (int k = 0; k < NUMBERS; k++)
        assert_true(sums[0].covered[k] >= n - 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(defaults_are_as_good_as_alternatives_on_loadings),
        cmocka_unit_test(defaults_are_as_good_as_alternatives_on_unloadings),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
