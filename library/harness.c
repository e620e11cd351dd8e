/* Harnesses of the library: a session of analysis/harness, with its results as tables. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/harness/harness_session.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "library/call.h"

#define WB_LOG_DOMAIN "library"

_Static_assert((int)WB_HARNESS_TAKE_OFF == (int)WIREBENCH_TAKE_OFF, "kinds of steps");

enum {
    SHAPES,
    ITEMS,
    FORCES,
    BRANCHES,
    TABLES
};

struct wirebench_harness {
    struct wb_harness_plan *plan;
    struct wb_harness_session *session;
    struct wirebench_table tables[TABLES];
    bool is_made[TABLES]; /* the table is that of the current state */
};

/* --- tables --- */

static const struct wb_column_kind shape_kinds[] = {
    {"branch", "", WB_COLUMN_TEXT},
    {"s_m", "m", WB_COLUMN_REAL},
    {"x_m", "m", WB_COLUMN_REAL},
    {"y_m", "m", WB_COLUMN_REAL},
    {"z_m", "m", WB_COLUMN_REAL},
    {"direction_x", "1", WB_COLUMN_REAL},
    {"direction_y", "1", WB_COLUMN_REAL},
    {"direction_z", "1", WB_COLUMN_REAL},
    {"curvature_1_m", "1/m", WB_COLUMN_REAL},
    {"twist_1_m", "1/m", WB_COLUMN_REAL},
    {"moment_Nm", "N m", WB_COLUMN_REAL},
    {"torque_Nm", "N m", WB_COLUMN_REAL},
    {"tension_N", "N", WB_COLUMN_REAL},
};

static const struct wb_column_kind item_kinds[] = {
    {"item", "", WB_COLUMN_TEXT},         {"mounted", "1", WB_COLUMN_INTEGER},
    {"x_m", "m", WB_COLUMN_REAL},         {"y_m", "m", WB_COLUMN_REAL},
    {"z_m", "m", WB_COLUMN_REAL},         {"direction_x", "1", WB_COLUMN_REAL},
    {"direction_y", "1", WB_COLUMN_REAL}, {"direction_z", "1", WB_COLUMN_REAL},
    {"up_x", "1", WB_COLUMN_REAL},        {"up_y", "1", WB_COLUMN_REAL},
    {"up_z", "1", WB_COLUMN_REAL},
};

static const struct wb_column_kind force_kinds[] = {
    {"item", "", WB_COLUMN_TEXT},
    {"force_N", "N", WB_COLUMN_REAL},
    {"force_along_N", "N", WB_COLUMN_REAL},
    {"force_across_N", "N", WB_COLUMN_REAL},
    {"force_up_N", "N", WB_COLUMN_REAL},
    {"moment_Nm", "N m", WB_COLUMN_REAL},
    {"moment_along_Nm", "N m", WB_COLUMN_REAL},
    {"moment_across_Nm", "N m", WB_COLUMN_REAL},
    {"moment_up_Nm", "N m", WB_COLUMN_REAL},
    {"largest_force_N", "N", WB_COLUMN_REAL},
    {"largest_moment_Nm", "N m", WB_COLUMN_REAL},
    {"exceeds_force", "1", WB_COLUMN_INTEGER},
    {"exceeds_moment", "1", WB_COLUMN_INTEGER},
    {"slid_m", "m", WB_COLUMN_REAL},
};

static const struct wb_column_kind branch_kinds[] = {
    {"branch", "", WB_COLUMN_TEXT},
    {"least_radius_m", "m", WB_COLUMN_REAL},
    {"at_m", "m", WB_COLUMN_REAL},
    {"largest_bending_1_m", "1/m", WB_COLUMN_REAL},
    {"largest_bending_so_far_1_m", "1/m", WB_COLUMN_REAL},
    {"beyond_calibration", "1", WB_COLUMN_INTEGER},
    {"exceeds_radius", "1", WB_COLUMN_INTEGER},
    {"tightest_radius_m", "m", WB_COLUMN_REAL},
};

static void add_shapes(const struct wirebench_harness *h, struct wb_columns *table)
{
    const struct wb_harness_place *p = wb_harness_session_state(h->session)->result.places;
    for (int i = 0; i < wb_harness_session_n_places(h->session); i++, p++) {
        const union wb_cell cells[] = {
            {.text = h->plan->branches[p->branch].name},
            {.real = p->s},
            {.real = p->position[0]},
            {.real = p->position[1]},
            {.real = p->position[2]},
            {.real = p->direction[0]},
            {.real = p->direction[1]},
            {.real = p->direction[2]},
            {.real = p->curvature},
            {.real = p->twist},
            {.real = p->moment},
            {.real = p->torque},
            {.real = p->tension},
        };
        wb_columns_add_row(table, cells);
    }
}

