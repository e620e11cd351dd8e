/* Live views of whole tests on the virtual bench, in virtual time: contents of the view, effects of
 * its keys, and that no view changes a byte of the recording. The test plays the view, at the other
 * end of the feed's socket. */
#include <curses.h>
#include <fcntl.h>
#include <locale.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/file.h"
#include "base/interrupt_private.h"
#include "base/timing.h"
#include "base/units.h"
#include "cli/virtual_test.h"
#include "daq/recording/recording.h"
#include "fe/model/wire.h"
#include "fixtures/virtual/virtual_time_private.h"
#include "live/live_events.h"
#include "live/live_feed.h"
#include "live/live_history.h"
#include "live/live_plan.h"
#include "live/live_screen.h"
#include "live/live_source.h"
#include "tests/folder.h"
#include "tests/messages.h"

#define DATE INT64_C(1795615380)
#define TELL_NS (50 * WB_NS_PER_MS) /* between two frames, as `wirebench record` sends them */
#define TRAVEL_MM 20.0
#define WORDS 16

/* A key pressed by the operator during the test. */
struct press {
    double at; /* s since the test was opened */
    int key;
};

/* One test and its view. */
struct show {
    struct wb_virtual_test virtual;
    struct wb_bend_test_request request;
    struct wb_bend_test *test;
    struct wb_bend_test_result result;
    struct wb_live_feed feed;
    struct wb_live_source source;
    struct wb_live_plan plan;
    struct wb_live_history history;
    int view;                        /* the view's end of the socket; -1: no view */
    bool is_slow;                    /* it reads nothing until the test has ended */
    double dies;                     /* s, when it closes its end; 0: never */
    const struct press *presses;     /* by time, up to a key of 0; NULL: none */
    void (*look)(struct show *show); /* called after each frame; NULL: none */
    /* Seen: */
    enum wb_live_frame_word words[WORDS]; /* each as it changed */
    int n_words;
    int frames, holds;
    double held_longest;
    struct wb_text screen;
    char folder[32], rig[WB_PATH], specimen[WB_PATH], output[64];
};

static int set_up(void **state)
{
    struct show *const show = calloc(1, sizeof *show);
    if (!show || !temporary_folder_make(show->folder))
        return 1;
    snprintf(show->output, sizeof show->output, "%s/test.wbr", show->folder);
    if (wb_file_find_data(show->rig, "fixtures/rigs/paper.yaml") != WB_OK ||
        wb_file_find_data(show->specimen, "fixtures/specimens/type1-L85-1.yaml") != WB_OK)
        return 1;
    wb_bend_test_default_request(&show->request);
    show->request.rig_path = show->rig;
    show->request.specimen_path = show->specimen;
    show->request.output_path = show->output;
    show->request.travel = TRAVEL_MM * WB_MM;
    show->virtual = (struct wb_virtual_test){.settings.seed = 7, .start = DATE};
    show->view = -1;
    wb_interrupt_set(false);
    *state = show;
    return 0;
}

static int tear_down(void **state)
{
    struct show *const show = *state;
    wb_log_set_sink(NULL, NULL);
    if (wb_time_is_virtual()) { /* an assertion has failed */
        (void)!wb_bend_test_close(show->test, NULL);
        wb_virtual_test_end(&show->virtual, &show->request);
    }
    wb_live_history_release(&show->history);
    wb_text_release(&show->screen);
    if (show->view >= 0)
        close(show->view);
    const int removed = temporary_folder_remove(show->folder);
    free(show);
    return removed;
}

/* A view in this process. */
static void connect_view(struct show *show)
{
    const int bytes = 65536;
    int ends[2];
    assert_int_equal(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends), 0);
    assert_int_equal(setsockopt(ends[0], SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes), 0);
    show->feed.view[0] = (struct wb_live_feed_view){.socket = ends[0], .has_ended = true};
    show->feed.n_views = 1;
    show->view = ends[1];
}

static void make_plan(struct show *show)
{
    struct wb_rig rig;
    struct wb_specimen specimen;
    struct wb_wire wire;
    char path[WB_PATH];
    assert_int_equal(wb_bend_test_rig(&show->request, &rig), WB_OK);
    assert_int_equal(wb_bend_test_specimen(&show->request, &specimen), WB_OK);
    assert_int_equal(wb_file_find_data(path, "fixtures/wires/type1.yaml"), WB_OK);
    assert_int_equal(wb_wire_read(path, &wire, NULL), WB_OK);
    assert_int_equal(wb_live_plan_make(&show->plan, &rig, &specimen, &wire, show->request.travel),
                     WB_OK);
    show->plan.title = "type1, 85 mm, sample 1";
    show->plan.recording = show->folder;
    wb_live_source_init(&show->source, &show->feed, &rig, &specimen);
    show->request.sink = wb_live_source_sink(&show->source);
}

