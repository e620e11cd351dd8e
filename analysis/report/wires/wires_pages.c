/* Summary, cost and provenance of a comparison. */
#include "analysis/report/wires/wires_pages.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/report/pages_private.h"
#include "base/text.h"
#include "base/units.h"
#include "base/version.h"

/* --- what is missing, what is exceeded --- */

static void put_missing(struct wb_document *document, const struct wb_wires_results *results)
{
    const struct wb_wires *const comparison = results->comparison;
    if (results->is_complete)
        return;
    char text[1700], name[600], problem[900];
    const int n = results->n_wanted - results->n_usable;
    if (n > 0)
        snprintf(text, sizeof text,
                 "<b>Incomplete.</b> %d of %d datasets %s missing or cannot be used. The report "
                 "shows what the others give.",
                 n, results->n_wanted, wb_pages_plural(n, "is", "are"));
    else
        snprintf(text, sizeof text,
                 "<b>Incomplete.</b> All datasets are there, but not every step could be done.");
    wb_document_notice(document, WB_TONE_WARNING, text);
    for (int i = 0; i < comparison->n_cases; i++) {
        for (int k = 0; k < WB_WIRES_SOLVERS; k++) {
            const struct wb_wires_run *const run = &results->runs[i][k];
            if (run->state == WB_WIRES_NOT_WANTED || run->state == WB_WIRES_USABLE)
                continue;
            snprintf(text, sizeof text, "<b>%s</b>: %s. To make it:",
                     wb_pages_escape(name, sizeof name, comparison->cases[i].datasets[k].name),
                     wb_pages_escape(problem, sizeof problem, wb_text_string(&run->problem)));
            wb_document_item(document, WB_TONE_WARNING, text);
            wb_document_code(document, run->command);
        }
    }
    if (results->fit_state != WB_WIRES_USABLE) {
        snprintf(text, sizeof text, "<b>No fitted rod</b>: %s",
                 wb_pages_escape(problem, sizeof problem, wb_text_string(&results->fit_problem)));
        wb_document_item(document, WB_TONE_WARNING, text);
    }
}

/* One sentence for each limit; `value` NaN: not known. */
static void put_limit(struct wb_document *document, const char *what, double value, double limit)
{
    char text[400];
    if (!(limit > 0.0) || isnan(value))
        return;
    const bool kept = value <= limit;
    snprintf(text, sizeof text, "<b>%s</b> %s: %.3g %%, limit %.3g %%.",
             kept ? "Limit kept." : "Limit exceeded.", what, value / WB_PERCENT,
             limit / WB_PERCENT);
    wb_document_item(document, kept ? WB_TONE_GOOD : WB_TONE_WARNING, text);
}

static void put_limits(struct wb_document *document, const struct wb_wires_results *results)
{
    static const char *const names[] = {
        "Tip of the elastic solid from the exact one, over its displacement",
        "Tip of the elastic rod from the exact one, over its displacement"};
    const struct wb_wires *const comparison = results->comparison;
    for (int k = 0; k < WB_WIRES_SOLVERS; k++) {
        const struct wb_wires_run *const run =
            wb_wires_usable(results, WB_WIRES_ELASTIC, (enum wb_wires_solver)k);
        put_limit(document, names[k], run ? wb_wires_tip_error(results, run) : (double)NAN,
                  comparison->tip_limit);
    }
    double largest = (double)NAN;
    for (int i = 0; i < results->n_stresses; i++)
        largest =
            fmax(largest, fabs(results->stresses[i].core.stress / results->stresses[i].beam - 1.0));
    put_limit(document, "Elastic stress of the core's outer fibre from <i>E\xce\xba</i><i>r</i>",
              largest, comparison->stress_limit);
    put_limit(document, "CPU seconds of the elastic rod over those of the solid",
              wb_wires_cost(results, WB_WIRES_ELASTIC), comparison->cost_limit);
}

/* --- what came out --- */

struct fact {
    const char *what, *unit;
    double ours;
    int decimals;
    const char *paper; /* NULL or "": nothing */
};

static void put_fact(struct wb_document *document, struct wb_document_table *table,
                     const struct fact *fact)
{
    struct wb_pages_row row = {.n = 0};
    wb_pages_cell(&row, WB_TONE_PLAIN, "%s", fact->what);
    wb_pages_cell(&row, WB_TONE_QUIET, "%s", fact->unit);
    wb_pages_cell_number(&row, fact->ours, fact->decimals);
    if (fact->paper && fact->paper[0])
        wb_pages_cell_plain(&row, WB_TONE_PLAIN, fact->paper);
    else
        wb_pages_cell(&row, WB_TONE_QUIET, "\xe2\x80\x93");
    wb_pages_put_row(document, table, false, &row);
}

