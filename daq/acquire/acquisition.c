#include "daq/acquire/acquisition.h"
#include "daq/acquire/acquisition_private.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include "base/interrupt.h"
#include "base/timing.h"
#include "base/units.h"
#include "daq/acquire/remark_gate.h"
#include "daq/protocol/drivers.h"
#include "daq/stream/stream.h"

#define WB_LOG_DOMAIN "acquisition"

/* Period of the drivers' ticks, and therefore also the longest reaction time to Ctrl-C. */
#define TICK_NS (20 * WB_NS_PER_MS)
/* Reads of one stream in one step, at most, so that a flood on one cannot starve the others. */
#define READS_A_STEP 64
/* A delay of the loop longer than this counts as a stall. */
#define STALL_NS (30 * WB_NS_PER_MS)
/* Stalls longer than this are reported: the stage may have moved unwatched for a second. */
#define REPORTED_STALL_NS (1000 * WB_NS_PER_MS)
/* A loss that lasts longer than this is reported: late frames are missing only until they arrive.
 */
#define LASTING_LOSS_NS (500 * WB_NS_PER_MS)
#define RATE_PERIOD_NS (500 * WB_NS_PER_MS) /* over which sample rates are measured */
#define REOPEN_NS (100 * WB_NS_PER_MS)      /* between two attempts to reopen a port */

/* One open stream with its driver. */
struct line {
    struct wb_acquisition *owner;
    enum wb_role role;
    const struct wb_driver *driver;
    void *state;
    struct wb_stream *stream;
    int id; /* in the recording */
    bool reported_lost, reported_loss;
    int64_t losing_ns;      /* time since which samples are missing; 0: none are */
    int64_t write_again_ns; /* next write attempt after the port accepted no bytes */
    int64_t gone_ns;        /* when its device was disconnected */
    int64_t reopen_ns;      /* next attempt to reopen it */
    uint64_t counted;       /* valid samples so far */
    uint64_t rate_from;     /* counted at rate_ns */
    int64_t rate_ns;
    bool has_rate;
    struct wb_remark_gate gate;
    uint64_t kernel_drops; /* datagrams dropped by the kernel that have been reported */
    struct wb_loss loss;   /* by the frames' time stamps, or by the arrival of lines */
};

struct wb_acquisition {
    struct wb_rig rig;
    struct wb_sink sinks[2]; /* receive every sample, in this order */
    struct wb_writer *writer;
    int n_lines;
    struct line lines[WB_INTERLOCK_ROLES];
    struct line *by_role[WB_INTERLOCK_ROLES];
    struct wb_interlock interlock;
    struct wb_stop stop;
    bool moving, started, hold_sent;
    enum wb_stop_state reported_stop;
    struct wb_acquisition_latest latest;
    int64_t next_tick_ns;
    int64_t woken_ns;   /* end of the last wait for bytes */
    int64_t storage_ns; /* arrival of the oldest data that are not on the disk */
    int64_t stalled_ns; /* sum of all stalls since the start */
    struct wb_outbox outbox;
    uint8_t buffer[WB_STREAM_READ_MAX];
};

static void push_text(struct wb_acquisition *a, int64_t t_ns, const char *kind, const char *format,
                      va_list arguments)
{
    char text[sizeof((struct wb_event *)0)->text];
    vsnprintf(text, sizeof text, format, arguments);
    if (a->writer)
        wb_writer_push_event(a->writer, t_ns, kind, text);
}

/* Records an event, if there is a recording. */
static void __attribute__((format(printf, 4, 5)))
push_event(struct wb_acquisition *a, int64_t t_ns, const char *kind, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    push_text(a, t_ns, kind, format, arguments);
    va_end(arguments);
}

/* Records an event and warns with the same text. */
#define REPORT(a, t_ns, kind, ...)                                                                 \
    (push_event((a), (t_ns), (kind), __VA_ARGS__), wb_warn(__VA_ARGS__))

void wb_acquisition_raise_priority(void)
{
    if (!wb_time_is_virtual() && setpriority(PRIO_PROCESS, 0, -15) != 0)
        wb_debug("the scheduling priority cannot be raised: %s", strerror(errno));
}

bool wb_acquisition_marker_measured(const struct wb_marker *marker)
{
    return (marker->params & (WB_MARKER_OCCLUDED | WB_MARKER_MODEL_FILLED)) == 0;
}

void wb_acquisition_event(struct wb_acquisition *a, const char *kind, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    push_text(a, wb_time_now_ns(), kind, format, arguments);
    va_end(arguments);
}

/* --- sending --- */

/* A disconnected stage counts as lost at once. A disconnected load cell may be reconnected within
 * its allowed silence. */
static void lose_device(struct line *line)
{
    struct wb_acquisition *const a = line->owner;
    a->latest.stream[line->role].gone = true;
    line->gone_ns = wb_time_now_ns();
    line->reopen_ns = line->gone_ns + REOPEN_NS;
    if (line->role == WB_ROLE_STAGE)
        a->interlock.lost[line->role] = true;
}

