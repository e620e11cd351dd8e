/* `wirebench record` and `stage` as a user meets them, on a virtual bench in virtual time: a whole
 * test, and everything that goes wrong, each with its messages, its exit code and a recording that
 * can be read. */
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>

#include "daq/recording/recording.h"
#include "daq/stream/stream.h"
#include "fixtures/virtual/sim_port.h"
#include "tests/cli/bench_tool.h"
#include "tests/trials.h"

static const struct wb_bench_settings usual;
/* The way down takes long enough to stop it on its way. */
static const char *const slow[] = {"speed_mm_s: 1\n", "speed_mm_s: 0.2\n", NULL};
static const char *const tic[] = {"protocol: grbl", "protocol: tic", "axis: X", "steps_per_mm: 400",
                                  NULL};

static void whole_test_is_recorded(void **state)
{
    (void)state;
    open_bench(NULL, usual);
    run("record rig.yaml " SPECIMEN
        "-o whole.wbr --travel-mm 10 --cycles 2 --operator 'A. Tester' --notes 'a note'");
    assert_code(0);
    assert_said("whole.wbr: virtual rig, 2 cycles, ");
    assert_said(", 0 drops\n");
    assert_said(" test  sample");
    assert_said("\nfound   type1, L = 85 mm, sample 1 (virtual rig): 2 cycles, peak force ");
    assert_said("\ntrust   yes: complete");
    assert_said("\nnext    wirebench align whole.wbr -o whole\n");
    assert_string_equal(o.err, "");
    assert_recorded("whole", "cycle_end");
    assert_non_null(strstr(content_of("exported/events.csv"), "first_force"));
    run("info whole.wbr");
    assert_code(0);
    assert_said("$1=255 $10=1");
    assert_said("A. Tester");
    assert_said("a note");
    run("record rig.yaml " SPECIMEN "-o whole.wbr --travel-mm 10");
    assert_code(1);
    assert_said("never overwritten");
}

static void ctrl_c_stops_the_stage_and_a_release_frees_the_specimen(void **state)
{
    char release[256];
    (void)state;
    open_bench(slow, usual);
    plan(5.0, interrupt, false);
    run("record rig.yaml " SPECIMEN "-o stopped.wbr");
    assert_code(3);
    assert_said("stopped by the operator");
    advised(release);
    assert_memory_equal(release, "stage rig.yaml release ", 23);
    assert_non_null(strstr(release, "--zero-mn="));
    assert_recorded("stopped", "interrupted");
    /* The stage stands on hold: a test is refused, a release frees it. */
    run("record rig.yaml " SPECIMEN "-o refused.wbr --travel-mm 5");
    assert_code(1);
    assert_said("stage rig.yaml release'");
    /* Without the cell's zero the messages do not say that the specimen is free. */
    run("stage rig.yaml release");
    assert_code(3);
    assert_said("check the strand");
    assert_string_equal(o.out, "");
    run(release);
    assert_code(0);
    assert_said("the specimen is free");
    run("stage rig.yaml jog 0.5");
    assert_code(0);
    run("record rig.yaml " SPECIMEN "-o again.wbr --travel-mm 5");
    assert_code(0);
    assert_said("virtual rig, 1 cycle,");
}

/* An instrument that is there and says nothing. */
static void hear_nothing(void *context, int64_t now_ns, const void *bytes, size_t n)
{
    (void)context, (void)now_ns, (void)bytes, (void)n;
}

static const struct wb_sim_port_handler silent = {.receive = hear_nothing};
static const char *const silent_mocap[] = {"sim:mocap", "sim:silent", NULL};

static void ctrl_c_before_all_instruments_answered_leaves_no_recording(void **state)
{
    struct wb_sim_port *port;
    (void)state;
    open_bench(NULL, usual);
    assert_int_equal(wb_sim_port_create(&port, "silent", &silent), WB_OK);
    copy_edited("rig.yaml", "rig.yaml", silent_mocap);
    plan(0.0, interrupt, false);
    run("record rig.yaml " SPECIMEN "-o early.wbr");
    wb_sim_port_destroy(port);
    assert_code(1);
    assert_said("nothing was recorded");
    assert_false(wb_file_exists("early.wbr"));
}

