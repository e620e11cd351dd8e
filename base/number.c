#include "base/number.h"

#include <ctype.h>
#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* strtod() also accepts hexadecimal, "nan" and "inf": allow only the characters of decimal
 * numbers. */
static bool only_decimal_characters(const char *text)
{
    return text[strspn(text, "0123456789+-.eE \t\r\n")] == '\0';
}

static bool only_blanks(const char *text)
{
    return text[strspn(text, " \t\r\n")] == '\0';
}

bool wb_number_parse(const char *text, double *value)
{
    if (!only_decimal_characters(text))
        return false;
    char *end;
    const double parsed = strtod(text, &end);
    if (end == text || !only_blanks(end) || !isfinite(parsed))
        return false;
    *value = parsed;
    return true;
}

bool wb_number_parse_integer(const char *text, long *value)
{
    char *end;
    errno = 0;
    const long parsed = strtol(text, &end, 10);
    if (end == text || !only_blanks(end) || errno != 0)
        return false;
    *value = parsed;
    return true;
}

char *wb_number_format(double value, char text[WB_NUMBER_TEXT])
{
    if (isnan(value))
        return strcpy(text, "nan");
    if (isinf(value))
        return strcpy(text, value > 0.0 ? "inf" : "-inf");
    /* A number that reads back from fewer than DBL_DIG digits also does from DBL_DIG. */
    snprintf(text, WB_NUMBER_TEXT, "%.*g", DBL_DIG, value);
    const bool is_long = strtod(text, NULL) != value;
    for (int digits = is_long ? DBL_DIG + 1 : 6; digits <= 17; digits++) {
        snprintf(text, WB_NUMBER_TEXT, "%.*g", digits, value);
        if (strtod(text, NULL) == value)
            break;
    }
    return text;
}
