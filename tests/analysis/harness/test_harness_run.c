#include "analysis/harness/harness_found.h"

#include "base/units.h"
#include "base/vec3.h"
#include "tests/analysis/harness/harness_set.h"
#include "tests/messages.h"

static char file[64];

static int begin(void **state)
{
    if (make_folder(state) != 0)
        return -1;
    snprintf(file, sizeof file, "%s/h.yaml", folder);
    return 0;
}

static const struct wb_harness_settings elastic = {.is_elastic = true, .torsion = 1.0};

static double weight_of(const struct wb_harness_plan *plan)
{
    double mass = 0.0;
    for (int i = 0; i < plan->n_branches; i++)
        mass += plan->branches[i].length * plan->wires[plan->branches[i].wire].mass;
    for (int i = 0; i < plan->n_items; i++)
        mass += plan->items[i].mass;
    return mass * WB_STANDARD_GRAVITY;
}

static void root_carries_the_weight_of_what_hangs(void **unused)
{
    (void)unused;
    struct wb_harness_result_set set;
    struct wb_harness_plan *const plan = compute_set(&set, 0, NULL, &yielding);
    assert_true(set.converged);
    assert_int_equal(set.n_steps, 5);
    const struct wb_harness_force *const root = &set.results[0].forces[0];
    assert_close_relative(root->size, weight_of(plan), 1e-9);
    assert_close_relative(set.weight, weight_of(plan), 1e-12);
    /* Its frame is that of space: z up, and a moment about -y against the weight's. */
    assert_close_relative(root->force[2], weight_of(plan), 1e-9);
    assert_true(root->moment[1] < 0.0);
    assert_false(set.results[0].forces[3].is_mounted);
    assert_true(set.results[1].forces[3].is_mounted);
    assert_false(set.results[3].forces[3].is_mounted);
    /* Taken off, nothing holds it. */
    assert_true(set.results[4].forces[0].size < 1e-9);
    release_set(&set, plan);
}

/* The axes of the first section, in which the root's force is, as columns. */
static void find_root_axes(const struct wb_harness_step_result *step, double R[9])
{
    const struct wb_harness_place *const first = step->places;
    double across[3];
    wb_vec3_cross(first->up, first->direction, across);
    for (int k = 0; k < 3; k++) {
        R[3 * k] = first->direction[k];
        R[3 * k + 1] = across[k];
        R[3 * k + 2] = first->up[k];
    }
}

/* The trunk hangs over a bar, and one lead lies on the floor. */
static void holders_and_obstacles_carry_the_weight(void **unused)
{
    (void)unused;
    static const char obstacles[] =
        "obstacles:\n"
        "  - {name: bar, shape: cylinder, at_mm: [150, 0, -20], direction: [0, 1, 0],\n"
        "     radius_mm: 10, length_mm: 200, edge_radius_mm: 2, friction: 0.3}\n"
        "  - {name: floor, shape: plane, at_mm: [0, 0, -130], direction: [0, 0, 1],\n"
        "     friction: 0.4}\n"
        "clips:";
    struct wb_harness_result_set set;
    struct wb_harness_plan *const plan = compute_set(&set, 14, obstacles, &yielding);
    const int n = plan->n_items;
    assert_true(set.converged);
    for (int i = 0; i < 4; i += 3) { /* the steps after which no clip is mounted */
        const struct wb_harness_force *const forces = set.results[i].forces;
        double sum[3] = {0.0, 0.0, -weight_of(plan)}, R[9], force[3];
        find_root_axes(&set.results[i], R);
        wb_vec3_turn(R, forces[0].force, force);
        for (int k = 0; k <= plan->n_obstacles; k++) {
            for (int c = 0; c < 3; c++)
                sum[c] += force[c];
            if (k == plan->n_obstacles)
                break;
            wb_rod_element_matrix(plan->obstacles[k].body.rotation, R);
            wb_vec3_turn(R, forces[n + k].force, force);
        }
        for (int c = 0; c < 3; c++)
            assert_close(sum[c], 0.0, 1e-9 * weight_of(plan));
    }
    assert_true(set.results[0].forces[n].size > 0.1 * weight_of(plan));
    assert_true(set.results[0].forces[n].largest >= set.results[0].forces[n].size);
    assert_true(set.results[0].forces[n + 1].size > 1e-3 * weight_of(plan));
    assert_false(set.results[4].forces[n + 1].size > 1e-9);
    release_set(&set, plan);
}

