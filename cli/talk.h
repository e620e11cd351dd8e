/* Talk to the operator that never waits: a terminal that hangs, a pipe whose reader sleeps or is
 * gone must not hold up a loop that has a stage to stop.
 *
 * What stderr does not take at once waits in a buffer of 16 KiB. A text that does not fit there is
 * dropped whole and counted; as soon as there is room a line says how many were. Used by one thread
 * at a time (live_line.c sees to that).
 */
#ifndef WB_CLI_TALK_H
#define WB_CLI_TALK_H

#include <stdbool.h>
#include <stdint.h>

/* Begins on a descriptor, stderr's or stdout's: nothing waits, nothing is lost yet. */
void wb_talk_open(int descriptor);

/* Says a whole text, such as a message with its newline. False when it was dropped. */
bool wb_talk_say(const char *text);

/* Writes what waits, as far as stderr takes it; true when nothing is left. What only matters now
 * is not worth saying otherwise. */
bool wb_talk_flush(void);

/* Waits at most `patience_ms` for the descriptor to take what is left, and ends. */
void wb_talk_close(int patience_ms);

#endif
