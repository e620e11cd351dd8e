/* Why a stage is in alarm, whatever its controller is. */
#ifndef WB_DAQ_ACQUIRE_STAGE_ALARM_H
#define WB_DAQ_ACQUIRE_STAGE_ALARM_H

#include <stddef.h>

#include "daq/protocol/sample.h"

/* Of a stage in state Alarm, a few words: "ALARM:1, hard limit: ..." of GRBL, "low VIN: ..." of a
 * Tic. */
void wb_stage_alarm_reason(const struct wb_stage_report *report, char *text, size_t size);

#endif
