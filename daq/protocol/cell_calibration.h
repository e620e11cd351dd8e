/* Evaluates readings of the load cell under known masses: the deviation at one mass and, for a
 * series of loading and unloading, the quantities of a calibration. Pure functions.
 *
 * A least-squares line of reading over mass is fitted to all points. Fractions refer to the span,
 * the largest mass minus the smallest.
 *
 * - span: slope of the line relative to the unit and scale of the rig file, minus 1; its standard
 *   uncertainty follows from the scatter of the points around the line;
 * - linearity: the point farthest from the line;
 * - hysteresis: largest difference between the mean readings of a mass in loading and in unloading.
 * A mass belongs to loading if it is larger than the one before;
 * - repeatability: standard deviation of readings of the same mass reached from the same side,
 *   over all masses; its standard uncertainty is itself over sqrt(2 degrees of freedom);
 * - zero return: the last reading at 0 minus the first.
 *
 * Standard uncertainties are those of the means (struct wb_cell_point). Those of the masses and of
 * gravity are not included. Terms as in OIML R 60 (load cells).
 */
#ifndef WB_DAQ_PROTOCOL_CELL_CALIBRATION_H
#define WB_DAQ_PROTOCOL_CELL_CALIBRATION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "daq/protocol/rig.h"

/* A mass and the readings of the cell. */
struct wb_cell_point {
    double mass;        /* kg, known */
    double reading, sd; /* N, mean, and standard deviation of a reading */
    int64_t n;          /* number of readings */
    /* N, standard error of the mean: the larger of sd/sqrt(n) and the value from the means of eight
     * equal parts of the time. Filtered readings are correlated, which makes the former too small.
     */
    double uncertainty;
};

/* Deviation of the reading of a mass. */
struct wb_cell_deviation {
    double mass;        /* kg, measured: (reading - zero) / g */
    double deviation;   /* kg, measured minus known mass */
    double relative;    /* deviation divided by the known mass; NaN at 0 */
    double uncertainty; /* kg, standard uncertainty of both means */
};

/* The deviation at `point`, with the zero read at `zero`, which may be the same point. */
struct wb_cell_deviation wb_cell_calibration_deviation(const struct wb_cell_point *zero,
                                                       const struct wb_cell_point *point,
                                                       double gravity);

enum wb_cell_quantity {
    WB_CELL_SPAN,
    WB_CELL_LINEARITY,
    WB_CELL_HYSTERESIS,
    WB_CELL_REPEATABILITY,
    WB_CELL_ZERO_RETURN,
    WB_CELL_QUANTITIES
};

/* "span", "linearity", ... */
const char *wb_cell_calibration_name(enum wb_cell_quantity quantity);

struct wb_cell_result {
    bool known;         /* false: cannot be determined from this series */
    double value;       /* fraction of the span; signed, except for repeatability */
    double uncertainty; /* standard uncertainty, fraction of the span */
    double at;          /* kg, the mass where it was found; NaN: none */
    bool passed;        /* known, and |value| within the tolerance */
};

struct wb_cell_calibration {
    double slope, offset;            /* of the line: kg measured per kg known, and kg at 0 */
    double scatter;                  /* kg, standard deviation of the points around the line */
    double span;                     /* kg */
    double residuals[WB_RIG_MASSES]; /* kg, of each point */
    bool is_down[WB_RIG_MASSES];     /* unloading: the mass is smaller than the one before */
    struct wb_cell_result results[WB_CELL_QUANTITIES];
    bool passed; /* all known quantities passed */
};

/* Checks a series: it must begin with 0 (the zero) and have at least two other different masses and
 * at most WB_RIG_MASSES in total. If not, returns false with the `problem`. */
bool wb_cell_calibration_check(const double *masses, int n, char *problem, size_t size);

/* Parses a list of grams separated by commas ("0,5,10,5,0") into kg and checks it as above. Returns
 * the number of masses, or 0 with the `problem`. */
int wb_cell_calibration_parse(const char *text, double masses[WB_RIG_MASSES], char *problem,
                              size_t size);

/* Computes the quantities of a series and compares each with `tolerance` (a fraction). The masses
 * must have passed the check above. */
void wb_cell_calibration_compute(struct wb_cell_calibration *calibration,
                                 const struct wb_cell_point *points, int n, double gravity,
                                 double tolerance);

#endif
