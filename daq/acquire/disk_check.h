/* Checks whether a disk is suitable for recordings: duration of a flush, and free space. */
#ifndef WB_DAQ_ACQUIRE_DISK_CHECK_H
#define WB_DAQ_ACQUIRE_DISK_CHECK_H

#include <stdbool.h>

#include "base/reason.h"

#define WB_DISK_CHECK_TEXT 512

struct wb_disk_check {
    int n;          /* timed flushes */
    double usual;   /* s, median duration of a flush */
    double longest; /* s, longest duration of a flush */
    double free;    /* bytes available to this user */
};

/* Measures by writing, flushing and removing a file of some hundred kilobytes in the folder.
 * WB_ERR_PERMISSION, WB_ERR_NOT_FOUND or WB_ERR_IO: the file cannot be written; `why` holds the
 * message. */
WB_MUST_CHECK enum wb_status wb_disk_check_measure(struct wb_disk_check *check, const char *folder,
                                                   struct wb_reason *why);

/* True if the disk can flush ten times a second and has space for ten tests of `duration` (s) at
 * `rate` (bytes/s). `text` receives the result and, if false, the remedy. */
bool wb_disk_check_judge(const struct wb_disk_check *check, const char *folder, double rate,
                         double duration, char text[WB_DISK_CHECK_TEXT]);

#endif
