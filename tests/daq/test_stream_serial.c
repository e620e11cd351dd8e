/* The serial stream through the real libserialport, on a pseudo-terminal that serial_shim.c
 * presents as a serial port. meson preloads the shim. */
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/serial.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include "base/file.h"
#include "base/log.h"
#include "daq/acquire/acquisition.h"
#include "daq/recording/recording.h"
#include "daq/stream/stream.h"
#include "tests/check.h"

#define PORT "/dev/ttyWB0"

struct bench {
    int master;
    char slave[64];
    char folder[64];
    char message[1024]; /* the last one logged */
};

static int ask_shim(const char *name)
{
    void *found = dlsym(RTLD_DEFAULT, name);
    if (!found)
        fail_msg("serial_shim is not preloaded: run this test through meson");
    int (*function)(void);
    memcpy(&function, &found, sizeof function);
    return function();
}

static void keep_message(void *context, enum wb_log_level level, const char *domain,
                         const char *message)
{
    struct bench *bench = context;
    (void)level;
    (void)domain;
    snprintf(bench->message, sizeof bench->message, "%s", message);
}

static void lend_device(struct bench *bench)
{
    bench->master = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    assert_true(bench->master >= 0);
    assert_int_equal(grantpt(bench->master), 0);
    assert_int_equal(unlockpt(bench->master), 0);
    assert_int_equal(ptsname_r(bench->master, bench->slave, sizeof bench->slave), 0);
    setenv("WB_SHIM_DEVICE", bench->slave, 1);
}

static int set_up(void **state)
{
    struct bench *bench = calloc(1, sizeof *bench);
    ask_shim("wb_shim_modem_lines");
    snprintf(bench->folder, sizeof bench->folder, "/tmp/wb-serial-XXXXXX");
    assert_non_null(mkdtemp(bench->folder));
    char link[128];
    snprintf(link, sizeof link, "%s/ttyWB0", bench->folder);
    assert_int_equal(symlink("../../devices/platform/wb/tty/ttyWB0", link), 0);
    setenv("WB_SHIM_SYSFS", bench->folder, 1);
    setenv("WB_SHIM_PORT", PORT, 1);
    unsetenv("WB_SHIM_ERRNO");
    lend_device(bench);
    wb_log_set_sink(keep_message, bench);
    *state = bench;
    return 0;
}

static int tear_down(void **state)
{
    struct bench *bench = *state;
    wb_log_set_sink(NULL, NULL);
    if (bench->master >= 0)
        close(bench->master);
    char link[128];
    snprintf(link, sizeof link, "%s/ttyWB0", bench->folder);
    unlink(link);
    rmdir(bench->folder);
    free(bench);
    return 0;
}

static struct wb_stream *open_stream(const char *address)
{
    struct wb_stream *stream = NULL;
    assert_int_equal(wb_stream_open(&stream, address), WB_OK);
    return stream;
}

static void wait_readable(struct wb_stream *stream)
{
    int descriptors[2];
    assert_int_equal(wb_stream_descriptors(stream, descriptors), 1);
    struct pollfd wait = {.fd = descriptors[0], .events = POLLIN};
    assert_int_equal(poll(&wait, 1, 2000), 1);
}

static void line_settings_reach_the_terminal(void **state)
{
    struct bench *bench = *state;
    struct wb_stream *stream = open_stream("serial:" PORT ",19200,7e2");
    struct termios set;
    assert_int_equal(tcgetattr(bench->master, &set), 0);
    assert_int_equal(cfgetispeed(&set), B19200);
    assert_int_equal(cfgetospeed(&set), B19200);
    assert_int_equal(ask_shim("wb_shim_frame"), CS7 | PARENB);
    assert_true(set.c_cflag & CSTOPB);
    assert_false(set.c_lflag & (ICANON | ECHO | ISIG));
    assert_string_equal(wb_stream_address(stream), "serial:" PORT ",19200,7e2");
    assert_int_equal(ask_shim("wb_shim_exclusive"), 1);
    assert_true(ask_shim("wb_shim_serial_flags") & ASYNC_LOW_LATENCY);
    wb_stream_close(stream);
    assert_int_equal(ask_shim("wb_shim_exclusive"), 0);
}

