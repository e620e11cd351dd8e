/* The axis of a wire, fitted to the markers that sit on it.
 *
 * A marker sits `offset` from the axis along the local normal (-sin theta, cos theta). The axis is
 * inextensible and leaves the clamp along x: its angle is theta(s) = sum_i a_i (s/L)^i, i = 1..m,
 *     x(s) = int cos theta,  y(s) = int sin theta,
 * fitted to all markers by least squares (Gauss-Newton). Only the slope of the fit is used:
 * a marker's point on the axis is its measured place less offset times the fitted normal.
 */
#ifndef WB_ANALYSIS_ALIGN_AXIS_FIT_H
#define WB_ANALYSIS_ALIGN_AXIS_FIT_H

#include "base/status.h"

#define WB_AXIS_FIT_TERMS 4

struct wb_axis_fit {
    double length;
    int n_terms;
    double terms[WB_AXIS_FIT_TERMS]; /* a_1.., rad */
    double residual;                 /* m, RMS of the markers' coordinates about the fit */
};

/* Markers on a wire. */
struct wb_axis_fit_markers {
    int n;
    const double *s;     /* (n) m, arc lengths: ascending, within 0..length, not 0 itself */
    const double *x, *y; /* (n) m, in the clamp's frame, offset not removed */
    double offset;       /* m, from the axis along the local normal */
};

/* Fits the axis of a wire of `length` (m). WB_ERR_DATA without a message when there is no marker
 * or the iteration does not converge. */
WB_MUST_CHECK enum wb_status wb_axis_fit(struct wb_axis_fit *fit, double length,
                                         const struct wb_axis_fit_markers *markers);

/* Angle of the fitted axis, rad. */
double wb_axis_fit_angle(const struct wb_axis_fit *fit, double s);

/* Moves a marker's place at arc length s onto the axis. */
void wb_axis_fit_move(const struct wb_axis_fit *fit, double offset, double s, double *x, double *y);

#endif
