#include "analysis/harness/harness_gltf.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/keys/common.h"
#include "analysis/plot/palette.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "fe/output/gltf_file.h"
#include "fe/rod/rod_element.h"

enum {
    AROUND = WB_HARNESS_GLTF_AROUND,
    CORNERS = 4, /* of a face of a box */
    FACES = 6
};

/* Materials by their index in the file. */
enum material {
    WIRE, /* coloured at its vertices */
    ROOT,
    CONNECTOR,
    CLIP,
    MATERIALS
};

/* A branch's tube in one shape. */
struct tube {
    double *positions, *normals; /* (n_vertices, 3) */
    double *colours;             /* (n_vertices, 4) */
};

struct scene {
    const struct wb_harness_result_set *set;
    int base; /* index of the shape at rest, of which the others are changes */
    double most_curvature;
    struct wb_gltf_file file;
    struct wb_json *nodes, *meshes, *samplers, *channels;
    int n_nodes, n_meshes, n_samplers;
    int times, boxes[MATERIALS]; /* an accessor, and meshes */
    struct wb_memory memory;
};

/* The last shape before the harness is taken off. */
static int find_base(const struct wb_harness_result_set *set)
{
    int base = set->n_shapes - 1;
    while (base > 0 && set->plan->steps[set->shapes[base].step].kind == WB_HARNESS_TAKE_OFF)
        base--;
    return base;
}

static double find_most_curvature(const struct wb_harness_result_set *set)
{
    double most = 0.0;
    for (int i = 0; i < set->n_shapes; i++) {
        for (int k = 0; k < set->n_places; k++)
            most = fmax(most, set->shapes[i].places[k].curvature);
    }
    return most;
}

static void put_numbers(struct wb_json *object, const char *key, const double *numbers, int n)
{
    struct wb_json *const list = wb_json_set_array(object, key);
    for (int i = 0; i < n; i++)
        wb_json_append_number(list, numbers[i]);
}

/* Adds a node that is a child of the root node, which is node 0. */
static struct wb_json *add_node(struct scene *scene, const char *name, int mesh)
{
    struct wb_json *const node = wb_json_append_object(scene->nodes);
    wb_json_set_text(node, "name", name);
    wb_json_set_integer(node, "mesh", mesh);
    scene->n_nodes++;
    return node;
}

/* --- the animation --- */

static int add_sampler(struct scene *scene, int output)
{
    struct wb_json *const sampler = wb_json_append_object(scene->samplers);
    wb_json_set_integer(sampler, "input", scene->times);
    wb_json_set_text(sampler, "interpolation", "LINEAR");
    wb_json_set_integer(sampler, "output", output);
    return scene->n_samplers++;
}

/* A sampler for what the last node does. */
static void add_channel(struct scene *scene, int sampler, const char *path)
{
    struct wb_json *const channel = wb_json_append_object(scene->channels);
    wb_json_set_integer(channel, "sampler", sampler);
    struct wb_json *const target = wb_json_set_object(channel, "target");
    wb_json_set_integer(target, "node", scene->n_nodes - 1);
    wb_json_set_text(target, "path", path);
}

/* At the time of each shape, the weight of that shape alone; sampler 0, of all branches. The shape
 * at rest has no weight. */
static void begin_animation(struct scene *scene)
{
    const int n = scene->set->n_shapes;
    double *const times = wb_memory_take(&scene->memory, (size_t)n, sizeof *times);
    double *const weights =
        wb_memory_take(&scene->memory, (size_t)n * (size_t)(n - 1), sizeof *weights);
    struct wb_json *const animation =
        wb_json_append_object(wb_json_set_array(scene->file.root, "animations"));
    wb_json_set_text(animation, "name", "steps");
    scene->samplers = wb_json_set_array(animation, "samplers");
    scene->channels = wb_json_set_array(animation, "channels");
    for (int i = 0; i < n; i++) {
        times[i] = scene->set->shapes[i].time;
        if (i != scene->base)
            weights[i * (n - 1) + (i < scene->base ? i : i - 1)] = 1.0;
    }
    scene->times = wb_gltf_file_add(&scene->file, WB_GLTF_FILE_TIMES, (size_t)n, times);
    add_sampler(scene, wb_gltf_file_add(&scene->file, WB_GLTF_FILE_WEIGHTS,
                                        (size_t)n * (size_t)(n - 1), weights));
}

