/* Bad input of every kind, made of good specimens of the virtual rig by changing their rows, and
 * good input, of which nothing may be said. With the argument `good`: many good specimens. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/calibration/cycle/cycle_calibrate.h"
#include "analysis/calibration/cycle/cycle_check_private.h"
#include "base/units.h"
#include "tests/analysis/fast_rig.h"
#include "tests/check.h"

#include <cmocka.h>

enum {
    MOST = 5
};

/* Of the rig's wires; that other wires may choose them is for other tests. */
static const unsigned never_chosen =
    1U << WB_CANDIDATE_LUDWIK_ISOTROPIC | 1U << WB_CANDIDATE_LUDWIK_MIXED;

struct bench {
    int n;
    struct wb_dataset datasets[MOST];
    const struct wb_dataset *list[MOST];
    struct wb_cycle_calibration calibration;
    struct wb_cycle_remarks remarks;
};

static double dwell; /* s, of the tests that follow; 0: the fast rig's */

static void add(struct bench *bench, int type, double length, double travel, uint64_t seed)
{
    struct fast_rig fast;
    struct wb_dataset *const dataset = &bench->datasets[bench->n];
    fast_rig_init(&fast, type, length, seed);
    fast.travel = travel;
    if (dwell > 0.0)
        fast.dwell = dwell;
    assert_int_equal(fast_rig_run(&fast, dataset), WB_OK);
    dataset->info.sample = (int)seed;
    bench->list[bench->n++] = dataset;
}

static struct bench *one(uint64_t seed)
{
    struct bench *const bench = calloc(1, sizeof *bench);
    assert_non_null(bench);
    add(bench, 2, 85.0 * WB_MM, 53.0 * WB_MM, seed);
    return bench;
}

static void check_rows(struct bench *bench)
{
    wb_cycle_check_data(&bench->remarks, bench->list, bench->n);
}

/* Rows, calibration, and what it made of them. */
static void check(struct bench *bench)
{
    struct wb_cycle_calibrate_settings settings;
    check_rows(bench);
    assert_null(wb_cycle_check_find(&bench->remarks, WB_CHECK_UNUSABLE));
    wb_cycle_calibrate_default_settings(&settings);
    settings.left_out = never_chosen;
    assert_int_equal(
        wb_cycle_calibrate_run(&bench->calibration, bench->list, bench->n, &settings, NULL), WB_OK);
    assert_int_equal(wb_cycle_check_run(&bench->remarks, &bench->calibration, bench->list), WB_OK);
}

static void release(struct bench *bench)
{
    wb_cycle_calibrate_release(&bench->calibration);
    for (int i = 0; i < bench->n; i++)
        wb_dataset_release(&bench->datasets[i]);
    free(bench);
}

static void print_all(const struct bench *bench)
{
    for (int i = 0; i < bench->remarks.n; i++)
        print_message("%s: %s\n", wb_cycle_check_severity_name(bench->remarks.items[i].severity),
                      bench->remarks.items[i].text);
}

static int count(const struct bench *bench, enum wb_cycle_check_severity severity)
{
    int n = 0;
    for (int i = 0; i < bench->remarks.n; i++)
        n += bench->remarks.items[i].severity == severity;
    return n;
}

/* One good specimen, looked at. */
static struct bench *good;

static int start(void **state)
{
    (void)state;
    good = one(1);
    check(good);
    return 0;
}

static int finish(void **state)
{
    (void)state;
    release(good);
    return 0;
}

/* Exactly one remark of this severity holds the words; it is of that sample and names the wire. */
static void assert_remark(const struct bench *bench, enum wb_cycle_check_severity severity,
                          int sample, const char *words)
{
    int n = 0;
    for (int i = 0; i < bench->remarks.n; i++) {
        const struct wb_cycle_remark *const remark = &bench->remarks.items[i];
        if (remark->severity != severity || !strstr(remark->text, words))
            continue;
        assert_int_equal(remark->sample, sample);
        assert_non_null(strstr(remark->text, "wire 'type"));
        assert_true(strlen(remark->text) < sizeof remark->text - 1);
        n++;
    }
    if (n != 1) {
        print_all(bench);
        fail_msg("%d remarks '%s' with '%s', expected one", n,
                 wb_cycle_check_severity_name(severity), words);
    }
}

