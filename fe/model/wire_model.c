#include "fe/model/wire_model.h"

#include <math.h>

static bool is_zero(const double vector[3])
{
    return vector[0] == 0.0 && vector[1] == 0.0 && vector[2] == 0.0;
}

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

/* A force to be compared over the deflection is zero at zero deflection: with the weight only a
 * test that begins there has that. */
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

/* Of a full circle, m4. */
static double second_moment(double diameter)
{
    return M_PI / 64.0 * pow(diameter, 4.0);
}

static double outer_diameter(const struct wb_wire_model *model)
{
    return model->part[model->n_parts - 1].outer_diameter;
}

double wb_wire_model_flexural_rigidity(const struct wb_wire_model *model)
{
    double sum = 0.0;
    for (int i = 0; i < model->n_parts; i++) {
        const struct wb_wire_model_part *const part = &model->part[i];
        sum += part->material.youngs_modulus *
               (second_moment(part->outer_diameter) - second_moment(part->inner_diameter));
    }
    return sum;
}

double wb_wire_model_youngs_modulus(const struct wb_wire_model *model)
{
    return wb_wire_model_flexural_rigidity(model) / second_moment(outer_diameter(model));
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
