/* Diagnosis of an instrument from its first bytes if they cannot be decoded. */
#include "daq/protocol/diagnosis.h"

#include "tests/check.h"

static struct wb_rig rig;
static char text[WB_DIAGNOSIS_TEXT];

static struct wb_diagnosis heard(const char *bytes)
{
    struct wb_diagnosis diagnosis = {0};
    wb_diagnosis_add(&diagnosis, bytes, strlen(bytes));
    return diagnosis;
}

static void assert_stage(const char *bytes, const char *words)
{
    const struct wb_diagnosis stage = heard(bytes);
    strcpy(rig.stage.protocol, "grbl");
    wb_diagnosis_stage(&stage, &rig, text);
    if (!strstr(text, words))
        fail_msg("of '%s': '%s' does not contain '%s'", bytes, text, words);
}

static void assert_load(const char *bytes, const char *stage_bytes, const char *words)
{
    const struct wb_diagnosis load = heard(bytes), stage = heard(stage_bytes);
    wb_diagnosis_load(&load, &stage, &rig, text);
    if (!strstr(text, words))
        fail_msg("of '%s': '%s' does not contain '%s'", bytes, text, words);
}

static const char readings[] = ".3 g\r\n   12.34 g\r\n   12.35 g\r\nST,+00018.27  g\r\n";
static const char noise[] = "\xe5\x9a\xf8\x81\xfe\x86~\xe0\x98\xff\x9c\xfc\x81\x80\xf8";

static void other_firmware_is_named(void **state)
{
    (void)state;
    assert_stage("\r\nGrbl 0.9j ['$' for help]\r\n", "GRBL before 1.1");
    assert_stage("<Idle,MPos:0.000,0.000,0.000,WPos:0.000,0.000,0.000>\r\n", "GRBL before 1.1");
    assert_stage("start\necho:Marlin 1.1.9\n\necho: Last Updated: 2018-07-31\n", "Marlin");
    assert_stage("echo:Unknown command: \"????????\"\nok\n", "Marlin");
    assert_stage("\r\nGrbl 1.1h ['$' for help]\r\n", "does not reply to '?'");
    assert_stage("hello\r\nhello\r\n", "stage.protocol");
}

static void silent_tic_is_reported_with_advice_for_a_tic(void **state)
{
    (void)state;
    static const struct {
        const char *bytes, *words;
    } cases[] = {
        {"", "TX, RX and ground"},
        {noise, "not a reply of a Tic"},
        {"\r\nGrbl 1.1h ['$' for help]\r\n", "set stage.protocol: grbl"},
        {readings, "swapped"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const struct wb_diagnosis stage = heard(cases[i].bytes);
        strcpy(rig.stage.protocol, "tic");
        wb_diagnosis_stage(&stage, &rig, text);
        if (!strstr(text, cases[i].words))
            fail_msg("of '%s': '%s'", cases[i].bytes, text);
    }
}

static void wrong_baud_rate_is_reported(void **state)
{
    (void)state;
    assert_stage(noise, "baud rate in stage.address");
    assert_stage("", "baud rate in stage.address");
    assert_load(noise, "", "baud rate and frame");
    assert_load("", "", "the baud rate in load_cell.address");
}

static void swapped_ports_are_reported(void **state)
{
    (void)state;
    assert_stage(readings, "swapped");
    assert_load("", readings, "swapped");
    assert_load("\r\nGrbl 1.1h ['$' for help]\r\n", "", "swapped");
    /* A few numbers among other lines do not identify a load cell. */
    assert_stage("boot\r\n12\r\nloading\r\nchecking\r\n", "not those of GRBL 1.1");
}

static void other_line_ends_are_reported(void **state)
{
    (void)state;
    char endless[200];
    memset(endless, '7', sizeof endless - 1);
    endless[sizeof endless - 1] = '\0';
    assert_load(endless, "", "load_cell.terminator");
    strcpy(rig.load_cell.terminator, "crlf");
    assert_load("1.2 g\n1.2 g\n1.2 g\n", "", "load_cell.terminator");
    strcpy(rig.load_cell.terminator, "cr");
    assert_load("1.2 g\n1.2 g\n1.2 g\n", "", "load_cell.terminator");
    strcpy(rig.load_cell.terminator, "lf");
    assert_load("1.2 g\r1.2 g\r1.2 g\r", "", "load_cell.terminator");
    assert_load("1,2;3 q\n1,2;3 q\n1,2;3 q\n", "", "load_cell.protocol");
}

static void only_the_beginning_is_kept(void **state)
{
    (void)state;
    struct wb_diagnosis diagnosis = heard("Grbl 0.9j\r\n");
    char flood[300];
    memset(flood, 0xff, sizeof flood);
    for (int i = 0; i < 10; i++)
        wb_diagnosis_add(&diagnosis, flood, sizeof flood);
    assert_int_equal(diagnosis.n, sizeof diagnosis.bytes);
    assert_int_equal(wb_diagnosis_kind(&diagnosis), WB_DIAGNOSIS_NOISE);
}

/* Any bytes, and lines truncated anywhere, are accepted. */
static void any_bytes_are_accepted(void **state)
{
    (void)state;
    unsigned seed = 1;
    for (int i = 0; i < 20000; i++) {
        struct wb_diagnosis diagnosis = {0};
        char bytes[40];
        for (size_t k = 0; k < sizeof bytes; k++) {
            seed = seed * 1664525u + 1013904223u;
            bytes[k] = "<>|,:MPosGrbl 0.9$\r\n12.3 g\xff"[(seed >> 16) % 26];
        }
        wb_diagnosis_add(&diagnosis, bytes, (seed >> 8) % sizeof bytes);
        const enum wb_diagnosis_kind kind = wb_diagnosis_kind(&diagnosis);
        assert_true(kind >= WB_DIAGNOSIS_NOTHING && kind <= WB_DIAGNOSIS_OTHER);
        wb_diagnosis_load(&diagnosis, &diagnosis, &rig, text);
        wb_diagnosis_stage(&diagnosis, &rig, text);
        assert_true(strlen(text) > 20);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(other_firmware_is_named),
        cmocka_unit_test(wrong_baud_rate_is_reported),
        cmocka_unit_test(swapped_ports_are_reported),
        cmocka_unit_test(other_line_ends_are_reported),
        cmocka_unit_test(silent_tic_is_reported_with_advice_for_a_tic),
        cmocka_unit_test(only_the_beginning_is_kept),
        cmocka_unit_test(any_bytes_are_accepted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
