/* Presets of load cells: lines of the manufacturers' manuals, and settings from the presets. */
#include "daq/protocol/loadcell_preset.h"

#include <stdlib.h>

#include "base/config.h"
#include "base/file.h"
#include "base/units.h"
#include "daq/protocol/drivers.h"
#include "tests/daq/collect.h"
#include "tests/messages.h"

#define MS WB_NS_PER_MS
#define GRAM (1e-3 * WB_STANDARD_GRAVITY)
#define POUND (0.45359237 * WB_STANDARD_GRAVITY)

static int set_up(void **state)
{
    (void)state;
    keep_messages();
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    release_messages();
    return 0;
}

/* A rig file whose load cell has these lines. */
static enum wb_status parse(const char *address, const char *lines, struct wb_rig *rig)
{
    char text[2048];
    snprintf(text, sizeof text,
             "name: bench\n"
             "load_cell:\n"
             "  address: %s\n"
             "  protocol: generic\n"
             "  capacity_N: 1000\n"
             "  filter_delay_ms: 50\n"
             "  filter_delay_uncertainty_ms: 5\n"
             "%s"
             "mocap: {address: 'udp:192.168.1.10:1510', protocol: natnet, up: y}\n"
             "stage: {address: 'serial:/dev/ttyACM0,115200,8n1', protocol: grbl, axis: X,\n"
             "  down: 1, travel_mm: 60, speed_mm_s: 1}\n",
             address, lines);
    return wb_rig_parse(text, "bench.yaml", rig, NULL);
}

static struct wb_rig rig_of(const char *lines)
{
    struct wb_rig rig;
    if (parse("serial:/dev/ttyUSB0", lines, &rig) != WB_OK)
        fail_msg("refused: %s", kept.last);
    return rig;
}

/* The rig of a preset; grams where the instrument prints no unit. */
static struct wb_rig rig_of_preset(const char *name)
{
    char lines[128];
    const struct wb_loadcell_preset *const preset = wb_loadcell_preset_find(name);
    assert_non_null(preset);
    const bool is_told = preset->unit_rule != WB_UNIT_OF_RIG_FILE || preset->unit;
    snprintf(lines, sizeof lines, "  preset: %s\n%s", name, is_told ? "" : "  unit: g\n");
    struct wb_rig rig;
    const char *const address = preset->line ? "serial:/dev/ttyUSB0" : "serial:/dev/ttyUSB0,9600";
    assert_int_equal(parse(address, lines, &rig), WB_OK);
    return rig;
}

static void feed(void *driver, int64_t t_ns, const char *text, struct collect *collect)
{
    const struct wb_sink sink = collect_sink(collect);
    wb_loadcell_generic.receive(driver, t_ns, (const uint8_t *)text, strlen(text), &sink);
}

enum result {
    STABLE,
    UNSTABLE,
    OVERLOAD,
    REFUSED, /* with a remark */
    SILENT   /* ignored */
};

struct line {
    const char *preset, *text; /* with its end */
    enum result result;
    double force; /* N */
};

