/* What scatter between specimens lets a perfect model be off by, tried on many campaigns of the
 * virtual rig. The model is fitted to the nominal wire, without noise and scatter. */
#include "tests/messages.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/calibration/cycle/cycle_fit.h"
#include "analysis/calibration/paper/first_guess.h"
#include "analysis/dataset/curve.h"
#include "analysis/validation/validate.h"
#include "base/log.h"
#include "base/units.h"
#include "tests/analysis/fast_rig.h"

enum {
    TYPE = 2,
    CAMPAIGNS = 200,
    SPECIMENS = 3,
    MOST_BEYOND = 18 /* of 200 at 5 %: more in less than 1 % of such tests */
};

static const double calibrated_at = 0.085, validated_at = 0.1;

/* Ludwik's law first, from which parallel parts start. */
static void fit_nominal(struct wb_properties *properties)
{
    struct fast_rig fast;
    struct wb_dataset dataset;
    const struct wb_dataset *const datasets[] = {&dataset};
    struct wb_curve curve;
    struct wb_first_guess guess;
    struct wb_cycle_data data;
    struct wb_cycle_fit_settings settings;
    struct wb_cycle_fit fit;
    struct wb_law law;

    fast_rig_init(&fast, TYPE, calibrated_at, 1);
    fast.noise = 0.01;
    fast.truth.stiffness_factor = fast.truth.yield_factor = 1.0;
    assert_int_equal(fast_rig_run(&fast, &dataset), WB_OK);
    assert_int_equal(wb_curve_average_on(&curve, datasets, 1, NULL, NULL), WB_OK);
    assert_int_equal(wb_first_guess_run(&guess, &curve, &dataset.info, 0.05, 0.05, NULL), WB_OK);
    const struct wb_material start = {
        .hardening = WB_HARDENING_ISOTROPIC_POWER,
        .youngs_modulus = guess.youngs_modulus,
        .poissons_ratio = dataset.info.poissons_ratio,
        .yield_stress = guess.yield_stress,
        .strength_coefficient = guess.strength_coefficient,
        .hardening_exponent = guess.hardening_exponent,
    };
    wb_law_init_ludwik(&law, &start);
    assert_int_equal(wb_cycle_data_take(&data, &dataset, NULL, NULL), WB_OK);
    wb_cycle_fit_default_settings(&settings);
    const double radius = 0.5 * dataset.info.outer_diameter;
    struct wb_cycle_grid grid = {.first_strain =
                                     radius * 1.5 * WB_MM / (calibrated_at * calibrated_at),
                                 .last_strain = radius * 30.0};
    assert_int_equal(
        wb_cycle_fit_run(&fit, &data, WB_CANDIDATE_LUDWIK_KINEMATIC, &law, &grid, &settings, NULL),
        WB_OK);
    law = fit.law;
    grid.last_strain = radius * fit.clamp_curvature;
    wb_cycle_fit_release(&fit);
    assert_int_equal(wb_cycle_fit_run(&fit, &data, WB_CANDIDATE_PARALLEL_KINEMATIC, &law, &grid,
                                      &settings, NULL),
                     WB_OK);
    assert_true(fit.misfit < 1e-3);
    *properties = (struct wb_properties){
        .outer_diameter = dataset.info.outer_diameter,
        .mass_per_length = dataset.info.mass_per_length,
        .material = fit.law.material,
        .law = fit.law,
        .largest_curvature = fit.clamp_curvature,
        .is_rule_tested = true,
        .scatter_rms = (double)NAN,
        .residual_scatter_rms = (double)NAN,
        .stiffness_deviation = (double)NAN,
    };
    strcpy(properties->wire, dataset.info.wire);
    wb_cycle_fit_release(&fit);
    wb_cycle_data_release(&data);
    wb_curve_release(&curve);
    wb_dataset_release(&dataset);
}

/* False where the beginning of a test is lost, which is refused. */
static bool validate(const struct wb_properties *properties, int campaign,
                     struct wb_validate_result *result)
{
    struct wb_reason why = {.text = ""};
    struct wb_dataset dataset[SPECIMENS];
    const struct wb_dataset *datasets[SPECIMENS];
    for (int i = 0; i < SPECIMENS; i++) {
        struct fast_rig fast;
        fast_rig_init(&fast, TYPE, validated_at, 5000 + 10 * (uint64_t)campaign + (uint64_t)i);
        fast.cycles = 2;
        assert_int_equal(fast_rig_run(&fast, &dataset[i]), WB_OK);
        dataset[i].info.sample = i + 1;
        datasets[i] = &dataset[i];
    }
    const enum wb_status status =
        wb_validate_run(result, properties, datasets, SPECIMENS, NULL, &why);
    assert_true(status == WB_OK || status == WB_ERR_DATA);
    for (int i = 0; i < SPECIMENS; i++)
        wb_dataset_release(&dataset[i]);
    return status == WB_OK;
}

static void perfect_model_is_beyond_its_bound_in_one_of_twenty(void **state)
{
    (void)state;
    struct wb_properties properties;
    double squares = 0.0, expected = 0.0, unloading = 0.0, left = 0.0, energy = 0.0;
    int beyond = 0, done = 0;
    wb_log_set_threshold(WB_LOG_ERROR); /* seeds have gaps and odd bows */
    fit_nominal(&properties);
    for (int k = 0; done < CAMPAIGNS; k++) {
        struct wb_validate_result result;
        assert_true(k < 2 * CAMPAIGNS);
        if (!validate(&properties, k, &result))
            continue;
        done++;
        const struct wb_validate_cycles *const cycles = &result.cycles;
        beyond += result.elastoplastic.rms > result.expected_rms_95;
        squares += pow(result.elastoplastic.rms, 2) / CAMPAIGNS;
        expected += pow(result.expected_rms, 2) / CAMPAIGNS;
        unloading += pow(cycles->rms, 2) / CAMPAIGNS;
        left += (cycles->residual_computed - cycles->residual_measured) / CAMPAIGNS;
        assert_int_equal(cycles->n_loops, 1);
        energy += (cycles->loops[0].computed / cycles->loops[0].measured - 1.0) / CAMPAIGNS;
        wb_validate_result_release(&result);
    }
    print_message("%d of %d beyond; RMS %.2f %%, expected %.2f %%; unloading %.2f %%; left %+.2f "
                  "mm; second cycle %+.1f %%\n",
                  beyond, CAMPAIGNS, 100.0 * sqrt(squares), 100.0 * sqrt(expected),
                  100.0 * sqrt(unloading), left / WB_MM, 100.0 * energy);
    assert_true(beyond <= MOST_BEYOND);
    /* The bound is not kept by being wide: what is expected is what is found. */
    assert_true(sqrt(squares / expected) > 0.75 && sqrt(squares / expected) < 1.35);
    assert_true(fabs(left) < 0.5 * WB_MM);
    assert_true(fabs(energy) < 0.02);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(perfect_model_is_beyond_its_bound_in_one_of_twenty),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
