/* Slurm job arrays with stand-ins for Slurm's commands: submission, the script of a task, and the
 * parsing of the queue's answers. jobs-slurm.sh uses a real Slurm. */
#include <signal.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/interrupt_private.h"
#include "tests/analysis/jobs/jobs_fixture.h"
#include "tests/check.h"

static const struct wb_jobs_options slurm = {.where = WB_JOBS_SLURM, .poll_interval = 0.05};

/* Records its arguments; runs the tasks of the list at once unless there is a file `hold`. If a
 * file `clusters` lists clusters, each gets one array, all with the number 12. With a file
 * `forget`, squeue gets no entries. */
static const char sbatch[] =
    "#!/bin/sh\n"
    "cd \"$FAKE\" || exit 1\n"
    "[ ! -e refuse ] || { echo 'sbatch: error: invalid partition: nowhere' >&2; exit 1; }\n"
    "printf '%s\\n' \"$@\" >> sbatch.said\n"
    "echo . >> sbatch.count\n"
    "id=$((11 + $(wc -l < sbatch.count))) cluster=\n"
    "[ ! -e clusters ] || { cluster=$(sed -n \"$((id - 11))p\" clusters); id=12; }\n"
    "while [ $# -gt 2 ]; do\n"
    "    case $1 in --array) tasks=${2%\\%*} ;; --chdir) folder=$2 ;; esac\n"
    "    shift\n"
    "done\n"
    "for task in $(seq \"${tasks#1-}\"); do\n"
    "    state=PENDING\n"
    "    [ -e \"hold$cluster\" ] || {\n"
    "        state=FAILED\n"
    "        (cd \"$folder\" && SLURM_ARRAY_TASK_ID=$task SLURM_CPUS_PER_TASK=3 sh \"$@\") \\\n"
    "            && state=COMPLETED\n"
    "    }\n"
    "    [ -e forget ] || echo \"${id}_$task|$state|None|$1\" >> queue.$id$cluster\n"
    "done\n"
    "echo \"$id${cluster:+;$cluster}\"\n";

/* Answers from the file that sbatch wrote; while the file `mute` has lines, removes one and
 * fails. */
static const char squeue[] =
    "#!/bin/sh\n"
    "cd \"$FAKE\" || exit 1\n"
    "[ ! -s mute ] || {\n"
    "    sed -i 1d mute\n"
    "    echo 'slurm_load_jobs error: Unable to contact slurm controller' >&2\n"
    "    exit 1\n"
    "}\n"
    "while [ $# -gt 1 ]; do\n"
    "    case $1 in --jobs) id=$2 ;; --clusters) cluster=$2 ;; esac\n"
    "    shift\n"
    "done\n"
    "cat \"queue.$id$cluster\" && exit\n"
    "echo 'slurm_load_jobs error: Invalid job id specified' >&2\n"
    "exit 1\n";

static const char scontrol[] = "#!/bin/sh\n"
                               "echo 'MaxArraySize            = '$(cat \"$FAKE/largest\")\n";

static const char sacct[] = "#!/bin/sh\n"
                            "[ -e \"$FAKE/accounting\" ] || exit 1\n"
                            "cat \"$FAKE/accounting\"\n";

static char old_path[4096];

static void write_command(const char *path, const char *text)
{
    jobs_fixture_write(path, text);
    assert_int_equal(chmod(path, 0755), 0);
}

static int make_slurm(void **state)
{
    char path[8192];
    if (jobs_fixture_make_folder(state) != 0 || mkdir("fake", 0777) != 0)
        return -1;
    write_command("fake/sbatch", sbatch);
    write_command("fake/squeue", squeue);
    write_command("fake/scontrol", scontrol);
    write_command("fake/sacct", sacct);
    jobs_fixture_write("fake/largest", "1001");
    snprintf(path, sizeof path, "%s/fake", jobs_fixture_folder);
    setenv("FAKE", path, 1);
    snprintf(old_path, sizeof old_path, "%s", getenv("PATH"));
    snprintf(path, sizeof path, "%s/fake:%s", jobs_fixture_folder, old_path);
    return setenv("PATH", path, 1);
}

static int remove_slurm(void **state)
{
    setenv("PATH", old_path, 1);
    return jobs_fixture_remove_folder(state);
}

static const struct jobs_fixture_run five[] = {
    {.name = "a", .words = {"make", "1"}},
    {.name = "b", .words = {"fail"}},
    {.name = "c", .words = {"make", "it's \"so\" $HOME"}},
    {.name = "d", .words = {"threads"}},
    {.name = "e", .words = {"nothing"}}};

