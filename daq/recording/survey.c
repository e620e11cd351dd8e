#include "daq/recording/survey.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "daq/recording/recording_foreign.h"
#include "daq/recording/recover.h"
#include "daq/recording/replay.h"

#define WB_LOG_DOMAIN "survey"

/* s, lower bound of the limit of silence: the stage reports a few times a second, and a computer
 * may stall. */
#define LEAST_LIMIT 0.6

struct survey_state {
    struct wb_survey *survey;
    int64_t next_seq[WB_SURVEY_STREAMS];
    /* Sum of the times without data of any stream, up to now and up to each stream's last chunk. */
    double quiet, quiet_before[WB_SURVEY_STREAMS]; /* s */
    bool has_tare;
};

static int find_stream(const struct wb_survey *survey, int id)
{
    for (int i = 0; i < survey->n_streams; i++) {
        if (survey->streams[i].id == id)
            return i;
    }
    return -1;
}

/* Sequence numbers begin at 0; a number above the expected one shows a gap. */
static void check_order(struct wb_survey_stream *stream, int64_t *next, int64_t seq)
{
    if (seq < *next) {
        stream->repeated++;
        return;
    }
    if (seq > *next) {
        stream->missing += (uint64_t)seq - (uint64_t)*next;
        stream->gaps++;
    }
    *next = seq == INT64_MAX ? seq : seq + 1;
}

/* Longer times without data of any stream count as a stall of the recording computer. */
#define SHORTEST_QUIET_NS (100 * WB_NS_PER_MS)

/* Updates the longest silence of a stream during which other streams sent data. */
static void note_alone(struct survey_state *state, int i, int64_t t_ns)
{
    struct wb_survey_stream *const stream = &state->survey->streams[i];
    const double all = wb_survey_seconds(stream->last_ns, t_ns);
    const double shared = state->quiet - state->quiet_before[i];
    if (!stream->is_file && stream->chunks > 0 && all < 1e9 &&
        all - shared > wb_seconds_from_ns(stream->alone_silent_ns))
        stream->alone_silent_ns = wb_ns_from_seconds(all - shared);
}

/* Only damaged time stamps have a difference that exceeds an int64_t. */
static void note_silence(struct wb_survey_stream *stream, int64_t t_ns)
{
    uint64_t silence_ns = (uint64_t)t_ns - (uint64_t)stream->last_ns;
    if (silence_ns > INT64_MAX)
        silence_ns = INT64_MAX;
    if ((int64_t)silence_ns > stream->longest_silence_ns)
        stream->longest_silence_ns = (int64_t)silence_ns;
}

static void check_time(struct wb_survey *survey, struct wb_survey_stream *stream, int64_t t_ns)
{
    if (survey->chunks == 0)
        survey->first_ns = t_ns;
    survey->last_ns = t_ns;
    if (stream->chunks == 0)
        stream->first_ns = t_ns;
    else
        note_silence(stream, t_ns);
    stream->last_ns = t_ns;
}

static enum wb_status look_at_chunk(void *context, const struct wb_chunk *chunk)
{
    struct survey_state *state = context;
    struct wb_survey *survey = state->survey;
    int i = find_stream(survey, chunk->stream);
    if (i < 0) {
        survey->undeclared++;
        return WB_OK;
    }
    struct wb_survey_stream *stream = &survey->streams[i];
    survey->damaged += !chunk->intact;
    stream->damaged += !chunk->intact;
    /* Count a damaged chunk only if its sequence number is the expected one. */
    if (!chunk->intact && chunk->seq != state->next_seq[i])
        return WB_OK;
    check_order(stream, &state->next_seq[i], chunk->seq);
    const double quiet = survey->chunks > 0 ? wb_survey_seconds(survey->last_ns, chunk->t_ns) : 0.0;
    if (survey->n_streams > 1 && quiet > wb_seconds_from_ns(SHORTEST_QUIET_NS) && quiet < 1e6)
        state->quiet += quiet;
    note_alone(state, i, chunk->t_ns);
    state->quiet_before[i] = state->quiet;
    check_time(survey, stream, chunk->t_ns);
    stream->chunks++;
    stream->bytes += chunk->n;
    survey->chunks++;
    survey->bytes += chunk->n;
    return WB_OK;
}

