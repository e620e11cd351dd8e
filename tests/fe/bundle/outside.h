/* External forces on a bundle and its momentum, for tests of the balance of momentum. */
#ifndef WB_TESTS_FE_BUNDLE_OUTSIDE_H
#define WB_TESTS_FE_BUNDLE_OUTSIDE_H

#include "fe/bundle/bundle.h"
#include "fe/bundle/bundle_part.h"

/* External forces on the bundle in the last step, N, and its momentum after it, kg m/s, of the
 * scaled masses: the momentum changes in each step by the sum of the three forces times the
 * step. */
struct outside {
    double clamp[3], tip[3], weight[3];
    double momentum[3];
};

/* Adds a body's part. */
static inline void add_outside(const struct wb_bundle_bodies *bodies,
                               const struct wb_bundle_body *body, struct outside *out)
{
    const int held = wb_bundle_bodies_last_held(bodies), stride = body->layout.stride;

    for (int j = 0; j < bodies->extent.n_stations; j++) {
        const double mass = wb_bundle_bodies_station_mass(bodies, body, j);
        const double weight = -bodies->gravity * mass / bodies->model->run.mass_scaling;
        out->weight[1] += weight;
        if (j <= held)
            out->clamp[1] -= weight;
        for (int i = 0; i < 3 * body->layout.n_nodes; i++) {
            const size_t at = (size_t)i * (size_t)stride + (size_t)j;
            if (j <= held)
                out->clamp[i % 3] -= wb_bundle_body_force(body, at);
            out->momentum[i % 3] += mass * body->node_mass[i / 3] / body->mass * body->velocity[at];
        }
    }
}

static inline void get_outside(const struct wb_bundle *bundle, struct outside *outside)
{
    const struct wb_bundle_part *whole = wb_bundle_whole(bundle);
    const struct wb_bundle_bodies *bodies = &whole->bodies;
    const double *pull = whole->account.pull;

    *outside = (struct outside){.tip = {pull[0], pull[1], pull[2]}};
    for (int w = 0; w < bodies->n_wires; w++)
        add_outside(bodies, &bodies->wire[w], outside);
    if (bodies->has_tape)
        add_outside(bodies, &bodies->ring, outside);
}

#endif
