/* Faults of the virtual bench, and what the commands say of each: the table of the manual. */
#include "tests/cli/bench_tool.h"

struct said {
    int code;
    const char *parts[3]; /* to the first NULL */
};

static const struct fault {
    const char *list;
    double travel; /* mm */
    struct said record, verify, align;
    const char *never; /* what no command says */
} faults[] = {
    {.list = "loss=20,duplicates=5,reorder=5",
     .travel = 8,
     .record = {3, {"19 % of the data from the mocap never came: 541 in 474 gaps"}},
     .verify = {3, {"19 % of its frames never came: 541 in 474 places"}},
     .align = {0, {"19 % of the frames never came: 541 in 474 places", "largest deflection"}}},
    /* What arrives late, twice or in another order costs nothing that was measured. */
    {.list = "duplicates=20,delay=100,clock-drift=500",
     .travel = 8,
     .record = {0, {"3371 frames"}},
     .verify = {0, {"whole"}},
     .align = {0, {"largest deflection", "no warnings"}},
     .never = "never came"},
    /* Frames of another order are all there, also those still on their way at the end. */
    {.list = "duplicates=10,reorder=20",
     .travel = 8,
     .record = {0, {"3081 frames"}},
     .verify = {0, {"whole"}},
     .align = {0, {"largest deflection", "no warnings"}},
     .never = "never came"},
    {.list = "garbage=10",
     .travel = 8,
     .record = {3,
                {"rejected at byte 0: the datagram is shorter than its header says; 200 so far. "
                 "Another program may send to this port, or the network damages datagrams: check "
                 "host, port and group in mocap.address",
                 "check baud rate and parity in load_cell.address; 100 so far",
                 "17 % of the data from the load never came: 326 in 214 gaps"}},
     .verify = {3, {"lines that could not be decoded"}},
     .align = {0, {"largest deflection"}}},
    {.list = "wrong-up",
     .travel = 8,
     .record = {3, {"set mocap.up of the rig file to the vertical axis"}},
     .verify = {0, {"whole"}},
     .align = {1, {"the rig's mocap.up is wrong"}}},
    {.list = "clock-restart=4",
     .travel = 8,
     .record = {0, {"the server's clock went back"}},
     .verify = {0, {"whole"}},
     .align = {0, {"clock broke 1 time", "largest deflection"}}},
    {.list = "unit-change=4",
     .travel = 8,
     .record = {3, {"the load cell's unit changed from g to oz", "restore the previous unit"}},
     .verify = {0, {"whole"}},
     .align = {1, {"the test was cut short", "no force at zero deflection"}}},
    {.list = "replug-cell=4",
     .travel = 8,
     .record = {0, {"the load cell's port was reconnected after 0.41 s"}},
     .verify = {3, {"a stream was silent for too long 1 time"}},
     .align = {3, {"the load cell's port was reconnected after 0.41 s"}}},
    {.list = "unplug-cell=4",
     .travel = 8,
     .record = {3, {"the load cell's port sim:load_cell was disconnected"}},
     .verify = {3, {"a stream was silent for too long 1 time"}},
     .align = {3, {"the test was cut short", "largest deflection"}}},
    {.list = "unplug-mocap=4",
     .travel = 50,
     .record = {3, {"the motion capture sent no valid sample for 1.00 s"}},
     .verify = {3, {"silent for"}},
     .align = {1, {"the test was cut short", "no force at zero deflection"}}},
    {.list = "unplug-stage=4",
     .travel = 8,
     .record = {3, {"the stage's port sim:stage was disconnected", "switch off its power"}},
     .verify = {3, {"a stream was silent for too long 1 time"}},
     .align = {1, {"the test was cut short", "no force at zero deflection"}}},
    {.list = "stuck-stage=15",
     .travel = 40,
     .record = {3, {"the cameras see the clamp at 15.0 mm"}},
     .verify = {0, {"whole"}},
     .align = {3, {"lost steps"}}},
    {.list = "strand-break=6",
     .travel = 30,
     .record = {3, {"the force fell from 38.6 to 34.4 mN"}},
     .verify = {0, {"whole"}},
     .align = {3, {"the test was cut short: limit: the force fell"}}},
};

