#include "analysis/report/bundles/bundles_figures.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/properties.h"
#include "analysis/report/draw/figures_surface.h"
#include "analysis/report/pdf.h"
#include "analysis/validate.h"
#include "base/text.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "report"

static const double millijoule = 1e-3;
static const double panel_height = 190.0;

/* --- lines --- */

/* The published curve is a broad pale line in every figure; the others lie on it. */
static const struct wb_figure_style published_style = {.colour = {0.34, 0.71, 0.91, 0.75},
                                                       .width = 3.6};
static const struct wb_figure_style dynamic_style = {.colour = {0.114, 0.153, 0.2, 1.0},
                                                     .width = 1.3};
static const struct wb_figure_style constant_style = {
    .colour = {0.835, 0.369, 0.0, 1.0}, .width = 1.2, .dash = WB_DASH_DASHED};

/* Values on the curve's grid, which begins at zero deflection. */
static enum wb_status add_values(struct wb_panel *panel, const char *label,
                                 const struct wb_curve *curve, const double *values,
                                 const struct wb_figure_style *style)
{
    double *const x = malloc((size_t)curve->n * sizeof *x);
    if (!x)
        return wb_fail(WB_ERR_MEMORY, "out of memory drawing figures");
    for (int i = 0; i < curve->n; i++)
        x[i] = curve->step * i / WB_MM;
    wb_figure_add_line(panel, label, (size_t)curve->n, x, values, style);
    free(x);
    return WB_OK;
}

static enum wb_status add_run(struct wb_panel *panel, const char *label,
                              const struct wb_bundles_result *run,
                              const struct wb_figure_style *style)
{
    return run ? add_values(panel, label, &run->curve, run->curve.force, style) : WB_OK;
}

static enum wb_status add_published(struct wb_panel *panel, const char *label,
                                    const struct wb_bundles_result *run)
{
    if (!run || !run->published)
        return WB_OK;
    return add_values(panel, label, &run->curve, run->published, &published_style);
}

static void set_title(struct wb_panel *panel, const char *plain)
{
    struct wb_text title = {0};
    wb_text_append_escaped(&title, plain);
    wb_figure_set_title(panel, wb_text_string(&title));
    wb_text_release(&title);
}

static enum wb_status start(struct wb_figure **figure, const char *kind, int index, double height)
{
    char name[64];
    snprintf(name, sizeof name, index >= 0 ? "%s-%d" : "%s", kind, index + 1);
    WB_TRY(wb_figure_create(figure, name, WB_PDF_WIDTH, height));
    wb_figure_set_footer(*figure, "simulation, no test");
    return WB_OK;
}

static struct wb_panel *add_force_panel(struct wb_figure *figure, const char *title, bool first)
{
    struct wb_panel *const panel = wb_figure_add_panel(figure);
    set_title(panel, title);
    wb_figure_set_axes(panel, "Deflection <i>\xce\xb4</i> (mm)", first ? "Force (N)" : "");
    wb_figure_set_y_range(panel, 0.0, (double)NAN);
    return panel;
}

/* --- sections --- */

static enum wb_status draw_sections(struct wb_figure **figure,
                                    const struct wb_bundles_results *results, int index)
{
    const struct wb_bundles *const campaign = results->campaign;
    const struct wb_bundles_group *const group = &campaign->groups[index];
    const struct wb_bundle_model *models[WB_FIGURES_BUNDLE_MOST];
    const char *mesh = campaign->runs[campaign->bundles[group->first].dynamic].mesh->name;
    char name[64];
    snprintf(name, sizeof name, "sections-%d", index + 1);
    for (int i = 0; i < group->n; i++) {
        models[i] = campaign->runs[campaign->bundles[group->first + i].dynamic].model;
        if (!wb_bundle_model_mesh(models[i], mesh))
            mesh = "engineering";
    }
    return wb_figures_bundle_draw(figure, name, group->n, models, mesh);
}

/* --- constant and decaying friction --- */