static void assert_no_doubt(const struct bench *bench)
{
    if (wb_cycle_check_find(&bench->remarks, WB_CHECK_DOUBT)) {
        print_all(bench);
        fail_msg("good data are doubted");
    }
}

/* Unusable: refused with the one message, before any fit. */
static void assert_refused(struct bench *bench, const char *words)
{
    struct wb_reason why = {.text = ""};
    check_rows(bench);
    assert_remark(bench, WB_CHECK_UNUSABLE, bench->list[0]->info.sample, words);
    assert_int_equal(bench->remarks.n, 1);
    assert_int_equal(wb_cycle_check_refuse(&bench->remarks, &why), WB_ERR_DATA);
    assert_non_null(strstr(why.text, words));
    release(bench);
}

/* --- changes --- */

static void scale_force(struct wb_dataset *dataset, double factor)
{
    for (size_t i = 0; i < dataset->n_rows; i++) {
        dataset->rows[i].tension *= factor;
        dataset->rows[i].force *= factor;
    }
}

static void scale_deflection(struct wb_dataset *dataset, double factor)
{
    for (size_t i = 0; i < dataset->n_rows; i++)
        dataset->rows[i].deflection *= factor;
    for (size_t i = 0; i < dataset->n_shape_rows; i++)
        dataset->shape_rows[i].deflection *= factor;
}

static void shift_tension(struct wb_dataset *dataset, double by)
{
    for (size_t i = 0; i < dataset->n_rows; i++)
        dataset->rows[i].tension += by;
}

static void hit_row(struct wb_row *row, double force)
{
    row->tension += force;
    row->force += force;
}

/* One row in 500, up and down in turn. */
static int scatter_outliers(struct wb_dataset *dataset)
{
    int n = 0;
    for (size_t i = 250; i < dataset->n_rows; i += 500)
        hit_row(&dataset->rows[i], n++ % 2 == 0 ? 1.0 : -1.0);
    return n;
}

static void forget_places(struct wb_dataset *dataset)
{
    dataset->n_shape_rows = 0;
    for (size_t i = 0; i < dataset->n_rows; i++)
        dataset->rows[i].tip_x = (double)NAN;
}

/* --- units --- */

static void forces_in_other_units_are_rejected(void **state)
{
    static const struct {
        double factor;
        const char *words;
    } slips[] = {
        {1e3, "forces in millinewtons"}, {102.0, "forces in grams"}, {1e-3, "weights tared away"}};
    (void)state;
    for (size_t i = 0; i < sizeof slips / sizeof slips[0]; i++) {
        struct bench *bench = one(1);
        scale_force(&bench->datasets[0], slips[i].factor);
        assert_refused(bench, slips[i].words);
        /* Without weights to compare with. */
        if (slips[i].factor != 102.0) {
            bench = one(1);
            scale_force(&bench->datasets[0], slips[i].factor);
            bench->datasets[0].info.counterweight = bench->datasets[0].info.gravity = 0.0;
            assert_refused(bench, "solid rod");
        }
    }
}

static void deflections_in_other_units_are_rejected(void **state)
{
    (void)state;
    struct bench *bench = one(1);
    scale_deflection(&bench->datasets[0], 1e3);
    assert_refused(bench, "deflections in micrometres");
    bench = one(1);
    scale_deflection(&bench->datasets[0], 1e-3);
    assert_refused(bench, "deflections in metres");
}

/* --- lengths and travel --- */

static void another_length_is_seen_by_the_markers(void **state)
{
    (void)state;
    struct bench *const bench = calloc(1, sizeof *bench);
    add(bench, 2, 100.0 * WB_MM, 53.0 * WB_MM, 1);
    bench->datasets[0].info.length = 85.0 * WB_MM;
    assert_refused(bench, "100.0 mm long, not 85");
}

static void another_length_is_found_without_markers(void **state)
{
    (void)state;
    struct bench *const bench = calloc(1, sizeof *bench);
    add(bench, 2, 100.0 * WB_MM, 53.0 * WB_MM, 1);
    bench->datasets[0].info.length = 85.0 * WB_MM;
    forget_places(&bench->datasets[0]);
    check(bench);
    assert_remark(bench, WB_CHECK_DOUBT, 1, "length of about 100 mm");
    release(bench);
}

