#include "fe/section/section_homogenise.h"

#include <math.h>

enum {
    PIECES = 400, /* integration steps along the length */
    MAX_ITERATIONS = 30
};

static const double tolerance = 1e-10; /* rad; and relative to the length */

/* Curvature as a function of moment: piecewise linear through the points, then linear with a slope
 * (1/(N m2)). */
struct curve {
    int n;
    const struct wb_section_homogenise_point *points;
    double slope;
};

static double curvature_at(const struct curve *curve, double moment, int *piece)
{
    const struct wb_section_homogenise_point *const p = curve->points;

    while (*piece < curve->n && p[*piece].moment < moment)
        (*piece)++;
    const double from_moment = *piece > 0 ? p[*piece - 1].moment : 0.0;
    const double from = *piece > 0 ? p[*piece - 1].curvature : 0.0;
    if (*piece == curve->n)
        return from + curve->slope * (moment - from_moment);
    return from +
           (p[*piece].curvature - from) * (moment - from_moment) / (p[*piece].moment - from_moment);
}

struct end {
    double angle; /* rad, at the clamp */
    double x, y;  /* m, of the tip from the clamp */
    double bend;  /* 1/m, at the clamp */
};

/* Integrates from the tip, where the angle is `angle`, to the clamp under a tip force: midpoint
 * rule. */
static struct end integrate(const struct curve *curve, double force, double length, double angle)
{
    const double h = length / PIECES;
    struct end at = {.angle = angle};
    int piece = 0;

    for (int i = 0; i < PIECES; i++) {
        const double half = at.angle - 0.5 * h * curvature_at(curve, force * at.x, &piece);
        const double moment = force * (at.x + 0.5 * h * cos(half));
        const double middle = at.angle - 0.5 * h * curvature_at(curve, moment, &piece);
        at.angle -= h * curvature_at(curve, moment, &piece);
        at.x += h * cos(middle);
        at.y += h * sin(middle);
    }
    at.bend = curvature_at(curve, force * at.x, &piece);
    return at;
}

/* Newton's method for the slope and the tip's angle, with finite differences. */
static int find_slope(struct curve *curve, const struct wb_section_homogenise_point *point,
                      double length, double *angle, struct end *end)
{
    for (int i = 0; i < MAX_ITERATIONS; i++) {
        const double slope = curve->slope, more = 1e-6 * slope, turn = 1e-7;
        *end = integrate(curve, point->force, length, *angle);
        const double a = end->angle, y = (end->y - point->deflection) / length;
        if (fabs(a) <= tolerance && fabs(y) <= tolerance)
            return 1;
        const struct end turned = integrate(curve, point->force, length, *angle + turn);
        curve->slope = slope + more;
        const struct end softer = integrate(curve, point->force, length, *angle);
        const double aa = (turned.angle - a) / turn, as = (softer.angle - a) / more;
        const double ya = (turned.y - end->y) / length / turn,
                     ys = (softer.y - end->y) / length / more;
        const double determinant = aa * ys - as * ya;
        const double next = slope - (aa * y - ya * a) / determinant;
        *angle -= (ys * a - as * y) / determinant;
        curve->slope = next > 0.1 * slope ? next : 0.1 * slope;
        if (!isfinite(*angle) || !isfinite(next))
            return 0;
    }
    return 0;
}

int wb_section_homogenise(int n, struct wb_section_homogenise_point *points, double length)
{
    double angle = 0.0;

    for (int i = 0; i < n; i++) {
        struct curve curve = {.n = i, .points = points};
        struct end end;
        if (i == 0) {
            /* Initial guess: the elastic cantilever. */
            curve.slope = 3.0 * points[0].deflection / (points[0].force * length * length * length);
            angle = 1.5 * points[0].deflection / length;
        } else {
            const double from = i > 1 ? points[i - 2].moment : 0.0;
            const double bent = i > 1 ? points[i - 2].curvature : 0.0;
            curve.slope = (points[i - 1].curvature - bent) / (points[i - 1].moment - from);
        }
        if (!find_slope(&curve, &points[i], length, &angle, &end))
            return i;
        points[i].moment = points[i].force * end.x;
        points[i].curvature = end.bend;
        if (i > 0 && !(points[i].moment > points[i - 1].moment &&
                       points[i].curvature > points[i - 1].curvature))
            return i;
    }
    return n;
}
