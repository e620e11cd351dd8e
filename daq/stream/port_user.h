/* Who has a port open: for the message that it is busy.
 *
 * The kernel tells the holder of a lock (/proc/locks), and which files the processes of this user,
 * or for root of all users, have open (/proc/PID/fd).
 */
#ifndef WB_DAQ_STREAM_PORT_USER_H
#define WB_DAQ_STREAM_PORT_USER_H

#include <stdbool.h>

#define WB_PORT_USER_TEXT 64

/* "minicom, process 1234" of the process other than this one that holds the lock on the device at
 * `path` (links are followed), or else has it open. False: nobody that this user may see. */
bool wb_port_user(const char *path, char text[WB_PORT_USER_TEXT]);

#endif
