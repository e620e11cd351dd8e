/* Output of `wirebench calibrate` for a calibration on whole cycles. */
#ifndef WB_CLI_CALIBRATE_CYCLE_H
#define WB_CLI_CALIBRATE_CYCLE_H

#include "analysis/calibration/cycle/cycle_verdict.h"

struct wb_calibrate_cycle {
    struct wb_cycle_calibrate_settings settings;
    struct wb_cycle_calibration calibration;
    struct wb_cycle_remarks remarks; /* on the data and the fits */
    struct wb_cycle_verdict verdict; /* set by the caller before it prints */
};

/* `output`: the properties file that was written, or NULL; `figure` beside it, or NULL. */
void wb_calibrate_cycle_print(const struct wb_calibrate_cycle *cycle, const char *output,
                              const char *figure);

/* Draws measured and computed tension of the first specimens into a new SVG file. */
WB_MUST_CHECK enum wb_status wb_calibrate_cycle_draw(const struct wb_calibrate_cycle *cycle,
                                                     const char *path);

void wb_calibrate_cycle_print_json(const struct wb_calibrate_cycle *cycle);

#endif
