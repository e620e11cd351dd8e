/* Failing storage: a layer of SQLite's file system that records writes, truncations and syncs and
 * can make them fail.
 *
 * From this record the files can be reconstructed as they may be after a power cut at any moment:
 * synced data are present; of later writes each sector may be present or not, in any order.
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

/* Installs the layer for all files opened from now on, and clears its record. */
void fault_vfs_begin(void);
/* Removes the layer; no file may be open. The record is kept. */
void fault_vfs_end(void);

/* From now on; may be called by any thread. */
void fault_vfs_set(enum fault fault);

/* Sets a function that is called before each sync by the syncing thread; NULL: none. */
void fault_vfs_on_sync(void (*hook)(void *context), void *context);

/* Number of recorded operations. */
size_t fault_vfs_operations(void);

/* Reconstructs in `folder` the files as they may be after a power cut after `n` operations. Files
 * keep their names; deleted files are omitted. Random by `seed`. */
void fault_vfs_rebuild(const char *folder, size_t n, uint64_t seed);

#endif