static double angle_of(const struct wb_wires_run *run)
{
    return run ? run->tip_angle / WB_DEGREE : (double)NAN;
}

static double largest_stress(const struct wb_wires_results *results, int index)
{
    const struct wb_wires_run *const run = wb_wires_usable(results, index, WB_WIRES_SOLID);
    const struct wb_field *const field =
        run ? wb_fields_find(&run->fields, results->comparison->loaded_state, (double)NAN) : NULL;
    return wb_wires_find_peak(field, 0).stress / WB_MPA;
}

static double distance_between(const struct wb_wires_run *one, const struct wb_wires_run *other)
{
    return one && other ? wb_wires_distance(one, other) / WB_MM : (double)NAN;
}

static void put_facts(struct wb_document *document, const struct wb_wires_results *results)
{
    static const struct wb_document_column columns[] = {
        {.heading = "Simulated at the full force", .wraps = true},
        {"Unit"},
        {.heading = "Here", .right = true},
        {.heading = "Paper", .right = true},
    };
    const struct wb_wires *const comparison = results->comparison;
    const struct wb_wires_run *runs[WB_WIRES_RESIDUAL][WB_WIRES_SOLVERS];
    for (int i = 0; i < WB_WIRES_RESIDUAL; i++) {
        for (int k = 0; k < WB_WIRES_SOLVERS; k++)
            runs[i][k] = wb_wires_usable(results, i, (enum wb_wires_solver)k);
    }
    const struct wb_wires_run *const elastic = runs[WB_WIRES_ELASTIC][0];
    const struct wb_wires_run *const plastic = runs[WB_WIRES_ELASTOPLASTIC][0];
    const bool fitted = results->fit_state == WB_WIRES_USABLE && results->fitted.reached;
    const double none = (double)NAN;
    char stress[40] = "", cost[40] = "";
    if (comparison->printed_stress > 0.0)
        snprintf(stress, sizeof stress, "%.0f", comparison->printed_stress / WB_MPA);
    if (comparison->printed_cost > 0.0)
        snprintf(cost, sizeof cost, "below %g", comparison->printed_cost / WB_PERCENT);
    const struct fact facts[] = {
        {"Elastic: largest von Mises stress of the core, 3D", "MPa",
         largest_stress(results, WB_WIRES_ELASTIC), 0, stress},
        {"Elastic: largest distance of the axes, 1D from 3D", "mm",
         distance_between(elastic, runs[WB_WIRES_ELASTIC][1]), 3, NULL},
        {"Elastic: largest distance of the axes, friction from bond", "mm",
         distance_between(elastic, runs[WB_WIRES_CONTACT][0]), 3, NULL},
        {"Elastic: angle of the tip, 3D", "degrees", angle_of(elastic), 2, NULL},
        {"Elastoplastic: angle of the tip, 3D", "degrees", angle_of(plastic), 1, NULL},
        {"Elastoplastic: largest distance of the axes, 1D fibres from 3D", "mm",
         distance_between(plastic, runs[WB_WIRES_ELASTOPLASTIC][1]), 2, NULL},
        {"Elastoplastic: largest distance of the axes, 1D fitted from 3D", "mm",
         fitted && plastic ? wb_wires_rod_distance(plastic, &results->fitted) / WB_MM : none, 2,
         NULL},
        {"Elastoplastic: angle of the tip, 1D with the printed properties", "degrees",
         results->printed.reached ? results->printed.tip_angle / WB_DEGREE : none, 0, NULL},
        {"Cost of the elastic rod over the solid's", "%",
         wb_wires_cost(results, WB_WIRES_ELASTIC) / WB_PERCENT, 2, cost},
    };
    wb_document_heading(document, 2, "facts", "What came out");
    struct wb_document_table *const table = wb_document_table(
        document,
        comparison->printed_source[0]
            ? "Paper: what it prints. It has no numbers for the rest, and its figures are lost."
            : NULL,
        4, columns);
    for (size_t i = 0; i < sizeof facts / sizeof facts[0]; i++)
        put_fact(document, table, &facts[i]);
}

void wb_wires_pages_summary(struct wb_document *document, const struct wb_wires_results *results)
{
    wb_document_heading(document, 1, "summary", "Summary");
    wb_document_notice(
        document, WB_TONE_ORIGIN,
        wb_wires_has_substitutes(results->comparison)
            ? "<b>Simulations.</b> Everything in this report is computed: a wire as a 3D solid and "
              "as a 1D rod. No wire was tested. The materials of the solid stand in for the "
              "paper's Table 1, which is lost, so its numbers cannot be had again; what can be "
              "shown is how solid and rod compare."
            : "<b>Simulations.</b> Everything in this report is computed: a wire as a 3D solid and "
              "as a 1D rod. No wire was tested.");
    put_missing(document, results);
    put_limits(document, results);
    put_facts(document, results);
}