/* False if a write would block. Checked before all writes that are not urgent, because waiting for
 * one instrument must not delay the hold byte to another. */
static bool is_writable(const struct line *line)
{
    int descriptors[2];
    if (wb_stream_descriptors(line->stream, descriptors) == 0)
        return true;
    struct pollfd polled = {.fd = descriptors[0], .events = POLLOUT};
    return poll(&polled, 1, 0) > 0;
}

/* Writes the contents of the outbox and empties it. After a port accepted no bytes, writes to it
 * are skipped for a second, so that waiting for it cannot delay the others; urgent bytes are always
 * written. */
static enum wb_status send_outbox(struct line *line, bool urgent)
{
    struct wb_acquisition *const a = line->owner;
    struct wb_outbox *const outbox = &a->outbox;
    enum wb_status status = WB_OK;
    const int64_t now_ns = wb_time_now_ns();
    size_t begin = 0;
    if (a->latest.stream[line->role].gone)
        status = WB_ERR_IO;
    else if (!urgent && now_ns < line->write_again_ns)
        status = WB_ERR_TIMEOUT;
    else if (!urgent && outbox->n_entries > 0 && !is_writable(line)) {
        line->write_again_ns = now_ns + WB_NS_PER_S;
        status = WB_ERR_TIMEOUT;
    }
    for (size_t i = 0; status == WB_OK && i < outbox->n_entries; i++) {
        status = wb_stream_write(line->stream, outbox->bytes + begin, outbox->ends[i] - begin);
        begin = outbox->ends[i];
        if (status == WB_ERR_TIMEOUT)
            line->write_again_ns = now_ns + WB_NS_PER_S;
        /* A failed datagram does not disconnect a network stream. */
        else if (status != WB_OK && line->role != WB_ROLE_MOCAP)
            lose_device(line);
    }
    wb_outbox_clear(outbox);
    return status;
}

static enum wb_status send_command(struct line *line, enum wb_stage_command command,
                                   double distance, double speed)
{
    struct wb_acquisition *const a = line->owner;
    wb_outbox_clear(&a->outbox);
    const enum wb_status status =
        line->driver->command(line->state, command, distance, speed, &a->outbox);
    if (status != WB_OK) {
        wb_outbox_clear(&a->outbox);
        return status;
    }
    const bool urgent = command == WB_STAGE_COMMAND_HOLD || command == WB_STAGE_COMMAND_SOFT_RESET;
    return send_outbox(line, urgent);
}

/* --- stopping --- */

/* Called when the interlock trips: sends the hold byte before anything else. */
static void hold_now(struct wb_acquisition *a)
{
    if (a->stop.state != WB_STOP_NONE)
        return;
    struct line *const stage = a->by_role[WB_ROLE_STAGE];
    enum wb_status status = WB_OK;
    if (stage && a->moving)
        status = send_command(stage, WB_STAGE_COMMAND_HOLD, 0.0, 0.0);
    a->hold_sent = status == WB_OK;
    const int64_t now_ns = wb_time_now_ns();
    if (!stage || !a->moving)
        wb_stop_settle(&a->stop, WB_STOP_STANDING, now_ns);
    else
        wb_stop_begin(&a->stop, now_ns);
    if (stage && a->latest.stream[WB_ROLE_STAGE].gone && a->moving)
        wb_stop_settle(&a->stop, WB_STOP_FAILED, now_ns);
    if (a->interlock.reason != WB_INTERLOCK_INTERRUPT)
        push_event(a, a->interlock.t_ns, "limit", "%s", a->interlock.text);
    if (stage && a->moving && status == WB_OK)
        push_event(a, now_ns, "hold", "{\"reason\": \"%s\", \"latency_ms\": %.3f}",
                   wb_interlock_reason_name(a->interlock.reason),
                   (double)(now_ns - a->interlock.t_ns) / 1e6);
    else if (stage && a->moving)
        push_event(a, now_ns, "hold", "the hold byte could not be sent to the stage");
}

/* Records the result of a completed stop, once. */
static void report_stop(struct wb_acquisition *a)
{
    if (!wb_stop_over(&a->stop) || a->reported_stop == a->stop.state)
        return;
    a->reported_stop = a->stop.state;
    if (!a->moving)
        return;
    if (a->stop.state == WB_STOP_STANDING) {
        a->moving = false;
        push_event(a, a->stop.confirmed_ns, "stopped",
                   "{\"confirmed_ms\": %.3f, \"soft_reset\": %s}",
                   (double)(a->stop.confirmed_ns - a->stop.hold_ns) / 1e6,
                   a->stop.reset_ns ? "true" : "false");
    } else {
        push_event(a, a->stop.confirmed_ns, "stopped",
                   "not confirmed: the stage may still be moving");
    }
}

