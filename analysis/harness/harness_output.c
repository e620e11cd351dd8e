#include "analysis/harness/harness_output.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/dataset/csv_table.h"
#include "analysis/harness/harness_bands_output.h"
#include "analysis/harness/harness_found.h"
#include "analysis/keys/common.h"
#include "analysis/keys/row.h"
#include "base/file.h"
#include "base/number.h"
#include "base/units.h"

#define FORCE(member) WB_AT(struct wb_harness_force, member)
#define BRANCH(member) WB_AT(struct wb_harness_branch_result, member)
#define STEP(member) WB_AT(struct wb_harness_step_result, member)
#define SNAP(member) WB_AT(struct wb_harness_snap, member)
#define WIRE(member) WB_AT(struct wb_harness_wire, member)
#define PLAN(member) WB_AT(struct wb_harness_plan, member)

/* --- harness.json --- */

static const struct wb_key wire_rows[] = {
    {"name", WIRE(name), "name in the harness"},
    {"file", WIRE(file), "its file, without folders"},
    {"sha256", WIRE(sha256), "checksum of the file"},
    {"virtual_rig", WIRE(is_virtual), "calibrated on a virtual rig"},
    {"outer_diameter_mm", WIRE(diameter), "outer diameter"},
    {"mass_per_length_kg_m", WIRE(mass), "mass per length"},
    {"largest_curvature_1_m", WIRE(largest_curvature) | UNKNOWN,
     "largest curvature of the calibration; null: not known"},
    {"has_unloading", WIRE(has_unloading), "calibrated on unloading, too"},
    {"flexural_rigidity_N_mm2", NUMBER, "EI of the law at zero curvature"},
    {"torsional_stiffness_N_mm2", NUMBER, "torsional stiffness GJ"},
    {"torsional_stiffness_from", TEXT, "the harness file, or by default EI / (1 + nu)",
     .choices = "file|default"},
};
static WB_KEYS(wire, "harness_wire", "A wire of a harness.");

static const struct wb_key snap_rows[] = {
    {"fraction", SNAP(fraction), "of the step"},
    {"branch", TEXT, "branch that moved farthest; empty: the root"},
    {"at_mm", NUMBER, "place there"},
    {"distance_mm", SNAP(distance), "how far it moved"},
};
static WB_KEYS(snap, "harness_snap",
               "A place where the equilibrium became unstable and the harness moved to another.");

static const struct wb_key force_rows[] = {
    {"name", TEXT, "root, connector, clip or obstacle"},
    {"force_N", FORCE(size), "force on the wire at the end of the step"},
    {"moment_N_mm", FORCE(moment_size), "moment on the wire"},
    {"force_vector_N", WB_FULL(struct wb_harness_force, force),
     "the force along the wire, across and up, in the frame of the section there, or that of the "
     "obstacle"},
    {"moment_vector_N_mm", WB_FULL(struct wb_harness_force, moment),
     "the moment in that frame; of an obstacle about its place"},
    {"slid_mm", FORCE(slid) | IF_KNOWN,
     "length of wire that slid through the clip since its mount, towards the branch's beginning"},
    {"largest_force_N", FORCE(largest), "largest force during the step"},
    {"largest_moment_N_mm", FORCE(largest_moment), "largest moment during the step"},
    {"exceeds_force", FORCE(exceeds_force), "the limit of the force was exceeded"},
    {"exceeds_moment", FORCE(exceeds_moment), "the limit of the moment was exceeded"},
    {"soft_torsion_force_N", FORCE(soft_force) | IF_KNOWN,
     "force_N where torsional stiffnesses by default are a fifth of that"},
    {"twist_sensitive", FLAG | OPTIONAL,
     "that differs by more than 10 %: the force depends on a stiffness that is not measured"},
};
static WB_KEYS(force, "harness_force",
               "What holds the wires at a mounted item, or an obstacle that they touch.");

static const struct wb_key branch_rows[] = {
    {"name", TEXT, "branch"},
    {"least_radius_mm", BRANCH(least_radius) | UNKNOWN, "least bend radius; null: straight"},
    {"at_mm", BRANCH(at), "where it is"},
    {"tightest_radius_mm", BRANCH(tightest_radius) | UNKNOWN,
     "least bend radius during the step; null: straight"},
    {"largest_bending_1_m", BRANCH(largest_bending),
     "largest curvature relative to the natural shape"},
    {"largest_bending_so_far_1_m", BRANCH(largest_bending_so_far),
     "the same, from the first step on"},
    {"beyond_calibration", BRANCH(is_beyond), "more than the curvature of the calibration"},
    {"exceeds_radius", BRANCH(exceeds_radius), "the radius was below its limit during the step"},
};
static WB_KEYS(branch, "harness_branch", "A branch at the end of a step.");

