/* What the cameras see beside what the specimen file says, as text for a terminal. */
#ifndef WB_DAQ_DOCTOR_MARKER_PICTURE_H
#define WB_DAQ_DOCTOR_MARKER_PICTURE_H

#include <stddef.h>

#include "daq/protocol/sample.h"
#include "daq/protocol/specimen.h"

/* Draws a frame from the side, seen at right angles to the wire: up is `up` ('y' or 'z'), the
 * measured markers that are the specimen's as the digits and letters of their order in the file,
 * others as '*'; below, at the same scale, the specimen's markers at their arc lengths, a '?' below
 * each that is not seen. `specimen` may be NULL. Lines of at most 80 columns, each with its line
 * end; "" for a frame without measured markers and no specimen. */
void wb_marker_picture(const struct wb_mocap_frame *frame, const struct wb_specimen *specimen,
                       char up, char *text, size_t size);

#endif
