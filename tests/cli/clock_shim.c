/* Preloaded into a program: the wall clock jumps by hours, forward and back, each time it is read.
 * The monotonic clock stays. With WB_CLOCK_SHIM=FILE the number of jumps is written there at the
 * end. */
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <time.h>

static unsigned long jumps;

static time_t jump(void)
{
    const unsigned long k = __atomic_add_fetch(&jumps, 1, __ATOMIC_RELAXED);
    return (time_t)(k * 2654435761UL % 200000) - 100000;
}

int clock_gettime(clockid_t clock, struct timespec *t)
{
    static int (*real)(clockid_t, struct timespec *);
    if (!real) {
        void *const found = dlsym(RTLD_NEXT, "clock_gettime");
        memcpy(&real, &found, sizeof real);
    }
    const int status = real(clock, t);
    if (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE)
        t->tv_sec += jump();
    return status;
}

time_t time(time_t *out)
{
    struct timespec t;
    clock_gettime(CLOCK_REALTIME, &t);
    if (out)
        *out = t.tv_sec;
    return t.tv_sec;
}

int gettimeofday(struct timeval *restrict out, void *restrict zone)
{
    struct timespec t;
    (void)zone;
    clock_gettime(CLOCK_REALTIME, &t);
    out->tv_sec = t.tv_sec;
    out->tv_usec = t.tv_nsec / 1000;
    return 0;
}

__attribute__((destructor)) static void tell(void)
{
    const char *const path = getenv("WB_CLOCK_SHIM");
    FILE *const file = path ? fopen(path, "w") : NULL;
    if (file) {
        fprintf(file, "%lu\n", jumps);
        fclose(file);
    }
}
