/* Reading of a bundle's section: wb_bundle_model_read_section() of fe/model/bundle_model_private.h.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/units.h"
#include "fe/model/bundle_model_private.h"

#define WB_LOG_DOMAIN "bundle"

static const double touching = 1e-9; /* m: wires so near to the tape touch it */
static const double largest_poisson = 0.499;
/* Of a tape whose material says none. With 0.39 for the wires and voids that count as zero it gives
 * the bundles of Table 4 the 0.3 on average that section 5.5 takes by the rule of mixtures. */
static const double tape_poisson = 0.35;

const char *const wb_bundle_model_packings[] = {"hexagon", "triangle", "densest", "places", NULL};
static const char *const layouts[] = {"sleeve", "helix", NULL};
static const char *const outlines[] = {"hull", "circle", NULL};
static const char *const hands[] = {"right", "left", NULL};

/* --- wires --- */

static bool are_same(const struct wb_wire *a, const struct wb_wire *b)
{
    const struct wb_material *const p = &a->material, *const q = &b->material;
    return a->conductor_diameter == b->conductor_diameter &&
           a->outer_diameter == b->outer_diameter && a->density == b->density &&
           p->youngs_modulus == q->youngs_modulus && p->poissons_ratio == q->poissons_ratio &&
           p->yield_stress == q->yield_stress &&
           p->strength_coefficient == q->strength_coefficient &&
           p->hardening_exponent == q->hardening_exponent;
}

/* The type of that file's wire: one there is, or a new one. */
static enum wb_status take_type(struct wb_bundle_model_reader *reader,
                                const struct wb_config_node *map, const char *name, int *type)
{
    struct wb_bundle_model *const m = reader->model;
    struct wb_wire wire;
    WB_TRY(wb_bundle_model_find_wire(reader, map, "wire", name, &wire));
    for (*type = 0; *type < m->n_types; (*type)++) {
        if (strcmp(m->type[*type].name, wire.name) != 0)
            continue;
        if (!are_same(&m->type[*type], &wire))
            return wb_config_refuse(map, "wire", "another, different wire is called %s, too",
                                    wire.name);
        return WB_OK;
    }
    if (m->n_types == WB_BUNDLE_MODEL_TYPES)
        return wb_config_refuse(map, "wire", "more than %d different wires", WB_BUNDLE_MODEL_TYPES);
    m->type[m->n_types++] = wire;
    return WB_OK;
}

static enum wb_status read_wires(struct wb_bundle_model_reader *reader,
                                 const struct wb_config_node *list)
{
    struct wb_bundle_model *const m = reader->model;
    const int n = wb_config_length(list);
    if (n < 1)
        return wb_config_refuse(reader->root, "wires", "expected a list of wires");
    for (int i = 0; i < n; i++) {
        const struct wb_config_node *const map = wb_config_item(list, i);
        char name[64];
        int count = 1, type;
        const struct wb_config_key keys[] = {
            WB_CONFIG_TEXT("wire", name),
            WB_CONFIG_OPTIONAL_INTEGER("count", &count, 1, WB_PACKING_MOST),
        };
        WB_TRY(wb_config_map(map, keys, WB_COUNT(keys)));
        WB_TRY(take_type(reader, map, name, &type));
        if (m->packing.n + count > WB_PACKING_MOST)
            return wb_config_refuse(map, "count", "more than %d wires", WB_PACKING_MOST);
        while (count-- > 0)
            m->type_of[m->packing.n++] = type;
    }
    return WB_OK;
}

/* --- packing --- */

static enum wb_status read_search(struct wb_bundle_model *model, const struct wb_config_node *map)
{
    int seed = 1, trials = 0;
    const struct wb_config_key keys[] = {
        WB_CONFIG_OPTIONAL_INTEGER("seed", &seed, 0, 1000000000),
        WB_CONFIG_OPTIONAL_INTEGER("trials", &trials, 1, 1000000),
    };
    if (map)
        WB_TRY(wb_config_map(map, keys, WB_COUNT(keys)));
    model->search = (struct wb_packing_search){.seed = (unsigned int)seed, .trials = trials};
    return WB_OK;
}

