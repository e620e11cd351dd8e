#include "fe/model/bundle_model.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/config.h"
#include "base/memory.h"
#include "base/units.h"
#include "fe/model/model_file.h"
#include "fe/model/packing_touch.h"

static const double touching = 1e-9; /* m: wires within this distance touch the tape */
static const double largest_poisson = 0.499;

static const char *const length_sources[] = {"own", "printed", "inferred", NULL};
static const char *const tips[] = {"free", "capped", NULL};
static const char *const formulations[] = {"2x2x1", "one-point", NULL};
static const char *const precisions[] = {"single", "double", NULL};

/* --- settings --- */

/* In the order of the enum. */
const struct wb_setting wb_bundle_model_run_settings[WB_BUNDLE_MODEL_RUN_SETTINGS] = {
    {WB_ROW_TEXT(wb_bundle_run, mesh, "mesh"),
     WB_ROW_OPTION("mesh", "NAME", "Mesh: engineering, paper, or a mesh of the file"),
     .otherwise = "engineering"},
    {WB_ROW_QUANTITY(wb_bundle_run, duration, "duration_s", "s", 1.0, 1e-6, 1e6, 0.0),
     WB_ROW_OPTION("duration-s", "T",
                   "Duration of a loading; if the file has none, it is chosen so that the kinetic "
                   "energy stays small"),
     .otherwise = "chosen"},
    {WB_ROW_NUMBER(wb_bundle_run, mass_scaling, "mass_scaling", 1.0, 1e6, 25.0),
     WB_ROW_OPTION("mass-scaling", "F", "Factor on all masses")},
    {WB_ROW_NUMBER(wb_bundle_run, selective, "selective_mass_scaling", 1.0, 1e6, 100.0),
     WB_ROW_OPTION("selective", "B", "Selective mass scaling of sections")},
    {WB_ROW_QUANTITY(wb_bundle_run, deflection, "deflection_mm", "mm", WB_MM, 1e-6, 1e6, 53.0),
     WB_ROW_OPTION("deflection-mm", "D", "Largest deflection of the tip")},
    {WB_ROW_INTEGER(wb_bundle_run, rows, "rows", 1, 10000, 53),
     WB_ROW_OPTION("points", "N", "Equal steps to the largest deflection")},
    {WB_ROW_INTEGER(wb_bundle_run, cycles, "cycles", 0, 1000, 0),
     .help = "Times up and back; 0: up only"},
    {WB_ROW_NUMBER(wb_bundle_run, kinetic_limit, "kinetic_energy_limit", 1e-6, 1.0, 0.05),
     .help = "Largest kinetic over internal energy"},
    {WB_ROW_CHOICE(wb_bundle_run, double_precision, "precision", precisions, 0),
     .help = "Precision of forces and of stored states of the material; positions and velocities "
             "are in double"},
};

static const struct wb_setting_table run_table = {.rows = wb_bundle_model_run_settings,
                                                  .n = WB_BUNDLE_MODEL_RUN_SETTINGS};

static const struct wb_setting friction_rows[] = {
    {WB_ROW_NUMBER(wb_friction, mu_static, "static", 0.0, 10.0, 0.0), .required = true,
     .help = "Static friction coefficient"},
    {WB_ROW_NUMBER(wb_friction, mu_kinetic, "kinetic", 0.0, 10.0, 0.0), .required = true,
     .help = "Kinetic friction coefficient"},
    {WB_ROW_QUANTITY(wb_friction, decay, "decay_s_mm", "s/mm", WB_S_PER_MM, 1e-9, 1e9, 0.0),
     .required = true,
     .help = "Decay from static to kinetic friction with the slip rate (eq. 20); 0: constant"},
};

static const struct wb_setting_table friction_table = {WB_SETTING_ROWS(friction_rows)};

/* A single coefficient means constant friction. */
static int complete_friction(void *members, int n, char *problem, size_t size)
{
    struct wb_friction *const friction = members;
    if (n == 1) {
        friction->mu_kinetic = friction->mu_static;
        friction->decay = 0.0;
    }
    if (!(friction->mu_kinetic > friction->mu_static))
        return -1;
    snprintf(problem, size, "%g is more than the static one, %g", friction->mu_kinetic,
             friction->mu_static);
    return 1;
}

