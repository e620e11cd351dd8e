/* The web page of a live view with a minimal client: accepted and rejected requests, and that no
 * client delays another. */
#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/timing.h"
#include "base/units.h"
#include "fixtures/virtual/virtual_time.h"
#include "live/live_events.h"
#include "live/live_feed.h"
#include "live/live_history.h"
#include "live/live_page.h"
#include "tests/check.h"
#include "tests/messages.h"

static const struct wb_live_frame_point earlier[] = {{0.001f, 0.040f, 3}, {0.002f, 0.050f, 3}};
static struct wb_live_plan plan = {
    .earlier = earlier,
    .n_earlier = 2,
    .title = "type9, \"85\" mm <b>",
    .recording = "/tmp",
    .travel = 53.0 * WB_MM,
    .length = 85.0 * WB_MM,
    .force_limit = 0.275,
    .n_predicted = 2,
    .deflection = {0.0, 0.01},
    .tension = {0.02, 0.04},
};
static struct wb_live_page page = {.plan = &plan};
static struct wb_live_feed *feed;
static struct wb_live_frame frame;
static int port;
static char heard[1 << 20];

static int set_up(void **state)
{
    (void)state;
    int index;
    alarm(50); /* ends a hanging test */
    feed = calloc(1, sizeof *feed);
    memset(&frame, 0, sizeof frame);
    frame.force = 12.5 * WB_MN;
    frame.time_left = (double)NAN;
    frame.word = WB_LIVE_FRAME_TESTING;
    if (!feed || wb_live_page_listen(0, &page.listener, &port) != WB_OK)
        return 1;
    const enum wb_status status = wb_live_feed_start(feed, wb_live_page_run, &page, &index);
    close(page.listener);
    return status != WB_OK;
}

static int tear_down(void **state)
{
    (void)state;
    wb_live_feed_stop(feed, 20000);
    free(feed);
    alarm(0);
    return 0;
}

