/* Checkpoints of long computations: numbers carried to a file and back in the same order.
 *
 * Who has a state writes one function that carries all of it; the same walk then sizes nothing
 * twice, saves and restores:
 *
 *     wb_checkpoint_carry(c, &r->steps, sizeof r->steps);
 *
 * A file holds what it belongs to (an identity), the numbers as they lie in memory, and their
 * SHA-256: for the machine and the program that wrote it. It is written beside its place and then
 * renamed.
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
    size_t at;             /* carried so far */
    enum wb_status status; /* of the first failure; then nothing is carried any more */
};

/* One that saves, empty. */
void wb_checkpoint_init(struct wb_checkpoint *checkpoint);
void wb_checkpoint_release(struct wb_checkpoint *checkpoint); /* accepts a zeroed one */

/* From `data` into the checkpoint, or back from it. What is missing leaves `data` alone; the status
 * tells of it. */
void wb_checkpoint_carry(struct wb_checkpoint *checkpoint, void *data, size_t size);

/* From now on it restores, from its first byte. */
void wb_checkpoint_rewind(struct wb_checkpoint *checkpoint);

/* Whether all was carried that there is to restore; WB_ERR_DATA. Any failure so far. */
WB_MUST_CHECK enum wb_status wb_checkpoint_finish(struct wb_checkpoint *checkpoint);

/* `identity` says in a few words what the numbers belong to; compared byte for byte. */
WB_MUST_CHECK enum wb_status wb_checkpoint_write(const struct wb_checkpoint *checkpoint,
                                                 const char *path, const char *identity);
/* Into one that was released or never used. WB_ERR_FORMAT for what is no checkpoint or damaged,
 * WB_ERR_DATA for one with another identity; the message shows both. */
WB_MUST_CHECK enum wb_status wb_checkpoint_read(struct wb_checkpoint *checkpoint, const char *path,
                                                const char *identity);

#endif
