/* Messages for people: four levels, one settable sink, stderr by default.
 *
 * A file defines its domain below its includes and then speaks with wb_error(), wb_warn(),
 * wb_info() and wb_debug():
 *
 *     #define WB_LOG_DOMAIN "loadcell"
 *     wb_warn("reading %u ignored: unit changed from %s to %s", n, was, is);
 *
 * Messages are lower case, without a full stop, and name the subject in quotes. Threads may log at
 * the same time; the sink is called under a lock.
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

/* Receives one finished message, without a newline. `context` is the one given with the sink. */
typedef void wb_log_sink(void *context, enum wb_log_level level, const char *domain,
                         const char *message);

/* Formats and delivers a message if `level` is not above the threshold. errno is preserved. */
void wb_log(enum wb_log_level level, const char *domain, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Replaces the sink; NULL restores stderr. `context` must outlive its use. */
void wb_log_set_sink(wb_log_sink *sink, void *context);

/* From now on graver messages of the calling thread are delivered as `level`: for an attempt that
 * may well fail. WB_LOG_ERROR ends that. Returns the level that was set before. */
enum wb_log_level wb_log_set_gravest(enum wb_log_level level);

/* Sets the highest level that is delivered; WB_LOG_INFO at start. */
void wb_log_set_threshold(enum wb_log_level level);

/* A line without end stands on stderr's terminal (a progress line): the next message to stderr
 * erases it first, instead of continuing it. false: it is gone. */
void wb_log_note_line(bool is_drawn);

#define wb_error(...) wb_log(WB_LOG_ERROR, WB_LOG_DOMAIN, __VA_ARGS__)
#define wb_warn(...) wb_log(WB_LOG_WARNING, WB_LOG_DOMAIN, __VA_ARGS__)
#define wb_info(...) wb_log(WB_LOG_INFO, WB_LOG_DOMAIN, __VA_ARGS__)
#define wb_debug(...) wb_log(WB_LOG_DEBUG, WB_LOG_DOMAIN, __VA_ARGS__)

#endif
