/* Summary, cost, runs and provenance of a report of bundles. */
#include "analysis/report/bundles/bundles_pages.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/report/pages_private.h"
#include "base/text.h"
#include "base/units.h"
#include "base/version.h"

const char *wb_bundles_pages_loading(const struct wb_bundles_run *run)
{
    static const char *const texts[2][2] = {{"dead force", "dead force, weight"},
                                            {"strand", "strand, weight"}};
    const struct wb_bundle_loads *const loads = &run->model->loads;
    return texts[loads->strand_length > 0.0][loads->weight];
}

const char *wb_bundles_pages_figure(char text[48], const char *number)
{
    text[0] = '\0';
    if (number[0])
        snprintf(text, 48, " (the paper's Fig. %s)", number);
    return text;
}

/* --- what is missing, what is exceeded --- */

static void put_missing_dataset(struct wb_document *document,
                                const struct wb_bundles_dataset *dataset,
                                const struct wb_bundles_result *result)
{
    char text[1700], name[600], problem[900];
    if (result->state == WB_BUNDLES_USABLE || result->state == WB_BUNDLES_NOT_WANTED)
        return;
    snprintf(text, sizeof text,
             "<b>%s</b>: %s. To make it:", wb_pages_escape(name, sizeof name, dataset->name),
             wb_pages_escape(problem, sizeof problem, wb_text_string(&result->problem)));
    wb_document_item(document, WB_TONE_WARNING, text);
    wb_document_code(document, dataset->command);
}

static void put_unfitted(struct wb_document *document, const struct wb_bundles_results *results)
{
    char text[1700], name[600], problem[900];
    for (int i = 0; i < results->campaign->n_bundles; i++) {
        const struct wb_bundles_fit *const fit = &results->fits[i];
        if (fit->state != WB_BUNDLES_REFUSED)
            continue;
        snprintf(text, sizeof text, "<b>%s</b>, no fitted beam: %s",
                 wb_pages_escape(name, sizeof name, results->campaign->bundles[i].label),
                 wb_pages_escape(problem, sizeof problem, wb_text_string(&fit->problem)));
        wb_document_item(document, WB_TONE_WARNING, text);
    }
}

static void put_missing(struct wb_document *document, const struct wb_bundles_results *results)
{
    const struct wb_bundles *const campaign = results->campaign;
    char text[400];
    const int n = results->n_wanted - results->n_usable;
    if (results->is_complete)
        return;
    if (n > 0)
        snprintf(text, sizeof text,
                 "<b>Incomplete.</b> %d of %d datasets %s missing or cannot be used. The report "
                 "shows what the others give. <tt>wirebench report --solve</tt> makes them.",
                 n, results->n_wanted, wb_pages_plural(n, "is", "are"));
    else
        snprintf(text, sizeof text,
                 "<b>Incomplete.</b> All datasets are there, but not every step could be done.");
    wb_document_notice(document, WB_TONE_WARNING, text);
    for (int i = 0; i < campaign->n_runs; i++)
        put_missing_dataset(document, &campaign->runs[i].dataset, &results->runs[i]);
    for (int i = 0; i < campaign->n_bundles; i++)
        put_missing_dataset(document, &campaign->bundles[i].rod, &results->rods[i]);
    put_unfitted(document, results);
}

static void put_limits(struct wb_document *document, const struct wb_bundles_results *results)
{
    struct wb_bundles_verdict verdicts[WB_BUNDLES_VERDICTS];
    const int n = wb_bundles_results_judge(results, verdicts);
    for (int i = 0; i < n; i++) {
        const struct wb_bundles_verdict *const v = &verdicts[i];
        char text[600], label[300], value[40] = "not known";
        if (isfinite(v->value))
            snprintf(value, sizeof value, "%.3g %%", v->value / WB_PERCENT);
        snprintf(text, sizeof text, "<b>%s</b> %s, %s: %s, limit %.3g %%.",
                 v->kept ? "Limit kept." : "Limit exceeded.", v->what,
                 wb_pages_escape(label, sizeof label, v->label), value, v->limit / WB_PERCENT);
        wb_document_item(document, v->kept ? WB_TONE_GOOD : WB_TONE_WARNING, text);
    }
}

