/* Points of a three-point bending test for fits: zero of the force, first contact, usable range,
 * and an even grid of the first loading and of the unloading, if there is one.
 *
 * The first contact is not visible: the force rises gradually, and a wire that is not quite
 * straight is seated on the rollers before it bends. Below about a hundredth of the span the
 * seating dominates. So the points begin above it, and the first contact is a parameter of the fit,
 * for which the initial guess is found here.
 */
#ifndef WB_ANALYSIS_CALIBRATION_THREE_POINT_THREE_POINT_DATA_H
#define WB_ANALYSIS_CALIBRATION_THREE_POINT_THREE_POINT_DATA_H

#include <stdbool.h>

#include "analysis/dataset/dataset.h"
#include "base/reason.h"
#include "base/setting.h"
#include "base/status.h"

enum wb_three_point_limit {
    WB_THREE_POINT_LIMIT_END,   /* of the loading */
    WB_THREE_POINT_LIMIT_GIVEN, /* by the settings or the specimen */
    WB_THREE_POINT_LIMIT_KINK,  /* the force drops: the wire slips */
    WB_THREE_POINT_LIMIT_THIRD, /* a third of the span, the limit of the model's verification */
    WB_THREE_POINT_LIMITS
};

/* "end of the loading", "given", "kink", "third of the span" */
const char *wb_three_point_limit_name(enum wb_three_point_limit limit);

struct wb_three_point_point {
    double travel; /* m, of the machine */
    double force;  /* N, zeroed */
    bool is_unloading;
};

struct wb_three_point_data {
    struct wb_test_info info;
    int n_points;
    struct wb_three_point_point *points; /* owned; loading first, in the order of the test */
    bool has_unloading;
    double zero_force;    /* N, subtracted */
    bool is_zeroed;       /* there were readings before the contact for the zero */
    double first_contact; /* m of travel: initial guess */
    double noise;         /* N, of a reading */
    double max_force;     /* N, of the points */
    double usable;        /* m of travel: the last one used */
    enum wb_three_point_limit limit;
};

struct wb_three_point_data_settings {
    double seating; /* of the span, beyond the first contact: beginning of the points */
    double usable;  /* m of travel; 0: from the specimen file, else up to a kink */
    double step;    /* of the span, between points */
};
enum {
    WB_THREE_POINT_DATA_ROWS = 3
};
extern const struct wb_setting wb_three_point_data_rows[WB_THREE_POINT_DATA_ROWS];

/* WB_ERR_DATA if a test cannot be fitted; `why` receives the reason (NULL: logged). */
WB_MUST_CHECK enum wb_status
wb_three_point_data_make(struct wb_three_point_data *data, const struct wb_dataset *dataset,
                         const struct wb_three_point_data_settings *settings,
                         struct wb_reason *why);
/* Number of points of the loading. */
int wb_three_point_data_count_loading(const struct wb_three_point_data *data);
/* Force at a travel, linear between the points of the loading or of the unloading, and extrapolated
 * linearly beyond them. */
double wb_three_point_data_force(const struct wb_three_point_data *data, double travel,
                                 bool is_unloading);
void wb_three_point_data_release(struct wb_three_point_data *data); /* accepts a zeroed one */

#endif
