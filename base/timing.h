/* The clock and the wait function of everything that acquires, displays or simulates, through a
 * table that can be replaced by virtual time (fixtures/virtual/virtual_time.h): a test of minutes
 * then takes a second and gives the same result on any machine.
 *
 * Computations that measure their own speed use the same clock; they run in the host's time.
 */
#ifndef WB_BASE_TIMING_H
#define WB_BASE_TIMING_H

#include <poll.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct wb_time_source {
    int64_t (*now_ns)(void);
    int64_t (*utc)(void);
    int (*wait)(struct pollfd *descriptors, size_t n, int64_t deadline_ns);
};

/* Replaces the host's clock for the whole process; NULL restores it. Not while another thread uses
 * it. The source is borrowed. */
void wb_time_replace(const struct wb_time_source *source);

/* True while the host's clock is replaced: time then advances only during wb_time_wait(). */
bool wb_time_is_virtual(void);

/* Monotonic clock, ns. */
int64_t wb_time_now_ns(void);

/* Date, seconds since 1970-01-01 UTC. */
int64_t wb_time_utc(void);

/* Formats a date (s, as from wb_time_utc()) as "2026-11-25T14:03:00Z". */
#define WB_TIME_TEXT 32
void wb_time_format(int64_t utc, char text[WB_TIME_TEXT]);
/* Parses a date in that format, or "2026-11-25" (its first second). False for any other text. */
bool wb_time_parse(const char *text, int64_t *utc);

/* Waits like ppoll() until one of the n descriptors is ready, a signal arrives or `deadline_ns` has
 * passed, and sets their `revents`. Returns the number of ready descriptors, 0 at the deadline, -1
 * with errno otherwise (EINTR: a signal). `descriptors` may be NULL with n = 0. */
int wb_time_wait(struct pollfd *descriptors, size_t n, int64_t deadline_ns);

/* Waits until `deadline_ns`, or until a signal arrives. */
void wb_time_sleep(int64_t deadline_ns);

#endif
