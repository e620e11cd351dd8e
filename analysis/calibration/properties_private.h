/* What tests of analysis/properties.h ask beside it. */
#ifndef WB_ANALYSIS_PROPERTIES_PRIVATE_H
#define WB_ANALYSIS_PROPERTIES_PRIVATE_H

#include "analysis/calibration/properties.h"

/* The properties that wb_properties_write_cycle() writes, without a file in between. */
void wb_properties_from_cycle(const struct wb_cycle_calibration *calibration,
                              struct wb_properties *properties);

#endif
