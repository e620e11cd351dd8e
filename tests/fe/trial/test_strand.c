/* The cantilever under its strand: direction of the tension, transitions to slack and taut, the
 * rest. */
#include "fe/trial/cantilever.h"

#include "tests/fe/rod/wires.h"

static const double strand_length = 0.76, wire_length = 0.085;

struct rig {
    struct test_wire wire;
    struct wb_section section;
    struct wb_cantilever_model model;
    struct wb_cantilever *cantilever;
};

/* Type 1 without weight; the test changes rig.model and then creates the cantilever. */
static void begin(struct rig *rig, int type)
{
    rig->wire = test_wire_type(type);
    rig->section = test_section(&rig->wire);
    wb_cantilever_default_model(&rig->model);
    rig->model.section = &rig->section;
    rig->model.length = wire_length;
    rig->model.strand_length = strand_length;
}

static void weigh(struct rig *rig, double counterweight)
{
    rig->model.mass_per_length = test_wire_mass(&rig->wire);
    rig->model.counterweight = counterweight;
}

static void end(struct rig *rig)
{
    wb_cantilever_destroy(rig->cantilever);
    wb_section_release(&rig->section);
}

/* Stage travel at which a strand to this tip is just taut. */
static double reach(const struct wb_cantilever_point *p)
{
    const double aside = wire_length - p->tip_x;
    return p->deflection - strand_length + sqrt(strand_length * strand_length - aside * aside);
}

static void tension_acts_towards_the_strands_upper_end(void **unused)
{
    (void)unused;
    struct rig rig;
    begin(&rig, 1);
    rig.cantilever = test_cantilever(&rig.model);
    for (int mm = 0; mm <= 53; mm++) {
        const struct wb_cantilever_point p =
            test_move(rig.cantilever, WB_CONTROL_DEFLECTION, mm * WB_MM);
        const double sine = (wire_length - p.tip_x) / strand_length;
        const double x = p.tension * sine, y = p.tension * sqrt(1.0 - sine * sine);
        assert_close(p.vertical_force, y, 1e-14);
        /* Moments about the clamp: checks the forces that act on the wire. */
        assert_close(p.root_moment, y * p.tip_x - x * p.deflection, 1e-9 * (1e-6 + p.root_moment));
        assert_false(p.slack);
    }
    end(&rig);
}

static void stage_and_deflection_control_agree(void **unused)
{
    (void)unused;
    struct rig one, two;
    int rows = 0;
    begin(&one, 3);
    weigh(&one, 0.0027);
    begin(&two, 3);
    weigh(&two, 0.0027);
    one.cantilever = test_cantilever(&one.model);
    two.cantilever = test_cantilever(&two.model);
    for (int i = 0; i <= 106; i++) {
        const double y = (i <= 53 ? i : 106 - i) * WB_MM;
        const struct wb_cantilever_point p = test_move(one.cantilever, WB_CONTROL_DEFLECTION, y);
        if (p.slack)
            break;
        const struct wb_cantilever_point q = test_move(two.cantilever, WB_CONTROL_STAGE, reach(&p));
        assert_close(q.deflection, p.deflection, 1e-9);
        assert_close(q.tension, p.tension, 1e-7);
        assert_false(q.slack);
        rows++;
    }
    assert_true(rows > 70);
    end(&one);
    end(&two);
}

static void short_strand_needs_no_more_iterations(void **unused)
{
    (void)unused;
    /* A strand of 60 mm inclines by 20 degrees: without its derivatives Newton's method would be
     * slow. */
    for (int control = WB_CONTROL_DEFLECTION; control <= WB_CONTROL_STAGE; control++) {
        struct rig rig;
        begin(&rig, 1);
        rig.wire.material.hardening = WB_HARDENING_NONE_ELASTIC;
        wb_section_release(&rig.section);
        rig.section = test_section(&rig.wire);
        rig.model.strand_length = 0.06;
        rig.cantilever = test_cantilever(&rig.model);
        int most = 0;
        for (int i = 1; i <= 10; i++) {
            const struct wb_cantilever_point p =
                test_move(rig.cantilever, (enum wb_cantilever_control)control, 4.5 * i * WB_MM);
            most = p.iterations > most ? p.iterations : most;
        }
        print_message("short strand: at most %d iterations a step of 4.5 mm\n", most);
        assert_true(most <= 5);
        end(&rig);
    }
}

