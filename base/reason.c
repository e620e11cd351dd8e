#include "base/reason.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* As long as the longest log message. */
enum {
    MAX_MESSAGE = 2048
};

/* Stores the message, truncated if necessary. */
static void keep(struct wb_reason *reason, const char *message)
{
    static const char mark[] = "...";
    const size_t length = strlen(message);

    if (length < sizeof reason->text) {
        memcpy(reason->text, message, length + 1);
        return;
    }
    memcpy(reason->text, message, sizeof reason->text);
    size_t end = sizeof reason->text - sizeof mark;
    /* Do not cut within a UTF-8 character: bytes 10xxxxxx continue one. */
    while (end > 0 && ((unsigned char)reason->text[end] & 0xc0) == 0x80)
        end--;
    memcpy(reason->text + end, mark, sizeof mark);
}

void wb_reason_set(struct wb_reason *reason, const char *format, ...)
{
    char message[MAX_MESSAGE];
    va_list arguments;

    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    keep(reason, message);
}

void wb_reason_report(struct wb_reason *reason, bool also, const char *domain, const char *format,
                      ...)
{
    char message[MAX_MESSAGE];
    va_list arguments;

    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    if (!reason)
        wb_log(WB_LOG_ERROR, domain, "%s", message);
    else if (also && reason->text[0])
        wb_reason_set(reason, "%s; %s", reason->text, message);
    else
        keep(reason, message);
}
