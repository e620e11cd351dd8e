#include "daq/acquire/disk_check.h"

#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "base/file.h"
#include "base/timing.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "disk"

#define FLUSHES 16
/* Bytes written between two flushes of a test: some kilobytes of data and as many of the log. */
#define FLUSH_BYTES 16384
/* s between two flushes (daq/recording/writer.h). */
#define FLUSH_PERIOD 0.1
/* Space of the database and its log per received byte. */
#define ROOM_FACTOR 3.0
#define TESTS 10.0 /* that must fit on the disk */
#define MEGABYTE 1e6

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Returns 0, or the errno of a failure. */
static int time_flushes(int file, struct wb_disk_check *check)
{
    static const char bytes[FLUSH_BYTES] = "wirebench: how fast is this disk?\n";
    double took[FLUSHES];
    for (check->n = 0; check->n < FLUSHES; check->n++) {
        const int64_t begun_ns = wb_time_now_ns();
        const ssize_t written = write(file, bytes, sizeof bytes);
        if (written != (ssize_t)sizeof bytes)
            return written < 0 ? errno : ENOSPC;
        if (fsync(file) != 0)
            return errno;
        took[check->n] = wb_seconds_from_ns(wb_time_now_ns() - begun_ns);
    }
    qsort(took, FLUSHES, sizeof *took, by_size);
    check->usual = took[FLUSHES / 2];
    check->longest = took[FLUSHES - 1];
    return 0;
}

static enum wb_status fail(int error, const char *folder, struct wb_reason *why)
{
    const enum wb_status status = error == EACCES || error == EROFS ? WB_ERR_PERMISSION
                                  : error == ENOENT                 ? WB_ERR_NOT_FOUND
                                                                    : WB_ERR_IO;
    return wb_fail_to(why, status,
                      "nothing can be written to the folder '%s': %s; free disk space, check its "
                      "permissions, or choose another folder (--folder)",
                      folder, strerror(error));
}

enum wb_status wb_disk_check_measure(struct wb_disk_check *check, const char *folder,
                                     struct wb_reason *why)
{
    char path[WB_PATH];
    struct statvfs room;
    struct wb_disk_check measured = {0};
    WB_TRY(wb_file_join(path, folder, ".wirebench-disk-XXXXXX"));
    const int file = mkstemp(path);
    if (file < 0)
        return fail(errno, folder, why);
    const int error = time_flushes(file, &measured);
    close(file);
    unlink(path);
    if (error != 0)
        return fail(error, folder, why);
    if (statvfs(folder, &room) != 0)
        return fail(errno, folder, why);
    measured.free = (double)room.f_bavail * (double)room.f_frsize;
    *check = measured;
    return WB_OK;
}

bool wb_disk_check_judge(const struct wb_disk_check *check, const char *folder, double rate,
                         double duration, char text[WB_DISK_CHECK_TEXT])
{
    const double need = ROOM_FACTOR * rate * duration;
    if (check->usual > FLUSH_PERIOD)
        snprintf(
            text, WB_DISK_CHECK_TEXT,
            "the disk of '%s' needs %.0f ms for a flush, but a recording flushes every %.0f ms: "
            "record to a disk of this computer (--folder), not to a network drive or a memory "
            "card",
            folder, check->usual * 1e3, FLUSH_PERIOD * 1e3);
    else if (check->free < TESTS * need)
        snprintf(text, WB_DISK_CHECK_TEXT,
                 "'%s' has %.0f MB free, and a test of %.0f s takes about %.1f MB: free space for "
                 "%.0f tests",
                 folder, check->free / MEGABYTE, duration, need / MEGABYTE, TESTS);
    else {
        snprintf(text, WB_DISK_CHECK_TEXT,
                 "'%s': a flush takes %.1f ms (longest %.1f ms); %.0f MB free, a test of %.0f s "
                 "takes about %.1f MB",
                 folder, check->usual * 1e3, check->longest * 1e3, check->free / MEGABYTE, duration,
                 need / MEGABYTE);
        return true;
    }
    return false;
}