/* --- what came out --- */

static void put_fact(struct wb_document *document, struct wb_document_table *table,
                     const struct wb_bundles_results *results, int index)
{
    const struct wb_bundles_bundle *const bundle = &results->campaign->bundles[index];
    const struct wb_bundles_result *const dynamic =
        wb_bundles_results_usable(results, bundle->dynamic);
    const struct wb_bundles_result *const constant =
        wb_bundles_results_usable(results, bundle->constant);
    const struct wb_bundles_fit *const fit = wb_bundles_results_fit(results, index);
    const double none = (double)NAN;
    struct wb_pages_row row = {.n = 0};
    wb_pages_cell_plain(&row, WB_TONE_PLAIN, bundle->label);
    wb_pages_cell_number(&row, dynamic ? dynamic->curve.max_force : none, 3);
    wb_pages_cell_number(&row, dynamic && dynamic->published ? dynamic->published_max : none, 3);
    wb_pages_cell_number(&row, dynamic && dynamic->published ? dynamic->rms : none, 4);
    wb_pages_cell_number(&row, constant && constant->published ? constant->rms : none, 4);
    wb_pages_cell_number(&row, fit ? fit->result.rms : none, 4);
    wb_pages_cell_number(&row, wb_bundles_results_cost(results, index) / WB_PERCENT, 3);
    wb_pages_put_row(document, table, false, &row);
}

static void put_facts(struct wb_document *document, const struct wb_bundles_results *results)
{
    static const struct wb_document_column columns[] = {
        {"Bundle"},
        {.heading = "<i>F</i><sub>max</sub>, 3D (N)", .right = true, .wraps = true},
        {.heading = "<i>F</i><sub>max</sub>, published (N)", .right = true, .wraps = true},
        {.heading = "RMS, decaying friction", .right = true, .wraps = true},
        {.heading = "RMS, constant friction", .right = true, .wraps = true},
        {.heading = "RMS, 1D from 3D", .right = true, .wraps = true},
        {.heading = "CPU of 1D over 3D (%)", .right = true, .wraps = true},
    };
    const struct wb_bundles *const campaign = results->campaign;
    struct wb_text caption = {0};
    wb_text_append(&caption,
                   "RMS of decaying and of constant friction: from the published curve, over its "
                   "largest force. The published curve is the 1D beam with the published "
                   "properties, under the same loading.");
    if (campaign->printed_rms[1] > 0.0)
        wb_text_append(&caption, " The paper's own 3D curves lie %g to %g from its tests.",
                       campaign->printed_rms[0], campaign->printed_rms[1]);
    wb_document_heading(document, 2, "facts", "What came out");
    struct wb_document_table *const table =
        wb_document_table(document, wb_text_string(&caption), 7, columns);
    document->failed |= caption.failed;
    wb_text_release(&caption);
    for (int i = 0; i < campaign->n_bundles; i++)
        put_fact(document, table, results, i);
}

void wb_bundles_pages_summary(struct wb_document *document,
                              const struct wb_bundles_results *results)
{
    wb_document_heading(document, 1, "summary", "Summary");
    wb_document_notice(
        document, WB_TONE_ORIGIN,
        "<b>Simulations.</b> Everything in this report is computed: bundles of wires "
        "with contact, friction and tape in explicit 3D, and 1D beams. No bundle was "
        "tested.");
    put_missing(document, results);
    put_limits(document, results);
    put_facts(document, results);
}

/* --- cost --- */

