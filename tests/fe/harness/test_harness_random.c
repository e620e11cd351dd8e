/* Random trees and sequences of steps: nearly all find stable equilibria, with obstacles and
 * friction seven of eight; the others are printed with their cause. Usage: test_harness_random
 * [many] */
#include "base/vec3.h"
#include "tests/fe/harness/harnesses.h"

enum {
    MOST_BRANCHES = 5,
    STEPS = 5,
    FEW = 40,
    MANY = 1000
};

static int all_cases = FEW;

struct random_tree {
    uint64_t random;
    int n_branches;
    struct wb_law_section *sections[MOST_BRANCHES];
    double curvature[MOST_BRANCHES][3];
    int parents[MOST_BRANCHES];
    double lengths[MOST_BRANCHES];
    int ends[MOST_BRANCHES]; /* joints */
    bool is_held[MOST_BRANCHES];
    int middles[MOST_BRANCHES]; /* joints of sliding clips; 0: none */
    bool slides[MOST_BRANCHES];
    int n_obstacles;
    bool begins_inside;
    struct wb_obstacle obstacles[2];
    struct test_harness t;
};

static double within(uint64_t *random, double low, double high)
{
    return low + (high - low) * test_random(random);
}

static void constant_curvature(void *context, double s, double curvature[3])
{
    (void)s;
    memcpy(curvature, context, 3 * sizeof *curvature);
}

/* A floor, and a bar or a box below the root. */
static void add_obstacles(struct random_tree *tree)
{
    const double up[3] = {0.0, -0.5 * M_PI, 0.0}, across[3] = {0.0, 0.0, 0.5 * M_PI};
    struct wb_obstacle *const floor = &tree->obstacles[0], *const other = &tree->obstacles[1];
    *floor = (struct wb_obstacle){.kind = WB_OBSTACLE_PLANE,
                                  .place = {0.0, 0.0, within(&tree->random, -0.5, -0.15)},
                                  .friction = within(&tree->random, 0.0, 0.5)};
    wb_rod_element_exponential(up, floor->rotation);
    *other = (struct wb_obstacle){.kind = test_random(&tree->random) < 0.5 ? WB_OBSTACLE_CYLINDER
                                                                           : WB_OBSTACLE_BOX,
                                  .place = {within(&tree->random, 0.05, 0.3), 0.0, -0.1},
                                  .size = {within(&tree->random, 0.01, 0.05), 0.1, 0.05},
                                  .edge = 2e-3,
                                  .friction = within(&tree->random, 0.0, 0.5)};
    wb_rod_element_exponential(across, other->rotation);
    tree->n_obstacles = 2;
}

static void make(struct random_tree *tree, uint64_t seed, bool has_all)
{
    struct wb_harness_branch branches[MOST_BRANCHES];
    struct wb_harness_body bodies[MOST_BRANCHES];
    double middles[MOST_BRANCHES], at;
    int obstacle, branch;
    *tree = (struct random_tree){.random = seed};
    for (int i = 0; i < 10; i++)
        (void)test_random(&tree->random);
    tree->n_branches = 1 + (int)within(&tree->random, 0.0, MOST_BRANCHES);
    for (int i = 0; i < tree->n_branches; i++) {
        const struct wb_law law = test_laws_get((int)within(&tree->random, 0.0, TEST_LAWS));
        const double diameter = within(&tree->random, 1e-3, 5e-3);
        const struct wb_law_section_model section = {
            .diameter = diameter, .law = &law, .fibres = {4, 12}};
        assert_int_equal(wb_law_section_create(&tree->sections[i], &section), WB_OK);
        double turn[3];
        for (int k = 0; k < 3; k++) {
            turn[k] = i == 0 ? 0.0 : within(&tree->random, -0.8, 0.8);
            tree->curvature[i][k] = within(&tree->random, -2.0, 2.0);
        }
        tree->parents[i] = i == 0 ? -1 : (int)within(&tree->random, 0.0, i);
        tree->lengths[i] = within(&tree->random, 0.1, 0.4);
        branches[i] = (struct wb_harness_branch){
            .parent = tree->parents[i],
            .section = tree->sections[i],
            .length = tree->lengths[i],
            .mass = 5000.0 * M_PI * diameter * diameter / 4.0,
            .natural_curvature = constant_curvature,
            .curvature_context = tree->curvature[i],
            .radius = 0.5 * diameter,
            .n_stations = has_all,
            .stations = &middles[i],
        };
        middles[i] = 0.5 * tree->lengths[i];
        wb_rod_element_exponential(turn, branches[i].leaving);
        bodies[i] = (struct wb_harness_body){
            .branch = i, .mass = within(&tree->random, 0.0, 0.02), .centre = {0.01, 0.0, 0.005}};
    }
    if (has_all)
        add_obstacles(tree);
    const struct wb_harness_model model = {.n_branches = tree->n_branches,
                                           .branches = branches,
                                           .n_obstacles = tree->n_obstacles,
                                           .obstacles = tree->obstacles,
                                           .most_sliding = has_all ? tree->n_branches : 0,
                                           .n_bodies = tree->n_branches,
                                           .bodies = bodies,
                                           .gravity = {0.0, 0.0, -9.80665},
                                           .element_length = 0.02,
                                           .root = test_origin};
    tree->t = test_harness_make(&model);
    tree->begins_inside = wb_harness_depth(tree->t.harness, &obstacle, &branch, &at) > 1e-6;
    for (int i = 0; i < tree->n_branches; i++)
        tree->ends[i] = wb_harness_joint(tree->t.harness, i, tree->lengths[i]);
    for (int i = 0; i < tree->n_branches && has_all; i++)
        tree->middles[i] = wb_harness_joint(tree->t.harness, i, middles[i]);
}

