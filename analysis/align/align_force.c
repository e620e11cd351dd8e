/* Tension and force from readings: slack, zero drift, lean of the strand, zero of force. */
#include <math.h>
#include <stdlib.h>

#include "analysis/align/align_private.h"
#include "analysis/dataset/fit.h"
#include "base/memory.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "align"

/* Tip height (m) below that of a taut strand from which on the strand is slack; larger than the
 * noise of the markers. */
#define SLACK_LENGTH (0.3 * WB_MM)
/* Settling time after a jump, in filter delays: a first-order filter has then settled to 3e-4. */
#define SETTLE_DELAYS 8.0
#define LEAST_SETTLE 0.2 /* s */
/* Fewest rows of a zero-load stretch. */
#define LEAST_ZERO_ROWS 6
/* Part of the largest tension above which the strand is certainly taut. */
#define TAUT_PART 0.3
/* Least tension of a strand that has become taut: in standard deviations of a row's reading, and as
 * part of the largest tension. */
#define PULL_NOISES 10.0
#define PULL_PART 0.02
/* Without a strand, or without its geometry: tension below this part of the largest counts as
 * zero. */
#define NO_TENSION_PART 0.005
/* The zero of force and the initial slope are fitted over at least this deflection, m, or this part
 * of the length. */
#define ZERO_WINDOW (1.6 * WB_MM)
#define SLOPE_PART 0.03
/* Range of deflection (m), from the first taut row, of the second-degree fit for the zero of
 * force. */
#define ZERO_RANGE (3.0 * WB_MM)
#define LEAST_FIT_ROWS 8
/* Typical zero drift of such load cells per minute, as part of the capacity. */
#define TYPICAL_DRIFT 2e-4
/* Largest deflection (m) at which the strand may become taut; the force is extrapolated from there
 * to zero. */
#define FARTHEST_ZERO (2.0 * WB_MM)

static double settle_time(const struct wb_align *align)
{
    return fmax(SETTLE_DELAYS * align->filter_delay, LEAST_SETTLE);
}

/* Standard deviation of a row's reading: a straight line fitted to n readings has, at its middle,
 * that of their mean. */
static double row_noise(const struct wb_align *align)
{
    const double in_row =
        fmax(1.0 / align->settings.row_rate / wb_align_reading_period(align), 5.0);
    return align->reading_noise / sqrt(in_row);
}

/* --- largest force --- */

static enum wb_status find_largest(struct wb_align *align)
{
    double *const readings = wb_memory_new(align->n_rows, sizeof *readings);
    for (size_t i = 0; i < align->n_rows; i++)
        readings[i] = align->rows[i].reading;
    wb_fit_sort(readings, align->n_rows);
    const double low = readings[align->n_rows / 50];
    align->largest = readings[align->n_rows - 1 - align->n_rows / 50];
    free(readings);
    align->reading_noise = isfinite(align->tare_deviation) && align->tare_deviation > 0.0
                               ? align->tare_deviation
                           : align->rig.load_cell.noise > 0.0 ? align->rig.load_cell.noise
                                                              : 1e-3 * fabs(align->largest);
    if (-low > fabs(align->largest) && -low > 10.0 * align->reading_noise)
        return wb_fail_to(align->why, WB_ERR_DATA,
                          "%s: readings fall to %.1f mN below the tare, as if the strand pushed: "
                          "the sign of the rig's load_cell is reversed",
                          align->name, -low / WB_MN);
    if (!(align->largest > 10.0 * align->reading_noise))
        return wb_fail_to(align->why, WB_ERR_DATA,
                          "%s: no reading of the load cell exceeds its noise (largest %.3f mN, "
                          "noise %.3f mN): is the strand attached?",
                          align->name, align->largest / WB_MN, align->reading_noise / WB_MN);
    return WB_OK;
}

/* --- slack --- */

/* Height of the tip over the clamp less travel and lean: constant while the strand is taut. */
static double tautness(const struct wb_align *align, const struct wb_align_row *row)
{
    return row->tip_y - align->rig.strand.length * (1.0 - row->lean_cosine) - row->travel;
}

