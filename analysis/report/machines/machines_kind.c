#include "analysis/report/machines/machines_kind.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/keys/common.h"
#include "analysis/keys/row.h"
#include "analysis/report/numbers.h"
#include "analysis/report/pages.h"
#include "analysis/report/pdf.h"
#include "base/memory.h"
#include "base/units.h"

/* --- figures --- */

static int count_groups(const void *context)
{
    const struct wb_machines_results *const results = context;
    return results->campaign->n_groups;
}

static void add_tests(struct wb_panel *panel, const struct wb_machines_group *group,
                      const struct wb_machines_group_results *results)
{
    static const struct wb_figure_style style = {.colour = {0.45, 0.5, 0.56, 1.0}, .width = 0.6};
    bool named = false;
    for (int i = 0; i < group->n_tests; i++) {
        const struct wb_machines_test *const test = &results->tests[i];
        const size_t n = test->dataset.n_rows;
        if (!test->is_usable)
            continue;
        double *const x = wb_memory_new(2 * n, sizeof *x);
        for (size_t k = 0; k < n; k++) {
            x[k] = (test->dataset.rows[k].deflection - test->start) / WB_MM;
            x[n + k] = test->dataset.rows[k].force / WB_MN;
        }
        wb_figure_add_line(panel, named ? NULL : "tests", n, x, x + n, &style);
        named = true;
        free(x);
    }
}

/* The mean last: tests would cover it. */
static void add_curves(struct wb_panel *panel, const struct wb_machines_group *group,
                       const struct wb_machines_group_results *results)
{
    static const struct wb_figure_style style = {.colour = WB_PALETTE_INK, .width = 1.4};
    static const struct wb_colour pale = WB_PALETTE_PALE(0.5);
    double x[WB_MACHINES_GRID], y[WB_MACHINES_GRID], low[WB_MACHINES_GRID], high[WB_MACHINES_GRID];
    for (int k = 0; k < WB_MACHINES_GRID; k++) {
        const double s = isfinite(results->deviation[k]) ? results->deviation[k] : 0.0;
        x[k] = results->reach * k / (WB_MACHINES_GRID - 1) / WB_MM;
        y[k] = results->force[k] / WB_MN;
        low[k] = (results->force[k] - s) / WB_MN;
        high[k] = (results->force[k] + s) / WB_MN;
    }
    const double *const edges[2] = {low, high};
    if (results->n_usable > 1)
        wb_figure_add_band(panel, "mean \xc2\xb1 s", WB_MACHINES_GRID, x, edges, pale);
    add_tests(panel, group, results);
    wb_figure_add_line(panel, "mean, usable range", WB_MACHINES_GRID, x, y, &style);
}

/* "4: six wires", or the name alone where it has no label of its own. */
static void full_name(char *text, size_t size, const struct wb_machines_group *group)
{
    if (strcmp(group->name, group->label) == 0)
        snprintf(text, size, "%s", group->name);
    else
        snprintf(text, size, "%s: %s", group->name, group->label);
}

static enum wb_status draw_group(struct wb_figures_item *item)
{
    const struct wb_machines_results *const results = item->results;
    const struct wb_machines_group *const group = &results->campaign->groups[item->index];
    const struct wb_machines_group_results *const of = &results->groups[item->index];
    char name[32], label[6 * sizeof group->label];
    if (of->n_usable == 0)
        return WB_OK;
    snprintf(name, sizeof name, "group-%d", item->index + 1);
    WB_TRY(wb_figure_create(&item->figure, name, WB_PDF_WIDTH, 200.0));
    wb_figure_set_footer(item->figure, "measured");
    struct wb_panel *const panel = wb_figure_add_panel(item->figure);
    wb_figure_set_axes(panel, "Travel from the first contact (mm)", "Force (mN)");
    wb_figure_set_y_range(panel, 0.0, (double)NAN);
    wb_text_append(&item->caption, "Force over travel of %s, %d of %d tests, span %.4g mm.",
                   wb_pages_escape(label, sizeof label, group->label), of->n_usable, group->n_tests,
                   group->machine.span / WB_MM);
    add_curves(panel, group, of);
    return WB_OK;
}

