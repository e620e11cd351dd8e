#include "analysis/dataset/test_piece.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/dataset/test_piece_private.h"
#include "base/circle.h"
#include "base/config.h"
#include "base/file.h"
#include "base/units.h"
#include "fe/model/wire.h"

#define WB_LOG_DOMAIN "specimen"

#define SQUARE_MM (WB_MM * WB_MM)
#define GRAM_PER_METRE 1e-3

static const char *const constituent_names[] = {"conductor", "jacket", "tape", NULL};

const char *wb_test_piece_constituent_name(enum wb_constituent constituent)
{
    return constituent_names[constituent];
}

static const struct wb_band unknown = {false, (double)NAN, (double)NAN, (double)NAN};

static void clear(struct wb_test_piece *piece)
{
    memset(piece, 0, sizeof *piece);
    piece->outer_diameter = piece->length = piece->area = (double)NAN;
    piece->usable_travel = piece->natural_bow = unknown;
}

/* Values of a file from which the piece is derived; NaN and 0: not given. */
struct said {
    const struct wb_config_node *usable, *bow;
    double area, strand_diameter, inner_diameter, width, thickness;
    int strands;
};

/* --- area --- */

static enum wb_status take_area(const struct wb_config_node *root, const struct said *said,
                                struct wb_test_piece *piece)
{
    const bool by_strands = said->strands > 0 || isfinite(said->strand_diameter);
    const bool by_jacket = isfinite(said->inner_diameter);
    const bool by_tape = isfinite(said->width) || isfinite(said->thickness);
    const int ways = isfinite(said->area) + by_strands + by_jacket + by_tape;
    if (ways != 1)
        return wb_config_refuse(
            root, NULL,
            "expected the area that carries the load in one way: area_mm2; strands and "
            "strand_diameter_mm; outer_diameter_mm and inner_diameter_mm; width_mm and "
            "thickness_mm");
    if (isfinite(said->area)) {
        piece->area = said->area;
        return WB_OK;
    }
    if (by_strands) {
        if (said->strands == 0 || !isfinite(said->strand_diameter))
            return wb_config_refuse(root, NULL, "expected strands and strand_diameter_mm together");
        piece->area = said->strands * wb_circle_area(said->strand_diameter);
        return WB_OK;
    }
    if (by_tape) {
        if (!isfinite(said->width) || !isfinite(said->thickness))
            return wb_config_refuse(root, NULL, "expected width_mm and thickness_mm together");
        piece->area = said->width * said->thickness;
        return WB_OK;
    }
    if (!(piece->outer_diameter > said->inner_diameter))
        return wb_config_refuse(root, "inner_diameter_mm",
                                "expected less than outer_diameter_mm, which is %s",
                                isfinite(piece->outer_diameter) ? "no larger" : "missing");
    piece->area = wb_circle_area(piece->outer_diameter) - wb_circle_area(said->inner_diameter);
    return WB_OK;
}

/* --- the file --- */

/* Takes values that the specimen's file does not give from the wire's file. */
static enum wb_status take_wire(const struct wb_config_node *root, struct wb_test_piece *piece,
                                struct wb_reason *why)
{
    char path[WB_PATH], folder[WB_PATH], named_in[WB_PATH + 32];
    struct wb_wire wire;
    wb_file_folder(folder, wb_config_origin(root));
    snprintf(named_in, sizeof named_in, "%s:%d: wire", wb_config_origin(root),
             wb_config_line(wb_config_find(root, "wire")));
    WB_TRY(wb_file_find_named(path, "wires", piece->wire, folder, named_in, why));
    WB_TRY(wb_wire_read(path, &wire, why));
    snprintf(piece->wire, sizeof piece->wire, "%s", wire.name);
    piece->outer_diameter = wire.outer_diameter;
    piece->poissons_ratio = wire.has_properties ? wire.material.poissons_ratio : 0.0;
    if (piece->mass_per_length == 0.0)
        piece->mass_per_length = wb_wire_mass_per_length(&wire);
    return WB_OK;
}

static enum wb_status check_kind(const struct wb_config_node *root, const struct said *said,
                                 enum wb_test_kind kind, struct wb_test_piece *piece)
{
    static const char *const tensile_only[] = {
        "area_mm2",     "strands", "strand_diameter_mm", "inner_diameter_mm", "width_mm",
        "thickness_mm", NULL,
    };
    if (kind == WB_TEST_CANTILEVER && !isfinite(piece->length))
        return wb_config_refuse(root, "length_mm", "this key is missing for a cantilever test");
    if (kind == WB_TEST_TENSILE) {
        if (!wb_config_find(root, "constituent"))
            return wb_config_refuse(root, "constituent",
                                    "this key is missing for a tensile test: conductor, jacket or "
                                    "tape");
        return take_area(root, said, piece);
    }
    return wb_config_refuse_keys(root, tensile_only, "only a tensile test has this");
}