/* --- branches --- */

static double radius_of(const struct wb_harness_result_set *set, int branch)
{
    return 0.5 * set->plan->wires[set->plan->branches[branch].wire].diameter;
}

/* One ring around a place; its normals point along `along` if it is not NULL, otherwise away from
 * the wire's axis. */
static void set_ring(const struct scene *scene, const struct wb_harness_place *place,
                     const double *along, struct tube *tube, size_t ring)
{
    const double radius = radius_of(scene->set, place->branch);
    const struct wb_colour colour = wb_palette_linear(wb_palette_map(
        WB_PALETTE_SEQUENTIAL,
        scene->most_curvature > 0.0 ? place->curvature / scene->most_curvature : 0.0));
    double side[3];
    wb_vec3_cross(place->up, place->direction, side);
    for (int around = 0; around < AROUND; around++) {
        const size_t vertex = AROUND * ring + (size_t)around;
        const double angle = 2.0 * M_PI * around / AROUND;
        for (size_t k = 0; k < 3; k++) {
            const double away = cos(angle) * side[k] + sin(angle) * place->up[k];
            tube->positions[3 * vertex + k] = place->position[k] + radius * away;
            tube->normals[3 * vertex + k] = along ? along[k] : away;
        }
        double *const c = &tube->colours[4 * vertex];
        c[0] = colour.red, c[1] = colour.green, c[2] = colour.blue, c[3] = 1.0;
    }
}

/* The rings of `n` places, then those of the caps at the beginning and the end. */
static void set_tube(const struct scene *scene, const struct wb_harness_place *places, size_t n,
                     struct tube *tube)
{
    double back[3];
    for (size_t i = 0; i < n; i++)
        set_ring(scene, &places[i], NULL, tube, i);
    for (int k = 0; k < 3; k++)
        back[k] = -places[0].direction[k];
    set_ring(scene, &places[0], back, tube, n);
    set_ring(scene, &places[n - 1], places[n - 1].direction, tube, n + 1);
}

static struct tube make_tube(struct scene *scene, size_t n_vertices)
{
    return (struct tube){
        .positions = wb_memory_take(&scene->memory, 3 * n_vertices, sizeof(double)),
        .normals = wb_memory_take(&scene->memory, 3 * n_vertices, sizeof(double)),
        .colours = wb_memory_take(&scene->memory, 4 * n_vertices, sizeof(double)),
    };
}

static void add_tube(struct scene *scene, struct wb_json *attributes, const struct tube *tube,
                     size_t n_vertices, bool is_base)
{
    struct wb_gltf_file *const file = &scene->file;
    wb_json_set_integer(
        attributes, "POSITION",
        wb_gltf_file_add(file, WB_GLTF_FILE_POSITIONS, n_vertices, tube->positions));
    wb_json_set_integer(attributes, "NORMAL",
                        wb_gltf_file_add(file, WB_GLTF_FILE_NORMALS, n_vertices, tube->normals));
    wb_json_set_integer(
        attributes, "COLOR_0",
        wb_gltf_file_add(file, is_base ? WB_GLTF_FILE_COLOURS : WB_GLTF_FILE_COLOUR_CHANGES,
                         n_vertices, tube->colours));
}

static void subtract(double *values, const double *base, size_t n)
{
    for (size_t i = 0; i < n; i++)
        values[i] -= base[i];
}

