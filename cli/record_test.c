#include "cli/record_test.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/config.h"
#include "base/interrupt.h"
#include "base/text.h"
#include "base/units.h"
#include "cli/command.h"
#include "cli/live_line.h"
#include "daq/acquire/acquisition.h"
#include "daq/protocol/specimen.h"
#include "fe/model/wire.h"

#define WB_LOG_DOMAIN "record"

/* The fields of the live line, as text. */
struct fields {
    const char *origin;
    char phase[48], force[64], travel[32], deflection[32], markers[32], drops[32], rates[64];
};

static void fill_fields(const struct wb_bend_test_status *status, struct fields *f)
{
    const struct wb_acquisition_latest *const latest = status->latest;
    const struct wb_acquisition_stream_state *const stream = latest->stream;
    const int seconds = (int)status->elapsed;
    *f = (struct fields){.origin = status->is_virtual ? "virtual rig: " : "",
                         .force = "-- mN",
                         .travel = "-- mm",
                         .deflection = "-- mm",
                         .markers = "no markers"};
    if (status->cycle > 0)
        snprintf(f->phase, sizeof f->phase, "%s %d/%d %d:%02d", status->phase, status->cycle,
                 status->cycles, seconds / 60, seconds % 60);
    else
        snprintf(f->phase, sizeof f->phase, "%s %d:%02d", status->phase, seconds / 60,
                 seconds % 60);
    if (status->has_tension)
        snprintf(f->force, sizeof f->force, "%.2f mN %.2f g", status->tension / WB_MN,
                 status->tension / status->gravity / WB_G);
    if (status->has_deflection)
        snprintf(f->deflection, sizeof f->deflection, "%.1f mm", status->deflection / WB_MM);
    if (status->has_travel)
        snprintf(f->travel, sizeof f->travel, "%.1f mm", status->travel / WB_MM);
    if (latest->has_mocap)
        snprintf(f->markers, sizeof f->markers, "%d/%d", latest->markers_seen,
                 status->markers_expected);
    snprintf(f->drops, sizeof f->drops, "%" PRIu64,
             stream[WB_ROLE_LOAD].drops + stream[WB_ROLE_MOCAP].drops +
                 stream[WB_ROLE_STAGE].drops);
    if (status->latest->is_storage_late)
        snprintf(f->drops, sizeof f->drops, "0, DISK %.1f s LATE",
                 wb_seconds_from_ns(status->latest->storage.lag_ns));
    snprintf(f->rates, sizeof f->rates, "%.0f/%.0f/%.0f Hz", stream[WB_ROLE_LOAD].rate,
             stream[WB_ROLE_MOCAP].rate, stream[WB_ROLE_STAGE].rate);
}

/* Uses the longest form that fits the terminal: in words, short, or short without rates. */
static void show(const struct wb_bend_test *test)
{
    struct wb_bend_test_status status;
    struct fields f;
    char line[512];
    wb_bend_test_status(test, &status);
    fill_fields(&status, &f);
    const int columns = wb_live_line_columns();
    int length =
        snprintf(line, sizeof line,
                 "%s%s  force %s  deflection %s  travel %s  markers %s  drops %s  "
                 "cell/cameras/stage %s",
                 f.origin, f.phase, f.force, f.deflection, f.travel, f.markers, f.drops, f.rates);
    if (length > columns)
        length = snprintf(line, sizeof line, "%s%s %s y %s %s %s drops %s", f.origin, f.phase,
                          f.force, f.deflection, f.markers, f.drops, f.rates);
    if (length > columns)
        snprintf(line, sizeof line, "%s%s %s y %s %s %s drops", f.origin, f.phase, f.force,
                 f.deflection, f.markers, f.drops);
    wb_live_line_show("%s", line);
}

static void handle_key(struct wb_bend_test *test, int key)
{
    switch (key) {
    case 'm':
        wb_bend_test_mark(test, "key m");
        wb_info("marked");
        break;
    case 'h':
        if (!wb_bend_test_hold(test))
            wb_info("cannot hold: the stage is not moving, or is held already");
        break;
    case 'r':
        if (wb_bend_test_resume(test))
            wb_info("resumed");
        else
            wb_info("cannot resume: the test is not held, or the stage is still moving");
        break;
    case 'q':
        wb_bend_test_stop(test);
        break;
    }
}

static void run(struct wb_bend_test *test, struct wb_record_views *views)
{
    while (wb_bend_test_step(test, 20 * WB_NS_PER_MS) == WB_SEQUENCE_RUNNING) {
        if (wb_record_views_update(views, false) && wb_live_line_due())
            show(test);
        handle_key(test, wb_record_views_key(views));
    }
    (void)wb_record_views_update(views, true);
}

/* Reports why the test stopped, and how to free the specimen. */
static void report_stop(const struct wb_bend_test_result *result, const char *rig_path,
                        bool bench_stays)
{
    struct wb_text rig = {0};
    if (result->end == WB_SEQUENCE_LIMIT)
        wb_warn("stopped by a limit: %s", result->text);
    else if (result->end == WB_SEQUENCE_INTERRUPTED)
        wb_warn("%s", result->text);
    else
        wb_error("%s", result->text);
    if (!result->standing)
        wb_error("the stage did not confirm that it stopped: switch off its power before you touch "
                 "the bench");
    if (!result->standing || !bench_stays)
        return;
    wb_text_append_quoted(&rig, rig_path);
    if (result->displaced && isfinite(result->travel))
        wb_warn(
            "the stage stopped at %.2f mm and the specimen stays loaded; free it with: wirebench "
            "stage %s release %.0f --zero-mn=%.2f (it moves up by at most that distance in mm; "
            "a slack strand gives that reading)",
            result->travel / WB_MM, wb_text_string(&rig), ceil(fabs(result->travel) / WB_MM) + 1.0,
            result->unloaded / WB_MN);
    else if (result->displaced)
        wb_warn(
            "the specimen stays loaded; free it with: wirebench stage %s release --zero-mn=%.2f "
            "(a slack strand gives that reading)",
            wb_text_string(&rig), result->unloaded / WB_MN);
    wb_text_release(&rig);
}