static void expect_said(const char *command, const struct said *expected, const char *never)
{
    run(command);
    if (o.code != expected->code)
        fail_msg("%s: exit code %d, expected %d: %s%s", command, o.code, expected->code, o.out,
                 o.err);
    for (int i = 0; i < 3 && expected->parts[i]; i++)
        assert_said(expected->parts[i]);
    if (never)
        assert_not_said(never);
}

static void every_fault_gives_the_messages_of_the_manual(void **state)
{
    (void)state;
    for (size_t i = 0; i < WB_COUNT(faults); i++) {
        const struct fault *const fault = &faults[i];
        char command[512];
        print_message("           %s\n", fault->list);
        snprintf(command, sizeof command,
                 "record fixtures/rigs/paper.yaml --virtual --start 2026-11-25 " SPECIMEN
                 "--travel-mm %g --faults %s -o test.wbr",
                 fault->travel, fault->list);
        expect_said(command, &fault->record, fault->never);
        expect_said("verify test.wbr", &fault->verify, fault->never);
        expect_said("align test.wbr -o dataset", &fault->align, fault->never);
        assert_int_equal(wb_file_exists("dataset/force_deflection.csv"), fault->align.code != 1);
        assert_int_equal(system("rm -rf test.wbr dataset"), 0);
    }
}

/* The recording is not lost: a corrected rig file holds in place of its own. */
static void recording_with_a_wrong_axis_is_aligned_by_a_corrected_rig_file(void **state)
{
    static const char *const corrected[] = {"  up: y", "  up: z", NULL};
    (void)state;
    run("record fixtures/rigs/paper.yaml --virtual --start 2026-11-25 " SPECIMEN
        "--travel-mm 8 --seed 2 --faults wrong-up -o up.wbr");
    assert_code(3);
    copy_edited("fixtures/rigs/paper.yaml", "up.yaml", corrected);
    run("align up.wbr --rig up.yaml -o dataset");
    assert_code(3); /* cut short */
    assert_said("mocap.up is z in place of the recorded y");
    assert_said("largest deflection");
    assert_int_equal(system("rm -r dataset"), 0);
}

/* A clamp that jams leaves a bent wire and a level reading: a release says nothing of free. */
static void a_specimen_in_a_jammed_clamp_is_not_reported_as_free(void **state)
{
    char release[256];
    (void)state;
    open_bench(NULL, (struct wb_bench_settings){.faults = "stuck-stage=15"});
    run("record rig.yaml " SPECIMEN "-o stuck.wbr --travel-mm 40");
    assert_code(3);
    advised(release);
    assert_non_null(strstr(release, "--zero-mn="));
    for (int i = 0; i < 2; i++) {
        run(i == 0 ? release : "stage rig.yaml release");
        assert_code(3);
        assert_said("before you touch the specimen");
        assert_null(strstr(o.err, "specimen is free\n"));
        assert_string_equal(o.out, "");
    }
}

/* By the names of the message that refuses another. */
static void manual_has_every_fault(void **state)
{
    static char manual[1 << 20];
    const char *const before = "expected some of ";
    char path[WB_PATH], row[64];
    int n = 0;
    (void)state;
    run("record fixtures/rigs/paper.yaml --virtual " SPECIMEN "--faults none -o none.wbr");
    assert_code(1);
    FILE *const file = fopen(wb_command_find("docs/manual.md", path), "r");
    assert_non_null(file);
    manual[fread(manual, 1, sizeof manual - 1, file)] = '\0';
    fclose(file);
    char *names = strstr(o.err, before);
    assert_non_null(names);
    for (char *name = strtok(names + strlen(before), ", \n"); name; name = strtok(NULL, ", \n")) {
        snprintf(row, sizeof row, "\n| `%s` |", name);
        if (!strstr(manual, row))
            fail_msg("docs/manual.md lacks %s", name);
        n++;
    }
    assert_true(n > 10);
}

#define FACT(name) cmocka_unit_test_teardown(name, close_bench)

int main(void)
{
    const struct CMUnitTest tests[] = {
        FACT(every_fault_gives_the_messages_of_the_manual),
        FACT(recording_with_a_wrong_axis_is_aligned_by_a_corrected_rig_file),
        FACT(a_specimen_in_a_jammed_clamp_is_not_reported_as_free),
        FACT(manual_has_every_fault),
    };
    return cmocka_run_group_tests(tests, make_work_folder, remove_work_folder);
}
