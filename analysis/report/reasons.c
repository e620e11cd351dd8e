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

static void keep(const struct wb_reasons *reasons, enum wb_status status,
                 const struct wb_reason *why)
{
    struct wb_text *const problem = reasons->problem;
    if (problem->length > 0 && !why->text[0])
        return;
    wb_text_append(problem, "%s", problem->length > 0 ? "; " : "");
    append_replaced(problem, why->text[0] ? why->text : wb_status_text(status), reasons->path,
                    reasons->name);
}

void wb_reasons_fail(const struct wb_reasons *reasons, enum wb_status status,
                     const struct wb_reason *why)
{
    if (why->text[0])
        wb_error("%s", why->text);
    keep(reasons, status, why);
}

void wb_reasons_warn(const struct wb_reasons *reasons, enum wb_status status,
                     const struct wb_reason *why)
{
    keep(reasons, status, why);
    if (why->text[0])
        wb_warn("%s: %s", reasons->name, wb_text_string(reasons->problem));
}