/* --- cost --- */

static void put_simulation(struct wb_document *document, struct wb_document_table *table,
                           const struct wb_wires_results *results, int i, int k)
{
    static const char *const models[] = {"3D solid", "1D rod"};
    const struct wb_wires_run *const run = &results->runs[i][k];
    struct wb_pages_row row = {.n = 0};
    wb_pages_cell_plain(&row, WB_TONE_PLAIN,
                        k == WB_WIRES_SOLID ? results->comparison->cases[i].label : "");
    wb_pages_cell(&row, WB_TONE_PLAIN, "%s", models[k]);
    wb_pages_cell_number(&row, run->elements, 0);
    wb_pages_cell_number(&row, run->unknowns, 0);
    wb_pages_cell_number(&row, run->iterations, 0);
    wb_pages_cell_number(&row, run->cpu_s, run->cpu_s < 0.1 ? 3 : run->cpu_s < 10.0 ? 2 : 0);
    wb_pages_cell_number(&row, run->memory_MB, 0);
    if (run->state == WB_WIRES_USABLE)
        wb_pages_cell(&row, WB_TONE_GOOD, "converged");
    else
        wb_pages_cell(&row, WB_TONE_WARNING, "%s",
                      run->is_stale                    ? "model changed"
                      : run->is_cut_short              ? "cut short"
                      : run->state == WB_WIRES_MISSING ? "missing"
                                                       : "not used");
    wb_pages_cell_number(
        &row, k == WB_WIRES_ROD ? wb_wires_cost(results, i) / WB_PERCENT : (double)NAN, 2);
    wb_pages_put_row(document, table, k == WB_WIRES_SOLID, &row);
}

void wb_wires_pages_cost(struct wb_document *document, const struct wb_wires_results *results)
{
    static const struct wb_document_column columns[] = {
        {"Simulation"},
        {"Model"},
        {.heading = "Elements", .right = true},
        {.heading = "Unknowns", .right = true},
        {.heading = "Iterations", .right = true},
        {.heading = "CPU (s)", .right = true},
        {.heading = "Memory (MB)", .right = true, .wraps = true},
        {"State"},
        {.heading = "1D over 3D (%)", .right = true, .wraps = true},
    };
    const struct wb_wires *const comparison = results->comparison;
    wb_document_heading(document, 1, "cost", "Cost");
    struct wb_text caption = {0};
    wb_text_append(&caption, "CPU seconds and memory are those that each simulation stored when it "
                             "was made, on the machine that made it.");
    if (comparison->printed_cost > 0.0)
        wb_text_append(&caption,
                       " The paper: the elastic rod costs below %g %% of the bonded solid.",
                       comparison->printed_cost / WB_PERCENT);
    struct wb_document_table *const table =
        wb_document_table(document, wb_text_string(&caption), 9, columns);
    document->failed |= caption.failed;
    wb_text_release(&caption);
    for (int i = 0; i < comparison->n_cases; i++) {
        for (int k = 0; k < WB_WIRES_SOLVERS; k++) {
            if (results->runs[i][k].state != WB_WIRES_NOT_WANTED)
                put_simulation(document, table, results, i, k);
        }
    }
}

/* --- provenance --- */

static void put_material(struct wb_document *document, struct wb_document_table *table,
                         const struct wb_wire_model_part *part)
{
    const struct wb_material *const m = &part->material;
    struct wb_pages_row row = {.n = 0};
    wb_pages_cell_plain(&row, WB_TONE_PLAIN, part->name);
    wb_pages_cell_plain(&row, WB_TONE_PLAIN, part->material_name);
    wb_pages_cell_number(&row, part->outer_diameter / WB_MM, 2);
    wb_pages_cell_number(&row, m->youngs_modulus / WB_MPA, 0);
    wb_pages_cell_number(&row, m->poissons_ratio, 2);
    wb_pages_cell_number(&row, m->yield_stress / WB_MPA, 1);
    wb_pages_cell_number(&row, m->strength_coefficient / WB_MPA, 1);
    wb_pages_cell_number(&row, m->hardening_exponent, 2);
    wb_pages_cell(&row, part->is_substitute ? WB_TONE_WARNING : WB_TONE_PLAIN, "%s",
                  part->is_substitute ? "substitute" : "given");
    wb_pages_put_row(document, table, false, &row);
}