/* Context of read_root(). */
struct request {
    enum wb_test_kind kind;
    struct wb_test_piece *piece;
    struct wb_reason *why;
};

static enum wb_status read_root(const struct wb_config_node *root, void *into)
{
    const struct request *const request = into;
    const enum wb_test_kind kind = request->kind;
    struct wb_test_piece read, *const piece = &read;
    const double none = (double)NAN;
    struct said said = {NULL, NULL, none, none, none, none, none, 0};
    const struct wb_config_key usable =
        WB_CONFIG_NUMBER("usable_travel_mm", NULL, WB_MM, 1e-6, 1e5);
    const struct wb_config_key bow = WB_CONFIG_NUMBER("natural_bow_mm", NULL, WB_MM, -1e5, 1e5);
    const struct wb_config_key table[] = {
        WB_CONFIG_TEXT("wire", piece->wire),
        WB_CONFIG_INTEGER("sample", &piece->sample, 1, 100000),
        WB_CONFIG_OPTIONAL_TEXT("series", piece->series),
        WB_CONFIG_OPTIONAL_NUMBER("outer_diameter_mm", &piece->outer_diameter, WB_MM, 0.001, 1000),
        WB_CONFIG_OPTIONAL_NUMBER("length_mm", &piece->length, WB_MM, 0.1, 100000.0),
        WB_CONFIG_OPTIONAL_NUMBER("mass_per_length_g_m", &piece->mass_per_length, GRAM_PER_METRE,
                                  1e-6, 1e6),
        WB_CONFIG_OPTIONAL_NODE("usable_travel_mm", &said.usable),
        WB_CONFIG_OPTIONAL_NODE("natural_bow_mm", &said.bow),
        WB_CONFIG_OPTIONAL_CHOICE("constituent", &piece->constituent, constituent_names),
        WB_CONFIG_OPTIONAL_NUMBER("area_mm2", &said.area, SQUARE_MM, 1e-9, 1e6),
        WB_CONFIG_OPTIONAL_INTEGER("strands", &said.strands, 1, 100000),
        WB_CONFIG_OPTIONAL_NUMBER("strand_diameter_mm", &said.strand_diameter, WB_MM, 1e-4, 1000),
        WB_CONFIG_OPTIONAL_NUMBER("inner_diameter_mm", &said.inner_diameter, WB_MM, 1e-4, 1000),
        WB_CONFIG_OPTIONAL_NUMBER("width_mm", &said.width, WB_MM, 1e-4, 1e5),
        WB_CONFIG_OPTIONAL_NUMBER("thickness_mm", &said.thickness, WB_MM, 1e-5, 1e4),
        WB_CONFIG_IGNORED("u_length_mm"),
        WB_CONFIG_IGNORED("markers_mm"),
        WB_CONFIG_IGNORED("marker_offset_mm"),
        WB_CONFIG_IGNORED("marker_offset_uncertainty_mm"),
    };
    clear(piece);
    WB_TRY(wb_config_map(root, table, WB_COUNT(table)));
    if (piece->wire[0] == '\0')
        return wb_config_refuse(root, "wire", "expected the name of the product");
    if (said.usable)
        WB_TRY(wb_machine_read_band(said.usable, &usable, &piece->usable_travel));
    if (said.bow && kind != WB_TEST_THREE_POINT)
        return wb_config_refuse(root, "natural_bow_mm",
                                "only specimens of three-point bending have one");
    if (said.bow)
        WB_TRY(wb_machine_read_band(said.bow, &bow, &piece->natural_bow));
    WB_TRY(check_kind(root, &said, kind, piece));
    if (kind != WB_TEST_TENSILE && !isfinite(piece->outer_diameter))
        WB_TRY(take_wire(root, piece, request->why));
    *request->piece = read;
    return WB_OK;
}

enum wb_status wb_test_piece_read(const char *path, enum wb_test_kind kind,
                                  struct wb_test_piece *piece, struct wb_reason *why)
{
    return wb_config_load(NULL, path, why, read_root, &(struct request){kind, piece, why});
}

enum wb_status wb_test_piece_parse(const char *text, const char *origin, enum wb_test_kind kind,
                                   struct wb_test_piece *piece, struct wb_reason *why)
{
    return wb_config_load(text, origin, why, read_root, &(struct request){kind, piece, why});
}

