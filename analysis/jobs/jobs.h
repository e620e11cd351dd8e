/* Many runs at once: on this machine's cores, or as a Slurm job array.
 *
 * A job makes one output folder, as `solve` does with -o: by a function that a worker process of
 * this machine calls, or by the command line of wirebench that does the same, which a task of Slurm
 * executes. It makes OUTPUT.partial, and the folder takes its final name when the job ended well
 * (exit code 0): an output that exists is complete, and a job whose output exists is not run again.
 * So the same call resumes what was interrupted and repeats what failed.
 *
 * A worker process is a fork of this one. It ends without what this process does at its end, and a
 * crash in it is its own; so that no lock is held in it by a thread that it does not have,
 * wb_jobs_run() is called while this process has no threads but those of the linear algebra, whose
 * library sees to its own.
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
    /* Makes the folder `output` on as many cores and returns an exit code; WB_JOBS_LOCAL only. Its
     * messages and what it prints go to the log. */
    int (*run)(void *context, const char *output, int cores);
    void *context;
    const char *const *arguments; /* of wirebench, for the same: NULL-terminated, without the
                                     program and without `-o OUTPUT`, which is added */
    const char *output;           /* folder that the job makes; its parent is made if need be */
    double cost;  /* expected duration in any unit: the longest go first; 0: not known */
    bool replace; /* an output that exists is outdated: make it again, and put the new one in
                     its place once it is whole */
};

enum wb_jobs_where {
    WB_JOBS_NOWHERE, /* nothing was asked for */
    WB_JOBS_LOCAL,   /* --solve: worker processes on this machine */
    WB_JOBS_SLURM    /* --slurm: a job array */
};

/* How jobs are run. All zero is a good start; cli/job_options.h fills it from a command line. Texts
 * are borrowed. */
struct wb_jobs_options {
    enum wb_jobs_where where;
    const char *folder;    /* for logs and lists; made if need be. Given by the caller */
    const char *title;     /* of the Slurm job; NULL: "wirebench" */
    const char *program;   /* of Slurm's tasks; NULL: this very binary */
    int workers;           /* jobs at once on this machine (0: cores / cores_per_job), or array
                              tasks at once in Slurm (0: no limit of ours) */
    int cores_per_job;     /* threads that a job may use; 0: 1 */
    bool dry_run;          /* Slurm: write the list and the script, submit nothing */
    const char *partition; /* of Slurm; NULL: its default, as the next three */
    const char *account;
    const char *time;   /* limit of a task, as sbatch takes it: "2:00:00" */
    const char *memory; /* of a task: "2G" */
    const char **extra; /* (n_extra) further options of sbatch: "--qos=long"; owned, see
                           wb_jobs_options_release() */
    int n_extra;
    double poll_interval; /* s between looks at Slurm's queue; 0: 10 */
};

/* What became of the jobs; the counts add up to n. */
struct wb_jobs_outcome {
    int present; /* output was there, nothing to do */
    int done;    /* made in this call */
    int failed;  /* ended without output; each was named with the last lines of its log */
    int left;    /* not run, or still in the queue: interrupted, or a dry run */
    bool interrupted;
};

/* Whether jobs are to be run. */
bool wb_jobs_wanted(const struct wb_jobs_options *options);

/* Runs what is missing of `jobs` (n), and waits. A failed job does not stop the others. An
 * interrupt (base/interrupt.h) ends local jobs and leaves nothing half-written; a Slurm array goes
 * on, and the next call waits for its tasks instead of submitting them again. One call at a time
 * per folder. Errors are about running itself: bad or double names (WB_ERR_ARGUMENT), no sbatch
 * (WB_ERR_NOT_FOUND), a folder in use (WB_ERR_BUSY), files (WB_ERR_IO). */
WB_MUST_CHECK enum wb_status wb_jobs_run(struct wb_jobs_outcome *outcome, const struct wb_job *jobs,
                                         int n, const struct wb_jobs_options *options);

/* Frees what the command line added. */
void wb_jobs_options_release(struct wb_jobs_options *options);

#endif
