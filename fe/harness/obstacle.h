/* Rigid obstacles of a harness: the distance of a point from their surface. */
#ifndef WB_FE_HARNESS_OBSTACLE_H
#define WB_FE_HARNESS_OBSTACLE_H

#include "base/reason.h"
#include "base/status.h"

enum wb_obstacle_kind {
    WB_OBSTACLE_PLANE,    /* what is behind it is solid; its x axis points out of it */
    WB_OBSTACLE_CYLINDER, /* along its x axis */
    WB_OBSTACLE_BOX
};

struct wb_obstacle {
    enum wb_obstacle_kind kind;
    double place[3];    /* a point of the plane; the centre of a cylinder or a box, m */
    double rotation[4]; /* of its axes: unit quaternion */
    double size[3];  /* cylinder: radius, length (may be infinite); box: edges along its axes, m */
    double edge;     /* radius of the edges of a cylinder or a box, m */
    double friction; /* coefficient */
};

/* WB_ERR_ARGUMENT if a size is not above 0, an edge has a radius of more than half of a size, or
 * the friction is negative. */
WB_MUST_CHECK enum wb_status wb_obstacle_check(const struct wb_obstacle *obstacle,
                                               struct wb_reason *why);

/* Distance of a point from the surface, m; negative inside. `normal` receives its gradient, a unit
 * vector out of the obstacle, `curvature` (3 x 3, row-major, 1/m) the gradient of the normal; zero
 * deep inside a box. */
double wb_obstacle_distance(const struct wb_obstacle *obstacle, const double point[3],
                            double normal[3], double curvature[9]);

#endif
