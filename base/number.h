/* Numbers as text, independent of the locale. */
#ifndef WB_BASE_NUMBER_H
#define WB_BASE_NUMBER_H

#include <stdbool.h>
#include <stddef.h>

/* Enough for any double in wb_number_format(), with the NUL. */
#define WB_NUMBER_TEXT 32

/* Parses the whole of `text` as one finite decimal number (blanks around it are allowed; a
 * decimal comma, a unit, hexadecimal, "nan" and "inf" are not). False when it is anything else. */
bool wb_number_parse(const char *text, double *value);

/* Parses the whole of `text` as one decimal integer within a long. */
bool wb_number_parse_integer(const char *text, long *value);

/* The shortest text that reads back as the same double; "nan", "inf" and "-inf" otherwise.
 * Returns `text`. */
char *wb_number_format(double value, char text[WB_NUMBER_TEXT]);

#endif