static void add_items(const struct wirebench_harness *h, struct wb_columns *table)
{
    const struct wb_harness_assembly *const assembly =
        &wb_harness_session_state(h->session)->assembly;
    for (int i = 0; i < h->plan->n_items; i++) {
        const struct wb_rod_node node = wb_harness_session_item(h->session, i);
        double R[9];
        wb_rod_element_matrix(node.rotation, R);
        const union wb_cell cells[] = {
            {.text = h->plan->items[i].name},
            {.integer = assembly->is_mounted[i]},
            {.real = node.position[0]},
            {.real = node.position[1]},
            {.real = node.position[2]},
            {.real = R[0]},
            {.real = R[3]},
            {.real = R[6]},
            {.real = R[2]},
            {.real = R[5]},
            {.real = R[8]},
        };
        wb_columns_add_row(table, cells);
    }
}

static void add_forces(const struct wirebench_harness *h, struct wb_columns *table)
{
    for (int i = 0; i < h->plan->n_items; i++) {
        const struct wb_harness_force *const f =
            &wb_harness_session_state(h->session)->result.forces[i];
        const union wb_cell cells[] = {
            {.text = h->plan->items[i].name},
            {.real = f->size},
            {.real = f->force[0]},
            {.real = f->force[1]},
            {.real = f->force[2]},
            {.real = f->moment_size},
            {.real = f->moment[0]},
            {.real = f->moment[1]},
            {.real = f->moment[2]},
            {.real = f->largest},
            {.real = f->largest_moment},
            {.integer = f->exceeds_force},
            {.integer = f->exceeds_moment},
            {.real = f->slid},
        };
        if (f->is_mounted)
            wb_columns_add_row(table, cells);
    }
}

static void add_branches(const struct wirebench_harness *h, struct wb_columns *table)
{
    for (int i = 0; i < h->plan->n_branches; i++) {
        const struct wb_harness_branch_result *const b =
            &wb_harness_session_state(h->session)->result.branches[i];
        const union wb_cell cells[] = {
            {.text = h->plan->branches[i].name},
            {.real = b->least_radius},
            {.real = b->at},
            {.real = b->largest_bending},
            {.real = b->largest_bending_so_far},
            {.integer = b->is_beyond},
            {.integer = b->exceeds_radius},
            {.real = b->tightest_radius},
        };
        wb_columns_add_row(table, cells);
    }
}

#define COUNT(array) ((int)(sizeof(array) / sizeof((array)[0])))

static const struct {
    const char *name;
    const struct wb_column_kind *kinds;
    int n;
    void (*add)(const struct wirebench_harness *h, struct wb_columns *table);
} layouts[TABLES] = {
    [SHAPES] = {"shapes", shape_kinds, COUNT(shape_kinds), add_shapes},
    [ITEMS] = {"items", item_kinds, COUNT(item_kinds), add_items},
    [FORCES] = {"forces", force_kinds, COUNT(force_kinds), add_forces},
    [BRANCHES] = {"branches", branch_kinds, COUNT(branch_kinds), add_branches},
};

enum wirebench_status wirebench_harness_table(struct wirebench_harness *harness, const char *name,
                                              const struct wirebench_table **table)
{
    wb_call_begin();
    if (wb_call_need(harness, "harness") != WB_OK || wb_call_need(name, "name") != WB_OK ||
        wb_call_need(table, "table") != WB_OK)
        return wb_call_end(WB_ERR_ARGUMENT);
    int index = 0;
    while (index < TABLES && strcmp(layouts[index].name, name) != 0)
        index++;
    if (index == TABLES)
        return wb_call_end(wb_fail(WB_ERR_NOT_FOUND,
                                   "no table '%s' in a harness: expected shapes, items, forces or "
                                   "branches",
                                   name));
    if (!harness->is_made[index]) {
        struct wb_columns made; /* if memory runs out, the old table stays */
        wb_columns_init(&made, layouts[index].name, layouts[index].kinds, layouts[index].n);
        layouts[index].add(harness, &made);
        wb_columns_release(&harness->tables[index].columns);
        harness->tables[index].columns = made;
        harness->is_made[index] = true;
    }
    *table = &harness->tables[index];
    return wb_call_end(WB_OK);
}

/* --- creation --- */

