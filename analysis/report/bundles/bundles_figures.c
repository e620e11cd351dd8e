#include "analysis/report/bundles/bundles_kind.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/calibration/properties/properties.h"
#include "analysis/report/draw/figures_surface.h"
#include "analysis/report/pages.h"
#include "analysis/report/pdf.h"
#include "analysis/validation/validate.h"
#include "base/memory.h"
#include "base/text.h"
#include "base/units.h"

static const double millijoule = 1e-3;
static const double panel_height = 190.0;

enum {
    LABEL = 400 /* bytes of a bundle's label, escaped */
};

/* --- lines --- */

/* They lie on the published curve. */
static const struct wb_figure_style dynamic_style = {.colour = WB_PALETTE_INK, .width = 1.3};
static const struct wb_figure_style constant_style = {
    .colour = {0.835, 0.369, 0.0, 1.0}, .width = 1.2, .dash = WB_DASH_DASHED};

static void add_run(struct wb_panel *panel, const char *label, const struct wb_bundles_result *run,
                    const struct wb_figure_style *style)
{
    if (run)
        wb_figures_add_curve(panel, label, &run->curve, run->curve.force, 1.0, style);
}

static void add_published(struct wb_panel *panel, const char *label,
                          const struct wb_bundles_result *run)
{
    if (run && run->published)
        wb_figures_add_curve(panel, label, &run->curve, run->published, 1.0,
                             &wb_figures_reference_style);
}

static enum wb_status start(struct wb_figure **figure, const char *kind, int index, double height)
{
    char name[64];
    snprintf(name, sizeof name, index >= 0 ? "%s-%d" : "%s", kind, index + 1);
    return wb_figures_start_simulation(figure, name, height);
}

static struct wb_panel *add_force_panel(struct wb_figure *figure, const char *title, bool first)
{
    struct wb_panel *const panel = wb_figure_add_panel(figure);
    wb_figures_set_title(panel, title);
    wb_figure_set_axes(panel, "Deflection <i>\xce\xb4</i> (mm)", first ? "Force (N)" : "");
    wb_figure_set_y_range(panel, 0.0, (double)NAN);
    return panel;
}

/* --- sections --- */

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

static enum wb_status draw_sections(struct wb_figures_item *item)
{
    const struct wb_bundles_results *const results = item->results;
    const struct wb_bundles *const campaign = results->campaign;
    const struct wb_bundles_group *const group = &campaign->groups[item->index];
    const struct wb_bundle_model *models[WB_FIGURES_BUNDLE_MOST];
    const char *mesh = campaign->runs[campaign->bundles[group->first].dynamic].mesh->name;
    char name[64];
    snprintf(name, sizeof name, "sections-%d", item->index + 1);
    for (int i = 0; i < group->n; i++) {
        models[i] = campaign->runs[campaign->bundles[group->first + i].dynamic].model;
        if (!wb_bundle_model_mesh(models[i], mesh))
            mesh = "engineering";
    }
    char place[48];
    wb_text_append(&item->caption, "Sections%s of ",
                   wb_pages_paper_figure(place, group->figures[WB_BUNDLES_SECTION]));
    append_labels(&item->caption, results->campaign, group);
    wb_text_append(&item->caption, ", with the lines of the mesh and the homogenised cylinder.");
    return wb_figures_bundle_draw(&item->figure, name, group->n, models, mesh);
}

/* --- constant and decaying friction --- */

static void add_forces(struct wb_panel *panel, const struct wb_bundles_results *results,
                       const struct wb_bundles_bundle *bundle)
{
    const struct wb_bundles_result *const dynamic =
        wb_bundles_results_usable(results, bundle->dynamic);
    const struct wb_bundles_result *const constant =
        wb_bundles_results_usable(results, bundle->constant);
    const struct wb_bundles_result *const any = dynamic ? dynamic : constant;
    double largest = any->published ? fmax(any->published_max, 0.0) : 0.0;
    largest = fmax(largest, fmax(dynamic ? dynamic->curve.max_force : 0.0,
                                 constant ? constant->curve.max_force : 0.0));
    /* Room above for the legend, so that the panels are alike. */
    wb_figure_set_y_range(panel, 0.0, 1.25 * largest);
    add_published(panel, "published", any);
    add_run(panel, "constant", constant, &constant_style);
    add_run(panel, "decaying", dynamic, &dynamic_style);
}

