/* Log of the files that this process has read, with the SHA-256 sums of their contents.
 * wb_file_read() and everything based on it notes them where they are read, so the inputs of a
 * result are complete. Any thread may read files; one thread queries the log.
 */
#ifndef WB_BASE_READS_H
#define WB_BASE_READS_H

#include <stdbool.h>
#include <stddef.h>

#include "base/hash.h"

/* Clears the log and notes reads until wb_reads_stop(), which also clears it. */
void wb_reads_start(void);
void wb_reads_stop(void);

/* Number of entries: one per file, and one more for each time that its contents had changed. */
int wb_reads_count(void);
/* Drops all entries after the first n. */
void wb_reads_forget(int n);

struct wb_read {
    const char *path; /* absolute, without links and ".."; valid until the entry is dropped */
    char sha256[WB_SHA256_TEXT];
};
/* Gets the entry at an index, in the order of reading; false after the last. */
bool wb_reads_at(int index, struct wb_read *read);

/* For a file that was read: adds an entry; removes it again if the file is not an input of the
 * result. */
void wb_reads_note(const char *path, const void *bytes, size_t size);
void wb_reads_leave_out(const char *path);

#endif
