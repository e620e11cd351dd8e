/* Reading of bundle files: wb_bundle_model_read() of fe/model/bundle_model.h. */
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/config.h"
#include "base/file.h"
#include "base/text.h"
#include "base/units.h"
#include "fe/model/bundle_model_private.h"

#define WB_LOG_DOMAIN "bundle"

static const double pa_per_m = 1e9; /* of one N/mm3 */
static const double s_per_m = 1e3;  /* of one s/mm */
static const double j_per_m2 = 1e3; /* of one N/mm */
static const double largest_poisson = 0.499;

static const char *const length_sources[] = {"own", "printed", "inferred", NULL};
static const char *const tips[] = {"free", "capped", NULL};
static const char *const formulations[] = {"2x2x1", "one-point", NULL};
static const char *const precisions[] = {"single", "double", NULL};

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

/* --- names and files --- */

/* Names go into file names and into tables without quotes. */
static enum wb_status check_name(const struct wb_config_node *map, const char *name)
{
    const char *c = name;
    while (isalnum((unsigned char)*c) || (*c && strchr("-_.+", *c)))
        c++;
    if (*name == '\0' || *c != '\0')
        return wb_config_refuse(map, "name", "expected letters, digits, '-', '_', '.', '+' only");
    return WB_OK;
}

/* A part of the checksum, to be counted up whenever files that stay as they are come to mean
 * something else: by defaults, or by what is computed of them. */
static const char meaning[] = "# wirebench bundle files, 2\n";

static enum wb_status keep_text(struct wb_bundle_model_reader *reader, const char *path)
{
    char *bytes;
    size_t size;
    WB_TRY(wb_file_read(path, &bytes, &size));
    wb_text_append_bytes(&reader->texts, bytes, size);
    free(bytes);
    return WB_OK;
}

/* The file that the value of `key` in `map` names. */
enum wb_status wb_bundle_model_find(struct wb_bundle_model_reader *reader,
                                    const struct wb_config_node *map, const char *key,
                                    const char *kind, const char *name, char path[WB_PATH])
{
    char named_in[WB_PATH + 64];
    snprintf(named_in, sizeof named_in, "%s:%d: %s", wb_config_origin(map),
             wb_config_line(wb_config_find(map, key)), key);
    WB_TRY(wb_file_find_named(path, kind, name, reader->folder, named_in));
    return keep_text(reader, path);
}

enum wb_status wb_bundle_model_find_wire(struct wb_bundle_model_reader *reader,
                                         const struct wb_config_node *map, const char *key,
                                         const char *name, struct wb_wire *wire)
{
    char path[WB_PATH];
    WB_TRY(wb_bundle_model_find(reader, map, key, "wires", name, path));
    WB_TRY(wb_wire_read(path, wire));
    if (!wire->has_properties)
        return wb_config_refuse(map, key, "wire %s has no properties", wire->name);
    if (wire->material.poissons_ratio > largest_poisson)
        return wb_config_refuse(map, key, "wire %s has poissons_ratio %g, expected at most %g",
                                wire->name, wire->material.poissons_ratio, largest_poisson);
    return WB_OK;
}

/* --- interface --- */

/* A number, or static and kinetic coefficient with the decay between them. */
static enum wb_status read_friction(struct wb_bundle_interface *interface,
                                    const struct wb_config_node *map)
{
    const struct wb_config_key keys[] = {
        WB_CONFIG_NUMBER("static", &interface->friction_static, 1.0, 0.0, 10.0),
        WB_CONFIG_NUMBER("kinetic", &interface->friction_kinetic, 1.0, 0.0, 10.0),
        WB_CONFIG_NUMBER("decay_s_mm", &interface->friction_decay, s_per_m, 1e-9, 1e9),
    };
    WB_TRY(wb_config_map(map, keys, WB_COUNT(keys)));
    if (interface->friction_kinetic > interface->friction_static)
        return wb_config_refuse(map, "kinetic", "%g is more than static, %g",
                                interface->friction_kinetic, interface->friction_static);
    return WB_OK;
}

/* The law has to soften after it reaches its strength. */
static enum wb_status check_energy(const struct wb_config_node *map, double strength,
                                   double stiffness, const struct wb_bundle_damage *damage)
{
    const double least = 0.5 * strength * strength / stiffness;
    if (!(damage->fracture_energy > least))
        return wb_config_refuse(map, "fracture_energy_N_mm",
                                "%g N/mm is not more than the %g N/mm it takes to reach %g MPa",
                                damage->fracture_energy / j_per_m2, least / j_per_m2,
                                strength / WB_MPA);
    return WB_OK;
}