static int ask(const char *request)
{
    const struct sockaddr_in address = {.sin_family = AF_INET,
                                        .sin_port = htons((uint16_t)port),
                                        .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    const int client = socket(AF_INET, SOCK_STREAM, 0);
    assert_int_equal(connect(client, (const struct sockaddr *)&address, sizeof address), 0);
    assert_int_equal(send(client, request, strlen(request), 0), strlen(request));
    return client;
}

/* Reads until the words were received, pushing frames meanwhile; NULL: until the end. */
static void hear(int client, const char *words)
{
    size_t n = 0;
    heard[0] = '\0';
    while (!words || !strstr(heard, words)) {
        struct pollfd polled = {.fd = client, .events = POLLIN};
        if (poll(&polled, 1, 20) > 0) {
            const ssize_t got = recv(client, heard + n, sizeof heard - 1 - n, 0);
            if (got <= 0)
                break;
            n += (size_t)got;
            heard[n] = '\0';
        }
        wb_live_feed_push(feed, &frame);
    }
    if (words && !strstr(heard, words))
        fail_msg("'%s' did not come, but: %.300s", words, heard);
}

static void assert_heard(const char *words)
{
    if (!strstr(heard, words))
        fail_msg("no '%s' in: %.300s", words, heard);
}

#define GET(path) "GET " path " HTTP/1.1\r\nHost: localhost:1234\r\nConnection: close\r\n\r\n"

static void page_is_complete_and_fetches_nothing_from_other_hosts(void **state)
{
    (void)state;
    const int client = ask(GET("/"));
    hear(client, NULL);
    close(client);
    assert_heard("HTTP/1.1 200");
    assert_heard("text/html; charset=utf-8");
    assert_heard("default-src 'none'");
    assert_heard("</html>\n");
    assert_null(strstr(heard, "src=\"http"));
    assert_null(strstr(heard, "//cdn"));
    assert_null(strstr(heard, "https://"));
}

static void events_bring_the_plan_the_curve_and_the_state(void **state)
{
    (void)state;
    wb_live_feed_add_point(feed, &(struct wb_live_frame_point){0.0015f, 0.0225f, 1});
    const int client = ask(GET("/events"));
    hear(client, "\"points\": [[1,1.5,22.5]]}\n\n");
    assert_heard("event: earlier\ndata: {\"points\": [[3,1,40],[3,2,50]]}\n\n");
    hear(client, "\"force_mN\": 12.5");
    assert_heard("\"state\": \"test in progress\"");
    assert_heard("\"time_left_s\": null");
    hear(client, "\"disk_free_GB\": ");
    wb_live_feed_add_point(feed, &(struct wb_live_frame_point){0.0025f, 0.0335f, 2});
    hear(client, "data: {\"from\": 1, \"points\": [[2,2.5,33.5]]}\n\n");
    wb_live_feed_add_message(feed, WB_LOG_WARNING, "a \"message\"\nof two lines");
    hear(client, "event: message\ndata: {   \"level\": \"warning\",   \"text\": \"a "
                 "\\\"message\\\"\\nof two lines\" } \n\n");
    close(client);
}

/* The number under this key of the state that a client would get now; NaN: null. */
static double number_of(const struct wb_live_history *history, const char *key)
{
    struct wb_live_events_cursor cursor = {.frame = UINT64_MAX};
    struct wb_text text = {0};
    double value = (double)NAN;
    wb_live_events_append(&cursor, &plan, history, false, &text);
    const char *const at = strstr(wb_text_string(&text), key);
    assert_non_null(at);
    (void)sscanf(at + strlen(key), "\": %lf", &value);
    wb_text_release(&text);
    return value;
}

static void free_space_is_given_in_bytes_and_time(void **state)
{
    (void)state;
    struct wb_live_history history = {.has_frame = true};
    wb_virtual_time_begin(WB_VIRTUAL_TIME_HOST_DATE);
    wb_live_history_check_disk(&history, plan.recording);
    assert_true(number_of(&history, "disk_free_GB") > 0.0);
    assert_true(isnan(number_of(&history, "disk_left_h"))); /* before the first frame */
    history.frame.elapsed = 100.0;
    history.frame.bytes = 1000000000;
    wb_time_sleep(WB_VIRTUAL_TIME_START_NS + 2 * WB_NS_PER_S - 1);
    wb_live_history_check_disk(&history, plan.recording);
    assert_true(isnan(number_of(&history, "disk_left_h"))); /* a check every two seconds */
    wb_time_sleep(WB_VIRTUAL_TIME_START_NS + 2 * WB_NS_PER_S);
    wb_live_history_check_disk(&history, plan.recording);
    assert_close_relative(number_of(&history, "disk_left_h") * 3600.0 * 1e-2,
                          number_of(&history, "disk_free_GB"), 1e-9);
    wb_virtual_time_end();
}

static void disk_that_cannot_be_queried_has_unknown_free_space(void **state)
{
    (void)state;
    struct wb_live_history history = {.frame = {.elapsed = 10.0, .bytes = 1000}};
    wb_live_history_check_disk(&history, "/tmp");
    assert_close_relative(history.disk_left, history.disk_free / 100.0, 1e-12);
    history.disk_due_ns = 1;
    wb_live_history_check_disk(&history, "/nowhere/at all");
    assert_true(isnan(history.disk_free) && isnan(history.disk_left));
}

static void client_that_comes_later_has_all_of_the_curve(void **state)
{
    (void)state;
    for (int i = 0; i < 500; i++)
        wb_live_feed_add_point(feed, &(struct wb_live_frame_point){(float)i, 0.0f, 1});
    const int first = ask(GET("/events"));
    hear(first, "[1,4.99e+05,0]]}");
    const int second = ask(GET("/events"));
    hear(second, "[1,4.99e+05,0]]}");
    assert_heard("event: plan\ndata: {   \"title\": \"type9, \\\"85\\\" mm <b>\"");
    assert_heard("data: {\"from\": 0, \"points\": [[1,0,0],[1,1000,0],");
    close(first);
    close(second);
}

static void client_that_never_reads_holds_up_nobody(void **state)
{
    (void)state;
    const int lazy = ask(GET("/events"));
    for (int i = 0; i < 300; i++) {
        for (int k = 0; k < WB_LIVE_FRAME_POINTS; k++)
            wb_live_feed_add_point(feed, &(struct wb_live_frame_point){(float)i, 0.0f, 1});
        wb_live_feed_push(feed, &frame);
    }
    frame.force = 77.5 * WB_MN;
    const int client = ask(GET("/events"));
    hear(client, "\"force_mN\": 77.5");
    close(client);
    close(lazy);
}

static void page_is_read_only_and_served_to_this_host_only(void **state)
{
    (void)state;
    static const struct {
        const char *request, *code;
    } cases[] = {
        {"POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 0\r\nConnection: close\r\n\r\n",
         "HTTP/1.1 405"},
        {"GET / HTTP/1.1\r\nHost: evil.example\r\nConnection: close\r\n\r\n", "HTTP/1.1 403"},
        {"GET /events HTTP/1.1\r\nHost: localhost.evil.example\r\nConnection: close\r\n\r\n",
         "HTTP/1.1 403"},
        {"GET / HTTP/1.0\r\n\r\n", " 403"},
        {GET("/../etc/passwd"), "HTTP/1.1 404"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const int client = ask(cases[i].request);
        hear(client, NULL);
        close(client);
        assert_heard(cases[i].code);
        assert_null(strstr(heard, "<html"));
    }
}

static void last_state_and_end_reach_the_clients(void **state)
{
    (void)state;
    const int client = ask(GET("/events"));
    hear(client, "event: state");
    frame.word = WB_LIVE_FRAME_STOPPED;
    snprintf(frame.text, sizeof frame.text, "stopped by the operator");
    wb_live_feed_push(feed, &frame);
    wb_live_feed_stop(feed, 20000);
    assert_true(feed->view[0].ended_well);
    hear(client, NULL);
    close(client);
    assert_heard("\"reason\": \"stopped by the operator\"");
    assert_heard("event: end\n");
}

static void port_in_use_is_reported_with_its_remedy(void **state)
{
    (void)state;
    int first, second, taken, other;
    assert_int_equal(wb_live_page_listen(0, &first, &taken), WB_OK);
    keep_messages();
    assert_int_equal(wb_live_page_listen(taken, &second, &other), WB_ERR_BUSY);
    release_messages();
    assert_message("cannot be used");
    assert_message("choose another port with --serve");
    close(first);
}

int main(void)
{
    signal(SIGPIPE, SIG_IGN); /* of this client's own sockets */
#define ON_A_PAGE(fact) cmocka_unit_test_setup_teardown(fact, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        ON_A_PAGE(page_is_complete_and_fetches_nothing_from_other_hosts),
        ON_A_PAGE(events_bring_the_plan_the_curve_and_the_state),
        cmocka_unit_test(free_space_is_given_in_bytes_and_time),
        cmocka_unit_test(disk_that_cannot_be_queried_has_unknown_free_space),
        ON_A_PAGE(client_that_comes_later_has_all_of_the_curve),
        ON_A_PAGE(client_that_never_reads_holds_up_nobody),
        ON_A_PAGE(page_is_read_only_and_served_to_this_host_only),
        ON_A_PAGE(last_state_and_end_reach_the_clients),
        cmocka_unit_test(port_in_use_is_reported_with_its_remedy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
