/* Obstacles. */
#include "base/vec3.h"
#include "tests/fe/harness/harnesses.h"

/* Distance, normal and curvature against differences of the distance. */
static void check_distance(const struct wb_obstacle *obstacle, const double point[3],
                           double expected)
{
    double n[3], curvature[9], near[3], other[9];
    assert_close(wb_obstacle_distance(obstacle, point, n, curvature), expected, 1e-14);
    assert_close(wb_vec3_length(n), 1.0, 1e-14);
    for (int k = 0; k < 3; k++) {
        const double step = 1e-6;
        double before[3], after[3], at[3];
        memcpy(at, point, sizeof at);
        at[k] += step;
        const double up = wb_obstacle_distance(obstacle, at, after, other);
        at[k] -= 2.0 * step;
        const double down = wb_obstacle_distance(obstacle, at, before, other);
        assert_close(n[k], (up - down) / (2.0 * step), 1e-8);
        for (int i = 0; i < 3; i++)
            near[i] = (after[i] - before[i]) / (2.0 * step);
        for (int i = 0; i < 3; i++)
            assert_close(curvature[3 * i + k], near[i], 1e-6 * (1.0 + fabs(near[i])));
    }
}

static void distances_have_their_gradients(void **unused)
{
    (void)unused;
    const double turn[3] = {0.0, 0.0, 0.5 * M_PI};
    struct wb_obstacle o = {.kind = WB_OBSTACLE_PLANE, .place = {0.1, 0.2, 0.3}};
    wb_rod_element_exponential(turn, o.rotation); /* its x axis is y */
    check_distance(&o, (const double[3]){7.0, 0.5, -2.0}, 0.3);
    check_distance(&o, (const double[3]){7.0, 0.1, -2.0}, -0.1);
    o.kind = WB_OBSTACLE_CYLINDER;
    o.size[0] = 0.05;
    o.size[1] = 0.4;
    check_distance(&o, (const double[3]){0.1, 0.3, 0.5}, 0.15);                /* side */
    check_distance(&o, (const double[3]){0.12, 0.5, 0.31}, 0.1);               /* end */
    check_distance(&o, (const double[3]){0.1, 0.43, 0.39}, hypot(0.03, 0.04)); /* edge */
    check_distance(&o, (const double[3]){0.13, 0.25, 0.3}, -0.02);             /* inside */
    o.kind = WB_OBSTACLE_BOX;
    o.size[0] = 0.2;
    o.size[1] = 0.1;
    o.size[2] = 0.3;
    check_distance(&o, (const double[3]){0.11, 0.36, 0.2}, 0.06);                       /* face */
    check_distance(&o, (const double[3]){0.19, 0.33, 0.2}, hypot(0.04, 0.03));          /* edge */
    check_distance(&o, (const double[3]){0.18, 0.33, 0.49}, sqrt(9e-4 + 9e-4 + 16e-4)); /* corner */
    o.edge = 0.01;
    check_distance(&o, (const double[3]){0.11, 0.36, 0.2}, 0.06);
    check_distance(&o, (const double[3]){0.19, 0.33, 0.2}, hypot(0.05, 0.04) - 0.01);
    o.edge = 0.0;
    check_distance(&o, (const double[3]){0.11, 0.29, 0.3}, -0.01); /* inside */
}

static void impossible_obstacles_are_refused(void **unused)
{
    (void)unused;
    const struct wb_obstacle good = {.kind = WB_OBSTACLE_BOX, .size = {1.0, 1.0, 1.0}};
    struct wb_obstacle bad = good;
    struct wb_reason why;
    assert_int_equal(wb_obstacle_check(&good, &why), WB_OK);
    bad.size[2] = 0.0;
    assert_int_equal(wb_obstacle_check(&bad, &why), WB_ERR_ARGUMENT);
    bad = good;
    bad.edge = 0.6;
    assert_int_equal(wb_obstacle_check(&bad, &why), WB_ERR_ARGUMENT);
    bad = good;
    bad.friction = -0.1;
    assert_int_equal(wb_obstacle_check(&bad, &why), WB_ERR_ARGUMENT);
}

