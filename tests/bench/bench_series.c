/* CPU cost of the live views and of a series: one test of the virtual rig in real time, recorded by
 * `wirebench record` without views, and then as the first test of a series with the terminal view
 * and the web page, which a client reads. Measured is the CPU time of the recorder and its views
 * until the end of the recording, and separately that of the evaluation by the series.
 *
 *     bench_series WIREBENCH SOURCE_ROOT [TRAVEL_MM]
 *
 * The goal is said, and fails nothing: no drop, and at most 15 % of a core more than without. */
#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/timing.h"
#include "base/units.h"
#include "tests/folder.h"

#define GOAL 0.15 /* of a core */
#define PATIENCE_S 300.0

static char folder[32], rig_yaml[64], specimen[4096], output[1 << 20];
static size_t n_output;
static const char *tool;

/* CPU time of a process and of its ended children, s. */
static double cpu_of(pid_t process)
{
    char path[64], text[1024] = "";
    unsigned long ticks[4] = {0};
    snprintf(path, sizeof path, "/proc/%d/stat", (int)process);
    const int file = open(path, O_RDONLY);
    assert_true(file >= 0 && read(file, text, sizeof text - 1) > 0);
    close(file);
    /* After the process name, which may contain any character: state, ten numbers, utime, stime,
     * cutime, cstime. */
    assert_int_equal(sscanf(strrchr(text, ')') + 1,
                            " %*c %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %lu %lu %lu %lu",
                            &ticks[0], &ticks[1], &ticks[2], &ticks[3]),
                     4);
    return (double)(ticks[0] + ticks[1] + ticks[2] + ticks[3]) / (double)sysconf(_SC_CLK_TCK);
}

/* Starts the tool on a new pseudo-terminal, *terminal. */
static pid_t start(const char *const *arguments, int *terminal)
{
    const struct winsize window = {.ws_row = 42, .ws_col = 120};
    const pid_t process = forkpty(terminal, NULL, NULL, &window);
    assert_true(process >= 0);
    if (process == 0) {
        setenv("TERM", "xterm-256color", 1);
        setenv("LC_ALL", "C.UTF-8", 1);
        execv(tool, (char *const *)arguments);
        _exit(127);
    }
    return process;
}

/* Reads the output of the terminal and of the page's client (-1: no client) until the words appear.
 * False if the program ends or the time limit is reached before. */
static bool read_until(int terminal, int client, const char *words)
{
    const int64_t end_ns = wb_time_now_ns() + wb_ns_from_seconds(PATIENCE_S);
    static char page[65536];
    while (!strstr(output, words) && wb_time_now_ns() < end_ns) {
        struct pollfd polled[] = {{.fd = terminal, .events = POLLIN},
                                  {.fd = client, .events = POLLIN}};
        (void)poll(polled, 2, 200);
        if (polled[1].revents && recv(client, page, sizeof page, MSG_DONTWAIT) == 0)
            client = -1;
        if (!polled[0].revents)
            continue;
        if (n_output > sizeof output / 2) /* the view draws a lot */
            n_output = 0;
        const ssize_t n = read(terminal, output + n_output, sizeof output - 1 - n_output);
        if (n <= 0)
            return strstr(output, words) != NULL;
        n_output += (size_t)n;
        output[n_output] = '\0';
    }
    return strstr(output, words) != NULL;
}

static void expect(int terminal, int client, const char *words)
{
    if (!read_until(terminal, client, words))
        fail_msg("'%s' not in the output: %.2000s", words, output);
}

static void answer(int terminal)
{
    n_output = 0;
    output[0] = '\0';
    assert_int_equal(write(terminal, "\n", 1), 1);
}

/* Waits for the end of the program, reading what it still prints. */
static void wait_for(pid_t process, int terminal)
{
    int status = 0;
    while (waitpid(process, &status, WNOHANG) == 0)
        (void)read_until(terminal, -1, "\001");
    assert_true(WIFEXITED(status));
    close(terminal);
}

static int free_port(void)
{
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t length = sizeof address;
    const int descriptor = socket(AF_INET, SOCK_STREAM, 0);
    assert_int_equal(bind(descriptor, (struct sockaddr *)&address, sizeof address), 0);
    assert_int_equal(getsockname(descriptor, (struct sockaddr *)&address, &length), 0);
    close(descriptor);
    return ntohs(address.sin_port);
}

