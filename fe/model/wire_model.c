#include "fe/model/wire_model.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/circle.h"
#include "base/config.h"
#include "base/units.h"
#include "base/vec3.h"
#include "fe/material/material_file.h"
#include "fe/model/model_file.h"

#define WB_LOG_DOMAIN "model"

enum {
    DEFAULT_ELEMENTS = 60,
    DEFAULT_DENSITY = 1,
    DEFAULT_ROWS = 10,
    MOST_ROWS = 10000
};

static const char *const laws[] = {"elastic", "elastoplastic", NULL};
static const char *const clamps[] = {"plane", "fixed", NULL};
static const char *const integrations[] = {"selective", "reduced", NULL};

/* State while a model is read. */
struct reader {
    struct wb_wire_model *model;
    struct wb_model_file file;
};

static enum wb_status read_triple(const struct wb_config_node *sequence, const char *name,
                                  double limit, double values[3])
{
    const struct wb_config_key key = {
        .name = name, .factor = 1.0, .minimum = -limit, .maximum = limit};
    int n;
    return wb_config_numbers(sequence, &key, 3, 3, values, &n);
}

/* --- parts --- */

static enum wb_status check_material(const struct reader *reader, const struct wb_config_node *map,
                                     const char *key, const struct wb_material_file *file)
{
    if (!isfinite(file->material.poissons_ratio))
        return wb_config_refuse(map, key, "material %s has no poissons_ratio", file->name);
    if (!reader->model->is_elastic && file->material.hardening == WB_HARDENING_NONE_ELASTIC)
        return wb_config_refuse(map, key,
                                "material %s has no yield_stress_MPa, which law elastoplastic "
                                "needs",
                                file->name);
    return WB_OK;
}

static enum wb_status read_part(void *into, const struct wb_config_node *map)
{
    struct reader *const reader = into;
    const int index = reader->model->n_parts;
    struct wb_wire_model_part *const part = &reader->model->part[index];
    char material[WB_PATH], path[WB_PATH]; /* a name, or a path */
    const struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("name", part->name),
        WB_CONFIG_NUMBER("outer_diameter_mm", &part->outer_diameter, WB_MM, 1e-3, 1e3),
        WB_CONFIG_TEXT("material", material),
    };
    struct wb_material_file file;

    WB_TRY(wb_config_map(map, keys, WB_COUNT(keys)));
    WB_TRY(wb_model_file_check_name(map, part->name));
    part->inner_diameter = index == 0 ? 0.0 : reader->model->part[index - 1].outer_diameter;
    if (!(part->outer_diameter > part->inner_diameter))
        return wb_config_refuse(map, "outer_diameter_mm",
                                "expected more than the %g mm of the part before",
                                part->inner_diameter / WB_MM);
    for (int i = 0; i < index; i++)
        if (strcmp(part->name, reader->model->part[i].name) == 0)
            return wb_config_refuse(map, "name", "another part has the name %s", part->name);

    WB_TRY(wb_model_file_find(&reader->file, map, "material", "materials", material, path));
    WB_TRY(wb_material_file_read(&file, path));
    WB_TRY(check_material(reader, map, "material", &file));
    part->material = file.material;
    part->density = file.density;
    part->is_substitute = file.is_substitute;
    snprintf(part->material_name, sizeof part->material_name, "%s", file.name);
    snprintf(part->source, sizeof part->source, "%s", file.source);
    reader->model->n_parts++;
    return WB_OK;
}

static enum wb_status read_parts(struct reader *reader, const struct wb_config_node *parts)
{
    struct wb_wire_model *const m = reader->model;
    WB_TRY(wb_model_file_list(reader->file.root, "parts", parts, WB_WIRE_MODEL_PARTS, read_part,
                              reader));
    const int n = m->n_parts;
    if (!(fabs(m->part[n - 1].outer_diameter - m->wire.outer_diameter) <=
          1e-9 * m->wire.outer_diameter))
        return wb_config_refuse(wb_config_item(parts, n - 1), "outer_diameter_mm",
                                "%g mm is the outermost part's, but wire %s has %g mm",
                                m->part[n - 1].outer_diameter / WB_MM, m->wire.name,
                                m->wire.outer_diameter / WB_MM);
    return WB_OK;
}

