/* The live line never waits for its terminal, and leaves it to others where it should. */
#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include "base/log.h"
#include "base/timing.h"
#include "cli/live_line.h"
#include "cli/talk_private.h"
#include "fixtures/virtual/virtual_time.h"
#include "tests/check.h"

#define WB_LOG_DOMAIN "test"

static char heard[1 << 20];

/* Reads what comes out of a descriptor until these words have come; NULL: until nothing waits. */
static void listen_until(int descriptor, const char *words)
{
    size_t n = strlen(heard);
    while (!wb_talk_flush() || (words && !strstr(heard, words))) {
        struct pollfd polled = {.fd = descriptor, .events = POLLIN};
        const ssize_t got =
            poll(&polled, 1, 10) > 0 ? read(descriptor, heard + n, sizeof heard - 1 - n) : 0;
        n += got > 0 ? (size_t)got : 0;
        heard[n] = '\0';
    }
}

/* Messages and lines far beyond what `ours` takes, which nobody reads; true when nothing waited: in
 * virtual time only waits take time, and what would block is ended by alarm(). */
static bool talks_without_waiting(void)
{
    char message[512];
    memset(message, 'x', sizeof message - 1);
    message[sizeof message - 1] = '\0';
    wb_virtual_time_begin(WB_VIRTUAL_TIME_HOST_DATE);
    for (int i = 0; i < 400; i++) {
        wb_warn("%d %s", i, message);
        wb_live_line_show("line %d", i);
    }
    const bool waited = wb_time_now_ns() != WB_VIRTUAL_TIME_START_NS;
    wb_virtual_time_end();
    return !waited;
}

/* Perhaps in parts: the kernel's own buffers may make room in between. */
static int said_to_be_lost(void)
{
    static const char words[] = "wirebench: ", what[] = " messages were dropped";
    int sum = 0;
    for (const char *at = heard; (at = strstr(at, words)); at += strlen(words)) {
        char *end;
        const long n = strtol(at + strlen(words), &end, 10);
        if (strncmp(end, what, strlen(what)) == 0)
            sum += (int)n;
    }
    return sum;
}

static void assert_never_waits(int theirs, int ours)
{
    const int kept = dup(STDERR_FILENO);
    heard[0] = '\0';
    alarm(20); /* what hangs is ended */
    assert_true(dup2(ours, STDERR_FILENO) >= 0);
    wb_live_line_open();
    const bool free = talks_without_waiting();
    const uint64_t lost = wb_talk_lost();
    listen_until(theirs, NULL);
    wb_warn("at last");
    listen_until(theirs, "warning: at last");
    wb_live_line_close();
    dup2(kept, STDERR_FILENO);
    close(kept);
    alarm(0);
    assert_true(free);
    assert_in_range(lost, 1, 399);
    assert_non_null(strstr(heard, "warning: 0 xxx"));
    assert_int_equal(said_to_be_lost(), lost);
    assert_non_null(strstr(heard, "warning: at last"));
}

static void a_blocked_terminal_loses_messages_and_counts_them(void **state)
{
    (void)state;
    int theirs, ours;
    assert_int_equal(openpty(&theirs, &ours, NULL, NULL, NULL), 0);
    assert_int_equal(fcntl(theirs, F_SETFL, O_NONBLOCK), 0);
    assert_never_waits(theirs, ours);
    close(theirs);
    close(ours);
}

/* The last line of a recording that is whole already. */
static void the_result_does_not_wait_for_a_blocked_terminal(void **state)
{
    (void)state;
    int theirs, ours;
    assert_int_equal(openpty(&theirs, &ours, NULL, NULL, NULL), 0);
    const int modes = fcntl(ours, F_GETFL);
    assert_int_equal(fcntl(ours, F_SETFL, modes | O_NONBLOCK), 0);
    while (write(ours, "x", 1) == 1) {
    }
    assert_int_equal(fcntl(ours, F_SETFL, modes), 0);
    fflush(stdout);
    const int kept = dup(STDOUT_FILENO);
    alarm(20); /* what hangs is ended */
    assert_true(dup2(ours, STDOUT_FILENO) >= 0);
    wb_live_line_print("the result\n");
    fflush(stdout);
    dup2(kept, STDOUT_FILENO);
    alarm(0);
    close(kept);
    close(theirs);
    close(ours);
}

