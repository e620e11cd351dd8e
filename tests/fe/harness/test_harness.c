/* A tree of branches: balance of forces, independence of frame and of how it is divided, holds,
 * release. */
#include "base/vec3.h"
#include "tests/fe/harness/harnesses.h"

#define GRAVITY 9.80665

enum {
    BRANCHES = 4,
    BODIES = 2
};

/* A trunk that divides in two, one of which divides again; bundles are thicker. */
struct tree {
    struct wb_law_section *thick, *thin;
    struct test_harness t;
    struct wb_rod_node root;
    double frame[9]; /* of the root */
    int clip, end;   /* joints: within the trunk, and at the end of the third branch */
};

static void curl(void *context, double s, double curvature[3])
{
    (void)context;
    curvature[0] = 1.0;
    curvature[1] = 2.0 * cos(4.0 * s);
    curvature[2] = -3.0;
}

static struct wb_law_section *section_of(double diameter, const struct wb_law *law)
{
    struct wb_law_section *section;
    const struct wb_law_section_model model = {.diameter = diameter, .law = law, .fibres = {4, 16}};
    assert_int_equal(wb_law_section_create(&section, &model), WB_OK);
    return section;
}

/* A tree whose root is at `root`, in a frame turned with it. `cut`: the trunk consists of two
 * branches. */
static void make_tree(struct tree *tree, const struct wb_law *law, const struct wb_rod_node *root,
                      bool cut)
{
    static const double turns[BRANCHES][3] = {
        {0.0, 0.0, 0.0}, {0.0, 0.0, 0.7}, {0.0, 0.5, -0.6}, {0.3, 0.0, -0.8}};
    static const double lengths[BRANCHES] = {0.4, 0.3, 0.25, 0.2};
    static const double station = 0.2;
    tree->root = *root;
    tree->thick = section_of(2.8e-3, law);
    tree->thin = section_of(1.4e-3, law);
    wb_rod_element_matrix(root->rotation, tree->frame);

    struct wb_harness_branch branches[BRANCHES + 1];
    int n = 0;
    for (int i = 0; i < BRANCHES; i++) {
        const int parent = i == 0 ? -1 : i == 3 ? n - 2 : cut ? 1 : 0;
        branches[n] = (struct wb_harness_branch){
            .parent = parent,
            .section = i == 0 ? tree->thick : tree->thin,
            .length = lengths[i],
            .mass = i == 0 ? 0.03 : 0.008,
            .natural_curvature = i > 1 ? curl : NULL,
            .n_stations = i == 0 ? 1 : 0,
            .stations = &station,
        };
        wb_rod_element_exponential(turns[i], branches[n].leaving);
        n++;
        if (i == 0 && cut) {
            branches[1] = branches[0];
            branches[0].length = branches[1].length = 0.2;
            branches[0].n_stations = branches[1].n_stations = 0;
            branches[1].parent = 0;
            n++;
        }
    }
    const struct wb_harness_body bodies[BODIES] = {
        {n - 1, 0.01, {0.02, 0.005, 0.0}},
        {n - 3, 0.02, {0.01, 0.0, -0.01}},
    };
    struct wb_harness_model model = {.n_branches = n,
                                     .branches = branches,
                                     .n_bodies = BODIES,
                                     .bodies = bodies,
                                     .element_length = 0.02,
                                     .root = *root};
    for (int k = 0; k < 3; k++)
        model.gravity[k] = -GRAVITY * tree->frame[3 * k + 2];
    tree->t = test_harness_make(&model);
    tree->clip = cut ? wb_harness_joint(tree->t.harness, 0, 0.2)
                     : wb_harness_joint(tree->t.harness, 0, station);
    tree->end = wb_harness_joint(tree->t.harness, n - 2, lengths[2]);
}

static void release_tree(struct tree *tree)
{
    test_harness_release(&tree->t);
    wb_law_section_destroy(tree->thick);
    wb_law_section_destroy(tree->thin);
}

/* A place in the frame of the root. */
static struct wb_rod_node place(const struct tree *tree, const double at[3], const double turn[3])
{
    struct wb_rod_node node;
    for (int k = 0; k < 3; k++)
        node.position[k] = tree->root.position[k] + wb_vec3_dot(tree->frame + 3 * k, at);
    wb_rod_element_exponential(turn, node.rotation);
    wb_rod_element_compose(tree->root.rotation, node.rotation, node.rotation);
    return node;
}