static void only_what_is_missing_is_submitted(void **unused)
{
    (void)unused;
    struct jobs_fixture_run runs[5];
    struct wb_jobs_outcome outcome = jobs_fixture_run(five, 5, &slurm, WB_OK);
    jobs_fixture_expect(&outcome, 0, 3, 2, 0);
    assert_non_null(strstr(jobs_fixture_text("fake/sbatch.said"), "--array\n1-5\n"));
    assert_string_equal(jobs_fixture_text("c/dataset.json"), "it's \"so\" $HOME");
    assert_string_equal(jobs_fixture_text("d/dataset.json"), "3");
    assert_false(jobs_fixture_is_there("logs/a.slurm") || jobs_fixture_is_there("logs/b.slurm"));
    assert_non_null(strstr(jobs_fixture_said, "run 'b' failed: Slurm's task 12_2 is FAILED"));
    assert_non_null(
        strstr(jobs_fixture_said, "\n    line 9 of what went wrong\n    exit code 1\n"));
    assert_non_null(strstr(jobs_fixture_said, "run 'e' failed: Slurm's task 12_5 is FAILED"));
    assert_non_null(strstr(jobs_fixture_said, "\n    it made no dataset.json\n"));

    memcpy(runs, five, sizeof runs);
    runs[1].words[0] = runs[4].words[0] = "make";
    runs[1].words[1] = runs[4].words[1] = "x";
    unlink("a/dataset.json");
    rmdir("a");
    jobs_fixture_write("fake/sbatch.said", "");
    outcome = jobs_fixture_run(runs, 5, &slurm, WB_OK);
    jobs_fixture_expect(&outcome, 2, 3, 0, 0);
    assert_non_null(strstr(jobs_fixture_text("fake/sbatch.said"), "--array\n1-3\n"));
    outcome = jobs_fixture_run(runs, 5, &slurm, WB_OK);
    jobs_fixture_expect(&outcome, 5, 0, 0, 0);
    assert_int_equal(jobs_fixture_count(jobs_fixture_text("fake/sbatch.count"), "\n"), 2);
}

static void options_are_passed_on(void **unused)
{
    (void)unused;
    static const char *extra[] = {"--qos=long", "--exclude=a b"};
    const struct wb_jobs_options options = {.where = WB_JOBS_SLURM,
                                            .poll_interval = 0.05,
                                            .title = "my bundles",
                                            .workers = 7,
                                            .cores_per_job = 3,
                                            .partition = "fast",
                                            .account = "wires",
                                            .time = "1:30:00",
                                            .memory = "2G",
                                            .extra = extra,
                                            .n_extra = 2,
                                            .folder = "100 %"};
    const struct wb_jobs_outcome outcome = jobs_fixture_run(five, 1, &options, WB_OK);
    jobs_fixture_expect(&outcome, 0, 1, 0, 0);
    char expected[4096];
    snprintf(expected, sizeof expected,
             "--parsable\n--array\n1-1%%7\n--job-name\nmy bundles\n--chdir\n%s/100 %%/slurm-1\n"
             "--output\n%%A_%%a.out\n--ntasks\n1\n--cpus-per-task\n3\n--partition\nfast\n"
             "--account\nwires\n--time\n1:30:00\n--mem\n2G\n--qos=long\n--exclude=a b\n"
             "%s/100 %%/slurm-1/array.sh\n%s\n",
             jobs_fixture_folder, jobs_fixture_folder, jobs_fixture_folder);
    assert_string_equal(jobs_fixture_text("fake/sbatch.said"), expected);
}

static void dry_run_writes_and_submits_nothing(void **unused)
{
    (void)unused;
    struct wb_jobs_options options = slurm;
    options.dry_run = true;
    const struct wb_jobs_outcome outcome = jobs_fixture_run(five, 3, &options, WB_OK);
    jobs_fixture_expect(&outcome, 0, 0, 0, 3);
    assert_false(jobs_fixture_is_there("fake/sbatch.said"));
    assert_non_null(strstr(jobs_fixture_said, "3 runs not submitted; to submit:\n    sbatch "));
    assert_int_equal(jobs_fixture_count(jobs_fixture_text("logs/slurm-1/jobs.txt"), "\n"), 3);
    /* The printed command submits it. */
    const char *const said = strstr(jobs_fixture_said, "    sbatch ");
    char command[4096];
    assert_non_null(said);
    snprintf(command, sizeof command, "%.*s >/dev/null", (int)strcspn(said, "\n"), said);
    assert_int_equal(system(command), 0);
    assert_true(jobs_fixture_is_there("a/dataset.json"));
    assert_false(jobs_fixture_is_there("b"));
    assert_true(jobs_fixture_is_there("c/dataset.json"));
}

