#include "daq/protocol/rig.h"

#include <stdlib.h>
#include <unistd.h>

#include "base/file.h"
#include "base/units.h"
#include "tests/folder.h"
#include "tests/messages.h"

static const char good[] = "name: paper bench\n"                         /* line 1 */
                           "gravity_m_s2: 9.81\n"                        /* 2 */
                           "load_cell:\n"                                /* 3 */
                           "  address: serial:/dev/ttyUSB0,9600,8n1\n"   /* 4 */
                           "  protocol: generic\n"                       /* 5 */
                           "  capacity_g: 20\n"                          /* 6 */
                           "  overload_percent: 150\n"                   /* 7 */
                           "  serial_number: LS270-1234\n"               /* 8 */
                           "  calibration_date: 2026-01-15\n"            /* 9 */
                           "  filter_delay_ms: 50\n"                     /* 10 */
                           "  filter_delay_uncertainty_ms: 5\n"          /* 11 */
                           "  noise_mg: 10\n"                            /* 12 */
                           "  unit: g\n"                                 /* 13 */
                           "  sign: +1\n"                                /* 14 */
                           "mocap:\n"                                    /* 15 */
                           "  address: udp:192.168.1.10:1510\n"          /* 16 */
                           "  protocol: natnet\n"                        /* 17 */
                           "  up: y\n"                                   /* 18 */
                           "stage:\n"                                    /* 19 */
                           "  address: serial:/dev/ttyACM0,115200,8n1\n" /* 20 */
                           "  protocol: grbl\n"                          /* 21 */
                           "  axis: X\n"                                 /* 22 */
                           "  down: +1\n"                                /* 23 */
                           "  travel_mm: 60\n"                           /* 24 */
                           "  speed_mm_s: 1\n"                           /* 25 */
                           "strand:\n"                                   /* 26 */
                           "  length_mm: 760\n"                          /* 27 */
                           "  counterweight_g: 2.7\n"                    /* 28 */
                           "limits:\n"                                   /* 29 */
                           "  force_mN: 280\n"                           /* 30 */
                           "  travel_mm: 58\n";                          /* 31 */

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

/* The good text with its first `from` replaced by `to`. */
static const char *edited(const char *from, const char *to)
{
    static char text[4096];
    const char *const at = strstr(good, from);
    assert_non_null(at);
    snprintf(text, sizeof text, "%.*s%s%s", (int)(at - good), good, to, at + strlen(from));
    return text;
}

static struct wb_rig parse(const char *text)
{
    struct wb_rig rig;
    memset(&rig, 0xff, sizeof rig);
    const enum wb_status status = wb_rig_parse(text, "bench.yaml", &rig, NULL);
    if (status != WB_OK)
        fail_msg("refused: %s", kept.last);
    return rig;
}

static void every_value_arrives_in_si(void **state)
{
    (void)state;
    const struct wb_rig rig = parse(good);
    assert_string_equal(rig.name, "paper bench");
    assert_close(rig.gravity, 9.81, 0.0);
    assert_string_equal(rig.load_cell.address, "serial:/dev/ttyUSB0,9600,8n1");
    assert_string_equal(rig.load_cell.protocol, "generic");
    assert_close_relative(rig.load_cell.capacity, 0.02 * 9.81, 1e-15);
    assert_close_relative(rig.load_cell.overload, 0.03 * 9.81, 1e-15);
    assert_close_relative(rig.load_cell.filter_delay, 0.05, 1e-15);
    assert_close_relative(rig.load_cell.filter_delay_uncertainty, 0.005, 1e-15);
    assert_close_relative(rig.load_cell.noise, 1e-5 * 9.81, 1e-15);
    assert_string_equal(rig.load_cell.unit, "g");
    assert_int_equal(rig.load_cell.sign, 1);
    assert_close(rig.load_cell.scale, 1.0, 0.0);
    assert_string_equal(rig.load_cell.terminator, "any");
    assert_int_equal(rig.load_cell.poll_period_ns, 0);
    assert_int_equal(rig.mocap.up, 'y');
    assert_int_equal(rig.stage.axis, 'X');
    assert_int_equal(rig.stage.down, 1);
    assert_close_relative(rig.stage.travel, 0.06, 1e-15);
    assert_close_relative(rig.stage.speed, 1e-3, 1e-15);
    assert_close_relative(rig.strand.length, 0.76, 1e-15);
    assert_close_relative(rig.strand.counterweight, 2.7e-3, 1e-15);
    assert_close_relative(rig.limits.force, 0.28, 1e-15);
    assert_close_relative(rig.limits.travel, 0.058, 1e-15);
    assert_close(rig.limits.stream_lost, 1.0, 0.0);
    assert_false(rig.is_virtual);
    assert_close(rig.time_scale, 1.0, 0.0);
    assert_int_equal(kept.n, 0);
}

