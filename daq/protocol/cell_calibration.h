/* What readings of the load cell under known masses say of the cell: the deviation at one mass, and
 * of a series up and down the quantities of a calibration. Pure functions.
 *
 * A least-squares line goes through all points, reading over mass. Fractions are of the span, the
 * largest mass less the smallest.
 *
 * - span: slope of the line against what the rig file's unit and scale say, less 1; its standard
 *   uncertainty from the scatter of the points around the line;
 * - linearity: the point farthest from the line;
 * - hysteresis: of masses read on the way up and on the way down, the largest difference of both
 *   means. A mass is on the way up when it is larger than the one before;
 * - repeatability: standard deviation of readings of the same mass reached from the same side,
 *   over all masses; its standard uncertainty is itself over sqrt(2 degrees of freedom);
 * - zero return: the last reading at 0 less the first.
 *
 * Standard uncertainties are those of the means (struct wb_cell_point). Those of the masses
 * themselves and of gravity come on top and are not known here. Terms as in OIML R 60 (load cells).
 */
#ifndef WB_DAQ_PROTOCOL_CELL_CALIBRATION_H
#define WB_DAQ_PROTOCOL_CELL_CALIBRATION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "daq/protocol/rig.h"

/* One mass and what the cell read. */
struct wb_cell_point {
    double mass;        /* kg, hung */
    double reading, sd; /* N: the mean, and the standard deviation of one reading */
    int64_t n;          /* readings */
    /* N, standard error of the mean: the larger of sd/sqrt(n) and what the means of eight equal
     * parts of the time give. Readings behind a filter follow each other, and the first is then too
     * small. */
    double uncertainty;
};

/* One mass against zero. */
struct wb_cell_deviation {
    double mass;        /* kg, read: (reading - zero) / g */
    double deviation;   /* kg, read less known */
    double relative;    /* deviation over the known mass; NaN at 0 */
    double uncertainty; /* kg, standard, of both means */
};

/* `zero` and `point` may be the same. */
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
    bool known;         /* false: the series does not show it */
    double value;       /* fraction of the span; with its sign where it has one */
    double uncertainty; /* the same, standard */
    double at;          /* kg: the mass where it was found; NaN: none */
    bool passed;        /* known, and |value| within the tolerance */
};

struct wb_cell_calibration {
    double slope, offset;            /* of the line: kg read over kg hung, and kg read at 0 */
    double scatter;                  /* kg, standard deviation of the points around the line */
    double span;                     /* kg */
    double residuals[WB_RIG_MASSES]; /* kg, of each point */
    bool is_down[WB_RIG_MASSES];     /* the mass is smaller than the one before */
    struct wb_cell_result results[WB_CELL_QUANTITIES];
    bool passed; /* all that are known */
};

/* What a series must be: it begins with 0 (the zero), has at least two other masses that differ,
 * and at most WB_RIG_MASSES. False with the `problem`. */
bool wb_cell_calibration_check(const double *masses, int n, char *problem, size_t size);

/* A list as it is written, grams between commas ("0,5,10,5,0"), into kg, checked as above. Returns
 * how many; 0 with the `problem`. */
int wb_cell_calibration_parse(const char *text, double masses[WB_RIG_MASSES], char *problem,
                              size_t size);

/* The series' quantities, each held against `tolerance` (a fraction). The masses passed the check
 * above. */
void wb_cell_calibration_compute(struct wb_cell_calibration *calibration,
                                 const struct wb_cell_point *points, int n, double gravity,
                                 double tolerance);

#endif