static const struct wb_key step_rows[] = {
    {"name", TEXT, "step"},
    {"converged", FLAG, "it ended at an equilibrium"},
    {"fraction", STEP(fraction), "of the step that was completed"},
    {"problem", TEXT | OPTIONAL, "why it was not completed"},
    {"branch", TEXT | OPTIONAL, "branch where no equilibrium was found"},
    {"increments", STEP(increments), "number of increments"},
    {"iterations", STEP(iterations), "number of Newton iterations"},
    {"elastic_mJ", STEP(elastic),
     "energy that the wires give back when they are unloaded elastically"},
    {"plastic_mJ", STEP(plastic),
     "plastic work from the first step on: dissipated, or kept by the hardening"},
    {"snaps", OBJECT | LIST, "snaps during the step", &snap_keys},
    {"forces", OBJECT | LIST, "forces of the mounted items and the obstacles", &force_keys},
    {"branches", OBJECT | LIST, "branches", &branch_keys},
};
const struct wb_keys wb_harness_output_step_keys = {"harness_step", "A step of the assembly.",
                                                    step_rows, WB_COUNT(step_rows)};

static const struct wb_key residual_rows[] = {
    {"distance_mm", NUMBER, "largest distance from the stress-free shape before"},
    {"branch", TEXT, "where it is"},
};
static WB_KEYS(residual, "harness_residual", "The shape of the harness after it was taken off.");

static const struct wb_key wb_harness_output_result_rows[] = {
    {"name", PLAN(name), "name of the harness"},
    {"title", PLAN(title) | OPTIONAL, "title"},
    {"file_sha256", PLAN(sha256), "checksum of the harness file"},
    {"law", TEXT, "whether the wires may yield", .choices = "elastoplastic|elastic"},
    {"elements", INTEGER, "number of elements"},
    {"weight_N", NUMBER, "weight of branches and connectors"},
    {"converged", FLAG, "all steps were computed"},
    {"wires", WB_POINTER(struct wb_harness_plan, wires, n_wires), "wires", &wire_keys},
    {"steps", OBJECT | LIST, "steps", &wb_harness_output_step_keys},
    {"residual_shape", OBJECT | OPTIONAL, "shape after the harness was taken off", &residual_keys},
    {"uncertainty", OBJECT | OPTIONAL, "bands of forces and shapes, with `--uncertain`",
     &wb_harness_bands_output_keys},
};
WB_KEYS(wb_harness_output_result, "harness_result", "A harness that was computed.");

static const struct wb_key wb_harness_output_rows[] = {
    {"tool", OBJECT, "the program", &wb_common_tool_keys},
    {"kind", TEXT, "kind of file", .choices = "harness"},
    {.of = &wb_harness_output_result_keys},
};
WB_KEYS(wb_harness_output, "harness", "`wirebench solve harness`.");

static const char *branch_name(const struct wb_harness_plan *plan, int branch)
{
    return branch < 0 ? "" : plan->branches[branch].name;
}

static void put_wires(struct wb_json *object, const struct wb_harness_result_set *set)
{
    struct wb_json *const list = wb_json_set_array(object, "wires");
    for (int i = 0; i < set->plan->n_wires; i++) {
        const struct wb_harness_wire *const wire = &set->plan->wires[i];
        struct wb_json *const item = wb_json_append_object(list);
        WB_PUT(item, &wire_keys, struct wb_harness_wire, wire);
        wb_json_set_number(item, "flexural_rigidity_N_mm2",
                           wire->law.material.youngs_modulus * M_PI * pow(wire->diameter, 4.0) /
                               64.0 / WB_NMM2);
        wb_json_set_number(item, "torsional_stiffness_N_mm2",
                           wb_harness_run_torsion(set->plan, i, &set->settings) / WB_NMM2);
        wb_json_set_text(item, "torsional_stiffness_from",
                         wire->torsional_stiffness > 0.0 ? "file" : "default");
    }
}