static void a_short_travel_gives_a_stiffness_alone(void **state)
{
    static const double travel[] = {6.5 * WB_MM, 8.0 * WB_MM, 10.0 * WB_MM};
    (void)state;
    for (size_t i = 0; i < sizeof travel / sizeof travel[0]; i++) {
        struct bench *const bench = calloc(1, sizeof *bench);
        add(bench, 2, 85.0 * WB_MM, travel[i], 1);
        check(bench);
        assert_remark(bench, WB_CHECK_DOUBT, 1, "a travel of 30 mm is enough");
        assert_int_equal(count(bench, WB_CHECK_DOUBT), 1);
        assert_false(bench->calibration.is_strength_identifiable);
        release(bench);
    }
    struct bench *const bench = calloc(1, sizeof *bench);
    add(bench, 2, 85.0 * WB_MM, 4.0 * WB_MM, 1);
    assert_refused(bench, "nothing can be determined from so little");
}

/* --- zeros --- */

static void a_wrong_zero_of_force_is_reported(void **state)
{
    static const double offsets[] = {5.0 * WB_MN, -5.0 * WB_MN};
    (void)state;
    for (size_t i = 0; i < sizeof offsets / sizeof offsets[0]; i++) {
        struct bench *const bench = one(1);
        shift_tension(&bench->datasets[0], offsets[i]);
        check(bench);
        assert_remark(bench, WB_CHECK_DOUBT, 1, "the zero of force or the counterweight is wrong");
        assert_int_equal(count(bench, WB_CHECK_DOUBT), 1);
        release(bench);
    }
}

static void a_wrong_counterweight_is_reported(void **state)
{
    (void)state;
    struct bench *const bench = one(1);
    bench->datasets[0].info.counterweight = 2.2e-3;
    check(bench);
    assert_remark(bench, WB_CHECK_DOUBT, 1, "the zero of force or the counterweight is wrong");
    release(bench);
}

/* Three specimens on a bench that holds at the turn for 2 s, as `record` does. */
static struct bench *three_held(void)
{
    struct bench *const bench = calloc(1, sizeof *bench);
    assert_non_null(bench);
    dwell = 2.0;
    for (int i = 0; i < 3; i++)
        add(bench, 2, 85.0 * WB_MM, 53.0 * WB_MM, (uint64_t)(1 + i));
    dwell = 0.0;
    return bench;
}

/* A counterweight that is wrong for all specimens, by much less than one specimen shows. A bench
 * that states its uncertainty is not wrong where the weight is off by that. */
static void a_common_counterweight_is_doubted_unless_it_is_stated(void **state)
{
    (void)state;
    static const double off[] = {0.2e-3, 0.25e-3, 0.3e-3, 0.35e-3};
    for (int i = 0; i < 8; i++) {
        struct bench *const bench = three_held();
        const bool is_stated = i % 2;
        for (int k = 0; k < bench->n; k++) {
            bench->datasets[k].info.counterweight += off[i / 2];
            bench->datasets[k].info.uncertainty.counterweight = is_stated ? off[i / 2] : 0.0;
        }
        check(bench);
        print_message("    %g g, %s\n", off[i / 2] / WB_G, is_stated ? "stated" : "not stated");
        if (is_stated)
            assert_no_doubt(bench);
        else
            assert_non_null(wb_cycle_check_find(&bench->remarks, WB_CHECK_DOUBT));
        release(bench);
    }
}

/* A stated uncertainty of 0.02 g of the counterweight does not explain a zero that is 1 mm off. */
static void a_wrong_zero_of_deflection_is_reported(void **state)
{
    static const struct {
        double offset, counterweight;
    } cases[] = {{0.8 * WB_MM, 0.0},
                 {-0.8 * WB_MM, 0.0},
                 {1.0 * WB_MM, 0.02 * WB_G},
                 {-1.0 * WB_MM, 0.02 * WB_G}};
    (void)state;
    dwell = 2.0;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct bench *const bench = one(1);
        fast_rig_shift_deflection(&bench->datasets[0], cases[i].offset);
        bench->datasets[0].info.uncertainty.counterweight = cases[i].counterweight;
        check(bench);
        assert_remark(bench, WB_CHECK_DOUBT, 1, "the zero of deflection, or of force, is wrong");
        release(bench);
    }
    dwell = 0.0;
}

