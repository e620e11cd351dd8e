#include "daq/start_check.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/units.h"
#include "daq/marker_check.h"

#define ZERO_SHARE 0.1
#define NOISE_TIMES 5.0
#define NOISE_SHARE 0.01
#define SEEN_SHARE 0.5
#define LEAST_READINGS 10
#define LEAST_FRAMES 10

void wb_start_check_frame(struct wb_start_check *check, const struct wb_mocap_frame *frame,
                          const struct wb_specimen *specimen)
{
    struct wb_marker_places places;
    wb_marker_check_frame(frame, specimen, &places);
    check->n_frames++;
    for (int m = 0; m < specimen->n_markers; m++)
        check->seen[m] += places.index[m] >= 0;
}

bool wb_start_check_enough(const struct wb_start_check *check)
{
    return check->load.n >= LEAST_READINGS && check->n_frames >= LEAST_FRAMES;
}

bool wb_start_check_stage(const struct wb_stage_report *report, char text[WB_START_CHECK_TEXT])
{
    switch (report->state) {
    case WB_STAGE_IDLE:
        break;
    case WB_STAGE_ALARM:
        snprintf(
            text, WB_START_CHECK_TEXT,
            "the stage is in alarm (%d): mend the cause, then run 'wirebench stage RIG unlock' "
            "or 'home'",
            report->alarm);
        return false;
    case WB_STAGE_HOLD:
        snprintf(text, WB_START_CHECK_TEXT,
                 "the stage is on hold from before: run 'wirebench stage RIG release'");
        return false;
    default:
        snprintf(text, WB_START_CHECK_TEXT, "the stage is not idle: wait for it, or reset it");
        return false;
    }
    if (isfinite(report->position))
        return true;
    snprintf(text, WB_START_CHECK_TEXT, "the stage does not tell its position");
    return false;
}

bool wb_start_check_markers(const struct wb_start_check *check, const struct wb_specimen *specimen,
                            char text[WB_START_CHECK_TEXT])
{
    char missing[160] = "";
    int n_missing = 0;
    const int n = specimen->n_markers;
    for (int m = 0; m < n; m++) {
        if (check->seen[m] >= SEEN_SHARE * check->n_frames)
            continue;
        const size_t used = strlen(missing);
        snprintf(missing + used, sizeof missing - used, "%s%d (%g mm)", n_missing ? ", " : "",
                 m + 1, specimen->markers[m] / WB_MM);
        n_missing++;
    }
    if (n_missing == n)
        snprintf(text, WB_START_CHECK_TEXT, "none of the %d markers is seen on a wire of %g mm", n,
                 specimen->length / WB_MM);
    else if (n_missing > 0)
        snprintf(text, WB_START_CHECK_TEXT,
                 "%d of %d markers seen; not seen, counted from one end: %s", n - n_missing, n,
                 missing);
    return n_missing == 0;
}

bool wb_start_check_zero(const struct wb_start_check *check, const struct wb_rig_load_cell *cell,
                         char text[WB_START_CHECK_TEXT])
{
    const double zero = check->load.mean;
    const double noise = wb_average_deviation(&check->load);
    const double allowed =
        cell->noise > 0.0 ? NOISE_TIMES * cell->noise : NOISE_SHARE * cell->capacity;
    if (!(fabs(zero) <= ZERO_SHARE * cell->capacity)) {
        snprintf(text, WB_START_CHECK_TEXT,
                 "the unloaded load cell reads %.2f mN, more than %g %% of its capacity of %.1f "
                 "mN: is the strand slack (after a stop: 'wirebench stage RIG release'), the cell "
                 "zeroed, its unit right?",
                 zero / WB_MN, ZERO_SHARE / WB_PERCENT, cell->capacity / WB_MN);
        return false;
    }
    if (!(noise <= allowed)) {
        snprintf(text, WB_START_CHECK_TEXT,
                 "the unloaded load cell's noise is %.3f mN, more than %.3f mN: is something "
                 "touching it?",
                 noise / WB_MN, allowed / WB_MN);
        return false;
    }
    return true;
}
