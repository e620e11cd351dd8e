/* The study itself: sections, friction and cohesion, forces and energies, 1D properties. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/report/bundles/bundles_pages.h"
#include "analysis/report/pages_private.h"
#include "base/text.h"
#include "base/units.h"

static const double n_mm2 = 1e-6;                     /* N m2 of one N mm2 */
static const int property_decimals[4] = {0, 2, 1, 3}; /* E, sigma_Y, K, n */

static void put_figure(struct wb_document *document, const struct wb_figure *figure,
                       struct wb_text *caption)
{
    if (figure)
        wb_document_figures(document, figure, wb_text_string(caption), NULL, NULL);
    document->failed |= caption->failed;
    wb_text_release(caption);
}

/* "7 wires, 12 wires and 19 wires", escaped. */
static void append_labels(struct wb_text *text, const struct wb_bundles *campaign,
                          const struct wb_bundles_group *group)
{
    for (int i = 0; i < group->n; i++) {
        if (i > 0)
            wb_text_append(text, i + 1 < group->n ? ", " : " and ");
        wb_text_append_escaped(text, campaign->bundles[group->first + i].label);
    }
}

/* --- sections and Table 4 --- */

static void put_section(struct wb_document *document, struct wb_document_table *table,
                        const struct wb_bundles_bundle *bundle, const struct wb_bundles_run *run)
{
    const struct wb_bundle_model *const m = run->model;
    const struct wb_bundle_rigidity rigidity = wb_bundle_model_rigidity(m);
    const double own = wb_bundle_model_diameter(m), none = (double)NAN;
    const double printed = m->has_published ? m->published.outer_diameter : none;
    struct wb_pages_row row = {.n = 0};
    wb_pages_cell_plain(&row, WB_TONE_PLAIN, bundle->label);
    wb_pages_cell(&row, WB_TONE_PLAIN, "%d", m->packing.n);
    wb_pages_cell_plain(&row, WB_TONE_PLAIN, wb_bundle_model_arrangement(m));
    wb_pages_cell_number(&row, own / WB_MM, 2);
    wb_pages_cell_number(&row, printed / WB_MM, 2);
    wb_pages_cell_number(
        &row, wb_bundle_model_density(m, m->has_published ? printed : own) / WB_G_PER_CM3, 2);
    wb_pages_cell_number(&row, m->has_published ? m->published.density / WB_G_PER_CM3 : none, 2);
    wb_pages_cell_number(&row, rigidity.sliding[0] / n_mm2, 0);
    wb_pages_cell_number(&row, rigidity.bonded[0] / n_mm2, 0);
    wb_pages_put_row(document, table, false, &row);
}

void wb_bundles_pages_sections(struct wb_document *document,
                               const struct wb_bundles_results *results,
                               const struct wb_bundles_figures *figures)
{
    static const struct wb_document_column columns[] = {
        {"Bundle"},
        {.heading = "Wires", .right = true},
        {"Packing"},
        {.heading = "<i>d</i><sub>o</sub>, packed (mm)", .right = true, .wraps = true},
        {.heading = "<i>d</i><sub>o</sub>, printed (mm)", .right = true, .wraps = true},
        {.heading = "Density (g/cm<sup>3</sup>)", .right = true, .wraps = true},
        {.heading = "Density, printed", .right = true, .wraps = true},
        {.heading = "<i>EI</i>, sliding (N mm<sup>2</sup>)", .right = true, .wraps = true},
        {.heading = "<i>EI</i>, bonded (N mm<sup>2</sup>)", .right = true, .wraps = true},
    };
    const struct wb_bundles *const campaign = results->campaign;
    wb_document_heading(document, 1, "bundles", "Bundles");
    struct wb_document_table *const table = wb_document_table(
        document,
        "Packed: round wires and tape as they are packed here. Printed: Table 4 of the paper. "
        "Density: eq. 30, over the printed diameter. <i>EI</i>: elastic bounds of wires that slide "
        "freely and of wires that do not slide at all, with the tape.",
        9, columns);
    for (int i = 0; i < campaign->n_bundles; i++)
        put_section(document, table, &campaign->bundles[i],
                    &campaign->runs[campaign->bundles[i].dynamic]);
    for (int i = 0; i < campaign->n_groups; i++) {
        const struct wb_bundles_group *const group = &campaign->groups[i];
        struct wb_text caption = {0};
        char place[48];
        wb_text_append(&caption, "Sections%s of ",
                       wb_bundles_pages_figure(place, group->figures[WB_BUNDLES_SECTION]));
        append_labels(&caption, campaign, group);
        wb_text_append(&caption, ", with the lines of the mesh and the homogenised cylinder.");
        put_figure(document, figures->groups[i][WB_BUNDLES_SECTION], &caption);
    }
}

/* --- studies --- */