static enum wb_status read_gaps(struct wb_bundle_model *model, const struct wb_config_node *map)
{
    const struct wb_config_key keys[] = {
        WB_CONFIG_OPTIONAL_NUMBER("wires_mm", &model->wire_gap, WB_MM, 0.0, 10.0),
        WB_CONFIG_OPTIONAL_NUMBER("tape_mm", &model->tape.gap, WB_MM, 0.0, 10.0),
    };
    return wb_config_map(map, keys, WB_COUNT(keys));
}

/* The listed places, [y, z] each. */
static enum wb_status read_places(struct wb_bundle_model_reader *reader,
                                  const struct wb_config_node *list, struct wb_packing *packing)
{
    const struct wb_config_key key = {
        .name = "places_mm", .factor = WB_MM, .minimum = -1e3, .maximum = 1e3};
    const int n = wb_config_length(list);
    if (n != packing->n)
        return wb_config_refuse(reader->root, "places_mm", "expected a list of %d places [y, z]",
                                packing->n);
    for (int i = 0; i < n; i++) {
        double place[2];
        int two;
        WB_TRY(wb_config_numbers(wb_config_item(list, i), &key, 2, 2, place, &two));
        packing->wire[i].y = place[0];
        packing->wire[i].z = place[1];
    }
    return WB_OK;
}

static enum wb_status check_lattice(const struct wb_bundle_model_reader *reader,
                                    enum wb_packing_lattice lattice)
{
    const int n = reader->model->packing.n;
    int less;
    const int whole = wb_packing_whole(lattice, n, &less);
    if (whole == n)
        return WB_OK;
    if (less == 0)
        return wb_config_refuse(reader->root, "packing", "%d wires are no %s; the smallest has %d",
                                n, wb_bundle_model_packings[lattice], whole);
    return wb_config_refuse(reader->root, "packing", "%d wires are no %s; %d or %d are", n,
                            wb_bundle_model_packings[lattice], less, whole);
}

static enum wb_status check_keys(const struct wb_bundle_model_reader *reader,
                                 const struct wb_bundle_model_section *section)
{
    const struct wb_bundle_model *const m = reader->model;
    const bool is_places = m->arrangement == WB_BUNDLE_PLACES;
    const bool is_densest = m->arrangement == WB_BUNDLE_DENSEST;
    if (is_places && !section->places)
        return wb_config_refuse(reader->root, "places_mm",
                                "this key is missing: packing places needs it");
    if (!is_places && section->places)
        return wb_config_refuse(reader->root, "places_mm", "only with packing: places");
    if (!is_densest && section->search)
        return wb_config_refuse(reader->root, "search", "only with packing: densest");
    if (is_densest && section->has_settled)
        return wb_config_refuse(reader->root, "settled", "the densest packing is settled");
    if (is_places && !m->settled && m->wire_gap > 0.0)
        return wb_config_refuse(section->gaps, "wires_mm",
                                "the places say how far wires are apart");
    return WB_OK;
}

/* Wires packed with their gap as part of them. */
static enum wb_status pack(struct wb_bundle_model_reader *reader,
                           const struct wb_bundle_model_section *section)
{
    struct wb_bundle_model *const m = reader->model;
    double diameter[WB_PACKING_MOST];
    struct wb_packing packing = {.n = m->packing.n};
    for (int i = 0; i < packing.n; i++) {
        diameter[i] = m->type[m->type_of[i]].outer_diameter + m->wire_gap;
        packing.wire[i].radius = 0.5 * diameter[i];
    }
    switch (m->arrangement) {
    case WB_BUNDLE_HEXAGON:
    case WB_BUNDLE_TRIANGLE: {
        const enum wb_packing_lattice lattice =
            m->arrangement == WB_BUNDLE_HEXAGON ? WB_PACKING_HEXAGON : WB_PACKING_TRIANGLE;
        WB_TRY(check_lattice(reader, lattice));
        WB_TRY(wb_packing_on_lattice(&packing, packing.n, diameter, lattice));
        break;
    }
    case WB_BUNDLE_DENSEST:
        WB_TRY(wb_packing_densest(&packing, packing.n, diameter, &m->search));
        break;
    case WB_BUNDLE_PLACES:
        WB_TRY(read_places(reader, section->places, &packing));
        break;
    }
    if (m->settled)
        WB_TRY(wb_packing_settle(&packing));
    m->packing = packing;
    return WB_OK;
}