const struct wb_setting wb_bundle_model_friction_setting[1] = {
    {WB_ROW_LIST(wb_bundle_interface, friction, "friction", friction_table, has_friction),
     WB_ROW_OPTION("friction", "S[,K,D]",
                   "Constant friction, or static and kinetic friction with their decay in s/mm; "
                   "coefficients"),
     .required = true, .complete = complete_friction},
};

const struct wb_setting wb_bundle_model_cohesion_setting[1] = {
    {WB_ROW_QUANTITY(wb_bundle_interface, normal_stiffness, "cohesive_stiffness_N_mm3", "N/mm3",
                     WB_N_PER_MM3, 1e-6, 1e9, 0.0),
     WB_ROW_OPTION(
         "cohesive-stiffness", "K",
         "Normal stiffness between tape and wires; the shear stiffness changes in proportion"),
     .required = true},
};

static const struct wb_setting_table cohesion_table = {.rows = wb_bundle_model_cohesion_setting,
                                                       .n = 1};

static const struct wb_setting loads_rows[] = {
    {WB_ROW_QUANTITY(wb_bundle_loads, strand_length, "strand_mm", "mm", WB_MM, 1e-3, 1e9, 0.0),
     .otherwise = "none"},
    {WB_ROW_BOOLEAN(wb_bundle_loads, weight, "weight", false), .required = true},
};

static const struct wb_setting_table loads_table = {WB_SETTING_ROWS(loads_rows)};

static const struct wb_bundle_mesh own_meshes[2] = {
    {.name = "engineering",
     .core_quads = 2,
     .rings = 1,
     .elements_along = 80,
     .formulation = WB_BUNDLE_FOUR_POINTS},
    {.name = "paper",
     .core_quads = 6,
     .rings = 2,
     .elements_along = 384,
     .formulation = WB_BUNDLE_ONE_POINT},
};

/* Poisson's ratio of a tape whose material file has none. With 0.39 for the wires and 0 for voids,
 * the bundles of Table 4 get 0.3 on average, the value that section 5.5 derives by the rule of
 * mixtures. */
static const double tape_poisson = 0.35;

static const char *const packings[] = {"hexagon", "triangle", "densest", "places", NULL};
static const char *const layouts[] = {"sleeve", "helix", NULL};
static const char *const hands[] = {"right", "left", NULL};

const char *wb_bundle_model_arrangement(const struct wb_bundle_model *model)
{
    return packings[model->arrangement];
}

int wb_bundle_model_count(const struct wb_bundle_model *model, int type)
{
    int n = 0;
    for (int i = 0; i < model->packing.n; i++)
        n += model->type_of[i] == type;
    return n;
}

/* --- meshes --- */

int wb_bundle_model_rows(const struct wb_bundle_model *model)
{
    return 1 + model->run.rows * (model->run.cycles == 0 ? 1 : 2 * model->run.cycles);
}

const struct wb_bundle_mesh *wb_bundle_model_mesh(const struct wb_bundle_model *model,
                                                  const char *name)
{
    for (int i = 0; i < model->n_meshes; i++) {
        if (strcmp(model->mesh[i].name, name) == 0)
            return &model->mesh[i];
    }
    return NULL;
}

int wb_bundle_model_section_quads(const struct wb_bundle_mesh *mesh)
{
    return mesh->core_quads * (mesh->core_quads + 4 * mesh->rings);
}

long wb_bundle_model_hexahedra(const struct wb_bundle_model *model,
                               const struct wb_bundle_mesh *mesh)
{
    return (long)model->packing.n * wb_bundle_model_section_quads(mesh) * mesh->elements_along;
}

int wb_bundle_model_tape_quads(const struct wb_bundle_model *model,
                               const struct wb_bundle_mesh *mesh)
{
    if (!model->has_tape)
        return 0;
    if (mesh->tape_quads > 0)
        return mesh->tape_quads;
    double thinnest = (double)INFINITY;
    for (int i = 0; i < model->n_types; i++)
        thinnest = fmin(thinnest, model->type[i].outer_diameter);
    const double width = M_PI * thinnest / (4 * mesh->core_quads);
    return 6 * (int)ceil(model->tape.taping.circumference / (6.0 * width) - 1e-9);
}

/* --- scaled --- */

