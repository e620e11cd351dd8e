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
 *       series: type1-85             # the series it was recorded in, and its number there
 *       number: 2
 *       excluded:                    # the test does not count
 *         by: A. Tester
 *         reason: the clamp slipped
 *         date_utc: 2026-11-20T11:52:00Z   # optional
 *         repeated: true             # optional: its specimen was to be tested again
 *
 * A recording is never changed, so what was decided of it afterwards stands in an index. The one in
 * the recording's own folder, index.yaml, is looked at by whatever opens the recording.
 */
#ifndef WB_DAQ_RECORDING_INDEX_H
#define WB_DAQ_RECORDING_INDEX_H

#include <stdbool.h>

#include "base/config.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/json.h"
#include "base/reason.h"
#include "base/status.h"

#define WB_INDEX_FILE "index.yaml" /* in the folder of recordings */

/* Who decided that a test does not count, why and when, in words for people. */
struct wb_index_exclusion {
    bool is_excluded, is_repeated;
    char by[80], reason[240], date_utc[40];
};

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
    char series[64]; /* "": recorded on its own */
    int number;      /* of the test in its series; 0 unknown */
    struct wb_index_exclusion excluded;
};

struct wb_index {
    char folder[WB_PATH]; /* of the index file; the entries' files are relative to it */
    int n;
    struct wb_index_entry *entries; /* (n), owned */
};

/* Errors name file, line and key; two entries of one file are refused. `why` receives the reason;
 * NULL: it is logged. */
WB_MUST_CHECK enum wb_status wb_index_read(struct wb_index *index, const char *path,
                                           struct wb_reason *why);
void wb_index_release(struct wb_index *index); /* accepts a zeroed one */

/* The entry of a file name, with or without its folder, compressed (.zst) or not; NULL when there
 * is none. */
const struct wb_index_entry *wb_index_find(const struct wb_index *index, const char *file);

/* What the index in a recording's own folder says of it. True when it lists the recording with this
 * checksum (NULL: with any). False without an index or an entry; also, with the reason in `why`,
 * where the index cannot be read or has the name for other data. */
bool wb_index_look_up(struct wb_index_entry *entry, const char *recording_path, const char *sha256,
                      struct wb_reason *why);

/* Reads the keys `by`, `reason`, `date_utc` and `repeated` of a map into a zeroed exclusion, and
 * `recording` where there is room for it (NULL: it is no key). `node` NULL: leaves all as it is. */
WB_MUST_CHECK enum wb_status wb_index_exclusion_read(const struct wb_config_node *node,
                                                     char recording[256],
                                                     struct wb_index_exclusion *exclusion);

/* "by A. Tester on 2026-11-20: the clamp slipped". */
#define WB_INDEX_EXCLUSION_TEXT 384
void wb_index_exclusion_describe(const struct wb_index_exclusion *exclusion,
                                 char text[WB_INDEX_EXCLUSION_TEXT]);

/* Sets it as the member "excluded" of an object: by, reason, date_utc. */
void wb_index_exclusion_set_json(const struct wb_index_exclusion *exclusion,
                                 struct wb_json *object);

/* Reads that member; false where the object has none. */
bool wb_index_exclusion_get_json(struct wb_index_exclusion *exclusion,
                                 const struct wb_json *object);

/* Adds an entry at the end of an index file, which is begun where there is none; what stands in it
 * stays as it is, comments included. The file is replaced as a whole. WB_ERR_EXISTS when the file
 * lists that name already. */
WB_MUST_CHECK enum wb_status wb_index_append(const char *path, const struct wb_index_entry *entry);

#endif