static void dtr_and_rts_lines_are_set(void **state)
{
    (void)state;
    struct wb_stream *stream = open_stream("serial:" PORT ",115200,8n1,dtr=on,rts=off");
    assert_true(ask_shim("wb_shim_modem_lines") & TIOCM_DTR);
    assert_false(ask_shim("wb_shim_modem_lines") & TIOCM_RTS);
    wb_stream_close(stream);
    stream = open_stream("serial:" PORT ",115200,8n1,dtr=off,rts=on");
    assert_false(ask_shim("wb_shim_modem_lines") & TIOCM_DTR);
    assert_true(ask_shim("wb_shim_modem_lines") & TIOCM_RTS);
    wb_stream_close(stream);
}

static bool hangs_up_at_closing(const struct bench *bench, const char *address)
{
    struct termios set;
    assert_int_equal(tcgetattr(bench->master, &set), 0);
    set.c_cflag |= HUPCL;
    assert_int_equal(tcsetattr(bench->master, TCSANOW, &set), 0);
    struct wb_stream *const stream = open_stream(address);
    assert_int_equal(tcgetattr(bench->master, &set), 0);
    wb_stream_close(stream);
    return (set.c_cflag & HUPCL) != 0;
}

static void dtr_stays_after_closing_if_configured(void **state)
{
    const struct bench *const bench = *state;
    assert_true(hangs_up_at_closing(bench, "serial:" PORT ",115200,8n1"));
    assert_false(hangs_up_at_closing(bench, "serial:" PORT ",115200,8n1,dtr=off"));
    assert_true(hangs_up_at_closing(bench, "serial:" PORT ",115200,8n1,dtr=on"));
    assert_false(hangs_up_at_closing(bench, "serial:" PORT ",115200,8n1,dtr=keep"));
    assert_true(ask_shim("wb_shim_modem_lines") & TIOCM_DTR);
}

/* A command for the stage opens its port, closes it, and the next opens it again. */
static void stages_port_keeps_dtr_by_default(void **state)
{
    const struct bench *const bench = *state;
    struct wb_rig rig = {.time_scale = 1.0};
    struct wb_acquisition *acquisition;
    struct termios set;
    rig.stage.axis = 'X';
    rig.stage.down = 1;
    strcpy(rig.stage.protocol, "grbl");
    for (int i = 0; i < 2; i++) {
        strcpy(rig.stage.address, i ? "serial:" PORT ",115200,dtr=on" : "serial:" PORT ",115200");
        assert_int_equal(tcgetattr(bench->master, &set), 0);
        set.c_cflag |= HUPCL;
        assert_int_equal(tcsetattr(bench->master, TCSANOW, &set), 0);
        assert_int_equal(wb_acquisition_open(&acquisition, &rig, WB_ACQUISITION_STAGE, NULL),
                         WB_OK);
        assert_int_equal(tcgetattr(bench->master, &set), 0);
        assert_int_equal((set.c_cflag & HUPCL) != 0, i);
        wb_acquisition_close(acquisition);
    }
}

static void bytes_pass_unchanged_in_both_directions(void **state)
{
    struct bench *bench = *state;
    struct wb_stream *stream = open_stream("serial:" PORT ",9600");
    uint8_t sent[256], got[512];
    for (int i = 0; i < 256; i++)
        sent[i] = (uint8_t)i;
    size_t n = 99;
    assert_int_equal(wb_stream_read(stream, got, sizeof got, &n), WB_OK);
    assert_int_equal(n, 0);

    assert_int_equal(write(bench->master, sent, sizeof sent), sizeof sent);
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
        struct pollfd wait = {.fd = bench->master, .events = POLLIN};
        assert_int_equal(poll(&wait, 1, 2000), 1);
        ssize_t part = read(bench->master, got + total, sizeof got - total);
        assert_true(part > 0);
        total += (size_t)part;
    }
    assert_memory_equal(got, sent, sizeof sent);
    wb_stream_close(stream);
}

static void write_that_nobody_takes_times_out(void **state)
{
    struct bench *bench = *state;
    struct wb_stream *stream = open_stream("serial:" PORT);
    static const uint8_t many[1 << 20];
    assert_int_equal(wb_stream_write(stream, many, sizeof many), WB_ERR_TIMEOUT);
    assert_non_null(strstr(bench->message, "within 50 ms"));
    wb_stream_close(stream);
}