/* Takes the next step of a stop in progress. */
static void follow_stop(struct wb_acquisition *a, int64_t now_ns)
{
    struct line *const stage = a->by_role[WB_ROLE_STAGE];
    if (!stage || a->stop.state == WB_STOP_NONE)
        return;
    const bool was_over = wb_stop_over(&a->stop);
    enum wb_status status = WB_OK;
    switch (wb_stop_tick(&a->stop, now_ns)) {
    case WB_STOP_DO_ASK:
        if (a->stop.state == WB_STOP_HOLDING && !a->hold_sent)
            a->hold_sent = send_command(stage, WB_STAGE_COMMAND_HOLD, 0.0, 0.0) == WB_OK;
        status = send_command(stage, WB_STAGE_COMMAND_STATUS, 0.0, 0.0);
        break;
    case WB_STOP_DO_RESET:
        status = send_command(stage, WB_STAGE_COMMAND_SOFT_RESET, 0.0, 0.0);
        wb_warn("the stage did not confirm the feed hold within %d ms: a soft reset is sent",
                (int)(WB_STOP_CONFIRM_NS / WB_NS_PER_MS));
        push_event(a, wb_time_now_ns(), "reset",
                   status == WB_OK ? "hold not confirmed in time: soft reset sent"
                                   : "the soft reset could not be sent");
        break;
    case WB_STOP_DO_NOTHING:
        break;
    }
    if (!was_over && a->latest.stream[WB_ROLE_STAGE].gone)
        wb_stop_settle(&a->stop, WB_STOP_FAILED, now_ns);
    report_stop(a);
}

void wb_acquisition_stop(struct wb_acquisition *a, enum wb_interlock_reason reason,
                         const char *text)
{
    if (wb_interlock_trip(&a->interlock, reason, wb_time_now_ns(), "%s", text))
        hold_now(a);
}

void wb_acquisition_clear_stop(struct wb_acquisition *a)
{
    const struct wb_interlock_settings settings = a->interlock.settings;
    bool lost[WB_INTERLOCK_ROLES];
    memcpy(lost, a->interlock.lost, sizeof lost);
    wb_interlock_init(&a->interlock, &settings, wb_time_now_ns());
    memcpy(a->interlock.lost, lost, sizeof lost);
    memset(&a->stop, 0, sizeof a->stop);
    a->reported_stop = WB_STOP_NONE;
}

/* --- the caller's side of stage and interlock --- */

void wb_acquisition_arm(struct wb_acquisition *a, const struct wb_interlock_settings *settings,
                        double start_position)
{
    if (a->interlock.reason != WB_INTERLOCK_NONE)
        return;
    wb_interlock_init(&a->interlock, settings, wb_time_now_ns());
    a->interlock.armed = true;
    if (!isfinite(start_position) && a->latest.has_stage)
        start_position = a->latest.stage.position;
    a->interlock.start_position = start_position;
    /* Streams that are not open cannot fall silent. */
    for (int role = 0; role < WB_INTERLOCK_ROLES; role++)
        if (!a->by_role[role])
            a->interlock.settings.stream_lost_ns[role] = 0;
}

void wb_acquisition_disarm(struct wb_acquisition *a)
{
    a->interlock.armed = false;
}

void wb_acquisition_set_tare(struct wb_acquisition *a, double tare)
{
    a->interlock.tare = tare;
}

const struct wb_interlock *wb_acquisition_interlock(const struct wb_acquisition *a)
{
    return &a->interlock;
}

enum wb_status wb_acquisition_command(struct wb_acquisition *a, enum wb_stage_command command,
                                      double distance, double speed)
{
    struct line *const stage = a->by_role[WB_ROLE_STAGE];
    if (!stage)
        return wb_fail(WB_ERR_UNSUPPORTED, "no stage is open");
    if (a->stop.state != WB_STOP_NONE && command != WB_STAGE_COMMAND_STATUS)
        return WB_ERR_ARGUMENT;
    const bool moves = command == WB_STAGE_COMMAND_JOG || command == WB_STAGE_COMMAND_HOME;
    const bool was_moving = a->moving;
    if (command != WB_STAGE_COMMAND_STATUS)
        a->latest.stage_error[0] = '\0';
    /* Set before sending: after a partial write the stage may move. */
    a->moving = a->moving || moves;
    const enum wb_status status = send_command(stage, command, distance, speed);
    if (status == WB_ERR_BUSY)
        a->moving = was_moving;
    return status;
}

void wb_acquisition_motion_ended(struct wb_acquisition *a)
{
    a->moving = false;
}

bool wb_acquisition_moving(const struct wb_acquisition *a)
{
    return a->moving;
}

const struct wb_stop *wb_acquisition_stop_state(const struct wb_acquisition *a)
{
    return &a->stop;
}

/* --- samples from the drivers --- */

/* Passes a sample to both sinks. */
#define PASS_ON(a, member, ...)                                                                    \
    do {                                                                                           \
        for (int i_ = 0; i_ < 2; i_++)                                                             \
            if ((a)->sinks[i_].member)                                                             \
                (a)->sinks[i_].member((a)->sinks[i_].context, __VA_ARGS__);                        \
    } while (0)

