#include "analysis/validation/validate_json.h"

#include <math.h>

#include "analysis/validation/validate_bounds.h"
#include "base/units.h"

void wb_validate_json_put_cycles(struct wb_json *item, const struct wb_validate_result *r)
{
    const struct wb_validate_cycles *const cycles = &r->cycles;
    wb_json_set_number(item, "clamp_curvature_1_m", cycles->clamp_curvature);
    wb_json_set_boolean(item, "beyond_known_curvature", r->is_beyond);
    struct wb_json *const bounds = wb_json_set_object(item, "bounds");
    for (int i = 0; i < WB_VALIDATE_PARTS; i++) {
        const struct wb_validate_bound *const bound = &r->bounds[i];
        const double unit = wb_validate_part_unit(i);
        struct wb_json *const part = wb_json_set_object(bounds, wb_validate_part_key(i));
        wb_json_set_number(part, "found", bound->found / unit);
        wb_json_set_number(part, "bound", bound->bound / unit);
        wb_json_set_boolean(part, "exceeded", bound->is_exceeded);
    }
    if (cycles->n_samples == 0) {
        wb_json_set_number(item, "unloading", (double)NAN);
        return;
    }
    struct wb_json *const unloading = wb_json_set_object(item, "unloading");
    wb_json_set_integer(unloading, "samples", cycles->n_samples);
    wb_json_set_number(unloading, "rms", cycles->rms);
    wb_json_set_number(unloading, "max_error", cycles->largest_error);
    wb_json_set_number(unloading, "rms_of_samples", cycles->sample_rms);
    wb_json_set_boolean(unloading, "rule_untested", r->is_rule_untested);
    struct wb_json *const left = wb_json_set_object(item, "residual_deflection_mm");
    wb_json_set_number(left, "measured", cycles->residual_measured / WB_MM);
    wb_json_set_number(left, "predicted", cycles->residual_computed / WB_MM);
    struct wb_json *const loops = wb_json_set_array(item, "loop_energy_mJ");
    for (int i = 0; i < cycles->n_loops; i++) {
        struct wb_json *const loop = wb_json_append_object(loops);
        wb_json_set_integer(loop, "cycle", cycles->loops[i].cycle);
        wb_json_set_integer(loop, "samples", cycles->loops[i].n_samples);
        wb_json_set_number(loop, "measured", cycles->loops[i].measured / WB_MJ);
        wb_json_set_number(loop, "predicted", cycles->loops[i].computed / WB_MJ);
    }
}
