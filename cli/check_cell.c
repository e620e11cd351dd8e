#include "cli/check_cell.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "analysis/report/certificate.h"
#include "base/number.h"
#include "base/timing.h"
#include "base/units.h"
#include "daq/acquire/mass_check.h"
#include "daq/protocol/cell_calibration.h"
#include "daq/test/check_log.h"

#define WB_LOG_DOMAIN "stage"

/* A check: request and result. */
struct check {
    const struct wb_stage_options *options;
    const struct wb_rig *rig;
    double tolerance;
    char utc[32]; /* end of the measurement */
    bool is_series;
    int n;
    double masses[WB_RIG_MASSES]; /* kg */
    struct wb_cell_point points[WB_RIG_MASSES];
    struct wb_cell_deviation single;
    struct wb_cell_calibration series;
    bool passed;
};

/* --- the request --- */

static bool take_single(struct check *check, double known)
{
    check->masses[0] = 0.0;
    check->masses[1] = known;
    check->n = 2;
    if (known > 0.0)
        return true;
    wb_error("check: no mass given, and the rig file has no load_cell.check_masses_g and no "
             "load_cell.check_mass_g");
    return false;
}

static bool take_masses(struct check *check)
{
    const struct wb_rig_load_cell *const cell = &check->rig->load_cell;
    const struct wb_stage_options *const options = check->options;
    char problem[160];
    double known;
    check->is_series = options->masses || (!options->value && cell->n_check_masses > 0);
    if (options->value) {
        if (!wb_number_parse(options->value, &known) || !(known > 0.0)) {
            wb_error("check: expected a mass in grams, not '%s'", options->value);
            return false;
        }
        return take_single(check, known * WB_G);
    }
    if (options->masses) {
        check->n =
            wb_cell_calibration_parse(options->masses, check->masses, problem, sizeof problem);
        if (check->n == 0)
            wb_error("check: --masses: %s", problem);
        return check->n > 0;
    }
    if (!check->is_series)
        return take_single(check, cell->check_mass);
    check->n = cell->n_check_masses;
    memcpy(check->masses, cell->check_masses, sizeof check->masses);
    return true;
}

static bool fits_the_cell(const struct check *check)
{
    const struct wb_rig *const rig = check->rig;
    for (int i = 0; i < check->n; i++) {
        if (check->masses[i] * rig->gravity > rig->load_cell.overload) {
            wb_error("check: %g g exceeds the overload limit of the load cell (%g g)",
                     check->masses[i] / WB_G, rig->load_cell.overload / rig->gravity / WB_G);
            return false;
        }
    }
    if (check->options->common.output && !check->is_series) {
        wb_error("check: a certificate (-o) needs a series of masses: --masses 0,5,10,5,0, or "
                 "load_cell.check_masses_g in the rig file");
        return false;
    }
    return true;
}

/* --- measuring --- */

/* True once a whole line, which may be empty, was read from stdin; sets *ended at its end. Reads
 * byte by byte, so that the bytes behind the line remain for the next question. */
static bool line_came(bool *ended)
{
    struct pollfd polled = {.fd = STDIN_FILENO, .events = POLLIN};
    char byte;
    while (poll(&polled, 1, 0) > 0) {
        const ssize_t n = read(STDIN_FILENO, &byte, 1);
        if (n == 1 && byte == '\n')
            return true;
        if (n < 0 && errno == EINTR)
            return false;
        if (n <= 0) {
            *ended = true;
            return false;
        }
    }
    return false;
}

static void ask(double mass, enum wb_mass_check_phase phase)
{
    if (phase == WB_MASS_CHECK_WAITING && mass > 0.0)
        fprintf(stderr, "hang %g g on the load cell, then press Enter: ", mass / WB_G);
    else if (phase == WB_MASS_CHECK_WAITING)
        fprintf(stderr, "take the mass off the load cell, then press Enter: ");
    else if (phase == WB_MASS_CHECK_SETTLING && mass > 0.0)
        fprintf(stderr, "reading with %g g...\n", mass / WB_G);
    else if (phase == WB_MASS_CHECK_SETTLING)
        fprintf(stderr, "reading without a mass...\n");
}

static bool run_program(struct check *check, struct wb_mass_check *program)
{
    enum wb_mass_check_phase phase, before = WB_MASS_CHECK_CONNECTING;
    bool ended = false;
    while ((phase = wb_mass_check_step(program, 20 * WB_NS_PER_MS)) < WB_MASS_CHECK_DONE) {
        if (phase != before)
            ask(check->masses[wb_mass_check_index(program)], phase);
        before = phase;
        if (phase == WB_MASS_CHECK_WAITING && line_came(&ended))
            wb_mass_check_confirm(program);
        if (ended) {
            wb_error("standard input ended before Enter was pressed");
            return false;
        }
    }
    return phase == WB_MASS_CHECK_DONE;
}

