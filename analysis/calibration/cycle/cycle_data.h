/* Data of one cycle of a test (by default the first), reduced to a few hundred points with little
 * noise: tension over deflection on loading and unloading, and the places of the markers between
 * clamp and tip.
 *
 * The tension is as measured, weights included, not zeroed at zero deflection, because its absolute
 * value depends on the natural shape of the wire. A point is the mean deflection and the mean
 * tension of a bin; the slope of a line over the deflection, which has noise too, would be too
 * small. Outliers are left out and counted. The loading begins at zero deflection. The unloading
 * begins half a millimetre below the turn, after the change of direction, and ends before the
 * strand becomes slack. Of a simulation, which has no noise, every row is a point.
 */
#ifndef WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_DATA_H
#define WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_DATA_H

#include <stdbool.h>

#include "analysis/dataset/dataset.h"
#include "base/reason.h"
#include "base/setting.h"
#include "base/status.h"

enum {
    WB_CYCLE_MOST_HELD = 10
};

struct wb_cycle_point {
    double deflection, tension; /* m, N */
    double t;                   /* s, mean of the rows */
    double deviation;           /* N: standard error of the tension by the scatter of the rows */
    bool is_unloading;
    int n_rows;
};

/* Tension while the tip was held at the turn. */
struct wb_cycle_held {
    double t, tension; /* s, N: means */
    double deviation;  /* N: standard error */
};

/* A marker's place at the deflection of a point. */
struct wb_cycle_place {
    int point;   /* index of the point */
    int marker;  /* from 0 among the inner markers */
    double s;    /* m, arc length */
    double x, y; /* m */
};

struct wb_cycle_data {
    struct wb_test_info info;
    int n_points, n_loading;       /* the loading's points come first, upwards; then downwards */
    struct wb_cycle_point *points; /* owned */
    int n_places, n_markers;
    struct wb_cycle_place *places; /* owned; of the first cycle only */
    double top;                    /* m: deflection of the turn */
    double arrival, departure;     /* s: arrival at the turn and departure from it */
    int n_held;                    /* 0: no dwell */
    struct wb_cycle_held held[WB_CYCLE_MOST_HELD];
    double max_force;           /* N: largest tension minus that at zero deflection */
    double zero_tension;        /* N: tension at zero deflection on the first loading */
    double residual_deflection; /* m: deflection at which the tension of the unloading equals that
                                   at zero deflection; NaN: not reached */
    int n_outliers;             /* rows left out */
};

/* Time of the loading, from its first point, s. */
static inline double wb_cycle_data_loading_time(const struct wb_cycle_data *data)
{
    return data->arrival - data->points[0].t;
}

struct wb_cycle_data_settings {
    int cycle;               /* from 1; 0: 1 */
    double step;             /* m between points; 0: 1 mm */
    double fine_step;        /* m, of the first points of either branch; 0: 0.5 mm */
    double fine_reach;       /* m: range of the fine step; 0: 4 mm */
    double turn_distance;    /* m below the turn where the unloading begins; 0: 0.5 mm */
    double smallest_tension; /* N: where the unloading ends; 0: 2.5 mN */
    double marker_step;      /* m of deflection between places; 0: 4 mm */
};

/* Rows of the settings, with range and default. */
enum {
    WB_CYCLE_DATA_ROWS = 6
};
extern const struct wb_setting wb_cycle_data_rows[WB_CYCLE_DATA_ROWS];

/* Takes the data of a cycle. WB_ERR_DATA if the cycle gives too few points, or for a test with a
 * follower force. Without unloading, n_loading equals n_points. `settings` NULL: defaults. `why`
 * receives the reason; NULL: it is logged. */
WB_MUST_CHECK enum wb_status wb_cycle_data_take(struct wb_cycle_data *data,
                                                const struct wb_dataset *dataset,
                                                const struct wb_cycle_data_settings *settings,
                                                struct wb_reason *why);
void wb_cycle_data_release(struct wb_cycle_data *data); /* accepts a zeroed one */

#endif
