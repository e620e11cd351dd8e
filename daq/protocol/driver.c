#include "daq/protocol/driver.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

const char *wb_role_name(enum wb_role role)
{
    static const char *const names[] = {
        [WB_ROLE_LOAD] = "load", [WB_ROLE_MOCAP] = "mocap", [WB_ROLE_STAGE] = "stage"};
    return (size_t)role < sizeof names / sizeof names[0] ? names[role] : "unknown";
}

bool wb_outbox_add(struct wb_outbox *outbox, const void *bytes, size_t n)
{
    if (n == 0 || outbox->n_entries == WB_OUTBOX_ENTRIES || n > WB_OUTBOX_BYTES - outbox->n_bytes)
        return false;
    memcpy(outbox->bytes + outbox->n_bytes, bytes, n);
    outbox->n_bytes += n;
    outbox->ends[outbox->n_entries++] = outbox->n_bytes;
    return true;
}

bool wb_outbox_add_text(struct wb_outbox *outbox, const char *text)
{
    return wb_outbox_add(outbox, text, strlen(text));
}

void wb_outbox_clear(struct wb_outbox *outbox)
{
    outbox->n_bytes = 0;
    outbox->n_entries = 0;
}

void wb_driver_remark(const struct wb_sink *sink, enum wb_log_level level, int64_t t_ns,
                      const char *kind, const char *format, ...)
{
    if (!sink->remark)
        return;
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    sink->remark(sink->context, level, t_ns, kind, text);
}

char *wb_driver_printable(char *text, size_t size, const void *bytes, size_t n)
{
    const char *const from = bytes;
    const size_t kept = n < size ? n : size - 1;
    for (size_t i = 0; i < kept; i++)
        text[i] = from[i] >= 0x20 && from[i] < 0x7f ? from[i] : '?';
    text[kept] = '\0';
    return text;
}

int64_t wb_driver_period_ns(const struct wb_rig *rig, int64_t period_ns)
{
    return (int64_t)((double)period_ns / (rig->time_scale > 1.0 ? rig->time_scale : 1.0));
}

bool wb_driver_is_report_due(uint64_t n)
{
    while (n > 3 && n % 10 == 0)
        n /= 10;
    return n <= 3;
}