static bool measure(struct check *check)
{
    struct wb_mass_check *program;
    if (wb_mass_check_open(&program, check->rig, check->options->seconds, check->masses,
                           check->n) != WB_OK)
        return false;
    const bool measured = run_program(check, program);
    if (measured)
        memcpy(check->points, wb_mass_check_points(program),
               (size_t)check->n * sizeof *check->points);
    wb_mass_check_close(program);
    wb_time_format(wb_time_utc(), check->utc);
    return measured;
}

static void judge(struct check *check)
{
    const double gravity = check->rig->gravity;
    if (check->is_series) {
        wb_cell_calibration_compute(&check->series, check->points, check->n, gravity,
                                    check->tolerance);
        check->passed = check->series.passed;
        return;
    }
    check->single = wb_cell_calibration_deviation(&check->points[0], &check->points[1], gravity);
    check->passed = fabs(check->single.relative) <= check->tolerance;
}

/* --- output --- */

static const char *or_not_given(const char *text)
{
    return text[0] ? text : "not given";
}

static void describe_single(const struct check *check, struct wb_json *root)
{
    wb_json_set_number(root, "known_mass_g", check->masses[1] / WB_G);
    wb_json_set_number(root, "read_mass_g", check->single.mass / WB_G);
    wb_json_set_number(root, "deviation_mg", check->single.deviation / WB_MG);
    wb_json_set_number(root, "deviation_percent", check->single.relative / WB_PERCENT);
    wb_json_set_number(root, "standard_error_mg", check->single.uncertainty / WB_MG);
}

static void describe_series(const struct check *check, struct wb_json *root)
{
    struct wb_json *const list = wb_json_set_array(root, "points");
    for (int i = 0; i < check->n; i++) {
        const struct wb_cell_deviation deviation = wb_cell_calibration_deviation(
            &check->points[0], &check->points[i], check->rig->gravity);
        struct wb_json *const entry = wb_json_append_object(list);
        wb_json_set_number(entry, "known_mass_g", check->masses[i] / WB_G);
        wb_json_set_number(entry, "read_mass_g", deviation.mass / WB_G);
        wb_json_set_number(entry, "deviation_mg", deviation.deviation / WB_MG);
        wb_json_set_number(entry, "standard_error_mg", deviation.uncertainty / WB_MG);
        wb_json_set_number(entry, "from_line_mg", check->series.residuals[i] / WB_MG);
        wb_json_set_number(entry, "scatter_mg", check->points[i].sd / check->rig->gravity / WB_MG);
        wb_json_set_boolean(entry, "down", check->series.is_down[i]);
    }
    struct wb_json *const results = wb_json_set_array(root, "quantities");
    for (int i = 0; i < WB_CELL_QUANTITIES; i++) {
        const struct wb_cell_result *const result = &check->series.results[i];
        const double none = (double)NAN;
        struct wb_json *const entry = wb_json_append_object(results);
        wb_json_set_text(entry, "name", wb_cell_calibration_name((enum wb_cell_quantity)i));
        wb_json_set_boolean(entry, "known", result->known);
        wb_json_set_number(entry, "percent", result->known ? result->value / WB_PERCENT : none);
        wb_json_set_number(entry, "standard_uncertainty_percent",
                           result->known ? result->uncertainty / WB_PERCENT : none);
        wb_json_set_number(entry, "at_g", result->known ? result->at / WB_G : none);
        wb_json_set_boolean(entry, "passed", result->passed);
    }
}

static void print_json(const struct check *check)
{
    const struct wb_rig *const rig = check->rig;
    struct wb_json *const root = wb_json_create();
    wb_json_set_boolean(root, "virtual_rig", rig->is_virtual);
    wb_json_set_text(root, "utc", check->utc);
    wb_json_set_text(root, "serial_number", or_not_given(rig->load_cell.serial_number));
    wb_json_set_text(root, "calibration_date", or_not_given(rig->load_cell.calibration_date));
    wb_json_set_number(root, "capacity_g", rig->load_cell.capacity / rig->gravity / WB_G);
    if (check->is_series)
        describe_series(check, root);
    else
        describe_single(check, root);
    wb_json_set_number(root, "tolerance_percent", check->tolerance / WB_PERCENT);
    wb_json_set_boolean(root, "passed", check->passed);
    wb_command_print_json(root);
}

