/* Benchmark: one calibration of type 3 with L = 85 mm, on a loading curve of the beam itself under
 * the paper's test (strand, counterweight, weight): seconds and beam runs.
 *
 * Baseline in the same run: the same number of beam runs with a beam created for each of them,
 * which is what an optimiser that starts a solver each time cannot avoid. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/calibration/paper/calibrate.h"
#include "analysis/calibration/paper/computed.h"
#include "base/units.h"
#include "tests/bench/clock.h"

static const double goal_s = 3.0;
static const double step = 0.5 * WB_MM;

enum {
    POINTS = 107
};

static struct wb_test_info test_info(void)
{
    const double diameter = 1.40 * WB_MM;
    struct wb_test_info info = {
        .sample = 1,
        .length = 85 * WB_MM,
        .outer_diameter = diameter,
        .mass_per_length = 4.97 * WB_G_PER_CM3 * M_PI * diameter * diameter / 4.0,
        .poissons_ratio = 0.39,
        .strand_length = 760 * WB_MM,
        .counterweight = 2.7 * WB_G,
        .gravity = WB_STANDARD_GRAVITY,
        .rest_level = (double)NAN,
        .is_simulation = true,
    };
    snprintf(info.wire, sizeof info.wire, "type3");
    return info;
}

static enum wb_status run_once(const struct wb_test_info *info, const struct wb_material *material,
                               double force[POINTS])
{
    const struct wb_computed_settings settings = {0};
    struct wb_computed *computed;
    int reached = 0;
    WB_TRY(wb_computed_create(&computed, info, material, &settings));
    const enum wb_status status =
        wb_computed_curve(computed, material, POINTS, step, force, &reached);
    wb_computed_destroy(computed);
    return status == WB_OK && reached < POINTS ? WB_ERR_CONVERGENCE : status;
}

static enum wb_status make_dataset(struct wb_dataset *dataset, const struct wb_test_info *info,
                                   const struct wb_material *material)
{
    double force[POINTS];
    wb_dataset_init(dataset);
    dataset->info = *info;
    WB_TRY(run_once(info, material, force));
    for (int i = 0; i < POINTS; i++) {
        struct wb_row row = {.t = i * step * 1e3, .cycle = 1, .deflection = i * step};
        row.force = row.tension = force[i];
        wb_dataset_add_row(dataset, &row);
    }
    return WB_OK;
}

static enum wb_status bench(void)
{
    const struct wb_material truth = {
        .hardening = WB_HARDENING_ISOTROPIC_POWER,
        .youngs_modulus = 4528 * WB_MPA,
        .poissons_ratio = 0.39,
        .yield_stress = 4.52 * WB_MPA,
        .strength_coefficient = 1327 * WB_MPA,
        .hardening_exponent = 0.90,
    };
    const struct wb_test_info info = test_info();
    struct wb_calibrate_settings settings;
    struct wb_calibrate_result result;
    struct wb_dataset dataset = {0};
    double force[POINTS];
    WB_TRY(make_dataset(&dataset, &info, &truth));
    const struct wb_dataset *const datasets[] = {&dataset};
    wb_calibrate_default_settings(&settings);
    settings.yield_point = 0.04;

    double started = cpu_seconds();
    WB_TRY(wb_calibrate_run(&result, datasets, 1, &settings, NULL));
    const double calibration = cpu_seconds() - started;

    started = cpu_seconds();
    for (int i = 0; i < result.evaluations; i++)
        WB_TRY(run_once(&info, &result.material, force));
    const double baseline = cpu_seconds() - started;

    printf("one calibration, type 3, L = 85 mm, 50 elements, 20 fibres, %d points:\n", POINTS);
    printf("  %.2f s of CPU, %d beam runs, %.2f ms each (goal: at most %g s)\n", calibration,
           result.evaluations, 1e3 * calibration / result.evaluations, goal_s);
    printf("  K = %.0f MPa (true 1327), n = %.3f (true 0.900), RMS %.1e of F_max; %s\n",
           result.material.strength_coefficient / WB_MPA, result.material.hardening_exponent,
           result.rms, wb_calibrate_end_text(result.end));
    printf("  baseline, a beam created for each run: %.2f s of CPU; ratio %.2f\n", baseline,
           baseline / calibration);
    wb_calibrate_result_release(&result);
    wb_dataset_release(&dataset);
    return WB_OK;
}

int main(void)
{
    return bench() == WB_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