/* Triangles between the rings, then of the caps, outer side counter-clockwise. */
static int add_triangles(struct scene *scene, size_t n_rings)
{
    const size_t n = 6 * AROUND * (n_rings - 1) + 2 * 3 * (AROUND - 2);
    double *const indices = wb_memory_take(&scene->memory, n, sizeof *indices);
    size_t next = 0;
    for (size_t ring = 0; ring + 1 < n_rings; ring++) {
        for (size_t i = 0; i < AROUND; i++) {
            const size_t a = AROUND * ring + i, b = AROUND * ring + (i + 1) % AROUND;
            const size_t corners[] = {a, b, b + AROUND, a, b + AROUND, a + AROUND};
            for (int k = 0; k < 6; k++)
                indices[next++] = (double)corners[k];
        }
    }
    for (size_t cap = 0; cap < 2; cap++) {
        const size_t first = AROUND * (n_rings + cap);
        for (size_t i = 1; i + 1 < AROUND; i++) {
            indices[next++] = (double)first;
            indices[next++] = (double)(first + (cap == 0 ? i + 1 : i));
            indices[next++] = (double)(first + (cap == 0 ? i : i + 1));
        }
    }
    return wb_gltf_file_add(&scene->file, WB_GLTF_FILE_INDICES, n, indices);
}

/* Names of the shapes but that at rest, as other programs show them. */
static void put_target_names(const struct scene *scene, struct wb_json *mesh)
{
    struct wb_json *const names =
        wb_json_set_array(wb_json_set_object(mesh, "extras"), "targetNames");
    for (int i = 0; i < scene->set->n_shapes; i++) {
        const struct wb_harness_shape *const shape = &scene->set->shapes[i];
        char name[160];
        snprintf(name, sizeof name, "%.7g %s", shape->time,
                 i == 0 ? "natural" : scene->set->plan->steps[shape->step].name);
        if (i != scene->base)
            wb_json_append_text(names, name);
    }
}

static int add_branch_mesh(struct scene *scene, int branch, size_t first, size_t n)
{
    const struct wb_harness_result_set *const set = scene->set;
    const size_t n_vertices = AROUND * (n + 2);
    const struct tube base = make_tube(scene, n_vertices);
    struct tube tube = make_tube(scene, n_vertices);
    struct wb_json *const mesh = wb_json_append_object(scene->meshes);
    wb_json_set_text(mesh, "name", set->plan->branches[branch].name);
    struct wb_json *const primitive = wb_json_append_object(wb_json_set_array(mesh, "primitives"));
    set_tube(scene, &set->shapes[scene->base].places[first], n, &tube);
    memcpy(base.positions, tube.positions, 3 * n_vertices * sizeof(double));
    memcpy(base.normals, tube.normals, 3 * n_vertices * sizeof(double));
    memcpy(base.colours, tube.colours, 4 * n_vertices * sizeof(double));
    add_tube(scene, wb_json_set_object(primitive, "attributes"), &base, n_vertices, true);
    wb_json_set_integer(primitive, "indices", add_triangles(scene, n));
    wb_json_set_integer(primitive, "material", WIRE);
    struct wb_json *const targets = wb_json_set_array(primitive, "targets");
    for (int i = 0; i < set->n_shapes; i++) {
        if (i == scene->base)
            continue;
        set_tube(scene, &set->shapes[i].places[first], n, &tube);
        subtract(tube.positions, base.positions, 3 * n_vertices);
        subtract(tube.normals, base.normals, 3 * n_vertices);
        subtract(tube.colours, base.colours, 4 * n_vertices);
        add_tube(scene, wb_json_append_object(targets), &tube, n_vertices, false);
    }
    put_target_names(scene, mesh);
    return scene->n_meshes++;
}

static void add_branches(struct scene *scene)
{
    const struct wb_harness_plan *const plan = scene->set->plan;
    size_t first = 0;
    for (int b = 0; b < plan->n_branches; b++) {
        size_t n = 0;
        while (first + n < (size_t)scene->set->n_places &&
               scene->set->natural[first + n].branch == b)
            n++;
        struct wb_json *const node =
            add_node(scene, plan->branches[b].name, add_branch_mesh(scene, b, first, n));
        struct wb_json *const extras = wb_json_set_object(node, "extras");
        wb_json_set_text(extras, "wire", plan->wires[plan->branches[b].wire].name);
        wb_json_set_number(extras, "length_m", plan->branches[b].length);
        wb_json_set_number(extras, "diameter_m", 2.0 * radius_of(scene->set, b));
        add_channel(scene, 0, "weights");
        first += n;
    }
}

