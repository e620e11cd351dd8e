/* The tape around a bundle: how its windings lie on the outline.
 *
 * A sleeve is a closed tube of some layers. A helix is one tape of a width w, wound with an advance
 * p along the bundle for each turn round the outline's length C. Rolled out it is a strip at the
 * angle tan a = p / C to the circumference that covers c = w / cos a along the bundle. Each winding
 * covers the part 1 - p / c of the one before; half-lapped that is a half, and there are c / p = 2
 * layers everywhere.
 */
#ifndef WB_FE_MODEL_TAPING_H
#define WB_FE_MODEL_TAPING_H

#include "base/status.h"

enum wb_taping_kind {
    WB_TAPING_SLEEVE,
    WB_TAPING_HELIX
};

struct wb_taping_helix {
    double width; /* w, m */
    double lap;   /* part of a winding that the next winding covers, 0 to 0.95 */
    int hand;     /* 1: as a right-handed screw, -1: left-handed */
};

struct wb_taping {
    enum wb_taping_kind kind;
    double layer_thickness;         /* m */
    double circumference;           /* C, m: of the outline at the middle of the tape */
    double layers;                  /* an integer for a sleeve, the mean for a helix */
    struct wb_taping_helix helix;   /* of a helix, as the following fields */
    double advance, angle, covered; /* p, m; a, rad; c, m */
};

/* A closed tube of whole layers. */
WB_MUST_CHECK enum wb_status wb_taping_sleeve(struct wb_taping *taping, double circumference,
                                              double layer_thickness, int layers);

/* Fails if the tape is too wide to be wound around the bundle. */
WB_MUST_CHECK enum wb_status wb_taping_wind(struct wb_taping *taping, double circumference,
                                            double layer_thickness,
                                            const struct wb_taping_helix *helix);

/* Thickness of all layers on average, m; area of tape, all layers, for a length of bundle, m2/m. */
double wb_taping_thickness(const struct wb_taping *taping);
double wb_taping_area(const struct wb_taping *taping);

#endif
