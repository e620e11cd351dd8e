#include "analysis/report/wires/wires_kind.h"

#include <stdio.h>

#include "analysis/report/wires/wires_figures.h"
#include "analysis/report/wires/wires_json.h"
#include "analysis/report/wires/wires_pages.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "report"

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

/* --- the row --- */

static enum wb_status read(void *campaign, const char *path)
{
    return wb_wires_read(campaign, path);
}

static enum wb_status load(void *results, const void *campaign)
{
    wb_wires_results_load(results, campaign);
    return WB_OK;
}

static int count_steps(const void *campaign)
{
    (void)campaign;
    return WB_WIRES_COMPUTE_STEPS;
}

static enum wb_status compute(void *results, int n_threads, wb_kind_progress *progress,
                              void *context)
{
    (void)n_threads;
    return wb_wires_results_compute(results, progress, context);
}

static void pages(struct wb_document *document, const void *results,
                  const struct wb_figures *figures)
{
    wb_wires_pages_build(document, results, figures);
}

static struct wb_json *json(const void *results, const char *const *files, int n_files)
{
    return wb_wires_json_build(results, files, n_files);
}

static void release(void *results)
{
    wb_wires_results_release(results);
}

static void release_campaign(void *campaign)
{
    wb_wires_release(campaign);
}

const struct wb_kind wb_wires_kind = {
    .name = "comparison",
    .data = "datasets",
    .datasets = wb_wires_results_list,
    .campaign_size = sizeof(struct wb_wires),
    .results_size = sizeof(struct wb_wires_results),
    .read = read,
    .load = load,
    .count_steps = count_steps,
    .compute = compute,
    .figures = wb_wires_figures,
    .n_figures = WB_WIRES_FIGURES,
    .pages = pages,
    .json = json,
    .print = print,
    .release = release,
    .release_campaign = release_campaign,
};