static void scale_circles(struct wb_packing *packing, double factor)
{
    for (int i = 0; i < packing->n; i++) {
        struct wb_packing_circle *const circle = &packing->wire[i];
        circle->y *= factor;
        circle->z *= factor;
        circle->radius *= factor;
    }
}

void wb_bundle_model_scale(struct wb_bundle_model *model, const struct wb_bundle_scales *scales)
{
    /* A pitch unlike the diameter makes circles as wide as the pitch, with wires of their own
     * diameter in them: law and area are the wire's; lever arms and contacts follow the pitch. */
    const double factor = scales->diameter * scales->pitch;
    struct wb_bundle_tape *const tape = &model->tape;

    for (int i = 0; i < model->n_types; i++) {
        model->type[i].conductor_diameter *= scales->diameter;
        model->type[i].outer_diameter *= scales->diameter;
    }
    model->wire_gap *= factor;
    scale_circles(&model->packing, factor);
    if (!model->has_tape)
        return;
    tape->gap *= factor;
    scale_circles(&tape->hull.packing, factor);
    for (int i = 0; i < tape->hull.n_arcs; i++)
        tape->hull.arc[i].straight *= factor;
    tape->taping.layer_thickness *= scales->thickness;
    const double middle = tape->gap + 0.5 * wb_taping_thickness(&tape->taping);
    tape->taping.circumference = wb_hull_length(&tape->hull, middle);
}

/* State while a model is read. */
struct reader {
    struct wb_bundle_model *model;
    struct wb_model_file file;
    const struct wb_bundle_variant *variant; /* NULL: none */
};

/* Top-level values of a file that define the section. */
struct section_nodes {
    const struct wb_config_node *wires, *places, *search, *gaps, *taping;
    bool has_settled;
    char tape[64]; /* "": none */
};

/* --- names and files --- */

static enum wb_status find_wire(struct reader *reader, const struct wb_config_node *map,
                                const char *key, const char *name, struct wb_wire *wire)
{
    WB_TRY(wb_model_file_wire(&reader->file, map, key, name, wire));
    return wb_model_file_check_wire(map, key, wire, "");
}

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

/* Finds the type of a wire file's wire, or adds a new type. */
static enum wb_status take_type(struct reader *reader, const struct wb_config_node *map,
                                const char *name, int *type)
{
    struct wb_bundle_model *const m = reader->model;
    struct wb_wire wire;
    WB_TRY(find_wire(reader, map, "wire", name, &wire));
    for (*type = 0; *type < m->n_types; (*type)++) {
        if (strcmp(m->type[*type].name, wire.name) != 0)
            continue;
        if (!are_same(&m->type[*type], &wire))
            return wb_config_refuse(map, "wire", "another, different wire has the name %s",
                                    wire.name);
        return WB_OK;
    }
    if (m->n_types == WB_BUNDLE_MODEL_TYPES)
        return wb_config_refuse(map, "wire", "more than %d different wires", WB_BUNDLE_MODEL_TYPES);
    m->type[m->n_types++] = wire;
    return WB_OK;
}

static enum wb_status read_wires(struct reader *reader, const struct wb_config_node *list)
{
    struct wb_bundle_model *const m = reader->model;
    const int n = wb_config_length(list);
    if (n < 1)
        return wb_config_refuse(reader->file.root, "wires", "expected a list of wires");
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

/* --- variants --- */

/* The default packing of n wires. */
static enum wb_bundle_packing natural_packing(int n)
{
    int less;
    return wb_packing_whole(WB_PACKING_HEXAGON, n, &less) == n    ? WB_BUNDLE_HEXAGON
           : wb_packing_whole(WB_PACKING_TRIANGLE, n, &less) == n ? WB_BUNDLE_TRIANGLE
                                                                  : WB_BUNDLE_DENSEST;
}

/* Applies the variant's number of wires and packing. */
static enum wb_status vary_wires(struct reader *reader, struct section_nodes *section)
{
    const struct wb_bundle_variant *const variant = reader->variant;
    struct wb_bundle_model *const m = reader->model;
    const bool is_repacked = variant && (variant->has_packing || variant->wires > 0);