static bool is_usable(const struct wb_bundles_results *results,
                      const struct wb_bundles_bundle *bundle)
{
    return wb_bundles_results_usable(results, bundle->dynamic) ||
           wb_bundles_results_usable(results, bundle->constant);
}

static bool any_usable(const struct wb_bundles_results *results, const struct wb_bundles_group *g)
{
    bool any = false;
    for (int i = g->first; i < g->first + g->n; i++)
        any |= is_usable(results, &results->campaign->bundles[i]);
    return any;
}

static enum wb_status add_forces(struct wb_panel *panel, const struct wb_bundles_results *results,
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
    WB_TRY(add_published(panel, "published", any));
    WB_TRY(add_run(panel, "constant", constant, &constant_style));
    return add_run(panel, "decaying", dynamic, &dynamic_style);
}

static enum wb_status draw_forces(struct wb_figure **figure,
                                  const struct wb_bundles_results *results, int index)
{
    const struct wb_bundles_group *const group = &results->campaign->groups[index];
    if (!any_usable(results, group))
        return WB_OK;
    WB_TRY(start(figure, "forces", index, panel_height));
    for (int i = group->first, n = 0; i < group->first + group->n; i++) {
        const struct wb_bundles_bundle *const bundle = &results->campaign->bundles[i];
        if (is_usable(results, bundle))
            WB_TRY(add_forces(add_force_panel(*figure, bundle->label, n++ == 0), results, bundle));
    }
    return WB_OK;
}

/* --- errors --- */

static enum wb_status add_error(struct wb_panel *panel, const char *bundle, const char *friction,
                                const struct wb_bundles_result *run,
                                const struct wb_figure_style *style)
{
    struct wb_text label = {0};
    if (!run || !run->published || !isfinite(run->rms))
        return WB_OK;
    wb_text_append_escaped(&label, bundle);
    wb_text_append(&label, ", %s: RMS %.4f", friction, run->rms);
    const enum wb_status status =
        add_values(panel, wb_text_string(&label), &run->curve, run->error, style);
    wb_text_release(&label);
    return status;
}

static enum wb_status draw_errors(struct wb_figure **figure,
                                  const struct wb_bundles_results *results, int index)
{
    const struct wb_bundles *const campaign = results->campaign;
    const struct wb_bundles_group *const group = &campaign->groups[index];
    bool any = false;
    for (int i = 0; i < group->n; i++)
        any |= wb_bundles_published(&campaign->runs[campaign->bundles[group->first + i].dynamic]) !=
               NULL;
    if (!any || !any_usable(results, group))
        return WB_OK;
    WB_TRY(start(figure, "errors", index, 180.0));
    struct wb_panel *const panel = wb_figure_add_panel(*figure);
    wb_figure_set_axes(panel, "Deflection <i>\xce\xb4</i> (mm)", "Error / <i>F</i><sub>max</sub>");
    wb_figure_set_y_range(panel, 0.0, (double)NAN);
    for (int i = 0; i < group->n; i++) {
        const struct wb_bundles_bundle *const bundle = &campaign->bundles[group->first + i];
        const struct wb_figure_style solid = {.colour = wb_palette_wire(i), .width = 1.5};
        const struct wb_figure_style dashed = {
            .colour = wb_palette_wire(i), .width = 1.1, .dash = WB_DASH_DASHED};
        WB_TRY(add_error(panel, bundle->label, "decaying",
                         wb_bundles_results_usable(results, bundle->dynamic), &solid));
        WB_TRY(add_error(panel, bundle->label, "constant",
                         wb_bundles_results_usable(results, bundle->constant), &dashed));
    }
    return WB_OK;
}

/* --- energies --- */

enum energy {
    INTERNAL,
    FRICTION,
    KINETIC,
    ARTIFICIAL,
    ENERGIES
};

static double energy_of(const struct wb_bundles_energy *row, enum energy kind)
{
    const double of[ENERGIES] = {
        [INTERNAL] = row->internal,
        [FRICTION] = row->friction,
        [KINETIC] = row->kinetic,
        [ARTIFICIAL] = row->artificial,
    };
    return of[kind];
}