static void check_balance(const struct tree *tree)
{
    struct wb_harness *const h = tree->t.harness;
    double sum[6], size;
    wb_harness_weight(h, sum);
    size = wb_vec3_length(sum);
    for (int j = 0; j < wb_harness_n_joints(h); j++) {
        if (wb_harness_hold(h, j) == WB_HARNESS_FREE)
            continue;
        double reaction[6], moment[3];
        const double *const r = wb_harness_node(h, j)->position;
        wb_harness_reaction(h, j, reaction);
        wb_vec3_cross(r, reaction, moment);
        for (int k = 0; k < 3; k++) {
            sum[k] += reaction[k];
            sum[3 + k] += reaction[3 + k] + moment[k];
        }
    }
    for (int k = 0; k < 6; k++)
        assert_close(sum[k], 0.0, 1e-9 * size * (k < 3 ? 1.0 : 1.15));
}

/* Hangs, is clipped, pulled and turned at one end; everything plastic. */
static void assemble(struct tree *tree)
{
    struct test_harness *const t = &tree->t;
    const struct wb_harness_move hang = {.weight = 1.0};
    (void)test_harness_move(t, &hang);
    check_balance(tree);

    wb_harness_set_hold(t->harness, tree->clip, WB_HARNESS_AXIS,
                        wb_harness_node(t->harness, tree->clip));
    wb_harness_set_hold(t->harness, tree->end, WB_HARNESS_FIXED,
                        wb_harness_node(t->harness, tree->end));
    static const double clip[3] = {0.17, 0.03, 0.05}, clip_turn[3] = {0.0, -0.3, 0.4};
    static const double end[3] = {0.45, 0.1, 0.1}, end_turn[3] = {0.4, -0.5, 0.6};
    const struct wb_harness_aim aims[] = {{tree->clip, place(tree, clip, clip_turn)},
                                          {tree->end, place(tree, end, end_turn)}};
    const struct wb_harness_move mount = {.n_aims = 2, .aims = aims, .weight = 1.0};
    (void)test_harness_move(t, &mount);
    check_balance(tree);

    /* The clip is where it should be, with its axis, and lets the wire turn about it. */
    const struct wb_rod_node *const at = wb_harness_node(t->harness, tree->clip);
    double R[9], aim[9], reaction[6];
    wb_rod_element_matrix(at->rotation, R);
    wb_rod_element_matrix(aims[0].target.rotation, aim);
    wb_harness_reaction(t->harness, tree->clip, reaction);
    double along = 0.0;
    for (int k = 0; k < 3; k++) {
        assert_close(at->position[k], aims[0].target.position[k], 1e-10);
        assert_close(R[3 * k], aim[3 * k], 1e-9);
        along += reaction[3 + k] * R[3 * k];
    }
    assert_close(along, 0.0, 1e-10);
}

static void forces_balance_for_every_law(void **unused)
{
    (void)unused;
    for (int l = 0; l < TEST_LAWS; l++) {
        const struct wb_law law = test_laws_get(l);
        struct tree tree;
        make_tree(&tree, &law, &test_origin, false);
        assemble(&tree);
        release_tree(&tree);
    }
}

/* Reactions and positions of a tree in the frame of its root. */
static void compare_trees(const struct tree *a, const struct tree *b, double tolerance)
{
    const int joints[2][3] = {{0, a->clip, a->end}, {0, b->clip, b->end}};
    for (int i = 0; i < 3; i++) {
        double ra[6], rb[6];
        wb_harness_reaction(a->t.harness, joints[0][i], ra);
        wb_harness_reaction(b->t.harness, joints[1][i], rb);
        const double size = wb_vec3_length(ra) + wb_vec3_length(ra + 3) + 0.1;
        for (int k = 0; k < 6; k++) {
            double ours = 0.0, theirs = 0.0;
            for (int c = 0; c < 3; c++) {
                ours += a->frame[3 * c + k % 3] * ra[k / 3 * 3 + c];
                theirs += b->frame[3 * c + k % 3] * rb[k / 3 * 3 + c];
            }
            assert_close(ours, theirs, tolerance * size);
        }
    }
}

static void frame_does_not_matter(void **unused)
{
    (void)unused;
    const struct wb_law law = test_laws_get(5);
    struct wb_rod_node turned = {.position = {3.0, -2.0, 1.0}};
    const double turn[3] = {0.9, -1.4, 0.6};
    struct tree a, b;
    wb_rod_element_exponential(turn, turned.rotation);
    make_tree(&a, &law, &test_origin, false);
    make_tree(&b, &law, &turned, false);
    assemble(&a);
    assemble(&b);
    compare_trees(&a, &b, 1e-8);
    release_tree(&a);
    release_tree(&b);
}