static void large_lists_become_several_arrays(void **unused)
{
    (void)unused;
    struct jobs_fixture_run runs[5];
    static const char *const names[] = {"a", "b", "c", "d", "e"};
    for (int i = 0; i < 5; i++)
        runs[i] = (struct jobs_fixture_run){.name = names[i], .words = {"make", names[i]}};
    jobs_fixture_write("fake/largest", "3");
    const struct wb_jobs_outcome outcome = jobs_fixture_run(runs, 5, &slurm, WB_OK);
    jobs_fixture_expect(&outcome, 0, 5, 0, 0);
    assert_string_equal(jobs_fixture_text("e/dataset.json"), "e");
    assert_int_equal(jobs_fixture_count(jobs_fixture_text("fake/sbatch.said"), "--array\n1-2\n"),
                     2);
    assert_int_equal(jobs_fixture_count(jobs_fixture_text("fake/sbatch.said"), "--array\n1-1\n"),
                     1);
    assert_string_equal(jobs_fixture_text("b/dataset.json"), "b");
    assert_string_equal(jobs_fixture_text("d/dataset.json"), "d");
}

static void outdated_output_is_replaced_by_a_task(void **unused)
{
    (void)unused;
    jobs_fixture_replace(&slurm);
}

static void a_missing_sbatch_is_reported(void **unused)
{
    (void)unused;
    setenv("PATH", "/nowhere", 1);
    jobs_fixture_run(five, 2, &slurm, WB_ERR_NOT_FOUND);
    setenv("PATH", old_path, 1);
    assert_non_null(strstr(jobs_fixture_said, "no sbatch in PATH"));
    assert_non_null(strstr(jobs_fixture_said, "--solve"));
    assert_int_equal(jobs_fixture_count(jobs_fixture_said, "\n"), 1);
}

static void a_rejected_submission_is_reported_with_the_reason(void **unused)
{
    (void)unused;
    jobs_fixture_write("fake/refuse", "");
    jobs_fixture_run(five, 2, &slurm, WB_ERR_IO);
    assert_non_null(strstr(jobs_fixture_said, "sbatch rejected the array (exit code 1): sbatch: "
                                              "error: invalid partition: nowhere\n"));
    assert_false(jobs_fixture_is_there("logs/a.slurm"));
}

static void a_queue_without_answer_is_asked_again(void **unused)
{
    (void)unused;
    jobs_fixture_write("fake/mute", "1\n2\n3\n");
    const struct wb_jobs_outcome outcome = jobs_fixture_run(&five[1], 1, &slurm, WB_OK);
    jobs_fixture_expect(&outcome, 0, 0, 1, 0);
    assert_int_equal(jobs_fixture_count(jobs_fixture_said, "Slurm does not answer, still waiting"),
                     1);
    assert_int_equal(jobs_fixture_count(jobs_fixture_said, "Slurm answers again"), 1);
    assert_string_equal(jobs_fixture_text("fake/mute"), "");
}

/* Interrupts the wait after the tasks were submitted. */
static void interrupt_a_call(const struct jobs_fixture_run *runs, int n)
{
    char last[32];
    snprintf(last, sizeof last, "logs/%s.slurm", runs[n - 1].name);
    wb_interrupt_install();
    const pid_t parent = getpid(), helper = fork();
    if (helper == 0) {
        for (int i = 0; i < 1000 && !jobs_fixture_is_there(last); i++)
            usleep(10000);
        kill(parent, SIGTERM);
        _exit(0);
    }
    const struct wb_jobs_outcome outcome = jobs_fixture_run(runs, n, &slurm, WB_OK);
    waitpid(helper, NULL, 0);
    wb_interrupt_set(false);
    assert_true(outcome.interrupted);
    assert_int_equal(outcome.left, n);
    assert_non_null(strstr(jobs_fixture_said, "`scancel 12`"));
}

