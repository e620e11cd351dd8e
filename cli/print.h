/* Numbers for the terminal. */
#ifndef WB_CLI_PRINT_H
#define WB_CLI_PRINT_H

#include "analysis/calibration/properties/properties.h"

enum {
    WB_PRINT_NUMBER = 32 /* bytes of a number as text */
};

/* Number of decimals that show `digits` significant digits of a value without an exponent. */
int wb_print_decimals(double value, int digits);

/* Four significant digits, or "-" for a number that is not finite. Returns `text`. */
const char *wb_print_number(double value, char text[WB_PRINT_NUMBER]);

/* A line for each quantity that is known: value, interval and range; `range` names the range. */
void wb_print_quantities(const struct wb_properties *properties, const char *range);

#endif