static void on_load(void *context, const struct wb_load_sample *sample)
{
    struct line *const line = context;
    struct wb_acquisition *const a = line->owner;
    if (wb_interlock_load(&a->interlock, sample))
        hold_now(a);
    a->latest.stream[WB_ROLE_LOAD].samples++;
    a->latest.unit_contradicts = sample->unit_contradicts;
    wb_loss_add(&line->loss, wb_seconds_from_ns(sample->t_ns));
    if (sample->valid) {
        line->counted++;
        a->latest.has_load = true;
        a->latest.load = *sample;
    }
    PASS_ON(a, load, sample);
}

static void on_mocap(void *context, const struct wb_mocap_frame *frame)
{
    struct line *const line = context;
    struct wb_acquisition *const a = line->owner;
    wb_interlock_mocap(&a->interlock, frame->t_ns);
    wb_loss_add(&line->loss, frame->t_device);
    a->latest.stream[WB_ROLE_MOCAP].samples++;
    line->counted++;
    a->latest.has_mocap = true;
    a->latest.markers_seen = 0;
    for (int i = 0; i < frame->n_markers; i++)
        if (wb_acquisition_marker_measured(&frame->markers[i]))
            a->latest.markers_seen++;
    PASS_ON(a, mocap, frame);
}

static void on_stage(void *context, const struct wb_stage_report *report)
{
    struct line *const line = context;
    struct wb_acquisition *const a = line->owner;
    if (wb_interlock_stage(&a->interlock, report))
        hold_now(a);
    wb_stop_report(&a->stop, report);
    a->latest.stream[WB_ROLE_STAGE].samples++;
    line->counted++;
    a->latest.has_stage = true;
    a->latest.stage = *report;
    a->latest.stage_reports++;
    PASS_ON(a, stage, report);
}

static void on_settings(void *context, const struct wb_stage_settings *settings)
{
    struct line *const line = context;
    struct wb_acquisition *const a = line->owner;
    a->latest.has_settings = true;
    a->latest.settings = *settings;
    if (a->writer)
        wb_writer_push_meta(a->writer, "stage_settings", settings->text);
    PASS_ON(a, settings, settings);
}

static void on_probe(void *context, const struct wb_clock_probe *probe)
{
    struct line *const line = context;
    struct wb_acquisition *const a = line->owner;
    const int64_t rtt_ns = probe->t_received_ns - probe->t_sent_ns;
    if (a->writer)
        (void)wb_writer_push_clock(a->writer, line->id, probe->t_sent_ns + rtt_ns / 2,
                                   probe->t_device, rtt_ns);
    PASS_ON(a, probe, probe);
}

static void on_remark(void *context, enum wb_log_level level, int64_t t_ns, const char *kind,
                      const char *text)
{
    struct line *const line = context;
    struct wb_acquisition *const a = line->owner;
    if (line->role == WB_ROLE_STAGE && level <= WB_LOG_WARNING)
        snprintf(a->latest.stage_error, sizeof a->latest.stage_error, "%s", text);
    unsigned held;
    const bool store = wb_remark_gate_store(&line->gate, t_ns, &held);
    if (held > 0)
        push_event(a, t_ns, "remarks",
                   "%u more remarks on the %s stream within the same second were not stored", held,
                   wb_role_name(line->role));
    if (store)
        push_event(a, t_ns, kind, "%s", text);
    /* All remarks are recorded; only warnings are also shown to the operator. */
    if (level > WB_LOG_WARNING)
        wb_debug("%s: %s", wb_role_name(line->role), text);
    else if (wb_remark_gate_show(&line->gate, t_ns, kind))
        wb_warn("%s: %s", wb_role_name(line->role), text);
    PASS_ON(a, remark, level, t_ns, kind, text);
}

/* Records and reports datagrams that the kernel dropped. */
static void note_kernel_drops(struct line *line, int64_t t_ns)
{
    const uint64_t drops = wb_stream_kernel_drops(line->stream);
    if (drops == line->kernel_drops)
        return;
    REPORT(line->owner, t_ns, "drop",
           "the %s stream lost %" PRIu64
           " datagrams that this computer did not read in time: close other programs",
           wb_role_name(line->role), drops - line->kernel_drops);
    line->kernel_drops = drops;
}

static struct wb_sink sink_of(struct line *line)
{
    return (struct wb_sink){.context = line,
                            .load = on_load,
                            .mocap = on_mocap,
                            .stage = on_stage,
                            .settings = on_settings,
                            .probe = on_probe,
                            .remark = on_remark};
}

