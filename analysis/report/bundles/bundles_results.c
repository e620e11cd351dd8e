#include "analysis/report/bundles/bundles_results.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/report/reasons.h"
#include "base/circle.h"
#include "base/interrupt.h"
#include "base/memory.h"

const struct wb_bundles_result *wb_bundles_results_usable(const struct wb_bundles_results *results,
                                                          int run)
{
    return run >= 0 && results->runs[run].simulation.state == WB_SIMULATION_USABLE
               ? &results->runs[run]
               : NULL;
}

const struct wb_bundles_result *wb_bundles_results_dynamic(const struct wb_bundles_results *results,
                                                           int bundle)
{
    return wb_bundles_results_usable(results, results->campaign->bundles[bundle].dynamic);
}

double wb_bundles_results_rms(const struct wb_bundles_results *results, int run)
{
    const struct wb_bundles_result *const result = wb_bundles_results_usable(results, run);
    return result && result->published ? result->rms : (double)NAN;
}

bool wb_bundles_results_either(const struct wb_bundles_results *results,
                               const struct wb_bundles_bundle *bundle)
{
    return wb_bundles_results_usable(results, bundle->dynamic) ||
           wb_bundles_results_usable(results, bundle->constant);
}

bool wb_bundles_results_any(const struct wb_bundles_results *results,
                            const struct wb_bundles_group *group)
{
    bool any = false;
    for (int i = group->first; i < group->first + group->n; i++)
        any |= wb_bundles_results_either(results, &results->campaign->bundles[i]);
    return any;
}

const struct wb_bundles_fit *wb_bundles_results_fit(const struct wb_bundles_results *results,
                                                    int bundle)
{
    const struct wb_bundles_fit *const fit = &results->fits[bundle];
    return fit->state == WB_SIMULATION_USABLE ? fit : NULL;
}

const struct wb_bundles_section *
wb_bundles_results_section(const struct wb_bundles_results *results, int run)
{
    return run >= 0 && results->sections[run].state == WB_SIMULATION_USABLE
               ? &results->sections[run]
               : NULL;
}

double wb_bundles_results_rigidity(double youngs_modulus, double diameter)
{
    return youngs_modulus * wb_circle_second_moment(diameter);
}

double wb_bundles_results_cost(const struct wb_bundles_results *results, int bundle)
{
    const struct wb_bundles_result *const rod = &results->rods[bundle];
    const struct wb_bundles_result *const run = wb_bundles_results_dynamic(results, bundle);
    return run && rod->simulation.state == WB_SIMULATION_USABLE
               ? rod->simulation.cpu_s / run->simulation.cpu_s
               : (double)NAN;
}

/* --- limits --- */

/* Adds the verdict on a ratio of energies, at this offset of the numbers, of the worst of all
 * usable runs that are judged; a NaN is worse than any. */
static void judge_energy(const struct wb_bundles_results *results, struct wb_verdict *verdicts,
                         int *n, struct wb_verdict verdict, size_t offset)
{
    for (int i = 0; i < results->campaign->n_runs; i++) {
        const struct wb_bundles_result *const run = wb_bundles_results_usable(results, i);
        if (!run || !results->campaign->runs[i].judged)
            continue;
        const double value = *(const double *)((const char *)&run->numbers + offset);
        if (verdict.label && value <= verdict.value)
            continue;
        verdict.value = value;
        verdict.label = results->campaign->runs[i].name;
        if (isnan(value))
            break;
    }
    if (verdict.label)
        wb_verdict_add(verdicts, n, &verdict);
}

