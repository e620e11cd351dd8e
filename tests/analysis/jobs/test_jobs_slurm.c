/* Runs in a real Slurm of one node, which this test starts for itself: own munged with an own key,
 * slurmctld and slurmd, on free ports, with all their files in a temporary folder. It needs root
 * (slurmd does) and the programs; without them it is skipped and says why. Everything is ended at
 * its end, also when it fails. */
#include <arpa/inet.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file.h"
#include "base/interrupt_private.h"
#include "base/timing.h"
#include "base/units.h"
#include "tests/analysis/jobs/jobs_fixture.h"
#include "tests/check.h"

enum {
    SKIPPED = 77, /* meson's code */
    NOT_POSSIBLE = 78,
    TEST_S = 170, /* all of it */
    START_S = 40, /* until the node is ready */
    DAEMONS = 3
};

static char cluster[64];        /* folder of the daemons */
static pid_t daemons[DAEMONS];  /* munged, slurmctld, slurmd */
static char wirebench[WB_PATH]; /* the tool */

/* --- the cluster --- */

static const char *missing_program(void)
{
    static const char *const names[] = {"munged", "slurmctld", "slurmd", "sbatch",
                                        "squeue", "scancel",   "sinfo",  "scontrol"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        char command[64];
        snprintf(command, sizeof command, "command -v %s >/dev/null", names[i]);
        if (system(command) != 0)
            return names[i];
    }
    return NULL;
}

static int free_port(void)
{
    struct sockaddr_in address = {.sin_family = AF_INET};
    socklen_t size = sizeof address;
    const int s = socket(AF_INET, SOCK_STREAM, 0);
    if (s < 0 || bind(s, (struct sockaddr *)&address, size) != 0 ||
        getsockname(s, (struct sockaddr *)&address, &size) != 0)
        return -1;
    close(s);
    return ntohs(address.sin_port);
}

static void path_in_cluster(char path[WB_PATH], const char *name)
{
    snprintf(path, WB_PATH, "%s/%s", cluster, name);
}

static int write_key(void)
{
    char path[WB_PATH], key[128];
    path_in_cluster(path, "munge/key");
    const int file = open(path, O_WRONLY | O_CREAT | O_EXCL, 0400);
    if (file < 0 || getrandom(key, sizeof key, 0) != (ssize_t)sizeof key ||
        write(file, key, sizeof key) != (ssize_t)sizeof key)
        return -1;
    return close(file);
}

static int write_settings(void)
{
    char path[WB_PATH], host[64] = "";
    const int ports[] = {free_port(), free_port()};
    if (gethostname(host, sizeof host - 1) != 0 || ports[0] < 0 || ports[1] < 0)
        return -1;
    host[strcspn(host, ".")] = '\0';
    path_in_cluster(path, "slurm.conf");
    FILE *file = fopen(path, "w");
    if (!file)
        return -1;
    fprintf(file,
            "ClusterName=wirebench\nSlurmctldHost=%s(127.0.0.1)\nSlurmUser=root\nSlurmdUser=root\n"
            "SlurmctldPort=%d\nSlurmdPort=%d\n"
            "AuthType=auth/munge\nAuthInfo=socket=%s/munge/socket\nCredType=cred/munge\n"
            "StateSaveLocation=%s/state\nSlurmdSpoolDir=%s/spool\n"
            "SlurmctldPidFile=%s/slurmctld.pid\nSlurmdPidFile=%s/slurmd.pid\n"
            "SlurmctldLogFile=%s/slurmctld.log\nSlurmdLogFile=%s/slurmd.log\n"
            "ProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\nSwitchType=switch/none\n"
            "JobAcctGatherType=jobacct_gather/none\nMpiDefault=none\nMailProg=/bin/true\n"
            "AccountingStorageType=accounting_storage/none\n"
            "SelectType=select/cons_tres\nSelectTypeParameters=CR_Core\n"
            "SchedulerParameters=batch_sched_delay=0,sched_interval=1,bf_interval=1\n"
            "KillWait=2\nReturnToService=2\n"
            /* Two cores whatever the machine has. */
            "SlurmdParameters=config_overrides\n"
            "NodeName=%s NodeAddr=127.0.0.1 CPUs=2 RealMemory=1000 State=UNKNOWN\n"
            "PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP\n",
            host, ports[0], ports[1], cluster, cluster, cluster, cluster, cluster, cluster, cluster,
            host);
    if (fclose(file) != 0)
        return -1;
    path_in_cluster(path, "cgroup.conf");
    file = fopen(path, "w");
    if (!file)
        return -1;
    /* Nothing is put into a cgroup; the plugin is loaded all the same. */
    fprintf(file, "CgroupPlugin=cgroup/%s\nCgroupAutomount=no\nIgnoreSystemd=yes\n",
            wb_file_exists("/sys/fs/cgroup/cgroup.controllers") ? "v2" : "v1");
    return fclose(file);
}

