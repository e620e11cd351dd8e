/* Many runs on this machine: all are made, in as many processes as requested, and no incomplete
 * output remains. */
#include <fcntl.h>
#include <pty.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "analysis/solve/solve.h"
#include "base/file.h"
#include "base/interrupt_private.h"
#include "base/units.h"
#include "tests/analysis/jobs/jobs_fixture.h"
#include "tests/check.h"

static const struct wb_jobs_options local = {.where = WB_JOBS_LOCAL, .workers = 3};
static const struct wb_jobs_options one_by_one = {.where = WB_JOBS_LOCAL, .workers = 1};

static int solve(void *context, const char *output, int cores)
{
    struct wb_solve_settings settings = *(const struct wb_solve_settings *)context;
    bool complete;
    settings.output = output;
    wb_solve_set_threads(cores);
    return wb_solve_run(&settings, NULL, NULL, &complete) == WB_OK && complete ? 0 : 1;
}

static void wirebench_itself_makes_datasets(void **unused)
{
    (void)unused;
    struct wb_solve_settings settings = {.kind = WB_SOLVE_CANTILEVER};
    wb_setting_fill(&wb_solve_settings_table, &settings);
    settings.wire = "type1";
    settings.length = 85.0 * WB_MM;
    settings.deflection = 10.0 * WB_MM;
    settings.points = 2;
    char **const words = wb_solve_settings_command(&settings);
    assert_non_null(words);
    const struct wb_job a = {.name = "a",
                             .run = solve,
                             .context = &settings,
                             .arguments = (const char *const *)words,
                             .output = "data/a b"};
    struct wb_job jobs[] = {a, a};
    jobs[1].name = "b";
    jobs[1].output = "data/b/";
    const struct wb_jobs_options options = {.where = WB_JOBS_LOCAL, .folder = "logs"};
    struct wb_jobs_outcome outcome;
    assert_int_equal(wb_jobs_run(&outcome, jobs, 2, &options), WB_OK);
    free(words);
    jobs_fixture_expect(&outcome, 0, 2, 0, 0);
    assert_true(jobs_fixture_is_there("data/a b/force_deflection.csv"));
    assert_true(jobs_fixture_is_there("data/b/dataset.json"));
    assert_false(jobs_fixture_is_there("data/b.partial"));
    assert_false(jobs_fixture_is_there("data/b/.partial"));
    assert_non_null(strstr(jobs_fixture_text("logs/a.log"),
                           "wirebench solve cantilever --wire type1 --length-mm 85 "
                           "--deflection-mm 10 --points 2 -o "));
    assert_false(jobs_fixture_is_there("logs/lock"));
}

static void existing_outputs_are_not_run_again(void **unused)
{
    (void)unused;
    /* The first time one fails: the folder of its notes is missing. */
    struct jobs_fixture_run first[] = {{.name = "a", .words = {"note", "nowhere/notes", "a"}},
                                       {.name = "b", .words = {"note", "notes", "b"}}};
    struct wb_jobs_outcome outcome = jobs_fixture_run(first, 2, &local, WB_OK);
    jobs_fixture_expect(&outcome, 0, 1, 1, 0);
    first[0].words[1] = "notes";
    outcome = jobs_fixture_run(first, 2, &local, WB_OK);
    jobs_fixture_expect(&outcome, 1, 1, 0, 0);
    assert_string_equal(jobs_fixture_text("notes"), "ba");
    outcome = jobs_fixture_run(first, 2, &local, WB_OK);
    jobs_fixture_expect(&outcome, 2, 0, 0, 0);
    assert_string_equal(jobs_fixture_text("notes"), "ba");
}

static void a_failure_is_reported_with_the_end_of_its_log_and_does_not_stop_others(void **unused)
{
    (void)unused;
    const struct jobs_fixture_run runs[] = {{.name = "bad", .words = {"fail"}},
                                            {.name = "none", .words = {"nothing"}},
                                            {.name = "dead", .words = {"crash"}},
                                            {.name = "good", .words = {"make", "x"}}};
    const struct wb_jobs_outcome outcome = jobs_fixture_run(runs, 4, &one_by_one, WB_OK);
    jobs_fixture_expect(&outcome, 0, 1, 3, 0);
    assert_false(outcome.interrupted);
    assert_non_null(strstr(jobs_fixture_said, "run 'bad' failed: exit code 1 after "));
    assert_non_null(strstr(jobs_fixture_said, "/logs/bad.log'\n    line 5 of what went wrong\n"));
    assert_non_null(strstr(jobs_fixture_said, "\n    line 9 of what went wrong\n"));
    assert_null(strstr(jobs_fixture_said, "line 4"));
    assert_non_null(strstr(jobs_fixture_said, "run 'none' failed: no dataset after "));
    assert_non_null(strstr(jobs_fixture_said, "run 'dead' failed: ended by signal 9 (Killed)"));
    assert_true(jobs_fixture_is_there("good/dataset.json"));
    assert_false(jobs_fixture_is_there("bad"));
    assert_false(jobs_fixture_is_there("bad.partial"));
}