static void uncertainties_are_those_of_the_data(void **state)
{
    (void)state;
    struct wb_rig rig = parse(good);
    assert_close(rig.load_cell.gain_uncertainty, 0.0, 0.0);
    assert_close(rig.strand.counterweight_uncertainty, 0.0, 0.0);
    rig = parse(edited("  noise_mg: 10\n", "  noise_mg: 10\n  u_gain_percent: 0.3\n"));
    assert_close_relative(rig.load_cell.gain_uncertainty, 3e-3, 1e-15);
    rig = parse(
        edited("  counterweight_g: 2.7\n", "  counterweight_g: 2.7\n  u_counterweight_g: 0.01\n"));
    assert_close_relative(rig.strand.counterweight_uncertainty, 1e-5, 1e-15);
}

static void line_protocol_keys_are_read(void **state)
{
    (void)state;
    const struct wb_rig rig = parse(edited("  sign: +1\n", "  sign: -1\n"
                                                           "  delimiter: ';'\n"
                                                           "  column: 3\n"
                                                           "  scale: 0.5\n"
                                                           "  offset: -2\n"
                                                           "  terminator: idle\n"
                                                           "  idle_gap_ms: 30\n"
                                                           "  poll_command: \"W\\r\"\n"
                                                           "  poll_period_ms: 100\n"
                                                           "  start_command: 'O0\\x41\\r\\n'\n"
                                                           "  tare_command: CT0\n"
                                                           "  unstable_tokens: [US, '?']\n"
                                                           "  overload_tokens: [OL, 8388607]\n"
                                                           "  decimal_comma: true\n"
                                                           "  settle_ms: 2000\n"));
    assert_false(rig.mocap.record_take);
    assert_true(parse(edited("  up: y\n", "  up: y\n  record_take: true\n")).mocap.record_take);
    const struct wb_rig_load_cell *const cell = &rig.load_cell;
    assert_int_equal(cell->sign, -1);
    assert_int_equal(cell->delimiter, ';');
    assert_int_equal(cell->column, 3);
    assert_close(cell->scale, 0.5, 0.0);
    assert_close(cell->offset, -2.0, 0.0);
    assert_string_equal(cell->terminator, "idle");
    assert_int_equal(cell->idle_gap_ns, 30 * WB_NS_PER_MS);
    assert_string_equal(cell->poll_command, "W\r");
    assert_int_equal(cell->poll_period_ns, 100 * WB_NS_PER_MS);
    assert_string_equal(cell->start_command, "O0A\r\n");
    assert_string_equal(cell->tare_command, "CT0");
    assert_string_equal(cell->unstable_tokens[1], "?");
    assert_string_equal(cell->overload_tokens[1], "8388607");
    assert_string_equal(cell->overload_tokens[2], "");
    assert_true(cell->decimal_comma);
    assert_int_equal(cell->settle_ns, 2000 * WB_NS_PER_MS);
}

