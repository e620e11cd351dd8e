/* Detection of a slack strand with scripted readings: the decision depends on the readings, not on
 * their arrival. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "daq/acquire/release.h"
#include "tests/check.h"

#define MS WB_NS_PER_MS

/* A bench that the release drives: the load is a function of the travel. */
struct bench {
    struct wb_rig rig;
    double (*load)(double travel); /* N */
    double noise;                  /* N, uniform to both sides */
    double zero;                   /* N, zero given to the release; NaN: unknown */
    double overload;               /* N, above which the cell reports overload; 0: never */
    int64_t period_ns;             /* of the readings */
    int at_once;                   /* readings that arrive together */
    int late;                      /* readings from before the step that arrive after it... */
    int late_every;                /* ... at every n-th rest; 0: never */
    int64_t t_ns;
    uint64_t seed;
    /* Result. */
    double travel;
    int rests;
};

static double slack_below_12_mm(double travel)
{
    return fmax(travel - 12.0 * WB_MM, 0.0) * 5.0 + 1.5 * WB_MN;
}

/* Half a gram on ten millimetres: a soft wire. */
static double soft(double travel)
{
    return fmax(travel - 12.0 * WB_MM, 0.0) * 0.5 + 1.5 * WB_MN;
}

static double never_slack(double travel)
{
    return travel * 2.0;
}

static double soft_and_never_slack(double travel)
{
    return travel * 0.6;
}

static double heavy(double travel)
{
    (void)travel;
    return 80.0 * WB_MN;
}

/* A clamp that jams while the wire is bent, with a smaller load than hook and counterweight may
 * have. */
static double jammed(double travel)
{
    (void)travel;
    return 36.7 * WB_MN;
}

/* The wire's load falls, until the clamp jams on its way up. */
static double jams_on_the_way(double travel)
{
    return soft(fmax(travel, 20.0 * WB_MM));
}

static struct bench make(double (*load)(double travel))
{
    struct bench bench = {.load = load, .period_ns = 10 * MS, .at_once = 1, .seed = 1};
    bench.zero = 1.5 * WB_MN;
    bench.rig.time_scale = 1.0;
    bench.rig.load_cell.capacity = 196.0 * WB_MN;
    bench.rig.load_cell.noise = 0.1 * WB_MN;
    bench.rig.load_cell.filter_delay = 0.05;
    bench.noise = 0.17 * WB_MN; /* the same, as a standard deviation */
    return bench;
}

static double noise_of(struct bench *bench)
{
    bench->seed = bench->seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return bench->noise * (2.0 * (double)(bench->seed >> 11) / 9007199254740992.0 - 1.0);
}

/* A reading of the strand at `travel`, stamped when its batch arrives. */
static void read_at(struct bench *bench, struct wb_release *release, double travel, int index)
{
    if (index % bench->at_once == 0)
        bench->t_ns += bench->at_once * bench->period_ns;
    const double force = bench->load(travel) + noise_of(bench);
    const bool overload = bench->overload > 0.0 && force > bench->overload;
    const struct wb_load_sample sample = {.t_ns = bench->t_ns,
                                          .force = overload ? (double)NAN : force,
                                          .valid = !overload,
                                          .overload = overload};
    wb_release_add(release, &sample);
}

/* Releases from a travel on, at most up to 0. */
static enum wb_release_verdict release_from(struct bench *bench, double travel)
{
    struct wb_release release;
    wb_release_init(&release, &bench->rig, bench->zero);
    double before = travel;
    for (bench->rests = 0; travel >= 0.0; bench->rests++) {
        enum wb_release_verdict verdict = WB_RELEASE_LISTEN;
        wb_release_rest(&release, travel, bench->t_ns);
        for (int i = 0; i < 10000 && verdict == WB_RELEASE_LISTEN; i++) {
            const bool is_late = bench->late_every > 0 && i < bench->late &&
                                 bench->rests % bench->late_every == bench->late_every - 1;
            read_at(bench, &release, is_late ? before : travel, i);
            verdict = wb_release_judge(&release);
        }
        bench->travel = travel;
        if (verdict != WB_RELEASE_GO_UP)
            return verdict;
        before = travel;
        travel -= wb_release_step(&release);
    }
    return WB_RELEASE_GO_UP;
}

