#include "daq/test/start_check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "base/vec3.h"
#include "daq/acquire/acquisition.h"
#include "daq/acquire/marker_check.h"
#include "daq/acquire/stage_alarm.h"

#define ZERO_SHARE 0.1                /* tolerance of the zero, fraction of the capacity */
#define COUNTERWEIGHT_SHARE 0.5       /* tolerance of the zero, fraction of the counterweight */
#define NOISE_TIMES 5.0               /* accepted marker noise, multiple of the expected noise */
#define SEEN_SHARE 0.5                /* fraction of the frames that must show a marker */
#define MARKER_NOISE (0.1 * WB_MM)    /* expected if the rig file has no marker_noise_mm */
#define LINK_TOLERANCE (1.3 * WB_MM)  /* of a distance between neighbouring markers */
#define CHAIN_TOLERANCE (1.0 * WB_MM) /* of the sum of these distances, or, */
#define CHAIN_SHARE 0.01              /* if larger, this fraction of the sum */
/* Markers this many specimen lengths apart are given in another unit. */
#define OTHER_UNIT 100.0
#define LEAST_READINGS 10
#define LEAST_FRAMES 10
#define LEAST_FULL_FRAMES 5

static void note_places(struct wb_start_check *check, const struct wb_mocap_frame *frame)
{
    double low[3], high[3];
    int n = 0;
    for (int i = 0; i < frame->n_markers; i++) {
        const struct wb_marker *const marker = &frame->markers[i];
        if (!wb_acquisition_marker_measured(marker)) {
            check->n_hidden++;
            continue;
        }
        check->n_measured++;
        for (int k = 0; k < 3; k++) {
            const double at = (double)marker->position[k];
            low[k] = n > 0 ? fmin(low[k], at) : at;
            high[k] = n > 0 ? fmax(high[k], at) : at;
        }
        n++;
    }
    for (int k = 0; k < 3 && n > 0; k++)
        check->spread = fmax(check->spread, high[k] - low[k]);
}

static double distance_to_mean(const struct wb_average place[3], const double at[3])
{
    const double mean[3] = {place[0].mean, place[1].mean, place[2].mean};
    return wb_vec3_distance(mean, at);
}

/* With symmetric spacing, a frame may number the markers from the other end than earlier frames. */
static bool is_mirrored(const struct wb_start_check *check, const double first[3], int n)
{
    return check->n_full > 0 &&
           distance_to_mean(check->place[n - 1], first) < distance_to_mean(check->place[0], first);
}

/* Adds a frame that shows all markers. In incomplete frames a marker may be mistaken for its
 * neighbour. */
static void add_full_frame(struct wb_start_check *check, const struct wb_mocap_frame *frame,
                           const struct wb_marker_places *places, int n)
{
    double at[WB_SPECIMEN_MAX_MARKERS][3];
    for (int m = 0; m < n; m++) {
        for (int k = 0; k < 3; k++)
            at[m][k] = (double)frame->markers[places->index[m]].position[k];
    }
    const bool mirrored = is_mirrored(check, at[0], n);
    check->n_full++;
    for (int m = 0; m < n; m++) {
        const double *const own = at[mirrored ? n - 1 - m : m];
        for (int k = 0; k < 3; k++)
            wb_average_add(&check->place[m][k], own[k]);
        if (m > 0)
            wb_average_add(&check->link[m - 1],
                           wb_vec3_distance(at[mirrored ? n - m : m - 1], own));
    }
}