static void an_incomplete_curve_is_kept_in_the_partial_folder(void **unused)
{
    (void)unused;
    struct jobs_fixture_run run = {.name = "a", .words = {"short"}};
    struct wb_jobs_outcome outcome = jobs_fixture_run(&run, 1, &local, WB_OK);
    jobs_fixture_expect(&outcome, 0, 0, 1, 0);
    assert_non_null(strstr(jobs_fixture_said, "exit code 3"));
    assert_non_null(strstr(jobs_fixture_said, "/a.partial'"));
    assert_string_equal(jobs_fixture_text("a.partial/dataset.json"), "cut short");
    assert_false(jobs_fixture_is_there("a"));
    /* The next attempt begins with an empty folder. */
    run.words[0] = "make";
    run.words[1] = "whole";
    outcome = jobs_fixture_run(&run, 1, &local, WB_OK);
    jobs_fixture_expect(&outcome, 0, 1, 0, 0);
    assert_string_equal(jobs_fixture_text("a/dataset.json"), "whole");
    assert_false(jobs_fixture_is_there("a.partial"));
}

static void the_requested_number_of_runs_is_executed_at_once(void **unused)
{
    (void)unused;
    struct jobs_fixture_run runs[7];
    static const char *const names[] = {"a", "b", "c", "d", "e", "f", "g"};
    for (int i = 0; i < 7; i++)
        runs[i] = (struct jobs_fixture_run){.name = names[i], .words = {"slow", "peak"}};
    const struct wb_jobs_outcome outcome = jobs_fixture_run(runs, 7, &local, WB_OK);
    jobs_fixture_expect(&outcome, 0, 7, 0, 0);
    int now = 0, most = 0;
    for (const char *c = jobs_fixture_text("peak"); *c; c++) {
        now += *c == '+' ? 1 : -1;
        most = now > most ? now : most;
    }
    assert_int_equal(now, 0);
    assert_int_equal(most, 3);
}

static void costly_runs_start_first(void **unused)
{
    (void)unused;
    const struct jobs_fixture_run runs[] = {
        {.name = "a", .words = {"note", "notes", "a"}, .cost = 1.0},
        {.name = "b", .words = {"note", "notes", "b"}, .cost = 7.0},
        {.name = "c", .words = {"note", "notes", "c"}, .cost = 1.0},
        {.name = "d", .words = {"note", "notes", "d"}, .cost = 27.0}};
    jobs_fixture_run(runs, 4, &one_by_one, WB_OK);
    assert_string_equal(jobs_fixture_text("notes"), "dbac");
}

static void threads_of_a_run_are_limited(void **unused)
{
    (void)unused;
    const struct jobs_fixture_run runs[] = {{.name = "a", .words = {"threads"}}};
    setenv("OMP_NUM_THREADS", "57", 1);
    jobs_fixture_run(runs, 1, &local, WB_OK);
    unsetenv("OMP_NUM_THREADS");
    assert_string_equal(jobs_fixture_text("a/dataset.json"), "1");
    const struct jobs_fixture_run more[] = {{.name = "b", .words = {"threads"}}};
    const struct wb_jobs_options options = {.where = WB_JOBS_LOCAL, .cores_per_job = 4};
    jobs_fixture_run(more, 1, &options, WB_OK);
    assert_string_equal(jobs_fixture_text("b/dataset.json"), "4");
}

static void outdated_output_stays_until_the_new_one_is_whole(void **unused)
{
    (void)unused;
    jobs_fixture_replace(&local);
}

static void a_folder_without_dataset_is_not_replaced(void **unused)
{
    (void)unused;
    const struct jobs_fixture_run runs[] = {{.name = "a", .words = {"make", "x"}},
                                            {.name = "empty", .words = {"make", "x"}}};
    assert_int_equal(mkdir("a", 0777), 0);
    assert_int_equal(mkdir("empty", 0777), 0);
    jobs_fixture_write("a/letters", "dear");
    const struct wb_jobs_outcome outcome = jobs_fixture_run(runs, 2, &local, WB_OK);
    jobs_fixture_expect(&outcome, 0, 1, 1, 0);
    assert_non_null(strstr(jobs_fixture_said, "/a' exists but has no dataset.json"));
    assert_string_equal(jobs_fixture_text("a/letters"), "dear");
    assert_true(jobs_fixture_is_there("empty/dataset.json"));
}

