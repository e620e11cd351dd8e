/* The section model (fe/section/section_run.h) against shipped curves of the explicit one: under a
 * vertical force, without weight, as most of them are; and that of a strand with weight. */
#include "analysis/dataset/dataset.h"
#include "base/file.h"
#include "fe/section/section_run.h"
#include "tests/check.h"

/* Of the largest force, of the RMS of the differences, on the way up and back. */
static const double limit = 0.02, limit_back = 0.015;

struct pair {
    const char *dataset, *bundle;
    double friction;  /* constant; 0: the file's, which decays from 0.4 to 0.1 */
    double stiffness; /* cohesive, Pa/m; 0: the file's */
};

static double force_at(const struct wb_section_run *run, double deflection)
{
    int i = 1;
    while (i + 1 < run->n_rows && run->rows[i].point.deflection < deflection)
        i++;
    const double from = run->rows[i - 1].point.deflection, to = run->rows[i].point.deflection;
    return run->rows[i - 1].force +
           (run->rows[i].force - run->rows[i - 1].force) * (deflection - from) / (to - from);
}

static struct wb_bundle_model model;

static void read_bundle(const struct pair *pair, bool is_strand)
{
    char path[WB_PATH];
    assert_int_equal(wb_file_find_fixture(path, "bundles", pair->bundle, NULL), WB_OK);
    assert_int_equal(wb_bundle_model_read(&model, path), WB_OK);
    if (!is_strand)
        model.loads = (struct wb_bundle_loads){0};
    if (pair->friction > 0.0)
        model.interface.friction.mu_static = model.interface.friction.mu_kinetic = pair->friction;
    if (pair->stiffness > 0.0) {
        model.interface.shear_stiffness *= pair->stiffness / model.interface.normal_stiffness;
        model.interface.normal_stiffness = pair->stiffness;
    }
}

static void read_dataset(const struct pair *pair, struct wb_dataset *dataset)
{
    char path[WB_PATH], folder[WB_PATH];
    snprintf(path, sizeof path, "simulations/%s", pair->dataset);
    assert_int_equal(wb_file_find_data(folder, path), WB_OK);
    assert_int_equal(wb_dataset_read(dataset, folder, NULL), WB_OK);
}

/* RMS of the differences over the largest force. */
static double compare(const struct pair *pair, bool is_strand)
{
    struct wb_section_run run;
    struct wb_dataset dataset;
    double squares = 0.0, most = 0.0;

    read_bundle(pair, is_strand);
    read_dataset(pair, &dataset);
    assert_int_equal(wb_section_run_init(&run, &model, 26), WB_OK);
    assert_int_equal(wb_section_run(&run, &model, NULL), WB_OK);
    assert_true(run.converged);
    assert_int_equal(run.n_rows, dataset.n_rows);
    assert_true(run.residual <= 1e-6);
    for (size_t i = 0; i < dataset.n_rows; i++) {
        const double difference =
            force_at(&run, dataset.rows[i].deflection) - dataset.rows[i].force;
        squares += difference * difference;
        most = fmax(most, dataset.rows[i].force);
    }
    const double rms = sqrt(squares / (double)dataset.n_rows) / most;
    print_message("%-22s mu %.2f: RMS %.2f %% of F_max, F(53 mm) %.4f N, explicit %.4f N\n",
                  pair->dataset, run.friction, 100.0 * rms, run.rows[run.n_rows - 1].force, most);
    wb_section_run_release(&run);
    wb_dataset_release(&dataset);
    return rms;
}

static void curves_with_constant_friction_agree_within_two_percent(void **unused)
{
    (void)unused;
    static const struct pair pairs[] = {
        {"7-type3-constant", "7-type3", 0.4, 0.0},
        {"12-type3-constant", "12-type3", 0.4, 0.0},
        {"19-type3-constant", "19-type3", 0.4, 0.0},
        {"27-type3-constant", "27-type3", 0.4, 0.0},
        {"7-type3-friction-0.2", "7-type3", 0.2, 0.0},
        {"7-type3-friction-0.6", "7-type3", 0.6, 0.0},
        {"7-type3-cohesion-3", "7-type3", 0.4, 3e9},
        {"7-type3-cohesion-300", "7-type3", 0.4, 300e9},
    };
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++)
        assert_true(compare(&pairs[i], false) < limit);
}

static void curves_with_decaying_friction_agree_with_its_mean_within_two_percent(void **unused)
{
    (void)unused;
    static const struct pair pairs[] = {
        {"7-type3", "7-type3", 0.0, 0.0},
        {"12-type3", "12-type3", 0.0, 0.0},
        {"19-type3", "19-type3", 0.0, 0.0},
        {"27-type3", "27-type3", 0.0, 0.0},
        {"7-type3-one-layer", "7-type3-one-layer", 0.0, 0.0},
        {"7-type3-turned", "7-type3-turned", 0.0, 0.0},
        {"7-type3-capped", "7-type3-capped", 0.0, 0.0},
        {"7-type3-circle", "7-type3-circle", 0.0, 0.0},
        {"12-type3-wider-bond", "12-type3-wider-bond", 0.0, 0.0},
        {"19-type3-wider-bond", "19-type3-wider-bond", 0.0, 0.0},
    };
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++)
        assert_true(compare(&pairs[i], false) < limit);
}

