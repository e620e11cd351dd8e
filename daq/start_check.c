#include "daq/start_check.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/units.h"
#include "daq/grbl.h"
#include "daq/marker_check.h"

#define ZERO_SHARE 0.1
#define COUNTERWEIGHT_SHARE 0.5
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

bool wb_start_check_stage(const struct wb_stage_report *report, const char *rig_path,
                          char text[WB_START_CHECK_TEXT])
{
    const size_t size = WB_START_CHECK_TEXT;
    char reason[256];
    switch (report->state) {
    case WB_STAGE_IDLE:
        if (isfinite(report->position))
            return true;
        snprintf(text, size,
                 "the stage does not tell its position: set $10=1 in its firmware, then "
                 "run 'wirebench stage %s home'",
                 rig_path);
        break;
    case WB_STAGE_ALARM:
        wb_grbl_alarm_reason(report, reason, sizeof reason);
        snprintf(text, size,
                 "the stage is in alarm (%s): mend the cause, then run 'wirebench stage %s home', "
                 "or, if it has no limit switch, 'wirebench stage %s unlock'",
                 reason, rig_path, rig_path);
        break;
    case WB_STAGE_HOLD:
        snprintf(text, size,
                 "the stage is on hold from before: run 'wirebench stage %s release', or 'unlock' "
                 "if nothing is loaded",
                 rig_path);
        break;
    case WB_STAGE_RUN:
    case WB_STAGE_JOG:
    case WB_STAGE_HOME:
        snprintf(text, size,
                 "the stage is moving, at somebody else's command: wait until it stands, "
                 "or stop it with 'wirebench stage %s unlock'",
                 rig_path);
        break;
    default:
        snprintf(text, size,
                 "the stage is not idle (door open, check or sleep mode): close the door, then run "
                 "'wirebench stage %s unlock'",
                 rig_path);
    }
    return false;
}

bool wb_start_check_unit(bool contradicts, const struct wb_rig *rig, const char *rig_path,
                         char text[WB_START_CHECK_TEXT])
{
    if (!contradicts)
        return true;
    snprintf(text, WB_START_CHECK_TEXT,
             "the load cell prints another unit than load_cell.unit: %s of %s: remove that key if "
             "the instrument is right, or set the instrument's unit; force limits would be wrong",
             rig->load_cell.unit, rig_path);
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
        snprintf(text, WB_START_CHECK_TEXT,
                 "none of the %d markers is seen on a wire of %g mm: do the cameras stream, and is "
                 "it this specimen?",
                 n, specimen->length / WB_MM);
    else if (n_missing > 0)
        snprintf(text, WB_START_CHECK_TEXT,
                 "%d of %d markers seen; not seen, counted from one end: %s", n - n_missing, n,
                 missing);
    return n_missing == 0;
}

bool wb_start_check_zero(const struct wb_start_check *check, const struct wb_rig *rig,
                         const char *rig_path, char text[WB_START_CHECK_TEXT])
{
    const struct wb_rig_load_cell *const cell = &rig->load_cell;
    const double zero = check->load.mean, expected = wb_rig_tare_load(rig);
    const double noise = wb_average_deviation(&check->load);
    const double noise_allowed =
        cell->noise > 0.0 ? NOISE_TIMES * cell->noise : NOISE_SHARE * cell->capacity;
    double allowed = ZERO_SHARE * cell->capacity;
    if (expected > 0.0)
        allowed = fmin(allowed, COUNTERWEIGHT_SHARE * expected);
    if (!(fabs(zero - expected) <= allowed) && expected > 0.0) {
        snprintf(text, WB_START_CHECK_TEXT,
                 "the load cell reads %.2f mN, not the counterweight's %.2f mN within %.2f mN "
                 "(load_cell.tare is counterweight): does it hang free, is the cell zeroed "
                 "without it, its unit right? After a stop: 'wirebench stage %s release'",
                 zero / WB_MN, expected / WB_MN, allowed / WB_MN, rig_path);
        return false;
    }
    if (!(fabs(zero - expected) <= allowed)) {
        snprintf(text, WB_START_CHECK_TEXT,
                 "the unloaded load cell reads %.2f mN, more than %g %% of its capacity of %.1f "
                 "mN: is the strand slack (after a stop: 'wirebench stage %s release'), the cell "
                 "zeroed, its unit right?",
                 zero / WB_MN, ZERO_SHARE / WB_PERCENT, cell->capacity / WB_MN, rig_path);
        return false;
    }
    if (!(noise <= noise_allowed)) {
        snprintf(text, WB_START_CHECK_TEXT,
                 "the %s load cell's noise is %.3f mN, more than %.3f mN: is something "
                 "touching it, or the counterweight swinging?",
                 expected > 0.0 ? "resting" : "unloaded", noise / WB_MN, noise_allowed / WB_MN);
        return false;
    }
    return true;
}