/* --- the document of a dataset --- */

static double rounded(double value)
{
    char text[40];
    snprintf(text, sizeof text, "%.15g", value);
    return strtod(text, NULL);
}

static void set(struct wb_json *object, const char *key, double value, double unit)
{
    if (isfinite(value))
        wb_json_set_number(object, key, rounded(value / unit));
}

static void set_band(struct wb_json *object, const char *key, const struct wb_band *band)
{
    if (!band->known)
        return;
    struct wb_json *const list = wb_json_set_array(object, key);
    wb_json_append_number(list, rounded(band->least / WB_MM));
    wb_json_append_number(list, rounded(band->most / WB_MM));
}

void wb_test_piece_set_json(const struct wb_test_piece *piece, struct wb_json *object)
{
    if (piece->series[0])
        wb_json_set_text(object, "series", piece->series);
    set(object, "outer_diameter_mm", piece->outer_diameter, WB_MM);
    set(object, "length_mm", piece->length, WB_MM);
    set(object, "mass_per_length_g_m",
        piece->mass_per_length > 0.0 ? piece->mass_per_length : (double)NAN, GRAM_PER_METRE);
    set_band(object, "usable_travel_mm", &piece->usable_travel);
    set_band(object, "natural_bow_mm", &piece->natural_bow);
    if (isfinite(piece->area)) {
        wb_json_set_text(object, "constituent", wb_test_piece_constituent_name(piece->constituent));
        set(object, "area_mm2", piece->area, SQUARE_MM);
    }
}

/* Reads an optional positive number. */
static bool get(const struct wb_json *object, const char *key, double unit, double *value)
{
    double read;
    if (!wb_json_get(object, key))
        return true;
    if (!wb_json_get_number(object, key, &read) || !(read > 0.0))
        return false;
    *value = read * unit;
    return true;
}

/* Reads an optional list of two numbers above `limit`. */
static bool get_band(const struct wb_json *object, const char *key, double limit,
                     struct wb_band *band)
{
    const struct wb_json *const list = wb_json_get(object, key);
    double least, most;
    if (!list)
        return true;
    if (wb_json_length(list) != 2 || !wb_json_number(wb_json_item(list, 0), &least) ||
        !wb_json_number(wb_json_item(list, 1), &most) || !(least > limit) || !(most >= least))
        return false;
    least *= WB_MM;
    most *= WB_MM;
    *band = (struct wb_band){true, least == most ? least : 0.5 * (least + most), least, most};
    return true;
}

static bool get_constituent(const struct wb_json *object, struct wb_test_piece *piece)
{
    const char *name;
    int index;
    if (!isfinite(piece->area))
        return true;
    if (!wb_json_get_text(object, "constituent", &name) ||
        !wb_machine_find_name(constituent_names, name, &index))
        return false;
    piece->constituent = (enum wb_constituent)index;
    return true;
}

enum wb_status wb_test_piece_get_json(struct wb_test_piece *piece, const struct wb_json *object,
                                      const char *path, struct wb_reason *why)
{
    struct wb_test_piece read;
    const char *series = "", *wrong = NULL;
    clear(&read);
    if (!object)
        wrong = "this object is missing";
    else if (wb_json_get(object, "series") &&
             (!wb_json_get_text(object, "series", &series) || strlen(series) >= sizeof read.series))
        wrong = "series: expected a short text";
    else if (!get(object, "outer_diameter_mm", WB_MM, &read.outer_diameter))
        wrong = "outer_diameter_mm: expected a positive number";
    else if (!get(object, "length_mm", WB_MM, &read.length))
        wrong = "length_mm: expected a positive number";
    else if (!get(object, "mass_per_length_g_m", GRAM_PER_METRE, &read.mass_per_length))
        wrong = "mass_per_length_g_m: expected a positive number";
    else if (!get_band(object, "usable_travel_mm", 0.0, &read.usable_travel))
        wrong = "usable_travel_mm: expected a list of two positive numbers, the least first";
    else if (!get_band(object, "natural_bow_mm", -HUGE_VAL, &read.natural_bow))
        wrong = "natural_bow_mm: expected a list of two numbers, the least first";
    else if (!get(object, "area_mm2", SQUARE_MM, &read.area))
        wrong = "area_mm2: expected a positive number";
    else if (!get_constituent(object, &read))
        wrong = "constituent: expected conductor, jacket or tape";
    if (wrong)
        return wb_fail_to(why, WB_ERR_FORMAT, "%s: test_piece: %s", path, wrong);
    strcpy(read.series, series);
    *piece = read;
    return WB_OK;
}