    if (!is_repacked)
        return WB_OK;
    if (variant->wires > 0 && m->n_types > 1)
        return wb_config_refuse(
            reader->file.root, "wires",
            "variant %s: %d wires: the number can be varied only in a file with one kind of wire",
            variant->name, variant->wires);
    if (variant->wires > 0)
        m->packing.n = variant->wires;
    for (int i = 0; i < m->packing.n && variant->wires > 0; i++)
        m->type_of[i] = 0;
    m->arrangement = variant->has_packing ? (enum wb_bundle_packing)variant->packing
                                          : natural_packing(m->packing.n);
    m->settled = false;
    m->touching = 0.0;
    section->has_settled = false;
    section->places = NULL;
    if (m->arrangement != WB_BUNDLE_DENSEST)
        section->search = NULL;
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
static enum wb_status read_places(struct reader *reader, const struct wb_config_node *list,
                                  struct wb_packing *packing)
{
    const struct wb_config_key key = {
        .name = "places_mm", .factor = WB_MM, .minimum = -1e3, .maximum = 1e3};
    const int n = wb_config_length(list);
    if (n != packing->n)
        return wb_config_refuse(reader->file.root, "places_mm",
                                "expected a list of %d places [up, right], one of each wire",
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

static enum wb_status check_lattice(const struct reader *reader, enum wb_packing_lattice lattice)
{
    const int n = reader->model->packing.n;
    int less;
    const int whole = wb_packing_whole(lattice, n, &less);
    if (whole == n)
        return WB_OK;
    if (less == 0)
        return wb_config_refuse(reader->file.root, "packing",
                                "%d wires do not fill a %s; the smallest has %d", n,
                                packings[lattice], whole);
    return wb_config_refuse(reader->file.root, "packing", "%d wires do not fill a %s; %d or %d do",
                            n, packings[lattice], less, whole);
}

static enum wb_status check_keys(const struct reader *reader, const struct section_nodes *section)
{
    const struct wb_bundle_model *const m = reader->model;
    const bool is_places = m->arrangement == WB_BUNDLE_PLACES;
    const bool is_densest = m->arrangement == WB_BUNDLE_DENSEST;
    if (is_places && !section->places)
        return wb_config_refuse(reader->file.root, "places_mm",
                                "this key is missing: packing places needs it");
    if (!is_places && section->places)
        return wb_config_refuse(reader->file.root, "places_mm", "only with packing: places");
    if (!is_densest && section->search)
        return wb_config_refuse(reader->file.root, "search", "only with packing: densest");
    if (is_densest && section->has_settled)
        return wb_config_refuse(reader->file.root, "settled",
                                "not with packing: densest, which is always settled");
    if (!is_places && m->touching > 0.0)
        return wb_config_refuse(reader->file.root, "touching_mm", "only with packing: places");
    if (is_places && !m->settled && m->wire_gap > 0.0)
        return wb_config_refuse(section->gaps, "wires_mm",
                                "not with packing: places, which give the distances");
    return WB_OK;
}

/* Moves the wires until they touch; on failure the message names touching_mm and the reason. */
static enum wb_status touch(const struct reader *reader, struct wb_packing *packing)
{
    struct wb_reason why = {""};
    if (wb_packing_touch(packing, reader->model->touching, &why) == WB_OK)
        return WB_OK;
    return wb_config_refuse(reader->file.root, "touching_mm", "%s", why.text);
}

/* Packs circles that include the gap between wires. */
static enum wb_status pack(struct reader *reader, const struct section_nodes *section)
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
        if (m->touching > 0.0)
            WB_TRY(touch(reader, &packing));
        break;
    }
    if (m->settled)
        WB_TRY(wb_packing_settle(&packing));
    m->packing = packing;
    return WB_OK;
}

/* Removes the gap from the circles and moves the axis to the centre of the enclosing circle. */
static enum wb_status place_axis(struct reader *reader)
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
        return wb_config_refuse(reader->file.root, "places_mm",
                                "two wires overlap by %g mm (touching_mm moves them apart)",
                                -gap / WB_MM);
    return WB_OK;
}

static enum wb_status read_packing(struct reader *reader, const struct section_nodes *section)
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
    double width, lap;
    double poissons_ratio, reach; /* NaN: not given */
};

