#include "analysis/harness/harness_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/cards/card_source.h"
#include "base/config.h"
#include "base/memory.h"
#include "base/units.h"
#include "base/vec3.h"
#include "fe/model/model_file.h"

#define WB_LOG_DOMAIN "harness"

static const char *const holds[] = {"point", "axis", "all", "slide", NULL};
const char *const wb_harness_file_shapes[] = {"plane", "cylinder", "box", NULL};
static const char *const steps[] = {"hang", "mount", "move", "release", "take_off", NULL};
static const char parallel[] = "it is parallel to `up`, which must point across";

/* State while a file is read. */
struct reader {
    struct wb_harness_plan *plan;
    struct wb_model_file file;
    char root[WB_HARNESS_NAME];
    struct wb_harness_assembly assembly;
};

/* --- values --- */

static enum wb_status read_vector(const struct wb_config_node *map, const char *key,
                                  const struct wb_config_node *list, double factor, double most,
                                  double vector[3])
{
    const struct wb_config_key row = WB_CONFIG_NUMBER(key, vector, factor, -most, most);
    int n;
    WB_TRY(wb_config_numbers(list, &row, 3, 3, vector, &n));
    (void)map;
    return WB_OK;
}

static enum wb_status read_direction(const struct wb_config_node *map, const char *key,
                                     const struct wb_config_node *list, double vector[3])
{
    WB_TRY(read_vector(map, key, list, 1.0, 1e6, vector));
    if (!(wb_vec3_normalise(vector) > 1e-9))
        return wb_config_refuse(map, key, "a direction has a length above 0");
    return WB_OK;
}

static bool is_parallel(const double direction[3], const double up[3])
{
    double across[3];
    wb_vec3_cross(direction, up, across);
    return wb_vec3_length(across) < 1e-3;
}

/* The unit quaternion of a rotation matrix (Shepperd 1978). */
static void quaternion(const double R[9], double q[4])
{
    const double traces[4] = {R[0] + R[4] + R[8], R[0] - R[4] - R[8], R[4] - R[0] - R[8],
                              R[8] - R[0] - R[4]};
    int most = 0;
    for (int i = 1; i < 4; i++)
        most = traces[i] > traces[most] ? i : most;
    const double twice = sqrt(1.0 + traces[most]), over = 0.5 / twice;
    const double xy = R[1] + R[3], xz = R[2] + R[6], yz = R[5] + R[7];
    const double wx = R[7] - R[5], wy = R[2] - R[6], wz = R[3] - R[1];
    const double rows[4][4] = {
        {0.0, wx, wy, wz}, {wx, 0.0, xy, xz}, {wy, xy, 0.0, yz}, {wz, xz, yz, 0.0}};
    for (int i = 0; i < 4; i++)
        q[i] = i == most ? 0.5 * twice : over * rows[most][i];
}

void wb_harness_file_rotation(const double direction[3], const double *up, const double before[4],
                              double rotation[4])
{
    double R[9];
    if (up) {
        double y[3], z[3];
        wb_vec3_cross(up, direction, y);
        (void)wb_vec3_normalise(y);
        wb_vec3_cross(direction, y, z);
        for (int k = 0; k < 3; k++) {
            R[3 * k] = direction[k];
            R[3 * k + 1] = y[k];
            R[3 * k + 2] = z[k];
        }
        quaternion(R, rotation);
        return;
    }
    double turn[3], q[4];
    wb_rod_element_turn_axis(before, direction, turn);
    wb_rod_element_exponential(turn, q);
    wb_rod_element_compose(q, before, rotation);
}

static enum wb_status check_name(const struct wb_config_node *map, const char *name)
{
    return wb_model_file_check_name(map, name);
}

/* --- wires --- */

static int find_wire(const struct wb_harness_plan *plan, const char *name)
{
    for (int i = 0; i < plan->n_wires; i++) {
        if (strcmp(plan->wires[i].name, name) == 0)
            return i;
    }
    return -1;
}

/* The wire of this name, or else the bundle. */
static enum wb_status find_wire_file(struct reader *reader, const struct wb_config_node *map,
                                     const char *name, char path[WB_PATH])
{
    struct wb_reason why = {.text = ""};
    if (wb_file_find_named(path, "wires", name, reader->file.folder, NULL, &why) == WB_OK ||
        wb_file_find_named(path, "bundles", name, reader->file.folder, NULL, &why) == WB_OK)
        return WB_OK;
    return wb_model_file_find(&reader->file, map, "wire", "wires", name, path);
}

