#include "daq/mass_check.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

#include "base/interrupt.h"
#include "base/units.h"
#include "daq/acquisition.h"
#include "daq/average.h"

#define WB_LOG_DOMAIN "check"

#define CONNECT_NS (6 * WB_NS_PER_S)
/* Time of the rig for a hung mass to come to rest and for the cell's filter to follow, s. */
#define SETTLE 2.0
#define LEAST_READINGS 10

struct wb_mass_check {
    struct wb_rig rig;
    struct wb_acquisition *acquisition;
    enum wb_mass_check_phase phase;
    int64_t phase_ns, duration_ns;
    struct wb_average zero, loaded;
    double reading;
    bool overload;
};

static void on_load(void *context, const struct wb_load_sample *sample)
{
    struct wb_mass_check *const check = context;
    if (sample->overload && check->phase == WB_MASS_CHECK_LOADED)
        check->overload = true;
    if (!sample->valid)
        return;
    check->reading = sample->force;
    if (check->phase == WB_MASS_CHECK_ZERO)
        wb_average_add(&check->zero, sample->force);
    else if (check->phase == WB_MASS_CHECK_LOADED)
        wb_average_add(&check->loaded, sample->force);
}

enum wb_status wb_mass_check_open(struct wb_mass_check **out, const struct wb_rig *rig,
                                  double seconds)
{
    struct wb_mass_check *const check = calloc(1, sizeof *check);
    if (!check)
        return wb_fail(WB_ERR_MEMORY, "no memory for the check");
    check->rig = *rig;
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
    check->phase_ns = wb_acquisition_now_ns();
    *out = check;
    return WB_OK;
}

static void enter(struct wb_mass_check *check, enum wb_mass_check_phase phase)
{
    check->phase = phase;
    check->phase_ns = wb_acquisition_now_ns();
}

#define FAIL(check, ...) (wb_error(__VA_ARGS__), enter((check), WB_MASS_CHECK_FAILED))

static void watch(struct wb_mass_check *check, int64_t now_ns)
{
    const struct wb_acquisition_stream_state *const load =
        &wb_acquisition_latest(check->acquisition)->stream[WB_ROLE_LOAD];
    const int64_t waited_ns = now_ns - check->phase_ns;
    const char *const address = check->rig.load_cell.address;
    char cause[WB_DIAGNOSIS_TEXT];
    if (wb_interrupted())
        FAIL(check, "stopped by the operator");
    else if (load->gone)
        FAIL(check, "the load cell's port %s went away: check its cable and power", address);
    else if (check->overload)
        FAIL(check, "the load cell reports overload: the mass is beyond its range");
    else if (check->phase == WB_MASS_CHECK_CONNECTING && !isfinite(check->reading) &&
             waited_ns > CONNECT_NS + check->rig.load_cell.settle_ns) {
        const struct wb_diagnosis no_stage = {0};
        wb_diagnosis_load(&load->heard, &no_stage, &check->rig, cause);
        FAIL(check, "the load cell at %s sent no reading within %d s (%" PRIu64 " bytes came): %s",
             address, (int)(CONNECT_NS / WB_NS_PER_S), load->bytes, cause);
    } else if ((check->phase == WB_MASS_CHECK_ZERO || check->phase == WB_MASS_CHECK_LOADED) &&
               waited_ns > check->duration_ns + CONNECT_NS)
        FAIL(check, "the load cell at %s sends too few readings: at least 10 are needed", address);
}

enum wb_mass_check_phase wb_mass_check_step(struct wb_mass_check *check, int64_t timeout_ns)
{
    if (check->phase >= WB_MASS_CHECK_DONE)
        return check->phase;
    const bool failed =
        wb_acquisition_step(check->acquisition, timeout_ns) == WB_ACQUISITION_FAILED;
    const int64_t now_ns = wb_acquisition_now_ns();
    const bool long_enough = now_ns - check->phase_ns >= check->duration_ns;
    if (failed) {
        enter(check, WB_MASS_CHECK_FAILED);
        return check->phase;
    }
    watch(check, now_ns);
    if (check->phase == WB_MASS_CHECK_CONNECTING && isfinite(check->reading))
        enter(check, WB_MASS_CHECK_ZERO);
    else if (check->phase == WB_MASS_CHECK_ZERO && long_enough && check->zero.n >= LEAST_READINGS)
        enter(check, WB_MASS_CHECK_WAITING);
    else if (check->phase == WB_MASS_CHECK_SETTLING &&
             now_ns - check->phase_ns >= wb_ns_from_seconds(SETTLE / check->rig.time_scale))
        enter(check, WB_MASS_CHECK_LOADED);
    else if (check->phase == WB_MASS_CHECK_LOADED && long_enough &&
             check->loaded.n >= LEAST_READINGS)
        enter(check, WB_MASS_CHECK_DONE);
    return check->phase;
}

void wb_mass_check_hung(struct wb_mass_check *check)
{
    if (check->phase == WB_MASS_CHECK_WAITING)
        enter(check, WB_MASS_CHECK_SETTLING);
}

void wb_mass_check_result(const struct wb_mass_check *check, double known, double tolerance,
                          struct wb_mass_check_result *result)
{
    const double g = check->rig.gravity;
    result->zero = check->zero.mean;
    result->loaded = check->loaded.mean;
    result->zero_sd = wb_average_deviation(&check->zero);
    result->loaded_sd = wb_average_deviation(&check->loaded);
    result->n_zero = check->zero.n;
    result->n_loaded = check->loaded.n;
    result->mass = (result->loaded - result->zero) / g;
    result->deviation = result->mass - known;
    result->relative = result->deviation / known;
    result->uncertainty = sqrt(result->zero_sd * result->zero_sd / (double)result->n_zero +
                               result->loaded_sd * result->loaded_sd / (double)result->n_loaded) /
                          g;
    result->passed = fabs(result->relative) <= tolerance;
}

void wb_mass_check_close(struct wb_mass_check *check)
{
    if (!check)
        return;
    wb_acquisition_close(check->acquisition);
    free(check);
}
