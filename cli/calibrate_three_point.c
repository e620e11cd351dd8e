#include "cli/calibrate_three_point.h"

#include <math.h>
#include <stdio.h>

#include "analysis/calibration/properties/properties.h"
#include "analysis/calibration/properties/quantity.h"
#include "base/interrupt.h"
#include "base/json.h"
#include "base/progress.h"
#include "base/units.h"
#include "cli/finding.h"
#include "cli/print.h"

#define WB_LOG_DOMAIN "calibrate"

bool wb_calibrate_report(void *context, int done, int all)
{
    (void)all;
    wb_progress_update(context, done, NULL);
    return !wb_interrupted();
}

static void print_member(const struct wb_three_point_member *m)
{
    const struct wb_test_info *const info = &m->data.info;
    printf("sample %d%s%s: ", info->sample, info->piece.series[0] ? ", series " : "",
           info->piece.series);
    if (!m->is_fitted) {
        printf("not fitted: %s\n", m->why.text);
        return;
    }
    printf("EI %.4g N mm2 +- %.2g %%, first contact %.3f +- %.2g mm, used up to %.3g mm (%s), "
           "misfit %.2g%s\n",
           m->rigidity / WB_NMM2, 200.0 * m->rigidity_error, m->fit.first_contact / WB_MM,
           2.0 * m->fit.first_contact_error / WB_MM, m->data.usable / WB_MM,
           wb_three_point_limit_name(m->data.limit), m->fit.misfit,
           m->data.has_unloading ? ", with unloading" : "");
    if (m->fit.bow_error > 0.0)
        printf("    natural bow %+.3f +- %.2g mm, %s; correlation with the first contact %+.2f\n",
               m->fit.bow / WB_MM, 2.0 * m->fit.bow_error / WB_MM,
               fabs(m->fit.bow_off) > 2.0 ? "far off its prior: it compensates a misfit of the law"
               : m->fit.is_bow_identifiable ? "determined by the curve"
                                            : "not determined by the curve: given by its prior",
               m->fit.bow_contact_correlation);
    else if (m->fit.bow != 0.0)
        printf("    natural bow %+.3f mm, given\n", m->fit.bow / WB_MM);
}

static void print_text(const struct wb_three_point_calibration *c,
                       const struct wb_properties *properties)
{
    const struct wb_test_info *const info = &c->members[0].data.info;
    printf("wire %s, three-point bending, span %g mm, %d of %d tests fitted%s\n", info->wire,
           info->length / WB_MM, c->n_fitted, c->n_members,
           info->is_simulation ? ", simulation" : "");
    printf("roller radius %g mm, nose radius %g mm, friction %g, compliance %g mm/N%s\n",
           info->machine.roller_radius / WB_MM, c->bench.nose_radius / WB_MM, c->bench.friction,
           c->bench.compliance / WB_MM, c->is_compliance_known ? "" : " (not known: assumed)");
    wb_print_quantities(properties, "friction and nose");
    if (!c->is_rigidity_identifiable)
        printf("EI at zero curvature cannot be determined from loading alone\n");
    for (int i = 0; i < WB_THREE_POINT_VARIANTS; i++) {
        const struct wb_three_point_variant *const v = &c->variants[i];
        if (v->value == (i < 2 ? c->bench.friction : c->bench.nose_radius))
            continue; /* known */
        printf("%s %g%s: ", v->name, i < 2 ? v->value : v->value / WB_MM, i < 2 ? "" : " mm");
        if (v->is_possible)
            printf("EI x %.4f, M at the largest curvature x %.4f, misfit %.2g (%.2g)\n",
                   v->rigidity, v->moment[WB_THREE_POINT_MOMENTS - 1], v->misfit, c->misfit);
        else
            printf("not possible: the model does not reach the measured travel\n");
    }
    if (c->n_series > 1)
        printf("%d series; the standard deviation of their means, %.2g %%, gives the interval\n",
               c->n_series, 100.0 * c->series_deviation);
    for (int i = 0; i < c->n_members; i++)
        print_member(&c->members[i]);
}