static void strand_carries_counterweight_and_weight(void **unused)
{
    (void)unused;
    struct rig rig;
    begin(&rig, 1);
    rig.wire.material.hardening = WB_HARDENING_NONE_ELASTIC;
    wb_section_release(&rig.section);
    rig.section = test_section(&rig.wire);
    weigh(&rig, 0.0027);
    rig.cantilever = test_cantilever(&rig.model);
    const struct wb_cantilever_point p = test_move(rig.cantilever, WB_CONTROL_DEFLECTION, 0.0);
    /* Propped cantilever: the prop carries 3/8 of the distributed weight, and the counterweight. */
    const double weight = rig.model.mass_per_length * WB_STANDARD_GRAVITY * wire_length;
    assert_close(p.vertical_force, 0.0027 * WB_STANDARD_GRAVITY + 0.375 * weight, 1e-3 * weight);
    end(&rig);
}

static void unloading_ends_slack_where_the_tip_is_free(void **unused)
{
    (void)unused;
    for (int type = 1; type <= 3; type++) {
        struct rig rig, free_end;
        begin(&rig, type);
        weigh(&rig, 0.0);
        rig.cantilever = test_cantilever(&rig.model);
        begin(&free_end, type);
        weigh(&free_end, 0.0);
        free_end.model.strand_length = 0.0;
        free_end.cantilever = test_cantilever(&free_end.model);

        struct wb_cantilever_point p;
        for (int mm = 0; mm <= 53; mm++)
            p = test_move(rig.cantilever, WB_CONTROL_DEFLECTION, mm * WB_MM);
        double last = p.tension;
        int slack = 0;
        for (int mm = 52; mm >= 0; mm--) {
            p = test_move(rig.cantilever, WB_CONTROL_DEFLECTION, mm * WB_MM);
            assert_true(p.tension >= 0.0 && p.tension <= last);
            last = p.tension;
            if (p.slack) {
                slack++;
                assert_true(p.tension == 0.0 && p.deflection > mm * WB_MM);
            } else {
                assert_close(p.deflection, mm * WB_MM, 1e-9);
                assert_int_equal(slack, 0);
            }
            assert_close(p.control, mm * WB_MM, 1e-12);
        }
        assert_true(slack > 10);

        /* The same wire, pushed up by the same amount and released, ends at the same position. */
        test_move(free_end.cantilever, WB_CONTROL_DEFLECTION, 0.053);
        const struct wb_cantilever_point q =
            test_move(free_end.cantilever, WB_CONTROL_DEAD_FORCE, 0.0);
        assert_close(p.deflection, q.deflection, 0.02 * WB_MM);
        print_message("type %d: slack below %.2f mm\n", type, p.deflection / WB_MM);
        end(&rig);
        end(&free_end);
    }
}

static void strand_is_taut_again_where_the_free_tip_is(void **unused)
{
    (void)unused;
    struct rig rig;
    begin(&rig, 2);
    weigh(&rig, 0.0);
    rig.model.length = 0.1;
    rig.cantilever = test_cantilever(&rig.model);
    double top[3], rest[3];
    for (int cycle = 0; cycle < 3; cycle++) {
        struct wb_cantilever_point p = {0};
        const double free_tip = cycle == 0 ? -1.0 : rest[cycle - 1];
        for (int i = 0; i <= 106; i++) {
            const double target = 0.5 * i * WB_MM;
            p = test_move(rig.cantilever, WB_CONTROL_DEFLECTION, target);
            assert_int_equal(p.slack, target < free_tip - 1e-6);
            if (p.slack)
                assert_close(p.deflection, free_tip, 1e-8);
        }
        top[cycle] = p.tension;
        for (int i = 105; i >= 0; i--)
            p = test_move(rig.cantilever, WB_CONTROL_DEFLECTION, 0.5 * i * WB_MM);
        assert_true(p.slack);
        rest[cycle] = p.deflection;
    }
    /* Isotropic hardening: reloading is elastic up to the end of the same curve. */
    assert_close_relative(top[1], top[0], 1e-3);
    assert_close_relative(top[2], top[1], 1e-4);
    assert_close(rest[2], rest[1], 0.02 * WB_MM);
    end(&rig);
}

