/* Files: read whole, written whole or not at all. */
#ifndef WB_BASE_FILE_H
#define WB_BASE_FILE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/reason.h"
#include "base/status.h"
#include "base/text.h"

/* Longest path this program makes, with the NUL. */
#define WB_PATH 4096

/* Reads a whole file into an allocated, NUL-terminated buffer (caller frees); *size excludes the
 * NUL and may be NULL. */
WB_MUST_CHECK enum wb_status wb_file_read(const char *path, char **bytes, size_t *size);
/* The same; On failure `why` holds the reason. NULL: that is logged. */
WB_MUST_CHECK enum wb_status wb_file_read_with_reason(const char *path, char **bytes, size_t *size,
                                                      struct wb_reason *why);

/* Writes a whole file: into a temporary file beside it, synchronised, then renamed, so that a
 * reader sees the old or the new file and nothing half-written stays behind. */
WB_MUST_CHECK enum wb_status wb_file_write(const char *path, const void *bytes, size_t size);

/* The same of a text; WB_ERR_MEMORY when that failed while it was built. */
WB_MUST_CHECK enum wb_status wb_file_write_text(const char *path, const struct wb_text *text);

/* Whether something is there, and whether it is a folder; links are followed. */
bool wb_file_exists(const char *path);
bool wb_file_is_folder(const char *path);

/* Makes a folder and its parents; an existing folder is fine. */
WB_MUST_CHECK enum wb_status wb_file_make_folder(const char *path);

/* Prepares an output folder: makes it; WB_ERR_EXISTS when it already holds anything and `force` is
 * not set (the message names --force). */
WB_MUST_CHECK enum wb_status wb_file_prepare_output(const char *path, bool force);

/* Joins folder and name into `path`; an absolute name stands alone, and an empty folder is the
 * current one. WB_ERR_ARGUMENT when it would be too long. */
WB_MUST_CHECK enum wb_status wb_file_join(char path[WB_PATH], const char *folder, const char *name);

/* The folder part of a path ("." when there is none) into `folder`. */
void wb_file_folder(char folder[WB_PATH], const char *path);

/* The last part of a path; points into it. */
const char *wb_file_name(const char *path);

/* Finds shipped data ("fixtures/wires/type1.yaml"): below $WIREBENCH_DATA if set, else below the
 * source tree the program was built in while that exists, else below the installed data folder.
 * WB_ERR_NOT_FOUND without a message when there is no such file. */
WB_MUST_CHECK enum wb_status wb_file_find_data(char path[WB_PATH], const char *name);

/* Finds the YAML file that `name` means in a place where fixtures are named: a path when it has a
 * slash or ends in ".yaml" (tried relative to the folder `beside` first when that is not NULL, then
 * to the current folder, then as shipped data), else fixtures/KIND/NAME.yaml ("wires", "type1"), or
 * where none ships a file of that name, in the same places. WB_ERR_NOT_FOUND with a message that
 * says where it looked. */
WB_MUST_CHECK enum wb_status wb_file_find_fixture(char path[WB_PATH], const char *kind,
                                                  const char *name, const char *beside);

/* The same, for a name that stands in a file: a failure's message begins with `named_in`, its file,
 * line and key ("specimen.yaml:1: wire"); NULL: with nothing. `why` receives the message. NULL: it
 * is logged. */
WB_MUST_CHECK enum wb_status wb_file_find_named(char path[WB_PATH], const char *kind,
                                                const char *name, const char *beside,
                                                const char *named_in, struct wb_reason *why);

/* A lock file that one process holds at a time. The kernel lets go of it when the process ends,
 * however that happens, so a lock file left behind locks nothing. */
struct wb_file_lock {
    int descriptor;
    char path[WB_PATH];
};

/* Takes the lock and writes this process's number into the file. WB_ERR_BUSY when another process
 * holds it: without a message, and *holder receives its number, 0 when that is not known. */
WB_MUST_CHECK enum wb_status wb_file_lock(struct wb_file_lock *lock, const char *path,
                                          long *holder);
/* Lets go of the lock and removes its file. */
void wb_file_unlock(struct wb_file_lock *lock);

#endif
