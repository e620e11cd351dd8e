/* Streams over pseudo-terminals, UDP on the loopback and memory; invalid addresses. */
#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include "base/log.h"
#include "daq/stream/stream_private.h"
#include "tests/folder.h"
#include "tests/messages.h"

static int set_up(void **state)
{
    (void)state;
    keep_messages();
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    wb_log_set_sink(NULL, NULL);
    return 0;
}

static void wait_readable(struct wb_stream *stream)
{
    int descriptors[2];
    int n = wb_stream_descriptors(stream, descriptors);
    struct pollfd wait[2] = {{.fd = descriptors[0], .events = POLLIN},
                             {.fd = n > 1 ? descriptors[1] : -1, .events = POLLIN}};
    assert_true(poll(wait, (nfds_t)n, 2000) > 0);
}

/* --- addresses --- */

static void wrong_addresses_are_rejected_with_what_is_expected(void **state)
{
    (void)state;
    static const struct {
        const char *address, *word;
    } wrong[] = {
        {"", "serial:PORT"},
        {"/dev/ttyUSB0", "serial:PORT"},
        {"tcp:1.2.3.4:5", "serial:PORT"},
        {"serial:", "PATH,BAUD,8n1"},
        {"serial:/dev/ttyS0,9600,8x1", "8x1"},
        {"serial:/dev/ttyS0,9600,9n1", "9n1"},
        {"serial:/dev/ttyS0,12", "12"},
        {"serial:/dev/ttyS0,dtr=maybe", "dtr=maybe"},
        {"serial:/dev/ttyS0,", "line setting ''"},
        {"pty:/dev/ptmx,flow=all", "flow=all"},
        {"udp:", "udp:HOST:PORT"},
        {"udp:localhost", "udp:HOST:PORT"},
        {"udp:localhost:0", "udp:HOST:PORT"},
        {"udp:localhost:65536", "udp:HOST:PORT"},
        {"udp:localhost:15x", "udp:HOST:PORT"},
        {"udp:127.0.0.1:1510,group=239.255.42.99", "group=ADDRESS:PORT"},
        {"udp:127.0.0.1:1510,group=127.0.0.1:1511", "group=ADDRESS:PORT"},
        {"udp:127.0.0.1:1510,grouo=239.255.42.99:1511", "'grouo=239.255.42.99:1511'"},
        {"udp:127.0.0.1:1510,group=239.255.42.99:1511,interface=nix0", "nix0"},
        {"memory:x", "'memory:x'"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        struct wb_stream *stream = (struct wb_stream *)&stream;
        kept.last[0] = '\0';
        assert_int_not_equal(wb_stream_open(&stream, wrong[i].address), WB_OK);
        assert_null(stream);
        assert_message(wrong[i].word);
    }
}

static void unknown_host_is_named(void **state)
{
    (void)state;
    struct wb_stream *stream = NULL;
    assert_int_equal(wb_stream_open(&stream, "udp:no-such-host.invalid:1510"), WB_ERR_NOT_FOUND);
    assert_message("no-such-host.invalid");
}

/* --- pseudo-terminals --- */

static int open_master(char *slave, size_t size)
{
    int master = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    assert_true(master >= 0);
    assert_int_equal(grantpt(master), 0);
    assert_int_equal(unlockpt(master), 0);
    assert_int_equal(ptsname_r(master, slave, size), 0);
    return master;
}

/* A stream at the other end of *master; `settings` follow the path. */
static struct wb_stream *open_pty(int *master, const char *settings)
{
    char slave[64], address[128];
    struct wb_stream *stream = NULL;
    *master = open_master(slave, sizeof slave);
    snprintf(address, sizeof address, "pty:%s%s", slave, settings);
    assert_int_equal(wb_stream_open(&stream, address), WB_OK);
    return stream;
}

/* Exactly these bytes are pending. */
static void assert_reads(struct wb_stream *stream, const char *text)
{
    char got[64];
    size_t n = 1;
    assert_int_equal(wb_stream_read(stream, got, sizeof got, &n), WB_OK);
    assert_int_equal(n, strlen(text));
    assert_memory_equal(got, text, n);
}

static void pseudo_terminal_passes_bytes_unchanged(void **state)
{
    (void)state;
    int master;
    struct wb_stream *stream = open_pty(&master, ",115200,8n1");
    uint8_t sent[256], got[512];
    struct termios line;
    assert_int_equal(tcgetattr(master, &line), 0);
    assert_int_equal(cfgetospeed(&line), B115200);
    for (int i = 0; i < 256; i++)
        sent[i] = (uint8_t)i;
    size_t n = 1;
    assert_int_equal(wb_stream_read(stream, got, sizeof got, &n), WB_OK);
    assert_int_equal(n, 0);
    assert_int_equal(write(master, sent, sizeof sent), sizeof sent);
    size_t total = 0;
    while (total < sizeof sent) {
        wait_readable(stream);
        assert_int_equal(wb_stream_read(stream, got + total, sizeof got - total, &n), WB_OK);
        total += n;
    }
    assert_int_equal(total, sizeof sent);
    assert_memory_equal(got, sent, sizeof sent);
    assert_int_equal(wb_stream_write(stream, sent, sizeof sent), WB_OK);
    total = 0;
    while (total < sizeof sent) {
        struct pollfd wait = {.fd = master, .events = POLLIN};
        assert_int_equal(poll(&wait, 1, 2000), 1);
        ssize_t part = read(master, got + total, sizeof got - total);
        assert_true(part > 0);
        total += (size_t)part;
    }
    assert_memory_equal(got, sent, sizeof sent);
    wb_stream_close(stream);
    close(master);
}

static void second_opener_of_a_pseudo_terminal_is_reported_it_is_busy(void **state)
{
    (void)state;
    char slave[64], address[128];
    int master = open_master(slave, sizeof slave);
    snprintf(address, sizeof address, "pty:%s", slave);
    struct wb_stream *first = NULL, *second = NULL;
    assert_int_equal(wb_stream_open(&first, address), WB_OK);
    assert_int_equal(wb_stream_open(&second, address), WB_ERR_BUSY);
    assert_message(slave);
    wb_stream_close(first);
    assert_int_equal(wb_stream_open(&second, address), WB_OK);
    wb_stream_close(second);
    close(master);
}

static void closed_master_is_a_lost_stream(void **state)
{
    (void)state;
    char got[8];
    int master;
    struct wb_stream *stream = open_pty(&master, "");
    close(master);
    size_t n = 0;
    wait_readable(stream);
    assert_int_equal(wb_stream_read(stream, got, sizeof got, &n), WB_ERR_IO);
    assert_message("was disconnected");
    wb_stream_close(stream);
}

/* As /dev/serial/by-id leads to a USB adapter that was plugged in again. */
static void lost_pseudo_terminal_is_found_through_its_link_under_another_number(void **state)
{
    (void)state;
    char folder[32], link[64], address[80], slave[64], again[64], byte;
    struct wb_stream *stream;
    size_t n;
    assert_true(temporary_folder_make(folder));
    snprintf(link, sizeof link, "%s/cell", folder);
    snprintf(address, sizeof address, "pty:%s", link);
    const int master = open_master(slave, sizeof slave);
    const int other = open_master(again, sizeof again);
    assert_string_not_equal(slave, again);
    assert_int_equal(symlink(slave, link), 0);
    assert_int_equal(wb_stream_open(&stream, address), WB_OK);
    close(master);
    assert_int_equal(unlink(link), 0);
    assert_int_equal(wb_stream_read(stream, &byte, 1, &n), WB_ERR_IO);
    assert_false(wb_stream_reopen(stream));
    assert_int_equal(symlink(again, link), 0);
    assert_true(wb_stream_reopen(stream));
    assert_int_equal(write(other, "0.15 g\r\n", 8), 8);
    wait_readable(stream);
    assert_reads(stream, "0.15 g\r\n");
    wb_stream_close(stream);
    close(other);
    assert_int_equal(temporary_folder_remove(folder), 0);
}

static void full_pseudo_terminal_times_out(void **state)
{
    (void)state;
    int master;
    struct wb_stream *stream = open_pty(&master, "");
    static const uint8_t many[1 << 20];
    assert_int_equal(wb_stream_write(stream, many, sizeof many), WB_ERR_TIMEOUT);
    wb_stream_close(stream);
    close(master);
}

static void missing_pseudo_terminal_and_plain_file_are_reported_apart(void **state)
{
    (void)state;
    struct wb_stream *stream = NULL;
    assert_int_equal(wb_stream_open(&stream, "pty:/dev/pts/no-such"), WB_ERR_NOT_FOUND);
    assert_message("does not exist");
    char path[] = "/tmp/wb-stream-XXXXXX", address[64];
    int descriptor = mkstemp(path);
    assert_true(descriptor >= 0);
    snprintf(address, sizeof address, "pty:%s", path);
    assert_int_equal(wb_stream_open(&stream, address), WB_ERR_IO);
    assert_message("not a terminal");
    close(descriptor);
    unlink(path);
}

/* --- UDP --- */

/* A socket on the loopback; *port receives its port. */
static int open_server(int *port)
{
    int server = socket(AF_INET, SOCK_DGRAM, 0);
    struct sockaddr_in bound = {.sin_family = AF_INET};
    bound.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof bound;
    assert_int_equal(bind(server, (struct sockaddr *)&bound, sizeof bound), 0);
    assert_int_equal(getsockname(server, (struct sockaddr *)&bound, &size), 0);
    *port = ntohs(bound.sin_port);
    return server;
}

/* A stream to a new server. */
static struct wb_stream *open_udp(const char *host, int *server)
{
    int port;
    char address[64];
    struct wb_stream *stream = NULL;
    *server = open_server(&port);
    snprintf(address, sizeof address, "udp:%s:%d", host, port);
    assert_int_equal(wb_stream_open(&stream, address), WB_OK);
    return stream;
}

/* The address of the stream, as the server sees it from a first datagram. */
static struct sockaddr_in address_of(struct wb_stream *stream, int server)
{
    char got[64];
    struct sockaddr_in client;
    socklen_t size = sizeof client;
    assert_int_equal(wb_stream_write(stream, "ping", 4), WB_OK);
    assert_int_equal(recvfrom(server, got, sizeof got, 0, (struct sockaddr *)&client, &size), 4);
    return client;
}

static void send_text(int socket, const struct sockaddr_in *to, const char *text)
{
    const size_t n = strlen(text);
    assert_int_equal(sendto(socket, text, n, 0, (const struct sockaddr *)to, sizeof *to), n);
}

static void datagrams_pass_one_a_read(void **state)
{
    (void)state;
    int server;
    struct wb_stream *stream = open_udp("127.0.0.1", &server);
    const struct sockaddr_in client = address_of(stream, server);

    /* Replies arrive from another port of the same host, as frames of a NatNet server may. */
    int data_port;
    int data = open_server(&data_port);
    send_text(data, &client, "one");
    send_text(data, &client, "");
    send_text(data, &client, "three");
    wait_readable(stream);
    assert_reads(stream, "one");
    assert_reads(stream, "three");
    assert_reads(stream, "");
    wb_stream_close(stream);
    close(data);
    close(server);
}

static void largest_datagram_is_received_completely(void **state)
{
    (void)state;
    int server;
    struct wb_stream *stream = open_udp("localhost", &server);
    uint8_t *big = malloc(WB_STREAM_READ_MAX), *got = malloc(WB_STREAM_READ_MAX);
    assert_non_null(big);
    assert_non_null(got);
    for (size_t i = 0; i < 65507; i++)
        big[i] = (uint8_t)(i * 7);
    assert_int_equal(wb_stream_write(stream, big, 65507), WB_OK);
    struct sockaddr_in client;
    socklen_t size = sizeof client;
    assert_int_equal(
        recvfrom(server, got, WB_STREAM_READ_MAX, 0, (struct sockaddr *)&client, &size), 65507);
    assert_int_equal(sendto(server, big, 65507, 0, (struct sockaddr *)&client, size), 65507);
    size_t n = 0;
    memset(got, 0, WB_STREAM_READ_MAX);
    wait_readable(stream);
    assert_int_equal(wb_stream_read(stream, got, WB_STREAM_READ_MAX, &n), WB_OK);
    assert_int_equal(n, 65507);
    assert_memory_equal(got, big, 65507);
    assert_int_not_equal(wb_stream_write(stream, big, WB_STREAM_READ_MAX), WB_OK);
    free(big);
    free(got);
    wb_stream_close(stream);
    close(server);
}

static void server_that_is_not_there_is_no_error_of_the_stream(void **state)
{
    (void)state;
    int port;
    close(open_server(&port)); /* a port without a listener */
    char address[64], got[8];
    snprintf(address, sizeof address, "udp:127.0.0.1:%d", port);
    struct wb_stream *stream = NULL;
    assert_int_equal(wb_stream_open(&stream, address), WB_OK);
    size_t n = 1;
    for (int i = 0; i < 3; i++) {
        assert_int_equal(wb_stream_write(stream, "ping", 4), WB_OK);
        assert_int_equal(wb_stream_read(stream, got, sizeof got, &n), WB_OK);
        assert_int_equal(n, 0);
    }
    wb_stream_close(stream);
}

static void datagrams_of_strangers_are_ignored(void **state)
{
    (void)state;
    int server;
    struct wb_stream *stream = open_udp("127.0.0.1", &server);
    const struct sockaddr_in client = address_of(stream, server);
    /* All of 127.0.0.0/8 is this host. */
    int stranger = socket(AF_INET, SOCK_DGRAM, 0);
    struct sockaddr_in bound = {.sin_family = AF_INET};
    bound.sin_addr.s_addr = htonl(INADDR_LOOPBACK + 1);
    assert_int_equal(bind(stranger, (struct sockaddr *)&bound, sizeof bound), 0);
    send_text(stranger, &client, "evil");
    send_text(server, &client, "good");
    wait_readable(stream);
    assert_reads(stream, "good");
    assert_message("127.0.0.2 are ignored");
    wb_stream_close(stream);
    close(stranger);
    close(server);
}

static void overrun_socket_counts_what_the_kernel_dropped(void **state)
{
    (void)state;
    int server;
    struct wb_stream *stream = open_udp("127.0.0.1", &server);
    static uint8_t bytes[60000];
    const struct sockaddr_in client = address_of(stream, server);
    const socklen_t size = sizeof client;
    /* A small buffer, so that few datagrams fill it. */
    int descriptors[2], small = 1;
    assert_int_equal(wb_stream_descriptors(stream, descriptors), 1);
    assert_int_equal(setsockopt(descriptors[0], SOL_SOCKET, SO_RCVBUF, &small, sizeof small), 0);
    uint64_t sent = 20, got = 0;
    for (uint64_t i = 0; i < sent; i++)
        assert_int_equal(sendto(server, bytes, 1000, 0, (struct sockaddr *)&client, size), 1000);
    size_t n = 0;
    do {
        assert_int_equal(wb_stream_read(stream, bytes, sizeof bytes, &n), WB_OK);
        got += n > 0;
    } while (n > 0);
    assert_true(got < sent);
    /* The count comes with the next datagram. */
    assert_int_equal(sendto(server, bytes, 10, 0, (struct sockaddr *)&client, size), 10);
    wait_readable(stream);
    assert_int_equal(wb_stream_read(stream, bytes, sizeof bytes, &n), WB_OK);
    assert_int_equal(n, 10);
    assert_int_equal(wb_stream_kernel_drops(stream), sent - got);
    wb_stream_close(stream);
    close(server);
}

static void one_stream_receives_multicast_data_and_unicast_replies(void **state)
{
    (void)state;
    int port, group_port;
    int server = open_server(&port);
    int free_port = open_server(&group_port);
    close(free_port);
    char address[160];
    snprintf(address, sizeof address, "udp:127.0.0.1:%d,group=239.255.77.99:%d,interface=127.0.0.1",
             port, group_port);
    struct wb_stream *stream = NULL, *other = NULL;
    if (wb_stream_open(&stream, address) != WB_OK) {
        print_message("no multicast on the loopback here: %s\n", kept.last);
        skip();
    }
    struct in_addr loopback = {.s_addr = htonl(INADDR_LOOPBACK)};
    assert_int_equal(setsockopt(server, IPPROTO_IP, IP_MULTICAST_IF, &loopback, sizeof loopback),
                     0);
    /* A second client on the same computer also receives the group. */
    assert_int_equal(wb_stream_open(&other, address), WB_OK);
    int descriptors[2];
    assert_int_equal(wb_stream_descriptors(stream, descriptors), 2);
    const struct sockaddr_in client = address_of(stream, server);
    send_text(server, &client, "info");
    wait_readable(stream);
    assert_reads(stream, "info");

    struct sockaddr_in group = {.sin_family = AF_INET, .sin_port = htons((uint16_t)group_port)};
    inet_pton(AF_INET, "239.255.77.99", &group.sin_addr);
    if (sendto(server, "frame", 5, 0, (struct sockaddr *)&group, sizeof group) != 5) {
        print_message("multicast cannot be sent on the loopback here: %s\n", strerror(errno));
        wb_stream_close(stream);
        wb_stream_close(other);
        skip();
    }
    struct wb_stream *both[] = {stream, other};
    for (int i = 0; i < 2; i++) {
        wait_readable(both[i]);
        assert_reads(both[i], "frame");
    }
    wb_stream_close(stream);
    wb_stream_close(other);
    close(server);
}

/* --- memory --- */

static void memory_gives_one_pushed_run_a_read(void **state)
{
    (void)state;
    struct wb_stream *stream = NULL;
    assert_int_equal(wb_stream_open(&stream, "memory:"), WB_OK);
    int descriptors[2];
    assert_int_equal(wb_stream_descriptors(stream, descriptors), 0);
    assert_int_equal(wb_stream_memory_push(stream, "abc", 3), WB_OK);
    assert_int_equal(wb_stream_memory_push(stream, "", 0), WB_OK);
    assert_int_equal(wb_stream_memory_push(stream, "defgh", 5), WB_OK);
    char got[8];
    size_t n = 0;
    assert_reads(stream, "abc");
    /* With a smaller buffer the rest of a block is returned by the next read. */
    assert_int_equal(wb_stream_read(stream, got, 4, &n), WB_OK);
    assert_int_equal(n, 4);
    assert_memory_equal(got, "defg", 4);
    assert_int_equal(wb_stream_read(stream, got, 4, &n), WB_OK);
    assert_int_equal(n, 1);
    assert_int_equal(got[0], 'h');
    assert_int_equal(wb_stream_read(stream, got, 4, &n), WB_OK);
    assert_int_equal(n, 0);
    assert_int_equal(wb_stream_memory_push(stream, "left over", 9), WB_OK);
    wb_stream_close(stream);
}

static void memory_keeps_what_was_written(void **state)
{
    (void)state;
    struct wb_stream *stream = NULL;
    assert_int_equal(wb_stream_open(&stream, "memory:"), WB_OK);
    char got[8];
    assert_int_equal(wb_stream_memory_take_written(stream, got, sizeof got), 0);
    assert_int_equal(wb_stream_write(stream, "?", 1), WB_OK);
    assert_int_equal(wb_stream_write(stream, "!G0", 3), WB_OK);
    assert_int_equal(wb_stream_memory_take_written(stream, got, 2), 2);
    assert_memory_equal(got, "?!", 2);
    assert_int_equal(wb_stream_memory_take_written(stream, got, sizeof got), 2);
    assert_memory_equal(got, "G0", 2);
    assert_int_equal(wb_stream_memory_take_written(stream, got, sizeof got), 0);
    wb_stream_close(stream);
}

static void other_streams_take_no_pushed_bytes(void **state)
{
    (void)state;
    struct wb_stream *stream = NULL;
    assert_int_equal(wb_stream_open(&stream, "udp:127.0.0.1:9"), WB_OK);
    assert_int_equal(wb_stream_memory_push(stream, "x", 1), WB_ERR_ARGUMENT);
    char got[4];
    assert_int_equal(wb_stream_memory_take_written(stream, got, sizeof got), 0);
    wb_stream_close(stream);
    wb_stream_close(NULL);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
#define FACT(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
        FACT(wrong_addresses_are_rejected_with_what_is_expected),
        FACT(unknown_host_is_named),
        FACT(pseudo_terminal_passes_bytes_unchanged),
        FACT(second_opener_of_a_pseudo_terminal_is_reported_it_is_busy),
        FACT(closed_master_is_a_lost_stream),
        FACT(lost_pseudo_terminal_is_found_through_its_link_under_another_number),
        FACT(full_pseudo_terminal_times_out),
        FACT(missing_pseudo_terminal_and_plain_file_are_reported_apart),
        FACT(datagrams_pass_one_a_read),
        FACT(largest_datagram_is_received_completely),
        FACT(server_that_is_not_there_is_no_error_of_the_stream),
        FACT(datagrams_of_strangers_are_ignored),
        FACT(overrun_socket_counts_what_the_kernel_dropped),
        FACT(one_stream_receives_multicast_data_and_unicast_replies),
        FACT(memory_gives_one_pushed_run_a_read),
        FACT(memory_keeps_what_was_written),
        FACT(other_streams_take_no_pushed_bytes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