static void unplugged_port_is_reported_and_found_again(void **state)
{
    struct bench *bench = *state;
    struct wb_stream *stream = open_stream("serial:" PORT ",19200");
    assert_int_equal(write(bench->master, "12.5\n", 5), 5);
    close(bench->master);
    bench->master = -1;
    uint8_t got[64];
    size_t n = 0;
    /* Pending bytes may still arrive or be lost with the port; then the port is disconnected. */
    enum wb_status status = wb_stream_read(stream, got, sizeof got, &n);
    if (status == WB_OK)
        status = wb_stream_read(stream, got, sizeof got, &n);
    assert_int_equal(status, WB_ERR_IO);
    assert_non_null(strstr(bench->message, PORT));
    assert_non_null(strstr(bench->message, "was disconnected"));
    /* Attempts to reopen it give no message. */
    bench->message[0] = '\0';
    unsetenv("WB_SHIM_DEVICE");
    for (int i = 0; i < 3; i++)
        assert_false(wb_stream_reopen(stream));
    assert_string_equal(bench->message, "");

    /* Plugged in again, the same stream continues with its line settings. */
    lend_device(bench);
    assert_true(wb_stream_reopen(stream));
    assert_int_equal(write(bench->master, "0.25\n", 5), 5);
    wait_readable(stream);
    assert_int_equal(wb_stream_read(stream, got, sizeof got, &n), WB_OK);
    assert_int_equal(n, 5);
    assert_memory_equal(got, "0.25\n", 5);
    struct termios set;
    assert_int_equal(tcgetattr(bench->master, &set), 0);
    assert_int_equal(cfgetispeed(&set), B19200);
    wb_stream_close(stream);
}

static void busy_port_says_so(void **state)
{
    struct bench *bench = *state;
    struct wb_stream *first = open_stream("serial:" PORT), *second = NULL;
    /* The lock of the first also excludes root. */
    assert_int_equal(wb_stream_open(&second, "serial:" PORT), WB_ERR_BUSY);
    assert_null(second);
    assert_non_null(strstr(bench->message, "in use by another program"));
    wb_stream_close(first);
    /* The kernel's error for users other than root while TIOCEXCL is set. */
    setenv("WB_SHIM_ERRNO", "16", 1);
    assert_int_equal(wb_stream_open(&second, "serial:" PORT), WB_ERR_BUSY);
    assert_non_null(strstr(bench->message, "in use by another program"));
    unsetenv("WB_SHIM_ERRNO");
    first = open_stream("serial:" PORT);
    wb_stream_close(first);
}

static void forbidden_port_names_the_group_to_join(void **state)
{
    struct bench *bench = *state;
    struct wb_stream *stream = NULL;
    setenv("WB_SHIM_ERRNO", "13", 1);
    assert_int_equal(wb_stream_open(&stream, "serial:" PORT), WB_ERR_PERMISSION);
    assert_non_null(strstr(bench->message, "usermod -aG dialout $USER"));
    assert_non_null(strstr(bench->message, "log in again"));
}

static void missing_port_lists_those_that_exist(void **state)
{
    struct bench *bench = *state;
    struct wb_stream *stream = NULL;
    assert_int_equal(wb_stream_open(&stream, "serial:/dev/ttyWB7,9600"), WB_ERR_NOT_FOUND);
    assert_non_null(strstr(bench->message, "'/dev/ttyWB7' does not exist"));
    assert_non_null(strstr(bench->message, PORT));

    char link[128];
    snprintf(link, sizeof link, "%s/ttyWB0", bench->folder);
    assert_int_equal(unlink(link), 0);
    assert_int_equal(wb_stream_open(&stream, "serial:/dev/ttyWB7,9600"), WB_ERR_NOT_FOUND);
    assert_non_null(strstr(bench->message, "has no serial port"));
}

static void pseudo_terminal_is_sent_to_its_own_scheme(void **state)
{
    struct bench *bench = *state;
    struct wb_stream *stream = NULL;
    char address[128];
    snprintf(address, sizeof address, "serial:%s", bench->slave);
    assert_int_equal(wb_stream_open(&stream, address), WB_ERR_UNSUPPORTED);
    assert_non_null(strstr(bench->message, "pty:"));
}

