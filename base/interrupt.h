/* A flag that Ctrl-C sets and loops check, so that the stage stops first and the recording closes.
 */
#ifndef WB_BASE_INTERRUPT_H
#define WB_BASE_INTERRUPT_H

#include <stdbool.h>

/* From now on SIGINT, SIGTERM and SIGHUP set the flag. System calls are interrupted, not
 * restarted, so a poll() wakes up. */
void wb_interrupt_install(void);

/* For commands that move the stage, after wb_interrupt_install(): nothing from the terminal or a
 * broken pipe may end or halt the process while something moves. SIGQUIT (Ctrl-\) sets the flag as
 * SIGINT does; SIGPIPE, SIGTSTP (Ctrl-Z), SIGTTIN and SIGTTOU are ignored. */
void wb_interrupt_guard(void);

/* True once a signal came; how many came. */
bool wb_interrupted(void);
/* The same for those who ask a function with a context whether to stop; it is not looked at. */
bool wb_interrupt_stops(void *context);
int wb_interrupt_count(void);

#endif
