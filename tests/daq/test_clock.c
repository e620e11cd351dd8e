/* Mapping of device clocks, with synthetic clocks of known offset, skew and latency. */
#include "daq/protocol/clock.h"

#include <stdlib.h>

#include "tests/check.h"

/* Repeatable numbers in [0, 1). */
static double uniform(uint64_t *state)
{
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*state >> 11) * 0x1p-53;
}

#define SKEW 50e-6
#define OFFSET 7200.0     /* s: the server started two hours before the host */
#define HOST_ZERO 12000.0 /* s */
#define N_BURSTS 60
#define N_PROBES 8

static double device_of_host(double host_s)
{
    return OFFSET + (host_s - HOST_ZERO) * (1.0 + SKEW) + HOST_ZERO;
}

static size_t make_probes(struct wb_clock_probe *probes, double asymmetry)
{
    uint64_t seed = 3;
    size_t n = 0;
    for (int burst = 0; burst < N_BURSTS; burst++) {
        for (int i = 0; i < N_PROBES; i++) {
            const double sent = HOST_ZERO + 2.0 * burst + 0.064 * i;
            const double there = 0.3e-3 + asymmetry + 1e-3 * uniform(&seed) * uniform(&seed);
            const double back = 0.3e-3 + 1e-3 * uniform(&seed) * uniform(&seed);
            probes[n++] = (struct wb_clock_probe){
                .t_sent_ns = (int64_t)(sent * 1e9),
                .t_received_ns = (int64_t)((sent + there + back) * 1e9),
                .t_device = device_of_host(sent + there),
            };
        }
    }
    return n;
}

static double error_at(const struct wb_clock_line *line, double host_s)
{
    return (double)wb_clock_line_host_ns(line, device_of_host(host_s)) * 1e-9 - host_s;
}

static void probes_give_offset_and_skew(void **state)
{
    (void)state;
    static struct wb_clock_probe probes[N_BURSTS * N_PROBES];
    const size_t n = make_probes(probes, 0.0);
    struct wb_clock_line line;
    assert_int_equal(wb_clock_fit_probes(&line, probes, n, 1.0), WB_OK);
    assert_close(line.slope, 1.0 / (1.0 + SKEW), 1e-6);
    assert_close(error_at(&line, HOST_ZERO), 0.0, 0.1e-3);
    assert_close(error_at(&line, HOST_ZERO + 120.0), 0.0, 0.1e-3);
    assert_true(line.slope_uncertainty > 0.0 && line.slope_uncertainty < 1e-6);
    assert_true(line.n_points == n && line.n_used >= N_BURSTS && line.n_used < n);
}

static void asymmetric_path_stays_within_the_stated_uncertainty(void **state)
{
    (void)state;
    static struct wb_clock_probe probes[N_BURSTS * N_PROBES];
    const size_t n = make_probes(probes, 0.8e-3);
    struct wb_clock_line line;
    assert_int_equal(wb_clock_fit_probes(&line, probes, n, 1.0), WB_OK);
    const double error = fabs(error_at(&line, HOST_ZERO + 60.0));
    assert_true(error > 0.3e-3);
    assert_true(error <= line.uncertainty);
}

static void outliers_do_not_change_the_line(void **state)
{
    (void)state;
    static struct wb_clock_probe probes[N_BURSTS * N_PROBES];
    const size_t n = make_probes(probes, 0.0);
    for (size_t i = 0; i < n; i += 5 * N_PROBES) {
        for (size_t k = i; k < i + N_PROBES; k++)
            probes[k].t_device += 0.05;
    }
    struct wb_clock_line line;
    assert_int_equal(wb_clock_fit_probes(&line, probes, n, 1.0), WB_OK);
    assert_close(error_at(&line, HOST_ZERO + 60.0), 0.0, 0.2e-3);
}

static void few_probes_take_the_nominal_slope(void **state)
{
    (void)state;
    static struct wb_clock_probe probes[N_BURSTS * N_PROBES];
    make_probes(probes, 0.0);
    struct wb_clock_line line;
    assert_int_equal(wb_clock_fit_probes(&line, probes, N_PROBES, 0.05), WB_OK);
    assert_close(line.slope, 0.05, 0.0);
    assert_true(isnan(line.slope_uncertainty));
    assert_int_equal(wb_clock_fit_probes(&line, probes, 0, 1.0), WB_ERR_DATA);
    probes[0].t_device = (double)NAN;
    assert_int_equal(wb_clock_fit_probes(&line, probes, 1, 1.0), WB_ERR_DATA);
}

