/* Of the machine's reader, for its tests. */
#ifndef WB_ANALYSIS_DATASET_MACHINE_PRIVATE_H
#define WB_ANALYSIS_DATASET_MACHINE_PRIVATE_H

#include "analysis/dataset/machine.h"

/* As wb_machine_read(), from text; `origin` stands for the file in errors. */
WB_MUST_CHECK enum wb_status wb_machine_parse(const char *text, const char *origin,
                                              struct wb_machine *machine, struct wb_reason *why);

#endif