/* One full circle with the wire's own properties. */
static enum wb_status take_homogenised(struct reader *reader)
{
    struct wb_wire_model *const m = reader->model;
    struct wb_wire_model_part *const part = &m->part[0];
    WB_TRY(wb_model_file_check_wire(reader->file.root, "wire", &m->wire,
                                    ", and the model has no parts"));
    m->is_homogenised = true;
    m->n_parts = 1;
    part->outer_diameter = m->wire.outer_diameter;
    part->material = m->wire.material;
    part->density = m->wire.density;
    snprintf(part->name, sizeof part->name, "wire");
    snprintf(part->material_name, sizeof part->material_name, "%s", m->wire.name);
    snprintf(part->source, sizeof part->source, "%s", m->wire.source);
    return WB_OK;
}

static enum wb_status read_jacket_contact(struct reader *reader, const struct wb_config_node *map)
{
    struct wb_wire_model *const m = reader->model;
    double friction = 0.0, normal_stiffness = 0.0;
    const struct wb_config_key keys[] = {
        WB_CONFIG_NUMBER("friction", &friction, 1.0, 0.0, 10.0),
        WB_CONFIG_OPTIONAL_NUMBER("normal_stiffness_N_mm3", &normal_stiffness, WB_N_PER_MM3, 1e-3,
                                  1e9),
    };

    WB_TRY(wb_config_map(map, keys, WB_COUNT(keys)));
    if (m->n_parts != 2)
        return wb_config_refuse(reader->file.root, "interface",
                                "a wire of one part has no interface");
    const struct wb_wire_model_part *const jacket = &m->part[1];
    wb_trial_default_jacket_contact(
        &m->jacket_contact, jacket->material.youngs_modulus, jacket->material.poissons_ratio,
        0.5 * (jacket->outer_diameter - jacket->inner_diameter), friction);
    if (normal_stiffness > 0.0) {
        m->jacket_contact.tangential_stiffness *=
            normal_stiffness / m->jacket_contact.normal_stiffness;
        m->jacket_contact.normal_stiffness = normal_stiffness;
    }
    m->has_contact = true;
    return WB_OK;
}

static enum wb_status read_mesh(struct wb_wire_model *model, const struct wb_config_node *map)
{
    const struct wb_config_key keys[] = {
        WB_CONFIG_OPTIONAL_INTEGER("elements_along", &model->elements_along, 1, 10000),
        WB_CONFIG_OPTIONAL_INTEGER("section_density", &model->section_density, 1, 16),
        WB_CONFIG_OPTIONAL_CHOICE("integration", &model->integration, integrations),
    };
    return wb_config_map(map, keys, WB_COUNT(keys));
}

static enum wb_status read_sections(struct wb_wire_model *model, const struct wb_config_node *list)
{
    const struct wb_config_key key = {
        .name = "fields_at_mm", .factor = WB_MM, .minimum = 0.0, .maximum = model->length / WB_MM};
    WB_TRY(wb_config_numbers(list, &key, 1, WB_WIRE_MODEL_SECTIONS, model->section,
                             &model->n_sections));
    for (int i = 1; i < model->n_sections; i++)
        if (!(model->section[i] > model->section[i - 1]))
            return wb_config_refuse(list, "fields_at_mm", "expected ascending positions");
    return WB_OK;
}

/* --- loading steps --- */

/* State at the beginning of a loading step. */
struct standing {
    struct wb_tip_loads loads;
    bool held;         /* at a deflection */
    double deflection; /* m, when held */
};

static bool is_zero(const double vector[3])
{
    return vector[0] == 0.0 && vector[1] == 0.0 && vector[2] == 0.0;
}

/* +1: the load grows; -1: it decreases or is reversed; 0: it is constant. */
static int growth(const double from[3], const double to[3])
{
    if (from[0] == to[0] && from[1] == to[1] && from[2] == to[2])
        return 0;
    return wb_vec3_dot(to, to) < wb_vec3_dot(from, from) || wb_vec3_dot(from, to) < 0.0 ? -1 : 1;
}