static enum wb_status read_damage(struct wb_bundle_interface *interface,
                                  const struct wb_config_node *map)
{
    struct wb_bundle_damage *const damage = &interface->damage;
    bool has_shear = false;
    struct wb_config_key keys[] = {
        WB_CONFIG_NUMBER("strength_MPa", &damage->strength, WB_MPA, 1e-6, 1e6),
        WB_CONFIG_OPTIONAL_NUMBER("shear_strength_MPa", &damage->shear_strength, WB_MPA, 1e-6, 1e6),
        WB_CONFIG_NUMBER("fracture_energy_N_mm", &damage->fracture_energy, j_per_m2, 1e-9, 1e6),
    };
    keys[1].present = &has_shear;
    WB_TRY(wb_config_map(map, keys, WB_COUNT(keys)));
    if (!has_shear)
        damage->shear_strength = damage->strength;
    interface->has_damage = true;
    WB_TRY(check_energy(map, damage->strength, interface->normal_stiffness, damage));
    return check_energy(map, damage->shear_strength, interface->shear_stiffness, damage);
}

static enum wb_status read_interface(struct wb_bundle_model *model,
                                     const struct wb_config_node *map)
{
    struct wb_bundle_interface *const interface = &model->interface;
    const struct wb_config_node *friction = wb_config_find(map, "friction"), *damage;
    const bool is_constant = friction && wb_config_scalar(friction);
    double share = 1.0 / 3.0;
    const struct wb_config_key keys[] = {
        WB_CONFIG_NUMBER("cohesive_stiffness_N_mm3", &interface->normal_stiffness, pa_per_m, 1e-6,
                         1e9),
        WB_CONFIG_OPTIONAL_NUMBER("shear_to_normal_stiffness", &share, 1.0, 1e-6, 1e3),
        WB_CONFIG_OPTIONAL_NODE("damage", &damage),
        is_constant ? (struct wb_config_key)WB_CONFIG_NUMBER(
                          "friction", &interface->friction_static, 1.0, 0.0, 10.0)
                    : (struct wb_config_key)WB_CONFIG_NODE("friction", &friction),
    };
    WB_TRY(wb_config_map(map, keys, WB_COUNT(keys)));
    interface->shear_stiffness = share * interface->normal_stiffness;
    interface->friction_kinetic = interface->friction_static;
    if (!is_constant)
        WB_TRY(read_friction(interface, friction));
    return damage ? read_damage(interface, damage) : WB_OK;
}

/* --- ends, meshes, run, loads --- */

static enum wb_status read_ends(struct wb_bundle_model *model, const struct wb_config_node *map)
{
    int tip = 0;
    const struct wb_config_key keys[] = {
        WB_CONFIG_OPTIONAL_NUMBER("potted_mm", &model->potted_length, WB_MM, 0.0, 1e6),
        WB_CONFIG_OPTIONAL_CHOICE("tip", &tip, tips),
    };
    WB_TRY(wb_config_map(map, keys, WB_COUNT(keys)));
    model->tip = tip == 1 ? WB_BUNDLE_TIP_CAPPED : WB_BUNDLE_TIP_FREE;
    if (!(model->potted_length < 0.5 * model->length))
        return wb_config_refuse(map, "potted_mm", "%g mm is not less than half of length_mm, %g mm",
                                model->potted_length / WB_MM, model->length / WB_MM);
    return WB_OK;
}

static enum wb_status read_mesh(struct wb_bundle_model *model, const struct wb_config_node *map)
{
    struct wb_bundle_mesh *const mesh = &model->mesh[model->n_meshes];
    int formulation = 0;
    const struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("name", mesh->name),
        WB_CONFIG_INTEGER("core_quads", &mesh->core_quads, 2, 32),
        WB_CONFIG_INTEGER("rings", &mesh->rings, 0, 32),
        WB_CONFIG_INTEGER("elements_along", &mesh->elements_along, 2, 100000),
        WB_CONFIG_OPTIONAL_INTEGER("tape_quads", &mesh->tape_quads, 6, 100000),
        WB_CONFIG_OPTIONAL_CHOICE("formulation", &formulation, formulations),
    };
    WB_TRY(wb_config_map(map, keys, WB_COUNT(keys)));
    WB_TRY(check_name(map, mesh->name));
    mesh->formulation = formulation == 1 ? WB_BUNDLE_ONE_POINT : WB_BUNDLE_FOUR_POINTS;
    if (wb_bundle_model_mesh(model, mesh->name))
        return wb_config_refuse(map, "name", "another mesh is called %s, too", mesh->name);
    if (mesh->core_quads % 2 != 0)
        return wb_config_refuse(map, "core_quads", "%d is not even", mesh->core_quads);
    model->n_meshes++;
    return WB_OK;
}

