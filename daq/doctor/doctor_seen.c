#include "daq/doctor/doctor_seen.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/units.h"

static void note_load(void *context, const struct wb_load_sample *sample)
{
    struct wb_doctor_seen *const seen = context;
    struct wb_doctor_trend *const trend = &seen->trend;
    if (!seen->listening || !sample->valid)
        return;
    wb_average_add(&seen->check.load, sample->force);
    if (trend->n == 0.0) {
        trend->first_ns = sample->t_ns;
        trend->lowest = trend->highest = sample->force;
    }
    const double t = wb_seconds_from_ns(sample->t_ns - trend->first_ns);
    trend->n++;
    trend->t += t;
    trend->f += sample->force;
    trend->tt += t * t;
    trend->tf += t * sample->force;
    trend->lowest = fmin(trend->lowest, sample->force);
    trend->highest = fmax(trend->highest, sample->force);
}

double wb_doctor_trend_slope(const struct wb_doctor_trend *trend, double *error)
{
    const double spread = trend->tt - trend->t * trend->t / trend->n;
    *error = (double)INFINITY;
    if (!(trend->n >= 3.0) || !(spread > 0.0))
        return 0.0;
    /* Bounds the scatter about the line by the range of the readings. */
    *error = 0.25 * (trend->highest - trend->lowest) / sqrt(spread);
    return (trend->tf - trend->t * trend->f / trend->n) / spread;
}

static int count_measured(const struct wb_mocap_frame *frame)
{
    int n = 0;
    for (int i = 0; i < frame->n_markers; i++)
        n += wb_acquisition_marker_measured(&frame->markers[i]);
    return n;
}

static void note_mocap(void *context, const struct wb_mocap_frame *frame)
{
    struct wb_doctor_seen *const seen = context;
    const int n = count_measured(frame);
    if (!seen->listening)
        return;
    if (seen->specimen)
        wb_start_check_frame(&seen->check, frame, seen->specimen);
    if (seen->n_frames++ == 0 || n >= seen->frame_measured) {
        seen->frame = *frame;
        seen->frame_measured = n;
    }
    const bool later = seen->n_stamps == 0 || frame->t_device > seen->stamps[seen->n_stamps - 1];
    if (isfinite(frame->t_device) && later && seen->n_stamps < WB_DOCTOR_FRAMES) {
        seen->stamps[seen->n_stamps] = frame->t_device;
        seen->arrivals[seen->n_stamps++] = frame->t_ns;
    }
}

static void note_probe(void *context, const struct wb_clock_probe *probe)
{
    struct wb_doctor_seen *const seen = context;
    if (seen->n_probes < WB_DOCTOR_PROBES)
        seen->probes[seen->n_probes++] = *probe;
}

static void note_remark(void *context, enum wb_log_level level, int64_t t_ns, const char *kind,
                        const char *text)
{
    struct wb_doctor_seen *const seen = context;
    const enum wb_role role = *seen->source;
    int i = 0;
    (void)t_ns;
    while (i < seen->n_remarks[role] && strcmp(seen->remarks[role][i].kind, kind) != 0)
        i++;
    if (i == WB_DOCTOR_REMARKS)
        return;
    struct wb_doctor_remark *const remark = &seen->remarks[role][i];
    /* A later remark does not replace a more severe one of the same kind. */
    if (i < seen->n_remarks[role] && level > remark->level)
        return;
    seen->n_remarks[role] += i == seen->n_remarks[role];
    remark->level = level;
    snprintf(remark->kind, sizeof remark->kind, "%s", kind);
    snprintf(remark->text, sizeof remark->text, "%s", text);
}

struct wb_sink wb_doctor_seen_sink(struct wb_doctor_seen *seen)
{
    return (struct wb_sink){.context = seen,
                            .load = note_load,
                            .mocap = note_mocap,
                            .probe = note_probe,
                            .remark = note_remark};
}

const struct wb_doctor_remark *wb_doctor_seen_remark(const struct wb_doctor_seen *seen,
                                                     enum wb_role role, const char *kind)
{
    for (int i = 0; i < seen->n_remarks[role]; i++)
        if (strcmp(seen->remarks[role][i].kind, kind) == 0)
            return &seen->remarks[role][i];
    return NULL;
}
