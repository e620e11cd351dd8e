#include "analysis/harness/harness_quicklook.h"

#include <math.h>
#include <stdio.h>

#include "analysis/harness/harness_drawing.h"
#include "base/file.h"
#include "base/units.h"

#define PNG_SCALE 2.5

static const struct wb_harness_settings settings = {.torsion = 1.0};
static const char *const kinds[] = {
    [WB_HARNESS_ROOT] = "root",
    [WB_HARNESS_CONNECTOR] = "connector",
    [WB_HARNESS_CLIP] = "clip",
};
/* As in the harness file. */
static const char *const holds[] = {
    [WB_HARNESS_POINT] = "holds point",
    [WB_HARNESS_AXIS] = "holds axis",
    [WB_HARNESS_FIXED] = "holds all",
    [WB_HARNESS_SLIDE] = "lets the wire slide",
};

enum wb_status wb_harness_quicklook_compute(struct wb_harness_result_set *set,
                                            struct wb_harness_plan *plan)
{
    const int n_steps = plan->n_steps;
    plan->n_steps = 0; /* only the shape before all steps */
    const enum wb_status status = wb_harness_run_compute(set, plan, &settings, NULL, NULL);
    plan->n_steps = n_steps;
    return status;
}

/* --- sizes --- */

static double wire_length(const struct wb_harness_plan *plan)
{
    double length = 0.0;
    for (int i = 0; i < plan->n_branches; i++)
        length += plan->branches[i].length;
    return length;
}

static void find_box(const struct wb_harness_result_set *set, double low[3], double high[3])
{
    static const double least = 1e-9; /* m; less is round-off */
    for (int k = 0; k < 3; k++) {
        low[k] = (double)INFINITY;
        high[k] = -(double)INFINITY;
        for (int i = 0; i < set->n_places; i++) {
            const double at = set->natural[i].position[k];
            low[k] = fmin(low[k], fabs(at) < least ? 0.0 : at);
            high[k] = fmax(high[k], fabs(at) < least ? 0.0 : at);
        }
    }
}

static double rigidity(const struct wb_harness_wire *wire)
{
    return wire->law.material.youngs_modulus * M_PI * pow(wire->diameter, 4.0) / 64.0;
}

/* --- summary --- */

static void append_wires(const struct wb_harness_result_set *set, struct wb_text *text)
{
    const struct wb_harness_plan *const plan = set->plan;
    wb_text_append(text, "\nwires\n");
    for (int i = 0; i < plan->n_wires; i++) {
        const struct wb_harness_wire *const wire = &plan->wires[i];
        wb_text_append(text, "  %-12s %s%s, %.3g mm, %.3g g/m, EI %.4g N mm2, GJ %.4g N mm2%s\n",
                       wire->name, wire->file, wire->is_virtual ? " (virtual rig)" : "",
                       wire->diameter / WB_MM, wire->mass / WB_G, rigidity(wire) / WB_NMM2,
                       wb_harness_run_torsion(plan, i, &settings) / WB_NMM2,
                       wire->torsional_stiffness > 0.0 ? "" : " (not measured)");
    }
}

static void append_branches(const struct wb_harness_plan *plan, struct wb_text *text)
{
    wb_text_append(text, "\nbranches\n");
    for (int i = 0; i < plan->n_branches; i++) {
        const struct wb_harness_plan_branch *const b = &plan->branches[i];
        wb_text_append(text, "  %-12s %s to %s, %s, %.4g mm%s", b->name, b->from, b->to,
                       plan->wires[b->wire].name, b->length / WB_MM,
                       b->n_curve > 0 ? ", curved" : "");
        if (b->least_radius > 0.0)
            wb_text_append(text, ", limit of the bend radius %.3g mm", b->least_radius / WB_MM);
        wb_text_append(text, "\n");
    }
}