/* One branch along x from the origin, with obstacles. */
static struct test_harness rod(struct wb_law_section *section, double length, double mass,
                               int n_elements, const struct wb_obstacle *obstacles, int n)
{
    const struct wb_harness_branch branch = {.parent = -1,
                                             .leaving = {1.0, 0.0, 0.0, 0.0},
                                             .section = section,
                                             .length = length,
                                             .mass = mass,
                                             .radius = 1e-3};
    const struct wb_harness_model model = {.n_branches = 1,
                                           .branches = &branch,
                                           .n_obstacles = n,
                                           .obstacles = obstacles,
                                           .gravity = {0.0, 0.0, -9.80665},
                                           .element_length = length / n_elements,
                                           .root = test_origin};
    struct test_harness t = test_harness_make(&model);
    t.section = section;
    return t;
}

/* Forces and moments of root, weight and obstacles balance. */
static void check_balance(const struct test_harness *t, int n_obstacles, double weight_factor)
{
    double sum[6], weight[6], root[6], moment[3], size = 0.0;
    wb_harness_weight(t->harness, weight);
    wb_harness_reaction(t->harness, 0, root);
    wb_vec3_cross(wb_harness_node(t->harness, 0)->position, root, moment);
    for (int k = 0; k < 6; k++)
        sum[k] = root[k] + weight_factor * weight[k] + (k < 3 ? 0.0 : moment[k - 3]);
    for (int i = 0; i < n_obstacles; i++) {
        double force[6];
        wb_harness_obstacle_force(t->harness, i, force);
        size += wb_vec3_length(force);
        for (int k = 0; k < 6; k++)
            sum[k] += force[k];
    }
    size += wb_vec3_length(root) + wb_vec3_length(weight);
    for (int k = 0; k < 6; k++)
        assert_close(sum[k], 0.0, 1e-9 * size);
}

/* A heavy cantilever that sags onto a floor: the part on the floor carries its own weight, the free
 * length l and the floor's edge force q l / ... follow from beam theory: a clamped beam with weight
 * q whose end touches the floor at depth d with zero slope and zero moment: d = q l^4 / (72 EI). */
static void wire_lies_down_on_a_floor(void **unused)
{
    (void)unused;
    const double EI = 1e-3, q = 0.05 * 9.80665, depth = 2e-4;
    const double free_length = pow(72.0 * EI * depth / q, 0.25);
    const double turn[3] = {0.0, -0.5 * M_PI, 0.0};
    struct wb_obstacle floor = {.kind = WB_OBSTACLE_PLANE, .place = {0.0, 0.0, -depth - 1e-3}};
    wb_rod_element_exponential(turn, floor.rotation);
    struct test_harness t = rod(test_elastic_section(EI, 0.0), 0.3, 0.05, 75, &floor, 1);
    const struct wb_harness_move hang = {.weight = 1.0};
    double root[6], force[6];
    int obstacle, branch;
    double at;
    (void)test_harness_move(&t, &hang);
    wb_harness_reaction(t.harness, 0, root);
    wb_harness_obstacle_force(t.harness, 0, force);
    /* The root carries 2/3 of the free part: q l / 2 + the fixed end's share. */
    assert_close_relative(root[2], q * free_length * 2.0 / 3.0, 5e-3);
    assert_close_relative(force[2] + root[2], q * 0.3, 1e-6);
    for (double s = free_length + 4e-3; s <= 0.3; s += 0.01)
        assert_close(wb_harness_position(t.harness, 0, s).position[2], -depth, 3e-6);
    assert_true(wb_harness_depth(t.harness, &obstacle, &branch, &at) < 3e-6);
    check_balance(&t, 1, 1.0);
    test_harness_release(&t);
}

/* A soft wire over a cylinder with a force at its end, 0.6 rad downwards: Euler and Eytelwein's
 * exp(friction times angle) between the force at the root and that at the end, whichever way the
 * wire slides. Its stiffness EI / (T R^2) is below 1e-4. */
