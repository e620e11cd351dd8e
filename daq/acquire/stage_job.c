#include "daq/acquire/stage_job.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/interrupt.h"
#include "base/units.h"
#include "daq/acquire/release.h"
#include "daq/acquire/stage_alarm.h"
#include "daq/acquire/stage_check.h"

#define WB_LOG_DOMAIN "stage"

/* A report within this time after a command may be older than the command. */
#define STALE_NS (300 * WB_NS_PER_MS)
#define RESET_NS (4 * WB_NS_PER_S)
#define HOMING_NS (180 * WB_NS_PER_S)

/* Release: near the end of the machine's travel steps become smaller, down to this length. */
#define LEAST_STEP (0.25 * WB_MM)
#define REST_NS (10 * WB_NS_PER_S) /* timeout for the readings of one rest */
#define GROWTH_SHARE 0.05          /* of the capacity: allowed growth of the force in a release */

enum phase {
    PHASE_CONNECT,
    PHASE_RESET,
    PHASE_UNLOCK,
    PHASE_HOME,
    PHASE_MOVE,
    PHASE_REST /* release: the stage stands and the load cell is read */
};

struct wb_stage_job {
    struct wb_sequence run;
    struct wb_stage_job_request request;
    double most, reach; /* m, release: longest step, and sum of all steps */
    double first_force; /* N; NaN before the first reading */
    struct wb_release release;
    bool standing;
};

static void finish(struct wb_stage_job *job)
{
    job->standing = true;
    wb_acquisition_disarm(job->run.acquisition);
    wb_sequence_enter(&job->run, WB_SEQUENCE_OVER);
}

static void on_load(void *context, const struct wb_load_sample *sample)
{
    struct wb_stage_job *const job = context;
    if (sample->valid && !isfinite(job->first_force))
        job->first_force = sample->force;
    if (job->run.phase == PHASE_REST)
        wb_release_add(&job->release, sample);
}

/* --- opening --- */

static unsigned roles_of(const struct wb_stage_job_request *request)
{
    if (request->kind == WB_STAGE_JOB_UNLOCK || request->without_load_cell)
        return WB_ACQUISITION_STAGE;
    return WB_ACQUISITION_STAGE | WB_ACQUISITION_LOAD;
}

enum wb_status wb_stage_job_open(struct wb_stage_job **out, const struct wb_rig *rig,
                                 const struct wb_stage_job_request *request)
{
    const double reach = fabs(request->distance);
    if (request->kind == WB_STAGE_JOB_JOG && !(reach >= 1e-6 && reach <= rig->stage.travel))
        return wb_fail(WB_ERR_ARGUMENT,
                       "jog: expected 0.001 mm to %g mm (the stage's travel) up or down, not %g mm",
                       rig->stage.travel / WB_MM, request->distance / WB_MM);
    if (request->kind == WB_STAGE_JOB_RELEASE && request->without_load_cell)
        return wb_fail(WB_ERR_ARGUMENT,
                       "release needs the load cell; without it run 'unlock', then 'jog'");
    struct wb_stage_job *const job = calloc(1, sizeof *job);
    if (!job)
        return wb_fail(WB_ERR_MEMORY, "out of memory for the stage's job");
    job->run.rig = *rig;
    job->request = *request;
    job->first_force = (double)NAN;
    job->run.start_position = (double)NAN;
    job->run.remedy = ", then run 'unlock'";
    if (!(job->request.connect_timeout > 0.0))
        job->request.connect_timeout = 6.0;
    if (!(job->request.speed > 0.0))
        job->request.speed =
            request->kind == WB_STAGE_JOB_RELEASE ? 0.5 * rig->stage.speed : rig->stage.speed;
    const struct wb_sink sink = {.context = job, .load = on_load};
    const enum wb_status status =
        wb_acquisition_open(&job->run.acquisition, rig, roles_of(request), &sink);
    if (status != WB_OK) {
        free(job);
        return status;
    }
    wb_acquisition_start(job->run.acquisition, NULL);
    wb_sequence_enter(&job->run, PHASE_CONNECT);
    *out = job;
    return WB_OK;
}

