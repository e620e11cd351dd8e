#include "analysis/compare/compare.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include <gsl/gsl_cdf.h>

#include "analysis/calibration/law/bending.h"
#include "analysis/keys/common.h"
#include "base/interpolate.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "compare"

const char *wb_compare_word(enum wb_verdict_of_groups verdict)
{
    static const char *const words[] = {"equivalent", "different", "cannot tell"};
    return words[verdict];
}

/* --- values of a properties file --- */

/* Degrees of freedom of the intervals. */
static int degrees_of(const struct wb_properties *p)
{
    return p->pooled_degrees > 0 ? p->pooled_degrees : wb_properties_units(p) - 1;
}

/* The group of specimens whose mean the estimate is, with its value times `factor`; false if the
 * file does not give the scatter of the specimens. */
static bool find_group(const struct wb_properties *p, const struct wb_estimate *estimate,
                       double factor, struct wb_welch_group *group)
{
    const int n = wb_properties_units(p), degrees = degrees_of(p);
    if (n < 2 || degrees < 1 || !(estimate->value > 0.0) || !(estimate->low > 0.0) ||
        !(estimate->high >= estimate->low) || !(factor > 0.0))
        return false;
    *group = (struct wb_welch_group){.mean = log(estimate->value * factor),
                                     .deviation = wb_properties_scatter(estimate, n, degrees),
                                     .n = n,
                                     .degrees = degrees};
    return true;
}

/* The moment at a curvature, from the two of the file around it: value relative to the law's and
 * interval relative to the value, both interpolated over the logarithm of the curvature. Constant
 * beyond the first or last. */
static enum wb_status find_moment(const struct wb_properties *p, double curvature,
                                  struct wb_estimate *moment)
{
    int k = 0;
    while (k < p->n_moments - 2 && p->curvature[k + 1] < curvature)
        k++;
    const int last = p->n_moments - 1, next = k < last ? k + 1 : k;
    const double at[3] = {p->curvature[k], p->curvature[next], curvature};
    double law[3];
    WB_TRY(wb_bending_moments(&p->law, p->outer_diameter, 3, at, law));
    const struct wb_estimate *const e[2] = {&p->moment[k], &p->moment[next]};
    const double part =
        next > k ? fmin(fmax(log(curvature / at[0]) / log(at[1] / at[0]), 0.0), 1.0) : 0.0;
    const double ratio = wb_interpolate(log(e[0]->value / law[0]), log(e[1]->value / law[1]), part);
    const double half =
        wb_interpolate(log(e[0]->high / e[0]->low), log(e[1]->high / e[1]->low), part);
    moment->value = exp(ratio) * law[2];
    moment->low = moment->value * exp(-0.5 * half);
    moment->high = moment->value * exp(0.5 * half);
    moment->deviation = wb_interpolate(e[0]->deviation, e[1]->deviation, part);
    return WB_OK;
}

/* Ratio of the law's residual curvature ratios from `curvature` and from the file's largest
 * curvature. */
static enum wb_status scale_to_curvature(const struct wb_properties *p, double curvature,
                                         double *ratio)
{
    struct wb_bending here, largest;
    *ratio = 1.0;
    if (curvature == p->largest_curvature)
        return WB_OK;
    WB_TRY(wb_bending_describe(&p->law, p->outer_diameter, curvature, &here));
    WB_TRY(wb_bending_describe(&p->law, p->outer_diameter, p->largest_curvature, &largest));
    *ratio = here.residual_curvature_ratio / largest.residual_curvature_ratio;
    return WB_OK;
}

/* --- the quantities --- */

static void begin(struct wb_compare_quantity *q, enum wb_quantity_id id, double curvature)
{
    *q = (struct wb_compare_quantity){.row = &wb_quantity_rows[id]};
    wb_quantity_label(id, curvature, q->name);
}

static enum wb_status take_rigidity(struct wb_compare_quantity *q,
                                    const struct wb_properties *const *p)
{
    begin(q, WB_QUANTITY_RIGIDITY, 0.0);
    for (int i = 0; i < WB_COMPARE_SIDES; i++) {
        if (!find_group(p[i], &p[i]->rigidity, 1.0, &q->groups[i]))
            q->reason = "a file has no interval of EI";
    }
    return WB_OK;
}

/* Stiffness on unloading from the curvature that both reach: the value of the file, times the ratio
 * of the values of its law from that curvature and from its largest. */
