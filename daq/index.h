/* The index of stored recordings, recordings/index.yaml: a list (or a map with the one key
 * `recordings` that holds it) of entries
 *
 *     - file: type1-L85-S1.wbr.zst   # beside the index
 *       wire: type1
 *       length_mm: 85
 *       sample: 1
 *       sha256: 64 hexadecimal digits   # of the uncompressed recording
 *       cycles: 3                    # these and the rest are optional
 *       seed: 1
 *       date_utc: 2026-11-20T11:40:00Z
 *       specimen: type1-L85-S1
 *       rig: paper-bench
 *       size_bytes: 3145728          # of the file
 *       tool_revision: 4e3cfe61a0b2
 *       virtual: true                # from the virtual rig
 *       corrected_specimen: long.yaml   # beside the index; in place of the recorded one
 *       corrected_rig: kilograms.yaml   # likewise
 */
#ifndef WB_DAQ_INDEX_H
#define WB_DAQ_INDEX_H

#include <stdbool.h>

#include "base/file.h"
#include "base/hash.h"
#include "base/status.h"

struct wb_index_entry {
    char file[256]; /* as written */
    char wire[64];
    double length; /* m */
    int sample;
    char sha256[WB_SHA256_TEXT]; /* lower case */
    int cycles;                  /* 0 unknown */
    int seed;                    /* -1 unknown */
    char date_utc[40];
    bool is_virtual;
    /* Files that hold in place of what was recorded, as written; "": the recording's own. */
    char corrected_specimen[256], corrected_rig[256];
};

struct wb_index {
    char folder[WB_PATH]; /* of the index file; the entries' files are relative to it */
    int n;
    struct wb_index_entry *entries; /* (n), owned */
};

/* Errors name file, line and key; two entries of one file are refused. */
WB_MUST_CHECK enum wb_status wb_index_read(struct wb_index *index, const char *path);
void wb_index_release(struct wb_index *index); /* accepts a zeroed one */

/* The entry of a file name, with or without its folder; NULL when there is none. */
const struct wb_index_entry *wb_index_find(const struct wb_index *index, const char *file);

#endif