static void read_line(struct line *line)
{
    struct wb_acquisition *const a = line->owner;
    struct wb_acquisition_stream_state *const state = &a->latest.stream[line->role];
    const struct wb_sink sink = sink_of(line);
    a->latest.source = line->role;
    for (int i = 0; i < READS_A_STEP && !state->gone; i++) {
        size_t n = 0;
        const enum wb_status status = wb_stream_read(line->stream, a->buffer, sizeof a->buffer, &n);
        if (status != WB_OK) {
            if (line->role != WB_ROLE_MOCAP)
                lose_device(line);
            return;
        }
        if (n == 0)
            return;
        /* Not the time of waking up: if this process stalls in between, the read also returns later
         * bytes, and a stamp before their arrival would spoil the fit of the clocks. */
        const int64_t t_ns = wb_time_now_ns();
        note_kernel_drops(line, t_ns);
        state->chunks++;
        state->bytes += n;
        wb_diagnosis_add(&state->heard, a->buffer, n);
        if (a->writer)
            (void)wb_writer_push_chunk(a->writer, line->id, t_ns, a->buffer, n);
        line->driver->receive(line->state, t_ns, a->buffer, n, &sink);
    }
}

/* --- the loop --- */

/* Sends queries and start commands. A failure needs no handling here: the replies show whether they
 * arrived, failed writes are logged, and a disconnected device is marked. */
static void send_unchecked(struct line *line)
{
    if (send_outbox(line, false) != WB_OK)
        wb_debug("the %s accepted no bytes", wb_role_name(line->role));
}

/* Reports a setting that could not be applied to the port. */
static void report_caution(const struct line *line, int64_t now_ns)
{
    const char *const caution = wb_stream_caution(line->stream);
    if (!caution[0])
        return;
    wb_warn("%s: %s", wb_role_name(line->role), caution);
    push_event(line->owner, now_ns, "latency", "%s", caution);
}

/* Tries to reopen the disconnected port of a load cell and starts the instrument again. An empty
 * chunk makes every decoder discard an incomplete line from before the interruption. */
static void try_to_reopen(struct line *line, int64_t now_ns)
{
    struct wb_acquisition *const a = line->owner;
    const struct wb_sink sink = sink_of(line);
    if (line->role != WB_ROLE_LOAD || now_ns < line->reopen_ns)
        return;
    line->reopen_ns = now_ns + REOPEN_NS;
    if (!wb_stream_reopen(line->stream))
        return;
    REPORT(a, now_ns, "reconnected",
           "the load cell's port was reconnected after %.2f s: after a loss of power the "
           "indicator has a different zero; check the force at the end of the test",
           wb_seconds_from_ns(now_ns - line->gone_ns));
    a->latest.stream[line->role].gone = false;
    line->write_again_ns = 0;
    report_caution(line, now_ns);
    if (a->writer)
        (void)wb_writer_push_chunk(a->writer, line->id, now_ns, "", 0);
    line->driver->receive(line->state, now_ns, NULL, 0, &sink);
    wb_outbox_clear(&a->outbox);
    line->driver->start(line->state, now_ns, &a->outbox);
    send_unchecked(line);
}

static void tick_lines(struct wb_acquisition *a, int64_t now_ns)
{
    for (int i = 0; i < a->n_lines; i++) {
        struct line *const line = &a->lines[i];
        if (a->latest.stream[line->role].gone)
            try_to_reopen(line, now_ns);
        if (a->latest.stream[line->role].gone)
            continue;
        wb_outbox_clear(&a->outbox);
        line->driver->tick(line->state, now_ns, &a->outbox);
        send_unchecked(line);
    }
    /* Missed ticks are skipped: catching up after a stall would cause a burst of commands. */
    a->next_tick_ns += TICK_NS;
    if (a->next_tick_ns <= now_ns)
        a->next_tick_ns = now_ns + TICK_NS;
}

/* Reports a lasting loss, once. */
static void report_loss(struct line *line, int64_t now_ns)
{
    const struct wb_acquisition_stream_state *const state = &line->owner->latest.stream[line->role];
    const char *const name = wb_role_name(line->role);
    if (!state->is_losing)
        line->losing_ns = 0;
    else if (line->losing_ns == 0)
        line->losing_ns = now_ns;
    if (line->losing_ns == 0 || now_ns - line->losing_ns < LASTING_LOSS_NS || line->reported_loss)
        return;
    line->reported_loss = true;
    push_event(line->owner, now_ns, "loss", "%s: %" PRIu64 " of %" PRIu64 " samples did not arrive",
               name, state->loss.missing, state->loss.received + state->loss.missing);
    wb_warn("samples of the %s stream are lost between instrument and computer: %" PRIu64 " so far",
            name, state->loss.missing);
}

