/* Datasets from the 1D beam with the paper's properties, for tests of the calibration. */
#ifndef WB_TESTS_ANALYSIS_BEAM_DATA_H
#define WB_TESTS_ANALYSIS_BEAM_DATA_H

#include "tests/messages.h"

#include <stdlib.h>

#include "analysis/calibration/paper/calibrate.h"
#include "analysis/calibration/paper/computed.h"
#include "analysis/dataset/curve.h"
#include "analysis/dataset/dataset.h"
#include "base/log.h"
#include "base/units.h"

/* Coarser than the default 50 elements: fast, and the same on both sides of every comparison. */
#define BEAM_ELEMENTS 10

/* Tables 2 and 3 of the paper: mm, g/cm3, MPa. */
struct paper_wire {
    const char *name;
    double outer_mm, density, modulus, yield, strength, exponent;
};
static const struct paper_wire paper_wires[3] = {
    {"type1", 1.10, 4.06, 5021, 3.90, 3222, 0.99},
    {"type2", 1.25, 4.31, 5641, 4.95, 850, 0.78},
    {"type3", 1.40, 4.97, 4528, 4.52, 1327, 0.90},
};

static inline struct wb_material beam_material(int type)
{
    const struct paper_wire *const wire = &paper_wires[type];
    return (struct wb_material){
        .hardening = WB_HARDENING_ISOTROPIC_POWER,
        .youngs_modulus = wire->modulus * WB_MPA,
        .poissons_ratio = 0.39,
        .yield_stress = wire->yield * WB_MPA,
        .strength_coefficient = wire->strength * WB_MPA,
        .hardening_exponent = wire->exponent,
    };
}

/* The paper's test: strand of 760 mm, counterweight 2.7 g, weight; a bow of constant curvature. */
static inline struct wb_test_info beam_info(int type, double length, double bow)
{
    const struct paper_wire *const wire = &paper_wires[type];
    const double diameter = wire->outer_mm * WB_MM;
    struct wb_test_info info = {
        .sample = 1,
        .length = length,
        .outer_diameter = diameter,
        .mass_per_length = wire->density * WB_G_PER_CM3 * M_PI * diameter * diameter / 4.0,
        .poissons_ratio = 0.39,
        .strand_length = 0.76,
        .counterweight = 2.7e-3,
        .gravity = WB_STANDARD_GRAVITY,
        .rest_level = (double)NAN,
        .is_simulation = true,
    };
    snprintf(info.wire, sizeof info.wire, "%s", wire->name);
    if (bow != 0.0) {
        info.n_natural_shape = 1;
        info.natural_shape[0] = 2.0 * bow / length;
    }
    return info;
}

/* Rows every `step` up to `last`, forces times `factor`, and shapes of seven markers. */
static inline void beam_dataset(struct wb_dataset *dataset, const struct wb_test_info *info,
                                const struct wb_material *material, double step, double last,
                                double factor)
{
    const struct wb_computed_settings settings = {.n_elements = BEAM_ELEMENTS};
    struct wb_computed *computed;
    double s[7], x[7], y[7];
    bool reached;
    wb_dataset_init(dataset);
    dataset->info = *info;
    for (int i = 0; i < 7; i++)
        s[i] = info->length * i / 6;
    assert_int_equal(wb_computed_create(&computed, info, material, &settings), WB_OK);
    assert_int_equal(wb_computed_start(computed, material, &reached), WB_OK);
    assert_true(reached);
    for (int k = 0; k * step <= last * (1.0 + 1e-9); k++) {
        struct wb_row row = {.t = 1e3 * k * step, .cycle = 1, .deflection = k * step};
        row.stage = row.tip_x = row.tip_angle = (double)NAN;
        if (k > 0) {
            assert_int_equal(wb_computed_move(computed, k * step, &row.force, &reached), WB_OK);
            assert_true(reached);
        }
        row.force *= factor;
        row.tension = row.force;
        wb_dataset_add_row(dataset, &row);
        wb_computed_shape(computed, 7, s, x, y, NULL);
        for (int i = 0; i < 7; i++) {
            const struct wb_shape_row shape = {.t = row.t,
                                               .deflection = row.deflection,
                                               .marker = i,
                                               .s = s[i],
                                               .x = x[i],
                                               .y = y[i]};
            wb_dataset_add_shape_row(dataset, &shape);
        }
    }
    wb_computed_destroy(computed);
}

/* A dataset from a function of deflection, for curves without a beam. */
static inline void plain_dataset(struct wb_dataset *dataset, double (*force)(double), double step,
                                 double last)
{
    wb_dataset_init(dataset);
    dataset->info = beam_info(0, 0.085, 0.0);
    for (int k = 0; k * step <= last * (1.0 + 1e-9); k++) {
        struct wb_row row = {.t = 1e3 * k * step, .cycle = 1, .deflection = k * step};
        row.stage = row.tip_x = row.tip_angle = (double)NAN;
        row.force = row.tension = force(row.deflection);
        wb_dataset_add_row(dataset, &row);
    }
}

/* Setup of a test or a group: messages are kept. */
static inline int silence(void **state)
{
    (void)state;
    keep_messages();
    return 0;
}

/* Settings of a fast calibration. */
static inline struct wb_calibrate_settings beam_settings(void)
{
    struct wb_calibrate_settings settings;
    wb_calibrate_default_settings(&settings);
    settings.yield_point = 0.04;
    settings.n_elements = BEAM_ELEMENTS;
    settings.step = 1.0 * WB_MM;
    return settings;
}

static inline enum wb_status calibrate_one(struct wb_calibrate_result *result,
                                           const struct wb_dataset *dataset,
                                           const struct wb_calibrate_settings *settings)
{
    return wb_calibrate_run(result, &dataset, 1, settings, NULL);
}

/* wb_curve_average_on() with a deflection step only; failures are logged. */
static inline enum wb_status
curve_average(struct wb_curve *curve, const struct wb_dataset *const *datasets, int n, double step)
{
    const struct wb_curve_grid grid = {.step = step};
    return wb_curve_average_on(curve, datasets, n, &grid, NULL);
}

/* Linear interpolation of the mean force at a deflection within 0..max_deflection; NaN outside, and
 * for a follower's curve. */
static inline double curve_force(const struct wb_curve *curve, double deflection)
{
    const double position = deflection / curve->step;
    if (curve->is_follower || !(position >= 0.0) || !(position <= (curve->n - 1) * (1.0 + 1e-12)))
        return (double)NAN;
    const int i = (int)fmin(floor(position), curve->n - 2);
    const double part = position - i;
    return (1.0 - part) * curve->force[i] + part * curve->force[i + 1];
}

#endif
