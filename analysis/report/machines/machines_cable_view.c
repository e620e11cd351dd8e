/* A cable and its layers in a report: figures, a chapter, numbers. */
#include "analysis/report/machines/machines_kind.h"

#include <math.h>

#include "analysis/keys/common.h"
#include "analysis/keys/row.h"
#include "analysis/report/numbers.h"
#include "analysis/report/pages.h"
#include "analysis/report/pdf.h"
#include "base/units.h"

/* The curvatures that a table shows: these parts of the largest. */
static const int shown[] = {4, 9, 14, 19};

static const struct wb_machines_group *group_of(const struct wb_machines_results *results,
                                                const struct wb_machines_layer *layer)
{
    return &results->campaign->groups[layer->group];
}

/* --- figures --- */

int wb_machines_cable_count(const void *context)
{
    const struct wb_machines_results *const results = context;
    return results->cable.n_layers;
}

static void add_moments(struct wb_panel *panel, const struct wb_machines_layer *layer)
{
    const struct wb_figure_style measured = {wb_palette_ink(), 1.4, WB_DASH_SOLID, WB_MARKER_CIRCLE,
                                             3.0};
    const struct wb_figure_style free = {wb_palette_wire(0), 1.2, WB_DASH_DASHED, WB_MARKER_NONE,
                                         0.0};
    const struct wb_figure_style bonded = {wb_palette_wire(1), 1.2, WB_DASH_MIXED, WB_MARKER_NONE,
                                           0.0};
    double m[3][WB_MACHINES_PLACES];
    for (int k = 0; k < WB_MACHINES_PLACES; k++) {
        m[0][k] = layer->place[k].measured / WB_NMM;
        m[1][k] = layer->place[k].free / WB_NMM;
        m[2][k] = layer->place[k].bonded / WB_NMM;
    }
    wb_figure_set_axes(panel, "Nominal curvature 12 d / L<sup>2</sup> (1/m)",
                       "Moment F L / 4 (N mm)");
    wb_figure_set_logarithmic_y(panel);
    wb_figure_add_line(panel, "bonded", WB_MACHINES_PLACES, layer->curvature, m[2], &bonded);
    wb_figure_add_line(panel, "measured", WB_MACHINES_PLACES, layer->curvature, m[0], &measured);
    wb_figure_add_line(panel, "sliding freely", WB_MACHINES_PLACES, layer->curvature, m[1], &free);
}

static void add_chi(struct wb_panel *panel, const struct wb_machines_results *results,
                    const struct wb_machines_layer *layer)
{
    const struct wb_machines_cable *const cable = &results->campaign->cable;
    const struct wb_figure_style style = {wb_palette_ink(), 1.4, WB_DASH_SOLID, WB_MARKER_CIRCLE,
                                          3.0};
    double chi[WB_MACHINES_PLACES], low[WB_MACHINES_PLACES], high[WB_MACHINES_PLACES];
    int n_known = 0;
    for (int k = 0; k < WB_MACHINES_PLACES; k++) {
        chi[k] = layer->place[k].chi.value;
        low[k] = layer->place[k].chi.low;
        high[k] = layer->place[k].chi.high;
        n_known += isfinite(low[k]);
    }
    const double *const edges[2] = {low, high};
    wb_figure_set_axes(panel, "Nominal curvature (1/m)", "\xcf\x87: 0 sliding, 1 bonded");
    if (n_known == WB_MACHINES_PLACES)
        wb_figure_add_band(panel, "95 %, tests and series", WB_MACHINES_PLACES, layer->curvature,
                           edges, wb_palette_fade(wb_palette_grey(), 0.25));
    wb_figure_add_line(panel, "mean", WB_MACHINES_PLACES, layer->curvature, chi, &style);
    for (int s = 0; s < cable->n_wires && cable->n_wires > 1; s++) {
        const struct wb_figure_style alone = {wb_palette_wire(2 + s), 1.0,
                                              s % 2 ? WB_DASH_DOTTED : WB_DASH_DASHED,
                                              WB_MARKER_NONE, 0.0};
        char label[100];
        snprintf(label, sizeof label, "wires of group %.60s",
                 results->campaign->groups[cable->wires[s]].name);
        wb_figure_add_line(panel, label, WB_MACHINES_PLACES, layer->curvature,
                           layer->chi_of_series[s], &alone);
    }
}