/* Replaces the path of a bundle file by that of its calibrated beam. */
static enum wb_status follow_bundle(const struct wb_config_node *map, char path[WB_PATH])
{
    char bundle[WB_PATH];
    struct wb_model_file file;
    snprintf(bundle, sizeof bundle, "%s", path);
    enum wb_status status = wb_model_file_open(&file, bundle);
    const bool is_bundle = status == WB_OK && wb_config_find(file.root, "wires") &&
                           !wb_config_find(file.root, "branches");
    if (is_bundle) {
        const struct wb_config_node *const published = wb_config_find(file.root, "published");
        const struct wb_config_node *const beam =
            published ? wb_config_find(published, "beam") : NULL;
        const char *const name = beam ? wb_config_scalar(beam) : NULL;
        status = name
                     ? wb_model_file_find(&file, published, "beam", "wires", name, path)
                     : wb_config_refuse(map, "wire",
                                        "%s is a bundle file without a calibrated beam (published: "
                                        "beam): name the properties file of 'wirebench calibrate' "
                                        "on tests of the bundle, or on a dataset of 'wirebench "
                                        "solve bundle'",
                                        bundle);
    }
    wb_model_file_close(&file);
    return status;
}

static enum wb_status read_wire(void *context, const struct wb_config_node *map)
{
    struct reader *const reader = context;
    struct wb_harness_plan *const plan = reader->plan;
    struct wb_harness_wire *const wire = &plan->wires[plan->n_wires];
    char from[WB_PATH], path[WB_PATH];
    const struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("name", wire->name),
        WB_CONFIG_TEXT("wire", from),
        WB_CONFIG_OPTIONAL_NUMBER("torsional_stiffness_N_mm2", &wire->torsional_stiffness, WB_NMM2,
                                  1e-9, 1e12),
    };
    WB_TRY(wb_config_map(map, keys, WB_COUNT(keys)));
    WB_TRY(check_name(map, wire->name));
    if (find_wire(plan, wire->name) >= 0)
        return wb_config_refuse(map, "name", "%s is the name of another wire, too", wire->name);
    WB_TRY(find_wire_file(reader, map, from, path));
    WB_TRY(follow_bundle(map, path));

    struct wb_card_source *const source = wb_memory_new(1, sizeof *source);
    const enum wb_status status = wb_card_source_read(source, path);
    if (status == WB_OK) {
        const struct wb_properties *const p = &source->properties;
        snprintf(wire->file, sizeof wire->file, "%s", source->file);
        snprintf(wire->sha256, sizeof wire->sha256, "%s", source->sha256);
        wire->diameter = p->outer_diameter;
        wire->mass = p->mass_per_length;
        wire->law = p->law;
        wire->largest_curvature = p->largest_curvature;
        wire->has_unloading = wb_card_source_has_unloading(source);
        wire->is_virtual = p->is_virtual;
        (void)wb_specimens_take(&wire->specimens, p);
    }
    free(source);
    WB_TRY(status);
    if (!(wire->mass > 0.0))
        return wb_config_refuse(map, "wire", "%s has no mass (mass_per_length_kg_m)", wire->file);
    plan->n_wires++;
    return WB_OK;
}

/* --- branches --- */

static int branch_to(const struct wb_harness_plan *plan, const char *node)
{
    for (int i = 0; i < plan->n_branches; i++) {
        if (strcmp(plan->branches[i].to, node) == 0)
            return i;
    }
    return -1;
}

static int find_branch(const struct wb_harness_plan *plan, const char *name)
{
    for (int i = 0; i < plan->n_branches; i++) {
        if (strcmp(plan->branches[i].name, name) == 0)
            return i;
    }
    return -1;
}

static enum wb_status read_place(const struct wb_config_node *map,
                                 struct wb_harness_plan_branch *branch)
{
    const struct wb_config_node *list = NULL;
    const int i = branch->n_curve;
    const struct wb_config_key keys[] = {
        WB_CONFIG_NUMBER("at_mm", &branch->place[i], WB_MM, 0.0, 1e6),
        WB_CONFIG_NODE("curvature_1_m", &list),
    };
    const struct wb_config_key value =
        WB_CONFIG_NUMBER("curvature_1_m", branch->curvature[i], 1.0, -1e4, 1e4);
    int n;
    WB_TRY(wb_config_map(map, keys, WB_COUNT(keys)));
    WB_TRY(wb_config_numbers(list, &value, 2, 2, branch->curvature[i], &n));
    if (i > 0 && !(branch->place[i] > branch->place[i - 1]))
        return wb_config_refuse(map, "at_mm", "expected more than at the place before");
    branch->n_curve++;
    return WB_OK;
}

static enum wb_status read_natural_shape(const struct wb_config_node *map,
                                         struct wb_harness_plan_branch *branch)
{
    const struct wb_config_node *constant = NULL, *curve = NULL;
    const struct wb_config_key keys[] = {
        WB_CONFIG_OPTIONAL_NODE("curvature_1_m", &constant),
        WB_CONFIG_OPTIONAL_NODE("curve", &curve),
    };
    WB_TRY(wb_config_map(map, keys, WB_COUNT(keys)));
    if (!constant == !curve)
        return wb_config_refuse(map, NULL, "expected either curvature_1_m or curve");
    if (constant) {
        const struct wb_config_key value =
            WB_CONFIG_NUMBER("curvature_1_m", branch->curvature[0], 1.0, -1e4, 1e4);
        branch->n_curve = 1;
        int n;
        return wb_config_numbers(constant, &value, 2, 2, branch->curvature[0], &n);
    }
    const int n = wb_config_length(curve);
    if (n < 2 || n > WB_HARNESS_MOST_CURVE)
        return wb_config_refuse(map, "curve", "expected a list of 2 to %d places",
                                WB_HARNESS_MOST_CURVE);
    for (int i = 0; i < n; i++)
        WB_TRY(read_place(wb_config_item(curve, i), branch));
    return WB_OK;
}