/* --- sequence --- */

static void arm(struct wb_stage_job *job)
{
    struct wb_interlock_settings settings;
    wb_interlock_default_settings(&settings, &job->run.rig);
    settings.rise = settings.travel = job->run.rig.stage.travel + 1.0 * WB_MM;
    if (job->request.kind == WB_STAGE_JOB_HOME) {
        /* A controller sends no reports while it is homing, and its position jumps at the end. */
        settings.stream_lost_ns[WB_ROLE_STAGE] = 0;
        settings.rise = settings.travel = 0.0;
        settings.alarm_allowed = true;
    }
    if (job->request.kind == WB_STAGE_JOB_RELEASE) {
        /* The force may exceed its limits at the beginning, but it must not grow. */
        const bool is_overloaded = !isfinite(job->first_force);
        /* The first number that an overloaded cell gives will be just below its overload. */
        const double force =
            is_overloaded ? job->run.rig.load_cell.overload : fabs(job->first_force);
        const double growth = GROWTH_SHARE * job->run.rig.load_cell.capacity;
        settings.force = fmax(settings.force, force + growth);
        if (is_overloaded || force + growth > settings.overload) {
            settings.overload = 0.0;
            settings.overload_allowed = true;
        }
    }
    wb_acquisition_arm(job->run.acquisition, &settings, job->run.start_position);
}

/* Release: begins a rest, whose readings show whether the strand is slack. */
static void begin_rest(struct wb_stage_job *job, double travel)
{
    wb_acquisition_motion_ended(job->run.acquisition);
    wb_sequence_enter(&job->run, PHASE_REST);
    wb_release_rest(&job->release, travel, job->run.phase_ns);
}

static void end_release(struct wb_stage_job *job)
{
    wb_acquisition_motion_ended(job->run.acquisition);
    finish(job);
}

/* m, longest travel of a test: a release needs at most the same travel up. */
static double longest_test(const struct wb_rig *rig)
{
    return rig->limits.travel > 0.0 ? rig->limits.travel : rig->stage.travel;
}

/* Release: begins the next step up, or ends the release at the end of the travel. */
static void step_up(struct wb_stage_job *job, double travel)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(job->run.acquisition);
    const double left = job->reach + travel;
    const double way_up =
        latest->has_settings
            ? wb_stage_check_way_up(&latest->settings, &job->run.rig, latest->stage.position)
            : HUGE_VAL;
    const double step = fmin(fmin(wb_release_step(&job->release), job->most), way_up);
    char now[40];
    const double force = wb_release_force(&job->release) / WB_MN;
    if (isfinite(force))
        snprintf(now, sizeof now, "%.2f mN now", force);
    else
        snprintf(now, sizeof now, "overload now");
    if (left <= WB_SEQUENCE_TOLERANCE)
        wb_sequence_set_end(
            &job->run, WB_SEQUENCE_STILL_LOADED,
            "moved up by %.2f mm, but the reading did not level off (%s): check the "
            "strand; if it is slack, the specimen is free; if not, run release "
            "again or jog up (jog -MM)",
            -travel / WB_MM, now);
    else if (step < LEAST_STEP)
        wb_sequence_set_end(
            &job->run, WB_SEQUENCE_STILL_LOADED,
            "moved up by %.2f mm to the end of the machine's travel, but the reading did not level "
            "off (%s): check the strand; if it is still taut, take the specimen out of its clamp; "
            "the stage can jog down",
            -travel / WB_MM, now);
    if (job->run.end != WB_SEQUENCE_RUNNING)
        end_release(job);
    else
        wb_sequence_jog_to(&job->run, travel - fmin(step, left), job->request.speed, PHASE_MOVE);
}

