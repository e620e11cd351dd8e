/* Instruments behind a pseudo-terminal whose baud rate counts: at another one they send rubbish and
 * understand nothing. */
#include "daq/acquire/listening.h"

#include "base/interrupt_private.h"
#include "tests/daq/fake_bench.h"
#include "tests/daq/tic_example.h"

struct port {
    pthread_t thread;
    int master, keep;
    char path[64], address[80];
    atomic_bool quit;
    speed_t speed; /* at which it is understood */
    enum wb_listening_found what;
    atomic_int understood, misunderstood; /* bytes that came to it */
};

static void answer(struct port *port, const char *bytes, ssize_t n)
{
    uint8_t status[WB_TIC_STATUS_BYTES];
    const struct wb_tic_status tic = {.operation = WB_TIC_NORMAL, .up_time_ms = 70000};
    if (port->what == WB_LISTENING_GRBL && memchr(bytes, '?', (size_t)n))
        fake_write(port->master, "<Idle|MPos:0.000,0.000,0.000|FS:0,0>\r\n", 38);
    if (port->what == WB_LISTENING_TIC && n > 1) {
        tic_example_status(status, &tic);
        fake_write(port->master, status, sizeof status);
    }
}

static void *run(void *context)
{
    struct port *const port = context;
    while (!port->quit) {
        struct termios line;
        char bytes[256];
        tcgetattr(port->master, &line);
        const bool understands = cfgetospeed(&line) == port->speed;
        const ssize_t n = read(port->master, bytes, sizeof bytes);
        if (n > 0 && understands)
            answer(port, bytes, n);
        if (n > 0)
            atomic_fetch_add(understands ? &port->understood : &port->misunderstood, (int)n);
        if (port->what == WB_LISTENING_LOAD_CELL)
            fake_write(port->master, understands ? "  12.34 g\r\n" : "\x81\xfe\x90\xe3\xbf\x88",
                       understands ? 11 : 6);
        usleep(5000);
    }
    return NULL;
}

static void begin(struct port *port, enum wb_listening_found what, speed_t speed)
{
    memset(port, 0, sizeof *port);
    port->what = what;
    port->speed = speed;
    fake_open_terminal(&port->master, &port->keep, port->path);
    snprintf(port->address, sizeof port->address, "pty:%s", port->path);
    assert_int_equal(pthread_create(&port->thread, NULL, run, port), 0);
}

static void end(struct port *port)
{
    port->quit = true;
    pthread_join(port->thread, NULL);
    close(port->master);
    close(port->keep);
}

static struct wb_listening listen_at(const struct port *port, bool asks)
{
    const struct wb_listening_settings settings = {.asks = asks, .patience_ns = 200 * WB_NS_PER_MS};
    struct wb_listening heard;
    struct wb_reason why = {0};
    wb_interrupt_set(false);
    assert_int_equal(wb_listening_run(port->address, &settings, &heard, &why), WB_OK);
    return heard;
}

static void a_load_cell_that_prints_is_found_at_its_baud_rate(void **state)
{
    struct port port;
    (void)state;
    begin(&port, WB_LISTENING_LOAD_CELL, B57600);
    const struct wb_listening heard = listen_at(&port, false);
    assert_int_equal(heard.found, WB_LISTENING_LOAD_CELL);
    assert_string_equal(heard.line, "57600,8n1");
    assert_string_equal(heard.sample, "  12.34 g");
    assert_int_equal(port.understood + port.misunderstood, 0);
    end(&port);
}

static void what_is_understood_at_no_rate_is_unknown_and_silence_is_silence(void **state)
{
    struct port port;
    (void)state;
    begin(&port, WB_LISTENING_LOAD_CELL, B300);
    assert_int_equal(listen_at(&port, false).found, WB_LISTENING_UNKNOWN);
    end(&port);
    begin(&port, WB_LISTENING_NOTHING, B9600);
    assert_int_equal(listen_at(&port, false).found, WB_LISTENING_NOTHING);
    assert_int_equal(port.understood + port.misunderstood, 0);
    end(&port);
}

static void stages_answer_their_question_and_are_not_asked_without_leave(void **state)
{
    struct port port;
    (void)state;
    begin(&port, WB_LISTENING_GRBL, B115200);
    assert_int_equal(listen_at(&port, false).found, WB_LISTENING_NOTHING);
    const struct wb_listening grbl = listen_at(&port, true);
    assert_int_equal(grbl.found, WB_LISTENING_GRBL);
    assert_string_equal(grbl.line, "115200,8n1");
    end(&port);
    begin(&port, WB_LISTENING_TIC, B9600);
    const struct wb_listening tic = listen_at(&port, true);
    assert_int_equal(tic.found, WB_LISTENING_TIC);
    assert_string_equal(tic.line, "9600,8n1");
    end(&port);
}

static void a_port_that_is_not_there_is_a_reason(void **state)
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
        cmocka_unit_test(a_load_cell_that_prints_is_found_at_its_baud_rate),
        cmocka_unit_test(what_is_understood_at_no_rate_is_unknown_and_silence_is_silence),
        cmocka_unit_test(stages_answer_their_question_and_are_not_asked_without_leave),
        cmocka_unit_test(a_port_that_is_not_there_is_a_reason),
    };
    return cmocka_run_group_tests(facts, NULL, NULL);
}
