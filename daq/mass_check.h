/* The check of the load cell with a known mass: zero, hang the mass, read, compare. Moves nothing.
 *
 *     WB_TRY(wb_mass_check_open(&check, &rig, seconds));
 *     while ((phase = wb_mass_check_step(check, timeout_ns)) != WB_MASS_CHECK_DONE) ...
 *
 * In WB_MASS_CHECK_WAITING the caller asks for the mass and calls wb_mass_check_hung().
 */
#ifndef WB_DAQ_MASS_CHECK_H
#define WB_DAQ_MASS_CHECK_H

#include <stdbool.h>
#include <stdint.h>

#include "base/status.h"
#include "daq/rig.h"

struct wb_mass_check; /* opaque */

enum wb_mass_check_phase {
    WB_MASS_CHECK_CONNECTING,
    WB_MASS_CHECK_ZERO,     /* reading without the mass */
    WB_MASS_CHECK_WAITING,  /* for the mass */
    WB_MASS_CHECK_SETTLING, /* the mass swings */
    WB_MASS_CHECK_LOADED,   /* reading with the mass */
    WB_MASS_CHECK_DONE,
    WB_MASS_CHECK_FAILED /* a message was logged */
};

/* `seconds` (of the host) is averaged without and with the mass. Opens the load cell only. */
WB_MUST_CHECK enum wb_status wb_mass_check_open(struct wb_mass_check **out,
                                                const struct wb_rig *rig, double seconds);
enum wb_mass_check_phase wb_mass_check_step(struct wb_mass_check *check, int64_t timeout_ns);
/* The operator says that the mass hangs: the check continues. */
void wb_mass_check_hung(struct wb_mass_check *check);

struct wb_mass_check_result {
    double zero, loaded;       /* N, means */
    double zero_sd, loaded_sd; /* N, of one reading */
    int64_t n_zero, n_loaded;  /* readings */
    double mass;               /* kg, read: (loaded - zero) / g */
    double deviation;          /* kg, read less known */
    double relative;           /* deviation over the known mass */
    double uncertainty;        /* kg, standard error of the two means */
    bool passed;               /* |relative| within the tolerance */
};

/* Compares with the known mass (kg) within `tolerance` (a fraction of it), after
 * WB_MASS_CHECK_DONE. */
void wb_mass_check_result(const struct wb_mass_check *check, double known, double tolerance,
                          struct wb_mass_check_result *result);

void wb_mass_check_close(struct wb_mass_check *check); /* accepts NULL */

#endif