/* A cell that is wired the other way round, and one whose scale is off by ten: the test ends in its
 * first millimetres. A scale of ten times too much is refused as noise. */
static void wrong_first_force_stops_the_test(void **state)
{
    static const struct {
        const char *edits[3], *said;
    } cases[] = {
        {{"sign: +1", "sign: -1"}, "reverse load_cell.sign"},
        {{"  sign: +1", "  scale: 0.1"}, "load_cell.scale"},
    };
    (void)state;
    for (size_t i = 0; i < WB_COUNT(cases); i++) {
        open_bench(NULL, usual);
        copy_edited("rig.yaml", "rig.yaml", cases[i].edits);
        run("record rig.yaml " SPECIMEN "-o force.wbr");
        assert_code(3);
        assert_said(cases[i].said);
        assert_said("the stage stopped at ");
        assert_recorded("force", cases[i].said);
        close_bench(NULL);
    }
}

/* The host's date, which jumps by up to 28 hours, forward and back, a hundred times a second. */
static unsigned long jumps;

static void jump(void)
{
    jumps++;
    wb_virtual_time_set_date(BENCH_DATE + (int64_t)(jumps * 2654435761UL % 200000) - 100000);
}

static void wall_clock_that_jumps_moves_no_stamp(void **state)
{
    static const char *const names[] = {"steady", "jumpy"};
    char command[256];
    (void)state;
    for (int i = 0; i < 2; i++) {
        open_bench(NULL, usual);
        if (i == 1)
            plan(-1.0, jump, true);
        snprintf(command, sizeof command,
                 "record rig.yaml " SPECIMEN "-o %s.wbr --travel-mm 10 --cycles 2", names[i]);
        run(command);
        assert_code(0);
        assert_string_equal(o.err, "");
        close_virtual_time();
        assert_recorded(names[i], "cycle_end");
        /* The first line names the recording. */
        snprintf(command, sizeof command,
                 "for f in load mocap stage; do tail -n +2 exported/$f.csv; done >%s", names[i]);
        assert_int_equal(system(command), 0);
    }
    assert_int_equal(system("cmp steady jumpy"), 0);
    assert_true(jumps > 1000);
    run("verify jumpy.wbr");
    assert_code(0);
    run("align jumpy.wbr -o dataset");
    assert_code(0);
    assert_said("largest deflection");
    count_trials("The wall clock jumps while a test is recorded", jumps,
                 "jumps of up to 28 hours: the recording is whole, no stamp moves");
}

static void force_limit_stops_the_test(void **state)
{
    static const char *const low[] = {"force_mN: 275", "force_mN: 45", NULL};
    (void)state;
    open_bench(low, usual);
    run("record rig.yaml " SPECIMEN "-o limit.wbr");
    assert_code(3);
    assert_said("beyond the force limit of 45.0 mN");
    assert_recorded("limit", "force limit");
}

/* The power of the whole bench fails. */
static void unplug_all(void)
{
    bench->transport->unplug(bench, WB_ROLE_LOAD);
    bench->transport->unplug(bench, WB_ROLE_STAGE);
    bench->has_mocap = false;
}

static void bench_that_is_gone_cannot_confirm_the_stop(void **state)
{
    (void)state;
    open_bench(slow, usual);
    plan(3.0, unplug_all, false);
    run("record rig.yaml " SPECIMEN "-o gone.wbr");
    assert_code(3);
    assert_said("switch off its power");
    assert_recorded("gone", "stream_lost");
}

static void tic_records_a_whole_test(void **state)
{
    (void)state;
    open_bench(tic, usual);
    run("record rig.yaml " SPECIMEN "-o tic.wbr --travel-mm 10");
    assert_code(0);
    assert_recorded("tic", "command timeout 1000 ms");
}

