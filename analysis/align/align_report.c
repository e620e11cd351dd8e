/* Writes corrections, checks, warnings and provenance into dataset.json. */
#include <math.h>

#include "analysis/align/align_keys.h"
#include "analysis/align/align_private.h"
#include "analysis/keys/common.h"
#include "analysis/keys/row.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "align"

/* --- keys --- */

#define ALIGN(member) WB_AT(struct wb_align, member)
#define FRAME(member) WB_AT(struct wb_bench_frame, member)

/* --- checks --- */

static const struct wb_key camera_clock_rows[] = {
    {"method", TEXT, "how the clock was mapped to the host's",
     .choices = "echo probes|lower envelope"},
    {"frames", INTEGER, "frames of the segment"},
    {"points", INTEGER, "points that a line could be fitted to: probes or arrivals"},
    {"points_used", INTEGER, "points that the line was fitted to"},
    {"offset_s", NUMBER, "host clock minus server clock at the first point"},
    {"span_s", NUMBER, "length of the segment by the server's clock"},
    {"skew_ppm", NUMBER, "relative difference of the rates of both clocks"},
    {"skew_uncertainty_ppm", NUMBER | UNKNOWN, "standard uncertainty of the skew"},
    {"scatter_ms", NUMBER | UNKNOWN, "scatter of the points about the line"},
    {"uncertainty_ms", NUMBER | UNKNOWN, "standard uncertainty of mapped times"},
    {"note", TEXT | OPTIONAL, "what the uncertainty does not include"},
};
static WB_KEYS(camera_clock, "camera_clock",
               "A segment of the cameras' clock, from one restart to the next.");

static const struct wb_key load_stream_rows[] = {
    {"method", TEXT, "source of the readings' times",
     .choices = "times of the file|arrival of each reading|lower envelope"},
    {"readings", INTEGER, "number of readings"},
    {"invalid_readings", INTEGER, "readings without a value"},
    {"segments", INTEGER, "stretches between interruptions of the stream"},
    {"rate_per_s", NUMBER | OPTIONAL, "readings per second"},
    {"arrival_scatter_ms", NUMBER | UNKNOWN,
     "scatter of the arrivals about the line over the readings' number"},
};
static WB_KEYS(load_stream, "load_cell_stream", "The stream of the load cell.");

static const struct wb_key markers_rows[] = {
    {"frames", INTEGER, "number of frames"},
    {"seen_percent", NUMBER, "share of the markers' places that were seen"},
    {"stray_points", INTEGER, "points that belong to no marker"},
    {"occluded_left_out", INTEGER, "points left out because the server marked them as occluded"},
    {"model_filled_left_out", INTEGER,
     "points left out because the server computed them from a model"},
    {"chain_searches", INTEGER, "searches for the chain of markers from scratch"},
};
static WB_KEYS(markers, "markers", "The identification of the markers.");

static const struct wb_key loss_rows[] = {
    {"received", INTEGER, "number received"},
    {"missing", INTEGER, "number that never arrived"},
    {"gaps", INTEGER, "places where some are missing"},
    {"repeated", INTEGER, "number received twice"},
    {"overtaken", INTEGER, "number received after a later one"},
    {"longest_gap_s", NUMBER, "longest gap"},
};
static WB_KEYS(loss, "loss", "Samples of one stream that were lost.");

static const struct wb_key losses_rows[] = {
    {"frames", OBJECT, "frames of the cameras", &loss_keys},
    {"readings", OBJECT, "readings of the load cell", &loss_keys},
};
static WB_KEYS(losses, "losses", "Samples that were lost.");

static const struct wb_key zero_rows[] = {
    {"t_s", NUMBER, "time of the stretch"},
    {"reading_mN", NUMBER, "mean reading, less the tare"},
    {"uncertainty_mN", NUMBER | UNKNOWN, "standard uncertainty of the mean"},
};
static WB_KEYS(zero, "zero_load", "A stretch without load.");

