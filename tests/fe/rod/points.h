/* A section point of a law, for tests of its history. */
#ifndef WB_TESTS_FE_ROD_POINTS_H
#define WB_TESTS_FE_ROD_POINTS_H

#include <stdlib.h>

#include "fe/rod/fibres.h"
#include "fe/rod/fibres_private.h"
#include "tests/check.h"

#define DIAMETER 1.25e-3

/* One section point with its history. */
struct point {
    struct wb_section section;
    struct wb_fibres *fibres;
    double *before, *after;
};

static inline struct point make_point(const struct wb_law *law, int n)
{
    struct point p = {.before = NULL};
    assert_int_equal(wb_section_init_law(&p.section, DIAMETER, law, n), WB_OK);
    assert_int_equal(wb_fibres_create(&p.fibres, &p.section), WB_OK);
    const size_t size = wb_fibres_history_size(p.fibres);
    p.before = calloc(size, sizeof *p.before);
    p.after = calloc(size, sizeof *p.after);
    assert_true(p.before && p.after);
    return p;
}

static inline void release_point(struct point *p)
{
    wb_fibres_destroy(p->fibres);
    wb_section_release(&p->section);
    free(p->before);
    free(p->after);
}

static inline struct wb_fibres_response respond(struct point *p, double eps, double kappa)
{
    struct wb_fibres_response r;
    wb_fibres_respond(p->fibres, eps, kappa, p->before, p->after, &r);
    return r;
}

static inline double bend(struct point *p, double kappa)
{
    const struct wb_fibres_response r = respond(p, 0.0, kappa);
    double *const old = p->before;
    p->before = p->after;
    p->after = old;
    return r.M;
}

#endif