static bool loads_unload(const struct wb_tip_loads *from, const struct wb_tip_loads *to)
{
    const int change[] = {growth(from->force, to->force), growth(from->moment, to->moment),
                          growth(from->follower, to->follower)};
    bool less = false;
    for (int i = 0; i < 3; i++) {
        if (change[i] > 0)
            return false;
        less = less || change[i] < 0;
    }
    return less;
}

/* The keys that define a step's action. */
struct action {
    const struct wb_config_node *force, *moment, *follower;
    bool unload, release;
    double deflection; /* NaN: not given */
};

static enum wb_status refuse_false(const struct wb_config_node *map, const char *key, bool value)
{
    if (wb_config_find(map, key) && !value)
        return wb_config_refuse(map, key, "expected true, or omit the key");
    return WB_OK;
}

static enum wb_status check_action(const struct wb_config_node *map, const struct action *action)
{
    WB_TRY(refuse_false(map, "unload", action->unload));
    WB_TRY(refuse_false(map, "release", action->release));
    const int n = (action->force != NULL) + (action->moment != NULL) + (action->follower != NULL) +
                  action->unload + action->release + !isnan(action->deflection);
    if (n != 1)
        return wb_config_refuse(map, NULL,
                                "a step has exactly one of force_N, moment_Nm, follower_N, unload, "
                                "deflection_mm, release; this one has %d",
                                n);
    return WB_OK;
}

static enum wb_status take_loads(const struct wb_config_node *map, const struct action *action,
                                 const struct standing *standing, struct wb_wire_step *step)
{
    const struct wb_tip_loads *const before = &standing->loads;
    if (standing->held)
        return wb_config_refuse(
            map, NULL, "a deflection is held; only another deflection or release can follow");
    step->kind = WB_WIRE_STEP_LOADS;
    if (action->force)
        WB_TRY(read_triple(action->force, "force_N", 1e6, step->loads.force));
    if (action->moment)
        WB_TRY(read_triple(action->moment, "moment_Nm", 1e6, step->loads.moment));
    if (action->follower)
        WB_TRY(read_triple(action->follower, "follower_N", 1e6, step->loads.follower));
    if (action->unload) {
        if (is_zero(before->force) && is_zero(before->moment) && is_zero(before->follower))
            return wb_config_refuse(map, "unload", "nothing acts at the tip before this step");
        step->loads = (struct wb_tip_loads){0};
    }
    step->unloads = loads_unload(before, &step->loads);
    return WB_OK;
}

static enum wb_status take_deflection(const struct wb_config_node *map,
                                      const struct wb_wire_model *model,
                                      const struct action *action, struct standing *standing,
                                      struct wb_wire_step *step)
{
    step->kind = WB_WIRE_STEP_DEFLECTION;
    step->deflection = action->deflection;
    if (!(fabs(step->deflection) < model->length))
        return wb_config_refuse(map, "deflection_mm", "%g mm cannot be reached by a wire of %g mm",
                                step->deflection / WB_MM, model->length / WB_MM);
    const double before = standing->held ? standing->deflection : 0.0;
    step->unloads = fabs(step->deflection) < fabs(before) || before * step->deflection < 0.0;
    standing->held = true;
    standing->deflection = step->deflection;
    return WB_OK;
}

static enum wb_status take_release(const struct wb_config_node *map, struct standing *standing,
                                   struct wb_wire_step *step)
{
    if (!standing->held)
        return wb_config_refuse(map, "release", "no deflection is held before this step");
    step->kind = WB_WIRE_STEP_RELEASE;
    step->unloads = true;
    standing->held = false;
    return WB_OK;
}

