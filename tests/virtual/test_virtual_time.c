/* Virtual time and its ports: arrival times, stalls, cables. */
#include "fixtures/virtual/virtual_time_private.h"

#include <errno.h>
#include <pthread.h>
#include <string.h>

#include "base/interrupt_private.h"
#include "base/timing.h"
#include "base/units.h"
#include "daq/stream/stream.h"
#include "fixtures/virtual/sim_port_private.h"
#include "tests/check.h"
#include "tests/messages.h"

#define MS WB_NS_PER_MS
#define START WB_VIRTUAL_TIME_START_NS

/* An instrument that sends a letter every 10 ms and stores what it receives. */
struct ticker {
    struct wb_virtual_actor actor;
    struct wb_sim_port_handler handler;
    struct wb_sim_port *port;
    int64_t due_ns;
    char next;
    char received[64], line[32];
    size_t n_heard;
    int64_t heard_ns;
};

static int64_t ticker_next(void *context)
{
    const struct ticker *const ticker = context;
    return ticker->due_ns;
}

static void ticker_run(void *context, int64_t now_ns)
{
    struct ticker *const ticker = context;
    for (; ticker->due_ns <= now_ns; ticker->due_ns += 10 * MS)
        wb_sim_port_send(ticker->port, &(char){ticker->next++}, 1);
}

static void ticker_hear(void *context, int64_t now_ns, const void *bytes, size_t n)
{
    struct ticker *const ticker = context;
    assert_true(ticker->n_heard + n <= sizeof ticker->received);
    memcpy(ticker->received + ticker->n_heard, bytes, n);
    ticker->n_heard += n;
    ticker->heard_ns = now_ns;
}

static void ticker_opened(void *context, int64_t now_ns, const char *line)
{
    struct ticker *const ticker = context;
    (void)now_ns;
    snprintf(ticker->line, sizeof ticker->line, "%s", line);
}

static int set_up(void **state)
{
    static struct ticker ticker;
    memset(&ticker, 0, sizeof ticker);
    wb_interrupt_set(false);
    wb_virtual_time_begin(WB_VIRTUAL_TIME_HOST_DATE);
    ticker.due_ns = START + 10 * MS;
    ticker.next = 'a';
    ticker.actor = (struct wb_virtual_actor){&ticker, ticker_next, ticker_run};
    ticker.handler = (struct wb_sim_port_handler){&ticker, ticker_hear, ticker_opened};
    assert_int_equal(wb_sim_port_create(&ticker.port, "cell", &ticker.handler), WB_OK);
    wb_virtual_time_add(&ticker.actor);
    *state = &ticker;
    return 0;
}

static int tear_down(void **state)
{
    struct ticker *const ticker = *state;
    wb_sim_port_destroy(ticker->port);
    wb_virtual_time_end();
    wb_interrupt_set(false);
    return 0;
}

static struct wb_stream *open_cell(void)
{
    struct wb_stream *stream;
    assert_int_equal(wb_stream_open(&stream, "sim:cell,9600,8n1"), WB_OK);
    return stream;
}

static int wait_for(struct wb_stream *stream, int64_t deadline_ns)
{
    int descriptors[2];
    assert_int_equal(wb_stream_descriptors(stream, descriptors), 1);
    struct pollfd polled = {.fd = descriptors[0], .events = POLLIN};
    return wb_time_wait(&polled, 1, deadline_ns);
}

static void assert_reads(struct wb_stream *stream, const char *expected)
{
    char text[16] = "";
    size_t n;
    assert_int_equal(wb_stream_read(stream, text, sizeof text - 1, &n), WB_OK);
    assert_int_equal(n, strlen(expected));
    assert_memory_equal(text, expected, n);
}

static void time_passes_only_in_waits(void **state)
{
    (void)state;
    assert_int_equal(wb_time_now_ns(), START);
    assert_int_equal(wb_time_now_ns(), START);
    assert_int_equal(wb_time_wait(NULL, 0, START + 3600 * WB_NS_PER_S), 0);
    assert_int_equal(wb_time_now_ns(), START + 3600 * WB_NS_PER_S);
}