enum wb_status wb_machines_cable_draw(struct wb_figures_item *item)
{
    const struct wb_machines_results *const results = item->results;
    const struct wb_machines_layer *const layer = &results->cable.layers[item->index];
    char name[32], group[400], label[1000];
    if (layer->n == 0)
        return WB_OK;
    snprintf(name, sizeof name, "layer-%d", item->index + 1);
    WB_TRY(wb_figure_create(&item->figure, name, WB_PDF_WIDTH, 210.0));
    wb_figure_set_footer(item->figure, "measured");
    add_moments(wb_figure_add_panel(item->figure), layer);
    add_chi(wb_figure_add_panel(item->figure), results, layer);
    wb_text_append(&item->caption,
                   "Group %s, %s: mean of %d tests with both bounds, and its place "
                   "<i>\xcf\x87</i> between them.",
                   wb_pages_escape(group, sizeof group, group_of(results, layer)->name),
                   wb_pages_escape(label, sizeof label, group_of(results, layer)->label), layer->n);
    return WB_OK;
}

/* --- pages --- */

static void put_range(struct wb_document_table *table, const struct wb_cable_interval *interval,
                      int decimals)
{
    if (isfinite(interval->low))
        wb_pages_cell_range(table, WB_TONE_PLAIN, interval->low, interval->high, decimals);
    else
        wb_pages_cell(table, WB_TONE_QUIET, "not known");
}

static void put_ends(struct wb_document_table *table, const double values[][WB_MACHINES_PLACES],
                     int n, int k)
{
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (int i = 0; i < n; i++) {
        low = fmin(low, values[i][k]);
        high = fmax(high, values[i][k]);
    }
    wb_pages_cell_range(table, WB_TONE_PLAIN, low, high, 2);
}

/* Begins a row where the layer has one, with the group's name and the curvature. */
static void begin_row(struct wb_document_table *table, const struct wb_machines_results *results,
                      const struct wb_machines_layer *layer, size_t row)
{
    const int k = shown[row];
    wb_document_row(table, row == 0);
    wb_pages_cell_plain(table, WB_TONE_PLAIN, row == 0 ? group_of(results, layer)->name : "");
    wb_pages_cell(table, layer->is_seating[k] ? WB_TONE_QUIET : WB_TONE_PLAIN, "%.1f",
                  layer->curvature[k]);
}

static void put_moments(struct wb_document *document, const struct wb_machines_results *results)
{
    static const struct wb_document_column columns[] = {
        {"Group", .right = false},
        {"<i>\xce\xba</i> (1/m)", .right = true},
        {"<i>M</i> (N mm)", .right = true},
        {"Sliding", .right = true},
        {"Bonded", .right = true},
        {"<i>M</i> over sliding", .right = true, .wraps = true},
        {"95 %", .right = true},
        {"<i>M</i> over first group", .right = true, .wraps = true},
    };
    struct wb_document_table *const table = wb_document_table(
        document,
        "Groups at equal curvature: moment, bounds, and the moment over that of sliding wires and "
        "over that of the first group. Curvatures in grey: the wires are bent by less than 0.01 of "
        "their span, where their seating governs the force.",
        (int)WB_COUNT(columns), columns);
    for (int i = 0; i < results->cable.n_layers; i++) {
        const struct wb_machines_layer *const layer = &results->cable.layers[i];
        for (size_t row = 0; row < WB_COUNT(shown) && layer->n > 0; row++) {
            const struct wb_cable_place *const place = &layer->place[shown[row]];
            begin_row(table, results, layer, row);
            wb_pages_cell_number(table, place->measured / WB_NMM, 2);
            wb_pages_cell_number(table, place->free / WB_NMM, 2);
            wb_pages_cell_number(table, place->bonded / WB_NMM, 2);
            wb_pages_cell_number(table, place->ratio.value, 2);
            put_range(table, &place->ratio, 1);
            wb_pages_cell_number(table, layer->over_first[shown[row]], 2);
        }
    }
}

