/* Conditions that prevent a bending test or end it in its first millimetres, each with one message,
 * with a small bench in virtual time. */
#include "daq/stream/stream.h"
#include "tests/daq/bend_fixture.h"

static void edit_rig(const struct fixture *fixture, const char *sed)
{
    char command[256];
    snprintf(command, sizeof command, "sed -i '%s' %s", sed, fixture->rig);
    assert_int_equal(system(command), 0);
}

/* --- start check --- */

static void assert_refused(struct fixture *fixture, const char *words, bool recorded)
{
    struct wb_bend_test *test;
    struct wb_bend_test_result result;
    assert_int_equal(wb_bend_test_open(&test, &fixture->request), WB_OK);
    assert_false(run(test, NULL));
    assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
    assert_int_equal(result.end, WB_SEQUENCE_FAILED);
    if (!strstr(result.text, words))
        fail_msg("'%s' does not contain '%s'", result.text, words);
    assert_false(result.started);
    assert_int_equal(result.recorded, recorded);
    assert_int_equal(access(fixture->output, F_OK) == 0, recorded);
    assert_int_equal(fixture->bench->holds, 0);
}

static void missing_natnet_reply_is_reported_and_leaves_no_file(void **state)
{
    struct fixture *const fixture = *state;
    fixture->bench->mocap_dead = true;
    assert_refused(fixture, "no NatNet reply from sim:fake_mocap", false);
}

static void silent_load_cell_is_reported(void **state)
{
    struct fixture *const fixture = *state;
    fixture->bench->load_silent = true;
    assert_refused(fixture, "sent no data within", false);
}

static void load_cell_with_another_protocol_is_reported(void **state)
{
    struct fixture *const fixture = *state;
    fixture->bench->garbage = true;
    assert_refused(fixture, "no reading that can be decoded", false);
}

static void silent_stage_is_reported(void **state)
{
    struct fixture *const fixture = *state;
    fixture->bench->stage_silent = true;
    assert_refused(fixture, "the stage at sim:fake_stage", false);
}

static void swapped_ports_are_reported(void **state)
{
    struct fixture *const fixture = *state;
    edit_rig(fixture, "s/fake_cell/fake_here/; s/fake_stage/fake_cell/; s/fake_here/fake_stage/");
    assert_refused(fixture, "load_cell.address and stage.address are probably swapped", false);
}

static void stage_set_slower_than_the_test_is_reported(void **state)
{
    struct fixture *const fixture = *state;
    fixture->bench->fastest_mm_min = 30;
    assert_refused(fixture, "($110=30 mm/min): set $110=60", true);
}

static void missing_marker_is_named(void **state)
{
    struct fixture *const fixture = *state;
    fixture->bench->markers = 6;
    assert_refused(fixture, "6 of 7 markers seen", true);
    read_events(fixture);
    assert_non_null(strstr(fixture->events, "check: refused: 6 of 7"));
}

static void stray_reflection_is_tolerated(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    fixture->bench->markers = 9;
    fixture->request.travel = 1.0 * WB_MM;
    assert_int_equal(wb_bend_test_open(&test, &fixture->request), WB_OK);
    assert_false(run(test, NULL));
    assert_int_equal(wb_bend_test_step(test, 0), WB_SEQUENCE_DONE);
    assert_int_equal(wb_bend_test_close(test, NULL), WB_OK);
}

/* In grams the rig file would allow a thousand times the force. */
static void unit_that_contradicts_the_rig_file_is_rejected(void **state)
{
    struct fixture *const fixture = *state;
    edit_rig(fixture, "s/^  noise_mg: 10/  unit: g\\n&/");
    fixture->bench->other_unit = true;
    assert_refused(fixture, "load_cell.unit: g in", true);
    unlink(fixture->output);
    /* Within the cell's range as well. */
    fixture->bench->force_mg = 0;
    assert_refused(fixture, "load_cell.unit: g in", true);
}

/* A converter without a calibration, with and without a unit in the rig file. */
static void raw_counts_are_reported_with_the_keys_to_set(void **state)
{
    struct fixture *const fixture = *state;
    fixture->bench->raw_counts = true;
    assert_refused(fixture, "load_cell.unit", false);
    edit_rig(fixture, "s/^  noise_mg: 10/  unit: g\\n&/");
    assert_refused(fixture, "load_cell.scale", false);
}

