#include "cli/validate_three_point.h"

#include <math.h>
#include <stdio.h>

#include "base/units.h"

static void print_bench(const struct wb_validate_three_point *r)
{
    printf("  bench          roller radius %g mm, nose radius %g mm, friction %g, compliance %g "
           "mm/N%s\n",
           r->info.machine.roller_radius / WB_MM, r->bench.nose_radius / WB_MM, r->bench.friction,
           r->bench.compliance / WB_MM, r->is_compliance_known ? "" : " (not known: assumed)");
    for (int i = 0; i < WB_THREE_POINT_VARIANTS; i++) {
        if (isfinite(r->bench_rms[i]))
            printf("    with %-11s %g%s: RMS of the loading %.3g\n", r->ends[i].name,
                   r->ends[i].value / (i < 2 ? 1.0 : WB_MM), i < 2 ? "" : " mm", r->bench_rms[i]);
    }
}

static void print_unloading(const struct wb_validate_three_point *r)
{
    if (r->n_unloading == 0) {
        printf("  unloading      not scored: no unloading was measured, or the beam did not "
               "converge\n");
        return;
    }
    printf(
        "  unloading      RMS %.3g, largest error %.3g, RMS over the points of all tests %.3g%s\n",
        r->unloading.rms, r->unloading.largest_error, r->unloading_rms_of_tests,
        r->is_rule_untested ? "; the hardening rule of these properties is not tested" : "");
    const double measured = r->residual_measured, predicted = r->residual_computed;
    if (isfinite(measured))
        printf("  residual deflection %.3f mm measured, %.3f mm predicted (%+.3f mm)\n",
               measured / WB_MM, predicted / WB_MM, (predicted - measured) / WB_MM);
}

static void print_scatter(const struct wb_validate_three_point *r)
{
    const struct wb_expected *const e = &r->expected;
    if (r->n_used > 1)
        printf("  scatter        between tests %.3g\n", r->scatter_rms);
    if (isfinite(e->rms_95))
        printf("  expected       from the scatter of %s (%.1f %% in stiffness): RMS of the loading "
               "about %.2g, at most %.2g (95 %%)\n"
               "                 RMS found %.2g\n",
               r->is_by_series ? "series" : "specimens", 100.0 * e->deviation, e->rms, e->rms_95,
               r->loading.rms);
}

static void print_test(const struct wb_validate_three_point_test *test)
{
    const struct wb_test_info *const info = &test->data.info;
    printf("  sample %d%s%s: ", info->sample, info->piece.series[0] ? ", series " : "",
           info->piece.series);
    if (!test->is_used) {
        printf("left out: %s\n", test->why.text);
        return;
    }
    printf("first contact %.3f mm (%.3f in the readings), ", test->first_contact / WB_MM,
           test->data.first_contact / WB_MM);
    if (test->is_bow_searched || test->bow != 0.0)
        printf("natural bow %.3f mm%s, ", test->bow / WB_MM,
               test->is_bow_searched ? " (fitted)" : "");
    printf("RMS %.3g\n", test->rms);
}

void wb_validate_three_point_print(const struct wb_validate_three_point *r)
{
    printf("wire %s, three-point bending, span %g mm, %d of %d test%s%s\n", r->info.wire,
           r->info.length / WB_MM, r->n_used, r->n_tests, r->n_tests == 1 ? "" : "s",
           r->info.is_simulation ? ", simulation" : "");
    printf("  loading        RMS %.3g, largest error %.3g (over F_max = %.4g N of the mean "
           "curve), %.3g to %.3g mm beyond the first contact\n",
           r->loading.rms, r->loading.largest_error, r->max_force, r->loading.deflection[0] / WB_MM,
           r->loading.deflection[r->loading.n - 1] / WB_MM);
    printf("                 RMS %.3g with the first contacts seen in the readings\n",
           r->rms_as_read);
    if (isfinite(r->elastic_rms))
        printf("    if elastic   RMS %.3g\n", r->elastic_rms);
    print_unloading(r);
    print_bench(r);
    print_scatter(r);
    for (int i = 0; i < r->n_tests; i++) {
        print_test(&r->tests[i]);
    }
    if (r->is_beyond)
        printf("  beyond         curvature at midspan %.3g /m: above the range of these "
               "properties\n",
               r->largest_curvature);
}
