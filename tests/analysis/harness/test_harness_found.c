#include "analysis/harness/harness_found.h"

#include "base/vec3.h"
#include "tests/analysis/harness/harness_set.h"

static void extremes_are_those_of_all_steps(void **unused)
{
    (void)unused;
    struct wb_harness_result_set set;
    struct wb_harness_found found;
    struct wb_harness_extreme force, moment;
    struct wb_harness_plan *const plan = compute_set(&set, 0, NULL, &yielding);
    wb_harness_found_collect(&found, &set);
    assert_true(set.results[found.force.step].forces[found.force.of].largest == found.force.value);
    assert_true(set.results[found.radius.step].branches[found.radius.of].least_radius ==
                found.radius.value);
    assert_true(set.results[found.radius.step].branches[found.radius.of].at == found.radius.at);
    for (int i = 0; i < set.n_steps; i++) {
        for (int k = 0; k < plan->n_items; k++) {
            wb_harness_found_largest(&set, k, &force, &moment);
            assert_true(set.results[i].forces[k].largest <= force.value);
            assert_true(set.results[i].forces[k].largest_moment <= moment.value);
            assert_true(force.value <= found.force.value);
        }
        for (int b = 0; b < plan->n_branches; b++) {
            assert_true(set.results[i].branches[b].least_radius >=
                        wb_harness_found_radius(&set, b).value);
            assert_true(set.results[i].branches[b].least_radius >= found.radius.value);
        }
    }
    /* Never mounted. */
    wb_harness_found_largest(&set, 1, &force, &moment);
    assert_true(force.value == 0.0 && moment.value == 0.0);
    release_set(&set, plan);
}

static void residual_is_the_largest_distance_after_the_harness_was_taken_off(void **unused)
{
    (void)unused;
    struct wb_harness_result_set set;
    struct wb_harness_found found;
    struct wb_harness_plan *const plan = compute_set(&set, 0, NULL, &yielding);
    const int far = wb_harness_found_farthest(&set, 4);
    wb_harness_found_collect(&found, &set);
    assert_true(found.is_taken_off);
    for (int i = 0; i < set.n_places; i++)
        assert_true(wb_vec3_distance(set.natural[i].position, set.results[4].places[i].position) <=
                    found.residual.value);
    assert_true(wb_vec3_distance(set.natural[far].position, set.results[4].places[far].position) ==
                found.residual.value);
    assert_int_equal(found.residual.of, set.natural[far].branch);
    assert_true(found.residual.at == set.natural[far].s);
    /* A harness whose last step was not completed is not taken off. */
    set.converged = false;
    wb_harness_found_collect(&found, &set);
    assert_false(found.is_taken_off);
    assert_true(found.residual.value == 0.0);
    set.converged = true;
    set.n_steps = 4;
    wb_harness_found_collect(&found, &set);
    assert_false(found.is_taken_off);
    release_set(&set, plan);
}

static void doubts_are_counted(void **unused)
{
    (void)unused;
    struct wb_harness_result_set set;
    struct wb_harness_found found;
    struct wb_harness_plan *const plan = compute_set(&set, 0, NULL, &yielding);
    wb_harness_found_collect(&found, &set);
    assert_int_equal(found.n_beyond, 0);
    assert_int_equal(found.n_snaps, 0);
    set.results[set.n_steps - 1].branches[1].is_beyond = true;
    set.results[0].n_snaps = 1;
    set.results[3].n_snaps = 2;
    for (int i = 0; i < set.n_steps; i++) {
        for (int k = 0; k < plan->n_items; k++)
            set.results[i].forces[k].soft_force = set.results[i].forces[k].size;
    }
    wb_harness_found_collect(&found, &set);
    assert_int_equal(found.n_beyond, 1);
    assert_true(wb_harness_found_is_beyond(&set, 1));
    assert_false(wb_harness_found_is_beyond(&set, 0));
    assert_int_equal(found.n_snaps, 3);
    assert_int_equal(found.n_twist, 0);
    set.results[1].forces[3].soft_force *= 1.2;
    set.results[2].forces[3].soft_force *= 1.2;
    wb_harness_found_collect(&found, &set);
    assert_int_equal(found.n_twist, 1);
    release_set(&set, plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(extremes_are_those_of_all_steps),
        cmocka_unit_test(residual_is_the_largest_distance_after_the_harness_was_taken_off),
        cmocka_unit_test(doubts_are_counted),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