static enum wb_status draw_forces(struct wb_figures_item *item)
{
    const struct wb_bundles_results *const results = item->results;
    const struct wb_bundles_group *const group = &results->campaign->groups[item->index];
    if (!wb_bundles_results_any(results, group))
        return WB_OK;
    WB_TRY(start(&item->figure, "forces", item->index, panel_height));
    char place[48];
    const struct wb_bundles_run *const run =
        &results->campaign->runs[results->campaign->bundles[group->first].dynamic];
    wb_text_append(&item->caption,
                   "Force over deflection%s, simulated with decaying and with constant friction "
                   "(%s), and the published curve.",
                   wb_pages_paper_figure(place, group->figures[WB_BUNDLES_FORCE]),
                   wb_bundles_loading(run));
    if (group->figures[WB_BUNDLES_FORCE][0])
        wb_text_append(&item->caption,
                       " The paper's figure has tests in the published curve's place; "
                       "they are not at hand.");
    for (int i = group->first, n = 0; i < group->first + group->n; i++) {
        const struct wb_bundles_bundle *const bundle = &results->campaign->bundles[i];
        if (wb_bundles_results_either(results, bundle))
            add_forces(add_force_panel(item->figure, bundle->label, n++ == 0), results, bundle);
    }
    return WB_OK;
}

/* --- errors --- */

static void add_error(struct wb_panel *panel, const char *bundle, const char *friction,
                      const struct wb_bundles_result *run, const struct wb_figure_style *style)
{
    char name[LABEL], label[LABEL + 100];
    if (!run || !run->published || !isfinite(run->rms))
        return;
    snprintf(label, sizeof label, "%s, %s: RMS %.4f", wb_pages_escape(name, sizeof name, bundle),
             friction, run->rms);
    wb_figures_add_curve(panel, label, &run->curve, run->error, 1.0, style);
}

static enum wb_status draw_errors(struct wb_figures_item *item)
{
    const struct wb_bundles_results *const results = item->results;
    const struct wb_bundles *const campaign = results->campaign;
    const struct wb_bundles_group *const group = &campaign->groups[item->index];
    bool any = false;
    for (int i = 0; i < group->n; i++)
        any |= wb_bundles_published(&campaign->runs[campaign->bundles[group->first + i].dynamic]) !=
               NULL;
    if (!any || !wb_bundles_results_any(results, group))
        return WB_OK;
    WB_TRY(start(&item->figure, "errors", item->index, 180.0));
    char place[48];
    wb_text_append(&item->caption,
                   "Distance of the simulated curves from the published ones%s, over the published "
                   "curve's largest force <i>F</i><sub>max</sub>.",
                   wb_pages_paper_figure(place, group->figures[WB_BUNDLES_ERROR]));
    struct wb_panel *const panel = wb_figure_add_panel(item->figure);
    wb_figure_set_axes(panel, "Deflection <i>\xce\xb4</i> (mm)", "Error / <i>F</i><sub>max</sub>");
    wb_figure_set_y_range(panel, 0.0, (double)NAN);
    for (int i = 0; i < group->n; i++) {
        const struct wb_bundles_bundle *const bundle = &campaign->bundles[group->first + i];
        const struct wb_figure_style solid = {.colour = wb_palette_wire(i), .width = 1.5};
        const struct wb_figure_style dashed = {
            .colour = wb_palette_wire(i), .width = 1.1, .dash = WB_DASH_DASHED};
        add_error(panel, bundle->label, "decaying",
                  wb_bundles_results_usable(results, bundle->dynamic), &solid);
        add_error(panel, bundle->label, "constant",
                  wb_bundles_results_usable(results, bundle->constant), &dashed);
    }
    return WB_OK;
}