static void the_curve_on_a_strand_with_weight_agrees_within_two_percent(void **unused)
{
    (void)unused;
    static const struct pair pair = {"7-type3-strand", "7-type3", 0.0, 0.0};
    assert_true(compare(&pair, true) < limit);
}

/* Where the unloading of an explicit cycle reaches zero force, or that of the section model. */
static double left_at(size_t from, size_t to, const double deflection[], const double force[])
{
    for (size_t i = from + 1; i < to; i++)
        if (force[i] <= 0.0)
            return deflection[i] +
                   (deflection[i - 1] - deflection[i]) * force[i] / (force[i] - force[i - 1]);
    return (double)NAN;
}

static void unloadings_agree_within_one_and_a_half_percent(void **unused)
{
    (void)unused;
    enum {
        MOST = 128
    };
    static const struct {
        struct pair pair;
        double deflection;
    } cycles[] = {
        {{"7-type3-cycle", "7-type3", 0.4, 0.0}, 53e-3},
        {{"12-type3-cycle", "12-type3", 0.4, 0.0}, 30e-3},
    };
    for (size_t c = 0; c < sizeof cycles / sizeof cycles[0]; c++) {
        struct wb_section_run run;
        struct wb_dataset dataset;
        double deflection[MOST], force[2][MOST], squares = 0.0, most = 0.0;
        size_t n_back = 0;

        read_bundle(&cycles[c].pair, false);
        read_dataset(&cycles[c].pair, &dataset);
        model.run.cycles = 1;
        model.run.deflection = cycles[c].deflection;
        assert_int_equal(wb_section_run_init(&run, &model, 26), WB_OK);
        assert_int_equal(wb_section_run(&run, &model, NULL), WB_OK);
        assert_true(run.converged);
        assert_int_equal(run.n_rows, dataset.n_rows);
        assert_true(dataset.n_rows <= MOST);
        const size_t top = dataset.n_rows / 2;
        for (size_t i = 0; i < dataset.n_rows; i++) {
            assert_int_equal(run.rows[i].phase, dataset.rows[i].phase);
            assert_close(run.rows[i].point.deflection, dataset.rows[i].deflection, 1e-6);
            deflection[i] = dataset.rows[i].deflection;
            force[0][i] = run.rows[i].force;
            force[1][i] = dataset.rows[i].force;
            most = fmax(most, force[1][i]);
            if (dataset.rows[i].phase == WB_PHASE_UNLOAD) {
                squares += pow(force[0][i] - force[1][i], 2.0);
                n_back++;
            }
        }
        assert_int_equal(n_back, top);
        const double rms = sqrt(squares / (double)n_back) / most;
        print_message("%-22s unloading: RMS %.2f %% of F_max, left %.2f mm, explicit %.2f mm\n",
                      cycles[c].pair.dataset, 100.0 * rms,
                      1e3 * left_at(top, dataset.n_rows, deflection, force[0]),
                      1e3 * left_at(top, dataset.n_rows, deflection, force[1]));
        assert_true(rms < limit_back);
        wb_section_run_release(&run);
        wb_dataset_release(&dataset);
    }
}

/* Where wires are loose the section model is wrong, and says so: there the tape's plastic strain is
 * beyond the limit of which solve warns. */
static void
on_a_circle_of_more_wires_the_tape_s_plastic_strain_tells_that_it_is_wrong(void **unused)
{
    (void)unused;
    static const struct pair pairs[] = {{"12-type3-circle", "12-type3-circle", 0.0, 0.0},
                                        {"19-type3-circle", "19-type3-circle", 0.0, 0.0},
                                        {"27-type3-circle", "27-type3-circle", 0.0, 0.0}};
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
        struct wb_section_run run;
        assert_true(compare(&pairs[i], false) > limit);
        assert_int_equal(wb_section_run_init(&run, &model, 2), WB_OK);
        assert_int_equal(wb_section_run(&run, &model, NULL), WB_OK);
        assert_true(run.tape_plastic > 0.010);
        wb_section_run_release(&run);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(curves_with_constant_friction_agree_within_two_percent),
        cmocka_unit_test(curves_with_decaying_friction_agree_with_its_mean_within_two_percent),
        cmocka_unit_test(the_curve_on_a_strand_with_weight_agrees_within_two_percent),
        cmocka_unit_test(unloadings_agree_within_one_and_a_half_percent),
        cmocka_unit_test(
            on_a_circle_of_more_wires_the_tape_s_plastic_strain_tells_that_it_is_wrong),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