/* The newest NatNet there is, and a take of the server's own. */
static void newest_natnet_streams_an_older_version_and_records_a_take(void **state)
{
    static const char *const take[] = {"protocol: natnet", "protocol: natnet\n  record_take: true",
                                       NULL};
    (void)state;
    open_bench(take, (struct wb_bench_settings){.natnet = {4, 4}});
    run("record rig.yaml " SPECIMEN "-o take.wbr --travel-mm 10");
    assert_code(0);
    assert_recorded("take", "NatNet 4.4");
    assert_non_null(strstr(content_of("exported/events.csv"), "agrees to stream NatNet 4.1"));
    assert_non_null(strstr(content_of("exported/events.csv"), "the server records its own take"));
}

static void press_stop_keys(void)
{
    raise(SIGTSTP);
    raise(SIGTTOU);
    raise(SIGTTIN);
    write_file("pressed", "");
    raise(SIGQUIT);
}

/* Ctrl-Z must not halt the process that watches a moving stage; Ctrl-\ is a Ctrl-C. In a process of
 * its own with a group of its own: the signals of keys would halt it otherwise. */
static void ctrl_z_is_ignored_and_ctrl_backslash_stops(void **state)
{
    int status;
    (void)state;
    fflush(NULL);
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        setpgid(0, 0);
        open_bench(slow, usual);
        plan(3.0, press_stop_keys, false);
        run("record rig.yaml " SPECIMEN "-o keys.wbr");
        _exit(o.code);
    }
    assert_int_equal(waitpid(child, &status, WUNTRACED), child);
    if (WIFSTOPPED(status))
        kill(child, SIGKILL);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 3);
    assert_true(wb_file_exists("pressed"));
    assert_non_null(strstr(content_of("err"), "stopped by the operator"));
    assert_recorded("keys", "interrupted");
}

/* Ctrl-C once the tool waits for room on the disk. */
static void give_up(void)
{
    if (strstr(content_of("err"), "press Ctrl-C to discard them"))
        interrupt();
}

/* No file grows beyond 1 MiB: the disk is full before the test's end, which goes on in memory. */
static void a_full_disk_keeps_the_data_written_before(void **state)
{
    struct rlimit before, full;
    (void)state;
    open_bench(NULL, usual);
    plan(0.0, give_up, true);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    full = (struct rlimit){.rlim_cur = 1 << 20, .rlim_max = before.rlim_max};
    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &full), 0);
    run("record rig.yaml " SPECIMEN "-o full.wbr --travel-mm 10");
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
    assert_code(3);
    assert_said("nothing can be written to the disk");
    assert_said("kB of the recording are lost");
    run("info full.wbr");
    assert_code(3);
    assert_said("cycle_start");
}

static size_t count_lines(const char *text)
{
    size_t n = 0;
    for (; *text; text++)
        n += *text == '\n';
    return n;
}

/* One by one, on a bench that is otherwise well. */
static void bad_ports_and_files_are_rejected_with_one_message(void **state)
{
    static const struct {
        const char *edits[3], *said;
    } cases[] = {
        {{"sim:load_cell", "pty:/dev/pts/no-such"}, "/dev/pts/no-such"},
        {{"capacity_g: 20", "capacity_kg: 0.02"}, "capacity_kg"},
        {{"unit: g", "unit: furlong"}, "furlong"},
    };
    struct wb_sim_port *port;
    struct wb_stream *busy;
    FILE *file;
    (void)state;
    open_bench(NULL, usual);
    for (size_t i = 0; i < WB_COUNT(cases); i++) {
        copy_edited("rig.yaml", "bad.yaml", cases[i].edits);
        run("record bad.yaml " SPECIMEN "-o bad.wbr");
        assert_code(1);
        assert_said(cases[i].said);
        assert_int_equal(count_lines(o.err), 1);
        assert_false(wb_file_exists("bad.wbr"));
    }
    assert_int_equal(wb_sim_port_create(&port, "silent", &silent), WB_OK);
    copy_edited("rig.yaml", "bad.yaml", silent_mocap);
    run("record bad.yaml " SPECIMEN "-o bad.wbr");
    assert_code(1);
    assert_said("no NatNet reply from sim:silent");
    assert_false(wb_file_exists("bad.wbr"));
    wb_sim_port_destroy(port);

    /* A specimen's file that no editor would show whole. */
    file = fopen("binary.yaml", "w");
    assert_non_null(file);
    assert_int_equal(fwrite("wire: type1\0\n", 1, 13, file), 13);
    assert_int_equal(fclose(file), 0);
    run("record rig.yaml --specimen binary.yaml -o bad.wbr");
    assert_code(1);
    assert_said("binary.yaml' is not a text file");

    assert_int_equal(wb_stream_open(&busy, "sim:stage"), WB_OK);
    run("record rig.yaml " SPECIMEN "-o bad.wbr");
    wb_stream_close(busy);
    assert_code(1);
    assert_said("sim:stage' is in use");
    assert_false(wb_file_exists("bad.wbr"));
}

