/* A three-point bending test as points to fit: zero of the force, first contact, usable range, and
 * an even grid of the first loading and, where there is one, the unloading.
 *
 * Where the wire was first touched is not seen: the force rises from nothing, and a wire that is
 * not quite straight settles on its rollers before it bends. Below some hundredth of the span that
 * settling decides. So the points begin above it, and the first contact is left to the fit; what is
 * found here is where it looks first.
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
    WB_THREE_POINT_LIMIT_KINK,  /* the force breaks down: the wire slips */
    WB_THREE_POINT_LIMIT_THIRD, /* a third of the span, up to where the model is verified */
    WB_THREE_POINT_LIMITS
};

/* "end of the loading", "given", "kink", "third of the span" */
const char *wb_three_point_limit_name(enum wb_three_point_limit limit);

struct wb_three_point_point {
    double travel; /* m, as the machine has it */
    double force;  /* N, zeroed */
    bool is_unloading;
};

struct wb_three_point_data {
    struct wb_test_info info;
    int n_points;
    struct wb_three_point_point *points; /* owned; loading first, in the order of the test */
    bool has_unloading;
    double zero_force;    /* N, taken off */
    bool is_zeroed;       /* there were readings before the contact to take it from */
    double first_contact; /* m of travel: where to look first */
    double noise;         /* N, of a reading */
    double max_force;     /* N, of the points */
    double usable;        /* m of travel: the last that is used */
    enum wb_three_point_limit limit;
};

struct wb_three_point_data_settings {
    double seating; /* of the span, beyond the first contact: points begin there */
    double usable;  /* m of travel; 0: as the specimen says, else a kink */
    double step;    /* of the span, between points */
};
enum {
    WB_THREE_POINT_DATA_ROWS = 3
};
extern const struct wb_setting wb_three_point_data_rows[WB_THREE_POINT_DATA_ROWS];

/* WB_ERR_DATA where a test cannot be fitted, with the reason in `why` (NULL: logged). */
WB_MUST_CHECK enum wb_status
wb_three_point_data_make(struct wb_three_point_data *data, const struct wb_dataset *dataset,
                         const struct wb_three_point_data_settings *settings,
                         struct wb_reason *why);
/* How many of its points are of the loading. */
int wb_three_point_data_count_loading(const struct wb_three_point_data *data);
/* Force at a travel between the points of the loading or of the unloading (straight lines; before
 * and beyond them the first or last goes on). */
double wb_three_point_data_force(const struct wb_three_point_data *data, double travel,
                                 bool is_unloading);
void wb_three_point_data_release(struct wb_three_point_data *data); /* accepts a zeroed one */

#endif