static void virtual_rigs_are_marked_and_their_truth_is_ignored(void **state)
{
    (void)state;
    const struct wb_rig rig = parse(edited("gravity_m_s2: 9.81\n", "virtual: true\n"
                                                                   "time_scale: 20\n"
                                                                   "truth:\n"
                                                                   "  E: 5021\n"
                                                                   "  nested: [1, {a: b}]\n"));
    assert_true(rig.is_virtual);
    assert_close(rig.time_scale, 20.0, 0.0);
    assert_close(rig.gravity, WB_STANDARD_GRAVITY, 0.0); /* the default */
}

static void tare_is_unloaded_unless_it_is_with_the_counterweight(void **state)
{
    (void)state;
    struct wb_rig rig = parse(good);
    assert_int_equal(rig.load_cell.tare, WB_RIG_TARE_UNLOADED);
    assert_close(wb_rig_tare_load(&rig), 0.0, 0.0);
    rig = parse(edited("  sign: +1\n", "  tare: unloaded\n"));
    assert_int_equal(rig.load_cell.tare, WB_RIG_TARE_UNLOADED);
    rig = parse(edited("  sign: +1\n", "  tare: counterweight\n"));
    assert_int_equal(rig.load_cell.tare, WB_RIG_TARE_COUNTERWEIGHT);
    assert_close_relative(wb_rig_tare_load(&rig), 2.7e-3 * 9.81, 1e-12);
}

static void tare_with_a_counterweight_needs_one(void **state)
{
    (void)state;
    struct wb_rig rig;
    char text[4096];
    snprintf(text, sizeof text, "%s", edited("  sign: +1\n", "  tare: counterweight\n"));
    char *const at = strstr(text, "counterweight_g: 2.7");
    memcpy(at, "counterweight_g: 0.0", strlen("counterweight_g: 0.0"));
    assert_int_equal(wb_rig_parse(text, "bench.yaml", &rig, NULL), WB_ERR_FORMAT);
    assert_message("tare");
    assert_message("strand.counterweight_g");
}

static void strand_and_limits_are_optional(void **state)
{
    (void)state;
    char text[4096];
    snprintf(text, sizeof text, "%.*s", (int)(strstr(good, "strand:") - good), good);
    const struct wb_rig rig = parse(text);
    assert_close(rig.strand.length, 0.0, 0.0);
    assert_close(rig.limits.force, 0.0, 0.0);
    assert_close(rig.limits.stream_lost, 1.0, 0.0);
}