static void find_taut_level(struct wb_align *align)
{
    double *const levels = wb_memory_new(align->n_rows, sizeof *levels);
    size_t n = 0;
    for (size_t i = 0; i < align->n_rows; i++) {
        if (align->rows[i].cycle == 1 && align->rows[i].reading > TAUT_PART * align->largest)
            levels[n++] = tautness(align, &align->rows[i]);
    }
    align->taut_level = align->rig.strand.length > 0.0 ? wb_fit_median(levels, n) : (double)NAN;
    free(levels);
}

/* Uses geometry where there is a strand, which zero drift does not affect. */
static bool is_slack(const struct wb_align *align, const struct wb_align_row *row)
{
    if (isfinite(align->taut_level))
        return tautness(align, row) - align->taut_level > SLACK_LENGTH;
    return fabs(row->reading) < fmax(5.0 * row_noise(align), NO_TENSION_PART * align->largest);
}

/* --- zero drift --- */

/* Adds the mean reading of a zero-load stretch, rows first..last-1, without the filter's settling
 * at its ends; with `begins` the stretch continues the tare. */
static void add_zero(struct wb_align *align, size_t first, size_t last, bool begins)
{
    const double settle = settle_time(align);
    const struct wb_align_row *const rows = align->rows;
    const double from = rows[first].t + (begins ? 0.0 : settle);
    /* A filter does not look ahead, but the stamps were moved back by its delay. */
    const double until =
        rows[last - 1].t - (last == align->n_rows ? 0.0 : 2.0 * align->filter_delay);
    double n = 0.0, sum = 0.0, sum_t = 0.0, squares = 0.0;
    for (size_t i = first; i < last; i++) {
        if (rows[i].t < from || rows[i].t > until)
            continue;
        n += 1.0;
        sum += rows[i].reading;
        squares += rows[i].reading * rows[i].reading;
        sum_t += rows[i].t;
    }
    if (n < LEAST_ZERO_ROWS || align->n_zeros == WB_ALIGN_MAX_ZEROS)
        return;
    const double mean = sum / n;
    align->zeros[align->n_zeros++] = (struct wb_align_zero){
        .t = sum_t / n,
        .value = mean,
        .deviation = sqrt(fmax(squares / n - mean * mean, 0.0) / n),
    };
}

/* Finds the zero-load stretches; the tare is one too. Rows before it are not used: the specimen may
 * have been handled. A stretch within 5 s of the tare is merged with it, weighted by their
 * variances. */
static void find_zeros(struct wb_align *align)
{
    const double tare_t = wb_align_bench_time(align, align->tare_ns);
    align->zeros[0] = (struct wb_align_zero){
        .t = tare_t - 0.5 * (double)align->tare_samples * wb_align_reading_period(align),
        .deviation = align->reading_noise / sqrt((double)align->tare_samples),
    };
    align->n_zeros = 1;
    size_t first = 0;
    while (first < align->n_rows && align->rows[first].t < tare_t)
        first++;
    const size_t after_tare = first;
    while (first < align->n_rows) {
        size_t last = first;
        while (last < align->n_rows && is_slack(align, &align->rows[last]))
            last++;
        if (last > first)
            add_zero(align, first, last, first == after_tare);
        first = last + 1;
    }
    align->slack_seen = align->n_zeros > 1;
    struct wb_align_zero *const a = &align->zeros[0], *const b = &align->zeros[1];
    if (align->n_zeros > 1 && b->t - a->t < 5.0) {
        const double wa = 1.0 / (a->deviation * a->deviation + 1e-18);
        const double wb = 1.0 / (b->deviation * b->deviation + 1e-18);
        *a = (struct wb_align_zero){
            .t = (wa * a->t + wb * b->t) / (wa + wb),
            .value = (wa * a->value + wb * b->value) / (wa + wb),
            .deviation = 1.0 / sqrt(wa + wb),
        };
        align->n_zeros--;
        for (size_t i = 1; i < align->n_zeros; i++)
            align->zeros[i] = align->zeros[i + 1];
    }
}

/* Zero of the cell at bench time t: linear between stretches, constant before the first and after
 * the last. */
static double zero_at(const struct wb_align *align, double t)
{
    const struct wb_align_zero *const zeros = align->zeros;
    size_t next = 0;
    while (next < align->n_zeros && zeros[next].t < t)
        next++;
    if (next == 0)
        return zeros[0].value;
    const struct wb_align_zero *const a = &zeros[next - 1];
    if (next == align->n_zeros)
        return a->value;
    return wb_fit_between(t, a->t, a->value, zeros[next].t, zeros[next].value);
}