static void friction_on_a_cylinder_is_that_of_euler_and_eytelwein(void **unused)
{
    (void)unused;
    const double R = 0.05, T = 4.0, EI = 0.9e-4 * T * R * R, angle = 0.6, friction = 0.4;
    const double turn[3] = {0.0, 0.0, 0.5 * M_PI}, length = 0.09;
    struct wb_obstacle tube = {.kind = WB_OBSTACLE_CYLINDER,
                               .place = {0.03, 0.0, -R - 1e-5},
                               .size = {R - 1e-3, 1.0},
                               .friction = friction};
    wb_rod_element_exponential(turn, tube.rotation);
    struct test_harness t = rod(test_elastic_section(EI, 0.0), length, 0.0, 180, &tube, 1);
    const struct wb_harness_load load = {wb_harness_joint(t.harness, 0, length),
                                         {T * cos(angle), 0.0, -T * sin(angle)}};
    const struct wb_harness_move move = {.n_loads = 1, .loads = &load};
    const double pulls[2] = {-2e-3, 2e-3};
    (void)test_harness_move(&t, &move);
    for (int i = 0; i < 2; i++) {
        const double expected = T * exp(pulls[i] < 0.0 ? friction * angle : -friction * angle);
        struct wb_rod_node target = test_origin;
        double root[6], force[6];
        target.position[0] = pulls[i];
        (void)test_harness_aim(&t, 0, &target);
        wb_harness_reaction(t.harness, 0, root);
        wb_harness_obstacle_force(t.harness, 0, force);
        assert_close_relative(-root[0], expected, 1e-3);
        for (int k = 0; k < 3; k++)
            assert_close(root[k] + force[k] + load.load[k], 0.0, 1e-8 * T);
    }
    test_harness_release(&t);
}

/* A heavy wire over the round edge of a box, pulled back and forth: a scene and the same scene
 * turned and shifted. */
static void pull_over_a_box(const struct wb_rod_node *place, double friction,
                            struct wb_rod_node *end, double root[6])
{
    struct wb_obstacle box = {
        .kind = WB_OBSTACLE_BOX, .size = {0.1, 0.2, 0.05}, .friction = friction};
    const double centre[3] = {0.1, 0.0, -0.0425}, down[3] = {0.0, 0.0, -9.80665};
    double R[9], gravity[3], way[3], at[3];
    wb_rod_element_matrix(place->rotation, R);
    memcpy(box.rotation, place->rotation, sizeof box.rotation);
    wb_vec3_turn(R, centre, at);
    wb_vec3_turn(R, down, gravity);
    for (int k = 0; k < 3; k++)
        box.place[k] = place->position[k] + at[k];
    const struct wb_harness_branch branch = {.parent = -1,
                                             .leaving = {1.0, 0.0, 0.0, 0.0},
                                             .section = test_elastic_section(2e-4, 0.0),
                                             .length = 0.5,
                                             .mass = 0.02,
                                             .radius = 2e-3};
    struct wb_harness_model model = {.n_branches = 1,
                                     .branches = &branch,
                                     .n_obstacles = 1,
                                     .obstacles = &box,
                                     .element_length = 1e-2,
                                     .root = *place};
    memcpy(model.gravity, gravity, sizeof gravity);
    struct test_harness t = test_harness_make(&model);
    t.section = (struct wb_law_section *)branch.section;
    const struct wb_harness_move hang = {.weight = 1.0};
    const double targets[3][3] = {{-0.05, 0.01, 0.01}, {0.02, 0.0, 0.0}, {0.0, 0.03, 0.0}};
    (void)test_harness_move(&t, &hang);
    for (int i = 0; i < 3; i++) {
        struct wb_rod_node target = *place;
        wb_vec3_turn(R, targets[i], way);
        for (int k = 0; k < 3; k++)
            target.position[k] += way[k];
        const struct wb_harness_aim aim = {0, target};
        const struct wb_harness_move move = {.n_aims = 1, .aims = &aim, .weight = 1.0};
        (void)test_harness_move(&t, &move);
        check_balance(&t, 1, 1.0);
    }
    *end = *wb_harness_node(t.harness, wb_harness_joint(t.harness, 0, 0.5));
    wb_harness_reaction(t.harness, 0, root);
    test_harness_release(&t);
}

