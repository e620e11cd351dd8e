/* The report of bundles, in order: summary, bundles, studies, groups, section model, 1D properties,
 * cost, runs, provenance. */
#include "analysis/report/bundles/bundles_kind.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/report/pages.h"
#include "analysis/report/simulation_pages.h"
#include "base/text.h"
#include "base/units.h"

/* --- fits that failed --- */

static void put_unfitted(struct wb_document *document, const struct wb_bundles_results *results)
{
    for (int i = 0; i < results->campaign->n_bundles; i++) {
        const struct wb_bundles_fit *const fit = &results->fits[i];
        if (fit->state == WB_SIMULATION_REFUSED)
            wb_pages_item(document, WB_TONE_WARNING, "<b>", results->campaign->bundles[i].label,
                          "</b>, no fitted beam: ", wb_text_string(&fit->problem));
    }
}

/* --- forces, errors and cost of all bundles --- */

static void put_fact(struct wb_document_table *table, const struct wb_bundles_results *results,
                     int index)
{
    const struct wb_bundles_bundle *const bundle = &results->campaign->bundles[index];
    const struct wb_bundles_result *const dynamic = wb_bundles_results_dynamic(results, index);
    const struct wb_bundles_fit *const fit = wb_bundles_results_fit(results, index);
    const double none = (double)NAN;
    wb_document_row(table, false);
    wb_pages_cell_plain(table, WB_TONE_PLAIN, bundle->label);
    wb_pages_cell_number(table, dynamic ? dynamic->curve.max_force : none, 3);
    wb_pages_cell_number(table, dynamic && dynamic->published ? dynamic->published_max : none, 3);
    wb_pages_cell_number(table, wb_bundles_results_rms(results, bundle->dynamic), 4);
    wb_pages_cell_number(table, wb_bundles_results_rms(results, bundle->constant), 4);
    wb_pages_cell_number(table, fit ? fit->result.rms : none, 4);
    wb_pages_cell_number(table, wb_bundles_results_cost(results, index) / WB_PERCENT, 3);
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
    wb_document_heading(document, 2, "facts", "Forces, errors and cost");
    struct wb_document_table *const table = wb_pages_start_table(document, &caption, 7, columns);
    for (int i = 0; i < campaign->n_bundles; i++)
        put_fact(table, results, i);
}

static void put_summary(struct wb_document *document, const struct wb_bundles_results *results,
                        const struct wb_figures *figures)
{
    struct wb_verdict verdicts[WB_BUNDLES_VERDICTS];
    const int n = wb_bundles_results_judge(results, verdicts);
    wb_bundles_found_put(document, results);
    wb_figures_put(figures, document, "found", 0);
    wb_simulation_pages_put_decisions(document, results->outcome.campaign, verdicts, n);
    wb_simulation_pages_put_missing(document, &results->outcome, wb_bundles_results_list, results);
    put_unfitted(document, results);
    put_facts(document, results);
}

/* --- a table of runs --- */

/* In percent, as short as the column. */
static void put_ratio(struct wb_document_table *table, double value, double limit)
{
    const double percent = value / WB_PERCENT;
    enum wb_document_tone tone = WB_TONE_PLAIN;
    if (limit > 0.0)
        tone = value <= limit ? WB_TONE_GOOD : WB_TONE_WARNING;
    if (isfinite(value) && percent < 0.005)
        wb_pages_cell(table, tone, "&lt; 0.01");
    else if (isfinite(value))
        wb_pages_cell(table, tone, "%.*f", percent < 1.0 ? 2 : percent < 10.0 ? 1 : 0, percent);
    else
        wb_pages_cell_number(table, value, 0);
}

