/* Between the values of properties, and their reading and writing. */
#ifndef WB_ANALYSIS_CALIBRATION_PROPERTIES_PROPERTIES_PRIVATE_H
#define WB_ANALYSIS_CALIBRATION_PROPERTIES_PROPERTIES_PRIVATE_H

#include "analysis/calibration/properties/properties.h"

enum wb_properties_method {
    WB_PROPERTIES_METHOD_CYCLE,
    WB_PROPERTIES_METHOD_PAPER,
    WB_PROPERTIES_METHOD_THREE_POINT
};
/* As the key `method` has them; NULL ends them. */
extern const char *const wb_properties_methods[];

extern const struct wb_estimate wb_properties_unknown_estimate;

/* All that no source of properties needs to know. */
void wb_properties_make_unknown(struct wb_properties *properties);
/* How far specimens differ, from the interval of a moment well within the data: EI carries more of
 * the fits' own noise. */
void wb_properties_find_deviation(struct wb_properties *properties);

#endif
