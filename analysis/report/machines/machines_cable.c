#include "analysis/report/machines/machines_cable.h"

#include <stdlib.h>

#include "base/memory.h"

static const double zeros[WB_MACHINES_ZEROS] = {0.5, 2.0};

/* Of the span: below this deflection the seating decides. */
static const double seating = 0.01;

struct input {
    const struct wb_machines *campaign;
    const struct wb_machines_group_results *groups;
    double zero; /* times the groups' zero force */
};

/* Of the tests of some groups, each a series, at one curvature. */
static struct wb_cable_mean find_mean(const struct input *in, const int *groups, int n_groups,
                                      double curvature)
{
    int most = 0, n = 0;
    for (int s = 0; s < n_groups; s++)
        most += in->campaign->groups[groups[s]].n_tests;
    double *const moment = wb_memory_new((size_t)most, sizeof *moment);
    int *const series = wb_memory_new((size_t)most, sizeof *series);
    for (int s = 0; s < n_groups; s++) {
        const struct wb_machines_group *const group = &in->campaign->groups[groups[s]];
        const double d = wb_cable_deflection(curvature, group->machine.span);
        for (int i = 0; i < group->n_tests; i++) {
            const struct wb_machines_test *const test = &in->groups[groups[s]].tests[i];
            if (!test->is_usable)
                continue;
            const double start = wb_machines_test_start(test, in->zero * group->zero_force);
            moment[n] =
                wb_cable_moment(wb_machines_test_force(test, start, d), group->machine.span);
            series[n++] = s;
        }
    }
    const struct wb_cable_mean mean = wb_cable_mean(moment, series, n);
    free(moment);
    free(series);
    return mean;
}

/* `wires`: groups that the wires are taken from. */
static struct wb_cable_place place(const struct input *in, int layer, const int *wires, int n_wires,
                                   double curvature, double axial)
{
    const struct wb_machines_cable *const cable = &in->campaign->cable;
    const struct wb_cable_mean of_layer = find_mean(in, &layer, 1, curvature);
    const struct wb_cable_mean of_wire = find_mean(in, wires, n_wires, curvature);
    const struct wb_cable_mean of_core = find_mean(in, &cable->core, 1, curvature);
    struct wb_cable_place out;
    wb_cable_place(&out, &of_layer, &of_wire, &of_core, cable->ring.n_wires, axial);
    return out;
}

static enum wb_status compute_layer(struct wb_machines_layer *layer, const struct input *in,
                                    int first)
{
    const struct wb_machines_cable *const cable = &in->campaign->cable;
    const double span = in->campaign->groups[layer->group].machine.span;
    const struct wb_machines_group *const wire = &in->campaign->groups[cable->wires[0]];
    /* A hair before the end, as the groups' own curves. */
    const double last = wb_cable_curvature(in->groups[layer->group].reach, span) * (1.0 - 1e-9);
    double axial[WB_MACHINES_PLACES];
    for (int k = 0; k < WB_MACHINES_PLACES; k++) {
        layer->curvature[k] = last * (k + 1) / WB_MACHINES_PLACES;
        layer->is_seating[k] = wb_cable_deflection(layer->curvature[k], wire->machine.span) <
                               seating * wire->machine.span;
    }
    WB_TRY(wb_cable_axial_moments(&cable->ring, layer->curvature, WB_MACHINES_PLACES, axial, NULL));
    for (int k = 0; k < WB_MACHINES_PLACES; k++) {
        const double curvature = layer->curvature[k];
        layer->place[k] =
            place(in, layer->group, cable->wires, cable->n_wires, curvature, axial[k]);
        layer->over_first[k] = layer->place[k].measured / find_mean(in, &first, 1, curvature).mean;
        for (int s = 0; s < cable->n_wires; s++)
            layer->chi_of_series[s][k] =
                place(in, layer->group, &cable->wires[s], 1, curvature, axial[k]).chi.value;
        for (int z = 0; z < WB_MACHINES_ZEROS; z++) {
            const struct input moved = {in->campaign, in->groups, zeros[z]};
            layer->chi_of_zero[z][k] =
                place(&moved, layer->group, cable->wires, cable->n_wires, curvature, axial[k])
                    .chi.value;
        }
    }
    return WB_OK;
}

enum wb_status wb_machines_cable_compute(struct wb_machines_cable_results *results,
                                         const struct wb_machines *campaign,
                                         const struct wb_machines_group_results *groups)
{
    const struct wb_machines_cable *const cable = &campaign->cable;
    const struct input in = {campaign, groups, 1.0};
    int n_wires = 0;
    for (int s = 0; s < cable->n_wires; s++)
        n_wires += groups[cable->wires[s]].n_usable;
    results->n_layers = cable->n_layers;
    for (int i = 0; i < cable->n_layers; i++) {
        struct wb_machines_layer *const layer = &results->layers[i];
        layer->group = cable->layers[i];
        if (n_wires == 0 || groups[cable->core].n_usable == 0)
            continue;
        layer->n = groups[layer->group].n_usable;
        if (layer->n > 0)
            WB_TRY(compute_layer(layer, &in, cable->layers[0]));
    }
    return WB_OK;
}
