/* Calibrated properties as a file: PROPERTIES.yaml, written by calibrate, read by validate.
 *
 *     wire: type1
 *     outer_diameter_mm: 1.1
 *     mass_per_length_kg_m: 0.00386
 *     youngs_modulus_MPa: 5021
 *     yield_stress_MPa: 3.9
 *     strength_coefficient_MPa: 3222
 *     hardening_exponent: 0.99
 *     poissons_ratio: 0.39
 *     deviations: {...}           # known standard uncertainties
 *     calibration: {...}          # length, elastic zone, yield point, RMS, stop reason, datasets
 *                                 # with sha256, tool revision, whether on a virtual rig
 *
 * A calibration on whole cycles adds
 *
 *     method: cycle
 *     law: {...}     # fe/material/law_file.h; the four numbers are then its equivalent
 *     ...: the quantities of quantity.h, each {value: 210, low: 200, high: 221,
 *          candidates_low: 209, ...} or a list of these at several curvatures
 *     largest_curvature_1_m: 29
 *     hardening_rule: {chosen: ..., supported: true, ...}
 *     ludwik_misfit: 0.004
 *     specimens: [{sample: 1, length_mm: 85, bow_mm: 1.2, uneven_bow_mm: 0.1, level_mm: 0, misfit:
 * 0.0007, and the four numbers of its own Ludwik equivalent}, ...]
 */
#ifndef WB_ANALYSIS_CALIBRATION_PROPERTIES_PROPERTIES_H
#define WB_ANALYSIS_CALIBRATION_PROPERTIES_PROPERTIES_H

#include <stdbool.h>

#include "analysis/calibration/cycle/cycle_calibrate.h"
#include "analysis/calibration/paper/calibrate.h"
#include "analysis/calibration/three_point/three_point_calibrate.h"
#include "base/hash.h"
#include "base/status.h"
#include "base/text.h"
#include "fe/material/law.h"
#include "fe/model/wire.h"

enum {
    WB_PROPERTIES_MOST_SPECIMENS = 100,
    WB_PROPERTIES_MOST_MOMENTS = 20,
    WB_PROPERTIES_MOST_DATASETS = 100
};

/* A dataset or recording from which a calibration was made. */
struct wb_properties_dataset {
    char name[96];               /* last part of its folder or path */
    char sha256[WB_SHA256_TEXT]; /* of its force_deflection.csv, or of the recording; "": unknown */
    bool is_recording; /* or a machine's file; read without a dataset folder, as reports do */
};

/* Results of one specimen. */
struct wb_properties_specimen {
    int sample;
    double length;             /* m */
    double bow, bow_deviation; /* m, natural offset of the tip; NaN unknown */
    double uneven_bow; /* m, of the middle relative to that of a uniform curvature; NaN unknown */
    double level;      /* m, of zero deflection */
    double misfit;     /* RMS of the force residuals over F_max */
    struct wb_material ludwik; /* equivalent on a first loading */
    double ludwik_misfit;      /* RMS of the relative differences of M */
};

struct wb_properties {
    char wire[64];
    double outer_diameter;  /* m */
    double mass_per_length; /* kg/m */
    struct wb_material material;
    double deviation[4];       /* of E, sigma_Y, ln K, n in SI; NaN unknown */
    double calibration_length; /* m; NaN unless from a calibration */
    double rms;                /* of the calibration, 1; NaN unknown */
    double scatter_rms,
        residual_scatter_rms;   /* of the calibration's samples, over F_max (a follower
                                   test's largest deflection), 1; NaN unknown */
    double stiffness_deviation; /* standard deviation of ln(M) over the calibration's samples; NaN
                                   unknown */
    int n_samples;              /* of the calibration; 0 unknown */
    int n_series;               /* number of series of three-point tests; 0 unknown */
    int pooled_degrees; /* degrees of freedom of a deviation pooled over several wires, for all
                           intervals; 0: the deviation is that of this wire's specimens */
    bool is_virtual;    /* from the virtual rig */
    bool is_simulation; /* from a computation */
    char method[16];    /* "cycle", "paper", "three-point"; "" for a file written by hand */
    char tool[96];      /* that made the calibration; "" unknown */
    int n_datasets;     /* total number */
    struct wb_properties_dataset datasets[WB_PROPERTIES_MOST_DATASETS]; /* the first ones */
    /* The law, whose Ludwik equivalent is `material`; for files without a law Ludwik's with
     * isotropic hardening, of `material`. */
    struct wb_law law;
    double ludwik_misfit;                                  /* of `material`, of M; NaN unknown */
    double largest_curvature;                              /* 1/m, of the data; NaN unknown */
    struct wb_estimate rigidity, residual_curvature_ratio; /* N m2, 1; NaN unknown */
    struct wb_cycle_stiffness secant, unloading;           /* without entries unknown */
    struct wb_estimate springback;                         /* of the deflection, 1; NaN unknown */
    struct wb_estimate loop_energy; /* J/m, of a loop to the largest curvature; NaN unknown */
    bool is_rule_tested, is_rule_supported;       /* false if unknown */
    int n_moments;                                /* points of the measured law; 0 unknown */
    double curvature[WB_PROPERTIES_MOST_MOMENTS]; /* 1/m */
    struct wb_estimate moment[WB_PROPERTIES_MOST_MOMENTS]; /* N m */
    int n_specimens;                                       /* 0 unknown */
    struct wb_properties_specimen specimens[WB_PROPERTIES_MOST_SPECIMENS];
};

