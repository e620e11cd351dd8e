#include "analysis/jobs/jobs_array.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "analysis/jobs/jobs_queue.h"
#include "base/text.h"

#define WB_LOG_DOMAIN "jobs"

static const double submit_time = 120.0; /* s */

/* Arguments: list, lines before this array's first. A line: log, output, what to do with an output
 * that is there, command line; quoted for a shell by whoever wrote it. */
static const char script[] =
    "#!/bin/sh\n"
    "# Written by wirebench: one task of a job array runs one line of the list.\n"
    "set -u\n"
    "line=$(sed -n \"$(($2 + SLURM_ARRAY_TASK_ID))p\" \"$1\") && [ -n \"$line\" ] || {\n"
    "    echo \"no line $(($2 + SLURM_ARRAY_TASK_ID)) in $1\" >&2\n"
    "    exit 1\n"
    "}\n"
    "eval \"set -- $line\"\n"
    "log=$1 output=$2 old=$3\n"
    "shift 3\n"
    "exec >\"$log\" 2>&1 </dev/null\n"
    "if [ \"$old\" = keep ] && [ -e \"$output/dataset.json\" ]; then\n"
    "    echo \"$output is there already\"\n"
    "    exit 0\n"
    "fi\n"
    "export OMP_NUM_THREADS=\"${SLURM_CPUS_PER_TASK:-1}\"\n"
    "export OPENBLAS_NUM_THREADS=\"$OMP_NUM_THREADS\"\n"
    "echo \"$* -o $output.partial\"\n"
    "rm -rf -- \"$output.partial\"\n"
    /* It stays as long as its run does: Slurm loses sight of an orphan, and may begin the run anew
       while that still writes. */
    "\"$@\" -o \"$output.partial\" &\n"
    "run=$!\n"
    "trap 'kill $run' TERM\n"
    "wait $run\n"
    "code=$?\n"
    "while kill -0 $run 2>/dev/null; do\n"
    "    wait $run\n"
    "    code=$?\n"
    "done\n"
    "trap - TERM\n"
    "if [ $code -ne 0 ]; then\n"
    "    echo \"exit code $code\"\n"
    "    exit $code\n"
    "fi\n"
    "[ -e \"$output.partial/dataset.json\" ] || {\n"
    "    echo \"it made no dataset\"\n"
    "    exit 1\n"
    "}\n"
    "if [ \"$old\" = replace ] && [ -e \"$output\" ]; then\n"
    "    rm -rf -- \"$output.outdated\"\n"
    "    mv -T -- \"$output\" \"$output.outdated\" || exit 1\n"
    "fi\n"
    "mv -T -- \"$output.partial\" \"$output\" || exit 1\n"
    "if [ \"$old\" = replace ]; then\n"
    "    rm -rf -- \"$output.outdated\"\n"
    "fi\n";

/* --- script and list --- */

static void append_words(struct wb_text *text, const char *const *words)
{
    for (; *words; words++) {
        wb_text_append(text, " ");
        wb_jobs_plan_quote(text, *words);
    }
}

static enum wb_status find_self(char program[WB_PATH])
{
    static const char gone[] = " (deleted)";
    const ssize_t n = readlink("/proc/self/exe", program, WB_PATH - 1);
    if (n < 0)
        return wb_fail(WB_ERR_IO, "cannot tell where wirebench is: %s", strerror(errno));
    program[n] = '\0';
    const size_t length = (size_t)n, ending = sizeof gone - 1;
    if (length > ending && strcmp(program + length - ending, gone) == 0)
        return wb_fail(WB_ERR_IO, "wirebench was replaced while it ran: start it again");
    return WB_OK;
}

static enum wb_status write_file(const char *folder, const char *name, const struct wb_text *text)
{
    char path[WB_PATH];
    if (text->failed)
        return wb_fail(WB_ERR_MEMORY, "out of memory");
    WB_TRY(wb_file_join(path, folder, name));
    return wb_file_write(path, wb_text_string(text), text->length);
}

