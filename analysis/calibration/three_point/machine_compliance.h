/* How much a three-point bending machine gives way, from tests of a stiff elastic bar.
 *
 * The travel is contact + w(F) + C F, where w is the deflection of a bar of known flexural rigidity
 * on this bench (fe/trial/three_point_bending.h, with shear, rollers and large deflections). So
 * travel - w(F) over F is a line of slope C; where the bar was first touched is in its height. The
 * smallest reading is the zero of the force. Only readings above a part of the largest force count,
 * past the seating.
 *
 * That holds of a bar which does not yield. One that yields early, far below the first reading that
 * counts, bends along a line, too: so the unloading, where it was measured, must be along the same
 * line, or nothing is told. Without unloading the strain of the bar's outer fibre is what is left
 * to judge by.
 *
 * What is known of C: the scatter of the slope over several tests (Student's t, 95 %), or of one
 * alone two standard errors, with neighbouring residuals of one sign counted once; and joined with
 * it in quadrature the error of the bar's rigidity, which counts by as much as the bar gives way
 * itself. Friction, where the machine file leaves it open, is varied over its band, and its half
 * range joins likewise. */
#ifndef WB_ANALYSIS_CALIBRATION_THREE_POINT_MACHINE_COMPLIANCE_H
#define WB_ANALYSIS_CALIBRATION_THREE_POINT_MACHINE_COMPLIANCE_H

#include <stdbool.h>

#include "analysis/dataset/dataset.h"
#include "base/reason.h"
#include "base/setting.h"
#include "base/status.h"

struct wb_machine_compliance_settings {
    double rigidity;       /* N m2, of the bar */
    double rigidity_error; /* 1: half width of its interval of 95 % */
    double from_force;     /* of the largest force: readings below serve not */
};
extern const struct wb_setting_table wb_machine_compliance_table;

struct wb_machine_compliance {
    double value, low, high;                      /* m/N; low may be below zero */
    double of_bar;                                /* m/N: what the bar gives way itself */
    double of_readings, of_rigidity, of_friction; /* half widths of the interval's parts, m/N */
    bool is_straight;  /* else the lines are curved by more than 3 %: the bar yields, or
                          slips, or the machine has play */
    bool has_way_back; /* of all tests: at least ten readings, too */
    bool comes_back;   /* it is the way up; else the bar yields, or slips: by 3 % in slope or in
                          travel, beyond noise and friction. True without unloading */
    double value_back; /* m/N, of the unloading; NaN: none */
    double
        left; /* m of travel that is left during unloading, mean, at the least force that counts */
    double most_travel; /* m, largest way from zero force */
    double strain;      /* 1, of the bar's outer fibre, largest, if it is elastic */
    bool is_told;       /* they are straight, come back, and the interval is above zero */
    double misfit;      /* RMS distance of the readings from their lines, m of travel */
    int n_tests;
};

/* WB_ERR_DATA for datasets of several bars or benches, or with too few readings; WB_ERR_ARGUMENT
 * without a rigidity. A bar that is not stiff enough to tell is a result. The reason goes to `why`
 * (NULL: logged). */
WB_MUST_CHECK enum wb_status wb_machine_compliance_find(
    struct wb_machine_compliance *result, const struct wb_dataset *const *datasets, int n,
    const struct wb_machine_compliance_settings *settings, struct wb_reason *why);

#endif
