/* The last lines of a command: what was found, whether to trust it, the figure that was written,
 * and the next command.
 */
#ifndef WB_CLI_FINDING_H
#define WB_CLI_FINDING_H

#include "analysis/calibration/properties/quantity.h"
#include "base/file.h"
#include "base/status.h"
#include "base/text.h"

struct wb_finding {
    struct wb_text found, trust, next; /* one sentence each; without text: left out */
    const char *figure;                /* path, also of a page; NULL: none was written */
};

/* Prints the lines on stdout, wrapped at words to the width of a terminal, and releases the texts.
 */
void wb_finding_print(struct wb_finding *finding);

/* "M at 28.1 1/m 9.36 N mm (8.18 to 10.7)": a quantity of properties with its interval, or the
 * range over laws where no value is known. `k` is the index of its curvature. */
void wb_finding_append_quantity(struct wb_text *text, const struct wb_properties *properties,
                                enum wb_quantity_id id, int k);

/* Where tests come from: "measured", "virtual rig" or "simulation". */
const char *wb_finding_source(const struct wb_test_info *info);

/* The figure's path beside an output file: its name with the ending .svg. */
const char *wb_finding_figure_path(char path[WB_PATH], const char *output);

#endif