static void bad_files_are_rejected_with_file_line_and_key(void **state)
{
    (void)state;
    static const struct {
        const char *from, *to, *expected; /* in the message */
    } cases[] = {
        {"  capacity_g: 20\n", "  capacity_kg: 20\n", "bench.yaml:6: capacity_kg: unknown key"},
        {"  capacity_g: 20\n", "", "capacity_g: expected exactly one of"},
        {"  capacity_g: 20\n", "  capacity_g: 20\n  capacity_N: 1\n", "exactly one of"},
        {"  capacity_g: 20\n", "  capacity_g: 20 g\n",
         "bench.yaml:6: capacity_g: expected a plain"},
        {"  capacity_g: 20\n", "  capacity_g: nan\n", "bench.yaml:6: capacity_g"},
        {"  capacity_g: 20\n", "  capacity_g: -20\n", "bench.yaml:6: capacity_g: -20 is out of"},
        {"  overload_percent: 150\n", "  overload_percent: 50\n", "bench.yaml:7: overload_percent"},
        {"  filter_delay_ms: 50\n", "", "filter_delay_ms: this key is missing"},
        {"  sign: +1\n", "  check_masses_g: [5, 10, 0]\n",
         "bench.yaml:14: check_masses_g: expected 0 first"},
        {"2026-01-15", "15.01.2026", "calibration_date: expected a date"},
        {"2026-01-15", "2026-13-15", "calibration_date: expected a date"},
        {"  protocol: generic\n", "  protocol: mettler\n", "bench.yaml:5: protocol: expected one"},
        {"  protocol: generic\n", "  protocol: mt-sics\n",
         "bench.yaml:13: unit: only the generic line protocol"},
        {"address: serial:/dev/ttyUSB0,9600,8n1", "address: /dev/ttyUSB0", "serial: or pty:"},
        {"udp:192.168.1.10:1510", "serial:/dev/ttyS0", "address: expected an address that starts"},
        {"  sign: +1\n", "  sign: 0\n", "sign: expected +1 or -1"},
        {"  down: +1\n", "  down: 0\n", "down: expected +1 or -1"},
        {"  axis: X\n", "  axis: A\n", "bench.yaml:22: axis: expected one of X, Y, Z, not A"},
        {"  up: y\n", "  up: x\n", "bench.yaml:18: up: expected one of y, z"},
        {"  travel_mm: 60\n", "", "travel_mm: this key is missing"},
        {"  axis: X\n", "", "axis: this key is missing: expected X, Y or Z"},
        {"  protocol: grbl\n", "  protocol: tic\n", "axis: a Tic has one axis: remove this key"},
        {"  protocol: grbl\n  axis: X\n", "  protocol: tic\n", "steps_per_mm: this key is missing"},
        {"  speed_mm_s: 1\n", "  speed_mm_s: 0\n", "bench.yaml:25: speed_mm_s: 0 is out of range"},
        {"  counterweight_g: 2.7\n", "", "counterweight_g: this key is missing"},
        {"force_mN: 280", "force_mN: 295", "force_mN: 295 mN is more than the load cell reads"},
        {"  travel_mm: 58\n", "  travel_mm: 61\n", "travel_mm: 61 mm is more than the stage's"},
        {"gravity_m_s2: 9.81\n", "gravity_m_s2: 981\n", "bench.yaml:2: gravity_m_s2"},
        {"gravity_m_s2: 9.81\n", "time_scale: 2\n", "time_scale: only a virtual rig"},
        {"name: paper bench\n", "", "name: this key is missing"},
        {"stage:\n", "stages:\n", "stages: unknown key"},
        {"  sign: +1\n", "  delimiter: ','\n", "delimiter and column belong together"},
        {"  sign: +1\n", "  column: 2\n", "delimiter and column belong together"},
        {"  sign: +1\n", "  delimiter: abc\n  column: 2\n", "delimiter: expected one character"},
        {"  sign: +1\n", "  delimiter: ','\n  column: 2\n  decimal_comma: true\n", "decimal_comma"},
        {"  sign: +1\n", "  poll_command: W\n", "poll_command and poll_period_ms belong together"},
        {"  sign: +1\n", "  poll_period_ms: 50\n", "poll_command and poll_period_ms belong"},
        {"  sign: +1\n", "  poll_command: 'W\\q'\n", "poll_command: expected one of \\r"},
        {"  sign: +1\n", "  tare_command: '\\x00'\n", "tare_command: expected one of \\r"},
        {"  sign: +1\n", "  overload_tokens: OL\n", "overload_tokens: expected a list"},
        {"  sign: +1\n", "  overload_tokens: ['a b']\n", "overload_tokens: expected a word"},
        {"  unit: g\n", "  unit: gramm\n", "unit: expected a unit such as g"},
        {"  sign: +1\n", "  scale: 0\n", "scale: expected a number other than 0"},
        {"  sign: +1\n", "  sign: +1\n  sign: -1\n", "sign: given twice"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct wb_rig rig, before;
        memset(&rig, 0x77, sizeof rig);
        before = rig;
        kept.n = 0;
        assert_int_equal(wb_rig_parse(edited(cases[i].from, cases[i].to), "bench.yaml", &rig, NULL),
                         WB_ERR_FORMAT);
        assert_message(cases[i].expected);
        assert_message("bench.yaml:");
        assert_int_equal(kept.n, 1);
        assert_memory_equal(&rig, &before, sizeof rig); /* results are written on success only */
    }
}

static void balances_reject_generic_keys(void **state)
{
    (void)state;
    char text[4096];
    snprintf(text, sizeof text, "%s", edited("  protocol: generic\n", "  protocol: mt-sics\n"));
    char *const unit = strstr(text, "  unit: g\n");
    memmove(unit, unit + strlen("  unit: g\n"), strlen(unit + strlen("  unit: g\n")) + 1);
    assert_string_equal(parse(text).load_cell.protocol, "mt-sics");
}

static void missing_file_is_named(void **state)
{
    (void)state;
    struct wb_rig rig;
    assert_int_equal(wb_rig_read("/nowhere/bench.yaml", &rig), WB_ERR_NOT_FOUND);
    assert_message("/nowhere/bench.yaml");
}

static void ended_virtual_rig_is_reported(void **state)
{
    (void)state;
    struct wb_rig rig;
    char folder[32], path[64];
    assert_true(temporary_folder_make(folder));
    snprintf(path, sizeof path, "%s/rig.yaml", folder);
    assert_int_equal(wb_rig_read(path, &rig), WB_ERR_NOT_FOUND);
    assert_message("has it said ready?");
    char text[4096];
    snprintf(text, sizeof text, "virtual: true\n%s", good);
    char *const port = strstr(text, "serial:");
    assert_non_null(port);
    memcpy(port, "pty:/dv", 7); /* whatever follows: there is no such port */
    assert_int_equal(wb_file_write(path, text, strlen(text)), WB_OK);
    assert_int_equal(wb_rig_read(path, &rig), WB_ERR_NOT_FOUND);
    assert_non_null(strstr(kept.last, "no longer runs; start it again"));
    assert_int_equal(kept.n, 2);
    unlink(path);
    rmdir(folder);
}

static void series_of_masses_and_its_due_date_are_read(void **state)
{
    (void)state;
    const struct wb_rig rig =
        parse(edited("  sign: +1\n", "  sign: +1\n  check_masses_g: [0, 5, 10.5, 0]\n"
                                     "  check_due_days: 30\n"));
    assert_int_equal(rig.load_cell.n_check_masses, 4);
    assert_close(rig.load_cell.check_masses[2], 10.5e-3, 1e-15);
    assert_close(rig.load_cell.check_due, 30.0 * 86400.0, 1e-9);
    assert_int_equal(parse(good).load_cell.n_check_masses, 0);
    assert_close(parse(good).load_cell.check_due, 0.0, 1e-15);
}

static void checks_after_the_table_give_the_line_of_their_key(void **state)
{
    (void)state;
    struct wb_rig rig;
    char place[64];
    const char *const text = edited("  sign: +1\n", "  sign: 2\n");
    int line = 1;
    for (const char *at = text; at < strstr(text, "sign: 2"); at++)
        line += *at == '\n';
    snprintf(place, sizeof place, "bench.yaml:%d: sign: expected +1 or -1", line);
    assert_int_equal(wb_rig_parse(text, "bench.yaml", &rig, NULL), WB_ERR_FORMAT);
    assert_message(place);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(every_value_arrives_in_si, set_up, tear_down),
        cmocka_unit_test_setup_teardown(uncertainties_are_those_of_the_data, set_up, tear_down),
        cmocka_unit_test_setup_teardown(line_protocol_keys_are_read, set_up, tear_down),
        cmocka_unit_test_setup_teardown(virtual_rigs_are_marked_and_their_truth_is_ignored, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(tare_is_unloaded_unless_it_is_with_the_counterweight,
                                        set_up, tear_down),
        cmocka_unit_test_setup_teardown(tare_with_a_counterweight_needs_one, set_up, tear_down),
        cmocka_unit_test_setup_teardown(strand_and_limits_are_optional, set_up, tear_down),
        cmocka_unit_test_setup_teardown(bad_files_are_rejected_with_file_line_and_key, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(balances_reject_generic_keys, set_up, tear_down),
        cmocka_unit_test_setup_teardown(ended_virtual_rig_is_reported, set_up, tear_down),
        cmocka_unit_test_setup_teardown(series_of_masses_and_its_due_date_are_read, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(checks_after_the_table_give_the_line_of_their_key, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(missing_file_is_named, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
