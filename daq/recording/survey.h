/* A survey of a whole recording: what it holds, and what is missing or damaged. A stream is what
 * one instrument sent, a chunk one read or datagram of it. */
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
    bool is_file; /* a file of another program: its pieces come at times of no meaning */
    uint64_t chunks, bytes;
    uint64_t damaged;  /* chunks whose CRC does not fit; their time and number do not count */
    uint64_t missing;  /* sequence numbers that are not there */
    uint64_t gaps;     /* places where they are missing */
    uint64_t repeated; /* sequence numbers that come twice or backwards */
    int64_t first_ns, last_ns;
    int64_t longest_silence_ns; /* between two chunks */
    int64_t alone_silent_ns;    /* the same without the times in which all streams were silent, as
                                   when the recording computer stood still and read them later */
    uint64_t samples;           /* decoded; 0 unless decoding was asked for and worked */
    double rate;                /* samples/s between first and last chunk; 0 unknown */
    struct wb_loss_counts loss; /* samples that the instrument sent and that never came */
    bool is_losing;             /* and they are more than chance */
};

struct wb_survey {
    struct wb_recording_check check; /* of every row */
    int n_streams;                   /* at most WB_SURVEY_STREAMS; further ones are not looked at */
    struct wb_survey_stream streams[WB_SURVEY_STREAMS];
    uint64_t chunks, bytes, damaged, missing;
    uint64_t undeclared; /* chunks of streams that were never declared */
    uint64_t events, drop_events, clock_rows;
    uint64_t refused_events;     /* remarks on refused lines after the tare */
    int64_t silence_limit_ns;    /* alone_silent_ns beyond it is a fault; of the rig; 0 unknown */
    uint64_t lost_events;        /* times a stream fell silent for too long */
    int64_t dropped_chunks;      /* what the writer counted; -1 when it was not written down */
    int64_t first_ns, last_ns;   /* of all chunks; 0 without any */
    bool closed;                 /* closed properly and not cut short */
    bool cut_short;              /* the file is shorter than its header says */
    char log_problem[240];       /* what is wrong with its write-ahead log; "" nothing */
    bool is_recovered;           /* made from a damaged file, */
    char recovered_missing[200]; /* of which this is missing; "" nothing */
    bool broken;                 /* a table breaks off or cannot be read */
    bool decoded;                /* samples were counted */
    bool has_rig, has_specimen;  /* meta values that replay and alignment need */
    bool is_virtual;             /* recorded from a virtual rig */
};

/* Reads all tables; with `decode` the bytes also go through the drivers, and samples are counted.
 * Faults of the recording are not failures of this function: they are in *survey (tables that break
 * off are also logged). */
WB_MUST_CHECK enum wb_status wb_survey_run(struct wb_recording *recording, bool decode,
                                           struct wb_survey *survey);

/* True when nothing is missing, damaged, dropped or cut short. */
bool wb_survey_is_whole(const struct wb_survey *survey);

/* Seconds from the first chunk to the last. */
double wb_survey_duration(const struct wb_survey *survey);

/* Seconds from one stamp to a later one, of any values (a damaged file may hold any). */
double wb_survey_seconds(int64_t from_ns, int64_t to_ns);

/* Describes the next fault in one line, beginning with *at = 0; false when there is no further
 * one. `text` receives for example "mocap stream 1: 12 chunks missing in 2 places"; 256 bytes hold
 * it. */
bool wb_survey_problem(const struct wb_survey *survey, int *at, char *text, size_t size);

#endif