static enum wb_status read_branch(void *context, const struct wb_config_node *map)
{
    struct reader *const reader = context;
    struct wb_harness_plan *const plan = reader->plan;
    struct wb_harness_plan_branch *const branch = &plan->branches[plan->n_branches];
    const struct wb_config_node *natural = NULL;
    char wire[WB_HARNESS_NAME];
    double angle = 0.0, around = 0.0;
    const struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("name", branch->name),
        WB_CONFIG_TEXT("from", branch->from),
        WB_CONFIG_TEXT("to", branch->to),
        WB_CONFIG_TEXT("wire", wire),
        WB_CONFIG_NUMBER("length_mm", &branch->length, WB_MM, 1e-3, 1e6),
        WB_CONFIG_OPTIONAL_NUMBER("angle_deg", &angle, WB_DEGREE, 0.0, 180.0),
        WB_CONFIG_OPTIONAL_NUMBER("around_deg", &around, WB_DEGREE, -360.0, 360.0),
        WB_CONFIG_OPTIONAL_NODE("natural_shape", &natural),
        WB_CONFIG_OPTIONAL_NUMBER("least_radius_mm", &branch->least_radius, WB_MM, 1e-3, 1e6),
    };
    WB_TRY(wb_config_map(map, keys, WB_COUNT(keys)));
    WB_TRY(check_name(map, branch->name));
    if (find_branch(plan, branch->name) >= 0)
        return wb_config_refuse(map, "name", "%s is the name of another branch, too", branch->name);
    const int other = branch_to(plan, branch->to);
    if (other >= 0)
        return wb_config_refuse(map, "to",
                                "branch %s ends at %s, too: a harness is a tree, in which each "
                                "node has one branch that leads to it",
                                plan->branches[other].name, branch->to);
    if (strcmp(branch->to, reader->root) == 0)
        return wb_config_refuse(map, "to", "%s is the root: a harness is a tree, without a loop",
                                branch->to);
    branch->wire = find_wire(plan, wire);
    if (branch->wire < 0)
        return wb_config_refuse(map, "wire", "no wire of this file is named '%s'", wire);
    if (natural)
        WB_TRY(read_natural_shape(natural, branch));
    if (branch->n_curve > 1 && branch->place[branch->n_curve - 1] > branch->length)
        return wb_config_refuse(natural, "curve",
                                "its last place, %g mm, is beyond the branch's "
                                "length, %g mm",
                                branch->place[branch->n_curve - 1] / WB_MM, branch->length / WB_MM);
    /* Turned about the axis that is across the parent's axis and the direction around it. */
    const double turn[3] = {0.0, -angle * cos(around), -angle * sin(around)};
    wb_rod_element_exponential(turn, branch->leaving);
    plan->n_branches++;
    return WB_OK;
}

/* Brings the branches into an order in which each comes after its parent. */
static enum wb_status sort_branches(struct reader *reader, const struct wb_config_node *list)
{
    struct wb_harness_plan *const plan = reader->plan;
    const int n = plan->n_branches;
    int order[WB_HARNESS_MOST_BRANCHES], done = 0, rank[WB_HARNESS_MOST_BRANCHES];
    for (int i = 0; i < n; i++) {
        const char *const from = plan->branches[i].from;
        rank[i] = -1;
        if (strcmp(from, reader->root) != 0 && branch_to(plan, from) < 0)
            return wb_config_refuse(wb_config_item(list, i), "from",
                                    "no branch leads to '%s', and the root is '%s'", from,
                                    reader->root);
    }
    for (bool found = true; found;) {
        found = false;
        for (int i = 0; i < n; i++) {
            const int parent = branch_to(plan, plan->branches[i].from);
            if (rank[i] >= 0 || (parent >= 0 && rank[parent] < 0))
                continue;
            rank[i] = done;
            order[done++] = i;
            found = true;
        }
    }
    for (int i = 0; i < n; i++) {
        if (rank[i] < 0)
            return wb_config_refuse(wb_config_item(list, i), "from",
                                    "branch %s is part of a loop that does not lead to the root: "
                                    "a harness is a tree",
                                    plan->branches[i].name);
    }
    struct wb_harness_plan_branch *const sorted = wb_memory_new((size_t)n, sizeof *sorted);
    for (int i = 0; i < n; i++) {
        const int parent = branch_to(plan, plan->branches[order[i]].from);
        sorted[i] = plan->branches[order[i]];
        sorted[i].parent = parent < 0 ? -1 : rank[parent];
    }
    memcpy(plan->branches, sorted, (size_t)n * sizeof *sorted);
    free(sorted);
    return WB_OK;
}

