/* Tensile curves of a wire's constituents: conductor, jacket, tape.
 *
 * For each specimen, from its first loading up to the largest force:
 *   1. engineering stress S = F/A over strain e = x/L0, A the area that carries the load (of a
 *      stranded conductor that of the metal), L0 the gauge length; the machine's deformation is
 *      subtracted from a crosshead's travel if its compliance is given;
 *   2. the steepest straight stretch at the start, and the slack: the strain where that line meets
 *      S = 0, which is subtracted. If the curve begins further to the right of that line than the
 *      offset of the proof stress, the start is curved, as for rubber: there is no initial line, no
 *      plastic strain, and none of 4, 6 and 7;
 *   3. the slope of that line. It is Young's modulus only if the elongation is the specimen's own;
 *      with the travel of a crosshead it includes grips and machine, and there is no E;
 *   4. the proof stress: S where the curve meets the line shifted by the offset;
 *   5. true stress sigma = S (1 + e) and true strain eps = ln(1 + e), valid for uniform elongation,
 *      and plastic strain ep = eps - sigma / slope, also with a crosshead, because the slope
 *      includes all strain that is not plastic;
 *   6. sigma at plastic strains of 0.002, 0.01 and 0.05;
 *   7. K and n of sigma = sigma_Y + K ep^n (eq. 6) twice: by eq. 7, the regression of
 *      ln(sigma - sigma_Y) on ln(ep) with the proof stress as sigma_Y, from five times the offset;
 *      and by least squares of eq. 6 itself with sigma_Y free, with the range of n for which the
 *      fit is equally good within the accuracy of the data.
 */
#ifndef WB_ANALYSIS_CALIBRATION_CONSTITUENTS_TENSILE_H
#define WB_ANALYSIS_CALIBRATION_CONSTITUENTS_TENSILE_H

#include <stdbool.h>
#include <stddef.h>

#include "analysis/dataset/dataset.h"
#include "base/reason.h"
#include "base/setting.h"

/* Defaults and ranges: wb_tensile_table. */
struct wb_tensile_settings {
    double proof_offset; /* strain */
    double stretch;  /* part of the largest force that the straight stretch of the start spans at
                        least: with less, the noise of a few points would determine the slope */
    double fit_from; /* plastic strain where the least squares begin */
    double fit_to;   /* where they end; 0: at the largest force */
    double alike;    /* laws fit alike if their root mean square misfit is below this part of the
                        strength: the accuracy of a testing machine of class 1 */
};
extern const struct wb_setting_table wb_tensile_table;

enum {
    WB_TENSILE_STRESSES = 3
};
/* 0.002, 0.01, 0.05 */
extern const double wb_tensile_plastic_strains[WB_TENSILE_STRESSES];

/* sigma_Y + K ep^n. NaN if there is no law. */
struct wb_tensile_law {
    double yield_stress, strength_coefficient; /* Pa */
    double hardening_exponent;                 /* 1 */
    double rms;                                /* Pa, over the points of the least squares */
};

/* One specimen. */
struct wb_tensile_specimen {
    int sample;
    size_t n_points;                    /* of the least squares */
    bool start_is_straight;             /* otherwise quantities that need plastic strain are NaN */
    double slack;                       /* strain */
    double slope;                       /* Pa, of the start */
    double slope_from;                  /* Pa, smallest stress of the stretch */
    double proof_stress;                /* Pa, engineering; NaN: not reached */
    double strength;                    /* Pa, engineering: at the largest force */
    double uniform_strain;              /* engineering strain there */
    double stress[WB_TENSILE_STRESSES]; /* Pa, true; NaN: not reached */
    struct wb_tensile_law direct, eq7;
    double n_low, n_high; /* range of exponents that fit alike; NaN: none fits */
    bool n_is_cut;        /* the range is limited by the exponents that were tried */
};

/* A value over the specimens: mean of its logarithms, and Student's 95 % interval of that mean; low
 * and high are NaN with one specimen. n = 0: no specimen has it. */
struct wb_tensile_number {
    int n;
    double mean, low, high;
};

struct wb_tensile_result {
    char wire[64];
    enum wb_constituent constituent;
    bool own_elongation;
    double area, gauge_length; /* m2, m, of the first specimen */
    int n_specimens;
    struct wb_tensile_specimen *specimens;   /* (n_specimens), owned */
    struct wb_tensile_number youngs_modulus; /* n = 0 unless the elongation is the specimens' own */
    struct wb_tensile_number slope, proof_stress, strength, uniform_strain;
    struct wb_tensile_number stress[WB_TENSILE_STRESSES];
    struct wb_tensile_number direct_yield, direct_strength, direct_exponent;
    struct wb_tensile_number eq7_strength, eq7_exponent;
    /* Least squares on the mean of the specimens' true curves: unlike the means above, these
     * parameters are consistent with each other. NaN if there is no law. */
    struct wb_tensile_law of_mean;
    double of_mean_n_low,
        of_mean_n_high;   /* range of exponents that fit that curve alike; NaN: none fits */
    double n_low, n_high; /* smallest and largest exponent that fits alike in any specimen */
    int n_followed;       /* specimens whose curve Ludwik's law fits within `alike` */
    bool follows;         /* all specimens are */
    bool identifiable;    /* n is known within a factor of 1.25 */
};

/* Fills in the defaults. */
void wb_tensile_default_settings(struct wb_tensile_settings *settings);

/* Evaluates n tensile datasets of one wire and constituent. WB_ERR_DATA if they are not, or if a
 * curve has no straight start or too few points; WB_ERR_UNSUPPORTED for datasets of another kind.
 * `why` receives the reason (NULL: logged). Release with wb_tensile_release(). */
WB_MUST_CHECK enum wb_status wb_tensile_run(struct wb_tensile_result *result,
                                            const struct wb_dataset *const *datasets, int n,
                                            const struct wb_tensile_settings *settings,
                                            struct wb_reason *why);
void wb_tensile_release(struct wb_tensile_result *result); /* accepts a zeroed one */

#endif
