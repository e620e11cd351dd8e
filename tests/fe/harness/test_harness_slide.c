/* Clips through which the wire slides. */
#include "base/vec3.h"
#include "tests/fe/harness/harnesses.h"

/* A rod of length 1 m along x, EI 1e-3 N m2, with a sliding clip at 2/3 of it. */
static struct test_harness rod_in_a_clip(double friction, int *clip)
{
    const double station = 2.0 / 3.0;
    const struct wb_harness_branch branch = {.parent = -1,
                                             .leaving = {1.0, 0.0, 0.0, 0.0},
                                             .section = test_elastic_section(1e-3, 0.0),
                                             .length = 1.0,
                                             .n_stations = 1,
                                             .stations = &station};
    const struct wb_harness_model model = {.n_branches = 1,
                                           .branches = &branch,
                                           .element_length = 1.0 / 30.0,
                                           .most_sliding = 1,
                                           .root = test_origin};
    struct test_harness t = test_harness_make(&model);
    t.section = (struct wb_law_section *)branch.section;
    *clip = wb_harness_joint(t.harness, 0, station);
    wb_harness_let_slide(t.harness, *clip, friction);
    return t;
}

static void load_tip(struct test_harness *t, double force)
{
    const struct wb_harness_load load = {wb_harness_joint(t->harness, 0, 1.0), {0.0, force}};
    const struct wb_harness_move move = {.n_loads = 1, .loads = &load};
    (void)test_harness_move(t, &move);
}

static struct wb_harness_result move_root(struct test_harness *t, double x)
{
    struct wb_rod_node target = test_origin;
    target.position[0] = x;
    return test_harness_aim(t, 0, &target);
}

/* A beam with an overhang of half its span: 1 + 3/2 a / L times the force at its end. */
static void clip_holds_an_overhang(void **unused)
{
    (void)unused;
    int clip;
    struct test_harness t = rod_in_a_clip(0.0, &clip);
    double reaction[6];
    load_tip(&t, -1e-7);
    wb_harness_reaction(t.harness, clip, reaction);
    assert_close_relative(reaction[1], 1.75e-7, 1e-4);
    test_harness_release(&t);
}

/* The force of the clip is across the wire, the wire is in the clip, forces and moments balance. */
static void check_clip(struct test_harness *t, int clip, double friction)
{
    double reaction[6], root[6], load[6], R[9], moment[3], arm[3];
    const int tip = wb_harness_joint(t->harness, 0, 1.0);
    const struct wb_rod_node held = wb_harness_held_node(t->harness, clip);
    const double *const end = wb_harness_node(t->harness, tip)->position;
    const double *const begin = wb_harness_node(t->harness, 0)->position;
    wb_harness_reaction(t->harness, clip, reaction);
    wb_harness_reaction(t->harness, 0, root);
    wb_harness_load(t->harness, tip, load);
    wb_rod_element_matrix(held.rotation, R);
    const double axis[3] = {R[0], R[3], R[6]}, size = wb_vec3_length(reaction);
    const double along = wb_vec3_dot(axis, reaction);
    assert_close(held.position[0], 2.0 / 3.0, 1e-10);
    assert_close(held.position[1], 0.0, 1e-10);
    assert_close(fabs(along), friction / sqrt(1.0 + friction * friction) * size, 1e-9 * size);
    for (int k = 0; k < 3; k++)
        assert_close(reaction[k] + root[k] + load[k], 0.0, 1e-9 * size);
    double sum = root[5];
    wb_vec3_cross(begin, root, moment);
    sum += moment[2];
    wb_vec3_cross(held.position, reaction, moment);
    sum += moment[2];
    for (int k = 0; k < 3; k++)
        arm[k] = end[k];
    wb_vec3_cross(arm, load, moment);
    assert_close(sum + moment[2], 0.0, 1e-9 * size);
}

