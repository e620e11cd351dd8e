/* Beams whose sections answer by the slow twin: to be included by one file of a program that is
 * linked with -Wl,--wrap=wb_fibres_respond. While `slow_section` is not NULL, it answers for all
 * sections; all answers are counted. Its histories stand in the rows that a beam keeps for its
 * fibres; virgin ones are zero in both ways.
 */
#ifndef WB_TESTS_TWIN_FIBRES_SWAP_H
#define WB_TESTS_TWIN_FIBRES_SWAP_H

#include "tests/twin/fibres_twin.h"

/* Fibres have three doubles each in a row, too. */
_Static_assert(sizeof(struct wb_material_state) == 3 * sizeof(double), "histories fit");

static const struct wb_section *slow_section;
static long section_updates;

void __real_wb_fibres_respond(const struct wb_fibres *fibres, double eps, double kappa,
                              const double *restrict before, double *restrict after,
                              struct wb_fibres_response *restrict response);
void __wrap_wb_fibres_respond(const struct wb_fibres *fibres, double eps, double kappa,
                              const double *restrict before, double *restrict after,
                              struct wb_fibres_response *restrict response);

void __wrap_wb_fibres_respond(const struct wb_fibres *fibres, double eps, double kappa,
                              const double *restrict before, double *restrict after,
                              struct wb_fibres_response *restrict response)
{
    section_updates++;
    if (slow_section)
        wb_fibres_twin_respond(slow_section, eps, kappa, (const struct wb_material_state *)before,
                               (struct wb_material_state *)after, response);
    else
        __real_wb_fibres_respond(fibres, eps, kappa, before, after, response);
}

#endif