/* --- root, connectors and clips --- */

/* A box of edge 1 around the origin, as a mesh of each material of items. */
static void add_boxes(struct scene *scene)
{
    static const char *const names[MATERIALS] = {
        [ROOT] = "root", [CONNECTOR] = "connector", [CLIP] = "clip"};
    double positions[3 * CORNERS * FACES], normals[3 * CORNERS * FACES];
    double indices[6 * FACES];
    static const double turns[CORNERS][2] = {{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}};
    static const int corners[6] = {0, 1, 2, 0, 2, 3};
    for (int face = 0; face < FACES; face++) {
        const int axis = face % 3, sign = face < 3 ? 1 : -1;
        const int across = (axis + (sign > 0 ? 1 : 2)) % 3, other = 3 - axis - across;
        for (int i = 0; i < CORNERS; i++) {
            double *const p = &positions[3 * (CORNERS * face + i)];
            double *const normal = &normals[3 * (CORNERS * face + i)];
            p[axis] = 0.5 * sign, p[across] = turns[i][0], p[other] = turns[i][1];
            normal[axis] = sign, normal[across] = normal[other] = 0.0;
        }
        for (int i = 0; i < 6; i++)
            indices[6 * face + i] = CORNERS * face + corners[i];
    }
    const int position =
        wb_gltf_file_add(&scene->file, WB_GLTF_FILE_POSITIONS, CORNERS * FACES, positions);
    const int normal =
        wb_gltf_file_add(&scene->file, WB_GLTF_FILE_NORMALS, CORNERS * FACES, normals);
    const int index = wb_gltf_file_add(&scene->file, WB_GLTF_FILE_INDICES, 6 * FACES, indices);
    for (int material = ROOT; material < MATERIALS; material++) {
        struct wb_json *const mesh = wb_json_append_object(scene->meshes);
        wb_json_set_text(mesh, "name", names[material]);
        struct wb_json *const primitive =
            wb_json_append_object(wb_json_set_array(mesh, "primitives"));
        struct wb_json *const attributes = wb_json_set_object(primitive, "attributes");
        wb_json_set_integer(attributes, "POSITION", position);
        wb_json_set_integer(attributes, "NORMAL", normal);
        wb_json_set_integer(primitive, "indices", index);
        wb_json_set_integer(primitive, "material", material);
        scene->boxes[material] = scene->n_meshes++;
    }
}

/* Sizes of an item's box along the wire, across and up, and its middle in the same frame. A
 * connector's is around its centre of mass. */
static void find_box(const struct wb_harness_result_set *set, const struct wb_harness_item *item,
                     double size[3], double middle[3])
{
    const double d = 2.0 * radius_of(set, item->branch < 0 ? 0 : item->branch);
    const double across = item->kind == WB_HARNESS_CLIP ? 2.0 * d : 3.0 * d;
    size[0] = item->kind == WB_HARNESS_CONNECTOR ? fmax(2.0 * fabs(item->centre[0]), 3.0 * d) : d;
    size[1] = size[2] = across;
    for (int k = 0; k < 3; k++)
        middle[k] = item->kind == WB_HARNESS_CONNECTOR ? item->centre[k] : 0.0;
    if (item->kind == WB_HARNESS_ROOT)
        middle[0] = -0.5 * d;
}

