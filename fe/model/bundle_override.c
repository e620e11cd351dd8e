#include "fe/model/bundle_override.h"

#include <stddef.h>
#include <stdio.h>

#include "base/config.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "bundle"

static const struct wb_setting load_rows[] = {
    {.name = "dead_force",
     .type = WB_SETTING_BOOLEAN,
     .offset = offsetof(struct wb_bundle_override, dead_force),
     .option = "dead-force",
     .help = "Raise the tip by a vertical force in place of a strand"},
    {.name = "no_weight",
     .type = WB_SETTING_BOOLEAN,
     .offset = offsetof(struct wb_bundle_override, no_weight),
     .option = "no-weight",
     .help = "Leave the weight out"},
};

#define RUN_AT offsetof(struct wb_bundle_override, run)
#define INTERFACE_AT offsetof(struct wb_bundle_override, interface)
#define FILES "the file's"

const struct wb_setting_table wb_bundle_override_tables[WB_BUNDLE_OVERRIDE_TABLES] = {
    [WB_BUNDLE_OVERRIDE_MESH] = {&wb_bundle_model_run_settings[WB_BUNDLE_MODEL_MESH], 1, RUN_AT,
                                 FILES},
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

/* What is given must be in its row's range. */
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

static enum wb_status override_run(const struct wb_bundle_run *given, struct wb_bundle_model *model)
{
    struct wb_bundle_run *const run = &model->run;

    if (given->mesh[0] && !wb_bundle_model_mesh(model, given->mesh))
        return wb_fail(WB_ERR_ARGUMENT, "%s: there is no mesh '%s'", model->path, given->mesh);
    if (given->mesh[0])
        snprintf(run->mesh, sizeof run->mesh, "%s", given->mesh);
    if (given->duration > 0.0)
        run->duration = given->duration;
    if (given->mass_scaling > 0.0)
        run->mass_scaling = given->mass_scaling;
    if (given->selective > 0.0)
        run->selective = given->selective;
    return WB_OK;
}

static enum wb_status override_friction(const struct wb_bundle_interface *given,
                                        struct wb_bundle_interface *interface)
{
    if (!given->has_friction)
        return WB_OK;
    if (given->friction_kinetic > given->friction_static)
        return wb_fail(WB_ERR_ARGUMENT,
                       "friction: the kinetic coefficient %g is more than the "
                       "static one, %g",
                       given->friction_kinetic, given->friction_static);
    interface->friction_static = given->friction_static;
    interface->friction_kinetic = given->friction_kinetic;
    interface->friction_decay = given->friction_decay;
    return WB_OK;
}

/* The law has to soften after it reaches its strength. */
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
    const struct wb_bundle_run before = model->run;

    WB_TRY(check(override));
    WB_TRY(override_friction(&override->interface, &interface));
    WB_TRY(override_cohesion(override->interface.normal_stiffness, &interface));
    const enum wb_status status = override_run(&override->run, model);
    if (status != WB_OK) {
        model->run = before;
        return status;
    }
    model->interface = interface;
    if (override->dead_force)
        model->loads.strand_length = 0.0;
    if (override->no_weight)
        model->loads.weight = false;
    return WB_OK;
}