static enum wb_status make(struct wirebench_harness *harness, const char *path_or_name,
                           const struct wirebench_harness_settings *given)
{
    const struct wb_harness_settings settings = {
        .is_elastic = given->is_elastic, .torsion = 1.0, .element_length = given->element_length};
    char path[WB_PATH];
    harness->plan = wb_memory_new(1, sizeof *harness->plan);
    WB_TRY(wb_file_find_fixture(path, "harnesses", path_or_name, NULL));
    WB_TRY(wb_harness_file_read(harness->plan, path));
    return wb_harness_session_create(&harness->session, harness->plan, &settings);
}

enum wirebench_status wirebench_harness_read(struct wirebench_harness **out,
                                             const char *path_or_name,
                                             const struct wirebench_harness_settings *settings)
{
    struct wirebench_harness_settings given = {0};
    wb_call_begin();
    if (wb_call_need(out, "out") != WB_OK || wb_call_need(path_or_name, "path_or_name") != WB_OK ||
        (settings &&
         wb_call_take(&given, sizeof given, settings, "wirebench_harness_settings") != WB_OK))
        return wb_call_end(WB_ERR_ARGUMENT);
    struct wirebench_harness *const harness = wb_memory_new(1, sizeof *harness);
    const enum wb_status status = make(harness, path_or_name, &given);
    if (status == WB_OK)
        *out = harness;
    else
        wirebench_harness_destroy(harness);
    return wb_call_end(status);
}

void wirebench_harness_destroy(struct wirebench_harness *harness)
{
    if (!harness)
        return;
    for (int i = 0; i < TABLES; i++)
        wb_columns_release(&harness->tables[i].columns);
    wb_harness_session_destroy(harness->session);
    free(harness->plan);
    free(harness);
}

/* --- steps --- */

enum wirebench_status wirebench_harness_planned_step(const struct wirebench_harness *harness,
                                                     int index, struct wirebench_harness_step *step)
{
    wb_call_begin();
    if (wb_call_need(harness, "harness") != WB_OK)
        return wb_call_end(WB_ERR_ARGUMENT);
    if (index < 0 || index >= harness->plan->n_steps)
        return wb_call_end(wb_fail(WB_ERR_NOT_FOUND, "step %d: expected 0 to %d", index,
                                   harness->plan->n_steps - 1));
    const struct wb_harness_step *const planned = &harness->plan->steps[index];
    const bool has_item = planned->kind != WB_HARNESS_HANG && planned->kind != WB_HARNESS_TAKE_OFF;
    struct wirebench_harness_step mine = {
        .kind = (enum wirebench_harness_step_kind)planned->kind,
        .item = has_item ? harness->plan->items[planned->item].name : NULL};
    memcpy(mine.position, planned->position, sizeof mine.position);
    memcpy(mine.direction, planned->direction, sizeof mine.direction);
    memcpy(mine.up, planned->up, sizeof mine.up);
    return wb_call_end(wb_call_give(step, &mine, sizeof mine, "wirebench_harness_step"));
}

/* A unit vector; *has is false if it was not given. A unit vector is taken as it is. */
static enum wb_status take_direction(const double given[3], const char *name, bool *has,
                                     double vector[3])
{
    const double length = wb_vec3_length(given);
    *has = length != 0.0;
    memcpy(vector, given, 3 * sizeof *vector);
    if (!*has)
        return WB_OK;
    if (!isfinite(length) || length < 1e-9)
        return wb_fail(WB_ERR_ARGUMENT, "%s: expected finite numbers, not near 0", name);
    if (fabs(length - 1.0) > 1e-15)
        (void)wb_vec3_normalise(vector);
    return WB_OK;
}

static enum wb_status make_step(const struct wb_harness_plan *plan,
                                const struct wirebench_harness_step *given,
                                struct wb_harness_step *step)
{
    static const char *const words[] = {"hang", "mount", "move", "release", "take_off"};
    const char *const item = given->item ? given->item : "";
    if ((int)given->kind < WIREBENCH_HANG || given->kind > WIREBENCH_TAKE_OFF)
        return wb_fail(WB_ERR_ARGUMENT, "kind: %d: expected 0 to %d", (int)given->kind,
                       WIREBENCH_TAKE_OFF);
    *step = (struct wb_harness_step){.kind = (enum wb_harness_step_kind)given->kind};
    snprintf(step->name, sizeof step->name, "%s", words[step->kind]);
    if (step->kind == WB_HARNESS_HANG || step->kind == WB_HARNESS_TAKE_OFF)
        return WB_OK;
    step->item = wb_harness_file_find_item(plan, item);
    if (step->item < 0)
        return wb_fail(WB_ERR_NOT_FOUND, "item: no connector, clip or root is named '%s'", item);
    snprintf(step->name, sizeof step->name, "%s %s", words[step->kind], item);
    if (step->kind == WB_HARNESS_RELEASE)
        return WB_OK;
    for (int k = 0; k < 3; k++) {
        step->position[k] = given->position[k];
        if (!(fabs(step->position[k]) <= 1e3))
            return wb_fail(WB_ERR_ARGUMENT, "position: %g: expected -1000 to 1000 m",
                           step->position[k]);
    }
    WB_TRY(take_direction(given->direction, "direction", &step->has_direction, step->direction));
    return take_direction(given->up, "up", &step->has_up, step->up);
}

