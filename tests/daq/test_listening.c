/* Instruments on a port with a baud rate: at other rates they send and receive invalid bytes. */
#include "daq/acquire/listening.h"

#include <stdlib.h>

#include "base/interrupt_private.h"
#include "base/timing.h"
#include "base/units.h"
#include "fixtures/virtual/sim_port.h"
#include "fixtures/virtual/virtual_time.h"
#include "tests/check.h"
#include "tests/daq/tic_example.h"

struct port {
    struct wb_sim_port *port;
    struct wb_sim_port_handler handler;
    struct wb_virtual_actor actor;
    int baud; /* at which it is understood */
    enum wb_listening_found what;
    int line_baud; /* at which the host has opened it */
    int64_t next_ns;
    int heard; /* bytes that came to it */
};

static void opened(void *context, int64_t now_ns, const char *line)
{
    struct port *const port = context;
    (void)now_ns;
    port->line_baud = atoi(line);
}

static void answer(void *context, int64_t now_ns, const void *bytes, size_t n)
{
    struct port *const port = context;
    uint8_t status[WB_TIC_STATUS_BYTES];
    const struct wb_tic_status tic = {.operation = WB_TIC_NORMAL, .up_time_ms = 70000};
    (void)now_ns;
    port->heard += (int)n;
    if (port->line_baud != port->baud)
        return;
    if (port->what == WB_LISTENING_GRBL && memchr(bytes, '?', n))
        wb_sim_port_send(port->port, "<Idle|MPos:0.000,0.000,0.000|FS:0,0>\r\n", 38);
    if (port->what == WB_LISTENING_TIC && n > 1) {
        tic_example_status(status, &tic);
        wb_sim_port_send(port->port, status, sizeof status);
    }
}

static int64_t next_reading(void *context)
{
    const struct port *const port = context;
    return port->what == WB_LISTENING_LOAD_CELL ? port->next_ns : INT64_MAX;
}

static void read_out(void *context, int64_t now_ns)
{
    struct port *const port = context;
    const bool understands = port->line_baud == port->baud;
    const char *const bytes = understands ? "  12.34 g\r\n" : "\x81\xfe\x90\xe3\xbf\x88";
    wb_sim_port_send(port->port, bytes, strlen(bytes));
    port->next_ns = now_ns + 5 * WB_NS_PER_MS;
}

static void begin(struct port *port, enum wb_listening_found what, int baud)
{
    wb_virtual_time_begin(WB_VIRTUAL_TIME_HOST_DATE);
    *port = (struct port){.handler = {port, answer, opened},
                          .actor = {port, next_reading, read_out},
                          .what = what,
                          .baud = baud};
    assert_int_equal(wb_sim_port_create(&port->port, "some", &port->handler), WB_OK);
    wb_virtual_time_add(&port->actor);
}

static void end(struct port *port)
{
    wb_sim_port_destroy(port->port);
    wb_virtual_time_end();
}

static struct wb_listening listen_to(bool asks)
{
    const struct wb_listening_settings settings = {.asks = asks, .patience_ns = 200 * WB_NS_PER_MS};
    struct wb_listening heard;
    struct wb_reason why = {0};
    wb_interrupt_set(false);
    assert_int_equal(wb_listening_run("sim:some", &settings, &heard, &why), WB_OK);
    return heard;
}

static void printing_load_cell_is_found_at_its_baud_rate(void **state)
{
    struct port port;
    (void)state;
    begin(&port, WB_LISTENING_LOAD_CELL, 57600);
    const struct wb_listening heard = listen_to(false);
    assert_int_equal(heard.found, WB_LISTENING_LOAD_CELL);
    assert_string_equal(heard.line, "57600,8n1");
    assert_string_equal(heard.sample, "  12.34 g");
    assert_int_equal(port.heard, 0);
    end(&port);
}

static void undecodable_bytes_are_unknown_and_silence_is_reported(void **state)
{
    struct port port;
    (void)state;
    begin(&port, WB_LISTENING_LOAD_CELL, 300);
    assert_int_equal(listen_to(false).found, WB_LISTENING_UNKNOWN);
    end(&port);
    begin(&port, WB_LISTENING_NOTHING, 9600);
    assert_int_equal(listen_to(false).found, WB_LISTENING_NOTHING);
    assert_int_equal(port.heard, 0);
    end(&port);
}

static void stages_reply_to_queries_that_are_sent_only_with_permission(void **state)
{
    struct port port;
    (void)state;
    begin(&port, WB_LISTENING_GRBL, 115200);
    assert_int_equal(listen_to(false).found, WB_LISTENING_NOTHING);
    const struct wb_listening grbl = listen_to(true);
    assert_int_equal(grbl.found, WB_LISTENING_GRBL);
    assert_string_equal(grbl.line, "115200,8n1");
    end(&port);
    begin(&port, WB_LISTENING_TIC, 9600);
    const struct wb_listening tic = listen_to(true);
    assert_int_equal(tic.found, WB_LISTENING_TIC);
    assert_string_equal(tic.line, "9600,8n1");
    end(&port);
}

static void missing_port_is_a_reason(void **state)
{
    const struct wb_listening_settings settings = {.patience_ns = 1};
    struct wb_listening heard;
    struct wb_reason why = {0};
    (void)state;
    assert_int_equal(wb_listening_run("pty:/dev/pts/none,9600", &settings, &heard, &why),
                     WB_ERR_NOT_FOUND);
    assert_non_null(strstr(why.text, "'/dev/pts/none' does not exist"));
}

int main(void)
{
    const struct CMUnitTest facts[] = {
        cmocka_unit_test(printing_load_cell_is_found_at_its_baud_rate),
        cmocka_unit_test(undecodable_bytes_are_unknown_and_silence_is_reported),
        cmocka_unit_test(stages_reply_to_queries_that_are_sent_only_with_permission),
        cmocka_unit_test(missing_port_is_a_reason),
    };
    return cmocka_run_group_tests(facts, NULL, NULL);
}
