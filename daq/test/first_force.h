/* Check of the first force of a test: once the strand is taut, the force must rise with deflection,
 * with a slope that is possible for this wire. Detects a wrong sign or unit of the cell and a wrong
 * specimen while the specimen is still intact.
 */
#ifndef WB_DAQ_TEST_FIRST_FORCE_H
#define WB_DAQ_TEST_FIRST_FORCE_H

#include <stdbool.h>

#include "daq/protocol/rig.h"
#include "daq/test/start_check.h"

/* Bounds of the slope of force over deflection of the tip. All zero: unknown; only the sign of the
 * slope is checked. */
struct wb_first_force_bounds {
    double lowest, highest; /* N/m */
    char of[160];           /* source of the bounds, for messages: "the properties in FILE" */
};

enum wb_first_force_verdict {
    WB_FIRST_FORCE_OPEN, /* not enough readings yet */
    WB_FIRST_FORCE_AGREES,
    WB_FIRST_FORCE_WRONG
};

struct wb_first_force {
    double noise;   /* N, standard deviation of a reading at rest */
    double settled; /* m of deflection during which the cell's filter settles */
    double stretch; /* m of deflection over which the slope is measured */
    int n_beyond;   /* consecutive readings beyond the noise */
    bool is_taut;
    double taut; /* m, deflection at which the strand was found taut */
    /* Regression of tension (N) on deflection (m) over the stretch. */
    int n;
    double mean_deflection, mean_tension, squares, products;
};

/* Initialises for the cell of a rig; `noise` (N) was measured by the tare. */
void wb_first_force_begin(struct wb_first_force *force, double noise, const struct wb_rig *rig);

/* Adds a reading during loading: `tension` (N, reading less the tare) at `deflection` (m, of the
 * tip relative to the clamp). The verdict stays open until 20 readings over 1.5 mm of deflection
 * follow the taut strand. If it is WRONG, `text` holds the cause and the remedy. */
enum wb_first_force_verdict wb_first_force_add(struct wb_first_force *force, double deflection,
                                               double tension,
                                               const struct wb_first_force_bounds *bounds,
                                               char text[WB_START_CHECK_TEXT]);

/* Slope of force over deflection in the stretch, N/m. */
double wb_first_force_slope(const struct wb_first_force *force);

#endif