static const struct line lines[] = {
    {"loadstar", "0.021\r\n", STABLE, 0.021 * POUND},
    {"loadstar", "-1.5\r\n", STABLE, -1.5 * POUND},
    {"loadstar", "A\r\n", SILENT, 0},
    {"loadstar-iload", "2345\r\n", STABLE, 2.345 * POUND},
    {"loadstar-iload", "-12\r", STABLE, -0.012 * POUND},
    {"mark-10", "-18.78 lbF\r\n", STABLE, 18.78 * POUND},
    {"mark-10", "4.285 N\r\n", STABLE, -4.285},
    {"mark-10", "*10\r\n", REFUSED, 0},
    {"mark-10", "*22\r\n", REFUSED, 0},
    {"kern", "+  12.34 G S\r\n", STABLE, 12.34 * GRAM},
    {"kern", "+  12.34 GLS\r\n", STABLE, 12.34 * GRAM},
    {"kern", "-  12.34 GHU\r\n", UNSTABLE, -12.34 * GRAM},
    {"kern", "+ 999.99 G E\r\n", OVERLOAD, 0},
    {"kern", "+  50.00CT U\r\n", UNSTABLE, 10.0 * GRAM},
    {"kern", "A00\r\n", SILENT, 0},
    {"kern", "E01\r\n", REFUSED, 0},
    {"kern-asked", "        0.0 g  \r\n", STABLE, 0.0},
    {"kern-asked", " -     12.3    \r\n", UNSTABLE, -12.3 * GRAM},
    {"kern-asked", "       Error\r\n", OVERLOAD, 0},
    {"hx711-adc", "Load_cell output val: -3.25\r\n", STABLE, -3.25 * GRAM},
    {"hx711-adc", "8388607\r\n", OVERLOAD, 0},
    {"hx711-adc", "Startup is complete\r\n", REFUSED, 0},
    {"hx711-bogde", "one reading:\t12.5\t| average:\t11.90000\r\n", STABLE, 12.5 * GRAM},
    {"hx711-bogde", "Readings:\r\n", REFUSED, 0},
    {"hx711-sparkfun", "Reading: 0.5 lbs\r\n", STABLE, 0.5 * POUND},
    {"a-and-d", "ST,+00018.27  g\r\n", STABLE, 18.27 * GRAM},
    {"a-and-d", "US,-0183.96  g\r\n", UNSTABLE, -183.96 * GRAM},
    {"a-and-d", "OL,+9999999E+19\r\n", OVERLOAD, 0},
    {"a-and-d", "ST,+00000010 PC\r\n", REFUSED, 0},
    {"a-and-d", "\x06\r\n", SILENT, 0},
    {"a-and-d", "EC,E01\r\n", REFUSED, 0},
    {"ohaus", "    192.21 g\r\n", STABLE, 192.21 * GRAM},
    {"ohaus", "      0.01 g ?\r\n", UNSTABLE, 0.01 * GRAM},
    {"ohaus", "Err 8.3\r\n", OVERLOAD, 0},
    {"ohaus", "Err 3.1\r\n", REFUSED, 0},
    {"ohaus", "OK!\r\n", SILENT, 0},
    {"ohaus-scout", "    192.21 g\r\n", STABLE, 192.21 * GRAM},
    {"ohaus-scout", "      0.01 g ?\r\n", UNSTABLE, 0.01 * GRAM},
    {"ohaus-scout", "Err 8.4\r\n", OVERLOAD, 0},
    {"sartorius", "+    12.34 g  \r\n", STABLE, 12.34 * GRAM},
    {"sartorius", "-    12.34    \r\n", UNSTABLE, -12.34 * GRAM},
    {"sartorius", "N     +    12.34 g  \r\n", STABLE, 12.34 * GRAM},
    {"sartorius", "      H       \r\n", OVERLOAD, 0},
    {"sartorius", "Stat       L        \r\n", OVERLOAD, 0},
    {"sartorius", "Err 55\r\n", REFUSED, 0},
    {"sartorius", "      C       \r\n", REFUSED, 0},
    {"radwag", "SI ?       18.5 kg \r\n", UNSTABLE, 18500.0 * GRAM},
    {"radwag", "SI   -     12.3 g  \r\n", STABLE, -12.3 * GRAM},
    {"radwag", "SI ^     1234.5 g  \r\n", OVERLOAD, 0},
    {"radwag", "SI v        0.0 g  \r\n", OVERLOAD, 0},
    {"radwag", "SUI? -   58.237 g  \r\n", REFUSED, 0},
    {"radwag", "SUI ? -   58.237 g  \r\n", UNSTABLE, -58.237 * GRAM},
    {"radwag", "      1832.0 g  \r\n", STABLE, 1832.0 * GRAM},
    {"radwag", "? -    2.237 lb \r\n", UNSTABLE, -2.237 * POUND},
    {"radwag", "C1 A\r\n", SILENT, 0},
    {"radwag", "SI I\r\n", REFUSED, 0},
    {"indicator", "ST,GS,+  4.876kg\r\n", STABLE, 4876.0 * GRAM},
    {"indicator", "US,NT,-  4.876kg\r\n", UNSTABLE, -4876.0 * GRAM},
    {"indicator", "OL,GS,+  9.999kg\r\n", OVERLOAD, 0},
    {"dini-argeo", "ST,GS,     0.250,kg\r\n", STABLE, 250.0 * GRAM},
    {"dini-argeo", "US,NT,      -12, g\r\n", UNSTABLE, -12.0 * GRAM},
    {"dini-argeo", "UL,GS,     0.000,kg\r\n", OVERLOAD, 0},
    {"dini-argeo", "ERR04\r\n", REFUSED, 0},
    {"mantracourt", "+0012.345\r", STABLE, 12.345 * GRAM},
    {"mantracourt", "?\r", REFUSED, 0},
};