static void put_snaps(struct wb_json *object, const struct wb_harness_plan *plan,
                      const struct wb_harness_step_result *step)
{
    struct wb_json *const list = wb_json_set_array(object, "snaps");
    for (int i = 0; i < step->n_snaps; i++) {
        const struct wb_harness_snap *const snap = &step->snaps[i];
        struct wb_json *const item = wb_json_append_object(list);
        WB_PUT(item, &snap_keys, struct wb_harness_snap, snap);
        wb_json_set_text(item, "branch", branch_name(plan, step->snap_branch[i]));
        wb_json_set_number(item, "at_mm", step->snap_at[i] / WB_MM);
        WB_PUT(item, &snap_keys, struct wb_harness_snap, snap);
    }
}

void wb_harness_output_put_step(struct wb_json *object, const struct wb_harness_plan *plan,
                                const char *name, const struct wb_harness_step_result *step)
{
    wb_json_set_text(object, "name", name);
    wb_json_set_boolean(object, "converged", step->end == WB_HARNESS_CONVERGED);
    WB_PUT(object, &wb_harness_output_step_keys, struct wb_harness_step_result, step);
    if (step->problem)
        wb_json_set_text(object, "problem", step->problem);
    if (step->worst_branch >= 0)
        wb_json_set_text(object, "branch", branch_name(plan, step->worst_branch));
    WB_PUT(object, &wb_harness_output_step_keys, struct wb_harness_step_result, step);
    put_snaps(object, plan, step);
    struct wb_json *const forces = wb_json_set_array(object, "forces");
    for (int i = 0; i < wb_harness_file_n_holders(plan); i++) {
        const struct wb_harness_force *const force = &step->forces[i];
        if (!force->is_mounted)
            continue;
        struct wb_json *const item = wb_json_append_object(forces);
        wb_json_set_text(item, "name", wb_harness_file_holder(plan, i));
        WB_PUT(item, &force_keys, struct wb_harness_force, force);
        if (isfinite(force->soft_force))
            wb_json_set_boolean(item, "twist_sensitive",
                                wb_harness_found_is_twist_sensitive(force));
    }
    struct wb_json *const branches = wb_json_set_array(object, "branches");
    for (int i = 0; i < plan->n_branches; i++) {
        struct wb_json *const item = wb_json_append_object(branches);
        wb_json_set_text(item, "name", plan->branches[i].name);
        WB_PUT(item, &branch_keys, struct wb_harness_branch_result, &step->branches[i]);
    }
}

void wb_harness_output_put_result(struct wb_json *object, const struct wb_harness_result_set *set,
                                  const struct wb_harness_bands *bands)
{
    const struct wb_harness_plan *const plan = set->plan;
    struct wb_harness_found found;
    wb_harness_found_collect(&found, set);
    WB_PUT(object, &wb_harness_output_result_keys, struct wb_harness_plan, plan);
    wb_json_set_text(object, "law", set->settings.is_elastic ? "elastic" : "elastoplastic");
    wb_json_set_integer(object, "elements", set->n_elements);
    wb_json_set_number(object, "weight_N", set->weight);
    wb_json_set_boolean(object, "converged", set->converged);
    put_wires(object, set);
    struct wb_json *const steps = wb_json_set_array(object, "steps");
    for (int i = 0; i < set->n_steps; i++)
        wb_harness_output_put_step(wb_json_append_object(steps), plan, plan->steps[i].name,
                                   &set->results[i]);
    if (found.is_taken_off) {
        struct wb_json *const residual = wb_json_set_object(object, "residual_shape");
        wb_json_set_number(residual, "distance_mm", found.residual.value / WB_MM);
        wb_json_set_text(residual, "branch", branch_name(plan, found.residual.of));
    }
    if (bands)
        wb_harness_bands_output_put(wb_json_set_object(object, "uncertainty"), bands);
}

void wb_harness_output_put(struct wb_json *object, const struct wb_harness_result_set *set,
                           const struct wb_harness_bands *bands)
{
    wb_keys_put_tool(object, "wirebench solve");
    wb_json_set_text(object, "kind", "harness");
    wb_harness_output_put_result(object, set, bands);
}

/* --- tables --- */

struct column {
    double value;
    int shift; /* decimal digits to the file's unit */
};

static void append_row(struct wb_text *text, const char *step, const char *name,
                       const struct column *columns, size_t n)
{
    wb_text_append(text, "%s,%s", step, name);
    for (size_t i = 0; i < n; i++) {
        wb_text_append(text, ",");
        wb_csv_table_append_number(text, columns[i].value, columns[i].shift);
    }
    wb_text_append(text, "\n");
}

#define PLACE(member) offsetof(struct wb_harness_place, member)

