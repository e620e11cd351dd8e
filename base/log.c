#include "base/log.h"

#include <errno.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static wb_log_sink *current_sink;
static void *sink_context;
static enum wb_log_level threshold = WB_LOG_INFO;
static bool has_line; /* see wb_log_note_line() */
static _Thread_local enum wb_log_level gravest = WB_LOG_ERROR;

static void write_to_stderr(enum wb_log_level level, const char *domain, const char *message)
{
    static const char *const names[] = {"error: ", "warning: ", "", "debug: "};
    if (has_line)
        fputs("\r\033[K", stderr);
    has_line = false;
    if (level == WB_LOG_DEBUG)
        fprintf(stderr, "wirebench: %s%s: %s\n", names[level], domain, message);
    else
        fprintf(stderr, "wirebench: %s%s\n", names[level], message);
}

void wb_log(enum wb_log_level level, const char *domain, const char *format, ...)
{
    const int saved_errno = errno;
    char message[2048];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);

    if (level < gravest)
        level = gravest;
    pthread_mutex_lock(&lock);
    if (level <= threshold) {
        if (current_sink)
            current_sink(sink_context, level, domain, message);
        else
            write_to_stderr(level, domain, message);
    }
    pthread_mutex_unlock(&lock);
    errno = saved_errno;
}

void wb_log_set_sink(wb_log_sink *sink, void *context)
{
    pthread_mutex_lock(&lock);
    current_sink = sink;
    sink_context = context;
    pthread_mutex_unlock(&lock);
}

enum wb_log_level wb_log_set_gravest(enum wb_log_level level)
{
    const enum wb_log_level before = gravest;
    gravest = level;
    return before;
}

void wb_log_set_threshold(enum wb_log_level level)
{
    pthread_mutex_lock(&lock);
    threshold = level;
    pthread_mutex_unlock(&lock);
}

void wb_log_note_line(bool is_drawn)
{
    pthread_mutex_lock(&lock);
    has_line = is_drawn;
    pthread_mutex_unlock(&lock);
}