/* A child that does not outlive this process. */
static pid_t start(const char *log, const char *const *words)
{
    char path[WB_PATH];
    path_in_cluster(path, log);
    const pid_t parent = getpid(), child = fork();
    if (child != 0)
        return child;
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    const int out = open(path, O_WRONLY | O_CREAT | O_APPEND, 0666);
    if (getppid() == parent && out >= 0 && dup2(out, 1) >= 0 && dup2(out, 2) >= 0)
        execvp(words[0], (char *const *)words);
    _exit(127);
}

static void start_daemons(void)
{
    char options[5][WB_PATH];
    snprintf(options[0], WB_PATH, "--socket=%s/munge/socket", cluster);
    snprintf(options[1], WB_PATH, "--key-file=%s/munge/key", cluster);
    snprintf(options[2], WB_PATH, "--pid-file=%s/munge/pid", cluster);
    snprintf(options[3], WB_PATH, "--log-file=%s/munge/log", cluster);
    snprintf(options[4], WB_PATH, "--seed-file=%s/munge/seed", cluster);
    const char *const munged[] = {"munged",   "--foreground", "--force",  options[0], options[1],
                                  options[2], options[3],     options[4], NULL};
    static const char *const slurmctld[] = {"slurmctld", "-D", "-c", "-i", NULL};
    static const char *const slurmd[] = {"slurmd", "-D", NULL};
    char socket_path[WB_PATH];
    path_in_cluster(socket_path, "munge/socket");
    daemons[0] = start("munged.out", munged);
    for (int i = 0; i < 100 && !wb_file_exists(socket_path); i++)
        usleep(100000);
    daemons[1] = start("slurmctld.out", slurmctld);
    daemons[2] = start("slurmd.out", slurmd);
}

static void print_end(const char *name)
{
    char command[WB_PATH + 32];
    snprintf(command, sizeof command, "tail -n 15 %s/%s", cluster, name);
    printf("%s:\n", name);
    fflush(stdout);
    if (system(command) != 0)
        printf("(none)\n");
}

/* SIGKILL to every child of this process; how many there are. Orphans of the daemons' are given to
 * it (it is a subreaper). */
static int kill_children(void)
{
    DIR *const listing = opendir("/proc");
    int n = 0;
    for (const struct dirent *entry; listing && (entry = readdir(listing));) {
        char path[300], line[512] = "";
        const char *after;
        int parent = 0;
        snprintf(path, sizeof path, "/proc/%s/stat", entry->d_name);
        FILE *const file = atol(entry->d_name) > 0 ? fopen(path, "r") : NULL;
        if (!file)
            continue;
        if (fgets(line, sizeof line, file) && (after = strrchr(line, ')')) &&
            sscanf(after + 1, " %*c %d", &parent) == 1 && parent == getpid()) {
            kill((pid_t)atol(entry->d_name), SIGKILL);
            n++;
        }
        fclose(file);
    }
    if (listing)
        closedir(listing);
    return n;
}

