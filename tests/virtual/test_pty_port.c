/* The instrument's end of a pseudo-terminal, tested with the real stream. */
#include "fixtures/virtual/pty_port.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include "daq/stream/stream.h"
#include "tests/check.h"

static struct wb_stream *open_stream(const struct wb_pty_port *port)
{
    struct wb_stream *stream;
    char address[96];
    snprintf(address, sizeof address, "pty:%s", port->path);
    assert_int_equal(wb_stream_open(&stream, address), WB_OK);
    return stream;
}

#define DEADLINE_MS 60000

/* The kernel delivers bytes in a worker: waits until some arrive. */
static void wait_for_bytes(int descriptor)
{
    struct pollfd polled = {.fd = descriptor, .events = POLLIN};
    assert_int_equal(poll(&polled, 1, DEADLINE_MS), 1);
}

/* Reads this number of bytes, and checks that no more follow. */
static void read_exactly(struct wb_stream *stream, char *text, size_t size)
{
    int descriptors[2];
    char more;
    size_t got;
    assert_int_equal(wb_stream_descriptors(stream, descriptors), 1);
    for (size_t n = 0; n < size; n += got) {
        wait_for_bytes(descriptors[0]);
        assert_int_equal(wb_stream_read(stream, text + n, size - n, &got), WB_OK);
    }
    assert_int_equal(wb_stream_read(stream, &more, 1, &got), WB_OK);
    assert_int_equal(got, 0);
}

/* Reads `expected`, written last: nothing arrived before it. */
static void assert_reads(struct wb_stream *stream, const char *expected)
{
    char text[16];
    read_exactly(stream, text, strlen(expected));
    assert_memory_equal(text, expected, strlen(expected));
}

static void opening_and_closing_are_detected(void **state)
{
    (void)state;
    struct wb_pty_port port;
    assert_int_equal(wb_pty_port_open(&port), WB_OK);
    assert_false(wb_pty_port_update(&port));
    assert_false(port.is_open);
    for (int i = 0; i < 3; i++) {
        struct wb_stream *const stream = open_stream(&port);
        assert_true(wb_pty_port_update(&port));
        assert_true(port.is_open);
        assert_false(wb_pty_port_update(&port));
        wb_stream_close(stream);
        assert_false(wb_pty_port_update(&port));
        assert_false(port.is_open);
    }
    wb_pty_port_close(&port);
}

static void bytes_go_both_ways_unchanged(void **state)
{
    (void)state;
    struct wb_pty_port port;
    unsigned char all[256], back[256];
    char text[256];
    for (int i = 0; i < 256; i++)
        all[i] = (unsigned char)i;
    assert_int_equal(wb_pty_port_open(&port), WB_OK);
    struct wb_stream *const stream = open_stream(&port);
    wb_pty_port_update(&port);
    wb_pty_port_write(&port, all, sizeof all);
    read_exactly(stream, text, sizeof all);
    assert_memory_equal(text, all, sizeof all);
    assert_int_equal(wb_stream_write(stream, all, sizeof all), WB_OK);
    for (size_t n = 0; n < sizeof all;) {
        wait_for_bytes(port.descriptor);
        n += wb_pty_port_read(&port, back + n, sizeof back - n);
    }
    assert_memory_equal(back, all, sizeof all);
    assert_int_equal(wb_pty_port_read(&port, back, sizeof back), 0);
    /* No echo: an echo would come before this. */
    wb_pty_port_write(&port, "end", 3);
    assert_reads(stream, "end");
    wb_stream_close(stream);
    wb_pty_port_close(&port);
}

/* A program that sets nothing gets no echo and no line editing. */
static void the_line_is_raw_from_the_start(void **state)
{
    (void)state;
    struct wb_pty_port port;
    char text[16];
    assert_int_equal(wb_pty_port_open(&port), WB_OK);
    const int slave = open(port.path, O_RDWR | O_NOCTTY | O_NONBLOCK);
    assert_true(slave >= 0);
    wb_pty_port_update(&port);
    wb_pty_port_write(&port, "a\rb", 3);
    wait_for_bytes(slave);
    assert_int_equal(read(slave, text, sizeof text), 3);
    assert_memory_equal(text, "a\rb", 3);
    assert_int_equal(wb_pty_port_read(&port, text, sizeof text), 0);
    close(slave);
    wb_pty_port_close(&port);
}

static void bytes_for_a_closed_port_are_lost(void **state)
{
    (void)state;
    struct wb_pty_port port;
    assert_int_equal(wb_pty_port_open(&port), WB_OK);
    wb_pty_port_update(&port);
    wb_pty_port_write(&port, "early", 5);
    struct wb_stream *stream = open_stream(&port);
    wb_pty_port_update(&port);
    wb_pty_port_write(&port, "late", 4);
    assert_reads(stream, "late");
    /* Bytes that one program left unread are not seen by the next. */
    wb_pty_port_write(&port, "unread", 6);
    int descriptors[2];
    assert_int_equal(wb_stream_descriptors(stream, descriptors), 1);
    wait_for_bytes(descriptors[0]);
    wb_stream_close(stream);
    wb_pty_port_update(&port);
    stream = open_stream(&port);
    wb_pty_port_update(&port);
    wb_pty_port_write(&port, "fresh", 5);
    assert_reads(stream, "fresh");
    wb_stream_close(stream);
    wb_pty_port_close(&port);
}

static void slow_reader_does_not_block(void **state)
{
    (void)state;
    struct wb_pty_port port;
    char block[1000];
    memset(block, 'x', sizeof block);
    assert_int_equal(wb_pty_port_open(&port), WB_OK);
    struct wb_stream *const stream = open_stream(&port);
    wb_pty_port_update(&port);
    for (int i = 0; i < 200; i++)
        wb_pty_port_write(&port, block, sizeof block);
    wb_stream_close(stream);
    wb_pty_port_close(&port);
}

static void ignore(void *context, enum wb_log_level level, const char *domain, const char *message)
{
    (void)context;
    (void)level;
    (void)domain;
    (void)message;
}

static void an_unplugged_port_is_gone_for_its_reader(void **state)
{
    (void)state;
    struct wb_pty_port port;
    char byte;
    size_t n;
    assert_int_equal(wb_pty_port_open(&port), WB_OK);
    struct wb_stream *const stream = open_stream(&port);
    wb_pty_port_update(&port);
    wb_pty_port_close(&port);
    assert_false(port.is_open);
    assert_false(wb_pty_port_update(&port));
    assert_false(port.is_open);
    wb_pty_port_write(&port, "x", 1);
    assert_int_equal(wb_pty_port_read(&port, &byte, 1), 0);
    wb_log_set_sink(ignore, NULL);
    assert_int_not_equal(wb_stream_read(stream, &byte, 1, &n), WB_OK);
    wb_log_set_sink(NULL, NULL);
    wb_stream_close(stream);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(opening_and_closing_are_detected),
        cmocka_unit_test(bytes_go_both_ways_unchanged),
        cmocka_unit_test(the_line_is_raw_from_the_start),
        cmocka_unit_test(bytes_for_a_closed_port_are_lost),
        cmocka_unit_test(slow_reader_does_not_block),
        cmocka_unit_test(an_unplugged_port_is_gone_for_its_reader),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
