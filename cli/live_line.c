#include "cli/live_line.h"

#include <poll.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include "base/log.h"
#include "base/timing.h"
#include "base/units.h"
#include "cli/talk.h"

#define REDRAW_NS (200 * WB_NS_PER_MS)
/* Longest wait for a terminal that hangs, at the end. */
#define PATIENCE_MS 300

#define ERASE "\r\033[K"

/* Any thread calls the log's sink; the lock is never held while waiting. */
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

static struct {
    bool open, draws, may_have_keys, has_keys, drawn;
    struct termios saved;
    int64_t drawn_ns;
    char text[512];
} live;

const char *wb_live_line_level(enum wb_log_level level)
{
    static const char *const levels[] = {"error: ", "warning: ", "", "debug: "};
    return levels[level];
}

void wb_live_line_log(void *context, enum wb_log_level level, const char *domain,
                      const char *message)
{
    char text[3072];
    (void)context;
    pthread_mutex_lock(&lock);
    snprintf(text, sizeof text, "%swirebench: %s%s%s%s\n%s", live.drawn ? ERASE : "",
             wb_live_line_level(level), level == WB_LOG_DEBUG ? domain : "",
             level == WB_LOG_DEBUG ? ": " : "", message, live.drawn ? live.text : "");
    (void)wb_talk_say(text);
    pthread_mutex_unlock(&lock);
}

void wb_live_line_say(const char *text)
{
    pthread_mutex_lock(&lock);
    if (live.drawn)
        (void)wb_talk_say(ERASE);
    live.drawn = false;
    /* Line by line, because a text longer than the buffer would be dropped as a whole. */
    while (*text) {
        char line[3072];
        const size_t n = strcspn(text, "\n") + (strchr(text, '\n') != NULL);
        snprintf(line, sizeof line, "%.*s", (int)n, text);
        (void)wb_talk_say(line);
        text += n;
    }
    pthread_mutex_unlock(&lock);
}

/* --- keys --- */

static bool in_foreground(void)
{
    return tcgetpgrp(STDIN_FILENO) == getpgrp();
}

/* Switches to single keys without Enter. A process in the background must not change the terminal;
 * it does so once it is in the foreground. */
static void take_keys(void)
{
    if (live.has_keys || !live.may_have_keys || !in_foreground() ||
        tcgetattr(STDIN_FILENO, &live.saved) != 0)
        return;
    struct termios keys = live.saved;
    keys.c_lflag &= ~(tcflag_t)(ICANON | ECHO); /* Ctrl-C stays a signal */
    keys.c_iflag &= ~(tcflag_t)(IXON);          /* Ctrl-S would halt the output */
    keys.c_cc[VMIN] = 0;
    keys.c_cc[VTIME] = 0;
    live.has_keys = tcsetattr(STDIN_FILENO, TCSANOW, &keys) == 0;
}

int wb_live_line_key(void)
{
    unsigned char key;
    struct pollfd polled = {.fd = STDIN_FILENO, .events = POLLIN};
    take_keys();
    if (!live.has_keys || !in_foreground() || poll(&polled, 1, 0) <= 0 ||
        read(STDIN_FILENO, &key, 1) != 1)
        return 0;
    return key;
}

void wb_live_line_restore(const struct termios *modes, const char *sequence)
{
    /* Output that a slow terminal has not accepted yet belongs to the screen that was left, and
     * would delay the following messages. */
    (void)tcflush(STDERR_FILENO, TCOFLUSH);
    wb_live_line_say(sequence);
    live.has_keys = false;
    if (in_foreground() && tcsetattr(STDIN_FILENO, TCSANOW, modes) == 0)
        take_keys();
}

/* --- the line --- */

void wb_live_line_open(void)
{
    static bool registered;
    live.open = true;
    live.draws = isatty(STDERR_FILENO);
    live.may_have_keys = live.draws && isatty(STDIN_FILENO);
    wb_talk_open(STDERR_FILENO);
    take_keys();
    wb_log_set_sink(wb_live_line_log, NULL);
    if (!registered)
        atexit(wb_live_line_close);
    registered = true;
}

bool wb_live_line_due(void)
{
    return live.draws && wb_time_now_ns() - live.drawn_ns >= REDRAW_NS;
}

int wb_live_line_columns(void)
{
    struct winsize window;
    if (ioctl(STDERR_FILENO, TIOCGWINSZ, &window) == 0 && window.ws_col > 1)
        return window.ws_col - 1; /* a full line would wrap */
    return (int)sizeof live.text - 1;
}

void wb_live_line_show(const char *format, ...)
{
    if (!live.draws)
        return;
    char text[sizeof live.text + 16];
    const size_t columns = (size_t)wb_live_line_columns();
    pthread_mutex_lock(&lock);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(live.text, sizeof live.text, format, arguments);
    va_end(arguments);
    if (strlen(live.text) > columns)
        live.text[columns] = '\0';
    snprintf(text, sizeof text, "\r%s\033[K", live.text);
    /* A line queued behind a waiting message would be outdated. */
    if (wb_talk_flush()) {
        (void)wb_talk_say(text);
        live.drawn = true;
    }
    live.drawn_ns = wb_time_now_ns();
    pthread_mutex_unlock(&lock);
}

void wb_live_line_print(const char *text)
{
    if (!isatty(STDOUT_FILENO)) {
        fputs(text, stdout);
        return;
    }
    fflush(stdout);
    wb_talk_open(STDOUT_FILENO);
    (void)wb_talk_say(text);
    wb_talk_close(PATIENCE_MS);
}

void wb_live_line_close(void)
{
    if (!live.open)
        return;
    wb_log_set_sink(NULL, NULL);
    if (live.drawn)
        (void)wb_talk_say(ERASE);
    wb_talk_close(PATIENCE_MS);
    if (live.has_keys && in_foreground())
        tcsetattr(STDIN_FILENO, TCSANOW, &live.saved);
    live.open = false;
    live.draws = live.may_have_keys = live.has_keys = live.drawn = false;
}