static void put_places(struct wb_document *document, const struct wb_machines_results *results)
{
    static const struct wb_document_column columns[] = {
        {"Group", .right = false},           {"<i>\xce\xba</i> (1/m)", .right = true},
        {"<i>\xcf\x87</i>", .right = true},  {"95 %", .right = true},
        {"One series alone", .right = true}, {"Zero halved, doubled", .right = true},
    };
    struct wb_document_table *const table = wb_document_table(
        document,
        "<i>\xcf\x87</i> = (<i>M</i> \xe2\x88\x92 <i>M</i><sub>sliding</sub>) / "
        "(<i>M</i><sub>bonded</sub> \xe2\x88\x92 <i>M</i><sub>sliding</sub>): 0 where the wires "
        "slide freely, 1 where they are bonded; with its interval over tests and series, with the "
        "wires of one series alone, and with half and twice the force at which a test begins.",
        (int)WB_COUNT(columns), columns);
    for (int i = 0; i < results->cable.n_layers; i++) {
        const struct wb_machines_layer *const layer = &results->cable.layers[i];
        for (size_t row = 0; row < WB_COUNT(shown) && layer->n > 0; row++) {
            const int k = shown[row];
            begin_row(table, results, layer, row);
            wb_pages_cell_number(table, layer->place[k].chi.value, 2);
            put_range(table, &layer->place[k].chi, 2);
            put_ends(table, layer->chi_of_series, results->campaign->cable.n_wires, k);
            put_ends(table, layer->chi_of_zero, WB_MACHINES_ZEROS, k);
        }
    }
}

static void put_method(struct wb_document *document, const struct wb_machines_cable *cable)
{
    struct wb_text text = {0};
    wb_text_append(&text,
                   "Tests at other spans are compared at equal curvature 12 <i>d</i> / "
                   "<i>L</i><sup>2</sup>. <b>Sliding freely</b>: <i>F</i>(<i>d</i>) = "
                   "(<i>L</i><sub>1</sub>/<i>L</i>)(%d <i>F</i><sub>1</sub> + "
                   "<i>F</i><sub>c</sub>) at the deflection <i>d</i> "
                   "<i>L</i><sub>1</sub><sup>2</sup>/<i>L</i><sup>2</sup> of wires and core. "
                   "<b>Bonded</b>: in addition, the axial forces of the conductors in a plane "
                   "section, %.4g mm<sup>2</sup> of <tt>",
                   cable->ring.n_wires, cable->ring.area / (WB_MM * WB_MM));
    wb_text_append_escaped(&text, cable->conductor);
    wb_text_append(
        &text,
        "</tt> each on a circle of %.3g mm radius; insulations, lay and what is wound "
        "round the wires are left out of both bounds. <i>\xcf\x87</i> of a group with more "
        "layers than the wires therefore includes the moment of those layers, and may "
        "exceed 1.",
        cable->ring.radius / WB_MM);
    wb_pages_put_text(document, WB_BLOCK_PARAGRAPH, WB_TONE_PLAIN, &text);
}

void wb_machines_cable_put(struct wb_document *document, const struct wb_machines_results *results,
                           const struct wb_figures *drawn)
{
    if (results->cable.n_layers == 0)
        return;
    wb_document_heading(document, 1, "cable", "Between sliding and bonded wires");
    put_method(document, &results->campaign->cable);
    put_moments(document, results);
    put_places(document, results);
    for (int i = 0; i < results->cable.n_layers; i++)
        wb_figures_put(drawn, document, "layer", i);
}

/* --- numbers --- */

#define INTERVAL(member) WB_AT(struct wb_cable_interval, member)
#define PLACE(member) WB_AT(struct wb_cable_place, member)
#define RING(member) WB_AT(struct wb_cable_ring, member)

static const struct wb_key interval_rows[] = {
    {"value", INTERVAL(value) | UNKNOWN, "value"},
    {"low_95", INTERVAL(low) | UNKNOWN, "lower end of its 95 % confidence interval"},
    {"high_95", INTERVAL(high) | UNKNOWN, "upper end of that interval"},
};
static WB_KEYS(interval, "interval", "A value and its interval.");