/* --- energies --- */

enum {
    ENERGIES = 4
};

static void add_energies(struct wb_panel *panel, const struct wb_bundles_result *run)
{
    static const char *const labels[ENERGIES] = {"internal", "friction", "kinetic", "artificial"};
    const struct wb_figure_style styles[ENERGIES] = {
        {.colour = wb_palette_ink(), .width = 1.4},
        {.colour = wb_palette_wire(1), .width = 1.2, .dash = WB_DASH_DASHED},
        {.colour = wb_palette_wire(0), .width = 1.2},
        {.colour = wb_palette_wire(2), .width = 1.2, .dash = WB_DASH_DOTTED},
    };
    const size_t n = run ? (size_t)run->n_energies : 0;
    if (n == 0)
        return;
    double *const times = wb_memory_new((1 + ENERGIES) * n, sizeof *times), *const values =
                                                                                times + n;
    for (size_t i = 0; i < n; i++) {
        const struct wb_bundles_energy *const row = &run->energies[i];
        const double of[ENERGIES] = {row->internal, row->friction, row->kinetic, row->artificial};
        times[i] = row->time;
        for (size_t kind = 0; kind < ENERGIES; kind++)
            values[kind * n + i] = of[kind] / millijoule;
    }
    for (size_t kind = 0; kind < ENERGIES; kind++)
        wb_figure_add_line(panel, labels[kind], n, times, values + kind * n, &styles[kind]);
    free(times);
}

static double largest_energy(const struct wb_bundles_result *run)
{
    double largest = 0.0;
    for (int i = 0; i < run->n_energies; i++)
        largest = fmax(largest, run->energies[i].internal);
    return largest > 0.0 ? largest : millijoule;
}

static enum wb_status draw_energies(struct wb_figures_item *item)
{
    const struct wb_bundles_results *const results = item->results;
    const struct wb_bundles_group *const group = &results->campaign->groups[item->index];
    char place[48];
    wb_text_append(&item->caption,
                   "Energies%s over the model's own time, with decaying friction. Internal: stored "
                   "and plastic, in wires, tape, contact and cohesion.",
                   wb_pages_paper_figure(place, group->figures[WB_BUNDLES_ENERGY]));
    for (int i = group->first; i < group->first + group->n; i++) {
        const struct wb_bundles_result *const run = wb_bundles_results_dynamic(results, i);
        const bool is_first = !item->figure;
        if (!run)
            continue;
        if (is_first)
            WB_TRY(start(&item->figure, "energies", item->index, panel_height));
        struct wb_panel *const panel = wb_figure_add_panel(item->figure);
        wb_figures_set_title(panel, results->campaign->bundles[i].label);
        wb_figure_set_axes(panel, "Time of the model (s)", is_first ? "Energy (mJ)" : "");
        /* Room above for the legend, so that the panels are alike. */
        wb_figure_set_y_range(panel, 0.0, 1.3 * largest_energy(run) / millijoule);
        add_energies(panel, run);
    }
    return WB_OK;
}

/* --- bent bundles --- */

/* The bundles of a group have one scale. */
static double most_stress(const struct wb_bundles_results *results,
                          const struct wb_bundles_group *group)
{
    double most = 0.0;
    for (int i = group->first; i < group->first + group->n; i++) {
        const struct wb_bundles_result *const run = wb_bundles_results_dynamic(results, i);
        if (run && run->surface.n > 0)
            most = fmax(most, wb_figures_surface_most_stress(&run->surface));
    }
    return most;
}

