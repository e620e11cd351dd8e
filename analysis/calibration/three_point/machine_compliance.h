/* Compliance of a three-point bending machine, from tests of a stiff elastic bar.
 *
 * The travel is contact + w(F) + C F, where w is the deflection of a bar of known flexural rigidity
 * on this bench (fe/trial/three_point_bending.h, with shear, rollers and large deflections). So
 * travel - w(F) over F is a line of slope C; the first contact affects only its intercept. The
 * smallest reading is the zero of the force. Only readings above a part of the largest force are
 * used, after the bar is seated.
 *
 * This assumes that the bar does not yield. A bar that yields early, far below the first reading
 * used, also gives a line. Therefore the unloading, if it was measured, must follow the same line;
 * otherwise the compliance is not identifiable. Without unloading only the strain of the bar's
 * outer fibre shows whether it stayed elastic.
 *
 * Uncertainty of C: the scatter of the slope over several tests (Student's t, 95 %), or two
 * standard errors of a single test, corrected for correlated residuals; and in quadrature the error
 * of the bar's rigidity, times the bar's own compliance. If the machine file gives a range of
 * friction, friction is varied over it, and half the range of C is added in quadrature.
 */
#ifndef WB_ANALYSIS_CALIBRATION_THREE_POINT_MACHINE_COMPLIANCE_H
#define WB_ANALYSIS_CALIBRATION_THREE_POINT_MACHINE_COMPLIANCE_H

#include <stdbool.h>

#include "analysis/dataset/dataset.h"
#include "base/reason.h"
#include "base/setting.h"
#include "base/status.h"

struct wb_machine_compliance_settings {
    double rigidity;       /* N m2, of the bar */
    double rigidity_error; /* 1: relative half width of its interval of 95 % */
    double from_force;     /* part of the largest force: readings below are not used */
};
extern const struct wb_setting_table wb_machine_compliance_table;

struct wb_machine_compliance {
    double value, low, high; /* m/N; low may be below zero */
    double of_bar;           /* m/N: compliance of the bar itself */
    /* m/N: contributions to the half width of the interval. */
    double of_readings, of_rigidity, of_friction;
    bool is_straight; /* else the lines are curved by more than 3 %: the bar yields or slips, or the
                         machine has play */
    bool has_unloading;     /* all tests have one, of at least ten readings */
    bool is_reversible;     /* the unloading follows the loading; else the bar yields or slips: the
                               deviation in slope or in travel exceeds 3 %, noise and friction. True
                               without unloading */
    double value_unloading; /* m/N, of the unloading; NaN: none */
    double residual;    /* m of residual travel after unloading, mean, at the smallest force used */
    double most_travel; /* m, largest travel from zero force */
    double strain;      /* 1, largest of the bar's outer fibre, if it is elastic */
    bool is_identifiable; /* straight, reversible, and the interval is above zero */
    double misfit;        /* RMS distance of the readings from their lines, m of travel */
    int n_tests;
};

/* WB_ERR_DATA for datasets of several bars or benches, or with too few readings; WB_ERR_ARGUMENT
 * without a rigidity. A bar that is too compliant to identify the machine's compliance is a result.
 * `why` receives the reason (NULL: logged). */
WB_MUST_CHECK enum wb_status wb_machine_compliance_find(
    struct wb_machine_compliance *result, const struct wb_dataset *const *datasets, int n,
    const struct wb_machine_compliance_settings *settings, struct wb_reason *why);

#endif
