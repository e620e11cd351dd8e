#include "base/reason.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

/* As long as the longest message of the log. */
enum {
    MOST_MESSAGE = 2048
};

/* Adds behind the first `used` bytes, which fit. */
static void add(struct wb_reason *reason, size_t used, const char *message)
{
    static const char mark[] = "...";
    const size_t room = sizeof reason->text - used;
    const size_t length = strlen(message);

    if (length < room) {
        memcpy(reason->text + used, message, length + 1);
        return;
    }
    memcpy(reason->text + used, message, room);
    size_t end = sizeof reason->text - sizeof mark;
    /* Bytes 10xxxxxx of UTF-8 continue a character: none may lose its head. */
    while (end > 0 && ((unsigned char)reason->text[end] & 0xc0) == 0x80)
        end--;
    memcpy(reason->text + end, mark, sizeof mark);
}

void wb_reason_set(struct wb_reason *reason, const char *format, ...)
{
    char message[MOST_MESSAGE];
    va_list arguments;

    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    add(reason, 0, message);
}

void wb_reason_append(struct wb_reason *reason, const char *format, ...)
{
    char message[MOST_MESSAGE] = "; ";
    const bool is_first = reason->text[0] == '\0';
    va_list arguments;

    va_start(arguments, format);
    vsnprintf(message + 2, sizeof message - 2, format, arguments);
    va_end(arguments);
    add(reason, strlen(reason->text), is_first ? message + 2 : message);
}

void wb_reason_tell(struct wb_reason *reason, const char *domain, const char *format, ...)
{
    char message[MOST_MESSAGE];
    va_list arguments;

    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    if (reason)
        add(reason, 0, message);
    else
        wb_log(WB_LOG_ERROR, domain, "%s", message);
}
