#include "analysis/jobs/jobs_array.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/memory.h"
#include "base/program.h"
#include "base/text.h"

#define WB_LOG_DOMAIN "jobs"

static const double submit_time = 120.0; /* s */

/* Runs in the folder of the list; its argument is the folder of the runs. A line contains log,
 * output, what to do with an existing output, the file that makes it complete, and the command
 * line, all quoted for a shell. */
/* clang-format off */
static const char script[] =
    "#!/bin/sh\n"
    "# Written by wirebench: one task of a job array runs one line of the list.\n"
    "set -u\n"
    "line=$(sed -n \"${SLURM_ARRAY_TASK_ID}p\" jobs.txt) && [ -n \"$line\" ] || exit 1\n"
    "cd \"$1\" || exit 1\n"
    "eval \"set -- $line\"\n"
    "log=$1 output=$2 old=$3 product=$4\n"
    "shift 4\n"
    "exec >\"$log\" 2>&1 </dev/null\n"
    "[ \"$old\" = replace ] || [ ! -e \"$output/$product\" ] || { echo \"$output exists already\"; exit 0; }\n"
    "export OMP_NUM_THREADS=\"${SLURM_CPUS_PER_TASK:-1}\"\n"
    "export OPENBLAS_NUM_THREADS=\"$OMP_NUM_THREADS\"\n"
    "echo \"$* -o $output.partial\"\n"
    "rm -rf -- \"$output.partial\"\n"
    /* The script stays until its run ends: Slurm does not track an orphan, and might start the run
     * again while the orphan still writes. */
    "\"$@\" --no-figure -o \"$output.partial\" &\n"
    "run=$!\n"
    "trap 'kill $run' TERM\n"
    "wait $run; code=$?\n"
    "while kill -0 $run 2>/dev/null; do wait $run; code=$?; done\n"
    "trap - TERM\n"
    "[ $code -eq 0 ] || { echo \"exit code $code\"; exit $code; }\n"
    "[ -e \"$output.partial/$product\" ] || { echo \"it made no $product\"; exit 1; }\n"
    "set -e\n"
    "if [ \"$old\" = replace ] && [ -e \"$output\" ]; then\n"
    "    rm -rf -- \"$output.outdated\"\n"
    "    mv -T -- \"$output\" \"$output.outdated\"\n"
    "fi\n"
    "mv -T -- \"$output.partial\" \"$output\"\n"
    "[ \"$old\" = keep ] || rm -rf -- \"$output.outdated\"\n";
/* clang-format on */

static enum wb_status find_self(char program[WB_PATH])
{
    static const char gone[] = " (deleted)";
    const ssize_t n = readlink("/proc/self/exe", program, WB_PATH - 1);
    if (n < 0)
        return wb_fail(WB_ERR_IO, "cannot determine the path of wirebench: %s", strerror(errno));
    program[n] = '\0';
    const size_t length = (size_t)n, ending = sizeof gone - 1;
    if (length > ending && strcmp(program + length - ending, gone) == 0)
        return wb_fail(WB_ERR_IO, "wirebench was replaced while it ran: start it again");
    return WB_OK;
}

/* Appends the words, quoted for a shell, each followed by a space. */
static void append_words(struct wb_text *text, const char *const *words)
{
    for (; *words; words++) {
        wb_text_append_quoted(text, *words);
        wb_text_append(text, " ");
    }
}

static enum wb_status write_file(const char *folder, const char *name, const struct wb_text *text)
{
    char path[WB_PATH];
    WB_TRY(wb_file_join(path, folder, name));
    return wb_file_write_text(path, text);
}

/* Writes one line per item, in their order. */
static enum wb_status write_list(const struct wb_jobs_plan *plan, const char *folder,
                                 struct wb_jobs_plan_item *const *items, int n)
{
    char program[WB_PATH];
    struct wb_text text = {0};
    if (plan->options->program)
        WB_TRY(wb_file_join(program, plan->directory, plan->options->program));
    else
        WB_TRY(find_self(program));
    for (int k = 0; k < n; k++) {
        const struct wb_job *const job = items[k]->job;
        const char *const head[] = {items[k]->log,
                                    items[k]->output,
                                    job->replace ? "replace" : "keep",
                                    wb_jobs_plan_product(items[k]),
                                    program,
                                    NULL};
        append_words(&text, head);
        append_words(&text, job->arguments);
        wb_text_append(&text, "\n");
    }
    const enum wb_status status = write_file(folder, "jobs.txt", &text);
    wb_text_release(&text);
    return status;
}

/* Creates the next free folder slurm-N, with the script. */
static enum wb_status make_folder(const struct wb_jobs_plan *plan, char list[32],
                                  char folder[WB_PATH])
{
    struct wb_text text = {0};
    if (strpbrk(plan->folder, "\n\\"))
        return wb_fail(WB_ERR_ARGUMENT,
                       "'%s': Slurm cannot write into a folder with a line break or a backslash in "
                       "its path",
                       plan->folder);
    int number = 0;
    do {
        snprintf(list, 32, "slurm-%d", ++number);
        WB_TRY(wb_file_join(folder, plan->folder, list));
    } while (mkdir(folder, 0777) != 0 && errno == EEXIST);
    wb_text_append(&text, "%s", script);
    const enum wb_status status = write_file(folder, "array.sh", &text);
    wb_text_release(&text);
    return status;
}