static void wire_slides_without_friction_and_back(void **unused)
{
    (void)unused;
    int clip;
    struct test_harness t = rod_in_a_clip(0.0, &clip);
    load_tip(&t, -2e-2);
    check_clip(&t, clip, 0.0);
    const double slid = wb_harness_slid(t.harness, clip);
    const double y = wb_harness_node(t.harness, wb_harness_joint(t.harness, 0, 1.0))->position[1];
    const struct wb_harness_result result = move_root(&t, -0.3);
    assert_int_equal(result.n_snaps, 0);
    check_clip(&t, clip, 0.0);
    /* Pulled through, with the slack of the curve left. */
    assert_close(wb_harness_slid(t.harness, clip) - slid, 0.3, 0.02);
    (void)move_root(&t, 0.0);
    check_clip(&t, clip, 0.0);
    assert_close(wb_harness_slid(t.harness, clip), slid, 1e-9);
    assert_close(wb_harness_node(t.harness, wb_harness_joint(t.harness, 0, 1.0))->position[1], y,
                 1e-9);
    test_harness_release(&t);
}

/* The work at the root and at the tip's load is the elastic energy, however far the wire slid. */
static void sliding_without_friction_takes_no_work(void **unused)
{
    (void)unused;
    int clip;
    struct test_harness t = rod_in_a_clip(0.0, &clip);
    double before[6], after[6], work = 0.0;
    load_tip(&t, -1e-2);
    const int tip = wb_harness_joint(t.harness, 0, 1.0);
    const double energy = wb_harness_elastic_energy(t.harness);
    const double y = wb_harness_node(t.harness, tip)->position[1];
    for (int i = 1; i <= 50; i++) {
        wb_harness_reaction(t.harness, 0, before);
        (void)move_root(&t, -0.2 * i / 50);
        wb_harness_reaction(t.harness, 0, after);
        work += 0.5 * (before[0] + after[0]) * -0.2 / 50;
    }
    work += -1e-2 * (wb_harness_node(t.harness, tip)->position[1] - y);
    assert_true(fabs(wb_harness_elastic_energy(t.harness) - energy) > 0.2 * energy);
    assert_close(work, wb_harness_elastic_energy(t.harness) - energy, 2e-3 * energy);
    test_harness_release(&t);
}

/* Pulled at the root, the wire sticks, then slides with the friction against its motion. */
static void wire_sticks_then_slides_against_friction(void **unused)
{
    (void)unused;
    int clip;
    struct test_harness t = rod_in_a_clip(0.3, &clip);
    double reaction[6];
    load_tip(&t, -1e-4);
    const double begin = wb_harness_slid(t.harness, clip);
    (void)move_root(&t, -1e-11);
    assert_true(wb_harness_slid(t.harness, clip) == begin);
    (void)move_root(&t, -0.05);
    assert_close(wb_harness_slid(t.harness, clip), 0.05, 1e-3);
    check_clip(&t, clip, 0.3);
    wb_harness_reaction(t.harness, clip, reaction);
    assert_true(reaction[0] > 0.0);
    const double slid = wb_harness_slid(t.harness, clip);
    (void)move_root(&t, -0.04);
    assert_close(slid - wb_harness_slid(t.harness, clip), 0.01, 1e-3);
    check_clip(&t, clip, 0.3);
    wb_harness_reaction(t.harness, clip, reaction);
    assert_true(reaction[0] < 0.0);
    test_harness_release(&t);
}

static void steps_after_a_restored_state_are_the_same_bit_for_bit(void **unused)
{
    (void)unused;
    int clip;
    struct test_harness t = rod_in_a_clip(0.3, &clip);
    double first[6], again[6];
    load_tip(&t, -1e-2);
    (void)move_root(&t, -0.05);
    void *const state = malloc(wb_harness_solver_state_size(t.solver));
    assert_non_null(state);
    wb_harness_solver_save(t.solver, state);
    (void)move_root(&t, -0.1);
    wb_harness_reaction(t.harness, clip, first);
    const double slid = wb_harness_slid(t.harness, clip);
    wb_harness_set_hold(t.harness, clip, WB_HARNESS_FREE, NULL);
    assert_true(wb_harness_slid(t.harness, clip) == 0.0);
    wb_harness_solver_restore(t.solver, state);
    (void)move_root(&t, -0.1);
    wb_harness_reaction(t.harness, clip, again);
    assert_memory_equal(first, again, sizeof first);
    assert_true(wb_harness_slid(t.harness, clip) == slid);
    free(state);
    test_harness_release(&t);
}

