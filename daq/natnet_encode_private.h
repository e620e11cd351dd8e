/* What only tests ask of daq/natnet_encode.h. */
#ifndef WB_DAQ_NATNET_ENCODE_PRIVATE_H
#define WB_DAQ_NATNET_ENCODE_PRIVATE_H

#include "daq/natnet_encode.h"

size_t wb_natnet_encode_message_string(uint8_t *buffer, size_t size, const char *text);

size_t wb_natnet_encode_response_text(uint8_t *buffer, size_t size, const char *text);

#endif
