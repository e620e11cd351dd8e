#include "analysis/validation/validate_json.h"

#include <math.h>

#include "analysis/keys/row.h"
#include "analysis/validation/validate_bounds.h"
#include "base/units.h"

#define RESULT(member) WB_AT(struct wb_validate_result, member)
#define LOOP(member) WB_AT(struct wb_validate_loop, member)
#define LOOPS WB_ARRAY(struct wb_validate_result, cycles.loops, cycles.n_loops)

static const struct wb_key bound_rows[] = {
    {"found", NUMBER | UNKNOWN, "value, in the unit of the key above"},
    {"bound", NUMBER | UNKNOWN, "bound of the value; null: not known"},
    {"exceeded", FLAG, "the value exceeds its bound"},
};
static WB_KEYS(bound, "bound", "A value of a validation and its bound.");

static const struct wb_key bounds_rows[] = {
    {"loading", OBJECT, "RMS error on loading over F_max", &bound_keys},
    {"unloading", OBJECT, "RMS error on unloading over F_max", &bound_keys},
    {"residual_deflection_mm", OBJECT, "error of the residual deflection", &bound_keys},
    {"shapes_mm", OBJECT, "RMS distance of the markers", &bound_keys},
};
static WB_KEYS(bounds, "bounds", "Bounds of a validation.");

static const struct wb_key unloading_rows[] = {
    {"samples", RESULT(cycles.n_samples), "number of specimens with unloading"},
    {"rms", RESULT(cycles.rms) | UNKNOWN, "RMS error of the mean over F_max"},
    {"max_error", RESULT(cycles.largest_error) | UNKNOWN, "largest error of the mean over F_max"},
    {"rms_of_samples", RESULT(cycles.sample_rms) | UNKNOWN,
     "RMS error of the single specimens over F_max"},
    {"rule_untested", RESULT(is_rule_untested),
     "the calibration had no unloading to test the hardening rule"},
};
static WB_KEYS(unloading, "unloading", "The prediction of the unloading.");

static const struct wb_key residual_rows[] = {
    {"measured", RESULT(cycles.residual_measured) | UNKNOWN, "measured residual deflection",
     .unit = "mm"},
    {"predicted", RESULT(cycles.residual_computed) | UNKNOWN, "predicted residual deflection",
     .unit = "mm"},
};
static WB_KEYS(residual, "residual_deflection",
               "Deflection where the force has returned to that at zero deflection.");

static const struct wb_key loop_rows[] = {
    {"cycle", LOOP(cycle), "cycle, from 1"},
    {"samples", LOOP(n_samples), "number of specimens"},
    {"measured", LOOP(measured) | UNKNOWN, "measured energy loss of the cycle", .unit = "mJ"},
    {"predicted", LOOP(computed) | UNKNOWN, "predicted energy loss of the cycle", .unit = "mJ"},
};
static WB_KEYS(loop, "loop_energy", "The energy loss of a later cycle.");

static const struct wb_key wb_validate_json_rows[] = {
    {"clamp_curvature_1_m", RESULT(cycles.clamp_curvature) | UNKNOWN | OPTIONAL,
     "computed curvature at the clamp"},
    {"beyond_known_curvature", RESULT(is_beyond) | OPTIONAL,
     "that curvature exceeds the one up to which the law was measured"},
    {"bounds", OBJECT | OPTIONAL, "errors and their bounds", &bounds_keys},
    {"unloading", WB_HERE(struct wb_validate_result) | UNKNOWN | OPTIONAL,
     "prediction of the unloading; null: no unloading was measured", &unloading_keys},
    {"residual_deflection_mm", WB_HERE(struct wb_validate_result) | OPTIONAL, "residual deflection",
     &residual_keys},
    {"loop_energy_mJ", LOOPS | OPTIONAL, "energy loss of the later cycles", &loop_keys},
};
WB_KEYS(wb_validate_json, "validation_cycles", "");

void wb_validate_json_put_cycles(struct wb_json *item, const struct wb_validate_result *r)
{
    WB_PUT(item, &wb_validate_json_keys, struct wb_validate_result, r);
    struct wb_json *const parts = wb_json_set_object(item, "bounds");
    for (int i = 0; i < WB_VALIDATE_PARTS; i++) {
        const struct wb_validate_bound *const of = &r->bounds[i];
        const double unit = wb_validate_part_unit(i);
        struct wb_json *const part = wb_json_set_object(parts, wb_validate_part_key(i));
        wb_json_set_number(part, "found", of->found / unit);
        wb_json_set_number(part, "bound", of->bound / unit);
        wb_json_set_boolean(part, "exceeded", of->is_exceeded);
    }
    if (r->cycles.n_samples == 0)
        wb_json_set_number(item, "unloading", (double)NAN);
    else
        WB_PUT(item, &wb_validate_json_keys, struct wb_validate_result, r);
}