/* --- checks of the load cell --- */

/* Answers a check's questions as an operator does: each mass hangs before Enter is pressed. */
static struct {
    const double *masses; /* g */
    size_t n, answered;
    int pipe[2];
} operator;

static void answer(void)
{
    size_t asked = 0;
    for (const char *at = content_of("err"); (at = strstr(at, "press Enter")); at++)
        asked++;
    for (; operator.answered<asked && operator.answered<operator.n; operator.answered++) {
        wb_bench_hang(bench, operator.masses[operator.answered] * WB_G);
        assert_int_equal(write(operator.pipe[1], "\n", 1), 1);
    }
}

static void check(const char *arguments, const double *masses, size_t n)
{
    char input[64];
    operator.masses = masses;
    operator.n = n;
    operator.answered = 0;
    assert_int_equal(pipe(operator.pipe), 0);
    snprintf(input, sizeof input, "/dev/fd/%d", operator.pipe[0]);
    write_file("err", "");
    plan(-1.0, answer, true);
    run_with_input(input, arguments);
    deed.act = NULL;
    close(operator.pipe[0]);
    close(operator.pipe[1]);
    wb_bench_hang(bench, 0.0);
    assert_int_equal(operator.answered, n);
}

/* It is kept beside the rig file, and the next recording says so. */
static void failed_check_of_the_cell_is_recorded(void **state)
{
    static const double nothing[] = {0.0};
    (void)state;
    open_bench(NULL, usual);
    check("stage rig.yaml check 10 --seconds 0.3", nothing, 1);
    assert_code(1);
    assert_int_equal(count_lines(content_of("rig.checks.csv")), 2);
    run("record rig.yaml " SPECIMEN "-o checked.wbr --travel-mm 2");
    assert_code(0);
    assert_said("the last check of the load cell, on");
    run("info checked.wbr");
    assert_code(0);
    assert_said(" 10 g read ");
    assert_said("NOT PASSED");
    run("info --json checked.wbr");
    assert_said("\"known_mass_g\": 10");
}

static int count(const char *part)
{
    int n = 0;
    for (const char *at = o.out; (at = strstr(at, part)); at++)
        n++;
    return n;
}

