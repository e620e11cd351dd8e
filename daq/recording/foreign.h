/* Files of other programs as sources of samples: how a stream of a recording says what its file is,
 * and the file's bytes through its reader into a sink, the same when it is imported and when the
 * recording is replayed. */
#ifndef WB_DAQ_RECORDING_FOREIGN_H
#define WB_DAQ_RECORDING_FOREIGN_H

#include "base/hash.h"
#include "daq/protocol/driver.h"
#include "daq/take/force_table.h"
#include "daq/take/take.h"

#define WB_FOREIGN_FORCE_TABLE "force-table"

/* What the settings of a stream hold, as JSON. */
struct wb_foreign {
    char name[128];  /* of the file, without folder */
    char format[32]; /* of a take: its reader's name; WB_FOREIGN_FORCE_TABLE; also the stream's
                        protocol */
    char sha256[WB_SHA256_TEXT];
    size_t size;        /* bytes */
    double offset;      /* s: time of the recording less time of the file */
    double uncertainty; /* s, standard, of the offset; NaN unknown */
    char channel[64];   /* of a take: the analogue channel that is the force; "": none */
    char unit[16];      /* of that channel */
    char columns[WB_FORCE_TABLE_LIST]; /* of a table: which are time and force, in which units */
};

/* JSON of it; caller frees. */
WB_MUST_CHECK enum wb_status wb_foreign_format(const struct wb_foreign *foreign, char **text);
/* Reads it; WB_ERR_FORMAT. */
WB_MUST_CHECK enum wb_status wb_foreign_parse(struct wb_foreign *foreign, const char *text,
                                              struct wb_reason *why);

/* The force of one analogue channel of a take, N, times the rig's sign, into allocated arrays of
 * n_frames x per_frame. The channel is that of foreign->channel, or the only one in a unit of force
 * where that is empty: then it is set. */
WB_MUST_CHECK enum wb_status
wb_foreign_channel(struct wb_foreign *foreign, const struct wb_take *take, const struct wb_rig *rig,
                   struct wb_force_table *force, struct wb_reason *why);

/* Reads the bytes and delivers all. */
WB_MUST_CHECK enum wb_status wb_foreign_play(const struct wb_foreign *foreign, const uint8_t *bytes,
                                             const struct wb_rig *rig, const struct wb_sink *sink,
                                             struct wb_reason *why);

#endif