static void put_cost(struct wb_document *document, struct wb_document_table *table,
                     const struct wb_bundles_results *results, int index)
{
    const struct wb_bundles_bundle *const bundle = &results->campaign->bundles[index];
    const struct wb_bundles_result *const run = wb_bundles_results_usable(results, bundle->dynamic);
    const struct wb_bundles_result *const rod = &results->rods[index];
    const double none = (double)NAN, cost = wb_bundles_results_cost(results, index);
    const double limit = results->campaign->limits.cost;
    const double rod_cpu = rod->state == WB_BUNDLES_USABLE ? rod->numbers.cpu_s : none;
    struct wb_pages_row row = {.n = 0};
    wb_pages_cell_plain(&row, WB_TONE_PLAIN, bundle->label);
    wb_pages_cell_number(&row, run ? run->numbers.elements : none, 0);
    wb_pages_cell_number(&row, run ? run->numbers.shells : none, 0);
    wb_pages_cell_number(&row, run ? run->numbers.steps / 1e3 : none, 0);
    wb_pages_cell_number(&row, run ? run->numbers.ns : none, 1);
    wb_pages_cell_number(&row, run ? run->numbers.cpu_s : none, 1);
    wb_pages_cell_number(&row, rod_cpu, 3);
    if (limit > 0.0 && isfinite(cost))
        wb_pages_cell(&row, cost <= limit ? WB_TONE_GOOD : WB_TONE_WARNING, "%.3f",
                      cost / WB_PERCENT);
    else
        wb_pages_cell_number(&row, cost / WB_PERCENT, 3);
    wb_pages_put_row(document, table, false, &row);
}

void wb_bundles_pages_cost(struct wb_document *document, const struct wb_bundles_results *results)
{
    static const struct wb_document_column columns[] = {
        {"Bundle"},
        {.heading = "Hexahedra", .right = true},
        {.heading = "Shells", .right = true},
        {.heading = "Steps (10<sup>3</sup>)", .right = true, .wraps = true},
        {.heading = "ns per element-step", .right = true, .wraps = true},
        {.heading = "CPU of 3D (s)", .right = true, .wraps = true},
        {.heading = "CPU of 1D (s)", .right = true, .wraps = true},
        {.heading = "1D over 3D (%)", .right = true, .wraps = true},
    };
    const struct wb_bundles *const campaign = results->campaign;
    struct wb_text caption = {0};
    wb_text_append(&caption, "CPU seconds are those that each simulation stored when it was made, "
                             "on the machine that made it.");
    if (campaign->printed_cost > 0.0)
        wb_text_append(&caption, " The paper: 1D costs below %g %% of 3D.",
                       campaign->printed_cost / WB_PERCENT);
    wb_document_heading(document, 1, "cost", "Cost");
    struct wb_document_table *const table =
        wb_document_table(document, wb_text_string(&caption), 8, columns);
    document->failed |= caption.failed;
    wb_text_release(&caption);
    for (int i = 0; i < campaign->n_bundles; i++)
        put_cost(document, table, results, i);
}

/* --- runs --- */

/* In percent, as short as the column. */
static void put_ratio(struct wb_pages_row *row, double value, double limit)
{
    const double percent = value / WB_PERCENT;
    enum wb_document_tone tone = WB_TONE_PLAIN;
    if (limit > 0.0)
        tone = value <= limit ? WB_TONE_GOOD : WB_TONE_WARNING;
    if (isfinite(value) && percent < 0.005)
        wb_pages_cell(row, tone, "&lt; 0.01");
    else if (isfinite(value))
        wb_pages_cell(row, tone, "%.*f", percent < 1.0 ? 2 : percent < 10.0 ? 1 : 0, percent);
    else
        wb_pages_cell_number(row, value, 0);
}

