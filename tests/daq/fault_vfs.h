/* Storage that fails: a layer of SQLite's file system under which writes, truncations and syncs are
 * written down and can be made to fail.
 *
 * From what was written down the files can be made as they may be after the power went at any
 * moment: what was synced is there; of each later write each sector may be there or not, in any
 * order.
 */
#ifndef WB_TESTS_DAQ_FAULT_VFS_H
#define WB_TESTS_DAQ_FAULT_VFS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum fault {
    FAULT_NONE,
    FAULT_FULL,  /* nothing more fits */
    FAULT_SHORT, /* half of each write is written, then an error */
    FAULT_IO,    /* writes fail */
    FAULT_SYNC,  /* writes succeed, syncs fail */
    FAULT_KINDS
};

/* Puts the layer under all files that are opened from now on, and forgets what was written down. */
void fault_vfs_begin(void);
/* Takes it away; no file may be open. What was written down stays. */
void fault_vfs_end(void);

/* From now on; may be called by any thread. */
void fault_vfs_set(enum fault fault);

/* Called by the thread that syncs, before each sync; NULL: nothing is. */
void fault_vfs_on_sync(void (*hook)(void *context), void *context);

/* Operations written down so far. */
size_t fault_vfs_operations(void);

/* Makes in `folder` the files as they may be when the power goes after `n` operations. Files keep
 * their names; those that are not there any more are not made. Random by `seed`. */
void fault_vfs_rebuild(const char *folder, size_t n, uint64_t seed);

#endif