static enum wb_status take_unloading(struct wb_compare_quantity *q,
                                     const struct wb_properties *const *p, double largest)
{
    static const double change = 1.0;
    begin(q, WB_QUANTITY_UNLOADING_STIFFNESS, change);
    for (int i = 0; i < WB_COMPARE_SIDES; i++) {
        const struct wb_estimate *const e = wb_cycle_stiffness_at(&p[i]->unloading, change);
        double here, there;
        if (!e || largest < change || p[i]->unloading.resolved > change) {
            q->reason = "a file has no value of it";
            continue;
        }
        WB_TRY(wb_bending_stiffness(&p[i]->law, p[i]->outer_diameter, largest, 0, NULL, NULL, 1,
                                    &change, &here));
        WB_TRY(wb_bending_stiffness(&p[i]->law, p[i]->outer_diameter, p[i]->largest_curvature, 0,
                                    NULL, NULL, 1, &change, &there));
        if (!find_group(p[i], e, here / there, &q->groups[i]))
            q->reason = "a file has no interval of it";
    }
    return WB_OK;
}

static enum wb_status take_residual_curvature_ratio(struct wb_compare_quantity *q,
                                                    const struct wb_properties *const *p,
                                                    double curvature)
{
    begin(q, WB_QUANTITY_RESIDUAL_CURVATURE_RATIO, 0.0);
    snprintf(q->name, sizeof q->name, "%s from %.3g /m", q->row->name, curvature);
    for (int i = 0; i < WB_COMPARE_SIDES; i++) {
        double ratio = 1.0;
        if (isfinite(p[i]->residual_curvature_ratio.low))
            WB_TRY(scale_to_curvature(p[i], curvature, &ratio));
        if (!find_group(p[i], &p[i]->residual_curvature_ratio, ratio, &q->groups[i]))
            q->reason = "a file has no interval of the residual curvature ratio";
    }
    return WB_OK;
}

static enum wb_status take_moment(struct wb_compare_quantity *q,
                                  const struct wb_properties *const *p, double curvature)
{
    begin(q, WB_QUANTITY_MOMENT, curvature);
    for (int i = 0; i < WB_COMPARE_SIDES; i++) {
        struct wb_estimate moment;
        WB_TRY(find_moment(p[i], curvature, &moment));
        if (!find_group(p[i], &moment, 1.0, &q->groups[i]))
            q->reason = "a file has no interval of moments";
    }
    return WB_OK;
}

static void decide(struct wb_compare_quantity *q, double within)
{
    if (q->reason)
        return;
    q->welch = wb_welch_find(&q->groups[0], &q->groups[1], WB_COMPARE_ALPHA);
    q->verdict = wb_welch_decide(&q->welch, within);
    if (q->verdict == WB_GROUPS_UNDECIDED)
        q->more = wb_welch_more(&q->groups[0], &q->groups[1], WB_COMPARE_ALPHA, within);
}

/* Different if any quantity is; equivalent if all are. */
static void decide_all(struct wb_compare *compare)
{
    bool is_open = false;
    compare->verdict = WB_GROUPS_EQUIVALENT;
    for (int k = 0; k < WB_COMPARE_QUANTITIES; k++) {
        const struct wb_compare_quantity *const q = &compare->quantities[k];
        if (q->reason)
            continue;
        compare->n_compared++;
        if (q->verdict == WB_GROUPS_DIFFERENT)
            compare->verdict = WB_GROUPS_DIFFERENT;
        if (q->verdict != WB_GROUPS_UNDECIDED)
            continue;
        is_open |= q->more == 0;
        compare->more = q->more > compare->more ? q->more : compare->more;
        if (compare->verdict == WB_GROUPS_EQUIVALENT)
            compare->verdict = WB_GROUPS_UNDECIDED;
    }
    if (is_open)
        compare->more = 0;
}

static enum wb_status check(const struct wb_properties *p, const char *name)
{
    if (p->n_moments < 1 || !(p->largest_curvature > 0.0))
        return wb_fail(WB_ERR_DATA,
                       "%s: no moments with intervals: calibrate with --method cycle, or on "
                       "three-point bending",
                       name);
    if (wb_properties_units(p) < 2)
        return wb_fail(WB_ERR_DATA,
                       "%s: %d specimen or series; a comparison needs the scatter of at least two",
                       name, wb_properties_units(p));
    return WB_OK;
}