static void check_line(const struct line *line)
{
    struct collect collect = {0};
    const struct wb_rig rig = rig_of_preset(line->preset);
    void *const driver = collect_open(&wb_loadcell_generic, &rig);
    const int64_t settled_ns = rig.load_cell.settle_ns;
    feed(driver, 0, strchr(line->text, '\n') ? "\r\n" : "\r", &collect);
    /* The second, because the first line may be the end of one. */
    feed(driver, settled_ns, strchr(line->text, '\n') ? "0\r\n" : "0\r", &collect);
    memset(&collect, 0, sizeof collect);
    /* A line without a unit goes by the one before. */
    if (wb_loadcell_preset_find(line->preset)->unit_rule == WB_UNIT_IF_STABLE)
        feed(driver, settled_ns, "+  1.0 g\r\n", &collect);
    memset(&collect, 0, sizeof collect);
    feed(driver, settled_ns + MS, line->text, &collect);
    const bool is_sample = line->result <= OVERLOAD;
    if (collect.n_load != is_sample ||
        collect_count(&collect, "refused") != (line->result == REFUSED))
        fail_msg("%s: '%s': %d samples, %d refused: %s", line->preset, line->text, collect.n_load,
                 collect_count(&collect, "refused"), collect_text(&collect, "refused"));
    const struct wb_load_sample *const sample = &collect.load[0];
    if (is_sample && (sample->overload != (line->result == OVERLOAD) ||
                      sample->unstable != (line->result == UNSTABLE)))
        fail_msg("%s: '%s': overload %d, unstable %d", line->preset, line->text, sample->overload,
                 sample->unstable);
    if (line->result <= UNSTABLE)
        assert_close(sample->force, line->force, 1e-12 * (1.0 + fabs(line->force)));
    free(driver);
}

static void lines_of_the_manuals_are_read(void **state)
{
    (void)state;
    for (size_t i = 0; i < WB_COUNT(lines); i++)
        check_line(&lines[i]);
}

static void every_preset_has_lines_of_its_manual(void **state)
{
    (void)state;
    for (size_t i = 0; wb_loadcell_preset_at(i); i++) {
        const struct wb_loadcell_preset *const preset = wb_loadcell_preset_at(i);
        size_t n = 0;
        for (size_t k = 0; k < WB_COUNT(lines); k++)
            n += strcmp(lines[k].preset, preset->name) == 0;
        if (n == 0)
            fail_msg("no line of %s is tested", preset->name);
        assert_ptr_equal(wb_loadcell_preset_find(preset->name), preset);
        assert_true(strlen(preset->name) < 32);
    }
    assert_null(wb_loadcell_preset_find("nobody"));
}

/* A row of docs/instruments.md describes the connection: "| `NAME` | ... | LINE |". */
static void every_preset_is_documented(void **state)
{
    (void)state;
    char path[WB_PATH], row[64], *text;
    const char *const root = getenv("WIREBENCH_SOURCE_ROOT");
    if (!root)
        fail_msg("WIREBENCH_SOURCE_ROOT is not set: run this test through meson");
    snprintf(path, sizeof path, "%s/docs/instruments.md", root);
    assert_int_equal(wb_file_read(path, &text, NULL), WB_OK);
    for (size_t i = 0; wb_loadcell_preset_at(i); i++) {
        const struct wb_loadcell_preset *const preset = wb_loadcell_preset_at(i);
        char line[24];
        snprintf(line, sizeof line, "| %s |", preset->line ? preset->line : "-");
        snprintf(row, sizeof row, "\n| `%s` |", preset->name);
        const char *const at = strstr(text, row);
        const char *const end = at ? strchr(at + 1, '\n') : NULL;
        const char *const found = at ? strstr(at, line) : NULL;
        if (!end || !found || found > end)
            fail_msg("docs/instruments.md: no row of %s with '%s'", preset->name, line);
    }
    free(text);
}

