#include "daq/recording/survey.h"

#include <inttypes.h>
#include <math.h>
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

#define FILE_PROBLEMS 11
#define ROW_PROBLEMS 5
#define STREAM_PROBLEMS 6

static const char *plural(uint64_t n)
{
    return n == 1 ? "" : "s";
}

static bool stream_problem(const struct wb_survey *survey, int which, char *text, size_t size)
{
    const struct wb_survey_stream *const stream = &survey->streams[which / STREAM_PROBLEMS];
    const char *role = wb_role_name(stream->role);
    switch (which % STREAM_PROBLEMS) {
    case 0:
        snprintf(text, size, "%s stream %d: no data received", role, stream->id);
        return stream->chunks == 0 && !survey->cut_short;
    case 1:
        snprintf(text, size, "%s stream %d: %" PRIu64 " chunk%s damaged (CRC-32)", role, stream->id,
                 stream->damaged, plural(stream->damaged));
        return stream->damaged > 0 && !survey->check.is_protected; /* else see row_problem() */
    case 2:
        snprintf(text, size, "%s stream %d: %" PRIu64 " chunk%s missing in %" PRIu64 " place%s",
                 role, stream->id, stream->missing, plural(stream->missing), stream->gaps,
                 plural(stream->gaps));
        return stream->missing > 0;
    case 3:
        snprintf(text, size, "%s stream %d: silent for %.2f s, the limit is %.2f s", role,
                 stream->id, wb_seconds_from_ns(stream->alone_silent_ns),
                 wb_seconds_from_ns(survey->silence_limit_ns));
        return survey->silence_limit_ns > 0 && stream->alone_silent_ns > survey->silence_limit_ns;
    case 4:
        snprintf(text, size,
                 "%s stream %d: %.2g %% of its %s never came: %" PRIu64 " in %" PRIu64
                 " place%s, the longest of %.3g s",
                 role, stream->id, wb_loss_share(&stream->loss) / WB_PERCENT,
                 stream->role == WB_ROLE_MOCAP ? "frames" : "lines", stream->loss.missing,
                 stream->loss.gaps, plural(stream->loss.gaps), stream->loss.longest_gap);
        return stream->is_losing;
    default:
        snprintf(text, size, "%s stream %d: %" PRIu64 " chunk%s repeated or out of order", role,
                 stream->id, stream->repeated, plural(stream->repeated));
        return stream->repeated > 0;
    }
}

static bool row_problem(const struct wb_survey *survey, int which, char *text, size_t size)
{
    const struct wb_recording_check *const check = &survey->check;
    if (!check->is_protected)
        return false;
    switch (which) {
    case 0:
        snprintf(text, size, "%" PRIu64 " row%s damaged (CRC-32): %s", check->damaged,
                 check->damaged == 1 ? " is" : "s are", check->damaged_where);
        return check->damaged > 0;
    case 1:
        snprintf(text, size, "%" PRIu64 " row%s missing: %s", check->lost,
                 check->lost == 1 ? " is" : "s are", check->lost_where);
        return check->lost > 0;
    case 2:
        snprintf(text, size, "%" PRIu64 " row%s not in the order of writing: %s", check->displaced,
                 check->displaced == 1 ? " is" : "s are", check->displaced_where);
        return check->displaced > 0;
    case 3:
        snprintf(text, size, "%" PRIu64 " row%s after the digest that closing wrote",
                 check->after_digest, check->after_digest == 1 ? " is" : "s are");
        return check->after_digest > 0;
    default:
        snprintf(text, size, "the digest of all rows differs from that written on closing");
        return check->is_closed && !check->digest_fits && check->damaged == 0 && check->lost == 0 &&
               check->displaced == 0;
    }
}

static bool file_problem(const struct wb_survey *survey, int which, char *text, size_t size)
{
    switch (which) {
    case 0:
        snprintf(text, size, "%s",
                 survey->cut_short ? "the file is truncated: use the original file"
                                   : "it was not closed properly: a crash, a power cut, a full "
                                     "disk, or it is still being recorded");
        return !survey->closed;
    case 1:
        snprintf(text, size, "the database is damaged: not all rows can be read");
        /* Damaged rows are listed separately. */
        return survey->broken && !survey->cut_short &&
               (survey->check.is_broken || survey->check.damaged == 0);
    case 2:
        snprintf(text, size, "the recording declares no stream");
        return survey->n_streams == 0;
    case 3:
        snprintf(text, size, "%" PRIu64 " chunk%s of undeclared streams", survey->undeclared,
                 plural(survey->undeclared));
        return survey->undeclared > 0;
    case 4:
        snprintf(text, size, "drops during recording: %" PRIu64 " (%" PRId64 " chunk%s)",
                 survey->drop_events, survey->dropped_chunks < 0 ? 0 : survey->dropped_chunks,
                 survey->dropped_chunks == 1 ? "" : "s");
        return survey->drop_events > 0 || survey->dropped_chunks > 0;
    case 5:
        snprintf(text, size, "a stream was silent for too long %" PRIu64 " time%s during recording",
                 survey->lost_events, plural(survey->lost_events));
        return survey->lost_events > 0;
    case 6:
        snprintf(text, size,
                 "lines that could not be decoded were received during the test (%" PRIu64
                 " event%s)",
                 survey->refused_events, plural(survey->refused_events));
        return survey->refused_events > 0;
    case 7:
        snprintf(text, size, "the rig file is missing: nothing can be decoded");
        return !survey->has_rig;
    case 8:
        snprintf(text, size, "%s", survey->log_problem);
        return survey->log_problem[0] != '\0';
    case 9:
        snprintf(text, size, "recovered from a damaged file; missing: %s",
                 survey->recovered_missing);
        return survey->is_recovered && survey->recovered_missing[0];
    default:
        snprintf(text, size, "the specimen file is missing: the recording cannot be aligned");
        return !survey->has_specimen;
    }
}

bool wb_survey_problem(const struct wb_survey *survey, int *at, char *text, size_t size)
{
    const int rows = FILE_PROBLEMS + ROW_PROBLEMS;
    while (*at < rows + survey->n_streams * STREAM_PROBLEMS) {
        const int which = (*at)++;
        if (which < FILE_PROBLEMS ? file_problem(survey, which, text, size)
            : which < rows        ? row_problem(survey, which - FILE_PROBLEMS, text, size)
                                  : stream_problem(survey, which - rows, text, size))
            return true;
    }
    return false;
}

bool wb_survey_is_whole(const struct wb_survey *survey)
{
    char text[256];
    int at = 0;
    return !wb_survey_problem(survey, &at, text, sizeof text);
}