static void wire_stops_at_its_end(void **unused)
{
    (void)unused;
    int clip;
    struct test_harness t = rod_in_a_clip(0.0, &clip);
    double reaction[6];
    (void)move_root(&t, -1.0 / 3.0);
    (void)move_root(&t, -1.0 / 3.0 - 1e-9);
    assert_close(wb_harness_slid(t.harness, clip), 1.0 / 3.0, 1e-12);
    wb_harness_reaction(t.harness, clip, reaction);
    assert_true(reaction[0] > 1e-6);
    (void)move_root(&t, -0.3);
    assert_close(wb_harness_slid(t.harness, clip), 0.3, 1e-9);
    test_harness_release(&t);
}

/* A clip that lets go is a release; the wire falls back to its straight shape. */
static void wire_leaves_a_clip_that_lets_go(void **unused)
{
    (void)unused;
    int clip;
    struct test_harness t = rod_in_a_clip(0.0, &clip);
    struct wb_harness_result result;
    struct wb_rod_node target = test_origin;
    target.position[0] = 2.0 / 3.0;
    target.position[1] = 0.1;
    (void)test_harness_aim(&t, clip, &target);
    assert_close(wb_harness_held_node(t.harness, clip).position[1], 0.1, 1e-10);
    wb_harness_set_hold(t.harness, clip, WB_HARNESS_FREE, NULL);
    wb_harness_solver_settle(t.solver, 0.0, NULL, NULL, &result);
    assert_int_equal(result.end, WB_HARNESS_CONVERGED);
    assert_close(wb_harness_node(t.harness, clip)->position[1], 0.0, 1e-9);
    test_harness_release(&t);
}

/* A column whose end a sliding clip guides: clamped and pinned, critical at 20.19 EI / L^2. */
static int negative_of_a_pushed_rod(double force)
{
    int clip;
    struct test_harness t = rod_in_a_clip(0.0, &clip);
    /* The part beyond the clip turns with it; the load stands at the clip. */
    const double load[6] = {-force};
    wb_harness_set_load(t.harness, clip, load);
    int negative = 1;
    struct wb_harness_balance balance;
    wb_harness_evaluate(t.harness, 0.0, &balance);
    for (int i = 0; i < 30; i++) {
        wb_harness_solve(t.harness);
        negative = wb_harness_negative(t.harness);
        if (balance.largest_residual <= 1e-9 * balance.largest_force + 1e-13)
            break;
        (void)wb_harness_advance(t.harness, 0.5, &balance);
    }
    test_harness_release(&t);
    return negative;
}

static void stability_knows_of_the_clip(void **unused)
{
    (void)unused;
    const double critical = 20.1907 * 1e-3 / (4.0 / 9.0);
    assert_int_equal(negative_of_a_pushed_rod(0.999 * critical), 0);
    assert_int_equal(negative_of_a_pushed_rod(1.001 * critical), 2); /* in both planes */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(clip_holds_an_overhang),
        cmocka_unit_test(wire_slides_without_friction_and_back),
        cmocka_unit_test(sliding_without_friction_takes_no_work),
        cmocka_unit_test(wire_sticks_then_slides_against_friction),
        cmocka_unit_test(steps_after_a_restored_state_are_the_same_bit_for_bit),
        cmocka_unit_test(wire_stops_at_its_end),
        cmocka_unit_test(wire_leaves_a_clip_that_lets_go),
        cmocka_unit_test(stability_knows_of_the_clip),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
