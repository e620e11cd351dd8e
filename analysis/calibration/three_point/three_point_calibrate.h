/* Calibration of one wire on three-point bending tests: each specimen is fitted by itself
 * (analysis/calibration/three_point/three_point_fit.h), and what the curves do not tell is varied.
 *
 * A number's interval is that of the mean of its logarithms (Student's t, 95 %) over specimens, or,
 * where specimens belong to more than one series, over the means of the series: what a series has
 * in common is not averaged away by its specimens. Of one alone it is two standard errors of its
 * fit, with the first contact's. Beside it stands the range of the number over friction and nose
 * radius: the machine's bands, or where it says nothing, 0 to 0.6, and half to two and a half times
 * the rollers' radius.
 */
#ifndef WB_ANALYSIS_CALIBRATION_THREE_POINT_THREE_POINT_CALIBRATE_H
#define WB_ANALYSIS_CALIBRATION_THREE_POINT_THREE_POINT_CALIBRATE_H

#include <stdbool.h>

#include "analysis/calibration/cycle/cycle_calibrate.h"
#include "analysis/calibration/three_point/three_point_data.h"
#include "analysis/calibration/three_point/three_point_fit.h"

/* Largest misfit, over F_max, of a law that both ways support. */
#define WB_THREE_POINT_LARGEST_SUPPORTED 5e-3

enum {
    WB_THREE_POINT_MOMENTS = 5
};

struct wb_three_point_member {
    struct wb_three_point_data data;
    bool is_fitted;
    struct wb_three_point_fit fit;
    double rigidity, rigidity_error;       /* N m2; of its logarithm */
    double moment[WB_THREE_POINT_MOMENTS]; /* N m */
    double moment_error[WB_THREE_POINT_MOMENTS];
    struct wb_reason why; /* where it could not be fitted */
};

/* One number of the bench at one end of its band. */
struct wb_three_point_variant {
    const char *name;                      /* "friction", "nose radius" */
    double value;                          /* SI */
    bool is_possible;                      /* all specimens could be fitted so */
    double misfit;                         /* RMS over the specimens */
    double rigidity;                       /* over that of the bench as taken */
    double moment[WB_THREE_POINT_MOMENTS]; /* the same */
};
enum {
    WB_THREE_POINT_VARIANTS = 4
};

struct wb_three_point_calibration {
    int n_members, n_fitted, n_series;
    struct wb_three_point_member *members; /* (n_members), owned */
    struct wb_three_point_bench bench;     /* as taken: known, or the middle of the band */
    struct wb_three_point_strains strains; /* of the parts of all laws */
    bool is_compliance_known;              /* else taken as none */
    double misfit;                         /* RMS over the specimens */
    double series_deviation;               /* s of ln EI between the means of series; NaN: one */
    double largest_curvature;              /* 1/m */
    struct wb_estimate rigidity;
    /* Every test has unloading: a loading alone, whose first points the seating takes, leaves EI
     * to the law's form where the wire yields early. */
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
    int threads;                                        /* 0: as many as there are processors */
    bool (*progress)(void *context, int done, int all); /* NULL; false stops. One at a time. */
    void *progress_context;
};
enum {
    WB_THREE_POINT_CALIBRATE_TABLES = 2
};
extern const struct wb_setting_table
    wb_three_point_calibrate_tables[WB_THREE_POINT_CALIBRATE_TABLES];

/* The bench as it is taken for: what the machine file says, or the middle of its band, or of the
 * one above where it says nothing; no compliance where it says none. `ends` receives name and value
 * of the bands' ends. */
void wb_three_point_calibrate_bench(const struct wb_machine *machine,
                                    struct wb_three_point_bench *bench,
                                    struct wb_three_point_variant ends[WB_THREE_POINT_VARIANTS]);

/* WB_ERR_DATA for datasets of several wires or benches, or where none can be fitted; WB_ERR_TIMEOUT
 * where `progress` stopped it. The reason goes to `why` (NULL: logged). */
WB_MUST_CHECK enum wb_status wb_three_point_calibrate_run(
    struct wb_three_point_calibration *calibration, const struct wb_dataset *const *datasets, int n,
    const struct wb_three_point_calibrate_settings *settings, struct wb_reason *why);
/* The law whose stress at any strain is the mean over the fitted members: the arithmetic mean of
 * their moduli, as all have the same yield strains. (Parts trade with their neighbours: where one
 * fit has most in this part and another in the next, geometric means have little in both.)
 * `without` leaves out one of them by its index (-1: none); there must be another. */
void wb_three_point_calibrate_law(const struct wb_three_point_calibration *calibration, int without,
                                  struct wb_law *law);

void wb_three_point_calibrate_release(struct wb_three_point_calibration *calibration);

#endif
