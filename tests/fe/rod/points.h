/* A section point of a law, for tests of its history. */
#ifndef WB_TESTS_FE_ROD_POINTS_H
#define WB_TESTS_FE_ROD_POINTS_H

#include "fe/rod/fibres_private.h"
#include "tests/fe/rod/fibre_point.h"
#include "tests/fe/rod/wires.h"

#define DIAMETER 1.25e-3

static inline struct fibre_point make_point(const struct wb_law *law, int n)
{
    struct wb_section section;
    assert_int_equal(wb_section_init_law(&section, DIAMETER, law, n), WB_OK);
    const struct fibre_point p = fibre_point_make(&section);
    wb_section_release(&section);
    return p;
}

/* Moment at a curvature; the history is committed. */
static inline double bend(struct fibre_point *p, double kappa)
{
    const struct wb_fibres_response r = fibre_point_respond(p, 0.0, kappa);
    fibre_point_accept(p);
    return r.M;
}

/* Bends back and forth with the processor's vector instructions and without. */
static inline void assert_same_bits(const struct wb_law *law)
{
    struct fibre_point fastest = make_point(law, 20), portable = make_point(law, 20);
    uint64_t random = 43;
    wb_fibres_set_portable(portable.fibres);
    for (int step = 0; step < 200; step++) {
        const double kappa = 80.0 * (test_random(&random) - 0.5);
        assert_true(bend(&fastest, kappa) == bend(&portable, kappa));
    }
    fibre_point_release(&fastest);
    fibre_point_release(&portable);
}

/* After wb_fibres_set_law() a point bends like a new one with the other law. */
static inline void assert_exchanged(const struct wb_law *law, const struct wb_law *other)
{
    struct fibre_point p = make_point(law, 20), fresh = make_point(other, 20);
    assert_int_equal(wb_fibres_set_law(p.fibres, other), WB_OK);
    (void)bend(&p, 30.0);
    (void)bend(&fresh, 30.0);
    assert_true(bend(&p, 4.0) == bend(&fresh, 4.0));
    fibre_point_release(&p);
    fibre_point_release(&fresh);
}

static inline void assert_not_exchanged(const struct wb_law *law, const struct wb_law *other)
{
    struct fibre_point p = make_point(law, 20);
    wb_log_set_sink(discard_message, NULL);
    assert_int_equal(wb_fibres_set_law(p.fibres, other), WB_ERR_ARGUMENT);
    wb_log_set_sink(NULL, NULL);
    fibre_point_release(&p);
}

#endif