static void check_seen_below_12_mm(const struct bench *bench)
{
    /* Detection needs 0.75 mm of level readings, and at most two steps. */
    assert_true(bench->travel <= 11.25 * WB_MM + 1e-9);
    assert_true(bench->travel > 9.0 * WB_MM);
}

static void slack_strand_is_detected(void **state)
{
    (void)state;
    struct bench bench = make(slack_below_12_mm);
    assert_int_equal(release_from(&bench, 32.0 * WB_MM), WB_RELEASE_SLACK);
    check_seen_below_12_mm(&bench);
    bench = make(soft);
    assert_int_equal(release_from(&bench, 32.0 * WB_MM), WB_RELEASE_SLACK);
    check_seen_below_12_mm(&bench);
}

static void division_of_readings_into_reads_does_not_matter(void **state)
{
    (void)state;
    static const int at_once[] = {1, 3, 17, 200, 1500};
    static const int64_t periods[] = {1 * MS, 10 * MS, 100 * MS};
    for (size_t i = 0; i < sizeof at_once / sizeof at_once[0]; i++) {
        for (size_t k = 0; k < sizeof periods / sizeof periods[0]; k++) {
            struct bench bench = make(slack_below_12_mm);
            bench.at_once = at_once[i];
            bench.period_ns = periods[k];
            assert_int_equal(release_from(&bench, 32.0 * WB_MM), WB_RELEASE_SLACK);
            check_seen_below_12_mm(&bench);
        }
    }
}

/* Readings of one position that arrive at the next one, which would give the same load at both. */
static void late_readings_do_not_suggest_a_slack_strand(void **state)
{
    (void)state;
    for (int every = 1; every <= 3; every++) {
        for (int late = 0; late <= 26; late++) {
            struct bench bench = make(soft);
            bench.late = late;
            bench.late_every = every;
            assert_int_equal(release_from(&bench, 32.0 * WB_MM), WB_RELEASE_SLACK);
            check_seen_below_12_mm(&bench);
        }
    }
}

/* A cell with a noise of 1 % of its capacity: it is read for longer, and the travel stays short. */
static void noisy_cell_is_read_for_longer(void **state)
{
    (void)state;
    int within = 0;
    for (uint64_t seed = 1; seed <= 50; seed++) {
        struct bench bench = make(slack_below_12_mm);
        bench.noise = 2.0 * WB_MN;
        bench.seed = seed;
        assert_int_equal(release_from(&bench, 32.0 * WB_MM), WB_RELEASE_SLACK);
        assert_true(bench.travel < 11.25 * WB_MM);
        within += bench.travel > 8.5 * WB_MM;
    }
    assert_true(within >= 45);
}

static void noisy_cell_needs_a_longer_travel_and_gives_no_wrong_verdict(void **state)
{
    (void)state;
    struct bench bench = make(slack_below_12_mm);
    bench.noise = 2.0 * WB_MN; /* and the rig file does not know */
    assert_int_equal(release_from(&bench, 32.0 * WB_MM), WB_RELEASE_SLACK);
    assert_true(bench.travel < 11.25 * WB_MM);
    for (uint64_t seed = 1; seed <= 50; seed++) {
        bench = make(seed % 2 ? never_slack : soft_and_never_slack);
        bench.noise = 2.0 * WB_MN;
        bench.seed = seed;
        assert_int_equal(release_from(&bench, 20.0 * WB_MM), WB_RELEASE_GO_UP);
    }
}

static void strand_that_is_slack_from_the_start_moves_one_step(void **state)
{
    (void)state;
    struct bench bench = make(slack_below_12_mm);
    assert_int_equal(release_from(&bench, 8.0 * WB_MM), WB_RELEASE_SLACK);
    assert_close(bench.travel, 7.0 * WB_MM, 1e-12);
}