static void put_run(struct wb_document *document, struct wb_document_table *table,
                    const struct wb_bundles_results *results, int index)
{
    const struct wb_bundles_run *const wanted = &results->campaign->runs[index];
    const struct wb_bundles_limits *const limits = &results->campaign->limits;
    const struct wb_bundles_result *const run = wb_bundles_results_usable(results, index);
    const struct wb_bundle_interface *const interface = &wanted->model->interface;
    const double none = (double)NAN;
    struct wb_pages_row row = {.n = 0};
    wb_pages_cell_plain(&row, WB_TONE_PLAIN, wanted->name);
    if (interface->friction_kinetic != interface->friction_static)
        wb_pages_cell(&row, WB_TONE_PLAIN, "%g\xe2\x80\x93%g", interface->friction_static,
                      interface->friction_kinetic);
    else
        wb_pages_cell(&row, WB_TONE_PLAIN, "%g", interface->friction_static);
    wb_pages_cell(&row, WB_TONE_PLAIN, "%g", interface->normal_stiffness / 1e9);
    wb_pages_cell(&row, WB_TONE_PLAIN, "%s", wb_bundles_pages_loading(wanted));
    wb_pages_cell_number(&row, run ? run->numbers.duration : none, 2);
    wb_pages_cell_number(&row, run ? run->curve.max_force : none, 3);
    wb_pages_cell_number(&row, run && run->published ? run->rms : none, 4);
    put_ratio(&row, run ? run->numbers.kinetic : none, limits->kinetic);
    put_ratio(&row, run ? run->numbers.artificial : none, limits->artificial);
    put_ratio(&row, run ? run->numbers.imbalance : none, limits->imbalance);
    wb_pages_put_row(document, table, false, &row);
}

void wb_bundles_pages_put_runs(struct wb_document *document,
                               const struct wb_bundles_results *results, int n, const int *runs,
                               bool explained)
{
    static const char caption[] =
        "RMS: from the published curve under the same loading, over its largest force. "
        "<i>E</i><sub>kin</sub>, <i>E</i><sub>art</sub>: kinetic and artificial energy over "
        "internal energy, at most from 2 mm on; <i>E</i><sub>off</sub>: imbalance of energy over "
        "the external work. Time: of the model.";
    static const struct wb_document_column columns[] = {
        {"Run"},
        {.heading = "Friction", .right = true},
        {.heading = "<i>K</i><sub>cc</sub> (N/mm<sup>3</sup>)", .right = true, .wraps = true},
        {"Loading"},
        {.heading = "Time (s)", .right = true, .wraps = true},
        {.heading = "<i>F</i><sub>max</sub> (N)", .right = true, .wraps = true},
        {.heading = "RMS", .right = true},
        {.heading = "<i>E</i><sub>kin</sub> (%)", .right = true, .wraps = true},
        {.heading = "<i>E</i><sub>art</sub> (%)", .right = true, .wraps = true},
        {.heading = "<i>E</i><sub>off</sub> (%)", .right = true, .wraps = true},
    };
    struct wb_document_table *const table =
        wb_document_table(document, explained ? caption : NULL, 10, columns);
    for (int i = 0; i < n; i++)
        put_run(document, table, results, runs[i]);
}

void wb_bundles_pages_runs(struct wb_document *document, const struct wb_bundles_results *results)
{
    int all[WB_BUNDLES_RUNS], n_beyond = 0;
    const int n = results->campaign->n_runs;
    struct wb_text text = {0};
    for (int i = 0; i < n; i++) {
        const struct wb_bundles_result *const run = wb_bundles_results_usable(results, i);
        all[i] = i;
        if (run && run->beyond)
            wb_text_append(&text, "%s%s (%.1f %%)", n_beyond++ > 0 ? ", " : "",
                           results->campaign->runs[i].name, run->numbers.strain / WB_PERCENT);
    }
    wb_document_heading(document, 1, "runs", "All runs");
    wb_bundles_pages_put_runs(document, results, n, all, true);
    if (n_beyond > 0) {
        struct wb_text note = {0};
        wb_text_append(&note, "Strains went beyond what the elements' logarithm is made for in ");
        wb_text_append_escaped(&note, wb_text_string(&text));
        wb_text_append(&note, ".");
        wb_document_notice(document, WB_TONE_WARNING, wb_text_string(&note));
        wb_text_release(&note);
    }
    wb_text_release(&text);
}

/* --- provenance --- */

