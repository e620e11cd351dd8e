/* Three-point bending by shooting, for tests: no finite elements, no springs. Half of a wire, from
 * its contact with the right roller back to its middle, or to the point where it leaves the nose.
 *
 * Beyond a section only the roller acts: force R = N n + T t and moment T d/2 at the contact, where
 * the wire's slope is phi. The moment of a section at (x, y) is therefore known, M = T d/2 + (x_c -
 * x) R_y - (y_c - y) R_x, and (x, y, theta) follow by integration from the contact: theta' =
 * kappa_0 + kappa(M), (x, y)' = (1 + R_t / EA) t + R_n / GA n. For a given phi there are three
 * cases. Point contact: N and the arc length s satisfy x = 0 and theta = 0 in the middle. Wrapped,
 * with tension in the arc: with the angle alpha at which the wire leaves the nose, x = R_n
 * sin(alpha), theta = alpha and kappa_0 + kappa = 1 / R_n. Two lines of contact, if the arc is
 * compressed and lifts off the nose between them: a force normal to the nose at alpha, behind which
 * there is only an axial force, and a second arc length to the middle.
 */
#ifndef WB_TESTS_FE_TRIAL_THREE_POINT_SHOOTING_H
#define WB_TESTS_FE_TRIAL_THREE_POINT_SHOOTING_H

#include <math.h>
#include <stdbool.h>

#include "fe/linear/banded.h"

enum {
    SHOOTING_STEPS = 2000
};

struct shooting {
    double span, diameter, support_radius, nose_radius;
    double friction; /* of a wire that is drawn in */
    double EI, EA, GA;
    double natural; /* curvature, 1/m; positive concave upwards */
    /* Curvature minus the natural one as a function of the moment; NULL: M / EI. */
    double (*curvature)(const void *context, double moment);
    const void *context;
};

enum shooting_contact {
    SHOOTING_POINT, /* with the nose */
    SHOOTING_WRAPPED,
    SHOOTING_TWO_LINES
};

struct shot {
    double deflection, force, draw_in; /* of the nose; of the wire over the roller */
    double moment;                     /* where the wire leaves the nose, N m */
    double axial;                      /* at the same point, N; positive is tension */
    double alpha;                      /* 0: a point contact */
    double gap;                        /* for two lines of contact: between nose and middle, m */
};

/* x, y, theta */
static inline void shooting_slope(const struct shooting *p, const double end[3], const double R[2],
                                  double moment, const double at[3], double slope[3])
{
    const double c = cos(at[2]), s = sin(at[2]);
    const double M = moment + (end[0] - at[0]) * R[1] - (end[1] - at[1]) * R[0];
    const double along = 1.0 + (R[0] * c + R[1] * s) / p->EA;
    const double across = (R[1] * c - R[0] * s) / p->GA;
    slope[0] = along * c - across * s;
    slope[1] = along * s + across * c;
    slope[2] = p->natural + (p->curvature ? p->curvature(p->context, M) : M / p->EI);
}

/* Integrates from a section where R and *moment act back over an arc length: `at` and *moment
 * become those of the other end. */
static inline void shoot_back(const struct shooting *p, const double R[2], double arc, double at[3],
                              double *moment)
{
    const double end[3] = {at[0], at[1], at[2]}, M = *moment, h = -arc / SHOOTING_STEPS;

    for (int i = 0; i < SHOOTING_STEPS; i++) {
        double k1[3], k2[3], k3[3], k4[3], mid[3];
        shooting_slope(p, end, R, M, at, k1);
        for (int k = 0; k < 3; k++)
            mid[k] = at[k] + 0.5 * h * k1[k];
        shooting_slope(p, end, R, M, mid, k2);
        for (int k = 0; k < 3; k++)
            mid[k] = at[k] + 0.5 * h * k2[k];
        shooting_slope(p, end, R, M, mid, k3);
        for (int k = 0; k < 3; k++)
            mid[k] = at[k] + h * k3[k];
        shooting_slope(p, end, R, M, mid, k4);
        for (int k = 0; k < 3; k++)
            at[k] += h / 6.0 * (k1[k] + 2.0 * k2[k] + 2.0 * k3[k] + k4[k]);
    }
    *moment = M + (end[0] - at[0]) * R[1] - (end[1] - at[1]) * R[0];
}

/* y of the wire's middle at rest. */
static inline double shooting_rest(const struct shooting *p)
{
    if (p->natural == 0.0)
        return 0.0;
    const double R = 1.0 / p->natural, r = p->support_radius + 0.5 * p->diameter;
    return copysign(sqrt((R + r) * (R + r) - 0.25 * p->span * p->span), R) - R - r;
}