int wb_bundles_results_judge(const struct wb_bundles_results *results,
                             struct wb_verdict verdicts[WB_BUNDLES_VERDICTS])
{
    const struct wb_bundles *const campaign = results->campaign;
    const struct wb_bundles_limits *const limits = &campaign->limits;
    const struct {
        struct wb_verdict verdict;
        size_t offset; /* of its ratio in the numbers of a run */
    } energies[] = {
        {{"Largest kinetic over internal energy of a run", "kinetic_max", .limit = limits->kinetic},
         offsetof(struct wb_bundles_numbers, kinetic)},
        {{"Largest artificial over internal energy of a run", "artificial_max",
          .limit = limits->artificial},
         offsetof(struct wb_bundles_numbers, artificial)},
        {{"Largest imbalance of energy over the external work of a run", "imbalance_max",
          .limit = limits->imbalance},
         offsetof(struct wb_bundles_numbers, imbalance)},
    };
    int n = 0;
    for (int i = 0; i < campaign->n_bundles; i++) {
        const struct wb_verdict rms = {
            "RMS from the published curve, over its largest force", "rms_max",
            campaign->bundles[i].label,
            .value = wb_bundles_results_rms(results, campaign->bundles[i].dynamic),
            .limit = limits->rms};
        if (isfinite(rms.value))
            wb_verdict_add(verdicts, &n, &rms);
    }
    for (size_t i = 0; i < WB_COUNT(energies); i++)
        judge_energy(results, verdicts, &n, energies[i].verdict, energies[i].offset);
    for (int i = 0; i < campaign->n_bundles; i++) {
        const struct wb_verdict cost = {"CPU seconds of the 1D beam over those of the bundle",
                                        "cost_max", campaign->bundles[i].label,
                                        .value = wb_bundles_results_cost(results, i),
                                        .limit = limits->cost};
        if (!isnan(cost.value))
            wb_verdict_add(verdicts, &n, &cost);
    }
    return n;
}

static void judge(struct wb_bundles_results *results)
{
    const struct wb_bundles *const campaign = results->campaign;
    struct wb_kind_outcome *const outcome = &results->outcome;
    struct wb_verdict verdicts[WB_BUNDLES_VERDICTS];
    wb_simulation_count(wb_bundles_results_list, results, &outcome->n_wanted, &outcome->n_usable);
    outcome->is_complete = outcome->n_usable == outcome->n_wanted;
    for (int i = 0; i < campaign->n_runs; i++) {
        const struct wb_bundles_result *const run = wb_bundles_results_usable(results, i);
        if (run && run->published && run->n_published < run->curve.n)
            outcome->is_complete = false;
    }
    for (int i = 0; i < campaign->n_bundles; i++)
        outcome->is_complete &= results->fits[i].state == WB_SIMULATION_USABLE;
    const int n = wb_bundles_results_judge(results, verdicts);
    outcome->exceeds_limit = !wb_verdict_all_kept(verdicts, n);
}

/* --- the fit --- */

static enum wb_status calibrate(struct wb_bundles_fit *fit, const struct wb_bundles_result *run,
                                const struct wb_calibrate_settings *settings, struct wb_reason *why)
{
    const struct wb_dataset *const dataset = &run->simulation.dataset;
    struct wb_calibrate_settings own = *settings;
    int n_reached;
    own.progress = wb_campaign_go_on;
    WB_TRY(wb_calibrate_run(&fit->result, &dataset, 1, &own, why));
    fit->rigidity = wb_bundles_results_rigidity(fit->result.material.youngs_modulus,
                                                dataset->info.outer_diameter);
    fit->force = wb_memory_new((size_t)run->curve.n, sizeof *fit->force);
    const enum wb_status status = wb_bundles_run_beam(fit->force, &n_reached, run, &dataset->info,
                                                      &fit->result.material, settings, why);
    if (status != WB_OK)
        wb_calibrate_result_release(&fit->result);
    return status;
}

static void fit_bundle(struct wb_bundles_results *results, int index)
{
    struct wb_bundles_fit *const fit = &results->fits[index];
    const struct wb_bundles_result *const run = wb_bundles_results_dynamic(results, index);
    fit->state = WB_SIMULATION_MISSING;
    if (!run) {
        wb_text_append(&fit->problem, "the bundle's dataset that it builds on is missing");
        return;
    }
    const struct wb_reasons reasons = {&fit->problem, NULL, NULL};
    struct wb_reason why = {.text = ""};
    const enum wb_status status = calibrate(fit, run, &results->campaign->head.fit, &why);
    fit->state = status == WB_OK ? WB_SIMULATION_USABLE : WB_SIMULATION_REFUSED;
    if (status != WB_OK)
        wb_reasons_fail(&reasons, status, &why);
}