static enum wb_status write_list(const struct wb_jobs_plan *plan, const char *folder)
{
    char program[WB_PATH];
    struct wb_text text = {0};
    if (plan->options->program)
        WB_TRY(wb_file_join(program, plan->directory, plan->options->program));
    else
        WB_TRY(find_self(program));
    for (int i = 0; i < plan->n; i++) {
        const struct wb_jobs_plan_item *const item = &plan->items[i];
        const char *const head[] = {item->output, item->job->replace ? "replace" : "keep", program,
                                    NULL};
        wb_jobs_plan_quote(&text, item->log);
        append_words(&text, head);
        append_words(&text, item->job->arguments);
        wb_text_append(&text, "\n");
    }
    const enum wb_status status = write_file(folder, "jobs.txt", &text);
    wb_text_release(&text);
    return status;
}

static enum wb_status make_folder(const struct wb_jobs_plan *plan, char list[32],
                                  char folder[WB_PATH])
{
    for (int i = 1; i < 1000000; i++) {
        snprintf(list, 32, "slurm-%d", i);
        WB_TRY(wb_file_join(folder, plan->folder, list));
        if (mkdir(folder, 0777) == 0)
            return WB_OK;
        if (errno != EEXIST)
            break;
    }
    return wb_fail(WB_ERR_IO, "cannot make '%s': %s", folder, strerror(errno));
}

enum wb_status wb_jobs_array_write(const struct wb_jobs_plan *plan, char list[32])
{
    char folder[WB_PATH];
    struct wb_text text = {0};
    if (strchr(plan->folder, '\n') || strchr(plan->folder, '\\'))
        return wb_fail(WB_ERR_ARGUMENT,
                       "'%s': Slurm cannot write into a folder with a line break or a backslash in "
                       "its path",
                       plan->folder);
    WB_TRY(make_folder(plan, list, folder));
    wb_text_append(&text, "%s", script);
    enum wb_status status = write_file(folder, "array.sh", &text);
    wb_text_release(&text);
    if (status == WB_OK)
        status = write_list(plan, folder);
    return status;
}

/* --- submission --- */

static bool is_wanted(const struct wb_jobs_plan *plan, int index)
{
    return index < plan->n && plan->items[index].state == WB_JOBS_PLAN_TODO &&
           !plan->items[index].queued;
}

/* "--array=1,4-7%2": the tasks that are wanted; how many. */
static int append_tasks(struct wb_text *text, const struct wb_jobs_plan *plan, int first, int size)
{
    int n = 0;
    wb_text_append(text, "--array=");
    for (int task = 1; task <= size; task++) {
        if (!is_wanted(plan, first + task - 1))
            continue;
        int last = task;
        while (last < size && is_wanted(plan, first + last))
            last++;
        wb_text_append(text, "%s%d", n > 0 ? "," : "", task);
        if (last > task)
            wb_text_append(text, "-%d", last);
        n += last - task + 1;
        task = last;
    }
    if (plan->options->workers > 0)
        wb_text_append(text, "%%%d", plan->options->workers);
    return n;
}

/* The words of the sbatch command, as texts one after the other. */
struct command {
    struct wb_text texts; /* NUL after each */
    size_t n;
};

static void add_word(struct command *command, const char *option, const char *value)
{
    if (!value)
        return;
    wb_text_append(&command->texts, "%s%s", option, value);
    wb_text_append_bytes(&command->texts, "", 1);
    command->n++;
}

static void add_number(struct command *command, const char *option, int value)
{
    char text[16];
    snprintf(text, sizeof text, "%d", value);
    add_word(command, option, text);
}

/* Where Slurm puts what it says itself; '%' begins one of its own signs. */
static void add_output(struct command *command, const char *folder)
{
    wb_text_append(&command->texts, "--output=");
    for (const char *c = folder; *c; c++)
        wb_text_append_bytes(&command->texts, *c == '%' ? "%%" : c, *c == '%' ? 2 : 1);
    wb_text_append(&command->texts, "/%%A_%%a.out");
    wb_text_append_bytes(&command->texts, "", 1);
    command->n++;
}

