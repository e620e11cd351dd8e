#include "analysis/clock_report.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/align/align.h"
#include "analysis/dataset/stops.h"
#include "analysis/import/reversal_lag.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "clock"

#define MS 1e-3
/* Two-sided 95 % of a normal distribution, in standard deviations. */
#define COVERAGE 1.96
/* s: a lag with a larger standard uncertainty is not identifiable. */
#define MOST_UNCERTAINTY 0.1

/* --- making --- */

/* Finds the next turn of the dataset, starting at row *at: the change from a cycle's loading to its
 * unloading, with the stop between them if there is one. Sets *at to the row after that unloading.
 * Returns the number of reversals of this turn, 0 if no turn follows. */
static int next_turn(const struct wb_dataset *dataset, size_t *at, struct wb_reversal reversals[2])
{
    const struct wb_row *const rows = dataset->rows;
    double from = (double)NAN;
    for (size_t i = *at; i + 1 < dataset->n_rows; i++) {
        struct wb_stop stop = {.arrival = rows[i].t, .departure = rows[i].t};
        double until = rows[i].t;
        if (rows[i].phase != WB_PHASE_LOAD)
            continue;
        if (!isfinite(from) || i == 0 || rows[i - 1].cycle != rows[i].cycle)
            from = rows[i].t;
        if (rows[i + 1].phase != WB_PHASE_UNLOAD || rows[i + 1].cycle != rows[i].cycle)
            continue;
        (void)wb_stops_at_turn(dataset, rows[i].cycle, &stop);
        for (i++; i < dataset->n_rows && rows[i].phase == WB_PHASE_UNLOAD; i++)
            until = rows[i].t;
        *at = i;
        return wb_reversal_list(reversals, from, stop.arrival, stop.departure, until);
    }
    return 0;
}

static void set_not_identifiable(struct wb_clock_report *report, int n_reversals, int n,
                                 double uncertainty)
{
    const double nan = (double)NAN;
    if (n_reversals == 0)
        snprintf(report->reason, sizeof report->reason,
                 "no reversal of the motion in the recording");
    else if (n == 0)
        snprintf(report->reason, sizeof report->reason,
                 "too few samples or too small a force at each of %d reversal%s", n_reversals,
                 n_reversals == 1 ? "" : "s");
    else
        snprintf(report->reason, sizeof report->reason,
                 "the lag from %d reversal%s has a standard uncertainty of %.0f ms, expected less "
                 "than %.0f ms",
                 n, n == 1 ? "" : "s", uncertainty / MS, MOST_UNCERTAINTY / MS);
    report->lag = report->uncertainty = report->interval[0] = report->interval[1] = nan;
}

/* The filter delay of the rig file is already subtracted from the times of the force: a remaining
 * lag is the amount by which this delay is too small. */
static void find_lag(struct wb_clock_report *report, const struct wb_align_signals *signals)
{
    const struct wb_signal motion = {signals->motion_t, signals->motion, signals->n_motion};
    const struct wb_signal force = {signals->force_t, signals->force, signals->n_force};
    struct wb_reversal_mean lags = {0};
    struct wb_reversal reversals[2];
    struct wb_reversal_lag one;
    double remaining, uncertainty;
    int n_reversals = 0, n;
    for (size_t at = 0; (n = next_turn(&report->dataset, &at, reversals)) > 0;) {
        for (int i = 0; i < n; i++, n_reversals++) {
            if (wb_reversal_lag_find(&one, &motion, &force, &reversals[i], signals->filter_delay))
                wb_reversal_mean_add(&lags, one.lag, one.uncertainty);
        }
    }
    report->expected = signals->filter_delay;
    report->expected_uncertainty = signals->filter_delay_uncertainty;
    report->n_reversals = lags.n;
    wb_reversal_mean_find(&lags, &remaining, &uncertainty);
    report->identifiable = lags.n > 0 && uncertainty < MOST_UNCERTAINTY;
    if (!report->identifiable) {
        set_not_identifiable(report, n_reversals, lags.n, uncertainty);
        return;
    }
    report->lag = signals->filter_delay + remaining;
    report->uncertainty = uncertainty;
    for (int i = 0; i < 2; i++)
        report->interval[i] = report->lag + (i ? COVERAGE : -COVERAGE) * uncertainty;
    report->agrees = fabs(remaining) < COVERAGE * hypot(uncertainty, report->expected_uncertainty);
}

