/* Whether the disk can take a recording: how long it takes to make data safe, and how much room
 * there is. */
#ifndef WB_DAQ_ACQUIRE_DISK_CHECK_H
#define WB_DAQ_ACQUIRE_DISK_CHECK_H

#include <stdbool.h>

#include "base/reason.h"

#define WB_DISK_CHECK_TEXT 512

struct wb_disk_check {
    int n;          /* flushes that were timed */
    double usual;   /* s, median of them */
    double longest; /* s */
    double free;    /* bytes that this user may still write */
};

/* Writes and flushes a file of some hundred kilobytes in the folder, as a recording is flushed, and
 * removes it. WB_ERR_PERMISSION, WB_ERR_NOT_FOUND or WB_ERR_IO where that cannot be done; `why` has
 * the message. */
WB_MUST_CHECK enum wb_status wb_disk_check_measure(struct wb_disk_check *check, const char *folder,
                                                   struct wb_reason *why);

/* True when a test of `duration` (s) that brings `rate` (bytes/s) can be recorded there ten times
 * over, flushed ten times a second. `text` says so, or what is wrong. */
bool wb_disk_check_judge(const struct wb_disk_check *check, const char *folder, double rate,
                         double duration, char text[WB_DISK_CHECK_TEXT]);

#endif
