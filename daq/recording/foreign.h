/* Files of other programs as sources of samples: the settings by which a stream of a recording
 * describes its file, and the decoding of the file into a sink, which import and replay share. */
#ifndef WB_DAQ_RECORDING_FOREIGN_H
#define WB_DAQ_RECORDING_FOREIGN_H

#include "base/hash.h"
#include "daq/protocol/driver.h"
#include "daq/take/force_table.h"
#include "daq/take/take.h"

#define WB_FOREIGN_FORCE_TABLE "force-table"

/* Settings of a stream that holds a file, stored as JSON. */
struct wb_foreign {
    char name[128];  /* of the file, without folder */
    char format[32]; /* name of the take's reader, or WB_FOREIGN_FORCE_TABLE; also the protocol of
                        the stream */
    char sha256[WB_SHA256_TEXT];
    size_t size;                       /* bytes */
    double offset;                     /* s, time of the recording minus time of the file */
    double uncertainty;                /* s, standard uncertainty of the offset; NaN: unknown */
    char channel[64];                  /* of a take: the analogue channel of the force; "": none */
    char unit[16];                     /* of that channel */
    char columns[WB_FORCE_TABLE_LIST]; /* of a table: columns and units of time and force */
};

/* The settings as JSON; the caller frees the text. */
char *wb_foreign_format(const struct wb_foreign *foreign);
/* Parses the settings. WB_ERR_FORMAT, with the reason in `why`, if they are invalid. */
WB_MUST_CHECK enum wb_status wb_foreign_parse(struct wb_foreign *foreign, const char *text,
                                              struct wb_reason *why);

/* Extracts the force (N, times the rig's sign) of one analogue channel of a take into allocated
 * arrays of n_frames x per_frame values. The channel is foreign->channel or, if that is empty, the
 * only channel with a unit of force, whose name is then stored there. */
WB_MUST_CHECK enum wb_status
wb_foreign_channel(struct wb_foreign *foreign, const struct wb_take *take, const struct wb_rig *rig,
                   struct wb_force_table *force, struct wb_reason *why);

/* Decodes the bytes of the file and delivers all samples to the sink. */
WB_MUST_CHECK enum wb_status wb_foreign_play(const struct wb_foreign *foreign, const uint8_t *bytes,
                                             const struct wb_rig *rig, const struct wb_sink *sink,
                                             struct wb_reason *why);

#endif