static void print_json(const struct wb_three_point_calibration *c,
                       const struct wb_properties *properties)
{
    const struct wb_test_info *const info = &c->members[0].data.info;
    struct wb_json *const root = wb_json_create();
    wb_json_set_text(root, "wire", info->wire);
    wb_json_set_text(root, "kind", wb_machine_kind_name(info->kind));
    wb_json_set_number(root, "span_mm", info->length / WB_MM);
    wb_json_set_number(root, "nose_radius_mm", c->bench.nose_radius / WB_MM);
    wb_json_set_number(root, "friction", c->bench.friction);
    wb_json_set_number(root, "compliance_mm_N", c->bench.compliance / WB_MM);
    wb_json_set_boolean(root, "compliance_known", c->is_compliance_known);
    wb_json_set_integer(root, "series", c->n_series);
    wb_json_set_number(root, "series_deviation", c->series_deviation);
    wb_json_set_number(root, "misfit", c->misfit);
    wb_json_set_boolean(root, "rigidity_identifiable", c->is_rigidity_identifiable);
    wb_quantity_put(root, properties);
    struct wb_json *const bands = wb_json_set_array(root, "bands");
    for (int i = 0; i < WB_THREE_POINT_VARIANTS; i++) {
        const struct wb_three_point_variant *const v = &c->variants[i];
        struct wb_json *const item = wb_json_append_object(bands);
        wb_json_set_text(item, "of", v->name);
        wb_json_set_number(item, i < 2 ? "value" : "value_mm", i < 2 ? v->value : v->value / WB_MM);
        wb_json_set_boolean(item, "possible", v->is_possible);
        wb_json_set_number(item, "misfit", v->is_possible ? v->misfit : (double)NAN);
        wb_json_set_number(item, "rigidity_ratio", v->is_possible ? v->rigidity : (double)NAN);
    }
    struct wb_json *const tests = wb_json_set_array(root, "tests");
    for (int i = 0; i < c->n_members; i++) {
        const struct wb_three_point_member *const m = &c->members[i];
        struct wb_json *const item = wb_json_append_object(tests);
        wb_json_set_integer(item, "sample", m->data.info.sample);
        wb_json_set_text(item, "series", m->data.info.piece.series);
        wb_json_set_boolean(item, "fitted", m->is_fitted);
        if (!m->is_fitted) {
            wb_json_set_text(item, "why", m->why.text);
            continue;
        }
        wb_json_set_number(item, "flexural_rigidity_N_mm2", m->rigidity / WB_NMM2);
        wb_json_set_number(item, "rigidity_error", m->rigidity_error);
        wb_json_set_number(item, "first_contact_mm", m->fit.first_contact / WB_MM);
        wb_json_set_number(item, "first_contact_error_mm", m->fit.first_contact_error / WB_MM);
        wb_json_set_number(item, "natural_bow_mm", m->fit.bow / WB_MM);
        wb_json_set_number(item, "natural_bow_error_mm", m->fit.bow_error / WB_MM);
        wb_json_set_boolean(item, "natural_bow_determined", m->fit.is_bow_identifiable);
        wb_json_set_number(item, "natural_bow_off_prior", m->fit.bow_off);
        wb_json_set_number(item, "bow_contact_correlation", m->fit.bow_contact_correlation);
        wb_json_set_number(item, "usable_mm", m->data.usable / WB_MM);
        wb_json_set_text(item, "usable_by", wb_three_point_limit_name(m->data.limit));
        wb_json_set_boolean(item, "with_unloading", m->data.has_unloading);
        wb_json_set_boolean(item, "converged", m->fit.is_converged);
        wb_json_set_number(item, "misfit", m->fit.misfit);
    }
    wb_json_set_number(root, "cpu_s", c->cpu_s);
    wb_command_print_json(root);
}

static int count_not_converged(const struct wb_three_point_calibration *c)
{
    int n = 0;
    for (int i = 0; i < c->n_members; i++)
        n += c->members[i].is_fitted && !c->members[i].fit.is_converged;
    return n;
}

/* Bands of the machine file that the calibration had to vary: friction, nose radius. */
static bool has_open_bands(const struct wb_three_point_calibration *c)
{
    for (int i = 0; i < WB_THREE_POINT_VARIANTS; i++) {
        if (c->variants[i].value != (i < 2 ? c->bench.friction : c->bench.nose_radius))
            return true;
    }
    return false;
}

