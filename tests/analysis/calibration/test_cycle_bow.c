/* The bow that a law finds from the first tension, against beams whose bow is known. */
#include "tests/analysis/beam_data.h"

#include "analysis/calibration/cycle/cycle_bow.h"
#include "base/json.h"

enum {
    POINTS = 10
};

static const struct wb_cycle_model_settings coarse = {.n_elements = 12};

/* What the alignment says: a bow, and whether it is one by the force too. */
static void make_dataset(struct wb_dataset *dataset, double bow, bool has_zero)
{
    wb_dataset_init(dataset);
    dataset->info = beam_info(1, 0.060, bow);
    dataset->info.n_natural_shape = 1;
    dataset->info.is_simulation = false;
    dataset->info.rest_level = -0.5 * WB_MM;
    struct wb_json *const checks = wb_json_set_object(dataset->document, "checks");
    struct wb_json *const shape = wb_json_set_object(checks, "natural_shape");
    if (has_zero)
        wb_json_set_number(shape, "bow_from_force_mm", bow / WB_MM);
}

static struct wb_law kinematic(void)
{
    const struct wb_material material = beam_material(1);
    struct wb_law law;
    wb_law_init_ludwik(&law, &material);
    law.isotropic_share = 0.0;
    return law;
}

/* A loading of the beam with a bow from a quarter of a millimetre on; only the first tension stays.
 */
static void bend(struct wb_cycle_data *data, const struct wb_dataset *dataset, double bow,
                 struct wb_cycle_point *points)
{
    const struct wb_law law = kinematic();
    const struct wb_cycle_specimen specimen = {.bow_angle = 2.0 * bow / dataset->info.length};
    struct wb_cycle_model *model;
    struct wb_cycle_run run;
    double tension[POINTS];
    *data = (struct wb_cycle_data){
        .info = dataset->info, .n_points = POINTS, .n_loading = POINTS, .points = points};
    for (int i = 0; i < POINTS; i++)
        points[i] = (struct wb_cycle_point){.deflection = (0.25 + i) * WB_MM};
    assert_int_equal(wb_cycle_model_create(&model, data, &law, &coarse), WB_OK);
    assert_int_equal(wb_cycle_model_run(model, &law, &specimen, tension, NULL, &run), WB_OK);
    assert_true(run.reached);
    wb_cycle_model_destroy(model);
    for (int i = 0; i < POINTS; i++)
        points[i].tension = i == 0 ? tension[i] : (double)NAN;
}

static double found(const struct wb_dataset *dataset, const struct wb_cycle_data *data)
{
    const struct wb_law law = kinematic();
    double angle;
    assert_int_equal(wb_cycle_bow_find(&angle, dataset, data, &law, &coarse), WB_OK);
    return 0.5 * angle * dataset->info.length;
}

static void the_first_tension_gives_the_bow(void **state)
{
    (void)state;
    static const double bows[] = {-4.0 * WB_MM, -1.0 * WB_MM, 0.0, 1.5 * WB_MM};
    static const double wrong[] = {-1.5 * WB_MM, 0.2 * WB_MM, 1.5 * WB_MM};
    for (size_t i = 0; i < WB_COUNT(bows); i++) {
        for (size_t k = 0; k < WB_COUNT(wrong); k++) {
            struct wb_cycle_point points[POINTS];
            struct wb_dataset dataset;
            struct wb_cycle_data data;
            make_dataset(&dataset, bows[i] + wrong[k], true);
            bend(&data, &dataset, bows[i], points);
            assert_true(points[0].tension > 0.0);
            assert_close(found(&dataset, &data), bows[i], 1e-3 * WB_MM);
            wb_dataset_release(&dataset);
        }
    }
}

static void without_a_true_zero_of_force_the_alignments_bow_stays(void **state)
{
    (void)state;
    for (int is_simulation = 0; is_simulation < 2; is_simulation++) {
        struct wb_cycle_point points[POINTS];
        struct wb_dataset dataset;
        struct wb_cycle_data data;
        make_dataset(&dataset, -3.0 * WB_MM, is_simulation);
        dataset.info.is_simulation = is_simulation;
        bend(&data, &dataset, -2.0 * WB_MM, points);
        assert_close(found(&dataset, &data), wb_dataset_bow(&dataset.info), 0.0);
        wb_dataset_release(&dataset);
    }
}

static void a_tension_that_no_bow_explains_leaves_it_too(void **state)
{
    (void)state;
    struct wb_cycle_point points[POINTS];
    struct wb_dataset dataset;
    struct wb_cycle_data data;
    make_dataset(&dataset, -3.0 * WB_MM, true);
    bend(&data, &dataset, -2.0 * WB_MM, points);
    points[0].tension = 50.0;
    assert_close(found(&dataset, &data), wb_dataset_bow(&dataset.info), 0.0);
    points[0].tension = (double)NAN;
    assert_close(found(&dataset, &data), wb_dataset_bow(&dataset.info), 0.0);
    wb_dataset_release(&dataset);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_first_tension_gives_the_bow),
        cmocka_unit_test(without_a_true_zero_of_force_the_alignments_bow_stays),
        cmocka_unit_test(a_tension_that_no_bow_explains_leaves_it_too),
    };
    return cmocka_run_group_tests(tests, silence, NULL);
}
