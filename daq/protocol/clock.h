/* Mapping of device clocks to the host's clock: fits to probes, stamps and arrivals, with their
 * uncertainty. Pure functions.
 *
 * Three cases. A server that replies to echo probes: Cristian's method, with the shortest round
 * trip of each burst, and a robust straight line (offset and skew). A server without echo but with
 * time stamps: the lower envelope of arrival over stamp, which contains the shortest latency as an
 * unknown constant. A streaming instrument without stamps: the same over the number of the reading.
 * After a break (a restarted server, lost readings) a new segment begins.
 */
#ifndef WB_DAQ_PROTOCOL_CLOCK_H
#define WB_DAQ_PROTOCOL_CLOCK_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "daq/protocol/sample.h"

/* host time = host_zero_ns + slope (device - device_zero). */
struct wb_clock_line {
    double device_zero; /* s, or number of the reading */
    int64_t host_zero_ns;
    double slope; /* host seconds per device second (1 + skew), or per reading */
    /* s, distance of the points from the line: standard deviation for probes, median delay of
     * arrivals for an envelope. */
    double scatter;
    /* s, bound of a constant error of the mapped time. Probes: half the median of the shortest
     * round trips plus the error of the line. Envelope: NaN, its constant is unknown. */
    double uncertainty;
    double slope_uncertainty; /* standard uncertainty of slope; NaN: the slope was given */
    size_t n_points, n_used;  /* given points, and points that determine the line */
};

/* Host time of a device time, rounded to 1 ns. */
int64_t wb_clock_line_host_ns(const struct wb_clock_line *line, double device);

/* Fits a line to probes (in any order): the shortest round trip of each second, with Huber's
 * weights. With fewer than three such bursts, or less than 2 s between the first and the last, the
 * slope is `nominal_slope` (1; 1/X for a virtual rig that runs X times as fast). WB_ERR_DATA (no
 * probe) or WB_ERR_MEMORY, both without a message. */
WB_MUST_CHECK enum wb_status wb_clock_fit_probes(struct wb_clock_line *line,
                                                 const struct wb_clock_probe *probes, size_t n,
                                                 double nominal_slope);

/* Fits the line below all points (device time ascending, host arrival) with the smallest sum of
 * distances: the edge of their lower convex hull at the mean device time. The slope is
 * `nominal_slope` if the points span less than `least_span` of device time. WB_ERR_DATA (no point)
 * or WB_ERR_MEMORY, both without a message. */
WB_MUST_CHECK enum wb_status wb_clock_fit_envelope(struct wb_clock_line *line, const double *device,
                                                   const int64_t *host_ns, size_t n,
                                                   double nominal_slope, double least_span);

/* Time stamps of a device and their arrivals. */
struct wb_clock_stamps {
    const double *device;   /* s, n of them; NULL: the index of the stamp */
    const int64_t *host_ns; /* n of them */
    size_t n;
    double nominal_slope; /* host seconds per device second; see wb_clock_fit_probes() */
};

/* Finds breaks of the stamps: the host and device times since the previous stamp differ by more
 * than `jump` host seconds, permanently. Datagrams out of order and a temporary delay of the host
 * are not breaks. Writes the first index of each segment (the first is 0) to `starts`, at most
 * `most`; returns the number of segments (the last one contains the rest). */
size_t wb_clock_split(const struct wb_clock_stamps *stamps, double jump, size_t *starts,
                      size_t most);

/* The same for readings at a constant rate: a segment begins where readings were lost, thus where
 * the delay of arrivals increases permanently. */
size_t wb_clock_split_readings(const int64_t *host_ns, size_t n, size_t *starts, size_t most);

#endif
