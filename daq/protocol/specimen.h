/* A specimen: one piece of a wire, as its YAML file describes it.
 *
 *     wire: type1                  # name in fixtures/wires, or a path
 *     length_mm: 85
 *     u_length_mm: 0.2             # optional, standard uncertainty
 *     sample: 1
 *     markers_mm: [0, 14.2, 28.3, 42.5, 56.7, 70.8, 85]   # arc length of each; the first on the
 *                                                         # clamp, the last at the strand's knot
 *     marker_offset_mm: 1.0        # from the wire's axis, along its local normal
 *     marker_offset_uncertainty_mm: 0.1   # optional
 */
#ifndef WB_DAQ_PROTOCOL_SPECIMEN_H
#define WB_DAQ_PROTOCOL_SPECIMEN_H

#include "base/file.h"
#include "base/reason.h"

#define WB_SPECIMEN_MAX_MARKERS 32

struct wb_specimen {
    char wire[160];
    int wire_line;             /* of the key `wire` in its file, for messages */
    double length;             /* m */
    double length_uncertainty; /* m, standard; 0: not stated */
    int sample;
    int n_markers;                           /* 2..WB_SPECIMEN_MAX_MARKERS */
    double markers[WB_SPECIMEN_MAX_MARKERS]; /* m, ascending, first 0, last = length */
    double marker_offset;                    /* m */
    double marker_offset_uncertainty;        /* m */
};

/* Reads a specimen file, or the same from text (a recording's meta), where `origin` stands for the
 * file in errors. Errors name file, line and key. */
WB_MUST_CHECK enum wb_status wb_specimen_read(const char *path, struct wb_specimen *specimen);
/* From text (a recording's meta); `origin` stands for the file in errors, which go to `why`; NULL:
 * to the log. */
WB_MUST_CHECK enum wb_status wb_specimen_parse(const char *text, const char *origin,
                                               struct wb_specimen *specimen, struct wb_reason *why);

/* The file of its wire: `wire` of the specimen file at `specimen_path`, a path beside that file or
 * a name in fixtures/wires. WB_ERR_NOT_FOUND names the line. */
WB_MUST_CHECK enum wb_status wb_specimen_find_wire(const struct wb_specimen *specimen,
                                                   const char *specimen_path, char path[WB_PATH]);

#endif