static void slack_does_not_depend_on_the_steps(void **unused)
{
    (void)unused;
    double tip[3];
    const int counts[] = {1, 10, 400};
    for (int k = 0; k < 3; k++) {
        struct rig rig;
        begin(&rig, 1);
        weigh(&rig, 0.001);
        rig.cantilever = test_cantilever(&rig.model);
        test_move(rig.cantilever, WB_CONTROL_STAGE, 0.053);
        struct wb_cantilever_point p = {0};
        for (int i = counts[k] - 1; i >= 0; i--)
            p = test_move(rig.cantilever, WB_CONTROL_STAGE, -0.01 + 0.063 * i / counts[k]);
        assert_true(p.slack);
        tip[k] = p.deflection;
        end(&rig);
    }
    assert_close(tip[0], tip[2], 0.05 * WB_MM);
    assert_close(tip[1], tip[2], 0.05 * WB_MM);
}

static double upward_bow(void *context, double s)
{
    (void)s;
    return *(const double *)context;
}

static void bow_decides_whether_the_virgin_strand_is_slack(void **unused)
{
    (void)unused;
    for (int sign = -1; sign <= 1; sign += 2) {
        struct rig rig;
        double curvature = sign * 2.0 * 0.003 / (wire_length * wire_length);
        begin(&rig, 1);
        rig.model.natural_curvature = upward_bow;
        rig.model.curvature_context = &curvature;
        rig.cantilever = test_cantilever(&rig.model);
        struct wb_cantilever_point p = test_move(rig.cantilever, WB_CONTROL_DEFLECTION, 0.0);
        assert_int_equal(p.slack, sign > 0);
        if (sign > 0) {
            assert_close(p.deflection, 0.003, 2e-5);
            assert_true(p.tension == 0.0);
            p = test_move(rig.cantilever, WB_CONTROL_DEFLECTION, 0.002);
            assert_true(p.slack);
            p = test_move(rig.cantilever, WB_CONTROL_DEFLECTION, 0.004);
            assert_false(p.slack);
        } else {
            assert_true(p.tension > 0.0);
        }
        end(&rig);
    }
}

static void lowered_tip_lies_on_the_rest(void **unused)
{
    (void)unused;
    struct rig rig;
    begin(&rig, 1);
    weigh(&rig, 0.0027);
    rig.model.has_rest = true;
    rig.model.rest_level = -0.002;
    rig.cantilever = test_cantilever(&rig.model);

    struct wb_cantilever_point p = test_move(rig.cantilever, WB_CONTROL_STAGE, 0.0);
    assert_false(p.slack || p.resting);
    for (int mm = -1; mm >= -6; mm--) {
        p = test_move(rig.cantilever, WB_CONTROL_STAGE, mm * WB_MM);
        assert_true(p.deflection >= rig.model.rest_level - 1e-8);
        if (mm <= -3) {
            assert_true(p.slack && p.resting && p.tension == 0.0);
            assert_close(p.deflection, rig.model.rest_level, 1e-10);
        }
    }
    /* Up again: slack until the strand becomes taut, then the tension increases from zero while the
     * tip is still on the rest (within less than a nanometre of travel), then it lifts off. Very
     * fine steps through the event. */
    p = test_move(rig.cantilever, WB_CONTROL_STAGE, -0.0025);
    const double lift = reach(&p);
    assert_true(p.slack && p.resting && lift > -0.0025);
    double last = 0.0;
    for (int i = -200; i <= 200; i++) {
        p = test_move(rig.cantilever, WB_CONTROL_STAGE, lift + 1e-9 * i);
        assert_true(p.tension >= 0.0 && p.tension >= last - 1e-9);
        assert_true(p.slack || fabs(reach(&p) - p.control) < 2e-8);
        last = p.tension;
    }
    p = test_move(rig.cantilever, WB_CONTROL_STAGE, lift + 1e-4);
    assert_false(p.slack || p.resting);
    assert_true(p.tension > 0.02);
    end(&rig);
}