static void put_run(struct wb_document_table *table, const struct wb_bundles_results *results,
                    int index)
{
    const struct wb_bundles_run *const wanted = &results->campaign->runs[index];
    const struct wb_bundles_limits *const limits = &results->campaign->limits;
    const struct wb_bundles_result *const run = wb_bundles_results_usable(results, index);
    const struct wb_bundle_interface *const interface = &wanted->model->interface;
    const double none = (double)NAN;
    wb_document_row(table, false);
    wb_pages_cell_plain(table, WB_TONE_PLAIN, wanted->name);
    if (interface->friction.mu_kinetic != interface->friction.mu_static)
        wb_pages_cell(table, WB_TONE_PLAIN, "%g\xe2\x80\x93%g", interface->friction.mu_static,
                      interface->friction.mu_kinetic);
    else
        wb_pages_cell(table, WB_TONE_PLAIN, "%g", interface->friction.mu_static);
    wb_pages_cell(table, WB_TONE_PLAIN, "%g", interface->normal_stiffness / 1e9);
    wb_pages_cell(table, WB_TONE_PLAIN, "%s", wb_bundles_loading(wanted));
    wb_pages_cell_number(table, run ? run->numbers.duration : none, 2);
    wb_pages_cell_number(table, run ? run->curve.max_force : none, 3);
    wb_pages_cell_number(table, wb_bundles_results_rms(results, index), 4);
    put_ratio(table, run ? run->numbers.kinetic : none, limits->kinetic);
    put_ratio(table, run ? run->numbers.artificial : none, limits->artificial);
    put_ratio(table, run ? run->numbers.imbalance : none, limits->imbalance);
}

