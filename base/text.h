/* Growing text: built by appending, read as one C string. */
#ifndef WB_BASE_TEXT_H
#define WB_BASE_TEXT_H

#include <stddef.h>

/* All zero is an empty text. Appending ends as base/memory.h describes if memory runs out. */
struct wb_text {
    char *bytes; /* NUL-terminated once something was appended; owned */
    size_t length, capacity;
};

/* Appends formatted text, or raw bytes. */
void wb_text_append(struct wb_text *text, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
void wb_text_append_bytes(struct wb_text *text, const void *bytes, size_t n);

/* Appends with &, <, >, " and ' escaped for HTML, SVG and Pango markup. */
void wb_text_append_escaped(struct wb_text *text, const char *raw);

/* Appends a word so that a POSIX shell reads it back as it is: in single quotes where it is empty
 * or has characters with a meaning in a shell. */
void wb_text_append_quoted(struct wb_text *text, const char *word);

/* The current text; "" if empty. Owned by `text`. */
const char *wb_text_string(const struct wb_text *text);

/* Frees and zeroes. */
void wb_text_release(struct wb_text *text);

#endif
