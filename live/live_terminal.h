/* The live view of a test on a terminal: a program of its own at the view's end of a socket.
 *
 * Works over ssh, follows the window's size, and uses plain ASCII where the locale is not UTF-8.
 * Keys m and q are sent to the recorder. It leaves the terminal as it was when the recorder has
 * gone or on SIGTERM and SIGHUP; after a harder end wb_live_terminal_restore() does.
 */
#ifndef WB_LIVE_LIVE_TERMINAL_H
#define WB_LIVE_LIVE_TERMINAL_H

#include <stdbool.h>

/* Whether stdin and stderr are one terminal that this process has the foreground of. */
bool wb_live_terminal_is_there(void);

/* Draws on stderr and reads keys from stdin until the recorder has gone. `plan` is a const struct
 * wb_live_plan. Returns an exit code: 0 when it ended with the recorder, 1 when the terminal is of
 * no use (its type is not known). */
int wb_live_terminal_run(int socket, void *plan);

/* What makes a terminal sane again whose full-screen program was killed: the usual screen, a
 * visible cursor, plain characters. Unknown sequences are ignored by terminals. */
#define WB_LIVE_TERMINAL_RESTORE "\033[?1049l\033[?25h\033[?1l\033>\033(B\033[m\r\n"

#endif