static void append_items(const struct wb_harness_plan *plan, struct wb_text *text)
{
    wb_text_append(text, "\nroot, connectors and clips\n");
    for (int i = 0; i < plan->n_items; i++) {
        const struct wb_harness_item *const item = &plan->items[i];
        wb_text_append(text, "  %-12s %s", item->name, kinds[item->kind]);
        if (item->branch >= 0)
            wb_text_append(text, " on %s at %.4g mm", plan->branches[item->branch].name,
                           item->at / WB_MM);
        if (item->kind == WB_HARNESS_CLIP)
            wb_text_append(text, ", %s", holds[item->hold]);
        if (item->hold == WB_HARNESS_SLIDE)
            wb_text_append(text, ", friction %.3g", item->friction);
        if (item->mass > 0.0)
            wb_text_append(text, ", %.3g g", item->mass / WB_G);
        if (item->largest_force > 0.0)
            wb_text_append(text, ", limit %.3g N", item->largest_force);
        if (item->largest_moment > 0.0)
            wb_text_append(text, ", limit %.4g N mm", item->largest_moment / WB_NMM);
        wb_text_append(text, "\n");
    }
}

static void append_obstacles(const struct wb_harness_plan *plan, struct wb_text *text)
{
    if (plan->n_obstacles > 0)
        wb_text_append(text, "\nobstacles\n");
    for (int i = 0; i < plan->n_obstacles; i++) {
        const struct wb_obstacle *const body = &plan->obstacles[i].body;
        wb_text_append(text, "  %-12s %s at (%.4g, %.4g, %.4g) mm, friction %.3g\n",
                       plan->obstacles[i].name, wb_harness_file_shapes[body->kind],
                       body->place[0] / WB_MM, body->place[1] / WB_MM, body->place[2] / WB_MM,
                       body->friction);
    }
}

static void append_steps(const struct wb_harness_plan *plan, struct wb_text *text)
{
    wb_text_append(text, "\nsteps, not computed here\n");
    for (int i = 0; i < plan->n_steps; i++) {
        const struct wb_harness_step *const step = &plan->steps[i];
        wb_text_append(text, "  %2d  %s", i + 1, step->name);
        if (step->kind == WB_HARNESS_MOUNT || step->kind == WB_HARNESS_MOVE)
            wb_text_append(text, " at (%.4g, %.4g, %.4g) mm", step->position[0] / WB_MM,
                           step->position[1] / WB_MM, step->position[2] / WB_MM);
        wb_text_append(text, "\n");
    }
}

void wb_harness_quicklook_summary(const struct wb_harness_result_set *set, struct wb_text *text)
{
    const struct wb_harness_plan *const plan = set->plan;
    double low[3], high[3];
    find_box(set, low, high);
    wb_text_append(text, "%s (harness file, stress-free shape)\n\n", plan->name);
    if (plan->title[0])
        wb_text_append(text, "title        %s\n", plan->title);
    wb_text_append(text, "length       %.4g mm in %d branches\n", wire_length(plan) / WB_MM,
                   plan->n_branches);
    wb_text_append(text, "weight       %.3g N with connectors\n", set->weight);
    wb_text_append(text, "extent       x %.4g to %.4g, y %.4g to %.4g, z %.4g to %.4g mm\n",
                   low[0] / WB_MM, high[0] / WB_MM, low[1] / WB_MM, high[1] / WB_MM, low[2] / WB_MM,
                   high[2] / WB_MM);
    append_wires(set, text);
    append_branches(plan, text);
    append_items(plan, text);
    append_obstacles(plan, text);
    append_steps(plan, text);
}

/* --- the same as an object --- */

static void put_point(struct wb_json *object, const char *key, const double point[3])
{
    struct wb_json *const list = wb_json_set_array(object, key);
    for (int k = 0; k < 3; k++)
        wb_json_append_number(list, point[k] / WB_MM);
}

static void describe_wires(const struct wb_harness_result_set *set, struct wb_json *object)
{
    const struct wb_harness_plan *const plan = set->plan;
    struct wb_json *const list = wb_json_set_array(object, "wires");
    for (int i = 0; i < plan->n_wires; i++) {
        const struct wb_harness_wire *const wire = &plan->wires[i];
        struct wb_json *const item = wb_json_append_object(list);
        wb_json_set_text(item, "name", wire->name);
        wb_json_set_text(item, "file", wire->file);
        wb_json_set_text(item, "sha256", wire->sha256);
        wb_json_set_boolean(item, "virtual_rig", wire->is_virtual);
        wb_json_set_number(item, "flexural_rigidity_N_mm2", rigidity(wire) / WB_NMM2);
        wb_json_set_number(item, "torsional_stiffness_N_mm2",
                           wb_harness_run_torsion(plan, i, &settings) / WB_NMM2);
        wb_json_set_text(item, "torsional_stiffness_from",
                         wire->torsional_stiffness > 0.0 ? "file" : "default");
    }
}

