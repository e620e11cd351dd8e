#include "base/text.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

/* Makes room for `more` bytes and a NUL; a size that no memory has fails like an allocation. */
static void reserve(struct wb_text *text, size_t more)
{
    if (more >= SIZE_MAX / 2)
        wb_memory_need(NULL);
    text->bytes = wb_memory_room(text->bytes, &text->capacity, text->length + more + 1, 1);
}

void wb_text_append(struct wb_text *text, const char *format, ...)
{
    va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    const int length = vsnprintf(NULL, 0, format, arguments);
    va_end(arguments);
    reserve(text, (size_t)length);
    vsnprintf(text->bytes + text->length, (size_t)length + 1, format, again);
    text->length += (size_t)length;
    va_end(again);
}

void wb_text_append_bytes(struct wb_text *text, const void *bytes, size_t n)
{
    reserve(text, n);
    if (n > 0)
        memcpy(text->bytes + text->length, bytes, n);
    text->length += n;
    text->bytes[text->length] = '\0';
}

void wb_text_append_escaped(struct wb_text *text, const char *raw)
{
    for (; *raw; raw++) {
        switch (*raw) {
        case '&':
            wb_text_append_bytes(text, "&amp;", 5);
            break;
        case '<':
            wb_text_append_bytes(text, "&lt;", 4);
            break;
        case '>':
            wb_text_append_bytes(text, "&gt;", 4);
            break;
        case '"':
            wb_text_append_bytes(text, "&quot;", 6);
            break;
        case '\'':
            wb_text_append_bytes(text, "&#39;", 5);
            break;
        default:
            wb_text_append_bytes(text, raw, 1);
        }
    }
}

void wb_text_append_quoted(struct wb_text *text, const char *word)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                "._-/+,:=@%";
    if (word[0] && !word[strspn(word, plain)]) {
        wb_text_append(text, "%s", word);
        return;
    }
    wb_text_append(text, "'");
    for (const char *c = word; *c; c++) {
        if (*c == '\'')
            wb_text_append(text, "'\\''");
        else
            wb_text_append_bytes(text, c, 1);
    }
    wb_text_append(text, "'");
}

const char *wb_text_string(const struct wb_text *text)
{
    return text->bytes ? text->bytes : "";
}

void wb_text_release(struct wb_text *text)
{
    free(text->bytes);
    *text = (struct wb_text){0};
}
