#include "analysis/report/wires/wires_rod.h"

#include <math.h>
#include <string.h>

#include "base/circle.h"
#include "fe/rod/section.h"
#include "fe/trial/cantilever.h"

static enum wb_status load(struct wb_wires_rod *rod, const struct wb_wires_wire *wire,
                           struct wb_cantilever *cantilever)
{
    for (rod->n_curve = 1; rod->n_curve <= WB_WIRES_STEPS; rod->n_curve++) {
        const int i = rod->n_curve;
        const double force = wire->force * i / WB_WIRES_STEPS;
        struct wb_cantilever_point point;
        WB_TRY(wb_cantilever_move(cantilever, WB_CONTROL_FOLLOWER_FORCE, force, &point));
        if (point.end != WB_CANTILEVER_CONVERGED)
            break;
        rod->force[i] = force;
        rod->deflection[i] = point.deflection;
        rod->angle[i] = point.tip_angle;
    }
    rod->reached = rod->n_curve == WB_WIRES_STEPS + 1;
    for (int i = 0; i < WB_WIRES_POINTS; i++)
        rod->s[i] = wire->length * i / (WB_WIRES_POINTS - 1);
    wb_cantilever_shape(cantilever, WB_WIRES_POINTS, rod->s, rod->x, rod->y, NULL);
    rod->tip_angle = rod->angle[rod->n_curve - 1];
    rod->done = true;
    return WB_OK;
}

enum wb_status wb_wires_rod_compute(struct wb_wires_rod *rod, const struct wb_wires_wire *wire)
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

/* State of the elastica from the tip: angle to the tip's tangent, its derivative, and the place in
 * the frame of that tangent. */
static void derive(const double state[4], double load, double derivative[4])
{
    derivative[0] = state[1];
    derivative[1] = load * cos(state[0]);
    derivative[2] = cos(state[0]);
    derivative[3] = -sin(state[0]);
}

/* One step of the classical Runge-Kutta method. */
static void step_elastica(double state[4], double load, double h)
{
    static const double places[4] = {0.0, 0.5, 0.5, 1.0}, weights[4] = {1.0, 2.0, 2.0, 1.0};
    double derivative[4] = {0.0}, sum[4] = {0.0};
    for (int stage = 0; stage < 4; stage++) {
        double at[4];
        for (int i = 0; i < 4; i++)
            at[i] = state[i] + places[stage] * h * derivative[i];
        derive(at, load, derivative);
        for (int i = 0; i < 4; i++)
            sum[i] += weights[stage] / 6.0 * derivative[i];
    }
    for (int i = 0; i < 4; i++)
        state[i] += h * sum[i];
}

void wb_wires_rod_exact(struct wb_wires_rod *rod, const struct wb_wires_wire *wire)
{
    const int last = WB_WIRES_POINTS - 1, substeps = 20;
    const double load =
        wire->force / (wire->material.youngs_modulus * wb_circle_second_moment(wire->diameter));
    const double h = wire->length / (last * substeps);
    double state[4] = {0.0}, back[WB_WIRES_POINTS][2] = {{0.0}};
    memset(rod, 0, sizeof *rod);
    for (int i = last - 1; i >= 0; i--) {
        for (int k = 0; k < substeps; k++)
            step_elastica(state, load, h);
        rod->curvature[i] = state[1];
        back[i][0] = state[2];
        back[i][1] = state[3];
    }
    /* From the frame of the tip's tangent into that of the clamp. */
    const double c = cos(state[0]), s = sin(state[0]);
    for (int i = 0; i <= last; i++) {
        const double along = back[0][0] - back[i][0], across = back[0][1] - back[i][1];
        rod->s[i] = wire->length * i / last;
        rod->x[i] = c * along - s * across;
        rod->y[i] = s * along + c * across;
    }
    rod->tip_angle = state[0];
    rod->n_curve = 1;
    rod->done = rod->reached = true;
}

double wb_wires_rod_curvature(const struct wb_wires_rod *rod, double s)
{
    const int last = WB_WIRES_POINTS - 1;
    if (!(s >= 0.0 && s <= rod->s[last]))
        return (double)NAN;
    const double place = s / rod->s[last] * last;
    const int below = place < last ? (int)place : last - 1;
    return rod->curvature[below] +
           (place - below) * (rod->curvature[below + 1] - rod->curvature[below]);
}
