#include "cli/print.h"

#include <math.h>
#include <stdio.h>

#include "analysis/calibration/properties/quantity.h"

int wb_print_decimals(double value, int digits)
{
    const double size = fabs(value);
    if (!(size > 1e-9) || !(size < 1e15))
        return 0;
    const int n = digits - 1 - (int)floor(log10(size));
    return n < 0 ? 0 : n;
}

const char *wb_print_number(double value, char text[WB_PRINT_NUMBER])
{
    if (isfinite(value))
        snprintf(text, WB_PRINT_NUMBER, "%.*f", wb_print_decimals(value, 4), value);
    else
        snprintf(text, WB_PRINT_NUMBER, "-");
    return text;
}

static void print_range(const char *of, double low, double high)
{
    char a[WB_PRINT_NUMBER], b[WB_PRINT_NUMBER];
    if (isfinite(low) && isfinite(high))
        printf("  %s %s to %s", of, wb_print_number(low, a), wb_print_number(high, b));
}

static void print_estimate(const char *label, const struct wb_quantity *row,
                           const struct wb_estimate *e, const char *range)
{
    char value[WB_PRINT_NUMBER] = "";
    if (isfinite(e->value))
        wb_print_number(e->value / row->scale, value);
    printf("%-34s %9s%s%-5s", label, value, row->unit[0] ? " " : "", row->unit);
    print_range("interval", e->low / row->scale, e->high / row->scale);
    print_range(range, e->candidates_low / row->scale, e->candidates_high / row->scale);
    printf("\n");
}

void wb_print_quantities(const struct wb_properties *properties, const char *range)
{
    for (enum wb_quantity_id id = 0; id < WB_QUANTITIES; id++) {
        const struct wb_quantity_values values = wb_quantity_values(properties, id);
        for (int k = 0; k < values.n; k++) {
            char label[WB_QUANTITY_LABEL];
            if (wb_quantity_is_known(&values.estimate[k]))
                print_estimate(
                    wb_quantity_label(id, values.curvature ? values.curvature[k] : 0.0, label),
                    &wb_quantity_rows[id], &values.estimate[k], range);
        }
    }
}