static void put_materials(struct wb_document *document, const struct wb_wires *comparison)
{
    static const struct wb_document_column columns[] = {
        {"Part"},
        {"Material"},
        {.heading = "Outside (mm)", .right = true},
        {.heading = "<i>E</i> (MPa)", .right = true},
        {.heading = "<i>\xce\xbd</i>", .right = true},
        {.heading = "<i>\xcf\x83</i><sub>Y</sub> (MPa)", .right = true},
        {.heading = "<i>K</i> (MPa)", .right = true},
        {.heading = "<i>n</i>", .right = true},
        {"Values"},
    };
    const struct wb_wire_model *const model = comparison->cases[WB_WIRES_ELASTOPLASTIC].model;
    wb_document_heading(document, 2, "materials", "Materials");
    struct wb_document_table *const table = wb_document_table(
        document,
        wb_wires_has_substitutes(comparison)
            ? "Substitute: stands in for a value of the paper's Table 1, which is lost."
            : NULL,
        9, columns);
    for (int i = 0; i < model->n_parts; i++)
        put_material(document, table, &model->part[i]);
    for (int i = 0; i < model->n_parts; i++) {
        char name[300], source[1200], item[1600];
        snprintf(item, sizeof item, "<b>%s</b>: %s",
                 wb_pages_escape(name, sizeof name, model->part[i].material_name),
                 wb_pages_escape(source, sizeof source, model->part[i].source));
        wb_document_item(document, WB_TONE_PLAIN, item);
    }
}

static void put_models(struct wb_document *document, const struct wb_wires *comparison)
{
    static const struct wb_document_column columns[] = {
        {"Model"}, {.heading = "SHA-256 of model, wire and materials", .monospace = true}};
    wb_document_heading(document, 2, "models", "Models");
    struct wb_document_table *const table = wb_document_table(document, NULL, 2, columns);
    for (int i = 0; i < comparison->n_cases; i++) {
        const struct wb_wires_case *const item = &comparison->cases[i];
        struct wb_pages_row row = {.n = 0};
        if (!item->model)
            continue;
        wb_pages_cell_plain(&row, WB_TONE_PLAIN, item->model_name);
        wb_pages_cell_plain(&row, WB_TONE_PLAIN, item->model->sha256);
        wb_pages_put_row(document, table, false, &row);
    }
}

static void put_datasets(struct wb_document *document, const struct wb_wires_results *results)
{
    static const struct wb_document_column columns[] = {
        {.heading = "Dataset", .wraps = true},
        {"Revision"},
        {.heading = "SHA-256 of force_deflection.csv", .monospace = true},
    };
    const struct wb_wires *const comparison = results->comparison;
    wb_document_heading(document, 2, "datasets", "Datasets");
    struct wb_document_table *const table =
        wb_document_table(document, "Revision: of the program that made it.", 3, columns);
    for (int i = 0; i < comparison->n_cases; i++) {
        for (int k = 0; k < WB_WIRES_SOLVERS; k++) {
            const struct wb_wires_run *const run = &results->runs[i][k];
            struct wb_pages_row row = {.n = 0};
            if (run->state == WB_WIRES_NOT_WANTED)
                continue;
            wb_pages_cell_plain(&row, WB_TONE_PLAIN, comparison->cases[i].datasets[k].name);
            if (run->state == WB_WIRES_USABLE)
                wb_pages_cell_plain(&row, WB_TONE_PLAIN, run->revision);
            else
                wb_pages_cell(&row, WB_TONE_WARNING, "not used");
            wb_pages_cell_plain(&row, WB_TONE_PLAIN, run->sha256);
            wb_pages_put_row(document, table, false, &row);
        }
    }
}

void wb_wires_pages_provenance(struct wb_document *document, const struct wb_wires_results *results)
{
    const struct wb_wires *const comparison = results->comparison;
    wb_pages_put_origin(document, comparison->name, comparison->sha256, comparison->notes,
                        "datasets");
    put_materials(document, comparison);
    put_models(document, comparison);
    put_datasets(document, results);
}

/* --- all of it --- */

void wb_wires_pages_build(struct wb_document *document, const struct wb_wires_results *results,
                          const struct wb_wires_figures *figures)
{
    char subtitle[300], footer[300];
    snprintf(footer, sizeof footer, "wirebench %s, revision %s \xc2\xb7 simulations, no tests",
             wb_version(), wb_version_revision());
    snprintf(subtitle, sizeof subtitle, "%d of %d simulations \xc2\xb7 wirebench %s, revision %s",
             results->n_usable, results->n_wanted, wb_version(), wb_version_revision());
    wb_document_init(document, "Simulation report", results->comparison->title, subtitle, footer,
                     "");
    wb_wires_pages_summary(document, results);
    wb_wires_pages_elastic(document, results, figures);
    wb_wires_pages_elastoplastic(document, results, figures);
    wb_wires_pages_residual(document, results, figures);
    wb_wires_pages_cost(document, results);
    wb_wires_pages_provenance(document, results);
}