static void put_dataset(struct wb_document *document, struct wb_document_table *table,
                        const struct wb_bundles_dataset *wanted,
                        const struct wb_bundles_result *result)
{
    struct wb_pages_row row = {.n = 0};
    if (result->state == WB_BUNDLES_NOT_WANTED)
        return;
    wb_pages_cell_plain(&row, WB_TONE_PLAIN, wanted->name);
    if (result->state == WB_BUNDLES_USABLE)
        wb_pages_cell_plain(&row, WB_TONE_PLAIN, result->revision);
    else
        wb_pages_cell(&row, WB_TONE_WARNING, "not used");
    wb_pages_cell_plain(&row, WB_TONE_PLAIN, result->sha256);
    wb_pages_put_row(document, table, false, &row);
}

static void put_datasets(struct wb_document *document, const struct wb_bundles_results *results)
{
    static const struct wb_document_column columns[] = {
        {.heading = "Dataset", .wraps = true},
        {"Revision"},
        {.heading = "SHA-256 of force_deflection.csv", .monospace = true},
    };
    const struct wb_bundles *const campaign = results->campaign;
    wb_document_heading(document, 2, "datasets", "Datasets");
    struct wb_document_table *const table =
        wb_document_table(document, "Revision: of the program that made it.", 3, columns);
    for (int i = 0; i < campaign->n_runs; i++)
        put_dataset(document, table, &campaign->runs[i].dataset, &results->runs[i]);
    for (int i = 0; i < campaign->n_bundles; i++)
        put_dataset(document, table, &campaign->bundles[i].rod, &results->rods[i]);
}

static void put_models(struct wb_document *document, const struct wb_bundles *campaign)
{
    static const struct wb_document_column columns[] = {
        {"Bundle"},
        {.heading = "Mesh"},
        {.heading = "SHA-256 with its wires and materials", .monospace = true},
    };
    wb_document_heading(document, 2, "models", "Bundles");
    struct wb_document_table *const table = wb_document_table(document, NULL, 3, columns);
    for (int i = 0; i < campaign->n_bundles; i++) {
        const struct wb_bundles_run *const run = &campaign->runs[campaign->bundles[i].dynamic];
        struct wb_pages_row row = {.n = 0};
        wb_pages_cell_plain(&row, WB_TONE_PLAIN, run->model_name);
        wb_pages_cell_plain(&row, WB_TONE_PLAIN, run->mesh->name);
        wb_pages_cell_plain(&row, WB_TONE_PLAIN, run->model->sha256);
        wb_pages_put_row(document, table, false, &row);
    }
}

void wb_bundles_pages_provenance(struct wb_document *document,
                                 const struct wb_bundles_results *results)
{
    const struct wb_bundles *const campaign = results->campaign;
    wb_pages_put_origin(document, campaign->name, campaign->sha256, campaign->notes, "datasets");
    put_models(document, campaign);
    put_datasets(document, results);
}

/* --- all of it --- */

void wb_bundles_pages_build(struct wb_document *document, const struct wb_bundles_results *results,
                            const struct wb_bundles_figures *figures)
{
    char subtitle[300], footer[300];
    snprintf(footer, sizeof footer, "wirebench %s, revision %s \xc2\xb7 simulations, no tests",
             wb_version(), wb_version_revision());
    snprintf(subtitle, sizeof subtitle, "%d of %d simulations \xc2\xb7 wirebench %s, revision %s",
             results->n_usable, results->n_wanted, wb_version(), wb_version_revision());
    wb_document_init(document, "Simulation report", results->campaign->title, subtitle, footer, "");
    wb_bundles_pages_summary(document, results);
    wb_bundles_pages_sections(document, results, figures);
    wb_bundles_pages_studies(document, results, figures);
    wb_bundles_pages_groups(document, results, figures);
    wb_bundles_pages_fit(document, results, figures);
    wb_bundles_pages_cost(document, results);
    wb_bundles_pages_runs(document, results);
    wb_bundles_pages_provenance(document, results);
}