/* The sysfs folder of an FTDI port, with a latency timer of `ms`; "" removes it. */
static void set_latency(const struct bench *bench, const char *text)
{
    static const char *const folders[] = {"/port", "/port/device"};
    char path[160], link[128];
    snprintf(link, sizeof link, "%s/ttyWB0", bench->folder);
    for (int i = 0; i < 2 && text[0]; i++) {
        snprintf(path, sizeof path, "%s%s", bench->folder, folders[i]);
        mkdir(path, 0700);
    }
    snprintf(path, sizeof path, "%s/port/device/latency_timer", bench->folder);
    unlink(path);
    if (text[0]) {
        unlink(link);
        assert_int_equal(symlink("port", link), 0);
        assert_int_equal(wb_file_write(path, text, strlen(text)), WB_OK);
    }
    for (int i = 1; i >= 0 && !text[0]; i--) {
        snprintf(path, sizeof path, "%s%s", bench->folder, folders[i]);
        rmdir(path);
    }
}

static void latency_timer_that_stays_high_is_reported(void **state)
{
    const struct bench *bench = *state;
    static const struct {
        const char *timer, *words;
    } cases[] = {{"16\n", "for up to 16 ms"}, {"2\n", "for up to 2 ms"}, {"1\n", ""}};
    struct wb_stream *stream = open_stream("serial:" PORT);
    assert_string_equal(wb_stream_caution(stream), ""); /* no FTDI adapter */
    wb_stream_close(stream);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        set_latency(bench, cases[i].timer);
        stream = open_stream("serial:" PORT);
        const char *const caution = wb_stream_caution(stream);
        if ((caution[0] == '\0') != (cases[i].words[0] == '\0') || !strstr(caution, cases[i].words))
            fail_msg("case %zu: '%s'", i, caution);
        assert_true(caution[0] == '\0' || strstr(caution, "tee /sys/class/tty/ttyWB0/device/"));
        wb_stream_close(stream);
    }
    set_latency(bench, "");
}

static enum wb_status count_latency(void *context, const struct wb_event *event)
{
    int *const n = context;
    *n += strcmp(event->kind, "latency") == 0 && strstr(event->text, "for up to 16 ms");
    return WB_OK;
}

/* A line for the operator at the start, and an event of the recording. */
static void latency_is_reported_at_the_start_and_recorded(void **state)
{
    struct bench *bench = *state;
    struct wb_acquisition *acquisition;
    struct wb_recording *recording;
    struct wb_writer *writer;
    struct wb_rig rig = {.gravity = 9.81, .time_scale = 1.0};
    char path[96];
    int id, n = 0;
    strcpy(rig.load_cell.protocol, "generic");
    strcpy(rig.load_cell.address, "serial:" PORT);
    set_latency(bench, "16\n");
    snprintf(path, sizeof path, "%s/a.wbr", bench->folder);
    assert_int_equal(wb_recording_create(&recording, path), WB_OK);
    assert_int_equal(wb_recording_add_stream(recording, WB_ROLE_LOAD, "a", "generic", "", &id),
                     WB_OK);
    assert_int_equal(wb_writer_start(&writer, recording, NULL), WB_OK);
    assert_int_equal(wb_acquisition_open(&acquisition, &rig, WB_ACQUISITION_LOAD, NULL), WB_OK);
    wb_acquisition_start(acquisition, writer);
    assert_non_null(strstr(bench->message, "load: the adapter at '" PORT "'"));
    wb_acquisition_close(acquisition);
    assert_int_equal(wb_writer_finish(writer), WB_OK);
    assert_int_equal(wb_recording_open(&recording, path), WB_OK);
    assert_int_equal(wb_recording_each_event(recording, count_latency, &n), WB_OK);
    assert_int_equal(n, 1);
    assert_int_equal(wb_recording_close(recording), WB_OK);
    unlink(path);
    set_latency(bench, "");
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
#define FACT(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
        FACT(line_settings_reach_the_terminal),
        FACT(dtr_and_rts_lines_are_set),
        FACT(dtr_stays_after_closing_if_configured),
        FACT(stages_port_keeps_dtr_by_default),
        FACT(bytes_pass_unchanged_in_both_directions),
        FACT(write_that_nobody_takes_times_out),
        FACT(unplugged_port_is_reported_and_found_again),
        FACT(busy_port_says_so),
        FACT(forbidden_port_names_the_group_to_join),
        FACT(missing_port_lists_those_that_exist),
        FACT(pseudo_terminal_is_sent_to_its_own_scheme),
        FACT(latency_timer_that_stays_high_is_reported),
        FACT(latency_is_reported_at_the_start_and_recorded),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