static void a_common_zero_of_deflection_is_doubted(void **state)
{
    static const double offsets[] = {0.7 * WB_MM, -0.7 * WB_MM};
    (void)state;
    for (size_t i = 0; i < sizeof offsets / sizeof offsets[0]; i++) {
        struct bench *const bench = three_held();
        for (int k = 0; k < bench->n; k++)
            fast_rig_shift_deflection(&bench->datasets[k], offsets[i]);
        check(bench);
        assert_non_null(wb_cycle_check_find(&bench->remarks, WB_CHECK_DOUBT));
        release(bench);
    }
}

/* Within the limits of each specimen, and of all together not; nor hidden by another doubt. */
static void a_small_common_counterweight_is_found_beside_another_doubt(void **state)
{
    (void)state;
    struct bench *const bench = three_held();
    for (int k = 0; k < bench->n; k++)
        bench->datasets[k].info.counterweight += 0.2e-3;
    for (size_t i = 0; i < bench->datasets[0].n_rows; i += 20)
        hit_row(&bench->datasets[0].rows[i], i % 40 == 0 ? 1.0 : -1.0);
    check(bench);
    assert_remark(bench, WB_CHECK_DOUBT, 1, "rows were left out as outliers");
    assert_remark(bench, WB_CHECK_DOUBT, 0, "the zero of force or the counterweight is wrong");
    release(bench);
}

static void a_lost_natural_shape_is_found_by_the_fit(void **state)
{
    (void)state;
    struct bench *const bench = one(1);
    bench->datasets[0].info.n_natural_shape = 0;
    check(bench);
    assert_remark(bench, WB_CHECK_NOTE, 1, "has no natural shape; the fit found a bow of -2.4");
    assert_no_doubt(bench);
    assert_close(bench->calibration.rigidity.value, good->calibration.rigidity.value,
                 0.005 * good->calibration.rigidity.value);
    release(bench);
}

/* --- outliers --- */

static void outliers_are_survived_and_counted(void **state)
{
    (void)state;
    for (int single = 0; single < 2; single++) {
        struct bench *const bench = one(1);
        struct wb_dataset *const dataset = &bench->datasets[0];
        size_t row = 0;
        if (single) {
            while (dataset->rows[row].phase != WB_PHASE_LOAD ||
                   dataset->rows[row].deflection < 4.0 * WB_MM)
                row++;
            hit_row(&dataset->rows[row], 1.0);
        } else {
            assert_true(scatter_outliers(dataset) >= 4);
        }
        check(bench);
        assert_no_doubt(bench);
        assert_remark(bench, WB_CHECK_NOTE, 1, "rows were left out as outliers");
        assert_true(bench->calibration.members[0].data.n_outliers >
                    good->calibration.members[0].data.n_outliers);
        assert_close(bench->calibration.rigidity.value, good->calibration.rigidity.value,
                     0.002 * good->calibration.rigidity.value);
        for (int k = 0; k < WB_CYCLE_MOMENTS; k++)
            assert_close(bench->calibration.moment[k].value, good->calibration.moment[k].value,
                         0.002 * good->calibration.moment[k].value);
        release(bench);
    }
}

static void many_outliers_are_doubted(void **state)
{
    (void)state;
    struct bench *const bench = one(1);
    for (size_t i = 10; i < bench->datasets[0].n_rows; i += 20)
        hit_row(&bench->datasets[0].rows[i], 1.0);
    check(bench);
    assert_remark(bench, WB_CHECK_DOUBT, 1, "rows were left out as outliers");
    release(bench);
}

/* --- misfit and other specimens --- */

