#include "live/live_plan.h"

#include <math.h>

#include "daq/acquire/interlock.h"
#include "fe/rod/section.h"
#include "fe/trial/loading_steps.h"

/* Adds rows as points of the curve, except rows with a slack strand. */
static void take_rows(struct wb_live_plan *plan, const struct wb_loading_steps *loading)
{
    for (int i = 0; i < loading->n_rows && plan->n_predicted < WB_LIVE_PLAN_POINTS; i++) {
        const struct wb_cantilever_point *const point = &loading->rows[i].point;
        if (point->slack || !isfinite(point->tension))
            continue;
        plan->deflection[plan->n_predicted] = point->deflection;
        plan->tension[plan->n_predicted++] = point->tension;
    }
}

static enum wb_status run(struct wb_live_plan *plan, struct wb_cantilever *cantilever)
{
    struct wb_loading_steps loading = {0};
    const struct wb_loading_steps_plan steps = {
        .control = WB_CONTROL_DEFLECTION,
        .maximum = plan->travel,
        .steps = WB_LIVE_PLAN_STEPS,
        .cycles = 1,
    };
    enum wb_status status = wb_loading_steps_init(&loading, &steps);
    if (status == WB_OK)
        status = wb_loading_steps_run(&loading, &steps, cantilever);
    if (status == WB_OK)
        take_rows(plan, &loading);
    wb_loading_steps_release(&loading);
    return status;
}

static enum wb_status predict(struct wb_live_plan *plan, const struct wb_rig *rig,
                              const struct wb_wire *wire)
{
    struct wb_section section = {0};
    struct wb_cantilever *cantilever = NULL;
    struct wb_cantilever_model model;
    WB_TRY(wb_section_init_law(&section, wire->outer_diameter, &wire->law, 0));
    wb_cantilever_default_model(&model);
    model.section = &section;
    model.length = plan->length;
    model.strand_length = rig->strand.length;
    model.counterweight = rig->strand.counterweight;
    model.mass_per_length = wb_wire_mass_per_length(wire);
    model.gravity_y = -rig->gravity;
    enum wb_status status = wb_cantilever_create(&cantilever, &model, NULL);
    if (status == WB_OK)
        status = run(plan, cantilever);
    wb_cantilever_destroy(cantilever);
    wb_section_release(&section);
    return status;
}

enum wb_status wb_live_plan_make(struct wb_live_plan *plan, const struct wb_rig *rig,
                                 const struct wb_specimen *specimen, const struct wb_wire *wire,
                                 double travel)
{
    struct wb_interlock_settings limits;
    wb_interlock_default_settings(&limits, rig);
    *plan = (struct wb_live_plan){
        .is_virtual = rig->is_virtual,
        .length = specimen->length,
        .travel = travel,
        .force_limit = limits.force,
        .travel_limit = limits.travel,
        .gravity = rig->gravity,
    };
    return wire->has_properties ? predict(plan, rig, wire) : WB_OK;
}
