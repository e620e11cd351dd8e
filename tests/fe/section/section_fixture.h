/* Bundles of fixtures/bundles for the tests of the section model: a vertical force at the tip, no
 * weight. */
#ifndef WB_TESTS_FE_SECTION_SECTION_FIXTURE_H
#define WB_TESTS_FE_SECTION_SECTION_FIXTURE_H

#include "base/file.h"
#include "fe/section/section_solver.h"
#include "tests/check.h"

static struct wb_bundle_model model;
static struct wb_section_solver *solver;

static inline void read_bundle(const char *name)
{
    char path[WB_PATH];
    assert_int_equal(wb_file_find_fixture(path, "bundles", name, NULL), WB_OK);
    assert_int_equal(wb_bundle_model_read(&model, path), WB_OK);
    model.loads.weight = false;
    model.loads.strand_length = 0.0;
}

static inline void create(const struct wb_section_solver_settings *settings)
{
    assert_int_equal(wb_section_solver_create(&solver, &model, settings), WB_OK);
}

static inline struct wb_section_solver_point move(double deflection)
{
    struct wb_section_solver_point point;
    wb_section_solver_move(solver, deflection, &point);
    assert_int_equal(point.end, WB_SECTION_SOLVER_CONVERGED);
    return point;
}

/* Moves to a deflection in equal steps; returns the last point. */
static inline struct wb_section_solver_point load(double from, double to, int steps)
{
    struct wb_section_solver_point point = {0};
    for (int i = 1; i <= steps; i++)
        point = move(from + (to - from) * i / steps);
    return point;
}

static inline int destroy(void **unused)
{
    (void)unused;
    wb_section_solver_destroy(solver);
    solver = NULL;
    return 0;
}

#define TEST(name) cmocka_unit_test_teardown(name, destroy)

#endif
