#include "cli/live_line.h"

#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include "base/log.h"
#include "base/progress.h"
#include "base/units.h"

#define REDRAW_NS (200 * WB_NS_PER_MS)

static struct {
    bool open, draws, has_keys, drawn;
    struct termios saved;
    int64_t drawn_ns;
    char text[512];
} live;

static void erase(void)
{
    if (live.drawn)
        fputs("\r\033[K", stderr);
    live.drawn = false;
}

static void log_above(void *context, enum wb_log_level level, const char *domain,
                      const char *message)
{
    static const char *const levels[] = {"error: ", "warning: ", "", "debug: "};
    (void)context;
    (void)domain;
    const bool redraw = live.drawn;
    erase();
    fprintf(stderr, "wirebench: %s%s\n", levels[level], message);
    if (redraw) {
        fputs(live.text, stderr);
        live.drawn = true;
    }
}

void wb_live_line_open(void)
{
    static bool registered;
    live.open = true;
    live.draws = isatty(STDERR_FILENO);
    live.has_keys = live.draws && isatty(STDIN_FILENO) && tcgetattr(STDIN_FILENO, &live.saved) == 0;
    if (live.has_keys) {
        struct termios keys = live.saved;
        keys.c_lflag &= ~(tcflag_t)(ICANON | ECHO); /* Ctrl-C stays a signal */
        keys.c_cc[VMIN] = 0;
        keys.c_cc[VTIME] = 0;
        tcsetattr(STDIN_FILENO, TCSANOW, &keys);
    }
    if (live.draws)
        wb_log_set_sink(log_above, NULL);
    if (!registered)
        atexit(wb_live_line_close);
    registered = true;
}

bool wb_live_line_due(void)
{
    return live.draws && wb_progress_now_ns() - live.drawn_ns >= REDRAW_NS;
}

void wb_live_line_show(const char *format, ...)
{
    if (!live.draws)
        return;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(live.text, sizeof live.text, format, arguments);
    va_end(arguments);
    struct winsize window;
    if (ioctl(STDERR_FILENO, TIOCGWINSZ, &window) == 0 && window.ws_col > 1 &&
        strlen(live.text) >= window.ws_col)
        live.text[window.ws_col - 1] = '\0';
    fprintf(stderr, "\r%s\033[K", live.text);
    fflush(stderr);
    live.drawn = true;
    live.drawn_ns = wb_progress_now_ns();
}

int wb_live_line_key(void)
{
    unsigned char key;
    struct pollfd polled = {.fd = STDIN_FILENO, .events = POLLIN};
    if (!live.has_keys || poll(&polled, 1, 0) <= 0 || read(STDIN_FILENO, &key, 1) != 1)
        return 0;
    return key;
}

void wb_live_line_close(void)
{
    if (!live.open)
        return;
    erase();
    if (live.has_keys)
        tcsetattr(STDIN_FILENO, TCSANOW, &live.saved);
    if (live.draws)
        wb_log_set_sink(NULL, NULL);
    live.open = false;
    live.draws = live.has_keys = false;
}
