/* wirebench calibrate --compliance: compliance of a machine, from tests of a stiff bar. */
#include <math.h>
#include <stdio.h>

#include "analysis/calibration/three_point/machine_compliance.h"
#include "base/circle.h"
#include "base/json.h"
#include "base/units.h"
#include "cli/calibrate.h"
#include "cli/command.h"
#include "cli/datasets.h"
#include "cli/finding.h"
#include "cli/settings.h"

#define WB_LOG_DOMAIN "calibrate"

struct options {
    struct wb_command_common common;
    struct wb_datasets datasets;
    struct wb_machine_compliance_settings settings;
};

static const struct argp_option other_options[] = {
    {"compliance", WB_KEY_IGNORED, NULL, 0, "Compliance of a machine from a stiff bar"},
    {"json", WB_KEY_JSON, NULL, 0, "Print one JSON object"},
    {0},
};

static const struct argp argp = {
    .options = other_options,
    .parser = wb_command_parse_common,
    .args_doc = "DATASET...",
    .doc = "The compliance of a three-point bending machine (compliance_mm_N of its machine file), "
           "from tests of a stiff elastic bar whose flexural rigidity is known.\v"
           "Exit code 3: the compliance cannot be determined; a warning says whether the bar is "
           "too compliant, too uncertain, yields or slips.",
};

static void print_text(const struct wb_machine_compliance *c, const struct wb_test_info *info)
{
    printf("%s, three-point bending, span %g mm, %d test%s\n", info->wire, info->length / WB_MM,
           c->n_tests, c->n_tests == 1 ? "" : "s");
    printf("compliance of the machine %.3g mm/N, %.3g to %.3g (95 %%); of the bar %.3g mm/N\n",
           c->value / WB_MM, c->low / WB_MM, c->high / WB_MM, c->of_bar / WB_MM);
    printf("half width of the interval: readings %.2g, rigidity of the bar %.2g, friction %.2g "
           "mm/N\n",
           c->of_readings / WB_MM, c->of_rigidity / WB_MM, c->of_friction / WB_MM);
    printf("the readings deviate from a straight line by %.2g mm (RMS)\n", c->misfit / WB_MM);
    if (c->has_unloading)
        printf("unloading %.3g mm/N; residual travel %.2g of %.3g mm\n", c->value_unloading / WB_MM,
               c->residual / WB_MM, c->most_travel / WB_MM);
    if (c->is_identifiable)
        printf("for the machine file:\ncompliance_mm_N: %.3g\n", c->value / WB_MM);
}

static void print_finding(const struct wb_machine_compliance *c, const struct wb_test_info *info)
{
    struct wb_finding finding = {.figure = NULL};
    wb_text_append(&finding.found, "compliance %.3g mm/N (%.3g to %.3g), from %d test%s of %s (%s)",
                   c->value / WB_MM, c->low / WB_MM, c->high / WB_MM, c->n_tests,
                   c->n_tests == 1 ? "" : "s", info->wire, wb_finding_source(info));
    if (!c->is_identifiable)
        wb_text_append(&finding.trust,
                       "no: cannot be determined from these tests, see the warning");
    else if (!c->has_unloading)
        wb_text_append(&finding.trust,
                       "if the bar did not yield: unloading was not measured, so that this is not "
                       "checked");
    else
        wb_text_append(&finding.trust, "yes: the readings are straight, and unloading follows "
                                       "loading within 3 %%");
    if (c->is_identifiable)
        wb_text_append(&finding.next,
                       "write compliance_mm_N: %.3g into the machine file and import the tests "
                       "again",
                       c->value / WB_MM);
    else
        wb_text_append(&finding.next, "test a stiffer bar, or with less force, up and down again");
    wb_finding_print(&finding);
}