/* In a bending test the load is never stable. */
static void no_preset_waits_for_a_stable_load(void **state)
{
    (void)state;
    static const char *const waiting[] = {"S\r\n", "S", "s", "SP\r\n", "ST\r\n", "O9\r\n"};
    for (size_t i = 0; wb_loadcell_preset_at(i); i++) {
        const struct wb_loadcell_preset *const preset = wb_loadcell_preset_at(i);
        const char *const sent[] = {preset->start, preset->request};
        for (size_t k = 0; k < 2; k++)
            for (size_t w = 0; sent[k] && w < WB_COUNT(waiting); w++)
                assert_string_not_equal(sent[k], waiting[w]);
    }
}

static void preset_sets_port_commands_and_unit(void **state)
{
    (void)state;
    const struct wb_rig and_d = rig_of("  preset: a-and-d\n");
    assert_string_equal(and_d.load_cell.preset, "a-and-d");
    assert_string_equal(and_d.load_cell.address, "serial:/dev/ttyUSB0,2400,7e1");
    assert_string_equal(and_d.load_cell.start_command, "SIR\r\n");
    assert_string_equal(and_d.load_cell.stop_command, "C\r\n");
    assert_string_equal(and_d.load_cell.poll_command, "");
    assert_string_equal(and_d.load_cell.terminator, "crlf");
    const struct wb_rig iload = rig_of("  preset: loadstar-iload\n");
    assert_string_equal(iload.load_cell.unit, "lb");
    assert_close(iload.load_cell.scale, 1e-3, 0.0);
    const struct wb_rig gauge = rig_of("  preset: mark-10\n");
    assert_string_equal(gauge.load_cell.poll_command, "?C\r");
    assert_int_equal(gauge.load_cell.poll_period_ns, 50 * MS);
    assert_int_equal(gauge.load_cell.sign, -1);
    const struct wb_rig sketch = rig_of("  preset: hx711-bogde\n  unit: g\n");
    assert_int_equal(sketch.load_cell.delimiter, '|');
    assert_int_equal(sketch.load_cell.column, 1);
    assert_int_equal(sketch.load_cell.settle_ns, 2500 * MS);
    assert_int_equal(kept.n, 0);
}

static void keys_of_the_file_override_the_preset(void **state)
{
    (void)state;
    struct wb_rig rig = rig_of("  preset: mark-10\n  sign: +1\n  poll_command: \"?\\r\"\n");
    assert_int_equal(rig.load_cell.sign, 1);
    assert_string_equal(rig.load_cell.poll_command, "?\r");
    assert_int_equal(rig.load_cell.poll_period_ns, 50 * MS);
    /* A stream started by the file's own command is not polled. */
    rig = rig_of("  preset: mark-10\n  start_command: \"AOUT50\\r\"\n");
    assert_string_equal(rig.load_cell.start_command, "AOUT50\r");
    assert_string_equal(rig.load_cell.poll_command, "");
    assert_int_equal(rig.load_cell.poll_period_ns, 0);
    /* With a period, a streaming instrument is polled instead. */
    rig = rig_of("  preset: a-and-d\n  poll_period_ms: 200\n");
    assert_string_equal(rig.load_cell.poll_command, "Q\r\n");
    assert_string_equal(rig.load_cell.start_command, "");
    assert_string_equal(rig.load_cell.stop_command, "");
    assert_int_equal(rig.load_cell.poll_period_ns, 200 * MS);
    rig = rig_of("  preset: loadstar\n  unit: N\n  terminator: cr\n  scale: 2\n");
    assert_string_equal(rig.load_cell.unit, "N");
    assert_string_equal(rig.load_cell.terminator, "cr");
    assert_close(rig.load_cell.scale, 2.0, 0.0);
    const char *const preset = "  preset: a-and-d\n";
    assert_int_equal(parse("serial:/dev/ttyUSB0,dtr=keep,9600", preset, &rig), WB_OK);
    assert_string_equal(rig.load_cell.address, "serial:/dev/ttyUSB0,dtr=keep,9600,7e1");
    assert_int_equal(parse("serial:/dev/ttyUSB0,8n1", preset, &rig), WB_OK);
    assert_string_equal(rig.load_cell.address, "serial:/dev/ttyUSB0,8n1,2400");
    assert_int_equal(parse("pty:/dev/pts/3", preset, &rig), WB_OK);
    assert_string_equal(rig.load_cell.address, "pty:/dev/pts/3");
}

