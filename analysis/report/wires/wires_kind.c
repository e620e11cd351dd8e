#include "analysis/report/wires/wires_kind.h"

#include <stdio.h>

#include "base/units.h"

static void print(FILE *out, const void *context)
{
    const struct wb_wires_results *const results = context;
    const struct wb_wires *const comparison = results->comparison;
    fprintf(out, "%s (simulations): %d of %d datasets used\n", comparison->head.title,
            results->outcome.n_usable, results->outcome.n_wanted);
    wb_simulation_print_missing(out, wb_wires_results_list, results);
    if (results->fit_state == WB_SIMULATION_USABLE)
        fprintf(out, "  fitted rod: yield stress %.2f MPa, K %.4g MPa, n %.3f, RMS %.4f\n",
                results->fit.material.yield_stress / WB_MPA,
                results->fit.material.strength_coefficient / WB_MPA,
                results->fit.material.hardening_exponent, results->fit.rms);
    else
        fprintf(out, "  no fitted rod: %s\n", wb_text_string(&results->fit_problem));
    if (results->outcome.exceeds_limit)
        fprintf(out, "  a limit of the campaign is exceeded\n");
}

/* The law fitted to the solid's dataset. */
static enum wb_status add_cards(struct wb_cards *cards, const void *context)
{
    const struct wb_wires_results *const results = context;
    const struct wb_wires_run *const run = wb_wires_solid_run(results, WB_WIRES_ELASTOPLASTIC);
    if (results->fit_state != WB_SIMULATION_USABLE || !run)
        return WB_OK;
    return wb_cards_add_fit(
        cards, &results->fit, &results->comparison->head.fit,
        results->comparison->cases[WB_WIRES_ELASTOPLASTIC].datasets[WB_WIRES_SOLID].name,
        run->simulation.sha256);
}

const struct wb_kind wb_wires_kind = {
    .name = "comparison",
    .data = "datasets",
    .datasets = wb_wires_results_list,
    .campaign_size = sizeof(struct wb_wires),
    .results_size = sizeof(struct wb_wires_results),
    .keys = wb_wires_keys,
    .load = wb_wires_results_load,
    .compute = wb_wires_results_compute,
    .figures = wb_wires_figures,
    .n_figures = WB_WIRES_FIGURES,
    .pages = wb_wires_pages_build,
    .cards = add_cards,
    .json = wb_wires_json_build,
    .print = print,
    .release = wb_wires_results_release,
    .release_campaign = wb_wires_release,
};
