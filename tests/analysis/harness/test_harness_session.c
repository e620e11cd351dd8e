/* A session, step by step and by lines of JSON. */
#include "analysis/harness/harness_follow.h"
#include "analysis/harness/harness_session_private.h"

#include <string.h>

#include "base/vec3.h"
#include "tests/analysis/harness/harness_text.h"
#include "tests/own_folder.h"

static const struct wb_harness_settings yielding = {.torsion = 1.0};

/* The steps of harness_lines as lines of JSON. */
static const char *const lines[] = {
    "\"hang\"",
    "{\"mount\": \"C1\", \"at_mm\": [190, 0, 30], \"direction\": [1, 0.2, 0.2]}\n",
    "{\"move\":\"C1\",\"at_mm\":[190.0,2e1,30]}",
    "{\"release\": \"C1\", \"shapes\": false}",
    "{\"take_off\": true}",
};

enum {
    STEPS = sizeof lines / sizeof lines[0]
};

static struct wb_harness_plan *plan;
static struct wb_harness_session *session;
static struct wb_json *answer;

static int begin(void **state)
{
    char file[64];
    if (make_folder(state) != 0)
        return -1;
    snprintf(file, sizeof file, "%s/h.yaml", folder);
    plan = make_plan();
    write_harness(file, 0, NULL);
    return wb_harness_file_read(plan, file) == WB_OK ? 0 : -1;
}

static int end(void **state)
{
    free(plan);
    return remove_folder(state);
}

static int open_session(void **unused)
{
    (void)unused;
    return wb_harness_session_create(&session, plan, &yielding) == WB_OK ? 0 : -1;
}

static int close_session(void **unused)
{
    (void)unused;
    wb_harness_session_destroy(session);
    wb_json_destroy(answer);
    answer = NULL;
    return 0;
}

static bool stop_at_once(void *context, double fraction)
{
    (void)context, (void)fraction;
    return false;
}

/* The answer to a line, which must be one line; valid until the next. */
static bool ask(const char *line, bool (*watch)(void *context, double fraction))
{
    struct wb_text text = {0};
    const bool goes_on = wb_harness_follow_answer(session, line, watch, NULL, &text);
    const char *const bytes = wb_text_string(&text);
    assert_ptr_equal(strchr(bytes, '\n'), bytes + text.length - 1);
    wb_json_destroy(answer);
    answer = NULL;
    assert_int_equal(wb_json_parse(&answer, bytes, "answer"), WB_OK);
    wb_text_release(&text);
    return goes_on;
}

static void ask_without_error(const char *line)
{
    const char *error;
    assert_true(ask(line, NULL));
    if (wb_json_get_text(answer, "error", &error))
        fail_msg("%s: %s", line, error);
}

static void check_number(int number)
{
    int64_t state;
    assert_true(wb_json_get_integer(answer, "state", &state));
    assert_int_equal(state, number);
    assert_int_equal(wb_harness_session_state(session)->number, number);
}

/* --- states --- */

/* A copy of all results of a state, without padding between numbers that matter. */
struct results {
    int number;
    struct wb_harness_force forces[4];
    struct wb_harness_branch_result branches[3];
    struct wb_harness_place places[500];
    double elastic, plastic;
    struct wb_rod_node items[4];
    struct wb_harness_assembly assembly;
};

static struct results *take(void)
{
    const struct wb_harness_session_state *const state = wb_harness_session_state(session);
    struct results *const r = calloc(1, sizeof *r);
    const size_t n = (size_t)wb_harness_session_n_places(session);
    assert_non_null(r);
    assert_true(n <= 500 && plan->n_items == 4 && plan->n_branches == 3);
    r->number = state->number;
    memcpy(r->forces, state->result.forces, sizeof r->forces);
    memcpy(r->branches, state->result.branches, sizeof r->branches);
    memcpy(r->places, state->result.places, n * sizeof *r->places);
    r->elastic = state->result.elastic;
    r->plastic = state->result.plastic;
    for (int i = 0; i < 4; i++)
        r->items[i] = wb_harness_session_item(session, i);
    r->assembly = state->assembly;
    return r;
}

static void check_same(const struct results *expected)
{
    struct results *const r = take();
    assert_memory_equal(r, expected, sizeof *r);
    free(r);
}