static void values_missing_in_a_preset_are_required(void **state)
{
    (void)state;
    static const struct {
        const char *address, *lines, *message;
    } cases[] = {
        {"serial:/dev/a", "  preset: kernel\n", "bench.yaml:8: preset: expected one of loadstar, "},
        {"serial:/dev/a", "  preset: [kern]\n", "preset: expected one of"},
        {"serial:/dev/a", "  preset: hx711-adc\n", "unit: an instrument of the preset hx711-adc"},
        {"serial:/dev/a", "  preset: mantracourt\n  unit: g\n", "address: the preset mantracourt"},
        {"serial:/dev/a", "  preset: indicator\n  poll_period_ms: 100\n", "poll_command"},
    };
    for (size_t i = 0; i < WB_COUNT(cases); i++) {
        struct wb_rig rig;
        assert_int_equal(parse(cases[i].address, cases[i].lines, &rig), WB_ERR_FORMAT);
        if (!strstr(kept.last, cases[i].message))
            fail_msg("case %zu: '%s'", i, kept.last);
    }
}

static void silent_stream_is_requested_again(void **state)
{
    (void)state;
    struct collect collect = {0};
    struct wb_outbox outbox = {0};
    const struct wb_rig rig = rig_of("  preset: radwag\n");
    void *const driver = collect_open(&wb_loadcell_generic, &rig);
    wb_loadcell_generic.start(driver, 0, &outbox);
    for (int64_t t = 0; t < 3000; t += 20) {
        wb_loadcell_generic.tick(driver, t * MS, &outbox);
        feed(driver, t * MS, "SI ?       18.5 g  \r\n", &collect);
        collect.n_load = 0;
    }
    assert_int_equal(outbox.n_entries, 1);
    for (int64_t t = 3000; t < 5500; t += 20)
        wb_loadcell_generic.tick(driver, t * MS, &outbox);
    assert_int_equal(outbox.n_entries, 3);
    wb_loadcell_generic.stop(driver, &outbox);
    assert_int_equal(outbox.n_bytes, 16);
    assert_memory_equal(outbox.bytes, "C1\r\nC1\r\nC1\r\nC0\r\n", 16);
    free(driver);
}

/* Without a preset the effect of a second start command is unknown. */
static void start_command_of_the_file_is_sent_once(void **state)
{
    (void)state;
    struct wb_outbox outbox = {0};
    const struct wb_rig rig = rig_of("  start_command: X\n  stop_command: \"Y\\r\"\n");
    void *const driver = collect_open(&wb_loadcell_generic, &rig);
    wb_loadcell_generic.start(driver, 0, &outbox);
    for (int64_t t = 0; t < 5000; t += 20)
        wb_loadcell_generic.tick(driver, t * MS, &outbox);
    wb_loadcell_generic.stop(driver, &outbox);
    assert_int_equal(outbox.n_bytes, 3);
    assert_memory_equal(outbox.bytes, "XY\r", 3);
    free(driver);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lines_of_the_manuals_are_read),
        cmocka_unit_test(every_preset_has_lines_of_its_manual),
        cmocka_unit_test(every_preset_is_documented),
        cmocka_unit_test(no_preset_waits_for_a_stable_load),
        cmocka_unit_test(preset_sets_port_commands_and_unit),
        cmocka_unit_test(keys_of_the_file_override_the_preset),
        cmocka_unit_test(values_missing_in_a_preset_are_required),
        cmocka_unit_test(silent_stream_is_requested_again),
        cmocka_unit_test(start_command_of_the_file_is_sent_once),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
