/* Options for computing missing datasets: --solve, --slurm, --workers and others.
 *
 *     static const struct argp_child children[] = {{&wb_job_options_argp, 0, NULL, 0}, {0}};
 *     ... in its parser: case ARGP_KEY_INIT: state->child_inputs[0] = &o->jobs; return 0;
 */
#ifndef WB_CLI_JOB_OPTIONS_H
#define WB_CLI_JOB_OPTIONS_H

#include <argp.h>

/* A child of the command's own argp. Its input is a struct wb_jobs_options (analysis/jobs/jobs.h),
 * zeroed before and released with wb_jobs_options_release(). */
extern const struct argp wb_job_options_argp;

#endif
