#include "daq/acquire/mass_check.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/interrupt.h"
#include "base/timing.h"
#include "base/units.h"
#include "daq/acquire/acquisition.h"
#include "daq/protocol/average.h"

#define WB_LOG_DOMAIN "check"

#define CONNECT_NS (6 * WB_NS_PER_S) /* for the first reading, and for late readings */
/* s of rig time, least time for the mass and the cell's filter to settle. */
#define SETTLE 2.0
/* The reading is stable when two consecutive windows of STILL_WINDOW (s of rig time) have the same
 * mean, within STILL_ERRORS standard errors or within STILL_SHARE of the capacity, and the scatter
 * does not exceed wb_rig_noise_allowed(). */
#define STILL_WINDOW 0.5
#define STILL_ERRORS 4.0
#define STILL_SHARE 1e-4
/* s of rig time after which a reading that is not stable is an error. */
#define STILL_PATIENCE 60.0
#define LEAST_READINGS 10
/* Parts of a point whose means give the standard error of slow fluctuations. */
#define N_PARTS 8

struct wb_mass_check {
    struct wb_rig rig;
    struct wb_acquisition *acquisition;
    enum wb_mass_check_phase phase;
    int64_t phase_ns, duration_ns;
    int64_t window_ns; /* begin of `window` */
    struct wb_average window, window_before;
    bool is_still;
    struct wb_average all, parts[N_PARTS]; /* readings of the current point */
    double reading;
    bool overload;
    int index, n;
    struct wb_cell_point points[WB_RIG_MASSES];
};

static int64_t ns_of_rig_time(const struct wb_mass_check *check, double seconds)
{
    return wb_ns_from_seconds(seconds / check->rig.time_scale);
}

static double error_of(const struct wb_average *average)
{
    return wb_average_deviation(average) / sqrt((double)average->n);
}

/* Closes a window of the settling reading and compares it with the one before. */
static void compare_windows(struct wb_mass_check *check, int64_t now_ns)
{
    const struct wb_average *const now = &check->window, *const before = &check->window_before;
    if (now_ns - check->window_ns < ns_of_rig_time(check, STILL_WINDOW) || now->n < LEAST_READINGS)
        return;
    const double allowed = fmax(STILL_ERRORS * hypot(error_of(now), error_of(before)),
                                STILL_SHARE * check->rig.load_cell.capacity);
    check->is_still = before->n > 0 && fabs(now->mean - before->mean) <= allowed &&
                      wb_average_deviation(now) <= wb_rig_noise_allowed(&check->rig.load_cell);
    check->window_before = check->window;
    check->window = (struct wb_average){0};
    check->window_ns = now_ns;
}

static void on_load(void *context, const struct wb_load_sample *sample)
{
    struct wb_mass_check *const check = context;
    if (sample->overload && check->phase == WB_MASS_CHECK_READING)
        check->overload = true;
    if (!sample->valid)
        return;
    check->reading = sample->force;
    if (check->phase == WB_MASS_CHECK_SETTLING)
        wb_average_add(&check->window, sample->force);
    if (check->phase != WB_MASS_CHECK_READING)
        return;
    const int64_t since_ns = wb_time_now_ns() - check->phase_ns;
    const int64_t part = since_ns * N_PARTS / (check->duration_ns + 1);
    wb_average_add(&check->all, sample->force);
    wb_average_add(&check->parts[part < N_PARTS ? part : N_PARTS - 1], sample->force);
}

enum wb_status wb_mass_check_open(struct wb_mass_check **out, const struct wb_rig *rig,
                                  double seconds, const double *masses, int n)
{
    struct wb_mass_check *const check = calloc(1, sizeof *check);
    if (!check)
        return wb_fail(WB_ERR_MEMORY, "out of memory for the check");
    check->rig = *rig;
    check->n = n;
    for (int i = 0; i < n; i++)
        check->points[i].mass = masses[i];
    check->duration_ns = wb_ns_from_seconds(seconds);
    check->reading = (double)NAN;
    const struct wb_sink sink = {.context = check, .load = on_load};
    const enum wb_status status =
        wb_acquisition_open(&check->acquisition, rig, WB_ACQUISITION_LOAD, &sink);
    if (status != WB_OK) {
        free(check);
        return status;
    }
    wb_acquisition_start(check->acquisition, NULL);
    check->phase_ns = wb_time_now_ns();
    *out = check;
    return WB_OK;
}

static void enter(struct wb_mass_check *check, enum wb_mass_check_phase phase)
{
    check->phase = phase;
    check->phase_ns = check->window_ns = wb_time_now_ns();
    check->window = check->window_before = check->all = (struct wb_average){0};
    memset(check->parts, 0, sizeof check->parts);
    check->is_still = false;
}

#define FAIL(check, ...) (wb_error(__VA_ARGS__), enter((check), WB_MASS_CHECK_FAILED))