/* Nominal moments of all groups over the nominal curvature, which makes tests at different spans
 * comparable. */
static enum wb_status draw_found(struct wb_figures_item *item)
{
    const struct wb_machines_results *const results = item->results;
    struct wb_panel *panel = NULL;
    for (int g = 0; g < results->campaign->n_groups; g++) {
        const struct wb_machines_group *const group = &results->campaign->groups[g];
        const struct wb_machines_group_results *const of = &results->groups[g];
        const double span = group->machine.span;
        double x[WB_MACHINES_GRID], y[WB_MACHINES_GRID];
        char name[240], label[300];
        int n = 0;
        /* The first contact is left out: there is no logarithm of no force. */
        for (int k = 5; k < WB_MACHINES_GRID && of->n_usable > 0; k++) {
            const double d = of->reach * k / (WB_MACHINES_GRID - 1);
            if (!(of->force[k] > 0.0))
                continue;
            x[n] = 12.0 * d / (span * span);
            y[n++] = 0.25 * of->force[k] * span / WB_NMM;
        }
        if (n == 0)
            continue;
        if (!panel) {
            WB_TRY(wb_figure_create(&item->figure, "moments", WB_PDF_WIDTH, 185.0));
            wb_figure_set_footer(item->figure, "measured");
            panel = wb_figure_add_panel(item->figure);
            wb_figure_set_axes(panel, "Nominal curvature 12 d / L<sup>2</sup> (1/m)",
                               "Moment F L / 4 (N mm)");
            wb_figure_set_logarithmic_y(panel);
            wb_text_append(&item->caption, "Mean moment under the nose over the nominal curvature, "
                                           "of the tests of each group.");
        }
        full_name(name, sizeof name, group);
        const struct wb_figure_style style = {.colour = wb_palette_wire(g),
                                              .width = 1.3,
                                              .dash = g % 2 ? WB_DASH_DASHED : WB_DASH_SOLID};
        wb_figure_add_line(panel, wb_pages_escape(label, sizeof label, name), (size_t)n, x, y,
                           &style);
    }
    return WB_OK;
}

static const struct wb_figures_row figures[] = {
    {.place = "found", .draw = draw_found},
    {.place = "group", .count = count_groups, .draw = draw_group},
    {.place = "fit", .count = wb_machines_fits_count, .draw = wb_machines_fits_draw},
    {.place = "layer", .count = wb_machines_cable_count, .draw = wb_machines_cable_draw},
};

/* --- pages --- */

static void put_overview(struct wb_document *document, const struct wb_machines_results *results)
{
    static const struct wb_document_column columns[] = {
        {"Group", .wraps = true},
        {"<i>d</i> (mm)", .right = true},
        {"Span (mm)", .right = true},
        {"Tests", .right = true},
        {"<i>F</i> <i>L</i><sup>3</sup>/48 <i>d</i> (N\xc2\xa0mm\xc2\xb2)", .right = true,
         .wraps = true},
        {"<i>s</i> (%)", .right = true},
        {"Usable to (mm)", .right = true, .wraps = true},
        {"<i>F</i> there (mN)", .right = true, .wraps = true},
    };
    struct wb_document_table *const table = wb_document_table(
        document,
        "<i>F</i> <i>L</i><sup>3</sup>/48 <i>d</i>: flexural rigidity of an elastic wire, "
        "at a deflection <i>d</i> of 0.02 of the span <i>L</i> from the first "
        "contact; <i>s</i>: its standard deviation between tests.",
        (int)WB_COUNT(columns), columns);
    for (int g = 0; g < results->campaign->n_groups; g++) {
        const struct wb_machines_group *const group = &results->campaign->groups[g];
        const struct wb_machines_group_results *const of = &results->groups[g];
        char name[240];
        wb_document_row(table, false);
        full_name(name, sizeof name, group);
        wb_pages_cell_plain(table, WB_TONE_PLAIN, name);
        wb_pages_cell_number(table, group->piece.outer_diameter / WB_MM, 2);
        wb_pages_cell_number(table, group->machine.span / WB_MM, 1);
        wb_pages_cell(table, of->n_usable < group->n_tests ? WB_TONE_WARNING : WB_TONE_PLAIN,
                      "%d of %d", of->n_usable, group->n_tests);
        wb_pages_cell_number(table, of->rigidity / WB_NMM2, 1);
        wb_pages_cell_number(table, of->rigidity_deviation / of->rigidity / WB_PERCENT, 0);
        wb_pages_cell_number(table, of->n_usable > 0 ? of->reach / WB_MM : (double)NAN, 2);
        wb_pages_cell_number(table, of->force[WB_MACHINES_GRID - 1] / WB_MN, 1);
    }
}