static void note_losses(struct wb_acquisition *a, int64_t now_ns)
{
    for (int i = 0; i < a->n_lines; i++) {
        struct line *const line = &a->lines[i];
        struct wb_acquisition_stream_state *const state = &a->latest.stream[line->role];
        const bool lost = a->interlock.lost[line->role] || state->gone;
        if (lost != line->reported_lost) {
            push_event(a, now_ns, lost ? "stream_lost" : "stream_found", "%s",
                       wb_role_name(line->role));
            /* A disconnected device has been reported already. */
            if (lost && !state->gone)
                wb_warn("the %s stream is lost: no valid data arrive from %s",
                        wb_role_name(line->role), wb_stream_address(line->stream));
            else if (!lost)
                wb_info("the %s stream is back", wb_role_name(line->role));
            line->reported_lost = lost;
        }
        state->lost = lost;
        state->loss = wb_loss_counts(&line->loss);
        state->is_losing = wb_loss_is_significant(&line->loss);
        report_loss(line, now_ns);
        state->ready = !state->gone && line->driver->ready(line->state);
        state->drops = line->kernel_drops;
        if (a->writer)
            state->drops += wb_writer_drops(a->writer, line->id);
    }
}

static void note_rates(struct wb_acquisition *a, int64_t now_ns)
{
    for (int i = 0; i < a->n_lines; i++) {
        struct line *const line = &a->lines[i];
        const int64_t lasted_ns = now_ns - line->rate_ns;
        if (lasted_ns < RATE_PERIOD_NS)
            continue;
        const double rate =
            (double)(line->counted - line->rate_from) / wb_seconds_from_ns(lasted_ns);
        double *const smooth = &a->latest.stream[line->role].rate;
        *smooth = line->has_rate ? *smooth + 0.5 * (rate - *smooth) : rate;
        line->has_rate = line->has_rate || rate > 0.0;
        line->rate_from = line->counted;
        line->rate_ns = now_ns;
    }
}

/* A longer delay until data are on the disk is reported; the writer flushes ten times a second. */
#define STORAGE_LAG_NS (800 * WB_NS_PER_MS)

/* Reports a disk that fails or is too slow. The test continues; new data are kept in memory. */
static void watch_storage(struct wb_acquisition *a, int64_t now_ns)
{
    if (!a->writer)
        return;
    wb_writer_tick(a->writer);
    struct wb_writer_state *const state = &a->latest.storage;
    wb_writer_state(a->writer, state);
    const bool late = state->failing != WB_OK || state->lag_ns > STORAGE_LAG_NS;
    const char *const problem =
        state->failing != WB_OK ? "nothing can be written to the disk" : "the disk is too slow";
    if (late && !a->latest.is_storage_late) {
        a->storage_ns = now_ns - state->lag_ns;
        push_event(a, now_ns, "storage", "%s; new data are kept in memory", problem);
        wb_warn("%s: the data of the last %.1f s are in memory only%s", problem,
                wb_seconds_from_ns(state->lag_ns),
                state->failing != WB_OK ? "; make room on the disk during the test" : "");
    } else if (!late && a->latest.is_storage_late) {
        REPORT(a, now_ns, "storage", "all data are on the disk again after %.1f s",
               wb_seconds_from_ns(now_ns - a->storage_ns));
    }
    a->latest.is_storage_late = late;
}

/* Whether the port may still be reconnected within the allowed silence of the stream. */
static bool may_be_reconnected(const struct line *line)
{
    const struct wb_interlock *const interlock = &line->owner->interlock;
    return line->role == WB_ROLE_LOAD && interlock->settings.stream_lost_ns[line->role] > 0 &&
           !wb_interlock_expires(interlock, line->role, wb_time_now_ns());
}

/* Checks for Ctrl-C, disconnected devices and a full disk, which no sample shows. */
static void check_conditions(struct wb_acquisition *a)
{
    if (!a->interlock.armed || a->interlock.reason != WB_INTERLOCK_NONE)
        return;
    if (wb_interrupted()) {
        wb_acquisition_stop(a, WB_INTERLOCK_INTERRUPT, "stopped by the operator");
        return;
    }
    for (int i = 0; i < a->n_lines; i++) {
        struct line *const line = &a->lines[i];
        if (!a->latest.stream[line->role].gone || may_be_reconnected(line))
            continue;
        char text[WB_INTERLOCK_TEXT];
        snprintf(text, sizeof text, "the %s's port %s was disconnected: check its cable and power",
                 line->role == WB_ROLE_LOAD ? "load cell" : "stage",
                 wb_stream_address(line->stream));
        wb_acquisition_stop(a, WB_INTERLOCK_STREAM_LOST, text);
        return;
    }
    if (a->writer && wb_writer_status(a->writer) != WB_OK)
        wb_acquisition_stop(
            a, WB_INTERLOCK_DISK,
            "nothing can be written to the disk, and the memory for new data is nearly full");
}

/* Checks the streams for silence up to `until_ns`, a time before they were read: later data may not
 * have been read yet. A stream is read once more before it counts as lost, because the process may
 * have been suspended between waking up and reading the clock. */
static void judge_silence(struct wb_acquisition *a, int64_t until_ns)
{
    for (int i = 0; i < a->n_lines; i++) {
        struct line *const line = &a->lines[i];
        if (wb_interlock_expires(&a->interlock, line->role, until_ns))
            read_line(line);
    }
    if (wb_interlock_tick(&a->interlock, until_ns))
        hold_now(a);
}