static enum wb_status read_step(struct wb_wire_model *model, const struct wb_config_node *map,
                                struct standing *standing, struct wb_wire_step *step)
{
    struct action action = {.deflection = (double)NAN};
    const struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("name", step->name),
        WB_CONFIG_OPTIONAL_NODE("force_N", &action.force),
        WB_CONFIG_OPTIONAL_NODE("moment_Nm", &action.moment),
        WB_CONFIG_OPTIONAL_NODE("follower_N", &action.follower),
        WB_CONFIG_OPTIONAL_BOOLEAN("unload", &action.unload),
        WB_CONFIG_OPTIONAL_NUMBER("deflection_mm", &action.deflection, WB_MM, -1e6, 1e6),
        WB_CONFIG_OPTIONAL_BOOLEAN("release", &action.release),
        WB_CONFIG_OPTIONAL_INTEGER("rows", &step->rows, 1, MOST_ROWS),
        WB_CONFIG_OPTIONAL_BOOLEAN("fields", &step->fields),
    };
    step->rows = DEFAULT_ROWS;
    step->loads = standing->loads;

    WB_TRY(wb_config_map(map, keys, WB_COUNT(keys)));
    WB_TRY(wb_model_file_check_name(map, step->name));
    WB_TRY(check_action(map, &action));
    if (!isnan(action.deflection))
        WB_TRY(take_deflection(map, model, &action, standing, step));
    else if (action.release)
        WB_TRY(take_release(map, standing, step));
    else
        WB_TRY(take_loads(map, &action, standing, step));
    standing->loads = step->loads;
    return WB_OK;
}

static enum wb_status read_loading_steps(struct reader *reader, const struct wb_config_node *list)
{
    struct wb_wire_model *const m = reader->model;
    struct standing standing = {0};
    bool deflects = false;
    const int n = wb_config_length(list);
    if (n < 1 || n > WB_WIRE_MODEL_STEPS)
        return wb_config_refuse(reader->file.root, "history", "expected a list of 1 to %d steps",
                                WB_WIRE_MODEL_STEPS);
    for (int i = 0; i < n; i++) {
        const struct wb_config_node *const map = wb_config_item(list, i);
        WB_TRY(read_step(m, map, &standing, &m->step[i]));
        for (int k = 0; k < i; k++)
            if (strcmp(m->step[i].name, m->step[k].name) == 0)
                return wb_config_refuse(map, "name", "another step has the name %s",
                                        m->step[i].name);
        deflects = deflects || m->step[i].kind == WB_WIRE_STEP_DEFLECTION;
    }
    m->n_steps = n;
    if (m->strand_length > 0.0 && !deflects)
        return wb_config_refuse(reader->file.root, "strand_mm",
                                "no step of the history prescribes a deflection");
    return WB_OK;
}

/* --- the whole --- */

static enum wb_status read_root(struct reader *reader)
{
    struct wb_wire_model *const m = reader->model;
    const struct wb_config_node *parts, *interface, *gravity, *mesh, *sections, *history;
    char wire[WB_PATH]; /* a name, or a path */
    int law;
    const struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("name", m->name),
        WB_CONFIG_TEXT("title", m->title),
        WB_CONFIG_OPTIONAL_TEXT("notes", m->notes),
        WB_CONFIG_TEXT("wire", wire),
        WB_CONFIG_NUMBER("length_mm", &m->length, WB_MM, 1e-3, 1e6),
        WB_CONFIG_CHOICE("law", &law, laws),
        WB_CONFIG_OPTIONAL_NODE("parts", &parts),
        WB_CONFIG_OPTIONAL_NODE("interface", &interface),
        WB_CONFIG_OPTIONAL_CHOICE("clamp", &m->clamp, clamps),
        WB_CONFIG_NODE("gravity", &gravity),
        WB_CONFIG_OPTIONAL_NUMBER("strand_mm", &m->strand_length, WB_MM, 1e-3, 1e9),
        WB_CONFIG_OPTIONAL_NODE("mesh", &mesh),
        WB_CONFIG_OPTIONAL_NODE("fields_at_mm", &sections),
        WB_CONFIG_NODE("history", &history),
    };

    WB_TRY(wb_config_map(reader->file.root, keys, WB_COUNT(keys)));
    WB_TRY(wb_model_file_check_name(reader->file.root, m->name));
    m->is_elastic = law == 0;
    WB_TRY(wb_model_file_wire(&reader->file, reader->file.root, "wire", wire, &m->wire));
    if (parts)
        WB_TRY(read_parts(reader, parts));
    else
        WB_TRY(take_homogenised(reader));
    if (interface)
        WB_TRY(read_jacket_contact(reader, interface));
    WB_TRY(read_triple(gravity, "gravity", 1e4, m->gravity));
    if (mesh)
        WB_TRY(read_mesh(m, mesh));
    if (sections)
        WB_TRY(read_sections(m, sections));
    return read_loading_steps(reader, history);
}

