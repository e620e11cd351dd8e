#include "live/live_terminal.h"

#include <curses.h>
#include <errno.h>
#include <langinfo.h>
#include <locale.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include "base/timing.h"
#include "base/units.h"
#include "live/live_feed.h"
#include "live/live_history.h"
#include "live/live_plan.h"
#include "live/live_screen.h"

#define DRAW_NS (100 * WB_NS_PER_MS) /* between two drawings */

bool wb_live_terminal_is_there(void)
{
    return isatty(STDIN_FILENO) && isatty(STDERR_FILENO) && tcgetpgrp(STDIN_FILENO) == getpgrp();
}

/* Sends a key to the recorder; if the socket is full, the key is lost. */
static void send_key(int socket, int key)
{
    const struct wb_live_frame_key packet = {
        .header = wb_live_frame_header(WB_LIVE_FRAME_KEY, sizeof packet), .key = key};
    (void)send(socket, &packet, sizeof packet, MSG_DONTWAIT | MSG_NOSIGNAL);
}

static void handle_keys(int socket)
{
    for (int key = getch(); key != ERR; key = getch()) {
        if (key > 0 && key < 128 && strchr(WB_LIVE_FRAME_KEYS, key))
            send_key(socket, key);
        else if (key == KEY_RESIZE)
            clear();
    }
}

static void follow(int socket, struct wb_live_screen *screen, struct wb_live_history *history)
{
    int64_t drawn_ns = 0;
    bool goes_on = true;
    while (goes_on && !wb_live_feed_is_told_to_end()) {
        struct pollfd polled[] = {{.fd = socket, .events = POLLIN},
                                  {.fd = STDIN_FILENO, .events = POLLIN}};
        if (wb_time_wait(polled, 2, wb_time_now_ns() + 200 * WB_NS_PER_MS) < 0 && errno != EINTR)
            return;
        /* After a hangup the terminal is always readable. */
        if (polled[1].revents & (POLLHUP | POLLERR | POLLNVAL))
            return;
        goes_on = wb_live_history_receive(history, socket);
        handle_keys(socket);
        if (wb_time_now_ns() - drawn_ns < DRAW_NS)
            continue;
        wb_live_history_check_disk(history, screen->plan->recording);
        wb_live_screen_draw(screen);
        drawn_ns = wb_time_now_ns();
    }
}

/* Disables flow control: Ctrl-S would stop the view, including the keys that hold and stop the
 * test. */
static void ignore_flow_control(void)
{
    struct termios modes;
    if (tcgetattr(STDIN_FILENO, &modes) != 0)
        return;
    modes.c_iflag &= ~(tcflag_t)IXON;
    (void)tcsetattr(STDIN_FILENO, TCSANOW, &modes);
}

int wb_live_terminal_run(int socket, void *context)
{
    const struct wb_live_plan *const plan = context;
    struct wb_live_history history = {0};
    struct wb_live_screen screen = {.plan = plan, .history = &history};
    setlocale(LC_CTYPE, "");
    screen.is_unicode = strcmp(nl_langinfo(CODESET), "UTF-8") == 0;
    /* ncurses keeps the signal handlers of the feed; its own would end the process. */
    SCREEN *const terminal = newterm(NULL, stderr, stdin);
    if (!terminal)
        return 1;
    cbreak();
    noecho();
    nodelay(stdscr, TRUE);
    keypad(stdscr, TRUE);
    curs_set(0);
    ignore_flow_control();
    wb_live_screen_prepare();
    follow(socket, &screen, &history);
    endwin();
    delscreen(terminal);
    wb_live_history_release(&history);
    return 0;
}
