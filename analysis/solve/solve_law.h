/* The law that a solver uses for a wire. The 1D beam supports all laws; the solvers of wires and
 * bundles support only Ludwik's law with isotropic hardening, and use the four numbers that
 * accompany the law. */
#ifndef WB_ANALYSIS_SOLVE_SOLVE_LAW_H
#define WB_ANALYSIS_SOLVE_SOLVE_LAW_H

#include "base/status.h"
#include "fe/model/wire.h"
#include "fe/rod/section.h"

/* Reads a wire by its name or file, and makes the law for the beam: the wire's own, or with
 * `is_elastic` its elastic part; and its section over the outer diameter, which the caller
 * releases. WB_ERR_DATA if the wire has no properties. Failures are logged. */
WB_MUST_CHECK enum wb_status wb_solve_law_prepare(const char *name, bool is_elastic,
                                                  struct wb_wire *wire, struct wb_law *law,
                                                  struct wb_section *section);

/* Logs that the four numbers are an equivalent of the law, and its deviation; nothing if they are
 * the law itself. */
WB_MUST_CHECK enum wb_status wb_solve_law_report(const struct wb_wire *wire);

#endif