static void put_tests(struct wb_document *document, const struct wb_machines_group *group,
                      const struct wb_machines_group_results *of)
{
    static const struct wb_document_column columns[] = {
        {"File", .wraps = true},
        {"Rows", .right = true},
        {"Empty", .right = true},
        {"Partial", .right = true},
        {"<i>F</i><sub>max</sub> (mN)", .right = true},
        {"Contact (mm)", .right = true},
        {"<i>F</i> <i>L</i><sup>3</sup>/48 <i>d</i> (N\xc2\xa0mm\xc2\xb2)", .right = true,
         .wraps = true},
    };
    struct wb_document_table *const table =
        wb_document_table(document, NULL, (int)WB_COUNT(columns), columns);
    for (int i = 0; i < group->n_tests; i++) {
        const struct wb_machines_test *const test = &of->tests[i];
        wb_document_row(table, false);
        wb_pages_cell_plain(table, WB_TONE_PLAIN, wb_file_name(group->tests[i]));
        if (!test->is_usable) {
            wb_pages_cell_plain(table, WB_TONE_WARNING, wb_text_string(&test->problem));
            continue;
        }
        wb_pages_cell(table, WB_TONE_PLAIN, "%zu", test->report.rows);
        wb_pages_cell(table, WB_TONE_PLAIN, "%zu", test->report.empty);
        wb_pages_cell(table, WB_TONE_PLAIN, "%zu", test->report.partial);
        wb_pages_cell_number(table, test->report.largest_force / WB_MN, 1);
        wb_pages_cell_number(table, test->start / WB_MM, 3);
        wb_pages_cell_number(table, test->rigidity / WB_NMM2, 1);
    }
}

static void build_pages(struct wb_document *document, const void *context,
                        const struct wb_figures *drawn)
{
    const struct wb_machines_results *const results = context;
    const struct wb_machines *const campaign = results->campaign;
    char subtitle[200], anchor[32], name[240];
    snprintf(subtitle, sizeof subtitle, "%d of %d tests used", results->outcome.n_usable,
             results->outcome.n_wanted);
    wb_pages_start(document, "Tests of testing machines", &campaign->head, subtitle, NULL, "");
    wb_machines_found_put(document, results);
    wb_figures_put(drawn, document, "found", 0);
    wb_document_heading(document, 2, "groups", "Groups");
    put_overview(document, results);
    wb_machines_cable_put(document, results, drawn);
    wb_machines_fits_put(document, results, drawn);
    for (int g = 0; g < campaign->n_groups; g++) {
        snprintf(anchor, sizeof anchor, "group-%d", g + 1);
        full_name(name, sizeof name, &campaign->groups[g]);
        wb_document_heading(document, 2, anchor, name);
        wb_figures_put(drawn, document, "group", g);
        put_tests(document, &campaign->groups[g], &results->groups[g]);
    }
    wb_pages_put_origin(document, &campaign->head, "files");
}

/* --- numbers --- */

#define TEST(member) WB_AT(struct wb_machines_test, member)
#define GROUP(member) WB_AT(struct wb_machines_group, member)
#define MEAN(member) WB_AT(struct wb_machines_group_results, member)

