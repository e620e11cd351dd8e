/* Runs many jobs: on this machine's cores, or as a Slurm job array.
 *
 * A job makes one output folder, such as a dataset, as `solve` does with -o: by a function, called
 * in a worker process on this machine, or by the equivalent command line of wirebench, executed by
 * a Slurm task. It writes OUTPUT.partial; the folder gets its final name when the job succeeded
 * (exit code 0). So an output that exists is complete, and its job is not run again: the same call
 * resumes interrupted jobs and repeats failed ones.
 *
 * A worker process is a fork of this one. It exits without this process's exit handlers, and its
 * crash does not affect this process. To avoid locks that are held by a thread the fork does not
 * have, wb_jobs_run() is called while this process has no threads except those of the linear
 * algebra, whose library handles forks.
 *
 * Typical use:
 *
 *     struct wb_jobs_options options = {.where = WB_JOBS_LOCAL, .folder = "report.jobs"};
 *     status = wb_jobs_run(&outcome, jobs, n, &options);
 */
#ifndef WB_ANALYSIS_JOBS_JOBS_H
#define WB_ANALYSIS_JOBS_JOBS_H

#include <stdbool.h>

#include "base/status.h"

struct wb_job {
    const char *name; /* unique; of letters, digits, '.', '_', '-': it names the log */
    /* Makes the folder `output` on this number of cores and returns an exit code; WB_JOBS_LOCAL
     * only. Its messages and output go to the log. */
    int (*run)(void *context, const char *output, int cores);
    void *context;
    const char *const *arguments; /* of the equivalent command of wirebench: NULL-terminated,
                                     without the program and without `-o OUTPUT`, which is added */
    const char *output;  /* folder that the job makes; missing parent folders are created */
    const char *product; /* file without which that folder is not complete; NULL: dataset.json */
    double cost;  /* expected duration in any unit: the longest jobs start first; 0: unknown */
    bool replace; /* an existing output is outdated: make it again, and replace it once the new one
                     is complete */
};

enum wb_jobs_where {
    WB_JOBS_NOWHERE, /* not requested */
    WB_JOBS_LOCAL,   /* --solve: worker processes on this machine */
    WB_JOBS_SLURM    /* --slurm: a job array */
};

/* How jobs are run. All zero is a valid default; cli/job_options.h fills it from a command line.
 * Strings are borrowed. */
struct wb_jobs_options {
    enum wb_jobs_where where;
    const char *folder;    /* for logs and lists; created if missing; required */
    const char *title;     /* of the Slurm job; NULL: "wirebench" */
    const char *program;   /* of Slurm's tasks; NULL: the running binary */
    int workers;           /* jobs at once on this machine (0: cores / cores_per_job), or array
                              tasks at once in Slurm (0: no limit of ours) */
    int cores_per_job;     /* threads that a job may use; 0: 1 */
    bool dry_run;          /* Slurm: write the list and the script, submit nothing */
    const char *partition; /* of Slurm; NULL: its default, also for the next three */
    const char *account;
    const char *time;   /* limit of a task, as sbatch takes it: "2:00:00" */
    const char *memory; /* of a task: "2G" */
    const char **extra; /* (n_extra) further options of sbatch: "--qos=long"; owned, see
                           wb_jobs_options_release() */
    int n_extra;
    double poll_interval; /* s between requests to Slurm's queue; 0: 10 */
};

/* Result of the jobs; the counts add up to n. */
struct wb_jobs_outcome {
    int present; /* the output existed */
    int done;    /* made in this call */
    int failed;  /* without output; each was reported with the last lines of its log */
    int left;    /* not run, or still in the queue: interrupted, or a dry run */
    bool interrupted;
};

/* Whether running jobs was requested. */
bool wb_jobs_wanted(const struct wb_jobs_options *options);

/* Runs the `jobs` (n) whose output is missing, and waits. A failed job does not stop the others. An
 * interrupt (base/interrupt.h) ends local jobs and removes their incomplete outputs; a Slurm array
 * continues, and the next call waits for its tasks instead of submitting them again. One call at a
 * time per folder. Errors: invalid or duplicate names (WB_ERR_ARGUMENT), no sbatch
 * (WB_ERR_NOT_FOUND), a folder in use (WB_ERR_BUSY), files (WB_ERR_IO). */
WB_MUST_CHECK enum wb_status wb_jobs_run(struct wb_jobs_outcome *outcome, const struct wb_job *jobs,
                                         int n, const struct wb_jobs_options *options);

/* Frees what the command line added. */
void wb_jobs_options_release(struct wb_jobs_options *options);

#endif