static const struct wb_key timing_rows[] = {
    {"camera_clock", TEXT, "method by which the cameras' clock was mapped"},
    {"camera_clock_uncertainty_ms", NUMBER | UNKNOWN, "standard uncertainty of the cameras' times"},
    {"filter_delay_uncertainty_ms", NUMBER, "standard uncertainty of the load cell's filter delay"},
    {"lag_uncertainty_ms", NUMBER | UNKNOWN, "uncertainty of the lag between force and deflection"},
    {"speed_mm_s", NUMBER, "speed of the tip"},
    {"deflection_error_mm", NUMBER | UNKNOWN, "error of the deflection by such a lag"},
    {"force_error_mN", NUMBER | UNKNOWN, "error of the force by such a lag"},
    {"loop_width_error_mm", NUMBER | UNKNOWN, "width of the loop that such a lag opens"},
    {"loop_area_mJ", NUMBER | UNKNOWN, "area of the first cycle's loop"},
    {"loop_area_per_delay_mJ_per_s", NUMBER | UNKNOWN,
     "change of that area with the filter delay that is subtracted"},
    {"loop_area_error_mJ", NUMBER | UNKNOWN, "error of that area by such a lag"},
    {"note", TEXT, "explanation of these numbers"},
};
static WB_KEYS(timing, "timing", "The effect of a lag between force and deflection.");

static const struct wb_key natural_rows[] = {
    {"bow_mm", NUMBER, "natural offset of the tip"},
    {"bow_uncertainty_mm", NUMBER | UNKNOWN, "standard uncertainty of the bow"},
    {"bow_from_markers_mm", NUMBER | UNKNOWN, "bow by the markers alone"},
    {"bow_from_markers_uncertainty_mm", NUMBER | UNKNOWN, "its standard uncertainty"},
    {"bow_from_force_mm", NUMBER | UNKNOWN, "bow by the force alone"},
    {"bow_from_force_uncertainty_mm", NUMBER | UNKNOWN, "its standard uncertainty"},
    {"per_percent_of_counterweight_mm", NUMBER,
     "change of the bow by the force when the counterweight changes by 1 %"},
    {"terms_uncertainty_rad", NUMBER | LIST | UNKNOWN,
     "standard uncertainties of the terms of `natural_shape_rad`"},
};
static WB_KEYS(natural, "natural_shape", "The natural shape of the wire, from force and markers.");

static const struct wb_key hold_rows[] = {
    {"cycle", INTEGER, "cycle, from 1"},
    {"phase", TEXT, "phase in which the test was held", .choices = "down|up|rest"},
    {"travel_mm", NUMBER | UNKNOWN, "travel of the stage at the hold"},
    {"start_s", NUMBER, "time at which the hold began"},
    {"lasted_s", NUMBER | UNKNOWN, "duration; null: to the end of the test"},
    {"tension_before_mN", NUMBER | UNKNOWN, "tension when the hold began"},
    {"tension_after_mN", NUMBER | UNKNOWN, "tension when the hold ended"},
};
static WB_KEYS(hold, "hold", "A hold of the test by the operator.");

static const struct wb_key check_rows_rows[] = {
    {"rows", INTEGER, "rows of force_deflection.csv"},
    {"shape_rows", INTEGER, "rows of shape.csv"},
    {"left_out", INTEGER, "time bins that have frames and give no row"},
    {"held", INTEGER | OPTIONAL, "rows left out because the operator held the test"},
    {"gaps", INTEGER, "gaps between rows longer than `longest_gap_s` of the settings"},
    {"longest_gap_s", NUMBER, "longest gap between rows"},
    {"deflection_level_uncertainty_mm", NUMBER | UNKNOWN,
     "standard uncertainty of the level of zero deflection"},
    {"note", TEXT, "what a row is"},
};
static WB_KEYS(check_rows, "rows_check", "The rows of the tables.");

