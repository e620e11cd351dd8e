/* Holds: the operator stopped the stage for some time, and the bent wire relaxed. No rows are made
 * from holds. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/align/align_private.h"
#include "base/units.h"

/* End of a hold, bench time; infinite if the hold did not end. */
static double end_of(const struct wb_align *align, const struct wb_bend_hold_recorded *hold)
{
    return hold->to_ns == INT64_MAX ? (double)INFINITY : wb_align_bench_time(align, hold->to_ns);
}

bool wb_align_is_held(const struct wb_align *align, double from, double to)
{
    for (int i = 0; i < align->n_holds; i++) {
        if (to >= wb_align_bench_time(align, align->holds[i].from_ns) &&
            from <= end_of(align, &align->holds[i]))
            return true;
    }
    return false;
}

void wb_align_describe_holds(struct wb_align *align)
{
    struct wb_json *const list =
        align->n_holds > 0 ? wb_json_set_array(align->checks, "holds") : NULL;
    for (int i = 0; i < align->n_holds; i++) {
        const struct wb_bend_hold_recorded *const hold = &align->holds[i];
        const double from = wb_align_bench_time(align, hold->from_ns);
        const double lasted = end_of(align, hold) - from;
        struct wb_json *const object = wb_json_append_object(list);
        wb_json_set_integer(object, "cycle", hold->cycle);
        wb_json_set_text(object, "phase", hold->phase);
        wb_align_set(object, "travel_mm", hold->travel / WB_MM);
        wb_align_set(object, "start_s", from);
        wb_align_set(object, "lasted_s", isfinite(lasted) ? lasted : (double)NAN);
        wb_align_set(object, "tension_before_mN", hold->before / WB_MN);
        wb_align_set(object, "tension_after_mN", hold->after / WB_MN);
        if (strcmp(hold->phase, "rest") == 0)
            continue;
        char duration[32] = "until the end";
        if (isfinite(lasted))
            snprintf(duration, sizeof duration, "for %.1f s", lasted);
        wb_align_warn(
            align,
            "held at %.2f mm of travel on the way %s of cycle %d %s, while the tension went from "
            "%.2f to %.2f mN: a bent wire relaxes, so the curve after the hold is that of a wire "
            "with another history; the rows of the hold are left out",
            hold->travel / WB_MM, hold->phase, hold->cycle, duration, hold->before / WB_MN,
            hold->after / WB_MN);
    }
}
