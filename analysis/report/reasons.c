#include "analysis/report/reasons.h"

#include <string.h>

#include "base/log.h"

#define WB_LOG_DOMAIN "report"

static void append_replaced(struct wb_text *text, const char *message, const char *path,
                            const char *name)
{
    const size_t length = path ? strlen(path) : 0;
    while (length > 0) {
        const char *const found = strstr(message, path);
        if (!found)
            break;
        wb_text_append_bytes(text, message, (size_t)(found - message));
        wb_text_append(text, "%s", name);
        message = found + length;
    }
    wb_text_append(text, "%s", message);
}

static void listen(void *context, enum wb_log_level level, const char *domain, const char *message)
{
    const struct wb_reasons *const reasons = context;
    (void)domain;
    if (level != WB_LOG_ERROR && !reasons->quiet)
        return;
    if (reasons->text->length > 0)
        wb_text_append(reasons->text, "; ");
    append_replaced(reasons->text, message, reasons->path, reasons->name);
}

void wb_reasons_begin(struct wb_reasons *reasons)
{
    wb_log_set_tap(listen, reasons);
    if (reasons->quiet)
        reasons->before = wb_log_set_gravest(WB_LOG_DEBUG);
}

void wb_reasons_end(void)
{
    wb_log_set_tap(NULL, NULL);
}

void wb_reasons_tell(const struct wb_reasons *reasons)
{
    wb_reasons_end();
    wb_log_set_gravest(reasons->before);
    if (reasons->text->length > 0)
        wb_warn("%s: %s", reasons->name, wb_text_string(reasons->text));
}