static void begin_motion(struct wb_stage_job *job)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(job->run.acquisition);
    const double distance = job->request.distance;
    if (job->request.kind == WB_STAGE_JOB_UNLOCK) {
        wb_sequence_set_end(&job->run, WB_SEQUENCE_DONE, "the stage is unlocked");
        finish(job);
        return;
    }
    job->run.start_position = latest->stage.position;
    arm(job);
    if (job->request.kind == WB_STAGE_JOB_HOME) {
        wb_sequence_send(&job->run, WB_STAGE_COMMAND_HOME, 0.0, job->request.speed, PHASE_HOME);
        return;
    }
    if (!isfinite(job->run.start_position)) {
        wb_sequence_give_up(&job->run, WB_INTERLOCK_STAGE,
                            "the stage does not report its position: set $10=1 in its firmware");
        return;
    }
    if (job->request.kind == WB_STAGE_JOB_RELEASE) {
        job->reach = fabs(distance) > 0.0 ? fmin(fabs(distance), job->run.rig.stage.travel)
                                          : longest_test(&job->run.rig);
        job->most = job->reach;
        wb_release_init(&job->release, &job->run.rig, job->request.zero);
        begin_rest(job, 0.0);
        return;
    }
    wb_sequence_jog_to(&job->run, job->request.distance, job->request.speed, PHASE_MOVE);
}

static void give_up_in_alarm(struct wb_stage_job *job, const struct wb_stage_report *report)
{
    char reason[256];
    wb_stage_alarm_reason(report, reason, sizeof reason);
    wb_sequence_give_up(
        &job->run, WB_INTERLOCK_ALARM,
        "the stage is in alarm (%s): remove the cause, then run 'home', or 'unlock' "
        "if it has no limit switch",
        reason);
}

static void step_connect(struct wb_stage_job *job)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(job->run.acquisition);
    const struct wb_acquisition_stream_state *const load = &latest->stream[WB_ROLE_LOAD];
    char cause[WB_DIAGNOSIS_TEXT];
    const bool load_speaks = !load->open || load->samples > 0;
    const bool stage_speaks = latest->has_stage && latest->stream[WB_ROLE_STAGE].ready;
    if (stage_speaks && load_speaks && wb_sequence_lasts_ns(&job->run) > STALE_NS) {
        const enum wb_stage_state state = latest->stage.state;
        const bool frees =
            job->request.kind == WB_STAGE_JOB_UNLOCK || job->request.kind == WB_STAGE_JOB_RELEASE;
        const bool locked =
            state == WB_STAGE_HOLD || state == WB_STAGE_ALARM || state == WB_STAGE_OTHER;
        const bool moving =
            state == WB_STAGE_RUN || state == WB_STAGE_JOG || state == WB_STAGE_HOME;
        if ((frees && locked) || (job->request.kind == WB_STAGE_JOB_UNLOCK && moving))
            wb_sequence_send(&job->run, WB_STAGE_COMMAND_SOFT_RESET, 0.0, job->request.speed,
                             PHASE_RESET);
        else if (state == WB_STAGE_IDLE ||
                 (job->request.kind == WB_STAGE_JOB_HOME && state == WB_STAGE_ALARM))
            begin_motion(job);
        else if (state == WB_STAGE_ALARM)
            give_up_in_alarm(job, &latest->stage);
        else if (state == WB_STAGE_HOLD)
            wb_sequence_give_up(
                &job->run, WB_INTERLOCK_STAGE,
                "the stage is on hold: run 'release' to free the specimen, or 'unlock'");
        else if (state == WB_STAGE_OTHER)
            wb_sequence_give_up(
                &job->run, WB_INTERLOCK_STAGE,
                "the stage is not idle (door open, check or sleep mode): run 'unlock'");
        else
            wb_sequence_give_up(
                &job->run, WB_INTERLOCK_STAGE,
                "the stage is moving at the command of another program: wait until it stops, or "
                "stop it with 'unlock'");
        return;
    }
    const int64_t allowed_ns =
        wb_ns_from_seconds(job->request.connect_timeout) + job->run.rig.load_cell.settle_ns;
    if (latest->stream[WB_ROLE_STAGE].gone)
        wb_sequence_give_up(&job->run, WB_INTERLOCK_STREAM_LOST,
                            "the stage's port %s was disconnected: check its cable and power",
                            job->run.rig.stage.address);
    else if (load->gone)
        wb_sequence_give_up(&job->run, WB_INTERLOCK_STREAM_LOST,
                            "the load cell's port %s was disconnected: check its cable and power",
                            job->run.rig.load_cell.address);
    else if (wb_sequence_lasts_ns(&job->run) > allowed_ns && !stage_speaks) {
        wb_diagnosis_stage(&latest->stream[WB_ROLE_STAGE].heard, &job->run.rig, cause);
        wb_sequence_give_up(&job->run, WB_INTERLOCK_STREAM_LOST,
                            "the stage at %s sent no status within %g s: %s",
                            job->run.rig.stage.address, job->request.connect_timeout, cause);
    } else if (wb_sequence_lasts_ns(&job->run) > allowed_ns) {
        wb_diagnosis_load(&load->heard, &latest->stream[WB_ROLE_STAGE].heard, &job->run.rig, cause);
        wb_sequence_give_up(&job->run, WB_INTERLOCK_STREAM_LOST,
                            "the load cell at %s sent no reading within %g s: %s; to move without "
                            "watching the force, use --without-load-cell",
                            job->run.rig.load_cell.address, job->request.connect_timeout, cause);
    }
}