#define N_FRAMES 12000

static void make_frames(double *device, int64_t *host_ns, double latency)
{
    uint64_t seed = 11;
    for (int i = 0; i < N_FRAMES; i++) {
        const double true_s = HOST_ZERO + i / 120.0;
        const double u = uniform(&seed);
        device[i] = device_of_host(true_s);
        host_ns[i] = (int64_t)((true_s + latency + 2e-3 * u * u * u) * 1e9);
    }
}

static void envelope_finds_skew_and_keeps_the_latency(void **state)
{
    (void)state;
    static double device[N_FRAMES];
    static int64_t host_ns[N_FRAMES];
    make_frames(device, host_ns, 1e-3);
    struct wb_clock_line line;
    assert_int_equal(wb_clock_fit_envelope(&line, device, host_ns, N_FRAMES, 1.0, 1.0), WB_OK);
    assert_close(line.slope, 1.0 / (1.0 + SKEW), 1e-7);
    assert_close(error_at(&line, HOST_ZERO + 10.0), 1e-3, 20e-6);
    assert_close(error_at(&line, HOST_ZERO + 90.0), 1e-3, 20e-6);
    assert_true(isnan(line.uncertainty));
    assert_close(line.scatter, 2e-3 / 8.0, 0.05e-3);
    for (int i = 0; i < N_FRAMES; i++)
        assert_true(host_ns[i] - wb_clock_line_host_ns(&line, device[i]) >= -2);
}

static void envelope_is_the_best_line_below_all_points(void **state)
{
    (void)state;
    /* The slow reference: every line through two points that has all other points above it. */
    enum {
        N = 40
    };
    uint64_t seed = 5;
    double device[N];
    int64_t host_ns[N];
    for (int i = 0; i < N; i++) {
        device[i] = i;
        host_ns[i] = (int64_t)((2.0 * i + uniform(&seed)) * 1e9);
    }
    struct wb_clock_line line;
    assert_int_equal(wb_clock_fit_envelope(&line, device, host_ns, N, 1.0, 1.0), WB_OK);
    double best = HUGE_VAL;
    for (int a = 0; a < N; a++) {
        for (int b = a + 1; b < N; b++) {
            const double slope = (double)(host_ns[b] - host_ns[a]) / (device[b] - device[a]);
            double sum = 0.0, least = HUGE_VAL;
            for (int i = 0; i < N; i++) {
                const double above =
                    (double)(host_ns[i] - host_ns[a]) - slope * (device[i] - device[a]);
                least = fmin(least, above);
                sum += above;
            }
            if (least > -0.5)
                best = fmin(best, sum);
        }
    }
    double sum = 0.0;
    for (int i = 0; i < N; i++)
        sum += (double)(host_ns[i] - wb_clock_line_host_ns(&line, device[i]));
    assert_close(sum, best, 100.0);
}

static void short_or_repeated_stamps_take_the_nominal_slope(void **state)
{
    (void)state;
    const double device[] = {5.0, 5.0, 5.0, 5.0};
    const int64_t host_ns[] = {400, 300, 500, 600};
    struct wb_clock_line line;
    assert_int_equal(wb_clock_fit_envelope(&line, device, host_ns, 4, 1.0, 1.0), WB_OK);
    assert_int_equal(wb_clock_line_host_ns(&line, 5.0), 300);
    assert_int_equal(wb_clock_fit_envelope(&line, device, host_ns, 0, 1.0, 1.0), WB_ERR_DATA);
    /* Absurd stamps do not overflow. */
    assert_int_equal(wb_clock_line_host_ns(&line, 1e300), 300);
    assert_int_equal(wb_clock_line_host_ns(&line, (double)NAN), 300);
}

static size_t split(const double *device, const int64_t *host_ns, size_t n, size_t *starts,
                    size_t most)
{
    const struct wb_clock_stamps stamps = {device, host_ns, n, 1.0};
    return wb_clock_split(&stamps, 0.5, starts, most);
}