static void release(struct random_tree *tree)
{
    test_harness_release(&tree->t);
    for (int i = 0; i < tree->n_branches; i++)
        wb_law_section_destroy(tree->sections[i]);
}

/* Length of wire between the ends of two branches; -1: the root. */
static double wire_between(const struct random_tree *tree, int a, int b)
{
    double way = 0.0;
    while (a != b) {
        int *const later = a > b ? &a : &b;
        way += tree->lengths[*later];
        *later = tree->parents[*later];
    }
    return way;
}

/* Length of wire between the sliding clip of a branch and the end of another; -1: the root. */
static double wire_from_middle(const struct random_tree *tree, int branch, int other)
{
    const double length = tree->lengths[branch];
    const double at = 0.5 * length + wb_harness_slid(tree->t.harness, tree->middles[branch]);
    int i = other;
    while (i > branch)
        i = tree->parents[i];
    return i == branch ? wire_between(tree, branch, other) + length - at
                       : wire_between(tree, branch, other) - length + at;
}

static bool is_inside(const struct random_tree *tree, const double place[3])
{
    double normal[3], curvature[9];
    for (int i = 0; i < tree->n_obstacles; i++) {
        if (wb_obstacle_distance(&tree->obstacles[i], place, normal, curvature) < 5e-3)
            return true;
    }
    return false;
}

/* Moves an end to a random place that it can reach with a tenth of the wire to spare; false: none
 * was found. */
static bool find_target(struct random_tree *tree, int end, struct wb_rod_node *target)
{
    const struct wb_harness *const h = tree->t.harness;
    const struct wb_rod_node *const now = wb_harness_node(h, tree->ends[end]);
    for (int attempt = 0; attempt < 50; attempt++) {
        double turn[3], q[4];
        bool reachable = true;
        for (int k = 0; k < 3; k++) {
            target->position[k] = now->position[k] + within(&tree->random, -0.15, 0.15);
            turn[k] = within(&tree->random, -0.6, 0.6);
        }
        wb_rod_element_exponential(turn, q);
        wb_rod_element_compose(q, now->rotation, target->rotation);
        reachable &= !is_inside(tree, target->position);
        for (int other = 0; other < tree->n_branches; other++)
            reachable &= !tree->slides[other] ||
                         wb_vec3_distance(target->position,
                                          wb_harness_held_node(h, tree->middles[other]).position) <
                             0.9 * wire_from_middle(tree, other, end);
        for (int other = -1; other < tree->n_branches; other++) {
            if (other == end || (other >= 0 && !tree->is_held[other]))
                continue;
            const struct wb_rod_node *const held =
                wb_harness_node(h, other < 0 ? 0 : tree->ends[other]);
            reachable &= wb_vec3_distance(target->position, held->position) <
                         0.9 * wire_between(tree, end, other);
        }
        if (reachable)
            return true;
    }
    return false;
}

static void mount(struct random_tree *tree, int end, struct wb_harness_result *result)
{
    static const enum wb_harness_hold holds[] = {WB_HARNESS_POINT, WB_HARNESS_AXIS,
                                                 WB_HARNESS_FIXED};
    struct wb_harness *const h = tree->t.harness;
    struct wb_harness_aim aim = {.joint = tree->ends[end]};
    result->end = WB_HARNESS_CONVERGED;
    if (!find_target(tree, end, &aim.target))
        return;
    if (!tree->is_held[end])
        wb_harness_set_hold(h, aim.joint, holds[(int)within(&tree->random, 0.0, 3.0)],
                            wb_harness_node(h, aim.joint));
    tree->is_held[end] = true;
    const struct wb_harness_move move = {.n_aims = 1, .aims = &aim, .weight = 1.0};
    wb_harness_solver_move(tree->t.solver, &move, result);
}