/* With friction they depend on the increments, in which the two differ. */
static void check_turned_scene(double friction, double tolerance)
{
    const double turn[3] = {0.3, -1.1, 0.7};
    struct wb_rod_node turned = {.position = {0.2, -0.1, 0.4}}, ends[2];
    double root[2][6], R[9], expected[3], shifted[3];
    wb_rod_element_exponential(turn, turned.rotation);
    wb_rod_element_matrix(turned.rotation, R);
    pull_over_a_box(&test_origin, friction, &ends[0], root[0]);
    pull_over_a_box(&turned, friction, &ends[1], root[1]);
    for (int half = 0; half < 2; half++) {
        wb_vec3_turn(R, root[0] + 3 * half, expected);
        for (int k = 0; k < 3; k++)
            assert_close(root[1][3 * half + k], expected[k], tolerance * wb_vec3_length(expected));
    }
    wb_vec3_turn(R, ends[0].position, expected);
    for (int k = 0; k < 3; k++)
        shifted[k] = expected[k] + turned.position[k];
    assert_close(wb_vec3_distance(ends[1].position, shifted), 0.0, tolerance);
}

static void forces_turn_with_the_scene(void **unused)
{
    (void)unused;
    check_turned_scene(0.0, 1e-7);
    check_turned_scene(0.25, 1e-3);
}

/* Pushed across a post without friction, the work at the root is the change of the elastic energy;
 * and back, the harness is where it was. */
static void smooth_obstacle_takes_no_work(void **unused)
{
    (void)unused;
    struct wb_obstacle post = {.kind = WB_OBSTACLE_CYLINDER,
                               .place = {0.2, -0.02, 0.0},
                               .rotation = {0.7071067811865476, 0.0, -0.7071067811865476, 0.0},
                               .size = {0.01, 0.3}};
    struct test_harness t = rod(test_elastic_section(1e-3, 0.0), 0.3, 0.0, 60, &post, 1);
    double before[6], after[6], work = 0.0;
    for (int i = 1; i <= 80; i++) {
        struct wb_rod_node target = test_origin;
        target.position[1] = -0.06 * (i <= 40 ? i : 80 - i) / 40;
        wb_harness_reaction(t.harness, 0, before);
        (void)test_harness_aim(&t, 0, &target);
        wb_harness_reaction(t.harness, 0, after);
        work += 0.5 * (before[1] + after[1]) * (i <= 40 ? -0.06 : 0.06) / 40;
        if (i == 40) {
            assert_true(work > 1e-4);
            assert_close_relative(work, wb_harness_elastic_energy(t.harness), 2e-3);
            check_balance(&t, 1, 0.0);
        }
    }
    assert_close(wb_harness_elastic_energy(t.harness), 0.0, 1e-12);
    test_harness_release(&t);
}

/* A wire that falls into the corner of a floor and a wall rests on both. */
static void wire_rests_in_a_corner(void **unused)
{
    (void)unused;
    struct wb_obstacle sides[2] = {
        {.kind = WB_OBSTACLE_PLANE, .place = {0.0, 0.0, -0.03}},
        {.kind = WB_OBSTACLE_PLANE,
         .place = {0.0, -0.004, 0.0},
         .rotation = {0.7071067811865476, 0.0, 0.0, 0.7071067811865476}}};
    const double up[3] = {0.0, -0.5 * M_PI, 0.0};
    wb_rod_element_exponential(up, sides[0].rotation);
    struct test_harness t = rod(test_elastic_section(1e-4, 0.0), 0.4, 0.02, 40, sides, 2);
    const struct wb_harness_load load = {wb_harness_joint(t.harness, 0, 0.4), {0.0, -2e-3, 0.0}};
    const struct wb_harness_move move = {.n_loads = 1, .loads = &load, .weight = 1.0};
    double force[2][6], weight[6], root[6];
    (void)test_harness_move(&t, &move);
    for (int i = 0; i < 2; i++)
        wb_harness_obstacle_force(t.harness, i, force[i]);
    wb_harness_weight(t.harness, weight);
    wb_harness_reaction(t.harness, 0, root);
    assert_true(force[0][2] > 0.5 * -weight[2] && force[1][1] > 1e-3);
    assert_close(force[0][2] + root[2] + weight[2], 0.0, 1e-9 * -weight[2]);
    assert_close(force[1][1] + root[1] + load.load[1], 0.0, 1e-9);
    assert_close(wb_harness_node(t.harness, load.joint)->position[1], -0.003, 3e-6);
    assert_close(wb_harness_node(t.harness, load.joint)->position[2], -0.029, 3e-6);
    test_harness_release(&t);
}