static enum wb_status add_energies(struct wb_panel *panel, const struct wb_bundles_result *run)
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
        return WB_OK;
    double *const values = malloc(2 * n * sizeof *values);
    if (!values)
        return wb_fail(WB_ERR_MEMORY, "out of memory drawing figures");
    for (int kind = 0; kind < ENERGIES; kind++) {
        for (size_t i = 0; i < n; i++) {
            values[i] = run->energies[i].time;
            values[n + i] = energy_of(&run->energies[i], (enum energy)kind) / millijoule;
        }
        wb_figure_add_line(panel, labels[kind], n, values, values + n, &styles[kind]);
    }
    free(values);
    return WB_OK;
}

static double largest_energy(const struct wb_bundles_result *run)
{
    double largest = 0.0;
    for (int i = 0; i < run->n_energies; i++)
        largest = fmax(largest, run->energies[i].internal);
    return largest > 0.0 ? largest : millijoule;
}

static enum wb_status draw_energies(struct wb_figure **figure,
                                    const struct wb_bundles_results *results, int index)
{
    const struct wb_bundles_group *const group = &results->campaign->groups[index];
    bool any = false;
    for (int i = group->first; i < group->first + group->n; i++)
        any |= wb_bundles_results_usable(results, results->campaign->bundles[i].dynamic) != NULL;
    if (!any)
        return WB_OK;
    WB_TRY(start(figure, "energies", index, panel_height));
    for (int i = group->first, n = 0; i < group->first + group->n; i++) {
        const struct wb_bundles_bundle *const bundle = &results->campaign->bundles[i];
        const struct wb_bundles_result *const run =
            wb_bundles_results_usable(results, bundle->dynamic);
        if (!run)
            continue;
        struct wb_panel *const panel = wb_figure_add_panel(*figure);
        set_title(panel, bundle->label);
        wb_figure_set_axes(panel, "Time of the model (s)", n++ == 0 ? "Energy (mJ)" : "");
        /* Room above for the legend, so that the panels are alike. */
        wb_figure_set_y_range(panel, 0.0, 1.3 * largest_energy(run) / millijoule);
        WB_TRY(add_energies(panel, run));
    }
    return WB_OK;
}

/* --- bent bundles --- */

/* The bundles of a group have one scale. */
static enum wb_status draw_shapes(struct wb_bundles_figures *figures,
                                  const struct wb_bundles_results *results, int index)
{
    const struct wb_bundles *const campaign = results->campaign;
    const struct wb_bundles_group *const group = &campaign->groups[index];
    const int end = group->first + group->n;
    struct wb_figures_surface_style style = {.width = WB_PDF_WIDTH};
    for (int i = group->first; i < end; i++) {
        const struct wb_bundles_result *const run =
            wb_bundles_results_usable(results, campaign->bundles[i].dynamic);
        if (run && run->surface.n > 0)
            style.most_stress =
                fmax(style.most_stress, wb_figures_surface_most_stress(&run->surface));
    }
    for (int i = group->first; i < end; i++) {
        const struct wb_bundles_result *const run =
            wb_bundles_results_usable(results, campaign->bundles[i].dynamic);
        struct wb_text title = {0};
        char name[64];
        if (!run || run->surface.n == 0)
            continue;
        wb_text_append_escaped(&title, campaign->bundles[i].label);
        snprintf(name, sizeof name, "shape-%d", i + 1);
        style.title = wb_text_string(&title);
        const enum wb_status status =
            wb_figures_surface_draw(&figures->shapes[i], name, &run->surface, &style);
        wb_text_release(&title);
        WB_TRY(status);
    }
    return WB_OK;
}

/* --- studies --- */

static enum wb_status draw_study(struct wb_figure *figure, const struct wb_bundles_results *results,
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
        struct wb_text label = {0};
        if (!run)
            continue;
        if (!published)
            WB_TRY(add_published(panel, "published", run));
        published = true;
        wb_text_append_escaped(&label, study->labels[i]);
        const enum wb_status status = add_run(panel, wb_text_string(&label), run, &style);
        wb_text_release(&label);
        WB_TRY(status);
    }
    return WB_OK;
}