static void loaded_zero_is_rejected(void **state)
{
    struct fixture *const fixture = *state;
    fixture->bench->force_mg = 2700;
    assert_refused(fixture, "the unloaded load cell reads 26", true);
}

static void stage_in_alarm_or_on_hold_is_rejected_with_the_remedy(void **state)
{
    struct fixture *const fixture = *state;
    char words[160];
    fixture->bench->state = "Alarm";
    snprintf(words, sizeof words, "'wirebench stage %s unlock'", fixture->rig);
    assert_refused(fixture, words, true);
    unlink(fixture->output);
    fixture->bench->state = "Hold:0";
    snprintf(words, sizeof words, "'wirebench stage %s release'", fixture->rig);
    assert_refused(fixture, words, true);
}

static void tare_with_the_counterweight_adds_its_weight(void **state)
{
    struct fixture *const fixture = *state;
    struct fake_bench *const bench = fixture->bench;
    struct wb_bend_test *test;
    struct wb_bend_test_result result;
    FILE *const file = fopen(fixture->rig, "a");
    assert_non_null(file);
    fputs("strand:\n  length_mm: 760\n  counterweight_g: 2.7\n", file);
    fclose(file);
    edit_rig(fixture, "s/noise_mg: 10/noise_mg: 10\\n  tare: counterweight/");
    fixture->request.travel = 8.0 * WB_MM;
    assert_refused(fixture, "expected the counterweight's 26.48 mN", true);
    unlink(fixture->output);
    bench->force_mg = 2800;
    assert_int_equal(wb_bend_test_open(&test, &fixture->request), WB_OK);
    assert_false(run(test, NULL));
    assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
    assert_int_equal(result.end, WB_SEQUENCE_DONE);
    assert_close(result.tare, 2.8e-3 * WB_STANDARD_GRAVITY, 0.01e-3 * WB_STANDARD_GRAVITY);
    assert_close(result.peak_tension, 6.7e-3 * WB_STANDARD_GRAVITY, 0.05e-3 * WB_STANDARD_GRAVITY);
}

/* --- opening --- */

static void assert_not_opened(struct fixture *fixture, enum wb_status expected, const char *words)
{
    struct wb_bend_test *test = NULL;
    fixture->errors[0] = '\0';
    assert_int_equal(wb_bend_test_open(&test, &fixture->request), expected);
    assert_null(test);
    if (!strstr(fixture->errors, words))
        fail_msg("'%s' does not contain '%s'", fixture->errors, words);
    /* One message, no more. */
    assert_ptr_equal(strchr(fixture->errors, '\n'), fixture->errors + strlen(fixture->errors) - 1);
}

static void missing_port_gives_one_message(void **state)
{
    struct fixture *const fixture = *state;
    edit_rig(fixture, "s/fake_cell/no_such_cell/");
    assert_not_opened(fixture, WB_ERR_NOT_FOUND, "'sim:no_such_cell' does not exist");
    edit_rig(fixture, "s:sim.no_such_cell:pty\\:/dev/pts/no-such:");
    assert_not_opened(fixture, WB_ERR_NOT_FOUND, "/dev/pts/no-such");
    assert_int_not_equal(access(fixture->output, F_OK), 0);
}

static void busy_port_gives_one_message(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_stream *other;
    assert_int_equal(wb_stream_open(&other, "sim:fake_stage"), WB_OK);
    assert_not_opened(fixture, WB_ERR_BUSY, "'sim:fake_stage' is in use");
    wb_stream_close(other);
    assert_int_not_equal(access(fixture->output, F_OK), 0);
}

static void existing_recording_is_never_overwritten(void **state)
{
    struct fixture *const fixture = *state;
    FILE *const file = fopen(fixture->output, "w");
    assert_non_null(file);
    fputs("precious", file);
    fclose(file);
    assert_not_opened(fixture, WB_ERR_EXISTS, "never overwritten");
}

static void excessive_travel_is_rejected_before_opening_instruments(void **state)
{
    struct fixture *const fixture = *state;
    fixture->request.travel = 59.0 * WB_MM;
    assert_not_opened(fixture, WB_ERR_ARGUMENT, "not 59 mm (--travel-mm)");
    fixture->request.travel = (double)NAN;
    assert_not_opened(fixture, WB_ERR_ARGUMENT, "not nan mm (--travel-mm)");
}