static enum wb_status read_all(struct reader *reader, const char *path)
{
    struct wb_wire_model *const m = reader->model;
    m->elements_along = DEFAULT_ELEMENTS;
    m->section_density = DEFAULT_DENSITY;
    WB_TRY(wb_file_join(m->path, "", path));
    WB_TRY(wb_model_file_open(&reader->file, path));
    WB_TRY(read_root(reader));
    for (int i = 0; i < m->n_parts && m->is_elastic; i++)
        m->part[i].material.hardening = WB_HARDENING_NONE_ELASTIC;
    return WB_OK;
}

enum wb_status wb_wire_model_read(struct wb_wire_model *model, const char *path)
{
    struct wb_wire_model read = {0};
    struct reader reader = {.model = &read};
    const enum wb_status status = read_all(&reader, path);
    wb_model_file_close(&reader.file);
    if (status == WB_OK)
        *model = read;
    return status;
}

/* --- derived properties --- */

bool wb_wire_model_is_follower(const struct wb_wire_model *model)
{
    bool any = false;
    for (int i = 0; i < model->n_steps; i++) {
        const struct wb_wire_step *const step = &model->step[i];
        const double *const follower = step->loads.follower;
        if (step->kind != WB_WIRE_STEP_LOADS || !is_zero(step->loads.force) ||
            !is_zero(step->loads.moment) || follower[0] != 0.0 || follower[2] != 0.0)
            return false;
        any = any || follower[1] != 0.0;
    }
    return any;
}

/* A force that is compared over the deflection must be zero at zero deflection; with weight this
 * holds only for a test that begins there. */
static bool step_bends(const struct wb_wire_model *model, const struct wb_wire_step *step)
{
    const struct wb_tip_loads *const loads = &step->loads;
    if (!is_zero(loads->moment) || !is_zero(loads->follower) || loads->force[0] != 0.0 ||
        loads->force[2] != 0.0)
        return false;
    if (step->kind == WB_WIRE_STEP_LOADS)
        return model->step[0].kind == WB_WIRE_STEP_LOADS && model->gravity[1] == 0.0;
    return model->step[0].kind != WB_WIRE_STEP_LOADS && is_zero(loads->force);
}

bool wb_wire_model_is_bending_test(const struct wb_wire_model *model)
{
    if (model->gravity[0] != 0.0 || model->gravity[2] != 0.0)
        return false;
    if (wb_wire_model_is_follower(model))
        return true;
    for (int i = 0; i < model->n_steps; i++)
        if (!step_bends(model, &model->step[i]))
            return false;
    return true;
}

static double area(const struct wb_wire_model_part *part)
{
    return M_PI / 4.0 *
           (part->outer_diameter * part->outer_diameter -
            part->inner_diameter * part->inner_diameter);
}

double wb_wire_model_mass_per_length(const struct wb_wire_model *model)
{
    double sum = 0.0;
    for (int i = 0; i < model->n_parts; i++)
        sum += model->part[i].density * area(&model->part[i]);
    return sum;
}

static double outer_diameter(const struct wb_wire_model *model)
{
    return model->part[model->n_parts - 1].outer_diameter;
}

/* Sum of E I over the parts, N m2. */
static double flexural_rigidity(const struct wb_wire_model *model)
{
    double sum = 0.0;
    for (int i = 0; i < model->n_parts; i++) {
        const struct wb_wire_model_part *const part = &model->part[i];
        sum += part->material.youngs_modulus * (wb_circle_second_moment(part->outer_diameter) -
                                                wb_circle_second_moment(part->inner_diameter));
    }
    return sum;
}

double wb_wire_model_youngs_modulus(const struct wb_wire_model *model)
{
    return flexural_rigidity(model) / wb_circle_second_moment(outer_diameter(model));
}

double wb_wire_model_poissons_ratio(const struct wb_wire_model *model)
{
    double sum = 0.0, total = 0.0;
    for (int i = 0; i < model->n_parts; i++) {
        sum += model->part[i].material.poissons_ratio * area(&model->part[i]);
        total += area(&model->part[i]);
    }
    return sum / total;
}