static enum wb_status read_meshes(struct wb_bundle_model_reader *reader,
                                  const struct wb_config_node *list)
{
    const int n = wb_config_length(list);
    if (n < 1 || n > WB_BUNDLE_MODEL_MESHES)
        return wb_config_refuse(reader->root, "meshes", "expected a list of 1 to %d meshes",
                                WB_BUNDLE_MODEL_MESHES);
    for (int i = 0; i < n; i++)
        WB_TRY(read_mesh(reader->model, wb_config_item(list, i)));
    return WB_OK;
}

static enum wb_status read_run(struct wb_bundle_model_reader *reader,
                               const struct wb_config_node *map)
{
    struct wb_bundle_model *const m = reader->model;
    struct wb_bundle_run *const run = &m->run;
    int precision = 0;
    const struct wb_config_key keys[] = {
        WB_CONFIG_OPTIONAL_TEXT("mesh", run->mesh),
        WB_CONFIG_OPTIONAL_NUMBER("deflection_mm", &run->deflection, WB_MM, 1e-6, 1e6),
        WB_CONFIG_OPTIONAL_INTEGER("rows", &run->rows, 1, 10000),
        WB_CONFIG_OPTIONAL_INTEGER("cycles", &run->cycles, 0, 1000),
        WB_CONFIG_OPTIONAL_NUMBER("duration_s", &run->duration, 1.0, 1e-6, 1e6),
        WB_CONFIG_OPTIONAL_NUMBER("mass_scaling", &run->mass_scaling, 1.0, 1.0, 1e6),
        WB_CONFIG_OPTIONAL_NUMBER("selective_mass_scaling", &run->selective, 1.0, 1.0, 1e6),
        WB_CONFIG_OPTIONAL_NUMBER("kinetic_energy_limit", &run->kinetic_limit, 1.0, 1e-6, 1.0),
        WB_CONFIG_OPTIONAL_CHOICE("precision", &precision, precisions),
    };
    if (map)
        WB_TRY(wb_config_map(map, keys, WB_COUNT(keys)));
    run->double_precision = precision == 1;
    if (!wb_bundle_model_mesh(m, run->mesh))
        return wb_config_refuse(map, "mesh", "there is no mesh %s", run->mesh);
    if (run->deflection < m->length)
        return WB_OK;
    return wb_config_refuse(map ? map : reader->root, "deflection_mm",
                            "%g mm cannot be reached by a bundle of %g mm", run->deflection / WB_MM,
                            m->length / WB_MM);
}

static enum wb_status read_loads(struct wb_bundle_loads *loads, const struct wb_config_node *map)
{
    struct wb_config_key keys[] = {
        WB_CONFIG_OPTIONAL_NUMBER("strand_mm", &loads->strand_length, WB_MM, 1e-3, 1e9),
        WB_CONFIG_OPTIONAL_BOOLEAN("weight", &loads->weight),
    };
    keys[1].optional = false;
    return wb_config_map(map, keys, WB_COUNT(keys));
}

static enum wb_status read_published(struct wb_bundle_model_reader *reader,
                                     const struct wb_config_node *map)
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
    WB_TRY(wb_bundle_model_find_wire(reader, map, "beam", beam, &published->beam));
    published->has_beam = true;
    return WB_OK;
}

/* --- the whole --- */

/* Values that are nodes until the others are known. */
struct root_nodes {
    const struct wb_config_node *interface, *ends, *meshes, *run, *loads, *published;
};

static enum wb_status read_nodes(struct wb_bundle_model_reader *reader,
                                 const struct root_nodes *nodes)
{
    struct wb_bundle_model *const m = reader->model;
    WB_TRY(read_interface(m, nodes->interface));
    if (nodes->ends)
        WB_TRY(read_ends(m, nodes->ends));
    if (nodes->meshes)
        WB_TRY(read_meshes(reader, nodes->meshes));
    WB_TRY(read_run(reader, nodes->run));
    WB_TRY(read_loads(&m->loads, nodes->loads));
    return nodes->published ? read_published(reader, nodes->published) : WB_OK;
}