/* Sends a signal to this process once the file has this number of lines. */
static pid_t send_when(int signal_number, const char *path, int lines)
{
    const pid_t parent = getpid(), child = fork();
    if (child != 0)
        return child;
    for (int i = 0; i < 1000 && jobs_fixture_count(jobs_fixture_text(path), "\n") < lines; i++)
        usleep(10000);
    kill(parent, signal_number);
    _exit(0);
}

/* Whether the processes listed in the file have ended; waits up to 5 s. */
static bool are_gone(const char *path)
{
    char text[256];
    snprintf(text, sizeof text, "%s", jobs_fixture_text(path));
    for (char *line = strtok(text, "\n"); line; line = strtok(NULL, "\n")) {
        int i = 0;
        while (kill((pid_t)atol(line), 0) == 0 && i < 500) {
            while (waitpid(-1, NULL, WNOHANG) > 0) /* orphans become our children */
                ;
            usleep(10000);
            i++;
        }
        if (i == 500)
            return false;
    }
    return true;
}

static void an_interrupt_ends_the_children_and_removes_incomplete_outputs(void **unused)
{
    (void)unused;
    const struct jobs_fixture_run runs[] = {{.name = "a", .words = {"make", "x"}, .cost = 9.0},
                                            {.name = "b", .words = {"hang", "pids"}},
                                            {.name = "c", .words = {"hang", "pids"}},
                                            {.name = "d", .words = {"hang", "pids"}},
                                            {.name = "e", .words = {"make", "x"}}};
    wb_interrupt_install();
    const pid_t helper = send_when(SIGINT, "pids", 3);
    struct wb_jobs_outcome outcome = jobs_fixture_run(runs, 5, &local, WB_OK);
    waitpid(helper, NULL, 0);
    wb_interrupt_set(false);
    jobs_fixture_expect(&outcome, 0, 1, 0, 4);
    assert_true(outcome.interrupted);
    assert_string_equal(jobs_fixture_said, "");
    assert_int_equal(jobs_fixture_count(jobs_fixture_text("pids"), "\n"), 3);
    assert_true(are_gone("pids"));
    assert_false(jobs_fixture_is_there("b") || jobs_fixture_is_there("b.partial"));
    assert_true(jobs_fixture_is_there("a/dataset.json"));
    /* The next call continues. */
    outcome = jobs_fixture_run(&runs[4], 1, &local, WB_OK);
    jobs_fixture_expect(&outcome, 0, 1, 0, 0);
}

static void children_do_not_outlive_a_killed_parent(void **unused)
{
    (void)unused;
    const struct jobs_fixture_run runs[] = {{.name = "a", .words = {"hang", "pids"}},
                                            {.name = "b", .words = {"hang", "pids"}}};
    assert_int_equal(prctl(PR_SET_CHILD_SUBREAPER, 1), 0);
    const pid_t child = fork();
    if (child == 0) {
        jobs_fixture_run(runs, 2, &local, WB_OK);
        _exit(0);
    }
    for (int i = 0; i < 1000 && jobs_fixture_count(jobs_fixture_text("pids"), "\n") < 2; i++)
        usleep(10000);
    kill(child, SIGKILL);
    waitpid(child, NULL, 0);
    assert_int_equal(jobs_fixture_count(jobs_fixture_text("pids"), "\n"), 2);
    assert_true(are_gone("pids"));
    /* Incomplete outputs and the lock do not block the next call. */
    const struct jobs_fixture_run again[] = {{.name = "a", .words = {"make", "x"}}};
    const struct wb_jobs_outcome outcome = jobs_fixture_run(again, 1, &local, WB_OK);
    jobs_fixture_expect(&outcome, 0, 1, 0, 0);
    assert_false(jobs_fixture_is_there("a.partial"));
    assert_false(jobs_fixture_is_there("a/force_deflection.csv"));
}

static void one_call_at_a_time(void **unused)
{
    (void)unused;
    const struct jobs_fixture_run runs[] = {{.name = "a", .words = {"make", "x"}}};
    struct wb_file_lock lock;
    long holder;
    assert_int_equal(mkdir("logs", 0777), 0);
    assert_int_equal(wb_file_lock(&lock, "logs/lock", &holder), WB_OK);
    jobs_fixture_run(runs, 1, &local, WB_ERR_BUSY);
    assert_non_null(strstr(jobs_fixture_said, "in progress in process"));
    wb_file_unlock(&lock);
    assert_false(jobs_fixture_is_there("a"));
}