/* --- items --- */

int wb_harness_file_find_item(const struct wb_harness_plan *plan, const char *name)
{
    for (int i = 0; i < plan->n_items; i++) {
        if (strcmp(plan->items[i].name, name) == 0)
            return i;
    }
    return -1;
}

static enum wb_status add_item(struct reader *reader, const struct wb_config_node *map,
                               const struct wb_harness_item *item)
{
    struct wb_harness_plan *const plan = reader->plan;
    WB_TRY(check_name(map, item->name));
    if (wb_harness_file_find_item(plan, item->name) >= 0)
        return wb_config_refuse(map, "name",
                                "%s is the name of the root, a connector or a clip "
                                "already",
                                item->name);
    plan->items[plan->n_items++] = *item;
    return WB_OK;
}

static enum wb_status read_connector(void *context, const struct wb_config_node *map)
{
    struct reader *const reader = context;
    struct wb_harness_plan *const plan = reader->plan;
    const struct wb_config_node *centre = NULL;
    struct wb_harness_item item = {.kind = WB_HARNESS_CONNECTOR, .hold = WB_HARNESS_FIXED};
    const struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("name", item.name),
        WB_CONFIG_OPTIONAL_NUMBER("mass_g", &item.mass, WB_G, 0.0, 1e6),
        WB_CONFIG_OPTIONAL_NODE("centre_mm", &centre),
        WB_CONFIG_OPTIONAL_NUMBER("most_force_N", &item.largest_force, 1.0, 1e-9, 1e9),
        WB_CONFIG_OPTIONAL_NUMBER("most_moment_N_mm", &item.largest_moment, WB_NMM, 1e-9, 1e9),
    };
    WB_TRY(wb_config_map(map, keys, WB_COUNT(keys)));
    if (centre)
        WB_TRY(read_vector(map, "centre_mm", centre, WB_MM, 1e4, item.centre));
    item.branch = branch_to(plan, item.name);
    if (item.branch < 0)
        return wb_config_refuse(map, "name", "no branch leads to '%s'", item.name);
    item.at = plan->branches[item.branch].length;
    return add_item(reader, map, &item);
}

static enum wb_status read_clip(void *context, const struct wb_config_node *map)
{
    struct reader *const reader = context;
    struct wb_harness_plan *const plan = reader->plan;
    struct wb_harness_item item = {.kind = WB_HARNESS_CLIP};
    char branch[WB_HARNESS_NAME];
    int hold;
    const struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("name", item.name),
        WB_CONFIG_TEXT("branch", branch),
        WB_CONFIG_NUMBER("at_mm", &item.at, WB_MM, 0.0, 1e6),
        WB_CONFIG_CHOICE("holds", &hold, holds),
        WB_CONFIG_OPTIONAL_NUMBER("friction", &item.friction, 1.0, 0.0, 10.0),
        WB_CONFIG_OPTIONAL_NUMBER("most_force_N", &item.largest_force, 1.0, 1e-9, 1e9),
        WB_CONFIG_OPTIONAL_NUMBER("most_moment_N_mm", &item.largest_moment, WB_NMM, 1e-9, 1e9),
    };
    WB_TRY(wb_config_map(map, keys, WB_COUNT(keys)));
    item.hold = WB_HARNESS_POINT + (enum wb_harness_hold)hold;
    if (wb_config_find(map, "friction") && item.hold != WB_HARNESS_SLIDE)
        return wb_config_refuse(map, "friction", "the wire slides only where `holds` is `slide`");
    item.branch = find_branch(plan, branch);
    if (item.branch < 0)
        return wb_config_refuse(map, "branch", "no branch is named '%s'", branch);
    const double length = plan->branches[item.branch].length;
    if (!(item.at > 0.0 && item.at <= length))
        return wb_config_refuse(map, "at_mm",
                                "%g mm: expected above 0 and at most the length of "
                                "branch %s, %g mm",
                                item.at / WB_MM, branch, length / WB_MM);
    for (int i = 1; i < plan->n_items; i++) {
        if (plan->items[i].branch == item.branch && fabs(plan->items[i].at - item.at) < 1e-6)
            return wb_config_refuse(map, "at_mm", "%s is at %g mm of branch %s already",
                                    plan->items[i].name, item.at / WB_MM, branch);
    }
    return add_item(reader, map, &item);
}

/* --- obstacles --- */

int wb_harness_file_n_holders(const struct wb_harness_plan *plan)
{
    return plan->n_items + plan->n_obstacles;
}

const char *wb_harness_file_holder(const struct wb_harness_plan *plan, int index)
{
    return index < plan->n_items ? plan->items[index].name
                                 : plan->obstacles[index - plan->n_items].name;
}

static int find_holder(const struct wb_harness_plan *plan, const char *name)
{
    for (int i = 0; i < wb_harness_file_n_holders(plan); i++) {
        if (strcmp(wb_harness_file_holder(plan, i), name) == 0)
            return i;
    }
    return -1;
}

