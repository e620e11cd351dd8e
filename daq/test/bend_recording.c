#include "daq/test/bend_recording.h"
#include "daq/test/bend_recording_private.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/number.h"
#include "base/timing.h"
#include "base/units.h"
#include "base/version.h"
#include "daq/test/check_log.h"

#define WB_LOG_DOMAIN "record"

char *wb_bend_recording_yaml_part(const char *yaml, const char *key)
{
    const size_t n_key = strlen(key);
    const char *begin = yaml;
    while (*begin && !(strncmp(begin, key, n_key) == 0 && begin[n_key] == ':')) {
        begin = strchr(begin, '\n');
        if (!begin)
            return strdup("");
        begin++;
    }
    /* The block ends at the next unindented line that is not a comment. */
    const char *end = begin;
    do {
        end = strchr(end, '\n');
        end = end ? end + 1 : begin + strlen(begin);
    } while (*end == ' ' || *end == '\n' || *end == '#' || *end == '\t' || *end == '\r');
    return strndup(begin, (size_t)(end - begin));
}

/* Stores the text, or that of the file if it is NULL. */
static enum wb_status set_text(struct wb_recording *recording, const char *key, const char *given,
                               const char *path)
{
    char *text = NULL;
    if (!given)
        WB_TRY(wb_file_read(path, &text, NULL));
    const enum wb_status status = wb_recording_set_meta(recording, key, given ? given : text);
    free(text);
    return status;
}

static enum wb_status set_wire(struct wb_recording *recording,
                               const struct wb_bend_recording *description)
{
    char path[WB_PATH];
    WB_TRY(wb_specimen_find_wire(description->specimen, description->specimen_path, path));
    return set_text(recording, "wire", NULL, path);
}

static enum wb_status set_truth(struct wb_recording *recording,
                                const struct wb_bend_recording *description)
{
    if (!description->rig->is_virtual)
        return WB_OK;
    char *text = NULL;
    WB_TRY(wb_recording_set_meta(recording, "virtual", "true"));
    if (!description->rig_text)
        WB_TRY(wb_file_read(description->rig_path, &text, NULL));
    char *const truth = wb_bend_recording_yaml_part(text ? text : description->rig_text, "truth");
    free(text);
    if (!truth)
        return wb_fail(WB_ERR_MEMORY, "out of memory for the true values of the virtual rig");
    const enum wb_status status = wb_recording_set_meta(recording, "truth", truth);
    free(truth);
    return status;
}

static enum wb_status set_number(struct wb_recording *recording, const char *key, double value)
{
    char text[WB_NUMBER_TEXT];
    return wb_recording_set_meta(recording, key, wb_number_format(value, text));
}

static enum wb_status set_circumstances(struct wb_recording *recording,
                                        const struct wb_bend_recording *description)
{
    char text[256];
    wb_time_format(wb_time_utc(), text);
    /* The files of an imported test do not contain its date. */
    WB_TRY(wb_recording_set_meta(recording, description->imported ? "imported_utc" : "start_utc",
                                 text));
    snprintf(text, sizeof text, "%" PRId64, description->monotonic_start_ns);
    WB_TRY(wb_recording_set_meta(recording, "monotonic_start_ns", text));
    if (gethostname(text, sizeof text) != 0)
        strcpy(text, "unknown");
    text[sizeof text - 1] = '\0';
    return wb_recording_set_meta(recording, "host", text);
}

/* Stores the last check of the load cell, if the rig file has a log of checks. */
static enum wb_status set_check(struct wb_recording *recording,
                                const struct wb_bend_recording *description)
{
    char line[WB_CHECK_LOG_LINE];
    struct wb_check_log_entry check;
    const char *const serial = description->rig->load_cell.serial_number;
    wb_check_log_last(description->rig_path, line);
    if (!wb_check_log_parse(line, &check))
        return WB_OK;
    if (!check.passed)
        wb_warn(
            "the last check of the load cell, on %s, failed: calibrate the cell or check it again",
            check.utc);
    if (strcmp(check.serial_number, serial) != 0)
        wb_warn(
            "the last check was made with load cell '%s', but the rig file has '%s': check again",
            check.serial_number, serial);
    return wb_recording_set_meta(recording, "load_cell_check", line);
}

static enum wb_status set_meta(struct wb_recording *recording, const struct wb_bend_recording *d)
{
    char text[32];
    snprintf(text, sizeof text, "%d", WB_RECORDING_SCHEMA);
    WB_TRY(wb_recording_set_meta(recording, "schema", text));
    WB_TRY(wb_recording_set_meta(recording, "tool_version", wb_version()));
    WB_TRY(wb_recording_set_meta(recording, "tool_revision", wb_version_revision()));
    WB_TRY(set_circumstances(recording, d));
    WB_TRY(wb_recording_set_meta(recording, "operator", d->operator_name ? d->operator_name : ""));
    WB_TRY(wb_recording_set_meta(recording, "notes", d->notes ? d->notes : ""));
    WB_TRY(set_text(recording, "rig", d->rig_text, d->rig_path));
    WB_TRY(set_text(recording, "specimen", d->specimen_text, d->specimen_path));
    WB_TRY(set_wire(recording, d));
    WB_TRY(set_truth(recording, d));
    if (!d->rig_text)
        WB_TRY(set_check(recording, d));
    WB_TRY(set_number(recording, "g", d->rig->gravity));
    if (d->imported)
        return WB_OK;
    WB_TRY(set_number(recording, "travel_mm", d->travel / WB_MM));
    WB_TRY(set_number(recording, "dwell_s", d->dwell));
    WB_TRY(wb_recording_set_meta(recording, "speeds_mm_s", d->speeds));
    snprintf(text, sizeof text, "%d", d->cycles);
    return wb_recording_set_meta(recording, "cycles", text);
}

static enum wb_status add_streams(struct wb_recording *recording, const struct wb_rig *rig)
{
    int id;
    WB_TRY(wb_recording_add_stream(recording, WB_ROLE_LOAD, rig->load_cell.address,
                                   rig->load_cell.protocol, "", &id));
    WB_TRY(wb_recording_add_stream(recording, WB_ROLE_MOCAP, rig->mocap.address,
                                   rig->mocap.protocol, "", &id));
    return wb_recording_add_stream(recording, WB_ROLE_STAGE, rig->stage.address,
                                   rig->stage.protocol, "", &id);
}

enum wb_status wb_bend_recording_create(struct wb_recording **out,
                                        const struct wb_bend_recording *description)
{
    struct wb_recording *recording;
    WB_TRY(wb_recording_create(&recording, description->path));
    enum wb_status status = set_meta(recording, description);
    if (status == WB_OK && !description->imported)
        status = add_streams(recording, description->rig);
    if (status == WB_OK)
        status = wb_recording_flush(recording);
    if (status != WB_OK) {
        /* The error is already logged. An incomplete file must not block the next attempt. */
        if (wb_recording_close(recording) != WB_OK)
            wb_debug("the incomplete recording could not be closed cleanly");
        unlink(description->path);
        return status;
    }
    *out = recording;
    return WB_OK;
}