/* Takes the gap off the wires again and puts the axis where it belongs. */
static enum wb_status place_axis(struct wb_bundle_model_reader *reader)
{
    struct wb_bundle_model *const m = reader->model;
    struct wb_packing *const packing = &m->packing;
    for (int i = 0; i < packing->n; i++)
        packing->wire[i].radius = 0.5 * m->type[m->type_of[i]].outer_diameter;
    const struct wb_packing_circle circle = wb_packing_enclosing(packing->n, packing->wire);
    for (int i = 0; i < packing->n; i++) {
        packing->wire[i].y -= circle.y;
        packing->wire[i].z -= circle.z;
    }
    const double gap = wb_packing_smallest_gap(packing);
    if (gap < -touching)
        return wb_config_refuse(reader->root, "places_mm",
                                "two wires overlap by %g mm (settled: true moves them apart)",
                                -gap / WB_MM);
    return WB_OK;
}

static enum wb_status read_packing(struct wb_bundle_model_reader *reader,
                                   const struct wb_bundle_model_section *section)
{
    if (section->gaps)
        WB_TRY(read_gaps(reader->model, section->gaps));
    WB_TRY(check_keys(reader, section));
    WB_TRY(read_search(reader->model, section->search));
    WB_TRY(pack(reader, section));
    return place_axis(reader);
}

/* --- tape --- */

struct taping_settings {
    int layout, layers, hand, outline;
    double width, lap, poissons_ratio, reach;
    bool has_layers, has_width, has_lap, has_hand, has_poisson, has_reach;
};

static enum wb_status check_taping(const struct wb_config_node *map,
                                   const struct taping_settings *settings)
{
    const bool is_helix = settings->layout == 1;
    if (is_helix && settings->has_layers)
        return wb_config_refuse(map, "layers", "the layers of a helix follow from lap_percent");
    if (is_helix && !settings->has_width)
        return wb_config_refuse(map, "width_mm", "this key is missing: a helix needs it");
    if (!is_helix && (settings->has_width || settings->has_lap || settings->has_hand))
        return wb_config_refuse(map,
                                settings->has_width ? "width_mm"
                                : settings->has_lap ? "lap_percent"
                                                    : "hand",
                                "only with layout: helix");
    if (settings->outline == 1 && !settings->has_reach)
        return wb_config_refuse(map, "bond_reach_mm",
                                "this key is missing: a tape on a circle touches wires along lines "
                                "only; say how far it may be off a wire where it is bonded "
                                "(0: it is bonded nowhere)");
    return WB_OK;
}

static enum wb_status read_taping(const struct wb_config_node *map,
                                  struct taping_settings *settings)
{
    struct wb_config_key keys[] = {
        WB_CONFIG_CHOICE("layout", &settings->layout, layouts),
        WB_CONFIG_OPTIONAL_INTEGER("layers", &settings->layers, 1, 20),
        WB_CONFIG_OPTIONAL_NUMBER("width_mm", &settings->width, WB_MM, 0.1, 1e3),
        WB_CONFIG_OPTIONAL_NUMBER("lap_percent", &settings->lap, WB_PERCENT, 0.0, 95.0),
        WB_CONFIG_OPTIONAL_CHOICE("hand", &settings->hand, hands),
        WB_CONFIG_OPTIONAL_NUMBER("poissons_ratio", &settings->poissons_ratio, 1.0, -0.99,
                                  largest_poisson),
        WB_CONFIG_OPTIONAL_CHOICE("outline", &settings->outline, outlines),
        WB_CONFIG_OPTIONAL_NUMBER("bond_reach_mm", &settings->reach, WB_MM, 0.0, 1.0),
    };
    keys[1].present = &settings->has_layers;
    keys[2].present = &settings->has_width;
    keys[3].present = &settings->has_lap;
    keys[4].present = &settings->has_hand;
    keys[5].present = &settings->has_poisson;
    keys[7].present = &settings->has_reach;
    WB_TRY(wb_config_map(map, keys, WB_COUNT(keys)));
    return check_taping(map, settings);
}