static void tell_feed(void *context, enum wb_log_level level, const char *domain,
                      const char *message)
{
    struct show *const show = context;
    (void)domain;
    wb_live_feed_add_message(&show->feed, level, message);
}

static void obey(struct show *show)
{
    switch (wb_live_feed_key(&show->feed)) {
    case 'm':
        wb_bend_test_mark(show->test, "key m");
        break;
    case 'h':
        assert_true(wb_bend_test_hold(show->test));
        break;
    case 'r':
        assert_true(wb_bend_test_resume(show->test));
        break;
    case 'q':
        wb_bend_test_stop(show->test);
        break;
    default:
        break;
    }
}

static void press_keys(struct show *show, double elapsed)
{
    while (show->presses && show->presses->key != 0 && elapsed >= show->presses->at) {
        const struct wb_live_frame_key packet = {
            .header = wb_live_frame_header(WB_LIVE_FRAME_KEY, sizeof packet),
            .key = show->presses++->key};
        assert_int_equal(send(show->view, &packet, sizeof packet, 0), sizeof packet);
    }
}

/* Actions of the view after a frame was sent. */
static void watch(struct show *show)
{
    struct wb_bend_test_status status;
    wb_bend_test_status(show->test, &status);
    if (show->dies > 0.0 && status.elapsed >= show->dies && show->view >= 0) {
        close(show->view);
        show->view = -1;
    }
    if (show->view < 0 || show->is_slow)
        return;
    press_keys(show, status.elapsed);
    assert_true(wb_live_history_receive(&show->history, show->view));
    const struct wb_live_frame *const frame = &show->history.frame;
    assert_int_equal(frame->number, ++show->frames);
    if (show->n_words == 0 || show->words[show->n_words - 1] != frame->word) {
        assert_true(show->n_words < WORDS);
        show->words[show->n_words++] = frame->word;
    }
    if (show->look)
        show->look(show);
}

static void tell(struct show *show)
{
    struct wb_live_frame frame;
    wb_live_source_fill(&show->source, &frame);
    wb_live_feed_push(&show->feed, &frame);
    watch(show);
}

/* The test from its start to its end, with frames sent and keys obeyed as `wirebench record` does.
 */
static void show_test(struct show *show, bool has_view)
{
    int64_t told_ns = 0;
    if (has_view)
        connect_view(show);
    assert_int_equal(wb_virtual_test_begin(&show->virtual, &show->request), WB_OK);
    make_plan(show);
    wb_log_set_sink(tell_feed, show);
    assert_int_equal(wb_bend_test_open(&show->test, &show->request), WB_OK);
    show->source.test = show->test;
    while (wb_bend_test_step(show->test, 20 * WB_NS_PER_MS) == WB_SEQUENCE_RUNNING) {
        if (wb_time_now_ns() - told_ns >= TELL_NS) {
            told_ns = wb_time_now_ns();
            tell(show);
        }
        obey(show);
    }
    tell(show);
    struct wb_bend_test *const test = show->test;
    show->test = NULL;
    assert_int_equal(wb_bend_test_close(test, &show->result), WB_OK);
    wb_log_set_sink(NULL, NULL);
    wb_virtual_test_end(&show->virtual, &show->request);
    wb_live_feed_stop(&show->feed, 0);
    if (show->view >= 0)
        assert_false(wb_live_history_receive(&show->history, show->view));
}

static void assert_words(const struct show *show, int n, const enum wb_live_frame_word *expected)
{
    for (int i = 0; i < n && i < show->n_words; i++)
        assert_string_equal(wb_live_frame_word(show->words[i]), wb_live_frame_word(expected[i]));
    assert_int_equal(show->n_words, n);
}
#define assert_words_are(show, ...)                                                                \
    assert_words(                                                                                  \
        show, sizeof((enum wb_live_frame_word[]){__VA_ARGS__}) / sizeof(enum wb_live_frame_word),  \
        (const enum wb_live_frame_word[]){__VA_ARGS__})

/* --- the screen --- */

/* Draws on a terminal of this size; show->screen receives the text line by line. Returns the number
 * of bytes above 127 that the terminal received. */