/* Fastest drift between two stretches of the recording, N/s. */
static double drift_seen(const struct wb_align *align)
{
    const struct wb_align_zero *const z = align->zeros;
    double seen = 0.0;
    for (size_t i = 1; i < align->n_zeros; i++)
        seen = fmax(seen, fabs(z[i].value - z[i - 1].value) / (z[i].t - z[i - 1].t));
    return seen;
}

static void list_zeros(struct wb_align *align)
{
    struct wb_json *const list = wb_json_set_array(align->checks, "zero_load");
    for (size_t i = 0; i < align->n_zeros; i++) {
        struct wb_json *const entry = wb_json_append_object(list);
        wb_align_set(entry, "t_s", align->zeros[i].t);
        wb_align_set(entry, "reading_mN", align->zeros[i].value / WB_MN);
        wb_align_set(entry, "uncertainty_mN", align->zeros[i].deviation / WB_MN);
    }
}

static void describe_drift(struct wb_align *align)
{
    const struct wb_align_zero *const zeros = align->zeros;
    const size_t n = align->n_zeros;
    const double end = align->rows[align->n_rows - 1].t;
    const double outside = fmax(end - zeros[n - 1].t, 0.0);
    struct wb_align_correction correction = {"zero drift", "mN", WB_MN, 0.0, 0.0};
    list_zeros(align);
    if (n > 1) {
        const double seen = drift_seen(align);
        for (size_t i = 0; i < n; i++) {
            if (fabs(zeros[i].value) > fabs(correction.value))
                correction.value = zeros[i].value;
        }
        correction.uncertainty = hypot(zeros[0].deviation, zeros[n - 1].deviation);
        wb_align_correct(
            align, &correction,
            "largest value subtracted: linear between %zu zero-load stretches, the fastest drift "
            "%.3g mN/min; unknown after the last stretch (%.1f s), and bounded by %.3g mN there",
            n, seen * 60.0 / WB_MN, outside, seen * outside / WB_MN);
        return;
    }
    /* Zero load was recorded only before the test (the tare and the rest of that time, which may
     * have changed the zero by its noise): drift cannot be separated from load. */
    correction.value = zeros[0].value;
    const double rate = TYPICAL_DRIFT * align->rig.load_cell.capacity / 60.0;
    correction.uncertainty = rate * outside;
    wb_align_correct(
        align, &correction,
        "not corrected: the cell was certainly unloaded only before the test; the uncertainty is a "
        "bound from the typical drift of such cells, %.0e of the capacity per minute",
        TYPICAL_DRIFT);
    wb_align_warn(align,
                  "zero drift is not corrected: no zero-load stretch after the start of the test; "
                  "it is bounded by %.3g mN",
                  rate * outside / WB_MN);
}

/* --- tension --- */

static void set_tension(struct wb_align *align)
{
    const double least = fmax(3.0 * row_noise(align), 1e-3 * align->largest);
    for (size_t i = 0; i < align->n_rows; i++) {
        struct wb_align_row *const row = &align->rows[i];
        row->tension = row->reading - zero_at(align, row->t);
        row->vertical = row->tension * row->lean_cosine;
        const bool without_tension = align->rig.strand.length > 0.0 && row->tension < least;
        if (is_slack(align, row) || without_tension)
            row->phase = WB_PHASE_SLACK;
    }
}

static void describe_tare(struct wb_align *align)
{
    const struct wb_align_correction tare = {
        "tare", "mN", WB_MN, align->tare, align->reading_noise / sqrt((double)align->tare_samples)};
    if (wb_rig_tare_load(&align->rig) != 0.0)
        wb_align_correct(align, &tare,
                         "mean of %ld readings before the test with the counterweight on the "
                         "strand, less its weight of %.4g mN",
                         align->tare_samples, wb_rig_tare_load(&align->rig) / WB_MN);
    else
        wb_align_correct(align, &tare, "mean of %ld readings of the unloaded cell before the test",
                         align->tare_samples);
}

/* --- zero of force --- */

static bool is_first_loading(const struct wb_align_row *row)
{
    return row->cycle == 1 && row->phase == WB_PHASE_LOAD;
}

/* Finds where the strand became taut for good in the first loading, and the first row after the
 * filter settled. Earlier rows may look taut by the markers' noise, but carry no tension. */