static void level_reading_far_from_zero_ends_the_release_without_slack(void **state)
{
    (void)state;
    struct bench bench = make(heavy);
    assert_int_equal(release_from(&bench, 32.0 * WB_MM), WB_RELEASE_STUCK);
    assert_close(bench.travel, 26.0 * WB_MM, 1e-12);
}

static void jammed_clamp_is_not_a_slack_strand(void **state)
{
    (void)state;
    struct bench bench = make(jammed);
    assert_int_equal(release_from(&bench, 32.0 * WB_MM), WB_RELEASE_STUCK);
    bench = make(jams_on_the_way);
    assert_int_equal(release_from(&bench, 32.0 * WB_MM), WB_RELEASE_STUCK);
}

static void zero_may_have_a_large_offset(void **state)
{
    (void)state;
    struct bench bench = make(jammed);
    bench.zero = 35.0 * WB_MN;
    assert_int_equal(release_from(&bench, 32.0 * WB_MM), WB_RELEASE_SLACK);
    bench = make(slack_below_12_mm);
    bench.zero = -35.0 * WB_MN;
    assert_int_equal(release_from(&bench, 32.0 * WB_MM), WB_RELEASE_STUCK);
}

static void without_a_zero_a_level_reading_is_not_called_slack(void **state)
{
    (void)state;
    double (*const loads[])(double) = {slack_below_12_mm, soft, jammed, jams_on_the_way};
    for (size_t i = 0; i < sizeof loads / sizeof loads[0]; i++) {
        struct bench bench = make(loads[i]);
        bench.zero = (double)NAN;
        assert_int_equal(release_from(&bench, 32.0 * WB_MM), WB_RELEASE_LEVEL);
    }
}

static void overloaded_cell_is_unloaded(void **state)
{
    (void)state;
    struct bench bench = make(slack_below_12_mm);
    bench.overload = 60.0 * WB_MN;
    assert_int_equal(release_from(&bench, 40.0 * WB_MM), WB_RELEASE_SLACK);
    check_seen_below_12_mm(&bench);
    /* For any travel: an overload does not count as a level reading. */
    bench = make(heavy);
    bench.overload = 60.0 * WB_MN;
    assert_int_equal(release_from(&bench, 40.0 * WB_MM), WB_RELEASE_GO_UP);
}

static void invalid_readings_do_not_count(void **state)
{
    (void)state;
    const struct bench bench = make(heavy);
    struct wb_release release;
    wb_release_init(&release, &bench.rig, bench.zero);
    wb_release_rest(&release, 0.0, 0);
    for (int i = 1; i <= 100; i++) {
        const struct wb_load_sample sample = {.t_ns = i * 100 * MS, .force = (double)NAN};
        wb_release_add(&release, &sample);
        assert_int_equal(wb_release_judge(&release), WB_RELEASE_LISTEN);
    }
    assert_true(isnan(wb_release_force(&release)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slack_strand_is_detected),
        cmocka_unit_test(division_of_readings_into_reads_does_not_matter),
        cmocka_unit_test(late_readings_do_not_suggest_a_slack_strand),
        cmocka_unit_test(noisy_cell_is_read_for_longer),
        cmocka_unit_test(noisy_cell_needs_a_longer_travel_and_gives_no_wrong_verdict),
        cmocka_unit_test(strand_that_is_slack_from_the_start_moves_one_step),
        cmocka_unit_test(level_reading_far_from_zero_ends_the_release_without_slack),
        cmocka_unit_test(jammed_clamp_is_not_a_slack_strand),
        cmocka_unit_test(zero_may_have_a_large_offset),
        cmocka_unit_test(without_a_zero_a_level_reading_is_not_called_slack),
        cmocka_unit_test(overloaded_cell_is_unloaded),
        cmocka_unit_test(invalid_readings_do_not_count),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
