#include "daq/test/clamp_watch.h"

#include <math.h>
#include <stdio.h>

#include "base/units.h"

#define REPORTS 3               /* consecutive contradicting reports that are believed */
#define LEAST_OFF (2.0 * WB_MM) /* difference that is always tolerated */
/* Tolerated difference as a fraction of the travel: errors of the stage's steps per mm and of the
 * cameras' scale, which `align` reports. */
#define SHARE_OFF 0.15
#define FRESH_NS (300 * WB_NS_PER_MS) /* greatest age of the clamp's position */

bool wb_clamp_watch_add(struct wb_clamp_watch *watch, const struct wb_tip_watch *tip, int64_t t_ns,
                        double travel, double ahead, char text[WB_START_CHECK_TEXT])
{
    if (!watch->has_end)
        watch->end = wb_tip_watch_clamp(tip);
    watch->has_end = true;
    const int64_t age_ns = t_ns - tip->seen_ns[watch->end];
    const double moved = wb_tip_watch_moved(tip, watch->end);
    if (!tip->settled || age_ns > FRESH_NS || !isfinite(travel))
        return false;
    const bool is_off = fabs(fabs(travel) - moved) > LEAST_OFF + SHARE_OFF * fabs(travel) + ahead;
    watch->n_off = is_off ? watch->n_off + 1 : 0;
    if (watch->n_off < REPORTS)
        return false;
    snprintf(text, WB_START_CHECK_TEXT,
             "the stage reports %.1f mm of travel, but the cameras see the clamp at %.1f mm: check "
             "whether the clamp jams, a coupling slips or the motor loses steps",
             travel / WB_MM, moved / WB_MM);
    return true;
}
