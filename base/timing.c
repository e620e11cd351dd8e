#include "base/timing.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

#include "base/units.h"

static int64_t host_now_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * WB_NS_PER_S + now.tv_nsec;
}

static int64_t host_utc(void)
{
    return (int64_t)time(NULL);
}

static int host_wait(struct pollfd *descriptors, size_t n, int64_t deadline_ns)
{
    const int64_t left_ns = deadline_ns - host_now_ns();
    const int64_t wait_ns = left_ns > 0 ? left_ns : 0;
    const struct timespec wait = {.tv_sec = (time_t)(wait_ns / WB_NS_PER_S),
                                  .tv_nsec = (long)(wait_ns % WB_NS_PER_S)};
    return ppoll(descriptors, n, &wait, NULL);
}

static const struct wb_time_source host = {host_now_ns, host_utc, host_wait};
static const struct wb_time_source *source = &host;

void wb_time_replace(const struct wb_time_source *replacement)
{
    source = replacement ? replacement : &host;
}

bool wb_time_is_virtual(void)
{
    return source != &host;
}

int64_t wb_time_now_ns(void)
{
    return source->now_ns();
}

int64_t wb_time_utc(void)
{
    return source->utc();
}

void wb_time_format(int64_t utc, char text[WB_TIME_TEXT])
{
    const time_t seconds = (time_t)utc;
    struct tm date;
    if (!gmtime_r(&seconds, &date) ||
        strftime(text, WB_TIME_TEXT, "%Y-%m-%dT%H:%M:%SZ", &date) == 0)
        snprintf(text, WB_TIME_TEXT, "unknown");
}

bool wb_time_parse(const char *text, int64_t *utc)
{
    static const char *const forms[] = {"%Y-%m-%dT%H:%M:%SZ", "%Y-%m-%d"};
    for (size_t i = 0; i < sizeof forms / sizeof forms[0]; i++) {
        struct tm date;
        char again[WB_TIME_TEXT];
        memset(&date, 0, sizeof date);
        const char *const end = strptime(text, forms[i], &date);
        if (!end || *end)
            continue;
        /* strptime() accepts the 31st of every month: only existing dates are printed unchanged. */
        const time_t seconds = timegm(&date);
        *utc = (int64_t)seconds;
        wb_time_format(*utc, again);
        return strncmp(again, text, strlen(text) < 11 ? strlen(text) : strlen(again)) == 0;
    }
    return false;
}

int wb_time_wait(struct pollfd *descriptors, size_t n, int64_t deadline_ns)
{
    return source->wait(descriptors, n, deadline_ns);
}

void wb_time_sleep(int64_t deadline_ns)
{
    (void)source->wait(NULL, 0, deadline_ns);
}