/* The wire at an item: on the line between the places around it, with the frame of the nearer. */
static struct wb_harness_place place_of(const struct wb_harness_result_set *set,
                                        const struct wb_harness_shape *shape,
                                        const struct wb_harness_item *item)
{
    const struct wb_harness_place *const places = shape->places;
    const double at =
        wb_harness_run_place(set->plan, shape->forces, (int)(item - set->plan->items));
    const int branch = item->branch < 0 ? 0 : item->branch;
    int i = 0;
    while (places[i].branch != branch)
        i++;
    while (i + 2 < set->n_places && places[i + 2].branch == branch && places[i + 1].s < at)
        i++;
    const struct wb_harness_place *const a = &places[i], *const b = &places[i + 1];
    const double part = (at - a->s) / (b->s - a->s);
    struct wb_harness_place place = part < 0.5 ? *a : *b;
    for (int k = 0; k < 3; k++)
        place.position[k] = a->position[k] + part * (b->position[k] - a->position[k]);
    return place;
}

/* Middle and rotation of an item's box in a shape. The sign of the rotation is that nearer to the
 * one before, so that what lies between turns the short way. */
static void set_pose(const struct wb_harness_result_set *set, const struct wb_harness_item *item,
                     const struct wb_harness_shape *shape, const double middle[3],
                     const double *before, double position[3], double rotation[4])
{
    const struct wb_harness_place place = place_of(set, shape, item);
    double q[4], R[9], cosine = 0.0;
    wb_harness_file_rotation(place.direction, place.up, NULL, q);
    wb_rod_element_matrix(q, R);
    for (int k = 0; k < 3; k++)
        position[k] = place.position[k] + wb_vec3_dot(&R[3 * k], middle);
    for (int k = 0; k < 4; k++) {
        rotation[k] = q[(k + 1) % 4];
        cosine += before ? rotation[k] * before[k] : 1.0;
    }
    for (int k = 0; k < 4 && before && cosine < 0.0; k++)
        rotation[k] = -rotation[k];
}

static void add_item(struct scene *scene, const struct wb_harness_item *item)
{
    static const enum material materials[] = {
        [WB_HARNESS_ROOT] = ROOT, [WB_HARNESS_CONNECTOR] = CONNECTOR, [WB_HARNESS_CLIP] = CLIP};
    static const char *const kinds[] = {[WB_HARNESS_ROOT] = "root",
                                        [WB_HARNESS_CONNECTOR] = "connector",
                                        [WB_HARNESS_CLIP] = "clip"};
    const struct wb_harness_result_set *const set = scene->set;
    const size_t n = (size_t)set->n_shapes;
    double *const positions = wb_memory_take(&scene->memory, 3 * n, sizeof *positions);
    double *const rotations = wb_memory_take(&scene->memory, 4 * n, sizeof *rotations);
    double size[3], middle[3];
    find_box(set, item, size, middle);
    for (size_t i = 0; i < n; i++)
        set_pose(set, item, &set->shapes[i], middle, i > 0 ? &rotations[4 * (i - 1)] : NULL,
                 &positions[3 * i], &rotations[4 * i]);
    struct wb_json *const node = add_node(scene, item->name, scene->boxes[materials[item->kind]]);
    put_numbers(node, "translation", &positions[3 * scene->base], 3);
    put_numbers(node, "rotation", &rotations[4 * scene->base], 4);
    put_numbers(node, "scale", size, 3);
    struct wb_json *const extras = wb_json_set_object(node, "extras");
    wb_json_set_text(extras, "kind", kinds[item->kind]);
    if (item->kind == WB_HARNESS_CONNECTOR)
        wb_json_set_number(extras, "mass_kg", item->mass);
    add_channel(
        scene,
        add_sampler(scene, wb_gltf_file_add(&scene->file, WB_GLTF_FILE_TRANSLATIONS, n, positions)),
        "translation");
    add_channel(
        scene,
        add_sampler(scene, wb_gltf_file_add(&scene->file, WB_GLTF_FILE_ROTATIONS, n, rotations)),
        "rotation");
}

/* --- the file --- */

