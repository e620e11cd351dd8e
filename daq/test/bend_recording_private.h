/* What only tests ask of daq/test/bend_recording.h. */
#ifndef WB_DAQ_TEST_BEND_RECORDING_PRIVATE_H
#define WB_DAQ_TEST_BEND_RECORDING_PRIVATE_H

#include "daq/test/bend_recording.h"

/* The text of a top-level key of a YAML block map, the key's own line included, or "" when it is
 * not there; allocated, NULL when out of memory. (For the truth of a virtual rig, which is stored
 * but never read.) */
char *wb_bend_recording_yaml_part(const char *yaml, const char *key);

#endif
