/* What an instrument that is not heard may lack, and how to mend it: nothing came, or nothing that
 * can be understood, or answers without frames. */
#ifndef WB_DAQ_ACQUIRE_SILENCE_CHECK_H
#define WB_DAQ_ACQUIRE_SILENCE_CHECK_H

#include <stdbool.h>

#include "daq/acquire/acquisition.h"

#define WB_SILENCE_TEXT 800

/* Whether the instrument of this role gave what a test needs: a reading, a status, a frame. Else
 * writes the reason; `waited` is how long it was listened to, s. */
bool wb_silence_check(enum wb_role role, const struct wb_acquisition_latest *latest,
                      const struct wb_rig *rig, double waited, char text[WB_SILENCE_TEXT]);

#endif
