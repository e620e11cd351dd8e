#include "analysis/align/align.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_errno.h>

#include "analysis/align/align_private.h"
#include "base/memory.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "align"

#define DEFAULT_ROW_RATE 20.0 /* 1/s */

static const struct wb_setting setting_rows[] = {
    {WB_ROW_QUANTITY(wb_align_settings, longest_gap, "longest_gap_s", "s", 1.0, 1e-3, 60.0, 0.1),
     WB_ROW_OPTION("longest-gap-s", "S", "Omit rows where force or shape is missing for longer")},
    {WB_ROW_NUMBER(wb_align_settings, row_rate, "row_rate", 0.1, 1e4, 0.0),
     WB_ROW_OPTION("row-rate", "N", "Rows per second of bench time"), .otherwise = "20"},
    {WB_ROW_QUANTITY(wb_align_settings, shape_step, "shape_step_mm", "mm", WB_MM, 0.0, 1000.0, 0.5),
     WB_ROW_OPTION("shape-step-mm", "H", "Deflection between stored shapes")},
    {WB_ROW_QUANTITY(wb_align_settings, lost_steps, "lost_steps_mm", "mm", WB_MM, 0.01, 100.0, 0.3),
     WB_ROW_OPTION("lost-steps-mm", "H",
                   "Flag the stage when commanded and measured travel differ by more")},
};

const struct wb_setting_table wb_align_table = {WB_SETTING_ROWS(setting_rows)};

void wb_align_default_settings(struct wb_align_settings *settings)
{
    wb_setting_fill(&wb_align_table, settings);
    settings->rig_path = settings->specimen_path = NULL;
}

/* Rounds to 1e-9 (m, N, s or rad): far below the noise, and keeps the file short. */
static double rounded(double value)
{
    return round(value * 1e9) / 1e9;
}

static void set_info(struct wb_align *align)
{
    struct wb_test_info *const info = &align->dataset->info;
    memcpy(info->wire, align->wire.name, sizeof info->wire);
    info->sample = align->specimen.sample;
    info->length = align->specimen.length;
    info->outer_diameter = align->wire.outer_diameter;
    info->mass_per_length = wb_wire_mass_per_length(&align->wire);
    info->poissons_ratio = align->wire.has_properties ? align->wire.material.poissons_ratio : 0.3;
    info->strand_length = align->rig.strand.length;
    info->counterweight = align->rig.strand.counterweight;
    info->gravity = align->gravity;
    info->uncertainty = (struct wb_test_uncertainty){
        .gain = align->rig.load_cell.gain_uncertainty > 0.0 ? align->rig.load_cell.gain_uncertainty
                                                            : align->checked_gain,
        .length = align->specimen.length_uncertainty,
        .counterweight = align->rig.strand.counterweight_uncertainty,
        .diameter = align->wire.outer_diameter_uncertainty,
        .density = align->wire.density_uncertainty,
        .marker_offset = align->specimen.marker_offset_uncertainty,
    };
    info->is_virtual = align->is_virtual;
}

static void add_shape(struct wb_align *align, const struct wb_align_row *row)
{
    for (int k = 0; k < align->specimen.n_markers; k++) {
        if (!isfinite(row->y[k]))
            continue;
        const struct wb_shape_row shape = {
            .t = rounded(row->t),
            .deflection = rounded(row->tip_y),
            .marker = k,
            .s = align->specimen.markers[k],
            .x = rounded(row->x[k]),
            .y = rounded(row->y[k]),
            .z = (double)NAN, /* not set: shapes lie in the plane of bending */
        };
        wb_dataset_add_shape_row(align->dataset, &shape);
    }
}

/* Exports the rows from the start of the first cycle, and a shape after each step of the tip.
 *
 * The deflection of the previous row decides whether a step is complete. Had the row's own
 * deflection to decide, rows with a large noise in the direction of motion would be chosen too
 * early, and the stored shapes would lag behind their deflections. */
