/* Ready-made harnesses for the tests of fe/harness. */
#ifndef WB_TESTS_FE_HARNESS_HARNESSES_H
#define WB_TESTS_FE_HARNESS_HARNESSES_H

#include <stdlib.h>

#include "fe/harness/harness_solver.h"
#include "tests/fe/rod/laws.h"
#include "tests/fe/rod/wires.h"

static const struct wb_rod_node test_origin = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}};

struct test_harness {
    struct wb_law_section *section;
    struct wb_harness *harness;
    struct wb_harness_solver *solver;
};

/* An elastic section with a given EI and GJ (N m2), so thin that it hardly stretches or shears. */
static inline struct wb_law_section *test_elastic_section(double EI, double GJ)
{
    const double diameter = 4e-4;
    const double E = EI / (M_PI * pow(diameter, 4.0) / 64.0);
    const struct wb_law_part part = {E, (double)INFINITY};
    struct wb_law law;
    wb_law_init_parallel(&law, &part, 1, 0.0, 0.3);
    struct wb_law_section *section;
    const struct wb_law_section_model model = {
        .diameter = diameter, .law = &law, .torsional_stiffness = GJ, .fibres = {2, 8}};
    assert_int_equal(wb_law_section_create(&section, &model), WB_OK);
    return section;
}

static inline struct test_harness test_harness_make(const struct wb_harness_model *model)
{
    struct test_harness t = {0};
    assert_int_equal(wb_harness_create(&t.harness, model), WB_OK);
    const struct wb_harness_solver_model solver = {.harness = t.harness};
    assert_int_equal(wb_harness_solver_create(&t.solver, &solver), WB_OK);
    return t;
}

/* One branch of length 1 m without weight. */
static inline struct test_harness test_single_branch(struct wb_law_section *section, int n_elements)
{
    const struct wb_harness_branch branch = {
        .parent = -1, .leaving = {1.0, 0.0, 0.0, 0.0}, .section = section, .length = 1.0};
    const struct wb_harness_model model = {.n_branches = 1,
                                           .branches = &branch,
                                           .element_length = 1.0 / n_elements,
                                           .root = test_origin};
    struct test_harness t = test_harness_make(&model);
    t.section = section;
    return t;
}

static inline void test_harness_release(struct test_harness *t)
{
    wb_harness_solver_destroy(t->solver);
    wb_harness_destroy(t->harness);
    wb_law_section_destroy(t->section);
}

/* Moves; fails if it does not converge. */
static inline struct wb_harness_result test_harness_move(struct test_harness *t,
                                                         const struct wb_harness_move *move)
{
    struct wb_harness_result result;
    wb_harness_solver_move(t->solver, move, &result);
    if (result.end != WB_HARNESS_CONVERGED)
        fail_msg("at %g: %s", result.fraction, result.problem ? result.problem : "stopped");
    return result;
}

/* Moves one held joint. */
static inline struct wb_harness_result test_harness_aim(struct test_harness *t, int joint,
                                                        const struct wb_rod_node *target)
{
    const struct wb_harness_aim aim = {joint, *target};
    const struct wb_harness_move move = {.n_aims = 1, .aims = &aim};
    return test_harness_move(t, &move);
}

#endif