static void restarted_server_begins_a_segment(void **state)
{
    (void)state;
    static double device[N_FRAMES];
    static int64_t host_ns[N_FRAMES];
    make_frames(device, host_ns, 1e-3);
    for (int i = 5000; i < N_FRAMES; i++)
        device[i] -= 19000.0;
    for (int i = 9000; i < N_FRAMES; i++)
        device[i] += 3.0;
    size_t starts[4];
    assert_int_equal(split(device, host_ns, N_FRAMES, starts, 4), 3);
    assert_int_equal(starts[0], 0);
    assert_int_equal(starts[1], 5000);
    assert_int_equal(starts[2], 9000);
    assert_int_equal(split(device, host_ns, N_FRAMES, starts, 2), 2);
}

static void busy_host_begins_no_segment(void **state)
{
    (void)state;
    static double device[N_FRAMES];
    static int64_t host_ns[N_FRAMES];
    make_frames(device, host_ns, 1e-3);
    /* Nothing is read for 2.7 s; then all pending data arrive at once. */
    const int64_t until = host_ns[6000] + INT64_C(2700000000);
    for (int i = 6000; i < N_FRAMES && host_ns[i] < until; i++)
        host_ns[i] = until;
    size_t starts[4];
    assert_int_equal(split(device, host_ns, N_FRAMES, starts, 4), 1);
    assert_int_equal(split(device, host_ns, 0, starts, 4), 0);
    /* The recording ends while the host is still processing the backlog. */
    assert_int_equal(split(device, host_ns, 6080, starts, 4), 1);
    assert_int_equal(split(device, host_ns, 6001, starts, 4), 1);
    /* A server that was interrupted for as long is not delayed: it continues at its rate. */
    make_frames(device, host_ns, 1e-3);
    for (int i = 6000; i < N_FRAMES; i++)
        host_ns[i] += INT64_C(2700000000);
    assert_int_equal(split(device, host_ns, 6080, starts, 4), 2);
    assert_int_equal(starts[1], 6000);
}

static void lost_readings_begin_a_segment_and_late_readings_do_not(void **state)
{
    (void)state;
    enum {
        COUNT = 4000
    };
    static int64_t host_ns[COUNT];
    uint64_t seed = 9;
    double lost = 0.0;
    for (int i = 0; i < COUNT; i++) {
        if (i == 2500)
            lost = 5 * 12.5e-3;
        double arrival = 100.0 + i * 12.5e-3 + lost + 2e-3 * uniform(&seed);
        /* The host was busy for 0.1, 2.7 and again 1.5 s: readings wait and come together. */
        if (i >= 1000)
            arrival = fmax(arrival, 100.0 + 1000 * 12.5e-3 + (i < 1300 ? 0.1 : 0.0));
        if (i >= 1500)
            arrival = fmax(arrival, 100.0 + 1500 * 12.5e-3 + 2.7);
        if (i >= 1730)
            arrival = fmax(arrival, 100.0 + 1730 * 12.5e-3 + 1.5);
        host_ns[i] = (int64_t)(arrival * 1e9);
    }
    size_t starts[8];
    assert_int_equal(wb_clock_split_readings(host_ns, COUNT, starts, 8), 2);
    assert_int_equal(starts[1], 2500);
    assert_int_equal(wb_clock_split_readings(host_ns, 1, starts, 8), 1);
    assert_int_equal(wb_clock_split_readings(host_ns, 0, starts, 8), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(probes_give_offset_and_skew),
        cmocka_unit_test(asymmetric_path_stays_within_the_stated_uncertainty),
        cmocka_unit_test(outliers_do_not_change_the_line),
        cmocka_unit_test(few_probes_take_the_nominal_slope),
        cmocka_unit_test(envelope_finds_skew_and_keeps_the_latency),
        cmocka_unit_test(envelope_is_the_best_line_below_all_points),
        cmocka_unit_test(short_or_repeated_stamps_take_the_nominal_slope),
        cmocka_unit_test(restarted_server_begins_a_segment),
        cmocka_unit_test(busy_host_begins_no_segment),
        cmocka_unit_test(lost_readings_begin_a_segment_and_late_readings_do_not),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