/* True if a new report cannot be older than the command of this phase. */
static bool fresh_report(struct wb_stage_job *job, int64_t stale_ns)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(job->run.acquisition);
    if (latest->stage_reports == job->run.reports_seen)
        return false;
    job->run.reports_seen = latest->stage_reports;
    return latest->stage.t_ns > job->run.phase_ns + stale_ns;
}

static void step_reset(struct wb_stage_job *job)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(job->run.acquisition);
    if (fresh_report(job, STALE_NS)) {
        if (latest->stage.state == WB_STAGE_ALARM) {
            wb_sequence_send(&job->run, WB_STAGE_COMMAND_UNLOCK, 0.0, job->request.speed,
                             PHASE_UNLOCK);
            return;
        }
        if (latest->stage.state == WB_STAGE_IDLE) {
            begin_motion(job);
            return;
        }
    }
    if (wb_sequence_lasts_ns(&job->run) > RESET_NS)
        wb_sequence_give_up(
            &job->run, WB_INTERLOCK_STAGE,
            "the stage did not restart after its reset: switch it off and on, then run 'home'");
}

static void step_unlock(struct wb_stage_job *job)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(job->run.acquisition);
    if (fresh_report(job, STALE_NS) && latest->stage.state == WB_STAGE_IDLE)
        begin_motion(job);
    else if (wb_sequence_lasts_ns(&job->run) > RESET_NS)
        wb_sequence_give_up(&job->run, WB_INTERLOCK_STAGE, "the stage did not unlock%s%s",
                            latest->stage_error[0] ? ": " : "", latest->stage_error);
}

static void step_home(struct wb_stage_job *job)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(job->run.acquisition);
    if (latest->stage_error[0] && latest->stage.state != WB_STAGE_HOME) {
        wb_sequence_give_up(&job->run, WB_INTERLOCK_STAGE, "homing failed: %s",
                            latest->stage_error);
        return;
    }
    if (fresh_report(job, STALE_NS)) {
        if (latest->stage.state == WB_STAGE_IDLE)
            job->run.idle_reports++;
        else
            job->run.idle_reports = 0;
        if (job->run.idle_reports >= 2) {
            wb_acquisition_motion_ended(job->run.acquisition);
            wb_sequence_set_end(&job->run, WB_SEQUENCE_DONE, "the stage is homed");
            finish(job);
            return;
        }
    }
    if (wb_sequence_lasts_ns(&job->run) > HOMING_NS)
        wb_sequence_give_up(
            &job->run, WB_INTERLOCK_STAGE,
            "homing did not end within %d s: check the limit switch, then run 'unlock'",
            (int)(HOMING_NS / WB_NS_PER_S));
}