static void branch_may_be_cut_in_two(void **unused)
{
    (void)unused;
    const struct wb_law law = test_laws_get(1);
    struct tree whole, cut;
    make_tree(&whole, &law, &test_origin, false);
    make_tree(&cut, &law, &test_origin, true);
    assemble(&whole);
    assemble(&cut);
    compare_trees(&whole, &cut, 1e-9);
    release_tree(&whole);
    release_tree(&cut);
}

/* Work of the hold of a joint, by the trapezoidal rule. */
struct watched_work {
    const struct wb_harness *harness;
    int joint;
    struct wb_rod_node node;
    double reaction[6], work;
};

static bool add_work(void *context, double fraction)
{
    struct watched_work *const w = context;
    const struct wb_rod_node node = *wb_harness_node(w->harness, w->joint);
    double reaction[6], turn[3];
    (void)fraction;
    wb_harness_reaction(w->harness, w->joint, reaction);
    wb_rod_element_turn_between(w->node.rotation, node.rotation, turn);
    for (int k = 0; k < 3; k++)
        w->work +=
            0.5 * ((w->reaction[k] + reaction[k]) * (node.position[k] - w->node.position[k]) +
                   (w->reaction[3 + k] + reaction[3 + k]) * turn[k]);
    w->node = node;
    memcpy(w->reaction, reaction, sizeof reaction);
    return true;
}

static void work_on_the_wire_is_elastic_or_plastic(void **unused)
{
    (void)unused;
    for (int l = 0; l < TEST_LAWS; l += 2) {
        const struct wb_law law = test_laws_get(l);
        struct test_harness t = test_single_branch(section_of(8e-3, &law), 20);
        const struct wb_harness_solver_model fine = {t.harness, 0.02};
        wb_harness_solver_destroy(t.solver);
        assert_int_equal(wb_harness_solver_create(&t.solver, &fine), WB_OK);
        const int tip = wb_harness_joint(t.harness, 0, 1.0);
        struct watched_work watched = {
            .harness = t.harness, .joint = tip, .node = *wb_harness_node(t.harness, tip)};
        wb_harness_set_hold(t.harness, tip, WB_HARNESS_FIXED, &watched.node);
        static const double places[][3] = {{0.9, 0.3, 0.1}, {0.8, -0.2, 0.4}, {0.9, 0.1, -0.1}};
        for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
            const double turn[3] = {0.2, -places[i][2], places[i][1]};
            struct wb_harness_aim aim = {.joint = tip};
            memcpy(aim.target.position, places[i], sizeof places[i]);
            wb_rod_element_exponential(turn, aim.target.rotation);
            const struct wb_harness_move move = {
                .n_aims = 1, .aims = &aim, .observer = add_work, .context = &watched};
            assert_int_equal(test_harness_move(&t, &move).n_snaps, 0);
        }
        const double inner =
            wb_harness_elastic_energy(t.harness) + wb_harness_plastic_work(t.harness);
        assert_close_relative(watched.work, inner, 2e-3);
        assert_true(wb_harness_plastic_work(t.harness) > 0.2 * inner);
        test_harness_release(&t);
    }
}

/* An elastic tree forgets what was done to it. */
static void elastic_tree_returns_after_release(void **unused)
{
    (void)unused;
    const struct wb_law_part part = {4500.0 * WB_MPA, (double)INFINITY};
    struct wb_law law;
    wb_law_init_parallel(&law, &part, 1, 0.0, 0.39);
    struct tree tree, hanging;
    make_tree(&tree, &law, &test_origin, false);
    make_tree(&hanging, &law, &test_origin, false);
    const struct wb_harness_move hang = {.weight = 1.0};
    (void)test_harness_move(&hanging.t, &hang);
    assemble(&tree);
    wb_harness_set_hold(tree.t.harness, tree.clip, WB_HARNESS_FREE, NULL);
    wb_harness_set_hold(tree.t.harness, tree.end, WB_HARNESS_FREE, NULL);
    struct wb_harness_result result;
    wb_harness_solver_settle(tree.t.solver, 1.0, NULL, NULL, &result);
    assert_int_equal(result.end, WB_HARNESS_CONVERGED);
    check_balance(&tree);
    for (int j = 0; j < wb_harness_n_joints(tree.t.harness); j++)
        assert_true(wb_vec3_distance(wb_harness_node(tree.t.harness, j)->position,
                                     wb_harness_node(hanging.t.harness, j)->position) < 1e-7);
    release_tree(&tree);
    release_tree(&hanging);
}

