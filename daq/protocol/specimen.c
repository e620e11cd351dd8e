#include "daq/protocol/specimen.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/config.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "specimen"

/* Checks that the markers ascend from the clamp to the knot. */
static enum wb_status check_markers(const struct wb_config_node *list, struct wb_specimen *specimen)
{
    const double *const markers = specimen->markers;
    const int n = specimen->n_markers;
    if (markers[0] != 0.0)
        return wb_config_refuse(list, "markers_mm",
                                "expected 0 first (the marker on the clamp), not %g",
                                markers[0] / WB_MM);
    for (int i = 1; i < n; i++)
        if (!(markers[i] > markers[i - 1]))
            return wb_config_refuse(list, "markers_mm",
                                    "expected ascending arc lengths, but %g follows %g",
                                    markers[i] / WB_MM, markers[i - 1] / WB_MM);
    if (!(fabs(markers[n - 1] - specimen->length) <= 1e-9))
        return wb_config_refuse(list, "markers_mm",
                                "expected the last marker at the strand's knot, length_mm (%g), "
                                "not at %g",
                                specimen->length / WB_MM, markers[n - 1] / WB_MM);
    return WB_OK;
}

static enum wb_status read_root(const struct wb_config_node *root, void *into)
{
    const struct wb_config_node *markers;
    struct wb_specimen read = {.wire = ""}, *const specimen = &read;
    const struct wb_config_key table[] = {
        WB_CONFIG_TEXT("wire", specimen->wire),
        WB_CONFIG_NUMBER("length_mm", &specimen->length, WB_MM, 1.0, 10000.0),
        WB_CONFIG_OPTIONAL_NUMBER("u_length_mm", &specimen->length_uncertainty, WB_MM, 1e-4,
                                  1000.0),
        WB_CONFIG_INTEGER("sample", &specimen->sample, 1, 100000),
        WB_CONFIG_NODE("markers_mm", &markers),
        WB_CONFIG_NUMBER("marker_offset_mm", &specimen->marker_offset, WB_MM, -100.0, 100.0),
        WB_CONFIG_OPTIONAL_NUMBER("marker_offset_uncertainty_mm",
                                  &specimen->marker_offset_uncertainty, WB_MM, 0.0, 100.0),
    };
    WB_TRY(wb_config_map(root, table, WB_COUNT(table)));
    if (specimen->wire[0] == '\0')
        return wb_config_refuse(root, "wire",
                                "expected the name of a wire, such as type1, or a path");
    specimen->wire_line = wb_config_line(wb_config_find(root, "wire"));
    const struct wb_config_key marker = WB_CONFIG_NUMBER("markers_mm", NULL, WB_MM, 0.0, 10000.0);
    WB_TRY(wb_config_numbers(markers, &marker, 2, WB_SPECIMEN_MAX_MARKERS, specimen->markers,
                             &specimen->n_markers));
    WB_TRY(check_markers(markers, specimen));
    *(struct wb_specimen *)into = read;
    return WB_OK;
}

enum wb_status wb_specimen_read(const char *path, struct wb_specimen *specimen)
{
    return wb_config_load(NULL, path, NULL, read_root, specimen);
}

enum wb_status wb_specimen_parse(const char *text, const char *origin, struct wb_specimen *specimen,
                                 struct wb_reason *why)
{
    return wb_config_load(text, origin, why, read_root, specimen);
}

enum wb_status wb_specimen_find_wire(const struct wb_specimen *specimen, const char *specimen_path,
                                     char path[WB_PATH])
{
    char folder[WB_PATH], named_in[WB_PATH + 32];
    wb_file_folder(folder, specimen_path);
    snprintf(named_in, sizeof named_in, "%s:%d: wire", specimen_path, specimen->wire_line);
    return wb_file_find_named(path, "wires", specimen->wire, folder, named_in, NULL);
}
