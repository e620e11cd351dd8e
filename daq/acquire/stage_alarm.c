#include "daq/acquire/stage_alarm.h"

#include <stdio.h>

#include "daq/protocol/grbl.h"
#include "daq/protocol/tic.h"

void wb_stage_alarm_reason(const struct wb_stage_report *report, char *text, size_t size)
{
    if (report->alarm >= WB_TIC_ALARM)
        snprintf(text, size, "%s", wb_tic_alarm_text(report->alarm));
    else
        wb_grbl_alarm_reason(report, text, size);
}