static void describe_branches(const struct wb_harness_plan *plan, struct wb_json *object)
{
    struct wb_json *const list = wb_json_set_array(object, "branches");
    for (int i = 0; i < plan->n_branches; i++) {
        struct wb_json *const item = wb_json_append_object(list);
        wb_json_set_text(item, "name", plan->branches[i].name);
        wb_json_set_text(item, "from", plan->branches[i].from);
        wb_json_set_text(item, "to", plan->branches[i].to);
        wb_json_set_text(item, "wire", plan->wires[plan->branches[i].wire].name);
        wb_json_set_number(item, "length_mm", plan->branches[i].length / WB_MM);
    }
}

static void describe_items(const struct wb_harness_plan *plan, struct wb_json *object)
{
    struct wb_json *const list = wb_json_set_array(object, "items");
    for (int i = 0; i < plan->n_items; i++) {
        const struct wb_harness_item *const item = &plan->items[i];
        struct wb_json *const entry = wb_json_append_object(list);
        wb_json_set_text(entry, "name", item->name);
        wb_json_set_text(entry, "kind", kinds[item->kind]);
        if (item->branch < 0)
            continue;
        wb_json_set_text(entry, "branch", plan->branches[item->branch].name);
        wb_json_set_number(entry, "at_mm", item->at / WB_MM);
    }
}

void wb_harness_quicklook_describe(const struct wb_harness_result_set *set, struct wb_json *object)
{
    const struct wb_harness_plan *const plan = set->plan;
    double low[3], high[3];
    find_box(set, low, high);
    wb_json_set_text(object, "name", plan->name);
    wb_json_set_text(object, "data", "stress-free shape of a harness file");
    wb_json_set_text(object, "file_sha256", plan->sha256);
    wb_json_set_number(object, "length_mm", wire_length(plan) / WB_MM);
    wb_json_set_number(object, "weight_N", set->weight);
    put_point(object, "low_mm", low);
    put_point(object, "high_mm", high);
    describe_wires(set, object);
    describe_branches(plan, object);
    describe_items(plan, object);
    struct wb_json *const obstacles = wb_json_set_array(object, "obstacles");
    for (int i = 0; i < plan->n_obstacles; i++) {
        struct wb_json *const item = wb_json_append_object(obstacles);
        wb_json_set_text(item, "name", plan->obstacles[i].name);
        wb_json_set_text(item, "kind", wb_harness_file_shapes[plan->obstacles[i].body.kind]);
        put_point(item, "at_mm", plan->obstacles[i].body.place);
    }
    struct wb_json *const steps = wb_json_set_array(object, "steps");
    for (int i = 0; i < plan->n_steps; i++)
        wb_json_append_text(steps, plan->steps[i].name);
}

/* --- files --- */

static enum wb_status write_drawing(const struct wb_harness_result_set *set, const char *folder)
{
    static const char *const names[] = {"shape.svg", "shape.png", "shape.pdf"};
    struct wb_harness_drawing drawing;
    struct wb_figure *figure;
    struct wb_text footer = {0};
    char path[WB_PATH];
    wb_text_append_escaped(&footer, set->plan->name);
    wb_text_append(&footer, ": stress-free shape from the harness file");
    wb_harness_drawing_of_natural(&drawing, set);
    enum wb_status status = wb_harness_drawing_create(&drawing, wb_text_string(&footer), &figure);
    wb_text_release(&footer);
    if (status != WB_OK)
        return status;
    for (size_t i = 0; i < sizeof names / sizeof names[0] && status == WB_OK; i++) {
        status = wb_file_join(path, folder, names[i]);
        if (status == WB_OK)
            status = wb_figure_write_file(figure, PNG_SCALE, path);
    }
    wb_figure_destroy(figure);
    return status;
}

enum wb_status wb_harness_quicklook_write(const struct wb_harness_result_set *set,
                                          const char *folder, bool force)
{
    struct wb_text text = {0};
    char path[WB_PATH];
    WB_TRY(wb_file_prepare_output(folder, force));
    WB_TRY(write_drawing(set, folder));
    WB_TRY(wb_file_join(path, folder, "summary.txt"));
    wb_harness_quicklook_summary(set, &text);
    const enum wb_status status = wb_file_write_text(path, &text);
    wb_text_release(&text);
    return status;
}