static int stop_cluster(void **state)
{
    (void)state;
    for (int i = DAEMONS - 1; i >= 0; i--) {
        if (daemons[i] <= 0)
            continue;
        kill(daemons[i], SIGTERM);
        for (int k = 0; k < 50 && waitpid(daemons[i], NULL, WNOHANG) == 0; k++)
            usleep(100000);
        daemons[i] = 0;
    }
    int left;
    for (int k = 0; k < 50 && (left = kill_children()) > 0; k++) {
        while (waitpid(-1, NULL, WNOHANG) > 0)
            ;
        usleep(100000);
    }
    char command[128];
    snprintf(command, sizeof command, "rm -r '%s'", cluster);
    return system(command) == 0 && left == 0 ? 0 : -1;
}

/* Waits for a shell command to succeed. */
static bool comes_true(const char *command, int seconds)
{
    const int64_t until_ns = wb_time_now_ns() + seconds * WB_NS_PER_S;
    while (system(command) != 0) {
        if (wb_time_now_ns() > until_ns)
            return false;
        usleep(200000);
    }
    return true;
}

static int start_cluster(void **state)
{
    static const char *const folders[] = {"munge", "state", "spool"};
    char path[WB_PATH];
    strcpy(cluster, "/tmp/wirebench-slurm-XXXXXX");
    if (!mkdtemp(cluster) || chmod(cluster, 0755) != 0)
        return -1;
    for (size_t i = 0; i < sizeof folders / sizeof folders[0]; i++) {
        path_in_cluster(path, folders[i]);
        if (mkdir(path, 0755) != 0)
            return -1;
    }
    path_in_cluster(path, "slurm.conf");
    setenv("SLURM_CONF", path, 1);
    if (write_key() != 0 || write_settings() != 0)
        return -1;
    start_daemons();
    if (comes_true("sinfo --noheader --format=%T 2>/dev/null | grep -qx idle", START_S))
        return 0;
    printf("Slurm did not start within %d s\n", START_S);
    print_end("munged.out");
    print_end("slurmctld.out");
    print_end("slurmd.out");
    stop_cluster(state);
    return -1;
}

/* --- what is tried in it --- */

static struct wb_jobs_options options(void)
{
    return (struct wb_jobs_options){.where = WB_JOBS_SLURM,
                                    .folder = "logs",
                                    .program = wirebench,
                                    .partition = "main",
                                    .time = "10",
                                    .memory = "100M",
                                    .poll_interval = 0.5};
}

/* Rows of a dataset's curve. */
static int rows_of(const char *folder)
{
    char path[WB_PATH];
    snprintf(path, sizeof path, "%s/force_deflection.csv", folder);
    return jobs_fixture_count(jobs_fixture_text(path), "\n") - 1;
}

#define SOLVE "solve", "cantilever", "--wire", "type1", "--length-mm", "85"
static const char *const quick_words[] = {SOLVE, "--deflection-mm", "10", "--points", "4", NULL};
static const char *const other_words[] = {SOLVE, "--deflection-mm", "20", "--points", "6", NULL};
/* Would take minutes. */
static const char *const long_words[] = {SOLVE, "--deflection-mm", "53",    "--cycles",
                                         "100", "--points",        "20000", NULL};
static const char *const bad_words[] = {
    "solve", "cantilever", "--wire", "no such", "--length-mm", "85", "--deflection-mm", "1", NULL};

static struct wb_jobs_outcome run(const struct wb_job *jobs, int n, const struct wb_jobs_options *o)
{
    struct wb_jobs_outcome outcome = {.done = -1};
    jobs_fixture_listen();
    const enum wb_status status = wb_jobs_run(&outcome, jobs, n, o);
    if (status != WB_OK)
        fail_msg("status %d; said: %s", status, jobs_fixture_said);
    return outcome;
}