const struct wb_harness_output_column wb_harness_output_columns[WB_HARNESS_OUTPUT_COLUMNS] = {
    {"s_mm", PLACE(s), 3},
    {"x_mm", PLACE(position[0]), 3},
    {"y_mm", PLACE(position[1]), 3},
    {"z_mm", PLACE(position[2]), 3},
    {"direction_x", PLACE(direction[0]), 0},
    {"direction_y", PLACE(direction[1]), 0},
    {"direction_z", PLACE(direction[2]), 0},
    {"curvature_1_m", PLACE(curvature), 0},
    {"twist_1_m", PLACE(twist), 0},
    {"moment_N_mm", PLACE(moment), 3},
    {"torque_N_mm", PLACE(torque), 3},
    {"tension_N", PLACE(tension), 0},
};

double wb_harness_output_value(const struct wb_harness_place *place,
                               const struct wb_harness_output_column *column)
{
    return *(const double *)(const void *)((const char *)place + column->offset);
}

static void append_places(struct wb_text *text, const struct wb_harness_result_set *set,
                          const char *step, const struct wb_harness_place *places)
{
    for (int i = 0; i < set->n_places; i++) {
        struct column columns[WB_HARNESS_OUTPUT_COLUMNS];
        for (int c = 0; c < WB_HARNESS_OUTPUT_COLUMNS; c++) {
            const struct wb_harness_output_column *const column = &wb_harness_output_columns[c];
            columns[c] =
                (struct column){wb_harness_output_value(&places[i], column), column->shift};
        }
        append_row(text, step, set->plan->branches[places[i].branch].name, columns,
                   WB_HARNESS_OUTPUT_COLUMNS);
    }
}

static enum wb_status write_shapes(const struct wb_harness_result_set *set, const char *folder)
{
    const char *names[2 + WB_HARNESS_OUTPUT_COLUMNS] = {"step", "branch"};
    for (int c = 0; c < WB_HARNESS_OUTPUT_COLUMNS; c++)
        names[2 + c] = wb_harness_output_columns[c].key;
    struct wb_text text = {0};
    wb_csv_table_append_header(&text, names, WB_COUNT(names));
    for (int i = 0; i < set->n_shapes; i++) {
        char step[WB_NUMBER_TEXT];
        append_places(&text, set, i == 0 ? "natural" : wb_number_format(set->shapes[i].time, step),
                      set->shapes[i].places);
    }
    const enum wb_status status = wb_csv_table_write(folder, "shapes.csv", &text);
    wb_text_release(&text);
    return status;
}

static enum wb_status write_forces(const struct wb_harness_result_set *set, const char *folder)
{
    static const char *const names[] = {"step",
                                        "item",
                                        "force_N",
                                        "force_along_N",
                                        "force_across_N",
                                        "force_up_N",
                                        "moment_N_mm",
                                        "moment_along_N_mm",
                                        "moment_across_N_mm",
                                        "moment_up_N_mm",
                                        "largest_force_N",
                                        "largest_moment_N_mm",
                                        "slid_mm"};
    struct wb_text text = {0};
    wb_csv_table_append_header(&text, names, WB_COUNT(names));
    for (int i = 1; i < set->n_shapes; i++) {
        char step[WB_NUMBER_TEXT];
        (void)wb_number_format(set->shapes[i].time, step);
        for (int k = 0; k < wb_harness_file_n_holders(set->plan); k++) {
            const struct wb_harness_force *const f = &set->shapes[i].forces[k];
            const struct column columns[] = {
                {f->size, 0},        {f->force[0], 0},       {f->force[1], 0},  {f->force[2], 0},
                {f->moment_size, 3}, {f->moment[0], 3},      {f->moment[1], 3}, {f->moment[2], 3},
                {f->largest, 0},     {f->largest_moment, 3}, {f->slid, 3},
            };
            if (f->is_mounted)
                append_row(&text, step, wb_harness_file_holder(set->plan, k), columns,
                           WB_COUNT(columns));
        }
    }
    const enum wb_status status = wb_csv_table_write(folder, "forces.csv", &text);
    wb_text_release(&text);
    return status;
}

enum wb_status wb_harness_output_write(const struct wb_harness_result_set *set,
                                       const struct wb_harness_bands *bands, const char *folder)
{
    char path[WB_PATH];
    WB_TRY(write_shapes(set, folder));
    WB_TRY(write_forces(set, folder));
    WB_TRY(wb_harness_bands_output_write(bands, folder));
    WB_TRY(wb_file_join(path, folder, "harness.json"));
    struct wb_json *const root = wb_json_create();
    wb_harness_output_put(root, set, bands);
    char *const text = wb_json_format(root);
    wb_json_destroy(root);
    const enum wb_status status = wb_file_write(path, text, strlen(text));
    free(text);
    return status;
}

