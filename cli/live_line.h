/* One line on the terminal that is redrawn in place, and single keys without Enter. Messages of the
 * log go above it. Where stderr is no terminal nothing is drawn.
 *
 * Nothing here ever waits for the terminal, not even messages of the log while it is open: what
 * stderr does not take is dropped and counted (cli/talk.h). */
#ifndef WB_CLI_LIVE_LINE_H
#define WB_CLI_LIVE_LINE_H

#include <stdbool.h>
#include <termios.h>

#include "base/log.h"

/* Begins; takes over the log's sink while it lasts. The terminal is restored by
 * wb_live_line_close(), which is also registered with atexit(). */
void wb_live_line_open(void);

/* True when it is time to redraw (5 times a second) and there is a terminal to draw on. */
bool wb_live_line_due(void);

/* Draws, cut to the terminal's width. */
void wb_live_line_show(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Columns that the line may fill; many where stderr is no terminal. */
int wb_live_line_columns(void);

/* What the log's sink does while the line is open: the message goes above the line. For a sink of
 * the caller's that has more to do. */
void wb_live_line_log(void *context, enum wb_log_level level, const char *domain,
                      const char *message);
/* "error: ", "warning: ", "" or "debug: ", as messages begin. */
const char *wb_live_line_level(enum wb_log_level level);

/* Says a text as it is, above the line that is drawn next. */
void wb_live_line_say(const char *text);

/* After another program had the terminal: says the sequence that makes it sane, and sets the modes
 * that it had before, on which wb_live_line_key() builds. */
void wb_live_line_restore(const struct termios *modes, const char *sequence);

/* The next key pressed, 0 when there is none (or stdin is no terminal, or somebody else has its
 * foreground). Never waits. */
int wb_live_line_key(void);

/* Erases the line, restores terminal and log; waits 0.3 s at most. Harmless when not open. */
void wb_live_line_close(void);

/* Prints a text to stdout after wb_live_line_close(). A terminal that hangs is waited for no longer
 * than messages are; pipes and files get all of it. */
void wb_live_line_print(const char *text);

#endif