/* Which of the sizes belong to a shape. */
static enum wb_status check_sizes(const struct wb_config_node *map, const struct wb_obstacle *body)
{
    static const char *const keys[] = {"radius_mm", "length_mm", "size_mm", "edge_radius_mm"};
    static const char *const needed[] = {NULL, "radius_mm", "size_mm"};
    static const int allowed[] = {0x0, 0xb, 0xc};
    for (int i = 0; i < 4; i++) {
        if (wb_config_find(map, keys[i]) && !(allowed[body->kind] >> i & 1))
            return wb_config_refuse(map, keys[i], "a %s has none",
                                    wb_harness_file_shapes[body->kind]);
    }
    if (needed[body->kind] && !wb_config_find(map, needed[body->kind]))
        return wb_config_refuse(map, needed[body->kind], "missing: a %s needs it",
                                wb_harness_file_shapes[body->kind]);
    struct wb_reason why = {""};
    if (wb_obstacle_check(body, &why) != WB_OK)
        return wb_config_refuse(map, "edge_radius_mm", "%s", why.text);
    return WB_OK;
}

static enum wb_status read_obstacle(void *context, const struct wb_config_node *map)
{
    struct reader *const reader = context;
    struct wb_harness_plan *const plan = reader->plan;
    struct wb_harness_plan_obstacle obstacle = {.body = {.size = {0.0, (double)INFINITY, 0.0}}};
    struct wb_obstacle *const body = &obstacle.body;
    const struct wb_config_node *at = NULL, *direction_node = NULL, *up_node = NULL, *size = NULL;
    double direction[3] = {1.0, 0.0, 0.0}, up[3] = {0.0, 0.0, 1.0};
    int shape;
    const struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("name", obstacle.name),
        WB_CONFIG_CHOICE("shape", &shape, wb_harness_file_shapes),
        WB_CONFIG_NODE("at_mm", &at),
        WB_CONFIG_OPTIONAL_NODE("direction", &direction_node),
        WB_CONFIG_OPTIONAL_NODE("up", &up_node),
        WB_CONFIG_OPTIONAL_NUMBER("radius_mm", &body->size[0], WB_MM, 1e-3, 1e6),
        WB_CONFIG_OPTIONAL_NUMBER("length_mm", &body->size[1], WB_MM, 1e-3, 1e6),
        WB_CONFIG_OPTIONAL_NODE("size_mm", &size),
        WB_CONFIG_OPTIONAL_NUMBER("edge_radius_mm", &body->edge, WB_MM, 0.0, 1e6),
        WB_CONFIG_OPTIONAL_NUMBER("friction", &body->friction, 1.0, 0.0, 10.0),
    };
    WB_TRY(wb_config_map(map, keys, WB_COUNT(keys)));
    body->kind = (enum wb_obstacle_kind)shape;
    WB_TRY(check_name(map, obstacle.name));
    if (find_holder(plan, obstacle.name) >= 0)
        return wb_config_refuse(map, "name", "%s is a name of this file already", obstacle.name);
    WB_TRY(read_vector(map, "at_mm", at, WB_MM, 1e6, body->place));
    if (direction_node)
        WB_TRY(read_direction(map, "direction", direction_node, direction));
    else if (body->kind != WB_OBSTACLE_BOX)
        return wb_config_refuse(map, "direction", "missing: a %s needs it",
                                wb_harness_file_shapes[shape]);
    if (size) {
        const struct wb_config_key row = WB_CONFIG_NUMBER("size_mm", body->size, WB_MM, 1e-3, 1e6);
        int n;
        WB_TRY(wb_config_numbers(size, &row, 3, 3, body->size, &n));
    }
    WB_TRY(check_sizes(map, body));
    if (up_node)
        WB_TRY(read_direction(map, "up", up_node, up));
    else if (is_parallel(direction, up))
        up[0] = 1.0;
    if (is_parallel(direction, up))
        return wb_config_refuse(map, "up", "%s", parallel);
    wb_harness_file_rotation(direction, up, NULL, body->rotation);
    plan->obstacles[plan->n_obstacles++] = obstacle;
    return WB_OK;
}

/* --- steps --- */

/* Length of wire between an item and the root. */
static double way_to_root(const struct wb_harness_plan *plan, int branch, double at)
{
    double way = at;
    for (int b = branch; b >= 0 && plan->branches[b].parent >= 0; b = plan->branches[b].parent)
        way += plan->branches[plan->branches[b].parent].length;
    return way;
}