/* A dataset that cannot be compared is refused with the reason. */
static void compare_run(struct wb_bundles_result *result, const struct wb_bundles_run *run,
                        const struct wb_calibrate_settings *fit)
{
    const struct wb_reasons reasons = {&result->simulation.problem, run->dataset.path,
                                       run->dataset.name};
    struct wb_reason why = {.text = ""};
    const enum wb_status status = wb_bundles_run_compare(result, run, fit, &why);
    if (status == WB_OK)
        return;
    result->simulation.state = WB_SIMULATION_REFUSED;
    wb_reasons_fail(&reasons, status, &why);
}

/* The section model of a bundle's run, where it was not computed yet. */
static void add_section(struct wb_bundles_results *results, int run)
{
    const struct wb_bundles *const campaign = results->campaign;
    const struct wb_bundles_result *const explicit = wb_bundles_results_usable(results, run);
    if (run >= 0 && results->sections[run].state == WB_SIMULATION_NOT_WANTED)
        wb_bundles_section_compute(&results->sections[run], &campaign->runs[run],
                                   explicit ? &explicit->curve : NULL, campaign->head.fit.step);
}

/* --- all of it --- */

bool wb_bundles_results_list(const void *context, int index, struct wb_simulation_entry *entry)
{
    const struct wb_bundles_results *const results = context;
    const struct wb_bundles *const campaign = results->campaign;
    const int beam = index - campaign->n_runs;
    if (beam >= campaign->n_bundles)
        return false;
    if (beam >= 0) {
        *entry = (struct wb_simulation_entry){.wanted = &campaign->bundles[beam].rod,
                                              .result = &results->rods[beam].simulation};
        return true;
    }
    const struct wb_bundles_run *const run = &campaign->runs[index];
    *entry = (struct wb_simulation_entry){.wanted = &run->dataset,
                                          .result = &results->runs[index].simulation,
                                          .cost = wb_bundles_run_cost(run),
                                          .is_resumable = true};
    return true;
}

enum wb_status wb_bundles_results_load(void *context, const void *of)
{
    struct wb_bundles_results *const results = context;
    const struct wb_bundles *const campaign = of;
    const struct wb_simulation_reader reader = {.take = NULL};
    results->campaign = campaign;
    results->outcome.campaign = &campaign->head;
    results->outcome.n_steps = campaign->n_bundles;
    for (int i = 0; i < campaign->n_runs; i++)
        wb_bundles_run_load(&results->runs[i], &campaign->runs[i]);
    for (int i = 0; i < campaign->n_bundles; i++)
        wb_simulation_load(&results->rods[i].simulation, &campaign->bundles[i].rod, &reader);
    return WB_OK;
}

enum wb_status wb_bundles_results_compute(void *of, int n_threads, wb_kind_progress *progress,
                                          void *context)
{
    struct wb_bundles_results *const results = of;
    (void)n_threads;
    const struct wb_bundles *const campaign = results->campaign;
    for (int i = 0; i < campaign->n_runs && !wb_interrupted(); i++) {
        if (results->runs[i].simulation.state == WB_SIMULATION_USABLE)
            compare_run(&results->runs[i], &campaign->runs[i], &campaign->head.fit);
    }
    for (int i = 0; i < campaign->n_bundles && !wb_interrupted(); i++) {
        fit_bundle(results, i);
        add_section(results, campaign->bundles[i].dynamic);
        add_section(results, campaign->bundles[i].constant);
        if (progress)
            progress(context, i + 1, campaign->bundles[i].label);
    }
    results->outcome.interrupted = wb_interrupted();
    judge(results);
    return WB_OK;
}

void wb_bundles_results_release(void *context)
{
    struct wb_bundles_results *const results = context;
    for (int i = 0; i < WB_BUNDLES_RUNS; i++) {
        wb_bundles_run_release(&results->runs[i]);
        wb_bundles_section_release(&results->sections[i]);
    }
    for (int i = 0; i < WB_BUNDLES_BUNDLES; i++) {
        struct wb_bundles_fit *const fit = &results->fits[i];
        wb_bundles_run_release(&results->rods[i]);
        wb_text_release(&fit->problem);
        if (fit->state == WB_SIMULATION_USABLE)
            wb_calibrate_result_release(&fit->result);
        free(fit->force);
    }
    memset(results, 0, sizeof *results);
}