static bool find_taut(struct wb_align *align, size_t *settled)
{
    const double least = fmax(PULL_NOISES * row_noise(align), PULL_PART * align->largest);
    size_t pulled = 0, i;
    while (pulled < align->n_rows &&
           !(is_first_loading(&align->rows[pulled]) && align->rows[pulled].reading > least))
        pulled++;
    if (pulled == align->n_rows)
        return false;
    for (i = pulled; i > 0 && is_first_loading(&align->rows[i - 1]);)
        i--;
    align->taut_t = align->rows[i].t;
    /* Taut from the first row on: the filter had settled before. */
    const double settle = i == 0 ? 0.0 : settle_time(align);
    while (i < align->n_rows &&
           (!is_first_loading(&align->rows[i]) || align->rows[i].t < align->taut_t + settle))
        i++;
    *settled = i;
    if (i < align->n_rows)
        align->settled_t = align->rows[i].t;
    return i < align->n_rows;
}

/* Vertical force over deflection, rows of the first loading from `first` on, up to `highest`. */
static size_t gather(const struct wb_align *align, size_t first, double highest, double *x,
                     double *y)
{
    size_t n = 0;
    for (size_t i = first; i < align->n_rows && align->rows[i].cycle == 1; i++) {
        const struct wb_align_row *const row = &align->rows[i];
        if (!is_first_loading(row))
            continue;
        if (row->tip_y > highest)
            break;
        x[n] = row->tip_y;
        y[n++] = row->vertical;
    }
    return n;
}

static enum wb_status fit_zero(struct wb_align *align, size_t first, double *x, double *y)
{
    const double begin = align->rows[first].tip_y;
    struct wb_fit_line line;
    if (begin > FARTHEST_ZERO)
        return wb_fail_to(
            align->why, WB_ERR_DATA,
            "%s: at the first loading the strand is taut only from %.2f mm on, too far "
            "from zero deflection: lower the tip's rest",
            align->name, begin / WB_MM);
    double window = ZERO_WINDOW;
    size_t n = gather(align, first, fmax(begin, 0.0) + window, x, y);
    for (; n < LEAST_FIT_ROWS && window < 4.0 * ZERO_WINDOW; window *= 1.5)
        n = gather(align, first, fmax(begin, 0.0) + window, x, y);
    if (n < LEAST_FIT_ROWS || !wb_fit_line(x, y, n, &line) || !(line.slope > 0.0))
        return wb_fail_to(align->why, WB_ERR_DATA,
                          "%s: no force at zero deflection: %zu rows of the first loading lie near "
                          "it, expected %d with a rising force (does the test pass zero slowly "
                          "enough, and is the tip's marker seen there?)",
                          align->name, n, LEAST_FIT_ROWS);
    align->zero_force = line.value;
    align->zero_force_deviation = line.value_deviation;
    /* If the wire yielded before zero deflection, its curve is bent there, and a straight line
     * fitted to one side would be too high at zero. */
    double c[3], deviation;
    n = gather(align, first, begin + ZERO_RANGE, x, y);
    if (n >= 3 * LEAST_FIT_ROWS && wb_fit_parabola(x, y, n, c, &deviation) && c[1] > 0.0) {
        align->zero_force = c[0];
        align->zero_force_deviation = deviation;
    }
    if (begin > 0.25 * WB_MM)
        wb_align_warn(align,
                      "the strand is taut only from %.2f mm of deflection on: force at zero "
                      "deflection is extrapolated",
                      begin / WB_MM);
    n = gather(align, first, begin + fmax(SLOPE_PART * align->specimen.length, ZERO_WINDOW), x, y);
    if (!wb_fit_line(x, y, n, &line))
        return wb_fail_to(align->why, WB_ERR_DATA, "%s: no initial slope of force over deflection",
                          align->name);
    align->stiffness = line.slope;
    align->stiffness_deviation = line.slope_deviation;
    return WB_OK;
}

double wb_align_level_uncertainty(const struct wb_align *align)
{
    const double vertical =
        align->frame.up_from_motion ? align->frame.up_uncertainty * align->specimen.length : 0.0;
    return hypot(M_SQRT2 * align->specimen.marker_offset_uncertainty, vertical);
}

