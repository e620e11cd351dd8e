/* What is behind a serial port of which nothing is known: its baud rate and frame are found by
 * listening at one after another, until the bytes are lines of a load cell or of a stage. */
#ifndef WB_DAQ_ACQUIRE_LISTENING_H
#define WB_DAQ_ACQUIRE_LISTENING_H

#include <stdbool.h>
#include <stdint.h>

#include "daq/protocol/diagnosis.h"

enum wb_listening_found {
    WB_LISTENING_NOTHING,   /* no byte came */
    WB_LISTENING_LOAD_CELL, /* prints readings */
    WB_LISTENING_GRBL,
    WB_LISTENING_OLD_GRBL, /* before 1.1 */
    WB_LISTENING_TIC,
    WB_LISTENING_UNKNOWN /* bytes, and at no rate what is known here */
};

struct wb_listening {
    enum wb_listening_found found;
    char line[16];   /* "38400,8n1", where it was found */
    char sample[48]; /* a line as it came, what cannot be printed as '?'; "" */
};

struct wb_listening_settings {
    bool asks;           /* also sends the questions for the state of GRBL and Tic, which move
                            nothing; else nothing is sent */
    int64_t patience_ns; /* at each rate; of a controller that is reset by the opening the triple */
};

/* Listens at the port of an address (`serial:PATH` or `pty:PATH`; what follows the path is not
 * used). Takes a second or two where nothing is sent, else up to the patience at each of some ten
 * rates. Ends early after Ctrl-C. Fails where the port cannot be opened; `why` has the message. */
WB_MUST_CHECK enum wb_status wb_listening_run(const char *address,
                                              const struct wb_listening_settings *settings,
                                              struct wb_listening *heard, struct wb_reason *why);

#endif
