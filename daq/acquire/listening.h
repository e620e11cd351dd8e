/* Identifies the instrument at an unknown serial port: tries baud rates and frames one after
 * another until the received bytes are lines of a load cell or a stage. */
#ifndef WB_DAQ_ACQUIRE_LISTENING_H
#define WB_DAQ_ACQUIRE_LISTENING_H

#include <stdbool.h>
#include <stdint.h>

#include "daq/protocol/diagnosis.h"

enum wb_listening_found {
    WB_LISTENING_NOTHING,   /* no byte received */
    WB_LISTENING_LOAD_CELL, /* prints readings */
    WB_LISTENING_GRBL,
    WB_LISTENING_OLD_GRBL, /* before 1.1 */
    WB_LISTENING_TIC,
    WB_LISTENING_UNKNOWN /* bytes, but no supported instrument at any rate */
};

struct wb_listening {
    enum wb_listening_found found;
    char line[16];   /* setting at which it was found: "38400,8n1" */
    char sample[48]; /* a received line, with '?' for characters that cannot be printed; "" */
};

struct wb_listening_settings {
    bool asks;           /* send the status queries of GRBL and Tic, which cause no motion; false:
                            send nothing */
    int64_t patience_ns; /* time at each rate; with `asks` three times this at the first one, where
                            opening the port may reset the controller */
};

/* Identifies the instrument at an address (`serial:PATH` or `pty:PATH`; settings after the path are
 * ignored). Takes a few times `patience_ns` if the port is silent, otherwise up to `patience_ns` at
 * each of eleven settings. Ends early after Ctrl-C. Fails if the port cannot be opened, read or
 * written; `why` holds the message. */
WB_MUST_CHECK enum wb_status wb_listening_run(const char *address,
                                              const struct wb_listening_settings *settings,
                                              struct wb_listening *heard, struct wb_reason *why);

#endif
