/* Steps of wb_wires_results_judge(), for tests. */
#ifndef WB_ANALYSIS_REPORT_WIRES_WIRES_RESULTS_PRIVATE_H
#define WB_ANALYSIS_REPORT_WIRES_WIRES_RESULTS_PRIVATE_H

#include "analysis/report/wires/wires_results.h"

/* Distance of a usable run's tip from the exact elastic one, over that one's displacement. */
double wb_wires_tip_error(const struct wb_wires_results *results, const struct wb_wires_run *run);

#endif
