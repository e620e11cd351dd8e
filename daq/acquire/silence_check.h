/* Finds the likely cause and the remedy if an instrument gives no samples: no data, data that
 * cannot be decoded, or replies without frames. */
#ifndef WB_DAQ_ACQUIRE_SILENCE_CHECK_H
#define WB_DAQ_ACQUIRE_SILENCE_CHECK_H

#include <stdbool.h>

#include "daq/acquire/acquisition.h"

#define WB_SILENCE_TEXT 800

/* True if the instrument of this role has sent what a test needs (a reading, a frame, a status).
 * Otherwise `text` receives cause and remedy; `waited` is the time waited so far, s. */
bool wb_silence_check(enum wb_role role, const struct wb_acquisition_latest *latest,
                      const struct wb_rig *rig, double waited, char text[WB_SILENCE_TEXT]);

#endif