static void the_next_call_waits_for_tasks_of_an_interrupted_call(void **unused)
{
    (void)unused;
    jobs_fixture_write("fake/hold", "");
    interrupt_a_call(five, 3);
    /* Meanwhile two of three end, one of them successfully. */
    char queue[1024];
    snprintf(queue, sizeof queue,
             "12_1|COMPLETED|None|%s/logs/slurm-1/array.sh\n"
             "12_2|RUNNING|None|%s/logs/slurm-1/array.sh\n"
             "12_3|TIMEOUT|TimeLimit|%s/logs/slurm-1/array.sh\n",
             jobs_fixture_folder, jobs_fixture_folder, jobs_fixture_folder);
    jobs_fixture_write("fake/queue.12", queue);
    assert_int_equal(mkdir("a", 0777), 0);
    jobs_fixture_write("a/dataset.json", "by Slurm");

    /* A local run does not touch the one that runs in Slurm. */
    const struct wb_jobs_options local = {.where = WB_JOBS_LOCAL};
    struct jobs_fixture_run runs[3];
    memcpy(runs, five, sizeof runs);
    struct wb_jobs_outcome outcome = jobs_fixture_run(runs, 2, &local, WB_OK);
    jobs_fixture_expect(&outcome, 1, 0, 0, 1);
    assert_non_null(strstr(jobs_fixture_said, "1 run is still in Slurm's queue"));

    /* The failed one is submitted again, the other one ends in the queue. */
    unlink("fake/hold");
    snprintf(queue, sizeof queue,
             "(sleep 0.5; mkdir b; echo x >b/dataset.json; sed -i s/RUNNING/COMPLETED/ "
             "fake/queue.12) &");
    assert_int_equal(system(queue), 0);
    outcome = jobs_fixture_run(runs, 3, &slurm, WB_OK);
    jobs_fixture_expect(&outcome, 1, 2, 0, 0);
    assert_int_equal(jobs_fixture_count(jobs_fixture_text("fake/sbatch.count"), "\n"), 2);
    assert_non_null(strstr(jobs_fixture_text("fake/sbatch.said"), "--array\n1-1\n"));
    assert_false(jobs_fixture_is_there("logs/a.slurm"));
}

static void tasks_missing_in_the_queue_are_judged_by_their_outputs(void **unused)
{
    (void)unused;
    jobs_fixture_write("fake/hold", "");
    interrupt_a_call(five, 2);
    /* Between two looks one is made, and then Slurm lists neither. */
    assert_int_equal(system("(sleep 0.4; mkdir a; echo x >a/dataset.json; rm fake/queue.12) &"), 0);
    jobs_fixture_write("fake/accounting", "CANCELLED by 1000\n");
    const struct wb_jobs_outcome outcome = jobs_fixture_run(five, 2, &slurm, WB_OK);
    jobs_fixture_expect(&outcome, 0, 1, 1, 0);
    assert_non_null(strstr(jobs_fixture_said, "run 'b' failed: Slurm's task 12_2 is CANCELLED"));
}

static void a_reused_job_number_is_recognised(void **unused)
{
    (void)unused;
    jobs_fixture_write("fake/hold", "");
    interrupt_a_call(five, 1);
    unlink("fake/hold");
    jobs_fixture_write("fake/queue.12", "12_1|RUNNING|None|/home/other/array.sh\n");
    const struct wb_jobs_outcome outcome = jobs_fixture_run(five, 1, &slurm, WB_OK);
    jobs_fixture_expect(&outcome, 0, 1, 0, 0);
    assert_int_equal(jobs_fixture_count(jobs_fixture_text("fake/sbatch.count"), "\n"), 2);
}

static void arrays_of_two_clusters_may_have_one_number(void **unused)
{
    (void)unused;
    struct jobs_fixture_run runs[4] = {five[0], five[2], five[3], five[1]};
    jobs_fixture_write("fake/largest", "3");
    jobs_fixture_write("fake/clusters", "east\nwest\n");
    /* The array of the east ends long after that of the west. */
    jobs_fixture_write("fake/holdeast", "");
    assert_int_equal(system("(sleep 1; mkdir a; echo x >a/dataset.json; "
                            "sed -i 's/_2|PENDING/_2|TIMEOUT/' fake/queue.12east) &"),
                     0);
    const struct wb_jobs_outcome outcome = jobs_fixture_run(runs, 4, &slurm, WB_OK);
    jobs_fixture_expect(&outcome, 0, 2, 2, 0);
    assert_non_null(strstr(jobs_fixture_said, "run 'b' failed: Slurm's task 12_2 is FAILED"));
    assert_non_null(strstr(jobs_fixture_said, "run 'c' failed: Slurm's task 12_2 is TIMEOUT"));
}

