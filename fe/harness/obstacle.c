#include "fe/harness/obstacle.h"

#include <math.h>
#include <string.h>

#include "base/units.h"
#include "base/vec3.h"
#include "fe/rod/rod_element.h"

#define WB_LOG_DOMAIN "harness"

enum wb_status wb_obstacle_check(const struct wb_obstacle *obstacle, struct wb_reason *why)
{
    static const int sizes[] = {
        [WB_OBSTACLE_PLANE] = 0, [WB_OBSTACLE_CYLINDER] = 2, [WB_OBSTACLE_BOX] = 3};
    for (int k = 0; k < sizes[obstacle->kind]; k++) {
        const bool is_radius = obstacle->kind == WB_OBSTACLE_CYLINDER && k == 0;
        const double most = obstacle->size[k] * (is_radius ? 1.0 : 0.5);
        if (!(obstacle->size[k] > 0.0))
            return wb_fail_to(why, WB_ERR_ARGUMENT, "a size of %g mm: expected above 0",
                              obstacle->size[k] / WB_MM);
        if (!(obstacle->edge >= 0.0 && obstacle->edge <= most))
            return wb_fail_to(why, WB_ERR_ARGUMENT,
                              "edges of radius %g mm: expected 0 or more, and at most %g mm",
                              obstacle->edge / WB_MM, most / WB_MM);
    }
    if (!(isfinite(obstacle->friction) && obstacle->friction >= 0.0))
        return wb_fail_to(why, WB_ERR_ARGUMENT, "friction %g: expected 0 or more",
                          obstacle->friction);
    return WB_OK;
}

/* Distance from a body in a frame of three orthogonal directions, of which those with `along[i]`
 * above 0 are outside by that distance: n = along / distance, with the gradient (I - n n^T) /
 * distance in the directions that are outside. Inside: the direction with the largest value. */
static double outside(const double along[3], double n[3], double gradient[9])
{
    double out[3];
    int nearest = 0;
    memset(gradient, 0, 9 * sizeof *gradient);
    for (int i = 0; i < 3; i++) {
        out[i] = fmax(along[i], 0.0);
        nearest = along[i] > along[nearest] ? i : nearest;
        n[i] = 0.0;
    }
    const double distance = wb_vec3_length(out);
    if (!(distance > 0.0)) {
        n[nearest] = 1.0;
        return along[nearest];
    }
    for (int i = 0; i < 3; i++)
        n[i] = out[i] / distance;
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++)
            gradient[3 * i + k] = ((i == k && out[i] > 0.0 ? 1.0 : 0.0) - n[i] * n[k]) / distance;
    }
    return distance;
}

static double box(const double *size, double edge, const double *q, double *n, double *gradient)
{
    double along[3], side[3];
    for (int i = 0; i < 3; i++) {
        side[i] = q[i] < 0.0 ? -1.0 : 1.0;
        along[i] = fabs(q[i]) - 0.5 * size[i] + edge;
    }
    const double distance = outside(along, n, gradient);
    for (int i = 0; i < 3; i++) {
        n[i] *= side[i];
        for (int k = 0; k < 3; k++)
            gradient[3 * i + k] *= side[i] * side[k];
    }
    return distance - edge;
}

/* The directions are the axis, that away from it, and that around it. */
static double cylinder(const double *size, double edge, const double *q, double *n,
                       double *gradient)
{
    const double radius = hypot(q[1], q[2]);
    const double c = radius > 0.0 ? q[1] / radius : 1.0, s = radius > 0.0 ? q[2] / radius : 0.0;
    const double axes[9] = {q[0] < 0.0 ? -1.0 : 1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c};
    const double along[3] = {fabs(q[0]) - 0.5 * size[1] + edge, radius - size[0] + edge,
                             -(double)INFINITY};
    double own[3], own_gradient[9];
    const double distance = outside(along, own, own_gradient);
    if (radius > 0.0)
        own_gradient[8] = own[1] / radius;
    wb_vec3_turn(axes, own, n);
    wb_vec3_turn_matrix(axes, own_gradient, gradient);
    return distance - edge;
}

double wb_obstacle_distance(const struct wb_obstacle *obstacle, const double point[3],
                            double normal[3], double curvature[9])
{
    double R[9], from[3], q[3], n[3] = {1.0, 0.0, 0.0}, gradient[9] = {0}, distance;
    for (int k = 0; k < 3; k++)
        from[k] = point[k] - obstacle->place[k];
    wb_rod_element_matrix(obstacle->rotation, R);
    wb_vec3_turn_back(R, from, q);
    if (obstacle->kind == WB_OBSTACLE_PLANE)
        distance = q[0];
    else if (obstacle->kind == WB_OBSTACLE_CYLINDER)
        distance = cylinder(obstacle->size, obstacle->edge, q, n, gradient);
    else
        distance = box(obstacle->size, obstacle->edge, q, n, gradient);
    wb_vec3_turn(R, n, normal);
    wb_vec3_turn_matrix(R, gradient, curvature);
    return distance;
}
