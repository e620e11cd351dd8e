/* A flag set by Ctrl-C and checked by loops, so that the stage stops and the recording is closed
 * before the program ends.
 */
#ifndef WB_BASE_INTERRUPT_H
#define WB_BASE_INTERRUPT_H

#include <stdbool.h>

/* Makes SIGINT, SIGTERM and SIGHUP set the flag. System calls are interrupted, not restarted, so a
 * poll() returns. */
void wb_interrupt_install(void);

/* For commands that move the stage, after wb_interrupt_install(): neither the terminal nor a broken
 * pipe may end or suspend the process while the stage moves. SIGQUIT (Ctrl-\) sets the flag like
 * SIGINT; SIGPIPE, SIGTSTP (Ctrl-Z), SIGTTIN and SIGTTOU are ignored. */
void wb_interrupt_guard(void);

/* True after a signal; the number of signals. */
bool wb_interrupted(void);
/* As wb_interrupted(), as a callback; the context is ignored. */
bool wb_interrupt_stops(void *context);
int wb_interrupt_count(void);

#endif