/* Length of wire between two items, at most; a wire may slide through a clip up to its ends. */
static double wire_between(const struct wb_harness_plan *plan, const struct wb_harness_item *a,
                           const struct wb_harness_item *b)
{
    if (a->hold == WB_HARNESS_SLIDE || b->hold == WB_HARNESS_SLIDE) {
        const struct wb_harness_item *const slides = a->hold == WB_HARNESS_SLIDE ? a : b;
        struct wb_harness_item first = *slides, last = *slides;
        first.hold = last.hold = WB_HARNESS_POINT;
        first.at = 0.0;
        last.at = plan->branches[slides->branch].length;
        return fmax(wire_between(plan, &first, slides == a ? b : a),
                    wire_between(plan, &last, slides == a ? b : a));
    }
    double common = 0.0;
    for (int i = a->branch; i >= 0; i = plan->branches[i].parent) {
        double there = i == a->branch ? a->at : plan->branches[i].length;
        for (int j = b->branch; j >= 0; j = plan->branches[j].parent) {
            if (i != j)
                continue;
            there = fmin(there, j == b->branch ? b->at : plan->branches[j].length);
            common = fmax(common, way_to_root(plan, i, there));
        }
    }
    return way_to_root(plan, a->branch, a->at) + way_to_root(plan, b->branch, b->at) - 2.0 * common;
}

static enum wb_status check_reach(const struct wb_harness_plan *plan,
                                  const struct wb_harness_assembly *assembly,
                                  const struct wb_harness_step *step, struct wb_reason *why)
{
    for (int i = 0; i < plan->n_items; i++) {
        if (!assembly->is_mounted[i] || i == step->item)
            continue;
        const double wire = wire_between(plan, &plan->items[step->item], &plan->items[i]);
        const double apart = wb_vec3_distance(step->position, assembly->place[i]);
        if (apart > wire * (1.0 + 1e-9))
            return wb_fail_to(why, WB_ERR_ARGUMENT, "%s to %s: %.4g mm apart, %.4g mm of wire",
                              plan->items[step->item].name, plan->items[i].name, apart / WB_MM,
                              wire / WB_MM);
    }
    return WB_OK;
}

static enum wb_status check_target(const struct wb_harness_plan *plan,
                                   const struct wb_harness_assembly *assembly,
                                   const struct wb_harness_step *step, const char **key,
                                   struct wb_reason *why)
{
    const struct wb_harness_item *const item = &plan->items[step->item];
    *key = "direction";
    if (step->has_direction && (item->hold == WB_HARNESS_POINT || item->hold == WB_HARNESS_SLIDE))
        return wb_fail_to(why, WB_ERR_ARGUMENT, "%s holds a point only", item->name);
    if (step->has_direction && step->has_up && is_parallel(step->direction, step->up))
        return wb_fail_to(why, WB_ERR_ARGUMENT, "%s", parallel);
    *key = "up";
    if (step->has_up && item->hold != WB_HARNESS_FIXED)
        return wb_fail_to(why, WB_ERR_ARGUMENT, "%s lets the wire turn about its axis", item->name);
    if (step->has_up && !step->has_direction)
        return wb_fail_to(why, WB_ERR_ARGUMENT, "expected a `direction` beside it");
    *key = "at_mm";
    for (int i = 0; i < plan->n_obstacles; i++) {
        double normal[3], curvature[9];
        const double depth =
            -wb_obstacle_distance(&plan->obstacles[i].body, step->position, normal, curvature);
        if (depth > 0.0)
            return wb_fail_to(why, WB_ERR_ARGUMENT, "%s would be %.3g mm inside of obstacle %s",
                              item->name, depth / WB_MM, plan->obstacles[i].name);
    }
    return check_reach(plan, assembly, step, why);
}

/* Whether a release leaves a hold. */
static bool holds_another(const struct wb_harness_plan *plan,
                          const struct wb_harness_assembly *assembly, int item)
{
    for (int i = 0; i < plan->n_items; i++) {
        if (assembly->is_mounted[i] && i != item)
            return true;
    }
    return false;
}

enum wb_status wb_harness_file_check_step(const struct wb_harness_plan *plan,
                                          const struct wb_harness_assembly *assembly,
                                          const struct wb_harness_step *step, const char **key,
                                          struct wb_reason *why)
{
    const char *const name = plan->items[step->item].name;
    const bool mounted = assembly->is_mounted[step->item];
    *key = NULL;
    if (assembly->is_off)
        return wb_fail_to(why, WB_ERR_ARGUMENT, "`take_off` is the last step");
    if (step->kind == WB_HARNESS_HANG && assembly->hangs)
        return wb_fail_to(why, WB_ERR_ARGUMENT, "the harness hangs already");
    if (step->kind == WB_HARNESS_HANG || step->kind == WB_HARNESS_TAKE_OFF)
        return WB_OK;
    *key = steps[step->kind];
    if (step->kind == WB_HARNESS_MOUNT && mounted)
        return wb_fail_to(why, WB_ERR_ARGUMENT, "%s is mounted already; `move` moves it", name);
    if (step->kind != WB_HARNESS_MOUNT && !mounted)
        return wb_fail_to(why, WB_ERR_ARGUMENT, "%s is not mounted", name);
    if (step->kind != WB_HARNESS_RELEASE)
        return check_target(plan, assembly, step, key, why);
    if (!holds_another(plan, assembly, step->item))
        return wb_fail_to(why, WB_ERR_ARGUMENT,
                          "nothing would be held; `take_off` takes the harness off");
    return WB_OK;
}

