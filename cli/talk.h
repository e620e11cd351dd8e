/* Output to the operator that never blocks: a terminal that hangs, or a pipe whose reader sleeps or
 * has ended, must not delay the loop that stops the stage.
 *
 * Output that stderr does not accept at once waits in a buffer of 16 KiB. A text that does not fit
 * is dropped as a whole and counted; the count is printed as soon as there is room. Used by one
 * thread at a time, which live_line.c ensures.
 */
#ifndef WB_CLI_TALK_H
#define WB_CLI_TALK_H

#include <stdbool.h>

/* Starts on the descriptor of stderr or stdout, with an empty buffer and no losses. */
void wb_talk_open(int descriptor);

/* Prints a whole text, such as a message with its newline. False if it was dropped. */
bool wb_talk_say(const char *text);

/* Writes the buffer as far as stderr accepts it; true if it is empty then. Text that is valid only
 * for a moment should not be printed otherwise. */
bool wb_talk_flush(void);

/* Waits at most `patience_ms` for the descriptor to accept the rest, and closes it. */
void wb_talk_close(int patience_ms);

#endif