static const struct wb_key import_rows[] = {
    {"take", TEXT, "name of the cameras' file"},
    {"take_sha256", TEXT, "SHA-256 of that file"},
    {"format", TEXT, "format of that file"},
    {"frames", INTEGER, "frames of the file"},
    {"missing_frames", INTEGER, "frames that the file lacks"},
    {"jumps", INTEGER, "places where frames are missing between two others"},
    {"frames_jumped", INTEGER, "frames missing at these places"},
    {"skipped_rows", INTEGER,
     "rows left out: cut off, out of order or with another number of cells"},
    {"first_skipped_line", INTEGER, "line of the first such row; 0: none"},
    {"empty_rows", INTEGER, "rows without a marker"},
    {"marker_columns", INTEGER, "columns of markers in the file"},
    {"markers", INTEGER, "markers of the wire"},
    {"columns_stitched", INTEGER, "columns joined to others because they show the same marker"},
    {"missing_percent", NUMBER, "share of the markers' places that the file lacks"},
    {"force", TEXT | OPTIONAL, "name of the force file"},
    {"force_sha256", TEXT | OPTIONAL, "SHA-256 of that file"},
    {"readings", INTEGER | OPTIONAL, "readings of force"},
    {"force_skipped_rows", INTEGER | OPTIONAL, "rows of force that could not be read"},
    {"clocks", TEXT | OPTIONAL, "method by which the two clocks were brought together"},
    {"lag_s", NUMBER | UNKNOWN | OPTIONAL, "lag found between the two clocks"},
    {"lag_uncertainty_s", NUMBER | UNKNOWN | OPTIONAL, "standard uncertainty of the lag"},
    {"events_paired", INTEGER | OPTIONAL, "events found in both files"},
    {"offset_s", NUMBER | UNKNOWN | OPTIONAL, "time of the recording less time of the force file"},
};
static WB_KEYS(import, "mocap_import", "The import of files of cameras and load cell.");

static const struct wb_key wb_align_plane_rows[] = {
    {"planarity_rms_mm", FRAME(planarity) | ROUNDED,
     "RMS distance of the markers from the bending plane"},
    {"plane_tilt_deg", FRAME(plane_tilt) | ROUNDED,
     "angle of the fitted plane's normal to the horizontal"},
    {"clamp_motion_mm", FRAME(motion) | ROUNDED, "travel of the clamp's marker"},
    {"clamp_path_rms_mm", FRAME(straightness) | ROUNDED,
     "RMS distance of the clamp's path from a straight line"},
    {"vertical_tilt_deg", FRAME(tilt) | ROUNDED,
     "angle between the clamp's motion and the cameras' up axis"},
    {"vertical_uncertainty_mrad", NUMBER | UNKNOWN,
     "standard uncertainty of the vertical's direction"},
    {"vertical", TEXT, "source of the vertical's direction"},
};
WB_KEYS(wb_align_plane, "bending_plane", "The plane in which the wire bends.");

static const struct wb_key stage_rows[] = {
    {"reports", INTEGER | OPTIONAL, "position reports of the stage that were compared"},
    {"slope", NUMBER | OPTIONAL, "measured over commanded travel"},
    {"slope_uncertainty", NUMBER | UNKNOWN | OPTIONAL, "standard uncertainty of the slope"},
    {"offset_mm", NUMBER | OPTIONAL, "measured travel at a commanded travel of zero"},
    {"report_lag_ms", NUMBER | OPTIONAL, "delay of the stage's reports"},
    {"residual_rms_mm", NUMBER | OPTIONAL, "RMS deviation of the travel from the line"},
    {"largest_residual_mm", NUMBER | OPTIONAL, "largest deviation from the line"},
    {"not_returned_mm", NUMBER | UNKNOWN | OPTIONAL,
     "measured less commanded travel after the test, less the same before it"},
    {"lost_steps", FLAG, "the stage seems to have lost steps"},
};
static WB_KEYS(
    stage, "stage_check",
    "Measured over commanded travel of the stage; only `lost_steps` where the clamp did not follow "
    "the stage.");

