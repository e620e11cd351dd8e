/* The paper's wires and ready-made cantilevers for the tests of fe. */
#ifndef WB_TESTS_FE_ROD_WIRES_H
#define WB_TESTS_FE_ROD_WIRES_H

#include "base/units.h"
#include "fe/trial/cantilever.h"
#include "tests/check.h"

struct test_wire {
    struct wb_material material;
    double diameter, density;
};

/* Types 1 to 3, Tables 2 and 3 of the paper. */
static inline struct test_wire test_wire_type(int type)
{
    static const struct test_wire wires[] = {
        {{WB_HARDENING_ISOTROPIC_POWER, 5021e6, 0.39, 3.90e6, 3222e6, 0.99}, 1.10e-3, 4060.0},
        {{WB_HARDENING_ISOTROPIC_POWER, 5641e6, 0.39, 4.95e6, 850e6, 0.78}, 1.25e-3, 4310.0},
        {{WB_HARDENING_ISOTROPIC_POWER, 4528e6, 0.39, 4.52e6, 1327e6, 0.90}, 1.40e-3, 4970.0},
    };
    return wires[type - 1];
}

static inline double test_wire_mass(const struct test_wire *wire)
{
    return wire->density * M_PI * wire->diameter * wire->diameter / 4.0;
}

static inline struct wb_section test_section(const struct test_wire *wire)
{
    struct wb_section section;
    assert_int_equal(wb_section_init_circle(&section, wire->diameter, &wire->material, 0), WB_OK);
    return section;
}

/* A core with kinematic and isotropic hardening in parallel, in a jacket. */
static inline struct wb_section test_composite_section(void)
{
    const struct wb_material kinematic = {
        WB_HARDENING_KINEMATIC_LINEAR, 12000e6, 0.35, 9e6, 700e6, 0.0};
    const struct wb_material isotropic = {
        WB_HARDENING_ISOTROPIC_POWER, 9000e6, 0.35, 5e6, 1500e6, 0.6};
    const struct wb_material jacket = {WB_HARDENING_NONE_ELASTIC, 30e6, 0.45, 0.0, 0.0, 0.0};
    struct wb_section s;
    wb_section_init_empty(&s);
    assert_int_equal(wb_section_add_ring(&s, 0.0, 0.7e-3, &kinematic, 0.5, 20), WB_OK);
    assert_int_equal(wb_section_add_ring(&s, 0.0, 0.7e-3, &isotropic, 0.5, 20), WB_OK);
    assert_int_equal(wb_section_add_ring(&s, 0.7e-3, 1.1e-3, &jacket, 1.0, 12), WB_OK);
    return s;
}

static inline struct wb_cantilever *test_cantilever(const struct wb_cantilever_model *model)
{
    struct wb_cantilever *cantilever = NULL;
    assert_int_equal(wb_cantilever_create(&cantilever, model, NULL), WB_OK);
    return cantilever;
}

/* Moves; fails if it does not converge. */
static inline struct wb_cantilever_point
test_move(struct wb_cantilever *cantilever, enum wb_cantilever_control control, double target)
{
    struct wb_cantilever_point point;
    assert_int_equal(wb_cantilever_move(cantilever, control, target, &point), WB_OK);
    assert_int_equal(point.end, WB_CANTILEVER_CONVERGED);
    return point;
}

/* Deterministic numbers in [0, 1) (xorshift). */
static inline double test_random(uint64_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return (double)(*state >> 11) / 9007199254740992.0;
}

#endif
