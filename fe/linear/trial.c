#include "fe/linear/trial.h"

#include "base/interpolate.h"

struct wb_tip_loads wb_trial_loads_between(const struct wb_tip_loads *from,
                                           const struct wb_tip_loads *to, double fraction)
{
    struct wb_tip_loads loads;
    for (int i = 0; i < 3; i++) {
        loads.force[i] = wb_interpolate(from->force[i], to->force[i], fraction);
        loads.moment[i] = wb_interpolate(from->moment[i], to->moment[i], fraction);
        loads.follower[i] = wb_interpolate(from->follower[i], to->follower[i], fraction);
    }
    return loads;
}

const char *wb_trial_phase_name(enum wb_phase phase)
{
    static const char *const names[] = {"load", "unload", "slack"};
    return names[phase];
}

void wb_trial_default_jacket_contact(struct wb_jacket_contact_law *law, double youngs_modulus,
                                     double poissons_ratio, double thickness, double friction)
{
    const double nu = poissons_ratio;
    const double confined = youngs_modulus * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
    law->normal_stiffness = confined / thickness;
    law->tangential_stiffness = law->normal_stiffness / 3.0;
    law->friction = friction;
}
