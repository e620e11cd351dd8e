/* One line on the terminal that is redrawn in place, and single keys without Enter. Messages of the
 * log are printed above it. If stderr is not a terminal, nothing is drawn.
 *
 * No function waits for the terminal, and neither do messages of the log while the line is open:
 * output that stderr does not accept is dropped and counted (cli/talk.h). */
#ifndef WB_CLI_LIVE_LINE_H
#define WB_CLI_LIVE_LINE_H

#include <stdbool.h>
#include <termios.h>

#include "base/log.h"

/* Opens the line and replaces the sink of the log. wb_live_line_close(), which is also registered
 * with atexit(), restores the terminal. */
void wb_live_line_open(void);

/* True when it is time to redraw (5 times a second) and there is a terminal to draw on. */
bool wb_live_line_due(void);

/* Draws, cut to the terminal's width. */
void wb_live_line_show(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* The width of the line in columns; large if stderr is not a terminal. */
int wb_live_line_columns(void);

/* The sink of the log while the line is open: prints the message above the line. For sinks of
 * callers that do more. */
void wb_live_line_log(void *context, enum wb_log_level level, const char *domain,
                      const char *message);
/* "error: ", "warning: ", "" or "debug: ": the beginning of a message. */
const char *wb_live_line_level(enum wb_log_level level);

/* Prints a text unchanged, above the line that is drawn next. */
void wb_live_line_say(const char *text);

/* After another process used the terminal: prints the sequence that resets it, and restores its
 * earlier modes, which wb_live_line_key() depends on. */
void wb_live_line_restore(const struct termios *modes, const char *sequence);

/* The next key pressed; 0 if there is none, if stdin is not a terminal, or if another process is in
 * its foreground. Never waits. */
int wb_live_line_key(void);

/* Erases the line, restores terminal and log; waits 0.3 s at most. Does nothing if not open. */
void wb_live_line_close(void);

/* Prints a text to stdout after wb_live_line_close(). Waits at most 0.3 s for a terminal that
 * hangs; pipes and files receive the whole text. */
void wb_live_line_print(const char *text);

#endif