/* Standard deviation of the logarithm of a value between specimens: as given in the file, or for
 * older files, whose interval of 95 % was Student's of the mean of n, from its degrees of
 * freedom. */
double wb_properties_scatter(const struct wb_estimate *estimate, int n, int degrees);

/* Number of means from which the calibration's intervals are made: series if there are several,
 * else samples; 0 unknown. */
int wb_properties_units(const struct wb_properties *properties);

/* Reads a properties file; messages name file, line and key. */
WB_MUST_CHECK enum wb_status wb_properties_read(const char *path, struct wb_properties *properties);
/* Writes a properties file. `names` are the datasets' folders as given. WB_ERR_EXISTS unless
 * `force`. */
WB_MUST_CHECK enum wb_status wb_properties_write(const char *path,
                                                 const struct wb_calibrate_result *result,
                                                 const struct wb_calibrate_settings *settings,
                                                 const char *const *names, int n_names, bool force);
/* The same for a calibration on whole cycles. Only the first WB_PROPERTIES_MOST_SPECIMENS specimens
 * are kept. */
WB_MUST_CHECK enum wb_status
wb_properties_write_cycle(const char *path, const struct wb_cycle_calibration *calibration,
                          const struct wb_cycle_calibrate_settings *settings,
                          const char *const *names, int n_names, bool force);
/* The same for a calibration on three-point bending tests: method `three-point`. */
WB_MUST_CHECK enum wb_status
wb_properties_write_three_point(const char *path,
                                const struct wb_three_point_calibration *calibration,
                                const char *const *names, int n_names, bool force);
/* Appends the text of the same file for a report, whose datasets the caller names with their
 * checksums. */
void wb_properties_format(struct wb_text *text, const struct wb_calibrate_result *result,
                          const struct wb_calibrate_settings *settings,
                          const struct wb_properties_dataset *datasets, int n_datasets);
void wb_properties_format_cycle(struct wb_text *text,
                                const struct wb_cycle_calibration *calibration,
                                const struct wb_cycle_calibrate_settings *settings,
                                const struct wb_properties_dataset *datasets, int n_datasets);
void wb_properties_format_three_point(struct wb_text *text,
                                      const struct wb_three_point_calibration *calibration,
                                      const struct wb_properties_dataset *datasets, int n_datasets);
/* Reads such a text; `origin` is the file's name in messages. `why` receives the reason; NULL: it
 * is logged. */
WB_MUST_CHECK enum wb_status wb_properties_parse(const char *text, const char *origin,
                                                 struct wb_properties *properties,
                                                 struct wb_reason *why);
/* The same properties without a file. */
void wb_properties_from_result(const struct wb_calibrate_result *result,
                               struct wb_properties *properties);
void wb_properties_from_cycle(const struct wb_cycle_calibration *calibration,
                              struct wb_properties *properties);
/* Properties of a calibration on three-point bending tests, without their specimens. */
void wb_properties_from_three_point(const struct wb_three_point_calibration *calibration,
                                    struct wb_properties *properties);
/* Properties from a wire's own file, of which only the law is known. The wire must have
 * properties. */
void wb_properties_from_wire(const struct wb_wire *wire, struct wb_properties *properties);

#endif