static void wait_ends_when_a_piece_arrives(void **state)
{
    struct wb_stream *const stream = open_cell();
    (void)state;
    assert_int_equal(wait_for(stream, START + 5 * MS), 0);
    assert_int_equal(wb_time_now_ns(), START + 5 * MS);
    assert_reads(stream, "");
    assert_int_equal(wait_for(stream, START + WB_NS_PER_S), 1);
    assert_int_equal(wb_time_now_ns(), START + 10 * MS + WB_SIM_PORT_DELAY_NS);
    assert_reads(stream, "a");
    assert_reads(stream, "");
    assert_int_equal(wait_for(stream, START + WB_NS_PER_S), 1);
    assert_int_equal(wb_time_now_ns(), START + 20 * MS + WB_SIM_PORT_DELAY_NS);
    wb_stream_close(stream);
}

static void written_bytes_arrive_at_once(void **state)
{
    struct ticker *const ticker = *state;
    struct wb_stream *const stream = open_cell();
    assert_string_equal(ticker->line, "9600,8n1");
    wb_time_sleep(START + 7 * MS);
    assert_int_equal(wb_stream_write(stream, "?!", 2), WB_OK);
    assert_int_equal(ticker->n_heard, 2);
    assert_int_equal(ticker->heard_ns, START + 7 * MS);
    wb_stream_close(stream);
}

static void pieces_wait_while_the_program_is_stalled(void **state)
{
    struct wb_stream *const stream = open_cell();
    (void)state;
    wb_time_sleep(wb_time_now_ns() + 35 * MS);
    assert_int_equal(wb_time_now_ns(), START + 35 * MS);
    assert_int_equal(wait_for(stream, START + 36 * MS), 1);
    assert_int_equal(wb_time_now_ns(), START + 35 * MS);
    assert_reads(stream, "a");
    assert_reads(stream, "b");
    assert_reads(stream, "c");
    assert_reads(stream, "");
    wb_stream_close(stream);
}

static void pieces_are_lost_while_nobody_has_the_port_open(void **state)
{
    (void)state;
    wb_time_sleep(START + 25 * MS);
    struct wb_stream *const stream = open_cell();
    assert_int_equal(wait_for(stream, START + WB_NS_PER_S), 1);
    assert_reads(stream, "c");
    wb_stream_close(stream);
}

static void port_is_open_once_and_named(void **state)
{
    struct wb_stream *again;
    struct wb_stream *const stream = open_cell();
    (void)state;
    keep_messages();
    assert_int_equal(wb_stream_open(&again, "sim:cell"), WB_ERR_BUSY);
    assert_int_equal(wb_stream_open(&again, "sim:cellar"), WB_ERR_NOT_FOUND);
    assert_message("sim:cellar");
    release_messages();
    wb_stream_close(stream);
}

static void unplugged_port_is_gone_until_its_cable_is_back(void **state)
{
    struct ticker *const ticker = *state;
    struct wb_stream *const stream = open_cell();
    char byte;
    size_t n;
    wb_time_sleep(START + 11 * MS);
    keep_messages();
    wb_sim_port_unplug(ticker->port);
    assert_reads(stream, "a"); /* had arrived */
    assert_int_equal(wait_for(stream, START + WB_NS_PER_S), 1);
    assert_int_equal(wb_time_now_ns(), START + 11 * MS);
    assert_int_equal(wb_stream_read(stream, &byte, 1, &n), WB_ERR_IO);
    assert_int_equal(wb_stream_write(stream, "?", 1), WB_ERR_IO);
    assert_false(wb_stream_reopen(stream));
    wb_time_sleep(START + 25 * MS);
    wb_sim_port_replug(ticker->port);
    ticker->line[0] = '\0';
    assert_true(wb_stream_reopen(stream));
    assert_string_equal(ticker->line, "9600,8n1");
    assert_int_equal(wait_for(stream, START + WB_NS_PER_S), 1);
    assert_reads(stream, "c");
    release_messages();
    wb_stream_close(stream);
}

