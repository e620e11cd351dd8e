/* A terminal with a slow connection: it accepts BYTES_PER_SECOND, and its window changes its size
 * all the time, down to a single cell. SIGUSR1 makes it hang, a second one makes it continue; it
 * prints "the terminal is full" once a program that writes to it would block. Standard input gives
 * its keys; its output goes to standard output.
 *
 *     slow_terminal BYTES_PER_SECOND COMMAND...
 */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

#define TURN_MS 20
#define TURNS_PER_SIZE 5

static volatile sig_atomic_t hangs;

static void hang_or_go_on(int number)
{
    (void)number;
    hangs = !hangs;
}

static const struct winsize sizes[] = {
    {.ws_row = 40, .ws_col = 110}, {.ws_row = 16, .ws_col = 60},  {.ws_row = 90, .ws_col = 300},
    {.ws_row = 14, .ws_col = 90},  {.ws_row = 120, .ws_col = 70}, {.ws_row = 1, .ws_col = 1},
};

/* Copies at most `most` bytes; false at the end. */
static bool copy(int from, int to, size_t most)
{
    char bytes[4096];
    const ssize_t n = read(from, bytes, most < sizeof bytes ? most : sizeof bytes);
    if (n < 0 && errno == EINTR)
        return true;
    return n > 0 && write(to, bytes, (size_t)n) == n;
}

/* Whether a write to the terminal would block. Opened each time, because a terminal that is open
 * never reads as ended. */
static bool is_full(int terminal)
{
    const char *const path = ptsname(terminal);
    const int program = path ? open(path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC) : -1;
    struct pollfd polled = {.fd = program, .events = POLLOUT};
    if (program < 0)
        return false;
    const bool full = poll(&polled, 1, 0) == 0;
    close(program);
    return full;
}

static void serve(int terminal, size_t bytes_per_turn)
{
    bool was_full = false;
    for (unsigned turn = 0;; turn++) {
        struct pollfd keys = {.fd = STDIN_FILENO, .events = POLLIN};
        struct pollfd shown = {.fd = terminal, .events = POLLIN};
        if (poll(&keys, 1, TURN_MS) > 0)
            (void)copy(STDIN_FILENO, terminal, 16);
        if (turn % TURNS_PER_SIZE == 0)
            (void)ioctl(terminal, TIOCSWINSZ,
                        &sizes[turn / TURNS_PER_SIZE % (sizeof sizes / sizeof sizes[0])]);
        if (hangs && !was_full && is_full(terminal)) {
            was_full = true;
            printf("the terminal is full\n");
            fflush(stdout);
        }
        if (!hangs && poll(&shown, 1, 0) > 0 && !copy(terminal, STDOUT_FILENO, bytes_per_turn))
            return;
    }
}

int main(int argc, char **argv)
{
    int terminal, status;
    const long rate = argc > 2 ? atol(argv[1]) : 0;
    if (rate < 1000 / TURN_MS) {
        fprintf(stderr, "usage: slow_terminal BYTES_PER_SECOND COMMAND...\n");
        return 2;
    }
    const pid_t process = forkpty(&terminal, NULL, NULL, &sizes[0]);
    if (process == 0) {
        execvp(argv[2], argv + 2);
        _exit(127);
    }
    if (process < 0)
        return 1;
    signal(SIGUSR1, hang_or_go_on);
    serve(terminal, (size_t)(rate * TURN_MS / 1000));
    return waitpid(process, &status, 0) == process && WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}