static void lines_give_the_results_of_the_file_bit_for_bit(void **unused)
{
    (void)unused;
    struct wb_harness_result_set set;
    assert_int_equal(plan->n_steps, STEPS);
    assert_int_equal(wb_harness_run_compute(&set, plan, &yielding, NULL, NULL), WB_OK);
    for (int i = 0; i < STEPS; i++) {
        const struct wb_harness_step_result *const expected = &set.results[i];
        ask_without_error(lines[i]);
        check_number(i + 1);
        const struct wb_harness_step_result *const r = &wb_harness_session_state(session)->result;
        assert_memory_equal(r->places, expected->places, (size_t)set.n_places * sizeof *r->places);
        assert_memory_equal(r->branches, expected->branches, 3 * sizeof *r->branches);
        for (int k = 0; k < plan->n_items; k++) {
            assert_memory_equal(r->forces[k].force, expected->forces[k].force,
                                sizeof r->forces[k].force);
            assert_memory_equal(r->forces[k].moment, expected->forces[k].moment,
                                sizeof r->forces[k].moment);
            assert_true(r->forces[k].largest == expected->forces[k].largest);
        }
    }
    wb_harness_run_release(&set);
}

static void undone_steps_leave_no_trace(void **unused)
{
    (void)unused;
    struct results *states[STEPS + 1];
    for (int i = 0; i <= STEPS; i++) {
        states[i] = take();
        if (i < STEPS)
            ask_without_error(lines[i]);
    }
    for (int n = 1; n <= STEPS; n++) {
        char undo[40];
        snprintf(undo, sizeof undo, "{\"undo\": %d}", n);
        ask_without_error(undo);
        check_number(STEPS - n);
        check_same(states[STEPS - n]);
        for (int i = STEPS - n; i < STEPS; i++)
            ask_without_error(lines[i]);
        check_same(states[STEPS]);
    }
    for (int i = 0; i <= STEPS; i++)
        free(states[i]);
}

static void snapshots_are_restored_and_a_restored_one_is_undone(void **unused)
{
    (void)unused;
    ask_without_error(lines[0]);
    ask_without_error("{\"snapshot\": \"hanging\"}");
    check_number(1);
    struct results *const hanging = take();
    ask_without_error(lines[1]);
    struct results *const mounted = take();
    ask_without_error("{\"restore\": \"hanging\"}");
    check_same(hanging);
    ask_without_error(lines[1]);
    check_same(mounted);
    ask_without_error("{\"undo\": 1}");
    check_same(hanging);
    ask_without_error("{\"undo\": 1}");
    check_same(mounted);
    ask_without_error("{\"snapshot\": \"hanging\"}");
    ask_without_error("{\"undo\": 2}");
    check_number(0);
    ask_without_error("{\"restore\": \"hanging\"}");
    check_same(mounted);
    free(hanging);
    free(mounted);
}

static void oldest_states_are_given_up(void **unused)
{
    (void)unused;
    const char *error;
    ask_without_error("{\"steps\": 2}");
    struct results *kept = NULL;
    for (int i = 0; i < WB_HARNESS_SESSION_UNDO + 3; i++) {
        char line[80];
        if (i == 3)
            kept = take();
        snprintf(line, sizeof line, "{\"move\": \"C1\", \"at_mm\": [190, %g, 30]}", 0.1 * i);
        ask_without_error(line);
    }
    ask_without_error("{\"undo\": 100}");
    check_number(5);
    check_same(kept);
    free(kept);
    ask("{\"undo\": 1}", NULL);
    assert_true(wb_json_get_text(answer, "error", &error));
    assert_non_null(strstr(error, "undo: no change to undo"));
}

static void fewer_large_states_are_kept(void **unused)
{
    (void)unused;
    assert_int_equal(wb_harness_session_most_undo(1000), 100);
    assert_int_equal(wb_harness_session_most_undo(5 << 20), 100);
    assert_int_equal(wb_harness_session_most_undo(64 << 20), 8);
    assert_int_equal(wb_harness_session_most_undo(1000 << 20), 2);
}

static void step_that_was_stopped_can_be_undone(void **unused)
{
    (void)unused;
    bool converged = true;
    double fraction;
    ask_without_error(lines[0]);
    struct results *const hanging = take();
    assert_true(ask(lines[1], stop_at_once));
    assert_true(wb_json_get_boolean(answer, "converged", &converged) && !converged);
    assert_true(wb_json_get_number(answer, "fraction", &fraction) && fraction < 1.0);
    check_number(2);
    /* The clip holds the wire where it got to. */
    const struct wb_harness_session_state *const state = wb_harness_session_state(session);
    const struct wb_rod_node clip = wb_harness_session_item(session, 3);
    assert_true(state->assembly.is_mounted[3] && state->result.forces[3].is_mounted);
    assert_true(wb_vec3_distance(state->assembly.place[3], clip.position) == 0.0);
    assert_true(wb_vec3_distance(clip.position, (const double[]){0.19, 0.0, 0.03}) > 1e-3);
    ask_without_error(lines[2]);
    ask_without_error("{\"undo\": 2}");
    check_same(hanging);
    free(hanging);
}

/* --- lines --- */