static enum wb_status export_rows(struct wb_align *align)
{
    double last_shape = (double)NAN, before = (double)NAN;
    for (size_t i = 0; i < align->n_rows; i++) {
        const struct wb_align_row *const row = &align->rows[i];
        if (row->t < 0.0)
            continue;
        const struct wb_row out = {
            .t = rounded(row->t),
            .cycle = row->cycle,
            .phase = row->phase,
            .deflection = rounded(row->tip_y),
            .tension = rounded(row->tension),
            .force = rounded(row->force),
            .stage = rounded(row->commanded),
            .tip_x = rounded(row->tip_x),
            .tip_angle = rounded(row->tip_angle),
        };
        wb_dataset_add_row(align->dataset, &out);
        if (!(fabs(before - last_shape) < align->settings.shape_step)) {
            add_shape(align, row);
            last_shape = row->tip_y;
        }
        before = row->tip_y;
    }
    if (align->dataset->n_rows == 0)
        return wb_fail_to(align->why, WB_ERR_DATA,
                          "%s: nothing was recorded after the first cycle's start", align->name);
    return WB_OK;
}

static void describe_rows(struct wb_align *align)
{
    struct wb_json *const document = align->dataset->document;
    /* A row's time is the mean time of its frames, of which half may be lost. A marker that is
     * hidden for exactly longest_gap separates two rows by up to 1.5 row intervals more than
     * that. */
    const double most = align->settings.longest_gap + 1.5 / align->settings.row_rate;
    size_t n_gaps = 0;
    double longest = 0.0, largest = 0.0;
    for (size_t i = 0; i < align->n_rows; i++) {
        const bool is_next =
            i > 0 && !wb_align_is_held(align, align->rows[i - 1].t, align->rows[i].t);
        const double gap = is_next ? align->rows[i].t - align->rows[i - 1].t : 0.0;
        n_gaps += gap > most;
        longest = fmax(longest, gap);
        largest = fmax(largest, align->rows[i].tip_y);
    }
    wb_json_set_integer(document, "cycles", align->n_cycles);
    wb_align_set(document, "largest_deflection_mm", largest / WB_MM);
    wb_json_set_boolean(document, "complete", !align->is_cut_short && n_gaps == 0);
    struct wb_json *const rows = wb_json_set_object(align->checks, "rows");
    wb_json_set_integer(rows, "rows", (int64_t)align->dataset->n_rows);
    wb_json_set_integer(rows, "shape_rows", (int64_t)align->dataset->n_shape_rows);
    wb_json_set_integer(rows, "left_out", (int64_t)align->n_dropped_rows);
    if (align->n_holds > 0)
        wb_json_set_integer(rows, "held", (int64_t)align->n_held_rows);
    wb_json_set_integer(rows, "gaps", (int64_t)n_gaps);
    wb_align_set(rows, "longest_gap_s", longest);
    wb_align_set(rows, "deflection_level_uncertainty_mm",
                 wb_align_level_uncertainty(align) / WB_MM);
    wb_json_set_text(rows, "note",
                     "a row is the mean of the frames of 1/row_rate seconds in which the tip's "
                     "marker was seen, with the readings around that time; gaps are not filled");
    if (n_gaps > 0)
        wb_align_warn(align, "%zu gap%s " WB_ALIGN_GAPS_TEXT " %.2f s", n_gaps,
                      n_gaps == 1 ? "" : "s", longest);
}

static enum wb_status run(struct wb_align *align,
                          enum wb_status (*load)(struct wb_align *, const void *),
                          const void *context)
{
    WB_TRY(load(align, context));
    WB_TRY(wb_align_times(align));
    WB_TRY(wb_align_markers(align));
    WB_TRY(wb_align_rows(align));
    WB_TRY(wb_align_cycles(align));
    wb_align_stage(align);
    WB_TRY(wb_align_force(align));
    set_info(align);
    wb_align_natural(align);
    WB_TRY(export_rows(align));
    describe_rows(align);
    wb_align_describe_holds(align);
    return WB_OK;
}

