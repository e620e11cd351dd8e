/* A harness of one branch against the planar cantilever with converged fibres, for every law, and
 * turned in space. */
#include "fe/trial/cantilever.h"
#include "tests/fe/harness/harnesses.h"

#define LENGTH 0.1
#define BENT 1.4e-3
#define MASS 0.0076 /* kg/m */

enum {
    TURNS = 3,
    STEPS = 6,  /* of each phase */
    STRIPS = 80 /* of the cantilever; its 20 are 0.1 % off */
};

/* Deflection up, back, past zero and up again, m. */
static const double path[] = {0.0, 60e-3, 0.0, -20e-3, 60e-3, 0.0};

struct pair {
    struct wb_section plane;
    struct wb_cantilever *cantilever;
    struct test_harness t;
    double up[3]; /* y of the cantilever, in space */
    struct wb_rod_node root;
};

static void make(struct pair *pair, const struct wb_law *law, const double turn[3])
{
    struct wb_cantilever_model model;
    assert_int_equal(wb_section_init_law(&pair->plane, BENT, law, STRIPS), WB_OK);
    wb_cantilever_default_model(&model);
    model.section = &pair->plane;
    model.length = LENGTH;
    model.mass_per_length = MASS;
    pair->cantilever = test_cantilever(&model);

    double R[9];
    pair->root = test_origin;
    wb_rod_element_exponential(turn, pair->root.rotation);
    wb_rod_element_matrix(pair->root.rotation, R);
    for (int k = 0; k < 3; k++)
        pair->up[k] = R[3 * k + 1];
    struct wb_law_section *section;
    const struct wb_law_section_model section_model = {.diameter = BENT, .law = law};
    assert_int_equal(wb_law_section_create(&section, &section_model), WB_OK);
    const struct wb_harness_branch branch = {.parent = -1,
                                             .leaving = {1.0, 0.0, 0.0, 0.0},
                                             .section = section,
                                             .length = LENGTH,
                                             .mass = MASS};
    struct wb_harness_model harness = {
        .n_branches = 1, .branches = &branch, .element_length = LENGTH / 50.0, .root = pair->root};
    for (int k = 0; k < 3; k++)
        harness.gravity[k] = -9.80665 * pair->up[k];
    pair->t = test_harness_make(&harness);
    pair->t.section = section;
}

static void release(struct pair *pair)
{
    wb_cantilever_destroy(pair->cantilever);
    wb_section_release(&pair->plane);
    test_harness_release(&pair->t);
}

/* A rotation whose first axis is the second of `rotation`: the plane hold of a deflection. */
static void aim_along_y(const double rotation[4], double plane[4])
{
    const double quarter[3] = {0.0, 0.0, 0.5 * M_PI};
    double q[4];
    wb_rod_element_exponential(quarter, q);
    wb_rod_element_compose(rotation, q, plane);
}

static double harness_force(struct pair *pair, double deflection)
{
    const int tip = wb_harness_joint(pair->t.harness, 0, LENGTH);
    struct wb_harness_aim aim = {.joint = tip};
    for (int k = 0; k < 3; k++)
        aim.target.position[k] = deflection * pair->up[k];
    aim_along_y(pair->root.rotation, aim.target.rotation);
    const struct wb_harness_move move = {.n_aims = 1, .aims = &aim, .weight = 1.0};
    (void)test_harness_move(&pair->t, &move);
    double reaction[6];
    wb_harness_reaction(pair->t.harness, tip, reaction);
    return reaction[0] * pair->up[0] + reaction[1] * pair->up[1] + reaction[2] * pair->up[2];
}

static void compare(const struct wb_law *law, const double turn[3])
{
    struct pair pair;
    make(&pair, law, turn);
    double largest = 0.0, worst = 0.0;
    const struct wb_harness_move hang = {.weight = 1.0};
    (void)test_harness_move(&pair.t, &hang);
    const int tip = wb_harness_joint(pair.t.harness, 0, LENGTH);
    struct wb_rod_node now = *wb_harness_node(pair.t.harness, tip);
    aim_along_y(pair.root.rotation, now.rotation);
    wb_harness_set_hold(pair.t.harness, tip, WB_HARNESS_PLANE, &now);
    for (size_t phase = 1; phase < sizeof path / sizeof path[0]; phase++) {
        for (int i = 1; i <= STEPS; i++) {
            const double y = path[phase - 1] + (path[phase] - path[phase - 1]) * i / STEPS;
            const double exact =
                test_move(pair.cantilever, WB_CONTROL_DEFLECTION, y).vertical_force;
            const double force = harness_force(&pair, y);
            largest = fmax(largest, fabs(exact));
            worst = fmax(worst, fabs(force - exact));
        }
    }
    assert_true(worst <= 2e-4 * largest);
    release(&pair);
}

static void equals_the_planar_cantilever(void **unused)
{
    (void)unused;
    const double turns[][3] = {{0.0, 0.0, 0.0}, {17.0 * M_PI / 180.0, 0.0, 0.0}, {0.5, -1.2, 0.8}};
    for (int l = 0; l < TEST_LAWS; l++) {
        const struct wb_law law = test_laws_get(l);
        for (int i = 0; i < TURNS; i++)
            compare(&law, turns[i]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(equals_the_planar_cantilever)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