/* After lines[0] and lines[1]: R and C1 are mounted. */
static const struct {
    const char *line, *error;
} wrong[] = {
    {"", "the line is empty: expected an object"},
    {" \n", "the line is empty: expected an object"},
    {"{\"move\": \"C1\"", "did not find expected ',' or '}'"},
    {"[1, 2]",
     "expected an object with one of the keys mount, move, release, hang, take_off, steps, undo"},
    {"{\"movee\": \"C1\"}", "expected an object with one of the keys mount, move"},
    {"\"hung\"", "'hung': expected an object with one of the keys mount"},
    {"\"hang\"", "the harness hangs already"},
    {"{\"hang\": true}", "the harness hangs already"},
    {"{\"hang\": false}", "hang: expected true"},
    {"{\"hang\": true, \"at_mm\": [1, 2, 3]}", "at_mm: unknown key"},
    {"{\"mount\": \"C1\", \"at_mm\": [190, 0, 30]}",
     "mount: C1 is mounted already; `move` moves it"},
    {"{\"mount\": \"X\", \"at_mm\": [190, 0, 30]}",
     "mount: no connector, clip or root is named 'X'"},
    {"{\"mount\": [], \"at_mm\": [190, 0, 30]}", "mount: no connector, clip or root is named ''"},
    {"{\"move\": \"K1\", \"at_mm\": [190, 0, 30]}", "move: K1 is not mounted"},
    {"{\"move\": \"C1\"}", "at_mm: this key is missing"},
    {"{\"move\": \"C1\", \"at_mm\": [190, 0]}", "at_mm: 2 numbers given, expected 3"},
    {"{\"move\": \"C1\", \"at_mm\": 190}", "at_mm: expected a list of numbers"},
    {"{\"move\": \"C1\", \"at_mm\": [190, 0, null]}", "at_mm: expected a plain number"},
    {"{\"move\": \"C1\", \"at_mm\": [190, 0, 1e9]}", "at_mm: 1e9 is out of range"},
    {"{\"move\": \"C1\", \"at_mm\": [190, 0, 130]}",
     "at_mm: C1 to R: 230.2 mm apart, 200 mm of wire"},
    {"{\"move\": \"C1\", \"at_mm\": [1, 0, 0], \"speed\": 1}",
     "speed: unknown key; known here: move"},
    {"{\"move\": \"C1\", \"move\": \"C1\", \"at_mm\": [1, 0, 0]}", "move: given twice"},
    {"{\"move\": \"C1\", \"release\": \"C1\", \"at_mm\": [1, 0, 0]}",
     "move: unknown key; known here: release"},
    {"{\"move\": \"C1\", \"at_mm\": [1, 0, 0], \"direction\": [0, 0, 0]}",
     "direction: a direction has a length above 0"},
    {"{\"move\": \"C1\", \"at_mm\": [1, 0, 0], \"direction\": [1, 0, 0], \"up\": [0, 0, 1]}",
     "up: C1 lets the wire turn about its axis"},
    {"{\"mount\": \"K1\", \"at_mm\": [400, 0, 0], \"up\": [0, 0, 1]}",
     "up: expected a `direction` beside it"},
    {"{\"mount\": \"K1\", \"at_mm\": [400, 0, 0], \"direction\": [0, 0, 2], \"up\": [0, 0, 1]}",
     "direction: it is parallel to `up`"},
    {"{\"release\": \"K2\"}", "release: K2 is not mounted"},
    {"{\"release\": \"C1\", \"at_mm\": [1, 0, 0]}", "at_mm: unknown key; known here: release"},
    {"{\"undo\": 0}", "undo: 0 is out of range, expected 1 to 100"},
    {"{\"undo\": 3}", "undo: 3: expected 1 to 2, the number of changes kept"},
    {"{\"undo\": 1.5}", "undo: expected a whole number"},
    {"{\"undo\": true}", "undo: expected a whole number"},
    {"{\"snapshot\": \"\"}", "snapshot: expected a name of 1 to 39 bytes"},
    {"{\"snapshot\": 5, \"name\": 1}", "name: unknown key"},
    {"{\"restore\": \"a\"}", "restore: no snapshot is named 'a'"},
    {"{\"steps\": 0}", "steps: 0 is out of range, expected 1 to 5"},
    {"{\"steps\": \"some\"}", "steps: expected a whole number"},
    {"{\"steps\": 1}", "steps: step 1, hang: the harness hangs already"},
    {"{\"state\": 1}", "state: expected true or false"},
    {"{\"describe\": false}", "describe: expected true"},
    {"{\"quit\": false}", "quit: expected true"},
    {"{\"state\": true, \"shapes\": \"some\"}", "shapes: expected one of false, true, all"},
    {"{\"move\": \"C1\", \"at_mm\": [1, 0, 0], \"shapes\": 1}", "shapes: expected one of false"},
};

