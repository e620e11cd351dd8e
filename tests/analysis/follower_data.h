/* Datasets of a thick wire under a follower force: copper core in a PVC jacket as fibres, which the
 * calibrated homogenised wire can reproduce closely but not exactly. */
#ifndef WB_TESTS_ANALYSIS_FOLLOWER_DATA_H
#define WB_TESTS_ANALYSIS_FOLLOWER_DATA_H

#include "tests/check.h"

#include "analysis/dataset/dataset.h"
#include "base/units.h"
#include "fe/trial/loading_steps.h"

static const struct wb_material follower_core = {
    WB_HARDENING_ISOTROPIC_POWER, 68.2e9, 0.34, 182e6, 292e6, 0.31};
static const struct wb_material follower_jacket = {
    WB_HARDENING_ISOTROPIC_POWER, 41e6, 0.43, 2e6, 12e6, 0.6};

static inline struct wb_test_info follower_info(double length)
{
    return (struct wb_test_info){.wire = "8awg",
                                 .length = length,
                                 .outer_diameter = 4.86e-3,
                                 .poissons_ratio = 0.39,
                                 .is_follower = true,
                                 .rest_level = (double)NAN,
                                 .is_simulation = true};
}

/* Rows in equal steps of the force, and shapes of eleven positions. */
static inline void follower_dataset(struct wb_dataset *dataset, const struct wb_test_info *info,
                                    double force, int steps)
{
    enum {
        POSITIONS = 11
    };
    double s[POSITIONS];
    struct wb_section section;
    struct wb_cantilever_model model;
    struct wb_cantilever *cantilever;
    struct wb_loading_steps loading;
    for (int i = 0; i < POSITIONS; i++)
        s[i] = info->length * i / (POSITIONS - 1);
    const struct wb_loading_steps_plan plan = {.control = WB_CONTROL_FOLLOWER_FORCE,
                                               .maximum = force,
                                               .steps = steps,
                                               .n_shape = POSITIONS,
                                               .shape_s = s};
    wb_section_init_empty(&section);
    assert_int_equal(wb_section_add_ring(&section, 0.0, 3.26e-3, &follower_core, 1.0, 40), WB_OK);
    assert_int_equal(wb_section_add_ring(&section, 3.26e-3, 4.86e-3, &follower_jacket, 1.0, 40),
                     WB_OK);
    wb_cantilever_default_model(&model);
    model.section = &section;
    model.length = info->length;
    model.mass_per_length = info->mass_per_length;
    model.gravity_y = -info->gravity;
    assert_int_equal(wb_cantilever_create(&cantilever, &model, NULL), WB_OK);
    assert_int_equal(wb_loading_steps_init(&loading, &plan), WB_OK);
    assert_int_equal(wb_loading_steps_run(&loading, &plan, cantilever), WB_OK);
    assert_int_equal(loading.n_rows, steps + 1);
    wb_dataset_init(dataset);
    dataset->info = *info;
    for (int i = 0; i < loading.n_rows; i++) {
        const struct wb_cantilever_point *const point = &loading.rows[i].point;
        const struct wb_row row = {.t = i,
                                   .cycle = 1,
                                   .deflection = point->deflection,
                                   .tension = (double)NAN,
                                   .force = loading.rows[i].force,
                                   .stage = (double)NAN,
                                   .tip_x = point->tip_x,
                                   .tip_angle = point->tip_angle};
        wb_dataset_add_row(dataset, &row);
        for (int k = 0; k < POSITIONS; k++) {
            const struct wb_shape_row shape = {.t = i,
                                               .deflection = point->deflection,
                                               .marker = k,
                                               .s = s[k],
                                               .x = loading.shape_x[i * POSITIONS + k],
                                               .y = loading.shape_y[i * POSITIONS + k]};
            wb_dataset_add_shape_row(dataset, &shape);
        }
    }
    wb_loading_steps_release(&loading);
    wb_cantilever_destroy(cantilever);
    wb_section_release(&section);
}

#endif
