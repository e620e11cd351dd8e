/* A bundle whose energies and momentum are checked in every step. */
#ifndef WB_TESTS_FE_BUNDLE_BUNDLES_LEAD_H
#define WB_TESTS_FE_BUNDLE_BUNDLES_LEAD_H

#include "tests/fe/bundle/bundles.h"
#include "tests/fe/bundle/outside.h"

/* Moves the tip to a deflection. Energies balance to the given fraction of the largest work,
 * momentum to single precision. */
static inline void move_and_check(struct wb_bundle *bundle, double deflection, double duration,
                                  double tolerance)
{
    const int steps = (int)(duration / wb_bundle_time_step(bundle));
    struct outside outside;
    struct wb_bundle_energies e;
    double impulse[3] = {0.0}, size = 0.0, most = 0.0, worst = 0.0;

    wb_bundle_move_tip(bundle, deflection, duration);
    for (int i = 0; i < steps; i++) {
        const double dt = wb_bundle_time_step(bundle) * (i == 0 ? 0.5 : 1.0);
        assert_int_equal(wb_bundle_advance(bundle, 1, NULL), WB_OK);
        get_outside(bundle, &outside);
        for (int c = 0; c < 3; c++) {
            const double force = outside.clamp[c] + outside.tip[c] + outside.weight[c];
            impulse[c] += force * dt;
            size += fabs(force * dt);
        }
        if (i % 50 != 0)
            continue;
        wb_bundle_get_energies(bundle, &e);
        most = fmax(most, fabs(e.external));
        if (i < steps / 10)
            continue;
        worst = fmax(worst, fabs(wb_bundle_imbalance(&e)) / most);
        for (int c = 0; c < 3; c++)
            assert_close(outside.momentum[c], impulse[c], 1e-5 * size);
    }
    print_message("energy imbalance at most %.3g %% in %d steps\n", 100.0 * worst, steps);
    assert_true(worst < tolerance);
}

#endif
