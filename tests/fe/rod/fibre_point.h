/* One section point with its history, for tests of fibres. */
#ifndef WB_TESTS_FE_ROD_FIBRE_POINT_H
#define WB_TESTS_FE_ROD_FIBRE_POINT_H

#include <stdlib.h>

#include "fe/rod/fibres.h"
#include "tests/check.h"

struct fibre_point {
    struct wb_fibres *fibres;
    double *before, *after;
};

static inline struct fibre_point fibre_point_make(const struct wb_section *section)
{
    struct fibre_point p = {0};
    assert_int_equal(wb_fibres_create(&p.fibres, section), WB_OK);
    const size_t size = wb_fibres_history_size(p.fibres);
    p.before = calloc(size, sizeof *p.before);
    p.after = calloc(size, sizeof *p.after);
    assert_true(p.before && p.after);
    return p;
}

static inline void fibre_point_release(struct fibre_point *p)
{
    wb_fibres_destroy(p->fibres);
    free(p->before);
    free(p->after);
}

static inline struct wb_fibres_response fibre_point_respond(struct fibre_point *p, double eps,
                                                            double kappa)
{
    struct wb_fibres_response r;
    wb_fibres_respond(p->fibres, eps, kappa, p->before, p->after, &r);
    return r;
}

static inline void fibre_point_accept(struct fibre_point *p)
{
    double *old = p->before;
    p->before = p->after;
    p->after = old;
}

#endif