static void print_single(const struct check *check)
{
    printf("known %.4f g, read %.4f g: deviation %+.2f mg (%+.3f %%), standard error %.2f mg\n",
           check->masses[1] / WB_G, check->single.mass / WB_G, check->single.deviation / WB_MG,
           check->single.relative / WB_PERCENT, check->single.uncertainty / WB_MG);
}

static void print_series(const struct check *check)
{
    printf("%10s %10s %14s %16s %14s\n", "mass g", "read g", "deviation mg", "uncertainty mg",
           "from line mg");
    for (int i = 0; i < check->n; i++) {
        const struct wb_cell_deviation deviation = wb_cell_calibration_deviation(
            &check->points[0], &check->points[i], check->rig->gravity);
        printf("%10g %10.4f %14.2f %16.2f %14.2f\n", check->masses[i] / WB_G, deviation.mass / WB_G,
               deviation.deviation / WB_MG, deviation.uncertainty / WB_MG,
               check->series.residuals[i] / WB_MG);
    }
    for (int i = 0; i < WB_CELL_QUANTITIES; i++) {
        const struct wb_cell_result *const result = &check->series.results[i];
        const char *const name = wb_cell_calibration_name((enum wb_cell_quantity)i);
        if (!result->known)
            printf("%-14s cannot be determined with these masses\n", name);
        else
            printf("%-14s %+.3f %% +- %.3f %%%s\n", name, result->value / WB_PERCENT,
                   result->uncertainty / WB_PERCENT, result->passed ? "" : ", EXCEEDED");
    }
}

static void print_text(const struct check *check)
{
    const struct wb_rig *const rig = check->rig;
    printf("%sload cell %s, capacity %g g, calibrated %s\n", rig->is_virtual ? "virtual rig: " : "",
           or_not_given(rig->load_cell.serial_number),
           rig->load_cell.capacity / rig->gravity / WB_G,
           or_not_given(rig->load_cell.calibration_date));
    if (check->is_series)
        print_series(check);
    else
        print_single(check);
    printf("%s: tolerance %g %%%s\n", check->passed ? "passed" : "NOT PASSED",
           check->tolerance / WB_PERCENT, check->is_series ? " of the span" : "");
}

/* Adds the result to the log beside the rig file; if the log cannot be written, that is reported
 * and does not change the result. A series is logged by its largest mass, as read by the slope of
 * the line. */
static void add_to_log(const struct check *check)
{
    struct wb_check_log_entry entry = {.tolerance = check->tolerance, .passed = check->passed};
    char path[WB_PATH];
    entry.known = check->is_series ? check->series.span : check->masses[1];
    entry.read = check->is_series ? check->series.slope * check->series.span : check->single.mass;
    snprintf(entry.utc, sizeof entry.utc, "%s", check->utc);
    snprintf(entry.serial_number, sizeof entry.serial_number, "%s",
             check->rig->load_cell.serial_number);
    if (wb_check_log_append(check->options->rig_path, &entry) == WB_OK &&
        wb_check_log_path(path, check->options->rig_path) == WB_OK)
        wb_info("added to '%s'", path);
}

static enum wb_status write_certificate(const struct check *check)
{
    const struct wb_command_common *const common = &check->options->common;
    const struct wb_certificate certificate = {
        .rig = check->rig,
        .utc = check->utc,
        .tolerance = check->tolerance,
        .seconds = check->options->seconds,
        .n = check->n,
        .points = check->points,
        .calibration = &check->series,
    };
    if (!common->output)
        return WB_OK;
    WB_TRY(wb_certificate_write(&certificate, common->output, common->force));
    wb_info("certificate: '%s'", common->output);
    return WB_OK;
}

int wb_check_cell_run(const struct wb_stage_options *options, const struct wb_rig *rig)
{
    const char *const output = options->common.output;
    struct check check = {
        .options = options,
        .rig = rig,
        .tolerance = options->tolerance > 0.0 ? options->tolerance : rig->load_cell.check_tolerance,
    };
    if (!take_masses(&check) || !fits_the_cell(&check))
        return WB_EXIT_USAGE;
    /* Checked before the operator hangs nine masses. */
    if (output && wb_command_check_output(output, options->common.force) != WB_OK)
        return WB_EXIT_FAILED;
    if (!measure(&check))
        return WB_EXIT_FAILED;
    judge(&check);
    add_to_log(&check);
    if (options->common.json)
        print_json(&check);
    else
        print_text(&check);
    if (write_certificate(&check) != WB_OK)
        return WB_EXIT_FAILED;
    return check.passed ? WB_EXIT_OK : WB_EXIT_FAILED;
}
