/* Checkpoints of long computations: named fields, saved to a file and restored.
 *
 * Each module provides one function that visits its state field by field, always in the same order;
 * the same function saves and restores:
 *
 *     void wb_engine_visit(struct wb_engine *engine, struct wb_checkpoint *checkpoint)
 *     {
 *         wb_checkpoint_visit_member(checkpoint, engine, steps);
 *         wb_checkpoint_visit(checkpoint, "speed", engine->speed, engine->n * sizeof(double));
 *     }
 *
 * A checkpoint contains name, size and bytes of each field. Restoring fails at the first field
 * whose name or size differs from the visitor's, and the message names it.
 *
 * A file contains an identity of the run, the fields in memory representation, and their SHA-256.
 * Only the program and the kind of machine that wrote it can read it. It is written to a temporary
 * file and then renamed.
 */
#ifndef WB_BASE_CHECKPOINT_H
#define WB_BASE_CHECKPOINT_H

#include <stdbool.h>
#include <stddef.h>

#include "base/hash.h"
#include "base/status.h"

struct wb_checkpoint {
    bool restores;        /* else it saves */
    unsigned char *bytes; /* owned */
    size_t size, room;
    size_t at;             /* position of the next field */
    enum wb_status status; /* of the first failure, after which no field is visited */
    char group[128];       /* "part 1/wire 2/": prefix of the fields' names */
};

/* An empty checkpoint that saves. */
void wb_checkpoint_init(struct wb_checkpoint *checkpoint);
void wb_checkpoint_release(struct wb_checkpoint *checkpoint); /* accepts a zeroed one */

/* Saves or restores `size` bytes at `data`. A failure is stored in `status`; `data` is then
 * unchanged. */
void wb_checkpoint_visit(struct wb_checkpoint *checkpoint, const char *name, void *data,
                         size_t size);

/* As wb_checkpoint_visit(), for a member of a structure, with the member's name. */
#define wb_checkpoint_visit_member(checkpoint, structure, member)                                  \
    wb_checkpoint_visit((checkpoint), #member, &(structure)->member, sizeof(structure)->member)

/* Begins a group of fields within the current group, whose name is a prefix of theirs;
 * wb_checkpoint_leave() ends it. */
void wb_checkpoint_enter(struct wb_checkpoint *checkpoint, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
void wb_checkpoint_leave(struct wb_checkpoint *checkpoint);

/* When restoring: skips the fields of the current group. When saving: no effect. */
void wb_checkpoint_skip(struct wb_checkpoint *checkpoint);

/* Appends fields that were saved in another checkpoint, `size` bytes. */
void wb_checkpoint_append(struct wb_checkpoint *checkpoint, const void *fields, size_t size);

/* Switches to restoring, starting at the first field. */
void wb_checkpoint_rewind(struct wb_checkpoint *checkpoint);

/* Returns any failure so far; WB_ERR_DATA if not all fields were restored. */
WB_MUST_CHECK enum wb_status wb_checkpoint_finish(struct wb_checkpoint *checkpoint);

/* Writes the file. `identity` describes the run in a few words and is compared byte for byte on
 * reading. */
WB_MUST_CHECK enum wb_status wb_checkpoint_write(const struct wb_checkpoint *checkpoint,
                                                 const char *path, const char *identity);
/* Reads a file into a released or unused checkpoint. WB_ERR_FORMAT for a file that is not a
 * checkpoint, has another version, or is damaged; WB_ERR_DATA for another identity, with both
 * identities in the message. */
WB_MUST_CHECK enum wb_status wb_checkpoint_read(struct wb_checkpoint *checkpoint, const char *path,
                                                const char *identity);

#endif