/* A plastic tree keeps a shape of its own, which does not depend on the steps of its motion. */
static void plastic_tree_keeps_a_shape_after_release(void **unused)
{
    (void)unused;
    const struct wb_law law = test_laws_get(5);
    struct tree trees[2], hanging;
    make_tree(&hanging, &law, &test_origin, false);
    const struct wb_harness_move hang = {.weight = 1.0};
    (void)test_harness_move(&hanging.t, &hang);
    for (int i = 0; i < 2; i++) {
        struct tree *const tree = &trees[i];
        make_tree(tree, &law, &test_origin, false);
        if (i == 1) {
            const struct wb_harness_solver_model fine = {tree->t.harness, 0.025};
            wb_harness_solver_destroy(tree->t.solver);
            assert_int_equal(wb_harness_solver_create(&tree->t.solver, &fine), WB_OK);
        }
        assemble(tree);
        wb_harness_set_hold(tree->t.harness, tree->clip, WB_HARNESS_FREE, NULL);
        wb_harness_set_hold(tree->t.harness, tree->end, WB_HARNESS_FREE, NULL);
        struct wb_harness_result result;
        wb_harness_solver_settle(tree->t.solver, 1.0, NULL, NULL, &result);
        assert_int_equal(result.end, WB_HARNESS_CONVERGED);
        check_balance(tree);
    }
    double largest = 0.0, apart = 0.0;
    for (int j = 0; j < wb_harness_n_joints(hanging.t.harness); j++) {
        const double *const at = wb_harness_node(trees[0].t.harness, j)->position;
        largest =
            fmax(largest, wb_vec3_distance(at, wb_harness_node(hanging.t.harness, j)->position));
        apart = fmax(apart, wb_vec3_distance(at, wb_harness_node(trees[1].t.harness, j)->position));
    }
    if (getenv("PRINT"))
        printf("residual %g mm, apart %g mm\n", largest * 1e3, apart * 1e3);
    assert_true(largest > 5e-3);
    assert_true(apart < 2e-4);
    for (int i = 0; i < 2; i++)
        release_tree(&trees[i]);
    release_tree(&hanging);
}

/* All that can be read from a harness; the caller frees it. */
struct readings {
    struct wb_rod_node node[200];
    double reaction[200][6];
    struct wb_harness_point points[400];
    double elastic, plastic, weight[6];
};

static struct readings *read_all(const struct tree *tree)
{
    const struct wb_harness *const h = tree->t.harness;
    struct readings *const r = calloc(1, sizeof *r);
    assert_non_null(r);
    assert_true(wb_harness_n_joints(h) <= 200 && wb_harness_n_points(h) <= 400);
    for (int j = 0; j < wb_harness_n_joints(h); j++) {
        r->node[j] = *wb_harness_node(h, j);
        wb_harness_reaction(h, j, r->reaction[j]);
    }
    for (int g = 0; g < wb_harness_n_points(h); g++)
        wb_harness_point(h, g, &r->points[g]);
    r->elastic = wb_harness_elastic_energy(h);
    r->plastic = wb_harness_plastic_work(h);
    wb_harness_weight(h, r->weight);
    return r;
}

static void check_readings(const struct tree *tree, const struct readings *expected)
{
    struct readings *const r = read_all(tree);
    assert_memory_equal(r, expected, sizeof *r);
    free(r);
}

/* A release, then a move with a load and half the weight. */
static void release_and_load(struct tree *tree)
{
    static const double clip[3] = {0.18, 0.0, 0.03}, turn[3] = {0.0, -0.1, 0.2};
    const struct wb_harness_aim aim = {tree->clip, place(tree, clip, turn)};
    const struct wb_harness_load load = {tree->end, {0.0, 0.02, 0.03}};
    struct wb_harness_result result;
    wb_harness_set_hold(tree->t.harness, tree->end, WB_HARNESS_FREE, NULL);
    wb_harness_solver_settle(tree->t.solver, 1.0, NULL, NULL, &result);
    assert_int_equal(result.end, WB_HARNESS_CONVERGED);
    const struct wb_harness_move move = {
        .n_aims = 1, .aims = &aim, .n_loads = 1, .loads = &load, .weight = 0.5};
    (void)test_harness_move(&tree->t, &move);
}

/* The unbalanced force of a state extrapolated by the last step, against a drag that depends on it.
 */
static double extrapolated_residual(const struct tree *tree)
{
    struct wb_harness *const h = tree->t.harness;
    struct wb_harness_balance balance;
    wb_harness_set_drag(h, 10.0, 5.0);
    wb_harness_extrapolate(h, 0.5);
    wb_harness_evaluate(h, 1.0, &balance);
    return balance.largest_residual;
}