static void wire_that_begins_in_an_obstacle_is_refused(void **unused)
{
    (void)unused;
    struct wb_harness_plan *const plan = make_plan();
    struct wb_harness_result_set set;
    write_harness(file, 14,
                  "obstacles:\n"
                  "  - {name: wall, shape: plane, at_mm: [500, 0, 0], direction: [-1, 0, 0]}\n"
                  "clips:");
    assert_int_equal(wb_harness_file_read(plan, file), WB_OK);
    keep_messages();
    assert_int_equal(wb_harness_run_compute(&set, plan, &yielding, NULL, NULL), WB_ERR_ARGUMENT);
    release_messages();
    assert_non_null(strstr(kept.error, "obstacles"));
    assert_non_null(strstr(kept.error, "wall"));
    assert_non_null(strstr(kept.error, "B3"));
    release_set(&set, plan);
}

static void elastic_harness_forgets(void **unused)
{
    (void)unused;
    struct wb_harness_result_set set;
    struct wb_harness_plan *const plan = compute_set(&set, 0, NULL, &elastic);
    struct wb_harness_found found;
    assert_true(set.converged);
    for (int i = 0; i < 5; i++)
        assert_close(set.results[i].plastic, 0.0, 1e-12 * set.results[1].elastic);
    wb_harness_found_collect(&found, &set);
    assert_true(found.is_taken_off && found.residual.value < 1e-8);
    release_set(&set, plan);
}

static void yielding_harness_keeps_a_shape(void **unused)
{
    (void)unused;
    struct wb_harness_result_set set;
    struct wb_harness_plan *const plan = compute_set(&set, 0, NULL, &yielding);
    struct wb_harness_found found;
    for (int i = 1; i < 4; i++)
        assert_true(set.results[i].plastic > set.results[i - 1].plastic);
    wb_harness_found_collect(&found, &set);
    assert_true(found.is_taken_off && found.residual.value > 1e-3);
    assert_true(set.results[4].elastic < 1e-12);
    release_set(&set, plan);
}

/* The clip goes around a triangle three times. */
static void closed_sequence_yields_no_work(void **unused)
{
    (void)unused;
    static const char laps[] = "  - {move: C1, at_mm: [150, 60, 30]}\n"
                               "  - {move: C1, at_mm: [150, -20, 70]}\n"
                               "  - {move: C1, at_mm: [190, 0, 30]}\n"
                               "  - {move: C1, at_mm: [150, 60, 30]}\n"
                               "  - {move: C1, at_mm: [150, -20, 70]}\n"
                               "  - {move: C1, at_mm: [190, 0, 30]}\n"
                               "  - {move: C1, at_mm: [150, 60, 30]}\n"
                               "  - {move: C1, at_mm: [150, -20, 70]}\n"
                               "  - {move: C1, at_mm: [190, 0, 30]}";
    struct wb_harness_result_set set;
    struct wb_harness_plan *const plan = compute_set(&set, 19, laps, &yielding);
    assert_true(set.converged);
    for (int lap = 0; lap < 3; lap++) {
        const struct wb_harness_step_result *const from = &set.results[1 + 3 * lap];
        const struct wb_harness_step_result *const to = &set.results[4 + 3 * lap];
        assert_true(to->plastic > from->plastic);
        assert_true(to->plastic + to->elastic > from->plastic + from->elastic);
    }
    release_set(&set, plan);
}