static void a_misfit_is_reported(void **state)
{
    (void)state;
    struct bench *const bench = one(1);
    struct wb_dataset *const dataset = &bench->datasets[0];
    /* The specimen slips in the clamp half-way up: a step that no law has. */
    for (size_t i = 0; i < dataset->n_rows; i++) {
        if (dataset->rows[i].phase == WB_PHASE_LOAD && dataset->rows[i].deflection > 25.0 * WB_MM)
            hit_row(&dataset->rows[i], -10.0 * WB_MN);
    }
    check(bench);
    assert_remark(bench, WB_CHECK_DOUBT, 1, "the best law misses the force by");
    release(bench);
}

static void an_outlying_specimen_is_reported(void **state)
{
    (void)state;
    struct bench *const bench = one(1);
    add(bench, 2, 85.0 * WB_MM, 53.0 * WB_MM, 2);
    add(bench, 1, 85.0 * WB_MM, 53.0 * WB_MM, 3);
    bench->datasets[2].info = bench->datasets[1].info;
    bench->datasets[2].info.sample = 3;
    check(bench);
    assert_remark(bench, WB_CHECK_DOUBT, 3, "lower than the others'");
    release(bench);
}

static void one_specimen_is_noted(void **state)
{
    (void)state;
    assert_remark(good, WB_CHECK_NOTE, 0, "one specimen");
    assert_no_doubt(good);
}

static void good_specimens_are_not_doubted(void **state)
{
    (void)state;
    struct bench *const bench = calloc(1, sizeof *bench);
    for (uint64_t seed = 1; seed <= 3; seed++)
        add(bench, 2, 85.0 * WB_MM, 53.0 * WB_MM, seed);
    check(bench);
    assert_no_doubt(bench);
    release(bench);
}

/* Some seconds at a deflection of the loading (NaN: at the turn), in which the force falls by a
 * part of what it is there. */
static void stop_at(struct wb_dataset *dataset, double deflection, size_t n, double fall,
                    bool has_stage)
{
    size_t turn = 0;
    for (size_t i = 1; i < dataset->n_rows; i++) {
        if (dataset->rows[i].tension > dataset->rows[turn].tension)
            turn = i;
    }
    for (size_t i = 0; isfinite(deflection) && i < turn; i++) {
        if (dataset->rows[i].deflection > deflection)
            turn = i;
    }
    struct wb_row *const rows =
        calloc(dataset->n_rows + n, sizeof *rows); /* the dataset releases them */
    assert_non_null(rows);
    memcpy(rows, dataset->rows, (turn + 1) * sizeof *rows);
    for (size_t i = 0; i < n; i++) {
        const double past = 0.05 * (double)(i + 1);
        rows[turn + 1 + i] = rows[turn];
        rows[turn + 1 + i].t += past;
        rows[turn + 1 + i].tension *=
            1.0 - fall * (1.0 - exp(-past / 0.6)) / (1.0 - exp(-2.0 / 0.6));
    }
    for (size_t i = turn + 1; i < dataset->n_rows; i++) {
        rows[i + n] = dataset->rows[i];
        rows[i + n].t += 0.05 * (double)n;
    }
    free(dataset->rows);
    dataset->rows = rows;
    dataset->n_rows += n;
    for (size_t i = 0; i < dataset->n_rows && !has_stage; i++)
        dataset->rows[i].stage = (double)NAN;
}