/* Mounts a clip at the middle of a branch, where the wire slides, and moves it a little, or lets it
 * go. */
static void slide(struct random_tree *tree, int branch, struct wb_harness_result *result)
{
    struct wb_harness *const h = tree->t.harness;
    struct wb_harness_aim aim = {.joint = tree->middles[branch]};
    if (tree->slides[branch]) {
        tree->slides[branch] = false;
        wb_harness_set_hold(h, aim.joint, WB_HARNESS_FREE, NULL);
        wb_harness_solver_settle(tree->t.solver, 1.0, NULL, NULL, result);
        return;
    }
    aim.target = *wb_harness_node(h, aim.joint);
    for (int k = 0; k < 3; k++)
        aim.target.position[k] += within(&tree->random, -0.02, 0.02);
    result->end = WB_HARNESS_CONVERGED;
    bool reachable = !is_inside(tree, aim.target.position);
    for (int other = -1; other < tree->n_branches; other++) {
        const double *const held = wb_harness_node(h, other < 0 ? 0 : tree->ends[other])->position;
        reachable &= (other >= 0 && !tree->is_held[other]) ||
                     wb_vec3_distance(aim.target.position, held) <
                         0.9 * wire_from_middle(tree, branch, other);
    }
    if (!reachable)
        return;
    wb_harness_let_slide(h, aim.joint, within(&tree->random, 0.0, 0.3));
    tree->slides[branch] = true;
    const struct wb_harness_move move = {.n_aims = 1, .aims = &aim, .weight = 1.0};
    wb_harness_solver_move(tree->t.solver, &move, result);
}

/* A hold that is let go, or one that is mounted or moved. */
static void step(struct random_tree *tree, struct wb_harness_result *result)
{
    const int end = (int)within(&tree->random, 0.0, tree->n_branches);
    if (tree->middles[end] > 0 && test_random(&tree->random) < 0.3) {
        slide(tree, end, result);
        return;
    }
    if (tree->is_held[end] && test_random(&tree->random) < 0.4) {
        tree->is_held[end] = false;
        wb_harness_set_hold(tree->t.harness, tree->ends[end], WB_HARNESS_FREE, NULL);
        wb_harness_solver_settle(tree->t.solver, 1.0, NULL, NULL, result);
        return;
    }
    mount(tree, end, result);
}

static void check_sequences(int n_cases, bool has_all, double part)
{
    int inside = 0, reached = 0, snaps = 0, iterations = 0, most = 0;
    for (int i = 0; i < n_cases; i++) {
        struct random_tree tree;
        struct wb_harness_result result;
        const struct wb_harness_move hang = {.weight = 1.0};
        make(&tree, 1000 + 7 * (uint64_t)i, has_all);
        if (tree.begins_inside) {
            inside++;
            release(&tree);
            continue;
        }
        wb_harness_solver_move(tree.t.solver, &hang, &result);
        for (int k = 0; k <= STEPS; k++) {
            struct wb_harness_balance balance;
            iterations += result.iterations;
            most = result.iterations > most ? result.iterations : most;
            snaps += result.n_snaps;
            if (result.end != WB_HARNESS_CONVERGED) {
                printf("case %d, step %d: at %.3g: %s; %d branches, joint %d, residual %.2g\n", i,
                       k, result.fraction, result.problem, tree.n_branches, result.worst_joint,
                       result.residual);
                break;
            }
            wb_harness_evaluate(tree.t.harness, 1.0, &balance);
            wb_harness_solve(tree.t.harness);
            assert_int_equal(wb_harness_negative(tree.t.harness), 0);
            assert_true(balance.largest_residual <= 1e-9 * balance.largest_force);
            reached += k == STEPS;
            result = (struct wb_harness_result){.end = WB_HARNESS_CONVERGED};
            if (k < STEPS)
                step(&tree, &result);
        }
        release(&tree);
    }
    printf("%d of %d sequences reached stable equilibria; %d snaps, %d iterations, at most %d in a "
           "step\n",
           reached, n_cases - inside, snaps, iterations, most);
    assert_true(reached >= part * (n_cases - inside));
}

static void sequences_reach_stable_equilibria(void **unused)
{
    (void)unused;
    check_sequences(all_cases, false, 0.98);
}

static void most_sequences_with_obstacles_and_sliding_clips_do_too(void **unused)
{
    (void)unused;
    check_sequences(all_cases / 4, true, 0.86);
}

int main(int argc, char **argv)
{
    (void)argv;
    all_cases = argc > 1 ? MANY : FEW;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sequences_reach_stable_equilibria),
        cmocka_unit_test(most_sequences_with_obstacles_and_sliding_clips_do_too),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