void wb_harness_file_begin(const struct wb_harness_plan *plan, struct wb_harness_assembly *assembly)
{
    *assembly = (struct wb_harness_assembly){.is_mounted = {true}};
    memcpy(assembly->place[0], plan->root.position, sizeof assembly->place[0]);
}

void wb_harness_file_apply_step(const struct wb_harness_step *step,
                                struct wb_harness_assembly *assembly)
{
    switch (step->kind) {
    case WB_HARNESS_HANG:
        assembly->hangs = true;
        break;
    case WB_HARNESS_TAKE_OFF:
        assembly->is_off = true;
        break;
    case WB_HARNESS_RELEASE:
        assembly->is_mounted[step->item] = false;
        break;
    case WB_HARNESS_MOUNT:
    case WB_HARNESS_MOVE:
        memcpy(assembly->place[step->item], step->position, sizeof step->position);
        assembly->is_mounted[step->item] = true;
        break;
    }
}

static enum wb_status read_target(const struct wb_config_node *map, const char *beside,
                                  struct wb_harness_step *step)
{
    const struct wb_config_node *at = NULL, *direction = NULL, *up = NULL;
    const struct wb_config_key keys[] = {
        WB_CONFIG_IGNORED(steps[step->kind]),
        WB_CONFIG_NODE("at_mm", &at),
        WB_CONFIG_OPTIONAL_NODE("direction", &direction),
        WB_CONFIG_OPTIONAL_NODE("up", &up),
        WB_CONFIG_IGNORED(beside),
    };
    WB_TRY(wb_config_map(map, keys, WB_COUNT(keys) - !beside));
    WB_TRY(read_vector(map, "at_mm", at, WB_MM, 1e6, step->position));
    step->has_direction = direction;
    step->has_up = up;
    if (direction)
        WB_TRY(read_direction(map, "direction", direction, step->direction));
    if (up)
        WB_TRY(read_direction(map, "up", up, step->up));
    return WB_OK;
}

static enum wb_status read_action(const struct wb_harness_plan *plan,
                                  const struct wb_config_node *map, const char *beside,
                                  struct wb_harness_step *step)
{
    int found = -1;
    for (int kind = WB_HARNESS_MOUNT; kind <= WB_HARNESS_RELEASE; kind++)
        found = wb_config_find(map, steps[kind]) ? kind : found;
    if (found < 0)
        return wb_config_refuse(map, NULL,
                                "expected `hang`, `take_off`, or a map with one of "
                                "`mount`, `move` and `release`");
    step->kind = (enum wb_harness_step_kind)found;
    const char *const key = steps[step->kind];
    const char *const name = wb_config_scalar(wb_config_find(map, key));
    step->item = name ? wb_harness_file_find_item(plan, name) : -1;
    if (step->item < 0)
        return wb_config_refuse(map, key, "no connector, clip or root is named '%s'",
                                name ? name : "");
    snprintf(step->name, sizeof step->name, "%s %s", key, name);
    if (step->kind != WB_HARNESS_RELEASE)
        return read_target(map, beside, step);
    const struct wb_config_key keys[] = {WB_CONFIG_IGNORED(key), WB_CONFIG_IGNORED(beside)};
    return wb_config_map(map, keys, WB_COUNT(keys) - !beside);
}

enum wb_status wb_harness_file_parse_step(const struct wb_harness_plan *plan,
                                          const struct wb_config_node *node, const char *beside,
                                          struct wb_harness_step *step)
{
    const char *const word = wb_config_scalar(node);
    *step = (struct wb_harness_step){.kind = WB_HARNESS_HANG};
    if (!word)
        return read_action(plan, node, beside, step);
    if (strcmp(word, steps[WB_HARNESS_TAKE_OFF]) == 0)
        step->kind = WB_HARNESS_TAKE_OFF;
    else if (strcmp(word, steps[WB_HARNESS_HANG]) != 0)
        return wb_config_refuse(node, NULL,
                                "'%s': expected hang, take_off, or a map with one of "
                                "mount, move and release",
                                word);
    snprintf(step->name, sizeof step->name, "%s", word);
    return WB_OK;
}

static enum wb_status read_step(void *context, const struct wb_config_node *node)
{
    struct reader *const reader = context;
    struct wb_harness_plan *const plan = reader->plan;
    struct wb_harness_step *const step = &plan->steps[plan->n_steps];
    struct wb_reason why = {""};
    const char *key;
    WB_TRY(wb_harness_file_parse_step(plan, node, NULL, step));
    if (wb_harness_file_check_step(plan, &reader->assembly, step, &key, &why) != WB_OK)
        return wb_config_refuse(node, key, "%s", why.text);
    wb_harness_file_apply_step(step, &reader->assembly);
    plan->n_steps++;
    return WB_OK;
}

/* --- the file --- */