static enum wb_status draw_shape(struct wb_figures_item *item)
{
    const struct wb_bundles_results *const results = item->results;
    const struct wb_bundles *const campaign = results->campaign;
    const struct wb_bundles_bundle *const bundle = &campaign->bundles[item->index];
    const struct wb_bundles_result *const run = wb_bundles_results_dynamic(results, item->index);
    char name[64], title[LABEL];
    if (!run || run->surface.n == 0)
        return WB_OK;
    char place[48];
    wb_text_append_escaped(&item->caption, bundle->label);
    wb_text_append(
        &item->caption,
        " bent by %.0f mm%s: von Mises stress of the wires, with the tape drawn as "
        "glass, from the side and its ends from nearby.",
        run->curve.max_deflection / WB_MM,
        wb_pages_paper_figure(place, campaign->groups[bundle->group].figures[WB_BUNDLES_SHAPE]));
    snprintf(name, sizeof name, "shape-%d", item->index + 1);
    const struct wb_figures_surface_style style = {
        .width = WB_PDF_WIDTH,
        .most_stress = most_stress(results, &campaign->groups[bundle->group]),
        .title = wb_pages_escape(title, sizeof title, bundle->label)};
    return wb_figures_surface_draw(&item->figure, name, &run->surface, &style);
}

/* --- studies --- */

static void draw_study(struct wb_figure *figure, const struct wb_bundles_results *results,
                       const struct wb_bundles_study *study, bool first)
{
    static const enum wb_figure_dash dashes[] = {WB_DASH_SOLID, WB_DASH_DASHED, WB_DASH_DOTTED,
                                                 WB_DASH_MIXED};
    struct wb_panel *const panel = add_force_panel(figure, study->title, first);
    bool published = false;
    for (int i = 0; i < study->n; i++) {
        const struct wb_bundles_result *const run =
            wb_bundles_results_usable(results, study->runs[i]);
        const struct wb_figure_style style = {
            .colour = wb_palette_wire(i), .width = 1.2, .dash = dashes[i % 4]};
        char label[6 * sizeof study->labels[0]];
        if (!run)
            continue;
        if (!published)
            add_published(panel, "published", run);
        published = true;
        add_run(panel, wb_pages_escape(label, sizeof label, study->labels[i]), run, &style);
    }
}

static enum wb_status draw_studies(struct wb_figures_item *item)
{
    const struct wb_bundles_results *const results = item->results;
    const struct wb_bundles *const campaign = results->campaign;
    const int first = 2 * item->index;
    const int end = first + 2 < campaign->n_studies ? first + 2 : campaign->n_studies;
    bool any = false;
    for (int k = first; k < end; k++) {
        for (int i = 0; i < campaign->studies[k].n; i++)
            any |= wb_bundles_results_usable(results, campaign->studies[k].runs[i]) != NULL;
    }
    if (!any)
        return WB_OK;
    WB_TRY(start(&item->figure, "study", item->index, 220.0));
    wb_text_append(&item->caption, "Studies of ");
    for (int k = first; k < end; k++) {
        const struct wb_bundles_study *const study = &campaign->studies[k];
        wb_text_append(&item->caption, "%s<i>", k > first ? " and " : "");
        wb_text_append_escaped(&item->caption, study->title);
        wb_text_append(&item->caption, "</i> (");
        wb_text_append_escaped(&item->caption, campaign->runs[study->runs[0]].model->title);
        wb_text_append(&item->caption, ")");
    }
    wb_text_append(&item->caption,
                   "%s. Published: the 1D beam with the published properties, under "
                   "the first run's loading.",
                   item->index == 0 && campaign->printed_source[0] ? ", after the paper's Fig. 18"
                                                                   : "");
    for (int k = first; k < end; k++)
        draw_study(item->figure, results, &campaign->studies[k], k == first);
    return WB_OK;
}

/* --- the section model --- */

/* Of the run with constant friction, where both models have the same one, else of the other. */
static int shown_run(const struct wb_bundles_results *results,
                     const struct wb_bundles_bundle *bundle)
{
    return wb_bundles_results_usable(results, bundle->constant) &&
                   wb_bundles_results_section(results, bundle->constant)
               ? bundle->constant
               : bundle->dynamic;
}

