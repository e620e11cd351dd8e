/* Shared by properties.c and by reading and writing. */
#ifndef WB_ANALYSIS_CALIBRATION_PROPERTIES_PROPERTIES_PRIVATE_H
#define WB_ANALYSIS_CALIBRATION_PROPERTIES_PROPERTIES_PRIVATE_H

#include "analysis/calibration/properties/properties.h"

extern const struct wb_estimate wb_properties_unknown_estimate;

/* Sets all members that a source of properties may lack to unknown. */
void wb_properties_make_unknown(struct wb_properties *properties);
/* Finds the scatter of the specimens from the interval of a moment well within the data: that of EI
 * contains more of the fits' noise. */
void wb_properties_find_deviation(struct wb_properties *properties);

#endif
