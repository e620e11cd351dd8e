#include "base/interrupt.h"
#include "base/interrupt_private.h"

#include <signal.h>
#include <stddef.h>

static volatile sig_atomic_t count;

static void note_signal(int number)
{
    (void)number;
    count = count + 1;
}

static void handle(const int *signals, size_t n, void (*handler)(int))
{
    struct sigaction action = {.sa_handler = handler};
    sigemptyset(&action.sa_mask);
    for (size_t i = 0; i < n; i++)
        sigaction(signals[i], &action, NULL);
}

void wb_interrupt_install(void)
{
    static const int noted[] = {SIGINT, SIGTERM};
    static const int hangup[] = {SIGHUP};
    struct sigaction before;
    handle(noted, sizeof noted / sizeof noted[0], note_signal);
    /* `nohup` ignores SIGHUP: keep it ignored, so that closing the terminal does not stop the
     * program. */
    if (sigaction(SIGHUP, NULL, &before) != 0 || before.sa_handler != SIG_IGN)
        handle(hangup, 1, note_signal);
}

void wb_interrupt_guard(void)
{
    static const int noted[] = {SIGQUIT};
    static const int ignored[] = {SIGPIPE, SIGTSTP, SIGTTIN, SIGTTOU};
    handle(noted, sizeof noted / sizeof noted[0], note_signal);
    handle(ignored, sizeof ignored / sizeof ignored[0], SIG_IGN);
}

bool wb_interrupted(void)
{
    return count > 0;
}

bool wb_interrupt_stops(void *context)
{
    (void)context;
    return wb_interrupted();
}

int wb_interrupt_count(void)
{
    return count;
}

void wb_interrupt_set(bool interrupted)
{
    count = interrupted;
}
