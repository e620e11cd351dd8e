/* The first force of a test: where the strand has become taut, the reading must rise as the wire is
 * bent, and as steeply as a wire of its kind can be. A cell that reads the other way round, another
 * unit, or another specimen shows here, while the specimen is still whole.
 */
#ifndef WB_DAQ_TEST_FIRST_FORCE_H
#define WB_DAQ_TEST_FIRST_FORCE_H

#include <stdbool.h>

#include "daq/protocol/rig.h"
#include "daq/test/start_check.h"

/* What is believed of the slope of force over deflection at the tip. All zero: nothing is known,
 * and only its sign is judged. */
struct wb_first_force_bounds {
    double lowest, highest; /* N/m */
    char of[160];           /* what they belong to, for messages: "the properties in FILE" */
};

enum wb_first_force_verdict {
    WB_FIRST_FORCE_OPEN, /* too little was seen so far */
    WB_FIRST_FORCE_AGREES,
    WB_FIRST_FORCE_WRONG
};

struct wb_first_force {
    double noise;   /* N, standard deviation of a reading at rest */
    double settled; /* m of deflection that the cell's filter needs to follow the force */
    double stretch; /* m of deflection that is judged */
    int n_beyond;   /* readings in a row that are no noise */
    bool is_taut;
    double taut; /* m, deflection where the strand was found taut */
    /* Of the readings in the stretch that is judged: deflection (m) and tension (N). */
    int n;
    double mean_deflection, mean_tension, squares, products;
};

/* Prepares for a rig's cell: `noise` (N) is what the tare has measured. */
void wb_first_force_begin(struct wb_first_force *force, double noise, const struct wb_rig *rig);

/* A reading on the way down: `tension` (N, of the strand) at `deflection` (m, of the tip against
 * the clamp). Says whether the force agrees with the bounds, once it has been followed for long
 * enough (1.5 mm beyond the taut strand and 20 readings); where it does not, `text` says what is
 * wrong and how to mend it. */
enum wb_first_force_verdict wb_first_force_add(struct wb_first_force *force, double deflection,
                                               double tension,
                                               const struct wb_first_force_bounds *bounds,
                                               char text[WB_START_CHECK_TEXT]);

/* Slope of the readings in the stretch that is judged, N/m. */
double wb_first_force_slope(const struct wb_first_force *force);

#endif