static void array_makes_datasets(void **unused)
{
    (void)unused;
    const struct wb_job jobs[] = {{.name = "a", .arguments = quick_words, .output = "data/a b's"},
                                  {.name = "b", .arguments = other_words, .output = "data/b"},
                                  {.name = "c", .arguments = bad_words, .output = "data/c"},
                                  {.name = "d", .arguments = other_words, .output = "data/d"}};
    const struct wb_jobs_options o = options();
    const struct wb_jobs_outcome outcome = run(jobs, 4, &o);
    jobs_fixture_expect(&outcome, 0, 3, 1, 0);
    assert_int_equal(rows_of("data/a b's"), 5);
    assert_int_equal(rows_of("data/b"), 7);
    assert_int_equal(rows_of("data/d"), 7);
    assert_non_null(strstr(jobs_fixture_said, "run 'c' failed: Slurm's task "));
    assert_non_null(strstr(jobs_fixture_said, "_3 is FAILED"));
    assert_non_null(strstr(jobs_fixture_said, "no such"));
    assert_non_null(strstr(jobs_fixture_said, "\n    exit code 1\n"));
    assert_false(jobs_fixture_is_there("data/c"));
    assert_false(jobs_fixture_is_there("logs/a.slurm"));
}

/* A process that, once task 2 of the array runs (its unfinished folder is not needed for that),
 * does something with the number of the array in $id. */
static pid_t when_task_2_runs(const char *what)
{
    static const char wait[] = "for i in $(seq 200); do\n"
                               "  id=$(sed -n '1s/ .*//p' logs/b.slurm 2>/dev/null)\n"
                               "  [ -n \"$id\" ] && squeue -h -r -j $id -o '%i %T' 2>/dev/null |\n"
                               "    grep -qx \"${id}_2 RUNNING\" && break\n"
                               "  sleep 0.2\n"
                               "done\n";
    char command[1024];
    const pid_t child = fork();
    if (child != 0)
        return child;
    snprintf(command, sizeof command, "%s%s", wait, what);
    _exit(system(command) == 0 ? 0 : 1);
}

static void killed_task_is_named_and_made_by_the_next_call(void **unused)
{
    (void)unused;
    struct wb_job jobs[] = {{.name = "a", .arguments = quick_words, .output = "a"},
                            {.name = "b", .arguments = long_words, .output = "b"},
                            {.name = "c", .arguments = other_words, .output = "c"}};
    const struct wb_jobs_options o = options();
    const pid_t helper = when_task_2_runs("scancel ${id}_2");
    struct wb_jobs_outcome outcome = run(jobs, 3, &o);
    waitpid(helper, NULL, 0);
    jobs_fixture_expect(&outcome, 0, 2, 1, 0);
    assert_non_null(strstr(jobs_fixture_said, "run 'b' failed: Slurm's task "));
    assert_non_null(strstr(jobs_fixture_said, "_2 is CANCELLED"));
    assert_non_null(strstr(jobs_fixture_said, "CANCELLED AT ")); /* Slurm's own words */
    assert_false(jobs_fixture_is_there("b"));
    assert_false(jobs_fixture_is_there("c.partial"));

    jobs[1].arguments = quick_words;
    outcome = run(jobs, 3, &o);
    jobs_fixture_expect(&outcome, 2, 1, 0, 0);
    assert_int_equal(rows_of("b"), 5);
    assert_false(jobs_fixture_is_there("b.partial"));
    outcome = run(jobs, 3, &o);
    jobs_fixture_expect(&outcome, 3, 0, 0, 0);
    assert_false(jobs_fixture_is_there("logs/slurm-3"));
}

