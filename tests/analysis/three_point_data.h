/* Datasets of three-point bending tests, computed with known laws and with the disturbances of real
 * tests. */
#ifndef WB_TESTS_ANALYSIS_THREE_POINT_DATA_H
#define WB_TESTS_ANALYSIS_THREE_POINT_DATA_H

#include "analysis/dataset/dataset.h"
#include "fe/trial/three_point_bending.h"
#include "tests/check.h"
#include "tests/fe/rod/wires.h"

/* A computed test of a wire of type 2 on a machine; the calibration should recover its values. */
struct three_point_made {
    double modulus_factor; /* on E, sigma_Y and K */
    double softness;       /* divisor of K; 0: 1 */
    double friction, nose_radius, compliance;
    double contact; /* m of travel before first contact */
    double zero;    /* N */
    double noise;   /* N, alternating */
    double slip;    /* m of deflection at which the force drops by a tenth; 0: none */
    bool with_unloading;
    /* m of travel while the wire is seated on its rollers, of which 1 - exp(-deflection / seating)
     * is reached at a deflection; 0: none. */
    double seating;
    double bow; /* m, see struct wb_three_point_fit */
};

static const double three_point_span = 20e-3, three_point_deepest = 5e-3;

static inline struct wb_material three_point_material(const struct three_point_made *made)
{
    struct wb_material material = test_wire_type(2).material;
    material.youngs_modulus *= made->modulus_factor;
    material.yield_stress *= made->modulus_factor;
    material.strength_coefficient *= made->modulus_factor;
    if (made->softness > 0.0)
        material.strength_coefficient /= made->softness;
    return material;
}

static inline void three_point_add_row(struct wb_dataset *dataset,
                                       const struct three_point_made *made, double travel,
                                       double force, enum wb_phase phase)
{
    static uint64_t random = 20261123;
    const struct wb_row row = {
        .t = (double)NAN,
        .cycle = 1,
        .phase = phase,
        .deflection = travel,
        .tension = force,
        .force = force + made->zero + made->noise * (2.0 * test_random(&random) - 1.0),
        .stage = (double)NAN,
        .tip_x = (double)NAN,
        .tip_angle = (double)NAN,
    };
    wb_dataset_add_row(dataset, &row);
}

static inline double three_point_curvature(void *context, double from_middle)
{
    const struct three_point_made *const made = context;
    (void)from_middle;
    return 8.0 * made->bow / (three_point_span * three_point_span);
}

static inline double settled(const struct three_point_made *made, double deflection)
{
    return made->seating > 0.0 ? made->seating * (1.0 - exp(-deflection / made->seating)) : 0.0;
}

static inline void three_point_make(struct wb_dataset *dataset, const struct three_point_made *made,
                                    const char *series)
{
    const double d = test_wire_type(2).diameter;
    const struct wb_band unknown = {false, (double)NAN, (double)NAN, (double)NAN};
    const struct wb_material material = three_point_material(made);
    struct wb_section section;
    struct wb_three_point_bending *bending;

    wb_dataset_init(dataset);
    dataset->info = (struct wb_test_info){
        .wire = "type2",
        .sample = 1,
        .length = three_point_span,
        .outer_diameter = d,
        .poissons_ratio = 0.39,
        .rest_level = (double)NAN,
        .kind = WB_TEST_THREE_POINT,
        .has_machine = true,
        .machine = {.name = "made",
                    .kind = WB_TEST_THREE_POINT,
                    .span = three_point_span,
                    .roller_radius = 2e-3,
                    .nose_radius = {true, made->nose_radius, made->nose_radius, made->nose_radius},
                    .friction = {true, made->friction, made->friction, made->friction},
                    .compliance = {true, made->compliance, made->compliance, made->compliance},
                    .speed = unknown},
        .piece = {.usable_travel = unknown, .natural_bow = unknown, .outer_diameter = d},
    };
    snprintf(dataset->info.piece.series, sizeof dataset->info.piece.series, "%s", series);
    assert_int_equal(wb_section_init_circle(&section, d, &material, 40), WB_OK);
    const struct wb_three_point_bending_model model = {
        .section = &section,
        .diameter = d,
        .span = three_point_span,
        .support_radius = 2e-3,
        .nose_radius = made->nose_radius,
        .friction = made->friction,
        .compliance = made->compliance,
        .natural_curvature = three_point_curvature,
        .curvature_context = (void *)(uintptr_t)made,
    };
    assert_int_equal(wb_three_point_bending_create(&bending, &model), WB_OK);
    for (int i = 0; i < 20 && made->contact > 0.0; i++)
        three_point_add_row(dataset, made, made->contact * i / 20.0, 0.0, WB_PHASE_LOAD);
    const int n = 200;
    for (int i = 0; i <= (made->with_unloading ? 2 * n : n); i++) {
        struct wb_three_point_bending_point point;
        const double w = three_point_deepest * (i <= n ? i : 2 * n - i) / n;
        assert_int_equal(wb_three_point_bending_move(bending, w, &point), WB_OK);
        assert_int_equal(point.end, WB_THREE_POINT_BENDING_CONVERGED);
        const bool slipped = made->slip > 0.0 && w >= made->slip;
        three_point_add_row(dataset, made, made->contact + point.travel + settled(made, w),
                            slipped ? 0.9 * point.force : point.force,
                            i <= n ? WB_PHASE_LOAD : WB_PHASE_UNLOAD);
    }
    wb_three_point_bending_destroy(bending);
    wb_section_release(&section);
}

#endif
