/* Time to make the report of the shipped campaign, on all cores and on one: alignment of all
 * recordings, calibrations, validations, and drawing. The baseline is one thread in the same run.
 * Usage: bench_demo_report CAMPAIGN.yaml */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#include "analysis/report/bench/recordings_kind.h"
#include "base/log.h"

static double seconds(clockid_t clock)
{
    struct timespec now;
    clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

struct timing {
    double compute, draw, cpu; /* s: wall, wall, CPU of both */
    int n_tests, n_usable;
};

static bool time_report(const char *path, int n_threads, const char *folder, struct timing *timing)
{
    struct wb_recordings campaign;
    struct wb_recordings_results results = {.n_wires = 0};
    const double cpu = seconds(CLOCK_PROCESS_CPUTIME_ID), start = seconds(CLOCK_MONOTONIC);
    if (wb_kind_read(&wb_recordings_kind, &campaign, path) != WB_OK)
        return false;
    if (wb_recordings_results_load(&results, &campaign) != WB_OK ||
        wb_recordings_results_compute(&results, n_threads, NULL, NULL) != WB_OK) {
        wb_recordings_results_release(&results);
        wb_recordings_release(&campaign);
        return false;
    }
    const double computed = seconds(CLOCK_MONOTONIC);
    const bool good =
        wb_kind_write(&wb_recordings_kind, &results, folder, true, n_threads) == WB_OK;
    timing->compute = computed - start;
    timing->draw = seconds(CLOCK_MONOTONIC) - computed;
    timing->cpu = seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu;
    timing->n_tests = results.outcome.n_wanted;
    timing->n_usable = results.outcome.n_usable;
    wb_recordings_results_release(&results);
    wb_recordings_release(&campaign);
    return good;
}

int main(int argc, char **argv)
{
    char folder[] = "/tmp/wb-demo-report-XXXXXX", command[128];
    struct timing all, one;
    if (argc != 2 || !mkdtemp(folder)) {
        fprintf(stderr, "usage: bench_demo_report CAMPAIGN.yaml\n");
        return EXIT_FAILURE;
    }
    wb_log_set_threshold(WB_LOG_ERROR);
    const bool good =
        time_report(argv[1], 0, folder, &all) && time_report(argv[1], 1, folder, &one);
    snprintf(command, sizeof command, "rm -r '%s'", folder);
    if (system(command) != 0)
        fprintf(stderr, "cannot remove %s\n", folder);
    if (!good)
        return EXIT_FAILURE;
    printf("report of the shipped campaign, %d of %d recordings (virtual rig), %ld cores\n\n"
           "                          compute      draw     wall s    CPU s\n"
           "wirebench                %8.2f  %8.2f   %8.2f %8.2f\n"
           "one thread (base)        %8.2f  %8.2f   %8.2f %8.2f\n"
           "ratio to one thread      %8.2f  %8.2f   %8.2f\n\n"
           "goal: at most 10 s of wall time on 2 cores\n",
           all.n_usable, all.n_tests, sysconf(_SC_NPROCESSORS_ONLN), all.compute, all.draw,
           all.compute + all.draw, all.cpu, one.compute, one.draw, one.compute + one.draw, one.cpu,
           all.compute / one.compute, all.draw / one.draw,
           (all.compute + all.draw) / (one.compute + one.draw));
    return EXIT_SUCCESS;
}