static enum wb_status check_taping(const struct wb_config_node *map,
                                   const struct taping_settings *settings)
{
    static const char *const helix_only[] = {"width_mm", "lap_percent", "hand", NULL};
    const bool is_helix = settings->layout == 1;
    if (is_helix && wb_config_find(map, "layers"))
        return wb_config_refuse(map, "layers", "the layers of a helix follow from lap_percent");
    if (is_helix && !wb_config_find(map, "width_mm"))
        return wb_config_refuse(map, "width_mm", "this key is missing: a helix needs it");
    if (!is_helix)
        WB_TRY(wb_config_refuse_keys(map, helix_only, "only with layout: helix"));
    if (settings->outline == 1 && isnan(settings->reach))
        return wb_config_refuse(map, "bond_reach_mm",
                                "this key is missing: a tape on a circle touches wires along lines "
                                "only; give the largest distance at which it is bonded to a wire "
                                "(0: no bond), here or by --bond-reach-mm");
    return WB_OK;
}

static enum wb_status read_taping(const struct wb_config_node *map,
                                  struct taping_settings *settings)
{
    const struct wb_config_key keys[] = {
        WB_CONFIG_CHOICE("layout", &settings->layout, layouts),
        WB_CONFIG_OPTIONAL_INTEGER("layers", &settings->layers, 1, 20),
        WB_CONFIG_OPTIONAL_NUMBER("width_mm", &settings->width, WB_MM, 0.1, 1e3),
        WB_CONFIG_OPTIONAL_NUMBER("lap_percent", &settings->lap, WB_PERCENT, 0.0, 95.0),
        WB_CONFIG_OPTIONAL_CHOICE("hand", &settings->hand, hands),
        WB_CONFIG_OPTIONAL_NUMBER("poissons_ratio", &settings->poissons_ratio, 1.0, -0.99,
                                  largest_poisson),
        WB_CONFIG_OPTIONAL_CHOICE("outline", &settings->outline, wb_bundle_uncertainty_outlines),
        WB_CONFIG_OPTIONAL_NUMBER("bond_reach_mm", &settings->reach, WB_MM, 0.0, 1.0),
    };
    return wb_config_map(map, keys, WB_COUNT(keys));
}

static bool has_tape_of_its_own(const struct wb_bundle_variant *variant)
{
    return variant && (variant->layers > 0 || variant->lap > 0.0 || variant->has_outline ||
                       variant->has_reach);
}

static enum wb_status vary_taping(const struct reader *reader, struct taping_settings *settings)
{
    const struct wb_bundle_variant *const variant = reader->variant;

    if (!has_tape_of_its_own(variant))
        return WB_OK;
    if (settings->layout != 0)
        return wb_config_refuse(
            reader->file.root, "taping",
            "variant %s: layers, overlap, outline and bonds can be varied only with a sleeve",
            variant->name);
    if (variant->layers > 0)
        settings->layers = variant->layers;
    if (variant->has_outline)
        settings->outline = variant->outline;
    if (variant->has_reach)
        settings->reach = variant->reach;
    return WB_OK;
}

static enum wb_status read_tape_material(struct reader *reader, const char *name)
{
    struct wb_material_file *const file = &reader->model->tape.material;
    char path[WB_PATH];
    WB_TRY(wb_model_file_find(&reader->file, reader->file.root, "tape", "materials", name, path));
    WB_TRY(wb_material_file_read(file, path));
    if (!(file->thickness > 0.0))
        return wb_config_refuse(reader->file.root, "tape",
                                "material %s has no thickness_of_two_layers_mm", file->name);
    if (file->material.hardening == WB_HARDENING_KINEMATIC_LINEAR)
        return wb_config_refuse(reader->file.root, "tape", "material %s hardens kinematically",
                                file->name);
    return WB_OK;
}

