#include "analysis/report/comparison_rod.h"

#include <math.h>
#include <string.h>

#include "fe/cantilever.h"
#include "fe/section.h"

#define WB_LOG_DOMAIN "report"

static const double pi = 3.14159265358979323846;

/* Moment of the tip force about each point: (r_tip - r) x F. */
static void find_curvature(struct wb_comparison_rod *rod, const struct wb_comparison_wire *wire)
{
    const int last = WB_COMPARISON_POINTS - 1;
    const double rigidity = wire->material.youngs_modulus * pi / 64.0 * pow(wire->diameter, 4.0);
    const double force = rod->force[rod->n_curve - 1], angle = rod->angle[rod->n_curve - 1];
    for (int i = 0; i <= last; i++) {
        const double arm_x = rod->x[last] - rod->x[i], arm_y = rod->y[last] - rod->y[i];
        rod->curvature[i] = force * (arm_x * cos(angle) + arm_y * sin(angle)) / rigidity;
    }
}

static enum wb_status load(struct wb_comparison_rod *rod, const struct wb_comparison_wire *wire,
                           struct wb_cantilever *cantilever)
{
    struct wb_cantilever_point point = {.end = WB_CANTILEVER_CONVERGED};
    rod->n_curve = 1;
    while (rod->n_curve <= WB_COMPARISON_STEPS && point.end == WB_CANTILEVER_CONVERGED) {
        const int i = rod->n_curve;
        const double force = wire->force * i / WB_COMPARISON_STEPS;
        WB_TRY(wb_cantilever_move(cantilever, WB_CONTROL_FOLLOWER_FORCE, force, &point));
        if (point.end != WB_CANTILEVER_CONVERGED)
            break;
        rod->force[i] = force;
        rod->deflection[i] = point.deflection;
        rod->angle[i] = point.tip_angle;
        rod->n_curve++;
    }
    rod->reached = rod->n_curve == WB_COMPARISON_STEPS + 1;
    for (int i = 0; i < WB_COMPARISON_POINTS; i++)
        rod->s[i] = wire->length * i / (WB_COMPARISON_POINTS - 1);
    wb_cantilever_shape(cantilever, WB_COMPARISON_POINTS, rod->s, rod->x, rod->y, NULL);
    find_curvature(rod, wire);
    rod->done = true;
    return WB_OK;
}

enum wb_status wb_comparison_rod_compute(struct wb_comparison_rod *rod,
                                         const struct wb_comparison_wire *wire)
{
    struct wb_section section;
    struct wb_cantilever *cantilever;
    memset(rod, 0, sizeof *rod);
    WB_TRY(wb_section_init_circle(&section, wire->diameter, &wire->material, wire->n_fibres));
    struct wb_cantilever_model model;
    wb_cantilever_default_model(&model);
    model.section = &section;
    model.length = wire->length;
    model.n_elements = wire->n_elements;
    model.gravity_y = 0.0;
    enum wb_status status = wb_cantilever_create(&cantilever, &model, NULL);
    if (status == WB_OK)
        status = load(rod, wire, cantilever);
    wb_cantilever_destroy(cantilever);
    wb_section_release(&section);
    return status;
}

double wb_comparison_rod_curvature(const struct wb_comparison_rod *rod, double s)
{
    const int last = WB_COMPARISON_POINTS - 1;
    if (!(s >= 0.0 && s <= rod->s[last]))
        return (double)NAN;
    const double place = s / rod->s[last] * last;
    const int below = place < last ? (int)place : last - 1;
    return rod->curvature[below] +
           (place - below) * (rod->curvature[below + 1] - rod->curvature[below]);
}
