/* The index of stored recordings, recordings/index.yaml: a list (or a map whose only key
 * `recordings` holds the list) of entries
 *
 *     - file: type1-L85-S1.wbr.zst   # beside the index
 *       wire: type1
 *       length_mm: 85
 *       sample: 1
 *       sha256: 64 hexadecimal digits   # of the uncompressed recording
 *       cycles: 3                    # this and all keys below are optional
 *       seed: 1
 *       date_utc: 2026-11-20T11:40:00Z
 *       specimen: type1-L85-S1
 *       rig: paper-bench
 *       size_bytes: 3145728          # of the file
 *       tool_revision: 4e3cfe61a0b2
 *       virtual: true                # from the virtual rig
 *       corrected_specimen: long.yaml   # file beside the index, replaces the recorded specimen
 *       corrected_rig: kilograms.yaml   # the same for the rig
 *       series: type1-85             # series of the test, and its number in the series
 *       number: 2
 *       excluded:                    # the test is not used
 *         by: A. Tester
 *         reason: the clamp slipped
 *         date_utc: 2026-11-20T11:52:00Z   # optional
 *         repeated: true             # optional: the specimen is to be tested again
 *
 * A recording is never changed; later decisions about it are stored in the index. Every command
 * that opens a recording consults index.yaml in the recording's folder.
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

/* Person, reason and date of the decision not to use a test. */
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
    int cycles;                  /* 0: unknown */
    int seed;                    /* -1: unknown */
    char date_utc[40];
    bool is_virtual;
    /* Files that replace the recorded specimen and rig, as written; "": not replaced. */
    char corrected_specimen[256], corrected_rig[256];
    char series[64]; /* "": not part of a series */
    int number;      /* of the test in its series; 0: unknown */
    struct wb_index_exclusion excluded;
};

struct wb_index {
    char folder[WB_PATH]; /* of the index file; files of the entries are relative to it */
    int n;
    struct wb_index_entry *entries; /* (n), owned */
};

/* Reads an index. Errors give file, line and key; a file that is listed twice is an error. `why`
 * receives the reason; NULL: it is logged. */
WB_MUST_CHECK enum wb_status wb_index_read(struct wb_index *index, const char *path,
                                           struct wb_reason *why);
void wb_index_release(struct wb_index *index); /* accepts a zeroed one */

/* The entry of a file name, with or without folder, compressed (.zst) or not; NULL: none. */
const struct wb_index_entry *wb_index_find(const struct wb_index *index, const char *file);

/* Looks a recording up in the index of its own folder. True if it is listed with this checksum
 * (NULL: with any). False without an index or entry and, with the reason in `why`, if the index
 * cannot be read or lists the name with another checksum. */
bool wb_index_look_up(struct wb_index_entry *entry, const char *recording_path, const char *sha256,
                      struct wb_reason *why);

/* Reads the keys `by`, `reason`, `date_utc` and `repeated` of a map into a zeroed exclusion, and
 * the key `recording` into `recording` (NULL: this key is not accepted). `node` NULL: does nothing.
 */
WB_MUST_CHECK enum wb_status wb_index_exclusion_read(const struct wb_config_node *node,
                                                     char recording[256],
                                                     struct wb_index_exclusion *exclusion);

/* Formats an exclusion: "by A. Tester on 2026-11-20: the clamp slipped". */
#define WB_INDEX_EXCLUSION_TEXT 384
void wb_index_exclusion_describe(const struct wb_index_exclusion *exclusion,
                                 char text[WB_INDEX_EXCLUSION_TEXT]);

/* Writes the exclusion as member "excluded" of an object: by, reason, date_utc. */
void wb_index_exclusion_set_json(const struct wb_index_exclusion *exclusion,
                                 struct wb_json *object);

/* Reads that member; false if the object has none. */
bool wb_index_exclusion_get_json(struct wb_index_exclusion *exclusion,
                                 const struct wb_json *object);

/* Appends an entry to an index file, which is created if missing; existing contents, including
 * comments, are not changed. The file is replaced atomically. WB_ERR_EXISTS: the name is already
 * listed. */
WB_MUST_CHECK enum wb_status wb_index_append(const char *path, const struct wb_index_entry *entry);

#endif