static void release(struct wb_align *align)
{
    free(align->readings.items);
    free(align->reports.items);
    free(align->probes.items);
    free(align->frame_t);
    free(align->rows);
    wb_point_cloud_release(&align->cloud);
    wb_marker_tracks_release(&align->tracks);
    wb_frame_release(&align->frame);
}

/* --- signals --- */

void wb_align_signals_release(struct wb_align_signals *signals)
{
    free(signals->motion_t);
    free(signals->motion);
    free(signals->force_t);
    free(signals->force);
    memset(signals, 0, sizeof *signals);
}

static void keep_signals(const struct wb_align *align, struct wb_align_signals *signals)
{
    const struct wb_align_reading *const readings = align->readings.items;
    const size_t n_frames = align->cloud.n_frames, n = align->readings.n;
    const int up = align->rig.mocap.up == 'z' ? 2 : 1;
    *signals = (struct wb_align_signals){
        .motion_t = wb_memory_new(n_frames, sizeof *signals->motion_t),
        .motion = wb_memory_new(n_frames, sizeof *signals->motion),
        .n_force = n,
        .force_t = wb_memory_new(n, sizeof *signals->force_t),
        .force = wb_memory_new(n, sizeof *signals->force),
        .filter_delay = align->filter_delay,
        .filter_delay_uncertainty = align->filter_delay_uncertainty,
    };
    for (size_t i = 0; i < n_frames; i++) {
        const double *const clamp = wb_markers_position(&align->tracks, i, 0);
        if (!clamp)
            continue;
        signals->motion_t[signals->n_motion] = align->frame_t[i];
        signals->motion[signals->n_motion++] = -clamp[up];
    }
    for (size_t i = 0; i < n; i++) {
        signals->force_t[i] = readings[i].t;
        signals->force[i] = readings[i].force;
    }
}

enum wb_status wb_align_run_from(struct wb_dataset *dataset, struct wb_align_signals *signals,
                                 const struct wb_align_settings *settings,
                                 enum wb_status (*load)(struct wb_align *, const void *),
                                 const void *context, struct wb_reason *why)
{
    struct wb_reason lost = {.text = ""};
    memset(dataset, 0, sizeof *dataset);
    if (why)
        *why = lost;
    WB_TRY(wb_setting_check(&wb_align_table, settings, why));
    /* GSL's default handler aborts; its status codes are checked instead. */
    gsl_set_error_handler_off();
    struct wb_align *const align = wb_memory_new(1, sizeof *align);
    wb_dataset_init(dataset);
    align->why = why;
    align->lost = why ? &lost : NULL;
    align->dataset = dataset;
    align->settings = *settings;
    if (align->settings.row_rate == 0.0)
        align->settings.row_rate = DEFAULT_ROW_RATE;
    const enum wb_status status = run(align, load, context);
    if (status == WB_OK && signals)
        keep_signals(align, signals);
    release(align);
    free(align);
    if (status != WB_OK)
        wb_dataset_release(dataset);
    if (status != WB_OK && lost.text[0])
        wb_reason_set(why, "%s%s%s", lost.text, why->text[0] ? "; " : "", why->text);
    else if (lost.text[0])
        wb_error("%s", lost.text);
    return status;
}

enum wb_status wb_align_run(struct wb_dataset *dataset, const char *recording_path,
                            const struct wb_align_settings *settings, struct wb_reason *why)
{
    return wb_align_run_from(dataset, NULL, settings, wb_align_load, recording_path, why);
}

enum wb_status wb_align_run_signals(struct wb_dataset *dataset, struct wb_align_signals *signals,
                                    const char *recording_path,
                                    const struct wb_align_settings *settings, struct wb_reason *why)
{
    memset(signals, 0, sizeof *signals);
    return wb_align_run_from(dataset, signals, settings, wb_align_load, recording_path, why);
}