static int draw(struct show *show, int rows, int columns, bool is_unicode)
{
    const struct wb_live_screen screen = {&show->plan, &show->history, is_unicode};
    FILE *const out = tmpfile(), *const in = fopen("/dev/null", "r");
    char line[4096];
    int n = 0;
    assert_true(out && in);
    assert_non_null(setlocale(LC_CTYPE, is_unicode ? "C.UTF-8" : "C"));
    SCREEN *const terminal = newterm("xterm", out, in);
    assert_non_null(terminal);
    assert_int_equal(resizeterm(rows, columns), OK);
    wb_live_screen_prepare();
    wb_live_screen_draw(&screen);
    wb_text_release(&show->screen);
    for (int row = 0; row < rows; row++) {
        assert_true(mvinnstr(row, 0, line, sizeof line - 1) >= 0);
        wb_text_append(&show->screen, "%s\n", line);
    }
    endwin();
    delscreen(terminal);
    rewind(out);
    for (int c; (c = fgetc(out)) != EOF;)
        n += c > 127;
    fclose(out);
    fclose(in);
    setlocale(LC_CTYPE, "C");
    return n;
}

static bool shows(const struct show *show, const char *words)
{
    return strstr(wb_text_string(&show->screen), words);
}

static void assert_shows(const struct show *show, const char *words)
{
    if (!shows(show, words))
        fail_msg("no '%s' on the screen:\n%s", words, wb_text_string(&show->screen));
}

/* --- facts --- */

static bool drawn_before, drawn_while_testing, drawn_at_the_end;

static void draw_on_the_way(struct show *show)
{
    const struct wb_live_frame *const frame = &show->history.frame;
    if (frame->number == 1) {
        drawn_before = true;
        assert_true(draw(show, 40, 110, true) > 0);
        assert_shows(show, "connecting");
        assert_shows(show, "connecting");
        assert_shows(show, "not all markers have been seen");
    }
    if (frame->word == WB_LIVE_FRAME_DONE) {
        drawn_at_the_end = true;
        draw(show, 40, 110, true);
        assert_shows(show, "\n done ");
        wb_time_sleep(wb_time_now_ns() + 3 * WB_NS_PER_S);
        draw(show, 40, 110, true);
        assert_shows(show, "NO DATA FOR 3 s");
    }
    if (drawn_while_testing || !(frame->deflection >= 10.0 * WB_MM))
        return;
    drawn_while_testing = true;
    assert_true(draw(show, 40, 110, true) > 0);
    assert_shows(show, "VIRTUAL RIG  type1, 85 mm, sample 1");
    assert_shows(show, "test in progress");
    assert_shows(show, "down, cycle 1 of 1");
    assert_shows(show, "tension, mN over mm");
    assert_shows(show, "(above)");
    assert_shows(show, "the wire, from the clamp");
    assert_shows(show, "●●●●●●●");
    assert_shows(show, "120 Hz, no gaps");
    assert_shows(show, "m  mark this moment    h  hold    q  stop the test");
    const char *const text = wb_text_string(&show->screen);
    bool has_braille = false;
    for (const char *at = text; (at = strchr(at, '\xe2')); at++)
        has_braille |= (unsigned char)at[1] >= 0xa0 && (unsigned char)at[1] <= 0xa3;
    assert_true(has_braille);

    assert_int_equal(draw(show, 40, 110, false), 0);
    assert_shows(show, "test in progress");
    assert_shows(show, "*******");
    draw(show, 15, 60, true);
    assert_shows(show, "enlarge the window to see the curve");
    assert_false(shows(show, "mN over mm"));
    draw(show, 16, 60, true);
    assert_shows(show, "mN over mm");
    draw(show, 90, 300, true);
    assert_shows(show, "tension (mN) over deflection (mm)");
    draw(show, 120, 70, true);
    assert_shows(show, "mN over mm");
    draw(show, 1, 1, true);
    assert_int_equal(strlen(wb_text_string(&show->screen)), 2);
}