static void step_move(struct wb_stage_job *job)
{
    char text[80];
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(job->run.acquisition);
    if (wb_sequence_lasts_ns(&job->run) > job->run.allowed_ns)
        wb_sequence_give_up(
            &job->run, WB_INTERLOCK_STAGE,
            "the stage did not reach its target in time: check that nothing blocks it");
    if (!fresh_report(job, 0) || latest->stage.state != WB_STAGE_IDLE)
        return;
    const double travel = wb_sequence_travel(&job->run, latest->stage.position);
    const bool releases = job->request.kind == WB_STAGE_JOB_RELEASE;
    if (fabs(travel - job->run.target) <= WB_SEQUENCE_TOLERANCE && releases) {
        begin_rest(job, travel);
        return;
    }
    if (fabs(travel - job->run.target) <= WB_SEQUENCE_TOLERANCE) {
        wb_acquisition_motion_ended(job->run.acquisition);
        const bool is_off = wb_sequence_note_speed(&job->run, text, sizeof text);
        wb_sequence_set_end(&job->run, WB_SEQUENCE_DONE, "moved by %.3f mm%s%s", travel / WB_MM,
                            is_off ? " " : "", is_off ? text : "");
        finish(job);
        return;
    }
    job->run.idle_reports++;
    if (job->run.idle_reports >= 2 && releases &&
        strncmp(latest->stage_error, "error:15", 8) == 0) {
        job->most = 0.5 * fmin(wb_release_step(&job->release), job->most);
        step_up(job, travel);
        return;
    }
    /* The stage has stopped already; a feed hold would have to be released again. */
    if (job->run.idle_reports >= 2 && latest->stage_error[0]) {
        wb_acquisition_motion_ended(job->run.acquisition);
        wb_sequence_give_up(&job->run, WB_INTERLOCK_STAGE, "the stage stopped after %.2f mm: %s",
                            travel / WB_MM, latest->stage_error);
    } else if (job->run.idle_reports >= 5 && wb_sequence_lasts_ns(&job->run) > WB_NS_PER_S) {
        wb_acquisition_motion_ended(job->run.acquisition);
        wb_sequence_give_up(
            &job->run, WB_INTERLOCK_STAGE,
            "the stage stopped after %.2f mm of %.2f mm: check that nothing blocks it",
            travel / WB_MM, job->run.target / WB_MM);
    }
}

/* Release: ends with a level reading that does not prove a slack strand. */
static void end_level(struct wb_stage_job *job, enum wb_release_verdict verdict)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(job->run.acquisition);
    const double up = -wb_sequence_travel(&job->run, latest->stage.position) / WB_MM;
    const double force = wb_release_force(&job->release) / WB_MN;
    const double zero = job->request.zero / WB_MN;
    if (verdict == WB_RELEASE_LEVEL)
        wb_sequence_set_end(
            &job->run, WB_SEQUENCE_STILL_LOADED,
            "moved up by %.2f mm, and the reading no longer changes (%.2f mN): either the strand "
            "is "
            "slack, or the clamp does not follow the stage and the wire is still bent; check the "
            "strand before you touch the specimen; if it is slack, the specimen is free; with "
            "--zero-mn (record prints the value after a stop) release can distinguish the two",
            up, force);
    else if (isfinite(zero))
        wb_sequence_set_end(
            &job->run, WB_SEQUENCE_STILL_LOADED,
            "moved up by %.2f mm, but the reading stays at %.2f mN instead of the %.2f mN of a "
            "slack strand (--zero-mn): the clamp does not follow the stage and the wire is still "
            "bent, or the cell carries another load or was zeroed meanwhile; check clamp and "
            "strand before you touch the specimen",
            up, force, zero);
    else
        wb_sequence_set_end(&job->run, WB_SEQUENCE_STILL_LOADED,
                            "moved up by %.2f mm, but the reading stays at %.2f mN, more than a "
                            "slack strand can cause: check that the clamp follows the stage, the "
                            "strand and the load of the cell before you touch the specimen, then "
                            "jog",
                            up, force);
    end_release(job);
}