/* Requests the page's events as a browser does. The server is up before the test begins. */
static int follow_page(int port)
{
    static const char request[] = "GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n";
    const struct sockaddr_in address = {.sin_family = AF_INET,
                                        .sin_port = htons((uint16_t)port),
                                        .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    for (int i = 0; i < 1000; i++) {
        const int client = socket(AF_INET, SOCK_STREAM, 0);
        if (connect(client, (const struct sockaddr *)&address, sizeof address) == 0) {
            assert_int_equal(send(client, request, sizeof request - 1, 0), sizeof request - 1);
            return client;
        }
        close(client);
        usleep(10000);
    }
    fail_msg("the page does not answer at port %d", port);
    return -1;
}

struct cost {
    double cpu, seconds; /* of the recording; of the recorder's life until its end */
    double after;        /* CPU time after it: alignment, table, plot */
    long drops;
};

static void take_end(pid_t process, int64_t begun_ns, struct cost *cost)
{
    const char *at = strstr(output, " drops");
    cost->cpu = cpu_of(process);
    cost->seconds = wb_seconds_from_ns(wb_time_now_ns() - begun_ns);
    while (at > output && at[-1] >= '0' && at[-1] <= '9')
        at--;
    cost->drops = atol(at);
}

static void record_alone(const char *travel, struct cost *cost)
{
    char path[64];
    int terminal;
    snprintf(path, sizeof path, "%s/alone.wbr", folder);
    const char *const arguments[] = {tool, "record", rig_yaml,      "--specimen", specimen,
                                     "-o", path,     "--travel-mm", travel,       NULL};
    const int64_t begun_ns = wb_time_now_ns();
    const pid_t process = start(arguments, &terminal);
    /* The last line of output. The CPU time can be read until the process is reaped. */
    expect(terminal, -1, " drops\r\n");
    take_end(process, begun_ns, cost);
    wait_for(process, terminal);
}

static void record_series(const char *travel, struct cost *cost)
{
    char yaml[64], text[4400], port_text[16];
    int terminal;
    const int port = free_port();
    snprintf(port_text, sizeof port_text, "%d", port);
    snprintf(yaml, sizeof yaml, "%s/series.yaml", folder);
    FILE *const file = fopen(yaml, "w");
    assert_non_null(file);
    snprintf(text, sizeof text, "series: s\nspecimen: %s\nspecimens: 1\ntravel_mm: %s\n", specimen,
             travel);
    fputs(text, file);
    fclose(file);
    const char *const arguments[] = {tool,    "record", rig_yaml,  "--series", yaml, "--operator",
                                     "bench", "--live", "--serve", port_text,  NULL};
    const pid_t process = start(arguments, &terminal);
    expect(terminal, -1, "press Enter");
    const double before = cpu_of(process);
    const int64_t begun_ns = wb_time_now_ns();
    answer(terminal);
    const int client = follow_page(port);
    expect(terminal, client, " drops\r\n");
    take_end(process, begun_ns, cost);
    cost->cpu -= before;
    expect(terminal, -1, "Enter: keep it");
    cost->after = cpu_of(process) - before - cost->cpu;
    close(client);
    answer(terminal);
    wait_for(process, terminal);
}

static pid_t start_rig(const char *root)
{
    char bench[4200], log[64], text[4096] = "";
    snprintf(bench, sizeof bench, "%s/fixtures/rigs/paper.yaml", root);
    snprintf(specimen, sizeof specimen, "%.4000s/fixtures/specimens/type1-L85-1.yaml", root);
    snprintf(rig_yaml, sizeof rig_yaml, "%s/rig/rig.yaml", folder);
    snprintf(log, sizeof log, "%s/rig.log", folder);
    const pid_t process = fork();
    assert_true(process >= 0);
    if (process == 0) {
        char run[64];
        snprintf(run, sizeof run, "%s/rig", folder);
        const int file = open(log, O_WRONLY | O_CREAT, 0600);
        dup2(file, STDERR_FILENO);
        execl(tool, tool, "rig", bench, "--specimen", specimen, "--run", run, (char *)NULL);
        _exit(127);
    }
    for (int i = 0; i < 3000 && !strstr(text, "ready"); i++) {
        usleep(10000);
        const int file = open(log, O_RDONLY);
        const ssize_t n = file >= 0 ? read(file, text, sizeof text - 1) : 0;
        text[n > 0 ? n : 0] = '\0';
        close(file);
    }
    assert_non_null(strstr(text, "ready"));
    return process;
}

int main(int argc, char **argv)
{
    struct cost alone = {0}, series = {0};
    if (argc < 3) {
        fprintf(stderr, "usage: bench_series WIREBENCH SOURCE_ROOT [TRAVEL_MM]\n");
        return 2;
    }
    const char *const travel = argc > 3 ? argv[3] : "10";
    tool = argv[1];
    assert_true(temporary_folder_make(folder));
    const pid_t rig = start_rig(argv[2]);
    record_alone(travel, &alone);
    record_series(travel, &series);
    kill(rig, SIGINT);
    waitpid(rig, NULL, 0);
    const double more = series.cpu / series.seconds - alone.cpu / alone.seconds;
    printf("alone:                      %.2f s of CPU in %.1f s, %.1f %% of a core, %ld drops\n",
           alone.cpu, alone.seconds, 100.0 * alone.cpu / alone.seconds, alone.drops);
    printf("with view, page and series: %.2f s of CPU in %.1f s, %.1f %% of a core, %ld drops\n",
           series.cpu, series.seconds, 100.0 * series.cpu / series.seconds, series.drops);
    printf("%.1f %% of a core more; goal: at most %.0f %%, and no drop\n", 100.0 * more,
           100.0 * GOAL);
    printf("ratio %.2f; after the test, with nothing recorded: %.2f s of CPU\n",
           series.cpu * alone.seconds / (alone.cpu * series.seconds), series.after);
    return temporary_folder_remove(folder);
}