/* The heavy branch hangs beside the clip, whose axis is turned: the trunk is twisted. */
static void forces_that_depend_on_a_default_are_known(void **unused)
{
    (void)unused;
    struct wb_harness_result_set set;
    struct wb_harness_plan *plan =
        compute_set(&set, 18,
                    "  - {mount: K1, at_mm: [350, 200, -100], direction: [0, 1, 0.5]}\n"
                    "  - {mount: C1, at_mm: [190, 0, 30], direction: [1, 0.2, 0.2]}",
                    &yielding);
    bool any = false;
    for (int i = 0; i < plan->n_items; i++)
        any |= wb_harness_found_is_twist_sensitive(&set.results[1].forces[i]);
    assert_true(any);
    assert_true(isfinite(set.results[1].forces[1].soft_force));
    assert_false(wb_harness_found_is_twist_sensitive(&set.results[0].forces[0]));
    release_set(&set, plan);

    plan = make_plan();
    write_harness(file, 0, NULL);
    assert_int_equal(wb_harness_file_read(plan, file), WB_OK);
    for (int i = 0; i < plan->n_wires; i++)
        plan->wires[i].torsional_stiffness = 1e-4;
    assert_int_equal(wb_harness_run_compute(&set, plan, &yielding, NULL, NULL), WB_OK);
    assert_true(isnan(set.results[1].forces[3].soft_force));
    assert_false(wb_harness_found_is_twist_sensitive(&set.results[1].forces[3]));
    assert_true(wb_harness_run_torsion(plan, 0, &yielding) == 1e-4);
    release_set(&set, plan);
}

static void limits_are_watched(void **unused)
{
    (void)unused;
    struct wb_harness_result_set set;
    struct wb_harness_found found;
    struct wb_harness_plan *plan = compute_set(
        &set, 15, "  - {name: C1, branch: B1, at_mm: 200, holds: axis, most_force_N: 0.1}",
        &yielding);
    assert_true(set.results[1].forces[3].exceeds_force);
    assert_false(set.results[1].forces[3].exceeds_moment);
    wb_harness_found_collect(&found, &set);
    assert_int_equal(found.n_limits, 1);
    assert_int_equal(found.n_exceeded, 1);
    release_set(&set, plan);
    plan =
        compute_set(&set, 8,
                    "  - {name: B1, from: R, to: J, wire: trunk, length_mm: 300, least_radius_mm: "
                    "1000}",
                    &yielding);
    assert_true(set.results[1].branches[0].exceeds_radius);
    assert_false(set.results[1].branches[1].exceeds_radius);
    for (int i = 0; i < set.n_steps; i++) {
        const struct wb_harness_branch_result *const b = &set.results[i].branches[0];
        assert_true(b->tightest_radius <= b->least_radius);
        assert_int_equal(b->exceeds_radius, b->tightest_radius < plan->branches[0].least_radius);
    }
    assert_int_equal(wb_harness_found_exceeds_radius(&set, 0), 0);
    assert_int_equal(wb_harness_found_exceeds_radius(&set, 1), -1);
    wb_harness_found_collect(&found, &set);
    assert_int_equal(found.n_exceeded, 1);
    release_set(&set, plan);
    plan = compute_set(&set, 0, NULL, &yielding);
    wb_harness_found_collect(&found, &set);
    assert_int_equal(found.n_limits + found.n_exceeded, 0);
    release_set(&set, plan);
}

/* A constant natural curvature is the shape of the harness that was taken off before it yielded. */
static void natural_shape_is_free_of_force(void **unused)
{
    (void)unused;
    struct wb_harness_result_set set;
    struct wb_harness_plan *const plan =
        compute_set(&set, 8,
                    "  - {name: B1, from: R, to: J, wire: trunk, length_mm: 300, natural_shape: "
                    "{curvature_1_m: [0, 5]}}",
                    &elastic);
    /* An arc in the plane of x and y: curvature 5 /m about z. */
    const struct wb_harness_place *place = set.natural;
    while (place[1].branch == 0)
        place++;
    assert_close_relative(place->s, 0.3, 1e-12);
    assert_close(place->position[0], sin(1.5) / 5.0, 1e-8);
    assert_close(place->position[1], (1.0 - cos(1.5)) / 5.0, 1e-8);
    assert_close_relative(place->curvature, 5.0, 1e-12);
    assert_true(place->moment == 0.0);
    release_set(&set, plan);
}

static bool stop_in_second(void *context, int step, double fraction)
{
    (void)context, (void)fraction;
    return step < 1;
}