static enum wb_status lay_tape(struct reader *reader, const struct wb_config_node *map,
                               const struct taping_settings *settings)
{
    struct wb_bundle_tape *const tape = &reader->model->tape;
    const double layer = 0.5 * tape->material.thickness;
    const double layers = settings->layout == 0 ? settings->layers : 1.0 / (1.0 - settings->lap);
    struct wb_packing circle = {.n = 1};
    tape->round = settings->outline == 1;
    tape->reach = isnan(settings->reach) ? 0.0 : settings->reach;
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

static enum wb_status read_tape(struct reader *reader, const char *name,
                                const struct wb_config_node *map)
{
    struct taping_settings settings = {
        .layers = 2, .lap = 0.5, .poissons_ratio = (double)NAN, .reach = (double)NAN};
    if (*name == '\0') {
        if (has_tape_of_its_own(reader->variant))
            return wb_config_refuse(reader->file.root, "tape",
                                    "variant %s applies to a tape, and this bundle has no tape",
                                    reader->variant->name);
        if (map)
            return wb_config_refuse(reader->file.root, "taping", "the bundle has no tape");
        return reader->model->tape.gap > 0.0
                   ? wb_config_refuse(reader->file.root, "gaps", "tape_mm: the bundle has no tape")
                   : WB_OK;
    }
    if (map)
        WB_TRY(read_taping(map, &settings));
    WB_TRY(vary_taping(reader, &settings));
    WB_TRY(check_taping(map ? map : reader->file.root, &settings));
    WB_TRY(read_tape_material(reader, name));
    double *const poisson = &reader->model->tape.material.material.poissons_ratio;
    if (!isnan(settings.poissons_ratio))
        *poisson = settings.poissons_ratio;
    else if (!isfinite(*poisson))
        *poisson = tape_poisson;
    reader->model->has_tape = true;
    return lay_tape(reader, map, &settings);
}

/* --- section --- */

static enum wb_status read_section(struct reader *reader, struct section_nodes *section)
{
    WB_TRY(read_wires(reader, section->wires));
    WB_TRY(vary_wires(reader, section));
    WB_TRY(read_packing(reader, section));
    WB_TRY(read_tape(reader, section->tape, section->taping));
    if (reader->variant && reader->variant->lap > 0.0) {
        const struct wb_bundle_scales scales = {1.0, 1.0, 1.0 / (1.0 - reader->variant->lap)};
        wb_bundle_model_scale(reader->model, &scales);
    }
    return WB_OK;
}

/* --- interface --- */

/* The law must soften beyond its strength. */
static enum wb_status check_energy(const struct wb_config_node *map, double strength,
                                   double stiffness, const struct wb_bundle_damage *damage)
{
    const double least = 0.5 * strength * strength / stiffness;
    if (!(damage->fracture_energy > least))
        return wb_config_refuse(map, "fracture_energy_N_mm",
                                "%g N/mm is not more than the %g N/mm it takes to reach %g MPa",
                                damage->fracture_energy / WB_N_PER_MM, least / WB_N_PER_MM,
                                strength / WB_MPA);
    return WB_OK;
}

static enum wb_status read_damage(struct wb_bundle_interface *interface,
                                  const struct wb_config_node *map)
{
    struct wb_bundle_damage *const damage = &interface->damage;
    const struct wb_config_key keys[] = {
        WB_CONFIG_NUMBER("strength_MPa", &damage->strength, WB_MPA, 1e-6, 1e6),
        WB_CONFIG_OPTIONAL_NUMBER("shear_strength_MPa", &damage->shear_strength, WB_MPA, 1e-6, 1e6),
        WB_CONFIG_NUMBER("fracture_energy_N_mm", &damage->fracture_energy, WB_N_PER_MM, 1e-9, 1e6),
    };
    WB_TRY(wb_config_map(map, keys, WB_COUNT(keys)));
    if (damage->shear_strength == 0.0)
        damage->shear_strength = damage->strength;
    interface->has_damage = true;
    WB_TRY(check_energy(map, damage->strength, interface->normal_stiffness, damage));
    return check_energy(map, damage->shear_strength, interface->shear_stiffness, damage);
}

static enum wb_status read_interface(struct wb_bundle_model *model,
                                     const struct wb_config_node *map)
{
    struct wb_bundle_interface *const interface = &model->interface;
    const struct wb_config_node *friction, *damage;
    double share = 1.0 / 3.0;
    struct wb_config_key keys[4] = {
        WB_CONFIG_OPTIONAL_NUMBER("shear_to_normal_stiffness", &share, 1.0, 1e-6, 1e3),
        WB_CONFIG_OPTIONAL_NODE("damage", &damage),
        WB_CONFIG_NODE("friction", &friction),
    };
    (void)wb_setting_keys(&cohesion_table, 0, interface, keys + 3);
    WB_TRY(wb_config_map(map, keys, WB_COUNT(keys)));
    interface->shear_stiffness = share * interface->normal_stiffness;
    WB_TRY(wb_setting_read_list(wb_bundle_model_friction_setting, friction, interface));
    return damage ? read_damage(interface, damage) : WB_OK;
}

/* --- ends, meshes, run, loads --- */

static enum wb_status read_ends(struct wb_bundle_model *model, const struct wb_config_node *map)
{
    const struct wb_config_key keys[] = {
        WB_CONFIG_OPTIONAL_NUMBER("potted_mm", &model->potted_length, WB_MM, 0.0, 1e6),
        WB_CONFIG_OPTIONAL_CHOICE("tip", &model->tip, tips),
    };
    WB_TRY(wb_config_map(map, keys, WB_COUNT(keys)));
    if (!(model->potted_length < 0.5 * model->length))
        return wb_config_refuse(map, "potted_mm", "%g mm is not less than half of length_mm, %g mm",
                                model->potted_length / WB_MM, model->length / WB_MM);
    return WB_OK;
}

static enum wb_status read_mesh(void *into, const struct wb_config_node *map)
{
    struct wb_bundle_model *const model = into;
    struct wb_bundle_mesh *const mesh = &model->mesh[model->n_meshes];
    const struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("name", mesh->name),
        WB_CONFIG_INTEGER("core_quads", &mesh->core_quads, 2, 32),
        WB_CONFIG_INTEGER("rings", &mesh->rings, 0, 32),
        WB_CONFIG_INTEGER("elements_along", &mesh->elements_along, 2, 100000),
        WB_CONFIG_OPTIONAL_INTEGER("tape_quads", &mesh->tape_quads, 6, 100000),
        WB_CONFIG_OPTIONAL_CHOICE("formulation", &mesh->formulation, formulations),
    };
    WB_TRY(wb_config_map(map, keys, WB_COUNT(keys)));
    WB_TRY(wb_model_file_check_name(map, mesh->name));
    if (wb_bundle_model_mesh(model, mesh->name))
        return wb_config_refuse(map, "name", "another mesh has the name %s", mesh->name);
    if (mesh->core_quads % 2 != 0)
        return wb_config_refuse(map, "core_quads", "%d is not even", mesh->core_quads);
    model->n_meshes++;
    return WB_OK;
}

