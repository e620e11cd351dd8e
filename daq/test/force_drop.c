#include "daq/test/force_drop.h"

#include <stdio.h>

#include "base/units.h"

#define BEYOND_NOISE 20.0 /* standard deviations of a reading */

bool wb_force_drop_add(struct wb_force_drop *drop, double tension, char text[WB_START_CHECK_TEXT])
{
    drop->recent[drop->n++ % WB_FORCE_DROP_MEAN] = tension;
    if (!(drop->share > 0.0) || drop->n < WB_FORCE_DROP_MEAN)
        return false;
    double mean = 0.0;
    for (int i = 0; i < WB_FORCE_DROP_MEAN; i++)
        mean += drop->recent[i] / WB_FORCE_DROP_MEAN;
    drop->peak = mean > drop->peak ? mean : drop->peak;
    const double fallen = drop->peak - mean;
    /* A missing force is reported by first_force.h. */
    if (!(drop->peak > BEYOND_NOISE * drop->noise) || !(fallen > drop->share * drop->peak) ||
        !(fallen > BEYOND_NOISE * drop->noise))
        return false;
    snprintf(text, WB_START_CHECK_TEXT,
             "the force fell from %.1f to %.1f mN during loading: the wire or the strand broke, or "
             "the wire slips in its clamp; if such a drop is normal for this specimen, raise "
             "limits.force_drop_percent in the rig file",
             drop->peak / WB_MN, mean / WB_MN);
    return true;
}