static void view_shows_a_test_from_its_start_to_its_end(void **state)
{
    struct show *const show = *state;
    show->look = draw_on_the_way;
    drawn_before = drawn_while_testing = drawn_at_the_end = false;
    show_test(show, true);
    assert_int_equal(show->result.end, WB_SEQUENCE_DONE);
    assert_true(show->result.is_virtual);
    assert_int_equal(show->result.drops, 0);
    for (int role = 0; role < WB_INTERLOCK_ROLES; role++)
        assert_int_equal(show->result.loss[role].missing, 0);
    assert_words_are(show, WB_LIVE_FRAME_CONNECTING, WB_LIVE_FRAME_READY, WB_LIVE_FRAME_TESTING,
                     WB_LIVE_FRAME_DONE);
    assert_true(drawn_before && drawn_while_testing && drawn_at_the_end);

    const struct wb_live_frame *const frame = &show->history.frame;
    assert_int_equal(frame->frames_dropped, 0);
    assert_int_equal(frame->points_dropped, 0);
    assert_close(frame->peak, show->result.peak_tension, 0.0);
    assert_close(frame->time_left, 0.0, 0.0);
    assert_int_equal(show->feed.n_points, show->history.n_points);
    /* 20 points a second, down and up at 1 mm/s, and 2 s at the turn. */
    assert_in_range(show->history.n_points, 20 * 2 * 21, 20 * 2 * 23);
    double largest = 0.0, furthest = 0.0;
    for (size_t i = 0; i < show->history.n_points; i++) {
        assert_int_equal(show->history.points[i].cycle, 1);
        largest = fmax(largest, (double)show->history.points[i].force);
        furthest = fmax(furthest, (double)show->history.points[i].deflection);
    }
    assert_close_relative(largest, show->result.peak_tension, 0.01);
    /* The strand is slack for the first part of the travel. */
    assert_true(furthest > (TRAVEL_MM - 1.5) * WB_MM && furthest < TRAVEL_MM * WB_MM);

    struct wb_live_events_cursor cursor = {0};
    struct wb_text text = {0};
    wb_live_events_append(&cursor, &show->plan, &show->history, true, &text);
    const char *const events = wb_text_string(&text);
    assert_non_null(strstr(events, "\"virtual_rig\": true"));
    assert_non_null(strstr(events, "\"state\": \"done\""));
    assert_non_null(strstr(events, "event: points\ndata: {\"from\": 0, \"points\": [[1,"));
    assert_non_null(strstr(events, "event: end\n"));
    wb_text_release(&text);
}

static char *read_recording(const struct show *show, size_t *n)
{
    FILE *const file = fopen(show->output, "rb");
    assert_non_null(file);
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    *n = (size_t)ftell(file);
    rewind(file);
    char *const bytes = malloc(*n);
    assert_non_null(bytes);
    assert_int_equal(fread(bytes, 1, *n, file), *n);
    fclose(file);
    assert_int_equal(unlink(show->output), 0);
    return bytes;
}

static void no_view_changes_a_byte_of_the_recording(void **state)
{
    struct show *const show = *state;
    char *alone = NULL;
    size_t n_alone = 0;
    for (int kind = 0; kind < 4; kind++) { /* no view; reads all; reads nothing; dies */
        memset(&show->feed, 0, sizeof show->feed);
        wb_live_history_release(&show->history);
        show->frames = show->n_words = 0;
        show->is_slow = kind == 2;
        show->dies = kind == 3 ? 15.0 : 0.0;
        show_test(show, kind > 0);
        assert_int_equal(show->result.end, WB_SEQUENCE_DONE);
        const struct wb_live_feed_view *const view = &show->feed.view[0];
        const uint64_t dropped = view->frames_dropped;
        if (kind == 2) {
            /* The socket contained the first frames, without the last one. */
            assert_true(show->history.has_frame);
            assert_true(dropped > 0);
            assert_int_equal(show->history.frame.number + dropped, show->feed.n_frames);
            assert_int_equal(show->history.frame.frames_dropped, 0);
        }
        if (kind == 3) {
            assert_true(view->is_gone);
            assert_in_range(dropped, 1, show->feed.n_frames - 100);
        }
        if (show->view >= 0)
            close(show->view);
        show->view = -1;
        size_t n;
        char *const bytes = read_recording(show, &n);
        if (kind == 0) {
            alone = bytes;
            n_alone = n;
            continue;
        }
        assert_int_equal(n, n_alone);
        assert_memory_equal(bytes, alone, n);
        free(bytes);
    }
    free(alone);
}

/* Number of events of one kind in the recording, and the text of the last. */
struct found {
    const char *kind;
    int n;
    char text[1024];
};

static enum wb_status find_event(void *context, const struct wb_event *event)
{
    struct found *const found = context;
    if (strcmp(event->kind, found->kind) != 0)
        return WB_OK;
    found->n++;
    snprintf(found->text, sizeof found->text, "%s", event->text);
    return WB_OK;
}

static void assert_recorded_once(const struct show *show, const char *kind, const char *words)
{
    struct wb_recording *recording;
    struct found found = {.kind = kind};
    assert_int_equal(wb_recording_open(&recording, show->output), WB_OK);
    assert_int_equal(wb_recording_each_event(recording, find_event, &found), WB_OK);
    assert_int_equal(wb_recording_close(recording), WB_OK);
    assert_int_equal(found.n, 1);
    if (!strstr(found.text, words))
        fail_msg("%s: '%s' does not say '%s'", kind, found.text, words);
}