/* The second array is known from the accounting database only. */
static void the_state_of_an_earlier_task_is_not_reported_for_the_next(void **unused)
{
    (void)unused;
    char queue[256];
    jobs_fixture_write("fake/hold", "");
    interrupt_a_call(&five[1], 1);
    unlink("fake/hold");
    snprintf(queue, sizeof queue, "12_1|TIMEOUT|TimeLimit|%s/logs/slurm-1/array.sh\n",
             jobs_fixture_folder);
    jobs_fixture_write("fake/queue.12", queue);
    jobs_fixture_write("fake/forget", "");
    jobs_fixture_write("fake/accounting", "OUT_OF_MEMORY\n");
    const struct wb_jobs_outcome outcome = jobs_fixture_run(&five[1], 1, &slurm, WB_OK);
    jobs_fixture_expect(&outcome, 0, 0, 1, 0);
    assert_non_null(strstr(jobs_fixture_said, "Slurm's task 13_1 is OUT_OF_MEMORY"));
}

static void a_reason_that_may_last_forever_is_reported_once(void **unused)
{
    (void)unused;
    jobs_fixture_write("fake/hold", "");
    assert_int_equal(system("(for i in 1 2 3 4 5 6 7 8 9 10; do sleep 0.1; "
                            "[ ! -e fake/queue.12 ] || break; done; "
                            "sed -i s/None/PartitionTimeLimit/ fake/queue.12; sleep 1; "
                            "sed -i s/PENDING/CANCELLED/ fake/queue.12) &"),
                     0);
    const struct wb_jobs_outcome outcome = jobs_fixture_run(five, 1, &slurm, WB_OK);
    jobs_fixture_expect(&outcome, 0, 0, 1, 0);
    assert_int_equal(
        jobs_fixture_count(jobs_fixture_said, "tasks wait in Slurm's queue: PartitionTimeLimit"),
        1);
}

static void unknown_state_of_earlier_runs_is_an_error(void **unused)
{
    (void)unused;
    const struct wb_jobs_options local = {.where = WB_JOBS_LOCAL};
    jobs_fixture_write("fake/hold", "");
    interrupt_a_call(five, 1);
    jobs_fixture_write("fake/mute", "1\n2\n");
    jobs_fixture_run(five, 1, &slurm, WB_ERR_BUSY);
    jobs_fixture_run(five, 1, &local, WB_ERR_BUSY);
    assert_non_null(strstr(jobs_fixture_said, "Unable to contact slurm controller"));
    assert_non_null(strstr(jobs_fixture_said, "/logs/*.slurm'"));
    assert_false(jobs_fixture_is_there("a"));
}

int main(int argc, char **argv)
{
    if (argc > 1 && strcmp(argv[1], "worker") == 0)
        return jobs_fixture_worker(argc, argv);
    alarm(50); /* a signal that only sets a flag does not end a test that hangs */
#define WITH_SLURM(fact) cmocka_unit_test_setup_teardown(fact, make_slurm, remove_slurm)
    const struct CMUnitTest tests[] = {
        WITH_SLURM(only_what_is_missing_is_submitted),
        WITH_SLURM(options_are_passed_on),
        WITH_SLURM(dry_run_writes_and_submits_nothing),
        WITH_SLURM(large_lists_become_several_arrays),
        WITH_SLURM(outdated_output_is_replaced_by_a_task),
        WITH_SLURM(a_missing_sbatch_is_reported),
        WITH_SLURM(a_rejected_submission_is_reported_with_the_reason),
        WITH_SLURM(a_queue_without_answer_is_asked_again),
        WITH_SLURM(the_next_call_waits_for_tasks_of_an_interrupted_call),
        WITH_SLURM(tasks_missing_in_the_queue_are_judged_by_their_outputs),
        WITH_SLURM(a_reused_job_number_is_recognised),
        WITH_SLURM(arrays_of_two_clusters_may_have_one_number),
        WITH_SLURM(the_state_of_an_earlier_task_is_not_reported_for_the_next),
        WITH_SLURM(a_reason_that_may_last_forever_is_reported_once),
        WITH_SLURM(unknown_state_of_earlier_runs_is_an_error),
    };
    return cmocka_run_group_tests_name("jobs_array", tests, NULL, NULL);
}