void wb_start_check_frame(struct wb_start_check *check, const struct wb_mocap_frame *frame,
                          const struct wb_specimen *specimen)
{
    struct wb_marker_places places;
    wb_marker_check_frame(frame, specimen, &places);
    note_places(check, frame);
    check->n_frames++;
    for (int m = 0; m < specimen->n_markers; m++)
        check->seen[m] += places.index[m] >= 0;
    if (places.n_seen == specimen->n_markers)
        add_full_frame(check, frame, &places, specimen->n_markers);
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
                 "the stage does not report its position: set $10=1 in its firmware, then "
                 "run 'wirebench stage %s home'",
                 rig_path);
        break;
    case WB_STAGE_ALARM:
        wb_stage_alarm_reason(report, reason, sizeof reason);
        snprintf(text, size,
                 "the stage is in alarm (%s): remove the cause, then run 'wirebench stage %s home' "
                 "or, if it has no limit switch, 'wirebench stage %s unlock'",
                 reason, rig_path, rig_path);
        break;
    case WB_STAGE_HOLD:
        snprintf(text, size,
                 "the stage is on hold since an earlier command: run 'wirebench stage %s release', "
                 "or 'unlock' if nothing is loaded",
                 rig_path);
        break;
    case WB_STAGE_RUN:
    case WB_STAGE_JOG:
    case WB_STAGE_HOME:
        snprintf(text, size,
                 "the stage is moving at the command of another program: wait until it stops, "
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
    snprintf(
        text, WB_START_CHECK_TEXT,
        "the unit that the load cell prints is not that of load_cell.unit: %s in %s, therefore "
        "force limits would be wrong: remove the key if the instrument is right, or set the "
        "instrument's unit",
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
    if (n_missing > 0 && check->n_measured == 0 && check->n_hidden > 0)
        snprintf(text, WB_START_CHECK_TEXT,
                 "every marker that the cameras send is occluded or filled in by a model: check "
                 "lighting and view of the bench; in Motive stream the measured markers, without a "
                 "rigid body or skeleton for this wire");
    else if (n_missing > 0 && check->spread > OTHER_UNIT * specimen->length)
        snprintf(text, WB_START_CHECK_TEXT,
                 "the markers are up to %.0f m apart, but the wire is %g mm long: the server "
                 "probably sends millimetres; set its unit to metres",
                 check->spread, specimen->length / WB_MM);
    else if (n_missing == n)
        snprintf(text, WB_START_CHECK_TEXT,
                 "0 of %d markers seen on a wire of %g mm: check that the cameras stream and that "
                 "this is the specimen of the specimen file",
                 n, specimen->length / WB_MM);
    else if (n_missing > 0)
        snprintf(text, WB_START_CHECK_TEXT,
                 "%d of %d markers seen; missing, counted from one end: %s", n - n_missing, n,
                 missing);
    return n_missing == 0;
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* m, standard deviation of a coordinate: the median over the markers, because a reflection is
 * sometimes mistaken for one of them. */
static double place_noise(const struct wb_start_check *check, int n_markers)
{
    double deviation[WB_SPECIMEN_MAX_MARKERS];
    for (int m = 0; m < n_markers; m++) {
        double squares = 0.0;
        for (int k = 0; k < 3; k++)
            squares += pow(wb_average_deviation(&check->place[m][k]), 2) / 3.0;
        deviation[m] = sqrt(squares);
    }
    qsort(deviation, (size_t)n_markers, sizeof *deviation, by_size);
    return deviation[n_markers / 2];
}

/* True if all distances between neighbours differ by the same factor, thus by the cameras' scale;
 * false if single markers are misplaced. */
static bool is_scaled(const struct wb_start_check *check, const struct wb_specimen *specimen,
                      double factor)
{
    for (int m = 0; m + 1 < specimen->n_markers; m++) {
        const double arc = specimen->markers[m + 1] - specimen->markers[m];
        if (fabs(check->link[m].mean - factor * arc) > 0.5 * LINK_TOLERANCE)
            return false;
    }
    return true;
}

bool wb_start_check_chain(const struct wb_start_check *check, const struct wb_specimen *specimen,
                          const struct wb_rig *rig, char text[WB_START_CHECK_TEXT])
{
    const int last = specimen->n_markers - 1;
    const double expected = rig->mocap.marker_noise > 0.0 ? rig->mocap.marker_noise : MARKER_NOISE;
    const double noise = place_noise(check, last + 1);
    const double length = specimen->markers[last] - specimen->markers[0];
    double chain = 0.0, worst = 0.0;
    int at = 0;
    if (check->n_full < LEAST_FULL_FRAMES)
        return true;
    for (int m = 0; m < last; m++) {
        const double off = check->link[m].mean - (specimen->markers[m + 1] - specimen->markers[m]);
        chain += check->link[m].mean;
        if (fabs(off) > fabs(worst)) {
            worst = off;
            at = m;
        }
    }
    const double factor = chain / length;
    if (noise == 0.0)
        snprintf(
            text, WB_START_CHECK_TEXT,
            "the positions of all markers are identical in %d frames: the take is probably paused; "
            "set Motive to live mode",
            check->n_frames);
    else if (!(noise <= NOISE_TIMES * expected))
        snprintf(text, WB_START_CHECK_TEXT,
                 "marker noise is %.2f mm, more than %.2f mm: check whether the wire swings or the "
                 "stage vibrates; otherwise calibrate the cameras or set mocap.marker_noise_mm",
                 noise / WB_MM, NOISE_TIMES * expected / WB_MM);
    else if (!(fabs(chain - length) <= fmax(CHAIN_TOLERANCE, CHAIN_SHARE * length)) &&
             is_scaled(check, specimen, factor))
        snprintf(text, WB_START_CHECK_TEXT,
                 "the cameras measure %.1f mm from the first to the last marker, but markers_mm of "
                 "the specimen file gives %.1f mm: measure with a ruler; if the file is right, the "
                 "cameras' scale is off by %+.1f %%: calibrate them with the wand",
                 chain / WB_MM, length / WB_MM, (factor - 1.0) / WB_PERCENT);
    else if (!(fabs(worst) <= LINK_TOLERANCE))
        snprintf(
            text, WB_START_CHECK_TEXT,
            "markers %d and %d (counted from one end) are %.1f mm apart, but markers_mm of the "
            "specimen file gives %.1f mm: move the marker or correct the file",
            at + 1, at + 2, check->link[at].mean / WB_MM, (check->link[at].mean - worst) / WB_MM);
    else
        return true;
    return false;
}

bool wb_start_check_zero(const struct wb_start_check *check, const struct wb_rig *rig,
                         const char *rig_path, char text[WB_START_CHECK_TEXT])
{
    const struct wb_rig_load_cell *const cell = &rig->load_cell;
    const double zero = check->load.mean, expected = wb_rig_tare_load(rig);
    const double noise = wb_average_deviation(&check->load);
    const double noise_allowed = wb_rig_noise_allowed(cell);
    double allowed = ZERO_SHARE * cell->capacity;
    if (expected > 0.0)
        allowed = fmin(allowed, COUNTERWEIGHT_SHARE * expected);
    if (!(fabs(zero - expected) <= allowed) && expected > 0.0) {
        snprintf(text, WB_START_CHECK_TEXT,
                 "the load cell reads %.2f mN; expected the counterweight's %.2f mN within %.2f mN "
                 "(load_cell.tare is counterweight): check that the counterweight hangs freely, "
                 "that the cell was zeroed without it, and the cell's unit; after a stop run "
                 "'wirebench stage %s release'",
                 zero / WB_MN, expected / WB_MN, allowed / WB_MN, rig_path);
        return false;
    }
    if (!(fabs(zero - expected) <= allowed)) {
        snprintf(text, WB_START_CHECK_TEXT,
                 "the unloaded load cell reads %.2f mN, more than %g %% of its capacity of %.1f "
                 "mN: check that the strand is slack (after a stop run 'wirebench stage %s "
                 "release'), that the cell is zeroed, and its unit",
                 zero / WB_MN, ZERO_SHARE / WB_PERCENT, cell->capacity / WB_MN, rig_path);
        return false;
    }
    if (!(noise <= noise_allowed)) {
        snprintf(text, WB_START_CHECK_TEXT,
                 "the %s load cell's noise is %.3f mN, more than %.3f mN: check that nothing "
                 "touches it and that the counterweight does not swing",
                 expected > 0.0 ? "resting" : "unloaded", noise / WB_MN, noise_allowed / WB_MN);
        return false;
    }
    return true;
}
