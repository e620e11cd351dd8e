#include "fe/model/bundle_override.h"

#include <math.h>
#include <stdio.h>

#include "base/units.h"

#define WB_LOG_DOMAIN "bundle"

static const double most_friction = 10.0;

bool wb_bundle_override_is_empty(const struct wb_bundle_override *o)
{
    return !o->mesh && !o->dead_force && !o->no_weight && o->duration == 0.0 &&
           o->mass_scaling == 0.0 && o->selective == 0.0 && !o->has_friction &&
           o->cohesive_stiffness == 0.0;
}

static enum wb_status override_run(const struct wb_bundle_override *o,
                                   struct wb_bundle_model *model)
{
    struct wb_bundle_run *run = &model->run;

    if (o->mesh && !wb_bundle_model_mesh(model, o->mesh))
        return wb_fail(WB_ERR_NOT_FOUND, "%s: there is no mesh '%s'", model->path, o->mesh);
    if (o->mesh)
        snprintf(run->mesh, sizeof run->mesh, "%s", o->mesh);
    if (!(o->duration >= 0.0 && isfinite(o->duration)))
        return wb_fail(WB_ERR_ARGUMENT, "a duration of %g s: expected above 0", o->duration);
    if (o->duration > 0.0)
        run->duration = o->duration;
    const double factor[2] = {o->mass_scaling, o->selective};
    double *const place[2] = {&run->mass_scaling, &run->selective};
    for (int i = 0; i < 2; i++) {
        if (factor[i] == 0.0)
            continue;
        if (!(factor[i] >= 1.0 && isfinite(factor[i])))
            return wb_fail(WB_ERR_ARGUMENT, "a mass scaling of %g: expected at least 1", factor[i]);
        *place[i] = factor[i];
    }
    return WB_OK;
}

static enum wb_status override_friction(const struct wb_bundle_override *o,
                                        struct wb_bundle_interface *interface)
{
    if (!o->has_friction)
        return WB_OK;
    if (!(o->friction_static >= 0.0 && o->friction_static <= most_friction) ||
        !(o->friction_kinetic >= 0.0 && o->friction_kinetic <= o->friction_static))
        return wb_fail(WB_ERR_ARGUMENT,
                       "friction %g (static), %g (kinetic): expected 0 to %g, the kinetic one not "
                       "above the static one",
                       o->friction_static, o->friction_kinetic, most_friction);
    if (!(o->friction_decay >= 0.0 && isfinite(o->friction_decay)))
        return wb_fail(WB_ERR_ARGUMENT, "a decay of friction of %g s/m: expected 0 or more",
                       o->friction_decay);
    interface->friction_static = o->friction_static;
    interface->friction_kinetic = o->friction_kinetic;
    interface->friction_decay = o->friction_decay;
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

static enum wb_status override_cohesion(const struct wb_bundle_override *o,
                                        struct wb_bundle_interface *interface)
{
    const double stiffness = o->cohesive_stiffness;
    const struct wb_bundle_damage *damage = &interface->damage;

    if (stiffness == 0.0)
        return WB_OK;
    if (!(stiffness > 0.0 && isfinite(stiffness)))
        return wb_fail(WB_ERR_ARGUMENT, "a cohesive stiffness of %g N/mm3: expected above 0",
                       stiffness / WB_N_PER_MM3);
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

    WB_TRY(override_friction(override, &interface));
    WB_TRY(override_cohesion(override, &interface));
    const enum wb_status status = override_run(override, model);
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