static const struct wb_key wb_align_checks_rows[] = {
    {"import", OBJECT | OPTIONAL, "of an imported recording: what the import found", &import_keys},
    {"losses", OBJECT | OPTIONAL, "frames and readings that were lost", &losses_keys},
    {"camera_clock", OBJECT | LIST | OPTIONAL, "segments of the cameras' clock",
     &camera_clock_keys},
    {"disordered_frames", INTEGER | OPTIONAL,
     "frames left out: without a stamp, repeated or out of order"},
    {"load_cell_stream", OBJECT | OPTIONAL, "the stream of the load cell", &load_stream_keys},
    {"markers", OBJECT | OPTIONAL, "identification of the markers", &markers_keys},
    {"bending_plane", OBJECT | OPTIONAL, "plane in which the wire bends", &wb_align_plane_keys},
    {"stage", OBJECT | OPTIONAL, "measured over commanded travel", &stage_keys},
    {"zero_load", OBJECT | LIST | OPTIONAL, "stretches without load", &zero_keys},
    {"timing", OBJECT | OPTIONAL, "effect of a lag between force and deflection", &timing_keys},
    {"natural_shape", OBJECT | OPTIONAL, "natural shape from force and markers", &natural_keys},
    {"rows", OBJECT | OPTIONAL, "rows of the tables", &check_rows_keys},
    {"holds", OBJECT | LIST | OPTIONAL, "holds of the test by the operator", &hold_keys},
};
WB_KEYS(wb_align_checks, "checks", "Findings of the alignment.");

/* --- corrections --- */

static const struct wb_key wb_align_correction_rows[] = {
    {"name", TEXT, "the correction",
     .choices = "filter delay|marker offset|tare|zero drift|strand lean|force at zero "
                "deflection|natural shape"},
    {"value_mN", NUMBER | UNKNOWN | OPTIONAL, "size of a correction of the force"},
    {"uncertainty_mN", NUMBER | UNKNOWN | OPTIONAL, "its standard uncertainty"},
    {"value_mm", NUMBER | UNKNOWN | OPTIONAL, "size of a correction of a length"},
    {"uncertainty_mm", NUMBER | UNKNOWN | OPTIONAL, "its standard uncertainty"},
    {"value_ms", NUMBER | UNKNOWN | OPTIONAL, "size of a correction of time"},
    {"uncertainty_ms", NUMBER | UNKNOWN | OPTIONAL, "its standard uncertainty"},
    {"note", TEXT, "what was done, and how the size was found"},
};
WB_KEYS(wb_align_correction, "correction",
        "A correction of the data; its size stands in the key of its unit.");

/* --- where the data come from --- */

static const struct wb_key difference_rows[] = {
    {"key", TEXT, "key of the file, as `load_cell.unit`"},
    {"recorded", TEXT, "value that was recorded"},
    {"given", TEXT, "value that holds in its place"},
};
static WB_KEYS(difference, "difference", "A key in which two files differ.");

static const struct wb_key correction_file_rows[] = {
    {"file", TEXT, "name of the file"},
    {"sha256", TEXT, "SHA-256 of the file"},
    {"differences", OBJECT | LIST, "keys in which it differs from the recorded file",
     &difference_keys},
};
static WB_KEYS(correction_file, "corrected_file",
               "A file that holds in place of the recorded one.");

static const struct wb_key corrected_rows[] = {
    {"rig", OBJECT | OPTIONAL, "rig file in place of the recorded one", &correction_file_keys},
    {"specimen", OBJECT | OPTIONAL, "specimen file in place of the recorded one",
     &correction_file_keys},
};
static WB_KEYS(corrected, "corrected", "Files that hold in place of recorded ones.");