static enum wb_status read_run(struct reader *reader, const struct wb_config_node *map)
{
    struct wb_bundle_model *const m = reader->model;
    struct wb_bundle_run *const run = &m->run;
    struct wb_config_key keys[WB_BUNDLE_MODEL_RUN_SETTINGS];
    const size_t n = wb_setting_keys(&run_table, 0, run, keys);
    if (map)
        WB_TRY(wb_config_map(map, keys, n));
    if (!wb_bundle_model_mesh(m, run->mesh))
        return wb_config_refuse(map, "mesh", "there is no mesh %s", run->mesh);
    if (run->deflection < m->length)
        return WB_OK;
    return wb_config_refuse(map ? map : reader->file.root, "deflection_mm",
                            "%g mm cannot be reached by a bundle of %g mm", run->deflection / WB_MM,
                            m->length / WB_MM);
}

static enum wb_status read_loads(struct wb_bundle_loads *loads, const struct wb_config_node *map)
{
    struct wb_config_key keys[WB_COUNT(loads_rows)];
    return wb_config_map(map, keys, wb_setting_keys(&loads_table, 0, loads, keys));
}

static enum wb_status read_published(struct reader *reader, const struct wb_config_node *map)
{
    struct wb_bundle_published *const published = &reader->model->published;
    char beam[64] = "";
    const struct wb_config_key keys[] = {
        WB_CONFIG_NUMBER("outer_diameter_mm", &published->outer_diameter, WB_MM, 1e-3, 1e3),
        WB_CONFIG_NUMBER("density_g_cm3", &published->density, WB_G_PER_CM3, 1e-3, 30.0),
        WB_CONFIG_OPTIONAL_TEXT("beam", beam),
    };
    WB_TRY(wb_config_map(map, keys, WB_COUNT(keys)));
    reader->model->has_published = true;
    if (*beam == '\0')
        return WB_OK;
    WB_TRY(find_wire(reader, map, "beam", beam, &published->beam));
    published->has_beam = true;
    return WB_OK;
}

/* --- the whole --- */

/* Blocks that are read after the section. */
struct root_nodes {
    const struct wb_config_node *interface, *ends, *meshes, *run, *loads, *published, *uncertainty;
};