static enum wb_status draw_section_model(struct wb_figures_item *item)
{
    const struct wb_bundles_results *const results = item->results;
    const struct wb_bundles_group *const group = &results->campaign->groups[item->index];
    wb_text_append(&item->caption,
                   "Force over deflection of the section model and of the explicit one, with the "
                   "same constant friction where there is such a run.");
    for (int i = group->first; i < group->first + group->n; i++) {
        const struct wb_bundles_bundle *const bundle = &results->campaign->bundles[i];
        const int run = shown_run(results, bundle);
        const struct wb_bundles_result *const explicit = wb_bundles_results_usable(results, run);
        const struct wb_bundles_section *const section = wb_bundles_results_section(results, run);
        const bool is_first = !item->figure;
        if (!section)
            continue;
        if (is_first)
            WB_TRY(start(&item->figure, "section-model", item->index, panel_height));
        struct wb_panel *const panel = add_force_panel(item->figure, bundle->label, is_first);
        const double largest = explicit ? explicit->curve.max_force : 0.0;
        add_run(panel, "explicit 3D", explicit, &wb_figures_reference_style);
        /* Room above for the legend, so that the panels are alike. */
        wb_figure_set_y_range(panel, 0.0, 1.25 * fmax(section->curve.max_force, largest));
        wb_figures_add_curve(panel, "section model", &section->curve, section->curve.force, 1.0,
                             &dynamic_style);
    }
    return WB_OK;
}

/* --- 3D and 1D --- */

enum {
    SHAPE_POINTS = 61,
    SHAPES = 3, /* at thirds of the largest deflection */
    MOST_MARKERS = 128
};

/* The stored axis at the row nearest to a deflection, mm; returns its number of points. */
static size_t take_axis(const struct wb_dataset *dataset, double *deflection, double x[],
                        double y[])
{
    const double wanted = *deflection;
    double nearest = (double)INFINITY;
    size_t n = 0;
    for (size_t i = 0; i < dataset->n_shape_rows; i++)
        nearest = fmin(nearest, fabs(dataset->shape_rows[i].deflection - wanted));
    for (size_t i = 0; i < dataset->n_shape_rows && n < MOST_MARKERS; i++) {
        const struct wb_shape_row *const row = &dataset->shape_rows[i];
        if (fabs(row->deflection - wanted) > nearest)
            continue;
        if (n > 0 && row->marker == 0)
            break;
        *deflection = row->deflection;
        x[n] = row->x / WB_MM;
        y[n++] = row->y / WB_MM;
    }
    return n;
}

static struct wb_figure_style solid_style(int index)
{
    return (struct wb_figure_style){.colour = wb_palette_fade(wb_palette_wire(index), 0.45),
                                    .width = 3.6};
}

static struct wb_figure_style beam_style(int index)
{
    return (struct wb_figure_style){
        .colour = wb_palette_wire(index), .width = 1.2, .dash = WB_DASH_DASHED};
}

static enum wb_status add_shapes(struct wb_panel *inset, const struct wb_bundles_results *results,
                                 int index)
{
    const struct wb_bundles_result *const run = wb_bundles_results_dynamic(results, index);
    const struct wb_bundles_fit *const fit = wb_bundles_results_fit(results, index);
    const struct wb_figure_style solid = solid_style(index), beam = beam_style(index);
    struct wb_properties properties;
    wb_properties_from_result(&fit->result, &properties);
    wb_figure_set_axes(inset, "<i>x</i> (mm)", "<i>y</i> (mm)");
    wb_figure_set_equal_aspect(inset);
    for (int i = 1; i <= SHAPES; i++) {
        double x[MOST_MARKERS], y[MOST_MARKERS], line_x[SHAPE_POINTS], line_y[SHAPE_POINTS];
        double deflection = run->curve.max_deflection * i / SHAPES;
        const size_t n = take_axis(&run->simulation.dataset, &deflection, x, y);
        if (n == 0)
            continue;
        wb_figure_add_line(inset, NULL, n, x, y, &solid);
        const enum wb_status status = wb_validate_shape(&properties, &run->simulation.dataset.info,
                                                        deflection, SHAPE_POINTS, line_x, line_y);
        if (status == WB_ERR_CONVERGENCE)
            continue;
        WB_TRY(status);
        for (int k = 0; k < SHAPE_POINTS; k++) {
            line_x[k] /= WB_MM;
            line_y[k] /= WB_MM;
        }
        wb_figure_add_line(inset, NULL, SHAPE_POINTS, line_x, line_y, &beam);
    }
    return WB_OK;
}

