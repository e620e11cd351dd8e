/* The quantities that a calibration of bending gives, each with its value, its interval of 95 % and
 * its range over the laws that the data do not exclude.
 *
 * One row describes a quantity. Properties files, JSON, the terminal and comparisons use the rows,
 * so that a quantity has one key, one name and one unit everywhere.
 */
#ifndef WB_ANALYSIS_CALIBRATION_PROPERTIES_QUANTITY_H
#define WB_ANALYSIS_CALIBRATION_PROPERTIES_QUANTITY_H

#include <stdbool.h>
#include <stddef.h>

#include "analysis/calibration/cycle/cycle_calibrate.h"
#include "base/json.h"

struct wb_properties;

/* The main results first. */
enum wb_quantity_id {
    WB_QUANTITY_MOMENT,
    WB_QUANTITY_UNLOADING_STIFFNESS,
    WB_QUANTITY_RESIDUAL_CURVATURE_RATIO,
    WB_QUANTITY_SPRINGBACK,
    WB_QUANTITY_LOOP_ENERGY,
    WB_QUANTITY_SECANT_STIFFNESS,
    WB_QUANTITY_RIGIDITY,
    WB_QUANTITIES
};

struct wb_quantity {
    const char *key;       /* in files, including the unit */
    const char *value_key; /* of its value in files, next to "low", "high" and so on */
    const char *name;      /* in text; followed by the curvature if the quantity has one */
    const char *unit;      /* in text; "" for a ratio */
    const char *meaning;   /* for the documentation of files, without a full stop */
    double scale;          /* SI value of one unit */
    double largest;        /* largest value accepted in a file, in the unit */
    /* Offsets in struct wb_properties. */
    size_t estimate;  /* of one estimate, or of at most `most` */
    int most;         /* largest number of curvatures; 0: the quantity has none */
    size_t n;         /* of their number, and */
    size_t curvature; /* of their curvatures, 1/m */
    size_t resolved;  /* of the smallest curvature that the data resolve, 1/m; 0: not stated */
};

extern const struct wb_quantity wb_quantity_rows[WB_QUANTITIES];

/* Values of a quantity from properties; borrowed. An unknown estimate is NaN. */
struct wb_quantity_values {
    int n;                              /* 1 for a quantity without curvatures */
    const double *curvature;            /* 1/m, (n); NULL: no curvatures */
    const struct wb_estimate *estimate; /* (n), SI */
    double resolved;                    /* 1/m; NaN: not stated */
};
struct wb_quantity_values wb_quantity_values(const struct wb_properties *properties,
                                             enum wb_quantity_id id);

/* Whether there is a value, or at least a range over laws. */
bool wb_quantity_is_known(const struct wb_estimate *estimate);

enum {
    WB_QUANTITY_LABEL = 64
};
/* Its name, with the curvature (1/m) if it has one: "M at 1.41 /m". */
const char *wb_quantity_label(enum wb_quantity_id id, double curvature,
                              char label[WB_QUANTITY_LABEL]);

/* Sets a member for each quantity; unknown values are null. For three-point bending only known ones
 * are set. */
void wb_quantity_put(struct wb_json *object, const struct wb_properties *properties);

#endif