static void wrong_lines_are_answered_with_an_error_and_change_nothing(void **unused)
{
    (void)unused;
    ask_without_error("{\"steps\": 2}");
    struct results *const before = take();
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        const char *error = "no error";
        assert_true(ask(wrong[i].line, NULL));
        (void)wb_json_get_text(answer, "error", &error);
        if (strncmp(error, wrong[i].error, strlen(wrong[i].error)) != 0)
            fail_msg("%s: '%s', expected '%s'", wrong[i].line, error, wrong[i].error);
        check_number(2);
        check_same(before);
    }
    free(before);
}

static void nothing_follows_after_take_off_but_an_undo(void **unused)
{
    (void)unused;
    const char *error;
    ask_without_error("{\"steps\": \"all\"}");
    check_number(STEPS);
    assert_true(ask(lines[1], NULL));
    assert_true(wb_json_get_text(answer, "error", &error));
    assert_string_equal(error, "`take_off` is the last step");
    ask_without_error("{\"undo\": 1}");
    ask_without_error(lines[STEPS - 1]);
}

static void last_hold_is_not_released(void **unused)
{
    (void)unused;
    const char *error;
    assert_true(ask("{\"release\": \"R\"}", NULL));
    assert_true(wb_json_get_text(answer, "error", &error));
    assert_non_null(strstr(error, "release: nothing would be held"));
}

static void answer_has_as_much_of_the_shapes_as_is_asked_for(void **unused)
{
    (void)unused;
    ask_without_error("{\"state\": true}");
    const struct wb_json *const shapes = wb_json_get(answer, "shapes");
    assert_int_equal(wb_json_length(shapes), 3);
    const struct wb_json *const last = wb_json_item(shapes, 2);
    const size_t n = wb_json_length(wb_json_get(last, "s_mm"));
    double s;
    assert_true(n > 10 && n == wb_json_length(wb_json_get(last, "z_mm")));
    assert_true(wb_json_number(wb_json_item(wb_json_get(last, "s_mm"), n - 1), &s));
    assert_close(s, 250.0, 1e-9);
    assert_null(wb_json_get(last, "moment_N_mm"));
    ask_without_error("{\"state\": true, \"shapes\": \"all\"}");
    const struct wb_json *const all = wb_json_item(wb_json_get(answer, "shapes"), 2);
    assert_int_equal(wb_json_length(wb_json_get(all, "moment_N_mm")), n);
    assert_int_equal(wb_json_length(wb_json_get(all, "direction_x")), n);
    ask_without_error("{\"state\": true, \"shapes\": false}");
    assert_null(wb_json_get(answer, "shapes"));
    assert_int_equal(wb_json_length(wb_json_get(answer, "items")), 4);
}

static void description_has_what_a_scene_needs(void **unused)
{
    (void)unused;
    const char *text;
    double number;
    ask_without_error("{\"describe\": true}");
    check_number(0);
    const struct wb_json *const branch = wb_json_item(wb_json_get(answer, "branches"), 1);
    assert_true(wb_json_get_text(branch, "wire", &text));
    assert_string_equal(text, "lead");
    assert_true(wb_json_get_number(branch, "outer_diameter_mm", &number));
    assert_close(number, 1.4, 1e-12);
    const struct wb_json *const clip = wb_json_item(wb_json_get(answer, "items"), 3);
    assert_true(wb_json_get_text(clip, "holds", &text));
    assert_string_equal(text, "axis");
    assert_true(wb_json_get_text(clip, "branch", &text));
    assert_string_equal(text, "B1");
    assert_int_equal(wb_json_length(wb_json_get(answer, "steps")), STEPS);
}

static void quit_ends_the_session(void **unused)
{
    (void)unused;
    bool quits = false;
    assert_false(ask("{\"quit\": true}", NULL));
    assert_true(wb_json_get_boolean(answer, "quit", &quits) && quits);
}

#define FACT(fact) cmocka_unit_test_setup_teardown(fact, open_session, close_session)

int main(void)
{
    const struct CMUnitTest tests[] = {
        FACT(lines_give_the_results_of_the_file_bit_for_bit),
        FACT(undone_steps_leave_no_trace),
        FACT(snapshots_are_restored_and_a_restored_one_is_undone),
        FACT(oldest_states_are_given_up),
        FACT(fewer_large_states_are_kept),
        FACT(step_that_was_stopped_can_be_undone),
        FACT(wrong_lines_are_answered_with_an_error_and_change_nothing),
        FACT(nothing_follows_after_take_off_but_an_undo),
        FACT(last_hold_is_not_released),
        FACT(answer_has_as_much_of_the_shapes_as_is_asked_for),
        FACT(description_has_what_a_scene_needs),
        FACT(quit_ends_the_session),
    };
    return cmocka_run_group_tests(tests, begin, end);
}