static void relaxation_at_rest_is_reported(void **state)
{
    (void)state;
    static const double turn = (double)NAN, amidst = 30.0 * WB_MM;
    /* At the turn Maxwell elements follow it. */
    static const struct {
        double at;
        size_t rows; /* of 0.05 s */
        double fall;
        bool has_stage;
        int doubts, notes;
    } cases[] = {{turn, 40, 0.053, true, 0, 1},  {turn, 40, 0.053, false, 0, 1},
                 {turn, 40, 0.0035, true, 0, 1}, {turn, 40, 0.0, true, 0, 0},
                 {turn, 7, 0.0, true, 0, 0},     {turn, 20, 0.0, true, 0, 0},
                 {amidst, 40, 0.08, true, 1, 0}, {amidst, 40, 0.08, false, 1, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct bench *const bench = one(1);
        int n[2] = {0, 0};
        stop_at(&bench->datasets[0], cases[i].at, cases[i].rows, cases[i].fall, cases[i].has_stage);
        check(bench);
        for (int k = 0; k < bench->remarks.n; k++) {
            const struct wb_cycle_remark *const remark = &bench->remarks.items[k];
            if (strstr(remark->text, "relaxes"))
                n[remark->severity == WB_CHECK_DOUBT]++;
        }
        assert_int_equal(n[1], cases[i].doubts);
        assert_int_equal(n[0], cases[i].notes);
        if (cases[i].fall > 0.002)
            assert_remark(bench, cases[i].doubts ? WB_CHECK_DOUBT : WB_CHECK_NOTE, 1,
                          "while nothing moves");
        release(bench);
    }
}

/* Last, because it changes the good specimen. */
static void a_held_test_is_doubted_but_not_one_held_at_rest(void **state)
{
    (void)state;
    static const char *const phases[] = {"rest", "down"};
    struct wb_json *const holds =
        wb_json_set_array(wb_json_get(good->datasets[0].document, "checks"), "holds");
    for (int i = 0; i < 2; i++) {
        struct wb_json *const hold = wb_json_append_object(holds);
        wb_json_set_text(hold, "phase", phases[i]);
        wb_json_set_number(hold, "lasted_s", 30.0 + i);
        good->remarks = (struct wb_cycle_remarks){.n = 0};
        assert_int_equal(wb_cycle_check_run(&good->remarks, &good->calibration, good->list), WB_OK);
        if (i == 0)
            assert_no_doubt(good);
    }
    assert_remark(good, WB_CHECK_DOUBT, 1, "the test was held 1 time, for 31 s in all");
}

/* Three types, four lengths, five specimens each. */
static void no_good_specimen_is_doubted(void **state)
{
    static const double lengths[] = {60.0 * WB_MM, 85.0 * WB_MM, 100.0 * WB_MM, 150.0 * WB_MM};
    (void)state;
    for (int type = 1; type <= 3; type++) {
        for (size_t k = 0; k < sizeof lengths / sizeof lengths[0]; k++) {
            struct bench *const bench = calloc(1, sizeof *bench);
            for (uint64_t seed = 1; seed <= MOST; seed++)
                add(bench, type, lengths[k], fmin(53.0 * WB_MM, 0.62 * lengths[k]), seed);
            check(bench);
            print_message("type %d, %g mm: %d notes\n", type, lengths[k] / WB_MM, bench->remarks.n);
            assert_no_doubt(bench);
            release(bench);
        }
    }
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(forces_in_other_units_are_rejected),
        cmocka_unit_test(deflections_in_other_units_are_rejected),
        cmocka_unit_test(another_length_is_seen_by_the_markers),
        cmocka_unit_test(another_length_is_found_without_markers),
        cmocka_unit_test(a_short_travel_gives_a_stiffness_alone),
        cmocka_unit_test(a_wrong_zero_of_force_is_reported),
        cmocka_unit_test(a_wrong_counterweight_is_reported),
        cmocka_unit_test(a_common_counterweight_is_doubted_unless_it_is_stated),
        cmocka_unit_test(a_wrong_zero_of_deflection_is_reported),
        cmocka_unit_test(a_common_zero_of_deflection_is_doubted),
        cmocka_unit_test(a_small_common_counterweight_is_found_beside_another_doubt),
        cmocka_unit_test(a_lost_natural_shape_is_found_by_the_fit),
        cmocka_unit_test(outliers_are_survived_and_counted),
        cmocka_unit_test(many_outliers_are_doubted),
        cmocka_unit_test(a_misfit_is_reported),
        cmocka_unit_test(an_outlying_specimen_is_reported),
        cmocka_unit_test(one_specimen_is_noted),
        cmocka_unit_test(good_specimens_are_not_doubted),
        cmocka_unit_test(relaxation_at_rest_is_reported),
        cmocka_unit_test(a_held_test_is_doubted_but_not_one_held_at_rest),
    };
    const struct CMUnitTest many[] = {
        cmocka_unit_test(no_good_specimen_is_doubted),
    };
    if (argc > 1 && strcmp(argv[1], "good") == 0)
        return cmocka_run_group_tests(many, NULL, NULL);
    return cmocka_run_group_tests(tests, start, finish);
}