void wb_bundles_pages_studies(struct wb_document *document,
                              const struct wb_bundles_results *results,
                              const struct wb_bundles_figures *figures)
{
    const struct wb_bundles *const campaign = results->campaign;
    if (campaign->n_studies == 0)
        return;
    wb_document_heading(document, 1, "studies", "Friction, cohesion, loading");
    for (int i = 0; 2 * i < campaign->n_studies; i++) {
        struct wb_text caption = {0};
        wb_text_append(&caption, "Studies of ");
        for (int k = 2 * i; k < 2 * i + 2 && k < campaign->n_studies; k++) {
            const struct wb_bundles_study *const study = &campaign->studies[k];
            wb_text_append(&caption, "%s<i>", k > 2 * i ? " and " : "");
            wb_text_append_escaped(&caption, study->title);
            wb_text_append(&caption, "</i> (");
            wb_text_append_escaped(&caption, campaign->runs[study->runs[0]].model->title);
            wb_text_append(&caption, ")");
        }
        wb_text_append(&caption,
                       "%s. Published: the 1D beam with the published properties, under "
                       "the first run's loading.",
                       i == 0 && campaign->printed_source[0] ? ", after the paper's Fig. 18" : "");
        put_figure(document, figures->studies[i], &caption);
    }
    for (int i = 0; i < campaign->n_studies; i++) {
        char anchor[32];
        snprintf(anchor, sizeof anchor, "study-%d", i + 1);
        wb_document_heading(document, 2, anchor, campaign->studies[i].title);
        wb_bundles_pages_put_runs(document, results, campaign->studies[i].n,
                                  campaign->studies[i].runs, i == campaign->n_studies - 1);
    }
}

/* --- groups --- */

static void put_forces(struct wb_document *document, const struct wb_bundles *campaign,
                       const struct wb_bundles_group *group, const struct wb_figure *figure)
{
    struct wb_text caption = {0};
    char place[48];
    const struct wb_bundles_run *const run =
        &campaign->runs[campaign->bundles[group->first].dynamic];
    wb_text_append(&caption,
                   "Force over deflection%s, simulated with decaying and with constant friction "
                   "(%s), and the published curve.",
                   wb_bundles_pages_figure(place, group->figures[WB_BUNDLES_FORCE]),
                   wb_bundles_pages_loading(run));
    if (group->figures[WB_BUNDLES_FORCE][0])
        wb_text_append(&caption, " The paper's figure has tests in the published curve's place; "
                                 "they are not at hand.");
    put_figure(document, figure, &caption);
}

static void put_shapes(struct wb_document *document, const struct wb_bundles_results *results,
                       const struct wb_bundles_group *group, struct wb_figure *const shapes[])
{
    for (int i = group->first; i < group->first + group->n; i++) {
        const struct wb_bundles_bundle *const bundle = &results->campaign->bundles[i];
        const struct wb_bundles_result *const run =
            wb_bundles_results_usable(results, bundle->dynamic);
        struct wb_text caption = {0};
        char place[48];
        if (!shapes[i])
            continue;
        wb_text_append_escaped(&caption, bundle->label);
        wb_text_append(&caption,
                       " bent by %.0f mm%s: von Mises stress of the wires, with the tape drawn as "
                       "glass, from the side and its ends from nearby.",
                       run->curve.max_deflection / WB_MM,
                       wb_bundles_pages_figure(place, group->figures[WB_BUNDLES_SHAPE]));
        put_figure(document, shapes[i], &caption);
    }
}

static void put_group(struct wb_document *document, const struct wb_bundles_results *results,
                      int index, const struct wb_bundles_figures *all)
{
    const struct wb_bundles *const campaign = results->campaign;
    struct wb_figure *const *const figures = all->groups[index];
    const struct wb_bundles_group *const group = &campaign->groups[index];
    struct wb_text caption = {0};
    char anchor[32], place[48];
    snprintf(anchor, sizeof anchor, "group-%d", index + 1);
    wb_document_heading(document, 1, anchor, group->label);
    if (!figures[WB_BUNDLES_FORCE])
        wb_document_paragraph(document, "None of their datasets is there.");
    put_forces(document, campaign, group, figures[WB_BUNDLES_FORCE]);
    wb_text_append(&caption,
                   "Distance of the simulated curves from the published ones%s, over the published "
                   "curve's largest force <i>F</i><sub>max</sub>.",
                   wb_bundles_pages_figure(place, group->figures[WB_BUNDLES_ERROR]));
    put_figure(document, figures[WB_BUNDLES_ERROR], &caption);
    put_shapes(document, results, group, all->shapes);
    wb_text_append(&caption,
                   "Energies%s over the model's own time, with decaying friction. Internal: stored "
                   "and plastic, in wires, tape, contact and cohesion.",
                   wb_bundles_pages_figure(place, group->figures[WB_BUNDLES_ENERGY]));
    put_figure(document, figures[WB_BUNDLES_ENERGY], &caption);
}

void wb_bundles_pages_groups(struct wb_document *document, const struct wb_bundles_results *results,
                             const struct wb_bundles_figures *figures)
{
    for (int i = 0; i < results->campaign->n_groups; i++)
        put_group(document, results, i, figures);
}