static void series_of_masses_is_due_before_a_test_and_gives_a_certificate(void **state)
{
    static const char *const due[] = {
        "  sign: +1",
        "  check_masses_g: [0, 5, 10, 20, 10, 5, 0]\n  check_due_days: 30\n  sign: +1", NULL};
    static const double good[] = {5.0, 10.0, 20.0, 10.0, 5.0, 0.0},
                        bad[] = {5.0, 10.0, 19.2, 10.0, 5.0, 0.0};
    static const char *const words[] = {
        "Certificate", "virtual rig", "LC20G-0001",          "relates only to the item tested",
        "hysteresis",  "Passed",      "cannot be determined"};
    (void)state;
    open_bench(due, usual);
    run("record rig.yaml " SPECIMEN "-o test.wbr --travel-mm 2");
    assert_code(1);
    assert_said("stage rig.yaml check");
    check("stage rig.yaml check --seconds 0.3 --json -o series.pdf", good, 6);
    assert_code(0);
    assert_int_equal(count("\"known\": true"), 4);
    assert_int_equal(count("\"known_mass_g\""), 7);
    assert_int_equal(count("\"down\": true"), 3);
    const char *const last = strstr(o.out, "\"known_mass_g\": 20");
    double read;
    assert_non_null(last);
    assert_int_equal(sscanf(strstr(last, "\"read_mass_g\""), "\"read_mass_g\": %lf", &read), 1);
    assert_close(read, 20.0, 0.01);
    assert_memory_equal(content_of("series.pdf"), "%PDF-", 5);
    if (system("command -v pdftotext >/dev/null") == 0) {
        assert_int_equal(system("pdftotext -layout series.pdf - | tr -s ' \\n' ' ' >series.txt"),
                         0);
        for (size_t i = 0; i < WB_COUNT(words); i++)
            if (!strstr(content_of("series.txt"), words[i]))
                fail_msg("the certificate does not say '%s'", words[i]);
    }
    assert_int_equal(count_lines(content_of("rig.checks.csv")), 2);
    run("record rig.yaml " SPECIMEN "-o test.wbr --travel-mm 2");
    assert_code(0);
    /* A cell that reads 4 % too little at its upper end. */
    check("stage rig.yaml check --seconds 0.3 --masses 0,5,10,20,10,5,0", bad, 6);
    assert_code(1);
    assert_non_null(strstr(o.out, "linearity"));
    assert_said(", EXCEEDED");
}

/* --- a series --- */

/* The start check does not find the markers where the answer has them. The recording is kept. */
static void series_asks_again_for_a_specimen_whose_test_did_not_begin(void **state)
{
    (void)state;
    open_bench(NULL, usual);
    write_file("series.yaml", "series: s\nspecimen: like.yaml\nspecimens: 3\nask: [markers_mm]\n"
                              "travel_mm: 12\n");
    write_file("answers", "0, 85.5\n0, 10, 20, 30, 40, 50, 85\n\nq\nq\n");
    run_with_input("answers", "record rig.yaml --series series.yaml -o f --operator me");
    assert_code(3);
    assert_said("expected the last marker at the strand");
    assert_said("'s-001-type1-L85-1.wbr' contains no cycle");
    assert_said("recording s-002-type1-L85-1.wbr");
    assert_said("0 of 3 specimens done");
    assert_true(wb_file_exists("f/s-001-type1-L85-1.wbr"));
    assert_false(wb_file_exists("f/index.yaml"));
}

/* --- `record --virtual` --- */

/* The whole file; *size receives its length. */
static char *bytes_of(const char *name, size_t *size)
{
    FILE *const file = fopen(name, "r");
    assert_non_null(file);
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    *size = (size_t)ftell(file);
    rewind(file);
    char *const bytes = malloc(*size);
    assert_non_null(bytes);
    assert_int_equal(fread(bytes, 1, *size, file), *size);
    fclose(file);
    return bytes;
}

#define VIRTUAL "record fixtures/rigs/paper.yaml --virtual " SPECIMEN "--travel-mm 8 "

static void same_start_date_gives_the_same_bytes(void **state)
{
    static const struct {
        const char *first, *second;
        int code;
    } cases[] = {
        {VIRTUAL "--start 2026-11-25 -o a.wbr", VIRTUAL "--start 2026-11-25 -o b.wbr", 0},
        {VIRTUAL "--start 2026-11-25 --seed 5 -o a.wbr --faults "
                 "loss=20,duplicates=5,reorder=5,delay=20,garbage=2,clock-drift=500,replug-cell=3",
         VIRTUAL "--start 2026-11-25 --seed 5 -o b.wbr --faults "
                 "loss=20,duplicates=5,reorder=5,delay=20,garbage=2,clock-drift=500,replug-cell=3",
         3},
    };
    (void)state;
    for (size_t i = 0; i < WB_COUNT(cases); i++) {
        size_t n[2];
        run(cases[i].first);
        assert_code(cases[i].code);
        run(cases[i].second);
        assert_code(cases[i].code);
        char *const a = bytes_of("a.wbr", &n[0]), *const b = bytes_of("b.wbr", &n[1]);
        assert_int_equal(n[0], n[1]);
        assert_memory_equal(a, b, n[0]);
        free(a);
        free(b);
        close_bench(NULL);
    }
}