static void watch_connection(struct wb_mass_check *check, int64_t waited_ns)
{
    const struct wb_acquisition_stream_state *const load =
        &wb_acquisition_latest(check->acquisition)->stream[WB_ROLE_LOAD];
    const char *const address = check->rig.load_cell.address;
    char cause[WB_DIAGNOSIS_TEXT];
    if (load->gone) {
        FAIL(check, "the load cell's port %s was disconnected: check its cable and power", address);
    } else if (check->phase == WB_MASS_CHECK_CONNECTING && !isfinite(check->reading) &&
               waited_ns > CONNECT_NS + check->rig.load_cell.settle_ns) {
        const struct wb_diagnosis no_stage = {0};
        wb_diagnosis_load(&load->heard, &no_stage, &check->rig, cause);
        FAIL(check,
             "the load cell at %s sent no reading within %d s (%" PRIu64 " bytes received): %s",
             address, (int)(CONNECT_NS / WB_NS_PER_S), load->bytes, cause);
    }
}

/* Fails if there are too few readings in the allowed time, or if they do not become stable. */
static void watch_reading(struct wb_mass_check *check, int64_t waited_ns)
{
    const char *const address = check->rig.load_cell.address;
    const int64_t settle_ns = ns_of_rig_time(check, STILL_PATIENCE) + CONNECT_NS;
    if ((check->phase == WB_MASS_CHECK_READING && waited_ns > check->duration_ns + CONNECT_NS) ||
        (check->phase == WB_MASS_CHECK_SETTLING && waited_ns > settle_ns &&
         check->window_before.n == 0))
        FAIL(check, "the load cell at %s sends too few readings: at least 10 are needed", address);
    else if (check->phase == WB_MASS_CHECK_SETTLING && waited_ns > settle_ns)
        FAIL(check,
             "the load cell's reading with %g g does not become stable (scatter %.3f mN; expected "
             "at most %.3f mN): keep the mass from swinging and shield it from draught, or set "
             "load_cell.noise_mg to the cell's noise",
             check->points[check->index].mass / WB_G,
             wb_average_deviation(&check->window_before) / WB_MN,
             wb_rig_noise_allowed(&check->rig.load_cell) / WB_MN);
}

static void watch(struct wb_mass_check *check, int64_t now_ns)
{
    const int64_t waited_ns = now_ns - check->phase_ns;
    if (wb_interrupted())
        FAIL(check, "stopped by the operator");
    else if (check->overload)
        FAIL(check, "the load cell reports overload: the mass exceeds its range");
    else
        watch_connection(check, waited_ns);
    if (check->phase != WB_MASS_CHECK_FAILED)
        watch_reading(check, waited_ns);
}

static void store_point(struct wb_mass_check *check)
{
    struct wb_cell_point *const point = &check->points[check->index];
    struct wb_average means = {0};
    for (int i = 0; i < N_PARTS; i++) {
        if (check->parts[i].n > 0)
            wb_average_add(&means, check->parts[i].mean);
    }
    point->reading = check->all.mean;
    point->sd = wb_average_deviation(&check->all);
    point->n = check->all.n;
    point->uncertainty = fmax(error_of(&check->all), error_of(&means));
}

static void end_reading(struct wb_mass_check *check)
{
    const bool is_last = check->index + 1 == check->n;
    store_point(check);
    check->index += !is_last;
    enter(check, is_last ? WB_MASS_CHECK_DONE : WB_MASS_CHECK_WAITING);
}

static void advance(struct wb_mass_check *check, int64_t now_ns)
{
    const int64_t waited_ns = now_ns - check->phase_ns;
    switch (check->phase) {
    case WB_MASS_CHECK_CONNECTING:
        if (isfinite(check->reading))
            enter(check, WB_MASS_CHECK_SETTLING);
        break;
    case WB_MASS_CHECK_SETTLING:
        compare_windows(check, now_ns);
        if (check->is_still && waited_ns >= ns_of_rig_time(check, SETTLE))
            enter(check, WB_MASS_CHECK_READING);
        break;
    case WB_MASS_CHECK_READING:
        if (waited_ns >= check->duration_ns && check->all.n >= LEAST_READINGS)
            end_reading(check);
        break;
    default:
        break;
    }
}

enum wb_mass_check_phase wb_mass_check_step(struct wb_mass_check *check, int64_t timeout_ns)
{
    if (check->phase >= WB_MASS_CHECK_DONE)
        return check->phase;
    if (wb_acquisition_step(check->acquisition, timeout_ns) == WB_ACQUISITION_FAILED) {
        enter(check, WB_MASS_CHECK_FAILED);
        return check->phase;
    }
    const int64_t now_ns = wb_time_now_ns();
    watch(check, now_ns);
    advance(check, now_ns);
    return check->phase;
}

int wb_mass_check_index(const struct wb_mass_check *check)
{
    return check->index;
}

void wb_mass_check_confirm(struct wb_mass_check *check)
{
    if (check->phase == WB_MASS_CHECK_WAITING)
        enter(check, WB_MASS_CHECK_SETTLING);
}

const struct wb_cell_point *wb_mass_check_points(const struct wb_mass_check *check)
{
    return check->points;
}

void wb_mass_check_close(struct wb_mass_check *check)
{
    if (!check)
        return;
    wb_acquisition_close(check->acquisition);
    free(check);
}