static void unwritable_folder_gives_one_message(void **state)
{
    struct fixture *const fixture = *state;
    fixture->request.output_path = "/no/such/folder/test.wbr";
    struct wb_bend_test *test = NULL;
    assert_int_not_equal(wb_bend_test_open(&test, &fixture->request), WB_OK);
    assert_non_null(strstr(fixture->errors, "/no/such/folder/test.wbr"));
}

/* --- first millimetres --- */

static void implausible_first_force_ends_the_test(void **state)
{
    struct fixture *const fixture = *state;
    static const struct {
        int spring_mg_mm;
        double lowest, highest; /* N/m; 500 mg/mm are 4.9 */
        const char *word;       /* NULL: nothing is wrong */
    } cases[] = {{500, 1.6, 15.0, NULL},
                 {500, 0.0, 0.0, NULL},
                 {-500, 0.0, 0.0, "load_cell.sign"},
                 {500, 0.0016, 0.015, "at most 0.015 by a known wire"},
                 {500, 50.0, 450.0, "at least 50 by a known wire"},
                 {0, 1.6, 15.0, "shows no force"}};
    fixture->request.travel = 20.0 * WB_MM;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct fake_bench *const bench = fixture->bench;
        struct wb_bend_test *test;
        struct wb_bend_test_result result;
        unlink(fixture->output);
        bench->spring_mg_mm = cases[i].spring_mg_mm;
        fixture->request.stiffness =
            (struct wb_first_force_bounds){cases[i].lowest, cases[i].highest, "a known wire"};
        assert_int_equal(wb_bend_test_open(&test, &fixture->request), WB_OK);
        assert_false(run(test, NULL));
        assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
        read_events(fixture);
        if (!cases[i].word) {
            assert_int_equal(result.end, WB_SEQUENCE_DONE);
            assert_non_null(strstr(fixture->events, "first_force: the force rises by"));
            continue;
        }
        if (result.end != WB_SEQUENCE_FAILED || !strstr(result.text, cases[i].word))
            fail_msg("case %zu: ended with '%s'", i, result.text);
        assert_true(result.standing);
        /* The whole test goes farther. */
        assert_in_range((int)bench->position_mm, 2, 17);
        assert_null(strstr(fixture->events, "first_force"));
        renew(fixture, 60.0);
    }
}

static void specimen_that_breaks_ends_the_test_at_once(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    struct wb_bend_test_result result;
    fixture->request.travel = 45.0 * WB_MM;
    fixture->bench->spring_mg_mm = 100;
    fixture->bench->breaks_mm = 20;
    assert_int_equal(wb_bend_test_open(&test, &fixture->request), WB_OK);
    assert_false(run(test, NULL));
    assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
    assert_int_equal(result.end, WB_SEQUENCE_LIMIT);
    assert_non_null(strstr(result.text, "limits.force_drop_percent"));
    assert_true(result.standing && result.displaced);
    assert_in_range((int)fixture->bench->position_mm, 20, 30);
    read_events(fixture);
    assert_non_null(strstr(fixture->events, "\"reason\": \"force_drop\""));
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(missing_natnet_reply_is_reported_and_leaves_no_file),
        TEST(silent_load_cell_is_reported),
        TEST(load_cell_with_another_protocol_is_reported),
        TEST(silent_stage_is_reported),
        TEST(swapped_ports_are_reported),
        TEST(stage_set_slower_than_the_test_is_reported),
        TEST(missing_marker_is_named),
        TEST(stray_reflection_is_tolerated),
        TEST(unit_that_contradicts_the_rig_file_is_rejected),
        TEST(raw_counts_are_reported_with_the_keys_to_set),
        TEST(loaded_zero_is_rejected),
        TEST(stage_in_alarm_or_on_hold_is_rejected_with_the_remedy),
        TEST(tare_with_the_counterweight_adds_its_weight),
        TEST(missing_port_gives_one_message),
        TEST(busy_port_gives_one_message),
        TEST(existing_recording_is_never_overwritten),
        TEST(excessive_travel_is_rejected_before_opening_instruments),
        TEST(unwritable_folder_gives_one_message),
        TEST(implausible_first_force_ends_the_test),
        TEST(specimen_that_breaks_ends_the_test_at_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
