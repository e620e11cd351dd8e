/* Numbers, warnings and corrections of an alignment, as dataset.json has them. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "analysis/align/align_private.h"

#define WB_LOG_DOMAIN "align"

void wb_align_set(struct wb_json *object, const char *key, double value)
{
    char text[40];
    snprintf(text, sizeof text, "%.6g", value);
    wb_json_set_number(object, key, isfinite(value) ? strtod(text, NULL) : value);
}

void wb_align_warn(struct wb_align *align, const char *format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    wb_warn("%s: %s", align->name, text);
    wb_json_append_text(align->warnings, text);
}

void wb_align_correct(struct wb_align *align, const struct wb_align_correction *correction,
                      const char *note, ...)
{
    char key[64], text[512];
    va_list arguments;
    va_start(arguments, note);
    vsnprintf(text, sizeof text, note, arguments);
    va_end(arguments);
    struct wb_json *const entry = wb_json_append_object(align->corrections);
    wb_json_set_text(entry, "name", correction->name);
    snprintf(key, sizeof key, "value_%s", correction->unit);
    wb_align_set(entry, key, correction->value / correction->factor);
    snprintf(key, sizeof key, "uncertainty_%s", correction->unit);
    wb_align_set(entry, key, correction->uncertainty / correction->factor);
    wb_json_set_text(entry, "note", text);
}