static enum wb_status draw_studies(struct wb_figure **figure,
                                   const struct wb_bundles_results *results, int index)
{
    const struct wb_bundles *const campaign = results->campaign;
    bool any = false;
    for (int k = 2 * index; k < 2 * index + 2 && k < campaign->n_studies; k++) {
        for (int i = 0; i < campaign->studies[k].n; i++)
            any |= wb_bundles_results_usable(results, campaign->studies[k].runs[i]) != NULL;
    }
    if (!any)
        return WB_OK;
    WB_TRY(start(figure, "study", index, 220.0));
    for (int k = 2 * index; k < 2 * index + 2 && k < campaign->n_studies; k++)
        WB_TRY(draw_study(*figure, results, &campaign->studies[k], k == 2 * index));
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

static enum wb_status add_shapes(struct wb_panel *inset, const struct wb_bundles_result *run,
                                 const struct wb_bundles_fit *fit,
                                 const struct wb_figure_style *solid,
                                 const struct wb_figure_style *beam)
{
    struct wb_properties properties;
    wb_properties_from_result(&fit->result, &properties);
    wb_figure_set_axes(inset, "<i>x</i> (mm)", "<i>y</i> (mm)");
    wb_figure_set_equal_aspect(inset);
    for (int i = 1; i <= SHAPES; i++) {
        double x[MOST_MARKERS], y[MOST_MARKERS], line_x[SHAPE_POINTS], line_y[SHAPE_POINTS];
        double deflection = run->curve.max_deflection * i / SHAPES;
        const size_t n = take_axis(&run->dataset, &deflection, x, y);
        if (n == 0)
            continue;
        wb_figure_add_line(inset, NULL, n, x, y, solid);
        const enum wb_status status = wb_validate_shape(&properties, &run->dataset.info, deflection,
                                                        SHAPE_POINTS, line_x, line_y);
        if (status == WB_ERR_CONVERGENCE)
            continue;
        WB_TRY(status);
        for (int k = 0; k < SHAPE_POINTS; k++) {
            line_x[k] /= WB_MM;
            line_y[k] /= WB_MM;
        }
        wb_figure_add_line(inset, NULL, SHAPE_POINTS, line_x, line_y, beam);
    }
    return WB_OK;
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

static enum wb_status add_fit(struct wb_panel *panel, const struct wb_bundles_results *results,
                              int index)
{
    const struct wb_bundles_bundle *const bundle = &results->campaign->bundles[index];
    const struct wb_bundles_result *const run = wb_bundles_results_usable(results, bundle->dynamic);
    const struct wb_bundles_fit *const fit = wb_bundles_results_fit(results, index);
    const struct wb_figure_style solid = solid_style(index), beam = beam_style(index);
    struct wb_text label = {0};
    wb_text_append_escaped(&label, bundle->label);
    wb_text_append(&label, ", 3D");
    enum wb_status status = add_run(panel, wb_text_string(&label), run, &solid);
    wb_text_release(&label);
    if (status != WB_OK || !fit)
        return status;
    wb_text_append_escaped(&label, bundle->label);
    wb_text_append(&label, ", 1D: RMS %.4f", fit->result.rms);
    status = add_values(panel, wb_text_string(&label), &run->curve, fit->force, &beam);
    wb_text_release(&label);
    return status;
}

static enum wb_status draw_fit(struct wb_figure **figure, const struct wb_bundles_results *results)
{
    const struct wb_bundles *const campaign = results->campaign;
    double largest = 0.0;
    bool some_rod = false; /* then variants without one would only crowd the figure */
    for (int i = 0; i < campaign->n_bundles; i++) {
        const struct wb_bundles_result *const run =
            wb_bundles_results_usable(results, campaign->bundles[i].dynamic);
        largest = fmax(largest, run ? run->curve.max_force : 0.0);
        some_rod = some_rod || campaign->bundles[i].has_rod;
    }
    if (!(largest > 0.0))
        return WB_OK;
    WB_TRY(start(figure, "fit", -1, 300.0));
    struct wb_panel *const panel = wb_figure_add_panel(*figure);
    wb_figure_set_axes(panel, "Deflection <i>\xce\xb4</i> (mm)", "Force (N)");
    /* Room above for legend and inset. */
    wb_figure_set_y_range(panel, 0.0, 1.3 * largest);
    for (int i = 0; i < campaign->n_bundles; i++)
        if (campaign->bundles[i].has_rod || !some_rod)
            WB_TRY(add_fit(panel, results, i));
    if (campaign->inset < 0 || !wb_bundles_results_fit(results, campaign->inset))
        return WB_OK;
    const struct wb_figure_style solid = solid_style(campaign->inset),
                                 beam = beam_style(campaign->inset);
    return add_shapes(
        wb_figure_add_inset(panel),
        wb_bundles_results_usable(results, campaign->bundles[campaign->inset].dynamic),
        wb_bundles_results_fit(results, campaign->inset), &solid, &beam);
}

/* --- all of them --- */

static enum wb_status draw_all(struct wb_bundles_figures *figures,
                               const struct wb_bundles_results *results)
{
    const struct wb_bundles *const campaign = results->campaign;
    for (int i = 0; i < campaign->n_groups; i++) {
        struct wb_figure **const group = figures->groups[i];
        WB_TRY(draw_sections(&group[WB_BUNDLES_SECTION], results, i));
        WB_TRY(draw_forces(&group[WB_BUNDLES_FORCE], results, i));
        WB_TRY(draw_errors(&group[WB_BUNDLES_ERROR], results, i));
        WB_TRY(draw_shapes(figures, results, i));
        WB_TRY(draw_energies(&group[WB_BUNDLES_ENERGY], results, i));
    }
    for (int i = 0; 2 * i < campaign->n_studies; i++)
        WB_TRY(draw_studies(&figures->studies[i], results, i));
    return draw_fit(&figures->fit, results);
}

enum wb_status wb_bundles_figures_create(struct wb_bundles_figures *figures,
                                         const struct wb_bundles_results *results)
{
    memset(figures, 0, sizeof *figures);
    const enum wb_status status = draw_all(figures, results);
    if (status != WB_OK)
        wb_bundles_figures_release(figures);
    return status;
}

/* Everything, also what is not there. */
static int collect(const struct wb_bundles_figures *figures,
                   struct wb_figure *all[WB_BUNDLES_FIGURES_MOST])
{
    int n = 0;
    for (int i = 0; i < WB_BUNDLES_GROUPS; i++)
        all[n++] = figures->groups[i][WB_BUNDLES_SECTION];
    for (int i = 0; i < (WB_BUNDLES_STUDIES + 1) / 2; i++)
        all[n++] = figures->studies[i];
    for (int i = 0; i < WB_BUNDLES_GROUPS; i++) {
        for (int k = WB_BUNDLES_SECTION + 1; k < WB_BUNDLES_FIGURES; k++)
            all[n++] = figures->groups[i][k];
    }
    for (int i = 0; i < WB_BUNDLES_BUNDLES; i++)
        all[n++] = figures->shapes[i];
    all[n++] = figures->fit;
    return n;
}

int wb_bundles_figures_list(const struct wb_bundles_figures *figures,
                            const struct wb_figure *list[WB_BUNDLES_FIGURES_MOST])
{
    struct wb_figure *all[WB_BUNDLES_FIGURES_MOST];
    const int n_all = collect(figures, all);
    int n = 0;
    for (int i = 0; i < n_all; i++) {
        if (all[i])
            list[n++] = all[i];
    }
    return n;
}

void wb_bundles_figures_release(struct wb_bundles_figures *figures)
{
    struct wb_figure *all[WB_BUNDLES_FIGURES_MOST];
    const int n = collect(figures, all);
    for (int i = 0; i < n; i++)
        wb_figure_destroy(all[i]);
    memset(figures, 0, sizeof *figures);
}