static void destroyed_port_is_gone(void **state)
{
    struct ticker *const ticker = *state;
    struct wb_stream *const stream = open_cell();
    char byte;
    size_t n;
    keep_messages();
    wb_virtual_time_remove(&ticker->actor);
    wb_sim_port_destroy(ticker->port);
    ticker->port = NULL;
    assert_int_equal(wait_for(stream, START + WB_NS_PER_S), 1);
    assert_int_equal(wb_stream_read(stream, &byte, 1, &n), WB_ERR_IO);
    release_messages();
    wb_stream_close(stream);
}

static void blocked_port_fails_after_the_time_of_a_write(void **state)
{
    struct ticker *const ticker = *state;
    struct wb_stream *const stream = open_cell();
    keep_messages();
    wb_sim_port_block(ticker->port, true);
    assert_int_equal(wb_stream_write(stream, "?", 1), WB_ERR_TIMEOUT);
    assert_int_equal(wb_time_now_ns(), START + 50 * MS);
    assert_int_equal(ticker->n_heard, 0);
    release_messages();
    wb_stream_close(stream);
}

static int64_t interrupt_next(void *context)
{
    (void)context;
    return wb_interrupted() ? INT64_MAX : START + 3 * MS;
}

static void interrupt_run(void *context, int64_t now_ns)
{
    (void)context, (void)now_ns;
    wb_interrupt_set(true);
}

static void interrupt_ends_a_wait(void **state)
{
    const struct wb_virtual_actor actor = {NULL, interrupt_next, interrupt_run};
    (void)state;
    wb_virtual_time_add(&actor);
    errno = 0;
    assert_int_equal(wb_time_wait(NULL, 0, START + WB_NS_PER_S), -1);
    assert_int_equal(errno, EINTR);
    assert_int_equal(wb_time_now_ns(), START + 3 * MS);
    wb_virtual_time_remove(&actor);
}

static void *wait_in_a_thread(void *context)
{
    (void)context;
    (void)wb_time_wait(NULL, 0, START + 2 * MS);
    return NULL;
}

static void other_threads_do_not_move_virtual_time(void **state)
{
    pthread_t thread;
    (void)state;
    assert_int_equal(pthread_create(&thread, NULL, wait_in_a_thread, NULL), 0);
    assert_int_equal(pthread_join(thread, NULL), 0);
    assert_int_equal(wb_time_now_ns(), START);
}

static void dates_follow_the_virtual_clock_from_a_given_start(void **state)
{
    (void)state;
    wb_virtual_time_begin(1795615380);
    wb_time_sleep(START + 90 * WB_NS_PER_S);
    assert_int_equal(wb_time_utc(), 1795615470);
    wb_virtual_time_end();
    assert_false(wb_time_is_virtual());
    wb_virtual_time_begin(WB_VIRTUAL_TIME_HOST_DATE);
    assert_true(wb_time_utc() > 1700000000);
}

#define FACT(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        FACT(time_passes_only_in_waits),
        FACT(wait_ends_when_a_piece_arrives),
        FACT(written_bytes_arrive_at_once),
        FACT(pieces_wait_while_the_program_is_stalled),
        FACT(pieces_are_lost_while_nobody_has_the_port_open),
        FACT(port_is_open_once_and_named),
        FACT(unplugged_port_is_gone_until_its_cable_is_back),
        FACT(destroyed_port_is_gone),
        FACT(blocked_port_fails_after_the_time_of_a_write),
        FACT(interrupt_ends_a_wait),
        FACT(other_threads_do_not_move_virtual_time),
        FACT(dates_follow_the_virtual_clock_from_a_given_start),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