static void interrupted_call_leaves_the_array_to_the_next(void **unused)
{
    (void)unused;
    /* The first holds its place in the queue until the second call waits. */
    const struct wb_job jobs[] = {{.name = "a", .arguments = long_words, .output = "a"},
                                  {.name = "b", .arguments = long_words, .output = "b"},
                                  {.name = "c", .arguments = other_words, .output = "c"}};
    const struct wb_jobs_options o = options();
    char what[64];
    snprintf(what, sizeof what, "kill -TERM %ld", (long)getpid());
    wb_interrupt_install();
    pid_t helper = when_task_2_runs(what);
    struct wb_jobs_outcome outcome = run(jobs, 3, &o);
    waitpid(helper, NULL, 0);
    jobs_fixture_expect(&outcome, 0, 0, 0, 3);
    assert_true(outcome.interrupted);
    assert_non_null(strstr(jobs_fixture_said, "stopped waiting; Slurm goes on with 3 of the runs"));
    wb_interrupt_set(false);

    helper = when_task_2_runs("sleep 1; scancel ${id}_1 ${id}_2");
    outcome = run(jobs, 3, &o);
    waitpid(helper, NULL, 0);
    jobs_fixture_expect(&outcome, 0, 1, 2, 0);
    assert_non_null(strstr(jobs_fixture_said, "3 runs are still with Slurm from an earlier call"));
    assert_int_equal(rows_of("c"), 7);
    assert_true(jobs_fixture_is_there("logs/slurm-1"));
    assert_false(jobs_fixture_is_there("logs/slurm-2"));
}

static void refused_array_says_slurms_reason(void **unused)
{
    (void)unused;
    const struct wb_job job = {.name = "a", .arguments = quick_words, .output = "a"};
    struct wb_jobs_options o = options();
    struct wb_jobs_outcome outcome;
    o.partition = "nowhere";
    jobs_fixture_listen();
    assert_int_equal(wb_jobs_run(&outcome, &job, 1, &o), WB_ERR_IO);
    assert_non_null(strstr(jobs_fixture_said, "sbatch refused the array"));
    assert_non_null(strstr(jobs_fixture_said, "artition"));
    assert_false(jobs_fixture_is_there("a"));
}

/* One wire stands in for a bundle: it is solved in a second. */
static const char small_bundle[] =
    "name: one\n"
    "title: One wire\n"
    "wires: [{wire: type3, count: 1}]\n"
    "packing: hexagon\n"
    "length_mm: 85\n"
    "interface: {cohesive_stiffness_N_mm3: 30, friction: 0.4}\n"
    "meshes: [{name: coarse, core_quads: 2, rings: 1, elements_along: 20, formulation: 2x2x1}]\n"
    "run: {mesh: coarse, deflection_mm: 10, rows: 20, mass_scaling: 25, "
    "selective_mass_scaling: 10}\n"
    "loads: {strand_mm: 760, weight: true}\n"
    "published: {outer_diameter_mm: 1.4, density_g_cm3: 4.97, beam: type3}\n";
static const char small_campaign[] =
    "kind: bundles\n"
    "title: One wire\n"
    "simulations: sim\n"
    "defaults: {dead_force: true, weight: false, duration_s: 1.5}\n"
    "runs:\n"
    "  - {name: one, bundle: ./one.yaml}\n"
    "  - {name: one-0.2, bundle: ./one.yaml, friction: 0.2}\n"
    "groups:\n"
    "  - label: A wire\n"
    "    bundles: [{label: one wire, dynamic: one, constant: one-0.2, rod: one-1d}]\n"
    "fit: {elements: 10, fibres: 12}\n";