static void stops_when_asked(void **unused)
{
    (void)unused;
    struct wb_harness_plan *const plan = make_plan();
    struct wb_harness_result_set set;
    write_harness(file, 0, NULL);
    assert_int_equal(wb_harness_file_read(plan, file), WB_OK);
    assert_int_equal(wb_harness_run_compute(&set, plan, &yielding, stop_in_second, NULL), WB_OK);
    assert_false(set.converged);
    assert_int_equal(set.n_steps, 2);
    assert_int_equal(set.results[1].end, WB_HARNESS_STOPPED);
    assert_true(set.results[1].fraction > 0.0 && set.results[1].fraction < 1.0);
    release_set(&set, plan);
}

static void check_result(const struct wb_harness_result_set *set, int step,
                         const struct wb_harness_step_result *r)
{
    const struct wb_harness_step_result *const expected = &set->results[step];
    const size_t n_places = (size_t)set->n_places, n_items = (size_t)set->plan->n_items;
    const size_t n_branches = (size_t)set->plan->n_branches;
    assert_memory_equal(r->places, expected->places, n_places * sizeof *r->places);
    assert_memory_equal(r->branches, expected->branches, n_branches * sizeof *r->branches);
    for (size_t i = 0; i < n_items; i++) {
        struct wb_harness_force without_soft = expected->forces[i];
        without_soft.soft_force = r->forces[i].soft_force;
        assert_memory_equal(&r->forces[i], &without_soft, sizeof without_soft);
    }
    assert_true(r->plastic == expected->plastic && r->elastic == expected->elastic);
    assert_int_equal(r->iterations, expected->iterations);
}

/* Each step is undone once by restoring the state before it. */
static void steps_that_are_undone_and_repeated_are_the_same_bit_for_bit(void **unused)
{
    (void)unused;
    struct wb_harness_result_set set;
    struct wb_harness_plan *const plan = compute_set(&set, 0, NULL, &yielding);
    struct wb_harness_run *run;
    struct wb_harness_step_result result;
    struct wb_memory memory = {0};
    assert_int_equal(wb_harness_run_create(&run, plan, &yielding), WB_OK);
    void *const state = calloc(1, wb_harness_run_state_size(run));
    assert_non_null(state);
    assert_int_equal(wb_harness_run_n_places(run), set.n_places);
    wb_harness_run_take_memory(run, &memory, &result);
    wb_harness_run_begin(run, &result);
    assert_memory_equal(result.places, set.natural, (size_t)set.n_places * sizeof *set.natural);
    for (int i = 0; i < plan->n_steps; i++) {
        wb_harness_run_save(run, state);
        for (int k = 0; k < 2; k++) {
            wb_harness_run_step(run, &plan->steps[i], NULL, NULL, &result);
            check_result(&set, i, &result);
            if (k == 0)
                wb_harness_run_restore(run, state);
        }
    }
    free(state);
    wb_harness_run_destroy(run);
    wb_memory_release(&memory);
    release_set(&set, plan);
}

static bool stop_at_once(void *context, double fraction)
{
    (void)context, (void)fraction;
    return false;
}

/* The clip holds it as before, and the release can be repeated. */
static void release_that_does_not_end_leaves_the_state_before(void **unused)
{
    (void)unused;
    enum {
        RELEASE = 3
    };
    struct wb_harness_result_set set;
    struct wb_harness_plan *const plan = compute_set(&set, 0, NULL, &yielding);
    struct wb_harness_run *run;
    struct wb_harness_step_result result;
    struct wb_memory memory = {0};
    assert_int_equal(wb_harness_run_create(&run, plan, &yielding), WB_OK);
    wb_harness_run_take_memory(run, &memory, &result);
    for (int i = 0; i < RELEASE; i++)
        wb_harness_run_step(run, &plan->steps[i], NULL, NULL, &result);
    wb_harness_run_step(run, &plan->steps[RELEASE], stop_at_once, NULL, &result);
    assert_int_equal(result.end, WB_HARNESS_STOPPED);
    assert_true(result.forces[3].is_mounted);
    assert_true(result.forces[3].size == set.results[RELEASE - 1].forces[3].size);
    assert_memory_equal(result.places, set.results[RELEASE - 1].places,
                        (size_t)set.n_places * sizeof *result.places);
    const struct wb_rod_node clip = wb_harness_run_item(run, 3);
    assert_true(wb_vec3_distance(clip.position, plan->steps[RELEASE - 1].position) < 1e-10);
    wb_harness_run_step(run, &plan->steps[RELEASE], NULL, NULL, &result);
    check_result(&set, RELEASE, &result);
    wb_harness_run_destroy(run);
    wb_memory_release(&memory);
    release_set(&set, plan);
}