enum wb_status wb_compare_run(struct wb_compare *compare,
                              const struct wb_properties *const *properties,
                              const char *const *names, double within)
{
    struct wb_compare c = {.within = within, .curvature = (double)INFINITY};
    for (int i = 0; i < WB_COMPARE_SIDES; i++) {
        WB_TRY(check(properties[i], names[i]));
        c.curvature = fmin(c.curvature, properties[i]->largest_curvature);
    }
    struct wb_compare_quantity *q = c.quantities;
    for (int k = 0; k < WB_CYCLE_MOMENTS; k++)
        WB_TRY(take_moment(q++, properties, wb_cycle_moment_parts[k] * c.curvature));
    WB_TRY(take_unloading(q++, properties, c.curvature));
    WB_TRY(take_residual_curvature_ratio(q++, properties, c.curvature));
    WB_TRY(take_rigidity(q, properties));
    for (int k = 0; k < WB_COMPARE_QUANTITIES; k++)
        decide(&c.quantities[k], within);
    decide_all(&c);
    if (c.n_compared == 0)
        return wb_fail(WB_ERR_DATA, "%s and %s have no quantity with an interval in common",
                       names[0], names[1]);
    *compare = c;
    return WB_OK;
}

/* --- JSON --- */

static void put_group(struct wb_json *of, const char *key, const struct wb_compare_quantity *q,
                      int side)
{
    const struct wb_welch_group *const group = &q->groups[side];
    struct wb_json *const entry = wb_json_set_object(of, key);
    wb_json_set_number(entry, "mean", exp(group->mean) / q->row->scale);
    wb_json_set_number(entry, "deviation_of_logarithm", group->deviation);
    wb_json_set_integer(entry, "n", group->n);
    wb_json_set_integer(entry, "degrees_of_freedom", group->degrees);
}

static void put_quantity(struct wb_json *list, const struct wb_compare_quantity *q)
{
    struct wb_json *const entry = wb_json_append_object(list);
    wb_json_set_text(entry, "quantity", q->name);
    wb_json_set_text(entry, "unit", q->row->unit[0] ? q->row->unit : "1");
    if (q->reason) {
        wb_json_set_text(entry, "not_compared", q->reason);
        return;
    }
    put_group(entry, "A", q, 0);
    put_group(entry, "B", q, 1);
    wb_json_set_number(entry, "ratio", exp(q->welch.difference));
    wb_json_set_number(entry, "log_ratio", q->welch.difference);
    wb_json_set_number(entry, "log_ratio_low", q->welch.low);
    wb_json_set_number(entry, "log_ratio_high", q->welch.high);
    wb_json_set_number(entry, "degrees_of_freedom", q->welch.degrees);
    wb_json_set_text(entry, "verdict", wb_compare_word(q->verdict));
    if (q->verdict == WB_GROUPS_UNDECIDED)
        wb_json_set_integer(entry, "more_specimens_of_each", q->more);
}

struct wb_json *wb_compare_json(const struct wb_compare *compare,
                                const struct wb_properties *const *properties,
                                const char *const *names)
{
    static const char *const keys[] = {"A", "B"};
    struct wb_json *const root = wb_json_create();
    wb_keys_put_tool(root, "wirebench compare");
    for (int i = 0; i < WB_COMPARE_SIDES; i++) {
        const struct wb_properties *const p = properties[i];
        struct wb_json *const side = wb_json_set_object(root, keys[i]);
        wb_json_set_text(side, "file", names[i]);
        wb_json_set_text(side, "wire", p->wire);
        wb_json_set_text(side, "method", p->method);
        wb_json_set_number(side, "outer_diameter_mm", p->outer_diameter / WB_MM);
        wb_json_set_number(side, "largest_curvature_1_m", p->largest_curvature);
        wb_json_set_integer(side, "n", wb_properties_units(p));
        wb_json_set_boolean(side, "virtual_rig", p->is_virtual);
        wb_json_set_boolean(side, "simulation", p->is_simulation);
    }
    wb_json_set_number(root, "within_log_ratio", compare->within);
    wb_json_set_number(root, "alpha", WB_COMPARE_ALPHA);
    wb_json_set_integer(root, "quantities_compared", compare->n_compared);
    struct wb_json *const list = wb_json_set_array(root, "quantities");
    for (int k = 0; k < WB_COMPARE_QUANTITIES; k++)
        put_quantity(list, &compare->quantities[k]);
    wb_json_set_text(root, "verdict", wb_compare_word(compare->verdict));
    if (compare->verdict == WB_GROUPS_UNDECIDED)
        wb_json_set_integer(root, "more_specimens_of_each", compare->more);
    return root;
}