static void steps_after_a_restored_state_are_the_same_bit_for_bit(void **unused)
{
    (void)unused;
    for (int l = 0; l < TEST_LAWS; l++) {
        const struct wb_law law = test_laws_get(l);
        struct tree tree, other;
        make_tree(&tree, &law, &test_origin, false);
        make_tree(&other, &law, &test_origin, false);
        void *const state = calloc(1, wb_harness_solver_state_size(tree.t.solver));
        assert_non_null(state);
        assemble(&tree);
        wb_harness_solver_save(tree.t.solver, state);
        struct readings *const before = read_all(&tree);
        const double residual = extrapolated_residual(&tree);
        wb_harness_solver_restore(tree.t.solver, state);
        release_and_load(&tree);
        struct readings *const after = read_all(&tree);
        assert_memory_not_equal(before, after, sizeof *before);

        /* The same harness, and one that was only created. */
        struct tree *const both[] = {&tree, &other};
        for (int i = 0; i < 2; i++) {
            wb_harness_solver_restore(both[i]->t.solver, state);
            check_readings(both[i], before);
            assert_true(extrapolated_residual(both[i]) == residual);
            wb_harness_solver_restore(both[i]->t.solver, state);
            release_and_load(both[i]);
            check_readings(both[i], after);
        }
        free(state);
        free(before);
        free(after);
        release_tree(&tree);
        release_tree(&other);
    }
}

static void arch_curvature(void *context, double s, double curvature[3])
{
    (void)context, (void)s;
    curvature[0] = curvature[2] = 0.0;
    curvature[1] = 4.0;
}

/* A plane arch between clamps that is loaded in its plane cannot leave it, and has no stable
 * equilibrium in it beyond a load. */
static void move_without_an_end_leaves_the_last_equilibrium(void **unused)
{
    (void)unused;
    const double length = 0.3, middle = 0.15;
    const struct wb_law_part part = {4500.0 * WB_MPA, (double)INFINITY};
    struct wb_law law;
    wb_law_init_parallel(&law, &part, 1, 0.0, 0.39);
    struct wb_law_section *const section = section_of(1.4e-3, &law);
    const struct wb_harness_branch branch = {.parent = -1,
                                             .leaving = {1.0, 0.0, 0.0, 0.0},
                                             .section = section,
                                             .length = length,
                                             .natural_curvature = arch_curvature,
                                             .n_stations = 1,
                                             .stations = &middle};
    const struct wb_harness_model model = {
        .n_branches = 1, .branches = &branch, .element_length = 0.015, .root = test_origin};
    struct test_harness t = test_harness_make(&model);
    struct wb_harness *const h = t.harness;
    const int end = wb_harness_joint(h, 0, length);
    wb_harness_set_hold(h, end, WB_HARNESS_AXIS, wb_harness_node(h, end));
    const struct wb_rod_node top = *wb_harness_node(h, wb_harness_joint(h, 0, middle));
    struct wb_harness_load load = {.joint = wb_harness_joint(h, 0, middle)};
    for (int k = 0; k < 3; k++) {
        const double foot = 0.5 * wb_harness_node(h, end)->position[k];
        load.load[k] = 60.0 * (foot - top.position[k]);
    }
    const struct wb_harness_move move = {.n_loads = 1, .loads = &load};
    struct wb_harness_result result;
    wb_harness_solver_move(t.solver, &move, &result);
    assert_int_equal(result.end, WB_HARNESS_NOT_CONVERGED);
    assert_true(result.fraction > 0.0 && result.fraction < 1.0 && result.n_snaps == 0);
    double reactions[2][6];
    wb_harness_reaction(h, 0, reactions[0]);
    wb_harness_reaction(h, end, reactions[1]);
    const double size = result.fraction * wb_vec3_length(load.load);
    for (int k = 0; k < 3; k++)
        assert_close(reactions[0][k] + reactions[1][k], -result.fraction * load.load[k],
                     1e-8 * size);
    struct wb_harness_balance balance;
    wb_harness_evaluate(h, 0.0, &balance);
    assert_true(balance.largest_residual <= 1e-9 * balance.largest_force);
    test_harness_release(&t);
    wb_law_section_destroy(section);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(forces_balance_for_every_law),
        cmocka_unit_test(frame_does_not_matter),
        cmocka_unit_test(branch_may_be_cut_in_two),
        cmocka_unit_test(work_on_the_wire_is_elastic_or_plastic),
        cmocka_unit_test(elastic_tree_returns_after_release),
        cmocka_unit_test(plastic_tree_keeps_a_shape_after_release),
        cmocka_unit_test(move_without_an_end_leaves_the_last_equilibrium),
        cmocka_unit_test(steps_after_a_restored_state_are_the_same_bit_for_bit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