static void forget_tables(struct wirebench_harness *harness)
{
    memset(harness->is_made, 0, sizeof harness->is_made);
}

enum wirebench_status wirebench_harness_take_step(struct wirebench_harness *harness,
                                                  const struct wirebench_harness_step *step)
{
    struct wirebench_harness_step given;
    struct wb_harness_step mine;
    struct wb_reason why = {""};
    const char *key;
    wb_call_begin();
    if (wb_call_need(harness, "harness") != WB_OK ||
        wb_call_take(&given, sizeof given, step, "wirebench_harness_step") != WB_OK)
        return wb_call_end(WB_ERR_ARGUMENT);
    enum wb_status status = make_step(harness->plan, &given, &mine);
    if (status != WB_OK)
        return wb_call_end(status);
    forget_tables(harness);
    status = wb_harness_session_step(harness->session, &mine, NULL, NULL, &key, &why);
    if (status != WB_OK)
        return wb_call_end(wb_fail(status, "%s: %s", mine.name, why.text));
    const struct wb_harness_step_result *const result =
        &wb_harness_session_state(harness->session)->result;
    if (result->end == WB_HARNESS_CONVERGED)
        return wb_call_end(WB_OK);
    return wb_call_end_incomplete("%s ends at %.3g of it: %s", mine.name, result->fraction,
                                  result->problem);
}

enum wirebench_status wirebench_harness_undo(struct wirebench_harness *harness, int n)
{
    struct wb_reason why = {""};
    wb_call_begin();
    if (wb_call_need(harness, "harness") != WB_OK)
        return wb_call_end(WB_ERR_ARGUMENT);
    forget_tables(harness);
    const enum wb_status status = wb_harness_session_undo(harness->session, n, &why);
    return wb_call_end(status == WB_OK ? WB_OK : wb_fail(status, "undo: %s", why.text));
}

enum wirebench_status wirebench_harness_snapshot(struct wirebench_harness *harness,
                                                 const char *name)
{
    struct wb_reason why = {""};
    wb_call_begin();
    if (wb_call_need(harness, "harness") != WB_OK || wb_call_need(name, "name") != WB_OK)
        return wb_call_end(WB_ERR_ARGUMENT);
    const enum wb_status status = wb_harness_session_snapshot(harness->session, name, &why);
    return wb_call_end(status == WB_OK ? WB_OK : wb_fail(status, "snapshot: %s", why.text));
}

enum wirebench_status wirebench_harness_restore(struct wirebench_harness *harness, const char *name)
{
    struct wb_reason why = {""};
    wb_call_begin();
    if (wb_call_need(harness, "harness") != WB_OK || wb_call_need(name, "name") != WB_OK)
        return wb_call_end(WB_ERR_ARGUMENT);
    forget_tables(harness);
    const enum wb_status status = wb_harness_session_restore(harness->session, name, &why);
    return wb_call_end(status == WB_OK ? WB_OK : wb_fail(status, "restore: %s", why.text));
}

enum wirebench_status wirebench_harness_describe(const struct wirebench_harness *harness,
                                                 struct wirebench_harness_info *info)
{
    wb_call_begin();
    if (wb_call_need(harness, "harness") != WB_OK)
        return wb_call_end(WB_ERR_ARGUMENT);
    const struct wb_harness_session_state *const state = wb_harness_session_state(harness->session);
    const struct wirebench_harness_info mine = {
        .name = harness->plan->name,
        .title = harness->plan->title,
        .n_branches = harness->plan->n_branches,
        .n_items = harness->plan->n_items,
        .n_steps = harness->plan->n_steps,
        .state = state->number,
        .step = state->name,
        .is_converged = state->result.end == WB_HARNESS_CONVERGED,
        .fraction = state->result.fraction,
        .n_snaps = state->result.n_snaps,
        .elastic = state->result.elastic,
        .plastic = state->result.plastic,
    };
    return wb_call_end(wb_call_give(info, &mine, sizeof mine, "wirebench_harness_info"));
}