static void add_fit(struct wb_panel *panel, const struct wb_bundles_results *results, int index)
{
    const struct wb_bundles_result *const run = wb_bundles_results_dynamic(results, index);
    const struct wb_bundles_fit *const fit = wb_bundles_results_fit(results, index);
    const struct wb_figure_style solid = solid_style(index), beam = beam_style(index);
    char name[LABEL], label[LABEL + 100];
    wb_pages_escape(name, sizeof name, results->campaign->bundles[index].label);
    snprintf(label, sizeof label, "%s, 3D", name);
    add_run(panel, label, run, &solid);
    if (!fit)
        return;
    snprintf(label, sizeof label, "%s, 1D: RMS %.4f", name, fit->result.rms);
    wb_figures_add_curve(panel, label, &run->curve, fit->force, 1.0, &beam);
}

static bool any_published(const struct wb_bundles_results *results)
{
    bool any = false;
    for (int i = 0; i < results->campaign->n_bundles; i++)
        any |= isfinite(wb_bundles_results_rms(results, results->campaign->bundles[i].dynamic));
    return any;
}

static enum wb_status draw_fit(struct wb_figures_item *item)
{
    const struct wb_bundles_results *const results = item->results;
    const struct wb_bundles *const campaign = results->campaign;
    double largest = 0.0;
    bool some_rod = false; /* then variants without one would only crowd the figure */
    for (int i = 0; i < campaign->n_bundles; i++) {
        const struct wb_bundles_result *const run = wb_bundles_results_dynamic(results, i);
        largest = fmax(largest, run ? run->curve.max_force : 0.0);
        some_rod = some_rod || campaign->bundles[i].has_rod;
    }
    /* Without published curves the first page has this figure. */
    const bool is_first = strcmp(item->row->place, "found") == 0;
    if (!(largest > 0.0) || is_first == any_published(results))
        return WB_OK;
    WB_TRY(start(&item->figure, "fit", -1, 300.0));
    wb_text_append(&item->caption,
                   "Simulated force over deflection in 3D (broad) and of the fitted 1D "
                   "beam (dashed)%s.",
                   campaign->printed_source[0] ? ", after the paper's Fig. 26" : "");
    if (campaign->inset >= 0) {
        wb_text_append(&item->caption, " Inset: bent axes of ");
        wb_text_append_escaped(&item->caption, campaign->bundles[campaign->inset].label);
        wb_text_append(&item->caption, " at a third, two thirds and all of the deflection.");
    }
    struct wb_panel *const panel = wb_figure_add_panel(item->figure);
    wb_figure_set_axes(panel, "Deflection <i>\xce\xb4</i> (mm)", "Force (N)");
    /* Room above for legend and inset. */
    wb_figure_set_y_range(panel, 0.0, 1.3 * largest);
    for (int i = 0; i < campaign->n_bundles; i++)
        if (campaign->bundles[i].has_rod || !some_rod)
            add_fit(panel, results, i);
    if (campaign->inset < 0 || !wb_bundles_results_fit(results, campaign->inset))
        return WB_OK;
    return add_shapes(wb_figure_add_inset(panel), results, campaign->inset);
}