static const struct wb_key machine_test_rows[] = {
    {"file", TEXT, "file of the test"},
    {"state", TEXT, "whether the test is used", .choices = "used|missing|refused"},
    {"sha256", TEXT | OPTIONAL, "SHA-256 of the file"},
    {"problem", TEXT | OPTIONAL, "why the test is not used"},
    {"rows", TEST(report.rows) | OPTIONAL, "rows of the test"},
    {"empty_rows", TEST(report.empty) | OPTIONAL, "lines without force and travel"},
    {"partial_rows", TEST(report.partial) | OPTIONAL, "rows left out because a value is missing"},
    {"largest_force_N", TEST(report.largest_force) | UNKNOWN | OPTIONAL, "largest force"},
    {"contact_mm", TEST(start) | UNKNOWN | OPTIONAL, "travel at the first contact"},
    {"early_rigidity_N_mm2", TEST(rigidity) | UNKNOWN | OPTIONAL,
     "F L^3 / 48 d at d = 0.02 of the span from the first contact"},
};
static WB_KEYS(machine_test, "machine_test", "A test of a group.");

static const struct wb_key group_rows[] = {
    {"name", GROUP(name), "name of the group"},
    {"label", GROUP(label), "name in the report"},
    {"outer_diameter_mm", GROUP(piece.outer_diameter), "outer diameter"},
    {"zero_force_mN", GROUP(zero_force), "force that marks the first contact"},
    {"machine", OBJECT, "testing machine", &wb_common_machine_keys},
    {"early_rigidity_N_mm2", MEAN(rigidity) | UNKNOWN, "mean of the tests' early rigidity"},
    {"early_rigidity_deviation_N_mm2", MEAN(rigidity_deviation) | UNKNOWN,
     "its standard deviation"},
    {"reach_mm", NUMBER | UNKNOWN | OPTIONAL, "deflection that all tests reach"},
    {"force_N", NUMBER | LIST | UNKNOWN | OPTIONAL,
     "mean force at even deflections from 0 to `reach_mm`"},
    {"force_deviation_N", NUMBER | LIST | UNKNOWN | OPTIONAL, "its standard deviation"},
    {"tests", OBJECT | LIST, "tests", &machine_test_keys},
};
static WB_KEYS(group, "machine_group", "A group of tests.");

static const struct wb_key wb_machines_kind_rows[] = {
    {.of = &wb_numbers_head_keys},
    {"tests_wanted", WB_AT(struct wb_kind_outcome, n_wanted), "tests of the campaign"},
    {"tests_used", WB_AT(struct wb_kind_outcome, n_usable), "tests that are used"},
    {"tests_missing", WB_AT(struct wb_kind_outcome, n_missing), "tests whose files are missing"},
    {"groups", OBJECT | LIST, "groups of tests", &group_keys},
    {"cable", OBJECT | OPTIONAL, "layered cable", &wb_machines_cable_keys},
    {"wires", OBJECT | LIST | OPTIONAL, "calibrated wires", &wb_machines_fits_keys},
};
WB_KEYS(wb_machines_kind, "report_of_machine", "The report of a campaign of testing machines.");

static void put_test(struct wb_json *list, const char *file, const struct wb_machines_test *test)
{
    struct wb_json *const entry = wb_json_append_object(list);
    wb_json_set_text(entry, "file", file);
    wb_json_set_text(entry, "state",
                     test->is_usable    ? "used"
                     : test->is_missing ? "missing"
                                        : "refused");
    if (!test->is_missing)
        wb_json_set_text(entry, "sha256", test->sha256);
    if (!test->is_usable) {
        wb_json_set_text(entry, "problem", wb_text_string(&test->problem));
        return;
    }
    WB_PUT(entry, &machine_test_keys, struct wb_machines_test, test);
}