static const struct wb_key recording_rows[] = {
    {"name", TEXT, "file name of the recording"},
    {"sha256", TEXT, "SHA-256 of the uncompressed recording"},
    {"start_utc", TEXT | OPTIONAL, "start of the test"},
    {"operator", TEXT | OPTIONAL, "operator"},
    {"notes", TEXT | OPTIONAL, "notes of the operator"},
    {"recorded_with_version", TEXT | OPTIONAL, "version of the program that recorded"},
    {"recorded_with_revision", TEXT | OPTIONAL, "revision of the program that recorded"},
    {"excluded", OBJECT | OPTIONAL, "exclusion of the test", &wb_common_excluded_keys},
    {"corrected", OBJECT | OPTIONAL, "files that hold in place of recorded ones", &corrected_keys},
};
static WB_KEYS(recording, "recording", "The recording of a dataset.");

static const struct wb_key settings_rows[] = {
    {"longest_gap_s", ALIGN(settings.longest_gap) | ROUNDED,
     "no row is made where force or shape is missing for longer"},
    {"row_rate_per_s", ALIGN(settings.row_rate) | ROUNDED, "rows per second of bench time"},
    {"shape_step_mm", ALIGN(settings.shape_step) | ROUNDED, "deflection between stored shapes"},
    {"lost_steps_mm", ALIGN(settings.lost_steps) | ROUNDED,
     "difference of commanded and measured travel from which the stage is flagged"},
};
static WB_KEYS(settings, "align_settings", "Settings of the alignment.");

static const struct wb_key specimen_rows[] = {
    {"wire", ALIGN(wire.name), "name of the product"},
    {"sample", ALIGN(specimen.sample), "number of the piece"},
    {"length_mm", ALIGN(specimen.length) | ROUNDED, "free length"},
    {"markers_mm", NUMBER | LIST, "arc lengths of the markers"},
    {"marker_offset_mm", ALIGN(specimen.marker_offset) | ROUNDED,
     "distance of the markers' centres from the axis"},
    {"marker_offset_uncertainty_mm", ALIGN(specimen.marker_offset_uncertainty) | ROUNDED,
     "standard uncertainty of that offset"},
    {"outer_diameter_mm", ALIGN(wire.outer_diameter) | ROUNDED, "outer diameter"},
    {"density_g_cm3", ALIGN(wire.density) | ROUNDED, "mean density over the outer diameter"},
};
static WB_KEYS(specimen, "specimen", "The specimen, as its files say.");

static const struct wb_key cell_rows[] = {
    {"protocol", ALIGN(rig.load_cell.protocol), "protocol of the load cell"},
    {"capacity_g", NUMBER, "nominal load"},
    {"serial_number", ALIGN(rig.load_cell.serial_number), "serial number; empty: not stated"},
    {"calibration_date", ALIGN(rig.load_cell.calibration_date),
     "date of its calibration; empty: not stated"},
    {"filter_delay_ms", ALIGN(rig.load_cell.filter_delay) | ROUNDED,
     "delay of the reading behind the force"},
    {"filter_delay_uncertainty_ms", ALIGN(rig.load_cell.filter_delay_uncertainty) | ROUNDED,
     "standard uncertainty of that delay"},
};
static WB_KEYS(cell, "rig_load_cell", "The load cell of the rig.");

static const struct wb_key mocap_rows[] = {
    {"protocol", ALIGN(rig.mocap.protocol), "protocol of the cameras"},
};
static WB_KEYS(mocap, "rig_mocap", "The cameras of the rig.");

static const struct wb_key rig_stage_rows[] = {
    {"protocol", ALIGN(rig.stage.protocol), "protocol of the stage"},
    {"speed_mm_s", ALIGN(rig.stage.speed) | ROUNDED, "speed during the test"},
};
static WB_KEYS(rig_stage, "rig_stage", "The stage of the rig.");