static enum wb_status look_at_event(void *context, const struct wb_event *event)
{
    struct survey_state *state = context;
    struct wb_survey *survey = state->survey;
    survey->events++;
    /* Before the tare, instruments may still send incomplete lines. */
    state->has_tare |= strcmp(event->kind, "tare") == 0;
    survey->refused_events += state->has_tare && strcmp(event->kind, "refused") == 0;
    survey->drop_events += strcmp(event->kind, "drop") == 0;
    survey->lost_events += strcmp(event->kind, "stream_lost") == 0;
    return WB_OK;
}

static enum wb_status look_at_clock(void *context, const struct wb_clock_row *row)
{
    (void)row;
    ((struct wb_survey *)context)->clock_rows++;
    return WB_OK;
}

static enum wb_status look_at_meta(void *context, const char *key, const char *value)
{
    struct wb_survey *survey = context;
    if (strcmp(key, "rig") == 0)
        survey->has_rig = true;
    else if (strcmp(key, "specimen") == 0)
        survey->has_specimen = true;
    else if (strcmp(key, WB_RECOVER_META_FROM) == 0)
        survey->is_recovered = true;
    else if (strcmp(key, WB_RECOVER_META_MISSING) == 0)
        snprintf(survey->recovered_missing, sizeof survey->recovered_missing, "%s", value);
    else if (strcmp(key, "virtual") == 0)
        survey->is_virtual = strcmp(value, "true") == 0;
    else if (strcmp(key, "dropped_chunks") == 0)
        survey->dropped_chunks = strtoll(value, NULL, 10);
    return WB_OK;
}

/* Damage found by a walk is a finding; other errors are failures. */
static enum wb_status note_walk(struct wb_survey *survey, enum wb_status status)
{
    if (status != WB_ERR_DATA)
        return status;
    survey->broken = true;
    return WB_OK;
}

/* --- samples --- */

/* Losses by the time stamps of frames and the arrival of lines. */
struct losses {
    struct wb_loss load, mocap;
};

static void count_load(void *context, const struct wb_load_sample *sample)
{
    wb_loss_add(&((struct losses *)context)->load, wb_seconds_from_ns(sample->t_ns));
}

static void count_mocap(void *context, const struct wb_mocap_frame *frame)
{
    wb_loss_add(&((struct losses *)context)->mocap, frame->t_device);
}

static void note_loss(struct wb_survey_stream *stream, const struct wb_loss *loss)
{
    stream->loss = wb_loss_counts(loss);
    stream->is_losing = wb_loss_is_significant(loss);
}

static enum wb_status decode_all(struct wb_recording *recording, struct wb_survey *survey)
{
    /* Without a rig nothing can be decoded; file_problem() reports that. */
    struct wb_rig rig;
    if (!survey->has_rig || wb_replay_rig(recording, &rig) != WB_OK)
        return WB_OK;
    struct losses losses;
    wb_loss_init(&losses.load, false, 0.0);
    wb_loss_init(&losses.mocap, true, 0.0);
    struct wb_sink sink = {.context = &losses, .load = count_load, .mocap = count_mocap};
    struct wb_replay_counts counts;
    WB_TRY(note_walk(survey, wb_replay_run(recording, &rig, &sink, 0.0, &counts)));
    survey->decoded = true;
    const uint64_t samples[] = {[WB_ROLE_LOAD] = counts.load_samples,
                                [WB_ROLE_MOCAP] = counts.mocap_frames,
                                [WB_ROLE_STAGE] = counts.stage_reports};
    for (int i = 0; i < survey->n_streams; i++) {
        struct wb_survey_stream *stream = &survey->streams[i];
        stream->samples = samples[stream->role];
        if (stream->role == WB_ROLE_LOAD)
            note_loss(stream, &losses.load);
        else if (stream->role == WB_ROLE_MOCAP)
            note_loss(stream, &losses.mocap);
        double seconds = wb_survey_seconds(stream->first_ns, stream->last_ns);
        stream->rate = seconds > 0.0 ? (double)stream->samples / seconds : 0.0;
    }
    return WB_OK;
}