/* Time in which this process could not run or wait for bytes does not count as silence of the
 * instruments: polled instruments could not be polled either. */
static void discount_stall(struct wb_acquisition *a, int64_t stalled_ns)
{
    if (stalled_ns < STALL_NS)
        return;
    a->stalled_ns += stalled_ns;
    wb_interlock_discount(&a->interlock, stalled_ns);
    if (stalled_ns < REPORTED_STALL_NS || !a->interlock.armed)
        return;
    REPORT(a, wb_time_now_ns(), "stall",
           "the recorder was stalled for %.1f s: no limit was checked in that time",
           wb_seconds_from_ns(stalled_ns));
}

static int64_t earlier(int64_t a, int64_t b)
{
    return a < b ? a : b;
}

/* Polls all descriptors until `deadline_ns`; marks the lines that have something to read. */
static enum wb_status wait_for_bytes(struct wb_acquisition *a, int64_t deadline_ns,
                                     bool readable[WB_INTERLOCK_ROLES], int64_t *woken_ns)
{
    struct pollfd polled[2 * WB_INTERLOCK_ROLES];
    int owner[2 * WB_INTERLOCK_ROLES];
    size_t n_polled = 0;
    for (int i = 0; i < a->n_lines; i++) {
        int descriptors[2];
        readable[i] = false;
        if (a->latest.stream[a->lines[i].role].gone)
            continue;
        const int n = wb_stream_descriptors(a->lines[i].stream, descriptors);
        readable[i] = n == 0; /* a memory stream has no descriptor and is always read */
        for (int k = 0; k < n; k++) {
            polled[n_polled] = (struct pollfd){.fd = descriptors[k], .events = POLLIN};
            owner[n_polled++] = i;
        }
    }
    const int n_ready = wb_time_wait(polled, n_polled, deadline_ns);
    *woken_ns = wb_time_now_ns();
    if (n_ready < 0 && errno != EINTR)
        return wb_fail(WB_ERR_IO, "waiting for the instruments failed: %s", strerror(errno));
    for (size_t k = 0; n_ready > 0 && k < n_polled; k++)
        if (polled[k].revents != 0)
            readable[owner[k]] = true;
    return WB_OK;
}

enum wb_acquisition_end wb_acquisition_step(struct wb_acquisition *a, int64_t timeout_ns)
{
    bool readable[WB_INTERLOCK_ROLES];
    int64_t woken_ns;
    const int64_t begun_ns = wb_time_now_ns();
    int64_t deadline_ns = begun_ns + (timeout_ns > 0 ? timeout_ns : 0);
    deadline_ns = earlier(deadline_ns, a->next_tick_ns);
    deadline_ns = earlier(deadline_ns, wb_interlock_deadline(&a->interlock));
    deadline_ns = earlier(deadline_ns, wb_stop_deadline(&a->stop));
    if (wait_for_bytes(a, deadline_ns, readable, &woken_ns) != WB_OK)
        return WB_ACQUISITION_FAILED;
    /* A stall is the time from the last waking up to the beginning of this wait, plus the time from
     * the end of the wait to waking up. If the wait began late, its deadline had already passed. */
    const int64_t end_ns = deadline_ns > begun_ns ? deadline_ns : begun_ns;
    discount_stall(a, begun_ns - a->woken_ns + (woken_ns > end_ns ? woken_ns - end_ns : 0));
    a->woken_ns = woken_ns;
    for (int i = 0; i < a->n_lines; i++)
        if (readable[i])
            read_line(&a->lines[i]);
    check_conditions(a);
    judge_silence(a, woken_ns);
    const int64_t now_ns = wb_time_now_ns();
    follow_stop(a, now_ns);
    if (now_ns >= a->next_tick_ns)
        tick_lines(a, now_ns);
    note_losses(a, now_ns);
    note_rates(a, now_ns);
    watch_storage(a, now_ns);
    for (int i = 0; i < a->n_lines; i++)
        if (!a->latest.stream[a->lines[i].role].gone)
            return WB_ACQUISITION_CONTINUE;
    return WB_ACQUISITION_DONE;
}

/* --- opening and closing --- */

/* An edge on DTR resets some controllers at each opening of the port; the stage would then lose its
 * position and have to be homed. */
static bool must_keep_dtr(const char *address)
{
    return strncmp(address, "serial:", 7) == 0 && !strstr(address, ",dtr=");
}

