/* All kinds of report: the only file that sees them all. A new kind is one row. */
#ifndef WB_ANALYSIS_REPORT_KINDS_KINDS_H
#define WB_ANALYSIS_REPORT_KINDS_KINDS_H

#include "analysis/report/kind.h"

enum {
    WB_KINDS = 6
};

/* The first is that of a campaign file without `kind`. */
extern const struct wb_kind *const wb_kinds[WB_KINDS];

#endif