/* Bent over a thin post and let go at once, a wire rests against the post; it does not pass through
 * to where it is straight. */
static void wire_that_springs_back_stops_at_a_post(void **unused)
{
    (void)unused;
    struct wb_obstacle post = {.kind = WB_OBSTACLE_CYLINDER,
                               .place = {0.2, -0.03, 0.0},
                               .rotation = {0.7071067811865476, 0.0, -0.7071067811865476, 0.0},
                               .size = {2e-3, 0.3}};
    struct test_harness t = rod(test_elastic_section(1e-3, 0.0), 0.3, 0.0, 30, &post, 1);
    const int end = wb_harness_joint(t.harness, 0, 0.3);
    const struct wb_harness_load load = {end, {0.0, 0.02, 0.0}};
    const struct wb_harness_move bend = {.n_loads = 1, .loads = &load};
    struct wb_rod_node target = test_origin;
    struct wb_harness_result result;
    double force[6];
    (void)test_harness_move(&t, &bend);
    target.position[1] = -0.06;
    (void)test_harness_aim(&t, 0, &target);
    assert_true(wb_harness_position(t.harness, 0, 0.2).position[1] > -0.027);
    wb_harness_set_load(t.harness, end, (const double[6]){0.0});
    wb_harness_solver_settle(t.solver, 0.0, NULL, NULL, &result);
    assert_int_equal(result.end, WB_HARNESS_CONVERGED);
    wb_harness_obstacle_force(t.harness, 0, force);
    assert_true(force[1] > 1e-3);
    assert_true(wb_harness_position(t.harness, 0, 0.2).position[1] > -0.03);
    test_harness_release(&t);
}

/* Of more places near obstacles than there is room for, none is left out in silence. */
static void too_many_places_are_not_an_equilibrium(void **unused)
{
    (void)unused;
    struct wb_obstacle floors[20];
    const double up[3] = {0.0, -0.5 * M_PI, 0.0};
    for (int i = 0; i < 20; i++) {
        floors[i] = (struct wb_obstacle){.kind = WB_OBSTACLE_PLANE,
                                         .place = {0.0, 0.0, -2e-3 - 1e-5 * (20 - i)}};
        wb_rod_element_exponential(up, floors[i].rotation);
    }
    const struct wb_harness_move hang = {.weight = 1.0};
    for (int n = 2; n <= 20; n += 18) {
        struct test_harness t = rod(test_elastic_section(1e-3, 0.0), 0.3, 0.05, 10, floors, n);
        struct wb_harness_result result;
        wb_harness_solver_move(t.solver, &hang, &result);
        assert_int_equal(result.end, n == 2 ? WB_HARNESS_CONVERGED : WB_HARNESS_NOT_CONVERGED);
        test_harness_release(&t);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(distances_have_their_gradients),
        cmocka_unit_test(impossible_obstacles_are_refused),
        cmocka_unit_test(wire_lies_down_on_a_floor),
        cmocka_unit_test(forces_turn_with_the_scene),
        cmocka_unit_test(smooth_obstacle_takes_no_work),
        cmocka_unit_test(wire_rests_in_a_corner),
        cmocka_unit_test(too_many_places_are_not_an_equilibrium),
        cmocka_unit_test(wire_that_springs_back_stops_at_a_post),
        cmocka_unit_test(friction_on_a_cylinder_is_that_of_euler_and_eytelwein),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
