#include "analysis/report/bundles/bundles_kind.h"

#include <stdio.h>

#include "base/units.h"

static void print_bundle(FILE *out, const struct wb_bundles_results *results, int index)
{
    const struct wb_bundles *const campaign = results->campaign;
    const struct wb_bundles_bundle *const bundle = &campaign->bundles[index];
    const struct wb_bundles_result *const run = wb_bundles_results_dynamic(results, index);
    const struct wb_bundles_fit *const fit = wb_bundles_results_fit(results, index);
    fprintf(out, "%-16s", bundle->label);
    if (run)
        fprintf(out, "  F_max %.4g N", run->curve.max_force);
    if (run && run->published)
        fprintf(out, "  RMS from the published curve %.4f", run->rms);
    if (fit)
        fprintf(out, "  E %.0f MPa, yield stress %.2f MPa, K %.4g MPa, n %.3f, RMS %.4f",
                fit->result.material.youngs_modulus / WB_MPA,
                fit->result.material.yield_stress / WB_MPA,
                fit->result.material.strength_coefficient / WB_MPA,
                fit->result.material.hardening_exponent, fit->result.rms);
    else
        fprintf(out, "  no beam fitted: %s", wb_text_string(&results->fits[index].problem));
    fprintf(out, "\n");
}

static void print(FILE *out, const void *context)
{
    const struct wb_bundles_results *const results = context;
    const struct wb_bundles *const campaign = results->campaign;
    struct wb_verdict verdicts[WB_BUNDLES_VERDICTS];
    fprintf(out, "%s (simulations): %d of %d datasets used\n", campaign->head.title,
            results->outcome.n_usable, results->outcome.n_wanted);
    wb_simulation_print_missing(out, wb_bundles_results_list, results);
    for (int i = 0; i < campaign->n_bundles; i++)
        print_bundle(out, results, i);
    const int n = wb_bundles_results_judge(results, verdicts);
    for (int i = 0; i < n; i++) {
        if (!verdicts[i].kept)
            fprintf(out, "  limit %s exceeded by %s: %.4g, limit %.4g\n", verdicts[i].key,
                    verdicts[i].label, verdicts[i].value, verdicts[i].limit);
    }
}

/* Adds the material cards of the beams fitted to the bundles. */
static enum wb_status add_cards(struct wb_cards *cards, const void *context)
{
    const struct wb_bundles_results *const results = context;
    const struct wb_bundles *const campaign = results->campaign;
    for (int i = 0; i < campaign->n_bundles; i++) {
        const struct wb_bundles_run *const run = &campaign->runs[campaign->bundles[i].dynamic];
        const struct wb_bundles_fit *const fit = wb_bundles_results_fit(results, i);
        const struct wb_bundles_result *const result = wb_bundles_results_dynamic(results, i);
        if (fit && result)
            WB_TRY(wb_cards_add_fit(cards, &fit->result, &campaign->head.fit, run->dataset.name,
                                    result->simulation.sha256));
    }
    return WB_OK;
}

const struct wb_kind wb_bundles_kind = {
    .name = "bundles",
    .data = "datasets",
    .datasets = wb_bundles_results_list,
    .campaign_size = sizeof(struct wb_bundles),
    .results_size = sizeof(struct wb_bundles_results),
    .keys = wb_bundles_keys,
    .load = wb_bundles_results_load,
    .compute = wb_bundles_results_compute,
    .figures = wb_bundles_figures,
    .n_figures = WB_BUNDLES_FIGURE_ROWS,
    .pages = wb_bundles_pages_build,
    .cards = add_cards,
    .json = wb_bundles_json_build,
    .print = print,
    .release = wb_bundles_results_release,
    .release_campaign = wb_bundles_release,
};