static enum wb_status open_line(struct wb_acquisition *a, enum wb_role role, const char *address,
                                const char *protocol, struct wb_reason *why)
{
    struct line *const line = &a->lines[a->n_lines];
    line->owner = a;
    line->role = role;
    wb_loss_init(&line->loss, role == WB_ROLE_MOCAP, 0.0);
    line->id = a->n_lines;
    line->driver = wb_drivers_find(role, protocol);
    if (!line->driver)
        return wb_fail_to(why, WB_ERR_UNSUPPORTED, "unknown %s protocol '%s'", wb_role_name(role),
                          protocol);
    line->state = calloc(1, line->driver->state_size);
    if (!line->state)
        return wb_fail_to(why, WB_ERR_MEMORY, "out of memory for the %s driver", protocol);
    enum wb_status status = line->driver->init(line->state, &a->rig);
    char kept[WB_RIG_TEXT + 16];
    snprintf(kept, sizeof kept, "%s%s", address,
             role == WB_ROLE_STAGE && must_keep_dtr(address) ? ",dtr=keep" : "");
    if (status == WB_OK)
        status = wb_stream_open_with_reason(&line->stream, kept, why);
    if (status != WB_OK) {
        free(line->state);
        memset(line, 0, sizeof *line);
        return status;
    }
    a->n_lines++; /* from here on wb_acquisition_close() frees the line */
    a->by_role[role] = line;
    a->latest.stream[role].open = true;
    a->latest.stream[role].caution = wb_stream_caution(line->stream);
    return WB_OK;
}

/* Opens the streams of `roles`; returns the status of the first failure. With `why` (indexed by
 * role) the others are opened nevertheless; NULL: the first failure is logged and is the last. */
static enum wb_status open_lines(struct wb_acquisition *a, unsigned roles, struct wb_reason *why)
{
    const struct wb_rig *const rig = &a->rig;
    const struct {
        const char *address, *protocol;
    } lines[WB_INTERLOCK_ROLES] = {
        [WB_ROLE_LOAD] = {rig->load_cell.address, rig->load_cell.protocol},
        [WB_ROLE_MOCAP] = {rig->mocap.address, rig->mocap.protocol},
        [WB_ROLE_STAGE] = {rig->stage.address, rig->stage.protocol},
    };
    enum wb_status first = WB_OK;
    for (int role = 0; role < WB_INTERLOCK_ROLES; role++) {
        if (!(roles & 1u << role))
            continue;
        const enum wb_status status = open_line(a, (enum wb_role)role, lines[role].address,
                                                lines[role].protocol, why ? &why[role] : NULL);
        first = first == WB_OK ? status : first;
        if (status != WB_OK && !why)
            break;
    }
    return first;
}

enum wb_status wb_acquisition_open_each(struct wb_acquisition **out, const struct wb_rig *rig,
                                        unsigned roles, const struct wb_sink *sink,
                                        struct wb_reason why[WB_INTERLOCK_ROLES])
{
    struct wb_acquisition *const a = calloc(1, sizeof *a);
    if (!a)
        return wb_fail(WB_ERR_MEMORY, "out of memory for the acquisition");
    a->rig = *rig;
    if (sink)
        a->sinks[0] = *sink;
    const enum wb_status status = open_lines(a, roles, why);
    if (status == WB_OK || (why && status != WB_ERR_MEMORY)) {
        *out = a;
        return WB_OK;
    }
    wb_acquisition_close(a);
    return why ? wb_fail(status, "out of memory for the acquisition") : status;
}

enum wb_status wb_acquisition_open(struct wb_acquisition **out, const struct wb_rig *rig,
                                   unsigned roles, const struct wb_sink *sink)
{
    return wb_acquisition_open_each(out, rig, roles, sink, NULL);
}

void wb_acquisition_add_sink(struct wb_acquisition *a, const struct wb_sink *sink)
{
    a->sinks[1] = *sink;
}

int wb_acquisition_stream(const struct wb_acquisition *a, enum wb_role role)
{
    return a->by_role[role] ? a->by_role[role]->id : -1;
}

void wb_acquisition_start(struct wb_acquisition *a, struct wb_writer *writer)
{
    const struct wb_interlock_settings unwatched = {0};
    const int64_t now_ns = wb_time_now_ns();
    a->writer = writer;
    a->started = true;
    a->next_tick_ns = now_ns + TICK_NS;
    a->woken_ns = now_ns;
    wb_interlock_init(&a->interlock, &unwatched, now_ns);
    for (int i = 0; i < a->n_lines; i++) {
        struct line *const line = &a->lines[i];
        line->rate_ns = now_ns;
        report_caution(line, now_ns);
        wb_outbox_clear(&a->outbox);
        line->driver->start(line->state, now_ns, &a->outbox);
        send_unchecked(line);
    }
}

void wb_acquisition_close(struct wb_acquisition *a)
{
    if (!a)
        return;
    for (int i = 0; i < a->n_lines; i++) {
        struct line *const line = &a->lines[i];
        if (a->started && line->driver->stop && !a->latest.stream[line->role].gone) {
            wb_outbox_clear(&a->outbox);
            line->driver->stop(line->state, &a->outbox);
            send_unchecked(line);
        }
        wb_stream_close(line->stream);
        free(line->state);
    }
    free(a);
}

int64_t wb_acquisition_listened_ns(const struct wb_acquisition *a)
{
    return a->woken_ns - a->stalled_ns;
}

const struct wb_acquisition_latest *wb_acquisition_latest(const struct wb_acquisition *a)
{
    return &a->latest;
}
