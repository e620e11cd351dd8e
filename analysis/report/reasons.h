/* Why a step of a report failed: the errors of the calling thread, kept beside being shown, or
 * instead. */
#ifndef WB_ANALYSIS_REPORT_REASONS_H
#define WB_ANALYSIS_REPORT_REASONS_H

#include <stdbool.h>

#include "base/log.h"
#include "base/text.h"

struct wb_reasons {
    struct wb_text *text; /* errors are appended, with "; " between them */
    const char *path;     /* replaced by `name`: no path of this machine may reach the report; */
    const char *name;     /* NULL: nothing is replaced */
    bool quiet;           /* they are not shown one by one, but by wb_reasons_tell() */
    enum wb_log_level before; /* set by wb_reasons_begin() */
};

/* From begin to end, which follow each other in one thread; `reasons` must live as long. */
void wb_reasons_begin(struct wb_reasons *reasons);
void wb_reasons_end(void);

/* Ends quiet reasons and, where there are any, shows them as one warning that begins with the name.
 */
void wb_reasons_tell(const struct wb_reasons *reasons);

#endif
