#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "base/config.h"
#include "base/units.h"
#include "fe/model/bundle_override_private.h"

#define WB_LOG_DOMAIN "bundle"

/* "file" keeps the file's value; the others are in the order of enum wb_bundle_packing. */
static const char *const packings[] = {"file", "hexagon", "triangle", "densest", NULL};
static const char *const outlines[] = {"file", "hull", "circle", NULL};

static const struct wb_setting bond_row[1] = {
    {.name = "bond_reach_mm", .unit = "mm", .scale = WB_MM, .largest = 1.0},
};

static const struct wb_setting_table bond_table = {bond_row, 1, 0, NULL};

static const struct wb_setting piece_rows[] = {
    {WB_ROW_QUANTITY(wb_bundle_override, length, "length_mm", "mm", WB_MM, 1e-3, 1e6, 0.0),
     WB_ROW_OPTION("length-mm", "L", "Free length from clamp to tip")},
    {WB_ROW_CHOICE(wb_bundle_override, packing, "packing", packings, 0),
     WB_ROW_OPTION("packing", "PACKING", "Packing of the wires")},
    {WB_ROW_INTEGER(wb_bundle_override, layers, "layers", 1, 20, 0),
     WB_ROW_OPTION("layers", "N", "Layers of the tape")},
    {WB_ROW_CHOICE(wb_bundle_override, outline, "outline", outlines, 0),
     WB_ROW_OPTION("outline", "OUTLINE",
                   "Outline of the tape: taut on the wires, or a circle around them")},
    {WB_ROW_LIST(wb_bundle_override, bond.reach, "bond_reach_mm", bond_table, bond.is_given),
     WB_ROW_OPTION("bond-reach-mm", "R", "Bond the tape to wires within this distance")},
    {WB_ROW_INTEGER(wb_bundle_override, run.cycles, "cycles", 1, 1000, 0),
     WB_ROW_OPTION("cycles", "N", "Load and unload N times")},
};

static const struct wb_setting load_rows[] = {
    {WB_ROW_BOOLEAN(wb_bundle_override, dead_force, "dead_force", false),
     WB_ROW_OPTION("dead-force", NULL, "Load the tip by a vertical force instead of a strand")},
    {WB_ROW_BOOLEAN(wb_bundle_override, no_weight, "no_weight", false),
     WB_ROW_OPTION("no-weight", NULL, "Ignore the weight")},
};

#define RUN_AT offsetof(struct wb_bundle_override, run)
#define INTERFACE_AT offsetof(struct wb_bundle_override, interface)
#define FILES "the file's"

const struct wb_setting_table wb_bundle_override_tables[WB_BUNDLE_OVERRIDE_TABLES] = {
    [WB_BUNDLE_OVERRIDE_MESH] = {&wb_bundle_model_run_settings[WB_BUNDLE_MODEL_MESH], 1, RUN_AT,
                                 FILES},
    [WB_BUNDLE_OVERRIDE_PIECE] = {piece_rows, WB_COUNT(piece_rows), 0, FILES},
    [WB_BUNDLE_OVERRIDE_TEST] = {&wb_bundle_model_run_settings[WB_BUNDLE_MODEL_DEFLECTION], 2,
                                 RUN_AT, FILES},
    [WB_BUNDLE_OVERRIDE_LOADS] = {load_rows, WB_COUNT(load_rows), 0, NULL},
    [WB_BUNDLE_OVERRIDE_RUN] = {&wb_bundle_model_run_settings[WB_BUNDLE_MODEL_DURATION], 3, RUN_AT,
                                FILES},
    [WB_BUNDLE_OVERRIDE_FRICTION] = {wb_bundle_model_friction_setting, 1, INTERFACE_AT, FILES},
    [WB_BUNDLE_OVERRIDE_COHESION] = {wb_bundle_model_cohesion_setting, 1, INTERFACE_AT, FILES},
};

bool wb_bundle_override_is_empty(const struct wb_bundle_override *override)
{
    for (int t = 0; t < WB_BUNDLE_OVERRIDE_TABLES; t++) {
        const struct wb_setting_table *const table = &wb_bundle_override_tables[t];
        for (size_t i = 0; i < table->n; i++) {
            if (wb_setting_is_given(&table->rows[i], (const char *) override + table->offset))
                return false;
        }
    }
    return true;
}

/* Checks the given values against the ranges of their rows. */
static enum wb_status check(const struct wb_bundle_override *override)
{
    for (int t = 0; t < WB_BUNDLE_OVERRIDE_TABLES; t++) {
        const struct wb_setting_table *const table = &wb_bundle_override_tables[t];
        const char *const settings = (const char *) override + table->offset;
        for (size_t i = 0; i < table->n; i++) {
            if (wb_setting_is_given(&table->rows[i], settings))
                WB_TRY(wb_setting_check_row(&table->rows[i], settings, NULL));
        }
    }
    return WB_OK;
}