static void step_rest(struct wb_stage_job *job)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(job->run.acquisition);
    const enum wb_release_verdict verdict = wb_release_judge(&job->release);
    switch (verdict) {
    case WB_RELEASE_LISTEN:
        if (wb_sequence_lasts_ns(&job->run) > REST_NS)
            wb_sequence_give_up(
                &job->run, WB_INTERLOCK_STREAM_LOST,
                "the load cell at %s sends too few readings to detect a slack strand",
                job->run.rig.load_cell.address);
        break;
    case WB_RELEASE_GO_UP:
        /* Without a position the allowed travel is unknown: wait for the next report. */
        if (isfinite(latest->stage.position))
            step_up(job, wb_sequence_travel(&job->run, latest->stage.position));
        else if (wb_sequence_lasts_ns(&job->run) > REST_NS)
            wb_sequence_give_up(
                &job->run, WB_INTERLOCK_STREAM_LOST,
                "the stage does not report its position: set $10=1 in its firmware");
        break;
    case WB_RELEASE_SLACK:
        wb_sequence_set_end(&job->run, WB_SEQUENCE_DONE,
                            "the strand is slack: the specimen is free");
        end_release(job);
        break;
    case WB_RELEASE_LEVEL:
    case WB_RELEASE_STUCK:
        end_level(job, verdict);
        break;
    }
}

static void step_stop(struct wb_stage_job *job)
{
    const struct wb_stop *const stop = wb_acquisition_stop_state(job->run.acquisition);
    if (stop->state != WB_STOP_NONE && !wb_stop_over(stop))
        return;
    finish(job);
    job->standing = stop->state != WB_STOP_FAILED;
}

static const struct {
    const char *name;
    void (*step)(struct wb_stage_job *job);
} phases[] = {
    [PHASE_CONNECT] = {"connecting", step_connect}, [PHASE_RESET] = {"resetting", step_reset},
    [PHASE_UNLOCK] = {"unlocking", step_unlock},    [PHASE_HOME] = {"homing", step_home},
    [PHASE_MOVE] = {"moving", step_move},           [PHASE_REST] = {"reading", step_rest},
    [WB_SEQUENCE_STOP] = {"stopping", step_stop},   [WB_SEQUENCE_OVER] = {"end", NULL},
};

enum wb_sequence_end wb_stage_job_step(struct wb_stage_job *job, int64_t timeout_ns)
{
    if (job->run.phase == WB_SEQUENCE_OVER)
        return job->run.end;
    if (!wb_sequence_wait(&job->run, timeout_ns, true))
        return WB_SEQUENCE_RUNNING;
    phases[job->run.phase].step(job);
    return job->run.phase == WB_SEQUENCE_OVER ? job->run.end : WB_SEQUENCE_RUNNING;
}

void wb_stage_job_status(const struct wb_stage_job *job, struct wb_stage_job_status *status)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(job->run.acquisition);
    memset(status, 0, sizeof *status);
    status->phase = phases[job->run.phase].name;
    status->has_force = latest->has_load;
    status->force = latest->load.force;
    status->has_position = latest->has_stage && isfinite(latest->stage.position);
    status->position = latest->stage.position;
    status->moved = isfinite(job->run.start_position)
                        ? wb_sequence_travel(&job->run, latest->stage.position)
                        : 0.0;
    status->gravity = job->run.rig.gravity;
    status->is_virtual = job->run.rig.is_virtual;
}

void wb_stage_job_close(struct wb_stage_job *job, struct wb_stage_job_result *result)
{
    if (!job)
        return;
    if (job->run.phase < WB_SEQUENCE_STOP)
        wb_sequence_give_up(&job->run, WB_INTERLOCK_INTERRUPT, "stopped by the operator");
    while (wb_stage_job_step(job, 10 * WB_NS_PER_MS) == WB_SEQUENCE_RUNNING) {
    }
    if (result) {
        const struct wb_acquisition_latest *const latest =
            wb_acquisition_latest(job->run.acquisition);
        memset(result, 0, sizeof *result);
        result->end = job->run.end;
        memcpy(result->text, job->run.text, sizeof result->text);
        result->standing = job->standing;
        result->position = latest->has_stage ? latest->stage.position : (double)NAN;
        result->moved = wb_sequence_travel(&job->run, result->position);
        result->force = latest->has_load ? latest->load.force : (double)NAN;
        result->change = result->force - job->first_force;
    }
    wb_acquisition_close(job->run.acquisition);
    free(job);
}
