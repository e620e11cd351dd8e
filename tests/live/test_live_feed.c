/* The recorder's side of live views: it never waits for a view, and losses are counted. The views
 * here are small programs that store what they receive in shared memory. */
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "live/live_feed.h"
#include "live/live_history.h"
#include "tests/check.h"

#define PUSHES 100000

/* Data received by a view. */
struct seen {
    volatile int frames, points, is_in_order, began, stops, sends;
    volatile uint64_t last_number, told_dropped;
};

static struct seen *seen;
static struct wb_live_feed *feed;

static int set_up(void **state)
{
    (void)state;
    seen = mmap(NULL, sizeof *seen, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    feed = calloc(1, sizeof *feed);
    signal(SIGPIPE, SIG_DFL); /* the feed must work without ignoring it */
    alarm(50);                /* ends a hanging test */
    return seen == MAP_FAILED || !feed;
}

static int tear_down(void **state)
{
    (void)state;
    alarm(0);
    wb_live_feed_stop(feed, 1000);
    free(feed);
    return munmap(seen, sizeof *seen);
}

/* Counts frames and points until the recorder has ended. Stops itself first, or sends a key. */
static int count_all(int socket, void *context)
{
    struct seen *const s = context;
    struct wb_live_frame frame;
    s->is_in_order = 1;
    if (s->sends) {
        const struct wb_live_frame_key key = {
            .header = wb_live_frame_header(WB_LIVE_FRAME_KEY, sizeof key), .key = s->sends};
        (void)!send(socket, &key, sizeof key, 0);
    }
    const int stops = s->stops;
    s->began = 1;
    if (stops)
        raise(SIGSTOP);
    while (recv(socket, &frame, sizeof frame, 0) == (ssize_t)sizeof frame) {
        s->is_in_order &= frame.number > s->last_number;
        s->last_number = frame.number;
        s->told_dropped = frame.frames_dropped;
        for (int i = 0; i < frame.n_points; i++)
            s->is_in_order &= frame.point[i].cycle == s->points++;
        s->frames++;
    }
    return 0;
}

static int end_at_once(int socket, void *context)
{
    (void)socket;
    (void)context;
    raise(SIGKILL);
    return 0;
}

static void start(int (*run)(int, void *))
{
    int index;
    assert_int_equal(wb_live_feed_start(feed, run, seen, &index), WB_OK);
}

static void wait_until_stopped(int index)
{
    int status;
    const pid_t process = feed->view[index].process;
    assert_int_equal(waitpid(process, &status, WUNTRACED), process);
    assert_true(WIFSTOPPED(status));
}

static void push(int n)
{
    struct wb_live_frame frame = {0};
    for (int i = 0; i < n; i++)
        wb_live_feed_push(feed, &frame);
}

static void add_points(int from, int n)
{
    for (int i = from; i < from + n; i++)
        wb_live_feed_add_point(feed, &(struct wb_live_frame_point){0.0f, 0.0f, i});
}

/* Pushes frames at the pace of the view until it has received this many points. */
static void push_until_points(int n)
{
    while (seen->points < n) {
        push(1);
        (void)poll(NULL, 0, 1);
    }
}

static void stopped_view_causes_no_delay_and_its_frames_are_counted(void **state)
{
    (void)state;
    seen->stops = 1;
    start(count_all);
    wait_until_stopped(0);
    push(PUSHES);
    const uint64_t dropped = feed->view[0].frames_dropped;
    assert_in_range(dropped, 1, PUSHES - 1);
    assert_int_equal(kill(feed->view[0].process, SIGCONT), 0);
    wb_live_feed_stop(feed, 20000);
    assert_int_equal(seen->frames + (int)dropped, PUSHES);
    assert_true(seen->is_in_order);
    assert_true(feed->view[0].ended_well);
}

static void points_wait_for_a_view_that_was_slow(void **state)
{
    (void)state;
    seen->stops = 1;
    start(count_all);
    wait_until_stopped(0);
    for (int i = 0; i < 10; i++) {
        add_points(i * 300, 300);
        push(300);
    }
    assert_true(feed->view[0].frames_dropped > 0);
    assert_int_equal(kill(feed->view[0].process, SIGCONT), 0);
    push_until_points(3000);
    assert_int_equal(feed->view[0].points_dropped, 0);
    assert_true(seen->is_in_order);
    assert_true(seen->told_dropped > 0);
}

static void points_beyond_the_ring_are_dropped_oldest_first_and_counted(void **state)
{
    (void)state;
    seen->stops = 1;
    start(count_all);
    wait_until_stopped(0);
    add_points(0, WB_LIVE_FEED_RING + 123);
    push(1);
    assert_int_equal(feed->view[0].points_dropped, 123);
    assert_int_equal(feed->view[0].sent_points, 123 + WB_LIVE_FRAME_POINTS);
}

static void killed_view_is_noticed_without_other_effects(void **state)
{
    (void)state;
    start(end_at_once);
    while (!wb_live_feed_has_ended(feed, 0))
        (void)poll(NULL, 0, 1);
    push(10);
    wb_live_feed_add_message(feed, WB_LOG_INFO, "nobody hears this");
    assert_true(feed->view[0].is_gone);
    assert_false(feed->view[0].ended_well);
    assert_int_equal(wb_live_feed_key(feed), 0);
    assert_int_equal(feed->view[0].frames_dropped, 10);
}

static void dead_view_does_not_affect_the_other(void **state)
{
    (void)state;
    start(end_at_once);
    start(count_all);
    while (!wb_live_feed_has_ended(feed, 0))
        (void)poll(NULL, 0, 1);
    add_points(0, 10);
    push_until_points(10);
    wb_live_feed_stop(feed, 20000);
    assert_true(seen->is_in_order);
    assert_true(feed->view[1].ended_well);
}

static volatile pid_t first_view, second_view;

/* The first view has seen the end of the recorder: do not wait for the other. */
static void kill_second(int number, siginfo_t *info, void *context)
{
    (void)number, (void)context;
    if (info->si_pid == first_view && info->si_code == CLD_EXITED)
        kill(second_view, SIGKILL);
}

static void view_detects_the_end_of_the_recorder_independent_of_others(void **state)
{
    (void)state;
    struct sigaction action = {.sa_sigaction = kill_second, .sa_flags = SA_SIGINFO}, before;
    sigemptyset(&action.sa_mask);
    /* The second view is stopped: it must not keep the first one's socket open. */
    start(count_all);
    while (!seen->began)
        (void)poll(NULL, 0, 1);
    seen->stops = 1;
    start(count_all);
    wait_until_stopped(1);
    first_view = feed->view[0].process;
    second_view = feed->view[1].process;
    assert_int_equal(sigaction(SIGCHLD, &action, &before), 0);
    wb_live_feed_stop(feed, 40000);
    assert_int_equal(sigaction(SIGCHLD, &before, NULL), 0);
    assert_true(feed->view[0].ended_well);
    assert_false(feed->view[1].ended_well);
}

static void view_that_does_not_end_is_killed(void **state)
{
    (void)state;
    seen->stops = 1;
    start(count_all);
    wait_until_stopped(0);
    wb_live_feed_stop(feed, 50);
    while (!wb_live_feed_has_ended(feed, 0))
        (void)poll(NULL, 0, 1);
    assert_false(feed->view[0].ended_well);
}

static void key_is_received_once(void **state)
{
    (void)state;
    int key = 0;
    seen->sends = 'm';
    start(count_all);
    while ((key = wb_live_feed_key(feed)) == 0)
        (void)poll(NULL, 0, 1);
    assert_int_equal(key, 'm');
    assert_int_equal(wb_live_feed_key(feed), 0);
}

static void packets_of_another_version_or_size_end_a_view(void **state)
{
    (void)state;
    static struct wb_live_frame frame;
    for (int wrong = 0; wrong < 4; wrong++) {
        struct wb_live_history history = {0};
        int ends[2];
        assert_int_equal(socketpair(AF_UNIX, SOCK_SEQPACKET, 0, ends), 0);
        frame.header = wb_live_frame_header(WB_LIVE_FRAME_STATE, sizeof frame);
        frame.n_points = wrong == 3 ? WB_LIVE_FRAME_POINTS + 1 : 0;
        frame.header.version += wrong == 1;
        const size_t size = sizeof frame - (wrong == 2 ? 8 : 0);
        assert_int_equal(send(ends[0], &frame, size, 0), size);
        assert_int_equal(wb_live_history_receive(&history, ends[1]), wrong == 0);
        assert_int_equal(history.has_frame, wrong == 0);
        wb_live_history_release(&history);
        close(ends[0]);
        close(ends[1]);
    }
}

static void long_test_is_thinned_and_keeps_its_ends(void **state)
{
    (void)state;
    struct wb_live_history history = {0};
    struct wb_live_frame frame = {.n_points = WB_LIVE_FRAME_POINTS};
    int ends[2], n = 0;
    assert_int_equal(socketpair(AF_UNIX, SOCK_SEQPACKET, 0, ends), 0);
    frame.header = wb_live_frame_header(WB_LIVE_FRAME_STATE, sizeof frame);
    while (n < 3 * WB_LIVE_HISTORY_POINTS) {
        for (int i = 0; i < WB_LIVE_FRAME_POINTS; i++)
            frame.point[i] = (struct wb_live_frame_point){(float)n, 0.0f, n + i};
        n += WB_LIVE_FRAME_POINTS;
        assert_int_equal(send(ends[0], &frame, sizeof frame, 0), sizeof frame);
        assert_true(wb_live_history_receive(&history, ends[1]));
    }
    assert_in_range(history.n_points, WB_LIVE_HISTORY_POINTS / 4, WB_LIVE_HISTORY_POINTS);
    assert_int_equal(history.points[0].cycle, 0);
    assert_int_equal(history.points[history.n_points - 1].cycle, n - 1);
    for (size_t i = 1; i < history.n_points; i++)
        assert_true(history.points[i].cycle > history.points[i - 1].cycle);
    wb_live_history_release(&history);
    close(ends[0]);
    close(ends[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(stopped_view_causes_no_delay_and_its_frames_are_counted,
                                        set_up, tear_down),
        cmocka_unit_test_setup_teardown(points_wait_for_a_view_that_was_slow, set_up, tear_down),
        cmocka_unit_test_setup_teardown(points_beyond_the_ring_are_dropped_oldest_first_and_counted,
                                        set_up, tear_down),
        cmocka_unit_test_setup_teardown(killed_view_is_noticed_without_other_effects, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(dead_view_does_not_affect_the_other, set_up, tear_down),
        cmocka_unit_test_setup_teardown(view_detects_the_end_of_the_recorder_independent_of_others,
                                        set_up, tear_down),
        cmocka_unit_test_setup_teardown(view_that_does_not_end_is_killed, set_up, tear_down),
        cmocka_unit_test_setup_teardown(key_is_received_once, set_up, tear_down),
        cmocka_unit_test(packets_of_another_version_or_size_end_a_view),
        cmocka_unit_test(long_test_is_thinned_and_keeps_its_ends),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