static void invalid_lists_are_rejected(void **unused)
{
    (void)unused;
    static const char *const words[] = {"worker", "make", "x", NULL}, *const broken[] = {"a\nb",
                                                                                         NULL};
    struct wb_job lists[][2] = {
        {{.name = "a/b", .arguments = words, .output = "a"}},
        {{.name = "", .arguments = words, .output = "a"}},
        {{.name = "a", .arguments = broken, .output = "a"}},
        {{.name = "a", .arguments = words, .output = ""}},
        {{.name = "a", .arguments = words, .output = "a"},
         {.name = "a", .arguments = words, .output = "b"}},
        {{.name = "a", .arguments = words, .output = "x"},
         {.name = "b", .arguments = words, .output = "./x/"}},
        {{.name = "a", .arguments = words, .output = "x"}},
    };
    static const char *const messages[] = {"'a/b'",
                                           "''",
                                           "line break",
                                           "no output folder",
                                           "two runs are named 'a'",
                                           "'a' and 'b' would both write",
                                           "no function to run"};
    const struct wb_jobs_options options = {.where = WB_JOBS_LOCAL, .folder = "logs"};
    for (size_t i = 0; i < sizeof lists / sizeof lists[0]; i++) {
        struct wb_jobs_outcome outcome;
        if (i + 1 < WB_COUNT(lists))
            lists[i][0].run = lists[i][1].run = solve;
        jobs_fixture_listen();
        assert_int_equal(wb_jobs_run(&outcome, lists[i], lists[i][1].name ? 2 : 1, &options),
                         WB_ERR_ARGUMENT);
        if (!strstr(jobs_fixture_said, messages[i]))
            fail_msg("'%s' is not in '%s'", messages[i], jobs_fixture_said);
        assert_int_equal(jobs_fixture_count(jobs_fixture_said, "\n"), 1);
    }
}

static void the_terminal_shows_the_progress(void **unused)
{
    (void)unused;
    const struct jobs_fixture_run runs[] = {{.name = "a", .words = {"make", "x"}, .cost = 2.0},
                                            {.name = "b", .words = {"fail"}, .cost = 1.0},
                                            {.name = "c", .words = {"hang", "pids"}},
                                            {.name = "d", .words = {"make", "x"}}};
    int terminal;
    const pid_t child = forkpty(&terminal, NULL, NULL, NULL);
    assert_true(child >= 0);
    if (child == 0) {
        wb_interrupt_install();
        jobs_fixture_run(runs, 4, &one_by_one, WB_OK);
        _exit(0);
    }
    char heard[8192] = "";
    size_t n = 0;
    for (ssize_t got; !strstr(heard, "1 running, 1 left, 1 failed, about ") &&
                      n < sizeof heard - 1 &&
                      (got = read(terminal, heard + n, sizeof heard - 1 - n)) > 0;) {
        n += (size_t)got;
        heard[n] = '\0';
    }
    kill(child, SIGINT);
    waitpid(child, NULL, 0);
    close(terminal);
    assert_non_null(strstr(heard, "runs: 1 of 4 done, 1 running, 1 left, 1 failed, about 0 s"));
}

int main(int argc, char **argv)
{
    if (argc > 1 && strcmp(argv[1], "worker") == 0)
        return jobs_fixture_worker(argc, argv);
    alarm(50); /* a signal that only sets a flag does not end a test that hangs */
#define WITH_FOLDER(fact)                                                                          \
    cmocka_unit_test_setup_teardown(fact, jobs_fixture_make_folder, jobs_fixture_remove_folder)
    const struct CMUnitTest tests[] = {
        WITH_FOLDER(wirebench_itself_makes_datasets),
        WITH_FOLDER(existing_outputs_are_not_run_again),
        WITH_FOLDER(a_failure_is_reported_with_the_end_of_its_log_and_does_not_stop_others),
        WITH_FOLDER(an_incomplete_curve_is_kept_in_the_partial_folder),
        WITH_FOLDER(the_requested_number_of_runs_is_executed_at_once),
        WITH_FOLDER(costly_runs_start_first),
        WITH_FOLDER(threads_of_a_run_are_limited),
        WITH_FOLDER(outdated_output_stays_until_the_new_one_is_whole),
        WITH_FOLDER(a_folder_without_dataset_is_not_replaced),
        WITH_FOLDER(an_interrupt_ends_the_children_and_removes_incomplete_outputs),
        WITH_FOLDER(children_do_not_outlive_a_killed_parent),
        WITH_FOLDER(one_call_at_a_time),
        WITH_FOLDER(invalid_lists_are_rejected),
        WITH_FOLDER(the_terminal_shows_the_progress),
    };
    return cmocka_run_group_tests_name("jobs_local", tests, NULL, NULL);
}