static void describe_zero(struct wb_align *align)
{
    double lean = 0.0;
    for (size_t i = 0; i < align->n_rows; i++) {
        struct wb_align_row *const row = &align->rows[i];
        row->force = row->vertical - align->zero_force;
        lean = fmax(lean, row->tension - row->vertical);
    }
    const struct wb_align_correction strand = {"strand lean", "mN", WB_MN, lean, (double)NAN};
    wb_align_correct(align, &strand,
                     "largest difference of the tension and its vertical component; the strand's "
                     "upper end is assumed to be vertically above the straight wire's tip");
    const double level = wb_align_level_uncertainty(align);
    const struct wb_align_correction zero = {
        "force at zero deflection", "mN", WB_MN, align->zero_force,
        hypot(align->zero_force_deviation, align->stiffness * level)};
    wb_align_correct(
        align, &zero,
        "vertical component of the tension where the tip is level with the clamp on the first "
        "loading (second-degree fit to the taut rows near it), subtracted from all forces; initial "
        "slope %.4g N/m; the uncertainty includes that of the level, %.3g mm",
        align->stiffness, level / WB_MM);
}

/* --- timing --- */

/* Area of the first cycle's loop above zero deflection, and its change per second of lag of the
 * force: a lag opens a false loop of width 2 v dt. */
static void loop_area(const struct wb_align *align, double *area, double *per_second)
{
    const struct wb_align_row *last = NULL;
    *area = *per_second = 0.0;
    for (size_t i = 1; i + 1 < align->n_rows; i++) {
        const struct wb_align_row *const row = &align->rows[i];
        if (row->cycle != 1 || row->phase == WB_PHASE_SLACK || row->t < align->settled_t ||
            !(row->tip_y > 0.0))
            continue;
        const double dt = align->rows[i + 1].t - align->rows[i - 1].t;
        const double rate = (align->rows[i + 1].vertical - align->rows[i - 1].vertical) / dt;
        if (last) {
            *area += 0.5 * (row->force + last->force) * (row->tip_y - last->tip_y);
            *per_second -= rate * (row->tip_y - last->tip_y);
        }
        last = row;
    }
}

static void describe_timing(struct wb_align *align)
{
    struct wb_json *const object = wb_json_set_object(align->checks, "timing");
    const double camera = isfinite(align->camera_uncertainty) ? align->camera_uncertainty
                                                              : 1e-3 * align->rig.time_scale;
    const double lag = align->filter_delay_uncertainty + camera;
    double area, per_second;
    loop_area(align, &area, &per_second);
    wb_json_set_text(object, "camera_clock", align->method);
    wb_align_set(object, "camera_clock_uncertainty_ms", align->camera_uncertainty * 1e3);
    wb_align_set(object, "filter_delay_uncertainty_ms", align->filter_delay_uncertainty * 1e3);
    wb_align_set(object, "lag_uncertainty_ms", lag * 1e3);
    wb_align_set(object, "speed_mm_s", align->speed / WB_MM);
    wb_align_set(object, "deflection_error_mm", align->speed * lag / WB_MM);
    wb_align_set(object, "force_error_mN", align->stiffness * align->speed * lag / WB_MN);
    wb_align_set(object, "loop_width_error_mm", 2.0 * align->speed * lag / WB_MM);
    wb_align_set(object, "loop_area_mJ", area * 1e3);
    wb_align_set(object, "loop_area_per_delay_mJ_per_s", -per_second * 1e3);
    wb_align_set(object, "loop_area_error_mJ", fabs(per_second) * lag * 1e3);
    wb_json_set_text(object, "note",
                     "a lag between force and deflection moves a loading curve by speed times lag "
                     "(force: times stiffness too) and opens a false loop of twice that width; the "
                     "uncertainty excludes the unknown delay of the cameras before their data "
                     "reach the server, and assumes 1 ms for a clock without probes");
}

enum wb_status wb_align_force(struct wb_align *align)
{
    size_t settled;
    WB_TRY(find_largest(align));
    find_taut_level(align);
    find_zeros(align);
    describe_tare(align);
    describe_drift(align);
    set_tension(align);
    if (!find_taut(align, &settled))
        return wb_fail_to(align->why, WB_ERR_DATA,
                          "%s: the strand is never taut on the first loading", align->name);
    double *const x = wb_memory_new(2 * align->n_rows, sizeof *x);
    const enum wb_status status = fit_zero(align, settled, x, x + align->n_rows);
    free(x);
    WB_TRY(status);
    describe_zero(align);
    describe_timing(align);
    return WB_OK;
}