static const struct wb_json *checks_of(const struct wb_clock_report *report, const char *key)
{
    return wb_json_get(wb_json_get(report->dataset.document, "checks"), key);
}

/* A number of an object; NaN if it is null or missing. */
static double number_of(const struct wb_json *object, const char *key)
{
    double value;
    return wb_json_get_number(object, key, &value) ? value : (double)NAN;
}

static void find_area(struct wb_clock_report *report)
{
    const struct wb_json *const timing = checks_of(report, "timing");
    report->area = number_of(timing, "loop_area_mJ") * WB_MJ;
    report->area_per_delay = number_of(timing, "loop_area_per_delay_mJ_per_s") * WB_MJ;
    for (int i = 0; i < 2; i++)
        report->area_interval[i] =
            report->area + report->area_per_delay * (report->interval[i] - report->expected);
}

enum wb_status wb_clock_report_make(struct wb_clock_report *report, const char *recording_path)
{
    struct wb_align_settings settings;
    struct wb_align_signals signals;
    memset(report, 0, sizeof *report);
    wb_align_default_settings(&settings);
    WB_TRY(wb_align_run_signals(&report->dataset, &signals, recording_path, &settings, NULL));
    find_lag(report, &signals);
    wb_align_signals_release(&signals);
    find_area(report);
    return WB_OK;
}

void wb_clock_report_release(struct wb_clock_report *report)
{
    wb_dataset_release(&report->dataset);
}

/* --- text and JSON --- */

static const char *text_of(const struct wb_json *object, const char *key)
{
    const char *text;
    return wb_json_get_text(object, key, &text) ? text : "unknown";
}

/* Appends "0.42 ms", or "unknown" if the value is not finite. */
static void append_value(struct wb_text *text, double value, const char *unit)
{
    if (isfinite(value))
        wb_text_append(text, "%.4g %s", value, unit);
    else
        wb_text_append(text, "unknown");
}

static void append_cameras(const struct wb_clock_report *report, struct wb_text *text)
{
    const struct wb_json *const list = checks_of(report, "camera_clock");
    if (wb_json_length(list) == 0)
        wb_text_append(text, "cameras             camera clock not used (method: %s)\n",
                       text_of(checks_of(report, "timing"), "camera_clock"));
    for (size_t i = 0; i < wb_json_length(list); i++) {
        const struct wb_json *const entry = wb_json_item(list, i);
        const double skew = number_of(entry, "skew_ppm"), span = number_of(entry, "span_s");
        wb_text_append(text, "cameras             %s, over %.0f s\n", text_of(entry, "method"),
                       span);
        wb_text_append(text, "  offset            %.6f s, host clock minus server clock\n",
                       number_of(entry, "offset_s"));
        wb_text_append(text, "  drift             %.4g +- ", skew);
        append_value(text, number_of(entry, "skew_uncertainty_ppm"), "ppm");
        wb_text_append(text, ": %.4g ms over the recording\n", skew * WB_PPM * span / MS);
        wb_text_append(text, "  scatter           ");
        append_value(text, number_of(entry, "scatter_ms"), "ms");
        wb_text_append(text, "\n  uncertainty       ");
        append_value(text, number_of(entry, "uncertainty_ms"), "ms");
        wb_text_append(text, "\n");
    }
}

