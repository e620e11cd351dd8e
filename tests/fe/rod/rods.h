/* Ready-made rods for the tests of fe. */
#ifndef WB_TESTS_FE_ROD_RODS_H
#define WB_TESTS_FE_ROD_RODS_H

#include "fe/rod/rod_solver.h"
#include "tests/fe/rod/wires.h"

struct test_rod {
    struct wb_rod_section *section;
    struct wb_rod *rod;
    struct wb_rod_solver *solver;
};

struct test_rod_plan {
    double diameter, length;
    struct wb_material material;
    int n_elements; /* 0: 50 */
    int n_rings, n_around;
    double load[3], strand_length;
    void (*natural_curvature)(void *context, double arc_length, double curvature[3]);
    void *curvature_context;
    double most_rotation; /* of an increment */
};

static inline struct test_rod test_rod_make(const struct test_rod_plan *plan)
{
    struct test_rod t;
    const struct wb_rod_section_part part = {0.0, plan->diameter, plan->material};
    const struct wb_rod_section_layout layout = {plan->n_rings, plan->n_around};
    assert_int_equal(wb_rod_section_create(&t.section, 1, &part, &layout), WB_OK);

    const struct wb_rod_model model = {
        .section = t.section,
        .length = plan->length,
        .n_elements = plan->n_elements == 0 ? 50 : plan->n_elements,
        .natural_curvature = plan->natural_curvature,
        .curvature_context = plan->curvature_context,
        .load = {plan->load[0], plan->load[1], plan->load[2]},
    };
    assert_int_equal(wb_rod_create(&t.rod, &model), WB_OK);

    const struct wb_rod_solver_model solver = {
        .rod = t.rod,
        .length = plan->length,
        .strand_length = plan->strand_length,
        .strand_x = plan->length,
        .most_rotation = plan->most_rotation,
    };
    assert_int_equal(wb_rod_solver_create(&t.solver, &solver), WB_OK);
    return t;
}

static inline void test_rod_release(struct test_rod *t)
{
    wb_rod_solver_destroy(t->solver);
    wb_rod_destroy(t->rod);
    wb_rod_section_destroy(t->section);
}

/* Moves the loads to `tip` under full weight; fails if it does not converge. */
static inline struct wb_rod_result test_rod_load(struct test_rod *t, const struct wb_tip_loads *tip)
{
    struct wb_rod_result result;
    const struct wb_rod_move move = {.control = WB_ROD_LOADS,
                                     .target = {.weight = 1.0, .tip = *tip}};
    assert_int_equal(wb_rod_solver_move(t->solver, &move, &result), WB_OK);
    assert_int_equal(result.end, WB_ROD_CONVERGED);
    return result;
}

/* Moves the tip's y; fails if it does not converge. */
static inline struct wb_rod_result test_rod_raise(struct test_rod *t, double deflection)
{
    struct wb_rod_result result;
    const struct wb_rod_move move = {
        .control = WB_ROD_DEFLECTION, .target = {.weight = 1.0}, .deflection = deflection};
    assert_int_equal(wb_rod_solver_move(t->solver, &move, &result), WB_OK);
    assert_int_equal(result.end, WB_ROD_CONVERGED);
    return result;
}

/* Unit vector along the tip's axis 0, 1 or 2. */
static inline void test_rod_axis(const struct wb_rod_node *node, int axis, double vector[3])
{
    double R[9];
    wb_rod_element_matrix(node->rotation, R);
    for (int i = 0; i < 3; i++)
        vector[i] = R[3 * i + axis];
}

static inline double test_rod_distance(const double *a, const double *b)
{
    return sqrt(pow(a[0] - b[0], 2.0) + pow(a[1] - b[1], 2.0) + pow(a[2] - b[2], 2.0));
}

#endif