static void report_losses(const struct wb_bend_test_result *result)
{
    if (result->drops > 0)
        wb_warn("%" PRIu64 " reads are missing from the recording", result->drops);
    for (int role = 0; role < WB_INTERLOCK_ROLES; role++) {
        if (result->is_losing[role])
            wb_warn(
                "%.2g %% of the data from the %s never came: %" PRIu64 " in %" PRIu64
                " gaps, the longest of %.3g s: check its cable or network, and the load of this "
                "computer",
                wb_loss_share(&result->loss[role]) / WB_PERCENT, wb_role_name((enum wb_role)role),
                result->loss[role].missing, result->loss[role].gaps,
                result->loss[role].longest_gap);
    }
}

static void report_holds(const struct wb_bend_test_result *result)
{
    if (result->holds > 0)
        wb_warn(
            "the test was held %d time%s, for %.0f s in all: the wire relaxed meanwhile, so that "
            "the rest of the curve has another loading history",
            result->holds, result->holds == 1 ? "" : "s", result->held);
}

static int exit_code(const struct wb_bend_test_result *result, enum wb_status status)
{
    if (result->end == WB_SEQUENCE_DONE && status == WB_OK && result->drops == 0 &&
        !result->is_losing[WB_ROLE_LOAD] && !result->is_losing[WB_ROLE_MOCAP])
        return WB_EXIT_OK;
    if (result->end == WB_SEQUENCE_INTERRUPTED && result->recorded)
        return WB_EXIT_INCOMPLETE;
    return result->started ? WB_EXIT_INCOMPLETE : WB_EXIT_FAILED;
}

void wb_record_test_print(FILE *out, const struct wb_bend_test_result *result, const char *output)
{
    fprintf(out,
            "%s: %s%d cycle%s, %.0f s, %" PRIu64 " readings, %" PRIu64 " frames, largest tension "
            "%.2f mN, %" PRIu64 " drops\n",
            output, result->is_virtual ? "virtual rig, " : "", result->cycles_done,
            result->cycles_done == 1 ? "" : "s", result->duration, result->samples[WB_ROLE_LOAD],
            result->samples[WB_ROLE_MOCAP], result->peak_tension / WB_MN, result->drops);
}

/* Reads the specimen's wire and sets the bounds of the first force in the request. */
static enum wb_status find_wire(struct wb_bend_test_request *request, struct wb_wire *wire)
{
    struct wb_first_force_bounds *const bounds = &request->stiffness;
    char path[WB_PATH];
    struct wb_specimen specimen;
    WB_TRY(wb_bend_test_specimen(request, &specimen));
    WB_TRY(wb_specimen_find_wire(&specimen, request->specimen_path, path));
    WB_TRY(wb_wire_read(path, wire, NULL));
    wb_wire_stiffness_bounds(wire, specimen.length, &bounds->lowest, &bounds->highest);
    snprintf(bounds->of, sizeof bounds->of,
             wire->has_properties ? "%s (a third to three times the properties in its file)"
                                  : "%s (between free strands and solid copper)",
             wire->name);
    return WB_OK;
}

static enum wb_status run_test(struct wb_bend_test_request *request,
                               struct wb_record_views_options *options, bool bench_stays,
                               struct wb_bend_test_result *result, int *code)
{
    static struct wb_record_views views;
    struct wb_bend_test *test;
    struct wb_wire wire;
    WB_TRY(find_wire(request, &wire));
    wb_interrupt_install();
    wb_interrupt_guard();
    WB_TRY(wb_record_views_open(&views, options, request, &wire));
    wb_acquisition_raise_priority();
    const enum wb_status opened = wb_bend_test_open(&test, request);
    if (opened != WB_OK) {
        wb_record_views_close(&views);
        return opened;
    }
    wb_record_views_begin(&views, test);
    run(test, &views);
    const enum wb_status status = wb_bend_test_close(test, result);
    /* While the views are open, because afterwards messages would wait for a terminal that hangs.
     */
    if (result->end != WB_SEQUENCE_DONE)
        report_stop(result, request->rig_path, bench_stays);
    report_losses(result);
    report_holds(result);
    if (!result->recorded)
        wb_info("nothing was recorded: '%s' was removed", request->output_path);
    wb_record_views_close(&views);
    *code = exit_code(result, status);
    return WB_OK;
}

/* Reads the specimen's file once, so that checks, views and recording use the same text even if the
 * file changes meanwhile. */
enum wb_status wb_record_test_run(struct wb_bend_test_request *request,
                                  struct wb_record_views_options *options,
                                  struct wb_virtual_test *virtual,
                                  struct wb_bend_test_result *result, int *code)
{
    const char *const given = request->specimen_text;
    char *text = NULL;
    if (!given)
        WB_TRY(wb_config_read_text(&text, request->specimen_path, NULL));
    request->specimen_text = given ? given : text;
    enum wb_status status = virtual ? wb_virtual_test_begin(virtual, request) : WB_OK;
    if (status == WB_OK) {
        status = run_test(request, options, !virtual, result, code);
        if (virtual)
            wb_virtual_test_end(virtual, request);
    }
    request->specimen_text = given;
    free(text);
    return status;
}