static void print_json(const struct wb_machine_compliance *c, const struct wb_test_info *info)
{
    struct wb_json *const root = wb_json_create();
    wb_json_set_text(root, "bar", info->wire);
    wb_json_set_integer(root, "tests", c->n_tests);
    wb_json_set_number(root, "compliance_mm_N", c->value / WB_MM);
    wb_json_set_number(root, "low", c->low / WB_MM);
    wb_json_set_number(root, "high", c->high / WB_MM);
    wb_json_set_boolean(root, "determined", c->is_identifiable);
    wb_json_set_boolean(root, "straight", c->is_straight);
    wb_json_set_boolean(root, "has_unloading", c->has_unloading);
    wb_json_set_boolean(root, "is_reversible", c->is_reversible);
    wb_json_set_number(root, "unloading_compliance_mm_N", c->value_unloading / WB_MM);
    wb_json_set_number(root, "residual_travel_mm", c->residual / WB_MM);
    wb_json_set_number(root, "largest_travel_mm", c->most_travel / WB_MM);
    wb_json_set_number(root, "strain", c->strain);
    wb_json_set_number(root, "of_the_bar_mm_N", c->of_bar / WB_MM);
    wb_json_set_number(root, "half_by_readings_mm_N", c->of_readings / WB_MM);
    wb_json_set_number(root, "half_by_rigidity_mm_N", c->of_rigidity / WB_MM);
    wb_json_set_number(root, "half_by_friction_mm_N", c->of_friction / WB_MM);
    wb_json_set_number(root, "misfit_mm", c->misfit / WB_MM);
    wb_command_print_json(root);
}

static int deliver(const struct options *o, const struct wb_machine_compliance *c)
{
    const struct wb_test_info *const info = &o->datasets.items[0].info;
    const double modulus = o->settings.rigidity / wb_circle_second_moment(info->outer_diameter);
    if (o->common.json) {
        print_json(c, info);
    } else {
        print_text(c, info);
        print_finding(c, info);
    }
    if (!c->has_unloading)
        wb_warn(
            "no unloading was measured: a bar that yields early gives a straight line as well, and "
            "a compliance that is too large; the strain of its outer fibre was %.2g %%, so that "
            "the bar must not yield below %.0f MPa",
            100.0 * c->strain, c->strain * modulus / WB_MPA);
    if (c->is_identifiable)
        return WB_EXIT_OK;
    if (!c->is_reversible)
        wb_warn(
            "the bar yields or slips: residual travel %.2g of %.3g mm, slope %.3g mm/N during "
            "loading and %.3g mm/N during unloading; use less force, or a thicker bar of harder "
            "steel",
            c->residual / WB_MM, c->most_travel / WB_MM, c->value / WB_MM,
            c->value_unloading / WB_MM);
    else if (!c->is_straight && c->low > 0.0)
        wb_warn("the readings are not on a straight line: the bar yields or slips, or the machine "
                "has play; use less force, or a thicker bar");
    else if (c->of_rigidity > fmax(c->of_readings, c->of_friction))
        wb_warn("the bar is too compliant: its own compliance is %.3g mm/N, known within %.2g %%; "
                "use a bar %.2g times as stiff, or a shorter span",
                c->of_bar / WB_MM, 100.0 * c->of_rigidity / c->of_bar,
                fmax(2.0, 4.0 * c->of_rigidity / fmax(fabs(c->value), 0.1 * c->of_rigidity)));
    else
        wb_warn("the machine's compliance cannot be determined: its uncertainty, mainly from %s, "
                "exceeds its value",
                c->of_readings > c->of_friction ? "the readings" : "the range of friction");
    return WB_EXIT_INCOMPLETE;
}

int wb_calibrate_compliance(int argc, char **argv)
{
    struct options options = {.common = {.noun = "at least one dataset", .least = 1}};
    struct wb_machine_compliance result;
    wb_setting_fill(&wb_machine_compliance_table, &options.settings);
    wb_settings_parse_table(&argp, &wb_machine_compliance_table, &options.settings, 1, argc, argv,
                            &options);
    enum wb_status status = wb_datasets_read(&options.datasets, options.common.inputs,
                                             options.common.n, WB_TEST_BIT(WB_TEST_THREE_POINT));
    if (status == WB_OK)
        status = wb_machine_compliance_find(&result, options.datasets.pointers, options.datasets.n,
                                            &options.settings, NULL);
    const int code = status == WB_OK ? deliver(&options, &result) : wb_command_exit(status);
    wb_datasets_release(&options.datasets);
    return code;
}
