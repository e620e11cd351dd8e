#include "tests/analysis/jobs/jobs_fixture.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/interrupt_private.h"
#include "tests/check.h"

char jobs_fixture_folder[64];
char jobs_fixture_said[16384];

/* --- the worker --- */

static void append(const char *path, const char *text)
{
    const int file = open(path, O_WRONLY | O_CREAT | O_APPEND, 0666);
    if (file < 0 || write(file, text, strlen(text)) < 0)
        exit(99);
    close(file);
}

static int make(const char *folder, const char *text)
{
    char path[4096];
    if (mkdir(folder, 0777) != 0 && errno != EEXIST)
        return 98;
    snprintf(path, sizeof path, "%s/dataset.json", folder);
    append(path, text);
    return 0;
}

static void sleep_ms(long ms)
{
    const struct timespec time = {.tv_sec = ms / 1000, .tv_nsec = ms % 1000 * 1000000L};
    nanosleep(&time, NULL);
}

static int run_until_killed(const char *folder, const char *note)
{
    char path[4096], pid[32];
    mkdir(folder, 0777);
    snprintf(path, sizeof path, "%s/force_deflection.csv", folder);
    append(path, "half of it");
    snprintf(pid, sizeof pid, "%ld\n", (long)getpid());
    append(note, pid);
    sleep_ms(60000);
    return 97;
}

/* `words` are the mode and up to three more, NULL-terminated. */
static int work(const char *const *words, const char *folder, const char *threads)
{
    const char *const mode = words[0], *const word = words[1] ? words[1] : "";
    if (strcmp(mode, "make") == 0)
        return make(folder, word);
    if (strcmp(mode, "note") == 0) { /* FILE TEXT */
        append(word, words[2]);
        return make(folder, words[2]);
    }
    if (strcmp(mode, "slow") == 0) { /* FILE */
        append(word, "+");
        sleep_ms(200);
        append(word, "-");
        return make(folder, "");
    }
    if (strcmp(mode, "hang") == 0) /* FILE */
        return run_until_killed(folder, word);
    if (strcmp(mode, "threads") == 0)
        return make(folder, threads);
    if (strcmp(mode, "nothing") == 0)
        return 0;
    if (strcmp(mode, "crash") == 0)
        return raise(SIGKILL);
    if (strcmp(mode, "short") == 0) {
        make(folder, "cut short");
        return 3;
    }
    for (int i = 1; i <= 9; i++) /* fail */
        fprintf(stderr, "line %d of what went wrong\n", i);
    mkdir(folder, 0777);
    return 1;
}

int jobs_fixture_worker(int argc, char **argv)
{
    const char *words[5] = {NULL};
    if (argc < 5 || argc > 9 || strcmp(argv[argc - 2], "-o") != 0)
        return 96;
    for (int i = 2; i < argc - 2; i++)
        words[i - 2] = argv[i];
    return work(words, argv[argc - 1], getenv("OMP_NUM_THREADS"));
}

/* The same as a function; its context are the words, "worker" first. */
static int run(void *context, const char *output, int cores)
{
    const char *const *const words = context;
    char threads[16];
    snprintf(threads, sizeof threads, "%d", cores);
    return work(words + 1, output, threads);
}

/* --- folder, messages, files --- */

int jobs_fixture_make_folder(void **state)
{
    (void)state;
    strcpy(jobs_fixture_folder, "/tmp/wirebench 9% jobs' XXXXXX");
    wb_interrupt_set(false);
    return mkdtemp(jobs_fixture_folder) && chdir(jobs_fixture_folder) == 0 ? 0 : -1;
}

int jobs_fixture_remove_folder(void **state)
{
    char command[128];
    (void)state;
    wb_log_set_sink(NULL, NULL);
    snprintf(command, sizeof command, "rm -rf \"%s\" 2>/dev/null", jobs_fixture_folder);
    if (chdir("/") != 0)
        return -1;
    /* A killed process may still be writing its last file. */
    for (int i = 0; i < 20 && system(command) != 0; i++)
        sleep_ms(200);
    return jobs_fixture_is_there(jobs_fixture_folder) ? -1 : 0;
}

static void take_message(void *context, enum wb_log_level level, const char *domain,
                         const char *message)
{
    const size_t n = strlen(jobs_fixture_said);
    (void)context, (void)level, (void)domain;
    snprintf(jobs_fixture_said + n, sizeof jobs_fixture_said - n, "%s\n", message);
}

void jobs_fixture_listen(void)
{
    jobs_fixture_said[0] = '\0';
    wb_log_set_sink(take_message, NULL);
}

const char *jobs_fixture_text(const char *path)
{
    static char text[16384];
    FILE *const file = fopen(path, "r");
    text[file ? fread(text, 1, sizeof text - 1, file) : 0] = '\0';
    if (file)
        fclose(file);
    return text;
}

bool jobs_fixture_is_there(const char *path)
{
    struct stat info;
    return lstat(path, &info) == 0;
}

int jobs_fixture_count(const char *text, const char *part)
{
    int n = 0;
    for (; (text = strstr(text, part)); text += strlen(part))
        n++;
    return n;
}

void jobs_fixture_write(const char *path, const char *text)
{
    FILE *const file = fopen(path, "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

/* --- runs --- */

struct wb_jobs_outcome jobs_fixture_run(const struct jobs_fixture_run *runs, int n,
                                        const struct wb_jobs_options *options,
                                        enum wb_status expected)
{
    struct wb_job jobs[16];
    const char *words[16][7];
    struct wb_jobs_outcome outcome = {.done = -1};
    struct wb_jobs_options with_folder = *options;
    assert_in_range(n, 0, 16);
    for (int i = 0; i < n; i++) {
        words[i][0] = "worker";
        for (int k = 0; k < 5; k++)
            words[i][k + 1] = runs[i].words[k];
        jobs[i] = (struct wb_job){.name = runs[i].name,
                                  .run = run,
                                  .context = words[i],
                                  .arguments = words[i],
                                  .output = runs[i].name,
                                  .cost = runs[i].cost,
                                  .replace = runs[i].replace};
    }
    if (!with_folder.folder)
        with_folder.folder = "logs";
    jobs_fixture_listen();
    assert_int_equal(wb_jobs_run(&outcome, jobs, n, &with_folder), expected);
    return outcome;
}

void jobs_fixture_expect(const struct wb_jobs_outcome *outcome, int present, int done, int failed,
                         int left)
{
    if (outcome->present != present || outcome->done != done || outcome->failed != failed ||
        outcome->left != left)
        fail_msg("%d present, %d done, %d failed, %d left; said: %s", outcome->present,
                 outcome->done, outcome->failed, outcome->left, jobs_fixture_said);
}

void jobs_fixture_replace(const struct wb_jobs_options *options)
{
    struct jobs_fixture_run run = {.name = "a", .words = {"make", "old"}};
    jobs_fixture_run(&run, 1, options, WB_OK);
    run.replace = true;
    run.words[0] = "fail";
    struct wb_jobs_outcome outcome = jobs_fixture_run(&run, 1, options, WB_OK);
    jobs_fixture_expect(&outcome, 0, 0, 1, 0);
    assert_string_equal(jobs_fixture_text("a/dataset.json"), "old");
    run.words[0] = "make";
    run.words[1] = "new";
    outcome = jobs_fixture_run(&run, 1, options, WB_OK);
    jobs_fixture_expect(&outcome, 0, 1, 0, 0);
    assert_string_equal(jobs_fixture_text("a/dataset.json"), "new");
    assert_false(jobs_fixture_is_there("a.outdated"));
}
