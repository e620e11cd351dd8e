#include "analysis/validation/validate_tables.h"

#include <math.h>
#include <stdio.h>

#include "base/file.h"
#include "base/number.h"
#include "base/units.h"
#include "base/version.h"

static void put(struct wb_text *text, double value, char end)
{
    char number[WB_NUMBER_TEXT];
    wb_text_append(text, "%s%c", isfinite(value) ? wb_number_format(value, number) : "", end);
}

void wb_validate_tables_put_row(struct wb_text *text, const double *values, size_t n)
{
    for (size_t i = 0; i < n; i++)
        put(text, values[i], i + 1 < n ? ',' : '\n');
}

/* The wire's name with the characters replaced that would break a table. */
static void plain_name(char *name, size_t size, const struct wb_test_info *info)
{
    snprintf(name, size, "%s", info->wire);
    for (char *c = name; *c; c++) {
        if ((unsigned char)*c < 0x20 || *c == ',')
            *c = ' ';
    }
}

void wb_validate_tables_put_origin(struct wb_text *text, const struct wb_test_info *info, int n)
{
    char wire[sizeof info->wire];
    plain_name(wire, sizeof wire, info);
    wb_text_append(text, "# %swire %s, L = %g mm, %d %s, wirebench %s (%s)\n",
                   info->is_virtual      ? "virtual rig, "
                   : info->is_simulation ? "simulation, "
                                         : "",
                   wire, info->length / WB_MM, n, n == 1 ? "sample" : "samples", wb_version(),
                   wb_version_revision());
}

void wb_validate_tables_put_heading(struct wb_text *text)
{
    wb_text_append(text, "wire,length_mm,score,measured,computed,error,unit\n");
}

void wb_validate_tables_put_score(struct wb_text *text, const struct wb_test_info *info,
                                  const char *score, const double values[3], const char *unit)
{
    char wire[sizeof info->wire];
    plain_name(wire, sizeof wire, info);
    wb_text_append(text, "%s,%g,%s,", wire, info->length / WB_MM, score);
    for (int i = 0; i < 3; i++)
        put(text, values[i], ',');
    wb_text_append(text, "%s\n", unit);
}

enum wb_status wb_validate_tables_write(struct wb_text *text, const char *path)
{
    const enum wb_status status = wb_file_write_text(path, text);
    wb_text_release(text);
    return status;
}