static enum wb_status fill_command(struct command *command, const struct wb_jobs_plan *plan,
                                   const char *tasks, const char *list, int first)
{
    const struct wb_jobs_options *const o = plan->options;
    char folder[WB_PATH], path[WB_PATH];
    WB_TRY(wb_file_join(folder, plan->folder, list));
    add_word(command, "sbatch", "");
    add_word(command, "--parsable", "");
    add_word(command, tasks, "");
    add_word(command, "--job-name=", o->title ? o->title : "wirebench");
    add_word(command, "--chdir=", plan->directory);
    add_output(command, folder);
    add_word(command, "--ntasks=", "1");
    add_number(command, "--cpus-per-task=", plan->cores_per_job);
    add_word(command, "--partition=", o->partition);
    add_word(command, "--account=", o->account);
    add_word(command, "--time=", o->time);
    add_word(command, "--mem=", o->memory);
    for (int i = 0; i < o->n_extra; i++)
        add_word(command, o->extra[i], "");
    WB_TRY(wb_file_join(path, folder, "array.sh"));
    add_word(command, path, "");
    WB_TRY(wb_file_join(path, folder, "jobs.txt"));
    add_word(command, path, "");
    add_number(command, "", first);
    return WB_OK;
}

/* "12" or "12;cluster". */
static enum wb_status read_id(const char *said, char array[32], char cluster[64])
{
    array[0] = cluster[0] = '\0';
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
        return wb_fail(
            WB_ERR_NOT_FOUND,
            "there is no sbatch in PATH: --slurm needs Slurm's commands on this machine; "
            "--solve computes here, on all cores");
    if (status == WB_ERR_TIMEOUT)
        return wb_fail(WB_ERR_TIMEOUT, "it cannot be told whether the array was submitted: look "
                                       "with squeue before trying again");
    if (status != WB_OK)
        return status;
    const char *const said = wb_text_string(&answer.err);
    if (answer.code != 0)
        status = wb_fail(WB_ERR_IO, "sbatch refused the array (exit code %d): %.*s", answer.code,
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
    wb_info("%d %s not submitted; to do that:\n   %s", n, n == 1 ? "run" : "runs",
            wb_text_string(&text));
    wb_text_release(&text);
}

static void mark(struct wb_jobs_plan *plan, const char *list, int first, int size,
                 const char *array, const char *cluster)
{
    for (int task = 1; task <= size; task++) {
        if (!is_wanted(plan, first + task - 1))
            continue;
        struct wb_jobs_plan_item *const item = &plan->items[first + task - 1];
        item->queued = true;
        item->task = task;
        item->ended_ns = 0;
        item->ending[0] = '\0';
        snprintf(item->array, sizeof item->array, "%s", array);
        snprintf(item->cluster, sizeof item->cluster, "%s", cluster);
        snprintf(item->list, sizeof item->list, "%s", list);
    }
}

/* An old log would be taken for the new one's. */
static void remove_logs(const struct wb_jobs_plan *plan, int first, int size)
{
    for (int i = first; i < first + size; i++)
        if (is_wanted(plan, i))
            unlink(plan->items[i].log);
}

static enum wb_status submit(struct wb_jobs_plan *plan, const struct command *command, int n,
                             char array[32], char cluster[64])
{
    const char **const words = calloc(command->n + 1, sizeof *words);
    if (!words || command->texts.failed) {
        free(words);
        return wb_fail(WB_ERR_MEMORY, "out of memory");
    }
    const char *text = command->texts.bytes;
    for (size_t i = 0; i < command->n; i++) {
        words[i] = text;
        text += strlen(text) + 1;
    }
    enum wb_status status = WB_OK;
    if (plan->options->dry_run)
        show(words, n);
    else
        status = ask_sbatch(words, array, cluster);
    free(words);
    return status;
}

enum wb_status wb_jobs_array_submit(struct wb_jobs_plan *plan, const char *list, int first,
                                    int size)
{
    char array[32] = "", cluster[64] = "";
    struct wb_text tasks = {0};
    struct command command = {0};
    const int n = append_tasks(&tasks, plan, first, size);
    enum wb_status status = WB_OK;
    if (n > 0) {
        status = fill_command(&command, plan, wb_text_string(&tasks), list, first);
        if (status == WB_OK && !plan->options->dry_run)
            remove_logs(plan, first, size);
        if (status == WB_OK)
            status = submit(plan, &command, n, array, cluster);
        if (status == WB_OK && !plan->options->dry_run)
            mark(plan, list, first, size, array, cluster);
    }
    wb_text_release(&command.texts);
    wb_text_release(&tasks);
    return status;
}