/* Arc length from the middle to the roller at rest. */
static inline double shooting_rest_arc(const struct shooting *p)
{
    if (p->natural == 0.0)
        return 0.5 * p->span;
    const double R = 1.0 / p->natural, r = p->support_radius + 0.5 * p->diameter;
    return fabs(R) * asin(0.5 * p->span / fabs(R + r));
}

/* Residuals of u = (arc / span, N span^2 / EI, alpha, second arc / span). */
static inline void shooting_miss(const struct shooting *p, double phi,
                                 enum shooting_contact contact, const double u[4], double miss[4],
                                 struct shot *shot)
{
    const double rn = p->nose_radius + 0.5 * p->diameter;
    const double r = p->support_radius + 0.5 * p->diameter;
    const double alpha = contact == SHOOTING_POINT ? 0.0 : u[2];
    const double N = u[1] * p->EI / (p->span * p->span), T = p->friction * N;
    double R[2] = {-N * sin(phi) + T * cos(phi), N * cos(phi) + T * sin(phi)};
    double at[3] = {0.5 * p->span - r * sin(phi), -r + r * cos(phi), phi};
    double moment = T * 0.5 * p->diameter;

    shoot_back(p, R, u[0] * p->span, at, &moment);
    /* A wire with shear compliance lies on the nose with its axis, not with its section, and cannot
     * be pressed at a point: on the nose, section and axis differ by sinh(s / l), l^2 = EI / GA.
     * For infinite GA both are the same, and the curvature is the nose's. */
    const double length = sqrt(p->EI / p->GA);
    const double shear = (R[1] * cos(at[2]) - R[0] * sin(at[2])) / p->GA;
    const double less = shear / length / tanh(rn * alpha / length);
    miss[0] = (at[0] - rn * sin(alpha)) / p->span;
    miss[1] = at[2] + (contact == SHOOTING_WRAPPED ? shear : 0.0) - alpha;
    miss[2] = miss[3] = 0.0;
    const double curvature =
        p->natural + (p->curvature ? p->curvature(p->context, moment) : moment / p->EI);
    *shot = (struct shot){
        .deflection = shooting_rest(p) + rn - (at[1] + rn * cos(alpha)),
        .force = 2.0 * R[1],
        .draw_in = u[0] * p->span + rn * alpha - shooting_rest_arc(p),
        .moment = moment,
        .axial = R[0] * cos(at[2]) + R[1] * sin(at[2]),
        .alpha = alpha,
    };
    if (contact == SHOOTING_WRAPPED)
        miss[2] = (curvature - 1.0 / rn + less) * p->span;
    if (contact != SHOOTING_TWO_LINES)
        return;
    const double nose = at[1] + rn * cos(alpha);
    R[0] += R[1] * tan(alpha);
    R[1] = 0.0;
    shoot_back(p, R, u[3] * p->span, at, &moment);
    miss[2] = at[0] / p->span;
    miss[3] = at[2];
    shot->draw_in = (u[0] + u[3]) * p->span - shooting_rest_arc(p);
    shot->gap = nose - at[1] - rn;
}

/* The equilibrium with slope phi at the roller, from the initial guess u, which becomes the
 * solution. */
static inline bool shoot(const struct shooting *p, double phi, enum shooting_contact contact,
                         double u[4], struct shot *shot)
{
    const int n = contact == SHOOTING_POINT ? 2 : contact == SHOOTING_WRAPPED ? 3 : 4;
    for (int iteration = 0; iteration < 60; iteration++) {
        double miss[4], more[4], A[16], size = 0.0;
        struct shot ignored;
        shooting_miss(p, phi, contact, u, miss, shot);
        for (int j = 0; j < n; j++) {
            double v[4] = {u[0], u[1], u[2], u[3]};
            const double small = 1e-7 * fmax(1e-2, fabs(u[j]));
            v[j] += small;
            shooting_miss(p, phi, contact, v, more, &ignored);
            for (int i = 0; i < n; i++)
                A[4 * i + j] = (more[i] - miss[i]) / small;
        }
        for (int i = 0; i < n; i++)
            size = fmax(size, fabs(miss[i]));
        if (!(size < 1e6))
            return false;
        wb_banded_solve_small(n, 4, A, miss);
        for (int j = 0; j < n; j++)
            u[j] -= miss[j];
        if (size < 1e-10) {
            shooting_miss(p, phi, contact, u, miss, shot);
            return true;
        }
    }
    return false;
}

#endif
