/* Device clocks to the host's: pure fits on probes, stamps and arrivals, with their uncertainty.
 *
 * Three cases. A server that answers echo probes: Cristian's method, the probe of the shortest
 * round trip in each burst, and a robust straight line through them (offset and skew). A server
 * without echo, but with stamps: the lower envelope of arrival over stamp, which has the shortest
 * latency as an unknown constant. A streaming instrument without stamps: the same over the
 * readings' number. After a break (a restarted server, lost readings) a new segment begins.
 */
#ifndef WB_DAQ_PROTOCOL_CLOCK_H
#define WB_DAQ_PROTOCOL_CLOCK_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "daq/protocol/sample.h"

/* host time = host_zero_ns + slope (device - device_zero). */
struct wb_clock_line {
    double device_zero; /* s, or readings */
    int64_t host_zero_ns;
    double slope; /* host seconds per device second (1 + skew), or per reading */
    /* s: how far the points lie from the line: standard deviation for probes, median lateness of
     * arrivals for an envelope. */
    double scatter;
    /* s: bound of a constant error of the mapped time: half the median of the shortest round trips
     * plus the line's own error for probes. NaN for an envelope: its constant is not known. */
    double uncertainty;
    double slope_uncertainty; /* standard, of slope; NaN when the slope was given */
    size_t n_points, n_used;  /* points given, and those that determine the line */
};

/* Host time of a device time, rounded to 1 ns. */
int64_t wb_clock_line_host_ns(const struct wb_clock_line *line, double device);

/* Line through probes (any order): the shortest round trip of each second, Huber's weights. With
 * fewer than three such bursts, or less than 2 s between the first and the last, the slope is
 * `nominal_slope` (1; 1/X for a rig that runs X times). WB_ERR_DATA without a probe, or
 * WB_ERR_MEMORY, both silent. */
WB_MUST_CHECK enum wb_status wb_clock_fit_probes(struct wb_clock_line *line,
                                                 const struct wb_clock_probe *probes, size_t n,
                                                 double nominal_slope);

/* The line below all points (device ascending, host arrival) with the least sum of distances: the
 * edge of their lower convex hull over the mean device time. The slope is `nominal_slope` when
 * the points span less than `least_span` of device time. WB_ERR_DATA without a point, or
 * WB_ERR_MEMORY, both silent. */
WB_MUST_CHECK enum wb_status wb_clock_fit_envelope(struct wb_clock_line *line, const double *device,
                                                   const int64_t *host_ns, size_t n,
                                                   double nominal_slope, double least_span);

/* A device's stamps and when they arrived. */
struct wb_clock_stamps {
    const double *device;   /* s, n of them */
    const int64_t *host_ns; /* n of them */
    size_t n;
    double nominal_slope; /* host seconds per device second: 1; 1/X for a rig that runs X times */
};

/* Finds where stamps break: host and device time since the previous one differ by more than `jump`
 * host seconds, and stay apart (a datagram that overtook another, or a host that was busy for a
 * while, is no break, even if the stamps end before it caught up). Writes the first index of each
 * segment (the first is 0) into `starts`, at most `most`; returns the number of segments (the last
 * takes what is over). */
size_t wb_clock_split(const struct wb_clock_stamps *stamps, double jump, size_t *starts,
                      size_t most);

/* The same for numbered readings that come at a constant rate: a segment begins where readings
 * were lost, which is where arrivals stay later than before, not where they were only late. */
size_t wb_clock_split_readings(const int64_t *host_ns, size_t n, size_t *starts, size_t most);

#endif