/* Parses "12" or "12;cluster". */
static enum wb_status read_id(const char *said, char array[32], char cluster[64])
{
    if (sscanf(said, "%31[0-9];%63[^\n]", array, cluster) < 1)
        return wb_fail(WB_ERR_FORMAT, "sbatch answered '%.*s', not with the number of a job",
                       (int)strcspn(said, "\n"), said);
    return WB_OK;
}

static enum wb_status ask_sbatch(const char *const *words, char array[32], char cluster[64])
{
    struct wb_program_answer answer;
    enum wb_status status = wb_program_run(&answer, words, submit_time);
    if (status == WB_ERR_NOT_FOUND)
        return wb_fail(WB_ERR_NOT_FOUND, "no sbatch in PATH: --slurm needs Slurm's commands on "
                                         "this machine; --solve computes on this machine's cores");
    if (status == WB_ERR_TIMEOUT)
        return wb_fail(WB_ERR_TIMEOUT, "cannot determine whether the array was submitted: check "
                                       "with squeue before trying again");
    if (status != WB_OK)
        return status;
    const char *const said = wb_text_string(&answer.err);
    if (answer.code != 0)
        status = wb_fail(WB_ERR_IO, "sbatch rejected the array (exit code %d): %.*s", answer.code,
                         (int)strcspn(said, "\n"), said);
    else
        status = read_id(wb_text_string(&answer.out), array, cluster);
    wb_program_answer_release(&answer);
    return status;
}

static void show(const char *const *words, int n)
{
    struct wb_text text = {0};
    append_words(&text, words);
    wb_info("%d %s not submitted; to submit:\n    %s", n, n == 1 ? "run" : "runs",
            wb_text_string(&text));
    wb_text_release(&text);
}

static enum wb_status submit(const struct wb_jobs_plan *plan, const char *folder, int n,
                             char array[32], char cluster[64])
{
    const struct wb_jobs_options *const o = plan->options;
    char tasks[32], cores[16], path[WB_PATH];
    WB_TRY(wb_file_join(path, folder, "array.sh"));
    snprintf(cores, sizeof cores, "%d", plan->cores_per_job);
    snprintf(tasks, sizeof tasks, o->workers > 0 ? "1-%d%%%d" : "1-%d", n, o->workers);
    /* An option and its value; options without a value are left out. */
    const char *const options[][2] = {{"--array", tasks},
                                      {"--job-name", o->title ? o->title : "wirebench"},
                                      {"--chdir", folder},
                                      {"--output", "%A_%a.out"},
                                      {"--ntasks", "1"},
                                      {"--cpus-per-task", cores},
                                      {"--partition", o->partition},
                                      {"--account", o->account},
                                      {"--time", o->time},
                                      {"--mem", o->memory}};
    const size_t n_options = sizeof options / sizeof options[0];
    const char **const words = wb_memory_new(2 * n_options + (size_t)o->n_extra + 5, sizeof *words);
    size_t k = 0;
    words[k++] = "sbatch";
    words[k++] = "--parsable";
    for (size_t i = 0; i < n_options; i++) {
        if (!options[i][1])
            continue;
        words[k++] = options[i][0];
        words[k++] = options[i][1];
    }
    for (int i = 0; i < o->n_extra; i++)
        words[k++] = o->extra[i];
    words[k++] = path;
    words[k++] = plan->directory;
    enum wb_status status = WB_OK;
    if (o->dry_run)
        show(words, n);
    else
        status = ask_sbatch(words, array, cluster);
    free(words);
    return status;
}

enum wb_status wb_jobs_array_submit(const struct wb_jobs_plan *plan,
                                    struct wb_jobs_plan_item *const *items, int n)
{
    char list[32], folder[WB_PATH], array[32] = "", cluster[64] = "";
    WB_TRY(make_folder(plan, list, folder));
    WB_TRY(write_list(plan, folder, items, n));
    /* An old log would be mistaken for the new one. */
    for (int k = 0; k < n && !plan->options->dry_run; k++)
        unlink(items[k]->log);
    WB_TRY(submit(plan, folder, n, array, cluster));
    for (int k = 0; k < n && !plan->options->dry_run; k++) {
        struct wb_jobs_plan_item *const item = items[k];
        item->queued = true;
        item->task = k + 1;
        item->ended_ns = 0;
        item->ending[0] = '\0';
        snprintf(item->array, sizeof item->array, "%s", array);
        snprintf(item->cluster, sizeof item->cluster, "%s", cluster);
        snprintf(item->list, sizeof item->list, "%s", list);
    }
    return WB_OK;
}
