/* The certificate of a load cell's calibration: a PDF of the cell, the masses, the readings, the
 * quantities of daq/protocol/cell_calibration.h with their uncertainties and the verdict, and a
 * figure of the deviations on the way up and down. */
#ifndef WB_ANALYSIS_REPORT_CERTIFICATE_H
#define WB_ANALYSIS_REPORT_CERTIFICATE_H

#include "base/status.h"
#include "daq/protocol/cell_calibration.h"
#include "daq/protocol/rig.h"

struct wb_certificate {
    const struct wb_rig *rig;
    const char *utc;  /* ISO 8601, when it was measured */
    double tolerance; /* fraction of the span */
    double seconds;   /* each mass was read so long, s */
    int n;
    const struct wb_cell_point *points; /* (n) */
    const struct wb_cell_calibration *calibration;
};

/* Writes the file, whole or not at all. WB_ERR_EXISTS when it is there, unless `force`. */
WB_MUST_CHECK enum wb_status wb_certificate_write(const struct wb_certificate *certificate,
                                                  const char *path, bool force);

#endif