/* `wirebench report c.yaml -o r OPTIONS`; its exit code. */
static int report(const char *extra)
{
    char command[2 * WB_PATH];
    snprintf(command, sizeof command, "%s report c.yaml -o r --slurm %s >out 2>err", wirebench,
             extra);
    const int status = system(command);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static void report_of_a_campaign_resumes_what_is_missing(void **unused)
{
    (void)unused;
    jobs_fixture_write("one.yaml", small_bundle);
    jobs_fixture_write("c.yaml", small_campaign);
    /* Held until one of the tasks is killed. */
    assert_int_equal(
        system("(for i in $(seq 200); do\n"
               "  id=$(sed -n '1s/ .*//p' r.jobs/one-0.2.slurm)\n"
               "  [ -n \"$id\" ] && break; sleep 0.2; done; scancel ${id}_2; scontrol release $id)"
               " >/dev/null 2>&1 &"),
        0);
    const int code = report("--slurm-partition=main --slurm-time=10 --slurm-option=--hold");
    if (code != 3)
        fail_msg("exit code %d: %s", code, jobs_fixture_text("err"));
    /* Of a task that had not begun Slurm keeps nothing. */
    if (!strstr(jobs_fixture_text("err"), "_2 is gone and left no output"))
        fail_msg("no task was cancelled: %s", jobs_fixture_text("err"));
    assert_non_null(strstr(jobs_fixture_text("err"), "tasks wait in Slurm's queue: JobHeld"));
    assert_non_null(strstr(jobs_fixture_text("out"), "2 of 3 datasets used"));
    assert_true(jobs_fixture_is_there("r/report.pdf"));

    assert_int_equal(report("--force --slurm-partition=main"), 0);
    assert_non_null(strstr(jobs_fixture_text("out"), "3 of 3 datasets used"));
    /* Slurm opened a file for one task only. */
    assert_int_equal(system("[ $(ls r.jobs/slurm-2/*.out | wc -l) -eq 1 ]"), 0);
    assert_int_equal(report("--force"), 0);
    assert_false(jobs_fixture_is_there("r.jobs/slurm-3"));
}

static int run_facts(void)
{
    /* Orphans of the daemons come to us, who end them. */
    prctl(PR_SET_CHILD_SUBREAPER, 1);
#define WITH_FOLDER(fact)                                                                          \
    cmocka_unit_test_setup_teardown(fact, jobs_fixture_make_folder, jobs_fixture_remove_folder)
    const struct CMUnitTest tests[] = {
        WITH_FOLDER(array_makes_datasets),
        WITH_FOLDER(killed_task_is_named_and_made_by_the_next_call),
        WITH_FOLDER(interrupted_call_leaves_the_array_to_the_next),
        WITH_FOLDER(refused_array_says_slurms_reason),
        WITH_FOLDER(report_of_a_campaign_resumes_what_is_missing),
    };
    return cmocka_run_group_tests_name("jobs_slurm", tests, start_cluster, stop_cluster);
}

static int exit_code(pid_t child)
{
    int status = 0;
    if (child < 0 || waitpid(child, &status, 0) != child)
        return 1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

/* Runs the tests as the first process of a PID namespace, with which the kernel ends all others of
 * it, tasks that Slurm started as well, however this one ends. */
static int run_in_namespace(void)
{
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (unshare(CLONE_NEWPID | CLONE_NEWNS) != 0)
        return NOT_POSSIBLE;
    const pid_t first = fork();
    if (first != 0)
        return exit_code(first);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (mount(NULL, "/", NULL, MS_REC | MS_PRIVATE, NULL) != 0 ||
        mount("proc", "/proc", "proc", 0, NULL) != 0)
        return NOT_POSSIBLE;
    return run_facts();
}

/* Where namespaces are not allowed, the tests run without. */
static int in_own_processes(void)
{
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0)
        exit(run_in_namespace());
    const int code = exit_code(child);
    return code == NOT_POSSIBLE ? run_facts() : code;
}

static int skip_because(const char *reason, const char *what)
{
    printf("skipped: %s%s\n", reason, what);
    return SKIPPED;
}

int main(void)
{
    /* Where Debian has the daemons. */
    char path[WB_PATH];
    snprintf(path, sizeof path, "%s:/usr/sbin:/sbin", getenv("PATH") ? getenv("PATH") : "");
    setenv("PATH", path, 1);
    if (geteuid() != 0)
        return skip_because("slurmd needs root", "");
    const char *const missing = missing_program();
    if (missing)
        return skip_because("there is no ", missing);
    const char *const binary = getenv("WIREBENCH_BINARY");
    if (!binary || !realpath(binary, wirebench)) {
        printf("WIREBENCH_BINARY is not set: run this test through meson\n");
        return 1;
    }
    alarm(TEST_S);
    return in_own_processes();
}