static enum wb_status read_root(struct wb_bundle_model_reader *reader)
{
    struct wb_bundle_model *const m = reader->model;
    struct wb_bundle_model_section section = {0};
    struct root_nodes nodes = {0};
    int packing, length_source = 0;
    struct wb_config_key keys[] = {
        WB_CONFIG_OPTIONAL_BOOLEAN("settled", &m->settled),
        WB_CONFIG_TEXT("name", m->name),
        WB_CONFIG_OPTIONAL_TEXT("title", m->title),
        WB_CONFIG_OPTIONAL_TEXT("notes", m->notes),
        WB_CONFIG_NODE("wires", &section.wires),
        WB_CONFIG_CHOICE("packing", &packing, wb_bundle_model_packings),
        WB_CONFIG_OPTIONAL_NODE("places_mm", &section.places),
        WB_CONFIG_OPTIONAL_NODE("search", &section.search),
        WB_CONFIG_OPTIONAL_NODE("gaps", &section.gaps),
        WB_CONFIG_OPTIONAL_TEXT("tape", section.tape),
        WB_CONFIG_OPTIONAL_NODE("taping", &section.taping),
        WB_CONFIG_NUMBER("length_mm", &m->length, WB_MM, 1e-3, 1e6),
        WB_CONFIG_OPTIONAL_CHOICE("length_source", &length_source, length_sources),
        WB_CONFIG_NODE("interface", &nodes.interface),
        WB_CONFIG_OPTIONAL_NODE("ends", &nodes.ends),
        WB_CONFIG_OPTIONAL_NODE("meshes", &nodes.meshes),
        WB_CONFIG_OPTIONAL_NODE("run", &nodes.run),
        WB_CONFIG_NODE("loads", &nodes.loads),
        WB_CONFIG_OPTIONAL_NODE("published", &nodes.published),
    };
    keys[0].present = &section.has_settled;

    WB_TRY(wb_config_map(reader->root, keys, WB_COUNT(keys)));
    WB_TRY(check_name(reader->root, m->name));
    m->arrangement = (enum wb_bundle_packing)packing;
    m->length_source = (enum wb_bundle_length_source)length_source;
    WB_TRY(wb_bundle_model_read_section(reader, &section));
    return read_nodes(reader, &nodes);
}

static void set_defaults(struct wb_bundle_model *model)
{
    memcpy(model->mesh, own_meshes, sizeof own_meshes);
    model->n_meshes = (int)WB_COUNT(own_meshes);
    model->run = (struct wb_bundle_run){.mesh = "engineering",
                                        .deflection = 53.0 * WB_MM,
                                        .rows = 53,
                                        .mass_scaling = 25.0,
                                        .selective = 1.0,
                                        .kinetic_limit = 0.05};
}

static enum wb_status read_all(struct wb_bundle_model_reader *reader, const char *path)
{
    struct wb_bundle_model *const m = reader->model;
    struct wb_config *config;
    set_defaults(m);
    WB_TRY(wb_file_join(m->path, "", path));
    wb_file_folder(reader->folder, path);
    WB_TRY(wb_config_read(&config, path));
    reader->root = wb_config_root(config);
    enum wb_status status = keep_text(reader, path);
    if (status == WB_OK)
        status = read_root(reader);
    wb_config_destroy(config);
    WB_TRY(status);
    wb_text_append(&reader->texts, "%s", meaning);
    if (reader->texts.failed)
        return wb_fail(WB_ERR_MEMORY, "out of memory reading '%s'", path);
    wb_hash_bytes(wb_text_string(&reader->texts), reader->texts.length, m->sha256);
    return WB_OK;
}

enum wb_status wb_bundle_model_read(struct wb_bundle_model *model, const char *path)
{
    struct wb_bundle_model *const read = calloc(1, sizeof *read);
    if (!read)
        return wb_fail(WB_ERR_MEMORY, "out of memory reading '%s'", path);
    struct wb_bundle_model_reader reader = {.model = read};
    const enum wb_status status = read_all(&reader, path);
    wb_text_release(&reader.texts);
    if (status == WB_OK)
        *model = *read;
    free(read);
    return status;
}
