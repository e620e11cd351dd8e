/* The last lines of a command: the result, whether it can be trusted, the figure that was written,
 * and the next command.
 */
#ifndef WB_CLI_FINDING_H
#define WB_CLI_FINDING_H

#include <stdbool.h>
#include <stdio.h>

#include "analysis/calibration/properties/quantity.h"
#include "base/file.h"
#include "base/status.h"
#include "base/text.h"

struct wb_finding {
    struct wb_text found, trust, next; /* one sentence each; without text: left out */
    const char *figure;                /* path of a figure or page; NULL or "": none was written */
};

/* Prints the lines on stdout, wrapped at words to the width of a terminal, and releases the texts.
 */
void wb_finding_print(struct wb_finding *finding);
void wb_finding_write(FILE *out, struct wb_finding *finding); /* the same, on another stream */

/* "M at 28.1 /m 9.36 N mm (8.18 to 10.7)": a quantity of properties with its interval, or the
 * range over laws where no value is known. `k` is the index of its curvature. */
void wb_finding_append_quantity(struct wb_text *text, const struct wb_properties *properties,
                                enum wb_quantity_id id, int k);

/* The origin of tests, or of the tests of a calibration: "measured", "virtual rig" or "simulation".
 */
const char *wb_finding_source(const struct wb_test_info *info);

const char *wb_finding_properties_source(const struct wb_properties *properties);

/* Appends a command line: `format` with a word, quoted for the shell, in place of each "%s". */
void wb_finding_append_command(struct wb_text *text, const char *format, ...);

/* Appends the next command after a calibration: `wirebench validate OUTPUT DATASET...` with tests
 * of another length or span (`another`), or, where no properties were written (NULL), how to keep
 * them.
 */
void wb_finding_append_validate(struct wb_text *text, const char *output, const char *wire,
                                const char *another);

/* The path of a figure beside an output: of a file its name with the ending .svg in place of its
 * own, of a folder with .svg appended. */
const char *wb_finding_figure_path(char path[WB_PATH], const char *output);
const char *wb_finding_folder_figure_path(char path[WB_PATH], const char *folder);

/* Fails with WB_ERR_EXISTS where the figure's file exists and may not be replaced. */
WB_MUST_CHECK enum wb_status wb_finding_check_figure(const char *path, bool force);

#endif