static void append_load(const struct wb_clock_report *report, struct wb_text *text)
{
    const struct wb_json *const load = checks_of(report, "load_cell_stream");
    wb_text_append(text, "load cell           %s, ", text_of(load, "method"));
    append_value(text, number_of(load, "rate_per_s"), "readings/s");
    wb_text_append(text, "\n  arrival scatter   ");
    append_value(text, number_of(load, "arrival_scatter_ms"), "ms");
    wb_text_append(text, "\n");
}

static void append_lag(const struct wb_clock_report *report, struct wb_text *text)
{
    wb_text_append(
        text,
        "lag of the force behind the markers\n  expected          %.4g +- %.2g ms (the rig file's "
        "filter delay)\n",
        report->expected / MS, report->expected_uncertainty / MS);
    if (!report->identifiable) {
        wb_text_append(text, "  measured          not identifiable: %s\n", report->reason);
        return;
    }
    wb_text_append(
        text, "  measured          %.1f +- %.1f ms at %d reversal%s, 95 %%: %.1f to %.1f ms\n",
        report->lag / MS, report->uncertainty / MS, report->n_reversals,
        report->n_reversals == 1 ? "" : "s", report->interval[0] / MS, report->interval[1] / MS);
    if (!report->agrees)
        wb_text_append(text, "  NOT AS EXPECTED: measure the cell's filter and set "
                             "load_cell.filter_delay_ms, or look for another delay of a stream\n");
}

static void append_area(const struct wb_clock_report *report, struct wb_text *text)
{
    if (!isfinite(report->area))
        return;
    wb_text_append(
        text, "loop of cycle 1     %.4g mJ, %+.3g mJ per ms of delay subtracted from the force\n",
        report->area / WB_MJ, report->area_per_delay / WB_MJ * MS);
    if (report->identifiable)
        wb_text_append(text, "  at 95 %% limits    %.4g and %.4g mJ\n",
                       report->area_interval[0] / WB_MJ, report->area_interval[1] / WB_MJ);
}

void wb_clock_report_format(const struct wb_clock_report *report, struct wb_text *text)
{
    append_cameras(report, text);
    append_load(report, text);
    append_lag(report, text);
    append_area(report, text);
}

static void copy(const struct wb_clock_report *report, const char *key, struct wb_json *object)
{
    const struct wb_json *const found = checks_of(report, key);
    if (found)
        wb_json_set_copy(object, key, found);
}

void wb_clock_report_describe(const struct wb_clock_report *report, struct wb_json *object)
{
    const bool known = report->identifiable;
    wb_json_set_boolean(object, "virtual_rig", report->dataset.info.is_virtual);
    copy(report, "camera_clock", object);
    copy(report, "load_cell_stream", object);
    struct wb_json *const lag = wb_json_set_object(object, "lag");
    wb_json_set_number(lag, "expected_ms", report->expected / MS);
    wb_json_set_number(lag, "expected_uncertainty_ms", report->expected_uncertainty / MS);
    wb_json_set_boolean(lag, "identifiable", known);
    wb_json_set_text(lag, "reason", known ? NULL : report->reason);
    wb_json_set_integer(lag, "reversals", report->n_reversals);
    wb_json_set_number(lag, "measured_ms", report->lag / MS);
    wb_json_set_number(lag, "uncertainty_ms", report->uncertainty / MS);
    wb_json_set_number(lag, "low_ms", report->interval[0] / MS);
    wb_json_set_number(lag, "high_ms", report->interval[1] / MS);
    if (known)
        wb_json_set_boolean(lag, "as_expected", report->agrees);
    struct wb_json *const loop = wb_json_set_object(object, "loop");
    wb_json_set_number(loop, "area_mJ", report->area / WB_MJ);
    wb_json_set_number(loop, "area_per_delay_mJ_per_s", report->area_per_delay / WB_MJ);
    wb_json_set_number(loop, "area_low_mJ", report->area_interval[0] / WB_MJ);
    wb_json_set_number(loop, "area_high_mJ", report->area_interval[1] / WB_MJ);
}