static enum wb_status override_run(const struct wb_bundle_run *given,
                                   const struct wb_bundle_model *model, struct wb_bundle_run *run)
{
    if (given->mesh[0] && !wb_bundle_model_mesh(model, given->mesh))
        return wb_fail(WB_ERR_ARGUMENT, "%s: there is no mesh '%s'", model->path, given->mesh);
    for (size_t i = 0; i < WB_BUNDLE_MODEL_RUN_SETTINGS; i++) {
        const struct wb_setting *const row = &wb_bundle_model_run_settings[i];
        const size_t size = row->type == WB_SETTING_TEXT     ? row->size
                            : row->type == WB_SETTING_NUMBER ? sizeof(double)
                                                             : sizeof(int);
        if (wb_setting_is_given(row, given))
            memcpy((char *)run + row->offset, (const char *)given + row->offset, size);
    }
    return WB_OK;
}

/* Checks that the bundle can reach the deflection and that the epoxy leaves a free length. */
static enum wb_status check_length(const struct wb_bundle_model *model, double length,
                                   double deflection)
{
    if (!(deflection < length))
        return wb_fail(WB_ERR_ARGUMENT,
                       "%s: a deflection of %g mm cannot be reached by a bundle of %g mm: expected "
                       "a smaller deflection (--deflection-mm) or a greater length (--length-mm)",
                       model->path, deflection / WB_MM, length / WB_MM);
    if (model->potted_length < 0.5 * length)
        return WB_OK;
    return wb_fail(WB_ERR_ARGUMENT,
                   "%s: a length of %g mm is not more than twice potted_mm, %g mm: expected a "
                   "greater length (--length-mm)",
                   model->path, length / WB_MM, model->potted_length / WB_MM);
}

static enum wb_status override_friction(const struct wb_bundle_interface *given,
                                        struct wb_bundle_interface *interface)
{
    if (!given->has_friction)
        return WB_OK;
    if (given->friction.mu_kinetic > given->friction.mu_static)
        return wb_fail(WB_ERR_ARGUMENT,
                       "friction: the kinetic coefficient %g is more than the "
                       "static one, %g",
                       given->friction.mu_kinetic, given->friction.mu_static);
    interface->friction = given->friction;
    return WB_OK;
}

/* The law must soften beyond its strength. */
static enum wb_status check_softening(double strength, double stiffness, double fracture_energy)
{
    const double least = 0.5 * strength * strength / stiffness;
    if (fracture_energy > least)
        return WB_OK;
    return wb_fail(
        WB_ERR_ARGUMENT,
        "with a cohesive stiffness of %g N/mm3 the fracture energy, %g N/mm, is not more "
        "than the %g N/mm it takes to reach %g MPa",
        stiffness / WB_N_PER_MM3, fracture_energy / WB_N_PER_MM, least / WB_N_PER_MM,
        strength / WB_MPA);
}

static enum wb_status override_cohesion(double stiffness, struct wb_bundle_interface *interface)
{
    const struct wb_bundle_damage *damage = &interface->damage;

    if (stiffness == 0.0)
        return WB_OK;
    interface->shear_stiffness *= stiffness / interface->normal_stiffness;
    interface->normal_stiffness = stiffness;
    if (!interface->has_damage)
        return WB_OK;
    WB_TRY(check_softening(damage->strength, stiffness, damage->fracture_energy));
    return check_softening(damage->shear_strength, interface->shear_stiffness,
                           damage->fracture_energy);
}

enum wb_status wb_bundle_override_apply(const struct wb_bundle_override *override,
                                        struct wb_bundle_model *model)
{
    struct wb_bundle_interface interface = model->interface;
    struct wb_bundle_run run = model->run;
    const double length = override->length > 0.0 ? override->length : model->length;

    WB_TRY(check(override));
    WB_TRY(override_friction(&override->interface, &interface));
    WB_TRY(override_cohesion(override->interface.normal_stiffness, &interface));
    WB_TRY(override_run(&override->run, model, &run));
    if (override->length > 0.0 || override->run.deflection > 0.0)
        WB_TRY(check_length(model, length, run.deflection));
    model->interface = interface;
    model->run = run;
    model->length = length;
    if (override->length > 0.0)
        model->length_source = WB_BUNDLE_LENGTH_OWN;
    if (override->dead_force)
        model->loads.strand_length = 0.0;
    if (override->no_weight)
        model->loads.weight = false;
    return WB_OK;
}

/* --- packing and tape --- */

/* Applies values that the variant does not set. Messages name the options. */
static void join(const struct wb_bundle_override *override, struct wb_bundle_variant *variant)
{
    if (override->packing > 0 && !variant->has_packing) {
        variant->has_packing = true;
        variant->packing = override->packing - 1;
    }
    if (variant->layers == 0)
        variant->layers = override->layers;
    if (override->outline > 0 && !variant->has_outline) {
        variant->has_outline = true;
        variant->outline = override->outline - 1;
    }
    if (override->bond.is_given && !variant->has_reach) {
        variant->has_reach = true;
        variant->reach = override->bond.reach;
    }
    if (!variant->name[0])
        snprintf(variant->name, sizeof variant->name, "of the options");
}

enum wb_status wb_bundle_override_read(struct wb_bundle_model *model, const char *path,
                                       const struct wb_bundle_override *override,
                                       const struct wb_bundle_variant *variant)
{
    struct wb_bundle_variant all = {.wires = 0};

    if (variant)
        all = *variant;
    if (override) {
        WB_TRY(check(override));
        join(override, &all);
    }
    WB_TRY(wb_bundle_model_read_variant(model, path, &all));
    return override ? wb_bundle_override_apply(override, model) : WB_OK;
}
