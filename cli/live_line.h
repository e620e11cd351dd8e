/* One line on the terminal that is redrawn in place, and single keys without Enter. Messages of the
 * log go above it. Where stderr is no terminal nothing is drawn.
 *
 * Nothing here ever waits for the terminal, not even messages of the log while it is open: what
 * stderr does not take is dropped and counted (cli/talk.h). */
#ifndef WB_CLI_LIVE_LINE_H
#define WB_CLI_LIVE_LINE_H

#include <stdbool.h>

/* Begins; takes over the log's sink while it lasts. The terminal is restored by
 * wb_live_line_close(), which is also registered with atexit(). */
void wb_live_line_open(void);

/* True when it is time to redraw (5 times a second) and there is a terminal to draw on. */
bool wb_live_line_due(void);

/* Draws, cut to the terminal's width. */
void wb_live_line_show(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Columns that the line may fill; many where stderr is no terminal. */
int wb_live_line_columns(void);

/* The next key pressed, 0 when there is none (or stdin is no terminal, or somebody else has its
 * foreground). Never waits. */
int wb_live_line_key(void);

/* Erases the line, restores terminal and log; waits 0.3 s at most. Harmless when not open. */
void wb_live_line_close(void);

#endif
