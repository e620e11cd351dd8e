/* Checkpoints of long computations: fields with their names, to a file and back.
 *
 * Each module provides one function that visits its state field by field, always in the same order;
 * it both saves and restores:
 *
 *     void wb_engine_visit(struct wb_engine *engine, struct wb_checkpoint *checkpoint)
 *     {
 *         wb_checkpoint_visit_member(checkpoint, engine, steps);
 *         wb_checkpoint_visit(checkpoint, "speed", engine->speed, engine->n * sizeof(double));
 *     }
 *
 * A checkpoint holds the name, the size and the bytes of each field. Restoring fails at the first
 * field whose name or size differs from what the visitor asks for, and the message says which.
 *
 * A file holds what it belongs to (an identity), the fields as they lie in memory, and their
 * SHA-256. It can be read by the machine and the program that wrote it, and by no other. It is
 * written beside its place and then renamed.
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
    size_t at;             /* where the next field is */
    enum wb_status status; /* of the first failure; then nothing is visited any more */
    char group[128];       /* "part 1/wire 2/": stands before the names of fields */
};

/* An empty one that saves. */
void wb_checkpoint_init(struct wb_checkpoint *checkpoint);
void wb_checkpoint_release(struct wb_checkpoint *checkpoint); /* accepts a zeroed one */

/* Saves or restores `size` bytes at `data`. A failure is kept in `status`; `data` stays as it is
 * then. */
void wb_checkpoint_visit(struct wb_checkpoint *checkpoint, const char *name, void *data,
                         size_t size);

/* The same for a member of a structure, under the member's name. */
#define wb_checkpoint_visit_member(checkpoint, structure, member)                                  \
    wb_checkpoint_visit((checkpoint), #member, &(structure)->member, sizeof(structure)->member)

/* Begins a group of fields, whose name stands before theirs, within the present group; ends it. */
void wb_checkpoint_enter(struct wb_checkpoint *checkpoint, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
void wb_checkpoint_leave(struct wb_checkpoint *checkpoint);

/* Passes over the fields of the present group when it restores; nothing when it saves. */
void wb_checkpoint_skip(struct wb_checkpoint *checkpoint);

/* Adds fields that were saved elsewhere, `size` bytes of another checkpoint. */
void wb_checkpoint_append(struct wb_checkpoint *checkpoint, const void *fields, size_t size);

/* From now on it restores, from its first field on. */
void wb_checkpoint_rewind(struct wb_checkpoint *checkpoint);

/* Any failure so far; WB_ERR_DATA where not all fields were restored. */
WB_MUST_CHECK enum wb_status wb_checkpoint_finish(struct wb_checkpoint *checkpoint);

/* `identity` says in a few words what the state belongs to; it is compared byte for byte. */
WB_MUST_CHECK enum wb_status wb_checkpoint_write(const struct wb_checkpoint *checkpoint,
                                                 const char *path, const char *identity);
/* Reads into one that was released or never used. WB_ERR_FORMAT for a file that is no checkpoint,
 * of another version, or damaged; WB_ERR_DATA for one with another identity, and the message shows
 * both. */
WB_MUST_CHECK enum wb_status wb_checkpoint_read(struct wb_checkpoint *checkpoint, const char *path,
                                                const char *identity);

#endif
