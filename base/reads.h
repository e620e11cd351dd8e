/* Which files this process has read, with the SHA-256 sums of what it found in them. wb_file_read()
 * notes them, and whatever stands on it: what a result is made from is noted where it is read, and
 * no list can forget a file. Any thread may read; one asks.
 */
#ifndef WB_BASE_READS_H
#define WB_BASE_READS_H

#include <stdbool.h>
#include <stddef.h>

#include "base/hash.h"

/* Forgets what was noted. From here on reads are noted, until wb_reads_stop(), which forgets too.
 */
void wb_reads_start(void);
void wb_reads_stop(void);

/* How many are noted: one for a file, one more for each time that something else was found in it.
 */
int wb_reads_count(void);
/* Forgets all but the first n. */
void wb_reads_forget(int n);

struct wb_read {
    const char *path; /* absolute, without links and ".."; valid until it is forgotten */
    char sha256[WB_SHA256_TEXT];
};
/* The one at an index, in the order of reading; false after the last. */
bool wb_reads_at(int index, struct wb_read *read);

/* Of a file that was read: notes what it holds; leaves it out again, as no input that stays. */
void wb_reads_note(const char *path, const void *bytes, size_t size);
void wb_reads_leave_out(const char *path);

#endif