static void add_materials(struct scene *scene)
{
    const struct {
        const char *name;
        struct wb_colour colour;
    } materials[MATERIALS] = {
        [WIRE] = {"curvature", {1.0, 1.0, 1.0, 1.0}},
        [ROOT] = {"root", wb_palette_linear(wb_palette_ink())},
        [CONNECTOR] = {"connector", wb_palette_linear(wb_palette_grey())},
        [CLIP] = {"clip", wb_palette_linear(wb_palette_warning())},
    };
    struct wb_json *const list = wb_json_set_array(scene->file.root, "materials");
    for (int i = 0; i < MATERIALS; i++) {
        const struct wb_colour *const c = &materials[i].colour;
        const double factor[] = {c->red, c->green, c->blue, 1.0};
        struct wb_json *const material = wb_json_append_object(list);
        wb_json_set_text(material, "name", materials[i].name);
        struct wb_json *const surface = wb_json_set_object(material, "pbrMetallicRoughness");
        put_numbers(surface, "baseColorFactor", factor, 4);
        wb_json_set_number(surface, "metallicFactor", 0.0);
        wb_json_set_number(surface, "roughnessFactor", 0.7);
    }
}

/* What was computed, of which file and by which program. */
static void put_origin(const struct scene *scene, struct wb_json *extras)
{
    const struct wb_harness_result_set *const set = scene->set;
    wb_keys_put_tool(extras, "wirebench solve");
    wb_json_set_text(extras, "kind", "harness");
    wb_json_set_text(extras, "origin", "computed, not compared with a measurement");
    wb_json_set_text(extras, "name", set->plan->name);
    if (set->plan->title[0])
        wb_json_set_text(extras, "title", set->plan->title);
    wb_json_set_text(extras, "file", wb_file_name(set->plan->path));
    wb_json_set_text(extras, "sha256", set->plan->sha256);
    wb_json_set_text(extras, "law", set->settings.is_elastic ? "elastic" : "elastoplastic");
    wb_json_set_boolean(extras, "converged", set->converged);
    wb_json_set_number(extras, "curvature_of_brightest_colour_1_m", scene->most_curvature);
    struct wb_json *const steps = wb_json_set_array(extras, "steps");
    for (int i = 0; i < set->n_steps; i++)
        wb_json_append_text(steps, set->plan->steps[i].name);
}

/* The root node turns z up to glTF's y up. */
static void begin_scene(struct scene *scene)
{
    const struct wb_harness_plan *const plan = scene->set->plan;
    static const double y_up[] = {-M_SQRT1_2, 0.0, 0.0, M_SQRT1_2};
    struct wb_json *const root = scene->file.root;
    wb_json_set_integer(root, "scene", 0);
    struct wb_json *const top = wb_json_append_object(wb_json_set_array(root, "scenes"));
    wb_json_set_text(top, "name", plan->name);
    wb_json_append_number(wb_json_set_array(top, "nodes"), 0.0);
    put_origin(scene, wb_json_set_object(top, "extras"));
    add_materials(scene);
    scene->meshes = wb_json_set_array(root, "meshes");
    scene->nodes = wb_json_set_array(root, "nodes");
    struct wb_json *const node = wb_json_append_object(scene->nodes);
    wb_json_set_text(node, "name", plan->name);
    put_numbers(node, "rotation", y_up, 4);
    struct wb_json *const children = wb_json_set_array(node, "children");
    for (int i = 1; i <= plan->n_branches + plan->n_items; i++)
        wb_json_append_number(children, i);
    scene->n_nodes = 1;
}

enum wb_status wb_harness_gltf_write(const struct wb_harness_result_set *set, const char *path)
{
    struct scene scene = {
        .set = set, .base = find_base(set), .most_curvature = find_most_curvature(set)};
    wb_gltf_file_init(&scene.file);
    begin_scene(&scene);
    begin_animation(&scene);
    add_branches(&scene);
    add_boxes(&scene);
    for (int i = 0; i < set->plan->n_items; i++)
        add_item(&scene, &set->plan->items[i]);
    const enum wb_status status = wb_gltf_file_write(&scene.file, path);
    wb_gltf_file_release(&scene.file);
    wb_memory_release(&scene.memory);
    return status;
}
