/* Numbers as text, independent of the locale. */
#ifndef WB_BASE_NUMBER_H
#define WB_BASE_NUMBER_H

#include <stdbool.h>
#include <stddef.h>

/* Size of the buffer for wb_number_format(), including the NUL. */
#define WB_NUMBER_TEXT 32

/* Parses the whole `text` as one finite decimal number; surrounding blanks are allowed. False for
 * anything else, including a decimal comma, a unit, hexadecimal, "nan" and "inf". */
bool wb_number_parse(const char *text, double *value);

/* Parses the whole `text` as one decimal integer within the range of long. */
bool wb_number_parse_integer(const char *text, long *value);

/* The shortest text that is read back as the same double; "nan", "inf" and "-inf" for other values.
 * Returns `text`. */
char *wb_number_format(double value, char text[WB_NUMBER_TEXT]);

#endif