static void put_runs(struct wb_document *document, const struct wb_bundles_results *results, int n,
                     const int *runs, bool explained)
{
    static const char caption[] =
        "RMS: from the published curve under the same loading, over its largest force. "
        "<i>E</i><sub>kin</sub>, <i>E</i><sub>art</sub>: kinetic and artificial energy over "
        "internal energy, at most from 2 mm on; <i>E</i><sub>off</sub>: imbalance of energy over "
        "the external work. Time: of the model.";
    static const struct wb_document_column columns[] = {
        {"Run"},
        {.heading = "Friction", .right = true},
        {.heading = "<i>K</i><sub>cc</sub> (N/mm\xc2\xb3)", .right = true, .wraps = true},
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
        put_run(table, results, runs[i]);
}

static const int property_decimals[4] = {0, 2, 1, 3}; /* E, sigma_Y, K, n */

/* --- sections and Table 4 --- */

static void put_section(struct wb_document_table *table, const struct wb_bundles_bundle *bundle,
                        const struct wb_bundles_run *run)
{
    const struct wb_bundle_model *const m = run->model;
    const struct wb_bundle_rigidity rigidity = wb_bundle_model_rigidity(m);
    const double own = wb_bundle_model_diameter(m), none = (double)NAN;
    const double printed = m->has_published ? m->published.outer_diameter : none;
    wb_document_row(table, false);
    wb_pages_cell_plain(table, WB_TONE_PLAIN, bundle->label);
    wb_pages_cell(table, WB_TONE_PLAIN, "%d", m->packing.n);
    wb_pages_cell_plain(table, WB_TONE_PLAIN, wb_bundle_model_arrangement(m));
    wb_pages_cell_number(table, own / WB_MM, 2);
    wb_pages_cell_number(table, printed / WB_MM, 2);
    wb_pages_cell_number(
        table, wb_bundle_model_density(m, m->has_published ? printed : own) / WB_G_PER_CM3, 2);
    wb_pages_cell_number(table, m->has_published ? m->published.density / WB_G_PER_CM3 : none, 2);
    wb_pages_cell_number(table, rigidity.sliding[0] / WB_NMM2, 0);
    wb_pages_cell_number(table, rigidity.bonded[0] / WB_NMM2, 0);
}

static void put_sections(struct wb_document *document, const struct wb_bundles_results *results,
                         const struct wb_figures *figures)
{
    static const struct wb_document_column columns[] = {
        {"Bundle"},
        {.heading = "Wires", .right = true},
        {"Packing"},
        {.heading = "<i>d</i><sub>o</sub>, packed (mm)", .right = true, .wraps = true},
        {.heading = "<i>d</i><sub>o</sub>, printed (mm)", .right = true, .wraps = true},
        {.heading = "Density (g/cm<sup>3</sup>)", .right = true, .wraps = true},
        {.heading = "Density, printed", .right = true, .wraps = true},
        {.heading = "<i>EI</i>, sliding (N\xc2\xa0mm\xc2\xb2)", .right = true, .wraps = true},
        {.heading = "<i>EI</i>, bonded (N\xc2\xa0mm\xc2\xb2)", .right = true, .wraps = true},
    };
    const struct wb_bundles *const campaign = results->campaign;
    wb_document_heading(document, 1, "bundles", "Bundles");
    struct wb_document_table *const table = wb_document_table(
        document,
        "Packed: round wires and tape in the packing of this report. Printed: Table 4 of the "
        "paper. Density: eq. 30, over the printed diameter. <i>EI</i>: elastic bounds with the "
        "tape, of wires that slide freely and of wires that are bonded.",
        9, columns);
    for (int i = 0; i < campaign->n_bundles; i++)
        put_section(table, &campaign->bundles[i], &campaign->runs[campaign->bundles[i].dynamic]);
    for (int i = 0; i < campaign->n_groups; i++)
        wb_figures_put(figures, document, "sections", i);
}

/* --- studies --- */

static void put_studies(struct wb_document *document, const struct wb_bundles_results *results,
                        const struct wb_figures *figures)
{
    const struct wb_bundles *const campaign = results->campaign;
    if (campaign->n_studies == 0)
        return;
    wb_document_heading(document, 1, "studies", "Friction, cohesion, loading");
    for (int i = 0; 2 * i < campaign->n_studies; i++)
        wb_figures_put(figures, document, "studies", i);
    for (int i = 0; i < campaign->n_studies; i++) {
        char anchor[32];
        snprintf(anchor, sizeof anchor, "study-%d", i + 1);
        wb_document_heading(document, 2, anchor, campaign->studies[i].title);
        put_runs(document, results, campaign->studies[i].n, campaign->studies[i].runs,
                 i == campaign->n_studies - 1);
    }
}

/* --- groups --- */

static void put_groups(struct wb_document *document, const struct wb_bundles_results *results,
                       const struct wb_figures *figures)
{
    for (int index = 0; index < results->campaign->n_groups; index++) {
        const struct wb_bundles_group *const group = &results->campaign->groups[index];
        char anchor[32];
        snprintf(anchor, sizeof anchor, "group-%d", index + 1);
        wb_document_heading(document, 1, anchor, group->label);
        if (!wb_bundles_results_any(results, group))
            wb_document_paragraph(document, "None of the datasets of this group could be used.");
        wb_figures_put(figures, document, "curves", index);
        for (int i = group->first; i < group->first + group->n; i++)
            wb_figures_put(figures, document, "shapes", i);
        wb_figures_put(figures, document, "energies", index);
    }
}

/* --- section model beside the explicit one --- */

static void put_section_model(struct wb_document_table *table,
                              const struct wb_bundles_results *results, int run)
{
    const struct wb_bundles_section *const section = wb_bundles_results_section(results, run);
    const struct wb_bundles_result *const explicit = wb_bundles_results_usable(results, run);
    const double none = (double)NAN;
    if (run < 0)
        return;
    wb_document_row(table, false);
    wb_pages_cell_plain(table, WB_TONE_PLAIN, results->campaign->runs[run].name);
    if (section)
        wb_pages_cell(table, WB_TONE_PLAIN, "%.3g%s", section->friction,
                      section->is_mean ? " (mean)" : "");
    else
        wb_pages_cell_number(table, none, 2);
    wb_pages_cell_number(table, explicit ? explicit->curve.max_force : none, 3);
    wb_pages_cell_number(table, section ? section->curve.max_force : none, 3);
    wb_pages_cell_number(table, section ? section->rms : none, 4);
    for (int i = 0; i < WB_SECTION_RUN_LENGTHS; i++)
        wb_pages_cell_number(table, section ? section->rigidity[i].rigidity / WB_NMM2 : none, 0);
    if (section && isfinite(section->loosens))
        wb_pages_cell(table, WB_TONE_WARNING, "%.3g mm", section->loosens / WB_MM);
    else
        wb_pages_cell_plain(table, WB_TONE_PLAIN, section ? "stays on" : "");
}

static void put_section_problem(struct wb_document *document,
                                const struct wb_bundles_results *results, int run)
{
    if (run >= 0 && results->sections[run].state == WB_SIMULATION_REFUSED)
        wb_pages_item(document, WB_TONE_PLAIN, "<b>", results->campaign->runs[run].name,
                      "</b>: ", wb_text_string(&results->sections[run].problem));
}

static void put_section_models(struct wb_document *document,
                               const struct wb_bundles_results *results,
                               const struct wb_figures *figures)
{
    static const struct wb_document_column columns[] = {
        {"Run"},
        {.heading = "Friction used", .right = true, .wraps = true},
        {.heading = "<i>F</i><sub>max</sub>, explicit (N)", .right = true, .wraps = true},
        {.heading = "<i>F</i><sub>max</sub>, section (N)", .right = true, .wraps = true},
        {.heading = "RMS", .right = true},
        {.heading = "<i>EI</i> at <i>L</i>/2 (N\xc2\xa0mm\xc2\xb2)", .right = true, .wraps = true},
        {.heading = "<i>EI</i> at <i>L</i> (N\xc2\xa0mm\xc2\xb2)", .right = true, .wraps = true},
        {.heading = "<i>EI</i> at 2 <i>L</i> (N\xc2\xa0mm\xc2\xb2)", .right = true, .wraps = true},
        {.heading = "Tape comes off at", .right = true, .wraps = true},
    };
    const struct wb_bundles *const campaign = results->campaign;
    wb_document_heading(document, 1, "section-model", "Section model beside the explicit one");
    wb_document_paragraph(
        document,
        "The section model takes a tenth of a second. Its wires have the rotation of the section "
        "in common and slip along their axes; the tape transfers shear between them. It is "
        "computed for this report. It is valid as long as the tape stays on the wires.");
    for (int i = 0; i < campaign->n_groups; i++)
        wb_figures_put(figures, document, "section-model", i);
    struct wb_document_table *const table = wb_document_table(
        document,
        "RMS: difference from the explicit curve, over its largest force. Friction: the static "
        "model has no rate and uses the geometric mean of a friction that decays. <i>EI</i>: of "
        "the elastic bundle as a beam of this length <i>L</i> and these ends, "
        "<i>F L</i><sup>3</sup>/3<i>\xce\xb4</i>; a short one also deforms in shear. Where a tape "
        "on "
        "a circle comes off the wires, the section model is too stiff.",
        9, columns);
    for (int i = 0; i < campaign->n_bundles; i++) {
        put_section_model(table, results, campaign->bundles[i].dynamic);
        put_section_model(table, results, campaign->bundles[i].constant);
    }
    for (int i = 0; i < campaign->n_bundles; i++) {
        put_section_problem(document, results, campaign->bundles[i].dynamic);
        put_section_problem(document, results, campaign->bundles[i].constant);
    }
}

/* --- 1D properties --- */

static void put_properties(struct wb_document_table *table, const char *label, const char *of,
                           const struct wb_material *material, double diameter)
{
    wb_document_row(table, label[0] != '\0');
    wb_pages_cell_plain(table, WB_TONE_PLAIN, label);
    wb_pages_cell(table, WB_TONE_PLAIN, "%s", of);
    wb_pages_cell_number(table, diameter / WB_MM, 2);
    for (int k = 0; k < 4; k++)
        wb_pages_cell_number(table,
                             material ? wb_pages_value(material, k) / wb_pages_properties[k].factor
                                      : (double)NAN,
                             property_decimals[k]);
    wb_pages_cell_number(
        table,
        material ? wb_bundles_results_rigidity(material->youngs_modulus, diameter) / WB_NMM2
                 : (double)NAN,
        0);
}

static void put_bundle(struct wb_document_table *table, const struct wb_bundles_results *results,
                       int index)
{
    const struct wb_bundles_bundle *const bundle = &results->campaign->bundles[index];
    const struct wb_bundles_run *const run = &results->campaign->runs[bundle->dynamic];
    const struct wb_bundles_result *const result = wb_bundles_results_dynamic(results, index);
    const struct wb_wire *const published = wb_bundles_published(run);
    const struct wb_bundles_fit *const fit = wb_bundles_results_fit(results, index);
    put_properties(table, bundle->label, "here", fit ? &fit->result.material : NULL,
                   result ? result->simulation.dataset.info.outer_diameter : (double)NAN);
    if (published)
        put_properties(table, "", "paper", &published->material, published->outer_diameter);
}

static void put_table(struct wb_document *document, const struct wb_bundles_results *results)
{
    static const char form[] = "%s (%s)";
    char headings[4][80];
    struct wb_document_column columns[8] = {
        {"Bundle"}, {"Of"}, {.heading = "<i>d</i><sub>o</sub> (mm)", .right = true}};
    for (int k = 0; k < 4; k++) {
        const struct wb_pages_property *const p = &wb_pages_properties[k];
        snprintf(headings[k], sizeof headings[k], strcmp(p->unit, "1") ? form : "%s", p->symbol,
                 p->unit);
        columns[3 + k] = (struct wb_document_column){.heading = headings[k], .right = true};
    }
    columns[7] =
        (struct wb_document_column){.heading = "<i>EI</i> (N\xc2\xa0mm\xc2\xb2)", .right = true};
    wb_document_heading(document, 2, "properties", "Properties of the 1D beam");
    struct wb_document_table *const table = wb_document_table(
        document,
        "Here: calibrated against each simulated 3D curve with decaying friction, with the printed "
        "diameter. Paper: Tables 4 and 5. <i>E</i> goes with the diameter's inverse fourth power, "
        "<i>EI</i> does not depend on it.",
        8, columns);
    for (int i = 0; i < results->campaign->n_bundles; i++)
        put_bundle(table, results, i);
}

static void put_quality(struct wb_document *document, const struct wb_bundles_results *results)
{
    static const struct wb_document_column columns[] = {
        {"Bundle"},
        {.heading = "RMS, 1D from 3D", .right = true, .wraps = true},
        {.heading = "Largest error", .right = true, .wraps = true},
        {.heading = "<i>EI</i>, here over paper", .right = true, .wraps = true},
        {.heading = "Beam runs of the fit", .right = true, .wraps = true},
        {.heading = "Stopped because", .wraps = true},
    };
    struct wb_document_table *const table = wb_document_table(
        document, "Errors are over the largest force of the 3D curve.", 6, columns);
    for (int i = 0; i < results->campaign->n_bundles; i++) {
        const struct wb_bundles_bundle *const bundle = &results->campaign->bundles[i];
        const struct wb_wire *const published =
            wb_bundles_published(&results->campaign->runs[bundle->dynamic]);
        const struct wb_bundles_fit *const fit = wb_bundles_results_fit(results, i);
        if (!fit)
            continue;
        wb_document_row(table, false);
        wb_pages_cell_plain(table, WB_TONE_PLAIN, bundle->label);
        wb_pages_cell_number(table, fit->result.rms, 4);
        wb_pages_cell_number(table, fit->result.max_error, 4);
        wb_pages_cell_number(table,
                             published ? fit->rigidity / wb_bundles_results_rigidity(
                                                             published->material.youngs_modulus,
                                                             published->outer_diameter)
                                       : (double)NAN,
                             2);
        wb_pages_cell(table, WB_TONE_PLAIN, "%d", fit->result.evaluations);
        wb_pages_cell_plain(table, WB_TONE_PLAIN, wb_calibrate_end_text(fit->result.end));
    }
}

static void put_remarks(struct wb_document *document, const struct wb_bundles_results *results)
{
    for (int i = 0; i < results->campaign->n_bundles; i++) {
        const struct wb_bundles_fit *const fit = wb_bundles_results_fit(results, i);
        const char *remarks[WB_CALIBRATE_MOST_REMARKS];
        const int n = fit ? wb_calibrate_remarks(&fit->result, remarks) : 0;
        for (int k = 0; k < n; k++) {
            struct wb_text text = {0};
            wb_text_append(&text, "<b>");
            wb_text_append_escaped(&text, results->campaign->bundles[i].label);
            wb_text_append(&text, "</b>: ");
            wb_pages_append_symbols(&text, remarks[k]);
            wb_text_append(&text, ".");
            wb_pages_put_text(document, WB_BLOCK_ITEM, WB_TONE_PLAIN, &text);
        }
    }
}

static void put_fit(struct wb_document *document, const struct wb_bundles_results *results,
                    const struct wb_figures *figures)
{
    wb_document_heading(document, 1, "one-dimensional", "Effective 1D properties");
    wb_figures_put(figures, document, "fit", 0);
    put_table(document, results);
    put_quality(document, results);
    put_remarks(document, results);
}

/* --- cost --- */

static void put_cost_of(struct wb_document_table *table, const struct wb_bundles_results *results,
                        int index)
{
    const struct wb_bundles_bundle *const bundle = &results->campaign->bundles[index];
    const struct wb_bundles_result *const run = wb_bundles_results_dynamic(results, index);
    const struct wb_bundles_result *const rod = &results->rods[index];
    const double none = (double)NAN, cost = wb_bundles_results_cost(results, index);
    const double limit = results->campaign->limits.cost;
    const double rod_cpu =
        rod->simulation.state == WB_SIMULATION_USABLE ? rod->simulation.cpu_s : none;
    wb_document_row(table, false);
    wb_pages_cell_plain(table, WB_TONE_PLAIN, bundle->label);
    wb_pages_cell_number(table, run ? run->numbers.elements : none, 0);
    wb_pages_cell_number(table, run ? run->numbers.shells : none, 0);
    wb_pages_cell_number(table, run ? run->numbers.steps / 1e3 : none, 0);
    wb_pages_cell_number(table, run ? run->numbers.ns : none, 1);
    wb_pages_cell_number(table, run ? run->simulation.cpu_s : none, 1);
    wb_pages_cell_number(table, rod_cpu, 3);
    wb_pages_cell_judged(table, cost / WB_PERCENT, 3, limit > 0.0, cost <= limit);
}

static void put_cost(struct wb_document *document, const struct wb_bundles_results *results)
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
    struct wb_document_table *const table = wb_pages_start_table(document, &caption, 8, columns);
    for (int i = 0; i < campaign->n_bundles; i++)
        put_cost_of(table, results, i);
}

