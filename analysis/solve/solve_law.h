/* What solvers make of a wire's law. The 1D beam takes it as it is; those of wires and bundles know
 * Ludwik's with isotropic hardening alone, and compute with the four numbers beside it. */
#ifndef WB_ANALYSIS_SOLVE_SOLVE_LAW_H
#define WB_ANALYSIS_SOLVE_SOLVE_LAW_H

#include "base/status.h"
#include "fe/model/wire.h"
#include "fe/rod/section.h"

/* Reads a wire by its name or file, and makes the law that the beam computes with: the wire's own,
 * or with `is_elastic` its elastic part; and its section over the outer diameter, which the caller
 * releases. WB_ERR_DATA where the wire has no properties. Failures are logged. */
WB_MUST_CHECK enum wb_status wb_solve_law_prepare(const char *name, bool is_elastic,
                                                  struct wb_wire *wire, struct wb_law *law,
                                                  struct wb_section *section);

/* Logs that the four numbers are an equivalent, and how near; nothing where they are the law. */
WB_MUST_CHECK enum wb_status wb_solve_law_tell(const struct wb_wire *wire);

#endif
