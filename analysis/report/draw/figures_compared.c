#include "analysis/report/draw/figures_compared.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "base/units.h"

static const char deflection_axis[] = "Deflection <i>\xce\xb4</i> (mm)";

void wb_figures_compared_start(struct wb_figures_compared *to, struct wb_figure *figure,
                               const char *force_label, double max_force)
{
    to->forces = wb_figure_add_panel(figure);
    to->errors = wb_figure_add_panel(figure);
    to->max_force = max_force;
    wb_figure_set_axes(to->forces, deflection_axis, force_label);
    wb_figure_set_axes(to->errors, deflection_axis, "Error (% of <i>F</i><sub>max</sub>)");
}

void wb_figures_compared_add(const struct wb_figures_compared *to, const char *label,
                             const char *line, int n, const double *x, const double *measured,
                             const double *computed, struct wb_colour colour, bool is_odd)
{
    double *const error = wb_memory_new((size_t)n, sizeof *error);
    for (int i = 0; i < n; i++)
        error[i] = 100.0 * WB_MN * (computed[i] - measured[i]) / to->max_force;
    const struct wb_figure_style points = {
        .colour = colour, .marker = is_odd ? WB_MARKER_RING : WB_MARKER_CIRCLE, .marker_size = 3.0};
    const struct wb_figure_style ink = {.colour = wb_palette_ink(), .width = 0.9};
    const struct wb_figure_style thin = {
        .colour = colour, .width = 1.0, .dash = is_odd ? WB_DASH_DASHED : WB_DASH_SOLID};
    wb_figure_add_line(to->forces, label, (size_t)n, x, measured, &points);
    wb_figure_add_line(to->forces, line, (size_t)n, x, computed, &ink);
    wb_figure_add_line(to->errors, label, (size_t)n, x, error, &thin);
    free(error);
}

void wb_figures_compared_prediction(struct wb_figure *figure,
                                    const struct wb_validate_result *result,
                                    struct wb_colour colour)
{
    const struct wb_curve *const curve = &result->curve;
    const struct wb_validate_cycles *const back = &result->cycles;
    const int most = curve->n > back->n ? curve->n : back->n;
    double *const x = wb_memory_new(3 * (size_t)most, sizeof *x), *const measured = x + most,
                  *const computed = x + 2 * most;
    struct wb_figures_compared to;
    int n = 0;
    wb_figures_compared_start(&to, figure, "Force <i>F</i> (mN)", curve->max_force);
    /* Points as far apart as those of the unloading, and no others than the beam reached. */
    const int every = (int)fmax(1.0, round(WB_MM / curve->step));
    for (int i = 0; i < result->elastoplastic.n_reached; i += every) {
        x[n] = i * curve->step / WB_MM;
        measured[n] = curve->force[i] / WB_MN;
        computed[n++] = result->elastoplastic.force[i] / WB_MN;
    }
    wb_figures_compared_add(&to, "loading", back->n > 0 ? NULL : "predicted", n, x, measured,
                            computed, colour, false);
    for (int i = 0; i < back->n; i++) {
        x[i] = back->deflection[i] / WB_MM;
        measured[i] = back->measured[i] / WB_MN;
        computed[i] = back->computed[i] / WB_MN;
    }
    if (back->n > 0)
        wb_figures_compared_add(&to, "unloading", "predicted", back->n, x, measured, computed,
                                colour, true);
    free(x);
}
