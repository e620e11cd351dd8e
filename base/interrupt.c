#include "base/interrupt.h"

#include <signal.h>
#include <stddef.h>

static volatile sig_atomic_t flag;

static void note_signal(int number)
{
    (void)number;
    flag = 1;
}

void wb_interrupt_install(void)
{
    struct sigaction action = {.sa_handler = note_signal};
    sigemptyset(&action.sa_mask);
    static const int signals[] = {SIGINT, SIGTERM, SIGHUP};
    for (size_t i = 0; i < sizeof signals / sizeof signals[0]; i++)
        sigaction(signals[i], &action, NULL);
}

bool wb_interrupted(void)
{
    return flag != 0;
}

void wb_interrupt_set(bool interrupted)
{
    flag = interrupted;
}