static void look_at_hold(struct show *show)
{
    const struct wb_live_frame *const frame = &show->history.frame;
    double held;
    if (frame->word != WB_LIVE_FRAME_HELD || show->holds++ == 0)
        return;
    const char *const at = strstr(frame->text, "held at ");
    if (!at || sscanf(at, "held at %*f mm for %lf s", &held) != 1)
        return;
    show->held_longest = held;
    if (!shows(show, "held at")) {
        draw(show, 40, 110, true);
        assert_shows(show, " held ");
        assert_shows(show, "held at");
        assert_shows(show, "press r to resume, q to end the test");
        assert_shows(show, "r  resume");
    }
}

static void keys_of_the_view_mark_hold_and_resume(void **state)
{
    struct show *const show = *state;
    static const struct press presses[] = {{15.0, 'h'}, {18.0, 'm'}, {25.0, 'r'}, {0.0, 0}};
    show->look = look_at_hold;
    show->presses = presses;
    show_test(show, true);
    assert_int_equal(show->result.end, WB_SEQUENCE_DONE);
    assert_int_equal(show->result.holds, 1);
    assert_close(show->result.held, 10.0, 0.1);
    assert_close(show->held_longest, 10.0, 0.51);
    assert_words_are(show, WB_LIVE_FRAME_CONNECTING, WB_LIVE_FRAME_READY, WB_LIVE_FRAME_TESTING,
                     WB_LIVE_FRAME_HELD, WB_LIVE_FRAME_TESTING, WB_LIVE_FRAME_DONE);
    assert_in_range(show->history.n_points, 20 * 2 * 21, 20 * 2 * 23); /* none while it is held */
    assert_recorded_once(show, "mark", "key m");
    assert_recorded_once(show, "hold_start", "");
    assert_recorded_once(show, "hold_end", "resumed");
}

static void key_q_ends_a_held_test(void **state)
{
    struct show *const show = *state;
    static const struct press presses[] = {{15.0, 'h'}, {18.0, 'q'}, {0.0, 0}};
    show->presses = presses;
    show_test(show, true);
    assert_int_equal(show->result.end, WB_SEQUENCE_INTERRUPTED);
    assert_non_null(strstr(show->result.text, "stopped by the operator"));
    assert_true(show->result.recorded && show->result.standing);
    assert_words_are(show, WB_LIVE_FRAME_CONNECTING, WB_LIVE_FRAME_READY, WB_LIVE_FRAME_TESTING,
                     WB_LIVE_FRAME_HELD, WB_LIVE_FRAME_STOPPED);
    assert_non_null(strstr(show->history.frame.text, "stopped by the operator"));
    assert_recorded_once(show, "hold_end", "stopped");
}

static void hold_that_no_key_ends_is_ended_by_its_limit(void **state)
{
    struct show *const show = *state;
    static const struct press presses[] = {{15.0, 'h'}, {0.0, 0}};
    show->presses = presses;
    show->request.hold_most = 2.0;
    show_test(show, true);
    assert_int_equal(show->result.end, WB_SEQUENCE_INTERRUPTED);
    assert_non_null(strstr(show->result.text, "--hold-most-s"));
    assert_close(show->result.held, 2.0, 0.05);
    assert_recorded_once(show, "hold_end", "stopped");
}

/* Messages of the recorder reach the view in order. */
static void messages_reach_the_view(void **state)
{
    struct show *const show = *state;
    static const struct press presses[] = {{15.0, 'q'}, {0.0, 0}};
    show->presses = presses;
    show->virtual.settings.faults = "garbage=20";
    show_test(show, true);
    assert_int_equal(show->result.end, WB_SEQUENCE_INTERRUPTED);
    assert_true(show->history.n_messages > 0);
    draw(show, 40, 110, true);
    char line[60];
    const int last = (show->history.n_messages - 1) % WB_LIVE_HISTORY_MESSAGES;
    snprintf(line, sizeof line, "%.50s", show->history.message[last].text);
    assert_shows(show, line);
}

#define FACT(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        FACT(view_shows_a_test_from_its_start_to_its_end),
        FACT(no_view_changes_a_byte_of_the_recording),
        FACT(keys_of_the_view_mark_hold_and_resume),
        FACT(key_q_ends_a_held_test),
        FACT(hold_that_no_key_ends_is_ended_by_its_limit),
        FACT(messages_reach_the_view),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