static enum wb_status read_tape_material(struct wb_bundle_model_reader *reader, const char *name)
{
    struct wb_material_file *const file = &reader->model->tape.material;
    char path[WB_PATH];
    WB_TRY(wb_bundle_model_find(reader, reader->root, "tape", "materials", name, path));
    WB_TRY(wb_material_file_read(file, path));
    if (!(file->thickness > 0.0))
        return wb_config_refuse(reader->root, "tape",
                                "material %s has no thickness_of_two_layers_mm", file->name);
    if (file->material.hardening == WB_HARDENING_KINEMATIC_LINEAR)
        return wb_config_refuse(reader->root, "tape", "material %s hardens kinematically",
                                file->name);
    return WB_OK;
}

static enum wb_status lay_tape(struct wb_bundle_model_reader *reader,
                               const struct wb_config_node *map,
                               const struct taping_settings *settings)
{
    struct wb_bundle_tape *const tape = &reader->model->tape;
    const double layer = 0.5 * tape->material.thickness;
    const double layers = settings->layout == 0 ? settings->layers : 1.0 / (1.0 - settings->lap);
    struct wb_packing circle = {.n = 1};
    tape->round = settings->outline == 1;
    tape->reach = settings->reach;
    circle.wire[0] = wb_packing_enclosing(reader->model->packing.n, reader->model->packing.wire);
    WB_TRY(wb_hull_find(&tape->hull, tape->round ? &circle : &reader->model->packing, touching));
    const double round = wb_hull_length(&tape->hull, tape->gap + 0.5 * layers * layer);
    if (settings->layout == 0)
        return wb_taping_sleeve(&tape->taping, round, layer, settings->layers);
    if (!((1.0 - settings->lap) * settings->width < round))
        return wb_config_refuse(map, "width_mm",
                                "a tape %g mm wide with a lap of %g %% cannot be wound round %g mm",
                                settings->width / WB_MM, settings->lap / WB_PERCENT, round / WB_MM);
    const struct wb_taping_helix helix = {settings->width, settings->lap,
                                          settings->hand == 0 ? 1 : -1};
    return wb_taping_wind(&tape->taping, round, layer, &helix);
}

static enum wb_status read_tape(struct wb_bundle_model_reader *reader, const char *name,
                                const struct wb_config_node *map)
{
    struct taping_settings settings = {.layers = 2, .lap = 0.5};
    if (*name == '\0') {
        if (map)
            return wb_config_refuse(reader->root, "taping", "there is no tape");
        return reader->model->tape.gap > 0.0
                   ? wb_config_refuse(reader->root, "gaps", "there is no tape for tape_mm")
                   : WB_OK;
    }
    if (map)
        WB_TRY(read_taping(map, &settings));
    WB_TRY(read_tape_material(reader, name));
    double *const poisson = &reader->model->tape.material.material.poissons_ratio;
    if (settings.has_poisson)
        *poisson = settings.poissons_ratio;
    else if (!isfinite(*poisson))
        *poisson = tape_poisson;
    reader->model->has_tape = true;
    return lay_tape(reader, map, &settings);
}

/* --- all of it --- */

enum wb_status wb_bundle_model_read_section(struct wb_bundle_model_reader *reader,
                                            const struct wb_bundle_model_section *section)
{
    WB_TRY(read_wires(reader, section->wires));
    WB_TRY(read_packing(reader, section));
    return read_tape(reader, section->tape, section->taping);
}