static void rest_limits_a_deflection_below_it(void **unused)
{
    (void)unused;
    struct rig rig;
    begin(&rig, 3);
    weigh(&rig, 0.0027);
    rig.model.has_rest = true;
    rig.model.rest_level = -0.001;
    rig.cantilever = test_cantilever(&rig.model);
    for (int cycle = 0; cycle < 3; cycle++) {
        for (int i = 0; i <= 40; i++) {
            const double target = (i <= 20 ? 2.0 * i - 5.0 : 75.0 - 2.0 * i) * WB_MM;
            const struct wb_cantilever_point p =
                test_move(rig.cantilever, WB_CONTROL_DEFLECTION, target);
            assert_true(p.deflection >= rig.model.rest_level - 1e-8);
            assert_true(p.slack || fabs(p.deflection - target) < 1e-9);
            assert_true(!p.resting || fabs(p.deflection - rig.model.rest_level) < 1e-9);
            assert_true(p.tension >= 0.0);
        }
    }
    end(&rig);
}

/* For any motion the inequalities hold: the strand only pulls and does not extend, and the tip is
 * not below the rest. */
static void random_tests_satisfy_the_inequalities(void **unused)
{
    (void)unused;
    uint64_t random = 123456789;
    for (int trial = 0; trial < 60; trial++) {
        struct rig rig;
        double curvature = (test_random(&random) - 0.5) * 4.0;
        begin(&rig, 1 + trial % 3);
        rig.wire.material.strength_coefficient = 1e6 * pow(10.0, 5.0 * test_random(&random));
        rig.wire.material.hardening_exponent = 0.05 + 1.45 * test_random(&random);
        wb_section_release(&rig.section);
        rig.section = test_section(&rig.wire);
        weigh(&rig, trial % 2 ? 0.0027 : 0.0005 * test_random(&random));
        rig.model.natural_curvature = upward_bow;
        rig.model.curvature_context = &curvature;
        rig.model.has_rest = trial % 4 < 2;
        rig.model.rest_level = -0.008 * test_random(&random);
        rig.cantilever = test_cantilever(&rig.model);
        const bool stage = trial % 5 < 2;
        double target = 0.0;
        for (int i = 0; i < 80; i++) {
            const struct wb_cantilever_point p =
                test_move(rig.cantilever, stage ? WB_CONTROL_STAGE : WB_CONTROL_DEFLECTION, target);
            assert_true(p.tension >= -1e-7);
            assert_true(!p.slack || p.tension == 0.0);
            assert_true((stage ? reach(&p) : p.deflection) >= target - 1e-7);
            assert_true(p.slack || fabs((stage ? reach(&p) : p.deflection) - target) < 1e-8);
            assert_true(!rig.model.has_rest || p.deflection >= rig.model.rest_level - 1e-7);
            target = i % 20 == 19 ? 0.06 * test_random(&random) - 0.01
                                  : target + 0.004 * (test_random(&random) - 0.5);
            target = fmin(fmax(target, -0.01), 0.053);
        }
        end(&rig);
    }
}

static void drop_message(void *context, enum wb_log_level level, const char *domain,
                         const char *message)
{
    (void)context;
    (void)level;
    (void)domain;
    (void)message;
}

/* A leader on the stage, with a rest, beyond the point where the strand becomes slack and the tip
 * lies on the rest: a slightly stiffer follower moves as it would alone, to second order in the
 * difference between the two. */