static enum wb_status read_root(struct reader *reader, const struct wb_config_node *map)
{
    struct wb_harness_plan *const plan = reader->plan;
    const struct wb_config_node *at = NULL, *direction_node = NULL, *up_node = NULL;
    double direction[3] = {1.0, 0.0, 0.0}, up[3] = {0.0, 0.0, 1.0};
    struct wb_harness_item item = {.kind = WB_HARNESS_ROOT, .branch = -1, .hold = WB_HARNESS_FIXED};
    const struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("name", item.name),
        WB_CONFIG_OPTIONAL_NODE("at_mm", &at),
        WB_CONFIG_OPTIONAL_NODE("direction", &direction_node),
        WB_CONFIG_OPTIONAL_NODE("up", &up_node),
        WB_CONFIG_OPTIONAL_NUMBER("most_force_N", &item.largest_force, 1.0, 1e-9, 1e9),
        WB_CONFIG_OPTIONAL_NUMBER("most_moment_N_mm", &item.largest_moment, WB_NMM, 1e-9, 1e9),
    };
    WB_TRY(wb_config_map(map, keys, WB_COUNT(keys)));
    if (at)
        WB_TRY(read_vector(map, "at_mm", at, WB_MM, 1e6, plan->root.position));
    if (direction_node)
        WB_TRY(read_direction(map, "direction", direction_node, direction));
    if (up_node)
        WB_TRY(read_direction(map, "up", up_node, up));
    if (is_parallel(direction, up))
        return wb_config_refuse(map, "direction", "%s", parallel);
    wb_harness_file_rotation(direction, up, NULL, plan->root.rotation);
    snprintf(reader->root, sizeof reader->root, "%s", item.name);
    wb_harness_file_begin(plan, &reader->assembly);
    return add_item(reader, map, &item);
}

static enum wb_status read_top(struct reader *reader)
{
    struct wb_harness_plan *const plan = reader->plan;
    const struct wb_config_node *const top = reader->file.root;
    const struct wb_config_node *gravity = NULL, *wires = NULL, *root = NULL, *branches = NULL,
                                *connectors = NULL, *clips = NULL, *obstacles = NULL, *list = NULL;
    static const char *const kind_words[] = {"harness", NULL};
    int kind;
    const struct wb_config_key keys[] = {
        WB_CONFIG_CHOICE("kind", &kind, kind_words),
        WB_CONFIG_TEXT("name", plan->name),
        WB_CONFIG_OPTIONAL_TEXT("title", plan->title),
        WB_CONFIG_OPTIONAL_NODE("gravity_m_s2", &gravity),
        WB_CONFIG_NODE("wires", &wires),
        WB_CONFIG_NODE("root", &root),
        WB_CONFIG_NODE("branches", &branches),
        WB_CONFIG_OPTIONAL_NODE("connectors", &connectors),
        WB_CONFIG_OPTIONAL_NODE("clips", &clips),
        WB_CONFIG_OPTIONAL_NODE("obstacles", &obstacles),
        WB_CONFIG_NODE("steps", &list),
    };
    plan->gravity[2] = -WB_STANDARD_GRAVITY;
    WB_TRY(wb_config_map(top, keys, WB_COUNT(keys)));
    WB_TRY(check_name(top, plan->name));
    if (gravity)
        WB_TRY(read_vector(top, "gravity_m_s2", gravity, 1.0, 1e3, plan->gravity));
    WB_TRY(wb_model_file_list(top, "wires", wires, WB_HARNESS_MOST_WIRES, read_wire, reader));
    WB_TRY(read_root(reader, root));
    WB_TRY(wb_model_file_list(top, "branches", branches, WB_HARNESS_MOST_BRANCHES, read_branch,
                              reader));
    WB_TRY(sort_branches(reader, branches));
    if (connectors)
        WB_TRY(wb_model_file_list(top, "connectors", connectors, WB_HARNESS_MOST_BRANCHES,
                                  read_connector, reader));
    if (clips)
        WB_TRY(wb_model_file_list(top, "clips", clips, 100, read_clip, reader));
    if (obstacles)
        WB_TRY(wb_model_file_list(top, "obstacles", obstacles, WB_HARNESS_MOST_OBSTACLES,
                                  read_obstacle, reader));
    return wb_model_file_list(top, "steps", list, WB_HARNESS_MOST_STEPS, read_step, reader);
}

enum wb_status wb_harness_file_read(struct wb_harness_plan *plan, const char *path)
{
    struct reader *const reader = wb_memory_new(1, sizeof *reader);
    reader->plan = plan;
    *plan = (struct wb_harness_plan){.n_wires = 0};
    snprintf(plan->path, sizeof plan->path, "%s", path);
    enum wb_status status = wb_hash_file(path, plan->sha256);
    if (status == WB_OK)
        status = wb_model_file_open(&reader->file, path);
    if (status == WB_OK)
        status = read_top(reader);
    wb_model_file_close(&reader->file);
    free(reader);
    return status;
}
