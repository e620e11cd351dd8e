#include "base/progress.h"

#include <stdio.h>
#include <time.h>
#include <unistd.h>

#include "base/log.h"
#include "base/timing.h"
#include "base/units.h"

double wb_progress_thread_cpu(void)
{
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void wb_progress_start(struct wb_progress *progress, const char *label, const char *unit,
                       double total)
{
    *progress = (struct wb_progress){
        .label = label,
        .unit = unit,
        .total = total,
        .started_ns = wb_time_now_ns(),
        .on_terminal = isatty(STDERR_FILENO) != 0,
    };
}

void wb_progress_resume(struct wb_progress *progress, double done)
{
    progress->begun = done;
}

void wb_progress_update(struct wb_progress *progress, double done, const char *note)
{
    if (!progress->on_terminal)
        return;
    const int64_t now_ns = wb_time_now_ns();
    if (progress->drawn && now_ns - progress->drawn_ns < WB_NS_PER_S / 10)
        return;
    progress->drawn = true;
    progress->drawn_ns = now_ns;
    const double elapsed = wb_seconds_from_ns(now_ns - progress->started_ns);
    const double rate = elapsed > 0.0 ? (done - progress->begun) / elapsed : 0.0;
    fprintf(stderr, "\r\033[K%s: ", progress->label);
    if (progress->total > 0.0 && rate > 0.0)
        fprintf(stderr, "%.0f of %.0f %s, %.3g/s, %.0f s left", done, progress->total,
                progress->unit, rate, (progress->total - done) / rate);
    else
        fprintf(stderr, "%.0f %s, %.3g/s", done, progress->unit, rate);
    if (note && note[0])
        fprintf(stderr, ", %s", note);
    fflush(stderr);
    wb_log_note_line(true);
}

void wb_progress_finish(struct wb_progress *progress)
{
    if (progress->on_terminal && progress->drawn) {
        fprintf(stderr, "\r\033[K");
        fflush(stderr);
        wb_log_note_line(false);
    }
    progress->drawn = false;
}
