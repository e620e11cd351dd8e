/* Text picture of the seen markers and of the markers of the specimen file, for a terminal. */
#ifndef WB_DAQ_DOCTOR_MARKER_PICTURE_H
#define WB_DAQ_DOCTOR_MARKER_PICTURE_H

#include <stddef.h>

#include "daq/protocol/sample.h"
#include "daq/protocol/specimen.h"

/* Draws a frame from the side, perpendicular to the wire, with `up` ('y' or 'z') upwards. Measured
 * markers of the specimen are shown as digits and letters in the order of the file, others as '*'.
 * Below, at the same scale, the specimen's markers at their arc lengths, with a '?' below each
 * marker that is not seen. `specimen` may be NULL. Lines of at most 80 columns, each with a line
 * end; "" without measured markers and specimen. */
void wb_marker_picture(const struct wb_mocap_frame *frame, const struct wb_specimen *specimen,
                       char up, char *text, size_t size);

#endif
