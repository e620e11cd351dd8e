/* Files: read completely, written completely or not at all. */
#ifndef WB_BASE_FILE_H
#define WB_BASE_FILE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/reason.h"
#include "base/status.h"
#include "base/text.h"

/* Longest path that this program creates, including the NUL. */
#define WB_PATH 4096

/* Reads a file into an allocated, NUL-terminated buffer (caller frees); *size excludes the NUL and
 * may be NULL. */
WB_MUST_CHECK enum wb_status wb_file_read(const char *path, char **bytes, size_t *size);
/* As wb_file_read(). On failure `why` receives the reason; if it is NULL, the reason is logged. */
WB_MUST_CHECK enum wb_status wb_file_read_with_reason(const char *path, char **bytes, size_t *size,
                                                      struct wb_reason *why);

/* Writes a file: to a temporary file in the same folder, synchronised, then renamed, so that
 * readers see either the old or the new file and no partial file remains. */
WB_MUST_CHECK enum wb_status wb_file_write(const char *path, const void *bytes, size_t size);

/* As wb_file_write() for a text. */
WB_MUST_CHECK enum wb_status wb_file_write_text(const char *path, const struct wb_text *text);

/* True if a file or folder exists; true if it is a folder. Links are followed. */
bool wb_file_exists(const char *path);
bool wb_file_is_folder(const char *path);

/* Number of a folder's entries, without "." and ".."; -1 if it cannot be opened. */
int wb_file_count_entries(const char *path);

/* Creates a folder and its parents; an existing folder is not an error. */
WB_MUST_CHECK enum wb_status wb_file_make_folder(const char *path);

/* Prepares an output folder: creates it. WB_ERR_EXISTS if it is not empty and `force` is not set
 * (the message mentions --force). */
WB_MUST_CHECK enum wb_status wb_file_prepare_output(const char *path, bool force);

/* Joins folder and name into `path`; an absolute name replaces the folder, and an empty folder is
 * the current one. WB_ERR_ARGUMENT if the result is too long. */
WB_MUST_CHECK enum wb_status wb_file_join(char path[WB_PATH], const char *folder, const char *name);

/* The folder part of a path ("." if there is none) into `folder`. */
void wb_file_folder(char folder[WB_PATH], const char *path);

/* The last component of a path; points into it. */
const char *wb_file_name(const char *path);

/* Finds shipped data ("fixtures/wires/type1.yaml"): below $WIREBENCH_DATA if set, otherwise below
 * the source tree of the build if it exists, otherwise below the installed data folder.
 * WB_ERR_NOT_FOUND without a message if there is no such file. */
WB_MUST_CHECK enum wb_status wb_file_find_data(char path[WB_PATH], const char *name);

/* Finds the YAML file for `name`, as given on the command line. A name with a slash or ending in
 * ".yaml" is a path: tried relative to the folder `beside` (unless NULL), then relative to the
 * current folder, then as shipped data. Any other name is fixtures/KIND/NAME.yaml ("wires",
 * "type1"); if no such file is shipped, it is tried as a path. WB_ERR_NOT_FOUND with a message that
 * names the places searched. */
WB_MUST_CHECK enum wb_status wb_file_find_fixture(char path[WB_PATH], const char *kind,
                                                  const char *name, const char *beside);

/* As wb_file_find_fixture(), for a name in a file: a failure's message begins with `named_in`, its
 * file, line and key ("specimen.yaml:1: wire"); NULL: no prefix. `why` receives the message; NULL:
 * it is logged. */
WB_MUST_CHECK enum wb_status wb_file_find_named(char path[WB_PATH], const char *kind,
                                                const char *name, const char *beside,
                                                const char *named_in, struct wb_reason *why);

/* A lock file, held by one process at a time. The kernel releases the lock when the process ends
 * for any reason, so a leftover lock file has no effect. */
struct wb_file_lock {
    int descriptor;
    char path[WB_PATH];
};

/* Takes the lock and writes this process's number to the file. WB_ERR_BUSY, without a message, if
 * another process holds it; *holder receives its number, 0 if unknown. */
WB_MUST_CHECK enum wb_status wb_file_lock(struct wb_file_lock *lock, const char *path,
                                          long *holder);
/* Releases the lock and removes its file. */
void wb_file_unlock(struct wb_file_lock *lock);

#endif