/* --- 1D properties --- */

static void put_properties(struct wb_document *document, struct wb_document_table *table,
                           const char *label, const char *of, const struct wb_material *material,
                           double diameter)
{
    struct wb_pages_row row = {.n = 0};
    wb_pages_cell_plain(&row, WB_TONE_PLAIN, label);
    wb_pages_cell(&row, WB_TONE_PLAIN, "%s", of);
    wb_pages_cell_number(&row, diameter / WB_MM, 2);
    for (int k = 0; k < 4; k++)
        wb_pages_cell_number(&row,
                             material ? wb_pages_value(material, k) / wb_pages_properties[k].factor
                                      : (double)NAN,
                             property_decimals[k]);
    wb_pages_cell_number(
        &row,
        material ? wb_bundles_results_rigidity(material->youngs_modulus, diameter) / n_mm2
                 : (double)NAN,
        0);
    wb_pages_put_row(document, table, label[0] != '\0', &row);
}

static void put_bundle(struct wb_document *document, struct wb_document_table *table,
                       const struct wb_bundles_results *results, int index)
{
    const struct wb_bundles_bundle *const bundle = &results->campaign->bundles[index];
    const struct wb_bundles_run *const run = &results->campaign->runs[bundle->dynamic];
    const struct wb_bundles_result *const result =
        wb_bundles_results_usable(results, bundle->dynamic);
    const struct wb_wire *const published = wb_bundles_published(run);
    const struct wb_bundles_fit *const fit = wb_bundles_results_fit(results, index);
    put_properties(document, table, bundle->label, "here", fit ? &fit->result.material : NULL,
                   result ? result->dataset.info.outer_diameter : (double)NAN);
    if (published)
        put_properties(document, table, "", "paper", &published->material,
                       published->outer_diameter);
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
        (struct wb_document_column){.heading = "<i>EI</i> (N mm<sup>2</sup>)", .right = true};
    wb_document_heading(document, 2, "properties", "Properties of the 1D beam");
    struct wb_document_table *const table = wb_document_table(
        document,
        "Here: calibrated against each simulated 3D curve with decaying friction, with the printed "
        "diameter. Paper: Tables 4 and 5. <i>E</i> goes with the diameter's inverse fourth power, "
        "<i>EI</i> does not depend on it.",
        8, columns);
    for (int i = 0; i < results->campaign->n_bundles; i++)
        put_bundle(document, table, results, i);
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
        struct wb_pages_row row = {.n = 0};
        if (!fit)
            continue;
        wb_pages_cell_plain(&row, WB_TONE_PLAIN, bundle->label);
        wb_pages_cell_number(&row, fit->result.rms, 4);
        wb_pages_cell_number(&row, fit->result.max_error, 4);
        wb_pages_cell_number(&row,
                             published ? fit->rigidity / wb_bundles_results_rigidity(
                                                             published->material.youngs_modulus,
                                                             published->outer_diameter)
                                       : (double)NAN,
                             2);
        wb_pages_cell(&row, WB_TONE_PLAIN, "%d", fit->result.evaluations);
        wb_pages_cell_plain(&row, WB_TONE_PLAIN, wb_calibrate_end_text(fit->result.end));
        wb_pages_put_row(document, table, false, &row);
    }
}

static void put_remarks(struct wb_document *document, const struct wb_bundles_results *results)
{
    for (int i = 0; i < results->campaign->n_bundles; i++) {
        const struct wb_bundles_fit *const fit = wb_bundles_results_fit(results, i);
        const char *remarks[WB_CALIBRATE_MOST_REMARKS];
        const int n = fit ? wb_calibrate_remarks(&fit->result, remarks) : 0;
        for (int k = 0; k < n; k++) {
            char text[800], label[300], remark[400];
            snprintf(text, sizeof text, "<b>%s</b>: %s.",
                     wb_pages_escape(label, sizeof label, results->campaign->bundles[i].label),
                     wb_pages_escape(remark, sizeof remark, remarks[k]));
            wb_document_item(document, WB_TONE_PLAIN, text);
        }
    }
}

void wb_bundles_pages_fit(struct wb_document *document, const struct wb_bundles_results *results,
                          const struct wb_bundles_figures *figures)
{
    const struct wb_bundles *const campaign = results->campaign;
    struct wb_text caption = {0};
    wb_document_heading(document, 1, "one-dimensional", "Effective 1D properties");
    wb_text_append(&caption,
                   "Simulated force over deflection in 3D (broad) and of the fitted 1D "
                   "beam (dashed)%s.",
                   campaign->printed_source[0] ? ", after the paper's Fig. 26" : "");
    if (campaign->inset >= 0) {
        wb_text_append(&caption, " Inset: bent axes of ");
        wb_text_append_escaped(&caption, campaign->bundles[campaign->inset].label);
        wb_text_append(&caption, " at a third, two thirds and all of the deflection.");
    }
    put_figure(document, figures->fit, &caption);
    put_table(document, results);
    put_quality(document, results);
    put_remarks(document, results);
}