/* What is read is whole, on a terminal as in a file. */
static void the_result_reaches_who_reads(void **state)
{
    (void)state;
    int theirs, ours;
    assert_int_equal(openpty(&theirs, &ours, NULL, NULL, NULL), 0);
    assert_int_equal(fcntl(theirs, F_SETFL, O_NONBLOCK), 0);
    fflush(stdout);
    const int kept = dup(STDOUT_FILENO);
    assert_true(dup2(ours, STDOUT_FILENO) >= 0);
    wb_live_line_print("the result\n");
    dup2(kept, STDOUT_FILENO);
    heard[0] = '\0';
    alarm(20);
    listen_until(theirs, "result\r\n");
    alarm(0);
    close(kept);
    close(theirs);
    close(ours);
    assert_string_equal(heard, "the result\r\n");
}

static void a_pipe_nobody_reads_loses_messages_and_counts_them(void **state)
{
    (void)state;
    int ends[2];
    assert_int_equal(pipe(ends), 0);
    assert_int_equal(fcntl(ends[0], F_SETFL, O_NONBLOCK), 0);
    assert_never_waits(ends[0], ends[1]);
    close(ends[0]);
    close(ends[1]);
}

static void a_pipe_without_reader_is_survived(void **state)
{
    (void)state;
    int ends[2];
    assert_int_equal(pipe(ends), 0);
    close(ends[0]);
    signal(SIGPIPE, SIG_IGN);
    const int kept = dup(STDERR_FILENO);
    assert_true(dup2(ends[1], STDERR_FILENO) >= 0);
    wb_live_line_open();
    wb_warn("nobody hears this");
    wb_warn("nor this");
    const uint64_t lost = wb_talk_lost();
    wb_live_line_close();
    dup2(kept, STDERR_FILENO);
    close(kept);
    close(ends[1]);
    assert_true(lost >= 1);
}

/* In a terminal of its own: 0 when all is as it should be, else the number of what is not. */
static int in_terminal(void)
{
    struct termios before, during, after;
    tcgetattr(STDIN_FILENO, &before);
    wb_live_line_open();
    tcgetattr(STDIN_FILENO, &during);
    wb_live_line_close();
    tcgetattr(STDIN_FILENO, &after);
    if (!(before.c_iflag & IXON) || (during.c_iflag & IXON))
        return 1; /* Ctrl-S would halt us */
    if ((during.c_lflag & (ICANON | ECHO)) || !(during.c_lflag & ISIG))
        return 2;
    if (after.c_iflag != before.c_iflag || after.c_lflag != before.c_lflag)
        return 3;
    /* A process group of its own is in the background. */
    signal(SIGTTOU, SIG_IGN);
    signal(SIGTTIN, SIG_IGN);
    const pid_t child = fork();
    if (child == 0) {
        setpgid(0, 0);
        wb_live_line_open();
        tcgetattr(STDIN_FILENO, &during);
        const int key = wb_live_line_key();
        wb_live_line_close();
        _exit(during.c_lflag != before.c_lflag || key != 0);
    }
    int code;
    waitpid(child, &code, 0);
    return code == 0 ? 0 : 4;
}

static void keys_are_taken_in_the_foreground_only_and_ctrl_s_is_off(void **state)
{
    (void)state;
    int theirs, code;
    const pid_t child = forkpty(&theirs, NULL, NULL, NULL);
    assert_true(child >= 0);
    if (child == 0)
        _exit(in_terminal());
    assert_int_equal(waitpid(child, &code, 0), child);
    close(theirs);
    assert_true(WIFEXITED(code));
    assert_int_equal(WEXITSTATUS(code), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_blocked_terminal_loses_messages_and_counts_them),
        cmocka_unit_test(a_pipe_nobody_reads_loses_messages_and_counts_them),
        cmocka_unit_test(the_result_does_not_wait_for_a_blocked_terminal),
        cmocka_unit_test(the_result_reaches_who_reads),
        cmocka_unit_test(a_pipe_without_reader_is_survived),
        cmocka_unit_test(keys_are_taken_in_the_foreground_only_and_ctrl_s_is_off),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
