/* Functions of daq/test/bend_recording.h that only tests call. */
#ifndef WB_DAQ_TEST_BEND_RECORDING_PRIVATE_H
#define WB_DAQ_TEST_BEND_RECORDING_PRIVATE_H

#include "daq/test/bend_recording.h"

/* Extracts the text of a top-level key of a YAML block map, including the key's own line; "" if the
 * key is missing. Allocated; NULL when out of memory. (For the true values of a virtual rig, which
 * are stored but never parsed.) */
char *wb_bend_recording_yaml_part(const char *yaml, const char *key);

#endif