/* The limit of silence in the rig file, raised because the state of a stage at rest is queried less
 * often. */
static void note_limit(struct wb_recording *recording, struct wb_survey *survey)
{
    struct wb_rig rig;
    if (survey->has_rig && wb_replay_rig(recording, &rig) == WB_OK)
        survey->silence_limit_ns =
            wb_ns_from_seconds(fmax(rig.limits.stream_lost / rig.time_scale, LEAST_LIMIT));
}

enum wb_status wb_survey_run(struct wb_recording *recording, bool decode, struct wb_survey *survey)
{
    memset(survey, 0, sizeof *survey);
    survey->dropped_chunks = -1;
    survey->closed = wb_recording_is_complete(recording);
    survey->cut_short = wb_recording_is_cut_short(recording);
    (void)wb_recording_log_problem(recording, survey->log_problem, sizeof survey->log_problem);
    int n = wb_recording_n_streams(recording);
    for (int i = 0; i < n && i < WB_SURVEY_STREAMS; i++) {
        const struct wb_recording_stream *stream = wb_recording_stream_at(recording, i);
        survey->streams[i] = (struct wb_survey_stream){
            .id = stream->id, .role = stream->role, .is_file = wb_recording_foreign_is(stream)};
        survey->n_streams++;
    }
    struct survey_state state = {.survey = survey};
    WB_TRY(note_walk(survey, wb_recording_each_meta(recording, look_at_meta, survey)));
    WB_TRY(note_walk(survey, wb_recording_each_chunk(recording, look_at_chunk, &state)));
    for (int i = 0; i < survey->n_streams; i++) {
        survey->missing += survey->streams[i].missing;
        note_alone(&state, i, survey->last_ns); /* silence at the end */
    }
    note_limit(recording, survey);
    WB_TRY(note_walk(survey, wb_recording_each_event(recording, look_at_event, &state)));
    WB_TRY(note_walk(survey, wb_recording_each_clock(recording, look_at_clock, survey)));
    WB_TRY(wb_recording_check(recording, &survey->check));
    survey->broken |= survey->check.is_broken;
    return decode ? decode_all(recording, survey) : WB_OK;
}

double wb_survey_duration(const struct wb_survey *survey)
{
    return wb_survey_seconds(survey->first_ns, survey->last_ns);
}

double wb_survey_seconds(int64_t from_ns, int64_t to_ns)
{
    if (to_ns < from_ns)
        return -wb_survey_seconds(to_ns, from_ns);
    return (double)((uint64_t)to_ns - (uint64_t)from_ns) * 1e-9;
}

/* --- problems --- */

/* Counts the problems in a fixed order, and describes one of them. */
struct problems {
    int n, wanted; /* problems so far; number of the described one, from 0 */
    char *text;
    size_t size;
};

static void __attribute__((format(printf, 3, 4)))
note(struct problems *problems, bool is_problem, const char *format, ...)
{
    va_list arguments;
    if (!is_problem || problems->n++ != problems->wanted)
        return;
    va_start(arguments, format);
    vsnprintf(problems->text, problems->size, format, arguments);
    va_end(arguments);
}

static const char *plural(uint64_t n)
{
    return n == 1 ? "" : "s";
}

static const char *rows_are(uint64_t n)
{
    return n == 1 ? "row is" : "rows are";
}