static void a_follower_moves_as_it_would_alone(void **unused)
{
    (void)unused;
    const double stiffer = 1e-3, offset = 1e-5;
    struct rig rigs[3]; /* leader, follower, and the follower alone */
    double squares = 0.0, missed = 0.0;
    int slack = 0, resting = 0;
    for (int i = 0; i < 3; i++) {
        begin(&rigs[i], 1);
        weigh(&rigs[i], 0.0027);
        rigs[i].model.has_rest = true;
        rigs[i].model.rest_level = 1.0 * WB_MM;
        struct wb_material *const m = &rigs[i].wire.material;
        if (i > 0) {
            m->youngs_modulus *= 1.0 + stiffer;
            m->strength_coefficient *= 1.0 + stiffer;
        }
        wb_section_release(&rigs[i].section);
        rigs[i].section = test_section(&rigs[i].wire);
        rigs[i].cantilever = test_cantilever(&rigs[i].model);
    }
    struct wb_cantilever *const followers[] = {rigs[1].cantilever};
    wb_cantilever_lead(rigs[0].cantilever, 1, followers, &offset);
    for (int i = 0; i <= 110; i++) {
        const double travel = (i <= 53 ? i : 106 - i) * WB_MM;
        const struct wb_cantilever_point p =
            test_move(rigs[0].cantilever, WB_CONTROL_STAGE, travel);
        const struct wb_cantilever_point q =
            test_move(rigs[2].cantilever, WB_CONTROL_STAGE, travel + offset);
        const double s = wire_length;
        double x, led[3], alone[3];
        wb_cantilever_shape(rigs[0].cantilever, 1, &s, &x, &led[0], &led[1]);
        wb_cantilever_shape(rigs[1].cantilever, 1, &s, &x, &led[0], &led[2]);
        wb_cantilever_shape(rigs[2].cantilever, 1, &s, &x, &alone[0], &alone[2]);
        slack += p.slack;
        resting += p.resting;
        if (p.slack != q.slack || p.resting != q.resting)
            continue; /* for a step, where they differ */
        squares += pow(alone[2] - led[1], 2.0) + pow((q.tension - p.tension) / 0.1, 2.0);
        missed += pow(led[2] - alone[2], 2.0) +
                  pow((wb_cantilever_tension(rigs[1].cantilever) - q.tension) / 0.1, 2.0);
    }
    print_message("follower: %.1e of the difference missed, %d points slack, %d at rest\n",
                  sqrt(missed / squares), slack, resting);
    assert_true(slack > 5 && resting > 0);
    assert_true(missed < 1e-4 * squares);
    for (int i = 0; i < 3; i++)
        end(&rigs[i]);
}

static void force_control_and_a_strand_exclude_each_other(void **unused)
{
    (void)unused;
    struct rig rig;
    struct wb_cantilever_point p;
    begin(&rig, 1);
    rig.cantilever = test_cantilever(&rig.model);
    wb_log_set_sink(drop_message, NULL);
    assert_int_equal(wb_cantilever_move(rig.cantilever, WB_CONTROL_DEAD_FORCE, 0.01, &p),
                     WB_ERR_ARGUMENT);
    wb_log_set_sink(NULL, NULL);
    end(&rig);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tension_acts_towards_the_strands_upper_end),
        cmocka_unit_test(stage_and_deflection_control_agree),
        cmocka_unit_test(short_strand_needs_no_more_iterations),
        cmocka_unit_test(strand_carries_counterweight_and_weight),
        cmocka_unit_test(unloading_ends_slack_where_the_tip_is_free),
        cmocka_unit_test(strand_is_taut_again_where_the_free_tip_is),
        cmocka_unit_test(slack_does_not_depend_on_the_steps),
        cmocka_unit_test(bow_decides_whether_the_virgin_strand_is_slack),
        cmocka_unit_test(lowered_tip_lies_on_the_rest),
        cmocka_unit_test(rest_limits_a_deflection_below_it),
        cmocka_unit_test(random_tests_satisfy_the_inequalities),
        cmocka_unit_test(a_follower_moves_as_it_would_alone),
        cmocka_unit_test(force_control_and_a_strand_exclude_each_other),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
