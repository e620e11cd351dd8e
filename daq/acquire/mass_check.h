/* Readings of the load cell under known masses that an operator hangs on it one after another: a
 * program that asks for each, waits until the reading is still and averages. What the readings say
 * of the cell is worked out in cell_calibration.h.
 *
 *     WB_TRY(wb_mass_check_open(&check, rig, seconds, masses, n));
 *     while ((phase = wb_mass_check_step(check, timeout_ns)) < WB_MASS_CHECK_DONE)
 *         ...on WAITING: ask for masses[wb_mass_check_index(check)], then
 * wb_mass_check_confirm()... points = wb_mass_check_points(check); wb_mass_check_close(check);
 *
 * The list begins with 0: what the cell carries when the check begins is its zero, and is read
 * without a question. Used by one thread.
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
    WB_MASS_CHECK_SETTLING, /* the mass swings, the cell's filter follows */
    WB_MASS_CHECK_READING,
    WB_MASS_CHECK_DONE,
    WB_MASS_CHECK_FAILED /* a message was logged */
};

/* `seconds` (of the host) is averaged under each of the masses (kg, n of them: 2 to WB_RIG_MASSES;
 * copied). Opens the load cell only. */
WB_MUST_CHECK enum wb_status wb_mass_check_open(struct wb_mass_check **out,
                                                const struct wb_rig *rig, double seconds,
                                                const double *masses, int n);
enum wb_mass_check_phase wb_mass_check_step(struct wb_mass_check *check, int64_t timeout_ns);
/* Number from 0 of the mass that is asked for or being read. */
int wb_mass_check_index(const struct wb_mass_check *check);
/* The operator says that the mass hangs: the check continues. */
void wb_mass_check_confirm(struct wb_mass_check *check);

/* The points (n of them), after WB_MASS_CHECK_DONE; owned by the check. */
const struct wb_cell_point *wb_mass_check_points(const struct wb_mass_check *check);

void wb_mass_check_close(struct wb_mass_check *check); /* accepts NULL */

#endif
