/* Calibration of one wire on three-point bending tests: each specimen is fitted separately
 * (analysis/calibration/three_point/three_point_fit.h), and parameters that the curves do not
 * determine are varied.
 *
 * A value's interval is that of the mean of its logarithms (Student's t, 95 %) over specimens, or,
 * if specimens belong to more than one series, over the means of the series: what the specimens of
 * a series have in common does not average out. For a single specimen it is two standard errors of
 * its fit, including the first contact's. In addition, the range of the value over friction and
 * nose radius is given: over the machine file's ranges, or if it gives none, 0 to 0.6, and half to
 * two and a half times the rollers' radius.
 */
#ifndef WB_ANALYSIS_CALIBRATION_THREE_POINT_THREE_POINT_CALIBRATE_H
#define WB_ANALYSIS_CALIBRATION_THREE_POINT_THREE_POINT_CALIBRATE_H

#include <stdbool.h>

#include "analysis/calibration/cycle/cycle_calibrate.h"
#include "analysis/calibration/three_point/three_point_data.h"
#include "analysis/calibration/three_point/three_point_fit.h"

/* Largest misfit, over F_max, of a law that fits loading and unloading. */
#define WB_THREE_POINT_LARGEST_SUPPORTED 5e-3

enum {
    WB_THREE_POINT_MOMENTS = 5
};

struct wb_three_point_member {
    struct wb_three_point_data data;
    bool is_fitted;
    struct wb_three_point_fit fit;
    double rigidity, rigidity_error;       /* N m2; error of its logarithm */
    double moment[WB_THREE_POINT_MOMENTS]; /* N m */
    double moment_error[WB_THREE_POINT_MOMENTS];
    struct wb_reason why; /* why it could not be fitted */
};

/* One parameter of the bench at one end of its range. */
struct wb_three_point_variant {
    const char *name;                      /* "friction", "nose radius" */
    double value;                          /* SI */
    bool is_possible;                      /* all specimens could be fitted with it */
    double misfit;                         /* RMS over the specimens */
    double rigidity;                       /* relative to that of the nominal bench */
    double moment[WB_THREE_POINT_MOMENTS]; /* likewise */
};
enum {
    WB_THREE_POINT_VARIANTS = 4
};

struct wb_three_point_calibration {
    int n_members, n_fitted, n_series;
    struct wb_three_point_member *members; /* (n_members), owned */
    struct wb_three_point_bench bench;     /* nominal: known exactly, or the middle of the range */
    struct wb_three_point_strains strains; /* of the parts of all laws */
    bool is_compliance_known;              /* else assumed to be 0 */
    double misfit;                         /* RMS over the specimens */
    double series_deviation;  /* s of ln EI between the means of series; NaN: a single series */
    double largest_curvature; /* 1/m */
    struct wb_estimate rigidity;
    /* Every test has an unloading. With a loading alone, whose first points are excluded by the
     * seating, EI depends on the form of the law if the wire yields early. */
    bool is_rigidity_identifiable;
    double curvature[WB_THREE_POINT_MOMENTS];
    struct wb_estimate moment[WB_THREE_POINT_MOMENTS];
    struct wb_law law; /* mean */
    struct wb_material ludwik;
    double ludwik_misfit;
    struct wb_three_point_variant variants[WB_THREE_POINT_VARIANTS];
    double cpu_s;
};

struct wb_three_point_calibrate_settings {
    struct wb_three_point_data_settings data;
    struct wb_three_point_fit_settings fit;
    int threads; /* 0: number of processors */
    /* Called by one thread at a time; false stops; NULL: none. */
    bool (*progress)(void *context, int done, int all);
    void *progress_context;
};
enum {
    WB_THREE_POINT_CALIBRATE_TABLES = 2
};
extern const struct wb_setting_table
    wb_three_point_calibrate_tables[WB_THREE_POINT_CALIBRATE_TABLES];

/* The nominal bench: values from the machine file, or the middle of their range, or of the range
 * above if the file gives none; compliance 0 if the file gives none. `ends` receives name and value
 * of the ends of the ranges. */
void wb_three_point_calibrate_bench(const struct wb_machine *machine,
                                    struct wb_three_point_bench *bench,
                                    struct wb_three_point_variant ends[WB_THREE_POINT_VARIANTS]);

/* WB_ERR_DATA for datasets of several wires or benches, or if none can be fitted; WB_ERR_TIMEOUT if
 * `progress` stopped it. `why` receives the reason (NULL: logged). */
WB_MUST_CHECK enum wb_status wb_three_point_calibrate_run(
    struct wb_three_point_calibration *calibration, const struct wb_dataset *const *datasets, int n,
    const struct wb_three_point_calibrate_settings *settings, struct wb_reason *why);
/* The law whose stress at any strain is the mean over the fitted members: the arithmetic mean of
 * their moduli, as all have the same yield strains. (Moduli of neighbouring parts are correlated:
 * where two fits have their largest modulus in different parts, geometric means would be small in
 * both.) `without` leaves out one member by its index (-1: none); another must remain. */
void wb_three_point_calibrate_law(const struct wb_three_point_calibration *calibration, int without,
                                  struct wb_law *law);

void wb_three_point_calibrate_release(struct wb_three_point_calibration *calibration);

#endif