static void note_file(struct problems *p, const struct wb_survey *survey)
{
    note(p, !survey->closed, "%s",
         survey->cut_short ? "the file is truncated: use the original file"
                           : "it was not closed properly: a crash, a power cut, a full disk, or it "
                             "is still being recorded");
    /* Damaged rows are listed separately. */
    note(p,
         survey->broken && !survey->cut_short &&
             (survey->check.is_broken || survey->check.damaged == 0),
         "the database is damaged: not all rows can be read");
    note(p, survey->n_streams == 0, "the recording declares no stream");
    note(p, survey->undeclared > 0, "%" PRIu64 " chunk%s of undeclared streams", survey->undeclared,
         plural(survey->undeclared));
    note(p, survey->drop_events > 0 || survey->dropped_chunks > 0,
         "drops during recording: %" PRIu64 " (%" PRId64 " chunk%s)", survey->drop_events,
         survey->dropped_chunks < 0 ? 0 : survey->dropped_chunks,
         survey->dropped_chunks == 1 ? "" : "s");
    note(p, survey->lost_events > 0,
         "a stream was silent for too long %" PRIu64 " time%s during recording",
         survey->lost_events, plural(survey->lost_events));
    note(p, survey->refused_events > 0,
         "lines that could not be decoded were received during the test (%" PRIu64 " event%s)",
         survey->refused_events, plural(survey->refused_events));
    note(p, !survey->has_rig, "the rig file is missing: nothing can be decoded");
    note(p, survey->log_problem[0] != '\0', "%s", survey->log_problem);
    note(p, survey->is_recovered && survey->recovered_missing[0],
         "recovered from a damaged file; missing: %s", survey->recovered_missing);
    note(p, !survey->has_specimen, "the specimen file is missing: the recording cannot be aligned");
}

static void note_rows(struct problems *p, const struct wb_recording_check *check)
{
    note(p, check->damaged > 0, "%" PRIu64 " %s damaged (CRC-32): %s", check->damaged,
         rows_are(check->damaged), check->damaged_where);
    note(p, check->lost > 0, "%" PRIu64 " %s missing: %s", check->lost, rows_are(check->lost),
         check->lost_where);
    note(p, check->displaced > 0, "%" PRIu64 " %s not in the order of writing: %s",
         check->displaced, rows_are(check->displaced), check->displaced_where);
    note(p, check->after_digest > 0, "%" PRIu64 " %s after the digest that closing wrote",
         check->after_digest, rows_are(check->after_digest));
    note(p,
         check->is_closed && !check->digest_fits && check->damaged == 0 && check->lost == 0 &&
             check->displaced == 0,
         "the digest of all rows differs from that written on closing");
}

static void note_stream(struct problems *p, const struct wb_survey *survey,
                        const struct wb_survey_stream *stream)
{
    char name[32];
    snprintf(name, sizeof name, "%s stream %d", wb_role_name(stream->role), stream->id);
    note(p, stream->chunks == 0 && !survey->cut_short, "%s: no data received", name);
    /* Of a protected recording, note_rows() lists the damaged rows. */
    note(p, stream->damaged > 0 && !survey->check.is_protected,
         "%s: %" PRIu64 " chunk%s damaged (CRC-32)", name, stream->damaged,
         plural(stream->damaged));
    note(p, stream->missing > 0, "%s: %" PRIu64 " chunk%s missing in %" PRIu64 " place%s", name,
         stream->missing, plural(stream->missing), stream->gaps, plural(stream->gaps));
    note(p, survey->silence_limit_ns > 0 && stream->alone_silent_ns > survey->silence_limit_ns,
         "%s: silent for %.2f s, the limit is %.2f s", name,
         wb_seconds_from_ns(stream->alone_silent_ns), wb_seconds_from_ns(survey->silence_limit_ns));
    note(p, stream->is_losing,
         "%s: %.2g %% of its %s never came: %" PRIu64 " in %" PRIu64
         " place%s, the longest of %.3g s",
         name, wb_loss_share(&stream->loss) / WB_PERCENT,
         stream->role == WB_ROLE_MOCAP ? "frames" : "lines", stream->loss.missing,
         stream->loss.gaps, plural(stream->loss.gaps), stream->loss.longest_gap);
    note(p, stream->repeated > 0, "%s: %" PRIu64 " chunk%s repeated or out of order", name,
         stream->repeated, plural(stream->repeated));
}

bool wb_survey_problem(const struct wb_survey *survey, int *at, char *text, size_t size)
{
    struct problems problems = {.wanted = (*at)++, .text = text, .size = size};
    note_file(&problems, survey);
    if (survey->check.is_protected)
        note_rows(&problems, &survey->check);
    for (int i = 0; i < survey->n_streams; i++)
        note_stream(&problems, survey, &survey->streams[i]);
    return problems.n > problems.wanted;
}

bool wb_survey_is_whole(const struct wb_survey *survey)
{
    char text[256];
    int at = 0;
    return !wb_survey_problem(survey, &at, text, sizeof text);
}
