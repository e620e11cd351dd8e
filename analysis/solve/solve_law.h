/* What solvers of wires and bundles make of a wire's law: they know Ludwik's with isotropic
 * hardening alone, and compute with the four numbers beside it. */
#ifndef WB_ANALYSIS_SOLVE_SOLVE_LAW_H
#define WB_ANALYSIS_SOLVE_SOLVE_LAW_H

#include "base/status.h"
#include "fe/model/wire.h"

/* Logs that the four numbers are an equivalent, and how near; nothing where they are the law. */
WB_MUST_CHECK enum wb_status wb_solve_law_tell(const struct wb_wire *wire);

#endif
