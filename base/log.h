/* Messages for users: four levels, one configurable sink, stderr by default.
 *
 * A file defines its domain below its includes and then uses wb_error(), wb_warn(), wb_info() and
 * wb_debug():
 *
 *     #define WB_LOG_DOMAIN "loadcell"
 *     wb_warn("reading %u ignored: unit changed from %s to %s", n, was, is);
 *
 * Messages are lower case, without a full stop, and quote their subject. Threads may log at the
 * same time; the sink is called under a lock.
 */
#ifndef WB_BASE_LOG_H
#define WB_BASE_LOG_H

#include <stdbool.h>

enum wb_log_level {
    WB_LOG_ERROR,
    WB_LOG_WARNING,
    WB_LOG_INFO,
    WB_LOG_DEBUG
};

/* Receives one complete message, without a newline. `context` is the one given with the sink. */
typedef void wb_log_sink(void *context, enum wb_log_level level, const char *domain,
                         const char *message);

/* Formats and delivers a message if `level` does not exceed the threshold. errno is preserved. */
void wb_log(enum wb_log_level level, const char *domain, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Replaces the sink; NULL restores stderr. `context` must outlive its use. */
void wb_log_set_sink(wb_log_sink *sink, void *context);

/* Messages of the calling thread that are more severe than `level` are delivered as `level` from
 * now on: for attempts that may fail. WB_LOG_ERROR restores the default. Returns the previous
 * level. */
enum wb_log_level wb_log_set_gravest(enum wb_log_level level);

/* Sets the highest level that is delivered; initially WB_LOG_INFO. */
void wb_log_set_threshold(enum wb_log_level level);

/* Tells the log that a line without newline (a progress line) is on stderr's terminal: the next
 * message to stderr erases it first, instead of continuing it. false: the line was erased. */
void wb_log_note_line(bool is_drawn);

#define wb_error(...) wb_log(WB_LOG_ERROR, WB_LOG_DOMAIN, __VA_ARGS__)
#define wb_warn(...) wb_log(WB_LOG_WARNING, WB_LOG_DOMAIN, __VA_ARGS__)
#define wb_info(...) wb_log(WB_LOG_INFO, WB_LOG_DOMAIN, __VA_ARGS__)
#define wb_debug(...) wb_log(WB_LOG_DEBUG, WB_LOG_DOMAIN, __VA_ARGS__)

#endif