/* The results are those without frames; frames lie between the steps, in order. */
static void frames_are_shapes_along_each_step(void **unused)
{
    (void)unused;
    struct wb_harness_settings with = yielding;
    struct wb_harness_result_set set, plain;
    with.frames = 4;
    struct wb_harness_plan *const plan = compute_set(&set, 0, NULL, &with);
    struct wb_harness_plan *const other = compute_set(&plain, 0, NULL, &yielding);
    assert_int_equal(plain.n_shapes, 6);
    assert_true(set.n_shapes > 6 + 5 && set.n_shapes <= 1 + 5 * 4);
    for (int i = 0, step = -1; i < set.n_shapes; i++) {
        const struct wb_harness_shape *const shape = &set.shapes[i];
        const bool is_end = shape->time == shape->step + 1;
        assert_true(i == 0 ? shape->time == 0.0 : shape->time > shape[-1].time);
        assert_true(shape->time > shape->step && shape->time <= shape->step + 1);
        assert_close(shape->places[1].position[0], set.natural[1].position[0], 1e-3);
        if (!is_end)
            continue;
        assert_int_equal(shape->step, step);
        assert_memory_equal(shape->places, plain.shapes[++step].places,
                            (size_t)set.n_places * sizeof *shape->places);
    }
    /* A frame of a move lies between the two ends of the clip's way. */
    const struct wb_harness_shape *shape = set.shapes;
    while (shape->time <= 2.0)
        shape++;
    for (int i = 0; i < set.n_places; i++) {
        if (shape->places[i].branch == 0 && fabs(shape->places[i].s - 0.2) < 2e-3)
            assert_close(shape->places[i].position[1], 0.02 * (shape->time - 2.0), 2e-3);
    }
    release_set(&set, plan);
    release_set(&plain, other);
}

/* Across the wire, and where the branch begins upwards. */
static void section_frame_is_kept_with_the_shape(void **unused)
{
    (void)unused;
    struct wb_harness_result_set set;
    struct wb_harness_plan *const plan = compute_set(&set, 0, NULL, &elastic);
    assert_close(set.natural[0].up[2], 1.0, 1e-12);
    for (int k = 0; k < set.n_shapes; k++) {
        for (int i = 0; i < set.n_places; i++) {
            const struct wb_harness_place *const place = &set.shapes[k].places[i];
            assert_close(wb_vec3_dot(place->up, place->direction), 0.0, 1e-12);
            assert_close(wb_vec3_length(place->up), 1.0, 1e-12);
        }
    }
    release_set(&set, plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(root_carries_the_weight_of_what_hangs),
        cmocka_unit_test(holders_and_obstacles_carry_the_weight),
        cmocka_unit_test(wire_that_begins_in_an_obstacle_is_refused),
        cmocka_unit_test(elastic_harness_forgets),
        cmocka_unit_test(yielding_harness_keeps_a_shape),
        cmocka_unit_test(closed_sequence_yields_no_work),
        cmocka_unit_test(forces_that_depend_on_a_default_are_known),
        cmocka_unit_test(limits_are_watched),
        cmocka_unit_test(natural_shape_is_free_of_force),
        cmocka_unit_test(stops_when_asked),
        cmocka_unit_test(steps_that_are_undone_and_repeated_are_the_same_bit_for_bit),
        cmocka_unit_test(release_that_does_not_end_leaves_the_state_before),
        cmocka_unit_test(frames_are_shapes_along_each_step),
        cmocka_unit_test(section_frame_is_kept_with_the_shape),
    };
    return cmocka_run_group_tests(tests, begin, remove_folder);
}
