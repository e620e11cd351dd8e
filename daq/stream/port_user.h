/* Finds the program that has a port open, for the message that the port is busy.
 *
 * Sources: /proc/locks lists the holders of locks; /proc/PID/fd lists the open files of this user's
 * processes (of all processes for root).
 */
#ifndef WB_DAQ_STREAM_PORT_USER_H
#define WB_DAQ_STREAM_PORT_USER_H

#include <stdbool.h>

#define WB_PORT_USER_TEXT 64

/* Writes "minicom, process 1234" for another process that holds a lock on the device at `path`
 * (links are followed) or, failing that, has it open. False: no such process is visible to this
 * user. */
bool wb_port_user(const char *path, char text[WB_PORT_USER_TEXT]);

#endif