static const struct wb_key strand_rows[] = {
    {"length_mm", ALIGN(rig.strand.length) | ROUNDED, "length of the strand; 0: none"},
    {"counterweight_g", ALIGN(rig.strand.counterweight) | ROUNDED, "mass at the tip"},
};
static WB_KEYS(strand, "rig_strand", "The strand of the rig.");

static const struct wb_key rig_rows[] = {
    {"name", ALIGN(rig.name), "name of the rig"},
    {"virtual_rig", ALIGN(is_virtual), "the data come from a virtual rig"},
    {"time_scale", ALIGN(rig.time_scale) | ROUNDED,
     "factor by which the clocks of a virtual rig run faster"},
    {"gravity_m_s2", ALIGN(gravity) | ROUNDED, "local gravity"},
    {"load_cell", OBJECT, "load cell", &cell_keys},
    {"mocap", WB_HERE(struct wb_align), "cameras", &mocap_keys},
    {"stage", WB_HERE(struct wb_align), "stage", &rig_stage_keys},
    {"strand", WB_HERE(struct wb_align), "strand", &strand_keys},
};
static WB_KEYS(rig, "rig", "The rig, as its file says.");

static const struct wb_key wb_align_document_rows[] = {
    {"source", TEXT, "test on the bench, or on a virtual rig"},
    {"tool", OBJECT, "program that aligned the recording", &wb_common_tool_keys},
    {"settings", WB_HERE(struct wb_align), "settings of the alignment", &settings_keys},
    {"specimen", OBJECT, "the specimen", &specimen_keys},
    {"rig", OBJECT, "the rig", &rig_keys},
    {"corrections", OBJECT | LIST, "corrections in the order in which they were made",
     &wb_align_correction_keys},
    {"checks", OBJECT, "findings of the alignment", &wb_align_checks_keys},
    {"warnings", TEXT | LIST, "warnings"},
    {"recordings", OBJECT | LIST, "the recording", &recording_keys},
    {"cycles", INTEGER, "number of cycles"},
    {"largest_deflection_mm", NUMBER, "largest deflection"},
    {"complete", FLAG, "false: there are gaps, or the test was cut short"},
};
WB_KEYS(wb_align_document, "aligned_keys", "Keys of the dataset of a recording.");

static void describe_specimen(const struct wb_align *align, struct wb_json *document)
{
    struct wb_json *const object = wb_json_set_object(document, "specimen");
    WB_PUT(object, &specimen_keys, struct wb_align, align);
    struct wb_json *const markers = wb_json_set_array(object, "markers_mm");
    for (int i = 0; i < align->specimen.n_markers; i++)
        wb_json_append_number(markers, round(align->specimen.markers[i] / WB_MM * 1e6) / 1e6);
    WB_PUT(object, &specimen_keys, struct wb_align, align);
}

static void describe_rig(const struct wb_align *align, struct wb_json *document)
{
    struct wb_json *const object = wb_json_set_object(document, "rig");
    WB_PUT(object, &rig_keys, struct wb_align, align);
    struct wb_json *const of = wb_json_set_object(object, "load_cell");
    WB_PUT(of, &cell_keys, struct wb_align, align);
    wb_align_set(of, "capacity_g", align->rig.load_cell.capacity / WB_STANDARD_GRAVITY / WB_G);
    WB_PUT(of, &cell_keys, struct wb_align, align);
    WB_PUT(object, &rig_keys, struct wb_align, align);
}

void wb_align_describe(struct wb_align *align)
{
    struct wb_json *const document = align->dataset->document;
    wb_json_set_text(document, "name", align->name);
    wb_json_set_text(document, "source",
                     align->is_virtual ? "test on a virtual rig" : "test on the bench");
    wb_keys_put_tool(document, "wirebench align");
    WB_PUT(document, &wb_align_document_keys, struct wb_align, align);
    describe_specimen(align, document);
    describe_rig(align, document);
    align->corrections = wb_json_set_array(document, "corrections");
    align->checks = wb_json_set_object(document, "checks");
    align->warnings = wb_json_set_array(document, "warnings");
}