/* --- all runs --- */

static void put_all_runs(struct wb_document *document, const struct wb_bundles_results *results)
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
    put_runs(document, results, n, all, true);
    if (n_beyond > 0) {
        struct wb_text note = {0};
        wb_text_append(&note, "The largest strain is beyond the range in which the elements' "
                              "logarithm is accurate in ");
        wb_text_append_escaped(&note, wb_text_string(&text));
        wb_text_append(&note, ".");
        wb_pages_put_text(document, WB_BLOCK_NOTICE, WB_TONE_WARNING, &note);
    }
    wb_text_release(&text);
}

/* --- provenance --- */

static void put_models(struct wb_document *document, const struct wb_bundles *campaign)
{
    static const struct wb_document_column columns[] = {
        {"Bundle"},
        {.heading = "Mesh"},
        {.heading = "SHA-256 of all inputs, first 16 digits", .monospace = true},
    };
    wb_document_heading(document, 2, "models", "Bundles");
    struct wb_document_table *const table = wb_document_table(document, NULL, 3, columns);
    for (int i = 0; i < campaign->n_bundles; i++) {
        const struct wb_bundles_run *const run = &campaign->runs[campaign->bundles[i].dynamic];
        wb_document_row(table, false);
        wb_pages_cell_plain(table, WB_TONE_PLAIN, run->model_name);
        wb_pages_cell_plain(table, WB_TONE_PLAIN, run->mesh->name);
        wb_pages_cell_checksum(table, run->dataset.inputs_sha256);
    }
}

static void put_provenance(struct wb_document *document, const struct wb_bundles_results *results)
{
    const struct wb_bundles *const campaign = results->campaign;
    wb_pages_put_origin(document, &campaign->head, "datasets");
    put_models(document, campaign);
    wb_simulation_pages_put_datasets(document, wb_bundles_results_list, results);
}

/* --- all of it --- */

void wb_bundles_pages_build(struct wb_document *document, const void *context,
                            const struct wb_figures *figures)
{
    const struct wb_bundles_results *const results = context;
    wb_simulation_pages_start(document, &results->outcome);
    put_summary(document, results, figures);
    put_sections(document, results, figures);
    put_studies(document, results, figures);
    put_groups(document, results, figures);
    put_section_models(document, results, figures);
    put_fit(document, results, figures);
    put_cost(document, results);
    put_all_runs(document, results);
    put_provenance(document, results);
}