static enum wb_status read_nodes(struct reader *reader, const struct root_nodes *nodes)
{
    struct wb_bundle_model *const m = reader->model;
    WB_TRY(read_interface(m, nodes->interface));
    if (nodes->ends)
        WB_TRY(read_ends(m, nodes->ends));
    if (nodes->meshes)
        WB_TRY(wb_model_file_list(reader->file.root, "meshes", nodes->meshes,
                                  WB_BUNDLE_MODEL_MESHES, read_mesh, m));
    WB_TRY(read_run(reader, nodes->run));
    WB_TRY(read_loads(&m->loads, nodes->loads));
    if (nodes->published)
        WB_TRY(read_published(reader, nodes->published));
    m->has_uncertainty = nodes->uncertainty != NULL;
    return m->has_uncertainty ? wb_bundle_uncertainty_read(&m->uncertainty, nodes->uncertainty)
                              : WB_OK;
}

static enum wb_status read_root(struct reader *reader)
{
    struct wb_bundle_model *const m = reader->model;
    struct section_nodes section = {0};
    struct root_nodes nodes = {0};
    const struct wb_config_key keys[] = {
        WB_CONFIG_OPTIONAL_BOOLEAN("settled", &m->settled),
        WB_CONFIG_TEXT("name", m->name),
        WB_CONFIG_OPTIONAL_TEXT("title", m->title),
        WB_CONFIG_OPTIONAL_TEXT("notes", m->notes),
        WB_CONFIG_NODE("wires", &section.wires),
        WB_CONFIG_CHOICE("packing", &m->arrangement, packings),
        WB_CONFIG_OPTIONAL_NODE("places_mm", &section.places),
        WB_CONFIG_OPTIONAL_NUMBER("touching_mm", &m->touching, WB_MM, 0.0, 1.0),
        WB_CONFIG_OPTIONAL_NODE("search", &section.search),
        WB_CONFIG_OPTIONAL_NODE("gaps", &section.gaps),
        WB_CONFIG_OPTIONAL_TEXT("tape", section.tape),
        WB_CONFIG_OPTIONAL_NODE("taping", &section.taping),
        WB_CONFIG_NUMBER("length_mm", &m->length, WB_MM, 1e-3, 1e6),
        WB_CONFIG_OPTIONAL_CHOICE("length_source", &m->length_source, length_sources),
        WB_CONFIG_NODE("interface", &nodes.interface),
        WB_CONFIG_OPTIONAL_NODE("ends", &nodes.ends),
        WB_CONFIG_OPTIONAL_NODE("meshes", &nodes.meshes),
        WB_CONFIG_OPTIONAL_NODE("run", &nodes.run),
        WB_CONFIG_NODE("loads", &nodes.loads),
        WB_CONFIG_OPTIONAL_NODE("published", &nodes.published),
        WB_CONFIG_OPTIONAL_NODE("uncertainty", &nodes.uncertainty),
    };
    WB_TRY(wb_config_map(reader->file.root, keys, WB_COUNT(keys)));
    WB_TRY(wb_model_file_check_name(reader->file.root, m->name));
    section.has_settled = wb_config_find(reader->file.root, "settled");
    WB_TRY(read_section(reader, &section));
    return read_nodes(reader, &nodes);
}

static void set_defaults(struct wb_bundle_model *model)
{
    memcpy(model->mesh, own_meshes, sizeof own_meshes);
    model->n_meshes = (int)WB_COUNT(own_meshes);
    wb_setting_fill(&run_table, &model->run);
    strcpy(model->run.mesh, own_meshes[0].name);
}

static enum wb_status read_all(struct reader *reader, const char *path)
{
    struct wb_bundle_model *const m = reader->model;
    set_defaults(m);
    WB_TRY(wb_file_join(m->path, "", path));
    WB_TRY(wb_model_file_open(&reader->file, path));
    return read_root(reader);
}

enum wb_status wb_bundle_model_read(struct wb_bundle_model *model, const char *path)
{
    return wb_bundle_model_read_variant(model, path, NULL);
}

enum wb_status wb_bundle_model_read_variant(struct wb_bundle_model *model, const char *path,
                                            const struct wb_bundle_variant *variant)
{
    struct wb_bundle_model *const read = wb_memory_new(1, sizeof *read);
    struct reader reader = {.model = read, .variant = variant};
    const enum wb_status status = read_all(&reader, path);
    wb_model_file_close(&reader.file);
    if (status == WB_OK)
        *model = *read;
    free(read);
    return status;
}