static void specimens_differ_because_their_sample_is_the_seed(void **state)
{
    static const char second[] = "record fixtures/rigs/paper.yaml --virtual --start 2026-11-25 "
                                 "--specimen fixtures/specimens/type1-L85-2.yaml --travel-mm 8 ";
    (void)state;
    for (int seed = 1; seed <= 2; seed++) {
        char line[256];
        size_t n[2];
        snprintf(line, sizeof line, "%s-o a.wbr", second);
        run(line);
        assert_code(0);
        snprintf(line, sizeof line, "%s-o b.wbr --seed %d", second, seed);
        run(line);
        assert_code(0);
        char *const a = bytes_of("a.wbr", &n[0]), *const b = bytes_of("b.wbr", &n[1]);
        const bool is_same = n[0] == n[1] && memcmp(a, b, n[0]) == 0;
        assert_int_equal(is_same, seed == 2);
        free(a);
        free(b);
        close_bench(NULL);
    }
}

static void start_of(const char *name, char utc[WB_TIME_TEXT])
{
    struct wb_recording *recording;
    char *text;
    assert_int_equal(wb_recording_open(&recording, name), WB_OK);
    assert_int_equal(wb_recording_meta(recording, "start_utc", &text), WB_OK);
    snprintf(utc, WB_TIME_TEXT, "%s", text);
    free(text);
    assert_int_equal(wb_recording_close(recording), WB_OK);
}

static void date_is_the_given_or_the_real_one(void **state)
{
    char utc[WB_TIME_TEXT];
    int64_t date;
    (void)state;
    run("record fixtures/rigs/paper.yaml --virtual " SPECIMEN
        "--travel-mm 1 --start 2031-02-03 -o given.wbr");
    assert_code(0);
    start_of("given.wbr", utc);
    assert_string_equal(utc, "2031-02-03T00:00:00Z");
    const int64_t before = (int64_t)time(NULL);
    run("record fixtures/rigs/paper.yaml --virtual " SPECIMEN "--travel-mm 1 -o real.wbr");
    assert_code(0);
    start_of("real.wbr", utc);
    assert_true(wb_time_parse(utc, &date));
    assert_in_range(date, before, (int64_t)time(NULL));
}

/* The bench ends with the test: there is no specimen to free. */
static void virtual_test_advises_no_release(void **state)
{
    (void)state;
    run(VIRTUAL "-o broken.wbr --faults strand-break=6");
    assert_code(3);
    assert_not_said("release");
}

#define FACT(name) cmocka_unit_test_teardown(name, close_bench)

int main(void)
{
    const struct CMUnitTest tests[] = {
        FACT(whole_test_is_recorded),
        FACT(ctrl_c_stops_the_stage_and_a_release_frees_the_specimen),
        FACT(ctrl_c_before_all_instruments_answered_leaves_no_recording),
        FACT(wrong_first_force_stops_the_test),
        FACT(wall_clock_that_jumps_moves_no_stamp),
        FACT(force_limit_stops_the_test),
        FACT(bench_that_is_gone_cannot_confirm_the_stop),
        FACT(tic_records_a_whole_test),
        FACT(newest_natnet_streams_an_older_version_and_records_a_take),
        FACT(ctrl_z_is_ignored_and_ctrl_backslash_stops),
        FACT(a_full_disk_keeps_the_data_written_before),
        FACT(bad_ports_and_files_are_rejected_with_one_message),
        FACT(failed_check_of_the_cell_is_recorded),
        FACT(series_of_masses_is_due_before_a_test_and_gives_a_certificate),
        FACT(series_asks_again_for_a_specimen_whose_test_did_not_begin),
        FACT(same_start_date_gives_the_same_bytes),
        FACT(specimens_differ_because_their_sample_is_the_seed),
        FACT(date_is_the_given_or_the_real_one),
        FACT(virtual_test_advises_no_release),
    };
    return cmocka_run_group_tests(tests, make_work_folder, remove_work_folder);
}
