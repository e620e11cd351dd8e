/* Reads the load cell under known masses, which the operator attaches one after another: waits
 * until the reading is stable, then averages. cell_calibration.h evaluates the readings.
 *
 *     WB_TRY(wb_mass_check_open(&check, rig, seconds, masses, n));
 *     while ((phase = wb_mass_check_step(check, timeout_ns)) < WB_MASS_CHECK_DONE)
 *         ...on WAITING: prompt for masses[wb_mass_check_index(check)], then
 * wb_mass_check_confirm() points = wb_mass_check_points(check); wb_mass_check_close(check);
 *
 * The list begins with 0: the load of the cell at the beginning is its zero, which is read without
 * a prompt. Used by one thread.
 */
#ifndef WB_DAQ_ACQUIRE_MASS_CHECK_H
#define WB_DAQ_ACQUIRE_MASS_CHECK_H

#include <stdbool.h>
#include <stdint.h>

#include "base/status.h"
#include "daq/protocol/cell_calibration.h"
#include "daq/protocol/rig.h"

struct wb_mass_check; /* opaque */

enum wb_mass_check_phase {
    WB_MASS_CHECK_CONNECTING,
    WB_MASS_CHECK_WAITING,  /* for the next mass */
    WB_MASS_CHECK_SETTLING, /* until the reading is stable */
    WB_MASS_CHECK_READING,
    WB_MASS_CHECK_DONE,
    WB_MASS_CHECK_FAILED /* a message was logged */
};

/* Opens the load cell only. Readings are averaged over `seconds` of host time under each of the n
 * masses (kg, copied; n is 2 to WB_RIG_MASSES). */
WB_MUST_CHECK enum wb_status wb_mass_check_open(struct wb_mass_check **out,
                                                const struct wb_rig *rig, double seconds,
                                                const double *masses, int n);
enum wb_mass_check_phase wb_mass_check_step(struct wb_mass_check *check, int64_t timeout_ns);
/* Index of the mass that is waited for or being read. */
int wb_mass_check_index(const struct wb_mass_check *check);
/* The operator has attached the mass: the check continues. */
void wb_mass_check_confirm(struct wb_mass_check *check);

/* The n points, valid after WB_MASS_CHECK_DONE; owned by the check. */
const struct wb_cell_point *wb_mass_check_points(const struct wb_mass_check *check);

void wb_mass_check_close(struct wb_mass_check *check); /* accepts NULL */

#endif