/* --- the terminal --- */

static const double least_residual = 1e-6; /* m; less is round-off */

/* Round-off is 0. */
static double chopped(double value)
{
    return value < 1e-8 ? 0.0 : value;
}

/* Obstacles have no limits. */
static void append_force(struct wb_text *text, const struct wb_harness_plan *plan, int holder,
                         const struct wb_harness_force *f)
{
    const struct wb_harness_item *const item = &plan->items[holder];
    wb_text_append(text, "      %-16s %8.3g N  %8.4g N mm   largest %.3g N, %.4g N mm",
                   wb_harness_file_holder(plan, holder), chopped(f->size),
                   chopped(f->moment_size / WB_NMM), chopped(f->largest),
                   chopped(f->largest_moment / WB_NMM));
    if (isfinite(f->slid))
        wb_text_append(text, "  slid %.3g mm", f->slid / WB_MM);
    if (f->exceeds_force)
        wb_text_append(text, "  LIMIT EXCEEDED (%.3g N)", item->largest_force);
    if (f->exceeds_moment)
        wb_text_append(text, "  LIMIT EXCEEDED (%.4g N mm)", item->largest_moment / WB_NMM);
    wb_text_append(text, "%s\n", wb_harness_found_is_twist_sensitive(f) ? "  depends on GJ" : "");
}

static void append_radii(struct wb_text *text, const struct wb_harness_plan *plan,
                         const struct wb_harness_step_result *step)
{
    for (int b = 0; b < plan->n_branches; b++) {
        if (step->branches[b].exceeds_radius)
            wb_text_append(text,
                           "      %-16s bend radius down to %.3g mm  LIMIT EXCEEDED (%.4g mm)\n",
                           plan->branches[b].name, step->branches[b].tightest_radius / WB_MM,
                           plan->branches[b].least_radius / WB_MM);
    }
}

void wb_harness_output_append_table(struct wb_text *text, const struct wb_harness_result_set *set)
{
    const struct wb_harness_plan *const plan = set->plan;
    for (int i = 0; i < set->n_steps; i++) {
        const struct wb_harness_step_result *const step = &set->results[i];
        int tightest = 0;
        for (int b = 1; b < plan->n_branches; b++) {
            if (step->branches[b].least_radius < step->branches[tightest].least_radius)
                tightest = b;
        }
        const struct wb_harness_branch_result *const b = &step->branches[tightest];
        wb_text_append(text, "%2d  %-20s", i + 1, plan->steps[i].name);
        if (isfinite(b->least_radius) && b->least_radius < 1e3)
            wb_text_append(text, "  least radius %.3g mm (%s at %.4g mm)", b->least_radius / WB_MM,
                           plan->branches[tightest].name, b->at / WB_MM);
        wb_text_append(text, "\n");
        for (int k = 0; k < wb_harness_file_n_holders(plan); k++) {
            if (step->forces[k].is_mounted)
                append_force(text, plan, k, &step->forces[k]);
        }
        append_radii(text, plan, step);
        for (int s = 0; s < step->n_snaps; s++)
            wb_text_append(text, "      snap at %.3g of the step: %s moves by %.3g mm\n",
                           step->snaps[s].fraction, branch_name(plan, step->snap_branch[s]),
                           step->snaps[s].distance / WB_MM);
    }
}

void wb_harness_output_append_finding(struct wb_text *text, const struct wb_harness_result_set *set)
{
    const struct wb_harness_plan *const plan = set->plan;
    struct wb_harness_found found;
    wb_harness_found_collect(&found, set);
    wb_text_append(text, "%s (simulation, %s): largest force %.3g N, on %s in step %d (%s)",
                   plan->name, set->settings.is_elastic ? "elastic" : "elastoplastic",
                   found.force.value, plan->items[found.force.of].name, found.force.step + 1,
                   plan->steps[found.force.step].name);
    if (found.is_taken_off && found.residual.value < least_residual)
        wb_text_append(text, "; taken off, it returns to its stress-free shape");
    else if (found.is_taken_off)
        wb_text_append(text,
                       "; taken off, its residual shape is up to %.4g mm from the stress-free "
                       "one (%s)",
                       found.residual.value / WB_MM, plan->branches[found.residual.of].name);
}
