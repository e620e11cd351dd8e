/* What only tests ask of daq/grbl.h. */
#ifndef WB_DAQ_GRBL_PRIVATE_H
#define WB_DAQ_GRBL_PRIVATE_H

#include "daq/grbl.h"

bool wb_grbl_parse_jog(const char *text, struct wb_grbl_jog *jog);

#endif