static struct wb_json *build_json(const void *context)
{
    const struct wb_machines_results *const results = context;
    const struct wb_machines *const campaign = results->campaign;
    struct wb_json *const root = wb_numbers_create(&campaign->head, "measured", &results->outcome);
    WB_PUT(root, &wb_machines_kind_keys, struct wb_kind_outcome, &results->outcome);
    struct wb_json *const groups = wb_json_set_array(root, "groups");
    for (int g = 0; g < campaign->n_groups; g++) {
        const struct wb_machines_group *const group = &campaign->groups[g];
        const struct wb_machines_group_results *const of = &results->groups[g];
        struct wb_json *const entry = wb_json_append_object(groups);
        WB_PUT(entry, &group_keys, struct wb_machines_group, group);
        wb_machine_set_json(&group->machine, wb_json_set_object(entry, "machine"));
        WB_PUT(entry, &group_keys, struct wb_machines_group_results, of);
        if (of->n_usable > 0) {
            wb_json_set_number(entry, "reach_mm", of->reach / WB_MM);
            wb_numbers_put_list(entry, "force_N", of->force, WB_MACHINES_GRID, 1.0);
            wb_numbers_put_list(entry, "force_deviation_N", of->deviation, WB_MACHINES_GRID, 1.0);
        }
        struct wb_json *const tests = wb_json_set_array(entry, "tests");
        for (int i = 0; i < group->n_tests; i++)
            put_test(tests, group->tests[i], &of->tests[i]);
    }
    wb_machines_cable_put_json(root, results);
    wb_machines_fits_put_json(root, results);
    return root;
}

static void print(FILE *out, const void *context)
{
    const struct wb_machines_results *const results = context;
    const struct wb_machines *const campaign = results->campaign;
    fprintf(out, "%s: %d of %d tests used\n", campaign->head.title, results->outcome.n_usable,
            results->outcome.n_wanted);
    if (!results->has_folder)
        fprintf(out, "  the data are missing: set %s to the path of their folder\n",
                campaign->environment);
    for (int g = 0; g < campaign->n_groups; g++) {
        const struct wb_machines_group_results *const of = &results->groups[g];
        for (int i = 0; i < campaign->groups[g].n_tests && results->has_folder; i++) {
            if (!of->tests[i].is_usable)
                fprintf(out, "  not used: %s: %s\n", wb_file_name(campaign->groups[g].tests[i]),
                        wb_text_string(&of->tests[i].problem));
        }
        if (of->n_usable > 0)
            fprintf(out, "  %-40s F L^3/48 d = %.4g N mm2, s = %.2g\n", campaign->groups[g].label,
                    of->rigidity / WB_NMM2, of->rigidity_deviation / WB_NMM2);
    }
    wb_machines_cable_print(out, results);
}

static enum wb_status add_cards(struct wb_cards *cards, const void *context)
{
    const struct wb_machines_results *const results = context;
    struct wb_properties_dataset list[WB_PROPERTIES_MOST_DATASETS];
    for (int i = 0; i < results->fits.n; i++) {
        const struct wb_machines_fit *const fit = &results->fits.fits[i];
        struct wb_text text = {0};
        if (!fit->is_fitted)
            continue;
        const int n = wb_machines_fits_list(fit, results->campaign, results->groups, list);
        wb_properties_format_three_point(&text, &fit->calibration, list, n);
        WB_TRY(wb_cards_add(cards, results->campaign->groups[fit->first].piece.wire, &text));
    }
    return WB_OK;
}

const struct wb_kind wb_machines_kind = {
    .name = "machine",
    .data = "tests of a machine",
    .campaign_size = sizeof(struct wb_machines),
    .results_size = sizeof(struct wb_machines_results),
    .keys = wb_machines_keys,
    .load = wb_machines_results_load,
    .compute = wb_machines_results_compute,
    .figures = figures,
    .n_figures = WB_COUNT(figures),
    .pages = build_pages,
    .cards = add_cards,
    .json = build_json,
    .print = print,
    .release = wb_machines_results_release,
    .release_campaign = wb_machines_release,
};
