/* Writes corrections, checks, warnings and provenance into dataset.json. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/align/align_private.h"
#include "analysis/keys/common.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "align"

void wb_align_set(struct wb_json *object, const char *key, double value)
{
    char text[40];
    snprintf(text, sizeof text, "%.6g", value);
    wb_json_set_number(object, key, isfinite(value) ? strtod(text, NULL) : value);
}

void wb_align_warn(struct wb_align *align, const char *format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    wb_warn("%s: %s", align->name, text);
    wb_json_append_text(align->warnings, text);
}

void wb_align_correct(struct wb_align *align, const struct wb_align_correction *correction,
                      const char *note, ...)
{
    char key[64], text[512];
    va_list arguments;
    va_start(arguments, note);
    vsnprintf(text, sizeof text, note, arguments);
    va_end(arguments);
    struct wb_json *const entry = wb_json_append_object(align->corrections);
    wb_json_set_text(entry, "name", correction->name);
    snprintf(key, sizeof key, "value_%s", correction->unit);
    wb_align_set(entry, key, correction->value / correction->factor);
    snprintf(key, sizeof key, "uncertainty_%s", correction->unit);
    wb_align_set(entry, key, correction->uncertainty / correction->factor);
    wb_json_set_text(entry, "note", text);
}

static void describe_settings(const struct wb_align *align, struct wb_json *document)
{
    struct wb_json *const settings = wb_json_set_object(document, "settings");
    wb_align_set(settings, "longest_gap_s", align->settings.longest_gap);
    wb_align_set(settings, "row_rate_per_s", align->settings.row_rate);
    wb_align_set(settings, "shape_step_mm", align->settings.shape_step / WB_MM);
    wb_align_set(settings, "lost_steps_mm", align->settings.lost_steps / WB_MM);
}

static void describe_specimen(const struct wb_align *align, struct wb_json *document)
{
    const struct wb_specimen *const specimen = &align->specimen;
    struct wb_json *const object = wb_json_set_object(document, "specimen");
    wb_json_set_text(object, "wire", align->wire.name);
    wb_json_set_integer(object, "sample", specimen->sample);
    wb_align_set(object, "length_mm", specimen->length / WB_MM);
    struct wb_json *const markers = wb_json_set_array(object, "markers_mm");
    for (int i = 0; i < specimen->n_markers; i++)
        wb_json_append_number(markers, round(specimen->markers[i] / WB_MM * 1e6) / 1e6);
    wb_align_set(object, "marker_offset_mm", specimen->marker_offset / WB_MM);
    wb_align_set(object, "marker_offset_uncertainty_mm",
                 specimen->marker_offset_uncertainty / WB_MM);
    wb_align_set(object, "outer_diameter_mm", align->wire.outer_diameter / WB_MM);
    wb_align_set(object, "density_g_cm3", align->wire.density / WB_G_PER_CM3);
}

static void describe_rig(const struct wb_align *align, struct wb_json *document)
{
    const struct wb_rig *const rig = &align->rig;
    struct wb_json *const object = wb_json_set_object(document, "rig");
    wb_json_set_text(object, "name", rig->name);
    wb_json_set_boolean(object, "virtual_rig", align->is_virtual);
    wb_align_set(object, "time_scale", rig->time_scale);
    wb_align_set(object, "gravity_m_s2", align->gravity);
    struct wb_json *const cell = wb_json_set_object(object, "load_cell");
    wb_json_set_text(cell, "protocol", rig->load_cell.protocol);
    wb_align_set(cell, "capacity_g", rig->load_cell.capacity / WB_STANDARD_GRAVITY / WB_G);
    wb_json_set_text(cell, "serial_number", rig->load_cell.serial_number);
    wb_json_set_text(cell, "calibration_date", rig->load_cell.calibration_date);
    wb_align_set(cell, "filter_delay_ms", rig->load_cell.filter_delay * 1e3);
    wb_align_set(cell, "filter_delay_uncertainty_ms",
                 rig->load_cell.filter_delay_uncertainty * 1e3);
    wb_json_set_text(wb_json_set_object(object, "mocap"), "protocol", rig->mocap.protocol);
    struct wb_json *const stage = wb_json_set_object(object, "stage");
    wb_json_set_text(stage, "protocol", rig->stage.protocol);
    wb_align_set(stage, "speed_mm_s", rig->stage.speed / WB_MM);
    struct wb_json *const strand = wb_json_set_object(object, "strand");
    wb_align_set(strand, "length_mm", rig->strand.length / WB_MM);
    wb_align_set(strand, "counterweight_g", rig->strand.counterweight / WB_G);
}

void wb_align_describe(struct wb_align *align)
{
    struct wb_json *const document = align->dataset->document;
    wb_json_set_text(document, "name", align->name);
    wb_json_set_text(document, "source",
                     align->is_virtual ? "test on a virtual rig" : "test on the bench");
    wb_keys_put_tool(document, "wirebench align");
    describe_settings(align, document);
    describe_specimen(align, document);
    describe_rig(align, document);
    align->corrections = wb_json_set_array(document, "corrections");
    align->checks = wb_json_set_object(document, "checks");
    align->warnings = wb_json_set_array(document, "warnings");
}
