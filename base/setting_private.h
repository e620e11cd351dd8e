/* Functions for the tests of base/setting.h. */
#ifndef WB_BASE_SETTING_PRIVATE_H
#define WB_BASE_SETTING_PRIVATE_H

#include "base/setting.h"

/* A number's or integer's field, in the row's unit. */
double wb_setting_value(const struct wb_setting *row, const void *settings);

/* "0.01 to 100 mm", "elastic or elastoplastic"; "" where any value is valid. */
void wb_setting_range(const struct wb_setting *row, char text[WB_SETTING_VALUE]);
/* The default as options and files take it, or in words; "" where there is none. `otherwise`:
 * wb_setting_table's. */
void wb_setting_default(const struct wb_setting *row, const char *otherwise,
                        char text[WB_SETTING_VALUE]);

#endif