static void append_trust(struct wb_text *text, const struct wb_three_point_calibration *c)
{
    const int n_lost = count_not_converged(c);
    bool has_unloading = true;
    for (int i = 0; i < c->n_members; i++)
        has_unloading =
            has_unloading && (!c->members[i].is_fitted || c->members[i].data.has_unloading);
    if (n_lost > 0)
        wb_text_append(text, "no: the fit of %d test%s did not converge", n_lost,
                       n_lost == 1 ? "" : "s");
    else if (c->n_fitted < c->n_members)
        wb_text_append(text, "in part: %d of %d tests could not be fitted",
                       c->n_members - c->n_fitted, c->n_members);
    else if (!has_unloading)
        wb_text_append(text, "for loading only: unloading was not recorded in every test");
    else
        wb_text_append(text, "%s", c->n_fitted > 1 ? "yes" : "for this specimen");
    wb_text_append(text, "; misfit %.2g %% of the largest force", c->misfit / WB_PERCENT);
    if (!c->is_compliance_known)
        wb_text_append(text, "; the machine's compliance is not known and taken as zero");
    if (has_open_bands(c))
        wb_text_append(text, "; friction or nose radius is known only as a range");
    if (c->n_fitted == 1)
        wb_text_append(text, "; one specimen cannot show how specimens differ");
}

static void print_finding(const struct wb_three_point_calibration *c,
                          const struct wb_properties *properties, const char *output)
{
    struct wb_finding finding = {.figure = NULL};
    const struct wb_test_info *const info = &c->members[0].data.info;
    wb_text_append(&finding.found,
                   "%s (%s, three-point bending, %d of %d tests fitted): ", info->wire,
                   wb_finding_source(info), c->n_fitted, c->n_members);
    wb_finding_append_quantity(&finding.found, properties, WB_QUANTITY_MOMENT,
                               WB_THREE_POINT_MOMENTS - 1);
    if (c->is_rigidity_identifiable) {
        wb_text_append(&finding.found, "; ");
        wb_finding_append_quantity(&finding.found, properties, WB_QUANTITY_RIGIDITY, 0);
    }
    append_trust(&finding.trust, c);
    if (count_not_converged(c) > 0)
        wb_text_append(&finding.next,
                       "run the same command again with a larger --curve-iterations");
    else
        wb_finding_append_validate(&finding.next, output, info->wire, "span");
    wb_finding_print(&finding);
}

static int deliver(const struct wb_three_point_calibration *c,
                   const struct wb_command_common *common)
{
    bool complete = c->n_fitted == c->n_members;
    if (common->output) {
        const enum wb_status status = wb_properties_write_three_point(
            common->output, c, common->inputs, common->n, common->force);
        if (status != WB_OK)
            return wb_command_exit(status);
    }
    struct wb_properties properties;
    wb_properties_from_three_point(c, &properties);
    if (common->json) {
        print_json(c, &properties);
    } else {
        print_text(c, &properties);
        print_finding(c, &properties, common->output);
    }
    if (!complete)
        wb_warn("%d of %d tests could not be fitted", c->n_members - c->n_fitted, c->n_members);
    for (int i = 0; i < c->n_members; i++) {
        const struct wb_three_point_member *const m = &c->members[i];
        if (!m->is_fitted || m->fit.is_converged)
            continue;
        wb_warn("sample %d: the fit did not converge (--curve-iterations)", m->data.info.sample);
        complete = false;
    }
    return complete ? WB_EXIT_OK : WB_EXIT_INCOMPLETE;
}

int wb_calibrate_three_point(struct wb_three_point_calibrate_settings *settings,
                             const struct wb_datasets *datasets,
                             const struct wb_command_common *common)
{
    struct wb_three_point_calibration calibration = {0};
    struct wb_progress progress;
    settings->progress = wb_calibrate_report;
    settings->progress_context = &progress;
    wb_progress_start(&progress, "calibrate", "fits",
                      (double)datasets->n * (1 + WB_THREE_POINT_VARIANTS));
    const enum wb_status status =
        wb_three_point_calibrate_run(&calibration, datasets->pointers, datasets->n, settings, NULL);
    wb_progress_finish(&progress);
    const int code = status == WB_OK ? deliver(&calibration, common) : wb_command_exit(status);
    wb_three_point_calibrate_release(&calibration);
    return code;
}