/* The RMS of every bundle from its published curve beside the limit. */
static enum wb_status draw_found(struct wb_figures_item *item)
{
    const struct wb_bundles_results *const results = item->results;
    const struct wb_bundles *const campaign = results->campaign;
    const struct wb_figure_style styles[] = {
        {.colour = wb_palette_wire(0), .marker = WB_MARKER_CIRCLE, .marker_size = 5.0},
        {.colour = wb_palette_wire(1), .marker = WB_MARKER_RING, .marker_size = 5.0}};
    const struct wb_figure_style limit = {
        .colour = wb_palette_warning(), .width = 1.0, .dash = WB_DASH_DASHED};
    static const char *const labels[] = {"decaying friction", "constant friction"};
    double x[2][WB_BUNDLES_BUNDLES], y[2][WB_BUNDLES_BUNDLES];
    char escaped[WB_BUNDLES_BUNDLES][LABEL];
    const char *names[WB_BUNDLES_BUNDLES];
    size_t n[2] = {0, 0};
    const int n_bundles = campaign->n_bundles;
    if (!any_published(results))
        return draw_fit(item);
    /* From the bottom up, as tables are read from the top down. */
    for (int i = 0; i < n_bundles; i++) {
        const struct wb_bundles_bundle *const bundle = &campaign->bundles[n_bundles - 1 - i];
        const double rms[2] = {wb_bundles_results_rms(results, bundle->dynamic),
                               wb_bundles_results_rms(results, bundle->constant)};
        names[i] = wb_pages_escape(escaped[i], sizeof escaped[i], bundle->label);
        for (int k = 0; k < 2; k++) {
            if (!isfinite(rms[k]))
                continue;
            x[k][n[k]] = rms[k] / WB_PERCENT;
            y[k][n[k]++] = i;
        }
    }
    WB_TRY(start(&item->figure, "found", -1, 46.0 + 10.0 * n_bundles));
    struct wb_panel *const panel = wb_figure_add_panel(item->figure);
    wb_figure_set_axes(panel, "RMS from the published curve (% of its largest force)", "");
    for (int k = 0; k < 2; k++) {
        if (n[k] > 0)
            wb_figure_add_line(panel, labels[k], n[k], x[k], y[k], &styles[k]);
    }
    if (campaign->limits.rms > 0.0) {
        const double at = campaign->limits.rms / WB_PERCENT;
        const double xs[2] = {at, at}, ys[2] = {-0.6, n_bundles - 0.4};
        wb_figure_add_line(panel, "limit", 2, xs, ys, &limit);
    }
    wb_figure_set_y_names(panel, n_bundles, names);
    wb_figure_set_y_range(panel, -0.6, n_bundles - 0.4);
    wb_text_append(&item->caption,
                   "RMS difference of each bundle's simulated force from the published curve.");
    return WB_OK;
}

/* --- the table --- */

static int count_groups(const void *context)
{
    const struct wb_bundles_results *const results = context;
    return results->campaign->n_groups;
}

static int count_bundles(const void *context)
{
    const struct wb_bundles_results *const results = context;
    return results->campaign->n_bundles;
}

/* Two studies stand beside each other. */
static int count_studies(const void *context)
{
    const struct wb_bundles_results *const results = context;
    return (results->campaign->n_studies + 1) / 2;
}

const struct wb_figures_row wb_bundles_figures[WB_BUNDLES_FIGURE_ROWS] = {
    {"found", NULL, draw_found, false},
    {"sections", count_groups, draw_sections, false},
    {"studies", count_studies, draw_studies, false},
    {"curves", count_groups, draw_forces, false},
    {"curves", count_groups, draw_errors, false},
    {"energies", count_groups, draw_energies, false},
    {"shapes", count_bundles, draw_shape, false},
    {"section-model", count_groups, draw_section_model, false},
    {"fit", NULL, draw_fit, false},
};
