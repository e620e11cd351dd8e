/* The wires of a campaign, each calibrated on the tests of all its groups and validated by leaving
 * each test out. */
#ifndef WB_ANALYSIS_REPORT_MACHINES_MACHINES_FITS_H
#define WB_ANALYSIS_REPORT_MACHINES_MACHINES_FITS_H

#include "analysis/calibration/properties/properties.h"
#include "analysis/report/kind.h"
#include "analysis/report/machines/machines.h"
#include "analysis/report/machines/machines_test.h"
#include "analysis/validation/left_out.h"

struct wb_machines_fit {
    int first; /* first group of the wire */
    int n;     /* tests */
    bool is_fitted, is_validated;
    struct wb_reason why; /* why it was not fitted or not validated */
    struct wb_three_point_calibration calibration;
    struct wb_left_out left_out;
};

struct wb_machines_fits {
    int n;                        /* wires; 0: the campaign does not calibrate */
    struct wb_machines_fit *fits; /* (n), owned */
};

/* Number of wires to calibrate. */
int wb_machines_fits_count_wires(const struct wb_machines *campaign);

/* Fills zeroed fits, with progress after each wire: its steps follow those of the groups.
 * `n_threads` 0: as many as there are processors. After Ctrl-C, the remaining wires are not
 * calibrated. */
void wb_machines_fits_compute(struct wb_machines_fits *fits, const struct wb_machines *campaign,
                              const struct wb_machines_group_results *groups, int n_threads,
                              wb_kind_progress *progress, void *context);

/* Whether the law of a wire differs from the tests left out by more than 0.7 of their standard
 * deviation. */
bool wb_machines_fits_is_biased(const struct wb_machines_fit *fit);

/* Number of tests of a calibrated wire whose fits did not converge. */
int wb_machines_fits_count_unconverged(const struct wb_machines_fit *fit);

/* Lists the files of the tests of a fit, at most WB_PROPERTIES_MOST_DATASETS; returns their number.
 */
int wb_machines_fits_list(const struct wb_machines_fit *fit, const struct wb_machines *campaign,
                          const struct wb_machines_group_results *groups,
                          struct wb_properties_dataset *list);

void wb_machines_fits_release(struct wb_machines_fits *fits); /* accepts a zeroed one */

#endif
