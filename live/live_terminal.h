/* The live view of a test on a terminal: a child process at the view's end of a socket.
 *
 * Works over ssh, adapts to the size of the window, and uses ASCII if the locale is not UTF-8. The
 * keys of WB_LIVE_FRAME_KEYS are sent to the recorder. The view restores the terminal when the
 * recorder has ended and on SIGTERM and SIGHUP; if it was killed, the recorder writes
 * WB_LIVE_TERMINAL_RESTORE.
 */
#ifndef WB_LIVE_LIVE_TERMINAL_H
#define WB_LIVE_LIVE_TERMINAL_H

#include <stdbool.h>

/* Whether stdin and stderr are the same terminal, with this process in the foreground. */
bool wb_live_terminal_is_there(void);

/* Draws on stderr and reads keys from stdin until the recorder has ended. `plan` is a const struct
 * wb_live_plan. Returns an exit code: 0 if it ended with the recorder, 1 if the terminal cannot be
 * used (unknown type). */
int wb_live_terminal_run(int socket, void *plan);

/* Restores a terminal after a full-screen program was killed: normal screen, visible cursor, normal
 * characters. Terminals ignore unknown sequences. */
#define WB_LIVE_TERMINAL_RESTORE "\033[?1049l\033[?25h\033[?1l\033>\033(B\033[m\r\n"

#endif
