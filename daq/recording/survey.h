/* Survey of a recording: its contents, and missing or damaged parts. A stream holds the data of one
 * instrument, a chunk is one read or datagram of a stream. */
#ifndef WB_DAQ_RECORDING_SURVEY_H
#define WB_DAQ_RECORDING_SURVEY_H

#include <stdbool.h>
#include <stdint.h>

#include "base/status.h"
#include "daq/protocol/loss.h"
#include "daq/recording/recording.h"

#define WB_SURVEY_STREAMS 16

struct wb_survey_stream {
    int id;
    enum wb_role role;
    bool is_file; /* a file of another program: the times of its pieces have no meaning */
    uint64_t chunks, bytes;
    uint64_t damaged;  /* chunks with a wrong CRC; their time and number are ignored */
    uint64_t missing;  /* missing sequence numbers */
    uint64_t gaps;     /* groups of consecutive missing numbers */
    uint64_t repeated; /* sequence numbers that are repeated or out of order */
    int64_t first_ns, last_ns;
    int64_t longest_silence_ns; /* between two chunks */
    int64_t alone_silent_ns;    /* the same without times in which all streams were silent because
                                   the recording computer stalled */
    uint64_t samples;           /* decoded samples; 0 if nothing was decoded */
    double rate;                /* samples/s between first and last chunk; 0: unknown */
    struct wb_loss_counts loss; /* samples sent but not received */
    bool is_losing;             /* the loss exceeds chance */
};

struct wb_survey {
    struct wb_recording_check check; /* of every row */
    int n_streams;                   /* at most WB_SURVEY_STREAMS; further ones are ignored */
    struct wb_survey_stream streams[WB_SURVEY_STREAMS];
    uint64_t chunks, bytes, damaged, missing;
    uint64_t undeclared; /* chunks of undeclared streams */
    uint64_t events, drop_events, clock_rows;
    uint64_t refused_events;     /* events "refused" (rejected lines) after the tare */
    int64_t silence_limit_ns;    /* of the rig, for alone_silent_ns; 0: unknown */
    uint64_t lost_events;        /* times a stream was silent for too long */
    int64_t dropped_chunks;      /* counted by the writer; -1: not recorded */
    int64_t first_ns, last_ns;   /* of all chunks; 0 without chunks */
    bool closed;                 /* closed properly and not truncated */
    bool cut_short;              /* the file is shorter than its header says */
    char log_problem[240];       /* problem of its write-ahead log; "": none */
    bool is_recovered;           /* recovered from a damaged file */
    char recovered_missing[200]; /* description of the rows missing after recovery; "": none */
    bool broken;                 /* a table cannot be read completely */
    bool decoded;                /* samples were counted */
    bool has_rig, has_specimen;  /* meta values that replay and alignment need */
    bool is_virtual;             /* recorded from a virtual rig */
};

/* Reads all tables; with `decode` also decodes the bytes and counts samples. Problems of the
 * recording are no failures of this function: they are stored in *survey (damaged tables are also
 * logged). */
WB_MUST_CHECK enum wb_status wb_survey_run(struct wb_recording *recording, bool decode,
                                           struct wb_survey *survey);

/* True if wb_survey_problem() finds no problem. */
bool wb_survey_is_whole(const struct wb_survey *survey);

/* Seconds from the first chunk to the last. */
double wb_survey_duration(const struct wb_survey *survey);

/* Seconds between two time stamps, without overflow for any values (a file may be damaged). */
double wb_survey_seconds(int64_t from_ns, int64_t to_ns);

/* Describes the next problem in one line, beginning with *at = 0; false if there are no more.
 * `text` (256 bytes) receives for example "mocap stream 1: 12 chunks missing in 2 places". */
bool wb_survey_problem(const struct wb_survey *survey, int *at, char *text, size_t size);

#endif