static const struct wb_key layer_place_rows[] = {
    {"curvature_1_m", NUMBER | UNKNOWN, "curvature"},
    {"seating", FLAG, "the deflection is so small that the seating of the wire decides"},
    {"measured_Nmm", PLACE(measured) | UNKNOWN, "measured moment"},
    {"free_Nmm", PLACE(free) | UNKNOWN, "moment of wires that slide freely"},
    {"bonded_Nmm", PLACE(bonded) | UNKNOWN, "moment of bonded wires"},
    {"over_first_layer", NUMBER | UNKNOWN, "measured moment over that of the first layer"},
    {"measured_over_free", PLACE(ratio), "measured moment over that of free wires", &interval_keys},
    {"chi", PLACE(chi), "place between free (0) and bonded (1) wires", &interval_keys},
    {"chi_of_each_series", NUMBER | LIST | UNKNOWN, "chi with the wires of each series alone"},
    {"chi_of_half_and_twice_the_zero", NUMBER | LIST | UNKNOWN,
     "chi with half and twice the force that marks the first contact"},
};
static WB_KEYS(layer_place, "layer_place", "A layer at one curvature.");

static const struct wb_key layer_rows[] = {
    {"group", TEXT, "group of the layer"},
    {"tests", WB_AT(struct wb_machines_layer, n), "number of tests"},
    {"places", OBJECT | LIST, "curvatures", &layer_place_keys},
};
static WB_KEYS(layer, "cable_layer", "A layer of the cable.");

static const struct wb_key wb_machines_cable_rows[] = {
    {"wire_count", RING(n_wires), "wires round the core"},
    {"wire_circle_radius_mm", RING(radius), "radius of the circle of their centres"},
    {"conductor_area_mm2", RING(area), "area of the metal in one wire"},
    {"conductor", OBJECT, "law of the conductor", &wb_law_ludwik_keys},
    {"layers", OBJECT | LIST, "layers", &layer_keys},
};
WB_KEYS(wb_machines_cable, "cable", "A layered cable.");

static void put_place(struct wb_json *list, const struct wb_machines_layer *layer, int n_series,
                      int k)
{
    struct wb_json *const entry = wb_json_append_object(list);
    wb_json_set_number(entry, "curvature_1_m", layer->curvature[k]);
    wb_json_set_boolean(entry, "seating", layer->is_seating[k]);
    WB_PUT(entry, &layer_place_keys, struct wb_cable_place, &layer->place[k]);
    wb_json_set_number(entry, "over_first_layer", layer->over_first[k]);
    WB_PUT(entry, &layer_place_keys, struct wb_cable_place, &layer->place[k]);
    struct wb_json *const series = wb_json_set_array(entry, "chi_of_each_series");
    for (int s = 0; s < n_series; s++)
        wb_json_append_number(series, layer->chi_of_series[s][k]);
    struct wb_json *const zeros = wb_json_set_array(entry, "chi_of_half_and_twice_the_zero");
    for (int z = 0; z < WB_MACHINES_ZEROS; z++)
        wb_json_append_number(zeros, layer->chi_of_zero[z][k]);
}

void wb_machines_cable_put_json(struct wb_json *root, const struct wb_machines_results *results)
{
    const struct wb_machines_cable *const cable = &results->campaign->cable;
    if (results->cable.n_layers == 0)
        return;
    struct wb_json *const object = wb_json_set_object(root, "cable");
    WB_PUT(object, &wb_machines_cable_keys, struct wb_cable_ring, &cable->ring);
    wb_numbers_put_properties(wb_json_set_object(object, "conductor"), &cable->ring.conductor);
    struct wb_json *const layers = wb_json_set_array(object, "layers");
    for (int i = 0; i < results->cable.n_layers; i++) {
        const struct wb_machines_layer *const layer = &results->cable.layers[i];
        struct wb_json *const entry = wb_json_append_object(layers);
        wb_json_set_text(entry, "group", group_of(results, layer)->name);
        WB_PUT(entry, &layer_keys, struct wb_machines_layer, layer);
        struct wb_json *const places = wb_json_set_array(entry, "places");
        for (int k = 0; k < WB_MACHINES_PLACES && layer->n > 0; k++)
            put_place(places, layer, cable->n_wires, k);
    }
}

void wb_machines_cable_print(FILE *out, const struct wb_machines_results *results)
{
    for (int i = 0; i < results->cable.n_layers; i++) {
        const struct wb_machines_layer *const layer = &results->cable.layers[i];
        const struct wb_cable_place *const last = &layer->place[WB_MACHINES_PLACES - 1];
        if (layer->n > 0)
            fprintf(out, "  group %-34s M / M_free = %.2f, chi = %.2f at %.3g 1/m\n",
                    group_of(results, layer)->name, last->ratio.value, last->chi.value,
                    layer->curvature[WB_MACHINES_PLACES - 1]);
    }
}
