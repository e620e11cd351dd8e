#include "analysis/report/draw/figures_cycle.h"

#include <stdio.h>
#include <stdlib.h>

#include "base/memory.h"
#include "base/units.h"

int wb_figures_cycle_points(const struct wb_cycle_member *member, const struct wb_cycle_fit *fit,
                            bool is_unloading, double *x, double *measured, double *computed)
{
    int n = 0;
    for (int i = 0; i < member->data.n_points; i++) {
        const struct wb_cycle_point *const point = &member->data.points[i];
        if (point->is_unloading != is_unloading)
            continue;
        x[n] = point->deflection / WB_MM;
        measured[n] = point->tension / WB_MN;
        computed[n++] = fit->tension[i] / WB_MN;
    }
    return n;
}

static void add_branches(struct wb_panel *panel, const struct wb_cycle_member *member,
                         const struct wb_cycle_fit *fit, struct wb_colour colour, bool has_legend)
{
    const size_t most = (size_t)member->data.n_points;
    double *const x = wb_memory_new(3 * most, sizeof *x), *const measured = x + most,
                  *const computed = x + 2 * most;
    const struct wb_figure_style points[2] = {
        {.colour = colour, .marker = WB_MARKER_CIRCLE, .marker_size = 3.2},
        {.colour = colour, .marker = WB_MARKER_RING, .marker_size = 3.6}};
    const struct wb_figure_style line = {.colour = wb_palette_ink(), .width = 1.0};
    static const char *const labels[2] = {"loading", "unloading"};
    for (int k = 0; k < 2; k++) {
        const int n = wb_figures_cycle_points(member, fit, k == 1, x, measured, computed);
        if (n == 0)
            continue;
        wb_figure_add_line(panel, has_legend && k == 0 ? "computed" : NULL, (size_t)n, x, computed,
                           &line);
        /* Every third, so that the line is seen between them. */
        int shown = 0;
        for (int i = 0; i < n; i += 3, shown++) {
            x[shown] = x[i];
            measured[shown] = measured[i];
        }
        wb_figure_add_line(panel, has_legend ? labels[k] : NULL, (size_t)shown, x, measured,
                           &points[k]);
    }
    free(x);
}

void wb_figures_cycle_add_panels(struct wb_figure *figure,
                                 const struct wb_cycle_calibration *calibration,
                                 struct wb_colour colour)
{
    for (int i = 0; i < calibration->n_members && i < WB_FIGURES_CYCLE_MOST; i++) {
        const struct wb_cycle_member *const member = &calibration->members[i];
        struct wb_panel *const panel = wb_figure_add_panel(figure);
        char title[40];
        snprintf(title, sizeof title, "sample %d", member->sample);
        wb_figure_set_title(panel, title);
        wb_figure_set_axes(panel, "Deflection <i>\xce\xb4</i> (mm)",
                           i == 0 ? "Strand tension (mN)" : "");
        add_branches(panel, member, &member->answers[calibration->chosen].fit, colour, i == 0);
    }
}
