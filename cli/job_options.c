#include "cli/job_options.h"

#include "analysis/jobs/jobs.h"
#include "base/memory.h"
#include "cli/command.h"

enum {
    KEY_SOLVE = WB_KEY_OWN,
    KEY_SLURM,
    KEY_DRY_RUN,
    KEY_WORKERS,
    KEY_CORES,
    KEY_EXTRA
};

static const struct argp_option option_table[] = {
    {NULL, 0, NULL, 0, "Datasets that are missing or outdated, and runs of --uncertain:", 2},
    {"solve", KEY_SOLVE, NULL, 0, "Compute them here, on all cores", 2},
    {"workers", KEY_WORKERS, "N", 0, "Runs at once (as many as cores; with --slurm, no limit)", 2},
    {"cores-per-run", KEY_CORES, "N", 0, "Threads that one run may use (1)", 2},
    {"slurm", KEY_SLURM, NULL, 0,
     "Compute them as a Slurm job array, wait for it and collect the datasets", 2},
    {"slurm-dry-run", KEY_DRY_RUN, NULL, 0,
     "Write the script and list of the array, but submit nothing", 2},
    {"slurm-partition", WB_KEY_TEXT(wb_jobs_options, partition), "NAME", 0,
     "Partition of the array", 2},
    {"slurm-account", WB_KEY_TEXT(wb_jobs_options, account), "NAME", 0, "Account that is charged",
     2},
    {"slurm-time", WB_KEY_TEXT(wb_jobs_options, time), "TIME", 0,
     "Time limit of one run, as sbatch takes it (2:00:00)", 2},
    {"slurm-memory", WB_KEY_TEXT(wb_jobs_options, memory), "SIZE", 0,
     "Memory of one run, as sbatch takes it (2G)", 2},
    {"slurm-option", KEY_EXTRA, "OPTION", 0,
     "Another option of sbatch (--qos=long); may be given several times", 2},
    {0},
};

static void want(struct argp_state *state, struct wb_jobs_options *o, enum wb_jobs_where where)
{
    if (o->where != WB_JOBS_NOWHERE && o->where != where)
        argp_error(state, "--solve and --slurm cannot be combined");
    o->where = where;
}

static void add_extra(struct argp_state *state, struct wb_jobs_options *o, const char *option)
{
    if (option[0] != '-')
        argp_error(state,
                   "--slurm-option: expected an option of sbatch such as --qos=long, not "
                   "'%s'",
                   option);
    o->extra = wb_memory_resize(o->extra, (size_t)o->n_extra + 1, sizeof *o->extra);
    o->extra[o->n_extra++] = option;
}

static void check(struct argp_state *state, const struct wb_jobs_options *o)
{
    const bool has_slurm_option =
        o->partition || o->account || o->time || o->memory || o->n_extra > 0;
    if (has_slurm_option && o->where != WB_JOBS_SLURM)
        argp_error(state, "options --slurm-... need --slurm");
    if ((o->workers > 0 || o->cores_per_job > 0) && o->where == WB_JOBS_NOWHERE)
        argp_error(state, "--workers and --cores-per-run need --solve or --slurm");
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct wb_jobs_options *const o = state->input;
    switch (key) {
    case KEY_SOLVE:
        want(state, o, WB_JOBS_LOCAL);
        return 0;
    case KEY_SLURM:
        want(state, o, WB_JOBS_SLURM);
        return 0;
    case KEY_DRY_RUN:
        want(state, o, WB_JOBS_SLURM);
        o->dry_run = true;
        return 0;
    case KEY_WORKERS:
        o->workers = wb_command_integer(state, "--workers", argument, 1, 100000);
        return 0;
    case KEY_CORES:
        o->cores_per_job = wb_command_integer(state, "--cores-per-run", argument, 1, 1024);
        return 0;
    case KEY_EXTRA:
        add_extra(state, o, argument);
        return 0;
    case ARGP_KEY_END:
        check(state, o);
        return 0;
    default:
        return wb_command_parse_field(key, argument, state);
    }
}

const struct argp wb_job_options_argp = {.options = option_table, .parser = parse};
