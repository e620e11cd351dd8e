/* Later cycles against a test that the beam made itself, and the valley of its first loading. */
#include "tests/analysis/beam_data.h"

#include "analysis/calibration/cycle/cycle_later.h"
#include "analysis/calibration/cycle/cycle_model.h"
#include "analysis/calibration/cycle/cycle_valley.h"

enum {
    CYCLES = 3,
    STEPS = 250 /* of a way */
};

/* Goes up from `low` to `top` and back in each cycle. */
static void add_cycles(struct wb_dataset *dataset, struct wb_cycle_data *path, double low,
                       double top)
{
    double from = 0.0;
    for (int cycle = 1; cycle <= CYCLES; cycle++) {
        for (int way = 0; way < 2; way++) {
            const double begin = way == 0 ? from : top, end = way == 0 ? top : low;
            for (int i = 0; i < STEPS; i++) {
                struct wb_row row = {.t = 0.2 * path->n_points, .cycle = cycle};
                row.phase = way == 0 ? WB_PHASE_LOAD : WB_PHASE_UNLOAD;
                row.deflection = begin + (end - begin) * i / STEPS;
                row.stage = row.tip_x = row.tip_angle = (double)NAN;
                wb_dataset_add_row(dataset, &row);
                path->points[path->n_points++].deflection = row.deflection;
            }
        }
        from = low;
    }
    path->n_loading = path->n_points;
}

static void make_test(struct wb_dataset *dataset, const struct wb_law *law)
{
    const struct wb_test_info info = beam_info(0, 0.085, 0.0);
    const struct wb_cycle_specimen specimen = {0.0, 0.0};
    const struct wb_cycle_model_settings settings = {.n_elements = 20};
    struct wb_cycle_data path = {.info = info};
    struct wb_cycle_model *model;
    struct wb_cycle_run run;
    wb_dataset_init(dataset);
    dataset->info = info;
    path.points = calloc(2 * CYCLES * STEPS, sizeof *path.points);
    double *const tension = calloc(2 * CYCLES * STEPS, sizeof *tension);
    assert_true(path.points && tension);
    add_cycles(dataset, &path, 35e-3, 50e-3);
    assert_int_equal(wb_cycle_model_create(&model, &path, law, &settings), WB_OK);
    assert_int_equal(wb_cycle_model_run(model, law, &specimen, tension, NULL, &run), WB_OK);
    assert_true(run.reached);
    for (int i = 0; i < path.n_points; i++) {
        dataset->rows[i].tension = tension[i];
        dataset->rows[i].force = tension[i] - tension[0];
    }
    wb_cycle_model_destroy(model);
    free(path.points);
    free(tension);
}

/* Predicts with a rule: 0 kinematic, 1 isotropic. */
static void predict(const struct wb_dataset *dataset, struct wb_law law, double share,
                    struct wb_cycle_later *later)
{
    struct wb_cycle_data data;
    law.isotropic_share = share;
    const struct wb_cycle_fit fit = {.law = law};
    assert_int_equal(wb_cycle_data_take(&data, dataset, NULL, NULL), WB_OK);
    assert_int_equal(wb_cycle_later_predict(later, dataset, &data, &fit), WB_OK);
    assert_int_equal(later->n_cycles, CYCLES);
    assert_true(later->n > 30);
    wb_cycle_data_release(&data);
}

static void the_true_law_predicts_its_own_later_cycles_and_another_rule_does_not(void **state)
{
    (void)state;
    const struct wb_material material = beam_material(0);
    struct wb_dataset dataset;
    struct wb_cycle_later right, wrong;
    struct wb_law law;
    wb_law_init_ludwik(&law, &material);
    law.isotropic_share = 0.0;
    make_test(&dataset, &law);
    predict(&dataset, law, 0.0, &right);
    assert_true(right.rms < 2e-3);
    assert_true(right.measured_energy > 0.0);
    assert_close_relative(right.computed_energy, right.measured_energy, 0.03);
    predict(&dataset, law, 1.0, &wrong);
    assert_true(wrong.rms > 5.0 * right.rms);
    wb_cycle_later_release(&right);
    wb_cycle_later_release(&wrong);
    wb_dataset_release(&dataset);
}

static void the_valley_holds_the_true_pair_and_rises_around_it(void **state)
{
    (void)state;
    const struct wb_material material = beam_material(0);
    struct wb_cycle_valley valley;
    struct wb_dataset dataset;
    struct wb_cycle_data data;
    struct wb_law law;
    wb_law_init_ludwik(&law, &material);
    make_test(&dataset, &law);
    /* Noise that a cell has: without any there is no valley. */
    for (size_t i = 0; i < dataset.n_rows; i++)
        dataset.rows[i].tension += 1e-4 * sin(1.7 * (double)i);
    assert_int_equal(wb_cycle_data_take(&data, &dataset, NULL, NULL), WB_OK);
    assert_int_equal(wb_cycle_valley_find(&valley, &data, &law, NULL), WB_OK);
    assert_true(valley.limit > valley.best_misfit);
    assert_true(valley.strength_low < valley.strength_high);
    assert_close_relative(valley.best.hardening_exponent, material.hardening_exponent, 0.1);
    const struct wb_cycle_valley_node *const corner = &valley.nodes[0][0];
    assert_true(!(corner->misfit <= valley.limit));
    wb_cycle_data_release(&data);
    wb_dataset_release(&dataset);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_true_law_predicts_its_own_later_cycles_and_another_rule_does_not),
        cmocka_unit_test(the_valley_holds_the_true_pair_and_rises_around_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
