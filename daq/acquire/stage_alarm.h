/* Reason of a stage's alarm, for every kind of controller. */
#ifndef WB_DAQ_ACQUIRE_STAGE_ALARM_H
#define WB_DAQ_ACQUIRE_STAGE_ALARM_H

#include <stddef.h>

#include "daq/protocol/sample.h"

/* Describes the alarm of a stage in state Alarm: "ALARM:1, hard limit: ..." for GRBL, "low VIN:
 * ..." for a Tic. */
void wb_stage_alarm_reason(const struct wb_stage_report *report, char *text, size_t size);

#endif
